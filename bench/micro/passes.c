// What a step costs, pass by pass: nanoseconds per particle-step for each kernel, transfer, size and number of threads.
//
//   bench_passes [--quick] [--particles N[,N...]] [--threads N[,N...]] [--dimension D[,D]] [--only WORDS] [--rounds N]
//                [--steps N] [--growth] [-o FILE.csv]
//
// --growth: the cost over size, quadratic APIC alone, from 10,000 to 3,000,000 particles (2D: three sizes). -o: rows of
// a machine's file (bench/machines/README.md) are appended.
//
// A block, 8 particles a cell (2D: 4), moves as one in an impact does: 0.05, 0.04 and 0.03 cells a step along the axes,
// turning slowly, with a longitudinal wave through it. Rounds go through all configurations one after the other, so
// that what else the machine does falls on all of them alike; the grid is shifted by another part of a cell in each
// round, since the kernels' speed depends on where the particles lie in the cells. Every sample is the mean over a
// window of steps; the table gives the median and the least of the rounds.
#include "brunt.h"
#include "typical.h"

enum { SIZE_LIMIT = 8, ROUND_LIMIT = 64, PASS_LIMIT = 16, CONFIGURATION_LIMIT = 512, WARM_UP = 4 };

static const char *const kernel_names[] = {"", "linear", "quadratic", "cubic"};
static const char *const transfer_names[] = {"pic", "flip", "apic"};

typedef struct configuration {
    int dimension, threads;
    brunt_kernel kernel;
    brunt_transfer transfer;
    const char *material; // of the plan below; behind a stroke what else is special
    int64_t wanted, particles;
    double bytes; // of all arrays, per particle
    int pass_count, round_count;
    const char *pass_name[PASS_LIMIT];
    double total[ROUND_LIMIT], pass[PASS_LIMIT][ROUND_LIMIT]; // [ns] per particle-step
    double busy[PASS_LIMIT][ROUND_LIMIT];                     // [-] share of threads x time spent working
} configuration;

typedef struct settings {
    int64_t particles[SIZE_LIMIT];
    int64_t threads[SIZE_LIMIT], dimensions[SIZE_LIMIT];
    int size_count, thread_count, dimension_count, rounds, steps;
    const char *only, *file;
    bool growth;
} settings;

static brunt_world *create(const configuration *c, int turn, int turns, brunt_error *error) {
    brunt_world_def def = brunt_world_def_default();
    def.dimension = c->dimension, def.threads = c->threads, def.kernel = c->kernel, def.transfer = c->transfer;
    def.cell = 1e-3, def.end = 1, def.energy_limit = INFINITY;
    for (int a = 0; a < 3; a++) def.origin[a] = def.cell * fmod((turn + 0.5) / turns * (a + 1), 1);

    brunt_material_def material = {.name = "material", .density = typical_density};
    bool impact = strcmp(c->material, "johnson-cook+mie-gruneisen") == 0;
    const char *special = strchr(c->material, '/');
    const bool rings = special && strcmp(special, "/rings") == 0;
    snprintf(material.strength, sizeof material.strength, "%.*s", (int)strcspn(c->material, "+/"), c->material);
    def.axisymmetric = rings;
    if (rings) def.origin[0] = 0; // a line of the grid is the axis
    const brunt_model *strength = brunt_find_strength(material.strength), *eos = brunt_find_eos("mie-gruneisen");
    typical_parameters(strength, material.strength_parameters);
    if (impact) {
        snprintf(material.eos, sizeof material.eos, "%s", eos->name);
        typical_parameters(eos, material.eos_parameters);
        material.bulk_viscosity = true;
        typical_parameters(&brunt_bulk_viscosity, material.viscosity_parameters);
    }
    def.materials = &material, def.material_count = 1;

    int per_cell = c->dimension == 3 ? 8 : 4;
    double side = def.cell * round(pow((double)c->wanted / per_cell, 1.0 / c->dimension));
    double wave = sqrt(124e9 / typical_density), step = 0.5 * def.cell / (1.3 * wave);
    brunt_body_def body = brunt_body_def_default();
    snprintf(body.name, sizeof body.name, "block");
    body.shape.kind = BRUNT_BOX, body.particles_per_cell = per_cell;
    body.total_lagrangian = special && !rings;
    for (int a = 0; a < c->dimension; a++) {
        body.shape.max[a] = side;
        body.spin_about[a] = side / 2;
        body.velocity[a] = (0.05 - 0.01 * a) * def.cell / step;
    }
    if (rings)
        body.shape.min[0] += side, body.shape.max[0] += side; // off the axis, about which nothing may turn over
    else
        body.spin[2] = 0.01 * wave / side;
    body.wave_velocity[0] = 0.01 * wave, body.wave_vector[0] = 12.566370614359172 / side;
    def.bodies = &body, def.body_count = 1;
    return brunt_world_create(&def, error);
}

// Small ones take more steps: a window is to be long against what a clock and other work disturb.
static int window_of(const configuration *c, const settings *s) {
    const int64_t more = s->growth && s->steps > 2 ? 250000 / c->particles : 1;
    return s->steps * (int)(more < 1 ? 1 : more > 10 ? 10 : more);
}

static int measure(configuration *c, int round, const settings *s) {
    brunt_error error = {0};
    brunt_world *world = create(c, round, s->rounds, &error);
    brunt_pass before[PASS_LIMIT];
    int status = world ? BRUNT_OK : error.code, steps = 0;
    for (; status == BRUNT_OK && steps < WARM_UP; steps++) status = brunt_world_step(world, INFINITY, &error);
    if (status == BRUNT_OK) {
        c->particles = brunt_world_particles(world);
        c->pass_count = brunt_pass_count(world);
        if (c->pass_count > PASS_LIMIT) c->pass_count = PASS_LIMIT;
        for (int p = 0; p < c->pass_count; p++) before[p] = brunt_world_pass(world, p);
    }
    const int window = status == BRUNT_OK ? window_of(c, s) : 0;
    double start = brunt_clock();
    for (steps = 0; status == BRUNT_OK && steps < window; steps++) status = brunt_world_step(world, INFINITY, &error);
    double scale = 1e9 / ((double)c->particles * window);
    if (status == BRUNT_OK) {
        int r = c->round_count++;
        c->total[r] = scale * (brunt_clock() - start);
        for (int p = 0; p < c->pass_count; p++) {
            brunt_pass after = brunt_world_pass(world, p);
            double seconds = after.seconds - before[p].seconds, busy = 0;
            for (int t = 0; t < c->threads; t++) busy += after.thread_seconds[t] - before[p].thread_seconds[t];
            c->pass_name[p] = after.name;
            c->pass[p][r] = scale * seconds;
            c->busy[p][r] = seconds > 0 ? busy / (seconds * c->threads) : 1;
        }
        c->bytes = 0;
        for (int a = 0; a < brunt_array_count(world); a++) c->bytes += (double)brunt_world_array(world, a).bytes;
        c->bytes /= (double)c->particles;
    } else {
        fprintf(stderr, "%dD %s %s %s: %s\n", c->dimension, kernel_names[c->kernel], transfer_names[c->transfer],
                c->material, error.message);
    }
    brunt_world_destroy(world);
    return status;
}

// Runs of the same configuration that differ in threads alone stand one after the other.
static int plan(const settings *s, configuration *list) {
    static const char *const materials[] = {"neo-hookean", "von-mises", "johnson-cook+mie-gruneisen",
                                            "neo-hookean/total", "neo-hookean/rings"};
    int count = 0;
    for (int d = 0; d < s->dimension_count; d++)
        for (int n = 0; n < s->size_count; n++)
            for (int m = 0; m < 5; m++)
                for (int k = BRUNT_LINEAR; k <= BRUNT_CUBIC; k++)
                    for (int transfer = BRUNT_APIC; transfer >= BRUNT_PIC; transfer--)
                        for (int t = 0; t < s->thread_count; t++) {
                            // Plasticity changes one pass only: once, with the default kernel and transfer. So do the
                            // rest; rings are plane.
                            bool usual = k == BRUNT_QUADRATIC && transfer == BRUNT_APIC && n == 0;
                            char words[128];
                            snprintf(words, sizeof words, "%s %s %s", kernel_names[k], transfer_names[transfer],
                                     materials[m]);
                            if (m == 4 && s->dimensions[d] != 2) continue;
                            if (s->growth && (m > 0 || k != BRUNT_QUADRATIC || transfer != BRUNT_APIC)) continue;
                            if (s->growth && s->dimensions[d] == 2 && n % 2 == 1) continue;
                            if ((m > 0 && !usual) || (s->only && !strstr(words, s->only))) continue;
                            if (count == CONFIGURATION_LIMIT) return count;
                            list[count++] = (configuration){.dimension = (int)s->dimensions[d],
                                                            .threads = (int)s->threads[t],
                                                            .kernel = (brunt_kernel)k,
                                                            .transfer = (brunt_transfer)transfer,
                                                            .material = materials[m],
                                                            .wanted = s->particles[n]};
                        }
    return count;
}

static void write_passes(FILE *csv, const settings *s, configuration *c) {
    char name[96], figure[48];
    snprintf(name, sizeof name, "%dd %s %s %s", c->dimension, kernel_names[c->kernel], transfer_names[c->transfer],
             c->material);
    const row_key key = {s->growth ? "growth" : "particles", name, (double)c->particles, c->threads};
    write_samples(csv, key, "step", "ns/particle", c->total, c->round_count);
    write_row(csv, key, "bytes", "B/particle", c->bytes, c->bytes, c->round_count);
    for (int p = 0; p < c->pass_count; p++) {
        write_samples(csv, key, c->pass_name[p], "ns/particle", c->pass[p], c->round_count);
        if (c->threads == 1) continue;
        snprintf(figure, sizeof figure, "busy %.40s", c->pass_name[p]);
        write_samples(csv, key, figure, "1", c->busy[p], c->round_count);
    }
}

// Table on standard output: total with the least in brackets, then the passes' medians; what of a step is in no pass is
// its rest. The speed-up is that of the medians over the line with one thread.
static bool report(FILE *csv, const settings *s, configuration *list, int count) {
    double single = 0;
    printf("ns per particle-step, median of the rounds (least in brackets); B: bytes per particle\n");
    for (int i = 0; i < count; i++) {
        configuration *c = &list[i];
        const double total = median_of(c->total, c->round_count);
        if (c->threads == 1) single = total;
        printf("%dD %-9s %-4s %-27s %8lld %d thread%s %7.1f (%6.1f)", c->dimension, kernel_names[c->kernel],
               transfer_names[c->transfer], c->material, (long long)c->particles, c->threads,
               c->threads == 1 ? " " : "s", total, c->total[0]);
        double rest = total;
        for (int p = 0; p < c->pass_count; p++) {
            const double median = median_of(c->pass[p], c->round_count);
            rest -= median;
            printf("  %s %.1f", c->pass_name[p], median);
        }
        printf("  rest %.1f  B %.0f", rest, c->bytes);
        if (c->threads > 1 && single > 0) printf("  speed-up %.2f", single / total);
        printf("\n");
        write_passes(csv, s, c);
    }
    return close_rows(csv);
}

static bool read_settings(int argc, char **argv, settings *s) {
    static const int64_t sizes[] = {10000, 30000, 100000, 300000, 1000000, 3000000};
    bool quick = false, sized = false;
    for (int i = 1; i < argc; i++) {
        const char *option = argv[i], *value = i + 1 < argc ? argv[i + 1] : "";
        int64_t number[SIZE_LIMIT];
        bool ok = true;
        if (strcmp(option, "--quick") == 0) {
            s->particles[0] = 8000, s->size_count = 1;
            s->rounds = 2, s->steps = 2;
            quick = true;
            continue;
        }
        if (strcmp(option, "--growth") == 0) {
            s->growth = true;
            continue;
        }
        i++;
        if (strcmp(option, "--particles") == 0)
            sized = ok = (s->size_count = read_list(value, 100000000, SIZE_LIMIT, s->particles)) > 0;
        else if (strcmp(option, "--threads") == 0)
            ok = (s->thread_count = read_list(value, 64, SIZE_LIMIT, s->threads)) > 0;
        else if (strcmp(option, "--dimension") == 0)
            ok = (s->dimension_count = read_list(value, 3, SIZE_LIMIT, s->dimensions)) > 0 && s->dimensions[0] > 1 &&
                 s->dimensions[s->dimension_count - 1] > 1;
        else if (strcmp(option, "--rounds") == 0)
            ok = read_list(value, ROUND_LIMIT, SIZE_LIMIT, number) == 1, s->rounds = ok ? (int)number[0] : 0;
        else if (strcmp(option, "--steps") == 0)
            ok = read_list(value, 1000000, SIZE_LIMIT, number) == 1, s->steps = ok ? (int)number[0] : 0;
        else if (strcmp(option, "--only") == 0)
            s->only = value;
        else if (strcmp(option, "-o") == 0)
            s->file = value, ok = *value;
        else
            ok = false;
        if (!ok) {
            fprintf(stderr, "bench_passes: %s %s is not understood\n", option, value);
            return false;
        }
    }
    if (s->growth && !sized) {
        s->size_count = quick ? 3 : (int)(sizeof sizes / sizeof *sizes);
        for (int n = 0; n < s->size_count; n++) s->particles[n] = sizes[n] / (quick ? 10 : 1);
    }
    return true;
}

int main(int argc, char **argv) {
    start_with_short_spins(argv);
    settings s = {.particles = {250000, 1000000},
                  .size_count = 2,
                  .threads = {1, 2},
                  .thread_count = 2,
                  .dimensions = {3, 2},
                  .dimension_count = 2,
                  .rounds = 5,
                  .steps = 12};
    if (!read_settings(argc, argv, &s)) return BRUNT_BAD_USAGE;
    configuration *list = brunt_alloc(CONFIGURATION_LIMIT * sizeof *list);
    if (!list) return BRUNT_FAILED;
    int count = plan(&s, list), status = count ? BRUNT_OK : BRUNT_BAD_USAGE;
    if (!count) fprintf(stderr, "bench_passes: no configuration has '%s' in it\n", s.only);
    FILE *csv = NULL;
    if (status == BRUNT_OK && s.file) {
        csv = open_rows(s.file);
        if (!csv) status = BRUNT_IO_ERROR;
    }
    for (int round = 0; status == BRUNT_OK && round < s.rounds; round++) {
        for (int i = 0; status == BRUNT_OK && i < count; i++) status = measure(&list[i], round, &s);
        fprintf(stderr, "round %d of %d done\n", round + 1, s.rounds);
    }
    if (status == BRUNT_OK)
        status = report(csv, &s, list, count) ? BRUNT_OK : BRUNT_IO_ERROR;
    else
        close_rows(csv);
    brunt_free(list);
    return status;
}
