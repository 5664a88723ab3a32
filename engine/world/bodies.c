// The bodies of a definition, and those of material points.
#include <math.h>
#include <string.h>

#include "contact/methods/method.h"
#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/sweep.h"
#include "geometry/axis.h"
#include "geometry/fill.h"
#include "mpm/sort.h"
#include "world/create.h"

static const double TOUCHING = 1e-6; // spacings: bodies closer than that touch, they do not overlap

static double lattice_spacing(const brunt_world_def *def, const brunt_body_def *body) {
    int per_cell = body->particles_per_cell > 0 ? body->particles_per_cell : def->dimension == 3 ? 8 : 4;
    return body->spacing > 0 ? body->spacing : def->cell / round(pow(per_cell, 1.0 / def->dimension));
}

// ------------------------------------------------------------------------------------------ bodies

void brunt_start_motion(const brunt_body_def *def, int dim, const double x[3], double v[3], double gradient[3][3]) {
    double phase = def->wave_phase, r[3];
    for (int a = 0; a < 3; a++) phase += def->wave_vector[a] * x[a], r[a] = x[a] - def->spin_about[a];
    const double *w = def->spin;
    double turn[3][3] = {{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}};
    for (int a = 0; a < 3; a++) {
        v[a] = def->velocity[a] + def->wave_velocity[a] * sin(phase);
        for (int b = 0; b < dim; b++) {
            v[a] += turn[a][b] * r[b];
            gradient[a][b] = turn[a][b] + def->wave_velocity[a] * cos(phase) * def->wave_vector[b];
        }
    }
}

// How far a particle reaches that is at a distance from the body's surface, which is told up to half the diagonal of
// its cell (geometry/fill.h). What is inside a fluid comes to its surface later, and so does what is inside a body that
// erodes: there is a particle's own material about it, no more. Of a body that erodes those in the outermost layer keep
// their distance: it says where the surface is that there is now.
static double particle_extent(const brunt_body *body, double distance) {
    const double own = 0.5 * body->spacing, told = own * sqrt(body->particles.dim);
    if (body->material.model[BRUNT_STRENGTH]->fluid) return fmin(distance, own);
    return body->erodes && distance >= (1 - 1e-6) * told ? own : distance;
}

static int fill_body(const brunt_body_def *def, const brunt_filled *filled, brunt_body *body, brunt_error *error) {
    brunt_particles *p = &body->particles;
    const int dim = p->dim;
    if (brunt_particles_reserve(p, filled->count, error)) return BRUNT_FAILED;
    p->count = p->slots = p->made = filled->count;
    const bool axisymmetric = brunt_axisymmetric(p);
    body->particle_mass = (real)(filled->volume * (double)body->material.density * (axisymmetric ? 2 * M_PI : 1));
    real **x = brunt_field(p, BRUNT_FIELD_position), **v = brunt_field(p, BRUNT_FIELD_velocity),
         **C = brunt_field(p, BRUNT_FIELD_affine);
    real **F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    bool affine = p->field[BRUNT_FIELD_affine].components > 0, reach = p->field[BRUNT_FIELD_reach].components > 0;
    for (int64_t s = 0; s < p->count; s++) {
        double at[3] = {0}, speed[3], gradient[3][3] = {{0}};
        for (int a = 0; a < dim; a++) at[a] = filled->position[a][s];
        brunt_start_motion(def, dim, at, speed, gradient);
        p->id[s] = s;
        // Of a ring, 2 pi times the integral of r over its square: exact.
        const double volume = filled->volume * (axisymmetric ? 2 * M_PI * at[0] : 1);
        if (!(volume > 0)) REFUSE("bodies.%s: a particle at r = %g m: " BRUNT_CUT_AT_AXIS, def->name, at[0]);
        brunt_field(p, BRUNT_FIELD_mass)[0][s] = (real)(volume * (double)body->material.density);
        brunt_field(p, BRUNT_FIELD_reference_volume)[0][s] = (real)volume;
        if (reach) brunt_field(p, BRUNT_FIELD_reach)[0][s] = (real)particle_extent(body, filled->reach[s]);
        for (int a = 0; a < 3 && body->material.rest_stress != 0; a++)
            brunt_field(p, BRUNT_FIELD_kirchhoff_stress)[a][s] = body->material.rest_stress;
        if (axisymmetric) F[8][s] = 1;
        for (int a = 0; a < dim; a++) {
            x[a][s] = (real)at[a];
            if (brunt_total_lagrangian(p)) brunt_kernel_position(p)[a][s] = (real)at[a];
            v[a][s] = (real)speed[a];
            for (int b = 0; b < dim; b++) {
                F[a * p->point_dim + b][s] = a == b;
                if (affine) C[a * dim + b][s] = (real)gradient[a][b];
            }
        }
    }
    for (int f = BRUNT_BASE_FIELDS; f < p->field_count; f++) {
        const brunt_particle_field *field = &p->field[f];
        const brunt_state_field *state = &field->model->state[field->state];
        int component = 0;
        while (body->material.model[component] != field->model) component++;
        for (int c = 0; c < field->components; c++) {
            real value = state->initial ? state->initial(body->material.constants[component], c) : 0;
            if (!strcmp(state->name, "temperature") && def->temperature > 0) value = (real)def->temperature;
            for (int64_t s = 0; s < p->count; s++) p->scalar[field->first + c][s] = value;
        }
    }
    return BRUNT_OK;
}

// Deepest overlap of body `a`'s particles with shape `b` [m]; a particle's reach is material.
static double overlap_depth(const brunt_filled *a, const brunt_body_def *b, int dim) {
    double deepest = 0;
    for (int32_t i = 0; i < a->count; i++) {
        double local[3] = {0};
        for (int k = 0; k < 3; k++)
            for (int r = 0; r < 3; r++)
                local[k] +=
                    b->place.rotation[3 * r + k] * ((r < dim ? a->position[r][i] : 0) - b->place.translation[r]);
        deepest = fmax(deepest, a->reach[i] - brunt_shape_distance(&b->shape, dim, local));
    }
    return deepest;
}

// Bounds of a body's particles with what they reach [m].
static brunt_box box_of_particles(const brunt_filled *filled, int dim, double spacing) {
    brunt_box box = {{0}, {0}};
    for (int a = 0; a < dim; a++) box.low[a] = INFINITY, box.high[a] = -INFINITY;
    for (int32_t i = 0; i < filled->count; i++)
        for (int a = 0; a < dim; a++) {
            const double reach = filled->reach[i] + spacing, x = filled->position[a][i];
            box.low[a] = fmin(box.low[a], x - reach), box.high[a] = fmax(box.high[a], x + reach);
        }
    return box;
}

brunt_box brunt_box_of_shape(const brunt_body_def *body, int dim) {
    double low[3] = {0}, high[3] = {0};
    brunt_box box = {{0}, {0}};
    const bool bounded = brunt_shape_bounds(&body->shape, dim, low, high);
    for (int a = 0; a < dim; a++) box.low[a] = bounded ? INFINITY : -INFINITY, box.high[a] = -box.low[a];
    for (int corner = 0; bounded && corner < 1 << dim; corner++)
        for (int a = 0; a < dim; a++) {
            double x = body->place.translation[a];
            for (int k = 0; k < dim; k++) x += body->place.rotation[3 * a + k] * (corner >> k & 1 ? high[k] : low[k]);
            box.low[a] = fmin(box.low[a], x), box.high[a] = fmax(box.high[a], x);
        }
    return box;
}

// Of a membrane the shape is only what it is wrapped around, and a mesh that is given has none.
static bool fills_its_shape(const brunt_body_def *body) {
    return !body->mesh.node_count && body->method != BRUNT_MEMBRANE;
}

// What lies in another body by no more than its particles' reach is outside it for implicit steps, which know centres.
static int refuse_overlap(const brunt_filled *a, const char *name, const char *other, double depth,
                          brunt_error *error) {
    double reach = 0;
    for (int32_t i = 0; i < a->count; i++) reach = fmax(reach, a->reach[i]);
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "bodies.%s overlaps bodies.%s by %.4g m at the start%s; move one of them, or write "
                      "contact.initial_overlap: allow",
                      name, other, depth, depth < reach ? BRUNT_POINTS_REACH : "");
}

// Refuses particles of one body in the shape of another that it meets. Only where boxes share something is looked.
static int check_overlap(const brunt_pairs *pairs, const brunt_world_def *def, const brunt_body_def **order,
                         const brunt_filled *filled, brunt_error *error) {
    const int n = def->body_count, dim = def->dimension;
    brunt_box *box;
    if (BRUNT_NEW(box, 2 * n, "boxes about bodies", error)) return BRUNT_FAILED;
    for (int i = 0; i < n; i++) {
        box[i] = box_of_particles(&filled[i], dim, lattice_spacing(def, order[i]));
        box[n + i] = brunt_box_of_shape(order[i], dim);
    }
    brunt_box_pair *near;
    int64_t count;
    int status = brunt_sweep(box, n, 2 * n, &near, &count, error);
    for (int64_t q = 0; q < count && !status; q++) {
        const int i = near[q].a, k = near[q].b - n;
        if (k < 0 || i == k || brunt_pair_of(&pairs->map, i, k) < 0 || !fills_its_shape(order[k])) continue;
        double depth = overlap_depth(&filled[i], order[k], dim);
        if (depth > TOUCHING * lattice_spacing(def, order[i]))
            status = refuse_overlap(&filled[i], order[i]->name, order[k]->name, depth, error);
    }
    brunt_free(near);
    brunt_free(box);
    return status;
}

// Particles of the bodies that are made of them, and the lowest of their coordinates. Bodies of meshes stay empty.
static int fill_shapes(brunt_pairs *pairs, const brunt_world_def *def, const brunt_body_def **order,
                       brunt_filled *filled, double low[3], brunt_error *error) {
    const int n = def->body_count, dim = def->dimension;
    int status = BRUNT_OK;
    for (int i = 0; i < n && !status; i++) {
        if (order[i]->method != BRUNT_MPM) continue;
        status = brunt_fill_shape(order[i], dim, lattice_spacing(def, order[i]), &filled[i], error);
        for (int32_t k = 0; !status && k < filled[i].count; k++)
            for (int a = 0; a < dim; a++) low[a] = fmin(low[a], filled[i].position[a][k]);
    }
    // Barriers look at points alone (scheme/implicit_contact.c).
    if (!status && !def->contact.allow_overlap && def->scheme == BRUNT_EXPLICIT)
        status = check_overlap(pairs, def, order, filled, error);
    return status;
}

// What needs the bodies' grids at one place in space is not for bodies whose grids are undeformed.
static int check_total_lagrangian(const brunt_world *world, const brunt_world_def *def, const brunt_body_def **order,
                                  const brunt_body *body, brunt_error *error) {
    const brunt_body_def *from = order[body->index];
    if (def->axisymmetric) REFUSE("bodies.%s.lagrangian: total: not in axisymmetric scenes", from->name);
    if (!world->transfers.total_g2p)
        REFUSE(
            "bodies.%s.lagrangian: total: kernel linear has gradients that jump between cells; use quadratic or cubic",
            from->name);
    if (body->material.model[BRUNT_STRENGTH]->fluid)
        REFUSE("bodies.%s.lagrangian: total: material '%s' is a fluid: it has no undeformed configuration", from->name,
               body->material.name);
    for (int k = 0; k < def->body_count; k++) {
        const brunt_body_def *other = order[k];
        const int32_t pair = other == from ? -1 : brunt_pair_of(&world->pairs.map, body->index, k);
        if (pair < 0) continue;
        if (other->method == BRUNT_MPM)
            REFUSE("contact of '%s' and '%s': bodies of material points meet at the nodes of their grids, and that of "
                   "'%s' "
                   "is undeformed (lagrangian: total); let one of them be a mesh, or switch contact off between them",
                   from->name, other->name, from->name);
        if (world->pairs.pair[pair].meets & BRUNT_MEET_ON_GRID)
            REFUSE("contact of '%s' and '%s': the grid of '%s' is undeformed (lagrangian: total): use augury, not %s",
                   from->name, other->name, from->name, brunt_contact_word(world->pairs.pair[pair].method));
    }
    return BRUNT_OK;
}

static int set_erosion(const brunt_body_def *from, int32_t count, brunt_body *body, brunt_error *error) {
    body->fails = body->material.erodes;
    body->erodes_inverted = from->erosion.inverted;
    body->erodes = body->fails || body->erodes_inverted || isfinite(from->erosion.strain);
    body->keeps = body->erodes && from->erosion.keep;
    if (!body->erodes) return BRUNT_OK;
    return BRUNT_NEW(body->rank, count + 1, "ranks of particles that erode", error);
}

static int make_background(brunt_background *background, const brunt_mesh *mesh, brunt_error *error) {
    brunt_mesh_quality quality;
    brunt_error inner = {.code = BRUNT_OK};
    const int status = brunt_mesh_check(mesh, &quality, &inner);
    if (status) return brunt_fail(error, status, "grid.cells.mesh: %.400s", inner.message);
    const int32_t most = BRUNT_COORD_LIMIT * BRUNT_BLOCK_NODES;
    if (mesh->node_count > most || mesh->element_count > most)
        REFUSE("grid.cells.mesh: %d nodes and %d triangles, %d are the most", mesh->node_count, mesh->element_count,
               most);
    return brunt_background_make(background, mesh, error);
}

static int check_in_mesh(const brunt_body *body, brunt_error *error) {
    const brunt_particles *p = &body->particles;
    real *const *x = p->scalar + p->field[BRUNT_FIELD_position].first;
    for (int64_t s = 0; body->grid.mesh && s < p->slots; s++) {
        const double at[2] = {(double)x[0][s], (double)x[1][s]};
        if (p->id[s] >= 0 && brunt_background_find(body->grid.mesh, at) < 0)
            REFUSE("bodies.%s: particle %lld at (%.6g, %.6g) m: " BRUNT_OUTSIDE_OF_MESH, body->name,
                   (long long)p->id[s], at[0], at[1]);
    }
    return BRUNT_OK;
}

static int make_particles(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order,
                          const brunt_filled *filled, const double origin[3], int index, brunt_error *error) {
    const brunt_body_def *from = order[index];
    brunt_body *body = &world->bodies.mpm[world->bodies.mpm_count++];
    world->bodies.all[index] = (brunt_body_ref){.ops = &brunt_points_ops, .mpm = body};
    memcpy(body->name, from->name, sizeof body->name);
    body->index = index;
    body->spacing = lattice_spacing(def, from);
    int status = brunt_material_make(&def->materials[from->material], &body->material, error);
    if (status) return status;
    brunt_material_set_temperature(&body->material, from->temperature);
    if (from->total_lagrangian && (status = check_total_lagrangian(world, def, order, body, error))) return status;
    if ((status = set_erosion(from, filled->count, body, error))) return status;
    world->bodies.has_fluid = world->bodies.has_fluid || body->material.model[BRUNT_STRENGTH]->fluid;
    brunt_particle_needs needs = {.affine = def->transfer == BRUNT_APIC,
                                  .reach = world->contact.rows || world->boundaries.meets_points,
                                  .grid_velocity = world->transfers.musl_velocity && def->transfer == BRUNT_FLIP,
                                  .total = from->total_lagrangian};
    memcpy(needs.models, body->material.model, sizeof needs.models);
    brunt_particles_init(&body->particles, def->dimension, def->axisymmetric ? 3 : def->dimension, &needs);
    brunt_grid_init(&body->grid, def->dimension, (int)def->kernel, def->cell, origin);
    if (def->cells != BRUNT_QUADS)
        brunt_grid_use_triangles(&body->grid, def->cells == BRUNT_MESH_CELLS ? &world->bodies.background : NULL);
    status = fill_body(from, filled, body, error);
    return status ? status : check_in_mesh(body, error);
}

int brunt_bodies_make(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order,
                      brunt_error *error) {
    const int n = def->body_count, dim = def->dimension;
    brunt_filled *filled;
    if (BRUNT_NEW(filled, n, "bodies of points", error)) return BRUNT_FAILED;
    double low[3] = {INFINITY, INFINITY, INFINITY};
    int status = fill_shapes(&world->pairs, def, order, filled, low, error);
    // A grid far from the scene would waste the digits of the particles' places on it: it starts near them, whole cells
    // away.
    double origin[3] = {0};
    for (int a = 0; a < dim; a++) {
        double cells = status || isinf(low[a]) ? 0 : floor((low[a] - def->origin[a]) / def->cell);
        origin[a] = def->origin[a] + (fabs(cells) > 1024 ? cells * def->cell : 0);
    }
    if (!status && def->cells == BRUNT_MESH_CELLS)
        status = make_background(&world->bodies.background, &def->background, error);
    for (int i = 0; i < n && !status; i++)
        status = order[i]->method == BRUNT_MPM ? make_particles(world, def, order, &filled[i], origin, i, error)
                                               : brunt_make_elements(world, def, order[i], i, error);
    for (int i = 0; i < n; i++) brunt_filled_free(&filled[i]);
    brunt_free(filled);
    return status;
}
