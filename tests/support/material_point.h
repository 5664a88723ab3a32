// One material point that is stretched along its axes: parameters by key, the work of its stress, the ledger.
#pragma once

#include "tests/support/suite.h"
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/simd.h"
#include "materials/material.h"

#define GPA 1e9
#define MPA 1e6

enum { SCALARS = 16 };
typedef struct point {
    const brunt_model *model;
    double density;
    real constants[BRUNT_MAX_CONSTANTS];
    double parameters[BRUNT_MAX_PARAMETERS];
    real F[9][BRUNT_LANES], L[9][BRUNT_LANES], stress[6][BRUNT_LANES], state[SCALARS][BRUNT_LANES], volume[BRUNT_LANES];
    brunt_update_result result;
    double length[3];           // stretches along the axes; F is these, rounded
    double dt, work, most_work; // of the stress, per reference volume; the greatest there was
} point;

static inline int parameter_index(const brunt_model *model, const char *key) {
    for (int i = 0; i < model->parameter_count; i++)
        if (strcmp(model->parameters[i].key, key) == 0) return i;
    ck_abort_msg("%s has no parameter %s", model->name, key);
    return -1;
}

typedef struct value {
    const char *key;
    double value;
} value;

static inline void set_values(const brunt_model *model, const value *values, double *parameters) {
    for (int k = 0; values && values[k].key; k++) parameters[parameter_index(model, values[k].key)] = values[k].value;
}

// `base` and then `changes`, both ending with a NULL key; the rest are defaults.
static inline point make(const char *name, double density, const value *base, const value *changes) {
    point p = {.model = brunt_find_strength(name), .density = density, .length = {1, 1, 1}, .dt = 1e-3};
    ck_assert_msg(p.model != NULL, "no model %s", name);
    for (int k = 0; k < p.model->parameter_count; k++) p.parameters[k] = p.model->parameters[k].initial;
    set_values(p.model, base, p.parameters), set_values(p.model, changes, p.parameters);
    for (int k = 0; k < p.model->parameter_count; k++)
        ck_assert_msg(!isnan(p.parameters[k]), "%s is not given", p.model->parameters[k].key);
    const char *wrong = p.model->prepare(p.parameters, density, false, p.constants);
    ck_assert_msg(!wrong, "%s: %s", name, wrong ? wrong : "");
    int scalar = 0;
    for (int s = 0; s < p.model->state_count; s++)
        for (int c = 0; c < p.model->state[s].components3; c++, scalar++) {
            ck_assert_int_lt(scalar, SCALARS);
            for (int l = 0; l < BRUNT_LANES; l++)
                p.state[scalar][l] = p.model->state[s].initial ? p.model->state[s].initial(p.constants, c) : 0;
        }
    for (int l = 0; l < BRUNT_LANES; l++) p.F[0][l] = p.F[4][l] = p.F[8][l] = p.volume[l] = 1;
    return p;
}

static inline brunt_material_points points_of(point *p) {
    brunt_material_points points = {
        .count = BRUNT_LANES, .dim = 3, .dt = (real)p->dt, .cell = 1, .wave_speed = 1, .volume = p->volume};
    for (int k = 0; k < 9; k++) points.F[k] = p->F[k], points.L[k] = p->L[k];
    for (int k = 0; k < 6; k++) points.stress[k] = p->stress[k];
    for (int k = 0; k < SCALARS; k++) points.state[k] = p->state[k];
    return points;
}

static inline double parameter(const point *p, const char *key) {
    return p->parameters[parameter_index(p->model, key)];
}
static inline double state_of(const point *p, const char *name) {
    int scalar = 0;
    for (int s = 0; s < p->model->state_count; scalar += p->model->state[s++].components3)
        if (strcmp(p->model->state[s].name, name) == 0) return (double)p->state[scalar][0];
    ck_abort_msg("%s has no state %s", p->model->name, name);
    return 0;
}
static inline double volume_of(const point *p) { return p->length[0] * p->length[1] * p->length[2]; }
static inline double mu_of(const point *p) { return 1 / volume_of(p) - 1; }
// Cauchy, mean pressure and von Mises; of paths along the axes.
static inline double pressure_of(const point *p) {
    return -((double)p->stress[0][0] + (double)p->stress[1][0] + (double)p->stress[2][0]) / (3 * volume_of(p));
}
static inline double mises_of(const point *p) {
    double a = (double)p->stress[0][0], b = (double)p->stress[1][0], c = (double)p->stress[2][0];
    return sqrt(0.5 * ((a - b) * (a - b) + (b - c) * (b - c) + (c - a) * (c - a))) / volume_of(p);
}
static inline brunt_point_energy energy_of(point *p) {
    brunt_point_energy energy = {0};
    brunt_material_points points = points_of(p);
    p->model->energy(p->constants, &points, &energy);
    energy.internal /= BRUNT_LANES, energy.plastic /= BRUNT_LANES;
    return energy;
}

// One step of the stretches e[0..2] along the axes: F <- (1 + e) F.
static inline void stretch(point *p, const double e[3]) {
    double before[3];
    for (int a = 0; a < 3; a++) {
        before[a] = (double)p->stress[a][0];
        p->length[a] *= 1 + e[a];
        for (int l = 0; l < BRUNT_LANES; l++)
            p->L[4 * a][l] = (real)(e[a] / p->dt), p->F[4 * a][l] = (real)p->length[a];
    }
    brunt_material_points points = points_of(p);
    p->result = p->model->update(p->constants, &points);
    ck_assert_msg(p->result.bad < 0, "%s: %s", p->model->name, p->result.reason);
    for (int a = 0; a < 3; a++) p->work += 0.5 * (before[a] * e[a] + (double)p->stress[a][0] * e[a] / (1 + e[a]));
    p->most_work = fmax(p->most_work, fabs(p->work));
}
// To the volumetric strain mu with n equal steps of the logarithm, by all axes or by the first alone.
static inline void compress_to(point *p, double mu, int n, bool uniaxial) {
    double e = -log((1 + mu) * volume_of(p)) / n / (uniaxial ? 1 : 3);
    for (int k = 0; k < n; k++) stretch(p, (double[3]){expm1(e), uniaxial ? 0 : expm1(e), uniaxial ? 0 : expm1(e)});
}
// Keeps the volume.
static inline void shear_by(point *p, double strain, int n) {
    for (int k = 0; k < n; k++) {
        double e = expm1(-strain / n), f = 1 / sqrt(1 + e) - 1;
        stretch(p, (double[3]){e, f, f});
    }
}
static inline void check_ledger(point *p, double tolerance, const char *what) {
    brunt_point_energy e = energy_of(p);
    double error = fabs(e.internal + e.plastic - p->work) / p->most_work;
    ck_assert_msg(error <= tolerance, "%s, %s: energy off by %.3g (stored %.6g, dissipated %.6g, work %.6g)",
                  p->model->name, what, error, e.internal, e.plastic, p->work);
}
