// The plan of a scene, without running it: what is switched on and by what, what it costs in memory and time.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>

#include "app/app.h"
#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "io/output/history.h"
#include "io/output/parts.h"
#include "io/performance/machine.h"
#include "io/performance/predict.h"
#include "io/performance/progress.h"
#include "io/run/run.h"
#include "io/scene/crowd.h"
#include "materials/material.h"

static void print_size(double bytes, int width) {
    static const char *const units[] = {"B", "kB", "MB", "GB", "TB"};
    int u = 0;
    for (; bytes >= 999.5 && u < BRUNT_COUNT(units) - 1; u++) bytes /= 1000;
    printf("%*.*f %s", width, u ? 2 : 0, bytes, units[u]);
}

static void print_mesh(brunt_world *world, int32_t body) {
    brunt_mesh_report report;
    brunt_body_mesh(world, body, &report);
    const brunt_mesh_quality *q = &report.quality;
    printf("      edges %.4g to %.4g m, worst shape %.3g of 1 (element id %lld), least stable step %.4g s\n",
           q->shortest_edge, q->longest_edge, q->worst_shape, (long long)q->worst, report.least_step);
    if (report.scaled_elements)
        printf("      mass scaling: %lld elements made denser, %.4g kg added\n", (long long)report.scaled_elements,
               report.added_mass);
}

static void print_body(brunt_world *world, int32_t b) {
    brunt_body_sums sums;
    char size[96];
    bool fem = brunt_body_method(world, b) != BRUNT_MPM;
    brunt_body_totals(world, b, &sums);
    if (fem)
        snprintf(size, sizeof size, "%10lld %s elements, %lld nodes", (long long)brunt_body_elements(world, b),
                 brunt_element_name(brunt_body_element(world, b)), (long long)brunt_body_nodes(world, b));
    else
        snprintf(size, sizeof size, "%12lld particles", (long long)brunt_body_particles(world, b));
    printf("  %-20s %-20s %s  mass %.6g kg  velocity [%.6g, %.6g, %.6g] m/s\n", brunt_body_name(world, b),
           brunt_body_material(world, b), size, sums.mass, sums.velocity[0], sums.velocity[1], sums.velocity[2]);
    if (fem) print_mesh(world, b);
}

// Young's modulus of a body of the definition; NAN: its material has none.
static double young_of(const brunt_world_def *def, int32_t body) {
    const brunt_material_def *material = &def->materials[def->bodies[body].material];
    const brunt_model *model = brunt_find_strength(material->strength);
    for (int p = 0; model && p < model->parameter_count; p++)
        if (!strcmp(model->parameters[p].key, "E")) return material->strength_parameters[p];
    return NAN;
}

typedef struct spread {
    double least, greatest, mean, sd;
} spread;

static void spread_add(spread *s, double value, int64_t before) {
    const double off = value - s->mean;
    s->least = before ? fmin(s->least, value) : value, s->greatest = before ? fmax(s->greatest, value) : value;
    s->mean += off / (double)(before + 1);
    s->sd += off * (value - s->mean); // of squares, until it ends
}

static void print_spread(const char *what, spread s, int64_t count, const char *unit) {
    printf(", %s %.5g to %.5g %s", what, s.least, s.greatest, unit);
    if (s.greatest > s.least) printf(" (mean %.5g, sd %.4g)", s.mean, sqrt(s.sd / (double)count));
}

// Members of a crowd together: what was made of its keys.
static void print_crowd(const brunt_scene *scene, brunt_world *world, int32_t first, int32_t end) {
    const brunt_world_def *def = &scene->world;
    char name[BRUNT_NAME_LENGTH];
    double mass = 0, step = INFINITY;
    int64_t elements = 0, particles = 0;
    spread radius = {0}, young = {0};
    for (int32_t b = first; b < end; b++) {
        brunt_body_sums sums;
        brunt_mesh_report report = {.least_step = INFINITY};
        brunt_body_totals(world, b, &sums);
        if (brunt_body_method(world, b) == BRUNT_FEM) brunt_body_mesh(world, b, &report);
        step = fmin(step, report.least_step), mass += sums.mass;
        elements += brunt_body_elements(world, b), particles += brunt_body_particles(world, b);
        spread_add(&radius, def->bodies[b].shape.radius, b - first);
        spread_add(&young, young_of(def, b), b - first);
    }
    brunt_part_name(world, first, name);
    printf("  %-20s %-20s %10d bodies, %lld %s, mass %.6g kg\n      ", name, brunt_body_material(world, first),
           (int)(end - first), (long long)(elements ? elements : particles),
           elements ? brunt_element_name(brunt_body_element(world, first)) : "particles", mass);
    printf("%s.1 to %s.%d", name, name, (int)(end - first));
    print_spread("radius", radius, end - first, "m");
    if (!isnan(young.mean)) print_spread("E", young, end - first, "Pa");
    if (isfinite(step)) printf(", least stable step %.4g s", step);
    putchar('\n');
}

static void print_bodies(const brunt_scene *scene, brunt_world *world) {
    printf("bodies\n");
    for (int32_t b = 0, end; b < brunt_body_count(world); b = end) {
        end = brunt_part_end(world, b);
        if (end > b + 1)
            print_crowd(scene, world, b, end);
        else
            print_body(world, b);
    }
}

// Lines and meshes that hold material points: into how many pieces they are cut.
static void print_surfaces(const brunt_scene *scene, const brunt_world *world) {
    const int32_t count = brunt_boundary_surface_count(world);
    if (count) printf("boundaries in pieces\n");
    for (int32_t s = 0; s < count; s++) {
        brunt_boundary_surface_report report;
        brunt_boundary_surface_read(world, s, &report);
        const double piece = s < scene->world.surface_count ? scene->world.surfaces[s].piece
                                                            : brunt_boundary_surface_def_default().piece;
        printf("  %-20s %12d pieces of about %g cells, %lld boundary particles\n", report.name, (int)report.pieces,
               piece, (long long)brunt_boundary_surface_size(world, s));
    }
}

// Those that are on with the key that asked for each, and the names of the others.
static void print_effects(brunt_world *world) {
    enum { WIDTH = 100 };
    printf("effects\n");
    for (int32_t e = 0; e < brunt_effect_count(world); e++) {
        const brunt_effect effect = brunt_world_effect(world, e);
        if (effect.on) printf("  %-28s on   %s\n", effect.name, effect.because ? effect.because : "");
    }
    int column = printf("  off:");
    for (int32_t e = 0; e < brunt_effect_count(world); e++) {
        const brunt_effect effect = brunt_world_effect(world, e);
        if (effect.on) continue;
        if (column + 1 + (int)strlen(effect.name) > WIDTH) column = printf("\n      ") - 1;
        column += printf(" %s", effect.name);
    }
    putchar('\n');
}

static void print_plan(brunt_world *world) {
    print_effects(world);
    printf("passes of a step\n");
    for (int32_t p = 0; p < brunt_pass_count(world); p++)
        printf("  %2d  %s\n", (int)p + 1, brunt_world_pass(world, p).name);
}

static double points_of(const brunt_world *world) {
    return (double)(brunt_world_particles(world) + brunt_world_elements(world));
}

// A line of the table: an array, or the same one of all members of a crowd.
typedef struct array_line {
    char name[160];
    brunt_array array;
    double bytes;
} array_line;

// "grains.17: nodes" is "grains: nodes".
static void name_line(const char *name, char *out, size_t room) {
    const int crowd = brunt_crowd_of(name);
    const size_t digits = crowd ? strspn(name + crowd + 1, "0123456789") : 0;
    if (digits)
        snprintf(out, room, "%.*s%s", crowd, name, name + crowd + 1 + digits);
    else
        snprintf(out, room, "%s", name);
}

// Members come one after the other: what one has is among the last lines, if it is there.
static void add_array(array_line *line, int32_t *count, const brunt_array *array) {
    enum { ARRAYS_OF_A_BODY = 64 };
    char name[160];
    name_line(array->name, name, sizeof name);
    for (int32_t k = *count - 1; k >= 0 && k >= *count - ARRAYS_OF_A_BODY; k--) {
        if (strcmp(line[k].name, name) != 0) continue;
        line[k].bytes += (double)array->bytes;
        return;
    }
    line[*count] = (array_line){.array = *array, .bytes = (double)array->bytes};
    memcpy(line[(*count)++].name, name, sizeof name);
}

static int print_memory(const brunt_world *world, brunt_error *error) {
    array_line *line;
    int32_t count = 0;
    double total = 0;
    if (BRUNT_NEW(line, (size_t)brunt_array_count(world) + 1, "a list of arrays", error)) return BRUNT_FAILED;
    printf("arrays\n");
    for (int32_t a = 0; a < brunt_array_count(world); a++) {
        const brunt_array array = brunt_world_array(world, a);
        add_array(line, &count, &array);
        total += (double)array.bytes;
    }
    for (int32_t k = 0; k < count; k++) {
        printf("  %-52s %2d x [%-8s] ", line[k].name, line[k].array.components, line[k].array.unit);
        print_size(line[k].bytes, 10);
        printf("\n");
    }
    printf("  %-68s", "all arrays");
    print_size(total, 10);
    printf(", %.0f bytes a %s\n", total / points_of(world),
           brunt_world_elements(world) ? "particle or element" : "particle");
    brunt_free(line);
    return BRUNT_OK;
}

static const char *plural(double count) { return count == 1 ? "" : "s"; }

// The passes that take the most, as shares of the steps.
static void print_shares(const brunt_prediction *p) {
    enum { SHOWN = 4 };
    bool shown[BRUNT_PREDICTION_PASSES] = {false};
    for (int n = 0; n < SHOWN; n++) {
        int32_t most = -1;
        for (int32_t i = 0; i < p->pass_count; i++)
            if (!shown[i] && (most < 0 || p->passes[i].seconds > p->passes[most].seconds)) most = i;
        if (most < 0 || !(p->passes[most].seconds > 0.02 * p->step_seconds)) break;
        shown[most] = true;
        printf("%s%s %.0f %%", n ? ", " : "", p->passes[most].name, 100 * p->passes[most].seconds / p->step_seconds);
    }
}

// Beside what was measured: far more of it means other work on the machine, or effects that cost more than the bodies
// do.
static void print_stored(const brunt_machine *machine, const brunt_scene *scene, const brunt_world *world) {
    const double step = brunt_machine_step(machine, &scene->world, world);
    if (isfinite(step))
        printf(
            "  the stored benchmark of this machine gives %.4g s for the bodies alone, neo-Hookean, without contact\n",
            step);
    else if (!machine->row_count)
        printf("  no benchmark of this machine is stored (sh bench/run.sh --store)\n");
}

static void print_rehearsal(const brunt_prediction *p) {
    if (p->factor > 1)
        printf("  rehearsed %.2g times coarser in %.2g s\n", p->factor, p->rehearsal_seconds);
    else if (p->factor > 0)
        printf("  rehearsed as it is, without output, in %.2g s\n", p->rehearsal_seconds);
    if (p->note[0]) printf("  note: %s\n", p->note);
}

// What the run will leave on the disk, and whether that is a mistake: an interval of nanoseconds fills any.
static void print_output(const brunt_prediction *p) {
    enum { MANY = 100000 };
    const double bytes = p->picture_bytes + p->line_bytes + p->checkpoint_bytes;
    struct statvfs disk;
    printf("output\n  %.0f picture%s, ", p->pictures, plural(p->pictures));
    print_size(p->picture_bytes, 0);
    printf(" before compression; %.0f history line%s, ", p->lines, plural(p->lines));
    print_size(p->line_bytes, 0);
    printf("; two checkpoints, ");
    print_size(p->checkpoint_bytes, 0);
    printf("\n");
    if (p->pictures > MANY)
        printf("warning: %.3g pictures, a file each for every body: is output.every as long as it is meant to be?\n",
               p->pictures);
    if (!statvfs(".", &disk) && bytes > (double)disk.f_bavail * (double)disk.f_frsize) {
        printf("warning: this disk has room for ");
        print_size((double)disk.f_bavail * (double)disk.f_frsize, 0);
        printf(", the output may take ");
        print_size(bytes, 0);
        printf("\n");
    }
}

// [m/s]; 0 of meshes, and where there is no memory to look.
static double fastest_particle(brunt_world *world, int32_t body) {
    const int64_t count = brunt_body_particles(world, body);
    const int32_t field = brunt_body_find_field(world, body, "velocity");
    double *v = count && field >= 0 ? malloc((size_t)count * 3 * sizeof *v) : NULL, most = 0;
    if (v) brunt_body_read(world, body, field, v);
    for (int64_t p = 0; v && p < count; p++)
        most = fmax(most, v[3 * p] * v[3 * p] + v[3 * p + 1] * v[3 * p + 1] + v[3 * p + 2] * v[3 * p + 2]);
    free(v);
    return sqrt(most);
}

static void print_range(const char *key, const double range[2], const char *unit) {
    if (!(range[1] > 0)) return;
    printf(", %s %.4g", key, range[0]);
    if (range[1] > range[0]) printf(" to %.4g", range[1]);
    printf(" %s", unit);
}

// What contact goes by where the scene does not say: it decides how near bodies come and how they rest.
static void print_barrier(const brunt_world *world) {
    brunt_barrier_values v;
    if (!brunt_world_barrier(world, &v)) return;
    printf("  contact.distance %.4g m", v.distance);
    print_range("contact.stiffness", v.stiffness, "Pa");
    print_range("contact.penalty", v.penalty, "Pa/m");
    if (v.penalty[1] > 0 && v.width > 0) printf(": 20 E* / a, a of %.4g m until contacts tell it", v.width);
    printf("\n");
    if (v.slip_speed > 0)
        printf("  contact.slip_speed %.4g m/s, %.3g of the slowest wave speed: what sticks creeps by up to that, "
               "and slower sliding has less than Coulomb's friction\n",
               v.slip_speed, v.slip_speed / v.slowest_wave);
    if (v.slip_length > 0)
        printf("  contact.slip_length %.4g m: surfaces that rub give by up to that along each other, then they slip\n",
               v.slip_length);
}

// What implicit steps solve, and whether they are short enough for the grid.
static void print_newton(const brunt_scene *scene, brunt_world *world) {
    brunt_newton_systems s;
    if (!brunt_world_newton_systems(world, &s)) return;
    if (brunt_world_static(world))
        printf("load steps\n  %d to t = 1, %lld unknowns, forces balanced to %.3g of those that act, ",
               scene->world.load_steps, (long long)s.unknowns, s.tolerance);
    else
        printf("implicit steps\n  c dt / h %.3g, %lld unknowns, corrections down to %.3g m/s, ", s.courant,
               (long long)s.unknowns, s.tolerance);
    print_size(s.bytes, 0);
    printf(" beside the bodies\n");
    const bool named = !strncmp(s.why, s.solver, strlen(s.solver)); // the reason begins with it
    printf("  solver %s%s%s\n", named ? "" : s.solver, named ? "" : ": ", s.why);
    print_barrier(world);
    double fastest = 0;
    for (int32_t b = 0; b < brunt_body_count(world); b++) fastest = fmax(fastest, fastest_particle(world, b));
    if (fastest * scene->world.step > scene->world.cell)
        printf("warning: particles move %.2g cells in a step: at most one is wanted\n",
               fastest * scene->world.step / scene->world.cell);
}

static void print_longer(double times, double seconds, const char *without) {
    if (times < 1.005)
        printf("no longer without %s", without);
    else
        printf("%.3g times as long without %s (steps %.3g s)", times, without, seconds / times);
}

// What longer steps would take, which material points stand that do not come away from each other.
static void print_together(const brunt_world_def *def, double seconds) {
    const double most = brunt_together_cfl(def->dimension, def->kernel, def->transfer);
    if (def->step > 0 || !(def->cfl < most * (1 - 1e-9))) return;
    printf("; points that hold together are stable up to time.cfl %.2g: %.3g times as long (steps %.3g s)", most,
           most / def->cfl, seconds * def->cfl / most);
}

// Whose step it is, and what its elements and the other bodies would have.
static void print_limit(const brunt_scene *scene, const brunt_world *world, brunt_step_limit limit, double seconds) {
    char few[64];
    if (limit.body < 0) return;
    printf("  the step is that of body %s", brunt_body_name(world, limit.body));
    if (limit.element >= 0)
        printf(", element id %lld (stable up to %.4g s%s)", (long long)limit.element, limit.step,
               limit.step < 0.999 * limit.element_step ? " with the loads on its surface" : "");
    else
        printf(" (stable up to %.4g s)", limit.step), print_together(&scene->world, seconds);
    if (limit.element >= 0 && isfinite(limit.without_few)) {
        snprintf(few, sizeof few, "its shortest %s", limit.few == 1 ? "element" : "elements");
        if (limit.few > 1) snprintf(few, sizeof few, "its %lld shortest elements", (long long)limit.few);
        printf("; ");
        print_longer(limit.without_few / limit.element_step, seconds, few);
    }
    if (isfinite(limit.without_body)) {
        printf("%s", limit.element >= 0 && isfinite(limit.without_few) ? ", " : "; ");
        print_longer(limit.without_body / limit.step, seconds, "the body");
    }
    printf("\n");
}

static int print_cost(const brunt_machine *machine, const brunt_scene *scene, brunt_world *world,
                      brunt_history *history, bool quick, brunt_error *error) {
    brunt_prediction p;
    brunt_step_limit limit; // at the start: predictions take steps
    const int threads = brunt_world_threads(world);
    int status = brunt_world_step_limit(world, &limit, error);
    if (!status) status = brunt_predict(scene, world, history, quick, &p, error);
    if (status) return status;
    char all[32];
    brunt_duration(p.step_seconds + p.output_seconds, all);
    double step = p.sampled_seconds / p.sampled_steps;
    printf("time\n  ");
    if (!(scene->world.step > 0)) printf("cfl %.3g, ", scene->world.cfl);
    printf("first step %.6g s, end %.6g s, about %.0f steps\n", p.first_step, brunt_world_end(world), p.steps);
    printf("  measured over %.0f step%s on %d thread%s: %.4g s a step, %.1f ns per %s-step\n", p.sampled_steps,
           plural(p.sampled_steps), threads, plural(threads), step, 1e9 * step / points_of(world),
           brunt_world_elements(world) == 0    ? "particle"
           : brunt_world_particles(world) == 0 ? "element"
                                               : "particle- or element");
    print_limit(scene, world, limit, p.step_seconds);
    print_stored(machine, scene, world);
    print_rehearsal(&p);
    printf("  steps %.3g s (", p.step_seconds);
    print_shares(&p);
    printf(") + output %.2g s = about %s on %d thread%s\n", p.output_seconds, all, threads, plural(threads));
    printf("memory\n  arrays ");
    print_size(p.array_bytes, 0);
    printf(", peak about ");
    print_size(p.peak_bytes, 0);
    printf(" (program, arrays as they grow, output)\n");
    print_output(&p);
    return BRUNT_OK;
}

static int check(const brunt_scene *scene, bool quick, brunt_error *error) {
    brunt_machine machine;
    int status = brunt_machine_load(&machine, error);
    if (status) {
        fprintf(stderr, "brunt: %s\n", error->message);
        return status;
    }
    brunt_world *world = brunt_world_create(&scene->world, error);
    brunt_history *history = world ? brunt_history_create(world, scene, error) : NULL;
    status = history ? BRUNT_OK : error->code;
    if (status) brunt_scene_complain(scene, error->message, stderr);
    if (!status) status = brunt_run_check(scene, world, history, stderr, error);
    if (!status) {
        char counts[64];
        brunt_counts(world, counts);
        printf("%s: %s\n%dD, %s, %lld nodes, %d thread%s, %d history columns, %d measures\n", scene->name, scene->title,
               brunt_world_dimension(world), counts, (long long)brunt_world_nodes(world), brunt_world_threads(world),
               brunt_world_threads(world) == 1 ? "" : "s", (int)brunt_history_column_count(history),
               (int)scene->measure_count);
        brunt_console console = {.out = stdout};
        brunt_run_warn(scene, world, &console);
        print_bodies(scene, world);
        print_surfaces(scene, world);
        print_plan(world);
        print_newton(scene, world);
        status = print_memory(world, error);
        if (!status) status = print_cost(&machine, scene, world, history, quick, error);
        if (status) fprintf(stderr, "brunt: the scene fails in its first steps: %s\n", error->message);
    }
    brunt_machine_free(&machine);
    brunt_history_destroy(history);
    brunt_world_destroy(world);
    return status;
}

int cmd_check(int argc, char **argv) {
    app_arguments arguments;
    int status = app_parse(argc, argv, "brunt check SCENE [-t THREADS] [--quick] [--set PATH=VALUE]...",
                           APP_THREADS | APP_SET | APP_QUICK, true, &arguments);
    if (status) return status < 0 ? BRUNT_OK : status;
    brunt_parallel_adapt(true); // as the run will
    brunt_scene scene;
    status = app_read_scene(&arguments, &scene);
    if (status) return status;
    brunt_error error = {0};
    status = check(&scene, arguments.quick, &error);
    brunt_scene_free(&scene);
    return status;
}
