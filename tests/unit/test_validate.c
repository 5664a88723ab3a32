// Labels: unit
// Parts of a world that a wrong write has broken are noticed between two steps.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/def_world.h"
#include "world/world.h"

// A block of material points on a plane, and a mesh with damping beside it.
static brunt_world *two_bodies(void) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.4, 0.3, 0));
    brunt_body_def *mesh = def_box(&def, "mesh", XYZ(1, 0, 0), XYZ(1.4, 0.3, 0));
    mesh->method = BRUNT_FEM, mesh->element = BRUNT_QUAD4, mesh->size = 0.1, mesh->damping = 5;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    return world_take(&def);
}

typedef void breaking(brunt_world *world);
static void nothing(brunt_world *w) { (void)w; }
static void boundary_body(brunt_world *w) { w->boundaries.walls[0].body = w->bodies.count; }
static void boundary_normal(brunt_world *w) { w->boundaries.walls[0].plane.normal[1] = 0.9; }
static void boundary_mirror(brunt_world *w) { w->boundaries.walls[0].mirror = w->boundaries.mirror_count; }
static void boundary_account(brunt_world *w) { w->boundaries.walls[0].action.impulse[1] = NAN; }
static void mirror_count(brunt_world *w) { w->boundaries.mirror_count = -1; }
static void damping_active(brunt_world *w) { w->boundaries.damping.active = false; }
static void damping_count(brunt_world *w) { w->boundaries.damping.fem_count++; }
static void ledger_number(brunt_world *w) { w->ledger.gravity_angular[2] = INFINITY; }
static void ledger_scale(brunt_world *w) { w->ledger.initial_energy = 2 * w->ledger.energy_scale + 1; }
static void plan_pass(brunt_world *w) { w->plan.pass_of[0] = w->plan.pass_count; }
static void plan_order(brunt_world *w) { w->plan.row[1] = w->plan.row[0], w->plan.pass_of[1] = w->plan.pass_of[0]; }
static void plan_rows(brunt_world *w) { w->plan.row_count = BRUNT_PASS_LIMIT + 1; }
static void timing_pass(brunt_world *w) { w->timing.pass = w->plan.pass_count; }
static void scratch_capacity(brunt_world *w) { w->scratch.node_sums_capacity = w->scratch.node_sums ? 0 : 1; }
static void scratch_dofs(brunt_world *w) {
    brunt_particle_dofs *planes = &w->scratch.planes;
    planes->dof_count = (int32_t)(planes->dof_capacity / sizeof *planes->dof) + 1;
}
static void scratch_thread(brunt_world *w) { w->scratch.points[0].capacity = w->scratch.points[0].memory ? 0 : 1; }

static breaking *const breakings[] = {boundary_body, boundary_normal,  boundary_mirror, boundary_account,
                                      mirror_count,  damping_active,   damping_count,   ledger_number,
                                      ledger_scale,  plan_pass,        plan_order,      plan_rows,
                                      timing_pass,   scratch_capacity, scratch_dofs,    scratch_thread};
enum { BREAKINGS = sizeof breakings / sizeof *breakings };

// The signal that ends a process which looks the world over after `break_it`; 0: none.
static int signal_after(brunt_world *world, breaking *break_it) {
    const pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (!child) {
        break_it(world);
        brunt_world_validate(world);
        _exit(0);
    }
    int status = 0;
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

START_TEST(broken_part_is_noticed) {
    brunt_world *world = two_bodies();
    ck_assert_int_eq(signal_after(world, nothing), 0);
    world_steps(world, 3);
    ck_assert_int_eq(signal_after(world, nothing), 0);
    ck_assert_int_eq(signal_after(world, breakings[_i]), SIGABRT);
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("validate");
    ADD_LOOP(broken_part_is_noticed, BREAKINGS);
    return suite_main(suite);
}
