// Labels: verification
// Mohr-Coulomb against closed forms: strengths in triaxial compression and extension, the conditions that a return to
// faces, edges and the apex has to meet, hardening, opening; what holds of every material is in test_materials.
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/material_point.h"
#include "tests/support/suite.h"

static double uniform(uint64_t *seed) { // -1 .. 1
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 4503599627370496.0 - 1;
}

#define QUARTER_PI 0.78539816339744831

// Strained by `axial` a step along the first axis, with the stress of the others held at -confined: bisection of their
// strain.
static void confined_steps(point *p, double axial, double confined, int steps) {
    for (int step = 0; step < steps; step++) {
        double low = -10 * fabs(axial), high = -low;
        point next = *p;
        for (int b = 0; b < 60; b++) {
            const double lateral = 0.5 * (low + high);
            next = *p;
            stretch(&next, (double[3]){axial, lateral, lateral});
            if (-(double)next.stress[1][0] > confined)
                low = lateral;
            else
                high = lateral;
        }
        *p = next;
    }
}

// Triaxial compression ends at -t1 = confined N + 2 c sqrt(N), extension at (confined - 2 c sqrt(N)) / N, N = tan^2(45
// deg + phi/2), with hardening at the cohesion that the plastic strain has made; the volume opens by 2 sin(psi) / (1 -
// sin(psi) / 3) of the plastic strain in compression, 2 sin(psi) / (1 + sin(psi) / 3) in extension: two faces.
START_TEST(triaxial_strength) {
    const double angle = 0.6, dilatancy[] = {0, 0.3, 0.6};
    for (int k = 0; k < 24; k++) {
        const double psi = dilatancy[k % 3], confined = (k / 3 % 2) * 3 * MPA + 4 * MPA,
                     hardening = (k / 6 % 2) * 20 * MPA;
        const bool extension = k / 12;
        const value soil[] = {{"E", 1 * GPA},
                              {"nu", 0.3},
                              {"cohesion", 1 * MPA},
                              {"friction_angle", angle},
                              {"dilatancy_angle", psi},
                              {"hardening", hardening},
                              {NULL, 0}};
        point p = make("mohr-coulomb", 2000, soil, NULL);
        compress_to(&p, 3 * confined * (1 - 0.6) / GPA, 10, false);
        confined_steps(&p, extension ? 2e-4 : -2e-4, confined, 200);
        const double t = tan(QUARTER_PI + 0.5 * angle), strain = state_of(&p, "plastic_strain"),
                     c = MPA + hardening * strain,
                     expect = extension ? (confined - 2 * c * t) / (t * t) : confined * t * t + 2 * c * t;
        ck_assert_double_gt(strain, 0.01);
        ck_assert_double_eq_tol(-(double)p.stress[0][0], expect, TOLERANCE(1e-9, 1e-2) * confined);
        const double s = sin(psi), opened = 2 * s / (extension ? 1 + s / 3 : 1 - s / 3) * strain;
        const double elastic = -pressure_of(&p) * volume_of(&p) / (GPA / 1.2);
        ck_assert_double_eq_tol(log(volume_of(&p)), opened + elastic, TOLERANCE(1e-9, 1e-4));
        check_ledger(&p, TOLERANCE(1e-3, 2e-2), extension ? "extension" : "compression");
    }
}
END_TEST

// Elastic strains along the axes.
static void elastic_strains(const point *p, double e[3]) {
    for (int a = 0; a < 3; a++) e[a] = 0.5 * log1p((double)p->state[a][0]);
}

typedef struct ranked {
    double trial[3], flow[3], tau[3]; // in descending order of the trial
} ranked;

static ranked rank_axes(const double trial[3], const double flow[3], const point *p) {
    ranked r;
    bool taken[3] = {false};
    for (int k = 0; k < 3; k++) {
        int best = -1;
        for (int a = 0; a < 3; a++)
            if (!taken[a] && (best < 0 || trial[a] > trial[best])) best = a;
        taken[best] = true;
        r.trial[k] = trial[best], r.flow[k] = flow[best], r.tau[k] = (double)p->stress[best][0];
    }
    return r;
}

// What a return has to meet, whichever way it was found, which has one solution: no face is exceeded; flow is a sum of
// normals of the potential's faces with multipliers that are not negative, each of a face that is met; mean stress is
// that of the elastic volume, or the limit of tension.
static int check_return(const double trial[3], point *p) {
    const double sf = sin(parameter(p, "friction_angle")), sd = sin(parameter(p, "dilatancy_angle")),
                 strength = 2 * cos(parameter(p, "friction_angle")) *
                            (parameter(p, "cohesion") + parameter(p, "hardening") * state_of(p, "plastic_strain")),
                 tight = TOLERANCE(1e-12, 3e-5) * GPA * (1e-3 + fabs(trial[0]) + fabs(trial[1]) + fabs(trial[2]));
    double e[3], flow[3];
    elastic_strains(p, e);
    for (int a = 0; a < 3; a++) flow[a] = trial[a] - e[a];
    const ranked r = rank_axes(trial, flow, p);
#define FACE(i, j) ((1 + sf) * r.tau[i] - (1 - sf) * r.tau[j] - strength)
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (i != j) ck_assert_double_le(FACE(i, j), tight);
    const double bulk = 1 / 1.2 * GPA, volume = e[0] + e[1] + e[2],
                 tension = fmin(parameter(p, "tension"),
                                sf > 0 ? parameter(p, "cohesion") / tan(parameter(p, "friction_angle")) : INFINITY);
    ck_assert_double_eq_tol((r.tau[0] + r.tau[1] + r.tau[2]) / 3, fmin(bulk * volume, tension), tight);
    const double small = tight / GPA;
    if (state_of(p, "plastic_strain") == 0) {
        for (int a = 0; a < 3; a++) ck_assert_double_le(fabs(flow[a]), small);
        return 0;
    }
    const bool right = r.flow[1] < 0;
    const double second = right ? -r.flow[1] / (1 - sd) : r.flow[1] / (1 + sd),
                 first = right ? -r.flow[2] / (1 - sd) : r.flow[0] / (1 + sd), sum = first + second;
    ck_assert_double_ge(first, -small);
    ck_assert_double_eq_tol(right ? r.flow[0] / (1 + sd) : -r.flow[2] / (1 - sd), sum, 10 * small);
    ck_assert_double_ge(FACE(0, 2), -10 * tight);
    if (second <= 10 * small) return 1;
    ck_assert_double_ge(right ? FACE(0, 1) : FACE(1, 2), -10 * tight);
    return fabs(r.tau[0] - r.tau[2]) < tight ? 4 : right ? 2 : 3;
#undef FACE
}

START_TEST(returns_meet_their_conditions) {
    const double angles[][2] = {{0.5, 0}, {0.5, 0.2}, {0.5, 0.5}, {0, 0}, {1.2, 0.7}}, cohesion[] = {1 * MPA, 0};
    uint64_t seed = 3;
    int found[5] = {0};
    for (int n = 0; n < 20000; n++) {
        const int k = n % 5;
        const value soil[] = {{"E", 1 * GPA},
                              {"nu", 0.3},
                              {"cohesion", k == 3 ? 1 * MPA : cohesion[n / 5 % 2]},
                              {"friction_angle", angles[k][0]},
                              {"dilatancy_angle", angles[k][1]},
                              {"tension", n / 10 % 3 == 0 ? 0.3 * MPA : INFINITY},
                              {"hardening", n / 30 % 2 ? 50 * MPA : 0},
                              {NULL, 0}};
        point p = make("mohr-coulomb", 2000, soil, NULL);
        double trial[3], e[3];
        const double size = n % 7 ? 5e-3 : 0.1, mean = size * uniform(&seed);
        for (int a = 0; a < 3; a++) trial[a] = mean + size * uniform(&seed), e[a] = expm1(trial[a]);
        if (n % 11 == 0) trial[1] = trial[2], e[1] = e[2];
        stretch(&p, e);
        found[check_return(trial, &p)]++;
    }
    printf("returns: %d elastic, %d face, %d and %d edges, %d apex\n", found[0], found[1], found[2], found[3],
           found[4]);
    for (int k = 0; k < 5; k++) ck_assert_int_gt(found[k], 300);
}
END_TEST

// However stiff hardening is: from a cohesion at which the first flow alone would take the strength above the trial's,
// to one that leaves the trial as it is. Stress grows with it up to there.
START_TEST(hardening_may_be_stiff) {
    const double hardening[] = {0.1, 1, 2, 5, 100, 1e6, 1e20};
    uint64_t seed = 11;
    for (int n = 0; n < 2000; n++) {
        double trial[3], e[3], flown = INFINITY;
        for (int a = 0; a < 3; a++) trial[a] = 5e-3 * uniform(&seed), e[a] = expm1(trial[a]);
        for (int k = 0; k < 7; k++) {
            const value soil[] = {{"E", 1 * GPA},
                                  {"nu", 0.3},
                                  {"cohesion", 0.5 * MPA},
                                  {"friction_angle", 0.5},
                                  {"dilatancy_angle", n % 2 ? 0.2 : 0},
                                  {"hardening", hardening[k] * GPA},
                                  {NULL, 0}};
            point p = make("mohr-coulomb", 2000, soil, NULL);
            stretch(&p, e);
            const double strain = state_of(&p, "plastic_strain");
            if (k < 4) check_return(trial, &p);
            ck_assert_double_le(strain, flown * (1 + TOLERANCE(1e-12, 1e-5)) + TOLERANCE(1e-17, 1e-9));
            ck_assert_double_le(strain * fmin(hardening[k], 1e6), TOLERANCE(0.02, 0.03));
            flown = strain;
        }
    }
}
END_TEST

// Axes that are named otherwise: the same stresses and state under the new names, over a path.
START_TEST(axes_have_no_order) {
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const value soil[] = {
        {"E", 1 * GPA},         {"nu", 0.3}, {"cohesion", 0.2 * MPA}, {"friction_angle", 0.5}, {"dilatancy_angle", 0.1},
        {"hardening", 5 * MPA}, {NULL, 0}};
    point p[6];
    uint64_t seed = 5;
    for (int k = 0; k < 6; k++) p[k] = make("mohr-coulomb", 2000, soil, NULL);
    for (int step = 0; step < 200; step++) {
        const double e[3] = {4e-4 * uniform(&seed) - 5e-5, 4e-4 * uniform(&seed), 4e-4 * uniform(&seed)};
        for (int k = 0; k < 6; k++) stretch(&p[k], (double[3]){e[order[k][0]], e[order[k][1]], e[order[k][2]]});
        for (int k = 1; k < 6; k++)
            for (int a = 0; a < 3; a++)
                ck_assert_double_eq_tol((double)p[k].stress[a][0], (double)p[0].stress[order[k][a]][0],
                                        TOLERANCE(1e-4, 1e3));
    }
    ck_assert_double_gt(state_of(&p[0], "plastic_strain"), 1e-3);
}
END_TEST

// Tension ends at the apex, c / tan(phi), or where it is cut off; what opened closes where it opened, and leaves no
// plastic strain.
START_TEST(apex_opens_and_closes) {
    for (int k = 0; k < 3; k++) {
        const value soil[] = {{"E", 1 * GPA},
                              {"nu", 0.3},
                              {"cohesion", k == 2 ? 0 : 1 * MPA},
                              {"friction_angle", 0.6},
                              {"dilatancy_angle", 0.2},
                              {"tension", k == 1 ? 0.5 * MPA : INFINITY},
                              {NULL, 0}};
        point p = make("mohr-coulomb", 2000, soil, NULL);
        compress_to(&p, -0.01, 200, false);
        const double limit = k == 2 ? 0 : k ? 0.5 * MPA : MPA / tan(0.6);
        for (int a = 0; a < 3; a++) ck_assert_double_eq_tol((double)p.stress[a][0], limit, TOLERANCE(1e-4, 1e4));
        compress_to(&p, 0.002, 200, false);
        ck_assert_double_eq_tol(pressure_of(&p) * volume_of(&p), log1p(0.002) * GPA / 1.2, TOLERANCE(1e-7, 1e-3) * GPA);
        ck_assert_double_le(state_of(&p, "plastic_strain"), TOLERANCE(1e-12, 1e-5));
        check_ledger(&p, TOLERANCE(2e-2, 5e-2), "apex");
    }
}
END_TEST

// Cycles of compression, tension and shear: nothing of what is dissipated comes back, and the ledger closes to second
// order.
START_TEST(dissipation_never_falls) {
    const double dilatancy[] = {0, 0.25, 0.5};
    for (int k = 0; k < 3; k++) {
        const value soil[] = {{"E", 1 * GPA},
                              {"nu", 0.3},
                              {"cohesion", 1 * MPA},
                              {"friction_angle", 0.5},
                              {"dilatancy_angle", dilatancy[k]},
                              {"hardening", 10 * MPA},
                              {NULL, 0}};
        double error[2];
        for (int fine = 0; fine < 2; fine++) {
            const int steps = fine ? 8000 : 1000;
            point p = make("mohr-coulomb", 2000, soil, NULL);
            compress_to(&p, 0.004, 100, false);
            double last = 0, size = 0.01 / steps * 6.28;
            for (int step = 0; step < 2 * steps; step++) {
                const double t = 6.283185307179586 * (step + 0.5) / steps;
                stretch(&p, (double[3]){size * sin(t), -0.3 * size * sin(2 * t), 0.5 * size * cos(3 * t)});
                const double plastic = energy_of(&p).plastic;
                ck_assert_double_ge(plastic, last - TOLERANCE(1e-9, 1e-5) * (1 + last));
                last = plastic;
            }
            const brunt_point_energy e = energy_of(&p);
            ck_assert_double_gt(last, 0);
            error[fine] = fabs(e.internal + e.plastic - p.work) / last;
        }
        printf("dilatancy %.2f: ledger off by %.2g, with an eighth of the step %.2g\n", dilatancy[k], error[0],
               error[1]);
        ck_assert_double_le(error[1], TOLERANCE(1e-5, 1e-2));
        if (TOLERANCE(1, 0)) ck_assert(error[1] <= error[0] / 16 || error[1] < 1e-6);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("mohr_coulomb");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_test(all, triaxial_strength);
    tcase_add_test(all, returns_meet_their_conditions);
    tcase_add_test(all, hardening_may_be_stiff);
    tcase_add_test(all, axes_have_no_order);
    tcase_add_test(all, apex_opens_and_closes);
    tcase_add_test(all, dissipation_never_falls);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
