// Explosive: detonation products by the equation of Jones, Wilkins and Lee (Lee, Hornig and Kury, UCRL-50422 (1968)),
// lit by programmed burn. With V = J and e the internal energy per reference volume,
//   p_products = A (1 - w/(R1 V)) exp(-R1 V) + B (1 - w/(R2 V)) exp(-R2 V) + w e / V
//              = c(V) + w t / V,   c = A exp(-R1 V) + B exp(-R2 V),   t = e - E(V),   E = A/R1 exp(-R1 V) + B/R2
//              exp(-R2 V).
// As c = -dE/dV, along an isentrope t V^w is constant: what burnt a step ago takes
//   t1 = (t0 m + Q) m,  m = (V1/V0)^(-w/2),   the heat Q in the middle: exact without it whatever the step (see
//   ideal_gas.c).
//
// Programmed burn: a point burns from its ignition time on, when the front that runs from the detonators at the
// detonation speed D gets there (Wilkins, Calculation of Elastic-Plastic Flow, UCRL-7322 (1964); LS-DYNA
// *MAT_HIGH_EXPLOSIVE_BURN),
//   p = F p_products + (1 - F) K mu,   F = max(F1, F2) within 0 .. 1, never falling,
//   F1 = (time - ignition_time) D / (width cell),    F2 = (1 - V) / (1 - V_CJ) from one such width ahead of the front
//   on.
// A width of 1.5 is LS-DYNA's (its 2 D A_max / 3 v is D / 1.5 length of a cube). F2, its beta burn, keeps a point on
// the Rayleigh line of the front when the artificial viscosity compresses it early: it has burnt when it is as dense as
// behind the front (Chapman-Jouguet, found from the constants). With F1 alone elements pile up unburnt before the front
// and then burn too dense: 34 % too much pressure after 720 elements at cfl 0.5, at cfl 0.9 a front that runs away;
// with F2 1.7 and 0.5 %. It acts near the front only, as LS-DYNA's would light by any compression what no detonator
// reaches, of which these constants say nothing.
//
// What is not burnt is as stiff as `bulk_modulus` K in compression (LS-DYNA's K with beta 2, RADIOSS' B_unreacted),
// with mu = max(1/V - 1, 0): against these pressures cast and pressed explosives bear no tension. With K = 0 it carries
// nothing at all, which is enough when the front is all that reaches it. It changes nothing behind the front: a steady
// wave obeys p = rho0 D^2 (1 - V) and e = e0 + p (1 - V) / 2 all through whatever F, and ends where these meet
// p_products.
//
// The chemical energy is `initial_energy`, in e from the start: nothing is released, F only lets it do work. A point
// that burns takes the trapezoid of its whole pressure,
//   e1 = e0 - (p0 + p1)/2 dJ + Q,  p1 = a + b e1,   in closed form, so that the energy closes while F changes.
//
// Time step: what is not burnt has D for its wave speed, so that the front never skips a cell.
#include "materials/energy_state.h"

enum {
    DENSITY = ENERGY_CONSTANTS,
    DETONATION_SPEED,
    FACTOR_1,
    FACTOR_2,
    RATE_1,
    RATE_2,
    OMEGA,
    BULK_MODULUS,
    WIDTH,
    BETA
};
enum { IGNITION_TIME = COMPRESSION_WORK + 1, BURN_FRACTION };

static const brunt_parameter parameters[] = {
    {"detonation_speed", "m/s", NAN, 0, INFINITY, true, true, "speed of the front, from where and when it is lit"},
    {"A", "Pa", NAN, 0, INFINITY, true, true, "factor of exp(-R1 V)"},
    {"B", "Pa", NAN, 0, INFINITY, false, true, "factor of exp(-R2 V)"},
    {"R1", "1", NAN, 0, INFINITY, true, true, "rate of the first exponential"},
    {"R2", "1", NAN, 0, INFINITY, true, true, "rate of the second exponential"},
    {"omega", "1", NAN, 0, INFINITY, true, true, "Gruneisen coefficient of the products"},
    {"initial_energy", "J/m^3", NAN, 0, INFINITY, true, true, "chemical energy per reference volume"},
    {"bulk_modulus", "Pa", 0, 0, INFINITY, false, true, "of the explosive before it burns; 0: it carries no pressure"},
    {"front_width", "1", 1.5, 0, INFINITY, true, true, "cells over which the front burns; wider smooths it"},
};

// Volume and speed of the Chapman-Jouguet state: where the Rayleigh line p = rho0 D^2 (1 - V) touches the Hugoniot of
// the products, p = p_products(V, e0 + p (1 - V)/2), which is at its least D.
static double front_speed(const double *p, double density, double V) {
    double cold = p[1] * (1 - p[5] / (p[3] * V)) * exp(-p[3] * V) + p[2] * (1 - p[5] / (p[4] * V)) * exp(-p[4] * V);
    double hugoniot = (cold + p[5] * p[6] / V) / (1 - 0.5 * p[5] * (1 - V) / V);
    return sqrt(hugoniot / (density * (1 - V)));
}

static double chapman_jouguet_volume(const double *p, double density) {
    double low = 0.5, high = 0.99;
    while (high - low > 1e-9) { // a third at a time: there is one minimum
        double left = low + (high - low) / 3, right = high - (high - low) / 3;
        if (front_speed(p, density, left) < front_speed(p, density, right))
            high = right;
        else
            low = left;
    }
    return 0.5 * (low + high);
}

static real never(const real *constants, int component) {
    (void)constants, (void)component;
    return (real)INFINITY;
}

static const brunt_state_field state[] = {
    {"internal_energy", "J/m^3", 1, 1, energy_at_start},
    {"compression_work", "J/m^3", 1, 1, NULL},
    {"ignition_time", "s", 1, 1, never},
    {"burn_fraction", "1", 1, 1, NULL},
};

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    (void)with_eos;
    constants[DENSITY] = (real)density;
    constants[DETONATION_SPEED] = (real)p[0];
    constants[FACTOR_1] = (real)p[1];
    constants[FACTOR_2] = (real)p[2];
    constants[RATE_1] = (real)p[3];
    constants[RATE_2] = (real)p[4];
    constants[OMEGA] = (real)p[5];
    constants[INITIAL_ENERGY] = (real)p[6];
    constants[BULK_MODULUS] = (real)p[7];
    constants[WIDTH] = (real)p[8];
    if (!(p[7] < density * p[0] * p[0])) return "bulk_modulus makes sound in the explosive as fast as its detonation";
    // t must be positive, or the products would be colder than matter can be.
    if (!(p[6] > p[1] / p[3] * exp(-p[3]) + p[2] / p[4] * exp(-p[4])))
        return "initial_energy is less than that of the cold products";
    const double V = chapman_jouguet_volume(p, density), speed = front_speed(p, density, V);
    constants[BETA] = (real)(1 / (1 - V));
    return fabs(speed / p[0] - 1) < 0.1
               ? NULL
               : "detonation_speed is off by a tenth or more of that of its products (Chapman-Jouguet)";
}

// c(V), E(V) and -dc/dV.
typedef struct cold_products {
    lanes pressure, energy, stiffness;
} cold_products;

BRUNT_INLINE cold_products cold(const real *k, lanes V) {
    lanes first = k[FACTOR_1] * lanes_exp(-k[RATE_1] * V), second = lanes_set(0);
    if (k[FACTOR_2] > 0) second = k[FACTOR_2] * lanes_exp(-k[RATE_2] * V);
    return (cold_products){.pressure = first + second,
                           .energy = first * (1 / k[RATE_1]) + second * (1 / k[RATE_2]),
                           .stiffness = k[RATE_1] * first + k[RATE_2] * second};
}

BRUNT_INLINE brunt_update_result update_dim(int dim, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const real half = (real)0.5, w = k[OMEGA], K = k[BULK_MODULUS];
    const real rate = k[DETONATION_SPEED] / (k[WIDTH] * points->cell);
    const lanes zero = lanes_set(0), one = lanes_set(1);
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        const volume_step step = load_volume_step(dim, points, i, &record);
        const lanes change = step.change, V = step.J, dV = step.dJ, before = change - dV, V_old = 1 + before;
        real *burnt = points->state[BURN_FRACTION] + i;
        lanes F_old = lanes_load(burnt), lit = lanes_load(points->state[IGNITION_TIME] + i);
        lanes F = (points->time - lit) * rate;
        F = lanes_select(F > -1, lanes_max(F, -k[BETA] * change), F);
        F = lanes_max(lanes_min(lanes_max(F, zero), one), F_old);
        lanes_store(burnt, F);

        lanes e = lanes_load(points->state[INTERNAL_ENERGY] + i), heat = step_heat(points, i, dV);
        cold_products old = cold(k, V_old), now = cold(k, V);

        lanes m = lanes_exp(-half * w * lanes_log1p(step.growth)), t = e - old.energy;
        lanes isentrope = (m - 1) * (t * (m + 1) + heat) + (now.energy - old.energy); // e_new - e - heat

        lanes squeezed = lanes_min(change, zero), squeezed_before = lanes_min(before, zero);
        lanes p_old = F_old * (old.pressure + w * t / V_old) - (1 - F_old) * K * squeezed_before / V_old;
        lanes a = F * (now.pressure - w * now.energy / V) - (1 - F) * K * squeezed / V, b = F * w / V;
        lane_mask burning = F_old < 1;
        lanes follows = lanes_select(burning, 1 + half * b * dV, one);
        lanes trapezoid = -half * (p_old + a + b * (e + heat)) * dV / follows;

        lanes work = lanes_select(burning, trapezoid, isentrope), e_new = e + heat + work;
        note_first(&record.model, ~((follows > 0) & (e_new > 0) & (e_new <= MATERIAL_REAL_MAX)), i);
        lanes p = a + b * e_new;
        store_energy_step(points, i, e_new, work, V * p);

        // c^2 = V^2 / rho0 (-dp/dV at constant e + p dp/de).
        t = e_new - now.energy;
        lanes raw = lanes_select(change > 0, zero, lanes_set(K)); // closes again at the speed of the front
        lanes slope = F * (now.stiffness + w * (t / V - now.pressure) / V) + (1 - F) * raw / (V * V) + b * p;
        lanes speed2 = V * V * slope / k[DENSITY], front = lanes_set(k[DETONATION_SPEED] * k[DETONATION_SPEED]);
        note_speed(&record, lanes_select(F < 1, lanes_max(speed2, front), speed2));
    }
    return update_end(&record, points, "the internal energy of the explosive is not positive and finite");
}

MATERIAL_UPDATE

static real wave_speed(const real *constants) { return constants[DETONATION_SPEED]; }

const brunt_model brunt_jwl = {
    .name = "jwl",
    .doc =
        "explosive: products by Jones, Wilkins and Lee (1968), burnt by a front from the detonators (programmed burn)",
    .eos = true,
    .explosive = true,
    .parameters = parameters,
    .parameter_count = BRUNT_COUNT(parameters),
    .state = state,
    .state_count = BRUNT_COUNT(state),
    .prepare = prepare,
    .flops = {318, 366},
    .update = update,
    .energy = add_internal_energy,
    .wave_speed = wave_speed,
    .no_potential =
        "'jwl' has no potential for implicit steps: its pressure depends on the energy that it has at their end",
};
