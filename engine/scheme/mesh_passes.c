// The passes over finite-element bodies. Tasks are runs of nodes and blocks of elements of all bodies together, so that
// many small bodies keep all threads busy as well as one large one does.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "scheme/scheme.h"

enum { NODES_A_TASK = 1024 };

static int64_t list_tasks(const brunt_world *world, brunt_fem_task *nodes, brunt_fem_task *elements) {
    int64_t n = 0, e = 0;
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const brunt_fem_body *fem = &world->bodies.fem[k];
        for (int32_t i = 0; i < fem->node_count; i += NODES_A_TASK, n++)
            if (nodes)
                nodes[n] =
                    (brunt_fem_task){k, i, i + NODES_A_TASK < fem->node_count ? i + NODES_A_TASK : fem->node_count};
        for (int32_t b = 0; b < fem->block_count; b++, e++)
            if (elements) elements[e] = (brunt_fem_task){k, b, b + 1};
    }
    return nodes || !elements ? n : e;
}

int brunt_fem_tasks_make(brunt_world *world, brunt_error *error) {
    world->bodies.tasks.node_count = list_tasks(world, NULL, NULL);
    for (int k = 0; k < world->bodies.fem_count; k++)
        world->bodies.tasks.element_count += world->bodies.fem[k].block_count;
    if (BRUNT_NEW(world->bodies.tasks.node, world->bodies.tasks.node_count + 1, "tasks of nodes", error) ||
        BRUNT_NEW(world->bodies.tasks.element, world->bodies.tasks.element_count + 1, "tasks of elements", error) ||
        BRUNT_NEW(world->bodies.tasks.sums, world->bodies.tasks.node_count + 1, "sums of tasks of nodes", error))
        return BRUNT_FAILED;
    list_tasks(world, world->bodies.tasks.node, world->bodies.tasks.element);
    for (int t = 0; t < world->settings.threads; t++)
        for (int k = 0; k < world->bodies.fem_count; k++)
            if (brunt_fem_workspace_fit(&world->scratch.meshes[t], &world->bodies.fem[k], error)) return BRUNT_FAILED;
    return BRUNT_OK;
}

typedef struct job {
    brunt_world *world;
    const double *gravity;
    double dt;
} job;

// Nodes that have left their body stay where they were, whatever gravity.
static void keep_still(brunt_fem_body *fem, int32_t begin, int32_t end) {
    for (int32_t n = begin; n < end; n++)
        for (int a = 0; brunt_fem_removed(fem, n) && a < 3; a++) brunt_fem_node(fem, n)[BRUNT_FEM_V + a] = 0;
}

static void kick_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t t = begin; t < end; t++) {
        const brunt_fem_task *task = &j->world->bodies.tasks.node[t];
        brunt_fem_body *fem = &j->world->bodies.fem[task->fem];
        brunt_fem_kick(fem, task->begin, task->end, j->dt, j->gravity, &j->world->bodies.tasks.sums[t]);
        if (fem->bonds && fem->element_count < fem->mesh_elements) keep_still(fem, task->begin, task->end);
    }
}

// A free ring that closes on the axis opens again: what came from one side goes on on the other.
static void pass_axis(brunt_fem_body *fem, const brunt_fem_task *task) {
    for (int32_t n = task->begin; n < task->end; n++) {
        real *node = brunt_fem_node(fem, n);
        if (fem->bonds[n] == 0 && node[BRUNT_FEM_X] < 0) {
            node[BRUNT_FEM_X] = -node[BRUNT_FEM_X];
            node[BRUNT_FEM_V] = -node[BRUNT_FEM_V];
        }
    }
}

static void drift_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t t = begin; t < end; t++) {
        const brunt_fem_task *task = &j->world->bodies.tasks.node[t];
        brunt_fem_body *fem = &j->world->bodies.fem[task->fem];
        brunt_fem_drift(fem, task->begin, task->end, j->dt, &j->world->bodies.tasks.sums[t]);
        if (fem->bonds && fem->element->axisymmetric) pass_axis(fem, task);
    }
}

static void strain_elements(void *context, int64_t begin, int64_t end, int worker) {
    const job *j = context;
    for (int64_t t = begin; t < end; t++) {
        const brunt_fem_task *task = &j->world->bodies.tasks.element[t];
        brunt_fem_body *fem = &j->world->bodies.fem[task->fem];
        if (fem->block[task->begin].count) // all of them may have eroded
            fem->element->forces(fem, task->begin, (real)j->dt, &j->world->scratch.meshes[worker],
                                 &fem->report[task->begin]);
    }
}

// Gravity's work is taken at the mean of the velocities before the kick and after all impulses.
static void account_gravity(brunt_world *world, const double gravity[3], double dt) {
    for (int64_t t = 0; t < world->bodies.tasks.node_count; t++) {
        const brunt_fem_sums *s = &world->bodies.tasks.sums[t];
        for (int a = 0; a < 3; a++) {
            int k = (a + 1) % 3, l = (a + 2) % 3;
            world->ledger.gravity_work += 0.5 * dt * gravity[a] * (s->momentum_old[a] + s->momentum[a]);
            world->ledger.gravity_impulse[a] += dt * s->mass * gravity[a];
            world->ledger.gravity_angular[a] +=
                dt * (s->first_moment[k] * gravity[l] - s->first_moment[l] * gravity[k]);
        }
    }
}

static brunt_kick kick_of(brunt_world *world, const brunt_step *step) {
    const double *gravity = step->gravity;
    return (brunt_kick){.dt = step->kick,
                        .gravity = {gravity[0], gravity[1], gravity[2]},
                        .threads = world->settings.threads,
                        .timer = brunt_pass_timer(&world->timing)};
}

int brunt_pass_kick(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)error;
    const brunt_kick drag = kick_of(world, step);
    job j = {world, step->gravity, step->kick};
    if (world->boundaries.sets.act || world->boundaries.damping.active)
        brunt_loads_begin(&world->boundaries.sets, &world->bodies, world->clock.time, step->kick);
    if (world->boundaries.damping.active) brunt_damping_begin(&world->boundaries.damping, &world->bodies, &drag);
    brunt_parallel(world->settings.threads, world->bodies.tasks.node_count, 1, kick_nodes, &j,
                   brunt_pass_timer(&world->timing));
    return BRUNT_OK;
}

int brunt_pass_groups(brunt_world *world, brunt_step *step, brunt_error *error) {
    const brunt_kick kick = kick_of(world, step);
    brunt_node_sets_prescribe(&world->boundaries.sets, &kick, world->clock.time, step->dt);
    const brunt_node_set *lost = world->boundaries.sets.gas_lost;
    if (!lost) return BRUNT_OK;
    char reason[200];
    snprintf(reason, sizeof reason, "boundaries (%s): the gas's volume has become %.4g m^3", lost->boundary->name,
             lost->gas_volume);
    return brunt_fail_step(&world->clock, NULL, error, reason);
}

// The other half of what loads and drag do: velocities are final now.
int brunt_pass_finish_kick(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)error;
    const brunt_kick drag = kick_of(world, step);
    if (world->boundaries.sets.act) brunt_loads_end(&world->boundaries.sets, step->kick);
    if (world->boundaries.damping.active)
        brunt_damping_end(&world->boundaries.damping, &world->bodies, &drag, &world->ledger.damping);
    return BRUNT_OK;
}

int brunt_pass_drift(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)error;
    job j = {world, step->gravity, step->dt};
    brunt_parallel(world->settings.threads, world->bodies.tasks.node_count, 1, drift_nodes, &j,
                   brunt_pass_timer(&world->timing));
    if (world->settings.has_gravity) account_gravity(world, step->gravity, step->kick);
    world->ledger.fem_kinetic = 0;
    for (int64_t t = 0; t < world->bodies.tasks.node_count; t++)
        world->ledger.fem_kinetic += world->bodies.tasks.sums[t].kinetic;
    return BRUNT_OK;
}

int brunt_pass_elements(brunt_world *world, brunt_step *step, brunt_error *error) {
    int32_t bad = -1;
    const char *reason = "";
    const brunt_fem_body *failed = brunt_fem_elements_all(world, step->dt, &bad, &reason);
    if (failed && !step->status) step->status = brunt_fail_element(&world->clock, failed, bad, error, reason);
    return BRUNT_OK;
}

brunt_fem_body *brunt_fem_elements_all(brunt_world *world, double dt, int32_t *bad, const char **reason) {
    job j = {.world = world, .dt = dt};
    brunt_parallel(world->settings.threads, world->bodies.tasks.element_count, 1, strain_elements, &j,
                   brunt_pass_timer(&world->timing));
    brunt_fem_body *failed = NULL;
    double work = 0, stored = 0;
    for (int k = 0; k < world->bodies.fem_count; k++)
        for (int32_t b = 0; b < world->bodies.fem[k].block_count; b++) {
            const brunt_fem_report *r = &world->bodies.fem[k].report[b];
            work += r->stress_work;
            stored += r->hourglass_stored;
            if (dt > 0) world->ledger.hourglass_lost += r->hourglass_lost;
            if (r->bad >= 0 && !failed) failed = &world->bodies.fem[k], *bad = r->bad, *reason = r->reason;
        }
    world->ledger.hourglass_stored = stored;
    if (dt > 0) world->ledger.fem_stress_work = work;
    return failed;
}

double brunt_fem_stable_step(const brunt_world *world) {
    double least = INFINITY;
    for (int k = 0; k < world->bodies.fem_count; k++) {
        double step = brunt_body_step(world, world->bodies.fem[k].index, 0);
        if (isnan(step)) return NAN;
        least = fmin(least, step);
    }
    return least;
}

// The slot of a body's element that has the shortest step, BRUNT_NONE: out of memory.
static int32_t shortest_element(brunt_scratch *scratch, const brunt_fem_body *fem) {
    brunt_fem_single *single = brunt_fem_single_make(fem);
    const double block_least = brunt_fem_blocks_step(fem);
    double shortest = INFINITY;
    int32_t slot = BRUNT_NONE;
    for (int32_t b = 0; single && b < fem->block_count; b++) {
        const brunt_fem_block *block = &fem->block[b];
        if (!block->count || fem->report[b].stable_step > block_least) continue;
        for (int32_t s = block->first; s < block->first + block->count; s++) {
            double step = brunt_fem_single_look(single, fem, s, 0, 0, &scratch->meshes[0]).stable_step;
            if (step < shortest) shortest = step, slot = s;
        }
    }
    brunt_fem_single_free(single);
    return slot;
}

brunt_fem_body *brunt_fem_shortest(brunt_world *world, int32_t *slot) {
    const double least = brunt_fem_stable_step(world);
    for (int k = 0; k < world->bodies.fem_count; k++)
        if (brunt_body_step(world, world->bodies.fem[k].index, 0) <= least)
            return (*slot = shortest_element(&world->scratch, &world->bodies.fem[k])) < 0 ? NULL
                                                                                          : &world->bodies.fem[k];
    return NULL;
}
