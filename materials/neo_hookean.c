// Compressible neo-Hookean solid (Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, section
// 6.4):
//   psi = mu/2 (tr b - 3) - mu ln J + lambda/2 (ln J)^2,   tau = mu (b - I) + lambda ln(J) I.
//
// In plane stress l3 makes tau_33 = mu (l3^2 - 1) + lambda ln(l1 l2 l3) vanish; then tau_i = mu (l_i^2 - l3^2).
#include "materials/plane_stress.h"
#include "materials/trial.h"

BRUNT_INLINE lanes law(int dim, const real *k, const lanes H[9], lanes change, const lanes B[6], lanes tau[6]) {
    (void)H;
    const real lambda = k[ELASTIC_LAMBDA], mu = k[ELASTIC_MU];
    lanes log_J = lanes_log1p(change), pressure = lambda * log_J;
    tau[XX] = mu * B[XX] + pressure;
    tau[YY] = mu * B[YY] + pressure;
    tau[ZZ] = dim == 3 ? mu * B[ZZ] + pressure : pressure;
    tau[XY] = mu * B[XY];
    if (dim == 3) {
        tau[YZ] = mu * B[YZ];
        tau[XZ] = mu * B[XZ];
    }
    // Along n: rho0 c^2 = lambda (1 - ln J) + mu (1 + b_nn) for the longitudinal wave, mu b_nn for the transverse one.
    lanes stretch = stretch_squared_bound(dim, B);
    lanes modulus = lanes_max(lambda - pressure + mu, lanes_set(0)) + mu * stretch;
    return k[ELASTIC_INVERSE_DENSITY] * modulus;
}

BRUNT_INLINE lanes density_of(int dim, const real *k, const lanes H[9]) {
    lanes B[6];
    finger_strain(dim, H, B);
    lanes log_J = lanes_log1p(volume_change(dim, H));
    return k[ELASTIC_MU] * ((real)0.5 * plane_trace(dim, B) - log_J) + (real)0.5 * k[ELASTIC_LAMBDA] * log_J * log_J;
}

ELASTIC_FUNCTIONS(law, density_of)

// The s for which mu (e^(2s) - 1) + lambda (m s + c) = 0, in the lanes of `wanted`; also growth = e^(2s) - 1. With m =
// 1 and c = ln(l1 l2) s is ln l3 of plane stress, with m = 2 and c = ln l1 it is ln l2 = ln l3 of uniaxial tension.
//
// The left side is convex in s, and at the root of its linear part it is mu (e^(2s) - 1 - 2s) >= 0 and grows, so from
// there Newton's method comes down to the root from above. With lambda >= 0 it grows everywhere and any start will do:
// then the second-order start and Chebyshev's third-order step, with bend = f f'' / (2 f'^2) = curvature step,
//   step = (f / f') (1 + bend),   error left about (2 curvature^2 - 2/3 curvature) step^3,   curvature <= 1,
// take one step at strains up to 0.005 and two up to 0.5 (Newton alone: two, and up to five). With lambda < 0
// (nu < 0) it is Newton alone, which leaves curvature step^2; there is no root in strong compression of both stretches
// (the law lets the membrane shrink to nothing), and s is nan.
//
// A lane stops when the error left is below rounding, and keeps its value whatever the others do.
BRUNT_INLINE lanes natural_logarithm(real lambda, real mu, real m, lanes c, lane_mask wanted, lanes *growth) {
    enum { STEP_LIMIT = 60 };
    const bool third_order = lambda >= 0;
    const real tolerance = LANES_REAL_EPSILON / 4, quarter = (real)0.25;
    lanes s = c * (-lambda / (2 * mu + m * lambda));
    if (third_order) s -= lanes_min(2 * mu / (2 * mu + m * lambda) * (s * s), quarter * lanes_abs(s));
    *growth = lanes_set(0);
    lane_mask open = wanted;
    for (int n = 0; n < STEP_LIMIT && lanes_any(open); n++) {
        lanes grown = lanes_expm1(2 * s), elastic = 2 * mu * (1 + grown), slope = elastic + m * lambda;
        lanes inverse = 1 / slope, step = (mu * grown + lambda * (m * s + c)) * inverse;
        lanes bend = elastic * inverse * step, left = lanes_abs(bend * step);
        if (third_order) {
            left *= (real)(4.0 / 3) * lanes_abs(step);
            step *= 1 + lanes_max(lanes_min(bend, lanes_set(quarter)), lanes_set(-quarter));
        }
        // e^(2s) after the last step, which is small, without another exponential: series of e^(-2 step) - 1
        lanes series = 1 - step * (1 - (real)(2.0 / 3) * step * (1 - (real)0.5 * step));
        *growth = lanes_select(open, grown - (1 + grown) * (2 * step) * series, *growth);
        s = lanes_select(open, s - step, s);
        open &= ~((left <= tolerance * lanes_abs(s)) & (lanes_abs(step) <= (real)0.01) & (slope > 0));
    }
    return lanes_select(open, lanes_set((real)NAN), s);
}

// x - ln(1 + x), which is of second order, without the difference where x is small: with s = x / (2 + x),
// ln(1 + x) = 2 artanh(s) = x - s (x - 2 (s^2/3 + s^4/5 + ...)).
BRUNT_INLINE lanes above_logarithm(lanes x) {
    lanes s = x / (2 + x), z = s * s, series = lanes_set((real)(2.0 / 23));
    for (int n = 10; n > 0; n--) series = series * z + (real)(2.0 / (2 * n + 1));
    lanes small = s * (x - z * series);
    return lanes_select(lanes_abs(x) < (real)0.4, small, x - lanes_log1p(x));
}

BRUNT_INLINE void plane_stress_response_of(const real *k, bool tension_only, const lanes strain[2],
                                           plane_stress_response *r) {
    const real lambda = k[ELASTIC_LAMBDA], mu = k[ELASTIC_MU], half = (real)0.5;
    const lane_mask every = (lane_mask){0} - 1;
    lanes e[2] = {strain[0], strain[1]};
    lanes growth, log_l3, log_area;
    if (tension_only) {
        // Taut when uniaxial tension wants no more width; for nu < 0 it wants more than the undeformed one.
        lanes zero = lanes_set(0), log_1, log_2 = lanes_log1p(e[1]);
        e[0] = lanes_max(e[0], zero);
        log_1 = lanes_log1p(e[0]);
        lanes across = mu * (2 * e[1] + e[1] * e[1]) + lambda * (log_1 + 2 * log_2);
        r->taut = (across >= 0) & ((e[1] >= 0) | ((lane_mask){0} - (lambda >= 0)));
        log_area = log_1 + log_2;
        log_l3 = natural_logarithm(lambda, mu, 1, log_area, r->taut, &growth);
        if (lanes_any(~r->taut)) {
            lanes growth_2, log_w = natural_logarithm(lambda, mu, 2, log_1, ~r->taut, &growth_2);
            growth = lanes_select(r->taut, growth, growth_2);
            log_l3 = lanes_select(r->taut, log_l3, log_w);
            log_area = lanes_select(r->taut, log_area, log_1 + log_w);
            e[1] = lanes_select(r->taut, e[1], growth / (1 + lanes_sqrt(1 + growth)));
        }
    } else {
        log_area = lanes_log1p(e[0] + e[1] + e[0] * e[1]);
        log_l3 = natural_logarithm(lambda, mu, 1, log_area, every, &growth);
    }
    lanes l3 = lanes_sqrt(1 + growth), stiff = 2 * mu * (1 + growth);
    // dtau_i/dln(l_j) with tau_33 kept at 0 is 2 mu l_i^2 delta_ij + bulk
    lanes bulk = lambda * stiff / (stiff + lambda);
    r->thickness = lanes_select(log_l3 == log_l3, l3, log_l3);
    r->shear = lanes_set(mu);
    r->cross = bulk;
    for (int i = 0; i < 2; i++) {
        lanes change = 2 * e[i] + e[i] * e[i];
        r->tau[i] = mu * (change - growth);
        r->along[i] = mu * (1 + change) + (bulk + half * stiff);
    }
    lanes e3 = growth / (1 + l3), log_J = log_area + log_l3;
    lanes shape = half * (e[0] * e[0] + e[1] * e[1] + e3 * e3) +
                  (above_logarithm(e[0]) + above_logarithm(e[1]) + above_logarithm(e3));
    r->energy = mu * shape + half * lambda * log_J * log_J;
}

PLANE_STRESS_FUNCTIONS(plane_stress_response_of)

// --------------------------------------------------------------------------------- implicit steps

// a(G, G) = mu G b : G + lambda (tr G)^2 + (mu - lambda ln J) tr(G G)
BRUNT_INLINE void respond_dim(int dim, const real *k, const brunt_trial_points *trial) {
    const real lambda = k[ELASTIC_LAMBDA], mu = k[ELASTIC_MU], half = (real)0.5;
    for (int32_t i = 0; i < trial->count; i += BRUNT_LANES) {
        lanes H[9], B[6];
        load_trial_gradient(dim, trial->F, i, H);
        lanes change = volume_change(dim, H), log_J = lanes_log1p(change);
        finger_strain(dim, H, B);
        if (trial->density) {
            lanes density = mu * (half * plane_trace(dim, B) - log_J) + half * lambda * log_J * log_J;
            put_density(trial, i, 1 + change, density, false);
        }
        if (trial->stress[0]) {
            lanes tau[6];
            for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++)
                tau[c] = c == ZZ && dim == 2 ? lambda * log_J : mu * B[c] + (c < 3 ? lambda * log_J : lanes_set(0));
            put_stress(dim, trial, i, tau);
        }
        if (trial->tangent[0]) {
            lanes a[45], b[6];
            clear_tangent(dim, a);
            for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++)
                b[c] = c == ZZ && dim == 2 ? lanes_set(mu) : mu * B[c] + (c < 3 ? mu : 0);
            add_geometric(dim, b, a);
            add_volumetric(dim, lanes_set(lambda), mu - lambda * log_J, a);
            put_tangent(dim, trial, i, a, false);
        }
    }
}

TRIAL_RESPOND

PLANE_STRESS_RESPOND(plane_stress_response_of)

static const brunt_model_potential potential = {.respond = respond, .respond_membrane = respond_membrane};

const brunt_model brunt_neo_hookean = {
    .name = "neo-hookean",
    .doc = "compressible neo-Hookean solid with ln J volumetric term (Bonet and Wood): large elastic strains",
    ELASTIC_MODEL,
    .potential = &potential,
    .flops = {78, 136, 169},
    PLANE_STRESS_MODEL,
};
