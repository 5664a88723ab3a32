// A finite-element body: nodes, elements in blocks, the material at their points.
//
// Total Lagrangian with one point per element: F comes from where the nodes are and were at the start, so that stress
// of a hyperelastic material has no history and a rigid motion, however long, leaves none. Materials see F, and dt L =
// F F_old^-1 - I; they give Kirchhoff stress tau, and the forces are f_a = -V0 tau F^-T dN_a/dX.
//
// Elements are sorted along a space-filling order and cut into blocks. A block gathers its nodes into a local copy,
// sums the forces of its elements there, and writes them to its own stretch of `partial`; a node then sums its partial
// forces in block order. No colours, no locks, and the same bits for any number of threads.
#pragma once

#include "fem/element.h"
#include "materials/prepared.h"

enum { BRUNT_FEM_NODE_REALS = 8 }; // x y z m vx vy vz -, so that a node is one cache line
enum { BRUNT_FEM_X = 0, BRUNT_FEM_MASS = 3, BRUNT_FEM_V = 4 };
enum { BRUNT_FEM_TILE = 64 }; // elements that go through kinematics, material and forces at a time, in the cache

// name, unit, components as a function of the dimension, kept only when
#define BRUNT_ELEMENT_FIELDS(X)                                                                                        \
    X(deformation_gradient, "1", BRUNT_MATRIX, true)                                                                   \
    X(kirchhoff_stress, "Pa", BRUNT_SYMMETRIC, true)                                                                   \
    X(reference_volume, "m^3", BRUNT_ONE, true)                                                                        \
    X(thickness_stretch, "1", BRUNT_ONE, needs->membrane) /* of membranes, across the membrane */                      \
    X(density_scale, "1", BRUNT_ONE, needs->mass_scaling) /* factor of mass scaling on the density */                  \
    X(hourglass_rate, "1/s", BRUNT_HOURGLASS_RATES, needs->viscous_hourglass) /* of the last step, for its work */
#define BRUNT_ONE(dim) 1
#define BRUNT_HOURGLASS_RATES(dim) ((dim) == 3 ? 12 : 2)

enum {
#define BRUNT_ELEMENT_FIELD_INDEX(name, unit, components, when) BRUNT_ELEMENT_##name,
    BRUNT_ELEMENT_FIELDS(BRUNT_ELEMENT_FIELD_INDEX)
#undef BRUNT_ELEMENT_FIELD_INDEX
        BRUNT_ELEMENT_BASE_FIELDS,
    BRUNT_ELEMENT_MAX_FIELDS = BRUNT_ELEMENT_BASE_FIELDS + 4 * 8,
    BRUNT_ELEMENT_MAX_SCALARS = 96
};

typedef struct brunt_element_field {
    const char *name, *unit;
    int first, components;    // scalars first .. first+components-1; components 0: not kept
    const brunt_model *model; // NULL for base fields
    int state;                // index in the model's state table
} brunt_element_field;

typedef struct brunt_fem_block {
    int32_t first, count; // element slots; first is a multiple of BRUNT_LANES, count that of the real elements
    int32_t node_first, node_count; // its nodes in block_node, and its stretch of `partial`
    real length;                    // [m] cube root of the mean volume (2D: square root): for artificial viscosity
} brunt_fem_block;

// What the elements of a block report of a step; combined over the blocks in their order.
struct brunt_fem_report {
    double stress_work; // [J] of the new internal forces, hourglass included, over the step just made: dt sum f . v,
                        // sign of V0 P : dF (positive when energy is stored)
    double hourglass_stored; // [J] in the springs of the stiffness form, now
    double hourglass_lost;   // [J] taken by the dampers of the viscous form in the step just made: trapezoidal, both
                             // steps' rates
    double stable_step; // [s] least of the block (see element.inc), with the wave speeds of this step; with dt 0 of the
                        // undeformed material, or of the step before
    real wave_speed;    // [m/s] greatest of the step; 0 before the first
    bool failed;        // the material of an element has failed
    int32_t marked;     // of bodies that erode: elements with a mark (see brunt_fem_body)
    int32_t bad;        // slot of an element whose update failed, -1
    const char *reason;
};

typedef enum brunt_fem_mark {
    BRUNT_MARK_NONE,
    BRUNT_MARK_INVERTED, // the last step would have turned it inside out: set by the kernels
    BRUNT_MARK_FAILED,
    BRUNT_MARK_STRAINED,
    BRUNT_MARK_SHORT
} brunt_fem_mark;

// The mass of a node that has left its body with its last element: the smallest there is, so that neither the kick nor
// sums need to know. Such a node is at rest and stays where it was.
#ifdef BRUNT_FLOAT
#define BRUNT_FEM_NO_MASS 1.17549435e-38f
#else
#define BRUNT_FEM_NO_MASS 2.2250738585072014e-308
#endif

struct brunt_fem_body {
    char name[BRUNT_NAME_LENGTH];
    int index;      // among all bodies, in order of name
    int dim;        // of the room the nodes are in
    int point_dim;  // of the material's points: 2 for membranes (F is then the stretch U in the plane, see material.h);
                    // 3 for rings about an axis (r, z, hoop: F_rt, F_zt, F_tr, F_tz are 0)
    real thickness; // [m] of membranes, undeformed; 0 of others
    real contact_thickness; // [m] of membranes, as contact sees it; 0 of others
    double damping;         // [1/s] of the mass
    double damping_mass;    // [-] of a kick: mass that impulses of contact and holders meet, over that of the node; 1
                            // without damping
    const brunt_element *element;
    const brunt_element_traits *traits; // the element's
    brunt_element_kind kind;
    brunt_material material;
    brunt_hourglass hourglass;
    real hourglass_coefficient;
    real hourglass_norm;    // [-] >= 1: greatest, over the elements, stiffness of a mode over that in an undistorted
                            // element
    real hourglass_overlap; // [-] 0..1: greatest squared cosine between hourglass and strain modes, 0 for
                            // parallelepipeds
    real lateral_ratio;     // [-] lambda / (lambda + 2 mu) of the undeformed material: lateral over axial stress in
                            // uniaxial strain

    int32_t node_count;
    real *node;       // node_count x BRUNT_FEM_NODE_REALS, in an order that keeps blocks together
    real *start;      // node_count x 4: X Y Z 0, at the start
    int32_t *node_id; // of each node: its number in the mesh
    uint8_t *held;    // of each node: bit a set when component a is prescribed; NULL when nothing is
    real *load;       // node_count x 4 [N] external forces on nodes of this step (traction, pressure); NULL when none

    int32_t element_count, slots; // real elements (of now), places with padding: each block is filled to whole vectors
                                  // with copies of its last element that have volume 0 and exert no force
    int32_t *element_id;          // of each slot: its number in the mesh, -1 for padding
    int32_t *element_node;        // slots x traits->nodes: node numbers (of this body)
    uint16_t *local;              // slots x traits->nodes: place among the nodes of the block
    int field_count;
    brunt_element_field field[BRUNT_ELEMENT_MAX_FIELDS];
    int scalar_count;
    real *scalar[BRUNT_ELEMENT_MAX_SCALARS]; // slots each
    void *slab;
    size_t slab_bytes;

    int32_t block_count;
    brunt_fem_block *block;
    int32_t *block_node; // nodes of the blocks, one block after the other
    int32_t block_nodes; // most that a block has, rounded up to a multiple of 4
    int32_t partial_count;
    real *partial;                       // partial_count x 4 [N]: internal forces (of the step to come) by block
    int32_t *partial_first, *partial_of; // of node n: partial_of[partial_first[n] .. partial_first[n + 1])
    brunt_fem_report *report;            // a block each

    // Of bodies that erode, else NULL and 0.
    int32_t *bonds;        // of each node: how many elements it still has; 0: it is detached
    bool erodes_inverted;  // an element that would turn inside out keeps its last state and is marked instead
    uint8_t *mark;         // of each slot: why its element is to leave (brunt_fem_mark)
    int32_t mesh_elements; // elements at the start
    int32_t *rank; // of each element of the mesh: its place among those that are left, by their numbers; for readers
    bool ranked;   // `rank` is up to date
    brunt_group *groups;
    int32_t group_count;     // the mesh's, in this body's node numbers
    double added_mass;       // [kg] by mass scaling
    int32_t scaled_elements; // how many got some
    double mean_edge;        // [m] of the surface at the start
    double scaled_edge;      // [m] where mass scaling acts: the longest edge in which a wave of the unscaled material
                             // takes as long as in a scaled element (its mean edge); 0: nowhere
    double least_step;       // [s] stable step of the undeformed mesh
    bool fold_told;          // a warning has said that elements are folded
    real time;               // [s] at the end of the step, for materials that burn
};

// Makes a body of a mesh that brunt_mesh_check accepts. Nodes are placed by the definition's placement, at rest; stress
// and state are those of new material. BRUNT_BAD_INPUT or BRUNT_FAILED (memory).
int brunt_fem_make(const brunt_body_def *def, const brunt_material *material, int dim, const brunt_mesh *mesh,
                   brunt_fem_body *body, brunt_error *error);
// The same of a mesh of triangles or quadrilaterals in x = r and y = z that is revolved about the axis x = 0: rings
// with masses and forces of the whole circle. Nodes on the axis are held there (`held`).
int brunt_fem_make_axisymmetric(const brunt_body_def *def, const brunt_material *material, const brunt_mesh *mesh,
                                brunt_fem_body *body, brunt_error *error);
// Shares of an element's reference volume that its nodes have of its mass [m^3]; 0 of padding.
void brunt_fem_shares(const brunt_fem_body *body, int32_t slot, double *share);
void brunt_fem_free(brunt_fem_body *body);
size_t brunt_fem_bytes(const brunt_fem_body *body);

// --- stable_step.c: the least of the steps that its blocks last reported [s]; INFINITY: there is none, NAN: one is
// none.
double brunt_fem_blocks_step(const brunt_fem_body *body);

// --- validate.c: aborts where elements, blocks and nodes do not belong together. Every step in debug builds.
void brunt_fem_validate(const brunt_fem_body *body);

// --- erosion.c
// What a body needs to lose elements: bonds, marks, ranks.
int brunt_fem_prepare_erosion(brunt_fem_body *body, bool inverted, brunt_error *error);
// Takes `count` elements out, given by ascending slots: the last element of a block moves into the gap, so that others
// change their slots; element_count, bonds, marks and the padding follow. Forces and reports of their blocks are made
// anew (dt 0). Nodes are left alone.
void brunt_fem_remove(brunt_fem_body *body, const int32_t *slots, int32_t count, brunt_fem_workspace *work);
// Elements of a saved state by their slots, brunt_fem_elements_count numbers: first the mesh's number of each (-1:
// none), then their nodes. `set` makes of them all that follows from them but the forces. BRUNT_OK, or BRUNT_BAD_INPUT:
// they are not of this body.
int64_t brunt_fem_elements_count(const brunt_fem_body *body);
void brunt_fem_elements_get(const brunt_fem_body *body, int64_t *out);
int brunt_fem_elements_set(brunt_fem_body *body, const int64_t *in, brunt_error *error);
// Brings `rank` up to date.
void brunt_fem_ranks(brunt_fem_body *body);
// Something resists the zero-energy modes of the body's elements.
static inline bool brunt_fem_has_hourglass(const brunt_fem_body *body) {
    return body->element->hourglass_modes && body->hourglass_coefficient > 0;
}
// The node has left with its last element.
static inline bool brunt_fem_removed(const brunt_fem_body *body, int32_t node) {
    return body->bonds && !body->bonds[node] &&
           body->node[(size_t)node * BRUNT_FEM_NODE_REALS + BRUNT_FEM_MASS] == (real)BRUNT_FEM_NO_MASS;
}
// Equivalent logarithmic strain of the elements of a block (materials/log_strain.h): marks those at which it is `limit`
// or more.
void brunt_fem_mark_strained(brunt_fem_body *body, int32_t block, double limit);
// -dt sum f . v of a block with its forces and velocities as they are [J]: stress_work of its report.
double brunt_fem_stress_work(const brunt_fem_body *body, int32_t block, double dt);

// One element of a body as a body of its own, so that what the kernels say of blocks can be had of single elements.
typedef struct brunt_fem_single brunt_fem_single;
brunt_fem_single *brunt_fem_single_make(const brunt_fem_body *body); // NULL: out of memory
void brunt_fem_single_free(brunt_fem_single *single);
typedef struct brunt_fem_share {
    brunt_point_energy energy; // [J] of the material
    double hourglass_stored;   // [J]
    double half_work;          // [J] -dt/2 sum f . v
    double stable_step;        // [s] with the greatest wave speed of its block
} brunt_fem_share;
// Element `slot` with its nodes moved back by `back` times their velocities [s]; `dt` is that of half_work.
brunt_fem_share brunt_fem_single_look(brunt_fem_single *single, const brunt_fem_body *body, int32_t slot, double back,
                                      double dt, brunt_fem_workspace *work);

struct brunt_fem_workspace {
    real *memory;
    size_t capacity;
}; // of a thread, for any body
int brunt_fem_workspace_fit(brunt_fem_workspace *work, const brunt_fem_body *body,
                            brunt_error *error);         // BRUNT_OK, or BRUNT_FAILED
size_t brunt_fem_tile_reals(const brunt_fem_body *body); // of it, what a tile takes; states that are kept follow
void brunt_fem_workspace_free(brunt_fem_workspace *work);

static inline real **brunt_element_scalars(brunt_fem_body *body, int field) {
    return body->scalar + body->field[field].first;
}
static inline real *brunt_fem_node(const brunt_fem_body *body, int32_t node) {
    return body->node + (size_t)node * BRUNT_FEM_NODE_REALS;
}

// Views element slots `first` .. `first + count - 1` (count a multiple of BRUNT_LANES) as the points of a component.
brunt_material_points brunt_fem_points(brunt_fem_body *body, brunt_component component, int64_t first, int32_t count);
// How many elements have a corner that is turned inside out now, the mean Jacobian still being positive. One-point
// elements go on with that, since the mean is all they see; it says that the mesh is too coarse for what happens. For
// output, not for each step.
int32_t brunt_fem_folded(const brunt_fem_body *body);
// Cauchy stress of a membrane's element [Pa] in global axes, XX YY ZZ XY YZ XZ, from where its nodes are now and its
// stretch and Kirchhoff stress: none across the membrane. The area that stress acts on has `thickness` times the
// stretch across.
void brunt_membrane_stress(const brunt_fem_body *body, int32_t slot, double sigma[6]);
// Stored and dissipated energy of the elements of blocks [begin, end) [J], without the hourglass modes.
brunt_point_energy brunt_fem_energy(brunt_fem_body *body, int32_t begin, int32_t end);
// Internal force on a node [N], from the partial forces.
static inline void brunt_fem_internal_force(const brunt_fem_body *body, int32_t node, real force[3]) {
    force[0] = force[1] = force[2] = 0;
    for (int32_t k = body->partial_first[node]; k < body->partial_first[node + 1]; k++) {
        const real *p = body->partial + (size_t)body->partial_of[k] * 4;
        for (int a = 0; a < 3; a++) force[a] += p[a];
    }
}

// Nodes of a group or a surface, and what is summed up for them, are anywhere in their body: fetched for a later call.
static inline void brunt_fem_fetch_force(const brunt_fem_body *body, int32_t node) {
    for (int32_t k = body->partial_first[node]; k < body->partial_first[node + 1]; k++)
        __builtin_prefetch(body->partial + (size_t)body->partial_of[k] * 4);
}

// Sums over a run of nodes, added up in order by the caller (over runs whose bounds do not depend on the threads). Of a
// step v -> v_new (kick, and what contact and boundaries then change), x -> x + dt v_new (drift):
//   work of gravity g       dt g . (momentum_old + momentum) / 2         impulse dt mass g, angular dt first_moment x g
// first_moment is at the start of the step, where the forces act. What loads do is recorded by whoever makes them.
typedef struct brunt_fem_sums {
    // by kick, at the velocities before it
    double momentum_old[3]; // [kg m/s] sum m v
    // by drift
    double mass, first_moment[3];       // [kg], [kg m] sum m x, before the move
    double momentum[3], kinetic;        // sum m v_new, sum m v_new^2 / 2
    double angular[3];                  // [kg m^2/s] about the origin, after the move
    double scale_linear, scale_angular; // sums of magnitudes m |v|, m |x| |v|, after the move
    double speed;                       // [m/s] greatest
} brunt_fem_sums;

// Changes the velocities of nodes [begin, end) by dt (f / m + gravity), f the internal and external forces. Fills its
// part of `sums`, zeroes the rest. Prescribed components are changed like others: whoever prescribes sets them
// afterwards.
void brunt_fem_kick(brunt_fem_body *body, int32_t begin, int32_t end, double dt, const double gravity[3],
                    brunt_fem_sums *sums);
// Moves nodes [begin, end) by dt v. Fills its part of `sums`, leaves the rest.
void brunt_fem_drift(brunt_fem_body *body, int32_t begin, int32_t end, double dt, brunt_fem_sums *sums);
// The sums of nodes [begin, end) as they are: mass, momenta, kinetic energy.
brunt_fem_sums brunt_fem_audit(brunt_fem_body *body, int32_t begin, int32_t end);

// The faces of a body's surface: those that only one element has. Nodes (of this body) as in brunt_element.face, the
// 4th is -1 for triangles, 3rd and 4th for 2D; `element` is a slot. Ordered by slot and face. Of a membrane, each of
// its elements is one face, with its own order of nodes.
typedef struct brunt_faces {
    int32_t count;
    int32_t (*node)[4];
    int32_t *element;
} brunt_faces;
int brunt_fem_faces(const brunt_fem_body *body, brunt_faces *faces, brunt_error *error);
void brunt_faces_free(brunt_faces *faces);
