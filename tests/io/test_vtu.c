// Pictures are read back with VTK's own reader (Debian package python3-vtk9); a missing reader is a failure, not a
// skip.
#include <check.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <signal.h>
#include <unistd.h>

#include "fem/element.h"
#include "base/memory.h"
#include "io/output/vtu.h"
#include "tests/support/suite.h"

static char folder[64];

static void make_folder(void) {
    strcpy(folder, "/tmp/brunt_vtu_XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void remove_folder(void) {
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    ck_assert_int_eq(system(command), 0);
}

// Runs tests/support/read_vtu.py and returns what it prints; a failure of the script is a failure of the test.
static char *read_back(const char *arguments) {
    const char *source = getenv("BRUNT_SOURCE");
    char command[2048];
    snprintf(command, sizeof command, "/usr/bin/python3 %s/tests/support/read_vtu.py %s 2>&1", source ? source : ".",
             arguments);
    FILE *pipe = popen(command, "r");
    ck_assert_ptr_nonnull(pipe);
    static char text[65536];
    size_t size = fread(text, 1, sizeof text - 1, pipe);
    text[size] = 0;
    int status = pclose(pipe);
    ck_assert_msg(status == 0, "%s\n%s", command, text);
    return text;
}

// The value tests/support/read_vtu.py expects; exact in single precision.
static double pattern(int array, long long i, int component) {
    return array * 1000 + (double)(i % 1013) * 0.5 + component * 0.25;
}

static double *filled(int array, int64_t count, int components) {
    double *values = brunt_alloc(sizeof *values * (size_t)count * (size_t)components);
    ck_assert_ptr_nonnull(values);
    for (int64_t i = 0; i < count; i++)
        for (int c = 0; c < components; c++) values[i * components + c] = pattern(array, i, c);
    return values;
}

static void write_pattern(const char *path, int64_t count, bool float32) {
    int64_t *ids = brunt_alloc(sizeof *ids * (size_t)count);
    for (int64_t i = 0; i < count; i++) ids[i] = i * 3000000000; // beyond 32 bits
    double *points = filled(7, count, 3), *scalar = filled(1, count, 1), *vector = filled(2, count, 3),
           *tensor = filled(3, count, 6), *matrix = filled(4, count, 9);
    const brunt_vtu_array arrays[] = {
        {.name = "id", .components = 1, .integers = ids},
        {.name = "plastic_strain", .unit = "1", .components = 1, .values = scalar},
        {.name = "velocity", .unit = "m/s", .components = 3, .values = vector},
        {.name = "cauchy stress/2", .unit = "kg m^-1 s^-2", .components = 6, .values = tensor},
        {.name = "deformation_gradient", .components = 9, .values = matrix}};
    const brunt_vtu_grid grid = {.point_count = count, .points = points};
    brunt_error error = {0};
    ck_assert_msg(brunt_vtu_write(path, 0.1 + 0.2, &grid, arrays, 5, float32, &error) == BRUNT_OK, "%s", error.message);
    brunt_free(ids);
    brunt_free(points);
    brunt_free(scalar);
    brunt_free(vector);
    brunt_free(tensor);
    brunt_free(matrix);
}

// 65536 floats and 32768 doubles or ids fill one compression block of 262144 bytes exactly; one more and one less do
// not.
static const int64_t counts[] = {0, 1, 100, 32767, 32768, 32769, 65536, 131072, 262144};

// Writes the file of a count and adds its name to what is to be read, and what that is to say.
static void add_pattern(int which, FILE *arguments, FILE *wanted) {
    const int64_t count = counts[which / 2];
    const bool float32 = which % 2 == 0;
    const char *type = float32 ? "float" : "double";
    const long long n = count;
    char path[128];
    snprintf(path, sizeof path, "%s/p%d.vtu", folder, which);
    write_pattern(path, count, float32);
    fprintf(arguments, " %s", path);
    fprintf(wanted,
            "points %lld cells %lld\ntime 0.30000000000000004\nactive plastic_strain velocity\narray id long_long "
            "%lld None\n"
            "array plastic_strain %s %lld None\narray velocity %s %lld X,Y,Z [m/s]\narray cauchy_stress_2 %s "
            "%lld XX,YY,ZZ,XY,YZ,XZ [kg m^-1 s^-2]\n"
            "array deformation_gradient %s %lld XX,XY,XZ,YX,YY,YZ,ZX,ZY,ZZ\n%spattern ok\n",
            n, n, n, type, n, type, n, type, n, type, n, count ? "cell types 1\n" : "");
}

// All that `add` writes, read by one start of the reader, which takes longer than its files.
static void read_all(const char *option, int count, void (*add)(int which, FILE *arguments, FILE *wanted)) {
    char *words, *lines;
    size_t size;
    FILE *arguments = open_memstream(&words, &size), *wanted = open_memstream(&lines, &size);
    fputs(option, arguments);
    for (int i = 0; i < count; i++) add(i, arguments, wanted);
    fclose(arguments), fclose(wanted);
    ck_assert_str_eq(read_back(words), lines);
    free(words), free(lines);
    ck_assert_int_eq((int)brunt_memory_live(), 0);
}

START_TEST(reads_back_whole) { read_all("--pattern", 2 * (int)(sizeof counts / sizeof *counts), add_pattern); }
END_TEST

static uint64_t word_at(const char *at) {
    uint64_t word = 0;
    for (int i = 7; i >= 0; i--) word = word << 8 | (unsigned char)at[i];
    return word;
}

// VTK's reader forgives a block too many; other readers do not. The headers are looked at byte by byte.
START_TEST(block_headers_are_exact) {
    int64_t count = counts[_i];
    char path[128];
    snprintf(path, sizeof path, "%s/p.vtu", folder);
    write_pattern(path, count, true);
    FILE *file = fopen(path, "rb");
    static char bytes[64 << 20];
    size_t size = fread(bytes, 1, sizeof bytes - 1, file);
    fclose(file);
    bytes[size] = 0;
    const int widths[] = {8, 4, 12, 24, 36, 12, 8, 8, 1}; // bytes a particle, in the order of the arrays
    const char *data = strstr(bytes, "<AppendedData");
    ck_assert_ptr_nonnull(data);
    data = strchr(data, '_') + 1;
    size_t offset = 0;
    const char *element = bytes;
    for (size_t a = 0; a < sizeof widths / sizeof *widths; a++) {
        element = strstr(element + 1, "offset=\"");
        ck_assert_ptr_nonnull(element);
        ck_assert_int_eq(atoll(element + 8), (long long)offset);
        uint64_t length = (uint64_t)count * (uint64_t)widths[a], blocks = word_at(data + offset),
                 block = word_at(data + offset + 8);
        ck_assert(blocks == (length + block - 1) / block);
        ck_assert(word_at(data + offset + 16) == length % block);
        size_t next = offset + 8 * (3 + blocks);
        for (uint64_t b = 0; b < blocks; b++) next += word_at(data + offset + 24 + 8 * b);
        offset = next;
    }
    ck_assert_int_eq(strncmp(data + offset, "\n  </AppendedData>", 18), 0);
}
END_TEST

// A strip of elements side by side, in the node order of brunt (which is VTK's): each reads back with its type and a
// positive volume, and the values of nodes and elements stay apart.
static const struct {
    brunt_element_kind kind;
    int vtk_cell;   // number in VTK's file formats
    bool flat;      // has an area, not a volume
    double measure; // of one
    double corner[8][3];
} shapes[] = {{BRUNT_TET4, 10, false, 1.0 / 6, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
              {BRUNT_HEX8,
               12,
               false,
               1,
               {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}},
              {BRUNT_TRI3, 5, true, 0.5, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
              {BRUNT_QUAD4, 9, true, 1, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}},
              {BRUNT_MEMBRANE_QUAD4, 9, true, 1.25, {{0, 0, 0}, {1, 0, 0.75}, {1, 1, 0.75}, {0, 1, 0}}},
              {BRUNT_MEMBRANE_TRI3, 5, true, 0.625, {{0, 0, 0}, {1, 0, 0.75}, {0, 1, 0}}}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static void write_elements(const char *path, int shape, int64_t count, bool float32) {
    const brunt_element_traits *element = brunt_element_traits_of(shapes[shape].kind);
    int64_t n = element->nodes, points = n * count;
    double *x = brunt_alloc(sizeof *x * 3 * (size_t)points);
    int32_t *cells = brunt_alloc(sizeof *cells * (size_t)points);
    int64_t *ids = brunt_alloc(sizeof *ids * (size_t)points);
    for (int64_t i = 0; i < points; i++) {
        // Nodes out of order, so that a connectivity that is not read would show.
        int64_t at = 7 * i % points;
        cells[i] = (int32_t)at;
        ids[i] = i * 3000000000;
        for (int c = 0; c < 3; c++)
            x[3 * at + c] = shapes[shape].corner[i % n][c] + (c == 0 ? 2 * (double)(i / n % 1000) : 0);
    }
    double *vector = filled(1, points, 3), *scalar = filled(2, count, 1), *tensor = filled(4, count, 6);
    const brunt_vtu_array arrays[] = {
        {.name = "id", .components = 1, .integers = ids},
        {.name = "velocity", .components = 3, .values = vector},
        {.name = "plastic_strain", .components = 1, .values = scalar, .at_cells = true},
        {.name = "id", .components = 1, .integers = ids, .at_cells = true},
        {.name = "stress", .unit = "Pa", .components = 6, .values = tensor, .at_cells = true}};
    const brunt_vtu_grid grid = {points, count, x, cells, element->nodes, element->shape->vtk_cell};
    brunt_error error = {0};
    ck_assert_msg(brunt_vtu_write(path, 0.5, &grid, arrays, 5, float32, &error) == BRUNT_OK, "%s", error.message);
    brunt_free(x);
    brunt_free(cells);
    brunt_free(ids);
    brunt_free(vector);
    brunt_free(scalar);
    brunt_free(tensor);
}

static void add_elements(int which, FILE *arguments, FILE *wanted) {
    static const int64_t numbers[] = {1, 32769, 0};
    const int shape = which % SHAPES;
    const long long count = numbers[which / SHAPES], nodes = brunt_element_nodes(shapes[shape].kind);
    const bool float32 = which / SHAPES % 2 == 0;
    const char *type = float32 ? "float" : "double";
    char path[128], size[64] = "";
    snprintf(path, sizeof path, "%s/e%d.vtu", folder, which);
    write_elements(path, shape, count, float32);
    fprintf(arguments, " %s", path);
    if (count)
        snprintf(size, sizeof size, "cell types %d\n%s %.6f\n", shapes[shape].vtk_cell,
                 shapes[shape].flat ? "area" : "volume", shapes[shape].measure * (double)count);
    fprintf(wanted,
            "points %lld cells %lld\ntime 0.5\nactive - velocity\narray id long_long %lld None\narray velocity %s %lld "
            "X,Y,Z\nactive of cells plastic_strain -\ncell array plastic_strain %s %lld None\ncell array id long_long "
            "%lld None\ncell array stress %s %lld XX,YY,ZZ,XY,YZ,XZ [Pa]\n%spattern ok\n",
            nodes * count, count, nodes * count, type, nodes * count, type, count, count, type, count, size);
}

START_TEST(elements_read_back_whole) { read_all("--elements", 2 * SHAPES + 1, add_elements); }
END_TEST

START_TEST(describes_elements) {
    char path[128], *text = NULL;
    size_t size;
    snprintf(path, sizeof path, "%s/e.vtu", folder);
    write_elements(path, 1, 100, true);
    FILE *out = open_memstream(&text, &size);
    ck_assert_int_eq(brunt_vtu_describe(path, out, NULL), BRUNT_OK);
    fclose(out);
    ck_assert_ptr_nonnull(strstr(text, "nodes      800\nelements   100\n"));
    const char *nodes = strstr(text, "at the nodes\n"), *cells = strstr(text, "at the elements\n");
    ck_assert(nodes && cells && strstr(nodes, "velocity") < cells && strstr(cells, "plastic_strain"));
    ck_assert_ptr_nonnull(strstr(cells, "Float32 x 6 [Pa]\n"));
    ck_assert_ptr_nonnull(strstr(nodes, "Float32 x 3\n")); // none is told of these velocities
    free(text);
}
END_TEST

START_TEST(describes_what_it_wrote) {
    char path[128], *text = NULL;
    size_t size;
    snprintf(path, sizeof path, "%s/p.vtu", folder);
    write_pattern(path, 100, true);
    FILE *out = open_memstream(&text, &size);
    ck_assert_int_eq(brunt_vtu_describe(path, out, NULL), BRUNT_OK);
    fclose(out);
    ck_assert_ptr_nonnull(strstr(text, "particles  100\n"));
    ck_assert_ptr_nonnull(strstr(text, "time       0.30000000000000004 s\n"));
    ck_assert_ptr_nonnull(strstr(text, "cauchy_stress_2"));
    free(text);
}
END_TEST

START_TEST(leaves_nothing_behind_when_it_cannot_write) {
    brunt_error error = {0};
    const double point[3] = {0};
    char path[128], command[256];
    snprintf(path, sizeof path, "%s/no/such/folder/p.vtu", folder);
    const brunt_vtu_grid one = {.point_count = 1, .points = point};
    ck_assert_int_eq(brunt_vtu_write(path, 0, &one, NULL, 0, true, &error), BRUNT_IO_ERROR);
    ck_assert_ptr_nonnull(strstr(error.message, "No such file or directory"));
    // A file that may not grow stands for a full disk: the old picture stays, nothing lies beside it.
    snprintf(path, sizeof path, "%s/p.vtu", folder);
    write_pattern(path, 10, true);
    struct rlimit old, small;
    getrlimit(RLIMIT_FSIZE, &old);
    small = old;
    small.rlim_cur = 4096;
    signal(SIGXFSZ, SIG_IGN);
    ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &small), 0);
    int64_t count = 32768;
    double *points = filled(7, count, 3);
    for (int64_t i = 0; i < 3 * count; i++) points[i] = (double)((i * 2654435761u) % 1000003) * 1e-3;
    const brunt_vtu_grid many = {.point_count = count, .points = points};
    int status = brunt_vtu_write(path, 0, &many, NULL, 0, false, &error);
    setrlimit(RLIMIT_FSIZE, &old);
    brunt_free(points);
    ck_assert_int_eq(status, BRUNT_IO_ERROR);
    ck_assert_ptr_nonnull(strstr(error.message, "p.vtu"));
    ck_assert_ptr_nonnull(strstr(error.message, "File too large"));
    snprintf(command, sizeof command, "test \"$(ls -A '%s')\" = p.vtu", folder);
    ck_assert_int_eq(system(command), 0);
    snprintf(command, sizeof command, "--pattern %s", path);
    ck_assert_ptr_nonnull(strstr(read_back(command), "points 10 "));
    ck_assert_int_eq((int)brunt_memory_live(), 0);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("vtu");
    TCase *files = tcase_create("files");
    tcase_add_checked_fixture(files, make_folder, remove_folder);
    tcase_add_test(files, reads_back_whole);
    tcase_add_loop_test(files, block_headers_are_exact, 0, (int)(sizeof counts / sizeof *counts));
    tcase_add_test(files, elements_read_back_whole);
    tcase_add_test(files, describes_elements);
    tcase_add_test(files, describes_what_it_wrote);
    tcase_add_test(files, leaves_nothing_behind_when_it_cannot_write);
    suite_add_tcase(suite, files);
    return suite_main(suite);
}
