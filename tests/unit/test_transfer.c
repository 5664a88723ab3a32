// What particles take from the grid, where it is known exactly: affine velocities, free fall.
#include "tests/support/def_world.h"

// An array of body a in the state, component by component.
static real *state_get(brunt_world *w, const char *field, int32_t *at) { // free()
    char name[64];
    snprintf(name, sizeof name, "bodies/a/%s", field);
    for (int32_t b = 0; b < brunt_state_count(w); b++) {
        brunt_state_block block = brunt_state_info(w, b);
        if (strcmp(block.name, name)) continue;
        real *values = malloc((size_t)block.count * sizeof *values);
        brunt_state_get(w, b, values);
        *at = b;
        return values;
    }
    ck_abort_msg("there is no %s", name);
}

// Gives the body of `from`, in a world that is its twin, the velocity A x, with the affine matrices that belong to it.
static void move_affinely(brunt_world *from, brunt_world *w, int dim, const double A[3][3]) {
    const int64_t n = brunt_body_particles(from, 0);
    int32_t at_x, at_v, at_C;
    real *x = state_get(from, "position", &at_x), *v = state_get(from, "velocity", &at_v),
         *C = state_get(from, "affine", &at_C);
    for (int64_t i = 0; i < n; i++)
        for (int r = 0; r < dim; r++) {
            double sum = 0;
            for (int c = 0; c < dim; c++) {
                sum += A[r][c] * (double)x[c * n + i];
                C[(r * dim + c) * n + i] = (real)A[r][c];
            }
            v[r * n + i] = (real)sum;
        }
    brunt_error error = {0};
    for (int32_t b = 0; b < brunt_state_count(from); b++) {
        brunt_state_block block = brunt_state_info(from, b);
        void *data = malloc((size_t)block.count * 8 + 8);
        brunt_state_get(from, b, data);
        void *values = b == at_v ? (void *)v : b == at_C ? (void *)C : data;
        ck_assert_msg(brunt_state_set(w, b, values, block.count, &error) == BRUNT_OK, "%s", error.message);
        free(data);
    }
    ck_assert_int_eq(brunt_state_done(w, &error), BRUNT_OK);
    free(x), free(v), free(C);
}

static const double RATE[3][3] = {{0.3, -1.1, 0.4}, {0.7, -0.2, 0.9}, {-0.5, 0.6, 0.25}};

// Seen from where a particle has moved to, the motion A x has the gradient A (I + dt A)^-1; the symmetric part of what
// that changes is taken to first order: A - dt/2 (A A + (A A)^T). Not of fluids, nor of kernels that do not move.
START_TEST(affine_matrix_turns_with_the_particle) {
    const double dt = 1e-2;
    const int dim = _i % 2 ? 3 : 2, kind = _i / 4; // solid, fluid, total Lagrangian
    brunt_world_def def = def_begin(dim, 0.1);
    def.kernel = _i / 2 % 2 ? BRUNT_CUBIC : BRUNT_QUADRATIC;
    def.step = dt;
    if (kind == 1) {
        brunt_material_def *m = &def.materials[def.material_count++];
        brunt_error error = {0};
        *m = brunt_material_def_default("still", "newtonian");
        ck_assert_int_eq(brunt_material_set(m, "density", 1000, NULL, &error), BRUNT_OK);
        ck_assert_int_eq(brunt_material_set(m, "eos", 0, "tait", &error), BRUNT_OK);
        ck_assert_int_eq(brunt_material_set(m, "eos.c0", 0.1, NULL, &error), BRUNT_OK);
    } else {
        def_material(&def, "neo-hookean", 1000, 1e-3, 0.3);
    }
    def_box(&def, "a", XYZ(0, 0, 0), XYZ(0.3, 0.2, 0.2))->total_lagrangian = kind == 2;
    brunt_world *still = world_from(&def), *w = world_take(&def);
    move_affinely(still, w, dim, RATE);
    world_steps(w, 1);
    const int64_t n = brunt_body_particles(w, 0);
    int32_t at;
    real *C = state_get(w, "affine", &at);
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) {
            double square = 0;
            for (int k = 0; k < dim; k++) square += RATE[r][k] * RATE[k][c] + RATE[c][k] * RATE[k][r];
            const double expected = RATE[r][c] - (kind ? 0 : 0.5 * dt * square);
            for (int64_t i = 0; i < n; i++)
                ck_assert_double_eq_tol((double)C[(r * dim + c) * n + i], expected, 100 * ROUNDING);
        }
    free(C);
    brunt_world_destroy(still);
    brunt_world_destroy(w);
}
END_TEST

// Whatever share of their own velocity particles keep, they fall as the grid does: FLIP's other share is the grid's
// velocity at the end of the step.
START_TEST(flip_falls_freely) {
    static const double share[] = {0, 0.5, 0.99, 1};
    brunt_world_def def = def_begin(2, 0.1);
    def.kernel = (brunt_kernel)(BRUNT_LINEAR + _i % 3);
    def.transfer = BRUNT_FLIP, def.flip = share[_i / 3];
    def_material(&def, "neo-hookean", 1000, 1e3, 0.3);
    def_box(&def, "a", XYZ(0, 0, 0), XYZ(0.3, 0.2, 0));
    def_falls_freely(&def);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("transfer");
    TCase *all = tcase_create("all");
    tcase_add_loop_test(all, affine_matrix_turns_with_the_particle, 0, 12);
    tcase_add_loop_test(all, flip_falls_freely, 0, 12);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
