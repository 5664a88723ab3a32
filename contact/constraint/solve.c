#include "contact/constraint/constraint.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"

enum { GRAIN = 128 };

void brunt_constraints_clear(brunt_constraint_set *p) {
    p->point_count = p->entry_count = p->lever_count = p->support_count = 0;
}

void brunt_constraints_free(brunt_constraint_set *p) {
    brunt_free(p->point);
    brunt_free(p->entry);
    brunt_free(p->lever);
    brunt_free(p->support);
    brunt_free(p->pressing);
    brunt_free(p->pressing_first);
    brunt_free(p->given);
    brunt_free(p->changed);
    memset(p, 0, sizeof *p);
}

#define ADD(p, what)                                                                                                   \
    (BRUNT_GROW((p)->what) ? -1 : (memset(&(p)->what[(p)->what##_count], 0, sizeof *(p)->what), (p)->what##_count++))

int32_t brunt_constraints_dof_node(brunt_constraint_set *p) { return ADD(p, support); }

int32_t brunt_constraints_add(brunt_constraint_set *p) {
    int32_t at = ADD(p, point);
    if (at >= 0) p->point[at].first = p->entry_count;
    return at;
}

int32_t brunt_constraints_entry(brunt_constraint_set *p, int32_t support, double weight) {
    int32_t at = ADD(p, entry);
    if (at < 0) return -1;
    p->entry[at].support = support;
    for (int a = 0; a < 3; a++) p->entry[at].weight[a] = weight;
    p->point[p->point_count - 1].count++;
    return at;
}

int32_t brunt_constraints_friction_point(brunt_constraint_set *p, const double x[3]) {
    const int32_t at = ADD(p, lever), first = p->entry_count;
    brunt_constraint *point = &p->point[p->point_count - 1];
    if (at < 0) return -1;
    memcpy(p->lever[at].x, x, sizeof p->lever[at].x);
    for (int32_t e = 0; e < point->count; e++) {
        const int32_t entry = ADD(p, entry);
        if (entry < 0) return -1;
        p->entry[entry].support = p->entry[point->first + e].support;
    }
    point->lever = at + 1;
    return first;
}

int brunt_constraints_reserve(brunt_constraint_set *p, int32_t points, int32_t entries) {
    return BRUNT_RESERVE(p->point, (size_t)points + 1, (size_t)p->point_count) ||
                   BRUNT_RESERVE(p->entry, (size_t)entries + 1, (size_t)p->entry_count)
               ? -1
               : 0;
}

// `first`: of the entries that are weighed.
static void velocity(const brunt_constraint_set *p, const brunt_constraint *point, int32_t first, bool old,
                     double u[3]) {
    for (int a = 0; a < 3; a++) u[a] = -point->plane[a];
    for (int32_t e = first; e < first + point->count; e++) {
        const brunt_constraint_entry *entry = &p->entry[e];
        const double *v = old ? p->support[entry->support].old : p->support[entry->support].v;
        double rise = point->facet[0] * v[0] + point->facet[1] * v[1] + point->facet[2] * v[2];
        for (int a = 0; a < 3; a++) u[a] += entry->weight[a] * v[a] + rise * entry->turn[a];
    }
}

void brunt_constraint_velocity(const brunt_constraint_set *p, const brunt_constraint *point, bool old, double u[3]) {
    velocity(p, point, point->first, old, u);
}

// What an entry gives its support of the point's impulse: the transpose of the above.
static void give(const brunt_constraint *point, const brunt_constraint_entry *entry, const double J[3], double out[3]) {
    double turn = entry->turn[0] * J[0] + entry->turn[1] * J[1] + entry->turn[2] * J[2];
    for (int a = 0; a < 3; a++) out[a] = entry->weight[a] * J[a] + turn * point->facet[a];
}

static struct brunt_pressing pressing_of(int32_t point, const brunt_constraint_entry *entry) {
    return (struct brunt_pressing){point,
                                   {entry->weight[0], entry->weight[1], entry->weight[2]},
                                   {entry->turn[0], entry->turn[1], entry->turn[2]}};
}

// Entries by support, in the order of the points, each with that of its lever.
static int transpose(brunt_constraint_set *p) {
    size_t entries = (size_t)p->entry_count + 1, supports = (size_t)p->support_count + 1,
           points = (size_t)p->point_count + (size_t)p->lever_count + 1;
    if (BRUNT_RESERVE(p->pressing, entries, 0) || BRUNT_RESERVE(p->pressing_first, supports + 1, 0) ||
        BRUNT_RESERVE(p->given, points, 0) || BRUNT_RESERVE(p->changed, points / GRAIN + 2, 0))
        return -1;
    int32_t *first = p->pressing_first;
    memset(first, 0, (supports + 1) * sizeof(int32_t));
    for (int32_t e = 0; e < p->entry_count; e++) first[p->entry[e].support + 2]++;
    for (size_t s = 2; s <= supports; s++) first[s] += first[s - 1];
    for (int32_t k = 0; k < p->point_count; k++) {
        const brunt_constraint *point = &p->point[k];
        const int32_t lever = p->point_count + point->lever - 1;
        memcpy(p->given[k].facet, point->facet, sizeof point->facet);
        if (point->lever) memcpy(p->given[lever].facet, point->facet, sizeof point->facet);
        for (int32_t e = point->first; e < point->first + point->count; e++) {
            int32_t *at = &first[p->entry[e].support + 1];
            p->pressing[(*at)++] = pressing_of(k, &p->entry[e]);
            if (point->lever) p->pressing[(*at)++] = pressing_of(lever, &p->entry[e + point->count]);
        }
    }
    return 0;
}

// Effective mass of each point alone. Points that nothing can move (all masses infinite) get 0.
static void weigh_points(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t k = begin * GRAIN; k < end * GRAIN && k < p->point_count; k++) {
        brunt_constraint *point = &p->point[k];
        double alone = 0;
        for (int32_t e = point->first; e < point->first + point->count; e++) {
            double J[3];
            give(point, &p->entry[e], point->n, J);
            const double *inverse = p->support[p->entry[e].support].inverse;
            for (int a = 0; a < 3; a++) alone += J[a] * J[a] * inverse[a];
        }
        point->scale = alone > 0 ? 1 / alone : 0;
    }
}

static double greatest(const double weight[3]) { return fmax(fabs(weight[0]), fmax(fabs(weight[1]), fabs(weight[2]))); }

static void load_supports(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t s = begin * GRAIN; s < end * GRAIN && s < p->support_count; s++) {
        double load = 0;
        for (int32_t q = p->pressing_first[s]; q < p->pressing_first[s + 1]; q++) {
            const struct brunt_pressing *by = &p->pressing[q];
            double most = greatest(by->weight);
            if (p->point[by->point].lever) most = fmax(most, greatest(p->pressing[++q].weight));
            load += most * p->point[by->point].scale;
        }
        p->support[s].load = load;
    }
}

// Row sums, in units of the effective masses.
static void sum_rows(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t k = begin * GRAIN; k < end * GRAIN && k < p->point_count; k++) {
        brunt_constraint *point = &p->point[k];
        double along[3] = {0};
        for (int32_t e = point->first; e < point->first + point->count; e++) {
            const brunt_dof_node *s = &p->support[p->entry[e].support];
            const double *weight = p->entry[e].weight, *other = p->entry[e + (point->lever ? point->count : 0)].weight;
            for (int a = 0; a < 3; a++) along[a] += fmax(fabs(weight[a]), fabs(other[a])) * s->load * s->inverse[a];
        }
        for (int a = 0; a < 3; a++) {
            point->response += point->n[a] * point->n[a] * along[a];
            point->response_t = fmax(point->response_t, along[a]);
        }
        point->response = fmax(point->response, 1);
        point->response_t = fmax(point->response_t, 1);
    }
}

// Brings one point to its condition, as far as it is concerned; the impulse goes to `J`, that of friction to `rub`,
// which is the same without a lever. Returns the velocity it is worth [m/s].
static double visit(const brunt_constraint_set *p, brunt_constraint *point, double J[3], double rub[3]) {
    for (int a = 0; a < 3; a++) J[a] = rub[a] = 0;
    if (!(point->scale > 0)) return 0;
    double u[3], along = 0;
    brunt_constraint_velocity(p, point, false, u);
    for (int a = 0; a < 3; a++) along += u[a] * point->n[a];
    double unit = point->scale / point->response;
    double push = fmax(0, point->push + (point->target - along) * unit), step = push - point->push;
    point->push = push;
    double changed = fabs(step) / unit;
    for (int a = 0; a < 3; a++) J[a] = step * point->n[a];
    if (point->friction > 0) {
        double drag[3], size = 0, moved = 0, unit_t = point->scale / point->response_t;
        if (point->lever) {
            velocity(p, point, point->first + point->count, false, u);
            along = u[0] * point->n[0] + u[1] * point->n[1] + u[2] * point->n[2];
        }
        for (int a = 0; a < 3; a++) {
            drag[a] = point->drag[a] - (u[a] - along * point->n[a]) * unit_t;
            size += drag[a] * drag[a];
        }
        size = sqrt(size);
        double most = point->friction * push;
        point->slips = size > most;
        double share = point->slips ? most / size : 1;
        for (int a = 0; a < 3; a++) {
            double now = share * drag[a], add = now - point->drag[a];
            rub[a] += add;
            moved += add * add;
            point->drag[a] = now;
        }
        changed = fmax(changed, sqrt(moved) / unit_t);
    }
    return changed;
}

static void visit_points(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t c = begin; c < end; c++) {
        double most = 0;
        for (int32_t k = (int32_t)c * GRAIN; k < (c + 1) * GRAIN && k < p->point_count; k++) {
            const int32_t lever = p->point[k].lever;
            double *J = p->given[k].impulse, *rub = lever ? p->given[p->point_count + lever - 1].impulse : J;
            double changed = visit(p, &p->point[k], J, rub);
            most = changed > most ? changed : most;
        }
        p->changed[c] = most;
    }
}

static void move_supports(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t s = begin * GRAIN; s < end * GRAIN && s < p->support_count; s++) {
        double sum[3] = {0};
        for (int32_t q = p->pressing_first[s]; q < p->pressing_first[s + 1]; q++) {
            const struct brunt_pressing *by = &p->pressing[q];
            const struct brunt_given *given = &p->given[by->point];
            const double *J = given->impulse, turn = by->turn[0] * J[0] + by->turn[1] * J[1] + by->turn[2] * J[2];
            for (int a = 0; a < 3; a++) sum[a] += by->weight[a] * J[a] + turn * given->facet[a];
        }
        brunt_dof_node *support = &p->support[s];
        for (int a = 0; a < 3; a++) {
            support->impulse[a] += sum[a];
            support->v[a] += sum[a] * support->inverse[a];
        }
    }
}

static void book(brunt_constraint_set *p) {
    for (int32_t k = 0; k < p->point_count; k++) {
        const brunt_constraint *point = &p->point[k];
        if (!(point->push > 0)) continue;
        point->action->area += point->area;
        double old[3], now[3], push[3], drag[3], x[3];
        brunt_constraint_velocity(p, point, true, old);
        brunt_constraint_velocity(p, point, false, now);
        for (int a = 0; a < 3; a++) {
            // The account is of the second body: the slave's impulse, or the reaction to it.
            push[a] = point->sign * point->push * point->n[a], drag[a] = point->sign * point->drag[a];
            old[a] = point->sign * (old[a] + point->plane[a]), now[a] = point->sign * (now[a] + point->plane[a]);
            x[a] = point->x[a];
        }
        brunt_impulse_account_book(point->action, &point->action->normal_loss, push, x, old, now, point->plane);
        if (point->lever) {
            velocity(p, point, point->first + point->count, true, old);
            velocity(p, point, point->first + point->count, false, now);
            for (int a = 0; a < 3; a++) {
                old[a] = point->sign * (old[a] + point->plane[a]), now[a] = point->sign * (now[a] + point->plane[a]);
                x[a] = p->lever[point->lever - 1].x[a];
            }
        }
        if (point->friction > 0)
            brunt_impulse_account_book(point->action, &point->action->friction_loss, drag, x, old, now, point->plane);
    }
}

int brunt_constraints_solve(brunt_constraint_set *p, int sweeps, double tolerance, int threads, brunt_timer *timer) {
    if (!p->point_count) return 0;
    if (transpose(p)) return -1;
    const int64_t chunks = (p->point_count + GRAIN - 1) / GRAIN, groups = (p->support_count + GRAIN - 1) / GRAIN;
    brunt_parallel(threads, chunks, 1, weigh_points, p, timer);
    brunt_parallel(threads, groups, 1, load_supports, p, timer);
    brunt_parallel(threads, chunks, 1, sum_rows, p, timer);
    double first = 0;
    int sweep = 0;
    while (sweep < sweeps) {
        brunt_parallel(threads, chunks, 1, visit_points, p, timer);
        brunt_parallel(threads, groups, 1, move_supports, p, timer);
        sweep++;
        double most = 0;
        for (int64_t c = 0; c < chunks; c++) most = fmax(most, p->changed[c]);
        first = fmax(first, most);
        if (most <= tolerance * first) break;
    }
    book(p);
    return sweep;
}
