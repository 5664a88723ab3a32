#include "base/array.h"
#include "base/memory.h"
#include "base/simd.h"
#include "mpm/transfer.h"

int brunt_workspace_fit(brunt_workspace *work, const brunt_grid *grid, int32_t most, int outs, brunt_error *error) {
    int64_t stride = (most + 2 * BRUNT_LANES + 7) / 8 * 8 + 72; // 9 cache lines apart, see brunt_particles_reserve
    int n = grid->order + 1, arrays = outs + 3;
    int64_t window = ((int64_t)grid->span_nodes + 1) * 8;
    int64_t planes = (int64_t)n * (grid->dim == 3 ? 16 * n * n : 8 * n) * 8;
    size_t reals = (size_t)(window + planes + arrays * stride + 64);
    if (work->memory && work->capacity / sizeof(real) >= reals && work->stride >= stride) return BRUNT_OK;
    if (BRUNT_CAPACITY_IN(work->memory, work->capacity, reals, 0, "numbers of a thread to work with", error))
        return BRUNT_FAILED;
    work->stride = stride;
    work->window = work->memory;
    work->planes = work->window + window;
    real *at = work->planes + planes;
    for (int k = 0; k < outs; k++, at += stride) work->out[k] = at;
    work->plastic = at;
    work->viscous = at + stride;
    work->strain = at + 2 * stride;
    return BRUNT_OK;
}

void brunt_workspace_free(brunt_workspace *work) {
    brunt_free(work->memory);
    *work = (brunt_workspace){0};
}
