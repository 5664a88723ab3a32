// Elements that leave their bodies at the end of a step, and the accounts of what went with them.
//
// Energy. The ledger sees a mesh at the time of its stress: kinetic energy at the velocities half a step before, what
// the forces do in that half step, -dt/2 W with W = -sum f . v, and the energy stored. An element that goes takes its
// stored energy and its share of W, for its forces do not act in the half step to come:
//   U + hourglass springs - W/2 dt.
// An element that would have turned inside out goes with the state of the step before, when its forces f were the last
// to act: over the whole step they have done what should have become stored energy, dt W, so that it takes
//   U + hourglass springs + W/2 dt,   all as they were then.
// Nodes without elements take m v^2/2; gravity, loads and damping in the half step are recorded on both sides of the
// balance. What elements had dissipated stays dissipated.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/saved.h"
#include "account/erosion.h"

struct brunt_erosion_work {
    int mesh_count;
    brunt_fem_single **single; // of each mesh that erodes
    const real **damage;       // of each mesh whose elements go when their material has failed, by slot
    int32_t *slots;            // room for those of one body
    int32_t *corner;           // nodes of elements that go
    size_t corner_capacity;
};

// ------------------------------------------------------------------------------------------ making

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

static int make_mesh(brunt_erosion *erosion, const brunt_bodies *bodies, brunt_fem_body *fem, bool by_failure,
                     brunt_error *error) {
    struct brunt_erosion_work *work = erosion->work;
    const int k = (int)(fem - bodies->fem);
    const int status = brunt_fem_prepare_erosion(fem, erosion->rule[fem->index].inverted, error);
    if (status) return status;
    if (!(work->single[k] = brunt_fem_single_make(fem)))
        return brunt_fail(error, BRUNT_FAILED, "body '%s': out of memory for erosion", fem->name);
    if (by_failure) work->damage[k] = find_damage(fem);
    return BRUNT_OK;
}

static int allocate(brunt_erosion *erosion, const brunt_bodies *bodies, brunt_error *error) {
    const size_t all = (size_t)bodies->count, fems = (size_t)bodies->fem_count + 1;
    if (BRUNT_NEW(erosion->work, 1, "room for erosion", error) ||
        BRUNT_NEW(erosion->account, all, "accounts of bodies that erode", error) ||
        BRUNT_NEW(erosion->rule, all, "bodies that erode", error))
        return BRUNT_FAILED;
    struct brunt_erosion_work *work = erosion->work;
    erosion->count = bodies->count;
    erosion->active = true;
    size_t most = 1;
    for (int k = 0; k < bodies->fem_count; k++)
        most = (size_t)bodies->fem[k].slots > most ? (size_t)bodies->fem[k].slots : most;
    work->mesh_count = bodies->fem_count;
    if (BRUNT_NEW(work->single, fems, "meshes that erode", error) ||
        BRUNT_NEW(work->damage, fems, "meshes that erode", error))
        return BRUNT_FAILED;
    return BRUNT_NEW(work->slots, most, "elements that leave", error);
}

int brunt_erosion_make(brunt_erosion *erosion, const brunt_bodies *bodies, const brunt_world_def *def,
                       brunt_error *error) {
    for (int q = 0; q < def->body_count; q++) {
        const brunt_body_def *body = &def->bodies[q];
        const brunt_erosion_def *rule = &body->erosion;
        int status = check(body, error);
        if (status) return status;
        const int i = brunt_bodies_find(bodies, body->name);
        const brunt_body *mpm = bodies->all[i].mpm; // has its part since it was made
        const bool by_failure = !mpm && bodies->all[i].fem->material.erodes;
        if (mpm ? !mpm->erodes : !by_failure && isinf(rule->strain) && !(rule->step > 0) && !rule->inverted) continue;
        if (!erosion->active && (status = allocate(erosion, bodies, error))) return status;
        erosion->rule[i] = *rule;
        if (!mpm && (status = make_mesh(erosion, bodies, bodies->all[i].fem, by_failure, error))) return status;
    }
    return BRUNT_OK;
}

void brunt_erosion_free(brunt_erosion *erosion) {
    struct brunt_erosion_work *work = erosion->work;
    for (int k = 0; work && work->single && k < work->mesh_count; k++) brunt_fem_single_free(work->single[k]);
    if (work) {
        brunt_free(work->single);
        brunt_free(work->damage);
        brunt_free(work->slots);
        brunt_free(work->corner);
    }
    brunt_free(work);
    brunt_free(erosion->account);
    brunt_free(erosion->rule);
}

void brunt_erosion_validate(const brunt_erosion *erosion) {
    BRUNT_ASSERT(erosion->active ? erosion->account && erosion->rule && erosion->work : !erosion->account);
    for (int i = 0; erosion->active && i < erosion->count; i++) {
        const brunt_eroded *e = &erosion->account[i];
        BRUNT_ASSERT(e->elements >= 0 && e->particles >= 0 && e->nodes >= 0 && e->mass >= 0);
    }
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

typedef struct mark_job {
    const brunt_erosion *erosion;
    const brunt_bodies *bodies;
} mark_job;

static void mark_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const mark_job *j = context;
    for (int64_t t = begin; t < end; t++) {
        const brunt_fem_task *task = &j->bodies->tasks.element[t];
        brunt_fem_body *fem = &j->bodies->fem[task->fem];
        if (!fem->bonds || !fem->block[task->begin].count) continue;
        const real *damage = j->erosion->work->damage[task->fem];
        if (damage && fem->report[task->begin].failed) mark_failed(fem, task->begin, damage);
        const double limit = j->erosion->rule[fem->index].strain;
        if (isfinite(limit)) brunt_fem_mark_strained(fem, task->begin, limit);
    }
}

// Elements below the least step of a block that has such.
static void mark_short(const brunt_erosion *erosion, const brunt_erosion_step *step, int k, int32_t b) {
    brunt_fem_body *fem = &step->bodies->fem[k];
    const double least = erosion->rule[fem->index].step;
    const brunt_fem_block *block = &fem->block[b];
    for (int32_t s = block->first; s < block->first + block->count; s++) {
        if (fem->mark[s] != BRUNT_MARK_NONE) continue;
        brunt_fem_share share = brunt_fem_single_look(erosion->work->single[k], fem, s, 0, 0, step->workspace);
        if (!(share.stable_step < least)) continue;
        fem->mark[s] = BRUNT_MARK_SHORT;
        fem->report[b].marked++;
    }
}

void brunt_erosion_mark_elements(const brunt_erosion *erosion, const brunt_erosion_step *step) {
    mark_job j = {erosion, step->bodies};
    brunt_parallel(step->threads, step->bodies->tasks.element_count, 1, mark_blocks, &j, step->timer);
    for (int k = 0; k < step->bodies->fem_count; k++) {
        const brunt_fem_body *fem = &step->bodies->fem[k];
        const double least = fem->bonds ? erosion->rule[fem->index].step : 0;
        for (int32_t b = 0; least > 0 && b < fem->block_count; b++)
            if (fem->block[b].count && fem->report[b].stable_step < least) mark_short(erosion, step, k, b);
    }
}

static int32_t list_marked(struct brunt_erosion_work *work, const brunt_fem_body *fem) {
    int32_t count = 0;
    for (int32_t b = 0; b < fem->block_count; b++) {
        const brunt_fem_block *block = &fem->block[b];
        for (int32_t s = block->first; fem->report[b].marked && s < block->first + block->count; s++)
            if (fem->mark[s] != BRUNT_MARK_NONE) work->slots[count++] = s;
    }
    return count;
}

// ------------------------------------------------------------------------------------------ what goes with them

static void account_elements(brunt_erosion *erosion, const brunt_erosion_step *step, int k, int32_t count) {
    brunt_fem_body *fem = &step->bodies->fem[k];
    brunt_eroded *account = &erosion->account[fem->index];
    for (int32_t i = 0; i < count; i++) {
        const int32_t slot = erosion->work->slots[i];
        const uint8_t mark = fem->mark[slot];
        const bool turned = mark == BRUNT_MARK_INVERTED;
        brunt_fem_share share = brunt_fem_single_look(erosion->work->single[k], fem, slot, turned ? step->dt : 0,
                                                      step->dt, step->workspace);
        account->energy +=
            share.energy.internal + share.hourglass_stored + (turned ? share.half_work : -share.half_work);
        step->ledger->eroded_plastic += share.energy.plastic;
        step->ledger->eroded_viscosity += share.energy.viscosity;
        step->ledger->eroded_heat += share.energy.heat;
        account->elements++;
        account->inverted += turned;
        account->failed += mark == BRUNT_MARK_FAILED;
        account->strained += mark == BRUNT_MARK_STRAINED;
        account->short_step += mark == BRUNT_MARK_SHORT;
        fem->mark[slot] = BRUNT_MARK_NONE;
    }
}

static void account_node(brunt_eroded *account, brunt_ledger *ledger, brunt_fem_body *fem, int32_t n) {
    const bool axisymmetric = fem->element->axisymmetric;
    real *node = brunt_fem_node(fem, n);
    const double mass = (double)node[BRUNT_FEM_MASS];
    double x[3], p[3], kinetic = 0;
    for (int a = 0; a < 3; a++) {
        const double v = (double)node[BRUNT_FEM_V + a];
        x[a] = (double)node[a], p[a] = mass * v;
        kinetic += 0.5 * mass * v * v;
        node[BRUNT_FEM_V + a] = 0;
    }
    if (axisymmetric) p[0] = 0; // of a whole ring
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        account->momentum[a] += p[a];
        if (!axisymmetric) account->angular[a] += x[b] * p[c] - x[c] * p[b];
    }
    account->mass += mass;
    account->energy += kinetic;
    ledger->fem_kinetic -= kinetic;
    node[BRUNT_FEM_MASS] = (real)BRUNT_FEM_NO_MASS;
}

static int ascending(const void *left, const void *right) {
    int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
    return (a > b) - (a < b);
}

// Nodes of the elements that go, each once, ascending: their count, or BRUNT_NONE: out of memory.
static int32_t list_corners(struct brunt_erosion_work *work, const brunt_fem_body *fem, int32_t count,
                            brunt_error *error) {
    const int nodes = fem->traits->nodes;
    if (BRUNT_CAPACITY(work->corner, (size_t)count * (size_t)nodes, 0, "nodes of elements that leave", error))
        return BRUNT_NONE;
    int32_t found = 0;
    for (int32_t i = 0; i < count; i++)
        for (int a = 0; a < nodes; a++) work->corner[found++] = fem->element_node[(int64_t)work->slots[i] * nodes + a];
    qsort(work->corner, (size_t)found, sizeof *work->corner, ascending);
    int32_t once = 0;
    for (int32_t i = 0; i < found; i++)
        if (!once || work->corner[once - 1] != work->corner[i]) work->corner[once++] = work->corner[i];
    return once;
}

static int gas_escapes(const brunt_node_set *set, const brunt_erosion_step *step, int32_t element, brunt_error *error) {
    const char *body = set->fem->name;
    brunt_fail(error, BRUNT_FAILED,
               "boundaries (%s): the envelope of the gas has lost element %d of body '%s', time %.9g s, step %.0f: "
               "gas does not flow out through holes",
               set->boundary->name, element + 1, body, step->time, step->steps);
    if (error) {
        error->time = step->time;
        error->id = element;
        const size_t workspace =
            sizeof error->body < sizeof set->fem->name ? sizeof error->body : sizeof set->fem->name;
        memcpy(error->body, body, workspace);
    }
    return BRUNT_FAILED;
}

static int take_out(brunt_erosion *erosion, const brunt_erosion_step *step, int k, int32_t count, brunt_error *error) {
    brunt_fem_body *fem = &step->bodies->fem[k];
    struct brunt_erosion_work *work = erosion->work;
    brunt_eroded *account = &erosion->account[fem->index];
    const int32_t corners = list_corners(work, fem, count, error);
    if (corners < 0) return BRUNT_FAILED;
    account_elements(erosion, step, k, count);
    brunt_fem_remove(fem, work->slots, count, step->workspace);
    for (int32_t i = 0; i < corners; i++) {
        if (fem->bonds[work->corner[i]]) continue;
        account->nodes++;
        if (!erosion->rule[fem->index].keep) account_node(account, step->ledger, fem, work->corner[i]);
    }
    int32_t element;
    const brunt_node_set *gas = brunt_node_sets_follow(step->sets, fem, &element);
    return gas ? gas_escapes(gas, step, element, error) : BRUNT_OK;
}

// The half steps of the ledger, of what is left.
static void renew_sums(const brunt_erosion_step *step) {
    double work = 0, stored = 0;
    for (int k = 0; k < step->bodies->fem_count; k++) {
        brunt_fem_body *fem = &step->bodies->fem[k];
        for (int32_t b = 0; b < fem->block_count; b++) {
            brunt_fem_report *report = &fem->report[b];
            if (report->marked) report->stress_work = brunt_fem_stress_work(fem, b, step->dt);
            report->marked = 0;
            work += report->stress_work;
            stored += report->hourglass_stored;
        }
    }
    step->ledger->fem_stress_work = work;
    step->ledger->hourglass_stored = stored;
}

int brunt_erosion_take_elements(brunt_erosion *erosion, const brunt_erosion_step *step, bool *any, brunt_error *error) {
    *any = false;
    for (int k = 0; k < step->bodies->fem_count; k++) {
        const brunt_fem_body *fem = &step->bodies->fem[k];
        const int32_t count = fem->bonds ? list_marked(erosion->work, fem) : 0;
        if (!count) continue;
        *any = true;
        int status = take_out(erosion, step, k, count, error);
        if (status) return status;
    }
    if (*any) renew_sums(step);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ to be kept

#define EACH(member) BRUNT_SAVED(brunt_eroded, member)
#define AXIS(member, a)                                                                                                \
    { #member, offsetof(brunt_eroded, member[a]), 1, false }
static const brunt_saved saved[] = {
    EACH(elements),   EACH(particles),   EACH(nodes),      EACH(failed),      EACH(strained),
    EACH(short_step), EACH(inverted),    EACH(mass),       EACH(energy),      AXIS(momentum, 0),
    AXIS(angular, 0), AXIS(momentum, 1), AXIS(angular, 1), AXIS(momentum, 2), AXIS(angular, 2),
};
enum { ROWS = BRUNT_COUNT(saved) };

int64_t brunt_erosion_state_count(const brunt_erosion *erosion) {
    return erosion->active ? erosion->count * brunt_saved_count(saved, ROWS) : 0;
}

void brunt_erosion_state_get(const brunt_erosion *erosion, double *out) {
    for (int i = 0; i < erosion->count; i++) out = brunt_saved_get(saved, ROWS, &erosion->account[i], out);
}

void brunt_erosion_state_set(brunt_erosion *erosion, const double *in) {
    for (int i = 0; i < erosion->count; i++) in = brunt_saved_set(saved, ROWS, &erosion->account[i], in);
}
