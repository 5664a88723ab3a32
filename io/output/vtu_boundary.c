// Pictures of lines and surfaces that hold material points.
#include "io/output/vtu_picture.h"

brunt_vtu_picture *brunt_vtu_take_boundary(const brunt_world *world, int32_t surface, brunt_error *error) {
    static const char what[] = "a boundary";
    const int64_t count = brunt_boundary_surface_size(world, surface);
    brunt_vtu_picture *p = brunt_vtu_start(world, what, error);
    double *values = p ? brunt_vtu_alloc(p, (size_t)count * 10 * sizeof *values, what, error) : NULL;
    int64_t *piece = values ? brunt_vtu_alloc(p, (size_t)count * sizeof *piece, what, error) : NULL;
    if (!piece) {
        brunt_vtu_release(p);
        return NULL;
    }
    const brunt_boundary_surface_arrays arrays = {.position = values,
                                                  .normal = values + 3 * count,
                                                  .traction = values + 6 * count,
                                                  .weight = values + 9 * count,
                                                  .piece = piece};
    brunt_boundary_surface_particles(world, surface, &arrays);
    p->grid = (brunt_vtu_grid){.point_count = count, .points = arrays.position};
    const char *area = brunt_world_dimension(world) == 3 ? "m^2" : "m";
    brunt_vtu_add(p, (brunt_vtu_array){.name = "traction", .unit = "Pa", .components = 3, .values = arrays.traction});
    brunt_vtu_add(p, (brunt_vtu_array){.name = "normal", .components = 3, .values = arrays.normal});
    brunt_vtu_add(p, (brunt_vtu_array){.name = "weight", .unit = area, .components = 1, .values = arrays.weight});
    brunt_vtu_add(p, (brunt_vtu_array){.name = "piece", .components = 1, .integers = piece});
    return p;
}
