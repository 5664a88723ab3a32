// What a world does and does not do: effects, passes, arrays.
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "contact/methods/method.h"
#include "scheme/scheme.h"

// The first model that brings an effect, NULL when none does; `flag`: where brunt_model says so.
static const brunt_model *find_model(const brunt_bodies *bodies, size_t flag) {
    for (int i = 0; i < bodies->count; i++)
        for (int k = 0; k < BRUNT_COMPONENTS; k++) {
            const brunt_body_ref *body = &bodies->all[i];
            const brunt_model *model = body->ops->material(body)->model[k];
            if (model && *(const bool *)((const char *)model + flag)) return model;
        }
    return NULL;
}

static bool has_hourglass(const brunt_bodies *bodies) {
    for (int k = 0; k < bodies->fem_count; k++)
        if (brunt_fem_has_hourglass(&bodies->fem[k])) return true;
    return false;
}

static bool has_total_lagrangian(const brunt_bodies *bodies) {
    for (int i = 0; i < bodies->mpm_count; i++)
        if (brunt_total_lagrangian(&bodies->mpm[i].particles)) return true;
    return false;
}

static bool has_tension_only(const brunt_bodies *bodies) {
    for (int k = 0; k < bodies->fem_count; k++)
        if (bodies->fem[k].material.tension_only) return true;
    return false;
}

static bool has_softening(const brunt_bodies *bodies) {
    for (int i = 0; i < bodies->count; i++) {
        const brunt_body_ref *body = &bodies->all[i];
        const brunt_material *material = body->ops->material(body);
        if (material->model[BRUNT_FAILURE] && material->failure_action == BRUNT_FAILURE_SOFTEN) return true;
    }
    return false;
}

static bool has_tied(const brunt_pairs *pairs) {
    for (int p = 0; p < pairs->count; p++)
        if (brunt_contact_node_law(pairs->pair[p].method)) return true;
    return false;
}

static bool has_slaves(const brunt_pairs *pairs) {
    for (int p = 0; p < pairs->count; p++)
        if (pairs->pair[p].slaves != BRUNT_SLAVES_BOTH) return true;
    return false;
}

static bool has_membranes(const brunt_bodies *bodies) {
    for (int k = 0; k < bodies->fem_count; k++)
        if (bodies->fem[k].traits->membrane) return true;
    return false;
}

// That they are there, and what contact does otherwise at them: to stop a node gives nothing back.
static const char *membranes_because(const brunt_contact *contact) {
    return contact->rows && contact->has_surfaces && contact->def.touch == BRUNT_TOUCH_ELASTIC
               ? "bodies: method membrane; contact with them gives nothing back (contact.touch)"
               : "bodies: method membrane";
}

static bool has_mass_scaling(const brunt_bodies *bodies) {
    for (int k = 0; k < bodies->fem_count; k++)
        if (bodies->fem[k].field[BRUNT_ELEMENT_density_scale].components) return true;
    return false;
}

// Besides the axis of rings.
static bool has_symmetry_planes(const brunt_boundaries *boundaries) {
    return boundaries->symmetry_count > 0 && boundaries->symmetry[boundaries->symmetry_count - 1].boundary >= 0;
}

#define BRUNT_EFFECTS(X)                                                                                               \
    X(implicit, brunt_scheme_minimises(world->settings.scheme), "time.scheme")                                         \
    X(equilibrium, world->settings.scheme == BRUNT_STATIC, "time.scheme: static")                                      \
    X(elements, world->bodies.fem_count > 0, "bodies: method fem or membrane")                                         \
    X(affine, world->settings.transfer == BRUNT_APIC && world->bodies.mpm_count > 0, "grid.transfer")                  \
    X(kept_share, world->settings.apic > 0 && world->bodies.mpm_count > 0, "grid.transfer.apic")                       \
    X(contact, world->contact.rows != 0, "contact.method")                                                             \
    X(barrier, world->contact.has_barrier, "contact.method: barrier or penalty")                                       \
    X(tied, has_tied(&world->pairs), "contact.pairs: method tied")                                                     \
    X(self_contact, world->contact.has_self, "contact.pairs: a body with itself")                                      \
    X(one_way_contact, has_slaves(&world->pairs), "contact.pairs: sides slave")                                        \
    X(friction, world->contact.has_friction || world->boundaries.has_friction, "friction of contact or boundaries")    \
    X(surfaces, world->contact.has_surfaces, "contact of meshes, or planes they may meet")                             \
    X(hourglass, has_hourglass(&world->bodies), "bodies: elements with hourglass modes")                               \
    X(mass_scaling, has_mass_scaling(&world->bodies), "bodies: mass_scaling")                                          \
    X(groups, world->boundaries.sets.act, "boundaries: group")                                                         \
    X(gas, world->boundaries.sets.has_gas, "boundaries: gas")                                                          \
    X(damping, world->boundaries.damping.active, "bodies: damping")                                                    \
    X(membranes, has_membranes(&world->bodies), membranes_because(&world->contact))                                    \
    X(tension_only, has_tension_only(&world->bodies), "bodies: tension_only")                                          \
    X(total_lagrangian, has_total_lagrangian(&world->bodies), "bodies: lagrangian total")                              \
    X(boundaries, world->boundaries.meets_points, "boundaries: condition separate, line, mesh")                        \
    X(axisymmetric, world->settings.axisymmetric, "axisymmetric")                                                      \
    X(symmetry, has_symmetry_planes(&world->boundaries), "boundaries: condition symmetry, slip or stick")              \
    X(conditions, world->boundaries.has_conditions, "boundaries: planes that hold nodes, region")                      \
    X(erosion, world->erosion.active, "bodies: erosion, materials: failure")                                           \
    X(softening, has_softening(&world->bodies), "materials: failure.action soften")                                    \
    X(detonation, world->boundaries.has_detonations, "detonations")                                                    \
    X(gravity, world->settings.has_gravity, "loads.gravity")

#define BRUNT_MODEL_EFFECTS(X)                                                                                         \
    X(plasticity, plastic)                                                                                             \
    X(rate_dependence, rate_dependent)                                                                                 \
    X(thermal, thermal)                                                                                                \
    X(equation_of_state, eos)                                                                                          \
    X(bulk_viscosity, viscous) X(fluid, fluid) X(shear_viscosity, shear_viscous) X(damage, damage)

enum {
#define COUNT(name, ...) EFFECT_##name,
    BRUNT_EFFECTS(COUNT) BRUNT_MODEL_EFFECTS(COUNT) EFFECT_COUNT
#undef COUNT
};

int32_t brunt_effect_count(const brunt_world *world) {
    (void)world;
    return EFFECT_COUNT;
}

bool brunt_effect_on(const brunt_world *world, const char *name) {
    static const char *const names[] = {
#define NAME(name, ...) #name,
        BRUNT_EFFECTS(NAME) BRUNT_MODEL_EFFECTS(NAME)
#undef NAME
    };
    _Static_assert(BRUNT_COUNT(names) == EFFECT_COUNT, "a name for each effect");
    for (int32_t e = 0; e < EFFECT_COUNT; e++)
        if (!strcmp(names[e], name)) return brunt_world_effect(world, e).on;
    return false;
}

brunt_effect brunt_world_effect(const brunt_world *world, int32_t effect) {
    switch (effect) {
#define ROW(name, on, key)                                                                                             \
    case EFFECT_##name: return (brunt_effect){#name, on, (on) ? key : ""};
        BRUNT_EFFECTS(ROW)
#undef ROW
#define ROW(effect_name, flag)                                                                                         \
    case EFFECT_##effect_name: {                                                                                       \
        const brunt_model *model = find_model(&world->bodies, offsetof(brunt_model, flag));                            \
        return (brunt_effect){#effect_name, model != NULL, model ? model->name : ""};                                  \
    }
        BRUNT_MODEL_EFFECTS(ROW)
#undef ROW
    default: return (brunt_effect){"", false, ""};
    }
}

// The pass that a further part of it belongs to.
static int find_pass(const brunt_plan *plan, const char *name) {
    for (int p = 0; p < plan->pass_count; p++)
        if (!strcmp(plan->pass[p]->name, name)) return p;
    BRUNT_ASSERT(!"a part of a pass that is not in the table, or not wanted");
    return 0;
}

void brunt_plan_make(brunt_plan *plan, const brunt_world *world) {
    *plan = (brunt_plan){.row_count = 0};
    const bool implicit = brunt_scheme_minimises(world->settings.scheme);
    const brunt_pass_row *table = implicit ? brunt_implicit_passes : brunt_explicit_passes;
    for (int i = 0; i < (implicit ? brunt_implicit_pass_count : brunt_explicit_pass_count); i++) {
        const brunt_pass_row *row = &table[i];
        if (!row->wanted(world)) continue;
        plan->row[plan->row_count++] = row;
        if (row->kind != BRUNT_PASS_PART) plan->pass[plan->pass_count++] = row;
    }
    for (int i = 0; i < plan->row_count; i++) plan->pass_of[i] = find_pass(plan, plan->row[i]->name);
}

void brunt_plan_validate(const brunt_plan *plan) {
    BRUNT_ASSERT(plan->row_count >= 1 && plan->row_count <= BRUNT_PASS_LIMIT);
    BRUNT_ASSERT(plan->pass_count >= 1 && plan->pass_count <= plan->row_count);
    for (int i = 0; i < plan->row_count; i++) {
        const int pass = plan->pass_of[i];
        BRUNT_ASSERT(pass >= 0 && pass < plan->pass_count && !strcmp(plan->pass[pass]->name, plan->row[i]->name));
        BRUNT_ASSERT(!i || plan->row[i - 1] < plan->row[i]); // in the order of the table
    }
}

int32_t brunt_pass_count(const brunt_world *world) { return world->plan.pass_count; }

static const char *unit_of(const brunt_bodies *bodies, const brunt_pass_row *row) {
    if (strcmp(row->unit, "point") != 0) return row->unit;
    return !bodies->fem_count ? "particle" : !bodies->mpm_count ? "element" : row->unit;
}

brunt_pass brunt_world_pass(const brunt_world *world, int32_t index) {
    if (index < 0 || index >= world->plan.pass_count) return (brunt_pass){.name = "", .unit = ""};
    const brunt_pass_row *row = world->plan.pass[index];
    const brunt_pass_time *time = &world->timing.passes[index];
    const brunt_amount work = brunt_pass_work(world, row);
    brunt_pass pass = {.name = row->name,
                       .calls = time->calls,
                       .seconds = time->seconds,
                       .unit = unit_of(&world->bodies, row),
                       .units = time->units,
                       .bytes_per_unit = work.bytes,
                       .flops_per_unit = work.flops};
    for (size_t t = 0; t < sizeof pass.thread_seconds / sizeof pass.thread_seconds[0]; t++)
        pass.thread_seconds[t] = time->threads.seconds[t];
    return pass;
}

// Arrays: those of each body, then the surfaces of meshes, or what implicit steps have.
int32_t brunt_array_count(const brunt_world *world) {
    return world->bodies.first_array[world->bodies.count] + (world->contact.has_surfaces ? 1 : 0) +
           (world->plan.implicit ? 2 : 0);
}

static brunt_array particle_array(const brunt_body *body, int32_t index) {
    brunt_array array = {.unit = "", .components = 1};
    const brunt_particles *p = &body->particles;
    size_t fields = 0;
    for (int f = 0; f < p->field_count; f++) {
        size_t bytes = (size_t)p->field[f].components * (size_t)p->capacity * sizeof(real);
        fields += bytes;
        if (!bytes || index-- > 0) continue;
        snprintf(array.name, sizeof array.name, "%s.%s", body->name, p->field[f].name);
        array.unit = p->field[f].unit, array.components = p->field[f].components, array.bytes = bytes;
        return array;
    }
    snprintf(array.name, sizeof array.name, index ? "%s: grid" : "%s: ids and sort", body->name);
    array.bytes = index ? brunt_grid_bytes(&body->grid) : p->slab_bytes - fields;
    return array;
}

static brunt_array element_array(const brunt_fem_body *body, int32_t index) {
    brunt_array array = {.unit = "", .components = 1};
    size_t fields = 0;
    for (int f = 0; f < body->field_count; f++) {
        size_t bytes = (size_t)body->field[f].components * (size_t)body->slots * sizeof(real);
        fields += bytes;
        if (!bytes || index-- > 0) continue;
        snprintf(array.name, sizeof array.name, "%s.%s", body->name, body->field[f].name);
        array.unit = body->field[f].unit, array.components = body->field[f].components, array.bytes = bytes;
        return array;
    }
    size_t nodes = (size_t)body->node_count * (BRUNT_FEM_NODE_REALS + 4) * sizeof(real), all = brunt_fem_bytes(body);
    snprintf(array.name, sizeof array.name, index ? "%s: mesh and forces" : "%s: nodes", body->name);
    array.bytes = index ? (all > nodes + fields ? all - nodes - fields : 0) : nodes;
    return array;
}

static brunt_array surfaces_array(const brunt_contact *contact) {
    brunt_array array = {.name = "contact of surfaces", .unit = "", .components = 1};
    array.bytes = brunt_surface_bytes(&contact->surface) + brunt_node_to_facet_bytes(contact->node_to_facet) +
                  contact->constraints.constraint_capacity + contact->constraints.entry_capacity +
                  contact->constraints.dof_node_capacity;
    return array;
}

brunt_array brunt_world_array(const brunt_world *world, int32_t index) {
    const brunt_bodies *bodies = &world->bodies;
    const int i = brunt_bodies_holding(bodies, bodies->first_array, index);
    const brunt_body_ref *body = &bodies->all[i];
    index -= bodies->first_array[i];
    if (i < bodies->count) return body->mpm ? particle_array(body->mpm, index) : element_array(body->fem, index);
    if (world->contact.has_surfaces && index-- == 0) return surfaces_array(&world->contact);
    brunt_array implicit = {.unit = "", .components = 1};
    snprintf(implicit.name, sizeof implicit.name, index ? "implicit steps: matrix" : "implicit steps: unknowns");
    implicit.bytes = index ? brunt_implicit_matrix_bytes(&world->plan) : brunt_implicit_bytes(world);
    return implicit;
}
