// Reading a body's fields, whatever it is made of.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "body/fields.h"
#include "world/world.h"
#include "base/error.h"

// Contact state of boundary nodes in the last step; elsewhere as of a node that touches nothing.
static const brunt_field_info contact_fields[] = {
    {"contact_gap", "m", 1, false, BRUNT_AT_NODES},       // to the nearest surface, NaN where none is near
    {"contact_traction", "Pa", 3, false, BRUNT_AT_NODES}, // impulse over the step and the node's area
    {"contact_state", "1", 1, false, BRUNT_AT_NODES},     // 0 free, 1 sticks, 2 slips
};
enum { CONTACT_FIELDS = sizeof contact_fields / sizeof contact_fields[0] };

static void read_contact(const brunt_world *world, const brunt_body_ref *ref, int32_t field, double *out) {
    const brunt_fem_body *fem = ref->fem;
    const brunt_contact_surface *s = &world->contact.surface;
    const int components = contact_fields[field].components;
    for (int64_t k = 0; k < (int64_t)fem->node_count * components; k++) out[k] = field == 0 ? NAN : 0;
    const int32_t body = (int32_t)(fem - world->bodies.fem);
    if (world->clock.steps == 0 || !s->active[body]) return;
    for (int32_t n = s->node_range[body]; n < s->node_end[body]; n++) {
        double *to = out + (int64_t)fem->node_id[s->node[n]] * components;
        if (field == 0) *to = isinf(s->output.gap[n]) ? NAN : s->output.gap[n];
        if (field == 2) *to = s->output.state[n];
        for (int a = 0; field == 1 && a < 3; a++)
            to[a] = s->area[n] > 0 && world->clock.kick > 0 ? s->output.impulse[n][a] / (s->area[n] * world->clock.kick)
                                                            : 0;
    }
}

// Where those of contact stand among the fields of a body: after its own at nodes, if it has any there. -1: nowhere.
static int32_t contact_place(const brunt_contact *contact, const brunt_body_ref *ref) {
    int32_t place = 0;
    while (place < ref->ops->field_count(ref) && ref->ops->field(ref, place).at == BRUNT_AT_NODES) place++;
    return contact->has_surfaces && place ? place : BRUNT_NONE;
}

// The number of a field among a body's own, or among those of contact.
static int32_t own_field(const brunt_contact *contact, const brunt_body_ref *ref, int32_t field, bool *of_contact) {
    const int32_t place = contact_place(contact, ref);
    *of_contact = place >= 0 && field >= place && field < place + CONTACT_FIELDS;
    if (*of_contact) return field - place;
    return place >= 0 && field >= place ? field - CONTACT_FIELDS : field;
}

int32_t brunt_body_field_count(const brunt_world *world, int32_t body) {
    const brunt_body_ref *ref = &world->bodies.all[body];
    return ref->ops->field_count(ref) + (contact_place(&world->contact, ref) < 0 ? 0 : CONTACT_FIELDS);
}

brunt_field_info brunt_body_field(const brunt_world *world, int32_t body, int32_t field) {
    const brunt_body_ref *ref = &world->bodies.all[body];
    bool of_contact;
    field = own_field(&world->contact, ref, field, &of_contact);
    return of_contact ? contact_fields[field] : ref->ops->field(ref, field);
}

int32_t brunt_body_find_field(const brunt_world *world, int32_t body, const char *name) {
    for (int32_t f = 0; name && f < brunt_body_field_count(world, body); f++)
        if (!strcmp(brunt_body_field(world, body, f).name, name)) return f;
    return BRUNT_NONE;
}

void brunt_body_read(brunt_world *world, int32_t body, int32_t field, double *out) {
    const brunt_body_ref *ref = &world->bodies.all[body];
    bool of_contact;
    field = own_field(&world->contact, ref, field, &of_contact);
    if (of_contact)
        read_contact(world, ref, field, out);
    else
        ref->ops->read(ref, field, out);
}

void brunt_body_connectivity(const brunt_world *world, int32_t body, int32_t *out) {
    brunt_mesh_connectivity(&world->bodies.all[body], out);
}

int32_t brunt_gas_count(const brunt_world *world) { return brunt_gas_sets(&world->boundaries.sets); }

void brunt_world_gas(const brunt_world *world, int32_t index, brunt_gas *gas) {
    *gas = brunt_gas_now(brunt_gas_number(&world->boundaries.sets, index));
}

int32_t brunt_warning_count(const brunt_world *world) { return world->messages.count; }
const char *brunt_world_warning(const brunt_world *world, int32_t warning) { return world->messages.text[warning]; }

static void fill_force(const brunt_impulse_account *last, const brunt_impulse_account *all, double kick,
                       brunt_reaction *force) {
    for (int k = 0; k < 3; k++) {
        force->force[k] = kick > 0 ? last->impulse[k] / kick : 0;
        force->impulse[k] = all->impulse[k];
    }
    force->normal_work = all->normal_loss;
    force->friction_work = all->friction_loss;
    force->area = last->area;
}

int32_t brunt_pair_count(const brunt_world *world) { return world->pairs.count; }
void brunt_pair_force(const brunt_world *world, int32_t index, brunt_reaction *force) {
    const brunt_pair *pair = &world->pairs.pair[index];
    const bool first = !index || pair[-1].a >= 0; // behind those of bodies with themselves
    if (pair->a < 0)
        snprintf(force->name, sizeof force->name, first ? "all" : "all%d", index + 1);
    else
        snprintf(force->name, sizeof force->name, "%s-%s", brunt_body_name(world, pair->a),
                 brunt_body_name(world, pair->b));
    fill_force(&pair->last, &pair->account, world->clock.kick, force);
}
int32_t brunt_boundary_count(const brunt_world *world) { return world->boundaries.boundary_count; }
void brunt_boundary_reaction(const brunt_world *world, int32_t index, brunt_reaction *force) {
    const brunt_boundary *boundary = &world->boundaries.boundary[index];
    snprintf(force->name, sizeof force->name, "%s", boundary->name);
    fill_force(&boundary->last, &boundary->account, world->clock.kick, force);
}

// Of bodies [first, end) that a boundary acts on, NULL: of all of them.
static double longest_transit(const brunt_world *world, int32_t first, int32_t end, const brunt_boundary *boundary) {
    double longest = 0;
    for (int32_t b = first; b < end && !brunt_world_newton(world, NULL, NULL); b++) {
        const brunt_body_ref *ref = &world->bodies.all[b];
        if (boundary && ref->fem && !boundary->kind->meet_surface && boundary->body < 0) continue;
        const double transit = ref->ops->transit(ref, world->settings.cell);
        if (isfinite(transit)) longest = fmax(longest, transit);
    }
    return longest;
}

double brunt_pair_transit(const brunt_world *world, int32_t index) {
    const brunt_pair *pair = &world->pairs.pair[index];
    if (pair->a < 0) return longest_transit(world, 0, world->bodies.count, NULL);
    return fmax(longest_transit(world, pair->a, pair->a + 1, NULL), longest_transit(world, pair->b, pair->b + 1, NULL));
}

double brunt_boundary_transit(const brunt_world *world, int32_t index) {
    const brunt_boundary *boundary = &world->boundaries.boundary[index];
    const int32_t body = boundary->body, count = world->bodies.count;
    return longest_transit(world, body < 0 ? 0 : body, body < 0 ? count : body + 1, boundary);
}

double brunt_world_time(const brunt_world *world) { return world->clock.time; }
double brunt_world_end(const brunt_world *world) { return world->settings.end; }
int64_t brunt_world_steps(const brunt_world *world) { return (int64_t)world->clock.steps; }
bool brunt_world_step_withdrawn(const brunt_world *world) { return world->clock.withdrawn; }
double brunt_world_dt(const brunt_world *world) { return world->clock.dt; }
double brunt_world_dt_min(const brunt_world *world) {
    return world->clock.steps > 0 ? world->clock.dt_min : world->clock.dt;
}
double brunt_world_dt_max(const brunt_world *world) {
    return world->clock.steps > 0 ? world->clock.dt_max : world->clock.dt;
}
int brunt_world_dimension(const brunt_world *world) { return world->settings.dimension; }
int brunt_world_threads(const brunt_world *world) { return world->settings.threads; }
int64_t brunt_world_particles(const brunt_world *world) {
    int64_t n = 0;
    for (int i = 0; i < world->bodies.mpm_count; i++) n += world->bodies.mpm[i].particles.count;
    return n;
}
int64_t brunt_world_nodes(const brunt_world *world) {
    int64_t n = 0;
    for (int i = 0; i < world->bodies.mpm_count; i++)
        n += (int64_t)world->bodies.mpm[i].grid.slot_count * BRUNT_BLOCK_NODES;
    for (int i = 0; i < world->bodies.fem_count; i++) n += world->bodies.fem[i].node_count;
    return n;
}
int64_t brunt_world_elements(const brunt_world *world) {
    int64_t n = 0;
    for (int i = 0; i < world->bodies.fem_count; i++) n += world->bodies.fem[i].element_count;
    return n;
}
int32_t brunt_body_count(const brunt_world *world) { return world->bodies.count; }
const char *brunt_body_name(const brunt_world *world, int32_t body) { return brunt_bodies_name(&world->bodies, body); }
const char *brunt_body_material(const brunt_world *world, int32_t body) {
    return brunt_bodies_material(&world->bodies, body)->name;
}
brunt_method brunt_body_method(const brunt_world *world, int32_t body) {
    const brunt_body_ref *ref = &world->bodies.all[body];
    return ref->ops->method(ref);
}
int64_t brunt_body_size(const brunt_world *world, int32_t body, brunt_location at) {
    const brunt_body_ref *ref = &world->bodies.all[body];
    return ref->ops->count(ref, at);
}
int64_t brunt_body_particles(const brunt_world *world, int32_t body) {
    return brunt_body_size(world, body, BRUNT_AT_PARTICLES);
}
int64_t brunt_body_nodes(const brunt_world *world, int32_t body) {
    return brunt_body_size(world, body, BRUNT_AT_NODES);
}
int64_t brunt_body_elements(const brunt_world *world, int32_t body) {
    return brunt_body_size(world, body, BRUNT_AT_ELEMENTS);
}
brunt_element_kind brunt_body_element(const brunt_world *world, int32_t body) {
    return world->bodies.all[body].fem->kind;
}
void brunt_body_mesh(const brunt_world *world, int32_t body, brunt_mesh_report *report) {
    *report = world->bodies.mesh_reports[world->bodies.all[body].fem - world->bodies.fem];
}

// ------------------------------------------------------------------------------------------ the balance

brunt_accounts brunt_accounts_of(const brunt_world *world) {
    return (brunt_accounts){.bodies = &world->bodies,
                            .boundaries = world->boundaries.boundary,
                            .boundary_count = world->boundaries.boundary_count,
                            .pairs = world->pairs.pair,
                            .pair_count = world->pairs.count,
                            .eroded = world->erosion.account,
                            .surface = &world->contact.surface,
                            .steps = world->clock.steps,
                            .axisymmetric = world->settings.axisymmetric};
}

void brunt_world_energy(brunt_world *world, brunt_energy *energy) {
    const brunt_accounts accounts = brunt_accounts_of(world);
    brunt_ledger_energy(&world->ledger, &accounts, energy);
    energy->contact_held = brunt_node_to_facet_held(world->contact.node_to_facet, &world->contact.surface);
    for (int32_t k = 0; k < world->pairs.count; k++) energy->contact_held += world->pairs.pair[k].last.spring;
    for (int w = 0; w < world->boundaries.boundary_count; w++)
        energy->contact_held += world->boundaries.boundary[w].last.spring;
}

void brunt_world_momentum(brunt_world *world, brunt_momentum *momentum) {
    const brunt_accounts accounts = brunt_accounts_of(world);
    brunt_ledger_momentum(&world->ledger, &accounts, momentum);
}

void brunt_body_totals(brunt_world *world, int32_t index, brunt_body_sums *sums) {
    const brunt_body_measure measure = brunt_bodies_measure_of(&world->bodies, &world->bodies.all[index]);
    const brunt_audit a = measure.sums;
    const brunt_point_energy e = measure.energy;
    *sums = (brunt_body_sums){.mass = a.mass, .kinetic = a.kinetic, .internal = e.internal, .plastic = e.plastic};
    for (int k = 0; k < 3; k++) {
        const bool there = k < world->settings.dimension;
        sums->momentum[k] = a.linear[k];
        sums->centre[k] = a.mass > 0 ? a.moment[k] / a.mass : NAN;
        sums->velocity[k] = a.mass > 0 ? a.linear[k] / a.mass : 0;
        sums->low[k] = there ? measure.low[k] : 0, sums->high[k] = there ? measure.high[k] : 0;
    }
}

void brunt_world_measure(brunt_world *world) { brunt_bodies_measure(&world->bodies, world->settings.threads); }
void brunt_world_forget_measure(brunt_world *world) { brunt_bodies_forget(&world->bodies); }
