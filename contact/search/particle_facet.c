// Material points that face the surfaces of meshes: each that is near looks for the facet it would pass, and becomes a
// contact point whose slave is the grid's velocity at its place.
//
// Friction acts at the particle's surface, not at its centre, half a spacing inside: where a pair has friction its
// points have levers (constraint.h), with the weights of the velocity extended affinely to there.
//
// The looking is done block by block, by any thread; the points are then made in the order of the blocks. Where a
// mirror plane is near, a node and its images have one velocity, turned over: they are one support, and what a point
// gives it is the sum of the weights of all of them, each turned over, since the image of the point presses too. A node
// on the plane moves along it only. Tangentially the body then gets all of the impulse; what is missing across the
// plane is what the mirror bears.
#include "contact/search/node_to_facet_parts.h"
#include "contact/distance/particle_extent.h"

#include "mpm/mpm_body.h"
#include "grid/bspline.h"
#include "mpm/particles.h"
#include "base/parallel.h"

enum { MAX_NODES = 64, IMAGE_LAYERS = 2 };

// Share of what the load of a step brings that a shallow depth may be pushed out against it. Particles that flow along
// a surface are a little behind it all the time: with all of it, as nodes have, a nose that is pushed through a plate
// gave the plate 5 % of its own energy out of nothing. What rests needs only what unfinished sweeps leave, and stays
// where it is with this.
static const double LIFT = 0.02;

typedef struct search_job {
    const brunt_contact_context *m;
    brunt_node_to_facet *f;
    brunt_body *body;
    int k; // of the bodies of material points
    int32_t box;
    brunt_constraint_set *constraints;
    brunt_symmetry_plane symmetry[BRUNT_MAX_PLANES]; // that act on the body
    int symmetry_count;
} search_job;

typedef struct nodes {
    int count;
    real *node[MAX_NODES];
    int32_t at[MAX_NODES][3];
    double weight[MAX_NODES];
} nodes;

// Nodes and weights under particle `s` of block `b`, or at an arm's length from it [m]; NULL: none.
static void particle_nodes(const brunt_body *body, int32_t b, int64_t s, const double *arm, nodes *out) {
    const brunt_grid *grid = &body->grid;
    const int dim = grid->dim, n = grid->order + 1;
    int local[3];
    int32_t base[3] = {0, 0, 0};
    double w[3][4] = {{1}, {1}, {1}}, slope[3][4] = {{0}};
    out->count = 0;
    brunt_node_local(grid, body->particles.bin[s], local);
    real *const *x = brunt_kernel_place(&body->particles);
    for (int a = 0; a < dim; a++) {
        base[a] = grid->blocks[b].coord[a] * grid->side + local[a];
        const double u = ((double)x[a][s] - grid->origin[a]) / (double)grid->h - base[a];
        brunt_bspline_weights(grid->order, u, w[a]);
        if (!arm) continue;
        brunt_bspline_levers(grid->order, u, w[a], slope[a]);
        for (int i = 0; i < n; i++) slope[a][i] *= arm[a] / (double)grid->h;
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            for (int l = 0; l < (dim == 3 ? n : 1); l++) {
                const int32_t at[3] = {base[0] + i, base[1] + k, base[2] + l};
                real *found = brunt_grid_node(grid, at);
                if (!found || !(found[BRUNT_NODE_MASS] > 0)) continue;
                memcpy(out->at[out->count], at, sizeof at);
                out->node[out->count] = found;
                double weight = w[0][i] * w[1][k] * w[2][l];
                if (arm)
                    weight += slope[0][i] * w[1][k] * w[2][l] + w[0][i] * slope[1][k] * w[2][l] +
                              w[0][i] * w[1][k] * slope[2][l];
                out->weight[out->count++] = weight;
            }
}

// ------------------------------------------------------------------------------------------ looking

// Keeps a hit that the particle would pass in this step. 0, or -1: out of memory.
static int add_particle_candidate(const search_job *j, particle_list *list, int32_t b, int64_t s, const double x[3],
                                  const facet_candidate *h) {
    const brunt_contact_surface *surface = j->m->surface;
    nodes under;
    double v[3] = {0}, old[3] = {0};
    particle_nodes(j->body, b, s, NULL, &under);
    for (int e = 0; e < under.count; e++)
        for (int a = 0; a < j->body->grid.dim; a++) {
            v[a] += under.weight[e] * (double)under.node[e][BRUNT_NODE_VELOCITY + a];
            old[a] += under.weight[e] * (double)under.node[e][BRUNT_NODE_OLD + a];
        }
    const double approach = brunt_node_to_facet_approach(surface, h, x, v, surface->v);
    const double before = brunt_node_to_facet_approach(surface, h, x, old, surface->old);
    const double target = brunt_node_to_facet_target(surface, h->gap, fmin(before, LIFT * approach), before, j->m->dt);
    if (!(approach < target + 1e-6 * surface->mean_edge / j->m->dt)) return 0;
    const size_t used = (size_t)list->count;
    if (BRUNT_RESERVE_IN(list->candidate, list->capacity, used + 1, used)) return -1;
    particle_candidate *found = &list->candidate[list->count++];
    *found = (particle_candidate){.block = b, .particle = s, .h = *h};
    memcpy(found->x, x, sizeof found->x);
    found->h.target = target;
    return 0;
}

// How far the ball of material about a particle reaches along n [m].
static double extent_along(brunt_body *body, int64_t s, const double n[3]) {
    const int dim = body->grid.dim, stride = body->particles.point_dim;
    real *const *F = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
    double square = 0;
    for (int c = 0; c < dim; c++) {
        double t = 0;
        for (int r = 0; r < dim; r++) t += (double)F[r * stride + c][s] * n[r];
        square += t * t;
    }
    return (double)brunt_field(&body->particles, BRUNT_FIELD_reach)[0][s] * sqrt(square);
}

static int search_from_block(const search_job *j, int32_t b, particle_list *list) {
    brunt_node_to_facet *f = j->f;
    const brunt_grid *grid = &j->body->grid;
    const int dim = grid->dim;
    double low[3] = {0}, high[3] = {0};
    for (int a = 0; a < dim; a++) {
        low[a] = grid->origin[a] + (double)grid->h * grid->blocks[b].coord[a] * grid->side;
        high[a] = low[a] + (double)grid->h * (grid->side + 1);
    }
    real *const *place = brunt_field(&j->body->particles, BRUNT_FIELD_position);
    if (brunt_total_lagrangian(&j->body->particles)) brunt_body_block_bounds(j->body, b, low, high);
    if (!brunt_broad_phase_in_reach(f, j->box, low, high, f->bodies.range)) return 0;
    for (int64_t s = grid->blocks[b].first; s < grid->blocks[b].first + grid->blocks[b].count; s++) {
        double x[3] = {0}, distance, second;
        for (int a = 0; a < dim; a++) x[a] = (double)place[a][s];
        candidate_list found;
        search_query l = {.box = j->box, .body = j->body->index, .x = x};
        if (!brunt_candidates_bodies(f, &l)) continue;
        brunt_candidates_find(j->m, f, &l, -1, &found, &distance, &second);
        for (int32_t q = 0; q < found.count; q++) {
            found.candidate[q].gap -= extent_along(j->body, s, found.candidate[q].n);
            if (found.candidate[q].gap <= f->bodies.travel &&
                add_particle_candidate(j, list, b, s, x, &found.candidate[q]))
                return -1;
        }
    }
    return 0;
}

static void search_from_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const search_job *j = context;
    particle_list *list = &j->f->particles.list[worker];
    for (int64_t b = begin; b < end; b++) {
        j->f->particles.run[b] = (particle_run){.worker = worker, .first = list->count};
        if (search_from_block(j, (int32_t)b, list)) list->failed = true;
        j->f->particles.run[b].count = list->count - j->f->particles.run[b].first;
    }
}

// ------------------------------------------------------------------------------------------ constraints

// The mirrors that act on a body.
static int symmetry_of(const brunt_contact_context *m, const brunt_body *body,
                       brunt_symmetry_plane out[BRUNT_MAX_PLANES]) {
    int count = 0;
    for (int k = 0; k < m->mirror_count && count < BRUNT_MAX_PLANES; k++) {
        int on = m->mirrors[k].wall < 0 ? -1 : m->walls[m->mirrors[k].wall].body;
        if (on < 0 || on == body->index) out[count++] = m->mirrors[k];
    }
    return count;
}

// Makes the degree-of-freedom node of a grid node and of its images. 0, or -1: out of memory.
static int make_dof_node(const search_job *j, const int32_t at[3]) {
    brunt_node_to_facet *f = j->f;
    const brunt_grid *grid = &j->body->grid;
    int32_t image[BRUNT_MAX_IMAGES][3];
    real sign[BRUNT_MAX_IMAGES][3];
    int images = brunt_symmetry_images(j->symmetry, j->symmetry_count, at, IMAGE_LAYERS, image, sign);
    int32_t dof_node = brunt_constraints_dof_node(j->constraints);
    if (dof_node < 0) return -1;
    for (int i = 0; i < images; i++) {
        real *node = brunt_grid_node(grid, image[i]);
        if (!node || !(node[BRUNT_NODE_MASS] > 0)) continue;
        int64_t number = (node - grid->nodes) / BRUNT_NODE_REALS;
        if (BRUNT_GROW(f->particles.grid)) return -1;
        grid_dof *entry = &f->particles.grid[f->particles.grid_count];
        *entry = (grid_dof){.mpm = j->k, .node = number, .dof_node = dof_node};
        for (int a = 0; a < 3; a++) entry->sign[a] = (double)sign[i][a];
        f->particles.node_dof[j->k][number] = ++f->particles.grid_count;
        brunt_dof_node *dof = &j->constraints->dof_node[dof_node];
        for (int a = 0; a < grid->dim && i == 0; a++) {
            dof->v[a] = (double)node[BRUNT_NODE_VELOCITY + a];
            dof->old[a] = (double)node[BRUNT_NODE_OLD + a];
            dof->inverse[a] =
                sign[0][a] != 0 && !brunt_node_held(grid, number, a) ? 1 / (double)node[BRUNT_NODE_MASS] : 0;
        }
    }
    return 0;
}

// The degree-of-freedom node of node `e` under a particle, which there is.
static const grid_dof *dof_under(const search_job *j, const nodes *under, int e) {
    const int64_t number = (under->node[e] - j->body->grid.nodes) / BRUNT_NODE_REALS;
    return &j->f->particles.grid[j->f->particles.node_dof[j->k][number] - 1];
}

// Entries of the slave: of each degree-of-freedom node the weights of all its nodes, turned over as they are.
static int add_slave(const search_job *j, const nodes *under) {
    brunt_constraint_set *set = j->constraints;
    const int32_t first = set->entry_count;
    for (int e = 0; e < under->count; e++) {
        const int64_t number = (under->node[e] - j->body->grid.nodes) / BRUNT_NODE_REALS;
        if (!j->f->particles.node_dof[j->k][number] && make_dof_node(j, under->at[e])) return -1;
        const grid_dof *g = dof_under(j, under, e);
        int32_t entry = j->symmetry_count ? first : set->entry_count; // without images each node has its own
        while (entry < set->entry_count && set->entry[entry].dof_node != g->dof_node) entry++;
        if (entry == set->entry_count && brunt_constraints_entry(set, g->dof_node, 0) < 0) return -1;
        for (int a = 0; a < 3; a++) set->entry[entry].weight[a] += under->weight[e] * g->sign[a];
    }
    return 0;
}

// What the last constraint rubs with: the same degree-of-freedom nodes, at the particle's surface.
static int add_friction_point(const search_job *j, const particle_candidate *found) {
    brunt_constraint_set *set = j->constraints;
    const int32_t number = set->constraint_count - 1;
    double arm[3], kernel_arm[3], x[3];
    const double extent = brunt_extent_along(j->body, found->particle, found->h.n);
    brunt_extent_arm(j->body, found->particle, found->h.n, extent + found->h.gap, arm, kernel_arm);
    for (int a = 0; a < 3; a++) x[a] = found->x[a] + arm[a];
    const int32_t first = brunt_constraints_friction_point(set, x);
    if (first < 0) return -1;
    brunt_constraint *constraint = &set->constraint[number];
    nodes under;
    particle_nodes(j->body, found->block, found->particle, kernel_arm, &under);
    for (int e = 0; e < under.count; e++) {
        const grid_dof *g = dof_under(j, &under, e);
        int32_t entry = first;
        while (set->entry[entry].dof_node != g->dof_node) entry++;
        for (int a = 0; a < 3; a++) set->entry[entry].weight[a] += under.weight[e] * g->sign[a];
    }
    brunt_master master;
    brunt_node_to_facet_master(j->m->surface, &found->h, x, &master);
    brunt_node_to_facet_entries(j->f, &master, constraint, &set->entry[first + constraint->count - master.count]);
    return 0;
}

static int add_particle_constraint(const search_job *j, const particle_candidate *found) {
    const brunt_contact_surface *surface = j->m->surface;
    const brunt_body *body = j->body;
    brunt_constraint_set *set = j->constraints;
    brunt_master master;
    nodes under;
    particle_nodes(body, found->block, found->particle, NULL, &under);
    brunt_node_to_facet_master(surface, &found->h, found->x, &master);
    for (int c = 0; c < master.count; c++)
        if (brunt_node_to_facet_dof_node(j->f, surface, master.node[c], set) < 0) return -1;
    int32_t at = brunt_constraints_add(set);
    if (at < 0) return -1;
    brunt_node_to_facet_constraint(j->m, &found->h, found->x, body->index, &set->constraint[at]);
    set->constraint[at].target = found->h.target, set->constraint[at].tag = -1 - j->k;
    set->constraint[at].area = body->spacing * (body->grid.dim == 3     ? body->spacing
                                                : surface->axisymmetric ? 2 * M_PI * found->x[0]
                                                                        : 1);
    if (add_slave(j, &under)) return -1;
    const int32_t first = set->entry_count;
    for (int c = 0; c < master.count; c++)
        if (brunt_constraints_entry(set, j->f->nodes.dof_of[master.node[c]], 0) < 0) return -1;
    brunt_node_to_facet_entries(j->f, &master, &set->constraint[at], set->entry + first);
    return set->constraint[at].friction > 0 ? add_friction_point(j, found) : 0;
}

static int reserve_particles(brunt_node_to_facet *f, const brunt_body *body, int k, int threads) {
    const size_t count = (size_t)body->grid.slot_count * BRUNT_BLOCK_NODES;
    if (BRUNT_RESERVE_IN(f->particles.node_dof[k], f->particles.node_dof_capacity[k], count, 0) ||
        RESERVE(&f->particles, run, body->grid.block_count + 1))
        return -1;
    memset(f->particles.node_dof[k], 0, count * sizeof *f->particles.node_dof[k]);
    if (!f->particles.list) {
        if (!(f->particles.list = brunt_alloc((size_t)threads * sizeof *f->particles.list))) return -1;
        f->particles.list_count = threads;
    }
    for (int t = 0; t < f->particles.list_count; t++)
        f->particles.list[t].count = 0, f->particles.list[t].failed = false;
    return 0;
}

int brunt_node_to_facet_particles(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_body *body, int k,
                                  int32_t box, brunt_constraint_set *constraints) {
    search_job j = {.m = m, .f = f, .body = body, .k = k, .box = box, .constraints = constraints};
    if (reserve_particles(f, body, k, m->threads)) return -1;
    brunt_parallel(m->threads, body->grid.block_count, 1, search_from_blocks, &j, m->timer);
    for (int t = 0; t < f->particles.list_count; t++)
        if (f->particles.list[t].failed) return -1;
    j.symmetry_count = symmetry_of(m, body, j.symmetry);
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        const particle_run *run = &f->particles.run[b];
        const particle_candidate *found = f->particles.list[run->worker].candidate;
        for (int32_t i = run->first; i < run->first + run->count; i++)
            if (add_particle_constraint(&j, &found[i])) return -1;
    }
    return 0;
}

// ------------------------------------------------------------------------------------------ the way back

static void add_moment(const double x[3], const double P[3], double factor, double linear[3], double angular[3]) {
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        linear[a] += factor * P[a];
        angular[a] += factor * (x[b] * P[c] - x[c] * P[b]);
    }
}

// What the body's own share of the nodes has got, less what the points gave it, is the mirrors'.
static void account_symmetry(const brunt_contact_context *m, const brunt_body *body, int k, double linear[3],
                             double angular[3], const brunt_constraint_set *constraints) {
    brunt_symmetry_plane mirrors[BRUNT_MAX_PLANES];
    const int count = symmetry_of(m, body, mirrors);
    for (int32_t p = 0; p < constraints->constraint_count; p++) {
        const brunt_constraint *constraint = &constraints->constraint[p];
        double normal_impulse[3];
        if (constraint->tag != -1 - k || !(constraint->normal_impulse > 0)) continue;
        for (int a = 0; a < 3; a++) normal_impulse[a] = constraint->normal_impulse * constraint->n[a];
        add_moment(constraint->x, normal_impulse, -1, linear, angular);
        add_moment(constraint->friction_point ? constraints->friction_point[constraint->friction_point - 1].x
                                              : constraint->x,
                   constraint->friction_impulse, -1, linear, angular);
    }
    for (int a = 0; a < 3; a++) {
        int i = 0;
        while (i < count && mirrors[i].axis != a) i++;
        if (i < count && mirrors[i].wall >= 0) m->walls[mirrors[i].wall].last.impulse[a] += linear[a];
        if (mirrors[0].wall >= 0) m->walls[mirrors[0].wall].last.angular[a] += angular[a];
    }
}

void brunt_node_to_facet_scatter_grids(const brunt_contact_context *m, brunt_body *mpm, brunt_node_to_facet *f,
                                       const brunt_constraint_set *constraints) {
    for (int32_t g = 0; g < f->particles.grid_count;) {
        const int k = f->particles.grid[g].mpm;
        brunt_body *body = &mpm[k];
        const brunt_grid *grid = &body->grid;
        double linear[3] = {0}, angular[3] = {0};
        brunt_symmetry_plane mirrors[BRUNT_MAX_PLANES];
        const bool mirrored = symmetry_of(m, body, mirrors) > 0;
        for (; g < f->particles.grid_count && f->particles.grid[g].mpm == k; g++) {
            const grid_dof *entry = &f->particles.grid[g];
            real *node = grid->nodes + entry->node * BRUNT_NODE_REALS;
            double P[3] = {0}, x[3];
            for (int a = 0; a < grid->dim; a++) {
                const brunt_dof_node *dof_node = &constraints->dof_node[entry->dof_node];
                double v = entry->sign[a] * dof_node->v[a];
                if (brunt_node_held(grid, entry->node, a)) // the condition takes it again, and books it
                    v += entry->sign[a] * dof_node->impulse[a] / (double)node[BRUNT_NODE_MASS];
                P[a] = (double)node[BRUNT_NODE_SPARE] * (v - (double)node[BRUNT_NODE_VELOCITY + a]);
                node[BRUNT_NODE_VELOCITY + a] = (real)v;
            }
            if (!mirrored) continue;
            brunt_node_position(grid, grid->slots[entry->node / BRUNT_BLOCK_NODES].coord,
                                (int)(entry->node % BRUNT_BLOCK_NODES), x);
            add_moment(x, P, 1, linear, angular);
        }
        if (mirrored) account_symmetry(m, body, k, linear, angular, constraints);
    }
}
