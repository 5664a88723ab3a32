// Inertia, dead loads and prescribed motion of an implicit step.
#include "scheme/step_terms.h"

#include <math.h>

#include "linear/block_matrix.h"

// ------------------------------------------------------------------------------------------ sums

enum { STRETCH = 512, STRETCHES = 256 }; // nodes; stretches whose sums are kept at a time

typedef struct sum_job {
    brunt_stretch_fn *add;
    const void *context;
    int32_t count;
    int64_t first;
    brunt_energy_sum sum[STRETCHES];
} sum_job;

static void sum_stretches(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    sum_job *job = context;
    for (int64_t s = begin; s < end; s++) {
        const int64_t from = (job->first + s) * STRETCH, to = from + STRETCH;
        job->sum[s] = job->add(job->context, (int32_t)from, to < job->count ? (int32_t)to : job->count);
    }
}

brunt_energy_sum brunt_sum_nodes(const brunt_team *team, int32_t count, brunt_stretch_fn *add, const void *context) {
    sum_job job = {.add = add, .context = context, .count = count};
    brunt_energy_sum all = {0};
    const int64_t stretches = ((int64_t)count + STRETCH - 1) / STRETCH;
    for (job.first = 0; job.first < stretches; job.first += STRETCHES) {
        const int64_t n = stretches - job.first < STRETCHES ? stretches - job.first : STRETCHES;
        brunt_parallel(team->threads, n, 1, sum_stretches, &job, team->timer);
        for (int64_t s = 0; s < n; s++) all.value += job.sum[s].value, all.magnitude += job.sum[s].magnitude;
    }
    return all;
}

// ------------------------------------------------------------------------------------------ inertia

typedef struct inertia_sum {
    const brunt_inertia *inertia;
    const double *u;
} inertia_sum;

static brunt_energy_sum inertia_stretch(const void *context, int32_t begin, int32_t end) {
    const inertia_sum *job = context;
    const brunt_unknowns *unknowns = job->inertia->unknowns;
    const int dim = unknowns->dim;
    brunt_energy_sum sum = {0};
    for (int32_t n = begin; n < end; n++) {
        double square = 0;
        for (int a = 0; a < dim; a++) {
            const double off = job->u[n * (int64_t)dim + a] - job->inertia->aim[n * (int64_t)dim + a];
            square += off * off;
        }
        sum.value += unknowns->mass[n] * square;
    }
    sum.value *= 0.5 / job->inertia->c;
    sum.magnitude = sum.value;
    return sum;
}

static brunt_energy_sum inertia_energy(void *term, const brunt_team *team, const double *u) {
    const brunt_inertia *inertia = term;
    const inertia_sum job = {inertia, u};
    return brunt_sum_nodes(team, inertia->unknowns->count, inertia_stretch, &job);
}

typedef struct add_job {
    const void *term;
    const double *u;
    double *g;
    brunt_block_matrix *h;
} add_job;

static void inertia_add(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const add_job *job = context;
    const brunt_inertia *inertia = job->term;
    const int dim = inertia->unknowns->dim;
    for (int64_t n = begin; n < end; n++)
        for (int64_t dof = n * dim; dof < (n + 1) * dim; dof++)
            job->g[dof] += inertia->unknowns->mass[n] / inertia->c * (job->u[dof] - inertia->aim[dof]);
}

static void inertia_gradient(void *term, const brunt_team *team, const double *u, double *g) {
    const brunt_inertia *inertia = term;
    add_job job = {.term = inertia, .u = u, .g = g};
    brunt_parallel(team->threads, inertia->unknowns->count, STRETCH, inertia_add, &job, team->timer);
}

static void inertia_add_hessian(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const add_job *job = context;
    const brunt_inertia *inertia = job->term;
    for (int64_t n = begin; n < end; n++)
        for (int a = 0; a < job->h->dim; a++)
            brunt_block_matrix_diagonal(job->h, (int32_t)n)[a * (job->h->dim + 1)] +=
                inertia->unknowns->mass[n] / inertia->c;
}

static void inertia_hessian(void *term, const brunt_team *team, const double *u, bool project,
                            struct brunt_block_matrix *h) {
    (void)u, (void)project; // it has no negative eigenvalues
    const brunt_inertia *inertia = term;
    add_job job = {.term = inertia, .h = h};
    brunt_parallel(team->threads, inertia->unknowns->count, STRETCH, inertia_add_hessian, &job, team->timer);
}

const brunt_term_ops brunt_inertia_ops = {
    .name = "inertia", .energy = inertia_energy, .gradient = inertia_gradient, .hessian = inertia_hessian};

// ------------------------------------------------------------------------------------------ about the iterate

static brunt_energy_sum proximal_energy(void *term, const brunt_team *team, const double *u) {
    (void)term, (void)team, (void)u; // 0 at the iterate, and the energy that steps are judged by is without it
    return (brunt_energy_sum){0};
}

static void proximal_gradient(void *term, const brunt_team *team, const double *u, double *g) {
    (void)term, (void)team, (void)u, (void)g;
}

static void proximal_add_hessian(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const add_job *job = context;
    const brunt_proximal *p = job->term;
    for (int64_t n = begin; n < end; n++) {
        const double grid = n < p->unknowns->mesh_count ? 0 : p->everywhere;
        const double share = p->support[n] == BRUNT_GROUNDED ? grid : p->share[p->support[n]];
        for (int a = 0; a < job->h->dim; a++)
            brunt_block_matrix_diagonal(job->h, (int32_t)n)[a * (job->h->dim + 1)] += share * p->stiffness[n];
    }
}

static void proximal_hessian(void *term, const brunt_team *team, const double *u, bool project,
                             struct brunt_block_matrix *h) {
    (void)u, (void)project; // it has no negative eigenvalues
    const brunt_proximal *p = term;
    add_job job = {.term = p, .h = h};
    brunt_parallel(team->threads, p->unknowns->count, STRETCH, proximal_add_hessian, &job, team->timer);
}

const brunt_term_ops brunt_proximal_ops = {.name = "the iterate's neighbourhood",
                                           .energy = proximal_energy,
                                           .gradient = proximal_gradient,
                                           .hessian = proximal_hessian};

// ------------------------------------------------------------------------------------------ dead loads

typedef struct load_sum {
    const brunt_dead_loads *loads;
    const double *u;
} load_sum;

static brunt_energy_sum load_stretch(const void *context, int32_t begin, int32_t end) {
    const load_sum *job = context;
    const int dim = job->loads->unknowns->dim;
    brunt_energy_sum sum = {0};
    for (int64_t dof = (int64_t)begin * dim; dof < (int64_t)end * dim; dof++) {
        const double work = job->loads->force[dof] * job->u[dof];
        sum.value -= work, sum.magnitude += fabs(work);
    }
    return sum;
}

static brunt_energy_sum load_energy(void *term, const brunt_team *team, const double *u) {
    const load_sum job = {term, u};
    return brunt_sum_nodes(team, job.loads->unknowns->count, load_stretch, &job);
}

static void load_add(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const add_job *job = context;
    const brunt_dead_loads *loads = job->term;
    const int dim = loads->unknowns->dim;
    for (int64_t dof = begin * dim; dof < end * dim; dof++) job->g[dof] -= loads->force[dof];
}

static void load_gradient(void *term, const brunt_team *team, const double *u, double *g) {
    const brunt_dead_loads *loads = term;
    add_job job = {.term = loads, .u = u, .g = g};
    brunt_parallel(team->threads, loads->unknowns->count, STRETCH, load_add, &job, team->timer);
}

const brunt_term_ops brunt_dead_load_ops = {.name = "loads", .energy = load_energy, .gradient = load_gradient};

// ------------------------------------------------------------------------------------------ drag

typedef struct drag_sum {
    const brunt_drag *drag;
    const double *u;
} drag_sum;

static brunt_energy_sum drag_stretch(const void *context, int32_t begin, int32_t end) {
    const drag_sum *job = context;
    const brunt_drag *drag = job->drag;
    const int64_t dim = drag->unknowns->dim;
    double sum = 0;
    for (int64_t dof = begin * dim; dof < end * dim; dof++) {
        const double off = job->u[dof] - drag->rest[dof];
        sum += drag->weight[dof / dim] * off * off;
    }
    sum *= 0.5 * drag->slope;
    return (brunt_energy_sum){.value = sum, .magnitude = sum};
}

static brunt_energy_sum drag_energy(void *term, const brunt_team *team, const double *u) {
    const drag_sum job = {term, u};
    if (!job.drag->weight) return (brunt_energy_sum){0};
    return brunt_sum_nodes(team, job.drag->unknowns->count, drag_stretch, &job);
}

static void drag_gradient(void *term, const brunt_team *team, const double *u, double *g) {
    const brunt_drag *drag = term;
    const int64_t dim = drag->unknowns->dim;
    (void)team;
    for (int64_t dof = 0; drag->weight && dof < drag->unknowns->count * dim; dof++)
        g[dof] += drag->slope * drag->weight[dof / dim] * (u[dof] - drag->rest[dof]);
}

static void drag_hessian(void *term, const brunt_team *team, const double *u, bool project,
                         struct brunt_block_matrix *h) {
    (void)u, (void)project, (void)team; // it has no negative eigenvalues
    const brunt_drag *drag = term;
    for (int32_t n = 0; drag->weight && n < drag->unknowns->count; n++)
        for (int a = 0; a < h->dim; a++)
            brunt_block_matrix_diagonal(h, n)[a * (h->dim + 1)] += drag->slope * drag->weight[n];
}

const brunt_term_ops brunt_drag_ops = {
    .name = "damping", .energy = drag_energy, .gradient = drag_gradient, .hessian = drag_hessian};

// ------------------------------------------------------------------------------------------ prescribed motion

typedef struct pull_sum {
    const brunt_pull *pull;
    const double *u;
} pull_sum;

static brunt_energy_sum pull_stretch(const void *context, int32_t begin, int32_t end) {
    const pull_sum *job = context;
    const brunt_unknowns *unknowns = job->pull->unknowns;
    brunt_energy_sum sum = {0};
    for (int64_t dof = (int64_t)begin * unknowns->dim; dof < (int64_t)end * unknowns->dim; dof++) {
        const double off = job->u[dof] - unknowns->target[dof];
        if (job->pull->weight[dof] > 0) sum.value += 0.5 * job->pull->weight[dof] * off * off;
    }
    sum.magnitude = sum.value;
    return sum;
}

static brunt_energy_sum pull_energy(void *term, const brunt_team *team, const double *u) {
    const pull_sum job = {term, u};
    if (!job.pull->weight) return (brunt_energy_sum){0};
    return brunt_sum_nodes(team, job.pull->unknowns->count, pull_stretch, &job);
}

static void pull_add(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const add_job *job = context;
    const brunt_pull *pull = job->term;
    const int dim = pull->unknowns->dim;
    for (int64_t dof = begin * dim; dof < end * dim; dof++)
        if (pull->weight[dof] > 0) job->g[dof] += pull->weight[dof] * (job->u[dof] - pull->unknowns->target[dof]);
}

static void pull_gradient(void *term, const brunt_team *team, const double *u, double *g) {
    const brunt_pull *pull = term;
    add_job job = {.term = pull, .u = u, .g = g};
    if (pull->weight) brunt_parallel(team->threads, pull->unknowns->count, STRETCH, pull_add, &job, team->timer);
}

static void pull_add_hessian(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const add_job *job = context;
    const brunt_pull *pull = job->term;
    for (int64_t n = begin; n < end; n++)
        for (int a = 0; a < job->h->dim; a++)
            brunt_block_matrix_diagonal(job->h, (int32_t)n)[a * (job->h->dim + 1)] += pull->weight[n * job->h->dim + a];
}

static void pull_hessian(void *term, const brunt_team *team, const double *u, bool project,
                         struct brunt_block_matrix *h) {
    (void)u, (void)project; // it has no negative eigenvalues
    const brunt_pull *pull = term;
    add_job job = {.term = pull, .h = h};
    if (pull->weight)
        brunt_parallel(team->threads, pull->unknowns->count, STRETCH, pull_add_hessian, &job, team->timer);
}

const brunt_term_ops brunt_pull_ops = {
    .name = "prescribed motion", .energy = pull_energy, .gradient = pull_gradient, .hessian = pull_hessian};
