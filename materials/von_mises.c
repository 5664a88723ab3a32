// Von Mises plasticity with isotropic hardening, finite strain (kinematics and return: j2.h):
//   Y = yield + hardening eps_p + (saturation_stress - yield) (1 - exp(-saturation_rate eps_p)),
// the last term (Voce) only when a saturation stress is given. Linear hardening returns in closed form.
#include "materials/principal.h"
#include "materials/return_mapping.h"

enum { YIELD = J2_CONSTANTS, HARDENING, RISE, RATE };

static const brunt_parameter parameters[] = {
    PARAMETER_E,
    PARAMETER_NU,
    {"yield", "Pa", NAN, 0, INFINITY, true, true, "initial yield stress in uniaxial tension"},
    {"hardening", "Pa", 0, 0, INFINITY, false, true, "linear hardening modulus: stress per plastic strain"},
    {"saturation_stress", "Pa", 0, 0, INFINITY, false, true, "yield stress exponential hardening tends to; 0: none"},
    {"saturation_rate", "1", 0, 0, INFINITY, false, true, "exponent of the exponential hardening"},
};
static const brunt_state_field state[] = {J2_STATE};

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    if (p[4] > 0 && p[4] < p[2]) return "saturation_stress is below yield";
    if (p[4] > 0 && !(p[5] > 0)) return "saturation_stress needs a saturation_rate";
    j2_prepare(p[0], p[1], density, with_eos, constants);
    constants[YIELD] = (real)p[2];
    constants[HARDENING] = (real)p[3];
    constants[RISE] = p[4] > 0 ? (real)(p[4] - p[2]) : 0;
    constants[RATE] = (real)p[5];
    return NULL;
}

BRUNT_INLINE lanes flow_stress(const real *k, lanes plastic_strain, lanes *slope) {
    const lanes risen = -lanes_expm1(-k[RATE] * plastic_strain); // with its digits where it is next to nothing yet
    *slope = k[HARDENING] + k[RISE] * k[RATE] * (1 - risen);
    return k[YIELD] + k[HARDENING] * plastic_strain + k[RISE] * risen;
}

BRUNT_INLINE brunt_update_result update_dim(int dim, bool saturates, bool softens, const real *k,
                                            const brunt_material_points *points) {
    update_record record = update_begin();
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        j2_point p = j2_trial(dim, k, points, i, &record);
        lanes zero = lanes_set(0), delta = zero, q = p.q, slope = lanes_set(k[HARDENING]);
        lanes yield = saturates ? flow_stress(k, p.plastic_strain, &slope) : k[YIELD] + k[HARDENING] * p.plastic_strain;
        const lanes integrity = j2_integrity(softens, points, i);
        if (softens) yield *= integrity, slope *= integrity;
        lane_mask plastic = p.q > yield;
        if (lanes_any(plastic)) {
            if (softens)
                j2_set_softened_stiffness(k, points, i, &p);
            else
                j2_set_stiffness(k, &p);
            if (saturates) {
                j2_root root = j2_root_begin(&p, plastic);
                lane_mask gone = {0};
                if (softens) gone = j2_root_collapse(&root, integrity);
                for (int step = 0; step < J2_ROOT_STEPS && lanes_any(root.active); step++) {
                    q = flow_stress(k, p.plastic_strain + root.delta, &slope);
                    if (softens) q *= integrity, slope *= integrity;
                    j2_root_step(&p, &root, q, slope);
                }
                note_first(&record.model, root.active, i);
                delta = lanes_select(plastic, root.delta, zero);
                q = lanes_select(plastic, q, p.q);
                if (softens) q = lanes_select(gone, zero, q);
            } else {
                delta = lanes_select(plastic, (p.q - yield) / (p.stiffness + slope), zero);
                q = yield + slope * delta;
            }
            j2_return(dim, &p, plastic, q);
        }
        j2_store(dim, k, points, i, &p, (j2_flow){delta, q}, &record);
    }
    return update_end(&record, points, "the plastic increment of the hardening law was not found");
}

BRUNT_INLINE brunt_update_result update_of(int dim, const real *k, const brunt_material_points *points) {
    const bool saturates = k[RISE] > 0;
    if (points->integrity)
        return saturates ? update_dim(dim, true, true, k, points) : update_dim(dim, false, true, k, points);
    return saturates ? update_dim(dim, true, false, k, points) : update_dim(dim, false, false, k, points);
}

static brunt_update_result update(const real *constants, const brunt_material_points *points) {
    return points->dim == 2 ? update_of(2, constants, points) : update_of(3, constants, points);
}

// --------------------------------------------------------------------------------- implicit steps

// The return above derives from no potential. Implicit steps have Hencky's form of the same law: with the logarithmic
// strains e = dev ln(b) / 2 of the elastic trial b = f b_old f^T,
//   W = U(J) + min over delta of [ mu |e|^2 (q / q_trial)^2 + int Y ],   q = q_trial - 3 mu delta,  q_trial = sqrt(6)
//   mu |e|
// (Ortiz and Stainier, CMAME 171 (1999) 419; de Souza Neto, Peric and Owen, Computational Methods for Plasticity
// (2008), chapter 14): the return is radial, tau = U' J I + 2 mu (q / q_trial) e, and as Y grows with plastic strain
// the minimum is one. U is the explicit model's. At small elastic strain both laws are one; their stress differs by the
// strain's second order.
typedef struct hencky_point {
    principal_axes axes;
    lanes volume_change, e[3], size; // J - 1; trial; |e|
    lanes delta, q, ratio;           // plastic increment; von Mises stress; q / q_trial
    lanes consistent;                // dq / dq_trial
    lanes plastic_strain;            // at the start
} hencky_point;

BRUNT_INLINE void hencky_strain(const principal_axes *axes, lanes e[3], lanes *size) {
    for (int a = 0; a < 3; a++) e[a] = (real)0.5 * lanes_log1p(axes->strain[a]);
    lanes mean = (e[0] + e[1] + e[2]) * (real)(1.0 / 3);
    for (int a = 0; a < 3; a++) e[a] -= mean;
    *size = lanes_sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
}

// The root of q_trial - 3 mu delta = Y: with Y concave the left side less the right is convex and falls, so that
// Newton's method comes up to the root from 0. Lanes stop one by one.
BRUNT_INLINE void hencky_return(const real *k, hencky_point *p, lanes q_trial) {
    enum { STEPS = 100 };
    const real stiff = 3 * k[J2_MU];
    lanes slope, flow = flow_stress(k, p->plastic_strain, &slope);
    const lane_mask plastic = q_trial > flow;
    lane_mask active = plastic;
    p->delta = lanes_set(0);
    for (int step = 0; step < STEPS && lanes_any(active); step++) {
        lanes change = (q_trial - stiff * p->delta - flow) / (stiff + slope);
        p->delta = lanes_select(active, p->delta + change, p->delta);
        active &= change > 4 * LANES_REAL_EPSILON * p->delta;
        flow = flow_stress(k, p->plastic_strain + p->delta, &slope);
    }
    p->q = lanes_select(plastic, q_trial - stiff * p->delta, q_trial);
    p->ratio = lanes_select(plastic, p->q / q_trial, lanes_set(1));
    p->consistent = lanes_select(plastic, slope / (stiff + slope), lanes_set(1));
}

BRUNT_INLINE hencky_point hencky_at(int dim, const real *k, const brunt_trial_points *trial, int32_t i) {
    hencky_point p;
    lanes H[9], b[6], pushed[6];
    load_trial_gradient(dim, trial->F, i, H);
    p.volume_change = volume_change(dim, H);
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) b[c] = lanes_load(trial->state[c] + i);
    load_trial_gradient(dim, trial->f, i, H);
    j2_push(dim, H, b, pushed);
    for (int c = 0; c < 3; c++) pushed[c] -= 1;
    p.axes = principal_of(dim, pushed);
    hencky_strain(&p.axes, p.e, &p.size);
    p.plastic_strain = lanes_load(trial->state[j2_slot(dim, J2_PLASTIC_STRAIN)] + i);
    hencky_return(k, &p, (real)sqrt(6) * k[J2_MU] * p.size);
    return p;
}

// int Y over the plastic increment.
BRUNT_INLINE lanes hencky_work(const real *k, const hencky_point *p) {
    lanes work = p->delta * (k[YIELD] + k[HARDENING] * (p->plastic_strain + (real)0.5 * p->delta));
    if (k[RISE] > 0) {
        lanes decay = lanes_exp(-k[RATE] * p->plastic_strain);
        work += k[RISE] * (p->delta + decay * lanes_expm1(-k[RATE] * p->delta) / k[RATE]);
    }
    return work;
}

BRUNT_INLINE lanes hencky_stored(const real *k, lanes volume_change, lanes size) {
    return k[J2_MU] * size * size +
           (real)0.5 * k[J2_KAPPA] * ((real)0.5 * volume_change * (2 + volume_change) - lanes_log1p(volume_change));
}

// dtau_i/de_j = 2 mu ratio (delta_ij - 1/3) + 2 mu (consistent - ratio) n_i n_j, n = e / |e|.
BRUNT_INLINE void hencky_moduli(const real *k, const hencky_point *p, principal_moduli *m) {
    const lanes along = 2 * k[J2_MU] * (p->consistent - p->ratio), across = 2 * k[J2_MU] * p->ratio;
    const lanes square = lanes_select(p->size > 0, p->size * p->size, lanes_set(1));
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            m->c[r][c] = across * (real)((r == c) - 1.0 / 3) + along * (p->e[r] * p->e[c] / square);
    for (int r = 0, pair = 0; r < 3; r++)
        for (int c = r + 1; c < 3; c++, pair++)
            m->slope[pair] = across * principal_slope(p->axes.strain[r], p->axes.strain[c], p->e[r], p->e[c]);
}

BRUNT_INLINE void respond_dim(int dim, const real *k, const brunt_trial_points *trial) {
    for (int32_t i = 0; i < trial->count; i += BRUNT_LANES) {
        const hencky_point p = hencky_at(dim, k, trial, i);
        const lanes J = 1 + p.volume_change;
        lanes pressure = (real)0.5 * k[J2_KAPPA] * p.volume_change * (2 + p.volume_change);
        if (trial->density) {
            lanes density = hencky_stored(k, p.volume_change, p.ratio * p.size) + hencky_work(k, &p);
            put_density(trial, i, J, density, false);
        }
        principal_moduli m;
        for (int c = 0; c < 3; c++) m.tau[c] = 2 * k[J2_MU] * p.ratio * p.e[c];
        if (trial->stress[0]) {
            lanes tau[6], value[3] = {m.tau[0] + pressure, m.tau[1] + pressure, m.tau[2] + pressure};
            principal_tensor(dim, &p.axes, value, tau);
            put_stress(dim, trial, i, tau);
        }
        if (!trial->tangent[0]) continue;
        lanes a[45];
        clear_tangent(dim, a);
        hencky_moduli(k, &p, &m);
        principal_tangent(dim, &p.axes, &m, a);
        // J U' = pressure, J^2 U'' = kappa (J^2 + 1) / 2
        add_volumetric(dim, k[J2_KAPPA] * J * J, -pressure, a);
        put_tangent(dim, trial, i, a, false);
    }
}

TRIAL_RESPOND

BRUNT_INLINE brunt_update_result commit_dim(int dim, const real *k, const brunt_trial_points *trial,
                                            const brunt_material_points *points) {
    update_record record = update_begin();
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        const hencky_point p = hencky_at(dim, k, trial, i);
        lanes value[3], tau[6], b[6], work = hencky_work(k, &p);
        lanes pressure = (real)0.5 * k[J2_KAPPA] * p.volume_change * (2 + p.volume_change);
        note_deformation(&record, 1 + p.volume_change, i);
        for (int c = 0; c < 3; c++) value[c] = lanes_expm1(2 * p.ratio * p.e[c]);
        principal_tensor(dim, &p.axes, value, b);
        for (int c = 0; c < 3; c++) value[c] = pressure + 2 * k[J2_MU] * p.ratio * p.e[c];
        principal_tensor(dim, &p.axes, value, tau);
        for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) {
            lanes_store(points->stress[c] + i, tau[c]);
            lanes_store(points->state[c] + i, c < 3 ? 1 + b[c] : b[c]);
        }
        real *plastic_work = points->state[j2_slot(dim, J2_PLASTIC_WORK)] + i;
        lanes_store(points->state[j2_slot(dim, J2_PLASTIC_STRAIN)] + i, p.plastic_strain + p.delta);
        lanes_store(plastic_work, lanes_load(plastic_work) + work);
        if (points->plastic_increment) lanes_store(points->plastic_increment + i, work);
        // Along n: rho0 c^2 = kappa (J^2 + 1)/2 + 4/3 mu, less what the stress is of both.
        lanes volumetric = k[J2_KAPPA] * (1 + p.volume_change * (1 + (real)0.5 * p.volume_change));
        note_speed(&record, k[J2_INVERSE_DENSITY] * (volumetric + (real)(4.0 / 3) * k[J2_MU]));
    }
    return update_end(&record, points, NULL);
}

TRIAL_COMMIT

BRUNT_INLINE void hencky_energy_dim(int dim, const real *k, const brunt_material_points *points,
                                    brunt_point_energy *energy) {
    lane_total stored = {0}, plastic = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9], b[6], e[3], size;
        for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) b[c] = lanes_load(points->state[c] + i) - (real)(c < 3);
        const principal_axes axes = principal_of(dim, b);
        hencky_strain(&axes, e, &size);
        load_displacement_gradient(dim, points, i, H);
        lanes volume = lanes_load(points->volume + i);
        total_add(&stored, volume * hencky_stored(k, volume_change(dim, H), size));
        total_add(&plastic, volume * lanes_load(points->state[j2_slot(dim, J2_PLASTIC_WORK)] + i));
    }
    energy->internal += total_end(&stored);
    energy->plastic += total_end(&plastic);
}

static void hencky_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    if (points->dim == 2)
        hencky_energy_dim(2, constants, points, energy);
    else
        hencky_energy_dim(3, constants, points, energy);
}

static const brunt_model_potential potential = {.respond = respond, .commit = commit, .energy = hencky_energy};

const brunt_model brunt_von_mises = {
    .name = "von-mises",
    .doc = "J2 plasticity with isotropic hardening, finite strain (Simo 1988)",
    .plastic = true,
    .accepts_eos = true,
    .parameters = parameters,
    .parameter_count = BRUNT_COUNT(parameters),
    .state = state,
    .state_count = BRUNT_COUNT(state),
    .prepare = prepare,
    .potential = &potential,
    .flops = {140, 243},
    .update = update,
    .energy = j2_energy,
    .wave_speed = j2_wave_speed,
};
