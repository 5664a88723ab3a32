// Studies made by hand: as if all runs had been made, with the results that a test gives them.
#pragma once

#include "tests/support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/study/study.h"

static inline void made_axis(brunt_study *study, const char *name, const char *unit, brunt_study_role role,
                             int32_t count) {
    brunt_study_axis *axis = &study->axes[study->axis_count];
    snprintf(axis->name, sizeof axis->name, "%s", name);
    snprintf(axis->unit, sizeof axis->unit, "%s", unit);
    axis->role = role;
    axis->value_count = count;
    axis->values = brunt_alloc((size_t)count * sizeof *axis->values);
    for (int32_t v = 0; v < count; v++) axis->values[v].number = NAN;
    if (role == BRUNT_STUDY_RESOLUTION) study->resolution = study->axis_count;
    study->axis_count++;
}

static inline void made_case(brunt_study *study, int32_t line, int32_t value, int32_t repeats) {
    brunt_study_case *c = &study->cases[study->case_count++];
    c->value[0] = line, c->value[1] = value, c->line = line;
    c->status = BRUNT_STUDY_DONE;
    c->runs = repeats;
    c->wall = brunt_alloc((size_t)repeats * sizeof *c->wall);
    c->wall_median = c->wall_least = c->wall_greatest = c->peak_bytes = c->steps = NAN;
    for (int32_t m = 0; m < BRUNT_STUDY_MEASURES; m++) {
        c->result[m] = c->expect[m] = c->error[m] = NAN;
        strcpy(c->unit[m], "m");
    }
}

// Axis 0: `methods` labels; axis 1: `h` [m] (none: 0). One measure, "length", without order, compared with `exact`.
static inline void made_study(brunt_study *study, const char *const *methods, int32_t method_count, const double *h,
                              int32_t h_count, double exact) {
    memset(study, 0, sizeof *study);
    strcpy(study->name, "made"), strcpy(study->title, "A made-up study"), strcpy(study->scene, "/scenes/rod.yaml");
    study->resolution = -1;
    study->repeats = 1, study->threads = 1;
    made_axis(study, "method", "", BRUNT_STUDY_METHOD, method_count);
    study->lines = brunt_alloc((size_t)method_count * sizeof *study->lines);
    study->line_count = method_count;
    for (int32_t l = 0; l < method_count; l++) {
        snprintf(study->axes[0].values[l].label, 64, "%s", methods[l]);
        snprintf(study->lines[l].label, 160, "%s", methods[l]);
    }
    if (h_count) made_axis(study, "h", "m", BRUNT_STUDY_RESOLUTION, h_count);
    for (int32_t v = 0; v < h_count; v++) {
        study->axes[1].values[v].number = h[v];
        snprintf(study->axes[1].values[v].label, 64, "%.4g mm", 1e3 * h[v]);
    }
    study->cases = brunt_alloc((size_t)(method_count * (h_count ? h_count : 1)) * sizeof *study->cases);
    for (int32_t l = 0; l < method_count; l++)
        for (int32_t v = 0; v < (h_count ? h_count : 1); v++) made_case(study, l, v, 1);
    study->measure_count = 1;
    brunt_study_measure *m = &study->measures[0];
    strcpy(m->name, "length"), strcpy(m->title, "error of the length");
    m->exact = exact, m->scale = NAN, m->order = NAN;
    study->accuracies[0] = 0.1, study->accuracies[1] = 0.03, study->accuracies[2] = 0.01;
    study->accuracy_count = 3;
}

static inline brunt_study_case *made_at(brunt_study *study, int32_t line, int32_t value) {
    for (int32_t i = 0; i < study->case_count; i++) {
        brunt_study_case *c = &study->cases[i];
        if (c->line == line && (study->resolution < 0 || c->value[1] == value)) return c;
    }
    return NULL;
}

static inline void made_result(brunt_study *study, int32_t line, int32_t value, double result, double wall) {
    brunt_study_case *c = made_at(study, line, value);
    c->result[0] = result;
    for (int32_t r = 0; r < c->runs; r++) c->wall[r] = wall;
}

static inline void made_failure(brunt_study *study, int32_t line, int32_t value, const char *reason) {
    brunt_study_case *c = made_at(study, line, value);
    c->status = BRUNT_STUDY_FAILED;
    c->runs = 0;
    snprintf(c->reason, sizeof c->reason, "%s", reason);
}

static inline void made_free(brunt_study *study) {
    for (int32_t i = 0; i < study->case_count; i++) brunt_free(study->cases[i].wall);
    for (int32_t a = 0; a < study->axis_count; a++) brunt_free(study->axes[a].values);
    for (int32_t m = 0; m < study->measure_count; m++) brunt_free(study->measures[m].table);
    brunt_free(study->cases), brunt_free(study->lines);
    memset(study, 0, sizeof *study);
}
