// What meets material points that a region holds meets an infinite mass: a block that rests on them does not sink, and
// they take no energy.
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

int main(void) {
    Suite *suite = suite_create("held_points");
    TCase *looped = tcase_create("bears_a_block");
    tcase_add_loop_test(looped, bears_a_block, 0, 4);
    suite_add_tcase(suite, looped);
    TCase *planes = tcase_create("planes");
    tcase_add_test(planes, a_plane_gives_way_to_what_moves_points);
    suite_add_tcase(suite, planes);
    return suite_main(suite);
}
