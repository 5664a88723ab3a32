//
// Studies filled by hand: fits, limits and fronts against what they must be in closed form, and what plots and report
// say of them.
#include "tests/support/made_study.h"

#include <sys/stat.h>
#include <unistd.h>

#include "io/study/study_view.h"
#include "tests/support/suite.h"

static const double cells[] = {8e-3, 4e-3, 2e-3, 1e-3, 0.5e-3};
static const char *const methods[] = {"APIC, quadratic", "FEM", "FLIP | 'x'_y"};

// --- numbers that look random, the same everywhere

static uint64_t state;
static double uniform(void) { // (0, 1): splitmix64
    uint64_t z = (state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return ((double)((z ^ (z >> 31)) >> 11) + 0.5) / 9007199254740992.0;
}
static double normal(void) { return sqrt(-2 * log(uniform())) * cos(6.283185307179586 * uniform()); }

// --- fits

START_TEST(power_law_is_found) {
    double y[5];
    for (int i = 0; i < 5; i++) y[i] = 3 * pow(cells[i], 1.7);
    brunt_study_fit fit = brunt_study_line_fit(cells, y, 5);
    ck_assert_int_eq(fit.points, 5);
    ck_assert_double_eq_tol(fit.slope, 1.7, 1e-12);
    ck_assert_double_eq_tol(fit.intercept, log(3), 1e-11);
    ck_assert_double_le(fit.uncertainty, 1e-12);
}
END_TEST

// Logarithms (0, 0), (1, 1), (2, 0): slope 0, squares left 2/3, so a standard error of sqrt(2/3 / 1 / 2) and t(1)
// = 12.706 of it.
START_TEST(interval_is_students) {
    const double x[] = {1, exp(1), exp(2)}, y[] = {1, exp(1), 1};
    brunt_study_fit fit = brunt_study_line_fit(x, y, 3);
    ck_assert_double_eq_tol(fit.slope, 0, 1e-14);
    ck_assert_double_eq_tol(fit.intercept, 1.0 / 3, 1e-14);
    ck_assert_double_eq_tol(fit.uncertainty, 12.706 * sqrt(1.0 / 3), 1e-10);
}
END_TEST

// Integral of Student's density from 0 to t, by Simpson's rule.
static double student_share(double t, int freedom) {
    enum { PARTS = 2000 };
    const double scale = exp(lgamma((freedom + 1) / 2.0) - lgamma(freedom / 2.0)) / sqrt(freedom * 3.141592653589793);
    double sum = 0;
    for (int i = 0; i <= PARTS; i++) {
        const double x = t * i / PARTS, weight = i == 0 || i == PARTS ? 1 : i % 2 ? 4 : 2;
        sum += weight * scale * pow(1 + x * x / freedom, -(freedom + 1) / 2.0);
    }
    return sum * t / PARTS / 3;
}

// Whatever the points leave: the interval in standard errors holds 95 % of Student's distribution. Beyond 30 degrees of
// freedom it is the normal one's, which holds up to 0.9 % less.
START_TEST(every_degree_of_freedom_is_right) {
    for (int count = 3; count <= 60; count++) {
        double x[60], y[60], xx = 0, squares = 0, mean = 0;
        for (int i = 0; i < count; i++)
            x[i] = exp(0.1 * i), y[i] = exp(i % 3 == 1 ? 0.3 : 0.1), mean += 0.1 * i / count;
        brunt_study_fit fit = brunt_study_line_fit(x, y, count);
        for (int i = 0; i < count; i++) {
            const double rest = log(y[i]) - fit.intercept - fit.slope * log(x[i]);
            squares += rest * rest, xx += (0.1 * i - mean) * (0.1 * i - mean);
        }
        const int freedom = count - 2;
        const double t = fit.uncertainty / sqrt(squares / freedom / xx), tolerance = freedom > 30 ? 0.0095 : 1e-4;
        ck_assert_double_eq_tol(2 * student_share(t, freedom), 0.95, tolerance);
    }
}
END_TEST

// The truth lies in 95 % of the intervals, few points or many: of 4000, the share scatters by 0.0034.
START_TEST(interval_holds_the_truth) {
    static const int counts[] = {3, 5, 12, 40};
    for (int k = 0; k < 4; k++) {
        int held = 0;
        state = 7;
        for (int seed = 0; seed < 4000; seed++) {
            double x[40], y[40];
            for (int i = 0; i < counts[k]; i++) x[i] = pow(1.3, i), y[i] = 0.2 * pow(x[i], 1.5) * exp(0.1 * normal());
            brunt_study_fit fit = brunt_study_line_fit(x, y, counts[k]);
            held += fabs(fit.slope - 1.5) <= fit.uncertainty;
        }
        ck_assert_msg(fabs(held / 4000.0 - 0.95) < 0.014, "%d points: %.4f", counts[k], held / 4000.0);
    }
}
END_TEST

START_TEST(few_points_say_what_they_can) {
    const double x[] = {1, 2, 4, 8, 16, 32}, y[] = {1, 0, -1, NAN, INFINITY, 1024};
    brunt_study_fit two = brunt_study_line_fit(x, y, 6), one = brunt_study_line_fit(x, y, 5),
                    none = brunt_study_line_fit(x, y, 0);
    ck_assert_int_eq(two.points, 2);
    ck_assert_double_eq_tol(two.slope, 2, 1e-14);
    ck_assert(isnan(two.uncertainty));
    ck_assert_int_eq(one.points, 1);
    ck_assert(isnan(one.slope) && isnan(one.intercept) && isnan(one.uncertainty));
    ck_assert_int_eq(none.points, 0);
    const double same[] = {0.1, 0.1, 0.1}, any[] = {1, 2, 3};
    ck_assert(isnan(brunt_study_line_fit(same, any, 3).slope));
}
END_TEST

// --- limits

START_TEST(limit_is_found_for_any_ratios) {
    static const double orders[] = {0.3, 0.5, 1, 2, 3.7, 6},
                        grids[][3] = {{4, 2, 1}, {4e-3, 3e-3, 1e-3}, {1, 0.9, 0.3}};
    for (int p = 0; p < 6; p++)
        for (int g = 0; g < 3; g++)
            for (int sign = -1; sign <= 1; sign += 2) {
                double y[3], limit, order;
                for (int i = 0; i < 3; i++) y[i] = 5 + sign * 0.7 * pow(grids[g][i] / grids[g][0], orders[p]);
                ck_assert(brunt_study_richardson(grids[g], y, &limit, &order));
                ck_assert_double_eq_tol(order, orders[p], 1e-8);
                ck_assert_double_eq_tol(limit, 5, 1e-8);
            }
}
END_TEST

START_TEST(what_does_not_converge_is_refused) {
    const double x[] = {4, 2, 1}, wrong[][3] = {{1, 2, 4}, {4, 2, 3}, {1, 2, 1},   {1, 2, 3},
                                                {2, 1, 1}, {2, 2, 1}, {NAN, 2, 1}, {3, INFINITY, 1}};
    double limit, order;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        ck_assert_msg(!brunt_study_richardson(x, wrong[i], &limit, &order), "%zu", i);
        ck_assert(isnan(limit) && isnan(order));
    }
    const double y[] = {5.4, 5.2, 5.1}, rising[] = {1, 2, 4}, twice[] = {4, 2, 2};
    ck_assert(brunt_study_richardson(x, y, &limit, &order));
    ck_assert(!brunt_study_richardson(rising, y, &limit, &order));
    ck_assert(!brunt_study_richardson(twice, y, &limit, &order));
    const double same[] = {7, 7, 7};
    ck_assert(brunt_study_richardson(x, same, &limit, &order));
    ck_assert_double_eq(limit, 7);
    ck_assert(isnan(order));
}
END_TEST

// --- errors

static brunt_study study;

static void tear_down(void) {
    made_free(&study);
    ck_assert_int_eq((int)brunt_memory_live(), 0);
}

// y = limit + C h^p, times that grow as h^-3.
static void fill_line(int32_t line, double limit, double c, double p, double wall) {
    const brunt_study_axis *h = &study.axes[1];
    for (int32_t v = 0; v < h->value_count; v++) {
        const double ratio = h->values[v].number / cells[0];
        made_result(&study, line, v, limit + c * pow(ratio, p), wall * pow(ratio, -3));
        made_at(&study, line, v)->units = 1000 * pow(ratio, -2);
    }
}

START_TEST(errors_follow_the_reference) {
    made_study(&study, methods, 2, cells, 3, 2);
    fill_line(0, 2, 0.4, 1, 1), fill_line(1, 2, 0.1, 2, 2);
    brunt_study_analyse(&study);
    ck_assert_double_eq_tol(made_at(&study, 0, 1)->error[0], 0.1, 1e-14);
    study.measures[0].scale = 4;
    brunt_study_analyse(&study);
    ck_assert_double_eq_tol(made_at(&study, 0, 1)->error[0], 0.05, 1e-14);
    study.measures[0].scale = study.measures[0].exact = NAN; // what the scene expects
    made_at(&study, 0, 1)->expect[0] = 2.2, made_at(&study, 0, 0)->expect[0] = 0;
    brunt_study_analyse(&study);
    ck_assert_double_le(made_at(&study, 0, 1)->error[0], 1e-15);
    ck_assert(isnan(made_at(&study, 0, 0)->error[0])); // relative to zero
    ck_assert(isnan(made_at(&study, 0, 2)->error[0])); // nothing is expected
    study.measures[0].reference = BRUNT_REFERENCE_TABLE;
    study.measures[0].table = brunt_alloc(2 * sizeof(double));
    study.measures[0].table_axis = 0;
    study.measures[0].table[0] = 2, study.measures[0].table[1] = 4;
    brunt_study_analyse(&study);
    ck_assert_double_eq_tol(made_at(&study, 0, 0)->error[0], 0.2, 1e-14);
    ck_assert_double_eq_tol(made_at(&study, 1, 0)->error[0], 1.9 / 4, 1e-14);
}
END_TEST

START_TEST(finest_run_is_not_accurate_by_definition) {
    made_study(&study, methods, 2, cells, 3, NAN);
    fill_line(0, 2, 0.4, 1, 1), fill_line(1, 2, 0.1, 2, 2);
    study.measures[0].reference = BRUNT_REFERENCE_FINEST;
    made_at(&study, 1, 2)->units *= 2; // as fine as the other, of more particles and elements
    brunt_study_analyse(&study);
    const brunt_study_case *finest = made_at(&study, 1, 2);
    ck_assert(isnan(finest->error[0]) && !finest->front[0]);
    ck_assert_double_eq_tol(made_at(&study, 0, 2)->error[0], (2.1 - finest->result[0]) / finest->result[0], 1e-14);
    strcpy(study.measures[0].of, methods[0]);
    brunt_study_analyse(&study);
    ck_assert(isnan(made_at(&study, 0, 2)->error[0]));
    ck_assert_double_gt(finest->error[0], 0);
    made_failure(&study, 0, 2, "lost");
    brunt_study_analyse(&study);
    ck_assert(isnan(made_at(&study, 0, 1)->error[0])); // the finest that finished
}
END_TEST

START_TEST(limits_serve_as_reference) {
    made_study(&study, methods, 2, cells, 4, NAN);
    fill_line(0, 2, 0.4, 1, 1), fill_line(1, 3, 0.1, 2, 2);
    study.measures[0].reference = BRUNT_REFERENCE_RICHARDSON;
    brunt_study_analyse(&study);
    ck_assert_double_eq_tol(study.lines[0].limit[0], 2, 1e-10);
    ck_assert_double_eq_tol(study.lines[0].observed_order[0], 1, 1e-9);
    ck_assert_double_le(study.lines[0].limit_uncertainty[0], 1e-10);
    ck_assert_double_eq_tol(made_at(&study, 0, 0)->error[0], 0.2, 1e-9);
    ck_assert_double_eq_tol(made_at(&study, 1, 0)->error[0], 0.1 / 3, 1e-9);
    ck_assert_double_eq_tol(study.lines[1].order[0].slope, 2, 1e-7);
    strcpy(study.measures[0].of, methods[1]);
    brunt_study_analyse(&study);
    ck_assert_double_eq_tol(made_at(&study, 0, 0)->error[0], 0.2, 1e-9); // 2.4 of 3
    // Values that do not converge have neither a limit nor errors.
    study.measures[0].of[0] = 0;
    made_at(&study, 0, 2)->result[0] = 9;
    brunt_study_analyse(&study);
    ck_assert(isnan(study.lines[0].limit[0]) && isnan(study.lines[0].observed_order[0]) &&
              isnan(made_at(&study, 0, 0)->error[0]));
}
END_TEST

// Values that settle without being monotone: the finest is the limit, the last change its uncertainty and its error.
START_TEST(settled_values_have_a_limit) {
    made_study(&study, methods, 3, cells, 3, NAN);
    static const double values[3][3] = {{-15.38, -16.97, -16.94}, {1, 3, 1}, {1, 2, 2}};
    for (int32_t l = 0; l < 3; l++)
        for (int32_t v = 0; v < 3; v++) made_result(&study, l, v, values[l][v], pow(8, v));
    study.measures[0].reference = BRUNT_REFERENCE_RICHARDSON;
    brunt_study_analyse(&study);
    const brunt_study_line *settled = &study.lines[0], *still = &study.lines[2];
    ck_assert(settled->settled[0] && isnan(settled->observed_order[0]));
    ck_assert_double_eq(settled->limit[0], -16.94);
    ck_assert_double_eq_tol(settled->limit_uncertainty[0], 0.03, 1e-12);
    const brunt_study_case *finest = made_at(&study, 0, 2);
    ck_assert_double_eq_tol(finest->error[0], 0.03 / 16.94, 1e-12);
    ck_assert_double_eq_tol(made_at(&study, 0, 0)->error[0], 1.56 / 16.94, 1e-12);
    ck_assert(brunt_study_doubtful(&study, finest, 0) && !brunt_study_doubtful(&study, made_at(&study, 0, 0), 0));
    ck_assert_int_eq(settled->order[0].points, 2); // the finest's own error is a bound, not a distance
    ck_assert(isnan(brunt_study_plateau(&study, 0, 0)));
    char why[160];
    ck_assert(!brunt_study_lacks_limit(&study, 0, 0, why));
    ck_assert(isnan(study.lines[1].limit[0]) && !study.lines[1].settled[0]);
    ck_assert(brunt_study_lacks_limit(&study, 1, 0, why));
    ck_assert_str_eq(why, "its values 1, 3, 1 do not settle");
    // A last change of zero is no certainty: nothing is without error.
    ck_assert(still->settled[0]);
    ck_assert_double_eq(still->limit_uncertainty[0], 1);
    for (int32_t v = 0; v < 3; v++) ck_assert_double_gt(made_at(&study, 2, v)->error[0], 0);
    made_failure(&study, 1, 0, "lost");
    brunt_study_analyse(&study);
    ck_assert(brunt_study_lacks_limit(&study, 1, 0, why));
    ck_assert_str_eq(why, "fewer than three of its runs give a value");
    study.measures[0].reference = BRUNT_REFERENCE_FINEST; // a limit is not asked for
    ck_assert(!brunt_study_lacks_limit(&study, 1, 0, why));
}
END_TEST

// Three points give limit, slope and intercept exactly: of the order's uncertainty they say nothing.
START_TEST(own_limit_takes_a_degree_of_freedom) {
    made_study(&study, methods, 1, cells, 3, 2);
    fill_line(0, 2, 0.4, 1, 1);
    brunt_study_analyse(&study);
    ck_assert(!isnan(study.lines[0].order[0].uncertainty));
    study.measures[0].reference = BRUNT_REFERENCE_RICHARDSON;
    brunt_study_analyse(&study);
    ck_assert_double_eq_tol(study.lines[0].order[0].slope, 1, 1e-8);
    ck_assert(isnan(study.lines[0].order[0].uncertainty));
    // Without a coarser triple the limit's uncertainty is 3 of the way to it, 1.25 where theory confirms the order.
    ck_assert_double_eq_tol(study.lines[0].limit_uncertainty[0], 0.3, 1e-9);
    study.measures[0].order = 1.05;
    brunt_study_analyse(&study);
    ck_assert_double_eq_tol(study.lines[0].limit_uncertainty[0], 0.125, 1e-9);
}
END_TEST

START_TEST(times_are_medians) {
    made_study(&study, methods, 1, cells, 2, 2);
    for (int32_t v = 0; v < 2; v++) {
        brunt_study_case *c = made_at(&study, 0, v);
        brunt_free(c->wall);
        c->runs = 3 + v;
        c->wall = brunt_alloc(4 * sizeof *c->wall);
        memcpy(c->wall, (double[]){5, 1, 2, 3}, 4 * sizeof *c->wall);
    }
    brunt_study_analyse(&study);
    const brunt_study_case *odd = made_at(&study, 0, 0), *even = made_at(&study, 0, 1);
    ck_assert_double_eq(odd->wall_median, 2);
    ck_assert_double_eq(even->wall_median, 2.5);
    ck_assert_double_eq(even->wall_least, 1);
    ck_assert_double_eq(even->wall_greatest, 5);
    ck_assert_double_eq(even->wall[0], 5); // the order they ran in stays
}
END_TEST

START_TEST(front_has_what_nothing_beats) {
    static const struct {
        double error, wall;
        bool front;
    } cloud[] = {{0.5, 1, true},  {0.5, 1, true},  {0.5, 2, false},   {0.2, 2, true},
                 {0.3, 2, false}, {0.2, 3, false}, {0.1, 4, true},    {0, 10, true},
                 {0, 11, false},  {0.6, 1, false}, {NAN, 0.1, false}, {0.01, NAN, false}};
    enum { N = sizeof cloud / sizeof *cloud };
    const char *names[N + 1];
    for (int i = 0; i <= N; i++) names[i] = "a";
    made_study(&study, names, N + 1, cells, 0, 1);
    for (int i = 0; i < N; i++) made_result(&study, i, 0, 1 + cloud[i].error, cloud[i].wall);
    made_result(&study, N, 0, 1, 0.5);
    made_failure(&study, N, 0, "lost");
    brunt_study_analyse(&study);
    for (int i = 0; i < N; i++) ck_assert_msg(study.cases[i].front[0] == cloud[i].front, "%d", i);
    ck_assert(!study.cases[N].front[0] && isnan(study.cases[N].error[0]));
}
END_TEST

START_TEST(plateaus_are_seen) {
    made_study(&study, methods, 3, cells, 5, 1);
    fill_line(0, 1, 0.3, 2, 1), fill_line(1, 1, 0.3, 2, 1), fill_line(2, 1, 0.3, 1, 1);
    static const double level[] = {0.3, 0.075, 0.019, 0.018, 0.0185}, flat[] = {0.3, 0.29, 0.3, 0.295, 0.3};
    for (int32_t v = 0; v < 5; v++) {
        made_at(&study, 1, v)->result[0] = 1 + level[v];
        made_at(&study, 2, v)->result[0] = 1 + flat[v];
    }
    brunt_study_analyse(&study);
    ck_assert(isnan(brunt_study_plateau(&study, 0, 0)));
    ck_assert_double_eq(brunt_study_plateau(&study, 1, 0), 2e-3);
    ck_assert(isnan(brunt_study_plateau(&study, 2, 0))); // never fell
}
END_TEST

START_TEST(times_over_errors_are_fitted) {
    made_study(&study, methods, 1, cells, 4, 1);
    fill_line(0, 1, 0.3, 2, 0.1);
    brunt_study_analyse(&study);
    ck_assert_double_eq_tol(study.lines[0].cost.slope, 1.5, 1e-12);
    ck_assert_double_eq_tol(brunt_study_price(&study, 0, 0).slope, -1.5, 1e-11);
    ck_assert_double_eq_tol(brunt_study_price(&study, -1, 0).slope, -1.5, 1e-11);
}
END_TEST

START_TEST(numbers_are_written_sensibly) {
    char text[64];
    static const struct {
        double value;
        const char *seconds, *percent;
    } rows[] = {{0.12, "120 ms", "12 %"},     {0.9997, "1 s", "100 %"},    {0.01234, "12.3 ms", "1.23 %"},
                {2.5e-8, "25 ns", "2.5e-08"}, {0.081, "81 ms", "8.1 %"},   {754, "12.6 min", "75400 %"},
                {0, "0 ns", "0 %"},           {9000, "2.5 h", "900000 %"}, {0.00035, "350 us", "0.035 %"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        brunt_study_format_seconds(rows[i].value, text);
        ck_assert_str_eq(text, rows[i].seconds);
        brunt_study_format_percent(rows[i].value, text);
        ck_assert_str_eq(text, rows[i].percent);
    }
    brunt_study_format_value(0.123456, 0.0005, text);
    ck_assert_str_eq(text, "0.1235 ± 0.0005");
    brunt_study_format_value(1.23456e-7, 1.2e-9, text);
    ck_assert_str_eq(text, "(1.235 ± 0.012)e-7");
    brunt_study_format_value(12, NAN, text);
    ck_assert_str_eq(text, "12");
    brunt_study_format_slope(&(brunt_study_fit){4, 1.944, 0, 0.083}, 1, text);
    ck_assert_str_eq(text, "1.94 ± 0.08");
    brunt_study_format_slope(&(brunt_study_fit){2, -1.5, 0, NAN}, -1, text);
    ck_assert_str_eq(text, "1.50");
}
END_TEST

// --- report and pictures

static char folder[64];

static void make_folder(void) {
    strcpy(folder, "/tmp/brunt_study_XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void remove_folder(void) {
    char command[96];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    ck_assert_int_eq(system(command), 0);
    tear_down();
}

static const char *path_of(const char *name) {
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static const char *content(const char *name) {
    static char text[1 << 16];
    FILE *file = fopen(path_of(name), "r");
    ck_assert_msg(file != NULL, "%s", name);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    return text;
}

static const char *report(void) {
    brunt_study_analyse(&study);
    brunt_error error = {0};
    ck_assert_msg(brunt_study_write_report(&study, folder, &error) == BRUNT_OK, "%s", error.message);
    return content("report.md");
}

#define SAYS(text, wanted) ck_assert_msg(strstr(text, wanted) != NULL, "'%s' is not in:\n%.2500s", wanted, text)
#define DOES_NOT_SAY(text, unwanted)                                                                                   \
    ck_assert_msg(strstr(text, unwanted) == NULL, "'%s' is in:\n%.2500s", unwanted, text)

START_TEST(report_answers_first) {
    made_study(&study, methods, 3, cells, 4, 1);
    fill_line(0, 1, 0.4, 1, 0.01), fill_line(1, 1, 0.096, 2, 0.05), fill_line(2, 1, 0.9, 1, 0.02);
    study.accuracies[3] = 0.001, study.accuracy_count = 4;
    const char *text = report();
    // 0.4, 0.2, 0.1 and 0.05; 0.096, 0.024, 0.006 and 0.0015.
    SAYS(text, "- **10 %**: FEM, h = 8 mm: 50 ms, already the coarsest of this method (error 9.6 %). Next best: APIC, "
               "quadratic, h = 2 mm, 640 ms.\n");
    SAYS(text,
         "- **3 %**: FEM, h = 4 mm: 400 ms (error 2.4 %), 8 times the time of 10 %. No other method reaches it.\n");
    SAYS(text, "- **1 %**: FEM, h = 2 mm: 3.2 s (error 0.6 %), 8 times the time of 3 %.");
    SAYS(text, "- **0.1 %**: not reached; the nearest is 0.15 %, by FEM, h = 1 mm in 25.6 s.\n");
    SAYS(text, "along the front of 5 runs time grows as error^-q");
    SAYS(text, "| FEM | 4 of 4 | 0.15 % | 2.000 ± 0.000 | - | 2.00 | 1 | 1.500 ± 0.000 | 1.500 ± 0.000 |");
    SAYS(text, "FLIP \\| 'x'\\_y");
    SAYS(text, "12 finished.");
    SAYS(text, "how far times scatter is not known");
    ck_assert(strstr(text, "**10 %**") < strstr(text, "| method |"));
}
END_TEST

START_TEST(report_is_right_in_odd_cases) {
    made_study(&study, methods, 1, cells, 3, 1); // one method, all reached by the coarsest
    fill_line(0, 1, 0.005, 1, 0.01);
    const char *text = report();
    SAYS(text, "- **10 %**: APIC, quadratic, h = 8 mm: 10 ms, already the coarsest of this method (error 0.5 %).\n");
    SAYS(text, "- **1 %**: the same run (error 0.5 %).\n");
    DOES_NOT_SAY(text, "other method");
    fill_line(0, 2, 0.5, 1, 0.01); // nothing is reached
    text = report();
    SAYS(text, "- **10 %**: not reached; the nearest is 112 %, by APIC, quadratic, h = 2 mm in 640 ms.\n");
    for (int32_t v = 0; v < 3; v++) made_at(&study, 0, v)->result[0] = 1; // exact
    text = report();
    SAYS(text, "3 runs meet the reference to the last bit");
    SAYS(text, "more time bought no less error");
    for (int32_t v = 0; v < 3; v++) made_failure(&study, 0, v, "body 'a|b' is <lost>");
    text = report();
    SAYS(text, "No finished run has an error");
    SAYS(text, "- APIC, quadratic, h = 8 mm: body 'a\\|b' is \\<lost\\>\n");
}
END_TEST

// Of an error that passes through zero on its way, the run nearest to it is no answer.
START_TEST(report_is_not_taken_in_by_a_change_of_sign) {
    made_study(&study, methods, 1, cells, 4, 1);
    static const double error[] = {0.001, 0.2, 0.08, 0.02};
    for (int32_t v = 0; v < 4; v++) made_result(&study, 0, v, 1 + error[v], pow(8, v));
    const char *text = report();
    SAYS(text, "- **10 %**: APIC, quadratic, h = 2 mm: 64 s (error 8 %). (APIC, quadratic, h = 8 mm shows 0.1 % after "
               "1 s, but by accident: "
               "APIC, quadratic, h = 4 mm of the same method is off by 20 %.)");
    SAYS(text, "- **1 %**: not reached reliably.");
}
END_TEST

START_TEST(report_doubts_errors_below_the_reference) {
    made_study(&study, methods, 2, cells, 3, NAN);
    fill_line(0, 2, 0.4, 1, 1), fill_line(1, 2, 0.1, 2, 2);
    study.measures[0].reference = BRUNT_REFERENCE_RICHARDSON;
    strcpy(study.measures[0].of, methods[0]); // known to 3 * 0.1
    study.repeats = 2;
    const char *text = report();
    SAYS(text, "the limit of APIC, quadratic, 2.0 ± 0.3 m");
    SAYS(text, "below the 15 % that the reference can tell");
    SAYS(text, "0.31 % ?");
}
END_TEST

START_TEST(report_knows_levelling_off_and_noise) {
    made_study(&study, methods, 1, cells, 4, 1);
    fill_line(0, 1, 0.3, 2, 1);
    made_at(&study, 0, 3)->result[0] = made_at(&study, 0, 2)->result[0] * 0.999;
    for (int32_t v = 0; v < 4; v++) {
        brunt_study_case *c = made_at(&study, 0, v);
        brunt_free(c->wall);
        c->runs = 2, c->wall = brunt_alloc(2 * sizeof *c->wall);
        c->wall[0] = 0.95, c->wall[1] = 1.05 + (v == 2);
    }
    study.repeats = 2;
    const char *text = report();
    SAYS(text, "The error of APIC, quadratic no longer falls below h = 2 mm");
    SAYS(text, "73 % at most (APIC, quadratic, h = 2 mm)");
    SAYS(text, "the median of 2 repeats");
}
END_TEST

START_TEST(report_names_settled_and_missing_limits) {
    made_study(&study, methods, 3, cells, 3, NAN);
    fill_line(0, 2, 0.1, 2, 1);
    static const double values[2][3] = {{-15.38, -16.97, -16.94}, {1, 3, 1}};
    for (int32_t l = 0; l < 2; l++)
        for (int32_t v = 0; v < 3; v++) made_result(&study, l + 1, v, values[l][v], pow(8, v));
    study.measures[0].reference = BRUNT_REFERENCE_RICHARDSON;
    const char *text = report();
    SAYS(text, "FLIP \\| 'x'\\_y has no limit: its values 1, 3, 1 do not settle; it is not among these.\n");
    ck_assert(strstr(text, "has no limit") < strstr(text, "What the next digit costs"));
    SAYS(text, "| limit [m] |");
    SAYS(text, "| -16.94 ± 0.03 (settled, not extrapolated) |");
    SAYS(text, "Settled, not extrapolated, are the limits of FEM: ");
    SAYS(text, " | -16.94 | 0.177 % ? |");
    DOES_NOT_SAY(text, "FEM has no limit");
    strcpy(study.measures[0].of, methods[1]);
    text = report();
    SAYS(text, "the limit of FEM, -16.94 ± 0.03 m, its finest result: the values have settled");
    DOES_NOT_SAY(text, "has no limit");
    strcpy(study.measures[0].of, methods[2]);
    text = report();
    SAYS(text, "No finished run has an error");
    SAYS(text, "FLIP \\| 'x'\\_y has no limit: its values 1, 3, 1 do not settle.\n");
}
END_TEST

START_TEST(report_counts_the_reference) {
    made_study(&study, methods, 2, cells, 3, NAN);
    fill_line(0, 2, 0.4, 1, 0.01), fill_line(1, 2, 1.6, 1, 0.01);
    study.measures[0].reference = BRUNT_REFERENCE_FINEST;
    made_at(&study, 0, 2)->units *= 2;
    study.accuracies[3] = 0.001, study.accuracy_count = 4;
    const char *text = report();
    SAYS(text, "Beside the reference, no other method reaches it.");
    DOES_NOT_SAY(text, "No other method");
    SAYS(text, "- **0.1 %**: not reached beside the reference; ");
    SAYS(text, "\nThe reference is APIC, quadratic, h = 2 mm (640 ms) itself.\n");
}
END_TEST

// Nothing is said of times, bits, pictures or units that are not there.
START_TEST(report_of_nothing_is_short) {
    made_study(&study, methods, 2, cells, 3, 1);
    for (int32_t i = 0; i < study.case_count; i++) {
        made_failure(&study, study.cases[i].line, study.cases[i].value[1], "lost");
        study.cases[i].unit[0][0] = 0;
    }
    study.repeats = 3;
    const char *text = report();
    SAYS(text, "No run has come to its end.");
    SAYS(text, "| length | error |");
    DOES_NOT_SAY(text, "median");
    DOES_NOT_SAY(text, "to the bit");
    DOES_NOT_SAY(text, "gnuplot");
    DOES_NOT_SAY(text, "Pictures");
    DOES_NOT_SAY(text, "timed once");
}
END_TEST

static bool here(const char *name) { return access(path_of(name), F_OK) == 0; }

static bool plot(void) {
    bool drawn = false;
    brunt_error error = {0};
    brunt_study_analyse(&study);
    ck_assert_msg(brunt_study_write_plots(&study, folder, &drawn, &error) == BRUNT_OK, "%s", error.message);
    return drawn;
}

// Every kind of study that has been thought of is drawn without a word from gnuplot (where it is installed).
START_TEST(pictures_are_drawn) {
    for (int32_t kind = 0; kind < 8; kind++) {
        made_study(&study, methods, kind == 0 ? 1 : 3, cells, kind == 1 ? 0 : kind == 2 ? 1 : 4, 1);
        strcpy(study.title, "It's \"50 %\" of `date` \\n {x}^2_a & <b>");
        strcpy(study.measures[0].title, "error % of 'it', x_y^{2}");
        study.measures[0].order = 2;
        if (study.resolution >= 0)
            for (int32_t l = 0; l < study.line_count; l++) fill_line(l, 1, 0.1 * (l + 1), 1 + l, 0.01);
        for (int32_t i = 0; i < study.case_count; i++) {
            if (kind == 1) made_result(&study, i, 0, 1 + 0.1 * (i + 1), 1);
            if (kind == 3) study.cases[i].result[0] = 1;
            if (kind == 4) study.cases[i].result[0] = 1.1;
            if (kind == 5) study.cases[i].result[0] = NAN;
        }
        if (kind == 6) made_failure(&study, 1, 3, "lost");
        if (kind == 7) {
            study.measures[1] = study.measures[0], study.measure_count = 2;
            strcpy(study.measures[1].name, "order");
            for (int32_t i = 0; i < study.case_count; i++) study.cases[i].result[1] = 1 + 1e-13 * (i + 1);
        }
        bool drawn = plot();
        ck_assert_int_eq(here("study.gp"), kind != 5);
        ck_assert_int_eq(here("study.svg"), drawn && kind != 5);
        ck_assert_int_eq(here("study.png"), drawn && kind != 5);
        ck_assert_int_eq(here("study_order.png"), drawn && kind != 5 && kind != 1);
        ck_assert_int_eq(here("study_measure_order.svg"), drawn && kind == 7);
        if (drawn && kind == 0) SAYS(content("study.svg"), "error % of 'it', x_y^{2}");
        if (kind == 3) SAYS(content("study.gp"), " 2.5e-17 "); // where zeros are drawn
        if (drawn && kind == 0) SAYS(content("study.svg"), "It's \"50 %\" of `date` \\n {x}^2_a &amp; &lt;b");
        tear_down();
    }
}
END_TEST

START_TEST(pictures_say_what_they_leave_out) {
    made_study(&study, methods, 3, cells, 4, NAN);
    fill_line(0, 2, 0.4, 1, 1), fill_line(1, 2, 0.1, 2, 2);
    for (int32_t v = 0; v < 4; v++) made_result(&study, 2, v, v % 2 ? 4 + v : 1, 1);
    made_failure(&study, 0, 0, "lost"), made_failure(&study, 1, 0, "lost");
    study.measures[0].reference = BRUNT_REFERENCE_RICHARDSON;
    plot();
    SAYS(content("study.gp"), "× 2 runs failed: APIC quadratic, FEM'");
    SAYS(content("study.gp"), "set label '' at graph 0.0360, graph 0.9850 point");
    SAYS(content("study.gp"), "'not shown: FLIP | ''x''_y (no limit)'");
    SAYS(content("study.gp"), "'A made-up study' at");
    SAYS(content("study_order.gp"), "'A made-up study (fitted orders)'");
    SAYS(content("study_cost.gp"), "'A made-up study (fitted exponents)'");
    study.measures[0].reference = BRUNT_REFERENCE_FINEST;
    made_at(&study, 1, 3)->units *= 2;
    plot();
    SAYS(content("study.gp"), "'reference, not shown: FEM, h = 1 mm'");
    DOES_NOT_SAY(content("study.gp"), "no limit");
}
END_TEST

START_TEST(long_lists_of_failures_are_cut) {
    static char names[30][48];
    const char *labels[30];
    for (int i = 0; i < 30; i++) {
        snprintf(names[i], sizeof names[i], "method, number %d", i);
        labels[i] = names[i];
    }
    made_study(&study, labels, 30, cells, 3, 1);
    for (int32_t l = 0; l < 30; l++) {
        fill_line(l, 1, 0.1, 1, 1);
        made_failure(&study, l, 2, "lost"), made_failure(&study, l, 1, "lost");
    }
    plot();
    SAYS(content("study.gp"), "× 60 runs failed: method number 0, ");
    SAYS(content("study.gp"), ", ...'");
    SAYS(content("study.gp"), "graph 0.9550 point"); // a second row
}
END_TEST

// A word of gnuplot's own would be its warning that there is no terminal yet.
START_TEST(scripts_run_without_a_word) {
    made_study(&study, methods, 2, cells, 4, 1);
    fill_line(0, 1, 0.4, 1, 1), fill_line(1, 1, 0.1, 2, 2);
    if (!plot()) return; // no gnuplot
    char command[256];
    static const char *const scripts[] = {"study", "study_order", "study_cost"};
    for (int i = 0; i < 3; i++) {
        snprintf(command, sizeof command, "cd '%s' && env -u DISPLAY gnuplot -d %s.gp >said 2>&1", folder, scripts[i]);
        ck_assert_int_eq(system(command), 0);
        ck_assert_str_eq(content("said"), "");
    }
}
END_TEST

static void use_path(const char *path) { ck_assert_int_eq(setenv("PATH", path, 1), 0); }

START_TEST(without_gnuplot_the_scripts_are_there) {
    made_study(&study, methods, 1, cells, 4, 1);
    fill_line(0, 1, 0.3, 2, 1);
    char *path = strdup(getenv("PATH"));
    use_path(folder);
    bool drawn = plot();
    use_path(path);
    ck_assert(!drawn && here("study.gp") && here("study_order.gp") && here("study_cost.gp") && !here("study.png"));
    free(path);
}
END_TEST

START_TEST(what_gnuplot_says_is_returned) {
    made_study(&study, methods, 1, cells, 4, 1);
    fill_line(0, 1, 0.3, 2, 1);
    brunt_study_analyse(&study);
    FILE *file = fopen(path_of("gnuplot"), "w");
    fputs("#!/bin/sh\n: >study.png\necho 'no such terminal' >&2\nexit 1\n", file);
    fclose(file);
    chmod(path_of("gnuplot"), 0700);
    char *path = strdup(getenv("PATH"));
    use_path(folder);
    bool drawn;
    brunt_error error = {0};
    int status = brunt_study_write_plots(&study, folder, &drawn, &error);
    use_path(path);
    free(path);
    ck_assert_int_eq(status, BRUNT_IO_ERROR);
    SAYS(error.message, "study.gp: gnuplot refused it: no such terminal");
    ck_assert(!here("study.png")); // half a picture is none
}
END_TEST

int main(void) {
    Suite *suite = suite_create("study_fit");
    TCase *fits = tcase_create("fits");
    tcase_add_test(fits, power_law_is_found);
    tcase_add_test(fits, interval_is_students);
    tcase_add_test(fits, every_degree_of_freedom_is_right);
    tcase_add_test(fits, interval_holds_the_truth);
    tcase_add_test(fits, few_points_say_what_they_can);
    tcase_add_test(fits, limit_is_found_for_any_ratios);
    tcase_add_test(fits, what_does_not_converge_is_refused);
    tcase_add_test(fits, numbers_are_written_sensibly);
    suite_add_tcase(suite, fits);
    TCase *errors = tcase_create("errors");
    tcase_add_checked_fixture(errors, NULL, tear_down);
    tcase_add_test(errors, errors_follow_the_reference);
    tcase_add_test(errors, finest_run_is_not_accurate_by_definition);
    tcase_add_test(errors, limits_serve_as_reference);
    tcase_add_test(errors, settled_values_have_a_limit);
    tcase_add_test(errors, own_limit_takes_a_degree_of_freedom);
    tcase_add_test(errors, times_are_medians);
    tcase_add_test(errors, front_has_what_nothing_beats);
    tcase_add_test(errors, plateaus_are_seen);
    tcase_add_test(errors, times_over_errors_are_fitted);
    suite_add_tcase(suite, errors);
    TCase *files = tcase_create("files");
    tcase_add_checked_fixture(files, make_folder, remove_folder);
    tcase_add_test(files, report_answers_first);
    tcase_add_test(files, report_is_right_in_odd_cases);
    tcase_add_test(files, report_is_not_taken_in_by_a_change_of_sign);
    tcase_add_test(files, report_doubts_errors_below_the_reference);
    tcase_add_test(files, report_knows_levelling_off_and_noise);
    tcase_add_test(files, pictures_are_drawn);
    tcase_add_test(files, report_names_settled_and_missing_limits);
    tcase_add_test(files, report_counts_the_reference);
    tcase_add_test(files, report_of_nothing_is_short);
    tcase_add_test(files, pictures_say_what_they_leave_out);
    tcase_add_test(files, long_lists_of_failures_are_cut);
    tcase_add_test(files, scripts_run_without_a_word);
    tcase_add_test(files, without_gnuplot_the_scripts_are_there);
    tcase_add_test(files, what_gnuplot_says_is_returned);
    suite_add_tcase(suite, files);
    return suite_main(suite);
}
