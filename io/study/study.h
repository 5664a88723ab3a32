// A study: one scene (or one a method) over a grid of settings, and what accuracy costs in time.
//
// study_keys.c, study_read.c  the file to a brunt_study     study_run.c    runs what is not finished yet
// study_case.c                what a case sets              study_table.c  study.csv, study.json, the table at the end
// study_fit.c                 orders, limits, fronts        study_view.c   references, numbers in words
// study_plot.c                gnuplot                       study_report.c report.md
#pragma once

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "brunt.h"

enum { BRUNT_STUDY_AXES = 6, BRUNT_STUDY_MEASURES = 8, BRUNT_STUDY_ACCURACIES = 8 };

// One place on an axis: what it is called and what it sets.
typedef struct brunt_study_value {
    char label[64]; // as shown: "APIC", "0.5 mm"
    double number;  // [SI], or the factor of `scale`; NAN: no number
    char **sets;    // "path.to.key=value" or "path.to.key*=factor" each, placeholders put in later; owned
    int32_t set_count;
    char scene[1024];   // "": that of the study
    char program[1024]; // "": this one
    int32_t threads;    // 0: those of the study
} brunt_study_value;

typedef enum brunt_study_role {
    BRUNT_STUDY_METHOD,    // each value is (with the others of this role) a line of the plots
    BRUNT_STUDY_RESOLUTION // points along a line; one axis at most. Its numbers fall as the resolution grows (a cell,
                           // an edge, a time step)
} brunt_study_role;

typedef struct brunt_study_axis {
    char name[64], unit[32]; // unit: SI, of the numbers; "": none
    brunt_study_role role;
    brunt_study_value *values; // owned
    int32_t value_count;
} brunt_study_axis;

typedef enum brunt_study_reference {
    BRUNT_REFERENCE_NUMBER,    // `exact`, or what the scene's measure expects (taken from its summary when NAN)
    BRUNT_REFERENCE_TABLE,     // by the value of one axis
    BRUNT_REFERENCE_FINEST,    // the finest run of all methods (`of`: of that method); its own error is not defined
    BRUNT_REFERENCE_RICHARDSON // each method's own limit, extrapolated from its three finest runs, or the finest where
                               // they settle without showing an order; `of`: that method's for all
} brunt_study_reference;

typedef struct brunt_study_measure {
    char name[64];   // of the scene's measures
    char title[128]; // of the axis of errors, e.g. "error of the length"
    brunt_study_reference reference;
    double exact; // BRUNT_REFERENCE_NUMBER
    int32_t table_axis;
    double *table; // BRUNT_REFERENCE_TABLE: one a value of that axis; owned
    char of[64];   // label of the method; "": none
    double scale;  // errors are |value - reference| / scale; NAN: / |reference|
    double order;  // what theory says; NAN: nothing
} brunt_study_measure;

typedef enum brunt_study_status { BRUNT_STUDY_WAITING, BRUNT_STUDY_DONE, BRUNT_STUDY_FAILED } brunt_study_status;

// One combination of values with all its repeats.
typedef struct brunt_study_case {
    int32_t value[BRUNT_STUDY_AXES];
    int32_t line; // which line of the plots, 0 .. line_count-1
    brunt_study_status status;
    char reason[256]; // why it failed
    int32_t runs;     // repeats that are finished
    double *wall;     // [s] of the steps (output left out), one a repeat, in the order they ran; owned
    double wall_median, wall_least, wall_greatest; // [s]
    double peak_bytes, steps, units;               // units: particles + elements
    double result[BRUNT_STUDY_MEASURES];           // in the measures' own unit; NAN: none
    double expect[BRUNT_STUDY_MEASURES];           // what the scene says it should be; NAN: nothing
    char unit[BRUNT_STUDY_MEASURES][32];
    // Filled by brunt_study_analyse:
    double error[BRUNT_STUDY_MEASURES]; // relative (or over `scale`); NAN: none
    bool front[BRUNT_STUDY_MEASURES];   // no other case is both faster and more accurate
} brunt_study_case;

// A line through points in log-log: y = exp(intercept) x^slope, by least squares.
typedef struct brunt_study_fit {
    int32_t points; // that it goes through; the rest NAN below 2
    double slope, intercept;
    double uncertainty; // half width of the 95 % interval of the slope by Student's t; NAN below 3 points
} brunt_study_fit;

// What a method (a combination of values of all axes but the resolution) gives.
typedef struct brunt_study_line {
    char label[160];                             // "APIC, quadratic"
    brunt_study_fit order[BRUNT_STUDY_MEASURES]; // error over resolution
    brunt_study_fit cost;                        // wall time over units
    double limit[BRUNT_STUDY_MEASURES];          // Richardson's, or the finest value when `settled`; NAN: none
    double limit_uncertainty[BRUNT_STUDY_MEASURES];
    bool settled[BRUNT_STUDY_MEASURES]; // no order could be seen, but the last change is smaller than the one before
    double observed_order[BRUNT_STUDY_MEASURES]; // of the three finest values, without a reference; NAN: they do not
                                                 // converge
} brunt_study_line;

typedef struct brunt_study {
    char name[128], title[256], source[1024];
    char scene[1024]; // path as to be opened
    char **sets;
    int32_t set_count; // for all runs; owned
    brunt_study_axis axes[BRUNT_STUDY_AXES];
    int32_t axis_count, resolution; // resolution: axis, or -1
    brunt_study_measure measures[BRUNT_STUDY_MEASURES];
    int32_t measure_count;
    double accuracies[BRUNT_STUDY_ACCURACIES];
    int32_t accuracy_count; // default 0.1, 0.03, 0.01
    int32_t repeats, threads;
    double time_limit; // [s] of the clock for one run; past it the run counts as failed
    brunt_study_case *cases;
    int32_t case_count; // owned
    brunt_study_line *lines;
    int32_t line_count; // owned
} brunt_study;

// Reads and checks, all mistakes at once with line and column; the cases are made and waiting.
int brunt_study_read(const char *path, brunt_study *study, FILE *messages);
void brunt_study_free(brunt_study *study);

typedef struct brunt_study_options {
    const char *folder;  // NULL: out/study/<name>
    const char *program; // what runs scenes: this program's own file
    bool fresh;          // nothing is taken over from earlier
    FILE *console;       // NULL: quiet
    const volatile sig_atomic_t *stop;
} brunt_study_options;

// Runs all cases that are not finished in `folder`, in turn (the first repeat of each, then the second, ...), then
// writes study.csv, study.json, report.md, study.svg and .png with study_order and study_cost beside them. A run that
// fails is a result. BRUNT_OK, BRUNT_STOPPED, BRUNT_IO_ERROR; BRUNT_FAILED, with everything written, when no case came
// to its end or repeats of one ended in different bits.
int brunt_study_run(brunt_study *study, const brunt_study_options *options, brunt_error *error);

// --- study_fit.c: from results to errors, fronts and fits. No file is touched.
void brunt_study_analyse(brunt_study *study);
// Least squares of log y over log x through the pairs that are finite and positive.
brunt_study_fit brunt_study_line_fit(const double *x, const double *y, int32_t count);
// Limit of values at three falling resolutions x[0] > x[1] > x[2] (any ratios), with the order they show. False when
// they do not converge monotonically.
bool brunt_study_richardson(const double x[3], const double y[3], double *limit, double *order);

// --- study_table.c, study_plot.c, study_report.c: into `folder`
int brunt_study_write_tables(const brunt_study *study, const char *folder, brunt_error *error);
// A row a case, by lines from the coarsest to the finest, and why those that failed did.
void brunt_study_print(const brunt_study *study, FILE *out);
// Scripts and data for gnuplot, then the pictures by it. Without gnuplot: BRUNT_OK, the scripts are there and `*drawn`
// is false.
int brunt_study_write_plots(const brunt_study *study, const char *folder, bool *drawn, brunt_error *error);
int brunt_study_write_report(const brunt_study *study, const char *folder, brunt_error *error);
