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

// 1 - T*^m, and its derivative with respect to T.
BRUNT_INLINE lanes softening(const real *k, lanes temperature, lanes *slope) {
    lanes zero = lanes_set(0), one = lanes_set(1);
    lanes t = lanes_min(lanes_max((temperature - k[REFERENCE]) * k[INVERSE_RANGE], zero), one);
    if (k[SOFTENING] == 1) {
        *slope = lanes_select((t > 0) & (t < 1), -k[INVERSE_RANGE] * one, zero);
        return 1 - t;
    }
    lanes tm = power(t, k[SOFTENING]);
    *slope = lanes_select((t > 0) & (t < 1), -k[SOFTENING] * k[INVERSE_RANGE] * tm / lanes_select(t > 0, t, one), zero);
    return 1 - tm;
}

// What of the law there is, as literals but for the last; softens: there is damage.
typedef struct form {
    int dim;
    bool softens, rated, heats, hardens;
} form;

// Flow stress at the end of a step with the plastic increment delta, and its slope with delta. The temperature rise is
// the step's own trapezoid of work, 1/2 delta (q_old + q), q = trial - stiffness delta.
BRUNT_INLINE lanes flow_stress(form f, const real *k, const j2_point *p, lanes start, lanes inverse_rate_step,
                               lanes delta, lanes *slope) {
    lanes one = lanes_set(1), zero = lanes_set(0), tiny = lanes_set(LANES_REAL_MIN);
    lanes hard = lanes_set(k[STATIC]), hard_slope = zero;
    if (f.hardens) {
        lanes strain = p->plastic_strain + delta, hardening = k[POWER] * power(strain, k[EXPONENT]);
        hard = k[STATIC] + hardening, hard_slope = k[EXPONENT] * hardening / lanes_max(strain, tiny);
    }
    lanes rate = one, rate_slope = zero;
    if (f.rated) {
        lanes ratio = delta * inverse_rate_step;
        lane_mask fast = ratio > 1;
        rate = 1 + k[RATE] * lanes_log(lanes_select(fast, ratio, one));
        rate_slope = lanes_select(fast, k[RATE] / lanes_max(delta, tiny), zero);
    }
    lanes soft = lanes_set(k[COLD_SOFTENING]), soft_slope = zero, heating = zero;
    if (f.heats) {
        lanes q = p->q - p->stiffness * delta;
        lanes temperature = start + (real)0.5 * k[HEATING] * delta * (p->q_old + q);
        heating = (real)0.5 * k[HEATING] * (p->q_old + q - p->stiffness * delta);
        soft = softening(k, temperature, &soft_slope);
    }
    *slope = hard_slope * rate * soft + hard * rate_slope * soft + hard * rate * soft_slope * heating;
    return hard * rate * soft;
}

// What softens the flow stress at the start of a step.
BRUNT_INLINE lanes start_softening(form f, const real *k, lanes start) {
    lanes slope;
    return f.heats ? softening(k, start, &slope) : lanes_set(k[COLD_SOFTENING]);
}

BRUNT_INLINE lanes start_strength(form f, const real *k, lanes plastic_strain) {
    return f.hardens ? k[STATIC] + k[POWER] * power(plastic_strain, k[EXPONENT]) : lanes_set(k[STATIC]);
}

BRUNT_INLINE brunt_update_result update_form(form f, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const lanes zero = lanes_set(0);
    const lanes inverse_rate_step = lanes_set(f.rated && points->dt > 0 ? 1 / (points->dt * k[RATE_ZERO]) : 0);
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        j2_point p = j2_trial(f.dim, k, points, i, &record);
        real *temperature = f.heats ? points->state[j2_slot(f.dim, TEMPERATURE)] + i : NULL;
        lanes delta = zero, q = p.q, start = f.heats ? lanes_load(temperature) : zero, slope;
        // Below the static strength without any hardening nothing flows: most vectors of most runs stop here.
        const lanes integrity = j2_integrity(f.softens, points, i);
        lanes lowest = k[STATIC] * start_softening(f, k, start);
        if (f.softens) lowest *= integrity;
        lane_mask plastic = p.q > lowest;
        if (lanes_any(plastic)) {
            lanes yield = start_strength(f, k, p.plastic_strain) * start_softening(f, k, start);
            if (f.softens) yield *= integrity;
            plastic = p.q > yield;
            if (f.softens)
                j2_set_softened_stiffness(k, points, i, &p);
            else
                j2_set_stiffness(k, &p);
            j2_root root = j2_root_begin(&p, plastic);
            lane_mask gone = {0};
            if (f.softens) gone = j2_root_collapse(&root, integrity);
            for (int step = 0; step < J2_ROOT_STEPS && lanes_any(root.active); step++) {
                q = flow_stress(f, k, &p, start, inverse_rate_step, root.delta, &slope);
                if (f.softens) q *= integrity, slope *= integrity;
                j2_root_step(&p, &root, q, slope);
            }
            note_first(&record.model, root.active, i);
            delta = lanes_select(plastic, root.delta, zero);
            q = lanes_select(plastic, q, p.q);
            if (f.softens) q = lanes_select(gone, zero, q);
            j2_return(f.dim, &p, plastic, q);
        }
        lanes work = j2_store(f.dim, k, points, i, &p, (j2_flow){delta, q}, &record);
        if (f.heats) lanes_store(temperature, start + k[HEATING] * work);
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
    lanes slope, soft = softening(constants, lanes_set((real)temperature), &slope);
    constants[COLD_SOFTENING] = lanes_max_of(soft);
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
