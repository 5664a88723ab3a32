// What the elastic models without state share: two parameters, their constants, and the loop over dimension.
#pragma once

#include "materials/tensor.h"

// PLANE: E / (1 - nu^2), the longitudinal modulus of a membrane in plane stress.
enum { ELASTIC_LAMBDA, ELASTIC_MU, ELASTIC_INVERSE_DENSITY, ELASTIC_NU, ELASTIC_PLANE };

static const brunt_parameter elastic_parameters[] = {PARAMETER_E, PARAMETER_NU};

static inline const char *elastic_prepare(const double *parameters, double density, bool with_eos, real *constants) {
    if (with_eos) return "this model gives its own pressure and takes no equation of state";
    constants[ELASTIC_LAMBDA] = (real)lame_lambda(parameters[0], parameters[1]);
    constants[ELASTIC_MU] = (real)shear_modulus(parameters[0], parameters[1]);
    constants[ELASTIC_INVERSE_DENSITY] = (real)(1 / density);
    constants[ELASTIC_NU] = (real)parameters[1];
    constants[ELASTIC_PLANE] = (real)(parameters[0] / (1 - parameters[1] * parameters[1]));
    return NULL;
}

static inline real elastic_wave_speed(const real *constants) {
    double modulus = (double)constants[ELASTIC_LAMBDA] + 2 * (double)constants[ELASTIC_MU];
    return (real)sqrt(modulus * (double)constants[ELASTIC_INVERSE_DENSITY]);
}

BRUNT_INLINE void store_stress(int dim, const brunt_material_points *points, int32_t i, const lanes tau[6]) {
    for (int k = 0; k < BRUNT_SYMMETRIC(dim); k++) lanes_store(points->stress[k] + i, tau[k]);
}
