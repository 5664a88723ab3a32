// What the update of each material costs: nanoseconds per point, for a range that fits the cache.
//
//   bench_materials [--quick] [-o FILE.csv]
//
// -o: rows of a machine's file (bench/machines/README.md) are appended.
//
// 8192 points go back and forth between two deformation gradients close to one another, so that state stays bounded.
// "elastic": strain steps of 1e-6; "flowing": of 2e-3, which takes a plastic model through yield every time. Rounds go
// through all models one after the other; the table gives the median and the least of the rounds.
#include "typical.h"

enum { POINTS = 8192, ROUND_LIMIT = 64, CASE_LIMIT = 256 };

typedef struct bench_case {
    const brunt_model *model;
    bool with_eos;
    int dim;
    double strain; // of one step [-]
    double ns[ROUND_LIMIT];
    int rounds;
} bench_case;

static real *reals(real value) {
    real *a = brunt_alloc(sizeof(real) * POINTS);
    if (!a) {
        fprintf(stderr, "bench_materials: out of memory\n");
        exit(70);
    }
    for (int i = 0; i < POINTS; i++) a[i] = value;
    return a;
}

// Uniform in -1 .. 1, the same in every run (Knuth's 64-bit congruential generator).
static double noise(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(int64_t)*state / 9223372036854775808.0;
}

// L = (to from^-1 - I) / dt, point by point.
static void velocity_gradient(int dim, double dt, real *const from[9], real *const to[9], real *const L[9]) {
    for (int i = 0; i < POINTS; i++) {
        double f[3][3] = {{0}}, t[3][3] = {{0}}, inverse[3][3];
        f[2][2] = t[2][2] = 1;
        for (int k = 0; k < dim * dim; k++) {
            f[k / dim][k % dim] = (double)from[k][i];
            t[k / dim][k % dim] = (double)to[k][i];
        }
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) {
                int p = (b + 1) % 3, q = (b + 2) % 3, r = (a + 1) % 3, s = (a + 2) % 3;
                inverse[a][b] = f[p][r] * f[q][s] - f[p][s] * f[q][r];
            }
        double det = f[0][0] * inverse[0][0] + f[0][1] * inverse[1][0] + f[0][2] * inverse[2][0];
        for (int k = 0; k < dim * dim; k++) {
            double sum = 0;
            for (int c = 0; c < 3; c++) sum += t[k / dim][c] * inverse[c][k % dim] / det;
            L[k][i] = (real)((sum - (k % (dim + 1) == 0)) / dt);
        }
    }
}

// One round of `updates`; false when a point failed.
static bool measure(bench_case *c, int updates) {
    double parameters[BRUNT_MAX_PARAMETERS] = {0};
    real constants[BRUNT_MAX_CONSTANTS] = {0};
    const double density = typical_parameters(c->model, parameters), dt = 1e-7;
    const char *wrong = c->model->prepare(parameters, density, c->with_eos, constants);
    brunt_material_points points = {
        .count = POINTS, .dim = c->dim, .dt = (real)dt, .time = 1, .cell = (real)1e-3, .wave_speed = 4000};
    real *F[2][9] = {{0}}, *L[2][9] = {{0}}, *volume = reals(1);
    uint64_t seed = 1;
    for (int k = 0; k < BRUNT_MATRIX(c->dim); k++) {
        for (int side = 0; side < 2; side++) F[side][k] = reals(k % (c->dim + 1) == 0), L[side][k] = reals(0);
        for (int i = 0; i < POINTS; i++) {
            F[0][k][i] += (real)(0.01 * noise(&seed));
            F[1][k][i] = F[0][k][i] + (real)(c->strain * noise(&seed));
        }
    }
    velocity_gradient(c->dim, dt, F[0], F[1], L[1]);
    velocity_gradient(c->dim, dt, F[1], F[0], L[0]);
    for (int k = 0; k < BRUNT_SYMMETRIC(c->dim); k++) points.stress[k] = reals(0);
    points.volume = volume;
    points.plastic_increment = reals(0), points.viscous_pressure = reals(0);
    int scalars = 0;
    for (int f = 0; f < c->model->state_count; f++) {
        const brunt_state_field *field = &c->model->state[f];
        const bool lit = strcmp(field->name, "ignition_time") == 0; // long ago: explosives have burnt
        for (int k = 0; k < (c->dim == 3 ? field->components3 : field->components2); k++)
            points.state[scalars++] = reals(field->initial && !lit ? field->initial(constants, k) : 0);
    }
    double start = 0;
    enum { WARM_UP = 4 };
    for (int u = 0; u < updates + WARM_UP && !wrong; u++) {
        if (u == WARM_UP) start = brunt_clock();
        int side = (u + 1) % 2;
        for (int k = 0; k < 9; k++) points.F[k] = F[side][k], points.L[k] = L[side][k];
        brunt_update_result result = c->model->update(constants, &points);
        if (result.bad >= 0) wrong = result.reason;
    }
    c->ns[c->rounds++] = 1e9 * (brunt_clock() - start) / ((double)POINTS * updates);
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < 9; k++) brunt_free(F[side][k]), brunt_free(L[side][k]);
    for (int k = 0; k < 6; k++) brunt_free(points.stress[k]);
    for (int k = 0; k < scalars; k++) brunt_free(points.state[k]);
    brunt_free(volume), brunt_free(points.plastic_increment), brunt_free(points.viscous_pressure);
    if (wrong) fprintf(stderr, "bench_materials: %s: %s\n", c->model->name, wrong);
    return !wrong;
}

static int add_cases(bench_case *list, int count, const brunt_model *model) {
    for (int dim = 3; dim >= 2; dim--)
        for (int with_eos = 0; with_eos <= (model->accepts_eos ? 1 : 0); with_eos++)
            for (int flowing = 0; flowing <= (model->plastic ? 1 : 0); flowing++)
                if (count < CASE_LIMIT)
                    list[count++] =
                        (bench_case){.model = model, .dim = dim, .with_eos = with_eos, .strain = flowing ? 2e-3 : 1e-6};
    return count;
}

int main(int argc, char **argv) {
    int rounds = 9, updates = 100;
    FILE *csv = NULL;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0) {
            rounds = 2, updates = 4;
        } else if (strcmp(argv[i], "-o") == 0 && i + 1 < argc && !csv) {
            csv = open_rows(argv[++i]);
            if (!csv) return 74;
        } else {
            fprintf(stderr, "usage: bench_materials [--quick] [-o FILE.csv]\n");
            return 64;
        }
    }
    bench_case *list = brunt_alloc(CASE_LIMIT * sizeof *list);
    if (!list) return 70;
    int count = 0;
    for (int m = 0; m < brunt_strength_model_count; m++) count = add_cases(list, count, brunt_strength_models[m]);
    count = add_cases(list, count, &brunt_bulk_viscosity);
    for (int m = 0; m < brunt_eos_model_count; m++) count = add_cases(list, count, brunt_eos_models[m]);
    for (int r = 0; r < rounds; r++)
        for (int i = 0; i < count; i++)
            if (!measure(&list[i], updates)) return 70;

    printf("ns per point, median of the rounds (least in brackets), %d points\n", POINTS);
    for (int i = 0; i < count; i++) {
        bench_case *c = &list[i];
        char name[96];
        const char *kind = c->strain > 1e-4 ? "flowing" : "elastic";
        snprintf(name, sizeof name, "%s%s %s%s", c->dim == 2 ? "2d " : "", c->model->name, kind,
                 c->with_eos ? " with eos" : "");
        const row_key key = {"materials", name, POINTS, 1};
        const double median = write_samples(csv, key, "update", "ns/point", c->ns, c->rounds);
        printf("%-22s %dD %-8s %-8s %7.2f (%.2f)\n", c->model->name, c->dim, c->with_eos ? "with eos" : "",
               c->model->plastic ? kind : "", median, c->ns[0]);
    }
    brunt_free(list);
    return close_rows(csv) ? 0 : 74;
}
