// What the kernels of all elements share: small vectors, the room of a block, the way from nodes to a block and back.
#pragma once

#include "fem/fem_body.h"
#include "base/simd_math.h"
#include "fem/record.h"

#include <string.h>

static inline double triple(const double a[3], const double b[3], const double c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

BRUNT_INLINE void cross(const lanes a[3], const lanes b[3], lanes out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

BRUNT_INLINE lanes dot(int dim, const lanes *a, const lanes *b) {
    lanes sum = a[0] * b[0] + a[1] * b[1];
    return dim == 3 ? sum + a[2] * b[2] : sum;
}

// F^-1; matrices row by row.
BRUNT_INLINE void inverse_matrix(int dim, const lanes *F, lanes *out) {
    if (dim == 2) {
        lanes r = 1 / (F[0] * F[3] - F[1] * F[2]);
        out[0] = F[3] * r, out[1] = -F[1] * r, out[2] = -F[2] * r, out[3] = F[0] * r;
        return;
    }
    lanes c0 = F[4] * F[8] - F[5] * F[7], c1 = F[5] * F[6] - F[3] * F[8], c2 = F[3] * F[7] - F[4] * F[6];
    lanes r = 1 / (F[0] * c0 + F[1] * c1 + F[2] * c2);
    out[0] = c0 * r, out[3] = c1 * r, out[6] = c2 * r;
    out[1] = (F[2] * F[7] - F[1] * F[8]) * r;
    out[4] = (F[0] * F[8] - F[2] * F[6]) * r;
    out[7] = (F[1] * F[6] - F[0] * F[7]) * r;
    out[2] = (F[1] * F[5] - F[2] * F[4]) * r;
    out[5] = (F[2] * F[3] - F[0] * F[5]) * r;
    out[8] = (F[0] * F[4] - F[1] * F[3]) * r;
}

BRUNT_INLINE void multiply(int dim, const lanes *a, const lanes *b, lanes *out) {
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) {
            lanes sum = a[i * dim] * b[j] + a[i * dim + 1] * b[dim + j];
            out[i * dim + j] = dim == 3 ? sum + a[i * dim + 2] * b[2 * dim + j] : sum;
        }
}

// Place of component r, c in the layout of symmetric tensors (real.h).
#define SYMMETRIC_PLACE(dim, r, c) ((r) == (c) ? (r) : (dim) == 2 ? 3 : (r) + (c) == 1 ? 3 : (r) + (c) == 3 ? 4 : 5)

// Greatest eigenvalue of A + B from those of A and B (both not negative) and the squared cosine of the least angle
// between their ranges.
BRUNT_INLINE lanes joint_eigenvalue(lanes a, lanes b, real overlap) {
    return (real)0.5 * ((a + b) + lanes_sqrt((a - b) * (a - b) + 4 * overlap * a * b));
}

// Bound of omega^2 such that 2 / omega is stable, from that of the strain and the rate C of the hourglass dampers,
// which act by rates of the step before: dt^2 omega^2 + 2 dt c' <= 4 of a mode by itself; of both together, with the
// eigenvalue of the sum bounded by the greater plus s times the lesser.
BRUNT_INLINE lanes damped_frequency(lanes strain, lanes C, real overlap) {
    const real s = (real)sqrt((double)overlap);
    lanes first = s * C + lanes_sqrt(s * s * C * C + 4 * strain), second = C + lanes_sqrt(C * C + 4 * s * strain);
    lanes twice = (real)0.5 * lanes_max(first, second);
    return twice * twice;
}

// A block's pass through its elements. The local copy holds X Y Z 0 ux uy uz 0 of each node, u = x - X.
typedef struct fem_pass {
    const real *copy, *velocity; // of the block's nodes; velocity (4 reals each): viscous hourglass control only
    real **F, **stress, **rate;
    const real *scale, *volume; // scale: NULL without mass scaling
    real *L[9];                 // of a tile
    real dt;
    bool viscous, tension_only;
    real spring, damper;   // what is common to all elements of the hourglass coefficients
    real lateral, c0, rho; // see brunt_fem_body
    real norm, overlap, cosine;
    real thickness;     // of membranes
    lanes stored, lost; // hourglass work so far
    // Of bodies whose elements may turn inside out, else NULL.
    uint8_t *mark;
    real *kept;     // scalar_count x FEM_TILE
    int32_t turned; // in this tile
} fem_pass;

enum { FEM_TILE = BRUNT_FEM_TILE };

// Copies the block's nodes.
static inline void fem_load_block(const brunt_fem_body *body, const brunt_fem_block *block, real *copy,
                                  real *velocity) {
    const int32_t *node = body->block_node + block->node_first;
    for (int32_t k = 0; k < block->node_count; k++) {
        const real *record = brunt_fem_node(body, node[k]);
        real4 X = real4_load(body->start + (size_t)node[k] * 4), u = real4_load(record) - X;
        u[3] = 0; // the mass
        real4_store(copy + (size_t)k * 8, X);
        real4_store(copy + (size_t)k * 8 + 4, u);
        if (velocity) real4_store(velocity + (size_t)k * 4, real4_load(record + BRUNT_FEM_V));
    }
}

// -dt sum f . v over the block's nodes [J].
static inline double fem_stress_work(const brunt_fem_body *body, const brunt_fem_block *block, real dt) {
    const int32_t *node = body->block_node + block->node_first;
    const real *partial = body->partial + (size_t)block->node_first * 4;
    real4 sum = real4_set(0);
    for (int32_t k = 0; k < block->node_count; k++)
        sum += real4_load(partial + (size_t)k * 4) * real4_load(brunt_fem_node(body, node[k]) + BRUNT_FEM_V);
    return -(double)dt * ((double)sum[0] + (double)sum[1] + (double)sum[2]);
}

// The material points of a block, by component; their velocity gradients are to be in the first `gradients` arrays of
// L.
static inline void fem_points_of_block(brunt_fem_body *body, const brunt_fem_block *block, real dt, real *const *L,
                                       int gradients, brunt_material_points whole[BRUNT_COMPONENTS]) {
    const int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        whole[k] = brunt_fem_points(body, (brunt_component)k, block->first, padded);
        whole[k].dt = dt;
        whole[k].cell = block->length;
        for (int c = 0; c < gradients; c++) whole[k].L[c] = L[c];
    }
}

// The range from `offset` on of `whole`.
static inline brunt_material_points fem_points_from(const brunt_material_points *whole, int32_t offset, int32_t count) {
    brunt_material_points points = *whole;
    points.count = count;
    for (int c = 0; c < BRUNT_MATRIX(points.dim); c++) points.F[c] += offset;
    for (int c = 0; c < BRUNT_SYMMETRIC(points.dim); c++) points.stress[c] += offset;
    for (int s = 0; s < BRUNT_MAX_STATE && points.state[s]; s++) points.state[s] += offset;
    if (points.thickness) points.thickness += offset;
    points.volume += offset;
    return points;
}

// --- elements that would turn inside out, of bodies where they leave instead: their state stays that of the last step

// J is no larger than what rounding makes of it.
BRUNT_INLINE lane_mask inside_out(int dim, const lanes *F) {
    lanes J = F[0] * F[3] - F[1] * F[2], size = lanes_set(0);
    for (int c = 0; c < dim * dim; c++) size += F[c] * F[c];
    if (dim == 3)
        J = F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
            F[2] * (F[3] * F[7] - F[4] * F[6]);
    return J <= 64 * LANES_REAL_EPSILON * (dim == 3 ? size * lanes_sqrt(size) : size);
}

static inline void fem_note_turned(fem_pass *pass, int64_t slot, lane_mask turned) {
    for (int l = 0; l < BRUNT_LANES && lanes_any(turned); l++)
        if (turned[l] && pass->volume[slot + l] > 0) pass->mark[slot + l] = BRUNT_MARK_INVERTED, pass->turned++;
}

// Everything the elements of a tile keep, aside before the material's update and back after it.
static inline void fem_keep_state(const brunt_fem_body *body, const fem_pass *pass, int64_t slot, int32_t count) {
    for (int c = 0; pass->turned && c < body->scalar_count; c++)
        memcpy(pass->kept + c * FEM_TILE, body->scalar[c] + slot, (size_t)count * sizeof(real));
}

static inline void fem_restore_state(const brunt_fem_body *body, const fem_pass *pass, int64_t slot, int32_t count) {
    for (int32_t k = 0; pass->turned && k < count; k++)
        for (int c = 0; pass->mark[slot + k] == BRUNT_MARK_INVERTED && c < body->scalar_count; c++)
            body->scalar[c][slot + k] = pass->kept[c * FEM_TILE + k];
}

static inline fem_pass fem_pass_begin(brunt_fem_body *body, const brunt_fem_block *block, real dt, real *memory) {
    const bool viscous = body->element->hourglass_modes && body->hourglass == BRUNT_HOURGLASS_VISCOUS;
    const brunt_element_field *rate = &body->field[BRUNT_ELEMENT_hourglass_rate],
                              *scale = &body->field[BRUNT_ELEMENT_density_scale];
    real *copy = memory, *velocity = copy + (size_t)body->block_nodes * 8;
    const bool keeps = body->erodes_inverted && dt > 0;
    fem_load_block(body, block, copy, viscous ? velocity : NULL);
    const real c0 = body->material.wave_speed, density = body->material.density;
    return (fem_pass){.copy = copy,
                      .velocity = velocity,
                      .F = brunt_element_scalars(body, BRUNT_ELEMENT_deformation_gradient),
                      .stress = brunt_element_scalars(body, BRUNT_ELEMENT_kirchhoff_stress),
                      .rate = rate->components ? body->scalar + rate->first : NULL,
                      .scale = scale->components ? body->scalar[scale->first] : NULL,
                      .volume = brunt_element_scalars(body, BRUNT_ELEMENT_reference_volume)[0],
                      .dt = dt,
                      .viscous = viscous,
                      .tension_only = body->material.tension_only,
                      .spring = body->hourglass_coefficient * density * c0 * c0,
                      .damper = body->hourglass_coefficient * density * c0 * (body->dim == 3 ? (real)0.25 : 1),
                      .lateral = body->lateral_ratio,
                      .c0 = c0,
                      .rho = density,
                      .norm = body->hourglass_norm,
                      .overlap = body->hourglass_overlap,
                      .cosine = (real)sqrt((double)body->hourglass_overlap),
                      .thickness = body->thickness,
                      .mark = keeps ? body->mark : NULL,
                      .kept = keeps ? memory + brunt_fem_tile_reals(body) : NULL};
}
