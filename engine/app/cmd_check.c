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

static void print_bodies(brunt_world *world) {
    printf("bodies\n");
    for (int32_t b = 0; b < brunt_body_count(world); b++) {
        brunt_body_sums sums;
        brunt_body_totals(world, b, &sums);
        printf("  %-20s %-20s %12lld particles  mass %.6g kg  velocity [%.6g, %.6g, %.6g] m/s\n",
               brunt_body_name(world, b), brunt_body_material(world, b), (long long)brunt_body_particles(world, b),
               sums.mass, sums.velocity[0], sums.velocity[1], sums.velocity[2]);
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
    printf(", %.0f bytes a particle\n", total / (double)brunt_world_particles(world));
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

static int print_cost(brunt_world *world, brunt_error *error) {
    double dt = brunt_world_dt(world), steps = ceil(brunt_world_end(world) / dt), seconds;
    printf("time\n  first step %.6g s, end %.6g s, about %.0f steps\n", dt, brunt_world_end(world), steps);
    int taken, status = measure_step(world, &seconds, &taken, error);
    if (status) return status;
    char duration[32];
    brunt_duration(seconds * steps, duration);
    printf("  measured over %d step%s on %d thread%s: %.4g s a step, %.1f ns per particle-step; about %s in all\n",
           taken, taken == 1 ? "" : "s", brunt_world_threads(world), brunt_world_threads(world) == 1 ? "" : "s",
           seconds, 1e9 * seconds / (double)brunt_world_particles(world), duration);
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
        printf("%s: %s\n%dD, %lld particles, %lld grid nodes, %d thread%s, %d history columns, %d measures\n",
               scene->name, scene->title, brunt_world_dimension(world), (long long)brunt_world_particles(world),
               (long long)brunt_world_nodes(world), brunt_world_threads(world),
               brunt_world_threads(world) == 1 ? "" : "s", (int)brunt_history_column_count(history),
               (int)scene->measure_count);
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
