// What acts from outside: a plane, a region, or a group of nodes of meshes, and what it has done; and what a kind of
// them is asked for.
#pragma once

#include "brunt.h"
#include "contact/constraint/constraint.h"
#include "contact/contact.h"
#include "materials/material.h"

typedef struct brunt_boundary_kind brunt_boundary_kind;
typedef struct brunt_boundary_lists brunt_boundary_lists; // planes/boundary_lists.h
typedef struct brunt_held_grid brunt_held_grid;           // planes/grid_conditions.h
typedef struct brunt_node_to_facet brunt_node_to_facet;   // search/node_to_facet.h
typedef struct brunt_particle_dofs brunt_particle_dofs;   // search/particle_dof.h

struct brunt_boundary {
    char name[BRUNT_NAME_LENGTH];
    const brunt_boundary_kind *kind;
    brunt_plane_def plane;                  // of a plane; normal of unit length
    brunt_region_def where;                 // of a region; shares the world's definition
    const brunt_group_def *group;           // of a group, NULL for the others
    brunt_boundary_def given;               // of a kind that lists its keys; shares the world's definition
    struct brunt_boundary_surface *surface; // of a line or mesh, of a plane that is in pieces
    bool in_pieces;                         // implicit steps: a plane that holds material points as those do
    int body;                               // the one it acts on, -1: all, or that of its group
    int symmetry_plane;                     // index of the symmetry plane it has become, -1
    brunt_impulse_account account;          // since the start
    brunt_impulse_account last;             // of the last step
};

// What makes boundaries of a definition.
typedef struct brunt_boundary_making {
    const brunt_world_def *def;
    struct brunt_boundaries *all; // boundary/boundaries.h
    struct brunt_messages *messages;
} brunt_boundary_making;

typedef enum brunt_boundary_value {
    BRUNT_VALUE_NUMBER,
    BRUNT_VALUE_VECTOR, // three numbers
    BRUNT_VALUE_WORD,   // one of `words`
    BRUNT_VALUE_SHAPE,  // one of a kind at most, and so of tables
    BRUNT_VALUE_TABLE
} brunt_boundary_value;

// A key of such a kind: a value, in scenes below the key of the kind.
typedef struct brunt_boundary_key {
    brunt_boundary_value is;
    int at;                   // of a number, vector or word: its place among the numbers of the definition
    int dimension;            // 2 or 3: it is there in that one only; 0: in both
    brunt_parameter in_scene; // numbers alone have a range; a word's default is a place in `words`
    const char *words;        // "a|b|c"
} brunt_boundary_key;

// A kind of boundary, a row of boundary/kinds.h. Its functions are in the file of the kind; NULL: nothing of that is
// its.
struct brunt_boundary_kind {
    const char *word; // "plane"
    bool is_plane;    // brunt_boundary.plane says where it is
    const char *doc;  // of a kind that lists its keys: what it does, and they; else NULL and none
    const brunt_boundary_key *keys;
    int key_count;
    // Of a definition: how many; the next entry from *at on, which becomes what is behind it, NULL: no more; the names
    // of an entry and of the one body it acts on (NULL: that of its nodes); frees all.
    int32_t (*count)(const brunt_boundary_kind *kind, const brunt_world_def *def);
    const void *(*next)(const brunt_boundary_kind *kind, const brunt_world_def *def, int32_t *at);
    const char *(*name)(const void *entry);
    const char *(*body)(const void *entry);
    void (*free)(brunt_world_def *def);
    // Looks an entry over, which is boundary `w` of all. BRUNT_OK, or BRUNT_BAD_INPUT.
    int (*check)(const brunt_world_def *def, const void *entry, int32_t w, brunt_error *error);
    // What the scheme cannot do of it, and the key that asks for that; NULL: it can do all.
    const char *(*refusal)(const brunt_world_def *def, const void *entry, const char **key);
    // Makes boundary `w` of its entry, named, with its body. BRUNT_OK, or what is wrong.
    int (*make)(const brunt_boundary_making *m, const void *entry, int w, brunt_error *error);
    // Of what moves by itself [m/s].
    const double *(*velocity)(const brunt_boundary *b);
    // Gives velocities to nodes of the grid of a body of material points.
    void (*hold_grid)(const brunt_held_grid *g, brunt_boundary *b, double time);
    // Implicit steps: the components (bits) of a node at x (within `tolerance` [m]) that it holds, and their velocity.
    unsigned (*hold_at)(const brunt_boundary *b, int dim, double time, const double x[3], double tolerance,
                        double v[3]);
    bool holds_meshes; // ... of meshes as well
    // Whether mesh k of the surface is near it, and what it does to the nodes of near ones: BRUNT_OK, or BRUNT_FAILED:
    // out of memory.
    bool (*near_surface)(const brunt_contact_surface *s, int k, const brunt_boundary *b, double time, double range);
    int (*meet_surface)(const brunt_contact_context *m, brunt_boundary *b, brunt_node_to_facet *f,
                        brunt_constraint_set *set, brunt_error *error);
    // Adds the constraints of the particles of a body that it would catch. BRUNT_OK, or BRUNT_FAILED: out of memory.
    int (*meet_points)(const brunt_contact_context *m, brunt_boundary *b, brunt_body *body, brunt_particle_dofs *dofs,
                       brunt_constraint_set *set, brunt_error *error);
    // ... and once they are solved, what they are read for; such boundaries are solved further.
    void (*met_points)(const brunt_contact_context *m, brunt_boundary *b, const brunt_body *body,
                       const brunt_constraint_set *set);
};

// Whether it acts on a body.
static inline bool brunt_boundary_acts_on(const brunt_boundary *b, int body) { return b->body < 0 || b->body == body; }
