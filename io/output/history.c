#include "io/output/history_lines.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/file/atomic_file.h"
#include "base/error.h"
#include "base/array.h"
#include "base/memory.h"
#include "io/output/parts.h"
#include "io/output/positions.h"
#include "io/scene/crowd.h"
#include "io/scene/history_columns.h"

// ---------------------------------------------------------------------------------------------------- columns

static void add(brunt_history *h, const char *name, const char *unit, double value) {
    if (h->declaring) {
        const size_t used = (size_t)h->column_count;
        if (BRUNT_RESERVE(h->columns, used + 1, used)) {
            h->out_of_memory = true;
            return;
        }
        column *c = &h->columns[h->column_count++];
        memset(c, 0, sizeof *c);
        const history_column *means = brunt_column_meaning(name);
        if (!means || (means->unit && !strstr(means->unit, unit))) h->unknown = h->column_count;
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

// Force number k and its impulse.
static void add_force(brunt_history *h, const char *prefix, int32_t k, const brunt_reaction *force) {
    double mean[3] = {0, 0, 0};
    if (!h->declaring && h->rows > 0) brunt_history_mean_force(h, k, force->impulse, mean);
    char name[COLUMN_NAME];
    snprintf(name, sizeof name, "%s.%s.force", prefix, force->name);
    add_vector(h, name, "N", mean);
    add(h, name, "N", sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]));
    snprintf(name, sizeof name, "%s.%s.impulse", prefix, force->name);
    if (h->declaring) h->forces[k].impulse = h->column_count;
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

static void add_tool(brunt_history *h, const brunt_boundary_surface_report *now) {
    char name[COLUMN_NAME];
    snprintf(name, sizeof name, "wall.%s.position", now->name);
    add_vector(h, name, "m", now->position);
    snprintf(name, sizeof name, "wall.%s.velocity", now->name);
    add_vector(h, name, "m/s", now->velocity);
    snprintf(name, sizeof name, "wall.%s.spin", now->name);
    add_vector(h, name, "rad/s", now->spin);
    add_named(h, "J", now->kinetic, "wall.%s.kinetic", now->name);
    add_named(h, "J", now->gravity_work, "wall.%s.gravity_work", now->name);
}

// Beside the force, which it has as every boundary: of the last step.
static void add_surface(brunt_history *h, const brunt_world *world, int32_t index) {
    brunt_boundary_surface_report now;
    char name[COLUMN_NAME];
    brunt_boundary_surface_read(world, index, &now);
    snprintf(name, sizeof name, "wall.%s.moment", now.name);
    add_vector(h, name, "N m", now.moment);
    add_named(h, "J", now.work, "wall.%s.work", now.name);
    add_named(h, "m/s", now.drift, "wall.%s.drift", now.name);
    add_named(h, "1", now.active, "wall.%s.active", now.name);
    if (now.mass > 0) add_tool(h, &now);
}

static void add_energy(brunt_history *h, brunt_world *world) {
    brunt_energy e;
    brunt_world_energy(world, &e);
    add(h, "energy.kinetic", "J", e.kinetic);
    add(h, "energy.internal", "J", e.internal);
    add(h, "energy.mechanical", "J", e.mechanical);
    add(h, "energy.plastic", "J", e.plastic);
    add(h, "energy.hourglass", "J", e.hourglass);
    add(h, "energy.contact", "J", e.contact);
    add(h, "energy.contact_held", "J", e.contact_held);
    add(h, "energy.friction", "J", e.friction);
    add(h, "energy.viscosity", "J", e.viscosity);
    add(h, "energy.transfer", "J", e.transfer);
    add(h, "energy.eroded", "J", e.eroded);
    if (brunt_world_newton(world, NULL, NULL)) add(h, "energy.scheme", "J", e.scheme);
    add(h, "energy.heat", "J", e.heat);
    add(h, "energy.external_work", "J", e.external_work);
    add(h, "energy.initial", "J", e.initial);
    add(h, "energy.total", "J", e.total);
    add(h, "energy.error", "J", e.error);
    add(h, "energy.error_relative", "1", e.error_relative);
}

// Of the last step; no number where nothing is near.
static void add_newton(brunt_history *h, const brunt_world *world) {
    brunt_newton_counts last;
    if (!brunt_world_newton(world, NULL, &last)) return;
    add(h, "newton.iterations", "1", last.iterations);
    add(h, "newton.halvings", "1", last.halvings);
    add(h, "newton.linear_iterations", "1", last.linear_iterations);
    add(h, "newton.cuts", "1", last.cuts);
    add(h, "newton.residual", brunt_world_static(world) ? "1" : "m/s", last.residual);
    add(h, "newton.least_gap", "m", isfinite(last.least_gap) ? last.least_gap : NAN);
    add(h, "newton.least_part", "1", isfinite(last.least_part) ? last.least_part : NAN);
}

// What load steps leave of the forces on bodies.
static void add_balance(brunt_history *h, const brunt_world *world) {
    brunt_balance balance;
    if (!brunt_world_balance(world, &balance)) return;
    add(h, "balance.body", "1", balance.body);
    add(h, "balance.all", "1", balance.all);
}

// Of the bodies that push each other in load steps.
static void add_links(brunt_history *h, const brunt_world *world) {
    int32_t count;
    brunt_link_sums sums;
    if (!brunt_world_static(world) || !brunt_world_links(world, &count)) return;
    brunt_world_link_sums(world, &sums);
    add(h, "links.count", "1", sums.count);
    add(h, "links.mean", "N", sums.mean);
    add(h, "links.sd", "N", sums.sd);
    add(h, "links.greatest", "N", sums.greatest);
    add(h, "links.slipping", "1", sums.slipping);
}

// In load steps nothing has any.
static void add_momentum(brunt_history *h, brunt_world *world) {
    brunt_momentum m;
    if (brunt_world_static(world)) return;
    brunt_world_momentum(world, &m);
    add_vector(h, "momentum.linear", "kg m/s", m.linear);
    add_vector(h, "momentum.angular", "kg m^2/s", m.angular);
    add(h, "momentum.linear_drift", "1", m.linear_drift);
    add(h, "momentum.angular_drift", "1", m.angular_drift);
}

// Of bodies [first, end); those of which nothing is left have no place.
static void sum_bodies(brunt_world *world, int32_t first, int32_t end, brunt_body_sums *all) {
    brunt_body_totals(world, first, all);
    if (end == first + 1) return;
    *all = (brunt_body_sums){.low = {INFINITY, INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY, -INFINITY}};
    for (int32_t b = first; b < end; b++) {
        brunt_body_sums one;
        brunt_body_totals(world, b, &one);
        if (!(one.mass > 0)) continue;
        all->mass += one.mass;
        all->kinetic += one.kinetic, all->internal += one.internal, all->plastic += one.plastic;
        for (int c = 0; c < 3; c++) {
            all->centre[c] += one.mass * one.centre[c], all->velocity[c] += one.mass * one.velocity[c];
            all->low[c] = fmin(all->low[c], one.low[c]), all->high[c] = fmax(all->high[c], one.high[c]);
        }
    }
    for (int c = 0; c < 3 && all->mass > 0; c++) all->centre[c] /= all->mass, all->velocity[c] /= all->mass;
}

static void add_eroded(brunt_history *h, brunt_world *world, int32_t first, int32_t end, const char *name) {
    double pieces = 0, mass = 0;
    for (int32_t b = first; b < end; b++) {
        brunt_eroded eroded;
        brunt_body_eroded(world, b, &eroded);
        pieces += (double)(eroded.elements + eroded.particles), mass += eroded.mass;
    }
    add_named(h, "1", pieces, "body.%s.eroded", name);
    add_named(h, "kg", mass, "body.%s.eroded_mass", name);
}

// Bodies [first, end), under one name.
static void add_bodies(brunt_history *h, brunt_world *world, int32_t first, int32_t end, const char *body_name) {
    brunt_body_sums sums;
    sum_bodies(world, first, end, &sums);
    char name[COLUMN_NAME];
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
    if (brunt_effect_on(world, "erosion")) add_eroded(h, world, first, end, body_name);
}

// Each body, all members of a crowd as one, and those members that measures ask for.
static void add_parts(brunt_history *h, brunt_world *world) {
    for (int32_t b = 0, end; b < brunt_body_count(world); b = end) {
        char name[BRUNT_NAME_LENGTH];
        end = brunt_part_end(world, b);
        brunt_part_name(world, b, name);
        add_bodies(h, world, b, end, name);
    }
    for (int32_t m = 0; m < h->member_count; m++)
        add_bodies(h, world, h->members[m], h->members[m] + 1, brunt_body_name(world, h->members[m]));
}

// Where the probe's id is among those there are now, -1 when it has eroded. Uses the scratch.
static int64_t probe_place(brunt_history *h, brunt_world *world, const probe *p) {
    const int64_t count = brunt_body_size(world, p->body, p->info.at);
    const int32_t field = brunt_location_ids(world, p->body, p->info.at);
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
    return low < count && h->scratch[low] == (double)p->id ? low : BRUNT_NONE;
}

static void add_probe(brunt_history *h, brunt_world *world, const probe *p) {
    static const char *const names3[3] = {"x", "y", "z"}, *const names6[6] = {"xx", "yy", "zz", "xy", "yz", "xz"},
                             *const names9[9] = {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
    int n = p->info.components;
    const char *const *names = n == 3 ? names3 : n == 6 ? names6 : n == 9 ? names9 : NULL;
    const double *values = NULL;
    if (!h->declaring) {
        const size_t count = (size_t)n * (size_t)brunt_body_size(world, p->body, p->info.at);
        if (BRUNT_RESERVE(h->scratch, count, 0)) {
            h->out_of_memory = true;
            return;
        }
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
    add(h, "time", "s", brunt_world_time(world));
    add(h, "step", "1", (double)brunt_world_steps(world));
    add(h, "dt", "s", brunt_world_dt(world));
    add_energy(h, world);
    add_momentum(h, world);
    add_newton(h, world);
    add_balance(h, world);
    add_links(h, world);
    add_parts(h, world);
    const bool flat = brunt_world_dimension(world) == 2 && !brunt_effect_on(world, "axisymmetric");
    for (int32_t p = 0; p < brunt_pair_count(world); p++) {
        brunt_reaction force;
        brunt_pair_force(world, p, &force);
        add_force(h, "contact", p, &force);
        add_named(h, flat ? "m" : "m^2", force.area, "contact.%s.area", force.name);
    }
    for (int32_t w = 0; w < brunt_boundary_count(world); w++) {
        brunt_reaction force;
        brunt_boundary_reaction(world, w, &force);
        add_force(h, "wall", brunt_pair_count(world) + w, &force);
    }
    for (int32_t s = 0; s < brunt_boundary_surface_count(world); s++) add_surface(h, world, s);
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
    int status = brunt_positions_read(world, out->body, out->info.at, &places, error);
    if (status) return status;
    out->count = brunt_body_size(world, out->body, out->info.at);
    out->id = nearest_place(places, out->count, brunt_world_dimension(world), def->point);
    brunt_free(places);
    if (out->id < 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "output.probes.%s: body '%s' is empty", def->name, def->body);
    return BRUNT_OK;
}

static int compare_bodies(const void *a, const void *b) {
    const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

// Members of crowds that the columns of measures begin with, "body.grains.17.".
static void find_members(brunt_history *h, const brunt_world *world, const brunt_scene *scene) {
    int32_t found = 0;
    for (int32_t m = 0; m < scene->measure_count; m++) {
        char name[BRUNT_NAME_LENGTH];
        const char *from = scene->measures[m].column, *end = from + strlen(from);
        if (strncmp(from, "body.", 5) != 0) continue;
        while (end > from && *end != '.') end--;
        snprintf(name, sizeof name, "%.*s", (int)(end - from > 5 ? end - from - 5 : 0), from + 5);
        const int32_t body = brunt_crowd_of(name) ? brunt_find_body(world, name) : BRUNT_NONE;
        if (body >= 0) h->members[found++] = body;
    }
    qsort(h->members, (size_t)found, sizeof *h->members, compare_bodies);
    for (int32_t i = 0; i < found; i++)
        if (!i || h->members[i] != h->members[i - 1]) h->members[h->member_count++] = h->members[i];
}

static int name_columns(brunt_history *h, brunt_world *world, brunt_error *error) {
    h->declaring = true;
    traverse(h, world);
    h->declaring = false;
    if (h->unknown)
        return brunt_fail(error, BRUNT_FAILED, "column '%s' of the history is not in the table of columns, or its unit",
                          h->columns[h->unknown - 1].name);
    h->out_of_memory |= brunt_names_sort(&h->names, h->columns[0].name, sizeof *h->columns, h->column_count, NULL) != 0;
    return h->out_of_memory ? brunt_fail(error, BRUNT_FAILED, "out of memory") : BRUNT_OK;
}

brunt_history *brunt_history_create(brunt_world *world, const brunt_scene *scene, brunt_error *error) {
    brunt_history *h = brunt_alloc(sizeof *h);
    if (h) h->probes = brunt_alloc(sizeof *h->probes * (size_t)scene->output.probe_count);
    if (h) h->members = brunt_alloc(sizeof *h->members * (size_t)scene->measure_count);
    if (!h || !h->probes || !h->members) {
        if (h) brunt_free(h->probes), brunt_free(h->members);
        brunt_free(h);
        brunt_fail(error, BRUNT_FAILED, "out of memory");
        return NULL;
    }
    snprintf(h->title, sizeof h->title, "%s", scene->title);
    int status = BRUNT_OK;
    for (; h->probe_count < scene->output.probe_count && !status; h->probe_count++)
        status = find_probe(world, &scene->output.probes[h->probe_count], &h->probes[h->probe_count], error);
    find_members(h, world, scene);
    if (!status) status = brunt_history_find_forces(h, world, scene, error);
    if (!status) status = name_columns(h, world, error);
    if (!status) return h;
    brunt_history_destroy(h);
    return NULL;
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
    brunt_names_free(&history->names);
    brunt_free(history->lines);
    brunt_free(history->forces);
    brunt_free(history->past.line);
    brunt_free(history->probes);
    brunt_free(history->members);
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

// ---------------------------------------------------------------------------------------------------- sampling

static int keep_in_memory(brunt_history *h, brunt_error *error) {
    const size_t columns = (size_t)h->column_count, used = columns * (size_t)h->rows;
    if (BRUNT_RESERVE(h->lines, used + columns, used))
        return brunt_fail(error, BRUNT_FAILED, "out of memory after %lld history lines", (long long)h->rows);
    for (int32_t c = 0; c < h->column_count; c++) h->lines[h->column_count * h->rows + c] = h->columns[c].now;
    return BRUNT_OK;
}

static int append_to_file(brunt_history *h, brunt_error *error) {
    if (BRUNT_RESERVE(h->scratch, (size_t)h->column_count, 0))
        return brunt_fail(error, BRUNT_FAILED, "out of memory after %lld history lines", (long long)h->rows);
    for (int32_t c = 0; c < h->column_count; c++) h->scratch[c] = h->columns[c].now;
    brunt_history_print_line(h, h->scratch, h->csv);
    if (fflush(h->csv) || ferror(h->csv))
        return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot write the file: %s", h->csv_path, strerror(errno));
    return BRUNT_OK;
}

int brunt_history_sample(brunt_history *history, brunt_world *world, brunt_error *error) {
    brunt_world_measure(world);
    traverse(history, world);
    brunt_world_forget_measure(world);
    if (history->out_of_memory)
        return brunt_fail(error, BRUNT_FAILED, "out of memory after %lld history lines", (long long)history->rows);
    int status = history->csv ? append_to_file(history, error) : keep_in_memory(history, error);
    if (!status) status = brunt_history_keep_past(history, error);
    if (status) return status;
    for (int32_t c = 0; c < history->column_count; c++) {
        column *at = &history->columns[c];
        if (brunt_history_counts(at->name)) history->hash = brunt_history_hash_value(history->hash, at->now);
        at->last = at->now;
    }
    history->rows++;
    forget_columns(history);
    return BRUNT_OK;
}

int32_t brunt_history_find(const brunt_history *history, const char *name) {
    return brunt_names_find(&history->names, name, strlen(name));
}

// All lines of the columns that are `wanted`, whose memory is there, in one go over the file.
static int read_lines(const brunt_history *h, const bool *wanted, double *line, brunt_error *error) {
    line_reader r = {0};
    int status = brunt_history_open_lines(&r, h, brunt_history_lines_path(h), error);
    for (int64_t row = 0; row < h->rows && !status; row++) {
        status = brunt_history_next_line(&r, wanted, line, error);
        for (int32_t c = 0; c < h->column_count; c++)
            if (wanted[c]) h->columns[c].values[row] = line[c];
    }
    brunt_history_close_lines(&r);
    return status;
}

int brunt_history_fetch(const brunt_history *history, const char *const *names, int32_t count, brunt_error *error) {
    bool *wanted = brunt_alloc(sizeof *wanted * (size_t)history->column_count), any = false;
    double *line = brunt_alloc(sizeof *line * (size_t)history->column_count);
    int status = wanted && line ? BRUNT_OK : brunt_fail(error, BRUNT_FAILED, "out of memory for the history's columns");
    for (int32_t i = 0; i < count && !status; i++) {
        const int32_t c = brunt_history_find(history, names[i]);
        if (c < 0 || history->columns[c].values) continue;
        history->columns[c].values = brunt_alloc(sizeof(double) * (size_t)history->rows);
        wanted[c] = any = true;
        if (!history->columns[c].values)
            status = brunt_fail(error, BRUNT_FAILED, "out of memory for the history's column '%s'", names[i]);
    }
    if (!status && any) status = read_lines(history, wanted, line, error);
    for (int32_t c = 0; status && wanted && c < history->column_count; c++) {
        if (!wanted[c]) continue;
        brunt_free(history->columns[c].values);
        history->columns[c].values = NULL;
    }
    brunt_free(wanted), brunt_free(line);
    return status;
}

int brunt_history_read(const brunt_history *history, const char *name, const double **values, brunt_error *error) {
    const int32_t c = brunt_history_find(history, name);
    if (c < 0) return brunt_fail(error, BRUNT_BAD_INPUT, "the history has no column '%s'", name);
    const int status = brunt_history_fetch(history, &name, 1, error);
    if (!status) *values = history->columns[c].values;
    return status;
}

const double *brunt_history_column(const brunt_history *history, const char *name) {
    const double *values;
    return brunt_history_read(history, name, &values, NULL) ? NULL : values;
}

// ---------------------------------------------------------------------------------------------------- files

int brunt_history_resume(brunt_history *history, const char *path, int64_t lines, uint64_t hash, brunt_error *error) {
    double *line = brunt_alloc(sizeof *line * (size_t)history->column_count);
    line_reader r = {0};
    int status = line ? brunt_history_open_lines(&r, history, path, error)
                      : brunt_fail(error, BRUNT_FAILED, "out of memory while reading %s", path);
    history->past.count = history->past.old = 0;
    for (int64_t row = 0; row < lines && !status; row++) {
        status = brunt_history_next_line(&r, NULL, line, error);
        for (int32_t c = 0; c < history->column_count && !status; c++) history->columns[c].now = line[c];
        if (!status) status = brunt_history_keep_past(history, error);
    }
    if (!status && r.hash != hash)
        status =
            brunt_fail(error, BRUNT_BAD_INPUT,
                       "%s: its first %lld lines are not those of the checkpoint: of another run, or changed since",
                       path, (long long)lines);
    for (int32_t c = 0; c < history->column_count && !status && lines; c++) history->columns[c].last = line[c];
    if (!status) history->rows = lines, history->hash = hash, history->resumed = true;
    if (status) history->past.count = history->past.old = 0;
    brunt_history_close_lines(&r);
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
    int status = line ? brunt_history_open_lines(&r, h, h->resumed ? path : NULL, error)
                      : brunt_fail(error, BRUNT_FAILED, "out of memory while writing %s", path);
    for (int64_t row = 0; row < h->rows && !status; row++) {
        status = brunt_history_next_line(&r, NULL, line, error);
        if (!status) brunt_history_print_line(h, line, out);
    }
    brunt_history_close_lines(&r);
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
    if (!history->csv || !brunt_sync_data(fileno(history->csv), false)) return BRUNT_OK;
    return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot write the file: %s", history->csv_path, strerror(errno));
}

double brunt_history_line_bytes(const brunt_history *history) {
    double bytes = 8 * (double)history->column_count; // history.h5
    for (int32_t c = 0; c < history->column_count; c++)
        bytes += 1 + snprintf(NULL, 0, "%.17g", history->columns[c].last);
    return bytes;
}
