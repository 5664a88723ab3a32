// Contact between meshes, measured: one case a call, one line out.
//
//   contact_study cubes|corner|face|ramp|stack|slide|crowd KEY=VALUE ...
//
//   h         edge length of the elements [m]                      grid      contact cell, in h (0: chosen)
//   h2        of the second cube's [m] (0: h)
//   form      node_to_facet|averaged_facets|averaged_surface|published|none|rigid
//   transfer  pic|apic, of the published form
//   n         iterations or sweeps (-1: the form's own)            mu        friction
//   touch     inelastic|elastic (contact_table.md is of the first)
//   slave     of the first two bodies the slave, 1 or 2 (0: both are)
//   element   tet4|hex8                                            end       [s]
//   speed     factor on the velocities                             stiff     factor on E
//   e1, r1    factors on E and density of the first body           dt        factor on the time step
//   turn      angle about the vertical [deg]                       shift     of everything, in h
//   load      factor on gravity                                    ramp      s over which gravity grows
//   hg        hourglass coefficient                              trace     1: a line for every sample
//   samples   how often penetration is measured; slide, crowd: steps
//   bodies    of the crowd (0: n^3)                                rounds    slide, crowd: of which the median is given
//   rows      FILE.csv: slide, crowd append to a machine's file (bench/machines/README.md)
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "brunt.h"
#include "penetration.h"
#include "rows.h"

enum { ROUND_LIMIT = 16 };

typedef struct settings {
    double h, h2, hg, grid, mu, end, speed, stiff, e1, r1, dt, turn, shift, load, ramp;
    int n, samples, threads, trace, bodies, rounds, slave;
    const char *rows;
    brunt_augury_form form;
    brunt_touch_kind touch;
    int none, rigid;
    brunt_transfer transfer;
    brunt_element_kind element;
} settings;

static double number(int argc, char **argv, const char *key, double initial) {
    size_t length = strlen(key);
    for (int i = 2; i < argc; i++)
        if (!strncmp(argv[i], key, length) && argv[i][length] == '=') return atof(argv[i] + length + 1);
    return initial;
}
static const char *word(int argc, char **argv, const char *key, const char *initial) {
    size_t length = strlen(key);
    for (int i = 2; i < argc; i++)
        if (!strncmp(argv[i], key, length) && argv[i][length] == '=') return argv[i] + length + 1;
    return initial;
}

static settings read_settings(int argc, char **argv) {
    settings s = {.h = number(argc, argv, "h", 0.5),
                  .h2 = number(argc, argv, "h2", 0),
                  .hg = number(argc, argv, "hg", NAN),
                  .grid = number(argc, argv, "grid", 0),
                  .mu = number(argc, argv, "mu", 0),
                  .end = number(argc, argv, "end", 0),
                  .speed = number(argc, argv, "speed", 1),
                  .stiff = number(argc, argv, "stiff", 1),
                  .e1 = number(argc, argv, "e1", 1),
                  .r1 = number(argc, argv, "r1", 1),
                  .dt = number(argc, argv, "dt", 1),
                  .turn = number(argc, argv, "turn", 0),
                  .shift = number(argc, argv, "shift", 0),
                  .load = number(argc, argv, "load", 1),
                  .ramp = number(argc, argv, "ramp", 0.2),
                  .n = (int)number(argc, argv, "n", -1),
                  .samples = (int)number(argc, argv, "samples", 60),
                  .threads = (int)number(argc, argv, "threads", 1),
                  .trace = (int)number(argc, argv, "trace", 0),
                  .bodies = (int)number(argc, argv, "bodies", 0),
                  .rounds = (int)number(argc, argv, "rounds", 1),
                  .slave = (int)number(argc, argv, "slave", 0),
                  .rows = word(argc, argv, "rows", NULL)};
    if (s.rounds < 1) s.rounds = 1;
    if (s.rounds > ROUND_LIMIT) s.rounds = ROUND_LIMIT;
    const char *form = word(argc, argv, "form", "node_to_facet");
    s.none = !strcmp(form, "none"), s.rigid = !strcmp(form, "rigid");
    s.form = !strcmp(form, "averaged_facets")    ? BRUNT_AUGURY_AVERAGED_FACETS
             : !strcmp(form, "averaged_surface") ? BRUNT_AUGURY_AVERAGED_SURFACE
             : !strcmp(form, "published")        ? BRUNT_AUGURY_PUBLISHED
                                                 : BRUNT_AUGURY_NODE_TO_FACET;
    s.touch = strcmp(word(argc, argv, "touch", "inelastic"), "elastic") ? BRUNT_TOUCH_INELASTIC : BRUNT_TOUCH_ELASTIC;
    s.transfer = !strcmp(word(argc, argv, "transfer", "apic"), "pic") ? BRUNT_PIC : BRUNT_APIC;
    s.element = !strcmp(word(argc, argv, "element", "tet4"), "hex8") ? BRUNT_HEX8 : BRUNT_TET4;
    return s;
}

// ------------------------------------------------------------------------------------------ worlds

static void stop(const char *what, const brunt_error *error) {
    printf("%s: %s\n", what, error->message);
    exit(1);
}

// The world of a definition whose bodies are complete.
static brunt_world *create(brunt_world_def *def, const settings *s, const char *what) {
    brunt_error error;
    if (s->slave) {
        brunt_pair_def *pair = def->contact.pairs = brunt_def_alloc(sizeof *pair);
        def->contact.pair_count = 1;
        *pair = (brunt_pair_def){
            .method = def->contact.method, .friction = def->contact.friction, .sides = BRUNT_SIDES_SLAVE};
        memcpy(pair->a, def->bodies[s->slave - 1].name, sizeof pair->a);
        memcpy(pair->b, def->bodies[2 - s->slave].name, sizeof pair->b);
    }
    brunt_world *world = brunt_world_create(def, &error);
    if (!world) stop(what, &error);
    return world;
}

static brunt_world_def begin(const settings *s, int bodies) {
    brunt_world_def def = brunt_world_def_default();
    def.threads = s->threads;
    def.energy_limit = INFINITY;
    def.end = 1e9;
    def.materials = brunt_def_alloc((size_t)bodies * sizeof *def.materials);
    def.bodies = brunt_def_alloc((size_t)bodies * sizeof *def.bodies);
    def.groups = brunt_def_alloc((size_t)bodies * sizeof *def.groups);
    def.planes = brunt_def_alloc(sizeof *def.planes);
    def.contact.method = s->none || s->rigid ? BRUNT_CONTACT_NONE : BRUNT_CONTACT_AUGURY;
    def.contact.form = s->form;
    def.contact.transfer = s->transfer;
    def.contact.iterations = s->n;
    def.contact.cell = s->grid * s->h;
    def.contact.friction = s->mu;
    def.contact.touch = s->touch;
    return def;
}

static void material(brunt_world_def *def, double E, double nu, double density) {
    brunt_material_def *m = &def->materials[def->material_count++];
    char name[16];
    snprintf(name, sizeof name, "m%d", def->material_count);
    *m = brunt_material_def_default(name, "neo-hookean");
    brunt_material_set(m, "E", E, NULL, NULL);
    brunt_material_set(m, "nu", nu, NULL, NULL);
    m->density = density;
}

static brunt_body_def *box(brunt_world_def *def, const settings *s, const char *name, const double low[3],
                           const double high[3]) {
    brunt_body_def *b = &def->bodies[def->body_count];
    *b = brunt_body_def_default();
    snprintf(b->name, sizeof b->name, "%s", name);
    b->hourglass_coefficient = s->hg;
    b->method = BRUNT_FEM, b->element = s->element, b->size = s->h, b->material = def->body_count++;
    b->shape.kind = BRUNT_BOX;
    memcpy(b->shape.min, low, sizeof b->shape.min), memcpy(b->shape.max, high, sizeof b->shape.max);
    return b;
}

static void fix(brunt_world_def *def, const char *body, const char *group) {
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", body), snprintf(g->group, sizeof g->group, "%s", group);
}

// Two cubes of 3 m that meet at an angle (section 3.2 of the paper on contact by APIC transfers).
static brunt_world_def cubes(const settings *s, const char *kind) {
    brunt_world_def def = begin(s, 2);
    material(&def, 1e8 * s->stiff * s->e1, 0.3, 2700 * s->r1);
    material(&def, 1e8 * s->stiff, 0.3, 2700);
    const double low[3] = {-1.5, -1.5, -1.5}, high[3] = {1.5, 1.5, 1.5}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0},
                 z[3] = {0, 0, 1}, o[3] = {0, 0, 0};
    brunt_body_def *a = box(&def, s, "a", low, high), *b = box(&def, s, "b", low, high);
    if (s->h2 > 0) b->size = s->h2;
    double up[3] = {0, 3.8, 0}, angle = 22 * M_PI / 180;
    if (!strcmp(kind, "corner")) {
        b->place = brunt_placement_rotate(b->place, z, M_PI / 4, o);
        b->place = brunt_placement_rotate(b->place, x, -atan(1 / sqrt(2)), o);
        up[1] = 1.5 + 1.5 * sqrt(3) + 0.35, angle = 0;
    }
    b->place = brunt_placement_translate(b->place, up);
    b->place = brunt_placement_rotate(b->place, x, strcmp(kind, "cubes") ? 0 : angle, o);
    a->velocity[1] = 35 * s->speed;
    b->velocity[1] = -35 * s->speed;
    if (!strcmp(kind, "cubes")) b->velocity[0] = b->velocity[2] = -15 * s->speed;
    double shift[3] = {s->shift * s->h, 0.37 * s->shift * s->h, -0.61 * s->shift * s->h};
    for (int k = 0; k < 2; k++) {
        brunt_body_def *body = k ? b : a;
        body->place = brunt_placement_rotate(body->place, y, s->turn * M_PI / 180, o);
        body->place = brunt_placement_translate(body->place, shift);
        double c = cos(s->turn * M_PI / 180), w = sin(s->turn * M_PI / 180), u = body->velocity[0],
               v = body->velocity[2];
        body->velocity[0] = c * u + w * v, body->velocity[2] = -w * u + c * v;
    }
    def.step = 1e-4 * (s->h2 > 0 ? fmin(s->h, s->h2) : s->h) * s->dt;
    return def;
}

static void run_cubes(const settings *s, const char *kind) {
    brunt_world_def def = cubes(s, kind);
    brunt_error error;
    brunt_world *world = create(&def, s, kind);
    brunt_gap_probe *probe = brunt_gap_probe_make(world);
    double end = s->end > 0 ? s->end : 0.15 / s->speed, deepest = 0, closest = INFINITY, most = 0, from = brunt_clock(),
           measuring = 0;
    brunt_energy energy;
    int status = BRUNT_OK;
    for (int k = 1; k <= s->samples && !status; k++) {
        while (!status && brunt_world_time(world) < end * k / s->samples * (1 - 1e-12))
            status = brunt_world_step(world, end * k / s->samples, &error);
        double depth, distance, start = brunt_clock();
        brunt_gap_measure(probe, &depth, &distance);
        brunt_world_energy(world, &energy);
        deepest = fmax(deepest, depth), closest = fmin(closest, distance);
        most = fmax(most, (energy.kinetic + energy.internal + energy.hourglass + energy.transfer) / energy.initial);
        if (s->trace)
            printf("%g kinetic %.4f internal %.4f hourglass %.4f contact %.4f depth %.4fh\n", brunt_world_time(world),
                   energy.kinetic / energy.initial, energy.internal / energy.initial, energy.hourglass / energy.initial,
                   energy.contact / energy.initial, depth / s->h);
        measuring += brunt_clock() - start;
    }
    brunt_momentum p;
    brunt_world_momentum(world, &p);
    brunt_body_sums a, b;
    brunt_body_totals(world, 0, &a), brunt_body_totals(world, 1, &b);
    double depth, distance;
    brunt_gap_measure(probe, &depth, &distance);
    printf("%s h=%g status=%d E/E0=%.4f max=%.4f contact=%.4f error=%.1e pen=%.4fh near=%.4fh now=%.2fh dP=%.1e "
           "dL=%.1e v=(%.2f %.2f %.2f) apart=%.2f steps=%lld wall=%.1f\n",
           kind, s->h, status, (energy.kinetic + energy.internal + energy.hourglass + energy.transfer) / energy.initial,
           most, energy.contact / energy.initial, energy.error_relative, deepest / s->h, closest / s->h,
           depth > 0 ? -depth / s->h : distance / s->h, p.linear_drift, p.angular_drift, b.velocity[0] - a.velocity[0],
           b.velocity[1] - a.velocity[1], b.velocity[2] - a.velocity[2], (b.velocity[1] - a.velocity[1]),
           (long long)brunt_world_steps(world), brunt_clock() - from - measuring);
    if (status) printf("  %s\n", error.message);
    brunt_gap_probe_free(probe);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}

// ------------------------------------------------------------------------------------------ ramp

// A unit cube on a ramp of 30 degrees. The ramp lies level and gravity is turned, then all is turned about the
// vertical.
static void run_ramp(const settings *s) {
    brunt_world_def def = begin(s, 2);
    material(&def, 1e10 * s->stiff, 0.3, 1e6);
    material(&def, 1e10 * s->stiff, 0.3, 1e6);
    const double slope = M_PI / 6, g = 100 * s->load, low[3] = {-0.5, 0, -0.75}, high[3] = {3.5, 0.25, 0.75},
                 l2[3] = {0, 0.25, -0.5}, h2[3] = {1, 1.25, 0.5}, y[3] = {0, 1, 0}, o[3] = {0, 0, 0};
    brunt_body_def *ramp = s->rigid ? NULL : box(&def, s, "ramp", low, high), *block = box(&def, s, "block", l2, h2);
    const double zaxis[3] = {0, 0, 1}, turn = s->turn * M_PI / 180;
    // Real slope: turned by -30 degrees about z, then about the vertical.
    for (int k = 0; k < 2; k++) {
        brunt_body_def *b = k ? block : ramp;
        if (!b) continue;
        b->place = brunt_placement_rotate(b->place, zaxis, -slope, o);
        b->place = brunt_placement_rotate(b->place, y, turn, o);
    }
    if (!s->rigid)
        fix(&def, "ramp", "ymin");
    else {
        brunt_plane_def *plane = &def.planes[def.plane_count++];
        *plane = brunt_plane_def_default();
        double n[3] = {sin(slope), cos(slope), 0};
        plane->normal[0] = cos(turn) * n[0], plane->normal[1] = n[1], plane->normal[2] = -sin(turn) * n[0];
        for (int a = 0; a < 3; a++) plane->point[a] = 0.25 * plane->normal[a];
        plane->friction = s->mu;
    }
    def.gravity[1] = -g;
    def.gravity_ramp = s->ramp;
    def.step = 2.5e-5 * s->h * s->dt;
    if (s->dt < 0) def.step = 0;
    brunt_error error;
    brunt_world *world = create(&def, s, "ramp");
    brunt_body_sums start, now;
    brunt_body_totals(world, 0, &start);
    double end = s->end > 0 ? s->end : s->ramp + 0.16, from = brunt_clock();
    int status = BRUNT_OK;
    while (!status && brunt_world_time(world) < end * (1 - 1e-12)) status = brunt_world_step(world, end, &error);
    brunt_body_totals(world, 0, &now);
    // Gravity that grows linearly over T: sliding starts as it is; distance along the slope by the double integral.
    double T = s->ramp, after = end - T, a = g * fmax(0, sin(slope) - s->mu * cos(slope)),
           exact = T > 0 ? a * (T * T / 6 + T / 2 * after + 0.5 * after * after) : 0.5 * a * end * end;
    double down[3] = {cos(slope) * cos(turn), -sin(slope), -cos(slope) * sin(turn)}, along = 0, side = 0;
    for (int k = 0; k < 3; k++) along += (now.centre[k] - start.centre[k]) * down[k];
    side = (now.centre[0] - start.centre[0]) * sin(turn) + (now.centre[2] - start.centre[2]) * cos(turn);
    brunt_gap_probe *probe = brunt_gap_probe_make(world);
    double depth, distance;
    brunt_gap_measure(probe, &depth, &distance);
    brunt_gap_probe_free(probe);
    printf("ramp h=%g mu=%g status=%d along=%.6f exact=%.6f error=%.3f%% diff=%.2e side=%.1e pen=%.4fh steps=%lld "
           "wall=%.1f\n",
           s->h, s->mu, status, along, exact, exact > 0 ? 100 * (along / exact - 1) : 0, along - exact, side,
           depth / s->h, (long long)brunt_world_steps(world), brunt_clock() - from);
    if (status) printf("  %s\n", error.message);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}

// ------------------------------------------------------------------------------------------ stack

// A block on a block on a block that is fixed, under gravity, for many steps.
static void run_stack(const settings *s) {
    brunt_world_def def = begin(s, 3);
    const double E = 1e6 * s->stiff, density = 1000;
    const double weight = 0.05 * E / (density * 1.0) * s->load; // rho g L / E = 0.05
    const char *names[3] = {"a", "b", "c"};
    for (int k = 0; k < 3; k++) {
        const double low[3] = {k ? -0.5 : -1, k, k ? -0.5 : -1}, high[3] = {k ? 0.5 : 1, k + 1.0, k ? 0.5 : 1};
        material(&def, E * (k == 0 ? s->e1 : 1), 0.3, density * (k == 0 ? s->r1 : 1));
        brunt_body_def *b = box(&def, s, names[k], low, high);
        double shift[3] = {k ? s->shift * s->h : 0, 0, k ? 0.37 * s->shift * s->h : 0};
        b->place = brunt_placement_translate(b->place, shift);
        def.materials[k].bulk_viscosity = false;
        brunt_material_set(&def.materials[k], "viscosity", 0, NULL, NULL);
    }
    fix(&def, "a", "ymin");
    def.gravity[1] = -weight;
    def.gravity_ramp = s->ramp;
    def.cfl = 0.5 * s->dt;
    brunt_error error;
    brunt_world *world = create(&def, s, "stack");
    int64_t steps = (int64_t)(s->end > 0 ? s->end : 1e5);
    brunt_body_sums start, now, late;
    brunt_body_totals(world, 2, &start);
    brunt_gap_probe *probe = brunt_gap_probe_make(world);
    brunt_reaction before, after;
    double deepest = 0, from = brunt_clock(), t0 = 0;
    int status = BRUNT_OK;
    for (int64_t k = 0; k < steps && !status; k++) {
        status = brunt_world_step(world, INFINITY, &error);
        if (k == steps / 2)
            brunt_body_totals(world, 2, &late), brunt_pair_force(world, 0, &before), t0 = brunt_world_time(world);
        if (k % (steps / 20) == 0) {
            double depth, distance;
            brunt_gap_measure(probe, &depth, &distance);
            deepest = fmax(deepest, depth);
        }
    }
    brunt_body_totals(world, 2, &now), brunt_pair_force(world, 0, &after);
    double force = (after.impulse[1] - before.impulse[1]) / (brunt_world_time(world) - t0);
    double depth, distance;
    brunt_gap_measure(probe, &depth, &distance);
    printf("stack h=%g mu=%g status=%d t=%.2f pen=%.5fh (max %.5fh) sink2nd=%.2ehh lateral=%.2eh lateral2nd=%.2eh "
           "KE/mgh=%.1e N/mg-1=%.1e steps=%lld wall=%.1f\n",
           s->h, s->mu, status, brunt_world_time(world), depth / s->h, deepest / s->h,
           (now.centre[1] - late.centre[1]) / s->h,
           hypot(now.centre[0] - start.centre[0], now.centre[2] - start.centre[2]) / s->h,
           hypot(now.centre[0] - late.centre[0], now.centre[2] - late.centre[2]) / s->h,
           now.kinetic / (now.mass * weight * s->h), force / (2 * now.mass * weight) - 1,
           (long long)brunt_world_steps(world), brunt_clock() - from);
    if (status) printf("  %s\n", error.message);
    brunt_gap_probe_free(probe);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}

// ------------------------------------------------------------------------------------------ cost

static double pass_seconds(const brunt_world *world, const char *name) {
    for (int32_t p = 0; p < brunt_pass_count(world); p++)
        if (!strcmp(brunt_world_pass(world, p).name, name)) return brunt_world_pass(world, p).seconds;
    return 0;
}

typedef struct cost {
    double contact[ROUND_LIMIT], step[ROUND_LIMIT]; // [s] a step: the pass of contact, all
    int rounds, status;
} cost;

// One round of so many steps.
static void measure_cost(cost *c, brunt_world *world, int steps, brunt_error *error) {
    const double before = pass_seconds(world, "surfaces"), from = brunt_clock();
    int done = 0;
    for (; done < steps && !c->status; done++) c->status = brunt_world_step(world, INFINITY, error);
    c->step[c->rounds] = (brunt_clock() - from) / done;
    c->contact[c->rounds++] = (pass_seconds(world, "surfaces") - before) / done;
}

// A line, and rows; `nodes` that contact is counted by, `units` the name is about.
static void report_cost(const settings *s, const char *name, double units, double nodes, const brunt_world *world,
                        cost *c) {
    FILE *csv = s->rows ? open_rows(s->rows) : NULL;
    const row_key key = {"contact", name, units, s->threads};
    const double step = write_samples(csv, key, "step", "s", c->step, c->rounds),
                 elements = (double)brunt_world_elements(world);
    for (int r = 0; r < c->rounds; r++) c->contact[r] *= 1e9 / nodes;
    const double contact = write_samples(csv, key, "contact", "ns/node", c->contact, c->rounds);
    printf(
        "%s threads=%d bodies=%d elements=%.0f nodes=%.0f steps=%lld dt=%.3e rounds=%d ns/element-step=%.1f contact: "
        "share=%.1f%% ns/surface-node-step=%.1f (%.1f) status=%d\n",
        name, s->threads, (int)brunt_body_count(world), elements, nodes, (long long)brunt_world_steps(world),
        brunt_world_dt(world), c->rounds, (1e9 * step - contact * nodes) / elements, 1e-7 * contact * nodes / step,
        contact, c->contact[0], c->status);
    if (s->rows && (!csv || !close_rows(csv))) exit(BRUNT_IO_ERROR);
}

// Two plates of 140 x 140 x 6 hexahedra, one sliding on the other under pressure: 19,881 nodes a side in contact.
static void run_slide(const settings *s) {
    brunt_world_def def = begin(s, 2);
    int n = (int)lround(140 / s->h);
    const double low[3] = {0, 0, 0}, high[3] = {n, 6, n}, l2[3] = {0, 6, 0}, h2[3] = {n, 12, n};
    material(&def, 1e9, 0.3, 1000), material(&def, 1e9, 0.3, 1000);
    settings one = *s;
    one.h = 1, one.element = BRUNT_HEX8;
    brunt_body_def *a = box(&def, &one, "a", low, high), *b = box(&def, &one, "b", l2, h2);
    (void)a;
    b->velocity[0] = 10, b->velocity[2] = 3;
    def.contact.cell = s->grid;
    fix(&def, "a", "ymin");
    def.gravity[1] = -1e4;
    brunt_error error;
    brunt_world *world = create(&def, s, "slide");
    cost c = {.rounds = 0};
    char name[64];
    const int steps = s->samples / s->rounds > 1 ? s->samples / s->rounds : 1;
    for (int k = 0; k < s->samples / 4 && !c.status; k++) c.status = brunt_world_step(world, INFINITY, &error);
    for (int r = 0; r < s->rounds && !c.status; r++) measure_cost(&c, world, steps, &error);
    if (c.status) stop("slide", &error);
    const double nodes = 2.0 * (n + 1) * (n + 1);
    snprintf(name, sizeof name, "augury slide %d sweeps%s%s", s->n > 0 ? s->n : 16, s->slave ? " one way" : "",
             s->touch == BRUNT_TOUCH_ELASTIC ? " elastic" : "");
    report_cost(s, name, nodes, nodes, world, &c);
    brunt_world_destroy(world);
    brunt_world_def_free(&def);
}

// Cubes of 4^3 cells, layer by layer in a cube of them, falling on each other and on the floor.
static brunt_world_def crowd(const settings *s, int count) {
    const int n = (int)ceil(cbrt(count) - 1e-9);
    settings one = *s;
    one.h = 0.25, one.n = -1;
    brunt_world_def def = begin(&one, count);
    material(&def, 1e7, 0.3, 1000);
    for (int k = 0; k < count; k++) {
        int i = k % n, j = k / n % n, l = k / n / n;
        double at[3] = {1.02 * i + 0.03 * l, 1.05 * l, 1.02 * j - 0.02 * l}, top[3] = {at[0] + 1, at[1] + 1, at[2] + 1};
        char name[16];
        snprintf(name, sizeof name, "c%05d", k);
        brunt_body_def *b = box(&def, &one, name, at, top);
        b->material = 0;
    }
    brunt_plane_def *plane = &def.planes[def.plane_count++];
    *plane = brunt_plane_def_default();
    plane->normal[1] = 1, plane->point[1] = -0.05;
    def.gravity[1] = -100;
    return def;
}

// Each round is the same fall.
static void run_crowd(const settings *s) {
    const int n = s->n > 0 ? s->n : 2, count = s->bodies > 0 ? s->bodies : n * n * n;
    brunt_error error;
    cost c = {.rounds = 0};
    for (int r = 0; r < s->rounds; r++) {
        brunt_world_def def = crowd(s, count);
        brunt_world *world = create(&def, s, "crowd");
        measure_cost(&c, world, s->samples, &error);
        if (c.status) stop("crowd", &error);
        if (r == s->rounds - 1) report_cost(s, "augury crowd", count, count * 98.0, world, &c);
        brunt_world_destroy(world);
        brunt_world_def_free(&def);
    }
}

int main(int argc, char **argv) {
    if (argc < 2) return fprintf(stderr, "contact_study cubes|corner|face|ramp|stack|slide|crowd KEY=VALUE ...\n"), 64;
    settings s = read_settings(argc, argv);
    if (!strcmp(argv[1], "ramp"))
        run_ramp(&s);
    else if (!strcmp(argv[1], "stack"))
        run_stack(&s);
    else if (!strcmp(argv[1], "slide"))
        run_slide(&s);
    else if (!strcmp(argv[1], "crowd"))
        run_crowd(&s);
    else
        run_cubes(&s, argv[1]);
    return 0;
}
