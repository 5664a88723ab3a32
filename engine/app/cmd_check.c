// The plan of a scene, without running it: what is switched on and by what, what it costs in memory and time.
#include <math.h>
#include <stdio.h>

#include "app.h"
#include "history.h"
#include "progress.h"
#include "run.h"
#include "threads.h"

static void print_size(double bytes) {
    static const char *const units[] = {"B", "kB", "MB", "GB", "TB"};
    int u = 0;
    for (; bytes >= 999.5 && u < 4; u++) bytes /= 1000;
    printf(u ? "%10.2f %s" : "%10.0f %s", bytes, units[u]);
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

static void print_bodies(brunt_world *world) {
    printf("bodies\n");
    for (int32_t b = 0; b < brunt_body_count(world); b++) {
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
}

static void print_plan(brunt_world *world) {
    printf("effects\n");
    for (int32_t e = 0; e < brunt_effect_count(world); e++) {
        brunt_effect effect = brunt_world_effect(world, e);
        printf("  %-28s %-4s %s\n", effect.name, effect.on ? "on" : "off",
               effect.on && effect.because ? effect.because : "");
    }
    printf("passes of a step\n");
    for (int32_t p = 0; p < brunt_pass_count(world); p++)
        printf("  %2d  %s\n", (int)p + 1, brunt_world_pass(world, p).name);
}

static double points_of(const brunt_world *world) {
    return (double)(brunt_world_particles(world) + brunt_world_elements(world));
}

static void print_memory(brunt_world *world) {
    double total = 0;
    printf("arrays\n");
    for (int32_t a = 0; a < brunt_array_count(world); a++) {
        brunt_array array = brunt_world_array(world, a);
        printf("  %-52s %2d x [%-8s] ", array.name, array.components, array.unit);
        print_size((double)array.bytes);
        printf("\n");
        total += (double)array.bytes;
    }
    printf("  %-68s", "all arrays");
    print_size(total);
    printf(", %.0f bytes a %s\n", total / points_of(world),
           brunt_world_elements(world) ? "particle or element" : "particle");
}

// Times up to three steps of this very scene: no stored figure knows its materials, contacts and threads. The first
// step is left out when there are more, since it touches memory for the first time; no more are taken once two seconds
// are up.
static int measure_step(brunt_world *world, double *seconds, int *taken, brunt_error *error) {
    enum { STEPS = 3 };
    double spent[STEPS], start = brunt_clock();
    *taken = 0;
    while (*taken < STEPS && brunt_world_time(world) < brunt_world_end(world)) {
        double from = brunt_clock();
        int status = brunt_world_step(world, INFINITY, error);
        if (status) return status;
        spent[(*taken)++] = brunt_clock() - from;
        if (brunt_clock() - start > 2) break;
    }
    *seconds = 0;
    int first = *taken > 1 ? 1 : 0;
    for (int s = first; s < *taken; s++) *seconds += spent[s] / (*taken - first);
    return BRUNT_OK;
}

// What a step usually takes on one core [s], contact and walls apart: to compare the measured time with.
static double usual_cost(const brunt_world *world) {
    static const double element[BRUNT_ELEMENT_KINDS] = {30e-9, 100e-9, 20e-9, 40e-9, 60e-9, 40e-9}, particle = 75e-9;
    double cost = 0;
    for (int32_t b = 0; b < brunt_body_count(world); b++)
        cost += brunt_body_method(world, b) != BRUNT_MPM
                    ? element[brunt_body_element(world, b)] * (double)brunt_body_elements(world, b)
                    : particle * (double)brunt_body_particles(world, b);
    return cost;
}

static int print_cost(brunt_world *world, brunt_error *error) {
    double dt = brunt_world_dt(world), steps = ceil(brunt_world_end(world) / dt), seconds;
    printf("time\n  first step %.6g s, end %.6g s, about %.0f steps\n", dt, brunt_world_end(world), steps);
    int taken, status = measure_step(world, &seconds, &taken, error);
    if (status) return status;
    char duration[32];
    brunt_duration(seconds * steps, duration);
    printf("  measured over %d step%s on %d thread%s: %.4g s a step, %.1f ns per %s-step; about %s in all\n", taken,
           taken == 1 ? "" : "s", brunt_world_threads(world), brunt_world_threads(world) == 1 ? "" : "s", seconds,
           1e9 * seconds / points_of(world),
           brunt_world_elements(world) == 0    ? "particle"
           : brunt_world_particles(world) == 0 ? "element"
                                               : "particle- or element",
           duration);
    printf("  usual on one core, without contact: %.4g s a step\n", usual_cost(world));
    printf("  (without output; steps grow shorter where material is compressed, so this is a lower estimate)\n");
    return BRUNT_OK;
}

static int check(const brunt_scene *scene, brunt_error *error) {
    brunt_world *world = brunt_world_create(&scene->world, error);
    brunt_history *history = world ? brunt_history_create(world, scene, error) : NULL;
    int status = history ? BRUNT_OK : error->code;
    if (status) fprintf(stderr, "%s: %s\n", scene->source, error->message);
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
        print_bodies(world);
        print_plan(world);
        print_memory(world);
        status = print_cost(world, error);
        if (status) fprintf(stderr, "brunt: the scene fails in its first steps: %s\n", error->message);
    }
    brunt_history_destroy(history);
    brunt_world_destroy(world);
    return status;
}

int cmd_check(int argc, char **argv) {
    app_arguments arguments;
    int status = app_parse(argc, argv, "brunt check SCENE [-t THREADS] [--set PATH=VALUE]...", APP_THREADS | APP_SET,
                           true, &arguments);
    if (status) return status < 0 ? BRUNT_OK : status;
    brunt_scene scene;
    status = app_read_scene(&arguments, &scene);
    if (status) return status;
    brunt_error error = {0};
    status = check(&scene, &error);
    brunt_scene_free(&scene);
    return status;
}
