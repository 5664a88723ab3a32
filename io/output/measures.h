// Named results of a run: numbers taken from the history or from the bodies at the end, judged against references.
#pragma once

#include "io/output/history.h"
#include "io/scene/scene.h"
#include "io/scene/units.h"

typedef struct brunt_measure_result {
    double value; // in the measure's own (SI) unit; NAN when there was nothing to take it from
    double error; // relative to the expectation, or absolute [unit] when the measure says so or the expectation is 0;
                  // NAN without one
    bool judged;  // an expectation with a tolerance is given
    bool ok;      // judged and within the tolerance
} brunt_measure_result;

// Checks before the run that the history columns, bodies and fields a measure names exist. BRUNT_BAD_INPUT with the
// names there are, or of a unit that is not that of what it names.
int brunt_measure_check(const brunt_measure *measure, const brunt_history *history, brunt_world *world,
                        brunt_units *units, brunt_error *error);

// The value at the start of a measure that looks at a body (NAN for one that reads the history): the divisor of
// `relative_to: initial`. To be called before the world has moved or been restored.
int brunt_measure_initial(const brunt_measure *measure, brunt_world *world, double *initial, brunt_error *error);

// Reads the columns that the measures will ask for, all at once: to be called before they are evaluated.
int brunt_measures_fetch(const brunt_measure *measures, int32_t count, const brunt_history *history,
                         brunt_error *error);

// Evaluates with history and world as they are. The value is (reduced - minus) / divisor; with a curve, the reduced
// ((history - minus) / divisor - curve) / range of the curve, between its times or those of the window.
int brunt_measure_evaluate(const brunt_measure *measure, const brunt_history *history, brunt_world *world,
                           double initial, brunt_measure_result *result, brunt_error *error);
