// Mie-Gruneisen equation of state about a linear shock Hugoniot Us = c0 + s up (for the form: Meyers, Dynamic Behavior
// of Materials (1994), chapter 5; Wilkins, Computer Simulation of Dynamic Phenomena (1999)), with rho gamma = rho0
// gamma0 in compression and gamma = gamma0 in expansion:
//   compression, eta = 1 - J:  p = p_H (1 - gamma0 eta / 2) + gamma0 e,   p_H = rho0 c0^2 eta / (1 - s eta)^2
//   expansion, mu = 1/J - 1:   p = rho0 c0^2 mu + gamma0 e / J
// with e the internal energy per reference volume. With mu, eta = mu / (1 + mu) and 1 - s eta = (1 - (s - 1) mu) / (1 +
// mu). On the Hugoniot e = p_H eta / 2, and p = p_H: the compression law holds it exactly. Both branches meet at J = 1,
// without energy with their slope too. A compression past eta = 1/s has no shock state; it is reported, never bounded.
//
// In expansion rho gamma = rho0 gamma0 would have a gas whose adiabatic energy goes as exp(-gamma0 J): debris that has
// spread thirty times and is stopped by a wall would be heated by exp(30 gamma0) (as measured: steps fell to 1e-14 s).
// With gamma constant it is a gas of exponent 1 + gamma0.
//
// e changes by -p dJ + viscous work + plastic work. p at the end of the step is linear in e, so the trapezoid
//   e1 = e0 - (p0 + p1)/2 dJ + Q,  p1 = a + g e1,  g = gamma0 / max(J, 1)   is solved in closed form.
// `compression_work` is -int p dJ alone: plastic work is counted by the strength model, viscous work by the viscosity.
//
// With `tension` p stays at -tension where the laws give less, the material then being torn (liquids: 0; p = 0 for mu <
// 0). The trapezoid is that of the pressures so bounded. Whether the end of a step is torn does not depend on the order
// of bounding and solving: both pressures lie on the same side of -tension, as 1 + g dJ/2 > 0.
// A point that has failed (integrity 0) carries none, from the step after on: the bound then differs at both ends of a
// step.
#include "materials/energy_state.h"

enum { INVERSE_DENSITY = ENERGY_CONSTANTS, SOUND_SPEED, SLOPE, GAMMA, STIFFNESS, INVERSE_STIFFNESS, TENSION };

static const brunt_parameter parameters[] = {
    {"c0", "m/s", NAN, 0, INFINITY, true, true, "bulk sound speed at rest: Us = c0 + s up"},
    {"s", "1", NAN, 0, INFINITY, false, true, "slope of shock speed over particle speed"},
    {"gamma0", "1", NAN, 0, INFINITY, false, true, "Gruneisen coefficient at reference density"},
    {"initial_energy", "J/m^3", 0, -INFINITY, INFINITY, true, true, "energy per reference volume at the start"},
    {"tension", "Pa", INFINITY, 0, INFINITY, false, false,
     "greatest tension it carries, beyond which it cavitates; 0: none at all"},
};

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    (void)with_eos;
    constants[INVERSE_DENSITY] = (real)(1 / density);
    constants[SOUND_SPEED] = (real)p[0];
    constants[SLOPE] = (real)p[1];
    constants[GAMMA] = (real)p[2];
    constants[INITIAL_ENERGY] = (real)p[3];
    constants[STIFFNESS] = (real)(density * p[0] * p[0]);
    constants[INVERSE_STIFFNESS] = (real)(1 / (density * p[0] * p[0]));
    constants[TENSION] = (real)p[4];
    return NULL;
}

// The law at J - 1 = change.
typedef struct gruneisen {
    lanes valid;   // 1 - s eta, which must be positive; in expansion J
    lanes inverse; // of that
    lanes cold;    // what of the pressure does not depend on the energy
    lanes thermal; // pressure per energy, g
} gruneisen;

BRUNT_INLINE gruneisen gruneisen_at(const real *k, lanes change) {
    const lane_mask expands = change > 0;
    const lanes eta = -change;
    gruneisen at = {.valid = lanes_select(expands, 1 + change, 1 - k[SLOPE] * eta)};
    at.inverse = 1 / at.valid;
    const lanes hugoniot = eta * at.inverse * at.inverse * (1 - (real)0.5 * k[GAMMA] * eta);
    at.cold = k[STIFFNESS] * lanes_select(expands, eta * at.inverse, hugoniot);
    at.thermal = k[GAMMA] * lanes_select(expands, at.inverse, lanes_set(1));
    return at;
}

// c^2 = J^2 / rho0 (dp/deta at constant e + g p); in expansion c0^2 + J (gamma0 p + g e) / rho0.
BRUNT_INLINE lanes speed_squared(const real *k, const gruneisen *at, lanes change, lanes e, lanes p) {
    const lanes J = 1 + change, eta = -change, inverse = at->inverse;
    const lanes r = 1 - (real)0.5 * k[GAMMA] * eta;
    const lanes squeezed = inverse * inverse * ((1 + k[SLOPE] * eta) * inverse * r - (real)0.5 * k[GAMMA] * eta);
    const lanes expanding = inverse * (inverse + at->thermal * e * k[INVERSE_STIFFNESS]);
    const lanes slope = lanes_select(change > 0, expanding, squeezed);
    return J * J * (k[STIFFNESS] * slope + at->thermal * p) * k[INVERSE_DENSITY];
}

BRUNT_INLINE brunt_update_result update_dim(int dim, bool tears, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const real half = (real)0.5;
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        const volume_step step = load_volume_step(dim, points, i, &record);
        const lanes change = step.change, J = step.J, dJ = step.dJ;
        lanes e = lanes_load(points->state[INTERNAL_ENERGY] + i);
        const gruneisen before = gruneisen_at(k, change - dJ), at = gruneisen_at(k, change);
        lanes p_old = before.cold + before.thermal * e;
        if (tears) p_old = lanes_max(p_old, tear_pressure(k[TENSION], points->integrity_before, i));
        const energy_step begin = {e, p_old, dJ, step_heat(points, i, dJ)};
        lanes e_new = (e - half * (p_old + at.cold) * dJ + begin.heat) / (1 + half * at.thermal * dJ);
        lanes p = at.cold + at.thermal * e_new;
        lane_mask torn = {0};
        if (tears) torn = tear_at(&begin, tear_pressure(k[TENSION], points->integrity, i), &e_new, &p);
        note_first(&record.model, ~(at.valid > 0), i);
        store_energy_step(points, i, e_new, -half * (p_old + p) * dJ, J * p);

        lanes speed2 = speed_squared(k, &at, change, e_new, p);
        // What is torn closes again at c0.
        if (tears) speed2 = lanes_select(torn, lanes_set(k[STIFFNESS] * k[INVERSE_DENSITY]), speed2);
        note_speed(&record, speed2);
    }
    return update_end(&record, points, "compressed beyond the Mie-Gruneisen equation of state (1 - s (1 - J) <= 0)");
}

static brunt_update_result update(const real *constants, const brunt_material_points *points) {
    if (constants[TENSION] < (real)INFINITY || points->integrity)
        return points->dim == 2 ? update_dim(2, true, constants, points) : update_dim(3, true, constants, points);
    return points->dim == 2 ? update_dim(2, false, constants, points) : update_dim(3, false, constants, points);
}

static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    (void)constants;
    energy->internal += state_total(points, COMPRESSION_WORK);
}

static real wave_speed(const real *constants) {
    double c0 = (double)constants[SOUND_SPEED], gamma = (double)constants[GAMMA];
    return (real)sqrt(c0 * c0 + gamma * gamma * (double)constants[INITIAL_ENERGY] * (double)constants[INVERSE_DENSITY]);
}

const brunt_model brunt_mie_gruneisen = {
    .name = "mie-gruneisen",
    .doc = "Mie-Gruneisen equation of state about a linear shock Hugoniot",
    ENERGY_EOS,
    .parameters = parameters,
    .parameter_count = BRUNT_COUNT(parameters),
    .prepare = prepare,
    .flops = {89, 137},
    .update = update,
    .energy = add_energy,
    .wave_speed = wave_speed,
    .no_potential = "'mie-gruneisen' has no potential for implicit steps: its pressure depends on the energy that it "
                    "has at their end",
    .differences = true,
};
