// Meshes of gmsh: files it wrote itself, files written here in all formats, and files that are broken.
#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "brunt.h"
#include "io/mesh/gmsh.h"
#include "tests/support/gmsh_writer.h"
#include "base/memory.h"
#include "tests/support/suite.h"

static char path[64];
static size_t live;

static void begin(void) {
    snprintf(path, sizeof path, "/tmp/brunt_gmsh_%d.msh", (int)getpid());
    live = brunt_memory_live();
}
static void end(void) {
    unlink(path);
    ck_assert_uint_eq(brunt_memory_live(), live);
}

static const char *source(const char *name) {
    static char full[512];
    const char *folder = getenv("BRUNT_SOURCE");
    snprintf(full, sizeof full, "%s/tests/meshes/%s", folder ? folder : ".", name);
    return full;
}

static brunt_mesh read_from(const char *file, const char *group, int dimension, char *warnings) {
    brunt_mesh mesh;
    brunt_error error = {0};
    FILE *stream = warnings ? fmemopen(warnings, 1024, "w") : NULL;
    ck_assert_msg(!brunt_gmsh_read(file, group, dimension, &mesh, stream, &error), "%s", error.message);
    if (stream) fclose(stream);
    return mesh;
}

static brunt_mesh read_membrane(const char *file, const char *group, char *warnings) {
    brunt_mesh mesh;
    brunt_error error = {0};
    FILE *stream = warnings ? fmemopen(warnings, 1024, "w") : NULL;
    ck_assert_msg(!brunt_gmsh_read_membrane(file, group, &mesh, stream, &error), "%s", error.message);
    if (stream) fclose(stream);
    return mesh;
}

static void expect_refused(const char *file, const char *group, int dimension, int code, const char *message) {
    brunt_mesh mesh;
    brunt_error error = {0};
    int status = brunt_gmsh_read(file, group, dimension, &mesh, NULL, &error);
    ck_assert_msg(status == code && strstr(error.message, message), "code %d, '%s' instead of '%s'", status,
                  error.message, message);
    ck_assert_msg(strstr(error.message, file) == error.message, "'%s' does not name the file", error.message);
    ck_assert_int_eq(mesh.node_count + mesh.element_count + mesh.group_count, 0);
}

static const brunt_group *group_of(const brunt_mesh *mesh, const char *name) {
    for (int32_t g = 0; g < mesh->group_count; g++)
        if (!strcmp(mesh->groups[g].name, name)) return &mesh->groups[g];
    ck_abort_msg("no group %s", name);
    return NULL;
}

static void expect_same(const brunt_mesh *a, const brunt_mesh *b) {
    size_t nodes = (size_t)brunt_element_nodes(a->kind);
    ck_assert_int_eq(a->kind, b->kind);
    ck_assert_int_eq(a->node_count, b->node_count);
    ck_assert_int_eq(a->element_count, b->element_count);
    ck_assert_mem_eq(a->nodes, b->nodes, (size_t)a->node_count * sizeof *a->nodes);
    ck_assert_mem_eq(a->elements, b->elements, (size_t)a->element_count * nodes * sizeof *a->elements);
}

static brunt_mesh_quality checked(const brunt_mesh *mesh) {
    brunt_mesh_quality quality;
    brunt_error error = {0};
    ck_assert_msg(!brunt_mesh_check(mesh, &quality, &error), "%s", error.message);
    return quality;
}

// ---------------------------------------------------------------------------------------------------- files of gmsh
// itself

static const char *const bricks[] = {"brick_22_text.msh", "brick_22_binary.msh", "brick_41_text.msh",
                                     "brick_41_binary.msh"};

START_TEST(bricks_of_gmsh) {
    brunt_mesh first = read_from(source(bricks[0]), "brick", 3, NULL);
    for (int f = 0; f < 4; f++) {
        brunt_mesh mesh = read_from(source(bricks[f]), f % 2 ? "brick" : "", 3, NULL);
        expect_same(&mesh, &first);
        ck_assert_int_eq(mesh.kind, BRUNT_HEX8);
        ck_assert_int_eq(mesh.element_count, 6);
        ck_assert_int_eq(mesh.node_count, 24);
        brunt_mesh_quality q = checked(&mesh);
        ck_assert_double_eq_tol(q.volume, 6, 1e-9);
        ck_assert_double_eq_tol(q.worst_shape, 1, 1e-9);
        ck_assert_int_eq(mesh.group_count, 2);
        for (int g = 0; g < 2; g++) {
            const brunt_group *group = group_of(&mesh, g ? "zmax" : "zmin");
            ck_assert_int_eq(group->count, 12);
            for (int i = 0; i < 12; i++) ck_assert_double_eq(mesh.nodes[group->nodes[i]][2], g);
            for (int i = 1; i < 12; i++) ck_assert_int_lt(group->nodes[i - 1], group->nodes[i]);
        }
        brunt_mesh_free(&mesh);
    }
    brunt_mesh_free(&first);
}
END_TEST

// Facets of a surface, whatever its elements are.
START_TEST(facets_of_gmsh) {
    brunt_gmsh_facets facets;
    brunt_error error = {0};
    for (int f = 0; f < 6; f++) {
        const char *name = f < 4 ? bricks[f] : f == 4 ? "disk_41_text.msh" : "disk_41_binary.msh";
        ck_assert_int_eq(brunt_gmsh_read_facets(source(name), f < 4 ? "zmax" : "", &facets, &error), BRUNT_OK);
        ck_assert_int_eq(facets.count, f < 4 ? 6 : 37);
        ck_assert_int_eq(facets.point_count, f < 4 ? 12 : 27);
        double area = 0;
        for (int32_t e = 0; e < facets.count; e++)
            for (int k = 0; k < 2; k++) { // its triangles
                const int32_t *c = facets.corners[e];
                ck_assert_int_eq(c[3] >= 0, f < 4);
                if (c[1 + k] < 0 || c[2 + k] < 0) continue;
                const double *o = facets.points[c[0]], *p = facets.points[c[1 + k]], *q = facets.points[c[2 + k]];
                area += 0.5 * ((p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]));
                ck_assert_double_eq(p[2], f < 4);
            }
        ck_assert_double_eq_tol(fabs(area), f < 4 ? 6 : 0.778823, 1e-6);
        brunt_free(facets.points), brunt_free(facets.corners);
    }
    ck_assert_int_eq(brunt_gmsh_read_facets(source(bricks[0]), "zmid", &facets, &error), BRUNT_BAD_INPUT);
    ck_assert_ptr_nonnull(strstr(error.message, "did you mean 'zmin'?"));
    ck_assert_ptr_null(facets.points);
}
END_TEST

START_TEST(disks_of_gmsh) {
    for (int f = 0; f < 2; f++) {
        brunt_mesh mesh = read_from(source(f ? "disk_41_binary.msh" : "disk_41_text.msh"), "disk", 2, NULL);
        ck_assert_int_eq(mesh.kind, BRUNT_TRI3);
        double area = checked(&mesh).volume, quarter = 3.14159265358979 / 4;
        ck_assert_double_lt(area, quarter);
        ck_assert_double_gt(area, 0.98 * quarter); // 7 chords: 1 - sin(x) / x with x = pi / 14 is 0.8 %
        ck_assert_int_eq(mesh.group_count, 3);
        const brunt_group *bottom = group_of(&mesh, "bottom"), *rim = group_of(&mesh, "rim");
        for (int32_t i = 0; i < bottom->count; i++) ck_assert_double_eq(mesh.nodes[bottom->nodes[i]][1], 0);
        for (int32_t i = 0; i < rim->count; i++)
            ck_assert_double_eq_tol(hypot(mesh.nodes[rim->nodes[i]][0], mesh.nodes[rim->nodes[i]][1]), 1, 1e-12);
        ck_assert_int_eq(bottom->count, 5);
        ck_assert_int_eq(rim->count, 8);
        brunt_mesh_free(&mesh);
    }
}
END_TEST

// ---------------------------------------------------------------------------------------------------- all formats

static const int types[BRUNT_ELEMENT_KINDS] = {4, 5, 2, 3, 3, 2};

// A mesh of a shape as gmsh would have it, with its groups as points (type 15).
static gmsh_model model_of(const brunt_mesh *mesh, const int64_t *tags) {
    gmsh_model m = {.node_count = mesh->node_count, .x = mesh->nodes, .tags = tags, .part_count = 1, .name_count = 1};
    m.part[0] = (gmsh_part){types[mesh->kind],
                            brunt_element_nodes(mesh->kind),
                            brunt_element_is_membrane(mesh->kind) ? 2 : brunt_element_dimension(mesh->kind),
                            7,
                            mesh->element_count,
                            mesh->elements};
    m.name[0].dimension = m.part[0].dimension, m.name[0].tag = 7, m.name[0].name = "body";
    for (int32_t g = 0; g < mesh->group_count; g++) {
        m.part[m.part_count++] = (gmsh_part){15, 1, 0, g + 1, mesh->groups[g].count, mesh->groups[g].nodes};
        m.name[m.name_count].dimension = 0, m.name[m.name_count].tag = g + 1,
        m.name[m.name_count++].name = mesh->groups[g].name;
    }
    return m;
}

START_TEST(every_kind_in_every_format) {
    brunt_shape ring = {.kind = BRUNT_TUBE, .axis = {0, 0, 1}, .radius = 1, .inner_radius = 0.5, .length = 1};
    for (int k = 0; k < BRUNT_ELEMENT_KINDS; k++) {
        brunt_mesh mesh;
        const bool sheet = brunt_element_is_membrane(k);
        ck_assert_int_eq(sheet ? brunt_mesh_surface(&ring, k, 0.4, NULL, 0, &mesh, NULL)
                               : brunt_mesh_shape(&ring, brunt_element_dimension(k), k, 0.4, &mesh, NULL),
                         0);
        // Bytes of numbers that would be blanks in text.
        for (int n = 0; n < mesh.node_count; n++)
            for (int d = 0; d < 2; d++) *(char *)&mesh.nodes[n][d] = " \t\r\n"[n % 4];
        int64_t *tags = calloc((size_t)mesh.node_count, sizeof *tags);
        for (int numbering = 0; numbering < 3; numbering++) {
            for (int format = 0; format < 4; format++) {
                // in order; backwards with gaps; far apart, beyond 32 bits where the format can
                int64_t far = format < 2 ? 1000003 : 10000000019;
                for (int n = 0; n < mesh.node_count; n++)
                    tags[n] = numbering == 1 ? 5 + 3 * (mesh.node_count - n) : 17 + far * ((n * 7) % mesh.node_count);
                gmsh_model m = model_of(&mesh, numbering ? tags : NULL);
                gmsh_write(path, &m, format < 2 ? 2 : 4, format % 2);
                brunt_mesh back = sheet ? read_membrane(path, "body", NULL)
                                        : read_from(path, "body", brunt_element_dimension(k), NULL);
                expect_same(&back, &mesh);
                ck_assert_int_eq(back.group_count, mesh.group_count + sheet); // a sheet is one of its groups
                for (int32_t g = 0; g < mesh.group_count; g++) {
                    const brunt_group *group = group_of(&back, mesh.groups[g].name);
                    ck_assert_int_eq(group->count, mesh.groups[g].count);
                    ck_assert_mem_eq(group->nodes, mesh.groups[g].nodes, (size_t)group->count * sizeof *group->nodes);
                }
                brunt_mesh_free(&back);
            }
        }
        free(tags);
        brunt_mesh_free(&mesh);
    }
}
END_TEST

// A body whose every element is inside out is turned over as a whole, whatever it is made of.
START_TEST(bodies_inside_out_are_turned_over) {
    static const struct {
        brunt_element_kind kind;
        int swap[2][2];
    } cases[] = {{BRUNT_TRI3, {{1, 2}, {0, 0}}},
                 {BRUNT_QUAD4, {{1, 3}, {0, 0}}},
                 {BRUNT_TET4, {{1, 2}, {0, 0}}},
                 {BRUNT_HEX8, {{1, 3}, {5, 7}}}};
    const brunt_shape box = {.kind = BRUNT_BOX, .max = {1, 0.5, 0.7}};
    const int dimension = brunt_element_dimension(cases[_i].kind), nodes = brunt_element_nodes(cases[_i].kind);
    brunt_mesh right, wrong;
    ck_assert_int_eq(brunt_mesh_shape(&box, dimension, cases[_i].kind, 0.25, &right, NULL), 0);
    ck_assert_int_eq(brunt_mesh_shape(&box, dimension, cases[_i].kind, 0.25, &wrong, NULL), 0);
    for (int32_t e = 0; e < wrong.element_count; e++)
        for (int k = 0; k < 2; k++) {
            int32_t *p = &wrong.elements[e * nodes + cases[_i].swap[k][0]],
                    *q = &wrong.elements[e * nodes + cases[_i].swap[k][1]], keep = *p;
            *p = *q, *q = keep;
        }
    gmsh_model m = model_of(&wrong, NULL);
    gmsh_write(path, &m, 4, 1);
    brunt_mesh back = read_from(path, "body", dimension, NULL);
    expect_same(&back, &right);
    brunt_mesh_free(&back), brunt_mesh_free(&right), brunt_mesh_free(&wrong);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- which elements

static double square[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}, {9, 9, 0}, {8, 8, 0}};
static const int32_t left[] = {0, 1, 2, 3}, right[] = {1, 4, 5, 2}, bottom[] = {0, 1, 1, 4}, corner[] = {0},
                     halves[] = {0, 1, 2, 0, 2, 3};
static const int32_t clockwise[] = {0, 3, 2, 1, 1, 2, 5, 4}, outside[] = {6, 7};

// Two squares side by side, the line below both.
static gmsh_model two_squares(void) {
    gmsh_model m = {.node_count = 8, .x = square, .part_count = 4, .name_count = 4};
    m.part[0] = (gmsh_part){3, 4, 2, 1, 1, left};
    m.part[1] = (gmsh_part){3, 4, 2, 2, 1, right};
    m.part[2] = (gmsh_part){1, 2, 1, 3, 2, bottom};
    m.part[3] = (gmsh_part){15, 1, 0, 4, 1, corner};
    const char *names[] = {"left", "right", "bottom", "corner"};
    for (int i = 0; i < 4; i++)
        m.name[i].dimension = i < 2 ? 2 : 3 - i, m.name[i].tag = i + 1, m.name[i].name = names[i];
    return m;
}

START_TEST(bodies_are_physical_groups) {
    for (int format = 0; format < 4; format++) {
        int version = format < 2 ? 2 : 4;
        bool binary = format % 2;
        char warnings[1024] = "";
        gmsh_model m = two_squares();
        gmsh_write(path, &m, version, binary);
        brunt_mesh mesh = read_from(path, "right", 2, warnings);
        ck_assert_int_eq(mesh.element_count, 1);
        ck_assert_int_eq(mesh.node_count, 4); // 1, 2, 4, 5, in the order of the file
        const int32_t element[4] = {0, 2, 3, 1};
        ck_assert_mem_eq(mesh.elements, element, sizeof element);
        ck_assert_double_eq(mesh.nodes[0][0], 1);
        ck_assert_int_eq(mesh.group_count, 1); // the corner does not touch it
        ck_assert_str_eq(mesh.groups[0].name, "bottom");
        ck_assert_int_eq(mesh.groups[0].count, 2);
        ck_assert_int_eq(mesh.groups[0].nodes[1], 2);
        ck_assert_msg(strstr(warnings, "2 of its nodes belong to no element of dimension 2 and are left out"), "'%s'",
                      warnings);
        brunt_mesh_free(&mesh);

        expect_refused(
            path, "", 2, BRUNT_BAD_INPUT,
            "which physical group is the body? There are: 'left' (2D, 1 elements), 'right' (2D, 1 elements)");
        expect_refused(path, "rigth", 2, BRUNT_BAD_INPUT,
                       "no physical group 'rigth' of dimension 2, did you mean 'right'? There are: 'left' (2D, 1 "
                       "elements), 'right' (2D, "
                       "1 elements), 'bottom' (1D, 2 elements), 'corner' (0D, 1 elements)");
        expect_refused(path, "bottom", 2, BRUNT_BAD_INPUT,
                       "no physical group 'bottom' of dimension 2; there are: 'left'");
        expect_refused(path, "left", 3, BRUNT_BAD_INPUT, "no physical group 'left' of dimension 3");
        expect_refused(path, "", 3, BRUNT_BAD_INPUT, "has no elements of dimension 3");

        m.part[1].physical = 0; // one group is left: all is the body
        m.name_count = 1;
        gmsh_write(path, &m, version, binary);
        mesh = read_from(path, NULL, 2, NULL);
        ck_assert_int_eq(mesh.element_count, 2);
        ck_assert_int_eq(mesh.group_count, 2);
        ck_assert_int_eq(group_of(&mesh, "3")->count, 3); // without a name: its number
        brunt_mesh_free(&mesh);
        mesh = read_from(path, "left", 2, NULL);
        ck_assert_int_eq(mesh.element_count, 1);
        brunt_mesh_free(&mesh);

        m = two_squares();
        m.part[0].elements = clockwise, m.part[0].count = 2, m.part[1].count = 0;
        gmsh_write(path, &m, version, binary);
        mesh = read_from(path, "left", 2, warnings);
        ck_assert_msg(strstr(warnings, "all 2 elements were inside out and have been turned over"), "'%s'", warnings);
        ck_assert_double_eq(checked(&mesh).volume, 2);
        brunt_mesh_free(&mesh);

        m.part[1].count = 1, m.part[1].physical = 1, m.part[0].count = 1; // one of two: the check says so
        gmsh_write(path, &m, version, binary);
        mesh = read_from(path, "left", 2, NULL);
        brunt_mesh_quality quality;
        ck_assert_int_eq(brunt_mesh_check(&mesh, &quality, NULL), BRUNT_BAD_INPUT);
        ck_assert_int_eq(quality.inverted, 1);
        ck_assert_int_eq(quality.first[0], 0);
        brunt_mesh_free(&mesh);

        m.part[1] = (gmsh_part){2, 3, 2, 1, 2, halves};
        gmsh_write(path, &m, version, binary);
        expect_refused(path, "left", 2, BRUNT_BAD_INPUT,
                       "physical group 'left' has 2 3-node triangles and 1 4-node quadrangles");
        m.part_count = 1, m.part[0] = (gmsh_part){9, 6, 2, 1, 1, halves};
        gmsh_write(path, &m, version, binary);
        expect_refused(path, "left", 2, BRUNT_BAD_INPUT,
                       "physical group 'left' has 1 6-node triangles: a body has elements of one kind");
        expect_refused(path, "right", 2, BRUNT_BAD_INPUT, "physical group 'right' has no elements");
        m.part[0] = (gmsh_part){4, 4, 3, 0, 1, left};
        gmsh_write(path, &m, version, binary);
        expect_refused(path, "", 2, BRUNT_BAD_INPUT,
                       "has elements of dimension 3 (4-node tetrahedra), the scene is of dimension 2");

        m = two_squares();
        square[2][2] = 1e-3;
        gmsh_write(path, &m, version, binary);
        square[2][2] = 1e-12; // rounding
        expect_refused(path, "left", 2, BRUNT_BAD_INPUT, "a node at (1, 1, 0.001)");
        gmsh_write(path, &m, version, binary);
        square[2][2] = 0;
        mesh = read_from(path, "left", 2, NULL);
        ck_assert_double_eq(mesh.nodes[2][2], 0);
        brunt_mesh_free(&mesh);
    }
}
END_TEST

// A tent: two squares that meet at a ridge, the second clockwise; a solid stands below it, a line along the ridge.
START_TEST(membranes_are_surfaces_in_space) {
    double x[][3] = {{0, 0, 0}, {1, 0, 1}, {1, 1, 1}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}, {1, 0.5, 0}};
    const int32_t ridge[] = {1, 2}, tet[] = {0, 4, 3, 6}, backwards[] = {1, 2, 5, 4};
    for (int format = 0; format < 4; format++) {
        int version = format < 2 ? 2 : 4;
        bool binary = format % 2;
        char warnings[1024] = "";
        gmsh_model m = {.node_count = 6, .x = x, .part_count = 3, .name_count = 3};
        m.part[0] = (gmsh_part){3, 4, 2, 1, 1, left};
        m.part[1] = (gmsh_part){3, 4, 2, 2, 1, right};
        m.part[2] = (gmsh_part){1, 2, 1, 3, 1, ridge};
        const char *names[] = {"west", "east", "ridge"};
        for (int i = 0; i < 3; i++)
            m.name[i].dimension = i < 2 ? 2 : 1, m.name[i].tag = i + 1, m.name[i].name = names[i];
        gmsh_write(path, &m, version, binary);
        brunt_mesh mesh = read_membrane(path, "east", warnings);
        ck_assert_str_eq(warnings, "");
        ck_assert_int_eq(mesh.kind, BRUNT_MEMBRANE_QUAD4);
        ck_assert_int_eq(mesh.node_count, 4);
        ck_assert_double_eq(mesh.nodes[0][2], 1);
        ck_assert_double_eq_tol(checked(&mesh).volume, sqrt(2), 1e-14);
        ck_assert_int_eq(mesh.group_count, 4);
        ck_assert_int_eq(group_of(&mesh, "east")->count, 4);
        ck_assert_int_eq(group_of(&mesh, "west")->count, 2); // where it touches
        ck_assert_int_eq(group_of(&mesh, "ridge")->count, 2);
        ck_assert_int_eq(group_of(&mesh, "surface")->count, 4);
        brunt_mesh_free(&mesh);

        m.part[0].elements = clockwise; // seen from below: that is its front then
        gmsh_write(path, &m, version, binary);
        mesh = read_membrane(path, "west", warnings);
        ck_assert_str_eq(warnings, "");
        ck_assert_mem_eq(mesh.elements, clockwise, 4 * sizeof *clockwise);
        brunt_mesh_free(&mesh);
        m.part[0].elements = left;

        m.name[1].name = "west", m.part[1].elements = backwards; // two groups of one name; turned as in the file
        gmsh_write(path, &m, version, binary);
        mesh = read_membrane(path, "west", NULL);
        ck_assert_int_eq(mesh.element_count, 2);
        ck_assert_mem_eq(mesh.elements + 4, backwards, sizeof backwards);
        brunt_mesh_quality quality;
        brunt_error error = {0};
        ck_assert_int_eq(brunt_mesh_check(&mesh, &quality, &error), BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, "elements 1 and 2 are turned to opposite sides") != NULL, "'%s'",
                      error.message);
        brunt_mesh_free(&mesh);

        m.part[1] = (gmsh_part){4, 4, 3, 0, 1, tet}; // beside a solid the sheet must be named
        m.node_count = 7, m.name_count = 1;
        gmsh_write(path, &m, version, binary);
        ck_assert_int_eq(brunt_gmsh_read_membrane(path, "", &mesh, NULL, &error), BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, "which physical group of dimension 2 is the sheet?") != NULL, "'%s'",
                      error.message);
        mesh = read_membrane(path, "west", warnings);
        ck_assert_int_eq(mesh.element_count, 1);
        ck_assert_msg(strstr(warnings, "1 of its nodes belong to no element") != NULL, "'%s'", warnings); // the sixth
        brunt_mesh_free(&mesh);
        ck_assert_int_eq(brunt_gmsh_read_membrane(path, "east", &mesh, NULL, &error), BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, "no physical group 'east' of dimension 2") != NULL, "'%s'", error.message);
    }
    char text[2048] = "";
    FILE *out = fmemopen(text, sizeof text, "w");
    gmsh_model m = {.node_count = 6, .x = x, .part_count = 1};
    m.part[0] = (gmsh_part){3, 4, 2, 0, 1, left};
    gmsh_write(path, &m, 4, false);
    ck_assert_int_eq(brunt_gmsh_describe(path, out, NULL), BRUNT_OK);
    fclose(out);
    ck_assert_msg(strstr(text, "1 membrane_quad4 elements, area 1.41421 m^2") != NULL, "%s", text);
}
END_TEST

START_TEST(groups_that_cannot_be_are_said) {
    char warnings[1024] = "";
    gmsh_model m = two_squares();
    m.name[2].name = "a name of more than forty-seven bytes is more than can be";
    gmsh_write(path, &m, 4, false);
    brunt_mesh mesh = read_from(path, "left", 2, warnings);
    ck_assert_int_eq(mesh.group_count, 1);
    ck_assert_msg(strstr(warnings, "is left out: its name is longer than 47 bytes"), "'%s'", warnings);
    brunt_mesh_free(&mesh);

    m.name[2].name = "corner"; // the line and the point
    gmsh_write(path, &m, 4, false);
    mesh = read_from(path, "left", 2, warnings);
    ck_assert_int_eq(mesh.group_count, 1);
    ck_assert_int_eq(mesh.groups[0].count, 2);
    ck_assert_msg(strstr(warnings, "'corner' of dimension 0 is left out: there is one of a higher dimension"), "'%s'",
                  warnings);
    brunt_mesh_free(&mesh);

    m.name[1].name = "left"; // two groups of one name are one body
    m.part[3] = (gmsh_part){1, 2, 1, 5, 1, outside};
    gmsh_write(path, &m, 4, false);
    mesh = read_from(path, "left", 2, NULL);
    ck_assert_int_eq(mesh.element_count, 2);
    brunt_mesh_free(&mesh);
}
END_TEST

START_TEST(description) {
    char text[4096] = "";
    FILE *out = fmemopen(text, sizeof text, "w");
    ck_assert_int_eq(brunt_gmsh_describe(source("brick_41_binary.msh"), out, NULL), 0);
    fclose(out);
    const char *const lines[] = {"mesh of gmsh, format 4.1, binary",
                                 "nodes      24",
                                 "elements   6 8-node hexahedra",
                                 "(0, 0, 0) to (3, 2, 1) m",
                                 "group      'zmax', dimension 2, 6 elements",
                                 "body 'brick'  24 nodes, 6 hex8 elements, volume 6 m^3",
                                 "edges 1 to 1 m, worst shape 1"};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        ck_assert_msg(strstr(text, lines[i]), "no '%s' in\n%s", lines[i], text);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- broken files

#define FORMAT_2 "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define FORMAT_4 "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
#define NODES_2 "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n"
#define NODES_4 "$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n"
#define TRIANGLE_2 "$Elements\n1\n1 2 2 0 1 1 2 3\n$EndElements\n"
#define TRIANGLE_4 "$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n"

static const struct {
    const char *text, *message;
} broken[] = {
    {"", ":1: not a mesh of gmsh"},
    {"solid cube\n", ":1: not a mesh of gmsh"},
    {"$MeshFormat", ":1: the file ends in $MeshFormat"},
    {"$MeshFormat\n", ":2: the file ends where the version of its format is wanted"},
    {"$MeshFormat\n4.0 0 8\n$EndMeshFormat\n", ":2: format 4.0: 4.1 and 2.2 are read"},
    {"$MeshFormat\n2.2 2 8\n$EndMeshFormat\n", ":2: file type 2"},
    {"$MeshFormat\n4.1 0 4\n$EndMeshFormat\n", ":2: numbers of 4 bytes"},
    {"$MeshFormat\n4.1 0\n$EndMeshFormat\n", ":2: the line ends where the size of numbers is wanted"},
    {"$MeshFormat\n4.1 0 8 9\n$EndMeshFormat\n", ":2: '9' where $EndMeshFormat is wanted"},
    {"$Nodes\n0\n$EndNodes\n", ":1: $Nodes before $MeshFormat"},
    {FORMAT_2 "Nodes\n", ":4: 'Nodes' where a section"},
    {FORMAT_2 "$EndNodes\n", ":4: '$EndNodes' where a section"},
    {FORMAT_2 NODES_2, ":10: the file ends without $Elements"},
    {FORMAT_2, ":4: the file ends without $Nodes"},
    {FORMAT_2 NODES_2 NODES_2, ":10: a second $Nodes"},
    {FORMAT_2 TRIANGLE_2 NODES_2, "$Elements before $Nodes"},
    {FORMAT_2 "$Entities\n0 0 0 0\n$EndEntities\n", ":4: $Entities in a file of format 2.2"},
    {FORMAT_2 "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n", ":5: the number of nodes is 6, but only 35 bytes"},
    {FORMAT_2 "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n" TRIANGLE_2,
     ":9: '$EndNodes' is not the number of a node"},
    {FORMAT_2 "$Nodes\n2\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n", ":8: '3' where $EndNodes is wanted"},
    {FORMAT_2 "$Nodes\n1\n1 0 0\n$EndNodes\n", ":6: the line ends where a coordinate of a node is wanted"},
    {FORMAT_2 "$Nodes\n1\n1 0 0 0 0\n$EndNodes\n", ":6: '0' at the end of a line of $Nodes"},
    {FORMAT_2 "$Nodes\n1\n1 0 nan 0\n$EndNodes\n", ":6: 'nan' is not a coordinate of a node"},
    {FORMAT_2 "$Nodes\n1\n1 0 1e999 0\n$EndNodes\n", ":6: '1e999' is not a coordinate of a node"},
    {FORMAT_2 "$Nodes\n1\n1 0 1,5 0\n$EndNodes\n", ":6: '1,5' is not a coordinate of a node"},
    {FORMAT_2 "$Nodes\n1\n1.5 0 0 0\n$EndNodes\n", ":6: '1.5' is not the number of a node"},
    {FORMAT_2 "$Nodes\n-1\n$EndNodes\n", ":5: the number of nodes is -1"},
    {FORMAT_2 "$Nodes\n4000000000\n1 0 0 0\n$EndNodes\n",
     ":5: the number of nodes is 4000000000, but only 19 bytes of the file follow"},
    {FORMAT_2 "$Nodes\n99999999999999999999\n$EndNodes\n", ":5: '99999999999999999999' is not the number of nodes"},
    {FORMAT_2 "$Nodes\n1\n0 0 0 0\n$EndNodes\n", ":6: a node has number 0"},
    {FORMAT_2 "$Nodes\n1\n-7 0 0 0\n$EndNodes\n", ":6: a node has number -7"},
    {FORMAT_2 "$Nodes\n2\n7 0 0 0\n7 1 0 0\n$EndNodes\n", "node 7 is given twice"},
    {FORMAT_2 "$Nodes\n2\n7 0 0 0\n7 1 0 0", "node 7 is given twice"},
    {FORMAT_2 "$Nodes\n3\n1 0 0 0\n900000000000 1 0 0\n900000000000 1 0 0\n$EndNodes\n",
     "node 900000000000 is given twice"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 2 2 0 1 1 2 4\n$EndElements\n",
     ":12: an element of node 4, which $Nodes does not have"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 2 2 0 1 1 2 0\n$EndElements\n", ":12: an element of node 0"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 2 2 0 1 1 2 -9223372036854775807\n$EndElements\n",
     ":12: an element of node -9223372036854775807"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 2 2 0 1 1 2\n$EndElements\n",
     ":12: the line ends where the number of a node is wanted"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 2 2 0 1 1 2 3 1\n$EndElements\n", ":12: '1' at the end of a line of $Elements"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 99 2 0 1 1 2 3\n$EndElements\n", ":12: elements of type 99, which is not known"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 -2 2 0 1 1 2 3\n$EndElements\n", ":12: elements of type -2"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 2 -2 0 1 1 2 3\n$EndElements\n", ":12: the number of tags of an element is -2"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 2 999999 0 1 1 2 3\n$EndElements\n",
     ":12: the number of tags of an element is 999999, but only"},
    {FORMAT_2 NODES_2 "$Elements\n2\n1 2 2 0 1 1 2 3\n$EndElements\n",
     ":13: '$EndElements' is not the number of an element"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 2 2 9999999999 1 1 2 3\n$EndElements\n",
     ":12: '9999999999' is not a tag of an element"},
    {FORMAT_2 NODES_2 "$Elements\n1\n1 2 2 0 1 1 2 3\n$EndElement\n",
     ":13: '$EndElement' where $EndElements is wanted"},
    {FORMAT_2 NODES_2 TRIANGLE_2 "$NodeData\n1\n", ":14: $NodeData is not closed"},
    {FORMAT_2 "$PhysicalNames\n1\n2 1 body\n$EndPhysicalNames\n", ":6: the name of physical group 1 is not in quotes"},
    {FORMAT_2 "$PhysicalNames\n1\n5 1 \"body\"\n$EndPhysicalNames\n", ":6: a physical group of dimension 5"},
    {FORMAT_2 "$PhysicalNames\n2\n2 1 \"body\"\n2 1 \"other\"\n$EndPhysicalNames\n",
     ":7: physical group 1 of dimension 2 has two names"},
    {FORMAT_4 "$PartitionedEntities\n1\n$EndPartitionedEntities\n", ":4: the mesh is cut into partitions"},
    {FORMAT_4 "$Entities\n3 0 0 0\n1 0 0 0\n$EndEntities\n", ":5: the number of points is 3, but only 28 bytes"},
    {FORMAT_4 "$Entities\n1 0 0 0\n1 0 0 0\n$EndEntities\n", ":7: '$EndEntities' is not the number of physical groups"},
    {FORMAT_4 "$Entities\n1 0 0 0\n1 0 0 x 0\n$EndEntities\n", ":6: 'x' is not a coordinate of an entity"},
    {FORMAT_4 "$Entities\n1 0 0 0\n1 0 0 0 99\n$EndEntities\n",
     ":6: the number of physical groups of an entity is 99, but only"},
    {FORMAT_4 "$Nodes\n1 3 1 3\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n$EndNodes\n",
     ":6: more nodes than the 3"},
    {FORMAT_4 "$Nodes\n1 3 1 3\n2 1 0 2\n1\n2\n0 0 0\n1 0 0\n$EndNodes\n", "2 nodes instead of the 3"},
    {FORMAT_4 "$Nodes\n1 3 1 3\n2 1 2 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n",
     ":6: a block of nodes of dimension 2, parametric 2"},
    {FORMAT_4 "$Nodes\n1 3 1 3\n2 1 1 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n",
     ":10: the line ends where a parameter of a node is wanted"},
    {FORMAT_4 "$Nodes\n1 3 1 3\n2 1 0 3\n1 2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n",
     ":7: '2' at the end of a line of $Nodes"},
    {FORMAT_4 NODES_4 "$Elements\n1 1 1 1\n3 1 2 1\n1 1 2 3\n$EndElements\n",
     ":16: a block of 3-node triangles of dimension 3"},
    {FORMAT_4 NODES_4 "$Elements\n1 1 1 1\n2 1 2 2\n1 1 2 3\n1 1 2 3\n$EndElements\n", ":16: more elements than the 1"},
    {FORMAT_4 NODES_4 "$Elements\n1 2 1 2\n2 1 2 1\n1 1 2 3\n$EndElements\n", "1 elements instead of the 2"},
    {FORMAT_4 NODES_4 "$Elements\n2 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n",
     ":18: '$EndElements' is not the dimension of an entity"},
    {FORMAT_4 NODES_4 "$Elements\n1 8 1 1\n2 1 25 8\n1 1 2 3\n$EndElements\n                ",
     ":16: 8 21-node triangles, but only"},
    {FORMAT_4 NODES_4 "$Elements\n1 1 1 1\n2 1 0 1\n1 1 2 3\n$EndElements\n", ":16: elements of type 0"},
};

static void put_file(const void *bytes, size_t size) {
    unlink(path); // some file systems flush a file that is overwritten, which takes longer than all else here
    FILE *out = fopen(path, "wb");
    ck_assert_ptr_nonnull(out);
    ck_assert_uint_eq(fwrite(bytes, 1, size, out), size);
    fclose(out);
}

START_TEST(broken_files_are_refused) {
    const char *const sound[] = {FORMAT_2 NODES_2 TRIANGLE_2, FORMAT_4 NODES_4 TRIANGLE_4,
                                 "$Comments\nhello\n$EndComments\r\n" FORMAT_4 NODES_4 TRIANGLE_4
                                 "$Periodic\n0\n$EndPeriodic"};
    for (int i = 0; i < 3; i++) { // what is broken below is sound before
        put_file(sound[i], strlen(sound[i]));
        brunt_mesh mesh = read_from(path, "", 2, NULL);
        ck_assert_double_eq(checked(&mesh).volume, 0.5);
        brunt_mesh_free(&mesh);
    }
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        put_file(broken[i].text, strlen(broken[i].text));
        expect_refused(path, "", 2, BRUNT_BAD_INPUT, broken[i].message);
    }
    static const char zero[] = FORMAT_2 "$Nodes\n1\n1 0 \0 0\n$EndNodes\n";
    put_file(zero, sizeof zero - 1);
    expect_refused(path, "", 2, BRUNT_BAD_INPUT, ":6: '");
}
END_TEST

// Text with the line ends of another system.
START_TEST(carriage_returns_are_blanks) {
    const char text[] = FORMAT_4 NODES_4 TRIANGLE_4;
    char crlf[sizeof text * 2];
    size_t size = 0;
    for (const char *p = text; *p; p++) {
        if (*p == '\n') crlf[size++] = '\r';
        crlf[size++] = *p;
    }
    put_file(crlf, size);
    brunt_mesh mesh = read_from(path, "", 2, NULL);
    ck_assert_int_eq(mesh.element_count, 1);
    brunt_mesh_free(&mesh);
}
END_TEST

static char *get_file(const char *name, size_t *size) {
    FILE *in = fopen(name, "rb");
    ck_assert_msg(in != NULL, "%s", name);
    fseek(in, 0, SEEK_END);
    *size = (size_t)ftell(in);
    rewind(in);
    char *bytes = malloc(*size + 1);
    ck_assert_uint_eq(fread(bytes, 1, *size, in), *size);
    fclose(in);
    return bytes;
}

// Overwrites bytes of a binary file written here, and says what must come of it.
START_TEST(broken_binary_files_are_refused) {
    const struct {
        int version;
        const char *after;
        long skip;
        int64_t value;
        int bytes;
        const char *message;
    } list[] = {
        {2, "2.2 1 8\n", 0, 0x01000000, 4, "byte 20: written with the other byte order"},
        {4, "4.1 1 8\n", 0, 0x01000000, 4, "byte 20: written with the other byte order"},
        {4, "4.1 1 8\n", 0, 7, 4, "byte 20: the mark of the byte order is 7"},
        {4, "$Nodes\n", 8, INT64_MAX, 8, "the number of nodes is 9223372036854775807, but only"},
        {4, "$Nodes\n", 8, -1, 8, "the number of nodes is -1"},
        {4, "$Nodes\n", 8, 9, 8, "8 nodes instead of the 9"},
        {4, "$Nodes\n", 8, 7, 8, "more nodes than the 7"},
        {4, "$Nodes\n", 32, 9, 4, "a block of nodes of dimension 9"},
        {4, "$Nodes\n", 44, 1000000, 8, "the number of nodes of a block is 1000000, but only"},
        {4, "$Nodes\n", 52, -5, 8, "a node has number -5"},
        {4, "$Nodes\n", 52, 2, 8, "node 2 is given twice"},
        {4, "$Nodes\n", 84, 0x7ff8000000000000, 8, "a coordinate of a node is not a finite number"},
        {4, "$Nodes\n", 84, 0x7ff0000000000000, 8, "a coordinate of a node is not a finite number"},
        {4, "$Elements\n", 0, 99, 8, "an element of node"}, /* reads on into the end mark or past it */
        {4, "$Elements\n", 40, 77, 4, "elements of type 77"},
        {4, "$Elements\n", 44, 50, 8, "the number of elements of a block is 50, but only"},
        {4, "$Elements\n", 60, 44, 8, "an element of node 44, which $Nodes does not have"},
        {4, "$Entities\n", 0, 1 << 30, 8, "the number of points is 1073741824, but only"},
        {2, "$Elements\n5\n", 0, 77, 4, "elements of type 77"},
        {2, "$Elements\n5\n", 4, 1 << 20, 4, "the number of elements that follow is 1048576, but only"},
        {2, "$Elements\n5\n", 4, 0, 4, "a block of 0 elements"},
        {2, "$Elements\n5\n", 4, 6, 4, "a block of 6 elements, where 5 are left"},
        {2, "$Elements\n5\n", 8, -1, 4, "the number of tags of elements is -1"},
        {2, "$Elements\n5\n", 24, 99, 4, "an element of node 99"},
        {2, "$Nodes\n8\n", 4, 0x7ff8000000000000, 8, "byte 53: a coordinate of a node is not a finite number"},
    };
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        gmsh_model m = two_squares();
        m.name_count = list[i].version == 2 ? 0 : m.name_count;
        size_t size;
        gmsh_write(path, &m, list[i].version, true);
        char *bytes = get_file(path, &size), *at = memmem(bytes, size, list[i].after, strlen(list[i].after));
        ck_assert_ptr_nonnull(at);
        int32_t narrow = (int32_t)list[i].value;
        memcpy(at + strlen(list[i].after) + list[i].skip, list[i].bytes == 4 ? (void *)&narrow : (void *)&list[i].value,
               (size_t)list[i].bytes);
        put_file(bytes, size);
        if (list[i].value == 99 && list[i].bytes == 8) {
            brunt_mesh mesh;
            ck_assert_int_eq(brunt_gmsh_read(path, "left", 2, &mesh, NULL, NULL), BRUNT_BAD_INPUT);
        } else {
            expect_refused(path, "left", 2, BRUNT_BAD_INPUT, list[i].message);
        }
        free(bytes);
    }
}
END_TEST

static const char *const whole[] = {"brick_22_text.msh",   "brick_22_binary.msh", "brick_41_text.msh",
                                    "brick_41_binary.msh", "disk_41_text.msh",    "disk_41_binary.msh"};

// Any file cut short is an error, but for blanks that are missing at the end, or periodic data behind the mesh.
START_TEST(truncated_files_are_refused) {
    for (size_t f = 0; f < sizeof whole / sizeof *whole; f++) {
        size_t size;
        char *bytes = get_file(source(whole[f]), &size);
        char *done = memmem(bytes, size, "$EndElements", 12);
        size_t least = (size_t)(done - bytes) + 12;
        for (size_t cut = 0; cut <= size; cut++) {
            brunt_mesh mesh;
            brunt_error error = {0};
            put_file(bytes, cut);
            int status = brunt_gmsh_read(path, "", f < 4 ? 3 : 2, &mesh, NULL, &error);
            ck_assert_msg(status == (cut < least ? BRUNT_BAD_INPUT : BRUNT_OK), "%s cut to %zu bytes: %d %s", whole[f],
                          cut, status, error.message);
            brunt_mesh_free(&mesh);
        }
        free(bytes);
    }
}
END_TEST

// Bytes changed at random: an error or a mesh that can be looked over, never a crash or a leak.
START_TEST(damaged_files_do_no_harm) {
    uint64_t seed = 1;
    for (size_t f = 0; f < sizeof whole / sizeof *whole; f++) {
        size_t size;
        char *bytes = get_file(source(whole[f]), &size), *copy = malloc(size);
        for (int trial = 0; trial < 1500; trial++) {
            memcpy(copy, bytes, size);
            for (int hit = 0; hit <= trial % 4; hit++) {
                seed = seed * 6364136223846793005u + 1442695040888963407u;
                char byte = (char)(seed >> 20), letter = "0123456789-. \n$\"e"[(seed >> 20) % 17];
                copy[(seed >> 33) % size] = trial % 2 ? byte : letter;
            }
            brunt_mesh mesh;
            brunt_mesh_quality quality;
            put_file(copy, size);
            int status = brunt_gmsh_read(path, "", f < 4 ? 3 : 2, &mesh, NULL, NULL);
            ck_assert(status == BRUNT_OK || status == BRUNT_BAD_INPUT);
            if (!status) brunt_mesh_check(&mesh, &quality, NULL);
            brunt_mesh_free(&mesh);
        }
        free(bytes);
        free(copy);
    }
}
END_TEST

START_TEST(unreadable_files_are_io_errors) {
    expect_refused("/tmp/brunt_no_such_file.msh", "", 3, BRUNT_IO_ERROR, "cannot open the file: No such file");
    expect_refused("/tmp", "", 3, BRUNT_IO_ERROR, "not a file");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("gmsh");
    TCase *tests = tcase_create("gmsh");
    tcase_add_checked_fixture(tests, begin, end);
    tcase_add_test(tests, bricks_of_gmsh);
    tcase_add_test(tests, disks_of_gmsh);
    tcase_add_test(tests, facets_of_gmsh);
    tcase_add_test(tests, every_kind_in_every_format);
    tcase_add_loop_test(tests, bodies_inside_out_are_turned_over, 0, 4);
    tcase_add_test(tests, bodies_are_physical_groups);
    tcase_add_test(tests, membranes_are_surfaces_in_space);
    tcase_add_test(tests, groups_that_cannot_be_are_said);
    tcase_add_test(tests, description);
    tcase_add_test(tests, broken_files_are_refused);
    tcase_add_test(tests, carriage_returns_are_blanks);
    tcase_add_test(tests, broken_binary_files_are_refused);
    tcase_add_test(tests, truncated_files_are_refused);
    tcase_add_test(tests, damaged_files_do_no_harm);
    tcase_add_test(tests, unreadable_files_are_io_errors);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
