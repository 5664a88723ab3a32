// Ideal gas of constant heats: p = (gamma - 1) e / J, with e the internal energy per reference volume.
//
// A step is an isentrope with the heat Q (of viscosity, bulk viscosity) in its middle:
//   e1 = (e0 m + Q) m,  m = (1 + v)^((1 - gamma)/2),  1 + v = det(I + dt L),
// exact without heat, whatever the step, and e stays positive. Tried and left: the trapezoid -(p0 + p1)/2 dJ in closed
// form, which has no answer where a step more than empties the gas, and whose ledger was off several times as much
// where gas rushes into vacuum (2 % of its energy, with steps of a tenth of the volume); and the trapezoid of the
// stress with its rate at either end, which depends on the rotation of the frame.
//
// Internal energy is that of the start with the work done on the gas by its pressure alone: heat is where it came from.
#include "materials/energy_state.h"

enum { GAMMA_1 = ENERGY_CONSTANTS, SOUND }; // gamma - 1, gamma (gamma - 1) / rho0

static const brunt_parameter parameters[] = {
    {"gamma", "1", 1.4, 1, INFINITY, true, true, "ratio of specific heats"},
    {"initial_energy", "J/m^3", NAN, 0, INFINITY, true, true,
     "internal energy per volume at the start: pressure over gamma - 1"},
};

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    (void)with_eos;
    constants[GAMMA_1] = (real)(p[0] - 1);
    constants[SOUND] = (real)(p[0] * (p[0] - 1) / density);
    constants[INITIAL_ENERGY] = (real)p[1];
    return NULL;
}

BRUNT_INLINE brunt_update_result update_dim(int dim, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const real half = (real)0.5 * k[GAMMA_1];
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        lanes J = 1 + volume_change(dim, H);
        load_step_gradient(dim, points, i, H);
        lanes v = volume_change(dim, H);
        note_deformation(&record, lanes_select(1 + v > 0, J, lanes_set(0)), i);

        lanes e = lanes_load(points->state[INTERNAL_ENERGY] + i), heat = lanes_set(0);
        if (points->plastic_increment) heat += lanes_load(points->plastic_increment + i);
        if (points->viscous_pressure) heat -= lanes_load(points->viscous_pressure + i) * J * (v / (1 + v));
        lanes m = lanes_exp(-half * lanes_log1p(v)), e_new = (e * m + heat) * m;
        note_first(&record.model, ~((e_new > 0) & (e_new <= MATERIAL_REAL_MAX)), i);
        lanes work = (m - 1) * (e * (m + 1) + heat); // e_new - e - heat
        store_energy_step(points, i, e_new, work, k[GAMMA_1] * e_new);
        note_speed(&record, k[SOUND] * e_new); // c^2 = gamma p / rho
    }
    return update_end(&record, points, "the internal energy of the gas is not positive and finite");
}

MATERIAL_UPDATE

static real wave_speed(const real *constants) {
    return (real)sqrt((double)constants[SOUND] * (double)constants[INITIAL_ENERGY]);
}

const brunt_model brunt_ideal_gas = {
    .name = "ideal-gas",
    .doc = "ideal gas of constant specific heats",
    ENERGY_EOS,
    .parameters = parameters,
    .parameter_count = BRUNT_COUNT(parameters),
    .prepare = prepare,
    .flops = {115, 163},
    .update = update,
    .energy = add_internal_energy,
    .wave_speed = wave_speed,
    .no_potential =
        "'ideal-gas' has no potential for implicit steps: its pressure depends on the energy that it has at their end",
    .differences = true,
};
