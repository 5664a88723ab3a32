// The pictures of a study: a script for gnuplot each, with its data inside, so that it can be restyled and drawn again
// by hand.
//
// Ranges and labels are worked out here: gnuplot's own leave logarithmic axes of less than a decade without a number.
// All text is drawn as it is ("noenhanced"); the powers of ten are characters.
#include "base/array.h"
#include "io/study/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/file/atomic_file.h"
#include "base/error.h"
#include "base/memory.h"
#include "io/study/gnuplot.h"
#include "io/study/plot_axis.h"
#include "io/study/study_view.h"

// M. Okabe and K. Ito's colours, which colour-blind readers tell apart, too (jfly.uni-koeln.de/color, 2008);
// their yellow is too light for lines on white.
static const char *const colours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000"};
static const int symbols[] = {7, 5, 9, 13, 11, 15, 6, 4, 8, 12, 10, 14}; // filled ones first
static const int dashes[] = {1, 2, 4, 5, 3};
enum { COLOURS = BRUNT_COUNT(colours), SYMBOLS = BRUNT_COUNT(symbols), DASHES = BRUNT_COUNT(dashes) };

typedef struct look {
    int colour, symbol, dash;
} look;

static int32_t method_value(const brunt_study *study, int32_t line, int32_t axis) {
    for (int32_t i = 0; i < study->case_count; i++)
        if (study->cases[i].line == line) return study->cases[i].value[axis];
    return 0;
}

// Few lines: a colour, a symbol and a dash each. Many, made by several axes: the colour says the first axis, symbol and
// dash the rest.
static look look_of(const brunt_study *study, int32_t line) {
    look own = {line % COLOURS, line % SYMBOLS, line % DASHES};
    if (study->line_count <= COLOURS) return own;
    int32_t first = -1, rest = 0;
    for (int32_t a = 0; a < study->axis_count; a++) {
        if (a == study->resolution || study->axes[a].value_count < 2) continue;
        if (first < 0)
            first = a;
        else
            rest = rest * study->axes[a].value_count + method_value(study, line, a);
    }
    if (first < 0 || study->axes[first].value_count > COLOURS || study->axes[first].value_count == study->line_count)
        return own;
    return (look){method_value(study, line, first), rest % SYMBOLS, rest % DASHES};
}

// --- a picture

enum { NOTES = 4 }; // lines at the foot: runs that failed, errors of zero, the reference, methods without a limit
typedef char notes[NOTES][256]; // "": none

typedef struct picture {
    const brunt_study *study;
    brunt_atomic_file file;
    char name[160]; // without ending
    int32_t *cases; // of a line; room for all
    FILE *out;
    int32_t drawn; // what the plot command lists so far
} picture;

static bool finished(const brunt_study_case *c) { return c->status == BRUNT_STUDY_DONE; }
static bool failed(const brunt_study_case *c) { return c->status == BRUNT_STUDY_FAILED; }

static int begin(picture *p, const char *folder, brunt_error *error) {
    char path[BRUNT_PATH_LENGTH], name[176];
    snprintf(name, sizeof name, "%s.gp", p->name);
    int status = brunt_join_path(path, folder, name, error);
    if (!status) status = brunt_atomic_open(&p->file, path, error);
    if (status) return status;
    p->out = p->file.stream;
    p->drawn = 0;
    fprintf(
        p->out,
        "# gnuplot %s.gp\nset encoding utf8\nset logscale xy\nset border 3 linewidth 1\n"
        "set tics nomirror out\nset grid xtics ytics linecolor '#dddddd' linewidth 0.6 dashtype 1\nset pointsize 1.2\n",
        p->name);
    return BRUNT_OK;
}

// From the top: title, key, the plot, a line of notes. The key stands outside, in as many columns as there is room for:
// nowhere else is it sure to cover no data.
static void write_layout(picture *p, int32_t entries, size_t longest, bool accuracies, const char *suffix,
                         const notes *note) {
    enum { WIDTH = 900, PLOT = 470, LETTER = 10, ROW = 25, TITLE = 42, BELOW = 98 }; // pixels
    const int room = (WIDTH - 40) / (75 + LETTER * (int)longest), columns = room < 1         ? 1
                                                                            : room > entries ? entries
                                                                                             : room;
    int noted = 0;
    for (int n = 0; note && n < NOTES; n++) noted += (*note)[n][0] != 0;
    const int rows = (entries + columns - 1) / columns, head = TITLE + ROW * rows + 22,
              foot = BELOW + (noted ? ROW * noted + 6 : 0);
    const int height = head + PLOT + foot;
    const brunt_study *study = p->study;
    fprintf(p->out,
            "height = %d\nset tmargin at screen %.4f\nset bmargin at screen %.4f\nset lmargin at screen 0.13\nset "
            "rmargin at screen %s\n",
            height, 1 - (double)head / height, (double)foot / height, accuracies ? "0.91" : "0.95");
    fprintf(p->out,
            "set key at screen 0.03, screen %.4f left top vertical Left reverse maxrows %d samplen 2.6 width %d "
            "noenhanced\n",
            1 - (double)TITLE / height, rows,
            longest < 24 ? -(int)longest / 8 : -(int)longest / 5); // letters are narrower than gnuplot takes them for
    char title[320];
    snprintf(title, sizeof title, "%s%s", study->title[0] ? study->title : study->name, suffix);
    fprintf(p->out, "set label ");
    plot_write_text(p->out, title);
    fprintf(p->out, " at screen 0.5, screen %.4f center noenhanced\n", 1 - 20.0 / height);
    for (int n = 0; note && n < NOTES; n++) {
        if (!(*note)[n][0]) continue;
        fprintf(p->out, "set label ");
        plot_write_text(p->out, (*note)[n]);
        fprintf(p->out, " at screen 0.03, screen %.4f left textcolor '#444444'\n", (16.0 + ROW * --noted) / height);
    }
}

// SVG first: what fails leaves no picture that looks whole. A terminal has to be there before the plot is.
static void plot_part(picture *p) {
    if (p->drawn++) {
        fputs(", \\\n  ", p->out);
        return;
    }
    fprintf(p->out,
            "set terminal svg size 900,height font 'sans,17' linewidth 1.6 noenhanced background 'white'\n"
            "set output '%s.svg'\nplot \\\n  ",
            p->name);
}

static int commit(picture *p, brunt_error *error) {
    fprintf(p->out,
            "\nset terminal pngcairo size 900,height font 'sans,15' linewidth 1.6 noenhanced\n"
            "set output '%s.png'\nreplot\nunset output\n",
            p->name);
    return brunt_atomic_commit(&p->file, error);
}

// Text of a key entry of a line: its label, and a slope where one is wanted.
static void entry(const brunt_study *study, int32_t line, const brunt_study_fit *fit, double sign, char out[256]) {
    char slope[48] = "";
    if (fit) brunt_study_format_slope(fit, sign, slope);
    snprintf(out, 256, "%s%s%s", brunt_study_line_label(study, line), slope[0] ? ": " : "", slope);
}

static size_t characters(const char *utf8) {
    size_t count = 0;
    for (const char *t = utf8; *t; t++) count += ((unsigned char)*t & 0xC0) != 0x80;
    return count;
}

static void plot_line(picture *p, int32_t line, bool connected, const char *title) {
    const look l = look_of(p->study, line);
    plot_part(p);
    fprintf(p->out, "$line%d using 1:2 with %s linecolor '%s' ", (int)line, connected ? "linespoints" : "points",
            colours[l.colour]);
    if (connected) fprintf(p->out, "dashtype %d ", dashes[l.dash]);
    fprintf(p->out, "pointtype %d linewidth 1.8 title ", symbols[l.symbol]);
    plot_write_text(p->out, title);
}

// --- error against time, or against resolution

typedef struct errors {
    picture p;
    int32_t measure;
    bool over_resolution;
    plot_axis x, y;
    bool percent;
    double floor;  // where errors of zero are drawn, as drawn
    int32_t zeros; // how many there are
    char unit_x[48];
} errors;

static double abscissa(const errors *e, const brunt_study_case *c) {
    return e->over_resolution ? brunt_study_resolution(e->p.study, c) : c->wall_median;
}

static bool shown(const errors *e, const brunt_study_case *c) {
    return finished(c) && abscissa(e, c) > 0 && isfinite(abscissa(e, c)) && isfinite(c->error[e->measure]);
}

static double ordinate(const errors *e, const brunt_study_case *c) {
    return c->error[e->measure] > 0 ? e->y.factor * c->error[e->measure] : e->floor;
}

static void find_ranges(errors *e) {
    const brunt_study *study = e->p.study;
    double least = INFINITY, greatest_x = 0;
    e->x = (plot_axis){INFINITY, -INFINITY, 1}, e->y = (plot_axis){INFINITY, -INFINITY, 1};
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (!shown(e, c)) continue;
        e->zeros += c->error[e->measure] == 0;
        if (c->error[e->measure] > 0) least = fmin(least, c->error[e->measure]);
        greatest_x = fmax(greatest_x, abscissa(e, c));
    }
    e->percent = !(least < 1e-6);
    e->y.factor = e->percent ? 100 : 1;
    if (e->over_resolution) e->x.factor = plot_prefixed(study->axes[study->resolution].unit, greatest_x, e->unit_x);
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (!shown(e, c)) continue;
        plot_axis_widen(&e->x, abscissa(e, c)), plot_axis_widen(&e->y, c->error[e->measure]);
        if (!e->over_resolution) plot_axis_widen(&e->x, c->wall_least), plot_axis_widen(&e->x, c->wall_greatest);
    }
    if (plot_axis_empty(&e->x)) return;
    if (e->over_resolution)
        for (int32_t i = 0; i < study->case_count; i++)
            if (failed(&study->cases[i])) plot_axis_widen(&e->x, brunt_study_resolution(study, &study->cases[i]));
    // What is asked for belongs into the picture, unless it is far from what there is.
    const plot_axis data = e->y;
    for (int32_t a = 0; a < study->accuracy_count && !plot_axis_empty(&data); a++) {
        const double wanted = e->y.factor * study->accuracies[a];
        if (wanted > data.from / 10 && wanted < data.to * 10) plot_axis_widen(&e->y, study->accuracies[a]);
    }
    if (plot_axis_empty(&e->y)) e->percent = false, e->y = (plot_axis){1e-16, 1e-15, 1}; // all errors are zero
    if (e->zeros) e->floor = e->y.from = e->y.from / 4;
    plot_axis_pad(&e->x), plot_axis_pad(&e->y);
}

static void write_points(errors *e, int32_t line, int32_t *points) {
    const brunt_study *study = e->p.study;
    const int32_t count = brunt_study_line_cases(study, line, e->p.cases);
    *points = 0;
    for (int32_t i = 0; i < count; i++) *points += shown(e, &study->cases[e->p.cases[i]]);
    if (!*points) return;
    fprintf(e->p.out, "$line%d << END\n# %s, error%s, least and most time [s]\n", (int)line,
            e->over_resolution ? "resolution" : "time [s]", e->percent ? " [%]" : "");
    for (int32_t i = 0; i < count; i++) {
        const brunt_study_case *c = &study->cases[e->p.cases[i]];
        if (shown(e, c))
            fprintf(e->p.out, "%.9g %.9g %.9g %.9g\n", e->x.factor * abscissa(e, c), ordinate(e, c),
                    isfinite(c->wall_least) ? c->wall_least : c->wall_median,
                    isfinite(c->wall_greatest) ? c->wall_greatest : c->wall_median);
    }
    fprintf(e->p.out, "END\n");
}

// The stair along which nothing is both faster and more accurate, from the upper edge to the right one.
static bool write_front(errors *e) {
    const brunt_study *study = e->p.study;
    int32_t count = 0, *front = e->p.cases;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (!c->front[e->measure] || !shown(e, c)) continue;
        int32_t place = count++;
        for (; place > 0 && study->cases[front[place - 1]].wall_median > c->wall_median; place--)
            front[place] = front[place - 1];
        front[place] = i;
    }
    if (!count) return false;
    fprintf(e->p.out, "$front << END\n%.9g %.9g\n", study->cases[front[0]].wall_median, e->y.to);
    for (int32_t i = 0; i < count; i++) {
        const brunt_study_case *c = &study->cases[front[i]];
        fprintf(e->p.out, "%.9g %.9g\n", c->wall_median, ordinate(e, c));
    }
    fprintf(e->p.out, "%.9g %.9g\nEND\n", e->x.to, ordinate(e, &study->cases[front[count - 1]]));
    return true;
}

static void write_accuracies(errors *e) {
    for (int32_t a = 0; a < e->p.study->accuracy_count; a++) {
        const double y = e->y.factor * e->p.study->accuracies[a];
        if (y < e->y.from || y > e->y.to) continue;
        fprintf(e->p.out,
                "set arrow from graph 0, first %.9g to graph 1, first %.9g nohead back dashtype 2 linewidth 0.9 "
                "linecolor '#666666'\n",
                y, y);
        fprintf(e->p.out, "set label '%.4g %%' at graph 1.01, first %.9g left textcolor '#444444'\n",
                100 * e->p.study->accuracies[a], y);
    }
}

// A run that failed has a resolution but no time: over time they stand in rows from the upper left corner.
static int32_t write_failed(errors *e) {
    enum { ROW = 50 };
    const double step = 0.016; // of the width: crosses beside each other
    const brunt_study *study = e->p.study;
    int32_t count = 0;
    for (int32_t i = 0; i < study->case_count; i++) {
        const brunt_study_case *c = &study->cases[i];
        if (!failed(c)) continue;
        double at = 0.02 + step * (count % ROW), height = 0.985 - 0.03 * (count / ROW);
        if (e->over_resolution) {
            int32_t before = 0; // at the same place
            for (int32_t j = 0; j < i; j++)
                before += failed(&study->cases[j]) &&
                          brunt_study_resolution(study, &study->cases[j]) == brunt_study_resolution(study, c);
            const double x = e->x.factor * brunt_study_resolution(study, c);
            if (!(x > 0) || !isfinite(x)) continue;
            at = log(x / e->x.from) / log(e->x.to / e->x.from) + step * before, height = 0.985;
        }
        fprintf(e->p.out,
                "set label '' at graph %.4f, graph %.4f point pointtype 2 pointsize 1.4 linewidth 2 linecolor '%s' "
                "front\n",
                at, height, colours[look_of(study, c->line).colour]);
        count++;
    }
    return count;
}

// Adds a method's name to a list that ends in "..." where it does not fit the picture; its own commas go, so that they
// part the names only. False: nothing more goes in.
static bool enlist(char note[256], int32_t before, const char *label, const char *suffix) {
    static const size_t most = 92; // characters of a line
    char name[192];
    size_t n = 0;
    for (const char *t = label; *t && n + 1 < sizeof name; t++)
        if (*t != ',') name[n++] = *t;
    name[n] = 0;
    const size_t length = strlen(note);
    if (characters(note) + characters(name) + strlen(suffix) + 2 > most || length + n + strlen(suffix) + 8 > 256) {
        snprintf(note + length, 256 - length, "%s...", before ? ", " : "");
        return false;
    }
    snprintf(note + length, 256 - length, "%s%s%s", before ? ", " : "", name, suffix);
    return true;
}

static bool line_failed(const brunt_study *study, int32_t line) {
    for (int32_t i = 0; i < study->case_count; i++)
        if (study->cases[i].line == line && failed(&study->cases[i])) return true;
    return false;
}

static void notes_of(const errors *e, int32_t failures, notes *note) {
    const brunt_study *study = e->p.study;
    char(*out)[256] = *note;
    int32_t listed = 0;
    memset(note, 0, sizeof *note);
    if (failures) snprintf(out[0], 256, "× %d %s failed: ", (int)failures, failures == 1 ? "run" : "runs");
    for (int32_t l = 0; failures && l < study->line_count; l++)
        if (line_failed(study, l) && !enlist(out[0], listed++, brunt_study_line_label(study, l), "")) break;
    if (e->zeros) snprintf(out[1], 256, "errors of 0 stand at the lower edge");
    const int32_t reference = brunt_study_reference_case(study, e->measure);
    if (reference >= 0) {
        char label[320];
        brunt_study_case_label(study, &study->cases[reference], label);
        snprintf(out[2], 256, "reference, not shown: %.220s", label);
    }
    for (int32_t l = listed = 0; l < study->line_count; l++) {
        char why[160];
        if (!brunt_study_lacks_limit(study, l, e->measure, why)) continue;
        if (!listed) snprintf(out[3], 256, "not shown: ");
        if (!enlist(out[3], listed++, brunt_study_line_label(study, l), " (no limit)")) break;
    }
}

// What errors are measured in: "% of the reference", "% of 2 mm".
static void scale_words(const errors *e, char out[128]) {
    const brunt_study *study = e->p.study;
    const double scale = study->measures[e->measure].scale;
    const char *unit = brunt_study_unit(study, e->measure);
    const bool bare = !unit[0] || !strcmp(unit, "1");
    if (isnan(scale))
        snprintf(out, 128, "%s", e->percent ? "% of the reference" : "of the reference");
    else
        snprintf(out, 128, "%s%.4g%s%s", e->percent ? "% of " : "of ", scale, bare ? "" : " ", bare ? "" : unit);
}

static bool threads_differ(const brunt_study *study) {
    for (int32_t a = 0; a < study->axis_count; a++)
        for (int32_t v = 0; v < study->axes[a].value_count; v++)
            if (study->axes[a].values[v].threads && study->axes[a].values[v].threads != study->threads) return true;
    return false;
}

static void write_time_label(FILE *out, char axis_name, const brunt_study *study) {
    const char what[] = {axis_name, 'l', 'a', 'b', 'e', 'l', 0};
    if (threads_differ(study) || study->threads < 1)
        plot_write_label(out, what, "time of the steps [s]");
    else
        plot_write_label(out, what, "time of the steps on %d %s [s]", (int)study->threads,
                         study->threads == 1 ? "thread" : "threads");
}

static void write_axes(errors *e) {
    const brunt_study *study = e->p.study;
    const brunt_study_measure *m = &study->measures[e->measure];
    char words[128];
    scale_words(e, words);
    plot_write_label(e->p.out, "ylabel", "%s%s [%s]", m->title[0] ? "" : "error of ", m->title[0] ? m->title : m->name,
                     words);
    if (e->over_resolution)
        plot_write_label(e->p.out, "xlabel", "%s [%s]", study->axes[study->resolution].name, e->unit_x);
    else
        write_time_label(e->p.out, 'x', study);
    plot_write_tics(e->p.out, 'x', &e->x);
    plot_write_tics(e->p.out, 'y', &e->y);
}

// Theory's slope, half a decade's third below the lowest point, so that it crosses no line that keeps to it.
static bool write_theory(errors *e) {
    const double order = e->p.study->measures[e->measure].order;
    if (!e->over_resolution || !isfinite(order)) return false;
    double factor = INFINITY; // lowest of error / resolution^order
    for (int32_t i = 0; i < e->p.study->case_count; i++) {
        const brunt_study_case *c = &e->p.study->cases[i];
        if (shown(e, c) && c->error[e->measure] > 0)
            factor = fmin(factor, ordinate(e, c) / pow(e->x.factor * abscissa(e, c), order));
    }
    if (!isfinite(factor)) return false;
    factor *= 0.6;
    fprintf(e->p.out, "theory(x) = %.9g * x**%.9g\n", factor, order);
    return true;
}

static bool repeated(const brunt_study *study) {
    for (int32_t i = 0; i < study->case_count; i++)
        if (study->cases[i].wall_greatest > 1.05 * study->cases[i].wall_least) return true;
    return false;
}

static void plot_errors(errors *e, const int32_t *points, bool front, bool theory) {
    const brunt_study *study = e->p.study;
    const bool connect = study->resolution >= 0;
    if (front) {
        plot_part(&e->p);
        fprintf(e->p.out, "$front using 1:2 with steps linewidth 5 linecolor '#c8c8c8' title 'Pareto front'");
    }
    if (theory) {
        plot_part(&e->p);
        fprintf(e->p.out,
                "theory(x) with lines linewidth 1.6 dashtype 2 linecolor '#777777' title 'theory: order %.3g'",
                study->measures[e->measure].order);
    }
    for (int32_t l = 0; l < study->line_count; l++) {
        char title[256];
        if (!points[l]) continue;
        if (!e->over_resolution && repeated(study)) {
            plot_part(&e->p);
            fprintf(e->p.out, "$line%d using 1:2:3:4 with xerrorbars pointtype 0 linewidth 0.9 linecolor '%s' notitle",
                    (int)l, colours[look_of(study, l).colour]);
        }
        entry(study, l, e->over_resolution ? &study->lines[l].order[e->measure] : NULL, 1, title);
        plot_line(&e->p, l, connect && points[l] > 1, title);
    }
}

static int draw_errors(errors *e, const char *folder, int32_t *points, bool *wanted, brunt_error *error) {
    const brunt_study *study = e->p.study;
    find_ranges(e);
    *wanted = !plot_axis_empty(&e->x);
    if (!*wanted) return BRUNT_OK;
    int status = begin(&e->p, folder, error);
    if (status) return status;
    size_t longest = 0;
    int32_t entries = 0;
    for (int32_t l = 0; l < study->line_count; l++) {
        char title[256];
        write_points(e, l, &points[l]);
        entry(study, l, e->over_resolution ? &study->lines[l].order[e->measure] : NULL, 1, title);
        if (points[l]) longest = characters(title) > longest ? characters(title) : longest, entries++;
    }
    const bool front = !e->over_resolution && write_front(e), theory = write_theory(e);
    bool fitted = false; // in the key
    for (int32_t l = 0; l < study->line_count; l++)
        fitted |= e->over_resolution && points[l] && isfinite(study->lines[l].order[e->measure].slope);
    notes note;
    notes_of(e, write_failed(e), &note);
    write_layout(&e->p, entries + front + theory, longest < 15 ? 15 : longest, true, fitted ? " (fitted orders)" : "",
                 &note);
    write_axes(e);
    write_accuracies(e);
    plot_errors(e, points, front, theory);
    return commit(&e->p, error);
}

// --- time against size

static bool sized(const brunt_study_case *c) {
    return finished(c) && c->units > 0 && c->wall_median > 0 && isfinite(c->wall_median);
}

static int draw_cost(picture *p, const char *folder, bool *wanted, brunt_error *error) {
    const brunt_study *study = p->study;
    plot_axis x = {INFINITY, -INFINITY, 1}, y = x;
    for (int32_t i = 0; i < study->case_count; i++)
        if (sized(&study->cases[i]))
            plot_axis_widen(&x, study->cases[i].units), plot_axis_widen(&y, study->cases[i].wall_median);
    *wanted = !plot_axis_empty(&x) && !plot_axis_empty(&y);
    if (!*wanted) return BRUNT_OK;
    int status = begin(p, folder, error);
    if (status) return status;
    plot_axis_pad(&x), plot_axis_pad(&y);
    bool fitted = false; // in the key
    size_t longest = 0;
    int32_t entries = 0;
    char title[256];
    for (int32_t l = 0; l < study->line_count; l++) {
        const int32_t count = brunt_study_line_cases(study, l, p->cases);
        fprintf(p->out, "$line%d << END\n# particles and elements, time [s]\n", (int)l);
        for (int32_t i = 0; i < count; i++) {
            const brunt_study_case *c = &study->cases[p->cases[i]];
            if (sized(c)) fprintf(p->out, "%.9g %.9g\n", c->units, c->wall_median);
        }
        fprintf(p->out, "END\n");
        entry(study, l, &study->lines[l].cost, 1, title);
        fitted |= isfinite(study->lines[l].cost.slope);
        longest = characters(title) > longest ? characters(title) : longest, entries++;
    }
    write_layout(p, entries, longest, false, fitted ? " (fitted exponents)" : "", NULL);
    plot_write_label(p->out, "xlabel", "particles and elements [1]");
    write_time_label(p->out, 'y', study);
    plot_write_tics(p->out, 'x', &x), plot_write_tics(p->out, 'y', &y);
    for (int32_t l = 0; l < study->line_count; l++) {
        int32_t points = 0;
        for (int32_t i = 0; i < study->case_count; i++) points += study->cases[i].line == l && sized(&study->cases[i]);
        entry(study, l, &study->lines[l].cost, 1, title);
        if (points) plot_line(p, l, points > 1 && study->resolution >= 0, title);
    }
    return commit(p, error);
}

static int finish(const char *folder, const char *name, bool wanted, bool *drawn, brunt_error *error) {
    int status = gnuplot_remove_pictures(folder, name, error);
    if (!status && !wanted) status = gnuplot_remove_file(folder, name, ".gp", error); // of an earlier study here
    if (status || !wanted || !*drawn) return status;
    bool there;
    status = gnuplot_run(folder, name, &there, error);
    if (status) gnuplot_remove_pictures(folder, name, NULL);
    *drawn = *drawn && there;
    return status;
}

// "study" for the first measure, "study_NAME" for the rest; kept apart from the other pictures.
void brunt_study_picture_name(const brunt_study *study, int32_t m, char out[160]) {
    snprintf(out, 160, "study");
    if (!m) return;
    const char *name = study->measures[m].name;
    const bool taken = !strcmp(name, "order") || !strcmp(name, "cost");
    size_t length = (size_t)snprintf(out, 160, "study_%s%s", taken ? "measure_" : "", name);
    for (size_t i = 0; i < length; i++)
        if (strchr("/\\'\"` ", out[i]) || (unsigned char)out[i] < ' ') out[i] = '_';
}

static int write_errors(errors *e, const char *folder, int32_t *points, bool *drawn, brunt_error *error) {
    const brunt_study *study = e->p.study;
    bool wanted = false;
    if (e->over_resolution)
        snprintf(e->p.name, sizeof e->p.name, "study_order");
    else
        brunt_study_picture_name(study, e->measure, e->p.name);
    int status = BRUNT_OK;
    if (!e->over_resolution || study->resolution >= 0) status = draw_errors(e, folder, points, &wanted, error);
    return status ? status : finish(folder, e->p.name, wanted, drawn, error);
}

int brunt_study_write_plots(const brunt_study *study, const char *folder, bool *drawn, brunt_error *error) {
    *drawn = true;
    int32_t *cases = brunt_alloc((size_t)study->case_count * sizeof *cases);
    int32_t *points = brunt_alloc((size_t)study->line_count * sizeof *points);
    int status =
        cases && points ? BRUNT_OK : brunt_fail(error, BRUNT_IO_ERROR, "no memory for the pictures of the study");
    for (int32_t m = 0; m <= study->measure_count && study->measure_count && !status; m++) { // last the order
        const bool order = m == study->measure_count;
        errors e = {.p = {.study = study, .cases = cases}, .measure = order ? 0 : m, .over_resolution = order};
        status = write_errors(&e, folder, points, drawn, error);
    }
    if (!status) {
        picture p = {.study = study, .cases = cases, .name = "study_cost"};
        bool wanted;
        status = draw_cost(&p, folder, &wanted, error);
        if (!status) status = finish(folder, p.name, wanted, drawn, error);
    }
    brunt_free(cases), brunt_free(points);
    return status;
}
