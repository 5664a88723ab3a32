// What the files of multi-velocity contact with meshes share. Private to them; surface_on_grid.h says what it is about.
#pragma once

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "contact/constraint/coulomb.h"
#include "contact/distance/particle_extent.h"
#include "contact/distance/point_facet.h"
#include "contact/methods/surface_on_grid.h"
#include "contact/planes/symmetry.h"
#include "grid/bspline.h"
#include "mpm/mpm_body.h"

// What a surface node gives to a node of the grid, itself or, by a symmetry plane, its image.
typedef struct link {
    int32_t surface, contact;
    double weight;
    int8_t sign[3]; // of each component of its velocity
    bool own;       // not of an image
} link;

// A surface node at the grid of a body: its links.
typedef struct item {
    int32_t surface, first, count;
} item;

// A mesh and a body at a grid node.
typedef struct contact {
    int32_t mpm, fem, slot, node, number; // number: of the node in its grid
    int32_t leader, next;                 // contacts at one grid node: the first of them has its velocity; -1
    int32_t first, count;                 // links, in by_contact
    int8_t across[3];                     // 0 where a symmetry plane through the node lets nothing move
    brunt_pair *pair;
    real *at;
    double x[3], mass, area; // of the mesh: [kg], [m^2]
    double v[3];             // of the body (the leader's counts)
    double inverse_s[3];     // [1/kg] of the body, by component: 0 where a condition gives v
    bool held;               // some component
    double inverse[3];       // [1/kg] of the mesh, by component
    double relax;            // share of what is asked for that a sweep gives
    double n[3], gap, target;
    double normal_impulse, friction_impulse[3], applied[3];
} contact;

// Contacts and items of one body of material points.
typedef struct range {
    int32_t contact, contact_end, item, item_end;
} range;

// A face near a block of particles.
typedef struct near_face {
    int32_t block, face;
} near_face;

// What a particle knows of the nearest facet. Of a membrane, its front is meant.
typedef struct touch {
    double height, radius, n[3]; // [m] in front of it, [m] reach along n; unit, to where it is in front
    bool near, beside;           // beside: of the border of a membrane, with n from there
} touch;

struct brunt_surface_on_grid {
    near_face *near;
    size_t near_capacity;
    int32_t near_count;
    int32_t *block_first, *block_face; // faces near block b: block_face[block_first[b] .. block_first[b + 1])
    size_t block_first_capacity, block_face_capacity;
    touch *touch; // of each particle slot
    size_t touch_capacity;
    double search_range;
    range *range;
    link *link;
    item *item;
    contact *contact;
    int32_t *by_contact, *place;
    uint8_t *met; // of each surface node, how many bodies
    size_t met_capacity;
    double *changed;
    size_t range_capacity, link_capacity, item_capacity, contact_capacity, by_contact_capacity, place_capacity,
        changed_capacity;
    int32_t range_count, link_count, item_count, contact_count;
};

typedef struct job {
    const brunt_contact_context *m;
    brunt_surface_on_grid *w;
    const range *range;                              // contacts and items that are worked on ...
    int range_mpm, range_fem;                        // ... of these two
    brunt_symmetry_plane symmetry[BRUNT_MAX_PLANES]; // that act on the body whose links are made
    int symmetry_count;
} job;

static inline double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline bool make_unit(double n[3]) {
    double size = sqrt(dot(n, n));
    if (!(size > 0) || !isfinite(size)) return false;
    for (int a = 0; a < 3; a++) n[a] /= size;
    return true;
}

// Room for one more, keeping what is there.
#define GROW(w, array, what, error) BRUNT_CAPACITY_MORE((w)->array, what, error)
#define RESERVE(w, array, count, what, error) BRUNT_CAPACITY((w)->array, (size_t)(count), 0, what, error)

static inline bool overlap(const double low[3], const double high[3], const double low2[3], const double high2[3]) {
    for (int a = 0; a < 3; a++)
        if (low[a] > high2[a] || low2[a] > high[a]) return false;
    return true;
}

// --- surface_on_grid_links.c: which nodes of a mesh and of a grid have to do with each other
// Contacts, links and items of body b. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_surface_on_grid_link(job *j, int b, brunt_error *error);
// Links by contact, in their order. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_surface_on_grid_sort(brunt_surface_on_grid *w, brunt_error *error);
// Slot and node with global coordinates `at`; false when it is not alive. `seen` remembers the last slot.
typedef struct slot_cache {
    int32_t coord[3], slot;
    bool is;
} slot_cache;
bool brunt_surface_on_grid_node(const brunt_grid *grid, const int32_t at[3], slot_cache *cached, int32_t *slot,
                                int *node);

// --- surface_on_grid_gap.c: normal and gap at each of them
// Normals and gaps of all contacts of body b, mesh after mesh. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_surface_on_grid_look(job *j, int b, brunt_error *error);
// A node behind a symmetry plane sees few particles, or none: it has what its image has, reflected.
void brunt_surface_on_grid_reflect(const job *j);
