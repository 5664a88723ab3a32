// The stored benchmark of this machine: the file is found, read, and asked for figures.
#include "io/performance/machine.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/simd.h"
#include "io/file/input_file.h"
#include "base/array.h"
#include "base/memory.h"

static const char header[] = "kind,name,units,threads,figure,unit,median,least,rounds";
enum { FIELDS = 9 };

// ------------------------------------------------------------------------------------------ the file's name

void brunt_machine_processor(char out[128]) {
    char line[256];
    snprintf(out, 128, "unknown processor");
    FILE *info = fopen("/proc/cpuinfo", "r");
    while (info && fgets(line, sizeof line, info)) {
        const char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || !value) continue;
        value += 1 + strspn(value + 1, " \t");
        snprintf(out, 128, "%.*s", (int)strcspn(value, "\n"), value);
        break;
    }
    if (info) fclose(info);
}

// Words that say nothing about which processor it is.
static bool is_filler(const char *word) {
    static const char *const filler[] = {"r", "tm", "cpu", "processor", "core"};
    for (size_t k = 0; k < sizeof filler / sizeof *filler; k++)
        if (strcmp(word, filler[k]) == 0) return true;
    return false;
}

void brunt_machine_name(char out[128]) {
    char processor[128], word[128];
    brunt_machine_processor(processor);
    processor[strcspn(processor, "@")] = 0; // the rest is the clock
    size_t length = 0;
    for (const char *p = processor; *p;) {
        size_t letters = 0;
        for (; isalnum((unsigned char)*p); p++) word[letters++] = (char)tolower((unsigned char)*p);
        word[letters] = 0;
        if (letters && !is_filler(word)) length += (size_t)snprintf(out + length, 128 - length, "%s-", word);
        while (*p && !isalnum((unsigned char)*p)) p++;
    }
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    snprintf(out + length, 128 - length, "%ld", cores > 0 ? cores : 1);
#ifdef BRUNT_FLOAT
    strncat(out, "-float", 127 - strlen(out));
#endif
}

// The program may have been moved with what was installed beside it, hence from its own place; else the source folder.
static bool find_stored(char *path, size_t size) {
    char name[128], program[512];
    brunt_machine_name(name);
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length > 0) {
        program[length] = 0;
        *strrchr(program, '/') = 0;
        snprintf(path, size, "%s/" BRUNT_MACHINES_INSTALLED "/%s.csv", program, name);
        if (access(path, R_OK) == 0) return true;
    }
    snprintf(path, size, "%s/%s.csv", BRUNT_MACHINES, name);
    return access(path, R_OK) == 0;
}

// ------------------------------------------------------------------------------------------ reading

typedef struct reader {
    brunt_machine *machine;
    size_t capacity;
    int32_t *place; // 1 + a row by the hash of its figure, or behind it where that is taken; 0: none
    size_t places;  // a power of 2, more than twice as many as rows
    int line;
    bool has_header;
    brunt_error *error;
} reader;

static int bad(const reader *r, const char *what, const char *text) {
    return brunt_fail(r->error, BRUNT_BAD_INPUT, "%.500s:%d: %s '%.200s'", r->machine->path, r->line, what, text);
}

static int read_number(const reader *r, const char *what, const char *text, double least, double *out) {
    char *end, message[96];
    *out = strtod(text, &end);
    if (end != text && !*end && isfinite(*out) && *out >= least) return BRUNT_OK;
    snprintf(message, sizeof message, "%s is to be a number from %g on, not", what, least);
    return bad(r, message, text);
}

static int read_count(const reader *r, const char *what, const char *text, int32_t *out) {
    double value;
    int status = read_number(r, what, text, 1, &value);
    if (status) return status;
    if (value != floor(value) || value > INT32_MAX) return bad(r, "a whole number is wanted, not", text);
    *out = (int32_t)value;
    return BRUNT_OK;
}

static int read_text(const reader *r, const char *what, const char *text, char *out, size_t size) {
    char message[96];
    const size_t length = strlen(text);
    if (length && length < size) {
        memcpy(out, text, length + 1);
        return BRUNT_OK;
    }
    snprintf(message, sizeof message, "%s is to have 1 to %zu characters, not", what, size - 1);
    return bad(r, message, text);
}

static bool same_figure(const brunt_machine_row *a, const brunt_machine_row *b) {
    return a->units == b->units && a->threads == b->threads && strcmp(a->kind, b->kind) == 0 &&
           strcmp(a->name, b->name) == 0 && strcmp(a->figure, b->figure) == 0;
}

static uint64_t hash_text(uint64_t hash, const char *text) {
    for (; *text; text++) hash = brunt_hash_add(hash, (uint64_t)(unsigned char)*text);
    return brunt_hash_add(hash, 0);
}

// Where the row stands that has this figure, or could.
static int32_t *place_of(const reader *r, const brunt_machine_row *row) {
    const uint64_t hash = hash_text(hash_text(hash_text((uint64_t)row->threads, row->kind), row->name), row->figure);
    size_t at = brunt_hash_add(hash, (uint64_t)(int64_t)fmin(row->units, 1e18)) & (r->places - 1);
    while (r->place[at] && !same_figure(&r->machine->rows[r->place[at] - 1], row)) at = (at + 1) & (r->places - 1);
    return &r->place[at];
}

// Makes space for one more row.
static bool fits_another(reader *r) {
    const size_t used = (size_t)r->machine->row_count;
    if (BRUNT_RESERVE_IN(r->machine->rows, r->capacity, used + 1, used)) return false;
    if (r->places > 2 * (used + 1)) return true;
    enum { FIRST = 1024 };
    const size_t places = r->places ? 2 * r->places : FIRST;
    int32_t *place = brunt_alloc(places * sizeof *place);
    if (!place) return false;
    brunt_free(r->place);
    r->place = place, r->places = places;
    for (size_t k = 0; k < used; k++) *place_of(r, &r->machine->rows[k]) = (int32_t)k + 1;
    return true;
}

static int read_row(reader *r, char *text) {
    char *field[FIELDS], *rest = text;
    int count = 0;
    while (rest) {
        char *part = strsep(&rest, ",");
        if (count < FIELDS) field[count] = part;
        count++;
    }
    if (count != FIELDS)
        return brunt_fail(r->error, BRUNT_BAD_INPUT, "%.500s:%d: %d fields instead of %d", r->machine->path, r->line,
                          count, FIELDS);
    brunt_machine_row row = {.threads = 0};
    int status = read_text(r, "kind", field[0], row.kind, sizeof row.kind);
    if (!status) status = read_text(r, "name", field[1], row.name, sizeof row.name);
    if (!status) status = read_number(r, "units", field[2], 0, &row.units);
    if (!status) status = read_count(r, "threads", field[3], &row.threads);
    if (!status) status = read_text(r, "figure", field[4], row.figure, sizeof row.figure);
    if (!status) status = read_text(r, "unit", field[5], row.unit, sizeof row.unit);
    if (!status) status = read_number(r, "median", field[6], 0, &row.median);
    if (!status) status = read_number(r, "least", field[7], 0, &row.least);
    if (!status) status = read_count(r, "rounds", field[8], &row.rounds);
    if (status) return status;
    if (!fits_another(r))
        return brunt_fail(r->error, BRUNT_FAILED, "out of memory while reading %.500s", r->machine->path);
    int32_t *place = place_of(r, &row);
    if (*place) return bad(r, "a figure for the second time:", row.name);
    r->machine->rows[r->machine->row_count++] = row;
    *place = r->machine->row_count;
    return BRUNT_OK;
}

// What follows the key in a line "# key: value"; NULL: it is not that line.
static const char *value_of(const char *text, const char *key) {
    const size_t length = strlen(key);
    return strncmp(text, key, length) == 0 ? text + length + strspn(text + length, " ") : NULL;
}

static int read_line(reader *r, char *text) {
    text[strcspn(text, "\r\n")] = 0;
    const char *processor = value_of(text, "# processor:"), *width = value_of(text, "# lanes:");
    if (processor) snprintf(r->machine->processor, sizeof r->machine->processor, "%.127s", processor);
    if (width) {
        const int status = read_count(r, "lanes", width, &r->machine->lanes);
        if (status) return status;
    }
    if (!*text || *text == '#') return BRUNT_OK;
    if (r->has_header) return read_row(r, text);
    if (strcmp(text, header) != 0)
        return brunt_fail(r->error, BRUNT_BAD_INPUT, "%.500s:%d: the line '%s' is missing: no benchmark of a machine",
                          r->machine->path, r->line, header);
    r->has_header = true;
    return BRUNT_OK;
}

static int read_file(brunt_machine *machine, brunt_error *error) {
    reader r = {.machine = machine, .error = error};
    const char *why;
    FILE *in = brunt_input_open(machine->path, &why);
    char *text = NULL;
    size_t size = 0;
    int status = BRUNT_OK;
    if (!in) return brunt_fail(error, BRUNT_IO_ERROR, "%.500s cannot be read: %s", machine->path, why);
    for (ssize_t length; !status && (length = getline(&text, &size, in)) >= 0;) {
        r.line++;
        status = strlen(text) == (size_t)length ? read_line(&r, text) : bad(&r, "a zero byte behind", "");
    }
    if (!status && ferror(in))
        status = brunt_fail(error, BRUNT_IO_ERROR, "%.500s cannot be read: %s", machine->path, strerror(errno));
    if (!status && !machine->row_count) status = bad(&r, "no figures up to the end of", "the file");
    free(text);
    fclose(in);
    brunt_free(r.place);
    return status;
}

int brunt_machine_load(brunt_machine *machine, brunt_error *error) {
    *machine = (brunt_machine){.row_count = 0};
    const char *named = getenv("BRUNT_MACHINE");
    if (named && *named) {
        if (strlen(named) >= sizeof machine->path)
            return brunt_fail(error, BRUNT_BAD_INPUT, "BRUNT_MACHINE is longer than %zu characters",
                              sizeof machine->path - 1);
        snprintf(machine->path, sizeof machine->path, "%s", named);
    } else if (!find_stored(machine->path, sizeof machine->path)) {
        machine->path[0] = 0;
        return BRUNT_OK;
    }
    int status = read_file(machine, error);
    // Processors of one name differ in the width of their registers, and by that in the speed of every kernel.
    const bool others = !(named && *named) && machine->lanes && machine->lanes != BRUNT_LANES;
    if (status || others) brunt_machine_free(machine);
    return status;
}

void brunt_machine_free(brunt_machine *machine) {
    brunt_free(machine->rows);
    *machine = (brunt_machine){.row_count = 0};
}

// ------------------------------------------------------------------------------------------ figures

static bool is_of(const brunt_machine_row *row, const char *kind, const char *name, const char *figure) {
    return strcmp(row->kind, kind) == 0 && strcmp(row->name, name) == 0 && strcmp(row->figure, figure) == 0;
}

// Of numbers of threads equally far away the smaller: it promises less. 0: there is no such figure.
static int32_t nearest_threads(const brunt_machine *machine, const char *kind, const char *name, const char *figure,
                               int32_t threads) {
    int32_t best = 0;
    for (int32_t k = 0; k < machine->row_count; k++) {
        const int32_t have = machine->rows[k].threads, off = abs(have - threads), least = abs(best - threads);
        if (!is_of(&machine->rows[k], kind, name, figure)) continue;
        if (!best || off < least || (off == least && have < best)) best = have;
    }
    return best;
}

double brunt_machine_figure(const brunt_machine *machine, const char *kind, const char *name, const char *figure,
                            double units, int32_t threads) {
    const int32_t of = nearest_threads(machine, kind, name, figure, threads);
    const brunt_machine_row *below = NULL, *above = NULL;
    for (int32_t k = 0; k < machine->row_count; k++) {
        const brunt_machine_row *row = &machine->rows[k];
        if (row->threads != of || !is_of(row, kind, name, figure)) continue;
        if (row->units <= units && (!below || row->units > below->units)) below = row;
        if (row->units >= units && (!above || row->units < above->units)) above = row;
    }
    if (!below || !above) return below ? below->median : above ? above->median : NAN;
    if (!(above->units > below->units) || !(below->units > 0)) return above->median;
    const double share = log(units / below->units) / log(above->units / below->units);
    return below->median + share * (above->median - below->median);
}

// ------------------------------------------------------------------------------------------ what a step costs by it

// Over sizes where that is stored, at one size elsewhere.
static double cost_of(const brunt_machine *machine, const char *kind, const char *name, double units, int32_t threads) {
    const double growing = brunt_machine_figure(machine, "growth", name, "step", units, threads);
    return 1e-9 * units *
           (isnan(growing) ? brunt_machine_figure(machine, kind, name, "step", units, threads) : growing);
}

double brunt_machine_step(const brunt_machine *machine, const brunt_world_def *def, const brunt_world *world) {
    static const char *const kernels[] = {"", "linear", "quadratic", "cubic"}, *const transfers[] = {"pic", "flip",
                                                                                                     "apic"};
    _Static_assert(BRUNT_COUNT(kernels) == BRUNT_CUBIC + 1 && BRUNT_COUNT(transfers) == BRUNT_APIC + 1,
                   "a word for each");
    const int32_t threads = brunt_world_threads(world);
    double seconds = 0;
    for (int32_t b = 0; b < brunt_body_count(world); b++) {
        char name[96];
        if (brunt_body_method(world, b) == BRUNT_MPM) {
            snprintf(name, sizeof name, "%dd %s %s neo-hookean", def->dimension, kernels[def->kernel],
                     transfers[def->transfer]);
            seconds += cost_of(machine, "particles", name, (double)brunt_body_particles(world, b), threads);
        } else {
            snprintf(name, sizeof name, "%s%s", def->axisymmetric ? "axisymmetric-" : "",
                     brunt_element_name(brunt_body_element(world, b)));
            seconds += cost_of(machine, "elements", name, (double)brunt_body_elements(world, b), threads);
        }
    }
    return seconds;
}
