// Points of any material, of which tests are told nothing but the lists: typical parameters, steps, stress and energy.
#pragma once

#include <check.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "base/simd.h"
#include "materials/material.h"
#include "base/memory.h"
#include "tests/support/matrix.h"
#include "tests/support/suite.h"

// ---------------------------------------------------------------------------------------------------- typical
// parameters

// By key or, where models use one key for different things, by model and key; in two variants; NAN: the table's
// default. A parameter without default that is not here fails the tests.
// clang-format off
typedef struct typical { const char *key; double value[2]; } typical;
static const typical typical_values[] = {
    {"E", {117e9, 60e9}},         {"nu", {0.35, 0.2}},
    {"yield", {400e6, 200e6}},    {"hardening", {100e6, 50e6}},
    {"saturation_stress", {NAN, 450e6}}, {"saturation_rate", {NAN, 12}},
    {"A", {90e6, 265e6}},         {"B", {292e6, 426e6}},
    {"n", {0.31, 0.34}},          {"C", {0.025, 0.015}},
    {"m", {1.09, 1}},             {"melt", {1356, 775}},
    {"heat_capacity", {383, 875}}, {"taylor_quinney", {NAN, 1}},
    {"c0", {3940, 5328}},         {"s", {1.489, 1.338}},
    {"gamma0", {1.96, 2.0}},      {"mie-gruneisen.initial_energy", {NAN, NAN}},
    {"tension", {NAN, 5e9}},      {"ideal-gas.initial_energy", {1e9, 3e8}},
    {"gamma", {1.4, 5.0 / 3}},    {"tait.gamma", {NAN, 1}},
    {"dynamic_viscosity", {1e3, 5e4}},
    // A solid and a gas; TNT, of a set that is consistent with the typical density.
    {"C1", {137e9, 0}}, {"C2", {272e9, 0}}, {"C3", {214e9, 0}}, {"C4", {2, 0.4}}, {"C5", {0.5, 0.4}}, {"C6", {-0.3, 0}},
    {"polynomial.initial_energy", {NAN, 1e9}}, {"detonation_speed", {2960, 2944}}, {"jwl.A", {371.2e9, 371.2e9}},
    {"jwl.B", {3.231e9, 3.21e9}}, {"R1", {4.15, 4.15}}, {"R2", {0.95, 0.95}}, {"omega", {0.30, 0.35}},
    {"jwl.initial_energy", {7.0e9, 6.0e9}}, {"bulk_modulus", {10e9, 20e9}},
    // Alumina AD-99.5 and float glass; the 48 MPa concrete and one of four times its strength.
    {"johnson-holmquist-2.A", {0.93, 0.93}}, {"johnson-holmquist-2.B", {0.31, 0.088}}, {"johnson-holmquist-2.C", {NAN, 0.003}},
    {"johnson-holmquist-2.T", {0.2e9, 0.15e9}}, {"johnson-holmquist-2.D1", {0.005, 0.053}}, {"johnson-holmquist-2.D2", {1, 0.85}},
    {"johnson-holmquist-2.K1", {130.95e9, 45.4e9}}, {"johnson-holmquist-2.K2", {NAN, -138e9}}, {"johnson-holmquist-2.K3", {NAN, 290e9}},
    {"johnson-holmquist-2.G", {90.16e9, 30.4e9}}, {"johnson-holmquist-2.N", {0.6, 0.77}}, {"M", {0.6, 0.35}},
    {"SFMAX", {NAN, 0.5}}, {"HEL", {2.79e9, 5.95e9}}, {"P_HEL", {1.46e9, 2.92e9}},
    {"holmquist-johnson-cook.A", {0.79, 0.79}}, {"holmquist-johnson-cook.B", {1.6, 1.6}}, {"holmquist-johnson-cook.C", {0.007, NAN}},
    {"holmquist-johnson-cook.T", {4e6, 16e6}}, {"holmquist-johnson-cook.D1", {0.04, 0.02}}, {"holmquist-johnson-cook.K1", {85e9, 85e9}},
    {"holmquist-johnson-cook.K2", {-171e9, -171e9}}, {"holmquist-johnson-cook.K3", {208e9, 208e9}}, {"holmquist-johnson-cook.G", {14.86e9, 14.86e9}},
    {"holmquist-johnson-cook.N", {0.61, 0.61}}, {"fc", {48e6, 192e6}}, {"SMAX", {7, NAN}}, {"EFMIN", {0.01, 0.005}},
    {"P_crush", {16e6, 64e6}}, {"mu_crush", {0.001, 0.004}}, {"P_lock", {0.8e9, 1e9}}, {"mu_lock", {0.1, 0.05}},
    {"cohesion", {200e6, 50e6}}, {"friction_angle", {0.5, 0.6}}, {"dilatancy_angle", {NAN, 0.2}},
};
// clang-format on
static const double typical_density = 8930;

static inline double typical_value(const brunt_model *model, const brunt_parameter *parameter, int variant) {
    char own[96];
    snprintf(own, sizeof own, "%s.%s", model->name, parameter->key);
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < sizeof typical_values / sizeof *typical_values; i++) {
            if (strcmp(typical_values[i].key, pass ? parameter->key : own) != 0) continue;
            double value = typical_values[i].value[variant];
            return isnan(value) ? parameter->initial : value;
        }
    return parameter->initial;
}

static inline void typical_parameters(const brunt_model *model, int variant, double *out) {
    for (int i = 0; i < model->parameter_count; i++) {
        out[i] = typical_value(model, &model->parameters[i], variant);
        ck_assert_msg(!isnan(out[i]), "%s: no typical value of %s", model->name, model->parameters[i].key);
    }
}

static inline int parameter_index(const brunt_model *model, const char *key) {
    for (int i = 0; i < model->parameter_count; i++)
        if (strcmp(model->parameters[i].key, key) == 0) return i;
    ck_abort_msg("%s has no parameter %s", model->name, key);
    return -1;
}

// ---------------------------------------------------------------------------------------------------- a range of
// points

typedef struct sample {
    const brunt_model *model;
    real constants[BRUNT_MAX_CONSTANTS];
    brunt_material_points points;
    real *L[9], *volume;
    int state_scalars;
} sample;

static inline real *reals(int count) {
    real *a = brunt_alloc(sizeof(real) * (size_t)count);
    ck_assert_ptr_nonnull(a);
    return a;
}

static inline sample sample_create(const brunt_model *model, const double *parameters, bool with_eos, int dim,
                                   int count) {
    sample s = {.model = model};
    const char *wrong = model->prepare(parameters, typical_density, with_eos, s.constants);
    ck_assert_msg(!wrong, "%s: %s", model->name, wrong ? wrong : "");
    s.points =
        (brunt_material_points){.count = count, .dim = dim, .dt = (real)1e-6, .cell = (real)1e-3, .wave_speed = 4000};
    for (int k = 0; k < BRUNT_MATRIX(dim); k++) {
        s.points.L[k] = s.L[k] = reals(count);
        s.points.F[k] = reals(count);
        if (k % (dim + 1) == 0)
            for (int i = 0; i < count; i++) s.points.F[k][i] = 1;
    }
    for (int k = 0; k < BRUNT_SYMMETRIC(dim); k++) s.points.stress[k] = reals(count);
    s.points.volume = s.volume = reals(count);
    for (int i = 0; i < count; i++) s.volume[i] = 1;
    for (int f = 0; f < model->state_count; f++) {
        const brunt_state_field *field = &model->state[f];
        for (int c = 0; c < (dim == 3 ? field->components3 : field->components2); c++) {
            ck_assert_int_lt(s.state_scalars, BRUNT_MAX_STATE);
            real *a = s.points.state[s.state_scalars++] = reals(count);
            for (int i = 0; i < count; i++) a[i] = field->initial ? field->initial(s.constants, c) : 0;
            // An explosive that is lit long ago: products, from the first step on.
            for (int i = 0; i < count && !strcmp(field->name, "ignition_time"); i++) a[i] = -1;
        }
    }
    s.points.plastic_increment = reals(count);
    s.points.viscous_pressure = reals(count);
    return s;
}

static inline void sample_destroy(sample *s) {
    for (int k = 0; k < 9; k++) brunt_free(s->L[k]), brunt_free(s->points.F[k]);
    for (int k = 0; k < 6; k++) brunt_free(s->points.stress[k]);
    for (int k = 0; k < s->state_scalars; k++) brunt_free(s->points.state[k]);
    brunt_free(s->volume), brunt_free(s->points.plastic_increment), brunt_free(s->points.viscous_pressure);
    *s = (sample){0};
}

// First array of a state field.
static inline real *state_of(const sample *s, const char *name) {
    int scalar = 0;
    for (int f = 0; f < s->model->state_count; f++) {
        if (strcmp(s->model->state[f].name, name) == 0) return s->points.state[scalar];
        scalar += s->points.dim == 3 ? s->model->state[f].components3 : s->model->state[f].components2;
    }
    ck_abort_msg("%s has no state %s", s->model->name, name);
    return NULL;
}

static inline void copy_points(const sample *from, sample *to) {
    size_t bytes = sizeof(real) * (size_t)from->points.count;
    for (int k = 0; k < BRUNT_MATRIX(from->points.dim); k++) memcpy(to->points.F[k], from->points.F[k], bytes);
    for (int k = 0; k < BRUNT_SYMMETRIC(from->points.dim); k++)
        memcpy(to->points.stress[k], from->points.stress[k], bytes);
    for (int k = 0; k < from->state_scalars; k++) memcpy(to->points.state[k], from->points.state[k], bytes);
}

// Plain 3 by 3 algebra of the tests, in double.
static const mat identity = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

static inline mat combine(double x, mat a, double y, mat b) {
    for (int i = 0; i < 9; i++) ((double *)a.a)[i] = x * ((double *)a.a)[i] + y * ((double *)b.a)[i];
    return a;
}
static inline double det(mat m) {
    double(*a)[3] = m.a;
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}
static inline mat inverse(mat m) {
    mat r;
    double d = det(m);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int p = (i + 1) % 3, q = (i + 2) % 3, u = (j + 1) % 3, v = (j + 2) % 3;
            r.a[j][i] = (m.a[p][u] * m.a[q][v] - m.a[p][v] * m.a[q][u]) / d;
        }
    return r;
}
static inline double inner(mat a, mat b) {
    double s = 0;
    for (int i = 0; i < 9; i++) s += ((double *)a.a)[i] * ((double *)b.a)[i];
    return s;
}
static inline mat rotation(int dim, double angle) {
    double x[3] = {0.36, 0.48, 0.8}, c = cos(angle), s = sin(angle);
    if (dim == 2) x[0] = x[1] = 0, x[2] = 1;
    mat r;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) r.a[i][j] = (1 - c) * x[i] * x[j] + (i == j ? c : 0);
    for (int i = 0; i < 3; i++) r.a[(i + 2) % 3][(i + 1) % 3] += s * x[i], r.a[(i + 1) % 3][(i + 2) % 3] -= s * x[i];
    return r;
}

static double uniform(uint64_t *seed) { // -1 .. 1
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    uint64_t x = (*seed ^ (*seed >> 31)) * 0x9e3779b97f4a7c15u;
    return (double)(x >> 11) / 4503599627370496.0 - 1;
}
static inline mat random_matrix(uint64_t *seed, int dim, double size) {
    mat m = {{{0}}};
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) m.a[i][j] = size * uniform(seed);
    return m;
}

static inline mat get_F(const sample *s, int i) {
    mat m = identity;
    int dim = s->points.dim;
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) m.a[r][c] = (double)s->points.F[r * dim + c][i];
    return m;
}
static inline void set_F(sample *s, int i, mat m) {
    int dim = s->points.dim;
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) s->points.F[r * dim + c][i] = (real)m.a[r][c];
}
static inline mat get_stress(const sample *s, int i) {
    real *const *t = s->points.stress;
    mat m = {{{0}}};
    for (int k = 0; k < 3; k++) m.a[k][k] = (double)t[k][i];
    m.a[0][1] = m.a[1][0] = (double)t[3][i];
    if (s->points.dim == 3) m.a[1][2] = m.a[2][1] = (double)t[4][i], m.a[0][2] = m.a[2][0] = (double)t[5][i];
    return m;
}
static inline double equivalent(mat t) {
    double p = (t.a[0][0] + t.a[1][1] + t.a[2][2]) / 3;
    return sqrt(1.5 * inner(combine(1, t, -p, identity), combine(1, t, -p, identity)));
}

// dt L = H of point i, and F <- (I + H) F.
static inline void set_step(sample *s, int i, mat H) {
    int dim = s->points.dim;
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) s->L[r * dim + c][i] = (real)(H.a[r][c] / (double)s->points.dt);
    set_F(s, i, product(combine(1, identity, 1, H), get_F(s, i)));
}

// A step as the engine takes it: what an eos adds to starts from 0.
static inline brunt_update_result try_update(sample *s) {
    if (s->model->eos || s->model->viscous)
        for (int k = 0; k < BRUNT_SYMMETRIC(s->points.dim); k++)
            memset(s->points.stress[k], 0, sizeof(real) * (size_t)s->points.count);
    return s->model->update(s->constants, &s->points);
}
static inline brunt_update_result step_all(sample *s, mat H) {
    for (int i = 0; i < s->points.count; i++) set_step(s, i, H);
    brunt_update_result result = try_update(s);
    ck_assert_msg(result.bad < 0, "%s: %s", s->model->name, result.reason ? result.reason : "");
    return result;
}
static inline brunt_point_energy energy_of(const sample *s) {
    brunt_point_energy energy = {0};
    s->model->energy(s->constants, &s->points, &energy);
    energy.internal /= s->points.count, energy.plastic /= s->points.count, energy.viscosity /= s->points.count;
    return energy;
}
static inline double total_of(const sample *s) {
    brunt_point_energy energy = energy_of(s);
    return energy.internal + energy.plastic + energy.viscosity;
}

// Every model there is, in every form it is used in.
typedef struct form {
    const brunt_model *model;
    bool with_eos;
    int dim, variant;
} form;
enum { FORM_LIMIT = 200 };
static form forms[FORM_LIMIT];
static int form_count;

static inline void add_forms(const brunt_model *model, bool with_eos) {
    for (int k = 0; k < 4; k++)
        if (form_count < FORM_LIMIT) forms[form_count++] = (form){model, with_eos, 2 + k % 2, k / 2};
}
static inline void collect_forms(void) {
    form_count = 0;
    for (int i = 0; i < brunt_strength_model_count; i++) {
        if (!brunt_strength_models[i]->needs_eos) add_forms(brunt_strength_models[i], false);
        if (brunt_strength_models[i]->accepts_eos) add_forms(brunt_strength_models[i], true);
    }
    for (int i = 0; i < brunt_eos_model_count; i++) add_forms(brunt_eos_models[i], false);
}
static inline sample sample_of(form f, int count) {
    double parameters[BRUNT_MAX_PARAMETERS];
    typical_parameters(f.model, f.variant, parameters);
    return sample_create(f.model, parameters, f.with_eos, f.dim, count);
}
// Strain that stays elastic, large where nothing flows.
static inline double elastic_size(const brunt_model *model) {
    return model->plastic ? 2e-4 : model->small_strain ? 1e-2 : 0.2;
}
