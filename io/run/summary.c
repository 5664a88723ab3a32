#include "io/run/summary.h"

#include <jansson.h>
#include <math.h>
#include <string.h>
#include <sys/resource.h>

#include "io/file/atomic_file.h"
#include "base/error.h"

double brunt_summary_peak(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * (double)usage.ru_maxrss;
}

// JSON knows no infinity and no NAN.
static json_t *number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

static json_t *vector(const double v[3]) {
    json_t *array = json_array();
    for (int c = 0; c < 3; c++) json_array_append_new(array, number(v[c]));
    return array;
}

// A rate of something there is none of is no number.
static json_t *rate(double of, double per) { return of > 0 && per > 0 ? number(of / per) : json_null(); }

static json_t *phases_of(const brunt_summary *summary, const brunt_world *world) {
    json_t *phases = json_object();
    for (int32_t p = 0; p < brunt_pass_count(world); p++) {
        brunt_pass pass = brunt_world_pass(world, p);
        json_object_set_new(phases, pass.name, number(pass.seconds));
    }
    json_object_set_new(phases, "output", number(summary->output_seconds));
    return phases;
}

static json_t *effects_of(const brunt_world *world) {
    json_t *effects = json_object();
    for (int32_t e = 0; e < brunt_effect_count(world); e++) {
        brunt_effect effect = brunt_world_effect(world, e);
        json_object_set_new(effects, effect.name, json_boolean(effect.on));
    }
    return effects;
}

static json_t *energy_of(brunt_world *world) {
    brunt_energy e;
    brunt_world_energy(world, &e);
    const struct {
        const char *name;
        double value;
    } rows[] = {{"initial", e.initial},
                {"final", e.total},
                {"kinetic", e.kinetic},
                {"internal", e.internal},
                {"plastic", e.plastic},
                {"hourglass", e.hourglass},
                {"contact", e.contact},
                {"friction", e.friction},
                {"viscosity", e.viscosity},
                {"transfer", e.transfer},
                {"eroded", e.eroded},
                {"heat", e.heat},
                {"external_work", e.external_work},
                {"reference", e.reference},
                {"error_relative", e.error_relative}};
    json_t *energy = json_object();
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
        json_object_set_new(energy, rows[r].name, number(rows[r].value));
    if (brunt_world_newton(world, NULL, NULL)) json_object_set_new(energy, "scheme", number(e.scheme));
    return energy;
}

// What left each body that has lost something.
static json_t *eroded_of(brunt_world *world) {
    json_t *bodies = json_object();
    for (int32_t b = 0; b < brunt_body_count(world); b++) {
        brunt_eroded e;
        brunt_body_eroded(world, b, &e);
        if (!e.elements && !e.particles && !e.nodes) continue;
        const struct {
            const char *name;
            int64_t count;
        } counts[] = {{"elements", e.elements}, {"particles", e.particles}, {"nodes", e.nodes},
                      {"failed", e.failed},     {"strained", e.strained},   {"short_step", e.short_step},
                      {"inverted", e.inverted}};
        json_t *entry = json_object();
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
            json_object_set_new(entry, counts[c].name, json_integer(counts[c].count));
        json_object_set_new(entry, "mass", number(e.mass));
        json_object_set_new(entry, "momentum", vector(e.momentum));
        json_object_set_new(entry, "energy", number(e.energy));
        json_object_set_new(bodies, brunt_body_name(world, b), entry);
    }
    return bodies;
}

// Whether mass scaling has made elements of a body denser, and what of it.
static bool is_scaled(const brunt_world *world, int32_t body, brunt_mesh_report *report) {
    if (brunt_body_method(world, body) == BRUNT_MPM) return false;
    brunt_body_mesh(world, body, report);
    return report->scaled_elements > 0;
}

// [kg] that it has added to each body that has it.
static json_t *added_mass_of(const brunt_world *world) {
    json_t *bodies = json_object();
    for (int32_t b = 0; b < brunt_body_count(world); b++) {
        brunt_mesh_report report = {.scaled_elements = 0};
        if (brunt_body_method(world, b) != BRUNT_MPM) brunt_body_mesh(world, b, &report);
        if (report.scaled_elements) json_object_set_new(bodies, brunt_body_name(world, b), number(report.added_mass));
    }
    return bodies;
}

static json_t *momentum_of(brunt_world *world) {
    brunt_momentum m;
    brunt_world_momentum(world, &m);
    json_t *momentum = json_object();
    json_object_set_new(momentum, "linear_initial", vector(m.linear_initial));
    json_object_set_new(momentum, "linear_final", vector(m.linear));
    json_object_set_new(momentum, "linear_drift", number(m.linear_drift));
    json_object_set_new(momentum, "angular_initial", vector(m.angular_initial));
    json_object_set_new(momentum, "angular_final", vector(m.angular));
    json_object_set_new(momentum, "angular_drift", number(m.angular_drift));
    return momentum;
}

// Of load steps with contact, NULL of others.
static json_t *links_of(const brunt_world *world) {
    int32_t count;
    brunt_link_sums s;
    if (!brunt_world_static(world) || !brunt_world_links(world, &count)) return NULL;
    brunt_world_link_sums(world, &s);
    json_t *links = json_object();
    json_object_set_new(links, "count", json_integer((json_int_t)s.count));
    json_object_set_new(links, "mean", number(s.mean));
    json_object_set_new(links, "sd", number(s.sd));
    json_object_set_new(links, "greatest", number(s.greatest));
    json_object_set_new(links, "slipping", json_integer((json_int_t)s.slipping));
    return links;
}

// Of load steps, NULL of others.
static json_t *balance_of(const brunt_world *world) {
    brunt_balance b;
    if (!brunt_world_balance(world, &b)) return NULL;
    json_t *balance = json_object();
    json_object_set_new(balance, "body", number(b.body));
    json_object_set_new(balance, "all", number(b.all));
    if (b.worst >= 0) json_object_set_new(balance, "worst", json_string(brunt_body_name(world, b.worst)));
    return balance;
}

// [Pa/m] Least and greatest of what may overlap, NULL where nothing does.
static json_t *penalty_of(const brunt_world *world) {
    brunt_barrier_values v;
    if (!brunt_world_barrier(world, &v) || !(v.penalty[1] > 0)) return NULL;
    return json_pack("{s:o, s:o, s:o}", "least", number(v.penalty[0]), "greatest", number(v.penalty[1]), "a",
                     number(v.width));
}

// Of implicit steps, NULL of others.
static json_t *newton_of(const brunt_world *world) {
    brunt_newton_counts n;
    if (!brunt_world_newton(world, &n, NULL)) return NULL;
    const struct {
        const char *name;
        double count;
    } rows[] = {{"steps", n.steps},
                {"iterations", n.iterations},
                {"iterations_worst", n.iterations_worst},
                {"halvings", n.halvings},
                {"projections", n.projections},
                {"linear_iterations", n.linear_iterations},
                {"factorisations", n.factorisations},
                {"cuts", n.cuts}};
    json_t *newton = json_object();
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
        json_object_set_new(newton, rows[r].name, json_integer((json_int_t)rows[r].count));
    json_object_set_new(newton, "residual", number(n.residual));
    return newton;
}

static void set_tool(json_t *entry, const brunt_boundary_surface_report *now) {
    json_object_set_new(entry, "mass", number(now->mass));
    json_object_set_new(entry, "position", vector(now->position));
    json_object_set_new(entry, "velocity", vector(now->velocity));
    json_object_set_new(entry, "spin", vector(now->spin));
    json_object_set_new(entry, "angular_momentum", vector(now->angular_momentum));
    json_object_set_new(entry, "kinetic", number(now->kinetic));
    json_object_set_new(entry, "gravity_work", number(now->gravity_work));
}

// Lines and surfaces that hold material points, NULL where there are none.
static json_t *boundaries_of(const brunt_world *world) {
    if (!brunt_boundary_surface_count(world)) return NULL;
    json_t *all = json_object();
    for (int32_t s = 0; s < brunt_boundary_surface_count(world); s++) {
        brunt_boundary_surface_report now;
        brunt_boundary_surface_read(world, s, &now);
        json_t *entry = json_object();
        json_object_set_new(entry, "force", vector(now.force));
        json_object_set_new(entry, "moment", vector(now.moment));
        json_object_set_new(entry, "impulse", vector(now.impulse));
        json_object_set_new(entry, "work", number(now.work));
        json_object_set_new(entry, "drift", number(now.drift));
        json_object_set_new(entry, "pieces", json_integer(now.pieces));
        json_object_set_new(entry, "active", json_integer(now.active));
        if (now.mass > 0) set_tool(entry, &now);
        json_object_set_new(all, now.name, entry);
    }
    return all;
}

static void set_newton(json_t *object, const brunt_world *world) {
    brunt_newton_counts n;
    if (!brunt_world_newton(world, &n, NULL)) return;
    json_object_set_new(object, "newton", newton_of(world));
    json_object_set_new(object, "balance", balance_of(world));
    json_object_set_new(object, "links", links_of(world));
    json_object_set_new(object, "least_gap", number(n.least_gap));
    json_t *penalty = penalty_of(world);
    if (penalty) json_object_set_new(object, "penalty", penalty);
}

static json_t *measures_of(const brunt_summary *summary, const brunt_scene *scene) {
    json_t *measures = json_object();
    for (int32_t i = 0; i < scene->measure_count; i++) {
        const brunt_measure *m = &scene->measures[i];
        const brunt_measure_result *r = summary->results ? &summary->results[i] : NULL;
        json_t *entry = json_object();
        json_object_set_new(entry, "value", number(r ? r->value : NAN));
        json_object_set_new(entry, "unit", json_string(m->unit));
        json_object_set_new(entry, "expect", number(m->expect));
        json_object_set_new(entry, "error", number(r ? r->error : NAN));
        // Neither true nor false where nothing is expected.
        json_object_set_new(entry, "ok", r && r->judged ? json_boolean(r->ok) : json_null());
        json_object_set_new(measures, m->name, entry);
    }
    return measures;
}

static void set_text(json_t *object, const char *key, const char *text) {
    json_t *value = json_string(text);
    // Text that is not UTF-8 (a file name may be anything) is refused by jansson.
    json_object_set_new(object, key, value ? value : json_string("(not UTF-8)"));
}

static json_t *summary_object(const brunt_summary *s, const brunt_scene *scene, brunt_world *world) {
    double steps = (double)brunt_world_steps(world), particle_steps = steps * (double)brunt_world_particles(world),
           element_steps = steps * (double)brunt_world_elements(world);
    char hash[24];
    snprintf(hash, sizeof hash, "0x%016llx", (unsigned long long)s->state_hash);
    json_t *o = json_object();
    set_text(o, "scene", scene->name);
    json_object_set_new(o, "version", json_string(BRUNT_VERSION));
    json_object_set_new(o, "status", json_string(s->status));
    set_text(o, "reason", s->reason);
    json_object_set_new(o, "dimension", json_integer(brunt_world_dimension(world)));
    json_object_set_new(o, "threads", json_integer(brunt_world_threads(world)));
    json_object_set_new(o, "steps", json_integer(brunt_world_steps(world)));
    json_object_set_new(o, "time", number(brunt_world_time(world)));
    json_object_set_new(o, "wall_s", number(s->wall_seconds));
    json_object_set_new(o, "cpu_s", number(s->cpu_seconds));
    json_object_set_new(o, "step_s", number(s->step_seconds));
    json_object_set_new(o, "peak_rss_bytes", json_integer((json_int_t)s->peak_bytes));
    json_object_set_new(o, "particles", json_integer(brunt_world_particles(world)));
    json_object_set_new(o, "nodes", json_integer(brunt_world_nodes(world)));
    json_object_set_new(o, "elements", json_integer(brunt_world_elements(world)));
    json_object_set_new(o, "particle_steps_per_s", rate(particle_steps, s->step_seconds));
    json_object_set_new(o, "element_steps_per_s", rate(element_steps, s->step_seconds));
    json_object_set_new(o, "ns_per_particle_step", rate(1e9 * s->step_seconds, particle_steps));
    json_object_set_new(o, "ns_per_element_step", rate(1e9 * s->step_seconds, element_steps));
    json_object_set_new(o, "dt_min", number(brunt_world_dt_min(world)));
    json_object_set_new(o, "dt_max", number(brunt_world_dt_max(world)));
    json_object_set_new(o, "state_hash", json_string(hash));
    json_object_set_new(o, "phases", phases_of(s, world));
    json_object_set_new(o, "effects", effects_of(world));
    json_object_set_new(o, "energy", energy_of(world));
    if (!brunt_world_static(world)) json_object_set_new(o, "momentum", momentum_of(world));
    json_object_set_new(o, "eroded", eroded_of(world));
    json_object_set_new(o, "added_mass", added_mass_of(world));
    set_newton(o, world);
    json_t *boundaries = boundaries_of(world);
    if (boundaries) json_object_set_new(o, "boundaries", boundaries);
    json_object_set_new(o, "measures", measures_of(s, scene));
    if (s->profile) json_object_set_new(o, "profile", brunt_profile_json(s->profile));
    return o;
}

int brunt_summary_write(const char *path, const brunt_summary *summary, const brunt_scene *scene, brunt_world *world,
                        brunt_error *error) {
    json_t *object = summary_object(summary, scene, world);
    char *text = json_dumps(object, JSON_INDENT(2) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(17));
    json_decref(object);
    if (!text) return brunt_fail(error, BRUNT_FAILED, "out of memory while writing %s", path);
    brunt_atomic_file file;
    int status = brunt_atomic_open(&file, path, error);
    if (!status) {
        fputs(text, file.stream);
        fputc('\n', file.stream);
        status = brunt_atomic_commit(&file, error);
    }
    void (*release)(void *);
    json_get_alloc_funcs(NULL, &release);
    release(text);
    return status;
}

void brunt_summary_status(const char *path, char status[16]) {
    json_t *object = json_load_file(path, 0, NULL);
    const char *text = json_string_value(json_object_get(object, "status"));
    snprintf(status, 16, "%s", text ? text : "");
    json_decref(object);
}

static void print_energy(brunt_world *world, brunt_console *console) {
    brunt_energy e;
    brunt_world_energy(world, &e);
    const struct {
        const char *name;
        double value;
    } rows[] = {{"initial", e.initial},     {"external work", e.external_work},
                {"kinetic", e.kinetic},     {"internal", e.internal},
                {"plastic", e.plastic},     {"hourglass", e.hourglass},
                {"contact", e.contact},     {"friction", e.friction},
                {"viscosity", e.viscosity}, {"transfer", e.transfer},
                {"eroded", e.eroded},       {"scheme", e.scheme},
                {"error", e.error},         {"of plastic, heat", e.heat}};
    brunt_console_print(console, "energy [J]\n");
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
        // Rows of effects the scene does not have are no more than noise; the four that always matter are always there.
        if (rows[r].value != 0 || r < 4) brunt_console_print(console, "  %-15s %16.8g\n", rows[r].name, rows[r].value);
    brunt_console_print(console, "  %-15s %16.3g %% of %.4g J\n", "error, relative", 100 * e.error_relative,
                        e.reference);
}

static void print_eroded(brunt_world *world, brunt_console *console) {
    for (int32_t b = 0; b < brunt_body_count(world); b++) {
        brunt_eroded e;
        brunt_body_eroded(world, b, &e);
        if (!e.elements && !e.particles && !e.nodes) continue;
        brunt_console_print(
            console, "eroded of %s: %lld %s (failed %lld, strained %lld, short of step %lld, inverted %lld)",
            brunt_body_name(world, b), (long long)(e.elements + e.particles), e.elements ? "elements" : "points",
            (long long)e.failed, (long long)e.strained, (long long)e.short_step, (long long)e.inverted);
        if (e.nodes) brunt_console_print(console, ", %lld nodes", (long long)e.nodes);
        brunt_console_print(console, "; %.4g kg and %.4g J left\n", e.mass, e.energy);
    }
}

static void print_added_mass(brunt_world *world, brunt_console *console) {
    for (int32_t b = 0; b < brunt_body_count(world); b++) {
        brunt_mesh_report report;
        brunt_body_sums sums;
        if (!is_scaled(world, b, &report)) continue;
        brunt_body_totals(world, b, &sums);
        brunt_console_print(console, "mass scaling of %s: %lld elements made denser, %.4g kg added, of %.4g kg now\n",
                            brunt_body_name(world, b), (long long)report.scaled_elements, report.added_mass, sums.mass);
    }
}

// Where a share of the energy says that bodies may have moved in another way than they would.
static void print_notes(brunt_world *world, brunt_console *console) {
    static const double hourglass = 0.1, contact = 0.03; // [-] of what bodies store, and flow has taken
    brunt_energy e;
    brunt_world_energy(world, &e);
    const double taken = e.internal + e.plastic, least = 1e-3 * e.reference;
    if (e.hourglass > fmax(hourglass * taken, least))
        brunt_console_print(console,
                            "note: hourglass modes have %.3g %% of what is stored and flow has taken, more than %.3g "
                            "%%: smaller elements, or hourglass.form: stiffness, let them have less\n",
                            100 * e.hourglass / taken, 100 * hourglass);
    if (brunt_world_newton(world, &(brunt_newton_counts){0}, NULL) && e.contact > fmax(contact * taken, least))
        brunt_console_print(console,
                            "note: what pushes surfaces apart has stored %.3g %% of what bodies have, more than %.3g "
                            "%%: with a smaller contact.distance, or a greater contact.penalty, they come nearer\n",
                            100 * e.contact / taken, 100 * contact);
}

static void print_links(brunt_world *world, brunt_console *console) {
    int32_t count;
    brunt_link_sums s;
    if (!brunt_world_static(world) || !brunt_world_links(world, &count)) return;
    brunt_world_link_sums(world, &s);
    brunt_console_print(console,
                        "links: %.0f bodies push each other, mean %.6g, spread %.4g, greatest %.6g %s, %.0f slip\n",
                        s.count, s.mean, s.sd, s.greatest, brunt_world_dimension(world) == 2 ? "N/m" : "N", s.slipping);
}

static void print_balance(brunt_world *world, brunt_console *console) {
    brunt_balance b;
    if (!brunt_world_balance(world, &b) || b.worst < 0) return;
    brunt_console_print(console, "balance: forces on %s leave %.3g of them, those on all bodies %.3g\n",
                        brunt_body_name(world, b.worst), b.body, b.all);
}

// How near surfaces came, or how deep into each other, and what pushes them apart there.
static void print_gap(brunt_world *world, const brunt_newton_counts *n, brunt_console *console) {
    brunt_barrier_values v;
    const bool overlaps = brunt_world_barrier(world, &v) && v.penalty[1] > 0;
    brunt_console_print(console, "least gap %.4g m, %.3g of %s\n", n->least_gap, n->least_part,
                        !overlaps            ? "contact.distance"
                        : v.stiffness[1] > 0 ? "contact.distance, or of the way that surfaces may overlap by"
                                             : "the way that surfaces may overlap by is left");
    if (!overlaps) return;
    brunt_console_print(console, "contact.penalty %.4g to %.4g Pa/m", v.penalty[0], v.penalty[1]);
    if (v.width > 0)
        brunt_console_print(console, ": 20 E* / a, a %.4g m, %s", v.width,
                            v.seen ? "half the mean length of contacts" : "the shortest edge");
    brunt_console_print(console, "\n");
}

static void print_newton(brunt_world *world, brunt_console *console) {
    brunt_newton_counts n;
    if (!brunt_world_newton(world, &n, NULL)) return;
    const bool still = brunt_world_static(world);
    brunt_console_print(console,
                        "newton: %.0f iterations in %.0f steps (%.1f each, at most %.0f), %.0f halvings, %.0f "
                        "projections, %.0f steps cut, %s up to %.3g%s\n",
                        n.iterations, n.steps, n.iterations / fmax(n.steps, 1), n.iterations_worst, n.halvings,
                        n.projections, n.cuts, still ? "forces unbalanced" : "last corrections", n.residual,
                        still ? " of those that act" : " m/s");
    brunt_console_print(console, "linear systems: %.0f factorised, %.0f iterations\n", n.factorisations,
                        n.linear_iterations);
    if (isfinite(n.least_gap)) print_gap(world, &n, console);
}

static void print_measures(const brunt_summary *summary, const brunt_scene *scene, brunt_console *console) {
    if (!scene->measure_count || !summary->results) return;
    brunt_console_print(console, "measures\n");
    for (int32_t i = 0; i < scene->measure_count; i++) {
        const brunt_measure *m = &scene->measures[i];
        const brunt_measure_result *r = &summary->results[i];
        if (m->absent) {
            brunt_console_print(console, "  %-28s   not measured\n", m->name);
            continue;
        }
        if (isnan(r->value)) {
            brunt_console_print(console, "  %-28s   no value, there is nothing to take it from%s\n", m->name,
                                r->judged ? "  FAIL" : "");
            continue;
        }
        brunt_console_print(console, "  %-28s %14.7g %-8s", m->name, r->value, m->unit);
        if (!isnan(m->expect))
            brunt_console_print(console, "  expected %.7g, off by %.3g%s", m->expect,
                                m->absolute || m->expect == 0 ? r->error : 100 * r->error,
                                m->absolute || m->expect == 0 ? "" : " %");
        if (r->judged) brunt_console_print(console, "  %s", r->ok ? "ok" : "FAIL");
        brunt_console_print(console, "%s%s%s\n", m->source[0] ? "  (" : "", m->source, m->source[0] ? ")" : "");
    }
}

static void print_rate(brunt_console *console, double count, double steps, double seconds, const char *what) {
    if (count > 0 && steps > 0 && seconds > 0)
        brunt_console_print(console, "%.4g %s-steps/s, %.1f ns per %s-step\n", count * steps / seconds, what,
                            1e9 * seconds / (count * steps), what);
}

static void print_momentum(brunt_world *world, brunt_console *console) {
    brunt_momentum m;
    if (brunt_world_static(world)) return; // nothing has any: the balance of forces is what says how well it is solved
    brunt_world_momentum(world, &m);
    brunt_console_print(console, "momentum drift: linear %.2e, angular %.2e\n", m.linear_drift, m.angular_drift);
}

void brunt_summary_print(const brunt_summary *s, const brunt_scene *scene, brunt_world *world, brunt_console *console) {
    double steps = (double)brunt_world_steps(world);
    char counts[64];
    brunt_counts(world, counts);
    brunt_console_print(console, "%s: %s\n", s->status, s->reason);
    brunt_console_print(console, "scene %s, brunt %s, %dD, %d thread%s, %s\n", scene->name, BRUNT_VERSION,
                        brunt_world_dimension(world), brunt_world_threads(world),
                        brunt_world_threads(world) == 1 ? "" : "s", counts);
    brunt_console_print(console, "t = %.9g s after %lld steps of %.4g to %.4g s\n", brunt_world_time(world),
                        (long long)brunt_world_steps(world), brunt_world_dt_min(world), brunt_world_dt_max(world));
    brunt_console_print(console, "wall %.2f s, of it steps %.2f s, output %.2f s; cpu %.2f s; peak memory %.1f MB\n",
                        s->wall_seconds, s->step_seconds, s->output_seconds, s->cpu_seconds, 1e-6 * s->peak_bytes);
    print_rate(console, (double)brunt_world_particles(world), steps, s->step_seconds, "particle");
    print_rate(console, (double)brunt_world_elements(world), steps, s->step_seconds, "element");
    print_energy(world, console);
    print_notes(world, console);
    print_added_mass(world, console);
    print_eroded(world, console);
    print_newton(world, console);
    print_balance(world, console);
    print_links(world, console);
    print_momentum(world, console);
    brunt_console_print(console, "state hash 0x%016llx\n", (unsigned long long)s->state_hash);
    print_measures(s, scene, console);
}
