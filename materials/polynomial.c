// Linear polynomial equation of state (Hallquist, LS-DYNA theory manual, equation of state form 1;
// *EOS_LINEAR_POLYNOMIAL):
//   p = C0 + C1 mu + C2 mu^2 + C3 mu^3 + (C4 + C5 mu + C6 mu^2) e,   mu = 1/J - 1,
// e the internal energy per reference volume. In expansion, mu < 0, C2 and C6 do not act, as there: squares, they would
// turn the pressure up again the more it expands. Value and slope of the pressure have no jump at mu = 0 by that.
// C4 = C5 = gamma - 1 with the others 0 is the ideal gas.
//
// The energy is that of mie_gruneisen.c: p = a + b e is linear in e, so the trapezoid
//   e1 = e0 - (p0 + p1)/2 dJ + Q,  p1 = a + b e1   is solved in closed form, p bounded below by -tension, and by 0
//   where
// the point has failed (integrity 0).
// It follows the energy while b dJ > -2 at the end of a step; and the energy of what has some at rest, a gas, stays
// positive while b dJ < 2 at its start (gamma = 1.4: a sixth of the volume, or six times it, in one step). Else it is
// reported.
//
// c^2 = (a' + b' e + b p J^2) / rho0, slopes with mu. Where a set of coefficients has no real speed of sound (in
// expansion past its use) it limits no step.
#include "materials/energy_state.h"
#include "materials/exponential.h"
#include "materials/trial.h"

enum { DENSITY = ENERGY_CONSTANTS, C0, C1, C2, C3, C4, C5, C6, TENSION, TEAR };

static const brunt_parameter parameters[] = {
    {"C0", "Pa", 0, -INFINITY, INFINITY, true, true, "pressure at the reference volume without energy"},
    {"C1", "Pa", 0, 0, INFINITY, false, true, "bulk modulus at rest"},
    {"C2", "Pa", 0, -INFINITY, INFINITY, true, true, "factor of mu^2, in compression"},
    {"C3", "Pa", 0, -INFINITY, INFINITY, true, true, "factor of mu^3"},
    {"C4", "1", 0, 0, INFINITY, false, true, "pressure per energy at the reference volume"},
    {"C5", "1", 0, -INFINITY, INFINITY, true, true, "pressure per energy, factor of mu"},
    {"C6", "1", 0, -INFINITY, INFINITY, true, true, "pressure per energy, factor of mu^2, in compression"},
    {"initial_energy", "J/m^3", 0, -INFINITY, INFINITY, true, true, "energy per reference volume at the start"},
    {"tension", "Pa", INFINITY, 0, INFINITY, false, false,
     "greatest tension it carries, beyond which it cavitates; 0: none at all"},
};

static double speed_squared_at_start(const double *p, double density) {
    double pressure = p[0] + p[4] * p[7];
    return (p[1] + p[5] * p[7] + p[4] * fmax(pressure, -p[8])) / density;
}

// ln J at which it tears without energy, where p = C0 + C1 mu + C3 mu^3 falls to -tension, in expansion; infinite where
// it does not come to that. Pressures that fall all the way have one such place (potential_refuses).
static double tear(const double *p) {
    double low = -1, high = 0; // of mu
    if (!(p[0] - p[1] - p[3] < -p[8])) return INFINITY;
    for (int k = 0; k < 200 && high - low > 0; k++) {
        const double middle = 0.5 * (low + high);
        if (middle == low || middle == high) break;
        if (p[0] + middle * (p[1] + p[3] * middle * middle) < -p[8])
            low = middle;
        else
            high = middle;
    }
    return -log1p(high);
}

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    (void)with_eos;
    constants[DENSITY] = (real)density;
    for (int k = 0; k < 7; k++) constants[C0 + k] = (real)p[k];
    constants[INITIAL_ENERGY] = (real)p[7];
    constants[TENSION] = (real)p[8];
    constants[TEAR] = (real)tear(p);
    return speed_squared_at_start(p, density) > 0
               ? NULL
               : "the polynomial has no speed of sound at rest: C1 + C5 e + C4 p is not positive";
}

// Pressure as a + b e, and its slopes with mu.
typedef struct line {
    lanes a, b, a_slope, b_slope;
} line;

BRUNT_INLINE line pressure_line(const real *k, lanes mu) {
    lanes squeezed = lanes_max(mu, lanes_set(0)); // the squares act in compression alone
    return (line){
        .a = k[C0] + mu * (k[C1] + k[C3] * mu * mu) + k[C2] * squeezed * squeezed,
        .b = k[C4] + k[C5] * mu + k[C6] * squeezed * squeezed,
        .a_slope = k[C1] + 3 * k[C3] * mu * mu + 2 * k[C2] * squeezed,
        .b_slope = k[C5] + 2 * k[C6] * squeezed,
    };
}

BRUNT_INLINE brunt_update_result update_dim(int dim, bool tears, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const real half = (real)0.5;
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        const volume_step step = load_volume_step(dim, points, i, &record);
        const lanes change = step.change, J = step.J, dJ = step.dJ, mu = -change / J, before = change - dJ;
        line old = pressure_line(k, -before / (1 + before)), now = pressure_line(k, mu);
        lanes e = lanes_load(points->state[INTERNAL_ENERGY] + i), p_old = old.a + old.b * e;
        if (tears) p_old = lanes_max(p_old, tear_pressure(k[TENSION], points->integrity_before, i));
        const energy_step begin = {e, p_old, dJ, step_heat(points, i, dJ)};
        lanes follows = 1 + half * now.b * dJ;
        lanes e_new = (e - half * (p_old + now.a) * dJ + begin.heat) / follows, p = now.a + now.b * e_new;
        lane_mask torn = {0};
        if (tears) torn = tear_at(&begin, tear_pressure(k[TENSION], points->integrity, i), &e_new, &p);
        lane_mask good = follows > 0;
        if (k[INITIAL_ENERGY] > 0) good &= e_new > 0;
        note_first(&record.model, ~good, i);
        store_energy_step(points, i, e_new, -half * (p_old + p) * dJ, J * p);

        lanes speed2 = (now.a_slope + now.b_slope * e_new + now.b * p * J * J) / k[DENSITY];
        // What is torn closes again at the speed of the reference volume.
        if (tears) speed2 = lanes_select(torn, lanes_set(k[C1] / k[DENSITY]), speed2);
        note_speed(&record, speed2);
    }
    return update_end(&record, points,
                      "the volume changes by more in a step than the energy of the polynomial can follow");
}

static brunt_update_result update(const real *constants, const brunt_material_points *points) {
    if (constants[TENSION] < (real)INFINITY || points->integrity)
        return points->dim == 2 ? update_dim(2, true, constants, points) : update_dim(3, true, constants, points);
    return points->dim == 2 ? update_dim(2, false, constants, points) : update_dim(3, false, constants, points);
}

static real wave_speed(const real *k) {
    double p[9], density = (double)k[DENSITY];
    for (int c = 0; c < 7; c++) p[c] = (double)k[C0 + c];
    p[7] = (double)k[INITIAL_ENERGY], p[8] = (double)k[TENSION];
    return (real)sqrt(speed_squared_at_start(p, density));
}

// --------------------------------------------------------------------------------- implicit steps

static const char *potential_refuses(const real *k) {
    if (k[C4] != 0 || k[C5] != 0 || k[C6] != 0)
        return "'polynomial' with C4, C5 or C6 has no potential for implicit steps: its pressure depends on the energy "
               "that it has at their end";
    if (k[TENSION] < (real)INFINITY && !(k[C0] > -k[TENSION] && k[C1] + 3 * (k[C3] < 0 ? k[C3] : 0) > 0))
        return "'polynomial' has no potential for implicit steps where its pressure does not fall in expansion from "
               "above -tension";
    return NULL;
}

// U = -int p dJ from J = 1 on. With L = ln J and phi(z) = e^z - 1 - z the integrals of 1, mu, mu^2, mu^3 over J are
//   phi(L) + L,  -phi(L),  phi(L) - phi(-L),  3 phi(-L) - phi(-2 L) / 2 - phi(L).
BRUNT_INLINE lanes stored_density(const real *k, lanes log_J) {
    const lanes L = lanes_min(log_J, lanes_set(k[TEAR]));
    lanes up = exponential_excess(L), down = exponential_excess(-L), twice = exponential_excess(-2 * L);
    lanes squares = lanes_select(L < 0, up - down, lanes_set(0));
    lanes density = k[C1] * up - k[C0] * (up + L) - k[C2] * squares - k[C3] * (3 * down - (real)0.5 * twice - up);
    if (k[TEAR] < (real)INFINITY) density += k[TENSION] * (lanes_exp(log_J) - lanes_exp(L));
    return density;
}

// J^2 U'' = dp/dmu, 0 where it is torn.
BRUNT_INLINE volume_response response_at(const real *k, lanes change, lanes log_J) {
    const lanes J = 1 + change;
    const line now = pressure_line(k, -change / J);
    const lane_mask torn = log_J > k[TEAR];
    const lanes p = lanes_select(torn, lanes_set(-k[TENSION]), now.a);
    return (volume_response){stored_density(k, log_J), -J * p, lanes_select(torn, lanes_set(0), now.a_slope)};
}

BRUNT_INLINE void respond_dim(int dim, const real *k, const brunt_trial_points *trial) {
    volume_respond(dim, response_at, k, trial);
}

TRIAL_RESPOND

BRUNT_INLINE brunt_update_result commit_dim(int dim, const real *k, const brunt_trial_points *trial,
                                            const brunt_material_points *points) {
    update_record record = update_begin();
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_trial_gradient(dim, trial->F, i, H);
        const lanes change = volume_change(dim, H), log_J = lanes_log1p(change);
        const volume_response r = response_at(k, change, log_J);
        note_deformation(&record, 1 + change, i);
        for (int c = 0; c < 3; c++) lanes_store(points->stress[c] + i, lanes_load(points->stress[c] + i) + r.first);
        note_speed(&record, lanes_select(log_J > k[TEAR], lanes_set(k[C1]), r.second) / k[DENSITY]);
        real *work = points->state[COMPRESSION_WORK] + i, *energy = points->state[INTERNAL_ENERGY] + i;
        lanes e = lanes_load(energy) + (r.density - lanes_load(work));
        if (points->plastic_increment) e += lanes_load(points->plastic_increment + i);
        lanes_store(energy, e);
        lanes_store(work, r.density);
    }
    return update_end(&record, points, NULL);
}

TRIAL_COMMIT

static const brunt_model_potential potential = {.refuses = potential_refuses, .respond = respond, .commit = commit};

const brunt_model brunt_polynomial = {
    .name = "polynomial",
    .doc =
        "equation of state, polynomial in mu = rho/rho0 - 1 and linear in the energy (LS-DYNA *EOS_LINEAR_POLYNOMIAL)",
    ENERGY_EOS,
    .parameters = parameters,
    .parameter_count = BRUNT_COUNT(parameters),
    .prepare = prepare,
    .potential = &potential,
    .differences = true,
    .flops = {91, 139},
    .update = update,
    .energy = add_internal_energy,
    .wave_speed = wave_speed,
};
