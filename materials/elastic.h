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

// c^2 of the fastest wave [m^2/s^2] and tau, from H, J - 1 and B.
typedef lanes elastic_law(int dim, const real *k, const lanes H[9], lanes change, const lanes B[6], lanes tau[6]);

// Stored per reference volume [J/m^3].
typedef lanes elastic_density(int dim, const real *k, const lanes H[9]);

BRUNT_INLINE brunt_update_result elastic_update(int dim, elastic_law *law, const real *k,
                                                const brunt_material_points *points) {
    update_record record = update_begin();
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9], B[6], tau[6];
        load_displacement_gradient(dim, points, i, H);
        lanes change = volume_change(dim, H);
        note_deformation(&record, 1 + change, i);
        finger_strain(dim, H, B);
        lanes speed_squared = law(dim, k, H, change, B, tau);
        store_stress(dim, points, i, tau);
        note_speed(&record, speed_squared);
    }
    return update_end(&record, points, NULL);
}

BRUNT_INLINE void elastic_energy(int dim, elastic_density *density, const real *k, const brunt_material_points *points,
                                 brunt_point_energy *energy) {
    lane_total stored = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        total_add(&stored, lanes_load(points->volume + i) * density(dim, k, H));
    }
    energy->internal += total_end(&stored);
}

// A model's functions from its elastic_law and elastic_density, and its table from them.
#define ELASTIC_FUNCTIONS(law, density)                                                                                \
    static brunt_update_result update(const real *constants, const brunt_material_points *points) {                    \
        return points->dim == 2 ? elastic_update(2, law, constants, points)                                            \
                                : elastic_update(3, law, constants, points);                                           \
    }                                                                                                                  \
    static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {   \
        if (points->dim == 2)                                                                                          \
            elastic_energy(2, density, constants, points, energy);                                                     \
        else                                                                                                           \
            elastic_energy(3, density, constants, points, energy);                                                     \
    }
#define ELASTIC_MODEL                                                                                                  \
    .parameters = elastic_parameters, .parameter_count = BRUNT_COUNT(elastic_parameters), .prepare = elastic_prepare,  \
    .update = update, .energy = add_energy, .wave_speed = elastic_wave_speed
