// Methods of contact between bodies: a row each, in list.c. Scene reader and world ask here which bodies may meet how,
// and the step lets those rows act that a world has pairs for, in their order.
#pragma once

#include "contact/constraint/constraint.h"
#include "contact/methods/augury.h"
#include "contact/methods/surface_on_grid.h"
#include "contact/search/node_to_facet.h"

// What methods keep from step to step, and how a scene wants them.
typedef struct brunt_contact_work {
    const brunt_contact_def *def;
    int grid_sweeps; // of meshes on the points' grid
    int sweeps;      // over constraints at facets and planes
    bool facets;     // there are pairs that meet at facets; else planes alone
    brunt_constraint_set *constraints;
    brunt_node_to_facet **node_to_facet;
    brunt_augury_workspace **augury;
    brunt_surface_on_grid **surface_on_grid;
} brunt_contact_work;

typedef struct brunt_contact_row {
    const char *name;
    unsigned methods; // bits of brunt_contact_method by which scenes ask for it
    unsigned forms;   // bits of brunt_augury_form, where that is the method; else 0
    // Whether two bodies, of elements (else of material points), may meet by it.
    bool (*accepts)(bool mesh_a, bool mesh_b);
    // Marks surfaces as near something beside those that the broad phase marks; NULL: none.
    void (*near)(const brunt_contact_context *m);
    // Changes the velocities of surfaces and grids; NULL: it has a pass of its own. 0, or -1: out of memory.
    int (*act)(const brunt_contact_context *m, const brunt_contact_work *work);
    // Accounts and contact state, once all else has acted; NULL: with act.
    void (*account)(const brunt_contact_context *m, const brunt_contact_work *work);
} brunt_contact_row;

enum { BRUNT_CONTACT_ROWS = 6 };
extern const brunt_contact_row brunt_contact_rows[BRUNT_CONTACT_ROWS];

// Whether two bodies may meet by a method, whichever of its rows that is.
bool brunt_contact_accepts(brunt_contact_method method, bool mesh_a, bool mesh_b);
