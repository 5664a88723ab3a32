// What plots and report both have to know of an analysed study, and how they write numbers.
//
// Within io only: study_view.c, study_fit.c, study_plot.c, study_report.c, study_table.c.
#pragma once

#include <stddef.h>

#include "io/study/study.h"

// Number of the case on the resolution axis [of that axis]; NAN without one.
double brunt_study_resolution(const brunt_study *study, const brunt_study_case *c);
// Indices of the cases of a line from the coarsest to the finest (without a resolution: as they are in the study) into
// `out`, which has room for `case_count`. Returns how many there are.
int32_t brunt_study_line_cases(const brunt_study *study, int32_t line, int32_t *out);

// What a result is compared with, in the measure's own unit; NAN: nothing is known.
typedef struct brunt_study_truth {
    double value;
    double uncertainty; // of `value`; NAN where it is not known, 0 for numbers that were given
    int32_t finest;     // the case that is the reference itself, or -1
    int32_t line;       // whose limit it is, or -1
} brunt_study_truth;
// Needs the limits of the lines, which brunt_study_analyse fills first.
brunt_study_truth brunt_study_truth_of(const brunt_study *study, const brunt_study_case *c, int32_t measure);
// What errors are divided by, in the measure's own unit.
double brunt_study_scale_of(const brunt_study *study, const brunt_study_case *c, int32_t measure);
// Uncertainty of the reference in the units of errors; 0 when none is known. An error below it says nothing.
double brunt_study_resolvable(const brunt_study *study, const brunt_study_case *c, int32_t measure);

// Whether the result is itself a limit to which the values settled: its error is then the uncertainty of that limit, a
// bound that no fit may use.
bool brunt_study_is_limit(const brunt_study *study, const brunt_study_case *c, int32_t measure);
// Whether the error is not above what the reference can tell (marked by ?).
bool brunt_study_doubtful(const brunt_study *study, const brunt_study_case *c, int32_t measure);
// Whether a limit of this line is wanted as reference and there is none; `why` reads behind "has no limit: ".
bool brunt_study_lacks_limit(const brunt_study *study, int32_t line, int32_t measure, char why[160]);
// Index of the case that is the reference itself, or -1.
int32_t brunt_study_reference_case(const brunt_study *study, int32_t measure);
// Unit of the measure; "": no run has said it.
const char *brunt_study_unit(const brunt_study *study, int32_t measure);

// Resolution below which the error of a line no longer falls; NAN: it goes on falling, or there are too few points to
// tell.
double brunt_study_plateau(const brunt_study *study, int32_t line, int32_t measure);
// Fit of time over error through the finished cases of a line; `line` -1: through those on the front. Its slope is -q
// of time ~ error^-q.
brunt_study_fit brunt_study_price(const brunt_study *study, int32_t line, int32_t measure);

// "APIC, quadratic, h = 4 mm"
void brunt_study_case_label(const brunt_study *study, const brunt_study_case *c, char out[320]);
// The label of the axis' value at this resolution, "4 mm".
const char *brunt_study_resolution_label(const brunt_study *study, double resolution);
const char *brunt_study_line_label(const brunt_study *study, int32_t line);
void brunt_study_format_percent(double ratio, char out[32]);   // "8.1 %"
void brunt_study_format_seconds(double seconds, char out[32]); // "120 ms"
void brunt_study_format_factor(double factor, char out[32]);   // "4.2", "33"
// "1.94 ± 0.08", "1.9" without an interval, "" when there is no slope. `sign`: +1 or -1, by which the slope is
// multiplied.
void brunt_study_format_slope(const brunt_study_fit *fit, double sign, char out[48]);
// "0.1234 ± 0.0005": digits as far as the uncertainty goes; none or at rounding's level: six digits and no interval.
void brunt_study_format_value(double value, double uncertainty, char out[64]);

// Without ending, of the picture of a measure's error against time: "study", "study_NAME" for those after the first
// (study_plot.c).
void brunt_study_picture_name(const brunt_study *study, int32_t measure, char out[160]);
