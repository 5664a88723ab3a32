// What contact of material points costs: of two blocks that slide on each other, and of a block on a membrane.
//
//   bench_contact [--quick] [--cells N] [--steps N] [--rounds N] [--threads N[,N...]] [-o FILE.csv]
//
// Blocks of N x N cells and a quarter as high, 8 particles a cell (default N = 32). Contact is counted by the (N+1)^2
// nodes of the face in which they meet, of the grid or of the membrane. Rounds go through all of them one after the
// other, each in a world of its own. -o: rows of a machine's file (bench/machines/README.md) are appended.
#include <math.h>

#include "base/memory.h"
#include "rows.h"

enum { ROUND_LIMIT = 32, THREADS_LIMIT = 4, CASES = 3, WARM_UP = 3 };

typedef enum setup { TWO_BLOCKS, TWO_BLOCKS_TIED, ON_MEMBRANE } setup;
static const struct {
    const char *name, *pass;
} setups[CASES] = {
    {"multi-velocity particles", "contact"}, {"tied particles", "contact"}, {"augury membrane-particles", "surfaces"}};

typedef struct settings {
    int64_t threads[THREADS_LIMIT];
    int thread_count, cells, steps, rounds;
    const char *file;
} settings;

typedef struct contact_case {
    setup what;
    int threads;
    double contact[ROUND_LIMIT], step[ROUND_LIMIT]; // [ns] a step and node, [s] a step
    int rounds;
} contact_case;

static const double cell = 1e-3;

// A block of particles whose lower face lies at `level`.
static void put_block(brunt_body_def *body, const char *name, int cells, double level) {
    *body = brunt_body_def_default();
    snprintf(body->name, sizeof body->name, "%s", name);
    body->shape.kind = BRUNT_BOX;
    body->shape.min[2] = level, body->shape.max[2] = level + cell * fmax(1, cells / 4);
    body->shape.max[0] = body->shape.max[1] = cell * cells;
}

static void put_membrane(brunt_body_def *body, int cells) {
    static char lower_face[1][BRUNT_NAME_LENGTH] = {"zmin"};
    *body = brunt_body_def_default();
    snprintf(body->name, sizeof body->name, "membrane");
    body->shape.kind = BRUNT_BOX, body->shape.max[2] = cell;
    body->shape.max[0] = body->shape.max[1] = cell * cells;
    body->method = BRUNT_MEMBRANE, body->element = BRUNT_MEMBRANE_QUAD4, body->size = cell,
    body->thickness = 0.1 * cell;
    body->faces = lower_face, body->face_count = 1;
}

// Pressed together at 0.2 % of the wave speed, and sliding as fast.
static brunt_world *create(const contact_case *c, const settings *s, brunt_error *error) {
    brunt_world_def def = brunt_world_def_default();
    brunt_material_def rubber = brunt_material_def_default("rubber", "neo-hookean");
    rubber.density = 1100;
    brunt_material_set(&rubber, "E", 1e6, NULL, error);
    brunt_material_set(&rubber, "nu", 0.4, NULL, error);
    const double height = cell * fmax(1, s->cells / 4), speed = 0.002 * sqrt(1e6 / 1100);
    brunt_body_def bodies[2];
    if (c->what == ON_MEMBRANE) {
        put_membrane(&bodies[0], s->cells);
        put_block(&bodies[1], "upper", s->cells, 0.3 * cell);
        def.contact.method = BRUNT_CONTACT_AUGURY;
    } else {
        put_block(&bodies[0], "lower", s->cells, -height);
        put_block(&bodies[1], "upper", s->cells, 0);
        def.contact.method = c->what == TWO_BLOCKS ? BRUNT_CONTACT_MULTI_VELOCITY : BRUNT_CONTACT_TIED;
    }
    bodies[1].velocity[0] = speed, bodies[1].velocity[2] = -speed;
    def.contact.friction = c->what == TWO_BLOCKS_TIED ? 0 : 0.2;
    def.cell = cell, def.end = 1, def.energy_limit = INFINITY, def.threads = c->threads;
    def.materials = &rubber, def.material_count = 1;
    def.bodies = bodies, def.body_count = 2;
    return brunt_world_create(&def, error);
}

static double pass_seconds(const brunt_world *world, const char *name) {
    for (int32_t p = 0; p < brunt_pass_count(world); p++)
        if (strcmp(brunt_world_pass(world, p).name, name) == 0) return brunt_world_pass(world, p).seconds;
    return NAN;
}

static double nodes_of(const settings *s) { return (double)(s->cells + 1) * (s->cells + 1); }

static int measure(contact_case *c, const settings *s) {
    brunt_error error = {0};
    brunt_world *world = create(c, s, &error);
    int status = world ? BRUNT_OK : error.code;
    for (int k = 0; k < WARM_UP && !status; k++) status = brunt_world_step(world, INFINITY, &error);
    const double before = status ? 0 : pass_seconds(world, setups[c->what].pass), from = brunt_clock();
    for (int k = 0; k < s->steps && !status; k++) status = brunt_world_step(world, INFINITY, &error);
    if (status) {
        fprintf(stderr, "bench_contact: %s: %s\n", setups[c->what].name, error.message);
    } else {
        c->step[c->rounds] = (brunt_clock() - from) / s->steps;
        c->contact[c->rounds++] = 1e9 * (pass_seconds(world, setups[c->what].pass) - before) / (s->steps * nodes_of(s));
    }
    brunt_world_destroy(world);
    return status;
}

static bool read_settings(int argc, char **argv, settings *s) {
    for (int i = 1; i < argc; i++) {
        const char *option = argv[i], *value = i + 1 < argc ? argv[i + 1] : "";
        int64_t number = 0;
        bool ok = *value != 0;
        if (strcmp(option, "--quick") == 0) {
            s->cells = 16, s->steps = 4, s->rounds = 2;
            continue;
        }
        i++;
        if (strcmp(option, "--threads") == 0)
            ok = (s->thread_count = read_list(value, 64, THREADS_LIMIT, s->threads)) > 0;
        else if (strcmp(option, "-o") == 0)
            s->file = value;
        else if (strcmp(option, "--cells") == 0)
            ok = read_list(value, 400, 1, &number) == 1, s->cells = (int)number;
        else if (strcmp(option, "--steps") == 0)
            ok = read_list(value, 100000, 1, &number) == 1, s->steps = (int)number;
        else if (strcmp(option, "--rounds") == 0)
            ok = read_list(value, ROUND_LIMIT, 1, &number) == 1, s->rounds = (int)number;
        else
            ok = false;
        if (!ok) {
            fprintf(stderr, "bench_contact: %s %s is not understood\n", option, value);
            return false;
        }
    }
    return true;
}

int main(int argc, char **argv) {
    start_with_short_spins(argv);
    settings s = {.threads = {1, 2}, .thread_count = 2, .cells = 32, .steps = 6, .rounds = 3};
    if (!read_settings(argc, argv, &s)) return BRUNT_BAD_USAGE;
    FILE *csv = s.file ? open_rows(s.file) : NULL;
    if (s.file && !csv) return BRUNT_IO_ERROR;
    static contact_case list[CASES * THREADS_LIMIT];
    int count = 0, status = BRUNT_OK;
    for (int k = 0; k < CASES; k++)
        for (int t = 0; t < s.thread_count; t++)
            list[count++] = (contact_case){.what = (setup)k, .threads = (int)s.threads[t]};
    for (int r = 0; r < s.rounds && !status; r++)
        for (int k = 0; k < count && !status; k++) status = measure(&list[k], &s);
    if (!status) printf("contact of material points, median of %d rounds (least in brackets)\n", s.rounds);
    for (int k = 0; k < count && !status; k++) {
        contact_case *c = &list[k];
        const row_key key = {"contact", setups[c->what].name, nodes_of(&s), c->threads};
        const double contact = write_samples(csv, key, "contact", "ns/node", c->contact, c->rounds),
                     step = write_samples(csv, key, "step", "s", c->step, c->rounds);
        printf("%-26s %8.0f nodes %d thread%s %8.1f (%.1f) ns/node, step %.2f ms\n", key.name, key.units, c->threads,
               c->threads == 1 ? " " : "s", contact, c->contact[0], 1e3 * step);
    }
    return close_rows(csv) || status ? status : BRUNT_IO_ERROR;
}
