// Material points over triangles, of cells that are cut in two and of a mesh: what links a point to nodes, and implicit
// and static steps with lines that hold the body.
#include <math.h>

#include "grid/background.h"
#include "grid/weigh.h"
#include "tests/support/implicit_world.h"
#include "tests/support/surface_world.h"
#include "tests/support/triangle_mesh.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

static const double DENSITY = 1000, YOUNG = 90e6, WEIGHT = 9.81;

static double between(uint64_t *seed) { // -1 .. 1
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 4503599627370496.0 - 1;
}

// ------------------------------------------------------------------------------------------ weights

// Place of a node by its coordinates on the grid.
static void place_of(const brunt_grid *grid, const int32_t at[3], double x[3]) {
    for (int a = 0; a < 3; a++) x[a] = a < grid->dim ? grid->origin[a] + (double)grid->h * at[a] : 0;
    if (!grid->mesh) return;
    for (int a = 0; a < 2; a++) x[a] = grid->mesh->node[at[0] * 8 + at[1]][a];
}

// At a point: they add up to 1 and reproduce a linear field, slopes are those of it, and what differences give.
static void check_point(const brunt_grid *grid, const double x[3], const double A[4]) {
    brunt_grid_weights w, near[2];
    double slope[BRUNT_KERNEL_NODES][3], sum = 0, field = 0, gradient[3] = {0}, total[3] = {0};
    brunt_grid_weigh(grid, x, 1, &w);
    brunt_grid_slopes(grid, x, slope);
    ck_assert_int_gt(w.count, 0);
    for (int k = 0; k < w.count; k++) {
        double X[3];
        place_of(grid, w.at[k], X);
        const double f = A[0] + A[1] * X[0] + A[2] * X[1] + A[3] * X[2];
        ck_assert_double_ge(w.weight[k], -1e-12);
        sum += w.weight[k], field += w.weight[k] * f;
        for (int a = 0; a < grid->dim; a++) gradient[a] += slope[k][a] * f, total[a] += slope[k][a];
    }
    ck_assert_double_eq_tol(sum, 1, 1e-14);
    ck_assert_double_eq_tol(field, A[0] + A[1] * x[0] + A[2] * x[1] + A[3] * x[2], 1e-12);
    for (int a = 0; a < grid->dim; a++) {
        ck_assert_double_eq_tol(total[a], 0, 1e-12);
        ck_assert_double_eq_tol(gradient[a], A[a + 1], 1e-10);
    }
    for (int a = 0; a < grid->dim; a++) {
        const double step = 1e-6 * (double)grid->h;
        for (int side = 0; side < 2; side++) {
            double y[3] = {x[0], x[1], x[2]};
            y[a] += (2 * side - 1) * step;
            brunt_grid_weigh(grid, y, 1, &near[side]);
        }
        const size_t size = (size_t)w.count * sizeof *w.at;
        if (!near[0].count || !near[1].count) continue; // at the border of a mesh
        if (memcmp(near[0].at, w.at, size) || memcmp(near[1].at, w.at, size)) continue;
        for (int k = 0; k < w.count; k++)
            ck_assert_double_eq_tol((near[1].weight[k] - near[0].weight[k]) / (2 * step), slope[k][a],
                                    1e-6 / (double)grid->h);
    }
}

START_TEST(weights) {
    const int kernel = _i % 5 + 1, dim = _i < 5 ? 2 : 3;
    brunt_mesh mesh = triangle_mesh(-0.1, 0.2, 9, 7, 0.11);
    brunt_background background = {0};
    brunt_grid grid;
    uint64_t seed = 3;
    brunt_grid_init(&grid, dim, kernel > BRUNT_CUBIC ? 1 : kernel, 0.1, XYZ(0.013, -0.02, 0.3));
    ck_assert_int_eq(brunt_background_make(&background, &mesh, NULL), BRUNT_OK);
    if (kernel > BRUNT_CUBIC) brunt_grid_use_triangles(&grid, kernel == BRUNT_GRID_MESH ? &background : NULL);
    for (int k = 0; k < 2000; k++) {
        double x[3] = {0.39 + 0.49 * between(&seed), 0.58 + 0.38 * between(&seed), dim == 3 ? between(&seed) : 0}, A[4];
        for (int c = 0; c < 4; c++) A[c] = between(&seed);
        // On nodes and edges too, where slopes jump and sums must not.
        if (k % 10 == 0 && grid.mesh) memcpy(x, background.node[k / 10 % background.node_count], 2 * sizeof *x);
        check_point(&grid, x, A);
    }
    brunt_mesh_free(&mesh), brunt_background_free(&background), brunt_grid_free(&grid);
}
END_TEST

// Every point of the rectangle is in a triangle, none beyond it is.
START_TEST(found) {
    brunt_mesh mesh = triangle_mesh(-0.3, 0.1, 31, 12, 0.07);
    brunt_background background;
    uint64_t seed = 8;
    ck_assert_int_eq(brunt_background_make(&background, &mesh, NULL), BRUNT_OK);
    const double width = 31 * 0.07, height = 12 * 0.07;
    for (int k = 0; k < 20000; k++) {
        const double s = 0.5 + 0.7 * between(&seed), t = 0.5 + 0.7 * between(&seed),
                     x[2] = {-0.3 + s * width, 0.1 + t * height};
        const bool inside = s >= 0 && s <= 1 && t >= 0 && t <= 1;
        const int32_t triangle = brunt_background_find(&background, x);
        double w[3];
        ck_assert_int_eq(triangle >= 0, inside);
        if (!inside) continue;
        brunt_background_weights(&background, triangle, x, w, NULL);
        for (int c = 0; c < 3; c++) ck_assert_double_ge(w[c], -1e-9);
    }
    double area = 0;
    for (int32_t n = 0; n < background.node_count; n++) area += background.area[n];
    ck_assert_double_eq_tol(area, width * height, 1e-12);
    ck_assert_int_eq(background.edge_count, 3 * 31 * 12 - 31 - 12);
    const int32_t blocks = (background.node_count + 63) / 64;
    ck_assert_int_eq(background.edge_first[0], 0);
    ck_assert_int_eq(background.edge_first[blocks], background.edge_count);
    for (int32_t b = 0; b < blocks; b++)
        for (int32_t e = background.edge_first[b]; e < background.edge_first[b + 1]; e++)
            ck_assert_int_eq(background.edge[e][0] / 64, b);
    brunt_mesh_free(&mesh), brunt_background_free(&background);
}
END_TEST

// ------------------------------------------------------------------------------------------ a bar that hangs

static void turn(brunt_body_def *b, double c, double s) {
    b->place.rotation[0] = c, b->place.rotation[1] = -s, b->place.rotation[3] = s, b->place.rotation[4] = c;
}

// 4 m by 1 m, held at its end, in cells of 0.2 m. The mesh has room all around.
static brunt_world_def bar(int kernel, double angle, int particles) {
    brunt_world_def def = def_begin(2, 0.2);
    def_material(&def, "st-venant-kirchhoff", DENSITY, YOUNG, 0);
    hold_by_surfaces(&def, BRUNT_LINEAR, 1e-2);
    use_kernel(&def, kernel, triangle_mesh(-1.3, -0.53, 30, 20, 0.2));
    const double c = cos(angle), s = sin(angle);
    brunt_body_def *b = def_box(&def, "bar", XYZ(0, 0, 0), XYZ(4, 1, 0));
    b->particles_per_cell = particles;
    turn(b, c, s);
    def_line(&def, -s, c, 0, 0, BRUNT_STICK);
    def.gravity[0] = WEIGHT * c, def.gravity[1] = WEIGHT * s;
    return def;
}

static void go_static(brunt_world_def *def, int steps) {
    def->scheme = BRUNT_STATIC, def->load_steps = steps, def->step = 0, def->end = 0, def->newton.tolerance = 1e-10;
}

// The mean way of a bar that its weight draws: of F E (F^2 - 1) / 2 = rho g (L - X), integrated twice.
static double exact_way(double L) {
    enum { PARTS = 4000 };
    double u = 0, mean = 0;
    for (int k = 0; k < PARTS; k++) {
        const double load = DENSITY * WEIGHT * (L - (k + 0.5) * L / PARTS) / YOUNG;
        double F = 1;
        for (int i = 0; i < 20; i++) F -= (F * (F * F - 1) / 2 - load) / ((3 * F * F - 1) / 2);
        mean += (u + (F - 1) * L / PARTS / 2) / PARTS;
        u += (F - 1) * L / PARTS;
    }
    return mean;
}

// Tractions along the line within a share of their mean, across it within the same of nothing.
static double uneven(const brunt_world *world, double c, double s, double mean) {
    const int64_t count = brunt_boundary_surface_size(world, 0);
    double *room = brunt_alloc((size_t)(10 * count) * sizeof *room), most = 0;
    int64_t *piece = brunt_alloc((size_t)count * sizeof *piece);
    const brunt_boundary_surface_arrays arrays = {.position = room,
                                                  .normal = room + 3 * count,
                                                  .traction = room + 6 * count,
                                                  .weight = room + 9 * count,
                                                  .piece = piece};
    brunt_boundary_surface_particles(world, 0, &arrays);
    for (int64_t k = 0; k < count; k++) {
        const double *t = arrays.traction + 3 * k;
        most = fmax(most, fmax(fabs((-t[0] * c - t[1] * s) / mean - 1), fabs(t[1] * c - t[0] * s) / mean));
    }
    brunt_free(room), brunt_free(piece);
    return most;
}

static const int kernels[4] = {BRUNT_QUADRATIC, BRUNT_LINEAR, BRUNT_GRID_CUT, BRUNT_GRID_MESH};
static const char *const words[4] = {"splines", "quads", "cells cut in two", "mesh"};

// A body at rest has all that it needs after some steps, on each grid.
START_TEST(needs_no_more) {
    brunt_world_def def = bar(kernels[_i], 0, 4);
    def.gravity[0] = 0;
    brunt_world *world = world_take(&def);
    world_steps(world, 6);
    const int64_t before = brunt_memory_calls();
    world_steps(world, 4);
    printf("  %s: %g allocations a step\n", words[_i], (double)(brunt_memory_calls() - before) / 4);
    ck_assert_int_eq(brunt_memory_calls(), before);
    brunt_world_destroy(world);
}
END_TEST

// On every grid, as it is and turned by 30 degrees.
START_TEST(hangs) {
    const int kernel = kernels[_i % 4];
    const double angle = _i / 4 * PI / 6, c = cos(angle), s = sin(angle), L = 4, weight = DENSITY * WEIGHT * L;
    brunt_world_def def = bar(kernel, angle, 64);
    go_static(&def, 1);
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    const brunt_body_sums sums = world_sums(world, 0);
    const brunt_reaction f = world_boundary(world, 0);
    const double x = sums.centre[0] - (2 * c - 0.5 * s), y = sums.centre[1] - (2 * s + 0.5 * c), way = exact_way(L);
    const double off = (x * c + y * s) / way - 1, across = (y * c - x * s) / way;
    printf("  %s, %.0f degrees: mean way %.1e off, %.1e across; tractions %.1e off\n", words[_i % 4], angle * 180 / PI,
           off, across, uneven(world, c, s, weight));
    ck_assert_double_le(fabs(off), kernel == BRUNT_QUADRATIC ? 1e-4 : 2e-3);
    // Linear triangles take more of the weight at one of two corners: a couple of rho g h^2 H / 12 at both ends.
    ck_assert_double_le(fabs(across), 3e-2);
    ck_assert_double_le(hypot(f.force[0] + weight * c, f.force[1] + weight * s), 1e-8 * weight);
    ck_assert_double_le(uneven(world, c, s, weight), 0.06);
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-8);
    brunt_world_destroy(world);
}
END_TEST

// Of 2 x 2 points a cell every second one lies on the diagonal: they pull at both of its sides alike, and the bar is as
// long as on quadrangles.
START_TEST(on_diagonals) {
    double way[2];
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = bar(k ? BRUNT_GRID_CUT : BRUNT_LINEAR, 0, 4);
        go_static(&def, 1);
        brunt_world *world = world_take(&def);
        world_steps(world, 1);
        way[k] = world_sums(world, 0).centre[0] - 2;
        brunt_world_destroy(world);
    }
    ck_assert_double_eq_tol(way[1] / way[0], 1, 1e-3);
}
END_TEST

// ------------------------------------------------------------------------------------------ a beam that bends

typedef struct bent {
    double down, moment; // [m] of the middle of its end, [N m] at the clamp
} bent;

// The beam of bench/scenes/bent_beam.yaml, held by a line with so many boundary particles a cell.
static bent bend(int kernel, double h, int points, int particles) {
    const double L = 8, slope = 0.1116;
    brunt_world_def def = def_begin(2, h);
    def_material(&def, "st-venant-kirchhoff", DENSITY, YOUNG, 0);
    hold_by_surfaces(&def, BRUNT_LINEAR, 1e-2);
    const int along = (int)round(8.8 / h), across = (int)round(2.6 / h);
    use_kernel(&def, kernel, triangle_mesh(-0.43, -1.17, along, across, h));
    def_box(&def, "beam", XYZ(0, 0, 0), XYZ(L, 1, 0))->particles_per_cell = points;
    brunt_boundary_surface_def *line = def_line(&def, 0, 1, 0, 0, BRUNT_STICK);
    line->piece = 1, line->particles = particles, line->about[1] = 0.5;
    def.gravity[1] = -WEIGHT;
    go_static(&def, 1);
    brunt_world *world = world_take(&def);
    const double last = L - 0.75 * h / sqrt(points); // before the last column of points
    double *start = world_field(world, 0, "position"), sum = 0;
    int count = 0;
    world_steps(world, 1);
    double *end = world_field(world, 0, "position");
    for (int64_t k = 0; k < brunt_body_particles(world, 0); k++)
        if (start[3 * k] > last) sum += start[3 * k + 1] - end[3 * k + 1], count++;
    brunt_boundary_surface_report report;
    brunt_boundary_surface_read(world, 0, &report);
    free(start), free(end);
    brunt_world_destroy(world);
    ck_assert_int_eq(count, (int)round(sqrt(points) / h));
    return (bent){sum / count + slope * 0.5 * h / sqrt(points), report.moment[2]};
}

// Second order, to the end of conforming elements, extrapolated.
START_TEST(bends) {
    static const int points[] = {4, 16, 64}; // a cell: those of a mesh are halved askew
    const int kernel = kernels[_i + 1], finest = _i ? 2 : 3;
    double before = 0;
    for (int k = 0; k < finest; k++) {
        const double h = 0.2 / (1 << k), off = bend(kernel, h, points[_i], 4).down / 0.67443 - 1;
        printf("  %s of %g m: end %.2e off, order %.2f\n", words[_i + 1], h, off, k ? log2(before / off) : NAN);
        if (k) ck_assert_double_le(fabs(log2(before / off) - 2), _i < 2 ? 0.2 : 0.4);
        before = off;
    }
}
END_TEST

// From 40 to 2560 of them over the clamp: nothing changes.
START_TEST(boundary_particles) {
    const bent few = bend(kernels[_i], 0.05, 4, 2), many = bend(kernels[_i], 0.05, 4, 128);
    printf("  %s: end %.1e, moment %.1e apart with 40 and 2560 boundary particles\n", words[_i],
           few.down / many.down - 1, few.moment / many.moment - 1);
    ck_assert_double_le(fabs(few.down / many.down - 1), kernels[_i] == BRUNT_GRID_MESH ? 1e-5 : 1e-4);
    ck_assert_double_le(fabs(few.moment / many.moment - 1), 1e-4);
}
END_TEST

// ------------------------------------------------------------------------------------------ a cylinder on a slope

// That of bench/scenes/cylinder_slope.yaml: on every grid it goes down as a point does, across it by no hundredth of a
// cell, and is carried by its weight across the slope in the mean.
START_TEST(slope) {
    const int kernel = kernels[_i];
    const double h = 0.12, c = 0.5, s = sqrt(0.75), steepest = WEIGHT * s;
    brunt_world_def def = def_begin(2, h);
    def_material(&def, "neo-hookean", 7800, 2e9, 0.3);
    hold_by_surfaces(&def, BRUNT_LINEAR, 0.02);
    // A sheet of squares would be large: the mesh is turned as the slope is.
    brunt_mesh mesh = triangle_mesh(-1.3, -0.25, 58, 20, h);
    for (int32_t n = 0; n < mesh.node_count; n++) {
        const double along = mesh.nodes[n][0], up = mesh.nodes[n][1];
        mesh.nodes[n][0] = along * c + up * s, mesh.nodes[n][1] = -along * s + up * c;
    }
    use_kernel(&def, kernel, mesh);
    def.integrator = BRUNT_NEWMARK, def.newton.tolerance = 1e-10, def.transfer = BRUNT_FLIP;
    def_ball(&def, "cylinder", XYZ(s, c, 0), 1)->spacing = h / 4;
    def_line(&def, -2 * c, 2 * s, 12 * c, -12 * s, BRUNT_SLIP);
    def.gravity[1] = -WEIGHT;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, 1);
    const brunt_body_sums after = world_sums(world, 0);
    brunt_boundary_surface_report report;
    brunt_boundary_surface_read(world, 0, &report);
    const double x = after.centre[0] - before.centre[0], y = after.centre[1] - before.centre[1];
    const double along = (x * c - y * s) / (0.5 * steepest) - 1, across = (x * s + y * c) / h;
    const double carried = (report.impulse[0] * s + report.impulse[1] * c) / (before.mass * WEIGHT * c) - 1;
    printf("  %s: way %.1e off, %.1e cells across, %.1e of the weight across it\n", words[_i], along, across, carried);
    ck_assert_double_le(fabs(along), 1e-8);
    ck_assert_double_le(fabs(across), 1e-2);
    ck_assert_double_le(fabs(carried), 1e-2);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what is kept

static brunt_world_def flight(int kernel, brunt_transfer transfer) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", DENSITY, 1e5, 0.3);
    use_kernel(&def, kernel, triangle_mesh(-1, -1, 30, 28, 0.1));
    go_implicit(&def, BRUNT_NEWMARK, 2e-3);
    def.transfer = transfer;
    brunt_body_def *b = def_box(&def, "block", XYZ(0.013, 0.021, 0), XYZ(0.51, 0.42, 0));
    def_velocity(b, 1.7, -0.9, 0);
    return def;
}

// A block that nothing acts on goes straight, without stress.
START_TEST(rigid) {
    brunt_world_def def = flight(BRUNT_GRID_CUT + _i % 2, _i / 2 ? BRUNT_PIC : BRUNT_FLIP);
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_steps(world, 50);
    const brunt_body_sums after = world_sums(world, 0);
    const brunt_energy e = world_energy(world);
    const double time = brunt_world_time(world);
    ck_assert_double_eq_tol(after.centre[0] - before.centre[0], 1.7 * time, 1e-10);
    ck_assert_double_eq_tol(after.centre[1] - before.centre[1], -0.9 * time, 1e-10);
    ck_assert_double_le(e.internal, 1e-12 * e.kinetic);
    brunt_world_destroy(world);
}
END_TEST

// One that swings keeps its momentum, and with FLIP alone its energy nearly.
START_TEST(momentum) {
    brunt_world_def def = flight(BRUNT_GRID_CUT + _i % 2, BRUNT_FLIP);
    def.flip = 1;
    def.bodies[0].wave_velocity[0] = 1, def.bodies[0].wave_vector[0] = PI / 0.5;
    brunt_world *world = world_take(&def);
    const brunt_momentum start = world_momentum(world);
    world_steps(world, 50);
    const brunt_momentum now = world_momentum(world);
    for (int a = 0; a < 2; a++)
        ck_assert_double_le(fabs(now.linear[a] - start.linear[a]), 1e-11 * fabs(start.linear[0]));
    ck_assert_double_le(fabs(world_energy(world).error_relative), 1e-10);
    brunt_world_destroy(world);
}
END_TEST

// On a slope that a barrier keeps it off a block goes as a point does; backward Euler is dt / t ahead.
START_TEST(slides) {
    brunt_world_def def = flight(BRUNT_GRID_CUT + _i, BRUNT_FLIP);
    const double c = 0.8, s = 0.6, along = WEIGHT * s, dt = 2e-3;
    def.integrator = BRUNT_EULER;
    def.contact.method = BRUNT_CONTACT_BARRIER;
    def.materials[0].strength_parameters[0] = 1e7;
    def_velocity(&def.bodies[0], 0, 0, 0);
    turn(&def.bodies[0], c, s);
    def_plane(&def, XYZ(0.013 * c - 0.021 * s, 0.013 * s + 0.021 * c, 0), XYZ(-s, c, 0), BRUNT_SEPARATE, 0);
    def.gravity[1] = -WEIGHT;
    brunt_world *world = world_take(&def);
    const brunt_body_sums before = world_sums(world, 0);
    world_until(world, 0.2);
    const brunt_body_sums after = world_sums(world, 0);
    const double x = after.centre[0] - before.centre[0], y = after.centre[1] - before.centre[1], t = 0.2;
    ck_assert_double_eq_tol((-x * c - y * s) / (0.5 * along * t * (t + dt)), 1, 1e-8);
    ck_assert_double_le(fabs(y * c - x * s), 0.025); // barriers are of centres, which lay so far off
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ bits

static brunt_world *swings(int i, int threads) {
    brunt_world_def def = bar(i % 2 ? BRUNT_GRID_MESH : BRUNT_GRID_CUT, PI / 6, 9);
    if (i / 2) go_static(&def, 6);
    def.threads = threads;
    return world_take(&def);
}

START_TEST(threads) {
    brunt_world *world[] = {swings(_i, 1), swings(_i, 2), swings(_i, 3)};
    check_threads(world, 3, 3);
}
END_TEST

START_TEST(restart) { check_restart(swings(_i, 1), swings(_i, 2)); }
END_TEST

// ------------------------------------------------------------------------------------------ beyond the mesh

START_TEST(outside) {
    brunt_world_def def = flight(BRUNT_GRID_MESH, BRUNT_PIC);
    brunt_error error;
    def_velocity(&def.bodies[0], 100, 0, 0);
    brunt_world *world = world_take(&def);
    int status = BRUNT_OK;
    for (int k = 0; k < 20 && !status; k++) status = brunt_world_step(world, INFINITY, &error);
    ck_assert_int_eq(status, BRUNT_FAILED);
    ck_assert_msg(strstr(error.message, "'block', particle ") && strstr(error.message, "outside of the mesh"), "%s",
                  error.message);
    ck_assert_double_gt(error.position[0], 2);
    brunt_world_destroy(world);

    def = flight(BRUNT_GRID_MESH, BRUNT_PIC);
    def.bodies[0].place.translation[0] = 1.7;
    ck_assert_ptr_null(brunt_world_create(&def, &error));
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "bodies.block: particle ") && strstr(error.message, "outside of the mesh"),
                  "%s", error.message);
    brunt_world_def_free(&def);
}
END_TEST

// What a program that gives the definition itself may get wrong.
START_TEST(refused) {
    static const char *const wanted[] = {
        "grid.cells",      "grid.kernel",     "grid.transfer", "grid.cells.mesh: there is none",
        "grid.cells.mesh", "grid.cells.mesh", "boundaries",    "grid.cells.mesh: elements 1 and 3 lie"};
    brunt_world_def def = flight(_i > 2 ? BRUNT_GRID_MESH : BRUNT_GRID_CUT, BRUNT_PIC);
    brunt_error error;
    if (_i == 0) def.scheme = BRUNT_EXPLICIT, def.step = 0;
    if (_i == 1) def.kernel = BRUNT_QUADRATIC;
    if (_i == 2) def.transfer = BRUNT_APIC;
    if (_i == 3) brunt_mesh_free(&def.background), def.background = (brunt_mesh){.node_count = 0};
    if (_i == 4) def.background.kind = BRUNT_QUAD4;
    if (_i == 5) def.background.elements[0] = def.background.elements[1];
    if (_i == 7) memcpy(def.background.elements + 6, def.background.elements, 2 * sizeof(int32_t));
    if (_i == 7) def.background.elements[8] = def.background.node_count - 1;
    if (_i == 6) def_plane(&def, XYZ(0, -0.5, 0), XYZ(0, 1, 0), BRUNT_SLIP, 0);
    ck_assert_ptr_null(brunt_world_create(&def, &error));
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    ck_assert_msg(!strncmp(error.message, wanted[_i], strlen(wanted[_i])), "%s", error.message);
    brunt_world_def_free(&def);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("triangles");
    ADD_LOOP(weights, 8);
    ADD_LOOP(found, 1);
    ADD_LOOP(needs_no_more, 4);
    ADD_LOOP(hangs, 8);
    ADD_LOOP(on_diagonals, 1);
    ADD_LOOP(bends, 3);
    ADD_LOOP(boundary_particles, 4);
    ADD_LOOP(slope, 4);
    ADD_LOOP(rigid, 4);
    ADD_LOOP(momentum, 2);
    ADD_LOOP(slides, 2);
    ADD_LOOP(threads, 4);
    ADD_LOOP(restart, 4);
    ADD_LOOP(outside, 1);
    ADD_LOOP(refused, 8);
    return suite_main(suite);
}
#endif
