#include "io/output/measures.h"

#include <math.h>

#include "base/array.h"
#include "io/output/measure.h"

static const measure_kind *const kinds[] = {
#define X(NAME, name) [BRUNT_MEASURE_##NAME] = &measure_##name,
    BRUNT_MEASURE_KINDS(X)
#undef X
};
#define AND_ONE(NAME, name) +1
_Static_assert(BRUNT_COUNT(kinds) == 0 BRUNT_MEASURE_KINDS(AND_ONE), "a row for each kind of measure");

const measure_kind *measure_kind_of(const brunt_measure *measure) { return kinds[measure->kind]; }

int brunt_measure_check(const brunt_measure *measure, const brunt_history *history, brunt_world *world,
                        brunt_units *units, brunt_error *error) {
    const measure_kind *kind = measure_kind_of(measure);
    const measure_source from = {.history = history, .world = world, .units = units};
    if (measure->absent) return BRUNT_OK;
    int status = kind->check ? kind->check(measure, &from, error) : BRUNT_OK;
    double unused;
    if (!status) status = measure_check_units(measure, &from, error);
    return status ? status : brunt_measure_initial(measure, world, &unused, error);
}

int brunt_measure_initial(const brunt_measure *measure, brunt_world *world, double *initial, brunt_error *error) {
    *initial = NAN;
    measure_source from = {.world = world};
    return measure->kind == BRUNT_MEASURE_HISTORY ? BRUNT_OK
                                                  : measure_kind_of(measure)->take(measure, &from, initial, error);
}

int brunt_measures_fetch(const brunt_measure *measures, int32_t count, const brunt_history *history,
                         brunt_error *error) {
    const char **names;
    if (BRUNT_NEW(names, count + 1, "columns of measures", error)) return BRUNT_FAILED;
    int32_t wanted = 0;
    names[wanted++] = "time";
    for (int32_t m = 0; m < count; m++)
        if (measures[m].kind == BRUNT_MEASURE_HISTORY && !measures[m].absent) names[wanted++] = measures[m].column;
    const int status = wanted > 1 ? brunt_history_fetch(history, names, wanted, error) : BRUNT_OK;
    brunt_free(names);
    return status;
}

int brunt_measure_evaluate(const brunt_measure *measure, const brunt_history *history, brunt_world *world,
                           double initial, brunt_measure_result *result, brunt_error *error) {
    *result = (brunt_measure_result){.value = NAN, .error = NAN};
    if (measure->absent) return BRUNT_OK;
    double value = NAN;
    measure_source from = {.history = history, .world = world, .initial = initial};
    int status = measure_kind_of(measure)->take(measure, &from, &value, error);
    if (status) return status;
    if (!measure->curve.count || measure->kind == BRUNT_MEASURE_PROFILE) {
        value -= measure->minus;
        if (measure->relative_to_initial) value /= from.initial;
        if (!isnan(measure->relative_to)) value /= measure->relative_to;
    }
    result->value = value;
    if (isnan(measure->expect)) return BRUNT_OK;
    double difference = fabs(value - measure->expect);
    // A relative error needs something to be relative to.
    result->error = measure->absolute || measure->expect == 0 ? difference : difference / fabs(measure->expect);
    result->judged = !isnan(measure->tolerance);
    result->ok = result->judged && result->error <= measure->tolerance;
    return BRUNT_OK;
}
