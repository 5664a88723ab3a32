#include "tests/support/small_scene.h"

#include <math.h>

#include "io/output/measures.h"
#include "base/memory.h"
#include "base/real.h"

// Positions and gradients carry the precision of the build.
static const double rounding = sizeof(real) == 4 ? 1e-5 : 1e-12;

static brunt_scene scene;
static brunt_world *world;
static brunt_history *history;
static brunt_units *units;

static void set_up(void) {
    small_scene(&scene, NULL, 0);
    world = small_world(&scene);
    history = brunt_history_create(world, &scene, NULL);
    ck_assert_ptr_nonnull(history);
    units = brunt_units_open();
}

static void tear_down(void) {
    brunt_units_close(units);
    brunt_history_destroy(history);
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
    ck_assert_int_eq((int)brunt_memory_live(), 0);
}

static brunt_measure blank(brunt_measure_kind kind) {
    return (brunt_measure){.name = "m",
                           .kind = kind,
                           .to = INFINITY,
                           .slab_min = -INFINITY,
                           .slab_max = INFINITY,
                           .component = -1,
                           .relative_to = NAN,
                           .expect = NAN,
                           .tolerance = NAN,
                           .body = "left"};
}

static brunt_measure_result evaluate(const brunt_measure *m, double initial) {
    brunt_measure_result result;
    brunt_error error = {0};
    int status = brunt_measure_check(m, history, world, units, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    status = brunt_measure_evaluate(m, history, world, initial, &result, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    return result;
}

static double of_history(const char *column, brunt_take take, double from, double to) {
    brunt_measure m = blank(BRUNT_MEASURE_HISTORY);
    strcpy(m.column, column);
    m.take = take;
    m.from = from;
    m.to = to;
    return evaluate(&m, NAN).value;
}

// Time and step are columns whose every reduction is known.
START_TEST(history_is_reduced) {
    for (int r = 0; r < 11; r++) {
        ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
        double next = brunt_world_time(world) + 1e-3 * (r + 1); // unevenly spaced
        brunt_error error = {0};
        while (brunt_world_time(world) < next) ck_assert_int_eq(brunt_world_step(world, next, &error), BRUNT_OK);
    }
    const double *time = brunt_history_column(history, "time"), *step = brunt_history_column(history, "step");
    double end = time[10];
    ck_assert_double_eq_tol(end, 0.055, 1e-12);
    ck_assert_double_eq(of_history("time", BRUNT_TAKE_END, 0, INFINITY), end);
    ck_assert_double_eq(of_history("time", BRUNT_TAKE_INITIAL, 0, INFINITY), 0);
    ck_assert_double_eq(of_history("time", BRUNT_TAKE_MIN, time[3], INFINITY), time[3]);
    ck_assert_double_eq(of_history("time", BRUNT_TAKE_MAX, 0, time[7]), time[7]);
    ck_assert_double_eq(of_history("time", BRUNT_TAKE_INITIAL, 0.5 * (time[3] + time[4]), INFINITY), time[4]);
    ck_assert_double_eq(of_history("step", BRUNT_TAKE_END, 0, 0.5 * (time[3] + time[4])), step[3]);
    ck_assert_double_eq_tol(of_history("time", BRUNT_TAKE_MEAN, 0, INFINITY), end / 2, 1e-15);
    ck_assert_double_eq_tol(of_history("time", BRUNT_TAKE_MEAN, time[2], time[9]), (time[2] + time[9]) / 2, 1e-15);
    ck_assert_double_eq_tol(of_history("time", BRUNT_TAKE_SLOPE, 0, INFINITY), 1, 1e-12);
    ck_assert_double_eq(of_history("step", BRUNT_TAKE_FIRST_NONZERO, 0, INFINITY), time[1]);
    ck_assert_double_eq(of_history("step", BRUNT_TAKE_LAST_NONZERO, 0, INFINITY), end);
    ck_assert_double_nan(of_history("energy.eroded", BRUNT_TAKE_FIRST_NONZERO, 0, INFINITY));
    ck_assert_double_nan(of_history("time", BRUNT_TAKE_END, 1, 2));
    // Half of the greatest value is passed between two lines, at the first of the window, or never.
    ck_assert_double_eq_tol(of_history("time", BRUNT_TAKE_RISE, 0, INFINITY), end / 2, 1e-12);
    ck_assert_double_eq_tol(of_history("time", BRUNT_TAKE_RISE, 0, time[7]), time[7] / 2, 1e-12);
    ck_assert_double_eq(of_history("time", BRUNT_TAKE_RISE, time[8], INFINITY), time[8]);
    ck_assert_double_eq(of_history("body.left.mass", BRUNT_TAKE_RISE, 0, INFINITY), 0);
    ck_assert_double_nan(of_history("energy.eroded", BRUNT_TAKE_RISE, 0, INFINITY)); // nothing rose
    ck_assert_double_nan(of_history("body.right.velocity_y", BRUNT_TAKE_RISE, 0, time[2]));
    int64_t row = 1;
    while (step[row] < 0.5 * step[10]) row++;
    double share = (0.5 * step[10] - step[row - 1]) / (step[row] - step[row - 1]);
    ck_assert_double_eq_tol(of_history("step", BRUNT_TAKE_RISE, 0, INFINITY),
                            time[row - 1] + share * (time[row] - time[row - 1]), 1e-12);
    // Velocities along -y: the greatest size is of the least value.
    ck_assert_double_eq(of_history("body.right.velocity_y", BRUNT_TAKE_MAX_ABS, 0, INFINITY),
                        fmax(-of_history("body.right.velocity_y", BRUNT_TAKE_MIN, 0, INFINITY),
                             of_history("body.right.velocity_y", BRUNT_TAKE_MAX, 0, INFINITY)));
    ck_assert_double_lt(of_history("body.right.velocity_y", BRUNT_TAKE_MIN, 0, INFINITY), -0.99);
    brunt_measure m = blank(BRUNT_MEASURE_HISTORY);
    strcpy(m.column, "step");
    m.relative_to_initial = true; // 0 / 0 or x / 0: no number, no crash
    ck_assert(!isfinite(evaluate(&m, NAN).value));
}
END_TEST

// A block of elements, held on one side, that swings along x: c = sqrt(E / rho), period 4 L / c.
START_TEST(periods_are_found) {
    brunt_scene elements;
    const char *const sets[] = {"bodies={lower: {method: fem, material: rubber, size: 0.05, shape: {box: {min: [0, 0, "
                                "0], max: [1, 0.05, 0.05]}}, "
                                "wave: {velocity: [0.1, 0, 0], wave_vector: [1.5707963267948966, 0, 0]}}}",
                                "materials.rubber.nu=0",
                                "output.probes={}",
                                "measures={}",
                                "loads={}",
                                "time.end=1",
                                "boundaries=[{name: grip, group: xmin, body: lower, fix: [x]}]"};
    small_scene_of(small_elements_text, &elements, sets, sizeof sets / sizeof *sets);
    brunt_world *bar = small_world(&elements);
    brunt_history *lines = brunt_history_create(bar, &elements, NULL);
    for (int s = 0; s < 150; s++) {
        ck_assert_int_eq(brunt_history_sample(lines, bar, NULL), BRUNT_OK);
        small_steps(bar, 5);
    }
    double end = brunt_world_time(bar);
    brunt_measure m = blank(BRUNT_MEASURE_HISTORY);
    brunt_measure_result result;
    strcpy(m.column, "body.lower.position_x");
    m.take = BRUNT_TAKE_PERIOD;
    ck_assert_int_eq(brunt_measure_evaluate(&m, lines, bar, NAN, &result, NULL), BRUNT_OK);
    double exact = 4 * 1 / sqrt(1e6 / 1000);
    ck_assert_double_gt(end, 3.5 * exact);
    ck_assert_double_eq_tol(result.value, exact, 2e-3 * exact);
    m.to = 0.9 * exact; // less than two rises
    ck_assert_int_eq(brunt_measure_evaluate(&m, lines, bar, NAN, &result, NULL), BRUNT_OK);
    ck_assert_double_nan(result.value);
    brunt_history_destroy(lines);
    brunt_world_destroy(bar);
    brunt_scene_free(&elements);
}
END_TEST

// The history is time itself, so that its distance from any broken line is known.
START_TEST(history_against_a_curve) {
    for (int r = 0; r < 6; r++) {
        ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
        brunt_error error = {0};
        double next = 0.01 * (r + 1);
        while (brunt_world_time(world) < next) ck_assert_int_eq(brunt_world_step(world, next, &error), BRUNT_OK);
    }
    double roof[3][2] = {{0, 0}, {0.02, 0.02}, {0.05, 0.01}},
           between_lines[3][2] = {{0, 0}, {0.025, 0.035}, {0.05, 0.05}};
    brunt_measure m = blank(BRUNT_MEASURE_HISTORY);
    strcpy(m.column, "time");
    m.take = BRUNT_TAKE_MAX_ABS;
    m.curve = (brunt_curve){roof, 3};
    m.from = 0;
    m.to = 0.05;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.04 / 0.02, 1e-12);
    m.take = BRUNT_TAKE_MIN;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0, 1e-12);
    m.take = BRUNT_TAKE_MEAN;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.5 * 0.03 * 0.04 / 0.05 / 0.02, 1e-12);
    m.take = BRUNT_TAKE_MAX;
    m.to = 0.02;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0, 1e-12);
    m.to = 0.035; // an end between two lines
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, (0.035 - 0.015) / 0.02, 1e-12);
    m.take = BRUNT_TAKE_INITIAL;
    m.from = 0.026; // likewise
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, (0.026 - 0.018) / 0.02, 1e-12);
    // The greatest distance is at a point of the curve that is between two lines of the history.
    m.curve = (brunt_curve){between_lines, 3};
    m.from = 0;
    m.to = 0.05;
    m.take = BRUNT_TAKE_MAX_ABS;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.01 / 0.05, 1e-12);
    m.take = BRUNT_TAKE_MIN;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, -0.01 / 0.05, 1e-12);
    // 1 + t, over 2, less the curve.
    m.minus = -1;
    m.relative_to = 2;
    m.take = BRUNT_TAKE_MAX;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.5 / 0.05, 1e-12);
    m.expect = 0;
    m.absolute = true;
    m.tolerance = 10.1;
    ck_assert(evaluate(&m, NAN).ok);
    m.tolerance = 9.9;
    ck_assert(!evaluate(&m, NAN).ok);
    // A run that ended before the window has no distance to show, however near it was.
    m.tolerance = INFINITY;
    m.to = 0.06;
    ck_assert_double_nan(evaluate(&m, NAN).value);
    ck_assert(!evaluate(&m, NAN).ok);
}
END_TEST

// The initial value of a column is what `relative_to: initial` divides the history by, also before a curve.
START_TEST(curves_of_shares) {
    ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    small_steps(world, 5);
    ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    double line[2][2] = {{0, 0.5}, {brunt_world_time(world), 1}};
    brunt_measure m = blank(BRUNT_MEASURE_HISTORY);
    strcpy(m.column, "body.left.mass");
    m.take = BRUNT_TAKE_MAX;
    m.relative_to_initial = true;
    m.curve = (brunt_curve){line, 2};
    m.from = 0;
    m.to = line[1][0];
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 1, 1e-12);
}
END_TEST

START_TEST(curves_of_scenes) {
    brunt_scene read, again;
    const char *const sets[] = {"measures={way: {history: body.left.position_x, expect: 0, tolerance: 0.1,"
                                " curve: [[0 ms, 25 cm], [10 ms, 0.3], [50 ms, 400 mm]]}}"};
    small_scene(&read, sets, 1);
    const brunt_measure *m = &read.measures[0];
    ck_assert_int_eq(m->curve.count, 3);
    ck_assert_double_eq_tol(m->curve.points[2][0], 0.05, 1e-15);
    ck_assert_double_eq_tol(m->curve.points[2][1], 0.4, 1e-15);
    ck_assert_str_eq(m->curve_unit, "m");
    ck_assert_double_eq(m->from, 0);
    ck_assert_double_eq_tol(m->to, 0.05, 1e-15);
    ck_assert(m->take == BRUNT_TAKE_MAX_ABS && m->absolute);
    char *text = small_scene_resolved(&read);
    small_scene_of(text, &again, NULL, 0);
    ck_assert_int_eq(again.measures[0].curve.count, 3);
    ck_assert_mem_eq(again.measures[0].curve.points, m->curve.points, sizeof(double[3][2]));
    ck_assert(again.measures[0].take == m->take && again.measures[0].absolute);
    free(text);
    brunt_scene_free(&again);
    // The unit is that of the column.
    brunt_error error = {0};
    ck_assert_int_eq(brunt_measure_check(m, history, world, units, &error), BRUNT_OK);
    brunt_measure other = *m;
    strcpy(other.column, "body.left.velocity_x");
    ck_assert_int_eq(brunt_measure_check(&other, history, world, units, &error), BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "the curve is in m, the history's column 'body.left.velocity_x' in m/s"), "%s",
                  error.message);
    strcpy(other.curve_unit, "m.s-1");
    ck_assert_int_eq(brunt_measure_check(&other, history, world, units, &error), BRUNT_OK);
    other.curve_unit[0] = 0; // SI, whatever that is
    ck_assert_int_eq(brunt_measure_check(&other, history, world, units, &error), BRUNT_OK);
    brunt_scene_free(&read);
}
END_TEST

// What is expected in a unit is that of the column, or a time, or whatever the scene's divisor makes of it.
START_TEST(units_are_those_of_columns) {
    static const struct {
        const char *column, *unit;
        brunt_take take;
        double relative_to;
        int status;
    } cases[] = {
        {"body.left.velocity_x", "m/s", BRUNT_TAKE_END, NAN, BRUNT_OK},
        {"body.left.velocity_x", "m.s-1", BRUNT_TAKE_MAX, NAN, BRUNT_OK},
        {"body.left.velocity_x", "", BRUNT_TAKE_END, NAN, BRUNT_OK},
        {"body.left.velocity_x", "m", BRUNT_TAKE_END, NAN, BRUNT_BAD_INPUT},
        {"body.left.velocity_x", "m", BRUNT_TAKE_MAX_ABS, NAN, BRUNT_BAD_INPUT},
        {"body.left.velocity_x", "1", BRUNT_TAKE_END, 2, BRUNT_OK},
        {"body.left.velocity_x", "m/s^2", BRUNT_TAKE_SLOPE, NAN, BRUNT_OK},
        {"body.left.velocity_x", "s", BRUNT_TAKE_RISE, NAN, BRUNT_OK},
        {"body.left.velocity_x", "m/s", BRUNT_TAKE_RISE, NAN, BRUNT_BAD_INPUT},
        {"momentum.angular_z", "J s", BRUNT_TAKE_END, NAN, BRUNT_OK},
        {"energy.kinetic", "J/m", BRUNT_TAKE_END, NAN, BRUNT_OK}, // of plane bodies
        {"energy.kinetic", "J/m^2", BRUNT_TAKE_END, NAN, BRUNT_BAD_INPUT},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        brunt_measure m = blank(BRUNT_MEASURE_HISTORY);
        strcpy(m.column, cases[c].column), strcpy(m.unit, cases[c].unit), strcpy(m.name, "v");
        m.take = cases[c].take, m.relative_to = cases[c].relative_to;
        brunt_error error = {0};
        ck_assert_msg(brunt_measure_check(&m, history, world, units, &error) == cases[c].status, "case %zu: %s", c,
                      error.message);
        if (c == 3)
            ck_assert_str_eq(
                error.message,
                "measures.v: what it takes of the history's column 'body.left.velocity_x' is in m/s, not m");
    }
}
END_TEST

// What is taken of bodies has a unit as well; what is subtracted is of that unit, and a divisor with a unit divides it.
START_TEST(units_are_those_of_values) {
    static const struct {
        brunt_measure_kind kind;
        const char *of, *unit, *minus, *relative;
        int status;
        const char *message;
    } cases[] = {
        {BRUNT_MEASURE_EXTENT, "", "m", "m", "", BRUNT_OK, ""},
        {BRUNT_MEASURE_EXTENT, "", "s", "", "", BRUNT_BAD_INPUT, "measures.m: it is in m, not s"},
        {BRUNT_MEASURE_EXTENT, "", "", "s", "", BRUNT_BAD_INPUT,
         "measures.m.minus: it is in s, what it is subtracted from in m"},
        {BRUNT_MEASURE_EXTENT, "", "1", "", "m", BRUNT_OK, ""},
        {BRUNT_MEASURE_EXTENT, "", "m/s", "", "s", BRUNT_OK, ""},
        {BRUNT_MEASURE_EXTENT, "", "m", "", "s", BRUNT_BAD_INPUT, "measures.m: it is in m.s-1, not m"},
        {BRUNT_MEASURE_RADIUS, "", "m", "m", "", BRUNT_OK, ""},
        {BRUNT_MEASURE_RADIUS, "", "Pa", "", "", BRUNT_BAD_INPUT, "measures.m: it is in m, not Pa"},
        {BRUNT_MEASURE_TWIST, "", "rad", "", "", BRUNT_OK, ""},
        {BRUNT_MEASURE_TWIST, "", "m", "", "", BRUNT_BAD_INPUT, "measures.m: it is in rad, not m"},
        {BRUNT_MEASURE_FIELD, "velocity", "m/s", "m.s-1", "", BRUNT_OK, ""},
        {BRUNT_MEASURE_FIELD, "velocity", "m", "", "", BRUNT_BAD_INPUT, "measures.m: it is in m/s, not m"},
        {BRUNT_MEASURE_HISTORY, "body.left.velocity_x", "", "m/s", "", BRUNT_OK, ""},
        {BRUNT_MEASURE_HISTORY, "body.left.velocity_x", "", "m", "", BRUNT_BAD_INPUT,
         "measures.m.minus: it is in m, what it is subtracted from in m/s"},
        {BRUNT_MEASURE_HISTORY, "energy.kinetic", "m", "", "J/m", BRUNT_OK, ""},
        {BRUNT_MEASURE_HISTORY, "energy.kinetic", "s", "", "J", BRUNT_BAD_INPUT, "measures.m: it is in 1, not s"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        brunt_measure m = blank(cases[c].kind);
        strcpy(m.column, cases[c].of), strcpy(m.field, cases[c].of), strcpy(m.unit, cases[c].unit);
        strcpy(m.minus_unit, cases[c].minus), strcpy(m.relative_unit, cases[c].relative);
        m.relative_to = *cases[c].relative ? 2 : NAN;
        m.take = m.kind == BRUNT_MEASURE_FIELD ? BRUNT_TAKE_MEAN : BRUNT_TAKE_END;
        m.axis[0] = 1;
        brunt_error error = {0};
        const int status = brunt_measure_check(&m, history, world, units, &error);
        ck_assert_msg(status == cases[c].status, "case %zu: %s", c, error.message);
        ck_assert_str_eq(error.message, cases[c].message);
    }
}
END_TEST

// As scenes say them: a time from a length, and a length over a time.
START_TEST(units_of_scenes) {
    static const struct {
        const char *set, *complaint;
    } cases[] = {
        {"measures={way: {history: body.left.position_x, minus: 3 ms}}",
         "way.minus: it is in s, what it is subtracted from in m"},
        {"measures={way: {history: body.left.position_x, relative_to: 3 ms, unit: m}}", "way: it is in m.s-1, not m"},
        {"measures={way: {history: body.left.position_x, take: slope, unit: m}}", "way: it is in m.s-1, not m"},
        {"measures={way: {history: body.left.position_x, relative_to: initial, unit: m}}", "way: it is in 1, not m"},
        {"measures={way: {history: body.left.position_x, minus: 0.25, relative_to: 2, unit: m}}", NULL},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        brunt_scene read;
        small_scene(&read, &cases[c].set, 1);
        brunt_error error = {0};
        const int status = brunt_measure_check(&read.measures[0], history, world, units, &error);
        ck_assert_msg(status == (cases[c].complaint ? BRUNT_BAD_INPUT : BRUNT_OK), "case %zu", c);
        if (cases[c].complaint) ck_assert_msg(strstr(error.message, cases[c].complaint), "%s", error.message);
        brunt_scene_free(&read);
    }
}
END_TEST

START_TEST(values_are_judged) {
    ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    small_steps(world, 10);
    ck_assert_int_eq(brunt_history_sample(history, world, NULL), BRUNT_OK);
    brunt_measure m = blank(BRUNT_MEASURE_HISTORY);
    strcpy(m.column, "step"); // 10 at the end
    brunt_measure_result r = evaluate(&m, NAN);
    ck_assert_double_eq(r.value, 10);
    ck_assert(!r.judged && !r.ok);
    ck_assert_double_nan(r.error);
    m.minus = 4;
    m.relative_to = 3;
    ck_assert_double_eq(evaluate(&m, NAN).value, 2);
    m.minus = 0;
    m.relative_to = NAN;
    m.expect = 8;
    r = evaluate(&m, NAN);
    ck_assert_double_eq(r.error, 0.25);
    ck_assert(!r.judged);
    m.tolerance = 0.25;
    ck_assert(evaluate(&m, NAN).ok);
    m.tolerance = 0.24;
    r = evaluate(&m, NAN);
    ck_assert(r.judged && !r.ok);
    m.absolute = true;
    m.tolerance = 2;
    r = evaluate(&m, NAN);
    ck_assert_double_eq(r.error, 2);
    ck_assert(r.ok);
    m.tolerance = 1.9;
    ck_assert(!evaluate(&m, NAN).ok);
    m.absolute = false;
    m.expect = -8; // relative to the size of what is expected
    ck_assert_double_eq(evaluate(&m, NAN).error, 18.0 / 8);
    strcpy(m.column, "body.left.mass");
    m.relative_to_initial = true;
    m.expect = 1;
    m.tolerance = 0;
    ck_assert(evaluate(&m, NAN).ok);
    // What cannot be computed is not within any tolerance.
    strcpy(m.column, "energy.eroded");
    m.take = BRUNT_TAKE_FIRST_NONZERO;
    m.relative_to_initial = false;
    m.tolerance = INFINITY;
    r = evaluate(&m, NAN);
    ck_assert(r.judged && !r.ok);
}
END_TEST

START_TEST(extent_reaches_to_the_surfaces) {
    brunt_measure m = blank(BRUNT_MEASURE_EXTENT);
    m.axis[0] = 2; // any length
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.5, rounding);
    strcpy(m.body, "right");
    m.axis[0] = 0;
    m.axis[1] = 1;
    double initial;
    ck_assert_int_eq(brunt_measure_initial(&m, world, &initial, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(initial, 0.3, rounding);
    m.relative_to_initial = true;
    ck_assert_double_eq_tol(evaluate(&m, 0.15).value, 2, 10 * rounding);
}
END_TEST

// A block turned by 30 degrees has its edges' lengths along its own axes.
START_TEST(extent_of_a_turned_block) {
    const char *sets[] = {"bodies.left.place=[{rotate: {angle: 30 deg, about: [0.25, 0.35]}}]",
                          "bodies.left.shape.box.max=[0.4, 0.6]", "bodies.right.velocity=[0, 0]",
                          "bodies.right.place=[{translate: [1, 0]}]", "boundaries=[]"};
    brunt_scene turned;
    small_scene(&turned, sets, 5);
    brunt_world *other = small_world(&turned);
    brunt_measure m = blank(BRUNT_MEASURE_EXTENT);
    double value, c = cos(acos(-1) / 6), s = 0.5;
    m.axis[0] = c;
    m.axis[1] = s;
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(value, 0.4, 10 * rounding);
    m.axis[0] = -s;
    m.axis[1] = c;
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(value, 0.5, 10 * rounding);
    brunt_world_destroy(other);
    brunt_scene_free(&turned);
}
END_TEST

// Gives one component of a field of the left block a value at all its particles.
static void set_left_each(brunt_world *at, const char *field, int components, int component, const double value[2]) {
    char name[96];
    brunt_error error = {0};
    snprintf(name, sizeof name, "bodies/left/%s", field);
    for (int32_t b = 0; b < brunt_state_count(at); b++) {
        brunt_state_block block = brunt_state_info(at, b);
        if (strcmp(block.name, name)) continue;
        real *values = malloc((size_t)block.count * sizeof *values);
        brunt_state_get(at, b, values);
        const int64_t n = block.count / components;
        for (int64_t i = 0; i < n; i++) values[component * n + i] = (real)value[i % 2];
        ck_assert_msg(brunt_state_set(at, b, values, block.count, &error) == BRUNT_OK, "%s", error.message);
        free(values);
        return;
    }
    ck_abort_msg("there is no %s", name);
}

static void set_left(brunt_world *at, const char *field, int components, int component, double value) {
    set_left_each(at, field, components, component, (const double[2]){value, value});
}

// Sheared by 5, particles every 0.05 reach sqrt(26) half a spacing along x; what has failed has no shape, and reaches
// as far as its volume.
START_TEST(extent_of_what_has_failed) {
    const char *sets[] = {
        "materials.rubber={model: von-mises, density: 1000, E: 1e6, nu: 0.3, yield: 1e4, eos: {model: "
        "mie-gruneisen, c0: 30, s: 1.5, gamma0: 1.5}, failure: {model: johnson-cook-damage, d1: 0.1, "
        "action: soften}}"};
    brunt_scene soft;
    small_scene(&soft, sets, 1);
    brunt_world *other = small_world(&soft);
    brunt_measure m = blank(BRUNT_MEASURE_EXTENT);
    double value;
    m.axis[0] = 1;
    set_left(other, "deformation_gradient", 4, 1, 5);
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(value, 0.45 + 0.05 * sqrt(26), 10 * rounding);
    set_left(other, "integrity", 1, 0, 0);
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(value, 0.5, 10 * rounding);
    brunt_world_destroy(other);
    brunt_scene_free(&soft);
}
END_TEST

// Rings about the axis: a volume of 2 pi r of their section's. Stretched along it, and failed.
START_TEST(extent_of_rings) {
    const char *sets[] = {"axisymmetric=true",
                          "materials.rubber={model: von-mises, density: 1000, E: 1e6, nu: 0.3, yield: 1e4, eos: "
                          "{model: mie-gruneisen, c0: 30, s: 1.5, gamma0: 1.5}, failure: {model: "
                          "johnson-cook-damage, d1: 0.1, action: soften}}"};
    brunt_scene rings;
    small_scene(&rings, sets, 2);
    brunt_world *other = small_world(&rings);
    brunt_measure m = blank(BRUNT_MEASURE_EXTENT);
    double value;
    for (int a = 0; a < 2; a++) {
        m.axis[a] = 1, m.axis[1 - a] = 0;
        ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
        ck_assert_double_eq_tol(value, 0.5, 10 * rounding);
    }
    set_left(other, "deformation_gradient", 9, 4, 2);
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(value, 0.45 + 2 * 0.05, 10 * rounding);
    set_left(other, "deformation_gradient", 9, 4, 1);
    set_left(other, "integrity", 1, 0, 0);
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(value, 0.5, 10 * rounding);
    brunt_world_destroy(other);
    brunt_scene_free(&rings);
}
END_TEST

// Rings at r = 0.025, 0.075 .. 0.475 count by their circumference, however they have swollen since.
START_TEST(mean_of_rings) {
    const char *sets[] = {"axisymmetric=true"};
    brunt_scene rings;
    small_scene(&rings, sets, 1);
    brunt_world *other = small_world(&rings);
    brunt_measure m = blank(BRUNT_MEASURE_FIELD);
    double value;
    strcpy(m.field, "position");
    m.take = BRUNT_TAKE_MEAN, m.component = 0;
    for (int k = 0; k < 2; k++) {
        if (k) set_left_each(other, "deformation_gradient", 9, 4, (const double[2]){1, 3});
        ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
        ck_assert_double_eq_tol(value, 0.83125 / 2.5, 10 * rounding);
    }
    m.take = BRUNT_TAKE_MAX;
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(value, 0.475, 10 * rounding);
    brunt_world_destroy(other);
    brunt_scene_free(&rings);
}
END_TEST

START_TEST(radius_about_an_axis) {
    // Left block: [0, 0.5] x [0.1, 0.6] with particles every 0.05; along y the farthest surface from the line y = 0.1
    // is 0.5 away.
    brunt_measure m = blank(BRUNT_MEASURE_RADIUS);
    m.axis[0] = 1;
    m.center[1] = 0.1;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.5, 10 * rounding);
    m.axis[0] = 0;
    m.axis[1] = 1;
    m.center[0] = 0.1;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.4, 10 * rounding);
    // Only a slab without particles.
    m.slab_min = 2;
    ck_assert_double_nan(evaluate(&m, NAN).value);
    // About the diagonal from the corner, particles i, j are (i + j + 1) 0.05 / sqrt 2 along it and (i - j) 0.05 / sqrt
    // 2 beside it: in a slab that ends after i + j = 5, or begins before 15.
    m = blank(BRUNT_MEASURE_RADIUS);
    m.axis[0] = m.axis[1] = 1, m.center[1] = 0.1;
    m.slab_max = 0.31 / sqrt(2);
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.25 / sqrt(2) + 0.025, 10 * rounding);
    m.slab_min = 0.79 / sqrt(2), m.slab_max = INFINITY;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.15 / sqrt(2) + 0.025, 10 * rounding);
    // About a point of the plane: the corner particle's centre is 0.475 sqrt 2 away and it is 0.025 big in any
    // direction.
    m = blank(BRUNT_MEASURE_RADIUS);
    m.axis[2] = 1;
    m.center[1] = 0.1;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.475 * sqrt(2) + 0.025, 10 * rounding);
}
END_TEST

// The left block is given F: a turn by 2 rad about z of a stretch.
START_TEST(twist_is_the_turn) {
    const char *sets[] = {"boundaries=[]"};
    brunt_scene still;
    small_scene(&still, sets, 1);
    brunt_world *other = small_world(&still);
    const double c = cos(2), s = sin(2), F[4] = {1.3 * c, -0.8 * s, 1.3 * s, 0.8 * c};
    brunt_measure m = blank(BRUNT_MEASURE_TWIST);
    double value;
    m.within = INFINITY;
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_eq(value, 0);
    for (int k = 0; k < 4; k++) set_left(other, "deformation_gradient", 4, k, F[k]);
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(value, 2, 10 * rounding);
    m.axis[2] = -3;
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(value, -2, 10 * rounding);
    // Nothing is that near, or that high.
    m.within = 1e-3;
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_nan(value);
    m.within = INFINITY, m.slab_min = 1;
    ck_assert_int_eq(brunt_measure_initial(&m, other, &value, NULL), BRUNT_OK);
    ck_assert_double_nan(value);
    brunt_world_destroy(other);
    brunt_scene_free(&still);
}
END_TEST

START_TEST(fields_are_reduced) {
    brunt_measure m = blank(BRUNT_MEASURE_FIELD);
    strcpy(m.body, "right");
    strcpy(m.field, "velocity");
    m.take = BRUNT_TAKE_MEAN;
    m.component = 0;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, -5, 10 * rounding);
    m.component = -1;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, sqrt(26), 10 * rounding);
    m.component = 0;
    m.take = BRUNT_TAKE_MAX_ABS;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 5, 10 * rounding);
    strcpy(m.field, "position");
    m.take = BRUNT_TAKE_MIN;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.625, 10 * rounding);
    m.take = BRUNT_TAKE_MAX;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 1.075, 10 * rounding);
    m.axis[0] = 1;
    m.slab_max = 0.8;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 0.775, 10 * rounding);
    m.slab_max = 0;
    ck_assert_double_nan(evaluate(&m, NAN).value);
}
END_TEST

static double initial_of(const brunt_measure *m, brunt_world *of) {
    brunt_error error = {0};
    double value;
    int status = brunt_measure_initial(m, of, &value, &error);
    ck_assert_msg(status == BRUNT_OK, "%s", error.message);
    return value;
}

// Blocks of elements: nodes lie on the surface, values are of nodes or of elements.
START_TEST(elements_are_measured) {
    brunt_scene blocks;
    const char *sets[] = {"bodies.upper.place=[{rotate: {axis: [0, 0, 1], angle: 30 deg, about: [0.2, 0.2, 0]}}]"};
    small_scene_of(small_elements_text, &blocks, sets, 1);
    brunt_world *other = small_world(&blocks);
    brunt_measure m = blank(BRUNT_MEASURE_EXTENT);
    strcpy(m.body, "lower");
    m.axis[0] = 3;
    ck_assert_double_eq_tol(initial_of(&m, other), 0.4, 10 * rounding);
    strcpy(m.body, "upper");
    m.axis[0] = cos(acos(-1) / 6);
    m.axis[1] = 0.5;
    ck_assert_double_eq_tol(initial_of(&m, other), 0.2, 10 * rounding);
    m = blank(BRUNT_MEASURE_RADIUS);
    strcpy(m.body, "upper");
    m.axis[2] = 1;
    m.center[0] = m.center[1] = 0.2;
    ck_assert_double_eq_tol(initial_of(&m, other), 0.1 * sqrt(2), 10 * rounding);
    m = blank(BRUNT_MEASURE_FIELD);
    strcpy(m.body, "upper");
    strcpy(m.field, "velocity"); // of nodes
    m.component = 2;
    m.take = BRUNT_TAKE_MEAN;
    ck_assert_double_eq_tol(initial_of(&m, other), -4, 10 * rounding);
    strcpy(m.body, "lower");
    strcpy(m.field, "volume"); // of elements
    m.component = -1;
    m.take = BRUNT_TAKE_MAX;
    ck_assert_double_eq_tol(initial_of(&m, other), 1e-3, 10 * rounding);
    // Centres of elements are at 0.05, 0.15, ...: there are none between 0.06 and 0.14, though there are nodes.
    m.axis[0] = 1;
    m.slab_min = 0.06;
    m.slab_max = 0.14;
    ck_assert_double_nan(initial_of(&m, other));
    m.slab_max = 0.16;
    ck_assert_double_eq_tol(initial_of(&m, other), 1e-3, 10 * rounding);
    brunt_world_destroy(other);
    brunt_scene_free(&blocks);
}
END_TEST

static double profile_of(const char *body, const char *field, int component, double (*points)[2], int32_t count) {
    brunt_measure m = blank(BRUNT_MEASURE_PROFILE);
    strcpy(m.body, body);
    strcpy(m.field, field);
    m.component = component;
    m.axis[0] = 3; // any length
    m.curve = (brunt_curve){points, count};
    return evaluate(&m, NAN).value;
}

// Of blocks at rest with the density 1000: `left` has 0.25 m^2 over [0, 0.5], `right` 0.15 m^2 over [0.6, 1.1]. Sums
// over a lattice of what is linear are its integrals.
START_TEST(profiles_are_compared) {
    double exact[1][2] = {{7, 1000}}, line[2][2] = {{0, 1000}, {0.5, 1500}},
           jump[4][2] = {{-1, 1000}, {0.25, 1000}, {0.25, 500}, {2, 500}},
           beside[4][2] = {{0, 2000}, {0.55, 2000}, {0.55, 1000}, {1, 1000}}, held[2][2] = {{0.2, 800}, {0.3, 1200}},
           at_point[3][2] = {{-1, 1000}, {0, 1000}, {0, 2000}},
           thrice[4][2] = {{0, 1000}, {0.25, 1000}, {0.25, 9000}, {0.25, 500}};
    ck_assert_double_eq_tol(profile_of("left", "density", -1, exact, 1), 0, rounding);
    ck_assert_double_eq_tol(profile_of("", "density", -1, exact, 1), 0, rounding);
    ck_assert_double_eq_tol(profile_of("left", "density", -1, line, 2), 250 / 1250.0, 100 * rounding);
    ck_assert_double_eq_tol(profile_of("left", "density", -1, jump, 4), 0.5 * 500 / 750.0, 100 * rounding);
    ck_assert_double_eq_tol(profile_of("left", "density", -1, thrice, 4), 0.5 * 500 / 750.0, 100 * rounding);
    // Two bodies, by their volumes.
    ck_assert_double_eq_tol(profile_of("", "density", -1, beside, 4), 0.25 * 1000 / (0.25 * 2000 + 0.15 * 1000),
                            100 * rounding);
    ck_assert_double_eq_tol(profile_of("right", "density", -1, beside, 4), 0, rounding);
    // Beyond its ends the reference is held: |200| over 0.2 m twice, |x - 0.25| 4000 in between.
    ck_assert_double_eq_tol(profile_of("left", "density", -1, held, 2), (0.4 * 200 + 0.1 * 100) / (0.5 * 1000),
                            100 * rounding);
    // Components and magnitudes: velocities (5, 0) and (-5, -1).
    double five[1][2] = {{0, 5}}, minus[1][2] = {{0, -5}};
    ck_assert_double_eq_tol(profile_of("", "velocity", 0, five, 1), 0.15 * 10 / (0.4 * 5), 100 * rounding);
    ck_assert_double_eq_tol(profile_of("right", "velocity", 0, minus, 1), 0, rounding);
    ck_assert_double_eq_tol(profile_of("right", "velocity", -1, five, 1), (sqrt(26) - 5) / 5, 100 * rounding);
    // Along another axis, from another origin; what is measured is offset and divided like any other.
    brunt_measure m = blank(BRUNT_MEASURE_PROFILE);
    double up[2][2] = {{0, 1000}, {0.5, 2000}};
    strcpy(m.field, "density");
    m.axis[1] = 0.1;
    m.center[0] = 9, m.center[1] = 0.1;
    m.curve = (brunt_curve){up, 2};
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 500 / 1500.0, 100 * rounding);
    m.minus = 0.25;
    m.relative_to = 0.5;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 2 * (1 / 3.0 - 0.25), 200 * rounding);
    // A jump at the first of 10 columns of particles is behind it.
    double *x = malloc((size_t)brunt_body_particles(world, 0) * sizeof(double[3])), first = INFINITY;
    brunt_body_read(world, 0, brunt_body_find_field(world, 0, "position"), x);
    for (int64_t i = 0; i < brunt_body_particles(world, 0); i++) first = fmin(first, x[3 * i]);
    free(x);
    m = blank(BRUNT_MEASURE_PROFILE);
    strcpy(m.field, "density");
    m.axis[0] = 1;
    m.center[0] = first;
    m.curve = (brunt_curve){at_point, 3};
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 1000 / 2000.0, 0.01);
}
END_TEST

// Each element of a graded bar counts by its volume: eight of the fine half are no more than the one of the coarse.
START_TEST(profiles_weigh_by_volume) {
    brunt_scene blocks;
    const char *sets[] = {
        ("bodies.lower={method: fem, material: rubber, size: 0.1, grading: {x: [[0, 1], [0.999999, 1], "
         "[1, 10]]}, shape: {box: {min: [0, 0, 0], max: [2, 0.1, 0.1]}}}"),
        "boundaries=[]", "contact={method: none}", "output.probes={}"};
    small_scene_of(small_elements_text, &blocks, sets, 4);
    brunt_world *bar = small_world(&blocks);
    ck_assert_int_eq(brunt_body_size(bar, 0, BRUNT_AT_ELEMENTS), 11);
    brunt_measure m = blank(BRUNT_MEASURE_PROFILE);
    double step[4][2] = {{0, 1000}, {1.1, 1000}, {1.1, 3000}, {2, 3000}}, value;
    strcpy(m.body, "lower");
    strcpy(m.field, "density");
    m.axis[0] = 1;
    m.curve = (brunt_curve){step, 4};
    ck_assert_int_eq(brunt_measure_initial(&m, bar, &value, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(value, 2000 / 4000.0, 1e-4);
    // Velocities are at nodes: there is no volume.
    brunt_error error = {0};
    strcpy(m.field, "velocity");
    ck_assert_int_eq(brunt_measure_check(&m, NULL, bar, units, &error), BRUNT_BAD_INPUT);
    ck_assert_msg(
        strstr(error.message, "'velocity' of body 'lower' is at nodes, a profile wants particles or elements"), "%s",
        error.message);
    brunt_world_destroy(bar);
    brunt_scene_free(&blocks);
}
END_TEST

START_TEST(profiles_that_cannot_be_are_refused) {
    brunt_scene read;
    const char *const sets[] = {"measures={a: {profile: {name: density, axis: [1, 0], reference: [[0, 3 Pa]]}},"
                                " b: {profile: {name: density, axis: [1, 0], reference: [[0, 3 g/cm^3]]}}}"};
    brunt_error error = {0};
    small_scene(&read, sets, 1);
    brunt_measure m = read.measures[0];
    ck_assert_int_eq(brunt_measure_check(&m, history, world, units, &error), BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "the reference is in m-1.kg.s-2, the field 'density' in kg/m^3"), "%s",
                  error.message);
    m = read.measures[1];
    ck_assert_int_eq(brunt_measure_check(&m, history, world, units, &error), BRUNT_OK);
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, 2.0 / 3, 100 * rounding);
    strcpy(m.body, "middle");
    ck_assert_int_eq(brunt_measure_check(&m, history, world, units, &error), BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "no body 'middle'"), "%s", error.message);
    m.body[0] = 0;
    strcpy(m.field, "desnity");
    ck_assert_int_eq(brunt_measure_check(&m, history, world, units, &error), BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "no body has a field 'desnity'"), "%s", error.message);
    strcpy(m.body, "left");
    ck_assert_int_eq(brunt_measure_check(&m, history, world, units, &error), BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, "body 'left' has no field 'desnity'"), "%s", error.message);
    strcpy(m.field, "density");
    m.component = 3;
    ck_assert_int_eq(brunt_measure_check(&m, history, world, units, &error), BRUNT_BAD_INPUT);
    m.component = -1;
    m.take = BRUNT_TAKE_MAX;
    ck_assert_int_eq(brunt_measure_check(&m, history, world, units, &error), BRUNT_BAD_INPUT);
    m.take = BRUNT_TAKE_END;
    m.curve.count = 0;
    ck_assert_int_eq(brunt_measure_check(&m, history, world, units, &error), BRUNT_BAD_INPUT);
    brunt_scene_free(&read);
}
END_TEST

// The magnitude of a symmetric tensor stored by six components counts each shear twice, as the tensor holds it:
// sqrt(s : s). The blocks have met and shear.
START_TEST(magnitude_of_a_tensor_counts_shear_twice) {
    small_steps(world, 80);
    const int64_t count = brunt_body_particles(world, 0);
    double *s = malloc(sizeof *s * 6 * (size_t)count), most = 0, sum = 0, shear = 0;
    brunt_body_read(world, 0, brunt_body_find_field(world, 0, "stress"), s);
    for (int64_t p = 0; p < count; p++) {
        const double *v = s + 6 * p; // xx, yy, zz, xy, yz, xz
        const double full[3][3] = {{v[0], v[3], v[5]}, {v[3], v[1], v[4]}, {v[5], v[4], v[2]}};
        double square = 0;
        for (int i = 0; i < 9; i++) square += full[i / 3][i % 3] * full[i / 3][i % 3];
        most = fmax(most, sqrt(square));
        sum += sqrt(square);
        shear = fmax(shear, v[3] * v[3] / square);
    }
    free(s);
    ck_assert_double_gt(shear, 0.1); // of the square: half of it lost would show
    brunt_measure m = blank(BRUNT_MEASURE_FIELD);
    strcpy(m.field, "stress");
    m.take = BRUNT_TAKE_MAX;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, most, 1e-14 * most);
    m.take = BRUNT_TAKE_MEAN;
    ck_assert_double_eq_tol(evaluate(&m, NAN).value, sum / (double)count, 1e-12 * most);
}
END_TEST

START_TEST(unknown_names_are_refused) {
    static const struct {
        brunt_measure_kind kind;
        const char *column, *body, *field;
        brunt_take take;
        const char *message;
    } cases[] = {
        {BRUNT_MEASURE_HISTORY, "energy.kinetik", "", "", BRUNT_TAKE_END, "energy.kinetic"},
        {BRUNT_MEASURE_HISTORY, "enrgy", "", "", BRUNT_TAKE_END, "there are: time step"},
        {BRUNT_MEASURE_EXTENT, "", "middle", "", BRUNT_TAKE_END, "no body 'middle'"},
        {BRUNT_MEASURE_FIELD, "", "left", "velocitee", BRUNT_TAKE_MAX, "no field 'velocitee'"},
        {BRUNT_MEASURE_FIELD, "", "left", "velocity", BRUNT_TAKE_SLOPE, "min, max, mean"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        brunt_measure m = blank(cases[c].kind);
        strcpy(m.column, cases[c].column);
        strcpy(m.body, cases[c].body);
        strcpy(m.field, cases[c].field);
        m.take = cases[c].take;
        m.axis[0] = 1;
        brunt_error error = {0};
        ck_assert_int_eq(brunt_measure_check(&m, history, world, units, &error), BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, cases[c].message) != NULL, "%s", error.message);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("measures");
    TCase *values = tcase_create("values");
    tcase_add_checked_fixture(values, set_up, tear_down);
    tcase_add_test(values, history_is_reduced);
    tcase_add_test(values, magnitude_of_a_tensor_counts_shear_twice);
    tcase_add_test(values, periods_are_found);
    tcase_add_test(values, history_against_a_curve);
    tcase_add_test(values, curves_of_shares);
    tcase_add_test(values, curves_of_scenes);
    tcase_add_test(values, units_are_those_of_columns);
    tcase_add_test(values, units_are_those_of_values);
    tcase_add_test(values, units_of_scenes);
    tcase_add_test(values, values_are_judged);
    tcase_add_test(values, extent_reaches_to_the_surfaces);
    tcase_add_test(values, extent_of_a_turned_block);
    tcase_add_test(values, extent_of_what_has_failed);
    tcase_add_test(values, extent_of_rings);
    tcase_add_test(values, mean_of_rings);
    tcase_add_test(values, radius_about_an_axis);
    tcase_add_test(values, twist_is_the_turn);
    tcase_add_test(values, fields_are_reduced);
    tcase_add_test(values, elements_are_measured);
    tcase_add_test(values, profiles_are_compared);
    tcase_add_test(values, profiles_weigh_by_volume);
    tcase_add_test(values, profiles_that_cannot_be_are_refused);
    tcase_add_test(values, unknown_names_are_refused);
    suite_add_tcase(suite, values);
    return suite_main(suite);
}
