// Making a world from its definition: bodies filled, conditions sorted out, the plan made.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boundary/kinds.h"
#include "contact/planes/condition.h"
#include "boundary/ignition.h"
#include "contact/methods/method.h"
#include "base/error.h"
#include "geometry/axis.h"
#include "geometry/fill.h"
#include "base/simd.h"
#include "base/array.h"
#include "base/memory.h"
#include "mpm/sort.h"
#include "mpm/courant.h"
#include "base/parallel.h"
#include "world/create.h"

static int compare_names(const void *a, const void *b) {
    return strcmp((*(const brunt_body_def *const *)a)->name, (*(const brunt_body_def *const *)b)->name);
}

int brunt_find_ordered(const brunt_body_def **order, int count, const char *name) {
    int low = 0, high = count;
    while (low < high) {
        const int middle = (low + high) / 2, less = strcmp(order[middle]->name, name);
        if (less == 0) return middle;
        if (less < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return BRUNT_NONE;
}

// ------------------------------------------------------------------------------------------ start

int brunt_reports_make(brunt_world *world, brunt_error *error) {
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        if (BRUNT_CAPACITY(body->report, (size_t)body->grid.block_count, 0, "reports of blocks of particles", error))
            return BRUNT_FAILED;
        real *const *v = brunt_field(&body->particles, BRUNT_FIELD_velocity);
        for (int32_t b = 0; b < body->grid.block_count; b++) {
            const brunt_block *block = &body->grid.blocks[b];
            double fastest = 0;
            for (int64_t s = block->first; s < block->first + block->count; s++) {
                double square = 0;
                for (int a = 0; a < world->settings.dimension; a++) square += (double)(v[a][s] * v[a][s]);
                fastest = fmax(fastest, square);
            }
            body->report[b] =
                (brunt_block_report){.speed = (real)sqrt(fastest), .wave_speed = body->material.wave_speed, .bad = -1};
        }
    }
    return BRUNT_OK;
}

// How far body i reaches behind a plane [m]; 0 where that is rounding, or the edge of what the body is made of.
static double depth_behind(const brunt_world *world, const brunt_plane_def *plane, int i) {
    brunt_body *mpm = world->bodies.all[i].mpm;
    const brunt_fem_body *fem = world->bodies.all[i].fem;
    const int64_t count = mpm ? mpm->particles.slots : fem->node_count;
    real *const *x = mpm ? brunt_field(&mpm->particles, BRUNT_FIELD_position) : NULL;
    double least = 0, size = world->bodies.all[i].ops->fineness(&world->bodies.all[i]), far = 0;
    for (int64_t s = 0; s < count; s++) {
        double distance = 0;
        for (int a = 0; a < world->settings.dimension; a++) {
            const double place = (double)(mpm ? x[a][s] : brunt_fem_node(fem, (int32_t)s)[a]);
            distance += plane->normal[a] * (place - plane->point[a]);
            far = fmax(far, fabs(place));
        }
        least = fmin(least, distance);
    }
    return least < -(1e-3 * size + 1e-6 * far) ? -least : 0;
}

// Whether a plane goes through body i: there is more than an edge of it on both sides.
static bool goes_through(const brunt_world *world, const brunt_plane_def *plane, int i) {
    brunt_plane_def other = *plane;
    for (int a = 0; a < 3; a++) other.normal[a] = -plane->normal[a];
    return depth_behind(world, plane, i) > 0 && depth_behind(world, &other, i) > 0;
}

// Images are of what is on one side alone: what goes through a plane would be its own image, and what both sides have
// in common be lost. A plane that sticks holds all that is behind it from the start, which images cannot. Then nodes
// hold.
static void hold_what_is_behind(brunt_world *world) {
    brunt_boundaries *all = &world->boundaries;
    for (int k = all->symmetry_count - 1; k >= 0; k--) {
        const brunt_symmetry_plane *symmetry = &all->symmetry[k];
        bool behind = false;
        if (symmetry->boundary < 0) continue; // the axis of rings
        const brunt_boundary *boundary = &all->boundary[symmetry->boundary];
        for (int i = 0; i < world->bodies.count; i++)
            behind = behind || (world->bodies.all[i].mpm && brunt_boundary_acts_on(boundary, i) &&
                                (symmetry->sticks ? depth_behind(world, &boundary->plane, i) > 0
                                                  : goes_through(world, &boundary->plane, i)));
        if (!behind) continue;
        all->has_conditions = true;
        all->boundary[all->symmetry[k].boundary].symmetry_plane = BRUNT_NONE;
        all->symmetry_count--;
        for (int q = k; q < all->symmetry_count; q++) {
            all->symmetry[q] = all->symmetry[q + 1];
            all->boundary[all->symmetry[q].boundary].symmetry_plane = q;
        }
    }
}

// A plane of symmetry stands for what is behind it: what a body has there would be there twice.
static int check_symmetry(brunt_world *world, brunt_error *error) {
    for (int w = 0; w < world->boundaries.boundary_count; w++) {
        const brunt_boundary *boundary = &world->boundaries.boundary[w];
        if (!boundary->kind->is_plane || !brunt_conditions[boundary->plane.condition].images) continue;
        const int only = boundary->body, first = only < 0 ? 0 : only, end = only < 0 ? world->bodies.count : only + 1;
        for (int i = first; i < end; i++) {
            const double depth = depth_behind(world, &boundary->plane, i);
            if (depth > 0)
                REFUSE(
                    "bodies.%s: it reaches %.4g m behind the plane of symmetry '%s', which stands for what is there: "
                    "cut the body at the plane",
                    brunt_body_name(world, i), depth, boundary->name);
        }
    }
    hold_what_is_behind(world);
    return BRUNT_OK;
}

static int start(brunt_world *world, brunt_error *error) {
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        int status = brunt_sort(&body->grid, &body->particles, world->settings.threads, NULL, error);
        if (status) return status;
    }
    int status = brunt_reports_make(world, error);
    if (status) return status;
    for (int i = 0; i < world->bodies.mpm_count; i++)
        for (int32_t b = 0; b < world->bodies.mpm[i].grid.block_count; b++)
            world->bodies.mpm[i].speed =
                (real)fmax((double)world->bodies.mpm[i].speed, (double)world->bodies.mpm[i].report[b].speed);
    int32_t bad;
    const char *reason;
    if (brunt_fem_elements_all(world, 0, &bad, &reason))
        return brunt_fail(error, BRUNT_BAD_INPUT, "a mesh: %s", reason);
    brunt_clock_make(&world->clock, brunt_stable_step(world), world->settings.fixed_step);
    const brunt_accounts accounts = brunt_accounts_of(world);
    brunt_bodies_measure(&world->bodies, world->settings.threads);
    brunt_ledger_open(&world->ledger, &accounts);
    brunt_bodies_forget(&world->bodies);
    return BRUNT_OK;
}

// Points that fail and stay, or that are a fluid's, fly on alone, and bear pressure there. (What erosion keeps has no
// stress, and nothing to be unstable with.)
static void warn_of_lone_points(brunt_world *world) {
    const double limit =
        brunt_lone_points_cfl(world->settings.dimension, world->settings.given.kernel, world->settings.transfer);
    if (world->settings.fixed_step > 0 || world->settings.cfl <= limit * (1 + 1e-9)) return;
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        const brunt_body *body = &world->bodies.mpm[i];
        const bool softens = body->material.model[BRUNT_FAILURE] && !body->fails;
        if (!softens && !body->material.model[BRUNT_STRENGTH]->fluid) continue;
        if (limit > 0)
            brunt_warn(&world->messages,
                       "bodies.%s: material points that come away from others bear pressure alone, which with this "
                       "kernel and transfer is stable up to cfl %.2g; time.cfl is %.2g",
                       body->name, limit, world->settings.cfl);
        else
            brunt_warn(&world->messages,
                       "bodies.%s: material points that come away from others bear pressure alone, which with this "
                       "kernel and transfer is stable at no step: grid.kernel quadratic or cubic is wanted, or "
                       "grid.transfer flip or pic",
                       body->name);
    }
}

static int finish_explicit(brunt_world *world, const brunt_world_def *def, brunt_error *error) {
    int status = def->contact.allow_overlap ? BRUNT_OK : brunt_surfaces_overlap(world, error);
    if (!status)
        status = brunt_boundary_surfaces_sides(&world->boundaries.surfaces, &world->bodies, def->contact.allow_overlap,
                                               error);
    if (!status) status = brunt_check_fixed_step(world, error);
    if (!status) warn_of_lone_points(world);
    return status;
}

// Node numbers count from where the grid starts.
static void number_symmetry_planes(brunt_world *world, const brunt_world_def *def) {
    for (int m = 0; m < world->boundaries.symmetry_count; m++) {
        brunt_symmetry_plane *plane = &world->boundaries.symmetry[m];
        const double start = world->bodies.mpm[0].grid.origin[plane->axis];
        plane->node -= (int32_t)round((start - def->origin[plane->axis]) / def->cell);
    }
}

// Bodies, and what each thread works in.
static int reserve_arrays(brunt_world *world, int32_t bodies, brunt_error *error) {
    world->bodies.count = bodies;
    if (brunt_scratch_make(&world->scratch, world->settings.threads, error) ||
        BRUNT_NEW(world->bodies.all, bodies, "bodies", error) ||
        BRUNT_NEW(world->bodies.mpm, bodies, "bodies", error) || BRUNT_NEW(world->bodies.fem, bodies, "bodies", error))
        return BRUNT_FAILED;
    return BRUNT_NEW(world->bodies.mesh_reports, bodies, "reports of meshes", error);
}

// Load steps are steps of a pseudo-time from 0 to 1, over which gravity grows where nothing else is said.
static void go_static(brunt_world_def *def) {
    def->end = 1, def->step = 1.0 / def->load_steps;
    if (def->gravity_ramp == 0) def->gravity_ramp = 1;
}

brunt_world *brunt_world_create(const brunt_world_def *given, brunt_error *error) {
    if (error) *error = (brunt_error){.id = -1};
    if (brunt_definition_check(given, error)) return NULL;
    brunt_world_def own = *given;
    if (own.transfer == BRUNT_FLIP && own.flip == 0) own.transfer = BRUNT_PIC; // nothing of their own velocity is kept
    if (own.scheme == BRUNT_STATIC) go_static(&own);
    const brunt_world_def *def = &own;
    brunt_world *world;
    const brunt_body_def **order;
    if (BRUNT_NEW(world, 1, "world", error)) return NULL;
    if (BRUNT_NEW(order, def->body_count, "bodies in order of name", error)) {
        brunt_free(world);
        return NULL;
    }
    for (int i = 0; i < def->body_count; i++) order[i] = &def->bodies[i];
    qsort(order, (size_t)def->body_count, sizeof *order, compare_names);

    brunt_transfers_make(&world->transfers, def);
    brunt_timing_make(&world->timing);
    for (int i = 0; i < def->body_count; i++)
        world->bodies.has_particles = world->bodies.has_particles || order[i]->method == BRUNT_MPM;
    brunt_settings_make(&world->settings, def, world->bodies.has_particles);

    int status = reserve_arrays(world, def->body_count, error);
    if (!status) status = brunt_boundaries_make(world, def, order, error);
    if (!status) status = brunt_pairs_make(world, def, order, error);
    if (!status) status = brunt_bodies_make(world, def, order, error);
    if (!status) status = check_symmetry(world, error);
    world->boundaries.has_detonations = def->detonation_count > 0;
    if (!status) status = brunt_ignition_make(&world->bodies, def, &world->messages, error);
    if (!status) status = brunt_erosion_make(&world->erosion, &world->bodies, def, error);
    if (!status)
        status = brunt_node_sets_make(&world->boundaries.sets, def, &world->bodies,
                                      world->boundaries.boundary + brunt_boundary_first(def, "group"), &world->messages,
                                      error);
    if (!status)
        status = brunt_boundary_surfaces_make(&world->boundaries.surfaces, def, &world->bodies,
                                              world->boundaries.boundary, error);
    if (!status)
        status = brunt_boundary_lists_make(&world->boundaries.acting, world->boundaries.boundary,
                                           world->boundaries.boundary_count, world->bodies.count, error);
    if (!status) status = brunt_surfaces_make(world, def, error);
    if (!status) status = brunt_fem_tasks_make(world, error);
    if (!status) status = brunt_damping_make(&world->boundaries.damping, &world->bodies, error);
    if (!status) status = brunt_load_step_make(&world->boundaries.sets, error);
    if (!status) number_symmetry_planes(world, def);
    if (!status) status = brunt_bodies_number(&world->bodies, error);
    brunt_plan_make(&world->plan, world);
    if (!status) status = start(world, error);
    if (!status)
        status =
            def->scheme == BRUNT_EXPLICIT ? finish_explicit(world, def, error) : brunt_implicit_make(world, def, error);
    brunt_free(order);
    if (!status) {
        BRUNT_VALIDATE(world);
        return world;
    }
    brunt_world_destroy(world);
    return NULL;
}

void brunt_world_destroy(brunt_world *world) {
    if (!world) return;
    brunt_implicit_free(&world->plan, &world->bodies);
    brunt_scratch_free(&world->scratch, world->settings.threads);
    brunt_contact_free(&world->contact);
    brunt_boundaries_free(&world->boundaries);
    brunt_erosion_free(&world->erosion);
    brunt_pairs_free(&world->pairs);
    brunt_bodies_free(&world->bodies);
    brunt_messages_free(&world->messages);
    brunt_free(world);
}
