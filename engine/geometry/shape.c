// Shapes by signed distance, their bounds, and rigid placements.
//
// Primitives are exact. A union takes the smallest of its children, an intersection the largest, a difference the
// largest of the first and the negated others: still no farther than the true distance (1-Lipschitz), which is all that
// filling a lattice and limiting a particle's reach rely on.
#include "brunt.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

// ---------------------------------------------------------------------------------------------------- placements

brunt_placement brunt_placement_identity(void) { return (brunt_placement){.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}}; }

brunt_placement brunt_placement_translate(brunt_placement first, const double by[3]) {
    for (int i = 0; i < 3; i++) first.translation[i] += by[i];
    return first;
}

brunt_placement brunt_placement_rotate(brunt_placement first, const double axis[3], double angle,
                                       const double about[3]) {
    double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    if (!(length > 0)) length = NAN; // no direction: the placement is none, and refused as such
    double a[3] = {axis[0] / length, axis[1] / length, axis[2] / length};
    double c = cos(angle), s = sin(angle);
    // Rodrigues: R = c I + s [a]x + (1 - c) a a^T
    double R[9] = {c + (1 - c) * a[0] * a[0],        (1 - c) * a[0] * a[1] - s * a[2], (1 - c) * a[0] * a[2] + s * a[1],
                   (1 - c) * a[1] * a[0] + s * a[2], c + (1 - c) * a[1] * a[1],        (1 - c) * a[1] * a[2] - s * a[0],
                   (1 - c) * a[2] * a[0] - s * a[1], (1 - c) * a[2] * a[1] + s * a[0], c + (1 - c) * a[2] * a[2]};
    brunt_placement result;
    for (int i = 0; i < 3; i++) {
        result.translation[i] = about[i];
        for (int j = 0; j < 3; j++) {
            result.translation[i] += R[3 * i + j] * (first.translation[j] - about[j]);
            result.rotation[3 * i + j] = R[3 * i] * first.rotation[j] + R[3 * i + 1] * first.rotation[3 + j] +
                                         R[3 * i + 2] * first.rotation[6 + j];
        }
    }
    return result;
}

// ---------------------------------------------------------------------------------------------------- distances

// Distance to a box of any dimension from the signed gaps to its faces, two faces an axis being one gap.
static double gaps_distance(const double *gap, int count) {
    double outside = 0, inside = -INFINITY;
    for (int i = 0; i < count; i++) {
        if (gap[i] > 0) outside += gap[i] * gap[i];
        if (gap[i] > inside) inside = gap[i];
    }
    return inside > 0 ? sqrt(outside) : inside;
}

static double span_gap(double x, double min, double max) { return fabs(x - (min + max) / 2) - (max - min) / 2; }

static double box_distance(const brunt_shape *shape, int dimension, const double *x) {
    double gap[3];
    for (int i = 0; i < dimension; i++) gap[i] = span_gap(x[i], shape->min[i], shape->max[i]);
    return gaps_distance(gap, dimension);
}

static double norm(const double *v, int dimension) {
    double square = 0;
    for (int i = 0; i < dimension; i++) square += v[i] * v[i];
    return sqrt(square);
}

static double center_distance(const brunt_shape *shape, int dimension, const double *x) {
    double d[3];
    for (int i = 0; i < dimension; i++) d[i] = x[i] - shape->center[i];
    return norm(d, dimension);
}

static double cylinder_distance(const brunt_shape *shape, int dimension, const double *x, double inner) {
    double length = norm(shape->axis, dimension), along = 0, radial[3];
    for (int i = 0; i < dimension; i++) along += (x[i] - shape->center[i]) * shape->axis[i] / length;
    for (int i = 0; i < dimension; i++) radial[i] = x[i] - shape->center[i] - along * shape->axis[i] / length;
    double r = norm(radial, dimension);
    double gap[2] = {span_gap(along, 0, shape->length),
                     inner > 0 ? span_gap(r, inner, shape->radius) : r - shape->radius};
    return gaps_distance(gap, 2);
}

// Nearest edge for the size; parity of the edges crossed by a ray towards +x for the sign, an edge owning its lower end
// only so that a ray through a corner is counted once.
static double polygon_distance(const brunt_shape *shape, const double *x) {
    double nearest = INFINITY;
    bool inside = false;
    for (int32_t i = 0, j = shape->point_count - 1; i < shape->point_count; j = i++) {
        const double *a = shape->points[j], *b = shape->points[i];
        double edge[2] = {b[0] - a[0], b[1] - a[1]}, from[2] = {x[0] - a[0], x[1] - a[1]};
        double square = edge[0] * edge[0] + edge[1] * edge[1];
        double t = square > 0 ? fmin(fmax((from[0] * edge[0] + from[1] * edge[1]) / square, 0), 1) : 0;
        double off[2] = {from[0] - t * edge[0], from[1] - t * edge[1]};
        nearest = fmin(nearest, off[0] * off[0] + off[1] * off[1]);
        if ((a[1] <= x[1]) != (b[1] <= x[1]) && x[0] < a[0] + (x[1] - a[1]) / edge[1] * edge[0]) inside = !inside;
    }
    return inside ? -sqrt(nearest) : sqrt(nearest);
}

static double half_space_distance(const brunt_shape *shape, int dimension, const double *x) {
    double length = norm(shape->axis, dimension), distance = 0;
    for (int i = 0; i < dimension; i++) distance += (x[i] - shape->center[i]) * shape->axis[i] / length;
    return distance;
}

double brunt_shape_distance(const brunt_shape *shape, int dimension, const double point[3]) {
    switch (shape->kind) {
    case BRUNT_BOX: return box_distance(shape, dimension, point);
    case BRUNT_SPHERE: return center_distance(shape, dimension, point) - shape->radius;
    case BRUNT_CYLINDER: return cylinder_distance(shape, dimension, point, 0);
    case BRUNT_TUBE:
        if (dimension == 2) return span_gap(center_distance(shape, 2, point), shape->inner_radius, shape->radius);
        return cylinder_distance(shape, dimension, point, shape->inner_radius);
    case BRUNT_PRISM: {
        double gap[2] = {polygon_distance(shape, point), 0};
        if (dimension == 2) return gap[0];
        gap[1] = span_gap(point[2], shape->min[2], shape->max[2]);
        return gaps_distance(gap, 2);
    }
    case BRUNT_HALF_SPACE: return half_space_distance(shape, dimension, point);
    case BRUNT_UNION:
    case BRUNT_DIFFERENCE:
    case BRUNT_INTERSECTION: break;
    }
    double result = shape->kind == BRUNT_UNION ? INFINITY : -INFINITY;
    for (int32_t c = 0; c < shape->child_count; c++) {
        double d = brunt_shape_distance(&shape->children[c], dimension, point);
        if (shape->kind == BRUNT_UNION)
            result = fmin(result, d);
        else
            result = fmax(result, shape->kind == BRUNT_DIFFERENCE && c > 0 ? -d : d);
    }
    return shape->child_count ? result : INFINITY;
}

// ---------------------------------------------------------------------------------------------------- bounds

// Cuts [min, max] by a half-space whose normal is along a coordinate axis (others bound nothing), or by its complement.
static void cut_by_half_space(const brunt_shape *shape, int dimension, bool flip, double *min, double *max) {
    int along = -1;
    for (int i = 0; i < dimension; i++) {
        if (shape->axis[i] == 0) continue;
        if (along >= 0) return;
        along = i;
    }
    if (along < 0) return;
    if ((shape->axis[along] > 0) != flip)
        max[along] = fmin(max[along], shape->center[along]);
    else
        min[along] = fmax(min[along], shape->center[along]);
}

// Half-extent along each coordinate of a disk of radius 1 across `axis`.
static double disk_extent(const double *axis, int dimension, int i) {
    double length = norm(axis, dimension), a = axis[i] / length;
    return sqrt(fmax(0, 1 - a * a));
}

// Bounds that may be infinite, or empty (min > max).
static void bounds_of(const brunt_shape *shape, int dimension, double *min, double *max) {
    for (int i = 0; i < dimension; i++) min[i] = -INFINITY, max[i] = INFINITY;
    bool round = shape->kind == BRUNT_SPHERE || (shape->kind == BRUNT_TUBE && dimension == 2);
    switch (shape->kind) {
    case BRUNT_BOX:
        for (int i = 0; i < dimension; i++) min[i] = shape->min[i], max[i] = shape->max[i];
        break;
    case BRUNT_SPHERE:
    case BRUNT_CYLINDER:
    case BRUNT_TUBE:
        for (int i = 0; i < dimension; i++) {
            double half = round ? shape->radius : shape->radius * disk_extent(shape->axis, dimension, i);
            double end = round ? 0 : shape->length * shape->axis[i] / norm(shape->axis, dimension);
            min[i] = shape->center[i] + fmin(0, end) - half;
            max[i] = shape->center[i] + fmax(0, end) + half;
        }
        break;
    case BRUNT_PRISM:
        for (int i = 0; i < 2; i++) {
            min[i] = INFINITY, max[i] = -INFINITY;
            for (int32_t p = 0; p < shape->point_count; p++) {
                min[i] = fmin(min[i], shape->points[p][i]);
                max[i] = fmax(max[i], shape->points[p][i]);
            }
        }
        if (dimension == 3) min[2] = shape->min[2], max[2] = shape->max[2];
        break;
    case BRUNT_HALF_SPACE: cut_by_half_space(shape, dimension, false, min, max); break;
    case BRUNT_UNION:
        for (int i = 0; i < dimension; i++) min[i] = INFINITY, max[i] = -INFINITY;
        for (int32_t c = 0; c < shape->child_count; c++) {
            double lower[3], upper[3];
            bounds_of(&shape->children[c], dimension, lower, upper);
            for (int i = 0; i < dimension; i++) min[i] = fmin(min[i], lower[i]), max[i] = fmax(max[i], upper[i]);
        }
        break;
    case BRUNT_DIFFERENCE:
        if (shape->child_count) bounds_of(&shape->children[0], dimension, min, max);
        for (int32_t c = 1; c < shape->child_count; c++)
            if (shape->children[c].kind == BRUNT_HALF_SPACE)
                cut_by_half_space(&shape->children[c], dimension, true, min, max);
        break;
    case BRUNT_INTERSECTION:
        for (int32_t c = 0; c < shape->child_count; c++) {
            double lower[3], upper[3];
            bounds_of(&shape->children[c], dimension, lower, upper);
            for (int i = 0; i < dimension; i++) min[i] = fmax(min[i], lower[i]), max[i] = fmin(max[i], upper[i]);
        }
        break;
    }
}

bool brunt_shape_bounds(const brunt_shape *shape, int dimension, double min[3], double max[3]) {
    min[2] = max[2] = 0;
    bounds_of(shape, dimension, min, max);
    for (int i = 0; i < dimension; i++)
        if (!isfinite(min[i]) || !isfinite(max[i]) || !(min[i] < max[i])) return false;
    return true;
}

void brunt_shape_free(brunt_shape *shape) {
    for (int32_t c = 0; c < shape->child_count; c++) brunt_shape_free(&shape->children[c]);
    brunt_free(shape->children);
    brunt_free(shape->points);
    shape->children = NULL;
    shape->points = NULL;
    shape->child_count = shape->point_count = 0;
}
