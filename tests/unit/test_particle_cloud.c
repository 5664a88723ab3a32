// What bodies of material points have near a node of their grid (contact/distance): every particle whose kernel reaches
// the node and none twice, how far they extend, the gradient of their volume, and the distance of two such clouds.
#include "base/array.h"
#include "contact/distance/gjk.h"
#include "contact/distance/particle_extent.h"
#include "contact/distance/particle_vicinity.h"
#include "tests/support/def_world.h"
#include "tests/support/material_point.h"
#include "tests/support/numbers.h"
#include "world/world.h"

enum { TRIES = 100, POINTS = 40 };
static const double h = 0.1;

// ------------------------------------------------------------------------------------------ gathered from a grid

typedef struct form {
    int dim;
    brunt_kernel kernel;
    bool rings;
} form;
static const form forms[] = {{2, BRUNT_LINEAR, false},   {2, BRUNT_QUADRATIC, false}, {2, BRUNT_CUBIC, false},
                             {2, BRUNT_QUADRATIC, true}, {3, BRUNT_LINEAR, false},    {3, BRUNT_QUADRATIC, false},
                             {3, BRUNT_CUBIC, false}};

// A block of points off the lines of the grid, each sheared and stretched in its own way.
static brunt_world *make_block(form is, uint64_t *state) {
    brunt_world_def def = def_begin(is.dim, h);
    def.kernel = is.kernel, def.axisymmetric = is.rings;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY; // asks for what particles reach
    def_box(&def, "other", XYZ(2, 0.12, -0.11), XYZ(2.2, 0.3, is.dim == 3 ? 0.1 : 0))->spacing = 0.5 * h;
    def_box(&def, "block", XYZ(0.03, 0.12, -0.11), XYZ(0.63, 0.82, is.dim == 3 ? 0.39 : 0))->spacing = 0.5 * h;
    brunt_world *world = world_take(&def);
    brunt_particles *p = &world->bodies.mpm[0].particles;
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    for (int64_t s = 0; s < p->slots; s++)
        for (int r = 0; r < is.dim; r++)
            for (int c = 0; c < is.dim; c++)
                F[r * p->point_dim + c][s] += (real)(p->id[s] < 0 ? 0 : draw_between(state, -0.2, 0.2));
    return world;
}

static double weight(brunt_kernel kernel, double d) {
    const double a = fabs(d);
    if (kernel == BRUNT_LINEAR) return fmax(0, 1 - a);
    if (kernel == BRUNT_QUADRATIC) return a < 0.5 ? 0.75 - a * a : 0.5 * pow(fmax(0, 1.5 - a), 2);
    return a < 1 ? 2.0 / 3 + a * a * (0.5 * a - 1) : pow(fmax(0, 2 - a), 3) / 6;
}

// The volume fraction at a place, by all particles of the body.
static double fraction(brunt_body *body, form is, const double at[3]) {
    brunt_particles *p = &body->particles;
    double sum = 0;
    for (int64_t s = 0; s < p->slots; s++) {
        if (p->id[s] < 0) continue;
        double share = (double)brunt_plane_volume(p, s) / pow(h, is.dim);
        for (int a = 0; a < is.dim; a++)
            share *= weight(is.kernel, ((double)brunt_field(p, BRUNT_FIELD_position)[a][s] - at[a]) / h);
        sum += share;
    }
    return sum;
}

static double least_weight(brunt_body *body, form is, int64_t s, const double at[3]) {
    double least = 1;
    for (int a = 0; a < is.dim; a++)
        least = fmin(
            least, weight(is.kernel, ((double)brunt_field(&body->particles, BRUNT_FIELD_position)[a][s] - at[a]) / h));
    return least;
}

// What a node of a slot sees, of a vicinity for it alone.
// Keeps B, which stays where it is from, with the cloud.
static void keep_own(brunt_cloud *cloud) {
    double *own = cloud->data + BRUNT_ROW_B * cloud->stride;
    for (int i = 0; i < cloud->count; i++)
        for (size_t r = 0; r < 6; r++)
            own[r * cloud->stride + (size_t)i] = cloud->b[r * cloud->b_stride + (size_t)brunt_cloud_source(cloud, i)];
    cloud->b = own, cloud->b_stride = cloud->stride, cloud->runs = cloud->count > 0;
    cloud->run[0] = (brunt_run){0, 0}, cloud->run[1].from = cloud->count;
}

static void look(brunt_body *body, int32_t slot, int node, brunt_cloud *cloud) {
    brunt_vicinity vicinity = {.body = NULL};
    int local[3];
    brunt_node_local(&body->grid, node, local);
    const int nodes[2] = {local[body->grid.dim - 1], local[body->grid.dim - 1]};
    ck_assert_int_eq(brunt_vicinity_turn(&vicinity, body, slot, nodes, NULL), BRUNT_OK);
    ck_assert_int_eq(brunt_vicinity_look(&vicinity, node, cloud, NULL), BRUNT_OK);
    keep_own(cloud);
    brunt_vicinity_free(&vicinity);
}

// Particles that the node feels are in its runs, once each.
static void check_runs(brunt_body *body, form is, int32_t slot, int node, const double at[3]) {
    static int seen[1 << 16];
    brunt_slot_run runs[BRUNT_MAX_SLOT_RUNS];
    const brunt_particles *p = &body->particles;
    ck_assert_int_lt(p->slots, 1 << 16);
    memset(seen, 0, sizeof seen);
    const int count = brunt_extent_runs(body, slot, node, runs);
    for (int q = 0; q < count; q++)
        for (int64_t s = runs[q].first; s < runs[q].first + runs[q].count; s++) seen[s]++;
    for (int64_t s = 0; s < p->slots; s++) {
        ck_assert_int_le(seen[s], 1);
        if (p->id[s] >= 0 && least_weight(body, is, s, at) > 1e-6) ck_assert_int_eq(seen[s], 1);
    }
}

static void check_gradient(brunt_body *body, form is, const brunt_cloud *cloud, const double at[3]) {
    const double step = 1e-5 * h;
    double gradient[3];
    brunt_cloud_gradient(cloud, &body->grid, gradient);
    for (int a = 0; a < is.dim; a++) {
        double to[2][3];
        for (int side = 0; side < 2; side++) memcpy(to[side], at, sizeof to[side]), to[side][a] += side ? step : -step;
        const double slope = (fraction(body, is, to[1]) - fraction(body, is, to[0])) / (2 * step);
        // Linear kernels have a kink; no particle is as near to a line of the grid.
        ck_assert_double_eq_tol(gradient[a] * h, slope * h, TOLERANCE(1e-6, 1e-1));
    }
    for (int a = is.dim; a < 3; a++) ck_assert_double_eq(gradient[a], 0);
}

// No point of the balls' images goes farther, and one goes as far.
static void check_extents(brunt_body *body, const brunt_cloud *cloud, int32_t slot, int node, uint64_t *state) {
    brunt_particles *p = &body->particles;
    brunt_slot_run runs[BRUNT_MAX_SLOT_RUNS];
    double n[3] = {draw_between(state, -1, 1), draw_between(state, -1, 1),
                   p->dim == 3 ? draw_between(state, -1, 1) : 0};
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    double at[3], most[2] = {-INFINITY, -INFINITY}, end[3];
    for (int a = 0; a < 3; a++) n[a] /= length;
    brunt_node_position(&body->grid, body->grid.slots[slot].coord, node, at);
    const int count = brunt_extent_runs(body, slot, node, runs);
    for (int q = 0; q < count; q++)
        for (int64_t s = runs[q].first; s < runs[q].first + runs[q].count; s++) {
            double along = 0;
            for (int a = 0; a < p->dim; a++)
                along += ((double)brunt_field(p, BRUNT_FIELD_position)[a][s] - at[a]) * n[a];
            most[0] = fmax(most[0], along), most[1] = fmax(most[1], along + brunt_extent_along(body, s, n));
        }
    for (int share = 0; share <= 1; share++) {
        int which;
        const double extent = brunt_cloud_extent(cloud, share == 1, n, &which);
        if (!count) continue;
        brunt_cloud_end(cloud, which, share == 1, n, end);
        ck_assert_double_ge(most[1], most[0] + 0.1 * h);
        ck_assert_double_eq_tol(extent, most[share], TOLERANCE(1e-14, 1e-6));
        ck_assert_double_eq_tol(end[0] * n[0] + end[1] * n[1] + end[2] * n[2], extent, TOLERANCE(1e-14, 1e-6));
    }
}

static void draw_direction(int dim, uint64_t *state, double n[3]) {
    double length = 0;
    for (int a = 0; a < 3; a++) n[a] = a < dim ? draw_between(state, -1, 1) : 0, length += n[a] * n[a];
    for (int a = 0; a < 3; a++) n[a] /= sqrt(length);
}

// A cloud whose B stays in its vicinity has the ends of one that keeps its own, to the bit; balls to rounding of the
// same arithmetic.
static void check_ends(const brunt_cloud *cloud, const brunt_cloud *own, int dim, uint64_t *state) {
    for (int k = 0; k < 4 && cloud->count; k++) {
        double n[3], end[2][3];
        int which[2];
        draw_direction(dim, state, n);
        ck_assert_double_eq(brunt_cloud_extent(cloud, true, n, &which[0]), brunt_cloud_extent(own, true, n, &which[1]));
        ck_assert_int_eq(which[0], which[1]);
        const int some[2] = {which[0], draw_whole(state, cloud->count)};
        brunt_cloud_end(cloud, some[1], true, n, end[0]), brunt_cloud_end(own, some[1], true, n, end[1]);
        for (int a = 0; a < 3; a++) ck_assert_double_eq(end[0][a], end[1][a]);
        ck_assert_double_eq(brunt_cloud_ball_of(cloud, some, 2), brunt_cloud_ball_of(own, some, 2));
    }
    ck_assert(!cloud->count || brunt_cloud_ball(cloud) == brunt_cloud_ball(own));
}

START_TEST(a_cloud_is_what_the_node_feels) {
    uint64_t state = (uint64_t)_i + 7;
    const form is = forms[_i];
    brunt_world *world = make_block(is, &state);
    brunt_body *body = &world->bodies.mpm[0];
    brunt_cloud cloud = {.count = 0};
    int full = 0;
    for (int k = 0; k < TRIES; k++) {
        const int32_t slot = draw_whole(&state, body->grid.slot_count);
        const int node = draw_whole(&state, BRUNT_BLOCK_NODES);
        double at[3];
        brunt_node_position(&body->grid, body->grid.slots[slot].coord, node, at);
        look(body, slot, node, &cloud);
        check_runs(body, is, slot, node, at);
        check_extents(body, &cloud, slot, node, &state);
        if (fabs(fraction(body, is, at)) > 0) check_gradient(body, is, &cloud, at), full++;
    }
    ck_assert_int_gt(full, TRIES / 10);
    brunt_cloud_free(&cloud);
    brunt_world_destroy(world);
}
END_TEST

// Nodes that look one after the other see what each would alone, to the bit, and what number a particle has where the
// cloud is from leads back to it.
START_TEST(nodes_of_a_slot_see_what_each_would_alone) {
    uint64_t state = (uint64_t)_i + 3;
    brunt_world *world = make_block(forms[_i], &state);
    brunt_body *body = &world->bodies.mpm[0];
    brunt_particles *p = &body->particles;
    const brunt_block *last = &body->grid.blocks[body->grid.block_count - 1];
    const int64_t slots = p->slots;
    brunt_vicinity vicinity = {.body = NULL};
    brunt_cloud alone = {.count = 0}, cloud = alone;
    const int nodes[2] = {1, body->grid.side - 2};
    int seen = 0;
    for (int32_t slot = 0; slot < body->grid.slot_count; slot++) {
        ck_assert_int_eq(brunt_vicinity_turn(&vicinity, body, slot, nodes, NULL), BRUNT_OK);
        for (int k = 0; k < BRUNT_BLOCK_NODES; k++) {
            const int node = draw_whole(&state, BRUNT_BLOCK_NODES);
            int local[3];
            brunt_node_local(&body->grid, node, local);
            if (local[body->grid.dim - 1] < nodes[0] || local[body->grid.dim - 1] > nodes[1]) continue;
            p->slots = last->first + last->count; // nothing behind the last may be read
            look(body, slot, node, &alone);
            p->slots = slots;
            ck_assert_int_eq(brunt_vicinity_look(&vicinity, node, &cloud, NULL), BRUNT_OK);
            ck_assert_int_eq(cloud.count, alone.count);
            check_ends(&cloud, &alone, body->grid.dim, &state);
            for (int i = 0; i < cloud.count; i++) {
                const int own = brunt_cloud_source(&cloud, i), other = brunt_cloud_source(&alone, i);
                for (size_t r = 0; r < 6; r++)
                    ck_assert_double_eq(cloud.b[r * cloud.b_stride + (size_t)own],
                                        alone.b[r * alone.b_stride + (size_t)other]);
                for (size_t r = 0; r < BRUNT_ROWS; r += r == 2 ? BRUNT_ROW_VOLUME - 2 : 1)
                    ck_assert_double_eq(cloud.data[r * cloud.stride + (size_t)i],
                                        alone.data[r * alone.stride + (size_t)i]);
            }
            for (int i = 0; i < cloud.count; i++) {
                const int source = brunt_cloud_source(&cloud, i);
                ck_assert_int_eq(brunt_cloud_find(&cloud, source), i);
                ck_assert_double_eq_tol(vicinity.data[source] - cloud.data[i],
                                        vicinity.data[brunt_cloud_source(&cloud, 0)] - cloud.data[0],
                                        1e-12); // the node's place
            }
            int found = 0;
            for (int source = 0; source < (int)vicinity.stride; source++)
                found += brunt_cloud_find(&cloud, source) != BRUNT_NONE;
            ck_assert_int_eq(found, cloud.count);
            seen += cloud.count > 0;
        }
    }
    ck_assert_int_gt(seen, 30);
    brunt_cloud_free(&cloud), brunt_cloud_free(&alone), brunt_vicinity_free(&vicinity);
    brunt_world_destroy(world);
}
END_TEST

// Known corners to begin with, right or wrong, change nothing but the way.
static void check_corners(const brunt_cloud cloud[2], double d, uint64_t *state) {
    brunt_corners corners = {.count = 1 + draw_whole(state, 3)};
    for (int i = 0; i < corners.count; i++)
        corners.a[i] = draw_whole(state, POINTS), corners.b[i] = draw_whole(state, POINTS);
    double n[3];
    const double start[3] = {1};
    ck_assert_double_eq_tol(brunt_gjk_centres(&cloud[0], &cloud[1], h, start, n, &corners), d, 1e-7);
    if (d > 0) ck_assert_int_gt(corners.count, 0);
    ck_assert_double_eq_tol(brunt_gjk_centres(&cloud[0], &cloud[1], h, start, n, &corners), d, 1e-7);
}

// What is freed of stress keeps its place: a particle of volume 0 counts with that of its lattice.
START_TEST(what_is_freed_keeps_its_place) {
    uint64_t state = 3;
    for (int dim = 2; dim <= 3; dim++) {
        brunt_world *world = make_block((form){dim, BRUNT_QUADRATIC, false}, &state);
        brunt_body *body = &world->bodies.mpm[0];
        real *const *F = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
        for (int64_t s = 0; s < body->particles.slots; s++)
            for (int k = 0; k < dim * dim; k++) F[k][s] = k % (dim + 1) == 0;
        real *volume = brunt_field(&body->particles, BRUNT_FIELD_reference_volume)[0];
        brunt_cloud cloud[2] = {{.count = 0}};
        double gradient[2][3];
        for (int freed = 0; freed < 2; freed++) {
            body->keeps = freed;
            for (int64_t s = 0; freed && s < body->particles.slots; s++) volume[s] = 0;
            look(body, 0, BRUNT_BLOCK_NODES - 1, &cloud[freed]);
            brunt_cloud_gradient(&cloud[freed], &body->grid, gradient[freed]);
        }
        ck_assert_int_gt(cloud[0].count, 0);
        for (int a = 0; a < dim; a++)
            ck_assert_double_eq_tol(gradient[1][a], gradient[0][a], TOLERANCE(1e-10, 1e-3) / h);
        brunt_cloud_free(&cloud[0]), brunt_cloud_free(&cloud[1]);
        brunt_world_destroy(world);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ distance of two clouds

// Points in a ball of radius 1 about `at`.
static void fill(brunt_cloud *cloud, const double at[3], uint64_t *state) {
    ck_assert_int_eq(brunt_cloud_reserve(cloud, POINTS, NULL), BRUNT_OK);
    for (int i = 0; i < POINTS; i++) {
        double x[3], square = 0;
        for (int a = 0; a < 3; a++) x[a] = draw_between(state, -1, 1), square += x[a] * x[a];
        for (int a = 0; a < 3; a++) x[a] = at[a] + x[a] / fmax(1, sqrt(square));
        brunt_cloud_point(cloud, x);
    }
}

static double apart_along(const brunt_cloud *a, const brunt_cloud *b, bool reach, const double n[3]) {
    const double back[3] = {-n[0], -n[1], -n[2]};
    int which;
    return -brunt_cloud_extent(b, reach, back, &which) - brunt_cloud_extent(a, reach, n, &which);
}

// The distance is that along its direction, along no other are they farther apart, and swapped it is the same.
START_TEST(no_direction_parts_two_clouds_more) {
    uint64_t state = 11;
    const double origin[3] = {0};
    brunt_cloud cloud[2] = {{.count = 0}};
    int apart = 0, together = 0;
    for (int k = 0; k < 20 * TRIES; k++) {
        double at[3], n[3], m[3], start[3];
        for (int a = 0; a < 3; a++) at[a] = draw_between(&state, -2.2, 2.2), start[a] = draw_between(&state, -1, 1);
        fill(&cloud[0], origin, &state), fill(&cloud[1], at, &state);
        brunt_corners corners = {.count = 0}, turned = corners;
        const double d = brunt_gjk_centres(&cloud[0], &cloud[1], h, at, n, &corners);
        const double other = brunt_gjk_centres(&cloud[1], &cloud[0], h, start, m, &turned);
        ck_assert_double_eq_tol(d, other, 1e-7);
        check_corners(cloud, d, &state);
        if (d > 0) {
            ck_assert_double_eq_tol(apart_along(&cloud[0], &cloud[1], false, n), d, 1e-12);
            for (int a = 0; a < 3; a++) ck_assert_double_eq_tol(n[a], -m[a], 1e-3);
            apart++;
        } else {
            together++;
        }
        for (int q = 0; q < 30; q++) {
            draw_direction(3, &state, m);
            ck_assert_double_le(apart_along(&cloud[0], &cloud[1], false, m), d + 1e-7);
        }
    }
    ck_assert_int_gt(apart, TRIES);
    ck_assert_int_gt(together, TRIES);
    brunt_cloud_free(&cloud[0]), brunt_cloud_free(&cloud[1]);
}
END_TEST

// ------------------------------------------------------------------------------------------ of ellipsoids

// Particles about a random node near the face of a body at x = `face`.
static void gather_face(brunt_body *body, double face, uint64_t *state, brunt_cloud *cloud) {
    for (;;) {
        const int32_t slot = draw_whole(state, body->grid.slot_count);
        const int node = draw_whole(state, BRUNT_BLOCK_NODES);
        double at[3];
        brunt_node_position(&body->grid, body->grid.slots[slot].coord, node, at);
        if (fabs(at[0] - face) > 0.7 * h) continue;
        look(body, slot, node, cloud);
        if (cloud->count > 4) return;
    }
}

// Between what bounds the distance is, by the way of M. Frank and P. Wolfe: each step
// along the line to the point that goes farthest.
static void bound_distance(const brunt_cloud cloud[2], const double start[3], double bound[2]) {
    double v[3] = {start[0], start[1], start[2]};
    bound[0] = -INFINITY, bound[1] = INFINITY;
    for (int k = 0; k < 400; k++) {
        const double size = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (k) bound[1] = fmin(bound[1], size);
        if (!(size > 1e-12)) return;
        const double n[3] = {v[0] / size, v[1] / size, v[2] / size}, back[3] = {-n[0], -n[1], -n[2]};
        double end[2][3], along = 0, square = 0;
        for (int side = 0; side < 2; side++) {
            int which;
            brunt_cloud_extent(&cloud[side], true, side ? back : n, &which);
            brunt_cloud_end(&cloud[side], which, true, side ? back : n, end[side]);
        }
        bound[0] = fmax(bound[0], apart_along(&cloud[0], &cloud[1], true, n));
        for (int a = 0; a < 3; a++) {
            const double w = end[1][a] - end[0][a];
            along -= v[a] * (w - v[a]), square += (w - v[a]) * (w - v[a]);
            end[0][a] = w;
        }
        const double share = k ? fmin(1, fmax(0, along / square)) : 1;
        for (int a = 0; a < 3; a++) v[a] += share * (end[0][a] - v[a]);
    }
}

// Bodies whose faces are apart by a tenth of a cell, or overlap by that: the distance is between its bounds and that
// along its direction, none beside parts them more, and swapped it is the same.
START_TEST(ellipsoids_are_as_far_apart_as_any_direction_says) {
    uint64_t state = 5 + (uint64_t)_i;
    const int dim = 2 + _i;
    brunt_world *world = make_block((form){dim, BRUNT_QUADRATIC, false}, &state);
    brunt_body *block = &world->bodies.mpm[0], *other = &world->bodies.mpm[1];
    if (strcmp(block->name, "block")) block = &world->bodies.mpm[1], other = &world->bodies.mpm[0];
    brunt_cloud cloud[2] = {{.count = 0}};
    int apart = 0, together = 0;
    for (int k = 0; k < 10 * TRIES; k++) {
        const double start[3] = {1}, back[3] = {-1};
        double n[3], m[3], bound[2];
        gather_face(block, 0.63, &state, &cloud[0]), gather_face(other, 2, &state, &cloud[1]);
        const double by = draw_between(&state, -0.1, 0.1) * h - apart_along(&cloud[0], &cloud[1], true, start);
        for (int i = 0; i < cloud[1].count; i++) cloud[1].data[i] += by; // the first row: x
        brunt_corners corners = {.count = 0}, turned = corners;
        ck_assert(brunt_gjk_centres(&cloud[0], &cloud[1], h, start, n, &corners) > 0);
        ck_assert(brunt_gjk_centres(&cloud[1], &cloud[0], h, back, m, &turned) > 0);
        const double d = brunt_gjk_reaches(&cloud[0], &cloud[1], h, n, n, &corners),
                     swapped = brunt_gjk_reaches(&cloud[1], &cloud[0], h, m, m, &turned);
        ck_assert_double_eq_tol(d, swapped, 1e-7 * h);
        bound_distance(cloud, start, bound);
        ck_assert_double_ge(d, bound[0] - 1e-7 * h);
        ck_assert_double_le(d, bound[1] + 1e-7 * h);
        if (d > 0) ck_assert_double_eq_tol(apart_along(&cloud[0], &cloud[1], true, n), d, 1e-12 * h);
        apart += d > 0, together += d == 0;
    }
    ck_assert_int_gt(apart, TRIES);
    ck_assert_int_gt(together, TRIES);
    brunt_cloud_free(&cloud[0]), brunt_cloud_free(&cloud[1]);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("particle_cloud");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_loop_test(all, a_cloud_is_what_the_node_feels, 0, BRUNT_COUNT(forms));
    tcase_add_loop_test(all, nodes_of_a_slot_see_what_each_would_alone, 0, BRUNT_COUNT(forms));
    tcase_add_test(all, what_is_freed_keeps_its_place);
    tcase_add_test(all, no_direction_parts_two_clouds_more);
    tcase_add_loop_test(all, ellipsoids_are_as_far_apart_as_any_direction_says, 0, 2);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
