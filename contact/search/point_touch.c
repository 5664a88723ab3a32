#include "contact/search/point_touch.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "contact/distance/gjk.h"
#include "contact/search/overlap_spring.h"
#include "contact/search/point_surface.h"

static const double NEAR = 0.25; // spacings: how near particles look at each other, if nothing moves faster
// Spacings: how far aside of a slave a particle may be that carries it, more than half the diagonal of a square.
static const double WIDE = 0.75;
static const double OWN = 1.5;  // spacings about a slave: what its body is taken for where the distance is measured
static const double TIE = 1e-6; // spacings: particles as near as this bear together
// How much deeper a particle that is aside seems, spacings at one spacing aside: of a flat surface the particle under
// the slave carries.
static const double ASIDE = 1e-3;

// A slave, and the particles that bear it.
typedef struct touch {
    int32_t slave, master; // of the bodies of material points
    int32_t block, blocks[BRUNT_PARTICLES_TOGETHER];
    int64_t particle, particles[BRUNT_PARTICLES_TOGETHER];
    int count;
    double x[3], n[3]; // n: from the master to the slave
    double gap, target, spring;
} touch;

typedef struct touch_list {
    touch *touch;
    size_t touch_capacity;
    int32_t touch_count;
    brunt_neighbours own, other; // of the slave
    brunt_error error;
} touch_list;

struct brunt_point_touches {
    brunt_constraint_set set;
    brunt_particle_dofs *dofs; // of each body of material points
    struct touch_box {
        int32_t low[3], high[3];
    } * box; // of the blocks of each
    int mpm_count;
    touch_list *list;
    int list_count;
    struct touch_run {
        int worker;
        int32_t first, count;
    } * run;
    size_t run_capacity;
};

typedef struct look {
    const brunt_contact_context *m;
    brunt_point_touches *t;
    brunt_body *slave, *master;
    int slave_k, master_k; // of the bodies of material points
    double range;          // [m] how far masters are looked for
    double travel;         // [m] how far two of their particles may come together in the step
} look;

void brunt_point_touches_free(brunt_point_touches *t) {
    if (!t) return;
    brunt_constraints_free(&t->set);
    for (int k = 0; t->dofs && k < t->mpm_count; k++) brunt_particle_dofs_free(&t->dofs[k]);
    for (int w = 0; w < t->list_count; w++) {
        brunt_free(t->list[w].touch);
        brunt_neighbours_free(&t->list[w].own);
        brunt_neighbours_free(&t->list[w].other);
    }
    brunt_free(t->dofs);
    brunt_free(t->box);
    brunt_free(t->list);
    brunt_free(t->run);
    brunt_free(t);
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// ------------------------------------------------------------------------------------------ looking

// How far the slave is from the master along n, out of the master, with what carries it. Whether anything does.
static bool measure(const look *l, const brunt_neighbours *list, const double n[3], touch *t) {
    double best = -INFINITY;
    t->count = 0;
    const double tie = TIE * l->master->spacing, aside = ASIDE / l->master->spacing;
    for (int32_t i = 0; i < list->near_count; i++) {
        const brunt_neighbour *of = &list->near[i];
        const double along = dot(of->d, n), square = dot(of->d, of->d) - along * along;
        const double wide = WIDE * l->master->spacing * brunt_point_stretch(l->master, of->particle);
        if (square > wide * wide) continue;
        const double score = along + brunt_point_extent(l->master, of->particle, n) - aside * square;
        if (score < best - tie || (score < best + tie && t->count == BRUNT_PARTICLES_TOGETHER)) continue;
        if (score > best + tie) t->count = 0;
        if (t->count == 0 || score > best) best = score;
        t->blocks[t->count] = of->block, t->particles[t->count++] = of->particle;
    }
    if (!t->count) return false;
    const double back[3] = {-n[0], -n[1], -n[2]};
    t->gap = -best - brunt_point_extent(l->slave, t->particle, back);
    memcpy(t->n, n, sizeof t->n);
    return true;
}

static void place_of(brunt_body *body, int64_t s, double x[3]) {
    real *const *place = brunt_field(&body->particles, BRUNT_FIELD_position);
    for (int a = 0; a < 3; a++) x[a] = a < body->grid.dim ? (double)place[a][s] : 0;
}

// From the centre of master `q` of a touch to the line of its push, or (`at` above 0) so far along n from the slave.
static void arm_of(brunt_body *body, const touch *t, int q, bool line, double at, double arm[3]) {
    double x[3];
    place_of(body, t->particles[q], x);
    for (int a = 0; a < 3; a++) arm[a] = t->x[a] - x[a];
    const double along = line ? dot(arm, t->n) : at;
    for (int a = 0; a < 3; a++) arm[a] -= along * t->n[a];
}

// The nodes of what carries a touch, with the weights where the line of the push meets it, or (`at` above 0) so far
// along n from the slave.
static void nodes_of_masters(brunt_body *body, const touch *t, bool line, double at, brunt_particle_nodes *out) {
    double arm[3];
    brunt_particle_nodes under;
    out->count = 0;
    for (int q = 0; q < t->count; q++) {
        arm_of(body, t, q, line, at, arm);
        brunt_particle_nodes_find(body, t->blocks[q], t->particles[q], arm, &under);
        brunt_particle_nodes_add(&under, 1.0 / t->count, out);
    }
}

// Velocity of the slave past the master along the normal [m/s].
static double approach_of(const look *l, const touch *t) {
    const int dim = l->slave->grid.dim;
    brunt_particle_nodes under;
    double v[3], master[3];
    brunt_particle_nodes_find(l->slave, t->block, t->particle, NULL, &under);
    brunt_particle_nodes_velocity(&under, dim, BRUNT_NODE_VELOCITY, v);
    nodes_of_masters(l->master, t, true, 0, &under);
    brunt_particle_nodes_velocity(&under, dim, BRUNT_NODE_VELOCITY, master);
    return dot(v, t->n) - dot(master, t->n);
}

// Where bodies are in each other: normals out of the master, into the slave, and between them. How many.
static int slopes(const look *l, const double x[3], double n[3][3]) {
    double in[3], mean[3];
    const bool out = brunt_point_outward(&l->master->grid, x, n[0]),
               known = brunt_point_outward(&l->slave->grid, x, in);
    int count = out;
    if (!known) return count;
    for (int a = 0; a < 3; a++) n[count][a] = -in[a], mean[a] = n[0][a] - in[a];
    count++;
    const double size = sqrt(dot(mean, mean));
    if (!out || !(size > 0.1)) return count;
    for (int a = 0; a < 3; a++) n[count][a] = mean[a] / size;
    return count + 1;
}

// How far the slave is, along the normal, from the slope of the master beside it: what carries may be aside of it.
static double slope_gap(const look *l, const touch *t) {
    double out[3], x[3], gap = 0;
    if (!brunt_point_outward(&l->master->grid, t->x, out)) return t->gap;
    const double cosine = dot(out, t->n), back[3] = {-t->n[0], -t->n[1], -t->n[2]};
    if (!(cosine > 0.5)) return t->gap;
    for (int q = 0; q < t->count; q++) {
        place_of(l->master, t->particles[q], x);
        for (int a = 0; a < 3; a++) x[a] = t->x[a] - x[a];
        gap += (dot(x, out) - brunt_point_extent(l->master, t->particles[q], out)) / (cosine * t->count);
    }
    return gap - brunt_point_extent(l->slave, t->particle, back);
}

// The direction of the least distance between the centres of both bodies about the slave. Whether they are apart.
static int least_distance(const look *l, touch_list *list, double n[3], bool *apart, brunt_error *error) {
    const brunt_neighbour *nearest = list->other.near;
    for (int32_t i = 1; i < list->other.near_count; i++)
        if (dot(list->other.near[i].d, list->other.near[i].d) < dot(nearest->d, nearest->d))
            nearest = &list->other.near[i];
    const double start[3] = {-nearest->d[0], -nearest->d[1], -nearest->d[2]};
    if (brunt_neighbours_centres(&list->own, OWN * l->slave->spacing, error) ||
        brunt_neighbours_centres(&list->other, l->range, error))
        return BRUNT_FAILED;
    brunt_corners corners = {.count = 0};
    *apart =
        brunt_gjk_centres(&list->other.centres, &list->own.centres, (double)l->slave->grid.h, start, n, &corners) > 0;
    return BRUNT_OK;
}

// Of the slopes that which keeps what is about the slave of both bodies the farthest apart. Whether there is any.
static bool best_slope(const look *l, const touch_list *list, touch *best) {
    touch t = *best;
    double n[3][3], most = -INFINITY;
    const int ways = slopes(l, t.x, n);
    best->count = 0;
    for (int way = 0; way < ways; way++) {
        if (!measure(l, &list->other, n[way], &t)) continue;
        const double back[3] = {-t.n[0], -t.n[1], -t.n[2]}, apart = -brunt_point_support(l->slave, &list->own, back) -
                                                                    brunt_point_support(l->master, &list->other, t.n);
        if (apart > most) most = apart, *best = t;
    }
    return best->count > 0;
}

// Looks from a particle along the direction in which the bodies are the least apart about it.
static int look_from(const look *l, int32_t b, int64_t s, touch_list *list, brunt_error *error) {
    touch t = {.slave = l->slave_k, .master = l->master_k, .block = b, .particle = s};
    const double dt = l->m->dt;
    double n[3];
    bool apart;
    place_of(l->slave, s, t.x);
    if (brunt_neighbours_find(l->master, l->range, t.x, &list->other, error)) return BRUNT_FAILED;
    if (!list->other.near_count) return BRUNT_OK;
    if (brunt_neighbours_find(l->slave, l->range, t.x, &list->own, error) || least_distance(l, list, n, &apart, error))
        return BRUNT_FAILED;
    if (!(apart ? measure(l, &list->other, n, &t) : best_slope(l, list, &t)) || t.gap > l->travel) return BRUNT_OK;
    t.gap = fmax(t.gap, slope_gap(l, &t));
    if (t.gap > l->travel) return BRUNT_OK;
    t.spring = brunt_overlap_spring_between(l->m, l->slave, s, l->master);
    const double back[3] = {-t.n[0], -t.n[1], -t.n[2]},
                 room = t.spring > 0
                            ? brunt_overlap_limit(l->slave, brunt_point_extent(l->slave, t.particle, back)) +
                                  brunt_overlap_limit(l->master, brunt_point_extent(l->master, t.particles[0], t.n))
                            : 0;
    t.target = -fmax(t.gap + room, 0) / dt;
    if (!(t.spring > 0 && t.gap < 0) && !(approach_of(l, &t) < t.target + 1e-6 * (double)l->slave->grid.h / dt))
        return BRUNT_OK;
    if (BRUNT_CAPACITY_MORE(list->touch, "particles that touch", error)) return BRUNT_FAILED;
    list->touch[list->touch_count++] = t;
    return BRUNT_OK;
}

static bool block_near(const look *l, int32_t b) {
    const brunt_grid *grid = &l->slave->grid, *other = &l->master->grid;
    const int32_t *at = grid->blocks[b].coord, by = 1 + (int32_t)(l->range / ((double)grid->h * grid->side)),
                  deep = grid->dim == 3 ? by : 0;
    int32_t c[3];
    for (c[0] = at[0] - by; c[0] <= at[0] + by; c[0]++)
        for (c[1] = at[1] - by; c[1] <= at[1] + by; c[1]++)
            for (c[2] = at[2] - deep; c[2] <= at[2] + deep; c[2]++)
                if (brunt_grid_block(other, brunt_key(c)) >= 0) return true;
    return false;
}

static void look_from_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const look *l = context;
    touch_list *list = &l->t->list[worker];
    const real *mass = brunt_field(&l->slave->particles, BRUNT_FIELD_mass)[0];
    for (int64_t b = begin; b < end; b++) {
        const brunt_block *block = &l->slave->grid.blocks[b];
        struct touch_run *run = &l->t->run[b];
        *run = (struct touch_run){.worker = worker, .first = list->touch_count};
        if (block_near(l, (int32_t)b))
            for (int64_t s = block->first; s < block->first + block->count; s++)
                if (mass[s] > 0) look_from(l, (int32_t)b, s, list, &list->error);
        run->count = list->touch_count - run->first;
    }
}

// ------------------------------------------------------------------------------------------ constraints

// Entries of the slave, and of what carries it.
static int enter_touch(const look *l, const touch *t, brunt_error *error) {
    brunt_particle_nodes under;
    brunt_particle_nodes_find(l->slave, t->block, t->particle, NULL, &under);
    if (brunt_particle_dofs_enter(l->slave, &under, 1, &l->t->dofs[t->slave], &l->t->set, error)) return BRUNT_FAILED;
    nodes_of_masters(l->master, t, true, 0, &under);
    return brunt_particle_dofs_enter(l->master, &under, -1, &l->t->dofs[t->master], &l->t->set, error);
}

// What the last constraint rubs with: the same nodes, where the surfaces meet.
static int enter_friction(const look *l, const touch *t, brunt_error *error) {
    const double back[3] = {-t->n[0], -t->n[1], -t->n[2]},
                 extent = brunt_point_extent(l->slave, t->particle, back) + 0.5 * fmin(t->gap, 0);
    double x[3], arm[3];
    brunt_particle_nodes under;
    for (int a = 0; a < 3; a++) arm[a] = -extent * t->n[a], x[a] = t->x[a] + arm[a];
    brunt_particle_nodes_find(l->slave, t->block, t->particle, arm, &under);
    const int32_t first =
        brunt_particle_dofs_friction_point(l->slave, &under, x, &l->t->dofs[t->slave], &l->t->set, error);
    if (first < 0) return BRUNT_FAILED;
    nodes_of_masters(l->master, t, false, extent, &under);
    brunt_particle_dofs_rub(l->master, &under, -1, &l->t->dofs[t->master], first, &l->t->set);
    return BRUNT_OK;
}

static int add_constraint(const look *l, const touch *t, brunt_error *error) {
    brunt_constraint_set *set = &l->t->set;
    brunt_pair *pair = &l->m->pairs[brunt_pair_of(l->m->pair_map, l->slave->index, l->master->index)];
    const int32_t at = brunt_constraints_add(set, error);
    if (at < 0) return BRUNT_FAILED;
    brunt_constraint *constraint = &set->constraint[at];
    memcpy(constraint->x, t->x, sizeof constraint->x);
    memcpy(constraint->n, t->n, sizeof constraint->n);
    constraint->gap = t->gap, constraint->target = t->target, constraint->spring = t->spring;
    constraint->friction = pair->friction;
    constraint->account = &pair->last;
    constraint->sign = l->slave->index > l->master->index ? 1 : -1;
    constraint->area = 0.5 * l->slave->spacing * (l->slave->grid.dim == 3 ? l->slave->spacing : 1);
    constraint->tag = t->slave, constraint->bearer = t->master + 1;
    if (enter_touch(l, t, error)) return BRUNT_FAILED;
    return pair->friction > 0 ? enter_friction(l, t, error) : BRUNT_OK;
}

static void bound_blocks(const brunt_grid *grid, struct touch_box *box) {
    for (int a = 0; a < 3; a++) box->low[a] = INT32_MAX, box->high[a] = INT32_MIN;
    for (int32_t b = 0; b < grid->block_count; b++)
        for (int a = 0; a < grid->dim; a++) {
            const int32_t c = grid->blocks[b].coord[a];
            box->low[a] = c < box->low[a] ? c : box->low[a], box->high[a] = c > box->high[a] ? c : box->high[a];
        }
}

// Whether the blocks of the two bodies are farther apart than anything is looked for.
static bool are_apart(const look *l) {
    const struct touch_box *one = &l->t->box[l->slave_k], *other = &l->t->box[l->master_k];
    const int32_t by = 1 + (int32_t)(l->range / ((double)l->slave->grid.h * l->slave->grid.side));
    for (int a = 0; a < l->slave->grid.dim; a++)
        if (one->low[a] - by > other->high[a] || other->low[a] - by > one->high[a]) return true;
    return false;
}

static int meet(look *l, int slave, int master, brunt_error *error) {
    brunt_point_touches *t = l->t;
    l->slave = &l->m->mpm[slave], l->master = &l->m->mpm[master], l->slave_k = slave, l->master_k = master;
    const double spacing = fmax(l->slave->spacing, l->master->spacing);
    l->travel = fmax(2 * l->m->dt * (double)(l->slave->speed + l->master->speed), NEAR * spacing);
    l->range = sqrt(spacing * spacing + pow(2 * spacing + l->travel, 2));
    if (are_apart(l)) return BRUNT_OK;
    const int32_t blocks = l->slave->grid.block_count;
    if (BRUNT_CAPACITY(t->run, (size_t)blocks + 1, 0, "blocks of particles that may touch", error)) return BRUNT_FAILED;
    for (int w = 0; w < t->list_count; w++) t->list[w].touch_count = 0, t->list[w].error.code = BRUNT_OK;
    brunt_parallel(l->m->threads, blocks, 1, look_from_blocks, l, l->m->timer);
    for (int w = 0; w < t->list_count; w++)
        if (brunt_hand_on(error, &t->list[w].error)) return BRUNT_FAILED;
    for (int32_t b = 0; b < blocks; b++)
        for (int32_t i = 0; i < t->run[b].count; i++)
            if (add_constraint(l, &t->list[t->run[b].worker].touch[t->run[b].first + i], error)) return BRUNT_FAILED;
    return BRUNT_OK;
}

static brunt_point_touches *make_touches(const brunt_contact_context *m, brunt_error *error) {
    brunt_point_touches *t;
    if (BRUNT_NEW(t, 1, "search for particles that touch", error)) return NULL;
    t->set.accelerated = true;
    t->mpm_count = m->mpm_count;
    const bool failed = BRUNT_NEW(t->list, m->threads, "threads that look from particles", error) ||
                        BRUNT_NEW(t->dofs, m->mpm_count, "bodies of particles that touch", error) ||
                        BRUNT_NEW(t->box, m->mpm_count, "boxes about bodies of particles", error);
    t->list_count = t->list ? m->threads : 0;
    if (!failed) return t;
    brunt_point_touches_free(t);
    return NULL;
}

int brunt_point_touches_apply(const brunt_contact_context *m, int sweeps, double tolerance,
                              brunt_point_touches **touches, brunt_error *error) {
    if (!*touches && !(*touches = make_touches(m, error))) return BRUNT_FAILED;
    brunt_point_touches *t = *touches;
    look l = {.m = m, .t = t};
    brunt_constraints_clear(&t->set);
    t->set.kick = m->kick;
    for (int k = 0; k < m->mpm_count; k++) {
        if (brunt_particle_dofs_begin(m, &m->mpm[k], &t->dofs[k], error)) return BRUNT_FAILED;
        t->dofs[k].tag = k;
        bound_blocks(&m->mpm[k].grid, &t->box[k]);
    }
    for (int a = 0; a < m->mpm_count; a++)
        for (int b = 0; b < m->mpm_count; b++) {
            const int32_t pair = a == b ? -1 : brunt_pair_of(m->pair_map, m->mpm[a].index, m->mpm[b].index);
            if (pair < 0 || !(m->pairs[pair].meets & BRUNT_MEET_AT_PARTICLES)) continue;
            if (meet(&l, a, b, error)) return BRUNT_FAILED;
        }
    if (brunt_constraints_solve(&t->set, sweeps, tolerance, m->threads, m->timer, error)) return BRUNT_FAILED;
    for (int k = 0; k < m->mpm_count; k++) brunt_particle_dofs_scatter(m, &m->mpm[k], &t->dofs[k], &t->set);
    return BRUNT_OK;
}
