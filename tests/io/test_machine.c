// Stored benchmarks of a machine: what is read, what is refused and where, and the figures between those stored.
#include "tests/support/small_scene.h"

#include <math.h>
#include <unistd.h>

#include "base/simd.h"
#include "io/performance/machine.h"

static const char head[] = "# processor: Some Processor 7\n"
                           "# cores: 2\n"
                           "kind,name,units,threads,figure,unit,median,least,rounds\n";

static int load(const char *rows, brunt_machine *machine, brunt_error *error) {
    char text[4096];
    snprintf(text, sizeof text, "%s%s", head, rows);
    small_write(small_path("machine.csv"), text, (long)strlen(text));
    setenv("BRUNT_MACHINE", small_path("machine.csv"), 1);
    return brunt_machine_load(machine, error);
}

static void load_good(const char *rows, brunt_machine *machine) {
    brunt_error error = {0};
    int status = load(rows, machine, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
}

START_TEST(rows_are_read) {
    brunt_machine machine;
    load_good("roofline,machine,0,1,bandwidth,GB/s,12.5,13,5\n"
              "\n"
              "particles,3d quadratic apic neo-hookean,250047,2,step,ns/particle,40.25,39.5,3\r\n",
              &machine);
    ck_assert_str_eq(machine.processor, "Some Processor 7");
    ck_assert_int_eq(machine.row_count, 2);
    const brunt_machine_row *row = &machine.rows[1];
    ck_assert_str_eq(row->kind, "particles");
    ck_assert_str_eq(row->name, "3d quadratic apic neo-hookean");
    ck_assert(row->units == 250047 && row->threads == 2);
    ck_assert_str_eq(row->figure, "step");
    ck_assert_str_eq(row->unit, "ns/particle");
    ck_assert(row->median == 40.25 && row->least == 39.5 && row->rounds == 3);
    brunt_machine_free(&machine);
    ck_assert_ptr_null(machine.rows);
}
END_TEST

// The logarithm of the units is what lies evenly: 20 is half-way from 10 to 40.
START_TEST(figures_between_and_beyond) {
    brunt_machine m;
    load_good("growth,hex8,40,1,step,ns/element,5,4,3\n"
              "growth,hex8,10,1,step,ns/element,3,2,3\n"
              "growth,hex8,160,1,step,ns/element,9,8,3\n"
              "growth,hex8,160,1,kick,ns/element,77,8,3\n"
              "growth,tet4,20,1,step,ns/element,88,8,3\n"
              "elements,hex8,20,1,step,ns/element,99,8,3\n",
              &m);
    ck_assert_double_eq_tol(brunt_machine_figure(&m, "growth", "hex8", "step", 20, 1), 4, 1e-12);
    ck_assert_double_eq_tol(brunt_machine_figure(&m, "growth", "hex8", "step", 80, 1), 7, 1e-12);
    ck_assert_double_eq(brunt_machine_figure(&m, "growth", "hex8", "step", 40, 1), 5);
    ck_assert_double_eq(brunt_machine_figure(&m, "growth", "hex8", "step", 10, 1), 3);
    ck_assert_double_eq(brunt_machine_figure(&m, "growth", "hex8", "step", 0, 1), 3);
    ck_assert_double_eq(brunt_machine_figure(&m, "growth", "hex8", "step", 1e9, 1), 9);
    ck_assert_double_eq(brunt_machine_figure(&m, "elements", "hex8", "step", 1e3, 1), 99);
    ck_assert_double_nan(brunt_machine_figure(&m, "growth", "hex8", "drift", 20, 1));
    ck_assert_double_nan(brunt_machine_figure(&m, "growth", "quad4", "step", 20, 1));
    ck_assert_double_nan(brunt_machine_figure(&m, "contact", "hex8", "step", 20, 1));
    brunt_machine_free(&m);
}
END_TEST

// Two bodies of material points, each at the cost of its size; nothing stored of a kernel: no figure.
START_TEST(a_step_by_what_is_stored) {
    brunt_machine m;
    brunt_scene scene;
    brunt_error error = {0};
    small_scene_of(small_scene_text, &scene, NULL, 0);
    scene.world.threads = 1;
    brunt_world *world = brunt_world_create(&scene.world, &error);
    ck_assert_msg(world != NULL, "%s", error.message);
    char rows[256];
    snprintf(rows, sizeof rows,
             "growth,%dd quadratic apic neo-hookean,10,1,step,ns/particle,50,50,3\n"
             "particles,%dd quadratic apic neo-hookean,10,1,step,ns/particle,99,99,3\n",
             scene.world.dimension, scene.world.dimension);
    load_good(rows, &m);
    ck_assert_double_eq_tol(brunt_machine_step(&m, &scene.world, world), 50e-9 * (double)brunt_world_particles(world),
                            1e-18);
    scene.world.kernel = BRUNT_CUBIC;
    ck_assert(isnan(brunt_machine_step(&m, &scene.world, world)));
    brunt_machine_free(&m);
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
}
END_TEST

START_TEST(figures_of_the_nearest_threads) {
    brunt_machine m;
    load_good("growth,hex8,10,8,step,ns/element,1,1,3\n"
              "growth,hex8,10,1,step,ns/element,6,6,3\n"
              "growth,hex8,10,4,step,ns/element,2,2,3\n"
              "growth,hex8,1000,4,step,ns/element,3,2,3\n"
              "growth,tet4,10,5,step,ns/element,50,6,3\n"
              "roofline,machine,0,2,bandwidth,GB/s,17,18,3\n",
              &m);
    ck_assert_double_eq(brunt_machine_figure(&m, "growth", "hex8", "step", 10, 1), 6);
    ck_assert_double_eq(brunt_machine_figure(&m, "growth", "hex8", "step", 10, 2), 6);
    ck_assert_double_eq(brunt_machine_figure(&m, "growth", "hex8", "step", 10, 3), 2);
    ck_assert_double_eq(brunt_machine_figure(&m, "growth", "hex8", "step", 10, 5), 2);
    ck_assert_double_eq_tol(brunt_machine_figure(&m, "growth", "hex8", "step", 100, 5), 2.5, 1e-12);
    ck_assert_double_eq(brunt_machine_figure(&m, "growth", "hex8", "step", 10, 6), 2); // as far from 4 as from 8
    ck_assert_double_eq(brunt_machine_figure(&m, "growth", "hex8", "step", 1000, 64), 1);
    ck_assert_double_eq(brunt_machine_figure(&m, "roofline", "machine", "bandwidth", 0, 1), 17);
    ck_assert_double_eq(brunt_machine_figure(&m, "roofline", "machine", "bandwidth", 1e6, 1), 17);
    brunt_machine_free(&m);
}
END_TEST

START_TEST(bad_rows_are_refused_with_their_line) {
    static const struct {
        const char *row, *said;
    } cases[] = {
        {"growth,hex8,10,1,step,ns/element,3,2\n", ":5: 8 fields instead of 9"},
        {"growth,hex8,10,1,step,ns/element,3,2,3,4\n", ":5: 10 fields instead of 9"},
        {"growth,hex8,ten,1,step,ns/element,3,2,3\n", ":5: units is to be a number from 0 on, not 'ten'"},
        {"growth,hex8,-1,1,step,ns/element,3,2,3\n", ":5: units is to be a number from 0 on, not '-1'"},
        {"growth,hex8,10,0,step,ns/element,3,2,3\n", ":5: threads is to be a number from 1 on, not '0'"},
        {"growth,hex8,10,1.5,step,ns/element,3,2,3\n", ":5: a whole number is wanted, not '1.5'"},
        {"growth,hex8,10,1,step,ns/element,nan,2,3\n", ":5: median is to be a number from 0 on, not 'nan'"},
        {"growth,hex8,10,1,step,ns/element,3,inf,3\n", ":5: least is to be a number from 0 on, not 'inf'"},
        {"growth,hex8,10,1,step,ns/element,3 ns,2,3\n", ":5: median is to be a number from 0 on, not '3 ns'"},
        {"growth,hex8,10,1,step,ns/element,3,2,\n", ":5: rounds is to be a number from 1 on, not ''"},
        {"growth,,10,1,step,ns/element,3,2,3\n", ":5: name is to have 1 to 95 characters, not ''"},
        {"a-kind-of-more-than-thirty-one-letters,hex8,10,1,step,ns,3,2,3\n", ":5: kind is to have 1 to 31 characters"},
        {"elements,hex8,10,1,step,ns/element,4,4,5\n", ":5: a figure for the second time: 'hex8'"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char rows[512];
        brunt_machine machine;
        brunt_error error = {0};
        snprintf(rows, sizeof rows, "elements,hex8,10,1,step,ns/element,3,2,3\n%s", cases[k].row);
        ck_assert_msg(load(rows, &machine, &error) == BRUNT_BAD_INPUT, "%s", cases[k].row);
        ck_assert_msg(strstr(error.message, cases[k].said) != NULL, "'%s' has no '%s'", error.message, cases[k].said);
        ck_assert_ptr_null(machine.rows);
        ck_assert_int_eq(machine.row_count, 0);
    }
}
END_TEST

// Each is another one by its kind, name, units, threads or figure; any of them is known again.
START_TEST(many_rows) {
    enum { ROWS = 5000, ROW = 64 };
    static const char *const kinds[] = {"growth", "elements"}, *const names[] = {"hex8", "tet4", "quad4"},
                             *const figures[] = {"step", "kick", "drift", "forces"};
    char *rows = malloc(sizeof head + (size_t)ROWS * ROW), *repeated = malloc(sizeof head + (size_t)ROWS * ROW + ROW);
    int length = snprintf(rows, sizeof head, "%s", head), start[ROWS];
    for (int k = 0; k < ROWS; k++) {
        start[k] = length;
        length += snprintf(rows + length, ROW, "%s,%s,%d,%d,%s,ns,%d,1,3\n", kinds[k % 2], names[k / 2 % 3], k / 48,
                           1 + k / 24 % 2, figures[k / 6 % 4], k);
    }
    const char *path = small_path("machine.csv");
    brunt_machine machine;
    brunt_error error = {0};
    setenv("BRUNT_MACHINE", path, 1);
    small_write(path, rows, length);
    ck_assert_msg(brunt_machine_load(&machine, &error) == BRUNT_OK, "%s", error.message);
    ck_assert_int_eq(machine.row_count, ROWS);
    for (int k = 0; k < ROWS; k++) ck_assert_double_eq(machine.rows[k].median, k);
    brunt_machine_free(&machine);
    for (int k = 0; k < ROWS; k += 499) {
        const int size = snprintf(repeated, sizeof head + (size_t)ROWS * ROW + ROW, "%s%.*s", rows,
                                  (int)strcspn(rows + start[k], "\n"), rows + start[k]);
        small_write(path, repeated, size);
        ck_assert_int_eq(brunt_machine_load(&machine, &error), BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, ":5004: a figure for the second time") != NULL, "%s", error.message);
    }
    free(rows), free(repeated);
}
END_TEST

START_TEST(files_that_are_none) {
    brunt_machine machine;
    brunt_error error = {0};
    const char *path = small_path("other.csv");
    ck_assert_int_eq(load("", &machine, &error), BRUNT_BAD_INPUT);
    ck_assert_ptr_nonnull(strstr(error.message, "no figures"));
    setenv("BRUNT_MACHINE", path, 1);
    ck_assert_int_eq(brunt_machine_load(&machine, &error), BRUNT_IO_ERROR);
    ck_assert_ptr_nonnull(strstr(error.message, "other.csv"));
    static const char others[][64] = {"time [s],energy [J]\n0,1\n", "", "# processor: x\n"};
    for (int k = 0; k < 3; k++) {
        small_write(path, others[k], (long)strlen(others[k]));
        ck_assert_int_eq(brunt_machine_load(&machine, &error), BRUNT_BAD_INPUT);
    }
    static const char zero[] = "# proc\0essor: x\n";
    small_write(path, zero, sizeof zero - 1);
    ck_assert_int_eq(brunt_machine_load(&machine, &error), BRUNT_BAD_INPUT);
    ck_assert_ptr_nonnull(strstr(error.message, ":1: a zero byte"));
}
END_TEST

// The name is a file's: no blanks, no capitals, no brand's signs; with the number of processors.
START_TEST(name_of_this_machine) {
    char name[128], end[32];
    brunt_machine_name(name);
    ck_assert_uint_eq(strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789-"), strlen(name));
    snprintf(end, sizeof end, "-%ld", sysconf(_SC_NPROCESSORS_ONLN));
#ifdef BRUNT_FLOAT
    strcat(end, "-float");
#endif
    ck_assert_uint_gt(strlen(name), strlen(end));
    ck_assert_str_eq(name + strlen(name) - strlen(end), end);
}
END_TEST

// Whatever lies in bench/machines can be read, and its name is as it says.
START_TEST(without_a_name_the_stored_one) {
    brunt_machine machine;
    brunt_error error = {0};
    char name[128];
    brunt_machine_name(name);
    unsetenv("BRUNT_MACHINE");
    int status = brunt_machine_load(&machine, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    if (machine.row_count) {
        ck_assert_int_eq(machine.lanes, BRUNT_LANES);
        ck_assert_ptr_nonnull(strstr(machine.path, name));
        ck_assert_str_ne(machine.processor, "");
    } else {
        ck_assert_str_eq(machine.path, "");
    }
    brunt_machine_free(&machine);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("machine");
    TCase *all = tcase_create("all");
    tcase_add_checked_fixture(all, small_folder_make, small_folder_remove);
    tcase_add_test(all, rows_are_read);
    tcase_add_test(all, figures_between_and_beyond);
    tcase_add_test(all, a_step_by_what_is_stored);
    tcase_add_test(all, figures_of_the_nearest_threads);
    tcase_add_test(all, bad_rows_are_refused_with_their_line);
    tcase_add_test(all, many_rows);
    tcase_add_test(all, files_that_are_none);
    tcase_add_test(all, name_of_this_machine);
    tcase_add_test(all, without_a_name_the_stored_one);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
