// Material points between two symmetry planes that the kernel reaches both of: they move as the same points in the
// middle of a body as wide as it is with their images, and the images of these, beside them.
#include "tests/support/def_world.h"

static const double H = 0.1; // [m] cells, edges of elements, twice the spacing of particles
// Cells apart after the steps: on planes rounding; on meshes, of which what is beyond a plane of symmetry is not
// searched, as much as strips of six cells, whose planes the kernel does not reach both of.
static const double NEAR = 100 * ROUNDING, NEAR_ON_MESH = 5e-3;

typedef struct strip {
    int dimension, width; // of the strip, cells
    brunt_kernel kernel;
    brunt_transfer transfer;
    brunt_contact_method method;
    bool on_mesh, pressed; // on a mesh or on a plane; by another plane
    double friction;
} strip;

// The strip with `more` images of it on either side.
static brunt_world *make_strip(const strip *s, int more) {
    brunt_world_def def = def_begin(s->dimension, H);
    const double low = -more * s->width * H, high = (more + 1) * s->width * H, deep = s->dimension == 3 ? H : 0;
    def.kernel = s->kernel, def.transfer = s->transfer;
    def.contact.method = s->method, def.contact.friction = s->friction;
    def.gravity[0] = -10;
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    brunt_body_def *b = def_box(&def, "points", XYZ(0, low, 0), XYZ(3 * H, high, deep));
    def_velocity(b, -1, 0, 0);
    b->wave_velocity[0] = 0.3, b->wave_vector[1] = PI / (s->width * H), b->wave_phase = PI / 2; // even about each plane
    if (s->on_mesh) {
        b = def_box(&def, "mesh", XYZ(-2 * H, low, 0), XYZ(0, high, deep));
        b->method = BRUNT_FEM, b->element = s->dimension == 3 ? BRUNT_HEX8 : BRUNT_QUAD4, b->size = H;
        def_plane(&def, XYZ(-2 * H, 0, 0), XYZ(1, 0, 0), BRUNT_STICK, 0);
    } else {
        def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SEPARATE, s->friction);
    }
    if (s->pressed) def_plane(&def, XYZ(3 * H, 0, 0), XYZ(-1, 0, 0), BRUNT_SEPARATE, s->friction)->velocity[0] = -0.5;
    def_plane(&def, XYZ(0, low, 0), XYZ(0, 1, 0), BRUNT_SYMMETRY, 0);
    def_plane(&def, XYZ(0, high, 0), XYZ(0, -1, 0), BRUNT_SYMMETRY, 0);
    if (s->dimension == 3) {
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 0, 1), BRUNT_SYMMETRY, 0);
        def_plane(&def, XYZ(0, 0, deep), XYZ(0, 0, -1), BRUNT_SYMMETRY, 0);
    }
    return world_take(&def);
}

// The particle that is nearest to a place.
static int64_t find_particle(const double *x, int64_t count, const double at[3]) {
    int64_t best = 0;
    double least = INFINITY;
    for (int64_t i = 0; i < count; i++) {
        double square = 0;
        for (int a = 0; a < 3; a++) square += (x[3 * i + a] - at[a]) * (x[3 * i + a] - at[a]);
        if (square < least) least = square, best = i;
    }
    return best;
}

// Greatest distance of a particle of the strip from that of the wide body that began where it did [cells].
static double apart(const strip *s, int steps, double *moved) {
    const int more = s->width == 1 ? 3 : 1;
    brunt_world *narrow = make_strip(s, 0), *wide = make_strip(s, more);
    double *from = world_field(narrow, !!s->on_mesh, "position"),
           *wide_from = world_field(wide, !!s->on_mesh, "position");
    for (int k = 0; k < steps; k++) {
        world_steps(narrow, 1);
        world_until(wide, brunt_world_time(narrow));
    }
    double *to = world_field(narrow, !!s->on_mesh, "position"), *wide_to = world_field(wide, !!s->on_mesh, "position");
    const int64_t count = brunt_body_particles(narrow, !!s->on_mesh), many = brunt_body_particles(wide, !!s->on_mesh);
    double worst = 0;
    *moved = 0;
    for (int64_t i = 0; i < count; i++) {
        const int64_t k = find_particle(wide_from, many, &from[3 * i]);
        for (int a = 0; a < 3; a++) {
            worst = fmax(worst, fabs(to[3 * i + a] - wide_to[3 * k + a]) / H);
            *moved = fmax(*moved, fabs(to[3 * i + a] - from[3 * i + a]) / H);
        }
    }
    free(from), free(to), free(wide_from), free(wide_to);
    brunt_world_destroy(narrow), brunt_world_destroy(wide);
    return worst;
}

static const strip strips[] = {
    {2, 1, BRUNT_QUADRATIC, BRUNT_APIC, BRUNT_CONTACT_AUGURY, false, true, 0},
    {2, 2, BRUNT_QUADRATIC, BRUNT_APIC, BRUNT_CONTACT_AUGURY, false, true, 0.3},
    {2, 3, BRUNT_QUADRATIC, BRUNT_FLIP, BRUNT_CONTACT_AUGURY, false, true, 0.3},
    {2, 2, BRUNT_CUBIC, BRUNT_APIC, BRUNT_CONTACT_AUGURY, false, false, 0.3},
    {2, 1, BRUNT_LINEAR, BRUNT_FLIP, BRUNT_CONTACT_AUGURY, false, true, 0.3},
    {2, 2, BRUNT_QUADRATIC, BRUNT_APIC, BRUNT_CONTACT_AUGURY, true, true, 0.3},
    {2, 1, BRUNT_QUADRATIC, BRUNT_APIC, BRUNT_CONTACT_AUGURY, true, false, 0.3},
    {2, 2, BRUNT_QUADRATIC, BRUNT_APIC, BRUNT_CONTACT_MULTI_VELOCITY, true, false, 0.3},
    {3, 2, BRUNT_QUADRATIC, BRUNT_APIC, BRUNT_CONTACT_AUGURY, false, true, 0.3},
    {2, 6, BRUNT_QUADRATIC, BRUNT_APIC, BRUNT_CONTACT_AUGURY, true, true, 0.3},
};

START_TEST(moves_as_with_its_images) {
    const strip *s = &strips[_i];
    double moved = 0;
    const double worst = apart(s, 40, &moved);
    printf("strip of %d cells, %dD, kernel %d, transfer %d, %s: %.2g cells apart, moved %.2g\n", s->width, s->dimension,
           (int)s->kernel, (int)s->transfer, s->on_mesh ? "on a mesh" : "on a plane", worst, moved);
    ck_assert_double_gt(moved, 0.04);
    ck_assert_double_lt(worst, s->on_mesh ? NEAR_ON_MESH : NEAR);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("between_symmetry_planes");
    ADD_LOOP(moves_as_with_its_images, (int)(sizeof strips / sizeof strips[0]));
    return suite_main(suite);
}
