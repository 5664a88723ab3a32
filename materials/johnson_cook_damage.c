// Johnson-Cook damage (Johnson and Cook, Engineering Fracture Mechanics 21 (1985) 31): damage grows with plastic
// strain,
//   dD = d eps_p / eps_f,   eps_f = (D1 + D2 exp(D3 s*)) (1 + D4 ln(max(rate / rate0, 1))) (1 + D5 T*),  0 <= T* <= 1,
// with s* the mean stress over the von Mises stress, both of the end of the step (tension positive: 1/3 in uniaxial
// tension, 0 in shear, -1/3 in uniaxial compression; D3 is negative where tension embrittles), the rate that of plastic
// strain, and T* as in the flow stress of that name. A point has failed when D is 1; there it stays.
//
// The formula may give no fracture strain at all (D1 < 0): where it is not positive a point fails as soon as it flows.
// Three things are not of 1985 and off by default:
//   onset   the flow stress falls linearly to 0 between this damage and 1 (by `integrity`, from the next step on);
//   spall   a mean Cauchy stress that reaches it fails a point at once, flowing or not;
//   cutoff  no damage grows below this s*. Bao and Wierzbicki (International Journal of Fracture 130 (2005), "On the
//           cut-off value of negative triaxiality for fracture") found none below -1/3 in upsetting tests; published
//           sets of D1..D3 are fitted without it, and with D3 of -0.5 a third of the damage of a shear band under
//           pressure may lie there, so that it belongs to a set and not to the law.
#include "materials/tensor.h"

enum { D1, D2, D3, D4, D5, INVERSE_RATE_ZERO, REFERENCE, INVERSE_RANGE, ONSET_SLOPE, SPALL, CUTOFF, COLD_FACTOR };
enum { DAMAGE, INTEGRITY, INTEGRITY_BEFORE };

// clang-format off
static const brunt_parameter parameters[] = {
    {"d1", "1", NAN, -INFINITY, INFINITY, true, true, "fracture strain, without the terms below"},
    {"d2", "1", 0, -INFINITY, INFINITY, true, true, "factor of the dependence on triaxiality"},
    {"d3", "1", 0, -INFINITY, INFINITY, true, true, "exponent per triaxiality (mean stress over von Mises stress, tension positive)"},
    {"d4", "1", 0, -INFINITY, INFINITY, true, true, "rate dependence"},
    {"d5", "1", 0, -INFINITY, INFINITY, true, true, "temperature dependence"},
    {"rate0", "1/s", 1, 0, INFINITY, true, true, "plastic strain rate below which rate has no effect; default: the strength model's, where it has one"},
    {"melt", "K", INFINITY, 0, INFINITY, true, false, "melting temperature; likewise"},
    {"reference_temperature", "K", 293.15, 0, INFINITY, false, true, "temperature below which heat has no effect; likewise"},
    {"onset", "1", 1, 0, 1, false, false, "damage from which on the flow stress falls, to 0 at damage 1; 1: all at once"},
    {"spall", "Pa", INFINITY, 0, INFINITY, true, false, "mean tension that fails a point at once"},
    {"cutoff", "1", -INFINITY, -INFINITY, INFINITY, false, true, "triaxiality below which no damage grows, such as -1/3"},
};
// clang-format on
enum { P_D1, P_D2, P_D3, P_D4, P_D5, P_RATE_ZERO, P_MELT, P_REFERENCE, P_ONSET, P_SPALL, P_CUTOFF };

static real sound(const real *constants, int component) {
    (void)constants, (void)component;
    return 1;
}

static const brunt_state_field state[] = {
    {"damage", "1", 1, 1, NULL}, {"integrity", "1", 1, 1, sound}, {"integrity_before", "1", 1, 1, sound}};

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    (void)density, (void)with_eos;
    if (!(p[P_MELT] > p[P_REFERENCE])) return "failure: melt is not above reference_temperature";
    if (p[P_D5] != 0 && isinf(p[P_MELT])) return "failure: d5 wants melt and a model with a temperature";
    // Without an exponent the second term is a part of the first: 0 times an infinite triaxiality is so never met.
    const bool flat = p[P_D3] == 0 || p[P_D2] == 0;
    constants[D1] = (real)(p[P_D1] + (flat ? p[P_D2] : 0));
    constants[D2] = (real)(flat ? 0 : p[P_D2]);
    constants[D3] = (real)p[P_D3];
    constants[D4] = (real)p[P_D4];
    constants[D5] = (real)p[P_D5];
    constants[INVERSE_RATE_ZERO] = (real)(1 / p[P_RATE_ZERO]);
    constants[REFERENCE] = (real)p[P_REFERENCE];
    constants[INVERSE_RANGE] = (real)(1 / (p[P_MELT] - p[P_REFERENCE]));
    constants[ONSET_SLOPE] = p[P_ONSET] < 1 ? (real)(1 / (1 - p[P_ONSET])) : MATERIAL_REAL_MAX;
    constants[SPALL] = (real)p[P_SPALL];
    constants[CUTOFF] = (real)p[P_CUTOFF];
    constants[COLD_FACTOR] = 1; // T* = 0 until a body says otherwise
    return NULL;
}

// Mean Kirchhoff stress over the von Mises stress; infinite, of the sign of the mean, where there is no deviator.
BRUNT_INLINE lanes triaxiality(int dim, const lanes tau[6], lanes mean) {
    lanes s[6];
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) s[c] = c < 3 ? tau[c] - mean : tau[c];
    lanes q = lanes_sqrt((real)1.5 * contraction(dim, s));
    return mean / lanes_max(q, lanes_set(LANES_REAL_MIN));
}

// 1 + D5 T*
BRUNT_INLINE lanes heat_factor(const real *k, lanes temperature) {
    lanes t = (temperature - k[REFERENCE]) * k[INVERSE_RANGE];
    return 1 + k[D5] * lanes_min(lanes_max(t, lanes_set(0)), lanes_set(1));
}

// Of a strength model whose temperature stays.
static void set_temperature(real *constants, double temperature) {
    constants[COLD_FACTOR] = lanes_max_of(heat_factor(constants, lanes_set((real)temperature)));
}

BRUNT_INLINE lanes fracture_strain(const real *k, const brunt_material_points *points, int32_t i, lanes triaxial,
                                   lanes rate) {
    lanes one = lanes_set(1), strain = lanes_set(k[D1]);
    if (k[D2] != 0) strain += k[D2] * lanes_exp(k[D3] * triaxial);
    if (k[D4] != 0) strain *= 1 + k[D4] * lanes_log(lanes_max(rate * k[INVERSE_RATE_ZERO], one));
    if (k[D5] != 0)
        strain *= points->temperature ? heat_factor(k, lanes_load(points->temperature + i)) : lanes_set(k[COLD_FACTOR]);
    return strain;
}

// Damage after the step of a vector of points, not yet bounded.
BRUNT_INLINE lanes grow(int dim, const real *k, const brunt_material_points *points, int32_t i, lanes damage,
                        lanes delta) {
    lanes tau[6];
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) tau[c] = lanes_load(points->stress[c] + i);
    lanes mean = (tau[XX] + tau[YY] + tau[ZZ]) * (real)(1.0 / 3), one = lanes_set(1);
    // One mask for branch and selection: gcc 12 takes the comparison, written again behind the branch, for 1 instead of
    // -1 where a vector has one lane.
    lane_mask flows = delta > 0;
    if (lanes_any(flows)) {
        lanes triaxial = triaxiality(dim, tau, mean);
        lanes strain = fracture_strain(k, points, i, triaxial, delta * (1 / points->dt));
        lanes increment = lanes_select(strain > 0, delta / strain, one);
        damage += lanes_select(flows & (triaxial >= k[CUTOFF]), increment, lanes_set(0));
    }
    if (k[SPALL] < (real)INFINITY) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        damage = lanes_select(mean >= k[SPALL] * (1 + volume_change(dim, H)), one, damage);
    }
    return damage;
}

BRUNT_INLINE brunt_update_result update_dim(int dim, bool softens, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    lane_mask failed = {0};
    const bool spalls = k[SPALL] < (real)INFINITY;
    const lanes zero = lanes_set(0), one = lanes_set(1);
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes damage = lanes_load(points->state[DAMAGE] + i), delta = lanes_load(points->strain_increment + i);
        if (spalls || lanes_any(delta != 0)) { // also of what is not a number
            damage = lanes_select(damage < 1, grow(dim, k, points, i, damage, delta), damage);
            note_first(&record.model, ~(damage >= 0) | ~(delta >= 0), i);
            damage = lanes_select(damage > 1, one, damage);
            lanes_store(points->state[DAMAGE] + i, damage);
        }
        failed |= (damage >= 1) & (lanes_load(points->volume + i) > zero);
        if (softens) {
            lanes_store(points->state[INTEGRITY_BEFORE] + i, lanes_load(points->state[INTEGRITY] + i));
            lanes_store(points->state[INTEGRITY] + i, lanes_min((1 - damage) * k[ONSET_SLOPE], one));
        }
    }
    brunt_update_result result = update_end(&record, points, "damage or plastic strain is not a number");
    result.failed = lanes_any(failed);
    return result;
}

static brunt_update_result update(const real *constants, const brunt_material_points *points) {
    return points->dim == 2 ? update_dim(2, true, constants, points) : update_dim(3, true, constants, points);
}

static brunt_update_result update_sudden(const real *constants, const brunt_material_points *points) {
    return points->dim == 2 ? update_dim(2, false, constants, points) : update_dim(3, false, constants, points);
}

// What loses its strength in the step in which it leaves needs no integrity.
static const brunt_model sudden = {
    .name = "johnson-cook-damage",
    .doc = "Johnson-Cook damage without softening",
    .damage = true,
    .parameters = parameters,
    .parameter_count = BRUNT_COUNT(parameters),
    .state = state,
    .state_count = 1,
    .prepare = prepare,
    .set_temperature = set_temperature,
    .update = update_sudden,
};

static const brunt_model *reduced(const double *p) { return p[P_ONSET] < 1 ? NULL : &sudden; }

const brunt_model brunt_johnson_cook_damage = {
    .name = "johnson-cook-damage",
    .doc = "fracture strain by triaxiality, rate and temperature (Johnson and Cook 1985)",
    .damage = true,
    .parameters = parameters,
    .parameter_count = BRUNT_COUNT(parameters),
    .state = state,
    .state_count = BRUNT_COUNT(state),
    .prepare = prepare,
    .set_temperature = set_temperature,
    .reduced = reduced,
    .update = update,
};
