// What release gives back (constraint/release.h), of constraints alone: beads that share masters, with whatever they
// hold. Energy and momentum are counted by hand.
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "contact/constraint/constraint.h"
#include "tests/support/suite.h"

enum { SLAVES = 6, LIMIT = SLAVES + 1 };

typedef struct beads {
    double mass[LIMIT], v[LIMIT], held[SLAVES]; // [kg, m/s, J]; the last is the master of all
    double push;                                // [m/s] that the last slave comes with; 0: it parts as the others
    double gap;                                 // [m] of all
    int32_t partner[SLAVES], of[SLAVES];        // of the constraint, and of whom is held
} beads;

typedef struct given {
    double gained, left, least, momentum, booked; // [J, J, J, N s, J]
    double v[LIMIT], held[SLAVES];
} given;

static void add_bead(brunt_constraint_set *p, const beads *b, int k, brunt_impulse_account *account,
                     brunt_touch_energy *touch) {
    ck_assert_int_eq(brunt_constraints_add(p, NULL), k);
    brunt_constraint *c = &p->constraint[k];
    c->n[1] = c->facet[1] = 1, c->account = account, c->sign = 1, c->gap = b->gap;
    touch[k] = (brunt_touch_energy){.held = b->held[k], .partner = b->of[k]}, c->touch = &touch[k];
    c->partner = b->partner[k];
    brunt_constraints_entry(p, k, 1, NULL), brunt_constraints_entry(p, SLAVES, -1, NULL);
}

static given release(const beads *b) {
    brunt_constraint_set p = {.gives_back = true, .shallow = 1e-3, .leap = 1e9};
    brunt_impulse_account account = {.area = 0};
    brunt_touch_energy touch[SLAVES];
    brunt_timer timer = {0};
    given out = {.least = INFINITY};
    for (int i = 0; i < LIMIT; i++) {
        ck_assert_int_eq(brunt_constraints_dof_node(&p, NULL), i);
        p.dof_node[i].v[1] = p.dof_node[i].old[1] = b->v[i] - (i == SLAVES - 1 ? b->push : 0);
        for (int a = 0; a < 3; a++) p.dof_node[i].inverse[a] = 1 / b->mass[i];
        out.gained -= 0.5 * b->mass[i] * p.dof_node[i].v[1] * p.dof_node[i].v[1];
        out.momentum -= b->mass[i] * p.dof_node[i].v[1];
    }
    for (int k = 0; k < SLAVES; k++) add_bead(&p, b, k, &account, touch);
    ck_assert_int_eq(brunt_constraints_solve(&p, 64, 0, 1, &timer, NULL), BRUNT_OK);
    for (int i = 0; i < LIMIT; i++) {
        out.v[i] = p.dof_node[i].v[1];
        out.gained += 0.5 * b->mass[i] * out.v[i] * out.v[i];
        out.momentum += b->mass[i] * out.v[i];
    }
    for (int k = 0; k < SLAVES; k++) {
        out.held[k] = touch[k].held, out.left += touch[k].held, out.least = fmin(out.least, touch[k].held);
        ck_assert(p.constraint[k].normal_impulse >= 0);
    }
    out.booked = account.normal_loss;
    brunt_constraints_free(&p);
    return out;
}

static double sum(const double *values, int count) {
    double all = 0;
    for (int i = 0; i < count; i++) all += values[i];
    return all;
}

// One alone gets what it held, but for the hundredth at which rounds end, whatever its velocities are.
START_TEST(one_gets_what_it_held) {
    const double away = 0.1 * _i;
    beads b = {.mass = {2, 1, 1, 1, 1, 1, 3}, .v = {away}, .held = {0.7}};
    const given g = release(&b);
    ck_assert_double_le(g.gained, 0.7);
    ck_assert_double_ge(g.gained, 0.99 * 0.7);
    ck_assert_double_eq_tol(g.booked, -g.gained, 1e-12);
    ck_assert_double_eq_tol(g.gained + g.left, 0.7, 1e-3 * 0.7);
    ck_assert_double_eq_tol(g.momentum, 0, 1e-14);
    // Reduced mass 1.2: what is gained is 0.6 (u^2 - away^2).
    ck_assert_double_eq_tol(g.v[0] - g.v[SLAVES], sqrt(away * away + g.gained / 0.6), 1e-12);
}
END_TEST

// Light and heavy ones on one master, with much and little: what is gained and what is left are what was held, no one
// owes anything, and nearly all is given.
START_TEST(together_they_get_no_more) {
    const beads cases[] = {
        {.mass = {1, 1, 1, 1, 1, 1, 1}, .held = {1, 1, 1, 1, 1, 1}},
        {.mass = {1, 1, 1, 1, 1, 1, 1}, .held = {1, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3}},
        {.mass = {100, 1, 1, 0.01, 1, 1, 0.1}, .held = {1, 1e-4, 1e-4, 1, 1e-4, 1e-4}},
        {.mass = {1, 1, 1, 1, 1, 1, 1e3}, .held = {1, 0, 1e-9, 1, 0.1, 3}},
        {.mass = {1, 1, 1, 1, 1, 1, 1}, .v = {0.1, 0.2, 0, 0, 1, 0, 0}, .held = {1, 1e-3, 1, 1e-3, 1e-3, 1e-3}},
    };
    const beads *b = &cases[_i];
    const given g = release(b);
    const double held = sum(b->held, SLAVES);
    printf("  held %.4f: gained %.4f, left %.2e, least %.2e\n", held, g.gained, g.left, g.least);
    ck_assert_double_eq_tol(g.gained, -g.booked, 1e-12 * held);
    ck_assert_double_le(g.gained, held * (1 + 1e-9));
    ck_assert_double_ge(g.gained, 0.99 * held);
    ck_assert_double_ge(g.least, -1e-9 * held);
    ck_assert_double_eq_tol(g.gained + g.left, held, 2e-3 * held); // a thousandth that is left is lost
    ck_assert_double_eq_tol(g.momentum, 0, 1e-12);
}
END_TEST

// What is pushed keeps what it holds, and what its push takes is added; the others have theirs.
START_TEST(pushed_ones_wait) {
    const beads b = {.mass = {1, 1, 1, 1, 1, 1, 1e6}, .held = {0, 0, 0, 0, 0.5, 0.25}, .push = 2};
    const given g = release(&b);
    ck_assert_double_eq_tol(g.held[SLAVES - 1], 0.25 + 0.5 * 2 * 2, 1e-4);
    ck_assert_double_eq_tol(g.held[SLAVES - 2], 0, 1e-9);
    ck_assert_double_eq_tol(g.v[SLAVES - 2], 1, 1e-4);
}
END_TEST

// What is owed is paid before anything is given; and what is deep waits.
START_TEST(debts_and_depths) {
    beads b = {.mass = {1, 1, 1, 1, 1, 1, 1e6}, .held = {1, -0.4, 0, 0, 0, 0}};
    given g = release(&b);
    ck_assert_double_eq_tol(g.gained, 0.6, 1e-4);
    ck_assert_double_eq_tol(g.left, 0, 1e-4);
    b.gap = -2e-3, g = release(&b);
    ck_assert(g.gained == 0 && g.held[0] == 1 && g.held[1] == -0.4);
}
END_TEST

// What is held of one body is not given to another that comes near, and lost when that pushes; where that is not said
// it is anyone's, as of states that did not say.
START_TEST(of_one_body) {
    beads b = {.mass = {1, 1, 1, 1, 1, 1, 1e6}, .held = {1, 1, 1, 0, 0, 1}};
    const int32_t partner[SLAVES] = {1, 1, 1, 1, 1, 1}, of[SLAVES] = {1, 2, 0, 0, 0, _i ? 2 : 1};
    memcpy(b.partner, partner, sizeof partner), memcpy(b.of, of, sizeof of);
    b.push = 2;
    const given g = release(&b);
    ck_assert_double_eq_tol(g.held[0], 0, 1e-9);
    ck_assert_double_eq(g.held[1], 1);
    ck_assert_double_eq_tol(g.held[2], 0, 1e-9);
    ck_assert_double_eq_tol(g.v[0], sqrt(2), 1e-4);
    ck_assert_double_eq_tol(g.v[1], 0, 1e-4);
    ck_assert_double_eq_tol(g.v[2], sqrt(2), 1e-4);
    ck_assert_double_eq_tol(g.held[SLAVES - 1], (_i ? 0 : 1) + 0.5 * 2 * 2, 1e-4);
}
END_TEST

// A node between two bodies, at one touch: that of which it holds something gets all of it, also where the other is
// light.
START_TEST(two_masters) {
    brunt_constraint_set p = {.gives_back = true, .shallow = 1e-3, .leap = 1e9};
    brunt_impulse_account account[2] = {{.area = 0}};
    brunt_touch_energy touch = {.held = 1, .partner = 1};
    brunt_timer timer = {0};
    static const double mass[] = {1, 1e3, 1e-6};
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(brunt_constraints_dof_node(&p, NULL), i);
        for (int a = 0; a < 3; a++) p.dof_node[i].inverse[a] = 1 / mass[i];
    }
    for (int k = 0; k < 2; k++) {
        ck_assert_int_eq(brunt_constraints_add(&p, NULL), k);
        brunt_constraint *c = &p.constraint[k];
        c->n[1] = c->facet[1] = 1, c->account = &account[k], c->sign = 1, c->touch = &touch, c->partner = 1 + k;
        brunt_constraints_entry(&p, k, 1, NULL), brunt_constraints_entry(&p, 1 + k, -1, NULL);
    }
    ck_assert_int_eq(brunt_constraints_solve(&p, 64, 0, 1, &timer, NULL), BRUNT_OK);
    ck_assert_double_eq_tol(touch.held, 0, 1e-9);
    ck_assert_double_eq_tol(p.dof_node[0].v[1], sqrt(2 / 1.001), 1e-3);
    ck_assert_double_eq(p.dof_node[2].v[1], 0);
    brunt_constraints_free(&p);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("release");
    TCase *tests = tcase_create("release");
    tcase_add_loop_test(tests, one_gets_what_it_held, 0, 3);
    tcase_add_loop_test(tests, together_they_get_no_more, 0, 5);
    tcase_add_test(tests, pushed_ones_wait);
    tcase_add_test(tests, debts_and_depths);
    tcase_add_loop_test(tests, of_one_body, 0, 2);
    tcase_add_test(tests, two_masters);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
