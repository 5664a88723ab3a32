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
#include "io/study/report_text.h"
#include "io/study/study_answers.h"
#include "io/study/study_view.h"

// --- what was run

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
static double noise(const brunt_study_case *c) { return (c->wall_greatest - c->wall_least) / c->wall_median; }

static void write_noise(FILE *out, const brunt_study *study) {
    double worst = -1, sum = 0;
    int32_t count = 0;
    const brunt_study_case *of = NULL;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (!report_finished(c) || c->runs < 2 || !isfinite(noise(c))) continue;
        sum += noise(c), count++;
        if (noise(c) > worst) worst = noise(c), of = c;
    }
    if (!count) {
        fprintf(out, "Each was timed once: how far times scatter is not known.\n");
        return;
    }
    fprintf(out, "Between the slowest and the fastest repeat of a run are %s of its median on average, %s at most (",
            report_percent(sum / count).text, report_percent(worst).text);
    report_put_case(out, study, of);
    fprintf(out, ").\n");
}

static void write_setting(FILE *out, const brunt_study *study) {
    char processor[128];
    brunt_machine_processor(processor);
    const char *file = strrchr(study->scene, '/');
    fprintf(out, "Scene ");
    report_put(out, file ? file + 1 : study->scene);
    if (other_scenes(study)) fprintf(out, " and those that values of the axes name");
    fprintf(out, ", %d combinations of", (int)study->case_count);
    for (int32_t a = 0; a < study->axis_count; a++) {
        fprintf(out, "%s ", a ? "," : "");
        report_put(out, study->axes[a].name);
        fprintf(out, " (%d)", (int)study->axes[a].value_count);
    }
    const int32_t waiting = report_count(study, BRUNT_STUDY_WAITING),
                  failures = report_count(study, BRUNT_STUDY_FAILED);
    fprintf(out, ": %d finished", (int)report_count(study, BRUNT_STUDY_DONE));
    if (failures) fprintf(out, ", %d failed", (int)failures);
    if (waiting) fprintf(out, ", %d not run yet", (int)waiting);
    fprintf(out, ".\nOn %d %s of %s (%ld cores), brunt " BRUNT_VERSION " in " BRUNT_REAL_NAME " precision%s. ",
            (int)study->threads, study->threads == 1 ? "thread" : "threads", processor, sysconf(_SC_NPROCESSORS_ONLN),
            other_programs(study) ? " unless a value of an axis says otherwise" : "");
    if (!report_count(study, BRUNT_STUDY_DONE)) {
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

// --- what the next digit costs

// time ~ error^-q: a digit costs 10^q.
static void write_price(FILE *out, const brunt_study_fit *fit) {
    const double q = -fit->slope;
    char slope[48];
    brunt_study_format_slope(fit, -1, slope);
    fprintf(out, "time grows as error^-q with q = %s", slope);
    if (isnan(fit->uncertainty)) {
        fprintf(out, " (by two runs: no interval), so that a ten times smaller error takes %s times the time",
                report_factor(pow(10, q)).text);
    } else {
        fprintf(out, " (95 %%), so that a ten times smaller error takes %s times the time",
                report_factor(pow(10, q)).text);
        if (fit->uncertainty < 1.5)
            fprintf(out, " (%s to %s)", report_factor(pow(10, q - fit->uncertainty)).text,
                    report_factor(pow(10, q + fit->uncertainty)).text);
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
    const brunt_study_case *best = report_most_accurate(study, m);
    const brunt_study_fit own = best ? brunt_study_price(study, best->line, m) : front;
    if (!best) {
        fprintf(out, " is not known.\n");
    } else if (isfinite(own.slope) && own.slope < 0) {
        fprintf(out, ": the front is one run; along ");
        report_put(out, brunt_study_line_label(study, best->line));
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
        report_put_case(out, study, c);
        fprintf(out, " (%s, %s)", report_seconds(c->wall_median).text, report_percent(c->error[m]).text);
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
        if (c->line == line && report_judged(c, m) && (!best || c->error[m] < best->error[m])) best = c;
    }
    return best;
}

static void write_methods(FILE *out, const brunt_study *study, int32_t m) {
    fprintf(out, "\n| method | runs | least error | order of the error | order of theory | order without reference | "
                 "limit");
    report_put_unit(out, study, m);
    fprintf(out, " | time over size | time over accuracy |\n"
                 "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (int32_t l = 0; l < study->line_count; l++) {
        const brunt_study_line *line = &study->lines[l];
        const brunt_study_case *best = best_of_line(study, l, m);
        const brunt_study_fit price = brunt_study_price(study, l, m);
        int32_t runs = 0, all = 0;
        for (int32_t i = 0; i < study->case_count; i++)
            if (study->cases[i].line == l) all++, runs += report_finished(&study->cases[i]);
        fprintf(out, "| ");
        report_put(out, brunt_study_line_label(study, l));
        fprintf(out, " | %d of %d | %s |", (int)runs, (int)all, best ? report_percent(best->error[m]).text : "-");
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
        report_put(out, brunt_study_line_label(study, l));
    }
    if (count)
        fprintf(out, ": their finest values show no order, but the last change is smaller than the one before. The "
                     "limit is the finest value, that change its uncertainty, and the error of the finest run.\n");
}

static void write_reference(FILE *out, const brunt_study *study, int32_t m) {
    const brunt_study_measure *measure = &study->measures[m];
    const brunt_study_case *any = NULL;
    for (int32_t i = 0; i < study->case_count && !any; i++)
        if (report_judged(&study->cases[i], m)) any = &study->cases[i];
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
        report_put(out, study->axes[measure->table_axis].name);
        break;
    case BRUNT_REFERENCE_FINEST:
        fprintf(out, "the finest run");
        if (truth.finest >= 0) {
            fprintf(out, ", ");
            report_put_case(out, study, &study->cases[truth.finest]);
            fprintf(out,
                    " (%s%s%s), which therefore has none itself; those of runs near it in resolution come out too "
                    "small, and the order too high",
                    value, unit[0] ? " " : "", unit);
        }
        break;
    case BRUNT_REFERENCE_RICHARDSON:
        if (measure->of[0] && truth.line >= 0) {
            fprintf(out, "the limit of ");
            report_put(out, brunt_study_line_label(study, truth.line));
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
        report_put(out, brunt_study_line_label(study, l));
        fprintf(out, " no longer falls below ");
        report_put(out, study->axes[study->resolution].name);
        fprintf(out, " = ");
        report_put(out, brunt_study_resolution_label(study, h));
        fprintf(out,
                ": something else than the resolution bounds it, and the order above is that of the whole line.\n");
    }
}

static void write_doubts(FILE *out, const brunt_study *study, int32_t m) {
    int32_t below = 0, zero = 0, without = 0;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        const bool reference = report_finished(c) && brunt_study_truth_of(study, c, m).finest == i;
        zero += report_judged(c, m) && c->error[m] == 0;
        below += report_judged(c, m) && brunt_study_doubtful(study, c, m);
        without += report_finished(c) && !isfinite(c->error[m]) && !reference;
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
    report_put(out, report_title(&study->measures[m]));
    fprintf(out, "\n\n");
    if (!report_most_accurate(study, m)) {
        fprintf(out, "No finished run has an error to speak of.\n");
        report_write_left_out(out, study, m);
        write_doubts(out, study, m);
        return;
    }
    report_write_answers(out, study, m);
    report_write_left_out(out, study, m);
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
    if (!report_count(study, BRUNT_STUDY_FAILED)) return;
    fprintf(out, "\n## What failed\n\n");
    for (int32_t i = 0; i < study->case_count; i++) {
        if (study->cases[i].status != BRUNT_STUDY_FAILED) continue;
        fprintf(out, "- ");
        report_put_case(out, study, &study->cases[i]);
        fprintf(out, ": ");
        report_put(out, study->cases[i].reason[0] ? study->cases[i].reason : "no reason is known");
        fprintf(out, "\n");
    }
}

static int write_picture(FILE *out, const char *folder, const char *name, const char *title, const char *over) {
    char path[BRUNT_PATH_LENGTH], file[192];
    snprintf(file, sizeof file, "%s.png", name);
    if (brunt_join_path(path, folder, file, NULL) || !brunt_file_exists(path)) return 0;
    fprintf(out, "\n![");
    report_put(out, title);
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
        drawn += write_picture(out, folder, name, report_title(&study->measures[m]), "time");
    }
    if (study->resolution >= 0)
        drawn += write_picture(out, folder, "study_order", report_title(&study->measures[0]), "resolution");
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
        fprintf(out, " %s%s%s |", report_percent(c->error[m]).text,
                report_judged(c, m) && brunt_study_doubtful(study, c, m) ? " ?" : "", c->front[m] ? " ★" : "");
}

static void write_runs(FILE *out, const brunt_study *study, int32_t *cases) {
    fprintf(out, "\n## All runs\n\n| run | particles + elements | steps | time | least to most | memory [MB] |");
    for (int32_t m = 0; m < study->measure_count; m++) {
        fprintf(out, " ");
        report_put(out, study->measures[m].name);
        report_put_unit(out, study, m);
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
            report_put_case(out, study, c);
            if (!report_finished(c)) {
                fprintf(out, " | - | - | %s | - | - |", c->status == BRUNT_STUDY_FAILED ? "failed" : "not run yet");
                for (int32_t m = 0; m < study->measure_count; m++) fprintf(out, " - | - |");
            } else {
                fprintf(out, " |");
                put_number(out, "%.0f", c->units), put_number(out, "%.0f", c->steps);
                fprintf(out, " %s |", report_seconds(c->wall_median).text);
                if (c->runs > 1)
                    fprintf(out, " %s to %s |", report_seconds(c->wall_least).text,
                            report_seconds(c->wall_greatest).text);
                else
                    fprintf(out, " - |");
                put_number(out, "%.3g", c->peak_bytes / 1e6);
                for (int32_t m = 0; m < study->measure_count; m++) write_result(out, study, c, m);
            }
            fprintf(out, "\n");
        }
    }
    if (report_count(study, BRUNT_STUDY_DONE)) fprintf(out, "\n★ on the front.\n");
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
        report_put(out, study->title[0] ? study->title : study->name);
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
