// Units of what measures give: of what is taken, over what the scene divides it by.
#include "io/output/measure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"

// Whether two units are the same in SI base units, as m/s and m.s-1 are.
bool measure_same_unit(brunt_units *units, const char *one, const char *other) {
    if (strcmp(one, other) == 0) return true;
    char base[2][BRUNT_UNIT_LENGTH] = {"", ""}, why[256];
    double value = 1;
    return brunt_units_to_si(units, one, &value, base[0], why, sizeof why) &&
           brunt_units_to_si(units, other, &value, base[1], why, sizeof why) && strcmp(base[0], base[1]) == 0;
}

// Bodies of two dimensions are 1 m thick, unless they are rings: their forces and energies may be said to be those of a
// metre.
static bool unit_fits(const char *taken, const char *unit, const measure_source *from) {
    char of_a_metre[3 * BRUNT_UNIT_LENGTH];
    snprintf(of_a_metre, sizeof of_a_metre, "(%s) m-1", taken);
    return measure_same_unit(from->units, taken, unit) ||
           (brunt_world_dimension(from->world) == 2 && !brunt_effect_on(from->world, "axisymmetric") &&
            measure_same_unit(from->units, of_a_metre, unit));
}

// A quotient as people write it: in SI base units.
static const char *simplify(brunt_units *units, const char *unit, char base[BRUNT_UNIT_LENGTH]) {
    char why[256];
    double one = 1;
    return brunt_units_to_si(units, unit, &one, base, why, sizeof why) ? base : unit;
}

// What is taken of something in the unit `of`.
static void write_taken(const brunt_measure *m, const char *of, char unit[BRUNT_UNIT_LENGTH]) {
    const bool time = m->take == BRUNT_TAKE_FIRST_NONZERO || m->take == BRUNT_TAKE_LAST_NONZERO ||
                      m->take == BRUNT_TAKE_PERIOD || m->take == BRUNT_TAKE_RISE;
    snprintf(unit, BRUNT_UNIT_LENGTH, m->take == BRUNT_TAKE_SLOPE ? "(%s) s-1" : "%s", time ? "s" : of);
}

// What it is divided by; "": nothing. NULL: a number whose unit is not told.
static const char *divisor_unit(const brunt_measure *m, const char *of) {
    if (m->relative_to_initial) return of;
    if (isnan(m->relative_to)) return "";
    return *m->relative_unit ? m->relative_unit : NULL;
}

int measure_check_units(const brunt_measure *m, const measure_source *from, brunt_error *error) {
    const measure_kind *kind = measure_kind_of(m);
    const char *of = kind->unit ? kind->unit(m, from) : NULL, *divisor = of ? divisor_unit(m, of) : NULL;
    if (!of) return BRUNT_OK;
    char taken[BRUNT_UNIT_LENGTH], given[3 * BRUNT_UNIT_LENGTH], base[BRUNT_UNIT_LENGTH];
    write_taken(m, of, taken);
    if (*m->minus_unit && !unit_fits(taken, m->minus_unit, from))
        return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s.minus: it is in %s, what it is subtracted from in %s",
                          m->name, m->minus_unit,
                          m->take == BRUNT_TAKE_SLOPE ? simplify(from->units, taken, base) : taken);
    if (!*m->unit || !divisor || (m->kind == BRUNT_MEASURE_HISTORY && m->curve.count)) return BRUNT_OK;
    snprintf(given, sizeof given, *divisor ? "(%s) (%s)-1" : "%s", taken, divisor);
    if (unit_fits(given, m->unit, from)) return BRUNT_OK;
    const bool divided = *divisor || m->take == BRUNT_TAKE_SLOPE;
    if (m->kind == BRUNT_MEASURE_HISTORY && !divided)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "measures.%s: what it takes of the history's column '%s' is in %s, not %s", m->name,
                          m->column, taken, m->unit);
    return brunt_fail(error, BRUNT_BAD_INPUT, "measures.%s: it is in %s, not %s", m->name,
                      divided ? simplify(from->units, given, base) : given, m->unit);
}
