// Surfaces, particles and planes that barriers keep apart.
#include "contact/methods/method.h"
#include "contact/planes/condition.h"
#include "scheme/implicit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "contact/barrier/barrier_function.h"
#include "grid/bspline.h"
#include "materials/material.h"

static const double WITHIN = 0.99; // of the distance: nearer gaps have a force to speak of at the start

// ------------------------------------------------------------------------------------------ stiffness and distance

// [Pa] Young's modulus, or of what has none that of its waves.
static double young(const brunt_world_def *def, const brunt_bodies *bodies, int body) {
    const brunt_material *material = brunt_bodies_material(bodies, body);
    for (int32_t m = 0; m < def->material_count; m++) {
        const brunt_material_def *from = &def->materials[m];
        const brunt_model *model = brunt_find_strength(from->strength);
        for (int k = 0; model && !strcmp(from->name, material->name) && k < model->parameter_count; k++)
            if (!strcmp(model->parameters[k].key, "E") && from->strength_parameters[k] > 0)
                return from->strength_parameters[k];
    }
    return (double)material->density * (double)material->wave_speed * (double)material->wave_speed;
}

// [m] shortest edge of a mesh at the start, or spacing of particles.
static double smallest_size(const brunt_bodies *bodies, int body) {
    const brunt_body_ref *ref = &bodies->all[body];
    return ref->mpm ? ref->mpm->spacing : bodies->mesh_reports[ref->fem - bodies->fem].quality.shortest_edge;
}

static double slowest_wave(const brunt_bodies *bodies) {
    double slowest = INFINITY;
    for (int b = 0; b < bodies->count; b++)
        slowest = fmin(slowest, (double)brunt_bodies_material(bodies, b)->wave_speed);
    return slowest;
}

// ------------------------------------------------------------------------------------------ pairs and planes

static bool plane_meets(const brunt_boundary *boundary, int body) {
    return boundary->body < 0 || boundary->body == body;
}

// Pairs of bodies that barriers keep apart; `c->pair` NULL: counts them.
static void list_pairs(brunt_implicit_contact *c, const brunt_world *world) {
    c->pair_count = 0;
    for (int32_t a = 0; a < world->bodies.count; a++)
        for (int32_t b = a; b < world->bodies.count; b++) {
            const int32_t p = brunt_pair_of(&world->pairs.map, a, b);
            brunt_gap_energy *energy = p < 0 ? NULL : brunt_contact_energy(world->pairs.pair[p].method);
            if (!energy) continue;
            if (c->pair) {
                c->pair[c->pair_count] =
                    (brunt_barrier_pair){.a = a, .b = b, .friction = world->pairs.pair[p].friction, .energy = energy};
                c->pair_account[c->pair_count] = p;
            }
            c->pair_count++;
        }
}

static void list_planes(brunt_implicit_contact *c, const brunt_boundaries *boundaries) {
    c->plane_count = 0;
    for (int32_t w = 0; w < boundaries->boundary_count; w++) {
        if (!brunt_boundary_pushes(&boundaries->boundary[w])) continue;
        if (c->plane) c->plane_boundary[c->plane_count] = w;
        c->plane_count++;
    }
}

static int reserve_arrays(brunt_implicit_contact *c, const brunt_world *world, brunt_error *error) {
    list_pairs(c, world);
    list_planes(c, &world->boundaries);
    const size_t pairs = (size_t)c->pair_count + 1, planes = (size_t)c->plane_count + 1;
    static const char of_pairs[] = "pairs of bodies and planes", of_planes[] = "planes that push";
    if (BRUNT_NEW(c->pair, pairs, of_pairs, error) || BRUNT_NEW(c->pair_account, pairs, of_pairs, error) ||
        BRUNT_NEW(c->plane, planes, of_planes, error) || BRUNT_NEW(c->plane_boundary, planes, of_planes, error) ||
        BRUNT_NEW(c->meets, planes, of_planes, error) || BRUNT_NEW(c->force, pairs + planes, of_pairs, error) ||
        BRUNT_NEW(c->force_before, pairs + planes, of_pairs, error) ||
        BRUNT_NEW(c->has_points, world->bodies.mpm_count + 1, "bodies of points", error) ||
        BRUNT_NEW(c->half, world->bodies.count + 1, "bodies", error))
        return BRUNT_FAILED;
    for (int32_t q = 0; q < c->plane_count; q++)
        if (BRUNT_NEW(c->meets[q], world->bodies.count, "bodies at a plane", error)) return BRUNT_FAILED;
    for (int k = 0; k < world->bodies.fem_count; k++)
        c->half[world->bodies.fem[k].index] = 0.5 * (double)world->bodies.fem[k].contact_thickness;
    list_pairs(c, world);
    list_planes(c, &world->boundaries);
    return BRUNT_OK;
}

// A tenth of the finest size among bodies that meet something, unless the definition says.
static double contact_distance(const brunt_implicit_contact *c, const brunt_bodies *bodies,
                               const brunt_contact_def *def) {
    double finest = INFINITY;
    if (def->distance > 0) return def->distance;
    for (int32_t p = 0; p < c->pair_count; p++)
        finest = fmin(finest, fmin(smallest_size(bodies, c->pair[p].a), smallest_size(bodies, c->pair[p].b)));
    for (int32_t q = 0; q < c->plane_count; q++)
        for (int b = 0; b < bodies->count; b++)
            if (c->meets[q][b]) finest = fmin(finest, smallest_size(bodies, b));
    return brunt_barrier_default_distance(finest);
}

static void fill_pairs(brunt_implicit_contact *c, const brunt_bodies *bodies, const brunt_world_def *def, double slip) {
    const brunt_contact_def *contact = &def->contact;
    for (int32_t p = 0; p < c->pair_count; p++) {
        brunt_barrier_pair *pair = &c->pair[p];
        pair->distance = c->distance;
        pair->slip_speed = slip;
        pair->offset = pair->a == pair->b ? 0 : c->half[pair->a] + c->half[pair->b];
        pair->stiffness = contact->stiffness > 0 ? contact->stiffness
                                                 : brunt_barrier_default_stiffness(young(def, bodies, pair->a),
                                                                                   young(def, bodies, pair->b));
        brunt_barrier_shares(pair, bodies->all[pair->a].fem != NULL, bodies->all[pair->b].fem != NULL);
        for (int side = 0; side < 2; side++) {
            const brunt_body *mpm = bodies->all[side ? pair->b : pair->a].mpm;
            if (mpm) c->has_points[mpm - bodies->mpm] = true;
        }
    }
}

static void fill_planes(brunt_implicit_contact *c, const brunt_world *world, const brunt_world_def *def, double slip) {
    for (int32_t q = 0; q < c->plane_count; q++) {
        const brunt_boundary *boundary = &world->boundaries.boundary[c->plane_boundary[q]];
        double softest = INFINITY;
        for (int b = 0; b < world->bodies.count; b++) {
            if (!c->meets[q][b]) continue;
            softest = fmin(softest, young(def, &world->bodies, b));
            const brunt_body *mpm = world->bodies.all[b].mpm;
            if (mpm) c->has_points[mpm - world->bodies.mpm] = true;
        }
        c->plane[q] = (brunt_barrier_plane){.node = -1,
                                            .meets = c->meets[q],
                                            .offset = c->half,
                                            .distance = c->distance,
                                            .stiffness = def->contact.stiffness,
                                            .friction = boundary->plane.friction,
                                            .slip_speed = slip,
                                            .energy = brunt_contact_energy(def->contact.method)};
        if (!(def->contact.stiffness > 0)) c->plane[q].stiffness = brunt_barrier_default_stiffness(softest, INFINITY);
        memcpy(c->plane[q].normal, boundary->plane.normal, sizeof c->plane[q].normal);
    }
}

// ------------------------------------------------------------------------------------------ surfaces

// Vertices and facets of one mesh; `number` has room for its nodes. With no room for facets it counts them.
static void add_surface(brunt_implicit_contact *c, const brunt_fem_body *fem, const brunt_faces *faces, int32_t base,
                        int32_t *number) {
    memset(number, 0xff, (size_t)fem->node_count * sizeof *number);
    for (int32_t f = 0; f < faces->count; f++)
        for (int k = 0; k < 4; k++)
            if (faces->node[f][k] >= 0) number[faces->node[f][k]] = 0;
    for (int32_t n = 0; n < fem->node_count; n++) {
        if (number[n] < 0) continue;
        if (c->facet) {
            for (int a = 0; a < 3; a++)
                c->rest[c->vertex_count][a] = a < fem->dim ? (double)fem->start[4 * (size_t)n + (size_t)a] : 0;
            c->body[c->vertex_count] = fem->index;
            c->node[c->vertex_count] = base + n;
        }
        number[n] = c->vertex_count++;
    }
    for (int32_t f = 0; c->facet && f < faces->count; f++)
        for (int k = 0; k < 4; k++)
            c->facet[c->facet_count + f][k] = faces->node[f][k] < 0 ? -1 : number[faces->node[f][k]];
    c->facet_count += faces->count;
}

static int walk_surfaces(brunt_implicit_contact *c, const brunt_bodies *bodies, brunt_error *error) {
    int32_t base = 0; // block nodes of meshes come first, body by body
    c->vertex_count = c->facet_count = 0;
    for (int k = 0; k < bodies->fem_count; k++) {
        const brunt_fem_body *fem = &bodies->fem[k];
        int32_t *number;
        brunt_faces faces;
        if (BRUNT_NEW(number, fem->node_count + 1, "numbers of nodes in a surface", error)) return BRUNT_FAILED;
        const int status = brunt_fem_faces(fem, &faces, error);
        if (status) {
            brunt_free(number);
            return status;
        }
        add_surface(c, fem, &faces, base, number);
        base += fem->node_count;
        brunt_faces_free(&faces);
        brunt_free(number);
    }
    return BRUNT_OK;
}

static int make_surfaces(brunt_implicit_contact *c, const brunt_world *world, brunt_error *error) {
    int status = walk_surfaces(c, &world->bodies, error);
    if (status) return status;
    const size_t vertices = (size_t)c->vertex_count + 1;
    static const char of_surfaces[] = "vertices of surfaces";
    if (BRUNT_NEW(c->rest, vertices, of_surfaces, error) || BRUNT_NEW(c->position, vertices, of_surfaces, error) ||
        BRUNT_NEW(c->body, vertices, of_surfaces, error) || BRUNT_NEW(c->node, vertices, of_surfaces, error) ||
        BRUNT_NEW(c->facet, c->facet_count + 1, "facets of surfaces", error))
        return BRUNT_FAILED;
    if ((status = walk_surfaces(c, &world->bodies, error))) return status;
    const brunt_barrier_mesh mesh = {.dim = world->settings.dimension,
                                     .vertex_count = c->vertex_count,
                                     .facet_count = c->facet_count,
                                     .rest = (const double(*)[3])c->rest,
                                     .body = c->body,
                                     .facet = (const int32_t(*)[4])c->facet};
    return brunt_barrier_set_mesh(c->barrier, &mesh, error);
}

// ------------------------------------------------------------------------------------------ the start

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

// Barriers know gaps, not insides: bodies must begin outside each other, as far as shapes can tell. `order`: the
// definitions by name, as the bodies of the world are.
static int check_shapes(const brunt_implicit_contact *c, const brunt_world *world, const brunt_body_def **order,
                        brunt_error *error) {
    for (int32_t q = 0; q < 2 * c->pair_count; q++) {
        const brunt_barrier_pair *pair = &c->pair[q / 2];
        const int one = q % 2 ? pair->b : pair->a, other = q % 2 ? pair->a : pair->b;
        const looked_at l = {&world->bodies.all[one], order[other], world->settings.dimension};
        double x[3], local[3];
        if (one == other || l.other->mesh.node_count || l.other->method != BRUNT_FEM) continue;
        for (int64_t n = 0; local_point(&l, n, x, local); n++)
            if (!(brunt_shape_distance(&l.other->shape, l.dim, local) > 0))
                return brunt_fail(error, BRUNT_BAD_INPUT,
                                  "bodies.%s touches bodies.%s at the start, or lies in it, at (%.6g, %.6g, %.6g) m: "
                                  "barriers want a gap of more than 0 m, of %.4g m to begin without a force",
                                  brunt_body_name(world, one), brunt_body_name(world, other), x[0], x[1], x[2],
                                  c->distance);
    }
    return BRUNT_OK;
}

static int check_start(const brunt_implicit_contact *c, const brunt_world *world, const brunt_world_def *def,
                       brunt_error *error) {
    const brunt_body_def **order;
    if (BRUNT_NEW(order, def->body_count + 1, "bodies in order of name", error)) return BRUNT_FAILED;
    for (int32_t i = 0; i < def->body_count; i++)
        order[brunt_bodies_find(&world->bodies, def->bodies[i].name)] = &def->bodies[i];
    const int status = check_shapes(c, world, order, error);
    brunt_free(order);
    return status;
}

// Material points that may meet something, and how many nodes they have in all.
static int count_points(const brunt_implicit_contact *c, const brunt_bodies *bodies, int32_t *points, int64_t *nodes,
                        brunt_error *error) {
    int64_t count = 0;
    *nodes = 0;
    for (int i = 0; i < bodies->mpm_count; i++) {
        const brunt_body *body = &bodies->mpm[i];
        if (!c->has_points[i]) continue;
        count += body->particles.count;
        *nodes += body->particles.count * (int64_t)pow(body->grid.order + 1, body->grid.dim);
    }
    *points = (int32_t)count;
    if (count < INT32_MAX) return BRUNT_OK;
    return brunt_fail(error, BRUNT_FAILED, "there are more than %d material points in contact", INT32_MAX - 1);
}

static int make_points(brunt_implicit_contact *c, const brunt_bodies *bodies, int32_t *count, int64_t *nodes,
                       brunt_error *error) {
    static const char points[] = "points in contact";
    if (count_points(c, bodies, count, nodes, error)) return BRUNT_FAILED;
    const size_t n = (size_t)*count + 1;
    if (BRUNT_CAPACITY(c->x, n, 0, points, error) || BRUNT_CAPACITY(c->area, n, 0, points, error) ||
        BRUNT_CAPACITY(c->owner, n, 0, points, error))
        return BRUNT_FAILED;
    return BRUNT_CAPACITY(c->first, n + 1, 0, points, error);
}

// Material points as they begin, which nothing moves yet.
static int place_points(brunt_implicit_contact *c, const brunt_bodies *bodies, brunt_error *error) {
    int64_t nodes;
    int32_t count;
    if (make_points(c, bodies, &count, &nodes, error)) return BRUNT_FAILED;
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
    for (int b = 0; b < bodies->count; b++) sum += bodies->all[b].ops->sums(&bodies->all[b]).kinetic;
    return sum;
}

// A closed gap has no energy that a step could begin with; one within the barrier pushes from the first step on.
static int check_gaps(brunt_implicit_contact *c, brunt_world *world, bool given, brunt_error *error) {
    brunt_barrier_report r;
    const int status = look_at_start(c, world, &r, error);
    if (status || !(r.least_gap < WITHIN * c->distance)) return status;
    char to[2 * BRUNT_NAME_LENGTH];
    if (r.plane >= 0)
        snprintf(to, sizeof to, "the plane '%s'", world->boundaries.boundary[c->plane_boundary[r.plane]].name);
    else
        snprintf(to, sizeof to, "bodies.%s", brunt_body_name(world, r.other));
    if (r.least_gap > 0) {
        brunt_warn(&world->messages,
                   "bodies.%s begins with a gap of %.4g m to %s, at (%.6g, %.6g, %.6g) m: within contact.distance, "
                   "%.4g m%s, barriers push; they store %.3g J at the start, all bodies move with %.3g J",
                   brunt_body_name(world, r.body), r.least_gap, to, r.position[0], r.position[1], r.position[2],
                   c->distance, given ? "" : " by default", r.energy, kinetic_energy(&world->bodies));
        return BRUNT_OK;
    }
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "bodies.%s has a gap of %.4g m to %s at the start, at (%.6g, %.6g, %.6g) m: barriers want more "
                      "than 0 m, %.4g m to begin without a force",
                      brunt_body_name(world, r.body), r.least_gap + 0.0, to, r.position[0], r.position[1],
                      r.position[2], c->distance);
}

// ------------------------------------------------------------------------------------------ making

int brunt_implicit_contact_make(brunt_implicit_contact *c, brunt_world *world, const brunt_world_def *def,
                                brunt_error *error) {
    int status = reserve_arrays(c, world, error);
    if (status || c->pair_count + c->plane_count == 0) return status;
    const double slip = def->contact.slip_speed > 0 ? def->contact.slip_speed : 1e-3 * slowest_wave(&world->bodies);
    for (int32_t q = 0; q < c->plane_count; q++)
        for (int b = 0; b < world->bodies.count; b++)
            c->meets[q][b] = plane_meets(&world->boundaries.boundary[c->plane_boundary[q]], b);
    c->distance = contact_distance(c, &world->bodies, &def->contact);
    fill_pairs(c, &world->bodies, def, slip);
    fill_planes(c, world, def, slip);
    if ((status = check_start(c, world, def, error))) return status;
    if (!(c->barrier = brunt_barrier_make(error))) return BRUNT_FAILED;
    status = make_surfaces(c, world, error);
    if (status || (status = brunt_barrier_set_pairs(c->barrier, c->pair, c->pair_count, error))) return status;
    return check_gaps(c, world, def->contact.distance > 0, error);
}

static void take_law(brunt_barrier_values *values, double stiffness, double friction, double slip) {
    values->stiffness[0] = fmin(values->stiffness[0], stiffness);
    values->stiffness[1] = fmax(values->stiffness[1], stiffness);
    if (friction > 0) values->slip_speed = slip;
}

bool brunt_world_barrier(const brunt_world *world, brunt_barrier_values *values) {
    if (!world->plan.implicit || !world->plan.implicit->contact.barrier) return false;
    const brunt_implicit_contact *c = &world->plan.implicit->contact;
    *values = (brunt_barrier_values){
        .distance = c->distance, .stiffness = {INFINITY, 0}, .slowest_wave = slowest_wave(&world->bodies)};
    for (int32_t p = 0; p < c->pair_count; p++)
        take_law(values, c->pair[p].stiffness, c->pair[p].friction, c->pair[p].slip_speed);
    for (int32_t q = 0; q < c->plane_count; q++)
        take_law(values, c->plane[q].stiffness, c->plane[q].friction, c->plane[q].slip_speed);
    return true;
}

void brunt_implicit_contact_free(brunt_implicit_contact *c) {
    brunt_barrier_free(c->barrier);
    for (int32_t q = 0; c->meets && q < c->plane_count; q++) brunt_free(c->meets[q]);
    void *const all[] = {
        c->rest,       c->position,     c->body,         c->node,        c->facet,          c->has_points,
        c->x,          c->area,         c->weight,       c->owner,       c->half,           c->first,
        c->point_node, c->pair,         c->pair_account, c->plane,       c->plane_boundary, c->meets,
        c->force,      c->force_before, c->before,       c->inverse_mass};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) brunt_free(all[k]);
    *c = (brunt_implicit_contact){.barrier = NULL};
}

size_t brunt_implicit_contact_bytes(const brunt_implicit_contact *c) {
    return (size_t)c->vertex_count * 56 + (size_t)c->facet_count * 16 + c->x_capacity + c->area_capacity +
           c->weight_capacity + c->owner_capacity + c->point_node_capacity + c->first_capacity + c->before_capacity +
           c->inverse_mass_capacity;
}

void brunt_implicit_contact_validate(const brunt_implicit_contact *c, int bodies, int boundaries, int pairs) {
    if (!c->barrier) return;
    brunt_barrier_validate(c->barrier);
    for (int32_t v = 0; v < c->vertex_count; v++)
        BRUNT_ASSERT(c->body[v] >= 0 && c->body[v] < bodies && c->node[v] >= 0);
    for (int32_t p = 0; p < c->pair_count; p++) {
        const brunt_barrier_pair *pair = &c->pair[p];
        BRUNT_ASSERT(pair->a >= 0 && pair->a <= pair->b && pair->b < bodies);
        BRUNT_ASSERT(c->pair_account[p] >= 0 && c->pair_account[p] < pairs);
    }
    for (int32_t q = 0; q < c->plane_count; q++)
        BRUNT_ASSERT(c->plane_boundary[q] >= 0 && c->plane_boundary[q] < boundaries);
    for (int32_t i = 0; i < c->point_count; i++)
        BRUNT_ASSERT(c->owner[i] >= 0 && c->owner[i] < bodies && c->first[i] <= c->first[i + 1]);
}

// ------------------------------------------------------------------------------------------ the points of a step

// Nodes and weights of a particle, those alone that are unknowns; returns how many.
static int weigh(const brunt_grid *grid, const brunt_block *block, int bin, const double x[3], const int32_t *number,
                 int32_t *node, double *weight) {
    double w[3][4];
    int from[3], count = 0;
    brunt_node_local(grid, bin, from);
    for (int a = 0; a < grid->dim; a++) {
        const double corner = grid->origin[a] + (double)grid->h * (block->coord[a] * grid->side + from[a]);
        brunt_bspline_weights(grid->order, (x[a] - corner) / (double)grid->h, w[a]);
    }
    const int deep = grid->dim == 3 ? grid->order : 0;
    for (int i = 0; i <= grid->order; i++)
        for (int j = 0; j <= grid->order; j++)
            for (int k = 0; k <= deep; k++) {
                const int at[3] = {from[0] + i, from[1] + j, from[2] + k};
                int corner = 0, local[3] = {0};
                for (int a = 0; a < grid->dim; a++) {
                    const int beyond = at[a] >= grid->side;
                    corner = 2 * corner + beyond, local[a] = at[a] - beyond * grid->side;
                }
                const int32_t n = number[(int64_t)block->slot[corner] * BRUNT_BLOCK_NODES +
                                         brunt_node_index(grid, local[0], local[1], local[2])];
                if (n < 0) continue;
                node[count] = n;
                weight[count++] = w[0][i] * w[1][j] * (grid->dim == 3 ? w[2][k] : 1);
            }
    return count;
}

typedef struct point_job {
    brunt_implicit_contact *c;
    brunt_body *body;
    const int32_t *number;
} point_job;

// The particles of a block, as points from number `point` on.
static void add_points(const point_job *job, int32_t block_index, int32_t point) {
    brunt_implicit_contact *c = job->c;
    const brunt_grid *grid = &job->body->grid;
    const brunt_block *block = &grid->blocks[block_index];
    brunt_particles *p = &job->body->particles;
    real *const *x = brunt_field(p, BRUNT_FIELD_position);
    const real *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    for (int64_t s = block->first; s < block->first + block->count; s++, point++) {
        const int64_t at = c->first[point];
        for (int a = 0; a < 3; a++) c->x[point][a] = a < p->dim ? (double)x[a][s] : 0;
        c->area[point] = brunt_barrier_particle_area(p->dim, (double)volume[s]);
        c->owner[point] = job->body->index;
        const int count = weigh(grid, block, p->bin[s], c->x[point], job->number, c->point_node + at, c->weight + at);
        c->first[point + 1] = at + count;
    }
}

int brunt_implicit_contact_points(brunt_implicit_contact *c, const brunt_bodies *bodies, const brunt_unknowns *u,
                                  brunt_error *error) {
    if (!c->barrier) return BRUNT_OK;
    int64_t nodes;
    int32_t count;
    if (make_points(c, bodies, &count, &nodes, error) ||
        BRUNT_CAPACITY(c->point_node, (size_t)nodes + 1, 0, "nodes of points in contact", error) ||
        BRUNT_CAPACITY(c->weight, (size_t)nodes + 1, 0, "nodes of points in contact", error))
        return BRUNT_FAILED;
    c->first[0] = 0;
    c->point_count = 0;
    for (int i = 0; i < bodies->mpm_count; i++) {
        const point_job job = {.c = c, .body = &bodies->mpm[i], .number = u->number[i]};
        for (int32_t b = 0; c->has_points[i] && b < job.body->grid.block_count; b++) {
            add_points(&job, b, c->point_count);
            c->point_count += job.body->grid.blocks[b].count;
        }
    }
    for (int32_t v = 0; v < c->vertex_count; v++) {
        const int32_t unknown = c->node[v];
        for (int a = 0; a < u->dim; a++) c->position[v][a] = u->position[unknown * (int64_t)u->dim + a];
    }
    return BRUNT_OK;
}

// How lightly nodes move, with their images; those that are given do not. It is not asked of backward Euler, nor once
// it has been said that a step is too long.
static int take_inverse_mass(brunt_implicit_contact *c, const brunt_unknowns *u, brunt_error *error) {
    const double *images = u->images.any ? u->images.mass : NULL;
    if (BRUNT_CAPACITY(c->inverse_mass, (size_t)u->count + 1, 0, "unknowns", error)) return BRUNT_FAILED;
    for (int32_t n = 0; n < u->count; n++) {
        const int32_t leader = images ? u->images.leader[n] : n;
        double mass = images ? 0 : u->mass[n];
        bool moves = false;
        for (int a = 0; a < u->dim; a++) {
            moves = moves || !u->held[n * (int64_t)u->dim + a];
            if (images) mass = fmax(mass, images[leader * (int64_t)u->dim + a]);
        }
        c->inverse_mass[n] = moves && mass > 0 ? 1 / mass : 0;
    }
    return BRUNT_OK;
}

int brunt_implicit_contact_begin(brunt_implicit_contact *c, const brunt_world *world, const brunt_unknowns *u,
                                 const brunt_team *team, const brunt_contact_rule *rule, brunt_error *error) {
    if (!c->barrier) return BRUNT_OK;
    const int64_t all = (int64_t)u->count * u->dim;
    if (BRUNT_CAPACITY(c->before, (size_t)all + 1, 0, "unknowns", error)) return BRUNT_FAILED;
    for (int64_t k = 0; k < all; k++) c->before[k] = rule->dt * u->velocity[k];
    const bool asks = rule->factor != 1 && !world->clock.chatter_told;
    if (asks && take_inverse_mass(c, u, error)) return BRUNT_FAILED;
    for (int32_t q = 0; q < c->plane_count; q++) {
        const brunt_plane_def *plane = &world->boundaries.boundary[c->plane_boundary[q]].plane;
        c->plane[q].node = u->plane[c->plane_boundary[q]];
        for (int a = 0; a < 3; a++) c->plane[q].origin[a] = plane->point[a] + plane->velocity[a] * world->clock.time;
    }
    const brunt_barrier_step step = {.x = (const double(*)[3])c->position,
                                     .node = c->node,
                                     .particles = {.count = c->point_count,
                                                   .x = (const double(*)[3])c->x,
                                                   .area = c->area,
                                                   .body = c->owner,
                                                   .first = c->first,
                                                   .node = c->point_node,
                                                   .weight = c->weight},
                                     .planes = c->plane,
                                     .plane_count = c->plane_count,
                                     .dt = rule->dt,
                                     .factor = rule->factor,
                                     .before = rule->factor == 1 ? NULL : c->before,
                                     .inverse_mass = asks ? c->inverse_mass : NULL};
    const int status = brunt_barrier_set_step(c->barrier, &step, error);
    if (status || !brunt_barrier_has_friction(c->barrier)) return status;
    return brunt_barrier_lag(c->barrier, team, rule->rest, error);
}
