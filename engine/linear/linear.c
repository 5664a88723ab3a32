#include "linear/linear.h"

#include <string.h>

#include "base/error.h"

static const brunt_linear_ops *const solvers[] = {&brunt_linear_direct, &brunt_linear_pcg, &brunt_linear_unsymmetric,
                                                  NULL};

const brunt_linear_ops *const *brunt_linear_list(void) { return solvers; }

const brunt_linear_ops *brunt_linear_find(const char *name) {
    for (int i = 0; solvers[i]; i++)
        if (!strcmp(solvers[i]->name, name)) return solvers[i];
    return NULL;
}

int brunt_linear_open(brunt_linear *s, const brunt_linear_ops *ops, const brunt_linear_options *options,
                      brunt_error *error) {
    if (s->ops != ops) {
        brunt_linear_close(s);
        s->self = ops->make(error);
        if (!s->self) return BRUNT_FAILED;
        s->ops = ops;
    }
    s->options = *options;
    s->report = (brunt_linear_report){0};
    return BRUNT_OK;
}

void brunt_linear_close(brunt_linear *s) {
    if (s->ops) s->ops->free(s->self);
    *s = (brunt_linear){0};
}

bool brunt_linear_stops(const brunt_linear *s, brunt_error *error) {
    const brunt_stop *stop = &s->options.stop;
    if (!stop->asked || !stop->asked(stop->context)) return false;
    brunt_fail(error, BRUNT_STOPPED, "The solver was stopped.");
    return true;
}

brunt_linear_status brunt_linear_analyse(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a,
                                         brunt_error *error) {
    BRUNT_ASSERT(s->ops && a->pattern);
    return s->ops->analyse(s, team, a, error);
}

brunt_linear_status brunt_linear_factor(brunt_linear *s, const brunt_team *team, const brunt_block_matrix *a,
                                        brunt_error *error) {
    BRUNT_ASSERT(s->ops && a->pattern);
    return brunt_linear_stops(s, error) ? BRUNT_LINEAR_FAILED : s->ops->factor(s, team, a, error);
}

brunt_linear_status brunt_linear_solve(brunt_linear *s, const brunt_team *team, const double *b, double *x,
                                       brunt_error *error) {
    BRUNT_ASSERT(s->ops);
    return s->ops->solve(s, team, b, x, error);
}

brunt_linear_status brunt_linear_solve_many(brunt_linear *s, const brunt_team *team, int count, double *x,
                                            brunt_error *error) {
    BRUNT_ASSERT(s->ops && s->ops->many);
    return s->ops->many(s, team, count, x, error);
}
