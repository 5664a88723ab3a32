#include "contact/constraint/coulomb.h"
#include "contact/constraint/constraint.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "base/quad.h"
#include "contact/constraint/acceleration.h"
#include "contact/constraint/accounts.h"
#include "contact/constraint/block.h"
#include "contact/constraint/parts.h"
#include "contact/constraint/release.h"
#include "contact/constraint/rest.h"

enum { GRAIN = BRUNT_CONSTRAINT_GRAIN, AHEAD = 40 }; // AHEAD: entries that are fetched before a node adds them up
_Static_assert(GRAIN % BRUNT_DOUBLES == 0, "a chunk is whole blocks");
static const double DIVERGES = 10;  // times the correction of the first sweep is left
static const double AT_REST = 0.02; // of the correction that ends the sweeps: what corrects less may rest
static const double PARALLEL = sizeof(real) == sizeof(double) ? 1e-9 : 1e-5; // unit vectors that differ by rounding

// Of a degree-of-freedom node, before the forces or as it is now.
static inline const double *velocity_of(const brunt_constraint_set *p, int32_t node, bool old) {
    return old ? p->dof_node[node].old : p->now ? p->now[node] : p->dof_node[node].v;
}

// Of what does not turn, with the weights of `entry` and the `count` - 1 after it. Quads here are three components and
// a number that does not count: whatever follows them in memory.
static inline quad plain_velocity(const brunt_constraint_set *p, const brunt_constraint_entry *entry, int32_t count,
                                  bool old) {
    quad u = {0};
    for (const brunt_constraint_entry *end = entry + count; entry < end; entry++) {
        u += quad_load(entry->weight) * quad_load(velocity_of(p, entry->dof_node, old));
    }
    return u;
}

static void turning_velocity(const brunt_constraint_set *p, const brunt_constraint *constraint, int32_t first, bool old,
                             double u[3]) {
    for (int a = 0; a < 3; a++) u[a] = -constraint->plane[a];
    for (int32_t e = first; e < first + constraint->count; e++) {
        const brunt_constraint_entry *entry = &p->entry[e];
        const double *v = velocity_of(p, entry->dof_node, old);
        double rise = constraint->facet[0] * v[0] + constraint->facet[1] * v[1] + constraint->facet[2] * v[2];
        for (int a = 0; a < 3; a++) u[a] += entry->weight[a] * v[a] + rise * entry->height_gradient[a];
    }
}

// `first`: of the entries that are weighed.
static void velocity(const brunt_constraint_set *p, const brunt_constraint *constraint, int32_t first, bool old,
                     double u[3]) {
    if (constraint->turns) {
        turning_velocity(p, constraint, first, old, u);
        return;
    }
    const quad plain = plain_velocity(p, &p->entry[first], constraint->count, old);
    for (int a = 0; a < 3; a++) u[a] = plain[a] - constraint->plane[a];
}

void brunt_constraint_velocity(const brunt_constraint_set *p, const brunt_constraint *constraint, bool old,
                               double u[3]) {
    velocity(p, constraint, constraint->first, old, u);
}

void brunt_constraint_slip(const brunt_constraint_set *p, const brunt_constraint *constraint, bool old, double u[3]) {
    velocity(p, constraint, constraint->first + constraint->count, old, u);
}

// What an entry gives its degree-of-freedom node of the point's impulse: the transpose of the above.
static void apply_transpose(const brunt_constraint *constraint, const brunt_constraint_entry *entry, const double J[3],
                            double out[3]) {
    const double *gradient = entry->height_gradient,
                 rise = gradient[0] * J[0] + gradient[1] * J[1] + gradient[2] * J[2];
    for (int a = 0; a < 3; a++) out[a] = entry->weight[a] * J[a] + rise * constraint->facet[a];
}

// What constraints that do not turn give (brunt_constraint_give).
static void give_plain(const brunt_constraint_set *p, const brunt_constraint *constraint, const double push[3],
                       const double rub[3]) {
    const quad pushed = {push[0], push[1], push[2]}, rubbed = {rub[0], rub[1], rub[2]};
    for (int32_t e = constraint->first; e < constraint->first + constraint->count; e++) {
        const int32_t s = p->entry[e].dof_node;
        const quad out = quad_load(p->entry[e].weight) * pushed, sum = p->shared[s] ? out : quad_load(p->sum[s]) + out;
        memcpy(p->shared[s] ? p->given[e] : p->sum[s], &sum, sizeof sum);
        if (!constraint->friction_point) continue;
        const quad apart = quad_load(p->entry[e + constraint->count].weight) * rubbed;
        memcpy(p->given[e + constraint->count], &apart, sizeof apart);
    }
}

void brunt_constraint_give(const brunt_constraint_set *p, const brunt_constraint *constraint, const double push[3],
                           const double rub[3]) {
    if (!constraint->turns) {
        give_plain(p, constraint, push, rub);
        return;
    }
    for (int32_t e = constraint->first; e < constraint->first + constraint->count; e++) {
        const int32_t s = p->entry[e].dof_node;
        double out[3];
        apply_transpose(constraint, &p->entry[e], push, p->shared[s] ? p->given[e] : out);
        for (int a = 0; a < 3 && !p->shared[s]; a++) p->sum[s][a] += out[a];
        if (constraint->friction_point)
            apply_transpose(constraint, &p->entry[e + constraint->count], rub, p->given[e + constraint->count]);
    }
}

static int reserve_sweeps(brunt_constraint_set *p, brunt_error *error) {
    const size_t points = (size_t)p->constraint_count + (size_t)p->friction_point_count + 1;
    const size_t nodes = (size_t)p->dof_node_count + 1;
    return BRUNT_CAPACITY(p->state, nodes, 0, "nodes that contact moves", error) ||
                   BRUNT_CAPACITY(p->before, nodes, 0, "nodes that contact moves", error) ||
                   BRUNT_CAPACITY(p->rates, points, 0, "contact points", error) ||
                   BRUNT_CAPACITY(p->inverse, nodes, 0, "nodes that contact moves", error) ||
                   BRUNT_CAPACITY(p->received, nodes, 0, "nodes that contact moves", error) ||
                   BRUNT_CAPACITY(p->sum, nodes, 0, "nodes that contact moves", error) ||
                   BRUNT_CAPACITY(p->load, nodes, 0, "nodes that contact moves", error) ||
                   BRUNT_CAPACITY(p->block, points / BRUNT_DOUBLES + 1, (size_t)p->open_blocks,
                                  "blocks of contact points", error) ||
                   BRUNT_CAPACITY(p->changed, points / GRAIN + 2, 0, "groups of contact points", error) ||
                   BRUNT_CAPACITY(p->recorded, points / GRAIN + 2, 0, "groups of contact points", error) ||
                   (p->gives_back && brunt_release_begin(p, error))
               ? BRUNT_FAILED
               : BRUNT_OK;
}

// The block that begins with constraint k, or NULL: it is on its own.
static brunt_constraint_block *block_at(const brunt_constraint_set *p, int64_t k) {
    brunt_constraint_block *block = &p->block[k / BRUNT_DOUBLES];
    return block->count ? block : NULL;
}
static int64_t after(const brunt_constraint_set *p, int64_t k) { return block_at(p, k) ? k + BRUNT_DOUBLES : k + 1; }

// Effective mass of each point alone, without its images: half of a body is then solved as the whole is. Points that
// nothing can move (all masses infinite) get 0.
static void weigh_constraint(const brunt_constraint_set *p, brunt_constraint *constraint) {
    double alone = -constraint->image;
    for (int32_t e = constraint->first; e < constraint->first + constraint->count; e++) {
        double J[3];
        apply_transpose(constraint, &p->entry[e], constraint->n, J);
        const double *inverse = p->dof_node[p->entry[e].dof_node].inverse;
        for (int a = 0; a < 3; a++) alone += J[a] * J[a] * inverse[a];
    }
    constraint->scale = alone > 0 ? 1 / alone : 0;
}

static void make_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t k = begin * GRAIN; k < end * GRAIN && k < p->constraint_count; k += BRUNT_DOUBLES)
        brunt_block_make(p, k / BRUNT_DOUBLES);
}

static double greatest_component(const double weight[3]) {
    return fmax(fabs(weight[0]), fmax(fabs(weight[1]), fabs(weight[2])));
}

// What turning a facet under a point of contact adds to the most of its impulse that a node gets. Of facets that are
// wide beside the height of that point it is small, and only slows the sweeps down: it counts where they diverge
// without.
static double lever(const brunt_constraint_set *p, const double height_gradient[3]) {
    return p->levers ? brunt_coulomb_norm(3, height_gradient) : 0;
}

// The most of its impulse that an entry gives a component of its node.
static double share_of(const brunt_constraint_set *p, const brunt_constraint_entry *entry) {
    return p->dof_node[entry->dof_node].angular ? brunt_coulomb_norm(3, entry->height_gradient)
                                                : greatest_component(entry->weight) + lever(p, entry->height_gradient);
}

// Weighs it, too.
static void share_constraint(const brunt_constraint_set *p, brunt_constraint *constraint) {
    weigh_constraint(p, constraint);
    for (int32_t e = constraint->first; e < constraint->first + constraint->count; e++) {
        const double push = share_of(p, &p->entry[e]);
        const double rub = constraint->friction_point ? share_of(p, &p->entry[e + constraint->count]) : push;
        const double share[4] = {push, rub, fmax(push, rub), constraint->scale};
        const int32_t s = p->entry[e].dof_node;
        if (p->shared[s])
            memcpy(p->given[e], share, sizeof share);
        else
            p->load[s][0] += push * constraint->scale;
    }
}

static void share_constraints(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_constraint_set *p = context;
    for (int64_t k = begin * GRAIN; k < end * GRAIN && k < p->constraint_count; k = after(p, k)) {
        if (block_at(p, k))
            brunt_block_share(p, block_at(p, k));
        else
            share_constraint(p, &p->constraint[k]);
    }
}

// Whether diagonal matrix D leaves unit vector n in its direction.
static bool keeps_direction(const double D[3], const double n[3]) {
    const int one = fabs(n[0]) > PARALLEL ? 0 : fabs(n[1]) > PARALLEL ? 1 : 2;
    for (int a = one + 1; a < 3; a++)
        if (fabs(n[a]) > PARALLEL && D[a] != D[one]) return false;
    return true;
}

// Whether what is pushed with along a degree-of-freedom node's `normal` may turn up across it: constraints with other
// normals, or the turning of a facet.
static bool is_crossed(const brunt_constraint_set *p, const double normal[3],
                       const struct brunt_constraint_column *column) {
    const double *n = p->constraint[column->constraint].n, *gradient = p->entry[column->entry].height_gradient;
    for (int a = 0; a < 3; a++)
        if (fabs(n[a] - normal[a]) > PARALLEL || gradient[a] != 0) return true;
    return !keeps_direction(p->entry[column->entry].weight, normal);
}

// Whether that is so of any of a node's constraints. Without friction points what pushes and what rubs are the same
// weights, and both loads as well.
static bool crosses(const brunt_constraint_set *p, const brunt_dof_node *node, int32_t first, int32_t last) {
    if (!p->friction_point_count || first == last) return false;
    const double *normal = p->constraint[p->column[first].constraint].n;
    bool crossed = !keeps_direction(node->inverse, normal);
    for (int32_t q = first; q < last && !crossed; q++) {
        crossed = is_crossed(p, normal, &p->column[q]);
        if (p->constraint[p->column[q].constraint].friction_point) q++;
    }
    return crossed;
}

// As before the first sweep.
static void begin_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t s = begin * GRAIN; s < end * GRAIN && s < p->dof_node_count; s++) {
        const brunt_dof_node *node = &p->dof_node[s];
        for (int a = 0; a < 3; a++)
            p->now[s][a] = node->v[a], p->before[s][a] = node->old[a], p->inverse[s][a] = node->inverse[a],
            p->received[s][a] = node->impulse[a];
        p->now[s][3] = p->before[s][3] = p->inverse[s][3] = p->received[s][3] = 0;
        if (node->angular) __atomic_store_n(&p->levered, true, __ATOMIC_RELAXED); // several threads may
        memset(p->sum[s], 0, sizeof *p->sum);
        memset(p->load[s], 0, sizeof *p->load);
    }
}

// What constraints with friction points push and rub with are different weights. Where the two do not cross, each has
// its own load; else both have the greater. Without any the load of what rubs is not looked at.
static void load_dof_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t s = begin * GRAIN; s < end * GRAIN && s < p->dof_node_count; s++) {
        brunt_dof_node *node = &p->dof_node[s];
        double push = 0, rub = 0, both = 0;
        if (!p->shared[s]) continue; // what was added up
        const int32_t first = p->column_first[s], last = p->column_first[s + 1];
        node->crossed = crosses(p, node, first, last);
        for (int32_t q = first; q < last; q++) {
            const double *share = p->given[p->column[q].entry], scale = share[3];
            push += share[0] * scale, rub += share[1] * scale, both += share[2] * scale;
            if (p->friction_point_count && p->constraint[p->column[q].constraint].friction_point) q++;
        }
        p->load[s][0] = node->crossed ? both : push, p->load[s][1] = node->crossed ? both : rub;
    }
}

// What the pushes on a node weigh, and what its friction does.
typedef struct node_load {
    double push, rub;
} node_load;

static node_load load_of(const brunt_constraint_set *p, int32_t node) {
    return (node_load){p->load[node][0], p->load[node][p->friction_point_count > 0]};
}

// The part of an angular velocity in the row sums of an entry that pushes and of one that rubs.
static void add_levers(const brunt_constraint_set *p, const brunt_constraint_entry *own,
                       const brunt_constraint_entry *rubs, double along[3], double across[3]) {
    const brunt_dof_node *s = &p->dof_node[own->dof_node];
    const node_load load = load_of(p, own->dof_node);
    for (int a = 0; a < 3; a++) {
        const double push = fabs(own->height_gradient[a]), rub = fabs(rubs->height_gradient[a]), both = fmax(push, rub);
        along[a] += (s->crossed ? both : push) * load.push * s->inverse[0];
        across[a] += (s->crossed ? both : rub) * load.rub * s->inverse[0];
    }
}

// What a spring that is overlapped pushes with, no more than what throws it out twice as fast as it is deep.
static double spring_impulse(const brunt_constraint_set *p, const brunt_constraint *constraint) {
    return fmax(0, -constraint->gap) *
           fmin(p->kick * constraint->spring, 2 * constraint->scale / (constraint->row_sum * p->kick));
}

// Row sums, in units of the effective masses.
static void sum_row(const brunt_constraint_set *p, brunt_constraint *constraint) {
    double along[3] = {0}, across[3] = {0};
    constraint->row_sum = constraint->row_sum_t = 0;
    for (int32_t e = constraint->first; e < constraint->first + constraint->count; e++) {
        const brunt_dof_node *s = &p->dof_node[p->entry[e].dof_node];
        const brunt_constraint_entry *own = &p->entry[e],
                                     *rubs = own + (constraint->friction_point ? constraint->count : 0);
        if (s->angular) {
            add_levers(p, own, rubs, along, across);
            continue;
        }
        const node_load load = load_of(p, own->dof_node);
        const double *weight = own->weight, *other = rubs->weight, turn = lever(p, own->height_gradient),
                     rub_turn = lever(p, rubs->height_gradient);
        for (int a = 0; a < 3; a++) {
            const double push = fabs(weight[a]) + turn, rub = fabs(other[a]) + rub_turn, both = fmax(push, rub);
            along[a] += (s->crossed ? both : push) * load.push * s->inverse[a];
            across[a] += (s->crossed ? both : rub) * load.rub * s->inverse[a];
        }
    }
    for (int a = 0; a < 3; a++) {
        constraint->row_sum += constraint->n[a] * constraint->n[a] * along[a];
        constraint->row_sum_t = fmax(constraint->row_sum_t, across[a]);
    }
    constraint->row_sum = fmax(constraint->row_sum, 1);
    constraint->row_sum_t = fmax(constraint->row_sum_t, 1);
    if (constraint->spring > 0) constraint->least = spring_impulse(p, constraint);
}

static void sum_rows(brunt_constraint_set *p, int64_t begin, int64_t end) {
    for (int64_t k = begin * GRAIN; k < end * GRAIN && k < p->constraint_count; k = after(p, k)) {
        if (block_at(p, k))
            brunt_block_sum_rows(p, block_at(p, k));
        else
            sum_row(p, &p->constraint[k]);
    }
}

// Brings what is left of slip, of relative velocity u, to what friction allows; the impulse is added to `rub`. Returns
// the velocity it is worth [m/s].
static double rub_with(const brunt_constraint_set *p, brunt_constraint *constraint, double u[3], double rub[3]) {
    const double unit_t = constraint->scale / constraint->row_sum_t;
    if (constraint->friction_point) velocity(p, constraint, constraint->first + constraint->count, false, u);
    const double along = u[0] * constraint->n[0] + u[1] * constraint->n[1] + u[2] * constraint->n[2];
    double wanted[3], change[3];
    for (int a = 0; a < 3; a++)
        wanted[a] = constraint->friction_impulse[a] - (u[a] - along * constraint->n[a]) * unit_t;
    constraint->slips =
        brunt_coulomb_project(3, constraint->friction, constraint->sticks ? INFINITY : constraint->normal_impulse,
                              wanted, constraint->friction_impulse, change);
    for (int a = 0; a < 3; a++) rub[a] += change[a];
    return brunt_coulomb_norm(3, change) / unit_t;
}

// Brings one point to its condition, as far as it is concerned; the impulse goes to `J`, that of friction to `rub`,
// which is the same without a friction point. Returns the velocity it is worth [m/s].
static double solve_constraint(const brunt_constraint_set *p, brunt_constraint *constraint, double J[3],
                               double rub[3]) {
    for (int a = 0; a < 3; a++) J[a] = rub[a] = 0;
    if (!(constraint->scale > 0)) return 0;
    double u[3], along = 0;
    brunt_constraint_velocity(p, constraint, false, u);
    for (int a = 0; a < 3; a++) along += u[a] * constraint->n[a];
    double unit = constraint->scale / constraint->row_sum;
    const double step =
        brunt_coulomb_bound(&constraint->normal_impulse, constraint->least, (constraint->target - along) * unit);
    const double changed = fabs(step) / unit;
    for (int a = 0; a < 3; a++) J[a] = step * constraint->n[a];
    return constraint->friction > 0 ? fmax(changed, rub_with(p, constraint, u, rub)) : changed;
}

void brunt_constraint_rub(const brunt_constraint_set *p, brunt_constraint *constraint, double rub[3]) {
    double u[3];
    brunt_constraint_velocity(p, constraint, false, u);
    rub_with(p, constraint, u, rub);
}

// Begins a sweep with a share of the last one's correction on top. What it had before goes to `past`.
static void extrapolate(double momentum, brunt_constraint *constraint, struct brunt_constraint_past *past) {
    const struct brunt_constraint_past now = {
        constraint->normal_impulse,
        {constraint->friction_impulse[0], constraint->friction_impulse[1], constraint->friction_impulse[2]}};
    constraint->normal_impulse += momentum * (now.normal_impulse - past->normal_impulse);
    for (int a = 0; a < 3; a++)
        constraint->friction_impulse[a] += momentum * (now.friction_impulse[a] - past->friction_impulse[a]);
    *past = now;
}

// How much of a sweep's correction, which began from `from`, goes back on that of all since `past` [m^2 kg/s^2].
static double turned_back(const brunt_constraint *constraint, const struct brunt_constraint_past *from,
                          const struct brunt_constraint_past *past) {
    if (!(constraint->scale > 0)) return 0;
    double friction = 0;
    for (int a = 0; a < 3; a++)
        friction += (from->friction_impulse[a] - constraint->friction_impulse[a]) *
                    (constraint->friction_impulse[a] - past->friction_impulse[a]);
    return ((from->normal_impulse - constraint->normal_impulse) * (constraint->normal_impulse - past->normal_impulse) *
                constraint->row_sum +
            friction * constraint->row_sum_t) /
           constraint->scale;
}

// Adds to `back` how much of its correction goes back, of accelerated sweeps.
static double sweep_constraint(brunt_constraint_set *p, int64_t k, double *back) {
    brunt_constraint *constraint = &p->constraint[k];
    double J[3], apart[3], *rub = constraint->friction_point ? apart : J;
    struct brunt_constraint_past from = {0};
    if (p->accelerated) {
        extrapolate(p->momentum, constraint, &p->point_past[k]);
        from.normal_impulse = constraint->normal_impulse;
        memcpy(from.friction_impulse, constraint->friction_impulse, sizeof from.friction_impulse);
    }
    if (p->still > 0 && brunt_constraint_rests(p, k)) return 0;
    const double changed = p->corrected[k] = solve_constraint(p, constraint, J, rub);
    if (p->accelerated) *back += turned_back(constraint, &from, &p->point_past[k]);
    brunt_constraint_give(p, constraint, J, rub);
    return changed;
}

static void solve_chunks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t c = begin; c < end; c++) {
        double greatest = 0, back = 0;
        for (int64_t k = c * GRAIN; k < (c + 1) * GRAIN && k < p->constraint_count; k = after(p, k)) {
            brunt_constraint_block *block = block_at(p, k);
            const double changed = block ? brunt_block_solve(p, block) : sweep_constraint(p, k, &back);
            greatest = changed > greatest ? changed : greatest;
        }
        p->changed[c] = greatest;
        if (p->accelerated) p->turned_back[c] = back;
    }
}

// The first sweep, while the rows that are summed up are at hand.
static void begin_chunks(void *context, int64_t begin, int64_t end, int worker) {
    for (int64_t c = begin; c < end; c++) sum_rows(context, c, c + 1), solve_chunks(context, c, c + 1, worker);
}

// The velocities that go with the impulses the next sweep begins with.
static void carry_on(double momentum, double now[3], double received[3], struct brunt_dof_past *past) {
    for (int a = 0; a < 3; a++) {
        const double v = now[a], impulse = received[a];
        now[a] += momentum * (v - past->v[a]);
        received[a] += momentum * (impulse - past->impulse[a]);
        past->v[a] = v, past->impulse[a] = impulse;
    }
}

static quad column_sum(const brunt_constraint_set *p, int64_t s) {
    const int32_t all = p->column_first[p->dof_node_count];
    quad sum = {0};
    for (int32_t q = p->column_first[s]; q < p->column_first[s + 1]; q++) {
        if (q + AHEAD < all) __builtin_prefetch(p->given[p->column[q + AHEAD].entry]);
        sum += quad_load(p->given[p->column[q].entry]);
    }
    return sum;
}

void brunt_constraints_move(const brunt_constraint_set *p, int64_t s) {
    const quad sum = p->shared[s] ? column_sum(p, s) : quad_load(p->sum[s]), zero = {0};
    if (p->still > 0 && sum[0] == 0 && sum[1] == 0 && sum[2] == 0) {
        p->stirred[s] = false;
        return;
    }
    const quad was = quad_load(p->now[s]), now = was + sum * quad_load(p->inverse[s]), by = now - was,
               received = quad_load(p->received[s]) + sum;
    if (p->still > 0) brunt_node_stirs(p, s, sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2]));
    memcpy(p->sum[s], &zero, sizeof zero);
    memcpy(p->now[s], &now, sizeof now), memcpy(p->received[s], &received, sizeof received);
    if (p->accelerated) carry_on(p->momentum, p->now[s], p->received[s], &p->dof_past[s]);
}

static void move_dof_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_constraint_set *p = context;
    for (int64_t s = begin * GRAIN; s < end * GRAIN && s < p->dof_node_count; s++) brunt_constraints_move(p, s);
}

// Those of parts, each by the thread that has swept over it and has them in its cache; with them as many of the shared.
static void move_own_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_constraint_set *p = context;
    const int64_t shared = p->own_first[p->parts], count = p->own_first[p->parts + 1] - shared;
    for (int64_t part = begin; part < end; part++) {
        for (int64_t i = p->own_first[part]; i < p->own_first[part + 1]; i++) brunt_constraints_move(p, p->own[i]);
        for (int64_t i = count * part / p->parts; i < count * (part + 1) / p->parts; i++)
            brunt_constraints_move(p, p->own[shared + i]);
    }
}

static void rate_chunks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t k = begin * GRAIN; k < end * GRAIN && k < p->constraint_count; k = after(p, k)) {
        if (block_at(p, k)) {
            brunt_block_rates(p, k / BRUNT_DOUBLES);
            continue;
        }
        brunt_constraint_velocity(p, &p->constraint[k], true, p->rates[k].old);
        brunt_constraint_velocity(p, &p->constraint[k], false, p->rates[k].now);
    }
}

// What has been done, with its rates, to the accounts.
static void account_chunks(void *context, int64_t begin, int64_t end, int worker) {
    brunt_constraint_set *p = context;
    rate_chunks(context, begin, end, worker);
    for (int64_t c = begin; c < end; c++) brunt_constraints_record(p, c);
}

// What sweeps have come to, back to the constraints.
static void finish_chunks(void *context, int64_t begin, int64_t end, int worker) {
    brunt_constraint_set *p = context;
    for (int64_t k = begin * GRAIN; k < end * GRAIN && k < p->constraint_count; k += BRUNT_DOUBLES)
        if (block_at(p, k)) brunt_block_finish(p, k / BRUNT_DOUBLES);
    account_chunks(context, begin, end, worker);
    for (int64_t k = begin * GRAIN; k < end * GRAIN && k < p->constraint_count && p->gives_back; k++)
        brunt_release_note(p, k);
}

static void move_all(brunt_constraint_set *p, int threads, brunt_timer *timer) {
    if (p->parts > 1)
        brunt_parallel_each(threads, p->parts, move_own_nodes, p, timer);
    else
        brunt_parallel(threads, (p->dof_node_count + GRAIN - 1) / GRAIN, 1, move_dof_nodes, p, timer);
}

// Constraints have given nothing yet.
static void take_back(brunt_constraint_set *p) {
    for (int32_t k = 0; k < p->constraint_count; k++) {
        brunt_constraint *constraint = &p->constraint[k];
        constraint->normal_impulse = 0;
        memset(constraint->friction_impulse, 0, sizeof constraint->friction_impulse);
        if (k % BRUNT_DOUBLES == 0 && block_at(p, k)) brunt_block_take_back(block_at(p, k));
    }
}

static void end_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t s = begin * GRAIN; s < end * GRAIN && s < p->dof_node_count; s++) {
        memcpy(p->dof_node[s].v, p->now[s], sizeof p->dof_node[s].v);
        memcpy(p->dof_node[s].impulse, p->received[s], sizeof p->dof_node[s].impulse);
    }
}

// Sweeps to the tolerance; `*converges`: what is left is not far more than there was.
static int sweep(brunt_constraint_set *p, int sweeps, double tolerance, int threads, brunt_timer *timer,
                 bool *converges, brunt_error *error) {
    const int64_t chunks = (p->constraint_count + GRAIN - 1) / GRAIN, groups = (p->dof_node_count + GRAIN - 1) / GRAIN;
    brunt_constraints_over_parts(p, threads, share_constraints, timer);
    if (p->parts != 1) brunt_parallel(threads, groups, 1, load_dof_nodes, p, timer); // else none is shared
    double start = 0, first = 0, enough = 0, greatest = INFINITY, weight = 1;
    if (p->accelerated && brunt_acceleration_begin(p, error)) return BRUNT_FAILED;
    if (brunt_rest_begin(p, error)) return BRUNT_FAILED;
    p->sweeps = 0;
    while (p->sweeps < sweeps && !(greatest <= enough)) {
        brunt_constraints_over_parts(p, threads, p->sweeps ? solve_chunks : begin_chunks, timer);
        p->sweeps++;
        greatest = 0;
        for (int64_t c = 0; c < chunks; c++) greatest = fmax(greatest, p->changed[c]);
        first = fmax(first, greatest), enough = fmax(tolerance * first, p->negligible);
        if (p->sweeps == 1) start = first;
        p->still = p->accelerated ? 0 : AT_REST * tolerance * first;
        if (p->accelerated) weight = brunt_acceleration_next(p, chunks, weight);
        if (p->sweeps == sweeps || greatest <= enough) p->momentum = 0;
        move_all(p, threads, timer);
    }
    p->still = 0;
    *converges = greatest <= DIVERGES * start;
    return BRUNT_OK;
}

int brunt_constraints_solve(brunt_constraint_set *p, int sweeps, double tolerance, int threads, brunt_timer *timer,
                            brunt_error *error) {
    bool converges;
    p->sweeps = 0, p->levers = false;
    if (!p->constraint_count) return BRUNT_OK;
    if (reserve_sweeps(p, error)) return BRUNT_FAILED;
    const int64_t chunks = (p->constraint_count + GRAIN - 1) / GRAIN, groups = (p->dof_node_count + GRAIN - 1) / GRAIN;
    p->now = p->state, p->levered = false;
    brunt_parallel(threads, groups, 1, begin_nodes, p, timer);
    brunt_parallel(threads, chunks, 1, make_blocks, p, timer);
    if (brunt_constraints_make_parts(p, threads, timer, error)) return BRUNT_FAILED;
    if (sweep(p, sweeps, tolerance, threads, timer, &converges, error)) return BRUNT_FAILED;
    if (!converges) {
        take_back(p);
        brunt_parallel(threads, groups, 1, begin_nodes, p, timer);
        p->levers = true;
        if (sweep(p, sweeps, tolerance, threads, timer, &converges, error)) return BRUNT_FAILED;
    }
    brunt_parallel(threads, chunks, 1, finish_chunks, p, timer);
    if (p->gives_back) {
        bool gave;
        if (brunt_constraints_release(p, &gave, threads, timer, error)) return BRUNT_FAILED;
        if (gave) brunt_parallel(threads, chunks, 1, account_chunks, p, timer);
    }
    brunt_constraints_account(p);
    brunt_parallel(threads, groups, 1, end_nodes, p, timer);
    p->now = NULL;
    return BRUNT_OK;
}
