// Structured meshes of shapes, and looking meshes over; more of sheets is in test_mesh_surface.c.
#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "brunt.h"
#include "base/memory.h"
#include "tests/support/mesh_order.h"
#include "tests/support/suite.h"

static const double pi = 3.14159265358979323846;
enum { SOLID_KINDS = BRUNT_MEMBRANE_QUAD4 }; // those that fill their room; sheets follow in the list

// ---------------------------------------------------------------------------------------------------- shapes

// A shape to be meshed, what its measure is, and how good its cells and what they are cut into must be.
typedef struct meshed {
    const char *name;
    int dimension;
    brunt_shape shape;
    double measure;                // [m^3], 2D [m^2]
    double least_whole, least_cut; // scaled Jacobian of hexahedra or quadrilaterals, of tetrahedra or triangles
    bool is_curved;
} meshed;

static double quad[4][2] = {{0, 0}, {2, 0.25}, {1.75, 1.5}, {0.25, 1}};
static double quad_clockwise[4][2] = {{0.25, 1}, {1.75, 1.5}, {2, 0.25}, {0, 0}};
// Its least corner has the sine 0.8437. Shoelace formula for `quad`: 0 + (2 1.5 - 1.75 .25) + (1.75 1 - .25 1.5) + 0,
// halved.
static const double quad_area = (3 - 0.4375 + 1.75 - 0.375) / 2;

enum { MESHED = 10 };
static void all_meshed(meshed list[MESHED]) {
    brunt_shape box = {.kind = BRUNT_BOX, .min = {-1, 0, 0.5}, .max = {1, 1.5, 1.5}};
    brunt_shape ball = {.kind = BRUNT_SPHERE, .center = {1, 2, 3}, .radius = 1};
    brunt_shape rod = {.kind = BRUNT_CYLINDER, .center = {1, 2, 3}, .axis = {1, -2, 0.5}, .radius = 1, .length = 1.5};
    brunt_shape ring = {
        .kind = BRUNT_TUBE, .center = {1, 2, 3}, .axis = {0, 0, 2}, .radius = 1, .inner_radius = 0.5, .length = 1};
    brunt_shape prism = {.kind = BRUNT_PRISM, .points = quad, .point_count = 4, .min = {0, 0, -1}, .max = {0, 0, 1}};
    brunt_shape other = prism;
    other.points = quad_clockwise;
    list[0] = (meshed){"box", 3, box, 3, 1, 0.5, false};
    list[1] = (meshed){"ball", 3, ball, 4 * pi / 3, 0.68, 0.25, true};
    list[2] = (meshed){"cylinder", 3, rod, 1.5 * pi, 0.75, 0.30, true};
    list[3] = (meshed){"ring", 3, ring, 0.75 * pi, 0.9, 0.28, true};
    list[4] = (meshed){"prism", 3, prism, 2 * quad_area, 0.84, 0.34, false};
    list[5] = (meshed){"box", 2, box, 3, 1, 0.75, false};
    list[6] = (meshed){"disk", 2, ball, pi, 0.75, 0.57, true};
    list[7] = (meshed){"annulus", 2, ring, 0.75 * pi, 0.9, 0.5, true};
    list[8] = (meshed){"quadrilateral", 2, prism, quad_area, 0.84, 0.5, false};
    list[9] = (meshed){"clockwise", 2, other, quad_area, 0.84, 0.5, false};
}

static brunt_mesh make(const brunt_shape *shape, int dimension, brunt_element_kind kind, double size) {
    brunt_mesh mesh;
    brunt_error error = {0};
    ck_assert_msg(!brunt_mesh_shape(shape, dimension, kind, size, &mesh, &error), "%s", error.message);
    return mesh;
}

static brunt_mesh wrap(const brunt_shape *shape, brunt_element_kind kind, double size, const char *face) {
    brunt_mesh mesh;
    brunt_error error = {0};
    char faces[1][BRUNT_NAME_LENGTH] = {""};
    if (face) memcpy(faces[0], face, strlen(face) + 1);
    int status =
        brunt_mesh_surface(shape, kind, size, (const char(*)[BRUNT_NAME_LENGTH])faces, face != NULL, &mesh, &error);
    ck_assert_msg(!status, "%s", error.message);
    return mesh;
}

static brunt_mesh_quality look(const brunt_mesh *mesh) {
    brunt_mesh_quality quality;
    brunt_error error = {0};
    ck_assert_msg(!brunt_mesh_check(mesh, &quality, &error), "%s", error.message);
    return quality;
}

static const brunt_group *group(const brunt_mesh *mesh, const char *name) {
    for (int32_t g = 0; g < mesh->group_count; g++)
        if (!strcmp(mesh->groups[g].name, name)) return &mesh->groups[g];
    return NULL;
}

// ---------------------------------------------------------------------------------------------------- faces

typedef struct face {
    int32_t sorted[4], node[4];
} face;

static int by_nodes(const void *a, const void *b) {
    return memcmp(((const face *)a)->sorted, ((const face *)b)->sorted, 16);
}

// Outward faces of elements in VTK's order; -1 ends a face.
static const int8_t faces_of[SOLID_KINDS][6][4] = {
    [BRUNT_TET4] = {{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}},
    [BRUNT_HEX8] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
    [BRUNT_TRI3] = {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 0, -1, -1}},
    [BRUNT_QUAD4] = {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {3, 0, -1, -1}},
};
static const int face_counts[SOLID_KINDS] = {4, 6, 3, 4};

// All faces of all elements, those with the same nodes one after the other.
static face *sorted_faces(const brunt_mesh *mesh, int32_t *count) {
    int faces = face_counts[mesh->kind], nodes = brunt_element_nodes(mesh->kind);
    face *list = calloc((size_t)mesh->element_count * (size_t)faces, sizeof *list);
    *count = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        for (int f = 0; f < faces; f++) {
            face *made = &list[(*count)++];
            for (int a = 0; a < 4; a++) {
                int8_t corner = faces_of[mesh->kind][f][a];
                int32_t node = corner < 0 ? -1 : mesh->elements[(size_t)e * (size_t)nodes + (size_t)corner];
                made->node[a] = node;
                int at = a;
                for (; at > 0 && made->sorted[at - 1] > node; at--) made->sorted[at] = made->sorted[at - 1];
                made->sorted[at] = node;
            }
        }
    }
    qsort(list, (size_t)*count, sizeof *list, by_nodes);
    return list;
}

// Area vector of a face seen from outside; in two dimensions the edge turned clockwise.
static void area_vector(const brunt_mesh *mesh, const face *f, double *area) {
    const double *x[4];
    for (int a = 0; a < 4; a++)
        x[a] = mesh->nodes[f->node[a] < 0 ? f->node[a - 1] < 0 ? f->node[0] : f->node[a - 1] : f->node[a]];
    if (brunt_element_dimension(mesh->kind) == 2) {
        area[0] = x[1][1] - x[0][1], area[1] = x[0][0] - x[1][0], area[2] = 0;
        return;
    }
    double p[3], q[3]; // the diagonals; a triangle is a quadrilateral with its last corner twice
    for (int d = 0; d < 3; d++) p[d] = x[2][d] - x[0][d], q[d] = x[3][d] - x[1][d];
    for (int d = 0; d < 3; d++) area[d] = (p[(d + 1) % 3] * q[(d + 2) % 3] - p[(d + 2) % 3] * q[(d + 1) % 3]) / 2;
}

// Every face has one element or two; those with one close up, and their nodes are the group "surface".
static void expect_conforming(const brunt_mesh *mesh, const char *name) {
    int32_t count;
    face *list = sorted_faces(mesh, &count);
    const brunt_group *surface = group(mesh, "surface");
    uint8_t *outside = calloc((size_t)mesh->node_count, 1);
    double sum[3] = {0}, size = 0, flux = 0;
    ck_assert_ptr_nonnull(surface);
    for (int32_t i = 0, same; i < count; i += same) {
        for (same = 1; i + same < count && !by_nodes(&list[i], &list[i + same]);) same++;
        ck_assert_msg(same <= 2, "%s: a face of %d elements", name, (int)same);
        double a[3], b[3];
        area_vector(mesh, &list[i], a);
        if (same == 2) { // the two see it from opposite sides: a tangled pair would not
            area_vector(mesh, &list[i + 1], b);
            for (int d = 0; d < 3; d++) ck_assert_double_le(fabs(a[d] + b[d]), 1e-12);
            continue;
        }
        for (int d = 0; d < 3; d++) {
            sum[d] += a[d], size += fabs(a[d]);
            flux += a[d] * (mesh->nodes[list[i].node[0]][d] + mesh->nodes[list[i].node[1]][d]) / 2;
        }
        for (int k = 0; k < 4; k++)
            if (list[i].node[k] >= 0) outside[list[i].node[k]] = 1;
    }
    for (int d = 0; d < 3; d++)
        ck_assert_msg(fabs(sum[d]) <= 1e-12 * size, "%s: the surface does not close, %g", name, sum[d]);
    ck_assert_double_gt(flux, 0); // outwards, not inwards
    int32_t n = 0;
    for (int32_t k = 0; k < mesh->node_count; k++) {
        if (!outside[k]) continue;
        ck_assert_msg(n < surface->count && surface->nodes[n] == k, "%s: node %d is on the surface", name, (int)k);
        n++;
    }
    ck_assert_int_eq(n, surface->count);
    free(outside);
    free(list);
}

START_TEST(shapes_give_conforming_good_meshes) {
    meshed list[MESHED];
    all_meshed(list);
    size_t before = brunt_memory_live();
    for (int i = 0; i < MESHED; i++) {
        for (int k = 0; k < SOLID_KINDS; k++) {
            if (brunt_element_dimension(k) != list[i].dimension || brunt_element_is_membrane(k)) continue;
            bool cut = k == BRUNT_TET4 || k == BRUNT_TRI3;
            double worst = 1;
            const double sizes[] = {3, 0.5, 0.31, 0.2, 0.13};
            for (size_t z = 0; z < sizeof sizes / sizeof *sizes; z++) {
                brunt_mesh mesh = make(&list[i].shape, list[i].dimension, k, sizes[z]);
                brunt_mesh_quality q = look(&mesh);
                ck_assert_int_eq(mesh.kind, k);
                expect_conforming(&mesh, list[i].name);
                ck_assert_int_eq(q.duplicate_nodes, 0);
                ck_assert_int_eq(q.unreferenced, 0);
                if (sizes[z] <= 0.5) { // with longer edges a shape's own proportions decide
                    worst = fmin(worst, q.worst_shape);
                    // sqrt(3): space diagonals of cut cells; the rest is the spread over a ball
                    ck_assert_double_gt(q.shortest_edge, 0.45 * sizes[z]);
                    ck_assert_double_lt(q.longest_edge, (cut ? sqrt(3) : 1) * 1.6 * sizes[z] + 0.15);
                }
                brunt_mesh_free(&mesh);
            }
            printf("%-14s %-6s least scaled Jacobian %.3f\n", list[i].name, brunt_element_name(k), worst);
            ck_assert_double_ge(worst, (cut ? list[i].least_cut : list[i].least_whole) - 1e-9);
        }
    }
    ck_assert_uint_eq(brunt_memory_live(), before);
}
END_TEST

START_TEST(volume_converges) {
    meshed list[MESHED];
    all_meshed(list);
    for (int i = 0; i < MESHED; i++) {
        for (int k = 0; k < SOLID_KINDS; k++) {
            if (brunt_element_dimension(k) != list[i].dimension || brunt_element_is_membrane(k)) continue;
            double error[2];
            if (list[i].shape.kind == BRUNT_TUBE) { // 20 edges of a quarter around at half the width, then 40
                double inner = list[i].shape.inner_radius = 5 / pi - 1;
                list[i].measure = pi * (1 - inner * inner);
            }
            for (int z = 0; z < 2; z++) {
                brunt_mesh mesh = make(&list[i].shape, list[i].dimension, k, z ? 0.125 : 0.25);
                error[z] = 1 - look(&mesh).volume / list[i].measure;
                brunt_mesh_free(&mesh);
            }
            expect_second_order(list[i].name, list[i].is_curved, error, 0.2);
        }
    }
}
END_TEST

// ---------------------------------------------------------------------------------------------------- groups and
// places

// Nodes of the group are those where `of(x)` is 0, ascending.
static void expect_group(const brunt_mesh *mesh, const char *name, double (*of)(const double *x)) {
    const brunt_group *g = group(mesh, name);
    ck_assert_msg(g != NULL, "no group %s", name);
    int32_t count = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        if (fabs(of(mesh->nodes[n])) > 1e-12) continue;
        ck_assert_msg(count < g->count && g->nodes[count] == n, "group %s: node %d", name, (int)n);
        count++;
    }
    ck_assert_int_eq(count, g->count);
    ck_assert_int_gt(count, 0);
}

static double at_xmin(const double *x) { return x[0] + 1; }
static double at_xmax(const double *x) { return x[0] - 1; }
static double at_ymin(const double *x) { return x[1]; }
static double at_ymax(const double *x) { return x[1] - 1.5; }
static double at_zmin(const double *x) { return x[2] - 0.5; }
static double at_zmax(const double *x) { return x[2] - 1.5; }
static double radius_of(const double *x) { return sqrt((x[0] - 1) * (x[0] - 1) + (x[1] - 2) * (x[1] - 2)); }
static double on_outer(const double *x) { return radius_of(x) - 1; }
static double on_inner(const double *x) { return radius_of(x) - 0.5; }
static double on_start(const double *x) { return x[2] - 3; }
static double on_end(const double *x) { return x[2] - 4; }
static double on_ball(const double *x) { return sqrt(radius_of(x) * radius_of(x) + (x[2] - 3) * (x[2] - 3)) - 1; }
static double on_axis_start(const double *x) { return ((x[0] - 1) - 2 * (x[1] - 2) + 0.5 * (x[2] - 3)) / sqrt(5.25); }
static double on_axis_end(const double *x) { return on_axis_start(x) - 1.5; }
static double on_side(const double *x) {
    double along = on_axis_start(x), square = on_ball(x) + 1;
    return sqrt(fmax(0, square * square - along * along)) - 1;
}
static double on_side1(const double *x) { return x[1] - x[0] / 8; }
static double on_side2(const double *x) { return (x[0] - 2) * 1.25 + (x[1] - 0.25) * 0.25; }

START_TEST(groups_are_the_sides) {
    meshed list[MESHED];
    all_meshed(list);
    brunt_mesh mesh = make(&list[0].shape, 3, BRUNT_HEX8, 0.25); // 8 x 6 x 4
    ck_assert_int_eq(mesh.element_count, 8 * 6 * 4);
    ck_assert_int_eq(mesh.node_count, 9 * 7 * 5);
    ck_assert_int_eq(mesh.group_count, 7);
    ck_assert_int_eq(group(&mesh, "xmin")->count, 7 * 5);
    expect_group(&mesh, "xmin", at_xmin), expect_group(&mesh, "xmax", at_xmax);
    expect_group(&mesh, "ymin", at_ymin), expect_group(&mesh, "ymax", at_ymax);
    expect_group(&mesh, "zmin", at_zmin), expect_group(&mesh, "zmax", at_zmax);
    ck_assert_str_eq(mesh.groups[0].name, "xmin");
    brunt_mesh_free(&mesh);

    mesh = make(&list[5].shape, 2, BRUNT_TRI3, 0.25);
    ck_assert_int_eq(mesh.element_count, 2 * 8 * 6);
    ck_assert_int_eq(mesh.group_count, 5);
    expect_group(&mesh, "xmin", at_xmin), expect_group(&mesh, "ymax", at_ymax);
    brunt_mesh_free(&mesh);

    for (int k = BRUNT_TET4; k <= BRUNT_HEX8; k++) {
        mesh = make(&list[1].shape, 3, k, 0.3);
        ck_assert_int_eq(mesh.group_count, 1);
        expect_group(&mesh, "surface", on_ball);
        brunt_mesh_free(&mesh);
        mesh = make(&list[2].shape, 3, k, 0.3);
        ck_assert_int_eq(mesh.group_count, 4);
        expect_group(&mesh, "start", on_axis_start), expect_group(&mesh, "end", on_axis_end),
            expect_group(&mesh, "side", on_side);
        brunt_mesh_free(&mesh);
        mesh = make(&list[3].shape, 3, k, 0.3);
        ck_assert_int_eq(mesh.group_count, 5);
        expect_group(&mesh, "start", on_start), expect_group(&mesh, "end", on_end);
        expect_group(&mesh, "inner", on_inner), expect_group(&mesh, "outer", on_outer);
        brunt_mesh_free(&mesh);
    }
    mesh = make(&list[7].shape, 2, BRUNT_QUAD4, 0.3);
    ck_assert_int_eq(mesh.group_count, 3);
    expect_group(&mesh, "inner", on_inner), expect_group(&mesh, "outer", on_outer);
    brunt_mesh_free(&mesh);
    mesh = make(&list[6].shape, 2, BRUNT_QUAD4, 0.3);
    expect_group(&mesh, "surface", on_outer);
    brunt_mesh_free(&mesh);
    // Sides have the numbers of the corners they begin at, whichever way these run.
    for (int i = 8; i < 10; i++) {
        mesh = make(&list[i].shape, 2, BRUNT_QUAD4, 0.3);
        expect_group(&mesh, i == 8 ? "side1" : "side3", on_side1);
        expect_group(&mesh, "side2", on_side2);
        brunt_mesh_free(&mesh);
    }
}
END_TEST

static int by_place(const void *a, const void *b) {
    const double *p = a, *q = b;
    for (int d = 0; d < 3; d++)
        if (fabs(p[d] - q[d]) > 1e-9) return p[d] < q[d] ? -1 : 1;
    return 0;
}

// Centres of the elements, sorted by place.
static double (*centres(const brunt_mesh *mesh, void (*move)(const double *x, double *out)))[3] {
    int nodes = brunt_element_nodes(mesh->kind);
    double(*list)[3] = calloc((size_t)mesh->element_count, sizeof *list);
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double sum[3] = {0};
        for (int a = 0; a < nodes; a++)
            for (int d = 0; d < 3; d++)
                sum[d] += mesh->nodes[mesh->elements[(size_t)e * (size_t)nodes + (size_t)a]][d] / nodes;
        move(sum, list[e]);
    }
    qsort(list, (size_t)mesh->element_count, sizeof *list, by_place);
    return list;
}
static void stay(const double *x, double *out) { memcpy(out, x, 3 * sizeof *x); }
static void turn(const double *x, double *out) { out[0] = -x[1], out[1] = x[0], out[2] = x[2]; }
static void mirror_x(const double *x, double *out) { out[0] = -x[0], out[1] = x[1], out[2] = x[2]; }
static void mirror_y(const double *x, double *out) { out[0] = x[0], out[1] = -x[1], out[2] = x[2]; }
static void mirror_xy(const double *x, double *out) { out[0] = x[1], out[1] = x[0], out[2] = x[2]; }
static void cycle(const double *x, double *out) { out[0] = x[1], out[1] = x[2], out[2] = x[0]; }

static void expect_symmetric(const brunt_mesh *mesh, const char *name, void (*move)(const double *x, double *out)) {
    double(*as_is)[3] = centres(mesh, stay), (*moved)[3] = centres(mesh, move);
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int d = 0; d < 3; d++)
            ck_assert_msg(fabs(as_is[e][d] - moved[e][d]) < 1e-12, "%s, %s: not symmetric", name,
                          brunt_element_name(mesh->kind));
    free(as_is);
    free(moved);
}

START_TEST(meshes_are_as_symmetric_as_their_shapes) {
    static const struct {
        const char *name;
        int dimension;
        brunt_shape shape;
        bool cube;
    } list[] = {
        {"box", 3, {.kind = BRUNT_BOX, .min = {-1, -1, -1}, .max = {1, 1, 1}}, true},
        {"ball", 3, {.kind = BRUNT_SPHERE, .radius = 1}, true},
        {"cylinder", 3, {.kind = BRUNT_CYLINDER, .axis = {0, 0, 1}, .radius = 1, .length = 1}, false},
        {"ring", 3, {.kind = BRUNT_TUBE, .axis = {0, 0, 1}, .radius = 1, .inner_radius = 0.4, .length = 1}, false},
        {"box", 2, {.kind = BRUNT_BOX, .min = {-1, -1}, .max = {1, 1}}, false},
        {"disk", 2, {.kind = BRUNT_SPHERE, .radius = 1}, false},
        {"annulus", 2, {.kind = BRUNT_TUBE, .radius = 1, .inner_radius = 0.4}, false},
    };
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        for (int k = 0; k < BRUNT_ELEMENT_KINDS; k++) {
            for (double size = 0.5; size > 0.15 && brunt_element_dimension(k) == list[i].dimension; size /= 2) {
                brunt_mesh mesh = brunt_element_is_membrane(k) ? wrap(&list[i].shape, k, size, NULL)
                                                               : make(&list[i].shape, list[i].dimension, k, size);
                expect_symmetric(&mesh, list[i].name, turn);
                expect_symmetric(&mesh, list[i].name, mirror_x);
                expect_symmetric(&mesh, list[i].name, mirror_y);
                expect_symmetric(&mesh, list[i].name, mirror_xy);
                if (list[i].cube) expect_symmetric(&mesh, list[i].name, cycle);
                brunt_mesh_free(&mesh);
            }
        }
    }
}
END_TEST

START_TEST(what_cannot_be_meshed_is_refused) {
    double three[3][2] = {{0, 0}, {1, 0}, {0, 1}}, dart[4][2] = {{0, 0}, {1, 0}, {0.2, 0.2}, {0, 1}},
           twice[4][2] = {{0, 0}, {0, 0}, {1, 1}, {0, 1}};
    double bow[4][2] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    const struct {
        brunt_shape shape;
        int dimension;
        brunt_element_kind kind;
        double size;
        const char *message;
    } list[] = {
        {{.kind = BRUNT_UNION}, 3, BRUNT_HEX8, 1, "not of a union"},
        {{.kind = BRUNT_DIFFERENCE}, 3, BRUNT_HEX8, 1, "not of a difference"},
        {{.kind = BRUNT_INTERSECTION}, 3, BRUNT_HEX8, 1, "not of an intersection"},
        {{.kind = BRUNT_HALF_SPACE, .axis = {0, 0, 1}}, 3, BRUNT_HEX8, 1, "not of a half-space"},
        {{.kind = BRUNT_CYLINDER, .axis = {1, 0, 0}, .radius = 1, .length = 1},
         2,
         BRUNT_QUAD4,
         1,
         "a cylinder in two dimensions"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}},
         2,
         BRUNT_HEX8,
         1,
         "elements of kind hex8 are of 3 dimensions, the shape is of 2"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}},
         3,
         BRUNT_MEMBRANE_TRI3,
         1,
         "elements of kind membrane_tri3 are membranes"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}}, 3, BRUNT_HEX8, 0, "an edge length of 0 m"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}}, 3, BRUNT_HEX8, NAN, "an edge length of nan m"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}}, 3, BRUNT_TET4, 1e-4, "more than 100 million nodes"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}}, 3, BRUNT_TET4, 1e-300, "more than 100 million nodes"},
        {{.kind = BRUNT_SPHERE, .radius = 1}, 3, BRUNT_TET4, 1e-300, "more than 100 million nodes"},
        {{.kind = BRUNT_TUBE, .radius = 1, .inner_radius = 0.5}, 2, BRUNT_QUAD4, 1e-300, "more than 100 million nodes"},
        {{.kind = BRUNT_BOX, .max = {1, 0, 1}}, 3, BRUNT_HEX8, 1, "the extent of a shape to be meshed is 0 m"},
        {{.kind = BRUNT_SPHERE}, 3, BRUNT_HEX8, 1, "the radius of a shape"},
        {{.kind = BRUNT_TUBE, .radius = 1, .inner_radius = 2, .axis = {1}, .length = 1},
         3,
         BRUNT_HEX8,
         1,
         "is not below its radius"},
        {{.kind = BRUNT_CYLINDER, .radius = 1, .length = 1}, 3, BRUNT_HEX8, 1, "has no direction"},
        {{.kind = BRUNT_PRISM, .points = three, .point_count = 3, .max = {0, 0, 1}},
         3,
         BRUNT_HEX8,
         1,
         "4 corners, this one has 3"},
        {{.kind = BRUNT_PRISM, .points = dart, .point_count = 4, .max = {0, 0, 1}},
         3,
         BRUNT_HEX8,
         1,
         "180 degrees or more"},
        {{.kind = BRUNT_PRISM, .points = bow, .point_count = 4}, 2, BRUNT_QUAD4, 1, "180 degrees or more"},
        {{.kind = BRUNT_PRISM, .points = twice, .point_count = 4}, 2, BRUNT_QUAD4, 1, "180 degrees or more"},
        {{.kind = BRUNT_PRISM, .points = quad, .point_count = 4},
         3,
         BRUNT_HEX8,
         1,
         "the height of a shape to be meshed is 0 m"},
    };
    size_t before = brunt_memory_live();
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        brunt_mesh mesh;
        brunt_error error = {0};
        ck_assert_int_eq(brunt_mesh_shape(&list[i].shape, list[i].dimension, list[i].kind, list[i].size, &mesh, &error),
                         BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, list[i].message) != NULL, "'%s' instead of '%s'", error.message,
                      list[i].message);
        ck_assert_int_eq(mesh.node_count + mesh.element_count + mesh.group_count, 0);
    }
    ck_assert_uint_eq(brunt_memory_live(), before);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- looking over

// Regular elements of edge 1 have the scaled Jacobian 1, by definition; their volumes are in every table.
START_TEST(regular_elements_are_ideal) {
    double s = sqrt(3) / 2;
    double tet[][3] = {{0, 0, 0}, {1, 0, 0}, {0.5, s, 0}, {0.5, s / 3, sqrt(2.0 / 3)}};
    double hex[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    int32_t in_order[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    const struct {
        brunt_element_kind kind;
        double (*x)[3];
        double volume;
    } list[] = {
        {BRUNT_TET4, tet, sqrt(2) / 12}, {BRUNT_HEX8, hex, 1}, {BRUNT_TRI3, tet, sqrt(3) / 4}, {BRUNT_QUAD4, hex, 1}};
    for (int i = 0; i < 4; i++) {
        brunt_mesh mesh = {.kind = list[i].kind,
                           .node_count = brunt_element_nodes(list[i].kind),
                           .nodes = list[i].x,
                           .element_count = 1,
                           .elements = in_order};
        brunt_mesh_quality q = look(&mesh);
        ck_assert_double_eq_tol(q.worst_shape, 1, 1e-14);
        ck_assert_double_eq_tol(q.volume, list[i].volume, 1e-15);
        ck_assert_double_eq_tol(q.shortest_edge, 1, 1e-15);
        ck_assert_double_eq_tol(q.longest_edge, 1, 1e-15);
        ck_assert_int_eq(q.worst, 0);
        for (int k = 0; k < 5; k++) ck_assert_int_eq(q.first[k], -1);
    }
    // A hexahedron with one face of twice the edge: frustum of volume (1 + sqrt(4) + 4) / 3.
    for (int a = 4; a < 8; a++) hex[a][0] *= 2, hex[a][1] *= 2;
    brunt_mesh mesh = {.kind = BRUNT_HEX8, .node_count = 8, .nodes = hex, .element_count = 1, .elements = in_order};
    ck_assert_double_eq_tol(look(&mesh).volume, 7.0 / 3, 1e-14);
}
END_TEST

typedef struct damaged {
    brunt_mesh mesh;
    brunt_mesh_quality quality;
    brunt_error error;
    int status;
} damaged;

static void judge(damaged *d) {
    d->error = (brunt_error){0};
    d->status = brunt_mesh_check(&d->mesh, &d->quality, &d->error);
}
static void expect_bad(damaged *d, const char *message) {
    judge(d);
    ck_assert_int_eq(d->status, BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(d->error.message, message) != NULL, "'%s' instead of '%s'", d->error.message, message);
}
static void swap_nodes(brunt_mesh *mesh, int32_t element, int a, int b) {
    int32_t *node = mesh->elements + (size_t)element * (size_t)brunt_element_nodes(mesh->kind), keep = node[a];
    node[a] = node[b];
    node[b] = keep;
}

START_TEST(damage_is_found) {
    brunt_shape box = {.kind = BRUNT_BOX, .max = {1, 1, 1}};
    const int swap[SOLID_KINDS][2] = {{1, 2}, {0, 6}, {1, 2}, {1, 3}};
    for (int k = 0; k < BRUNT_MEMBRANE_QUAD4; k++) {
        int nodes = brunt_element_nodes(k);
        damaged d = {.mesh = make(&box, brunt_element_dimension(k), k, 0.25)};
        judge(&d);
        ck_assert_int_eq(d.status, BRUNT_OK);

        swap_nodes(&d.mesh, 2, swap[k][0], swap[k][1]);
        expect_bad(&d, "element 3 is inside out");
        ck_assert_int_eq(d.quality.inverted, 1);
        ck_assert_int_eq(d.quality.first[0], 2);
        swap_nodes(&d.mesh, 6, swap[k][0], swap[k][1]);
        expect_bad(&d, "elements 3 and 7 are inside out");
        for (int32_t e = 0; e < 15; e++)
            if (e != 2 && e != 6) swap_nodes(&d.mesh, e, swap[k][0], swap[k][1]);
        expect_bad(&d, "elements 1, 2, 3, 4, 5, 6, 7, 8, 9, 10 and 5 more are inside out");
        ck_assert_int_eq(d.quality.inverted, 15);
        for (int32_t e = 0; e < 15; e++) swap_nodes(&d.mesh, e, swap[k][0], swap[k][1]);
        judge(&d);
        ck_assert_int_eq(d.status, BRUNT_OK);

        int32_t keep[8], *third = d.mesh.elements + 2 * nodes, *fifth = d.mesh.elements + 4 * nodes;
        memcpy(keep, third, sizeof keep);
        third[1] = third[0];
        expect_bad(&d, "element 3 is flat, or given with a node twice");
        ck_assert_int_eq(d.quality.degenerate, 1);
        ck_assert_int_eq(d.quality.first[1], 2);
        third[1] = d.mesh.node_count;
        expect_bad(&d, "element 3 is given with node numbers that the mesh does not have");
        third[1] = -1;
        expect_bad(&d, "element 3 is given with node numbers");
        memcpy(third, keep, sizeof keep);

        for (int a = 0; a < nodes; a++) keep[a] = fifth[a], fifth[a] = third[a];
        expect_bad(&d, "element 5 is given twice");
        ck_assert_int_eq(d.quality.duplicate_elements, 1);
        ck_assert_int_eq(d.quality.first[2], 4);
        swap_nodes(&d.mesh, 4, swap[k][0], swap[k][1]); // the same nodes in another order
        expect_bad(&d, "element 5 is inside out (nodes given in the wrong order, or the mesh is tangled); "
                       "element 5 is given twice");
        for (int a = 0; a < nodes; a++) fifth[a] = keep[a];

        double x = d.mesh.nodes[7][0];
        d.mesh.nodes[7][0] = NAN;
        expect_bad(&d, "node 8 is at a place that is not a finite number");
        d.mesh.nodes[7][0] = x;
        if (brunt_element_dimension(k) == 2) {
            d.mesh.nodes[7][2] = 1e-3;
            expect_bad(&d, "node 8 is off the x-y plane");
            d.mesh.nodes[7][2] = 0;
        }
        d.mesh.nodes[7][0] = 1e308, d.mesh.nodes[3][0] = -1e308; // overflows, and is not computed with
        judge(&d);
        ck_assert_int_eq(d.status, BRUNT_BAD_INPUT);
        brunt_mesh_free(&d.mesh);
    }
    damaged none = {.mesh = {.kind = BRUNT_HEX8}};
    expect_bad(&none, "a mesh of 0 nodes and 0 elements");
}
END_TEST

// A flat element that does not repeat a node.
START_TEST(flat_elements_are_degenerate) {
    double x[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 0, 0}};
    int32_t tet[] = {0, 1, 2, 3}, tri[] = {0, 1, 4};
    damaged d = {.mesh = {.kind = BRUNT_TET4, .node_count = 4, .nodes = x, .element_count = 1, .elements = tet}};
    expect_bad(&d, "element 1 is flat");
    d.mesh = (brunt_mesh){.kind = BRUNT_TRI3, .node_count = 5, .nodes = x, .element_count = 1, .elements = tri};
    expect_bad(&d, "element 1 is flat");
    // One so thin that it is nearly flat is not.
    x[3][2] = 1e-6;
    d.mesh = (brunt_mesh){.kind = BRUNT_TET4, .node_count = 4, .nodes = x, .element_count = 1, .elements = tet};
    judge(&d);
    ck_assert_int_eq(d.status, BRUNT_OK);
}
END_TEST

// A corner pushed through the opposite one turns that corner over, though the volume is still positive.
START_TEST(one_corner_turned_over_is_inside_out) {
    double hex[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0.4, 0.4, 0.4}, {0, 1, 1}};
    double flat[][3] = {{0, 0, 0}, {1, 0, 0}, {0.4, 0.4, 0}, {0, 1, 0}};
    int32_t in_order[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    damaged d = {.mesh = {.kind = BRUNT_HEX8, .node_count = 8, .nodes = hex, .element_count = 1, .elements = in_order}};
    expect_bad(&d, "element 1 is inside out");
    ck_assert_double_gt(d.quality.volume, 0);
    d.mesh =
        (brunt_mesh){.kind = BRUNT_QUAD4, .node_count = 4, .nodes = flat, .element_count = 1, .elements = in_order};
    expect_bad(&d, "element 1 is inside out");
    ck_assert_double_gt(d.quality.volume, 0);
}
END_TEST

// Two boxes that touch and are not joined have the nodes of a side twice; nodes 1e-7 of an edge apart are two.
START_TEST(duplicate_and_unreferenced_nodes_are_counted) {
    brunt_shape box = {.kind = BRUNT_BOX, .max = {1, 1, 1}};
    const double shifts[] = {0, 1e-11, -1e-11, 1e-7};
    for (int s = 0; s < 4; s++) {
        brunt_mesh one = make(&box, 3, BRUNT_HEX8, 0.25), both = {.kind = BRUNT_HEX8};
        int32_t n = one.node_count, e = one.element_count;
        both.nodes = brunt_alloc((size_t)(2 * n + 3) * sizeof *both.nodes);
        both.elements = brunt_alloc((size_t)(2 * e) * 8 * sizeof *both.elements);
        for (int32_t i = 0; i < n; i++)
            for (int d = 0; d < 3; d++) {
                const double odd = sqrt(2) / 10 * (d + 1); // on no line of a grid
                both.nodes[i][d] = one.nodes[i][d] + odd;
                both.nodes[n + i][d] = one.nodes[i][d] + odd + (d == 0 ? 1 : 0) + shifts[s];
            }
        for (int32_t i = 0; i < 8 * e; i++)
            both.elements[i] = one.elements[i], both.elements[8 * e + i] = one.elements[i] + n;
        for (int i = 0; i < 3; i++) both.nodes[2 * n + i][0] = 10 + i;
        both.node_count = 2 * n + 3, both.element_count = 2 * e;
        brunt_mesh_quality q = look(&both);
        ck_assert_int_eq(q.duplicate_nodes, s < 3 ? 25 : 0);
        ck_assert_int_eq(q.unreferenced, 3);
        ck_assert_int_eq(q.first[4], 2 * n);
        if (s < 3) ck_assert_int_eq(q.first[3], n);
        brunt_mesh_free(&one);
        brunt_mesh_free(&both);
    }
}
END_TEST

// Far from the origin coordinates have fewer digits; the checks must not see damage in that.
START_TEST(distance_from_the_origin_does_no_harm) {
    brunt_shape ball = {.kind = BRUNT_SPHERE, .center = {1e3, -2e3, 3e3}, .radius = 0.1};
    brunt_mesh mesh = make(&ball, 3, BRUNT_TET4, 0.02);
    brunt_mesh_quality q = look(&mesh);
    ck_assert_double_gt(q.worst_shape, 0.25);
    ck_assert_int_eq(q.duplicate_nodes, 0);
    brunt_mesh_free(&mesh);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("mesh");
    TCase *tests = tcase_create("mesh");
    tcase_add_test(tests, shapes_give_conforming_good_meshes);
    tcase_add_test(tests, volume_converges);
    tcase_add_test(tests, groups_are_the_sides);
    tcase_add_test(tests, meshes_are_as_symmetric_as_their_shapes);
    tcase_add_test(tests, what_cannot_be_meshed_is_refused);
    tcase_add_test(tests, regular_elements_are_ideal);
    tcase_add_test(tests, damage_is_found);
    tcase_add_test(tests, flat_elements_are_degenerate);
    tcase_add_test(tests, one_corner_turned_over_is_inside_out);
    tcase_add_test(tests, duplicate_and_unreferenced_nodes_are_counted);
    tcase_add_test(tests, distance_from_the_origin_does_no_harm);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
