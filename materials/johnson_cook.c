// Johnson-Cook plasticity (Johnson and Cook, 7th International Symposium on Ballistics, 1983), finite strain (j2.h):
//   Y = (A + B eps_p^n) (1 + C ln(max(rate / rate0, 1))) (1 - T*^m),  0 <= T* <= 1,
//   T* = (T - reference) / (melt - reference).
// T* is so bounded by the model's definition: at the melting point no strength is left. Plastic work heats
// adiabatically, dT = taylor_quinney dW / (density heat_capacity).
//
// Strain, rate and temperature are all taken at the end of the step, in one equation for the plastic increment: the
// flow stress at the end is the formula's to the solver's tolerance (1e-10), whatever the step.
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
    HEAT_SHARE
};
enum { TEMPERATURE = J2_MODEL_STATE };

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
    if (!(p[8] > p[9])) return "melt is not above reference_temperature";
    j2_prepare(p[0], p[1], density, with_eos, constants);
    constants[STATIC] = (real)p[2];
    constants[POWER] = (real)p[3];
    constants[EXPONENT] = (real)p[4];
    constants[RATE] = (real)p[5];
    constants[SOFTENING] = (real)p[6];
    constants[RATE_ZERO] = (real)p[7];
    constants[MELT] = (real)p[8];
    constants[REFERENCE] = (real)p[9];
    constants[INVERSE_RANGE] = (real)(1 / (p[8] - p[9]));
    constants[HEATING] = (real)(p[11] / (density * p[10]));
    constants[HEAT_SHARE] = (real)p[11];
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

// Flow stress at the end of a step with the plastic increment delta, and its slope with delta. The temperature rise is
// the step's own trapezoid of work, 1/2 delta (q_old + q), q = trial - stiffness delta.
BRUNT_INLINE lanes flow_stress(const real *k, const j2_point *p, lanes start, lanes inverse_rate_step, lanes delta,
                               lanes *slope) {
    lanes one = lanes_set(1), zero = lanes_set(0), tiny = lanes_set(LANES_REAL_MIN);
    lanes strain = p->plastic_strain + delta;
    lanes hardening = k[POWER] * power(strain, k[EXPONENT]);
    lanes hard = k[STATIC] + hardening, hard_slope = k[EXPONENT] * hardening / lanes_max(strain, tiny);
    lanes rate = one, rate_slope = zero;
    if (k[RATE] > 0) {
        lanes ratio = delta * inverse_rate_step;
        lane_mask fast = ratio > 1;
        rate = 1 + k[RATE] * lanes_log(lanes_select(fast, ratio, one));
        rate_slope = lanes_select(fast, k[RATE] / lanes_max(delta, tiny), zero);
    }
    lanes q = p->q - p->stiffness * delta, soft_slope;
    lanes temperature = start + (real)0.5 * k[HEATING] * delta * (p->q_old + q);
    lanes heating = (real)0.5 * k[HEATING] * (p->q_old + q - p->stiffness * delta);
    lanes soft = softening(k, temperature, &soft_slope);
    *slope = hard_slope * rate * soft + hard * rate_slope * soft + hard * rate * soft_slope * heating;
    return hard * rate * soft;
}

BRUNT_INLINE brunt_update_result update_dim(int dim, bool softens, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const lanes inverse_rate_step = lanes_set(points->dt > 0 ? 1 / (points->dt * k[RATE_ZERO]) : 0);
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        j2_point p = j2_trial(dim, k, points, i, &record);
        real *temperature = points->state[j2_slot(dim, TEMPERATURE)] + i;
        lanes zero = lanes_set(0), delta = zero, q = p.q, start = lanes_load(temperature), slope;
        // Below the static strength without any hardening nothing flows: most vectors of most runs stop here.
        const lanes integrity = j2_integrity(softens, points, i);
        lanes lowest = k[STATIC] * softening(k, start, &slope);
        if (softens) lowest *= integrity;
        lane_mask plastic = p.q > lowest;
        if (lanes_any(plastic)) {
            lanes yield = (k[STATIC] + k[POWER] * power(p.plastic_strain, k[EXPONENT])) * softening(k, start, &slope);
            if (softens) yield *= integrity;
            plastic = p.q > yield;
            if (softens)
                j2_set_softened_stiffness(k, points, i, &p);
            else
                j2_set_stiffness(k, &p);
            j2_root root = j2_root_begin(&p, plastic);
            lane_mask gone = {0};
            if (softens) gone = j2_root_collapse(&root, integrity);
            for (int step = 0; step < J2_ROOT_STEPS && lanes_any(root.active); step++) {
                q = flow_stress(k, &p, start, inverse_rate_step, root.delta, &slope);
                if (softens) q *= integrity, slope *= integrity;
                j2_root_step(&p, &root, q, slope);
            }
            note_first(&record.model, root.active, i);
            delta = lanes_select(plastic, root.delta, zero);
            q = lanes_select(plastic, q, p.q);
            if (softens) q = lanes_select(gone, zero, q);
            j2_return(dim, &p, plastic, q);
        }
        lanes work = j2_store(dim, k, points, i, &p, delta, q, &record);
        lanes_store(temperature, start + k[HEATING] * work);
    }
    return update_end(&record, points, "the plastic increment of the Johnson-Cook law was not found");
}

static brunt_update_result update(const real *constants, const brunt_material_points *points) {
    if (points->integrity)
        return points->dim == 2 ? update_dim(2, true, constants, points) : update_dim(3, true, constants, points);
    return points->dim == 2 ? update_dim(2, false, constants, points) : update_dim(3, false, constants, points);
}

static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    brunt_point_energy own = {0};
    j2_energy(constants, points, &own);
    energy->internal += own.internal;
    energy->plastic += own.plastic;
    energy->heat += (double)constants[HEAT_SHARE] * own.plastic;
}

const brunt_model brunt_johnson_cook = {
    .name = "johnson-cook",
    .doc = "J2 plasticity with strain, rate and temperature dependence (Johnson and Cook 1983)",
    .plastic = true,
    .thermal = true,
    .accepts_eos = true,
    .parameters = parameters,
    .parameter_count = COUNT_OF(parameters),
    .state = state,
    .state_count = COUNT_OF(state),
    .prepare = prepare,
    .flops = {231, 334},
    .update = update,
    .energy = add_energy,
    .wave_speed = j2_wave_speed,
};
