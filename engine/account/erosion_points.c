// Material points that leave their bodies at the end of a step: what they are made of has failed, has been strained too
// far, or would have turned inside out.
//
// One that leaves takes its mass, momentum, spin, kinetic and stored energy along, all recorded; what it had dissipated
// stays dissipated. Its slot then is like padding (id -1, no mass, no volume) until the next sort drops it. With `keep`
// it stays as mass: a point of no volume exerts no force whatever its stress, and only the stored energy is recorded.
//
// The ledger needs no more than that. The half step by which velocities are behind the stress is recorded with the
// transfer when it is made, and taken off with the forces of the next step, to which the point no longer adds: energy
// closes as well as without erosion.
#include <math.h>

#include "base/array.h"
#include "base/error.h"
#include "base/simd.h"
#include "materials/log_strain.h"
#include "base/parallel.h"
#include "account/erosion.h"
#include "mpm/audit.h"
#include "mpm/transfer.h"

enum { BLOCK_GRAIN = 4 };

typedef struct job {
    brunt_body *body;
    const real *damage; // NULL: failure of the material takes no point away
    double strain;      // [-] INFINITY: strain takes none away
    real near;          // log_strain_near of it
} job;

// The component whose state is called damage: of the failure model, or of a strength model that knows when it fails.
static const real *find_damage(brunt_body *body) {
    static const brunt_component order[] = {BRUNT_FAILURE, BRUNT_STRENGTH};
    for (int k = 0; k < BRUNT_COUNT(order); k++) {
        const brunt_model *model = body->material.model[order[k]];
        for (int s = 0; model && s < model->state_count; s++)
            if (!strcmp(model->state[s].name, "damage")) return brunt_state_arrays(&body->particles, model, s)[0];
    }
    return NULL;
}

// F of slot s in three dimensions.
static void deformation(brunt_particles *p, int64_t s, lanes F[9]) {
    real *const *field = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    const int dim = p->point_dim;
    for (int c = 0; c < 9; c++) F[c] = lanes_set(c == 8);
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) F[3 * r + c] = lanes_load(field[r * dim + c] + s);
}

static void mark_strained(const job *j, int64_t s) {
    brunt_particles *p = &j->body->particles;
    lanes F[9];
    deformation(p, s, F);
    const lanes bound = log_strain_bound(F);
    for (int l = 0; l < BRUNT_LANES; l++) {
        if (p->order[s + l] != BRUNT_STAYS || (double)bound[l] < j->strain * j->strain * (1 - 1e-6)) continue;
        double one[9];
        for (int c = 0; c < 9; c++) one[c] = (double)F[c][l];
        if (equivalent_log_strain(one) >= j->strain) p->order[s + l] = BRUNT_LEAVES_STRAINED;
    }
}

// Whether any point from `begin` to `end` may be strained to the limit.
static bool may_be_strained(const job *j, int64_t begin, int64_t end) {
    const real cube = log_strain_cube(j->strain);
    lane_mask far = lanes_set(-1) < 0;
    for (int64_t s = begin; s < end; s += BRUNT_LANES) {
        lanes F[9];
        deformation(&j->body->particles, s, F);
        far &= log_strain_excess(F, cube) < 0; // not of what is no number
    }
    return lanes_any(~far);
}

static void mark_block(const job *j, int32_t b) {
    brunt_body *body = j->body;
    brunt_particles *p = &body->particles;
    const brunt_block *block = &body->grid.blocks[b];
    brunt_block_report *report = &body->report[b];
    const int64_t end = block->first + (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    const bool failed = j->damage && report->failed;
    const bool strained = isfinite(j->strain) &&
                          !log_strain_all_near(p->point_dim, brunt_field(p, BRUNT_FIELD_deformation_gradient),
                                               block->first, end, j->near) &&
                          may_be_strained(j, block->first, end);
    report->leaving = 0;
    if (!failed && !strained && !report->turned) return;
    const real *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    for (int64_t s = block->first; s < end; s++) {
        if (!report->turned) p->order[s] = BRUNT_STAYS; // else the gather has marked them
        if (failed && p->order[s] == BRUNT_STAYS && j->damage[s] >= 1) p->order[s] = BRUNT_LEAVES_FAILED;
    }
    for (int64_t s = block->first; strained && s < end; s += BRUNT_LANES) mark_strained(j, s);
    for (int64_t s = block->first; s < end; s++) {
        if (p->id[s] < 0 || volume[s] == 0) p->order[s] = BRUNT_STAYS; // padding, and what has been freed
        report->leaving += p->order[s] != BRUNT_STAYS;
    }
}

static void mark_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    for (int64_t b = begin; b < end; b++) mark_block(context, (int32_t)b);
}

// Slots of those that leave, in the order they lie in.
static int64_t list_leaving(brunt_body *body, int64_t *slots, brunt_eroded *account) {
    brunt_particles *p = &body->particles;
    int64_t count = 0;
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        const brunt_block *block = &body->grid.blocks[b];
        if (!body->report[b].leaving) continue;
        for (int64_t s = block->first; s < block->first + block->count; s++) {
            if (p->order[s] == BRUNT_STAYS) continue;
            slots[count++] = s;
            account->failed += p->order[s] == BRUNT_LEAVES_FAILED;
            account->strained += p->order[s] == BRUNT_LEAVES_STRAINED;
            account->inverted += p->order[s] == BRUNT_LEAVES_INVERTED;
        }
    }
    return count;
}

// Stored and dissipated energy of the listed slots, tile by tile: what else is in a tile counts without volume.
static brunt_point_energy energy_of(brunt_body *body, const int64_t *slots, int64_t count) {
    brunt_point_energy energy = {0};
    const real *volume = brunt_field(&body->particles, BRUNT_FIELD_reference_volume)[0];
    for (int64_t i = 0; i < count;) {
        real share[BRUNT_LANES] __attribute__((aligned(64))) = {0};
        const int64_t first = slots[i] / BRUNT_LANES * BRUNT_LANES;
        for (; i < count && slots[i] < first + BRUNT_LANES; i++) share[slots[i] - first] = volume[slots[i]];
        for (int k = 0; k < BRUNT_COMPONENTS; k++) {
            if (!body->material.model[k]) continue;
            brunt_material_points points = brunt_body_points(body, (brunt_component)k, first, BRUNT_LANES);
            points.volume = share;
            brunt_material_energy(&body->material, (brunt_component)k, &points, &energy);
        }
    }
    return energy;
}

static void account_loss(brunt_body *body, const int64_t *slots, int64_t count, brunt_eroded *account,
                         brunt_ledger *ledger) {
    brunt_audit lost = brunt_slots_audit(body, slots, 0, count);
    account->mass += lost.mass;
    account->energy += lost.kinetic;
    ledger->kinetic -= lost.kinetic;
    for (int k = 0; k < 3; k++) account->momentum[k] += lost.linear[k], account->angular[k] += lost.angular[k];
}

static void take_out(brunt_body *body, const int64_t *slots, int64_t count) {
    brunt_particles *p = &body->particles;
    real *mass = brunt_field(p, BRUNT_FIELD_mass)[0], *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    for (int64_t i = 0; i < count; i++) {
        volume[slots[i]] = 0;
        if (!body->keeps) p->id[slots[i]] = -1, mass[slots[i]] = 0;
    }
    if (body->keeps) {
        for (int32_t b = 0; b < body->grid.block_count; b++)
            if (body->report[b].leaving) brunt_still_stress(body, &body->grid.blocks[b]);
        return;
    }
    p->count -= count;
    p->holes = true;
}

static void erode(brunt_erosion *erosion, const brunt_erosion_step *step, brunt_body *body) {
    const double strain = erosion->rule[body->index].strain;
    job j = {body, body->fails ? find_damage(body) : NULL, strain, log_strain_near(strain)};
    int64_t *slots = body->particles.spare_id; // free until the next sort
    brunt_eroded *account = &erosion->account[body->index];
    brunt_ledger *ledger = step->ledger;
    brunt_parallel(step->threads, body->grid.block_count, BLOCK_GRAIN, mark_blocks, &j, step->timer);
    const int64_t count = list_leaving(body, slots, account);
    if (!count) return;
    brunt_point_energy energy = energy_of(body, slots, count);
    account->particles += count;
    account->energy += energy.internal;
    ledger->eroded_plastic += energy.plastic;
    ledger->eroded_viscosity += energy.viscosity;
    ledger->eroded_heat += energy.heat;
    if (!body->keeps) account_loss(body, slots, count, account, ledger);
    take_out(body, slots, count);
}

void brunt_erosion_take_points(brunt_erosion *erosion, const brunt_erosion_step *step) {
    for (int i = 0; i < step->bodies->mpm_count; i++)
        if (step->bodies->mpm[i].erodes) erode(erosion, step, &step->bodies->mpm[i]);
}
