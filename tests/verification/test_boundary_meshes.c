// Surfaces of facets anywhere in the grid that hold implicit material points: reactions, places, release, friction.
#include <math.h>

#include "tests/support/implicit_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double CELL = 0.1, DENSITY = 1000, YOUNG = 1e6;

// How a test lies in space: turned, then shifted.
typedef struct lie {
    double turn[9], shift[3];
} lie;

// Turned about (1, 2, 2) / 3.
static lie lying(double angle, double x, double y, double z) {
    static const double axis[3] = {1.0 / 3, 2.0 / 3, 2.0 / 3};
    lie l = {.shift = {x, y, z}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            const int other = 3 - i - k;
            const double across = i == k ? 0 : (k == (i + 1) % 3 ? -1 : 1) * axis[other % 3];
            l.turn[3 * i + k] = cos(angle) * (i == k) + (1 - cos(angle)) * axis[i] * axis[k] + sin(angle) * across;
        }
    return l;
}

static void turned(const lie *l, const double v[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = l->turn[3 * i] * v[0] + l->turn[3 * i + 1] * v[1] + l->turn[3 * i + 2] * v[2];
}

// Along an axis of the test.
static double along(const lie *l, int axis, const double v[3]) {
    return l->turn[axis] * v[0] + l->turn[3 + axis] * v[1] + l->turn[6 + axis] * v[2];
}

static brunt_world_def meshes(int order, double step, double nu) {
    brunt_world_def def = def_begin(3, CELL);
    def_material(&def, "neo-hookean", DENSITY, YOUNG, nu);
    hold_by_surfaces(&def, order, step);
    return def;
}

static brunt_body_def *def_block(brunt_world_def *def, const lie *l, const double low[3], const double high[3]) {
    brunt_body_def *b = def_box(def, "block", low, high);
    memcpy(b->place.rotation, l->turn, sizeof l->turn);
    memcpy(b->place.translation, l->shift, sizeof l->shift);
    return b;
}

// A rectangle from `corner` along u and v, in `parts` along each, of triangles or quadrangles; its normal is u x v.
static brunt_boundary_surface_def *def_mesh(brunt_world_def *def, const lie *l, const double corner[3],
                                            const double u[3], const double v[3], int parts, bool quads,
                                            brunt_condition condition) {
    brunt_boundary_surface_def *s = &def->surfaces[def->surface_count++];
    *s = brunt_boundary_surface_def_default();
    s->condition = condition;
    s->point = brunt_alloc((size_t)(parts + 1) * (size_t)(parts + 1) * sizeof *s->point);
    s->facet = brunt_alloc((size_t)parts * (size_t)parts * 2 * sizeof *s->facet);
    for (int i = 0; i <= parts; i++)
        for (int j = 0; j <= parts; j++) {
            double x[3];
            for (int k = 0; k < 3; k++) x[k] = corner[k] + u[k] * i / parts + v[k] * j / parts;
            turned(l, x, s->point[s->point_count]);
            for (int k = 0; k < 3; k++) s->point[s->point_count][k] += l->shift[k];
            s->point_count++;
        }
    for (int i = 0; i < parts; i++)
        for (int j = 0; j < parts; j++) {
            const int32_t a = i * (parts + 1) + j, b = a + parts + 1;
            const int32_t quad[4] = {a, b, b + 1, a + 1}, one[4] = {a, b, b + 1, -1}, other[4] = {a, b + 1, a + 1, -1};
            memcpy(s->facet[s->facet_count++], quads ? quad : one, sizeof one);
            if (!quads) memcpy(s->facet[s->facet_count++], other, sizeof other);
        }
    return s;
}

static void load_along(brunt_world_def *def, const lie *l, const double g[3]) { turned(l, g, def->gravity); }

// What boundary particles say together.
typedef struct sight {
    double area, force[3];       // [m^2], [N]
    double least, most;          // [m^2] of a piece
    double unlike;               // least mean normal of a piece
    double range, within, round; // greatest traction over the least; how uneven it is in a piece; how far normals are
                                 // from those of a sphere
} sight;

static sight look(const brunt_world *world, int surface) {
    const int64_t count = brunt_boundary_surface_size(world, surface);
    double *values = malloc((size_t)count * 10 * sizeof *values), low = INFINITY, high = 0, area = 0;
    int64_t *piece = malloc((size_t)count * sizeof *piece);
    const brunt_boundary_surface_arrays arrays = {values, values + 3 * count, values + 6 * count, values + 9 * count,
                                                  piece};
    sight s = {.least = INFINITY, .unlike = 1};
    double mean[3] = {0, 0, 0};
    brunt_boundary_surface_particles(world, surface, &arrays);
    for (int64_t b = 0; b < count; b++) {
        const double *t = arrays.traction + 3 * b, *x = arrays.position + 3 * b, *n = arrays.normal + 3 * b;
        const double size = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]),
                     away = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        double off = 0;
        low = fmin(low, size), high = fmax(high, size);
        s.area += arrays.weight[b], area += arrays.weight[b];
        for (int k = 0; k < 3; k++) {
            s.force[k] += arrays.weight[b] * t[k];
            off += (n[k] + x[k] / away) * (n[k] + x[k] / away);
            mean[k] += arrays.weight[b] * n[k];
        }
        s.round = fmax(s.round, sqrt(off));
        if (b > 0 && piece[b] == piece[b - 1] && size > 0) {
            const double before = sqrt(t[-3] * t[-3] + t[-2] * t[-2] + t[-1] * t[-1]);
            s.within = fmax(s.within, fabs(before / size - 1));
        }
        if (b + 1 < count && piece[b] == piece[b + 1]) continue;
        const double sum = sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
        s.unlike = fmin(s.unlike, sum / area);
        s.least = fmin(s.least, area), s.most = fmax(s.most, area), area = mean[0] = mean[1] = mean[2] = 0;
    }
    s.range = high / low;
    free(values), free(piece);
    return s;
}

// A bar that hangs by a face, at any cut of the cells; the load acts along it, in one step as long as one likes.
START_TEST(hangs) {
    const int order = 2 - _i % 2;
    const lie l = lying(_i / 2 % 2 ? 0.7 : 0, 0.0125 * (_i / 4), 0.03 * (_i / 4), _i / 4 == 3 ? 1e-9 : 0);
    brunt_world_def def = meshes(order, 1e5, 0);
    def_block(&def, &l, XYZ(0, 0, 0), XYZ(0.6, 0.3, 0.3))->particles_per_cell = 27;
    def_mesh(&def, &l, XYZ(0, 0, 0), XYZ(0, 0.3, 0), XYZ(0, 0, 0.3), 2, _i % 3 == 0, BRUNT_STICK);
    load_along(&def, &l, XYZ(0.3, 0, 0));
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_steps(world, 1);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double weight = 0.054 * DENSITY * 0.3, exact = DENSITY * 0.3 * 0.36 / 3 / YOUNG;
    double went[3];
    for (int k = 0; k < 3; k++) went[k] = after.centre[k] - before.centre[k];
    brunt_boundary_surface_report report;
    brunt_boundary_surface_read(world, 0, &report);
    const double *c = after.centre, *g = f.force;
    double turn = 0;
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        turn = fmax(turn, fabs(report.moment[k] - (c[i] * g[j] - c[j] * g[i])));
    }
    const sight seen = look(world, 0);
    printf("  order %d turned %.1f: force %+.1e across %.1e, moment %.1e, centre %+.1e, traction %.4f\n", order,
           _i / 2 % 2 ? 0.7 : 0, along(&l, 0, f.force) / weight + 1,
           hypot(along(&l, 1, f.force), along(&l, 2, f.force)) / weight, turn / weight, along(&l, 0, went) / exact - 1,
           seen.range);
    ck_assert_int_eq(report.pieces, 4);
    ck_assert_int_eq(report.active, 4);
    ck_assert_double_le(fabs(along(&l, 0, f.force) / weight + 1), 1e-10);
    ck_assert_double_le(hypot(along(&l, 1, f.force), along(&l, 2, f.force)) / weight, 1e-10);
    ck_assert_double_le(turn / weight, 1e-10);
    ck_assert_double_le(fabs(along(&l, 0, went) / exact - 1), order == 2 ? 1e-2 : 6e-2); // as the points fill cells
    ck_assert_double_le(seen.range, 1.02);
    ck_assert_double_le(fabs(seen.area - 0.09), 1e-12);
    ck_assert_double_le(seen.most - seen.least, 1e-12);
    ck_assert_double_le(fabs(along(&l, 0, seen.force) / weight + 1), 2e-2); // as far as weights are of nodes with mass
    brunt_world_destroy(world);
}
END_TEST

// A block on a large plane, in a grid that lies askew to it.
static brunt_world_def block(const lie *l, brunt_condition condition, double step, int parts) {
    brunt_world_def def = meshes(2, step, 0.3);
    def_block(&def, l, XYZ(0, 0, 0), XYZ(0.3, 0.4, 0.1));
    def_mesh(&def, l, XYZ(-0.5, -0.5, 0), XYZ(3, 0, 0), XYZ(0, 1.5, 0), parts, false, condition);
    return def;
}

static const double MASS = 12; // flat, so that it does not tip

typedef struct way {
    double of[3], momentum; // [m] of the block along the test's axes; drift of momentum
} way;

static way go(brunt_world *world, const lie *l, int steps) {
    const brunt_body_sums before = world_sums(world, 0);
    world_steps(world, steps);
    const brunt_body_sums after = world_sums(world, 0);
    double went[3];
    for (int k = 0; k < 3; k++) went[k] = after.centre[k] - before.centre[k];
    way w = {.momentum = world_momentum(world).linear_drift};
    for (int k = 0; k < 3; k++) w.of[k] = along(l, k, went);
    return w;
}

// Along a plane of triangles a block slides as if nothing were there, and presses with its weight.
START_TEST(slides) {
    const lie l = lying(_i / 2 ? 0.7 * _i : 0, 0.02, 0.01, 0.03);
    const bool newmark = _i % 2;
    brunt_world_def def = block(&l, _i / 2 == 1 ? BRUNT_SEPARATE : BRUNT_SLIP, 0.01, 3);
    def.integrator = newmark ? BRUNT_NEWMARK : BRUNT_EULER;
    load_along(&def, &l, XYZ(9.81 * 0.8, 0, -9.81 * 0.6));
    brunt_world *world = world_take(&def);
    const way w = go(world, &l, 25);
    const brunt_reaction f = world_boundary(world, 0);
    const double wanted = 0.5 * 9.81 * 0.8 * 0.0625 * (newmark ? 1 : 1.04), weight = MASS * 9.81 * 0.6 * 0.25;
    printf("  %s %s: slid off by %+.1e, across %.1e %.1e cells, impulse off by %+.1e along %.1e, momentum %.1e\n",
           _i / 2 == 1 ? "separate" : "slip", newmark ? "newmark" : "euler", w.of[0] / wanted - 1, w.of[1] / CELL,
           w.of[2] / CELL, along(&l, 2, f.impulse) / weight - 1, along(&l, 0, f.impulse) / weight, w.momentum);
    ck_assert_double_le(fabs(w.of[0] / wanted - 1), 1e-8);
    ck_assert_double_le(fabs(w.of[1]), 1e-8 * CELL);
    ck_assert_double_le(fabs(w.of[2]), 2e-2 * CELL);
    ck_assert_double_le(fabs(along(&l, 2, f.impulse) / weight - 1), 1e-2);
    ck_assert_double_le(fabs(along(&l, 0, f.impulse)) / weight, 1e-10);
    ck_assert_double_le(w.momentum, 1e-10);
    brunt_world_destroy(world);
}
END_TEST

// A surface that carries a block along takes as much as the block is given, at every step.
START_TEST(carries) {
    const lie l = lying(0.7, 0.02, 0.01, 0.03);
    brunt_world_def def = block(&l, BRUNT_STICK, 0.01, 3);
    double v[3];
    def.integrator = _i ? BRUNT_NEWMARK : BRUNT_EULER;
    turned(&l, XYZ(0.3, 0.1, 0.2), v);
    memcpy(def.surfaces[0].value, v, sizeof v);
    if (_i) { // by its place
        static const double table[2][2] = {{0, 0}, {100, 100}};
        brunt_boundary_surface_def *s = &def.surfaces[0];
        s->displacement = true;
        s->table.points = brunt_alloc(sizeof table), s->table.count = 2;
        memcpy(s->table.points, table, sizeof table);
    }
    def_velocity(&def.bodies[0], v[0], v[1], v[2]);
    load_along(&def, &l, XYZ(0, 0, -1));
    brunt_world *world = world_take(&def);
    const way w = go(world, &l, 50);
    const brunt_reaction f = world_boundary(world, 0);
    const brunt_energy e = world_energy(world);
    printf("  %s: impulse off by %+.1e, block by %+.1e %+.1e %+.1e cells, momentum %.1e, energy %.1e, work %.4f J\n",
           _i ? "newmark" : "euler", along(&l, 2, f.impulse) / (MASS * 0.5) - 1, (w.of[0] - 0.15) / CELL,
           (w.of[1] - 0.05) / CELL, (w.of[2] - 0.1) / CELL, w.momentum, e.error_relative, e.external_work);
    ck_assert_double_le(fabs(along(&l, 2, f.impulse) / (MASS * 0.5) - 1), 1e-2);
    ck_assert_double_le(fabs(w.of[0] - 0.15), 1e-3 * CELL);
    ck_assert_double_le(fabs(w.of[1] - 0.05), 1e-3 * CELL);
    ck_assert_double_le(fabs(w.of[2] - 0.1), 5e-3 * CELL);
    ck_assert_double_le(w.momentum, 1e-10);
    ck_assert_double_le(fabs(e.error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// Friction: a block on a slope stays below the angle of friction, and above it slides as Coulomb says.
START_TEST(rubs) {
    static const double friction[] = {0.9, 0.4};
    const lie l = lying(0.7, 0.02, 0.01, 0.03);
    const double mu = friction[_i], g[3] = {4.8, 1.4, -7.5}, pull = 5;
    brunt_world_def def = block(&l, BRUNT_SEPARATE, _i ? 5e-3 : 0.1, 3); // what sticks comes to rest first
    def.surfaces[0].friction = mu;
    def.materials[0].strength_parameters[0] = 100 * YOUNG;
    load_along(&def, &l, g);
    brunt_world *world = world_take(&def);
    const way w = go(world, &l, 15);
    const brunt_reaction f = world_boundary(world, 0);
    const brunt_body_sums s = world_sums(world, 0);
    const double wanted = fmax(0, pull + mu * g[2]) * 0.075,
                 speed = hypot(along(&l, 0, s.velocity), along(&l, 1, s.velocity));
    brunt_newton_counts n;
    brunt_world_newton(world, &n, NULL);
    const double share = hypot(along(&l, 0, f.impulse), along(&l, 1, f.impulse)) / along(&l, 2, f.impulse),
                 aside =
                     (along(&l, 0, f.impulse) * g[1] - along(&l, 1, f.impulse) * g[0]) / pull / along(&l, 2, f.impulse);
    printf("  friction %.1f: speed %.6f, %.6f wanted; force %.6f of the normal one, aside %.1e; momentum %.1e; %.1f "
           "iterations a step\n",
           mu, speed, wanted, share, aside, w.momentum, n.iterations / n.steps);
    ck_assert_double_le(fabs(speed - wanted), 1e-4 * pull * 0.075);
    ck_assert_double_le(fabs(share - fmin(mu, pull / -g[2])), 1e-4);
    ck_assert_double_le(fabs(aside), 1e-4);
    ck_assert_double_ge(f.friction_work, 0);
    ck_assert_double_le(w.momentum, 1e-10);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-5);
    brunt_world_destroy(world);
}
END_TEST

// A surface that moves along drags a block by its friction until it has the same speed; its work is that of the force.
START_TEST(drags) {
    const lie l = lying(0.7, 0.02, 0.01, 0.03);
    brunt_world_def def = block(&l, BRUNT_SEPARATE, 0.01, 3);
    def.surfaces[0].friction = 0.4;
    def.materials[0].strength_parameters[0] = 100 * YOUNG;
    turned(&l, XYZ(0.3, 0.4, 0), def.surfaces[0].value);
    load_along(&def, &l, XYZ(0, 0, -10));
    brunt_world *world = world_take(&def);
    for (int k = 0; k < 3; k++) {
        go(world, &l, k < 2 ? 5 : 8);
        const brunt_body_sums s = world_sums(world, 0);
        const brunt_reaction f = world_boundary(world, 0);
        const double wanted = fmin(0.5, 4 * brunt_world_time(world)), x = along(&l, 0, s.velocity),
                     y = along(&l, 1, s.velocity), pull = 0.6 * along(&l, 0, f.impulse) + 0.8 * along(&l, 1, f.impulse),
                     work = world_energy(world).external_work;
        printf("  speed %.6f, %.6f wanted, aside %.1e, impulse %.6f of the momentum, work %.5f J, %.5f wanted\n",
               hypot(x, y), wanted, x * 0.8 - y * 0.6, pull / (MASS * wanted), work, 0.5 * pull);
        ck_assert_double_le(fabs(hypot(x, y) - wanted), 1e-3 * 0.5);
        ck_assert_double_le(fabs(x * 0.8 - y * 0.6), 1e-4);
        ck_assert_double_le(fabs(pull / (MASS * wanted) - 1), 1e-3);
        ck_assert_double_le(fabs(work / (0.5 * pull) - 1), 1e-3);
        ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    }
    brunt_world_destroy(world);
}
END_TEST

// What may leave a surface does so without being pulled; so does a body that the surface is moved away from.
START_TEST(leaves) {
    const lie l = lying(0.7, 0.02, 0.01, 0.03);
    brunt_world_def def = block(&l, BRUNT_SEPARATE, 5e-3, 3);
    if (_i)
        turned(&l, XYZ(0, 0, -1), def.surfaces[0].value);
    else
        load_along(&def, &l, XYZ(0, 0, 5));
    brunt_world *world = world_take(&def);
    go(world, &l, 20);
    const brunt_reaction f = world_boundary(world, 0);
    printf("  impulse %.1e N s\n", along(&l, 2, f.impulse));
    ck_assert_double_ge(along(&l, 2, f.impulse), -1e-12);
    ck_assert_double_le(along(&l, 2, f.impulse), 1e-9);
    brunt_world_destroy(world);
}
END_TEST

// A block that comes to a surface meets it where its own particles end; until then there is no force.
START_TEST(meets) {
    const lie l = lying(0.35 * _i, 0.013 * _i, 0, 0.027 * _i);
    brunt_world_def def = block(&l, _i % 2 ? BRUNT_SLIP : BRUNT_SEPARATE, 4e-3, 3);
    double v[3], up[3];
    turned(&l, XYZ(0, 0, -1), v), turned(&l, XYZ(0, 0, 0.06), up);
    for (int k = 0; k < 3; k++) def.bodies[0].place.translation[k] += up[k];
    def_velocity(&def.bodies[0], v[0], v[1], v[2]);
    brunt_world *world = world_take(&def);
    double first = -1;
    for (int s = 0; s < 40 && first < 0; s++) {
        world_steps(world, 1);
        const brunt_reaction f = world_boundary(world, 0);
        if (f.force[0] != 0 || f.force[1] != 0 || f.force[2] != 0) first = brunt_world_time(world);
    }
    printf("  %s: first force %.4f cells early\n", _i % 2 ? "slip" : "separate", (0.06 - first) / CELL);
    ck_assert_double_ge(first, 0);
    ck_assert_double_le(fabs(0.06 - first), 0.05 * CELL);
    brunt_world_destroy(world);
}
END_TEST

// A surface made of the six sides of a cube, in parts^2 quadrangles each, whose normals point inwards; drawn out to a
// sphere unless it has teeth: then every other corner of its quadrangles is `teeth` [m] further in.
static brunt_boundary_surface_def *def_hole(brunt_world_def *def, double radius, int parts, double teeth,
                                            brunt_condition condition) {
    brunt_boundary_surface_def *s = &def->surfaces[def->surface_count++];
    *s = brunt_boundary_surface_def_default();
    s->condition = condition;
    s->point = brunt_alloc((size_t)(6 * parts * parts * 4) * sizeof *s->point);
    s->facet = brunt_alloc((size_t)(6 * parts * parts) * sizeof *s->facet);
    for (int side = 0; side < 6; side++)
        for (int q = 0; q < parts * parts; q++) {
            int32_t *corner = s->facet[s->facet_count++];
            for (int k = 0; k < 4; k++) {
                const int i = q / parts + (k == 1 || k == 2), j = q % parts + (k == 2 || k == 3);
                const double a = tan(PI / 4 * (2.0 * i / parts - 1)), b = tan(PI / 4 * (2.0 * j / parts - 1));
                const int n = side / 2, sign = side % 2 ? 1 : -1;
                double x[3];
                x[n] = sign, x[(n + 1) % 3] = sign < 0 ? a : b, x[(n + 2) % 3] = sign < 0 ? b : a;
                const bool border = i == 0 || i == parts || j == 0 || j == parts;
                const double size = teeth > 0 ? 1 : sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
                for (int c = 0; c < 3; c++) x[c] *= radius / size;
                if (!border && (i + j) % 2) x[n] -= sign * teeth;
                int32_t at = 0; // corners of sides that meet are one
                while (at < s->point_count && memcmp(s->point[at], x, sizeof x)) {
                    double away = 0;
                    for (int c = 0; c < 3; c++) away = fmax(away, fabs(s->point[at][c] - x[c]));
                    if (away < 1e-9) break;
                    at++;
                }
                if (at == s->point_count) memcpy(s->point[s->point_count++], x, sizeof x);
                corner[k] = at;
            }
        }
    return s;
}

// A ball in a round hole that is as large rests in it, whatever the surface lets go.
START_TEST(hole) {
    static const brunt_condition conditions[] = {BRUNT_STICK, BRUNT_SLIP, BRUNT_SEPARATE, BRUNT_SEPARATE};
    brunt_world_def def = meshes(2, 0.05, 0.3);
    def_ball(&def, "ball", XYZ(0, 0, 0), 0.25)->particles_per_cell = 27;
    def_hole(&def, 0.25, 5, 0, conditions[_i]);
    if (_i == 3) def.surfaces[0].friction = 0.3;
    def.gravity[0] = 0.3, def.gravity[1] = -1, def.gravity[2] = 0.2;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_steps(world, 1);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    brunt_boundary_surface_report report;
    brunt_boundary_surface_read(world, 0, &report);
    const double sinks = before.centre[1] - after.centre[1], size = before.mass;
    const sight seen = look(world, 0);
    printf("  normals off by %.3f, pieces of %.4f to %.4f m^2, tractions within one differ by %.1e\n", seen.round,
           seen.least, seen.most, seen.within);
    ck_assert_double_le(seen.round, 0.05); // 18 degrees a side
    ck_assert_double_le(seen.most / seen.least, 1.3);
    ck_assert_double_le(seen.within, 1e-12); // friction is across the pressure at each place
    printf("  condition %d: force %+.1e, moment %.1e %.1e %.1e, sinks by %.1e, %d of %d pieces, momentum %.1e\n", _i,
           f.force[1] / size - 1, report.moment[0] / size, report.moment[1] / size, report.moment[2] / size, sinks,
           report.active, report.pieces, world_momentum(world).linear_drift);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    ck_assert_double_ge(sinks, 0);
    ck_assert_double_le(sinks, 1e-2 * CELL);
    for (int k = 0; k < 3; k++) ck_assert_double_le(fabs(report.moment[k]) / size, 5e-3);
    ck_assert_int_ge(report.pieces, 30); // of 0.785 m^2
    ck_assert_int_le(report.pieces, 35);
    brunt_world_destroy(world);
}
END_TEST

// The two sides of a thin plate with round ends are not one piece, though they go over into each other.
START_TEST(thin) {
    enum { ROUND = 8 };
    const lie l = lying(0.7, 0.02, 0.01, 0.03);
    brunt_world_def def = block(&l, BRUNT_SLIP, 0.01, 1);
    brunt_boundary_surface_def *s = &def.surfaces[def.surface_count++];
    *s = brunt_boundary_surface_def_default();
    s->point = brunt_alloc((size_t)(4 * ROUND + 4) * sizeof *s->point);
    s->facet = brunt_alloc((size_t)(2 * ROUND + 2) * sizeof *s->facet);
    for (int k = 0; k < 2 * ROUND + 2; k++) {
        const int end = k > ROUND;
        const double angle = PI * (k - end) / ROUND - PI / 2;
        for (int side = 0; side < 2; side++) {
            double *x = s->point[s->point_count++];
            x[0] = (end ? -0.3 : 0.3) + 0.03 * cos(angle), x[1] = 0.5 * side, x[2] = 2 + 0.03 * sin(angle);
        }
        const int32_t next = k < 2 * ROUND + 1 ? 2 * k + 2 : 0, quad[4] = {2 * k, 2 * k + 1, next + 1, next};
        memcpy(s->facet[s->facet_count++], quad, sizeof quad);
    }
    brunt_world *world = world_take(&def);
    const sight seen = look(world, 1);
    printf("  pieces of %.4f to %.4f m^2, least mean normal %.3f\n", seen.least, seen.most, seen.unlike);
    ck_assert_double_ge(seen.unlike, 0.5);
    ck_assert_double_ge(seen.least, 0.5 * 0.0225);
    brunt_world_destroy(world);
}
END_TEST

// A piece of a ring that slides in a round trough swings about its axis as a pendulum does.
START_TEST(swings) {
    enum { COUNT = 41, ACROSS = 3 };
    const lie l = lying(0.7, 0.02, 0.01, 0.03);
    brunt_world_def def = meshes(2, 5e-3, 0.3);
    const double R = 2, inner = 1.7, from = 0.5, half = 0.1;
    brunt_body_def *b = def_body(&def, "sector");
    b->shape.kind = BRUNT_INTERSECTION, b->shape.child_count = 2;
    b->shape.children = brunt_alloc(2 * sizeof *b->shape.children);
    b->shape.children[0] =
        (brunt_shape){.kind = BRUNT_TUBE, .radius = R, .inner_radius = inner, .length = 0.2, .axis = {0, 0, 1}};
    b->shape.children[1] = (brunt_shape){.kind = BRUNT_PRISM, .point_count = 3, .min = {0, 0, -1}, .max = {0, 0, 1}};
    b->shape.children[1].points = brunt_alloc(3 * sizeof *b->shape.points);
    for (int k = 1; k < 3; k++) {
        const double at = from + (k == 1 ? -half : half);
        b->shape.children[1].points[k][0] = 3 * sin(at), b->shape.children[1].points[k][1] = -3 * cos(at);
    }
    memcpy(b->place.rotation, l.turn, sizeof l.turn), memcpy(b->place.translation, l.shift, sizeof l.shift);
    brunt_boundary_surface_def *s =
        def_mesh(&def, &l, XYZ(0, 0, 0), XYZ(1, 0, 0), XYZ(0, 1, 0), COUNT - 1, true, _i ? BRUNT_SEPARATE : BRUNT_SLIP);
    s->facet_count = 0;
    for (int i = 0; i < COUNT; i++)
        for (int j = 0; j <= ACROSS; j++) { // counter-clockwise as seen from the axis
            const double at = 0.9 * i / (COUNT - 1), x[3] = {R * sin(at), -R * cos(at), 0.3 - 0.4 * j / ACROSS};
            const int32_t n = i * (ACROSS + 1) + j, quad[4] = {n, n + ACROSS + 1, n + ACROSS + 2, n + 1};
            turned(&l, x, s->point[n]);
            for (int k = 0; k < 3; k++) s->point[n][k] += l.shift[k];
            if (i + 1 < COUNT && j < ACROSS) memcpy(s->facet[s->facet_count++], quad, sizeof quad);
        }
    def.materials[0].strength_parameters[0] = 100 * YOUNG;
    def.integrator = BRUNT_NEWMARK;
    load_along(&def, &l, XYZ(0, -9.81, 0));
    brunt_world *world = world_take(&def);
    double x[2], found[2], arm = 0;
    for (int k = 0; k < 2; k++) {
        if (k) world_steps(world, 40);
        const brunt_body_sums sums = world_sums(world, 0);
        double c[3];
        for (int a = 0; a < 3; a++) c[a] = sums.centre[a] - l.shift[a];
        for (int a = 0; a < 2; a++) x[a] = along(&l, a, c);
        found[k] = atan2(x[0], -x[1]);
        if (!k) arm = hypot(x[0], x[1]);
    }
    double angle = found[0], speed = 0;
    for (int k = 0; k < 4000; k++) { // midpoint
        const double dt = 5e-5, middle = angle + 0.5 * dt * speed;
        speed -= dt * 9.81 * arm * 2 / (R * R + inner * inner) * sin(middle), angle = middle + 0.5 * dt * speed;
    }
    const double wanted = found[0] - angle;
    printf("  %s: way %.5f, %.5f wanted; off its circle by %+.1e cells; momentum %.1e, energy %.1e\n",
           _i ? "separate" : "slip", found[0] - found[1], wanted, (hypot(x[0], x[1]) - arm) / CELL,
           world_momentum(world).linear_drift, world_energy(world).error_relative);
    ck_assert_double_le(fabs(found[1] - angle), 2e-2 * wanted);
    ck_assert_double_le(fabs(hypot(x[0], x[1]) - arm), 0.1 * CELL);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-6);
    brunt_world_destroy(world);
}
END_TEST

// Facets that the grid cannot tell apart share pieces, whatever the edges between them.
START_TEST(teeth) {
    brunt_world_def def = meshes(2, 0.05, 0.3);
    const double width = _i == 3 ? 1e-12 : _i ? 0.04 : 0.15; // none: the sides of a cube
    def_box(&def, "block", XYZ(-0.2, -0.2, -0.2), XYZ(0.2, 0.2, 0.2));
    def_hole(&def, 0.2, _i ? 10 : 3, 0.5 * width, _i % 2 ? BRUNT_STICK : BRUNT_SLIP);
    def.gravity[0] = 0.3, def.gravity[1] = -1, def.gravity[2] = 0.2;
    brunt_world *world = world_take(&def);
    world_steps(world, 2);
    const brunt_reaction f = world_boundary(world, 0);
    brunt_boundary_surface_report report;
    brunt_boundary_surface_read(world, 0, &report);
    printf("  %d of %d pieces, force %.4f of the weight, momentum %.1e\n", report.active, report.pieces,
           f.force[1] / 64, world_momentum(world).linear_drift);
    if (_i == 3) ck_assert_int_eq(report.pieces, 24);
    ck_assert_double_le(fabs(f.force[1] / 64 - 1), 2e-2);
    ck_assert_double_le(world_momentum(world).linear_drift, 1e-10);
    brunt_world_destroy(world);
}
END_TEST

static brunt_world *rubbing(int threads, int parts, bool quads) {
    const lie l = lying(0.7, 0.02, 0.01, 0.03);
    brunt_world_def def = meshes(2, 5e-3, 0.3);
    def_block(&def, &l, XYZ(0, 0, 0), XYZ(0.2, 0.2, 0.2));
    def_mesh(&def, &l, XYZ(-0.3, -0.3, 0), XYZ(0.8, 0, 0), XYZ(0, 0.8, 0), parts, quads, BRUNT_SEPARATE);
    def.surfaces[0].friction = 0.3;
    turned(&l, XYZ(0.2, -0.1, 0), def.surfaces[0].value);
    load_along(&def, &l, XYZ(1, 0.5, -9.81));
    def.integrator = BRUNT_NEWMARK;
    def.threads = threads;
    return world_take(&def);
}

START_TEST(threads) {
    brunt_world *world[] = {rubbing(1, 2, false), rubbing(2, 2, false), rubbing(5, 2, false)};
    check_threads(world, 3, 4);
}
END_TEST

START_TEST(restart) { check_restart(rubbing(1, 2, false), rubbing(1, 2, false)); }
END_TEST

// Triangles that are cut in four each, or are halves of quadrangles, are the same surface: pieces and particles are.
START_TEST(finer) {
    brunt_body_sums sums[3];
    for (int k = 0; k < 3; k++) {
        brunt_world *world = rubbing(1, k == 1 ? 4 : 2, k == 2);
        world_steps(world, 10);
        sums[k] = world_sums(world, 0);
        brunt_world_destroy(world);
    }
    for (int k = 1; k < 3; k++) {
        double worst = 0;
        for (int a = 0; a < 3; a++)
            worst = fmax(worst, fmax(fabs(sums[k].centre[a] - sums[0].centre[a]) / CELL,
                                     fabs(sums[k].velocity[a] - sums[0].velocity[a])));
        printf("  %s: off by %.1e\n", k == 1 ? "twice as fine" : "quadrangles", worst);
        ck_assert_double_le(worst, 1e-8);
    }
}
END_TEST

// Corners go round one way, and what a surface lets go is before it.
START_TEST(turned_over) {
    static const char *const said[] = {"facets 1 and 2 turn against each other", "body 'block' is behind it",
                                       "has no area", "facet 0 has corner 99 of 4"};
    for (int k = 0; k < 4; k++) {
        const lie l = lying(0.7, 0, 0, 0);
        brunt_world_def def = block(&l, BRUNT_SEPARATE, 5e-3, 1);
        brunt_error error = {0};
        for (int32_t f = 0; f < (k == 1 ? 2 : 1); f++) {
            int32_t *corner = def.surfaces[0].facet[f];
            const int32_t kept = corner[1];
            if (k < 2) corner[1] = corner[2], corner[2] = kept;
            if (k == 2) corner[1] = corner[2];
            if (k == 3) corner[2] = 99;
        }
        ck_assert_ptr_null(brunt_world_create(&def, &error));
        printf("  %s\n", error.message);
        ck_assert_ptr_nonnull(strstr(error.message, said[k]));
        brunt_world_def_free(&def);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("boundary_meshes");
    ADD_LOOP(hangs, 16);
    ADD_LOOP(slides, 6);
    ADD_LOOP(carries, 2);
    ADD_LOOP(rubs, 2);
    ADD_LOOP(drags, 1);
    ADD_LOOP(leaves, 2);
    ADD_LOOP(meets, 8);
    ADD_LOOP(hole, 4);
    ADD_LOOP(swings, 2);
    ADD_LOOP(teeth, 4);
    ADD_LOOP(thin, 1);
    ADD_LOOP(threads, 1);
    ADD_LOOP(restart, 1);
    ADD_LOOP(finer, 1);
    ADD_LOOP(turned_over, 1);
    return suite_main(suite);
}
#endif
