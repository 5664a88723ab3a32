// Round bodies of material points on what they rub on: friction acts at their surface, so that they roll on their
// radius.
//
// Closed forms of a rigid disk, g = R = rho = 1, down a slope of angle a: rolling a = sin a / (1 + k), with sliding
// sin a - mu cos a and spin 1/k mu cos a; k = I / (m R^2), 1/2 of a disk and 2/5 of a ball. A body of particles has its
// own k: the lattice's (at 4 cells a radius 3 % more than a disk's), and with APIC that of the kernels, 2 D / R^2 (D =
// h^2/4 quadratic, h^2/3 cubic; 6 % more there). What is compared is what friction makes of that; of 2/3 sin a they
// leave 3 % at 4 cells, 0.8 % at 8.
#include "tests/support/def_world.h"

typedef enum bed { PLANE, MESH, POINTS } bed;
typedef struct roll {
    bed bed;
    int cells; // a radius
    double friction, slope;
    brunt_kernel kernel;
    brunt_transfer transfer;
    int dimension;
    double axis[3], turn; // the whole scene, turned in space
    double drift;         // [m/s] of the bed along the slope, and of the disk
    const char *name;     // of the bed
} roll;

static const roll plain = {.cells = 4,
                           .friction = 2,
                           .slope = 53 * PI / 180,
                           .kernel = BRUNT_QUADRATIC,
                           .transfer = BRUNT_APIC,
                           .dimension = 2,
                           .axis = {0, 0, 1},
                           .name = "slab"};

// Rodrigues' formula.
static void turned(const roll *r, double x, double y, double out[3]) {
    const double v[3] = {x, y, 0}, *k = r->axis, c = cos(r->turn), s = sin(r->turn), along = k[0] * x + k[1] * y;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, d = (a + 2) % 3;
        out[a] = c * v[a] + s * (k[b] * v[d] - k[d] * v[b]) + (1 - c) * along * k[a];
    }
}

static void hold_slab(brunt_world_def *def, const roll *r) {
    def->groups = brunt_alloc(sizeof *def->groups);
    brunt_group_def *group = &def->groups[def->group_count++];
    *group = brunt_group_def_default();
    snprintf(group->body, sizeof group->body, "%s", r->name);
    snprintf(group->group, sizeof group->group, "surface");
    group->action = BRUNT_GROUP_VELOCITY;
    double u[3];
    turned(r, r->drift, 0, u);
    memcpy(group->value, u, sizeof u);
}

static void add_slab(brunt_world_def *def, const roll *r) {
    const double h = 1.0 / r->cells, wide = r->dimension == 3 ? 1 : 0;
    brunt_body_def *slab = def_box(def, r->name, XYZ(-2.5, -2 * h, -wide), XYZ(2.5, 0, wide));
    slab->place = brunt_placement_rotate(slab->place, r->axis, r->turn, XYZ(0, 0, 0));
    slab->method = BRUNT_FEM, slab->element = r->dimension == 3 ? BRUNT_HEX8 : BRUNT_QUAD4, slab->size = h;
    turned(r, r->drift, 0, slab->velocity);
    hold_slab(def, r);
}

// A bed of material points, ten times as heavy and as stiff as the disk, whose underside is held.
static void add_bed(brunt_world_def *def, const roll *r) {
    const double h = 1.0 / r->cells, wide = r->dimension == 3 ? 1 : 0;
    def_material(def, "neo-hookean", 10, 3000, 0.3);
    brunt_body_def *below = def_box(def, r->name, XYZ(-2.5, -4 * h, -wide), XYZ(2.5, 0, wide));
    below->material = 1;
    below->place = brunt_placement_rotate(below->place, r->axis, r->turn, XYZ(0, 0, 0));
    turned(r, r->drift, 0, below->velocity);
    double n[3], x[3];
    turned(r, 0, 1, n), turned(r, 0, -3 * h, x);
    brunt_plane_def *plane = def_plane(def, x, n, BRUNT_STICK, 0);
    turned(r, r->drift, 0, plane->velocity);
}

static brunt_world_def def_roll(const roll *r) {
    brunt_world_def def = def_begin(r->dimension, 1.0 / r->cells);
    def.kernel = r->kernel, def.transfer = r->transfer;
    def_material(&def, "neo-hookean", 1, 300, 0.3);
    brunt_body_def *disk = def_ball(&def, "disk", XYZ(0, 1, 0), 1);
    disk->place = brunt_placement_rotate(disk->place, r->axis, r->turn, XYZ(0, 0, 0));
    turned(r, r->drift, 0, disk->velocity);
    turned(r, sin(r->slope), -cos(r->slope), def.gravity);
    def.gravity_ramp = 0.5;
    def.contact.friction = r->friction;
    def.contact.method = BRUNT_CONTACT_AUGURY;
    if (r->bed == POINTS) {
        add_bed(&def, r);
    } else if (r->bed == MESH) {
        add_slab(&def, r);
    } else {
        double n[3];
        turned(r, 0, 1, n);
        brunt_plane_def *plane = def_plane(&def, XYZ(0, 0, 0), n, BRUNT_SEPARATE, r->friction);
        turned(r, r->drift, 0, plane->velocity);
    }
    return def;
}

typedef struct motion {
    double time, velocity, spin, k; // along the slope, about the axis that rolling turns about
} motion;

static int disk_of(const roll *r) { return r->bed != PLANE && strcmp(r->name, "disk") < 0 ? 1 : 0; }

static motion observe(brunt_world *w, const roll *r) {
    const int disk = disk_of(r);
    const brunt_body_sums s = world_sums(w, disk);
    double *x = world_field(w, disk, "position"), *v = world_field(w, disk, "velocity"),
           *m = world_field(w, disk, "mass"), e[3], n[3], L = 0, I = 0;
    turned(r, 1, 0, e), turned(r, 0, 1, n);
    motion now = {.time = brunt_world_time(w)};
    for (int a = 0; a < 3; a++) now.velocity += s.velocity[a] * e[a];
    for (int64_t i = 0; i < brunt_body_particles(w, disk); i++) {
        double de = 0, dn = 0, ve = 0, vn = 0;
        for (int a = 0; a < 3; a++) {
            de += (x[3 * i + a] - s.centre[a]) * e[a], dn += (x[3 * i + a] - s.centre[a]) * n[a];
            ve += v[3 * i + a] * e[a], vn += v[3 * i + a] * n[a];
        }
        L += m[i] * (dn * ve - de * vn), I += m[i] * (de * de + dn * dn);
    }
    free(x), free(v), free(m);
    now.spin = L / I, now.k = I / s.mass;
    if (r->transfer == BRUNT_APIC) now.k += (r->kernel == BRUNT_CUBIC ? 2.0 / 3 : 0.5) / (r->cells * r->cells);
    return now;
}

// Acceleration between two times, once gravity is there, over that of a rigid body that rolls.
static double rolling(const roll *r) {
    brunt_world_def def = def_roll(r);
    brunt_world *w = world_take(&def);
    const double k = observe(w, r).k;
    world_until(w, 0.8);
    const motion from = observe(w, r);
    world_until(w, 2.5);
    const motion to = observe(w, r);
    const double a = (to.velocity - from.velocity) / (to.time - from.time), rigid = sin(r->slope) / (1 + k);
    const brunt_energy e = world_energy(w);
    printf("  %s, %d cells: acceleration %+.2f %% of that with its inertia, %+.2f %% of %.3f sin a, spin %+.1f %%; "
           "friction takes %.1e\n",
           r->bed == PLANE  ? "plane"
           : r->bed == MESH ? "mesh"
                            : "points",
           r->cells, 100 * (a / rigid - 1), 100 * (a / sin(r->slope) * (r->dimension == 3 ? 1.4 : 1.5) - 1),
           r->dimension == 3 ? 5.0 / 7 : 2.0 / 3, 100 * ((to.spin - from.spin) / (to.velocity - from.velocity) - 1),
           e.friction);
    ck_assert_double_ge(e.friction, 0);
    ck_assert_double_lt(fabs(e.error_relative), 1e-3);
    brunt_world_destroy(w);
    return a / rigid;
}

// B18.
START_TEST(rolls_on_its_radius) {
    for (int on = PLANE; on <= POINTS; on++)
        for (int cells = 4; cells <= 8; cells *= 2) {
            roll r = plain;
            r.bed = on, r.cells = cells;
            ck_assert_double_eq_tol(rolling(&r), 1, cells == 4 ? 0.02 : 0.01);
        }
}
END_TEST

START_TEST(rolls_alike_however_it_is_turned) {
    static const double turns[] = {0, PI / 2, 200 * PI / 180};
    for (int i = 0; i < 18; i++) {
        roll r = plain;
        r.bed = i % 3;
        r.turn = turns[i / 3 % 3];
        r.slope *= i < 9 ? 1 : -1;
        r.drift = i / 3 == 1 ? -0.7 : 0;
        r.name = i / 3 % 2 == 0 ? "a slab" : "slab";
        ck_assert_double_eq_tol(rolling(&r), 1, 0.02);
    }
}
END_TEST

START_TEST(rolls_in_space) {
    roll r = plain;
    r.dimension = 3;
    r.axis[0] = 2.0 / 3, r.axis[1] = -1.0 / 3, r.axis[2] = 2.0 / 3, r.turn = 1.1;
    for (r.bed = PLANE; r.bed <= POINTS; r.bed++) ck_assert_double_eq_tol(rolling(&r), 1, 0.02);
}
END_TEST

// A disk that comes in obliquely, without gravity, until it has left again.
static brunt_world *bounced(const roll *r, double tangential, double normal) {
    brunt_world_def def = def_roll(r);
    memset(def.gravity, 0, sizeof def.gravity);
    def.gravity_ramp = 0;
    turned(r, tangential, -normal, def.bodies[0].velocity);
    brunt_world *w = world_take(&def);
    world_until(w, 1.5);
    return w;
}

// B16. Friction that takes v from its speed gives it the spin v / k: it acts at a radius from the centre. Where it
// sticks the disk, being soft, leaves with more spin than a rigid one (Maw, Barber and Fawcett 1976), so it slides
// here. What is left is the pressure, which friction moves off the middle of the contact: at 8 cells a radius 3 %, at 4
// cells, where it stands on two particles, 13 %.
START_TEST(bounces_off_with_the_spin_of_its_radius) {
    for (int on = PLANE; on <= POINTS; on++) {
        roll r = plain;
        r.bed = on, r.cells = 16, r.friction = 0.2;
        brunt_world *w = bounced(&r, 0.12, 0.06);
        const motion after = observe(w, &r);
        printf("  bounce: velocity %.4f, spin %.4f, acts at %.4f of the radius\n", after.velocity, after.spin,
               after.k * after.spin / (0.12 - after.velocity));
        ck_assert_double_gt(after.spin, 0.04);
        ck_assert_double_eq_tol(after.k * after.spin / (0.12 - after.velocity), 1, 0.006);
        brunt_world_destroy(w);
    }
}
END_TEST

START_TEST(friction_only_takes_energy) {
    for (int i = 0; i < 24; i++) {
        roll r = plain;
        r.bed = i % 3, r.kernel = i / 3 % 2 ? BRUNT_CUBIC : BRUNT_QUADRATIC;
        r.transfer = i < 6 ? BRUNT_PIC : i < 12 ? BRUNT_FLIP : BRUNT_APIC;
        r.friction = i < 18 ? 0.2 : 5;
        brunt_world *w = bounced(&r, 0.4, 0.2);
        const brunt_energy e = world_energy(w);
        ck_assert_double_gt(e.friction, 0);
        ck_assert_double_lt(fabs(e.error_relative), 5e-3);
        brunt_world_destroy(w);
    }
}
END_TEST

START_TEST(without_friction_nothing_rubs) {
    for (int i = 0; i < 4; i++) {
        roll r = plain;
        r.bed = i % 2, r.friction = 0;
        const double tangential = i < 2 ? 0 : 0.4;
        brunt_world *w = bounced(&r, tangential, 0.2);
        const motion after = observe(w, &r);
        const brunt_reaction f = r.bed == MESH ? world_pair(w, 0) : world_boundary(w, 0);
        ck_assert_double_gt(fabs(f.impulse[1]), 1);
        ck_assert_double_eq(f.impulse[0], 0);
        ck_assert_double_eq_tol(after.velocity, tangential, 10 * ROUNDING);
        if (i < 2) ck_assert_double_eq_tol(after.spin, 0, 1e3 * ROUNDING); // else it may roll a little over the grid
        brunt_world_destroy(w);
    }
}
END_TEST

// A disk rubs past a block of elements, both free: what one gets the other gives, where it is given.
START_TEST(what_rubs_keeps_momentum) {
    for (int i = 0; i < 8; i++) {
        roll r = plain;
        r.bed = MESH, r.turn = i % 2 ? 0.7 : 0, r.name = i / 2 % 2 ? "a slab" : "slab";
        r.kernel = i < 4 ? BRUNT_QUADRATIC : BRUNT_CUBIC;
        brunt_world_def def = def_roll(&r);
        memset(def.gravity, 0, sizeof def.gravity);
        def.gravity_ramp = 0;
        def.group_count = 0;
        turned(&r, 2, -1, def.bodies[0].velocity);
        brunt_world *w = world_take(&def);
        world_until(w, 0.6);
        const brunt_momentum m = world_momentum(w);
        const motion after = observe(w, &r);
        ck_assert_double_gt(after.spin, 0.5);
        ck_assert_double_lt(m.linear_drift, ROUNDING);
        ck_assert_double_lt(m.angular_drift, ROUNDING);
        const brunt_energy e = world_energy(w);
        ck_assert_double_gt(e.friction, 0);
        ck_assert_double_lt(fabs(e.error_relative), 5e-3);
        brunt_world_destroy(w);
    }
}
END_TEST

// A disk of points rubs past a block of points, both free.
START_TEST(points_that_rub_keep_momentum) {
    for (int i = 0; i < 8; i++) {
        roll r = plain;
        r.turn = i % 2 ? 0.7 : 0, r.friction = i / 2 % 2 ? 5 : 0.3;
        r.kernel = i < 4 ? BRUNT_QUADRATIC : BRUNT_CUBIC;
        brunt_world_def def = def_roll(&r);
        memset(def.gravity, 0, sizeof def.gravity);
        def.gravity_ramp = 0;
        def.plane_count = 0;
        brunt_body_def *slab = def_box(&def, "slab", XYZ(-2, -0.75, 0), XYZ(2, 0, 0));
        slab->place = brunt_placement_rotate(slab->place, r.axis, r.turn, XYZ(0, 0, 0));
        turned(&r, 2, -1, def.bodies[0].velocity);
        brunt_world *w = world_take(&def);
        world_until(w, 0.6);
        const brunt_momentum m = world_momentum(w);
        ck_assert_double_gt(observe(w, &r).spin, 0.1);
        ck_assert_double_lt(m.linear_drift, ROUNDING);
        ck_assert_double_lt(m.angular_drift, ROUNDING);
        const brunt_energy e = world_energy(w);
        ck_assert_double_gt(e.friction, 0);
        ck_assert_double_lt(fabs(e.error_relative), 5e-3);
        brunt_world_destroy(w);
    }
}
END_TEST

// A block slides without friction over a bed of points, its rims over particle after particle: nothing holds it.
START_TEST(slides_over_points) {
    brunt_world_def def = def_begin(3, 0.25);
    def_material(&def, "neo-hookean", 10, 1e5, 0.3);
    def_box(&def, "bed", XYZ(-1.5, -0.75, -0.75), XYZ(1, 0.75, 0));
    brunt_body_def *block = def_box(&def, "block", XYZ(-1.25, -0.5, 0), XYZ(-0.25, 0.5, 1));
    block->velocity[0] = 2.6;
    def_plane(&def, XYZ(0, 0, -0.5), XYZ(0, 0, 1), BRUNT_STICK, 0);
    def.gravity[2] = -10, def.gravity_ramp = 0.05;
    def.contact.method = BRUNT_CONTACT_AUGURY;
    brunt_world *w = world_take(&def);
    world_until(w, 0.3);
    const brunt_body_sums s = world_sums(w, 1);
    const brunt_energy e = world_energy(w);
    printf("  slides at %.4f of its speed; contact takes %.4f J of %.1f J\n", s.velocity[0] / 2.6, e.contact,
           e.kinetic);
    ck_assert_double_eq_tol(s.velocity[0] / 2.6, 1, 2e-3);
    ck_assert_double_ge(e.contact, 0);
    ck_assert_double_lt(e.contact, 0.002 * e.kinetic);
    ck_assert_double_lt(fabs(e.error_relative), 1e-6);
    brunt_world_destroy(w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("rolling");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_test(all, rolls_on_its_radius);
    tcase_add_test(all, rolls_alike_however_it_is_turned);
    tcase_add_test(all, rolls_in_space);
    tcase_add_test(all, bounces_off_with_the_spin_of_its_radius);
    tcase_add_test(all, friction_only_takes_energy);
    tcase_add_test(all, without_friction_nothing_rubs);
    tcase_add_test(all, what_rubs_keeps_momentum);
    tcase_add_test(all, points_that_rub_keep_momentum);
    tcase_add_test(all, slides_over_points);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
