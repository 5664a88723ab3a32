// The definition of a world: plain structures. brunt_world_def_default fills one first, so that a field added later
// keeps a sensible value.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "brunt/body.h"
#include "brunt/boundary.h"
#include "brunt/material.h"

#ifdef __cplusplus
extern "C" {
#endif

// Time integration: central differences; steps that minimise an energy; load steps from one equilibrium to the next, in
// a pseudo-time that runs from 0 to 1.
typedef enum brunt_scheme { BRUNT_EXPLICIT, BRUNT_IMPLICIT, BRUNT_STATIC } brunt_scheme;
// Whether its steps minimise an energy, by Newton's method.
static inline bool brunt_scheme_minimises(brunt_scheme scheme) {
    return scheme == BRUNT_IMPLICIT || scheme == BRUNT_STATIC;
}
// Of implicit steps: backward Euler (first order, dissipates), Newmark with gamma 1/2 and beta 1/4 (second order).
typedef enum brunt_integrator { BRUNT_EULER, BRUNT_NEWMARK } brunt_integrator;
// Where load steps with prescribed motion begin: where the tangent at the last equilibrium takes all that follows it,
// or where that was, with what is moved alone at its place.
typedef enum brunt_predictor { BRUNT_PREDICTOR_TANGENT, BRUNT_PREDICTOR_NONE } brunt_predictor;
// Of the linear systems of implicit steps: by size and step, a factorisation, conjugate gradients, these by products of
// bodies in place of a matrix.
typedef enum brunt_solver {
    BRUNT_SOLVER_AUTO,
    BRUNT_SOLVER_DIRECT,
    BRUNT_SOLVER_PCG,
    BRUNT_SOLVER_MATRIX_FREE
} brunt_solver;
// Whether it is conjugate gradients that are asked for: matrices have to be symmetric, and there are no factors.
static inline bool brunt_solver_iterates(brunt_solver solver) {
    return solver == BRUNT_SOLVER_PCG || solver == BRUNT_SOLVER_MATRIX_FREE;
}

// Newton's method in implicit steps.
typedef struct brunt_newton_def {
    double tolerance;    // [-] > 0; implicit: of the slowest wave speed: a step has converged when its last correction
                         // moves no material point and no node of a mesh faster than that; static: of the forces that
                         // act (loads or reactions, the sum of their sizes), what is left unbalanced; default 1e-6
    int iterations;      // >= 1: most of a step; default 100
    int cut;             // >= 0: most halvings of a step that does not converge (static: of a load step); default 6
    brunt_solver solver; // default auto
    double accuracy;     // [-] between 0 and 1 (neither), of the residual of a linear system, of conjugate gradients;
                         // default 1e-3
} brunt_newton_def;

// B-splines of the grid, by order.
typedef enum brunt_cells {
    BRUNT_QUADS,     // hexahedra in three dimensions
    BRUNT_TRIANGLES, // each cell is cut in two by its diagonal
    BRUNT_MESH_CELLS // triangles of a mesh, beyond which no material point may come
} brunt_cells;
typedef enum brunt_kernel { BRUNT_LINEAR = 1, BRUNT_QUADRATIC = 2, BRUNT_CUBIC = 3 } brunt_kernel;
// PIC: Harlow 1964, "The particle-in-cell computing method for fluid dynamics". FLIP: Brackbill and Ruppel 1986, "FLIP:
// a method for adaptively zoned, particle-in-cell calculations of fluid flows in two dimensions"; points keep a share
// of their own velocity, and PIC's has the rest (Zhu and Bridson 2005, "Animating sand as a fluid"). `flip` of it is
// left after the time cell / 2c, c the wave speed of the undeformed material; in implicit steps, which take many of
// these, after a step, as in explicit ones with `flip_per_step` (what it was one version ago). APIC: Jiang, Schroeder,
// Selle, Teran and Stomakhin 2015, "The affine particle-in-cell method"; of what the grid does not see of their
// velocity and affine field, points keep a share, of which `apic` is left after the time cell / 2c, c the wave speed of
// the undeformed material. (Above 0: explicit steps, not linear, cfl <= 0.9.)
typedef enum brunt_transfer { BRUNT_PIC, BRUNT_FLIP, BRUNT_APIC } brunt_transfer;

// Tied: bodies of material points share one velocity field at the grid nodes that both reach, in both directions: they
// neither part nor slide (what material-point codes without contact do).
// Multi-velocity: at nodes that two bodies reach (Bardenhagen, Brackbill and Sulsky 2000). Barrier: of implicit steps,
// an energy that grows without end as gaps close (Li and others 2020). With the words of scenes.
#define BRUNT_CONTACT_METHODS(X)                                                                                       \
    X(NONE, "none")                                                                                                    \
    X(MULTI_VELOCITY, "multi-velocity")                                                                                \
    X(AUGURY, "augury")                                                                                                \
    X(TIED, "tied")                                                                                                    \
    X(BARRIER, "barrier")                                                                                              \
    X(PENALTY, "penalty")
#define BRUNT_CONTACT_VALUE(name, word) BRUNT_CONTACT_##name,
typedef enum brunt_contact_method { BRUNT_CONTACT_METHODS(BRUNT_CONTACT_VALUE) } brunt_contact_method;
#undef BRUNT_CONTACT_VALUE
// How augury makes the velocity that opposing bodies are to have where they meet, with the words of scenes. Node to
// facet: velocity and gap from the same facing facet, extended affinely; reaction by the transpose. Averaged facets:
// the same from facets averaged on the grid. Averaged surface: velocities averaged on the grid, gap to the averaged
// facing surface. Published: grid transfers and augury iterations as published.
#define BRUNT_AUGURY_FORMS(X)                                                                                          \
    X(NODE_TO_FACET, "node_to_facet")                                                                                  \
    X(AVERAGED_FACETS, "averaged_facets")                                                                              \
    X(AVERAGED_SURFACE, "averaged_surface")                                                                            \
    X(PUBLISHED, "published")
#define BRUNT_AUGURY_VALUE(name, word) BRUNT_AUGURY_##name,
typedef enum brunt_augury_form { BRUNT_AUGURY_FORMS(BRUNT_AUGURY_VALUE) } brunt_augury_form;
#undef BRUNT_AUGURY_VALUE

// What becomes of the energy that the touch of a node of a mesh takes: it gets it back when it is released, or it is
// lost. Of node to facet.
typedef enum brunt_touch_kind { BRUNT_TOUCH_ELASTIC, BRUNT_TOUCH_INELASTIC } brunt_touch_kind;

// How material points are stopped by boundaries and facets, and by those of other bodies where surfaces meet: within a
// step, at zero gap, or by springs that the overlap pushes in. Of explicit steps.
typedef enum brunt_stop_kind { BRUNT_STOP_HARD, BRUNT_STOP_SPRING } brunt_stop_kind;

// What penalties see of a mesh: its facets and their nodes, or (2D) curves through the nodes of its rim, and points on
// those between the nodes.
typedef enum brunt_surface_kind { BRUNT_SURFACE_FACETS, BRUNT_SURFACE_ARCS } brunt_surface_kind;

// Whose nodes are held off the other's facets: those of both bodies, or of the first alone, the slave, at half the
// cost: the second's nodes then pass between its nodes. Of node to facet.
typedef enum brunt_contact_sides { BRUNT_SIDES_BOTH, BRUNT_SIDES_SLAVE } brunt_contact_sides;

// Of two bodies; with both names the same, of a membrane with itself, which is not in contact unless it is asked for.
typedef struct brunt_pair_def {
    char a[BRUNT_NAME_LENGTH], b[BRUNT_NAME_LENGTH];
    brunt_contact_method method;
    double friction;           // [-] >= 0
    brunt_contact_sides sides; // of two meshes; default both
} brunt_pair_def;

typedef struct brunt_contact_def {
    brunt_contact_method method; // default: multi-velocity
    double friction;             // [-] >= 0, Coulomb; default 0
    brunt_augury_form form;      // of augury; default node to facet
    int iterations; // >= 0: most sweeps of a step, or N of the published form; -1 (default) = the method's own: augury
                    // 16 (64 where there are membranes), 4, 4, 1 by form; multi-velocity of a mesh with material points
                    // 8
    double tolerance; // [-] 0..1 (not 1): sweeps end when the greatest correction of one is no more than this share of
                      // the first one's; 0: when nothing changes, or by `iterations`; of node to facet; default 0.01
    double cell;      // [m] >= 0 of the contact grid; 0 (default) = the mean surface edge (published: twice that)
    brunt_transfer transfer; // of the published form: BRUNT_PIC or BRUNT_APIC (default)
    brunt_touch_kind touch;  // of node to facet; default elastic
    brunt_stop_kind stop;    // of material points; default hard
    // Of barriers and penalties.
    double distance;  // [m] >= 0: gaps beyond it know nothing of each other; 0 (default) = a tenth of the shortest edge
                      // or spacing of particles, of penalties nothing: surfaces push where they overlap
    double penalty;   // [Pa/m] >= 0 pressure by overlap of penalties; 0 (default) = 20 E* / a of each pair (penalty.c)
    double stiffness; // [Pa] >= 0 of the barrier; 0 (default) = a tenth of Young's modulus of the softer body of a pair
    double slip_speed;  // [m/s] >= 0: below it friction grows with the speed; 0 (default) = 1e-5 of the slowest wave
                        // speed
    double slip_length; // [m] >= 0 of load steps: surfaces that rub give by up to that, then they slip; 0 (default) = a
                        // hundredth of the distance
    brunt_surface_kind surface; // of penalties; default facets
    int friction_iterations; // >= 1: solutions of a step at most, each with the pressures of the one before; default 1
    bool allow_overlap;    // accept bodies that overlap at the start (meshes: by more than a fifth of an edge), or lie
                           // behind a plane of condition separate; default false: an error
    brunt_pair_def *pairs; // what holds of two bodies instead of the above
    int32_t pair_count;    // owned; overrides
} brunt_contact_def;

#define BRUNT_BOUNDARY_LIST(NAME, kind, type, word, what)                                                              \
    type##_def *kind##s;                                                                                               \
    int32_t kind##_count;

typedef struct brunt_world_def {
    int cookie;                  // set by brunt_world_def_default
    brunt_scheme scheme;         // default explicit
    brunt_integrator integrator; // of implicit steps; default Euler
    brunt_newton_def newton;     // of implicit steps
    int dimension;               // 2 or 3: 3 (default), or 2 = plane strain of unit thickness
    bool axisymmetric; // with dimension 2: x is the distance r >= 0 from the axis of revolution, y along it; bodies are
                       // whole rings: masses, forces and energies are those of the full circle; default false
    double cell;       // [m] > 0 of the grid; 0 where no body is of material points
    double origin[3];  // [m] where a grid node lies; default 0
    brunt_kernel kernel;     // default quadratic
    brunt_cells cells;       // default quads; others: implicit and static in two dimensions, linear, not with APIC
    brunt_mesh background;   // of BRUNT_TRI3, for BRUNT_MESH_CELLS; owned
    brunt_transfer transfer; // default APIC
    double flip;             // [-] for FLIP: share of the particle's own velocity kept over a time cell / 2c, 0..1;
                             // default 0.99; of implicit steps, over a step
    bool flip_per_step;      // `flip` is over a step, explicit ones too; default false
    double apic;             // [-] for APIC: share kept over a time cell / 2c, 0..0.98; default 0
    double cfl;     // [-] 0..1, of the stable step; default 0: with material points brunt_default_cfl, without 0.5
    double step;    // [s] fixed time step, 0 = from cfl; implicit steps: > 0; static: not used
    int load_steps; // static: >= 1, in which loads and prescribed motion grow
    brunt_predictor predictor; // static; default tangent
    double least_step;         // [s] the run stops, with the reason, when the stable step falls below it; default 0:
                               // when steps that follow it fall below a millionth of the greatest so far; >= 0
    double end;                // [s] > 0; the step that would pass it is cut to end on it; static: 0 or 1, it is 1
    double energy_limit;       // [-] > 0, of the energy `reference` (see brunt_energy); default 0.1; INFINITY = none
    int threads;               // 0 = all there are; at most BRUNT_THREAD_LIMIT
    brunt_material_def *materials;
    int32_t material_count; // owned
    brunt_body_def *bodies;
    int32_t body_count;                       // owned
    BRUNT_BOUNDARY_KINDS(BRUNT_BOUNDARY_LIST) // planes and plane_count, ...: owned
    brunt_boundary_def *boundaries;           // of kinds that list their keys
    int32_t boundary_count;                   // owned
    brunt_detonation_def *detonations;
    int32_t detonation_count; // owned
    brunt_contact_def contact;
    double gravity[3];   // [m/s^2] default 0
    double gravity_ramp; // [s] >= 0: gravity grows linearly from 0 over it; default 0; static: over all load steps
} brunt_world_def;
#undef BRUNT_BOUNDARY_LIST

// With every default that is given above; what has none is not set.
brunt_world_def brunt_world_def_default(void);
// The share of the stable step that is taken when none is given: 0.5, or less where material points alone in their
// cells would gain energy: 0.4 in three dimensions with the quadratic kernel and PIC or FLIP.
double brunt_default_cfl(int dimension, brunt_kernel kernel, brunt_transfer transfer);
// The share up to which points that hold together, one a cell or more, gain no energy; 0: not known (linear kernel).
double brunt_together_cfl(int dimension, brunt_kernel kernel, brunt_transfer transfer);

// Zeroed memory for the arrays and shapes a definition owns, so that brunt_world_def_free can free them. NULL: out of
// memory.
void *brunt_def_alloc(size_t bytes);
void brunt_world_def_free(brunt_world_def *def); // frees all that the definition owns

#ifdef __cplusplus
}
#endif
