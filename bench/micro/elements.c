// What finite elements cost: nanoseconds per element-step of the three passes of a step, by element and threads.
//
//   bench_elements [--quick] [--cells N] [--steps N] [--rounds N] [--threads N] [--only WORD] [--growth] [-o FILE.csv]
//
// A distorted block of neo-Hookean material vibrates: hexahedra N^3 (default 80), tetrahedra 6 (N * 0.55)^3; of N^1.5
// by N^1.5 quadrilaterals and as many squares of two triangles membranes, sections of plane strain and, from the axis
// on, sections of rings. Rounds go through all configurations one after the other; the table gives the median of the
// rounds and the least. --growth: the cost over size, hexahedra and tetrahedra alone, from 10,000 to a million. -o:
// rows of a machine's file (bench/machines/README.md) are appended.
#include "fem/fem_body.h"
#include "typical.h"

enum { ROUND_LIMIT = 64, PASSES = 3, THREAD_LIMIT = 16, BENCH_LIMIT = 16 };
static const char *const pass_names[PASSES] = {"kick", "drift", "forces"};

typedef struct bench {
    char name[64];
    brunt_fem_body body;
    brunt_fem_workspace work[THREAD_LIMIT];
    brunt_fem_sums *kicked, *drifted; // of each piece
    double dt;
    int steps;                                            // of a window
    double ns[THREAD_LIMIT + 1][PASSES + 1][ROUND_LIMIT]; // per element-step; last: all passes
} bench;

enum { GRAIN = 4096 };

static void kick_task(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    bench *b = context;
    const double none[3] = {0};
    brunt_fem_kick(&b->body, (int32_t)begin, (int32_t)end, b->dt, none, &b->kicked[begin / GRAIN]);
}

static void drift_task(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    bench *b = context;
    brunt_fem_drift(&b->body, (int32_t)begin, (int32_t)end, b->dt, &b->drifted[begin / GRAIN]);
}

static void forces_task(void *context, int64_t begin, int64_t end, int worker) {
    bench *b = context;
    for (int64_t k = begin; k < end; k++)
        b->body.element->forces(&b->body, (int32_t)k, (real)b->dt, &b->work[worker], &b->body.report[k]);
}

static bool flat(brunt_element_kind kind) {
    return brunt_element_is_membrane(kind) || brunt_element_dimension(kind) == 2;
}

// n cells along each axis (of a flat one, two of them), nodes moved by up to 0.05 cells, but for those at x = 0.
static int make_mesh(brunt_element_kind kind, int n, brunt_mesh *mesh) {
    static const int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    static const int tet[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
    static const int triangle[2][3] = {{0, 1, 2}, {0, 2, 3}};
    const int nodes = brunt_element_nodes(kind), layers = flat(kind) ? 1 : n;
    const int m = n + 1, parts = kind == BRUNT_TET4 ? 6 : nodes == 3 ? 2 : 1, levels = flat(kind) ? 1 : m;
    *mesh = (brunt_mesh){.kind = kind, .node_count = m * m * levels, .element_count = n * n * layers * parts};
    mesh->nodes = brunt_alloc((size_t)mesh->node_count * sizeof *mesh->nodes);
    mesh->elements = brunt_alloc((size_t)mesh->element_count * (size_t)nodes * sizeof *mesh->elements);
    if (!mesh->nodes || !mesh->elements) return -1;
    uint64_t seed = 1;
    for (int k = 0; k < mesh->node_count; k++) {
        const int at[3] = {k % m, k / m % m, k / m / m};
        for (int a = 0; a < 3; a++) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            const double aside = a == 0 && at[0] == 0 ? 0 : 0.05 * ((double)(seed >> 11) / 4503599627370496.0 - 1);
            if (a < 2 || levels > 1 || brunt_element_is_membrane(kind)) mesh->nodes[k][a] = 1e-3 * (at[a] + aside);
        }
    }
    int32_t *out = mesh->elements;
    for (int k = 0; k < n * n * layers; k++) {
        const int at[3] = {k % n, k / n % n, k / n / n};
        for (int p = 0; p < parts; p++)
            for (int a = 0; a < nodes; a++) {
                const int *c = corner[kind == BRUNT_TET4 ? tet[p][a] : nodes == 3 ? triangle[p][a] : a];
                *out++ = ((at[2] + c[2]) * m + at[1] + c[1]) * m + at[0] + c[0];
            }
    }
    return 0;
}

static int make(brunt_element_kind kind, bool rings, int cells, bench *b) {
    brunt_mesh mesh;
    brunt_error error = {0};
    if (make_mesh(kind, cells, &mesh)) return BRUNT_FAILED;
    brunt_body_def def = {
        .name = "block", .hourglass_coefficient = NAN, .thickness = 1e-4, .place = brunt_placement_identity()};
    def.method = brunt_element_is_membrane(kind) ? BRUNT_MEMBRANE : BRUNT_FEM;
    brunt_material_def rubber = brunt_material_def_default("rubber", "neo-hookean");
    brunt_material material;
    rubber.density = 1100;
    brunt_material_set(&rubber, "E", 1e6, NULL, &error);
    brunt_material_set(&rubber, "nu", 0.4, NULL, &error);
    int status = brunt_element_is_membrane(kind) ? brunt_material_make_membrane(&rubber, false, &material, &error)
                                                 : brunt_material_make(&rubber, &material, &error);
    if (status == BRUNT_OK)
        status = rings ? brunt_fem_make_axisymmetric(&def, &material, &mesh, &b->body, &error)
                       : brunt_fem_make(&def, &material, brunt_element_dimension(kind), &mesh, &b->body, &error);
    brunt_mesh_free(&mesh);
    if (status != BRUNT_OK) {
        fprintf(stderr, "bench_elements: %s\n", error.message);
        return status;
    }
    b->dt = 0.5 * b->body.least_step;
    size_t pieces = (size_t)b->body.node_count / GRAIN + 1;
    b->kicked = brunt_alloc(pieces * sizeof *b->kicked);
    b->drifted = brunt_alloc(pieces * sizeof *b->drifted);
    for (int t = 0; t < THREAD_LIMIT; t++)
        if (brunt_fem_workspace_fit(&b->work[t], &b->body, NULL)) return BRUNT_FAILED;
    for (int32_t n = 0; n < b->body.node_count; n++) {
        real *node = brunt_fem_node(&b->body, n);
        for (int a = 0; a < b->body.dim; a++)
            if (!b->body.held || !(b->body.held[n] >> a & 1))
                node[BRUNT_FEM_V + a] = (real)(0.5 * sin(200.0 * (double)node[(a + 1) % 3]));
    }
    return b->kicked && b->drifted ? BRUNT_OK : BRUNT_FAILED;
}

static void drop(bench *b) {
    for (int t = 0; t < THREAD_LIMIT; t++) brunt_fem_workspace_free(&b->work[t]);
    brunt_free(b->kicked);
    brunt_free(b->drifted);
    brunt_fem_free(&b->body);
}

// One window: the parts and their sum go to the round's place.
static void run(bench *b, int threads, int round) {
    double seconds[PASSES] = {0};
    for (int s = -1; s < b->steps; s++) {
        double t0 = brunt_clock();
        brunt_parallel(threads, b->body.node_count, GRAIN, kick_task, b, NULL);
        double t1 = brunt_clock();
        brunt_parallel(threads, b->body.node_count, GRAIN, drift_task, b, NULL);
        double t2 = brunt_clock();
        brunt_parallel(threads, b->body.block_count, 2, forces_task, b, NULL);
        double t3 = brunt_clock();
        if (s < 0) continue; // warm-up
        seconds[0] += t1 - t0, seconds[1] += t2 - t1, seconds[2] += t3 - t2;
    }
    b->ns[threads][PASSES][round] = 0;
    for (int p = 0; p < PASSES; p++) {
        b->ns[threads][p][round] = 1e9 * seconds[p] / b->steps / b->body.element_count;
        b->ns[threads][PASSES][round] += b->ns[threads][p][round];
    }
}

typedef struct settings {
    int cells, steps, rounds, threads;
    const char *only, *file;
    bool quick, growth;
} settings;

static bool read_settings(int argc, char **argv, settings *s) {
    for (int i = 1; i < argc; i++) {
        const char *option = argv[i], *value = i + 1 < argc ? argv[i + 1] : "0";
        const int number = atoi(value);
        if (strcmp(option, "--quick") == 0) {
            s->quick = true;
            s->cells = 10, s->steps = 3, s->rounds = 2;
            continue;
        }
        if (strcmp(option, "--growth") == 0) {
            s->growth = true;
            continue;
        }
        if (strcmp(option, "--only") == 0)
            s->only = value;
        else if (strcmp(option, "-o") == 0 && i + 1 < argc)
            s->file = value;
        else if (strcmp(option, "--cells") == 0 && number > 1 && number < 400)
            s->cells = number;
        else if (strcmp(option, "--steps") == 0 && number > 0)
            s->steps = number;
        else if (strcmp(option, "--rounds") == 0 && number > 0 && number <= ROUND_LIMIT)
            s->rounds = number;
        else if (strcmp(option, "--threads") == 0 && number > 0 && number <= THREAD_LIMIT)
            s->threads = number;
        else {
            fprintf(stderr, "bench_elements: %s %s is not understood\n", option, value);
            return false;
        }
        i++;
    }
    return true;
}

// One of about `elements`.
static int add(const settings *s, brunt_element_kind kind, bool rings, double elements, bench *list, int *count) {
    char name[64];
    snprintf(name, sizeof name, "%s%s", rings ? "axisymmetric-" : "", brunt_element_name(kind));
    if (*s->only && strcmp(s->only, name) != 0) return BRUNT_OK;
    const double cells = flat(kind) ? sqrt(elements) : cbrt(kind == BRUNT_TET4 ? elements / 6 : elements);
    bench *b = &list[(*count)++];
    memcpy(b->name, name, sizeof name);
    const int status = make(kind, rings, (int)lround(cells), b);
    // Small ones take more steps: a window is to be long against what a clock and other work disturb.
    const double more = s->quick ? 1 : 500000.0 / b->body.element_count;
    b->steps = s->steps * (int)fmax(1, fmin(more, 10));
    return status;
}

static int add_all(const settings *s, bench *list, int *count) {
    static const brunt_element_kind kinds[] = {BRUNT_HEX8,  BRUNT_TET4, BRUNT_MEMBRANE_QUAD4, BRUNT_MEMBRANE_TRI3,
                                               BRUNT_QUAD4, BRUNT_TRI3, BRUNT_QUAD4,          BRUNT_TRI3};
    static const double sizes[] = {1e4, 3e4, 1e5, 3e5, 1e6};
    int status = BRUNT_OK;
    for (int k = 0; k < 8 && !s->growth && !status; k++)
        status = add(s, kinds[k], k >= 6, pow(s->cells, 3), list, count);
    for (int n = 0; n < (s->quick ? 2 : 5) && s->growth && !status; n++)
        for (int k = 0; k < 2 && !status; k++)
            status = add(s, kinds[k], false, sizes[n] / (s->quick ? 10 : 1), list, count);
    return status;
}

static void report(FILE *csv, const settings *s, bench *b, int threads) {
    const row_key key = {s->growth ? "growth" : "elements", b->name, b->body.element_count, threads};
    const double bytes = (double)brunt_fem_bytes(&b->body) / b->body.element_count,
                 total = write_samples(csv, key, "step", "ns/element", b->ns[threads][PASSES], s->rounds);
    printf("%s %7d elements %7d nodes %4d blocks %d thread%s %6.1f (%6.1f)", b->name, b->body.element_count,
           b->body.node_count, b->body.block_count, threads, threads == 1 ? " " : "s", total,
           b->ns[threads][PASSES][0]);
    for (int p = 0; p < PASSES; p++) {
        const double median = write_samples(csv, key, pass_names[p], "ns/element", b->ns[threads][p], s->rounds);
        printf("  %s %.1f (%.1f)", pass_names[p], median, b->ns[threads][p][0]);
    }
    printf("  B %.0f\n", bytes);
    write_row(csv, key, "bytes", "B/element", bytes, bytes, s->rounds);
}

int main(int argc, char **argv) {
    start_with_short_spins(argv);
    settings s = {.cells = 80, .steps = 10, .rounds = 5, .threads = 2, .only = ""};
    if (!read_settings(argc, argv, &s)) return BRUNT_BAD_USAGE;
    FILE *csv = s.file ? open_rows(s.file) : NULL;
    if (s.file && !csv) return BRUNT_IO_ERROR;
    bench *list = brunt_alloc(BENCH_LIMIT * sizeof *list);
    int count = 0, status = list ? add_all(&s, list, &count) : BRUNT_FAILED;
    for (int r = 0; r < s.rounds && !status; r++)
        for (int k = 0; k < count; k++)
            for (int t = 1; t <= s.threads; t++) run(&list[k], t, r);
    if (!status)
        printf("ns per element-step, median of %d rounds (least in brackets); B: bytes per element\n", s.rounds);
    for (int k = 0; k < count; k++) {
        for (int t = 1; t <= s.threads && !status; t++) report(csv, &s, &list[k], t);
        drop(&list[k]);
    }
    brunt_free(list);
    return close_rows(csv) || status ? status : BRUNT_IO_ERROR;
}
