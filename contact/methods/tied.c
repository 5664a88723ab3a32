// Method `tied`: where two bodies of material points reach a node both get one velocity there, whatever the gap and the
// normal, so that they neither part nor slide.
#include "contact/methods/method.h"

#include <math.h>

static bool points_alone(bool a, bool b) { return !a && !b; }

static double tie(const double v[3], const double inverse[3], double J[3]) {
    double changed = 0;
    for (int k = 0; k < 3; k++) {
        if (!(inverse[k] > 0)) continue;
        J[k] = -v[k] / inverse[k];
        changed = fmax(changed, fabs(v[k]));
    }
    return changed;
}

const brunt_contact_row brunt_contact_tied = {
    .name = "tied",
    .methods = 1u << BRUNT_CONTACT_TIED,
    .schemes = 1u << BRUNT_EXPLICIT | 1u << BRUNT_IMPLICIT | 1u << BRUNT_STATIC,
    .meets = BRUNT_MEET_AT_NODES,
    .wants = "two bodies of method mpm",
    .accepts = points_alone,
    .at_node = tie,
};
