// Room that passes work in: nothing in it lasts from one to the next.
#pragma once

#include "contact/methods/grid_velocity.h"
#include "contact/search/point_touch.h"
#include "fem/fem_body.h"
#include "mpm/transfer.h"

typedef struct brunt_node_sums {
    double old_kinetic, new_kinetic, mass, first_moment[3], gravity_work, stress_work;
} brunt_node_sums;

typedef struct brunt_scratch {
    brunt_workspace *points;     // a thread each
    brunt_fem_workspace *meshes; // a thread each
    brunt_particle_dofs planes;  // of a body of material points at planes that push
    brunt_contact_workspace *grid_velocity;
    brunt_point_touches *point_touches;
    brunt_node_sums *node_sums; // of the slots of one grid
    size_t node_sums_capacity;
    double *own_momenta; // of the nodes of one grid, three each: where points keep a share beside symmetry planes
    size_t own_momenta_capacity;
} brunt_scratch;

// Room for as many threads; all else is made where it is first wanted. No state: nothing in it lasts. BRUNT_OK, or
// BRUNT_FAILED: out of memory.
int brunt_scratch_make(brunt_scratch *scratch, int threads, brunt_error *error);
void brunt_scratch_free(brunt_scratch *scratch, int threads);
// Aborts where there is memory without a capacity, or more is in it than it holds.
void brunt_scratch_validate(const brunt_scratch *scratch, int threads);
