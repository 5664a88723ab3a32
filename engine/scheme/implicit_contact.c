// Surfaces, particles and planes that barriers keep apart.
#include "boundary/kinds.h"
#include "contact/methods/method.h"
#include "contact/planes/condition.h"
#include "scheme/implicit.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "contact/barrier/barrier_function.h"
#include "grid/bspline.h"
#include "grid/weigh.h"
#include "materials/material.h"

static const double CREEP = 1e-5; // of the slowest wave speed: the slip speed by default
static const double GIVES = 0.01; // of the distance: the slip length of load steps by default
static const double HALF = 0.5;   // of the finest size: how deep surfaces may overlap

// ------------------------------------------------------------------------------------------ stiffness and distance

// A parameter of a material's strength; 0: it has none of that name.
static double parameter(const brunt_material_def *from, const char *key) {
    const brunt_model *model = brunt_find_strength(from->strength);
    for (int k = 0; model && k < model->parameter_count; k++)
        if (!strcmp(model->parameters[k].key, key)) return from->strength_parameters[k];
    return 0;
}

// [Pa] Young's modulus, or of what has none that of its waves.
static double young(const brunt_material_def *from, const brunt_material *material) {
    const double own = parameter(from, "E");
    return own > 0 ? own : (double)material->density * (double)material->wave_speed * (double)material->wave_speed;
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

// [Pa] what planes push a body with, or two bodies each other.
static double stiffness_of(const brunt_implicit_contact *c, double young_a, double young_b) {
    return c->stiffness > 0 ? c->stiffness : brunt_barrier_default_stiffness(young_a, young_b);
}

// [Pa/m] By how deep they overlap, where they may; a plane's modulus is INFINITY.
static double penalty_of(const brunt_implicit_contact *c, double modulus_a, double modulus_b) {
    return c->penalty > 0 ? c->penalty : brunt_penalty_default_stiffness(modulus_a, modulus_b, c->width);
}

// What two bodies are to each other, made when it is asked: of many bodies few are ever near each other.
bool brunt_implicit_contact_pair(const void *self, int32_t a, int32_t b, brunt_barrier_pair *pair) {
    const brunt_implicit_contact *c = self;
    const int32_t p = brunt_pair_of(&c->pairs->map, a, b);
    brunt_gap_energy *energy = p < 0 ? NULL : brunt_contact_energy(c->pairs->pair[p].method);
    if (!energy) return false;
    const bool overlaps = brunt_contact_overlaps(c->pairs->pair[p].method);
    *pair = (brunt_barrier_pair){.a = a,
                                 .b = b,
                                 .account = p,
                                 .distance = overlaps ? c->overlap_distance : c->distance,
                                 .offset = a == b ? 0 : c->half[a] + c->half[b],
                                 .stiffness = overlaps ? penalty_of(c, c->modulus[a], c->modulus[b])
                                                       : stiffness_of(c, c->young[a], c->young[b]),
                                 .reach = overlaps ? c->reach : 0,
                                 .friction = c->pairs->pair[p].friction,
                                 .slip_speed = c->slip_speed,
                                 .energy = energy};
    brunt_barrier_shares(pair, c->pairs->mesh[a], c->pairs->mesh[b]);
    return true;
}

// How far apart surfaces may be that push, and whether any rub.
static brunt_barrier_pair_source pair_source(const brunt_implicit_contact *c, int bodies) {
    brunt_barrier_pair_source source = {.between = brunt_implicit_contact_pair, .self = c};
    double thickest = 0;
    for (int b = 0; b < bodies; b++) thickest = fmax(thickest, 2 * c->half[b]);
    source.range = fmax(c->distance, 2 * c->reach) + thickest;
    for (int p = 0; p < c->pairs->count; p++)
        source.friction =
            source.friction || (c->pairs->pair[p].friction > 0 && brunt_contact_energy(c->pairs->pair[p].method));
    return source;
}

// Which bodies meet anything.
static int find_met(brunt_implicit_contact *c, int bodies, brunt_error *error) {
    bool *wanted;
    if (BRUNT_NEW(wanted, c->pairs->count + 1, "pairs of bodies", error)) return BRUNT_FAILED;
    for (int p = 0; p < c->pairs->count; p++) wanted[p] = brunt_contact_energy(c->pairs->pair[p].method) != NULL;
    const int status = brunt_pair_map_met(&c->pairs->map, bodies, wanted, c->met, error);
    brunt_free(wanted);
    return status;
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
    const int bodies = world->bodies.count;
    list_planes(c, &world->boundaries);
    const size_t planes = (size_t)c->plane_count + 1;
    static const char of_planes[] = "planes that push";
    if (BRUNT_NEW(c->plane, planes, of_planes, error) || BRUNT_NEW(c->plane_boundary, planes, of_planes, error) ||
        BRUNT_NEW(c->meets, planes, of_planes, error) || BRUNT_NEW(c->plane_modulus, planes, of_planes, error) ||
        BRUNT_NEW(c->has_points, world->bodies.mpm_count + 1, "bodies of points", error) ||
        BRUNT_NEW(c->met, bodies + 1, "bodies", error) || BRUNT_NEW(c->young, bodies + 1, "bodies", error) ||
        BRUNT_NEW(c->modulus, bodies + 1, "bodies", error) || BRUNT_NEW(c->half, bodies + 1, "bodies", error))
        return BRUNT_FAILED;
    for (int32_t q = 0; q < c->plane_count; q++)
        if (BRUNT_NEW(c->meets[q], bodies, "bodies at a plane", error)) return BRUNT_FAILED;
    list_planes(c, &world->boundaries);
    return BRUNT_OK;
}

// Of each body what its pairs and planes are made from.
static int describe_bodies(brunt_implicit_contact *c, const brunt_world *world, const brunt_world_def *def,
                           const brunt_body_def **order, brunt_error *error) {
    const brunt_bodies *bodies = &world->bodies;
    if (find_met(c, bodies->count, error)) return BRUNT_FAILED;
    for (int k = 0; k < bodies->fem_count; k++)
        c->half[bodies->fem[k].index] = 0.5 * (double)bodies->fem[k].contact_thickness;
    for (int b = 0; b < bodies->count; b++) {
        const brunt_material_def *material = &def->materials[order[b]->material];
        const double nu = parameter(material, "nu");
        c->young[b] = young(material, brunt_bodies_material(bodies, b));
        c->modulus[b] = c->young[b] / (1 - nu * nu);
    }
    for (int32_t q = 0; q < c->plane_count; q++)
        for (int b = 0; b < bodies->count; b++)
            c->meets[q][b] = plane_meets(&world->boundaries.boundary[c->plane_boundary[q]], b);
    for (int i = 0; i < bodies->mpm_count; i++) {
        const int b = bodies->mpm[i].index;
        c->has_points[i] = c->met[b];
        for (int32_t q = 0; q < c->plane_count; q++) c->has_points[i] = c->has_points[i] || c->meets[q][b];
    }
    return BRUNT_OK;
}

// [m] The finest size among bodies that meet something.
static double finest_size(const brunt_implicit_contact *c, const brunt_bodies *bodies) {
    double finest = INFINITY;
    for (int b = 0; b < bodies->count; b++) {
        bool meets = c->met[b];
        for (int32_t q = 0; q < c->plane_count; q++) meets = meets || c->meets[q][b];
        if (meets) finest = fmin(finest, smallest_size(bodies, b));
    }
    return finest;
}

// Whether some surfaces, or some surfaces and planes, may overlap, or may not.
static bool any_overlaps(const brunt_implicit_contact *c, const brunt_world_def *def, bool overlaps) {
    bool any = c->plane_count > 0 && brunt_contact_overlaps(def->contact.method) == overlaps;
    for (int p = 0; p < c->pairs->count; p++)
        any = any || (brunt_contact_energy(c->pairs->pair[p].method) &&
                      brunt_contact_overlaps(c->pairs->pair[p].method) == overlaps);
    return any;
}

// Where contact begins and, of load steps, how far surfaces give: a tenth of the finest size and a hundredth of that,
// unless the definition says; what may overlap begins to push where it does.
static void take_lengths(brunt_implicit_contact *c, const brunt_bodies *bodies, const brunt_world_def *def) {
    const brunt_contact_def *contact = &def->contact;
    const double finest = finest_size(c, bodies);
    c->width = finest, c->reach = any_overlaps(c, def, true) ? HALF * finest : 0;
    c->opens = any_overlaps(c, def, false);
    c->distance = contact->distance > 0 ? contact->distance : brunt_barrier_default_distance(finest);
    c->overlap_distance = contact->distance;
    c->slip_speed = contact->slip_speed > 0 ? contact->slip_speed : CREEP * slowest_wave(bodies);
    if (def->scheme == BRUNT_STATIC)
        c->slip_speed = contact->slip_length > 0 ? contact->slip_length : GIVES * c->distance;
}

static void fill_planes(brunt_implicit_contact *c, const brunt_world *world, const brunt_world_def *def) {
    for (int32_t q = 0; q < c->plane_count; q++) {
        const brunt_boundary *boundary = &world->boundaries.boundary[c->plane_boundary[q]];
        double softest = INFINITY, *modulus = &c->plane_modulus[q];
        *modulus = INFINITY;
        for (int b = 0; b < world->bodies.count; b++)
            if (c->meets[q][b]) softest = fmin(softest, c->young[b]), *modulus = fmin(*modulus, c->modulus[b]);
        const bool overlaps = brunt_contact_overlaps(def->contact.method);
        c->plane[q] = (brunt_barrier_plane){.node = -1,
                                            .meets = c->meets[q],
                                            .offset = c->half,
                                            .distance = overlaps ? c->overlap_distance : c->distance,
                                            .stiffness = overlaps ? penalty_of(c, *modulus, INFINITY)
                                                                  : stiffness_of(c, softest, INFINITY),
                                            .reach = overlaps ? c->reach : 0,
                                            .friction = boundary->plane.friction,
                                            .slip_speed = c->slip_speed,
                                            .energy = brunt_contact_energy(def->contact.method)};
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

static int make_surfaces(brunt_implicit_contact *c, const brunt_world *world, bool round, brunt_error *error) {
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
                                     .facet = (const int32_t(*)[4])c->facet,
                                     .overlaps = c->reach > 0,
                                     .round = round};
    return brunt_barrier_set_mesh(c->barrier, &mesh, error);
}

// ------------------------------------------------------------------------------------------ making

// The bodies' definitions in the order of the world's bodies.
static int order_bodies(const brunt_bodies *bodies, const brunt_world_def *def, const brunt_body_def ***order,
                        brunt_error *error) {
    if (BRUNT_NEW(*order, def->body_count + 1, "bodies in order of name", error)) return BRUNT_FAILED;
    for (int32_t i = 0; i < def->body_count; i++)
        (*order)[brunt_bodies_find(bodies, def->bodies[i].name)] = &def->bodies[i];
    return BRUNT_OK;
}

static int make_barrier(brunt_implicit_contact *c, brunt_world *world, const brunt_world_def *def,
                        const brunt_body_def **order, brunt_error *error) {
    bool meets = c->plane_count > 0;
    int status = describe_bodies(c, world, def, order, error);
    if (status) return status;
    for (int b = 0; b < world->bodies.count; b++) meets = meets || c->met[b];
    if (!meets) return BRUNT_OK;
    c->stiffness = def->contact.stiffness;
    c->penalty = def->contact.penalty;
    take_lengths(c, &world->bodies, def);
    fill_planes(c, world, def);
    if (!(c->barrier = brunt_barrier_make(error))) return BRUNT_FAILED;
    const bool round = def->contact.surface == BRUNT_SURFACE_ARCS;
    if ((status = make_surfaces(c, world, round, error))) return status;
    if (def->scheme == BRUNT_STATIC && brunt_friction_in_load_steps(def) &&
        (status = brunt_barrier_keep_slips(c->barrier, error)))
        return status;
    const brunt_barrier_pair_source source = pair_source(c, world->bodies.count);
    brunt_barrier_set_pairs(c->barrier, &source);
    return brunt_implicit_contact_check(c, world, order, def->contact.distance > 0, error);
}

int brunt_implicit_contact_make(brunt_implicit_contact *c, brunt_world *world, const brunt_world_def *def,
                                brunt_error *error) {
    const brunt_body_def **order = NULL;
    c->pairs = &world->pairs;
    int status = reserve_arrays(c, world, error);
    if (!status) status = order_bodies(&world->bodies, def, &order, error);
    if (!status) status = make_barrier(c, world, def, order, error);
    brunt_free((void *)order);
    return status;
}

static void take_stiffness(double range[2], double stiffness) {
    range[0] = fmin(range[0], stiffness), range[1] = fmax(range[1], stiffness);
}

// Of two bodies the softer one counts: no pair is softer than the softest body, nor stiffer than the second stiffest,
// but for a body with itself.
static void take_pairs(brunt_barrier_values *values, const brunt_implicit_contact *c, int bodies) {
    double softest = INFINITY, stiffest[2] = {0, 0}, least[2] = {INFINITY, INFINITY}, most[2] = {0, 0};
    brunt_barrier_pair itself;
    for (int b = 0; b < bodies; b++) {
        if (!c->met[b]) continue;
        softest = fmin(softest, c->young[b]);
        least[1] = fmin(least[1], fmax(least[0], c->modulus[b])), least[0] = fmin(least[0], c->modulus[b]);
        stiffest[1] = fmax(stiffest[1], fmin(stiffest[0], c->young[b]));
        stiffest[0] = fmax(stiffest[0], c->young[b]);
        most[1] = fmax(most[1], fmin(most[0], c->modulus[b])), most[0] = fmax(most[0], c->modulus[b]);
        if (brunt_implicit_contact_pair(c, b, b, &itself)) take_stiffness(values->stiffness, itself.stiffness);
    }
    if (softest == INFINITY) return;
    if (c->reach > 0 && most[1] > 0) {
        take_stiffness(values->penalty, penalty_of(c, least[0], least[1]));
        take_stiffness(values->penalty, penalty_of(c, most[0], most[1]));
    }
    take_stiffness(values->stiffness, stiffness_of(c, softest, INFINITY));
    take_stiffness(values->stiffness, stiffness_of(c, stiffest[1] > 0 ? stiffest[1] : softest, INFINITY));
}

bool brunt_world_barrier(const brunt_world *world, brunt_barrier_values *values) {
    if (!world->plan.implicit || !world->plan.implicit->contact.barrier) return false;
    const brunt_implicit_contact *c = &world->plan.implicit->contact;
    *values = (brunt_barrier_values){.distance = c->opens ? c->distance : c->overlap_distance,
                                     .stiffness = {INFINITY, 0},
                                     .penalty = {INFINITY, 0},
                                     .width = c->penalty > 0 ? 0 : c->width,
                                     .seen = c->seen,
                                     .slowest_wave = slowest_wave(&world->bodies)};
    take_pairs(values, c, world->bodies.count);
    for (int32_t q = 0; q < c->plane_count; q++)
        take_stiffness(c->plane[q].reach > 0 ? values->penalty : values->stiffness, c->plane[q].stiffness);
    if (!c->opens) values->stiffness[0] = values->stiffness[1] = 0;
    if (brunt_barrier_has_friction(c->barrier))
        *(brunt_world_static(world) ? &values->slip_length : &values->slip_speed) = c->slip_speed;
    return true;
}

void brunt_implicit_contact_widen(brunt_implicit_contact *c, double width) {
    c->width = width > 0 ? width : c->reach / HALF, c->seen = width > 0;
    for (int32_t q = 0; q < c->plane_count; q++)
        if (c->plane[q].reach > 0) c->plane[q].stiffness = penalty_of(c, c->plane_modulus[q], INFINITY);
}

double brunt_implicit_contact_width(const brunt_implicit_contact *c, const brunt_barrier_forces *forces) {
    double length = 0;
    int32_t count = 0;
    for (int32_t k = 0; k < forces->count; k++) {
        const brunt_barrier_force *f = &forces->force[k];
        if (!(fabs(f->normal[0]) + fabs(f->normal[1]) > 0)) continue;
        length += f->area, count++;
    }
    return count > 0 ? fmax(length / (2 * count), c->reach / HALF) : 0;
}

void brunt_implicit_contact_free(brunt_implicit_contact *c) {
    brunt_barrier_free(c->barrier);
    for (int32_t q = 0; c->meets && q < c->plane_count; q++) brunt_free(c->meets[q]);
    void *const all[] = {c->rest,  c->position,      c->body,       c->node,        c->facet,          c->has_points,
                         c->x,     c->area,          c->modulus,    c->weight,      c->owner,          c->half,
                         c->first, c->young,         c->point_node, c->met,         c->plane_boundary, c->meets,
                         c->plane, c->plane_modulus, c->before,     c->inverse_mass};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) brunt_free(all[k]);
    brunt_barrier_forces_free(&c->forces), brunt_barrier_forces_free(&c->forces_before);
    brunt_barrier_tractions_free(&c->tractions);
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
    int32_t count;
    const brunt_barrier_pair *pair = brunt_barrier_pairs(c->barrier, &count);
    for (int32_t p = 0; p < count; p++) {
        BRUNT_ASSERT(pair[p].b < bodies && c->met[pair[p].a] && c->met[pair[p].b]);
        BRUNT_ASSERT(pair[p].account >= 0 && pair[p].account < pairs);
    }
    for (int32_t q = 0; q < c->plane_count; q++)
        BRUNT_ASSERT(c->plane_boundary[q] >= 0 && c->plane_boundary[q] < boundaries);
    for (int32_t i = 0; i < c->point_count; i++)
        BRUNT_ASSERT(c->owner[i] >= 0 && c->owner[i] < bodies && c->first[i] <= c->first[i + 1]);
}

// ------------------------------------------------------------------------------------------ the points of a step

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

int brunt_implicit_contact_reserve(brunt_implicit_contact *c, const brunt_bodies *bodies, int32_t *count,
                                   int64_t *nodes, brunt_error *error) {
    static const char points[] = "points in contact";
    if (count_points(c, bodies, count, nodes, error)) return BRUNT_FAILED;
    const size_t n = (size_t)*count + 1;
    if (BRUNT_CAPACITY(c->x, n, 0, points, error) || BRUNT_CAPACITY(c->area, n, 0, points, error) ||
        BRUNT_CAPACITY(c->owner, n, 0, points, error))
        return BRUNT_FAILED;
    return BRUNT_CAPACITY(c->first, n + 1, 0, points, error);
}

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

// The same of triangles.
static int weigh_in_triangle(const brunt_grid *grid, const double x[3], const int32_t *number, int32_t *node,
                             double *weight) {
    brunt_grid_weights at;
    int count = 0;
    brunt_grid_weigh(grid, x, 1, &at);
    for (int k = 0; k < at.count; k++) {
        const int64_t place = brunt_grid_number(grid, at.at[k]);
        if (place < 0 || number[place] < 0 || !(at.weight[k] > 0)) continue;
        node[count] = number[place], weight[count++] = at.weight[k];
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
        const int count =
            grid->kernel > BRUNT_CUBIC
                ? weigh_in_triangle(grid, c->x[point], job->number, c->point_node + at, c->weight + at)
                : weigh(grid, block, p->bin[s], c->x[point], job->number, c->point_node + at, c->weight + at);
        c->first[point + 1] = at + count;
    }
}

int brunt_implicit_contact_points(brunt_implicit_contact *c, const brunt_bodies *bodies, const brunt_unknowns *u,
                                  brunt_error *error) {
    if (!c->barrier) return BRUNT_OK;
    int64_t nodes;
    int32_t count;
    if (brunt_implicit_contact_reserve(c, bodies, &count, &nodes, error) ||
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
