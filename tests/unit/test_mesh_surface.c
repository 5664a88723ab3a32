// Meshes of sheets: surfaces of shapes, and what is looked at in sheets alone.
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
static const brunt_element_kind kinds[] = {BRUNT_MEMBRANE_QUAD4, BRUNT_MEMBRANE_TRI3};

typedef const char (*names)[BRUNT_NAME_LENGTH];

static brunt_mesh surface_of(const brunt_shape *shape, brunt_element_kind kind, double size, names faces, int count) {
    brunt_mesh mesh;
    brunt_error error = {0};
    ck_assert_msg(!brunt_mesh_surface(shape, kind, size, faces, count, &mesh, &error), "%s", error.message);
    ck_assert_int_eq(mesh.kind, kind);
    return mesh;
}
static brunt_mesh face_of(const brunt_shape *shape, brunt_element_kind kind, double size, const char *name) {
    char faces[1][BRUNT_NAME_LENGTH] = {""};
    memcpy(faces[0], name, strlen(name));
    return surface_of(shape, kind, size, (names)faces, 1);
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

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static void cross(const double *a, const double *b, double *c) {
    for (int d = 0; d < 3; d++) c[d] = a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
}

// Corners of an element; a triangle is a quadrilateral with its last corner twice.
static void corners(const brunt_mesh *mesh, int32_t element, const double *x[4]) {
    const int nodes = brunt_element_nodes(mesh->kind);
    for (int a = 0; a < 4; a++)
        x[a] = mesh->nodes[mesh->elements[(size_t)element * (size_t)nodes + (size_t)(a < nodes ? a : nodes - 1)]];
}

static void area_vector(const brunt_mesh *mesh, int32_t element, double *area) {
    const double *x[4];
    double p[3], q[3];
    corners(mesh, element, x);
    for (int d = 0; d < 3; d++) p[d] = (x[2][d] - x[0][d]) / 2, q[d] = x[3][d] - x[1][d];
    cross(p, q, area);
}

// Volume that bilinear patches enclose: x . (dx/dxi cross dx/deta) / 3 is at most quadratic in each coordinate, for
// which two Gauss points a direction are exact.
static double enclosed(const brunt_mesh *mesh) {
    double sum = 0;
    const double g = 0.5 / sqrt(3);
    for (int32_t e = 0; e < mesh->element_count; e++) {
        const double *x[4];
        corners(mesh, e, x);
        for (int p = 0; p < 4; p++) {
            const double s = p % 2 ? 0.5 + g : 0.5 - g, t = p / 2 ? 0.5 + g : 0.5 - g;
            double at[3], along[3], up[3], normal[3];
            for (int d = 0; d < 3; d++) {
                at[d] = (1 - s) * (1 - t) * x[0][d] + s * (1 - t) * x[1][d] + s * t * x[2][d] + (1 - s) * t * x[3][d];
                along[d] = (1 - t) * (x[1][d] - x[0][d]) + t * (x[2][d] - x[3][d]);
                up[d] = (1 - s) * (x[3][d] - x[0][d]) + s * (x[2][d] - x[1][d]);
            }
            cross(along, up, normal);
            sum += dot(at, normal) / 12;
        }
    }
    return sum;
}

typedef struct side {
    int32_t from, to;
} side;
static int by_side(const void *a, const void *b) {
    const side *p = a, *q = b;
    return p->from != q->from ? (p->from > q->from) - (p->from < q->from) : (p->to > q->to) - (p->to < q->to);
}
// All edges, each in the direction its element has it, sorted.
static side *all_sides(const brunt_mesh *mesh, size_t *count) {
    const size_t nodes = (size_t)brunt_element_nodes(mesh->kind);
    *count = (size_t)mesh->element_count * nodes;
    side *list = calloc(*count, sizeof *list);
    for (size_t i = 0; i < *count; i++)
        list[i] = (side){mesh->elements[i], mesh->elements[i / nodes * nodes + (i + 1) % nodes]};
    qsort(list, *count, sizeof *list, by_side);
    return list;
}
static size_t open_sides(const brunt_mesh *mesh) {
    size_t count, open = 0;
    side *list = all_sides(mesh, &count);
    for (size_t i = 0; i < count; i++) {
        side back = {list[i].to, list[i].from};
        ck_assert(i == 0 ||
                  by_side(&list[i - 1], &list[i])); // two with one direction would be turned to opposite sides
        open += !bsearch(&back, list, count, sizeof *list, by_side);
    }
    free(list);
    return open;
}

// ---------------------------------------------------------------------------------------------------- whole surfaces

static double quad[4][2] = {{0, 0}, {2, 0.25}, {1.75, 1.5}, {0.25, 1}};
static double quad_clockwise[4][2] = {{0.25, 1}, {1.75, 1.5}, {2, 0.25}, {0, 0}};
static const double quad_sides = 2.0155644370746373 + 1.2747548783981961 + 1.5811388300841898 + 1.0307764064044151;
static const double quad_area = (3 - 0.4375 + 1.75 - 0.375) / 2; // shoelace formula

static const brunt_shape box = {.kind = BRUNT_BOX, .min = {-1, 0, 0.5}, .max = {1, 1.5, 1.5}};
static const brunt_shape ball = {.kind = BRUNT_SPHERE, .center = {1, 2, 3}, .radius = 1};
static const brunt_shape rod = {
    .kind = BRUNT_CYLINDER, .center = {1, 2, 3}, .axis = {2, -1, 2}, .radius = 1, .length = 1.5};
static const brunt_shape ring = {
    .kind = BRUNT_TUBE, .center = {1, 2, 3}, .axis = {0, 0, -2}, .radius = 1, .inner_radius = 0.5, .length = 1};

enum { SHAPES = 6 };
typedef struct shaped {
    const char *name;
    brunt_shape shape;
    double area; // [m^2]
    bool is_curved;
    int groups;
} shaped;
static void all_shapes(shaped list[SHAPES]) {
    brunt_shape prism = {.kind = BRUNT_PRISM, .points = quad, .point_count = 4, .min = {0, 0, -1}, .max = {0, 0, 1}};
    brunt_shape other = prism;
    other.points = quad_clockwise;
    list[0] = (shaped){"box", box, 2 * (2 * 1.5 + 1.5 * 1 + 1 * 2), false, 7};
    list[1] = (shaped){"ball", ball, 4 * pi, true, 1};
    list[2] = (shaped){"cylinder", rod, 2 * pi + 2 * pi * 1.5, true, 4};
    list[3] = (shaped){"ring", ring, 2 * pi * 0.75 + 2 * pi * 1.5, true, 5};
    list[4] = (shaped){"prism", prism, 2 * quad_area + 2 * quad_sides, false, 7};
    list[5] = (shaped){"clockwise", other, 2 * quad_area + 2 * quad_sides, false, 7};
}

// Closed, every neighbour turned alike, all of its nodes in use, around the volume of the elements it was taken from.
START_TEST(surfaces_are_closed) {
    shaped list[SHAPES];
    all_shapes(list);
    const size_t before = brunt_memory_live();
    for (int i = 0; i < SHAPES; i++)
        for (int k = 0; k < 2; k++)
            for (double size = 3; size > 0.15; size /= 1.7) {
                brunt_mesh mesh = surface_of(&list[i].shape, kinds[k], size, NULL, 0), volume;
                brunt_mesh_quality q = look(&mesh);
                ck_assert_int_eq(q.unreferenced + q.duplicate_nodes, 0);
                ck_assert_msg(open_sides(&mesh) == 0, "%s, %g: open", list[i].name, size);
                ck_assert_int_eq(mesh.group_count, list[i].groups);
                ck_assert_ptr_null(group(&mesh, "border"));
                ck_assert_int_eq(group(&mesh, "surface")->count, mesh.node_count);
                brunt_element_kind solid = k ? BRUNT_TET4 : BRUNT_HEX8;
                ck_assert_int_eq(brunt_mesh_shape(&list[i].shape, 3, solid, size, &volume, NULL), 0);
                double inside = look(&volume).volume;
                ck_assert_msg(fabs(enclosed(&mesh) - inside) <= 1e-12 * inside, "%s, %g: volume %.15g, not %.15g",
                              list[i].name, size, enclosed(&mesh), inside);
                // The same places under the same names, in the same order.
                const brunt_group *outer = group(&volume, "surface");
                ck_assert_int_eq(outer->count, mesh.node_count);
                for (int32_t n = 0; n < mesh.node_count; n++)
                    ck_assert_mem_eq(mesh.nodes[n], volume.nodes[outer->nodes[n]], sizeof *mesh.nodes);
                for (int32_t g = 0; g < mesh.group_count; g++) {
                    const brunt_group *mine = &mesh.groups[g], *theirs = group(&volume, mine->name);
                    ck_assert_int_eq(mine->count, theirs->count);
                    for (int32_t n = 0; n < mine->count; n++)
                        ck_assert_int_eq(outer->nodes[mine->nodes[n]], theirs->nodes[n]);
                }
                brunt_mesh_free(&mesh);
                brunt_mesh_free(&volume);
            }
    ck_assert_uint_eq(brunt_memory_live(), before);
}
END_TEST

START_TEST(area_converges) {
    shaped list[SHAPES];
    all_shapes(list);
    for (int i = 0; i < SHAPES; i++)
        for (int k = 0; k < 2; k++) {
            double error[2];
            if (list[i].shape.kind == BRUNT_TUBE) { // 20 edges of a quarter around at half the width, then 40
                double inner = list[i].shape.inner_radius = 5 / pi - 1;
                list[i].area = 2 * pi * (1 - inner * inner) + 2 * pi * (1 + inner);
            }
            for (int z = 0; z < 2; z++) {
                brunt_mesh mesh = surface_of(&list[i].shape, kinds[k], z ? 0.125 : 0.25, NULL, 0);
                error[z] = 1 - look(&mesh).volume / list[i].area;
                brunt_mesh_free(&mesh);
            }
            expect_second_order(list[i].name, list[i].is_curved, error, 0.25);
        }
}
END_TEST

// ---------------------------------------------------------------------------------------------------- faces

static void expect_normal(const brunt_mesh *mesh, double x, double y, double z) {
    const double want[3] = {x, y, z};
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double area[3];
        area_vector(mesh, e, area);
        ck_assert_double_ge(dot(area, want) / sqrt(dot(area, area)), 1 - 1e-12);
    }
}

// A sheet is 8 x 6 elements; its other groups are the edges it shares with other faces, which together are the border.
START_TEST(one_face_of_a_box) {
    static const struct {
        const char *name;
        double normal[3], area;
        const char *beside[4], *gone;
        int32_t counts[4];
    } list[] = {
        {"zmin", {0, 0, -1}, 3, {"xmin", "xmax", "ymin", "ymax"}, "zmax", {7, 7, 9, 9}},
        {"zmax", {0, 0, 1}, 3, {"xmin", "xmax", "ymin", "ymax"}, "zmin", {7, 7, 9, 9}},
        {"xmin", {-1, 0, 0}, 1.5, {"ymin", "ymax", "zmin", "zmax"}, "xmax", {5, 5, 7, 7}},
        {"ymax", {0, 1, 0}, 2, {"xmin", "xmax", "zmin", "zmax"}, "ymin", {5, 5, 9, 9}},
    };
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        for (int k = 0; k < 2; k++) {
            brunt_mesh mesh = face_of(&box, kinds[k], 0.25, list[i].name);
            ck_assert_double_eq_tol(look(&mesh).volume, list[i].area, 1e-13);
            ck_assert_int_eq(mesh.element_count, (k ? 2 : 1) * (int)lround(list[i].area * 16));
            expect_normal(&mesh, list[i].normal[0], list[i].normal[1], list[i].normal[2]);
            ck_assert_int_eq(mesh.group_count, 7); // four beside, the face itself, surface, border
            ck_assert_ptr_null(group(&mesh, list[i].gone));
            ck_assert_int_eq(group(&mesh, list[i].name)->count, mesh.node_count);
            ck_assert_int_eq(group(&mesh, "surface")->count, mesh.node_count);
            int32_t rim = 0;
            for (int b = 0; b < 4; b++) {
                ck_assert_int_eq(group(&mesh, list[i].beside[b])->count, list[i].counts[b]);
                rim += list[i].counts[b] - 1;
            }
            const brunt_group *border = group(&mesh, "border");
            ck_assert_int_eq(border->count, rim);
            for (int32_t n = 0; n < border->count; n++) {
                int near = 0;
                for (int b = 0; b < 4; b++)
                    for (int32_t m = 0; m < list[i].counts[b]; m++)
                        near += group(&mesh, list[i].beside[b])->nodes[m] == border->nodes[n];
                ck_assert_int_ge(near, 1);
                ck_assert(n == 0 || border->nodes[n] > border->nodes[n - 1]);
            }
            brunt_mesh_free(&mesh);
        }
}
END_TEST

// Two faces that share an edge are one sheet, folded there; two that do not are two in one mesh.
START_TEST(several_faces) {
    static const char folded[3][BRUNT_NAME_LENGTH] = {"zmin", "xmin", "zmin"},
                      apart[2][BRUNT_NAME_LENGTH] = {"ymin", "ymax"};
    for (int k = 0; k < 2; k++) {
        brunt_mesh mesh = surface_of(&box, kinds[k], 0.25, folded, 3);
        ck_assert_double_eq_tol(look(&mesh).volume, 4.5, 1e-13);
        ck_assert_int_eq(mesh.node_count, 9 * 7 + 7 * 5 - 7);
        ck_assert_uint_eq(open_sides(&mesh), 8 + 6 + 8 + 4 + 6 + 4);
        ck_assert_int_eq(group(&mesh, "border")->count, 8 + 6 + 8 + 4 + 6 + 4);
        brunt_mesh_free(&mesh);
        mesh = surface_of(&box, kinds[k], 0.25, apart, 2);
        ck_assert_double_eq_tol(look(&mesh).volume, 4, 1e-13);
        ck_assert_int_eq(group(&mesh, "border")->count, 2 * 24);
        brunt_mesh_free(&mesh);
    }
}
END_TEST

// However coarse the mesh: every face of the surface belongs to one of the named faces and to no other.
START_TEST(faces_make_up_the_surface) {
    static const struct {
        const brunt_shape *shape;
        int count;
        const char *face[6];
    } list[] = {{&box, 6, {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}},
                {&ball, 1, {"surface"}},
                {&rod, 3, {"start", "end", "side"}},
                {&ring, 4, {"start", "end", "inner", "outer"}}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        for (int k = 0; k < 2; k++)
            for (double size = 4; size > 0.2; size /= 1.7) {
                brunt_mesh all = surface_of(list[i].shape, kinds[k], size, NULL, 0);
                double area = 0;
                int32_t elements = 0;
                for (int f = 0; f < list[i].count; f++) {
                    brunt_mesh mesh = face_of(list[i].shape, kinds[k], size, list[i].face[f]);
                    area += look(&mesh).volume;
                    elements += mesh.element_count;
                    brunt_mesh_free(&mesh);
                }
                ck_assert_msg(elements == all.element_count, "shape %zu, %g: %d of %d elements", i, size, (int)elements,
                              (int)all.element_count);
                ck_assert_double_eq_tol(area, look(&all).volume, 1e-12);
                brunt_mesh_free(&all);
            }
}
END_TEST

START_TEST(faces_of_round_shapes) {
    for (int k = 0; k < 2; k++) {
        brunt_mesh mesh = face_of(&rod, kinds[k], 0.2, "start"), disk;
        expect_normal(&mesh, -2 / 3., 1 / 3., -2 / 3.);
        brunt_shape flat = {.kind = BRUNT_SPHERE, .radius = 1};
        ck_assert_int_eq(brunt_mesh_shape(&flat, 2, k ? BRUNT_TRI3 : BRUNT_QUAD4, 0.2, &disk, NULL), 0);
        ck_assert_int_eq(mesh.node_count, disk.node_count);
        ck_assert_double_eq_tol(look(&mesh).volume, look(&disk).volume, 1e-12);
        const brunt_group *border = group(&mesh, "border"), *rim = group(&mesh, "side");
        ck_assert_int_eq(border->count, group(&disk, "surface")->count);
        ck_assert_int_eq(border->count, rim->count);
        ck_assert_mem_eq(border->nodes, rim->nodes, (size_t)rim->count * sizeof *rim->nodes);
        brunt_mesh_free(&mesh);
        brunt_mesh_free(&disk);
        mesh = face_of(&rod, kinds[k], 0.2, "end");
        expect_normal(&mesh, 2 / 3., -1 / 3., 2 / 3.);
        brunt_mesh_free(&mesh);
        // A tube open at both ends, its fronts away from the axis; the inner one of a ring towards it.
        mesh = face_of(&rod, kinds[k], 0.2, "side");
        ck_assert_int_eq(group(&mesh, "border")->count, group(&mesh, "start")->count + group(&mesh, "end")->count);
        brunt_mesh_free(&mesh);
        mesh = face_of(&ring, kinds[k], 0.2, "inner");
        for (int32_t e = 0; e < mesh.element_count; e++) {
            const double *x[4];
            double area[3], out[3] = {0};
            corners(&mesh, e, x);
            area_vector(&mesh, e, area);
            for (int a = 0; a < 4; a++) out[0] += x[a][0] - 1, out[1] += x[a][1] - 2;
            ck_assert_double_lt(dot(area, out), 0);
        }
        brunt_mesh_free(&mesh);
    }
}
END_TEST

// One diagonal for all elements would not have it.
START_TEST(triangles_keep_mirror_symmetry) {
    brunt_mesh mesh = face_of(&box, BRUNT_MEMBRANE_TRI3, 0.25, "zmax");
    for (int axis = 0; axis < 2; axis++)
        for (int32_t e = 0; e < mesh.element_count; e++) {
            int found = 0;
            for (int32_t o = 0; o < mesh.element_count; o++) {
                const double *x[4], *y[4];
                double off = 0;
                corners(&mesh, e, x);
                corners(&mesh, o, y);
                for (int d = 0; d < 2; d++) {
                    const double a = x[0][d] + x[1][d] + x[2][d], b = y[0][d] + y[1][d] + y[2][d];
                    off += fabs(d == axis ? a + b - (d ? 3 * 1.5 : 0) : a - b);
                }
                found += off < 1e-12;
            }
            ck_assert_int_eq(found, 1);
        }
    brunt_mesh_free(&mesh);
}
END_TEST

START_TEST(what_has_no_surface_is_refused) {
    static const char unknown[2][BRUNT_NAME_LENGTH] = {"zmax", "top"};
    static const struct {
        brunt_shape shape;
        brunt_element_kind kind;
        double size;
        int faces;
        const char *message;
    } list[] = {
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}},
         BRUNT_MEMBRANE_QUAD4,
         0.5,
         2,
         "the shape has no face 'top'; there are: xmin, xmax, ymin, ymax, zmin, zmax, surface"},
        {{.kind = BRUNT_SPHERE, .radius = 1}, BRUNT_MEMBRANE_TRI3, 0.5, 1, "no face 'zmax'; there are: surface"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}}, BRUNT_QUAD4, 0.5, 0, "elements of kind quad4 are not membranes"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}}, BRUNT_HEX8, 0.5, 0, "elements of kind hex8 are not membranes"},
        {{.kind = BRUNT_UNION}, BRUNT_MEMBRANE_QUAD4, 0.5, 0, "not of a union"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 0}}, BRUNT_MEMBRANE_QUAD4, 0.5, 0, "the extent of a shape"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}}, BRUNT_MEMBRANE_QUAD4, 0, 0, "an edge length of 0 m"},
        {{.kind = BRUNT_BOX, .max = {1, 1, 1}}, BRUNT_MEMBRANE_TRI3, 1e-4, 0, "more than 100 million nodes"},
    };
    const size_t before = brunt_memory_live();
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        brunt_mesh mesh;
        brunt_error error = {0};
        ck_assert_int_eq(
            brunt_mesh_surface(&list[i].shape, list[i].kind, list[i].size, unknown, list[i].faces, &mesh, &error),
            BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, list[i].message) != NULL, "'%s' instead of '%s'", error.message,
                      list[i].message);
        ck_assert_int_eq(mesh.node_count + mesh.element_count + mesh.group_count, 0);
    }
    ck_assert_uint_eq(brunt_memory_live(), before);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- looking over

static void expect_bad(const brunt_mesh *mesh, const char *message) {
    brunt_mesh_quality quality;
    brunt_error error = {0};
    ck_assert_int_eq(brunt_mesh_check(mesh, &quality, &error), BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, message) != NULL, "'%s' instead of '%s'", error.message, message);
}
static void turn(brunt_mesh *mesh, int32_t element) {
    const size_t nodes = (size_t)brunt_element_nodes(mesh->kind), second = (size_t)element * nodes + 1;
    const int32_t keep = mesh->elements[second];
    mesh->elements[second] = mesh->elements[second + nodes - 2];
    mesh->elements[second + nodes - 2] = keep;
}

// Where a sheet is and how it lies in space changes nothing.
START_TEST(regular_membranes_are_ideal) {
    int32_t in_order[4] = {0, 1, 2, 3};
    const double a[3] = {2 / 3., -1 / 3., 2 / 3.}, b[3] = {1 / 3., -2 / 3., -2 / 3.}; // unit, at right angles
    for (int k = 0; k < 2; k++)
        for (int far = 0; far < 2; far++) {
            double x[4][3];
            for (int d = 0; d < 3; d++) {
                const double o = far * (100. * d - 70);
                x[0][d] = o, x[1][d] = o + 2 * a[d];
                x[2][d] = k ? o + a[d] + sqrt(3) * b[d] : o + 2 * a[d] + 2 * b[d];
                x[3][d] = o + 2 * b[d];
            }
            brunt_mesh mesh = {
                .kind = kinds[k], .node_count = 4 - k, .nodes = x, .element_count = 1, .elements = in_order};
            brunt_mesh_quality q = look(&mesh);
            ck_assert_double_eq_tol(q.worst_shape, 1, 1e-12);
            ck_assert_double_eq_tol(q.volume, k ? sqrt(3) : 4, 1e-12);
            ck_assert_double_eq_tol(q.shortest_edge, 2, 1e-12);
            ck_assert_double_eq_tol(q.longest_edge, 2, 1e-12);
            turn(&mesh, 0); // a sheet has no inside that it could be turned out of
            ck_assert_double_eq_tol(look(&mesh).volume, k ? sqrt(3) : 4, 1e-12);
        }
    // Warped: the area is that seen along the normal, edges are as long as they are.
    double x[4][3] = {{0, 0, 0.5}, {1, 0, -0.5}, {1, 1, 0.5}, {0, 1, -0.5}};
    brunt_mesh mesh = {
        .kind = BRUNT_MEMBRANE_QUAD4, .node_count = 4, .nodes = x, .element_count = 1, .elements = in_order};
    brunt_mesh_quality q = look(&mesh);
    ck_assert_double_eq_tol(q.volume, 1, 1e-14);
    ck_assert_double_eq_tol(q.worst_shape, 1, 1e-14);
    ck_assert_double_eq_tol(q.longest_edge, sqrt(2), 1e-14);
    ck_assert_double_eq_tol(q.shortest_edge, sqrt(2), 1e-14);
}
END_TEST

START_TEST(damaged_elements_are_found) {
    int32_t in_order[4] = {0, 1, 2, 3};
    double line[4][3] = {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}, {3, 3, 1}},
           fold[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0.1}, {1, 0, 0.2}};
    double bow[4][3] = {{0, 0, 0}, {0, 1, 1}, {0, 1, 0}, {0, 0, 1.5}},
           dart[4][3] = {{0, 0, 0}, {0, 1, 0}, {0, 0.3, 0.3}, {0, 0, 1}};
    brunt_mesh mesh = {.node_count = 4, .element_count = 1, .elements = in_order};
    for (int k = 0; k < 2; k++) {
        mesh.kind = kinds[k], mesh.nodes = line;
        expect_bad(&mesh, "element 1 is flat, or given with a node twice");
        mesh.nodes = bow;
        in_order[1] = 0;
        expect_bad(&mesh, "element 1 is flat, or given with a node twice");
        in_order[1] = 1;
    }
    mesh.kind = BRUNT_MEMBRANE_QUAD4, mesh.nodes = bow;
    expect_bad(&mesh, "element 1 is inside out");
    mesh.nodes = dart;
    expect_bad(&mesh, "element 1 is inside out");
    mesh.nodes = fold; // diagonals in one plane with the edges, crossing: turned back upon itself
    expect_bad(&mesh, "element 1 is");
    int32_t twice[8] = {0, 1, 2, 3, 2, 3, 0, 1};
    mesh.nodes = (double[4][3]){{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}, mesh.elements = twice,
    mesh.element_count = 2;
    expect_bad(&mesh, "element 2 is given twice");
    mesh.nodes = fold, mesh.elements = in_order, mesh.element_count = 1;
    fold[2][1] = NAN;
    expect_bad(&mesh, "node 3 is at a place that is not a finite number");
    fold[2][1] = 1e308, fold[0][1] = -1e308;
    expect_bad(&mesh, "nodes 1 and 3 are too far from the origin");
}
END_TEST

START_TEST(neighbours_are_turned_alike) {
    for (int k = 0; k < 2; k++) {
        brunt_mesh mesh = face_of(&box, kinds[k], 0.25, "zmin");
        const int32_t inner = mesh.element_count / 2 + 3;
        look(&mesh);
        turn(&mesh, inner);
        char message[128];
        snprintf(message, sizeof message, ", as are %d more pairs: neighbours in a membrane", k ? 2 : 3);
        expect_bad(&mesh, message);
        snprintf(message, sizeof message, "%d", (int)inner + 1);
        expect_bad(&mesh, message);
        for (int32_t e = 0; e < mesh.element_count; e++)
            if (e != inner) turn(&mesh, e); // all of it
        look(&mesh);
        brunt_mesh_free(&mesh);
    }
    // Two squares with one edge in common, the second the wrong way round.
    double x[6][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 1}, {2, 1, 1}};
    int32_t pair[8] = {0, 1, 2, 3, 1, 2, 5, 4};
    brunt_mesh mesh = {.kind = BRUNT_MEMBRANE_QUAD4, .node_count = 6, .nodes = x, .element_count = 2, .elements = pair};
    expect_bad(&mesh, "elements 1 and 2 are turned to opposite sides: neighbours");
    turn(&mesh, 1);
    look(&mesh);
}
END_TEST

// Three sheets that meet in a seam have no common front; sheets that share a node alone are no neighbours.
START_TEST(seams_join_membranes_of_any_side) {
    double x[8][3] = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, 1, 0}, {0, 0, 1}, {0, 1, 1}};
    int32_t seam[12] = {0, 2, 3, 1, 0, 4, 5, 1, 0, 6, 7, 1};
    brunt_mesh mesh = {.kind = BRUNT_MEMBRANE_QUAD4, .node_count = 8, .nodes = x, .element_count = 3, .elements = seam};
    look(&mesh);
    for (int32_t e = 0; e < 3; e++) {
        turn(&mesh, e);
        look(&mesh);
    }
    double y[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    int32_t tip[6] = {0, 1, 2, 0, 3, 4};
    mesh = (brunt_mesh){.kind = BRUNT_MEMBRANE_TRI3, .node_count = 5, .nodes = y, .element_count = 2, .elements = tip};
    look(&mesh);
    turn(&mesh, 1);
    look(&mesh);
}
END_TEST

// A strip that is closed with half a turn has no front.
START_TEST(one_sided_strips_are_refused) {
    enum { STRIP = 12 };
    for (int twisted = 0; twisted < 2; twisted++) {
        double x[2 * STRIP][3];
        int32_t elements[4 * STRIP];
        for (int i = 0; i < STRIP; i++)
            for (int edge = 0; edge < 2; edge++) {
                const double angle = 2 * pi * i / STRIP, half = twisted * angle / 2, w = edge ? 0.1 : -0.1;
                x[2 * i + edge][0] = (1 + w * cos(half)) * cos(angle);
                x[2 * i + edge][1] = (1 + w * cos(half)) * sin(angle);
                x[2 * i + edge][2] = w * sin(half);
                const bool last = i + 1 == STRIP;
                int32_t *e = elements + 4 * i;
                e[0] = 2 * i, e[1] = last ? twisted : 2 * i + 2, e[2] = last ? 1 - twisted : 2 * i + 3,
                e[3] = 2 * i + 1;
            }
        brunt_mesh mesh = {.kind = BRUNT_MEMBRANE_QUAD4,
                           .node_count = 2 * STRIP,
                           .nodes = x,
                           .element_count = STRIP,
                           .elements = elements};
        if (twisted)
            expect_bad(&mesh, "elements 1 and 12 are turned to opposite sides: neighbours");
        else
            ck_assert_double_eq_tol(look(&mesh).worst_shape, cos(pi / STRIP), 1e-12);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("mesh_surface");
    TCase *tests = tcase_create("mesh_surface");
    tcase_add_test(tests, surfaces_are_closed);
    tcase_add_test(tests, area_converges);
    tcase_add_test(tests, one_face_of_a_box);
    tcase_add_test(tests, several_faces);
    tcase_add_test(tests, faces_make_up_the_surface);
    tcase_add_test(tests, faces_of_round_shapes);
    tcase_add_test(tests, triangles_keep_mirror_symmetry);
    tcase_add_test(tests, what_has_no_surface_is_refused);
    tcase_add_test(tests, regular_membranes_are_ideal);
    tcase_add_test(tests, damaged_elements_are_found);
    tcase_add_test(tests, neighbours_are_turned_alike);
    tcase_add_test(tests, seams_join_membranes_of_any_side);
    tcase_add_test(tests, one_sided_strips_are_refused);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
