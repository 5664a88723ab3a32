// Transfers between particles and grid, and the update of the particles: the two passes that cost the time of a step.
//
// Both are written once (p2g.h, g2p.h) and compiled for each dimension, kernel, transfer and form, the list of which is
// transfer.c; a body's functions are looked up once.
#pragma once

#include "mpm/mpm_body.h"

// Per-thread room for one block, sized for the fullest block.
// Of rings: places in `out` that plane strain leaves free. How many arrays `out` has, and where APIC keeps a share.
enum { BRUNT_OUT_STRETCH = 21, BRUNT_OUT_HOOP = 22, BRUNT_OUT_ZERO = 23 };
enum { BRUNT_OUT_USUAL = 24, BRUNT_OUT_KEEPING = 3 + 9 + 9 + 3 + 9 };

typedef struct brunt_workspace {
    real *memory;
    size_t capacity;
    int64_t stride; // reals an array of particles takes
    real *window;   // nodes a block's bins touch
    real *planes;   // polynomial coefficients of the planes of bins in use
    // Particle arrays: velocity, gradient, affine field, old velocity and, where APIC keeps a share, its affine field;
    // of rings the hoop rate, and zeros.
    real *out[BRUNT_OUT_KEEPING];
    real *plastic, *viscous, *strain; // what material components leave for the next
} brunt_workspace;

// Particles of block `block` to its scatter buffer: mass, momentum, and dt times internal force.
typedef void brunt_p2g_fn(brunt_body *body, int32_t block, real dt);

// p2g_triangles.c: the same over triangles, without forces and affine velocities, for implicit steps.
brunt_p2g_fn brunt_p2g_triangles;

// Velocity and its gradient from the grid to the particles of `block`, then their update: velocity, position,
// deformation gradient, material. Fills body->report[block]. `kept`: what this step leaves of the share of FLIP or
// APIC.
typedef void brunt_g2p_fn(brunt_body *body, int32_t block, real dt, real kept, brunt_workspace *work);

// kernel 1..3, transfer BRUNT_PIC, BRUNT_FLIP, BRUNT_APIC; axisymmetric with dim 2
brunt_p2g_fn *brunt_find_p2g(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer);
brunt_g2p_fn *brunt_find_g2p(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer);
// The same of total-Lagrangian bodies (not axisymmetric). NULL for the linear kernel: the slope of its fields jumps
// between cells, and particles that never leave their corner of a cell do not average it.
brunt_p2g_fn *brunt_find_total_p2g(int dim, brunt_kernel kernel, brunt_transfer transfer);
brunt_g2p_fn *brunt_find_total_g2p(int dim, brunt_kernel kernel, brunt_transfer transfer);
// G2p of APIC that keeps a share, `total` of total-Lagrangian bodies. NULL for the linear kernel, on which APIC makes
// energy.
brunt_g2p_fn *brunt_find_keeping_g2p(int dim, bool axisymmetric, brunt_kernel kernel, bool total);
// Of the linear kernel g2p has two stages: this one updates the velocities, the one above the rest, after the
// velocities have been to the grid once more. NULL for the other kernels.
brunt_g2p_fn *brunt_find_musl_velocity(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer);

// --- detached.c: particles of a block whose deformation gradient stands still, of bodies that erode or keep what has
// left Sets the velocity gradient of those that would turn inside out (they are marked in particles.order) and of those
// freed of stress (volume 0) to 0, before F is updated. `hoop_stretch` takes F[8] of rings. How many are newly marked.
int32_t brunt_keep_inverted(brunt_body *body, const brunt_block *block, real dt, real *const *gradient,
                            real *hoop_stretch);
// The same for the hoop of rings, after F is updated: rate to 0, stretch as it was.
int32_t brunt_keep_inverted_hoops(brunt_body *body, const brunt_block *block, real dt, real *hoop,
                                  const real *hoop_stretch);
// What is freed has no stress.
void brunt_still_stress(brunt_body *body, const brunt_block *block);

// Makes room for blocks of up to `most` particles, with the first `outs` arrays of `out`. BRUNT_OK, or BRUNT_FAILED:
// out of memory.
int brunt_workspace_fit(brunt_workspace *work, const brunt_grid *grid, int32_t most, int outs, brunt_error *error);
void brunt_workspace_free(brunt_workspace *work);
