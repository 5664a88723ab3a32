// The explicit scheme: central differences in time, with velocities in the middle of the steps.
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/parallel.h"
#include "scheme/scheme.h"

// ------------------------------------------------------------------------------------------ what is wanted

static bool always(const brunt_world *world) { return world != NULL; }
static bool meshes(const brunt_world *world) { return world->bodies.fem_count > 0; }
static bool groups(const brunt_world *world) { return world->boundaries.sets.act; }
static bool loads_or_drag(const brunt_world *world) { return groups(world) || world->boundaries.damping.active; }
static bool particles(const brunt_world *world) { return world->bodies.mpm_count > 0; }
static bool symmetry(const brunt_world *world) { return particles(world) && world->boundaries.symmetry_count > 0; }
static bool conditions(const brunt_world *world) { return particles(world) && world->boundaries.has_conditions; }
static bool grid_contact(const brunt_world *world) { return world->contact.has_grid || world->contact.has_touches; }
static bool surfaces(const brunt_world *world) { return world->contact.has_surfaces; }
static bool conditions_of_contact(const brunt_world *world) { return conditions(world) && grid_contact(world); }
static bool conditions_of_surfaces(const brunt_world *world) { return conditions(world) && surfaces(world); }
static bool boundaries(const brunt_world *world) { return particles(world) && world->boundaries.meets_points; }
static bool conditions_of_boundaries(const brunt_world *world) { return conditions(world) && boundaries(world); }
static bool remapping(const brunt_world *world) { return particles(world) && world->transfers.musl_velocity; }
static bool erosion(const brunt_world *world) { return world->erosion.active; }

// ------------------------------------------------------------------------------------------ what passes run over

static double all_bodies(const brunt_world *world, const brunt_body *body) {
    (void)body;
    return world->bodies.count;
}

static double all_particles(const brunt_world *world, const brunt_body *body) {
    return body ? (double)body->particles.count : (double)brunt_world_particles(world);
}

static double all_grid_nodes(const brunt_world *world, const brunt_body *body) {
    double slots = body ? body->grid.slot_count : 0;
    for (int i = 0; !body && i < world->bodies.mpm_count; i++) slots += world->bodies.mpm[i].grid.slot_count;
    return slots * BRUNT_BLOCK_NODES;
}

static double all_mesh_nodes(const brunt_world *world, const brunt_body *body) {
    (void)body;
    double nodes = 0;
    for (int k = 0; k < world->bodies.fem_count; k++) nodes += world->bodies.fem[k].node_count;
    return nodes;
}

static double all_elements(const brunt_world *world, const brunt_body *body) {
    (void)body;
    return (double)brunt_world_elements(world);
}

static double all_points(const brunt_world *world, const brunt_body *body) {
    return all_elements(world, body) + all_particles(world, body);
}

static double group_nodes(const brunt_world *world, const brunt_body *body) {
    (void)body;
    double nodes = 0;
    for (int h = 0; h < world->boundaries.sets.count; h++) nodes += world->boundaries.sets.set[h].node_count;
    return nodes;
}

static double surface_nodes(const brunt_world *world, const brunt_body *body) {
    (void)body;
    return world->contact.surface.node_count;
}

// ------------------------------------------------------------------------------------------ passes of other parts

static int meet_surfaces(brunt_world *world, brunt_step *step, brunt_error *error) {
    return brunt_surfaces_meet(world, step->gravity, step->kick, step->dt, error)
               ? brunt_fail_inner(&world->clock, NULL, error)
               : BRUNT_OK;
}

static int64_t all_eroded(const brunt_world *world) {
    int64_t n = 0;
    for (int i = 0; i < world->bodies.count; i++)
        n += world->erosion.account[i].elements + world->erosion.account[i].particles;
    return n;
}

static int erode(brunt_world *world, brunt_step *step, brunt_error *error) {
    const int64_t before = all_eroded(world);
    int status = world->bodies.fem_count ? brunt_erode_meshes(world, step->dt, error) : BRUNT_OK;
    if (!status && world->bodies.mpm_count) brunt_erode_particles(world);
    if (all_eroded(world) > before)
        world->clock.recent_step = world->clock.earlier_step = INFINITY; // what left swings no more
    return status;
}

// The clock, and the accounts of what acts from outside and between bodies.
int brunt_pass_account(brunt_world *world, brunt_step *s, brunt_error *error) {
    (void)error;
    struct brunt_clock *now = &world->clock;
    brunt_ledger *ledger = &world->ledger;
    ledger->transfer += ledger->kinetic - s->old_kinetic + s->new_kinetic - s->kinetic;
    ledger->kinetic = s->kinetic;
    for (int w = 0; w < world->boundaries.boundary_count; w++)
        brunt_impulse_account_add(&world->boundaries.boundary[w].account, &world->boundaries.boundary[w].last);
    for (int p = 0; p < world->pairs.count; p++)
        brunt_impulse_account_add(&world->pairs.pair[p].account, &world->pairs.pair[p].last);
    const brunt_accounts accounts = brunt_accounts_of(world);
    brunt_ledger_remember(&world->ledger, &accounts);
    double stop = fmin(s->limit > now->time ? s->limit : INFINITY, world->settings.end);
    now->time = s->dt == stop - now->time ? stop : now->time + s->dt;
    now->steps += 1;
    now->dt = s->dt;
    now->kick = s->kick;
    if (2 * s->dt >= now->next_dt) now->longest = fmax(now->longest, s->dt); // else it was cut to end on a time
    now->dt_min = fmin(now->dt_min, s->dt);
    now->dt_max = fmax(now->dt_max, s->dt);
    return s->status;
}

// ------------------------------------------------------------------------------------------ the step

// clang-format off
const brunt_pass_row brunt_explicit_passes[] = {
    {BRUNT_PASS_PART,  "advance",       "body",     always,                   brunt_pass_choose,        all_bodies,     NULL},
    {BRUNT_PASS_WHOLE, "kick",          "node",     meshes,                   brunt_pass_kick,          all_mesh_nodes, brunt_work_kick},
    {BRUNT_PASS_WHOLE, "groups",        "node",     groups,                   brunt_pass_groups,        group_nodes,    NULL},
    {BRUNT_PASS_WHOLE, "sort",          "particle", particles,                brunt_pass_sort,          all_particles,  brunt_work_sort},
    {BRUNT_PASS_BODY,  "p2g",           "particle", particles,                brunt_pass_p2g,           all_particles,  brunt_work_p2g},
    {BRUNT_PASS_BODY,  "grid",          "node",     particles,                brunt_pass_grid,          all_grid_nodes, brunt_work_grid},
    {BRUNT_PASS_BODY,  "symmetry",      "node",     symmetry,                 brunt_pass_symmetry,      all_grid_nodes, NULL},
    {BRUNT_PASS_BODY,  "update",        "node",     particles,                brunt_pass_update,        all_grid_nodes, brunt_work_update},
    {BRUNT_PASS_WHOLE, "conditions",    "node",     conditions,               brunt_pass_conditions,    all_grid_nodes, NULL},
    {BRUNT_PASS_WHOLE, "contact",       "node",     grid_contact,             brunt_pass_contact,       all_grid_nodes, NULL},
    {BRUNT_PASS_PART,  "conditions",    "node",     conditions_of_contact,    brunt_pass_conditions,    all_grid_nodes, NULL},
    {BRUNT_PASS_WHOLE, "surfaces",      "node",     surfaces,                 meet_surfaces,            surface_nodes,  NULL},
    {BRUNT_PASS_PART,  "conditions",    "node",     conditions_of_surfaces,   brunt_pass_conditions,    all_grid_nodes, NULL},
    {BRUNT_PASS_WHOLE, "boundaries",    "node",     boundaries,               brunt_pass_boundaries,    all_grid_nodes, NULL},
    {BRUNT_PASS_PART,  "conditions",    "node",     conditions_of_boundaries, brunt_pass_conditions,    all_grid_nodes, NULL},
    {BRUNT_PASS_WHOLE, "ledger",        "node",     particles,                brunt_pass_ledger,        all_grid_nodes, brunt_work_ledger},
    {BRUNT_PASS_WHOLE, "musl_velocity", "particle", remapping,                brunt_pass_musl_velocity, all_particles,  brunt_work_musl_velocity},
    {BRUNT_PASS_WHOLE, "g2p",           "particle", particles,                brunt_pass_g2p,           all_particles,  brunt_work_g2p},
    {BRUNT_PASS_PART,  "kick",          "node",     loads_or_drag,            brunt_pass_finish_kick,   NULL,           NULL},
    {BRUNT_PASS_WHOLE, "drift",         "node",     meshes,                   brunt_pass_drift,         all_mesh_nodes, brunt_work_drift},
    {BRUNT_PASS_WHOLE, "elements",      "element",  meshes,                   brunt_pass_elements,      all_elements,   brunt_work_elements},
    {BRUNT_PASS_PART,  "advance",       "body",     always,                   brunt_pass_account,       NULL,           NULL},
    {BRUNT_PASS_WHOLE, "erosion",       "point",    erosion,                  erode,                    all_points,     NULL},
    {BRUNT_PASS_WHOLE, "advance",       "body",     always,                   brunt_pass_watch,         NULL,           NULL},
};
// clang-format on
BRUNT_COUNT_PASSES(brunt_explicit_passes, brunt_explicit_pass_count);

static int run_pass(brunt_world *world, int at, brunt_step *step, brunt_error *error) {
    const brunt_pass_row *row = world->plan.row[at];
    if (row->kind == BRUNT_PASS_INNER) return BRUNT_OK;
    const double units = row->units ? row->units(world, step->body) : 0;
    brunt_pass_begin(&world->timing, world->plan.pass_of[at]);
    int status = row->run(world, step, error);
    brunt_pass_end(&world->timing, units);
    return status;
}

// The rows [at, end) of the plan, of one body of material points after the other.
static int run_bodies(brunt_world *world, int at, int end, brunt_step *step, brunt_error *error) {
    int status = BRUNT_OK;
    for (int i = 0; i < world->bodies.mpm_count && !status; i++) {
        step->body = &world->bodies.mpm[i];
        for (int k = at; k < end && !status; k++) status = run_pass(world, k, step, error);
    }
    step->body = NULL;
    return status;
}

static int run_plan(brunt_world *world, double limit, brunt_error *error) {
    const brunt_plan *plan = &world->plan;
    brunt_step step = {.limit = limit};
    int status = BRUNT_OK;
    for (int at = 0, end; at < plan->row_count && !status; at = end) {
        for (end = at; end < plan->row_count && plan->row[end]->kind == BRUNT_PASS_BODY;) end++;
        status = end > at ? run_bodies(world, at, end, &step, error) : run_pass(world, end++, &step, error);
    }
    return status;
}

int brunt_world_step(brunt_world *world, double limit, brunt_error *error) {
    if (!world) return brunt_fail(error, BRUNT_BAD_INPUT, "there is no world to take a step of");
    brunt_step_begin(&world->timing);
    brunt_parallel_begin_step(world->settings.threads);
    int status = run_plan(world, limit, error);
    brunt_parallel_end_step(world->settings.threads);
    brunt_step_end(&world->timing);
    if (!status) BRUNT_VALIDATE(world);
    return status;
}
