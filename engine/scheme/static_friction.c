// Friction of load steps: normal forces and directions are those of the last solution, until both agree.
//
// With given normal forces friction has a potential (Coulomb's law becomes Tresca's), which Newton's method minimises
// with all else; then they are taken anew where that has led, and so on, until the forces with what presses there are
// as balanced as is asked for. What is not is no equilibrium, however well each potential is minimised: a body that
// slides away, say. It is in vain to minimise the first ones well, while bodies that only friction holds have none.
#include <math.h>

#include "base/error.h"
#include "scheme/implicit.h"

// Whether nothing is left to do: forces balance where friction has just been taken.
static bool settled(const brunt_newton_report *report) { return report->iterations == 0; }

int brunt_static_rub(struct brunt_implicit *m, brunt_minimise *minimise, brunt_newton_report *report,
                     brunt_error *error) {
    enum { AT_ONCE = 4, LONG = 12 };
    const brunt_newton_options asked = m->options;
    int32_t left = asked.iterations;
    int status = BRUNT_OK;
    for (int round = 0; left >= 0; round++) {
        if (brunt_barrier_lag(m->contact.barrier, &m->team, m->field.u, error)) return BRUNT_FAILED;
        const int32_t most = round < 2 ? AT_ONCE : LONG;
        m->options.stable = false;
        m->options.iterations = left > most ? most : left > 0 ? left : 1; // at last it is only looked at
        brunt_error tried = {.id = -1};
        status = minimise(m, report, &tried);
        m->options = asked;
        left -= report->iterations;
        if (!status && settled(report)) return minimise(m, report, error); // is it stable
        if (!status || report->result == BRUNT_NEWTON_ITERATIONS) continue;
        if (error) *error = tried;
        return BRUNT_FAILED;
    }
    report->result = BRUNT_NEWTON_ITERATIONS;
    return brunt_fail(error, BRUNT_FAILED,
                      "friction does not settle within %d iterations (newton.iterations): %.3g of the forces that act "
                      "are left.",
                      asked.iterations, report->unbalance);
}

// ------------------------------------------------------------------------------------------ of the state

static brunt_barrier *keeper(const brunt_plan *plan) { return plan->implicit ? plan->implicit->contact.barrier : NULL; }

int64_t brunt_implicit_kept_count(const brunt_plan *plan) { return brunt_barrier_kept_count(keeper(plan)); }

void brunt_implicit_kept_get(const brunt_plan *plan, double *to) { brunt_barrier_kept_get(keeper(plan), to); }

void brunt_implicit_kept_set(const brunt_plan *plan, const double *from) { brunt_barrier_kept_set(keeper(plan), from); }
