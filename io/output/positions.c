#include "io/output/positions.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"

int32_t brunt_find_body(const brunt_world *world, const char *name) {
    int32_t low = 0, high = brunt_body_count(world); // in order of name
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        const int order = strcmp(brunt_body_name(world, middle), name);
        if (order == 0) return middle;
        *(order < 0 ? &low : &high) = order < 0 ? middle + 1 : middle;
    }
    return BRUNT_NONE;
}

brunt_location brunt_location_of_motion(const brunt_world *world, int32_t body) {
    return brunt_body_method(world, body) == BRUNT_MPM ? BRUNT_AT_PARTICLES : BRUNT_AT_NODES;
}

static int no_memory(const brunt_world *world, int32_t body, brunt_error *error) {
    return brunt_fail(error, BRUNT_FAILED, "out of memory while reading body '%s'", brunt_body_name(world, body));
}

static int read_points(brunt_world *world, int32_t body, double **points, brunt_error *error) {
    int32_t position = brunt_body_find_field(world, body, "position");
    if (position < 0)
        return brunt_fail(error, BRUNT_FAILED, "body '%s' has no field 'position'", brunt_body_name(world, body));
    *points =
        brunt_alloc(sizeof(double) * 3 * (size_t)brunt_body_size(world, body, brunt_location_of_motion(world, body)));
    if (!*points) return no_memory(world, body, error);
    brunt_body_read(world, body, position, *points);
    return BRUNT_OK;
}

// Means of the corners.
static int read_centres(brunt_world *world, int32_t body, const double *points, double **positions,
                        brunt_error *error) {
    int nodes = brunt_element_nodes(brunt_body_element(world, body));
    int64_t count = brunt_body_size(world, body, BRUNT_AT_ELEMENTS);
    int32_t *cells = brunt_alloc(sizeof *cells * (size_t)nodes * (size_t)count);
    double *centres = brunt_alloc(sizeof *centres * 3 * (size_t)count);
    if (!cells || !centres) {
        brunt_free(cells);
        brunt_free(centres);
        return no_memory(world, body, error);
    }
    brunt_body_connectivity(world, body, cells);
    for (int64_t e = 0; e < count; e++)
        for (int c = 0; c < 3; c++) {
            double sum = 0;
            for (int n = 0; n < nodes; n++) sum += points[3 * (int64_t)cells[nodes * e + n] + c];
            centres[3 * e + c] = sum / nodes;
        }
    brunt_free(cells);
    *positions = centres;
    return BRUNT_OK;
}

int brunt_positions_read(brunt_world *world, int32_t body, brunt_location at, double **positions, brunt_error *error) {
    double *points = NULL;
    int status = read_points(world, body, &points, error);
    if (status || at != BRUNT_AT_ELEMENTS) {
        *positions = points;
        return status;
    }
    status = read_centres(world, body, points, positions, error);
    brunt_free(points);
    return status;
}

int32_t brunt_location_ids(const brunt_world *world, int32_t body, brunt_location at) {
    return at == BRUNT_AT_NODES ? BRUNT_NONE
                                : brunt_body_find_field(world, body, at == BRUNT_AT_ELEMENTS ? "element" : "id");
}
