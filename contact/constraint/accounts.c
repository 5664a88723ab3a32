// A chunk adds up what its constraints do, for the few accounts they have, and the accounts what the chunks have, in
// their order: sums are the same for any number of threads.
#include "contact/constraint/accounts.h"

#include <math.h>
#include <string.h>

#include "contact/constraint/parts.h"

enum { GRAIN = BRUNT_CONSTRAINT_GRAIN, MOST = BRUNT_RECORDED_ACCOUNTS };

// Velocities of a constraint before and after, against its plane, as the account's sign has them.
static void account_velocity(const brunt_constraint *constraint, double sign, double old[3], double now[3]) {
    for (int a = 0; a < 3; a++) {
        old[a] = sign * (old[a] + constraint->plane[a]);
        now[a] = sign * (now[a] + constraint->plane[a]);
    }
}

static void record(const brunt_constraint_set *p, int64_t k, brunt_impulse_account *to) {
    const brunt_constraint *constraint = &p->constraint[k];
    to->area += constraint->area;
    if (constraint->spring > 0) to->spring += 0.5 * constraint->spring * pow(fmin(0, constraint->gap), 2);
    // The account is of the second body: the slave's impulse, or the reaction to it; within one body there are
    // both.
    brunt_impulse_account within = {.area = 0}, *account = constraint->sign == 0 ? &within : to;
    const double sign = constraint->sign == 0 ? 1 : constraint->sign;
    double old[3], now[3], normal_impulse[3], friction_impulse[3], x[3];
    memcpy(old, p->rates[k].old, sizeof old), memcpy(now, p->rates[k].now, sizeof now);
    account_velocity(constraint, sign, old, now);
    for (int a = 0; a < 3; a++) {
        normal_impulse[a] = sign * constraint->normal_impulse * constraint->n[a],
        friction_impulse[a] = sign * constraint->friction_impulse[a];
        x[a] = constraint->x[a];
    }
    brunt_impulse_account_record(account, &to->normal_loss, normal_impulse, x, old, now, constraint->plane);
    if (constraint->friction_point) {
        brunt_constraint_slip(p, constraint, true, old);
        brunt_constraint_slip(p, constraint, false, now);
        account_velocity(constraint, sign, old, now);
        for (int a = 0; a < 3; a++) x[a] = p->friction_point[constraint->friction_point - 1].x[a];
    }
    if (constraint->friction > 0)
        brunt_impulse_account_record(account, &to->friction_loss, friction_impulse, x, old, now, constraint->plane);
}

static void add(brunt_impulse_account *sum, const brunt_impulse_account *part) {
    const double area = sum->area + part->area;
    brunt_impulse_account_add(sum, part);
    sum->area = area, sum->spring += part->spring;
}

// The place of an account among those of a chunk; MOST: there are too many.
static int place_of(struct brunt_recorded *r, brunt_impulse_account *account) {
    int at = r->count - 1; // most often the last
    while (at >= 0 && r->account[at] != account) at--;
    if (at >= 0 || r->count == MOST) return at >= 0 ? at : MOST;
    r->account[r->count] = account, r->sum[r->count] = (brunt_impulse_account){.area = 0};
    return r->count++;
}

void brunt_constraints_record(brunt_constraint_set *p, int64_t chunk) {
    struct brunt_recorded *r = &p->recorded[chunk];
    r->count = 0, r->first_left = -1;
    for (int64_t k = chunk * GRAIN; k < (chunk + 1) * GRAIN && k < p->constraint_count; k++) {
        if (!brunt_constraint_acts(&p->constraint[k])) continue;
        const int at = place_of(r, p->constraint[k].account);
        if (at == MOST) { // what is left, each to its account
            r->first_left = (int32_t)k;
            return;
        }
        record(p, k, &r->sum[at]);
    }
}

void brunt_constraints_account(brunt_constraint_set *p) {
    for (int64_t c = 0; c * GRAIN < p->constraint_count; c++) {
        const struct brunt_recorded *r = &p->recorded[c];
        for (int i = 0; i < r->count; i++) add(r->account[i], &r->sum[i]);
        for (int64_t k = r->first_left; k >= 0 && k < (c + 1) * GRAIN && k < p->constraint_count; k++)
            if (brunt_constraint_acts(&p->constraint[k])) record(p, k, p->constraint[k].account);
    }
}
