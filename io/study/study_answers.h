// Which setting of a study reaches which accuracy, in sentences. Private to study_report.c.
#pragma once

#include <stdio.h>

#include "io/study/study.h"

// NULL: none has an error.
const brunt_study_case *report_most_accurate(const brunt_study *study, int32_t m);
// One item a wanted accuracy: the cheapest run that reaches it, the next best, what only seems to reach it.
void report_write_answers(FILE *out, const brunt_study *study, int32_t m);
// What the answers leave out: the run that is the reference, and methods that have none.
void report_write_left_out(FILE *out, const brunt_study *study, int32_t m);
