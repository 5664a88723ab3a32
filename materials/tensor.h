// Small tensors of lanes and the frame every material's loop shares: deformation measures, a bound of the principal
// stretch, and the record of wave speeds and failed points. Always inlined with a literal dim, so that 2D does no 3D
// work.
//
// Deformation enters as H = F - I and what is made from it, never as F^T F - I or det F - 1: strains of 1e-8 then keep
// their digits. Layouts as in real.h; in 2D the zz component of H is 0 (plane strain).
//   H = F - I     J = det F     B = F F^T - I     e:f full contraction of symmetric tensors
#pragma once

#include "base/array.h"
#include "base/simd_math.h"
#include "materials/material.h"

#ifdef BRUNT_FLOAT
#define MATERIAL_REAL_MAX FLT_MAX
#else
#define MATERIAL_REAL_MAX DBL_MAX
#endif

enum { XX, YY, ZZ, XY, YZ, XZ };

BRUNT_INLINE void load_displacement_gradient(int dim, const brunt_material_points *points, int32_t i, lanes H[9]) {
    for (int k = 0; k < dim * dim; k++) H[k] = lanes_load(points->F[k] + i);
    for (int k = 0; k < dim; k++) H[k * (dim + 1)] -= 1;
}

// dt L, the displacement gradient of the step.
BRUNT_INLINE void load_step_gradient(int dim, const brunt_material_points *points, int32_t i, lanes H[9]) {
    for (int k = 0; k < dim * dim; k++) H[k] = lanes_load(points->L[k] + i) * points->dt;
}

BRUNT_INLINE lanes load_divergence(int dim, const brunt_material_points *points, int32_t i) {
    lanes d = lanes_load(points->L[0] + i) + lanes_load(points->L[dim + 1] + i);
    return dim == 3 ? d + lanes_load(points->L[8] + i) : d;
}

// det(I + H) - 1, from the invariants of H.
BRUNT_INLINE lanes volume_change(int dim, const lanes H[9]) {
    if (dim == 2) return (H[0] + H[3]) + (H[0] * H[3] - H[1] * H[2]);
    lanes minor_x = H[4] * H[8] - H[5] * H[7], minor_y = H[0] * H[8] - H[2] * H[6], minor_z = H[0] * H[4] - H[1] * H[3];
    lanes determinant = H[0] * minor_x - H[1] * (H[3] * H[8] - H[5] * H[6]) + H[2] * (H[3] * H[7] - H[4] * H[6]);
    return (H[0] + H[4] + H[8]) + (minor_x + minor_y + minor_z) + determinant;
}

// B = F F^T - I = H + H^T + H H^T
BRUNT_INLINE void finger_strain(int dim, const lanes H[9], lanes B[6]) {
    if (dim == 2) {
        B[XX] = 2 * H[0] + (H[0] * H[0] + H[1] * H[1]);
        B[YY] = 2 * H[3] + (H[2] * H[2] + H[3] * H[3]);
        B[XY] = (H[1] + H[2]) + (H[0] * H[2] + H[1] * H[3]);
        return;
    }
    B[XX] = 2 * H[0] + (H[0] * H[0] + H[1] * H[1] + H[2] * H[2]);
    B[YY] = 2 * H[4] + (H[3] * H[3] + H[4] * H[4] + H[5] * H[5]);
    B[ZZ] = 2 * H[8] + (H[6] * H[6] + H[7] * H[7] + H[8] * H[8]);
    B[XY] = (H[1] + H[3]) + (H[0] * H[3] + H[1] * H[4] + H[2] * H[5]);
    B[YZ] = (H[5] + H[7]) + (H[3] * H[6] + H[4] * H[7] + H[5] * H[8]);
    B[XZ] = (H[2] + H[6]) + (H[0] * H[6] + H[1] * H[7] + H[2] * H[8]);
}

// The functions below take symmetric tensors; `plane` ones have no zz component in 2D (H, B), the others do (stress,
// b).
BRUNT_INLINE lanes plane_trace(int dim, const lanes a[6]) { return dim == 3 ? a[XX] + a[YY] + a[ZZ] : a[XX] + a[YY]; }

BRUNT_INLINE lanes contraction(int dim, const lanes a[6]) {
    lanes off = a[XY] * a[XY];
    if (dim == 3) off += a[YZ] * a[YZ] + a[XZ] * a[XZ];
    return (a[XX] * a[XX] + a[YY] * a[YY] + a[ZZ] * a[ZZ]) + 2 * off;
}

BRUNT_INLINE lanes symmetric_determinant(int dim, const lanes a[6]) {
    lanes in_plane = a[XX] * a[YY] - a[XY] * a[XY];
    if (dim == 2) return in_plane * a[ZZ];
    return a[ZZ] * in_plane - a[XX] * a[YZ] * a[YZ] + a[XZ] * (2 * a[XY] * a[YZ] - a[YY] * a[XZ]);
}

// Upper bound of the greatest principal stretch squared, 1 + the greatest eigenvalue of B, by Gershgorin's circles;
// exact along the axes. The time step needs a bound, not the eigenvalue.
BRUNT_INLINE lanes stretch_squared_bound(int dim, const lanes B[6]) {
    lanes xy = lanes_abs(B[XY]);
    if (dim == 2) return 1 + lanes_max(lanes_max(B[XX], B[YY]) + xy, lanes_set(0));
    lanes yz = lanes_abs(B[YZ]), xz = lanes_abs(B[XZ]);
    return 1 + lanes_max(B[XX] + (xy + xz), lanes_max(B[YY] + (xy + yz), B[ZZ] + (yz + xz)));
}

// --------------------------------------------------------------------------------- what an update tells its caller

// Failures are recorded without branching: per lane, the first vector that failed.
typedef struct update_record {
    lanes speed_squared;
    lane_mask deformation, model; // first bad vector for either reason, -1 while there is none
} update_record;

BRUNT_INLINE update_record update_begin(void) {
    return (update_record){lanes_set(0), (lane_mask){0} - 1, (lane_mask){0} - 1};
}

BRUNT_INLINE void note_first(lane_mask *first, lane_mask bad, int32_t i) {
    lane_mask set = bad & (*first < 0);
    *first = (*first & ~set) | (i & set);
}

// A point is good when 0 < J < infinity; a NaN or an infinity anywhere in F makes J fail that.
BRUNT_INLINE void note_deformation(update_record *record, lanes J, int32_t i) {
    note_first(&record->deformation, ~((J > 0) & (J <= MATERIAL_REAL_MAX)), i);
}

BRUNT_INLINE void note_speed(update_record *record, lanes speed_squared) {
    record->speed_squared = lanes_max(speed_squared, record->speed_squared);
}

static inline int32_t first_index(lane_mask first) {
    int32_t index = -1;
    for (int l = 0; l < BRUNT_LANES; l++)
        if (first[l] >= 0 && (index < 0 || first[l] + l < index)) index = (int32_t)first[l] + l;
    return index;
}

// `model_reason`: what record.model stands for.
static inline brunt_update_result update_end(const update_record *record, const brunt_material_points *points,
                                             const char *model_reason) {
    brunt_update_result result = {.wave_speed = (real)sqrt((double)lanes_max_of(record->speed_squared)), .bad = -1};
    int32_t deformation = first_index(record->deformation), model = first_index(record->model);
    if (deformation >= 0 && (model < 0 || deformation <= model)) {
        result.bad = deformation;
        result.reason = "the deformation gradient has turned inside out (J <= 0)";
        for (int k = 0; k < BRUNT_MATRIX(points->dim); k++)
            if (!isfinite(points->F[k][deformation]) || (points->L[k] && !isfinite(points->L[k][deformation])))
                result.reason = "the deformation gradient or the velocity gradient is not a finite number";
    } else if (model >= 0) {
        result.bad = model;
        result.reason = model_reason;
    }
    return result;
}

// --------------------------------------------------------------------------------- energies

// Sum over many vectors: in lanes for speed, carried into a double often enough that a float build keeps its digits.
typedef struct lane_total {
    lanes part;
    int count;
    double sum;
} lane_total;

BRUNT_INLINE double total_end(lane_total *total) {
    for (int l = 0; l < BRUNT_LANES; l++) total->sum += (double)total->part[l];
    total->part = lanes_set(0);
    total->count = 0;
    return total->sum;
}

BRUNT_INLINE void total_add(lane_total *total, lanes a) {
    total->part += a;
    if (++total->count == 16) total_end(total);
}

// A component of the state, in J/m^3 of reference volume, over all points [J].
static inline double state_total(const brunt_material_points *points, int component) {
    lane_total total = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES)
        total_add(&total, lanes_load(points->volume + i) * lanes_load(points->state[component] + i));
    return total_end(&total);
}

// --------------------------------------------------------------------------------- by dimension

// A model's functions from its update_dim and energy_dim, which take the dimension as a literal.
#define MATERIAL_UPDATE                                                                                                \
    static brunt_update_result update(const real *constants, const brunt_material_points *points) {                    \
        return points->dim == 2 ? update_dim(2, constants, points) : update_dim(3, constants, points);                 \
    }
#define MATERIAL_ENERGY                                                                                                \
    static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {   \
        if (points->dim == 2)                                                                                          \
            energy_dim(2, constants, points, energy);                                                                  \
        else                                                                                                           \
            energy_dim(3, constants, points, energy);                                                                  \
    }

// Wave speed of what carries no elastic stress.
static inline real no_wave_speed(const real *constants) {
    (void)constants;
    return 0;
}

// --------------------------------------------------------------------------------- elastic constants

static inline double shear_modulus(double E, double nu) { return E / (2 * (1 + nu)); }
static inline double bulk_modulus(double E, double nu) { return E / (3 * (1 - 2 * nu)); }
static inline double lame_lambda(double E, double nu) { return E * nu / ((1 + nu) * (1 - 2 * nu)); }

#define PARAMETER_E                                                                                                    \
    { "E", "Pa", NAN, 0, INFINITY, true, true, "Young's modulus" }
#define PARAMETER_NU                                                                                                   \
    { "nu", "1", NAN, -1, 0.5, true, true, "Poisson's ratio" }
