// The step goes by the wave speed that materials report: no wave of small amplitude is faster, on whatever state it
// runs, and where a closed form has it the speed is that one.
#include "tests/support/material_sample.h"

// Without what its rate adds, which no small wave has.
static sample sample_still(form f) {
    double parameters[BRUNT_MAX_PARAMETERS];
    typical_parameters(f.model, f.variant, parameters);
    for (int i = 0; i < f.model->parameter_count; i++)
        if (!strcmp(f.model->parameters[i].key, "C")) parameters[i] = 0;
    return sample_create(f.model, parameters, f.with_eos, f.dim, BRUNT_LANES);
}

// rho0 c^2 of a wave along and across n on point 0 of the state, from steps +-h n x n: d tau_nn/dh - tau_nn (the
// nominal stress of the configuration it runs through). The stiffer side: plastic points unload on one.
static double stiffness_along(form f, const sample *state, const double n[3], double h, double *told) {
    double most = 0;
    sample still = sample_still(f); // what goes on without any motion is no wave
    copy_points(state, &still);
    step_all(&still, (mat){{{0}}});
    const mat before = get_stress(&still, 0);
    sample_destroy(&still);
    for (int side = -1; side <= 1; side += 2) {
        sample probe = sample_still(f);
        copy_points(state, &probe);
        mat H = {{{0}}};
        for (int r = 0; r < f.dim; r++)
            for (int c = 0; c < f.dim; c++) H.a[r][c] = side * h * n[r] * n[c];
        const brunt_update_result result = step_all(&probe, H);
        const mat change = combine(1, get_stress(&probe, 0), -1, before);
        double slope = 0, tension = 0;
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++) {
                slope += n[r] * n[c] * change.a[r][c] / (side * h);
                tension += n[r] * n[c] * before.a[r][c];
            }
        most = fmax(most, slope - tension);
        *told = fmax(*told, typical_density * (double)result.wave_speed * (double)result.wave_speed);
        sample_destroy(&probe);
    }
    return most;
}

// The greatest over many directions, with what the update tells.
static double stiffness_of(form f, const sample *state, double h, double *told) {
    double most = 0;
    uint64_t seed = 5;
    for (int k = 0; k < 60; k++) {
        double n[3] = {uniform(&seed), uniform(&seed), f.dim == 3 ? uniform(&seed) : 0};
        if (k < f.dim)
            for (int a = 0; a < 3; a++) n[a] = a == k;
        const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int a = 0; a < 3; a++) n[a] /= size;
        most = fmax(most, stiffness_along(f, state, n, h, told));
    }
    return most;
}

// What a path has shown.
typedef struct comparison {
    double least, most; // rho0 c^2 of the fastest wave over what the update tells
    double idle;        // what the step that led there told over what steps of no size tell there
} comparison;

// Forty steps that flow, by `squeeze` each in volume; states of equations of state are hot.
static void compare_on_path(form f, uint64_t seed, double size, double squeeze, comparison *out) {
    sample s = sample_still(f);
    for (int step = 0; step < 40; step++) {
        mat H = random_matrix(&seed, f.dim, size);
        if (f.model->small_strain) H = combine(0.5, H, 0.5, transpose(H));
        for (int a = 0; a < f.dim; a++) H.a[a][a] -= squeeze;
        for (int i = 0; f.model->eos && i < s.points.count; i++) s.points.plastic_increment[i] = (real)2e8;
        const double c = (double)step_all(&s, H).wave_speed;
        if (step % 8 != 7) continue;
        double told = 0;
        const double share = stiffness_of(f, &s, 1e-6, &told) / told;
        out->least = fmin(out->least, share), out->most = fmax(out->most, share);
        out->idle = fmax(out->idle, typical_density * c * c / told);
    }
    sample_destroy(&s);
}

// Strength that grows with a power of pressure has any slope where there is none: there stiffer than told, within some
// hundredths of the strength, which no wave keeps to.
static double excess_allowed(const brunt_model *model) {
    if (!strcmp(model->name, "holmquist-johnson-cook")) return INFINITY;
    return !strcmp(model->name, "johnson-holmquist-2") ? 0.03 : 0.005;
}

START_TEST(no_wave_is_faster) {
    const form f = forms[_i];
    if (f.model->shear_viscous || !TOLERANCE(1, 0)) return; // single precision has no digits for such small steps
    comparison c = {INFINITY, 0, 0};
    for (int path = 0; path < 6; path++) {
        const double size = f.model->small_strain ? 1e-4 : path < 3 ? 0.002 : 0.02;
        for (int side = -1; side <= 1; side++) compare_on_path(f, 11 + (uint64_t)path, size, 0.2 * side * size, &c);
    }
    printf("%s %dD %d: %.4f to %.4f, %.4f\n", f.model->name, f.dim, f.variant, c.least, c.most, c.idle);
    ck_assert_double_le(c.most, 1 + excess_allowed(f.model));
    ck_assert_double_ge(c.most, f.model->plastic || f.model->eos ? 0.999 : 0.98);
    if (f.model->accepts_eos && f.model->plastic) ck_assert_double_ge(c.least, 0.995);
    if (f.model->accepts_eos || f.model->eos) ck_assert_double_le(c.idle, 1.001);
}
END_TEST

int main(void) {
    collect_forms();
    Suite *suite = suite_create("wave speed");
    TCase *all = tcase_create("every model");
    tcase_add_loop_test(all, no_wave_is_faster, 0, form_count);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
