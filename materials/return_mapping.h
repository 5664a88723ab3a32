// Finite-strain J2 plasticity: the kinematics, return mapping, stress and energy that every von Mises type model
// shares. A model adds its flow stress and the plastic increment that meets it.
//
// After Simo, CMAME 66 (1988) 199 and 68 (1988) 1; Simo and Hughes, Computational Inelasticity (1998), chapter 9:
// the state is the isochoric elastic left Cauchy-Green tensor b (det b = 1),
//   psi = mu/2 (tr b - 3) + U(J),  U = kappa/2 ((J^2 - 1)/2 - ln J),  tau = kappa/2 (J^2 - 1) I + mu dev b,
// carried by a trial step b = det(.)^(-1/3) (I + dt L) b (I + dt L)^T and a radial return of d = dev b. Three things
// differ:
//   - the trial is scaled by its own determinant, not by det(I + dt L)^(-2/3), so rounding does not add up over the
//     steps;
//   - after the return tr b is solved from det b = 1 (Simo keeps the trial's), so the stored energy is that of b;
//   - Simo's mu tr(b)/3 per unit of plastic flow is right to first order in d only: with it the energy that leaves psi
//     differs from stress times plastic strain by Y/mu however small the step. Here the modulus is the one for which
//     they agree. From det b = 1: (3 m^2 - d:d/2) dm = m d:dd - cof(d):dd with m = tr b/3; asking d psi = -|s| dgamma
//     of dd along d gives
//       mu_bar = mu (m^2 - d:d/6) / (m - 3 det d / d:d),
//     taken at the middle of the return. In uniaxial stress the plastic strain then is the logarithmic one. The energy
//     closes to second order in the step; where the Lode angle of d changes under flow a first-order rest of about Y/mu
//     times a tenth stays (measured: 4e-8 of the work at strain steps of 3e-6).
//
// Where a failure model softens, the flow stress is multiplied by the point's integrity: the stress then falls back to
// it in one step, and what was stored becomes plastic work by the same trapezoid. Models take `softens` as a literal.
//
//   notation  m = tr b/3   d = dev b   q = sqrt(3/2) |s|, s = mu d   delta: increment of equivalent plastic strain
#pragma once

#include "materials/tensor.h"

enum { J2_MU, J2_KAPPA, J2_INVERSE_DENSITY, J2_CONSTANTS };

// State: b (6 or 4 components), then these, then the model's own.
enum { J2_PLASTIC_STRAIN, J2_PLASTIC_WORK, J2_MODEL_STATE };
BRUNT_INLINE int j2_slot(int dim, int field) { return BRUNT_SYMMETRIC(dim) + field; }

static inline real j2_initial_b(const real *constants, int component) {
    (void)constants;
    return component < 3 ? 1 : 0;
}

#define J2_STATE                                                                                                       \
    {"elastic_left_cauchy_green", "1", 6, 4, j2_initial_b}, {"plastic_strain", "1", 1, 1, NULL}, {                     \
        "plastic_work", "J/m^3", 1, 1, NULL                                                                            \
    }

// With an equation of state kappa is 0, which takes the pressure, its energy and its share of the wave speed away.
static inline void j2_prepare(double E, double nu, double density, bool with_eos, real *constants) {
    constants[J2_MU] = (real)shear_modulus(E, nu);
    constants[J2_KAPPA] = with_eos ? 0 : (real)bulk_modulus(E, nu);
    constants[J2_INVERSE_DENSITY] = (real)(1 / density);
}

static inline real j2_wave_speed(const real *constants) {
    double modulus = (double)constants[J2_KAPPA] + 4 * (double)constants[J2_MU] / 3;
    return (real)sqrt(modulus * (double)constants[J2_INVERSE_DENSITY]);
}

typedef struct j2_point {
    lanes volume_change;      // J - 1
    lanes m, d[6], dd, det_d; // trial b = m I + d; d:d
    lanes q, q_old;           // von Mises stress: of the trial, from j2_return on of the end; of the last step
    lanes inverse_q;          // of the trial, with the stiffness
    lanes stiffness;          // 3 mu_bar: q falls by it per unit of plastic strain
    lanes plastic_strain;     // of the last step
} j2_point;

// x^y for y >= 0; 0 for x <= 0, also where y is 0.
BRUNT_INLINE lanes power(lanes x, real y) {
    lanes tiny = lanes_set(LANES_REAL_MIN);
    return lanes_select(x > tiny, lanes_pow(lanes_max(x, tiny), lanes_set(y)), lanes_set(0));
}

// Splits b into m I + d.
BRUNT_INLINE lanes j2_deviator(int dim, const lanes b[6], lanes d[6]) {
    lanes m = (b[XX] + b[YY] + b[ZZ]) * (real)(1.0 / 3);
    for (int k = 0; k < 3; k++) d[k] = b[k] - m;
    for (int k = 3; k < BRUNT_SYMMETRIC(dim); k++) d[k] = b[k];
    return m;
}

BRUNT_INLINE lanes j2_equivalent(const real *k, lanes dd) { return k[J2_MU] * lanes_sqrt((real)1.5 * dd); }

// f b f^T with f = I + H.
BRUNT_INLINE void j2_push(int dim, const lanes H[9], const lanes b[6], lanes out[6]) {
    if (dim == 2) {
        lanes fxx = 1 + H[0], fyy = 1 + H[3];
        lanes a0 = fxx * b[XX] + H[1] * b[XY], a1 = fxx * b[XY] + H[1] * b[YY];
        lanes a2 = H[2] * b[XX] + fyy * b[XY], a3 = H[2] * b[XY] + fyy * b[YY];
        out[XX] = a0 * fxx + a1 * H[1];
        out[YY] = a2 * H[2] + a3 * fyy;
        out[XY] = a0 * H[2] + a1 * fyy;
        out[ZZ] = b[ZZ];
        return;
    }
    lanes f[9], a[9];
    for (int k = 0; k < 9; k++) f[k] = H[k];
    for (int k = 0; k < 9; k += 4) f[k] += 1;
    for (int r = 0; r < 3; r++) {
        const lanes *row = f + 3 * r;
        a[3 * r] = row[0] * b[XX] + row[1] * b[XY] + row[2] * b[XZ];
        a[3 * r + 1] = row[0] * b[XY] + row[1] * b[YY] + row[2] * b[YZ];
        a[3 * r + 2] = row[0] * b[XZ] + row[1] * b[YZ] + row[2] * b[ZZ];
    }
    out[XX] = a[0] * f[0] + a[1] * f[1] + a[2] * f[2];
    out[YY] = a[3] * f[3] + a[4] * f[4] + a[5] * f[5];
    out[ZZ] = a[6] * f[6] + a[7] * f[7] + a[8] * f[8];
    out[XY] = a[0] * f[3] + a[1] * f[4] + a[2] * f[5];
    out[YZ] = a[3] * f[6] + a[4] * f[7] + a[5] * f[8];
    out[XZ] = a[0] * f[6] + a[1] * f[7] + a[2] * f[8];
}

// The elastic trial of a vector of points.
BRUNT_INLINE j2_point j2_trial(int dim, const real *k, const brunt_material_points *points, int32_t i,
                               update_record *record) {
    j2_point p;
    lanes H[9], b[6], d[6];
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) b[c] = lanes_load(points->state[c] + i);
    j2_deviator(dim, b, d);
    p.q_old = j2_equivalent(k, contraction(dim, d));
    load_step_gradient(dim, points, i, H);
    lanes trial[6];
    j2_push(dim, H, b, trial);
    lanes determinant = symmetric_determinant(dim, trial), scale = lanes_inverse_cbrt(determinant);
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) trial[c] *= scale;
    p.m = j2_deviator(dim, trial, p.d);
    p.dd = contraction(dim, p.d);
    p.det_d = symmetric_determinant(dim, p.d);
    p.q = j2_equivalent(k, p.dd);
    p.plastic_strain = lanes_load(points->state[j2_slot(dim, J2_PLASTIC_STRAIN)] + i);
    load_displacement_gradient(dim, points, i, H);
    p.volume_change = volume_change(dim, H);
    // det b <= 0 or not finite where the step itself (I + dt L) is inside out or not finite.
    lane_mask good = (determinant > 0) & (determinant <= MATERIAL_REAL_MAX);
    note_deformation(record, lanes_select(good, 1 + p.volume_change, lanes_set(0)), i);
    return p;
}

// 3 mu_bar where q is `share` of the trial's.
BRUNT_INLINE void j2_set_stiffness_at(const real *k, j2_point *p, lanes share) {
    lanes numerator = p->m * p->m - share * share * p->dd * (real)(1.0 / 6);
    p->stiffness = 3 * k[J2_MU] * numerator * p->dd / (p->m * p->dd - 3 * share * p->det_d);
}

// At the middle of the return, whose end q_old estimates (exactly so in steady flow).
BRUNT_INLINE void j2_set_stiffness(const real *k, j2_point *p) {
    p->inverse_q = 1 / p->q;
    j2_set_stiffness_at(k, p, (real)0.5 * (1 + lanes_min(p->q_old * p->inverse_q, lanes_set(1))));
}

// What is left of the flow stress, 1 to 0; and the stiffness of a return that may end much lower for it: where the area
// under q over the return has its centroid, with which the trapezoid of the plastic work is that area (at the middle
// Y/mu times a sixth of what was stored would be missed).
BRUNT_INLINE lanes j2_integrity(bool softens, const brunt_material_points *points, int32_t i) {
    return softens ? lanes_load(points->integrity + i) : lanes_set(1);
}
BRUNT_INLINE void j2_set_softened_stiffness(const real *k, const brunt_material_points *points, int32_t i,
                                            j2_point *p) {
    lanes before = lanes_load(points->integrity_before + i), now = lanes_load(points->integrity + i);
    lanes end = p->q_old * lanes_select(before > 0, now / before, lanes_set(0));
    p->inverse_q = 1 / p->q;
    lanes r = lanes_min(end * p->inverse_q, lanes_set(1));
    j2_set_stiffness_at(k, p, (real)(2.0 / 3) * (1 + r * (1 + r)) / (1 + r));
}

// Scales d by q_new / q where `plastic`, and solves m^3 - (d:d/2) m + det d = 1 for m by Newton's method. The start is
// the root to second order in d:d while that is small, else (strains of 1: seldom) a bound above the root, from where
// Newton falls monotonically. Lanes stop one by one, so that a point's bits do not depend on its neighbours.
BRUNT_INLINE void j2_return(int dim, j2_point *p, lane_mask plastic, lanes q_new) {
    lanes ratio = lanes_select(plastic, q_new * p->inverse_q, lanes_set(1));
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) p->d[c] *= ratio;
    p->dd *= ratio * ratio;
    p->det_d *= ratio * ratio * ratio;
    p->q = lanes_select(plastic, q_new, p->q);
    lanes half = (real)0.5 * p->dd, m = 1 + (half - p->det_d) * (real)(1.0 / 3);
    const lane_mask small = half < 1;
    if (lanes_any(~small)) {
        const lanes above = (real)1.2 * lanes_sqrt(half) + (real)0.5 / lanes_max(half, lanes_set(1));
        m = lanes_select(small, m, above);
    }
    lane_mask active = plastic;
    for (int step = 0; step < 60 && lanes_any(active); step++) {
        lanes change = (m * (m * m - half) + (p->det_d - 1)) / (3 * m * m - half);
        m = lanes_select(active, m - change, m);
        // Newton converges quadratically: after a change of the square root of rounding the next one is rounding.
#ifdef BRUNT_FLOAT
        active &= lanes_abs(change) > (real)1e-4 * m;
#else
        active &= lanes_abs(change) > (real)1e-9 * m;
#endif
    }
    p->m = lanes_select(plastic, m, p->m);
}

// What flowed in a step: plastic increment, and von Mises stress at its end; 0 and any finite number where nothing did.
typedef struct j2_flow {
    lanes delta, q;
} j2_flow;

// The deviator's part of rho0 c^2 along n, 4/3 mu m - s_nn / 3, at most: |s_nn| <= 2/3 q.
BRUNT_INLINE lanes j2_shear_stiffness(const real *k, const j2_point *p) {
    return (real)(4.0 / 3) * k[J2_MU] * p->m + (real)(2.0 / 9) * p->q;
}

// Writes stress and state. Returns the plastic work of the step: the trapezoid of stress over plastic strain, as
// everywhere (material.h).
BRUNT_INLINE lanes j2_store(int dim, const real *k, const brunt_material_points *points, int32_t i, const j2_point *p,
                            j2_flow flow, update_record *record) {
    lanes pressure = (real)0.5 * k[J2_KAPPA] * p->volume_change * (2 + p->volume_change);
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) {
        lanes s = k[J2_MU] * p->d[c];
        lanes_store(points->stress[c] + i, c < 3 ? s + pressure : s);
        lanes_store(points->state[c] + i, c < 3 ? p->d[c] + p->m : p->d[c]);
    }
    lanes work = (real)0.5 * flow.delta * (p->q_old + flow.q);
    real *plastic_work = points->state[j2_slot(dim, J2_PLASTIC_WORK)] + i;
    lanes_store(points->state[j2_slot(dim, J2_PLASTIC_STRAIN)] + i, p->plastic_strain + flow.delta);
    lanes_store(plastic_work, lanes_load(plastic_work) + work);
    if (points->plastic_increment) lanes_store(points->plastic_increment + i, work);
    if (points->strain_increment) lanes_store(points->strain_increment + i, flow.delta);
    // The volume's: kappa (J^2 + 1)/2.
    lanes volumetric = k[J2_KAPPA] * (1 + p->volume_change * (1 + (real)0.5 * p->volume_change));
    note_speed(record, k[J2_INVERSE_DENSITY] * (volumetric + j2_shear_stiffness(k, p)));
    return work;
}

// psi_dev from d alone: m^3 - 1 = (d:d/2) m - det d keeps the digits that tr b - 3 loses.
BRUNT_INLINE void j2_energy_dim(int dim, const real *k, const brunt_material_points *points,
                                brunt_point_energy *energy) {
    lane_total stored = {0}, plastic = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9], b[6], d[6];
        for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) b[c] = lanes_load(points->state[c] + i);
        lanes m = j2_deviator(dim, b, d);
        lanes above_one = ((real)0.5 * contraction(dim, d) * m - symmetric_determinant(dim, d)) / (1 + m * (1 + m));
        lanes density = (real)1.5 * k[J2_MU] * above_one;
        load_displacement_gradient(dim, points, i, H);
        lanes change = volume_change(dim, H);
        density += (real)0.5 * k[J2_KAPPA] * ((real)0.5 * change * (2 + change) - lanes_log1p(change));
        lanes volume = lanes_load(points->volume + i);
        total_add(&stored, volume * density);
        total_add(&plastic, volume * lanes_load(points->state[j2_slot(dim, J2_PLASTIC_WORK)] + i));
    }
    energy->internal += total_end(&stored);
    energy->plastic += total_end(&plastic);
}

static inline void j2_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    if (points->dim == 2)
        j2_energy_dim(2, constants, points, energy);
    else
        j2_energy_dim(3, constants, points, energy);
}

// --------------------------------------------------------------------------------- implicit plastic increment

// Newton's method for q_trial - stiffness delta = flow(delta), kept inside a bracket that shrinks with every
// evaluation: 0 (where the trial is above the flow stress) to q_trial / stiffness (where no stress is left). Any step
// that leaves the bracket is replaced by halving it, so steep rate and power laws cannot throw it out.
typedef struct j2_root {
    lanes delta, low, high;
    lane_mask active;
} j2_root;

enum { J2_ROOT_STEPS = 60 };
#ifdef BRUNT_FLOAT
#define J2_ROOT_TOLERANCE 2e-6f
#else
#define J2_ROOT_TOLERANCE 1e-10
#endif

BRUNT_INLINE j2_root j2_root_begin(const j2_point *p, lane_mask plastic) {
    j2_root root = {.low = lanes_set(0), .high = p->q / p->stiffness, .active = plastic};
    // In steady flow the stress ends where it began.
    lanes guess = (p->q - p->q_old) / p->stiffness;
    root.delta = lanes_select((guess > 0) & (guess < root.high), guess, (real)0.5 * root.high);
    return root;
}

// Lanes whose flow stress is 0 have their root at the upper end, which the search would only come near.
BRUNT_INLINE lane_mask j2_root_collapse(j2_root *root, lanes integrity) {
    lane_mask gone = root->active & ~(integrity > 0);
    root->delta = lanes_select(gone, root->high, root->delta);
    root->active &= ~gone;
    return gone;
}

// One step after flow and its slope were evaluated at root->delta; lanes that have converged keep their delta.
BRUNT_INLINE void j2_root_step(const j2_point *p, j2_root *root, lanes flow, lanes slope) {
    lanes rest = p->q - p->stiffness * root->delta - flow;
    root->active &= ~(lanes_abs(rest) <= J2_ROOT_TOLERANCE * p->q);
    root->low = lanes_select(root->active & (rest > 0), root->delta, root->low);
    root->high = lanes_select(root->active & ~(rest > 0), root->delta, root->high);
    lanes next = root->delta + rest / (p->stiffness + slope);
    // The root may lie many decades below its upper bound (a point that hardly yields): halve the exponent, not the
    // interval.
    const lane_mask within = (next > root->low) & (next < root->high);
    if (lanes_any(root->active & ~within)) {
        const lanes middle = lanes_select(root->low > 0, lanes_sqrt(root->low * root->high), (real)1e-3 * root->high);
        next = lanes_select(within, next, middle);
    }
    root->delta = lanes_select(root->active, next, root->delta);
}

// Lanes whose bracket has closed on less than changes the stress, without a root that can be told: the law rises
// from its start by more than that within less than the least number there is, as a power of a small exponent does.
// Nothing flows.
BRUNT_INLINE void j2_root_closed(const j2_point *p, j2_root *root, lanes *q) {
    const lane_mask closed = root->active & (p->stiffness * root->high <= J2_ROOT_TOLERANCE * p->q);
    root->delta = lanes_select(closed, lanes_set(0), root->delta);
    *q = lanes_select(closed, p->q, *q);
    root->active &= ~closed;
}
