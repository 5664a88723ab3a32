// Labels: stability
//
// A membrane element of which two opposite edges pass through each other: its area passes through 0, and with it its
// normal turns without an end. What holds its warping mode must not.
#include <stdlib.h>

#include "tests/support/membrane_bodies.h"
#include "tests/support/suite.h"

enum { DIRECTIONS = 40 };

// A square of side 1, its upper edge now through the middle of the lower one, but for `apart`, and askew to it by an
// angle about an axis: chi = x + edge, psi = 2 apart, q = edge - x.
static brunt_fem_body crossed(int k, double apart, double coefficient) {
    random_state = 10 + (unsigned)k;
    brunt_mesh mesh = membrane_mesh(BRUNT_MEMBRANE_QUAD4, 1, 1, 1, 0, k % 2 ? 0.2 : 0, true);
    brunt_fem_body body = membrane_of(&mesh, (membrane_options){.tension_only = true, .coefficient = coefficient});
    const double angle = uniform(0.3, 2.5), turn = uniform(-3, 3), up = uniform(-3, 3), in = uniform(-1, 1);
    const double edge[3] = {cos(angle), sin(angle) * cos(turn), sin(angle) * sin(turn)};
    const double way[3] = {in, sqrt(1 - in * in) * cos(up), sqrt(1 - in * in) * sin(up)};
    for (int n = 0; n < 4; n++)
        for (int i = 0; i < 3; i++)
            brunt_fem_node(&body, n)[i] =
                (real)(n < 2 ? (i == 0) * n : 0.5 * (i == 0) + apart * way[i] + (n == 3 ? 0.5 : -0.5) * edge[i]);
    return body;
}

// The nearer the edges come the less it changes.
START_TEST(forces_stay_as_area_goes) {
    double most = 0;
    for (int k = 0; k < DIRECTIONS; k++) {
        double force[2];
        for (int near = 0; near < 2; near++) {
            brunt_fem_body body = crossed(k, near ? 1e-5 : 0.3, 1);
            ck_assert_int_eq(forces(&body, 1e-3).bad, -1);
            force[near] = force_scale(&body);
            brunt_fem_free(&body);
        }
        most = fmax(most, force[1] / force[0]);
    }
    printf("  edges that touch have up to %.2g times the force of those 0.3 of an edge apart\n", most);
    ck_assert_double_lt(most, 8);
}
END_TEST

START_TEST(forces_are_the_slope_of_the_energy) {
    if (sizeof(real) == 4) return;
    double worst = 0;
    for (int k = 0; k < DIRECTIONS; k++) {
        brunt_fem_body body = crossed(k, pow(10, -0.1 * k), k % 3 ? 1 : 0.05);
        brunt_fem_report report = forces(&body, 1e-3);
        const double scale = force_scale(&body), h = 1e-6;
        double f[4][3];
        for (int32_t n = 0; n < 4; n++) {
            real g[3];
            brunt_fem_internal_force(&body, n, g);
            for (int i = 0; i < 3; i++) f[n][i] = (double)g[i];
        }
        for (int32_t n = 0; n < 4; n++)
            for (int i = 0; i < 3; i++) {
                real *x = brunt_fem_node(&body, n) + i, at = *x;
                double energy[2];
                for (int side = 0; side < 2; side++) {
                    *x = (real)((double)at + (side ? h : -h));
                    report = forces(&body, 1e-3);
                    energy[side] = energy_of(&body, &report);
                }
                *x = at;
                worst = fmax(worst, fabs((energy[0] - energy[1]) / (2 * h) - f[n][i]) / scale);
            }
        brunt_fem_free(&body);
    }
    printf("  forces off the slope by %.1e\n", worst);
    ck_assert_double_lt(worst, 1e-6);
}
END_TEST

// A level element that is pressed to a hundredth has next to no forces without compression; one that was warped is no
// surface any more, and is told to be inside out.
START_TEST(pressed_flat_and_small) {
    for (int warped = 0; warped < 2; warped++) {
        random_state = 3;
        brunt_mesh mesh = membrane_mesh(BRUNT_MEMBRANE_QUAD4, 1, 1, 1, 0, warped ? 0.3 : 0, true);
        brunt_fem_body body = membrane_of(&mesh, (membrane_options){.tension_only = true});
        for (int n = 0; n < 4; n++)
            for (int i = 0; i < 3; i++) brunt_fem_node(&body, n)[i] *= (real)(i < 2 ? 0.01 : 0);
        const brunt_fem_report report = forces(&body, 1e-3);
        ck_assert_int_eq(report.bad, warped ? 0 : -1);
        if (warped) ck_assert_ptr_nonnull(strstr(report.reason, "inside out"));
        brunt_fem_free(&body);
    }
}
END_TEST

START_TEST(stable_step_is_a_bound) {
    if (sizeof(real) == 4) return;
    double least = INFINITY;
    for (int k = 0; k < 10 * DIRECTIONS; k++) {
        brunt_fem_body body = crossed(k, pow(10, -0.9 - 0.01 * k), k % 3 ? 1 : 0.05);
        const double step = forces(&body, 1e-3).stable_step, ratio = 4 / (step * step) / true_frequency(&body);
        least = fmin(least, ratio);
        ck_assert_msg(ratio > 1 - 1e-4, "%d: bound over frequency squared %g", k, ratio);
        brunt_fem_free(&body);
    }
    printf("  the bound is %.2f of the greatest frequency's square at least\n", least);
}
END_TEST

// The greatest error of the ledger while the edges fly through each other, in steps of a share of the stable one.
static double pass_through(int k, double share) {
    brunt_fem_body body = crossed(k, 0.3, 1), through = crossed(k, -0.3, 1);
    brunt_fem_report report = forces(&body, 0);
    brunt_fem_sums sums;
    const double speed = 2, dt = share * report.stable_step;
    for (int32_t n = 0; n < 4; n++)
        for (int i = 0; i < 3; i++)
            brunt_fem_node(&body, n)[BRUNT_FEM_V + i] =
                (real)(speed * ((double)brunt_fem_node(&through, n)[i] - (double)brunt_fem_node(&body, n)[i]));
    double first = NAN, kinetic = 0, worst = 0;
    for (double t = 0; t < 1 / speed; t += dt) {
        report = step(&body, dt, &sums);
        ck_assert_int_eq(report.bad, -1);
        const double total = sums.kinetic - 0.5 * report.stress_work + energy_of(&body, &report);
        if (isnan(first)) first = total, kinetic = sums.kinetic;
        worst = fmax(worst, fabs(total - first) / (first + kinetic));
    }
    brunt_fem_free(&body), brunt_fem_free(&through);
    return worst;
}

// Of elements that are flat at first: a warped one has no stretch left where it is flat.
START_TEST(edges_that_pass_keep_their_energy) {
    if (sizeof(real) == 4) return;
    double coarse = 0, fine = 0;
    for (int k = 0; k < 2 * DIRECTIONS; k += 2)
        coarse = fmax(coarse, pass_through(k, 0.05)), fine = fmax(fine, pass_through(k, 0.0125));
    printf("  energy off by %.1e at most, %.1e in steps of a quarter\n", coarse, fine);
    ck_assert_double_lt(coarse, 0.03);
    ck_assert_double_lt(fine, coarse / 8); // second order
}
END_TEST

int main(void) {
    Suite *suite = suite_create("crushed membranes");
    TCase *tcase = tcase_create("crossed");
    tcase_add_test(tcase, forces_stay_as_area_goes);
    tcase_add_test(tcase, forces_are_the_slope_of_the_energy);
    tcase_add_test(tcase, stable_step_is_a_bound);
    tcase_add_test(tcase, pressed_flat_and_small);
    tcase_add_test(tcase, edges_that_pass_keep_their_energy);
    suite_add_tcase(suite, tcase);
    return suite_main(suite);
}
