#include "base/check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"

#define REFUSE(...) return brunt_fail(error, BRUNT_BAD_INPUT, __VA_ARGS__)

int brunt_check_number(const char *owner, const char *key, double v, int rule, brunt_error *error) {
    const bool positive = rule & BRUNT_POSITIVE;
    if ((isnan(v) && rule & BRUNT_OR_NAN) || (isinf(v) && rule & BRUNT_OR_INFINITE)) return BRUNT_OK;
    if (!isfinite(v)) REFUSE("%s%s: %g is not a finite number", owner, key, v);
    if ((positive && !(v > 0)) || (rule & BRUNT_NOT_NEGATIVE && v < 0))
        REFUSE("%s%s: %g is %s", owner, key, v, positive ? "not above 0" : "negative");
    if (fabs(v) > BRUNT_GREATEST_NUMBER)
        REFUSE("%s%s: %g is too large a number, at most %g is wanted", owner, key, v, BRUNT_GREATEST_NUMBER);
    if (v != 0 && fabs(v) < (positive ? BRUNT_LEAST_NUMBER : BRUNT_LEAST_NORMAL))
        REFUSE("%s%s: %g is too small a number", owner, key, v);
    return BRUNT_OK;
}

int brunt_check_numbers(const char *owner, const brunt_numbers *list, size_t count, brunt_error *error) {
    for (size_t k = 0; k < count; k++)
        for (int c = 0; c < list[k].count; c++)
            BRUNT_TRY(brunt_check_number(owner, list[k].key, list[k].value[c], list[k].rule, error));
    return BRUNT_OK;
}
int brunt_check_array(const char *what, int32_t count, const void *array, brunt_error *error) {
    if (count < 0) REFUSE("%s: there are %d", what, count);
    if (count > 0 && !array) REFUSE("%s: there are %d, and no array of them", what, count);
    return BRUNT_OK;
}

int brunt_check_name_ends(const char *what, int index, const char name[BRUNT_NAME_LENGTH], brunt_error *error) {
    if (!memchr(name, 0, BRUNT_NAME_LENGTH))
        REFUSE("%s[%d]: a name of more than %d bytes, or without its end", what, index, BRUNT_NAME_LENGTH - 1);
    return BRUNT_OK;
}

int brunt_check_choice(const char *owner, const char *key, unsigned value, unsigned count, brunt_error *error) {
    if (value >= count) REFUSE("%s%s: there is no choice %d", owner, key, (int)value);
    return BRUNT_OK;
}

int brunt_check_curve(const char *owner, const char *key, const brunt_curve *curve, brunt_error *error) {
    char what[160];
    snprintf(what, sizeof what, "%s%s", owner, key);
    BRUNT_TRY(brunt_check_array(what, curve->count, curve->points, error));
    for (int32_t k = 0; k < curve->count; k++) BRUNT_CHECK_NUMBERS(owner, {key, curve->points[k], 2, BRUNT_ANY_NUMBER});
    return BRUNT_OK;
}
