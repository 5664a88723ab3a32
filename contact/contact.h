// What acts on grid velocities between the transfers: mirror planes, node conditions, contact between bodies, walls.
//
// Every method gets the bodies after the grid update (new and old velocities at the nodes) and changes the new ones.
// What it does is booked in a brunt_impulse_account: impulse, work and dissipation, taken at the mean of the old and
// the new velocity, which makes the work of an impulse equal to the change of kinetic energy it causes.
#pragma once

#include "mpm/mpm_body.h"
#include "base/parallel.h"
#include "contact/pairs.h"

// A condition that is imposed from outside, and what it has done so far.
typedef struct brunt_impulse_account {
    double impulse[3];    // [N s] on the bodies (a pair: on its second body)
    double angular[3];    // [N m s] about the origin, on the bodies
    double external_work; // [J] done on the bodies by prescribed motion
    double normal_loss;   // [J] dissipated by the normal impulse
    double friction_loss; // [J] dissipated by the tangential impulse
    double area;          // [m^2] that touched in the last step
} brunt_impulse_account;

void brunt_impulse_account_add(brunt_impulse_account *sum, const brunt_impulse_account *part);
// Books impulse J acting at x while its material moves with `old` before and `now` after, against a support that moves
// with `support`. What it dissipates is added to `loss`: the action's normal_loss or its friction_loss.
void brunt_impulse_account_book(brunt_impulse_account *action, double *loss, const double J[3], const double x[3],
                                const double old[3], const double now[3], const double support[3]);

// A mirror plane through grid nodes `node` along `axis`: symmetry, and slip walls that lie on a grid line.
typedef struct brunt_symmetry_plane {
    int axis;
    int32_t node;
    int wall; // -1: the axis of revolution of rings, which is there for every body and gives no impulse
} brunt_symmetry_plane;

typedef struct brunt_wall {
    char name[BRUNT_NAME_LENGTH];
    bool region;                         // else a plane; a group counts as a region without grid nodes
    const struct brunt_group_def *group; // of finite-element bodies, NULL for the others
    brunt_plane_def plane;               // normal of unit length
    brunt_region_def where;              // of a region; shares the world's definition
    int body;                            // the one it acts on, -1: all
    int mirror;                          // index of the mirror plane it has become, -1
    brunt_impulse_account action;        // since the start
    brunt_impulse_account last;          // of the last step
} brunt_wall;

// --- mirror planes (symmetry.c): symmetry by adding each node's mirror image to it, before velocities are made
// `taken`: the share of the grid's velocity that particles take over, 1 but for FLIP; the rest of what the mirror does
// to the old velocity never reaches them.
void brunt_symmetry_fold(brunt_body *body, const brunt_symmetry_plane *mirror, double taken,
                         brunt_impulse_account *action);
// Images of a node coordinate under the mirrors it is near to (within the kernel), itself first; `sign` of each
// velocity component.
enum { BRUNT_MAX_IMAGES = 8 };
int brunt_symmetry_images(const brunt_symmetry_plane *mirrors, int mirror_count, const int32_t node[3], int near,
                          int32_t image[BRUNT_MAX_IMAGES][3], real sign[BRUNT_MAX_IMAGES][3]);

// --- node conditions (grid_conditions.c): stick and slip planes at the nodes behind them, prescribed velocities in
// regions Each marks the components of nodes that it gives (brunt_grid.held); cleared before the first of them. 0, or
// -1: out of memory.
int brunt_condition_clear(brunt_body *body);
void brunt_condition_apply(brunt_body *body, brunt_wall *wall, double time);

// --- reach (particle_extent.c): where a body's surface really is
// Gradient of the body's volume fraction at a node [1/m], which points into the body, and the centre of the volume that
// the node feels, relative to the node [m].
void brunt_extent_gradient(brunt_body *body, int32_t slot, int node, double gradient[3], double centre[3]);
// The particles near a node, as ellipsoids of material: gathered once, since contact asks for many directions.
typedef struct brunt_extent_cloud {
    double
        *data; // rows of `stride` numbers: place relative to the node, deformation gradient, reach, and one to work in
    size_t stride, bytes;
    int count;
} brunt_extent_cloud;
// Refills a cloud, empty at first ({0}). 0, or -1: out of memory.
int brunt_extent_gather(brunt_body *body, int32_t slot, int node, brunt_extent_cloud *cloud);
void brunt_extent_cloud_free(brunt_extent_cloud *cloud);
// Greatest distance along unit vector n, from the node, that one of them reaches [m], and the point that does, relative
// to the node; -INFINITY when there is none. `share` of their reach counts: 1, or 0 for their centres alone.
double brunt_extent_of(const brunt_extent_cloud *cloud, double share, const double n[3], double farthest[3]);

// Where a node of a total-Lagrangian body is now, as its particles see it: mean of x_p + F (X_i - X_p) [m]; `x` its
// undeformed place, replaced when it has any particles.
void brunt_extent_deformed(brunt_body *body, int32_t slot, int node, double x[3]);

// The particles of the bins whose kernel covers a node, slot by slot. `base`: the node's number among the bin's nodes.
typedef void brunt_extent_visit_fn(void *context, brunt_body *body, int64_t slot, const int base[3]);
void brunt_extent_visit(brunt_body *body, int32_t slot, int node, brunt_extent_visit_fn *visit, void *context);
// How far the particle in a slot reaches from its centre along unit vector n [m].
double brunt_extent_along(brunt_body *body, int64_t slot, const double n[3]);
// Where what the particle in a slot has around it meets something `distance` [m] away against unit vector n, once they
// touch: from its centre, and the same where its kernel lives. Friction acts there.
void brunt_extent_arm(brunt_body *body, int64_t slot, const double n[3], double distance, double arm[3],
                      double kernel_arm[3]);

// --- separation (gjk.c)
// Distance between what two bodies have near a node [m], 0 when that overlaps, and its direction from a to b (unit;
// left alone when 0). `start`: where to look first, any length but 0. `h`: edge of a cell.
double brunt_gjk_distance(const brunt_extent_cloud *a, const brunt_extent_cloud *b, double h, double share,
                          const double start[3], double n[3]);

// --- walls (particle_plane.c): planes that push and let go, with Coulomb friction, at zero gap
typedef struct brunt_wall_workspace brunt_wall_workspace;
void brunt_wall_workspace_free(brunt_wall_workspace *workspace);

// --- contact between bodies (grid_velocity.c)
typedef struct brunt_pair {
    int a, b; // bodies, a < b; -1: all pairs of a crowded scene together
    brunt_contact_method method;
    double friction;
    brunt_impulse_account action, last;
} brunt_pair;

typedef struct brunt_contact_workspace brunt_contact_workspace;
void brunt_contact_workspace_free(brunt_contact_workspace *workspace);
