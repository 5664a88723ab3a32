// Which setting of a study reaches which accuracy, in sentences.
#include "io/study/study_answers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/study/report_text.h"
#include "io/study/study_view.h"

// An error that was meant to be 10 % is, to the bit, a little more or less.
static bool reaches(double error, double accuracy) { return error <= accuracy * (1 + 1e-9); }

static int by_falling(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

// A case whose line goes beyond the accuracy again when it is refined has hit it by accident: an error that changes its
// sign.
static const brunt_study_case *spoiler(const brunt_study *study, const brunt_study_case *c, int32_t m,
                                       double accuracy) {
    const double h = brunt_study_resolution(study, c);
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *o = &study->cases[i];
        if (o->line == c->line && report_judged(o, m) && brunt_study_resolution(study, o) < h &&
            !reaches(o->error[m], accuracy))
            return o;
    }
    return NULL;
}

// The cheapest that reaches it and stays there when refined; `accidental`: the cheapest of those that only seem to,
// when it is cheaper.
static const brunt_study_case *cheapest(const brunt_study *study, int32_t m, double accuracy, int32_t not_line,
                                        const brunt_study_case **accidental) {
    const brunt_study_case *best = NULL, *lucky = NULL;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (!report_judged(c, m) || !reaches(c->error[m], accuracy) || c->line == not_line) continue;
        const brunt_study_case **place = spoiler(study, c, m, accuracy) ? &lucky : &best;
        if (!*place || c->wall_median < (*place)->wall_median ||
            (c->wall_median == (*place)->wall_median && c->error[m] < (*place)->error[m]))
            *place = c;
    }
    if (accidental) *accidental = lucky && (!best || lucky->wall_median < best->wall_median) ? lucky : NULL;
    return best;
}

const brunt_study_case *report_most_accurate(const brunt_study *study, int32_t m) {
    const brunt_study_case *best = NULL;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (!report_judged(c, m)) continue;
        if (!best || c->error[m] < best->error[m] ||
            (c->error[m] == best->error[m] && c->wall_median < best->wall_median))
            best = c;
    }
    return best;
}

static bool coarsest_of_line(const brunt_study *study, const brunt_study_case *c) {
    if (study->resolution < 0) return false;
    const double h = brunt_study_resolution(study, c);
    for (int32_t i = 0; i < study->case_count; i++)
        if (study->cases[i].line == c->line && brunt_study_resolution(study, &study->cases[i]) > h) return false;
    return true;
}

static bool overlap(const brunt_study_case *a, const brunt_study_case *b) {
    return a->wall_least <= b->wall_greatest && b->wall_least <= a->wall_greatest;
}

static void write_error(FILE *out, const brunt_study *study, const brunt_study_case *c, int32_t m) {
    fprintf(out, "error %s", report_percent(c->error[m]).text);
    const double least = brunt_study_resolvable(study, c, m);
    if (brunt_study_doubtful(study, c, m))
        fprintf(out, ", %s the %s that the reference can tell",
                c->error[m] < least * (1 - 1e-9) ? "below" : "no more than", report_percent(least).text);
}

// The next best of another method, where the first is out of the question.
static void write_second(FILE *out, const brunt_study *study, int32_t m, double accuracy,
                         const brunt_study_case *first) {
    const brunt_study_case *second = cheapest(study, m, accuracy, first->line, NULL);
    if (study->line_count < 2) return;
    if (!second) {
        fprintf(out, brunt_study_reference_case(study, m) >= 0 ? " Beside the reference, no other method reaches it."
                                                               : " No other method reaches it.");
        return;
    }
    fprintf(out, " Next best: ");
    report_put_case(out, study, second);
    fprintf(out, ", %s%s.", report_seconds(second->wall_median).text,
            first->runs > 1 && overlap(first, second) ? ", which the scatter of the times does not tell apart" : "");
}

static void write_accident(FILE *out, const brunt_study *study, int32_t m, double accuracy,
                           const brunt_study_case *lucky) {
    const brunt_study_case *why = spoiler(study, lucky, m, accuracy);
    fprintf(out, " (");
    report_put_case(out, study, lucky);
    fprintf(out, " shows %s after %s, but by accident: ", report_percent(lucky->error[m]).text,
            report_seconds(lucky->wall_median).text);
    report_put_case(out, study, why);
    fprintf(out, " of the same method is off by %s.)", report_percent(why->error[m]).text);
}

static void write_not_reached(FILE *out, const brunt_study *study, int32_t m, double accuracy,
                              const brunt_study_case *lucky) {
    const brunt_study_case *best = report_most_accurate(study, m);
    fprintf(out, "not reached%s%s", lucky ? " reliably" : "",
            brunt_study_reference_case(study, m) >= 0 ? " beside the reference" : "");
    if (best && !lucky) {
        words error = report_percent(best->error[m]);
        if (atof(error.text) <= 100 * accuracy) // rounded, it would look reached
            snprintf(error.text, sizeof error.text, "%.6g %%", 100 * best->error[m]);
        fprintf(out, "; the nearest is %s, by ", error.text);
        report_put_case(out, study, best);
        fprintf(out, " in %s", report_seconds(best->wall_median).text);
    }
    fprintf(out, ".");
}

void report_write_answers(FILE *out, const brunt_study *study, int32_t m) {
    double accuracies[BRUNT_STUDY_ACCURACIES];
    memcpy(accuracies, study->accuracies, sizeof accuracies);
    qsort(accuracies, (size_t)study->accuracy_count, sizeof *accuracies, by_falling);
    const brunt_study_case *before = NULL;
    double accuracy_before = 0;
    for (int32_t a = 0; a < study->accuracy_count; a++) {
        const brunt_study_case *lucky, *best = cheapest(study, m, accuracies[a], -1, &lucky);
        fprintf(out, "- **%.4g %%**: ", 100 * accuracies[a]);
        if (!best) {
            write_not_reached(out, study, m, accuracies[a], lucky);
        } else if (best == before) {
            fprintf(out, "the same run (");
            write_error(out, study, best, m);
            fprintf(out, ").");
            write_second(out, study, m, accuracies[a], best);
        } else {
            report_put_case(out, study, best);
            fprintf(out, ": %s%s (", report_seconds(best->wall_median).text,
                    coarsest_of_line(study, best) ? ", already the coarsest of this method" : "");
            write_error(out, study, best, m);
            fprintf(out, ")");
            if (before)
                fprintf(out, ", %s times the time of %.4g %%",
                        report_factor(best->wall_median / before->wall_median).text, 100 * accuracy_before);
            fprintf(out, ".");
            write_second(out, study, m, accuracies[a], best);
        }
        if (lucky) write_accident(out, study, m, accuracies[a], lucky);
        fprintf(out, "\n");
        if (best) before = best, accuracy_before = accuracies[a];
    }
}

void report_write_left_out(FILE *out, const brunt_study *study, int32_t m) {
    const int32_t reference = brunt_study_reference_case(study, m);
    if (reference >= 0) {
        fprintf(out, "\nThe reference is ");
        report_put_case(out, study, &study->cases[reference]);
        fprintf(out, " (%s) itself.\n", report_seconds(study->cases[reference].wall_median).text);
    }
    if (!report_count(study, BRUNT_STUDY_DONE)) return;
    for (int32_t l = 0; l < study->line_count; l++) {
        char why[160];
        if (!brunt_study_lacks_limit(study, l, m, why)) continue;
        fprintf(out, "\n");
        report_put(out, brunt_study_line_label(study, l));
        fprintf(out, " has no limit: %s%s.\n", why, report_most_accurate(study, m) ? "; it is not among these" : "");
    }
}
