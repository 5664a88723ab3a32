// Mass-proportional damping of finite-element bodies: m dv/dt = F - c m v, exactly for the mean force F of a kick K:
//   v' = e v + phi K F / m,   e = exp(-c K), phi = (1 - e) / (c K)
// so that any damping slows and none turns a velocity round; with 2 / omega as step it is stable whatever c is (the
// product of its two factors is e, and c dt / 2 >= tanh(c dt / 2)). Impulses of contact and of holders are part of F,
// though not known before the kick: what they change of a velocity is phi J / m, so that they meet a mass m / phi
// (damping_mass times the node's), and drag takes its share of them. What it did in all follows from v and v' alone:
// the impulse m (v' - v) - m (v' - e v) / phi, recorded as viscosity at the mean velocity, as all work is, and as
// external to the momentum, which the ground behind the dashpots carries.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "boundary/damping.h"

typedef struct job {
    const brunt_damping *damping;
    const brunt_bodies *bodies;
    const brunt_kick *kick;
} job;

int brunt_damping_make(brunt_damping *damping, const brunt_bodies *bodies, brunt_error *error) {
    if (BRUNT_NEW(damping->drag, bodies->fem_count + 1, "meshes with damping", error)) return BRUNT_FAILED;
    damping->fem_count = bodies->fem_count;
    for (int k = 0; k < bodies->fem_count; k++) {
        brunt_fem_body *fem = &bodies->fem[k];
        if (!(fem->damping > 0)) continue;
        damping->active = true;
        const size_t numbers = (size_t)(fem->node_count + 1) * 4;
        if (BRUNT_NEW(damping->drag[k], numbers, "forces that damp nodes of a mesh", error) ||
            (!fem->load && BRUNT_NEW(fem->load, numbers, "loads on nodes of a mesh", error)))
            return BRUNT_FAILED;
    }
    if (!damping->active) return BRUNT_OK;
    return BRUNT_NEW(damping->sums, bodies->tasks.node_count + 1, "sums of tasks of nodes", error);
}

void brunt_damping_validate(const brunt_damping *damping, const brunt_bodies *bodies) {
    bool any = false;
    BRUNT_ASSERT(damping->fem_count == bodies->fem_count && damping->drag);
    for (int k = 0; k < bodies->fem_count; k++) {
        const brunt_fem_body *fem = &bodies->fem[k];
        BRUNT_ASSERT((fem->damping > 0) == (damping->drag[k] != NULL) && (!damping->drag[k] || fem->load));
        any = any || damping->drag[k];
    }
    BRUNT_ASSERT(damping->active == any && damping->active == (damping->sums != NULL));
}

void brunt_damping_free(brunt_damping *damping) {
    for (int k = 0; k < damping->fem_count; k++) brunt_free(damping->drag[k]);
    brunt_free(damping->drag);
    brunt_free(damping->sums);
}

// The drag on what is known of the force, as a load; the velocities from before it are kept.
static void drag_nodes(const job *j, const brunt_fem_task *task) {
    const brunt_fem_body *fem = &j->bodies->fem[task->fem];
    const double loss = -expm1(-fem->damping * j->kick->dt) / j->kick->dt, share = 1 - 1 / fem->damping_mass;
    real *kept = j->damping->drag[task->fem];
    for (int32_t n = task->begin; kept && n < task->end; n++) {
        const real *node = brunt_fem_node(fem, n);
        const double mass = (double)node[BRUNT_FEM_MASS];
        real force[3];
        brunt_fem_internal_force(fem, n, force);
        for (int a = 0; a < 3; a++) {
            const double v = (double)node[BRUNT_FEM_V + a];
            real *load = &fem->load[4 * (size_t)n + (size_t)a];
            *load -= (real)(mass * loss * v + share * ((double)force[a] + (double)*load + mass * j->kick->gravity[a]));
            kept[4 * (size_t)n + (size_t)a] = (real)v;
        }
    }
}

// What the drag of the kick did.
static void account_nodes(const job *j, const brunt_fem_task *task, brunt_damping_sums *sums) {
    const brunt_fem_body *fem = &j->bodies->fem[task->fem];
    const double left = exp(-fem->damping * j->kick->dt);
    const real *kept = j->damping->drag[task->fem];
    memset(sums, 0, sizeof *sums);
    for (int32_t n = task->begin; kept && n < task->end; n++) {
        const real *node = brunt_fem_node(fem, n);
        double J[3];
        for (int a = 0; a < 3; a++) {
            const double v = (double)node[BRUNT_FEM_V + a], old = (double)kept[4 * (size_t)n + (size_t)a];
            J[a] = (double)node[BRUNT_FEM_MASS] * ((v - old) - fem->damping_mass * (v - left * old));
            sums->loss -= 0.5 * J[a] * (old + v);
            sums->impulse[a] += J[a];
        }
        for (int a = 0; a < 3; a++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            sums->angular[a] += (double)node[b] * J[c] - (double)node[c] * J[b];
        }
    }
}

static void drag_tasks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t t = begin; t < end; t++) drag_nodes(j, &j->bodies->tasks.node[t]);
}

static void account_tasks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t t = begin; t < end; t++) account_nodes(j, &j->bodies->tasks.node[t], &j->damping->sums[t]);
}

void brunt_damping_begin(const brunt_damping *damping, const brunt_bodies *bodies, const brunt_kick *kick) {
    job j = {damping, bodies, kick};
    for (int k = 0; k < bodies->fem_count; k++) {
        brunt_fem_body *fem = &bodies->fem[k];
        const double decay = fem->damping * kick->dt;
        if (damping->drag[k]) fem->damping_mass = decay > 0 ? decay / -expm1(-decay) : 1; // too small a number is 0
    }
    brunt_parallel(kick->threads, bodies->tasks.node_count, 1, drag_tasks, &j, kick->timer);
}

void brunt_damping_end(const brunt_damping *damping, const brunt_bodies *bodies, const brunt_kick *kick,
                       brunt_damping_sums *done) {
    job j = {damping, bodies, kick};
    brunt_parallel(kick->threads, bodies->tasks.node_count, 1, account_tasks, &j, kick->timer);
    for (int64_t t = 0; t < bodies->tasks.node_count; t++) {
        const brunt_damping_sums *s = &damping->sums[t];
        done->loss += s->loss;
        for (int a = 0; a < 3; a++) done->impulse[a] += s->impulse[a], done->angular[a] += s->angular[a];
    }
}
