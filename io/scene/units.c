// Units through udunits2. What it is given is looked at first: its grammar takes dates, logarithms and numbers between
// units, none of which has a meaning in a scene, and a misread unit is worse than a refused one.
#include "io/scene/units.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <udunits2.h>

#include "brunt.h"
#include "base/memory.h"

struct brunt_units {
    ut_system *system;
    bool tried;
};

typedef struct quantity {
    const char *name, *unit;
} quantity;

// Names for what a unit measures, the first that fits.
static const quantity quantities[] = {
    {"an angle", "rad"},
    {"a pure number", "1"},
    {"a length", "m"},
    {"an area", "m^2"},
    {"a volume", "m^3"},
    {"a mass", "kg"},
    {"a time", "s"},
    {"a temperature", "K"},
    {"a velocity", "m/s"},
    {"an acceleration", "m/s^2"},
    {"an angular velocity", "rad/s"},
    {"a rate or frequency", "1/s"},
    {"a wave number", "1/m"},
    {"a density", "kg/m^3"},
    {"a force", "N"},
    {"a pressure", "Pa"},
    {"an energy", "J"},
    {"a power", "W"},
    {"a momentum", "kg m/s"},
    {"an angular momentum", "kg m^2/s"},
    {"a viscosity", "Pa s"},
    {"a specific energy", "J/kg"},
    {"a specific heat", "J/kg/K"},
    {"a thermal conductivity", "W/m/K"},
    {"a force per length", "N/m"},
    {"an electric current", "A"},
    {"an electric charge", "C"},
    {"an electric potential", "V"},
    {"an amount of substance", "mol"},
    {"a luminous intensity", "cd"},
};

// What most scenes are written in, a value of it times and over what in SI base units as the database names them: to
// read that takes longer than all else before the first step.
typedef struct usual_unit {
    const char *unit, *base;
    double times, over;
} usual_unit;

static const usual_unit usual_units[] = {
    {"1", "1", 1, 1},
    {"m", "m", 1, 1},
    {"km", "m", 1e3, 1},
    {"cm", "m", 1, 1e2},
    {"mm", "m", 1, 1e3},
    {"um", "m", 1, 1e6},
    {"nm", "m", 1, 1e9},
    {"s", "s", 1, 1},
    {"ms", "s", 1, 1e3},
    {"us", "s", 1, 1e6},
    {"ns", "s", 1, 1e9},
    {"1/s", "s-1", 1, 1},
    {"kg", "kg", 1, 1},
    {"g", "kg", 1, 1e3},
    {"K", "K", 1, 1},
    {"m/s", "m.s-1", 1, 1},
    {"km/s", "m.s-1", 1e3, 1},
    {"mm/s", "m.s-1", 1, 1e3},
    {"m/s^2", "m.s-2", 1, 1},
    {"kg/m^3", "m-3.kg", 1, 1},
    {"g/cm^3", "m-3.kg", 1e3, 1},
    {"N", "m.kg.s-2", 1, 1},
    {"kN", "m.kg.s-2", 1e3, 1},
    {"Pa", "m-1.kg.s-2", 1, 1},
    {"kPa", "m-1.kg.s-2", 1e3, 1},
    {"MPa", "m-1.kg.s-2", 1e6, 1},
    {"GPa", "m-1.kg.s-2", 1e9, 1},
    {"J", "m2.kg.s-2", 1, 1},
    {"mJ", "m2.kg.s-2", 1, 1e3},
    {"kJ", "m2.kg.s-2", 1e3, 1},
    {"W", "m2.kg.s-3", 1, 1},
};

// NULL: the database has it, or nothing has.
static const usual_unit *find_usual(const char *unit) {
    for (size_t i = 0; i < sizeof usual_units / sizeof *usual_units; i++)
        if (strcmp(usual_units[i].unit, unit) == 0) return &usual_units[i];
    return NULL;
}

// False where the result is no number; its words are the database's.
static bool convert_usual(const usual_unit *from, double *value) {
    const double result = *value * from->times / from->over;
    if (!isfinite(result)) return false;
    *value = result;
    return true;
}

brunt_units *brunt_units_open(void) { return brunt_alloc(sizeof(brunt_units)); }

void brunt_units_close(brunt_units *units) {
    if (!units) return;
    if (units->system) ut_free_system(units->system);
    brunt_free(units);
}

static ut_system *system_of(brunt_units *units) {
    if (units->tried) return units->system;
    units->tried = true;
    ut_system *system = units->system = ut_read_xml(NULL);
    if (!system) return NULL;
    // The database calls it arc_degree or by its sign only; everybody types deg.
    ut_unit *degree = ut_parse(system, "arc_degree", UT_ASCII);
    if (degree && !ut_get_unit_by_symbol(system, "deg")) ut_map_symbol_to_unit("deg", UT_ASCII, degree);
    ut_free(degree);
    return system;
}

// udunits2 writes to stderr unless told not to; its handler is its own global, so it is put back after each use.
static ut_error_message_handler silence(void) { return ut_set_error_message_handler(ut_ignore); }
static void restore(ut_error_message_handler handler) { ut_set_error_message_handler(handler); }

// Letters, signs of degree and micro, powers and products only.
static bool acceptable(const char *unit) {
    size_t length = strlen(unit);
    if (length == 0 || length >= BRUNT_UNIT_LENGTH) return false;
    int depth = 0, digits = 0;
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)unit[i], before = i ? (unsigned char)unit[i - 1] : ' ';
        digits = isdigit(c) ? digits + 1 : 0;
        if (digits > 2) return false;
        if (c == '(') depth++;
        if (c == ')' && --depth < 0) return false;
        if (depth > 3) return false;
        // A number stands behind its unit as a power; only "1/s" starts with one.
        if (isdigit(c) && (before == ' ' || before == '*' || before == '.' || before == '/' || before == '(') &&
            !(c == '1' && unit[i + 1] == '/'))
            return false;
        if (!isalnum(c) && !strchr(" ^*/.-()%_", c) && c < 0x80) return false;
    }
    static const char *const refused[] = {"since", "from", "after", "ref", "lg", "ln", "lb("};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        if (strstr(unit, refused[i])) return false;
    return depth == 0;
}

// NULL and a message when the text is no unit.
static ut_unit *parse(brunt_units *units, const char *unit, char *message, size_t size) {
    ut_system *system = system_of(units);
    if (!system) {
        snprintf(message, size, "the database of units (udunits2) cannot be read");
        return NULL;
    }
    ut_unit *parsed = strcmp(unit, "1") == 0 || acceptable(unit) ? ut_parse(system, unit, UT_UTF8) : NULL;
    if (!parsed) snprintf(message, size, "'%.60s' is not a unit", unit);
    return parsed;
}

// In base units: "0.001 m", "K @ 273.15", "s-1.rad".
static void definition(const ut_unit *unit, char *out, size_t size) {
    int length = ut_format(unit, out, size - 1, UT_ASCII | UT_DEFINITION);
    if (length < 0) length = 0;
    out[(size_t)length < size ? (size_t)length : size - 1] = 0;
}

// The base units alone: "m.kg.s-2", "s-1.rad", "1". Two units measure the same when these agree. (The library's own
// question is no use here: it counts reciprocals as convertible, 2 Hz for 0.5 s.)
static void base_units(const ut_unit *unit, char *out, size_t size) {
    char text[256], *start = text, *end;
    definition(unit, text, sizeof text);
    double factor = strtod(text, &end);
    if (end != text && *end == ' ' && isfinite(factor)) start = end + 1;
    start[strcspn(start, " ")] = 0;
    snprintf(out, size, "%s", *start ? start : "1");
}

static bool same_base(const ut_unit *a, const ut_unit *b) {
    char x[256], y[256];
    base_units(a, x, sizeof x);
    base_units(b, y, sizeof y);
    return strcmp(x, y) == 0;
}

static bool same_dimension(brunt_units *units, const ut_unit *unit, const char *reference) {
    ut_unit *other = ut_parse(units->system, reference, UT_UTF8);
    bool same = other && same_base(unit, other);
    ut_free(other);
    return same;
}

// Whether a value in `from` may be taken for one in `to`. 1/m is as good as rad/m where no angle is wanted; the other
// way round a factor 2 pi hides, and a pure number is no angle.
static bool fits(brunt_units *units, const ut_unit *from, const ut_unit *to, const char *wanted) {
    if (same_base(from, to)) return true;
    char base[256];
    base_units(to, base, sizeof base);
    if (strcmp(wanted, "1") == 0 || strstr(base, "rad")) return false;
    ut_unit *radian = ut_parse(units->system, "rad", UT_ASCII), *plain = radian ? ut_divide(from, radian) : NULL;
    bool same = plain && same_base(plain, to);
    ut_free(plain);
    ut_free(radian);
    return same;
}

static const char *quantity_name(brunt_units *units, const ut_unit *unit) {
    for (size_t i = 0; i < sizeof quantities / sizeof *quantities; i++)
        if (same_dimension(units, unit, quantities[i].unit)) return quantities[i].name;
    return NULL;
}

void brunt_units_describe(brunt_units *units, const char *unit, char *out, size_t size) {
    for (size_t i = 0; i < sizeof quantities / sizeof *quantities; i++) {
        if (strcmp(quantities[i].unit, unit) != 0) continue;
        if (strcmp(unit, "1") == 0)
            snprintf(out, size, "%s", quantities[i].name);
        else
            snprintf(out, size, "%s (%s)", quantities[i].name, unit);
        return;
    }
    ut_error_message_handler handler = silence();
    ut_system *system = system_of(units);
    ut_unit *parsed = system ? ut_parse(system, unit, UT_UTF8) : NULL;
    const char *name = parsed ? quantity_name(units, parsed) : NULL;
    if (name)
        snprintf(out, size, "%s (%s)", name, unit);
    else
        snprintf(out, size, "a value in %s", unit);
    ut_free(parsed);
    restore(handler);
}

// 12 mm must be the double nearest to 0.012: 12 * 0.001 is not always, 12 / 1000 is.
static double apply(cv_converter *converter, double value) {
    double offset = cv_convert_double(converter, 0.0), factor = cv_convert_double(converter, 1.0) - offset;
    if (offset != 0) return cv_convert_double(converter, value);
    double inverse = round(1 / factor), direct = round(factor);
    if (fabs(factor) < 1 && fabs(inverse * factor - 1) < 1e-13) return value / inverse;
    if (fabs(factor) >= 1 && fabs(direct / factor - 1) < 1e-13) return value * direct;
    return value * factor;
}

static bool finish(ut_unit *from, ut_unit *to, double *value, const char *unit, char *message, size_t size) {
    cv_converter *converter = ut_get_converter(from, to);
    if (!converter) {
        snprintf(message, size, "'%s' cannot be converted", unit);
        return false;
    }
    double result = apply(converter, *value);
    cv_free(converter);
    if (!isfinite(result)) {
        snprintf(message, size, "the number is too large once converted from '%s'", unit);
        return false;
    }
    *value = result;
    return true;
}

bool brunt_units_convert(brunt_units *units, const char *unit, const char *wanted, double *value, char *message,
                         size_t size) {
    if (strcmp(unit, wanted) == 0) return true;
    const usual_unit *usual = find_usual(unit), *si = usual ? find_usual(wanted) : NULL;
    if (si && si->times == si->over && strcmp(usual->base, si->base) == 0 && convert_usual(usual, value)) return true;
    ut_error_message_handler handler = silence();
    bool done = false;
    char want[96], why[160] = "";
    brunt_units_describe(units, wanted, want, sizeof want);
    ut_unit *from = parse(units, unit, why, sizeof why);
    ut_unit *to = from ? ut_parse(units->system, wanted, UT_UTF8) : NULL;
    if (!from) {
        snprintf(message, size, "%s, %s is wanted", why, want);
    } else if (!to) {
        snprintf(message, size, "'%s' cannot be converted to %s", unit, wanted);
    } else {
        if (fits(units, from, to, wanted)) {
            done = finish(from, to, value, unit, message, size);
        } else {
            const char *name = quantity_name(units, from);
            char text[96];
            definition(from, text, sizeof text);
            if (name)
                snprintf(message, size, "'%s' is %s, %s is wanted", unit, name, want);
            else
                snprintf(message, size, "'%s' is a value in %s, %s is wanted", unit, text, want);
        }
    }
    ut_free(from);
    ut_free(to);
    restore(handler);
    return done;
}

const char *brunt_units_written(const char *base) {
    for (size_t i = 0; i < sizeof usual_units / sizeof *usual_units; i++)
        if (usual_units[i].times == usual_units[i].over && strcmp(usual_units[i].base, base) == 0)
            return usual_units[i].unit;
    return base;
}

bool brunt_units_to_si(brunt_units *units, const char *unit, double *value, char base[BRUNT_UNIT_LENGTH], char *message,
                       size_t size) {
    const usual_unit *usual = find_usual(unit);
    snprintf(base, BRUNT_UNIT_LENGTH, "%s", usual ? usual->base : "1");
    if (usual && convert_usual(usual, value)) return true;
    ut_error_message_handler handler = silence();
    bool done = false;
    ut_unit *from = parse(units, unit, message, size);
    if (from) {
        char start[256];
        base_units(from, start, sizeof start);
        ut_unit *to = strlen(start) < BRUNT_UNIT_LENGTH ? ut_parse(units->system, start, UT_UTF8) : NULL;
        if (to) {
            done = finish(from, to, value, unit, message, size);
            snprintf(base, BRUNT_UNIT_LENGTH, "%.*s", BRUNT_UNIT_LENGTH - 1, start);
        } else {
            snprintf(message, size, "'%s' is not a unit that can be used here", unit);
        }
        ut_free(to);
        ut_free(from);
    }
    restore(handler);
    return done;
}

static bool word_is(const char *text, const char *word) {
    size_t n = strlen(word);
    for (size_t i = 0; i < n; i++)
        if (tolower((unsigned char)text[i]) != word[i]) return false;
    return !isalnum((unsigned char)text[n]);
}

const char *brunt_read_number(const char *text, double *value, const char **rest) {
    const char *p = text;
    if (*p == '+' || *p == '-') p++;
    const char *bare = *p == '.' ? p + 1 : p;
    if (word_is(bare, "nan") || word_is(bare, "inf") || word_is(bare, "infinity")) return "not a finite number";
    const char *digits = p;
    bool any = false, nonzero = false;
    for (; isdigit((unsigned char)*p) || *p == '.'; p++) {
        if (*p == '.') {
            if (memchr(digits, '.', (size_t)(p - digits))) return "not a number (two decimal points)";
            continue;
        }
        any = true;
        nonzero |= *p != '0';
    }
    if (!any) return "not a number";
    if (*p == ',' && isdigit((unsigned char)p[1])) return "not a number (write a decimal point, not a comma)";
    if (*p == 'e' || *p == 'E') {
        const char *q = p + 1;
        if (*q == '+' || *q == '-') q++;
        if (isdigit((unsigned char)*q)) {
            while (isdigit((unsigned char)*q)) q++;
            p = q;
        }
    }
    size_t length = (size_t)(p - text);
    char copy[400];
    if (length >= sizeof copy) return "too long a number";
    memcpy(copy, text, length);
    copy[length] = 0;
    *value = strtod(copy, NULL);
    if (!isfinite(*value)) return "too large a number for a double";
    if (*value == 0 && nonzero) return "too small a number for a double";
    *rest = p;
    return NULL;
}

bool brunt_usable_number(double value, bool positive, char *why, size_t size) {
    const double least = positive ? BRUNT_LEAST_NUMBER : BRUNT_LEAST_NORMAL;
    if (fabs(value) > BRUNT_GREATEST_NUMBER)
        snprintf(why, size, "too large a number, at most %g is wanted in SI units", BRUNT_GREATEST_NUMBER);
    else if (value != 0 && fabs(value) < least)
        snprintf(why, size, "too small a number, %sat least %g is wanted in SI units", positive ? "" : "0 or ", least);
    else
        return true;
    return false;
}

void brunt_format_number(double value, char out[32]) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(out, 32, "%.*g", digits, value);
        if (strtod(out, NULL) == value) return;
    }
}
