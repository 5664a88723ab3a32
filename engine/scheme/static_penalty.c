// What load steps take for the stiffness of surfaces that may overlap, where a scene does not say: 20 E* / a, with a
// half the mean length of contacts. How long those are is not known before they are there: the first load step in which
// anything touches is solved roughly with the shortest edge for a, then with what contacts have told.
#include "base/error.h"
#include "scheme/implicit.h"

bool brunt_static_guesses(const struct brunt_implicit *m) {
    return m->still && m->contact.reach > 0 && !(m->contact.penalty > 0) && !m->contact.seen;
}

int brunt_static_see(struct brunt_implicit *m, brunt_error *error) {
    brunt_implicit_contact *c = &m->contact;
    brunt_barrier_report unused;
    brunt_barrier_forces forces = {.count = 0};
    int status = m->rubs ? brunt_barrier_lag(c->barrier, &m->team, m->field.u, error) : BRUNT_OK;
    if (!status)
        status = brunt_barrier_look_back(c->barrier, &m->team, m->field.u, m->field.u, &unused, &forces, error);
    const double width = status ? 0 : brunt_implicit_contact_width(c, &forces);
    if (width > 0) brunt_implicit_contact_widen(c, width);
    brunt_barrier_forces_free(&forces);
    return status;
}

// ------------------------------------------------------------------------------------------ of the state

// How far surfaces have given along each other, and how long contacts were.
static brunt_implicit_contact *keeper(const brunt_plan *plan) {
    return plan->implicit && plan->implicit->contact.barrier ? &plan->implicit->contact : NULL;
}

int64_t brunt_implicit_kept_count(const brunt_plan *plan) {
    const brunt_implicit_contact *c = keeper(plan);
    return c ? brunt_barrier_kept_count(c->barrier) + (c->reach > 0) : 0;
}

void brunt_implicit_kept_get(const brunt_plan *plan, double *to) {
    const brunt_implicit_contact *c = keeper(plan);
    if (!c) return;
    brunt_barrier_kept_get(c->barrier, to);
    if (c->reach > 0) to[brunt_barrier_kept_count(c->barrier)] = c->seen ? c->width : 0;
}

bool brunt_implicit_kept_fits(const brunt_plan *plan, int64_t count) {
    const brunt_implicit_contact *c = keeper(plan);
    return c ? brunt_barrier_kept_fits(c->barrier, count - (c->reach > 0)) : count == 0;
}

int brunt_implicit_kept_set(const brunt_plan *plan, const double *from, int64_t count, brunt_error *error) {
    brunt_implicit_contact *c = keeper(plan);
    if (!c) return BRUNT_OK;
    const int64_t slips = count - (c->reach > 0);
    if (brunt_barrier_kept_set(c->barrier, from, slips, error)) return BRUNT_FAILED;
    const double kept = c->reach > 0 ? from[slips] : 0;
    if (kept > 0) brunt_implicit_contact_widen(c, kept);
    return BRUNT_OK;
}
