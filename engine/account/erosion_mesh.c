// Elements that leave their bodies at the end of a step, and the accounts of what went with them.
//
// Energy. The ledger sees a mesh at the time of its stress: kinetic energy at the velocities half a step before, what
// the forces do in that half step, -dt/2 W with W = -sum f . v, and the energy stored. An element that goes takes its
// stored energy and its share of W, for its forces do not act in the half step to come:
//   U + hourglass springs - W/2 dt.
// An element that would have turned inside out goes with the state of the step before, when its forces f were the last
// to act: over the whole step they have done what should have become stored energy, dt W, so that it takes
//   U + hourglass springs + W/2 dt,   all as they were then.
// Nodes without elements take m v^2/2; gravity, loads and damping in the half step are booked on both sides of the
// balance. What elements had dissipated stays dissipated.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "world/world.h"

struct brunt_erosion_work {
    brunt_fem_single **single; // of each mesh that erodes
    const real **damage;       // of each mesh whose elements go when their material has failed, by slot
    int32_t *slots;            // room for those of one body
    int32_t *corner;           // nodes of elements that go
    size_t corner_capacity;
};

// ------------------------------------------------------------------------------------------ making

// Whether points of the material may fail, and leave when they do.
static bool fails(const brunt_material *material, const brunt_material_def *def) {
    const brunt_model *strength = material->model[BRUNT_STRENGTH];
    if (material->model[BRUNT_FAILURE]) return material->failure_action == BRUNT_FAILURE_ERODE;
    for (int k = 0; strength->damage && k < strength->parameter_count; k++)
        if (!strcmp(strength->parameters[k].key, "failure_strain")) return isfinite(def->strength_parameters[k]);
    return false;
}

static const real *find_damage(const brunt_fem_body *fem) {
    const brunt_model *failure = fem->material.model[BRUNT_FAILURE],
                      *model = failure ? failure : fem->material.model[BRUNT_STRENGTH];
    for (int f = BRUNT_ELEMENT_BASE_FIELDS; f < fem->field_count; f++)
        if (fem->field[f].model == model && !strcmp(fem->field[f].name, "damage"))
            return fem->scalar[fem->field[f].first];
    return NULL;
}

static int check(const brunt_body_def *def, brunt_error *error) {
    const brunt_erosion_def *erosion = &def->erosion;
    if (!(erosion->strain > 0))
        return brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s.erosion.strain: %g is not positive", def->name,
                          erosion->strain);
    if (!(erosion->step >= 0) || !isfinite(erosion->step))
        return brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s.erosion.step: %g s is not a time", def->name,
                          erosion->step);
    if (erosion->step > 0 && def->method == BRUNT_MPM)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "bodies.%s.erosion.step: material points have no step of their own: it is for elements",
                          def->name);
    return BRUNT_OK;
}

static int find_body(const brunt_world *world, const char *name) {
    for (int i = 0; i < world->bodies.count; i++)
        if (!strcmp(brunt_body_name(world, i), name)) return i;
    return -1;
}

static int make_mesh(brunt_world *world, brunt_fem_body *fem, bool by_failure, brunt_error *error) {
    struct brunt_erosion_work *work = world->erosion.work;
    const int k = (int)(fem - world->bodies.fem);
    if (brunt_fem_erodes(fem, world->erosion.rule[fem->index].inverted) ||
        !(work->single[k] = brunt_fem_single_make(fem)))
        return brunt_fail(error, BRUNT_FAILED, "bodies.%s: out of memory", fem->name);
    if (by_failure) work->damage[k] = find_damage(fem);
    return BRUNT_OK;
}

static int allocate(brunt_world *world) {
    const size_t all = (size_t)world->bodies.count, fems = (size_t)world->bodies.fem_count + 1;
    struct brunt_erosion_work *work = world->erosion.work = brunt_alloc(sizeof *work);
    world->erosion.account = brunt_alloc(all * sizeof *world->erosion.account);
    world->erosion.rule = brunt_alloc(all * sizeof *world->erosion.rule);
    if (!work || !world->erosion.account || !world->erosion.rule) return -1;
    size_t most = 1;
    for (int k = 0; k < world->bodies.fem_count; k++)
        most = (size_t)world->bodies.fem[k].slots > most ? (size_t)world->bodies.fem[k].slots : most;
    work->single = brunt_alloc(fems * sizeof *work->single);
    work->damage = brunt_alloc(fems * sizeof *work->damage);
    work->slots = brunt_alloc(most * sizeof *work->slots);
    return work->single && work->damage && work->slots ? 0 : -1;
}

int brunt_erosion_make(brunt_world *world, const brunt_world_def *def, brunt_error *error) {
    for (int q = 0; q < def->body_count; q++) {
        const brunt_body_def *body = &def->bodies[q];
        const brunt_erosion_def *erosion = &body->erosion;
        int status = check(body, error);
        if (status) return status;
        const int i = find_body(world, body->name);
        const brunt_body *mpm = world->bodies.all[i].mpm; // has its part since it was made
        const bool by_failure = !mpm && fails(&world->bodies.all[i].fem->material, &def->materials[body->material]);
        if (mpm ? !mpm->erodes : !by_failure && isinf(erosion->strain) && !(erosion->step > 0) && !erosion->inverted)
            continue;
        if (!world->erosion.active && allocate(world)) return brunt_fail(error, BRUNT_FAILED, "out of memory");
        world->erosion.active = true;
        world->erosion.rule[i] = *erosion;
        if (!mpm) status = make_mesh(world, world->bodies.all[i].fem, by_failure, error);
        if (status) return status;
    }
    return BRUNT_OK;
}

void brunt_erosion_free(brunt_world *world) {
    struct brunt_erosion_work *work = world->erosion.work;
    for (int k = 0; work && work->single && k < world->bodies.fem_count; k++) brunt_fem_single_free(work->single[k]);
    if (work) {
        brunt_free(work->single);
        brunt_free(work->damage);
        brunt_free(work->slots);
        brunt_free(work->corner);
    }
    brunt_free(work);
    brunt_free(world->erosion.account);
    brunt_free(world->erosion.rule);
}

void brunt_body_eroded(const brunt_world *world, int32_t body, brunt_eroded *eroded) {
    *eroded = world->erosion.account ? world->erosion.account[body] : (brunt_eroded){0};
}

// ------------------------------------------------------------------------------------------ which go

static void mark_failed(brunt_fem_body *fem, int32_t b, const real *damage) {
    const brunt_fem_block *block = &fem->block[b];
    for (int32_t s = block->first; s < block->first + block->count; s++) {
        if (fem->mark[s] != BRUNT_MARK_NONE || !(damage[s] >= 1)) continue;
        fem->mark[s] = BRUNT_MARK_FAILED;
        fem->report[b].marked++;
    }
}

static void mark_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_world *world = context;
    for (int64_t t = begin; t < end; t++) {
        const brunt_fem_task *task = &world->bodies.tasks.element[t];
        brunt_fem_body *fem = &world->bodies.fem[task->fem];
        if (!fem->bonds || !fem->block[task->begin].count) continue;
        const real *damage = world->erosion.work->damage[task->fem];
        if (damage && fem->report[task->begin].failed) mark_failed(fem, task->begin, damage);
        const double limit = world->erosion.rule[fem->index].strain;
        if (isfinite(limit)) brunt_fem_mark_strained(fem, task->begin, limit);
    }
}

// Elements below the least step of a block that has such.
static void mark_short(brunt_world *world, int k, int32_t b) {
    brunt_fem_body *fem = &world->bodies.fem[k];
    const double least = world->erosion.rule[fem->index].step;
    const brunt_fem_block *block = &fem->block[b];
    for (int32_t s = block->first; s < block->first + block->count; s++) {
        if (fem->mark[s] != BRUNT_MARK_NONE) continue;
        brunt_fem_share share =
            brunt_fem_single_look(world->erosion.work->single[k], fem, s, 0, 0, &world->scratch.meshes[0]);
        if (!(share.stable_step < least)) continue;
        fem->mark[s] = BRUNT_MARK_SHORT;
        fem->report[b].marked++;
    }
}

static int32_t list_marked(brunt_world *world, int k) {
    brunt_fem_body *fem = &world->bodies.fem[k];
    int32_t count = 0;
    for (int32_t b = 0; b < fem->block_count; b++) {
        const brunt_fem_block *block = &fem->block[b];
        for (int32_t s = block->first; fem->report[b].marked && s < block->first + block->count; s++)
            if (fem->mark[s] != BRUNT_MARK_NONE) world->erosion.work->slots[count++] = s;
    }
    return count;
}

// ------------------------------------------------------------------------------------------ what goes with them

static void book_elements(brunt_world *world, int k, int32_t count, double dt) {
    brunt_fem_body *fem = &world->bodies.fem[k];
    brunt_eroded *account = &world->erosion.account[fem->index];
    for (int32_t i = 0; i < count; i++) {
        const int32_t slot = world->erosion.work->slots[i];
        const uint8_t mark = fem->mark[slot];
        const bool turned = mark == BRUNT_MARK_INVERTED;
        brunt_fem_share share = brunt_fem_single_look(world->erosion.work->single[k], fem, slot, turned ? dt : 0, dt,
                                                      &world->scratch.meshes[0]);
        account->energy +=
            share.energy.internal + share.hourglass_stored + (turned ? share.half_work : -share.half_work);
        world->ledger.eroded_plastic += share.energy.plastic;
        world->ledger.eroded_viscosity += share.energy.viscosity;
        world->ledger.eroded_heat += share.energy.heat;
        account->elements++;
        account->inverted += turned;
        account->failed += mark == BRUNT_MARK_FAILED;
        account->strained += mark == BRUNT_MARK_STRAINED;
        account->short_step += mark == BRUNT_MARK_SHORT;
        fem->mark[slot] = BRUNT_MARK_NONE;
    }
}

static void book_node(brunt_world *world, brunt_fem_body *fem, int32_t n) {
    brunt_eroded *account = &world->erosion.account[fem->index];
    real *node = brunt_fem_node(fem, n);
    const double mass = (double)node[BRUNT_FEM_MASS];
    double x[3], p[3], kinetic = 0;
    for (int a = 0; a < 3; a++) {
        const double v = (double)node[BRUNT_FEM_V + a];
        x[a] = (double)node[a], p[a] = mass * v;
        kinetic += 0.5 * mass * v * v;
        node[BRUNT_FEM_V + a] = 0;
    }
    if (world->settings.axisymmetric) p[0] = 0; // of a whole ring
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        account->momentum[a] += p[a];
        if (!world->settings.axisymmetric) account->angular[a] += x[b] * p[c] - x[c] * p[b];
    }
    account->mass += mass;
    account->energy += kinetic;
    world->ledger.fem_kinetic -= kinetic;
    node[BRUNT_FEM_MASS] = (real)BRUNT_FEM_NO_MASS;
}

static int ascending(const void *left, const void *right) {
    int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
    return (a > b) - (a < b);
}

// Nodes of the elements that go, each once, ascending. Their count, or -1: out of memory.
static int32_t list_corners(brunt_world *world, const brunt_fem_body *fem, int32_t count) {
    struct brunt_erosion_work *work = world->erosion.work;
    const int nodes = fem->traits->nodes;
    if (BRUNT_RESERVE(work->corner, (size_t)count * (size_t)nodes, 0)) return -1;
    int32_t found = 0;
    for (int32_t i = 0; i < count; i++)
        for (int a = 0; a < nodes; a++) work->corner[found++] = fem->element_node[(int64_t)work->slots[i] * nodes + a];
    qsort(work->corner, (size_t)found, sizeof *work->corner, ascending);
    int32_t once = 0;
    for (int32_t i = 0; i < found; i++)
        if (!once || work->corner[once - 1] != work->corner[i]) work->corner[once++] = work->corner[i];
    return once;
}

static int gas_escapes(brunt_world *world, const brunt_fem_body *fem, const brunt_node_set *hold, int32_t element,
                       brunt_error *error) {
    brunt_fail(error, BRUNT_FAILED,
               "boundaries (%s): the envelope of the gas has lost element %d of body '%s', time %.9g s, step %.0f: "
               "gas does not flow out through holes",
               hold->wall->name, element + 1, fem->name, world->clock.time, world->clock.steps);
    if (error) {
        error->time = world->clock.time;
        error->id = element;
        memcpy(error->body, fem->name, sizeof error->body < sizeof fem->name ? sizeof error->body : sizeof fem->name);
    }
    return BRUNT_FAILED;
}

static int erode(brunt_world *world, int k, int32_t count, double dt, brunt_error *error) {
    brunt_fem_body *fem = &world->bodies.fem[k];
    struct brunt_erosion_work *work = world->erosion.work;
    const int32_t corners = list_corners(world, fem, count);
    if (corners < 0) return brunt_fail(error, BRUNT_FAILED, "bodies.%s: out of memory", fem->name);
    book_elements(world, k, count, dt);
    brunt_fem_remove(fem, work->slots, count, &world->scratch.meshes[0]);
    for (int32_t i = 0; i < corners; i++) {
        if (fem->bonds[work->corner[i]]) continue;
        world->erosion.account[fem->index].nodes++;
        if (!world->erosion.rule[fem->index].keep) book_node(world, fem, work->corner[i]);
    }
    int32_t element;
    const brunt_node_set *gas = brunt_node_sets_follow(&world->boundaries.sets, fem, &element);
    return gas ? gas_escapes(world, fem, gas, element, error) : BRUNT_OK;
}

// The half steps of the ledger, of what is left.
static void renew_sums(brunt_world *world, double dt) {
    double work = 0, stored = 0;
    for (int k = 0; k < world->bodies.fem_count; k++)
        for (int32_t b = 0; b < world->bodies.fem[k].block_count; b++) {
            brunt_fem_report *report = &world->bodies.fem[k].report[b];
            if (report->marked) report->stress_work = brunt_fem_stress_work(&world->bodies.fem[k], b, dt);
            report->marked = 0;
            work += report->stress_work;
            stored += report->hourglass_stored;
        }
    world->ledger.fem_stress_work = work;
    world->ledger.hourglass_stored = stored;
}

int brunt_erode_marked(brunt_world *world, double dt, brunt_error *error) {
    bool any = false;
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const int32_t count = world->bodies.fem[k].bonds ? list_marked(world, k) : 0;
        if (!count) continue;
        any = true;
        int status = erode(world, k, count, dt, error);
        if (status) return status;
    }
    if (!any) return BRUNT_OK;
    renew_sums(world, dt);
    return world->contact.has_surfaces ? brunt_surfaces_renew(world, error) : BRUNT_OK;
}

int brunt_erode_meshes(brunt_world *world, double dt, brunt_error *error) {
    brunt_parallel(world->settings.threads, world->bodies.tasks.element_count, 1, mark_blocks, world,
                   brunt_pass_timer(world));
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const brunt_fem_body *fem = &world->bodies.fem[k];
        const double least = fem->bonds ? world->erosion.rule[fem->index].step : 0;
        for (int32_t b = 0; least > 0 && b < fem->block_count; b++)
            if (fem->block[b].count && fem->report[b].stable_step < least) mark_short(world, k, b);
    }
    return brunt_erode_marked(world, dt, error);
}

// ------------------------------------------------------------------------------------------ to be kept

enum { ACCOUNT_DOUBLES = 15 };

int64_t brunt_erosion_state_count(const brunt_world *world) {
    return world->erosion.active ? (int64_t)world->bodies.count * ACCOUNT_DOUBLES : 0;
}

void brunt_erosion_state_get(const brunt_world *world, double *out) {
    for (int i = 0; i < world->bodies.count; i++) {
        const brunt_eroded *e = &world->erosion.account[i];
        const double counts[] = {(double)e->elements, (double)e->particles,  (double)e->nodes,   (double)e->failed,
                                 (double)e->strained, (double)e->short_step, (double)e->inverted};
        for (int c = 0; c < 7; c++) *out++ = counts[c];
        *out++ = e->mass, *out++ = e->energy;
        for (int a = 0; a < 3; a++) *out++ = e->momentum[a], *out++ = e->angular[a];
    }
}

void brunt_erosion_state_set(brunt_world *world, const double *in) {
    for (int i = 0; i < world->bodies.count; i++) {
        brunt_eroded *e = &world->erosion.account[i];
        int64_t *const counts[] = {&e->elements, &e->particles,  &e->nodes,   &e->failed,
                                   &e->strained, &e->short_step, &e->inverted};
        for (int c = 0; c < 7; c++) *counts[c] = (int64_t)*in++;
        e->mass = *in++, e->energy = *in++;
        for (int a = 0; a < 3; a++) e->momentum[a] = *in++, e->angular[a] = *in++;
    }
}
