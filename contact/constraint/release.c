#include "contact/constraint/release.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/vector.h"
#include "contact/constraint/block.h"

enum { GRAIN = 64, ROUNDS = 16 };
static const double LEAST_PUSH = 1e-9;   // of what would stop it
static const double LEAST_TAKEN = 1e-3;  // of what the impulse would take of its own mass alone
static const double LEAST_MOTION = 1e-6; // of the energy of its motion, whichever way: at least so much is that
static const double LEAST_LEFT = 1e-3;   // of what was held
static const double LAST_LEFT = 0.01;    // of what all hold: rounds end

// What a touch does in a step, of each constraint: by itself, since most steps look at no more of them.
struct brunt_release {
    brunt_touch_energy *touch; // the constraint's
    double taken;              // [J] by its push
    double alone;              // [J] what it would take of its own mass alone
    int32_t partner;           // the constraint's
    bool pushes;               // by more than rounding, as of what slides along a wall
    bool may;                  // one that does not push may give back
};

// What a touch gives back.
struct brunt_kick {
    double impulse; // [N s] given back
    double work;    // [J] of it, beyond what the pushes would have done without
    double pressed; // [m/s] by how much the pushes of the step have changed u_n
    double left;    // [J] of what it is to give back; below 0: too much was given, since others gave beside it
    double push[3]; // [N s] of a round, with friction: what has a touch rubs where it pushes
};
typedef brunt_kick kick;

static double along(const brunt_constraint_set *p, const brunt_constraint *c, bool old) {
    double u[3];
    brunt_constraint_velocity(p, c, old, u);
    return dot(u, c->n);
}

// What the impulses of the step have changed u_n by.
static double pressed(const brunt_constraint_set *p, const brunt_constraint *c) {
    double sum = 0;
    for (int32_t e = c->first; e < c->first + c->count; e++) {
        const brunt_constraint_entry *entry = &p->entry[e];
        const brunt_dof_node *node = &p->dof_node[entry->dof_node];
        double by[3];
        for (int a = 0; a < 3; a++) by[a] = p->received[entry->dof_node][a] * node->inverse[a];
        const double rise = dot(c->facet, by);
        for (int a = 0; a < 3; a++) sum += c->n[a] * (entry->weight[a] * by[a] + rise * entry->height_gradient[a]);
    }
    return sum;
}

int brunt_release_begin(brunt_constraint_set *p, brunt_error *error) {
    return BRUNT_CAPACITY(p->release, (size_t)p->constraint_count, 0, "contact points", error);
}

void brunt_release_note(brunt_constraint_set *p, int64_t k) {
    const brunt_constraint *c = &p->constraint[k];
    brunt_release *r = &p->release[k];
    *r = (brunt_release){.touch = c->touch, .partner = c->partner, .may = c->scale > 0 && c->gap >= -p->shallow};
    if (!c->touch || !(c->normal_impulse > 0)) return;
    const double *old = p->rates[k].old, *now = p->rates[k].now;
    const double motion = dot(old, old) + dot(now, now), J = c->normal_impulse;
    r->pushes = J > LEAST_PUSH * c->scale * sqrt(motion);
    r->alone = 0.5 * fmax(J * J / c->scale, LEAST_MOTION * c->scale * motion);
    if (!r->pushes || !(dot(old, c->n) > -p->leap)) return;
    // What friction gives in a push, where all that push turn the slip about, it has of the pushes.
    const double *F = c->friction_impulse, rubbed = -0.5 * (dot(F, old) + dot(F, now));
    r->taken = -0.5 * J * (dot(old, c->n) + dot(now, c->n)) + fmin(rubbed, 0);
}

// Whether what its touch holds is for a constraint.
static bool is_for(const brunt_release *r) { return !r->touch->partner || r->touch->partner == r->partner; }

// Whether one gives back.
static bool releases(const brunt_release *r) {
    return r->touch && !r->touch->pushed && r->touch->held > 0 && r->may && is_for(r);
}

// Adds what a push has taken. Where nothing is there any more of whom the touch was, what is held of them is lost: it
// would throw off whatever touches next, however light it is. Of several that are new it is of the one that pushes
// most.
static void hold(const brunt_release *r, brunt_touch_energy *touch) {
    if (!touch->same && touch->partner && !touch->pushed) touch->held = fmin(touch->held, 0);
    if (!touch->same && r->alone > touch->alone) touch->partner = r->partner;
    touch->pushed = true;
    touch->held += r->taken;
    touch->alone = fmax(touch->alone, r->alone);
}

// Books what pushes have taken. Whether anything is to be given back.
static bool account_touches(brunt_constraint_set *p) {
    bool any = false;
    const brunt_release *end = p->release + p->constraint_count;
    for (const brunt_release *r = p->release; r < end; r++)
        if (r->touch)
            *r->touch =
                (brunt_touch_energy){.held = r->touch->held, .partner = r->touch->held != 0 ? r->touch->partner : 0};
    for (const brunt_release *r = p->release; r < end; r++)
        if (r->touch && r->touch->partner == r->partner) r->touch->same = true;
    for (const brunt_release *r = p->release; r < end; r++) {
        if (!r->touch) continue;
        r->touch->met++;
        if (r->pushes)
            hold(r, r->touch);
        else if (r->may && is_for(r))
            r->touch->releases++;
    }
    for (const brunt_release *r = p->release; r < end; r++) {
        // What presses without an approach takes rounding alone, the root of which would be a kick.
        if (r->touch && r->touch->held > 0 && r->touch->held < LEAST_TAKEN * r->touch->alone) r->touch->held = 0;
        any = any || releases(r);
    }
    return any;
}

// The share of what is left that may be given: the rest pays for what others of the pair have given too much.
static double payable(const brunt_impulse_account *account) {
    return account->unspent > account->overspent ? 1 - account->overspent / account->unspent : 0;
}

// Whether a constraint gives back, or owes; and its share of what its touch holds or owes.
static bool is_settled(const brunt_release *r) { return releases(r) || (r->touch && r->touch->held < 0); }
static double share(const brunt_release *r) {
    return r->touch->held / (releases(r) ? r->touch->releases : r->touch->met);
}

// Those of a step that give back or owe, which no round changes.
typedef struct round_job {
    brunt_constraint_set *set;
    int32_t settled, kicked; // how many
} round_job;

// Lists them and the nodes of those that give back, and makes their entries: kicks go over single constraints.
static void list_settled(round_job *j) {
    brunt_constraint_set *p = j->set;
    j->settled = j->kicked = 0;
    memset(p->shared, true, (size_t)p->dof_node_count); // but what is listed
    for (int32_t k = 0; k < p->constraint_count; k++) {
        brunt_constraint *c = &p->constraint[k];
        if (!is_settled(&p->release[k])) continue;
        p->settled[j->settled++] = k, p->kicks[k] = (kick){.impulse = 0};
        brunt_block_write_entries(p, k / BRUNT_DOUBLES);
        for (int32_t e = c->first; e < c->first + c->count && releases(&p->release[k]); e++) {
            const int32_t node = p->entry[e].dof_node;
            if (p->shared[node]) p->shared[node] = false, p->kicked[j->kicked++] = node;
        }
    }
}

// What is left, of each constraint, of each pair and in all.
static double sum_left(const round_job *j) {
    const brunt_constraint_set *p = j->set;
    double all = 0;
    for (int32_t i = 0; i < j->settled; i++) {
        brunt_impulse_account *account = p->constraint[p->settled[i]].account;
        account->unspent = account->overspent = 0;
    }
    for (int32_t i = 0; i < j->settled; i++) {
        const int32_t k = p->settled[i];
        brunt_impulse_account *account = p->constraint[k].account;
        const double left = p->kicks[k].left = share(&p->release[k]) - p->kicks[k].work;
        *(left > 0 ? &account->unspent : &account->overspent) += fabs(left);
        all += fmax(left, 0);
    }
    return all;
}

// The impulse with which what is left of a constraint is given back, and its friction: that its work, as far as all
// give alike, is that.
static void give_back(const brunt_constraint_set *p, brunt_constraint *c, kick *given) {
    const double unit = c->scale / c->row_sum, left = payable(c->account) * given->left;
    for (int a = 0; a < 3; a++) given->push[a] = 0;
    if (!(left > 0)) return;
    if (!(given->impulse > 0)) given->pressed = pressed(p, c);
    const double b = along(p, c, true) + along(p, c, false) + given->pressed + given->impulse / unit;
    const double J = 0.5 * unit * (sqrt(b * b + 8 * left / unit) - b);
    c->normal_impulse = given->impulse += J;
    for (int a = 0; a < 3; a++) given->push[a] = J * c->n[a];
    if (c->friction > 0) brunt_constraint_rub(p, c, given->push);
}

static void find_kicks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const round_job *j = context;
    const brunt_constraint_set *p = j->set;
    for (int64_t i = begin; i < end; i++) {
        const int32_t k = p->settled[i];
        if (releases(&p->release[k])) give_back(p, &p->constraint[k], &p->kicks[k]);
    }
}

// In the order of the constraints, as sums are.
static void give_kicks(const round_job *j) {
    const brunt_constraint_set *p = j->set;
    for (int32_t i = 0; i < j->settled; i++) {
        const int32_t k = p->settled[i];
        if (releases(&p->release[k])) brunt_constraint_give(p, &p->constraint[k], p->kicks[k].push, p->kicks[k].push);
    }
    for (int32_t i = 0; i < j->kicked; i++) brunt_constraints_move(p, p->kicked[i]);
}

static void note_work(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const round_job *j = context;
    const brunt_constraint_set *p = j->set;
    for (int64_t i = begin; i < end; i++) {
        const brunt_constraint *c = &p->constraint[p->settled[i]];
        kick *given = &p->kicks[p->settled[i]];
        if (given->impulse > 0)
            given->work = 0.5 * given->impulse * (along(p, c, true) + along(p, c, false) + given->pressed);
    }
}

// What is left stays held; what was given too much is owed by what got it, as far as the others of the pair cannot pay.
static void settle(const round_job *j) {
    const brunt_constraint_set *p = j->set;
    sum_left(j);
    for (int32_t i = 0; i < j->settled; i++) {
        const int32_t k = p->settled[i];
        const brunt_impulse_account *a = p->constraint[k].account;
        double *left = &p->kicks[k].left;
        if (*left < 0)
            *left *= a->overspent > a->unspent ? 1 - a->unspent / a->overspent : 0;
        else
            *left *= payable(a);
        if (fabs(*left) < LEAST_LEFT * fabs(p->release[k].touch->held)) *left = 0;
    }
    for (int32_t i = 0; i < j->settled; i++) p->release[p->settled[i]].touch->held = 0;
    for (int32_t i = 0; i < j->settled; i++) p->release[p->settled[i]].touch->held += p->kicks[p->settled[i]].left;
}

int brunt_constraints_release(brunt_constraint_set *p, bool *gave, int threads, brunt_timer *timer,
                              brunt_error *error) {
    *gave = false;
    if (!account_touches(p)) return BRUNT_OK;
    round_job j = {.set = p};
    if (BRUNT_CAPACITY(p->kicks, (size_t)p->constraint_count, 0, "contact points", error) ||
        BRUNT_CAPACITY(p->settled, (size_t)p->constraint_count, 0, "contact points", error) ||
        BRUNT_CAPACITY(p->kicked, (size_t)p->dof_node_count, 0, "nodes that contact moves", error))
        return BRUNT_FAILED;
    list_settled(&j);
    *gave = true;
    double held = 0;
    for (int round = 0; round < ROUNDS; round++) {
        const double left = sum_left(&j);
        held = fmax(held, left);
        if (left <= LAST_LEFT * held) break;
        brunt_parallel(threads, j.settled, GRAIN, find_kicks, &j, timer);
        give_kicks(&j);
        brunt_parallel(threads, j.settled, GRAIN, note_work, &j, timer);
    }
    settle(&j);
    return BRUNT_OK;
}
