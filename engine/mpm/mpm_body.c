#include "mpm/mpm_body.h"

#include <math.h>

#include "base/simd.h"
#include "base/memory.h"
#include "mpm/sort.h"

void brunt_body_free(brunt_body *body) {
    brunt_sort_workspace_free(body->particles.sort_workspace);
    brunt_particles_free(&body->particles);
    brunt_grid_free(&body->grid);
    brunt_free(body->report);
    brunt_free(body->rank);
    *body = (brunt_body){0};
}

brunt_material_points brunt_body_points(brunt_body *body, brunt_component component, int64_t first, int32_t count) {
    brunt_particles *p = &body->particles;
    const int dim = p->point_dim;
    brunt_material_points points = {.count = count,
                                    .dim = dim,
                                    .cell = body->grid.h,
                                    .wave_speed = body->material.wave_speed,
                                    .may_reshape = true,
                                    .time = body->time};
    real **F = brunt_field(p, BRUNT_FIELD_deformation_gradient),
         **stress = brunt_field(p, BRUNT_FIELD_kirchhoff_stress);
    for (int c = 0; c < BRUNT_MATRIX(dim); c++) points.F[c] = F[c] + first;
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++) points.stress[c] = stress[c] + first;
    points.volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0] + first;
    const brunt_model *model = body->material.model[component];
    int at = 0;
    for (int s = 0; model && s < model->state_count; s++) {
        real **arrays = brunt_state_arrays(p, model, s);
        int components = dim == 3 ? model->state[s].components3 : model->state[s].components2;
        for (int c = 0; c < components; c++) points.state[at++] = arrays[c] + first;
    }
    return points;
}

brunt_point_energy brunt_body_energy(brunt_body *body, int32_t begin, int32_t end) {
    brunt_point_energy energy = {0};
    for (int32_t b = begin; b < end; b++) {
        const brunt_block *block = &body->grid.blocks[b];
        int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
        for (int k = 0; k < BRUNT_COMPONENTS; k++) {
            if (!body->material.model[k]) continue;
            brunt_material_points points = brunt_body_points(body, (brunt_component)k, block->first, padded);
            brunt_material_energy(&body->material, (brunt_component)k, &points, &energy);
        }
    }
    return energy;
}

void brunt_body_block_bounds(const brunt_body *body, int32_t b, double low[3], double high[3]) {
    const brunt_block *block = &body->grid.blocks[b];
    real *const *x = body->particles.scalar + body->particles.field[BRUNT_FIELD_position].first;
    for (int a = 0; a < body->particles.dim; a++) {
        low[a] = INFINITY, high[a] = -INFINITY;
        for (int64_t s = block->first; s < block->first + block->count; s++)
            low[a] = fmin(low[a], (double)x[a][s]), high[a] = fmax(high[a], (double)x[a][s]);
    }
}

double brunt_body_spread(brunt_body *body) {
    brunt_particles *p = &body->particles;
    double most = 0;
    for (int64_t s = 0; s < p->slots; s++) most = fmax(most, (double)brunt_plane_volume(p, s));
    return pow(most, 1.0 / p->dim) / (double)body->grid.h;
}
