// Looks a definition over before a world is made of it: whatever it holds, the answer is a code and a message. What
// takes the bodies themselves to know (which groups a mesh has, what lies where) is found where they are made.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contact/planes/condition.h"
#include "world/definitions.h"
#include "base/error.h"
#include "base/memory.h"
#include "materials/material.h"
#include "world/world.h"

static const double ON_GRID_LINE =
    1e-6;                         // cells: how far off the axis of revolution may be and still count as on the line
static const double RIGID = 1e-6; // how far a rotation may be off one
enum { SHAPES_DEEP = 64 };

#define REFUSE(...) return brunt_fail(error, BRUNT_BAD_INPUT, __VA_ARGS__)
#define TRY(...)                                                                                                       \
    do {                                                                                                               \
        const int tried = (__VA_ARGS__);                                                                               \
        if (tried) return tried;                                                                                       \
    } while (0)

// ------------------------------------------------------------------------------------------ what all have

enum {
    ANY = BRUNT_ANY_NUMBER,
    NOT_NEGATIVE = BRUNT_NOT_NEGATIVE,
    POSITIVE = BRUNT_POSITIVE,
    OR_INFINITE = BRUNT_OR_INFINITE,
    OR_NAN = BRUNT_OR_NAN
};

static int check_number(const char *owner, const char *key, double v, int rule, brunt_error *error) {
    const bool positive = rule & POSITIVE;
    if ((isnan(v) && rule & OR_NAN) || (isinf(v) && rule & OR_INFINITE)) return BRUNT_OK;
    if (!isfinite(v)) REFUSE("%s%s: %g is not a finite number", owner, key, v);
    if ((positive && !(v > 0)) || (rule & NOT_NEGATIVE && v < 0))
        REFUSE("%s%s: %g is %s", owner, key, v, positive ? "not above 0" : "negative");
    if (fabs(v) > BRUNT_GREATEST_NUMBER)
        REFUSE("%s%s: %g is too large a number, at most %g is wanted", owner, key, v, BRUNT_GREATEST_NUMBER);
    if (v != 0 && fabs(v) < (positive ? BRUNT_LEAST_NUMBER : BRUNT_LEAST_NORMAL))
        REFUSE("%s%s: %g is too small a number", owner, key, v);
    return BRUNT_OK;
}

typedef struct numbers {
    const char *key;
    const double *value;
    int count, rule;
} numbers;

static int check_numbers(const char *owner, const numbers *list, size_t count, brunt_error *error) {
    for (size_t k = 0; k < count; k++)
        for (int c = 0; c < list[k].count; c++)
            TRY(check_number(owner, list[k].key, list[k].value[c], list[k].rule, error));
    return BRUNT_OK;
}
#define CHECK_NUMBERS(owner, ...)                                                                                      \
    TRY(check_numbers(owner, (const numbers[]){__VA_ARGS__}, sizeof((const numbers[]){__VA_ARGS__}) / sizeof(numbers), \
                      error))

static int check_array(const char *what, int32_t count, const void *array, brunt_error *error) {
    if (count < 0) REFUSE("%s: there are %d", what, count);
    if (count > 0 && !array) REFUSE("%s: there are %d, and no array of them", what, count);
    return BRUNT_OK;
}

// A name ends within its array.
static int check_name(const char *what, int index, const char name[BRUNT_NAME_LENGTH], brunt_error *error) {
    if (!memchr(name, 0, BRUNT_NAME_LENGTH))
        REFUSE("%s[%d]: a name of more than %d bytes, or without its end", what, index, BRUNT_NAME_LENGTH - 1);
    return BRUNT_OK;
}

// An enumerator is one of the first `count` numbers.
static int check_choice(const char *owner, const char *key, unsigned value, unsigned count, brunt_error *error) {
    if (value >= count) REFUSE("%s%s: there is no choice %d", owner, key, (int)value);
    return BRUNT_OK;
}

static int check_curve(const char *owner, const char *key, const brunt_curve *curve, brunt_error *error) {
    char what[160];
    snprintf(what, sizeof what, "%s%s", owner, key);
    TRY(check_array(what, curve->count, curve->points, error));
    for (int32_t k = 0; k < curve->count; k++) CHECK_NUMBERS(owner, {key, curve->points[k], 2, ANY});
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ shapes and places

static int check_shape(const char *owner, const brunt_shape *shape, int dim, int depth, brunt_error *error) {
    TRY(check_choice(owner, ".shape", (unsigned)shape->kind, BRUNT_INTERSECTION + 1, error));
    if (depth > SHAPES_DEEP) REFUSE("%s.shape: shapes of shapes, more than %d deep", owner, SHAPES_DEEP);
    if (shape->kind >= BRUNT_UNION) {
        TRY(check_array(owner, shape->child_count, shape->children, error));
        if (!shape->child_count) REFUSE("%s.shape: a union, difference or intersection of nothing", owner);
        for (int32_t c = 0; c < shape->child_count; c++)
            TRY(check_shape(owner, &shape->children[c], dim, depth + 1, error));
        return BRUNT_OK;
    }
    const bool box = shape->kind == BRUNT_BOX, prism = shape->kind == BRUNT_PRISM,
               plane = shape->kind == BRUNT_HALF_SPACE, ball = shape->kind == BRUNT_SPHERE,
               ring = shape->kind == BRUNT_RING, axial = plane || shape->kind == BRUNT_CYLINDER || (ring && dim == 3);
    const int centred = box || prism ? 0 : dim, whole = box ? dim : 0, high = prism && dim == 3;
    CHECK_NUMBERS(owner, {".shape: min", shape->min, whole, ANY}, {".shape: max", shape->max, whole, ANY},
                  {".shape: min", shape->min + 2, high, ANY}, {".shape: max", shape->max + 2, high, ANY},
                  {".shape: center", shape->center, centred, ANY}, {".shape: axis", shape->axis, axial ? dim : 0, ANY},
                  {".shape: radius", &shape->radius, centred && !plane, POSITIVE},
                  {".shape: inner_radius", &shape->inner_radius, ring, POSITIVE},
                  {".shape: length", &shape->length, axial && !plane && !ball, POSITIVE});
    bool direction = !axial;
    for (int a = 0; a < dim; a++) direction = direction || shape->axis[a] != 0;
    if (!direction) REFUSE("%s.shape: the axis has no direction", owner);
    if (!prism) return BRUNT_OK;
    TRY(check_array(owner, shape->point_count, shape->points, error));
    if (shape->point_count < 3) REFUSE("%s.shape: a polygon of %d corners", owner, shape->point_count);
    for (int32_t k = 0; k < shape->point_count; k++) CHECK_NUMBERS(owner, {".shape: points", shape->points[k], 2, ANY});
    return BRUNT_OK;
}

static int check_place(const char *owner, const brunt_placement *place, brunt_error *error) {
    const double *R = place->rotation;
    CHECK_NUMBERS(owner, {".place", R, 9, ANY}, {".place", place->translation, 3, ANY});
    double off = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int c = 0; c < 3; c++) sum += R[3 * i + c] * R[3 * k + c];
            off = fmax(off, fabs(sum - (i == k)));
        }
    if (off > RIGID) REFUSE("%s.place: this is no rotation (brunt_placement_identity makes one)", owner);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ bodies

// Node numbers of elements are looked at with the elements (brunt_mesh_check).
static int check_mesh(const char *owner, const brunt_mesh *mesh, brunt_error *error) {
    char what[160];
    TRY(check_choice(owner, ".mesh: kind", (unsigned)mesh->kind, BRUNT_ELEMENT_KINDS, error));
    snprintf(what, sizeof what, "%s.mesh: nodes", owner);
    TRY(check_array(what, mesh->node_count, mesh->nodes, error));
    snprintf(what, sizeof what, "%s.mesh: elements", owner);
    TRY(check_array(what, mesh->element_count, mesh->elements, error));
    snprintf(what, sizeof what, "%s.mesh: groups", owner);
    TRY(check_array(what, mesh->group_count, mesh->groups, error));
    for (int32_t g = 0; g < mesh->group_count; g++) {
        const brunt_group *group = &mesh->groups[g];
        TRY(check_name(what, g, group->name, error));
        TRY(check_array(what, group->count, group->nodes, error));
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
    TRY(check_choice(owner, ".method", (unsigned)body->method, BRUNT_MEMBRANE + 1, error));
    TRY(check_choice(owner, ".hourglass", (unsigned)body->hourglass, BRUNT_HOURGLASS_VISCOUS + 1, error));
    TRY(check_choice(owner, ".fill", (unsigned)body->fill, BRUNT_FILL_RINGS + 1, error));
    for (int k = 0; k < brunt_body_number_count; k++) {
        const brunt_body_number *row = &brunt_body_numbers[k];
        CHECK_NUMBERS(owner, {row->key, brunt_body_number_in(body, row), row->count, row->rule});
    }
    if (body->particles_per_cell < 0) REFUSE("%s.particles_per_cell: %d is negative", owner, body->particles_per_cell);
    TRY(check_array(owner, body->face_count, body->faces, error));
    for (int32_t f = 0; f < body->face_count; f++) TRY(check_name("faces", f, body->faces[f], error));
    for (int a = 0; a < 3; a++) TRY(check_curve(owner, axes[a], &body->grading[a], error));
    TRY(check_place(owner, &body->place, error));
    if (body->method != BRUNT_MPM && body->mesh.node_count) return check_mesh(owner, &body->mesh, error);
    if (body->method != BRUNT_MPM)
        TRY(check_choice(owner, ".element", (unsigned)body->element, BRUNT_ELEMENT_KINDS, error));
    return check_shape(owner, &body->shape, def->dimension, 0, error);
}

static int compare_body_names(const void *a, const void *b) {
    const brunt_body_def *const *p = a, *const *q = b;
    return strcmp((*p)->name, (*q)->name);
}

// Two bodies of one name stand side by side in the order of names.
static int check_body_names(const brunt_world_def *def, brunt_error *error) {
    const brunt_body_def **order = brunt_alloc(((size_t)def->body_count + 1) * sizeof *order);
    if (!order) return brunt_fail(error, BRUNT_FAILED, "out of memory");
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
        TRY(check_name("bodies", i, body->name, error));
        if (!body->name[0]) REFUSE("bodies: body %d has no name", i + 1);
        TRY(check_body(def, body, error));
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
        TRY(check_number(owner, key, value[k], OR_NAN | (positive ? POSITIVE : ANY), error));
    }
    return BRUNT_OK;
}

static int check_materials(const brunt_world_def *def, brunt_error *error) {
    for (int32_t i = 0; i < def->material_count; i++) {
        const brunt_material_def *material = &def->materials[i];
        const char *const names[] = {material->name, material->strength, material->eos, material->failure};
        for (int k = 0; k < 4; k++) TRY(check_name("materials", i, names[k], error));
        char owner[80];
        snprintf(owner, sizeof owner, "materials.%s", material->name);
        TRY(check_choice(owner, ".failure.action", (unsigned)material->failure_action, BRUNT_FAILURE_SOFTEN + 1,
                         error));
        if (isfinite(material->density)) TRY(check_number(owner, ".density", material->density, ANY, error));
        TRY(check_parameters(owner, brunt_find_strength(material->strength), material->strength_parameters, error));
        if (material->eos[0])
            TRY(check_parameters(owner, brunt_find_eos(material->eos), material->eos_parameters, error));
        if (material->bulk_viscosity)
            TRY(check_parameters(owner, &brunt_bulk_viscosity, material->viscosity_parameters, error));
        if (material->failure[0])
            TRY(check_parameters(owner, brunt_find_failure(material->failure), material->failure_parameters, error));
    }
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ boundaries

static int check_planes(const brunt_world_def *def, brunt_error *error) {
    for (int32_t q = 0; q < def->plane_count; q++) {
        const brunt_plane_def *plane = &def->planes[q];
        char owner[80];
        snprintf(owner, sizeof owner, "boundaries[%d].plane", q);
        TRY(check_name("boundaries", q, plane->name, error));
        TRY(check_name("boundaries", q, plane->body, error));
        TRY(check_choice(owner, ".condition", (unsigned)plane->condition, (unsigned)brunt_condition_count, error));
        CHECK_NUMBERS(owner, {".point", plane->point, def->dimension, ANY},
                      {".normal", plane->normal, def->dimension, ANY}, {".friction", &plane->friction, 1, ANY},
                      {".velocity", plane->velocity, def->dimension, ANY});
    }
    return BRUNT_OK;
}

static int check_regions(const brunt_world_def *def, brunt_error *error) {
    for (int32_t q = 0; q < def->region_count; q++) {
        const brunt_region_def *region = &def->regions[q];
        char owner[80];
        snprintf(owner, sizeof owner, "boundaries[%d].region", def->plane_count + q);
        TRY(check_name("boundaries", def->plane_count + q, region->name, error));
        TRY(check_name("boundaries", def->plane_count + q, region->body, error));
        CHECK_NUMBERS(owner, {".velocity", region->velocity, def->dimension, ANY},
                      {".start", &region->start, 1, OR_INFINITE}, {".end", &region->end, 1, OR_INFINITE});
        TRY(check_shape(owner, &region->shape, def->dimension, 0, error));
        TRY(check_place(owner, &region->place, error));
    }
    return BRUNT_OK;
}

static int check_groups(const brunt_world_def *def, brunt_error *error) {
    for (int32_t q = 0; q < def->group_count; q++) {
        const brunt_group_def *group = &def->groups[q];
        const int32_t index = def->plane_count + def->region_count + q;
        const char *const names[] = {group->name, group->body, group->group};
        for (int k = 0; k < 3; k++) TRY(check_name("boundaries", index, names[k], error));
        char owner[80];
        snprintf(owner, sizeof owner, "boundaries[%d].group", index);
        TRY(check_choice(owner, ".action", (unsigned)group->action, BRUNT_GROUP_GAS + 1, error));
        TRY(check_curve(owner, ".table", &group->table, error));
        const brunt_gas_def *gas = &group->gas;
        const int filled = group->action == BRUNT_GROUP_GAS, turned = group->action == BRUNT_GROUP_ROTATION;
        const brunt_rotation_def *turn = &group->rotation;
        CHECK_NUMBERS(owner, {".rotation.angle", &turn->angle, turned, ANY},
                      {".rotation.axis", turn->axis, 3 * turned, ANY},
                      {".rotation.about", turn->about, 3 * turned, ANY});
        if (turned && !(turn->axis[0] || turn->axis[1] || turn->axis[2]))
            REFUSE("boundaries[%d].rotation.axis: the axis has zero length", index);
        if (turned && def->dimension == 2 && (turn->axis[0] || turn->axis[1]))
            REFUSE("boundaries[%d].rotation.axis: in two dimensions what turns does so about z", index);
        CHECK_NUMBERS(owner, {".value", group->value, filled ? 0 : 3, ANY}, {".gas.gamma", &gas->gamma, filled, ANY},
                      {".gas.pressure", &gas->pressure, filled, ANY}, {".gas.outside", &gas->outside, filled, ANY},
                      {".gas.volume", &gas->volume, filled, ANY}, {".gas.inflow", &gas->inflow, filled, ANY});
    }
    return BRUNT_OK;
}

// Facets name corners that there are.
static int check_facets(const brunt_boundary_surface_def *surface, int dim, int32_t index, brunt_error *error) {
    if (surface->point_count < 2 || surface->facet_count < 1)
        REFUSE("boundaries[%d]: a line wants two points at least", index);
    for (int32_t f = 0; f < surface->facet_count; f++)
        for (int c = 0; c < dim; c++)
            if (surface->facet[f][c] < 0 || surface->facet[f][c] >= surface->point_count)
                REFUSE("boundaries[%d]: facet %d has corner %d of %d", index, f, surface->facet[f][c],
                       surface->point_count);
    return BRUNT_OK;
}

static int check_surfaces(const brunt_world_def *def, brunt_error *error) {
    for (int32_t q = 0; q < def->surface_count; q++) {
        const brunt_boundary_surface_def *surface = &def->surfaces[q];
        const int32_t index = def->plane_count + def->region_count + def->group_count + q;
        char owner[80];
        snprintf(owner, sizeof owner, "boundaries[%d]", index);
        TRY(check_name("boundaries", index, surface->name, error));
        TRY(check_name("boundaries", index, surface->body, error));
        TRY(check_choice(owner, ".condition", (unsigned)surface->condition, BRUNT_SEPARATE + 1, error));
        TRY(check_array("boundaries: points", surface->point_count, surface->point, error));
        TRY(check_array("boundaries: facets", surface->facet_count, surface->facet, error));
        TRY(check_facets(surface, def->dimension, index, error));
        TRY(check_curve(owner, ".table", &surface->table, error));
        for (int32_t k = 0; k < surface->point_count; k++)
            CHECK_NUMBERS(owner, {".line.points", surface->point[k], 3, ANY});
        CHECK_NUMBERS(owner, {".friction", &surface->friction, 1, NOT_NEGATIVE}, {".value", surface->value, 3, ANY},
                      {".piece", &surface->piece, 1, POSITIVE}, {".about", surface->about, 3, ANY});
        if (surface->friction > 0 && surface->condition != BRUNT_SEPARATE)
            REFUSE("%s.friction: friction acts only with condition separate", owner);
        if (surface->particles < 1) REFUSE("%s.particles_per_cell: %d is less than 1", owner, surface->particles);
        if (!(def->cell > 0)) REFUSE("%s: it holds material points, and there are none", owner);
    }
    return BRUNT_OK;
}

static int check_detonations(const brunt_world_def *def, brunt_error *error) {
    for (int32_t q = 0; q < def->detonation_count; q++) {
        const brunt_detonation_def *d = &def->detonations[q];
        char owner[80];
        snprintf(owner, sizeof owner, "detonations[%d]", q);
        TRY(check_name("detonations", q, d->body, error));
        CHECK_NUMBERS(owner, {".point", d->point, 3, ANY}, {".normal", d->normal, 3, ANY}, {".time", &d->time, 1, ANY});
    }
    return BRUNT_OK;
}

// The name of its columns in the history: its own, or what world.c gives it.
static void wall_name(const brunt_world_def *def, int32_t w, char out[BRUNT_NAME_LENGTH]) {
    const int32_t region = w - def->plane_count, group = region - def->region_count, surface = group - def->group_count;
    const char *kind = region < 0 ? "plane" : group < 0 ? "region" : surface < 0 ? "group" : "surface";
    const char *given = region < 0    ? def->planes[w].name
                        : group < 0   ? def->regions[region].name
                        : surface < 0 ? def->groups[group].name
                                      : def->surfaces[surface].name;
    if (given[0])
        memcpy(out, given, BRUNT_NAME_LENGTH);
    else
        snprintf(out, BRUNT_NAME_LENGTH, "%s%d", kind, w + 1);
}

static int check_wall_names(const brunt_world_def *def, brunt_error *error) {
    const int32_t count = def->plane_count + def->region_count + def->group_count + def->surface_count;
    char name[BRUNT_NAME_LENGTH], other[BRUNT_NAME_LENGTH];
    for (int32_t w = 0; w < count; w++) {
        wall_name(def, w, name);
        for (int32_t k = 0; k < w; k++) {
            wall_name(def, k, other);
            if (!strcmp(name, other)) REFUSE("boundaries[%d] and boundaries[%d] have the same name '%s'", k, w, name);
        }
    }
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ contact

static int check_contact(const brunt_world_def *def, brunt_error *error) {
    const brunt_contact_def *contact = &def->contact;
    TRY(check_choice("contact", ".method", (unsigned)contact->method, BRUNT_CONTACT_BARRIER + 1, error));
    TRY(check_choice("contact", ".form", (unsigned)contact->form, BRUNT_AUGURY_PAPER + 1, error));
    TRY(check_choice("contact", ".transfer", (unsigned)contact->transfer, BRUNT_APIC + 1, error));
    if (!(contact->friction >= 0)) REFUSE("contact.friction: %g is negative", contact->friction);
    if (contact->iterations < -1) REFUSE("contact.iterations: %d is negative", contact->iterations);
    if (!(contact->tolerance >= 0 && contact->tolerance < 1))
        REFUSE("contact.tolerance: %g is not in [0, 1)", contact->tolerance);
    CHECK_NUMBERS("contact", {".friction", &contact->friction, 1, ANY}, {".cell", &contact->cell, 1, NOT_NEGATIVE},
                  {".distance", &contact->distance, 1, NOT_NEGATIVE},
                  {".stiffness", &contact->stiffness, 1, NOT_NEGATIVE},
                  {".slip_speed", &contact->slip_speed, 1, NOT_NEGATIVE});
    if (contact->friction_iterations < 1)
        REFUSE("contact.friction_iterations: %d is less than 1", contact->friction_iterations);
    for (int32_t q = 0; q < contact->pair_count; q++) {
        const brunt_pair_def *pair = &contact->pairs[q];
        char owner[80];
        snprintf(owner, sizeof owner, "contact.pairs[%d]", q);
        TRY(check_name("contact.pairs", q, pair->a, error));
        TRY(check_name("contact.pairs", q, pair->b, error));
        TRY(check_choice(owner, ".method", (unsigned)pair->method, BRUNT_CONTACT_BARRIER + 1, error));
        CHECK_NUMBERS(owner, {".friction", &pair->friction, 1, ANY});
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
    TRY(check_array("materials", def->material_count, def->materials, error));
    TRY(check_array("bodies", def->body_count, def->bodies, error));
    TRY(check_array("boundaries: planes", def->plane_count, def->planes, error));
    TRY(check_array("boundaries: regions", def->region_count, def->regions, error));
    TRY(check_array("boundaries: groups", def->group_count, def->groups, error));
    TRY(check_array("boundaries: surfaces", def->surface_count, def->surfaces, error));
    TRY(check_array("detonations", def->detonation_count, def->detonations, error));
    return check_array("contact.pairs", def->contact.pair_count, def->contact.pairs, error);
}

static int check_time_and_grid(const brunt_world_def *def, bool particles, brunt_error *error) {
    if (particles && (!(def->cell > 0) || !isfinite(def->cell)))
        REFUSE("grid.cell: %g m is not a positive length", def->cell);
    if ((int)def->kernel < BRUNT_LINEAR || def->kernel > BRUNT_CUBIC)
        REFUSE("grid.kernel: there is no kernel %d", (int)def->kernel);
    if ((unsigned)def->transfer > BRUNT_APIC) REFUSE("grid.transfer: there is no transfer %d", (int)def->transfer);
    if (!(def->flip >= 0 && def->flip <= 1)) REFUSE("grid.transfer.flip: %g is not between 0 and 1", def->flip);
    if (!(def->cfl >= 0 && def->cfl <= 1)) REFUSE("time.cfl: %g is not in (0, 1]", def->cfl);
    if (!(def->step >= 0) || !isfinite(def->step)) REFUSE("time.step: %g s is not a positive time", def->step);
    if (!(def->least_step >= 0) || !isfinite(def->least_step))
        REFUSE("time.least_step: %g s is not a time", def->least_step);
    if (!(def->end > 0) || !isfinite(def->end)) REFUSE("time.end: %g s is not a positive time", def->end);
    if (!(def->energy_limit > 0)) REFUSE("time.energy_limit: %g is not positive", def->energy_limit);
    CHECK_NUMBERS("", {"grid.cell", &def->cell, 1, ANY}, {"grid.origin", def->origin, def->dimension, ANY},
                  {"time.step", &def->step, 1, ANY}, {"time.least_step", &def->least_step, 1, ANY},
                  {"time.end", &def->end, 1, POSITIVE}, {"loads.gravity", def->gravity, def->dimension, ANY},
                  {"loads.gravity_ramp", &def->gravity_ramp, 1, NOT_NEGATIVE});
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
        if (round_axis && (row->images || (row->mirrors && plane->point[0] == 0)))
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
    TRY(check_choice("time", ".integrator", (unsigned)def->integrator, BRUNT_NEWMARK + 1, error));
    TRY(check_choice("newton", ".solver", (unsigned)newton->solver, BRUNT_SOLVER_PCG + 1, error));
    CHECK_NUMBERS("newton", {".tolerance", &newton->tolerance, 1, POSITIVE});
    if (newton->iterations < 1) REFUSE("newton.iterations: %d is less than 1", newton->iterations);
    if (newton->cut < 0) REFUSE("newton.cut: %d is negative", newton->cut);
    if (!(newton->accuracy > 0 && newton->accuracy < 1))
        REFUSE("newton.accuracy: %g is not between 0 and 1", newton->accuracy);
    return BRUNT_OK;
}

// What a scheme cannot do is refused, never left out.
static int check_scheme(const brunt_world_def *def, brunt_error *error) {
    TRY(check_choice("time", ".scheme", (unsigned)def->scheme, BRUNT_IMPLICIT + 1, error));
    if (def->scheme == BRUNT_IMPLICIT) TRY(check_newton(def, error));
    brunt_error first = {.code = BRUNT_OK};
    brunt_scheme_refusals(def, refuse_first, &first);
    if (!first.code) return BRUNT_OK;
    return brunt_fail(error, BRUNT_BAD_INPUT, "%.*s", (int)sizeof first.message - 1, first.message);
}

int brunt_definition_check(const brunt_world_def *def, brunt_error *error) {
    if (!def) REFUSE("there is no definition of a world");
    if (def->cookie != BRUNT_WORLD_COOKIE) REFUSE("the world's definition was not made by brunt_world_def_default");
    if (def->dimension != 2 && def->dimension != 3) REFUSE("dimension: %d is neither 2 nor 3", def->dimension);
    TRY(check_arrays(def, error));
    bool particles = false;
    for (int32_t i = 0; i < def->body_count; i++) particles = particles || def->bodies[i].method == BRUNT_MPM;
    TRY(check_time_and_grid(def, particles, error));
    TRY(check_bodies(def, error));
    TRY(check_materials(def, error));
    TRY(check_planes(def, error));
    TRY(check_regions(def, error));
    TRY(check_groups(def, error));
    TRY(check_surfaces(def, error));
    TRY(check_wall_names(def, error));
    TRY(check_detonations(def, error));
    TRY(check_contact(def, error));
    if (def->axisymmetric) TRY(check_axis(def, particles, error));
    return check_scheme(def, error);
}
