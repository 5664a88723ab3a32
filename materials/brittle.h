// What brittle and frictional materials share: Cauchy flow stresses that depend on the pressure, flow stresses that
// damage lowers within the step, a pressure of their own that carries a limited tension, and the accounts of it. The
// deviator is that of j2.h with kappa = 0.
//
// Volume. mu = 1/J - 1, eta = 1 - J = mu / (1 + mu). The pressure does the work p d(eta) per reference volume, so that
// an energy
//   W(eta, s),  p = dW/d(eta)   with internal variables s (damage, compaction, bulking)
// is stored, and what a change of s takes from it is dissipated. Over a step from 0 to 1 that is recorded as
//   loss = 1/2 [W(eta1, s0) - W(eta1, s1) + W(eta0, s0) - W(eta0, s1)],
// which is 0 where s stays, of second order with the trapezoid of the pressure, and right also where s jumps (damage
// from 0 to 1 in a step): the rest is 1/4 d2p d(eta) ds, not dp ds.
//
// Torn. Where the law gives less than -tension the pressure stays there, the gap being open; it closes at the volume
// where it opened. The stored energy has the part tension x gap; damage that lowers the tension dissipates it.
//
// Wave speed. With U(J) per reference volume, rho0 c^2 = J^2 U'' = dp/dmu in the deformed body. It bounds elastic
// changes. A point that flows while it is relieved along a flow stress rising with pressure by b = dq/dp has up to
// dp/dmu (1 + 2/3 b), which for b above 2 G / K is more; it lasts as long as that stress.
#pragma once

#include "materials/return_mapping.h"

// Damage of 1 says that a point has failed and may be taken away (material.h). Material that is but fractured keeps its
// residual strength: its damage stays this far below.
#define BRITTLE_FRACTURED (1 - LANES_REAL_EPSILON)

// Deviators below this part of the shear modulus are rounding: where tension has taken all strength they neither flow
// nor fracture.
#define BRITTLE_ROUNDING (8 * LANES_REAL_EPSILON)

// K1 x + K2 x^2 + K3 x^3 with the three moduli at `modulus`, its slope, and int_0^x (that) / (1 + y)^2 dy for x > -1.
BRUNT_INLINE lanes cubic(const real *modulus, lanes x) { return x * (modulus[0] + x * (modulus[1] + x * modulus[2])); }
BRUNT_INLINE lanes cubic_slope(const real *modulus, lanes x) {
    return modulus[0] + x * (2 * modulus[1] + 3 * x * modulus[2]);
}
// The linear part alone: log(1 + x) - x / (1 + x).
BRUNT_INLINE lanes linear_energy(lanes x) { return lanes_log1p(x) - x / (1 + x); }
BRUNT_INLINE lanes cubic_energy(const real *modulus, lanes x) {
    lanes l = lanes_log1p(x), eta = x / (1 + x);
    lanes square = x - 2 * l + eta, cube = x * ((real)0.5 * x - 2) + 3 * l - eta;
    return modulus[0] * (l - eta) + modulus[1] * square + modulus[2] * cube;
}

// 1 + C log(rate / rate0), 1 below rate0. The rate is sqrt(2/3 e':e') / dt with Green's strain e of the step, 1/2 (f^T
// f - I): a frame that turns, however fast, sees the same. `inverse_rate_step`: 1 / (dt rate0).
BRUNT_INLINE lanes rate_factor(int dim, const brunt_material_points *points, int32_t i, real C,
                               lanes inverse_rate_step) {
    if (!(C > 0)) return lanes_set(1);
    lanes H[9], e[6] = {lanes_set(0), lanes_set(0), lanes_set(0), lanes_set(0), lanes_set(0), lanes_set(0)};
    static const int row[6] = {0, 1, 2, 0, 1, 0}, column[6] = {0, 1, 2, 1, 2, 2};
    load_step_gradient(dim, points, i, H);
    for (int c = 0; c < 6; c++) {
        const int a = row[c], b = column[c];
        if (a >= dim || b >= dim) continue;
        e[c] = H[a * dim + b] + H[b * dim + a];
        for (int m = 0; m < dim; m++) e[c] += H[m * dim + a] * H[m * dim + b];
        e[c] *= (real)0.5;
    }
    lanes d[6];
    j2_deviator(dim, e, d);
    lanes rate = lanes_sqrt((real)(2.0 / 3) * contraction(dim, d)) * inverse_rate_step;
    return 1 + C * lanes_log(lanes_max(rate, lanes_set(1)));
}

BRUNT_INLINE lanes inverse_rate_step(const brunt_material_points *points, real rate0) {
    return lanes_set(points->dt > 0 ? 1 / (points->dt * rate0) : 0);
}

// J - 1 at the beginning of the step: J_old = J / (1 + v), v of the step's own gradient.
BRUNT_INLINE lanes volume_change_before(int dim, const brunt_material_points *points, int32_t i, lanes change) {
    lanes H[9];
    load_step_gradient(dim, points, i, H);
    lanes v = volume_change(dim, H);
    return change - (1 + change) * (v / (1 + v));
}

// --------------------------------------------------------------------------------- return to a flow stress that
// softens

// Flow stress with damage D, which grows by plastic strain / `strain`: limit - drop (D - D0), not below `lower` and not
// above `upper`. All at the pressure of the end of the step.
typedef struct softening {
    lanes damage;       // D0
    lanes limit, drop;  // [Pa] at D0; from D = 0 to D = 1
    lanes lower, upper; // [Pa] lower >= 0
    lanes strain;       // plastic strain from D = 0 to D = 1, >= 0
} softening;

BRUNT_INLINE lanes softening_begin(const softening *s) { return lanes_min(lanes_max(s->limit, s->lower), s->upper); }

// Plastic strain delta with trial - stiffness delta = flow stress, in closed form, for trial > softening_begin. Where
// the flow stress falls faster than the elastic stress there is no way back on the slope (all elastic energy goes at
// once): the root is then on `lower`.
BRUNT_INLINE lanes softening_root(const softening *s, lanes trial, lanes stiffness) {
    lanes spread = stiffness * s->strain - s->drop;
    lanes slope = (trial - s->limit) * s->strain / spread;
    lane_mask on_slope = (spread > 0) & (trial - stiffness * slope > s->lower);
    lanes delta = lanes_select(on_slope, slope, (trial - s->lower) / stiffness);
    lanes capped = (trial - s->upper) / stiffness;
    lane_mask on_cap = (capped > 0) & (s->limit - s->drop * (capped / s->strain) >= s->upper);
    return lanes_select(on_cap, capped, delta);
}

BRUNT_INLINE lanes softening_damage(const softening *s, lanes delta) {
    lanes grown = s->damage + delta / lanes_max(s->strain, lanes_set(LANES_REAL_MIN));
    return lanes_max(s->damage, lanes_min(grown, lanes_set(BRITTLE_FRACTURED)));
}

// Elastic energy of the deviator per 3/2 mu: tr b / 3 - 1 (j2.h).
BRUNT_INLINE lanes distortion(const j2_point *p) {
    return ((real)0.5 * p->dd * p->m - p->det_d) / (1 + p->m * (1 + p->m));
}

// Returns the deviator from the trial to q where `plastic` and gives the plastic strain, 0 elsewhere: that which makes
// the energy set free the trapezoid 1/2 (q_trial + q) delta. Fracture may take all stress in one step, and mu_bar in
// the middle of so long a return is not its mean: with it that energy is wrong by 1e-4, whatever the step.
BRUNT_INLINE lanes return_deviator(int dim, const real *k, j2_point *p, lane_mask plastic, lanes q) {
    lanes trial = p->q, before = distortion(p);
    j2_return(dim, p, plastic, q);
    lanes freed = 3 * k[J2_MU] * (before - distortion(p));
    return lanes_select(plastic, freed / (trial + q), lanes_set(0));
}

// The increment and the stress q it ends at, where `plastic`; 0 and the trial's elsewhere.
BRUNT_INLINE lanes softening_return(int dim, const real *k, j2_point *p, const softening *s, lane_mask plastic,
                                    lanes *q) {
    j2_set_stiffness(k, p);
    lanes end = lanes_max(p->q - p->stiffness * softening_root(s, p->q, p->stiffness), lanes_set(0));
    *q = lanes_select(plastic, end, p->q);
    return return_deviator(dim, k, p, plastic, *q);
}

// --------------------------------------------------------------------------------- storing

// Adds the pressure, Kirchhoff [Pa], to the deviator that j2_store has written; `stiffness` = dp/dmu for the wave
// speed.
BRUNT_INLINE void store_pressure(const real *k, const brunt_material_points *points, int32_t i, const j2_point *p,
                                 lanes pressure, lanes stiffness, update_record *record) {
    for (int c = 0; c < 3; c++) lanes_store(points->stress[c] + i, lanes_load(points->stress[c] + i) - pressure);
    note_speed(record, k[J2_INVERSE_DENSITY] * (stiffness + j2_shear_stiffness(k, p)));
}

BRUNT_INLINE void add_plastic_work(int dim, const brunt_material_points *points, int32_t i, lanes work) {
    real *sum = points->state[j2_slot(dim, J2_PLASTIC_WORK)] + i;
    lanes_store(sum, lanes_load(sum) + work);
}

// Damage of 1 where the plastic strain has passed `limit`. Returns whether a point with volume is among them.
BRUNT_INLINE bool fail_beyond(int dim, const brunt_material_points *points, int32_t i, real limit, real *damage) {
    if (!(limit < (real)INFINITY)) return false;
    lane_mask failed = lanes_load(points->state[j2_slot(dim, J2_PLASTIC_STRAIN)] + i) > limit;
    lanes_store(damage, lanes_select(failed, lanes_set(1), lanes_load(damage)));
    return lanes_any(failed & (lanes_load(points->volume + i) > 0));
}

static inline void brittle_prepare(double shear, double density, real *constants) {
    constants[J2_MU] = (real)shear;
    constants[J2_KAPPA] = 0;
    constants[J2_INVERSE_DENSITY] = (real)(1 / density);
}

static inline real brittle_wave_speed(const real *constants, real bulk) {
    return (real)sqrt(((double)bulk + 4 * (double)constants[J2_MU] / 3) * (double)constants[J2_INVERSE_DENSITY]);
}

#define PARAMETER_G                                                                                                    \
    { "G", "Pa", NAN, 0, INFINITY, true, true, "shear modulus" }
#define PARAMETER_FAILURE_STRAIN                                                                                       \
    {                                                                                                                  \
        "failure_strain", "1", INFINITY, 0, INFINITY, true, false,                                                     \
            "equivalent plastic strain at which the material fails and may erode; default: never"                      \
    }

// --------------------------------------------------------------------------------- cohesion and friction

// Parameters of Drucker-Prager and Mohr-Coulomb, in this order.
#define BRITTLE_HALF_PI 1.57079632679489662
#define FRICTIONAL_PARAMETERS                                                                                          \
    PARAMETER_E, PARAMETER_NU,                                                                                         \
        {"cohesion", "Pa",  NAN,  0,                                                                                   \
         INFINITY,   false, true, "cohesion c of Mohr and Coulomb: shear strength without pressure"},                  \
        {"friction_angle", "rad", NAN, 0, BRITTLE_HALF_PI, false, true, "angle of internal friction"},                 \
        {"dilatancy_angle", "rad", 0,    0,                                                                            \
         BRITTLE_HALF_PI,   false, true, "how shear opens it: 0 keeps the volume, friction_angle is associated flow"}, \
        {"hardening", "Pa",  0,    0,                                                                                  \
         INFINITY,    false, true, "linear hardening of the cohesion: per equivalent plastic strain"},                 \
    {                                                                                                                  \
        "tension", "Pa", INFINITY, 0, INFINITY, false, false,                                                          \
            "greatest hydrostatic tension; at most cohesion / tan(friction_angle)"                                     \
    }

// Flow that opens less than friction lets it is stiffer than what stays elastic: squeezed across n, a point that gives
// way loses pressure, with it strength, and the stress along n gains what the deviator loses of it. With A and B what
// flow takes from the stress along n and what n adds to the yield function, per unit and by directions of the share
// `along` of n in the axis of most pressure, rho0 c^2 grows by -A B / D: between where A < 0 < B, the greatest.
typedef struct frictional_slope {
    double start, by_share; // A or B: start - by_share along
} frictional_slope;
static inline double frictional_stiffening(frictional_slope A, frictional_slope B, double D) {
    const double middle = 0.5 * (A.start / A.by_share + B.start / B.by_share), along = fmin(fmax(middle, 0), 1);
    return fmax(0, -(A.start - A.by_share * along) * (B.start - B.by_share * along) / D);
}

// What is wrong with them, NULL: nothing.
static inline const char *frictional_parameters(const double *p, bool with_eos) {
    if (with_eos) return "this model gives its own pressure and takes no equation of state";
    if (!(p[2] > 0 || p[3] > 0)) return "cohesion and friction_angle are both 0: there is no strength";
    if (p[4] > p[3]) return "dilatancy_angle is above friction_angle: flow would create energy";
    return NULL;
}

// Energy per reference volume of mean stress min(bulk volume, tension), `volume` the logarithm of the elastic one.
BRUNT_INLINE lanes opening_energy(real bulk, real tension, lanes volume) {
    lanes opening = lanes_set(tension / bulk), closed = lanes_min(volume, opening);
    lanes gap = lanes_select(volume > opening, tension * (volume - opening), lanes_set(0));
    return (real)0.5 * bulk * closed * closed + gap;
}

// --------------------------------------------------------------------------------- energies

// Stored energy of the volume of a range, the deviator's beside it: stored(k, J - 1, the model's own variable, damage),
// the last two by their places behind J2_MODEL_STATE.
typedef lanes brittle_stored_fn(const real *k, lanes change, lanes variable, lanes damage);
BRUNT_INLINE void brittle_energy_dim(int dim, const real *k, const brunt_material_points *points, int variable,
                                     int damage, brittle_stored_fn *stored, brunt_point_energy *energy) {
    lane_total sum = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        lanes s = lanes_load(points->state[j2_slot(dim, variable)] + i);
        lanes D = lanes_load(points->state[j2_slot(dim, damage)] + i);
        total_add(&sum, lanes_load(points->volume + i) * stored(k, volume_change(dim, H), s, D));
    }
    energy->internal += total_end(&sum);
}
BRUNT_INLINE void brittle_energy(const real *k, const brunt_material_points *points, int variable, int damage,
                                 brittle_stored_fn *stored, brunt_point_energy *energy) {
    j2_energy(k, points, energy);
    if (points->dim == 2)
        brittle_energy_dim(2, k, points, variable, damage, stored, energy);
    else
        brittle_energy_dim(3, k, points, variable, damage, stored, energy);
}
