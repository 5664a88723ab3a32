// The table of element kinds and the shapes they have.
#include "geometry/element_traits.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"

static const brunt_element_shape tetrahedron = {
    .plural = "tetrahedra",
    .pieces = 6,
    .vtk_cell = 10,
    .gmsh_type = 4,
    .regular = 1.4142135623730951, // sqrt(2)
    .swap = {{1, 2}},
};
static const uint8_t tetrahedron_face[][4] = {{0, 2, 1, 0}, {0, 1, 3, 0}, {1, 2, 3, 0}, {0, 3, 2, 0}};
static const int8_t tetrahedron_corner[][3] = {{1, 2, 3}, {2, 0, 3}, {0, 1, 3}, {2, 1, 0}};

static const brunt_element_shape hexahedron = {
    .plural = "hexahedra",
    .pieces = 1,
    .vtk_cell = 12,
    .gmsh_type = 5,
    .regular = 1,
    .swap = {{1, 3}, {5, 7}},
};
static const uint8_t hexahedron_face[][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                             {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
static const int8_t hexahedron_corner[][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                              {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};

static const brunt_element_shape triangle = {
    .plural = "triangles",
    .pieces = 2,
    .vtk_cell = 5,
    .gmsh_type = 2,
    .regular = 1.1547005383792517, // 2 / sqrt(3)
    .swap = {{1, 2}},
};
static const uint8_t triangle_face[][4] = {{0, 1, 0, 0}, {1, 2, 0, 0}, {2, 0, 0, 0}};
static const int8_t triangle_corner[][3] = {{1, 2, 0}, {2, 0, 0}, {0, 1, 0}};

static const brunt_element_shape quadrilateral = {
    .plural = "quadrilaterals",
    .pieces = 1,
    .vtk_cell = 9,
    .gmsh_type = 3,
    .regular = 1,
    .swap = {{1, 3}},
};
static const uint8_t quadrilateral_face[][4] = {{0, 1, 0, 0}, {1, 2, 0, 0}, {2, 3, 0, 0}, {3, 0, 0, 0}};
static const int8_t quadrilateral_corner[][3] = {{1, 3, 0}, {2, 0, 0}, {3, 1, 0}, {0, 2, 0}};

static const uint8_t membrane_face[][4] = {{0, 1, 2, 3}};

#define SOLID(kind, name, shape, nodes, dimension, face_nodes)                                                         \
    [kind] = {name,       &(shape),     nodes,         dimension, dimension, false, BRUNT_COUNT(shape##_face),         \
              face_nodes, shape##_face, shape##_corner},
#define MEMBRANE(kind, name, shape, nodes, dimension, face_nodes)                                                      \
    [kind] = {name,       &(shape),      nodes,         3, dimension, true, BRUNT_COUNT(membrane_face),                \
              face_nodes, membrane_face, shape##_corner},
const brunt_element_traits brunt_element_table[] = {BRUNT_SOLID_ELEMENTS(SOLID) BRUNT_MEMBRANE_ELEMENTS(MEMBRANE)};

#define AS_MANY(kind, name, shape, nodes, dimension, face_nodes)                                                       \
    static_assert(BRUNT_COUNT(shape##_corner) == (nodes) && (nodes) <= BRUNT_ELEMENT_NODES,                            \
                  name ": a corner for each "                                                                          \
                       "node");
BRUNT_SOLID_ELEMENTS(AS_MANY)
BRUNT_MEMBRANE_ELEMENTS(AS_MANY)
#define AND_ONE(kind, name, shape, nodes, dimension, face_nodes) +1
static_assert(BRUNT_COUNT(brunt_element_table) == BRUNT_ELEMENT_KINDS, "a row for the last kind");
static_assert(0 BRUNT_SOLID_ELEMENTS(AND_ONE) BRUNT_MEMBRANE_ELEMENTS(AND_ONE) == BRUNT_ELEMENT_KINDS,
              "a row for each kind");

const brunt_element_traits *brunt_element_traits_of(brunt_element_kind kind) {
    static const brunt_element_shape shapeless = {.plural = "elements of no shape"};
    static const brunt_element_traits unknown = {.name = "unknown", .shape = &shapeless};
    return (unsigned)kind < BRUNT_ELEMENT_KINDS ? &brunt_element_table[kind] : &unknown;
}

const char *brunt_element_name(brunt_element_kind kind) { return brunt_element_traits_of(kind)->name; }
int brunt_element_nodes(brunt_element_kind kind) { return brunt_element_traits_of(kind)->nodes; }
int brunt_element_dimension(brunt_element_kind kind) { return brunt_element_traits_of(kind)->dimension; }
bool brunt_element_is_membrane(brunt_element_kind kind) { return brunt_element_traits_of(kind)->membrane; }

bool brunt_element_is_simplex(brunt_element_kind kind) {
    const brunt_element_traits *element = brunt_element_traits_of(kind);
    return element->nodes == element->span + 1;
}

brunt_element_kind brunt_element_as_membrane(brunt_element_kind plane) {
    const brunt_element_shape *shape = brunt_element_traits_of(plane)->shape;
    int k = 0;
    while (k < BRUNT_ELEMENT_KINDS && !(brunt_element_table[k].membrane && brunt_element_table[k].shape == shape)) k++;
    return (brunt_element_kind)k;
}

brunt_element_kind brunt_element_below_membrane(brunt_element_kind membrane) {
    const int nodes = brunt_element_traits_of(membrane)->nodes;
    int k = 0;
    while (k < BRUNT_ELEMENT_KINDS && !(brunt_element_table[k].span == 3 && brunt_element_table[k].face_nodes == nodes))
        k++;
    return (brunt_element_kind)k;
}

static bool is_solid(int kind) { return !brunt_element_table[kind].membrane; }

brunt_element_kind brunt_element_named(const char *name) {
    int k = 0;
    while (k < BRUNT_ELEMENT_KINDS && !(is_solid(k) && strcmp(brunt_element_table[k].name, name) == 0)) k++;
    return (brunt_element_kind)k;
}

brunt_element_kind brunt_element_of_gmsh(int type) {
    int k = 0;
    while (k < BRUNT_ELEMENT_KINDS && !(is_solid(k) && brunt_element_table[k].shape->gmsh_type == type)) k++;
    return (brunt_element_kind)k;
}

void brunt_element_choice(int dimension, char *out, size_t size) {
    size_t used = 0;
    *out = 0;
    for (int k = 0; k < BRUNT_ELEMENT_KINDS && used < size; k++)
        if (is_solid(k) && brunt_element_table[k].dimension == dimension)
            used += (size_t)snprintf(out + used, size - used, "%s%s", used ? " or " : "", brunt_element_table[k].name);
}

// Six times the volume between the triangle abc and the node o.
static double cone(const double *o, const double *a, const double *b, const double *c) {
    double p[3], q[3], r[3];
    for (int i = 0; i < 3; i++) p[i] = a[i] - o[i], q[i] = b[i] - o[i], r[i] = c[i] - o[i];
    return p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
}

// From the first node: coordinates far from the origin cancel before they are multiplied.
double brunt_element_volume(const brunt_element_traits *element, const double (*x)[3]) {
    double sum = 0;
    if (element->span == 2) {
        for (int a = 1; a + 1 < element->nodes; a++)
            sum += (x[a][0] - x[0][0]) * (x[a + 1][1] - x[0][1]) - (x[a][1] - x[0][1]) * (x[a + 1][0] - x[0][0]);
        return sum / 2;
    }
    for (int f = 0; f < element->face_count; f++) {
        const uint8_t *n = element->face[f];
        if (element->face_nodes == 3) {
            sum += cone(x[0], x[n[0]], x[n[1]], x[n[2]]);
            continue;
        }
        sum += (cone(x[0], x[n[0]], x[n[1]], x[n[2]]) + cone(x[0], x[n[0]], x[n[2]], x[n[3]])) / 2;
        sum += (cone(x[0], x[n[0]], x[n[1]], x[n[3]]) + cone(x[0], x[n[1]], x[n[2]], x[n[3]])) / 2;
    }
    return sum / 6;
}
