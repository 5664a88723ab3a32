// Artificial bulk viscosity: spreads a shock over a few cells (von Neumann and Richtmyer, J. Appl. Phys. 21 (1950) 232;
// linear term: Landshoff, LANL report LA-1930 (1955); constants as in Hallquist's LS-DYNA theory manual):
//   q = rho l (quadratic l d^2 + linear c |d|)  for d = tr L < 0, else 0;  l = the cell.
//
// c is the wave speed of the undeformed body: the linear term is there to damp the ringing behind a front, for which
// the order of magnitude is what counts, and a constant keeps every point's result its own, and a resumed run the same,
// where the current greatest speed of the body would not. What grows with a strong shock is the quadratic term.
//
// Both have a bound, from which on they would no longer be a correction. Compression sets in within a step that was
// chosen without q: with 60 and 1500 the first such step made 13 and 2.4 % of an impact's energy, with 5 and 100 at 0.9
// of the stable step 11 and 53 %; with 1 and 10 it is 2 % at the most.
//
// The stress at the end of a step carries q of that step's rate and acts until the next, so the work it does in a step
// is with the mean of the last q and this one, and q of the last step is state. In the step after a compression ends
// that work is negative once: the old q still pushes.
#include "materials/tensor.h"

enum { LINEAR, QUADRATIC, DENSITY };
enum { VISCOUS_WORK, LAST_PRESSURE };

static const brunt_parameter parameters[] = {
    {"linear", "1", 0.06, 0, 1, false, false, "factor of the linear term; 1 ends all ringing"},
    {"quadratic", "1", 1.5, 0, 10, false, false, "factor of the quadratic term"},
};

static const brunt_state_field state[] = {
    {"viscous_work", "J/m^3", 1, 1, NULL},
    {"viscous_pressure", "Pa", 1, 1, NULL},
};

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    (void)with_eos;
    constants[LINEAR] = (real)p[0];
    constants[QUADRATIC] = (real)p[1];
    constants[DENSITY] = (real)density;
    return NULL;
}

BRUNT_INLINE brunt_update_result update_dim(int dim, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const real linear = k[LINEAR] * points->wave_speed, quadratic = k[QUADRATIC] * points->cell;
    lanes fastest = lanes_set(0), zero = fastest;
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        lanes J = 1 + volume_change(dim, H);
        note_deformation(&record, J, i);
        load_step_gradient(dim, points, i, H);
        lanes dJ = J - J / (1 + volume_change(dim, H));
        lanes squeeze = lanes_max(-load_divergence(dim, points, i), zero);
        lanes speed = linear + quadratic * squeeze, Jq = k[DENSITY] * points->cell * speed * squeeze, q = Jq / J;
        real *last = points->state[LAST_PRESSURE] + i, *work = points->state[VISCOUS_WORK] + i;
        lanes mean = (real)0.5 * (lanes_load(last) + q);
        lanes_store(last, q);
        lanes_store(work, lanes_load(work) - mean * dJ);
        if (points->viscous_pressure) lanes_store(points->viscous_pressure + i, mean);
        for (int c = 0; c < 3; c++) lanes_store(points->stress[c] + i, lanes_load(points->stress[c] + i) - Jq);
        fastest = lanes_max(lanes_select(squeeze > 0, speed, zero), fastest);
    }
    note_speed(&record, fastest * fastest);
    return update_end(&record, points, NULL);
}

MATERIAL_UPDATE

static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    (void)constants;
    energy->viscosity += state_total(points, VISCOUS_WORK);
}

static bool off(const double *p) { return p[0] == 0 && p[1] == 0; }

const brunt_model brunt_bulk_viscosity = {
    .name = "bulk-viscosity",
    .doc = "artificial bulk viscosity, linear and quadratic (von Neumann and Richtmyer 1950, Landshoff 1955)",
    .viscous = true,
    .parameters = parameters,
    .parameter_count = BRUNT_COUNT(parameters),
    .state = state,
    .state_count = BRUNT_COUNT(state),
    .prepare = prepare,
    .off = off,
    .flops = {34, 83},
    .update = update,
    .energy = add_energy,
    .wave_speed = no_wave_speed, // nothing is compressed at rest
};
