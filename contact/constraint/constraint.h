// Contact points: places where something must not move closer, with Coulomb friction, whatever moves them.
//
// A degree-of-freedom node is a velocity that impulses change: a node of a mesh, or of a grid. A point ties a slave, a
// weighted sum of degree-of-freedom nodes, to a master: a plane that moves as it likes, or a facet of a body, extended
// affinely:
//   u = sum_s w_s v_s - sum_k [ beta_k v_k - height (n_f . v_k) grad beta_k ]
// beta_k are the facet's weights where the slave projects onto its plane, height its distance from the plane, n_f the
// facet's normal: the velocity of the material plane as it moves, turns and stretches, seen at the slave. The reaction
// goes back by the transpose. As u is 0 for every rigid motion of both, any impulse leaves linear and angular momentum
// alone, to round-off.
//
// Material points are balls: their centres, whose velocity is weighed, stand off the surface. Where one rubs, friction
// acts at its surface: with a friction point, u of slip has entries of its own, on the same degree-of-freedom nodes,
// and friction goes back by their transpose, so that it acts there.
//
// All points of a step together must satisfy: u_n >= target, normal impulse >= 0, one of them 0; friction impulse
// within the Coulomb cone and against what is left of slip. Points that hold: u_n = target, and where they stick no
// slip is left. What a spring pushes pushes at least with that. Solved by projected Jacobi sweeps: a point's correction
// is scaled by its row sum of the coupling matrix (in units of its own effective mass), so that a uniform approach is
// met in one sweep and no sweep can add energy. Neither the order of points nor the number of threads changes a bit.
//
// Of sweeps that are not accelerated, those that correct a point by less than a fiftieth of what ends them leave it out
// from then on, until its nodes have drifted by as much (rest.h): where surfaces lie on each other two sweeps do for
// most points, and rims take the rest.
//
// Accelerated sweeps (Nesterov 1983, with the restarts of O'Donoghue and Candes 2015; contact: Mazhar, Heyn, Negrut and
// Tasora 2015) begin with a share of the last correction on top. Where touches are many to a node they need a
// quarter of the sweeps.
//
// Tried and left: starting the sweeps from the last step's impulses. They end earlier, but what is given too much is
// taken back only as far as the sweeps go, and a stack of hexahedra at rest gained energy until it fell.
#pragma once

#include "base/parallel.h"
#include "contact/constraint/impulse_account.h"

typedef struct brunt_dof_node {
    double v[3], old[3]; // [m/s] now; before the forces of this step
    double inverse[3];   // [1/kg] by component; 0: infinite mass
    double impulse[3];   // [N s] received in all
    bool crossed;        // some push along what others rub along: both loads are of the greater weights
    bool angular;        // v[0] is an angular velocity: entries have levers in place of weights
} brunt_dof_node;

typedef struct brunt_constraint_entry {
    int32_t dof_node;
    double weight[3];          // w_s of a slave, -beta_k of a master, by component: symmetry planes turn some of them
    double height_gradient[3]; // 0 of a slave; height grad beta_k of a master; a lever [m] of an angular velocity, with
                               // `facet` (1, 0, 0)
} brunt_constraint_entry;

// What pushes have taken of a slave, to be given back at its release (release.h).
typedef struct brunt_touch_energy {
    double held;      // [J]
    int32_t partner;  // of whom, as constraints say; 0: of anyone
    int32_t met;      // of its constraints in this step: how many there are ...
    int32_t releases; // ... and how many are of that partner and do not push
    bool same;        // some are of that partner
    bool pushed;      // some push
    int32_t claims;   // touches of edges that it goes to, before the step
    double alone;     // [J] of this step: the most that one of its pushes would take of its own mass alone
} brunt_touch_energy;

typedef struct brunt_release brunt_release; // release.c
typedef struct brunt_kick brunt_kick;       // release.c

typedef struct brunt_constraint {
    int32_t first, count;           // entries
    double x[3];                    // [m] where
    double n[3];                    // out of the master, unit
    double facet[3];                // n_f: normal of the master's facet; unused for planes
    double gap;                     // [m] before the step
    double target;                  // [m/s] least u_n
    double friction;                // of what sticks: greater than 0
    double least;                   // [N s] of the normal impulse: 0; -INFINITY: it holds; what its spring pushes with
    double spring;                  // [N/m] of what overlaps; 0: none
    bool sticks;                    // friction has no bound
    double plane[3];                // [m/s] velocity of the master when it is a plane; 0 for facets
    brunt_impulse_account *account; // where the point is recorded: impulse on the slave times `sign`
    brunt_touch_energy *touch;      // of the slave; NULL: what its pushes take is lost
    int32_t partner;                // of the touch: number of the other body + 1, or -1 - that of the plane
    double sign; // of a body with itself 0: it gets both, and the account neither, but what they dissipate
    double area; // [m^2] it stands for in the account's area
    // number + 1 of the body of material points that carries the reaction, if that is the caller's; else 0
    int32_t bearer;
    int32_t friction_point; // number + 1 of its own for friction, whose `count` entries follow the others; 0: it rubs
                            // where it pushes
    double image; // [1/kg] of what an impulse along n does to u_n, the share of the image that presses with it
    // solution
    double scale, row_sum, row_sum_t;           // [kg] effective mass alone; [-] row sums in units of it
    double normal_impulse, friction_impulse[3]; // [N s]
    bool slips;
    bool turns;  // with its facet: some entry has a height gradient
    bool laned;  // its entries are in its lane of its block, and nowhere else
    int32_t tag; // the caller's: read with what was found
} brunt_constraint;

enum { BRUNT_RECORDED_ACCOUNTS = 4 }; // of a chunk of points that are added up apart

typedef struct brunt_constraint_set {
    brunt_constraint *constraint;
    size_t constraint_capacity;
    int32_t constraint_count;
    brunt_constraint_entry *entry;
    size_t entry_capacity;
    int32_t entry_count;
    struct brunt_friction_point {
        double x[3]; // [m] where friction acts
    } * friction_point;
    size_t friction_point_capacity;
    int32_t friction_point_count;
    brunt_dof_node *dof_node;
    size_t dof_node_capacity;
    int32_t dof_node_count;
    // What sweeps look at and change of each degree-of-freedom node, close together; the nodes have it when all is
    // done. A fourth number does not count.
    double (*now)[4];      // [m/s]; NULL but while a set is solved
    double (*before)[4];   // [m/s] before the forces of this step
    double (*inverse)[4];  // [1/kg]
    double (*received)[4]; // [N s] in all
    double (*sum)[4];      // [N s] of a sweep so far, unless the node is shared
    bool levered;          // some are angular velocities
    double (*load)[2];  // [kg] sum of |weight| effective mass of its constraints: what they push and what they rub with
    double (*state)[4]; // room for `now`
    size_t state_capacity, before_capacity, inverse_capacity, received_capacity, sum_capacity, load_capacity;
    // Chunks of points are swept over in so many parts, each by one thread and in the order of the points, so that what
    // they give to nodes of one part alone is added up at once (parts.h). 0: every node is shared.
    int parts;
    int32_t *part_of; // of each chunk
    struct brunt_chunk_place {
        double x; // [m]
        int32_t chunk;
    } * chunk_place; // while chunks are divided
    uint8_t *marks;  // of each part and node: some of its constraints are in that part
    uint8_t *shared; // of each node: several parts have its constraints; what they give is added up by its column
    int32_t *own, *own_first; // nodes by the part that has them alone, then the shared ones; where each begins
    size_t part_of_capacity, chunk_place_capacity, marks_capacity, shared_capacity, own_capacity, own_first_capacity;
    // Which points press on a shared degree-of-freedom node: their entries by node, in the order of the points.
    struct brunt_constraint_column {
        int32_t constraint, entry; // whose friction point has an entry of its own, behind it
    } * column;
    size_t column_capacity;
    int32_t *column_first;
    size_t column_first_capacity;
    int32_t *column_at; // of each group of points and node, while columns are filled: the next one
    size_t column_at_capacity;
    // [N s] of each entry on a shared node: what the sweep gives it. A fourth number does not count, so that they are
    // added as one. Before the sweeps: the share of the constraint that the node gets of its pushes, of its friction,
    // the greater of both, and its effective mass.
    double (*given)[4];
    size_t given_capacity;
    struct brunt_constraint_block *block; // of so many constraints at a time, where they are alike (block.h)
    size_t block_capacity;
    int32_t open_blocks; // so many may have been made as their constraints were filled, or have lanes
    struct brunt_constraint_rates {
        double old[3], now[3]; // [m/s] relative velocity where it pushes, before the forces and now
    } * rates;                 // of each constraint, once it is solved
    size_t rates_capacity;
    struct brunt_recorded {
        int count;          // accounts
        int32_t first_left; // point from which on there were too many accounts; -1: none
        brunt_impulse_account *account[BRUNT_RECORDED_ACCOUNTS], sum[BRUNT_RECORDED_ACCOUNTS];
    } * recorded; // of each chunk of points: what they have done (accounts.h)
    size_t recorded_capacity;
    double *changed; // [m/s] of each chunk of points: greatest correction of the sweep
    size_t changed_capacity;
    // Constraints that rest (rest.h).
    double still;      // [m/s] the most that one which rests corrects, and that its nodes drift. 0: none rests
    double *corrected; // [m/s] of each, when it was last swept over
    bool *rests;       // of each; of a block all, as the first of them says
    double *drift;     // [m/s] of each node since what is beside it was told
    uint8_t *stirred;  // of each node: what is beside it is told
    size_t corrected_capacity, rests_capacity, drift_capacity, stirred_capacity;
    double kick;               // [s] what springs push over
    double negligible;         // [m/s] a correction that ends the sweeps, whatever the first one was
    bool gives_back;           // constraints have touches ...
    double leap;               // [m/s] ... what comes faster is lost: it would be thrown past what is near
    double shallow;            // [m] ... what is deeper is given nothing back until it is out again
    brunt_release *release;    // of each
    brunt_kick *kicks;         // of each, while some give back
    int32_t *settled, *kicked; // constraints that give back or owe, in their order; nodes that they give to
    size_t release_capacity, kicks_capacity, settled_capacity, kicked_capacity;
    // Of accelerated sweeps, else unused: what points and nodes had after the sweep before, and of each chunk how much
    // of its correction goes back on the last one's (see solve.c).
    bool accelerated;
    bool levers;     // of the last solution: it had to count how facets turn under what rubs above them
    int sweeps;      // of the last solution
    double momentum; // [-] share of the last sweep's correction that the next one begins with
    struct brunt_constraint_past {
        double normal_impulse, friction_impulse[3];
    } * point_past;
    size_t point_past_capacity;
    struct brunt_dof_past {
        double v[3], impulse[3];
    } * dof_past;
    size_t dof_past_capacity;
    double *turned_back;
    size_t turned_back_capacity;
} brunt_constraint_set;

// Aborts where a set is not one that can be solved: entries and nodes out of range, masses below 0, normals not of unit
// length.
void brunt_constraints_validate(const brunt_constraint_set *set);
void brunt_constraints_clear(brunt_constraint_set *set);
void brunt_constraints_free(brunt_constraint_set *set);
// New degree-of-freedom node, point, and entry of the last point. The index, or BRUNT_NONE: out of memory.
int32_t brunt_constraints_dof_node(brunt_constraint_set *set, brunt_error *error);
int32_t brunt_constraints_add(brunt_constraint_set *set, brunt_error *error);
int32_t brunt_constraints_entry(brunt_constraint_set *set, int32_t dof_node, double weight,
                                brunt_error *error); // all components alike
// Gives the last point, when its entries are complete, a friction point to x: entries without weights, for the caller
// to fill. The index of the first, or BRUNT_NONE: out of memory.
int32_t brunt_constraints_friction_point(brunt_constraint_set *set, const double x[3], brunt_error *error);
// Makes room for so many points, entries and degree-of-freedom nodes in all, which the caller then fills. BRUNT_OK, or
// BRUNT_FAILED: out of memory.
int brunt_constraints_reserve(brunt_constraint_set *set, int32_t point_count, int32_t entry_count, int32_t dof_count,
                              brunt_error *error);
// What is filled in then, in any order and by several threads, may go to its blocks at once, while it is at hand: none
// has yet; BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_constraints_open_blocks(brunt_constraint_set *set, brunt_error *error);
// Entries of constraint k, which is complete but for them and stays as it is, pushes, and is on a facet or on what
// stands still: to its lane of its block, not to `entry`, if it has no more than BRUNT_LANE_ENTRIES, of weights that
// are those of all components, and the first is the slave's.
enum { BRUNT_LANE_ENTRIES = 5 };
void brunt_constraints_lane(brunt_constraint_set *set, int32_t k, const brunt_constraint_entry *entry);
// And constraints first .. end are complete, of which those before `first` that it returns, a multiple of a block's,
// are done with.
int32_t brunt_constraints_fill_blocks(brunt_constraint_set *set, int32_t first, int32_t end);
// Whether a point has given an impulse: what lets go only by pushing.
static inline bool brunt_constraint_acts(const brunt_constraint *constraint) {
    return constraint->least < 0 || constraint->normal_impulse > 0;
}
// Relative velocity of a point, with the degree-of-freedom nodes' v (old: as they were before the forces).
void brunt_constraint_velocity(const brunt_constraint_set *set, const brunt_constraint *constraint, bool old,
                               double u[3]);
// The same where its friction point is, of one that has one.
void brunt_constraint_slip(const brunt_constraint_set *set, const brunt_constraint *constraint, bool old, double u[3]);
// What friction does to a constraint with the normal impulse it has, as far as it is concerned; added to `rub`.
void brunt_constraint_rub(const brunt_constraint_set *set, brunt_constraint *constraint, double rub[3]);
// Gives a constraint's nodes an impulse where it pushes and one where it rubs, which without a friction point is part
// of the first: of shared nodes `given`, of the others `sum`.
void brunt_constraint_give(const brunt_constraint_set *set, const brunt_constraint *constraint, const double push[3],
                           const double rub[3]);
// Gives a degree-of-freedom node its impulse in `given` or `sum`, while a set is solved.
void brunt_constraints_move(const brunt_constraint_set *set, int64_t node);
// Solves with at most `sweeps` sweeps, until the greatest correction of one is no more than `tolerance` of that of the
// first, or than `negligible`; what is left is met in the next step. Records every point. BRUNT_OK, or BRUNT_FAILED:
// out of memory.
int brunt_constraints_solve(brunt_constraint_set *set, int sweeps, double tolerance, int threads, brunt_timer *timer,
                            brunt_error *error);
