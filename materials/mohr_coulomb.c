// Mohr-Coulomb, soil, rock and other cohesive or frictional material, in Hencky strain (Coulomb 1773; de Souza Neto,
// Peric and Owen, Computational Methods for Plasticity (2008), sections 6.3 and 8.2): with principal Kirchhoff stresses
// t1 >= t2 >= t3, tension positive,
//   f = (t1 - t3) + (t1 + t3) sin(phi) - 2 c cos(phi) <= 0,
// flow by g = (t1 - t3) + (t1 + t3) sin(psi) of the dilatancy angle psi <= phi. In triaxial compression -t3 is
//   -t1 tan^2(45 deg + phi/2) + 2 c tan(45 deg + phi/2), in extension the same with the axes swapped.
//
// State is B = b - I of the elastic left Cauchy-Green tensor b, so that small strains keep their digits. A step carries
// b to f b f^T; e_i = log1p(B_i) / 2 of its principal values is the trial, and flow takes what is too much from these:
// axes stay. Energy mu |dev e|^2 + U(tr e); mean stress U' = K tr e, but not above `tension`, at most the apex c /
// tan(phi): beyond that the material is open, and it closes at the volume where it opened (brittle.h); only dilatancy
// leaves volume behind. So stress at the apex is where the pyramid's section has no size: a return to an edge.
//
// Return. The faces 13 (alone), 13 and 12 (edge t2 = t3), 13 and 23 (edge t1 = t2) are linear in their multipliers
// while closed and while open, f is the lesser of both, and so is the root. Which edge it is, is the side of
//   (1 - sin(psi)) t1 - 2 t2 + (1 + sin(psi)) t3
// on which the trial lies, which is 0 where face 13 alone ends at the apex.
//
// Hardening raises the cohesion, c + h eps_p, eps_p the equivalent plastic strain, as sqrt(2/3 e:e) of the deviator of
// each increment. What flows dissipates 2 c cos(phi) - (sin(phi) - sin(psi)) (t1 + t3) per multiplier, which is not
// negative up to the apex with psi <= phi. It is recorded as the trapezoid of stress over plastic strain (material.h).
#include "materials/brittle.h"
#include "materials/principal.h"

enum { BULK = J2_CONSTANTS, COHESION, HARDENING, FRICTION, DILATANCY, TENSION, STIFFENING };
enum { PLASTIC_STRAIN, PLASTIC_WORK };

static const brunt_parameter parameters[] = {FRICTIONAL_PARAMETERS};
static const brunt_state_field state[] = {{"elastic_finger_strain", "1", 6, 4, NULL},
                                          {"plastic_strain", "1", 1, 1, NULL},
                                          {"plastic_work", "J/m^3", 1, 1, NULL}};

// The greatest of face 13, alone, and of the two edges, where two faces give way at once (brittle.h).
static double stiffening(double bulk, double mu, double f, double g) {
    const double lambda = bulk - mu * (2.0 / 3), third = f * g / 3, closing = 4 * f * g * bulk,
                 face = 4 * mu * (1 + third);
    const frictional_slope A[3] = {{2 * g * lambda + 2 * mu * (1 + g), 4 * mu},
                                   {2 * g * lambda + 2 * mu * (1 + g), mu * (3 + g)},
                                   {2 * g * lambda + mu * (1 + g), mu * (3 - g)}};
    const frictional_slope B[3] = {{2 * f * lambda + 2 * mu * (1 + f), 4 * mu},
                                   {2 * f * lambda + 2 * mu * (1 + f), mu * (3 + f)},
                                   {2 * f * lambda + mu * (1 + f), mu * (3 - f)}};
    const double D[3] = {face, 0.5 * face + mu * (1 + f + g - third), 0.5 * face + mu * (1 - f - g - third)};
    double most = 0;
    for (int k = 0; k < 3; k++) most = fmax(most, frictional_stiffening(A[k], B[k], D[k] + closing));
    return most;
}

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    const char *wrong = frictional_parameters(p, with_eos);
    if (wrong) return wrong;
    brittle_prepare(shear_modulus(p[0], p[1]), density, constants);
    constants[BULK] = (real)bulk_modulus(p[0], p[1]);
    constants[COHESION] = (real)(2 * p[2] * cos(p[3]));
    constants[HARDENING] = (real)(2 * p[5] * cos(p[3]));
    constants[FRICTION] = (real)sin(p[3]);
    constants[DILATANCY] = (real)sin(p[4]);
    constants[TENSION] = (real)(p[3] > 0 ? fmin(p[6], p[2] / tan(p[3])) : p[6]);
    constants[STIFFENING] = (real)stiffening(bulk_modulus(p[0], p[1]), shear_modulus(p[0], p[1]), sin(p[3]), sin(p[4]));
    return NULL;
}

// --------------------------------------------------------------------------------- return

// A point at the end of a step. e: trial, flow: what it loses of it, tau: stress; in the axes of the trial, as they
// come.
typedef struct frictional_point {
    principal_axes axes;
    lanes e[3], flow[3], tau[3];
    lanes delta, plastic_strain; // equivalent plastic increment; plastic strain at the start
    lane_mask plastic;
} frictional_point;

// The trial in descending order, as deviatoric stress `d`; `rank` says where an axis has gone.
typedef struct sorted_trial {
    lanes d[3], volume, rank[3];
} sorted_trial;

BRUNT_INLINE lanes mean_stress(const real *k, lanes volume) {
    return lanes_min(k[BULK] * volume, lanes_set(k[TENSION]));
}

BRUNT_INLINE sorted_trial sort_trial(const real *k, const lanes e[3]) {
    sorted_trial s;
    const lanes zero = lanes_set(0), one = lanes_set(1);
    s.volume = e[0] + e[1] + e[2];
    const lanes mean = s.volume * (real)(1.0 / 3);
    for (int i = 0; i < 3; i++) {
        s.rank[i] = zero;
        for (int j = 0; j < 3; j++)
            if (j != i) s.rank[i] += lanes_select(j < i ? e[j] >= e[i] : e[j] > e[i], one, zero);
    }
    for (int r = 0; r < 3; r++) {
        s.d[r] = zero;
        for (int i = 0; i < 3; i++) s.d[r] = lanes_select(s.rank[i] == (real)r, 2 * k[J2_MU] * (e[i] - mean), s.d[r]);
    }
    return s;
}

// f of the face of t_i and t_j without the mean stress.
BRUNT_INLINE lanes face(const real *k, const lanes d[3], int i, int j, lanes cohesion) {
    return (1 + k[FRICTION]) * d[i] - (1 - k[FRICTION]) * d[j] - cohesion;
}

// The multiplier, or the sum of two, with `excess` + `faces` 2 sin(phi) mean stress = stiffness x: the lesser of the
// roots of material that is closed and that is open at the end.
BRUNT_INLINE lanes multiplier(const real *k, const sorted_trial *s, lanes excess, real faces, real stiffness) {
    const real pressed = 2 * faces * k[FRICTION], closing = 2 * pressed * k[BULK] * k[DILATANCY];
    lanes closed = (excess + pressed * k[BULK] * s->volume) / (stiffness + closing);
    if (!(k[FRICTION] > 0 && k[TENSION] < (real)INFINITY)) return closed;
    return lanes_min(closed, (excess + pressed * k[TENSION]) / stiffness);
}

// What flows in descending order, at a given cohesion.
BRUNT_INLINE void flow_at(const real *k, const sorted_trial *s, lanes cohesion, lanes flow[3]) {
    const real f = k[FRICTION], g = k[DILATANCY], third = f * g / 3, mu = k[J2_MU];
    const lanes a = face(k, s->d, 0, 2, cohesion), right = face(k, s->d, 0, 1, cohesion),
                left = face(k, s->d, 1, 2, cohesion);
    const real alone = 4 * mu * (1 + third);
    lanes x = multiplier(k, s, a, 1, alone);
    flow[0] = (1 + g) * x, flow[1] = lanes_set(0), flow[2] = -(1 - g) * x;
    const lanes mean = (real)(2.0 / 3) * g * x;
    const lanes low = s->d[2] - 2 * mu * (flow[2] - mean), high = s->d[0] - 2 * mu * (flow[0] - mean),
                middle = s->d[1] + 2 * mu * mean;
    const lane_mask edge = (middle > high) | (middle < low);
    if (!lanes_any(edge)) return;
    const lane_mask to_right = (1 - g) * s->d[0] - 2 * s->d[1] + (1 + g) * s->d[2] > 0;
    const real of_right = 2 * mu * (1 + f + g - third), of_left = 2 * mu * (1 - f - g - third);
    lanes sum = lanes_select(to_right, multiplier(k, s, a + right, 2, alone + of_right),
                             multiplier(k, s, a + left, 2, alone + of_left));
    lanes apart = lanes_select(to_right, (a - right) / (alone - of_right), (a - left) / (alone - of_left));
    lanes first = (real)0.5 * (sum + apart), second = (real)0.5 * (sum - apart);
    flow[0] = lanes_select(edge, (1 + g) * lanes_select(to_right, sum, first), flow[0]);
    flow[1] = lanes_select(edge, lanes_select(to_right, -(1 - g) * second, (1 + g) * second), flow[1]);
    flow[2] = lanes_select(edge, -(1 - g) * lanes_select(to_right, first, sum), flow[2]);
}

BRUNT_INLINE lanes equivalent_strain(const lanes flow[3]) {
    const lanes mean = (flow[0] + flow[1] + flow[2]) * (real)(1.0 / 3);
    lanes square = lanes_set(0);
    for (int r = 0; r < 3; r++) square += (flow[r] - mean) * (flow[r] - mean);
    return lanes_sqrt((real)(2.0 / 3) * square);
}

// The cohesion at the end, where more of it means less flow: regula falsi in the Illinois form between that of the
// start and that of the flow which it leaves, at most that with which nothing flows, `beyond` the start: above it the
// faces would be drawn to the trial from within. Lanes stop one by one.
BRUNT_INLINE lanes hardened(const real *k, const sorted_trial *s, lanes start, lanes beyond, lane_mask active,
                            lanes flow[3]) {
    enum { STEPS = 60 };
    flow_at(k, s, start, flow);
    lanes low = start, below = -k[HARDENING] * equivalent_strain(flow), high = start + lanes_min(-below, beyond),
          c = low;
    flow_at(k, s, high, flow);
    lanes above = high - start - k[HARDENING] * equivalent_strain(flow);
    active &= below < 0;
    c = lanes_select(active, high, c);
    for (int step = 0; step < STEPS; step++) {
        active &= above > 4 * LANES_REAL_EPSILON * high;
        if (!lanes_any(active)) break;
        lanes next = (low * above - high * below) / (above - below);
        flow_at(k, s, next, flow);
        lanes rest = next - start - k[HARDENING] * equivalent_strain(flow);
        c = lanes_select(active, next, c);
        active &= lanes_abs(rest) > 4 * LANES_REAL_EPSILON * high;
        const lane_mask over = rest > 0;
        above = lanes_select(over, rest, (real)0.5 * above), below = lanes_select(over, (real)0.5 * below, rest);
        high = lanes_select(over, next, high), low = lanes_select(over, low, next);
    }
    return c;
}

// The point that the step's own displacement gradient H makes of B.
BRUNT_INLINE frictional_point point_at(int dim, const real *k, const lanes H[9], const lanes B[6], lanes strain) {
    frictional_point p = {.plastic_strain = strain};
    lanes pushed[6], own[6], flow[3];
    j2_push(dim, H, B, pushed);
    finger_strain(dim, H, own);
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++)
        if (dim == 3 || c != ZZ) pushed[c] += own[c];
    p.axes = principal_of(dim, pushed);
    for (int i = 0; i < 3; i++) p.e[i] = (real)0.5 * lanes_log1p(p.axes.strain[i]);
    const sorted_trial s = sort_trial(k, p.e);
    lanes cohesion = k[COHESION] + k[HARDENING] * strain, volume = s.volume;
    const lanes excess = face(k, s.d, 0, 2, cohesion);
    const lanes pressed = k[FRICTION] > 0 ? 2 * k[FRICTION] * mean_stress(k, volume) : lanes_set(0);
    p.plastic = excess + pressed > BRITTLE_ROUNDING * k[J2_MU];
    for (int i = 0; i < 3; i++) p.flow[i] = lanes_set(0);
    p.delta = lanes_set(0);
    if (lanes_any(p.plastic)) {
        if (k[HARDENING] > 0) cohesion = hardened(k, &s, cohesion, excess + pressed, p.plastic, flow);
        flow_at(k, &s, cohesion, flow);
        for (int i = 0; i < 3; i++)
            for (int r = 0; r < 3; r++)
                p.flow[i] = lanes_select(p.plastic & (s.rank[i] == (real)r), flow[r], p.flow[i]);
        p.delta = equivalent_strain(p.flow);
        volume -= p.flow[0] + p.flow[1] + p.flow[2];
    }
    for (int i = 0; i < 3; i++)
        p.tau[i] = 2 * k[J2_MU] * (p.e[i] - p.flow[i] - volume * (real)(1.0 / 3)) + mean_stress(k, volume);
    return p;
}

// --------------------------------------------------------------------------------- steps

BRUNT_INLINE lanes elastic_energy(const real *k, const lanes e[3]) {
    const lanes volume = e[0] + e[1] + e[2], mean = volume * (real)(1.0 / 3);
    lanes square = lanes_set(0);
    for (int i = 0; i < 3; i++) square += (e[i] - mean) * (e[i] - mean);
    return k[J2_MU] * square + opening_energy(k[BULK], k[TENSION], volume);
}

// What the stress t of B, at the start of the step, does over the flow D at its end, seen from the start: t : f^-1 D f,
// which no turn changes. With f b f^T = b_trial it is (t b) : f^T (b_trial^-1 D) f, of symmetric tensors.
BRUNT_INLINE lanes work_before(int dim, const real *k, const lanes H[9], const lanes B[6], const frictional_point *p) {
    const principal_axes axes = principal_of(dim, B);
    lanes e[3], value[3], before[6], flow[6], pulled[6], turned[9], volume = lanes_set(0), work = lanes_set(0);
    for (int i = 0; i < 3; i++) e[i] = (real)0.5 * lanes_log1p(axes.strain[i]), volume += e[i];
    for (int i = 0; i < 3; i++)
        value[i] = (1 + axes.strain[i]) * (2 * k[J2_MU] * (e[i] - volume * (real)(1.0 / 3)) + mean_stress(k, volume));
    principal_tensor(dim, &axes, value, before);
    for (int i = 0; i < 3; i++) value[i] = p->flow[i] / (1 + p->axes.strain[i]);
    principal_tensor(dim, &p->axes, value, flow);
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) turned[r * dim + c] = H[c * dim + r];
    j2_push(dim, turned, flow, pulled);
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) work += (real)(c < 3 ? 1 : 2) * (before[c] * pulled[c]);
    return work;
}

BRUNT_INLINE void load_strain(int dim, real *const *arrays, int32_t i, lanes B[6]) {
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) B[c] = lanes_load(arrays[c] + i);
}

// Writes stress and state; `work` of the step per reference volume.
BRUNT_INLINE void store(int dim, const brunt_material_points *points, int32_t i, const frictional_point *p,
                        const lanes tau[6], lanes work) {
    lanes value[3], B[6];
    for (int c = 0; c < 3; c++) value[c] = lanes_expm1(2 * (p->e[c] - p->flow[c]));
    principal_tensor(dim, &p->axes, value, B);
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) {
        lanes_store(points->stress[c] + i, tau[c]);
        lanes_store(points->state[c] + i, B[c]);
    }
    real *plastic_work = points->state[j2_slot(dim, PLASTIC_WORK)] + i;
    lanes_store(points->state[j2_slot(dim, PLASTIC_STRAIN)] + i, p->plastic_strain + p->delta);
    lanes_store(plastic_work, lanes_load(plastic_work) + work);
    if (points->plastic_increment) lanes_store(points->plastic_increment + i, work);
    if (points->strain_increment) lanes_store(points->strain_increment + i, p->delta);
}

BRUNT_INLINE brunt_update_result update_dim(int dim, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const lanes zero = lanes_set(0);
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9], B[6], tau[6], work = zero;
        load_displacement_gradient(dim, points, i, H);
        const lanes J = 1 + volume_change(dim, H);
        load_step_gradient(dim, points, i, H);
        load_strain(dim, points->state, i, B);
        const frictional_point p = point_at(dim, k, H, B, lanes_load(points->state[j2_slot(dim, PLASTIC_STRAIN)] + i));
        // b with an eigenvalue that is not positive: the step itself is inside out.
        lanes least = lanes_min(lanes_min(p.axes.strain[0], p.axes.strain[1]), p.axes.strain[2]);
        note_deformation(&record, lanes_select(least > -1, J, zero), i);
        principal_tensor(dim, &p.axes, p.tau, tau);
        if (lanes_any(p.plastic)) {
            work = work_before(dim, k, H, B, &p);
            for (int a = 0; a < 3; a++) work += p.tau[a] * p.flow[a];
            work = lanes_select(p.plastic, (real)0.5 * work, zero);
        }
        store(dim, points, i, &p, tau, work);
        // Along an axis of stress: rho0 c^2 = K + 4/3 mu - t, and what flow adds.
        lanes pressed = lanes_max(zero, -lanes_min(lanes_min(p.tau[0], p.tau[1]), p.tau[2]));
        pressed += lanes_select(p.plastic, lanes_set(k[STIFFENING]), zero);
        note_speed(&record, k[J2_INVERSE_DENSITY] * (k[BULK] + (real)(4.0 / 3) * k[J2_MU] + pressed));
    }
    return update_end(&record, points, NULL);
}

MATERIAL_UPDATE

BRUNT_INLINE void energy_dim(int dim, const real *k, const brunt_material_points *points, brunt_point_energy *energy) {
    lane_total stored = {0}, plastic = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes B[6], e[3];
        load_strain(dim, points->state, i, B);
        const principal_axes axes = principal_of(dim, B);
        for (int c = 0; c < 3; c++) e[c] = (real)0.5 * lanes_log1p(axes.strain[c]);
        const lanes volume = lanes_load(points->volume + i);
        total_add(&stored, volume * elastic_energy(k, e));
        total_add(&plastic, volume * lanes_load(points->state[j2_slot(dim, PLASTIC_WORK)] + i));
    }
    energy->internal += total_end(&stored);
    energy->plastic += total_end(&plastic);
}

MATERIAL_ENERGY

static real wave_speed(const real *constants) { return brittle_wave_speed(constants, constants[BULK]); }

const brunt_model brunt_mohr_coulomb = {
    .name = "mohr-coulomb",
    .doc = "soil, rock, granular material: strength by the greatest and least stress, dilatancy (Coulomb 1773)",
    .plastic = true,
    .parameters = parameters,
    .parameter_count = BRUNT_COUNT(parameters),
    .state = state,
    .state_count = BRUNT_COUNT(state),
    .prepare = prepare,
    .update = update,
    .energy = add_energy,
    .wave_speed = wave_speed,
    .no_potential = "'mohr-coulomb' has no potential for implicit steps: it does not flow along the normal of its "
                    "yield surface",
    .differences = true,
};
