// What whole scenes cost, run by the program as a user does: time per step and particle or element, peak of memory.
//
//   bench_scenes [--quick] [--threads N[,N...]] [--rounds N] [--only NAME] [--folder bench/scenes] [-o FILE.csv]
//
// The scenes in the folder's benchmark.txt, each up to the share of its end time that stands there, without pictures;
// rounds go through all of them one after the other. --quick: every fourth, an eighth of its share, once. -o: rows of a
// machine's file (bench/machines/README.md) are appended.
#include <fcntl.h>
#include <jansson.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "rows.h"
#include "io/scene/scene.h"

enum { SCENE_LIMIT = 128, THREADS_LIMIT = 4, ROUND_LIMIT = 16, SECONDS_LIMIT = 120 };

typedef struct samples {
    double step[ROUND_LIMIT], wall[ROUND_LIMIT], peak[ROUND_LIMIT]; // [ns/unit], [s], [B]
    int rounds;
} samples;

typedef struct scene_case {
    char name[96];
    double share, end; // [-], [s]
    double units, steps;
    samples with[THREADS_LIMIT];
} scene_case;

typedef struct settings {
    int64_t threads[THREADS_LIMIT];
    int thread_count, rounds, stride;
    double share;
    const char *only, *folder, *file;
    char program[512], out[64];
} settings;

static bool read_settings(int argc, char **argv, settings *s) {
    for (int i = 1; i < argc; i++) {
        const char *option = argv[i], *value = i + 1 < argc ? argv[i + 1] : "";
        int64_t number[1];
        bool ok = *value != 0;
        if (strcmp(option, "--quick") == 0) {
            s->rounds = 1, s->share = 0.125, s->stride = 4;
            continue;
        }
        i++;
        if (strcmp(option, "--threads") == 0)
            ok = (s->thread_count = read_list(value, 64, THREADS_LIMIT, s->threads)) > 0;
        else if (strcmp(option, "--rounds") == 0)
            ok = read_list(value, ROUND_LIMIT, 1, number) == 1, s->rounds = ok ? (int)number[0] : 0;
        else if (strcmp(option, "--only") == 0)
            s->only = value;
        else if (strcmp(option, "--folder") == 0)
            s->folder = value;
        else if (strcmp(option, "-o") == 0)
            s->file = value;
        else
            ok = false;
        if (!ok) {
            fprintf(stderr, "bench_scenes: %s %s is not understood\n", option, value);
            return false;
        }
    }
    return true;
}

// The program lies beside the folder that this one is in.
static bool find_program(char *out, size_t size) {
    char self[480];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    if (length <= 0) return false;
    self[length] = 0;
    *strrchr(self, '/') = 0;
    snprintf(out, size, "%s/../brunt", self);
    if (access(out, X_OK) == 0) return true;
    fprintf(stderr, "bench_scenes: there is no program %s\n", out);
    return false;
}

// Lines "name share"; what begins with # is a comment. 0: something is wrong, and said.
static int read_plan(const settings *s, scene_case *list) {
    char path[1024], line[256];
    int count = 0, number = 0, seen = 0;
    snprintf(path, sizeof path, "%s/benchmark.txt", s->folder);
    FILE *in = fopen(path, "r");
    if (!in) return fprintf(stderr, "bench_scenes: %s: %s\n", path, strerror(errno)), 0;
    while (fgets(line, sizeof line, in) && count < SCENE_LIMIT) {
        scene_case *c = &list[count];
        number++;
        if (line[strspn(line, " \t\n")] == 0 || *line == '#') continue;
        if (sscanf(line, "%95s %lf", c->name, &c->share) != 2 || !(c->share > 0) || c->share > 1) {
            fprintf(stderr, "%s:%d: a name and a share from 0 to 1 are wanted\n", path, number);
            count = 0;
            break;
        }
        if (s->only ? strcmp(s->only, c->name) != 0 : seen++ % s->stride != 0) continue;
        brunt_scene scene;
        snprintf(path, sizeof path, "%s/%s.yaml", s->folder, c->name);
        if (brunt_scene_read(path, NULL, 0, &scene, stderr) != BRUNT_OK) {
            count = 0;
            break;
        }
        c->end = scene.world.end * c->share * s->share;
        brunt_scene_free(&scene);
        count++;
    }
    fclose(in);
    return count;
}

static void run_program(const settings *s, const scene_case *c, int threads) {
    char path[1024], end[64], count[16];
    snprintf(path, sizeof path, "%s/%s.yaml", s->folder, c->name);
    snprintf(end, sizeof end, "time.end=%.9e", c->end);
    snprintf(count, sizeof count, "%d", threads);
    const struct rlimit most = {SECONDS_LIMIT, SECONDS_LIMIT};
    const int nowhere = open("/dev/null", O_WRONLY);
    setrlimit(RLIMIT_CPU, &most);
    if (nowhere >= 0) dup2(nowhere, STDOUT_FILENO);
    execl(s->program, s->program, "run", path, "-q", "-t", count, "-o", s->out, "--set", end, "--set",
          "output.every=none", "--set", "measures={}", (char *)NULL); // measures may ask for later times
    _exit(127);
}

static double value_of(const json_t *summary, const char *key) {
    return json_number_value(json_object_get(summary, key));
}

// false when the run failed; what it said stands above.
static bool measure(const settings *s, scene_case *c, int t) {
    char path[128];
    int status = -1;
    struct rusage usage;
    const pid_t child = fork();
    if (child == 0) run_program(s, c, (int)s->threads[t]);
    if (child < 0 || wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        fprintf(stderr, "bench_scenes: %s did not run (%d)\n", c->name, status);
        return false;
    }
    snprintf(path, sizeof path, "%s/summary.json", s->out);
    json_t *summary = json_load_file(path, 0, NULL);
    const double particles = value_of(summary, "particles"), elements = value_of(summary, "elements"),
                 ns = particles * value_of(summary, "ns_per_particle_step"),
                 of_elements = elements * value_of(summary, "ns_per_element_step");
    samples *with = &c->with[t];
    c->units = particles + elements, c->steps = value_of(summary, "steps");
    with->step[with->rounds] = (ns > 0 ? ns : of_elements) / c->units;
    with->wall[with->rounds] = value_of(summary, "wall_s");
    with->peak[with->rounds++] = 1024.0 * (double)usage.ru_maxrss;
    json_decref(summary);
    return summary != NULL;
}

static void report(FILE *csv, const settings *s, scene_case *c) {
    double single = 0;
    for (int t = 0; t < s->thread_count; t++) {
        samples *with = &c->with[t];
        if (!with->rounds) continue;
        const row_key key = {"scene", c->name, c->units, (int)s->threads[t]};
        const double step = write_samples(csv, key, "step", "ns/unit", with->step, with->rounds),
                     wall = write_samples(csv, key, "wall", "s", with->wall, with->rounds),
                     peak = write_samples(csv, key, "peak", "B", with->peak, with->rounds);
        write_row(csv, key, "steps", "1", c->steps, c->steps, with->rounds);
        if (s->threads[t] == 1) single = step;
        printf("%-26s %8.0f units %7.0f steps %2d thread%s %9.1f ns (%.1f) %7.2f s %7.1f MB", c->name, c->units,
               c->steps, key.threads, key.threads == 1 ? " " : "s", step, with->step[0], wall, 1e-6 * peak);
        if (key.threads > 1 && single > 0) printf("  speed-up %.2f", single / step);
        printf("\n");
    }
}

static void remove_folder(const char *folder) {
    char command[96];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    if (system(command) != 0) fprintf(stderr, "bench_scenes: %s is left behind\n", folder);
}

int main(int argc, char **argv) {
    settings s = {.threads = {1, 2}, .thread_count = 2, .rounds = 3, .stride = 1, .share = 1, .folder = "bench/scenes"};
    if (!read_settings(argc, argv, &s)) return BRUNT_BAD_USAGE;
    if (!find_program(s.program, sizeof s.program)) return BRUNT_BAD_INPUT;
    scene_case *list = calloc(SCENE_LIMIT, sizeof *list);
    const int count = list ? read_plan(&s, list) : 0;
    FILE *csv = s.file && count ? open_rows(s.file) : NULL;
    snprintf(s.out, sizeof s.out, "/tmp/bench_scenes_XXXXXX");
    if (!count || (s.file && !csv) || !mkdtemp(s.out)) {
        if (!count) fprintf(stderr, "bench_scenes: no scene\n");
        free(list);
        return count ? BRUNT_IO_ERROR : BRUNT_BAD_INPUT;
    }
    if (csv) fflush(csv); // or each process would write it again
    bool all = true;
    for (int r = 0; r < s.rounds; r++)
        for (int k = 0; k < count; k++)
            for (int t = 0; t < s.thread_count; t++) all = measure(&s, &list[k], t) && all;
    printf("scenes: ns per step and particle or element, median of the rounds (least in brackets); whole run, peak\n");
    for (int k = 0; k < count; k++) report(csv, &s, &list[k]);
    remove_folder(s.out);
    free(list);
    return !close_rows(csv) ? BRUNT_IO_ERROR : all ? BRUNT_OK : BRUNT_FAILED;
}
