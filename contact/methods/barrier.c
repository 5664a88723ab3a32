// Method `barrier`, of implicit steps: an energy per area that is 0 from the distance dhat on and grows without bound
// as a gap closes, b(d) = kappa dhat g(d / dhat), g(s) = -(s - 1)^2 ln s for s < 1 (Li et al. 2020; Li, Kaufman and
// Jiang 2023 for the weights). kappa is a pressure [Pa]: b is in J/m^2, -b' is the pressure across the gap.
#include "contact/methods/method.h"

#include <math.h>

brunt_barrier_value brunt_barrier_at(double d, double distance, double stiffness) {
    const double s = d / distance;
    if (s >= 1) return (brunt_barrier_value){0};
    if (!(s > 0)) return (brunt_barrier_value){INFINITY, -INFINITY, INFINITY};
    // 1 - s from the difference: digits are kept where contact begins.
    const double y = (distance - d) / distance, log_s = s > 0.5 ? log1p(-y) : log(s);
    return (brunt_barrier_value){
        .b = -stiffness * distance * y * y * log_s,
        .db = -stiffness * (y * y / s - 2 * y * log_s),
        .ddb = stiffness / distance * (y * (3 + 1 / s) / s - 2 * log_s),
    };
}

static bool any_mesh(bool a, bool b) { return a || b; }

const brunt_contact_row brunt_contact_barrier = {
    .name = "barrier",
    .methods = 1u << BRUNT_CONTACT_BARRIER,
    .schemes = 1u << BRUNT_IMPLICIT | 1u << BRUNT_STATIC,
    .keys = "distance stiffness slip_speed slip_length friction_iterations",
    .self = BRUNT_SELF_MESHES,
    .wants = "a body of method fem",
    .accepts = any_mesh,
    .energy = brunt_barrier_at,
};
