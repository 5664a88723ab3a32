// Files that were made to be read wrongly: with checksums that fit and contents that no run has written. A message and
// an exit code.
#include "tests/support/small_program.h"

#include <hdf5.h>
#include <libdeflate.h>
#include <sys/stat.h>

static void set_up(void) {
    small_folder_make();
    small_put("small.yaml", small_scene_text);
    small_expect("run small.yaml -q -t 1 -o whole --set time.end='20 ms'", 0, NULL);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

// Length and checksum in front of the file are made to fit it.
static void reseal(const char *path, const char *kind) {
    enum { BLOCK = 512 };
    long size;
    char *bytes = small_read(path, &size);
    ck_assert_int_gt(size, BLOCK);
    int format = 0;
    ck_assert_int_eq(sscanf(bytes, "brunt %*[a-z], format %d", &format), 1);
    memset(bytes, 0, BLOCK);
    snprintf(bytes, BLOCK, "brunt %s, format %d, %zu bytes of HDF5 follow this block of 512, CRC-32 %08lx\n", kind,
             format, (size_t)size - BLOCK, (unsigned long)libdeflate_crc32(0, bytes + BLOCK, (size_t)size - BLOCK));
    small_write(path, bytes, size);
    free(bytes);
}

// A copy of the finished run in "out", its file open.
static hid_t open_copy(const char *name) {
    ck_assert_int_eq(small_shell("rm -rf out && cp -r whole out"), 0);
    hid_t file = H5Fopen(small_path(name), H5F_ACC_RDWR, H5P_DEFAULT);
    ck_assert_int_ge(file, 0);
    return file;
}

// What is wrong must be told at --resume; `info` may read what it can, but ends.
static void expect_refused(hid_t file, const char *name, const char *kind, const char *what, const char *text) {
    ck_assert_msg(H5Fclose(file) >= 0, "%s", what);
    reseal(small_path(name), kind);
    ck_assert_int_eq(small_shell("rm -rf before && cp -r out before"), 0);
    int code = small_shell("$B run small.yaml -q -t 1 -o out --resume > output 2>&1");
    long size;
    char *output = small_read(small_path("output"), &size);
    ck_assert_msg(code == 65, "%s: %d\n%s", what, code, output);
    ck_assert_msg(!text || strstr(output, text), "%s: '%s' is not in\n%s", what, text, output);
    free(output);
    ck_assert_int_eq(small_shell("diff -r out before"), 0);
    code = small_shell("$B info %s > output 2>&1", name);
    ck_assert_msg(code == 0 || code == 65, "info of %s: %d", what, code);
    ck_assert_msg(small_shell("! grep -q -e Sanitizer -e 'runtime error' output") == 0, "info of %s", what);
}

static const hsize_t far = ((hsize_t)1 << 61) - 1; // times 8 bytes it is just below 2^64: one more overflows

typedef struct edit {
    const char *what;
    void (*make)(hid_t file, const char *name);
} edit;

static void extend(hid_t file, const char *name) {
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    ck_assert_int_ge(H5Dset_extent(set, &far), 0);
    H5Dclose(set);
}

static void replace(hid_t file, const char *name, hid_t type, int rank, hid_t creation) {
    const hsize_t size[] = {4, 4}, most[] = {H5S_UNLIMITED, H5S_UNLIMITED};
    ck_assert_int_ge(H5Ldelete(file, name, H5P_DEFAULT), 0);
    hid_t space = H5Screate_simple(rank, size, creation == H5P_DEFAULT ? NULL : most);
    hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    ck_assert_int_ge(set, 0);
    H5Dclose(set);
    H5Sclose(space);
}

static void two_dimensions(hid_t file, const char *name) { replace(file, name, H5T_IEEE_F64LE, 2, H5P_DEFAULT); }
static void no_dimension(hid_t file, const char *name) { replace(file, name, H5T_IEEE_F64LE, 0, H5P_DEFAULT); }
static void other_class(hid_t file, const char *name) { replace(file, name, H5T_STD_U32LE, 1, H5P_DEFAULT); }
static void long_strings(hid_t file, const char *name) {
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    replace(file, name, type, 1, H5P_DEFAULT);
    H5Tclose(type);
}

static void filtered(hid_t file, const char *name) {
    const hsize_t chunk = 4;
    hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(creation, 1, &chunk);
    H5Pset_deflate(creation, 9);
    replace(file, name, H5T_IEEE_F64LE, 1, creation);
    H5Pclose(creation);
}

static void outside(hid_t file, const char *name) {
    const hsize_t size = 4;
    hid_t creation = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(1, &size, NULL);
    ck_assert_int_ge(H5Pset_external(creation, small_path("small.yaml"), 0, 32), 0);
    ck_assert_int_ge(H5Ldelete(file, name, H5P_DEFAULT), 0);
    hid_t set = H5Dcreate2(file, name, !strcmp(name, "/scene") ? H5T_STD_U8LE : H5T_IEEE_F64LE, space, H5P_DEFAULT,
                           creation, H5P_DEFAULT);
    ck_assert_int_ge(set, 0);
    H5Dclose(set), H5Sclose(space), H5Pclose(creation);
}

static void external_link(hid_t file, const char *name) {
    ck_assert_int_ge(H5Ldelete(file, name, H5P_DEFAULT), 0);
    ck_assert_int_ge(H5Lcreate_external(small_path("whole/checkpoint.h5"), name, file, name, H5P_DEFAULT, H5P_DEFAULT),
                     0);
}

static void soft_link(hid_t file, const char *name) {
    ck_assert_int_ge(H5Lmove(file, name, file, "/elsewhere", H5P_DEFAULT, H5P_DEFAULT), 0);
    ck_assert_int_ge(H5Lcreate_soft("/elsewhere", file, name, H5P_DEFAULT, H5P_DEFAULT), 0);
}

static void a_folder(hid_t file, const char *name) {
    ck_assert_int_ge(H5Ldelete(file, name, H5P_DEFAULT), 0);
    H5Gclose(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

static void gone(hid_t file, const char *name) { ck_assert_int_ge(H5Ldelete(file, name, H5P_DEFAULT), 0); }

static const edit edits[] = {{"2^61 - 1 numbers", extend},
                             {"two dimensions", two_dimensions},
                             {"no dimension", no_dimension},
                             {"another class", other_class},
                             {"strings", long_strings},
                             {"another filter", filtered},
                             {"data elsewhere", outside},
                             {"a link to a file", external_link},
                             {"a link", soft_link},
                             {"a folder", a_folder},
                             {"nothing", gone}};
enum { EDITS = sizeof edits / sizeof *edits };

// The first dataset below /state.
static herr_t first_name(hid_t group, const char *name, const H5O_info_t *info, void *out) {
    (void)group;
    if (info->type != H5O_TYPE_DATASET) return 0;
    snprintf(out, 128, "/state/%s", name);
    return 1;
}

START_TEST(checkpoints) {
    char block[128] = "";
    hid_t file = open_copy("out/checkpoint.h5"), state = H5Gopen2(file, "/state", H5P_DEFAULT);
    ck_assert_int_eq(H5Ovisit2(state, H5_INDEX_NAME, H5_ITER_NATIVE, first_name, block, H5O_INFO_BASIC), 1);
    H5Gclose(state), H5Fclose(file);
    const char *const names[] = {"/picture_times", "/scene", block};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        for (int e = 0; e < EDITS; e++) {
            file = open_copy("out/checkpoint.h5");
            edits[e].make(file, names[n]);
            expect_refused(file, "out/checkpoint.h5", "checkpoint", edits[e].what, "checkpoint.h5");
        }
}
END_TEST

static void set_number(hid_t file, const char *name, double value) {
    hid_t attribute = H5Aopen(file, name, H5P_DEFAULT);
    ck_assert_int_ge(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value), 0);
    H5Aclose(attribute);
}

static void set_text(hid_t file, const char *name, const char *value) {
    hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, strlen(value) + 1);
    H5Adelete(file, name);
    hid_t attribute = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    ck_assert_int_ge(H5Awrite(attribute, type, value), 0);
    H5Aclose(attribute), H5Sclose(space), H5Tclose(type);
}

START_TEST(numbers_that_no_run_has) {
    static const struct {
        const char *name;
        double value;
    } numbers[] = {{"step", -1},           {"time", NAN},        {"time", -1},           {"wall_seconds", INFINITY},
                   {"output_seconds", -1}, {"state_blocks", -1}, {"state_blocks", 1e18}, {"lanes", -1}};
    for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++) {
        hid_t file = open_copy("out/checkpoint.h5");
        set_number(file, numbers[n].name, numbers[n].value);
        expect_refused(file, "out/checkpoint.h5", "checkpoint", numbers[n].name, "checkpoint.h5");
    }
    for (int nan = 0; nan < 2; nan++) {
        hid_t file = open_copy("out/checkpoint.h5"), set = H5Dopen2(file, "/picture_times", H5P_DEFAULT);
        const double times[] = {0, nan ? NAN : 0.02, 0.01};
        ck_assert_int_ge(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, times), 0);
        H5Dclose(set);
        expect_refused(file, "out/checkpoint.h5", "checkpoint", "times", "numbers that no run has");
    }
    // Names that would write to the terminal what they like.
    hid_t file = open_copy("out/checkpoint.h5");
    H5Gclose(H5Gcreate2(file, "/\033[2Jgone", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    ck_assert_int_ge(H5Lmove(file, "/picture_times", file, "/\033[2Jgone/x", H5P_DEFAULT, H5P_DEFAULT), 0);
    set_text(file, "reason", "\033[2J");
    expect_refused(file, "out/checkpoint.h5", "checkpoint", "names", NULL);
    ck_assert_int_eq(small_shell("LC_ALL=C; ! $B info out/checkpoint.h5 2>&1 | grep -q \"$(printf '\\033')\""), 0);
}
END_TEST

// Another build would go on with other bits: it is said which.
START_TEST(other_builds_are_named) {
    hid_t file = open_copy("out/checkpoint.h5");
    set_number(file, "lanes", 32);
    set_text(file, "precision", "half");
    expect_refused(file, "out/checkpoint.h5", "checkpoint", "build",
                   "written by a build with 32 lanes in half; this one has ");
}
END_TEST

static long long run_of(const char *name) {
    long long run = 0;
    hid_t file = H5Fopen(small_path(name), H5F_ACC_RDONLY, H5P_DEFAULT), attribute = H5Aopen(file, "run", H5P_DEFAULT);
    ck_assert_int_ge(H5Aread(attribute, H5T_NATIVE_LLONG, &run), 0);
    H5Aclose(attribute);
    H5Fclose(file);
    return run;
}

// Checkpoint and history say of which run they are, in its later legs, too.
START_TEST(files_name_their_run) {
    const long long run = run_of("whole/history.h5");
    ck_assert(run != 0);
    ck_assert_int_eq(run_of("whole/checkpoint.h5"), run);
    small_expect("run small.yaml -q -t 1 -o whole --resume --set time.end='30 ms'", 0, NULL);
    ck_assert_int_eq(run_of("whole/checkpoint.h5"), run);
    ck_assert_int_eq(run_of("whole/history.h5"), run);
}
END_TEST

// A history of another run is not gone on with, whatever its columns are.
START_TEST(histories_of_another_run) {
    static const char *const others[] = {"--set materials.rubber.E='2 MPa'", "--set bodies.left.velocity='[4, 0]'",
                                         "--set grid.cell=0.05"};
    for (size_t o = 0; o < sizeof others / sizeof *others; o++) {
        ck_assert_int_eq(
            small_shell(
                "rm -rf out other && cp -r whole out && $B run small.yaml -q -t 1 -o other --set time.end='20 ms' %s",
                others[o]),
            0);
        ck_assert_int_eq(small_shell("cp other/history.h5 out/"), 0);
        small_expect("run small.yaml -q -t 1 -o out --resume", 65, "history.h5: the history of another run");
        ck_assert_int_eq(small_shell("cp whole/history.h5 out/ && cp other/history.csv out/"), 0);
        small_expect("run small.yaml -q -t 1 -o out --resume", 65, "21 lines are not those of the checkpoint");
        ck_assert_int_eq(small_shell("cp whole/history.csv out/"), 0);
        ck_assert_int_eq(
            small_shell("cmp out/checkpoint.h5 whole/checkpoint.h5 && cmp out/history.csv whole/history.csv"), 0);
    }
    // What may change between legs may: the title, the end, measures, probes.
    ck_assert_int_eq(small_shell("rm -rf out && cp -r whole out"), 0);
    small_expect(
        "run small.yaml -q -t 1 -o out --resume --set title=other --set time.end='30 ms' --set output.probes={}", 0,
        NULL);
}
END_TEST

START_TEST(histories) {
    for (int e = 0; e < EDITS; e++) {
        hid_t file = open_copy("out/history.h5");
        edits[e].make(file, e == EDITS - 1 ? "/time" : "/energy/kinetic");
        H5Fclose(file);
        reseal(small_path("out/history.h5"), "history");
        for (int info = 0; info < 2; info++) {
            int code = info ? small_shell("$B info out/history.h5 > output 2>&1")
                            : small_shell("$B run small.yaml -q -t 1 -o out --resume > output 2>&1");
            ck_assert_msg(code == 0 || code == 65, "%s: %d", edits[e].what, code);
            ck_assert_int_eq(small_shell("! grep -q -e Sanitizer -e 'runtime error' output"), 0);
        }
    }
}
END_TEST

// Cut off, or with a byte of its inside changed, and the checksum made to fit: what HDF5 makes of it is for HDF5, but
// it ends.
START_TEST(damage_under_a_checksum_that_fits) {
    long size;
    char *bytes = small_read(small_path("whole/checkpoint.h5"), &size);
    srand(3);
    for (int i = 0; i < 60; i++) {
        const long at = 512 + rand() % (i < 40 ? 4096 : size - 512);
        const char kept = bytes[at];
        bytes[at] = (char)rand();
        small_write(small_path("checkpoint.h5"), bytes, i % 4 ? size : at + 1);
        bytes[at] = kept;
        reseal(small_path("checkpoint.h5"), "checkpoint");
        // HDF5 loses some memory of its own where it gives such a file up: that is no leak of ours.
        int code = small_shell("ASAN_OPTIONS=detect_leaks=0 $B info checkpoint.h5 > output 2>&1");
        ck_assert_msg(code == 0 || code == 65, "byte %ld: %d", at, code);
    }
    free(bytes);
}
END_TEST

// Pipes that nothing writes to, and devices that never end.
START_TEST(pipes_and_devices_are_no_files) {
    ck_assert_int_eq(mkfifo(small_path("pipe"), 0666), 0);
    static const char *const places[] = {"pipe", "/dev/zero", "/dev/null", "."};
    char text[256];
    for (size_t p = 0; p < sizeof places / sizeof *places; p++) {
        static const char *const commands[] = {"run %s", "check %s", "study %s", "info %s"};
        for (size_t c = 0; c < sizeof commands / sizeof *commands; c++) {
            snprintf(text, sizeof text, commands[c], places[p]);
            small_expect(text, 74, places[p]);
        }
        snprintf(text, sizeof text, "check small.yaml --set bodies.left='{method: fem, material: rubber, mesh: %s}'",
                 places[p]);
        ck_assert_int_ne(small_shell("$B %s > output 2>&1", text), 0);
        small_put("study.yaml", "");
        FILE *study = fopen(small_path("study.yaml"), "w");
        fprintf(study,
                "brunt_study: 1\nscene: %s\naxes: {h: {key: grid.cell, values: [0.1, 0.2]}}\nmeasures: {kept: {}}\n",
                places[p]);
        fclose(study);
        small_shell("$B study study.yaml > output 2>&1; echo $? > code");
        ck_assert_int_eq(small_shell("grep -qx -e 65 -e 74 code"), 0);
    }
    static const char *const files[] = {"checkpoint.h5", "history.h5", "history.csv"};
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        ck_assert_int_eq(small_shell("rm -rf out && cp -r whole out && rm out/%s && mkfifo out/%s", files[f], files[f]),
                         0);
        small_expect("run small.yaml -q -t 1 -o out --resume", 65, files[f]);
    }
}
END_TEST

// What was asked for did not arrive: that is no success.
START_TEST(a_full_output_is_74) {
    static const char *const commands[] = {"check small.yaml --quick",
                                           "info whole/checkpoint.h5",
                                           "info whole/history.h5",
                                           "info whole/brunt.pvd",
                                           "keys",
                                           "keys --schema",
                                           "--help",
                                           "--version",
                                           "run --help"};
    for (size_t c = 0; c < sizeof commands / sizeof *commands; c++)
        ck_assert_msg(small_shell("$B %s > /dev/full 2> errors", commands[c]) == 74, "%s", commands[c]);
    ck_assert_int_eq(small_shell("$B keys > /dev/full 2> errors; grep -q 'standard output cannot be written' errors"),
                     0);
    // A run's results are in its files: it goes on to its end, and says so there.
    ck_assert_int_eq(small_shell("$B run small.yaml -t 1 -o out > /dev/full 2> errors"), 74);
    ck_assert_int_eq(small_shell("grep -qx 'brunt: standard output cannot be written' errors"), 0);
    ck_assert_int_eq(small_shell("grep -q '\"status\": \"done\"' out/summary.json"), 0);
    ck_assert_int_eq(small_shell("$B run small.yaml -q -t 1 -o quiet > /dev/full"), 0);
    // A reader that goes wants no more.
    ck_assert_int_eq(small_shell("{ $B run small.yaml -t 1 -o piped 2> errors; echo $? > code; } | true;"
                                 "test ! -s errors && grep -qx 0 code"),
                     0);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("hostile_files");
    TCase *tcase = tcase_create("hostile files");
    tcase_set_timeout(tcase, 0);
    tcase_add_checked_fixture(tcase, set_up, small_folder_remove);
    tcase_add_test(tcase, checkpoints);
    tcase_add_test(tcase, numbers_that_no_run_has);
    tcase_add_test(tcase, other_builds_are_named);
    tcase_add_test(tcase, files_name_their_run);
    tcase_add_test(tcase, histories_of_another_run);
    tcase_add_test(tcase, histories);
    tcase_add_test(tcase, damage_under_a_checksum_that_fits);
    tcase_add_test(tcase, a_full_output_is_74);
    suite_add_tcase(suite, tcase);
    TCase *pipes = tcase_create("pipes");
    tcase_set_timeout(pipes, 0);
    tcase_add_checked_fixture(pipes, set_up, small_folder_remove);
    tcase_add_test(pipes, pipes_and_devices_are_no_files);
    suite_add_tcase(suite, pipes);
    return suite_main(suite);
}
