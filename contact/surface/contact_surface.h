// The surfaces of all finite-element bodies as contact sees them in one step: boundary nodes and faces, one numbering
// for the whole world, in the order of the bodies.
//
// The methods change `v`, never the bodies: the velocities are taken from the bodies before and given back after.
//
// A membrane (the elements of a membrane) has two sides: its nodes and faces are there twice, first the front as the
// elements are oriented, then the back, with the order of the nodes reversed, on the same nodes of the body. What acts
// on a node of the back is gathered at its twin of the front, which alone gives a velocity back.
#pragma once

#include <math.h>

#include "base/parallel.h"
#include "fem/fem_body.h"
#include "fem/surface_topology.h"

// What a body is to membranes.
typedef struct brunt_side {
    int32_t faces;  // of one side of a membrane; 0: no membrane
    double half;    // [m] half its thickness
    double shallow; // [m] a node of another body that is behind a membrane, but no further than this, has come through
                    // it; one that is further is on the far side of its own body
} brunt_side;

// Where the nodes and faces of a surface have gone when it was made anew.
typedef struct brunt_surface_change {
    bool any;
    int32_t node_count, face_count; // that there were
    int32_t *node_was;              // of each node: its number before; -1: it is new
    int32_t *face_now;              // of each face that there was: its number now; -1: removed
    size_t node_was_capacity, face_now_capacity;
} brunt_surface_change;

// The two sides of membranes; all NULL where there are none.
typedef struct brunt_membrane_sides {
    int32_t *front;   // of each node: its twin of the front, or itself
    brunt_side *side; // of each body by its index among all, to the last of the meshes
    double thickest;  // [m] of all membranes, 0 where there are none
    // Elements about the nodes of membranes that may touch themselves, two deep, as faces of the front, ascending:
    // patch_face[patch_first[n] .. patch_first[n + 1]) of node n of the front.
    int32_t *patch_first, *patch_face;
    bool *self; // of each body: it has patches
    size_t patch_first_capacity, patch_face_capacity;
} brunt_membrane_sides;

// Surfaces of bodies that may lose elements; all NULL where none do.
typedef struct brunt_surface_renewal {
    brunt_surface_topology *topology; // of each body (elements 0: it loses none)
    bool *eroded;                // of each body by its index among all, to the last of the meshes: it may lose elements
    brunt_surface_change change; // of the last time
    int32_t *next_node, (*next_face)[4];
    char *spare;
    size_t next_node_capacity, next_face_capacity, spare_capacity;
} brunt_surface_renewal;

// Motion is measured against a frame that moves along with the bodies, which leaves what counts: theirs against each
// other.
typedef struct brunt_surface_motion {
    double frame[3];           // [m/s] mean velocity of all surfaces, a step ago
    double frame_step[3];      // [m] how far it went in the last step
    double (*mean)[3], *speed; // [m/s] of each body: mean velocity, greatest against the frame
    double seen;               // [m] how far nodes look for facets, and remember what they saw
    double *apart;     // [m] of each group of chunks: the most that one of their nodes has moved against what is near
                       // of it since they were gathered last ...
    int32_t group;     // ... which is so many chunks
    bool *anew;        // of each body: it became active, and where it was before is not known
    double (*zone)[6]; // [m] low, high of the room about all that is near each active body. All there is unless told
    uint8_t *near;     // of each node of active bodies: a face of it reaches into that room, or it has none
    double (*was)[3];  // [m] of each: where it was when it was gathered last
    bool *was_active;
    // While nothing is near: bounds of each body (low, high [m]) as they were looked at last, and how far any of its
    // nodes may have come since [m].
    double (*kept)[6], *travel;
    bool rests; // `kept` is there
    struct brunt_surface_way {
        double low[3], high[3], from[3], to[3]; // [m] of the ways of nodes that are near, and of their places
    } * chunk;                                  // of each chunk of nodes
    double *widest;                             // [m] of each chunk of faces, of those that are near
    uint8_t *made; // of each face of active bodies: it is near something, or has a node that is
    // Bounds of the pieces of bodies that threads look at, BRUNT_SURFACE_PIECE nodes each. Piece p of body k is number
    // node_range[k] / BRUNT_SURFACE_PIECE + k + p: room for all, and no table needed.
    struct brunt_surface_piece {
        double low[3], high[3], sum[3], fastest; // [m], [m/s], [m^2/s^2]
    } * piece;
} brunt_surface_motion;

// Contact state of the step, of each node, for output. Zeroed each step.
typedef struct brunt_contact_output {
    double *gap;          // [m] of the nearest contact; INFINITY where none is near
    double (*impulse)[3]; // [N s] on the node
    uint8_t *state;       // 0 free, 1 sticks, 2 slips
} brunt_contact_output;

typedef struct brunt_contact_surface {
    int dim;
    bool axisymmetric; // masses and impulses are those of the whole circle
    int fem_count;
    brunt_fem_body **fem;             // the bodies, in their order; body k has ...
    int32_t *node_range, *face_range; // ... nodes node_range[k] .. node_range[k + 1], faces likewise
    int32_t *node_end, *face_end;     // of each body: end of what counts once; of a membrane, of its front
    double (*low)[3], (*high)[3];     // [m] bounds of each body's surface
    bool *active;                     // of each body: something is near it; x and faces are only made for these
    // Nodes. Of active bodies those that are near (motion.near) have all of this, others their place alone.
    int32_t node_count;
    int32_t *body, *node; // of each node: index of its body (brunt_fem_body.index), node number there
    double (*x)[3];       // [m] at the start of the step
    double (*v)[3];       // [m/s] after all forces; what contact changes
    double (*old)[3];     // [m/s] before the forces: works and losses are taken at the mean of this and the final v
    double *mass;         // [kg]
    double (*inverse)[3]; // [1/kg] by component: 0 where the motion is prescribed, which is infinite mass
    double (*normal)[3];  // outward, of unit length: mean of its faces by area; 0 where they cancel
    double *area;         // [m^2] of the surface that is the node's; 0 of detached nodes, which have no faces
    double (*affine)[9];  // [m^2/s] B of the paper's form, kept from step to step; NULL for the others
    int32_t *face_first, *face_of; // faces of node n: face_of[face_first[n] .. face_first[n + 1])
    // Faces. Of active bodies those that are made (motion.made) have all of this, others their bounds alone.
    int32_t face_count;
    int32_t (*face)[4]; // nodes; the 4th is -1 for triangles, 3rd and 4th for segments (2D)
    int32_t *face_body;
    double (*face_normal)[3]; // outward unit normal ...
    double (*face_centre)[3]; // ... and centre, at the start of the step
    double *face_area;        // [m^2]; 2D [m]
    double (*face_box)[6];    // [m] bounds: low, then high
    double mean_edge;         // [m] of all faces at the start of the run
    size_t node_array_capacity, face_array_capacity, node_capacity, body_capacity, face_capacity;
    brunt_membrane_sides membrane;
    brunt_surface_renewal renewal;
    brunt_surface_motion motion;
    brunt_contact_output output;
} brunt_contact_surface;

// Aborts where bodies, nodes and faces do not belong to each other as they must.
void brunt_surface_validate(const brunt_contact_surface *surface);
// The surfaces of `count` bodies. `affine`: keep B. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_surface_make(brunt_contact_surface *surface, brunt_fem_body **fem, int count, bool affine,
                       brunt_error *error);
// Lists the elements near each node of the bodies marked in `self`, which are membranes in contact with themselves:
// those are no obstacles to it. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_surface_patches(brunt_contact_surface *surface, const bool *self, brunt_error *error);
// The surfaces anew after elements have left bodies, or (`restored`) of a saved state. What is kept of a node from step
// to step stays with it, and surface->change tells what has become of each. The order of nodes and faces follows from
// which elements there are. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_surface_renew(brunt_contact_surface *surface, bool restored, brunt_error *error);
// The affine velocities as they are saved: so many doubles, of all nodes that may ever be of the surface.
int64_t brunt_surface_affine_count(const brunt_contact_surface *surface);
void brunt_surface_affine_get(const brunt_contact_surface *surface, double *out);
void brunt_surface_affine_set(brunt_contact_surface *surface, const double *in);
// Where node `n` of the surface is among all nodes that may ever be of it, and how many those are: what a saved state
// is in the order of, since its size must not depend on what has left.
int64_t brunt_surface_slot(const brunt_contact_surface *surface, int k, int32_t n);
int64_t brunt_surface_slots(const brunt_contact_surface *surface);
// [bytes] that it takes.
size_t brunt_surface_bytes(const brunt_contact_surface *surface);
void brunt_surface_free(brunt_contact_surface *surface);
// Meshes first .. end of the surface are those of a body by its number among all; of -1: all.
void brunt_surface_meshes(const brunt_contact_surface *surface, int body, int *first, int *end);
// Bounds and speeds of every body's surface as it is now.
void brunt_surface_bounds(brunt_contact_surface *surface, int threads, brunt_timer *timer);
// Bounds, places of nodes and faces of all bodies, which become active, and nothing of how they move.
void brunt_surface_gather_places(brunt_contact_surface *surface, int threads, brunt_timer *timer);
// The same while nothing is near, for a fraction of the work: bounds kept from an earlier step and widened by what the
// nodes may have moved since, and speeds against space. With `anew` the bounds are looked at.
void brunt_surface_rest(brunt_contact_surface *surface, bool anew, int threads, brunt_timer *timer);
// After it: the bodies move for `dt` with the velocities that they have.
void brunt_surface_rest_moves(brunt_contact_surface *surface, double dt);
// All nodes of active bodies are near something.
void brunt_surface_all_near(brunt_contact_surface *surface);
// Places and faces of the active bodies, and of their nodes that are near something velocities, masses and normals.
// `gravity` [m/s^2] and `dt` are those of this step's kick.
void brunt_surface_gather_state(brunt_contact_surface *surface, double dt, const double gravity[3], int threads,
                                brunt_timer *timer);
// Velocities of nodes of the active bodies that are near something back to them, which then move for `dt`.
void brunt_surface_scatter_velocity(brunt_contact_surface *surface, double dt, int threads, brunt_timer *timer);

// Nodes are gathered, and their motion is bounded, by chunks of one body each: the number of that of node n of body k.
enum { BRUNT_SURFACE_GRAIN = 256 };
static inline int32_t brunt_surface_chunk(const brunt_contact_surface *surface, int k, int32_t n) {
    const int32_t first = surface->node_range[k];
    return first / BRUNT_SURFACE_GRAIN + k + (n - first) / BRUNT_SURFACE_GRAIN;
}

// How many nodes a face has.
static inline int brunt_face_corners(const int32_t face[4]) { return face[2] < 0 ? 2 : face[3] < 0 ? 3 : 4; }

// Area of face f that is its node n's [m^2], 2D [m]; of a ring that of the whole circle, 2 pi int N_n r ds [m^2].
static inline double brunt_surface_nodal_area(const brunt_contact_surface *surface, int32_t f, int32_t n) {
    const int32_t *node = surface->face[f];
    if (surface->axisymmetric)
        return M_PI / 3 * surface->face_area[f] * (surface->x[n][0] + surface->x[node[0]][0] + surface->x[node[1]][0]);
    return surface->face_area[f] / (node[2] < 0 ? 2 : node[3] < 0 ? 3 : 4);
}
