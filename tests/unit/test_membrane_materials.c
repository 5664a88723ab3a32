// Plane-stress forms of the materials, with and without resistance to compression, through the model tables.
#include <check.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/simd.h"
#include "base/memory.h"
#include "materials/prepared.h"
#include "tests/support/suite.h"

static const double epsilon = TOLERANCE(DBL_EPSILON, FLT_EPSILON);

static const double young = 3e6, density = 1200;
enum { LINEAR, ST_VENANT, NEO_HOOKEAN, LAWS, RATIOS = 5, FORMS = LAWS * RATIOS * 2 };
static const char *const law_name[LAWS] = {"linear-elastic", "st-venant-kirchhoff", "neo-hookean"};
static const double poisson[RATIOS] = {0.3, 0, -0.4, 0.45, 0.499};

// ------------------------------------------------------------------------------------------------------- a few points

enum { ROOM = 4 * BRUNT_LANES };
typedef struct sheet {
    const brunt_model *model;
    double E, nu, plane, mu, lambda; // plane: E / (1 - nu^2)
    real constants[BRUNT_MAX_CONSTANTS];
    brunt_material_points points;
    real F[4][ROOM], stress[4][ROOM], thickness[ROOM], volume[ROOM];
} sheet;

static void membrane_make(sheet *s, int law, double nu, bool slack) {
    memset(s, 0, sizeof *s);
    s->model = brunt_find_strength(law_name[law]);
    ck_assert(s->model && s->model->update_plane_stress && s->model->energy_plane_stress &&
              s->model->wave_speed_plane_stress);
    s->E = young, s->nu = nu, s->plane = young / (1 - nu * nu), s->mu = young / (2 * (1 + nu));
    s->lambda = young * nu / ((1 + nu) * (1 - 2 * nu));
    double parameters[BRUNT_MAX_PARAMETERS] = {young, nu};
    ck_assert_ptr_null(s->model->prepare(parameters, density, false, s->constants));
    s->points = (brunt_material_points){.count = BRUNT_LANES, .dim = 2, .dt = 1, .tension_only = slack};
    for (int k = 0; k < 4; k++) s->points.F[k] = s->F[k], s->points.stress[k] = s->stress[k];
    s->points.thickness = s->thickness, s->points.volume = s->volume;
    for (int i = 0; i < ROOM; i++) s->F[0][i] = s->F[3][i] = s->volume[i] = 1;
}

static int form_law(int form) { return form / (RATIOS * 2); }
static bool form_slack(int form) { return form % 2; }
static void membrane_of(sheet *s, int form) {
    membrane_make(s, form_law(form), poisson[form / 2 % RATIOS], form_slack(form));
}

typedef struct sym {
    double xx, yy, xy;
} sym;

static sym principal(double l1, double l2, double angle) {
    double m = (l1 + l2) / 2, d = (l1 - l2) / 2;
    return (sym){m + d * cos(2 * angle), m - d * cos(2 * angle), d * sin(2 * angle)};
}
static void set_stretch(sheet *s, int i, sym U) {
    s->F[0][i] = (real)U.xx, s->F[1][i] = s->F[2][i] = (real)U.xy, s->F[3][i] = (real)U.yy;
}
static sym get_stretch(const sheet *s, int i) {
    return (sym){(double)s->F[0][i], (double)s->F[3][i], (double)s->F[1][i]};
}
static sym get_stress(const sheet *s, int i) {
    return (sym){(double)s->stress[0][i], (double)s->stress[1][i], (double)s->stress[3][i]};
}
static double size_of(sym a) { return sqrt(a.xx * a.xx + a.yy * a.yy + 2 * a.xy * a.xy); }
static sym minus(sym a, sym b) { return (sym){a.xx - b.xx, a.yy - b.yy, a.xy - b.xy}; }

// The response of all points to one stretch; the speed, or a failed test.
static double respond(sheet *s, sym U) {
    for (int i = 0; i < s->points.count; i++) set_stretch(s, i, U);
    brunt_update_result result = s->model->update_plane_stress(s->constants, &s->points);
    ck_assert_msg(result.bad < 0, "%s nu %g: %s at %g %g %g", s->model->name, s->nu, result.reason, U.xx, U.yy, U.xy);
    ck_assert(s->stress[2][0] == 0);
    return (double)result.wave_speed;
}
static sym stress_at(sheet *s, sym U) {
    respond(s, U);
    return get_stress(s, 0);
}
static double energy_at(sheet *s, sym U) {
    brunt_point_energy energy = {0};
    for (int i = 0; i < s->points.count; i++) set_stretch(s, i, U);
    s->model->energy_plane_stress(s->constants, &s->points, &energy);
    ck_assert(energy.plastic == 0 && energy.viscosity == 0);
    return energy.internal / s->points.count;
}

static double uniform(uint64_t *seed) { // -1 .. 1
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    uint64_t x = (*seed ^ (*seed >> 31)) * 0x9e3779b97f4a7c15u;
    return (double)(x >> 11) / 4503599627370496.0 - 1;
}
static sym random_stretch(uint64_t *seed, double strain) {
    double l1 = 1 + strain * uniform(seed), l2 = 1 + strain * uniform(seed);
    return principal(l1, l2, 3 * uniform(seed));
}

// ------------------------------------------------------------------------------------------------------- every law

START_TEST(rest) {
    sheet s;
    membrane_of(&s, _i);
    double speed = respond(&s, (sym){1, 1, 0}), expect = sqrt(s.plane / density);
    ck_assert(size_of(get_stress(&s, 0)) == 0 && s.thickness[0] == 1 && energy_at(&s, (sym){1, 1, 0}) == 0);
    ck_assert_double_eq_tol(speed, expect, 10 * epsilon * expect);
    ck_assert_double_eq_tol((double)s.model->wave_speed_plane_stress(s.constants), expect, 10 * epsilon * expect);
}
END_TEST

// dW = (U^-1 tau) : dU, as tau has the axes of U; central differences along random directions, through all states of a
// slack sheet.
START_TEST(stress_is_derivative_of_energy) {
    sheet s;
    membrane_of(&s, _i);
    uint64_t seed = 3;
    const double h = TOLERANCE(1e-6, 1e-2);
    for (int n = 0; n < 200; n++) {
        sym U = random_stretch(&seed, 0.2), d = {uniform(&seed), uniform(&seed), uniform(&seed)};
        sym tau = stress_at(&s, U);
        double det = U.xx * U.yy - U.xy * U.xy;
        sym biot = {(U.yy * tau.xx - U.xy * tau.xy) / det, (U.xx * tau.yy - U.xy * tau.xy) / det,
                    (U.yy * tau.xy - U.xy * tau.yy) / det};
        double power = biot.xx * d.xx + biot.yy * d.yy + 2 * biot.xy * d.xy;
        double ahead = energy_at(&s, (sym){U.xx + h * d.xx, U.yy + h * d.yy, U.xy + h * d.xy});
        double behind = energy_at(&s, (sym){U.xx - h * d.xx, U.yy - h * d.yy, U.xy - h * d.xy});
        double slope = (ahead - behind) / (2 * h);
        // A difference across an edge between two states is off by their tangents' difference times h.
        ck_assert_msg(fabs(slope - power) <= TOLERANCE(4e-6, 4e-2) * s.plane, "%s nu %g: %.10g, stress gives %.10g",
                      s.model->name, s.nu, slope, power);
    }
}
END_TEST

START_TEST(response_turns_with_the_axes) {
    sheet s;
    membrane_of(&s, _i);
    uint64_t seed = 4;
    for (int n = 0; n < 100; n++) {
        double l1 = 1 + 0.2 * uniform(&seed), l2 = 1 + 0.2 * uniform(&seed), a = 3 * uniform(&seed);
        sym straight = stress_at(&s, principal(l1, l2, 0));
        double across = (double)s.thickness[0];
        sym turned = stress_at(&s, principal(l1, l2, a));
        ck_assert(straight.xy == 0);
        double error = size_of(minus(turned, principal(straight.xx, straight.yy, a)));
        ck_assert_double_le(error, 8 * epsilon * s.plane);
        ck_assert_double_eq_tol((double)s.thickness[0], across, 8 * epsilon);
    }
}
END_TEST

// Hooke's law of plane stress keeps its digits at strains where F^T F - I would have few: all that is left is the
// strain itself.
START_TEST(small_strain_is_hooke) {
    sheet s;
    membrane_of(&s, _i);
    if (form_slack(_i)) return;
    uint64_t seed = 5;
    for (int n = 0; n < 60; n++) {
        double strain = pow(10, -TOLERANCE(2 + n % 9, 2 + n % 3));
        sym U = random_stretch(&seed, strain), tau = stress_at(&s, U), e = get_stretch(&s, 0); // U as it is stored
        e.xx -= 1, e.yy -= 1;
        sym hooke = {s.plane * (e.xx + s.nu * e.yy), s.plane * (e.yy + s.nu * e.xx), 2 * s.mu * e.xy};
        double scale = s.plane * size_of(e);
        ck_assert_double_le(size_of(minus(tau, hooke)), (8 * strain + 8 * epsilon) * scale);
        double across = -s.nu / (1 - s.nu) * (e.xx + e.yy);
        ck_assert_double_eq_tol((double)s.thickness[0] - 1, across, 8 * strain * strain + 2 * epsilon);
        double stored = 0.5 * (hooke.xx * e.xx + hooke.yy * e.yy + 2 * hooke.xy * e.xy), got = energy_at(&s, U);
        ck_assert_double_eq_tol(got, stored, (8 * strain + 200 * epsilon) * scale * size_of(e));
    }
}
END_TEST

static bool same_bits(const sheet *a, int i, const sheet *b, int j) {
    bool same = memcmp(&a->thickness[i], &b->thickness[j], sizeof(real)) == 0;
    for (int k = 0; k < 4; k++) same &= memcmp(&a->stress[k][i], &b->stress[k][j], sizeof(real)) == 0;
    return same;
}

// A point among others in all states, and the same one alone: the same bits.
START_TEST(batch_equals_point) {
    sheet batch, alone;
    membrane_of(&batch, _i), membrane_of(&alone, _i);
    batch.points.count = ROOM;
    const double strains[] = {1e-6, 1e-2, 0.2, 0.3};
    uint64_t seed = 6;
    for (int i = 0; i < ROOM; i++) set_stretch(&batch, i, random_stretch(&seed, strains[i % 4]));
    ck_assert(batch.model->update_plane_stress(batch.constants, &batch.points).bad < 0);
    for (int i = 0; i < ROOM; i++) {
        respond(&alone, get_stretch(&batch, i));
        ck_assert_msg(same_bits(&batch, i, &alone, 0), "%s nu %g: point %d", batch.model->name, batch.nu, i);
    }
}
END_TEST

// First Piola-Kirchhoff stress of a deformation gradient of the plane, by its polar decomposition.
typedef struct mat2 {
    double a[2][2];
} mat2;
static mat2 first_stress(sheet *s, mat2 F) {
    double turn = atan2(F.a[1][0] - F.a[0][1], F.a[0][0] + F.a[1][1]), c = cos(turn), n = sin(turn);
    double R[2][2] = {{c, -n}, {n, c}}, U[2][2] = {{0}}, P[2][2] = {{0}};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            for (int k = 0; k < 2; k++) U[i][j] += R[k][i] * F.a[k][j];
    sym tau = stress_at(s, (sym){U[0][0], U[1][1], U[0][1]});
    double t[2][2] = {{tau.xx, tau.xy}, {tau.xy, tau.yy}}, det = U[0][0] * U[1][1] - U[0][1] * U[1][0];
    double inverse[2][2] = {{U[1][1] / det, -U[0][1] / det}, {-U[1][0] / det, U[0][0] / det}};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            for (int k = 0; k < 2; k++)
                for (int l = 0; l < 2; l++) P[i][j] += R[i][k] * t[k][l] * inverse[l][j];
    return (mat2){{{P[0][0], P[0][1]}, {P[1][0], P[1][1]}}};
}

// rho0 c^2 = m . (dP F^T) n for dF = (m n) F, along unit vectors at angles `a` (n) and `b` (m); Kirchhoff, in current
// lengths.
static double tangent(sheet *s, sym U, double a, double b) {
    const double h = TOLERANCE(1e-6, 1e-3), n[2] = {cos(a), sin(a)}, m[2] = {cos(b), sin(b)};
    const double u[2][2] = {{U.xx, U.xy}, {U.xy, U.yy}};
    double along[2] = {u[0][0] * n[0] + u[1][0] * n[1], u[0][1] * n[0] + u[1][1] * n[1]}, sum = 0; // n F
    mat2 ahead, behind;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            ahead.a[i][j] = u[i][j] + h * m[i] * along[j];
            behind.a[i][j] = u[i][j] - h * m[i] * along[j];
        }
    ahead = first_stress(s, ahead), behind = first_stress(s, behind);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) sum += m[i] * (ahead.a[i][j] - behind.a[i][j]) / (2 * h) * along[j];
    return sum;
}

// No wave is faster than the update says, in the plane or out of it.
START_TEST(wave_speed_is_a_bound) {
    sheet s;
    membrane_of(&s, _i);
    uint64_t seed = 8;
    double loosest = 0;
    for (int state = 0; state < 12; state++) {
        double stretch = s.model->small_strain || s.nu > 0.4 ? 0.2 : 0.4;
        double l1 = 1 + stretch * uniform(&seed), l2 = 1 + stretch * uniform(&seed);
        if (state < 3) l2 = 1 + 0.1 * (state - 1), l1 = (s.nu > 0.4 ? 1.2 : 1.4) * l2; // strong tension
        sym U = principal(l1, l2, 0.4);
        double speed = respond(&s, U), bound = density * speed * speed, most = 0;
        sym tau = get_stress(&s, 0);
        double tension = (tau.xx + tau.yy) / 2 + sqrt(pow((tau.xx - tau.yy) / 2, 2) + tau.xy * tau.xy);
        enum { ANGLES = 24 };
        for (int a = 0; a < ANGLES; a++)
            for (int b = 0; b < ANGLES; b++)
                most = fmax(most, tangent(&s, U, 0.4 + a * M_PI / ANGLES, 0.4 + b * M_PI / ANGLES));
        ck_assert_double_ge(bound, tension);
        ck_assert_msg(bound >= most * (1 - TOLERANCE(1e-6, 1e-2)), "%s nu %g at %g %g: bound %.8g, wave %.8g",
                      s.model->name, s.nu, l1, l2, bound, most);
        if (bound > 1.001 * s.plane && !form_slack(_i)) loosest = fmax(loosest, bound / most);
    }
    // Where it says more than at rest it is that of a wave (of a slack sheet it may be that of a taut one).
    ck_assert_double_le(loosest, 1 + TOLERANCE(1e-6, 2e-2));
}
END_TEST

// ------------------------------------------------------------------------------------------------------- closed forms

START_TEST(linear_uniaxial) {
    sheet s;
    membrane_make(&s, LINEAR, 0.3, _i);
    for (int n = 0; n < 8; n++) {
        double e = 0.05 * (n + 1);
        sym tau = stress_at(&s, (sym){1 + e, 1 - 0.3 * e, 0});
        ck_assert_double_eq_tol(tau.xx, (1 + e) * young * e, 8 * epsilon * young);
        ck_assert_double_eq_tol(tau.yy, 0, 8 * epsilon * young);
        ck_assert_double_eq_tol((double)s.thickness[0], 1 - 0.3 * e, 4 * epsilon);
        ck_assert_double_eq_tol(energy_at(&s, (sym){1 + e, 1 - 0.3 * e, 0}), young * e * e / 2, 8 * epsilon * young);
    }
}
END_TEST

START_TEST(st_venant_uniaxial) {
    sheet s;
    membrane_make(&s, ST_VENANT, 0.3, _i);
    for (int n = 0; n < 8; n++) {
        double E = 0.05 * (n + 1), l = sqrt(1 + 2 * E), w = sqrt(1 - 2 * 0.3 * E);
        sym tau = stress_at(&s, (sym){w, l, 0});
        ck_assert_double_eq_tol(tau.yy, l * l * young * E, 8 * epsilon * young);
        ck_assert_double_eq_tol(tau.xx, 0, 8 * epsilon * young);
        ck_assert_double_eq_tol((double)s.thickness[0], w, 4 * epsilon);
    }
}
END_TEST

// s with mu (e^(2s) - 1) + lambda (m s + c) = 0 by bisection in a wider type.
static long double bisect(const sheet *s, long double m, long double c) {
    long double low = -12, high = 12;
    if (s->lambda < 0) low = 0.5L * logl((long double)(-s->lambda / (2 * s->mu))) + 1e-3L;
    for (int n = 0; n < 120; n++) {
        long double middle = (low + high) / 2;
        if ((long double)s->mu * expm1l(2 * middle) + (long double)s->lambda * (m * middle + c) > 0)
            high = middle;
        else
            low = middle;
    }
    return (low + high) / 2;
}

// Against the definition: l3 solved in a wider type; stretches from 0.2 to 6.
START_TEST(neo_hookean_thickness) {
    const double ratios[] = {0, 0.3, 0.499, 0.4999, -0.5};
    sheet s;
    membrane_make(&s, NEO_HOOKEAN, ratios[_i], false);
    uint64_t seed = 9;
    double worst = 0;
    for (int n = 0; n < 300; n++) {
        double range = s.nu < 0 ? 0.15 : 1.7;
        double l1 = exp(range * uniform(&seed)), l2 = exp(range * uniform(&seed));
        if (n % 3 == 0) l1 = 1 + 1e-3 * uniform(&seed), l2 = 1 + 1e-3 * uniform(&seed);
        sym tau = stress_at(&s, (sym){l1, l2, 0});
        l1 = (double)s.F[0][0], l2 = (double)s.F[3][0];
        long double l3 = expl(bisect(&s, 1, logl((long double)l1 * (long double)l2)));
        // What the law sees are strains, those of Mohr's circle: a stretch is as good as the greater one or as 1, and
        // l3^2 as good as 1.
        double rounding = epsilon * (fmax(l1 / l2, l2 / l1) + 1 / (l1 * l2) + (double)(1 / (l3 * l3)));
        worst = fmax(worst, fabs((double)((long double)s.thickness[0] / l3 - 1)) / rounding);
        double t1 = s.mu * (l1 * l1 - (double)(l3 * l3)), t2 = s.mu * (l2 * l2 - (double)(l3 * l3));
        double scale = s.mu * (l1 * l1 + l2 * l2 + (double)(l3 * l3));
        ck_assert_double_le(hypot(tau.xx - t1, tau.yy - t2), 20 * epsilon * scale);
    }
    printf("nu %g: l3 off by %.2f rounding errors\n", s.nu, worst);
    ck_assert_msg(worst <= 1, "nu %g: l3 off by %g rounding errors", s.nu, worst);
}
END_TEST

// The solid law with F = diag(U, l3) has no stress across and the same in the plane.
START_TEST(neo_hookean_is_the_solid) {
    sheet s;
    membrane_make(&s, NEO_HOOKEAN, poisson[_i], false);
    real F[9][BRUNT_LANES] = {{0}}, L[9][BRUNT_LANES] = {{0}}, stress[6][BRUNT_LANES] = {{0}};
    brunt_material_points solid = {.count = BRUNT_LANES, .dim = 3, .dt = 1, .volume = s.volume};
    for (int k = 0; k < 9; k++) solid.F[k] = F[k], solid.L[k] = L[k];
    for (int k = 0; k < 6; k++) solid.stress[k] = stress[k];
    uint64_t seed = 10;
    for (int n = 0; n < 50; n++) {
        sym U = random_stretch(&seed, 0.25), tau = stress_at(&s, U);
        for (int i = 0; i < BRUNT_LANES; i++) {
            F[0][i] = s.F[0][i], F[1][i] = F[3][i] = s.F[1][i], F[4][i] = s.F[3][i], F[8][i] = s.thickness[i];
        }
        ck_assert(s.model->update(s.constants, &solid).bad < 0);
        brunt_point_energy energy = {0};
        s.model->energy(s.constants, &solid, &energy);
        // The solid's pressure is lambda ln J: it is as good as J is.
        double rounding = 10 * epsilon * (s.lambda + s.plane);
        sym in_plane = {(double)stress[0][0], (double)stress[1][0], (double)stress[3][0]};
        ck_assert_double_le(size_of(minus(tau, in_plane)), rounding);
        ck_assert_double_le(fabs((double)stress[2][0]), rounding);
        ck_assert_double_eq_tol(energy.internal / BRUNT_LANES, energy_at(&s, U), rounding);
    }
}
END_TEST

// B27. Pressure of a rubber balloon, p R0 / (2 mu t0) = tau / (mu l^3): with no change of volume 1/l - 1/l^7, which is
// greatest at l = 7^(1/6) (Needleman, Int. J. Solids Struct. 13 (1977) 409).
static double balloon_pressure(sheet *s, double l) { return stress_at(s, (sym){l, l, 0}).xx / (s->mu * l * l * l); }

START_TEST(balloon_has_its_greatest_pressure) {
    const double ratios[] = {0.499, 0.4999}, peak = pow(7, 1 / 6.0), height = 1 / peak - pow(peak, -7);
    for (int k = 0; k < 2; k++) {
        sheet s;
        membrane_make(&s, NEO_HOOKEAN, ratios[k], false);
        double low = 1.1, high = 1.9;
        while (high - low > TOLERANCE(1e-6, 2e-2)) {
            double a = low + (high - low) / 3, b = high - (high - low) / 3;
            if (balloon_pressure(&s, a) < balloon_pressure(&s, b))
                low = a;
            else
                high = b;
        }
        double off = 1 - 2 * ratios[k]; // compressibility: mu / lambda
        ck_assert_double_eq_tol((low + high) / 2, peak, 2 * off + TOLERANCE(1e-4, 3e-2));
        ck_assert_double_eq_tol(balloon_pressure(&s, peak), height, off + TOLERANCE(1e-6, 1e-4));
    }
}
END_TEST

// ------------------------------------------------------------------------------------------------------- slack sheets

// The width that uniaxial tension by l leaves.
static double natural_width(const sheet *s, int law, double l) {
    if (law == LINEAR) return 1 - s->nu * (l - 1);
    if (law == ST_VENANT) return sqrt(1 - s->nu * (l * l - 1));
    return (double)expl(bisect(s, 2, logl((long double)l)));
}

// No compression is borne; in tension with any width below the natural one the stress is that of uniaxial tension.
START_TEST(slack_bears_tension_only) {
    sheet s, stiff;
    int law = _i / RATIOS;
    membrane_make(&s, law, poisson[_i % RATIOS], true);
    membrane_make(&stiff, law, poisson[_i % RATIOS], false);
    uint64_t seed = 12;
    for (int n = 0; n < 60; n++) {
        double u = 0.5 * (1 + uniform(&seed)), v = 0.5 * (1 + uniform(&seed));
        sym U = principal(1 - 0.6 * u, 1 - 0.6 * v, 3 * u);
        ck_assert(size_of(stress_at(&s, U)) == 0 && s.thickness[0] == 1 && energy_at(&s, U) == 0);

        double l = 1 + 0.2 * u + 1e-3, w = natural_width(&s, law, l), a = 3 * uniform(&seed);
        double width = w - (w - 0.2) * v - 1e-3;
        sym uniaxial = stress_at(&stiff, principal(l, w, a));
        sym wrinkled = stress_at(&s, principal(l, width, a));
        ck_assert_double_le(size_of(minus(wrinkled, uniaxial)), 30 * epsilon * s.plane);
        ck_assert_double_le(fabs(wrinkled.xx * wrinkled.yy - wrinkled.xy * wrinkled.xy),
                            8 * epsilon * pow(size_of(wrinkled), 2)); // uniaxial
        ck_assert_double_eq_tol((double)s.thickness[0], (double)stiff.thickness[0], 10 * epsilon);
        double stored = energy_at(&stiff, principal(l, w, a));
        ck_assert_double_eq_tol(energy_at(&s, principal(l, width, a)), stored, 30 * epsilon * s.plane);

        sym taut = principal(l, fmin(l, w + (l - w) * v), a);
        ck_assert_double_le(size_of(minus(stress_at(&s, taut), stress_at(&stiff, taut))), 30 * epsilon * s.plane);
        ck_assert_double_eq_tol(energy_at(&s, taut), energy_at(&stiff, taut), 30 * epsilon * s.plane);
    }
}
END_TEST

// Young's modulus: wrinkled stress over strain, for a strain at which all laws agree.
START_TEST(slack_has_youngs_modulus) {
    sheet s;
    membrane_make(&s, _i / RATIOS, poisson[_i % RATIOS], true);
    const double e = TOLERANCE(1e-7, 1e-3);
    sym tau = stress_at(&s, (sym){0.8, 1 + e, 0});
    double strain = (double)s.F[3][0] - 1;
    ck_assert_double_eq_tol(tau.yy / strain, young, (4 * e + 20 * epsilon) * young);
    ck_assert(tau.xx == 0 || fabs(tau.xx) <= epsilon * tau.yy);
}
END_TEST

// Pipkin: the relaxed energy is the least that a sheet can have which is stretched at least as much in both directions.
START_TEST(slack_energy_is_the_least) {
    sheet s, stiff;
    int law = _i / RATIOS;
    membrane_make(&s, law, poisson[_i % RATIOS], true);
    membrane_make(&stiff, law, poisson[_i % RATIOS], false);
    uint64_t seed = 13;
    for (int n = 0; n < 8; n++) {
        double l1 = 1 + 0.15 * uniform(&seed), l2 = 1 + 0.15 * uniform(&seed), least = INFINITY;
        enum { TRIALS = 60 };
        const double step = 0.006;
        for (int i = 0; i < TRIALS; i++)
            for (int j = 0; j < TRIALS; j++)
                least = fmin(least, energy_at(&stiff, (sym){l1 + step * i, l2 + step * j, 0}));
        double got = energy_at(&s, (sym){l1, l2, 0});
        // The least of the trials is above, by no more than the stiffness times the square of their spacing.
        ck_assert_msg(got <= least + 1e-5 * TOLERANCE(1e-6, 1) * young && got >= least - 2 * s.plane * step * step,
                      "%s nu %g at %g %g: %g, least %g", s.model->name, s.nu, l1, l2, got, least);
    }
}
END_TEST

// Stress changes by no more than a stiffness times the change of stretch, along paths through all three states.
START_TEST(slack_is_continuous) {
    sheet s;
    membrane_make(&s, _i / RATIOS, poisson[_i % RATIOS], true);
    const double ends[][4] = {{0.8, 0.9, 1.2, 1.15}, {1.2, 0.7, 1.2, 1.2}, {0.7, 1.2, 1.2, 1.15}, {1.2, 0.9, 0.9, 1.2}};
    enum { STEPS = 2000 };
    for (int path = 0; path < 4; path++) {
        sym last = {0, 0, 0};
        double stored = 0, work = 0, first = 0, e1 = 0, e2 = 0;
        for (int n = 0; n <= STEPS; n++) {
            double t = (double)n / STEPS;
            double l1 = ends[path][0] + t * (ends[path][2] - ends[path][0]);
            double l2 = ends[path][1] + t * (ends[path][3] - ends[path][1]);
            sym tau = stress_at(&s, (sym){l1, l2, 0});
            stored = energy_at(&s, (sym){l1, l2, 0});
            double biot1 = tau.xx / l1, biot2 = tau.yy / l2;
            if (n == 0)
                first = stored;
            else {
                double change = hypot(ends[path][2] - ends[path][0], ends[path][3] - ends[path][1]) / STEPS;
                ck_assert_double_le(size_of(minus(tau, last)), 8 * s.plane * change + 40 * epsilon * s.plane);
                work += (biot1 + e1) / 2 * (ends[path][2] - ends[path][0]) / STEPS +
                        (biot2 + e2) / 2 * (ends[path][3] - ends[path][1]) / STEPS;
            }
            last = tau, e1 = biot1, e2 = biot2;
        }
        ck_assert_double_eq_tol(stored - first, work, TOLERANCE(1e-6, 1e-4) * s.plane);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------------------- failures

static void expect_bad(sheet *s, sym U, const char *word) {
    for (int i = 0; i < ROOM; i++) set_stretch(s, i, (sym){1.01, 1, 0.01});
    s->points.count = ROOM;
    const int where = ROOM - 2 > 0 ? ROOM - 2 : 0;
    set_stretch(s, where, U);
    brunt_update_result result = s->model->update_plane_stress(s->constants, &s->points);
    ck_assert_msg(result.bad == where, "%s %g %g %g: bad %d", s->model->name, U.xx, U.yy, U.xy, (int)result.bad);
    ck_assert_msg(strstr(result.reason, word) != NULL, "%s: %s", s->model->name, result.reason);
}

START_TEST(bad_points_are_reported) {
    sheet s;
    membrane_of(&s, _i);
    expect_bad(&s, (sym){1, -0.1, 0}, "inside out");
    expect_bad(&s, (sym){1, 1, 1.5}, "inside out");
    expect_bad(&s, (sym){-1, -2, 0}, "inside out");
    expect_bad(&s, (sym){1, 0, 0}, "inside out");
    const double no_number[] = {NAN, INFINITY, -INFINITY};
    for (int k = 0; k < 3; k++) {
        expect_bad(&s, (sym){no_number[k], 1, 0}, "finite");
        expect_bad(&s, (sym){1, no_number[k], 0}, "finite");
        expect_bad(&s, (sym){1, 1, no_number[k]}, "finite");
    }
    if (s.nu > 0.2 && form_law(_i) != NEO_HOOKEAN) expect_bad(&s, (sym){3, 3, 0}, "thickness");
    // The law with nu < 0 shrinks to nothing in strong compression of both stretches; a slack sheet is not compressed.
    membrane_make(&s, NEO_HOOKEAN, -0.8, false);
    expect_bad(&s, (sym){0.5, 0.5, 0}, "thickness");
    membrane_make(&s, NEO_HOOKEAN, -0.8, true);
    ck_assert(size_of(stress_at(&s, (sym){0.5, 0.5, 0})) == 0);
}
END_TEST

// Ends of what a neo-Hookean sheet may be asked: numbers come out.
START_TEST(extremes_are_admissible) {
    const double ratios[] = {0, 0.3, 0.4999}, stretches[] = {0.02, 0.5, 1, 2, 50};
    for (int r = 0; r < 3; r++)
        for (int slack = 0; slack < 2; slack++)
            for (int a = 0; a < 5; a++)
                for (int b = 0; b < 5; b++) {
                    sheet s;
                    membrane_make(&s, NEO_HOOKEAN, ratios[r], slack);
                    sym U = {stretches[a], stretches[b], 0};
                    double speed = respond(&s, U);
                    ck_assert(isfinite(speed) && speed > 0 && s.thickness[0] > 0);
                    ck_assert(isfinite(size_of(get_stress(&s, 0))) && energy_at(&s, U) >= 0);
                }
}
END_TEST

// ------------------------------------------------------------------------------------------------------- as a body's

// A body's material takes the form, and whether it is slack, in both stress and energy.
START_TEST(material_of_a_body) {
    brunt_material material;
    brunt_error error = {0};
    brunt_material_def def = brunt_material_def_default("cloth", "neo-hookean");
    def.density = density, def.strength_parameters[0] = young, def.strength_parameters[1] = 0.3;
    for (int slack = 0; slack < 2; slack++) {
        ck_assert_int_eq(brunt_material_make_membrane(&def, slack, &material, &error), BRUNT_OK);
        ck_assert_double_eq_tol((double)material.wave_speed, sqrt(young / 0.91 / density), 1e-4);
        sheet s;
        membrane_make(&s, NEO_HOOKEAN, 0.3, false);
        for (int i = 0; i < BRUNT_LANES; i++) set_stretch(&s, i, (sym){0.9, 0.95, 0.01});
        brunt_material_points points[BRUNT_COMPONENTS] = {[BRUNT_STRENGTH] = s.points};
        ck_assert_int_lt(brunt_material_update(&material, points, NULL, NULL, NULL).bad, 0);
        brunt_point_energy energy = {0};
        brunt_material_energy(&material, BRUNT_STRENGTH, &s.points, &energy);
        ck_assert((size_of(get_stress(&s, 0)) == 0) == slack && (energy.internal == 0) == slack);
    }
    def = brunt_material_def_default("steel", "von-mises");
    def.density = density, def.strength_parameters[0] = young, def.strength_parameters[1] = 0.3;
    def.strength_parameters[2] = 1e5;
    ck_assert_int_eq(brunt_material_make_membrane(&def, true, &material, &error), BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "neo-hookean") && strstr(error.message, "steel"), "%s", error.message);
}
END_TEST

static void nothing_is_leaked(void) { ck_assert_uint_eq(brunt_memory_live(), 0); }

int main(void) {
    Suite *suite = suite_create("sheets");
    TCase *all = tcase_create("every law");
    tcase_add_checked_fixture(all, NULL, nothing_is_leaked);
    tcase_add_loop_test(all, rest, 0, FORMS);
    tcase_add_loop_test(all, stress_is_derivative_of_energy, 0, FORMS);
    tcase_add_loop_test(all, response_turns_with_the_axes, 0, FORMS);
    tcase_add_loop_test(all, small_strain_is_hooke, 0, FORMS);
    tcase_add_loop_test(all, batch_equals_point, 0, FORMS);
    tcase_add_loop_test(all, wave_speed_is_a_bound, 0, FORMS);
    tcase_add_loop_test(all, bad_points_are_reported, 0, FORMS);
    suite_add_tcase(suite, all);
    TCase *closed = tcase_create("closed forms");
    tcase_add_loop_test(closed, linear_uniaxial, 0, 2);
    tcase_add_loop_test(closed, st_venant_uniaxial, 0, 2);
    tcase_add_loop_test(closed, neo_hookean_thickness, 0, 5);
    tcase_add_loop_test(closed, neo_hookean_is_the_solid, 0, RATIOS);
    tcase_add_test(closed, balloon_has_its_greatest_pressure);
    tcase_add_test(closed, extremes_are_admissible);
    suite_add_tcase(suite, closed);
    TCase *slack = tcase_create("slack");
    tcase_add_loop_test(slack, slack_bears_tension_only, 0, LAWS * RATIOS);
    tcase_add_loop_test(slack, slack_has_youngs_modulus, 0, LAWS * RATIOS);
    tcase_add_loop_test(slack, slack_energy_is_the_least, 0, LAWS * RATIOS);
    tcase_add_loop_test(slack, slack_is_continuous, 0, LAWS * RATIOS);
    tcase_add_test(slack, material_of_a_body);
    suite_add_tcase(suite, slack);
    return suite_main(suite);
}
