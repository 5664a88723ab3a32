// What the files of the search for facing facets share. Private to them.
#pragma once

#include <math.h>
#include <string.h>

#include "contact/search/node_to_facet.h"
#include "contact/distance/feature.h"
#include "base/array.h"
#include "base/memory.h"

enum { BRUNT_MAX_HITS = 7, BRUNT_MAX_NEAR = 32 };

static inline double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// The nearest facet of one other body, or the edge or corner of it (`feature`).
typedef struct hit {
    int32_t face, triangle, body;
    brunt_feature feature;
    bool valley; // another slope of it is as near
    double gap, n[3], target;
    int32_t worker, master; // of a feature that bears: who looked, and which of its masters
} hit;

// What a slave meets: an edge or corner with the faces about it, or a facet.
typedef struct brunt_master {
    int32_t node[BRUNT_FEATURE_NODES];
    double weight[BRUNT_FEATURE_NODES], gradient[BRUNT_FEATURE_NODES][3], facet[3], height;
    int count;
} brunt_master;

typedef struct slave_hits {
    hit hits[BRUNT_MAX_HITS];
    int32_t count;
} slave_hits;

typedef struct bounds {
    double low[3], high[3];
    int body; // of the world
    int fem;  // index in the skin, -1: material points
    int mpm;
    bool sheet;
} bounds;

typedef struct near_pair {
    int32_t a, b; // of the boxes
} near_pair;

struct brunt_node_to_facet {
    double range;      // [m] how far a body looks for others in this step ...
    double reach;      // ... and how far anything moves towards anything ...
    double wall_reach; // ... and towards a wall
    bounds *box;
    size_t box_capacity;
    int32_t box_count;
    near_pair *near;
    size_t near_capacity;
    int32_t near_count;
    int32_t *box_of; // skin body -> box
    size_t box_of_capacity;
    int32_t *near_first, *near_list; // boxes near a box
    size_t near_first_capacity, near_list_capacity;

    // Cells, and what they were made for.
    bool made;
    double made_range;
    int32_t made_near;
    uint64_t made_pairs;
    double origin[3], cell;
    int32_t n[3];
    int32_t *cell_first, *cell_face;
    size_t cell_first_capacity, cell_face_capacity;
    double (*made_x)[3]; // skin nodes then ...
    bounds *made_box;    // ... and boxes, bodies with facets first
    size_t made_x_capacity, made_box_capacity;

    uint8_t *found; // of each skin node: how many hits ...
    size_t found_capacity;
    hit *hits; // ... in its BRUNT_MAX_HITS places
    size_t hits_capacity;
    // The edges and corners that bear, by the worker that looked; none where nobody meets one.
    struct masters {
        brunt_master *master;
        size_t capacity;
        int32_t count;
        bool failed;
    } * masters;
    int masters_count;
    int32_t *last; // of each skin node: the face it was nearest to, to look at first; -1
    size_t last_capacity;
    int32_t *last_spare; // while they are put in a new order
    size_t last_spare_capacity;
    // How far from everything each skin node was when it was looked at, and how far things had moved then: until they
    // have moved that far again, it touches nothing and need not be looked at.
    struct quiet {
        double distance, travelled;
        double second; // of the nearest facet but `last`: until then that one stays the nearest
    } * quiet;
    size_t quiet_capacity;
    double travelled;    // [m] twice the furthest motion of each step, summed
    int32_t *support_of; // of each skin node: support, -1
    size_t support_of_capacity;
    int32_t *first_point;
    size_t first_point_capacity;

    int32_t **node_support; // of each mpm body: of each grid node its place in `grid` + 1
    size_t *node_support_capacity;
    int mpm_count;
    struct grid_support {
        int32_t mpm;
        int64_t node;
        int32_t support;
        double sign[3]; // v of the node is that of the support, turned over by mirrors; 0 across one it lies on
    } * grid;
    size_t grid_capacity;
    int32_t grid_count;
    // What particles have seen, by the worker that looked; and of each block of a body where it is there.
    struct sight {
        struct seen {
            int32_t block;
            int64_t particle;
            double x[3];
            hit h;
        } * seen;
        size_t capacity;
        int32_t count;
        bool failed;
    } * sight;
    int sight_count;
    struct run {
        int worker;
        int32_t first, count;
    } * run;
    size_t run_capacity;
};

#define RESERVE(f, what, count) BRUNT_RESERVE((f)->what, (size_t)(count), 0)

// Someone who looks around: which bodies may be touched (their boxes are that near), and which may have been entered.
typedef struct looker {
    int32_t box, body;
    const double *x, *normal; // outward; NULL when it has none
    int64_t cell;
    int32_t touch[BRUNT_MAX_NEAR], touches, enter[BRUNT_MAX_NEAR], enters;
    // Where there are sheets: half its own thickness, how far behind one it may be found, and the elements of its own
    // body that are no obstacle; without those the body does not meet itself.
    bool sheet;
    double half, shallow;
    const int32_t *ring;
    int32_t ring_count;
} looker;

static inline int face_corners(const brunt_contact_surface *s, int32_t face) {
    return s->face[face][2] < 0 ? 2 : s->face[face][3] < 0 ? 3 : 4;
}

// --- node_to_facet.c
// Makes what is kept between steps, when there is none. 0, or -1: out of memory.
int brunt_node_to_facet_make(brunt_node_to_facet **facing, int mpm_count, int32_t nodes);

// --- distance_cache.c
// Room for what is remembered of so many nodes. 0, or -1: out of memory.
int brunt_distance_cache_fit(brunt_node_to_facet *f, int32_t nodes, int32_t kept);

// --- broad_phase.c
double brunt_node_to_facet_plane_distance(const brunt_plane_def *plane, double time, const double x[3]);
bool brunt_broad_phase_plane(const brunt_contact_surface *s, int k, const brunt_wall *wall, double time, double range);

// --- facet_cells.c
// Makes the cells anew when they no longer hold all that may be near. 0, or -1: out of memory.
int brunt_search_cells(const brunt_contact_context *m, brunt_node_to_facet *f);
// Whether anything reaches, within `by`, a box near box `box`.
bool brunt_node_to_facet_in_reach(const brunt_node_to_facet *f, int32_t box, const double low[3], const double high[3],
                                  double by);
// --- candidates.c
// Fills the bodies a looker may touch or have entered; whether there are facets to look at.
bool brunt_node_to_facet_look(const brunt_node_to_facet *f, looker *l);
void brunt_node_to_facet_look_around(const brunt_contact_context *m, const brunt_node_to_facet *f, const looker *l,
                                     int32_t guess, slave_hits *out, double *distance, double *second);
bool brunt_node_to_facet_still_nearest(const brunt_contact_context *m, const brunt_node_to_facet *f, int32_t n,
                                       const double *normal, double least, slave_hits *out);

// --- node_facet.c
double brunt_node_to_facet_target(const brunt_contact_surface *s, double gap, double approach, double before,
                                  double dt);
double brunt_node_to_facet_area(const brunt_contact_surface *s, int32_t n, const double direction[3]);
int32_t brunt_node_to_facet_support(brunt_node_to_facet *f, const brunt_contact_surface *s, int32_t n,
                                    brunt_constraint_set *points);
double brunt_node_to_facet_approach(const brunt_contact_surface *s, const hit *h, const double x[3], const double v[3],
                                    double (*of)[3]);
void brunt_node_to_facet_point(const brunt_contact_context *m, const hit *h, const double x[3], int body,
                               brunt_constraint *point);
int brunt_node_to_facet_master(const brunt_contact_surface *s, const hit *h, const double x[3], brunt_master *master);
// The master's entries, whose supports there are; sets the point's facet.
void brunt_node_to_facet_entries(const brunt_node_to_facet *f, const brunt_master *master, brunt_constraint *point,
                                 brunt_constraint_entry *entry);

// --- particle_facet.c
// Contact points of the particles of body k of the mpm bodies. 0, or -1: out of memory.
int brunt_node_to_facet_particles(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_body *body, int k,
                                  int32_t box, brunt_constraint_set *points);
// After the solution: velocities back to the grids' nodes.
void brunt_node_to_facet_give_grids(const brunt_contact_context *m, brunt_body *mpm, brunt_node_to_facet *f,
                                    const brunt_constraint_set *points);
