// Planes that hold material points in implicit steps as lines and surfaces do: by pieces, wherever they lie in the
// grid.
//
// A plane has no end; its pieces are those of a window, which goes along with the bodies before it by whole pieces, so
// that each keeps its place and its traction.
#include "boundary/boundary_surface.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/check.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vector.h"
#include "boundary/boundary_pieces.h"

enum { SPARE = 8, RIM = 2 }; // pieces: of a window beside twice what the bodies take; between them and its ends

// Two directions across a normal and each other; the first is such that the normal is to its left in two dimensions.
static void find_tangents(const double n[3], int dim, double t[2][3]) {
    const int least = fabs(n[0]) <= fabs(n[1]) && fabs(n[0]) <= fabs(n[2]) ? 0 : fabs(n[1]) <= fabs(n[2]) ? 1 : 2;
    const double axis[3] = {least == 0, least == 1, least == 2};
    if (dim == 2) {
        t[0][0] = n[1], t[0][1] = -n[0], t[0][2] = 0;
        return;
    }
    cross(axis, n, t[0]);
    const double size = sqrt(dot(t[0], t[0]));
    for (int a = 0; a < 3; a++) t[0][a] /= size;
    cross(n, t[0], t[1]);
}

// From where to where the bodies are along a direction of the plane, in pieces from its point.
static void take_range(const brunt_boundary_surface *s, const brunt_bodies *bodies, int d, double range[2]) {
    const brunt_plane_def *plane = &s->boundary->plane;
    range[0] = INFINITY, range[1] = -INFINITY;
    for (int b = 0; b < bodies->count; b++) {
        const brunt_body_ref *body = &bodies->all[b];
        if (!body->mpm || !brunt_boundary_surface_acts(s, body->mpm)) continue;
        const brunt_body_measure m = brunt_body_measure_of(body);
        const double *low = m.low, *high = m.high;
        if (!(low[0] <= high[0])) continue;
        double middle = 0, half = 0;
        for (int a = 0; a < body->mpm->particles.dim; a++) {
            middle += s->window.tangent[d][a] * (0.5 * (low[a] + high[a]) - plane->point[a]);
            half += fabs(s->window.tangent[d][a]) * 0.5 * (high[a] - low[a]);
        }
        range[0] = fmin(range[0], (middle - half) / s->window.piece);
        range[1] = fmax(range[1], (middle + half) / s->window.piece);
    }
}

static double first_piece(const brunt_boundary_window *w, int d, const double range[2]) {
    return floor(0.5 * (range[0] + range[1] - w->count[d]));
}

static int size_window(brunt_boundary_surface *s, const brunt_bodies *bodies, int dim, brunt_error *error) {
    brunt_boundary_window *w = &s->window;
    double pieces = 1;
    w->count[0] = w->count[1] = 1;
    for (int d = 0; d < dim - 1; d++) {
        double range[2];
        take_range(s, bodies, d, range);
        const double wide = range[0] <= range[1] ? range[1] - range[0] : 0;
        const double count = ceil(2 * wide) + SPARE;
        pieces *= count;
        if (!(pieces * pow(w->each, dim - 1) < BRUNT_BOUNDARY_PARTICLE_LIMIT))
            return brunt_fail(
                error, BRUNT_BAD_INPUT,
                "boundaries (%s): the bodies that it holds extend over %.3g of its pieces: that is too many",
                s->boundary->name, wide);
        w->count[d] = (int32_t)count;
        if (range[0] <= range[1]) w->at[d] = first_piece(w, d, range);
    }
    return BRUNT_OK;
}

static void fill_piece(brunt_boundary_surface *s, int dim, int32_t i, int32_t j) {
    const brunt_boundary_window *w = &s->window;
    const brunt_plane_def *plane = &s->boundary->plane;
    const int each = w->each, across = dim == 3 ? each : 1;
    s->first[s->pieces] = s->particle_count;
    for (int k = 0; k < each * across; k++) {
        const double one = (i + (k / across + 0.5) / each) * w->piece,
                     two = dim == 3 ? (j + (k % across + 0.5) / each) * w->piece : 0;
        brunt_boundary_particle *p = &s->particle[s->particle_count++];
        *p = (brunt_boundary_particle){.weight = pow(w->piece / each, dim - 1), .back = INFINITY, .piece = s->pieces};
        memcpy(p->normal, plane->normal, sizeof p->normal), memcpy(p->tangent, w->tangent, sizeof p->tangent);
        for (int a = 0; a < 3; a++) p->x[a] = plane->point[a] + one * w->tangent[0][a] + two * w->tangent[1][a];
    }
    s->first[++s->pieces] = s->particle_count;
}

int brunt_boundary_window_make(brunt_boundary_surface *s, const brunt_bodies *bodies, int dim, brunt_error *error) {
    brunt_boundary_window *w = &s->window;
    const brunt_plane_def *plane = &s->boundary->plane;
    s->def = brunt_boundary_surface_def_default();
    s->def.condition = plane->condition;
    memcpy(s->def.value, plane->velocity, sizeof s->def.value), memcpy(s->def.about, plane->point, sizeof s->def.about);
    w->piece = s->def.piece * s->cell, w->each = (int)ceil(s->def.piece * s->def.particles);
    find_tangents(plane->normal, dim, w->tangent);
    BRUNT_TRY(size_window(s, bodies, dim, error));
    const size_t pieces = (size_t)w->count[0] * (size_t)w->count[1];
    if (BRUNT_NEW(s->particle, pieces * (size_t)pow(w->each, dim - 1) + 1, "particles of a plane", error) ||
        BRUNT_NEW(s->first, pieces + 2, "pieces of a plane", error))
        return BRUNT_FAILED;
    for (int32_t i = 0; i < w->count[0]; i++)
        for (int32_t j = 0; j < w->count[1]; j++) fill_piece(s, dim, i, j);
    return BRUNT_OK;
}

// Tractions stay where they are, as the window goes on by so many pieces.
static int shift(brunt_boundary_surface *s, const double by[2], brunt_error *error) {
    const brunt_boundary_window *w = &s->window;
    double(*moved)[3];
    if (BRUNT_NEW(moved, s->pieces + 1, "tractions of a plane", error)) return BRUNT_FAILED;
    for (int b = 0; b < s->bodies; b++) {
        double *traction = s->traction + 3 * (size_t)b * (size_t)s->pieces;
        memset(moved, 0, (size_t)s->pieces * sizeof *moved);
        for (int32_t p = 0; p < s->pieces; p++) {
            const double i = p / w->count[1] - by[0], j = p % w->count[1] - by[1];
            if (i < 0 || i >= w->count[0] || j < 0 || j >= w->count[1]) continue;
            memcpy(moved[(int32_t)i * w->count[1] + (int32_t)j], traction + 3 * (size_t)p, sizeof *moved);
        }
        memcpy(traction, moved, (size_t)s->pieces * sizeof *moved);
    }
    brunt_free(moved);
    return BRUNT_OK;
}

int brunt_boundary_window_follow(brunt_boundary_surface *s, const brunt_bodies *bodies, int dim, brunt_error *error) {
    brunt_boundary_window *w = &s->window;
    double by[2] = {0, 0};
    for (int d = 0; w->each && d < dim - 1; d++) {
        double range[2];
        take_range(s, bodies, d, range);
        if (!(range[0] <= range[1])) continue;
        if (range[1] - range[0] > w->count[d] - 2 * RIM)
            return brunt_fail(error, BRUNT_FAILED,
                              "material spreads along plane '%s' over %.3g of its pieces, %d were made for where it "
                              "was at the start: a line or mesh of the same condition may be as long as one likes",
                              s->boundary->name, range[1] - range[0], w->count[d]);
        if (range[0] < w->at[d] + RIM || range[1] > w->at[d] + w->count[d] - RIM)
            by[d] = first_piece(w, d, range) - w->at[d];
    }
    if (by[0] == 0 && by[1] == 0) return BRUNT_OK;
    for (int d = 0; d < 2; d++) w->at[d] += by[d];
    return shift(s, by, error);
}

void brunt_boundary_window_way(const brunt_boundary_surface *s, double way[3]) {
    const brunt_boundary_window *w = &s->window;
    for (int a = 0; w->each && a < 3; a++)
        way[a] += w->piece * (w->at[0] * w->tangent[0][a] + w->at[1] * w->tangent[1][a]);
}
