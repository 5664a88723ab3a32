// Logarithmic axes and text of a picture, as gnuplot takes them. Private to study_plot.c.
#pragma once

#include <stdbool.h>
#include <stdio.h>

typedef struct plot_axis {
    double from, to; // as drawn: data times `factor`
    double factor;
} plot_axis;

// Takes a value in; none that is not above 0.
void plot_axis_widen(plot_axis *a, double value);
bool plot_axis_empty(const plot_axis *a);
void plot_axis_pad(plot_axis *a);
void plot_write_tics(FILE *out, char name, const plot_axis *a);
void plot_write_text(FILE *out, const char *text);
void plot_write_label(FILE *out, const char *what, const char *format, ...) __attribute__((format(printf, 3, 4)));
// Factor of numbers in `unit`, of which the greatest is `most`, and the unit with its prefix: "mm".
double plot_prefixed(const char *unit, double most, char out[48]);
