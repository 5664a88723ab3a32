// The state of a world as named blocks of bytes, for checkpoints, and its hash: those of its bodies, in order of name,
// then its own.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/saved.h"
#include "body/points.h"
#include "mpm/sort.h"
#include "world/world.h"

// World blocks: clock (with the speeds of bodies of particles), boundaries (with the gas that groups of them enclose
// and the tractions of surfaces), pairs; where surfaces meet what their search remembers; and where contact keeps them
// the affine velocities of boundary nodes. Last the accounts of erosion, if there is any, or those of implicit steps.
static int plain_blocks(const brunt_contact *contact) {
    return contact->surface.affine ? 5 : contact->has_surfaces ? 4 : 3;
}
static bool implicit(const brunt_settings *settings) { return brunt_scheme_minimises(settings->scheme); }
static int world_blocks(const brunt_world *world) {
    return plain_blocks(&world->contact) + (world->erosion.active || implicit(&world->settings));
}

enum { SEARCH_BLOCK = 3, EROSION_BLOCK = 5, NEWTON_BLOCK = 6 };

// Where block `index` is: which of a body, or (body NULL) which of the world.
typedef struct block_location {
    const brunt_body_ref *body;
    int block;
} block_location;

static block_location find(const brunt_world *world, int32_t index) {
    const brunt_bodies *bodies = &world->bodies;
    const int i = brunt_bodies_holding(bodies, bodies->first_block, index);
    index -= bodies->first_block[i];
    if (i < bodies->count) return (block_location){&bodies->all[i], index};
    const int last = implicit(&world->settings) ? NEWTON_BLOCK : EROSION_BLOCK;
    return (block_location){NULL, index == plain_blocks(&world->contact) ? last : index};
}

int32_t brunt_state_count(brunt_world *world) {
    return world ? world->bodies.first_block[world->bodies.count] + world_blocks(world) : 0;
}

#define CLOCK(member) BRUNT_SAVED(brunt_world, clock.member)
#define LEDGER(member) BRUNT_SAVED(brunt_world, ledger.member)
static const brunt_saved clock_table[] = {
    CLOCK(time),
    CLOCK(steps),
    CLOCK(dt),
    CLOCK(kick),
    CLOCK(next_dt),
    CLOCK(dt_min),
    CLOCK(dt_max),
    CLOCK(longest),
    CLOCK(recent_step),
    CLOCK(earlier_step),
    LEDGER(kinetic),
    LEDGER(fem_kinetic),
    LEDGER(fem_stress_work),
    LEDGER(hourglass_stored),
    LEDGER(hourglass_lost),
    LEDGER(stress_work),
    LEDGER(transfer),
    LEDGER(gravity_work),
    BRUNT_SAVED(brunt_world, contact.frame),
    LEDGER(gravity_impulse),
    LEDGER(gravity_angular),
    LEDGER(damping.loss),
    LEDGER(damping.impulse),
    LEDGER(damping.angular),
    LEDGER(initial_energy),
    LEDGER(initial_kinetic),
    LEDGER(linear_initial),
    LEDGER(angular_initial),
    LEDGER(scale_linear),
    LEDGER(scale_angular),
    LEDGER(energy_scale),
    LEDGER(eroded_plastic),
    LEDGER(eroded_viscosity),
    LEDGER(eroded_heat),
};
#define NEWTON(member) CLOCK(newton.member), CLOCK(newton_last.member)
static const brunt_saved newton_table[] = {
    LEDGER(scheme),         LEDGER(barrier),     LEDGER(barrier_initial),
    NEWTON(steps),          NEWTON(iterations),  NEWTON(iterations_worst),
    NEWTON(halvings),       NEWTON(projections), NEWTON(linear_iterations),
    NEWTON(factorisations), NEWTON(cuts),        NEWTON(residual),
    NEWTON(least_gap),      NEWTON(least_part),  CLOCK(gap_told),
    CLOCK(chatter_told),    CLOCK(rubs_late),
};
#define ACCOUNT(member) BRUNT_SAVED(brunt_impulse_account, member)
static const brunt_saved account_table[] = {ACCOUNT(impulse),     ACCOUNT(angular),       ACCOUNT(external_work),
                                            ACCOUNT(normal_loss), ACCOUNT(friction_loss), ACCOUNT(area)};
enum {
    NEWTON_ROWS = BRUNT_COUNT(newton_table),
    CLOCK_ROWS = BRUNT_COUNT(clock_table),
    ACCOUNT_ROWS = BRUNT_COUNT(account_table)
};

static double *get_account(const brunt_impulse_account *account, double *out) {
    return brunt_saved_get(account_table, ACCOUNT_ROWS, account, out);
}
static const double *set_account(brunt_impulse_account *account, const double *in) {
    return brunt_saved_set(account_table, ACCOUNT_ROWS, account, in);
}

// What touches hold: of scenes that give it back.
static int64_t touches_count(const brunt_contact *contact) {
    return contact->def.touch == BRUNT_TOUCH_ELASTIC ? brunt_node_touches_state_count(&contact->surface) : 0;
}

// Of what overlaps since the start.
static int64_t penetrations_count(const brunt_contact *contact) {
    return brunt_initial_penetration_state_count(contact->node_to_facet, &contact->surface);
}

static int64_t search_count(const brunt_contact *contact) {
    return brunt_node_to_facet_state_count(&contact->surface) + touches_count(contact) + penetrations_count(contact);
}

// Whether a state of before says this scene's search: there may be no more overlap, or some, and checkpoints of before
// say less of touches.
static bool search_fits(const brunt_contact *contact, int64_t count) {
    const int64_t all = search_count(contact) - penetrations_count(contact);
    return count == all || count == all - touches_count(contact) / 2 ||
           count == all + brunt_surface_slots(&contact->surface);
}

static brunt_state_block world_info(const brunt_world *world, int index) {
    brunt_state_block block = {.type = 'd'};
    static const char *const names[] = {"world/clock",          "world/walls",   "world/pairs", "world/contact_search",
                                        "world/contact_affine", "world/erosion", "world/newton"};
    const int64_t account = 2 * brunt_saved_count(account_table, ACCOUNT_ROWS); // since the start, and of the last step
    const int64_t counts[] = {brunt_saved_count(clock_table, CLOCK_ROWS) + world->bodies.mpm_count,
                              world->boundaries.boundary_count * account +
                                  brunt_gas_state_count(&world->boundaries.sets) +
                                  brunt_boundary_surfaces_state_count(&world->boundaries.surfaces),
                              world->pairs.count * account,
                              search_count(&world->contact),
                              brunt_surface_affine_count(&world->contact.surface),
                              brunt_erosion_state_count(&world->erosion),
                              brunt_saved_count(newton_table, NEWTON_ROWS) + brunt_implicit_kept_count(&world->plan)};
    _Static_assert(BRUNT_COUNT(names) == BRUNT_COUNT(counts), "a count for each block of the world");
    snprintf(block.name, sizeof block.name, "%s", names[index]);
    block.count = counts[index];
    return block;
}

static void get_search(const brunt_contact *contact, double *to) {
    brunt_node_to_facet_state_get(contact->node_to_facet, &contact->surface, to);
    to += brunt_node_to_facet_state_count(&contact->surface);
    if (touches_count(contact)) brunt_node_touches_state_get(contact->node_to_facet, &contact->surface, to);
    brunt_initial_penetration_state_get(contact->node_to_facet, &contact->surface, to + touches_count(contact));
}

static int set_search(brunt_contact *contact, int mpm_count, const double *from, int64_t count, brunt_error *error) {
    if (brunt_node_to_facet_state_set(&contact->node_to_facet, &contact->surface, mpm_count, from, error))
        return BRUNT_FAILED;
    const int64_t before = brunt_node_to_facet_state_count(&contact->surface), touches = touches_count(contact),
                  after = count > before + touches ? count - before - touches : 0;
    from += before;
    if (touches && brunt_node_touches_state_set(contact->node_to_facet, &contact->surface, from, count - before, error))
        return BRUNT_FAILED;
    return brunt_initial_penetration_state_set(contact->node_to_facet, &contact->surface, from + touches, after, error);
}

static void world_get(brunt_world *world, int block, double *to) {
    if (block == EROSION_BLOCK) brunt_erosion_state_get(&world->erosion, to);
    if (block == NEWTON_BLOCK)
        brunt_implicit_kept_get(&world->plan, brunt_saved_get(newton_table, NEWTON_ROWS, world, to));
    if (block == SEARCH_BLOCK) get_search(&world->contact, to);
    if (block == 4) brunt_surface_affine_get(&world->contact.surface, to);
    if (block == 0) to = brunt_saved_get(clock_table, CLOCK_ROWS, world, to);
    for (int i = 0; block == 0 && i < world->bodies.mpm_count; i++) *to++ = (double)world->bodies.mpm[i].speed;
    for (int w = 0; block == 1 && w < world->boundaries.boundary_count; w++)
        to = get_account(&world->boundaries.boundary[w].last, get_account(&world->boundaries.boundary[w].account, to));
    if (block == 1) to = brunt_boundary_surfaces_state_get(&world->boundaries.surfaces, to);
    if (block == 1) brunt_gas_state_get(&world->boundaries.sets, to);
    for (int p = 0; block == 2 && p < world->pairs.count; p++)
        to = get_account(&world->pairs.pair[p].last, get_account(&world->pairs.pair[p].account, to));
}

static int world_set(brunt_world *world, int block, const double *from, int64_t count, brunt_error *error) {
    if (block == EROSION_BLOCK) brunt_erosion_state_set(&world->erosion, from);
    if (block == NEWTON_BLOCK)
        return brunt_implicit_kept_set(&world->plan, brunt_saved_set(newton_table, NEWTON_ROWS, world, from),
                                       count - brunt_saved_count(newton_table, NEWTON_ROWS), error);
    if (block == SEARCH_BLOCK && set_search(&world->contact, world->bodies.mpm_count, from, count, error))
        return BRUNT_FAILED;
    if (block == 4) brunt_surface_affine_set(&world->contact.surface, from);
    if (block == 0) from = brunt_saved_set(clock_table, CLOCK_ROWS, world, from);
    for (int i = 0; block == 0 && i < world->bodies.mpm_count; i++) world->bodies.mpm[i].speed = (real)*from++;
    for (int w = 0; block == 1 && w < world->boundaries.boundary_count; w++)
        from =
            set_account(&world->boundaries.boundary[w].last, set_account(&world->boundaries.boundary[w].account, from));
    if (block == 1) from = brunt_boundary_surfaces_state_set(&world->boundaries.surfaces, from);
    if (block == 1) brunt_gas_state_set(&world->boundaries.sets, from);
    for (int p = 0; block == 2 && p < world->pairs.count; p++)
        from = set_account(&world->pairs.pair[p].last, set_account(&world->pairs.pair[p].account, from));
    return BRUNT_OK;
}

brunt_state_block brunt_state_info(brunt_world *world, int32_t index) {
    if (index < 0 || index >= brunt_state_count(world)) return (brunt_state_block){.type = 'd'};
    const block_location at = find(world, index);
    return at.body ? at.body->ops->block_info(at.body, at.block) : world_info(world, at.block);
}

void brunt_state_get(brunt_world *world, int32_t index, void *out) {
    if (index < 0 || index >= brunt_state_count(world)) return;
    const block_location at = find(world, index);
    if (at.body)
        at.body->ops->block_get(at.body, at.block, out);
    else
        world_get(world, at.block, out);
}

static int check_set(brunt_world *world, int32_t index, const void *in, int64_t count, brunt_error *error) {
    if (!world) return brunt_fail(error, BRUNT_BAD_INPUT, "there is no world");
    if (index < 0 || index >= brunt_state_count(world))
        return brunt_fail(error, BRUNT_BAD_INPUT, "there is no state block %d, this scene has %d", index,
                          brunt_state_count(world));
    const brunt_state_block block = brunt_state_info(world, index);
    const block_location at = find(world, index);
    const brunt_body *mpm = at.body ? at.body->mpm : NULL;
    // Of a body that erodes there may be fewer particles by now than in the world as it is; its ids say how many.
    bool fits = count == block.count;
    if (mpm && at.block == 0 && mpm->erodes) fits = count >= 0 && count <= mpm->particles.made;
    if (!at.body && at.block == SEARCH_BLOCK) fits = search_fits(&world->contact, count);
    if (!at.body && at.block == NEWTON_BLOCK)
        fits = brunt_implicit_kept_fits(&world->plan, count - brunt_saved_count(newton_table, NEWTON_ROWS));
    if (!fits)
        return brunt_fail(error, BRUNT_BAD_INPUT, "the state block '%s' holds %lld values, this scene has %lld",
                          block.name, (long long)count, (long long)block.count);
    if (count > 0 && !in) return brunt_fail(error, BRUNT_BAD_INPUT, "the state block '%s' is not given", block.name);
    return BRUNT_OK;
}

// What follows from the elements there are: loads, and the surfaces, whose numbers the blocks of the world are in.
static int follow_elements(brunt_world *world, brunt_fem_body *fem, brunt_error *error) {
    int32_t element;
    brunt_node_sets_follow(&world->boundaries.sets, fem, &element);
    return world->contact.has_surfaces ? brunt_surfaces_renew(&world->contact, error) : BRUNT_OK;
}

int brunt_state_set(brunt_world *world, int32_t index, const void *in, int64_t count, brunt_error *error) {
    int status = check_set(world, index, in, count, error);
    if (status) return status;
    const block_location at = find(world, index);
    if (!at.body) return world_set(world, at.block, in, count, error);
    status = at.body->ops->block_set(at.body, at.block, in, count, error);
    const bool elements = at.body->fem && at.body->fem->bonds && at.block == 1;
    return status || !elements ? status : follow_elements(world, at.body->fem, error);
}

int brunt_state_done(brunt_world *world, brunt_error *error) {
    if (!world) return brunt_fail(error, BRUNT_BAD_INPUT, "there is no world");
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        brunt_points_close_ranks(&body->particles, body->particles.count);
        body->grid.block_count = 0;
        body->grid.block_table.capacity = 0;
        brunt_free(body->grid.block_table.key);
        brunt_free(body->grid.block_table.value);
        body->grid.block_table = (brunt_table){0};
        int status = brunt_sort(&body->grid, &body->particles, world->settings.threads, NULL, error);
        if (status) return BRUNT_BAD_INPUT;
    }
    int status = brunt_reports_make(world, error);
    if (status) return status;
    world->contact.surface.motion.rests = false;
    for (int a = 0; a < 3; a++) world->contact.surface.motion.frame_step[a] = world->contact.frame[a] * world->clock.dt;
    int32_t bad;
    const char *reason;
    const brunt_fem_body *failed = brunt_fem_elements_all(world, 0, &bad, &reason);
    if (failed) return brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s: %s", failed->name, reason);
    return BRUNT_OK;
}

uint64_t brunt_world_hash(const brunt_world *world) {
    uint64_t sum = 0, bits;
    for (int i = 0; i < world->bodies.count; i++) sum += world->bodies.all[i].ops->hash(&world->bodies.all[i]);
    memcpy(&bits, &world->clock.time, sizeof bits);
    return brunt_hash_add(sum, bits);
}
