// Holmquist-Johnson-Cook, concrete (Holmquist, Johnson and Cook, A computational constitutive model for concrete
// subjected to large strains, high strain rates, and high pressures, 14th International Symposium on Ballistics, Quebec
// (1993) 591).
//   sigma* = [A (1 - D) + B P*^N] (1 + C ln e*) <= SMAX,   * stresses and pressures over fc, e* = strain rate / rate0
//   >= 1 P* < 0:  A (1 - D) falls on a line to 0 at P* = -T* (1 - D) dD = (d eps_p + d mu_p) / eps_f,   eps_f = D1 (P*
//   + T*)^D2 >= EFMIN
// sigma and P are Cauchy stresses, not below -T (1 - D); the strain rate is the equivalent total one.
//
// Pressure over mu = 1/J - 1, h the greatest mu there was, from mu_crush to the end of compaction mu_dense:
//   h = mu_crush    P = Ke mu, Ke = P_crush / mu_crush
//   h between       P on the line from (mu_crush, P_crush) to (mu_dense, P_lock) while mu = h grows; below h, P = Ku
//   (mu - mu_p) with
//                   Ku = Ke + F (Kd - Ke), F = (h - mu_crush) / (mu_dense - mu_crush): unloading interpolated between
//                   the regions
//   h = mu_dense    P = K1 m + K2 m^2 + K3 m^3, m = (mu - mu_lock) / (1 + mu_lock)
// mu_dense is where the last law gives P_lock. Below P_lock dense material has its chord, from (mu_lock, 0) to
// (mu_dense, P_lock), so that Kd = P_lock / (mu_dense - mu_lock) and neither pressure nor energy jumps when the last
// pore closes (with the law's own slope for Kd they would, by 0.6 % of the energy for the concrete of the paper). mu_p
// is the plastic volumetric strain.
//
// Compaction is dissipated (brittle.h: the stored energy is that of unloading) and counted as plastic work.
#include "materials/brittle.h"

enum {
    K1 = J2_CONSTANTS,
    K2,
    K3,
    A,
    B,
    N,
    RATE,
    RATE_ZERO,
    FC,
    SMAX,
    D1,
    D2,
    EFMIN,
    CRUSH,
    CRUSH_PRESSURE,
    LOCK,
    DENSE,
    SLOPE,
    ELASTIC,
    CHORD,
    DENSE_ENERGY,
    TENSION,
    TENSION_STAR,
    FAILURE_STRAIN
};
enum { DAMAGE = J2_MODEL_STATE, COMPACTION };

static const brunt_parameter parameters[] = {
    PARAMETER_G,
    {"fc", "Pa", NAN, 0, INFINITY, true, true, "uniaxial compressive strength, quasi-static: unit of the strengths"},
    {"A", "1", NAN, 0, INFINITY, false, true, "cohesive strength, lost by damage: A (1 - D) + B P*^N"},
    {"B", "1", NAN, 0, INFINITY, false, true, "pressure hardening"},
    {"N", "1", NAN, 0, INFINITY, true, true, "exponent of the pressure hardening"},
    {"C", "1", 0, 0, INFINITY, false, true, "rate sensitivity"},
    {"rate0", "1/s", 1, 0, INFINITY, true, true, "strain rate below which rate has no effect"},
    {"SMAX", "1", INFINITY, 0, INFINITY, true, false, "greatest strength over fc"},
    {"D1", "1", NAN, 0, INFINITY, false, true, "plastic strain to fracture: D1 (P* + T*)^D2"},
    {"D2", "1", 1, 0, INFINITY, false, true, "exponent of the plastic strain to fracture"},
    {"EFMIN", "1", NAN, 0, INFINITY, true, true, "least plastic strain to fracture"},
    {"T", "Pa", NAN, 0, INFINITY, true, true, "greatest hydrostatic tension of sound material"},
    {"P_crush", "Pa", NAN, 0, INFINITY, true, true, "pressure at which pores begin to be crushed"},
    {"mu_crush", "1", NAN, 0, INFINITY, true, true, "volumetric strain there: density ratio - 1"},
    {"P_lock", "Pa", NAN, 0, INFINITY, true, true, "pressure at which all pores are crushed"},
    {"mu_lock", "1", NAN, 0, INFINITY, true, true, "volumetric strain of dense material without pressure"},
    {"K1", "Pa", NAN, 0, INFINITY, true, true, "dense: P = K1 m + K2 m^2 + K3 m^3, m = (mu - mu_lock) / (1 + mu_lock)"},
    {"K2", "Pa", 0, -INFINITY, INFINITY, true, true, "second coefficient of the dense material's pressure"},
    {"K3", "Pa", 0, -INFINITY, INFINITY, true, true, "third coefficient of the dense material's pressure"},
    PARAMETER_FAILURE_STRAIN,
};

static real initial_compaction(const real *constants, int component) {
    (void)component;
    return constants[CRUSH];
}

static const brunt_state_field state[] = {
    J2_STATE, {"damage", "1", 1, 1, NULL}, {"compaction", "1", 1, 1, initial_compaction}};

// The least m > 0 with K1 m + K2 m^2 + K3 m^3 = pressure, by Newton's method from 0; 0 when there is none on the rising
// branch.
static double dense_strain(const double K[3], double pressure) {
    double m = 0;
    for (int step = 0; step < 200; step++) {
        const double slope = K[0] + m * (2 * K[1] + 3 * m * K[2]);
        const double rest = pressure - m * (K[0] + m * (K[1] + m * K[2]));
        if (!(slope > 0)) return 0;
        if (fabs(rest) <= 1e-15 * pressure) break;
        m += rest / slope;
    }
    return m > 0 && fabs(m * (K[0] + m * (K[1] + m * K[2])) - pressure) <= 1e-12 * pressure ? m : 0;
}

static const char *prepare_pressure(const double *p, real *constants) {
    const double crush = p[13], lock = p[15], elastic = p[12] / crush, m = dense_strain(p + 16, p[14]);
    if (!(p[14] > p[12])) return "P_lock is not above P_crush";
    if (!(m > 0)) return "K1, K2 and K3 give no pressure as high as P_lock";
    const double dense = lock + m * (1 + lock), chord = p[14] / (dense - lock);
    if (!(dense > crush)) return "mu_lock leaves nothing to compact above mu_crush";
    if (!((p[14] - p[12]) / (dense - crush) < elastic))
        return "compaction is stiffer than elastic: P_lock or mu_crush is too large";
    if (chord < elastic) return "dense material (K1) is softer than sound (P_crush / mu_crush)";
    if (!(p[11] < p[12])) return "T is not below P_crush";
    constants[CRUSH] = (real)crush;
    constants[CRUSH_PRESSURE] = (real)p[12];
    constants[LOCK] = (real)lock;
    constants[DENSE] = (real)dense;
    constants[SLOPE] = (real)((p[14] - p[12]) / (dense - crush));
    constants[ELASTIC] = (real)elastic;
    constants[CHORD] = (real)chord;
    for (int c = 0; c < 3; c++) constants[K1 + c] = (real)p[16 + c];
    // Of the law and of the chord, up to P_lock.
    const double l = log1p(m), eta = m / (1 + m);
    const double law = p[16] * (l - eta) + p[17] * (m - 2 * l + eta) + p[18] * (m * (0.5 * m - 2) + 3 * l - eta);
    constants[DENSE_ENERGY] = (real)(law / (1 + lock));
    return NULL;
}

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    if (with_eos) return "this model gives its own pressure and takes no equation of state";
    if (!(p[2] > 0 || p[3] > 0)) return "A and B are both 0: there is no strength";
    brittle_prepare(p[0], density, constants);
    static const int place[] = {FC, A, B, N, RATE, RATE_ZERO, SMAX, D1, D2, EFMIN, TENSION};
    for (int c = 0; c < BRUNT_COUNT(place); c++) constants[place[c]] = (real)p[c + 1];
    constants[TENSION_STAR] = (real)(p[11] / p[1]);
    constants[FAILURE_STRAIN] = (real)p[19];
    return prepare_pressure(p, constants);
}

// Unloading from the compaction h: its slope, and where it meets no pressure (mu_p, 0 before anything is crushed).
BRUNT_INLINE lanes unloading(const real *k, lanes h, lanes *plastic_volume) {
    lanes beyond = h - k[CRUSH], F = beyond * (1 / (k[DENSE] - k[CRUSH]));
    lanes slope = lanes_select(h >= k[DENSE], lanes_set(k[CHORD]), k[ELASTIC] + F * (k[CHORD] - k[ELASTIC]));
    lanes left = h - (k[CRUSH_PRESSURE] + k[SLOPE] * beyond) / slope;
    left = lanes_select(h >= k[DENSE], lanes_set(k[LOCK]), left);
    *plastic_volume = lanes_select(beyond > 0, left, lanes_set(0));
    return slope;
}

// Pressure of a state that stays, without the limit of tension; `stiffness` dP/dmu, the greater of loading and
// unloading.
BRUNT_INLINE lanes pressure_at(const real *k, lanes mu, lanes h, lanes *stiffness) {
    lanes left, slope = unloading(k, h, &left), pressure = slope * (mu - left);
    lane_mask dense = (h >= k[DENSE]) & (mu > k[DENSE]);
    lanes m = (mu - k[LOCK]) * (1 / (1 + k[LOCK]));
    *stiffness = lanes_select(dense, cubic_slope(k + K1, m) * (1 / (1 + k[LOCK])), slope);
    return lanes_select(dense, cubic(k + K1, m), pressure);
}

// W per reference volume; `change` = J - 1.
BRUNT_INLINE lanes stored_energy(const real *k, lanes change, lanes h, lanes damage) {
    lanes left, slope = unloading(k, h, &left), mu = -change / (1 + change), tension = k[TENSION] * (1 - damage);
    lane_mask dense = (h >= k[DENSE]) & (mu > k[DENSE]);
    lanes opening = left - tension / slope, closed = lanes_max(lanes_select(dense, lanes_set(k[DENSE]), mu), opening);
    lanes volume = slope * linear_energy((closed - left) / (1 + left));
    if (lanes_any(dense)) {
        lanes law = cubic_energy(k + K1, (mu - k[LOCK]) * (1 / (1 + k[LOCK]))) * (1 / (1 + k[LOCK])) - k[DENSE_ENERGY];
        volume += lanes_select(dense, law, lanes_set(0));
    }
    lanes gap = lanes_select(mu < opening, change + closed / (1 + closed), lanes_set(0));
    return volume + tension * gap;
}

// Strength at a pressure [Pa], Kirchhoff; the damage in it is that of the beginning.
BRUNT_INLINE softening strength(const real *k, lanes pressure, lanes J, lanes rate, lanes damage) {
    lanes P = pressure * (1 / k[FC]), zero = lanes_set(0), scale = J * k[FC] * rate;
    lanes hard = k[B] * power(P, k[N]) + lanes_min(P, zero) * (k[A] / k[TENSION_STAR]);
    softening s = {.damage = damage, .drop = scale * k[A], .upper = J * k[FC] * k[SMAX]};
    s.limit = scale * (k[A] * (1 - damage) + hard);
    s.lower = lanes_min(lanes_max(scale * hard, zero), s.upper);
    s.strain = lanes_max(k[D1] * power(P + k[TENSION_STAR], k[D2]), lanes_set(k[EFMIN]));
    return s;
}

BRUNT_INLINE brunt_update_result update_dim(int dim, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const lanes per_step = inverse_rate_step(points, k[RATE_ZERO]), zero = lanes_set(0);
    bool failed = false;
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        j2_point p = j2_trial(dim, k, points, i, &record);
        real *damage = points->state[j2_slot(dim, DAMAGE)] + i,
             *compaction = points->state[j2_slot(dim, COMPACTION)] + i;
        lanes change = p.volume_change, J = 1 + change, mu = -change / J, D = lanes_load(damage),
              h = lanes_load(compaction);
        lanes end = lanes_max(h, lanes_min(mu, lanes_set(k[DENSE]))), stiffness;
        lanes elastic = pressure_at(k, mu, end, &stiffness), pressure = lanes_max(elastic, -k[TENSION] * (1 - D));
        lanes delta = zero, q = p.q, loss = zero;
        lane_mask crushed = end > h, plastic = p.q > 0;
        if (lanes_any(crushed | plastic)) {
            softening s = strength(k, pressure, J, rate_factor(dim, points, i, k[RATE], per_step), D);
            if (lanes_any(crushed)) {
                lanes left_before, left;
                unloading(k, h, &left_before), unloading(k, end, &left);
                lanes by_volume = softening_damage(&s, lanes_max(left - left_before, zero));
                s.limit -= s.drop * (by_volume - D);
                s.damage = by_volume;
            }
            plastic &= p.q > lanes_max(softening_begin(&s), lanes_set(BRITTLE_ROUNDING * k[J2_MU]));
            if (lanes_any(plastic)) delta = softening_return(dim, k, &p, &s, plastic, &q);
            if (lanes_any(crushed | plastic)) {
                lane_mask changed = crushed | plastic;
                lanes grown = lanes_select(changed, softening_damage(&s, delta), D);
                lanes before = volume_change_before(dim, points, i, change);
                loss = stored_energy(k, change, h, D) - stored_energy(k, change, end, grown);
                loss += stored_energy(k, before, h, D) - stored_energy(k, before, end, grown);
                loss = lanes_select(changed, (real)0.5 * loss, zero);
                pressure = lanes_max(elastic, -k[TENSION] * (1 - grown));
                lanes_store(damage, grown);
                lanes_store(compaction, end);
            }
        }
        j2_store(dim, k, points, i, &p, (j2_flow){delta, q}, &record);
        add_plastic_work(dim, points, i, loss);
        note_first(&record.model, ~(stiffness > 0), i);
        store_pressure(k, points, i, &p, J * pressure, stiffness, &record);
        failed |= fail_beyond(dim, points, i, k[FAILURE_STRAIN], damage);
    }
    brunt_update_result result =
        update_end(&record, points, "compressed past where the pressure K1 m + K2 m^2 + K3 m^3 rises with density");
    result.failed = failed;
    return result;
}

MATERIAL_UPDATE

static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    brittle_energy(constants, points, COMPACTION, DAMAGE, stored_energy, energy);
}

static real wave_speed(const real *constants) { return brittle_wave_speed(constants, constants[ELASTIC]); }

#define HOLMQUIST_JOHNSON_COOK                                                                                         \
    .name = "holmquist-johnson-cook",                                                                                  \
    .doc = "concrete: strength by pressure and rate, damage, compaction of pores (Holmquist, Johnson and Cook 1993)",  \
    .plastic = true, .damage = true, .parameters = parameters, .parameter_count = BRUNT_COUNT(parameters),             \
    .state = state, .state_count = BRUNT_COUNT(state), .prepare = prepare, .flops = {598, 736}, .update = update,      \
    .energy = add_energy, .wave_speed = wave_speed,                                                                    \
    .no_potential = "'holmquist-johnson-cook' has no potential for implicit steps: its strength falls with damage"

static const brunt_model static_form = {HOLMQUIST_JOHNSON_COOK};

static const brunt_model *reduced(const double *p) { return p[5] > 0 ? NULL : &static_form; }

const brunt_model brunt_holmquist_johnson_cook = {HOLMQUIST_JOHNSON_COOK, .rate_dependent = true, .reduced = reduced};
