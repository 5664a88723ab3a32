// Von Mises plasticity with isotropic hardening, finite strain (kinematics and return: j2.h):
//   Y = yield + hardening eps_p + (saturation_stress - yield) (1 - exp(-saturation_rate eps_p)),
// the last term (Voce) only when a saturation stress is given. Linear hardening returns in closed form.
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
    lanes decay = lanes_exp(-k[RATE] * plastic_strain);
    *slope = k[HARDENING] + k[RISE] * k[RATE] * decay;
    return k[YIELD] + k[HARDENING] * plastic_strain + k[RISE] * (1 - decay);
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
        j2_store(dim, k, points, i, &p, delta, q, &record);
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

const brunt_model brunt_von_mises = {
    .name = "von-mises",
    .doc = "J2 plasticity with isotropic hardening, finite strain (Simo 1988)",
    .plastic = true,
    .accepts_eos = true,
    .parameters = parameters,
    .parameter_count = COUNT_OF(parameters),
    .state = state,
    .state_count = COUNT_OF(state),
    .prepare = prepare,
    .flops = {140, 243},
    .update = update,
    .energy = j2_energy,
    .wave_speed = j2_wave_speed,
};
