// What meets material points that a region holds meets an infinite mass: a block that rests on them does not sink, and
// they take no energy. Of several regions the last one's velocity is theirs, and it alone gives it to them.
#include "tests/support/hard_world.h"

static const double H = 0.1; // [m] cells and edges
static const double END = 0.3;
static const double HELD = ROUNDING; // [m] what places of held points are rounded by

// The caller frees the definition after the world, which shares the region's shape.
static brunt_world *block_on_held_points(bool mesh, brunt_contact_method method, brunt_world_def *kept) {
    brunt_world_def def = def_begin(2, H);
    def.regions = brunt_alloc(DEF_CAPACITY * sizeof *def.regions);
    def.contact.method = method;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *block = def_box(&def, "block", XYZ(1.3 * H, 0, 0), XYZ(4.3 * H, 2 * H, 0));
    if (mesh) block->method = BRUNT_FEM, block->element = BRUNT_QUAD4, block->size = H;
    def_box(&def, "slab", XYZ(0, -2 * H, 0), XYZ(6 * H, 0, 0));
    brunt_region_def *r = &def.regions[def.region_count++];
    *r = brunt_region_def_default();
    snprintf(r->body, sizeof r->body, "slab");
    r->shape.kind = BRUNT_BOX;
    for (int a = 0; a < 2; a++) r->component[a] = true, r->shape.min[a] = -100 * H, r->shape.max[a] = 100 * H;
    def.gravity[1] = -1;
    *kept = def;
    return world_take(kept);
}

// [m] furthest that any of a body's particles or nodes has gone up or down since `from`
static double gone(brunt_world *world, int body, const double *from) {
    double(*x)[3] = (void *)world_field(world, body, "position"), most = 0;
    for (int64_t i = 0; i < brunt_body_nodes(world, body) + brunt_body_particles(world, body); i++)
        most = fmax(most, fabs(x[i][1] - from[3 * i + 1]));
    free(x);
    return most;
}

START_TEST(bears_a_block) {
    brunt_world_def def;
    static const brunt_contact_method methods[] = {BRUNT_CONTACT_MULTI_VELOCITY, BRUNT_CONTACT_AUGURY,
                                                   BRUNT_CONTACT_MULTI_VELOCITY, BRUNT_CONTACT_AUGURY};
    const bool mesh = _i == 1 || _i == 2;
    brunt_world *world = block_on_held_points(mesh, methods[_i], &def);
    double *from[2] = {world_field(world, 0, "position"), world_field(world, 1, "position")};
    world_until(world, END);
    const int slab = !strcmp(brunt_body_name(world, 1), "slab");
    const double sunk = gone(world, !slab, from[!slab]), moved = gone(world, slab, from[slab]);
    printf("%s by method %d on held points: sunk %.3g, they moved %.3g edges\n", mesh ? "mesh" : "points",
           (int)methods[_i], sunk / H, moved / H);
    ck_assert(moved < HELD);    // they are held
    ck_assert(sunk < 1e-3 * H); // twice rho g h^2 / 2 E is 4e-4 edges, and the height they begin at
    free(from[0]), free(from[1]);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}
END_TEST

// What a region moves goes where the region says, through a plane that would push it: the two are infinite masses to
// each other, so that the plane gives nothing.
START_TEST(a_plane_gives_way_to_what_moves_points) {
    brunt_world_def def = def_begin(2, H);
    def.regions = brunt_alloc(DEF_CAPACITY * sizeof *def.regions);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_box(&def, "slab", XYZ(0, 0, 0), XYZ(6 * H, 2 * H, 0));
    brunt_region_def *r = &def.regions[def.region_count++];
    *r = brunt_region_def_default();
    snprintf(r->body, sizeof r->body, "slab");
    r->shape.kind = BRUNT_BOX;
    r->velocity[1] = -1;
    for (int a = 0; a < 2; a++) r->component[a] = true, r->shape.min[a] = -100 * H, r->shape.max[a] = 100 * H;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0.3);
    brunt_world *world = world_take(&def);
    double *from = world_field(world, 0, "position");
    world_until(world, 0.05);
    double *to = world_field(world, 0, "position");
    for (int64_t i = 0; i < brunt_body_particles(world, 0); i++)
        ck_assert_double_eq_tol(to[3 * i + 1] - from[3 * i + 1], -0.05, HELD);
    brunt_reaction plane;
    brunt_boundary_reaction(world, 0, &plane);
    for (int a = 0; a < 3; a++) ck_assert_double_eq(plane.impulse[a], 0);
    free(from), free(to);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}
END_TEST

// A block, and half of it, that fall on a plane which goes through them: one at a line of the grid does what one half a
// cell higher does, up to the next line, as the same nodes are at and behind it. By images the block would be its own
// image, and what both sides have in common be lost: 393 J of 500 J. Of two blocks, one on each side, both have images.
START_TEST(what_a_plane_goes_through_is_held_behind_it) {
    static const brunt_condition conditions[] = {BRUNT_SLIP, BRUNT_STICK};
    brunt_energy energy[3];
    brunt_reaction plane[3];
    for (int k = 0; k < 3; k++) {
        brunt_world_def def = def_begin(2, H);
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        def_box(&def, "above", XYZ(0, k == 2 ? 4 * H : 0, 0), XYZ(8 * H, 8 * H, 0))->velocity[1] = -1;
        if (k == 2) def_box(&def, "below", XYZ(0, 0, 0), XYZ(8 * H, 4 * H, 0))->velocity[1] = -1;
        def_plane(&def, XYZ(0, (k == 1 ? 4.5 : 4) * H, 0), XYZ(0, 1, 0), conditions[_i], 0);
        def.contact.method = BRUNT_CONTACT_NONE;
        brunt_world *world = world_take(&def);
        world_steps(world, 20);
        energy[k] = world_energy(world);
        brunt_boundary_reaction(world, 0, &plane[k]);
        const double below = k == 2 ? world_sums(world, 1).momentum[1] / (1000 * 32 * H * H) : 0;
        ck_assert(k == 2 && conditions[_i] == BRUNT_SLIP ? fabs(below) > 0.1 : fabs(below) < 1e-3); // [m/s]
        brunt_world_destroy(world);
        brunt_world_def_free(&def);
    }
    ck_assert_double_eq(energy[0].kinetic, energy[1].kinetic);
    ck_assert_double_eq(energy[0].internal, energy[1].internal);
    ck_assert_double_eq(plane[0].impulse[1], plane[1].impulse[1]);
    ck_assert_double_lt(energy[0].transfer, 0.1 * energy[0].initial);
}
END_TEST

static brunt_region_def *add_region(brunt_world_def *def, const char *body) {
    brunt_region_def *r = &def->regions[def->region_count++];
    *r = brunt_region_def_default();
    snprintf(r->body, sizeof r->body, "%s", body);
    r->shape.kind = BRUNT_BOX;
    for (int a = 0; a < 2; a++) r->component[a] = true, r->shape.min[a] = -100 * H, r->shape.max[a] = 100 * H;
    return r;
}

// A block within two regions: the first gives it (2, 1) m/s, the second -3 m/s along x, and leaves y free. What each
// gives is the block's momentum, once: nothing where the other one's velocity is kept.
START_TEST(the_last_region_alone_acts) {
    enum { ALWAYS, NOT_YET, OF_ANOTHER, ALIKE, CASES };
    const int is = _i % CASES;
    brunt_world_def def = def_begin(2, H);
    def.regions = brunt_alloc(DEF_CAPACITY * sizeof *def.regions);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(2 * H, 2 * H, 0));
    def_box(&def, "other", XYZ(9 * H, 0, 0), XYZ(10 * H, 2 * H, 0));
    brunt_region_def *first = add_region(&def, ""), *second = add_region(&def, is == OF_ANOTHER ? "other" : "");
    first->velocity[0] = is == ALIKE ? -3 : 2, first->velocity[1] = 1;
    second->velocity[0] = -3, second->component[1] = false;
    first->shape.max[0] = 5 * H, second->shape.max[0] = is == OF_ANOTHER ? 100 * H : 5 * H;
    if (is == NOT_YET) second->start = 1;
    if (_i >= CASES) def.kernel = BRUNT_LINEAR, def.transfer = BRUNT_PIC; // velocities go to the grid a second time
    brunt_world *world = world_take(&def);
    const double mass = 1000 * 4 * H * H;
    world_steps(world, 10);
    brunt_reaction by[2];
    for (int w = 0; w < 2; w++) brunt_boundary_reaction(world, w, &by[w]);
    const double way[4] = {0, 2, 2, -3}, tolerance = TOLERANCE(1e-12, 1e-5) * mass;
    ck_assert_double_eq_tol(by[0].impulse[0], way[is] * mass, tolerance);
    ck_assert_double_eq_tol(by[0].impulse[1], mass, tolerance);
    ck_assert_double_eq_tol(by[1].impulse[0], is == ALWAYS ? -3 * mass : is == OF_ANOTHER ? -1.5 * mass : 0, tolerance);
    ck_assert_double_eq_tol(by[1].impulse[1], 0, tolerance);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}
END_TEST

// A block on a floor that holds its lowest nodes, pushed by a wall that holds those of its side, the corner in both:
// energy is kept as with one of them.
START_TEST(regions_that_overlap_keep_the_ledger) {
    double error[2];
    for (int overlap = 0; overlap < 2; overlap++) {
        brunt_world_def def = def_begin(2, H);
        def.regions = brunt_alloc(DEF_CAPACITY * sizeof *def.regions);
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        def_box(&def, "block", XYZ(0, 0, 0), XYZ(10 * H, 10 * H, 0));
        brunt_region_def *floor = add_region(&def, ""), *wall = add_region(&def, "");
        floor->shape.max[1] = H, wall->shape.max[0] = 1.5 * H, wall->velocity[0] = 1;
        if (!overlap) wall->shape.min[1] = 1.5 * H;
        brunt_world *world = world_take(&def);
        world_until(world, 0.02);
        brunt_energy energy;
        brunt_world_energy(world, &energy);
        error[overlap] = fabs(energy.error / energy.external_work);
        printf("energy lost or made %.3g of the work\n", error[overlap]);
        brunt_world_destroy(world);
        brunt_world_def_free(&def);
    }
    ck_assert(error[0] < 2e-4 && error[1] < 2e-4);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("held_points");
    TCase *looped = tcase_create("bears_a_block");
    tcase_add_loop_test(looped, bears_a_block, 0, 4);
    suite_add_tcase(suite, looped);
    TCase *planes = tcase_create("planes");
    tcase_add_test(planes, a_plane_gives_way_to_what_moves_points);
    tcase_add_loop_test(planes, what_a_plane_goes_through_is_held_behind_it, 0, 2);
    tcase_add_loop_test(planes, the_last_region_alone_acts, 0, 8);
    tcase_add_test(planes, regions_that_overlap_keep_the_ledger);
    suite_add_tcase(suite, planes);
    return suite_main(suite);
}
