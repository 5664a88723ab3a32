// The bodies of a world, in order of name, whatever they are made of.
#pragma once

#include "fem/fem_body.h"
#include "mpm/mpm_body.h"

typedef struct brunt_body_ref {
    brunt_body *mpm; // one of the two, the other is NULL
    brunt_fem_body *fem;
} brunt_body_ref;

// A run of nodes or a block of elements of one of the finite-element bodies: a task.
typedef struct brunt_fem_task {
    int32_t fem, begin, end;
} brunt_fem_task;

typedef struct brunt_fem_tasks {
    brunt_fem_task *node, *element;
    int64_t node_count, element_count;
    brunt_fem_sums *sums; // a node task each
} brunt_fem_tasks;

typedef struct brunt_bodies {
    brunt_body_ref *all; // in order of name
    int count;
    brunt_body *mpm; // of material points, in the same order
    int mpm_count;
    brunt_fem_body *fem; // of elements, likewise
    int fem_count;
    brunt_mesh_report *mesh_reports; // a finite-element body each
    brunt_fem_tasks tasks;
    bool has_particles, has_fluid;
} brunt_bodies;

const char *brunt_bodies_name(const brunt_bodies *bodies, int body);
