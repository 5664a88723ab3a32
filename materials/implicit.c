// Materials in implicit steps: their components together.
#include <math.h>
#include <stdbool.h>

#include "base/simd_math.h"
#include "materials/prepared.h"
#include "materials/trial.h"

const char *brunt_material_implicit(const brunt_material *material) {
    if (material->model[BRUNT_VISCOSITY])
        return "bulk viscosity has no potential for implicit steps, which damp shocks by themselves: leave it out";
    if (material->model[BRUNT_FAILURE]) return "failure has no potential for implicit steps";
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        const brunt_model *model = material->model[k];
        if (!model) continue;
        if (material->membrane && !(model->potential && model->potential->respond_membrane))
            return model->potential ? "the model has no potential of membranes for implicit steps"
                                    : model->no_potential;
        const char *reason = brunt_model_no_potential(model, material->constants[k]);
        if (reason && !model->differences) return reason;
    }
    return NULL;
}

const char *brunt_model_no_potential(const brunt_model *model, const real *constants) {
    if (!model->potential) return model->no_potential;
    return model->potential->refuses ? model->potential->refuses(constants) : NULL;
}

void brunt_material_respond(const brunt_material *material, const brunt_trial_points trial[BRUNT_COMPONENTS]) {
    if (material->membrane) {
        const brunt_model_potential *strength = material->model[BRUNT_STRENGTH]->potential;
        strength->respond_membrane(material->constants[BRUNT_STRENGTH], material->tension_only, &trial[BRUNT_STRENGTH]);
        return;
    }
    if (material->differences) {
        brunt_material_respond_by_differences(material, trial);
        return;
    }
    for (int k = 0; k < BRUNT_COMPONENTS; k++)
        if (material->model[k]) material->model[k]->potential->respond(material->constants[k], &trial[k]);
}

brunt_update_result brunt_material_commit(const brunt_material *material,
                                          const brunt_trial_points trial[BRUNT_COMPONENTS],
                                          brunt_material_points points[BRUNT_COMPONENTS], real *plastic) {
    if (material->differences) return brunt_material_commit_by_differences(material, trial, points, plastic);
    const brunt_model *const *model = material->model;
    const bool dissipates = model[BRUNT_STRENGTH]->plastic || model[BRUNT_STRENGTH]->shear_viscous;
    brunt_update_result total = {.bad = -1};
    real speed[BRUNT_COMPONENTS] = {0};
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        if (!model[k]) continue;
        points[k].plastic_increment = model[BRUNT_EOS] && dissipates ? plastic : NULL;
        const brunt_model_potential *potential = model[k]->potential;
        brunt_update_result result = potential->commit
                                         ? potential->commit(material->constants[k], &trial[k], &points[k])
                                         : model[k]->update(material->constants[k], &points[k]);
        speed[k] = result.wave_speed;
        if (result.bad >= 0 && total.bad < 0) total.bad = result.bad, total.reason = result.reason;
    }
    total.wave_speed = brunt_wave_speed(speed[BRUNT_STRENGTH], speed[BRUNT_EOS], 0);
    return total;
}

// --------------------------------------------------------------------------------- projection

enum { ROW_LIMIT = 9, PROJECTION_SWEEPS = 16 };

// One rotation of Jacobi's method of A with the vectors V, rows, of lanes in `active`.
BRUNT_INLINE void rotate_pair(int rows, lanes A[ROW_LIMIT][ROW_LIMIT], lanes V[ROW_LIMIT][ROW_LIMIT], int p, int q,
                              lane_mask active) {
    const lane_mask turn = active & (A[p][q] != 0);
    if (!lanes_any(turn)) return;
    lanes half = (real)0.5 * (A[q][q] - A[p][p]), off = lanes_select(turn, A[p][q], lanes_set(1));
    lanes root = lanes_sqrt(half * half + off * off);
    lanes t = lanes_select(turn, off / (half + lanes_select(half < 0, -root, root)), lanes_set(0));
    lanes c = 1 / lanes_sqrt(1 + t * t), s = t * c, shift = t * A[p][q];
    A[p][p] -= shift, A[q][q] += shift;
    A[p][q] = A[q][p] = lanes_select(turn, lanes_set(0), A[p][q]);
    for (int k = 0; k < rows; k++) {
        lanes a = V[p][k], b = V[q][k];
        V[p][k] = c * a - s * b, V[q][k] = s * a + c * b;
        if (k == p || k == q) continue;
        a = A[k][p], b = A[k][q];
        A[k][p] = A[p][k] = c * a - s * b;
        A[k][q] = A[q][k] = s * a + c * b;
    }
}

// Adds -l v v^T of the negative eigenvalues l to the tangents at i. Lanes stop one by one.
BRUNT_INLINE void project_at(int dim, real *const tangent[BRUNT_TANGENT_LIMIT], int32_t i) {
    const int rows = dim * dim;
    lanes A[ROW_LIMIT][ROW_LIMIT], V[ROW_LIMIT][ROW_LIMIT];
    for (int r = 0; r < rows; r++)
        for (int c = 0; c < rows; c++) {
            V[r][c] = lanes_set(r == c ? 1 : 0);
            A[r][c] = lanes_load(tangent[tangent_place(dim, r < c ? r : c, r < c ? c : r)] + i);
        }
    for (int sweep = 0; sweep < PROJECTION_SWEEPS; sweep++) {
        lanes off = lanes_set(0), size = lanes_set(0);
        for (int r = 0; r < rows; r++) {
            size += A[r][r] * A[r][r];
            for (int c = r + 1; c < rows; c++) off += A[r][c] * A[r][c];
        }
        const lane_mask active = off > LANES_REAL_EPSILON * LANES_REAL_EPSILON * size;
        if (!lanes_any(active)) break;
        for (int p = 0; p < rows; p++)
            for (int q = p + 1; q < rows; q++) rotate_pair(rows, A, V, p, q, active);
    }
    for (int k = 0; k < rows; k++) {
        const lanes lift = lanes_max(-A[k][k], lanes_set(0));
        if (!lanes_any(lift > 0)) continue;
        for (int r = 0; r < rows; r++)
            for (int c = r; c < rows; c++) put(tangent[tangent_place(dim, r, c)] + i, lift * V[k][r] * V[k][c], true);
    }
}

void brunt_material_project(const brunt_material *material, const brunt_trial_points *trial) {
    if (material->differences) return;
    for (int32_t i = 0; i < trial->count; i += BRUNT_LANES) {
        if (trial->dim == 2)
            project_at(2, trial->tangent, i);
        else
            project_at(3, trial->tangent, i);
    }
}
