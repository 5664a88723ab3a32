// A scene: the world's definition and everything a run adds to it. Read from YAML, checked, with units, all mistakes at
// once.
#pragma once

#include <stdio.h>

#include "brunt.h"

// Kinds of measures, one line each: the key that chooses it. The rest of a kind is in io/output/measure_NAME.c.
#define BRUNT_MEASURE_KINDS(X)                                                                                         \
    X(HISTORY, history) /* a column of the history (`history: energy.kinetic`), reduced over time */                   \
    X(EXTENT, extent)   /* size of a body along an axis, from particle surfaces or nodes, at the end */                \
    X(RADIUS, radius)   /* greatest distance of a body's surface from an axis line within a slab, at the end */        \
    X(TWIST, twist)     /* how far the material of a body about an axis line has turned, at the end */                 \
    X(FIELD, field)     /* a field of a body reduced over its particles, nodes or elements, at the end */              \
    X(PROFILE, profile) /* distance of a field of one body or all from a reference along an axis, at the end */

// A named result, judged against an expectation where one is given.
typedef enum brunt_measure_kind {
#define X(NAME, name) BRUNT_MEASURE_##NAME,
    BRUNT_MEASURE_KINDS(X)
#undef X
} brunt_measure_kind;

typedef enum brunt_take {
    BRUNT_TAKE_END,
    BRUNT_TAKE_INITIAL,
    BRUNT_TAKE_MIN,
    BRUNT_TAKE_MAX,
    BRUNT_TAKE_MEAN,
    BRUNT_TAKE_SLOPE,         // least-squares slope over from..to
    BRUNT_TAKE_FIRST_NONZERO, // time of the first sample that is not zero
    BRUNT_TAKE_LAST_NONZERO,
    BRUNT_TAKE_MAX_ABS,
    BRUNT_TAKE_PERIOD, // mean time between the rises through the middle of what it varies in
    BRUNT_TAKE_RISE    // [s] when it first passes half of its greatest value
} brunt_take;

typedef struct brunt_measure {
    char name[64];
    brunt_measure_kind kind;
    char column[160];    // history: column name without unit, e.g. "body.rod.velocity_x"
    bool absent;         // history: the scheme has no such column; its value is NAN, and nothing judges it
    brunt_take take;     // how it is reduced; default end
    double from, to;     // [s] window of the history, default everything, or the curve's times
    brunt_curve curve;   // history: its distance from this [s], [SI], over the curve's range, is reduced; no points:
                         // none. profile: the reference [m], [SI]. Owned
    char curve_unit[64]; // SI unit its values were given in; "": none was
    char body[BRUNT_NAME_LENGTH]; // profile: "" = all bodies with the field
    char field[64];
    int component;             // field: name, component (-1: scalar or magnitude)
    double axis[3], center[3]; // extent: axis; radius, twist: axis line through center
    double within;             // [m] twist: only what is no farther from the axis; default all
    double slab_min, slab_max; // [m] radius, twist, field: only what has its coordinate along axis inside; default all
    bool relative_to_initial;  // divide by the value at the first sample
    double relative_to;        // divide by this (NAN: no)
    double minus;              // subtract this first (default 0)
    char minus_unit[64], relative_unit[64]; // SI units the two were given in; "": none was
    double expect, tolerance;               // NAN: none; tolerance is relative to expect ...
    bool absolute;                          // ... or absolute (`tolerance: 0.1 mm` with `tolerance_is: absolute`)
    char unit[32];                          // of the value, as printed
    char source[256];                       // where the reference is from
} brunt_measure;

// Probe: a field of the particle, node or element (where the field lives) of a body that is nearest to a point at the
// start, written to the history.
typedef struct brunt_probe {
    char name[64], body[BRUNT_NAME_LENGTH];
    double point[3];
    char field[64];
} brunt_probe;

typedef struct brunt_output_def {
    double every;        // [s] between pictures (VTU); 0 = first and last only; INFINITY = none
    double history;      // [s] between history lines; 0 = every step
    double force_window; // [s] over which forces are means; 0: the step; INFINITY: by the bodies' elements
    double checkpoint;   // [s of wall time] between checkpoints; 0 = every picture; INFINITY = only at the end and on
                         // signals
    char (*fields)[64];
    int32_t field_count; // owned; what pictures hold besides id; "default": what the body's method always shows
    bool float32;        // pictures in single precision; default true
    bool tractions;      // tractions.csv at the end
    brunt_probe *probes;
    int32_t probe_count; // owned
} brunt_output_def;

typedef struct brunt_scene {
    char name[128]; // file name without folder and ending
    char title[256];
    char source[1024]; // path it was read from
    brunt_world_def world;
    brunt_output_def output;
    brunt_measure *measures;
    int32_t measure_count; // owned
    char *warnings;        // doubts about it, one a line; NULL: none. Owned, of the C library
    void *resolved;        // opaque: for brunt_scene_write
} brunt_scene;

// Reads and checks. `sets`: "path.to.key=value" overrides, applied before checking. On failure returns BRUNT_BAD_INPUT
// or BRUNT_IO_ERROR and writes every mistake, one a line ("file:line:column: path: what was wrong, what was wanted"),
// to `messages` (may be NULL).
int brunt_scene_read(const char *path, const char *const *sets, int set_count, brunt_scene *scene, FILE *messages);
// The same from memory; `name` stands for the file in messages.
int brunt_scene_parse(const char *text, size_t length, const char *name, const char *const *sets, int set_count,
                      brunt_scene *scene, FILE *messages);
void brunt_scene_free(brunt_scene *scene);

// A mistake found later, "bodies.rod.size: ...", with the place in the file (or the override) of the longest part of
// its path that is there: "file:line:column: bodies.rod.size: ...".
void brunt_scene_complain(const brunt_scene *scene, const char *message, FILE *out);

// The scene as resolved: every default filled in but methods of contact, SI units. It reads back to the same scene. Of
// methods that are not given each scheme has its own; keys of the other scheme stay, so that it can be run by that.
int brunt_scene_write(const brunt_scene *scene, FILE *out);
// Defaults that the bodies decide: of barriers the distance, the slip speed of what rubs, and the stiffness, where all
// pairs and planes have the same. Written from then on; the world is that of the scene.
int brunt_scene_take_values(const brunt_scene *scene, const brunt_world *world, brunt_error *error);
// The reference of all keys, made from the table that parses them. `section` NULL: all. False when there is no such
// section.
bool brunt_scene_keys(const char *section, FILE *out);
// JSON Schema of scene files, for editors; from the same table.
void brunt_scene_schema(FILE *out);
