// The passes over material points and their grids.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "contact/planes/grid_conditions.h"
#include "contact/search/particle_plane.h"
#include "mpm/courant.h"
#include "mpm/sort.h"
#include "scheme/scheme.h"

enum { SLOT_GRAIN = 8, BLOCK_GRAIN = 2 };

typedef struct body_job {
    brunt_world *world;
    brunt_body *body;
    double dt, kept;
} body_job;

static void p2g_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const body_job *job = context;
    brunt_p2g_fn *p2g =
        brunt_total_lagrangian(&job->body->particles) ? job->world->transfers.total_p2g : job->world->transfers.p2g;
    for (int64_t b = begin; b < end; b++) p2g(job->body, (int32_t)b, (real)job->dt);
}

// What a step leaves of the share that points keep of their own; 0 where they keep none.
static double kept_of(const brunt_settings *s, const brunt_body *body, double dt) {
    const double share = s->transfer == BRUNT_FLIP ? s->flip : s->apic;
    if (share == 0 || (s->transfer == BRUNT_FLIP && s->flip_per_step)) return share;
    return brunt_share_left(share, (double)body->material.wave_speed, (double)body->grid.h, dt);
}

static void g2p_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const body_job *job = context;
    brunt_g2p_fn *g2p =
        brunt_total_lagrangian(&job->body->particles) ? job->world->transfers.total_g2p : job->world->transfers.g2p;
    for (int64_t b = begin; b < end; b++)
        g2p(job->body, (int32_t)b, (real)job->dt, (real)job->kept, &job->world->scratch.points[worker]);
}

int brunt_pass_sort(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)step;
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        if (error) error->id = -1;
        if (brunt_sort(&body->grid, &body->particles, world->settings.threads, brunt_pass_timer(&world->timing), error))
            return brunt_fail_inner(&world->clock, body, error);
        const brunt_grid *grid = &body->grid;
        int32_t most = 0;
        for (int32_t b = 0; b < grid->block_count; b++)
            if (grid->blocks[b].count > most) most = grid->blocks[b].count;
        if (BRUNT_CAPACITY(body->report, (size_t)grid->block_count, 0, "reports of blocks of particles", error) ||
            BRUNT_CAPACITY(world->scratch.node_sums, (size_t)grid->slot_count, 0, "sums of blocks of nodes", error))
            return brunt_fail_inner(&world->clock, body, error);
        for (int t = 0; t < world->settings.threads; t++)
            if (brunt_workspace_fit(&world->scratch.points[t], grid, most, world->transfers.outs, error))
                return brunt_fail_inner(&world->clock, body, error);
    }
    return BRUNT_OK;
}

// The symmetry planes that act on a body, and where what they bear is recorded.
typedef struct acting_symmetry {
    brunt_symmetry_plane plane[BRUNT_MAX_PLANES];
    brunt_impulse_account *account[BRUNT_MAX_PLANES], unbooked;
    int count;
} acting_symmetry;

// What the axis of rings does is never recorded: its impulses cancel around the circle.
static void find_symmetry(brunt_boundaries *boundaries, const brunt_body *body, bool accounted, acting_symmetry *s) {
    s->unbooked = (brunt_impulse_account){.external_work = 0};
    s->count = 0;
    for (int m = 0; m < boundaries->symmetry_count; m++) {
        const int w = boundaries->symmetry[m].boundary;
        if (w < 0 || brunt_boundary_acts_on(&boundaries->boundary[w], body->index))
            s->plane[s->count++] = boundaries->symmetry[m];
    }
    s->count = brunt_symmetry_distinct(s->plane, s->count);
    for (int k = 0; k < s->count; k++) {
        const int w = s->plane[k].boundary;
        s->account[k] = w >= 0 && accounted ? &boundaries->boundary[w].last : &s->unbooked;
    }
}

// Sums of the grid's nodes and of their images by the symmetry planes that act on a body, recorded when `accounted`.
static void fold_symmetry(brunt_world *world, brunt_body *body, double taken, bool accounted) {
    acting_symmetry s;
    find_symmetry(&world->boundaries, body, accounted, &s);
    brunt_symmetry_fold(body, s.plane, s.count, taken, s.account, world->settings.threads,
                        brunt_pass_timer(&world->timing));
}

// The same where APIC keeps `kept`: the rest is taken, and what is kept moves on.
static int fold_kept(brunt_world *world, brunt_body *body, double kept, double dt, brunt_error *error) {
    acting_symmetry s;
    find_symmetry(&world->boundaries, body, true, &s);
    const size_t reals = (size_t)body->grid.slot_count * BRUNT_BLOCK_NODES * 3;
    if (BRUNT_CAPACITY(world->scratch.own_momenta, reals, 0, "momenta of nodes", error))
        return brunt_fail_inner(&world->clock, body, error);
    brunt_symmetry_remember(body, s.plane, s.count, world->scratch.own_momenta);
    brunt_symmetry_fold(body, s.plane, s.count, 1 - kept, s.account, world->settings.threads,
                        brunt_pass_timer(&world->timing));
    brunt_symmetry_carry(body, s.plane, s.count, world->scratch.own_momenta, kept * dt, s.account);
    return BRUNT_OK;
}

static brunt_grid_job grid_job(brunt_world *world, const brunt_step *step, brunt_body *body) {
    return (brunt_grid_job){.body = body,
                            .gravity = step->gravity,
                            .dt = step->kick,
                            .has_gravity = world->settings.has_gravity,
                            .sums = world->scratch.node_sums};
}

int brunt_pass_p2g(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)error;
    body_job job = {.world = world, .body = step->body, .dt = step->kick};
    brunt_parallel(world->settings.threads, step->body->grid.block_count, BLOCK_GRAIN, p2g_blocks, &job,
                   brunt_pass_timer(&world->timing));
    return BRUNT_OK;
}

int brunt_pass_grid(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)error;
    brunt_grid_job job = grid_job(world, step, step->body);
    brunt_parallel(world->settings.threads, step->body->grid.slot_count, SLOT_GRAIN, brunt_grid_sum, &job,
                   brunt_pass_timer(&world->timing));
    return BRUNT_OK;
}

int brunt_pass_symmetry(brunt_world *world, brunt_step *step, brunt_error *error) {
    const brunt_settings *s = &world->settings; // what particles keep of their own knows nothing of the images
    const double kept = kept_of(s, step->body, step->dt);
    if (s->apic > 0) return fold_kept(world, step->body, kept, step->dt, error);
    fold_symmetry(world, step->body, 1 - kept, true);
    return BRUNT_OK;
}

// The velocities on the grid before anything else acts. Between two steps the transfers change the velocities that the
// stress works on, without any change of strain: the work at the new velocities less that at the last ones is theirs.
int brunt_pass_update(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)error;
    brunt_grid_job job = grid_job(world, step, step->body);
    const int32_t slots = step->body->grid.slot_count;
    brunt_parallel(world->settings.threads, slots, SLOT_GRAIN, brunt_grid_update, &job,
                   brunt_pass_timer(&world->timing));
    for (int32_t n = 0; n < slots; n++) world->ledger.transfer -= 0.5 * world->scratch.node_sums[n].stress_work;
    return BRUNT_OK;
}

// Boundary w holds nodes of a body; it is not `accounted` where they only get the velocities that it gave them once
// more.
static void hold_nodes(brunt_boundaries *boundaries, int w, brunt_body *body, double time, bool accounted) {
    brunt_boundary *boundary = &boundaries->boundary[w], silent;
    acting_symmetry s;
    if (!boundary->kind->hold_grid) return;
    if (!accounted) silent = *boundary;
    find_symmetry(boundaries, body, accounted, &s);
    const int axis = s.count && s.plane[0].boundary < 0; // the first: what is beyond it is held by itself
    boundary->kind->hold_grid(&(brunt_held_grid){body, s.plane + axis, s.count - axis, s.account + axis, boundary + 1,
                                                 boundaries->boundary_count - w - 1, time},
                              accounted ? boundary : &silent, time);
}

// Planes that stick or slip and regions, at the nodes of the grids; once more after what gives impulses to nodes that
// are held.
int brunt_pass_conditions(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)step;
    for (int i = 0; i < world->bodies.mpm_count; i++)
        if (brunt_condition_clear(&world->bodies.mpm[i], error))
            return brunt_fail_inner(&world->clock, &world->bodies.mpm[i], error);
    for (int w = 0; w < world->boundaries.boundary_count; w++) {
        const brunt_boundary *boundary = &world->boundaries.boundary[w];
        brunt_body *only = boundary->body < 0 ? NULL : world->bodies.all[boundary->body].mpm;
        if (only) hold_nodes(&world->boundaries, w, only, world->clock.time, true);
        for (int i = 0; i < world->bodies.mpm_count && boundary->body < 0; i++)
            hold_nodes(&world->boundaries, w, &world->bodies.mpm[i], world->clock.time, true);
    }
    return BRUNT_OK;
}

int brunt_pass_contact(brunt_world *world, brunt_step *step, brunt_error *error) {
    brunt_contact_context m = brunt_contact_context_of(world, step->dt, brunt_pass_timer(&world->timing));
    m.kick = step->kick;
    const brunt_contact *contact = &world->contact;
    int failed = contact->has_grid ? brunt_grid_velocity_apply(&m, &world->scratch.grid_velocity, error) : BRUNT_OK;
    if (contact->has_touches && !failed)
        failed = brunt_point_touches_apply(&m, contact->touch_sweeps, 0.1 * contact->def.tolerance,
                                           &world->scratch.point_touches, error);
    return failed ? brunt_fail_inner(&world->clock, NULL, error) : BRUNT_OK;
}

int brunt_pass_boundaries(brunt_world *world, brunt_step *step, brunt_error *error) {
    brunt_boundary_surfaces_open(&world->boundaries.surfaces, step->gravity, step->kick);
    brunt_contact_context m = brunt_contact_context_of(world, step->dt, NULL);
    m.kick = step->kick;
    for (int i = 0; i < world->bodies.mpm_count; i++)
        if (brunt_boundaries_meet_points(&m, &world->bodies.mpm[i], &world->scratch.planes, &world->contact.constraints,
                                         error))
            return brunt_fail_inner(&world->clock, &world->bodies.mpm[i], error);
    brunt_boundary_surfaces_close(&world->boundaries.surfaces, step->dt);
    return BRUNT_OK;
}

// The grid of a total-Lagrangian body is not where its weight acts.
static void account_gravity_moment(brunt_ledger *ledger, brunt_body *body, const double gravity[3], double dt) {
    const brunt_audit audit = brunt_body_audit(body);
    for (int a = 0; a < 3; a++) {
        const int k = (a + 1) % 3, l = (a + 2) % 3;
        ledger->gravity_angular[a] += dt * (audit.moment[k] * gravity[l] - audit.moment[l] * gravity[k]);
    }
}

static void account_gravity(brunt_ledger *ledger, const brunt_step *step, const brunt_node_sums *n, bool total) {
    const double *gravity = step->gravity, dt = step->kick;
    ledger->gravity_work += n->gravity_work;
    for (int a = 0; a < 3; a++) {
        int k = (a + 1) % 3, l = (a + 2) % 3;
        ledger->gravity_impulse[a] += dt * n->mass * gravity[a];
        if (total) continue;
        ledger->gravity_angular[a] += dt * (n->first_moment[k] * gravity[l] - n->first_moment[l] * gravity[k]);
    }
}

// Kinetic energy that the grid has before and after the forces, and what gravity did.
int brunt_pass_ledger(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)error;
    step->old_kinetic = step->new_kinetic = 0;
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        const bool total = brunt_total_lagrangian(&body->particles);
        brunt_grid_job job = grid_job(world, step, body);
        brunt_parallel(world->settings.threads, body->grid.slot_count, SLOT_GRAIN, brunt_grid_ledger, &job,
                       brunt_pass_timer(&world->timing));
        for (int32_t s = 0; s < body->grid.slot_count; s++) {
            const brunt_node_sums *n = &world->scratch.node_sums[s];
            step->old_kinetic += n->old_kinetic;
            step->new_kinetic += n->new_kinetic;
            if (world->settings.has_gravity) account_gravity(&world->ledger, step, n, total);
        }
        if (total && world->settings.has_gravity)
            account_gravity_moment(&world->ledger, body, step->gravity, step->kick);
    }
    return BRUNT_OK;
}

static void musl_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const body_job *job = context;
    for (int64_t b = begin; b < end; b++)
        job->world->transfers.musl_velocity(job->body, (int32_t)b, (real)job->dt, (real)job->kept,
                                            &job->world->scratch.points[worker]);
}

static void musl_body(brunt_world *world, brunt_body *body, double dt) {
    static const double weightless[3] = {0, 0, 0};
    brunt_timer *timer = brunt_pass_timer(&world->timing);
    const double kept = kept_of(&world->settings, body, dt);
    body_job job = {.world = world, .body = body, .dt = dt, .kept = kept}, still = {.world = world, .body = body};
    brunt_grid_job nodes = {.body = body, .gravity = weightless, .sums = world->scratch.node_sums};
    brunt_parallel(world->settings.threads, body->grid.block_count, BLOCK_GRAIN, musl_blocks, &job, timer);
    brunt_parallel(world->settings.threads, body->grid.block_count, BLOCK_GRAIN, p2g_blocks, &still, timer);
    brunt_parallel(world->settings.threads, body->grid.slot_count, SLOT_GRAIN, brunt_grid_sum, &nodes, timer);
    fold_symmetry(world, body, 1, false);
    brunt_parallel(world->settings.threads, body->grid.slot_count, SLOT_GRAIN, brunt_grid_update, &nodes, timer);
    int w;
    brunt_boundary_walk acting = brunt_boundaries_of(&world->boundaries.acting, body->index);
    while ((w = brunt_boundary_next(&acting)) != BRUNT_NONE)
        hold_nodes(&world->boundaries, w, body, world->clock.time, false);
}

// Linear kernel: the particles' new velocities once more to the grid, without forces, for the gradient. What conditions
// do to that field is no impulse: it is not recorded.
int brunt_pass_musl_velocity(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)error;
    for (int i = 0; i < world->bodies.mpm_count; i++) musl_body(world, &world->bodies.mpm[i], step->dt);
    return BRUNT_OK;
}

typedef struct g2p_sums {
    double power, musl_power, before; // [W] of the stress: after the step, of what remapping changed, before the step
} g2p_sums;

// The slot of the first particle whose update failed, -1: none.
static int64_t sum_reports(brunt_body *body, brunt_step *step, g2p_sums *sums, const char **reason) {
    int64_t bad = -1;
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        const brunt_block_report *report = &body->report[b];
        body->speed = report->speed > body->speed ? report->speed : body->speed;
        step->kinetic += report->kinetic;
        sums->power += report->stress_power;
        sums->musl_power += report->musl_power;
        sums->before += report->old_power;
        if (report->bad >= 0 && bad < 0) bad = report->bad, *reason = report->reason;
    }
    return bad;
}

// Where the step changes, the two halves of the kick are not alike: velocities are further behind the stress, or less,
// by which central differences gain or lose (dt_old^2 - dt^2) / 8 f^2 / m. That is recorded with the transfers, too.
int brunt_pass_g2p(brunt_world *world, brunt_step *step, brunt_error *error) {
    const double dt = step->dt, kick = step->kick;
    g2p_sums sums = {0, 0, 0};
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        const char *reason = NULL;
        body_job job = {world, body, dt, kept_of(&world->settings, body, dt)};
        body->uneven = kick != dt;
        body->speed = 0;
        brunt_parallel(world->settings.threads, body->grid.block_count, BLOCK_GRAIN, g2p_blocks, &job,
                       brunt_pass_timer(&world->timing));
        const int64_t bad = sum_reports(body, step, &sums, &reason);
        if (bad >= 0 && !step->status) step->status = brunt_fail_particle(world, body, bad, error, reason);
    }
    world->ledger.transfer -= 0.5 * (world->ledger.stress_work + dt * sums.musl_power + (dt - kick) * sums.before);
    world->ledger.stress_work = dt * sums.power;
    return BRUNT_OK;
}
