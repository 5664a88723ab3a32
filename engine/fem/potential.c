// A body's term: over its blocks and nodes, whatever its elements are.
#include "fem/potential_parts.h"

const char *brunt_fem_implicit(const brunt_fem_body *body) {
    if (body->element->axisymmetric) return "elements about an axis have no implicit steps";
    if (brunt_fem_has_hourglass(body) && body->hourglass == BRUNT_HOURGLASS_VISCOUS)
        return "viscous hourglass control has no potential for implicit steps: stiffness has";
    if (body->bonds) return "bodies whose elements erode have no implicit steps";
    return brunt_material_implicit(&body->material);
}

// --------------------------------------------------------------------------------- making

static int make_arrays(brunt_fem_potential *p, brunt_error *error) {
    const brunt_fem_body *body = p->body;
    const size_t numbers = (size_t)body->node_count * (size_t)p->dim;
    static const char of_nodes[] = "numbers of nodes of a mesh", elements[] = "elements of a mesh";
    if (BRUNT_NEW(p->displacement, numbers, of_nodes, error) || BRUNT_NEW(p->way, numbers, of_nodes, error) ||
        BRUNT_NEW(p->force, (size_t)body->partial_count * 4, "numbers of nodes of blocks of a mesh", error) ||
        BRUNT_NEW(p->energy, body->block_count, "blocks of a mesh", error) ||
        BRUNT_NEW(p->limit, body->block_count, "blocks of a mesh", error) ||
        BRUNT_NEW(p->first, body->element_count + 1, elements, error) ||
        BRUNT_NEW(p->node, (size_t)body->element_count * (size_t)p->nodes, "nodes of elements of a mesh", error) ||
        BRUNT_NEW(p->slot, body->element_count, elements, error))
        return BRUNT_FAILED;
    return p->kind->make(p, error);
}

static void make_stencils(brunt_fem_potential *p) {
    const brunt_fem_body *body = p->body;
    int32_t count = 0;
    for (int32_t b = 0; b < body->block_count; b++)
        for (int32_t s = body->block[b].first; s < body->block[b].first + body->block[b].count; s++, count++) {
            p->slot[count] = s;
            p->first[count + 1] = (int64_t)(count + 1) * p->nodes;
            for (int a = 0; a < p->nodes; a++)
                p->node[(int64_t)count * p->nodes + a] = p->base + body->element_node[(size_t)s * p->nodes + a];
        }
}

static brunt_stencils stencils(void *self) {
    const brunt_fem_potential *p = self;
    return (brunt_stencils){.count = p->body->element_count, .first = p->first, .node = p->node, .version = 1};
}

static double moduli_of(brunt_fem_body *body) {
    const real *volume = brunt_element_scalars(body, BRUNT_ELEMENT_reference_volume)[0];
    const double c0 = (double)body->material.wave_speed;
    double all = 0;
    for (int64_t s = 0; s < body->slots; s++) all += (double)volume[s];
    return all * (double)body->material.density * c0 * c0;
}

brunt_fem_potential *brunt_fem_potential_make(brunt_fem_body *body, int32_t base, const brunt_team *team,
                                              brunt_error *error) {
    const char *reason = brunt_fem_implicit(body);
    if (reason) {
        brunt_fail(error, BRUNT_BAD_INPUT, "body '%s': %s", body->name, reason);
        return NULL;
    }
    brunt_fem_potential *p;
    if (BRUNT_NEW(p, 1, "room for the implicit steps of a mesh", error)) return NULL;
    const brunt_model *strength = body->material.model[BRUNT_STRENGTH];
    *p = (brunt_fem_potential){.kind =
                                   body->traits->membrane ? &brunt_fem_membrane_potential : &brunt_fem_solid_potential,
                               .body = body,
                               .base = base,
                               .dim = body->dim,
                               .nodes = body->traits->nodes,
                               .modes = brunt_fem_has_hourglass(body) ? body->element->hourglass_modes : 0,
                               .tangents = brunt_material_tangents(&body->material, body->dim),
                               .history = strength->plastic || strength->shear_viscous || body->material.differences,
                               .moduli = moduli_of(body)};
    int status = make_arrays(p, error);
    if (!status) {
        make_stencils(p);
        const brunt_stencils list = stencils(p);
        status = brunt_colours_make(&p->colours, team, p->dim, base + body->node_count, &list, error);
    }
    if (!status) return p;
    brunt_fem_potential_free(p);
    return NULL;
}

void brunt_fem_potential_free(brunt_fem_potential *p) {
    if (!p) return;
    brunt_colours_free(&p->colours);
    brunt_free(p->slab), brunt_free(p->membrane), brunt_free(p->displacement), brunt_free(p->way), brunt_free(p->force),
        brunt_free(p->energy);
    brunt_free(p->limit), brunt_free(p->first), brunt_free(p->node), brunt_free(p->slot);
    brunt_free(p);
}

size_t brunt_fem_potential_bytes(const brunt_fem_potential *p) {
    const brunt_fem_body *body = p->body;
    return p->slab_bytes + (size_t)body->node_count * (size_t)p->dim * 2 * sizeof(double) +
           (size_t)body->partial_count * 4 * sizeof(real) + (size_t)body->element_count * (12 + 4 * (size_t)p->nodes) +
           p->colours.stencil_capacity + p->colours.first_capacity + p->colours.used_capacity +
           p->colours.order_capacity + p->colours.dense_capacity;
}

void brunt_fem_potential_ask(brunt_fem_potential *p, brunt_trial_rule rule) { p->rule = rule; }

void brunt_fem_potential_step(brunt_fem_potential *p, double dt) { p->dt = (real)dt; }

static void run_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const fem_call *call = context;
    (void)worker;
    const fem_potential_kind *kind = call->p->kind;
    void (*const block)(const fem_call *, int32_t) = call->wanted == FEM_LIMIT     ? kind->limit
                                                     : call->wanted == FEM_PRODUCT ? kind->product
                                                                                   : kind->evaluate;
    for (int64_t b = begin; b < end; b++) block(call, (int32_t)b);
}

static void run_nodes(void *context, int64_t begin, int64_t end, int worker) {
    const fem_call *call = context;
    brunt_fem_potential *p = call->p;
    const int dim = p->dim;
    (void)worker;
    for (int64_t n = begin; n < end; n++)
        for (int i = 0; i < dim; i++) {
            const int64_t unknown = (p->base + n) * dim + i;
            const double moved = (double)(brunt_fem_node(p->body, (int32_t)n)[i] - p->body->start[n * 4 + i]);
            p->displacement[n * dim + i] = moved + (call->u ? call->u[unknown] : 0);
            if (call->way) p->way[n * dim + i] = call->way[unknown];
        }
}

static void add_gradient(void *context, int64_t begin, int64_t end, int worker) {
    const fem_call *call = context;
    const brunt_fem_potential *p = call->p;
    const brunt_fem_body *body = p->body;
    (void)worker;
    for (int64_t n = begin; n < end; n++)
        for (int32_t k = body->partial_first[n]; k < body->partial_first[n + 1]; k++)
            for (int i = 0; i < p->dim; i++)
                call->out[(p->base + n) * p->dim + i] += (double)p->force[(size_t)body->partial_of[k] * 4 + (size_t)i];
}

enum { NODE_GRAIN = 1024 };

static void run(fem_call *call, const brunt_team *team) {
    const brunt_fem_body *body = call->p->body;
    brunt_parallel(team->threads, body->node_count, NODE_GRAIN, run_nodes, call, team->timer);
    brunt_parallel(team->threads, body->block_count, 1, run_blocks, call, team->timer);
}

// --------------------------------------------------------------------------------- the term

static brunt_energy_sum energy(void *self, const brunt_team *team, const double *u) {
    brunt_fem_potential *p = self;
    fem_call call = {.p = p, .wanted = FEM_ENERGY, .u = u};
    run(&call, team);
    brunt_energy_sum sum = {.moduli = p->moduli};
    for (int32_t b = 0; b < p->body->block_count; b++)
        sum.value += p->energy[b].value, sum.magnitude += p->energy[b].magnitude;
    return sum;
}

static void gradient(void *self, const brunt_team *team, const double *u, double *g) {
    brunt_fem_potential *p = self;
    fem_call call = {.p = p, .wanted = FEM_GRADIENT, .u = u, .out = g};
    run(&call, team);
    brunt_parallel(team->threads, p->body->node_count, NODE_GRAIN, add_gradient, &call, team->timer);
}

static void fill(void *context, int64_t s, double *dense, int worker) {
    const brunt_fem_potential *p = context;
    (void)worker;
    p->kind->hessian(p, p->slot[s], dense);
}

static void hessian(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *h) {
    brunt_fem_potential *p = self;
    fem_call call = {.p = p, .wanted = FEM_TANGENT, .project = project, .u = u};
    run(&call, team);
    const brunt_stencils list = stencils(p);
    brunt_assemble(h, team, &list, &p->colours, fill, p);
}

static void linearise(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *blocks) {
    brunt_fem_potential *p = self;
    fem_call call = {.p = p, .wanted = FEM_TANGENT, .project = project, .u = u};
    run(&call, team);
    const brunt_stencils list = stencils(p);
    brunt_assemble_diagonal(blocks, team, &list, &p->colours, fill, p);
}

static void product(void *self, const brunt_team *team, const double *x, double *y) {
    brunt_fem_potential *p = self;
    fem_call call = {.p = p, .wanted = FEM_PRODUCT, .way = x + (int64_t)p->base * p->dim, .out = y};
    brunt_parallel(team->threads, p->body->block_count, 1, run_blocks, &call, team->timer);
    brunt_parallel(team->threads, p->body->node_count, NODE_GRAIN, add_gradient, &call, team->timer);
}

static double limit(void *self, const brunt_team *team, const double *u, const double *way, double largest) {
    brunt_fem_potential *p = self;
    fem_call call = {.p = p, .wanted = FEM_LIMIT, .u = u, .way = way, .largest = largest};
    if (!p->kind->limit) return largest;
    run(&call, team);
    for (int32_t b = 0; b < p->body->block_count; b++) largest = fmin(largest, p->limit[b]);
    return largest;
}

brunt_term brunt_fem_potential_term(brunt_fem_potential *p) {
    static const brunt_term_ops ops = {.name = "finite elements",
                                       .energy = energy,
                                       .gradient = gradient,
                                       .stencils = stencils,
                                       .hessian = hessian,
                                       .linearise = linearise,
                                       .product = product,
                                       .limit = limit};
    return (brunt_term){.ops = &ops, .self = p};
}

// --------------------------------------------------------------------------------- what stays

bool brunt_fem_hessian_stays(const brunt_fem_potential *p) {
    const brunt_material *material = &p->body->material;
    bool alone = true;
    for (int k = 0; k < BRUNT_COMPONENTS; k++) alone = alone && (k == BRUNT_STRENGTH || !material->model[k]);
    return alone && !strcmp(material->model[BRUNT_STRENGTH]->name, "linear-elastic") && !p->history && !p->modes &&
           !p->body->traits->membrane && brunt_element_is_simplex(p->body->kind) && !p->body->held;
}

void brunt_fem_hessian_rest(brunt_fem_potential *p, const brunt_team *team) {
    const real dt = p->dt;
    fem_call call = {.p = p, .wanted = FEM_TANGENT};
    p->dt = (real)INFINITY;
    memset(p->displacement, 0, (size_t)p->body->node_count * (size_t)p->dim * sizeof *p->displacement);
    brunt_parallel(team->threads, p->body->block_count, 1, run_blocks, &call, team->timer);
    p->dt = dt;
}

enum { ELEMENT = NODE_LIMIT * 3 }; // components

void brunt_fem_hessian_dense(const brunt_fem_potential *p, double *K) {
    const int size = p->nodes * p->dim, all = p->body->node_count * p->dim;
    for (int32_t s = 0; s < p->body->element_count; s++) {
        double dense[ELEMENT * ELEMENT] = {0};
        const int32_t *node = p->node + p->first[s];
        p->kind->hessian(p, p->slot[s], dense);
        for (int a = 0; a < size; a++)
            for (int b = 0; b < size; b++) {
                const int64_t row = (node[a / p->dim] - p->base) * p->dim + a % p->dim;
                K[row * all + (node[b / p->dim] - p->base) * p->dim + b % p->dim] += dense[a * size + b];
            }
    }
}

double brunt_fem_hessian_over(const brunt_fem_potential *p, const brunt_fem_potential *other) {
    static const double SAME = 1e-9; // of the greatest entry: places are rounded
    const int size = p->nodes * p->dim;
    double over = 0;
    if (p->body->element_count != other->body->element_count || p->body->node_count != other->body->node_count ||
        p->nodes != other->nodes || p->dim != other->dim)
        return 0;
    for (int32_t s = 0; s < p->body->element_count; s++) {
        double one[ELEMENT * ELEMENT] = {0}, two[ELEMENT * ELEMENT] = {0}, most = 0;
        for (int a = 0; a < p->nodes; a++)
            if (p->node[p->first[s] + a] - p->base != other->node[p->first[s] + a] - other->base) return 0;
        p->kind->hessian(p, p->slot[s], one), other->kind->hessian(other, other->slot[s], two);
        for (int e = 0; e < size * size; e++) most = fmax(most, fabs(two[e]));
        if (s == 0) over = one[0] / two[0];
        for (int e = 0; e < size * size; e++)
            if (!(fabs(one[e] - over * two[e]) <= SAME * over * most)) return 0;
    }
    return over;
}

// --------------------------------------------------------------------------------- commit

typedef struct fem_commit {
    brunt_fem_potential *p;
    const double *u, *v;
    brunt_fem_workspace *work;
} fem_commit;

static void move_nodes(void *context, int64_t begin, int64_t end, int worker) {
    const fem_commit *commit = context;
    const brunt_fem_potential *p = commit->p;
    (void)worker;
    for (int64_t n = begin; n < end; n++) {
        real *node = brunt_fem_node(p->body, (int32_t)n);
        for (int i = 0; i < p->dim; i++) {
            const int64_t unknown = (p->base + n) * p->dim + i;
            node[i] = (real)((double)node[i] + commit->u[unknown]);
            if (commit->v) node[BRUNT_FEM_V + i] = (real)commit->v[unknown];
        }
    }
}

static void commit_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const fem_commit *commit = context;
    for (int64_t b = begin; b < end; b++) commit->p->kind->commit(commit->p, (int32_t)b, &commit->work[worker]);
}

int brunt_fem_commit(brunt_fem_potential *p, const brunt_team *team, const double *u, const double *v,
                     brunt_fem_workspace *work, brunt_error *error) {
    brunt_fem_body *body = p->body;
    fem_commit moves = {p, u, v, work};
    fem_call call = {.p = p};
    brunt_parallel(team->threads, body->node_count, NODE_GRAIN, move_nodes, &moves, team->timer);
    brunt_parallel(team->threads, body->node_count, NODE_GRAIN, run_nodes, &call, team->timer);
    brunt_parallel(team->threads, body->block_count, 1, commit_blocks, &moves, team->timer);
    for (int32_t b = 0; b < body->block_count; b++) {
        const brunt_fem_report *report = &body->report[b];
        if (report->bad < 0) continue;
        const real *x = brunt_fem_node(body, body->element_node[(size_t)report->bad * (size_t)p->nodes]);
        return brunt_fail(error, BRUNT_FAILED, "body '%s': element %d at (%g, %g, %g) m: %s", body->name,
                          (int)body->element_id[report->bad], (double)x[0], (double)x[1], (double)x[2], report->reason);
    }
    return BRUNT_OK;
}
