// The state of a world as named blocks of bytes, for checkpoints, and its hash.
//
// Particles are stored without padding in the order they lie in memory. That order is part of the state: sorting is
// stable, so a restored world sorts them into the same places and every later sum has the same bits.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/saved.h"
#include "base/simd.h"
#include "base/memory.h"
#include "mpm/sort.h"
#include "base/parallel.h"
#include "world/world.h"

static const char REAL_TYPE = sizeof(real) == 8 ? 'd' : 'f';

// World blocks: clock (with the speeds of bodies of particles), walls (with the gas that groups of them enclose),
// pairs; where surfaces meet what their search remembers; and where contact keeps them the affine velocities of
// boundary nodes. Last the accounts of erosion, if there is any.
static int plain_blocks(const brunt_world *world) {
    return world->contact.surface.affine ? 5 : world->contact.has_surfaces ? 4 : 3;
}
static int world_blocks(const brunt_world *world) { return plain_blocks(world) + (world->erosion.active ? 1 : 0); }

enum { EROSION_BLOCK = 5, ELEMENTS_FIELD = -2 };

// What block `index` is: of a body its ids (field -1) or a field; of a mesh its nodes (field -1), the elements it still
// has where it erodes (ELEMENTS_FIELD), or a field; of the world number `field`.
typedef struct place {
    brunt_body *body;
    brunt_fem_body *fem;
    int field;
} place;

static place find(brunt_world *world, int32_t index) {
    for (int i = 0; i < world->bodies.count; i++) {
        brunt_body *mpm = world->bodies.all[i].mpm;
        brunt_fem_body *fem = world->bodies.all[i].fem;
        if (index-- == 0) return (place){mpm, fem, -1};
        if (fem && fem->bonds && index-- == 0) return (place){NULL, fem, ELEMENTS_FIELD};
        for (int f = 0; mpm && f < mpm->particles.field_count; f++)
            if (mpm->particles.field[f].components && index-- == 0) return (place){mpm, NULL, f};
        for (int f = 0; fem && f < fem->field_count; f++)
            if (fem->field[f].components && index-- == 0) return (place){NULL, fem, f};
    }
    return (place){NULL, NULL, index == plain_blocks(world) ? EROSION_BLOCK : index};
}

int32_t brunt_state_count(brunt_world *world) {
    if (!world) return 0;
    int32_t n = world_blocks(world);
    for (int i = 0; i < world->bodies.count; i++) {
        const brunt_body *mpm = world->bodies.all[i].mpm;
        const brunt_fem_body *fem = world->bodies.all[i].fem;
        n += fem && fem->bonds ? 2 : 1;
        for (int f = 0; mpm && f < mpm->particles.field_count; f++) n += mpm->particles.field[f].components > 0;
        for (int f = 0; fem && f < fem->field_count; f++) n += fem->field[f].components > 0;
    }
    return n;
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
#define ACCOUNT(member) BRUNT_SAVED(brunt_impulse_account, member)
static const brunt_saved account_table[] = {ACCOUNT(impulse),     ACCOUNT(angular),       ACCOUNT(external_work),
                                            ACCOUNT(normal_loss), ACCOUNT(friction_loss), ACCOUNT(area)};
enum { CLOCK_ROWS = BRUNT_SAVED_ROWS(clock_table), ACCOUNT_ROWS = BRUNT_SAVED_ROWS(account_table) };

static double *get_account(const brunt_impulse_account *account, double *out) {
    return brunt_saved_get(account_table, ACCOUNT_ROWS, account, out);
}
static const double *set_account(brunt_impulse_account *account, const double *in) {
    return brunt_saved_set(account_table, ACCOUNT_ROWS, account, in);
}

brunt_state_block brunt_state_info(brunt_world *world, int32_t index) {
    brunt_state_block block = {.type = 'd'};
    if (index < 0 || index >= brunt_state_count(world)) return block;
    place at = find(world, index);
    if (at.body) {
        const brunt_particles *p = &at.body->particles;
        block.type = at.field < 0 ? 'i' : REAL_TYPE;
        block.count = p->count * (at.field < 0 ? 1 : p->field[at.field].components);
        snprintf(block.name, sizeof block.name, "bodies/%s/%s", at.body->name,
                 at.field < 0 ? "id" : p->field[at.field].name);
        return block;
    }
    if (at.fem && at.field == ELEMENTS_FIELD) {
        block.type = 'i';
        block.count = brunt_fem_elements_count(at.fem);
        snprintf(block.name, sizeof block.name, "bodies/%s/elements", at.fem->name);
        return block;
    }
    if (at.fem) {
        block.type = REAL_TYPE;
        block.count = at.field < 0 ? (int64_t)at.fem->node_count * BRUNT_FEM_NODE_REALS
                                   : (int64_t)at.fem->slots * at.fem->field[at.field].components;
        snprintf(block.name, sizeof block.name, "bodies/%s/%s", at.fem->name,
                 at.field < 0 ? "nodes" : at.fem->field[at.field].name);
        return block;
    }
    static const char *const names[] = {"world/clock",          "world/walls",          "world/pairs",
                                        "world/contact_search", "world/contact_affine", "world/erosion"};
    const int64_t account = 2 * brunt_saved_count(account_table, ACCOUNT_ROWS); // since the start, and of the last step
    const int64_t counts[] = {brunt_saved_count(clock_table, CLOCK_ROWS) + world->bodies.mpm_count,
                              world->boundaries.wall_count * account + brunt_gas_state_count(&world->boundaries.sets),
                              world->pairs.count * account,
                              brunt_node_to_facet_state_count(&world->contact.surface),
                              brunt_surface_affine_count(&world->contact.surface),
                              brunt_erosion_state_count(world)};
    snprintf(block.name, sizeof block.name, "%s", names[at.field]);
    block.count = counts[at.field];
    return block;
}

void brunt_state_get(brunt_world *world, int32_t index, void *out) {
    if (index < 0 || index >= brunt_state_count(world)) return;
    place at = find(world, index);
    if (at.body) {
        const brunt_particles *p = &at.body->particles;
        int64_t n = 0;
        int components = at.field < 0 ? 1 : p->field[at.field].components;
        for (int c = 0; c < components; c++)
            for (int64_t s = 0; s < p->slots; s++) {
                if (p->id[s] < 0) continue;
                if (at.field < 0)
                    ((int64_t *)out)[n++] = p->id[s];
                else
                    ((real *)out)[n++] = p->scalar[p->field[at.field].first + c][s];
            }
        return;
    }
    if (at.fem) {
        const brunt_fem_body *fem = at.fem;
        if (at.field == ELEMENTS_FIELD) brunt_fem_elements_get(fem, out);
        if (at.field == -1) memcpy(out, fem->node, (size_t)fem->node_count * BRUNT_FEM_NODE_REALS * sizeof(real));
        for (int c = 0; at.field >= 0 && c < fem->field[at.field].components; c++)
            memcpy((real *)out + (size_t)c * (size_t)fem->slots, fem->scalar[fem->field[at.field].first + c],
                   (size_t)fem->slots * sizeof(real));
        return;
    }
    double *to = out;
    if (at.field == EROSION_BLOCK) brunt_erosion_state_get(world, to);
    if (at.field == 3) brunt_node_to_facet_state_get(world->contact.node_to_facet, &world->contact.surface, to);
    if (at.field == 4) brunt_surface_affine_get(&world->contact.surface, to);
    if (at.field == 0) to = brunt_saved_get(clock_table, CLOCK_ROWS, world, to);
    for (int i = 0; at.field == 0 && i < world->bodies.mpm_count; i++) *to++ = (double)world->bodies.mpm[i].speed;
    for (int w = 0; at.field == 1 && w < world->boundaries.wall_count; w++)
        to = get_account(&world->boundaries.walls[w].last, get_account(&world->boundaries.walls[w].action, to));
    if (at.field == 1) brunt_gas_state_get(&world->boundaries.sets, to);
    for (int p = 0; at.field == 2 && p < world->pairs.count; p++)
        to = get_account(&world->pairs.pair[p].last, get_account(&world->pairs.pair[p].action, to));
}

// What follows from the elements there are: loads, and the surfaces, whose numbers the blocks of the world are in.
static int set_elements(brunt_world *world, brunt_fem_body *fem, const int64_t *in, brunt_error *error) {
    int32_t element;
    if (brunt_fem_elements_set(fem, in))
        return brunt_fail(error, BRUNT_BAD_INPUT, "the state block 'bodies/%s/elements' is not of this mesh",
                          fem->name);
    brunt_node_sets_follow(&world->boundaries.sets, fem, &element);
    return world->contact.has_surfaces ? brunt_surfaces_renew(world, error) : BRUNT_OK;
}

// Particles without gaps between them, in their order; new ones at the end are all 0. Their grid is out of date then.
static void close_ranks(brunt_particles *p, int64_t count) {
    int64_t n = 0;
    for (int64_t s = 0; s < p->slots; s++) {
        if (p->id[s] < 0) continue;
        for (int k = 0; k < p->scalar_count && n < s; k++) p->scalar[k][n] = p->scalar[k][s];
        p->id[n++] = p->id[s];
    }
    for (int k = 0; k < p->scalar_count; k++)
        for (int64_t s = n; s < count; s++) p->scalar[k][s] = 0;
    p->count = p->slots = count;
    p->holes = false;
}

static int set_ids(brunt_particles *p, const char *name, const int64_t *id, int64_t count, brunt_error *error) {
    bool *there = brunt_alloc((size_t)p->made + 1);
    if (!there) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    int64_t s = 0;
    for (; s < count && id[s] >= 0 && id[s] < p->made && !there[id[s]]; s++) there[id[s]] = true;
    brunt_free(there);
    if (s < count)
        return brunt_fail(error, BRUNT_BAD_INPUT, "the state block '%s' holds the id %lld, which is %s", name,
                          (long long)id[s], id[s] >= 0 && id[s] < p->made ? "there twice" : "out of range");
    close_ranks(p, count);
    memcpy(p->id, id, (size_t)count * sizeof *id);
    return BRUNT_OK;
}

static void set_field(brunt_particles *p, const brunt_particle_field *field, const real *in) {
    for (int c = 0; c < field->components; c++)
        for (int64_t s = 0; s < p->slots; s++)
            if (p->id[s] >= 0) p->scalar[field->first + c][s] = *in++;
}

static int check_set(brunt_world *world, int32_t index, const void *in, int64_t count, brunt_error *error) {
    if (!world) return brunt_fail(error, BRUNT_BAD_INPUT, "there is no world");
    if (index < 0 || index >= brunt_state_count(world))
        return brunt_fail(error, BRUNT_BAD_INPUT, "there is no state block %d, this scene has %d", index,
                          brunt_state_count(world));
    const brunt_state_block block = brunt_state_info(world, index);
    const place at = find(world, index);
    // Of a body that erodes there may be fewer particles by now than in the world as it is; its ids say how many.
    const bool fits = at.body && at.field < 0 && at.body->erodes ? count >= 0 && count <= at.body->particles.made
                                                                 : count == block.count;
    if (!fits)
        return brunt_fail(error, BRUNT_BAD_INPUT, "the state block '%s' holds %lld values, this scene has %lld",
                          block.name, (long long)count, (long long)block.count);
    if (count > 0 && !in) return brunt_fail(error, BRUNT_BAD_INPUT, "the state block '%s' is not given", block.name);
    return BRUNT_OK;
}

int brunt_state_set(brunt_world *world, int32_t index, const void *in, int64_t count, brunt_error *error) {
    int status = check_set(world, index, in, count, error);
    if (status) return status;
    place at = find(world, index);
    if (at.body) {
        brunt_particles *p = &at.body->particles;
        if (at.field < 0) return set_ids(p, brunt_state_info(world, index).name, in, count, error);
        set_field(p, &p->field[at.field], in);
        return BRUNT_OK;
    }
    if (at.fem) {
        brunt_fem_body *fem = at.fem;
        if (at.field == ELEMENTS_FIELD) return set_elements(world, fem, in, error);
        if (at.field == -1) memcpy(fem->node, in, (size_t)fem->node_count * BRUNT_FEM_NODE_REALS * sizeof(real));
        for (int c = 0; at.field >= 0 && c < fem->field[at.field].components; c++)
            memcpy(fem->scalar[fem->field[at.field].first + c], (const real *)in + (size_t)c * (size_t)fem->slots,
                   (size_t)fem->slots * sizeof(real));
        return BRUNT_OK;
    }
    const double *from = in;
    if (at.field == EROSION_BLOCK) brunt_erosion_state_set(world, from);
    if (at.field == 3 && brunt_node_to_facet_state_set(&world->contact.node_to_facet, &world->contact.surface,
                                                       world->bodies.mpm_count, from))
        return brunt_fail(error, BRUNT_FAILED, "out of memory");
    if (at.field == 4) brunt_surface_affine_set(&world->contact.surface, from);
    if (at.field == 0) from = brunt_saved_set(clock_table, CLOCK_ROWS, world, from);
    for (int i = 0; at.field == 0 && i < world->bodies.mpm_count; i++) world->bodies.mpm[i].speed = (real)*from++;
    for (int w = 0; at.field == 1 && w < world->boundaries.wall_count; w++)
        from = set_account(&world->boundaries.walls[w].last, set_account(&world->boundaries.walls[w].action, from));
    if (at.field == 1) brunt_gas_state_set(&world->boundaries.sets, from);
    for (int p = 0; at.field == 2 && p < world->pairs.count; p++)
        from = set_account(&world->pairs.pair[p].last, set_account(&world->pairs.pair[p].action, from));
    return BRUNT_OK;
}

int brunt_state_done(brunt_world *world, brunt_error *error) {
    if (!world) return brunt_fail(error, BRUNT_BAD_INPUT, "there is no world");
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        close_ranks(&body->particles, body->particles.count);
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
    for (int a = 0; a < 3; a++) world->contact.surface.motion.frame_step[a] = world->contact.frame[a] * world->clock.dt;
    int32_t bad;
    const char *reason;
    const brunt_fem_body *failed = brunt_fem_elements_all(world, 0, &bad, &reason);
    if (failed) return brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s: %s", failed->name, reason);
    return BRUNT_OK;
}

static uint64_t hash_mesh(const brunt_fem_body *fem) {
    uint64_t h = (uint64_t)fem->index + 0x51ed27;
    for (size_t k = 0; k < (size_t)fem->node_count * BRUNT_FEM_NODE_REALS; k++) {
        uint64_t bits = 0;
        memcpy(&bits, &fem->node[k], sizeof(real));
        h = brunt_hash_add(h, bits);
    }
    for (int c = 0; c < fem->scalar_count; c++)
        for (int32_t s = 0; s < fem->slots; s++) {
            if (fem->element_id[s] < 0) continue;
            uint64_t bits = 0;
            memcpy(&bits, &fem->scalar[c][s], sizeof(real));
            h = brunt_hash_add(h, bits);
        }
    for (int32_t s = 0; fem->bonds && s < fem->slots; s++) h = brunt_hash_add(h, (uint64_t)(int64_t)fem->element_id[s]);
    return h;
}

uint64_t brunt_world_hash(const brunt_world *world) {
    uint64_t sum = 0;
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        const brunt_particles *p = &world->bodies.mpm[i].particles;
        for (int64_t s = 0; s < p->slots; s++) {
            if (p->id[s] < 0) continue;
            uint64_t h = brunt_hash_add((uint64_t)world->bodies.mpm[i].index, (uint64_t)p->id[s]);
            for (int k = 0; k < p->scalar_count; k++) {
                uint64_t bits = 0;
                memcpy(&bits, &p->scalar[k][s], sizeof(real));
                h = brunt_hash_add(h, bits);
            }
            sum += h;
        }
    }
    for (int i = 0; i < world->bodies.fem_count; i++) sum += hash_mesh(&world->bodies.fem[i]);
    uint64_t bits;
    memcpy(&bits, &world->clock.time, sizeof bits);
    return brunt_hash_add(sum, bits);
}
