#include "mpm/transfer.h"

#include <math.h>
#include <string.h>

#include "base/simd.h"
#include "base/array.h"
#include "base/memory.h"
#include "grid/bspline.h"
#include "grid/node.h"

// ------------------------------------------------------------------------------------------ shared by all instances

#define SYMMETRIC_INDEX(dim, r, c) ((r) == (c) ? (r) : (dim) == 2 ? 3 : (r) + (c) == 1 ? 3 : (r) + (c) == 3 ? 4 : 5)

typedef struct scatter_arrays {
    const real *x[3], *v[3], *C[9], *tau[6], *F[9], *mass, *volume;
    const uint8_t *bin;
    const real *all[32];
    int count; // for the prefetches
} scatter_arrays;

static void scatter_arrays_of(brunt_body *body, scatter_arrays *f) {
    brunt_particles *p = &body->particles;
    f->count = 0;
#define TAKE(to, field, n)                                                                                             \
    for (int c = 0; c < (n); c++) f->all[f->count++] = (to)[c] = brunt_field(p, BRUNT_FIELD_##field)[c]
    for (int a = 0; a < p->dim; a++) f->all[f->count++] = f->x[a] = brunt_kernel_place(p)[a];
    if (brunt_total_lagrangian(p)) TAKE(f->F, deformation_gradient, BRUNT_MATRIX(p->dim));
    TAKE(f->v, velocity, p->dim);
    TAKE(f->C, affine, p->field[BRUNT_FIELD_affine].components);
    TAKE(f->tau, kirchhoff_stress, BRUNT_SYMMETRIC(p->dim)); // of rings, those that are not zero
    TAKE(&f->mass, mass, 1);
    TAKE(&f->volume, reference_volume, 1);
#undef TAKE
    f->bin = p->bin;
}

// Bins ahead of the hardware's own prefetching, which follows fewer streams than there are arrays.
BRUNT_INLINE void prefetch_scatter(const scatter_arrays *f, int64_t s) {
    for (int k = 0; k < f->count; k++) __builtin_prefetch(f->all[k] + s + 6 * BRUNT_LANES, 0, 2);
}

// The bin's coordinate along an axis, as reals.
BRUNT_INLINE lanes bin_coordinate(const uint8_t *bin, int dim, int axis) {
    lanes r;
    int shift = dim == 3 ? 4 - 2 * axis : 3 - 3 * axis, mask = dim == 3 ? 3 : 7;
    for (int l = 0; l < BRUNT_LANES; l++) r[l] = (real)(bin[l] >> shift & mask);
    return r;
}

// Cells from the base node. One expression for both ways: near the end of a kernel's reach its last bit decides the
// weight.
BRUNT_INLINE lanes local_coordinate(lanes x, real corner, real inv_h, lanes bin) { return (x - corner) * inv_h - bin; }

// A light node feels particles only with the last 1/1000 of their kernels. Their stress throws it far, as force over
// mass grows without bound there; the weights make up for it, but the polynomials of the gather would lose the digits.
// So the window holds its old velocity, and what it changed by is added with the exact weights (add_light_nodes).
typedef struct light_node {
    int16_t at[3];
    real change[3];
} light_node;
enum { MAX_WINDOW = 11 * 11 > 7 * 7 * 7 ? 11 * 11 : 7 * 7 * 7 };

static real light_mass(const brunt_body *body) {
    const real shares[] = {0, (real)1e-3, (real)1e-6, (real)1e-9};
    return shares[body->grid.order] * body->particle_mass;
}

// Of rings a particle's mass grows with the distance from the axis; at the axis half a cell counts.
static real ring_light_mass(const brunt_body *body, int32_t node) {
    const brunt_grid *grid = &body->grid;
    const double r = fabs(grid->origin[0] + (double)grid->h * node);
    return light_mass(body) * (real)fmax(r, 0.5 * (double)grid->h);
}

// Velocities of the nodes that a block's bins touch: `width` reals a node, the new velocity first and, for a width of
// 8, the old one from the fourth on.
// Returns the number of light nodes.
BRUNT_INLINE int load_window(const brunt_body *body, const brunt_block *block, real *window, light_node *light,
                             int width, int dim, int order) {
    const brunt_grid *grid = &body->grid;
    const int side = dim == 3 ? 4 : 8, span = side + order;
    const bool rings = dim == 2 && brunt_axisymmetric(&body->particles);
    real least = light_mass(body);
    int lights = 0;
    for (int x = 0; x < span; x++) {
        if (rings) least = ring_light_mass(body, block->coord[0] * side + x);
        for (int y = 0; y < span; y++) {
            int corner = (x >= side) * 2 + (y >= side), cx = x % side, cy = y % side;
            for (int half = 0; half < (dim == 3 ? 2 : 1); half++) {
                int slot = dim == 3 ? block->slot[corner * 2 + half] : block->slot[corner];
                int n = dim == 2 ? 1 : half ? order : side;
                const real *from = brunt_slot_nodes(grid, slot) + (dim == 3 ? (cx * 4 + cy) * 4 : cx * 8 + cy) * 8;
                real *to = window + (dim == 3 ? (x * span + y) * span + half * side : x * span + y) * width;
                for (int z = 0; z < n; z++, from += 8, to += width) {
                    node4_store(to, node4_load(from + BRUNT_NODE_VELOCITY));
                    if (width == 8) node4_store(to + 3, node4_load(from + BRUNT_NODE_OLD));
                    if (!(from[BRUNT_NODE_MASS] < least) || !(from[BRUNT_NODE_MASS] > 0)) continue;
                    light_node *node = &light[lights++];
                    *node = (light_node){.at = {(int16_t)x, (int16_t)y, (int16_t)(half * side + z)}};
                    for (int r = 0; r < dim; r++) {
                        node->change[r] = from[BRUNT_NODE_VELOCITY + r] - from[BRUNT_NODE_OLD + r];
                        to[r] = from[BRUNT_NODE_OLD + r];
                    }
                }
            }
        }
    }
    return lights;
}

// `out` as the gather fills it: velocity, gradient, affine (if `affine`).
static void add_light_nodes(const brunt_body *body, const brunt_block *block, const int32_t *start,
                            const light_node *light, int lights, real *const *out, bool affine) {
    const brunt_grid *grid = &body->grid;
    const int dim = grid->dim, order = grid->order;
    real *const *x = brunt_kernel_place(&body->particles);
    for (const light_node *node = light; node < light + lights; node++)
        for (int k = 0; k < (dim == 3 ? (order + 1) * (order + 1) * (order + 1) : (order + 1) * (order + 1)); k++) {
            int number[3] = {0, 0, 0}, bin[3] = {0, 0, 0}; // the node's number in the bin's kernel; the bin
            bool inside = true;
            for (int a = dim - 1, rest = k; a >= 0; a--, rest /= order + 1) {
                number[a] = rest % (order + 1);
                bin[a] = node->at[a] - number[a];
                inside = inside && bin[a] >= 0 && bin[a] < grid->side;
            }
            if (!inside) continue;
            const int32_t *range = start + brunt_node_index(grid, bin[0], bin[1], bin[2]);
            for (int32_t s = range[0]; s < range[1]; s++) {
                real w[3] = {1, 1, 1}, g[3] = {0, 0, 0}, spread[3] = {1, 1, 1}, d[3] = {0, 0, 0};
                for (int a = 0; a < dim; a++) {
                    const real corner = (real)(grid->origin[a] + (double)grid->h * (block->coord[a] * grid->side));
                    lanes at = lanes_set(x[a][block->first + s]);
                    lanes u = local_coordinate(at, corner, grid->inv_h, lanes_set((real)bin[a])), weight[4], slope[4];
                    bspline_weights(order, u, weight);
                    bspline_slopes(order, u, grid->inv_h, slope);
                    w[a] = weight[number[a]][0], g[a] = slope[number[a]][0];
                    d[a] = ((real)number[a] - u[0]) * grid->h;
                    spread[a] = bspline_moment(order, at - (real)grid->origin[a], grid->h, grid->inv_h)[0];
                }
                real weight = w[0] * w[1] * w[2];
                const real slope[3] = {g[0] * w[1] * w[2], w[0] * g[1] * w[2], w[0] * w[1] * g[2]};
                for (int r = 0; r < dim; r++) {
                    out[r][s] += weight * node->change[r];
                    for (int a = 0; a < dim; a++) {
                        out[dim + r * dim + a][s] += slope[a] * node->change[r];
                        if (!affine) continue;
                        real share = order == 1 ? slope[a] : weight * d[a] / spread[a];
                        out[dim + dim * dim + r * dim + a][s] += share * node->change[r];
                    }
                }
            }
        }
}

// Of total-Lagrangian bodies: the inverse of a matrix with rows one after the other.
BRUNT_INLINE void inverse_matrix(int dim, const lanes *F, lanes *inverse) {
    if (dim == 2) {
        const lanes over = 1 / (F[0] * F[3] - F[1] * F[2]);
        inverse[0] = over * F[3], inverse[1] = -over * F[1], inverse[2] = -over * F[2], inverse[3] = over * F[0];
        return;
    }
    lanes cofactor[9];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            cofactor[3 * r + c] = F[3 * r1 + c1] * F[3 * r2 + c2] - F[3 * r1 + c2] * F[3 * r2 + c1];
        }
    const lanes over = 1 / (F[0] * cofactor[0] + F[1] * cofactor[1] + F[2] * cofactor[2]);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) inverse[3 * r + c] = over * cofactor[3 * c + r];
}

// Bound of the square of the greatest 1 / principal stretch of the particles at s: Gershgorin's circles of F^-T F^-1,
// exact along the axes.
BRUNT_INLINE lanes inverse_stretch(int dim, real *const *F, int64_t s) {
    lanes A[9], inverse[9], bound = (lanes){0};
    for (int c = 0; c < dim * dim; c++) A[c] = lanes_load(F[c] + s);
    inverse_matrix(dim, A, inverse);
    for (int r = 0; r < dim; r++) {
        lanes row = (lanes){0};
        for (int c = 0; c < dim; c++) {
            lanes product = (lanes){0};
            for (int k = 0; k < dim; k++) product += inverse[r * dim + k] * inverse[c * dim + k];
            row += c == r ? product : lanes_abs(product);
        }
        bound = lanes_max(bound, row);
    }
    return bound;
}

// What the stress at the end of the step does over the block's particles [W]. The rate it works on is that of the
// motion as it stands at the end, Fdot F^-1 = L (I + dt L)^-1 = L - dt L L + O(dt^2).
static double stress_power(brunt_body *body, const brunt_block *block, real dt, real *const *gradient) {
    brunt_particles *p = &body->particles; // of rings the part in the plane: its components have the same places
    const int dim = p->dim;
    real *const *tau = brunt_field(p, BRUNT_FIELD_kirchhoff_stress);
    const real *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    lanes sum = (lanes){0};
    for (int64_t i = 0; i < block->count; i += BRUNT_LANES) {
        int64_t s = block->first + i;
        lanes power = (lanes){0}, L[9];
        for (int c = 0; c < dim * dim; c++) L[c] = lanes_load(gradient[c] + i);
        for (int r = 0; r < dim; r++)
            for (int c = 0; c < dim; c++) {
                lanes rate = L[r * dim + c];
                for (int k = 0; k < dim; k++) rate -= dt * L[r * dim + k] * L[k * dim + c];
                power += lanes_load(tau[SYMMETRIC_INDEX(dim, r, c)] + s) * rate;
            }
        sum += lanes_load(volume + s) * power;
    }
    return (double)lanes_sum(sum);
}

// What the hoop stress of rings does, likewise [W].
static double hoop_power(brunt_body *body, const brunt_block *block, real dt, const real *hoop) {
    const real *tau = brunt_field(&body->particles, BRUNT_FIELD_kirchhoff_stress)[2];
    const real *volume = brunt_field(&body->particles, BRUNT_FIELD_reference_volume)[0];
    lanes sum = (lanes){0};
    for (int64_t i = 0; i < block->count; i += BRUNT_LANES) {
        int64_t s = block->first + i;
        const lanes rate = lanes_load(hoop + i);
        sum += lanes_load(volume + s) * lanes_load(tau + s) * (rate - dt * rate * rate);
    }
    return (double)lanes_sum(sum);
}

// The nine components of a ring's velocity gradient.
static void ring_rates(const brunt_workspace *work, int32_t padded, real *rates[9]) {
    real *zero = work->out[BRUNT_OUT_ZERO];
    memset(zero, 0, (size_t)padded * sizeof *zero);
    for (int c = 0; c < 9; c++) rates[c] = zero;
    rates[0] = work->out[2], rates[1] = work->out[3], rates[3] = work->out[4], rates[4] = work->out[5];
    rates[8] = work->out[BRUNT_OUT_HOOP];
}

static void update_material(brunt_body *body, const brunt_block *block, real dt, brunt_workspace *work,
                            real *const *gradient, brunt_block_report *report) {
    int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    brunt_material_points points[BRUNT_COMPONENTS];
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        points[k] = brunt_body_points(body, (brunt_component)k, block->first, padded);
        points[k].dt = dt;
        for (int c = 0; c < BRUNT_MATRIX(points[k].dim); c++) points[k].L[c] = gradient[c];
    }
    brunt_update_result result =
        brunt_material_update(&body->material, points, work->plastic, work->viscous, work->strain);
    if (result.bad >= 0) {
        report->bad = (int32_t)block->first + result.bad;
        report->reason = result.reason;
    }
    report->wave_speed = result.wave_speed;
    report->failed = result.failed;
}

// ------------------------------------------------------------------------------------------ instances

#define DIM 2
#define ORDER 1
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 1
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 1
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 1
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 2
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 2
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 3
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 3
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"

#define DIM 2
#define ORDER 1
#define TRANSFER 0
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 0
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 1
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 1
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 2
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 2
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 0
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 0
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 1
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 1
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 2
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 2
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"

// Rings: their gathers use the bins of plane strain above.
#define DIM 2
#define ORDER 1
#define AFFINE 0
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 1
#define AFFINE 1
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define AFFINE 0
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define AFFINE 1
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 0
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 1
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 0
#define STAGE 1
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 0
#define STAGE 2
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 1
#define STAGE 1
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 1
#define STAGE 2
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 2
#define STAGE 1
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 2
#define STAGE 2
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 0
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 1
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 2
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 0
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 1
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 2
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"

// Total-Lagrangian bodies: their gathers use the bins above.
#define DIM 2
#define ORDER 2
#define AFFINE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define AFFINE 1
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 1
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define AFFINE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 2
#define AFFINE 1
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define AFFINE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 3
#define AFFINE 1
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"

#define SCATTERS(d, axis)                                                                                              \
    {                                                                                                                  \
        {scatter_##d##_1_0_##axis, scatter_##d##_1_1_##axis}, {scatter_##d##_2_0_##axis, scatter_##d##_2_1_##axis}, {  \
            scatter_##d##_3_0_##axis, scatter_##d##_3_1_##axis                                                         \
        }                                                                                                              \
    }
#define GATHERS(name)                                                                                                  \
    {                                                                                                                  \
        {name##_1_0_2, name##_1_1_2, name##_1_2_2}, {name##_2_0_0, name##_2_1_0, name##_2_2_0}, {                      \
            name##_3_0_0, name##_3_1_0, name##_3_2_0                                                                   \
        }                                                                                                              \
    }

// Plane strain, space, rings.
static int table_row(int dim, bool axisymmetric) { return axisymmetric ? 2 : dim - 2; }

brunt_p2g_fn *brunt_find_scatter(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_p2g_fn *const table[3][3][2] = {SCATTERS(2, 0), SCATTERS(3, 0), SCATTERS(2, 1)};
    return table[table_row(dim, axisymmetric)][kernel - 1][transfer == BRUNT_APIC];
}

brunt_g2p_fn *brunt_find_gather(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_g2p_fn *const table[3][3][3] = {GATHERS(gather_2), GATHERS(gather_3), GATHERS(gather_axis_2)};
    return table[table_row(dim, axisymmetric)][kernel - 1][transfer];
}

brunt_p2g_fn *brunt_find_total_scatter(int dim, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_p2g_fn *const table[2][3][2] = {
        {{NULL}, {scatter_total_2_2_0_0, scatter_total_2_2_1_0}, {scatter_total_2_3_0_0, scatter_total_2_3_1_0}},
        {{NULL}, {scatter_total_3_2_0_0, scatter_total_3_2_1_0}, {scatter_total_3_3_0_0, scatter_total_3_3_1_0}}};
    return table[dim - 2][kernel - 1][transfer == BRUNT_APIC];
}

brunt_g2p_fn *brunt_find_total_gather(int dim, brunt_kernel kernel, brunt_transfer transfer) {
#define TOTALS(d, order)                                                                                               \
    { gather_total_##d##_##order##_0_0, gather_total_##d##_##order##_1_0, gather_total_##d##_##order##_2_0 }
    static brunt_g2p_fn *const table[2][3][3] = {{{NULL}, TOTALS(2, 2), TOTALS(2, 3)},
                                                 {{NULL}, TOTALS(3, 2), TOTALS(3, 3)}};
#undef TOTALS
    return table[dim - 2][kernel - 1][transfer];
}

brunt_g2p_fn *brunt_find_advance(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_g2p_fn *const table[3][3] = {{gather_2_1_0_1, gather_2_1_1_1, gather_2_1_2_1},
                                              {gather_3_1_0_1, gather_3_1_1_1, gather_3_1_2_1},
                                              {gather_axis_2_1_0_1, gather_axis_2_1_1_1, gather_axis_2_1_2_1}};
    return kernel == BRUNT_LINEAR ? table[table_row(dim, axisymmetric)][transfer] : NULL;
}

// ------------------------------------------------------------------------------------------ workspace

int brunt_workspace_fit(brunt_workspace *work, const brunt_grid *grid, int32_t most) {
    int64_t stride = (most + 2 * BRUNT_LANES + 7) / 8 * 8 + 72; // 9 cache lines apart, see brunt_particles_reserve
    int n = grid->order + 1, arrays = (int)(sizeof work->out / sizeof work->out[0]) + 3;
    int64_t window = ((int64_t)grid->span_nodes + 1) * 8;
    int64_t planes = (int64_t)n * (grid->dim == 3 ? 16 * n * n : 8 * n) * 8;
    size_t reals = (size_t)(window + planes + arrays * stride + 64);
    if (work->memory && work->capacity / sizeof(real) >= reals && work->stride >= stride) return 0;
    if (BRUNT_RESERVE_IN(work->memory, work->capacity, reals, 0)) return -1;
    work->stride = stride;
    work->window = work->memory;
    work->planes = work->window + window;
    real *at = work->planes + planes;
    for (size_t k = 0; k < sizeof work->out / sizeof work->out[0]; k++, at += stride) work->out[k] = at;
    work->plastic = at;
    work->viscous = at + stride;
    work->strain = at + 2 * stride;
    return 0;
}

void brunt_workspace_free(brunt_workspace *work) {
    brunt_free(work->memory);
    *work = (brunt_workspace){0};
}

// ------------------------------------------------------------------------------------------ audit

// One serial pass in the order of the particles, summed in extended precision: the drift it measures is near rounding
// itself.
brunt_audit brunt_body_audit(brunt_body *body) { return brunt_slots_audit(body, NULL, body->particles.slots); }

// The affine part has the lever arms of the undeformed kernel; F takes them to where they are.
static void deformed_spin(brunt_particles *p, int64_t s, double B[3][3]) {
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    for (int r = 0; r < p->dim; r++) {
        double row[3] = {0};
        for (int c = 0; c < p->dim; c++)
            for (int k = 0; k < p->dim; k++) row[c] += B[r][k] * (double)F[c * p->dim + k][s];
        memcpy(B[r], row, sizeof row);
    }
}

// `slots` NULL: all.
brunt_audit brunt_slots_audit(brunt_body *body, const int64_t *slots, int64_t count) {
    brunt_particles *p = &body->particles;
    const int dim = p->dim;
    const brunt_grid *grid = &body->grid;
    real *const *x = brunt_field(p, BRUNT_FIELD_position), *const *v = brunt_field(p, BRUNT_FIELD_velocity);
    real *const *C = brunt_field(p, BRUNT_FIELD_affine), *const *place = brunt_kernel_place(p);
    const real *mass = brunt_field(p, BRUNT_FIELD_mass)[0];
    const bool affine = p->field[BRUNT_FIELD_affine].components > 0, rings = brunt_axisymmetric(p);
    long double total_mass = 0, kinetic = 0, linear[3] = {0}, angular[3] = {0}, centre[3] = {0}, scale_linear = 0,
                scale_angular = 0;
    for (int64_t n = 0; n < count; n++) {
        const int64_t s = slots ? slots[n] : n;
        if (p->id[s] < 0) continue;
        double m = (double)mass[s], X[3] = {0}, V[3] = {0}, spin[3] = {0}, square = 0, B[3][3] = {{0}};
        for (int k = 0; k < dim; k++) X[k] = (double)x[k][s], V[k] = (double)v[k][s], square += V[k] * V[k];
        for (int k = 0; affine && k < dim; k++) {
            double D = (double)bspline_moment(grid->order, lanes_set(place[k][s] - (real)grid->origin[k]), grid->h,
                                              grid->inv_h)[0];
            for (int r = 0; r < dim; r++) {
                double c = (double)C[r * dim + k][s];
                B[r][k] = c * D;
                square += c * c * D;
            }
        }
        if (brunt_total_lagrangian(p)) deformed_spin(p, s, B);
        if (rings) { // the circle's sums; only sizes are left of what cancels
            total_mass += m;
            kinetic += 0.5 * m * square;
            linear[1] += m * V[1];
            centre[1] += m * X[1];
            scale_linear += m * sqrt(square);
            continue;
        }
        for (int k = 0; k < 3; k++) spin[k] = B[(k + 2) % 3][(k + 1) % 3] - B[(k + 1) % 3][(k + 2) % 3];
        total_mass += m;
        kinetic += 0.5 * m * square;
        double size = 0;
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            linear[k] += m * V[k];
            centre[k] += m * X[k];
            angular[k] += m * (X[i] * V[j] - X[j] * V[i] + spin[k]);
            size += X[k] * X[k];
        }
        scale_linear += m * sqrt(square);
        scale_angular += m * sqrt(square * size);
    }
    brunt_audit a = {.mass = (double)total_mass,
                     .kinetic = (double)kinetic,
                     .scale_linear = (double)scale_linear,
                     .scale_angular = (double)scale_angular};
    for (int k = 0; k < 3; k++) {
        a.linear[k] = (double)linear[k];
        a.angular[k] = (double)angular[k];
        a.centre[k] = total_mass > 0 ? (double)(centre[k] / total_mass) : 0;
    }
    return a;
}
