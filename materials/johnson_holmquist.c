// Johnson-Holmquist 2, brittle ceramics and glass (Johnson and Holmquist, An improved computational constitutive model
// for brittle materials, AIP Conf. Proc. 309 (1994) 981; Cronin et al., 4th European LS-DYNA Users Conference (2003),
// for the form).
//   sigma* = sigma_i* - D (sigma_i* - sigma_f*),  * stresses over sigma_HEL = 3/2 (HEL - P_HEL), pressures over P_HEL
//   sigma_i* = A (P* + T*)^N (1 + C ln e*),   sigma_f* = B P*^M (1 + C ln e*) <= SFMAX,   e* = strain rate / rate0 >= 1
//   dD = d eps_p / eps_f,   eps_f = D1 (P* + T*)^D2
//   P = K1 mu + K2 mu^2 + K3 mu^3 + dP for mu > 0,  K1 eta + dP else,  not below -T (1 - D);   eta = 1 - J = mu / (1 +
//   mu)
// sigma and P are Cauchy stresses; the shear modulus is that of the Kirchhoff stress (j2.h). The strain rate is the
// equivalent total one, as in the paper; within a step strength is that of the volume at its end and the bulking at its
// beginning.
//
// Bulking. Elastic energy U = sigma^2 / 6 G that growing damage takes, here of the flow stress before and after at one
// pressure and rate, becomes with the share beta energy of pressure. The paper asks mu dP + dP^2 / 2 K1 of it; with
// eta, which the pressure works on, that is the stored energy itself:
//   W = int P d(eta) + dP eta + dP^2 / (2 K1),
//   dP_new = -K1 eta + sqrt((K1 eta + dP)^2 + 2 beta K1 dU),   eta of the middle of the step.
// eta and mu differ by a part mu. For mu < 0 the paper has K1 mu; with K1 eta W is (K1 eta + dP)^2 / (2 K1), which ends
// at 0 where fragments part (with K1 mu it ends below 0). Where the net compression K1 eta + dP is negative nothing is
// pushed apart, and U is lost. dP stays when the load goes: it is the room that fragments take.
#include "materials/brittle.h"

enum {
    K1 = J2_CONSTANTS,
    K2,
    K3,
    A,
    N,
    B,
    M,
    RATE,
    RATE_ZERO,
    TENSION,
    TENSION_STAR,
    INVERSE_P_HEL,
    SIGMA_HEL,
    SF_MAX,
    D1,
    D2,
    BETA,
    FAILURE_STRAIN
};
enum { DAMAGE = J2_MODEL_STATE, BULKING };

static const brunt_parameter parameters[] = {
    PARAMETER_G,
    {"K1", "Pa", NAN, 0, INFINITY, true, true, "bulk modulus: P = K1 mu + K2 mu^2 + K3 mu^3, mu = density ratio - 1"},
    {"K2", "Pa", 0, -INFINITY, INFINITY, true, true, "second coefficient of the pressure, in compression"},
    {"K3", "Pa", 0, -INFINITY, INFINITY, true, true, "third coefficient of the pressure, in compression"},
    {"A", "1", NAN, 0, INFINITY, true, true, "intact strength: A (P* + T*)^N"},
    {"N", "1", NAN, 0, INFINITY, false, true, "exponent of the intact strength"},
    {"B", "1", 0, 0, INFINITY, false, true, "fractured strength: B P*^M"},
    {"M", "1", 1, 0, INFINITY, false, true, "exponent of the fractured strength"},
    {"C", "1", 0, 0, INFINITY, false, true, "rate sensitivity of both"},
    {"rate0", "1/s", 1, 0, INFINITY, true, true, "strain rate below which rate has no effect"},
    {"SFMAX", "1", INFINITY, 0, INFINITY, false, false, "greatest fractured strength, over that at the HEL"},
    {"T", "Pa", NAN, 0, INFINITY, false, true, "greatest hydrostatic tension of intact material"},
    {"HEL", "Pa", NAN, 0, INFINITY, true, true, "Hugoniot elastic limit: axial stress in uniaxial strain"},
    {"P_HEL", "Pa", NAN, 0, INFINITY, true, true, "pressure at the Hugoniot elastic limit"},
    {"D1", "1", 0, 0, INFINITY, false, true, "plastic strain to fracture: D1 (P* + T*)^D2; 0: fractures at once"},
    {"D2", "1", 1, 0, INFINITY, false, true, "exponent of the plastic strain to fracture"},
    {"beta", "1", 1, 0, 1, false, false, "share of the elastic energy lost by fracture that becomes pressure"},
    PARAMETER_FAILURE_STRAIN,
};
static const brunt_state_field state[] = {
    J2_STATE, {"damage", "1", 1, 1, NULL}, {"bulking_pressure", "Pa", 1, 1, NULL}};

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    if (with_eos) return "this model gives its own pressure and takes no equation of state";
    if (!(p[12] > p[13])) return "HEL is not above P_HEL: nothing is left for the strength";
    brittle_prepare(p[0], density, constants);
    static const int place[] = {K1, K2, K3, A, N, B, M, RATE, RATE_ZERO, SF_MAX, TENSION};
    for (int c = 0; c < BRUNT_COUNT(place); c++) constants[place[c]] = (real)p[c + 1];
    constants[TENSION_STAR] = (real)(p[11] / p[13]);
    constants[INVERSE_P_HEL] = (real)(1 / p[13]);
    constants[SIGMA_HEL] = (real)(1.5 * (p[12] - p[13]));
    constants[D1] = (real)p[14];
    constants[D2] = (real)p[15];
    constants[BETA] = (real)p[16];
    constants[FAILURE_STRAIN] = (real)p[17];
    return NULL;
}

BRUNT_INLINE lanes elastic_pressure(const real *k, lanes change) {
    return lanes_select(change < 0, cubic(k + K1, -change / (1 + change)), -k[K1] * change);
}

// The eta below which it is torn.
BRUNT_INLINE lanes opening(const real *k, lanes bulking, lanes damage) {
    return -(k[TENSION] * (1 - damage) + bulking) * (1 / k[K1]);
}

// W per reference volume; `change` = J - 1 = -eta.
BRUNT_INLINE lanes stored_energy(const real *k, lanes change, lanes bulking, lanes damage) {
    lanes closed = lanes_max(-change, opening(k, bulking, damage)), gap = closed + change;
    lanes net = k[K1] * closed + bulking, dilated = net * net * ((real)0.5 / k[K1]);
    lanes squeezed = cubic_energy(k + K1, closed / (1 - closed)) + bulking * (closed + bulking * ((real)0.5 / k[K1]));
    return lanes_select(closed > 0, squeezed, dilated) + k[TENSION] * (1 - damage) * gap;
}

// dP/dmu: K1 deta/dmu = K1 J^2 in expansion, to where it opens.
BRUNT_INLINE lanes pressure_slope(const real *k, lanes change, lanes bulking, lanes damage) {
    lanes stretch = lanes_min(1 + change, 1 - opening(k, bulking, damage));
    return lanes_select(change < 0, cubic_slope(k + K1, -change / (1 + change)), k[K1] * stretch * stretch);
}

// Both strengths at a pressure [Pa], Kirchhoff.
BRUNT_INLINE softening strength(const real *k, lanes pressure, lanes J, lanes rate, lanes damage) {
    lanes P = pressure * k[INVERSE_P_HEL], T = P + k[TENSION_STAR], scale = J * k[SIGMA_HEL];
    lanes intact = scale * k[A] * power(T, k[N]) * rate;
    lanes fractured = scale * lanes_min(k[B] * power(P, k[M]) * rate, lanes_set(k[SF_MAX]));
    softening s = {.damage = damage, .drop = intact - fractured};
    s.limit = intact - damage * s.drop;
    // Where the curves cross, fracture makes it stronger.
    s.lower = lanes_min(fractured, s.limit);
    s.upper = lanes_select(s.drop < 0, fractured, lanes_set((real)INFINITY));
    s.strain = k[D1] * power(T, k[D2]);
    return s;
}

// dP after elastic energy of U [J/m^3] was set free; change and before: J - 1 at the end and the beginning of the step.
BRUNT_INLINE lanes bulked(const real *k, lanes bulking, lanes U, lanes change, lanes before) {
    lanes net = bulking - (real)0.5 * k[K1] * (change + before), gain = 2 * k[BETA] * k[K1] * U;
    lanes sum = lanes_max(net + lanes_sqrt(net * net + gain), lanes_set(LANES_REAL_MIN));
    return bulking + lanes_select((net >= 0) & (U > 0), gain / sum, lanes_set(0));
}

// Without `bulks` beta is 0: no pressure of bulking is kept then.
BRUNT_INLINE brunt_update_result update_dim(int dim, bool bulks, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const lanes per_step = inverse_rate_step(points, k[RATE_ZERO]), zero = lanes_set(0);
    bool failed = false;
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        j2_point p = j2_trial(dim, k, points, i, &record);
        real *damage = points->state[j2_slot(dim, DAMAGE)] + i;
        real *bulking = bulks ? points->state[j2_slot(dim, BULKING)] + i : NULL;
        lanes change = p.volume_change, J = 1 + change, D = lanes_load(damage);
        const lanes dP = bulks ? lanes_load(bulking) : zero;
        lanes pushed = dP;
        lanes elastic = elastic_pressure(k, change), pressure = lanes_max(elastic + dP, -k[TENSION] * (1 - D));
        lanes delta = zero, q = p.q, loss = zero;
        lane_mask plastic = p.q > 0;
        if (lanes_any(plastic)) {
            softening s = strength(k, pressure, J, rate_factor(dim, points, i, k[RATE], per_step), D);
            lanes begin = softening_begin(&s);
            plastic = p.q > lanes_max(begin, lanes_set(BRITTLE_ROUNDING * k[J2_MU]));
            if (lanes_any(plastic)) {
                delta = softening_return(dim, k, &p, &s, plastic, &q);
                lanes grown = lanes_select(plastic, softening_damage(&s, delta), D);
                lanes before = volume_change_before(dim, points, i, change);
                if (bulks) {
                    lanes U = lanes_select(plastic, (begin * begin - q * q) * (1 / (6 * k[J2_MU])), zero);
                    pushed = bulked(k, dP, U, change, before);
                }
                loss = stored_energy(k, change, dP, D) - stored_energy(k, change, pushed, grown);
                loss += stored_energy(k, before, dP, D) - stored_energy(k, before, pushed, grown);
                loss = lanes_select(plastic, (real)0.5 * loss, zero);
                pressure = lanes_max(elastic + pushed, -k[TENSION] * (1 - grown));
                lanes_store(damage, grown);
                if (bulks) lanes_store(bulking, pushed);
            }
        }
        j2_store(dim, k, points, i, &p, (j2_flow){delta, q}, &record);
        add_plastic_work(dim, points, i, loss);
        lanes stiffness = pressure_slope(k, change, pushed, lanes_load(damage));
        note_first(&record.model, ~(stiffness > 0), i);
        store_pressure(k, points, i, &p, J * pressure, stiffness, &record);
        failed |= fail_beyond(dim, points, i, k[FAILURE_STRAIN], damage);
    }
    brunt_update_result result =
        update_end(&record, points, "compressed past where the pressure K1 mu + K2 mu^2 + K3 mu^3 rises with density");
    result.failed = failed;
    return result;
}

static brunt_update_result update(const real *constants, const brunt_material_points *points) {
    return points->dim == 2 ? update_dim(2, true, constants, points) : update_dim(3, true, constants, points);
}

static brunt_update_result update_flat(const real *constants, const brunt_material_points *points) {
    return points->dim == 2 ? update_dim(2, false, constants, points) : update_dim(3, false, constants, points);
}

static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    brittle_energy(constants, points, BULKING, DAMAGE, stored_energy, energy);
}

static lanes stored_without_bulking(const real *k, lanes change, lanes variable, lanes damage) {
    (void)variable;
    return stored_energy(k, change, lanes_set(0), damage);
}

static void add_energy_without_bulking(const real *constants, const brunt_material_points *points,
                                       brunt_point_energy *energy) {
    brittle_energy(constants, points, DAMAGE, DAMAGE, stored_without_bulking, energy);
}

static real wave_speed(const real *constants) { return brittle_wave_speed(constants, constants[K1]); }

#define JOHNSON_HOLMQUIST                                                                                              \
    .name = "johnson-holmquist-2",                                                                                     \
    .doc = "brittle ceramics and glass: intact and fractured strength, damage, bulking (Johnson and Holmquist 1994)",  \
    .plastic = true, .damage = true, .parameters = parameters, .parameter_count = BRUNT_COUNT(parameters),             \
    .state = state, .prepare = prepare, .flops = {538, 648}, .wave_speed = wave_speed,                                 \
    .no_potential = "'johnson-holmquist-2' has no potential for implicit steps: its strength falls with damage"
#define BULKS .state_count = BRUNT_COUNT(state), .update = update, .energy = add_energy
#define FLAT .state_count = BRUNT_COUNT(state) - 1, .update = update_flat, .energy = add_energy_without_bulking

static const brunt_model static_form = {JOHNSON_HOLMQUIST, BULKS};
static const brunt_model flat_form = {JOHNSON_HOLMQUIST, FLAT, .rate_dependent = true};
static const brunt_model static_flat_form = {JOHNSON_HOLMQUIST, FLAT};

static const brunt_model *reduced(const double *p) {
    if (p[16] > 0) return p[8] > 0 ? NULL : &static_form;
    return p[8] > 0 ? &flat_form : &static_flat_form;
}

const brunt_model brunt_johnson_holmquist = {JOHNSON_HOLMQUIST, BULKS, .rate_dependent = true, .reduced = reduced};
