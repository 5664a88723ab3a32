// Friction of load steps, as a user meets it: Coulomb's law, what surfaces have given is kept from step to step and
// over a restart, and what has no equilibrium is said with body and exit code 70.
#include "tests/support/small_columns.h"
#include "tests/support/small_hash.h"

#ifndef BRUNT_FLOAT
static const char block[] =
    "brunt: 1\ntitle: a block is pressed, then sheared to and fro\ndimension: 2\n"
    "time: {scheme: static, steps: 20}\nnewton: {tolerance: 1e-9, iterations: 200}\n"
    "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 50 MPa, nu: 0.3}}\nbodies:\n"
    "  lower: {method: fem, element: quad4, size: 2 mm, material: m, shape: {box: {min: [-20 mm, 0], max: [20 mm, 4 "
    "mm]}}}\n"
    "  upper: {method: fem, element: quad4, size: 2 mm, material: m, shape: {box: {min: [-5 mm, 4.006 mm], max: [5 mm, "
    "8.006 mm]}}}\n"
    "boundaries:\n"
    "  - {name: base, body: lower, group: ymin, fix: [x, y]}\n"
    "  - {name: press, body: upper, group: ymax, displacement: [free, -0.04 mm], table: [[0 s, 0], [0.2 s, 1]]}\n"
    "  - {name: shear, body: upper, group: ymax, displacement: [0.1 mm, free], table: [[0.2 s, 0], [0.4 s, 1], [0.6 s, "
    "1], "
    "[1 s, -1]]}\n"
    "contact: {method: barrier, friction: 0.3, distance: 10 um}\n"
    "output: {history: 0 s, every: none}\n";

static const char *const methods[] = {"barrier", "penalty"};

// Forces stay below Coulomb's bound and come to it, the other way when the shear is turned; where nothing moves any
// more nothing changes, though each load step begins anew; what the base takes is what goes through the contact.
START_TEST(friction_is_kept_from_step_to_step) {
    double time[ROWS], fx[ROWS], fy[ROWS], base[ROWS], error[ROWS], heat[ROWS], iterations[ROWS];
    char run[100];
    small_put("block.yaml", block);
    snprintf(run, sizeof run, "run block.yaml -t 1 -q -o out --set contact.method=%s", methods[_i]);
    small_expect(run, 0, NULL);
    const int rows = read_column("out", "time", time);
    read_column("out", "contact.lower-upper.force_x", fx), read_column("out", "contact.lower-upper.force_y", fy);
    read_column("out", "wall.base.force_x", base), read_column("out", "energy.error_relative", error);
    read_column("out", "energy.friction", heat), read_column("out", "newton.iterations", iterations);
    ck_assert_int_eq(rows, 21);
    for (int r = 1; r < rows; r++) {
        ck_assert_double_le(fabs(fx[r]), 1.0002 * 0.3 * fy[r]);
        ck_assert_double_eq_tol(base[r], fx[r], 1e-6 * fy[r]);
        ck_assert_double_lt(fabs(error[r]), 1e-8);
        ck_assert_double_ge(heat[r], heat[r - 1] * (1 - 1e-3));
    }
    ck_assert_double_eq_tol(fx[4], 0, 1e-6 * fy[4]);
    ck_assert_double_eq_tol(fx[8], -0.3 * fy[8], 1e-3 * fy[8]);
    for (int r = 9; r <= 12; r++) { // nothing moves
        ck_assert_double_eq_tol(fx[r], fx[8], 1e-6 * fy[8]);
        ck_assert_double_eq(iterations[r], 0);
    }
    ck_assert_double_lt(fabs(fx[13]), 0.5 * fabs(fx[12])); // sticks on its way back
    ck_assert_double_eq_tol(heat[13], heat[12], 1e-3 * heat[12]);
    ck_assert_double_eq_tol(fx[20], 0.3 * fy[20], 1e-3 * fy[20]);
    // Heat of the way back at full slip: mu N a millimetre.
    ck_assert_double_eq_tol(heat[20] - heat[19], 0.3 * fy[20] * 0.025e-3, 2e-3 * (heat[20] - heat[19]));
}
END_TEST

// While it sticks with a force that an earlier step has left.
START_TEST(friction_is_kept_over_a_restart) {
    const char *contact[] = {"method: barrier, distance: 10 um", "method: penalty, distance: 10 um",
                             "method: penalty, slip_length: 0.02 um",
                             "method: penalty, slip_length: 0.02 um, surface: arcs"};
    small_put("block.yaml", block);
    char words[300], set[120];
    snprintf(set, sizeof set, "--set 'contact={friction: 0.3, %s}'", contact[_i]);
    for (int threads = 1; threads <= 2; threads++) {
        snprintf(words, sizeof words, "run block.yaml -t %d -q -o %s %s", threads, threads == 1 ? "one" : "two", set);
        small_expect(words, 0, NULL);
    }
    // The step that turns takes the most iterations of all, one more than are allowed in the first leg; the first of
    // penalties is solved twice.
    double iterations[ROWS], most = 0;
    const int rows = read_column("one", "newton.iterations", iterations);
    for (int r = 2; r < 13; r++) most = fmax(most, iterations[r]);
    ck_assert(rows == 21 && iterations[13] > most);
    snprintf(words, sizeof words, "run block.yaml -t 1 -q -o legs --set newton.iterations=%g --set newton.cut=0 %s",
             iterations[13] - 1, set);
    small_expect(words, 70, "time 0.6 s");
    snprintf(words, sizeof words, "run block.yaml -t 2 -q -o legs --resume %s", set);
    small_expect(words, 0, NULL);
    ck_assert_uint_eq(hash_of("one"), hash_of("two"));
    ck_assert_uint_eq(hash_of("one"), hash_of("legs"));
    ck_assert_int_eq(small_shell("cmp one/history.csv two/history.csv"), 0);
}
END_TEST

// A line of tractions.csv.
typedef struct rim_line {
    char body[32], other[32];
    double along, x, y, normal, tangential;
} rim_line;

static int read_rims(const char *folder, rim_line line[ROWS]) {
    char path[200], text[400];
    int count = 0;
    snprintf(path, sizeof path, "%s/%s/tractions.csv", small_folder, folder);
    FILE *file = fopen(path, "r");
    ck_assert(file && fgets(text, sizeof text, file));
    ck_assert_str_eq(text, "body,other,along [m],x [m],y [m],normal [Pa],tangential [Pa]\n");
    for (rim_line *l = line; fgets(text, sizeof text, file) && count < ROWS; count++, l++)
        ck_assert_int_eq(sscanf(text, "%31[^,],%31[^,],%lf,%lf,%lf,%lf,%lf", l->body, l->other, &l->along, &l->x, &l->y,
                                &l->normal, &l->tangential),
                         7);
    fclose(file);
    return count;
}

// Nodes' forces over 2 mm each add up to the force between the bodies, on both rims. Where all slips, each node has
// Coulomb's friction along its rim: that of the upper block runs to +x, where it is pushed, that of the lower one to
// -x.
START_TEST(tractions_are_told_along_rims) {
    double fx[ROWS], fy[ROWS], sum[2][2] = {{0}};
    rim_line line[ROWS];
    small_put("block.yaml", block);
    static const char *const contact[] = {"method: barrier", "method: penalty, surface: arcs"};
    static const char run[] = "run block.yaml -t 1 -q -o out --set output.tractions=true --set 'contact={friction: %g, "
                              "distance: 10 um, %s}' %s";
    char words[300];
    snprintf(words, sizeof words, run, 0.3, contact[_i], "");
    small_expect(words, 0, NULL);
    const int count = read_rims("out", line), last = read_column("out", "contact.lower-upper.force_x", fx) - 1;
    read_column("out", "contact.lower-upper.force_y", fy);
    ck_assert_int_ge(count, 2 * 5);
    for (int k = 0; k < count; k++) {
        const bool upper = line[k].body[0] == 'u';
        ck_assert_str_eq(line[k].other, upper ? "lower" : "upper");
        ck_assert_double_eq_tol(line[k].tangential, 0.3 * line[k].normal, 1e-3 * line[k].normal);
        sum[upper][0] += 2e-3 * line[k].normal, sum[upper][1] += 2e-3 * line[k].tangential;
        if (k == 0 || strcmp(line[k].body, line[k - 1].body)) continue;
        ck_assert((line[k].x > line[k - 1].x) == upper);
        ck_assert_double_eq_tol(line[k].along - line[k - 1].along, 2e-3, 1e-9);
    }
    for (int side = 0; side < 2; side++) {
        ck_assert_double_eq_tol(sum[side][0], fy[last], 1e-3 * fy[last]); // surfaces lean by a little
        ck_assert_double_eq_tol(sum[side][1], fx[last], 1e-3 * fx[last]);
    }
    // What goes on from the end takes no step, and has nothing else to tell.
    char command[256];
    snprintf(command, sizeof command, "cp %s/out/tractions.csv %s/kept", small_folder, small_folder);
    ck_assert_int_eq(system(command), 0);
    snprintf(words, sizeof words, run, 0.3, contact[_i], "--resume");
    small_expect(words, 0, NULL);
    snprintf(command, sizeof command, "cmp %s/out/tractions.csv %s/kept", small_folder, small_folder);
    ck_assert_int_eq(system(command), 0);
    snprintf(words, sizeof words, run, 0.0, contact[_i], "--fresh");
    small_expect(words, 0, NULL);
    for (int k = read_rims("out", line) - 1; k >= 0; k--) ck_assert_double_eq(line[k].tangential, 0);
}
END_TEST

// A wedge of slope 0.2 is pressed down on its like, with nothing that keeps it from sliding but friction, and a smooth
// wall after a way: above 0.2 it stays, below it slides there and leaves the wall what friction does not take.
static const char wedges[] =
    "brunt: 1\ntitle: wedges\ndimension: 2\ntime: {scheme: static, steps: 4}\n"
    "newton: {tolerance: 1e-8, iterations: 300}\n"
    "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 50 MPa, nu: 0.3}}\nbodies:\n"
    "  lower: {method: fem, element: quad4, size: 1 mm, material: m, shape: {polygon: {points: [[-2 mm, 0], [12 mm, "
    "0], "
    "[12 mm, 4.4 mm], [-2 mm, 1.6 mm]]}}}\n"
    "  upper: {method: fem, element: quad4, size: 1 mm, material: m, shape: {polygon: {points: [[0, 2.005 mm], [10 mm, "
    "4.005 mm], [10 mm, 6 mm], [0, 6 mm]]}}}\n"
    "boundaries:\n"
    "  - {name: base, body: lower, group: side1, fix: [x, y]}\n"
    "  - {name: press, body: upper, group: side3, displacement: [free, -0.05 mm]}\n"
    "  - {name: wall, body: upper, plane: {point: [-0.05 mm, 0], normal: [1, 0]}, condition: separate}\n"
    "contact: {method: barrier, friction: 0.21, distance: 10 um}\noutput: {history: 0 s, every: none}\n";

START_TEST(wedge_slides_below_its_slope_alone) {
    double x[ROWS], wall[ROWS], up[ROWS];
    small_put("wedges.yaml", wedges);
    small_expect("run wedges.yaml -t 1 -q -o sticks", 0, NULL);
    int last = read_column("sticks", "body.upper.position_x", x) - 1;
    read_column("sticks", "wall.wall.force_x", wall);
    ck_assert_double_eq(wall[last], 0);
    const double elastic = x[last] - x[0], mu[] = {0.19, 0.15, 0.1, 0.05, 0.01, 0};
    double slid = elastic - 8e-6;
    for (size_t k = 0; k < sizeof mu / sizeof *mu; k++) {
        char words[200];
        snprintf(words, sizeof words, "run wedges.yaml -t 1 -q -o slides --set contact.friction=%g", mu[k]);
        small_expect(words, 0, NULL);
        read_column("slides", "body.upper.position_x", x), read_column("slides", "wall.wall.force_x", wall);
        last = read_column("slides", "wall.base.force_y", up) - 1;
        ck_assert_double_lt(x[last] - x[0], slid); // the farther, the less friction
        slid = x[last] - x[0];
        // Statics of the wedge: friction takes mu of what presses at most; what spreads pushes the wall as well.
        const double least = (0.2 - mu[k]) / (1 + 0.2 * mu[k]), share = wall[last] / up[last];
        ck_assert_double_ge(share, least - 3e-3);
        if (mu[k] == 0) ck_assert_double_eq_tol(share, 0.2, 3e-3);
    }
}
END_TEST

// Penalties, by which a corner of one lies within the other's slope, hold it above the slope as barriers do: the wall
// has nothing to bear. Where friction that follows what presses leads nowhere it is not tried again until less is left:
// 36 iterations a load step at most, not hundreds.
START_TEST(wedge_stays_on_penalties) {
    double wall[ROWS], iterations[ROWS];
    small_put("wedges.yaml", wedges);
    small_expect("run wedges.yaml -t 1 -q -o sticks --set contact.method=penalty", 0, NULL);
    const int rows = read_column("sticks", "wall.wall.force_x", wall);
    read_column("sticks", "newton.iterations", iterations);
    for (int r = 0; r < rows; r++) {
        ck_assert_double_eq(wall[r], 0);
        ck_assert_double_lt(iterations[r], 100);
    }
}
END_TEST

// Without the wall it has no equilibrium: that is said, and nothing of it is kept.
START_TEST(what_slides_away_is_70) {
    small_put("wedges.yaml", wedges);
    ck_assert_int_eq(
        small_shell("sed '/name: wall/d; s/friction: 0.21/friction: 0.19/; s/iterations: 300/iterations: 60, cut: 1/; "
                    "s/displacement: .free, -0.05 mm./traction: [0, -100 kPa]/' wedges.yaml > away.yaml"),
        0);
    small_expect("run away.yaml -t 1 -q -o away", 70, "body 'upper'");
    small_expect("run away.yaml -t 1 -q -o away", 70, "friction does not settle within 60 iterations");
    // Above its slope it stays. Where it is given how far it comes down, it comes to rest where it lies on nothing.
    small_expect("run away.yaml -t 1 -q -o stays --set contact.friction=0.21", 0, NULL);
    double up[ROWS];
    small_expect("run away.yaml -t 1 -q -o beside --set 'boundaries[1]={name: press, body: upper, group: side3, "
                 "displacement: [free, -0.05 mm]}'",
                 0, NULL);
    const int last = read_column("beside", "wall.base.force_y", up) - 1;
    ck_assert_double_eq_tol(up[last], 0, 1e-6);
}
END_TEST

// A block that only just touches, and one that is pressed: of the loose one there is next to nothing, and all of it
// would be left. It is told beside what acts on all.
START_TEST(loose_bodies_balance) {
    double body[ROWS];
    static const char loose[] =
        "brunt: 1\ndimension: 2\ntime: {scheme: static, steps: 3}\nnewton: {tolerance: 1e-9}\n"
        "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 50 MPa, nu: 0.3}}\nbodies:\n"
        "  base: {method: fem, element: quad4, size: 2 mm, material: m, shape: {box: {min: [0, 0], max: [40 mm, 4 "
        "mm]}}}\n"
        "  block: {method: fem, element: quad4, size: 2 mm, material: m, shape: {box: {min: [3 mm, 4.009 mm], max: [7 "
        "mm, 8.009 mm]}}}\n"
        "  loose: {method: fem, element: quad4, size: 2 mm, material: m, shape: {box: {min: [30 mm, 4.0099 mm], max: "
        "[34 mm, 8.009 mm]}}}\n"
        "boundaries:\n  - {body: base, group: ymin, fix: [x, y]}\n"
        "  - {name: press, body: block, group: ymax, displacement: [0, -0.02 mm], table: [[0 s, 0], [1 s, 1]]}\n"
        "contact: {method: barrier, distance: 10 um}\noutput: {every: none, history: 0 s}\n";
    small_put("loose.yaml", loose);
    small_expect("run loose.yaml -t 1 -q -o loose", 0, NULL);
    const int rows = read_column("loose", "balance.body", body);
    for (int r = 0; r < rows; r++) ck_assert_double_le(body[r], 1e-6);
    ck_assert_double_gt(body[rows - 1], 0);
}
END_TEST

// A block of 8 mm on, or (`swapped`) below, one of 80 mm that is held, `off` of an edge beside its nodes, pressed by 1
// MPa, then sheared by `ratio` of that; mirrored; all turned by 90 degrees.
typedef struct sheared_block {
    double off, ratio;
    bool mirrored, swapped, turned;
} sheared_block;

static void turn_by(const sheared_block *s, double x, double y, double out[2]) {
    const double a = s->mirrored ? -x : x, b = s->swapped ? -y : y;
    out[0] = s->turned ? -b : a, out[1] = s->turned ? a : b;
}

static void put_sheared(const char *name, const sheared_block *s) {
    const double corner[4][2] = {{-40 - 2 * s->off, -2}, {40 - 2 * s->off, 0}, {-4, 0}, {4, 2}};
    const bool below = s->swapped == s->turned; // what is held has its base at the least coordinate
    const char *const across = s->turned ? "x" : "y", *const held = below ? "min" : "max",
                      *const pressed = below ? "max" : "min", *const loose = s->swapped ? "block" : "loose";
    double box[4][2], press[2], shear[2];
    char text[1600];
    for (int k = 0; k < 4; k++) turn_by(s, corner[k][0], corner[k][1], box[k]);
    turn_by(s, 0, -1e6, press), turn_by(s, 1e6 * s->ratio, 0, shear);
    snprintf(
        text, sizeof text,
        "brunt: 1\ndimension: 2\ntime: {scheme: static, steps: 4}\n"
        "newton: {tolerance: 1e-8, iterations: 60, cut: 0}\n"
        "materials: {m: {model: linear-elastic, density: 1000 kg/m^3, E: 50 MPa, nu: 0.3}}\nbodies:\n"
        "  held: {method: fem, element: quad4, size: 2 mm, material: m, shape: {box: {min: [%.9g mm, %.9g mm], max: "
        "[%.9g mm, %.9g mm]}}}\n"
        "  %s: {method: fem, element: quad4, size: 2 mm, material: m, shape: {box: {min: [%.9g mm, %.9g mm], max: "
        "[%.9g mm, %.9g mm]}}}\n"
        "boundaries:\n  - {name: base, body: held, group: %s%s, fix: [x, y]}\n"
        "  - {name: press, body: %s, group: %s%s, traction: [%g, %g], table: [[0 s, 0], [0.5 s, 1]]}\n"
        "  - {name: shear, body: %s, group: %s%s, traction: [%g, %g], table: [[0.5 s, 0], [1 s, 1]]}\n"
        "contact: {method: penalty, friction: 0.3}\noutput: {history: 0 s, every: none}\n",
        fmin(box[0][0], box[1][0]), fmin(box[0][1], box[1][1]), fmax(box[0][0], box[1][0]), fmax(box[0][1], box[1][1]),
        loose, fmin(box[2][0], box[3][0]), fmin(box[2][1], box[3][1]), fmax(box[2][0], box[3][0]),
        fmax(box[2][1], box[3][1]), across, held, loose, across, pressed, press[0], press[1], loose, across, pressed,
        shear[0], shear[1]);
    small_put(name, text);
}

// Whatever is below its corners, a node that they are right above as well, a block holds what Coulomb's law lets it,
// and slides by little more: no node of the other within a corner keeps it by leaving through the block's side. Two
// nodes that are passed at once may be up to 0.003 of what presses.
START_TEST(corners_do_not_hold_what_slides) {
    static const double off[] = {0, 1 / 3.0, 0.5, 0.97}, ratio[] = {0.29, 0.31, 0.4};
    for (int k = 0; k < 12; k++) {
        const sheared_block plain = {off[k % 4], ratio[k / 4], false, false, false};
        for (int way = 0; way < (k % 4 == 0 && k < 8 ? 8 : 1); way++) {
            sheared_block s = plain;
            s.mirrored = way & 1, s.swapped = way & 2, s.turned = way & 4;
            put_sheared("sheared.yaml", &s);
            small_expect("run sheared.yaml -t 1 -q -o sheared --fresh", s.ratio < 0.3 ? 0 : 70, NULL);
        }
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("program_static");
    TCase *tests = tcase_create("program_static");
    tcase_add_checked_fixture(tests, small_folder_make, small_folder_remove);
    tcase_set_timeout(tests, 0);
    tcase_add_loop_test(tests, friction_is_kept_from_step_to_step, 0, 2);
    tcase_add_loop_test(tests, friction_is_kept_over_a_restart, 0, 4);
    tcase_add_loop_test(tests, tractions_are_told_along_rims, 0, 2);
    tcase_add_test(tests, wedge_slides_below_its_slope_alone);
    tcase_add_test(tests, wedge_stays_on_penalties);
    tcase_add_test(tests, what_slides_away_is_70);
    tcase_add_test(tests, loose_bodies_balance);
    tcase_add_test(tests, corners_do_not_hold_what_slides);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
#else
int main(void) { return 0; }
#endif
