// The surfaces of meshes and what they meet: each other, particles, planes.
#include <math.h>
#include <string.h>

#include "error.h"
#include "memory.h"
#include "world.h"

enum { SWEEPS = 16 };

static bool acts_on_fem(const brunt_world *world, const brunt_wall *wall) {
    if (wall->region) return false;
    for (int k = 0; k < world->fem_count; k++)
        if (wall->body < 0 || wall->body == world->fems[k].index) return true;
    return false;
}

// Smallest and largest mean edge among the bodies, for the choice of the contact grid.
static void look_at_edges(const brunt_world *world, double *fine, double *coarse) {
    *fine = INFINITY, *coarse = 0;
    for (int k = 0; k < world->fem_count; k++) {
        *fine = fmin(*fine, world->fems[k].mean_edge);
        *coarse = fmax(*coarse, world->fems[k].mean_edge);
    }
}

int brunt_surfaces_make(brunt_world *world, const brunt_world_def *def, brunt_error *error) {
    for (int w = 0; w < world->wall_count; w++)
        world->has_surfaces = world->has_surfaces || acts_on_fem(world, &world->walls[w]);
    world->has_surfaces = world->has_surfaces || world->has_augury;
    if (!world->has_surfaces) return BRUNT_OK;
    world->contact = def->contact;
    world->contact.pairs = NULL, world->contact.pair_count = 0;
    const brunt_augury_form form = def->contact.form;
    if (world->contact.iterations < 0)
        world->contact.iterations = form == BRUNT_AUGURY_PAPER ? 1 : form == BRUNT_AUGURY_AFFINE ? SWEEPS : 4;
    brunt_fem_body **fems = brunt_alloc((size_t)(world->fem_count + 1) * sizeof *fems);
    if (!fems) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    for (int k = 0; k < world->fem_count; k++) fems[k] = &world->fems[k];
    int failed = brunt_skin_make(&world->skin, fems, world->fem_count, world->has_augury && form == BRUNT_AUGURY_PAPER);
    brunt_free(fems);
    if (failed) return brunt_fail(error, BRUNT_FAILED, "out of memory for the bodies' surfaces");
    double fine, coarse;
    look_at_edges(world, &fine, &coarse);
    world->contact_cell = def->contact.cell > 0 ? def->contact.cell : form == BRUNT_AUGURY_PAPER ? 2 * coarse : coarse;
    if (!world->has_augury || form == BRUNT_AUGURY_AFFINE) return BRUNT_OK;
    if (world->contact_cell < 0.7 * coarse)
        brunt_warn(world,
                   "contact.cell %g m is less than 0.7 of the longest mean edge, %g m: nodes may pass between those of "
                   "the other body unseen",
                   world->contact_cell, coarse);
    if (world->contact_cell > 4 * fine)
        brunt_warn(world,
                   "contact.cell %g m is more than 4 of the shortest mean edge, %g m: edges and corners are rounded by "
                   "as much",
                   world->contact_cell, fine);
    return BRUNT_OK;
}

static int meet_by_facets(brunt_world *world, const brunt_meeting *m) {
    brunt_contact_points *points = &world->points;
    brunt_points_clear(points);
    int failed = brunt_facing_walls(m, world->walls, world->wall_count, world->now.time, world->facing, points);
    if (!failed && world->has_augury && world->contact.form == BRUNT_AUGURY_AFFINE)
        failed = brunt_facing_find(m, world->bodies, world->body_count, world->facing, points);
    int sweeps = world->contact.form == BRUNT_AUGURY_AFFINE ? world->contact.iterations : SWEEPS;
    if (!failed && brunt_points_solve(points, sweeps, m->threads, m->seconds) < 0) failed = -1;
    if (!failed) brunt_facing_finish(m, world->bodies, world->facing, points);
    return failed;
}

int brunt_surfaces_meet(brunt_world *world, const double gravity[3], double kick, double dt, brunt_error *error) {
    double *seconds = world->pass[BRUNT_PASS_surfaces].thread_seconds;
    brunt_meeting m = {
        .skin = &world->skin,
        .pairs = world->pairs,
        .pair_of = world->pair_of,
        .body_count = world->all_count,
        .dt = dt,
        .cell = world->contact_cell,
        .iterations = world->contact.iterations,
        .look = world->has_augury && world->contact.form != BRUNT_AUGURY_AFFINE ? 1.6 * world->contact_cell : 0,
        .step = (int64_t)world->now.steps,
        .threads = world->threads,
        .seconds = seconds};
    memcpy(world->skin.frame, world->now.contact_frame, sizeof world->skin.frame);
    brunt_skin_bounds(&world->skin, world->threads, seconds);
    int failed = brunt_facing_near(&m, world->bodies, world->body_count, world->walls, world->wall_count,
                                   world->now.time, &world->facing);
    if (!failed) {
        if (world->has_augury && world->contact.form == BRUNT_AUGURY_PAPER) // acts on every surface, touched or not
            for (int k = 0; k < world->fem_count; k++) world->skin.active[k] = true;
        brunt_skin_take(&world->skin, kick, gravity, world->threads, seconds);
        if (world->has_augury && world->contact.form == BRUNT_AUGURY_PAPER)
            failed = brunt_augury_paper(&m, world->contact.transfer, &world->augury);
        else if (world->has_augury && world->contact.form != BRUNT_AUGURY_AFFINE)
            failed = brunt_augury_surface(&m, world->contact.form == BRUNT_AUGURY_SMOOTH, &world->augury);
    }
    if (!failed) failed = meet_by_facets(world, &m);
    if (failed) return brunt_fail(error, BRUNT_FAILED, "out of memory in the contact of surfaces");
    brunt_skin_give(&world->skin, dt, world->threads, seconds);
    memcpy(world->now.contact_frame, world->skin.frame, sizeof world->skin.frame);
    brunt_fem_hold_contact(world);
    return BRUNT_OK;
}
