// Fields that follow from what material points and elements both have at a point: a file each, field_NAME.c, which is
// all there is to add to the list.
#pragma once

#include "body/bodies.h"

// In the order of output.
#define BRUNT_DERIVED_FIELDS(X)                                                                                        \
    X(pressure)                                                                                                        \
    X(von_mises)

typedef struct brunt_point_values {
    double F[9], J, stress[6], volume, density; // Cauchy's [Pa], [m^3], [kg/m^3]; of membranes F is the stretch U in
                                                // its plane, and that across
} brunt_point_values;

typedef struct brunt_derived_field {
    const char *name, *unit;
    int components;
    bool symmetric; // six components of a tensor
    void (*read)(const brunt_point_values *at, double *out);
} brunt_derived_field;

#define BRUNT_DECLARE_FIELD(name) extern const brunt_derived_field brunt_field_##name;
BRUNT_DERIVED_FIELDS(BRUNT_DECLARE_FIELD)
#undef BRUNT_DECLARE_FIELD

// What a row of a table of fields says of itself: `own`, or what the file of a derived one says.
static inline brunt_field_info brunt_field_info_of(const brunt_derived_field *derived, brunt_field_info own,
                                                   brunt_location at) {
    if (!derived) return own;
    return (brunt_field_info){derived->name, derived->unit, derived->components, derived->symmetric, at};
}
