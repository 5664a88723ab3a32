// What becomes of a definition: nodes of meshes, motion at the start, what particles reach and how warm they are, which
// bodies lie in each other or behind planes of symmetry, what pairs rub by, and scenes far from the origin.
#include "tests/support/def_world.h"

#include "mpm/particles.h"
#include "world/world.h"

static brunt_world_def begin(int dimension) {
    brunt_world_def def = def_begin(dimension, 0.25);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    return def;
}

static int refused(const brunt_world_def *def, const char *word) {
    brunt_error error = {0};
    brunt_world *world = brunt_world_create(def, &error);
    if (world) brunt_world_destroy(world);
    if (!world) ck_assert_msg(strstr(error.message, word) != NULL, "%s", error.message);
    return !world;
}

// A mesh may have nodes that no element uses: the others are read in their order, without gaps.
START_TEST(nodes_without_elements_are_left_out) {
    static const double place[6][2] = {{7, 7}, {0, 0}, {2, 0}, {8, 8}, {2, 1}, {0, 1}};
    static const int32_t used[4] = {1, 2, 4, 5}, corner[4] = {0, 1, 2, 3};
    brunt_world_def def = begin(2);
    brunt_body_def *body = def_body(&def, "plate");
    body->method = BRUNT_FEM;
    body->mesh = (brunt_mesh){.kind = BRUNT_QUAD4, .node_count = 6, .element_count = 1};
    body->mesh.nodes = brunt_alloc(6 * sizeof *body->mesh.nodes),
    body->mesh.elements = brunt_alloc(4 * sizeof(int32_t));
    for (int n = 0; n < 6; n++) memcpy(body->mesh.nodes[n], place[n], sizeof place[n]);
    memcpy(body->mesh.elements, used, sizeof used);
    brunt_world *world = world_take(&def);
    int32_t node[4];
    ck_assert_int_eq(brunt_body_nodes(world, 0), 4);
    ck_assert_double_eq(brunt_world_dt_min(world), brunt_world_dt(world)); // no step yet
    const brunt_body_sums sums = world_sums(world, 0);
    ck_assert(sums.low[2] == 0 && sums.high[2] == 0 && sums.high[0] == 2 && sums.high[1] == 1);
    brunt_body_connectivity(world, 0, node);
    ck_assert_mem_eq(node, corner, sizeof corner);
    double *x = world_field(world, 0, "position");
    for (int n = 0; n < 4; n++)
        for (int a = 0; a < 2; a++) ck_assert_double_eq(x[3 * n + a], place[used[n]][a]);
    free(x);
    brunt_world_destroy(world);
}
END_TEST

// Of a disk that flies apart at the start what is on its axis has no way to go but along it.
START_TEST(the_axis_does_not_move_outward) {
    brunt_world_def def = begin(2);
    def.axisymmetric = true;
    brunt_body_def *body = def_box(&def, "disk", XYZ(0, 0, 0), XYZ(1, 0.5, 0));
    body->method = BRUNT_FEM, body->element = _i ? BRUNT_TRI3 : BRUNT_QUAD4, body->size = 0.25;
    def_velocity(body, 3, 2, 0);
    brunt_world *world = world_take(&def);
    for (int s = 0; s < 2; s++) {
        double *x = world_field(world, 0, "position"), *v = world_field(world, 0, "velocity");
        int on_axis = 0;
        for (int64_t n = 0; n < brunt_body_nodes(world, 0); n++) {
            if (x[3 * n] != 0) continue;
            on_axis++;
            ck_assert_double_eq(v[3 * n], 0);
        }
        ck_assert_int_eq(on_axis, 3);
        free(x), free(v);
        world_steps(world, 5);
    }
    brunt_world_destroy(world);
}
END_TEST

// Half a spacing is what a particle of a fluid reaches, and one inside a body that erodes; else it reaches the surface.
// Those in the outermost layer, half a spacing below it, are alike.
START_TEST(particles_reach_what_is_theirs) {
    brunt_world_def def = begin(2);
    brunt_body_def *body = def_box(&def, "block", XYZ(0, 0, 0), XYZ(2, 2, 0));
    body->spacing = 0.1;
    if (_i) body->erosion.strain = 0.5;
    def_box(&def, "other", XYZ(5, 0, 0), XYZ(6, 1, 0)); // it may meet one
    brunt_world *world = world_take(&def);
    brunt_particles *p = &world->bodies.mpm[0].particles;
    real *const *x = brunt_field(p, BRUNT_FIELD_position), *reach = brunt_field(p, BRUNT_FIELD_reach)[0];
    for (int64_t s = 0; s < p->slots; s++) {
        if (p->id[s] < 0) continue;
        double deep = INFINITY; // reaches end at the corner of a particle's own square
        for (int a = 0; a < 2; a++) deep = fmin(deep, fmin((double)x[a][s], 2 - (double)x[a][s]));
        const double wanted = _i && deep > 0.11 ? 0.05 : fmin(deep, 0.05 * sqrt(2));
        ck_assert_double_eq_tol((double)reach[s], wanted, 1e-6);
    }
    brunt_world_destroy(world);
}
END_TEST

START_TEST(points_are_as_warm_as_their_body) {
    brunt_world_def def = begin(2);
    brunt_error error = {0};
    brunt_material_def *m = &def.materials[0];
    *m = brunt_material_def_default("m", "johnson-cook");
    static const struct {
        const char *key;
        double value;
    } set[] = {{"density", 1000}, {"E", 1e7}, {"nu", 0.3},    {"A", 2e5},
               {"B", 5e5},        {"n", 0.5}, {"melt", 1000}, {"heat_capacity", 500}};
    for (size_t k = 0; k < sizeof set / sizeof *set; k++) brunt_material_set(m, set[k].key, set[k].value, NULL, &error);
    ck_assert_msg(error.code == BRUNT_OK, "%s", error.message);
    brunt_body_def *body = def_box(&def, "block", XYZ(0, 0, 0), XYZ(1, 1, 0));
    body->temperature = 412;
    if (_i) body->method = BRUNT_FEM, body->element = BRUNT_QUAD4, body->size = 0.25;
    brunt_world *world = world_take(&def);
    double *warm = world_field(world, 0, "temperature");
    for (int64_t k = 0; k < (_i ? brunt_body_elements(world, 0) : brunt_body_particles(world, 0)); k++)
        ck_assert_double_eq(warm[k], 412);
    free(warm);
    brunt_world_destroy(world);
}
END_TEST

// A slat that is turned by 45 degrees lies over a block on one of its diagonals and not over one on the other.
START_TEST(what_overlaps_is_seen_where_it_is_turned_to) {
    brunt_world_def def = begin(2);
    brunt_body_def *slat = def_box(&def, "slat", XYZ(-2, -0.2, 0), XYZ(2, 0.2, 0));
    slat->place = brunt_placement_rotate(slat->place, XYZ(0, 0, 1), PI / 4, XYZ(0, 0, 0));
    const double y = _i ? 1 : -1;
    def_box(&def, "block", XYZ(0.75, y - 0.25, 0), XYZ(1.25, y + 0.25, 0));
    ck_assert_int_eq(refused(&def, "overlaps"), _i);
    brunt_world_def_free(&def);
}
END_TEST

// What reaches behind a plane of symmetry by more than rounding would be there twice.
START_TEST(bodies_end_at_planes_of_symmetry) {
    const double behind = _i % 2 ? 0.1 : 0; // a fifth of a spacing, or of an edge
    brunt_world_def def = begin(2);
    brunt_body_def *body = def_box(&def, "block", XYZ(-behind, 0, 0), XYZ(2, 2, 0));
    body->spacing = 0.5;
    if (_i / 2) body->method = BRUNT_FEM, body->element = BRUNT_QUAD4, body->size = 0.5;
    if (!(_i / 2) && behind > 0) body->shape.min[0] = -0.35; // so that a first row of centres is at -0.1
    def_box(&def, "points", XYZ(5, 0, 0), XYZ(6, 1, 0));     // the plane wants a grid
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SYMMETRY, 0);
    ck_assert_int_eq(refused(&def, "behind the plane of symmetry"), _i % 2);
    brunt_world_def_free(&def);
}
END_TEST

// A pair has the friction that it is given itself, not that of all others.
START_TEST(pairs_rub_by_their_own_friction) {
    static const double all[] = {0.5, 0}, own[] = {0, 0.5};
    brunt_world_def def = begin(2);
    const bool meshes = _i / 2;
    def.contact.method = meshes ? BRUNT_CONTACT_AUGURY : BRUNT_CONTACT_MULTI_VELOCITY;
    def.contact.friction = all[_i % 2];
    brunt_body_def *body[2] = {def_box(&def, "low", XYZ(-2, -0.5, 0), XYZ(2, 0, 0)),
                               def_box(&def, "top", XYZ(-0.25, 0.01, 0), XYZ(0.25, 0.51, 0))};
    def_velocity(body[1], 4, -1, 0);
    for (int k = 0; k < 2 && meshes; k++)
        body[k]->method = BRUNT_FEM, body[k]->element = BRUNT_QUAD4, body[k]->size = 0.125;
    def.contact.pairs = brunt_alloc(sizeof *def.contact.pairs), def.contact.pair_count = 1;
    brunt_pair_def *pair = def.contact.pairs;
    snprintf(pair->a, sizeof pair->a, "low"), snprintf(pair->b, sizeof pair->b, "top");
    pair->method = def.contact.method, pair->friction = own[_i % 2];
    brunt_world *world = world_take(&def);
    world_until(world, 0.04);
    const brunt_reaction f = world_pair(world, 0);
    ck_assert_double_gt(fabs(f.impulse[1]), 50);
    if (_i % 2)
        ck_assert_double_gt(f.friction_work, 20);
    else
        ck_assert_double_eq(f.friction_work, 0);
    brunt_world_destroy(world);
}
END_TEST

// A block thrown at a plane of symmetry is thrown back as near the origin as thousands of cells away, where the grid
// starts near the scene.
START_TEST(planes_of_symmetry_stand_far_away) {
    double impulse[2];
    for (int far = 0; far < 2; far++) {
        const double x = far ? 1024 : 0; // a number without roundings
        brunt_world_def def = begin(2);
        def_velocity(def_box(&def, "block", XYZ(x + 0.25, x, 0), XYZ(x + 1.25, x + 1, 0)), -5, 0, 0);
        def_plane(&def, XYZ(x, x, 0), XYZ(1, 0, 0), BRUNT_SYMMETRY, 0);
        brunt_world *world = world_take(&def);
        world_until(world, 0.1);
        impulse[far] = world_boundary(world, 0).impulse[0];
        ck_assert_double_gt(impulse[far], 5 * 1000 * 0.9);
        brunt_world_destroy(world);
    }
    ck_assert_double_eq_tol(impulse[1], impulse[0], TOLERANCE(1e-6, 0.05) * impulse[0]);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("worlds made");
    ADD_LOOP(nodes_without_elements_are_left_out, 1);
    ADD_LOOP(the_axis_does_not_move_outward, 2);
    ADD_LOOP(particles_reach_what_is_theirs, 2);
    ADD_LOOP(points_are_as_warm_as_their_body, 2);
    ADD_LOOP(what_overlaps_is_seen_where_it_is_turned_to, 2);
    ADD_LOOP(bodies_end_at_planes_of_symmetry, 4);
    ADD_LOOP(pairs_rub_by_their_own_friction, 4);
    ADD_LOOP(planes_of_symmetry_stand_far_away, 1);
    return suite_main(suite);
}
