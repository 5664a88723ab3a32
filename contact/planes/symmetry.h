// Symmetry planes: each node's mirror image is added to it, before velocities are made.
#pragma once

#include "contact/constraint/impulse_account.h"
#include "contact/contact.h"
#include "mpm/mpm_body.h"

// A symmetry plane through grid nodes `node` along `axis`: symmetry, and slip planes that lie on a grid line; such ones
// that stick, too, which splines keep at rest where the images of all velocities are opposite.
typedef struct brunt_symmetry_plane {
    int axis;
    int32_t node;
    int side;     // of it, along the axis, on which the bodies are: 1, -1
    bool sticks;  // no velocity, but opposite ones of images, not only across it
    int boundary; // -1: the axis of revolution of rings, which is there for every body and gives no impulse
} brunt_symmetry_plane;

enum { BRUNT_MAX_PLANES = 16 }; // of a world
// Nodes further than the kernel reaches from the plane have no partner with mass on the other side; two layers cover a
// cubic kernel and a body that has sunk into the plane by less than a cell.
enum { BRUNT_IMAGE_LAYERS = 2 };

// Adds up the sums of every node and its images by the symmetry planes that act on a body, each with its account.
// `taken`: the share of the grid's velocity that particles take over, 1 where they keep nothing of their own; the rest
// of what the symmetry planes do to the old velocity never reaches them.
void brunt_symmetry_fold(brunt_body *body, const brunt_symmetry_plane *symmetry, int symmetry_count, double taken,
                         brunt_impulse_account *const *account, int threads, brunt_timer *timer);
// What APIC's share keeps of the old velocity v moves on with it within the step, while what the planes have done to
// its momentum is booked at the nodes: dt a sum v x p of the body's own momenta p before they were added up, which are
// along v but near planes. Keeps those momenta: `own` has room for three numbers a node of the grid.
void brunt_symmetry_remember(const brunt_body *body, const brunt_symmetry_plane *symmetry, int symmetry_count,
                             double *own);
// Books that afterwards, `reach` = dt a [s], with the account of the plane that is near.
void brunt_symmetry_carry(const brunt_body *body, const brunt_symmetry_plane *symmetry, int symmetry_count,
                          const double *own, double reach, brunt_impulse_account *const *account);
// Of planes the number without those where another one sticks: such are more than they.
int brunt_symmetry_distinct(brunt_symmetry_plane *symmetry, int symmetry_count);
// The symmetry planes that act on a body, and their number.
int brunt_symmetry_of(const brunt_contact_context *m, const brunt_body *body,
                      brunt_symmetry_plane out[BRUNT_MAX_PLANES]);
// Whether a plane is near a node and can bear what acts on it along an axis: across it, or in all directions.
bool brunt_symmetry_carries(const brunt_symmetry_plane *plane, const int32_t at[3], int axis);
// What each of the planes near a node takes of what acts on it along an axis, 1 in all, whichever of them is given
// first: the nearest one across it or that sticks, of as near ones that across it; where there is none (moments alone)
// the nearest. As near ones take the same. `axis` BRUNT_NONE: across none.
void brunt_symmetry_shares(const brunt_symmetry_plane *symmetry, int symmetry_count, const int32_t at[3], int axis,
                           double share[BRUNT_MAX_PLANES]);
// Which of them takes what acts along an axis: the first across it, else the first that sticks, BRUNT_NONE.
int brunt_symmetry_bearer(const brunt_symmetry_plane *symmetry, int symmetry_count, int axis);
// Images of a node coordinate under the symmetry planes it is near to (within the kernel), itself first, and the images
// of these, as between two symmetry planes; `sign` of each velocity component, 0 across a symmetry plane that one of
// them lies on. The same nodes whichever of them is given.
enum { BRUNT_MAX_IMAGES = 27 }; // three along an axis: of two symmetry planes, each within two nodes
int brunt_symmetry_images(const brunt_symmetry_plane *symmetry, int symmetry_count, const int32_t node[3], int near,
                          int32_t image[BRUNT_MAX_IMAGES][3], real sign[BRUNT_MAX_IMAGES][3]);
