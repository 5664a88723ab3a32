// Rotors: material points within a cylinder about an axis turn about it, at a rate that does not change.
#include <math.h>

#include "boundary/kinds.h"

enum { POINT = 0, AXIS = 3, RADIUS = 6, RATE = 7 };

// clang-format off
static const brunt_boundary_key keys[] = {
    {BRUNT_VALUE_VECTOR, POINT, 0, {"point", "m", NAN, -INFINITY, INFINITY, true, true, "a point of its axis"}, NULL},
    {BRUNT_VALUE_VECTOR, AXIS, 3, {"axis", "1", NAN, -INFINITY, INFINITY, true, true, "direction of its axis"}, NULL},
    {BRUNT_VALUE_NUMBER, RADIUS, 0, {"radius", "m", NAN, 0, INFINITY, true, true, "distance from the axis up to which it holds"}, NULL},
    {BRUNT_VALUE_NUMBER, RATE, 0, {"rate", "rad/s", NAN, -INFINITY, INFINITY, true, true, "right-handed; in 2D counter-clockwise"}, NULL},
};
// clang-format on

static const char *refusal(const brunt_world_def *def, const void *one, const char **key) {
    const double *axis = ((const brunt_boundary_def *)one)->number + AXIS;
    *key = ".rotor";
    if (def->axisymmetric) return "rings do not turn in their plane";
    *key = ".rotor.axis";
    return def->dimension == 3 && !(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2] > 0)
               ? "the axis has zero length"
               : NULL;
}

// v = rate axis x (x - point). A node turns about where it is, so that material holds its shape to the order of a step.
static unsigned hold_at(const brunt_boundary *b, int dim, double time, const double x[3], double tolerance,
                        double v[3]) {
    (void)time;
    const double *number = b->given.number;
    double axis[3] = {0, 0, 1}, r[3] = {0}, along = 0, length = 0, square = 0;
    for (int a = 0; a < 3; a++) axis[a] = dim == 3 ? number[AXIS + a] : axis[a];
    for (int a = 0; a < 3; a++) length += axis[a] * axis[a];
    for (int a = 0; a < 3; a++) axis[a] /= sqrt(length);
    for (int a = 0; a < dim; a++) r[a] = x[a] - number[POINT + a], along += r[a] * axis[a];
    for (int a = 0; a < dim; a++) square += (r[a] - along * axis[a]) * (r[a] - along * axis[a]);
    if (sqrt(square) > number[RADIUS] + tolerance) return 0;
    for (int a = 0; a < dim; a++)
        v[a] = number[RATE] * (axis[(a + 1) % 3] * r[(a + 2) % 3] - axis[(a + 2) % 3] * r[(a + 1) % 3]);
    return (1u << dim) - 1;
}

const brunt_boundary_kind brunt_kind_rotor = {
    BRUNT_LISTED_ROW("rotor", "material points within a cylinder turn about its axis; acts on bodies of method mpm",
                     keys),
    .refusal = refusal,
    .hold_at = hold_at,
};
