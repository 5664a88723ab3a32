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
#include "base/simd.h"

// Share of what the load of a step brings that a shallow depth may be pushed out against it. Particles that flow along
// a surface are a little behind it all the time: with all of it, as nodes have, a nose that is pushed through a plate
// gave the plate 5 % of its own energy out of nothing. What rests needs only what unfinished sweeps leave, and stays
// where it is with this.
static const double LIFT = 0.02;

static const double ROUNDED = 0.01; // cells: how far off its bin a particle may be by rounding

enum { TOGETHER = 64, AHEAD = 4 }; // particles that are looked at together; those whose facets are fetched meanwhile

typedef struct search_job {
    const brunt_contact_context *m;
    brunt_node_to_facet *f;
    brunt_body *body;
    int32_t box;
    brunt_constraint_set *constraints;
    brunt_particle_dofs *dofs;
    double zone[2][3]; // [m] low, high of that about all bodies near the box: what is not in it is near none ...
    bool alone;        // ... and what is in it is near the only one, `other`
    int32_t other;
} search_job;

// ------------------------------------------------------------------------------------------ looking

// Particles in the zone about the bodies that are near, and the cells of facets that they are in.
typedef struct near_particles {
    int32_t count;
    int64_t slot[TOGETHER], cell[TOGETHER];
} near_particles;

// A block that looks: which of its particles, where what they find goes, and bounds of their velocities, once they were
// asked for.
typedef struct looking_block {
    const search_job *j;
    int32_t b;
    particle_list *list;
    search_query query;
    int32_t from[3], end[3]; // bins along each axis that reach into the zone
    near_particles near;
    bool bounded;
    double low[3], high[3]; // [m/s]
} looking_block;

// Whether no velocity that particles of the block can have closes a gap within the step, clearly: so it is with most
// that are near, whose own velocity then need not be known. What is over the inside of a facet, or along an edge, is
// over a mean of the velocities of its nodes.
static bool stays_open(looking_block *of, const facet_candidate *h, double target) {
    const brunt_contact_surface *surface = of->j->m->surface;
    if (h->feature.any ? h->feature.triangles != 0 : !h->inside) return false;
    const int32_t *node = h->feature.any ? h->feature.end : surface->face[h->face];
    const int count = h->feature.any ? 2 : brunt_face_corners(node);
    if (!of->bounded) {
        const brunt_node_range nodes = {.block = of->b, .from = of->from, .end = of->end};
        brunt_particle_velocity_bounds(of->j->body, &nodes, BRUNT_NODE_VELOCITY, of->low, of->high);
        of->bounded = true;
    }
    double least = 0, size = 0, fastest = dot(surface->v[node[0]], h->n);
    for (int c = 1; c < count; c++) {
        const double v = dot(surface->v[node[c]], h->n);
        fastest = v > fastest ? v : fastest;
    }
    for (int a = 0; a < 3; a++) {
        least += h->n[a] * (h->n[a] > 0 ? of->low[a] : of->high[a]);
        size += of->high[a] - of->low[a]; // which include 0
    }
    return least - fastest - 1e-9 * (size + fabs(fastest)) > target + 1e-6 * surface->mean_edge / of->j->m->dt;
}

// Keeps a hit that the particle would pass in this step.
static int add_particle_candidate(looking_block *of, int64_t s, const double x[3], const facet_candidate *h) {
    const search_job *j = of->j;
    const brunt_contact_surface *surface = j->m->surface;
    double v[3], old[3], before = 0; // what it came with only matters to what is behind the surface
    const double spring = brunt_overlap_spring(j->m, j->body, s);
    const double gap = h->gap + (spring > 0 ? brunt_overlap_limit(j->body, brunt_extent_along(j->body, s, h->n)) : 0);
    const bool sprung = spring > 0 && h->gap < 0;
    if (gap >= 0 && !sprung && stays_open(of, h, -gap / j->m->dt)) return BRUNT_OK;
    brunt_corners under;
    brunt_node_to_facet_corners(surface, h, x, &under);
    brunt_particle_velocity(j->body, of->b, s, BRUNT_NODE_VELOCITY, v);
    const double approach = brunt_node_to_facet_approach(&under, h->n, v, surface->v);
    if (gap < 0) {
        brunt_particle_velocity(j->body, of->b, s, BRUNT_NODE_OLD, old);
        before = brunt_node_to_facet_approach(&under, h->n, old, surface->old);
    }
    const double target =
        brunt_node_to_facet_target(surface, (double[]){gap, gap}, fmin(before, LIFT * approach), before, j->m->dt);
    if (!sprung && !(approach < target + 1e-6 * surface->mean_edge / j->m->dt)) return BRUNT_OK;
    particle_list *list = of->list;
    const size_t used = (size_t)list->count;
    if (BRUNT_CAPACITY_IN(list->candidate, list->capacity, used + 1, used, "facets near particles", &list->error))
        return BRUNT_FAILED;
    particle_candidate *found = &list->candidate[list->count++];
    *found = (particle_candidate){.block = of->b, .particle = s, .h = *h};
    memcpy(found->x, x, sizeof found->x);
    found->h.target = target;
    return BRUNT_OK;
}

// The bins of the block that reach into the zone: of total-Lagrangian bodies all, which lie where they were at first.
static void find_bins(looking_block *of) {
    const brunt_grid *grid = &of->j->body->grid;
    const bool all = brunt_total_lagrangian(&of->j->body->particles);
    for (int a = 0; a < 3; a++) {
        const double first = (grid->order - 1) / 2.0 - ROUNDED, last = first + 1 + 2 * ROUNDED; // of bin 0 [cells]
        const double low = (of->j->zone[0][a] - grid->origin[a]) / (double)grid->h -
                           grid->blocks[of->b].coord[a] * grid->side,
                     high = (of->j->zone[1][a] - grid->origin[a]) / (double)grid->h -
                            grid->blocks[of->b].coord[a] * grid->side;
        of->from[a] = 0, of->end[a] = a < grid->dim ? grid->side : 1;
        for (int i = 0; a < grid->dim && !all && i < grid->side && i + last < low; i++) of->from[a] = i + 1;
        for (int i = of->end[a] - 1; a < grid->dim && !all && i >= 0 && i + first > high; i--) of->end[a] = i;
    }
}

static inline void place_of(const search_job *j, int64_t s, double x[3]) {
    real *const *place = brunt_field(&j->body->particles, BRUNT_FIELD_position);
    for (int a = 0; a < 3; a++) x[a] = a < j->body->grid.dim ? (double)place[a][s] : 0;
}

// Facets near one of them that the particle would pass.
static int search_from_particle(looking_block *of, int64_t s, int64_t cell) {
    const search_job *j = of->j;
    search_query *l = &of->query;
    double x[3];
    place_of(j, s, x);
    l->x = x, l->cell = cell;
    if (!j->alone && !brunt_candidates_bodies(j->f, l)) return BRUNT_OK;
    candidate_list found;
    brunt_candidates_find_of_particle(j->m, j->f, l, &found);
    for (int32_t q = 0; q < found.count; q++) {
        found.candidate[q].gap -= brunt_extent_along(j->body, s, found.candidate[q].n);
        if (found.candidate[q].gap <= j->f->bodies.travel && add_particle_candidate(of, s, x, &found.candidate[q]))
            return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

// All that are near look, in their order, and are near no longer.
static int search_from_near(looking_block *of) {
    const brunt_node_to_facet *f = of->j->f;
    near_particles *near = &of->near;
    int32_t count = 0;
    for (int32_t i = 0; i < near->count; i++) {
        double x[3];
        place_of(of->j, near->slot[i], x);
        const int64_t cell = brunt_candidates_cell(f, x);
        if (cell < 0) continue;
        __builtin_prefetch(&f->cells.first[cell]);
        near->slot[count] = near->slot[i], near->cell[count++] = cell;
    }
    near->count = 0;
    for (int32_t i = 0; i < count; i++) {
        const int32_t next = i + AHEAD < count ? i + AHEAD : count - 1;
        const int32_t *facets = &f->cells.face[f->cells.first[near->cell[next]]];
        __builtin_prefetch(facets), __builtin_prefetch(facets + 15);
        if (search_from_particle(of, near->slot[i], near->cell[i])) return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

// Takes a register of particles from slot s on, of which those from `first` on to `end` count, as far as they are in
// the zone.
static void take_near(looking_block *of, int64_t s, int64_t first, int64_t end) {
    real *const *place = brunt_field(&of->j->body->particles, BRUNT_FIELD_position);
    const doubles_mask slot = doubles_lane() + s;
    doubles_mask in = (slot >= first) & (slot < end);
    for (int a = 0; a < of->j->body->grid.dim; a++) {
        const doubles x = doubles_of(place[a] + s);
        in &= (x >= of->j->zone[0][a]) & (x <= of->j->zone[1][a]);
    }
    int32_t found = of->near.count;
    for (int l = 0; l < BRUNT_DOUBLES; l++) of->near.slot[found] = s + l, found -= (int32_t)in[l];
    if (found > of->near.count) brunt_extent_fetch(of->j->body, of->near.slot[of->near.count]);
    of->near.count = found;
}

// Particles of a run of bins along the last axis.
static int search_from_bins(looking_block *of, int64_t first, int64_t end) {
    for (int64_t at = first; at < end; at += BRUNT_DOUBLES) {
        const int64_t last = of->j->body->particles.slots - BRUNT_DOUBLES; // from where a whole register is there
        if (of->near.count + BRUNT_DOUBLES > TOGETHER && search_from_near(of)) return BRUNT_FAILED;
        take_near(of, at < last ? at : last, at, end);
    }
    return BRUNT_OK;
}

static int search_from_block(looking_block *of) {
    const search_job *j = of->j;
    const brunt_grid *grid = &j->body->grid;
    const brunt_block *block = &grid->blocks[of->b];
    double low[3] = {0}, high[3] = {0};
    for (int a = 0; a < grid->dim; a++) {
        low[a] = grid->origin[a] + (double)grid->h * block->coord[a] * grid->side;
        high[a] = low[a] + (double)grid->h * (grid->side + 1);
    }
    if (brunt_total_lagrangian(&j->body->particles)) brunt_body_block_bounds(j->body, of->b, low, high);
    if (!brunt_broad_phase_in_range(j->f, j->box, low, high, j->f->bodies.range)) return BRUNT_OK;
    find_bins(of);
    const int last = grid->dim - 1, columns_end = last == 2 ? of->end[1] : 1;
    for (int x = of->from[0]; x < of->end[0] && of->end[last] > of->from[last]; x++)
        for (int y = last == 2 ? of->from[1] : 0; y < columns_end; y++) {
            const int bin =
                last == 2 ? brunt_node_index(grid, x, y, of->from[2]) : brunt_node_index(grid, x, of->from[1], 0);
            const int32_t *start = grid->bin_start + (int64_t)of->b * BRUNT_BIN_STARTS + bin;
            if (search_from_bins(of, block->first + start[0], block->first + start[of->end[last] - of->from[last]]))
                return BRUNT_FAILED;
        }
    return search_from_near(of);
}

static void search_from_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const search_job *j = context;
    particle_list *list = &j->f->particles.list[worker];
    for (int64_t b = begin; b < end; b++) {
        looking_block block; // but for what is found of it
        block.j = j, block.b = (int32_t)b, block.list = list, block.bounded = false, block.near.count = 0;
        block.query = (search_query){.box = j->box, .body = j->body->index, .particle = true, .touch = {j->other}};
        block.query.touches = 1; // unless there are others, too
        j->f->particles.run[b] = (particle_run){.worker = worker, .first = list->count};
        search_from_block(&block);
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

static void find_zone(search_job *j) {
    const near_bodies *bodies = &j->f->bodies;
    int count = 0;
    for (int a = 0; a < 3; a++) j->zone[0][a] = INFINITY, j->zone[1][a] = -INFINITY;
    for (int32_t q = bodies->first[j->box]; q < bodies->first[j->box + 1]; q++) {
        const body_box *other = &bodies->box[bodies->list[q]];
        for (int a = 0; a < 3 && other->fem >= 0; a++) {
            j->zone[0][a] = fmin(j->zone[0][a], other->low[a] - bodies->range);
            j->zone[1][a] = fmax(j->zone[1][a], other->high[a] + bodies->range);
        }
        if (other->fem >= 0) j->other = other->body, count++;
    }
    j->alone = count == 1;
}

int brunt_node_to_facet_particles(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_body *body, int k,
                                  int32_t box, brunt_constraint_set *constraints, brunt_error *error) {
    brunt_particle_dofs *dofs = &f->particles.dofs[k];
    search_job j = {.m = m, .f = f, .body = body, .box = box, .constraints = constraints, .dofs = dofs};
    if (reserve_particles(f, body, m->threads, error) || brunt_particle_dofs_begin(m, body, dofs, error))
        return BRUNT_FAILED;
    dofs->tag = -1 - k;
    find_zone(&j);
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
