// Looks a definition over before a world is made of it: whatever it holds, the answer is a code and a message. What
// takes the bodies themselves to know (which groups a mesh has, what lies where) is found where they are made.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/names.h"
#include "contact/planes/condition.h"
#include "boundary/kinds.h"
#include "contact/methods/method.h"
#include "world/definitions.h"
#include "base/check.h"
#include "base/error.h"
#include "geometry/shape_check.h"
#include "base/memory.h"
#include "materials/material.h"
#include "world/world.h"

static const double ON_GRID_LINE =
    1e-6; // cells: how far off the axis of revolution may be and still count as on the line

#define REFUSE(...) return brunt_fail(error, BRUNT_BAD_INPUT, __VA_ARGS__)

// ------------------------------------------------------------------------------------------ bodies

// Node numbers of elements are looked at with the elements (brunt_mesh_check).
static int check_mesh(const char *owner, const brunt_mesh *mesh, brunt_error *error) {
    char what[160];
    BRUNT_TRY(brunt_check_choice(owner, ".mesh: kind", (unsigned)mesh->kind, BRUNT_ELEMENT_KINDS, error));
    snprintf(what, sizeof what, "%s.mesh: nodes", owner);
    BRUNT_TRY(brunt_check_array(what, mesh->node_count, mesh->nodes, error));
    snprintf(what, sizeof what, "%s.mesh: elements", owner);
    BRUNT_TRY(brunt_check_array(what, mesh->element_count, mesh->elements, error));
    snprintf(what, sizeof what, "%s.mesh: groups", owner);
    BRUNT_TRY(brunt_check_array(what, mesh->group_count, mesh->groups, error));
    for (int32_t g = 0; g < mesh->group_count; g++) {
        const brunt_group *group = &mesh->groups[g];
        BRUNT_TRY(brunt_check_name_ends(what, g, group->name, error));
        BRUNT_TRY(brunt_check_array(what, group->count, group->nodes, error));
        for (int32_t i = 0; i < group->count; i++) {
            const int32_t node = group->nodes[i];
            if (node < 0 || node >= mesh->node_count)
                REFUSE("%s.mesh: group '%s' has node %d, the mesh has %d", owner, group->name, node, mesh->node_count);
            if (i > 0 && node <= group->nodes[i - 1])
                REFUSE("%s.mesh: group '%s' has node %d after %d: nodes must ascend, each once", owner, group->name,
                       node, group->nodes[i - 1]);
        }
    }
    return BRUNT_OK;
}

static int check_body(const brunt_world_def *def, const brunt_body_def *body, brunt_error *error) {
    static const char *const axes[] = {".grading.x", ".grading.y", ".grading.z"};
    char owner[80];
    snprintf(owner, sizeof owner, "bodies.%s", body->name);
    if (body->material < 0 || body->material >= def->material_count)
        REFUSE("%s.material: there is no material %d", owner, body->material);
    BRUNT_TRY(brunt_check_choice(owner, ".method", (unsigned)body->method, BRUNT_MEMBRANE + 1, error));
    BRUNT_TRY(brunt_check_choice(owner, ".hourglass", (unsigned)body->hourglass, BRUNT_HOURGLASS_VISCOUS + 1, error));
    BRUNT_TRY(brunt_check_choice(owner, ".fill", (unsigned)body->fill, BRUNT_FILL_RINGS + 1, error));
    for (int k = 0; k < brunt_body_number_count; k++) {
        const brunt_body_number *row = &brunt_body_numbers[k];
        BRUNT_CHECK_NUMBERS(owner, {row->key, brunt_body_number_in(body, row), row->count, row->rule});
    }
    if (body->particles_per_cell < 0) REFUSE("%s.particles_per_cell: %d is negative", owner, body->particles_per_cell);
    BRUNT_TRY(brunt_check_array(owner, body->face_count, body->faces, error));
    for (int32_t f = 0; f < body->face_count; f++) BRUNT_TRY(brunt_check_name_ends("faces", f, body->faces[f], error));
    for (int a = 0; a < BRUNT_COUNT(axes); a++) BRUNT_TRY(brunt_check_curve(owner, axes[a], &body->grading[a], error));
    BRUNT_TRY(brunt_check_placement(owner, &body->place, error));
    if (body->method != BRUNT_MPM && body->mesh.node_count) return check_mesh(owner, &body->mesh, error);
    if (body->method != BRUNT_MPM)
        BRUNT_TRY(brunt_check_choice(owner, ".element", (unsigned)body->element, BRUNT_ELEMENT_KINDS, error));
    return brunt_check_shape(owner, &body->shape, def->dimension, 0, error);
}

static int compare_body_names(const void *a, const void *b) {
    const brunt_body_def *const *p = a, *const *q = b;
    return strcmp((*p)->name, (*q)->name);
}

// Two bodies of one name stand side by side in the order of names.
static int check_body_names(const brunt_world_def *def, brunt_error *error) {
    const brunt_body_def **order;
    if (BRUNT_NEW(order, def->body_count + 1, "bodies in order of name", error)) return BRUNT_FAILED;
    for (int32_t i = 0; i < def->body_count; i++) order[i] = &def->bodies[i];
    qsort(order, (size_t)def->body_count, sizeof *order, compare_body_names);
    const brunt_body_def *twice = NULL;
    for (int32_t i = 1; i < def->body_count && !twice; i++)
        if (!strcmp(order[i - 1]->name, order[i]->name)) twice = order[i];
    brunt_free(order);
    if (twice) REFUSE("bodies.%s: two bodies have this name", twice->name);
    return BRUNT_OK;
}

static int check_bodies(const brunt_world_def *def, brunt_error *error) {
    for (int32_t i = 0; i < def->body_count; i++) {
        const brunt_body_def *body = &def->bodies[i];
        BRUNT_TRY(brunt_check_name_ends("bodies", i, body->name, error));
        if (!body->name[0]) REFUSE("bodies: body %d has no name", i + 1);
        BRUNT_TRY(check_body(def, body, error));
    }
    return check_body_names(def, error);
}

// ------------------------------------------------------------------------------------------ materials

// Ranges are looked at when the material is made.
static int check_parameters(const char *owner, const brunt_model *model, const double *value, brunt_error *error) {
    for (int k = 0; model && k < model->parameter_count && k < BRUNT_PARAMETER_LIMIT; k++) {
        const brunt_parameter *parameter = &model->parameters[k];
        if (isinf(value[k]) && value[k] == parameter->initial) continue;
        char key[64];
        snprintf(key, sizeof key, ".%s", parameter->key);
        const bool positive = parameter->min == 0 && parameter->min_open;
        BRUNT_TRY(brunt_check_number(owner, key, value[k],
                                     BRUNT_OR_NAN | (positive ? BRUNT_POSITIVE : BRUNT_ANY_NUMBER), error));
    }
    return BRUNT_OK;
}

static int check_materials(const brunt_world_def *def, brunt_error *error) {
    for (int32_t i = 0; i < def->material_count; i++) {
        const brunt_material_def *material = &def->materials[i];
        const char *const names[] = {material->name, material->strength, material->eos, material->failure};
        for (int k = 0; k < 4; k++) BRUNT_TRY(brunt_check_name_ends("materials", i, names[k], error));
        char owner[80];
        snprintf(owner, sizeof owner, "materials.%s", material->name);
        BRUNT_TRY(brunt_check_choice(owner, ".failure.action", (unsigned)material->failure_action,
                                     BRUNT_FAILURE_SOFTEN + 1, error));
        if (isfinite(material->density))
            BRUNT_TRY(brunt_check_number(owner, ".density", material->density, BRUNT_ANY_NUMBER, error));
        BRUNT_TRY(
            check_parameters(owner, brunt_find_strength(material->strength), material->strength_parameters, error));
        if (material->eos[0])
            BRUNT_TRY(check_parameters(owner, brunt_find_eos(material->eos), material->eos_parameters, error));
        if (material->bulk_viscosity)
            BRUNT_TRY(check_parameters(owner, &brunt_bulk_viscosity, material->viscosity_parameters, error));
        if (material->failure[0])
            BRUNT_TRY(
                check_parameters(owner, brunt_find_failure(material->failure), material->failure_parameters, error));
    }
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ boundaries

static int check_boundaries(const brunt_world_def *def, brunt_error *error) {
    for (brunt_boundary_entry e = {.w = -1}; brunt_boundary_entry_next(def, &e);) {
        BRUNT_TRY(brunt_check_name_ends("boundaries", e.w, e.kind->name(e.entry), error));
        if (e.kind->body) BRUNT_TRY(brunt_check_name_ends("boundaries", e.w, e.kind->body(e.entry), error));
        BRUNT_TRY(e.kind->check(def, e.entry, e.w, error));
    }
    return BRUNT_OK;
}

static int check_detonations(const brunt_world_def *def, brunt_error *error) {
    for (int32_t q = 0; q < def->detonation_count; q++) {
        const brunt_detonation_def *d = &def->detonations[q];
        char owner[80];
        snprintf(owner, sizeof owner, "detonations[%d]", q);
        BRUNT_TRY(brunt_check_name_ends("detonations", q, d->body, error));
        BRUNT_CHECK_NUMBERS(owner, {".point", d->point, 3, BRUNT_ANY_NUMBER},
                            {".normal", d->normal, 3, BRUNT_ANY_NUMBER}, {".time", &d->time, 1, BRUNT_ANY_NUMBER});
    }
    return BRUNT_OK;
}

static int check_boundary_names(const brunt_world_def *def, brunt_error *error) {
    const int32_t count = brunt_boundary_entry_count(def);
    char(*name)[BRUNT_NAME_LENGTH];
    brunt_names sorted;
    if (BRUNT_NEW(name, count + 1, "names of boundaries", error)) return BRUNT_FAILED;
    for (brunt_boundary_entry e = {.w = -1}; brunt_boundary_entry_next(def, &e);) brunt_boundary_name(&e, name[e.w]);
    int status = brunt_names_sort(&sorted, name[0], sizeof name[0], count, error);
    for (int32_t w = 0; w < count && !status; w++) {
        const int32_t first = brunt_names_find(&sorted, name[w], strlen(name[w]));
        if (first < w)
            status = brunt_fail(error, BRUNT_BAD_INPUT, "boundaries[%d] and boundaries[%d] have the same name '%s'",
                                first, w, name[w]);
    }
    brunt_names_free(&sorted);
    brunt_free(name);
    return status;
}

// ------------------------------------------------------------------------------------------ contact

static int check_contact(const brunt_world_def *def, brunt_error *error) {
    const brunt_contact_def *contact = &def->contact;
    BRUNT_TRY(brunt_check_choice("contact", ".method", (unsigned)contact->method, (unsigned)brunt_contact_method_count,
                                 error));
    BRUNT_TRY(
        brunt_check_choice("contact", ".form", (unsigned)contact->form, (unsigned)brunt_augury_form_count, error));
    BRUNT_TRY(brunt_check_choice("contact", ".touch", (unsigned)contact->touch, BRUNT_TOUCH_INELASTIC + 1, error));
    BRUNT_TRY(brunt_check_choice("contact", ".stop", (unsigned)contact->stop, BRUNT_STOP_SPRING + 1, error));
    BRUNT_TRY(brunt_check_choice("contact", ".surface", (unsigned)contact->surface, BRUNT_SURFACE_ARCS + 1, error));
    BRUNT_TRY(brunt_check_choice("contact", ".transfer", (unsigned)contact->transfer, BRUNT_APIC + 1, error));
    if (!(contact->friction >= 0)) REFUSE("contact.friction: %g is negative", contact->friction);
    if (contact->iterations < -1) REFUSE("contact.iterations: %d is negative", contact->iterations);
    if (!(contact->tolerance >= 0 && contact->tolerance < 1))
        REFUSE("contact.tolerance: %g is not in [0, 1)", contact->tolerance);
    BRUNT_CHECK_NUMBERS("contact", {".friction", &contact->friction, 1, BRUNT_ANY_NUMBER},
                        {".cell", &contact->cell, 1, BRUNT_NOT_NEGATIVE},
                        {".distance", &contact->distance, 1, BRUNT_NOT_NEGATIVE},
                        {".stiffness", &contact->stiffness, 1, BRUNT_NOT_NEGATIVE},
                        {".penalty", &contact->penalty, 1, BRUNT_NOT_NEGATIVE},
                        {".slip_speed", &contact->slip_speed, 1, BRUNT_NOT_NEGATIVE},
                        {".slip_length", &contact->slip_length, 1, BRUNT_NOT_NEGATIVE});
    if (contact->friction_iterations < 1)
        REFUSE("contact.friction_iterations: %d is less than 1", contact->friction_iterations);
    for (int32_t q = 0; q < contact->pair_count; q++) {
        const brunt_pair_def *pair = &contact->pairs[q];
        char owner[80];
        snprintf(owner, sizeof owner, "contact.pairs[%d]", q);
        BRUNT_TRY(brunt_check_name_ends("contact.pairs", q, pair->a, error));
        BRUNT_TRY(brunt_check_name_ends("contact.pairs", q, pair->b, error));
        BRUNT_TRY(
            brunt_check_choice(owner, ".method", (unsigned)pair->method, (unsigned)brunt_contact_method_count, error));
        BRUNT_TRY(brunt_check_choice(owner, ".sides", (unsigned)pair->sides, BRUNT_SIDES_SLAVE + 1, error));
        BRUNT_CHECK_NUMBERS(owner, {".friction", &pair->friction, 1, BRUNT_ANY_NUMBER});
    }
    int32_t one[2], other[2];
    if (brunt_pairs_of_one_name(def, one, other))
        REFUSE("contact: the pair of '%s' and '%s' has the name of that of '%s' and '%s'", def->bodies[other[0]].name,
               def->bodies[other[1]].name, def->bodies[one[0]].name, def->bodies[one[1]].name);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ the world

static int check_arrays(const brunt_world_def *def, brunt_error *error) {
    if (def->body_count == 0) REFUSE("bodies: there is none");
    BRUNT_TRY(brunt_check_array("materials", def->material_count, def->materials, error));
    BRUNT_TRY(brunt_check_array("bodies", def->body_count, def->bodies, error));
#define CHECK(NAME, kind, type, word, what)                                                                            \
    BRUNT_TRY(brunt_check_array("boundaries: " #kind "s", def->kind##_count, def->kind##s, error));
    BRUNT_BOUNDARY_KINDS(CHECK)
#undef CHECK
    BRUNT_TRY(brunt_check_array("boundaries", def->boundary_count, def->boundaries, error));
    BRUNT_TRY(brunt_check_array("detonations", def->detonation_count, def->detonations, error));
    return brunt_check_array("contact.pairs", def->contact.pair_count, def->contact.pairs, error);
}

static int check_end(const brunt_world_def *def, brunt_error *error) {
    if (def->scheme == BRUNT_STATIC) {
        if (def->end != 0 && def->end != 1)
            REFUSE("time.end: %g s: load steps run over a pseudo-time from 0 to 1, none or 1 is wanted", def->end);
        return BRUNT_OK;
    }
    if (!(def->end > 0) || !isfinite(def->end)) REFUSE("time.end: %g s is not a positive time", def->end);
    BRUNT_CHECK_NUMBERS("", {"time.end", &def->end, 1, BRUNT_POSITIVE});
    return BRUNT_OK;
}

static int check_background(const brunt_mesh *mesh, brunt_error *error) {
    if (!mesh->node_count) REFUSE("grid.cells.mesh: there is none");
    BRUNT_TRY(check_mesh("grid.cells", mesh, error));
    if (mesh->kind != BRUNT_TRI3)
        REFUSE("grid.cells.mesh: its elements are of kind %s, tri3 is wanted", brunt_element_name(mesh->kind));
    return BRUNT_OK;
}

static int check_time_and_grid(const brunt_world_def *def, bool particles, brunt_error *error) {
    if (particles && (!(def->cell > 0) || !isfinite(def->cell)))
        REFUSE("grid.cell: %g m is not a positive length", def->cell);
    if ((int)def->kernel < BRUNT_LINEAR || def->kernel > BRUNT_CUBIC)
        REFUSE("grid.kernel: there is no kernel %d", (int)def->kernel);
    BRUNT_TRY(brunt_check_choice("grid", ".cells", (unsigned)def->cells, BRUNT_MESH_CELLS + 1, error));
    if (def->cells == BRUNT_MESH_CELLS) BRUNT_TRY(check_background(&def->background, error));
    if ((unsigned)def->transfer > BRUNT_APIC) REFUSE("grid.transfer: there is no transfer %d", (int)def->transfer);
    if (!(def->flip >= 0 && def->flip <= 1)) REFUSE("grid.transfer.flip: %g is not between 0 and 1", def->flip);
    if (!(def->apic >= 0 && def->apic <= 0.98)) REFUSE("grid.transfer.apic: %g is not between 0 and 0.98", def->apic);
    if (!(def->cfl >= 0 && def->cfl <= 1)) REFUSE("time.cfl: %g is not in (0, 1]", def->cfl);
    if (!(def->step >= 0) || !isfinite(def->step)) REFUSE("time.step: %g s is not a positive time", def->step);
    if (!(def->least_step >= 0) || !isfinite(def->least_step))
        REFUSE("time.least_step: %g s is not a time", def->least_step);
    BRUNT_TRY(check_end(def, error));
    if (!(def->energy_limit > 0)) REFUSE("time.energy_limit: %g is not positive", def->energy_limit);
    BRUNT_CHECK_NUMBERS("", {"grid.cell", &def->cell, 1, BRUNT_ANY_NUMBER},
                        {"grid.origin", def->origin, def->dimension, BRUNT_ANY_NUMBER},
                        {"time.step", &def->step, 1, BRUNT_ANY_NUMBER},
                        {"time.least_step", &def->least_step, 1, BRUNT_ANY_NUMBER},
                        {"loads.gravity", def->gravity, def->dimension, BRUNT_ANY_NUMBER},
                        {"loads.gravity_ramp", &def->gravity_ramp, 1, BRUNT_NOT_NEGATIVE});
    if (def->threads < 0 || def->threads > BRUNT_THREAD_LIMIT)
        REFUSE("threads: %d is not between 0 (all) and %d", def->threads, BRUNT_THREAD_LIMIT);
    return BRUNT_OK;
}

// What is not the same all around the axis cannot be computed as rings.
static int check_axis(const brunt_world_def *def, bool particles, brunt_error *error) {
    const double at = -def->origin[0] / def->cell;
    if (def->dimension != 2) REFUSE("axisymmetric: dimension %d, 2 is wanted", def->dimension);
    if (particles && !(fabs(at - round(at)) < ON_GRID_LINE))
        REFUSE("grid.origin: the axis of revolution, x = 0, must lie on a line of the grid (cell %g m)", def->cell);
    if (def->gravity[0] != 0)
        REFUSE("loads.gravity: %g m/s^2 along x, away from the axis of revolution: only y is possible",
               def->gravity[0]);
    for (int i = 0; i < def->body_count; i++)
        for (int a = 0; a < 3; a++)
            if (def->bodies[i].spin[a] != 0)
                REFUSE("bodies.%s.spin: rings do not turn in their plane", def->bodies[i].name);
    for (int q = 0; q < def->plane_count; q++) {
        const brunt_plane_def *plane = &def->planes[q];
        const brunt_condition_row *row = &brunt_conditions[plane->condition];
        const bool round_axis = plane->normal[0] != 0 && plane->normal[1] == 0;
        if (round_axis && (row->images || (row->symmetry && plane->point[0] == 0)))
            REFUSE("boundaries[%d]: a cylinder is no plane of symmetry, and the axis of revolution x = 0 needs none",
                   q);
    }
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ the scheme

static void refuse_first(void *context, const char *path, const char *reason) {
    brunt_error *error = context;
    if (!error->code) brunt_fail(error, BRUNT_BAD_INPUT, "%s: %s", path, reason);
}

static int check_newton(const brunt_world_def *def, brunt_error *error) {
    const brunt_newton_def *newton = &def->newton;
    BRUNT_TRY(brunt_check_choice("time", ".integrator", (unsigned)def->integrator, BRUNT_NEWMARK + 1, error));
    BRUNT_TRY(brunt_check_choice("time", ".predictor", (unsigned)def->predictor, BRUNT_PREDICTOR_NONE + 1, error));
    BRUNT_TRY(brunt_check_choice("newton", ".solver", (unsigned)newton->solver, BRUNT_SOLVER_MATRIX_FREE + 1, error));
    BRUNT_CHECK_NUMBERS("newton", {".tolerance", &newton->tolerance, 1, BRUNT_POSITIVE});
    if (newton->iterations < 1) REFUSE("newton.iterations: %d is less than 1", newton->iterations);
    if (newton->cut < 0) REFUSE("newton.cut: %d is negative", newton->cut);
    if (!(newton->accuracy > 0 && newton->accuracy < 1))
        REFUSE("newton.accuracy: %g is not between 0 and 1", newton->accuracy);
    return BRUNT_OK;
}

// What a scheme cannot do is refused, never left out.
static int check_scheme(const brunt_world_def *def, brunt_error *error) {
    BRUNT_TRY(brunt_check_choice("time", ".scheme", (unsigned)def->scheme, BRUNT_STATIC + 1, error));
    if (brunt_scheme_minimises(def->scheme)) BRUNT_TRY(check_newton(def, error));
    brunt_error first = {.code = BRUNT_OK};
    brunt_scheme_refusals(def, refuse_first, &first);
    if (!first.code) return BRUNT_OK;
    return brunt_fail(error, BRUNT_BAD_INPUT, "%.*s", (int)sizeof first.message - 1, first.message);
}

int brunt_definition_check(const brunt_world_def *def, brunt_error *error) {
    if (!def) REFUSE("there is no definition of a world");
    if (def->cookie != BRUNT_WORLD_COOKIE) REFUSE("the world's definition was not made by brunt_world_def_default");
    if (def->dimension != 2 && def->dimension != 3) REFUSE("dimension: %d is neither 2 nor 3", def->dimension);
    BRUNT_TRY(check_arrays(def, error));
    BRUNT_TRY(brunt_listed_kinds_check(def, error));
    bool particles = false;
    for (int32_t i = 0; i < def->body_count; i++) particles = particles || def->bodies[i].method == BRUNT_MPM;
    BRUNT_TRY(check_time_and_grid(def, particles, error));
    BRUNT_TRY(check_bodies(def, error));
    BRUNT_TRY(check_materials(def, error));
    BRUNT_TRY(check_boundaries(def, error));
    BRUNT_TRY(check_boundary_names(def, error));
    BRUNT_TRY(check_detonations(def, error));
    BRUNT_TRY(check_contact(def, error));
    if (def->axisymmetric) BRUNT_TRY(check_axis(def, particles, error));
    return check_scheme(def, error);
}
