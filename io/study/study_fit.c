// From the results of a study to errors, orders, limits and fronts.
//
// Errors are taken to follow e = C h^p, times t = D n^q: straight lines in log-log, drawn by least squares. Where no
// closed form is known, the limit of h -> 0 comes from the values themselves (L. F. Richardson, Phil. Trans. A 210,
// 1911), its uncertainty after P. J. Roache, Annu. Rev. Fluid Mech. 29, 1997.
#include "io/study/study.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "io/study/study_view.h"

// Half width of the two-sided 95 % interval in standard errors, by degrees of freedom from 1 (NIST/SEMATECH e-Handbook
// of Statistical Methods, 1.3.6.7.2).
static double student(int32_t freedom) {
    static const double quantile[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                                      2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
                                      2.080,  2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042};
    const int32_t count = (int32_t)(sizeof quantile / sizeof *quantile);
    return freedom <= count ? quantile[freedom - 1] : 1.96;
}

static bool usable(double x, double y) { return isfinite(x) && isfinite(y) && x > 0 && y > 0; }

// `parameters` that were taken from the same points: each takes a degree of freedom.
static brunt_study_fit fit_line(const double *x, const double *y, int32_t count, int32_t parameters) {
    brunt_study_fit fit = {0, NAN, NAN, NAN};
    double mean_x = 0, mean_y = 0, least = INFINITY, most = 0;
    for (int32_t i = 0; i < count; i++) {
        if (!usable(x[i], y[i])) continue;
        fit.points++;
        mean_x += log(x[i]), mean_y += log(y[i]);
        least = fmin(least, x[i]), most = fmax(most, x[i]);
    }
    if (fit.points < 2 || least == most) return fit;
    mean_x /= fit.points, mean_y /= fit.points;
    double xx = 0, xy = 0;
    for (int32_t i = 0; i < count; i++) {
        if (!usable(x[i], y[i])) continue;
        double dx = log(x[i]) - mean_x;
        xx += dx * dx, xy += dx * (log(y[i]) - mean_y);
    }
    fit.slope = xy / xx;
    fit.intercept = mean_y - fit.slope * mean_x;
    if (fit.points <= parameters) return fit;
    double squares = 0; // of what the line leaves
    for (int32_t i = 0; i < count; i++) {
        if (!usable(x[i], y[i])) continue;
        double rest = log(y[i]) - mean_y - fit.slope * (log(x[i]) - mean_x);
        squares += rest * rest;
    }
    const int32_t freedom = fit.points - parameters;
    fit.uncertainty = student(freedom) * sqrt(squares / freedom / xx);
    return fit;
}

brunt_study_fit brunt_study_line_fit(const double *x, const double *y, int32_t count) {
    return fit_line(x, y, count, 2);
}

// y = L + C x^p gives (y0 - y1) / (y1 - y2) = (x0^p - x1^p) / (x1^p - x2^p), which grows with p: from log(x0/x1) /
// log(x1/x2) at p = 0.
bool brunt_study_richardson(const double x[3], const double y[3], double *limit, double *order) {
    // Below the least order the limit would be more than ten steps beyond the last value (when resolutions halve);
    // above the most it is the last value, by rounding.
    static const double least_order = 0.1, order_limit = 64;
    *limit = *order = NAN;
    for (int i = 0; i < 3; i++)
        if (!isfinite(y[i]) || !isfinite(x[i]) || x[i] <= 0 || (i && x[i] >= x[i - 1])) return false;
    if (y[0] == y[1] && y[1] == y[2]) { // nothing depends on the resolution: exact, and of no order
        *limit = y[2];
        return true;
    }
    const double ratio = (y[0] - y[1]) / (y[1] - y[2]);
    const double a = log(x[0] / x[1]), b = log(x[1] / x[2]);
    double low = least_order, high = order_limit;
#define RATIO_OF(p) (expm1((p)*a) / -expm1(-(p)*b))
    if (!isfinite(ratio) || !(ratio > RATIO_OF(low)) || !(ratio < RATIO_OF(high))) return false;
    for (int i = 0; i < 200 && high - low > 4e-16 * high; i++) {
        double middle = 0.5 * (low + high);
        if (RATIO_OF(middle) < ratio)
            low = middle;
        else
            high = middle;
    }
#undef RATIO_OF
    *order = 0.5 * (low + high);
    *limit = y[2] - (y[1] - y[2]) / expm1(*order * b);
    return true;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Not touched where a case brings no times of its own.
static void take_wall(brunt_study_case *c, double *scratch) {
    int32_t count = 0;
    for (int32_t r = 0; c->wall && r < c->runs; r++)
        if (isfinite(c->wall[r])) scratch[count++] = c->wall[r];
    if (!count) return;
    qsort(scratch, (size_t)count, sizeof *scratch, ascending);
    c->wall_least = scratch[0], c->wall_greatest = scratch[count - 1];
    c->wall_median = 0.5 * (scratch[(count - 1) / 2] + scratch[count / 2]);
}

static bool finished(const brunt_study_case *c) { return c->status == BRUNT_STUDY_DONE; }

// Roache's grid convergence index: 1.25 of the way from the finest value to the limit when the order seen is that of
// theory (within a tenth: W. L. Oberkampf, C. J. Roy, Verification and Validation in Scientific Computing, 2010, 8.5),
// 3 of it otherwise.
static double guarded(double distance, double observed, double theory) {
    bool as_theory = isfinite(theory) && fabs(observed - theory) <= 0.1 * theory;
    return (as_theory ? 1.25 : 3) * fabs(distance);
}

// Values that swing, the last change smaller than the one before: the limit is the finest, give or take that change. A
// change of exactly zero would claim a limit known to the bit: there the one before stands for it.
static void settle(brunt_study_line *line, int32_t m, const double x[3], const double y[3]) {
    for (int i = 0; i < 3; i++)
        if (!(x[i] > 0) || (i && x[i] >= x[i - 1])) return;
    const double before = fabs(y[1] - y[0]), last = fabs(y[2] - y[1]);
    // One that creeps on in the same direction has not settled, however slowly.
    if (!(last < before) || !isfinite(before) || (y[1] - y[0]) * (y[2] - y[1]) > 0) return;
    line->settled[m] = true;
    line->limit[m] = y[2];
    line->limit_uncertainty[m] = last > 0 ? last : before;
}

// The limit by the three finest results; `x`, `y` from the coarsest to the finest.
static void extrapolate(brunt_study_line *line, int32_t m, const double *x, const double *y, int32_t count,
                        double theory) {
    line->limit[m] = line->limit_uncertainty[m] = line->observed_order[m] = NAN;
    line->settled[m] = false;
    if (count < 3) return;
    if (!brunt_study_richardson(x + count - 3, y + count - 3, &line->limit[m], &line->observed_order[m])) {
        settle(line, m, x + count - 3, y + count - 3);
        return;
    }
    double coarser, order;
    if (count > 3 && brunt_study_richardson(x + count - 4, y + count - 4, &coarser, &order))
        line->limit_uncertainty[m] = fabs(line->limit[m] - coarser);
    else
        line->limit_uncertainty[m] = guarded(line->limit[m] - y[count - 1], line->observed_order[m], theory);
}

typedef struct scratch {
    int32_t *cases; // of a line
    double *x, *y;
} scratch;

static void take_limits(brunt_study *study, int32_t l, scratch *s) {
    const int32_t count = brunt_study_line_cases(study, l, s->cases);
    for (int32_t m = 0; m < study->measure_count; m++) {
        int32_t n = 0;
        for (int32_t i = 0; i < count; i++) {
            const brunt_study_case *c = &study->cases[s->cases[i]];
            s->x[n] = brunt_study_resolution(study, c), s->y[n] = c->result[m];
            if (finished(c) && isfinite(s->x[n]) && isfinite(s->y[n])) n++;
        }
        extrapolate(&study->lines[l], m, s->x, s->y, n, study->measures[m].order);
    }
}

static double error_of(const brunt_study *study, const brunt_study_case *c, int32_t m) {
    brunt_study_truth truth = brunt_study_truth_of(study, c, m);
    if (!finished(c) || !isfinite(truth.value) || !isfinite(c->result[m])) return NAN;
    if (truth.finest >= 0 && c == &study->cases[truth.finest])
        return NAN; // it is its own measure: 0 would look accurate
    double distance = fabs(c->result[m] - truth.value), scale = brunt_study_scale_of(study, c, m);
    if (brunt_study_is_limit(study, c, m)) distance = truth.uncertainty;
    return scale > 0 ? distance / scale : NAN; // relative to zero: nothing is
}

// A limit that came from the line's own points leaves one degree of freedom less.
static bool own_limit(const brunt_study *study, int32_t l, int32_t m, const brunt_study_case *c) {
    return study->measures[m].reference == BRUNT_REFERENCE_RICHARDSON && brunt_study_truth_of(study, c, m).line == l;
}

static void take_fits(brunt_study *study, int32_t l, scratch *s) {
    brunt_study_line *line = &study->lines[l];
    const int32_t count = brunt_study_line_cases(study, l, s->cases);
    for (int32_t m = 0; m < study->measure_count; m++) {
        for (int32_t i = 0; i < count; i++) {
            const brunt_study_case *c = &study->cases[s->cases[i]];
            s->x[i] = brunt_study_resolution(study, c);
            s->y[i] = brunt_study_is_limit(study, c, m) ? NAN : c->error[m];
        }
        bool own = count > 0 && own_limit(study, l, m, &study->cases[s->cases[0]]);
        line->order[m] = fit_line(s->x, s->y, count, own ? 3 : 2);
    }
    for (int32_t i = 0; i < count; i++) {
        const brunt_study_case *c = &study->cases[s->cases[i]];
        s->x[i] = c->units, s->y[i] = finished(c) ? c->wall_median : NAN;
    }
    line->cost = fit_line(s->x, s->y, count, 2);
}

static bool judged(const brunt_study_case *c, int32_t m) {
    return finished(c) && isfinite(c->error[m]) && isfinite(c->wall_median);
}

// Equal ones are on the front together.
static bool on_front(const brunt_study *study, const brunt_study_case *c, int32_t m) {
    if (!judged(c, m)) return false;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *o = &study->cases[i];
        if (!judged(o, m) || o->wall_median > c->wall_median || o->error[m] > c->error[m]) continue;
        if (o->wall_median < c->wall_median || o->error[m] < c->error[m]) return false;
    }
    return true;
}

static void forget(brunt_study *study) {
    const brunt_study_fit none = {0, NAN, NAN, NAN};
    for (int32_t i = 0; i < study->case_count; i++)
        for (int32_t m = 0; m < BRUNT_STUDY_MEASURES; m++)
            study->cases[i].error[m] = NAN, study->cases[i].front[m] = false;
    for (int32_t l = 0; l < study->line_count; l++) {
        brunt_study_line *line = &study->lines[l];
        line->cost = none;
        for (int32_t m = 0; m < BRUNT_STUDY_MEASURES; m++) {
            line->order[m] = none;
            line->limit[m] = line->limit_uncertainty[m] = line->observed_order[m] = NAN;
            line->settled[m] = false;
        }
    }
}

void brunt_study_analyse(brunt_study *study) {
    forget(study);
    size_t room = (size_t)study->case_count;
    for (int32_t i = 0; i < study->case_count; i++)
        if (study->cases[i].runs > 0 && (size_t)study->cases[i].runs > room) room = (size_t)study->cases[i].runs;
    scratch s = {brunt_alloc(room * sizeof *s.cases), brunt_alloc(room * sizeof *s.x), brunt_alloc(room * sizeof *s.y)};
    if (s.cases && s.x && s.y) {
        for (int32_t i = 0; i < study->case_count; i++) take_wall(&study->cases[i], s.x);
        for (int32_t l = 0; l < study->line_count; l++) take_limits(study, l, &s);
        for (int32_t i = 0; i < study->case_count; i++)
            for (int32_t m = 0; m < study->measure_count; m++)
                study->cases[i].error[m] = error_of(study, &study->cases[i], m);
        for (int32_t l = 0; l < study->line_count; l++) take_fits(study, l, &s);
        for (int32_t i = 0; i < study->case_count; i++)
            for (int32_t m = 0; m < study->measure_count; m++)
                study->cases[i].front[m] = on_front(study, &study->cases[i], m);
    }
    brunt_free(s.cases), brunt_free(s.x), brunt_free(s.y);
}
