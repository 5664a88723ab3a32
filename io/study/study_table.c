// The results of a study as tables: study.csv for spreadsheets, study.json for programs, and one for the terminal.
#include <jansson.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "io/file/atomic_file.h"
#include "base/error.h"
#include "base/memory.h"
#include "io/study/study_view.h"
#include "io/scene/units.h"

static const char *const statuses[] = {"waiting", "done", "failed"};
_Static_assert(BRUNT_COUNT(statuses) == BRUNT_STUDY_FAILED + 1, "a word for each status");

// ---------------------------------------------------------------------------------------------------- study.csv

static void csv_text(FILE *out, const char *text) {
    if (!strpbrk(text, ",\"\n")) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (const char *c = text; *c; c++) {
        if (*c == '"') fputc('"', out);
        fputc(*c == '\n' ? ' ' : *c, out);
    }
    fputc('"', out);
}

// Nothing stands where there is no number.
static void csv_number(FILE *out, double value) {
    char text[32];
    if (!isfinite(value)) return;
    brunt_format_number(value, text);
    fputs(text, out);
}

static bool has_numbers(const brunt_study_axis *axis) {
    for (int32_t v = 0; v < axis->value_count; v++)
        if (isfinite(axis->values[v].number)) return true;
    return false;
}

static void csv_head(const brunt_study *study, FILE *out) {
    fputs("line", out);
    for (int32_t a = 0; a < study->axis_count; a++) {
        fprintf(out, ",%s", study->axes[a].name);
        if (has_numbers(&study->axes[a])) fprintf(out, ",%s_si", study->axes[a].name);
    }
    fputs(",status,reason,steps,units,wall_median_s,wall_least_s,wall_most_s,peak_bytes", out);
    for (int32_t m = 0; m < study->measure_count; m++) {
        const char *name = study->measures[m].name;
        fprintf(out, ",%s,%s_unit,%s_error,%s_front", name, name, name, name);
    }
    fputc('\n', out);
}

static void csv_row(const brunt_study *study, const brunt_study_case *c, FILE *out) {
    csv_text(out, study->lines[c->line].label);
    for (int32_t a = 0; a < study->axis_count; a++) {
        const brunt_study_value *value = &study->axes[a].values[c->value[a]];
        fputc(',', out);
        csv_text(out, value->label);
        if (!has_numbers(&study->axes[a])) continue;
        fputc(',', out);
        csv_number(out, value->number);
    }
    fprintf(out, ",%s,", statuses[c->status]);
    csv_text(out, c->reason);
    bool ran = c->runs > 0;
    const double numbers[] = {c->steps, c->units, c->wall_median, c->wall_least, c->wall_greatest, c->peak_bytes};
    for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++) {
        fputc(',', out);
        csv_number(out, ran ? numbers[n] : NAN);
    }
    for (int32_t m = 0; m < study->measure_count; m++) {
        fputc(',', out);
        csv_number(out, c->result[m]);
        fputc(',', out);
        csv_text(out, c->unit[m]);
        fputc(',', out);
        csv_number(out, c->error[m]);
        fprintf(out, ",%d", c->front[m] ? 1 : 0);
    }
    fputc('\n', out);
}

// ---------------------------------------------------------------------------------------------------- study.json

// JSON knows no infinity and no NAN.
static json_t *number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

static void set_text(json_t *object, const char *key, const char *text) {
    json_t *value = json_string(text);
    json_object_set_new(object, key, value ? value : json_string("(not UTF-8)"));
}

static json_t *axes_of(const brunt_study *study) {
    json_t *axes = json_array();
    for (int32_t a = 0; a < study->axis_count; a++) {
        const brunt_study_axis *axis = &study->axes[a];
        json_t *entry = json_object(), *values = json_array();
        set_text(entry, "name", axis->name);
        set_text(entry, "unit", axis->unit);
        set_text(entry, "role", axis->role == BRUNT_STUDY_RESOLUTION ? "resolution" : "method");
        for (int32_t v = 0; v < axis->value_count; v++) {
            json_t *value = json_object();
            set_text(value, "label", axis->values[v].label);
            json_object_set_new(value, "number", number(axis->values[v].number));
            json_array_append_new(values, value);
        }
        json_object_set_new(entry, "values", values);
        json_array_append_new(axes, entry);
    }
    return axes;
}

static json_t *measures_of(const brunt_study *study) {
    static const char *const references[] = {"number", "table", "finest", "richardson"};
    _Static_assert(BRUNT_COUNT(references) == BRUNT_REFERENCE_RICHARDSON + 1, "a word for each reference");
    json_t *measures = json_array();
    for (int32_t m = 0; m < study->measure_count; m++) {
        const brunt_study_measure *measure = &study->measures[m];
        json_t *entry = json_object();
        bool scene = measure->reference == BRUNT_REFERENCE_NUMBER && isnan(measure->exact);
        set_text(entry, "name", measure->name);
        set_text(entry, "title", measure->title);
        set_text(entry, "reference", scene ? "scene" : references[measure->reference]);
        set_text(entry, "of", measure->of);
        json_object_set_new(entry, "scale", number(measure->scale));
        json_object_set_new(entry, "order", number(measure->order));
        json_array_append_new(measures, entry);
    }
    return measures;
}

static json_t *fit_of(const brunt_study_fit *fit) {
    json_t *object = json_object();
    json_object_set_new(object, "points", json_integer(fit->points));
    json_object_set_new(object, "slope", number(fit->slope));
    json_object_set_new(object, "intercept", number(fit->intercept));
    json_object_set_new(object, "uncertainty", number(fit->uncertainty));
    return object;
}

static json_t *lines_of(const brunt_study *study) {
    json_t *lines = json_array();
    for (int32_t l = 0; l < study->line_count; l++) {
        const brunt_study_line *line = &study->lines[l];
        json_t *entry = json_object(), *measures = json_object();
        set_text(entry, "label", line->label);
        json_object_set_new(entry, "cost", fit_of(&line->cost));
        for (int32_t m = 0; m < study->measure_count; m++) {
            json_t *measure = json_object();
            json_object_set_new(measure, "order", fit_of(&line->order[m]));
            json_object_set_new(measure, "limit", number(line->limit[m]));
            json_object_set_new(measure, "limit_uncertainty", number(line->limit_uncertainty[m]));
            json_object_set_new(measure, "observed_order", number(line->observed_order[m]));
            json_object_set_new(measures, study->measures[m].name, measure);
        }
        json_object_set_new(entry, "measures", measures);
        json_array_append_new(lines, entry);
    }
    return lines;
}

static json_t *case_of(const brunt_study *study, const brunt_study_case *c) {
    json_t *object = json_object(), *values = json_object(), *walls = json_array(), *measures = json_object();
    bool ran = c->runs > 0;
    for (int32_t a = 0; a < study->axis_count; a++)
        set_text(values, study->axes[a].name, study->axes[a].values[c->value[a]].label);
    for (int32_t r = 0; r < c->runs; r++) json_array_append_new(walls, number(c->wall[r]));
    json_object_set_new(object, "values", values);
    json_object_set_new(object, "line", json_integer(c->line));
    set_text(object, "status", statuses[c->status]);
    set_text(object, "reason", c->reason);
    json_object_set_new(object, "wall_s", walls);
    json_object_set_new(object, "wall_median_s", number(c->wall_median));
    json_object_set_new(object, "peak_bytes", number(ran ? c->peak_bytes : NAN));
    json_object_set_new(object, "steps", number(ran ? c->steps : NAN));
    json_object_set_new(object, "units", number(ran ? c->units : NAN));
    for (int32_t m = 0; m < study->measure_count; m++) {
        json_t *measure = json_object();
        json_object_set_new(measure, "value", number(c->result[m]));
        set_text(measure, "unit", c->unit[m]);
        json_object_set_new(measure, "reference", number(brunt_study_truth_of(study, c, m).value));
        json_object_set_new(measure, "error", number(c->error[m]));
        json_object_set_new(measure, "front", json_boolean(c->front[m]));
        json_object_set_new(measures, study->measures[m].name, measure);
    }
    json_object_set_new(object, "measures", measures);
    return object;
}

static json_t *study_object(const brunt_study *study) {
    json_t *object = json_object(), *cases = json_array(), *accuracies = json_array();
    set_text(object, "study", study->name);
    set_text(object, "title", study->title);
    set_text(object, "scene", study->scene);
    set_text(object, "version", BRUNT_VERSION);
    json_object_set_new(object, "threads", json_integer(study->threads));
    json_object_set_new(object, "repeats", json_integer(study->repeats));
    for (int32_t i = 0; i < study->accuracy_count; i++) json_array_append_new(accuracies, number(study->accuracies[i]));
    for (int32_t c = 0; c < study->case_count; c++) json_array_append_new(cases, case_of(study, &study->cases[c]));
    json_object_set_new(object, "accuracies", accuracies);
    json_object_set_new(object, "axes", axes_of(study));
    json_object_set_new(object, "measures", measures_of(study));
    json_object_set_new(object, "lines", lines_of(study));
    json_object_set_new(object, "cases", cases);
    return object;
}

// ---------------------------------------------------------------------------------------------------- files

static int open_in(const char *folder, const char *name, brunt_atomic_file *file, brunt_error *error) {
    char path[BRUNT_PATH_LENGTH];
    int status = brunt_join_path(path, folder, name, error);
    return status ? status : brunt_atomic_open(file, path, error);
}

int brunt_study_write_tables(const brunt_study *study, const char *folder, brunt_error *error) {
    brunt_atomic_file file;
    int status = open_in(folder, "study.csv", &file, error);
    if (status) return status;
    csv_head(study, file.stream);
    for (int32_t c = 0; c < study->case_count; c++) csv_row(study, &study->cases[c], file.stream);
    status = brunt_atomic_commit(&file, error);
    if (!status) status = open_in(folder, "study.json", &file, error);
    if (status) return status;
    json_t *object = study_object(study);
    bool dumped = json_dumpf(object, file.stream, JSON_INDENT(1) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(17)) == 0;
    json_decref(object);
    fputc('\n', file.stream);
    if (dumped) return brunt_atomic_commit(&file, error);
    brunt_atomic_abandon(&file);
    return brunt_fail(error, BRUNT_FAILED, "out of memory while writing study.json");
}

// ---------------------------------------------------------------------------------------------------- the terminal

static int shown_width(const char *text) {
    int width = 0;
    for (; *text; text++) width += ((unsigned char)*text & 0xC0) != 0x80;
    return width;
}

static int label_width(const brunt_study *study) {
    int width = 4;
    for (int32_t c = 0; c < study->case_count; c++) {
        char label[320];
        brunt_study_case_label(study, &study->cases[c], label);
        if (shown_width(label) > width) width = shown_width(label);
    }
    return width;
}

static bool any_doubt(const brunt_study *study) {
    for (int32_t c = 0; c < study->case_count; c++)
        for (int32_t m = 0; m < study->measure_count; m++)
            if (brunt_study_doubtful(study, &study->cases[c], m)) return true;
    return false;
}

static void print_case(const brunt_study *study, const brunt_study_case *c, int width, bool doubts, FILE *out) {
    char label[320], seconds[32], percent[32];
    brunt_study_case_label(study, c, label);
    fprintf(out, "  %s%*s", label, width - shown_width(label), "");
    if (c->status != BRUNT_STUDY_DONE) {
        fprintf(out, "  %s: %s\n", statuses[c->status], c->reason);
        return;
    }
    brunt_study_format_seconds(c->wall_median, seconds);
    fprintf(out, " %10.0f %9.0f %10s %8.1f MB", c->units, c->steps, seconds, 1e-6 * c->peak_bytes);
    for (int32_t m = 0; m < study->measure_count; m++) {
        char text[64];
        brunt_study_format_percent(c->error[m], percent);
        if (isfinite(c->error[m]))
            snprintf(text, sizeof text, "%s%s%s", percent, c->front[m] ? " *" : "  ",
                     brunt_study_doubtful(study, c, m) ? " ?"
                     : doubts                          ? "  "
                                                       : "");
        else
            snprintf(text, sizeof text, "%.5g %.16s  ", c->result[m], c->unit[m]);
        fprintf(out, " %*s", 16 > shown_width(study->measures[m].name) ? 16 : shown_width(study->measures[m].name),
                text);
    }
    fputc('\n', out);
}

void brunt_study_print(const brunt_study *study, FILE *out) {
    int width = label_width(study);
    const bool doubts = any_doubt(study);
    int32_t *cases = brunt_alloc((size_t)(study->case_count + 1) * sizeof *cases);
    if (!cases) return;
    fprintf(out, "\n  %-*s %10s %9s %10s %11s", width, "case", "units", "steps", "time", "memory");
    for (int32_t m = 0; m < study->measure_count; m++) fprintf(out, " %16s", study->measures[m].name);
    fputc('\n', out);
    for (int32_t l = 0; l < study->line_count; l++) {
        int32_t count = brunt_study_line_cases(study, l, cases);
        for (int32_t i = 0; i < count; i++) print_case(study, &study->cases[cases[i]], width, doubts, out);
    }
    fprintf(out, "  errors, * where no case is both faster and more accurate%s; units are particles and elements\n\n",
            doubts ? ", ? where the reference can tell no more" : "");
    brunt_free(cases);
}
