#include "io/output/history.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/file/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "io/file/hdf5_file.h"
#include "io/file/input_file.h"
#include "base/memory.h"
#include "io/output/places.h"

enum { FORMAT = 2, COLUMN_NAME = 200, BLOCK = 1 << 17 }; // BLOCK: numbers at a time

typedef struct column {
    char name[COLUMN_NAME], unit[16];
    double now, last; // of the line that is being made, of the one before
    double *values;   // all lines, when they have been asked for
} column;

typedef struct probe {
    char name[64];
    int32_t body, field;
    int64_t id;    // particle, node or element
    int64_t count; // how many of them there were at the start
    brunt_field_info info;
} probe;

struct brunt_history {
    column *columns;
    size_t columns_capacity; // [bytes]
    int32_t column_count, cursor;
    bool declaring; // the first traversal names the columns, later ones fill them
    bool out_of_memory;
    int64_t rows;
    uint64_t hash; // of all lines but their probes, which may change from leg to leg
    double *lines; // one after the other, as long as they go to no file
    size_t lines_capacity;
    bool resumed; // lines are in a file that is to be gone on with
    probe *probes;
    int32_t probe_count;
    double *scratch; // a field of a probe's body
    size_t scratch_capacity;
    FILE *csv;
    char csv_path[BRUNT_PATH_LENGTH];
    char title[256];
    uint64_t run; // brunt_checkpoint_identity
};

// ---------------------------------------------------------------------------------------------------- columns

static void add(brunt_history *h, const char *name, const char *unit, double value) {
    if (h->declaring) {
        void *memory = h->columns;
        size_t used = sizeof(column) * (size_t)h->column_count;
        if (brunt_reserve(&memory, &h->columns_capacity, used + sizeof(column), used)) {
            h->out_of_memory = true;
            return;
        }
        h->columns = memory;
        column *c = &h->columns[h->column_count++];
        memset(c, 0, sizeof *c);
        snprintf(c->name, sizeof c->name, "%s", name);
        snprintf(c->unit, sizeof c->unit, "%s", unit);
        return;
    }
    h->columns[h->cursor++].now = value;
}

__attribute__((format(printf, 4, 5))) static void add_named(brunt_history *h, const char *unit, double value,
                                                            const char *format, ...) {
    char name[COLUMN_NAME];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(name, sizeof name, format, arguments);
    va_end(arguments);
    add(h, name, unit, value);
}

static void add_vector(brunt_history *h, const char *name, const char *unit, const double v[3]) {
    for (int c = 0; c < 3; c++) add_named(h, unit, v[c], "%s_%c", name, 'x' + c);
}

// Force over the interval from the impulses at its ends; the impulse columns lie four after the force columns.
static void add_force(brunt_history *h, const char *prefix, double interval, const brunt_force *force) {
    double mean[3] = {0, 0, 0}, square = 0;
    for (int c = 0; c < 3; c++) {
        if (!h->declaring && h->rows > 0 && interval > 0)
            mean[c] = (force->impulse[c] - h->columns[h->cursor + 4 + c].last) / interval;
        square += mean[c] * mean[c];
    }
    char name[COLUMN_NAME];
    snprintf(name, sizeof name, "%s.%s.force", prefix, force->name);
    add_vector(h, name, "N", mean);
    add(h, name, "N", sqrt(square));
    snprintf(name, sizeof name, "%s.%s.impulse", prefix, force->name);
    add_vector(h, name, "N s", force->impulse);
}

static void add_gas(brunt_history *h, const brunt_world *world, int32_t index) {
    brunt_gas gas;
    brunt_world_gas(world, index, &gas);
    add_named(h, "m^3", gas.volume, "gas.%s.volume", gas.name);
    add_named(h, "Pa", gas.pressure, "gas.%s.pressure", gas.name);
    add_named(h, "J", gas.energy, "gas.%s.energy", gas.name);
    add_named(h, "J", gas.inflow, "gas.%s.inflow", gas.name);
}

static void add_energy(brunt_history *h, brunt_world *world) {
    brunt_energy e;
    brunt_world_energy(world, &e);
    add(h, "energy.kinetic", "J", e.kinetic);
    add(h, "energy.internal", "J", e.internal);
    add(h, "energy.mechanical", "J", e.kinetic + e.internal);
    add(h, "energy.plastic", "J", e.plastic);
    add(h, "energy.hourglass", "J", e.hourglass);
    add(h, "energy.contact", "J", e.contact);
    add(h, "energy.friction", "J", e.friction);
    add(h, "energy.viscosity", "J", e.viscosity);
    add(h, "energy.transfer", "J", e.transfer);
    add(h, "energy.eroded", "J", e.eroded);
    add(h, "energy.heat", "J", e.heat);
    add(h, "energy.external_work", "J", e.external_work);
    add(h, "energy.initial", "J", e.initial);
    add(h, "energy.total", "J", e.total);
    add(h, "energy.error", "J", e.error);
    add(h, "energy.error_relative", "1", e.error_relative);
}

static void add_momentum(brunt_history *h, brunt_world *world) {
    brunt_momentum m;
    brunt_world_momentum(world, &m);
    add_vector(h, "momentum.linear", "kg m/s", m.linear);
    add_vector(h, "momentum.angular", "kg m^2/s", m.angular);
    add(h, "momentum.linear_drift", "1", m.linear_drift);
    add(h, "momentum.angular_drift", "1", m.angular_drift);
}

static bool has_effect(const brunt_world *world, const char *name) {
    for (int32_t e = 0; e < brunt_effect_count(world); e++)
        if (!strcmp(brunt_world_effect(world, e).name, name)) return brunt_world_effect(world, e).on;
    return false;
}

static void add_body(brunt_history *h, brunt_world *world, int32_t body) {
    brunt_body_sums sums;
    brunt_body_totals(world, body, &sums);
    char name[COLUMN_NAME];
    const char *body_name = brunt_body_name(world, body);
    add_named(h, "kg", sums.mass, "body.%s.mass", body_name);
    snprintf(name, sizeof name, "body.%s.position", body_name);
    add_vector(h, name, "m", sums.centre);
    snprintf(name, sizeof name, "body.%s.velocity", body_name);
    add_vector(h, name, "m/s", sums.velocity);
    snprintf(name, sizeof name, "body.%s.low", body_name);
    add_vector(h, name, "m", sums.low);
    snprintf(name, sizeof name, "body.%s.high", body_name);
    add_vector(h, name, "m", sums.high);
    add_named(h, "J", sums.kinetic, "body.%s.kinetic", body_name);
    add_named(h, "J", sums.internal, "body.%s.internal", body_name);
    add_named(h, "J", sums.plastic, "body.%s.plastic", body_name);
    if (!has_effect(world, "erosion")) return;
    brunt_eroded eroded;
    brunt_body_eroded(world, body, &eroded);
    add_named(h, "1", (double)(eroded.elements + eroded.particles), "body.%s.eroded", body_name);
    add_named(h, "kg", eroded.mass, "body.%s.eroded_mass", body_name);
}

// Where the probe's id is among those there are now, -1 when it has eroded. Uses the scratch.
static int64_t probe_place(brunt_history *h, brunt_world *world, const probe *p) {
    const int64_t count = brunt_body_size(world, p->body, p->info.at);
    const int32_t field = brunt_place_ids(world, p->body, p->info.at);
    if (count == p->count || field < 0) return p->id;
    brunt_body_read(world, p->body, field, h->scratch);
    int64_t low = 0, high = count; // ids ascend
    while (low < high) {
        int64_t middle = (low + high) / 2;
        if (h->scratch[middle] < (double)p->id)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && h->scratch[low] == (double)p->id ? low : -1;
}

static void add_probe(brunt_history *h, brunt_world *world, const probe *p) {
    static const char *const names3[] = {"x", "y", "z"}, *const names6[] = {"xx", "yy", "zz", "xy", "yz", "xz"},
                             *const names9[] = {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
    int n = p->info.components;
    const char *const *names = n == 3 ? names3 : n == 6 ? names6 : n == 9 ? names9 : NULL;
    const double *values = NULL;
    if (!h->declaring) {
        void *memory = h->scratch;
        size_t bytes = sizeof(double) * (size_t)n * (size_t)brunt_body_size(world, p->body, p->info.at);
        if (brunt_reserve(&memory, &h->scratch_capacity, bytes, 0)) {
            h->out_of_memory = true;
            return;
        }
        h->scratch = memory;
        const int64_t place = probe_place(h, world, p);
        brunt_body_read(world, p->body, p->field, h->scratch);
        if (place >= 0) values = h->scratch + (size_t)n * (size_t)place;
    }
    for (int c = 0; c < n; c++) {
        double value = values ? values[c] : h->declaring ? 0 : NAN; // it has eroded
        if (names)
            add_named(h, p->info.unit, value, "probe.%s.%s", p->name, names[c]);
        else if (n == 1)
            add_named(h, p->info.unit, value, "probe.%s", p->name);
        else
            add_named(h, p->info.unit, value, "probe.%s.%d", p->name, c);
    }
}

// Every column there is, in order. The same traversal names them and fills them, so that the two cannot differ.
static void traverse(brunt_history *h, brunt_world *world) {
    h->cursor = 0;
    double time = brunt_world_time(world), interval = 0;
    if (!h->declaring && h->rows > 0) interval = time - h->columns[0].last;
    add(h, "time", "s", time);
    add(h, "step", "1", (double)brunt_world_steps(world));
    add(h, "dt", "s", brunt_world_dt(world));
    add_energy(h, world);
    add_momentum(h, world);
    for (int32_t b = 0; b < brunt_body_count(world); b++) add_body(h, world, b);
    const bool flat = brunt_world_dimension(world) == 2 && !has_effect(world, "axisymmetric");
    for (int32_t p = 0; p < brunt_pair_count(world); p++) {
        brunt_force force;
        brunt_pair_force(world, p, &force);
        add_force(h, "contact", interval, &force);
        add_named(h, flat ? "m" : "m^2", force.area, "contact.%s.area", force.name);
    }
    for (int32_t w = 0; w < brunt_wall_count(world); w++) {
        brunt_force force;
        brunt_wall_force(world, w, &force);
        add_force(h, "wall", interval, &force);
    }
    for (int32_t g = 0; g < brunt_gas_count(world); g++) add_gas(h, world, g);
    for (int32_t p = 0; p < h->probe_count; p++) add_probe(h, world, &h->probes[p]);
}

// ---------------------------------------------------------------------------------------------------- probes

static int64_t nearest_place(const double *places, int64_t count, int dimension, const double point[3]) {
    double least = INFINITY;
    int64_t nearest = -1;
    for (int64_t i = 0; i < count; i++) {
        double square = 0;
        for (int c = 0; c < dimension; c++) {
            double d = places[3 * i + c] - point[c];
            square += d * d;
        }
        if (square < least) least = square, nearest = i;
    }
    return nearest;
}

static int find_probe(brunt_world *world, const brunt_probe *def, probe *out, brunt_error *error) {
    snprintf(out->name, sizeof out->name, "%s", def->name);
    out->body = brunt_find_body(world, def->body);
    if (out->body < 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "output.probes.%s: there is no body '%s'", def->name, def->body);
    out->field = brunt_body_find_field(world, out->body, def->field);
    if (out->field < 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "output.probes.%s: body '%s' has no field '%s'", def->name, def->body,
                          def->field);
    out->info = brunt_body_field(world, out->body, out->field);
    double *places = NULL;
    int status = brunt_places_read(world, out->body, out->info.at, &places, error);
    if (status) return status;
    out->count = brunt_body_size(world, out->body, out->info.at);
    out->id = nearest_place(places, out->count, brunt_world_dimension(world), def->point);
    brunt_free(places);
    if (out->id < 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "output.probes.%s: body '%s' is empty", def->name, def->body);
    return BRUNT_OK;
}

brunt_history *brunt_history_create(brunt_world *world, const brunt_scene *scene, brunt_error *error) {
    brunt_history *h = brunt_alloc(sizeof *h);
    if (h) h->probes = brunt_alloc(sizeof *h->probes * (size_t)scene->output.probe_count);
    if (!h || !h->probes) {
        brunt_free(h);
        brunt_fail(error, BRUNT_FAILED, "out of memory");
        return NULL;
    }
    snprintf(h->title, sizeof h->title, "%s", scene->title);
    for (int32_t p = 0; p < scene->output.probe_count; p++) {
        if (find_probe(world, &scene->output.probes[p], &h->probes[p], error)) {
            brunt_history_destroy(h);
            return NULL;
        }
        h->probe_count++;
    }
    h->declaring = true;
    traverse(h, world);
    h->declaring = false;
    if (h->out_of_memory) {
        brunt_history_destroy(h);
        brunt_fail(error, BRUNT_FAILED, "out of memory");
        return NULL;
    }
    return h;
}

// What was read back is no longer all.
static void forget_columns(const brunt_history *h) {
    for (int32_t c = 0; c < h->column_count; c++) {
        brunt_free(h->columns[c].values);
        h->columns[c].values = NULL;
    }
}

void brunt_history_destroy(brunt_history *history) {
    if (!history) return;
    if (history->csv) fclose(history->csv);
    forget_columns(history);
    brunt_free(history->columns);
    brunt_free(history->lines);
    brunt_free(history->probes);
    brunt_free(history->scratch);
    brunt_free(history);
}

void brunt_history_identify(brunt_history *history, uint64_t run) { history->run = run; }

int64_t brunt_history_rows(const brunt_history *history) { return history->rows; }
int32_t brunt_history_column_count(const brunt_history *history) { return history->column_count; }
const char *brunt_history_column_name(const brunt_history *history, int32_t c) { return history->columns[c].name; }
const char *brunt_history_column_unit(const brunt_history *history, int32_t c) { return history->columns[c].unit; }

uint64_t brunt_history_hash(const brunt_history *history) { return history->hash; }
double brunt_history_time(const brunt_history *history) { return history->rows ? history->columns[0].last : NAN; }

// ---------------------------------------------------------------------------------------------------- lines

static bool counts(const char *name) { return strncmp(name, "probe.", 6) != 0; }

static uint64_t hash_value(uint64_t hash, double value) {
    uint64_t bits;
    if (isnan(value)) value = NAN; // there are many, and a text knows one
    memcpy(&bits, &value, sizeof bits);
    return brunt_hash_add(hash, bits);
}

static void print_line(const brunt_history *h, const double *values, FILE *out) {
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

// Lines as they were sampled, from memory or from history.csv. 17 digits give every bit of a double back.
typedef struct line_reader {
    const brunt_history *history;
    const char *path; // NULL: from memory
    FILE *file;
    char *text; // of the C library, as the next one
    size_t capacity;
    int32_t *column; // of each of the file's: the history's, -1: it has no such
    bool *counted;
    int32_t column_count; // of the file
    int64_t row;
    uint64_t hash; // of the lines so far
} line_reader;

static void close_lines(line_reader *r) {
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
        char wanted[COLUMN_NAME + 32];
        const size_t length = strcspn(at, ",\n");
        r->column[f] = -1;
        r->counted[f] = counts(at);
        for (int32_t c = 0; c < h->column_count && r->column[f] < 0; c++) {
            snprintf(wanted, sizeof wanted, "%s [%s]", h->columns[c].name, h->columns[c].unit);
            if (strlen(wanted) == length && !strncmp(wanted, at, length)) r->column[f] = c;
        }
    }
    return BRUNT_OK;
}

static int open_lines(line_reader *r, const brunt_history *h, const char *path, brunt_error *error) {
    *r = (line_reader){.history = h, .path = path};
    if (!path) return BRUNT_OK;
    const char *why;
    r->file = brunt_input_open(path, &why);
    if (!r->file) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the file: %s", path, why);
    return read_heading(r, error);
}

// The next line into `values`, one a column of the history, NAN where the file has none; of one column alone with
// `only` >= 0.
static int next_line(line_reader *r, int32_t only, double *values, brunt_error *error) {
    const int32_t columns = r->history->column_count;
    if (!r->path) {
        memcpy(values, r->history->lines + columns * r->row++, sizeof *values * (size_t)columns);
        return BRUNT_OK;
    }
    r->row++;
    int status = next_text(r, error);
    for (int32_t c = 0; c < columns && only < 0; c++) values[c] = NAN;
    char *at = r->text;
    for (int32_t f = 0; f < r->column_count && !status; f++) {
        char *end = at;
        if (only < 0 || r->column[f] == only) {
            double value = strtod(at, &end);
            if (end == at) return bad_line(r, error);
            if (r->column[f] >= 0) values[r->column[f]] = value;
            if (r->counted[f]) r->hash = hash_value(r->hash, value);
        } else {
            end += strcspn(at, ",\n");
        }
        if (*end != (f + 1 < r->column_count ? ',' : '\n')) status = bad_line(r, error);
        at = end + 1;
    }
    return status;
}

static const char *lines_path(const brunt_history *h) { return h->csv ? h->csv_path : NULL; }

// ---------------------------------------------------------------------------------------------------- sampling

static int keep_in_memory(brunt_history *h, brunt_error *error) {
    void *memory = h->lines;
    const size_t bytes = sizeof(double) * (size_t)h->column_count, used = bytes * (size_t)h->rows;
    if (brunt_reserve(&memory, &h->lines_capacity, used + bytes, used))
        return brunt_fail(error, BRUNT_FAILED, "out of memory after %lld history lines", (long long)h->rows);
    h->lines = memory;
    for (int32_t c = 0; c < h->column_count; c++) h->lines[h->column_count * h->rows + c] = h->columns[c].now;
    return BRUNT_OK;
}

static int append_to_file(brunt_history *h, brunt_error *error) {
    void *memory = h->scratch;
    if (brunt_reserve(&memory, &h->scratch_capacity, sizeof(double) * (size_t)h->column_count, 0))
        return brunt_fail(error, BRUNT_FAILED, "out of memory after %lld history lines", (long long)h->rows);
    h->scratch = memory;
    for (int32_t c = 0; c < h->column_count; c++) h->scratch[c] = h->columns[c].now;
    print_line(h, h->scratch, h->csv);
    if (fflush(h->csv) || ferror(h->csv))
        return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot write the file: %s", h->csv_path, strerror(errno));
    return BRUNT_OK;
}

int brunt_history_sample(brunt_history *history, brunt_world *world, brunt_error *error) {
    traverse(history, world);
    if (history->out_of_memory)
        return brunt_fail(error, BRUNT_FAILED, "out of memory after %lld history lines", (long long)history->rows);
    int status = history->csv ? append_to_file(history, error) : keep_in_memory(history, error);
    if (status) return status;
    for (int32_t c = 0; c < history->column_count; c++) {
        column *at = &history->columns[c];
        if (counts(at->name)) history->hash = hash_value(history->hash, at->now);
        at->last = at->now;
    }
    history->rows++;
    forget_columns(history);
    return BRUNT_OK;
}

int brunt_history_read(const brunt_history *history, const char *name, const double **values, brunt_error *error) {
    int32_t c = 0;
    while (c < history->column_count && strcmp(history->columns[c].name, name) != 0) c++;
    if (c == history->column_count) return brunt_fail(error, BRUNT_BAD_INPUT, "the history has no column '%s'", name);
    *values = history->columns[c].values;
    if (*values) return BRUNT_OK;
    double *all = brunt_alloc(sizeof *all * (size_t)history->rows),
           *line = brunt_alloc(sizeof *line * (size_t)history->column_count);
    line_reader r = {0};
    int status = all && line ? open_lines(&r, history, lines_path(history), error)
                             : brunt_fail(error, BRUNT_FAILED, "out of memory for the history's column '%s'", name);
    for (int64_t row = 0; row < history->rows && !status; row++) {
        status = next_line(&r, c, line, error);
        all[row] = line[c];
    }
    close_lines(&r);
    brunt_free(line);
    if (status) {
        brunt_free(all);
        return status;
    }
    *values = history->columns[c].values = all;
    return BRUNT_OK;
}

const double *brunt_history_column(const brunt_history *history, const char *name) {
    const double *values;
    return brunt_history_read(history, name, &values, NULL) ? NULL : values;
}

// ---------------------------------------------------------------------------------------------------- files

int brunt_history_resume(brunt_history *history, const char *path, int64_t lines, uint64_t hash, brunt_error *error) {
    double *line = brunt_alloc(sizeof *line * (size_t)history->column_count);
    line_reader r = {0};
    int status = line ? open_lines(&r, history, path, error)
                      : brunt_fail(error, BRUNT_FAILED, "out of memory while reading %s", path);
    for (int64_t row = 0; row < lines && !status; row++) status = next_line(&r, -1, line, error);
    if (!status && r.hash != hash)
        status =
            brunt_fail(error, BRUNT_BAD_INPUT,
                       "%s: its first %lld lines are not those of the checkpoint: of another run, or changed since",
                       path, (long long)lines);
    for (int32_t c = 0; c < history->column_count && !status && lines; c++) history->columns[c].last = line[c];
    if (!status) history->rows = lines, history->hash = hash, history->resumed = true;
    close_lines(&r);
    brunt_free(line);
    return status;
}

static int print_all(const brunt_history *h, const char *path, FILE *out, brunt_error *error) {
    for (int32_t c = 0; c < h->column_count; c++)
        fprintf(out, "%s%s [%s]", c ? "," : "", h->columns[c].name, h->columns[c].unit);
    fputc('\n', out);
    if (!h->rows) return BRUNT_OK;
    double *line = brunt_alloc(sizeof *line * (size_t)h->column_count);
    line_reader r = {0};
    int status = line ? open_lines(&r, h, h->resumed ? path : NULL, error)
                      : brunt_fail(error, BRUNT_FAILED, "out of memory while writing %s", path);
    for (int64_t row = 0; row < h->rows && !status; row++) {
        status = next_line(&r, -1, line, error);
        if (!status) print_line(h, line, out);
    }
    close_lines(&r);
    brunt_free(line);
    return status;
}

int brunt_history_open_csv(brunt_history *history, const char *path, brunt_error *error) {
    brunt_atomic_file file;
    int status = brunt_atomic_open(&file, path, error);
    if (status) return status;
    status = print_all(history, path, file.stream, error);
    if (status) {
        brunt_atomic_abandon(&file);
        return status;
    }
    status = brunt_atomic_commit(&file, error);
    if (status) return status;
    memcpy(history->csv_path, file.path, sizeof file.path);
    int descriptor = open(path, O_WRONLY | O_APPEND | O_NOFOLLOW | O_CLOEXEC);
    history->csv = descriptor < 0 ? NULL : fdopen(descriptor, "a");
    if (!history->csv) {
        if (descriptor >= 0) close(descriptor);
        return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the file: %s", path, strerror(errno));
    }
    // A line fits the buffer (25 characters a number), so that it reaches the file in one write.
    setvbuf(history->csv, NULL, _IOFBF, 64 + 26 * (size_t)history->column_count);
    brunt_free(history->lines);
    history->lines = NULL, history->lines_capacity = 0;
    return BRUNT_OK;
}

int brunt_history_sync(const brunt_history *history, brunt_error *error) {
    if (!history->csv || !fdatasync(fileno(history->csv))) return BRUNT_OK;
    return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot write the file: %s", history->csv_path, strerror(errno));
}

double brunt_history_line_bytes(const brunt_history *history) {
    double bytes = 8 * (double)history->column_count; // history.h5
    for (int32_t c = 0; c < history->column_count; c++)
        bytes += 1 + snprintf(NULL, 0, "%.17g", history->columns[c].last);
    return bytes;
}

// "body.rod.mass" -> "/body/rod/mass"
static void dataset_name(const char *column_name, char out[COLUMN_NAME + 1]) {
    snprintf(out, COLUMN_NAME + 1, "/%s", column_name);
    for (char *c = out; *c; c++)
        if (*c == '.') *c = '/';
}

static bool make_columns(const brunt_history *h, hid_t file, int64_t chunk) {
    bool ok = brunt_hdf5_put_text(file, "title", h->title) && brunt_hdf5_put_text(file, "version", BRUNT_VERSION) &&
              brunt_hdf5_put_integer(file, "run", (long long)h->run) &&
              brunt_hdf5_put_text(file, "force", "mean over the interval since the line before");
    for (int32_t c = 0; c < h->column_count && ok; c++) {
        char name[COLUMN_NAME + 1];
        dataset_name(h->columns[c].name, name);
        hid_t set = brunt_hdf5_make(file, name, H5T_IEEE_F64LE, (hsize_t)h->rows, (hsize_t)chunk);
        ok = set >= 0 && brunt_hdf5_put_text(set, "unit", h->columns[c].unit);
        if (set >= 0) H5Dclose(set);
    }
    return ok;
}

// Lines [first, first + count), which lie one after the other in `lines`, to their columns.
static bool put_lines(const brunt_history *h, hid_t file, int64_t first, int64_t count, const double *lines,
                      double *values) {
    bool ok = true;
    for (int32_t c = 0; c < h->column_count && ok; c++) {
        char name[COLUMN_NAME + 1];
        dataset_name(h->columns[c].name, name);
        for (int64_t row = 0; row < count; row++) values[row] = lines[h->column_count * row + c];
        hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
        ok = set >= 0 && brunt_hdf5_write_part(set, H5T_NATIVE_DOUBLE, first, count, values);
        if (set >= 0) H5Dclose(set);
    }
    return ok;
}

// A block of lines at a time: no more of them is in memory.
static int put_all(const brunt_history *h, hid_t file, const char *path, brunt_error *error) {
    const int64_t most = BLOCK / h->column_count > 0 ? BLOCK / h->column_count : 1, block = h->rows < 1      ? 1
                                                                                            : h->rows < most ? h->rows
                                                                                                             : most;
    double *lines = brunt_alloc(sizeof *lines * (size_t)(block * (h->column_count + 1)));
    line_reader r = {0};
    int status = lines ? open_lines(&r, h, lines_path(h), error)
                       : brunt_fail(error, BRUNT_FAILED, "out of memory while writing %s", path);
    if (!status && !make_columns(h, file, block))
        status = brunt_fail(error, BRUNT_IO_ERROR, "%s: HDF5 could not write the file", path);
    for (int64_t first = 0; first < h->rows && !status; first += block) {
        const int64_t count = h->rows - first < block ? h->rows - first : block;
        for (int64_t row = 0; row < count && !status; row++)
            status = next_line(&r, -1, lines + h->column_count * row, error);
        if (!status && !put_lines(h, file, first, count, lines, lines + block * h->column_count))
            status = brunt_fail(error, BRUNT_IO_ERROR, "%s: HDF5 could not write the file", path);
    }
    close_lines(&r);
    brunt_free(lines);
    return status;
}

int brunt_history_write(const brunt_history *history, const char *path, brunt_error *error) {
    const double room = 65536 + (double)history->column_count * (4096 + 8.1 * (double)history->rows);
    brunt_atomic_file out;
    hid_t file;
    int status = brunt_hdf5_create_aside(path, (size_t)room, &out, &file, error);
    if (status) return status;
    status = put_all(history, file, path, error);
    status = brunt_hdf5_seal(file, "history", FORMAT, status, &out, error);
    return status ? status : brunt_atomic_rename(&out, error);
}

// Opens a column of a file; negative when there is none.
static hid_t open_column(hid_t file, const char *name, int64_t *count) {
    char path[COLUMN_NAME + 1];
    dataset_name(name, path);
    return brunt_hdf5_dataset(file, path, H5T_FLOAT, sizeof(double), count);
}

int brunt_history_check_file(const brunt_history *history, const char *path, brunt_error *error) {
    hid_t file;
    long long run = 0;
    int status = brunt_hdf5_open(path, "history", FORMAT, &file, error);
    if (status) return status;
    if (!brunt_hdf5_get_integer(file, "run", &run) || (uint64_t)run != history->run)
        status = brunt_fail(error, BRUNT_BAD_INPUT, "%s: the history of another run than this scene's", path);
    H5Fclose(file);
    return status;
}

typedef struct description {
    FILE *out;
    hid_t file;
} description;

static herr_t describe_dataset(hid_t root, const char *name, const H5O_info_t *info, void *context) {
    const description *d = context;
    (void)root;
    if (info->type != H5O_TYPE_DATASET) return 0;
    char unit[32] = "", column_name[COLUMN_NAME];
    double first = NAN, last = NAN;
    int64_t count;
    snprintf(column_name, sizeof column_name, "%s", name);
    for (char *c = column_name; *c; c++)
        if (*c == '/') *c = '.';
    hid_t set = open_column(d->file, column_name, &count);
    if (set >= 0) {
        brunt_hdf5_get_text(set, "unit", unit, sizeof unit);
        if (count > 0) brunt_hdf5_read(set, H5T_NATIVE_DOUBLE, 0, 1, &first);
        if (count > 0) brunt_hdf5_read(set, H5T_NATIVE_DOUBLE, count - 1, 1, &last);
        H5Dclose(set);
    }
    brunt_hdf5_printable(column_name);
    fprintf(d->out, "%-44s [%-8s] first %15.8g  last %15.8g\n", column_name, unit, first, last);
    return 0;
}

int brunt_history_describe(const char *path, FILE *out, brunt_error *error) {
    hid_t file;
    int status = brunt_hdf5_open(path, "history", FORMAT, &file, error);
    if (status) return status;
    char title[256] = "", version[64] = "";
    brunt_hdf5_get_text(file, "title", title, sizeof title);
    brunt_hdf5_get_text(file, "version", version, sizeof version);
    int64_t lines;
    hid_t time = open_column(file, "time", &lines);
    if (time >= 0) {
        H5Dclose(time);
        fprintf(out, "history of '%s', written by brunt %s: %lld lines\n", title, version, (long long)lines);
    } else {
        status = brunt_fail(error, BRUNT_BAD_INPUT, "%s: the history has no column 'time'", path);
    }
    description d = {out, file};
    if (!status && H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, describe_dataset, &d, H5O_INFO_BASIC) < 0)
        status = brunt_fail(error, BRUNT_BAD_INPUT, "%s: HDF5 cannot read the file", path);
    H5Fclose(file);
    return status;
}
