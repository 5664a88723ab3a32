// The bodies of a world, in order of name, whatever they are made of.
#pragma once

#include "fem/fem_body.h"
#include "grid/background.h"
#include "mpm/mpm_body.h"
#include "mpm/audit.h"

typedef struct brunt_body_ops brunt_body_ops;

// What is summed up of a body, or of a part of it.
typedef struct brunt_body_measure {
    brunt_audit sums;
    brunt_point_energy energy;
    double low[3], high[3]; // [m] INFINITY and less: nothing is left
} brunt_body_measure;

typedef struct brunt_body_ref {
    const brunt_body_ops *ops;
    brunt_body *mpm; // one of the two, the other is NULL
    brunt_fem_body *fem;
} brunt_body_ref;

// What can be asked of a body, whatever it is made of: a table each for points and meshes.
struct brunt_body_ops {
    // Into how many parts it is summed up, at least 1: by how large it is alone, so that sums are the same for any
    // number of threads, and after a restart. And one of them.
    int32_t (*parts)(const brunt_body_ref *body);
    void (*measure)(const brunt_body_ref *body, int32_t part, brunt_body_measure *measure);
    uint64_t (*hash)(const brunt_body_ref *body); // to be added to that of the others
    const char *(*name)(const brunt_body_ref *body);
    const brunt_material *(*material)(const brunt_body_ref *body);
    brunt_method (*method)(const brunt_body_ref *body);
    int (*dim)(const brunt_body_ref *body);
    // How fine it is [m]: the spacing of its points, the mean edge of its surface.
    double (*fineness)(const brunt_body_ref *body);
    // Places of a kind that it still has.
    int64_t (*count)(const brunt_body_ref *body, brunt_location at);
    // Longest stable step [s] by what its blocks have reported, in cells of `cell` [m] and beside what moves at
    // `around` [m/s], with loads that follow its surface at a frequency of squared `load` [1/s^2]. INFINITY: nothing is
    // left, NAN: a report is no number. And as of its start, when nothing is left.
    double (*stable_step)(const brunt_body_ref *body, double cell, double around, double load);
    double (*first_step)(const brunt_body_ref *body, double cell);
    // What a wave takes [s] through a mean element or a cell of it, undeformed.
    double (*transit)(const brunt_body_ref *body, double cell);
    // Fields that can be read: how many, what they are, and the values of one in the order of the ids of their places.
    int32_t (*field_count)(const brunt_body_ref *body);
    brunt_field_info (*field)(const brunt_body_ref *body, int32_t field);
    void (*read)(const brunt_body_ref *body, int32_t field, double *out);
    void (*validate)(const brunt_body_ref *body);
    // Blocks of its state, in their order: how many; what they are; out, and in. What follows from them is made later.
    int (*block_count)(const brunt_body_ref *body);
    brunt_state_block (*block_info)(const brunt_body_ref *body, int block);
    void (*block_get)(const brunt_body_ref *body, int block, void *out);
    int (*block_set)(const brunt_body_ref *body, int block, const void *in, int64_t count, brunt_error *error);
};
extern const brunt_body_ops brunt_points_ops, brunt_mesh_ops;

// A run of nodes or a block of elements of one of the finite-element bodies: a task.
typedef struct brunt_fem_task {
    int32_t fem, begin, end;
} brunt_fem_task;

typedef struct brunt_fem_tasks {
    brunt_fem_task *node, *element;
    int64_t node_count, element_count;
    brunt_fem_sums *sums; // a node task each
} brunt_fem_tasks;

// A part of what is summed up.
typedef struct brunt_body_part {
    int32_t body, part; // its number among those of the body
    brunt_body_measure measure;
} brunt_body_part;

typedef struct brunt_bodies {
    brunt_body_ref *all; // in order of name
    int count;
    brunt_body *mpm; // of material points, in the same order
    int mpm_count;
    brunt_fem_body *fem; // of elements, likewise
    int fem_count;
    brunt_mesh_report *mesh_reports; // a finite-element body each
    brunt_body_measure *measure;     // of each, while they are `measured`
    brunt_body_part *part;           // of all, in order
    size_t measure_capacity, part_capacity;
    bool measured;
    brunt_fem_tasks tasks;
    // Of each body its first block of the state and its first array; past the last how many they all have.
    int32_t *first_block, *first_array;
    bool has_particles, has_fluid;
    brunt_background background; // the mesh that all grids are of; without nodes: they are lattices
} brunt_bodies;

// The arrays of each are its fields, and this many more.
enum { BRUNT_BODY_ARRAYS = 2 };

const char *brunt_bodies_name(const brunt_bodies *bodies, int body);
const brunt_material *brunt_bodies_material(const brunt_bodies *bodies, int body);
// Meshes first .. end are those of a body by its number among all; of -1: all. Of material points likewise.
void brunt_bodies_meshes(const brunt_bodies *bodies, int body, int *first, int *end);
void brunt_bodies_points(const brunt_bodies *bodies, int body, int *first, int *end);
// The body of a name, BRUNT_NONE: there is none.
int brunt_bodies_find(const brunt_bodies *bodies, const char *name);
// Body `i` in the order that sums are taken in: points, then meshes, each by name.
brunt_body_ref *brunt_bodies_summed(const brunt_bodies *bodies, int i);
// Sums up all of them, by `threads` threads, for what is asked until brunt_bodies_forget: meanwhile nothing may change.
// Where there is no memory for it, each is summed up when it is asked for, with the same result.
void brunt_bodies_measure(brunt_bodies *bodies, int threads);
void brunt_bodies_forget(brunt_bodies *bodies);
// The measure of one of them.
brunt_body_measure brunt_bodies_measure_of(const brunt_bodies *bodies, const brunt_body_ref *body);
// The same of a body by itself.
brunt_body_measure brunt_body_measure_of(const brunt_body_ref *body);
// Numbers the blocks and the arrays of all, once their fields are there. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_bodies_number(brunt_bodies *bodies, brunt_error *error);
// The body that block or array `index` is of, by where each begins; `count`, that of the bodies: of none.
int brunt_bodies_holding(const brunt_bodies *bodies, const int32_t *first, int32_t index);
// Made of a definition in world/bodies.c; their state is in blocks of their own (ops).
void brunt_bodies_free(brunt_bodies *bodies);
// Aborts where a body is not in its order, or what it is made of not as it must be.
void brunt_bodies_validate(const brunt_bodies *bodies);
