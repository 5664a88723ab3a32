// Making a world from its definition: bodies filled, conditions sorted out, the plan made.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "world/definitions.h"
#include "boundary/ignition.h"
#include "base/error.h"
#include "geometry/axis.h"
#include "geometry/fill.h"
#include "base/simd.h"
#include "base/array.h"
#include "base/memory.h"
#include "mpm/sort.h"
#include "mpm/courant.h"
#include "base/parallel.h"
#include "contact/methods/method.h"
#include "world/world.h"

static const double ON_GRID_LINE = 1e-6; // cells: how far off a mirror plane may be and still count as on the line
static const double TOUCHING = 1e-6;     // spacings: bodies closer than that touch, they do not overlap

#define REFUSE(...) return brunt_fail(error, BRUNT_BAD_INPUT, __VA_ARGS__)

static int compare_names(const void *a, const void *b) {
    return strcmp((*(const brunt_body_def *const *)a)->name, (*(const brunt_body_def *const *)b)->name);
}

static double lattice_spacing(const brunt_world_def *def, const brunt_body_def *body) {
    int per_cell = body->particles_per_cell > 0 ? body->particles_per_cell : def->dimension == 3 ? 8 : 4;
    return body->spacing > 0 ? body->spacing : def->cell / round(pow(per_cell, 1.0 / def->dimension));
}

// ------------------------------------------------------------------------------------------ bodies

static void start_motion(const brunt_body_def *def, int dim, const double x[3], double v[3], double gradient[3][3]) {
    double phase = def->wave_phase, r[3];
    for (int a = 0; a < 3; a++) phase += def->wave_vector[a] * x[a], r[a] = x[a] - def->spin_about[a];
    const double *w = def->spin;
    const double turn[3][3] = {{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}};
    for (int a = 0; a < 3; a++) {
        v[a] = def->velocity[a] + def->wave_velocity[a] * sin(phase);
        for (int b = 0; b < dim; b++) {
            v[a] += turn[a][b] * r[b];
            gradient[a][b] = turn[a][b] + def->wave_velocity[a] * cos(phase) * def->wave_vector[b];
        }
    }
}

// How far a particle reaches that is at a distance from the body's surface. What is inside a fluid comes to its surface
// later, and so does what is inside a body that erodes: there is a particle's own material about it, no more. Of a body
// that erodes those in the outermost layer keep their distance: it says where the surface is that there is now.
static double particle_reach(const brunt_body *body, double distance) {
    const double own = 0.5 * body->spacing;
    if (body->material.model[BRUNT_STRENGTH]->fluid) return fmin(distance, own);
    return body->erodes && distance > body->spacing ? own : distance;
}

static int fill_body(const brunt_body_def *def, const brunt_filled *filled, brunt_body *body, brunt_error *error) {
    brunt_particles *p = &body->particles;
    const int dim = p->dim;
    if (brunt_particles_reserve(p, filled->count))
        return brunt_fail(error, BRUNT_FAILED, "bodies.%s: out of memory for %d particles", def->name, filled->count);
    p->count = p->slots = p->made = filled->count;
    const bool rings = brunt_axisymmetric(p);
    body->particle_mass = (real)(filled->volume * (double)body->material.density * (rings ? 2 * M_PI : 1));
    real **x = brunt_field(p, BRUNT_FIELD_position), **v = brunt_field(p, BRUNT_FIELD_velocity),
         **C = brunt_field(p, BRUNT_FIELD_affine);
    real **F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    bool affine = p->field[BRUNT_FIELD_affine].components > 0, reach = p->field[BRUNT_FIELD_reach].components > 0;
    for (int64_t s = 0; s < p->count; s++) {
        double at[3] = {0}, speed[3], gradient[3][3] = {{0}};
        for (int a = 0; a < dim; a++) at[a] = filled->position[a][s];
        start_motion(def, dim, at, speed, gradient);
        p->id[s] = s;
        // Of a ring, 2 pi times the integral of r over its square: exact.
        const double volume = filled->volume * (rings ? 2 * M_PI * at[0] : 1);
        if (!(volume > 0)) REFUSE("bodies.%s: a particle at r = %g m: " BRUNT_CUT_AT_AXIS, def->name, at[0]);
        brunt_field(p, BRUNT_FIELD_mass)[0][s] = (real)(volume * (double)body->material.density);
        brunt_field(p, BRUNT_FIELD_reference_volume)[0][s] = (real)volume;
        if (reach) brunt_field(p, BRUNT_FIELD_reach)[0][s] = (real)particle_reach(body, filled->reach[s]);
        for (int a = 0; a < 3 && body->material.rest_stress != 0; a++)
            brunt_field(p, BRUNT_FIELD_kirchhoff_stress)[a][s] = body->material.rest_stress;
        if (rings) F[8][s] = 1;
        for (int a = 0; a < dim; a++) {
            x[a][s] = (real)at[a];
            if (brunt_total_lagrangian(p)) brunt_kernel_place(p)[a][s] = (real)at[a];
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

// Particles of the bodies that are made of them, and the lowest of their coordinates. Bodies of meshes stay empty.
static int fill_shapes(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order,
                       brunt_filled *filled, double low[3], brunt_error *error) {
    const int n = def->body_count, dim = def->dimension;
    int status = BRUNT_OK;
    for (int i = 0; i < n && !status; i++) {
        if (order[i]->method != BRUNT_MPM) continue;
        status = brunt_fill_shape(order[i], dim, lattice_spacing(def, order[i]), &filled[i], error);
        for (int32_t k = 0; !status && k < filled[i].count; k++)
            for (int a = 0; a < dim; a++) low[a] = fmin(low[a], filled[i].position[a][k]);
    }
    for (int i = 0; i < n && !status && !def->contact.allow_overlap; i++)
        for (int k = 0; k < n && !status; k++) {
            if (i == k || world->pairs.of[i * n + k] < 0 || order[k]->mesh.node_count ||
                order[k]->method == BRUNT_MEMBRANE) // of a membrane the shape is only what it is wrapped around
                continue;
            double depth = overlap_depth(&filled[i], order[k], dim);
            if (depth > TOUCHING * lattice_spacing(def, order[i]))
                status = brunt_fail(error, BRUNT_BAD_INPUT,
                                    "bodies.%s overlaps bodies.%s by %.4g m at the start; move one of them, or write "
                                    "contact.initial_overlap: allow",
                                    order[i]->name, order[k]->name, depth);
        }
    return status;
}

// What needs the bodies' grids at one place in space is not for bodies whose grids are undeformed.
static int check_total_lagrangian(const brunt_world *world, const brunt_world_def *def, const brunt_body_def *from,
                                  const brunt_body *body, brunt_error *error) {
    if (def->axisymmetric) REFUSE("bodies.%s.lagrangian: total: not in axisymmetric scenes", from->name);
    if (!world->transfers.total_gather)
        REFUSE(
            "bodies.%s.lagrangian: total: kernel linear has gradients that jump between cells; use quadratic or cubic",
            from->name);
    if (body->material.model[BRUNT_STRENGTH]->fluid)
        REFUSE("bodies.%s.lagrangian: total: material '%s' is a fluid: it has no undeformed configuration", from->name,
               body->material.name);
    for (int k = 0; k < def->body_count; k++) {
        const brunt_body_def *other = &def->bodies[k];
        int32_t n = 0; // its place in order of name
        for (int q = 0; q < def->body_count; q++) n += strcmp(def->bodies[q].name, other->name) < 0;
        const int32_t pair = other == from ? -1 : world->pairs.of[body->index * def->body_count + n];
        if (pair < 0) continue;
        if (other->method == BRUNT_MPM)
            REFUSE("contact of '%s' and '%s': bodies of material points meet at the nodes of their grids, and that of "
                   "'%s' "
                   "is undeformed (lagrangian: total); let one of them be a mesh, or switch contact off between them",
                   from->name, other->name, from->name);
        if (world->pairs.pair[pair].method == BRUNT_CONTACT_MULTI_VELOCITY)
            REFUSE("contact of '%s' and '%s': the grid of '%s' is undeformed (lagrangian: total): use augury, not "
                   "multi-velocity",
                   from->name, other->name, from->name);
    }
    return BRUNT_OK;
}

static int set_erosion(const brunt_world_def *def, const brunt_body_def *from, int32_t count, brunt_body *body,
                       brunt_error *error) {
    for (int k = 0; k < BRUNT_COMPONENTS; k++)
        body->fails = body->fails || (body->material.model[k] && body->material.model[k]->damage);
    body->fails = body->fails && def->materials[from->material].failure_action == BRUNT_FAILURE_ERODE;
    body->erodes_inverted = from->erosion.inverted;
    body->erodes = body->fails || body->erodes_inverted || isfinite(from->erosion.strain);
    body->keeps = body->erodes && from->erosion.keep;
    if (!body->erodes) return BRUNT_OK;
    body->rank = brunt_alloc(((size_t)count + 1) * sizeof *body->rank);
    return body->rank ? BRUNT_OK : brunt_fail(error, BRUNT_FAILED, "out of memory");
}

static int make_particles(brunt_world *world, const brunt_world_def *def, const brunt_body_def *from,
                          const brunt_filled *filled, const double origin[3], int index, brunt_error *error) {
    brunt_body *body = &world->bodies.mpm[world->bodies.mpm_count++];
    world->bodies.all[index] = (brunt_body_ref){.ops = &brunt_points_ops, .mpm = body};
    memcpy(body->name, from->name, sizeof body->name);
    body->index = index;
    body->spacing = lattice_spacing(def, from);
    int status = brunt_material_make(&def->materials[from->material], &body->material, error);
    if (status) return status;
    if (from->total_lagrangian && (status = check_total_lagrangian(world, def, from, body, error))) return status;
    if ((status = set_erosion(def, from, filled->count, body, error))) return status;
    world->bodies.has_fluid = world->bodies.has_fluid || body->material.model[BRUNT_STRENGTH]->fluid;
    brunt_particle_needs needs = {.affine = def->transfer == BRUNT_APIC,
                                  .reach = world->contact.has_grid || world->contact.has_augury ||
                                           world->contact.has_grid_surfaces || world->boundaries.has_walls,
                                  .grid_velocity = world->transfers.advance && def->transfer == BRUNT_FLIP,
                                  .total = from->total_lagrangian};
    memcpy(needs.models, body->material.model, sizeof needs.models);
    brunt_particles_init(&body->particles, def->dimension, def->axisymmetric ? 3 : def->dimension, &needs);
    brunt_grid_init(&body->grid, def->dimension, (int)def->kernel, def->cell, origin);
    return fill_body(from, filled, body, error);
}

// Nodes that no element uses are left out: the others are numbered without gaps, in the mesh's order.
static int close_ranks(brunt_fem_body *fem, int32_t mesh_nodes) {
    if (fem->node_count == mesh_nodes) return 0;
    int32_t *rank = brunt_alloc((size_t)(mesh_nodes + 1) * sizeof *rank), next = 0;
    if (!rank) return -1;
    for (int32_t n = 0; n < fem->node_count; n++) rank[fem->node_id[n]] = 1;
    for (int32_t i = 0; i < mesh_nodes; i++)
        if (rank[i]) rank[i] = next++;
    for (int32_t n = 0; n < fem->node_count; n++) fem->node_id[n] = rank[fem->node_id[n]];
    brunt_free(rank);
    return 0;
}

static int make_elements(brunt_world *world, const brunt_world_def *def, const brunt_body_def *from, int index,
                         brunt_error *error) {
    brunt_fem_body *fem = &world->bodies.fem[world->bodies.fem_count];
    brunt_mesh_report *report = &world->bodies.mesh_reports[world->bodies.fem_count++];
    world->bodies.all[index] = (brunt_body_ref){.ops = &brunt_mesh_ops, .fem = fem};
    brunt_mesh made = {0};
    brunt_material material;
    const bool sheet = from->method == BRUNT_MEMBRANE;
    int status = BRUNT_OK;
    if (sheet && !(from->thickness > 0 && isfinite(from->thickness)))
        REFUSE("bodies.%s.thickness: %g m is not a positive length", from->name, from->thickness);
    if (sheet &&
        !(isnan(from->contact_thickness) || (from->contact_thickness >= 0 && isfinite(from->contact_thickness))))
        REFUSE("bodies.%s.contact_thickness: %g m is negative", from->name, from->contact_thickness);
    if (!(from->damping >= 0) || !isfinite(from->damping))
        REFUSE("bodies.%s.damping: %g 1/s is not a rate", from->name, from->damping);
    const bool graded = from->grading[0].count || from->grading[1].count || from->grading[2].count;
    if (graded && (sheet || from->mesh.node_count || from->shape.kind != BRUNT_BOX))
        REFUSE("bodies.%s.grading: only the mesh of a box of method fem is graded", from->name);
    if (!from->mesh.node_count) {
        if (!(from->size > 0)) REFUSE("bodies.%s.size: %g m is not a positive length", from->name, from->size);
        status = sheet
                     ? brunt_mesh_surface(&from->shape, from->element, from->size,
                                          (const char(*)[BRUNT_NAME_LENGTH])from->faces, from->face_count, &made, error)
                 : graded ? brunt_mesh_graded(&from->shape, def->dimension, from->element, from->size, from->grading,
                                              &made, error)
                          : brunt_mesh_shape(&from->shape, def->dimension, from->element, from->size, &made, error);
    }
    const brunt_mesh *mesh = from->mesh.node_count ? &from->mesh : &made;
    if (!status) status = brunt_mesh_check(mesh, &report->quality, error);
    if (status && error) {
        char reason[sizeof error->message];
        memcpy(reason, error->message, sizeof reason);
        brunt_fail(error, error->code, "bodies.%s: %.900s", from->name, reason);
    }
    if (!status && brunt_element_is_membrane(mesh->kind) != sheet)
        REFUSE("bodies.%s: elements of kind %s are not for method %s", from->name, brunt_element_name(mesh->kind),
               sheet ? "membrane" : "fem");
    const brunt_material_def *law = &def->materials[from->material];
    if (!status)
        status = sheet ? brunt_material_make_membrane(law, from->tension_only, &material, error)
                       : brunt_material_make(law, &material, error);
    if (!status)
        status = def->axisymmetric ? brunt_fem_make_axisymmetric(from, &material, mesh, fem, error)
                                   : brunt_fem_make(from, &material, def->dimension, mesh, fem, error);
    if (!status && close_ranks(fem, mesh->node_count)) status = brunt_fail(error, BRUNT_FAILED, "out of memory");
    if (!status) {
        fem->index = index;
        report->least_step = fem->least_step;
        report->added_mass = fem->added_mass, report->scaled_elements = fem->scaled_elements;
        if (report->quality.duplicate_nodes)
            brunt_warn(&world->messages, "bodies.%s: %d nodes of the mesh lie on others: the body is not joined there",
                       from->name, report->quality.duplicate_nodes);
        if (report->quality.worst_shape < 0.1)
            brunt_warn(&world->messages, "bodies.%s: element %d is nearly flat (shape %.2g, 1 is regular)", from->name,
                       report->quality.worst + 1, report->quality.worst_shape);
    }
    for (int32_t n = 0; !status && n < fem->node_count; n++) {
        real *node = brunt_fem_node(fem, n);
        double x[3], v[3], gradient[3][3];
        for (int a = 0; a < 3; a++) x[a] = (double)node[a];
        start_motion(from, def->dimension, x, v, gradient);
        for (int a = 0; a < def->dimension; a++) node[BRUNT_FEM_V + a] = (real)v[a];
        if (def->axisymmetric && fem->held[n]) node[BRUNT_FEM_V] = 0; // on the axis
    }
    brunt_mesh_free(&made);
    return status;
}

static int make_bodies(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order,
                       brunt_error *error) {
    const int n = def->body_count, dim = def->dimension;
    brunt_filled *filled = brunt_alloc((size_t)n * sizeof *filled);
    if (!filled) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    double low[3] = {INFINITY, INFINITY, INFINITY};
    int status = fill_shapes(world, def, order, filled, low, error);
    // A grid far from the scene would waste the digits of the particles' places on it: it starts near them, whole cells
    // away.
    double origin[3] = {0};
    for (int a = 0; a < dim; a++) {
        double cells = status || isinf(low[a]) ? 0 : floor((low[a] - def->origin[a]) / def->cell);
        origin[a] = def->origin[a] + (fabs(cells) > 1024 ? cells * def->cell : 0);
    }
    for (int i = 0; i < n && !status; i++)
        status = order[i]->method == BRUNT_MPM ? make_particles(world, def, order[i], &filled[i], origin, i, error)
                                               : make_elements(world, def, order[i], i, error);
    for (int i = 0; i < n; i++) brunt_filled_free(&filled[i]);
    brunt_free(filled);
    return status;
}

// ------------------------------------------------------------------------------------------ conditions and contact

static int find_body(const brunt_body_def **order, int n, const char *name) {
    for (int i = 0; i < n; i++)
        if (!strcmp(order[i]->name, name)) return i;
    return -1;
}

// Index of the axis a plane is normal to, -1 when it is oblique.
static int plane_axis(const brunt_plane_def *plane, int dim) {
    for (int a = 0; a < dim; a++)
        if (fabs(fabs(plane->normal[a]) - 1) < 1e-12) return a;
    return -1;
}

static bool has_fluid(const brunt_world_def *def) {
    for (int i = 0; i < def->body_count; i++) {
        const brunt_model *model = brunt_find_strength(def->materials[def->bodies[i].material].strength);
        if (def->bodies[i].method == BRUNT_MPM && model && model->fluid) return true;
    }
    return false;
}

static int make_plane(brunt_world *world, const brunt_world_def *def, int index, brunt_error *error) {
    brunt_wall *wall = &world->boundaries.walls[index];
    brunt_plane_def *plane = &wall->plane;
    double size = 0;
    for (int a = 0; a < def->dimension; a++) size += plane->normal[a] * plane->normal[a];
    if (!(size > 0) || !isfinite(size)) REFUSE("boundaries[%d].plane.normal: it has no direction", index);
    for (int a = 0; a < 3; a++) plane->normal[a] = a < def->dimension ? plane->normal[a] / sqrt(size) : 0;
    if (!(plane->friction >= 0)) REFUSE("boundaries[%d].friction: %g is negative", index, plane->friction);
    bool moves = plane->velocity[0] != 0 || plane->velocity[1] != 0 || plane->velocity[2] != 0;
    int axis = plane_axis(plane, def->dimension);
    double at = axis < 0 ? 0 : (plane->point[axis] - def->origin[axis]) / def->cell;
    bool on_line = axis >= 0 && !moves && fabs(at - round(at)) < ON_GRID_LINE;
    if (!world->bodies.has_particles) { // meshes hold their nodes on any plane themselves
        world->boundaries.has_friction = world->boundaries.has_friction || plane->friction > 0;
        return BRUNT_OK;
    }
    if (plane->condition == BRUNT_SYMMETRY && !on_line)
        REFUSE("boundaries[%d] (%s): a symmetry plane must stand still, be normal to an axis and lie on a grid line "
               "(cell %g m)",
               index, wall->name, def->cell);
    if (on_line && (plane->condition == BRUNT_SYMMETRY || plane->condition == BRUNT_SLIP)) {
        if (world->boundaries.mirror_count ==
            (int)(sizeof world->boundaries.mirrors / sizeof world->boundaries.mirrors[0]))
            REFUSE("boundaries: more than 16 symmetry and slip planes");
        for (int m = 0; m < world->boundaries.mirror_count; m++) {
            const brunt_symmetry_plane *other = &world->boundaries.mirrors[m];
            int32_t apart = (int32_t)round(at) - other->node;
            if (other->wall >= 0 && other->axis == axis && apart != 0 && abs(apart) <= (int)def->kernel &&
                has_fluid(def))
                brunt_warn(
                    &world->messages,
                    "boundaries[%d] (%s): this plane of symmetry or slip and '%s' are %d cells apart; the kernel "
                    "reaches over both, and fluids leak: at least %d are wanted",
                    index, wall->name, world->boundaries.walls[other->wall].name, abs(apart), (int)def->kernel + 1);
        }
        wall->mirror = world->boundaries.mirror_count;
        world->boundaries.mirrors[world->boundaries.mirror_count++] =
            (brunt_symmetry_plane){.axis = axis, .node = (int32_t)round(at), .wall = index};
    } else if (plane->condition == BRUNT_SEPARATE) {
        world->boundaries.has_walls = true;
        if (has_fluid(def))
            brunt_warn(
                &world->messages,
                "boundaries[%d] (%s): beside a plane of condition separate the pressure of fluids is wrong in the "
                "two nearest rows of particles, and gas at rest tears there; slip on a line of the grid is exact",
                index, wall->name);
        world->boundaries.has_friction = world->boundaries.has_friction || plane->friction > 0;
    } else {
        world->boundaries.has_conditions = true;
        if (plane->condition == BRUNT_SLIP && has_fluid(def))
            brunt_warn(
                &world->messages,
                "boundaries[%d] (%s): a slip plane that is not on a line of the grid lets fluids in by half a cell; "
                "move it, or grid.origin",
                index, wall->name);
    }
    return BRUNT_OK;
}

static int make_walls(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order,
                      brunt_error *error) {
    world->boundaries.wall_count = def->plane_count + def->region_count + def->group_count;
    world->boundaries.walls = brunt_alloc((size_t)(world->boundaries.wall_count + 1) * sizeof *world->boundaries.walls);
    world->scratch.planes = brunt_alloc((size_t)def->body_count * sizeof(void *));
    if (!world->boundaries.walls || !world->scratch.planes) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    if (def->axisymmetric && world->bodies.has_particles)
        world->boundaries.mirrors[world->boundaries.mirror_count++] =
            (brunt_symmetry_plane){.axis = 0, .node = (int32_t)round(-def->origin[0] / def->cell), .wall = -1};
    for (int w = 0; w < world->boundaries.wall_count; w++) {
        brunt_wall *wall = &world->boundaries.walls[w];
        wall->region = w >= def->plane_count;
        wall->mirror = wall->body = -1;
        if (w >= def->plane_count + def->region_count) { // the rest follows with the bodies (holds.c)
            const char *given = def->groups[w - def->plane_count - def->region_count].name;
            if (given[0])
                memcpy(wall->name, given, sizeof wall->name);
            else
                snprintf(wall->name, sizeof wall->name, "group%d", w + 1);
            continue;
        }
        if (wall->region)
            wall->where = def->regions[w - def->plane_count];
        else
            wall->plane = def->planes[w];
        const char *name = wall->region ? wall->where.name : wall->plane.name,
                   *body = wall->region ? wall->where.body : wall->plane.body;
        if (name[0])
            memcpy(wall->name, name, sizeof wall->name);
        else
            snprintf(wall->name, sizeof wall->name, "%s%d", wall->region ? "region" : "plane", w + 1);
        if (body[0] && (wall->body = find_body(order, def->body_count, body)) < 0)
            REFUSE("boundaries (%s).body: there is no body '%s'", wall->name, body);
        if (wall->region)
            world->boundaries.has_conditions = true;
        else {
            int status = make_plane(world, def, w, error);
            if (status) return status;
        }
    }
    return BRUNT_OK;
}

// In a crowded scene all pairs of one method and friction are one.
static int find_alike(const brunt_world *world, const brunt_pair *pair) {
    for (int p = 0; p < world->pairs.count; p++)
        if (world->pairs.pair[p].method == pair->method && world->pairs.pair[p].friction == pair->friction) return p;
    return -1;
}

// Checks the names of a pair, and makes that of a membrane with itself.
static int make_self_pair(brunt_world *world, const brunt_pair_def *def, int q, const brunt_body_def **order, int n,
                          brunt_error *error) {
    const int a = find_body(order, n, def->a), b = find_body(order, n, def->b);
    if (a < 0 || b < 0) REFUSE("contact.pairs[%d].between: '%s' and '%s' are not two bodies", q, def->a, def->b);
    if (a != b) return BRUNT_OK;
    if (order[a]->method != BRUNT_MEMBRANE)
        REFUSE("contact.pairs[%d].between: '%s' is no membrane: no other body can be in contact with itself", q,
               def->a);
    if (def->method == BRUNT_CONTACT_NONE) return BRUNT_OK;
    if (def->method != BRUNT_CONTACT_AUGURY)
        REFUSE("contact.pairs[%d].method: contact of '%s' with itself is by augury", q, def->a);
    if (!(def->friction >= 0)) REFUSE("contact.pairs[%d].friction: %g is negative", q, def->friction);
    if (world->pairs.of[a * n + a] >= 0) REFUSE("contact.pairs[%d].between: '%s' is listed twice", q, def->a);
    world->contact.has_augury = true;
    world->contact.has_friction = world->contact.has_friction || def->friction > 0;
    world->pairs.of[a * n + a] = world->pairs.count;
    world->pairs.pair[world->pairs.count++] =
        (brunt_pair){.a = a, .b = a, .method = BRUNT_CONTACT_AUGURY, .friction = def->friction};
    return BRUNT_OK;
}

static int make_pairs(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order,
                      brunt_error *error) {
    const int n = def->body_count;
    world->pairs.of = brunt_alloc((size_t)n * (size_t)n * sizeof *world->pairs.of);
    const bool crowded = n * (n - 1) / 2 > BRUNT_MOST_PAIRS;
    size_t room = crowded ? BRUNT_MOST_PAIRS : (size_t)n * (size_t)n / 2;
    for (int q = 0; q < def->contact.pair_count; q++) room += !strcmp(def->contact.pairs[q].a, def->contact.pairs[q].b);
    world->pairs.pair = brunt_alloc((room + 1) * sizeof *world->pairs.pair);
    if (!world->pairs.of || !world->pairs.pair) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++) world->pairs.of[i * n + k] = -1;
    for (int q = 0; q < def->contact.pair_count; q++) {
        int status = make_self_pair(world, &def->contact.pairs[q], q, order, n, error);
        if (status) return status;
    }
    for (int i = 0; i < n; i++)
        for (int k = i + 1; k < n; k++) {
            brunt_pair pair = {.a = i, .b = k, .method = def->contact.method, .friction = def->contact.friction};
            for (int q = 0; q < def->contact.pair_count; q++) {
                const brunt_pair_def *p = &def->contact.pairs[q];
                int a = find_body(order, n, p->a), b = find_body(order, n, p->b);
                if ((a == i && b == k) || (a == k && b == i)) pair.method = p->method, pair.friction = p->friction;
            }
            bool meshes = order[i]->method != BRUNT_MPM || order[k]->method != BRUNT_MPM;
            if (pair.method == BRUNT_CONTACT_NONE) continue;
            const bool on_grid = pair.method == BRUNT_CONTACT_MULTI_VELOCITY;
            // Bodies of material points meet at the nodes of the grid that moves them, whatever the method is called.
            const bool accepted = !meshes || brunt_contact_accepts(pair.method, order[i]->method != BRUNT_MPM,
                                                                   order[k]->method != BRUNT_MPM);
            if (!accepted && on_grid)
                REFUSE("contact of '%s' and '%s': multi-velocity needs the grid of a body of material points; use "
                       "augury between meshes",
                       order[i]->name, order[k]->name);
            if (!accepted)
                REFUSE("contact of '%s' and '%s': only bodies of material points can be tied", order[i]->name,
                       order[k]->name);
            if (!meshes) {
                if (pair.method != BRUNT_CONTACT_TIED) pair.method = BRUNT_CONTACT_MULTI_VELOCITY;
                world->contact.has_grid = true;
            } else if (on_grid)
                world->contact.has_grid_surfaces = true;
            else
                world->contact.has_augury = true;
            if (!(pair.friction >= 0)) REFUSE("contact.friction: %g is negative", pair.friction);
            world->contact.has_friction = world->contact.has_friction || pair.friction > 0;
            int index = crowded ? find_alike(world, &pair) : -1;
            if (index < 0) {
                if (crowded) pair.a = pair.b = -1;
                world->pairs.pair[index = world->pairs.count++] = pair;
            }
            world->pairs.of[i * n + k] = world->pairs.of[k * n + i] = index;
        }
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ start

int brunt_reports_make(brunt_world *world, brunt_error *error) {
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        if (BRUNT_RESERVE(body->report, (size_t)body->grid.block_count, 0))
            return brunt_fail(error, BRUNT_FAILED, "out of memory");
        real *const *v = brunt_field(&body->particles, BRUNT_FIELD_velocity);
        for (int32_t b = 0; b < body->grid.block_count; b++) {
            const brunt_block *block = &body->grid.blocks[b];
            double fastest = 0;
            for (int64_t s = block->first; s < block->first + block->count; s++) {
                double square = 0;
                for (int a = 0; a < world->settings.dimension; a++) square += (double)(v[a][s] * v[a][s]);
                fastest = fmax(fastest, square);
            }
            body->report[b] =
                (brunt_block_report){.speed = (real)sqrt(fastest), .wave_speed = body->material.wave_speed, .bad = -1};
        }
    }
    return BRUNT_OK;
}

// A plane of symmetry stands for what is behind it: what a body has there would be there twice.
static int check_symmetry(const brunt_world *world, brunt_error *error) {
    for (int w = 0; w < world->boundaries.wall_count; w++) {
        const brunt_wall *wall = &world->boundaries.walls[w];
        const double *n = wall->plane.normal, *at = wall->plane.point;
        if (wall->region || wall->plane.condition != BRUNT_SYMMETRY) continue;
        for (int i = 0; i < world->bodies.count; i++) {
            if (wall->body >= 0 && wall->body != i) continue;
            brunt_body *mpm = world->bodies.all[i].mpm;
            const brunt_fem_body *fem = world->bodies.all[i].fem;
            const int64_t count = mpm ? mpm->particles.slots : fem->node_count;
            real *const *x = mpm ? brunt_field(&mpm->particles, BRUNT_FIELD_position) : NULL;
            double least = 0, size = mpm ? mpm->spacing : fem->mean_edge, far = 0;
            for (int64_t s = 0; s < count; s++) {
                double distance = 0;
                for (int a = 0; a < world->settings.dimension; a++) {
                    const double place = (double)(mpm ? x[a][s] : brunt_fem_node(fem, (int32_t)s)[a]);
                    distance += n[a] * (place - at[a]);
                    far = fmax(far, fabs(place));
                }
                least = fmin(least, distance);
            }
            if (least < -(1e-3 * size + 1e-6 * far))
                REFUSE(
                    "bodies.%s: it reaches %.4g m behind the plane of symmetry '%s', which stands for what is there: "
                    "cut the body at the plane",
                    brunt_body_name(world, i), -least, wall->name);
        }
    }
    return BRUNT_OK;
}

static int start(brunt_world *world, brunt_error *error) {
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        int status = brunt_sort(&body->grid, &body->particles, world->settings.threads, NULL, error);
        if (status) return status;
    }
    int status = brunt_reports_make(world, error);
    if (status) return status;
    for (int i = 0; i < world->bodies.mpm_count; i++)
        for (int32_t b = 0; b < world->bodies.mpm[i].grid.block_count; b++)
            world->bodies.mpm[i].speed =
                (real)fmax((double)world->bodies.mpm[i].speed, (double)world->bodies.mpm[i].report[b].speed);
    int32_t bad;
    const char *reason;
    if (brunt_fem_elements_all(world, 0, &bad, &reason))
        return brunt_fail(error, BRUNT_BAD_INPUT, "a mesh: %s", reason);
    struct brunt_clock *clock = &world->clock;
    clock->next_dt = clock->dt = clock->recent_step = clock->earlier_step = brunt_stable_step(world);
    if (world->settings.fixed_step > 0) clock->dt = world->settings.fixed_step;
    clock->dt_min = INFINITY;
    const brunt_books books = brunt_books_of(world);
    brunt_ledger_open(&world->ledger, &books);
    return BRUNT_OK;
}

static double cfl_of(const brunt_world_def *def, bool particles) {
    if (def->cfl > 0) return def->cfl;
    return particles ? brunt_default_cfl(def->dimension, def->kernel, def->transfer) : 0.5;
}

// Points that fail and stay, or that are a fluid's, fly on alone, and bear pressure there. (What erosion keeps has no
// stress, and nothing to be unstable with.)
static void warn_of_lone_points(brunt_world *world) {
    const double limit =
        brunt_lone_points_cfl(world->settings.dimension, world->settings.kernel, world->settings.transfer);
    if (world->settings.fixed_step > 0 || world->settings.cfl <= limit * (1 + 1e-9)) return;
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        const brunt_body *body = &world->bodies.mpm[i];
        const bool softens = body->material.model[BRUNT_FAILURE] && !body->fails;
        if (!softens && !body->material.model[BRUNT_STRENGTH]->fluid) continue;
        brunt_warn(&world->messages,
                   "bodies.%s: material points that come away from others bear pressure alone, which with this kernel "
                   "and transfer is stable up to cfl %.2g; time.cfl is %.2g",
                   body->name, limit, world->settings.cfl);
    }
}

brunt_world *brunt_world_create(const brunt_world_def *def, brunt_error *error) {
    if (error) *error = (brunt_error){.id = -1};
    if (brunt_definition_check(def, error)) return NULL;
    brunt_world *world = brunt_alloc(sizeof *world);
    const brunt_body_def **order = brunt_alloc((size_t)def->body_count * sizeof *order);
    if (!world || !order) {
        brunt_free(world);
        brunt_free(order);
        brunt_fail(error, BRUNT_FAILED, "out of memory");
        return NULL;
    }
    for (int i = 0; i < def->body_count; i++) order[i] = &def->bodies[i];
    qsort(order, (size_t)def->body_count, sizeof *order, compare_names);

    world->settings.dimension = def->dimension;
    world->settings.threads = def->threads > 0 ? def->threads : brunt_threads_available();
    if (world->settings.threads > BRUNT_THREAD_LIMIT) world->settings.threads = BRUNT_THREAD_LIMIT;
    world->settings.kernel = def->kernel, world->settings.transfer = def->transfer;
    world->settings.flip = def->flip, world->settings.fixed_step = def->step, world->settings.end = def->end;
    world->settings.axisymmetric = def->axisymmetric;
    world->settings.least_step = def->least_step;
    world->settings.energy_limit = def->energy_limit, world->settings.cell = def->cell,
    world->settings.gravity_ramp = def->gravity_ramp;
    memcpy(world->settings.gravity, def->gravity, sizeof world->settings.gravity);
    for (int a = 0; a < def->dimension; a++)
        world->settings.has_gravity = world->settings.has_gravity || def->gravity[a] != 0;
    world->transfers.scatter = brunt_find_scatter(def->dimension, def->axisymmetric, def->kernel, def->transfer);
    world->transfers.total_scatter = brunt_find_total_scatter(def->dimension, def->kernel, def->transfer);
    world->transfers.total_gather = brunt_find_total_gather(def->dimension, def->kernel, def->transfer);
    world->transfers.gather = brunt_find_gather(def->dimension, def->axisymmetric, def->kernel, def->transfer);
    world->transfers.advance = brunt_find_advance(def->dimension, def->axisymmetric, def->kernel, def->transfer);
    world->bodies.count = def->body_count;
    world->bodies.all = brunt_alloc((size_t)def->body_count * sizeof *world->bodies.all);
    world->bodies.mpm = brunt_alloc((size_t)def->body_count * sizeof *world->bodies.mpm);
    world->bodies.fem = brunt_alloc((size_t)def->body_count * sizeof *world->bodies.fem);
    world->bodies.mesh_reports = brunt_alloc((size_t)def->body_count * sizeof *world->bodies.mesh_reports);
    for (int i = 0; i < def->body_count; i++)
        world->bodies.has_particles = world->bodies.has_particles || order[i]->method == BRUNT_MPM;
    world->settings.cfl = cfl_of(def, world->bodies.has_particles);

    int status = world->bodies.mpm && world->bodies.all && world->bodies.fem && world->bodies.mesh_reports
                     ? BRUNT_OK
                     : brunt_fail(error, BRUNT_FAILED, "out of memory");
    if (!status) status = make_walls(world, def, order, error);
    if (!status) status = make_pairs(world, def, order, error);
    if (!status) status = make_bodies(world, def, order, error);
    if (!status) status = check_symmetry(world, error);
    if (!status) status = brunt_ignition_make(&world->bodies, def, &world->messages, error);
    if (!status) status = brunt_erosion_make(&world->erosion, &world->bodies, def, error);
    if (!status)
        status = brunt_node_sets_make(&world->boundaries.sets, def, &world->bodies,
                                      world->boundaries.walls + def->plane_count + def->region_count, &world->messages,
                                      error);
    if (!status) status = brunt_surfaces_make(world, def, error);
    if (!status && brunt_fem_tasks_make(world)) status = brunt_fail(error, BRUNT_FAILED, "out of memory");
    if (!status) status = brunt_damping_make(&world->boundaries.damping, &world->bodies, error);
    if (!status) status = brunt_load_step_make(&world->boundaries.sets, error);
    for (int m = 0; !status && m < world->boundaries.mirror_count;
         m++) { // node numbers count from where the grid starts
        int axis = world->boundaries.mirrors[m].axis;
        world->boundaries.mirrors[m].node -=
            (int32_t)round((world->bodies.mpm[0].grid.origin[axis] - def->origin[axis]) / def->cell);
    }
    brunt_plan_make(world);
    if (!status) status = start(world, error);
    if (!status && !def->contact.allow_overlap) status = brunt_surfaces_overlap(world, error);
    if (!status) warn_of_lone_points(world);
    brunt_free(order);
    if (!status) return world;
    brunt_world_destroy(world);
    return NULL;
}

void brunt_world_destroy(brunt_world *world) {
    if (!world) return;
    for (int i = 0; world->bodies.mpm && i < world->bodies.mpm_count; i++) {
        brunt_body_free(&world->bodies.mpm[i]);
        if (world->scratch.planes) brunt_wall_workspace_free(world->scratch.planes[i]);
    }
    for (size_t t = 0; t < sizeof world->scratch.points / sizeof world->scratch.points[0]; t++)
        brunt_workspace_free(&world->scratch.points[t]);
    brunt_contact_workspace_free(world->scratch.grid_velocity);
    brunt_surface_free(&world->contact.surface);
    brunt_constraints_free(&world->contact.constraints);
    brunt_node_to_facet_free(world->contact.node_to_facet);
    brunt_augury_workspace_free(world->contact.augury);
    brunt_surface_on_grid_free(world->contact.grid_surfaces);
    brunt_load_step_free(&world->boundaries.sets);
    brunt_node_sets_free(&world->boundaries.sets);
    brunt_damping_free(&world->boundaries.damping);
    brunt_erosion_free(&world->erosion);
    for (int k = 0; world->bodies.fem && k < world->bodies.fem_count; k++) brunt_fem_free(&world->bodies.fem[k]);
    for (size_t t = 0; t < sizeof world->scratch.meshes / sizeof world->scratch.meshes[0]; t++)
        brunt_fem_workspace_free(&world->scratch.meshes[t]);
    brunt_free(world->bodies.all);
    brunt_free(world->bodies.fem);
    brunt_free(world->bodies.mesh_reports);
    brunt_free(world->bodies.tasks.node);
    brunt_free(world->bodies.tasks.element);
    brunt_free(world->bodies.tasks.sums);
    brunt_messages_free(&world->messages);
    brunt_free(world->scratch.planes);
    brunt_free(world->bodies.mpm);
    brunt_free(world->boundaries.walls);
    brunt_free(world->pairs.pair);
    brunt_free(world->pairs.of);
    brunt_free(world->scratch.node_sums);
    brunt_free(world);
}
