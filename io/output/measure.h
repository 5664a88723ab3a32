// What the kinds of measures share. Private to measure*.c.
#pragma once

#include "io/output/history.h"
#include "io/scene/scene.h"
#include "io/scene/units.h"

// What a measure looks at.
typedef struct measure_source {
    const brunt_history *history;
    brunt_world *world;
    brunt_units *units;
    double initial; // value of the measure at the start, NAN: not known; histories know their own
} measure_source;

// One for each kind of the list in scene.h.
typedef struct measure_kind {
    // Whether the run can give it, beside taking it at the start; NULL: nothing else is to be checked.
    int (*check)(const brunt_measure *measure, const measure_source *from, brunt_error *error);
    // The SI unit of what it is taken from; NULL, or none given: what units are said is not looked at.
    const char *(*unit)(const brunt_measure *measure, const measure_source *from);
    // Its value, NAN when there is nothing to take it from. `from->initial` may be set.
    int (*take)(const brunt_measure *measure, measure_source *from, double *value, brunt_error *error);
} measure_kind;

#define X(NAME, name) extern const measure_kind measure_##name;
BRUNT_MEASURE_KINDS(X)
#undef X
const measure_kind *measure_kind_of(const brunt_measure *measure);

// What a measure looks at: particles, nodes or elements.
typedef struct point_set {
    int64_t count;
    int dimension;
    double *position, *values;
    double *gradient, *volume; // of particles, for their size; nodes have none
    bool axisymmetric;         // about the axis x = 0, as long as they are there
    double *integrity;         // of particles that may fail and stay; else NULL
    double *change;            // J of rings whose field is averaged, by the volume that each had; else NULL
    int components;
} point_set;

// Places of a body, and its field when the measure is of one; or what the size of particles is made of. To be freed.
int measure_read_points(const brunt_measure *m, brunt_world *world, int32_t body, point_set *set, brunt_error *error);
void measure_free_points(point_set *set);
// Of the one body of the measure. A number for a set of points comes of `reduce`.
int measure_take_points(const brunt_measure *m, brunt_world *world,
                        double (*reduce)(const brunt_measure *, const point_set *), double *value, brunt_error *error);
// Half the size of particle p along a unit direction n: a lattice cell of edge s deforms with F, and |F^T n| is the
// stretch of what now lies along n. s from the reference volume (volume / det F); of a ring from that of its section,
// which F stretches in its plane alone. What has failed has a volume and no shape: it resists no shear, so that F is as
// the motion about it has happened to draw it out. A node lies on the surface itself.
double measure_half_size(const point_set *set, int64_t p, const double n[3]);
// False: the measure has no axis, and `axis` is 0.
bool measure_unit_axis(const brunt_measure *m, double axis[3]);
// The component of a field that a measure asks for, or its magnitude.
double measure_value(const brunt_measure *m, const point_set *set, int64_t p);
// Whether two units are the same in SI base units, as m/s and m.s-1 are.
bool measure_same_unit(brunt_units *units, const char *one, const char *other);
// Whether `minus` can be subtracted, and the value has the unit that is said. BRUNT_OK or BRUNT_BAD_INPUT.
int measure_check_units(const brunt_measure *measure, const measure_source *from, brunt_error *error);
