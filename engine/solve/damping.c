// Mass-proportional damping of finite-element bodies: a force of -damping m v on every node, at the mean of the
// velocities before and after the kick (before contact), which makes it of second order and stable for any damping. It
// is a load like others, but what it takes is booked as viscosity, and the impulse that the ground behind the dashpots
// bears as external.
#include <string.h>

#include "error.h"
#include "memory.h"
#include "threads.h"
#include "world.h"

typedef struct job {
    brunt_world *world;
    double dt;
    const double *gravity; // NULL at the end
} job;

int brunt_damping_make(brunt_world *world, brunt_error *error) {
    world->drag = brunt_alloc((size_t)(world->fem_count + 1) * sizeof *world->drag);
    if (!world->drag) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    for (int k = 0; k < world->fem_count; k++) {
        brunt_fem_body *fem = &world->fems[k];
        if (!(fem->damping > 0)) continue;
        world->has_damping = true;
        size_t bytes = (size_t)(fem->node_count + 1) * 4 * sizeof(real);
        if (!(world->drag[k] = brunt_alloc(bytes)) || (!fem->load && !(fem->load = brunt_alloc(bytes))))
            return brunt_fail(error, BRUNT_FAILED, "bodies.%s: out of memory", fem->name);
    }
    if (!world->has_damping) return BRUNT_OK;
    world->damping_sums = brunt_alloc((size_t)(world->node_task_count + 1) * sizeof *world->damping_sums);
    return world->damping_sums ? BRUNT_OK : brunt_fail(error, BRUNT_FAILED, "out of memory");
}

void brunt_damping_free(brunt_world *world) {
    for (int k = 0; world->drag && k < world->fem_count; k++) brunt_free(world->drag[k]);
    brunt_free(world->drag);
    brunt_free(world->damping_sums);
}

// Half of the work of the drag at the velocities as they are; at the beginning the drag itself, too.
static void damp_nodes(const job *j, const brunt_fem_task *task, brunt_damping_sums *sums) {
    const brunt_fem_body *fem = &j->world->fems[task->fem];
    real *drag = j->world->drag[task->fem];
    memset(sums, 0, sizeof *sums);
    for (int32_t n = task->begin; drag && n < task->end; n++) {
        const real *node = brunt_fem_node(fem, n);
        const double mass = (double)node[BRUNT_FEM_MASS];
        real *D = drag + 4 * (size_t)n, force[3];
        if (j->gravity) brunt_fem_internal_force(fem, n, force);
        for (int a = 0; a < 3; a++) {
            const double v = (double)node[BRUNT_FEM_V + a];
            if (j->gravity) {
                real *load = &fem->load[4 * (size_t)n + (size_t)a];
                double half = 0.5 * j->dt * (((double)force[a] + (double)*load) / mass + j->gravity[a]);
                D[a] = (real)(-fem->damping * mass * (v + half) / (1 + 0.5 * j->dt * fem->damping));
                *load += D[a];
            }
            sums->work += 0.5 * j->dt * (double)D[a] * v;
        }
        for (int a = 0; j->gravity && a < 3; a++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            sums->impulse[a] += j->dt * (double)D[a];
            sums->angular[a] += j->dt * ((double)node[b] * (double)D[c] - (double)node[c] * (double)D[b]);
        }
    }
}

static void damp_tasks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t t = begin; t < end; t++) damp_nodes(j, &j->world->node_tasks[t], &j->world->damping_sums[t]);
}

static void damp(brunt_world *world, double dt, const double *gravity) {
    job j = {world, dt, gravity};
    brunt_parallel(world->threads, world->node_task_count, 1, damp_tasks, &j, &world->pass[BRUNT_PASS_kick].threads);
    for (int64_t t = 0; t < world->node_task_count; t++) {
        const brunt_damping_sums *s = &world->damping_sums[t];
        world->now.damped -= s->work;
        if (!gravity) world->now.fem_damping_work += s->work;
        for (int a = 0; a < 3; a++)
            world->now.damping_impulse[a] += s->impulse[a], world->now.damping_angular[a] += s->angular[a];
    }
}

void brunt_damping_begin(brunt_world *world, const double gravity[3], double dt) { damp(world, dt, gravity); }
void brunt_damping_end(brunt_world *world, double dt) { damp(world, dt, NULL); }
