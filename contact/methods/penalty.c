// Method `penalty`, of load steps in two dimensions: where two surfaces overlap they push each other by a pressure in
// proportion to how deep they do, p(d) = k (dhat - d) for a gap d below dhat, which is 0 unless a scene wants them to
// push before they touch. k is a pressure by length [Pa/m]. The energy is k / 2 (dhat - d)^2 of the area. Surfaces are
// facets, or round rims (barrier_arcs.c).
#include "contact/methods/method.h"

brunt_barrier_value brunt_penalty_at(double d, double distance, double stiffness) {
    const double deep = distance - d;
    if (!(deep > 0)) return (brunt_barrier_value){0};
    return (brunt_barrier_value){.b = stiffness / 2 * deep * deep, .db = -stiffness * deep, .ddb = stiffness};
}

static bool two_meshes(bool a, bool b) { return a && b; }

const brunt_contact_row brunt_contact_penalty = {
    .name = "penalty",
    .methods = 1u << BRUNT_CONTACT_PENALTY,
    .schemes = 1u << BRUNT_STATIC,
    .keys = "distance penalty slip_length surface",
    .wants = "two bodies of method fem",
    .planar = true,
    .overlaps = true,
    .accepts = two_meshes,
    .energy = brunt_penalty_at,
};
