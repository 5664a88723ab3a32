// Shapes and placements of a scene.
#include "io/scene/scene_reader.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

enum { POINT_LIMIT = 2000 }; // corners of a polygon: crossing is looked for pair by pair

static void complain_zero(scene_reader *reader, const scene_node *map, const char *key, const char *what) {
    double v[3] = {0};
    const scene_node *node = brunt_tree_child(map, key);
    if (!brunt_vector_of(map, key, v)) return;
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 0) || !isfinite(length))
        brunt_tree_complain(reader->tree, node, "%s has %s length", what, length > 0 ? "no usable" : "zero");
}

static double cross(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool between(const double a[2], const double b[2], const double p[2]) {
    return fmin(a[0], b[0]) <= p[0] && p[0] <= fmax(a[0], b[0]) && fmin(a[1], b[1]) <= p[1] && p[1] <= fmax(a[1], b[1]);
}

// Whether the segments ab and cd share a point.
static bool segments_meet(const double a[2], const double b[2], const double c[2], const double d[2]) {
    double d1 = cross(a, b, c), d2 = cross(a, b, d), d3 = cross(c, d, a), d4 = cross(c, d, b);
    if (((d1 > 0 && d2 < 0) || (d1 < 0 && d2 > 0)) && ((d3 > 0 && d4 < 0) || (d3 < 0 && d4 > 0))) return true;
    return (d1 == 0 && between(a, b, c)) || (d2 == 0 && between(a, b, d)) || (d3 == 0 && between(c, d, a)) ||
           (d4 == 0 && between(c, d, b));
}

static void check_polygon_form(scene_reader *reader, const scene_node *node, const brunt_shape *shape) {
    int n = shape->point_count;
    const double(*p)[2] = (const double(*)[2])shape->points;
    double area = 0, size = 0;
    for (int i = 0; i < n; i++) {
        const double *a = p[i], *b = p[(i + 1) % n];
        if (a[0] == b[0] && a[1] == b[1]) {
            brunt_tree_complain(reader->tree, node, "points %d and %d are the same", i, (i + 1) % n);
            return;
        }
        double x = a[0] - p[0][0], y = a[1] - p[0][1];
        area += x * (b[1] - p[0][1]) - (b[0] - p[0][0]) * y;
        size = fmax(size, fmax(fabs(x), fabs(y)));
    }
    // Edge i may touch only its neighbours, in the shared corner; folding back onto a neighbour shows as a zero turn.
    for (int i = 0; i < n; i++) {
        const double *a = p[i], *b = p[(i + 1) % n], *next = p[(i + 2) % n];
        double back = (a[0] - b[0]) * (next[0] - b[0]) + (a[1] - b[1]) * (next[1] - b[1]);
        bool folded = cross(a, b, next) == 0 && back > 0;
        for (int j = i + 2; j < n && !folded; j++) {
            if (i == 0 && j == n - 1) continue;
            if (!segments_meet(a, b, p[j], p[(j + 1) % n])) continue;
            brunt_tree_complain(reader->tree, node,
                                "the polygon crosses itself: the edges from point %d and from point %d meet", i, j);
            return;
        }
        if (folded) {
            brunt_tree_complain(reader->tree, node, "the polygon folds back onto itself at point %d", (i + 1) % n);
            return;
        }
    }
    if (!(fabs(area) > 1e-14 * size * size)) brunt_tree_complain(reader->tree, node, "the polygon has no area");
}

static void fill_polygon(scene_reader *reader, const scene_node *map, brunt_shape *shape) {
    const scene_node *points = brunt_tree_child(map, "points");
    shape->min[2] = brunt_real_of(map, "min", 0);
    shape->max[2] = brunt_real_of(map, "max", 0);
    const scene_node *low = brunt_tree_child(map, "min"), *high = brunt_tree_child(map, "max");
    if (low && high && low->good && high->good && !(shape->min[2] < shape->max[2]))
        brunt_tree_complain(reader->tree, low, "min must be below max");
    if (!points || !points->good) return;
    if (points->count < 3 || points->count > POINT_LIMIT) {
        brunt_tree_complain(reader->tree, points, "%d points are given, 3 to %d are wanted", points->count,
                            POINT_LIMIT);
        return;
    }
    shape->points = brunt_alloc(sizeof *shape->points * (size_t)points->count);
    if (!shape->points) {
        reader->tree->exhausted = true;
        return;
    }
    for (const scene_node *point = points->first; point; point = point->next) {
        shape->points[shape->point_count][0] = point->value[0];
        shape->points[shape->point_count++][1] = point->value[1];
    }
    check_polygon_form(reader, points, shape);
}

static void fill_box(scene_reader *reader, const scene_node *map, brunt_shape *shape) {
    bool low = brunt_vector_of(map, "min", shape->min), high = brunt_vector_of(map, "max", shape->max);
    // Where the dimension itself is wrong, that has been said.
    for (int c = 0; low && high && c < reader->dimension; c++) {
        if (shape->min[c] < shape->max[c]) continue;
        char a[32], b[32];
        brunt_format_number(shape->min[c], a);
        brunt_format_number(shape->max[c], b);
        brunt_tree_complain(reader->tree, brunt_tree_child(map, "min"),
                            "min must be below max, along %c it is %s against %s", "xyz"[c], a, b);
    }
}

static void fill_children(scene_reader *reader, const scene_node *list, brunt_shape *shape) {
    if (list->kind != SCENE_LIST || list->count == 0) return;
    if (shape->kind != BRUNT_UNION && list->count < 2)
        brunt_tree_complain(reader->tree, list, "one shape is given, at least two are wanted");
    shape->children = brunt_alloc(sizeof *shape->children * (size_t)list->count);
    if (!shape->children) {
        reader->tree->exhausted = true;
        return;
    }
    for (const scene_node *child = list->first; child; child = child->next)
        brunt_fill_shape_def(reader, child, &shape->children[shape->child_count++]);
}

void brunt_fill_shape_def(scene_reader *reader, const scene_node *node, brunt_shape *shape) {
    memset(shape, 0, sizeof *shape);
    if (!node || node->kind != SCENE_MAP || node->count != 1) return;
    static const struct {
        const char *key;
        brunt_shape_kind kind;
    } kinds[] = {{"box", BRUNT_BOX},
                 {"sphere", BRUNT_SPHERE},
                 {"disk", BRUNT_SPHERE},
                 {"cylinder", BRUNT_CYLINDER},
                 {"tube", BRUNT_TUBE},
                 {"polygon", BRUNT_PRISM},
                 {"half-space", BRUNT_HALF_SPACE},
                 {"union", BRUNT_UNION},
                 {"difference", BRUNT_DIFFERENCE},
                 {"intersection", BRUNT_INTERSECTION}};
    const scene_node *map = node->first;
    int k = -1;
    for (int i = 0; i < (int)(sizeof kinds / sizeof *kinds); i++)
        if (strcmp(kinds[i].key, map->key) == 0) k = i;
    if (k < 0) return;
    shape->kind = kinds[k].kind;
    if (shape->kind >= BRUNT_UNION) {
        fill_children(reader, map, shape);
        return;
    }
    brunt_vector_of(map, "center", shape->center);
    brunt_vector_of(map, "axis", shape->axis);
    shape->radius = brunt_real_of(map, "radius", 0);
    shape->inner_radius = brunt_real_of(map, "inner_radius", 0);
    shape->length = brunt_real_of(map, "length", 0);
    switch (shape->kind) {
    case BRUNT_BOX: fill_box(reader, map, shape); break;
    case BRUNT_PRISM: fill_polygon(reader, map, shape); break;
    case BRUNT_HALF_SPACE:
        brunt_vector_of(map, "point", shape->center);
        brunt_vector_of(map, "normal", shape->axis);
        complain_zero(reader, map, "normal", "the normal");
        break;
    case BRUNT_TUBE:
        if (shape->inner_radius > 0 && shape->radius > 0 && !(shape->inner_radius < shape->radius))
            brunt_tree_complain(reader->tree, brunt_tree_child(map, "inner_radius"),
                                "inner_radius must be below radius");
        complain_zero(reader, map, "axis", "the axis");
        break;
    default: complain_zero(reader, map, "axis", "the axis"); break;
    }
}

brunt_placement brunt_fill_placement(scene_reader *reader, const scene_node *list) {
    brunt_placement place = brunt_placement_identity();
    if (!list || list->kind != SCENE_LIST) return place;
    for (const scene_node *entry = list->first; entry; entry = entry->next) {
        const scene_node *turn = brunt_tree_child(entry, "rotate"), *shift = brunt_tree_child(entry, "translate");
        if (entry->kind != SCENE_MAP) continue;
        if (!turn == !shift) {
            brunt_tree_complain(reader->tree, entry, "exactly one of translate and rotate is wanted in each entry");
            continue;
        }
        double by[3] = {0}, axis[3] = {0, 0, 1}, about[3] = {0};
        if (shift && brunt_vector_of(entry, "translate", by)) place = brunt_placement_translate(place, by);
        if (!turn) continue;
        complain_zero(reader, turn, "axis", "the axis");
        brunt_vector_of(turn, "axis", axis);
        brunt_vector_of(turn, "about", about);
        double length = fabs(axis[0]) + fabs(axis[1]) + fabs(axis[2]), angle = brunt_real_of(turn, "angle", 0);
        if (length > 0) place = brunt_placement_rotate(place, axis, angle, about);
    }
    return place;
}
