// Bodies of material points that come to a wall: in the step that would take them past it the approach ends with the
// surface of what is first on the wall, gap 0. What lies in a particle is a ball of half the spacing, deformed by F:
// along a normal n it reaches s/2 |F^T n|. The bodies are all but free of stress and move as they were thrown.
#include "tests/support/def_world.h"

typedef struct approach {
    int dimension;
    bool total;           // total Lagrangian
    double stretch[3];    // [m/s] of the velocity that grows along ...
    double along[3];      // ... this direction, per metre
    double normal[3];     // of the wall, into the room
    double wall, towards; // [m/s] of the wall along its normal, of the body against it
} approach;

static const double CELL = 0.25, SIDE = 1, AWAY = 1.6, SPACING = 0.125, STEP = 0.004;

static brunt_world *thrown(const approach *a) {
    const double wave = 1e-4; // [1/m] of a sine so long that over the body it is a straight line
    brunt_world_def def = def_begin(a->dimension, CELL);
    def.step = STEP;
    def_material(&def, "neo-hookean", 1, 1e-9, 0);
    brunt_body_def *body =
        def_box(&def, "block", XYZ(-SIDE / 2, -SIDE / 2, -SIDE / 2), XYZ(SIDE / 2, SIDE / 2, SIDE / 2));
    body->total_lagrangian = a->total;
    double point[3];
    for (int i = 0; i < 3; i++) {
        body->velocity[i] = -a->towards * a->normal[i];
        body->wave_velocity[i] = a->stretch[i] / wave, body->wave_vector[i] = wave * a->along[i];
        point[i] = -AWAY * a->normal[i];
    }
    brunt_plane_def *plane = def_plane(&def, point, a->normal, BRUNT_SEPARATE, 0);
    for (int i = 0; i < 3; i++) plane->velocity[i] = a->wall * a->normal[i];
    return world_take(&def);
}

// |F^T n| of particle i.
static double reach(const double *F, int64_t i, const double n[3]) {
    double square = 0;
    for (int c = 0; c < 3; c++) {
        double t = 0;
        for (int r = 0; r < 3; r++) t += F[9 * i + 3 * r + c] * n[r];
        square += t * t;
    }
    return sqrt(square);
}

// From the wall to the nearest surface of a particle that is deformed by F.
static double nearest(brunt_world *world, const approach *a, const double *F) {
    double *x = world_field(world, 0, "position"), least = INFINITY;
    for (int64_t i = 0; i < brunt_body_particles(world, 0); i++) {
        double gap = AWAY - a->wall * brunt_world_time(world) - 0.5 * SPACING * reach(F, i, a->normal);
        for (int c = 0; c < 3; c++) gap += a->normal[c] * x[3 * i + c];
        least = fmin(least, gap);
    }
    free(x);
    return least;
}

// How far the nearest surface is from the wall after the first push and before it, of what it would have come nearer;
// and how much its particle is stretched along the normal.
static void arrive(const approach *a, double *after, double *before, double *stretched) {
    brunt_world *world = thrown(a);
    double *F = NULL, gap, come = 0;
    do {
        free(F);
        F = world_field(world, 0, "deformation_gradient");
        const double last = gap = nearest(world, a, F);
        world_steps(world, 1);
        if (fabs(world_boundary(world, 0).impulse[0]) + fabs(world_boundary(world, 0).impulse[1]) > 0) break;
        come = last - nearest(world, a, F);
    } while (brunt_world_time(world) < 1);
    *after = nearest(world, a, F) / come, *before = gap / come, *stretched = reach(F, 0, a->normal);
    free(F);
    brunt_world_destroy(world);
}

// Sweeps end at a hundredth of the greatest correction, which is at most what it would have come.
START_TEST(an_approach_ends_on_the_wall) {
    static const double normals[][3] = {{0, 1, 0}, {-1, 0, 0}, {0.6, 0.8, 0}, {-0.28, -0.96, 0}},
                        fields[][2][3] = {{{0, 0, 0}, {1, 0, 0}},  // as it was made
                                          {{2, 0, 0}, {1, 0, 0}},  // stretched,
                                          {{-2, 0, 0}, {1, 0, 0}}, // compressed,
                                          {{0, 3, 0}, {1, 0, 0}},  // sheared,
                                          {{1, 1, 0}, {1, 1, 0}}}; // stretched obliquely
    double widest = 0, longest = 0, shortest = 1;
    for (int k = 0; k < 80; k++) {
        approach a = {.dimension = k % 16 < 14 ? 2 : 3, .total = k / 4 % 2, .towards = 5, .wall = k / 8 % 2 ? 1.5 : 0};
        memcpy(a.normal, normals[k % 4], sizeof a.normal);
        memcpy(a.stretch, fields[k / 16][0], sizeof a.stretch), memcpy(a.along, fields[k / 16][1], sizeof a.along);
        double after, before, stretched;
        arrive(&a, &after, &before, &stretched);
        widest = fmax(widest, before), longest = fmax(longest, stretched), shortest = fmin(shortest, stretched);
        ck_assert_msg(fabs(after) < 0.01, "case %d: %g of a step's way from the wall, was %g before; stretched %g", k,
                      after, before, stretched);
    }
    printf("  gaps closed up to %.2f of a step's way; stretched %.2f to %.2f\n", widest, shortest, longest);
    ck_assert(widest > 0.5 && shortest < 0.7 && longest > 1.3);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("wall_gap");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 0);
    tcase_add_test(all, an_approach_ends_on_the_wall);
    suite_add_tcase(suite, all);
    return suite_main(suite);
}
