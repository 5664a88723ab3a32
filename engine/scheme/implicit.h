// What implicit steps keep beside the world: unknowns, terms, Newton's method. Private to the scheme.
//
// A step minimises 1/(2c) |u - aim|^2_M + stored energies + barriers + friction - loads . u over the displacements u of
// the step: its end is where the gradient is 0, M a = F. With c = 2 alpha beta dt^2,
//   aim = dt v + alpha (1 - 2 beta) dt^2 a,    a_end = (u - aim) / c,    v_end = v + dt ((1 - gamma) a + gamma a_end)
// and backward Euler is alpha 1, beta 1/2, gamma 1, Newmark's trapezoidal form alpha 1/2, beta 1/4, gamma 1/2. The
// acceleration a at the start is that of the forces there, on the grid of this step: it is not carried over.
//
// A load step is such a step with dt to infinity: no inertia, no velocities (static_step.c). dt is of a pseudo-time
// then.
#pragma once

#include "fem/potential.h"
#include "linear/newton.h"
#include "mpm/potential.h"
#include "scheme/boundary_rows.h"
#include "scheme/ghost.h"
#include "scheme/implicit_contact.h"
#include "scheme/scheme.h"
#include "scheme/step_terms.h"

// Inertia, loads and the pull of prescribed motion come first, with drag where bodies are damped, what surfaces hold
// and nodes without material where there are surfaces; then a term for each body, then those of contact.
enum { BRUNT_OTHER_TERM_LIMIT = 3 + 1 + 2 + 2 };

// Of a time integrator.
typedef struct brunt_weights {
    double alpha, beta, gamma;
    double moment; // where along the step forces act, for their moments: 1 its end, 1/2 its middle
    double work;   // share of the forces at the end in the work of the step; those at its start have the rest
} brunt_weights;

// Arrays over all components of the unknowns.
typedef struct brunt_fields {
    double *u, *v;              // [m] displacement, [m/s] velocity at the end
    double *aim;                // [m]
    double *acceleration;       // [m/s^2] at the start; 0 of backward Euler
    double *load;               // [N] at the end of the step
    double *force_before;       // [N] all forces at its start; of Newmark and of load steps
    double *gradient;           // [N] of all that is stored, at the end once the step is recorded
    double *contact;            // [N] of barriers and friction, as the integrator weighs both ends of the step
    double *step, *zero;        // room; 0
    double *pull;               // [N/m] of components on their way to where they are to be, while they are
    double *stiffness;          // [N/m] of nodes, m (c / h)^2; of load steps
    double *rub, *tried, *best; // [m] where friction was taken last, room, and where it was best; of load steps with it
    uint8_t *support;           // of nodes: brunt_support of their body; of load steps
    size_t u_capacity, v_capacity, aim_capacity, acceleration_capacity, load_capacity, force_before_capacity,
        gradient_capacity, contact_capacity, step_capacity, zero_capacity, pull_capacity, stiffness_capacity,
        support_capacity, rub_capacity, tried_capacity, best_capacity;
} brunt_fields;

struct brunt_implicit {
    brunt_team team;
    brunt_weights weights;
    brunt_unknowns unknowns;
    brunt_fields field;
    bool told_jump;        // that a load step has jumped; not of the state
    bool leads;            // load steps begin where the matrix takes what follows prescribed motion
    bool still;            // load steps: no inertia
    brunt_inertia inertia; // or
    brunt_proximal proximal;
    brunt_load_scale scale; // of load steps
    brunt_dead_loads loads;
    brunt_pull pull;
    brunt_drag drag;                 // of bodies with damping
    double *drag_weight, *drag_rest; // its arrays
    size_t drag_weight_capacity, drag_rest_capacity;
    brunt_fem_potential **fem; // a body each
    brunt_mpm_potential **mpm;
    brunt_term *term; // inertia or what holds load steps near their iterates, loads, pull, surfaces, bodies of
                      // elements, of points, barrier, friction
    int fixed_terms, term_count, body_terms; // of them, before the first of a body, up to the last
    brunt_implicit_contact contact;
    brunt_condensation condensation; // of load steps; no bodies: none
    brunt_condensed_mesh *condensed_mesh;
    bool holds; // there are surfaces, the two below are of them
    brunt_boundary_rows rows;
    brunt_ghost ghost;
    brunt_balance balance;       // of the last load step; not of the state
    bool stopped;                // the step that is tried is left; not of the state
    brunt_impulse_account *last; // of boundaries, of pairs, as the step began; of worlds that may be stopped
    size_t last_capacity;
    bool rubs;      // there is friction
    bool rubs_late; // from here on by the pressures of the step before; not of the state
    bool forces;    // materials without a potential: Newton's method has no energy to lower
    int friction_iterations;
    double *moved; // [m] of the particles of a body: a field of the unknowns where they are
    size_t moved_capacity;
    brunt_newton newton;
    brunt_newton_options options;
    double tolerance;       // [m/s] that is asked for; that of the options is less where gaps are narrow
    brunt_linear_size size; // of the systems at the start
    brunt_linear_choice choice;
    double dt;                      // [s] of the step that is tried
    brunt_world *world;             // for the phases of Newton's method
    int phase[BRUNT_NEWTON_PHASES]; // their passes
    brunt_newton_counts tried;      // of the step that is tried
    double *turned;                 // of all bodies at the end of a run: share of moments that are wrong; else NULL
    struct {                        // the body whose forces balance least, where Newton's method would have ended
        int body;                   // among all; -1: all do
        int32_t node;               // of the unknowns, with the greatest force left
        double left, all;           // [N] that is left, of forces that add up to this
    } off;
};

// [m/s] at the end of the step; of load steps nothing moves.
static inline const double *brunt_implicit_velocity(const struct brunt_implicit *m) {
    return m->still ? m->field.zero : m->field.v;
}

static inline int64_t brunt_implicit_components(const struct brunt_implicit *m) {
    return (int64_t)m->unknowns.count * m->unknowns.dim;
}

// --- implicit.c
void brunt_newton_counts_add(brunt_newton_counts *sum, const brunt_newton_counts *part);

// --- implicit_world.c
// The size of a correction: of particles and nodes of meshes [m/s]; of `where`: node of a mesh, or -2 - particle's
// slot. Sets the tolerance, below which it is small beside the least gap too: close to a wall a barrier's force goes by
// 1 / gap, and Newton's corrections are as small as the gap.
double brunt_implicit_measure(void *context, const brunt_team *team, const double *p, int64_t *where);

// --- implicit_balance.c
// What the forces on the body that balances least are off by, of what they may be (brunt_newton_options).
double brunt_implicit_balance(void *context, const brunt_team *team, const double *u);

// --- implicit_loads.c
// Loads at a time [N], of all components: gravity, and tractions on groups of nodes, which are left as of that time.
void brunt_implicit_loads(brunt_world *world, double time, double *load);
// Gradients of terms [first, end) at u, summed.
void brunt_implicit_gradient(const struct brunt_implicit *m, int first, int end, const double *u, double *g);

// --- implicit_condense.c
// Finds crowds whose inner nodes need not be among the unknowns of load steps, once there are all terms. BRUNT_OK, or
// BRUNT_FAILED.
int brunt_implicit_condense(struct brunt_implicit *m, brunt_error *error);
void brunt_implicit_condense_free(struct brunt_implicit *m);
// --- static_step.c
// A load step begins, all that is held and the loads at its end are known: how stiff nodes are, how large forces, what
// nothing holds. BRUNT_OK; BRUNT_FAILED: a body that nothing holds, and loads on it that do not balance.
int brunt_static_begin(brunt_world *world, brunt_error *error);
// What forces leave unbalanced, beside all that act (newton.h).
double brunt_static_unbalance(void *context, const double *gradient);
// [N] What rounding makes of forces along component k: places are known to some roundings of their size.
double brunt_static_rounding(const struct brunt_implicit *m, int64_t k);
// The step to try, in parts of a load step; the least part of one that is tried.
double brunt_static_wanted(const brunt_world *world);
double brunt_static_least(const brunt_settings *settings);
// --- static_balance.c
// What the forces on bodies leave, once `field.gradient` and `field.contact` are those at the end.
void brunt_static_take_balance(struct brunt_implicit *m);
// The greatest part of the forces on one body that is left of them, by the gradient at u: of one with next to none,
// beside `act`, of all [N]; 0 where rounding makes it. Takes `field.contact` at u.
double brunt_static_alone(struct brunt_implicit *m, const double *gradient, double act);
// --- static_friction.c
// From where held components are at their places to equilibrium with friction, by as many iterations as are allowed.
typedef int brunt_minimise(struct brunt_implicit *m, brunt_newton_report *report, brunt_error *error);
int brunt_static_rub(struct brunt_implicit *m, brunt_minimise *minimise, brunt_newton_report *report,
                     brunt_error *error);
// --- static_penalty.c
// Whether the stiffness of what may overlap is a guess yet; takes it from contacts at u, the end of a load step.
bool brunt_static_guesses(const struct brunt_implicit *m);
int brunt_static_see(struct brunt_implicit *m, brunt_error *error);
// --- static_step.c
// Records the work of forces that are unbalanced where the step begins: particles on a new grid bring them, the
// transfer's; meshes only have them where a run begins, and what they settle by is lost to the scheme.
void brunt_static_settle(brunt_world *world);
// Says, once, that a step has jumped: `taken` [J] of the work within bodies is not there at its end.
void brunt_static_watch(brunt_world *world, double taken, double work);
// --- implicit_drag.c
// Weights of damped nodes, once the unknowns have numbers. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_implicit_drag_number(struct brunt_implicit *m, const brunt_world *world, brunt_error *error);
void brunt_implicit_drag_before(const struct brunt_implicit *m,
                                double *force);         // adds the force at the step's start [N]
void brunt_implicit_drag_aim(struct brunt_implicit *m); // once the aim is known
// Loss and impulse of a step; adds the force at its end to `field.load`.
void brunt_implicit_account_drag(brunt_world *world);

// --- implicit_step.c
// What is asked of bodies from here on.
void brunt_implicit_ask(const struct brunt_implicit *m, brunt_trial_part part);
// Finds the passes that Newton's phases are.
void brunt_implicit_follow(brunt_plan *plan);

// --- implicit_stop.c: steps that are left (brunt_world_heed)
// A step begins that may be. BRUNT_OK, or BRUNT_FAILED: no memory.
int brunt_implicit_heed(brunt_world *world, brunt_error *error);
// BRUNT_STOPPED; the accounts are those of the step before again.
int brunt_implicit_leave(brunt_world *world, brunt_error *error);

// --- implicit_turns.c: bodies of small strain that have turned
// At the end of a run, by the gradient of what bodies store where the step ends: which have wrong moments. BRUNT_OK, or
// BRUNT_FAILED: no memory.
int brunt_implicit_take_turns(struct brunt_implicit *m, const double *force, brunt_error *error);
// Warns of them, once bodies are where the step ends.
void brunt_implicit_tell_turns(brunt_world *world);

// --- implicit_account.c
// Velocities at the end; kinetic energy, work and impulses of the step, before it is committed. BRUNT_OK, or
// BRUNT_FAILED: no memory to look at contact.
int brunt_implicit_account(brunt_world *world, brunt_step *step, brunt_error *error);

// --- implicit_surface.c: lines and surfaces that hold material points
// Rows of the step that is tried. BRUNT_OK, or BRUNT_FAILED.
int brunt_implicit_surfaces_begin(brunt_world *world, double dt, brunt_error *error);
// What comes, by u, to surfaces that it may leave. *grown: whether there was more than was known, for another solution.
// BRUNT_OK, or BRUNT_FAILED: it comes from too far, or went through.
int brunt_implicit_surfaces_meet(brunt_world *world, bool *grown, brunt_error *error);
// Adds the forces of their tractions at the start of the step to `force` [N], with a sign.
void brunt_implicit_surfaces_before(const struct brunt_implicit *m, double sign, double *force);
// Keeps the tractions at u: those that the next step begins with.
void brunt_implicit_surfaces_keep(brunt_world *world);
// None, as before the first step.
void brunt_implicit_surfaces_forget(brunt_boundary_surfaces *surfaces);
// What they did over the step; what they do at its end is added to `field.gradient`. Their tractions are kept.
void brunt_implicit_account_surfaces(brunt_world *world);
// Adds to a reason why a step has failed which bodies have too few rows to be held; nothing where there are no
// surfaces.
void brunt_implicit_surfaces_lack(const brunt_world *world, char *reason, size_t size);

// --- implicit_account_contact.c
typedef struct brunt_term_sums {
    double before, after; // [J] energies at the start and the end of the step
    double work;          // [J] gradient . u, as the integrator weighs both ends
} brunt_term_sums;
// Energies of terms [first, end), and the work against them. Their gradient at the end is in `field.step`; it is added,
// weighed, to `total`.
int brunt_implicit_sums(const struct brunt_implicit *m, int first, int end, double *total, brunt_term_sums *sums,
                        brunt_error *error);
int brunt_implicit_account_contact(brunt_world *world, brunt_error *error);
// Where the forces on a node have their moments [m].
void brunt_implicit_moment_arm(const struct brunt_implicit *m, int32_t n, double x[3]);
// A force on node n over the step, to a boundary's account: as impulses are weighed, and as work is.
typedef struct brunt_weighed_force {
    double impulse[3], work[3]; // [N]
} brunt_weighed_force;
void brunt_implicit_account_force(const struct brunt_implicit *m, brunt_impulse_account *last, int32_t n,
                                  const brunt_weighed_force *F);
