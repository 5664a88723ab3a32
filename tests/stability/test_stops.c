// Implicit steps and load steps that are left on the way: whenever that is, the world is as before the step, to the
// bit, and goes on from there, or from its checkpoint, as one that was not stopped.
#include "tests/support/def_world.h"
#include "tests/support/small_scene.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // load steps want double
#else

#define HEAD(dim, more) "brunt: 1\ntitle: stopped\ndimension: " dim "\n" more
#define RUBBER                                                                                                         \
    "materials:\n  soft: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}\n"                                     \
    "  linear: {model: linear-elastic, density: 1000, E: 1 MPa, nu: 0.3}\n"
#define DISKS                                                                                                          \
    "  stiff: {model: linear-elastic, density: 1000, E: 200 MPa, nu: 0.3}\nbodies:\n"                                  \
    "  grains: {method: fem, element: tri3, size: 2 mm, material: linear, crowd: {lattice: square, count: [3, 3], "    \
    "radius: 5 mm, gap: 30 um}, random: {E: {normal: [1 MPa, 1 MPa], between: [0.5 MPa, 2 MPa]}, seed: 1}}\n"          \
    "  top: {method: fem, element: quad4, size: 2.5 mm, material: stiff, shape: {box: {min: [0.1 mm, 30.09 mm], max: " \
    "[30.19 mm, 35.09 mm]}}}\nboundaries:\n"                                                                           \
    "  - {name: left, plane: {point: [0, 0], normal: [1, 0]}, condition: separate}\n"                                  \
    "  - {name: right, plane: {point: [30.24 mm, 0], normal: [-1, 0]}, condition: separate}\n"                         \
    "  - {name: floor, plane: {point: [0, 0], normal: [0, 1]}, condition: separate}\n"                                 \
    "  - {body: top, group: ymax, traction: [0, -3000], table: [[0 s, 0], [1 s, 1]]}\n"                                \
    "  - {body: top, group: surface, fix: [x]}\n"
#define POINTS                                                                                                         \
    "bodies:\n  low: {method: mpm, material: soft, shape: {box: {min: [0, 0], max: [0.8, 0.4]}}}\n"                    \
    "  high: {method: fem, material: soft, size: 0.2, shape: {box: {min: [0.2, 0.44], max: [0.6, 0.8]}}, velocity: "   \
    "[1, -4]}\n"

// What is solved by each: friction by rounds, and after them by what follows; a stiffness that is guessed; points,
// elements and a plane of symmetry; conjugate gradients, with a matrix and without; tractions of a line that are found
// before the first step; prescribed motion that leads.
static const char *const scenes[] = {
    HEAD("2", "time: {scheme: static, steps: 2}\nnewton: {tolerance: 1e-9}\n") RUBBER DISKS
    "contact: {method: barrier, friction: 0.3, distance: 50 um}\n",
    HEAD("2", "time: {scheme: static, steps: 2}\nnewton: {tolerance: 1e-8}\n") RUBBER DISKS
    "contact: {method: penalty, friction: 0.3, distance: 50 um}\n",
    HEAD("2", "time: {scheme: implicit, end: 0.1, step: 10 ms, integrator: newmark}\ngrid: {cell: 0.2}\n") RUBBER POINTS
    "contact: {method: barrier, friction: 0.3, distance: 20 mm}\n"
    "boundaries: [{name: middle, plane: {point: [0, 0], normal: [1, 0]}, condition: symmetry}]\n",
    HEAD("3", "time: {scheme: implicit, end: 0.1, step: 10 ms}\nnewton: {solver: pcg}\n") RUBBER
    "bodies:\n  low: {method: fem, material: soft, size: 0.2, shape: {box: {min: [0, 0, 0], max: [0.6, 0.6, 0.4]}}}\n"
    "  high: {method: fem, material: soft, size: 0.2, element: tet4, shape: {box: {min: [0.1, 0.1, 0.42], max: [0.5, "
    "0.5, "
    "0.8]}}, velocity: [0, 0, -4]}\ncontact: {method: barrier, distance: 20 mm}\n",
    HEAD("2", "time: {scheme: implicit, end: 0.1, step: 10 ms, integrator: newmark}\ngrid: {cell: 0.2}\n") RUBBER
    "bodies: {low: {method: mpm, material: soft, shape: {box: {min: [0, 0], max: [0.8, 0.4]}}}}\n"
    "boundaries: [{name: base, line: {points: [[-1, 0], [2, 0]]}, condition: stick}]\nloads: {gravity: [2, -10]}\n",
    HEAD("2", "time: {scheme: static, steps: 2}\n") RUBBER
    "bodies: {low: {method: fem, material: soft, size: 0.2, shape: {box: {min: [0, 0], max: [0.8, 0.4]}}}}\n"
    "boundaries:\n  - {name: base, body: low, group: ymin, fix: all}\n"
    "  - {name: top, body: low, group: ymax, displacement: [0.1, 0.2], table: [[0 s, 0], [1 s, 1]]}\n",
};
enum { SCENES = sizeof scenes / sizeof *scenes };

typedef struct patience {
    int asked, most; // says yes once it has been asked more often
} patience;

static bool is_over(void *context) {
    patience *p = context;
    return p->asked++ == p->most; // and no again: that it was told once is to be enough
}

// All that a checkpoint has, with its length.
static char *state_of(brunt_world *world, size_t *length) {
    char *bytes = NULL;
    *length = 0;
    for (int32_t b = 0; b < brunt_state_count(world); b++) {
        const size_t size = (size_t)brunt_state_info(world, b).count * 8;
        bytes = realloc(bytes, *length + size + 8);
        memset(bytes + *length, 0, size);
        brunt_state_get(world, b, bytes + *length);
        *length += size;
    }
    return bytes;
}

static void check_same(const char *a, size_t a_length, brunt_world *world) {
    size_t length;
    char *b = state_of(world, &length);
    ck_assert_uint_eq(a_length, length);
    ck_assert(!memcmp(a, b, length));
    free(b);
}

// A step that is left after ever more questions, until it has an end; how often it was left.
static int leave_step(const brunt_scene *scene, brunt_world *world, brunt_world *reference) {
    patience p = {.most = 0};
    size_t before, after;
    char *kept = state_of(world, &before);
    small_steps(reference, 1);
    char *wanted = state_of(reference, &after);
    int left = 0;
    for (int status = BRUNT_STOPPED; status == BRUNT_STOPPED; p.most += 1 + p.most / 4) {
        brunt_error error = {0};
        p.asked = 0;
        brunt_world_heed(world, &(brunt_stop){is_over, &p});
        status = brunt_world_step(world, INFINITY, &error);
        ck_assert_msg(status == BRUNT_OK || status == BRUNT_STOPPED, "%s", error.message);
        if (!status) break;
        ck_assert_int_eq(error.code, BRUNT_STOPPED);
        ck_assert_int_eq(p.asked, p.most + 1); // at once
        check_same(kept, before, world);
        if (left++ % 5) continue;
        brunt_world *fresh = small_world(scene);
        world_copy_state(world, fresh);
        small_steps(fresh, 1);
        ck_assert_uint_eq(brunt_world_hash(fresh), brunt_world_hash(reference));
        brunt_world_destroy(fresh);
    }
    check_same(wanted, after, world);
    brunt_newton_counts all, last; // asked before each factorisation, and in each iteration of conjugate gradients
    brunt_world_newton(world, &all, &last);
    ck_assert_double_ge(p.asked, last.factorisations + last.linear_iterations);
    free(kept), free(wanted);
    return left;
}

START_TEST(are_as_before) {
    brunt_scene scene;
    small_scene_of(scenes[_i], &scene, NULL, 0);
    brunt_world *world = small_world(&scene), *reference = small_world(&scene);
    for (int step = 0; step < 2; step++) {
        const int left = leave_step(&scene, world, reference);
        printf("scene %d, step %d: left %d times\n", _i, step, left);
        ck_assert_int_gt(left, 1);
    }
    brunt_world_destroy(world), brunt_world_destroy(reference);
    brunt_scene_free(&scene);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("steps that are left");
    ADD_LOOP(are_as_before, SCENES);
    return suite_main(suite);
}
#endif
