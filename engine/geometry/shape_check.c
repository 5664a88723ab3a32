#include "geometry/shape_check.h"

#include <math.h>

#include "base/check.h"
#include "base/error.h"

static const double RIGID = 1e-6; // how far a rotation may be off one
enum { SHAPES_DEEP = 64 };

#define REFUSE(...) return brunt_fail(error, BRUNT_BAD_INPUT, __VA_ARGS__)

int brunt_check_shape(const char *owner, const brunt_shape *shape, int dim, int depth, brunt_error *error) {
    BRUNT_TRY(brunt_check_choice(owner, ".shape", (unsigned)shape->kind, BRUNT_INTERSECTION + 1, error));
    if (depth > SHAPES_DEEP) REFUSE("%s.shape: shapes of shapes, more than %d deep", owner, SHAPES_DEEP);
    if (shape->kind >= BRUNT_UNION) {
        BRUNT_TRY(brunt_check_array(owner, shape->child_count, shape->children, error));
        if (!shape->child_count) REFUSE("%s.shape: a union, difference or intersection of nothing", owner);
        for (int32_t c = 0; c < shape->child_count; c++)
            BRUNT_TRY(brunt_check_shape(owner, &shape->children[c], dim, depth + 1, error));
        return BRUNT_OK;
    }
    const bool box = shape->kind == BRUNT_BOX, prism = shape->kind == BRUNT_PRISM,
               plane = shape->kind == BRUNT_HALF_SPACE, ball = shape->kind == BRUNT_SPHERE,
               tube = shape->kind == BRUNT_TUBE, axial = plane || shape->kind == BRUNT_CYLINDER || (tube && dim == 3);
    const int centred = box || prism ? 0 : dim, whole = box ? dim : 0, high = prism && dim == 3;
    BRUNT_CHECK_NUMBERS(owner, {".shape: min", shape->min, whole, BRUNT_ANY_NUMBER},
                        {".shape: max", shape->max, whole, BRUNT_ANY_NUMBER},
                        {".shape: min", shape->min + 2, high, BRUNT_ANY_NUMBER},
                        {".shape: max", shape->max + 2, high, BRUNT_ANY_NUMBER},
                        {".shape: center", shape->center, centred, BRUNT_ANY_NUMBER},
                        {".shape: axis", shape->axis, axial ? dim : 0, BRUNT_ANY_NUMBER},
                        {".shape: radius", &shape->radius, centred && !plane, BRUNT_POSITIVE},
                        {".shape: inner_radius", &shape->inner_radius, tube, BRUNT_POSITIVE},
                        {".shape: length", &shape->length, axial && !plane && !ball, BRUNT_POSITIVE});
    bool direction = !axial;
    for (int a = 0; a < dim; a++) direction = direction || shape->axis[a] != 0;
    if (!direction) REFUSE("%s.shape: the axis has no direction", owner);
    if (!prism) return BRUNT_OK;
    BRUNT_TRY(brunt_check_array(owner, shape->point_count, shape->points, error));
    if (shape->point_count < 3) REFUSE("%s.shape: a polygon of %d corners", owner, shape->point_count);
    for (int32_t k = 0; k < shape->point_count; k++)
        BRUNT_CHECK_NUMBERS(owner, {".shape: points", shape->points[k], 2, BRUNT_ANY_NUMBER});
    return BRUNT_OK;
}

int brunt_check_placement(const char *owner, const brunt_placement *place, brunt_error *error) {
    const double *R = place->rotation;
    BRUNT_CHECK_NUMBERS(owner, {".place", R, 9, BRUNT_ANY_NUMBER}, {".place", place->translation, 3, BRUNT_ANY_NUMBER});
    double off = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int c = 0; c < 3; c++) sum += R[3 * i + c] * R[3 * k + c];
            off = fmax(off, fabs(sum - (i == k)));
        }
    if (off > RIGID) REFUSE("%s.place: this is no rotation (brunt_placement_identity makes one)", owner);
    return BRUNT_OK;
}
