// report.md: the answers of a study in sentences first, then the tables they come from.
#include "io/study/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/file/atomic_file.h"
#include "base/error.h"
#include "io/performance/machine.h"
#include "base/memory.h"
#include "base/real.h"
#include "io/study/study_view.h"

static bool finished(const brunt_study_case *c) { return c->status == BRUNT_STUDY_DONE; }
static bool judged(const brunt_study_case *c, int32_t m) {
    return finished(c) && isfinite(c->error[m]) && isfinite(c->wall_median);
}

// --- words

// What Markdown would take for its own.
static void put(FILE *out, const char *text) {
    for (const char *t = text; *t; t++) {
        if (strchr("\\`*_|<>[]", *t)) fputc('\\', out);
        fputc((unsigned char)*t < ' ' ? ' ' : *t, out);
    }
}

static void put_case(FILE *out, const brunt_study *study, const brunt_study_case *c) {
    char label[320];
    brunt_study_case_label(study, c, label);
    put(out, label);
}

// " [mm]"; nothing where no run has said the unit.
static void put_unit(FILE *out, const brunt_study *study, int32_t m) {
    const char *unit = brunt_study_unit(study, m);
    if (!unit[0]) return;
    fprintf(out, " [");
    put(out, unit);
    fprintf(out, "]");
}

// A number in words, for one use in an argument.
typedef struct words {
    char text[32];
} words;

static words percent(double ratio) {
    words w;
    brunt_study_format_percent(ratio, w.text);
    return w;
}

static words seconds(double value) {
    words w;
    brunt_study_format_seconds(value, w.text);
    return w;
}

static words factor(double value) {
    words w;
    brunt_study_format_factor(value, w.text);
    return w;
}

static const char *title_of(const brunt_study_measure *m) { return m->title[0] ? m->title : m->name; }

// --- what was run

static int32_t count_of(const brunt_study *study, brunt_study_status status) {
    int32_t count = 0;
    for (int32_t i = 0; i < study->case_count; i++) count += study->cases[i].status == status;
    return count;
}

static bool other_programs(const brunt_study *study) {
    for (int32_t a = 0; a < study->axis_count; a++)
        for (int32_t v = 0; v < study->axes[a].value_count; v++)
            if (study->axes[a].values[v].program[0]) return true;
    return false;
}

static bool other_scenes(const brunt_study *study) {
    for (int32_t a = 0; a < study->axis_count; a++)
        for (int32_t v = 0; v < study->axes[a].value_count; v++)
            if (study->axes[a].values[v].scene[0]) return true;
    return false;
}

// [most - least] / median of the times of a case.
static double noise(const brunt_study_case *c) { return (c->wall_most - c->wall_least) / c->wall_median; }

static void write_noise(FILE *out, const brunt_study *study) {
    double worst = -1, sum = 0;
    int32_t count = 0;
    const brunt_study_case *of = NULL;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (!finished(c) || c->runs < 2 || !isfinite(noise(c))) continue;
        sum += noise(c), count++;
        if (noise(c) > worst) worst = noise(c), of = c;
    }
    if (!count) {
        fprintf(out, "Each was timed once: how far times scatter is not known.\n");
        return;
    }
    fprintf(out, "Between the slowest and the fastest repeat of a run are %s of its median on average, %s at most (",
            percent(sum / count).text, percent(worst).text);
    put_case(out, study, of);
    fprintf(out, ").\n");
}

static void write_setting(FILE *out, const brunt_study *study) {
    char processor[128];
    brunt_machine_processor(processor);
    const char *file = strrchr(study->scene, '/');
    fprintf(out, "Scene ");
    put(out, file ? file + 1 : study->scene);
    if (other_scenes(study)) fprintf(out, " and those that values of the axes name");
    fprintf(out, ", %d combinations of", (int)study->case_count);
    for (int32_t a = 0; a < study->axis_count; a++) {
        fprintf(out, "%s ", a ? "," : "");
        put(out, study->axes[a].name);
        fprintf(out, " (%d)", (int)study->axes[a].value_count);
    }
    const int32_t waiting = count_of(study, BRUNT_STUDY_WAITING), failures = count_of(study, BRUNT_STUDY_FAILED);
    fprintf(out, ": %d finished", (int)count_of(study, BRUNT_STUDY_DONE));
    if (failures) fprintf(out, ", %d failed", (int)failures);
    if (waiting) fprintf(out, ", %d not run yet", (int)waiting);
    fprintf(out, ".\nOn %d %s of %s (%ld cores), brunt " BRUNT_VERSION " in " BRUNT_REAL_NAME " precision%s. ",
            (int)study->threads, study->threads == 1 ? "thread" : "threads", processor, sysconf(_SC_NPROCESSORS_ONLN),
            other_programs(study) ? " unless a value of an axis says otherwise" : "");
    if (!count_of(study, BRUNT_STUDY_DONE)) {
        fprintf(out, "No run has come to its end.\n");
        return;
    }
    if (study->repeats > 1)
        fprintf(out,
                "Times are those of the steps alone, the median of %d repeats that gave the same results to the bit.\n",
                (int)study->repeats);
    else
        fprintf(out, "Times are those of the steps alone.\n");
    write_noise(out, study);
}

// --- which setting reaches what

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
        if (o->line == c->line && judged(o, m) && brunt_study_resolution(study, o) < h &&
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
        if (!judged(c, m) || !reaches(c->error[m], accuracy) || c->line == not_line) continue;
        const brunt_study_case **place = spoiler(study, c, m, accuracy) ? &lucky : &best;
        if (!*place || c->wall_median < (*place)->wall_median ||
            (c->wall_median == (*place)->wall_median && c->error[m] < (*place)->error[m]))
            *place = c;
    }
    if (accidental) *accidental = lucky && (!best || lucky->wall_median < best->wall_median) ? lucky : NULL;
    return best;
}

static const brunt_study_case *most_accurate(const brunt_study *study, int32_t m) {
    const brunt_study_case *best = NULL;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (!judged(c, m)) continue;
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
    return a->wall_least <= b->wall_most && b->wall_least <= a->wall_most;
}

static void write_error(FILE *out, const brunt_study *study, const brunt_study_case *c, int32_t m) {
    fprintf(out, "error %s", percent(c->error[m]).text);
    const double least = brunt_study_resolvable(study, c, m);
    if (brunt_study_doubtful(study, c, m))
        fprintf(out, ", %s the %s that the reference can tell",
                c->error[m] < least * (1 - 1e-9) ? "below" : "no more than", percent(least).text);
}

// The next best of another method, for whom the first is out of the question.
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
    put_case(out, study, second);
    fprintf(out, ", %s%s.", seconds(second->wall_median).text,
            first->runs > 1 && overlap(first, second) ? ", which the scatter of the times does not tell apart" : "");
}

static void write_accident(FILE *out, const brunt_study *study, int32_t m, double accuracy,
                           const brunt_study_case *lucky) {
    const brunt_study_case *why = spoiler(study, lucky, m, accuracy);
    fprintf(out, " (");
    put_case(out, study, lucky);
    fprintf(out, " shows %s after %s, but by accident: ", percent(lucky->error[m]).text,
            seconds(lucky->wall_median).text);
    put_case(out, study, why);
    fprintf(out, " of the same method is off by %s.)", percent(why->error[m]).text);
}

static void write_not_reached(FILE *out, const brunt_study *study, int32_t m, double accuracy,
                              const brunt_study_case *lucky) {
    const brunt_study_case *best = most_accurate(study, m);
    fprintf(out, "not reached%s%s", lucky ? " reliably" : "",
            brunt_study_reference_case(study, m) >= 0 ? " beside the reference" : "");
    if (best && !lucky) {
        words error = percent(best->error[m]);
        if (atof(error.text) <= 100 * accuracy) // rounded, it would look reached
            snprintf(error.text, sizeof error.text, "%.6g %%", 100 * best->error[m]);
        fprintf(out, "; the nearest is %s, by ", error.text);
        put_case(out, study, best);
        fprintf(out, " in %s", seconds(best->wall_median).text);
    }
    fprintf(out, ".");
}

static void write_answers(FILE *out, const brunt_study *study, int32_t m) {
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
            put_case(out, study, best);
            fprintf(out, ": %s%s (", seconds(best->wall_median).text,
                    coarsest_of_line(study, best) ? ", already the coarsest of this method" : "");
            write_error(out, study, best, m);
            fprintf(out, ")");
            if (before)
                fprintf(out, ", %s times the time of %.4g %%", factor(best->wall_median / before->wall_median).text,
                        100 * accuracy_before);
            fprintf(out, ".");
            write_second(out, study, m, accuracies[a], best);
        }
        if (lucky) write_accident(out, study, m, accuracies[a], lucky);
        fprintf(out, "\n");
        if (best) before = best, accuracy_before = accuracies[a];
    }
}

// What the answers above leave out: the run that is the reference, and methods that have none.
static void write_left_out(FILE *out, const brunt_study *study, int32_t m) {
    const int32_t reference = brunt_study_reference_case(study, m);
    if (reference >= 0) {
        fprintf(out, "\nThe reference is ");
        put_case(out, study, &study->cases[reference]);
        fprintf(out, " (%s) itself.\n", seconds(study->cases[reference].wall_median).text);
    }
    if (!count_of(study, BRUNT_STUDY_DONE)) return;
    for (int32_t l = 0; l < study->line_count; l++) {
        char why[160];
        if (!brunt_study_lacks_limit(study, l, m, why)) continue;
        fprintf(out, "\n");
        put(out, brunt_study_line_label(study, l));
        fprintf(out, " has no limit: %s%s.\n", why, most_accurate(study, m) ? "; it is not among these" : "");
    }
}

// --- what the next digit costs

// time ~ error^-q: a digit costs 10^q.
static void write_price(FILE *out, const brunt_study_fit *fit) {
    const double q = -fit->slope;
    char slope[48];
    brunt_study_format_slope(fit, -1, slope);
    fprintf(out, "time grows as error^-q with q = %s", slope);
    if (isnan(fit->uncertainty)) {
        fprintf(out, " (by two runs: no interval), so that a ten times smaller error takes %s times the time",
                factor(pow(10, q)).text);
    } else {
        fprintf(out, " (95 %%), so that a ten times smaller error takes %s times the time", factor(pow(10, q)).text);
        if (fit->uncertainty < 1.5)
            fprintf(out, " (%s to %s)", factor(pow(10, q - fit->uncertainty)).text,
                    factor(pow(10, q + fit->uncertainty)).text);
        else
            fprintf(out, ", which %d points so far from a line do not say well", (int)fit->points);
    }
}

static void write_next_digit(FILE *out, const brunt_study *study, int32_t m) {
    const brunt_study_fit front = brunt_study_price(study, -1, m);
    fprintf(out, "What the next digit costs");
    if (isfinite(front.slope) && front.slope < 0) {
        fprintf(out, ": along the front of %d runs ", (int)front.points);
        write_price(out, &front);
        fprintf(out, ".\n");
        return;
    }
    const brunt_study_case *best = most_accurate(study, m);
    const brunt_study_fit own = best ? brunt_study_price(study, best->line, m) : front;
    if (!best) {
        fprintf(out, " is not known.\n");
    } else if (isfinite(own.slope) && own.slope < 0) {
        fprintf(out, ": the front is one run; along ");
        put(out, brunt_study_line_label(study, best->line));
        fprintf(out, " ");
        write_price(out, &own);
        fprintf(out, ".\n");
    } else {
        fprintf(out, ", these runs do not say: more time bought no less error.\n");
    }
}

static void write_front(FILE *out, const brunt_study *study, int32_t m, int32_t *cases) {
    int32_t count = 0;
    for (int32_t i = 0; i < study->case_count; i++) {
        if (!study->cases[i].front[m]) continue;
        int32_t place = count++;
        for (; place > 0 && study->cases[cases[place - 1]].wall_median > study->cases[i].wall_median; place--)
            cases[place] = cases[place - 1];
        cases[place] = i;
    }
    if (!count) return;
    fprintf(out, "\nOn the front (nothing is both faster and more accurate), from fast to accurate: ");
    for (int32_t i = 0; i < count; i++) {
        const brunt_study_case *c = &study->cases[cases[i]];
        fprintf(out, "%s", i ? "; " : "");
        put_case(out, study, c);
        fprintf(out, " (%s, %s)", seconds(c->wall_median).text, percent(c->error[m]).text);
    }
    fprintf(out, ".\n");
}

// --- methods

static void write_slope_cell(FILE *out, const brunt_study_fit *fit, double sign) {
    char text[48];
    brunt_study_format_slope(fit, sign, text);
    fprintf(out, " %s |", text[0] ? text : "-");
}

static const brunt_study_case *best_of_line(const brunt_study *study, int32_t line, int32_t m) {
    const brunt_study_case *best = NULL;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (c->line == line && judged(c, m) && (!best || c->error[m] < best->error[m])) best = c;
    }
    return best;
}

static void write_methods(FILE *out, const brunt_study *study, int32_t m) {
    fprintf(out, "\n| method | runs | least error | order of the error | order of theory | order without reference | "
                 "limit");
    put_unit(out, study, m);
    fprintf(out, " | time over size | time over accuracy |\n"
                 "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (int32_t l = 0; l < study->line_count; l++) {
        const brunt_study_line *line = &study->lines[l];
        const brunt_study_case *best = best_of_line(study, l, m);
        const brunt_study_fit price = brunt_study_price(study, l, m);
        int32_t runs = 0, all = 0;
        for (int32_t i = 0; i < study->case_count; i++)
            if (study->cases[i].line == l) all++, runs += finished(&study->cases[i]);
        fprintf(out, "| ");
        put(out, brunt_study_line_label(study, l));
        fprintf(out, " | %d of %d | %s |", (int)runs, (int)all, best ? percent(best->error[m]).text : "-");
        write_slope_cell(out, &line->order[m], 1);
        if (isfinite(study->measures[m].order))
            fprintf(out, " %.3g |", study->measures[m].order);
        else
            fprintf(out, " - |");
        if (isfinite(line->observed_order[m]))
            fprintf(out, " %.2f |", line->observed_order[m]);
        else
            fprintf(out, " %s |", isfinite(line->limit[m]) && !line->settled[m] ? "the same values" : "-");
        char limit[64];
        brunt_study_format_value(line->limit[m], line->limit_uncertainty[m], limit);
        fprintf(out, " %s%s |", limit, line->settled[m] ? " (settled, not extrapolated)" : "");
        write_slope_cell(out, &line->cost, 1);
        write_slope_cell(out, &price, -1);
        fprintf(out, "\n");
    }
    if (m) return; // said once
    fprintf(out,
            "\nOrder of the error: p of error ~ %s^p. Order without reference and limit: of the three finest results "
            "(Richardson). "
            "Time over size: q of time ~ (particles + elements)^q. Time over accuracy: q of time ~ error^-q. "
            "Intervals: 95 %% by Student's t, "
            "of three points and more.\n",
            study->resolution >= 0 ? study->axes[study->resolution].name : "resolution");
}

// Whose limits are no extrapolation.
static void write_settled(FILE *out, const brunt_study *study, int32_t m) {
    int32_t count = 0;
    for (int32_t l = 0; l < study->line_count; l++) {
        if (!study->lines[l].settled[m]) continue;
        fprintf(out, "%s", count++ ? "; " : "\nSettled, not extrapolated, are the limits of ");
        put(out, brunt_study_line_label(study, l));
    }
    if (count)
        fprintf(out, ": their finest values show no order, but the last change is smaller than the one before. The "
                     "limit is the finest value, that change its uncertainty, and the error of the finest run.\n");
}

static void write_reference(FILE *out, const brunt_study *study, int32_t m) {
    const brunt_study_measure *measure = &study->measures[m];
    const brunt_study_case *any = NULL;
    for (int32_t i = 0; i < study->case_count && !any; i++)
        if (judged(&study->cases[i], m)) any = &study->cases[i];
    fprintf(out, "The errors are relative to ");
    brunt_study_truth truth = any ? brunt_study_truth_of(study, any, m) : (brunt_study_truth){NAN, NAN, -1, -1};
    char value[64];
    brunt_study_format_value(truth.value, truth.uncertainty, value);
    const char *unit = any && strcmp(any->unit[m], "1") ? any->unit[m] : "";
    switch (measure->reference) {
    case BRUNT_REFERENCE_NUMBER:
        if (isnan(measure->exact))
            fprintf(out, "what the scene expects");
        else
            fprintf(out, "%.10g%s%s", measure->exact, *unit ? " " : "", unit);
        break;
    case BRUNT_REFERENCE_TABLE:
        fprintf(out, "a value for each ");
        put(out, study->axes[measure->table_axis].name);
        break;
    case BRUNT_REFERENCE_FINEST:
        fprintf(out, "the finest run");
        if (truth.finest >= 0) {
            fprintf(out, ", ");
            put_case(out, study, &study->cases[truth.finest]);
            fprintf(out,
                    " (%s%s%s), which therefore has none itself; those of runs near it in resolution come out too "
                    "small, and the order too high",
                    value, unit[0] ? " " : "", unit);
        }
        break;
    case BRUNT_REFERENCE_RICHARDSON:
        if (measure->of[0] && truth.line >= 0) {
            fprintf(out, "the limit of ");
            put(out, brunt_study_line_label(study, truth.line));
            fprintf(out, ", %s%s%s, %s", value, unit[0] ? " " : "", unit,
                    study->lines[truth.line].settled[m]
                        ? "its finest result: the values have settled, and are not extrapolated"
                        : "extrapolated from its three finest results");
        } else {
            fprintf(out, "each method's own limit, extrapolated from its three finest results: methods that go to "
                         "different limits are each measured by their own");
        }
        break;
    }
    if (isfinite(measure->scale))
        fprintf(out, "; they are given in parts of %.6g%s%s", measure->scale, *unit ? " " : "", unit);
    fprintf(out, ".\n");
    if (measure->reference == BRUNT_REFERENCE_RICHARDSON && !measure->of[0]) write_settled(out, study, m);
}

static void write_plateaus(FILE *out, const brunt_study *study, int32_t m) {
    for (int32_t l = 0; l < study->line_count; l++) {
        const double h = brunt_study_plateau(study, l, m);
        if (isnan(h)) continue;
        fprintf(out, "\nThe error of ");
        put(out, brunt_study_line_label(study, l));
        fprintf(out, " no longer falls below ");
        put(out, study->axes[study->resolution].name);
        fprintf(out, " = ");
        put(out, brunt_study_resolution_label(study, h));
        fprintf(out,
                ": something else than the resolution bounds it, and the order above is that of the whole line.\n");
    }
}

static void write_doubts(FILE *out, const brunt_study *study, int32_t m) {
    int32_t below = 0, zero = 0, without = 0;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        const bool reference = finished(c) && brunt_study_truth_of(study, c, m).finest == i;
        zero += judged(c, m) && c->error[m] == 0;
        below += judged(c, m) && brunt_study_doubtful(study, c, m);
        without += finished(c) && !isfinite(c->error[m]) && !reference;
    }
    if (below)
        fprintf(
            out,
            "\nErrors marked ? (%d) are not above what the reference can tell: they say that the run is at least as "
            "good as the reference, no more.\n",
            (int)below);
    if (zero)
        fprintf(out, "\n%d %s the reference to the last bit; logarithms, and so the fits, leave %s out.\n", (int)zero,
                zero == 1 ? "run meets" : "runs meet", zero == 1 ? "it" : "them");
    if (without)
        fprintf(out, "\n%d finished %s no error: %s.\n", (int)without, without == 1 ? "run has" : "runs have",
                study->measures[m].reference == BRUNT_REFERENCE_RICHARDSON
                    ? "the three finest values of the method go to no limit"
                    : "there is nothing to compare with, or it is zero and no scale is given");
}

static void write_measure(FILE *out, const brunt_study *study, int32_t m, int32_t *cases) {
    fprintf(out, "\n## ");
    put(out, title_of(&study->measures[m]));
    fprintf(out, "\n\n");
    if (!most_accurate(study, m)) {
        fprintf(out, "No finished run has an error to speak of.\n");
        write_left_out(out, study, m);
        write_doubts(out, study, m);
        return;
    }
    write_answers(out, study, m);
    write_left_out(out, study, m);
    fprintf(out, "\n");
    write_next_digit(out, study, m);
    write_front(out, study, m, cases);
    write_methods(out, study, m);
    fprintf(out, "\n");
    write_reference(out, study, m);
    write_plateaus(out, study, m);
    write_doubts(out, study, m);
}

// --- failures, pictures, all runs

static void write_failures(FILE *out, const brunt_study *study) {
    if (!count_of(study, BRUNT_STUDY_FAILED)) return;
    fprintf(out, "\n## What failed\n\n");
    for (int32_t i = 0; i < study->case_count; i++) {
        if (study->cases[i].status != BRUNT_STUDY_FAILED) continue;
        fprintf(out, "- ");
        put_case(out, study, &study->cases[i]);
        fprintf(out, ": ");
        put(out, study->cases[i].reason[0] ? study->cases[i].reason : "no reason is known");
        fprintf(out, "\n");
    }
}

static int write_picture(FILE *out, const char *folder, const char *name, const char *title, const char *over) {
    char path[BRUNT_PATH_LENGTH], file[192];
    snprintf(file, sizeof file, "%s.png", name);
    if (brunt_join_path(path, folder, file, NULL) || !brunt_file_exists(path)) return 0;
    fprintf(out, "\n![");
    put(out, title);
    fprintf(out, " over %s](%s)\n", over, file);
    return 1;
}

static bool has_script(const char *folder, const char *name) {
    char path[BRUNT_PATH_LENGTH], file[192];
    snprintf(file, sizeof file, "%s.gp", name);
    return !brunt_join_path(path, folder, file, NULL) && brunt_file_exists(path);
}

static bool has_scripts(const brunt_study *study, const char *folder) {
    bool any = has_script(folder, "study_order") || has_script(folder, "study_cost");
    for (int32_t m = 0; m < study->measure_count && !any; m++) {
        char name[160];
        brunt_study_picture_name(study, m, name);
        any = has_script(folder, name);
    }
    return any;
}

static void write_pictures(FILE *out, const brunt_study *study, const char *folder) {
    if (!has_scripts(study, folder)) return;
    fprintf(out, "\n## Pictures\n");
    int drawn = 0;
    for (int32_t m = 0; m < study->measure_count; m++) {
        char name[160];
        brunt_study_picture_name(study, m, name);
        drawn += write_picture(out, folder, name, title_of(&study->measures[m]), "time");
    }
    if (study->resolution >= 0)
        drawn += write_picture(out, folder, "study_order", title_of(&study->measures[0]), "resolution");
    drawn += write_picture(out, folder, "study_cost", "time", "size");
    fprintf(out, "\n%s drawn by the script of its name (`gnuplot study.gp`), which holds its data.\n",
            drawn ? "Each is" : "There are none here; each would be");
}

// A cell; `format` takes a double.
static void put_number(FILE *out, const char *format, double value) {
    char text[32] = "-";
    if (isfinite(value)) snprintf(text, sizeof text, format, value);
    fprintf(out, " %s |", text);
}

static void write_result(FILE *out, const brunt_study *study, const brunt_study_case *c, int32_t m) {
    put_number(out, "%.6g", c->result[m]);
    const bool reference =
        brunt_study_truth_of(study, c, m).finest >= 0 && c == &study->cases[brunt_study_truth_of(study, c, m).finest];
    if (reference)
        fprintf(out, " reference |");
    else
        fprintf(out, " %s%s%s |", percent(c->error[m]).text,
                judged(c, m) && brunt_study_doubtful(study, c, m) ? " ?" : "", c->front[m] ? " ★" : "");
}

static void write_runs(FILE *out, const brunt_study *study, int32_t *cases) {
    fprintf(out, "\n## All runs\n\n| run | particles + elements | steps | time | least to most | memory [MB] |");
    for (int32_t m = 0; m < study->measure_count; m++) {
        fprintf(out, " ");
        put(out, study->measures[m].name);
        put_unit(out, study, m);
        fprintf(out, " | error |");
    }
    fprintf(out, "\n| --- | --- | --- | --- | --- | --- |");
    for (int32_t m = 0; m < study->measure_count; m++) fprintf(out, " --- | --- |");
    fprintf(out, "\n");
    for (int32_t l = 0; l < study->line_count; l++) {
        const int32_t count = brunt_study_line_cases(study, l, cases);
        for (int32_t i = 0; i < count; i++) {
            const brunt_study_case *c = &study->cases[cases[i]];
            fprintf(out, "| ");
            put_case(out, study, c);
            if (!finished(c)) {
                fprintf(out, " | - | - | %s | - | - |", c->status == BRUNT_STUDY_FAILED ? "failed" : "not run yet");
                for (int32_t m = 0; m < study->measure_count; m++) fprintf(out, " - | - |");
            } else {
                fprintf(out, " |");
                put_number(out, "%.0f", c->units), put_number(out, "%.0f", c->steps);
                fprintf(out, " %s |", seconds(c->wall_median).text);
                if (c->runs > 1)
                    fprintf(out, " %s to %s |", seconds(c->wall_least).text, seconds(c->wall_most).text);
                else
                    fprintf(out, " - |");
                put_number(out, "%.3g", c->peak_bytes / 1e6);
                for (int32_t m = 0; m < study->measure_count; m++) write_result(out, study, c, m);
            }
            fprintf(out, "\n");
        }
    }
    if (count_of(study, BRUNT_STUDY_DONE)) fprintf(out, "\n★ on the front.\n");
}

int brunt_study_write_report(const brunt_study *study, const char *folder, brunt_error *error) {
    char path[BRUNT_PATH_LENGTH];
    brunt_atomic_file file;
    int32_t *cases = brunt_alloc((size_t)study->case_count * sizeof *cases);
    if (!cases) return brunt_fail(error, BRUNT_IO_ERROR, "no memory for the report of the study");
    int status = brunt_join_path(path, folder, "report.md", error);
    if (!status) status = brunt_atomic_open(&file, path, error);
    if (!status) {
        FILE *out = file.stream;
        fprintf(out, "# ");
        put(out, study->title[0] ? study->title : study->name);
        fprintf(out, "\n\n");
        write_setting(out, study);
        for (int32_t m = 0; m < study->measure_count; m++) write_measure(out, study, m, cases);
        write_failures(out, study);
        write_pictures(out, study, folder);
        write_runs(out, study, cases);
        status = brunt_atomic_commit(&file, error);
    }
    brunt_free(cases);
    return status;
}
