// Drucker-Prager, soil and other cohesive or frictional material (Drucker and Prager, Quarterly of Applied Mathematics
// 10 (1952) 157; de Souza Neto, Peric and Owen, Computational Methods for Plasticity (2008), section 6.4):
//   q <= a + b p,   p >= -tension,   tension at most a / b, the apex
// fitted to Mohr-Coulomb on its compressive meridian (the outer cone), so that triaxial compression is exact:
//   a = 6 c cos(phi) / (3 - sin(phi)),   b = 6 sin(phi) / (3 - sin(phi));
// triaxial extension is then stronger than Mohr-Coulomb's by (3 + sin(phi)) / (3 - sin(phi)). q and p are Kirchhoff
// stresses, as in j2.h.
//
// Flow goes by q - beta p, beta = 6 sin(psi) / (3 - sin(psi)) of the dilatancy angle psi <= phi: with the equivalent
// plastic strain eps_p the volume grows by d(log J_p) = beta d(eps_p). psi = phi is associated, psi = 0 (the default)
// keeps the volume. Of power, (q - beta p) d(eps_p) is dissipated, which is not negative with psi <= phi. Hardening
// raises the cohesion: a + h eps_p.
//
// The pressure is linear in the logarithmic elastic volume, p = -K log(J / J_p), energy K/2 log^2(J / J_p). Below
// -tension the material is open: p stays, and it closes where it opened (brittle.h); this is no plastic flow and leaves
// no volume behind.
#include "materials/brittle.h"

enum { BULK = J2_CONSTANTS, COHESION, FRICTION, DILATANCY, HARDENING, TENSION, STIFFENING };
enum { PLASTIC_VOLUME = J2_MODEL_STATE };

static const brunt_parameter parameters[] = {FRICTIONAL_PARAMETERS};
static const brunt_state_field state[] = {J2_STATE, {"plastic_volume", "1", 1, 1, NULL}};

static double slope_of(double angle) { return 6 * sin(angle) / (3 - sin(angle)); }

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    const char *wrong = frictional_parameters(p, with_eos);
    if (wrong) return wrong;
    const double b = slope_of(p[3]), share = 6 * cos(p[3]) / (3 - sin(p[3])), a = share * p[2];
    brittle_prepare(shear_modulus(p[0], p[1]), density, constants);
    constants[BULK] = (real)bulk_modulus(p[0], p[1]);
    constants[COHESION] = (real)a;
    constants[FRICTION] = (real)b;
    constants[DILATANCY] = (real)slope_of(p[4]);
    constants[HARDENING] = (real)(share * p[5]);
    constants[TENSION] = (real)(b > 0 ? fmin(p[6], a / b) : p[6]);
    const double mu = shear_modulus(p[0], p[1]), bulk = bulk_modulus(p[0], p[1]), beta = slope_of(p[4]);
    constants[STIFFENING] =
        (real)frictional_stiffening((frictional_slope){bulk * beta, 2 * mu}, (frictional_slope){bulk * b, 2 * mu},
                                    3 * mu + b * bulk * beta + share * p[5]);
    return NULL;
}

// W per reference volume; `volume` = log(J / J_p).
BRUNT_INLINE lanes stored_energy(const real *k, lanes volume) { return opening_energy(k[BULK], k[TENSION], volume); }

// Plastic strain with trial - stiffness delta = a + h delta + b max(p + K beta delta, -tension): the lesser root of
// both branches.
BRUNT_INLINE lanes flow(const real *k, bool dilates, const j2_point *p, lanes a, lanes free_pressure) {
    lanes closed = p->stiffness + k[HARDENING], apart = (p->q - a + k[FRICTION] * k[TENSION]) / closed;
    if (!dilates) return (p->q - a - k[FRICTION] * lanes_max(free_pressure, lanes_set(-k[TENSION]))) / closed;
    lanes together = (p->q - a - k[FRICTION] * free_pressure) / (closed + k[FRICTION] * k[BULK] * k[DILATANCY]);
    return k[FRICTION] > 0 && k[TENSION] < (real)INFINITY ? lanes_min(together, apart) : together;
}

BRUNT_INLINE brunt_update_result update_dim(int dim, bool dilates, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const lanes zero = lanes_set(0);
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        j2_point p = j2_trial(dim, k, points, i, &record);
        real *plastic_volume = dilates ? points->state[j2_slot(dim, PLASTIC_VOLUME)] + i : NULL;
        lanes volume = lanes_log1p(p.volume_change), opened = dilates ? lanes_load(plastic_volume) : zero;
        lanes elastic = volume - opened, free_pressure = -k[BULK] * elastic;
        lanes pressure = lanes_max(free_pressure, lanes_set(-k[TENSION])), loss = zero;
        lanes a = k[COHESION] + k[HARDENING] * p.plastic_strain, delta = zero, q = p.q;
        lanes limit = a + k[FRICTION] * pressure; // at the apex 0 but for rounding
        lane_mask plastic = p.q > lanes_max(limit, lanes_set(BRITTLE_ROUNDING * k[J2_MU]));
        if (lanes_any(plastic)) {
            j2_set_stiffness(k, &p);
            lanes end = p.q - p.stiffness * flow(k, dilates, &p, a, free_pressure);
            q = lanes_select(plastic, lanes_max(end, zero), p.q);
            delta = return_deviator(dim, k, &p, plastic, q);
            if (dilates) {
                lanes grown = k[DILATANCY] * delta, after = elastic - grown;
                lanes before = lanes_log1p(volume_change_before(dim, points, i, p.volume_change)) - opened;
                loss = stored_energy(k, elastic) - stored_energy(k, after);
                loss += stored_energy(k, before) - stored_energy(k, before - grown);
                loss = lanes_select(plastic, (real)0.5 * loss, zero);
                elastic = after;
                pressure = lanes_max(-k[BULK] * elastic, lanes_set(-k[TENSION]));
                lanes_store(plastic_volume, opened + grown);
            }
        }
        j2_store(dim, k, points, i, &p, (j2_flow){delta, q}, &record);
        if (dilates) add_plastic_work(dim, points, i, loss);
        const lanes stiffening = lanes_select(plastic, lanes_set(k[STIFFENING]), zero);
        store_pressure(k, points, i, &p, pressure, k[BULK] * (1 + lanes_max(-elastic, zero)) + stiffening, &record);
    }
    return update_end(&record, points, NULL);
}

static brunt_update_result update(const real *constants, const brunt_material_points *points) {
    return points->dim == 2 ? update_dim(2, true, constants, points) : update_dim(3, true, constants, points);
}
static brunt_update_result update_isochoric(const real *constants, const brunt_material_points *points) {
    return points->dim == 2 ? update_dim(2, false, constants, points) : update_dim(3, false, constants, points);
}

BRUNT_INLINE void volume_energy(int dim, bool dilates, const real *k, const brunt_material_points *points,
                                brunt_point_energy *energy) {
    lane_total stored = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        lanes volume = lanes_log1p(volume_change(dim, H));
        if (dilates) volume -= lanes_load(points->state[j2_slot(dim, PLASTIC_VOLUME)] + i);
        total_add(&stored, lanes_load(points->volume + i) * stored_energy(k, volume));
    }
    energy->internal += total_end(&stored);
}

static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    j2_energy(constants, points, energy);
    if (points->dim == 2)
        volume_energy(2, true, constants, points, energy);
    else
        volume_energy(3, true, constants, points, energy);
}
static void add_energy_isochoric(const real *constants, const brunt_material_points *points,
                                 brunt_point_energy *energy) {
    j2_energy(constants, points, energy);
    if (points->dim == 2)
        volume_energy(2, false, constants, points, energy);
    else
        volume_energy(3, false, constants, points, energy);
}

static real wave_speed(const real *constants) { return brittle_wave_speed(constants, constants[BULK]); }

#define DRUCKER_PRAGER                                                                                                 \
    .name = "drucker-prager",                                                                                          \
    .doc = "soil and frictional material: strength that grows with pressure, dilatancy (Drucker and Prager 1952)",     \
    .plastic = true, .parameters = parameters, .parameter_count = BRUNT_COUNT(parameters), .state = state,             \
    .prepare = prepare, .wave_speed = wave_speed,                                                                      \
    .no_potential = "'drucker-prager' has no potential for implicit steps: it does not flow along the normal of its "  \
                    "yield surface",                                                                                   \
    .differences = true

// Flow that keeps the volume has no plastic one to remember.
static const brunt_model isochoric = {DRUCKER_PRAGER, .state_count = BRUNT_COUNT(state) - 1, .flops = {223, 329},
                                      .update = update_isochoric, .energy = add_energy_isochoric};

static const brunt_model *reduced(const double *p) { return p[4] > 0 ? NULL : &isochoric; }

const brunt_model brunt_drucker_prager = {DRUCKER_PRAGER,       .state_count = BRUNT_COUNT(state),
                                          .flops = {264, 377},  .update = update,
                                          .energy = add_energy, .reduced = reduced};
