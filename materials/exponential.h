// What is left of an exponential without its first terms, for energies whose first terms cancel.
#pragma once

#include "base/simd_math.h"

// phi(z) = e^z - 1 - z: its series up to 1/2, beyond which little is lost to the subtraction.
BRUNT_INLINE lanes exponential_excess(lanes z) {
#ifdef BRUNT_FLOAT
    enum { TERMS = 9 };
#else
    enum { TERMS = 15 };
#endif
    lanes series = lanes_set(1);
    for (int k = TERMS; k > 2; k--) series = 1 + z * series * (real)(1.0 / k);
    lanes value = (real)0.5 * z * z * series;
    lane_mask far = lanes_abs(z) > (real)0.5;
    if (lanes_any(far)) value = lanes_select(far, lanes_exp(z) - 1 - z, value);
    return value;
}
