// Labels: verification
// The library of materials: each makes a material whose constants agree with one another, and copper has the Hugoniot
// that its equation of state was measured by.
#include "tests/support/def_world.h"

#include "base/simd.h"
#include "materials/prepared.h"

static brunt_material_def preset(const char *name) {
    brunt_error error = {0};
    brunt_material_def def;
    ck_assert_msg(brunt_material_preset(name, "it", &def, &error) == BRUNT_OK, "%s: %s", name, error.message);
    return def;
}

// NAN when the model has no such parameter.
static double parameter(const brunt_model *model, const double *values, const char *key) {
    for (int k = 0; model && k < model->parameter_count; k++)
        if (!strcmp(model->parameters[k].key, key)) return values[k];
    return NAN;
}

// It is made without a word, everything that has no default given; all of it finite.
START_TEST(every_preset_is_a_material) {
    ck_assert_int_ge(brunt_preset_count(), 11);
    for (int32_t k = 0; k < brunt_preset_count(); k++) {
        const brunt_preset_info info = brunt_preset(k);
        ck_assert_msg(info.doc && strlen(info.doc) > 3 && info.source && strlen(info.source) > 20, "%s", info.name);
        for (int32_t other = 0; other < k; other++) ck_assert_str_ne(info.name, brunt_preset(other).name);
        brunt_error error = {0};
        brunt_material material;
        brunt_material_def def = preset(info.name);
        ck_assert_str_eq(def.name, "it");
        ck_assert_msg(brunt_material_make(&def, &material, &error) == BRUNT_OK, "%s: %s", info.name, error.message);
        ck_assert_msg(material.wave_speed > 0 && isfinite(material.wave_speed), "%s", info.name);
    }
}
END_TEST

// The bulk sound of E and nu, or G and K1, is that of the equation of state; densities, melting points and yield
// stresses are such as solids, liquids and gases have. The state at rest has no pressure but air's.
START_TEST(constants_agree) {
    for (int32_t k = 0; k < brunt_preset_count(); k++) {
        const char *name = brunt_preset(k).name;
        brunt_material_def def = preset(name);
        const brunt_model *strength = brunt_find_strength(def.strength), *eos = brunt_find_eos(def.eos);
        const double E = parameter(strength, def.strength_parameters, "E"),
                     nu = parameter(strength, def.strength_parameters, "nu"),
                     c0 = parameter(eos, def.eos_parameters, "c0"), s = parameter(eos, def.eos_parameters, "s");
        if (!isnan(E) && !isnan(c0)) {
            double c = sqrt(E / (3 * (1 - 2 * nu)) / def.density);
            printf("  %s: bulk sound %.0f m/s of E and nu, c0 %.0f (%+.1f %%)\n", name, c, c0, 100 * (c / c0 - 1));
            ck_assert_double_eq_tol(c, c0, 0.05 * c0);
        }
        if (!isnan(s))
            ck_assert(s > 1 && s < 2.1); // limiting compressions of 2 to 1/0 of (s + 1) / (s - 1): all matter
        const double melt = parameter(strength, def.strength_parameters, "melt"),
                     heat = parameter(strength, def.strength_parameters, "heat_capacity");
        if (!isnan(melt)) ck_assert(melt > 600 && melt < 2000);
        if (!isnan(heat)) { // Dulong and Petit: 25 J/K for 0.05 to 0.2 kg of atoms
            const double mole = 24.9 / heat;
            ck_assert_msg(mole > 0.025 && mole < 0.21, "%s: %g kg/mol", name, mole);
        }
        brunt_material material;
        brunt_error error = {0};
        ck_assert_int_eq(brunt_material_make(&def, &material, &error), BRUNT_OK);
        const bool air = !strcmp(name, "air");
        ck_assert_double_eq_tol(-(double)material.rest_stress, air ? 101325 : 0, TOLERANCE(1e-6, 1));
        if (air) ck_assert_double_eq_tol((double)material.wave_speed, 340.3, 0.1); // of the standard atmosphere
    }
}
END_TEST

// B08. A point of copper's equation of state taken from rest to the end state of a shock in one step: by the trapezoid
// of the pressure the energy is that of the Hugoniot, p (1 - J) / 2, when p is on it: p = rho0 (c0 + s u) u, 1 - J = u
// / (c0 + s u).
START_TEST(copper_hugoniot) {
    brunt_material_def def = preset("copper-ofhc");
    brunt_material material;
    brunt_error error = {0};
    ck_assert_int_eq(brunt_material_make(&def, &material, &error), BRUNT_OK);
    const double speeds[] = {250, 500, 1000}, c0 = 3940, s = 1.489;
    for (int k = 0; k < 3; k++) {
        const double u = speeds[k], shock = c0 + s * u, J = 1 - u / shock;
        real F[9][BRUNT_LANES] = {{0}}, L[9][BRUNT_LANES] = {{0}}, stress[6][BRUNT_LANES] = {{0}}, volume[BRUNT_LANES],
             state[2][BRUNT_LANES] = {{0}};
        brunt_material_points points = {.count = BRUNT_LANES, .dim = 3, .dt = 1, .cell = 1, .volume = volume};
        for (int c = 0; c < 9; c++) points.F[c] = F[c], points.L[c] = L[c];
        for (int c = 0; c < 6; c++) points.stress[c] = stress[c];
        for (int c = 0; c < 2; c++) points.state[c] = state[c];
        for (int l = 0; l < BRUNT_LANES; l++) {
            volume[l] = 1;
            F[0][l] = (real)J, F[4][l] = F[8][l] = 1;
            L[0][l] = (real)(J - 1);
        }
        const brunt_model *eos = material.model[BRUNT_EOS];
        brunt_update_result result = eos->update(material.constants[BRUNT_EOS], &points);
        ck_assert_int_lt(result.bad, 0);
        const double p = -(double)stress[0][0] / J, expect = 8930 * shock * u, e = (double)state[0][0];
        printf("  copper, u = %g m/s: p %.4f GPa, Hugoniot %.4f; e %.4g J/kg\n", u, p / 1e9, expect / 1e9, e / 8930);
        ck_assert_double_eq_tol(p, expect, TOLERANCE(1e-12, 1e-4) * expect);
        ck_assert_double_eq_tol(e, 0.5 * u * u * 8930, TOLERANCE(1e-11, 1e-3) * e);
    }
}
END_TEST

START_TEST(unknown_preset) {
    brunt_error error = {0};
    brunt_material_def def;
    ck_assert_int_eq(brunt_material_preset("unobtainium", "hull", &def, &error), BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "unobtainium") != NULL, "%s", error.message);
    ck_assert_int_eq(brunt_material_preset("unobtainium", "hull", &def, NULL), BRUNT_BAD_INPUT);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("presets");
    TCase *tcase = tcase_create("presets");
    tcase_add_test(tcase, every_preset_is_a_material);
    tcase_add_test(tcase, constants_agree);
    tcase_add_test(tcase, copper_hugoniot);
    tcase_add_test(tcase, unknown_preset);
    suite_add_tcase(suite, tcase);
    return suite_main(suite) ? EXIT_FAILURE : EXIT_SUCCESS;
}
