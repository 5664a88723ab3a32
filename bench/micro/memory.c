// What a world takes of memory: bytes per particle by kernel, bytes per element by kind.
//
//   bench_memory [--quick] [-o FILE.csv]
//
// Each world of about a million particles or half a million elements, neo-Hookean, is made and takes four steps on one
// thread in a process of its own. "arrays" is the sum of what the world says of its arrays, "peak" what the system saw
// the process take at most, less what it had before. -o: rows of a machine's file (bench/machines/README.md) are
// appended.
#include <math.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "rows.h"

typedef struct memory_case {
    int dimension, kernel; // kernel 0: finite elements
    brunt_element_kind element;
    bool axisymmetric;
} memory_case;

typedef struct usage {
    double units, arrays, peak; // [B] in all
} usage;

static const char *const kernel_names[] = {"", "linear", "quadratic", "cubic"};

static void name_of(const memory_case *c, char *out, size_t size) {
    if (c->kernel)
        snprintf(out, size, "%dd %s apic neo-hookean", c->dimension, kernel_names[c->kernel]);
    else
        snprintf(out, size, "%s%s", c->axisymmetric ? "axisymmetric-" : "", brunt_element_name(c->element));
}

// A block of cells of 1 mm, at (1 m, 0, 0) so that rings may be made of it.
static brunt_world *create(const memory_case *c, double wanted, brunt_error *error) {
    static char lower_face[1][BRUNT_NAME_LENGTH] = {"zmin"};
    brunt_world_def def = brunt_world_def_default();
    brunt_material_def rubber = brunt_material_def_default("rubber", "neo-hookean");
    rubber.density = 1100;
    brunt_material_set(&rubber, "E", 1e6, NULL, error);
    brunt_material_set(&rubber, "nu", 0.4, NULL, error);
    brunt_body_def body = brunt_body_def_default();
    snprintf(body.name, sizeof body.name, "block");
    const bool sheet = !c->kernel && brunt_element_is_membrane(c->element);
    const int flat = c->dimension == 2 || sheet, corners = c->kernel ? 0 : brunt_element_nodes(c->element);
    const double cell = 1e-3, units_of_cell = c->kernel                  ? (c->dimension == 3 ? 8 : 4)
                                              : corners == 3             ? 2
                                              : c->element == BRUNT_TET4 ? 6
                                                                         : 1;
    const double side = cell * round(flat ? sqrt(wanted / units_of_cell) : cbrt(wanted / units_of_cell));
    body.shape.kind = BRUNT_BOX;
    body.shape.min[0] = 1, body.shape.max[0] = 1 + side, body.shape.max[1] = side;
    if (c->dimension == 3) body.shape.max[2] = flat ? cell : side;
    if (c->kernel) {
        body.particles_per_cell = (int32_t)units_of_cell;
    } else {
        body.method = sheet ? BRUNT_MEMBRANE : BRUNT_FEM;
        body.element = c->element, body.size = cell, body.thickness = 0.1 * cell;
        if (sheet) body.faces = lower_face, body.face_count = 1;
    }
    def.dimension = c->dimension, def.axisymmetric = c->axisymmetric, def.cell = cell, def.end = 1, def.threads = 1;
    if (c->kernel) def.kernel = (brunt_kernel)c->kernel;
    def.materials = &rubber, def.material_count = 1;
    def.bodies = &body, def.body_count = 1;
    return brunt_world_create(&def, error);
}

static double resident(void) {
    long all, pages = 0;
    FILE *in = fopen("/proc/self/statm", "r");
    if (in && fscanf(in, "%ld %ld", &all, &pages) != 2) pages = 0;
    if (in) fclose(in);
    return (double)pages * (double)sysconf(_SC_PAGESIZE);
}

// In a process of its own.
static int use(const memory_case *c, double wanted, usage *used) {
    brunt_error error = {0};
    const double before = resident();
    brunt_world *world = create(c, wanted, &error);
    int status = world ? BRUNT_OK : error.code;
    for (int s = 0; s < 4 && !status; s++) status = brunt_world_step(world, INFINITY, &error);
    if (status) {
        fprintf(stderr, "bench_memory: %s\n", error.message);
        return status;
    }
    struct rusage most;
    getrusage(RUSAGE_SELF, &most);
    used->units = (double)(brunt_world_particles(world) + brunt_world_elements(world));
    used->peak = 1024.0 * (double)most.ru_maxrss - before;
    for (int32_t a = 0; a < brunt_array_count(world); a++) used->arrays += (double)brunt_world_array(world, a).bytes;
    return BRUNT_OK;
}

static int measure(const memory_case *c, double wanted, usage *used) {
    int ends[2], status = BRUNT_FAILED;
    *used = (usage){.units = 0};
    if (pipe(ends)) return BRUNT_FAILED;
    const pid_t child = fork();
    if (child == 0) {
        status = use(c, wanted, used);
        if (write(ends[1], used, sizeof *used) != (ssize_t)sizeof *used) status = BRUNT_IO_ERROR;
        _exit(status);
    }
    close(ends[1]);
    if (child > 0 && read(ends[0], used, sizeof *used) == (ssize_t)sizeof *used && waitpid(child, &status, 0) == child)
        status = WIFEXITED(status) ? WEXITSTATUS(status) : BRUNT_FAILED;
    close(ends[0]);
    return status;
}

int main(int argc, char **argv) {
    static const memory_case cases[] = {
        {3, BRUNT_LINEAR, 0, false},         {3, BRUNT_QUADRATIC, 0, false},    {3, BRUNT_CUBIC, 0, false},
        {2, BRUNT_LINEAR, 0, false},         {2, BRUNT_QUADRATIC, 0, false},    {2, BRUNT_CUBIC, 0, false},
        {3, 0, BRUNT_HEX8, false},           {3, 0, BRUNT_TET4, false},         {2, 0, BRUNT_QUAD4, false},
        {2, 0, BRUNT_TRI3, false},           {2, 0, BRUNT_QUAD4, true},         {2, 0, BRUNT_TRI3, true},
        {3, 0, BRUNT_MEMBRANE_QUAD4, false}, {3, 0, BRUNT_MEMBRANE_TRI3, false}};
    double share = 1;
    FILE *csv = NULL;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0) {
            share = 0.05;
        } else if (strcmp(argv[i], "-o") == 0 && i + 1 < argc && !csv) {
            csv = open_rows(argv[++i]);
            if (!csv) return BRUNT_IO_ERROR;
        } else {
            fprintf(stderr, "usage: bench_memory [--quick] [-o FILE.csv]\n");
            return BRUNT_BAD_USAGE;
        }
    }
    if (csv) fflush(csv); // or each process would write it again
    printf("bytes per particle or element: arrays of the world, and most of the process\n");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char name[96];
        usage used;
        fflush(stdout);
        const int status = measure(&cases[k], share * (cases[k].kernel ? 1e6 : 5e5), &used);
        if (status) return status;
        name_of(&cases[k], name, sizeof name);
        const char *unit = cases[k].kernel ? "B/particle" : "B/element";
        const row_key key = {"memory", name, used.units, 1};
        printf("%-30s %8.0f  %7.1f %7.1f\n", name, used.units, used.arrays / used.units, used.peak / used.units);
        write_row(csv, key, "arrays", unit, used.arrays / used.units, used.arrays / used.units, 1);
        write_row(csv, key, "peak", unit, used.peak / used.units, used.peak / used.units, 1);
    }
    return close_rows(csv) ? BRUNT_OK : BRUNT_IO_ERROR;
}
