// Pictures of what bodies do to each other: a line from centre to centre for each two that push.
#include <math.h>

#include "base/array.h"
#include "io/output/vtu_picture.h"

enum { LINE = 3 }; // VTK's number

typedef struct link_arrays {
    double *point, *force, *normal, *friction, *share;
    int64_t *body;
    int32_t *cell;
    int64_t count;
} link_arrays;

static double extent(const brunt_body_sums *sums) {
    double most = 0;
    for (int a = 0; a < 3; a++) most = fmax(most, sums->high[a] - sums->low[a]);
    return most;
}

// From centre to centre; to a body much larger than the other, a plate, it ends where that one does.
static void place_ends(brunt_world *world, const brunt_link *link, double point[2][3]) {
    static const double MUCH_LARGER = 3;
    brunt_body_sums sums[2];
    double size[2];
    for (int end = 0; end < 2; end++) {
        brunt_body_totals(world, end ? link->b : link->a, &sums[end]);
        size[end] = extent(&sums[end]);
        for (int a = 0; a < 3; a++) point[end][a] = sums[end].centre[a];
    }
    const int large = size[1] > size[0], small = !large;
    const double *F = link->force, all = sqrt(F[0] * F[0] + F[1] * F[1] + F[2] * F[2]);
    if (!(size[large] > MUCH_LARGER * size[small])) return;
    for (int a = 0; a < 3; a++) // forces push away from each other
        point[large][a] = point[small][a] - (small == 0 ? 0.5 : -0.5) * size[small] * F[a] / all;
}

static void fill(brunt_world *world, int32_t links, link_arrays *to) {
    for (int32_t i = 0; i < links; i++) {
        const brunt_link link = brunt_world_link(world, i);
        const int64_t k = to->count;
        if (!(link.normal > 0)) continue;
        place_ends(world, &link, (double(*)[3])(to->point + 6 * k));
        for (int end = 0; end < 2; end++) to->cell[2 * k + end] = (int32_t)(2 * k + end);
        for (int a = 0; a < 3; a++) to->force[3 * k + a] = link.force[a];
        to->normal[k] = link.normal, to->friction[k] = link.friction, to->share[k] = link.share;
        to->body[k] = link.a, to->body[k + links] = link.b;
        to->count++;
    }
}

static void show(brunt_vtu_picture *picture, const link_arrays *all, int32_t links) {
    const brunt_vtu_array shown[] = {
        {.name = "normal", .unit = "N", .components = 1, .values = all->normal, .at_cells = true},
        {.name = "force", .unit = "N", .components = 3, .values = all->force, .at_cells = true},
        {.name = "friction", .unit = "N", .components = 1, .values = all->friction, .at_cells = true},
        {.name = "share", .components = 1, .values = all->share, .at_cells = true},
        {.name = "body_a", .components = 1, .integers = all->body, .at_cells = true},
        {.name = "body_b", .components = 1, .integers = all->body + links, .at_cells = true},
    };
    picture->grid = (brunt_vtu_grid){.point_count = 2 * all->count,
                                     .cell_count = all->count,
                                     .points = all->point,
                                     .cells = all->cell,
                                     .cell_nodes = 2,
                                     .cell_type = LINE};
    for (size_t a = 0; a < BRUNT_COUNT(shown); a++) brunt_vtu_add(picture, shown[a]);
}

brunt_vtu_picture *brunt_vtu_take_links(brunt_world *world, brunt_error *error) {
    static const char what[] = "links";
    int32_t links;
    brunt_world_links(world, &links);
    const size_t n = (size_t)links + 1;
    brunt_vtu_picture *picture = brunt_vtu_start(world, what, error);
    double *values = picture ? brunt_vtu_alloc(picture, n * 12 * sizeof *values, what, error) : NULL;
    link_arrays all = {.body = values ? brunt_vtu_alloc(picture, 2 * n * sizeof *all.body, what, error) : NULL};
    if (all.body) all.cell = brunt_vtu_alloc(picture, 2 * n * sizeof *all.cell, what, error);
    if (!all.cell) {
        brunt_vtu_release(picture);
        return NULL;
    }
    all.point = values, all.force = values + 6 * n, all.normal = values + 9 * n;
    all.friction = values + 10 * n, all.share = values + 11 * n;
    fill(world, links, &all);
    show(picture, &all, links);
    return picture;
}
