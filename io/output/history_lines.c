// The lines of a history, from memory or from history.csv.
#include "io/output/history_lines.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "io/file/input_file.h"

// "body.grains.17.position_x": of one that is asked for.
static bool is_of_member(const char *name) {
    const char *dot = strncmp(name, "body.", 5) == 0 ? strchr(name + 5, '.') : NULL;
    return dot && dot[1] >= '0' && dot[1] <= '9';
}

bool brunt_history_counts(const char *name) { return strncmp(name, "probe.", 6) != 0 && !is_of_member(name); }

uint64_t brunt_history_hash_value(uint64_t hash, double value) {
    uint64_t bits;
    if (isnan(value)) value = NAN; // there are many, and a text knows one
    memcpy(&bits, &value, sizeof bits);
    return brunt_hash_add(hash, bits);
}

void brunt_history_print_line(const brunt_history *h, const double *values, FILE *out) {
    for (int32_t c = 0; c < h->column_count; c++) {
        if (isnan(values[c]))
            fputs(",nan", out);
        else if (c == 1)
            fprintf(out, ",%.0f", values[c]);
        else
            fprintf(out, c ? ",%.17g" : "%.17g", values[c]);
    }
    fputc('\n', out);
}

void brunt_history_close_lines(line_reader *r) {
    if (r->file) fclose(r->file);
    free(r->text);
    brunt_free(r->column);
    brunt_free(r->counted);
}

static int bad_line(const line_reader *r, brunt_error *error) {
    return brunt_fail(error, BRUNT_BAD_INPUT, "%s: line %lld is no line of a history of %d columns", r->path,
                      (long long)r->row + 1, (int)r->column_count);
}

static int next_text(line_reader *r, brunt_error *error) {
    errno = 0;
    ssize_t length = getline(&r->text, &r->capacity, r->file);
    if (length < 0 && errno)
        return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot read the file: %s", r->path, strerror(errno));
    if (length < 1 || r->text[length - 1] != '\n' || strlen(r->text) != (size_t)length) return bad_line(r, error);
    return BRUNT_OK;
}

// Whether a heading "time [s]" of `length` bytes is that of a column.
static bool is_heading(const column *c, const char *heading, size_t length) {
    const size_t name = strlen(c->name), unit = strlen(c->unit);
    return length == name + unit + 3 && !memcmp(heading, c->name, name) && !memcmp(heading + name, " [", 2) &&
           !memcmp(heading + name + 2, c->unit, unit) && heading[length - 1] == ']';
}

// The column of a heading that is number `f` of its file: the same one in a file of this run, any in one of another
// leg.
static int32_t column_of(const brunt_history *h, int32_t f, const char *heading, size_t length) {
    if (f < h->column_count && is_heading(&h->columns[f], heading, length)) return f;
    size_t name = length;
    while (name > 0 && heading[name - 1] != '[') name--; // no unit has a bracket in it
    const int32_t c = name < 2 ? BRUNT_NONE : brunt_names_find(&h->names, heading, name - 2);
    return c >= 0 && is_heading(&h->columns[c], heading, length) ? c : BRUNT_NONE;
}

// "time [s],step [1],..."
static int read_heading(line_reader *r, brunt_error *error) {
    const brunt_history *h = r->history;
    int status = next_text(r, error);
    if (status) return status;
    int32_t count = 1;
    for (const char *c = r->text; *c; c++) count += *c == ',';
    r->column_count = count;
    r->column = brunt_alloc(sizeof *r->column * (size_t)count);
    r->counted = brunt_alloc(sizeof *r->counted * (size_t)count);
    if (!r->column || !r->counted) return brunt_fail(error, BRUNT_FAILED, "out of memory while reading %s", r->path);
    const char *at = r->text;
    for (int32_t f = 0; f < count; f++, at += strcspn(at, ",\n") + 1) {
        r->counted[f] = brunt_history_counts(at);
        r->column[f] = column_of(h, f, at, strcspn(at, ",\n"));
    }
    return BRUNT_OK;
}

int brunt_history_open_lines(line_reader *r, const brunt_history *h, const char *path, brunt_error *error) {
    *r = (line_reader){.history = h, .path = path};
    if (!path) return BRUNT_OK;
    const char *why;
    r->file = brunt_input_open(path, &why);
    if (!r->file) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the file: %s", path, why);
    return read_heading(r, error);
}

int brunt_history_next_line(line_reader *r, const bool *wanted, double *values, brunt_error *error) {
    const int32_t columns = r->history->column_count;
    if (!r->path) {
        memcpy(values, r->history->lines + columns * r->row++, sizeof *values * (size_t)columns);
        return BRUNT_OK;
    }
    r->row++;
    int status = next_text(r, error);
    for (int32_t c = 0; c < columns && !wanted; c++) values[c] = NAN;
    char *at = r->text;
    for (int32_t f = 0; f < r->column_count && !status; f++) {
        char *end = at;
        if (!wanted || (r->column[f] >= 0 && wanted[r->column[f]])) {
            double value = strtod(at, &end);
            if (end == at) return bad_line(r, error);
            if (r->column[f] >= 0) values[r->column[f]] = value;
            if (r->counted[f]) r->hash = brunt_history_hash_value(r->hash, value);
        } else {
            end += strcspn(at, ",\n");
        }
        if (*end != (f + 1 < r->column_count ? ',' : '\n')) status = bad_line(r, error);
        at = end + 1;
    }
    return status;
}

const char *brunt_history_lines_path(const brunt_history *h) { return h->csv ? h->csv_path : NULL; }
