// Definitions of lines that hold material points.
#pragma once

#include "tests/support/def_world.h"

// Points in turn, of a line that may be closed; the caller says where they are.
static inline brunt_boundary_surface_def *def_polyline(brunt_world_def *def, int count, bool closed,
                                                       brunt_condition condition) {
    brunt_boundary_surface_def *s = &def->surfaces[def->surface_count++];
    *s = brunt_boundary_surface_def_default();
    s->condition = condition;
    s->point = brunt_alloc((size_t)count * sizeof *s->point), s->point_count = count;
    s->facet = brunt_alloc((size_t)count * sizeof *s->facet), s->facet_count = count - !closed;
    for (int32_t f = 0; f < s->facet_count; f++)
        memcpy(s->facet[f], (const int32_t[4]){f, (f + 1) % count, -1, -1}, sizeof s->facet[f]);
    return s;
}

static inline brunt_boundary_surface_def *def_line(brunt_world_def *def, double x0, double y0, double x1, double y1,
                                                   brunt_condition condition) {
    brunt_boundary_surface_def *s = def_polyline(def, 2, false, condition);
    s->point[0][0] = x0, s->point[0][1] = y0, s->point[1][0] = x1, s->point[1][1] = y1;
    return s;
}
