// Pictures of lines and surfaces that hold material points.
#include "base/error.h"
#include "base/memory.h"
#include "io/output/vtu.h"

int brunt_vtu_write_boundary(const char *path, const brunt_world *world, int32_t surface, bool float32,
                             brunt_error *error) {
    const int64_t count = brunt_boundary_surface_size(world, surface);
    double *values = brunt_alloc((size_t)count * 10 * sizeof *values + 1);
    int64_t *piece = brunt_alloc((size_t)count * sizeof *piece + 1);
    int status = BRUNT_FAILED;
    if (values && piece) {
        const brunt_boundary_surface_arrays arrays = {.position = values,
                                                      .normal = values + 3 * count,
                                                      .traction = values + 6 * count,
                                                      .weight = values + 9 * count,
                                                      .piece = piece};
        const brunt_vtu_grid grid = {.point_count = count, .points = arrays.position};
        const brunt_vtu_array shown[] = {{.name = "traction", .components = 3, .values = arrays.traction},
                                         {.name = "normal", .components = 3, .values = arrays.normal},
                                         {.name = "weight", .components = 1, .values = arrays.weight},
                                         {.name = "piece", .components = 1, .integers = piece}};
        brunt_boundary_surface_particles(world, surface, &arrays);
        status =
            brunt_vtu_write(path, brunt_world_time(world), &grid, shown, sizeof shown / sizeof *shown, float32, error);
    } else {
        brunt_fail(error, BRUNT_FAILED, "out of memory for the picture of a boundary");
    }
    brunt_free(values), brunt_free(piece);
    return status;
}
