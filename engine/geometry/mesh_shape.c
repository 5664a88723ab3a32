// Structured meshes of shapes: how many cells, which grid, where it lies, which groups.
//
// A count is length over size, rounded, and at least 1; around a circle it is a multiple of 4 (of 8 in balls and
// cylinders of triangles and tetrahedra), and at least 8. Nodes lie on curved surfaces, so that the mesh's volume is
// below the shape's (above, at a bore) by a share of the square of size over radius.
#include "brunt.h"
#include "base/error.h"
#include "base/memory.h"
#include "geometry/element_traits.h"
#include "geometry/mesh_shape.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static int32_t cells(double length, double size, int32_t least) {
    double count = round(length / size);
    return count < 1e9 ? (int32_t)fmax(count, least) : 1000000000; // more is refused when the nodes are counted
}

static double distance(const double *a, const double *b) { return hypot(b[0] - a[0], b[1] - a[1]); }

// ---------------------------------------------------------------------------------------------------- quadrilateral

static double turn_at(const double corner[4][2], int i) {
    const double *a = corner[(i + 3) % 4], *b = corner[i], *c = corner[(i + 1) % 4];
    double lengths = distance(a, b) * distance(b, c);
    return lengths > 0 ? ((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])) / lengths : 0;
}

// Corners in counter-clockwise order, and of each edge of those its number among the edges as given.
static int take_corners(const brunt_shape *shape, double corner[4][2], int edge[4], brunt_error *error) {
    if (shape->point_count != 4)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "a mesh is made of a prism with 4 corners, this one has %d: give a mesh file",
                          (int)shape->point_count);
    for (int turned = 0; turned < 2; turned++) {
        double least = INFINITY;
        for (int i = 0; i < 4; i++) {
            memcpy(corner[i], shape->points[turned ? 3 - i : i], sizeof corner[i]);
            edge[i] = turned ? (6 - i) % 4 : i;
        }
        for (int i = 0; i < 4; i++) least = fmin(least, turn_at(corner, i));
        if (least > 1e-6) return BRUNT_OK;
    }
    return brunt_fail(
        error, BRUNT_BAD_INPUT,
        "a mesh is made of a prism whose 4 corners are convex, this one has a corner of 180 degrees or more");
}

static int grid_of_corners(double corner[4][2], double size, brunt_mesh_grid *grid) {
    double along = (distance(corner[0], corner[1]) + distance(corner[3], corner[2])) / 2;
    double across = (distance(corner[1], corner[2]) + distance(corner[0], corner[3])) / 2;
    return brunt_mesh_grid_quadrilateral(corner, (int32_t[2]){cells(along, size, 1), cells(across, size, 1)}, grid);
}

// ---------------------------------------------------------------------------------------------------- round shapes

// `even`: a core that is to be cut symmetrically.
static int grid_of_ball(int dimension, double radius, double size, bool even, brunt_mesh_grid *grid) {
    int32_t core = even ? 2 * cells(radius / 2, size, 1) : cells(radius, size, 2);
    return brunt_mesh_grid_ball(dimension, radius, core, (core + 1) / 2, grid);
}

static int grid_of_annulus(double inner, double outer, double size, brunt_mesh_grid *grid) {
    int32_t quarter = cells(pi / 4 * (inner + outer), size, 2);
    if (quarter > 250000000) quarter = 250000000;
    return brunt_mesh_grid_annulus(inner, outer, 4 * quarter, cells(outer - inner, size, 1), grid);
}

// From the grid's frame to one whose third axis is `axis`, with its origin at `center`. An axis along +x, +y or +z
// gives the coordinate axes in cyclic order.
static void set_upright(const double *axis, const double *center, brunt_mesh_grid *grid) {
    double frame[3][3], length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    int steepest = 0;
    for (int d = 0; d < 3; d++) {
        frame[2][d] = axis[d] / length;
        if (fabs(axis[d]) >= fabs(axis[steepest])) steepest = d;
    }
    double along = frame[2][(steepest + 1) % 3], square = 0;
    for (int d = 0; d < 3; d++) {
        frame[0][d] = (d == (steepest + 1) % 3) - along * frame[2][d];
        square += frame[0][d] * frame[0][d];
    }
    for (int d = 0; d < 3; d++) frame[0][d] /= sqrt(square);
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        frame[1][d] = frame[2][e] * frame[0][f] - frame[2][f] * frame[0][e];
    }
    for (int32_t n = 0; n < grid->node_count; n++) {
        double *x = grid->x[n], u = x[0], v = x[1], w = x[2];
        for (int d = 0; d < 3; d++) x[d] = center[d] + u * frame[0][d] + v * frame[1][d] + w * frame[2][d];
    }
}

static void shift(const double *by, int dimension, brunt_mesh_grid *grid) {
    for (int32_t n = 0; n < grid->node_count; n++)
        for (int d = 0; d < dimension; d++) grid->x[n][d] += by[d];
}

// ---------------------------------------------------------------------------------------------------- shapes

static int refuse(brunt_error *error, const char *what) {
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "a mesh is made of a box, sphere, cylinder, ring, or prism with 4 corners, not of %s", what);
}

static int check_positive(const char *what, double value, brunt_error *error) {
    if (value > 0 && isfinite(value)) return BRUNT_OK;
    return brunt_fail(error, BRUNT_BAD_INPUT, "the %s of a shape to be meshed is %g m, a positive length is wanted",
                      what, value);
}

static int check_round(const brunt_shape *shape, int dimension, brunt_error *error) {
    int status = check_positive("radius", shape->radius, error);
    if (!status && shape->kind == BRUNT_TUBE) {
        status = check_positive("inner radius", shape->inner_radius, error);
        if (!status && shape->inner_radius >= shape->radius)
            status = brunt_fail(error, BRUNT_BAD_INPUT,
                                "the inner radius %g m of a ring to be meshed is not below its radius %g m",
                                shape->inner_radius, shape->radius);
    }
    if (status || shape->kind == BRUNT_SPHERE || dimension == 2) return status;
    double square = 0;
    for (int d = 0; d < 3; d++) square += shape->axis[d] * shape->axis[d];
    if (!(square > 0) || !isfinite(square))
        return brunt_fail(error, BRUNT_BAD_INPUT, "the axis of a shape to be meshed has no direction");
    return check_positive("length", shape->length, error);
}

static int check_shape(const brunt_shape *shape, int dimension, brunt_error *error) {
    int status = BRUNT_OK;
    switch (shape->kind) {
    case BRUNT_BOX:
        for (int d = 0; d < dimension && !status; d++)
            status = check_positive("extent", shape->max[d] - shape->min[d], error);
        return status;
    case BRUNT_PRISM: return dimension == 3 ? check_positive("height", shape->max[2] - shape->min[2], error) : BRUNT_OK;
    case BRUNT_CYLINDER:
        if (dimension == 2) return refuse(error, "a cylinder in two dimensions");
        return check_round(shape, dimension, error);
    case BRUNT_SPHERE:
    case BRUNT_TUBE: return check_round(shape, dimension, error);
    case BRUNT_HALF_SPACE: return refuse(error, "a half-space");
    case BRUNT_UNION: return refuse(error, "a union");
    case BRUNT_DIFFERENCE: return refuse(error, "a difference");
    case BRUNT_INTERSECTION: break; // has become what it is of
    }
    return refuse(error, "an unknown shape");
}

static void name_groups(const char *names[BRUNT_GRID_GROUPS], int dimension, const char *start, const char *end) {
    if (dimension == 3) names[BRUNT_GRID_START] = start, names[BRUNT_GRID_END] = end;
}

// What a grid that was not made is to the caller of a mesh.
static int grid_code(int made, double size, brunt_error *error) {
    if (made == BRUNT_GRID_TOO_MANY)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "an edge length of %g m makes more than 100 million nodes of this shape", size);
    return made ? brunt_fail(error, BRUNT_FAILED, "no memory for a mesh with edges of %g m", size) : BRUNT_OK;
}

// Makes the grid of a checked shape and names the bits of its groups.
static int make_grid(const brunt_shape *shape, int dimension, double size, bool even, brunt_mesh_grid *grid,
                     const char *names[BRUNT_GRID_GROUPS], brunt_error *error) {
    static const char *const box_sides[4] = {"ymin", "xmax", "ymax", "xmin"};
    static const char *const prism_sides[4] = {"side1", "side2", "side3", "side4"};
    double corner[4][2] = {{shape->min[0], shape->min[1]},
                           {shape->max[0], shape->min[1]},
                           {shape->max[0], shape->max[1]},
                           {shape->min[0], shape->max[1]}};
    int edge[4] = {0, 1, 2, 3}, made = 0, status;
    bool is_round = shape->kind == BRUNT_CYLINDER || shape->kind == BRUNT_TUBE;
    double from = is_round ? 0 : shape->min[2], to = is_round ? shape->length : shape->max[2];
    int32_t layers = cells(to - from, size, 1);
    if (dimension == 3 && shape->kind != BRUNT_SPHERE) grid->layers = layers;
    switch (shape->kind) {
    case BRUNT_SPHERE:
        made = grid_of_ball(dimension, shape->radius, size, even, grid);
        if (!made) shift(shape->center, dimension, grid);
        return grid_code(made, size, error);
    case BRUNT_CYLINDER:
        made = grid_of_ball(2, shape->radius, size, even, grid);
        names[0] = "side";
        name_groups(names, 3, "start", "end");
        break;
    case BRUNT_TUBE:
        made = grid_of_annulus(shape->inner_radius, shape->radius, size, grid);
        names[0] = "inner", names[1] = "outer";
        name_groups(names, dimension, "start", "end");
        break;
    default:
        if (shape->kind == BRUNT_PRISM && (status = take_corners(shape, corner, edge, error))) return status;
        made = grid_of_corners(corner, size, grid);
        for (int i = 0; i < 4; i++) names[i] = shape->kind == BRUNT_PRISM ? prism_sides[edge[i]] : box_sides[i];
        name_groups(names, dimension, "zmin", "zmax");
    }
    if (!made && dimension == 3) made = brunt_mesh_grid_extrude(from, to, layers, grid);
    if (!made && is_round && dimension == 3) set_upright(shape->axis, shape->center, grid);
    if (!made && is_round && dimension == 2) shift(shape->center, 2, grid);
    return grid_code(made, size, error);
}

// ---------------------------------------------------------------------------------------------------- the mesh

// Nodes with any bit of `mask`, as the mesh's next group. False: out of memory.
static bool add_group(const brunt_mesh_grid *grid, const char *name, unsigned mask, brunt_mesh *mesh) {
    brunt_group *group = &mesh->groups[mesh->group_count++];
    memcpy(group->name, name, strlen(name) + 1);
    for (int32_t n = 0; n < grid->node_count; n++) group->count += (grid->groups[n] & mask) != 0;
    group->nodes = brunt_alloc((size_t)group->count * sizeof *group->nodes);
    if (!group->nodes) return false;
    for (int32_t n = 0, i = 0; n < grid->node_count; n++)
        if (grid->groups[n] & mask) group->nodes[i++] = n;
    return true;
}

// In the order of the documentation, which is that of the names: xmin xmax ymin ..., start end side, and the surface
// last.
static bool add_groups(const brunt_mesh_grid *grid, const char *const names[BRUNT_GRID_GROUPS], brunt_mesh *mesh) {
    static const char *const order[] = {"xmin", "xmax",  "ymin",  "ymax",  "zmin",  "zmax",  "start", "end",
                                        "side", "inner", "outer", "side1", "side2", "side3", "side4"};
    mesh->groups = brunt_alloc((BRUNT_GRID_GROUPS + 1) * sizeof *mesh->groups);
    if (!mesh->groups) return false;
    for (size_t o = 0; o < sizeof order / sizeof *order; o++)
        for (int bit = 0; bit < BRUNT_GRID_GROUPS; bit++)
            if (names[bit] && !strcmp(names[bit], order[o]) && !add_group(grid, names[bit], 1u << bit, mesh))
                return false;
    return add_group(grid, "surface", ~0u, mesh);
}

static bool take_elements(const brunt_mesh_grid *grid, brunt_element_kind kind, brunt_mesh *mesh) {
    int nodes = brunt_element_nodes(kind), pieces = brunt_element_traits_of(kind)->shape->pieces;
    mesh->kind = kind;
    mesh->element_count = grid->cell_count * pieces;
    mesh->elements = brunt_alloc((size_t)mesh->element_count * (size_t)nodes * sizeof *mesh->elements);
    if (!mesh->elements) return false;
    if (pieces > 1)
        brunt_mesh_grid_split(grid, mesh->elements);
    else
        for (int32_t c = 0; c < grid->cell_count; c++)
            memcpy(mesh->elements + (size_t)c * (size_t)nodes, grid->cell[c], (size_t)nodes * sizeof *mesh->elements);
    return true;
}

int brunt_mesh_shape(const brunt_shape *shape, int dimension, brunt_element_kind kind, double size, brunt_mesh *mesh,
                     brunt_error *error) {
    *mesh = (brunt_mesh){0};
    if (brunt_element_dimension(kind) != dimension)
        return brunt_fail(error, BRUNT_BAD_INPUT, "elements of kind %s are of %d dimensions, the shape is of %d",
                          brunt_element_name(kind), brunt_element_dimension(kind), dimension);
    if (brunt_element_is_membrane(kind))
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "elements of kind %s are membranes: a shape's surface is made of them",
                          brunt_element_name(kind));
    if (!(size > 0) || !isfinite(size))
        return brunt_fail(error, BRUNT_BAD_INPUT, "an edge length of %g m, a positive length is wanted", size);
    brunt_mesh_cut cut;
    int status = brunt_mesh_cutting(shape, dimension, &cut, error);
    if (!status) status = check_shape(&cut.whole, dimension, error);
    if (status) return status;
    const char *names[BRUNT_GRID_GROUPS] = {0};
    brunt_mesh_grid grid = {0};
    const bool even = brunt_mesh_is_cut(&cut) || brunt_element_traits_of(kind)->shape->pieces > 1;
    status = make_grid(&cut.whole, dimension, size, even, &grid, names, error);
    if (!status) status = grid_code(brunt_mesh_grid_cut(&cut, names, &grid), size, error);
    if (!status && (!take_elements(&grid, kind, mesh) || !add_groups(&grid, names, mesh)))
        status = brunt_fail(error, BRUNT_FAILED, "no memory for a mesh with edges of %g m", size);
    if (!status) {
        mesh->node_count = grid.node_count;
        mesh->nodes = grid.x;
        grid.x = NULL;
    } else {
        brunt_mesh_free(mesh);
    }
    brunt_mesh_grid_free(&grid);
    return status;
}
