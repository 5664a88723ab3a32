#include "body.h"

#include <math.h>

#include "lanes.h"
#include "memory.h"
#include "sort.h"

void brunt_body_free(brunt_body *body) {
    brunt_sort_room_free(body->particles.sort_room);
    brunt_particles_free(&body->particles);
    brunt_grid_free(&body->grid);
    brunt_free(body->report);
    *body = (brunt_body){0};
}

brunt_points brunt_body_points(brunt_body *body, brunt_component component, int64_t first, int32_t count) {
    brunt_particles *p = &body->particles;
    const int dim = p->dim;
    brunt_points points = {
        .count = count, .dim = dim, .cell = body->grid.h, .wave_speed = body->material.wave_speed, .may_reshape = true};
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

brunt_point_energy brunt_body_energy(brunt_body *body) {
    brunt_point_energy energy = {0};
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        const brunt_block *block = &body->grid.blocks[b];
        int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
        for (int k = 0; k < BRUNT_COMPONENTS; k++) {
            if (!body->material.model[k]) continue;
            brunt_points points = brunt_body_points(body, (brunt_component)k, block->first, padded);
            brunt_material_energy(&body->material, (brunt_component)k, &points, &energy);
        }
    }
    return energy;
}

double brunt_body_spread(brunt_body *body) {
    brunt_particles *p = &body->particles;
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    const real *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    double most = 0;
    for (int64_t s = 0; s < p->slots; s++) {
        double J = p->dim == 2 ? (double)(F[0][s] * F[3][s] - F[1][s] * F[2][s])
                               : (double)(F[0][s] * (F[4][s] * F[8][s] - F[5][s] * F[7][s]) -
                                          F[1][s] * (F[3][s] * F[8][s] - F[5][s] * F[6][s]) +
                                          F[2][s] * (F[3][s] * F[7][s] - F[4][s] * F[6][s]));
        most = fmax(most, J * (double)volume[s]);
    }
    return pow(most, 1.0 / p->dim) / (double)body->grid.h;
}
