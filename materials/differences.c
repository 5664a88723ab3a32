// Materials without a potential in implicit steps: the stress at the end of a step is that of the models' own `update`,
// all components together, and the tangent is made of central differences of it. With tau(G) of (I + G) F,
//   a_ia,kb = dtau_ia/dG_kb - delta_ak tau_ib
// (trial.h), of which nothing is symmetric in general: flow that is not along the normal of the yield surface, heat
// that presses. A difference of 2 h = 2.4e-7 is known to some 1e-8 of the moduli: rounding of the strain over h, and
// (h over the strain at yield) squared.
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "materials/prepared.h"
#include "materials/tensor.h"

enum { POINT_LIMIT = 64 };
#define STEADY 1e30     // [s] a step without time: no rate
#define DIFFERENCE 0.02 // of the cube root of the rounding of 1

// A range's own copies of what an update writes, as its models see them.
typedef struct difference_step {
    const brunt_material *material;
    const brunt_trial_points *trial; // of each component
    brunt_material_points points[BRUNT_COMPONENTS];
    real F[9][POINT_LIMIT], L[9][POINT_LIMIT], stress[6][POINT_LIMIT], volume[POINT_LIMIT];
    real state[BRUNT_COMPONENTS][BRUNT_MAX_STATE][POINT_LIMIT];
    real plastic[POINT_LIMIT], viscous[POINT_LIMIT];
} __attribute__((aligned(64))) difference_step;

static int states_of(const brunt_model *model, int dim) {
    int count = 0;
    for (int s = 0; s < model->state_count; s++)
        count += dim == 3 ? model->state[s].components3 : model->state[s].components2;
    return count;
}

static real step_time(const brunt_trial_points *trial) { return isfinite(trial->dt) ? trial->dt : (real)STEADY; }

static void begin(difference_step *s, const brunt_material *material, const brunt_trial_points *trial) {
    s->material = material, s->trial = trial;
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        brunt_material_points *points = &s->points[k];
        *points = (brunt_material_points){.count = trial->count,
                                          .dim = trial->dim,
                                          .dt = step_time(trial),
                                          .finite = true,
                                          .cell = 1,
                                          .volume = s->volume};
        for (int c = 0; c < trial->dim * trial->dim; c++) points->F[c] = s->F[c], points->L[c] = s->L[c];
        for (int c = 0; c < BRUNT_SYMMETRIC(trial->dim); c++) points->stress[c] = s->stress[c];
        for (int c = 0; c < BRUNT_MAX_STATE; c++) points->state[c] = s->state[k][c];
    }
    for (int32_t i = 0; i < trial->count; i++) s->volume[i] = trial->volume ? trial->volume[i] : 1;
}

static void take_states(difference_step *s) {
    for (int m = 0; m < BRUNT_COMPONENTS; m++)
        for (int c = 0; s->material->model[m] && c < states_of(s->material->model[m], s->trial->dim); c++)
            memcpy(s->state[m][c], s->trial[m].state[c], (size_t)s->trial->count * sizeof(real));
}

// Whether f is I but for rounding.
static bool is_still(const brunt_trial_points *trial) {
    real most = 0;
    for (int c = 0; c < trial->dim * trial->dim; c++)
        for (int32_t q = 0; q < trial->count; q++)
            most = (real)fmax((double)most, fabs((double)trial->f[c][q] - (c % (trial->dim + 1) == 0)));
    return most <= 64 * LANES_REAL_EPSILON;
}

// What a viscous fluid has beside pressure, as the integrator wants it.
static void weigh_viscous_stress(difference_step *s) {
    const real more = 1 / (1 - s->trial->rule.start) - 1;
    if (more == 0 || !s->material->model[BRUNT_STRENGTH]->shear_viscous) return;
    for (int32_t q = 0; q < s->trial->count; q++) {
        const real mean = (s->stress[XX][q] + s->stress[YY][q] + s->stress[ZZ][q]) / 3;
        for (int c = 0; c < BRUNT_SYMMETRIC(s->trial->dim); c++)
            s->stress[c][q] += more * (s->stress[c][q] - (c < 3 ? mean : 0));
    }
}

// The step of (I + h e_k (x) e_b) f from the start; h = 0: that of the trial.
static brunt_update_result step(difference_step *s, int k, int b, real h) {
    const brunt_trial_points *trial = s->trial;
    const int dim = trial->dim;
    const size_t bytes = (size_t)trial->count * sizeof(real);
    const real over = 1 / step_time(trial);
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) {
            const int c = i * dim + j, from = b * dim + j;
            const real share = i == k ? h : 0, unit = i == j;
            for (int32_t q = 0; q < trial->count; q++) {
                s->F[c][q] = trial->F[c][q] + share * trial->F[from][q];
                s->L[c][q] = ((trial->f[c][q] - unit) + share * trial->f[from][q]) * over;
            }
        }
    take_states(s);
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) {
        if (trial->old_stress[c])
            memcpy(s->stress[c], trial->old_stress[c], bytes);
        else
            memset(s->stress[c], 0, bytes);
    }
    const brunt_update_result result = brunt_material_update(s->material, s->points, s->plastic, s->viscous, NULL);
    weigh_viscous_stress(s);
    return result;
}

static const int place[3][3] = {{XX, XY, XZ}, {XY, YY, YZ}, {XZ, YZ, ZZ}};

// Energies of whole vectors, spread over their points.
static void put_energies(difference_step *s, const brunt_update_result *result) {
    const brunt_trial_points *trial = s->trial;
    for (int32_t first = 0; first < trial->count; first += BRUNT_LANES) {
        brunt_point_energy energy = {0};
        double volume = 0;
        for (int m = 0; m < BRUNT_COMPONENTS; m++) {
            brunt_material_points part = s->points[m];
            part.count = BRUNT_LANES, part.volume += first;
            for (int c = 0; c < 9; c++) part.F[c] += part.F[c] ? first : 0, part.L[c] += part.L[c] ? first : 0;
            for (int c = 0; c < 6; c++) part.stress[c] += part.stress[c] ? first : 0;
            for (int c = 0; c < BRUNT_MAX_STATE; c++) part.state[c] += first;
            brunt_material_energy(s->material, (brunt_component)m, &part, &energy);
        }
        for (int32_t i = first; i < first + BRUNT_LANES; i++) volume += (double)s->volume[i];
        const double mean = volume > 0 ? (energy.internal + energy.plastic + energy.viscosity) / volume : 0;
        for (int32_t i = first; i < first + BRUNT_LANES; i++)
            trial->density[i] = result->bad >= 0 ? (real)INFINITY : (real)mean;
    }
}

// dtau/dG_kb less what turns tau to the first stress of Piola and Kirchhoff; `tau` of the trial.
static void put_column(difference_step *s, const real tau[6][POINT_LIMIT], int k, int b) {
    const brunt_trial_points *trial = s->trial;
    const int dim = trial->dim, rows = dim * dim;
    const real h = (real)(DIFFERENCE * cbrt((double)LANES_REAL_EPSILON)), over = 1 / (2 * h);
    real ahead[6][POINT_LIMIT];
    step(s, k, b, h);
    memcpy(ahead, s->stress, sizeof ahead);
    step(s, k, b, -h);
    for (int i = 0; i < dim; i++)
        for (int a = 0; a < dim; a++) {
            real *to = trial->tangent[(i * dim + a) * rows + k * dim + b];
            const int c = place[i][a];
            for (int32_t q = 0; q < trial->count; q++)
                to[q] = (ahead[c][q] - s->stress[c][q]) * over - (a == k ? tau[place[i][b]][q] : 0);
        }
}

void brunt_material_respond_by_differences(const brunt_material *material,
                                           const brunt_trial_points trial[BRUNT_COMPONENTS]) {
    const int dim = trial->dim;
    difference_step s;
    BRUNT_ASSERT(trial->count <= POINT_LIMIT);
    begin(&s, material, trial);
    const brunt_update_result result = step(&s, 0, 0, 0);
    if (trial->density) {
        if (is_still(trial)) take_states(&s); // energies of the start: what creeps has not yet
        put_energies(&s, &result);
    }
    // What carries more at the rate of the last step would creep at none, and leave a part of each step without its
    // stress.
    const bool held = trial->rule.part == BRUNT_TRIAL_START && material->model[BRUNT_STRENGTH]->rate_dependent;
    for (int c = 0; c < BRUNT_SYMMETRIC(dim) && held && trial->old_stress[c]; c++)
        memcpy(s.stress[c], trial->old_stress[c], (size_t)trial->count * sizeof(real));
    for (int i = 0; i < dim && trial->stress[0]; i++)
        for (int a = 0; a < dim; a++)
            for (int32_t q = 0; q < trial->count; q++)
                trial->stress[i * dim + a][q] = q == result.bad ? (real)NAN : s.stress[place[i][a]][q];
    if (!trial->tangent[0]) return;
    real tau[6][POINT_LIMIT];
    memcpy(tau, s.stress, sizeof tau);
    for (int k = 0; k < dim; k++)
        for (int b = 0; b < dim; b++) put_column(&s, (const real(*)[POINT_LIMIT])tau, k, b);
}

brunt_update_result brunt_material_commit_by_differences(const brunt_material *material,
                                                         const brunt_trial_points trial[BRUNT_COMPONENTS],
                                                         brunt_material_points points[BRUNT_COMPONENTS],
                                                         real *plastic) {
    const int dim = trial->dim;
    real L[9][POINT_LIMIT], viscous[POINT_LIMIT];
    BRUNT_ASSERT(trial->count <= POINT_LIMIT);
    for (int c = 0; c < dim * dim; c++)
        for (int32_t q = 0; q < trial->count; q++)
            L[c][q] = (trial->f[c][q] - (real)(c % (dim + 1) == 0)) / step_time(trial);
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        points[k].dt = step_time(trial), points[k].finite = true;
        for (int c = 0; c < dim * dim; c++) points[k].L[c] = L[c];
    }
    return brunt_material_update(material, points, plastic, viscous, NULL);
}
