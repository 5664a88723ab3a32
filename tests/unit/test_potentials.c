// The potentials of models: stress is the potential's derivative, the tangent the stress's; turns are free; a commit
// leaves what the explicit update of the same deformation leaves, and the energy that the potential says.
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/simd.h"
#include "materials/prepared.h"
#include "tests/support/suite.h"

typedef struct named_material {
    const char *name, *strength, *eos;
    const char *key[14]; // of what is set, and the values
    double value[14];
    bool objective, elastic;
} named_material;

static const named_material materials[] = {
    {"linear elastic", "linear-elastic", "", {"density", "E", "nu"}, {1000, 2e6, 0.3}, false, true},
    {"st venant-kirchhoff", "st-venant-kirchhoff", "", {"density", "E", "nu"}, {1000, 2e6, 0.3}, true, true},
    {"neo-hookean", "neo-hookean", "", {"density", "E", "nu"}, {1000, 2e6, 0.3}, true, true},
    {"water", "newtonian", "tait", {"density", "eos.c0", "eos.gamma"}, {1000, 30, 7}, true, true},
    {"linear water",
     "newtonian",
     "tait",
     {"density", "eos.c0", "eos.gamma", "eos.tension"},
     {1000, 30, 1, 4e4},
     true,
     true},
    {"honey", "newtonian", "tait", {"density", "dynamic_viscosity", "eos.c0"}, {1000, 40, 30}, true, false},
    {"polynomial",
     "newtonian",
     "polynomial",
     {"density", "dynamic_viscosity", "eos.C0", "eos.C1", "eos.C2", "eos.C3", "eos.tension"},
     {1000, 3, 1e3, 1e6, 5e5, 3e5, 1e5},
     true,
     false},
    {"metal", "von-mises", "", {"density", "E", "nu", "yield", "hardening"}, {1000, 2e6, 0.3, 1e5, 2e5}, true, false},
    {"saturating metal",
     "von-mises",
     "",
     {"density", "E", "nu", "yield", "hardening", "saturation_stress", "saturation_rate"},
     {1000, 2e6, 0.3, 5e4, 1e4, 2e5, 8},
     true,
     false},
    {"metal in water",
     "von-mises",
     "polynomial",
     {"density", "E", "nu", "yield", "eos.C1", "eos.C3"},
     {1000, 2e6, 0.3, 1e5, 2e6, 1e6},
     true,
     false},
    // From here on by differences.
    {"soil",
     "drucker-prager",
     "",
     {"density", "E", "nu", "cohesion", "friction_angle", "dilatancy_angle", "hardening"},
     {1000, 2e6, 0.3, 1e5, 0.5, 0.2, 1e5},
     true,
     false},
    {"rock",
     "mohr-coulomb",
     "",
     {"density", "E", "nu", "cohesion", "friction_angle", "dilatancy_angle", "hardening"},
     {1000, 2e6, 0.3, 1e5, 0.5, 0.2, 1e5},
     true,
     false},
    {"hot metal",
     "johnson-cook",
     "mie-gruneisen",
     {"density", "E", "nu", "A", "B", "n", "C", "eos.c0", "eos.s", "eos.gamma0", "melt", "m", "heat_capacity"},
     {1000, 2e6, 0.3, 1e5, 2e5, 0.5, 0.03, 40, 1.5, 2, 1000, 1, 100},
     true,
     false},
    {"gas",
     "newtonian",
     "ideal-gas",
     {"density", "dynamic_viscosity", "eos.gamma", "eos.initial_energy"},
     {1000, 40, 1.4, 1e6},
     true,
     false},
};
enum { MATERIALS = sizeof materials / sizeof *materials, POTENTIALS = MATERIALS - 4 };

static brunt_material make(const named_material *from) {
    brunt_error error;
    brunt_material_def def = brunt_material_def_default("it", from->strength);
    if (from->eos[0]) ck_assert_int_eq(brunt_material_set(&def, "eos", 0, from->eos, &error), BRUNT_OK);
    for (int k = 0; k < 14 && from->key[k]; k++)
        ck_assert_msg(!brunt_material_set(&def, from->key[k], from->value[k], NULL, &error), "%s", error.message);
    brunt_material material;
    ck_assert_msg(!brunt_material_make(&def, &material, &error), "%s", error.message);
    ck_assert_ptr_null(brunt_material_implicit(&material));
    material.implicit = true;
    return material;
}

static double uniform(uint64_t *seed) { // -1 .. 1
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 4503599627370496.0 - 1;
}

// A vector of points of one material, at the start of a step and at its trial.
typedef struct trial {
    brunt_material material;
    int dim, m;      // m: components of a matrix
    double old_F[9]; // of all lanes alike
    real F[9][BRUNT_LANES], f[9][BRUNT_LANES], state[2][BRUNT_MAX_STATE][BRUNT_LANES], stress[6][BRUNT_LANES];
    real density[BRUNT_LANES], tau[9][BRUNT_LANES], a[BRUNT_TANGENT_LIMIT][BRUNT_LANES];
    brunt_trial_points points[BRUNT_COMPONENTS];
    brunt_material_points kept[BRUNT_COMPONENTS];
    real volume[BRUNT_LANES], plastic[BRUNT_LANES];
} trial;

static int kind_of(int k) { return k == BRUNT_EOS; }

static void begin(trial *t, const named_material *from, int dim) {
    memset(t, 0, sizeof *t);
    t->material = make(from), t->dim = dim, t->m = dim * dim;
    for (int l = 0; l < BRUNT_LANES; l++) t->volume[l] = 1;
    for (int c = 0; c < t->m; c++) t->old_F[c] = c % (dim + 1) == 0;
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        const brunt_model *model = t->material.model[k];
        if (!model) continue;
        brunt_trial_points *p = &t->points[k];
        *p = (brunt_trial_points){.count = BRUNT_LANES, .dim = dim, .dt = (real)1e-3};
        t->kept[k] =
            (brunt_material_points){.count = BRUNT_LANES, .dim = dim, .dt = (real)1e-3, .cell = 1, .volume = t->volume};
        for (int c = 0; c < t->m; c++) p->F[c] = t->kept[k].F[c] = t->F[c], p->f[c] = t->f[c];
        for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) t->kept[k].stress[c] = t->stress[c];
        for (int s = 0, at = 0; s < model->state_count; s++)
            for (int c = 0; c < (dim == 3 ? model->state[s].components3 : model->state[s].components2); c++, at++) {
                real *array = t->state[kind_of(k)][at];
                p->state[at] = t->kept[k].state[at] = array;
                for (int l = 0; l < BRUNT_LANES; l++)
                    array[l] = model->state[s].initial ? model->state[s].initial(t->material.constants[k], c) : 0;
            }
    }
}

static void product(int d, const double *a, const double *b, double *out) {
    for (int i = 0; i < d; i++)
        for (int j = 0; j < d; j++) {
            out[i * d + j] = 0;
            for (int k = 0; k < d; k++) out[i * d + j] += a[i * d + k] * b[k * d + j];
        }
}
static double determinant(int d, const double *F) {
    if (d == 2) return F[0] * F[3] - F[1] * F[2];
    return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
}
static void inverse(int d, const double *F, double *out) {
    const double J = determinant(d, F);
    if (d == 2) {
        out[0] = F[3] / J, out[1] = -F[1] / J, out[2] = -F[2] / J, out[3] = F[0] / J;
        return;
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int p = (i + 1) % 3, q = (i + 2) % 3, u = (j + 1) % 3, v = (j + 2) % 3;
            out[j * 3 + i] = (F[p * 3 + u] * F[q * 3 + v] - F[p * 3 + v] * F[q * 3 + u]) / J;
        }
}

// Sets lane l to f; F = f F_old.
static void set(trial *t, int l, const double *f) {
    double F[9];
    product(t->dim, f, t->old_F, F);
    for (int c = 0; c < t->m; c++) t->f[c][l] = (real)f[c], t->F[c][l] = (real)F[c];
}

static void respond(trial *t, bool tangent) {
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        t->points[k].density = t->density;
        for (int c = 0; c < t->m; c++) t->points[k].stress[c] = t->tau[c];
        for (int c = 0; c < brunt_material_tangents(&t->material, t->dim); c++)
            t->points[k].tangent[c] = tangent ? t->a[c] : NULL;
    }
    brunt_material_respond(&t->material, t->points);
}

static void ask(trial *t, brunt_trial_part part, double start) {
    for (int k = 0; k < BRUNT_COMPONENTS; k++) t->points[k].rule = (brunt_trial_rule){part, (real)start};
}

// The trial as it is set becomes the step.
static brunt_update_result commit(trial *t) {
    for (int k = 0; k < BRUNT_COMPONENTS; k++)
        if (t->material.model[k]) t->kept[k].may_reshape = false;
    brunt_update_result result = brunt_material_commit(&t->material, t->points, t->kept, t->plastic);
    for (int c = 0; c < t->m; c++) t->old_F[c] = (double)t->F[c][0];
    return result;
}

static void turn(int d, double angle, double *R) {
    const double x[3] = {0.36, 0.48, 0.8}, z[3] = {0, 0, 1}, *n = d == 2 ? z : x, c = cos(angle), s = sin(angle);
    for (int i = 0; i < d; i++)
        for (int j = 0; j < d; j++) R[i * d + j] = (1 - c) * n[i] * n[j] + (i == j ? c : 0);
    R[1] -= s * n[2], R[d] += s * n[2];
    if (d == 3) R[2] += s * n[1], R[6] -= s * n[1], R[5] -= s * n[0], R[7] += s * n[0];
}

// Deformations of a step: at rest, small, moderate, a turn, nearly a turn, strongly compressed, stretched.
enum { SHAPES = 8 };
static void shape(int kind, int d, uint64_t *seed, double *f) {
    const double size[SHAPES] = {0, 1e-7, 0.01, 0.25, 0, 1e-6, 0.1, 0.1};
    double S[9], R[9];
    for (int c = 0; c < d * d; c++) S[c] = (c % (d + 1) == 0) + size[kind] * uniform(seed);
    for (int c = 0; c < d; c++) {
        if (kind == 6) S[c * (d + 1)] *= 0.45;
        if (kind == 7) S[c * (d + 1)] *= c == 0 ? 1.8 : 0.9;
    }
    turn(d, kind == 4 || kind == 5 ? 1.1 : 0, R);
    product(d, R, S, f);
}

static int place(int dim, int m, int n) {
    if (m > n) return place(dim, n, m);
    return m * (2 * dim * dim - m - 1) / 2 + n;
}

// P = tau F^-T of lane l.
static void piola(const trial *t, int l, double *P) {
    double F[9], G[9];
    for (int c = 0; c < t->m; c++) F[c] = (double)t->F[c][l];
    inverse(t->dim, F, G);
    for (int i = 0; i < t->dim; i++)
        for (int A = 0; A < t->dim; A++) {
            P[i * t->dim + A] = 0;
            for (int a = 0; a < t->dim; a++) P[i * t->dim + A] += (double)t->tau[i * t->dim + a][l] * G[A * t->dim + a];
        }
}

// Greatest error of stress against differences of the potential, and of the tangent against those of the stress, of a
// deformation of the step; by Richardson's extrapolation, whose own error is some 1e-10.
static void differences(trial *t, const double *f, uint64_t *seed, double *stress_error, double *tangent_error) {
    const int d = t->dim, m = t->m;
    double G[9], K[9], W[4], P[4][9], F[9], KF[9], power = 0, quadratic = 0, size = 0, stiff = 0;
    const double step[4] = {1e-4, -1e-4, 2e-4, -2e-4};
    for (int c = 0; c < m; c++) G[c] = uniform(seed), K[c] = uniform(seed);
    set(t, 0, f);
    respond(t, true);
    const double W0 = (double)t->density[0];
    for (int c = 0; c < m; c++) {
        power += (double)t->tau[c][0] * G[c], size += fabs((double)t->tau[c][0]);
        for (int e = 0; e < m; e++) {
            const double a = (double)t->a[brunt_tangent_place(t->material.differences, d, c, e)][0];
            quadratic += K[c] * a * G[e], stiff += fabs(a) / m;
        }
        F[c] = (double)t->F[c][0];
    }
    product(d, K, F, KF);
    for (int s = 0; s < 4; s++) {
        double moved[9], ft[9];
        for (int c = 0; c < m; c++) moved[c] = (c % (d + 1) == 0) + step[s] * G[c];
        product(d, moved, f, ft);
        set(t, 0, ft);
        respond(t, false);
        W[s] = (double)t->density[0];
        piola(t, 0, P[s]);
    }
    const double slope = (4 * (W[0] - W[1]) / 2e-4 - (W[2] - W[3]) / 4e-4) / 3;
    double bent = 0, kink = 0;
    for (int c = 0; c < m; c++) {
        const double near = (P[0][c] - P[1][c]) / 2e-4, far = (P[2][c] - P[3][c]) / 4e-4;
        bent += (4 * near - far) / 3 * KF[c], kink += (near - far) * KF[c];
    }
    // What is known of a difference: digits of the potential itself over the step.
    *stress_error = t->material.differences ? 0 : fabs(slope - power) / (size + 1e-4 * stiff + fabs(W0));
    *tangent_error = fabs(bent - quadratic) / (stiff + size);
    // Where both differences are not near each other, flow begins or another face of a yield surface is met between.
    if (t->material.differences && fabs(kink) > 3e-6 * (stiff + size)) *tangent_error = NAN;
}

START_TEST(stress_and_tangent) {
    const named_material *from = &materials[_i % MATERIALS];
    const int dim = _i / MATERIALS + 2;
    static trial t;
    uint64_t seed = 7;
    double worst[2] = {0};
    int tried = 0, known = 0;
    for (int history = 0; history < 3; history++) { // a new point, and one that has flowed
        begin(&t, from, dim);
        ask(&t, BRUNT_TRIAL_END, history == 2 ? 0.5 : 0);
        for (int n = 0; n < history; n++) {
            double f[9];
            shape(3, dim, &seed, f);
            for (int l = 0; l < BRUNT_LANES; l++) set(&t, l, f);
            ck_assert_int_lt(commit(&t).bad, 0);
        }
        // Where it yields, and where C2 begins to act, the tangent jumps: no differences there.
        const brunt_model *strength = t.material.model[BRUNT_STRENGTH], *eos = t.material.model[BRUNT_EOS];
        const bool kink = (strength->plastic && history) || (eos && !strcmp(eos->name, "mie-gruneisen")) ||
                          (!strength->plastic && eos && !strcmp(eos->name, "polynomial"));
        for (int kind = 0; kind < SHAPES; kind++)
            for (int n = 0; n < 10 && !(kink && (kind < 3 || kind == 4 || kind == 5)); n++) {
                double f[9], error[2];
                shape(kind, dim, &seed, f);
                for (int l = 0; l < BRUNT_LANES; l++) set(&t, l, f);
                differences(&t, f, &seed, &error[0], &error[1]);
                tried++, known += isfinite(error[1]);
                for (int k = 0; k < 2 && isfinite(error[1]); k++) {
                    ck_assert_msg(error[k] < (t.material.differences ? 1e-6 : 1e-7),
                                  "%s %dD, history %d, shape %d: %s %.2e", from->name, dim, history, kind,
                                  k ? "tangent" : "stress", error[k]);
                    worst[k] = fmax(worst[k], error[k]);
                }
            }
    }
    printf("%s %dD: stress %.1e, tangent %.1e, %d of %d\n", from->name, dim, worst[0], worst[1], known, tried);
    ck_assert_int_ge(known, tried / 2);
}
END_TEST

// The response to a step that all lanes take: its energy, and the stress.
static double respond_to(trial *t, const double *f, double *tau) {
    for (int l = 0; l < BRUNT_LANES; l++) set(t, l, f);
    respond(t, false);
    for (int c = 0; c < t->m; c++) tau[c] = (double)t->tau[c][0];
    return (double)t->density[0];
}

// A turn after the step changes neither the potential, and the stress turns with it. A turn alone of what is at rest is
// nothing, however large: what flows has no rate.
START_TEST(turns_are_free) {
    const named_material *from = &materials[_i % MATERIALS];
    const int dim = _i / MATERIALS + 2;
    static trial t;
    uint64_t seed = 3;
    if (!from->objective) return;
    begin(&t, from, dim);
    double rest = 0;
    for (int kind = 0; kind < SHAPES; kind++) {
        double f[9], R[9], turned[9], straight[9], found[9], size = 1e-6 * 2e6;
        shape(kind, dim, &seed, f);
        turn(dim, 2.3, R);
        product(dim, R, f, turned);
        const double energy = respond_to(&t, f, straight), again = respond_to(&t, turned, found);
        if (kind == 0) rest = energy;
        if (!isfinite(energy) && !isfinite(again)) continue; // beyond what an equation of state has
        ck_assert_double_le(fabs(again - energy), 1e-9 * (fabs(energy) + 1e-9) + 1e-9);
        for (int c = 0; c < dim * dim; c++) size += fabs(straight[c]);
        for (int i = 0; i < dim; i++)
            for (int j = 0; j < dim; j++) {
                double tau = 0;
                for (int p = 0; p < dim; p++)
                    for (int q = 0; q < dim; q++) tau += R[i * dim + p] * straight[p * dim + q] * R[j * dim + q];
                ck_assert_msg(fabs(tau - found[i * dim + j]) <= 1e-9 * size, "%s %dD, shape %d: %.9g %.9g", from->name,
                              dim, kind, tau, found[i * dim + j]);
            }
        if (kind == 4) ck_assert_double_le(fabs(again - rest), 1e-9 * (1 + fabs(rest)));
    }
}
END_TEST

// What a commit leaves: of elastic models the bits of `update`; of all the energy that the books said, stored and
// dissipated, whatever the integrator; and the trial of no further step gives that same energy and stress.
START_TEST(commits) {
    const named_material *from = &materials[_i % POTENTIALS];
    const int dim = _i / POTENTIALS + 2;
    static trial t;
    uint64_t seed = 5;
    double flown = 0;
    begin(&t, from, dim);
    for (int n = 0; n < 6; n++) {
        double f[9], before, after;
        brunt_point_energy old = {0}, now = {0};
        for (int k = 0; k < BRUNT_COMPONENTS; k++)
            brunt_material_energy(&t.material, (brunt_component)k, &t.kept[k], &old);
        shape(n < 3 ? 2 : 3, dim, &seed, f);
        if (n == 0)
            for (int k = 0; k < BRUNT_COMPONENTS; k++) { // F was not yet set
                old = (brunt_point_energy){0};
                for (int l = 0; l < BRUNT_LANES; l++)
                    for (int c = 0; c < t.m; c++) t.F[c][l] = c % (dim + 1) == 0;
            }
        for (int l = 0; l < BRUNT_LANES; l++) set(&t, l, f);
        respond(&t, false);
        real stress[9];
        for (int c = 0; c < t.m; c++) stress[c] = t.tau[c][0];
        ask(&t, BRUNT_TRIAL_ACCOUNT, n % 2 ? 0.5 : 0);
        respond(&t, false);
        before = (double)t.density[0] * BRUNT_LANES;
        const double viscosity = t.material.model[BRUNT_STRENGTH]->shear_viscous ? 1 : 0;
        ck_assert_int_lt(commit(&t).bad, 0);
        for (int k = 0; k < BRUNT_COMPONENTS; k++)
            brunt_material_energy(&t.material, (brunt_component)k, &t.kept[k], &now);
        double work = viscosity ? (double)t.state[0][0][0] * BRUNT_LANES : now.plastic;
        after = now.internal + work - flown;
        flown = work;
        ck_assert_double_le(fabs(after - before), 1e-10 * fabs(before) + 1e-9);
        if (from->objective)
            for (int i = 0; i < dim; i++)
                for (int j = 0; j < dim; j++) {
                    const int at = i == j ? i : dim == 2 ? 3 : i + j == 1 ? 3 : i + j == 3 ? 4 : 5;
                    ck_assert_double_le(fabs((double)(t.stress[at][0] - stress[i * dim + j])), 1e-10 * 2e6);
                }
        for (int c = 0; c < t.m; c++)
            for (int l = 0; l < BRUNT_LANES; l++) t.f[c][l] = c % (dim + 1) == 0;
        ask(&t, BRUNT_TRIAL_END, 0);
        if (viscosity) continue;
        real kept[6];
        for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) kept[c] = t.stress[c][0];
        respond(&t, false);
        ck_assert_double_le(fabs((double)t.density[0] * BRUNT_LANES - now.internal), 1e-10 * fabs(before) + 1e-9);
        if (!from->elastic) continue;
        brunt_material_points points[BRUNT_COMPONENTS];
        memcpy(points, t.kept, sizeof points);
        real L[9][BRUNT_LANES] = {{0}}, viscous[BRUNT_LANES], strain[BRUNT_LANES];
        for (int k = 0; k < BRUNT_COMPONENTS; k++)
            for (int c = 0; c < t.m; c++) points[k].L[c] = L[c];
        brunt_material_update(&t.material, points, t.plastic, viscous, strain);
        for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) ck_assert(t.stress[c][0] == kept[c]);
    }
}
END_TEST

// Hencky's form of von Mises' law and the explicit return agree at small elastic strain: uniaxial and shear paths.
START_TEST(hencky_agrees_with_the_explicit_return) {
    static trial t, e;
    named_material steel = {
        "steel", "von-mises", "", {"density", "E", "nu", "yield", "hardening"}, {7800, 2e11, 0.3, 4e8, 1e9},
        true,    false};
    begin(&t, &steel, 3), begin(&e, &steel, 3);
    real L[9][BRUNT_LANES], viscous[BRUNT_LANES], strain[BRUNT_LANES];
    for (int n = 0; n < 200; n++) {
        double f[9] = {1.0008, 0.0006, 0, 0, 0.9997, 0, 0, 0.0002, 0.9995};
        for (int l = 0; l < BRUNT_LANES; l++) set(&t, l, f), set(&e, l, f);
        commit(&t);
        for (int k = 0; k < BRUNT_COMPONENTS; k++)
            for (int c = 0; c < 9; c++) e.kept[k].L[c] = L[c];
        for (int c = 0; c < 9; c++)
            for (int l = 0; l < BRUNT_LANES; l++) L[c][l] = (real)((f[c] - (c % 4 == 0)) / 1e-3);
        brunt_material_update(&e.material, e.kept, e.plastic, viscous, strain);
        for (int c = 0; c < 9; c++) e.old_F[c] = (double)e.F[c][0];
    }
    const double flow = (double)t.state[0][6][0];
    ck_assert_double_gt(flow, 0.1);
    ck_assert_double_le(fabs(flow - (double)e.state[0][6][0]), 2e-3 * flow);
    // The flow stress differs with the step's elastic strain, some 0.002 of it.
    for (int c = 0; c < 6; c++) ck_assert_double_le(fabs((double)(t.stress[c][0] - e.stress[c][0])), 0.01 * 5e8);
    printf("steel: plastic strain %.6f, explicit %.6f; stress %.4e %.4e\n", flow, (double)e.state[0][6][0],
           (double)t.stress[0][0], (double)e.stress[0][0]);
}
END_TEST

// Projection takes the negative eigenvalues out, and leaves what has none.
START_TEST(projection) {
    static trial t;
    uint64_t seed = 11;
    const int dim = _i + 2, rows = dim * dim;
    begin(&t, &materials[1], dim);
    int lifted = 0;
    for (int n = 0; n < 40; n++) {
        real before[BRUNT_TANGENT_LIMIT][BRUNT_LANES];
        for (int l = 0; l < BRUNT_LANES; l++) {
            double f[9];
            shape(n % 2 ? 6 : 2, dim, &seed, f);
            set(&t, l, f);
        }
        respond(&t, true);
        memcpy(before, t.a, sizeof before);
        brunt_material_project(&t.material, t.points);
        for (int l = 0; l < BRUNT_LANES; l++) {
            bool same = true;
            double trace = 0;
            for (int c = 0; c < rows; c++) trace += fabs((double)before[place(dim, c, c)][l]);
            for (int c = 0; c < BRUNT_TANGENT(dim); c++) same = same && t.a[c][l] == before[c][l];
            lifted += !same;
            for (int k = 0; k < 200; k++) { // x.a x >= 0, and >= that before
                double x[9], q = 0, was = 0;
                for (int c = 0; c < rows; c++) x[c] = uniform(&seed);
                for (int r = 0; r < rows; r++)
                    for (int c = 0; c < rows; c++)
                        q += x[r] * x[c] * (double)t.a[place(dim, r, c)][l],
                            was += x[r] * x[c] * (double)before[place(dim, r, c)][l];
                ck_assert_double_ge(q, -1e-12 * trace);
                ck_assert_double_ge(q, was - 1e-12 * trace);
            }
        }
    }
    ck_assert_int_gt(lifted, 0);
}
END_TEST

// Past J = 0 the potential is infinite.
START_TEST(inside_out) {
    const named_material *from = &materials[_i % POTENTIALS];
    const int dim = _i / POTENTIALS + 2;
    static trial t;
    begin(&t, from, dim);
    double f[9];
    for (int c = 0; c < dim * dim; c++) f[c] = (c % (dim + 1) == 0) - (c == 0) * 1.2;
    for (int l = 0; l < BRUNT_LANES; l++) set(&t, l, f);
    respond(&t, false);
    ck_assert(isinf(t.density[0]) && t.density[0] > 0);
}
END_TEST

// Every model either has a potential or says why not.
START_TEST(the_rest_says_why) {
    for (int k = 0; k < brunt_strength_model_count; k++)
        ck_assert(!brunt_strength_models[k]->potential == !!brunt_strength_models[k]->no_potential);
    for (int k = 0; k < brunt_eos_model_count; k++)
        ck_assert(!brunt_eos_models[k]->potential == !!brunt_eos_models[k]->no_potential);
    for (int k = 0; k < brunt_strength_model_count; k++) // damage and explosives stay out
        ck_assert(!brunt_strength_models[k]->damage || !brunt_strength_models[k]->differences);
    for (int k = 0; k < brunt_eos_model_count; k++)
        ck_assert(!brunt_eos_models[k]->explosive || !brunt_eos_models[k]->differences);
    named_material gas = {
        "gas", "newtonian", "polynomial", {"density", "eos.C4", "eos.initial_energy", "eos.C1"}, {1, 0.4, 2.5e5, 1e3},
        true,  true};
    brunt_error error;
    brunt_material_def def = brunt_material_def_default("it", gas.strength);
    ck_assert_int_eq(brunt_material_set(&def, "eos", 0, gas.eos, &error), BRUNT_OK);
    for (int k = 0; k < 4; k++) brunt_material_set(&def, gas.key[k], gas.value[k], NULL, &error);
    brunt_material material;
    ck_assert_msg(!brunt_material_make(&def, &material, &error), "%s", error.message);
    ck_assert_ptr_null(brunt_material_implicit(&material));
    ck_assert(material.differences);
    ck_assert_ptr_nonnull(strstr(brunt_model_no_potential(material.model[BRUNT_EOS], material.constants[BRUNT_EOS]),
                                 "depends on the energy"));
    def = brunt_material_def_default("it", "neo-hookean");
    brunt_material_set(&def, "density", 1, NULL, &error), brunt_material_set(&def, "E", 1, NULL, &error);
    brunt_material_set(&def, "nu", 0.3, NULL, &error), brunt_material_set(&def, "viscosity", 0, NULL, &error);
    ck_assert_msg(!brunt_material_make(&def, &material, &error), "%s", error.message);
    ck_assert_ptr_nonnull(strstr(brunt_material_implicit(&material), "bulk viscosity"));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("potentials");
    TCase *all = tcase_create("all");
    if (sizeof(real) == sizeof(double)) { // what implicit steps are of
        tcase_add_loop_test(all, stress_and_tangent, 0, 2 * MATERIALS);
        tcase_add_loop_test(all, turns_are_free, 0, 2 * MATERIALS);
        tcase_add_loop_test(all, commits, 0, 2 * POTENTIALS);
        tcase_add_test(all, hencky_agrees_with_the_explicit_return);
        tcase_add_loop_test(all, projection, 0, 2);
    }
    tcase_add_loop_test(all, inside_out, 0, 2 * POTENTIALS);
    tcase_add_test(all, the_rest_says_why);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
