// Material points that face the surfaces of meshes: each that is near looks for the facet it would pass, and becomes a
// contact point whose slave is the grid's velocity at its place.
//
// The looking is done block by block, by any thread; the constraints are then made in the order of the blocks, on the
// degrees of freedom of particle_dof.h.
#include "contact/search/node_to_facet_parts.h"
#include "contact/distance/particle_extent.h"

#include "contact/search/overlap_spring.h"
#include "contact/search/particle_dof.h"
#include "mpm/mpm_body.h"
#include "mpm/particles.h"
#include "base/parallel.h"

// Share of what the load of a step brings that a shallow depth may be pushed out against it. Particles that flow along
// a surface are a little behind it all the time: with all of it, as nodes have, a nose that is pushed through a plate
// gave the plate 5 % of its own energy out of nothing. What rests needs only what unfinished sweeps leave, and stays
// where it is with this.
static const double LIFT = 0.02;

typedef struct search_job {
    const brunt_contact_context *m;
    brunt_node_to_facet *f;
    brunt_body *body;
    int32_t box;
    brunt_constraint_set *constraints;
    brunt_particle_dofs *dofs;
} search_job;

// ------------------------------------------------------------------------------------------ looking

// Keeps a hit that the particle would pass in this step.
static int add_particle_candidate(const search_job *j, particle_list *list, int32_t b, int64_t s, const double x[3],
                                  const facet_candidate *h, brunt_error *error) {
    const brunt_contact_surface *surface = j->m->surface;
    double v[3], old[3], before = 0; // what it came with only matters to what is behind the surface
    brunt_particle_velocity(j->body, b, s, BRUNT_NODE_VELOCITY, v);
    brunt_corners under;
    brunt_node_to_facet_corners(surface, h, x, &under);
    const double approach = brunt_node_to_facet_approach(&under, h->n, v, surface->v);
    const double spring = brunt_overlap_spring(j->m, j->body, s);
    const double gap = h->gap + (spring > 0 ? brunt_overlap_limit(j->body, brunt_extent_along(j->body, s, h->n)) : 0);
    if (gap < 0) {
        brunt_particle_velocity(j->body, b, s, BRUNT_NODE_OLD, old);
        before = brunt_node_to_facet_approach(&under, h->n, old, surface->old);
    }
    const double target = brunt_node_to_facet_target(surface, gap, fmin(before, LIFT * approach), before, j->m->dt);
    if (!(spring > 0 && h->gap < 0) && !(approach < target + 1e-6 * surface->mean_edge / j->m->dt)) return BRUNT_OK;
    const size_t used = (size_t)list->count;
    if (BRUNT_CAPACITY_IN(list->candidate, list->capacity, used + 1, used, "facets near particles", error))
        return BRUNT_FAILED;
    particle_candidate *found = &list->candidate[list->count++];
    *found = (particle_candidate){.block = b, .particle = s, .h = *h};
    memcpy(found->x, x, sizeof found->x);
    found->h.target = target;
    return BRUNT_OK;
}

static int search_from_block(const search_job *j, int32_t b, particle_list *list, brunt_error *error) {
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
    if (!brunt_broad_phase_in_range(f, j->box, low, high, f->bodies.range)) return BRUNT_OK;
    int32_t guess = -1; // what the last one met may well be the nearest of the next, too
    for (int64_t s = grid->blocks[b].first; s < grid->blocks[b].first + grid->blocks[b].count; s++) {
        double x[3] = {0};
        for (int a = 0; a < dim; a++) x[a] = (double)place[a][s];
        candidate_list found;
        search_query l = {.box = j->box, .body = j->body->index, .x = x, .particle = true};
        if (!brunt_candidates_bodies(f, &l)) continue;
        // Of several bodies the order in which they are found is that of the cell's facets.
        brunt_candidates_find(j->m, f, &l, l.touches == 1 ? guess : -1, &found);
        if (found.count) guess = brunt_candidates_front(j->m->surface, found.candidate[0].face);
        for (int32_t q = 0; q < found.count; q++) {
            found.candidate[q].gap -= brunt_extent_along(j->body, s, found.candidate[q].n);
            if (found.candidate[q].gap <= f->bodies.travel &&
                add_particle_candidate(j, list, b, s, x, &found.candidate[q], error))
                return BRUNT_FAILED;
        }
    }
    return BRUNT_OK;
}

static void search_from_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const search_job *j = context;
    particle_list *list = &j->f->particles.list[worker];
    for (int64_t b = begin; b < end; b++) {
        j->f->particles.run[b] = (particle_run){.worker = worker, .first = list->count};
        search_from_block(j, (int32_t)b, list, &list->error);
        j->f->particles.run[b].count = list->count - j->f->particles.run[b].first;
    }
}

// ------------------------------------------------------------------------------------------ constraints

// What the last constraint rubs with: the same degree-of-freedom nodes, at the particle's surface.
static int add_friction_point(const search_job *j, const particle_candidate *found, brunt_error *error) {
    brunt_constraint_set *set = j->constraints;
    const int32_t number = set->constraint_count - 1;
    double arm[3], kernel_arm[3], x[3];
    const double extent = brunt_extent_along(j->body, found->particle, found->h.n);
    brunt_extent_arm(j->body, found->particle, found->h.n, extent + found->h.gap, arm, kernel_arm);
    for (int a = 0; a < 3; a++) x[a] = found->x[a] + arm[a];
    brunt_particle_nodes at_arm;
    brunt_particle_nodes_find(j->body, found->block, found->particle, kernel_arm, &at_arm);
    const int32_t first = brunt_particle_dofs_friction_point(j->body, &at_arm, x, j->dofs, set, error);
    if (first < 0) return BRUNT_FAILED;
    brunt_constraint *constraint = &set->constraint[number];
    brunt_master master;
    brunt_node_to_facet_master(j->m->surface, &found->h, x, &master);
    brunt_node_to_facet_entries(j->f, &master, constraint, &set->entry[first + constraint->count - master.count]);
    return BRUNT_OK;
}

static int add_particle_constraint(const search_job *j, const particle_candidate *found, brunt_error *error) {
    const brunt_contact_surface *surface = j->m->surface;
    const brunt_body *body = j->body;
    brunt_constraint_set *set = j->constraints;
    brunt_master master;
    brunt_particle_nodes under;
    brunt_particle_nodes_find(body, found->block, found->particle, NULL, &under);
    brunt_node_to_facet_master(surface, &found->h, found->x, &master);
    for (int c = 0; c < master.count; c++)
        if (brunt_node_to_facet_dof_node(j->f, surface, master.node[c], set, error) < 0) return BRUNT_FAILED;
    int32_t at = brunt_constraints_add(set, error);
    if (at < 0) return BRUNT_FAILED;
    brunt_node_to_facet_constraint(j->m, &found->h, found->x, body->index, &set->constraint[at]);
    set->constraint[at].spring = brunt_overlap_spring(j->m, j->body, found->particle);
    set->constraint[at].target = found->h.target, set->constraint[at].tag = j->dofs->tag;
    set->constraint[at].area = body->spacing * (body->grid.dim == 3     ? body->spacing
                                                : surface->axisymmetric ? 2 * M_PI * found->x[0]
                                                                        : 1);
    if (brunt_particle_dofs_enter(body, &under, 1, j->dofs, set, error)) return BRUNT_FAILED;
    const int32_t first = set->entry_count;
    for (int c = 0; c < master.count; c++)
        if (brunt_constraints_entry(set, j->f->nodes.dof_of[master.node[c]], 0, error) < 0) return BRUNT_FAILED;
    brunt_node_to_facet_entries(j->f, &master, &set->constraint[at], set->entry + first);
    return set->constraint[at].friction > 0 ? add_friction_point(j, found, error) : BRUNT_OK;
}

static int reserve_particles(brunt_node_to_facet *f, const brunt_body *body, int threads, brunt_error *error) {
    if (RESERVE(&f->particles, run, body->grid.block_count + 1, "blocks of particles near facets", error))
        return BRUNT_FAILED;
    if (!f->particles.list) {
        if (BRUNT_NEW(f->particles.list, threads, "threads that look from particles", error)) return BRUNT_FAILED;
        f->particles.list_count = threads;
    }
    for (int t = 0; t < f->particles.list_count; t++)
        f->particles.list[t].count = 0, f->particles.list[t].error.code = BRUNT_OK;
    return BRUNT_OK;
}

int brunt_node_to_facet_particles(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_body *body, int k,
                                  int32_t box, brunt_constraint_set *constraints, brunt_error *error) {
    brunt_particle_dofs *dofs = &f->particles.dofs[k];
    search_job j = {.m = m, .f = f, .body = body, .box = box, .constraints = constraints, .dofs = dofs};
    if (reserve_particles(f, body, m->threads, error) || brunt_particle_dofs_begin(m, body, dofs, error))
        return BRUNT_FAILED;
    dofs->tag = -1 - k;
    brunt_parallel(m->threads, body->grid.block_count, 1, search_from_blocks, &j, m->timer);
    for (int t = 0; t < f->particles.list_count; t++)
        if (brunt_hand_on(error, &f->particles.list[t].error)) return BRUNT_FAILED;
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        const particle_run *run = &f->particles.run[b];
        const particle_candidate *found = f->particles.list[run->worker].candidate;
        for (int32_t i = run->first; i < run->first + run->count; i++)
            if (add_particle_constraint(&j, &found[i], error)) return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

void brunt_node_to_facet_scatter_grids(const brunt_contact_context *m, brunt_body *mpm, brunt_node_to_facet *f,
                                       const brunt_constraint_set *constraints) {
    for (int k = 0; k < f->particles.mpm_count; k++)
        if (f->particles.dofs[k].dof_count) brunt_particle_dofs_scatter(m, &mpm[k], &f->particles.dofs[k], constraints);
}
