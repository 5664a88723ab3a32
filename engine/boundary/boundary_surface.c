// Lines and surfaces that hold material points, once they are cut into pieces: made, asked, saved.
#include "boundary/boundary_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/check.h"
#include "base/error.h"
#include "base/memory.h"
#include "boundary/boundary_pieces.h"
#include "boundary/curve.h"
#include "boundary/kinds.h"
#include "grid/grid.h"

// ------------------------------------------------------------------------------------------ cells

typedef struct celled {
    uint64_t key;
    int32_t particle;
} celled;

static int compare_celled(const void *a, const void *b) {
    const celled *p = a, *q = b;
    return p->key != q->key ? (p->key < q->key ? -1 : 1) : (p->particle > q->particle) - (p->particle < q->particle);
}

static int sort_particles(brunt_boundary_surface *s, brunt_error *error) {
    const size_t n = (size_t)s->particle_count;
    celled *list;
    if (BRUNT_NEW(s->key, n + 1, "cells of a boundary", error) ||
        BRUNT_NEW(s->cell_first, n + 2, "cells of a boundary", error) ||
        BRUNT_NEW(s->cell_particle, n + 1, "particles of a boundary", error) ||
        BRUNT_NEW(list, n + 1, "particles of a boundary", error))
        return BRUNT_FAILED;
    for (int a = 0; a < 3; a++) s->low[a] = INFINITY, s->high[a] = -INFINITY;
    for (size_t p = 0; p < n; p++)
        for (int a = 0; a < 3; a++) {
            s->low[a] = fmin(s->low[a], s->particle[p].x[a]);
            s->high[a] = fmax(s->high[a], s->particle[p].x[a]);
        }
    for (size_t p = 0; p < n; p++) {
        int32_t at[3];
        for (int a = 0; a < 3; a++) at[a] = (int32_t)floor((s->particle[p].x[a] - s->low[a]) / s->cell);
        list[p] = (celled){brunt_key(at), (int32_t)p};
    }
    qsort(list, n, sizeof *list, compare_celled);
    for (size_t p = 0; p < n; p++) {
        if (p == 0 || list[p].key != list[p - 1].key)
            s->key[s->cells] = list[p].key, s->cell_first[s->cells++] = (int32_t)p;
        s->cell_particle[p] = list[p].particle;
    }
    s->cell_first[s->cells] = (int32_t)n;
    brunt_free(list);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ making

static int find_body(brunt_boundary_surface *s, const brunt_bodies *bodies, brunt_error *error) {
    s->boundary->body = -1;
    if (!s->def.body[0]) return BRUNT_OK;
    s->boundary->body = brunt_bodies_find(bodies, s->def.body);
    if (s->boundary->body < 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "boundaries (%s).body: there is no body '%s'", s->boundary->name,
                          s->def.body);
    if (bodies->all[s->boundary->body].mpm) return BRUNT_OK;
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "boundaries (%s).body: '%s' is of elements, lines and surfaces hold material points: group "
                      "names nodes of elements, and contact is with a mesh that one moves",
                      s->boundary->name, s->def.body);
}

// Load steps without a table go in proportion to the pseudo-time.
static int take_table(brunt_boundary_surface *s, const brunt_boundary_surface_def *def, const brunt_world_def *world,
                      brunt_error *error) {
    static const double ramp[][2] = {{0, 0}, {1, 1}};
    const brunt_curve grows = {.points = (double(*)[2])ramp, .count = BRUNT_COUNT(ramp)};
    const bool ramped = world->scheme == BRUNT_STATIC && def->displacement && !def->table.count;
    return brunt_curve_copy(&s->def.table, ramped ? &grows : &def->table, error);
}

// What all of them have, once they are cut.
static int close_surface(brunt_boundary_surface *s, const brunt_bodies *bodies, brunt_error *error) {
    BRUNT_TRY(sort_particles(s, error));
    brunt_boundary_surface_backs(s);
    BRUNT_TRY(brunt_boundary_turned_make(s, error));
    s->bodies = bodies->mpm_count;
    s->boundary->surface = s;
    return BRUNT_NEW(s->traction, (size_t)s->bodies * (size_t)s->pieces * 3 + 1, "tractions of a boundary", error);
}

static int make_surface(brunt_boundary_surface *s, const brunt_boundary_surface_def *def, const brunt_world_def *world,
                        const brunt_bodies *bodies, brunt_error *error) {
    s->def = *def;
    s->def.point = NULL, s->def.facet = NULL;
    BRUNT_TRY(take_table(s, def, world, error));
    int status = find_body(s, bodies, error);
    if (!status) status = (world->dimension == 2 ? brunt_boundary_cut_line : brunt_boundary_cut_facets)(s, def, error);
    if (!status) status = close_surface(s, bodies, error);
    if (status) return status;
    return brunt_scheme_minimises(world->scheme) ? BRUNT_OK : brunt_boundary_surface_points(s, def, world, error);
}

static int find_frames(brunt_boundary_surfaces *surfaces, const brunt_world_def *def, const brunt_bodies *bodies,
                       brunt_error *error) {
    if (BRUNT_NEW(surfaces->frame, bodies->mpm_count + 1, "bodies at boundaries", error)) return BRUNT_FAILED;
    for (int32_t k = 0; k < def->body_count; k++) {
        const int b = brunt_bodies_find(bodies, def->bodies[k].name);
        if (!bodies->all[b].mpm) continue;
        memcpy(surfaces->frame[bodies->all[b].mpm - bodies->mpm], def->bodies[k].place.rotation,
               sizeof *surfaces->frame);
    }
    return BRUNT_OK;
}

int brunt_boundary_surfaces_make(brunt_boundary_surfaces *surfaces, const brunt_world_def *def,
                                 const brunt_bodies *bodies, brunt_boundary *boundaries, brunt_error *error) {
    brunt_boundary *planes = boundaries + brunt_boundary_first(def, "plane");
    int count = def->surface_count;
    for (int w = 0; w < def->plane_count; w++) count += planes[w].in_pieces;
    if (!count) return BRUNT_OK;
    if (BRUNT_NEW(surfaces->surface, count, "boundaries of lines and surfaces", error) ||
        find_frames(surfaces, def, bodies, error))
        return BRUNT_FAILED;
    surfaces->count = count;
    for (int k = 0, w = 0; k < count; k++) {
        brunt_boundary_surface *s = &surfaces->surface[k];
        const bool is_plane = k >= def->surface_count;
        while (is_plane && !planes[w].in_pieces) w++;
        s->boundary = is_plane ? &planes[w++] : &boundaries[brunt_boundary_first(def, "surface") + k];
        s->cell = def->cell;
        int status = is_plane ? brunt_boundary_window_make(s, bodies, def->dimension, error)
                              : make_surface(s, &def->surfaces[k], def, bodies, error);
        if (!status && is_plane) status = close_surface(s, bodies, error);
        if (status) return status;
    }
    return BRUNT_OK;
}

void brunt_boundary_surfaces_free(brunt_boundary_surfaces *surfaces) {
    for (int k = 0; k < surfaces->count; k++) {
        brunt_boundary_surface *s = &surfaces->surface[k];
        brunt_free(s->def.table.points), brunt_free(s->particle), brunt_free(s->first);
        brunt_boundary_turned_free(&s->turned);
        brunt_free(s->key), brunt_free(s->cell_first), brunt_free(s->cell_particle), brunt_free(s->traction);
        brunt_facets_free(&s->facets), brunt_free(s->rate), brunt_free(s->touching);
    }
    brunt_free(surfaces->surface), brunt_free(surfaces->frame);
    *surfaces = (brunt_boundary_surfaces){.count = 0};
}

size_t brunt_boundary_surfaces_bytes(const brunt_boundary_surfaces *surfaces) {
    size_t bytes = 0;
    for (int k = 0; k < surfaces->count; k++) {
        const brunt_boundary_surface *s = &surfaces->surface[k];
        bytes += brunt_facets_bytes(&s->facets) + s->touching_capacity;
        bytes += s->rate ? (size_t)s->pieces * sizeof *s->rate : 0;
        bytes += s->turned.particle ? (size_t)s->particle_count * (sizeof *s->particle + sizeof *s->turned.goes) : 0;
        bytes += (size_t)s->particle_count * (sizeof *s->particle + sizeof *s->key + 2 * sizeof(int32_t)) +
                 (size_t)s->pieces * (size_t)s->bodies * 3 * sizeof *s->traction;
    }
    return bytes;
}

// ------------------------------------------------------------------------------------------ what is asked of it

int brunt_boundary_surface_rows(const brunt_boundary_surface *s, int dim) {
    return s->def.condition == BRUNT_STICK || s->def.friction > 0 ? dim : 1;
}

void brunt_boundary_surface_direction(const brunt_boundary_surface *s, const brunt_boundary_particle *b, int row,
                                      double out[3]) {
    const bool sticks = s->def.condition == BRUNT_STICK;
    const double *direction = row == 0 ? b->normal : b->tangent[row - 1];
    for (int a = 0; a < 3; a++) out[a] = sticks ? a == row : direction[a];
}

void brunt_boundary_surface_way(const brunt_boundary_surface *s, double time, double way[3]) {
    const double share =
        s->def.displacement ? brunt_curve_at(&s->def.table, time) : brunt_curve_integral(&s->def.table, time);
    for (int a = 0; a < 3; a++) way[a] = share * s->def.value[a];
    brunt_boundary_window_way(s, way);
}

bool brunt_boundary_surface_acts(const brunt_boundary_surface *s, const brunt_body *body) {
    return s->boundary->body < 0 || s->boundary->body == body->index;
}

// ------------------------------------------------------------------------------------------ what must hold

static void validate_cells(const brunt_boundary_surface *s) {
    BRUNT_ASSERT(s->cell > 0 && s->cells >= 0 && s->cell_first[0] == 0 && s->cell_first[s->cells] == s->particle_count);
    for (int32_t c = 0; c < s->cells; c++)
        BRUNT_ASSERT(s->cell_first[c] < s->cell_first[c + 1] && (!c || s->key[c - 1] < s->key[c]));
    for (int32_t p = 0; p < s->particle_count; p++)
        BRUNT_ASSERT(s->cell_particle[p] >= 0 && s->cell_particle[p] < s->particle_count);
}

void brunt_boundary_surfaces_validate(const brunt_boundary_surfaces *surfaces, const brunt_bodies *bodies) {
    for (int k = 0; k < surfaces->count; k++) {
        const brunt_boundary_surface *s = &surfaces->surface[k];
        BRUNT_ASSERT(s->boundary && s->boundary->body < bodies->count && s->bodies == bodies->mpm_count);
        BRUNT_ASSERT(s->pieces > 0 && s->first[0] == 0 && s->first[s->pieces] == s->particle_count);
        for (int32_t p = 0; p < s->particle_count; p++) {
            const int32_t piece = s->particle[p].piece;
            BRUNT_ASSERT(piece >= 0 && piece < s->pieces && p >= s->first[piece] && p < s->first[piece + 1]);
            const double *n = s->particle[p].normal, *t = s->particle[p].tangent[0];
            BRUNT_ASSERT(s->particle[p].weight > 0 && fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-9);
            BRUNT_ASSERT(fabs(n[0] * t[0] + n[1] * t[1] + n[2] * t[2]) < 1e-9);
        }
        for (int64_t i = 0; i < (int64_t)s->bodies * s->pieces * 3; i++) BRUNT_ASSERT(isfinite(s->traction[i]));
        BRUNT_ASSERT(s->active >= 0 && s->drift >= 0);
        BRUNT_ASSERT(s->boundary->surface == s && s->speed[0] >= 0);
        brunt_facets_validate(&s->facets);
        validate_cells(s);
    }
}

// ------------------------------------------------------------------------------------------ state

// Tractions, a free tool, where the pieces of a plane are, and what was reported of the last step.
static int64_t state_of(const brunt_boundary_surface *s) {
    return (int64_t)s->bodies * s->pieces * 3 + (s->tool.free ? BRUNT_TOOL_STATE : 0) + (s->window.each ? 2 : 0) + 2;
}

int64_t brunt_boundary_surfaces_state_count(const brunt_boundary_surfaces *surfaces) {
    int64_t count = 0;
    for (int k = 0; k < surfaces->count; k++) count += state_of(&surfaces->surface[k]);
    return count;
}

double *brunt_boundary_surfaces_state_get(const brunt_boundary_surfaces *surfaces, double *out) {
    for (int k = 0; k < surfaces->count; k++) {
        const brunt_boundary_surface *s = &surfaces->surface[k];
        const size_t tractions = (size_t)s->bodies * (size_t)s->pieces * 3;
        memcpy(out, s->traction, tractions * sizeof *out);
        out += tractions;
        if (s->tool.free) out = brunt_tool_state_get(&s->tool, out);
        for (int d = 0; s->window.each && d < 2; d++) *out++ = s->window.at[d];
        *out++ = s->active, *out++ = s->drift;
    }
    return out;
}

const double *brunt_boundary_surfaces_state_set(brunt_boundary_surfaces *surfaces, const double *in) {
    for (int k = 0; k < surfaces->count; k++) {
        brunt_boundary_surface *s = &surfaces->surface[k];
        const size_t tractions = (size_t)s->bodies * (size_t)s->pieces * 3;
        memcpy(s->traction, in, tractions * sizeof *in);
        in += tractions;
        if (s->tool.free) in = brunt_tool_state_set(&s->tool, in);
        if (s->tool.free) brunt_boundary_surface_hurry(s);
        for (int d = 0; s->window.each && d < 2; d++) s->window.at[d] = *in++;
        s->active = (int32_t)*in++, s->drift = *in++;
    }
    return in;
}
