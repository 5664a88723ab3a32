#include "history.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "atomic_file.h"
#include "error.h"
#include "hdf5_file.h"
#include "memory.h"
#include "places.h"

enum { FORMAT = 2, COLUMN_NAME = 200 };

typedef struct column {
    char name[COLUMN_NAME], unit[16];
    double *values;
    size_t capacity; // [bytes]
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
    column *c = &h->columns[h->cursor++];
    void *memory = c->values;
    if (brunt_reserve(&memory, &c->capacity, sizeof(double) * (size_t)(h->rows + 1),
                      sizeof(double) * (size_t)h->rows)) {
        h->out_of_memory = true;
        return;
    }
    c->values = memory;
    c->values[h->rows] = value;
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
            mean[c] = (force->impulse[c] - h->columns[h->cursor + 4 + c].values[h->rows - 1]) / interval;
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
    if (!h->declaring && h->rows > 0) interval = time - h->columns[0].values[h->rows - 1];
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

void brunt_history_destroy(brunt_history *history) {
    if (!history) return;
    if (history->csv) fclose(history->csv);
    for (int32_t c = 0; c < history->column_count; c++) brunt_free(history->columns[c].values);
    brunt_free(history->columns);
    brunt_free(history->probes);
    brunt_free(history->scratch);
    brunt_free(history);
}

void brunt_history_identify(brunt_history *history, uint64_t run) { history->run = run; }

int64_t brunt_history_rows(const brunt_history *history) { return history->rows; }
int32_t brunt_history_column_count(const brunt_history *history) { return history->column_count; }
const char *brunt_history_column_name(const brunt_history *history, int32_t c) { return history->columns[c].name; }
const char *brunt_history_column_unit(const brunt_history *history, int32_t c) { return history->columns[c].unit; }

const double *brunt_history_column(const brunt_history *history, const char *name) {
    static const double none[1];
    for (int32_t c = 0; c < history->column_count; c++)
        if (!strcmp(history->columns[c].name, name)) return history->rows ? history->columns[c].values : none;
    return NULL;
}

// ---------------------------------------------------------------------------------------------------- files

static void print_line(const brunt_history *h, int64_t row, FILE *out) {
    for (int32_t c = 0; c < h->column_count; c++) {
        if (c == 1)
            fprintf(out, ",%.0f", h->columns[c].values[row]);
        else
            fprintf(out, c ? ",%.17g" : "%.17g", h->columns[c].values[row]);
    }
    fputc('\n', out);
}

int brunt_history_sample(brunt_history *history, brunt_world *world, brunt_error *error) {
    traverse(history, world);
    if (history->out_of_memory)
        return brunt_fail(error, BRUNT_FAILED, "out of memory after %lld history lines", (long long)history->rows);
    history->rows++;
    if (!history->csv) return BRUNT_OK;
    print_line(history, history->rows - 1, history->csv);
    if (fflush(history->csv) || ferror(history->csv))
        return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot write the file: %s", history->csv_path, strerror(errno));
    return BRUNT_OK;
}

int brunt_history_open_csv(brunt_history *history, const char *path, brunt_error *error) {
    brunt_atomic_file file;
    int status = brunt_atomic_open(&file, path, error);
    if (status) return status;
    for (int32_t c = 0; c < history->column_count; c++)
        fprintf(file.stream, "%s%s [%s]", c ? "," : "", history->columns[c].name, history->columns[c].unit);
    fputc('\n', file.stream);
    for (int64_t row = 0; row < history->rows; row++) print_line(history, row, file.stream);
    status = brunt_atomic_commit(&file, error);
    if (status) return status;
    memcpy(history->csv_path, file.path, sizeof file.path);
    history->csv = fopen(path, "abe");
    if (!history->csv) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the file: %s", path, strerror(errno));
    // A line fits the buffer (25 characters a number), so that it reaches the file in one write.
    setvbuf(history->csv, NULL, _IOFBF, 64 + 26 * (size_t)history->column_count);
    return BRUNT_OK;
}

// "body.rod.mass" -> "/body/rod/mass"
static void dataset_name(const char *column_name, char out[COLUMN_NAME + 1]) {
    snprintf(out, COLUMN_NAME + 1, "/%s", column_name);
    for (char *c = out; *c; c++)
        if (*c == '.') *c = '/';
}

int brunt_history_write(const brunt_history *history, const char *path, brunt_error *error) {
    hid_t file = brunt_hdf5_create((size_t)history->column_count * (1024 + sizeof(double) * (size_t)history->rows));
    if (file < 0) return brunt_fail(error, BRUNT_FAILED, "%s: HDF5 could not start the file", path);
    bool ok = brunt_hdf5_put_text(file, "title", history->title) &&
              brunt_hdf5_put_text(file, "version", BRUNT_VERSION) &&
              brunt_hdf5_put_integer(file, "run", (long long)history->run) &&
              brunt_hdf5_put_text(file, "force", "mean over the interval since the line before");
    for (int32_t c = 0; c < history->column_count && ok; c++) {
        char name[COLUMN_NAME + 1];
        dataset_name(history->columns[c].name, name);
        ok = brunt_hdf5_put(file, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, (hsize_t)history->rows,
                            history->columns[c].values);
        hid_t set = ok ? H5Dopen2(file, name, H5P_DEFAULT) : -1;
        ok = set >= 0 && brunt_hdf5_put_text(set, "unit", history->columns[c].unit);
        if (set >= 0) H5Dclose(set);
    }
    if (!ok) {
        H5Fclose(file);
        return brunt_fail(error, BRUNT_FAILED, "%s: HDF5 could not put the file together", path);
    }
    brunt_atomic_file out;
    int status = brunt_hdf5_write(file, "history", FORMAT, path, &out, error);
    return status ? status : brunt_atomic_rename(&out, error);
}

// Opens a column of a file; negative when there is none.
static hid_t open_column(hid_t file, const char *name, int64_t *count) {
    char path[COLUMN_NAME + 1];
    dataset_name(name, path);
    return brunt_hdf5_dataset(file, path, H5T_FLOAT, sizeof(double), count);
}

// Reads a column of `length` values; false when there is none.
static bool read_column(hid_t file, const char *name, double *values, int64_t length) {
    int64_t count;
    hid_t set = open_column(file, name, &count);
    bool good = set >= 0 && count == length && brunt_hdf5_read(set, H5T_NATIVE_DOUBLE, 0, count, values);
    if (set >= 0) H5Dclose(set);
    return good;
}

static int load_columns(brunt_history *h, hid_t file, const char *path, int64_t last_step, brunt_error *error) {
    int64_t length, rows = 0;
    hid_t step = open_column(file, "step", &length);
    if (step >= 0) H5Dclose(step);
    if (step < 0) return brunt_fail(error, BRUNT_BAD_INPUT, "%s: the history has no column 'step'", path);
    for (int32_t c = 0; c < h->column_count; c++) {
        void *memory = h->columns[c].values;
        if (brunt_reserve(&memory, &h->columns[c].capacity, sizeof(double) * ((size_t)length + 1), 0))
            return brunt_fail(error, BRUNT_FAILED, "out of memory while reading %s", path);
        h->columns[c].values = memory;
        bool found = read_column(file, h->columns[c].name, memory, length);
        for (int64_t r = 0; !found && r < length; r++) h->columns[c].values[r] = NAN;
    }
    const double *steps = h->columns[1].values;
    while (rows < length && steps[rows] <= (double)last_step) rows++;
    h->rows = rows;
    return BRUNT_OK;
}

int brunt_history_load(brunt_history *history, const char *path, int64_t last_step, brunt_error *error) {
    hid_t file;
    int status = brunt_hdf5_open(path, "history", FORMAT, &file, error);
    if (status) return status;
    long long run = 0;
    if (!brunt_hdf5_get_integer(file, "run", &run) || (uint64_t)run != history->run)
        status = brunt_fail(error, BRUNT_BAD_INPUT, "%s: the history of another run than this scene's", path);
    if (!status) status = load_columns(history, file, path, last_step, error);
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
