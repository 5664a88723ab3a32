// From the places of contacts to the nodes that move them.
#include "contact/barrier/barrier_parts.h"

void barrier_add_gradient(const brunt_barrier *b, const barrier_contact *c, const double *local, double *g) {
    for (int i = 0; i < c->at.places; i++) {
        const int32_t *node;
        const double *weight;
        const int64_t count = barrier_nodes(b, c->place[i], &node, &weight);
        for (int64_t j = 0; j < count; j++)
            for (int k = 0; k < b->dim; k++) g[(int64_t)node[j] * b->dim + k] += weight[j] * local[i * b->dim + k];
    }
}

int barrier_make_sets(const brunt_barrier *b, const barrier_contacts *contacts, barrier_sets *sets,
                      brunt_error *error) {
    const int32_t *node;
    const double *weight;
    if (BRUNT_CAPACITY(sets->first, (size_t)contacts->count + 1, 0, "places of contact", error)) return BRUNT_FAILED;
    sets->count = contacts->count, sets->first[0] = 0;
    for (int64_t s = 0; s < contacts->count; s++) {
        const barrier_contact *c = &contacts->contact[s];
        int64_t nodes = 0;
        for (int i = 0; i < c->at.places; i++) nodes += barrier_nodes(b, c->place[i], &node, &weight);
        sets->first[s + 1] = sets->first[s] + nodes;
    }
    if (BRUNT_CAPACITY(sets->node, (size_t)sets->first[sets->count] + 1, 0, "nodes of places of contact", error))
        return BRUNT_FAILED;
    for (int64_t s = 0; s < contacts->count; s++) {
        const barrier_contact *c = &contacts->contact[s];
        int32_t *to = sets->node + sets->first[s];
        for (int i = 0; i < c->at.places; i++) {
            const int64_t nodes = barrier_nodes(b, c->place[i], &node, &weight);
            memcpy(to, node, (size_t)nodes * sizeof *to);
            to += nodes;
        }
    }
    return BRUNT_OK;
}

typedef struct fill_work {
    const brunt_barrier *b;
    const barrier_contacts *contacts;
    const double *u;
    bool project, friction;
} fill_work;

// A block of two places, spread over their nodes by the weights.
static void spread(const fill_work *w, const barrier_contact *c, const double *local, int64_t total, double *dense) {
    const brunt_barrier *b = w->b;
    const int dim = b->dim, rows = c->at.places * dim;
    int64_t row = 0;
    for (int i = 0; i < c->at.places; i++) {
        const int32_t *node;
        const double *wi, *wj;
        const int64_t ni = barrier_nodes(b, c->place[i], &node, &wi);
        int64_t column = 0;
        for (int j = 0; j < c->at.places; j++) {
            const int64_t nj = barrier_nodes(b, c->place[j], &node, &wj);
            for (int64_t p = 0; p < ni * dim; p++)
                for (int64_t q = 0; q < nj * dim; q++)
                    dense[(row * dim + p) * total * dim + column * dim + q] +=
                        wi[p / dim] * wj[q / dim] * local[(i * dim + p % dim) * rows + j * dim + q % dim];
            column += nj;
        }
        row += ni;
    }
}

static void fill_contact(void *context, int64_t s, double *dense, int worker) {
    const fill_work *w = context;
    const barrier_contact *c = &w->contacts->contact[s];
    double local[BARRIER_DOFS * BARRIER_DOFS];
    int64_t total = 0;
    (void)worker;
    for (int i = 0; i < c->at.places; i++) {
        const int32_t *node;
        const double *weight;
        total += barrier_nodes(w->b, c->place[i], &node, &weight);
    }
    if (w->friction && w->b->from)
        barrier_cone_hessian(w->b, c, w->b->felt[s].part, w->u, local);
    else if (w->friction && w->b->live)
        barrier_slip_tangent(w->b, c, w->b->felt[s].part, w->u, local);
    else if (w->friction)
        barrier_slip_hessian(w->b, c, &w->b->rub[s], w->u, local);
    else if (w->b->touch > 0)
        barrier_join_hessian(w->b, c, local);
    else
        barrier_contact_hessian(w->b, c, w->project, local);
    spread(w, c, local, total, dense);
}

int barrier_add_hessian(const barrier_assembly *a, const brunt_team *team, const double *u, bool project,
                        brunt_block_matrix *m, brunt_error *error) {
    fill_work work = {a->b, a->contacts, u, project, a->friction};
    const brunt_stencils sets = {.count = a->sets->count, .first = a->sets->first, .node = a->sets->node};
    if (brunt_colours_make(a->colours, team, a->b->dim, m->nodes, &sets, error)) return BRUNT_FAILED;
    brunt_assemble(m, team, &sets, a->colours, fill_contact, &work);
    return BRUNT_OK;
}
