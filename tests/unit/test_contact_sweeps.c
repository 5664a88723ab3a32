// What ends the sweeps of contact: their greatest number (contact.iterations), and how little the last one corrected
// (contact.tolerance). Both must tell, alone, on what is left of the approach.
#include "tests/support/hard_world.h"
#include "contact/constraint/block.h"
#include "world/world.h"
#include "tests/support/suite.h"

#include <sys/resource.h>

// ------------------------------------------------------------------------------------------ points alone

enum { CHAIN = 24, LONG = 20000 };

// A row of beads that touch, the first against a wall, all on their way towards it: an impulse must travel through all
// of them, and every sweep takes it one bead on.
static void make_chain(brunt_constraint_set *p, brunt_impulse_account *account, int count) {
    memset(p, 0, sizeof *p);
    memset(account, 0, sizeof *account);
    for (int i = 0; i < count; i++) {
        ck_assert_int_eq(brunt_constraints_dof_node(p, NULL), i);
        brunt_dof_node *s = &p->dof_node[i];
        s->v[0] = s->old[0] = -1;
        for (int a = 0; a < 3; a++) s->inverse[a] = 1;
    }
    for (int i = 0; i < count; i++) {
        ck_assert_int_eq(brunt_constraints_add(p, NULL), i);
        brunt_constraint *point = &p->constraint[i];
        point->n[0] = point->facet[0] = 1;
        point->account = account, point->sign = 1;
        brunt_constraints_entry(p, i, 1, NULL);
        if (i > 0) brunt_constraints_entry(p, i - 1, -1, NULL);
    }
}

// Fastest approach that is left [m/s], after sweeps that took `*sweeps` of them.
static double approach_left(int most, double tolerance, int *sweeps) {
    brunt_constraint_set p;
    brunt_impulse_account account;
    brunt_timer timer = {0};
    make_chain(&p, &account, CHAIN);
    ck_assert_int_eq(brunt_constraints_solve(&p, most, tolerance, 1, &timer, NULL), BRUNT_OK);
    *sweeps = p.sweeps;
    double left = 0;
    for (int k = 0; k < p.constraint_count; k++) {
        double u[3];
        brunt_constraint_velocity(&p, &p.constraint[k], false, u);
        left = fmax(left, -u[0]);
    }
    brunt_constraints_free(&p);
    return left;
}

// A point that sticks `height` above the middle of a sliver of a triangle, a tenth as wide: what rubs it turns the
// sliver, by forces on its corners of twenty times its own. Sweeps that do not count those run away.
static void make_sliver(brunt_constraint_set *p, brunt_impulse_account *account, double height) {
    static const double weight[4] = {1, -0.25, -0.25, -0.5}, slope[4] = {0, -10, 10, 0}; // of weights, by x
    memset(p, 0, sizeof *p);
    memset(account, 0, sizeof *account);
    for (int i = 0; i < 4; i++) {
        ck_assert_int_eq(brunt_constraints_dof_node(p, NULL), i);
        for (int a = 0; a < 3; a++) p->dof_node[i].inverse[a] = 1;
    }
    p->dof_node[0].v[0] = p->dof_node[0].old[0] = 1, p->dof_node[0].v[2] = p->dof_node[0].old[2] = -1;
    ck_assert_int_eq(brunt_constraints_add(p, NULL), 0);
    brunt_constraint *point = &p->constraint[0];
    point->n[2] = point->facet[2] = 1, point->account = account, point->sign = 1;
    point->friction = 1, point->sticks = point->turns = true;
    for (int i = 0; i < 4; i++) {
        const int32_t at = brunt_constraints_entry(p, i, weight[i], NULL);
        p->entry[at].height_gradient[0] = height * slope[i];
    }
}

START_TEST(slivers_do_not_run_away) {
    for (int k = 0; k < 6; k++) {
        const double height = 0.01 * pow(2, k);
        brunt_constraint_set p;
        brunt_impulse_account account;
        brunt_timer timer = {0};
        double u[3], kinetic = 0, drift[3] = {-1, 0, 1};
        make_sliver(&p, &account, height);
        p.accelerated = k % 2;
        ck_assert_int_eq(brunt_constraints_solve(&p, 200, 1e-6, 1, &timer, NULL), BRUNT_OK);
        brunt_constraint_velocity(&p, &p.constraint[0], false, u);
        for (int i = 0; i < 4; i++)
            for (int a = 0; a < 3; a++)
                kinetic += 0.5 * p.dof_node[i].v[a] * p.dof_node[i].v[a], drift[a] += p.dof_node[i].v[a];
        printf("  a point %.2f above a sliver 0.1 wide: slips at %.1e, energy %.3f of 1, %d sweeps%s\n", height,
               hypot(u[0], u[1]), kinetic, p.sweeps, p.levers ? ", which count levers" : "");
        ck_assert_double_lt(hypot(u[0], u[1]), 1e-3);
        ck_assert_double_lt(fabs(u[2]), 1e-3);
        ck_assert_double_le(kinetic, 1);
        for (int a = 0; a < 3; a++) ck_assert_double_lt(fabs(drift[a]), 1e-12);
        ck_assert(p.levers == (k >= 3));
        brunt_constraints_free(&p);
    }
}
END_TEST

// Bead i carries point i, the first of its column, and point i + 1, which begins with its friction point where it has
// one: in the order of the points, however many groups of them are filled at once.
static void check_columns(const brunt_constraint_set *p, int rough) {
    for (int i = 0; i < p->dof_node_count; i++) {
        int32_t q = p->column_first[i];
        for (int k = i; k <= i + 1 && k < p->constraint_count; k++) {
            const double weight = k == i ? 1 : -1;
            ck_assert_int_eq(p->column[q].constraint, k);
            ck_assert(p->entry[p->column[q++].entry].weight[0] == weight);
            if (k % rough) continue;
            ck_assert_int_eq(p->column[q].constraint, k);
            ck_assert(p->entry[p->column[q++].entry].weight[0] == 0.5 * weight);
        }
        ck_assert_int_eq(p->column_first[i + 1], q);
    }
}

// A chain long enough for several groups of points, every third of which rubs at a point of its own.
static void solve_long_chain(int count, int threads, double *v) {
    enum { ROUGH = 3 };
    brunt_constraint_set p, rough = {0};
    brunt_impulse_account account;
    brunt_timer timer = {0};
    make_chain(&p, &account, count);
    for (int i = 0; i < count; i++) brunt_constraints_dof_node(&rough, NULL), rough.dof_node[i] = p.dof_node[i];
    for (int i = 0; i < count; i++) {
        brunt_constraints_add(&rough, NULL);
        brunt_constraint *point = &rough.constraint[i];
        const int32_t first = point->first;
        *point = p.constraint[i], point->first = first, point->count = 0, point->friction = 0.3;
        brunt_constraints_entry(&rough, i, 1, NULL);
        if (i > 0) brunt_constraints_entry(&rough, i - 1, -1, NULL);
        if (i % ROUGH) continue;
        const int32_t rubs = brunt_constraints_friction_point(&rough, (const double[3]){0}, NULL);
        for (int a = 0; a < 3; a++) {
            rough.entry[rubs].weight[a] = 0.5;
            if (i > 0) rough.entry[rubs + 1].weight[a] = -0.5;
        }
    }
    ck_assert_int_eq(brunt_constraints_solve(&rough, 4, 0, threads, &timer, NULL), BRUNT_OK);
    check_columns(&rough, ROUGH);
    for (int i = 0; i < count; i++) v[i] = rough.dof_node[i].v[0];
    brunt_constraints_free(&p);
    brunt_constraints_free(&rough);
}

START_TEST(columns_are_in_the_order_of_the_points) {
    static const int count[] = {1, 1023, 1024, 1025, 8192, 8193, LONG};
    static double one[LONG], three[LONG];
    for (size_t i = 0; i < sizeof count / sizeof count[0]; i++) {
        solve_long_chain(count[i], 1, one);
        solve_long_chain(count[i], 3, three);
        ck_assert_mem_eq(one, three, (size_t)count[i] * sizeof one[0]);
    }
}
END_TEST

// Nodes above a sheet of quadrilaterals, each on one of them and pressed against it at an angle; all share corners with
// their neighbours. `alone`: one in eight has a sixth entry, of weight 0, so that they are in no block.
enum { ROW = 9, ABOVE = 67, ABOVE_EACH = 16 };
static double some(int k) { return 0.5 + 0.5 * sin(7.3 * k + 1); }
static void make_sheet(brunt_constraint_set *p, brunt_impulse_account *account, double height, bool alone) {
    memset(p, 0, sizeof *p);
    memset(account, 0, sizeof *account);
    for (int i = 0; i < (ROW + 1) * (ROW + 1) + ABOVE; i++) {
        ck_assert_int_eq(brunt_constraints_dof_node(p, NULL), i);
        brunt_dof_node *s = &p->dof_node[i];
        const bool above = i >= (ROW + 1) * (ROW + 1);
        for (int a = 0; a < 3; a++)
            s->v[a] = s->old[a] = above ? (a == 2 ? -1 : 0.6) * some(3 * i + a) : 0, s->inverse[a] = 0.5 + some(i);
        if (i % 17 == 0) s->inverse[i % 3] = 0;
    }
    for (int k = 0; k < ABOVE; k++) {
        const int x = k % ROW, y = k / ROW % ROW, corner[4] = {0, 1, ROW + 2, ROW + 1};
        const double u = some(2 * k), v = some(5 * k), side[4][2] = {{1 - u, 1 - v}, {u, 1 - v}, {u, v}, {1 - u, v}};
        ck_assert_int_eq(brunt_constraints_add(p, NULL), k);
        brunt_constraint *point = &p->constraint[k];
        const double tilt = 0.2 * some(k), facet[3] = {sin(tilt), 0, cos(tilt)}, n[3] = {0, sin(tilt), cos(tilt)};
        memcpy(point->facet, facet, sizeof facet), memcpy(point->n, n, sizeof n);
        point->account = account, point->sign = 1, point->turns = true;
        point->friction = k % 5 ? (0.3 + 5 * height) * some(k) : 0, point->target = -0.05 * some(k);
        ck_assert_int_ge(brunt_constraints_entry(p, (ROW + 1) * (ROW + 1) + k, 1, NULL), 0);
        for (int c = 0; c < 4; c++) {
            const int32_t at =
                brunt_constraints_entry(p, y * (ROW + 1) + x + corner[c], -side[c][0] * side[c][1], NULL);
            p->entry[at].height_gradient[0] = height * (c == 1 || c == 2 ? 1 : -1) * side[c][1];
            p->entry[at].height_gradient[1] = height * (c > 1 ? 1 : -1) * side[c][0];
            p->entry[at].height_gradient[2] = -tilt * p->entry[at].height_gradient[0];
        }
        if (alone && k % 8 == 3) ck_assert_int_ge(brunt_constraints_entry(p, 0, 0, NULL), 0);
    }
}

static void check_same(const double *a, const double *b, int count, double size) {
    for (int i = 0; i < count; i++) ck_assert_msg(fabs(a[i] - b[i]) < 1e-12 * size, "%.17g, not %.17g", a[i], b[i]);
}

// What is in a block is pushed and rubbed as it is alone, up to heights at which sweeps have to count how facets turn.
START_TEST(blocks_do_as_one_alone) {
    static const double height[] = {0, 0.05, 0.3, 10};
    for (int k = 0; k < 8; k++) {
        brunt_constraint_set one, many;
        brunt_impulse_account account[2];
        brunt_timer timer = {0};
        int slips = 0, sticks = 0, lifts = 0;
        make_sheet(&one, &account[0], height[k / 2], true), make_sheet(&many, &account[1], height[k / 2], false);
        const int sweeps = k % 2 ? 200 : 6;
        ck_assert_int_eq(brunt_constraints_solve(&one, sweeps, 1e-4, 1, &timer, NULL), BRUNT_OK);
        ck_assert_int_eq(brunt_constraints_solve(&many, sweeps, 1e-4, 2, &timer, NULL), BRUNT_OK);
        ck_assert_int_eq(one.sweeps, many.sweeps);
        check_same(one.changed, many.changed, 1, 1);
        ck_assert(one.levers == many.levers && one.levers == (height[k / 2] > 1));
        for (int i = 0; i < one.dof_node_count; i++) {
            check_same(one.dof_node[i].v, many.dof_node[i].v, 3, 1);
            check_same(one.dof_node[i].impulse, many.dof_node[i].impulse, 3, 1);
        }
        for (int i = 0; i < ABOVE; i++) {
            const brunt_constraint *a = &one.constraint[i], *b = &many.constraint[i];
            check_same(&a->normal_impulse, &b->normal_impulse, 1, 1);
            check_same(a->friction_impulse, b->friction_impulse, 3, 1);
            check_same(&a->scale, &b->scale, 1, 1), check_same(&a->row_sum, &b->row_sum, 1, a->row_sum);
            check_same(&a->row_sum_t, &b->row_sum_t, 1, a->row_sum_t);
            ck_assert_int_eq(a->slips, b->slips);
            lifts += !(a->normal_impulse > 0), slips += a->slips;
            sticks += a->normal_impulse > 0 && a->friction > 0 && !a->slips;
        }
        printf("  %.2f above: %d sweeps, %d slip, %d stick, %d lift%s\n", height[k / 2], one.sweeps, slips, sticks,
               lifts, one.levers ? ", counting levers" : "");
        ck_assert(slips > 0 && sticks + lifts > 0);
        check_same(&account[0].friction_loss, &account[1].friction_loss, 1, 1);
        check_same(&account[0].normal_loss, &account[1].normal_loss, 1, 1);
        brunt_constraints_free(&one), brunt_constraints_free(&many);
    }
}
END_TEST

// Points above the facets of a sheet one after the other, so many chunks of them that several threads share them by
// rows of the sheet: what is above is of one part, and the nodes between two parts are shared. Every other point has
// taken something that is to be given back.
enum { MANY = 2 * ABOVE_EACH * ROW * ROW, SHEET = (ROW + 1) * (ROW + 1) };
static void make_crowd(brunt_constraint_set *p, brunt_impulse_account *account, brunt_touch_energy *touch) {
    memset(p, 0, sizeof *p), memset(account, 0, sizeof *account);
    for (int i = 0; i < SHEET + MANY; i++) {
        ck_assert_int_eq(brunt_constraints_dof_node(p, NULL), i);
        brunt_dof_node *s = &p->dof_node[i];
        for (int a = 0; a < 3; a++)
            s->v[a] = s->old[a] = i < SHEET ? 0.1 * some(a + i) : some(3 * i + a) - (a == 2), s->inverse[a] = some(i);
    }
    for (int k = 0; k < MANY; k++) {
        const int facet = (k + 2) / ABOVE_EACH % (ROW * ROW), x = facet % ROW,
                  y = facet / ROW; // blocks are of two, too
        const double u = some(2 * k), v = some(5 * k), side[4] = {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
        ck_assert_int_eq(brunt_constraints_add(p, NULL), k);
        brunt_constraint *point = &p->constraint[k];
        const double tilt = 0.2 * some(k), n[3] = {0, sin(tilt), cos(tilt)};
        memcpy(point->facet, n, sizeof n), memcpy(point->n, n, sizeof n);
        point->x[0] = 0.1 * x, point->x[1] = y, point->account = account, point->sign = 1, point->turns = true;
        point->friction = k % 5 ? 0.3 : 0, point->gap = 1;
        touch[k] = (brunt_touch_energy){.held = k % 2 ? 0.01 * some(k) : 0}, point->touch = &touch[k];
        ck_assert_int_ge(brunt_constraints_entry(p, SHEET + k, 1, NULL), 0);
        for (int c = 0; c < 4; c++) {
            const int corner = (y + c / 2) * (ROW + 1) + x + (c == 1 || c == 2);
            const int32_t at = brunt_constraints_entry(p, corner, -side[c], NULL);
            p->entry[at].height_gradient[0] = 0.01 * (some(c + k) - 0.5);
        }
    }
    p->gives_back = true, p->leap = 10, p->shallow = 1;
}

// What parts the points are in changes nothing, to the bit.
START_TEST(parts_change_no_sum) {
    static brunt_touch_energy touch[2][MANY];
    static const int threads[] = {2, 3, 5};
    for (size_t i = 0; i < sizeof threads / sizeof threads[0]; i++) {
        brunt_constraint_set one, many;
        brunt_impulse_account account[2];
        brunt_timer timer = {0};
        make_crowd(&one, &account[0], touch[0]), make_crowd(&many, &account[1], touch[1]);
        int shared = 0, lifts = 0;
        many.gives_back = i != 1; // what gives back ends with everything shared
        one.gives_back = i != 1;
        ck_assert_int_eq(brunt_constraints_solve(&one, 8, 1e-9, 1, &timer, NULL), BRUNT_OK);
        ck_assert_int_eq(brunt_constraints_solve(&many, 8, 1e-9, threads[i], &timer, NULL), BRUNT_OK);
        for (int s = 0; s < many.dof_node_count; s++) {
            shared += many.shared[s];
            ck_assert_mem_eq(one.dof_node[s].v, many.dof_node[s].v, sizeof one.dof_node[s].v);
            ck_assert_mem_eq(one.dof_node[s].impulse, many.dof_node[s].impulse, sizeof one.dof_node[s].impulse);
        }
        for (int k = 0; k < MANY; k++) {
            lifts += !(one.constraint[k].normal_impulse > 0);
            ck_assert(one.constraint[k].normal_impulse == many.constraint[k].normal_impulse);
            ck_assert(one.constraint[k].row_sum == many.constraint[k].row_sum);
            ck_assert(touch[0][k].held == touch[1][k].held);
        }
        printf("  %d threads: %d parts, %d of %d nodes of the sheet shared\n", threads[i], many.parts, shared, SHEET);
        if (i == 1) ck_assert(many.parts == threads[i] && shared > ROW && shared < SHEET);
        ck_assert(lifts > 0);
        ck_assert_mem_eq(account[0].impulse, account[1].impulse, sizeof account[0].impulse);
        brunt_constraints_free(&one), brunt_constraints_free(&many);
    }
}
END_TEST

// The most that another sweep would correct a point that rests [m/s], and how many rest: in blocks and alone.
static double left_at_rest(const brunt_constraint_set *p, int *rest) {
    double most = 0;
    for (int k = 0; k < p->constraint_count; k++) {
        const brunt_constraint *point = &p->constraint[k];
        const brunt_constraint_block *block = &p->block[k / BRUNT_DOUBLES];
        if (!(block->count ? p->rests[k / BRUNT_DOUBLES * BRUNT_DOUBLES] : p->rests[k])) continue;
        double u[3], unit = point->scale / point->row_sum;
        brunt_constraint_velocity(p, point, false, u);
        const double along = u[0] * point->n[0] + u[1] * point->n[1] + u[2] * point->n[2],
                     now = fmax(0, point->normal_impulse + (point->target - along) * unit);
        most = fmax(most, fabs(now - point->normal_impulse) / unit), ++*rest;
    }
    return most;
}

// A copy of a set that is not solved yet. `alone`: one point in eight has a sixth entry, so that they are in no block.
static void copy_set(const brunt_constraint_set *from, bool alone, brunt_constraint_set *p) {
    memset(p, 0, sizeof *p);
    for (int i = 0; i < from->dof_node_count; i++)
        brunt_constraints_dof_node(p, NULL), p->dof_node[i] = from->dof_node[i];
    for (int i = 0; i < from->constraint_count; i++) {
        brunt_constraints_add(p, NULL), p->constraint[i] = from->constraint[i];
        p->constraint[i].first = p->entry_count, p->constraint[i].count = 0;
        for (int e = 0; e < from->constraint[i].count; e++) {
            const brunt_constraint_entry *entry = &from->entry[from->constraint[i].first + e];
            const int32_t at = brunt_constraints_entry(p, entry->dof_node, 0, NULL);
            p->entry[at] = *entry;
        }
        if (alone && i % 8 == 3) brunt_constraints_entry(p, 0, 0, NULL);
    }
}

static double greatest_approach(const brunt_constraint_set *p) {
    double most = 0;
    for (int k = 0; k < p->constraint_count; k++) {
        double u[3];
        brunt_constraint_velocity(p, &p->constraint[k], false, u);
        for (int a = 0; a < 3; a++) u[a] *= p->constraint[k].n[a];
        most = fmax(most, -u[0] - u[1] - u[2]);
    }
    return most;
}

// What rests is left out while sweeps go on elsewhere, but not what drifts: it is at its condition as well as what ends
// the sweeps says, ten times over, wherever impulses arrive late and slowly, and whoever sweeps over it.
START_TEST(what_rests_is_at_its_condition) {
    static brunt_touch_energy touch[MANY];
    for (int k = 0; k < 6; k++) {
        const double tolerance = k % 2 ? 0.1 : 0.03;
        brunt_constraint_set p, one, many;
        brunt_impulse_account account;
        brunt_timer timer = {0};
        int rest = 0, all = 0;
        double most = 0;
        if (k < 2) {
            make_chain(&p, &account, 600);
            for (int i = 0; i < 600; i++) p.dof_node[i].v[0] = i < 300 ? -some(i) : i < 302 ? -2 : 0;
        } else {
            make_crowd(&p, &account, touch), p.gives_back = false;
            for (int i = 0; i < SHEET + MANY; i++) p.dof_node[i].v[2] *= i % 97 ? 0.01 : 5;
        }
        for (int sweeps = 4; sweeps <= 512; sweeps *= 2) {
            copy_set(&p, k > 3, &one), copy_set(&p, k > 3, &many);
            ck_assert_int_eq(brunt_constraints_solve(&one, sweeps, tolerance, 1, &timer, NULL), BRUNT_OK);
            ck_assert_int_eq(brunt_constraints_solve(&many, sweeps, tolerance, 3, &timer, NULL), BRUNT_OK);
            for (int i = 0; i < p.dof_node_count; i++)
                ck_assert_mem_eq(one.dof_node[i].v, many.dof_node[i].v, sizeof one.dof_node[i].v);
            most = fmax(most, left_at_rest(&many, &rest) / (tolerance * greatest_approach(&p)));
            all += many.constraint_count;
            brunt_constraints_free(&one), brunt_constraints_free(&many);
        }
        printf("  %d of %d points rest, corrected by at most %.1e of what ends the sweeps\n", rest, all, most);
        ck_assert_int_gt(rest, all / 10);
        ck_assert_double_lt(most, 0.1);
        brunt_constraints_free(&p);
    }
}
END_TEST

// A set whose entries are in the lanes of its blocks, all or `some` of them: nowhere else is what they are.
static void put_in_lanes(brunt_constraint_set *p, bool some) {
    ck_assert_int_eq(brunt_constraints_open_blocks(p, NULL), BRUNT_OK);
    for (int k = 0; k < p->constraint_count; k++) {
        const brunt_constraint *c = &p->constraint[k];
        if (c->count > BRUNT_LANE_ENTRIES || (some && k / 8 % 3 == 1 && k % 8 == 5)) continue;
        brunt_constraints_lane(p, k, &p->entry[c->first]);
        memset(&p->entry[c->first], 0x7f, (size_t)c->count * sizeof *p->entry);
        if (k % 40 == 39) brunt_constraints_fill_blocks(p, k - 39 + 4, k + 1); // the rest when it is solved
    }
}

// Solves a crowd, and makes it anew in its place: what one step leaves behind is nothing to the next.
static void solve_before(brunt_constraint_set *p, brunt_impulse_account *account, brunt_touch_energy *touch) {
    brunt_timer timer = {0};
    ck_assert_int_eq(brunt_constraints_solve(p, 8, 1e-9, 1, &timer, NULL), BRUNT_OK);
    brunt_constraint_set anew;
    make_crowd(&anew, account, touch);
    memcpy(p->constraint, anew.constraint, (size_t)p->constraint_count * sizeof *p->constraint);
    memcpy(p->entry, anew.entry, (size_t)p->entry_count * sizeof *p->entry);
    memcpy(p->dof_node, anew.dof_node, (size_t)p->dof_node_count * sizeof *p->dof_node);
    brunt_constraints_free(&anew);
}

// Where entries are changes nothing: whatever part of a block is in lanes, and whether kicks go over single points.
START_TEST(lanes_do_as_entries) {
    static brunt_touch_energy touch[2][MANY];
    for (int k = 0; k < 16; k++) {
        brunt_constraint_set one, lane;
        brunt_impulse_account account[2];
        brunt_timer timer = {0};
        make_crowd(&one, &account[0], touch[0]), make_crowd(&lane, &account[1], touch[1]);
        one.gives_back = lane.gives_back = k & 1;
        if (k == 1) solve_before(&lane, &account[1], touch[1]);
        for (int i = 0; i < MANY; i++) one.constraint[i].target = lane.constraint[i].target = 0.1 * some(i);
        // In some blocks one point has fewer entries.
        for (int i = 0; i < MANY && k & 8; i += 24) one.constraint[i].count = lane.constraint[i].count = 4;
        put_in_lanes(&lane, k & 2);
        const int threads = k & 4 ? 3 : 1;
        ck_assert_int_eq(brunt_constraints_solve(&one, 8, 1e-9, threads, &timer, NULL), BRUNT_OK);
        ck_assert_int_eq(brunt_constraints_solve(&lane, 8, 1e-9, threads, &timer, NULL), BRUNT_OK);
        brunt_constraints_validate(&lane);
        for (int s = 0; s < one.dof_node_count; s++)
            ck_assert_mem_eq(one.dof_node[s].v, lane.dof_node[s].v, sizeof one.dof_node[s].v);
        for (int i = 0; i < MANY; i++) ck_assert(touch[0][i].held == touch[1][i].held);
        ck_assert_mem_eq(&account[0], &account[1], sizeof account[0]);
        brunt_constraints_free(&one), brunt_constraints_free(&lane);
    }
}
END_TEST

// However many accounts the points have, one after the other, all get what is theirs, the same for any number of
// threads.
START_TEST(each_account_gets_what_is_its_own) {
    static brunt_touch_energy touch[MANY];
    enum { MOST = 9 };
    for (int many = 1; many <= MOST; many++) {
        brunt_impulse_account account[2][MOST] = {{{.area = 0}}};
        double areas[MOST] = {0}, pushed[MOST] = {0};
        for (int i = 0; i < 2; i++) {
            brunt_constraint_set p;
            brunt_impulse_account all;
            brunt_timer timer = {0};
            make_crowd(&p, &all, touch), p.gives_back = false;
            for (int k = 0; k < MANY; k++)
                p.constraint[k].account = &account[i][k / (1 + many % 3) % many], p.constraint[k].area = some(k);
            ck_assert_int_eq(brunt_constraints_solve(&p, 8, 1e-9, i ? 3 : 1, &timer, NULL), BRUNT_OK);
            for (int k = 0; k < MANY && !i; k++) {
                const brunt_constraint *c = &p.constraint[k];
                if (!(c->normal_impulse > 0)) continue;
                areas[c->account - account[0]] += c->area;
                pushed[c->account - account[0]] += c->normal_impulse * c->n[2] + c->friction_impulse[2];
            }
            brunt_constraints_free(&p);
        }
        ck_assert_mem_eq(account[0], account[1], sizeof account[0]);
        for (int k = 0; k < many; k++) {
            ck_assert(areas[k] > 0);
            ck_assert_double_eq_tol(account[0][k].area, areas[k], 1e-12 * areas[k]);
            ck_assert_double_eq_tol(account[0][k].impulse[2], pushed[k], 1e-12 * pushed[k]);
        }
    }
}
END_TEST

// A push takes what came before the forces of the step, not what they bring: what only presses takes rounding alone.
START_TEST(what_presses_holds_nothing) {
    static const double came[] = {1, 0.1, 1e-6, 1e-15, 0};
    for (int k = 0; k < 5; k++) {
        brunt_constraint_set p = {.gives_back = true, .leap = 10, .shallow = 1};
        brunt_impulse_account account = {.area = 0};
        brunt_touch_energy touch = {.held = 0};
        brunt_timer timer = {0};
        ck_assert_int_eq(brunt_constraints_dof_node(&p, NULL), 0);
        p.dof_node[0].v[2] = -1, p.dof_node[0].old[2] = -came[k];
        for (int a = 0; a < 3; a++) p.dof_node[0].inverse[a] = 1;
        ck_assert_int_eq(brunt_constraints_add(&p, NULL), 0);
        p.constraint[0].n[2] = 1, p.constraint[0].account = &account, p.constraint[0].touch = &touch;
        p.constraint[0].sign = 1;
        ck_assert_int_eq(brunt_constraints_entry(&p, 0, 1, NULL), 0);
        ck_assert_int_eq(brunt_constraints_solve(&p, 8, 1e-9, 1, &timer, NULL), BRUNT_OK);
        ck_assert_double_eq_tol(p.constraint[0].normal_impulse, 1, 1e-14);
        ck_assert_double_eq_tol(touch.held, came[k] > 1e-3 ? 0.5 * came[k] : 0, 1e-12);
        brunt_constraints_free(&p);
    }
}
END_TEST

// Points that turn what they push on, by levers, each with a mass of its own. `alone`: all have four more entries, of
// weight 0, so that they are in no block whatever they push on.
static void make_turned(brunt_constraint_set *p, brunt_impulse_account *account, bool alone) {
    enum { COUNT = 16 };
    memset(p, 0, sizeof *p), memset(account, 0, sizeof *account);
    for (int i = 0; i < COUNT + 1; i++) {
        ck_assert_int_eq(brunt_constraints_dof_node(p, NULL), i);
        for (int a = 0; a < 3; a++) p->dof_node[i].inverse[a] = i ? 1 : a == 0 ? 5 : 0;
        p->dof_node[i].v[2] = p->dof_node[i].old[2] = i ? -some(i) : 0;
    }
    p->dof_node[0].angular = true;
    for (int k = 0; k < COUNT; k++) {
        brunt_constraint *point;
        ck_assert_int_eq(brunt_constraints_add(p, NULL), k);
        point = &p->constraint[k];
        point->n[2] = point->facet[0] = 1, point->account = account, point->sign = 1, point->turns = true;
        ck_assert_int_ge(brunt_constraints_entry(p, k + 1, 1, NULL), 0);
        const int32_t lever = brunt_constraints_entry(p, 0, 0, NULL);
        p->entry[lever].height_gradient[2] = 0.5 - some(3 * k);
        for (int e = 0; e < 4 && alone; e++) ck_assert_int_ge(brunt_constraints_entry(p, k + 1, 0, NULL), 0);
    }
}

START_TEST(levers_are_in_no_block) {
    brunt_constraint_set one, many;
    brunt_impulse_account account[2];
    brunt_timer timer = {0};
    make_turned(&one, &account[0], true), make_turned(&many, &account[1], false);
    ck_assert_int_eq(brunt_constraints_solve(&one, 50, 1e-6, 1, &timer, NULL), BRUNT_OK);
    ck_assert_int_eq(brunt_constraints_solve(&many, 50, 1e-6, 1, &timer, NULL), BRUNT_OK);
    ck_assert(many.dof_node[0].v[0] != 0);
    for (int k = 0; k < many.constraint_count; k++)
        check_same(&one.constraint[k].row_sum, &many.constraint[k].row_sum, 1, many.constraint[k].row_sum);
    for (int i = 0; i < many.dof_node_count; i++) check_same(one.dof_node[i].v, many.dof_node[i].v, 3, 1);
    brunt_constraints_free(&one), brunt_constraints_free(&many);
}
END_TEST

// The address sanitizer ends a program that asks for too much unless it is told to give nothing.
__attribute__((visibility("default"))) const char *__asan_default_options(void);
const char *__asan_default_options(void) { return "allocator_may_return_null=1"; }

// Where memory ends, contact says what of it there was no room for; what there was is as it was.
START_TEST(no_memory_is_told) {
    brunt_constraint_set p = {0};
    brunt_error error = {.id = -1};
    ck_assert_int_eq(brunt_constraints_add(&p, &error), 0);
    ck_assert_int_eq(error.code, BRUNT_OK);
    struct rlimit old, little;
    getrlimit(RLIMIT_AS, &old);
    little = (struct rlimit){(rlim_t)1 << 35, old.rlim_max}; // half a terabyte is asked for
    ck_assert_int_eq(setrlimit(RLIMIT_AS, &little), 0);
    const int status = brunt_constraints_reserve(&p, INT32_MAX - 1, 1, 1, &error);
    setrlimit(RLIMIT_AS, &old);
    ck_assert_int_eq(status, BRUNT_FAILED);
    ck_assert_int_eq(error.code, BRUNT_FAILED);
    ck_assert_msg(strstr(error.message, "no room for 2147483647 contact points"), "%s", error.message);
    ck_assert_int_eq(p.constraint_count, 1);
    brunt_constraints_free(&p);
}
END_TEST

enum { PLAIN = 30, PLAIN_NODES = 12 };

// Points of which most rub with other weights than they push with; `tilt`: of their normals, by as many different ones.
static void solve_plain(bool turns, double tilt, double v[PLAIN_NODES][3]) {
    brunt_constraint_set p = {0};
    brunt_impulse_account account = {.area = 0};
    brunt_timer timer = {0};
    for (int i = 0; i < PLAIN_NODES; i++) {
        ck_assert_int_eq(brunt_constraints_dof_node(&p, NULL), i);
        for (int a = 0; a < 3; a++) {
            p.dof_node[i].v[a] = p.dof_node[i].old[a] = some(3 * i + a) - (a == 2);
            p.dof_node[i].inverse[a] = 1 + some(i + 5 * a);
        }
    }
    for (int k = 0; k < PLAIN; k++) {
        ck_assert_int_eq(brunt_constraints_add(&p, NULL), k);
        brunt_constraint *point = &p.constraint[k];
        point->n[0] = tilt * k, point->n[2] = 1, point->facet[2] = 1, point->friction = 0.4, point->turns = turns;
        point->account = &account, point->sign = 1;
        for (int e = 0; e < 3; e++) brunt_constraints_entry(&p, (k + 5 * e) % PLAIN_NODES, some(k + e), NULL);
        if (k % 3 == 0) continue;
        const int32_t rubs = brunt_constraints_friction_point(&p, (const double[3]){0}, NULL);
        for (int e = 0; e < 3; e++)
            for (int a = 0; a < 3; a++) p.entry[rubs + e].weight[a] = some(7 * k + e);
    }
    ck_assert_int_eq(brunt_constraints_solve(&p, 8, 1e-9, 1, &timer, NULL), BRUNT_OK);
    for (int i = 0; i < PLAIN_NODES; i++) memcpy(v[i], p.dof_node[i].v, sizeof v[i]);
    ck_assert_double_gt(account.friction_loss, 0.01);
    brunt_constraints_free(&p);
}

static double most_between(double v[2][PLAIN_NODES][3]) {
    double most = 0;
    for (int i = 0; i < PLAIN_NODES; i++)
        for (int a = 0; a < 3; a++) most = fmax(most, fabs(v[0][i][a] - v[1][i][a]));
    return most;
}

// What does not turn gives by fewer operations what it gives with facets that could turn, and do not: at its friction
// point, too, whose weights are others.
START_TEST(what_does_not_turn_gives_the_same) {
    double v[2][PLAIN_NODES][3];
    for (int turns = 0; turns < 2; turns++) solve_plain(turns, 0, v[turns]);
    printf("  velocities differ by %.1e m/s\n", most_between(v));
    ck_assert_double_lt(most_between(v), 1e-13);
}
END_TEST

// Normals that are the same but for rounding are the same: sweeps that end early leave no more of it than it is.
START_TEST(normals_that_differ_by_rounding_are_the_same) {
    static const double tilt[] = {1e-16, 1e-13, 1e-3}, least[] = {0, 0, 1e-6}, greatest[] = {1e-13, 1e-10, 1};
    double v[2][PLAIN_NODES][3];
    solve_plain(false, 0, v[0]);
    for (int k = 0; k < 3; k++) {
        solve_plain(false, tilt[k], v[1]);
        printf("  normals to %.0e: velocities differ by %.1e m/s\n", tilt[k], most_between(v));
        ck_assert_double_ge(most_between(v), least[k]);
        ck_assert_double_lt(most_between(v), greatest[k]);
    }
}
END_TEST

START_TEST(more_sweeps_leave_less) {
    int sweeps;
    double last = INFINITY;
    for (int most = 4; most <= 1024; most *= 4) {
        const double left = approach_left(most, 0, &sweeps);
        ck_assert_int_le(sweeps, most);
        printf("%4d sweeps: %.3e m/s of approach left\n", sweeps, left);
        ck_assert_msg(left < 0.9 * last, "%d sweeps leave %g m/s, fewer left %g", most, left, last);
        last = left;
    }
}
END_TEST

START_TEST(a_tighter_tolerance_leaves_less) {
    int sweeps, before = 0;
    double last = INFINITY;
    for (double tolerance = 0.3; tolerance > 1e-5; tolerance *= 0.1) {
        const double left = approach_left(100000, tolerance, &sweeps);
        printf("tolerance %.0e: %4d sweeps, %.3e m/s of approach left\n", tolerance, sweeps, left);
        ck_assert_msg(left < 0.5 * last, "tolerance %g leaves %g m/s, a greater one %g", tolerance, left, last);
        ck_assert_int_gt(sweeps, before);
        last = left, before = sweeps;
    }
}
END_TEST

// Either alone holds the other up: sweeps that may be many end by the tolerance, a tight tolerance by the sweeps.
START_TEST(whichever_comes_first_ends_them) {
    int few, many, tight;
    approach_left(40, 0.3, &few);
    approach_left(1000, 0.3, &many);
    ck_assert_int_eq(few, many);
    ck_assert_int_lt(few, 40);
    approach_left(16, 1e-9, &tight);
    ck_assert_int_eq(tight, 16);
}
END_TEST

// ------------------------------------------------------------------------------------------ a world

enum { NODES = 4096 };

// Velocities after one step of five blocks in a row that touch, with edges that do not match, of which the outer two
// are thrown at the others.
static int velocities(int iterations, double tolerance, real *out) {
    static const char *const names[] = {"a", "b", "c", "d", "e"};
    brunt_world_def def = def_begin(2, 1);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.iterations = iterations, def.contact.tolerance = tolerance;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    for (int i = 0; i < 5; i++) {
        brunt_body_def *b = def_box(&def, names[i], XYZ(0.1 * i, 0, 0), XYZ(0.1 * (i + 1), 1, 0));
        b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = i % 2 ? 0.1 : 0.07;
        def_velocity(b, i == 0 ? 3 : i == 4 ? -3 : 0, 0, 0);
    }
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    int count = 0;
    for (int32_t k = 0; k < brunt_body_count(world); k++) {
        const int32_t field = brunt_body_find_field(world, k, "velocity");
        double *v = malloc((size_t)brunt_body_nodes(world, k) * 3 * sizeof *v);
        brunt_body_read(world, k, field, v);
        for (int64_t i = 0; i < 3 * brunt_body_nodes(world, k) && count < NODES; i++) out[count++] = (real)v[i];
        free(v);
    }
    brunt_world_destroy(world);
    return count;
}

static double far_from_solved(int iterations, double tolerance) {
    static real solved[NODES], now[NODES];
    const int count = velocities(20000, 0, solved);
    ck_assert_int_eq(count, velocities(iterations, tolerance, now));
    double far = 0;
    for (int i = 0; i < count; i++) far = fmax(far, fabs((double)(now[i] - solved[i])));
    printf("%d sweeps at most, tolerance %g: %.3e m/s from the solution\n", iterations, tolerance, far);
    return far;
}

// More than the 16 that there are by default, and less than the hundredth.
START_TEST(a_world_takes_both) {
    const double fewer = far_from_solved(16, 1e-6), more = far_from_solved(64, 1e-6);
    ck_assert_msg(more < 0.7 * fewer, "64 sweeps end %g m/s from the solution, 16 end %g", more, fewer);
    const double plain = far_from_solved(1000, 0.01), tight = far_from_solved(1000, 1e-3),
                 tighter = far_from_solved(1000, 1e-4);
    ck_assert_msg(tight < 0.5 * plain && tighter < 0.5 * tight, "tolerances 0.01, 1e-3, 1e-4: %g, %g, %g m/s", plain,
                  tight, tighter);
}
END_TEST

// Blocks that touch and fly on together come nearer by rounding alone, which is not swept out; where one of them comes
// by more than that, however slow, all of it is.
START_TEST(rounding_is_not_swept_out) {
    const double comes[] = {0, sizeof(real) == 4 ? 1e-3 : 1e-6}; // [m/s]
    int sweeps[2] = {0, 0};
    for (int k = 0; k < 2; k++) {
        brunt_world_def def = def_begin(3, 1);
        def.contact.method = BRUNT_CONTACT_AUGURY, def.contact.friction = 0.3;
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        for (int i = 0; i < 2; i++) {
            brunt_body_def *b = def_box(&def, i ? "b" : "a", XYZ(0, 0, 0.3 * i), XYZ(1, 1, 0.3 * (i + 1)));
            b->method = BRUNT_FEM, b->element = BRUNT_HEX8, b->size = i ? 0.1 : 0.125;
            def_velocity(b, 3, 2, i ? 7 - comes[k] : 7);
        }
        brunt_world *world = world_take(&def);
        for (int step = 0; step < 20; step++) {
            world_steps(world, 1);
            sweeps[k] += world->contact.constraints.sweeps;
            if (!k) ck_assert_int_gt(world->contact.constraints.constraint_count, 100);
        }
        printf("comes at %g m/s: %d sweeps in 20 steps\n", comes[k], sweeps[k]);
        brunt_world_destroy(world);
    }
    ck_assert_int_le(sweeps[0], sizeof(real) == 4 ? 40 : 20); // single precision rounds by a little more now and then
    ck_assert_int_gt(sweeps[1], 2 * sweeps[0]);
}
END_TEST

START_TEST(a_tolerance_out_of_range_is_refused) {
    static const double bad[] = {-0.01, 1, 2, NAN, INFINITY};
    for (int i = 0; i < 5; i++) {
        brunt_world_def def = def_begin(2, 1);
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        def_box(&def, "a", XYZ(0, 0, 0), XYZ(1, 1, 0));
        def.contact.tolerance = bad[i];
        brunt_error error = {0};
        ck_assert_ptr_null(brunt_world_create(&def, &error));
        ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, "contact.tolerance"), "%s", error.message);
        brunt_world_def_free(&def);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("contact sweeps");
    ADD(more_sweeps_leave_less);
    ADD(no_memory_is_told);
    ADD(columns_are_in_the_order_of_the_points);
    ADD(parts_change_no_sum);
    ADD(what_does_not_turn_gives_the_same);
    ADD(normals_that_differ_by_rounding_are_the_same);
    ADD(lanes_do_as_entries);
    ADD(what_presses_holds_nothing);
    ADD(each_account_gets_what_is_its_own);
    ADD(what_rests_is_at_its_condition);
    ADD(levers_are_in_no_block);
    ADD(slivers_do_not_run_away);
    ADD(blocks_do_as_one_alone);
    ADD(a_tighter_tolerance_leaves_less);
    ADD(whichever_comes_first_ends_them);
    ADD(a_world_takes_both);
    ADD(rounding_is_not_swept_out);
    ADD(a_tolerance_out_of_range_is_refused);
    return suite_main(suite);
}
