// Johnson-Cook plasticity (Johnson and Cook, 7th International Symposium on Ballistics, 1983), finite strain (j2.h):
//   Y = (A + B eps_p^n) (1 + C ln(max(rate / rate0, 1))) (1 - T*^m),  0 <= T* <= 1,
//   T* = (T - reference) / (melt - reference).
// T* is so bounded by the model's definition: at the melting point no strength is left. Plastic work heats
// adiabatically, dT = taylor_quinney dW / (density heat_capacity).
//
// Strain, rate and temperature are all taken at the end of the step, in one equation for the plastic increment: the
// flow stress at the end is the formula's to the solver's tolerance (1e-10), whatever the step.
//
// Each of B, C and taylor_quinney may be 0, and is then not computed: no power, no logarithm, and a temperature that
// stays is one constant and no state.
//
// A step changes strain and temperature by little, and the search for the increment its rate by less and less: powers
// and the logarithm are computed from those at the start of the step, or of the search, by series, and anew only where
// a point is far from them, and from there on. Which way is taken is each point's own affair, so that its bits are.
//
// The search begins from steady flow. Where a point did not flow before, or flows slower than it did, it begins from
// what its rate lets flow. It ends where the next step of Newton's method would change the increment by a share whose
// square is below the tolerance: that step is taken, and the flow stress goes with its slope.
#include "materials/return_mapping.h"

enum {
    STATIC = J2_CONSTANTS,
    POWER,
    EXPONENT,
    RATE,
    RATE_ZERO,
    SOFTENING,
    REFERENCE,
    MELT,
    INVERSE_RANGE,
    HEATING,
    HEAT_SHARE,
    COLD_SOFTENING
};
enum { TEMPERATURE = J2_MODEL_STATE };
enum { P_A = 2, P_B, P_N, P_C, P_M, P_RATE_ZERO, P_MELT, P_REFERENCE, P_HEAT_CAPACITY, P_TAYLOR_QUINNEY };

static const brunt_parameter parameters[] = {
    PARAMETER_E,
    PARAMETER_NU,
    {"A", "Pa", NAN, 0, INFINITY, true, true, "yield stress at the reference temperature and rate"},
    {"B", "Pa", 0, 0, INFINITY, false, true, "hardening factor"},
    {"n", "1", 1, 0, INFINITY, true, true, "hardening exponent"},
    {"C", "1", 0, 0, INFINITY, false, true, "rate sensitivity"},
    {"m", "1", 1, 0, INFINITY, true, true, "softening exponent"},
    {"rate0", "1/s", 1, 0, INFINITY, true, true, "plastic strain rate below which rate has no effect"},
    {"melt", "K", NAN, 0, INFINITY, true, true, "melting temperature"},
    {"reference_temperature", "K", 293.15, 0, INFINITY, false, true, "temperature below which heat has no effect"},
    {"heat_capacity", "J/kg/K", NAN, 0, INFINITY, true, true, "specific heat capacity"},
    {"taylor_quinney", "1", 0.9, 0, 1, false, false, "share of the plastic work that becomes heat"},
};

static real initial_temperature(const real *constants, int component) {
    (void)component;
    return constants[REFERENCE];
}

static const brunt_state_field state[] = {J2_STATE, {"temperature", "K", 1, 1, initial_temperature}};

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    if (!(p[P_MELT] > p[P_REFERENCE])) return "melt is not above reference_temperature";
    j2_prepare(p[0], p[1], density, with_eos, constants);
    constants[STATIC] = (real)p[P_A];
    constants[POWER] = (real)p[P_B];
    constants[EXPONENT] = (real)p[P_N];
    constants[RATE] = (real)p[P_C];
    constants[SOFTENING] = (real)p[P_M];
    constants[RATE_ZERO] = (real)p[P_RATE_ZERO];
    constants[MELT] = (real)p[P_MELT];
    constants[REFERENCE] = (real)p[P_REFERENCE];
    constants[INVERSE_RANGE] = (real)(1 / (p[P_MELT] - p[P_REFERENCE]));
    constants[HEATING] = (real)(p[P_TAYLOR_QUINNEY] / (density * p[P_HEAT_CAPACITY]));
    constants[HEAT_SHARE] = (real)p[P_TAYLOR_QUINNEY];
    constants[COLD_SOFTENING] = 1; // T* = 0 until a body says otherwise
    return NULL;
}

// ------------------------------------------------------------------------- powers and logarithms beside known ones

#ifdef BRUNT_FLOAT
enum { BINOMIAL_TERMS = 4, LOGARITHM_TERMS = 3 };
#else
enum { BINOMIAL_TERMS = 8, LOGARITHM_TERMS = 7 };
#endif

// (1 + r)^y = 1 + c1 r (1 + c2 r (1 + ...)), c_k = (y - k + 1) / k; to rounding for |r| <= radius.
typedef struct binomial {
    real exponent, radius, c[BINOMIAL_TERMS];
} binomial;

static binomial binomial_of(real exponent) {
    binomial b = {.exponent = exponent, .radius = (real)(1.0 / 64) / (exponent > 1 ? exponent : 1)};
    for (int k = 0; k < BINOMIAL_TERMS; k++) b.c[k] = (exponent - (real)k) / (real)(k + 1);
    return b;
}

// What is known: of x its power, or its logarithm.
typedef struct known {
    lanes x, inverse, value; // inverse: 1 / x
    lanes at;                // what x has changed by since the start of the step
} known;

// A function and its derivative; that, for a search, to some millionths.
typedef struct slope_value {
    lanes value, slope;
} slope_value;

// x^y for x >= 0, which has changed by `change` since the start of the step; where it is computed anew it is what is
// known from then on. Right where `wanted`.
BRUNT_INLINE slope_value power_beside(const binomial *b, known *at, lanes x, lanes change, lane_mask wanted) {
    const lanes r = (change - at->at) * at->inverse;
    const lane_mask beside = lanes_abs(r) <= b->radius;
    lanes series = lanes_set(1);
    for (int k = BINOMIAL_TERMS - 1; k >= 0; k--) series = 1 + b->c[k] * r * series;
    lanes value = at->value * series, inverse = at->inverse * (1 - r * (1 - r));
    if (lanes_any(wanted & ~beside)) {
        at->at = lanes_select(beside, at->at, change);
        at->value = lanes_select(beside, at->value, power(x, b->exponent));
        at->inverse = lanes_select(beside, at->inverse, 1 / lanes_max(x, lanes_set(LANES_REAL_MIN)));
        value = lanes_select(beside, value, at->value);
        inverse = lanes_select(beside, inverse, at->inverse);
    }
    return (slope_value){value, b->exponent * value * inverse};
}

BRUNT_INLINE known power_known(const binomial *b, lanes x) {
    return (known){x, 1 / lanes_max(x, lanes_set(LANES_REAL_MIN)), power(x, b->exponent), lanes_set(0)};
}

// ln x for x > 0, by that of a ratio within 1/8 of 1, ln((1 + z) / (1 - z)) = 2 (z + z^3/3 + ...); where it is
// computed anew it is what is known from then on.
BRUNT_INLINE slope_value log_beside(known *at, lanes x, lane_mask wanted) {
    const lane_mask beside = lanes_abs(x - at->x) <= (real)0.125 * at->x;
    const lanes half = 1 / (x + at->x), z = (x - at->x) * half, zz = z * z;
    lanes series = lanes_set((real)(2.0 / (2 * LOGARITHM_TERMS + 1)));
    for (int k = LOGARITHM_TERMS - 1; k >= 0; k--) series = series * zz + (real)(2.0 / (2 * k + 1));
    slope_value ln = {at->value + z * series, 2 * half * (1 - z * (1 - z * (1 - z)))};
    if (!lanes_any(wanted & ~beside)) return ln;
    at->x = lanes_select(beside, at->x, x);
    at->value = lanes_select(beside, at->value, lanes_log(x));
    ln.value = lanes_select(beside, ln.value, at->value);
    ln.slope = lanes_select(beside, ln.slope, 1 / x);
    return ln;
}

// ------------------------------------------------------------------------------------------------- the flow stress

// What of the law there is, as literals but for the last; softens: there is damage.
typedef struct form {
    int dim;
    bool softens, rated, heats, hardens;
} form;

typedef struct law_step {
    const real *k;
    real inverse_rate_step; // 1 / (dt rate0)
    binomial strain, heat;  // of the exponents
} law_step;

// A vector of points at the start of its step: temperature; the powers of strain and of T*, and the logarithm of the
// rate as the search goes on.
typedef struct flow_start {
    lanes temperature;
    known strain, heat, rate;
} flow_start;

BRUNT_INLINE lanes homologous(const real *k, lanes temperature) {
    return lanes_min(lanes_max((temperature - k[REFERENCE]) * k[INVERSE_RANGE], lanes_set(0)), lanes_set(1));
}

// 1 - T*^m at the end of a step, and its derivative with respect to T.
BRUNT_INLINE slope_value softening(const law_step *law, known *start, lanes temperature, lane_mask wanted) {
    const real *k = law->k;
    const lanes zero = lanes_set(0), t = homologous(k, temperature);
    const lane_mask within = (t > 0) & (t < 1);
    if (k[SOFTENING] == 1) return (slope_value){1 - t, lanes_select(within, -k[INVERSE_RANGE] + zero, zero)};
    const slope_value tm = power_beside(&law->heat, start, t, t - start->x, wanted);
    return (slope_value){1 - tm.value, lanes_select(within, -k[INVERSE_RANGE] * tm.slope, zero)};
}

// Flow stress at the end of a step with the plastic increment delta, and its slope with delta, where `wanted`. The
// temperature rise is the step's own trapezoid of work, 1/2 delta (q_old + q), q = trial - stiffness delta.
BRUNT_INLINE slope_value flow_stress(form f, const law_step *law, const j2_point *p, flow_start *start, lanes delta,
                                     lane_mask wanted) {
    const real *k = law->k;
    const lanes one = lanes_set(1), zero = lanes_set(0);
    slope_value hard = {lanes_set(k[STATIC]), zero}, rate = {one, zero}, soft = {lanes_set(k[COLD_SOFTENING]), zero};
    lanes heating = zero;
    if (f.hardens) {
        const slope_value h = power_beside(&law->strain, &start->strain, p->plastic_strain + delta, delta, wanted);
        hard.value += k[POWER] * h.value, hard.slope = k[POWER] * h.slope;
    }
    if (f.rated) {
        const lanes ratio = delta * law->inverse_rate_step;
        const lane_mask fast = ratio > 1;
        const slope_value ln = log_beside(&start->rate, lanes_select(fast, ratio, one), wanted);
        rate.value = 1 + k[RATE] * ln.value;
        rate.slope = lanes_select(fast, k[RATE] * law->inverse_rate_step * ln.slope, zero);
    }
    if (f.heats) {
        const lanes q = p->q - p->stiffness * delta;
        const lanes temperature = start->temperature + (real)0.5 * k[HEATING] * delta * (p->q_old + q);
        heating = (real)0.5 * k[HEATING] * (p->q_old + q - p->stiffness * delta);
        soft = softening(law, &start->heat, temperature, wanted);
    }
    return (slope_value){hard.value * rate.value * soft.value,
                         (hard.slope * rate.value + hard.value * rate.slope) * soft.value +
                             hard.value * rate.value * soft.slope * heating};
}

// Begins the search of lanes `late` with what the rate alone, and what the stiffness alone, would let flow, in series.
// `yield`: at the start of the step, at the law's own rate.
BRUNT_INLINE void start_by_rate(form f, const law_step *law, const j2_point *p, lanes yield, lane_mask late,
                                j2_root *root) {
    if (!lanes_any(late)) return;
    const lanes over = p->q - yield;
    lanes inverse = p->stiffness / over;
    if (f.rated) inverse += law->inverse_rate_step * lanes_exp(-over / (law->k[RATE] * yield));
    root->delta = lanes_select(late, 1 / inverse, root->delta);
}

// Share of the increment. What is left of the equation after such a change is at most an eighth of its square (a power
// law at its first flow; a logarithm with factor C: C / 2 of it) of the stress, and what slopes are short of, of it.
#ifdef BRUNT_FLOAT
#define SETTLED 2e-3f
#else
#define SETTLED 2e-5
#endif

// The increment of lanes that flow, and the stress they flow at; `yield` as above. What did not come to an end is left
// active.
BRUNT_INLINE j2_flow search(form f, const law_step *law, const j2_point *p, flow_start *start, lanes yield,
                            lanes integrity, j2_root *root) {
    const lane_mask plastic = root->active;
    lanes q = p->q;
    start_by_rate(f, law, p, yield, plastic & ~((p->q > p->q_old) & (p->q_old > yield)), root);
    for (int step = 0; step < J2_ROOT_STEPS && lanes_any(root->active); step++) {
        slope_value flow = flow_stress(f, law, p, start, root->delta, plastic);
        if (f.softens) flow.value *= integrity, flow.slope *= integrity;
        const lane_mask active = root->active;
        const lanes from = root->delta;
        j2_root_step(p, root, flow.value, flow.slope);
        const lanes change = root->delta - from;
        q = lanes_select(active, lanes_select(root->active, flow.value + flow.slope * change, flow.value), q);
        if (step == 0) start_by_rate(f, law, p, yield, root->active & (root->delta < (real)0.5 * from), root);
        root->active &= ~(lanes_abs(change) <= (real)SETTLED * lanes_min(from, root->delta));
    }
    if (lanes_any(root->active)) j2_root_closed(p, root, &q);
    return (j2_flow){lanes_select(plastic, root->delta, lanes_set(0)), q};
}

BRUNT_INLINE brunt_update_result update_form(form f, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const lanes zero = lanes_set(0);
    const law_step law = {.k = k,
                          .inverse_rate_step = f.rated && points->dt > 0 ? 1 / (points->dt * k[RATE_ZERO]) : 0,
                          .strain = binomial_of(k[EXPONENT]),
                          .heat = binomial_of(k[SOFTENING])};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        j2_point p = j2_trial(f.dim, k, points, i, &record);
        real *temperature = f.heats ? points->state[j2_slot(f.dim, TEMPERATURE)] + i : NULL;
        lanes delta = zero, q = p.q, cold = lanes_set(k[COLD_SOFTENING]);
        flow_start start = {.temperature = zero, .rate = {zero, zero, zero, zero}};
        if (f.heats) {
            start.temperature = lanes_load(temperature);
            start.heat = power_known(&law.heat, homologous(k, start.temperature));
            cold = 1 - start.heat.value;
        }
        // Below the static strength without any hardening nothing flows: most vectors of most runs stop here.
        const lanes integrity = j2_integrity(f.softens, points, i);
        if (f.softens) cold *= integrity;
        lane_mask plastic = p.q > k[STATIC] * cold;
        if (lanes_any(plastic)) {
            lanes yield = lanes_set(k[STATIC]);
            if (f.hardens) {
                start.strain = power_known(&law.strain, p.plastic_strain);
                yield += k[POWER] * start.strain.value;
            }
            plastic = p.q > yield * cold;
            if (f.softens)
                j2_set_softened_stiffness(k, points, i, &p);
            else
                j2_set_stiffness(k, &p);
            j2_root root = j2_root_begin(&p, plastic);
            lane_mask gone = {0};
            if (f.softens) gone = j2_root_collapse(&root, integrity);
            const j2_flow flow = search(f, &law, &p, &start, yield * cold, integrity, &root);
            note_first(&record.model, root.active, i);
            delta = lanes_select(gone, root.delta, flow.delta), q = flow.q;
            if (f.softens) q = lanes_select(gone, zero, q);
            j2_return(f.dim, &p, plastic, q);
        }
        lanes work = j2_store(f.dim, k, points, i, &p, (j2_flow){delta, q}, &record);
        if (f.heats) lanes_store(temperature, start.temperature + k[HEATING] * work);
    }
    return update_end(&record, points, "the plastic increment of the Johnson-Cook law was not found");
}

BRUNT_INLINE brunt_update_result update_of(bool rated, bool heats, const real *k, const brunt_material_points *points) {
    const bool hardens = k[POWER] > 0;
    if (points->integrity)
        return points->dim == 2 ? update_form((form){2, true, rated, heats, hardens}, k, points)
                                : update_form((form){3, true, rated, heats, hardens}, k, points);
    return points->dim == 2 ? update_form((form){2, false, rated, heats, hardens}, k, points)
                            : update_form((form){3, false, rated, heats, hardens}, k, points);
}

static brunt_update_result update(const real *constants, const brunt_material_points *points) {
    return update_of(true, true, constants, points);
}

static brunt_update_result update_static(const real *constants, const brunt_material_points *points) {
    return update_of(false, true, constants, points);
}

static brunt_update_result update_cold(const real *constants, const brunt_material_points *points) {
    return update_of(true, false, constants, points);
}

static brunt_update_result update_plain(const real *constants, const brunt_material_points *points) {
    return update_of(false, false, constants, points);
}

// A temperature that stays: one vector as the heated form has it, for the same bits.
static void set_temperature(real *constants, double temperature) {
    const binomial heat = binomial_of(constants[SOFTENING]);
    const lanes t = homologous(constants, lanes_set((real)temperature));
    constants[COLD_SOFTENING] = lanes_max_of(1 - power_known(&heat, t).value);
}

static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    brunt_point_energy own = {0};
    j2_energy(constants, points, &own);
    energy->internal += own.internal;
    energy->plastic += own.plastic;
    energy->heat += (double)constants[HEAT_SHARE] * own.plastic;
}

#define JOHNSON_COOK                                                                                                   \
    .name = "johnson-cook",                                                                                            \
    .doc = "J2 plasticity with strain, rate and temperature dependence (Johnson and Cook 1983)", .plastic = true,      \
    .accepts_eos = true, .parameters = parameters, .parameter_count = BRUNT_COUNT(parameters), .state = state,         \
    .prepare = prepare, .flops = {231, 334}, .wave_speed = j2_wave_speed,                                              \
    .no_potential =                                                                                                    \
        "'johnson-cook' has no potential for implicit steps: its flow stress depends on rate and temperature",         \
    .differences = true
#define HOT .thermal = true, .state_count = BRUNT_COUNT(state), .energy = add_energy
#define COLD .state_count = BRUNT_COUNT(state) - 1, .energy = j2_energy, .set_temperature = set_temperature

static const brunt_model static_form = {JOHNSON_COOK, HOT, .update = update_static};
static const brunt_model cold_form = {JOHNSON_COOK, COLD, .rate_dependent = true, .update = update_cold};
static const brunt_model plain_form = {JOHNSON_COOK, COLD, .update = update_plain};

static const brunt_model *reduced(const double *p) {
    if (p[P_TAYLOR_QUINNEY] > 0) return p[P_C] > 0 ? NULL : &static_form;
    return p[P_C] > 0 ? &cold_form : &plain_form;
}

const brunt_model brunt_johnson_cook = {
    JOHNSON_COOK, HOT, .rate_dependent = true, .update = update, .reduced = reduced,
};
