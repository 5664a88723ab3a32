// The implicit scheme: each step minimises an energy (implicit.h).
#include <math.h>

#include "base/error.h"
#include "scheme/implicit.h"

// ------------------------------------------------------------------------------------------ what is wanted, gone over

static bool always(const brunt_world *world) { return world != NULL; }
static bool particles(const brunt_world *world) { return world->bodies.mpm_count > 0; }
static bool pieces(const brunt_world *world) { return world->boundaries.surfaces.count > 0; }

static double all_bodies(const brunt_world *world, const brunt_body *body) {
    return body ? 1 : (double)world->bodies.count;
}

static double all_particles(const brunt_world *world, const brunt_body *body) {
    return body ? (double)body->particles.count : (double)brunt_world_particles(world);
}

static double slot_nodes(const brunt_world *world, const brunt_body *body) {
    (void)world;
    return (double)body->grid.slot_count * BRUNT_BLOCK_NODES;
}

static double all_unknowns(const brunt_world *world, const brunt_body *body) {
    (void)body;
    return (double)world->plan.implicit->unknowns.count;
}

static double all_points(const brunt_world *world, const brunt_body *body) {
    return (double)brunt_world_elements(world) + all_particles(world, body);
}

// ------------------------------------------------------------------------------------------ passes

// The step that is asked for, in equal parts up to a time that must be hit.
static int choose(brunt_world *world, brunt_step *step, brunt_error *error) {
    const struct brunt_clock *now = &world->clock;
    world->clock.withdrawn = false;
    if (error) *error = (brunt_error){.id = -1};
    const double stop = fmin(step->limit > now->time ? step->limit : INFINITY, world->settings.end);
    const bool still = world->plan.implicit->still;
    const double left = stop - now->time,
                 wanted = still ? brunt_static_wanted(world) : fmin(now->next_dt, world->settings.fixed_step);
    if (!(left > 0))
        return brunt_fail_step(&world->clock, NULL, error, "the end has been reached, there is no step to take");
    step->dt = wanted >= left * (1 - 1e-9)     ? left
               : !still && left < 1e6 * wanted ? left / ceil(left / wanted * (1 - 1e-9))
                                               : wanted;
    if (now->time + step->dt == now->time)
        return brunt_fail_step(&world->clock, NULL, error, "the step is too small to advance the time");
    if (brunt_implicit_heed(world, error)) return BRUNT_FAILED;
    step->kick = 0; // particles give the grid their mass and momentum, and no forces
    brunt_step_open(world, step);
    return BRUNT_OK;
}

static int commit_meshes(brunt_world *world, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    double stored = 0;
    world->ledger.fem_kinetic = 0;
    for (int k = 0; k < world->bodies.fem_count; k++) {
        brunt_fem_body *fem = &world->bodies.fem[k];
        if (brunt_fem_commit(m->fem[k], &m->team, m->field.u, brunt_implicit_velocity(m), world->scratch.meshes, error))
            return brunt_fail_inner(&world->clock, NULL, error);
        world->ledger.fem_kinetic += brunt_fem_audit(fem, 0, fem->node_count).kinetic;
        for (int32_t b = 0; b < fem->block_count; b++) stored += fem->report[b].hourglass_stored;
    }
    world->ledger.hourglass_stored = stored;
    return BRUNT_OK;
}

static int commit_points(brunt_world *world, brunt_step *step, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    const brunt_mpm_motion motion = {.u = m->field.u,
                                     .v = brunt_implicit_velocity(m),
                                     .v_old = m->unknowns.velocity,
                                     .transfer = world->settings.transfer,
                                     .flip = world->settings.flip};
    step->kinetic = 0;
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        brunt_mpm_result result;
        if (brunt_mpm_commit(m->mpm[i], &m->team, &motion, &result, error))
            return brunt_fail_inner(&world->clock, NULL, error);
        step->kinetic += result.kinetic;
        body->speed = result.speed;
    }
    return BRUNT_OK;
}

// The step becomes that of the bodies.
static int commit(brunt_world *world, brunt_step *step, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    m->team.timer = brunt_pass_timer(&world->timing);
    if (brunt_implicit_account(world, step, error)) return brunt_fail_inner(&world->clock, NULL, error);
    const int status = commit_meshes(world, error);
    if (status) return status;
    brunt_newton_counts_add(&world->clock.newton, &m->tried);
    world->clock.newton_last = m->tried;
    return commit_points(world, step, error);
}

void brunt_newton_counts_add(brunt_newton_counts *sum, const brunt_newton_counts *part) {
    sum->steps += part->steps;
    sum->iterations += part->iterations;
    sum->iterations_worst = fmax(sum->iterations_worst, part->iterations_worst);
    sum->halvings += part->halvings;
    sum->projections += part->projections;
    sum->linear_iterations += part->linear_iterations;
    sum->factorisations += part->factorisations;
    sum->cuts += part->cuts;
    sum->residual = fmax(sum->residual, part->residual);
    sum->least_gap = fmin(sum->least_gap, part->least_gap);
    sum->least_part = fmin(sum->least_part, part->least_part);
}

// ------------------------------------------------------------------------------------------ the step

// clang-format off
const brunt_pass_row brunt_implicit_passes[] = {
    {BRUNT_PASS_PART,  "advance",  "body",     always,    choose,                    all_bodies,    NULL},
    {BRUNT_PASS_WHOLE, "sort",     "particle", particles, brunt_pass_sort,           all_particles, brunt_work_sort},
    {BRUNT_PASS_BODY,  "p2g",      "particle", particles, brunt_pass_p2g,            all_particles, brunt_work_p2g},
    {BRUNT_PASS_BODY,  "grid",     "node",     particles, brunt_pass_grid,           slot_nodes,    brunt_work_grid},
    {BRUNT_PASS_WHOLE, "number",   "node",     always,    brunt_pass_number,         all_unknowns,  NULL},
    {BRUNT_PASS_WHOLE, "newton",   "node",     always,    brunt_pass_newton,         all_unknowns,  NULL},
    {BRUNT_PASS_INNER, "evaluate", "point",    always,    NULL,                      all_points,    NULL},
    {BRUNT_PASS_INNER, "matrix",   "point",    always,    NULL,                      all_points,    NULL},
    {BRUNT_PASS_INNER, "factor",   "node",     always,    NULL,                      all_unknowns,  NULL},
    {BRUNT_PASS_INNER, "solve",    "node",     always,    NULL,                      all_unknowns,  NULL},
    {BRUNT_PASS_INNER, "sweeps",   "node",     pieces,    NULL,                      all_unknowns,  NULL},
    {BRUNT_PASS_INNER, "limit",    "point",    always,    NULL,                      all_points,    NULL},
    {BRUNT_PASS_INNER, "search",   "point",    always,    NULL,                      all_points,    NULL},
    {BRUNT_PASS_WHOLE, "commit",   "point",    always,    commit,                    all_points,    NULL},
    {BRUNT_PASS_PART,  "advance",  "body",     always,    brunt_pass_account,        NULL,          NULL},
    {BRUNT_PASS_WHOLE, "advance",  "body",     always,    brunt_pass_watch_implicit, NULL,          NULL},
};
// clang-format on
BRUNT_COUNT_PASSES(brunt_implicit_passes, brunt_implicit_pass_count);
