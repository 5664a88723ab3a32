// Tait's equation of state, for liquids that are hardly compressed (Cole, Underwater Explosions (1948), section 2.3;
// for weakly compressible free-surface flow: Monaghan, J. Comput. Phys. 110 (1994) 399):
//   p = B (J^-gamma - 1),  B = rho0 c0^2 / gamma;  gamma = 1: p = c0^2 (rho - rho0).
// The pressure is a function of J alone, so is the energy U = -int p dJ from J = 1 on: no state. With L = ln J and
// phi(z) = e^z - 1 - z,
//   p = B (phi(-gamma L) - gamma L),  U = B (phi((1 - gamma) L) / (gamma - 1) + phi(L)),
// which keeps the digits of small compressions, and of which each term is positive.
//
// Beyond `tension` the liquid tears: p stays at -tension however far it expands, and U grows by tension dJ.
#include "materials/exponential.h"
#include "materials/trial.h"

enum { DENSITY, SOUND_SPEED, GAMMA, MODULUS, TENSION, TEAR };

static const brunt_parameter parameters[] = {
    {"c0", "m/s", NAN, 0, INFINITY, true, true, "sound speed at rest; ten times the flow's keeps density to 1 %"},
    {"gamma", "1", 7, 1, INFINITY, false, true, "exponent; 1: pressure linear in density"},
    {"tension", "Pa", INFINITY, 0, INFINITY, false, false,
     "greatest tension it carries, beyond which it cavitates; 0: none at all"},
};

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    (void)with_eos;
    double modulus = density * p[0] * p[0] / p[1], share = p[2] / modulus;
    constants[DENSITY] = (real)density;
    constants[SOUND_SPEED] = (real)p[0];
    constants[GAMMA] = (real)p[1];
    constants[MODULUS] = (real)modulus;
    constants[TENSION] = (real)p[2];
    // ln J at which it tears. Tension stays below the modulus in any expansion.
    constants[TEAR] = (real)(share < 1 ? -log1p(-share) / p[1] : INFINITY);
    return NULL;
}

BRUNT_INLINE brunt_update_result update_dim(int dim, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const lanes limit = lanes_set(-k[TENSION]);
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        lanes change = volume_change(dim, H), J = 1 + change;
        note_deformation(&record, J, i);
        lanes z = -k[GAMMA] * lanes_log1p(change), power = z + exponential_excess(z); // J^-gamma - 1
        lanes Jp = J * lanes_max(k[MODULUS] * power, limit);
        for (int c = 0; c < 3; c++) lanes_store(points->stress[c] + i, lanes_load(points->stress[c] + i) - Jp);
        // c^2 = dp/drho = c0^2 J^(1 - gamma). A liquid that has expanded, or torn, closes again at c0.
        lanes faster = lanes_max(J * (1 + power), lanes_set(1));
        note_speed(&record, k[SOUND_SPEED] * k[SOUND_SPEED] * faster);
    }
    return update_end(&record, points, NULL);
}

MATERIAL_UPDATE

// U(J) of log J.
BRUNT_INLINE lanes stored_density(const real *k, lanes log_J) {
    const real rest = k[GAMMA] - 1, inverse = rest > 0 ? 1 / rest : 0;
    lanes liquid = lanes_min(log_J, lanes_set(k[TEAR]));
    lanes density = exponential_excess(-rest * liquid) * inverse + exponential_excess(liquid);
    density *= k[MODULUS];
    if (k[TEAR] < (real)INFINITY) density += k[TENSION] * (lanes_exp(log_J) - lanes_exp(liquid));
    return density;
}

BRUNT_INLINE void energy_dim(int dim, const real *k, const brunt_material_points *points, brunt_point_energy *energy) {
    lane_total stored = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        lanes density = stored_density(k, lanes_log1p(volume_change(dim, H)));
        total_add(&stored, lanes_load(points->volume + i) * density);
    }
    energy->internal += total_end(&stored);
}

MATERIAL_ENERGY

static real wave_speed(const real *constants) { return constants[SOUND_SPEED]; }

// --------------------------------------------------------------------------------- implicit steps

// J^2 U'' = gamma B J^(1 - gamma), 0 where it is torn.
BRUNT_INLINE volume_response response_at(const real *k, lanes change, lanes log_J) {
    const lanes limit = lanes_set(-k[TENSION]), J = 1 + change;
    lanes z = -k[GAMMA] * log_J, power = z + exponential_excess(z), p = k[MODULUS] * power;
    lanes stiff = k[GAMMA] * k[MODULUS] * J * (1 + power);
    return (volume_response){stored_density(k, log_J), -J * lanes_max(p, limit),
                             lanes_select(p < limit, lanes_set(0), stiff)};
}

BRUNT_INLINE void respond_dim(int dim, const real *k, const brunt_trial_points *trial) {
    volume_respond(dim, response_at, k, trial);
}

TRIAL_RESPOND

static const brunt_model_potential potential = {.respond = respond};

const brunt_model brunt_tait = {
    .name = "tait",
    .doc = "liquid, weakly compressible, pressure by density alone (Cole 1948, Monaghan 1994)",
    .eos = true,
    .parameters = parameters,
    .parameter_count = BRUNT_COUNT(parameters),
    .prepare = prepare,
    .potential = &potential,
    .flops = {102, 124},
    .update = update,
    .energy = add_energy,
    .wave_speed = wave_speed,
};
