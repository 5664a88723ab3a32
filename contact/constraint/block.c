#include "contact/constraint/block.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/array.h"
#include "base/transpose.h"
#include "contact/constraint/rest.h"

enum { LANES = BRUNT_DOUBLES };
typedef brunt_constraint_block block;

// ------------------------------------------------------------------------------------------ to lanes and back

typedef double quad __attribute__((vector_size(32), may_alias));

// Three components of each lane's place in an array of four numbers each.
BRUNT_INLINE void gather(double (*from)[4], const int32_t at[LANES], doubles out[3]) {
    const double *place[LANES];
    doubles all[4];
    for (int l = 0; l < LANES; l++) place[l] = from[at[l]];
    doubles_take(place, all);
    for (int a = 0; a < 3; a++) out[a] = all[a];
}

// Four numbers of each lane, even lanes first.
typedef struct fours {
    _Alignas(64) double of[LANES][4];
} fours;

// What each entry gives its node.
typedef struct gifts {
    fours of[BRUNT_BLOCK_ENTRIES];
} gifts;

BRUNT_INLINE const double *four_of(const fours *f, int l) {
    return f->of[BRUNT_EIGHT_DOUBLES ? (l & 1) * (LANES / 2) + l / 2 : l];
}
BRUNT_INLINE const double *gift_of(const gifts *g, int e, int l) { return four_of(&g->of[e], l); }

BRUNT_INLINE void part(fours *g, doubles x, doubles y, doubles z, doubles w) {
#if BRUNT_EIGHT_DOUBLES
    const doubles low = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14); // x0 y0 x2 y2 x4 y4 x6 y6
    const doubles high = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
    const doubles low_z = __builtin_shufflevector(z, w, 0, 8, 2, 10, 4, 12, 6, 14);
    const doubles high_z = __builtin_shufflevector(z, w, 1, 9, 3, 11, 5, 13, 7, 15);
    doubles_store(g->of[0], __builtin_shufflevector(low, low_z, 0, 1, 8, 9, 2, 3, 10, 11));
    doubles_store(g->of[2], __builtin_shufflevector(low, low_z, 4, 5, 12, 13, 6, 7, 14, 15));
    doubles_store(g->of[4], __builtin_shufflevector(high, high_z, 0, 1, 8, 9, 2, 3, 10, 11));
    doubles_store(g->of[6], __builtin_shufflevector(high, high_z, 4, 5, 12, 13, 6, 7, 14, 15));
#else
    for (int l = 0; l < LANES; l++) g->of[l][0] = x[l], g->of[l][1] = y[l], g->of[l][2] = z[l], g->of[l][3] = w[l];
#endif
}

// In the order of the constraints, as sums are.
BRUNT_INLINE void hand_out(const brunt_constraint_set *p, const block *b, int count, const gifts *g) {
    if (!b->shared) {
        for (int l = 0; l < LANES; l++)
            for (int e = 0; e < count; e++) *(quad *)p->sum[b->dof_node[e][l]] += *(const quad *)gift_of(g, e, l);
        return;
    }
    for (int l = 0; l < LANES; l++)
        for (int e = 0; e < count; e++) {
            const int32_t s = b->dof_node[e][l];
            if (p->shared[s])
                *(quad *)p->given[b->first[l] + e] = *(const quad *)gift_of(g, e, l);
            else
                *(quad *)p->sum[s] += *(const quad *)gift_of(g, e, l);
        }
}

// ------------------------------------------------------------------------------------------ made

// What is read four numbers at a time.
#define FOLLOWS(of, b, a, size)                                                                                        \
    _Static_assert(offsetof(of, b) == offsetof(of, a) + (size), "read with what is before it")
FOLLOWS(brunt_constraint, facet, n, 3 * sizeof(double));
FOLLOWS(brunt_constraint, gap, facet, 3 * sizeof(double));
FOLLOWS(brunt_constraint, target, gap, sizeof(double));
FOLLOWS(brunt_constraint, least, friction, sizeof(double));
FOLLOWS(brunt_constraint, spring, least, sizeof(double));
FOLLOWS(brunt_constraint_entry, height_gradient, weight, 3 * sizeof(double));
enum { LAST_WEIGHT = 2 };

static bool all_lanes(doubles_mask m) {
    int64_t all = -1;
    for (int l = 0; l < LANES; l++) all &= m[l];
    return all != 0;
}

// Whether a constraint can be in a block of so many entries each: one that lets go, on what stands still or is a facet.
static bool fits(const brunt_constraint *c, int32_t count) {
    return c->count == count && !c->friction_point && !c->sticks && c->image == 0 && c->plane[0] == 0 &&
           c->plane[1] == 0 && c->plane[2] == 0;
}

// Of LANES constraints; false: they are not alike.
static bool take_constraints(const brunt_constraint *c, block *b) {
    const double *normal[LANES], *facet[LANES], *friction[LANES];
    doubles first[4], second[4], third[4], zero = {0};
    for (int l = 0; l < LANES; l++) {
        normal[l] = c[l].n, facet[l] = c[l].facet + 1, friction[l] = &c[l].friction;
        b->first[l] = c[l].first;
    }
    doubles_take(normal, first), doubles_take(facet, second), doubles_take(friction, third);
    for (int a = 0; a < 3; a++) b->n[a] = first[a];
    b->facet[0] = first[3], b->facet[1] = second[0], b->facet[2] = second[1];
    b->target = second[3], b->friction = third[0];
    b->rubs = !all_lanes(~(b->friction > zero));
    return all_lanes((third[1] == zero) & ~(third[2] > zero));
}

// Entry e of each; false: weights are not of all components, or the slave turns.
static bool take_entries(const brunt_constraint_set *p, int e, block *b) {
    const double *weight[LANES], *gradient[LANES];
    doubles first[4], second[4], zero = {0};
    for (int l = 0; l < LANES; l++) {
        const brunt_constraint_entry *entry = &p->entry[b->first[l] + e];
        b->dof_node[e][l] = entry->dof_node;
        weight[l] = entry->weight, gradient[l] = entry->weight + LAST_WEIGHT;
    }
    doubles_take(weight, first), doubles_take(gradient, second);
    b->weight[e] = first[0];
    for (int a = 0; a < 3 && e > 0; a++) b->height_gradient[e - 1][a] = second[1 + a];
    const doubles_mask turns =
        e > 0 ? zero != zero : ~((second[1] == zero) & (second[2] == zero) & (second[3] == zero));
    return all_lanes((first[0] == first[1]) & (first[1] == first[2]) & ~turns);
}

static bool any_angular(const brunt_constraint_set *p, const block *b) {
    for (int e = 0; e < b->count && p->levered; e++)
        for (int l = 0; l < LANES; l++)
            if (p->dof_node[b->dof_node[e][l]].angular) return true;
    return false;
}

// What entry e gives its node of an impulse.
BRUNT_INLINE void transpose(const block *b, int e, const doubles J[3], doubles out[3]) {
    if (e == 0) {
        for (int a = 0; a < 3; a++) out[a] = b->weight[e] * J[a];
        return;
    }
    const doubles *gradient = b->height_gradient[e - 1],
                  rise = gradient[0] * J[0] + gradient[1] * J[1] + gradient[2] * J[2];
    for (int a = 0; a < 3; a++) out[a] = b->weight[e] * J[a] + rise * b->facet[a];
}

static void weigh(const brunt_constraint_set *p, block *b) {
    doubles alone = {0};
    for (int e = 0; e < b->count; e++) {
        doubles J[3], inverse[3];
        transpose(b, e, b->n, J);
        gather(p->inverse, b->dof_node[e], inverse);
        for (int a = 0; a < 3; a++) alone += J[a] * J[a] * inverse[a];
    }
    const doubles zero = {0};
    b->scale = doubles_select(alone > zero, doubles_set(1) / alone, zero);
}

// Lanes are of several threads: a number at a time.
static double *lane_of(doubles *of, int64_t k) { return (double *)of + k % LANES; }

void brunt_constraints_lane(brunt_constraint_set *p, int32_t k, const brunt_constraint_entry *entry) {
    block *b = &p->block[k / LANES];
    brunt_constraint *c = &p->constraint[k];
    b->first[k % LANES] = c->first;
    for (int e = 0; e < c->count; e++) {
        b->dof_node[e][k % LANES] = entry[e].dof_node;
        *lane_of(&b->weight[e], k) = entry[e].weight[0];
        for (int a = 0; a < 3 && e > 0; a++) *lane_of(&b->height_gradient[e - 1][a], k) = entry[e].height_gradient[a];
    }
    for (int a = 0; a < 3; a++) *lane_of(&b->n[a], k) = c->n[a], *lane_of(&b->facet[a], k) = c->facet[a];
    *lane_of(&b->target, k) = c->target, *lane_of(&b->friction, k) = c->friction;
    c->laned = true;
}

void brunt_block_write_entries(brunt_constraint_set *p, int64_t at) {
    const block *b = &p->block[at];
    for (int64_t k = at * LANES; k < (at + 1) * LANES && k < p->constraint_count; k++) {
        brunt_constraint *c = &p->constraint[k];
        const int l = (int)(k % LANES);
        for (int e = 0; e < c->count && c->laned; e++) {
            brunt_constraint_entry *entry = &p->entry[c->first + e];
            entry->dof_node = b->dof_node[e][l];
            for (int a = 0; a < 3; a++) {
                entry->weight[a] = b->weight[e][l];
                entry->height_gradient[a] = e > 0 ? b->height_gradient[e - 1][a][l] : 0;
            }
        }
        c->laned = false;
    }
}

// Whether all of a block is in its lanes, with as many entries each.
static bool are_laned(const brunt_constraint *c) {
    for (int l = 0; l < LANES; l++)
        if (!c[l].laned || c[l].count != c->count) return false;
    return true;
}

static bool fills(brunt_constraint_set *p, int64_t at, block *b) {
    const int64_t k = at * LANES;
    const brunt_constraint *c = &p->constraint[k];
    const doubles zero = {0};
    if (!p->accelerated && k + LANES <= p->constraint_count && are_laned(c)) {
        b->rubs = !all_lanes(~(b->friction > zero));
        b->count = c->count;
        return true;
    }
    if (at < p->open_blocks) brunt_block_write_entries(p, at);
    if (p->accelerated || k + LANES > p->constraint_count || c->count > BRUNT_BLOCK_ENTRIES) return false;
    for (int l = 0; l < LANES; l++)
        if (!fits(&c[l], c->count)) return false;
    if (!take_constraints(c, b)) return false;
    for (int e = 0; e < c->count; e++)
        if (!take_entries(p, e, b)) return false;
    b->count = c->count;
    return !any_angular(p, b);
}

static void fill(brunt_constraint_set *p, int64_t at) {
    block *b = &p->block[at];
    if (fills(p, at, b))
        brunt_block_take_back(b);
    else
        b->count = 0;
}

void brunt_block_make(brunt_constraint_set *p, int64_t at) {
    if (at >= p->open_blocks || p->block[at].count == BRUNT_NONE) fill(p, at);
}

int brunt_constraints_open_blocks(brunt_constraint_set *p, brunt_error *error) {
    const int32_t blocks = p->constraint_count / LANES + 1;
    if (BRUNT_CAPACITY(p->block, (size_t)blocks, 0, "blocks of contact points", error)) return BRUNT_FAILED;
    for (int32_t b = 0; b < blocks; b++) p->block[b].count = BRUNT_NONE;
    p->open_blocks = blocks;
    return BRUNT_OK;
}

int32_t brunt_constraints_fill_blocks(brunt_constraint_set *p, int32_t first, int32_t end) {
    for (first = (first + LANES - 1) / LANES * LANES; first + LANES <= end; first += LANES) fill(p, first / LANES);
    return first;
}

// ------------------------------------------------------------------------------------------ weighed

// What turning the facet adds to the most of its impulse that entry e gives (solve.c).
BRUNT_INLINE doubles lever(const brunt_constraint_set *p, const block *b, int e) {
    doubles square = {0};
    if (!p->levers || e == 0) return square;
    for (int a = 0; a < 3; a++) square += b->height_gradient[e - 1][a] * b->height_gradient[e - 1][a];
    return doubles_sqrt(square);
}

BRUNT_INLINE doubles magnitude(doubles a) { return doubles_max(a, -a); }

void brunt_block_share(const brunt_constraint_set *p, block *b) {
    gifts g;
    b->shared = false;
    weigh(p, b);
    for (int e = 0; e < b->count; e++) {
        const doubles share = magnitude(b->weight[e]) + lever(p, b, e);
        part(&g.of[e], share, share, share, b->scale);
    }
    for (int l = 0; l < LANES; l++)
        for (int e = 0; e < b->count; e++) {
            const int32_t s = b->dof_node[e][l];
            const double *share = gift_of(&g, e, l);
            if (p->shared[s])
                memcpy(p->given[b->first[l] + e], share, sizeof g.of[e].of[0]);
            else
                p->load[s][0] += share[0] * share[3];
            b->shared = b->shared || p->shared[s];
        }
}

void brunt_block_sum_rows(const brunt_constraint_set *p, block *b) {
    const doubles zero = {0}, one = doubles_set(1);
    doubles along[3] = {{0}}, across[3] = {{0}}, row_sum = {0}, row_sum_t = {0};
    for (int e = 0; e < b->count; e++) {
        const doubles most = magnitude(b->weight[e]) + lever(p, b, e);
        doubles inverse[3], load, load_t = {0};
        gather(p->inverse, b->dof_node[e], inverse);
        for (int l = 0; l < LANES; l++) {
            const double *node = p->load[b->dof_node[e][l]];
            load[l] = node[0];
            if (p->friction_point_count) load_t[l] = node[1];
        }
        if (!p->friction_point_count) load_t = load; // what pushes and what rubs are the same weights
        for (int a = 0; a < 3; a++) {
            along[a] += most * load * inverse[a];
            across[a] += most * load_t * inverse[a];
        }
    }
    for (int a = 0; a < 3; a++) {
        row_sum += b->n[a] * b->n[a] * along[a];
        row_sum_t = doubles_max(across[a], row_sum_t);
    }
    b->row_sum = doubles_max(row_sum, one), b->row_sum_t = doubles_max(row_sum_t, one);
    const doubles_mask moves = b->scale > zero; // what nothing can move gets nothing, at any unit
    b->unit = doubles_select(moves, b->scale / b->row_sum, one);
    b->unit_t = doubles_select(moves, b->scale / b->row_sum_t, one);
}

// ------------------------------------------------------------------------------------------ solved

BRUNT_INLINE void relative_velocity(double (*of)[4], const block *b, int count, doubles u[3]) {
    const doubles zero = {0};
    doubles v[3];
    gather(of, b->dof_node[0], v);
    for (int a = 0; a < 3; a++) u[a] = zero + b->weight[0] * v[a];
    for (int e = 1; e < count; e++) {
        gather(of, b->dof_node[e], v);
        const doubles rise = b->facet[0] * v[0] + b->facet[1] * v[1] + b->facet[2] * v[2];
        for (int a = 0; a < 3; a++) u[a] += b->weight[e] * v[a] + rise * b->height_gradient[e - 1][a];
    }
}

// Brings slip to what friction allows, of velocity u, which is `along` the normal; the impulse is added to J. The
// velocity it is worth.
static inline doubles rub(block *b, const doubles u[3], doubles along, doubles_mask awake, doubles J[3]) {
    const doubles zero = {0};
    doubles wanted[3], change[3], square = {0};
    for (int a = 0; a < 3; a++) wanted[a] = b->friction_impulse[a] - (u[a] - along * b->n[a]) * b->unit_t;
    for (int a = 0; a < 3; a++) square += wanted[a] * wanted[a];
    const doubles size = doubles_sqrt(square), limit = b->friction * b->normal_impulse;
    const doubles_mask slips = size > limit;
    const doubles share = doubles_select(slips, limit / size, doubles_set(1));
    const doubles_mask rubs = (b->friction > zero) & (b->scale > zero) & awake;
    square = zero;
    for (int a = 0; a < 3; a++) {
        const doubles now = share * wanted[a];
        change[a] = doubles_select(rubs, now - b->friction_impulse[a], zero);
        b->friction_impulse[a] = doubles_select(rubs, now, b->friction_impulse[a]);
        square += change[a] * change[a];
        J[a] = doubles_select(rubs, J[a] + change[a], J[a]);
    }
    b->slips = doubles_mask_select(awake, slips & rubs, b->slips);
    return doubles_sqrt(square) / b->unit_t;
}

// Lanes that are not awake keep what they have.
BRUNT_INLINE doubles solve(const brunt_constraint_set *p, block *b, int count, doubles_mask awake) {
    const doubles zero = {0};
    doubles u[3], J[3], along = {0};
    gifts g;
    relative_velocity(p->now, b, count, u);
    for (int a = 0; a < 3; a++) along += u[a] * b->n[a];
    const doubles asked = b->normal_impulse + (b->target - along) * b->unit;
    const doubles least = doubles_select(b->scale > zero, doubles_max(asked, zero), zero);
    const doubles now = doubles_select(awake, least, b->normal_impulse);
    const doubles step = now - b->normal_impulse;
    b->normal_impulse = now;
    for (int a = 0; a < 3; a++) J[a] = step * b->n[a];
    doubles changed = magnitude(step) / b->unit;
    if (b->rubs) changed = doubles_max(rub(b, u, along, awake, J), changed);
    for (int e = 0; e < count; e++) {
        doubles out[3];
        transpose(b, e, J, out);
        part(&g.of[e], out[0], out[1], out[2], out[2]); // whatever the fourth is: beside zeros gcc 12 writes one by one
    }
    hand_out(p, b, count, &g);
    return changed;
}

// Which constraints of a block do not rest (rest.h).
BRUNT_INLINE doubles_mask find_awake(const brunt_constraint_set *p, const block *b, int count, doubles corrected) {
    uint8_t stirred[LANES] = {0};
    doubles_mask moved;
    for (int e = 0; e < count; e++)
        for (int l = 0; l < LANES; l++) stirred[l] |= p->stirred[b->dof_node[e][l]];
    for (int l = 0; l < LANES; l++) moved[l] = -(int64_t)stirred[l];
    return ~(corrected <= doubles_set(p->still)) | moved;
}

BRUNT_INLINE double sweep(const brunt_constraint_set *p, block *b, int count) {
    const int64_t k = (b - p->block) * LANES;
    const doubles corrected = doubles_load(&p->corrected[k]);
    doubles_mask awake = doubles_set_mask(-1);
    if (p->still > 0) {
        awake = find_awake(p, b, count, corrected);
        int64_t any = 0;
        for (int l = 0; l < LANES; l++) any |= awake[l];
        if (!any && !p->rests[k] && b->shared)
            for (int l = 0; l < LANES; l++) brunt_constraint_gives_nothing(p, k + l);
        p->rests[k] = !any;
        if (!any) return 0;
    }
    const doubles changed = doubles_select(awake, solve(p, b, count, awake), corrected);
    doubles_store(&p->corrected[k], changed);
    double greatest = 0;
    for (int l = 0; l < LANES; l++) greatest = changed[l] > greatest ? changed[l] : greatest;
    return greatest;
}

// Nodes on quadrilaterals are the most: loops over their entries have no branches.
double brunt_block_solve(const brunt_constraint_set *p, block *b) {
    return b->count == BRUNT_BLOCK_ENTRIES ? sweep(p, b, BRUNT_BLOCK_ENTRIES) : sweep(p, b, b->count);
}

void brunt_block_take_back(block *b) {
    const doubles zero = {0};
    b->normal_impulse = zero, b->slips = (doubles_mask){0};
    for (int a = 0; a < 3; a++) b->friction_impulse[a] = zero;
}

void brunt_block_finish(brunt_constraint_set *p, int64_t at) {
    const block *b = &p->block[at];
    for (int l = 0; l < LANES && (at + 2) * LANES <= p->constraint_count; l++)
        __builtin_prefetch(&p->constraint[(at + 1) * LANES + l].scale, 1),
            __builtin_prefetch(&p->constraint[(at + 1) * LANES + l].slips, 1);
    fours push, rub;
    part(&push, b->scale, b->row_sum, b->row_sum_t, b->normal_impulse);
    part(&rub, b->friction_impulse[0], b->friction_impulse[1], b->friction_impulse[2], (doubles)b->slips);
    for (int l = 0; l < LANES; l++) {
        brunt_constraint *c = &p->constraint[at * LANES + l];
        const double *one = four_of(&push, l);
        c->scale = one[0], c->row_sum = one[1], c->row_sum_t = one[2], c->normal_impulse = one[3];
        memcpy(c->friction_impulse, four_of(&rub, l), sizeof c->friction_impulse);
        c->slips = b->slips[l];
    }
}

void brunt_block_rates(const brunt_constraint_set *p, int64_t at) {
    const block *b = &p->block[at];
    struct brunt_constraint_rates *rates = &p->rates[at * LANES];
    doubles old[3], now[3];
    relative_velocity(p->before, b, b->count, old), relative_velocity(p->now, b, b->count, now);
    fours before, after;
    part(&before, old[0], old[1], old[2], old[2]), part(&after, now[0], now[1], now[2], now[2]);
    for (int l = 0; l < LANES; l++) {
        memcpy(rates[l].old, four_of(&before, l), sizeof rates[l].old);
        memcpy(rates[l].now, four_of(&after, l), sizeof rates[l].now);
    }
}
