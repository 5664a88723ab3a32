// Labels: verification
// Fluids: equations of state and viscosity against closed forms, point by point; then as material points: the energy of
// a gas let into vacuum and of a swinging drop, a column under its weight, the flow between two walls.
#include "tests/support/def_world.h"

#include "base/simd.h"
#include "materials/prepared.h"

// ------------------------------------------------------------------------------------------ points

// One vector of points, all alike, of a fluid with its equation of state, as the engine has them.
enum { SCALARS = 8 };
typedef struct drop {
    brunt_material material;
    brunt_material_points points[BRUNT_COMPONENTS];
    brunt_update_result last;
    real F[9][BRUNT_LANES], L[9][BRUNT_LANES], stress[6][BRUNT_LANES], volume[BRUNT_LANES];
    real state[BRUNT_COMPONENTS][SCALARS][BRUNT_LANES], plastic[BRUNT_LANES], viscous[BRUNT_LANES];
    double dt;
} drop;

static brunt_material_def fluid(double density, double viscosity, const char *eos) {
    brunt_error error;
    brunt_material_def def = brunt_material_def_default("fluid", "newtonian");
    def.density = density;
    ck_assert_int_eq(brunt_material_set(&def, "dynamic_viscosity", viscosity, NULL, &error), BRUNT_OK);
    ck_assert_int_eq(brunt_material_set(&def, "eos", 0, eos, &error), BRUNT_OK);
    return def;
}
static void set(brunt_material_def *def, const char *key, double value) {
    brunt_error error = {0};
    ck_assert_msg(brunt_material_set(def, key, value, NULL, &error) == BRUNT_OK, "%s", error.message);
}
static brunt_material_def gas(double gamma, double energy, double viscosity) {
    brunt_material_def def = fluid(1, viscosity, "ideal-gas");
    set(&def, "eos.gamma", gamma);
    set(&def, "eos.initial_energy", energy);
    return def;
}
static brunt_material_def liquid(double density, double c0, double gamma, double viscosity) {
    brunt_material_def def = fluid(density, viscosity, "tait");
    set(&def, "eos.c0", c0);
    set(&def, "eos.gamma", gamma);
    return def;
}

static void drop_begin(drop *d, const brunt_material_def *def, int dim, double dt) {
    brunt_error error = {0};
    memset(d, 0, sizeof *d);
    ck_assert_msg(brunt_material_make(def, &d->material, &error) == BRUNT_OK, "%s", error.message);
    d->dt = dt;
    for (int l = 0; l < BRUNT_LANES; l++) {
        d->volume[l] = 1;
        for (int c = 0; c < dim; c++) d->F[c * (dim + 1)][l] = 1;
        for (int c = 0; c < 3; c++) d->stress[c][l] = d->material.rest_stress;
    }
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        brunt_material_points *p = &d->points[k];
        *p = (brunt_material_points){.count = BRUNT_LANES, .dim = dim, .dt = (real)dt, .cell = 1, .may_reshape = true};
        p->wave_speed = d->material.wave_speed;
        p->volume = d->volume;
        for (int c = 0; c < 9; c++) p->F[c] = d->F[c], p->L[c] = d->L[c];
        for (int c = 0; c < 6; c++) p->stress[c] = d->stress[c];
        const brunt_model *model = d->material.model[k];
        for (int s = 0; model && s < model->state_count; s++) { // of fluids all state is one scalar each
            p->state[s] = d->state[k][s];
            real start = model->state[s].initial ? model->state[s].initial(d->material.constants[k], 0) : 0;
            for (int l = 0; l < BRUNT_LANES; l++) d->state[k][s][l] = start;
        }
    }
}

// A step of displacement gradient H = dt L.
static brunt_update_result drop_try(drop *d, const double H[9]) {
    const int dim = d->points[0].dim;
    real F[9];
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) {
            double sum = (double)d->F[r * dim + c][0];
            for (int k = 0; k < dim; k++) sum += H[3 * r + k] * (double)d->F[k * dim + c][0];
            F[r * dim + c] = (real)sum;
        }
    for (int l = 0; l < BRUNT_LANES; l++)
        for (int r = 0; r < dim; r++)
            for (int c = 0; c < dim; c++) {
                d->F[r * dim + c][l] = F[r * dim + c];
                d->L[r * dim + c][l] = (real)(H[3 * r + c] / d->dt);
            }
    return d->last = brunt_material_update(&d->material, d->points, d->plastic, d->viscous, NULL);
}
static void drop_step(drop *d, const double H[9]) {
    brunt_update_result result = drop_try(d, H);
    ck_assert_msg(result.bad < 0, "%s", result.reason);
}
// The same change of every length.
static void drop_scale(drop *d, double factor) {
    const double h = factor - 1;
    drop_step(d, (const double[9]){h, 0, 0, 0, h, 0, 0, 0, h});
}
static double drop_J(const drop *d) {
    const int dim = d->points[0].dim;
    double F[9];
    for (int c = 0; c < dim * dim; c++) F[c] = (double)d->F[c][0];
    if (dim == 2) return F[0] * F[3] - F[1] * F[2];
    return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
}
static double drop_pressure(const drop *d) { // Cauchy
    return -((double)d->stress[0][0] + (double)d->stress[1][0] + (double)d->stress[2][0]) / (3 * drop_J(d));
}
static brunt_point_energy drop_energy(drop *d) { // [J/m^3]
    brunt_point_energy energy = {0};
    for (int k = 0; k < BRUNT_COMPONENTS; k++)
        brunt_material_energy(&d->material, (brunt_component)k, &d->points[k], &energy);
    energy.internal /= BRUNT_LANES, energy.plastic /= BRUNT_LANES, energy.viscosity /= BRUNT_LANES;
    return energy;
}

// ------------------------------------------------------------------------------------------ ideal gas

// p J^gamma = const without viscosity, in steps of any size. Internal energy is p J / (gamma - 1), sound sqrt(gamma p /
// rho).
static double isentrope_error(int dim, double volume, int steps) {
    const double gamma = 1.4;
    brunt_material_def def = gas(gamma, 25, 0);
    drop d;
    drop_begin(&d, &def, dim, 1e-3);
    ck_assert_double_eq_tol(drop_pressure(&d), 10, TOLERANCE(1e-14, 1e-6) * 10);
    for (int k = 0; k < steps; k++) drop_scale(&d, pow(volume, 1.0 / (dim * steps)));
    double J = drop_J(&d), p = drop_pressure(&d);
    ck_assert_double_eq_tol(J, volume, TOLERANCE(1e-12, 1e-4) * volume);
    ck_assert_double_eq_tol(drop_energy(&d).internal, p * J / (gamma - 1), TOLERANCE(1e-12, 2e-4) * p * J);
    ck_assert_double_eq_tol((double)d.last.wave_speed, sqrt(gamma * p * J),
                            TOLERANCE(1e-12, 1e-4) * sqrt(gamma * p * J));
    return fabs(p * pow(J, gamma) / 10 - 1);
}

START_TEST(isentropic_gas) {
    const double volumes[] = {0.05, 20};
    for (int k = 0; k < 2; k++) {
        double once = isentrope_error(2 + k, volumes[k], 1), often = isentrope_error(2 + k, volumes[k], 800);
        printf("  gas to %g of its volume: p J^gamma off by %.1e in one step, %.1e in 800\n", volumes[k], once, often);
        ck_assert_double_le(once, TOLERANCE(1e-14, 1e-5));
        ck_assert_double_le(often, TOLERANCE(1e-12, 1e-3));
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ liquids

// p = B (J^-gamma - 1) and c^2 = dp/drho, with the digits of a change of volume of 1e-9; U = -int p dJ.
START_TEST(tait_liquid) {
    const double gammas[] = {7, 1, 7.15, 1.0001}, volumes[] = {0.05, 0.5, 0.99, 1 - 1e-9, 1 + 1e-9, 1.01, 2, 20};
    for (int g = 0; g < 4; g++)
        for (int v = 0; v < 8; v++) {
            const double gamma = gammas[g], B = 1000 * 1500.0 * 1500 / gamma, J = volumes[v], log_J = log1p(J - 1);
            brunt_material_def def = liquid(1000, 1500, gamma, 0);
            drop d;
            drop_begin(&d, &def, 3, 1e-3);
            ck_assert_int_eq(d.material.model[BRUNT_STRENGTH]->state_count + d.material.model[BRUNT_EOS]->state_count,
                             0);
            drop_step(&d, (const double[9]){J - 1});
            double p = B * expm1(-gamma * log_J), c = 1500 * fmax(1, exp(0.5 * (1 - gamma) * log_J));
            // One bit of J is worth rho c^2 / J of pressure.
            double scale =
                fabs(p) + TOLERANCE(2.3e-16, 1.2e-7) / TOLERANCE(1e-12, 1e-5) * 1000 * c * c * fmax(1, 1 / J);
            ck_assert_double_eq_tol(drop_pressure(&d), p, TOLERANCE(1e-12, 1e-5) * scale * fmax(1, gamma));
            ck_assert_double_eq_tol((double)d.last.wave_speed, c, TOLERANCE(1e-12, 2e-5) * c);
            double U = 0, x = log_J; // Gauss-Legendre, three points on each of 2000 parts of ln J
            for (int k = 0; k < 2000; k++)
                for (int q = -1; q <= 1; q++) {
                    double y = x * (k + 0.5 + 0.5 * q * sqrt(0.6)) / 2000;
                    U -= B * expm1(-gamma * y) * exp(y) * x / 2000 * (q ? 5.0 : 8.0) / 18;
                }
            ck_assert_double_eq_tol(drop_energy(&d).internal, U,
                                    TOLERANCE(1e-9, 1e-3) * U + fabs(p) * TOLERANCE(2.3e-16, 1.2e-7));
            ck_assert_double_ge(drop_energy(&d).internal, 0);
        }
}
END_TEST

// With `tension` the pressure stays at -tension beyond it, and energy goes on with that; 0: none at all. It closes
// where it tore, and has kept no energy.
START_TEST(liquids_cavitate) {
    const double tensions[] = {0, 2e6}, rho_c2 = 1000 * 1647.0 * 1647;
    for (int model = 0; model < 2; model++)
        for (int t = 0; t < 2; t++) {
            brunt_material_def def = fluid(1000, 0, model ? "tait" : "mie-gruneisen");
            set(&def, "eos.c0", 1647);
            if (!model) set(&def, "eos.s", 1.921), set(&def, "eos.gamma0", 0.1);
            set(&def, "eos.tension", tensions[t]);
            drop d;
            drop_begin(&d, &def, 3, 1e-6);
            double work = 0, pressure = 0, low = INFINITY, scale = 0;
            for (int k = 0; k < 2000; k++) {
                double J = drop_J(&d);
                drop_scale(&d, 1 + (k < 1000 ? 1e-4 : -1e-4));
                double p = drop_pressure(&d);
                work -= 0.5 * (p + pressure) * (drop_J(&d) - J);
                scale = fmax(scale, fabs(work));
                pressure = p;
                low = fmin(low, p);
                ck_assert_double_ge((double)d.last.wave_speed, 1640);
                if (p <= -tensions[t])
                    ck_assert_double_ge((double)d.last.wave_speed, 1647 * (1 - TOLERANCE(1e-9, 1e-6)));
                // Nothing heats it: its energy is that work.
                if (!model)
                    ck_assert(fabs((double)(d.state[BRUNT_EOS][0][0] - d.state[BRUNT_EOS][1][0])) <=
                              TOLERANCE(1e-9, 1e-3) * (scale + 1));
                ck_assert_double_eq_tol(drop_energy(&d).internal, work,
                                        TOLERANCE(2e-3, 2e-2) * scale + 0.25 * rho_c2 * 3e-4 * 3e-4);
            }
            ck_assert_double_eq_tol(low, -tensions[t], TOLERANCE(1e-12, 1e-5) * tensions[t] + 1e-30);
            // What the step in which it closes leaves: its square, of strain.
            ck_assert_double_le(fabs(drop_energy(&d).internal), 0.25 * rho_c2 * 3e-4 * 3e-4);
            // Under pressure the law is as without.
            brunt_material_def whole = def;
            set(&whole, "eos.tension", INFINITY);
            drop e;
            drop_begin(&d, &def, 3, 1e-6), drop_begin(&e, &whole, 3, 1e-6);
            for (int k = 0; k < 100; k++) drop_scale(&d, 0.999), drop_scale(&e, 0.999);
            ck_assert(drop_pressure(&d) > 1e8 && drop_pressure(&d) == drop_pressure(&e));
            // Without a limit it would bear any.
            drop_begin(&e, &whole, 3, 1e-6);
            for (int k = 0; k < 100; k++) drop_scale(&e, 1.001);
            ck_assert_double_lt(drop_pressure(&e), -1e8);
        }
}
END_TEST

// Volumes from 1/20 to 20 and back, of every equation of state, with and without viscosity and bulk viscosity: finite,
// energies not negative, and the step follows the sound.
START_TEST(extreme_volumes) {
    for (int kind = 0; kind < 6; kind++) {
        brunt_material_def def = kind % 2 ? gas(1.4, 25, kind > 2) : liquid(1000, 100, 7, kind > 2 ? 1 : 0);
        brunt_error error;
        if (kind > 3) brunt_material_set(&def, "viscosity", 0, NULL, &error);
        drop d;
        drop_begin(&d, &def, 3, 1e-3);
        const double start = drop_energy(&d).internal, rest = (double)d.material.wave_speed;
        double most = 0;
        enum { STEPS = 400 };
        const double shrink = pow(0.05, 1.0 / STEPS), grow = pow(400, 1.0 / STEPS), back = pow(0.05, 1.0 / STEPS);
        for (int k = 0; k < 3 * STEPS; k++) {
            double f = k < STEPS ? shrink : k < 2 * STEPS ? grow : back;
            drop_step(&d, (const double[9]){f - 1}); // one axis: shear and volume
            brunt_point_energy e = drop_energy(&d);
            most = fmax(most, (double)d.last.wave_speed);
            ck_assert(isfinite(e.internal) && isfinite(e.viscosity) && isfinite((double)d.last.wave_speed));
            ck_assert(e.internal + e.viscosity >= 0 && e.viscosity >= 0 && d.last.wave_speed > 0);
            if (kind % 2) ck_assert_double_gt((double)d.state[BRUNT_EOS][0][0], 0);
        }
        ck_assert_double_eq_tol(drop_J(&d), 1, TOLERANCE(1e-11, 1e-3));
        ck_assert_double_gt(most, 1.5 * rest);
        if (kind < 2) ck_assert_double_eq_tol(drop_energy(&d).internal, start, 1e-4 * fmax(start, most * most * 1000));
    }
}
END_TEST

// A gas that is left without energy is reported: here by a bulk viscosity whose heat is taken out again.
START_TEST(gas_without_energy_is_reported) {
    brunt_material_def def = gas(5.0 / 3, 25, 0);
    brunt_error error;
    brunt_material_set(&def, "viscosity", 0, NULL, &error);
    drop d;
    drop_begin(&d, &def, 3, 1);
    drop_scale(&d, 0.5);
    for (int l = 0; l < BRUNT_LANES; l++) d.state[BRUNT_VISCOSITY][1][l] = 1e4; // [Pa] of the last step
    brunt_update_result result = drop_try(&d, (const double[9]){0.5});
    ck_assert_int_eq(result.bad, 0);
    ck_assert_ptr_nonnull(strstr(result.reason, "gas"));
}
END_TEST

// ------------------------------------------------------------------------------------------ viscosity

// Simple shear of a gas that was compressed before: Cauchy stress mu g, dissipation mu g^2 t per deformed volume (the
// first step's stress is a ramp from 0), all of it heat in the gas. F keeps the volume alone: isotropic, and J its
// digits after a shear of 1e3.
START_TEST(simple_shear) {
    const double mu = 3, rate = 100, dt = 1e-4, steps = 1e5;
    for (int dim = 2; dim <= 3; dim++) {
        brunt_material_def def = gas(1.4, 25, mu);
        drop d;
        drop_begin(&d, &def, dim, dt);
        drop_scale(&d, 0.9);
        const double J = pow(0.9, dim), before = drop_energy(&d).viscosity, stored = drop_energy(&d).internal;
        const double start = (double)d.state[BRUNT_EOS][0][0], H[9] = {0, rate * dt};
        for (int k = 0; k < steps; k++) drop_step(&d, H);
        ck_assert_double_eq_tol((double)d.stress[3][0], mu * rate * J, TOLERANCE(1e-11, 1e-2) * mu * rate);
        for (int r = 0; r < dim; r++)
            for (int c = 0; c < dim; c++)
                ck_assert(r == c ? d.F[r * dim + c][0] == d.F[0][0] : d.F[r * dim + c][0] == 0);
        ck_assert_double_eq_tol(drop_J(&d), J, TOLERANCE(1e-11, 1e-2));
        brunt_point_energy e = drop_energy(&d);
        double expect = mu * rate * rate * J * dt * (steps - 0.5);
        ck_assert_double_eq_tol(e.viscosity - before, expect, TOLERANCE(1e-9, 2e-2) * expect);
        ck_assert_double_eq_tol(e.internal, stored, TOLERANCE(1e-9, 1) * stored);
        ck_assert_double_eq_tol((double)d.state[BRUNT_EOS][0][0], start + expect, TOLERANCE(1e-9, 2e-2) * expect);
        ck_assert_double_eq_tol(drop_pressure(&d) * J, 0.4 * (start + expect), TOLERANCE(1e-9, 2e-2) * expect);
        double Q = 8 * mu * J / 3; // 8/3 mu / (rho h)
        ck_assert_double_eq_tol((double)d.last.wave_speed, Q + sqrt(Q * Q + 1.4 * 0.4 * (start + expect)),
                                TOLERANCE(1e-9, 1e-2) * sqrt(expect));
        // At rest afterwards it keeps its bits.
        real kept = d.F[0][0];
        for (int k = 0; k < 1000; k++) drop_step(&d, (const double[9]){0});
        ck_assert(d.F[0][0] == kept && d.stress[3][0] == 0);
    }
}
END_TEST

// Any step that keeps the volume: J in its place to rounding, however the points are sheared and turned.
START_TEST(reshaping_keeps_volume) {
    for (int dim = 2; dim <= 3; dim++) {
        brunt_material_def def = liquid(1000, 100, 7, 0);
        drop d;
        drop_begin(&d, &def, dim, 1e-3);
        drop_scale(&d, 0.7);
        const double start = drop_J(&d);
        for (int k = 0; k < 30000; k++) {
            const double size = k % 10 ? 0.02 : 1.5; // now and then far off, as no flow would
            double a = size * sin(1.3 * k), H[9] = {0};
            H[3 * (k % dim) + (k + 1) % dim] = a;
            drop_step(&d, H);
        }
        ck_assert_double_eq_tol(drop_J(&d), start, TOLERANCE(1e-12, 1e-3) * start);
        // A quarter turn at once, F_00 = 0.
        drop_step(&d, (const double[9]){-1, -1, 0, 1, -1, 0, 0, 0, 0});
        ck_assert_double_eq_tol(drop_J(&d), start, TOLERANCE(1e-12, 1e-3) * start);
    }
}
END_TEST

// A rigid turn of 0.02 a step is no rate of strain: sym L alone would say 2e-4 / dt.
START_TEST(turning_is_no_flow) {
    const double a = 0.02, dt = 1e-3, mu = 5, shear = 0.02 / 1e-3 * 5;
    for (int dim = 2; dim <= 3; dim++) {
        brunt_material_def def = liquid(1000, 100, 7, mu);
        drop d;
        drop_begin(&d, &def, dim, dt);
        for (int k = 0; k < 100; k++) drop_step(&d, (const double[9]){cos(a) - 1, -sin(a), 0, sin(a), cos(a) - 1});
        for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++)
            ck_assert_double_le(fabs((double)d.stress[c][0] + (c < 3 ? drop_pressure(&d) * drop_J(&d) : 0)),
                                TOLERANCE(1e-5, 1e-1) * shear);
        ck_assert_double_le(fabs(drop_energy(&d).viscosity), 1e-5 * 100 * dt * shear * shear / mu);
    }
}
END_TEST

// Flow to and fro: the work of a step may be negative, its sum is not.
START_TEST(dissipation_is_not_negative) {
    brunt_material_def def = liquid(1000, 100, 7, 2);
    drop d;
    drop_begin(&d, &def, 3, 1e-3);
    for (int k = 0; k < 2000; k++) {
        double a = 1e-3 * sin(k < 1000 ? 2.9 * k : 0.1 * k);
        drop_step(&d, (const double[9]){a, 2 * a, 0, 0, -a, a, 0, 0, 0});
        ck_assert_double_ge(drop_energy(&d).viscosity, 0);
    }
    ck_assert_double_gt(drop_energy(&d).viscosity, 0);
}
END_TEST

// What cannot be: a fluid without pressure; and what does not cost anything: viscosity that is not there.
START_TEST(what_is_wanted) {
    brunt_error error = {0};
    brunt_material material;
    brunt_material_def def = brunt_material_def_default("fluid", "newtonian");
    def.density = 1000;
    ck_assert_int_eq(brunt_material_make(&def, &material, &error), BRUNT_BAD_INPUT);
    ck_assert_ptr_nonnull(strstr(error.message, "equation of state"));
    def = liquid(1000, 100, 7, 0);
    ck_assert_int_eq(brunt_material_make(&def, &material, &error), BRUNT_OK);
    ck_assert_int_eq(material.model[BRUNT_STRENGTH]->state_count, 0);
    ck_assert_str_eq(material.model[BRUNT_STRENGTH]->name, "newtonian");
    ck_assert(material.rest_stress == 0);
    def = liquid(1000, 100, 7, 1e-3);
    ck_assert_int_eq(brunt_material_make(&def, &material, &error), BRUNT_OK);
    ck_assert_int_eq(material.model[BRUNT_STRENGTH]->state_count, 1);
    set(&def, "dynamic_viscosity", -1);
    ck_assert_int_eq(brunt_material_make(&def, &material, &error), BRUNT_BAD_INPUT);
    def = gas(1, 25, 0);
    ck_assert_int_eq(brunt_material_make(&def, &material, &error), BRUNT_BAD_INPUT);
    def = gas(1.4, 0, 0);
    ck_assert_int_eq(brunt_material_make(&def, &material, &error), BRUNT_BAD_INPUT);
}
END_TEST

// ------------------------------------------------------------------------------------------ as material points

static void take_fluid(brunt_world_def *def, brunt_material_def fluid_def) {
    def->materials[def->material_count++] = fluid_def;
}

// A cube of gas let into vacuum. The particles in front grow by a tenth in a step: what the ledger is off by is of the
// third order in the step (with cfl 0.5 eight times as much).
START_TEST(gas_into_vacuum) {
    brunt_world_def def = def_begin(2 + _i, 0.1);
    def.cfl = 0.25;
    take_fluid(&def, gas(1.4, 25, _i ? 0 : 0.1));
    def_box(&def, "gas", XYZ(-0.3, -0.3, -0.3), XYZ(0.3, 0.3, 0.3));
    brunt_world *world = world_take(&def);
    const brunt_energy start = world_energy(world);
    ck_assert_double_eq_tol(start.internal, 25 * (_i ? 0.216 : 0.36), TOLERANCE(1e-12, 1e-5) * 9);
    double *pressure = world_field(world, 0, "pressure");
    ck_assert_double_eq_tol(pressure[0], 10, TOLERANCE(1e-12, 1e-5) * 10);
    free(pressure);
    world_until(world, 0.05);
    brunt_energy e = world_energy(world);
    double *J = world_field(world, 0, "J"), most = 0;
    for (int64_t k = 0; k < brunt_world_particles(world); k++) most = fmax(most, J[k]);
    free(J);
    printf("  gas into vacuum, %dD: volume up to %.1f, error %.1e, kinetic %.2f, viscosity %.4f, transfer %.4f of %.2f "
           "J\n",
           2 + _i, most, e.error_relative, e.kinetic, e.viscosity, e.transfer, start.internal);
    ck_assert_double_gt(most, 4);
    ck_assert_double_le(fabs(e.error_relative), 1e-3);
    ck_assert_double_gt(e.kinetic, 0.15 * start.internal);
    ck_assert_double_gt(e.internal, 0);
    ck_assert_double_le(fabs(e.transfer), 0.15 * start.internal); // APIC smooths the rush of single particles
    ck_assert_double_le(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// A round drop of liquid, drawn out by v = A (y, x) at the start, becomes an ellipse with p = 0 on its surface:
// semiaxes a, b along the diagonals with a' = A a, b' = -A b, A' = -A^2 (a^2 - b^2) / (a^2 + b^2) (Monaghan, J. Comput.
// Phys. 110 (1994) 399, section 5.1, incompressible). With sound twenty times the fastest flow.
static double drop_axis(double radius, double rate, double end) {
    double a = radius, A = rate;
    enum { STEPS = 20000 };
    for (int k = 0; k < STEPS; k++) { // midpoint rule
        double h = end / STEPS, q = pow(radius / a, 4), am = a + 0.5 * h * A * a,
               Am = A - 0.5 * h * A * A * (1 - q) / (1 + q);
        q = pow(radius / am, 4);
        a += h * Am * am, A -= h * Am * Am * (1 - q) / (1 + q);
    }
    return a;
}

START_TEST(drop_is_drawn_out) {
    const double radius = 1, rate = 1, far = 1e-6, end = 0.8;
    brunt_world_def def = def_begin(2, 0.1);
    take_fluid(&def, liquid(1000, 20, 7, 0));
    brunt_body_def *body = def_ball(&def, "drop", XYZ(0, 0, 0), radius);
    body->wave_velocity[0] = 2 * rate / far, body->wave_vector[1] = far; // 2 A y along x, and turned back by A
    body->spin[2] = rate;
    brunt_world *world = world_take(&def);
    int64_t n = brunt_world_particles(world);
    const double kinetic = world_energy(world).kinetic;
    world_until(world, end);
    brunt_energy e = world_energy(world);
    double *F = world_field(world, 0, "deformation_gradient");
    for (int64_t k = 0; k < n; k++) ck_assert(F[9 * k + 1] == 0 && F[9 * k + 3] == 0 && F[9 * k] == F[9 * k + 4]);
    free(F);
    // From the moment of inertia along the diagonal: a^2 / 4 of an ellipse, a^2 / 4 of the disc at the start.
    double *x = world_field(world, 0, "position"), along = 0, across = 0;
    for (int64_t k = 0; k < n; k++) {
        double u = (x[3 * k] + x[3 * k + 1]) / sqrt(2), v = (x[3 * k] - x[3 * k + 1]) / sqrt(2);
        along += 4 * u * u / (double)n, across += 4 * v * v / (double)n;
    }
    free(x);
    const double a = drop_axis(radius, rate, end);
    printf("  drop: semiaxes %.4f %.4f, exact %.4f %.4f; error %.1e, transfer %.1e, of kinetic\n", sqrt(along),
           sqrt(across), a, 1 / a, e.error_relative, e.transfer / kinetic);
    ck_assert_double_gt(a, 1.5);
    ck_assert_double_eq_tol(sqrt(along), a, 0.02 * a);
    ck_assert_double_eq_tol(sqrt(across), 1 / a, 0.03 / a);
    ck_assert_double_le(fabs(e.error_relative), 5e-4);
    ck_assert_double_le(fabs(e.transfer), 0.03 * kinetic);
    ck_assert_double_le(world_momentum(world).angular_drift, 1e3 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// B24. A column between slippery walls that comes to rest under its weight: hydrostatic pressure, and the height that
// the compression of a linear liquid leaves.
START_TEST(hydrostatic_column) {
    const double height = 1, h = 0.05, c = 40, g = 9.81, rho = 1000;
    brunt_world_def def = def_begin(2, h);
    take_fluid(&def, liquid(rho, c, 7, 50));
    def_box(&def, "water", XYZ(0, 0, 0), XYZ(4 * h, height, 0));
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SLIP, 0);
    def_plane(&def, XYZ(4 * h, 0, 0), XYZ(-1, 0, 0), BRUNT_SLIP, 0);
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SLIP, 0);
    def.gravity[1] = -g;
    def.gravity_ramp = 0.6; // six times what sound takes down and up twice
    brunt_world *world = world_take(&def);
    world_until(world, 1);
    double *x = world_field(world, 0, "position"), *p = world_field(world, 0, "pressure"), worst = 0, bottom = 0;
    int64_t n = brunt_world_particles(world), low = 0;
    for (int64_t k = 0; k < n; k++) {
        double y = x[3 * k + 1], expect = rho * g * (height - y);
        if (y < height - 3 * h) worst = fmax(worst, fabs(p[k] - expect));
        if (y < h) bottom += p[k] + rho * g * y, low++;
    }
    free(x), free(p);
    brunt_energy e = world_energy(world);
    printf("  column: pressure off by %.2g of that at the bottom, there by %.2g; error %.1e\n", worst / (rho * g),
           bottom / (double)low / (rho * g) - 1, e.error_relative);
    ck_assert_double_eq_tol(bottom / (double)low, rho * g, 0.01 * rho * g);
    ck_assert_double_le(worst, 0.03 * rho * g);
    ck_assert_double_eq_tol(world_boundary(world, 2).force[1], 4 * h * rho * g * height, 0.02 * 4 * h * rho * g);
    ck_assert_double_le(fabs(e.error_relative), 2e-3);
    brunt_world_destroy(world);
}
END_TEST

// Between two walls that it sticks to, far from its free ends. Couette: u = U (y/H - sum 2/(n pi) exp(-n^2 pi^2 nu t /
// H^2) sin(n pi (1 - y/H))) from rest; Poiseuille under a body force g: the steady u = g y (H - y) / 2 nu less the
// modes that die out.
static double channel_speed(bool driven, double y, double time) {
    double u = driven ? 0.5 * y * (1 - y) : y;
    for (int n = 1; n < 60; n++) {
        double decay = exp(-n * n * PI * PI * time);
        u -= driven ? (n % 2 ? 4 / pow(n * PI, 3) * decay * sin(n * PI * y) : 0)
                    : 2 / (n * PI) * decay * sin(n * PI * (1 - y));
    }
    return u;
}

START_TEST(channel_flow) {
    const bool driven = _i;
    const double h = 0.0625, half = 2, c = 60,
                 speed = 0.01; // H = nu = rho = 1; eight cells are 6 % off, by what APIC smooths
    brunt_world_def def = def_begin(2, h);
    take_fluid(&def, liquid(1, c, 7, 1));
    def_box(&def, "oil", XYZ(-half, 0, 0), XYZ(half, 1, 0));
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_STICK, 0);
    brunt_plane_def *lid = def_plane(&def, XYZ(0, 1, 0), XYZ(0, -1, 0), BRUNT_STICK, 0);
    if (driven)
        def.gravity[0] = speed;
    else
        lid->velocity[0] = speed;
    brunt_world *world = world_take(&def);
    const double times[] = {0.1, 1};
    for (int t = 0; t < 2; t++) {
        world_until(world, times[t]);
        double *x = world_field(world, 0, "position"), *v = world_field(world, 0, "velocity"), worst = 0, fastest = 0;
        for (int64_t k = 0; k < brunt_world_particles(world); k++) {
            if (fabs(x[3 * k]) > 0.5) continue;
            double u = speed * channel_speed(driven, x[3 * k + 1], times[t]);
            worst = fmax(worst, fabs(v[3 * k] - u));
            fastest = fmax(fastest, u);
        }
        free(x), free(v);
        printf("  %s, t = %.1f H^2/nu: off by %.2g of the fastest\n", driven ? "Poiseuille" : "Couette", times[t],
               worst / fastest);
        ck_assert_double_le(worst, 0.02 * fastest);
    }
    brunt_energy e = world_energy(world);
    ck_assert_double_gt(e.viscosity, 0);
    printf("  error %.1e, viscosity %.3g, work %.3g J\n", e.error_relative, e.viscosity, e.external_work);
    ck_assert_double_le(fabs(e.error_relative), TOLERANCE(1e-9, 1e-2));
    brunt_world_destroy(world);
}
END_TEST

// What comes to the surface of a fluid was inside it: about a particle there is half its spacing of material, where a
// solid's inner particles fill the lattice up to its diagonals.
START_TEST(reach_of_fluids) {
    for (int solid = 0; solid < 2; solid++) {
        brunt_world_def def = def_begin(2, 0.1);
        if (solid)
            def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        else
            take_fluid(&def, liquid(1000, 20, 7, 0));
        def_ball(&def, "ball", XYZ(0, 0.6, 0), 0.5);
        def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
        brunt_world *world = world_take(&def);
        double most = 0;
        for (int32_t b = 0; b < brunt_state_count(world); b++) {
            brunt_state_block block = brunt_state_info(world, b);
            if (strcmp(block.name, "bodies/ball/reach") != 0) continue;
            real *reach = malloc((size_t)block.count * sizeof *reach);
            brunt_state_get(world, b, reach);
            for (int64_t k = 0; k < block.count; k++) most = fmax(most, (double)reach[k]);
            free(reach);
        }
        ck_assert_double_eq_tol(most, solid ? 0.025 * sqrt(2) : 0.025, TOLERANCE(1e-12, 1e-6));
        brunt_world_destroy(world);
    }
}
END_TEST

// A very viscous lump full of the shortest waves, at the whole stable step and without any loss in the transfers: its
// motion only dies out.
static const struct {
    int dim;
    brunt_kernel kernel;
} lumps[] = {{2, BRUNT_LINEAR}, {2, BRUNT_QUADRATIC}, {2, BRUNT_CUBIC}, {3, BRUNT_QUADRATIC}};

START_TEST(viscous_step_is_stable) {
    brunt_world_def def = def_begin(lumps[_i].dim, 0.1);
    def.kernel = lumps[_i].kernel;
    def.transfer = BRUNT_FLIP, def.flip = 1, def.cfl = 1;
    take_fluid(&def, liquid(1000, 1, 7, 1e5)); // nu / h = 1000 c
    brunt_body_def *lump = def_box(&def, "lump", XYZ(-0.43, -0.4, -0.4), XYZ(0.4, 0.37, 0.4));
    lump->wave_velocity[0] = 1e-3, lump->wave_velocity[1] = 2e-3;
    lump->wave_vector[0] = 31, lump->wave_vector[1] = 29, lump->wave_vector[2] = 27; // two cells long
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    double start = 0, last = 0;
    int status = BRUNT_OK;
    for (int k = 0; k < 400 && !status; k++) {
        status = brunt_world_step(world, INFINITY, &error);
        last = world_energy(world).kinetic;
        if (k == 1) start = last;
    }
    printf("  viscous lump, %dD kernel %d: kinetic energy %.2e of the start, dt %.3g h^2/nu\n", lumps[_i].dim,
           (int)lumps[_i].kernel, last / start, brunt_world_dt(world) * 100 / 0.01);
    ck_assert_msg(!status, "%s", error.message);
    ck_assert_double_le(last, start);
    ck_assert_double_eq_tol(brunt_world_dt(world), 3.0 / 16 * 0.01 / 100, 0.05 * 0.01 / 100);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("fluids");
    TCase *points = tcase_create("points");
    tcase_add_test(points, isentropic_gas);
    tcase_add_test(points, tait_liquid);
    tcase_add_test(points, liquids_cavitate);
    tcase_add_test(points, extreme_volumes);
    tcase_add_test(points, gas_without_energy_is_reported);
    tcase_add_test(points, simple_shear);
    tcase_add_test(points, reshaping_keeps_volume);
    tcase_add_test(points, turning_is_no_flow);
    tcase_add_test(points, dissipation_is_not_negative);
    tcase_add_test(points, what_is_wanted);
    suite_add_tcase(suite, points);
    TCase *worlds = tcase_create("material points");
    tcase_add_loop_test(worlds, gas_into_vacuum, 0, 2);
    tcase_add_test(worlds, reach_of_fluids);
    tcase_add_test(worlds, drop_is_drawn_out);
    tcase_add_test(worlds, hydrostatic_column);
    tcase_add_loop_test(worlds, channel_flow, 0, 2);
    tcase_add_loop_test(worlds, viscous_step_is_stable, 0, 4);
    suite_add_tcase(suite, worlds);
    return suite_main(suite) ? EXIT_FAILURE : EXIT_SUCCESS;
}
