// Meshes of boxes whose elements grow along the axes, against the closed forms of where their nodes are; and contact
// between elements of very different edges along one surface.
#include "tests/support/def_world.h"

typedef double points[2];

static const brunt_curve even_axes[3];

static brunt_mesh make(const brunt_shape *box, int dimension, brunt_element_kind kind, double size,
                       const brunt_curve grading[3]) {
    brunt_mesh mesh;
    brunt_error error = {0};
    ck_assert_msg(!brunt_mesh_graded(box, dimension, kind, size, grading, &mesh, &error), "%s", error.message);
    return mesh;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// The different coordinates of nodes along an axis, ascending. Returns how many; free().
static int layers(const brunt_mesh *mesh, int axis, double **out) {
    double *all = malloc((size_t)mesh->node_count * sizeof *all);
    int count = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) all[n] = mesh->nodes[n][axis];
    qsort(all, (size_t)mesh->node_count, sizeof *all, ascending);
    for (int32_t n = 0; n < mesh->node_count; n++)
        if (!count || all[n] != all[count - 1]) all[count++] = all[n];
    *out = all;
    return count;
}

// Layers of one axis of a box, of quadrilaterals.
static int layers_of(double low, double high, double size, brunt_curve grading, double **out) {
    const brunt_shape box = {.kind = BRUNT_BOX, .min = {low, 0, 0}, .max = {high, size, 0}};
    brunt_mesh mesh = make(&box, 2, BRUNT_QUAD4, size, (brunt_curve[3]){grading});
    const int count = layers(&mesh, 0, out);
    ck_assert_int_eq(mesh.node_count, 2 * count);
    brunt_mesh_free(&mesh);
    return count;
}

// The factor, typed anew.
static double factor(brunt_curve g, double x) {
    const points *p = (const points *)g.points;
    int k = 0;
    if (!g.count || x <= p[0][0]) return g.count ? p[0][1] : 1;
    if (x >= p[g.count - 1][0]) return p[g.count - 1][1];
    while (x > p[k + 1][0]) k++;
    const double share = (x - p[k][0]) / (p[k + 1][0] - p[k][0]);
    return (1 - share) * p[k][1] + share * p[k + 1][1];
}

// Elements between two places by Simpson's rule, in steps that are small beside the grading: to 1e-7.
static double elements_between(brunt_curve g, double size, double from, double to) {
    enum { STEPS = 4000 };
    double sum = 0, step = (to - from) / STEPS;
    for (int i = 0; i < STEPS; i++) {
        const double x = from + i * step;
        sum += step / 6 * (1 / factor(g, x) + 4 / factor(g, x + step / 2) + 1 / factor(g, x + step));
    }
    return sum / size;
}

START_TEST(without_a_factor_it_is_the_even_mesh) {
    const brunt_shape box = {.kind = BRUNT_BOX, .min = {-1, 0.3, 0.5}, .max = {1, 1.7, 1.25}};
    for (int k = BRUNT_TET4; k <= BRUNT_QUAD4; k++) {
        const int dimension = brunt_element_dimension(k), corners = brunt_element_nodes(k);
        brunt_mesh even, graded = make(&box, dimension, k, 0.2, even_axes);
        ck_assert_int_eq(brunt_mesh_shape(&box, dimension, k, 0.2, &even, NULL), BRUNT_OK);
        ck_assert(graded.kind == even.kind && graded.node_count == even.node_count);
        ck_assert_int_eq(graded.element_count, even.element_count);
        ck_assert_mem_eq(graded.elements, even.elements,
                         (size_t)corners * (size_t)even.element_count * sizeof *even.elements);
        for (int32_t n = 0; n < even.node_count; n++)
            for (int a = 0; a < 3; a++) ck_assert_double_eq_tol(graded.nodes[n][a], even.nodes[n][a], 1e-14);
        ck_assert_int_eq(graded.group_count, even.group_count);
        for (int32_t g = 0; g < even.group_count; g++) {
            ck_assert_str_eq(graded.groups[g].name, even.groups[g].name);
            ck_assert_int_eq(graded.groups[g].count, even.groups[g].count);
            ck_assert_mem_eq(graded.groups[g].nodes, even.groups[g].nodes,
                             (size_t)even.groups[g].count * sizeof *even.groups[g].nodes);
        }
        brunt_mesh_free(&graded);
        brunt_mesh_free(&even);
    }
}
END_TEST

// A factor that is 1 + 2 x: (3^(k / n) - 1) / 2, edges in a geometric progression of ratio 3^(1 / n), with
// n = ln 3 / (2 size) rounded. And the other way round.
START_TEST(linear_factors_give_geometric_progressions) {
    points up[2] = {{0, 1}, {1, 3}}, down[2] = {{0, 3}, {1, 1}};
    for (double size = 0.1; size > 0.01; size /= 3) {
        const int n = (int)round(log(3) / (2 * size));
        double *x, *y;
        ck_assert_int_eq(layers_of(0, 1, size, (brunt_curve){up, 2}, &x), n + 1);
        ck_assert_int_eq(layers_of(0, 1, size, (brunt_curve){down, 2}, &y), n + 1);
        ck_assert(x[0] == 0 && x[n] == 1 && y[0] == 0 && y[n] == 1);
        for (int k = 0; k <= n; k++) {
            ck_assert_double_eq_tol(x[k], (pow(3, (double)k / n) - 1) / 2, 1e-14);
            ck_assert_double_eq_tol(y[n - k], 1 - x[k], 1e-14);
        }
        for (int k = 1; k < n; k++)
            ck_assert_double_eq_tol((x[k + 1] - x[k]) / (x[k] - x[k - 1]), pow(3, 1.0 / n), 1e-12);
        free(x), free(y);
    }
}
END_TEST

// Constant factors; points that lie outside; many points; boxes far from the origin, small and large. Ends are exact,
// and from node to node the integral of 1 / (size factor) is the same.
START_TEST(nodes_divide_the_integral_evenly) {
    points two[1] = {{7, 2}}, bump[4] = {{-0.4, 4}, {0.1, 1}, {0.2, 1}, {0.9, 20}},
           outside[4] = {{-9, 1}, {-3, 2}, {5, 6}, {9, 1}}, before[2] = {{-3, 7}, {-2, 3}},
           after[2] = {{3, 0.5}, {4, 9}}, nearly[2] = {{-1, 1}, {1, 1 + 1e-13}},
           steep[3] = {{-0.5, 50}, {0.25, 0.5}, {0.9, 50}};
    const brunt_curve list[] = {{two, 1},   {bump, 4},   {outside, 4}, {before, 2},
                                {after, 2}, {nearly, 2}, {steep, 3},   {NULL, 0}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        const double low = -0.7, high = 1.1, size = 0.01;
        const double whole = elements_between(list[i], size, low, 0.25) + elements_between(list[i], size, 0.25, high);
        double *x;
        const int n = layers_of(low, high, size, list[i], &x) - 1;
        ck_assert_int_eq(n, (int)round(whole));
        ck_assert(x[0] == low && x[n] == high);
        for (int k = 0; k < n; k++)
            ck_assert_double_eq_tol(elements_between(list[i], size, x[k], x[k + 1]), whole / n, 1e-4);
        free(x);
        // A million metres away the same mesh, to what such coordinates can tell.
        points there[4];
        for (int32_t p = 0; p < list[i].count; p++)
            there[p][0] = list[i].points[p][0] + 1e6, there[p][1] = list[i].points[p][1];
        double *far, *near;
        ck_assert_int_eq(layers_of(low + 1e6, high + 1e6, size, (brunt_curve){there, list[i].count}, &far), n + 1);
        layers_of(low, high, size, list[i], &near);
        for (int k = 0; k <= n; k++) ck_assert_double_eq_tol(far[k] - 1e6, near[k], 1e-7);
        free(far), free(near);
    }
    double *x;
    ck_assert_int_eq(layers_of(0, 1, 10, (brunt_curve){two, 1}, &x), 2); // at least one element
    free(x);
}
END_TEST

// Of every kind: fills the box, every group lies on its side with all of the nodes there, no element is turned over.
START_TEST(all_kinds_keep_sides_and_volume) {
    static const char *const names[3][2] = {{"xmin", "xmax"}, {"ymin", "ymax"}, {"zmin", "zmax"}};
    points x[2] = {{0, 1}, {2, 5}}, y[3] = {{-1, 3}, {0, 1}, {1, 3}}, z[1] = {{0, 2}};
    const brunt_curve grading[3] = {{x, 2}, {y, 3}, {z, 1}};
    const brunt_shape box = {.kind = BRUNT_BOX, .min = {0, -1, 3}, .max = {2, 1, 3.6}};
    for (int k = BRUNT_TET4; k <= BRUNT_QUAD4; k++) {
        const int dimension = brunt_element_dimension(k);
        brunt_mesh mesh = make(&box, dimension, k, 0.1, grading);
        brunt_mesh_quality quality;
        brunt_error error = {0};
        ck_assert_msg(!brunt_mesh_check(&mesh, &quality, &error), "%s", error.message);
        ck_assert_double_eq_tol(quality.volume, dimension == 2 ? 4 : 2.4, 1e-12);
        ck_assert_int_eq(mesh.group_count, 2 * dimension + 1);
        // n = ln(5) / (2 size) = 8.05, 2 ln(3) / (2 size) = 10.99, 3
        const int n[3] = {8, 11, 3}, cut[] = {6, 1, 2, 1};
        ck_assert_int_eq(mesh.element_count, cut[k] * n[0] * n[1] * (dimension == 3 ? n[2] : 1));
        for (int g = 0; g < 2 * dimension; g++) {
            const double place = g % 2 ? box.max[g / 2] : box.min[g / 2];
            int32_t wanted = 0, found = 0;
            for (int32_t i = 0; i < mesh.node_count; i++) wanted += mesh.nodes[i][g / 2] == place;
            for (int32_t i = 0; i < mesh.group_count; i++) {
                if (strcmp(mesh.groups[i].name, names[g / 2][g % 2]) != 0) continue;
                found = mesh.groups[i].count;
                for (int32_t q = 0; q < found; q++)
                    ck_assert(mesh.nodes[mesh.groups[i].nodes[q]][g / 2] == place); // exactly
            }
            ck_assert_int_eq(found, wanted);
            ck_assert_int_gt(found, 0);
        }
        brunt_mesh_free(&mesh);
    }
}
END_TEST

START_TEST(what_cannot_be_graded_is_refused) {
    points none[1] = {{0, 0}}, negative[2] = {{0, 1}, {1, -1}}, endless[1] = {{0, INFINITY}}, lost[1] = {{NAN, 1}},
           unknown[1] = {{0, NAN}}, descending[2] = {{1, 1}, {0, 2}}, twice[2] = {{1, 1}, {1, 2}},
           fine[1] = {{0, 1e-6}};
    const brunt_shape box = {.kind = BRUNT_BOX, .max = {1, 1, 1}}, ball = {.kind = BRUNT_SPHERE, .radius = 1},
                      flat = {.kind = BRUNT_BOX, .max = {1, 0, 1}}, turned = {.kind = BRUNT_BOX, .max = {1, 1, -1}};
    const struct {
        const brunt_shape *shape;
        brunt_element_kind kind;
        double size;
        brunt_curve curve;
        const char *message;
    } list[] = {
        {&ball, BRUNT_HEX8, 0.5, {NULL, 0}, "only a box can be graded"},
        {&box, BRUNT_HEX8, 0.5, {none, 1}, "grading.y: factors above 0 at ascending places are wanted, not 0 at 0 m"},
        {&box, BRUNT_HEX8, 0.5, {negative, 2}, "not -1 at 1 m"},
        {&box, BRUNT_HEX8, 0.5, {endless, 1}, "not inf at 0 m"},
        {&box, BRUNT_HEX8, 0.5, {unknown, 1}, "not nan at 0 m"},
        {&box, BRUNT_HEX8, 0.5, {lost, 1}, "not 1 at nan m"},
        {&box, BRUNT_HEX8, 0.5, {descending, 2}, "not 2 at 0 m"},
        {&box, BRUNT_HEX8, 0.5, {twice, 2}, "not 2 at 1 m"},
        {&box, BRUNT_HEX8, 0, {NULL, 0}, "an edge length of 0 m"},
        {&box, BRUNT_HEX8, NAN, {NULL, 0}, "an edge length of nan m"},
        {&flat, BRUNT_HEX8, 0.5, {NULL, 0}, "the extent of a shape to be meshed is 0 m"},
        {&turned, BRUNT_HEX8, 0.5, {NULL, 0}, "the extent of a shape to be meshed is -1 m"},
        {&box, BRUNT_HEX8, 1e-3, {NULL, 0}, "0.001 m makes more than 100 million nodes"},
        {&box, BRUNT_TET4, 1e-3, {fine, 1}, "0.001 m makes more than 100 million nodes"},
        {&box, BRUNT_HEX8, 1e-300, {NULL, 0}, "more than 100 million nodes"},
        {&box, BRUNT_QUAD4, 0.5, {NULL, 0}, "elements of kind quad4 are of 2 dimensions"},
        {&box, BRUNT_MEMBRANE_QUAD4, 0.5, {NULL, 0}, "are membranes"},
    };
    const size_t before = brunt_memory_live();
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        brunt_mesh mesh;
        brunt_error error = {0};
        ck_assert_int_eq(brunt_mesh_graded(list[i].shape, 3, list[i].kind, list[i].size,
                                           (brunt_curve[3]){{NULL, 0}, list[i].curve}, &mesh, &error),
                         BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, list[i].message) != NULL, "'%s' instead of '%s'", error.message,
                      list[i].message);
        ck_assert_int_eq(mesh.node_count + mesh.element_count + mesh.group_count, 0);
    }
    ck_assert_uint_eq(brunt_memory_live(), before);
}
END_TEST

static brunt_curve owned(int count, const points *from) {
    brunt_curve curve = {brunt_alloc((size_t)count * sizeof *from), count};
    memcpy(curve.points, from, (size_t)count * sizeof *from);
    return curve;
}

// A block with an even mesh is thrown onto a plate whose elements grow from its own edge to twelve times that along the
// surface and the depth: momenta and energy are kept, it does not sink in, and it comes to rest or leaves as of an even
// plate of its own edge, to what the waves in the coarse part of the plate change.
static double thrown_onto(int dimension, bool graded, double *depth) {
    brunt_world_def def = def_begin(dimension, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *plate = def_box(&def, "plate", XYZ(-1, -0.5, -0.1), XYZ(1, 0, 0.1));
    brunt_body_def *block = def_box(&def, "block", XYZ(-0.15, 0.01, -0.1), XYZ(0.15, 0.21, 0.1));
    for (int b = 0; b < 2; b++) {
        def.bodies[b].method = BRUNT_FEM;
        def.bodies[b].element = dimension == 2 ? BRUNT_QUAD4 : BRUNT_HEX8;
        def.bodies[b].size = 0.05;
    }
    if (graded) {
        plate->grading[0] = owned(4, (points[4]){{-1, 8}, {-0.2, 1}, {0.2, 1}, {1, 8}});
        plate->grading[1] = owned(2, (points[2]){{-0.5, 4}, {-0.1, 1}});
    }
    def_velocity(block, 0, -2, 0);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    brunt_world *world = world_take(&def);
    double deepest = 0;
    brunt_error error = {0};
    while (brunt_world_time(world) < 0.05) {
        ck_assert_msg(brunt_world_step(world, 0.05, &error) == BRUNT_OK, "%s", error.message);
        const double *const plate_y = world_field(world, 1, "position"), *const block_y =
                                                                             world_field(world, 0, "position");
        double top = -INFINITY, bottom = INFINITY; // under the block, of the plate; of the block
        for (int64_t n = 0; n < brunt_body_size(world, 1, BRUNT_AT_NODES); n++)
            if (fabs(plate_y[3 * n]) < 0.12) top = fmax(top, plate_y[3 * n + 1]);
        for (int64_t n = 0; n < brunt_body_size(world, 0, BRUNT_AT_NODES); n++)
            if (fabs(block_y[3 * n]) < 0.12) bottom = fmin(bottom, block_y[3 * n + 1]);
        deepest = fmax(deepest, top - bottom);
        free((void *)plate_y), free((void *)block_y);
    }
    const brunt_momentum m = world_momentum(world);
    const brunt_energy e = world_energy(world);
    const double speed = world_sums(world, 0).velocity[1];
    printf("  %dD %s: %lld elements, deepest %.4f of an edge, leaves at %.4f m/s, drift %.1e %.1e, ledger %.1e\n",
           dimension, graded ? "graded" : "even", (long long)brunt_body_size(world, 1, BRUNT_AT_ELEMENTS),
           deepest / 0.05, speed, m.linear_drift, m.angular_drift, e.error_relative);
    ck_assert_double_le(m.linear_drift, ROUNDING);
    ck_assert_double_le(m.angular_drift, 100 * ROUNDING);
    ck_assert_double_le(fabs(e.error_relative), 1e-2);
    *depth = deepest;
    brunt_world_destroy(world);
    return speed;
}

START_TEST(contact_with_a_graded_mesh) {
    double depth[2];
    const double even = thrown_onto(2 + _i, false, &depth[0]), graded = thrown_onto(2 + _i, true, &depth[1]);
    ck_assert_double_gt(even, 0);
    ck_assert_double_eq_tol(graded, even, 0.05 * 2);
    ck_assert_double_le(depth[1], 0.1 * 0.05);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("mesh_graded");
    TCase *tests = tcase_create("mesh_graded");
    tcase_add_test(tests, without_a_factor_it_is_the_even_mesh);
    tcase_add_test(tests, linear_factors_give_geometric_progressions);
    tcase_add_test(tests, nodes_divide_the_integral_evenly);
    tcase_add_test(tests, all_kinds_keep_sides_and_volume);
    tcase_add_test(tests, what_cannot_be_graded_is_refused);
    tcase_add_loop_test(tests, contact_with_a_graded_mesh, 0, 2);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
