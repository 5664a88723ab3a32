// Pieces of text of a report in Markdown. Private to study_report.c and study_answers.c.
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "io/study/study.h"

// Whether a run came to its end; whether it has an error and a time as well.
bool report_finished(const brunt_study_case *c);
bool report_judged(const brunt_study_case *c, int32_t m);

// How many runs have this status.
int32_t report_count(const brunt_study *study, brunt_study_status status);

// Text with what Markdown would take for its own escaped.
void report_put(FILE *out, const char *text);
void report_put_case(FILE *out, const brunt_study *study, const brunt_study_case *c);
// " [mm]"; nothing where no run has said the unit.
void report_put_unit(FILE *out, const brunt_study *study, int32_t m);

// A number in words, for one use in an argument.
typedef struct words {
    char text[32];
} words;

words report_percent(double ratio);
words report_seconds(double value);
words report_factor(double value);
const char *report_title(const brunt_study_measure *m);
