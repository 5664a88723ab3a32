// What barriers ask of bodies at the start: a gap, and better one that is wider than the barrier.
#include "scheme/implicit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/sweep.h"
#include "contact/barrier/barrier_function.h"
#include "contact/search/initial_overlap.h"
#include "world/create.h"

static const double WITHIN = 0.99;   // of the distance: nearer gaps have a force to speak of at the start
static const double ROUNDING = 1e-9; // of the reach, and of the distance
static const double CROSSED = 1e-3;  // edges: how deep bodies are in each other, beyond what warped facets leave open

#define TOO_DEEP "more than half the shortest edge in contact, %.4g m: surfaces do not know which way is out from there"

typedef struct looked_at {
    const brunt_body_ref *body;
    const brunt_body_def *other; // whose shape nothing of the body may lie in
    int dim;
} looked_at;

// A node or particle of a body in the frame that another's shape is described in; false: past the last.
static bool local_point(const looked_at *l, int64_t n, double x[3], double local[3]) {
    brunt_body *mpm = l->body->mpm;
    if (n >= (mpm ? mpm->particles.slots : l->body->fem->node_count)) return false;
    for (int a = 0; a < 3; a++)
        x[a] = a >= l->dim ? 0
               : mpm       ? (double)brunt_field(&mpm->particles, BRUNT_FIELD_position)[a][n]
                           : (double)brunt_fem_node(l->body->fem, (int32_t)n)[a];
    const brunt_placement *place = &l->other->place;
    for (int a = 0; a < 3; a++) {
        local[a] = 0;
        for (int r = 0; r < 3; r++) local[a] += place->rotation[3 * r + a] * (x[r] - place->translation[r]);
    }
    return true;
}

// Whether a point lies in the other's shape, deeper than it may.
static bool touches(const looked_at *l, double reach, double x[3]) {
    double local[3];
    for (int64_t n = 0; local_point(l, n, x, local); n++)
        if (!(brunt_shape_distance(&l->other->shape, l->dim, local) > -reach)) return true;
    return false;
}

// Bounds of a body's nodes or particles.
static brunt_box box_of_points(const looked_at *l) {
    brunt_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    double x[3], local[3];
    for (int64_t n = 0; local_point(l, n, x, local); n++)
        for (int a = 0; a < 3; a++) box.low[a] = fmin(box.low[a], x[a]), box.high[a] = fmax(box.high[a], x[a]);
    return box;
}

static bool has_shape(const brunt_body_def *body) { return !body->mesh.node_count && body->method == BRUNT_FEM; }

// Of bodies whose boxes share something: those that are near.
static int check_near(const brunt_implicit_contact *c, const brunt_world *world, const brunt_body_def **order,
                      const brunt_box_pair *near, brunt_error *error) {
    const int n = world->bodies.count, one = near->a, other = near->b - n;
    brunt_barrier_pair pair;
    if (other < 0 || one == other || !has_shape(order[other])) return BRUNT_OK;
    if (!brunt_implicit_contact_pair(c, one < other ? one : other, one < other ? other : one, &pair)) return BRUNT_OK;
    const looked_at l = {&world->bodies.all[one], order[other], world->settings.dimension};
    double x[3];
    if (!touches(&l, pair.reach, x)) return BRUNT_OK;
    if (pair.reach > 0)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "bodies.%s lies in bodies.%s at the start, at (%.6g, %.6g, %.6g) m, by " TOO_DEEP,
                          brunt_body_name(world, one), brunt_body_name(world, other), x[0], x[1], x[2], pair.reach);
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "bodies.%s touches bodies.%s at the start, or lies in it, at (%.6g, %.6g, %.6g) m: barriers want "
                      "a gap of more than 0 m, of %.4g m to begin without a force",
                      brunt_body_name(world, one), brunt_body_name(world, other), x[0], x[1], x[2], c->distance);
}

// Barriers know gaps, not insides: bodies must begin outside each other, as far as shapes can tell. `order`: the
// definitions by name, as the bodies of the world are.
static int check_shapes(const brunt_implicit_contact *c, const brunt_world *world, const brunt_body_def **order,
                        brunt_error *error) {
    const int n = world->bodies.count, dim = world->settings.dimension;
    brunt_box *box;
    brunt_box_pair *near;
    int64_t count;
    if (BRUNT_NEW(box, 2 * n + 1, "boxes about bodies", error)) return BRUNT_FAILED;
    for (int b = 0; b < n; b++) {
        const looked_at l = {&world->bodies.all[b], order[b], dim};
        box[b] = box_of_points(&l), box[n + b] = brunt_box_of_shape(order[b], dim);
        double size = 0; // what rounding may have taken
        for (int a = 0; a < dim; a++) size = fmax(size, fmax(fabs(box[b].low[a]), fabs(box[b].high[a])));
        for (int a = 0; a < dim; a++) box[b].low[a] -= 1e-12 * size, box[b].high[a] += 1e-12 * size;
    }
    int status = brunt_sweep(box, n, 2 * n, &near, &count, error);
    for (int64_t q = 0; q < count && !status; q++) status = check_near(c, world, order, &near[q], error);
    brunt_free(near), brunt_free(box);
    return status;
}

static bool keeps_apart(const void *contact, int32_t a, int32_t b) {
    brunt_barrier_pair pair;
    return brunt_implicit_contact_pair(contact, a < b ? a : b, a < b ? b : a, &pair) && !(pair.reach > 0);
}

// Of bodies of mesh files, and where facets of round bodies cross: by the meshes themselves.
static int find_overlap(const brunt_implicit_contact *c, const brunt_world *world, brunt_contact_surface *s,
                        brunt_overlap *found, brunt_error *error) {
    brunt_surface_gather_places(s, world->settings.threads, NULL);
    const brunt_contact_context m = {.surface = s, .body_count = world->bodies.count};
    const brunt_overlap_rule rule = {.meets = keeps_apart, .self = c, .least = CROSSED, .centres = true};
    return brunt_overlap_find(&m, world->bodies.mpm, world->bodies.mpm_count, 0, &rule, found, error);
}

static int check_meshes(const brunt_implicit_contact *c, const brunt_world *world, brunt_error *error) {
    const int count = world->bodies.fem_count;
    brunt_fem_body **fem;
    brunt_contact_surface s = {0};
    brunt_overlap o = {.any = false};
    if (BRUNT_NEW(fem, count + 1, "meshes that may overlap", error)) return BRUNT_FAILED;
    for (int k = 0; k < count; k++) fem[k] = &world->bodies.fem[k];
    int status = brunt_surface_make(&s, fem, count, false, error);
    if (!status && count) status = find_overlap(c, world, &s, &o, error);
    brunt_surface_free(&s), brunt_free(fem);
    if (status || !o.any) return status;
    return brunt_fail(
        error, BRUNT_BAD_INPUT,
        "bodies.%s overlaps bodies.%s by %.4g m at the start, at (%.6g, %.6g, %.6g) m: barriers want a gap "
        "of more than 0 m, of %.4g m to begin without a force",
        brunt_body_name(world, o.a), brunt_body_name(world, o.b), o.depth, o.x[0], o.x[1], o.x[2], c->distance);
}

// Material points as they begin, which nothing moves yet.
static int place_points(brunt_implicit_contact *c, const brunt_bodies *bodies, brunt_error *error) {
    int64_t nodes;
    int32_t count;
    if (brunt_implicit_contact_reserve(c, bodies, &count, &nodes, error)) return BRUNT_FAILED;
    const size_t n = (size_t)count + 1;
    memset(c->first, 0, (n + 1) * sizeof *c->first);
    c->point_count = 0;
    for (int i = 0; i < bodies->mpm_count; i++) {
        brunt_particles *p = &bodies->mpm[i].particles;
        real *const *x = brunt_field(p, BRUNT_FIELD_position);
        const real *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
        for (int64_t s = 0; c->has_points[i] && s < p->slots; s++) {
            if (!(volume[s] > 0)) continue; // padding
            for (int a = 0; a < 3; a++) c->x[c->point_count][a] = a < p->dim ? (double)x[a][s] : 0;
            c->area[c->point_count] = brunt_barrier_particle_area(p->dim, (double)volume[s]);
            c->owner[c->point_count++] = bodies->mpm[i].index;
        }
    }
    return BRUNT_OK;
}

// What is nearest to something as the run begins, by the barrier itself: of planes, surfaces whatever they are made
// from, and edges.
static int look_at_start(brunt_implicit_contact *c, const brunt_world *world, brunt_barrier_report *nearest,
                         brunt_error *error) {
    const brunt_team alone = {.threads = 1};
    const int status = place_points(c, &world->bodies, error);
    if (status) return status;
    for (int32_t q = 0; q < c->plane_count; q++)
        memcpy(c->plane[q].origin, world->boundaries.boundary[c->plane_boundary[q]].plane.point,
               sizeof c->plane[q].origin);
    const brunt_barrier_step step = {.x = (const double(*)[3])c->rest,
                                     .node = c->node,
                                     .particles = {.count = c->point_count,
                                                   .x = (const double(*)[3])c->x,
                                                   .area = c->area,
                                                   .body = c->owner,
                                                   .first = c->first},
                                     .planes = c->plane,
                                     .plane_count = c->plane_count,
                                     .dt = 1,
                                     .factor = 1};
    const int set = brunt_barrier_set_step(c->barrier, &step, error);
    return set ? set : brunt_barrier_look_back(c->barrier, &alone, NULL, NULL, nearest, NULL, error);
}

// [J]
static double kinetic_energy(const brunt_bodies *bodies) {
    double sum = 0;
    for (int b = 0; b < bodies->count; b++) sum += brunt_bodies_measure_of(bodies, &bodies->all[b]).sums.kinetic;
    return sum;
}

// What is nearest begins in what it meets.
static int check_overlap(const brunt_implicit_contact *c, brunt_world *world, const brunt_barrier_report *r,
                         const char *to, brunt_error *error) {
    if (r->least_gap < -c->reach)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "bodies.%s overlaps %s by %.4g m at the start, at (%.6g, %.6g, %.6g) m, " TOO_DEEP,
                          brunt_body_name(world, r->body), to, -r->least_gap, r->position[0], r->position[1],
                          r->position[2], c->reach);
    brunt_warn(&world->messages,
               "bodies.%s overlaps %s by %.4g m at the start, at (%.6g, %.6g, %.6g) m: penalties push them apart in "
               "the first load step; they store %.3g J",
               brunt_body_name(world, r->body), to, -r->least_gap, r->position[0], r->position[1], r->position[2],
               r->energy);
    return BRUNT_OK;
}

// A closed gap has no energy that a step could begin with, unless surfaces may overlap; one within the distance pushes
// from the first step on.
static int check_gaps(brunt_implicit_contact *c, brunt_world *world, bool given, brunt_error *error) {
    brunt_barrier_report r;
    const double distance = c->opens ? c->distance : c->overlap_distance;
    const int status = look_at_start(c, world, &r, error);
    if (status || !(r.least_gap < WITHIN * distance || r.least_gap < -ROUNDING * c->reach)) return status;
    const double closed = ROUNDING * distance; // what a turn leaves of none: no step could begin with its force
    char to[2 * BRUNT_NAME_LENGTH];
    if (r.plane >= 0)
        snprintf(to, sizeof to, "the plane '%s'", world->boundaries.boundary[c->plane_boundary[r.plane]].name);
    else
        snprintf(to, sizeof to, "bodies.%s", brunt_body_name(world, r.other));
    if (r.least_gap > (r.overlaps ? 0 : closed)) {
        brunt_warn(&world->messages,
                   "bodies.%s begins with a gap of %.4g m to %s, at (%.6g, %.6g, %.6g) m: within contact.distance, "
                   "%.4g m%s, %s push; they store %.3g J at the start, all bodies move with %.3g J",
                   brunt_body_name(world, r.body), r.least_gap, to, r.position[0], r.position[1], r.position[2],
                   distance, given ? "" : " by default", c->opens ? "barriers" : "penalties", r.energy,
                   kinetic_energy(&world->bodies));
        return BRUNT_OK;
    }
    if (r.overlaps) return check_overlap(c, world, &r, to, error);
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "bodies.%s has a gap of %.4g m to %s at the start, at (%.6g, %.6g, %.6g) m: barriers want more "
                      "than 0 m, %.4g m to begin without a force",
                      brunt_body_name(world, r.body), fabs(r.least_gap) > closed ? r.least_gap : 0, to, r.position[0],
                      r.position[1], r.position[2], c->distance);
}

int brunt_implicit_contact_check(brunt_implicit_contact *c, brunt_world *world, const brunt_body_def **order,
                                 bool given, brunt_error *error) {
    int status = check_shapes(c, world, order, error);
    if (!status && c->opens) status = check_meshes(c, world, error);
    return status ? status : check_gaps(c, world, given, error);
}
