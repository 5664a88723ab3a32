// Membranes: hyperelastic laws in plane stress, and the same without resistance to compression. What every law shares;
// a law brings its energy W(l1, l2) per reference volume of the principal stretches in the plane, with the stretch l3
// across the membrane already such that no stress acts there.
//
// A point's deformation is the symmetric stretch U. With l = 1 + mean +- d, d the radius of Mohr's circle of U - I, and
// principal Kirchhoff stresses tau_i = l_i dW/dl_i, tau has the axes of U, so its deviator is that of U times
//   (tau_1 - tau_2) / (2 d) = 2 (1 + mean) shear,   shear = (tau_1 - tau_2) / (l1^2 - l2^2),
// where every law has `shear` in closed form: no angle, and nothing special about equal stretches.
//
// Slack (tension field theory: Reissner, Proc. 5th Int. Congr. Appl. Mech. (1938) 88; Pipkin, IMA J. Appl. Math. 36
// (1986) 85; Steigmann, Proc. R. Soc. A 429 (1990) 141): a membrane without bending stiffness folds rather than bear
// compression, which replaces W by its relaxation. With l1 >= l2 and w(l1) the natural width, the l2 at which uniaxial
// tension stretches the membrane by l1 (tau_2 = 0), the relaxed energy is
//   W(l1, l2)     taut      l1 > 1, l2 >= w(l1)
//   W(l1, w(l1))  wrinkled  l1 > 1, l2 < w(l1): tau_2 = 0
//   0             tension_only     l1 <= 1:            tau = 0
// or W of the stretches it is relaxed to, max(l1, 1) and max(l2, w(max(l1, 1))). Both are continuous with their first
// derivatives, since W_2 = 0 at w; folds need no room, so the true stretches enter the deviator alone.
//
// Implicit steps see W(C), C = U^2. With S_i = tau_i / l_i^2 the tangent 4 d2W/dCdC has, in principal axes,
//   1111: (A_1 - tau_1) / l1^4     1122: l1 l2 W_12 / (l1 l2)^2     1212: (S_1 - S_2) / (l1^2 - l2^2) = (shear - S_1) /
//   l2^2
// and where it is wrinkled, tau_2 = 0 along w(l1): A_1 - (l1 l2 W_12)^2 / A_2 for A_1, and nothing with a 22.
//
// Wave speed. Along a direction n of the plane with polarisation m, from the spatial tangent in principal axes (Ogden,
// Non-Linear Elastic Deformations, section 6.1), in current lengths:
//   rho0 c^2 = A1 (n1 m1)^2 + A2 (n2 m2)^2 + shear (l1^2 (n1 m2)^2 + l2^2 (n2 m1)^2) + 2 coupling n1 n2 m1 m2,
//   A_i = l_i^2 W_ii,   coupling = l1 l2 W_12 + (tau_1 l2^2 - tau_2 l1^2) / (l1^2 - l2^2).
// With n1 n2 m1 m2 as (n1 m2)(n2 m1) and |n| |m| = 1 that is at most A = max(A1, A2) where
//   (A - shear l1^2) (A - shear l2^2) >= coupling^2
// with positive factors, and the laws here have it so whenever A > 0: the fastest wave is the longitudinal one along a
// principal axis. Out of the plane rho0 c^2 = tau_nn, which is less. In a wrinkled membrane A is that of the taut one
// at its natural width: there the two tangents differ by a positive one of rank 1 (W_22), and with less width the
// tangent of the wrinkled membrane only falls. Never less than at rest: compression slows the wave, and a tension-only
// membrane has none, but either may be gone within the step.
#pragma once

#include "materials/elastic.h"

typedef struct plane_stress_response {
    lanes tau[2];    // principal Kirchhoff stresses [Pa]
    lanes energy;    // W [Pa]
    lanes thickness; // l3; where it is not a positive number, there is none
    lanes along[2];  // A_i [Pa]
    lanes cross;     // l1 l2 W_12 [Pa]
    lanes shear;     // [Pa]
    lane_mask taut;  // with tension_only only
} plane_stress_response;

// To the principal strains l_i - 1, strain[0] >= strain[1]; when `tension_only`, to those they are relaxed to.
typedef void plane_stress_law(const real *k, bool tension_only, const lanes strain[2], plane_stress_response *response);

typedef struct plane_stress_stretch {
    lanes mean, half, off; // of U - I: (11 + 22) / 2, (11 - 22) / 2, 12
    lanes radius;          // d
    lanes principal[2];    // strains l_i - 1
} plane_stress_stretch;

BRUNT_INLINE plane_stress_stretch plane_stretch(const real *const U[9], int32_t i) {
    plane_stress_stretch u;
    lanes e11 = lanes_load(U[0] + i) - 1, e22 = lanes_load(U[3] + i) - 1;
    u.mean = (real)0.5 * (e11 + e22);
    u.half = (real)0.5 * (e11 - e22);
    u.off = lanes_load(U[1] + i);
    u.radius = lanes_sqrt(u.half * u.half + u.off * u.off);
    u.principal[0] = u.mean + u.radius;
    u.principal[1] = u.mean - u.radius;
    return u;
}

// For laws whose natural width is w - 1 = -contraction * strain in the measure of strain they are linear in.
BRUNT_INLINE lane_mask relax_linear(real contraction, lanes strain[2]) {
    strain[0] = lanes_max(strain[0], lanes_set(0));
    lanes natural = -contraction * strain[0];
    lane_mask taut = strain[1] >= natural;
    strain[1] = lanes_max(strain[1], natural);
    return taut;
}

BRUNT_INLINE brunt_update_result plane_stress_update(plane_stress_law *law, bool tension_only, const real *k,
                                                     const brunt_material_points *points) {
    update_record record = update_begin();
    const real half = (real)0.5;
    const lanes zero = lanes_set(0), rest = lanes_set(k[ELASTIC_PLANE]);
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        plane_stress_stretch u = plane_stretch((const real *const *)points->F, i);
        note_deformation(&record, 1 + u.principal[1], i); // the lesser stretch: a number, and positive, when both are
        plane_stress_response r;
        law(k, tension_only, u.principal, &r);
        note_first(&record.model, ~((r.thickness > 0) & (r.thickness <= MATERIAL_REAL_MAX)), i);
        lanes mean = half * (r.tau[0] + r.tau[1]), deviator = 2 * (1 + u.mean) * r.shear;
        if (tension_only) {
            lanes wrinkled = lanes_select(u.radius > 0, half * r.tau[0] / u.radius, zero);
            mean = lanes_select(r.taut, mean, half * r.tau[0]);
            deviator = lanes_select(r.taut, deviator, wrinkled);
        }
        lanes_store(points->stress[XX] + i, mean + deviator * u.half);
        lanes_store(points->stress[YY] + i, mean - deviator * u.half);
        lanes_store(points->stress[ZZ] + i, zero);
        lanes_store(points->stress[XY] + i, deviator * u.off);
        lanes_store(points->thickness + i, r.thickness);
        note_speed(&record, k[ELASTIC_INVERSE_DENSITY] * lanes_max(rest, lanes_max(r.along[0], r.along[1])));
    }
    return update_end(&record, points,
                      "the membrane has no thickness left (its strains are beyond what the law is for)");
}

BRUNT_INLINE void plane_stress_energy(plane_stress_law *law, bool tension_only, const real *k,
                                      const brunt_material_points *points, brunt_point_energy *energy) {
    lane_total stored = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        plane_stress_stretch u = plane_stretch((const real *const *)points->F, i);
        plane_stress_response r;
        law(k, tension_only, u.principal, &r);
        total_add(&stored, lanes_load(points->volume + i) * r.energy);
    }
    energy->internal += total_end(&stored);
}

// --------------------------------------------------------------------------------- implicit steps

// S_1, S_2 and the tangent 1111, 2222, 1122, 1212 in principal axes.
typedef struct plane_stress_tangent {
    lanes S[2], own[2], cross, shear;
} plane_stress_tangent;

BRUNT_INLINE plane_stress_tangent plane_stress_principal(bool tension_only, const lanes strain[2],
                                                         const plane_stress_response *r) {
    const lanes l[2] = {1 + strain[0], 1 + strain[1]}, C[2] = {l[0] * l[0], l[1] * l[1]}, zero = lanes_set(0);
    plane_stress_tangent t = {.S = {r->tau[0] / C[0], r->tau[1] / C[1]}};
    for (int i = 0; i < 2; i++) t.own[i] = (r->along[i] - r->tau[i]) / (C[i] * C[i]);
    t.cross = r->cross / (C[0] * C[1]);
    t.shear = (r->shear - t.S[0]) / C[1];
    if (!tension_only) return t;
    const lane_mask pulled = strain[0] > 0, taut = r->taut & pulled;
    lanes relaxed = (r->along[0] - r->cross * r->cross / r->along[1] - r->tau[0]) / (C[0] * C[0]);
    t.S[0] = lanes_select(pulled, t.S[0], zero);
    t.S[1] = lanes_select(taut, t.S[1], zero);
    t.own[0] = lanes_select(taut, t.own[0], lanes_select(pulled, relaxed, zero));
    t.own[1] = lanes_select(taut, t.own[1], zero);
    t.cross = lanes_select(taut, t.cross, zero);
    t.shear = lanes_select(taut, t.shear, lanes_select(pulled, t.S[0] / (C[0] - C[1]), zero));
    return t;
}

BRUNT_INLINE void plane_stress_respond(plane_stress_law *law, bool tension_only, const real *k,
                                       const brunt_trial_points *trial) {
    const real half = (real)0.5;
    for (int32_t i = 0; i < trial->count; i += BRUNT_LANES) {
        const plane_stress_stretch u = plane_stretch(trial->F, i);
        plane_stress_response r;
        law(k, tension_only, u.principal, &r);
        const lane_mask there = (u.principal[1] > -1) & (r.thickness > 0);
        if (trial->density) lanes_store(trial->density + i, lanes_select(there, r.energy, lanes_set((real)INFINITY)));
        if (!trial->stress[0] && !trial->tangent[0]) continue;
        const plane_stress_tangent t = plane_stress_principal(tension_only, u.principal, &r);
        // cos and sin of twice the angle of the first axis: any where all are axes
        const lane_mask turned = u.radius > 0;
        const lanes one = lanes_set(1), radius = lanes_select(turned, u.radius, one);
        const lanes c2 = lanes_select(turned, u.half / radius, one), s2 = lanes_select(turned, u.off / radius, 0 * one);
        const lanes P[3][3] = {{half * (1 + c2), half * (1 - c2), half * s2},  // n1 n1
                               {half * (1 - c2), half * (1 + c2), -half * s2}, // n2 n2
                               {-half * s2, half * s2, half * c2}};            // their symmetric product
        for (int m = 0; m < 3 && trial->stress[0]; m++)
            lanes_store(trial->stress[m] + i, t.S[0] * P[0][m] + t.S[1] * P[1][m]);
        for (int m = 0, at = 0; m < 3 && trial->tangent[0]; m++)
            for (int n = m; n < 3; n++, at++)
                lanes_store(trial->tangent[at] + i, t.own[0] * P[0][m] * P[0][n] + t.own[1] * P[1][m] * P[1][n] +
                                                        t.cross * (P[0][m] * P[1][n] + P[1][m] * P[0][n]) +
                                                        4 * t.shear * P[2][m] * P[2][n]);
    }
}

// A model's functions from its law, and its table from them.
#define PLANE_STRESS_FUNCTIONS(law)                                                                                    \
    static brunt_update_result update_plane_stress(const real *constants, const brunt_material_points *points) {       \
        return points->tension_only ? plane_stress_update(law, true, constants, points)                                \
                                    : plane_stress_update(law, false, constants, points);                              \
    }                                                                                                                  \
    static void add_energy_plane_stress(const real *constants, const brunt_material_points *points,                    \
                                        brunt_point_energy *energy) {                                                  \
        if (points->tension_only)                                                                                      \
            plane_stress_energy(law, true, constants, points, energy);                                                 \
        else                                                                                                           \
            plane_stress_energy(law, false, constants, points, energy);                                                \
    }
#define PLANE_STRESS_MODEL                                                                                             \
    .update_plane_stress = update_plane_stress, .energy_plane_stress = add_energy_plane_stress,                        \
    .wave_speed_plane_stress = plane_stress_wave_speed
#define PLANE_STRESS_RESPOND(law)                                                                                      \
    static void respond_membrane(const real *constants, bool tension_only, const brunt_trial_points *trial) {          \
        if (tension_only)                                                                                              \
            plane_stress_respond(law, true, constants, trial);                                                         \
        else                                                                                                           \
            plane_stress_respond(law, false, constants, trial);                                                        \
    }

static inline real plane_stress_wave_speed(const real *constants) {
    return (real)sqrt((double)constants[ELASTIC_PLANE] * (double)constants[ELASTIC_INVERSE_DENSITY]);
}
