#include "io/study/run_record.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

#include "io/file/atomic_file.h"

static double number_of(const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

static const char *text_of(const json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

static json_t *load(const char *folder, const char *name) {
    char path[BRUNT_PATH_LENGTH];
    return brunt_join_path(path, folder, name, NULL) == BRUNT_OK ? json_load_file(path, 0, NULL) : NULL;
}

// False when there is no summary. Its status may still be one of failure.
static bool read_summary(const brunt_study *study, const char *folder, run_result *result) {
    json_t *summary = load(folder, "summary.json");
    if (!summary) return false;
    bool done = strcmp(text_of(summary, "status"), "done") == 0;
    result->status = done ? BRUNT_STUDY_DONE : BRUNT_STUDY_FAILED;
    snprintf(result->reason, sizeof result->reason, "%s", done ? "" : text_of(summary, "reason"));
    snprintf(result->state_hash, sizeof result->state_hash, "%s", text_of(summary, "state_hash"));
    result->wall = number_of(summary, "step_s");
    result->peak = number_of(summary, "peak_rss_bytes");
    result->steps = number_of(summary, "steps");
    result->units = number_of(summary, "particles") + number_of(summary, "elements");
    const json_t *measures = json_object_get(summary, "measures");
    for (int32_t m = 0; m < study->measure_count; m++) {
        const json_t *measure = json_object_get(measures, study->measures[m].name);
        result->value[m] = number_of(measure, "value");
        result->expect[m] = number_of(measure, "expect");
        snprintf(result->unit[m], sizeof result->unit[m], "%s", text_of(measure, "unit"));
    }
    json_decref(summary);
    return true;
}

static void first_line(const char *folder, char *out, size_t size) {
    char path[BRUNT_PATH_LENGTH];
    FILE *file = brunt_join_path(path, folder, "messages.txt", NULL) == BRUNT_OK ? fopen(path, "r") : NULL;
    *out = 0;
    if (!file) return;
    if (!fgets(out, (int)size, file)) *out = 0;
    out[strcspn(out, "\n")] = 0;
    fclose(file);
}

void run_record_judge(const brunt_study *study, const char *folder, const brunt_child_end *end, run_result *result) {
    bool summary = end->fate == BRUNT_CHILD_ENDED && read_summary(study, folder, result);
    result->elapsed = end->seconds;
    if (summary && (result->status == BRUNT_STUDY_FAILED || end->code == 0)) return;
    result->status = BRUNT_STUDY_FAILED;
    char line[200];
    first_line(folder, line, sizeof line);
    if (end->fate == BRUNT_CHILD_TIMEOUT) {
        result->limit = study->time_limit;
        snprintf(result->reason, sizeof result->reason, "not done after %.4g s, the time limit of a run",
                 result->limit);
    } else if (end->fate == BRUNT_CHILD_KILLED) {
        snprintf(result->reason, sizeof result->reason, "ended by signal %d (%s)", end->code, strsignal(end->code));
    } else if (*line) {
        snprintf(result->reason, sizeof result->reason, "%s", line);
    } else {
        snprintf(result->reason, sizeof result->reason, "exit code %d, and no summary", end->code);
    }
}

int run_record_write(const char *folder, uint64_t key, const run_result *result, brunt_error *error) {
    char path[BRUNT_PATH_LENGTH], text[24];
    brunt_atomic_file file;
    int status = brunt_join_path(path, folder, "run.json", error);
    if (!status) status = brunt_atomic_open(&file, path, error);
    if (status) return status;
    snprintf(text, sizeof text, "0x%016llx", (unsigned long long)key);
    json_t *record = json_object(), *reason = json_string(result->reason);
    json_object_set_new(record, "key", json_string(text));
    json_object_set_new(record, "status", json_string(result->status == BRUNT_STUDY_DONE ? "done" : "failed"));
    json_object_set_new(record, "reason", reason ? reason : json_string("(not UTF-8)"));
    json_object_set_new(record, "elapsed_s", json_real(result->elapsed));
    json_object_set_new(record, "limit_s", isfinite(result->limit) ? json_real(result->limit) : json_null());
    json_dumpf(record, file.stream, JSON_INDENT(2) | JSON_PRESERVE_ORDER);
    json_decref(record);
    fputc('\n', file.stream);
    return brunt_atomic_commit(&file, error);
}

bool run_record_take_over(const brunt_study *study, uint64_t run_key, const char *folder, run_result *result) {
    json_t *record = load(folder, "run.json");
    char key[24];
    *result = (run_result){.limit = NAN};
    snprintf(key, sizeof key, "0x%016llx", (unsigned long long)run_key);
    bool same = record && strcmp(text_of(record, "key"), key) == 0;
    bool done = strcmp(text_of(record, "status"), "done") == 0;
    // What was killed at its limit deserves another try when it is given more.
    if (isfinite(number_of(record, "limit_s"))) same &= study->time_limit <= number_of(record, "limit_s");
    if (same && done) same = read_summary(study, folder, result) && result->status == BRUNT_STUDY_DONE;
    if (same && !done) {
        result->status = BRUNT_STUDY_FAILED;
        snprintf(result->reason, sizeof result->reason, "%s", text_of(record, "reason"));
    }
    result->elapsed = number_of(record, "elapsed_s");
    json_decref(record);
    return same;
}
