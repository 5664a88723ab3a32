// Scenes of more boundaries than a byte counts, as those of hundreds of bodies have: each acts, on the bodies that it
// names and no others.
#include "contact/planes/grid_conditions.h"
#include "tests/support/def_world.h"
#include "world/world.h"

#ifdef BRUNT_FLOAT
enum { SCHEMES = 1 }; // implicit steps want double
#else
enum { SCHEMES = 2 };
#endif

// A row of unit squares of one element each, apart.
static brunt_world_def squares(int count, int groups, brunt_scheme scheme) {
    brunt_world_def def = def_begin(2, 0);
    brunt_free(def.bodies);
    def.bodies = brunt_alloc((size_t)count * sizeof *def.bodies);
    def.groups = brunt_alloc((size_t)groups * sizeof *def.groups);
    def.scheme = scheme;
    def.step = 1e-3;
    def.contact.method = BRUNT_CONTACT_NONE;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    for (int i = 0; i < count; i++) {
        char name[24];
        snprintf(name, sizeof name, "b%05d", i);
        brunt_body_def *b = def_box(&def, name, XYZ(3 * i, 0, 0), XYZ(3 * i + 1, 1, 0));
        b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 1;
    }
    return def;
}

static void move(brunt_world_def *def, int body, const char *group, double x, double y) {
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "b%05d", body), snprintf(g->group, sizeof g->group, "%s", group);
    snprintf(g->name, sizeof g->name, "g%05d", def->group_count);
    g->action = BRUNT_GROUP_VELOCITY;
    g->value[0] = x, g->value[1] = y;
}

// Velocity of a node after a step, along an axis.
static double velocity_of(brunt_world *world, int body, int node, int axis) {
    double *v = world_field(world, body, "velocity");
    const double value = v[3 * node + axis];
    free(v);
    return value;
}

// The two sides of each body go its own way, and a third group has none left of it.
START_TEST(each_of_many_groups_moves_its_body) {
    enum { COUNT = 100 };
    brunt_world_def def = squares(COUNT, 3 * COUNT, _i ? BRUNT_IMPLICIT : BRUNT_EXPLICIT);
    for (int i = 0; i < COUNT; i++) move(&def, i, "xmin", 1 + i, -i), move(&def, i, "xmax", 1 + i, -i);
    for (int i = 0; i < COUNT; i++) move(&def, i, "surface", 0, 0);
    brunt_world *world = world_take(&def);
    world_steps(world, 2);
    for (int i = 0; i < COUNT; i++)
        for (int n = 0; n < 4; n++) {
            ck_assert_double_eq_tol(velocity_of(world, i, n, 0), 1 + i, 1e-4);
            ck_assert_double_eq_tol(velocity_of(world, i, n, 1), -i, 1e-4);
        }
    brunt_world_destroy(world);
}
END_TEST

// Of groups that hold the same components of a node the first does, and the others what is left, however many they are.
START_TEST(the_first_of_many_groups_holds) {
    enum { COUNT = 600 };
    brunt_world_def def = squares(1, COUNT, _i ? BRUNT_IMPLICIT : BRUNT_EXPLICIT);
    for (int i = 0; i < COUNT - 1; i++) {
        move(&def, 0, "xmin", 1 + i, 0);
        def.groups[i].component[1] = false;
    }
    move(&def, 0, "surface", -1, -2);
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    brunt_reaction last;
    brunt_boundary_reaction(world, COUNT - 1, &last);
    if (!_i) ck_assert_double_eq_tol(last.impulse[1], -2 * 1000, 1e-2); // of all its mass
    for (int n = 0; n < 4; n++) {
        double *x = world_field(world, 0, "position");
        const bool left = x[3 * n] < 0.5;
        free(x);
        ck_assert_double_eq_tol(velocity_of(world, 0, n, 0), left ? 1 : -1, 1e-6);
        ck_assert_double_eq_tol(velocity_of(world, 0, n, 1), -2, 1e-6);
    }
    brunt_world_destroy(world);
}
END_TEST

// Counts what each body of material points is held by in a step. What comes after that are the boundaries behind it,
// wherever its own account is.
static int64_t held;
static const brunt_boundaries *holders;
static void count_hold(const brunt_held_grid *g, brunt_boundary *b, double time) {
    ck_assert(b->body < 0 || b->body == g->body->index);
    ck_assert_int_lt(g->later_count, holders->boundary_count);
    ck_assert_ptr_eq(g->later + g->later_count, holders->boundary + holders->boundary_count);
    ck_assert_str_eq(g->later[-1].name, b->name);
    (void)time, held++;
}

// Blocks of material points; of each its own region and plane, and one region of all in their middle.
static brunt_world_def held_points(int count) {
    brunt_world_def def = def_begin(2, 1);
    brunt_free(def.bodies), brunt_free(def.planes);
    def.bodies = brunt_alloc((size_t)count * sizeof *def.bodies);
    def.planes = brunt_alloc((size_t)count * sizeof *def.planes);
    def.regions = brunt_alloc(((size_t)count + 1) * sizeof *def.regions);
    def.kernel = BRUNT_LINEAR;
    def.contact.method = BRUNT_CONTACT_NONE;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    for (int i = 0; i < count; i++) {
        char name[24];
        snprintf(name, sizeof name, "b%05d", i);
        def_box(&def, name, XYZ(4 * i, 0, 0), XYZ(4 * i + 1, 1, 0));
        brunt_plane_def *plane = def_plane(&def, XYZ(0, -1, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
        memcpy(plane->body, name, sizeof name);
    }
    for (int i = 0; i <= count; i++) {
        brunt_region_def *region = &def.regions[def.region_count++];
        *region = brunt_region_def_default();
        region->shape.kind = BRUNT_BOX;
        for (int a = 0; a < 3; a++)
            region->shape.min[a] = -1, region->shape.max[a] = 5 * count, region->component[a] = true;
        if (i != count / 2) snprintf(region->body, sizeof region->body, "b%05d", i < count / 2 ? i : i - 1);
    }
    return def;
}

// A step of the linear kernel holds nodes three times: after the forces, after planes, and of the new velocities. What
// is looked at for a body is its own boundaries and that of all.
START_TEST(a_body_looks_at_its_own_boundaries) {
    enum { COUNT = 400 };
    brunt_world_def def = held_points(COUNT);
    brunt_world *world = world_from(&def); // it shares its regions' shapes with the definition
    ck_assert_int_eq(brunt_boundary_count(world), 2 * COUNT + 1);
    brunt_boundaries *all = &world->boundaries;
    holders = all;
    brunt_boundary_kind counted = *all->boundary[COUNT].kind;
    counted.hold_grid = count_hold;
    for (int w = COUNT; w <= 2 * COUNT; w++) all->boundary[w].kind = &counted;
    held = 0;
    world_steps(world, 1);
    ck_assert_int_eq(held, 3 * 2 * COUNT);
    for (int i = 0; i < COUNT; i++) {
        brunt_boundary_walk walk = brunt_boundaries_of(&all->acting, i);
        int seen = 0, before = -1, w;
        while ((w = brunt_boundary_next(&walk)) != BRUNT_NONE) {
            ck_assert_int_lt(before, w);
            ck_assert(all->boundary[w].body == i || all->boundary[w].body == -1);
            before = w, seen++;
        }
        ck_assert_int_eq(seen, 3);
    }
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}
END_TEST

// Pressure on the faces of each body: the step of a body is found from its own loads, and gas by its number.
START_TEST(a_body_has_its_own_loads) {
    enum { COUNT = 50 };
    brunt_world_def def = squares(COUNT, 2 * COUNT, BRUNT_EXPLICIT);
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < COUNT; i++) {
            move(&def, i, side ? "xmax" : "xmin", 1e3 * (i + 1), 0);
            def.groups[def.group_count - 1].action = BRUNT_GROUP_PRESSURE;
        }
    brunt_world *world = world_take(&def);
    const brunt_node_sets *sets = &world->boundaries.sets;
    world_steps(world, 1);
    for (int i = 0; i < COUNT; i++) {
        ck_assert_int_eq(sets->first[i], i);
        ck_assert_int_eq(sets->set[i].next, COUNT + i);
        ck_assert_int_eq(sets->set[COUNT + i].next, BRUNT_NONE);
        // An edge of 1 m has a stiffness of its pressure, shared by nodes of a quarter of 1000 kg.
        ck_assert_double_eq_tol(brunt_load_frequency(sets, &world->bodies, i, 0), 1e3 * (i + 1) / 250, 1e-3 * (i + 1));
    }
    brunt_world_destroy(world);
}
END_TEST

// What a plane that acts on a mesh alone does is no matter of the grid of material points, or of whether there are any:
// it may lie between its lines, and the mesh does the same: to the bit, in implicit steps as far as they are solved.
START_TEST(a_plane_of_a_mesh_lies_where_it_likes) {
    static const brunt_condition conditions[] = {BRUNT_SYMMETRY, BRUNT_SLIP, BRUNT_STICK};
    const brunt_scheme scheme = _i % SCHEMES ? BRUNT_IMPLICIT : BRUNT_EXPLICIT;
    double *place[2];
    for (int points = 0; points < 2; points++) {
        brunt_world_def def = def_begin(2, 0.25);
        def.scheme = scheme, def.step = 1e-3;
        def.newton.tolerance = 1e-10;
        def.contact.method = BRUNT_CONTACT_NONE;
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        brunt_body_def *mesh = def_box(&def, "mesh", XYZ(0, 0.1, 0), XYZ(1, 1.1, 0));
        mesh->method = BRUNT_FEM, mesh->element = BRUNT_QUAD4, mesh->size = 0.5;
        def_velocity(mesh, 0.5, -1, 0);
        if (points) def_box(&def, "points", XYZ(0, -1, 0), XYZ(1, -0.5, 0)); // behind the plane, which is not theirs
        brunt_plane_def *plane = def_plane(&def, XYZ(0, 0.1, 0), XYZ(0, 1, 0), conditions[_i / SCHEMES], 0);
        snprintf(plane->body, sizeof plane->body, "mesh");
        brunt_world *world = world_take(&def);
        world_steps(world, 10);
        place[points] = world_field(world, 0, "position");
        for (int n = 0; n < 9; n++)
            ck_assert(place[points][3 * n + 1] >= 0.1 - ROUNDING && place[points][3 * n + 1] < 1.1);
        brunt_world_destroy(world);
        brunt_world_def_free(&def);
    }
    for (int k = 0; k < 27; k++)
        ck_assert_double_le(fabs(place[0][k] - place[1][k]), scheme == BRUNT_EXPLICIT ? 0 : 1e-12);
    for (int k = 0; k < 2; k++) free(place[k]);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("many boundaries");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 120);
    tcase_add_loop_test(all, each_of_many_groups_moves_its_body, 0, SCHEMES);
    tcase_add_loop_test(all, the_first_of_many_groups_holds, 0, SCHEMES);
    tcase_add_test(all, a_body_looks_at_its_own_boundaries);
    tcase_add_test(all, a_body_has_its_own_loads);
    tcase_add_loop_test(all, a_plane_of_a_mesh_lies_where_it_likes, 0, 3 * SCHEMES);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
