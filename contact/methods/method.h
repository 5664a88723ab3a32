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
    bool facets;     // there are pairs that meet by the row; else planes alone
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
    unsigned meets; // bits of brunt_contact_place: where two bodies are looked for that meet by it; 0: it looks itself
    const char *keys; // of `contact` in a scene that are its own, "a b c"; NULL: none
    brunt_contact_self self;
    bool never_axisymmetric; // not in axisymmetric scenes
    bool planar;             // in two dimensions alone
    bool overlaps;           // of an energy: surfaces may overlap, gaps have a sign
    bool sides;              // of two meshes either may be the slave alone
    // Of what meets at facets.
    bool knows_membranes;        // it knows the two sides of a membrane
    bool planes;                 // it acts where there are planes alone, too
    bool near_alone;             // of surfaces it asks for what is near other bodies alone
    bool affine;                 // it acts on every surface, touched or not, and keeps affine velocities of nodes
    int sweeps, membrane_sweeps; // most of a step by default; where there are membranes, 0: the same
    double cell_factor;          // cell of the contact grid by default, in mean edges
    double look;                 // cells of that grid that it looks ahead; 0: it has none
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
// Bits of the rows by which they do, where these meet, and the first of them that meets at a place; NULL: none.
unsigned brunt_contact_rows_of(brunt_contact_method method, brunt_augury_form form, bool mesh_a, bool mesh_b);
unsigned brunt_contact_places_of(unsigned rows);
const brunt_contact_row *brunt_contact_row_at(unsigned rows, brunt_contact_place place);
// The method by which two bodies of material points meet where that of all is `method`: itself, where it accepts them.
// Where its form has no row for them, or none for rings, it is multi-velocity.
brunt_contact_method brunt_contact_between_points(brunt_contact_method method, brunt_augury_form form,
                                                  bool axisymmetric);
// Whether a row is for a method, and for a form of it.
bool brunt_contact_is_of(const brunt_contact_row *row, brunt_contact_method method);
bool brunt_contact_has_form(const brunt_contact_row *row, brunt_augury_form form);
bool brunt_contact_has_key(const brunt_contact_row *row, const char *key);
// What scenes call a method, and what it wants of two bodies.
const char *brunt_contact_word(brunt_contact_method method);
const char *brunt_contact_wants(brunt_contact_method method);
extern const int brunt_contact_method_count, brunt_augury_form_count;
// What scenes call a form, and those that rows have, joined: bits of brunt_augury_form, "a or b".
const char *brunt_augury_form_word(brunt_augury_form form);
void brunt_augury_words_of(unsigned forms, char *out, size_t size);
// Forms in which two bodies of material points may meet by a method, and membranes by any.
unsigned brunt_augury_forms_of_points(brunt_contact_method method);
unsigned brunt_augury_forms_of_membranes(void);
// The method of a scheme for all pairs of a scene that gives none, with bodies that are meshes or without: that of the
// first row which takes two of them. Implicit steps have none for material points alone, and take that of meshes.
brunt_contact_method brunt_contact_default(brunt_scheme scheme, bool meshes);
// Whether a scheme has a method, none included, and the words of all that it has: "barrier, tied or none".
bool brunt_contact_of_scheme(brunt_contact_method method, brunt_scheme scheme);
void brunt_contact_words_of(brunt_scheme scheme, char *out, size_t size);
// What a method does at nodes, and its energy; NULL: none.
brunt_node_law *brunt_contact_node_law(brunt_contact_method method);
brunt_gap_energy *brunt_contact_energy(brunt_contact_method method);
// Whether it is by a row that planes of condition separate push in implicit steps, where the method of all is `method`:
// that one's, or where it has no energy the barrier.
bool brunt_contact_pushes_planes(const brunt_contact_row *row, brunt_contact_method method);
// Whether surfaces may overlap by a method, and whether it is of two dimensions alone.
bool brunt_contact_overlaps(brunt_contact_method method);
bool brunt_contact_is_planar(brunt_contact_method method);
brunt_contact_self brunt_contact_with_itself(brunt_contact_method method);
// Whether one of two meshes may be the slave alone; what messages say of it.
bool brunt_contact_has_sides(brunt_contact_method method, brunt_augury_form form);
#define BRUNT_CONTACT_WITH_SIDES "augury, form node_to_facet,"
// Aborts where a row keeps something that `rows` has no bit of, or what it keeps is not as it must be. `memory`: of
// each.
void brunt_contact_methods_validate(unsigned rows, void *const memory[]);
// The first method of a scheme by which bodies may be in contact with themselves.
brunt_contact_method brunt_contact_of_self(brunt_scheme scheme);
