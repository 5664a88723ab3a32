// Meshes of halves, quarters and eighths of round shapes, and of boxes cut by boxes: parts of the whole, with nodes
// exactly on the cuts; and bodies of rings that end on the axis of revolution, of elements and of points.
#include "tests/support/hard_world.h"
#include "tests/support/suite.h"

static brunt_shape box(double x0, double y0, double z0, double x1, double y1, double z1) {
    return (brunt_shape){.kind = BRUNT_BOX, .min = {x0, y0, z0}, .max = {x1, y1, z1}};
}
static brunt_shape half_space(int axis, double at, double normal) {
    brunt_shape shape = {.kind = BRUNT_HALF_SPACE};
    shape.center[axis] = at, shape.axis[axis] = normal;
    return shape;
}
static brunt_shape both(brunt_shape children[], int count) {
    return (brunt_shape){.kind = BRUNT_INTERSECTION, .children = children, .child_count = count};
}

static brunt_mesh make(const brunt_shape *shape, int dimension, brunt_element_kind kind, double size) {
    brunt_mesh mesh;
    brunt_error error = {0};
    ck_assert_msg(!brunt_mesh_shape(shape, dimension, kind, size, &mesh, &error), "%s", error.message);
    return mesh;
}

static brunt_mesh_quality quality(const brunt_mesh *mesh) {
    brunt_mesh_quality q;
    brunt_error error = {0};
    ck_assert_msg(!brunt_mesh_check(mesh, &q, &error), "%s", error.message);
    ck_assert_int_eq(q.duplicate_nodes + q.unreferenced, 0);
    return q;
}

static const brunt_group *group_of(const brunt_mesh *mesh, const char *name) {
    for (int32_t g = 0; g < mesh->group_count; g++)
        if (!strcmp(mesh->groups[g].name, name)) return &mesh->groups[g];
    return NULL;
}

static bool has_node(const brunt_mesh *mesh, const double x[3]) {
    for (int32_t n = 0; n < mesh->node_count; n++)
        if (!memcmp(mesh->nodes[n], x, sizeof mesh->nodes[n])) return true;
    return false;
}

// ------------------------------------------------------------------------------------------ parts of a whole

static const double c[3] = {0.3, -2.7, 11.1}; // a centre that is no short number in any direction
enum { R = 1 };

// Sides: 1 the upper half along an axis, -1 the lower, 0 both. The planes' groups are of exactly the nodes on them, the
// part is the whole's nodes on that side, and its measure is that share of the whole's.
static void check_part(const brunt_shape *shape, int dimension, brunt_element_kind kind, double size,
                       const int side[3]) {
    static const char *const faces[3][2] = {{"xmax", "xmin"}, {"ymax", "ymin"}, {"zmax", "zmin"}};
    brunt_shape room = box(c[0] - 9, c[1] - 9, c[2] - 9, c[0] + 9, c[1] + 9, c[2] + 9), children[2] = {*shape, room};
    double share = 1;
    for (int d = 0; d < dimension; d++) {
        if (side[d] > 0) children[1].min[d] = c[d];
        if (side[d] < 0) children[1].max[d] = c[d];
        if (side[d]) share /= 2;
    }
    brunt_shape part = both(children, 2);
    brunt_mesh whole = make(shape, dimension, kind, size), cut = make(&part, dimension, kind, size);
    const brunt_mesh_quality w = quality(&whole), q = quality(&cut);
    ck_assert_double_eq_tol(q.volume, share * w.volume, 1e-12 * w.volume);
    ck_assert_int_eq(cut.element_count, (int)(share * whole.element_count + 0.5));
    int32_t inside = 0;
    for (int32_t n = 0; n < whole.node_count; n++) {
        bool in = true;
        for (int d = 0; d < dimension; d++) in = in && side[d] * (whole.nodes[n][d] - c[d]) >= 0;
        inside += in;
        if (in) ck_assert_msg(has_node(&cut, whole.nodes[n]), "node %d of the whole is not in the part", n);
    }
    ck_assert_int_eq(cut.node_count, inside);
    for (int d = 0; d < dimension; d++) {
        const brunt_group *face = group_of(&cut, faces[d][side[d] > 0]);
        ck_assert_int_eq(face != NULL, side[d] != 0);
        if (!face) continue;
        int32_t on = 0;
        for (int32_t n = 0; n < cut.node_count; n++) on += cut.nodes[n][d] == c[d]; // to the last bit
        ck_assert_int_gt(on, 1);
        ck_assert_int_eq(face->count, on);
        for (int32_t i = 0; i < face->count; i++) ck_assert(cut.nodes[face->nodes[i]][d] == c[d]);
    }
    brunt_mesh_free(&whole);
    brunt_mesh_free(&cut);
}

// All 26 parts in three dimensions, all 8 in two, of all kinds of elements.
static void check_parts(const brunt_shape *shape, int dimension, int free_axis) {
    for (int code = 0; code < 27; code++) {
        const int side[3] = {code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
        if ((dimension == 2 && side[2]) || (free_axis >= 0 && side[free_axis])) continue;
        for (int k = 0; k < 2; k++)
            check_part(shape, dimension,
                       dimension == 2 ? (k ? BRUNT_TRI3 : BRUNT_QUAD4)
                       : k            ? BRUNT_TET4
                                      : BRUNT_HEX8,
                       0.5, side);
    }
}

START_TEST(halves_quarters_eighths) {
    brunt_shape ball = {.kind = BRUNT_SPHERE, .center = {c[0], c[1], c[2]}, .radius = R};
    check_parts(&ball, 3, -1);
    check_parts(&ball, 2, -1);
    brunt_shape ring = ball;
    ring.kind = BRUNT_TUBE, ring.inner_radius = 0.5;
    check_parts(&ring, 2, -1);
    for (int axis = 0; axis < 3; axis++)
        for (int turned = 0; turned < 2; turned++)
            for (int bored = 0; bored < 2; bored++) {
                brunt_shape rod = bored ? ring : ball;
                if (!bored) rod.kind = BRUNT_CYLINDER;
                rod.length = 1, rod.axis[axis] = turned ? -0.3 : 7;
                check_parts(&rod, 3, axis);
            }
}
END_TEST

// Across its axis a cylinder is cut anywhere, and to the bit.
START_TEST(cylinders_are_cut_across) {
    for (int turned = 0; turned < 2; turned++) {
        brunt_shape rod = {.kind = BRUNT_CYLINDER,
                           .center = {c[0], c[1], c[2]},
                           .axis = {0, turned ? -2 : 2, 0},
                           .radius = R,
                           .length = 3};
        const double low = turned ? c[1] - 2.3 : c[1] + 0.7, high = low + 1.1;
        brunt_shape children[3] = {half_space(1, low, -1), rod, half_space(1, high, 5)}, part = both(children, 3);
        brunt_mesh mesh = make(&part, 3, BRUNT_HEX8, 0.1);
        const brunt_mesh_quality q = quality(&mesh);
        ck_assert_double_eq_tol(q.volume, PI * 1.1, 0.02);
        double least = INFINITY, most = -INFINITY;
        for (int32_t n = 0; n < mesh.node_count; n++)
            least = fmin(least, mesh.nodes[n][1]), most = fmax(most, mesh.nodes[n][1]);
        ck_assert(least == low && most == high);
        ck_assert_int_eq(group_of(&mesh, "ymin")->count, group_of(&mesh, turned ? "end" : "start")->count);
        brunt_mesh_free(&mesh);
    }
}
END_TEST

START_TEST(boxes_of_boxes) {
    brunt_shape children[3] = {box(0, 0, 0, 3, 2, 1), box(1, -5, 0.25, 9, 1.5, 7), half_space(0, 2.5, 1)},
                part = both(children, 3), same = box(1, 0, 0.25, 2.5, 1.5, 1);
    brunt_mesh mesh = make(&part, 3, BRUNT_HEX8, 0.25), other = make(&same, 3, BRUNT_HEX8, 0.25);
    ck_assert_int_eq(mesh.node_count, other.node_count);
    ck_assert_int_eq(memcmp(mesh.nodes, other.nodes, (size_t)mesh.node_count * sizeof *mesh.nodes), 0);
    ck_assert(group_of(&mesh, "xmin") && group_of(&mesh, "zmax"));
    brunt_mesh_free(&mesh);
    brunt_mesh_free(&other);
}
END_TEST

// A cutter that misses the shape, or only touches it, leaves it whole.
START_TEST(what_misses_cuts_nothing) {
    brunt_shape ball = {.kind = BRUNT_SPHERE, .radius = R},
                children[4] = {box(-1, -1, -1, 1, 1, 1), ball, half_space(1, 1, 1), half_space(2, -8, -1)},
                part = both(children, 4);
    brunt_mesh mesh = make(&part, 3, BRUNT_HEX8, 0.3), whole = make(&ball, 3, BRUNT_HEX8, 0.3);
    ck_assert_int_eq(mesh.node_count, whole.node_count);
    ck_assert_int_eq(memcmp(mesh.nodes, whole.nodes, (size_t)mesh.node_count * sizeof *mesh.nodes), 0);
    ck_assert_int_eq(mesh.group_count, whole.group_count);
    brunt_mesh_free(&mesh);
    brunt_mesh_free(&whole);
}
END_TEST

START_TEST(other_intersections_are_refused) {
    const brunt_shape ball = {.kind = BRUNT_SPHERE, .radius = R};
    brunt_shape oblique = {.kind = BRUNT_CYLINDER, .axis = {1, 1, 0}, .radius = 1, .length = 1},
                slant = {.kind = BRUNT_HALF_SPACE, .axis = {1, 1, 0}};
    brunt_shape lists[][2] = {{ball, box(0.1, -2, -2, 2, 2, 2)}, // beside the centre
                              {ball, ball},                      // two round ones
                              {ball, slant},                     // an oblique plane
                              {oblique, half_space(0, 0, 1)},    // an oblique axis
                              {ball, box(1.5, -2, -2, 2, 2, 2)}, // nothing is left
                              {box(0, 0, 0, 1, 1, 1), box(2, 0, 0, 3, 1, 1)},
                              {half_space(0, 0, 1), half_space(1, 0, 1)}, // without bounds
                              {ball, box(0, -2, -2, 0, 2, 2)},
                              {{.kind = BRUNT_UNION}, box(0, 0, 0, 1, 1, 1)}};
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) {
        brunt_shape part = both(lists[k], 2);
        brunt_mesh mesh;
        brunt_error error = {0};
        ck_assert_msg(brunt_mesh_shape(&part, 3, BRUNT_HEX8, 0.3, &mesh, &error) == BRUNT_BAD_INPUT, "%d is meshed",
                      (int)k);
        ck_assert_msg(strstr(error.message, "go through its centre") && !strchr(error.message, '\n'), "%s",
                      error.message);
    }
}
END_TEST

// The skin of half a ball with its cut, and without: a dome with an open edge.
START_TEST(membranes_of_parts) {
    brunt_shape children[2] = {{.kind = BRUNT_SPHERE, .radius = R}, half_space(2, 0, -1)}, part = both(children, 2);
    brunt_mesh mesh;
    brunt_error error = {0};
    ck_assert_msg(!brunt_mesh_surface(&part, BRUNT_MEMBRANE_QUAD4, 0.1, NULL, 0, &mesh, &error), "%s", error.message);
    brunt_mesh_quality q = quality(&mesh);
    ck_assert_double_eq_tol(q.volume, 3 * PI, 0.05); // of sheets: their area
    ck_assert_int_eq(group_of(&mesh, "zmin") != NULL, 1);
    brunt_mesh_free(&mesh);
    const char lid[1][BRUNT_NAME_LENGTH] = {"zmin"};
    ck_assert_msg(!brunt_mesh_surface(&part, BRUNT_MEMBRANE_QUAD4, 0.1, lid, 1, &mesh, &error), "%s", error.message);
    q = quality(&mesh);
    ck_assert_double_eq_tol(q.volume, PI, 0.03);
    ck_assert_int_gt(group_of(&mesh, "border")->count, 8);
    brunt_mesh_free(&mesh);
}
END_TEST

// ------------------------------------------------------------------------------------------ on the axis of revolution

static brunt_world_def rings(bool elements, bool cut, brunt_shape_kind kind) {
    static brunt_shape children[2];
    brunt_world_def def = def_begin(2, 0.02);
    def.axisymmetric = true;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *body = def_body(&def, "ball");
    if (elements) body->method = BRUNT_FEM, body->element = BRUNT_QUAD4, body->size = 0.02;
    brunt_shape round = {.kind = kind, .center = {0, 0.3}, .radius = 0.2, .inner_radius = 0.1};
    children[0] = round, children[1] = box(0, 0, 0, 1, 1, 0);
    body->shape = round;
    if (!cut) return def;
    body->shape = (brunt_shape){.kind = BRUNT_INTERSECTION, .child_count = 2};
    body->shape.children = brunt_def_alloc(2 * sizeof *children);
    memcpy(body->shape.children, children, sizeof children);
    return def;
}

// The section of a ball or a shell is half a disk or a ring; a whole one is half beyond the axis: one rule and one
// text.
START_TEST(one_rule_on_the_axis) {
    for (int k = 0; k < 4; k++) {
        const bool elements = k % 2, shell = k / 2;
        const brunt_shape_kind kind = shell ? BRUNT_TUBE : BRUNT_SPHERE;
        brunt_world_def def = rings(elements, false, kind);
        brunt_error error = {0};
        ck_assert_ptr_null(brunt_world_create(&def, &error));
        ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, "bodies lie at r >= 0, what is on the axis of revolution is cut there"),
                      "%s", error.message);
        brunt_world_def_free(&def);
        def = rings(elements, true, kind);
        brunt_world *world = world_take(&def);
        const double volume = 4 * PI / 3 * (pow(0.2, 3) - (shell ? pow(0.1, 3) : 0)), mass = world_sums(world, 0).mass;
        ck_assert_msg(fabs(mass / (1000 * volume) - 1) < 0.04, "%s: mass %g, of a sphere %g",
                      elements ? "elements" : "points", mass, 1000 * volume);
        world_steps(world, 5);
        brunt_world_destroy(world);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("cut meshes");
    ADD(halves_quarters_eighths);
    ADD(cylinders_are_cut_across);
    ADD(boxes_of_boxes);
    ADD(what_misses_cuts_nothing);
    ADD(other_intersections_are_refused);
    ADD(membranes_of_parts);
    ADD(one_rule_on_the_axis);
    return suite_main(suite);
}
