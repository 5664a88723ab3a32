// Crowds whose inner nodes leave the systems of load steps: those of linear elasticity, which share a mesh.
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "scheme/implicit.h"

enum { MESHES = 8, LEAST_BODIES = 8, MOST = 1024 }; // that are looked for; that are to share one; components of a mesh

// Whether systems of the world may leave out nodes at all.
static bool may_condense(const struct brunt_implicit *m) {
    const brunt_world *world = m->world;
    return m->still && m->contact.barrier && !m->holds && !m->forces && m->options.solver == &brunt_linear_direct &&
           !world->boundaries.damping.active;
}

// Nodes that contact may reach; how many.
static int mark_rim(const struct brunt_implicit *m, const brunt_fem_body *fem, int32_t base, uint8_t *on_rim) {
    const brunt_implicit_contact *c = &m->contact;
    int count = 0;
    memset(on_rim, 0, MOST);
    for (int32_t v = 0; v < c->vertex_count; v++)
        if (c->body[v] == fem->index) count += !on_rim[c->node[v] - base], on_rim[c->node[v] - base] = 1;
    return count;
}

typedef struct family {
    int first, members; // a body of elements
    uint8_t on_rim[MOST];
} family;

// Which family each body is of, -1: none; how many there are.
static int find_families(struct brunt_implicit *m, family *families, int *of, double *over) {
    int count = 0, base = 0;
    for (int k = 0; k < m->world->bodies.fem_count; base += m->world->bodies.fem[k++].node_count) {
        const brunt_fem_body *fem = &m->world->bodies.fem[k];
        uint8_t on_rim[MOST];
        of[k] = -1;
        if (fem->node_count * m->unknowns.dim > MOST || !brunt_fem_hessian_stays(m->fem[k])) continue;
        if (mark_rim(m, fem, base, on_rim) <= m->unknowns.dim) continue;
        brunt_fem_hessian_rest(m->fem[k], &m->team);
        for (int q = 0; q < count && of[k] < 0; q++) {
            over[k] = brunt_fem_hessian_over(m->fem[k], m->fem[families[q].first]);
            if (over[k] > 0 && !memcmp(on_rim, families[q].on_rim, MOST)) of[k] = q, families[q].members++;
        }
        if (of[k] >= 0 || count == MESHES) continue;
        of[k] = count, over[k] = 1, families[count] = (family){.first = k, .members = 1};
        memcpy(families[count++].on_rim, on_rim, MOST);
    }
    return count;
}

static int make_mesh(struct brunt_implicit *m, const family *f, brunt_condensed_mesh *mesh, brunt_error *error) {
    const int dim = m->unknowns.dim;
    const size_t nodes = (size_t)m->world->bodies.fem[f->first].node_count, all = nodes * (size_t)dim;
    double *K, x[MOST];
    if (BRUNT_NEW(K, all * all, "the Hessian of a body", error)) return BRUNT_FAILED;
    brunt_fem_hessian_dense(m->fem[f->first], K);
    for (size_t k = 0; k < all; k++)
        x[k] = (double)m->world->bodies.fem[f->first].start[k / (size_t)dim * 4 + k % (size_t)dim];
    const int status = brunt_condensed_mesh_make(mesh, dim, (int)nodes, K, x, f->on_rim, error);
    brunt_free(K);
    return status;
}

int brunt_implicit_condense(struct brunt_implicit *m, brunt_error *error) {
    const int bodies = m->world->bodies.fem_count;
    brunt_condensation *c = &m->condensation;
    family *families = NULL;
    double *over = NULL;
    int *of = NULL, base = 0;
    if (!may_condense(m)) return BRUNT_OK;
    int status = BRUNT_NEW(families, MESHES, "families of bodies", error) ||
                 BRUNT_NEW(over, bodies + 1, "families of bodies", error) ||
                 BRUNT_NEW(of, bodies + 1, "families of bodies", error) ||
                 BRUNT_NEW(m->condensed_mesh, MESHES, "meshes of crowds", error) ||
                 BRUNT_NEW(c->body, bodies + 1, "bodies of crowds", error);
    const int count = status ? 0 : find_families(m, families, of, over);
    for (int q = 0; !status && q < count; q++)
        if (families[q].members >= LEAST_BODIES) status = make_mesh(m, &families[q], &m->condensed_mesh[q], error);
    for (int k = 0; !status && k < bodies; base += m->world->bodies.fem[k++].node_count)
        if (of[k] >= 0 && m->condensed_mesh[of[k]].nodes)
            c->body[c->count++] =
                (brunt_condensed_body){.mesh = &m->condensed_mesh[of[k]], .base = base, .scale = over[k]};
    if (!status && c->count) status = brunt_condensation_make(c, base, m->term_count, error);
    for (int k = 0; !status && c->count && k < bodies; k++)
        c->left_out[m->fixed_terms + k] = of[k] >= 0 && m->condensed_mesh[of[k]].nodes;
    brunt_free(families), brunt_free(over), brunt_free(of);
    return status ? BRUNT_FAILED : BRUNT_OK;
}

void brunt_implicit_condense_free(struct brunt_implicit *m) {
    brunt_condensation_free(&m->condensation);
    for (int q = 0; m->condensed_mesh && q < MESHES; q++) brunt_condensed_mesh_free(&m->condensed_mesh[q]);
    brunt_free(m->condensed_mesh);
}
