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

enum { DENSITY = ENERGY_CONSTANTS, C0, C1, C2, C3, C4, C5, C6, TENSION };

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
     "greatest tension it bears, beyond which it cavitates; 0: none at all"},
};

static double speed_squared_at_start(const double *p, double density) {
    double pressure = p[0] + p[4] * p[7];
    return (p[1] + p[5] * p[7] + p[4] * fmax(pressure, -p[8])) / density;
}

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    (void)with_eos;
    constants[DENSITY] = (real)density;
    for (int k = 0; k < 7; k++) constants[C0 + k] = (real)p[k];
    constants[INITIAL_ENERGY] = (real)p[7];
    constants[TENSION] = (real)p[8];
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

// Pressure at which a point tears.
BRUNT_INLINE lanes tear_pressure(const real *k, const real *integrity, int32_t i) {
    lanes sound = lanes_set(-k[TENSION]);
    return integrity ? lanes_select(lanes_load(integrity + i) > 0, sound, lanes_set(0)) : sound;
}

BRUNT_INLINE brunt_update_result update_dim(int dim, bool tears, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const real half = (real)0.5;
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        lanes change = volume_change(dim, H), J = 1 + change, mu = -change / J;
        load_step_gradient(dim, points, i, H);
        // J_old = J / (1 + v): dJ = J v / (1 + v).
        lanes step = volume_change(dim, H), dJ = J * (step / (1 + step)), before = change - dJ;
        note_deformation(&record, lanes_select(1 + step > 0, J, lanes_set(0)), i);

        line old = pressure_line(k, -before / (1 + before)), now = pressure_line(k, mu);
        lanes e = lanes_load(points->state[INTERNAL_ENERGY] + i), p_old = old.a + old.b * e, heat = lanes_set(0);
        if (tears) p_old = lanes_max(p_old, tear_pressure(k, points->integrity_before, i));
        if (points->plastic_increment) heat += lanes_load(points->plastic_increment + i);
        if (points->viscous_pressure) heat -= lanes_load(points->viscous_pressure + i) * dJ;
        lanes follows = 1 + half * now.b * dJ;
        lanes e_new = (e - half * (p_old + now.a) * dJ + heat) / follows, p = now.a + now.b * e_new;
        lane_mask torn = {0};
        if (tears) {
            lanes least = tear_pressure(k, points->integrity, i);
            torn = p < least;
            e_new = lanes_select(torn, e - half * (p_old + least) * dJ + heat, e_new);
            p = lanes_max(p, least);
        }
        lane_mask good = follows > 0;
        if (k[INITIAL_ENERGY] > 0) good &= e_new > 0;
        note_first(&record.model, ~good, i);

        lanes_store(points->state[INTERNAL_ENERGY] + i, e_new);
        real *work = points->state[COMPRESSION_WORK] + i;
        lanes_store(work, lanes_load(work) - half * (p_old + p) * dJ);
        lanes Jp = J * p;
        for (int c = 0; c < 3; c++) lanes_store(points->stress[c] + i, lanes_load(points->stress[c] + i) - Jp);

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

// That of the start counts: a gas begins with some, a solid has 0.
static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    lane_total stored = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES)
        total_add(&stored, lanes_load(points->volume + i) *
                               (constants[INITIAL_ENERGY] + lanes_load(points->state[COMPRESSION_WORK] + i)));
    energy->internal += total_end(&stored);
}

static real wave_speed(const real *k) {
    double p[9], density = (double)k[DENSITY];
    for (int c = 0; c < 7; c++) p[c] = (double)k[C0 + c];
    p[7] = (double)k[INITIAL_ENERGY], p[8] = (double)k[TENSION];
    return (real)sqrt(speed_squared_at_start(p, density));
}

const brunt_model brunt_polynomial = {
    .name = "polynomial",
    .doc =
        "equation of state, polynomial in mu = rho/rho0 - 1 and linear in the energy (LS-DYNA *EOS_LINEAR_POLYNOMIAL)",
    .eos = true,
    .parameters = parameters,
    .parameter_count = COUNT_OF(parameters),
    .state = energy_state,
    .state_count = COUNT_OF(energy_state),
    .prepare = prepare,
    .flops = {91, 139},
    .update = update,
    .energy = add_energy,
    .wave_speed = wave_speed,
};
