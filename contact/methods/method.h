// Methods of contact between bodies: a row each, in list.c. Scene reader and world ask here which bodies may meet how,
// and the step lets those rows act that a world has pairs for, in their order.
#pragma once

#include "contact/constraint/constraint.h"
#include "contact/methods/augury.h"
#include "contact/methods/gap_energy.h"
#include "contact/methods/grid_velocity.h"
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
    void *memory; // what the row that acts keeps, which it may make or move; NULL before it does so first
} brunt_contact_work;

// Which bodies may be in contact with themselves by a method.
typedef enum brunt_contact_self { BRUNT_SELF_NONE, BRUNT_SELF_MEMBRANES, BRUNT_SELF_MESHES } brunt_contact_self;

typedef struct brunt_contact_row {
    const char *name;
    unsigned methods; // bits of brunt_contact_method by which scenes ask for it
    unsigned forms;   // bits of brunt_augury_form, where that is the method; else 0
    unsigned schemes; // bits of brunt_scheme that have it
    brunt_contact_self self;
    bool at_nodes; // of the grid of material points
    // What it wants of two bodies, after "wants"; NULL: another row of the method says it.
    const char *wants;
    // Whether two bodies, of elements (else of material points), may meet by it.
    bool (*accepts)(bool mesh_a, bool mesh_b);
    // Marks surfaces as near something beside those that the broad phase marks; NULL: none.
    void (*near)(const brunt_contact_context *m);
    // Changes the velocities of surfaces and grids; NULL: it has a pass of its own. BRUNT_OK, or BRUNT_FAILED.
    int (*act)(const brunt_contact_context *m, brunt_contact_work *work, brunt_error *error);
    // Accounts and contact state, once all else has acted; NULL: with act.
    void (*account)(const brunt_contact_context *m, const brunt_contact_work *work);
    // Frees what it keeps, which may be NULL.
    void (*free)(void *memory);
    // Aborts where what it keeps is not as it must be; never of NULL. NULL: it keeps room alone, made anew in each
    // step.
    void (*validate)(const void *memory);
    // Of two bodies of material points, at a node of their grids that both reach: in place of pushes and friction there
    // (grid_velocity.c). Implicit steps that have the method give such bodies one displacement there. NULL: none.
    brunt_node_law *at_node;
    // Of implicit steps: a term of what they minimise, made of the gaps of all that meets (contact/barrier). NULL:
    // none.
    brunt_gap_energy *energy;
} brunt_contact_row;

extern const brunt_contact_row *const brunt_contact_rows[];
extern const int brunt_contact_row_count; // at most BRUNT_CONTACT_ROW_LIMIT

// Whether two bodies may meet by a method, whichever of its rows that is.
bool brunt_contact_accepts(brunt_contact_method method, bool mesh_a, bool mesh_b);
// Bits of the rows by which they do.
unsigned brunt_contact_rows_of(brunt_contact_method method, brunt_augury_form form, bool mesh_a, bool mesh_b);
// The method by which two bodies of material points meet where that of all is `method`: itself, where it accepts them.
// Where augury has no form of its own for them, and between rings, it is multi-velocity.
brunt_contact_method brunt_contact_between_points(brunt_contact_method method, brunt_augury_form form, bool rings);
// Whether a method acts at the nodes of the grid of material points.
bool brunt_contact_at_nodes(brunt_contact_method method);
// What scenes call a method, and what it wants of two bodies.
const char *brunt_contact_word(brunt_contact_method method);
const char *brunt_contact_wants(brunt_contact_method method);
extern const int brunt_contact_method_count;
// The method of a scheme for all pairs of a scene that gives none, with bodies that are meshes or without: that of the
// first row which takes two of them. Implicit steps have none for material points alone, and take that of meshes.
brunt_contact_method brunt_contact_default(brunt_scheme scheme, bool meshes);
// Whether a scheme has a method, none included, and the words of all that it has: "barrier, tied or none".
bool brunt_contact_of_scheme(brunt_contact_method method, brunt_scheme scheme);
void brunt_contact_words_of(brunt_scheme scheme, char *out, size_t size);
// What a method does at nodes, and its energy; NULL: none.
brunt_node_law *brunt_contact_node_law(brunt_contact_method method);
brunt_gap_energy *brunt_contact_energy(brunt_contact_method method);
brunt_contact_self brunt_contact_with_itself(brunt_contact_method method);
// Aborts where a row keeps something that `rows` has no bit of, or what it keeps is not as it must be. `memory`: of
// each.
void brunt_contact_methods_validate(unsigned rows, void *const memory[]);
