// Halves, quarters and eighths: what is left of a round shape between planes along the coordinate axes.
//
// The grids of round shapes have nodes on the planes through their centre, so that a part is the whole grid less the
// cells beyond; across its axis a cylinder is cut to another cylinder. Boxes cut by boxes are boxes.
#include "base/error.h"
#include "geometry/mesh_shape.h"

#include <math.h>

static const double NEAR = 1e-9; // of the radius: a plane that is nearer goes through the centre, or touches

static int refuse(brunt_error *error) {
    return brunt_fail(
        error, BRUNT_BAD_INPUT,
        "a mesh is made of a box, sphere, cylinder, ring, or prism with 4 corners, not of an intersection, but "
        "for that of boxes, and that of one sphere, disk, cylinder or ring with boxes (or half-spaces) "
        "whose faces miss it, go through its centre along x, y or z, or cut straight across its axis");
}

// Narrows the room between the planes by a box or a half-space along an axis. False: it is neither.
static bool narrow(const brunt_shape *by, int dimension, double low[3], double high[3]) {
    if (by->kind == BRUNT_BOX)
        for (int d = 0; d < dimension; d++) low[d] = fmax(low[d], by->min[d]), high[d] = fmin(high[d], by->max[d]);
    if (by->kind != BRUNT_HALF_SPACE) return by->kind == BRUNT_BOX;
    int along = -1;
    for (int d = 0; d < dimension; d++) {
        if (by->axis[d] == 0) continue;
        if (along >= 0) return false;
        along = d;
    }
    if (along < 0) return false;
    if (by->axis[along] > 0)
        high[along] = fmin(high[along], by->center[along]);
    else
        low[along] = fmax(low[along], by->center[along]);
    return true;
}

static int box_between(brunt_mesh_cut *cut, int dimension, brunt_error *error) {
    cut->whole = (brunt_shape){.kind = BRUNT_BOX};
    for (int d = 0; d < dimension; d++) {
        cut->whole.min[d] = cut->low[d], cut->whole.max[d] = cut->high[d];
        if (!isfinite(cut->high[d] - cut->low[d]) || !(cut->low[d] < cut->high[d])) return refuse(error);
        cut->low[d] = -INFINITY, cut->high[d] = INFINITY;
    }
    return BRUNT_OK;
}

enum { OBLIQUE = -2 };

// The coordinate axis that a shape turns about: BRUNT_NONE of balls and disks, or OBLIQUE.
static int axis_of(const brunt_shape *shape, int dimension) {
    int along = BRUNT_NONE;
    if (shape->kind == BRUNT_SPHERE || dimension == 2) return BRUNT_NONE;
    for (int d = 0; d < 3; d++) {
        if (shape->axis[d] == 0) continue;
        if (along >= 0) return OBLIQUE;
        along = d;
    }
    return along;
}

// A cylinder between two planes across its axis.
static void shorten(brunt_shape *shape, int along, double from, double to) {
    shape->center[along] = shape->axis[along] > 0 ? from : to;
    shape->length = to - from;
}

int brunt_mesh_cutting(const brunt_shape *shape, int dimension, brunt_mesh_cut *cut, brunt_error *error) {
    *cut = (brunt_mesh_cut){
        .whole = *shape, .low = {-INFINITY, -INFINITY, -INFINITY}, .high = {INFINITY, INFINITY, INFINITY}};
    if (shape->kind != BRUNT_INTERSECTION) return BRUNT_OK;
    const brunt_shape *one = NULL;
    for (int32_t c = 0; c < shape->child_count; c++) {
        if (narrow(&shape->children[c], dimension, cut->low, cut->high)) continue;
        if (one) return refuse(error);
        one = &shape->children[c];
    }
    if (!one) return box_between(cut, dimension, error);
    if (one->kind != BRUNT_SPHERE && one->kind != BRUNT_TUBE && (one->kind != BRUNT_CYLINDER || dimension == 2))
        return refuse(error);
    double min[3], max[3];
    if (!brunt_shape_bounds(one, dimension, min, max)) return refuse(error);
    cut->whole = *one;
    const double near = NEAR * one->radius;
    const int along = axis_of(one, dimension);
    for (int d = 0; d < dimension; d++) {
        double *low = &cut->low[d], *high = &cut->high[d];
        if (*low <= min[d] + near) *low = -INFINITY;
        if (*high >= max[d] - near) *high = INFINITY;
        if (isinf(*low) && isinf(*high)) continue;
        const double from = fmax(*low, min[d]), to = fmin(*high, max[d]);
        if (along == OBLIQUE || !(to - from > near)) return refuse(error);
        if (d == along) {
            shorten(&cut->whole, along, from, to);
            continue;
        }
        if ((isfinite(*low) && fabs(*low - one->center[d]) > near) ||
            (isfinite(*high) && fabs(*high - one->center[d]) > near))
            return refuse(error);
    }
    return BRUNT_OK;
}

bool brunt_mesh_is_cut(const brunt_mesh_cut *cut) {
    bool any = false;
    for (int d = 0; d < 3; d++) any = any || isfinite(cut->low[d]) || isfinite(cut->high[d]);
    return any;
}

// Puts the nodes of a cut exactly on it, in a group of its own.
static void mark(brunt_mesh_grid *grid, int axis, double at, double near, int bit) {
    for (int32_t n = 0; n < grid->node_count; n++) {
        if (fabs(grid->x[n][axis] - at) > near) continue;
        grid->x[n][axis] = at;
        grid->groups[n] |= (uint16_t)(1u << bit);
    }
}

int brunt_mesh_grid_cut(const brunt_mesh_cut *cut, const char *names[BRUNT_GRID_GROUPS], brunt_mesh_grid *grid) {
    static const char *const faces[3][2] = {{"xmin", "xmax"}, {"ymin", "ymax"}, {"zmin", "zmax"}};
    for (int f = 0; f < 2 * grid->dimension; f++) {
        const int axis = f / 2, bit = BRUNT_GRID_CUT + f;
        const bool lower = f % 2 == 0;
        const double at = lower ? cut->low[axis] : cut->high[axis], near = 2 * NEAR * cut->whole.radius;
        if (!isfinite(at)) continue;
        if (brunt_mesh_grid_keep(axis, lower, at + (lower ? -near : near), grid)) return BRUNT_GRID_MEMORY;
        mark(grid, axis, at, near, bit);
        names[bit] = faces[axis][!lower];
    }
    return 0;
}
