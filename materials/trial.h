// What the potentials of models share: how a trial is read, and where density, stress and tangent go.
//
// The tangent is a(G, G) = d2/dt2 W((I + t G) F) at t = 0, as a matrix over pairs (component i, direction a) of the
// gradient G. What every model's is made of:
//   tr b's part      G b : G                       delta_ij b_ab
//   volume, U(J)     (U'' J^2 + U' J) (tr G)^2 - U' J tr(G G)
#pragma once

#include "materials/tensor.h"

// A trial's displacement gradient: F - I or f - I.
BRUNT_INLINE void load_trial_gradient(int dim, const real *const *F, int32_t i, lanes H[9]) {
    for (int k = 0; k < dim * dim; k++) H[k] = lanes_load(F[k] + i);
    for (int k = 0; k < dim; k++) H[k * (dim + 1)] -= 1;
}

// Place of row m, column n >= m among the components of a tangent.
BRUNT_INLINE int tangent_place(int dim, int m, int n) {
    const int rows = dim * dim;
    return m * (2 * rows - m - 1) / 2 + n;
}

// Where it goes: over what is there, or added to it.
BRUNT_INLINE void put(real *to, lanes value, bool add) { lanes_store(to, add ? lanes_load(to) + value : value); }

BRUNT_INLINE void put_density(const brunt_trial_points *trial, int32_t i, lanes J, lanes density, bool add) {
    put(trial->density + i, lanes_select(J > 0, density, lanes_set((real)INFINITY)), add);
}

// Symmetric tau, in the layout of symmetric tensors.
BRUNT_INLINE void put_stress(int dim, const brunt_trial_points *trial, int32_t i, const lanes tau[6]) {
    static const int place[3][3] = {{XX, XY, XZ}, {XY, YY, YZ}, {XZ, YZ, ZZ}};
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) lanes_store(trial->stress[r * dim + c] + i, tau[place[r][c]]);
}

// Adds a multiple of delta_ij m_ab, m symmetric, to a tangent.
BRUNT_INLINE void add_geometric(int dim, const lanes m[6], lanes a[45]) {
    static const int place[3][3] = {{XX, XY, XZ}, {XY, YY, YZ}, {XZ, YZ, ZZ}};
    for (int r = 0; r < dim; r++)
        for (int p = 0; p < dim; p++)
            for (int q = p; q < dim; q++) a[tangent_place(dim, r * dim + p, r * dim + q)] += m[place[p][q]];
}

// Adds `trace` (tr G)^2 + `square` tr(G G).
BRUNT_INLINE void add_volumetric(int dim, lanes trace, lanes square, lanes a[45]) {
    for (int r = 0; r < dim; r++) {
        for (int c = r; c < dim; c++) a[tangent_place(dim, r * (dim + 1), c * (dim + 1))] += trace;
        a[tangent_place(dim, r * (dim + 1), r * (dim + 1))] += square;
        for (int c = r + 1; c < dim; c++) a[tangent_place(dim, r * dim + c, c * dim + r)] += square;
    }
}

BRUNT_INLINE void clear_tangent(int dim, lanes a[45]) {
    for (int k = 0; k < BRUNT_TANGENT(dim); k++) a[k] = lanes_set(0);
}

BRUNT_INLINE void put_tangent(int dim, const brunt_trial_points *trial, int32_t i, const lanes a[45], bool add) {
    for (int k = 0; k < BRUNT_TANGENT(dim); k++) put(trial->tangent[k] + i, a[k], add);
}

// --------------------------------------------------------------------------------- equations of state

// What an energy U(J) gives: itself, J U' = -J p, and J^2 U''.
typedef struct volume_response {
    lanes density, first, second;
} volume_response;

typedef volume_response volume_response_fn(const real *constants, lanes change, lanes log_J);

// Adds an equation of state's share; `response` of J - 1 and ln J, inlined.
BRUNT_INLINE void volume_respond(int dim, volume_response_fn *response, const real *k,
                                 const brunt_trial_points *trial) {
    for (int32_t i = 0; i < trial->count; i += BRUNT_LANES) {
        lanes H[9];
        load_trial_gradient(dim, trial->F, i, H);
        const lanes change = volume_change(dim, H);
        const volume_response r = response(k, change, lanes_log1p(change));
        if (trial->density) put_density(trial, i, 1 + change, r.density, true);
        if (trial->stress[0])
            for (int c = 0; c < dim; c++) put(trial->stress[c * (dim + 1)] + i, r.first, true);
        if (!trial->tangent[0]) continue;
        lanes a[45];
        clear_tangent(dim, a);
        add_volumetric(dim, r.second + r.first, -r.first, a);
        put_tangent(dim, trial, i, a, true);
    }
}

// --------------------------------------------------------------------------------- by dimension

// A model's functions from its respond_dim and commit_dim, which take the dimension as a literal.
#define TRIAL_RESPOND                                                                                                  \
    static void respond(const real *constants, const brunt_trial_points *trial) {                                      \
        if (trial->dim == 2)                                                                                           \
            respond_dim(2, constants, trial);                                                                          \
        else                                                                                                           \
            respond_dim(3, constants, trial);                                                                          \
    }
#define TRIAL_COMMIT                                                                                                   \
    static brunt_update_result commit(const real *constants, const brunt_trial_points *trial,                          \
                                      const brunt_material_points *points) {                                           \
        return trial->dim == 2 ? commit_dim(2, constants, trial, points) : commit_dim(3, constants, trial, points);    \
    }
