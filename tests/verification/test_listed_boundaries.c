// Boundaries of kinds that list their keys. A rotor turns what it holds: the velocity of a step is linear in place,
// which transfers carry exactly, so that n steps of dt are x -> (I + dt W)^n x, with W = rate (axis x), whatever the
// scheme.
#include "tests/support/def_world.h"

enum { STEPS = 20 };
static const double RATE = 3, STEP = 2e-3; // [rad/s], [s]
static const double AXIS[3] = {1, 2, -2}, POINT[3] = {0.3, -0.2, 0.15};

static brunt_world_def held(int dimension, brunt_scheme scheme, double radius) {
    brunt_world_def def = def_begin(dimension, 0.1);
    def.scheme = scheme, def.step = STEP;
    def.contact.method = BRUNT_CONTACT_NONE;
    def_material(&def, "neo-hookean", 1000, 1e3, 0.3);
    def_box(&def, "a", XYZ(0, 0, 0), XYZ(0.3, 0.2, 0.2));
    def_box(&def, "b", XYZ(9, 0, 0), XYZ(9.3, 0.2, 0.2));
    def.boundaries = brunt_def_alloc(sizeof *def.boundaries);
    brunt_boundary_def *rotor = &def.boundaries[def.boundary_count++];
    strcpy(rotor->kind, "rotor");
    for (int a = 0; a < 3; a++) rotor->number[a] = POINT[a], rotor->number[3 + a] = AXIS[a];
    rotor->number[6] = radius, rotor->number[7] = RATE;
    return def;
}

// A step, in place.
static void turn(int dimension, double x[3]) {
    double r[3] = {0}, n[3] = {0, 0, 1}, at[3];
    for (int a = 0; a < 3; a++) n[a] = dimension == 3 ? AXIS[a] / 3 : n[a];
    for (int a = 0; a < dimension; a++) r[a] = x[a] - POINT[a];
    for (int a = 0; a < 3; a++) at[a] = n[(a + 1) % 3] * r[(a + 2) % 3] - n[(a + 2) % 3] * r[(a + 1) % 3];
    for (int a = 0; a < dimension; a++) x[a] += STEP * RATE * at[a];
}

static const struct {
    int dimension;
    brunt_scheme scheme;
} cases[] = {{2, BRUNT_EXPLICIT}, {3, BRUNT_EXPLICIT}, {2, BRUNT_IMPLICIT}, {3, BRUNT_IMPLICIT}};

START_TEST(a_rotor_turns_what_it_reaches) {
    const int dimension = cases[_i].dimension;
    if (sizeof(real) != sizeof(double) && cases[_i].scheme != BRUNT_EXPLICIT) return; // which wants double precision
    brunt_world_def def = held(dimension, cases[_i].scheme, 2);
    brunt_world *world = world_take(&def);
    double *from[2] = {world_field(world, 0, "position"), world_field(world, 1, "position")};
    world_steps(world, STEPS);
    double *to[2] = {world_field(world, 0, "position"), world_field(world, 1, "position")}, farthest = 0;
    for (int64_t i = 0; i < brunt_body_particles(world, 0); i++) {
        double *x = from[0] + 3 * i;
        for (int k = 0; k < STEPS; k++) turn(dimension, x);
        for (int a = 0; a < 3; a++) farthest = fmax(farthest, fabs(x[a] - to[0][3 * i + a]));
    }
    ck_assert_double_le(farthest, 100 * ROUNDING);
    for (int64_t i = 0; i < 3 * brunt_body_particles(world, 1); i++)
        ck_assert_double_le(fabs(from[1][i] - to[1][i]), 100 * ROUNDING);
    for (int k = 0; k < 2; k++) free(from[k]), free(to[k]);
    brunt_world_destroy(world);
}
END_TEST

static void refused(brunt_world_def *def, const char *message) {
    brunt_error error = {0};
    ck_assert_ptr_null(brunt_world_create(def, &error));
    ck_assert_msg(error.code == BRUNT_BAD_INPUT && strstr(error.message, message), "%s", error.message);
    brunt_world_def_free(def);
}

START_TEST(what_is_wrong_is_refused) {
    brunt_world_def def = held(3, BRUNT_EXPLICIT, 0);
    refused(&def, "boundaries[0].rotor.radius: 0 is out of its range");
    def = held(3, BRUNT_EXPLICIT, 1);
    for (int a = 0; a < 3; a++) def.boundaries[0].number[3 + a] = 0;
    refused(&def, "boundaries[0].rotor.axis: the axis has zero length");
    def = held(3, BRUNT_EXPLICIT, 1);
    def.boundaries[0].number[7] = NAN;
    refused(&def, "boundaries[0].rotor.rate");
    def = held(3, BRUNT_EXPLICIT, 1);
    strcpy(def.boundaries[0].kind, "motor");
    refused(&def, "'motor' is no kind that lists its keys");
    def = held(2, BRUNT_EXPLICIT, 1);
    def.axisymmetric = true;
    refused(&def, "rings do not turn in their plane");
    def = held(2, BRUNT_EXPLICIT, 1);
    strcpy(def.boundaries[0].body, "c");
    refused(&def, "there is no body 'c'");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("listed_boundaries");
    TCase *all = tcase_create("all");
    tcase_add_loop_test(all, a_rotor_turns_what_it_reaches, 0, 4);
    tcase_add_test(all, what_is_wrong_is_refused);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
