// Newtonian fluid: the shear stress of a viscous fluid whose pressure an equation of state gives (LS-DYNA's null
// material, Hallquist, LS-DYNA theory manual, material 9):
//   tau = 2 mu J dev D,  D = sym(L - dt/2 L L).
// D is the rate as seen from the middle of the step: L (I + dt/2 L)^-1 to second order. With sym L alone a rigid turn
// by the angle a in a step would be a rate of a^2 / 2 dt.
//
// The stress at the end of a step is that of the step's rate and acts until the next, so the work it does in a step is
//   dt/2 (tau_old : L + tau : (L - dt L L)),
// each stress with the rate as seen from its own configuration. tau_old is the deviator of the last step's whole
// stress, as all that the other components add is pressure: no state is needed for it. Where the flow turns back the
// work of a step may be negative; its sum is not, as tau_old : L >= -(|tau_old| |L_old| + |tau| |L|) / 2.
//
// Time step: of the grid's modes the fastest decays at nu_l lambda, with nu_l = 4/3 mu J / rho0 of longitudinal motion
// and lambda <= 8 / h^2 the largest eigenvalue of the discrete Laplacian. As a share 2 zeta omega of the frequency
// omega = 2 c / h that is Q = zeta c = 2 nu_l / h in the sense of brunt_wave_speed; without sound h / 2 Q = 3/16 rho
// h^2 / mu. Elements have lambda = 4 / h^2, so have splines inside a body; but at a free edge a node that feels
// quadratic kernels' ends alone has (dN/dx)^2 / N = 2 / h^2 of its own: 5.3 / h^2 with its neighbours, over all places
// of an edge and up to one particle a cell, along one axis, and less than half of that from each of the others. With Q
// for 4 / h^2 a lump of material points came apart at cfl 0.7.
#include "materials/principal.h"

enum { VISCOSITY, DIFFUSION }; // 2 nu_l
enum { VISCOUS_WORK };

static const brunt_parameter parameters[] = {
    {"dynamic_viscosity", "Pa s", 0, 0, INFINITY, false, true, "shear stress per rate of shear"},
};

static const brunt_state_field state[] = {{"viscous_work", "J/m^3", 1, 1, NULL}};

static const char *prepare(const double *p, double density, bool with_eos, real *constants) {
    (void)with_eos;
    constants[VISCOSITY] = (real)p[0];
    constants[DIFFUSION] = (real)(8 * p[0] / (3 * density));
    return NULL;
}

// det(I + h I) - 1
BRUNT_INLINE lanes isotropic_change(int dim, lanes h) { return dim == 3 ? h * (3 + h * (3 + h)) : h * (2 + h); }

// F = s I with det F = J. From a guess m, (1 + r)^(1/dim) by Halley's method, with 1 + r = J / m^dim; its error is
// r^3/40 or less. F_00 is the guess where it is close (a fluid's step deforms little), so that a fluid at rest keeps
// its bits and rounding does not lean to one side; else the root.
BRUNT_INLINE void reshape(int dim, const brunt_material_points *points, int32_t i, lanes change) {
    lanes J = 1 + change, m = lanes_load(points->F[0] + i);
    lane_mask good = (J > 0) & (J <= MATERIAL_REAL_MAX);
    lanes r = change - isotropic_change(dim, m - 1);
    lane_mask close = (m > 0) & (lanes_abs(r) <= (real)0.03 * J);
    if (lanes_any(~close)) {
        lanes root;
        if (dim == 3) {
            lanes inverse = lanes_inverse_cbrt(J);
            root = J * inverse * inverse;
        } else {
            root = lanes_sqrt(J);
        }
        m = lanes_select(close, m, root);
    }
    for (int k = 0; k < 2; k++) {
        r = (change - isotropic_change(dim, m - 1)) / (dim == 3 ? m * m * m : m * m);
        m += dim == 3 ? m * r / (3 + r) : 2 * m * r / (4 + r);
    }
    for (int c = 0; c < dim * dim; c++) {
        real *F = points->F[c] + i;
        lanes_store(F, lanes_select(good, c % (dim + 1) == 0 ? m : lanes_set(0), lanes_load(F)));
    }
}

// a and b = sym(a a), the first made symmetric; off the plane 0.
BRUNT_INLINE void rate_and_square(int dim, const brunt_material_points *points, int32_t i, lanes rate[6],
                                  lanes square[6]) {
    static const int row[6] = {0, 1, 2, 0, 1, 0}, column[6] = {0, 1, 2, 1, 2, 2};
    lanes L[3][3];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            L[r][c] = r < dim && c < dim ? lanes_load(points->L[r * dim + c] + i) : lanes_set(0);
    for (int k = 0; k < BRUNT_SYMMETRIC(dim); k++) {
        int r = row[k], c = column[k];
        rate[k] = (real)0.5 * (L[r][c] + L[c][r]);
        square[k] = lanes_set(0);
        for (int j = 0; j < dim; j++) square[k] += L[r][j] * L[j][c] + L[c][j] * L[j][r];
        square[k] *= (real)0.5;
    }
}

BRUNT_INLINE lanes double_contraction(int dim, const lanes a[6], const lanes b[6]) {
    lanes off = a[XY] * b[XY];
    if (dim == 3) off += a[YZ] * b[YZ] + a[XZ] * b[XZ];
    return (a[XX] * b[XX] + a[YY] * b[YY] + a[ZZ] * b[ZZ]) + 2 * off;
}

BRUNT_INLINE void take_mean(lanes a[6]) {
    lanes mean = (a[XX] + a[YY] + a[ZZ]) * (real)(1.0 / 3);
    for (int k = 0; k < 3; k++) a[k] -= mean;
}

BRUNT_INLINE brunt_update_result update_dim(int dim, bool viscous, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    lanes thinnest = lanes_set(0);
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        lanes change = volume_change(dim, H), J = 1 + change;
        note_deformation(&record, J, i);
        if (points->may_reshape) reshape(dim, points, i, change);
        if (!viscous) {
            for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) lanes_store(points->stress[c] + i, lanes_set(0));
            continue;
        }
        lanes rate[6], square[6], old[6], tau[6], end[6];
        rate_and_square(dim, points, i, rate, square);
        for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) {
            old[c] = lanes_load(points->stress[c] + i);
            tau[c] = rate[c] - (real)0.5 * points->dt * square[c];
            end[c] = rate[c] - points->dt * square[c];
        }
        take_mean(old), take_mean(tau);
        for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) {
            tau[c] *= 2 * k[VISCOSITY] * J;
            lanes_store(points->stress[c] + i, tau[c]);
        }
        lanes power = double_contraction(dim, old, rate) + double_contraction(dim, tau, end);
        lanes work = (real)0.5 * points->dt * power;
        real *sum = points->state[VISCOUS_WORK] + i;
        lanes_store(sum, lanes_load(sum) + work);
        if (points->plastic_increment) lanes_store(points->plastic_increment + i, work);
        thinnest = lanes_max(J, thinnest);
    }
    brunt_update_result result = update_end(&record, points, NULL);
    if (viscous) result.viscosity = k[DIFFUSION] * lanes_max_of(thinnest) / points->cell;
    return result;
}

static brunt_update_result update_inviscid(const real *constants, const brunt_material_points *points) {
    return points->dim == 2 ? update_dim(2, false, constants, points) : update_dim(3, false, constants, points);
}

static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    (void)constants;
    energy->viscosity += state_total(points, VISCOUS_WORK);
}

// --------------------------------------------------------------------------------- implicit steps

// The rate of an implicit step is that of its logarithmic strain, D = ln(f f^T) / 2 dt: a turn is none, however large,
// and to second order in the step it is the explicit one. The fluid's potential is that of Rayleigh,
//   dt mu J_old |dev D|^2 = (mu J_old / dt) |dev e|^2,   e_i = ln(x_i) / 2 of the eigenvalues x_i of f f^T,
// whose stress is 2 mu J_old dev D. The step dissipates twice as much: stress times strain.
//
// Newmark's rule wants half the stress of the rate at the start of the step and half that of the rate at its end. Rates
// at both ends are the mean one in the mean, D = (D_start + D_end) / 2, as displacements are of velocities: what acts
// over the step is the stress of the mean rate, which is second order and dissipates in every step. All of it acts at
// the end (brunt_trial_rule.start), where potentials are; that it does so where the flow has turned on by half a step
// is first order in that turn.
typedef struct viscous_step {
    principal_axes axes;
    lanes e[3], modulus; // [-]; mu J_old / dt [Pa]
} viscous_step;

// Of a displacement gradient of the step, f - I.
BRUNT_INLINE viscous_step viscous_step_of(int dim, lanes modulus, const lanes H[9]) {
    viscous_step s = {.modulus = modulus / (1 + volume_change(dim, H))};
    lanes B[6];
    B[ZZ] = lanes_set(0);
    finger_strain(dim, H, B);
    s.axes = principal_of(dim, B);
    for (int a = 0; a < 3; a++) s.e[a] = (real)0.5 * lanes_log1p(s.axes.strain[a]);
    lanes mean = (s.e[0] + s.e[1] + s.e[2]) * (real)(1.0 / 3);
    for (int a = 0; a < 3; a++) s.e[a] -= mean;
    return s;
}

BRUNT_INLINE viscous_step viscous_step_at(int dim, const real *k, const brunt_trial_points *trial, int32_t i) {
    lanes H[9];
    load_trial_gradient(dim, trial->F, i, H);
    const lanes modulus = k[VISCOSITY] / trial->dt * (1 + volume_change(dim, H));
    load_trial_gradient(dim, trial->f, i, H);
    return viscous_step_of(dim, modulus, H);
}

// Of the step; the potential is half of it.
BRUNT_INLINE lanes dissipation(const viscous_step *s) {
    return 2 * s->modulus * (s->e[0] * s->e[0] + s->e[1] * s->e[1] + s->e[2] * s->e[2]);
}

BRUNT_INLINE void respond_dim(int dim, const real *k, const brunt_trial_points *trial) {
    const bool records = trial->rule.part == BRUNT_TRIAL_ACCOUNT;
    for (int32_t i = 0; i < trial->count; i += BRUNT_LANES) {
        viscous_step s = viscous_step_at(dim, k, trial, i);
        principal_moduli m;
        if (trial->density && records) lanes_store(trial->density + i, dissipation(&s));
        s.modulus /= 1 - trial->rule.start;
        for (int a = 0; a < 3; a++) m.tau[a] = 2 * s.modulus * s.e[a];
        if (trial->density && !records) lanes_store(trial->density + i, (real)0.5 * dissipation(&s));
        if (trial->stress[0]) {
            lanes tau[6];
            principal_tensor(dim, &s.axes, m.tau, tau);
            put_stress(dim, trial, i, tau);
        }
        if (!trial->tangent[0]) continue;
        lanes a[45];
        clear_tangent(dim, a);
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++) m.c[r][c] = 2 * s.modulus * (real)((r == c) - 1.0 / 3);
        for (int r = 0, pair = 0; r < 3; r++)
            for (int c = r + 1; c < 3; c++, pair++)
                m.slope[pair] = 2 * s.modulus * principal_slope(s.axes.strain[r], s.axes.strain[c], s.e[r], s.e[c]);
        principal_tangent(dim, &s.axes, &m, a);
        put_tangent(dim, trial, i, a, false);
    }
}

TRIAL_RESPOND

static void respond_inviscid(const real *constants, const brunt_trial_points *trial) {
    const size_t bytes = (size_t)trial->count * sizeof(real);
    (void)constants;
    if (trial->density) memset(trial->density, 0, bytes);
    for (int c = 0; c < BRUNT_MATRIX(trial->dim) && trial->stress[0]; c++) memset(trial->stress[c], 0, bytes);
    for (int c = 0; c < BRUNT_TANGENT(trial->dim) && trial->tangent[0]; c++) memset(trial->tangent[c], 0, bytes);
}

// The step is taken: its stress, and what it dissipates.
BRUNT_INLINE void take_step(int dim, const viscous_step *s, const brunt_material_points *points, int32_t i,
                            lanes change) {
    lanes tau[6], value[3];
    const lanes work = dissipation(s);
    for (int a = 0; a < 3; a++) value[a] = 2 * s->modulus * s->e[a];
    principal_tensor(dim, &s->axes, value, tau);
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) lanes_store(points->stress[c] + i, tau[c]);
    real *sum = points->state[VISCOUS_WORK] + i;
    lanes_store(sum, lanes_load(sum) + work);
    if (points->plastic_increment) lanes_store(points->plastic_increment + i, work);
    if (points->may_reshape) reshape(dim, points, i, change);
}

BRUNT_INLINE brunt_update_result commit_dim(int dim, const real *k, const brunt_trial_points *trial,
                                            const brunt_material_points *points) {
    update_record record = update_begin();
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        const viscous_step s = viscous_step_at(dim, k, trial, i);
        load_trial_gradient(dim, trial->F, i, H);
        const lanes change = volume_change(dim, H);
        note_deformation(&record, 1 + change, i);
        take_step(dim, &s, points, i, change);
    }
    return update_end(&record, points, NULL);
}

TRIAL_COMMIT

// The same from f - I = L dt, beside an equation of state that has no potential.
BRUNT_INLINE brunt_update_result finite_dim(int dim, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9];
        load_displacement_gradient(dim, points, i, H);
        const lanes change = volume_change(dim, H), modulus = k[VISCOSITY] / points->dt * (1 + change);
        for (int c = 0; c < dim * dim; c++) H[c] = points->dt * lanes_load(points->L[c] + i);
        const viscous_step s = viscous_step_of(dim, modulus, H);
        note_deformation(&record, 1 + change, i);
        take_step(dim, &s, points, i, change);
    }
    return update_end(&record, points, NULL);
}

static brunt_update_result update(const real *constants, const brunt_material_points *points) {
    if (points->finite) return points->dim == 2 ? finite_dim(2, constants, points) : finite_dim(3, constants, points);
    return points->dim == 2 ? update_dim(2, true, constants, points) : update_dim(3, true, constants, points);
}

static const brunt_model_potential viscous_potentials = {.respond = respond, .commit = commit};
static const brunt_model_potential inviscid_potentials = {.respond = respond_inviscid};

#define NEWTONIAN                                                                                                      \
    .name = "newtonian",                                                                                               \
    .doc =                                                                                                             \
        "fluid of constant viscosity, which carries no other shear stress; an equation of state gives its pressure",   \
    .fluid = true, .needs_eos = true, .accepts_eos = true, .parameters = parameters,                                   \
    .parameter_count = BRUNT_COUNT(parameters), .prepare = prepare, .wave_speed = no_wave_speed

static const brunt_model inviscid = {NEWTONIAN, .flops = {8, 30}, .update = update_inviscid,
                                     .potential = &inviscid_potentials};

static const brunt_model *reduced(const double *p) { return p[0] > 0 ? NULL : &inviscid; }

const brunt_model brunt_newtonian = {
    NEWTONIAN,        .shear_viscous = true, .state = state,     .state_count = BRUNT_COUNT(state), .flops = {96, 188},
    .update = update, .energy = add_energy,  .reduced = reduced, .potential = &viscous_potentials,
};
