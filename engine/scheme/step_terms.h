// The terms of an implicit step that are of no body and no contact: inertia or what stands for it in load steps, loads
// that do not follow what they act on, drag, and what draws prescribed motion to its end.
#pragma once

#include "linear/term.h"
#include "scheme/unknowns.h"

// 1/(2c) sum m |u - aim|^2: what moves wants to go on. c = 2 alpha beta dt^2.
typedef struct brunt_inertia {
    const brunt_unknowns *unknowns;
    const double *aim; // [m] displacement without forces
    double c;          // [s^2]
} brunt_inertia;

// What keeps a body from rigid motion: nothing, contact alone, or conditions on its nodes.
typedef enum brunt_support { BRUNT_UNSUPPORTED, BRUNT_BORNE, BRUNT_GROUNDED } brunt_support;

// 1/2 sum w |u - iterate|^2 about each iterate of a load step: a step of Newton's method stays near where it begins,
// what nothing holds does not fly away, and where it ends is the same.
typedef struct brunt_proximal {
    const brunt_unknowns *unknowns;
    const double *stiffness;                  // [N/m] of nodes
    const uint8_t *support;                   // of nodes, brunt_support
    double share[BRUNT_GROUNDED], everywhere; // [-] of the stiffness: by support, of all grid nodes
} brunt_proximal;

// How large forces are of which load steps leave a part unbalanced.
typedef struct brunt_load_scale {
    double least;    // [N] of forces: of those within bodies at the start, loads at the end, or what pushes
    double rounding; // [N] that rounding of places makes
    double left;     // [N] at the last place: 0 at first
    int stalled;     // iterations in a row that have lessened it by next to nothing
} brunt_load_scale;

// -sum f . u.
typedef struct brunt_dead_loads {
    const brunt_unknowns *unknowns;
    const double *force; // [N] of each component
} brunt_dead_loads;

// 1/2 sum w slope |u - rest|^2 over nodes that are damped: a force of -w v at the end of the step, whose velocity is
// v = slope (u - rest).
typedef struct brunt_drag {
    const brunt_unknowns *unknowns;
    const double *weight; // [kg/s] of each node, damping times mass; NULL: no body is damped
    const double *rest;   // [m] of each component: the displacement at whose end it is at rest
    double slope;         // [1/s] gamma dt / c
} brunt_drag;

// 1/2 sum w (u - target)^2 over components of weight: what is on its way to a place that is given.
typedef struct brunt_pull {
    const brunt_unknowns *unknowns;
    const double *weight; // [N/m] of each component; NULL: nothing is pulled
} brunt_pull;

extern const brunt_term_ops brunt_inertia_ops, brunt_proximal_ops, brunt_dead_load_ops, brunt_drag_ops, brunt_pull_ops;

// Sums over nodes that are the same for any number of threads: `add` takes the nodes of a stretch.
typedef brunt_energy_sum brunt_stretch_fn(const void *context, int32_t begin, int32_t end);
brunt_energy_sum brunt_sum_nodes(const brunt_team *team, int32_t count, brunt_stretch_fn *add, const void *context);
