// Loads, speeds and places without bounds: a run ends with a message in a few steps, or goes on; it never hangs. What
// guards the test is a number of steps.
#include <sys/resource.h>

#include "tests/support/hard_world.h"

enum { STEP_LIMIT = 50 };

// Two blocks, and what is done to the upper one.
static brunt_world_def blocks(double size) {
    brunt_world_def def = def_begin(2, size);
    def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    for (int k = 0; k < 2; k++) {
        brunt_body_def *b =
            def_box(&def, k ? "upper" : "lower", XYZ(0, 4.1 * k * size, 0), XYZ(4 * size, (4.1 * k + 4) * size, 0));
        b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = size;
    }
    return def;
}

// Whether it was refused, or ended, with a message; false: it went on.
static bool ends(brunt_world_def *def, const char *what) {
    brunt_error error = {0};
    brunt_world *world = brunt_world_create(def, &error);
    int status = world ? BRUNT_OK : error.code;
    for (int s = 0; s < STEP_LIMIT && !status; s++) status = brunt_world_step(world, INFINITY, &error);
    printf("  %s: %s\n", what, status ? error.message : "goes on");
    ck_assert(!status || *error.message);
    brunt_world_destroy(world);
    brunt_world_def_free(def);
    return status != BRUNT_OK;
}

START_TEST(endless_pressures) {
    static const double pressures[] = {1e30, 1e100, 1e150, 1e155, 1e160, 1e300, INFINITY, NAN, -1e160, -1e300};
    for (size_t k = 0; k < sizeof pressures / sizeof *pressures; k++) {
        brunt_world_def def = blocks(0.01);
        brunt_group_def *g = &def.groups[def.group_count++];
        *g = brunt_group_def_default();
        snprintf(g->body, sizeof g->body, "upper"), snprintf(g->group, sizeof g->group, "ymax");
        g->action = BRUNT_GROUP_PRESSURE, g->value[0] = pressures[k];
        char what[64];
        snprintf(what, sizeof what, "pressure %g Pa", pressures[k]);
        ck_assert_msg(ends(&def, what) || pressures[k] < 0, "%s", what); // it may be drawn out without an end
    }
}
END_TEST

START_TEST(endless_speeds) {
    static const double speeds[] = {1e20, 1e100, 1e150, 1e160, 1e300, INFINITY, NAN};
    for (size_t k = 0; k < 2 * sizeof speeds / sizeof *speeds; k++) {
        brunt_world_def def = blocks(0.01);
        def_velocity(&def.bodies[1], 0, -speeds[k / 2], 0);
        if (k & 1) def.bodies[1].method = BRUNT_MPM, def.bodies[1].spacing = 0.005;
        char what[64];
        snprintf(what, sizeof what, "%s at %g m/s", k & 1 ? "points" : "a mesh", speeds[k / 2]);
        ends(&def, what);
    }
}
END_TEST

START_TEST(endless_sizes) {
    static const double sizes[] = {0, 1e-310, 1e-300, 1e-160, 1e100, 1e160, 1e300, INFINITY, NAN};
    for (size_t k = 0; k < 2 * sizeof sizes / sizeof *sizes; k++) {
        brunt_world_def def = blocks(sizes[k / 2]);
        if (k & 1) def.bodies[1].hourglass = BRUNT_HOURGLASS_VISCOUS;
        char what[64];
        snprintf(what, sizeof what, "elements of %g m", sizes[k / 2]);
        ends(&def, what);
    }
}
END_TEST

START_TEST(endless_planes) {
    static const double far[] = {1e100, 1e160, 1e300, INFINITY, NAN};
    for (size_t k = 0; k < 2 * sizeof far / sizeof *far; k++) {
        brunt_world_def def = blocks(0.01);
        brunt_plane_def *p = def_plane(&def, XYZ(0, k & 1 ? -far[k / 2] : -1, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
        if (!(k & 1)) p->velocity[1] = far[k / 2];
        char what[64];
        snprintf(what, sizeof what, "a plane %s %g", k & 1 ? "at" : "that moves at", far[k / 2]);
        ends(&def, what);
    }
}
END_TEST

// Places and speeds that come in by the state, past all that looks at definitions. What would never end is ended by the
// processor's time, which does not depend on what else the machine does.
START_TEST(endless_states) {
    static const double values[] = {INFINITY, -INFINITY, 1e200, NAN};
    const struct rlimit seconds = {20, 20};
    ck_assert_int_eq(setrlimit(RLIMIT_CPU, &seconds), 0);
    for (int k = 0; k < 2 * (int)(sizeof values / sizeof *values); k++) {
        brunt_world_def def = blocks(0.01);
        brunt_world *world = world_take(&def);
        brunt_error error = {0};
        for (int32_t b = 0; b < brunt_state_count(world); b++) {
            const brunt_state_block block = brunt_state_info(world, b);
            if (strcmp(block.name, "bodies/upper/nodes")) continue;
            real *node = malloc((size_t)block.count * sizeof *node);
            brunt_state_get(world, b, node);
            node[k & 1 ? 4 : 0] = (real)values[k / 2]; // vx, x of the first
            ck_assert_int_eq(brunt_state_set(world, b, node, block.count, &error), BRUNT_OK);
            free(node);
        }
        int status = BRUNT_OK;
        for (int s = 0; s < STEP_LIMIT && !status; s++) status = brunt_world_step(world, INFINITY, &error);
        printf("  a node %s %g: %s\n", k & 1 ? "at a speed of" : "at", values[k / 2], error.message);
        ck_assert_int_eq(status, BRUNT_FAILED);
        brunt_world_destroy(world);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("no_end");
    ADD(endless_pressures);
    ADD(endless_speeds);
    ADD(endless_sizes);
    ADD(endless_planes);
    ADD(endless_states);
    return suite_main(suite);
}
