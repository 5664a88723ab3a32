// Boundaries of a definition: what becomes of each.
#include <math.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "boundary/kinds.h"
#include "world/create.h"

int brunt_boundaries_make(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order,
                          brunt_error *error) {
    brunt_boundaries *all = &world->boundaries;
    const brunt_boundary_making m = {def, all, &world->messages};
    all->boundary_count = brunt_boundary_entry_count(def);
    if (BRUNT_NEW(all->boundary, all->boundary_count + 1, "boundaries", error)) return BRUNT_FAILED;
    if (def->axisymmetric && world->bodies.has_particles)
        all->symmetry[all->symmetry_count++] = (brunt_symmetry_plane){
            .axis = 0, .node = (int32_t)round(-def->origin[0] / def->cell), .side = 1, .boundary = -1};
    for (brunt_boundary_entry e = {.w = -1}; brunt_boundary_entry_next(def, &e);) {
        brunt_boundary *boundary = &all->boundary[e.w];
        const char *body = e.kind->body ? e.kind->body(e.entry) : "";
        boundary->kind = e.kind;
        brunt_boundary_name(&e, boundary->name);
        boundary->symmetry_plane = boundary->body = -1;
        if (body[0] && (boundary->body = brunt_find_ordered(order, def->body_count, body)) < 0)
            REFUSE("boundaries (%s).body: there is no body '%s'", boundary->name, body);
        const int status = e.kind->make(&m, e.entry, e.w, error);
        if (status) return status;
    }
    return BRUNT_OK;
}
