#include "contact/planes/condition.h"

#include <math.h>

#define LEAK "a slip plane that is not on a line of the grid lets fluids in by half a cell; move it, or grid.origin"
#define TEAR                                                                                                           \
    "beside a plane of condition separate the pressure of fluids is wrong in the two nearest rows of particles, and "  \
    "gas at rest tears there; slip on a line of the grid is exact"

const brunt_condition_row brunt_conditions[] = {
    [BRUNT_STICK] = {.sticks = true},
    [BRUNT_SLIP] = {.symmetry = true, .of_fluids = LEAK},
    [BRUNT_SEPARATE] = {.pushes = true, .of_fluids = TEAR},
    [BRUNT_SYMMETRY] = {.symmetry = true, .images = true},
};
const int brunt_condition_count = sizeof brunt_conditions / sizeof *brunt_conditions;

#define ONE(name, word) +1
_Static_assert(sizeof brunt_conditions / sizeof *brunt_conditions == BRUNT_CONDITIONS(ONE), "a row for each condition");

unsigned brunt_condition_components(const brunt_plane_def *plane, int dim) {
    const bool sticks = brunt_conditions[plane->condition].sticks;
    unsigned held = 0;
    for (int a = 0; a < dim; a++)
        if (sticks || fabs(plane->normal[a]) > 1 - 1e-12) held |= 1u << a;
    return held;
}
