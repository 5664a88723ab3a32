// References, fits that only reports want, and words for numbers.
#include "io/study/study_view.h"
#include "base/error.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

static bool finished(const brunt_study_case *c) { return c->status == BRUNT_STUDY_DONE; }

double brunt_study_resolution(const brunt_study *study, const brunt_study_case *c) {
    const int32_t axis = study->resolution;
    return axis < 0 ? NAN : study->axes[axis].values[c->value[axis]].number;
}

int32_t brunt_study_line_cases(const brunt_study *study, int32_t line, int32_t *out) {
    int32_t count = 0;
    for (int32_t i = 0; i < study->case_count; i++) {
        if (study->cases[i].line != line) continue;
        const double h = brunt_study_resolution(study, &study->cases[i]);
        int32_t place = count++;
        for (; place > 0 && brunt_study_resolution(study, &study->cases[out[place - 1]]) < h; place--)
            out[place] = out[place - 1];
        out[place] = i;
    }
    return count;
}

// --- references

// `of` names a line, or a value that makes it: "FEM".
static bool is_of(const brunt_study *study, const brunt_study_case *c, const char *of) {
    if (!of[0] || !strcmp(study->lines[c->line].label, of)) return true;
    for (int32_t a = 0; a < study->axis_count; a++)
        if (a != study->resolution && !strcmp(study->axes[a].values[c->value[a]].label, of)) return true;
    return false;
}

// At equal resolution the one of more particles and elements.
static bool finer(const brunt_study *study, const brunt_study_case *a, const brunt_study_case *b) {
    const double ha = brunt_study_resolution(study, a), hb = brunt_study_resolution(study, b);
    if (ha < hb || ha > hb) return ha < hb;
    return a->units > b->units;
}

static int32_t finest(const brunt_study *study, int32_t m) {
    int32_t best = -1;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (!finished(c) || !isfinite(c->result[m]) || !is_of(study, c, study->measures[m].of)) continue;
        if (best < 0 || finer(study, c, &study->cases[best])) best = i;
    }
    return best;
}

// Whose limit is taken: the case's own line, or the first named that has one.
static int32_t limit_line(const brunt_study *study, const brunt_study_case *c, int32_t m) {
    if (!study->measures[m].of[0]) return c->line;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *o = &study->cases[i];
        if (is_of(study, o, study->measures[m].of) && isfinite(study->lines[o->line].limit[m])) return o->line;
    }
    return BRUNT_NONE;
}

brunt_study_truth brunt_study_truth_of(const brunt_study *study, const brunt_study_case *c, int32_t m) {
    const brunt_study_measure *measure = &study->measures[m];
    brunt_study_truth truth = {NAN, 0, -1, -1};
    switch (measure->reference) {
    case BRUNT_REFERENCE_NUMBER: truth.value = isnan(measure->exact) ? c->expect[m] : measure->exact; break;
    case BRUNT_REFERENCE_TABLE: truth.value = measure->table[c->value[measure->table_axis]]; break;
    case BRUNT_REFERENCE_FINEST: {
        truth.finest = finest(study, m);
        truth.uncertainty = NAN;
        if (truth.finest < 0) break;
        truth.value = study->cases[truth.finest].result[m];
        const brunt_study_line *own = &study->lines[study->cases[truth.finest].line];
        truth.uncertainty = own->settled[m] ? own->limit_uncertainty[m] : fabs(own->limit[m] - truth.value);
        break;
    }
    case BRUNT_REFERENCE_RICHARDSON:
        truth.line = limit_line(study, c, m);
        truth.uncertainty = NAN;
        if (truth.line < 0) break;
        truth.value = study->lines[truth.line].limit[m];
        truth.uncertainty = study->lines[truth.line].limit_uncertainty[m];
        break;
    }
    return truth;
}

double brunt_study_scale_of(const brunt_study *study, const brunt_study_case *c, int32_t m) {
    const double scale = study->measures[m].scale;
    return isnan(scale) ? fabs(brunt_study_truth_of(study, c, m).value) : scale;
}

double brunt_study_resolvable(const brunt_study *study, const brunt_study_case *c, int32_t m) {
    const double ratio = brunt_study_truth_of(study, c, m).uncertainty / brunt_study_scale_of(study, c, m);
    return isfinite(ratio) ? ratio : 0;
}

bool brunt_study_is_limit(const brunt_study *study, const brunt_study_case *c, int32_t m) {
    if (study->measures[m].reference != BRUNT_REFERENCE_RICHARDSON || !finished(c)) return false;
    const brunt_study_truth truth = brunt_study_truth_of(study, c, m);
    return truth.line >= 0 && study->lines[truth.line].settled[m] && c->result[m] == truth.value;
}

bool brunt_study_doubtful(const brunt_study *study, const brunt_study_case *c, int32_t m) {
    const double least = brunt_study_resolvable(study, c, m);
    return finished(c) && least > 0 && c->error[m] <= least * (1 + 1e-9); // equal but for rounding
}

bool brunt_study_lacks_limit(const brunt_study *study, int32_t line, int32_t m, char why[160]) {
    if (study->measures[m].reference != BRUNT_REFERENCE_RICHARDSON || isfinite(study->lines[line].limit[m]))
        return false;
    int32_t *cases = brunt_alloc((size_t)study->case_count * sizeof *cases);
    bool wanted = false;
    if (cases) {
        double finest_values[3] = {NAN, NAN, NAN}; // the last of them the finest
        int32_t known = 0, count = brunt_study_line_cases(study, line, cases);
        for (int32_t i = 0; i < count; i++) {
            const brunt_study_case *c = &study->cases[cases[i]];
            const char *of = study->measures[m].of;
            wanted = !of[0] || (is_of(study, c, of) && limit_line(study, c, m) < 0);
            if (!finished(c) || !isfinite(c->result[m])) continue;
            finest_values[0] = finest_values[1], finest_values[1] = finest_values[2];
            finest_values[2] = c->result[m], known++;
        }
        if (known < 3)
            snprintf(why, 160, "fewer than three of its runs give a value");
        else
            snprintf(why, 160, "its values %.6g, %.6g, %.6g do not settle", finest_values[0], finest_values[1],
                     finest_values[2]);
    }
    brunt_free(cases);
    return wanted;
}

int32_t brunt_study_reference_case(const brunt_study *study, int32_t m) {
    return study->measures[m].reference == BRUNT_REFERENCE_FINEST ? finest(study, m) : BRUNT_NONE;
}

const char *brunt_study_unit(const brunt_study *study, int32_t m) {
    for (int32_t i = 0; i < study->case_count; i++)
        if (study->cases[i].unit[m][0]) return study->cases[i].unit[m];
    return "";
}

// --- fits

// Through the first k points an order; all pairs behind them show less than half of it, its uncertainty left aside.
static double level_from(const double *h, const double *e, int32_t n) {
    static const double least_order = 0.25; // what falls slower than this has nothing to level off from
    for (int32_t k = 1; k + 1 < n; k++) {
        brunt_study_fit before = brunt_study_line_fit(h, e, k + 1);
        const double bound = before.slope / 2 - (isnan(before.uncertainty) ? 0 : before.uncertainty);
        bool level = before.slope > least_order;
        for (int32_t j = k; level && j + 1 < n; j++) level = log(e[j] / e[j + 1]) / log(h[j] / h[j + 1]) < bound;
        if (level) return h[k];
    }
    return NAN;
}

double brunt_study_plateau(const brunt_study *study, int32_t line, int32_t m) {
    const size_t room = (size_t)study->case_count;
    int32_t *cases = brunt_alloc(room * sizeof *cases);
    double *h = brunt_alloc(room * sizeof *h), *e = brunt_alloc(room * sizeof *e);
    double level = NAN;
    if (cases && h && e) {
        int32_t n = 0, count = brunt_study_line_cases(study, line, cases);
        for (int32_t i = 0; i < count; i++) {
            const brunt_study_case *c = &study->cases[cases[i]];
            h[n] = brunt_study_resolution(study, c), e[n] = c->error[m];
            if (h[n] > 0 && e[n] > 0 && isfinite(e[n]) && !brunt_study_is_limit(study, c, m)) n++;
        }
        level = level_from(h, e, n);
    }
    brunt_free(cases), brunt_free(h), brunt_free(e);
    return level;
}

brunt_study_fit brunt_study_price(const brunt_study *study, int32_t line, int32_t m) {
    const size_t room = (size_t)study->case_count;
    double *error = brunt_alloc(room * sizeof *error), *wall = brunt_alloc(room * sizeof *wall);
    brunt_study_fit fit = {0, NAN, NAN, NAN};
    if (error && wall) {
        int32_t n = 0;
        for (int32_t i = 0; i < study->case_count; i++) {
            const brunt_study_case *c = &study->cases[i];
            if (!finished(c) || !(line < 0 ? c->front[m] : c->line == line)) continue;
            if (brunt_study_is_limit(study, c, m)) continue;
            error[n] = c->error[m], wall[n++] = c->wall_median;
        }
        fit = brunt_study_line_fit(error, wall, n);
    }
    brunt_free(error), brunt_free(wall);
    return fit;
}

// --- words

const char *brunt_study_line_label(const brunt_study *study, int32_t line) {
    return study->lines[line].label[0] ? study->lines[line].label : "the scene";
}

const char *brunt_study_resolution_label(const brunt_study *study, double resolution) {
    if (study->resolution < 0) return "";
    const brunt_study_axis *axis = &study->axes[study->resolution];
    for (int32_t v = 0; v < axis->value_count; v++)
        if (axis->values[v].number == resolution) return axis->values[v].label;
    return "";
}

void brunt_study_case_label(const brunt_study *study, const brunt_study_case *c, char out[320]) {
    const char *line = study->lines[c->line].label;
    if (study->resolution < 0) {
        snprintf(out, 320, "%s", brunt_study_line_label(study, c->line));
        return;
    }
    const brunt_study_axis *axis = &study->axes[study->resolution];
    snprintf(out, 320, "%s%s%s = %s", line, line[0] ? ", " : "", axis->name,
             axis->values[c->value[study->resolution]].label);
}

// Two digits, three where the first is a 1: the same share is lost by rounding everywhere.
static void digits(double value, char *out, size_t size) {
    if (value == 0) {
        snprintf(out, size, "0");
        return;
    }
    char trial[32];
    snprintf(trial, sizeof trial, "%.1e", value);
    const int exponent = atoi(strchr(trial, 'e') + 1), count = trial[value < 0] == '1' ? 3 : 2;
    if (exponent >= count)
        snprintf(out, size, "%.0f", value);
    else
        snprintf(out, size, "%.*g", count, value);
}

void brunt_study_format_percent(double ratio, char out[32]) {
    if (!isfinite(ratio)) {
        snprintf(out, 32, "-");
    } else if (ratio != 0 && fabs(ratio) < 1e-6) {
        snprintf(out, 32, "%.1e", ratio);
    } else {
        char text[24];
        digits(100 * ratio, text, sizeof text);
        snprintf(out, 32, "%s %%", text);
    }
}

void brunt_study_format_seconds(double seconds, char out[32]) {
    static const struct {
        double factor, below; // [s]
        const char *unit;
    } units[] = {{1e-9, 1e-6, "ns"}, {1e-6, 1e-3, "us"}, {1e-3, 1, "ms"},
                 {1, 600, "s"},      {60, 7200, "min"},  {3600, INFINITY, "h"}};
    if (!isfinite(seconds)) {
        snprintf(out, 32, "-");
        return;
    }
    char text[32];
    snprintf(text, sizeof text, "%.2e", seconds);
    const double rounded = strtod(text, NULL); // 999.7 ms are 1 s
    size_t u = 0;
    while (rounded >= units[u].below) u++;
    const double value = rounded / units[u].factor;
    if (value >= 100)
        snprintf(out, 32, "%.0f %s", value, units[u].unit);
    else
        snprintf(out, 32, "%.3g %s", value, units[u].unit);
}

void brunt_study_format_factor(double factor, char out[32]) {
    if (!isfinite(factor))
        snprintf(out, 32, "-");
    else if (factor >= 1e6)
        snprintf(out, 32, "%.1e", factor);
    else
        digits(factor, out, 32);
}

void brunt_study_format_slope(const brunt_study_fit *fit, double sign, char out[48]) {
    const double slope = sign * fit->slope, u = fit->uncertainty;
    if (!isfinite(slope)) {
        out[0] = 0;
    } else if (!isfinite(u)) {
        snprintf(out, 48, "%.2f", slope);
    } else {
        const int decimals = u >= 9.5 ? 0 : u >= 0.95 ? 1 : u >= 0.0095 ? 2 : 3;
        snprintf(out, 48, "%.*f ± %.*f", decimals, slope, decimals, u);
    }
}

void brunt_study_format_value(double value, double uncertainty, char out[64]) {
    if (!isfinite(value)) {
        snprintf(out, 64, "-");
        return;
    }
    if (!(uncertainty > 1e-9 * fabs(value)) || !isfinite(uncertainty) || value == 0) {
        snprintf(out, 64, "%.6g", value);
        return;
    }
    const int exponent = (int)floor(log10(fabs(value)));
    const bool fixed = exponent >= -4 && exponent < 6;
    const double power = fixed ? 1 : pow(10, exponent), u = uncertainty / power;
    int decimals = (int)ceil(-log10(u)) + (u * pow(10, ceil(-log10(u))) < 2);
    decimals = decimals < 0 ? 0 : decimals > 12 ? 12 : decimals;
    if (fixed)
        snprintf(out, 64, "%.*f ± %.*f", decimals, value, decimals, u);
    else
        snprintf(out, 64, "(%.*f ± %.*f)e%d", decimals, value / power, decimals, u, exponent);
}
