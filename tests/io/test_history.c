#include "tests/support/small_scene.h"

#include <math.h>
#include <unistd.h>

#include "io/output/history.h"
#include "base/memory.h"
#include "io/output/positions.h"
#include "base/real.h"
#include "io/scene/history_columns.h"

static brunt_scene scene;
static brunt_world *world;
static brunt_history *history;

static void set_up_of(const char *text) {
    brunt_error error = {0};
    small_folder_make();
    const char *sets[] = {"time.end=10 s"}; // longer than any test
    small_scene_of(text, &scene, sets, 1);
    world = small_world(&scene);
    history = brunt_history_create(world, &scene, &error);
    ck_assert_msg(history != NULL, "%s", error.message);
}

static void set_up(void) { set_up_of(small_scene_text); }
static void set_up_elements(void) { set_up_of(small_elements_text); }

static void tear_down(void) {
    brunt_history_destroy(history);
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
    small_folder_remove();
    ck_assert_int_eq((int)brunt_memory_live(), 0);
}

// A balloon of membrane full of gas, one more filled beside it.
static const char balloons_text[] =
    "brunt: 1\n"
    "title: Two balloons\n"
    "dimension: 3\n"
    "time: {end: 0.01 s}\n"
    "materials:\n"
    "  gum: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.4}\n"
    "bodies:\n"
    "  ball: {method: membrane, material: gum, size: 30 mm, thickness: 1 mm,\n"
    "    shape: {sphere: {center: [1, 2, 3], radius: 0.1}}}\n"
    "  pillow: {method: membrane, material: gum, size: 50 mm, thickness: 1 mm, element: tri3,\n"
    "    shape: {box: {min: [0, 0, 0], max: [0.2, 0.1, 0.1]}}}\n"
    "contact: {method: none}\n"
    "boundaries:\n"
    "  - {name: grip, group: xmin, body: pillow, fix: all}\n"
    "  - {name: helium, group: surface, body: ball, gas: {gamma: 1.66, pressure: 1.01 bar, outside: 1 bar}}\n"
    "  - {name: air, group: surface, body: pillow, gas: {pressure: 1 bar, outside: 1 bar, volume: 1 l, inflow: 10 "
    "kW}}\n"
    "output: {every: none}\n"
    "measures:\n"
    "  highest: {history: gas.air.pressure, take: max}\n";
static void set_up_gas(void) { set_up_of(balloons_text); }

// Samples every few steps until `rows` lines are there.
static void sample(int rows) {
    while (brunt_history_rows(history) < rows) {
        ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
        small_steps(world, 5);
    }
}

static double last(const char *name) {
    const double *values = brunt_history_column(history, name);
    ck_assert_msg(values != NULL, "no column %s", name);
    return values[brunt_history_rows(history) - 1];
}

static const char *unit(const char *name) {
    for (int32_t c = 0; c < brunt_history_column_count(history); c++)
        if (!strcmp(brunt_history_column_name(history, c), name)) return brunt_history_column_unit(history, c);
    ck_abort_msg("no column %s", name);
}

static double last_of_fresh(const char *name) {
    ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    return last(name);
}

START_TEST(columns_hold_what_the_world_says) {
    small_steps(world, 40);
    ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    brunt_energy energy;
    brunt_momentum momentum;
    brunt_body_sums right;
    brunt_world_energy(world, &energy);
    brunt_world_momentum(world, &momentum);
    brunt_body_totals(world, 1, &right);
    ck_assert_double_eq(last("time"), brunt_world_time(world));
    ck_assert_double_eq(last("step"), 40);
    ck_assert_double_eq(last("dt"), brunt_world_dt(world));
    ck_assert_double_eq(last("energy.kinetic"), energy.kinetic);
    ck_assert_double_gt(energy.kinetic, 0);
    ck_assert_double_eq(last("energy.total"), energy.total);
    ck_assert_double_eq(last("energy.error_relative"), energy.error_relative);
    ck_assert_double_eq(last("momentum.linear_y"), momentum.linear[1]);
    ck_assert_double_eq(last("momentum.angular_z"), momentum.angular[2]);
    ck_assert_double_eq(last("body.right.mass"), right.mass);
    ck_assert_double_eq_tol(right.mass, 1000 * 0.5 * 0.3, 1e-3);
    ck_assert_double_eq(last("body.right.position_x"), right.centre[0]);
    ck_assert_double_eq(last("body.right.velocity_x"), right.velocity[0]);
    // Bounds are those of the particles' centres.
    int64_t count = brunt_body_particles(world, 1);
    double *x = malloc(sizeof *x * 3 * (size_t)count), low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    brunt_body_read(world, 1, brunt_body_find_field(world, 1, "position"), x);
    for (int64_t i = 0; i < count; i++)
        for (int c = 0; c < 2; c++) low[c] = fmin(low[c], x[3 * i + c]), high[c] = fmax(high[c], x[3 * i + c]);
    free(x);
    ck_assert_double_eq(last("body.right.low_x"), low[0]);
    ck_assert_double_eq(last("body.right.low_y"), low[1]);
    ck_assert_double_eq(last("body.right.high_x"), high[0]);
    ck_assert_double_eq(last("body.right.high_y"), high[1]);
    ck_assert_str_eq(unit("body.right.high_y"), "m");
    ck_assert_str_eq(unit("time"), "s");
    ck_assert_str_eq(unit("energy.kinetic"), "J");
    ck_assert_str_eq(unit("body.right.velocity_x"), "m/s");
    ck_assert_str_eq(unit("contact.left-right.force_x"), "N");
    ck_assert_str_eq(unit("contact.left-right.impulse_x"), "N s");
    ck_assert_str_eq(unit("wall.floor.force_y"), "N");
    ck_assert_ptr_null(brunt_history_column(history, "energy.none"));
}
END_TEST

// One row each, the one that says most of it first in none: whole names, with names in them that have dots.
START_TEST(columns_have_a_meaning) {
    for (int i = 0; i < brunt_column_rows; i++) {
        const history_column *row = &brunt_column_table[i];
        ck_assert_ptr_nonnull(row->doc);
        ck_assert_int_gt((int)strlen(row->doc), 3);
        ck_assert_ptr_eq(brunt_column_meaning(row->name[strcspn(row->name, "*?")] ? "time" : row->name),
                         row->name[strcspn(row->name, "*?")] ? brunt_column_table : row);
    }
    ck_assert_str_eq(brunt_column_meaning("body.grains.17.position_y")->name, "body.*.position_?");
    ck_assert_str_eq(brunt_column_meaning("contact.a-b.force")->name, "contact.*.force");
    ck_assert_str_eq(brunt_column_meaning("contact.a-b.force_z")->name, "contact.*.force_?");
    ck_assert_ptr_null(brunt_column_meaning("body.ball.position_w"));
    ck_assert_ptr_null(brunt_column_meaning("energy.kinetics"));
    ck_assert_ptr_null(brunt_column_meaning("energy.kineti"));
}
END_TEST

// A history anew whose forces are means over `window` [s]; INFINITY: by the bodies' cells.
static void look_back(double window) {
    brunt_error error = {0};
    brunt_history_destroy(history);
    scene.output.force_window = window;
    history = brunt_history_create(world, &scene, &error);
    ck_assert_msg(history != NULL, "%s", error.message);
}

// Force x interval, summed up, is the impulse: a contact between two lines is not missed.
START_TEST(forces_are_means_over_the_interval) {
    look_back(0);
    sample(120);
    const double *time = brunt_history_column(history, "time"),
                 *force = brunt_history_column(history, "contact.left-right.force_x"),
                 *impulse = brunt_history_column(history, "contact.left-right.impulse_x"),
                 *size = brunt_history_column(history, "contact.left-right.force"),
                 *force_y = brunt_history_column(history, "contact.left-right.force_y");
    double sum = 0, largest = 0;
    for (int64_t r = 1; r < brunt_history_rows(history); r++) {
        sum += force[r] * (time[r] - time[r - 1]);
        largest = fmax(largest, size[r]);
        ck_assert_double_eq_tol(size[r], hypot(force[r], force_y[r]), 1e-9 * (1 + size[r]));
    }
    ck_assert_double_gt(largest, 0);
    ck_assert_double_eq(force[0], 0);
    ck_assert_double_eq_tol(sum, impulse[brunt_history_rows(history) - 1], 1e-9 * fabs(sum));
    ck_assert_double_gt(fabs(sum), 1); // the blocks have met: their momenta are about 1000 kg m/s
}
END_TEST

// Linear between the lines; before the first what it had.
static double between_lines(const double *time, const double *value, int64_t rows, double at) {
    for (int64_t r = 1; r < rows && at > time[0]; r++)
        if (at <= time[r])
            return value[r - 1] + (value[r] - value[r - 1]) * (at - time[r - 1]) / (time[r] - time[r - 1]);
    return value[0];
}

// Where lines are closer than the window, forces are means over it, of a contact and of a wall; else since the line
// before. The default is four times what a wave takes through a cell.
START_TEST(forces_are_means_over_their_window) {
    const double wave = sqrt(1e6 * 0.7 / (1.3 * 0.4 * 1000)), windows[] = {0.02, 0.2, 1e-4, INFINITY},
                 window = isinf(windows[_i]) ? 4 * 0.1 / wave : windows[_i];
    look_back(windows[_i]);
    sample(120);
    static const char *const names[][2] = {{"contact.left-right.force_x", "contact.left-right.impulse_x"},
                                           {"wall.floor.force_y", "wall.floor.impulse_y"}};
    for (int k = 0; k < 2; k++) {
        const double *time = brunt_history_column(history, "time"), *force = brunt_history_column(history, names[k][0]),
                     *impulse = brunt_history_column(history, names[k][1]);
        double most = 0;
        int64_t closer = 0;
        for (int64_t r = 1; r < brunt_history_rows(history); r++) most = fmax(most, fabs(force[r]));
        ck_assert_double_gt(most, 0);
        for (int64_t r = 1; r < brunt_history_rows(history); r++) {
            const double over = fmax(window, time[r] - time[r - 1]);
            const double from = between_lines(time, impulse, r + 1, time[r] - over);
            ck_assert_double_eq_tol(force[r], (impulse[r] - from) / over, 1e-9 * most);
            closer += over == window;
        }
        ck_assert(closer == (window < 1e-3 ? 0 : brunt_history_rows(history) - 1));
    }
}
END_TEST

// Two bars of unit wave speed, of ten times their width, or one of half that, meet and part: the force is half of rho c
// v A until the wave, which is three elements wide by then, has been to the end of the shorter one and back. Force of
// the step: up to 2.2 of that.
static const char bars_text[] =
    "brunt: 1\n"
    "title: Two bars meet\n"
    "dimension: 3\n"
    "time: {end: 60 s, cfl: 0.9}\n"
    "materials:\n"
    "  unit: {model: linear-elastic, density: 1, E: 1, nu: 0}\n"
    "bodies:\n"
    "  a: {method: fem, material: unit, size: 1, shape: {box: {min: [-10.01, 0, 0], max: [-0.01, 1, 1]}},\n"
    "    velocity: [1e-3, 0, 0]}\n"
    "  b: {method: fem, material: unit, size: 1, shape: {box: {min: [0, 0, 0], max: [10, 1, 1]}}}\n"
    "contact: {method: augury}\n"
    "output: {every: none, history: 0}\n";

START_TEST(bars_have_the_force_of_the_wave) {
    static const struct {
        double size, length, cfl;
        const char *element;
    } bars[] = {{1, 10, 0.9, "hex8"},    {1, 10, 0.3, "hex8"},     {0.5, 10, 0.9, "hex8"}, {0.5, 10, 0.1, "hex8"},
                {0.25, 10, 0.5, "hex8"}, {0.125, 10, 0.9, "hex8"}, {1, 10, 0.9, "tet4"},   {1, 10, 0.3, "tet4"},
                {0.5, 10, 0.9, "tet4"},  {0.5, 10, 0.3, "tet4"},   {0.5, 20, 0.9, "hex8"}, {0.5, 20, 0.5, "tet4"}};
    char sets[7][64];
    const char *given[7];
    for (int b = 0; b < 2; b++) {
        snprintf(sets[2 * b], sizeof sets[0], "bodies.%c.size=%g", 'a' + b, bars[_i].size);
        snprintf(sets[2 * b + 1], sizeof sets[0], "bodies.%c.element=%s", 'a' + b, bars[_i].element);
    }
    snprintf(sets[4], sizeof sets[0], "time.cfl=%g", bars[_i].cfl);
    snprintf(sets[5], sizeof sets[0], "bodies.b.shape.box.max=[%g, 1, 1]", bars[_i].length);
    for (int s = 0; s < 6; s++) given[s] = sets[s];
    brunt_scene_free(&scene);
    brunt_history_destroy(history);
    brunt_world_destroy(world);
    small_scene_of(bars_text, &scene, given, 6);
    world = small_world(&scene);
    history = NULL;
    look_back(INFINITY);
    while (brunt_world_time(world) < 40) {
        ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
        small_steps(world, 1);
    }
    const double *time = brunt_history_column(history, "time"),
                 *force = brunt_history_column(history, "contact.a-b.force_x"),
                 *impulse = brunt_history_column(history, "contact.a-b.impulse_x");
    const int64_t rows = brunt_history_rows(history);
    double most = 0, plateau = 0, sum = 0;
    for (int64_t r = 1; r < rows; r++) {
        most = fmax(most, force[r] / 5e-4);
        if (time[r] > 10 + 6 * bars[_i].size && time[r] < fmin(28, 30 - 3 * bars[_i].size))
            plateau = fmax(plateau, fabs(force[r] / 5e-4 - 1));
        sum += force[r] * (time[r] - time[r - 1]);
    }
    printf("  bars, %s of %g, %g long, cfl %g: peak %.4f, plateau within %.4f\n", bars[_i].element, bars[_i].size,
           bars[_i].length, bars[_i].cfl, most, plateau);
    ck_assert_double_le(fabs(most - 1), 0.02);
    ck_assert_double_le(plateau, 0.02);
    ck_assert_double_eq_tol(sum, impulse[rows - 1], 0.01 * impulse[rows - 1]);
}
END_TEST

// Mass scaling makes a mesh slower: bars of four times their density, twice the force, half the wave speed, and twice
// the time over which forces are means.
START_TEST(scaled_bars_have_the_force_of_their_wave) {
    const char *sets[] = {"bodies.a.mass_scaling=2", "bodies.b.mass_scaling=2", _i ? "time.cfl=0.9" : "time.cfl=0.3"};
    brunt_scene_free(&scene);
    brunt_history_destroy(history);
    brunt_world_destroy(world);
    small_scene_of(bars_text, &scene, sets, 3);
    world = small_world(&scene);
    history = NULL;
    look_back(INFINITY);
    ck_assert_double_eq_tol(brunt_pair_transit(world, 0), 2, 1e-9);
    while (brunt_world_time(world) < 55) {
        ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
        small_steps(world, 1);
    }
    const double *time = brunt_history_column(history, "time"),
                 *force = brunt_history_column(history, "contact.a-b.force_x");
    double most = 0, plateau = 0;
    for (int64_t r = 1; r < brunt_history_rows(history); r++) {
        most = fmax(most, force[r] / 1e-3);
        if (time[r] > 22 && time[r] < 44) plateau = fmax(plateau, fabs(force[r] / 1e-3 - 1));
    }
    printf("  scaled bars, cfl %g: peak %.4f, plateau within %.4f\n", _i ? 0.9 : 0.3, most, plateau);
    ck_assert_double_le(fabs(most - 1), 0.02);
    ck_assert_double_le(plateau, 0.02);
}
END_TEST

// A line holds material points: what is slower there, but of elements, is not what its force is a mean over. A plane
// meets both, and with a body of its own that one alone.
START_TEST(windows_are_of_what_a_boundary_acts_on) {
    static const char text[] =
        "brunt: 1\n"
        "title: Quick points, slow elements\n"
        "dimension: 2\n"
        "time: {end: 1 s}\n"
        "grid: {cell: 0.1 m}\n"
        "materials:\n"
        "  quick: {model: linear-elastic, density: 1, E: 100, nu: 0}\n"
        "  slow: {model: linear-elastic, density: 1, E: 1, nu: 0}\n"
        "bodies:\n"
        "  points: {method: mpm, material: quick, shape: {box: {min: [0, 0], max: [1, 1]}}}\n"
        "  mesh: {method: fem, material: slow, size: 0.5, shape: {box: {min: [3, 0], max: [4, 1]}}}\n"
        "boundaries:\n"
        "  - {name: held, line: {points: [[5, -1], [-2, -1]]}, condition: separate}\n"
        "  - {name: floor, plane: {point: [0, -1], normal: [0, 1]}, condition: separate}\n"
        "  - {name: own, plane: {point: [-2, 0], normal: [1, 0]}, condition: separate, body: points}\n"
        "output: {every: none}\n";
    brunt_scene_free(&scene);
    brunt_history_destroy(history);
    brunt_world_destroy(world);
    small_scene_of(text, &scene, NULL, 0);
    world = small_world(&scene);
    history = NULL;
    look_back(INFINITY);
    int found = 0;
    for (int32_t w = 0; w < brunt_boundary_count(world); w++) {
        brunt_reaction reaction;
        brunt_boundary_reaction(world, w, &reaction);
        ck_assert_double_eq_tol(brunt_boundary_transit(world, w), strcmp(reaction.name, "floor") ? 0.01 : 0.5, 1e-9);
        found++;
    }
    ck_assert_int_eq(found, 3);
}
END_TEST

START_TEST(probe_follows_the_nearest_particle) {
    ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(last("probe.corner.x"), 5, 1e-6);
    small_steps(world, 60);
    ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    // The particle nearest to the corner of the box at the start, found by hand.
    int64_t count = brunt_body_particles(world, 0), nearest = 0;
    double *x = malloc(sizeof *x * 3 * (size_t)count), *v = malloc(sizeof *v * 3 * (size_t)count), best = INFINITY;
    brunt_world *fresh = small_world(&scene);
    brunt_body_read(fresh, 0, brunt_body_find_field(fresh, 0, "position"), x);
    brunt_world_destroy(fresh);
    for (int64_t i = 0; i < count; i++)
        if (hypot(x[3 * i], x[3 * i + 1] - 0.1) < best) {
            best = hypot(x[3 * i], x[3 * i + 1] - 0.1);
            nearest = i;
        }
    brunt_body_read(world, 0, brunt_body_find_field(world, 0, "velocity"), v);
    ck_assert_double_eq(last("probe.corner.y"), v[3 * nearest + 1]);
    ck_assert_double_ne(v[3 * nearest + 1], 0);
    free(x);
    free(v);
}
END_TEST

START_TEST(unknown_probe_field_is_refused) {
    const char *sets[] = {"output.probes.corner.field=velocitee"};
    brunt_scene other;
    brunt_error error = {0};
    small_scene(&other, sets, 1);
    ck_assert_ptr_null(brunt_history_create(world, &other, &error));
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    ck_assert_ptr_nonnull(strstr(error.message, "'velocitee'"));
    brunt_scene_free(&other);
}
END_TEST

// The lines of a file, read back, are the same to the bit, and a resumed run goes on after the last of its own.
START_TEST(file_gives_the_same_lines_and_drops_later_ones) {
    sample(31);
    const uint64_t hash31 = brunt_history_hash(history);
    sample(50);
    brunt_history *again = brunt_history_create(world, &scene, NULL);
    char path[160];
    snprintf(path, sizeof path, "%s", small_path("again.csv"));
    ck_assert_int_eq(brunt_history_open_csv(history, small_path("history.csv"), NULL), BRUNT_OK);
    long size;
    char *bytes = small_read(small_path("history.csv"), &size);
    small_write(path, bytes, size);
    free(bytes);
    for (int drop = 0; drop < 2; drop++) {
        int64_t kept = drop ? 31 : 50;
        brunt_error error = {0};
        int status = brunt_history_resume(again, path, kept, drop ? hash31 : brunt_history_hash(history), &error);
        ck_assert_msg(status == BRUNT_OK, "%s", error.message);
        ck_assert_int_eq(brunt_history_open_csv(again, path, NULL), BRUNT_OK);
        ck_assert_int_eq((int)brunt_history_rows(again), (int)kept);
        for (int32_t c = 0; c < brunt_history_column_count(history); c++) {
            const char *name = brunt_history_column_name(history, c);
            const double *a = brunt_history_column(history, name), *b = brunt_history_column(again, name);
            ck_assert_msg(a && b && !memcmp(a, b, sizeof *a * (size_t)kept), "%s differs", name);
        }
        if (drop) break;
        // What comes then is the same as if there had been no break.
        ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
        ck_assert_int_eq(brunt_history_sample(again, world, NULL), BRUNT_OK);
        ck_assert(brunt_history_hash(history) == brunt_history_hash(again));
        brunt_history_destroy(again);
        again = brunt_history_create(world, &scene, NULL);
    }
    // Lines go on after the last kept one.
    ck_assert_int_eq(brunt_history_sample(again, world, NULL), BRUNT_OK);
    ck_assert_int_eq((int)brunt_history_rows(again), 32);
    brunt_history_destroy(again);
}
END_TEST

// What is no history of these lines is refused and changes nothing: another number of them, another value, a line cut
// off.
START_TEST(other_lines_are_refused) {
    sample(20);
    char path[160], other[160];
    snprintf(path, sizeof path, "%s", small_path("history.csv"));
    snprintf(other, sizeof other, "%s", small_path("other.csv"));
    const uint64_t hash = brunt_history_hash(history);
    ck_assert_int_eq(brunt_history_open_csv(history, path, NULL), BRUNT_OK);
    brunt_history *again = brunt_history_create(world, &scene, NULL);
    brunt_error error;
    ck_assert_int_eq(brunt_history_resume(again, path, 21, hash, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_history_resume(again, path, 19, hash, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_history_resume(again, path, 20, hash + 1, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_history_resume(again, small_path("none.csv"), 20, hash, &error), BRUNT_IO_ERROR);
    long size;
    char *bytes = small_read(path, &size), *second = strchr(strchr(bytes, '\n') + 1, '\n') + 1;
    small_write(other, bytes, size - 1);
    ck_assert_int_eq(brunt_history_resume(again, other, 20, hash, &error), BRUNT_BAD_INPUT);
    for (int i = 0; i < 3; i++) { // a digit, a comma, a zero byte
        char *at = second + strcspn(second, i ? "," : "123456"), kept = *at;
        *at = "9;"[i < 2 ? i : 2];
        small_write(other, bytes, size);
        *at = kept;
        ck_assert_int_eq(brunt_history_resume(again, other, 20, hash, &error), BRUNT_BAD_INPUT);
    }
    ck_assert_int_eq((int)brunt_history_rows(again), 0);
    ck_assert_int_eq(brunt_history_resume(again, path, 20, hash, &error), BRUNT_OK);
    brunt_history_destroy(again);
    free(bytes);
}
END_TEST

START_TEST(empty_history_is_a_file_too) {
    ck_assert_int_eq(brunt_history_write(history, small_path("history.h5"), NULL), BRUNT_OK);
    ck_assert_int_eq(brunt_history_check_file(history, small_path("history.h5"), NULL), BRUNT_OK);
    ck_assert_int_eq(brunt_history_open_csv(history, small_path("history.csv"), NULL), BRUNT_OK);
    ck_assert_int_eq(brunt_history_resume(history, small_path("history.csv"), 0, 0, NULL), BRUNT_OK);
    ck_assert_int_eq((int)brunt_history_rows(history), 0);
}
END_TEST

// However long a run, its lines take no memory, also not while the HDF5 file is made of them; the file is the same
// bytes each time.
START_TEST(lines_take_no_memory) {
    char path[2][160];
    snprintf(path[0], sizeof path[0], "%s", small_path("a.h5")),
        snprintf(path[1], sizeof path[1], "%s", small_path("b.h5"));
    ck_assert_int_eq(brunt_history_open_csv(history, small_path("history.csv"), NULL), BRUNT_OK);
    sample(10);
    const size_t live = brunt_memory_live();
    for (int i = 0; i < 5000; i++) ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    ck_assert_int_eq((int)brunt_memory_live(), (int)live);
    const size_t peak = brunt_memory_peak();
    for (int f = 0; f < 2; f++) ck_assert_int_eq(brunt_history_write(history, path[f], NULL), BRUNT_OK);
    ck_assert_int_eq((int)brunt_memory_live(), (int)live);
    const size_t whole = 5010 * sizeof(double) * (size_t)brunt_history_column_count(history);
    ck_assert_uint_lt(brunt_memory_peak() - peak, whole / 2);
    ck_assert_double_eq(last("time"), brunt_world_time(world));
    long size[2];
    char *bytes[2] = {small_read(path[0], &size[0]), small_read(path[1], &size[1])};
    ck_assert(size[0] == size[1] && !memcmp(bytes[0], bytes[1], (size_t)size[0]));
    ck_assert_int_gt((int)size[0], (int)whole);
    free(bytes[0]), free(bytes[1]);
    ck_assert(access(small_path("a.h5.part"), F_OK) != 0);
}
END_TEST

START_TEST(csv_holds_the_columns_with_their_units) {
    sample(3);
    const char *path = small_path("history.csv");
    ck_assert_int_eq(brunt_history_open_csv(history, path, NULL), BRUNT_OK);
    sample(7);
    long size;
    char *text = small_read(path, &size), *line = text;
    ck_assert_int_eq(strncmp(text, "time [s],step [1],dt [s],energy.kinetic [J],", 43), 0);
    int lines = 0;
    for (char *end; (end = strchr(line, '\n')); line = end + 1, lines++) {
        *end = 0;
        int32_t c = 0;
        for (char *field = strtok(line, ","); field; field = strtok(NULL, ","), c++) {
            const char *name = brunt_history_column_name(history, c);
            if (lines == 0) {
                char header[256];
                snprintf(header, sizeof header, "%s [%s]", name, brunt_history_column_unit(history, c));
                ck_assert_str_eq(field, header);
            } else {
                ck_assert_double_eq(strtod(field, NULL), brunt_history_column(history, name)[lines - 1]);
            }
        }
        ck_assert_int_eq(c, brunt_history_column_count(history));
    }
    ck_assert_int_eq(lines, 8);
    free(text);
}
END_TEST

START_TEST(damage_is_an_error) {
    sample(20);
    const char *path = small_path("history.h5"), *broken = small_path("broken.h5");
    ck_assert_int_eq(brunt_history_write(history, path, NULL), BRUNT_OK);
    long size;
    char *bytes = small_read(path, &size);
    brunt_error error;
    srand(1);
    for (int i = 0; i < 100; i++) {
        long at = rand() % size;
        char kept = bytes[at];
        bytes[at] = (char)(kept ^ (1 << rand() % 8));
        // The unused rest of the user block says nothing; everything else is under the checksum.
        bool matters = at >= 512 || kept;
        small_write(broken, bytes, size);
        bytes[at] = kept;
        if (matters)
            ck_assert_msg(brunt_history_check_file(history, broken, &error) == BRUNT_BAD_INPUT, "byte %ld", at);
        small_write(broken, bytes, rand() % size);
        ck_assert_int_eq(brunt_history_check_file(history, broken, &error), BRUNT_BAD_INPUT);
    }
    free(bytes);
    ck_assert_int_eq(brunt_history_check_file(history, small_path("none.h5"), &error), BRUNT_IO_ERROR);
    ck_assert_int_eq((int)brunt_history_rows(history), 20);
}
END_TEST

// Meshes have the columns that particles have, and the area that touches.
START_TEST(elements_have_the_same_columns) {
    ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(last("body.upper.mass"), 1000 * 0.2 * 0.2 * 0.2, 1e-5);
    ck_assert_double_eq_tol(last("body.upper.position_z"), 0.32, 1e-6);
    ck_assert_double_eq_tol(last("body.upper.low_z"), 0.22, 1e-6);
    ck_assert_double_eq_tol(last("body.upper.high_z"), 0.42, 1e-6);
    ck_assert_double_eq_tol(last("body.upper.low_x"), 0.1, 1e-6);
    ck_assert_double_eq_tol(last("body.upper.velocity_z"), -4, 1e-6);
    ck_assert_double_eq_tol(last("body.upper.kinetic"), 0.5 * 8 * 16, 1e-4);
    ck_assert_double_eq(last("contact.lower-upper.area"), 0);
    ck_assert_double_eq(last("energy.hourglass"), 0);
    ck_assert_str_eq(unit("contact.lower-upper.area"), "m^2");
    ck_assert_str_eq(unit("wall.grip.force_x"), "N");
    double area = 0, force = 0, floor = 0, grip = 0;
    for (int s = 0; s < 60; s++) {
        small_steps(world, 10);
        ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
        area = fmax(area, last("contact.lower-upper.area"));
        force = fmax(force, last("contact.lower-upper.force_z"));
        floor = fmax(floor, last("wall.floor.force_z"));
        grip = fmax(grip, fabs(last("wall.grip.force_x")));
    }
    ck_assert(force > 0 && floor > 0 && grip > 0);
    ck_assert_double_gt(area, 0.01);
    ck_assert_double_lt(area,
                        0.1); // the lower face has 0.04 m^2, and its nodes twice that, with what is round its edges
}
END_TEST

// Bodies of which something may go tell how much has gone; a probe at what was eroded has no value. In a scene where
// nothing may there are no such columns.
START_TEST(eroded_is_counted) {
    ck_assert_ptr_null(brunt_history_column(history, "body.upper.eroded"));
    ck_assert_double_eq(last_of_fresh("energy.heat"), 0);
    brunt_scene pulled;
    const char *sets[] = {"bodies.lower.erosion={strain: 0.1}", "bodies.lower.velocity=[0, 0, 0]",
                          "bodies.lower.wave={velocity: [-12, 0, 0], wave_vector: [7.854, 0, 0], phase: 90 deg}",
                          ("output.probes={first: {body: lower, point: [0.15, 0.05, 0.05], field: density},"
                           " last: {body: lower, point: [0.35, 0.35, 0.15], field: density}}"),
                          "boundaries=[]"};
    small_scene_of(small_elements_text, &pulled, sets, 5);
    brunt_world *bar = small_world(&pulled);
    brunt_history *lines = brunt_history_create(bar, &pulled, NULL);
    brunt_eroded gone = {0};
    double *places, nearest = INFINITY;
    int64_t number = -1;
    ck_assert_int_eq(brunt_positions_read(bar, 0, BRUNT_AT_ELEMENTS, &places, NULL), BRUNT_OK);
    for (int64_t e = 0; e < brunt_body_elements(bar, 0); e++) {
        double away = hypot(hypot(places[3 * e] - 0.35, places[3 * e + 1] - 0.35), places[3 * e + 2] - 0.15);
        if (away < nearest) nearest = away, number = e;
    }
    brunt_free(places);
    ck_assert_int_eq(brunt_history_sample(lines, bar, NULL), BRUNT_OK);
    for (int s = 0; s < 400 && !gone.elements; s++) {
        small_steps(bar, 1);
        brunt_body_eroded(bar, 0, &gone);
    }
    ck_assert_int_gt(gone.elements, 0);
    ck_assert_int_eq(brunt_history_sample(lines, bar, NULL), BRUNT_OK);
    const double *count = brunt_history_column(lines, "body.lower.eroded"),
                 *mass = brunt_history_column(lines, "body.lower.eroded_mass"),
                 *first = brunt_history_column(lines, "probe.first"),
                 *at_end = brunt_history_column(lines, "probe.last");
    ck_assert(count && mass && first && at_end);
    ck_assert(count[0] == 0 && mass[0] == 0);
    ck_assert_double_eq(count[1], (double)gone.elements);
    ck_assert_double_eq(mass[1], gone.mass);
    ck_assert_double_eq(brunt_history_column(lines, "body.upper.eroded")[1], 0);
    // Where the bar was drawn out it is eroded; elsewhere the probe is still at its element, whose number is another.
    ck_assert_double_eq_tol(first[0], 1000, 1e-3);
    ck_assert(isnan(first[1]));
    int64_t left = brunt_body_elements(bar, 0), at = 0;
    double *ids = malloc((size_t)left * sizeof *ids), *density = malloc((size_t)left * sizeof *density);
    brunt_body_read(bar, 0, brunt_body_find_field(bar, 0, "element"), ids);
    brunt_body_read(bar, 0, brunt_body_find_field(bar, 0, "density"), density);
    while (at < left && ids[at] != (double)number) at++;
    ck_assert(at < left && at != number);
    ck_assert_double_eq(at_end[1], density[at]);
    free(ids);
    free(density);
    char path[160];
    snprintf(path, sizeof path, "%s", small_path("eroded.csv"));
    ck_assert_int_eq(brunt_history_open_csv(lines, path, NULL), BRUNT_OK);
    brunt_history *again = brunt_history_create(bar, &pulled, NULL); // declared when something has eroded
    ck_assert_int_eq(brunt_history_resume(again, path, 2, brunt_history_hash(lines), NULL), BRUNT_OK);
    ck_assert_int_eq(brunt_history_open_csv(again, path, NULL), BRUNT_OK);
    ck_assert_double_eq(brunt_history_column(again, "body.lower.eroded_mass")[1], gone.mass);
    brunt_history_destroy(again);
    brunt_history_destroy(lines);
    brunt_world_destroy(bar);
    brunt_scene_free(&pulled);
}
END_TEST

// A field of nodes is probed at the nearest node, one of elements at the nearest centre.
START_TEST(probes_of_elements) {
    small_steps(world, 200);
    ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    brunt_world *fresh = small_world(&scene);
    int64_t nodes = brunt_body_nodes(world, 1), elements = brunt_body_elements(world, 0), corner = -1, middle = -1;
    double *x = malloc(sizeof *x * 3 * (size_t)nodes), *v = malloc(sizeof *v * 3 * (size_t)nodes);
    brunt_body_read(fresh, 1, brunt_body_find_field(fresh, 1, "position"), x);
    brunt_body_read(world, 1, brunt_body_find_field(world, 1, "velocity"), v);
    for (int64_t i = 0; i < nodes; i++)
        if (fabs(x[3 * i] - 0.1) + fabs(x[3 * i + 1] - 0.1) + fabs(x[3 * i + 2] - 0.22) < 1e-6) corner = i;
    ck_assert_int_ge((int)corner, 0);
    ck_assert_double_eq(last("probe.corner.z"), v[3 * corner + 2]);
    ck_assert_double_ne(last("probe.corner.z"), -4);
    // The bricks of 0.1 m: the point lies in that of [0.2, 0.3] x [0.2, 0.3] x [0.1, 0.2].
    int64_t lower = brunt_body_nodes(world, 0);
    double *y = malloc(sizeof *y * 3 * (size_t)lower), *stress = malloc(sizeof *stress * 6 * (size_t)elements);
    int32_t *cells = malloc(sizeof *cells * 8 * (size_t)elements);
    brunt_body_read(fresh, 0, brunt_body_find_field(fresh, 0, "position"), y);
    brunt_body_connectivity(fresh, 0, cells);
    brunt_body_read(world, 0, brunt_body_find_field(world, 0, "stress"), stress);
    for (int64_t e = 0; e < elements; e++) {
        double low[3] = {1, 1, 1};
        for (int n = 0; n < 8; n++)
            for (int c = 0; c < 3; c++) low[c] = fmin(low[c], y[3 * (size_t)cells[8 * e + n] + c]);
        if (fabs(low[0] - 0.2) + fabs(low[1] - 0.2) + fabs(low[2] - 0.1) < 1e-6) middle = e;
    }
    ck_assert_int_ge((int)middle, 0);
    ck_assert_double_eq(last("probe.middle.zz"), stress[6 * middle + 2]);
    ck_assert_double_eq(last("probe.middle.xy"), stress[6 * middle + 3]);
    ck_assert_double_ne(stress[6 * middle + 2], 0);
    brunt_world_destroy(fresh);
    free(x), free(v), free(y), free(stress), free(cells);
}
END_TEST

// Gases in the order of the boundaries, by their names; grips have none. What a line says of one is consistent in
// itself: p V = (gamma - 1) E of the same moment.
START_TEST(gases_have_columns) {
    static const struct {
        const char *name;
        double gamma, pressure, power;
    } gases[] = {{"helium", 1.66, 1.01e5, 0}, {"air", 1.4, 1e5, 1e4}};
    static const char *const quantities[] = {"volume", "pressure", "energy", "inflow"}, *const units[] = {"m^3", "Pa",
                                                                                                          "J", "J"};
    double first[2][4], now[2][4], radius = 0;
    ck_assert_int_eq(brunt_gas_count(world), 2);
    for (int pass = 0; pass < 2; pass++) {
        ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
        for (int g = 0; g < 2; g++) {
            brunt_gas gas;
            brunt_world_gas(world, g, &gas);
            ck_assert_str_eq(gas.name, gases[g].name);
            double(*values)[4] = pass ? now : first;
            for (int q = 0; q < 4; q++) {
                char column[64];
                snprintf(column, sizeof column, "gas.%s.%s", gases[g].name, quantities[q]);
                values[g][q] = last(column);
                ck_assert_str_eq(unit(column), units[q]);
            }
            const double *value = values[g];
            ck_assert(value[0] == gas.volume && value[1] == gas.pressure && value[2] == gas.energy);
            ck_assert_double_eq(value[3], gas.inflow);
            ck_assert_double_eq_tol(value[1] * value[0] / (gases[g].gamma - 1) / value[2], 1, 1e-12);
            // gas flows in with the forces, up to a step behind the time of the places
            ck_assert_double_le(value[3], gases[g].power * brunt_world_time(world));
            ck_assert_double_ge(value[3], gases[g].power * (brunt_world_time(world) - brunt_world_dt(world)));
        }
        if (pass) continue;
        radius = last("body.ball.high_x") - 1;
        small_steps(world, 8);
    }
    const double cells = 1e-6, ball = 4.0 / 3 * 3.14159265358979 * 1e-3; // chords at three edges a quarter miss some
    ck_assert_double_lt(first[0][0], ball);
    ck_assert_double_gt(first[0][0], 0.85 * ball);
    ck_assert_double_eq_tol(first[1][0], 0.2 * 0.1 * 0.1 + 1e-3, sizeof(real) == 4 ? 1e-8 : 1e-15);
    for (int g = 0; g < 2; g++) {
        ck_assert_double_eq_tol(first[g][1], gases[g].pressure, 1e-6 * gases[g].pressure);
        ck_assert_double_gt(now[g][0], first[g][0] + cells); // both swell
    }
    ck_assert_double_lt(now[0][1], first[0][1]); // at constant entropy
    ck_assert_double_eq_tol(now[0][1] / first[0][1], pow(first[0][0] / now[0][0], 1.66), 1e-6);
    ck_assert_double_gt(now[1][3], 0);
    // The ball swells around its centre.
    const double centre[3] = {1, 2, 3}, reach = last("body.ball.high_x") - 1;
    ck_assert_double_le(radius, 0.1 + 1e-6);
    ck_assert_double_gt(reach, radius + 1e-5);
    for (int c = 0; c < 3; c++) {
        char low[] = "body.ball.low_x", high[] = "body.ball.high_x";
        low[sizeof low - 2] = high[sizeof high - 2] = "xyz"[c];
        ck_assert_double_eq_tol(last(low), centre[c] - reach, 1e-6);
        ck_assert_double_eq_tol(last(high), centre[c] + reach, 1e-6);
    }
    ck_assert_ptr_null(brunt_history_column(history, "gas.grip.volume"));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("history");
    TCase *lines = tcase_create("lines");
    tcase_add_checked_fixture(lines, set_up, tear_down);
    tcase_add_test(lines, columns_hold_what_the_world_says);
    tcase_add_test(lines, columns_have_a_meaning);
    tcase_add_test(lines, forces_are_means_over_the_interval);
    tcase_add_loop_test(lines, forces_are_means_over_their_window, 0, 4);
    tcase_add_loop_test(lines, bars_have_the_force_of_the_wave, 0, 12);
    tcase_add_loop_test(lines, scaled_bars_have_the_force_of_their_wave, 0, 2);
    tcase_add_test(lines, windows_are_of_what_a_boundary_acts_on);
    tcase_add_test(lines, probe_follows_the_nearest_particle);
    tcase_add_test(lines, unknown_probe_field_is_refused);
    tcase_add_test(lines, file_gives_the_same_lines_and_drops_later_ones);
    tcase_add_test(lines, other_lines_are_refused);
    tcase_add_test(lines, lines_take_no_memory);
    tcase_add_test(lines, empty_history_is_a_file_too);
    tcase_add_test(lines, csv_holds_the_columns_with_their_units);
    tcase_add_test(lines, damage_is_an_error);
    suite_add_tcase(suite, lines);
    TCase *elements = tcase_create("elements");
    tcase_add_checked_fixture(elements, set_up_elements, tear_down);
    tcase_add_test(elements, elements_have_the_same_columns);
    tcase_add_test(elements, eroded_is_counted);
    tcase_add_test(elements, probes_of_elements);
    tcase_add_test(elements, file_gives_the_same_lines_and_drops_later_ones);
    suite_add_tcase(suite, elements);
    TCase *gas = tcase_create("gas");
    tcase_add_checked_fixture(gas, set_up_gas, tear_down);
    tcase_add_test(gas, gases_have_columns);
    tcase_add_test(gas, file_gives_the_same_lines_and_drops_later_ones);
    suite_add_tcase(suite, gas);
    return suite_main(suite);
}
