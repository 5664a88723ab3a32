// Axes and text of a picture, as gnuplot takes them.
#include "io/study/plot_axis.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

enum { TIC_LIMIT = 64 };

void plot_axis_widen(plot_axis *a, double value) {
    if (!(value > 0) || !isfinite(value)) return;
    a->from = fmin(a->from, a->factor * value), a->to = fmax(a->to, a->factor * value);
}

bool plot_axis_empty(const plot_axis *a) { return !(a->to >= a->from); }

// Air around the data; what is all at one place gets a factor of two to both sides.
void plot_axis_pad(plot_axis *a) {
    const double decades = log10(a->to / a->from), air = decades < 0.05 ? 0.3 : 0.04 + 0.06 * decades;
    a->from *= pow(10, -air), a->to *= pow(10, air);
}

static void number_label(double value, char out[48]) {
    static const char *const raised[10] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    if (value >= 0.99e-4 && value < 0.99e6) {
        snprintf(out, 48, "%.10g", value);
        return;
    }
    char text[32];
    snprintf(text, sizeof text, "%.9e", value);
    const double mantissa = strtod(text, NULL) / pow(10, atoi(strchr(text, 'e') + 1));
    const int exponent = atoi(strchr(text, 'e') + 1), size = abs(exponent);
    int length = fabs(mantissa - 1) < 1e-6 ? snprintf(out, 48, "10") : snprintf(out, 48, "%.4g·10", mantissa);
    length += snprintf(out + length, 48 - (size_t)length, "%s", exponent < 0 ? "⁻" : "");
    if (size >= 100) length += snprintf(out + length, 48 - (size_t)length, "%s", raised[size / 100]);
    if (size >= 10) length += snprintf(out + length, 48 - (size_t)length, "%s", raised[size / 10 % 10]);
    snprintf(out + length, 48 - (size_t)length, "%s", raised[size % 10]);
}

static void tic(FILE *out, const plot_axis *a, double value, bool major, bool *first) {
    if (value < a->from * (1 - 1e-9) || value > a->to * (1 + 1e-9)) return;
    char label[48] = "";
    if (major) number_label(value, label);
    fprintf(out, "%s'%s' %.10g %d", *first ? "" : ", ", label, value, !major);
    *first = false;
}

// Less than a decade: round steps. More: decades, with 2 and 5 between them or every second, third, ... alone.
void plot_write_tics(FILE *out, char name, const plot_axis *a) {
    const double decades = log10(a->to / a->from);
    bool first = true;
    fprintf(out, "set %ctics (", name);
    if (decades < 0.8) {
        const double rough = (a->to - a->from) / 5, power = pow(10, floor(log10(rough))), m = rough / power;
        const double step = power * (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10);
        const double start = ceil(a->from / step - 1e-9);
        for (int k = 0; k < TIC_LIMIT && (start + k) * step <= a->to * (1 + 1e-9); k++)
            tic(out, a, (start + k) * step, true, &first);
    } else {
        const int low = (int)floor(log10(a->from)), high = (int)ceil(log10(a->to)), every = (high - low + 7) / 8;
        for (int e = low; e <= high; e++)
            for (int m = 1; m <= (every == 1 ? 9 : 1); m++) {
                bool major = m == 1 ? e % every == 0 : (m == 2 || m == 5) && decades < 3;
                tic(out, a, m * pow(10, e), major, &first);
            }
    }
    fprintf(out, ")\nset %crange [%.10g:%.10g]\n", name, a->from, a->to);
}

// As gnuplot takes it between single quotes.
void plot_write_text(FILE *out, const char *text) {
    fputc('\'', out);
    for (const char *t = text; *t; t++) {
        if (*t == '\'') fputc('\'', out);
        fputc((unsigned char)*t < ' ' ? ' ' : *t, out);
    }
    fputc('\'', out);
}

void plot_write_label(FILE *out, const char *what, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    // Where the margin is given, gnuplot puts the label of the ordinate outside of the picture: it is placed by hand.
    const bool upright = !strcmp(what, "ylabel");
    fprintf(out, "set %s ", upright ? "label" : what);
    plot_write_text(out, text);
    fputs(upright ? " at screen 0.025, graph 0.5 center rotate by 90\n" : "\n", out);
}

// Parts of a unit that read better as thousands or thousandths: factor of the numbers, and the unit with its prefix.
double plot_prefixed(const char *unit, double most, char out[48]) {
    static const char *const plain[] = {"m", "s", "Pa", "N", "J", "Hz", "V", "W"};
    static const char *const prefix[] = {"n", "u", "m", "", "k", "M", "G"};
    bool known = false;
    for (size_t u = 0; u < sizeof plain / sizeof *plain; u++) known = known || !strcmp(unit, plain[u]);
    int p = 3;
    if (known && most > 0) p += (int)floor(log10(most) / 3 + 1e-9);
    p = p < 0 ? 0 : p >= BRUNT_COUNT(prefix) ? BRUNT_COUNT(prefix) - 1 : p;
    snprintf(out, 48, "%s%s", prefix[p], unit[0] ? unit : "1");
    return pow(1000, 3 - p);
}
