// Studies: what a study file becomes, what is refused and where, and small studies run, gone on with and run anew.
//
// Every file of tests/bad_studies begins with lines "# expect: LINE:COLUMN: SUBSTRING", one for each mistake that must
// be reported, in order; no other mistake may be.
#include "tests/support/small_scene.h"

#include <dirent.h>
#include <jansson.h>
#include <math.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/memory.h"
#include "io/scene/scene_keys.h"
#include "io/study/study_reader.h"

static const char scene_text[] =
    "brunt: 1\n"
    "dimension: 2\n"
    "time: {end: 4 ms, cfl: 0.4}\n"
    "grid: {cell: 0.1 m}\n"
    "materials:\n"
    "  rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}\n"
    "bodies:\n"
    "  left: {method: mpm, material: rubber, shape: {box: {min: [0, 0], max: [0.5, 0.5]}}, velocity: [5, 0]}\n"
    "  right: {method: mpm, material: rubber, shape: {box: {min: [0.6, 0], max: [1.1, 0.5]}}, velocity: [-5, -1]}\n"
    "output: {every: 1 ms, history: 1 ms}\n"
    "measures:\n"
    "  kept: {history: energy.total, relative_to: initial, expect: 1, tolerance: 0.5}\n"
    "  length: {extent: {body: left, axis: [1, 0]}, expect: 50 cm, tolerance: 0.5, unit: m}\n";

static const char elements_text[] =
    "brunt: 1\n"
    "dimension: 2\n"
    "time: {end: 4 ms}\n"
    "materials:\n"
    "  rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}\n"
    "bodies:\n"
    "  left: {method: fem, material: rubber, size: 0.1, shape: {box: {min: [0, 0], max: [0.5, 0.5]}}, velocity: [5, "
    "0]}\n"
    "measures:\n"
    "  kept: {history: energy.total, relative_to: initial, expect: 1, tolerance: 0.5}\n"
    "  length: {extent: {body: left, axis: [1, 0]}, expect: 50 cm, tolerance: 0.5, unit: m}\n";

// All that a study file may say.
static const char all_text[] =
    "brunt_study: 1\n"
    "title: Two blocks, kernels and transfers\n"
    "scene: scenes/blocks.yaml\n"
    "set: {output.every: none, bodies.right.velocity: [0, '{v/2}'], measures.deep: {history: energy.kinetic, take: "
    "max}}\n"
    "threads: 2\n"
    "repeats: 4\n"
    "time_limit: 5 min\n"
    "axes:\n"
    "  method:\n"
    "    values:\n"
    "      APIC: {grid.transfer: apic}\n"
    "      FLIP: {grid.transfer: {flip: 0.98}}\n"
    "      FEM: {scene: scenes/elements.yaml, threads: 3, program: ../other/brunt, bodies.left.size: '{h*2}',\n"
    "        bodies.right: {method: fem, material: rubber, size: 0.1, shape: {box: {min: [9, 9], max: [10, 10]}}}}\n"
    "  kernel: {key: grid.kernel, values: [linear, quadratic, cubic]}\n"
    "  v: {values: {slow: 10 km/h, fast: 5}}\n"
    "  h: {key: grid.cell, values: [100 mm, 0.05 m], role: resolution}\n"
    "  size: {keys: [time.end, 'bodies.left.velocity'], scale: [1, 50 %]}\n"
    "measures:\n"
    "  length: {title: error of the length, order: 2}\n"
    "  kept: {reference: {axis: kernel, values: {linear: 1, quadratic: 99 %, cubic: 0.98}}, scale: 2}\n"
    "  deep: {reference: richardson, of: FEM}\n"
    "accuracies: [5 %, 0.001]\n"
    "skip: [{method: FEM, kernel: linear}, {method: FEM, kernel: cubic}, {method: APIC, v: fast, h: 100 mm}]\n";

static char *messages;

static void write_text(const char *name, const char *text) { small_write(small_path(name), text, (long)strlen(text)); }

static char *search_path;

static void set_up(void) {
    small_folder_make();
    search_path = strdup(getenv("PATH"));
    ck_assert_int_eq(mkdir(small_path("scenes"), 0777), 0);
    write_text("scenes/blocks.yaml", scene_text);
    write_text("scenes/elements.yaml", elements_text);
}

static void tear_down(void) {
    setenv("PATH", search_path, 1);
    free(search_path);
    small_folder_remove();
    free(messages);
    messages = NULL;
}

static int read_file(const char *path, brunt_study *study) {
    size_t length;
    free(messages);
    messages = NULL;
    FILE *out = open_memstream(&messages, &length);
    int status = brunt_study_read(path, study, out);
    fclose(out);
    return status;
}

static void read_good(const char *text, brunt_study *study) {
    write_text("study.yaml", text);
    int status = read_file(small_path("study.yaml"), study);
    ck_assert_msg(status == BRUNT_OK, "%s", messages);
}

#define NEAR(a, b) ck_assert_double_eq_tol(a, b, 1e-12 * fabs((double)(b)))

// ---------------------------------------------------------------------------------------------------- reading

START_TEST(whole_file) {
    brunt_study s;
    char path[1100];
    read_good(all_text, &s);
    ck_assert_str_eq(s.name, "study");
    ck_assert_str_eq(s.title, "Two blocks, kernels and transfers");
    snprintf(path, sizeof path, "%s/scenes/blocks.yaml", small_folder);
    ck_assert_str_eq(s.scene, path);
    ck_assert_int_eq(s.threads, 2);
    ck_assert_int_eq(s.repeats, 4);
    NEAR(s.time_limit, 300);
    ck_assert_int_eq(s.set_count, 3);
    ck_assert_str_eq(s.sets[0], "output.every=none");
    ck_assert_str_eq(s.sets[1], "bodies.right.velocity=[0, \"{v/2}\"]");
    ck_assert_str_eq(s.sets[2], "measures.deep={history: energy.kinetic, take: max}");
    ck_assert_int_eq(s.axis_count, 5);
    ck_assert_int_eq(s.resolution, 3);
    const brunt_study_axis *method = &s.axes[0], *v = &s.axes[2], *h = &s.axes[3], *size = &s.axes[4];
    ck_assert_str_eq(method->values[1].sets[0], "grid.transfer={flip: 0.98}");
    const brunt_study_value *fem = &method->values[2];
    ck_assert_int_eq(method->value_count, 3);
    ck_assert_str_eq(fem->label, "FEM");
    ck_assert_int_eq(fem->threads, 3);
    snprintf(path, sizeof path, "%s/scenes/elements.yaml", small_folder);
    ck_assert_str_eq(fem->scene, path);
    snprintf(path, sizeof path, "%s/../other/brunt", small_folder);
    ck_assert_str_eq(fem->program, path);
    ck_assert_int_eq(fem->set_count, 2);
    ck_assert(isnan(fem->number) && method->role == BRUNT_STUDY_METHOD);
    NEAR(v->values[0].number, 10 / 3.6);
    ck_assert_str_eq(v->values[0].label, "slow");
    ck_assert_int_eq(h->role, BRUNT_STUDY_RESOLUTION);
    ck_assert_str_eq(h->unit, "m");
    ck_assert_str_eq(h->values[0].label, "100 mm");
    NEAR(h->values[0].number, 0.1);
    ck_assert_str_eq(h->values[1].sets[0], "grid.cell=0.05 m");
    ck_assert_int_eq(size->values[1].set_count, 2);
    NEAR(size->values[1].number, 0.5);
    brunt_study_free(&s);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(measures_and_cases) {
    brunt_study s;
    read_good(all_text, &s);
    ck_assert_int_eq(s.measure_count, 3);
    const brunt_study_measure *length = &s.measures[0], *kept = &s.measures[1], *deep = &s.measures[2];
    ck_assert_str_eq(length->title, "error of the length");
    ck_assert_int_eq(length->reference, BRUNT_REFERENCE_NUMBER);
    ck_assert(isnan(length->exact) && isnan(length->scale));
    NEAR(length->order, 2);
    ck_assert_int_eq(kept->reference, BRUNT_REFERENCE_TABLE);
    ck_assert_int_eq(kept->table_axis, 1);
    NEAR(kept->table[1], 0.99);
    NEAR(kept->scale, 2);
    ck_assert_str_eq(kept->title, "error of kept");
    ck_assert_int_eq(deep->reference, BRUNT_REFERENCE_RICHARDSON);
    ck_assert_str_eq(deep->of, "FEM");
    ck_assert_int_eq(s.accuracy_count, 2);
    NEAR(s.accuracies[0], 0.05);
    // 3 x 3 x 2 x 2 x 2 without two of the three kernels of FEM (8 each) and one resolution of fast APIC (3 x 2).
    ck_assert_int_eq(s.case_count, 72 - 16 - 6);
    // Lines: methods, kernels, speeds and sizes, of FEM one kernel.
    ck_assert_int_eq(s.line_count, (3 + 3 + 1) * 4);
    ck_assert_str_eq(s.lines[0].label, "APIC, linear, slow, size = 1");
    for (int32_t c = 0; c < s.case_count; c++) {
        const int32_t *at = s.cases[c].value;
        ck_assert(s.cases[c].status == BRUNT_STUDY_WAITING && s.cases[c].line < s.line_count);
        ck_assert(at[0] != 2 || at[1] == 1);
        ck_assert(at[0] != 0 || at[2] != 1 || at[3] != 0);
    }
    brunt_study_free(&s);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

static const char *set_of(const study_job *job, const char *path) {
    size_t length = strlen(path);
    for (int32_t s = job->set_count - 1; s >= 0; s--)
        if (strncmp(job->sets[s], path, length) == 0 && job->sets[s][length] == '=') return job->sets[s] + length + 1;
    return "";
}

// What is handed to the program: placeholders in SI, factors on what the scene has.
START_TEST(jobs) {
    brunt_study s;
    study_job job;
    study_origin culprit;
    brunt_error error = {0};
    read_good(all_text, &s);
    brunt_study_case c = {.value = {2, 1, 1, 0, 1}}; // FEM, quadratic, fast, 100 mm, half
    ck_assert_int_eq(brunt_study_job(&s, &c, &job, &culprit, &error), BRUNT_OK);
    ck_assert_int_eq(job.threads, 3);
    ck_assert_ptr_nonnull(strstr(job.scene, "/scenes/elements.yaml"));
    ck_assert_ptr_nonnull(strstr(job.program, "/../other/brunt"));
    ck_assert_str_eq(set_of(&job, "bodies.left.size"), "\"0.2\"");
    ck_assert_str_eq(set_of(&job, "bodies.right.velocity"), "[0, \"2.5\"]");
    ck_assert_str_eq(set_of(&job, "grid.cell"), "100 mm");
    ck_assert_str_eq(set_of(&job, "time.end"), "0.002");
    ck_assert_str_eq(set_of(&job, "bodies.left.velocity"), "[2.5, 0]");
    brunt_study_job_free(&job);
    c = (brunt_study_case){.value = {1, 2, 0, 1, 0}};
    ck_assert_int_eq(brunt_study_job(&s, &c, &job, &culprit, &error), BRUNT_OK);
    ck_assert_int_eq(job.threads, 2);
    ck_assert_str_eq(job.program, "");
    ck_assert_str_eq(set_of(&job, "grid.transfer"), "{flip: 0.98}");
    ck_assert_str_eq(set_of(&job, "time.end"), "0.004");
    brunt_study_job_free(&job);
    brunt_study_free(&s);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(defaults) {
    brunt_study s;
    read_good("brunt_study: 1\nscene: scenes/blocks.yaml\naxes: {k: {key: grid.kernel, values: [linear, cubic]}}\n"
              "measures: {length: {reference: 12 mm}}\n",
              &s);
    ck_assert_int_eq(s.threads, 1);
    ck_assert_int_eq(s.repeats, 3);
    NEAR(s.time_limit, 3600);
    ck_assert_int_eq(s.resolution, -1);
    ck_assert_int_eq(s.accuracy_count, 3);
    NEAR(s.accuracies[1], 0.03);
    NEAR(s.measures[0].exact, 0.012);
    ck_assert_int_eq(s.line_count, 2);
    brunt_study_free(&s);
    ck_assert_int_eq(read_file("/nonexistent/study.yaml", &s), BRUNT_IO_ERROR);
    ck_assert_ptr_nonnull(strstr(messages, "/nonexistent/study.yaml: cannot be read: "));
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(reference) {
    char *text = NULL, line[160];
    size_t length;
    FILE *out = open_memstream(&text, &length);
    ck_assert(brunt_scene_keys("study", out));
    fclose(out);
    for (int i = 0; i < *brunt_study_format.row_count; i++) {
        snprintf(line, sizeof line, "\n  %s ", brunt_study_format.rows[i].path);
        ck_assert_msg(strstr(text, line) != NULL, "%s is not in the reference", brunt_study_format.rows[i].path);
    }
    // Its example is one, of the example of scenes.
    char *scene = NULL;
    out = open_memstream(&scene, &length);
    brunt_scene_keys(NULL, out);
    fclose(out);
    *strstr(scene, "\n\n") = 0;
    *strstr(text, "\n\n") = 0;
    brunt_study s;
    write_text("ball.yaml", scene);
    read_good(text, &s);
    ck_assert_int_eq(s.case_count, 8);
    brunt_study_free(&s);
    free(scene);
    free(text);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- mistakes

static void check_bad(const char *path, const char *text) {
    brunt_study s;
    const char *name = strrchr(path, '/') + 1;
    int status = read_file(path, &s);
    ck_assert_msg(status == BRUNT_BAD_INPUT, "%s: status %d", name, status);
    small_expect_mistakes(name, path, text, messages);
}

START_TEST(broken) {
    const char *source = getenv("BRUNT_SOURCE");
    char path[1024], folder_path[900];
    snprintf(folder_path, sizeof folder_path, "%s/tests/bad_studies", source ? source : ".");
    DIR *folder = opendir(folder_path);
    ck_assert_msg(folder != NULL, "%s", folder_path);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (!strstr(entry->d_name, ".yaml")) continue;
        snprintf(path, sizeof path, "%s/%.100s", folder_path, entry->d_name);
        long size;
        char *text = small_read(path, &size);
        check_bad(path, text);
        free(text);
        count++;
    }
    closedir(folder);
    ck_assert_int_ge(count, 55);
}
END_TEST

// ---------------------------------------------------------------------------------------------------- running

static const char small_study[] =
    "brunt_study: 1\n"
    "scene: scenes/blocks.yaml\n"
    "set: {output.every: 2 ms}\n"
    "repeats: 2\n"
    "axes:\n"
    "  transfer: {values: {APIC: {grid.transfer: apic}, PIC slow: {grid.transfer: pic}}}\n"
    "  h: {key: grid.cell, values: [0.1 m, 50 mm], role: resolution}\n"
    "measures: {length: {}, kept: {reference: finest}}\n";

static const char *program(void) {
    const char *path = getenv("BRUNT");
    ck_assert_msg(path != NULL, "BRUNT must name the program");
    return path;
}

static char *console;

// Runs the study file in the folder into "out".
static int run_study(brunt_study *study, bool fresh, brunt_error *error) {
    size_t length;
    int status = read_file(small_path("study.yaml"), study);
    ck_assert_msg(status == BRUNT_OK, "%s", messages);
    free(console);
    console = NULL;
    FILE *out = open_memstream(&console, &length);
    const brunt_study_options options = {
        .folder = small_path("out"), .program = program(), .fresh = fresh, .console = out};
    status = brunt_study_run(study, &options, error);
    fclose(out);
    return status;
}

static int run_good(brunt_study *study, bool fresh) {
    brunt_error error = {0};
    int status = run_study(study, fresh, &error);
    ck_assert_msg(status == BRUNT_OK, "%s\n%s", error.message, console);
    int runs = 0; // a line that begins with [ is a run that was made
    for (const char *p = console; *p; p += strcspn(p, "\n") + 1) runs += *p == '[';
    return runs;
}

static char *file_text(const char *name) {
    long size;
    return small_read(small_path(name), &size); // free()
}

static bool exists(const char *name) { return access(small_path(name), F_OK) == 0; }

START_TEST(results) {
    brunt_study s;
    write_text("study.yaml", small_study);
    ck_assert_int_eq(run_good(&s, false), 8);
    for (int32_t c = 0; c < s.case_count; c++) {
        const brunt_study_case *k = &s.cases[c];
        ck_assert_int_eq(k->status, BRUNT_STUDY_DONE);
        ck_assert_int_eq(k->runs, 2);
        ck_assert(k->wall_least > 0 && k->wall_least <= k->wall_median && k->wall_median <= k->wall_greatest);
        NEAR(k->wall_median, 0.5 * (k->wall[0] + k->wall[1]));
        ck_assert(k->steps > 2 && k->peak_bytes > 1e6);
        // Four particles a cell in both bodies: 25 cells of 0.1 m, 100 of 50 mm.
        ck_assert_double_eq(k->units, k->value[1] == 0 ? 200 : 800);
        // 4 ms of free flight: the length stays.
        ck_assert(fabs(k->result[0] - 0.5) < 1e-5 && k->expect[0] == 0.5);
        ck_assert_str_eq(k->unit[0], "m");
        ck_assert(k->error[0] < 2e-5 && k->error[0] >= 0);
    }
    ck_assert(exists("out/runs/APIC,0.1_m.r1/summary.json") && exists("out/runs/APIC,0.1_m.r1/scene.yaml"));
    ck_assert(exists("out/runs/PIC_slow,50_mm.r2/run.json") && exists("out/runs/PIC_slow,50_mm.r2/log.txt"));
    static const char *const gone[] = {"vtu", "brunt.pvd", "history.h5", "history.csv", "checkpoint.h5"};
    for (size_t g = 0; g < sizeof gone / sizeof *gone; g++) {
        char name[80];
        snprintf(name, sizeof name, "out/runs/APIC,50_mm.r1/%s", gone[g]);
        ck_assert_msg(!exists(name), "%s", name);
    }
    brunt_study_free(&s);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(tables) {
    brunt_study s;
    write_text("study.yaml", small_study);
    run_good(&s, false);
    char *csv = file_text("out/study.csv");
    const char *head =
        "line,transfer,h,h_si,status,reason,steps,units,wall_median_s,wall_least_s,wall_most_s,peak_bytes,"
        "length,length_unit,length_error,length_front,kept,kept_unit,kept_error,kept_front\n";
    ck_assert_msg(strncmp(csv, head, strlen(head)) == 0, "%s", csv);
    ck_assert_ptr_nonnull(strstr(csv, "\nAPIC,APIC,0.1 m,0.1,done,,"));
    ck_assert_ptr_nonnull(strstr(csv, "\nPIC slow,PIC slow,50 mm,0.05,done,,"));
    int lines = 0;
    for (const char *p = csv; *p; p++) lines += *p == '\n';
    ck_assert_int_eq(lines, 5);
    free(csv);
    json_error_t error;
    json_t *root = json_load_file(small_path("out/study.json"), JSON_REJECT_DUPLICATES, &error);
    ck_assert_msg(root != NULL, "%s", error.text);
    json_t *cases = json_object_get(root, "cases"), *lines_of = json_object_get(root, "lines");
    ck_assert_uint_eq(json_array_size(cases), 4);
    ck_assert_uint_eq(json_array_size(lines_of), 2);
    ck_assert_uint_eq(json_array_size(json_object_get(root, "axes")), 2);
    json_t *third = json_array_get(cases, 3);
    ck_assert_str_eq(json_string_value(json_object_get(json_object_get(third, "values"), "h")), "50 mm");
    ck_assert_int_eq(json_integer_value(json_object_get(third, "line")), 1);
    ck_assert_uint_eq(json_array_size(json_object_get(third, "wall_s")), 2);
    json_t *length = json_object_get(json_object_get(third, "measures"), "length");
    ck_assert_double_eq(json_number_value(json_object_get(length, "value")), s.cases[3].result[0]);
    ck_assert_double_eq(json_number_value(json_object_get(length, "error")), s.cases[3].error[0]);
    ck_assert_double_eq(json_number_value(json_object_get(length, "reference")), 0.5);
    json_decref(root);
    ck_assert(exists("out/report.md") && exists("out/study.gp"));
    brunt_study_free(&s);
}
END_TEST

// Without gnuplot from here on: its pictures take longer than these studies.
static void no_pictures(void) { setenv("PATH", "/nonexistent", 1); }

START_TEST(goes_on) {
    brunt_study first, again;
    no_pictures();
    write_text("study.yaml", small_study);
    ck_assert_int_eq(run_good(&first, false), 8);
    ck_assert_int_eq(run_good(&again, false), 0);
    for (int32_t c = 0; c < first.case_count; c++) {
        ck_assert_double_eq(first.cases[c].wall_median, again.cases[c].wall_median);
        ck_assert_double_eq(first.cases[c].result[1], again.cases[c].result[1]);
    }
    brunt_study_free(&again);
    // A folder without its record was cut off: this one run is made again.
    ck_assert_int_eq(unlink(small_path("out/runs/APIC,0.1_m.r2/run.json")), 0);
    ck_assert_int_eq(run_good(&again, false), 1);
    brunt_study_free(&again);
    // Another value of one axis: the others' runs are kept.
    char *text = strdup(small_study), *at = strstr(text, "50 mm");
    memcpy(at, "40 mm", 5);
    write_text("study.yaml", text);
    ck_assert_int_eq(run_good(&again, false), 4);
    brunt_study_free(&again);
    free(text);
    // Another scene: all are run again. What is no part of the study stays, also when it begins afresh.
    write_text("study.yaml", small_study);
    text = strdup(scene_text);
    at = strstr(text, "1 MPa");
    memcpy(at, "2 MPa", 5);
    write_text("scenes/blocks.yaml", text);
    free(text);
    write_text("out/runs/APIC,0.1_m.r1/note.txt", "mine");
    ck_assert_int_eq(run_good(&again, false), 8);
    brunt_study_free(&again);
    ck_assert_int_eq(run_good(&again, true), 8);
    brunt_study_free(&again);
    ck_assert(exists("out/runs/APIC,0.1_m.r1/note.txt"));
    ck_assert(!exists("out/runs/APIC,40_mm.r1"));
    brunt_study_free(&first);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

// A run that fails by its own, one that does not start and one that takes too long are results.
START_TEST(failures) {
    brunt_study s;
    no_pictures();
    write_text("study.yaml", "brunt_study: 1\n"
                             "scene: scenes/blocks.yaml\n"
                             "repeats: 2\n"
                             "time_limit: 1.5 s\n"
                             "axes:\n"
                             "  case:\n"
                             "    values:\n"
                             "      good: {grid.cell: 0.1}\n"
                             "      strict: {time.least_step: 1 s}\n"
                             "      nowhere: {output.probes: {p: {body: left, point: [0, 0], field: colour}}}\n"
                             "      slow: {time.end: 1000 s, time.cfl: 0.001, time.cfl_: 1}\n"
                             "measures: {length: {}}\n");
    brunt_study bad;
    ck_assert_int_eq(read_file(small_path("study.yaml"), &bad), BRUNT_BAD_INPUT);
    ck_assert_ptr_nonnull(strstr(messages, "axes.case.values.slow"));
    char *text = file_text("study.yaml");
    memcpy(strstr(text, ", time.cfl_: 1"), "              ", 14);
    write_text("study.yaml", text);
    free(text);
    ck_assert_int_eq(run_good(&s, false), 5);
    ck_assert_int_eq(s.cases[0].status, BRUNT_STUDY_DONE);
    static const char *const reasons[] = {"", "step", "colour", "not done after 1.5 s"};
    for (int32_t c = 1; c < 4; c++) {
        ck_assert_int_eq(s.cases[c].status, BRUNT_STUDY_FAILED);
        ck_assert_msg(strstr(s.cases[c].reason, reasons[c]) != NULL, "%s", s.cases[c].reason);
        ck_assert(isnan(s.cases[c].error[0]));
    }
    brunt_study_free(&s);
    ck_assert_int_eq(run_good(&s, false), 0); // failures too are taken over
    ck_assert_ptr_nonnull(strstr(s.cases[3].reason, "not done after 1.5 s"));
    brunt_study_free(&s);
    // One that was cut off gets another chance when it is given more time.
    text = file_text("study.yaml");
    memcpy(strstr(text, "1.5 s"), "2.0 s", 5);
    write_text("study.yaml", text);
    free(text);
    ck_assert_int_eq(run_good(&s, false), 1);
    ck_assert_ptr_nonnull(strstr(s.cases[3].reason, "not done after 2"));
    char *csv = file_text("out/study.csv");
    const char *row = "\nslow,slow,failed,\"not done after 2 s, the time limit of a run\",,,,,,,,,,0\n";
    ck_assert_msg(strstr(csv, row) != NULL, "%s", csv);
    free(csv);
    brunt_study_free(&s);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

// A program that gives other bits each time.
START_TEST(promise) {
    brunt_study s;
    brunt_error error = {0};
    char script[1024];
    snprintf(script, sizeof script,
             "#!/bin/sh\n'%s' \"$@\" || exit 1\nwhile [ \"$1\" != -o ]; do shift; done\n"
             "sed -i \"s/\\\"state_hash\\\": \\\"0x[0-9a-f]*/\\\"state_hash\\\": \\\"0x$$/\" \"$2/summary.json\"\n",
             program());
    write_text("other", script);
    ck_assert_int_eq(chmod(small_path("other"), 0755), 0);
    write_text("study.yaml", "brunt_study: 1\nscene: scenes/blocks.yaml\nrepeats: 3\n"
                             "axes: {build: {values: {this: {grid.cell: 0.1}, other: {program: other}}}}\n"
                             "measures: {length: {}}\n");
    ck_assert_int_eq(run_study(&s, false, &error), BRUNT_FAILED);
    ck_assert_ptr_nonnull(strstr(error.message, "different bits"));
    ck_assert_int_eq(s.cases[0].status, BRUNT_STUDY_DONE);
    ck_assert_int_eq(s.cases[1].status, BRUNT_STUDY_FAILED);
    ck_assert_msg(strstr(s.cases[1].reason, "repeat 2 ended in another state") != NULL, "%s", s.cases[1].reason);
    brunt_study_free(&s);
}
END_TEST

static int command(const char *arguments) {
    char text[1024];
    snprintf(text, sizeof text, "cd '%s' && '%s' %s > output 2>&1", small_folder, program(), arguments);
    int status = system(text);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

START_TEST(from_the_command_line) {
    write_text("study.yaml", small_study);
    ck_assert_int_eq(command("study study.yaml -o there -t 2"), 0);
    char *text = file_text("output");
    ck_assert_ptr_nonnull(strstr(text, "[8 of 8] PIC slow, h = 50 mm, repeat 2 of 2: error "));
    ck_assert_ptr_nonnull(strstr(text, "results are in there: "));
    free(text);
    json_t *summary = json_load_file(small_path("there/runs/APIC,0.1_m.r1/summary.json"), 0, NULL);
    ck_assert_int_eq(json_integer_value(json_object_get(summary, "threads")), 2);
    ck_assert(json_number_value(json_object_get(summary, "step_s")) > 0);
    json_decref(summary);
    ck_assert_int_eq(command("study study.yaml -q"), 0);
    text = file_text("output");
    ck_assert_str_eq(text, "");
    free(text);
    ck_assert(exists("out/study/study/study.csv"));
    ck_assert_int_eq(command("study scenes/blocks.yaml"), BRUNT_BAD_INPUT);
    ck_assert_int_eq(command("study"), BRUNT_BAD_USAGE);
    ck_assert_int_eq(command("study nowhere.yaml"), BRUNT_IO_ERROR);
    ck_assert_int_eq(command("run scenes/blocks.yaml --fresh --resume"), BRUNT_BAD_USAGE);
}
END_TEST

static void wait_seconds(double seconds) {
    struct timespec time = {(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
    nanosleep(&time, NULL);
}

// SIGTERM in the second case, which would take minutes: its run goes with it, the first case is kept.
START_TEST(interrupted) {
    write_text("study.yaml", "brunt_study: 1\nscene: scenes/blocks.yaml\nrepeats: 1\n"
                             "axes: {end: {key: time.end, values: [4 ms, 1000 s]}}\nmeasures: {length: {}}\n");
    pid_t child = fork();
    if (child == 0) {
        ck_assert_int_eq(chdir(small_folder), 0);
        ck_assert_ptr_nonnull(freopen("output", "w", stdout));
        ck_assert_ptr_nonnull(freopen("errors", "w", stderr));
        execl(program(), program(), "study", "study.yaml", "-o", "out", (char *)NULL);
        _exit(127);
    }
    int status = 0;
    pid_t ended = 0;
    while (!exists("out/runs/1000_s.r1/scene.yaml") && !ended)
        wait_seconds(0.01), ended = waitpid(child, &status, WNOHANG);
    ck_assert_int_eq(ended, 0);
    kill(child, SIGTERM);
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    ck_assert(WIFEXITED(status));
    ck_assert_int_eq(WEXITSTATUS(status), BRUNT_STOPPED);
    char *errors = file_text("errors");
    ck_assert_ptr_nonnull(strstr(errors, "go on with the same command"));
    free(errors);
    ck_assert(!exists("out/runs/1000_s.r1") && exists("out/runs/4_ms.r1/run.json") && !exists("out/study.csv"));
}
END_TEST

// What is shipped, and the pair of files that the README has one type.
START_TEST(shipped_studies_are_read) {
    const char *source = getenv("BRUNT_SOURCE");
    ck_assert_ptr_nonnull(source);
    char path[1200];
    snprintf(path, sizeof path, "%s/bench/studies", source);
    DIR *folder = opendir(path);
    ck_assert_ptr_nonnull(folder);
    int read = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || strcmp(dot, ".yaml")) continue;
        brunt_study study;
        snprintf(path, sizeof path, "%s/bench/studies/%s", source, entry->d_name);
        ck_assert_msg(brunt_study_read(path, &study, stderr) == BRUNT_OK, "%s", path);
        ck_assert_int_gt(study.case_count, 1);
        brunt_study_free(&study);
        read++;
    }
    closedir(folder);
    ck_assert_int_ge(read, 11);
}
END_TEST

// The first YAML block of the README from a line that starts with `start` on, as a file of the small folder.
static void take_from_readme(const char *start, const char *name) {
    char path[1200], line[512], text[8192] = "";
    snprintf(path, sizeof path, "%s/README.md", getenv("BRUNT_SOURCE"));
    FILE *readme = fopen(path, "r");
    ck_assert_ptr_nonnull(readme);
    bool block = false, found = false;
    while (fgets(line, sizeof line, readme)) {
        if (block && !strncmp(line, start, strlen(start))) found = true;
        if (block && !strncmp(line, "```", 3)) {
            if (found) break;
            block = false, text[0] = 0;
        } else if (!block && !strcmp(line, "```yaml\n")) {
            block = true, text[0] = 0;
        } else if (block) {
            strcat(text, line);
        }
    }
    fclose(readme);
    ck_assert_msg(found, "no block with '%s'", start);
    small_write(small_path(name), text, (long)strlen(text));
}

START_TEST(the_study_of_the_readme) {
    take_from_readme("title: A ball falls on a floor", "drop.yaml");
    take_from_readme("title: The ball, cells and transfers", "drop_study.yaml");
    brunt_study study;
    char path[1024];
    snprintf(path, sizeof path, "%s", small_path("drop_study.yaml"));
    ck_assert_int_eq(brunt_study_read(path, &study, stderr), BRUNT_OK);
    ck_assert_int_eq(study.case_count, 6);
    ck_assert_int_eq(study.line_count, 2);
    brunt_study_free(&study);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("study");
    TCase *tcase = tcase_create("study");
    tcase_set_timeout(tcase, 0);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, whole_file);
    tcase_add_test(tcase, shipped_studies_are_read);
    tcase_add_test(tcase, the_study_of_the_readme);
    tcase_add_test(tcase, measures_and_cases);
    tcase_add_test(tcase, jobs);
    tcase_add_test(tcase, defaults);
    tcase_add_test(tcase, reference);
    tcase_add_test(tcase, broken);
    tcase_add_test(tcase, results);
    tcase_add_test(tcase, tables);
    tcase_add_test(tcase, goes_on);
    tcase_add_test(tcase, failures);
    tcase_add_test(tcase, promise);
    tcase_add_test(tcase, from_the_command_line);
    tcase_add_test(tcase, interrupted);
    suite_add_tcase(suite, tcase);
    return suite_main(suite);
}
