// Planes that push and let go, at zero gap.
//
// A plane acts on particles, not on nodes: a particle whose surface would be past the plane at the end of the step gets
// an impulse that just prevents it, given to the nodes with the particle's own weights. Planes of any direction and
// position work alike, and the block of a tilted ramp rests where its surface is. Each such particle is a constraint,
// with a friction point where the material meets the plane (particle_dof.h).
//
// Tried and left: conditions on the nodes behind the plane (the surface then depends on where the plane cuts the cells,
// by up to half a cell); Gauss-Seidel (the first particle visited takes the load of its neighbours, which need 50 to
// 200 sweeps to take it back, against about 10 here).
#include "contact/search/particle_plane.h"

#include <math.h>
#include <string.h>

#include "contact/distance/particle_extent.h"
#include "contact/planes/boundary_lists.h"
#include "contact/planes/condition.h"
#include "contact/search/overlap_spring.h"
#include "mpm/particles.h"

enum { MAX_SWEEPS = 16, MORE_SWEEPS = 64 };
static const double SWEEP_TOLERANCE =
    1e-2; // of the greatest correction of velocity in the first sweep: what is left is met again next step
static const double FINE_TOLERANCE = 1e-4; // ... where lines and meshes act
static const double NEAR = 0.5; // cells: how far from a plane particles are looked at, if nothing moves faster

typedef struct plane_job {
    const brunt_contact_context *m;
    brunt_body *body;
    brunt_boundary *boundary;
    brunt_particle_dofs *dofs;
    brunt_constraint_set *set;
    double offset, speed, near; // [m] of the plane along its normal, [m/s] along it, [m] gaps that are looked at
} plane_job;

static int add_friction_point(const plane_job *j, int32_t b, int64_t s, const double x[3], double distance,
                              brunt_error *error) {
    double arm[3], kernel_arm[3], at[3];
    brunt_particle_nodes at_arm;
    brunt_extent_arm(j->body, s, j->boundary->plane.normal, distance, arm, kernel_arm);
    for (int a = 0; a < 3; a++) at[a] = x[a] + arm[a];
    brunt_particle_nodes_find(j->body, b, s, kernel_arm, &at_arm);
    return brunt_particle_dofs_friction_point(j->body, &at_arm, at, j->dofs, j->set, error) < 0 ? BRUNT_FAILED
                                                                                                : BRUNT_OK;
}

// The constraint of a particle that the plane would catch in this step.
static int add_particle(const plane_job *j, int32_t b, int64_t s, const double x[3], double distance, double gap,
                        brunt_error *error) {
    const brunt_plane_def *plane = &j->boundary->plane;
    const int dim = j->body->grid.dim;
    const double spring = brunt_overlap_spring(j->m, j->body, s),
                 room = spring > 0 ? brunt_overlap_limit(j->body, distance - gap) : 0;
    const double target = j->speed - fmax(gap + room, 0) / j->m->dt;
    brunt_particle_nodes under;
    double v[3], approach = 0;
    brunt_particle_velocity(j->body, b, s, BRUNT_NODE_VELOCITY, v);
    for (int a = 0; a < dim; a++) approach += plane->normal[a] * v[a];
    if (!(spring > 0 && gap < 0) && approach > target + 1e-6 * (double)j->body->grid.h / j->m->dt) return BRUNT_OK;
    const int32_t at = brunt_constraints_add(j->set, error);
    if (at < 0) return BRUNT_FAILED;
    brunt_constraint *constraint = &j->set->constraint[at];
    memcpy(constraint->x, x, sizeof constraint->x);
    memcpy(constraint->n, plane->normal, sizeof constraint->n);
    memcpy(constraint->plane, plane->velocity, sizeof constraint->plane);
    constraint->gap = gap, constraint->target = target - j->speed, constraint->friction = plane->friction;
    constraint->spring = spring;
    constraint->account = &j->boundary->last, constraint->sign = 1, constraint->tag = j->dofs->tag;
    brunt_particle_nodes_find(j->body, b, s, NULL, &under);
    if (brunt_particle_dofs_enter(j->body, &under, 1, j->dofs, j->set, error)) return BRUNT_FAILED;
    return plane->friction > 0 ? add_friction_point(j, b, s, x, distance, error) : BRUNT_OK;
}

static int add_block(const plane_job *j, int32_t b, brunt_error *error) {
    brunt_particles *p = &j->body->particles;
    const brunt_plane_def *plane = &j->boundary->plane;
    const brunt_block *block = &j->body->grid.blocks[b];
    real *const *place = brunt_field(p, BRUNT_FIELD_position);
    for (int64_t s = block->first; s < block->first + block->count; s++) {
        double x[3] = {0}, distance = -j->offset;
        for (int a = 0; a < p->dim; a++) x[a] = (double)place[a][s], distance += plane->normal[a] * x[a];
        if (distance > j->near + 4 * (double)j->body->grid.h) continue;
        const double gap = distance - brunt_extent_along(j->body, s, plane->normal);
        if (!(gap > j->near) && add_particle(j, b, s, x, distance, gap, error)) return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

static int add_plane(plane_job *j, brunt_error *error) {
    const brunt_grid *grid = &j->body->grid;
    const brunt_plane_def *plane = &j->boundary->plane;
    const double h = (double)grid->h;
    double half = 0;
    j->offset = j->speed = 0;
    for (int a = 0; a < grid->dim; a++) {
        j->offset += plane->normal[a] * (plane->point[a] + plane->velocity[a] * j->m->time);
        j->speed += plane->normal[a] * plane->velocity[a];
        half += fabs(plane->normal[a]) * (0.5 * grid->side + 2) * h;
    }
    j->near = fmax(NEAR * h, ((double)j->body->speed + fabs(j->speed)) * j->m->dt);
    for (int32_t b = 0; b < grid->block_count; b++) {
        double middle = -j->offset;
        for (int a = 0; a < grid->dim; a++)
            middle += plane->normal[a] * (grid->origin[a] + h * (grid->blocks[b].coord[a] + 0.5) * grid->side);
        if (middle > half + j->near + 4 * h && !brunt_total_lagrangian(&j->body->particles)) continue;
        if (add_block(j, b, error)) return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

int brunt_plane_meet_points(const brunt_contact_context *m, brunt_boundary *boundary, brunt_body *body,
                            brunt_particle_dofs *dofs, brunt_constraint_set *set, brunt_error *error) {
    plane_job j = {.m = m, .body = body, .boundary = boundary, .dofs = dofs, .set = set};
    return brunt_boundary_pushes(boundary) ? add_plane(&j, error) : BRUNT_OK;
}

// Lines and meshes hold and stick, too: what sweeps leave of that is slip, which no later step takes back.
static int solve(const brunt_contact_context *m, brunt_constraint_set *set, bool further, brunt_error *error) {
    if (!further) return brunt_constraints_solve(set, MAX_SWEEPS, SWEEP_TOLERANCE, m->threads, m->timer, error);
    set->accelerated = true;
    const int status = brunt_constraints_solve(set, MORE_SWEEPS, FINE_TOLERANCE, m->threads, m->timer, error);
    set->accelerated = false;
    return status;
}

int brunt_boundaries_meet_points(const brunt_contact_context *m, brunt_body *body, brunt_particle_dofs *dofs,
                                 brunt_constraint_set *set, brunt_error *error) {
    if (brunt_particle_dofs_begin(m, body, dofs, error)) return BRUNT_FAILED;
    brunt_constraints_clear(set);
    set->kick = m->kick;
    int w;
    bool further = false, met = false;
    brunt_boundary_walk acting = brunt_boundaries_of(m->acting, body->index);
    while ((w = brunt_boundary_next(&acting)) != BRUNT_NONE) {
        brunt_boundary *boundary = &m->boundaries[w];
        if (!boundary->kind->meet_points) continue;
        const int32_t before = set->constraint_count;
        if (boundary->kind->meet_points(m, boundary, body, dofs, set, error)) return BRUNT_FAILED;
        met = met || boundary->kind->met_points;
        further = further || (boundary->kind->met_points && set->constraint_count > before);
    }
    if (solve(m, set, further, error)) return BRUNT_FAILED;
    acting = brunt_boundaries_of(m->acting, body->index);
    while (met && (w = brunt_boundary_next(&acting)) != BRUNT_NONE)
        if (m->boundaries[w].kind->met_points) m->boundaries[w].kind->met_points(m, &m->boundaries[w], body, set);
    brunt_particle_dofs_scatter(m, body, dofs, set);
    return BRUNT_OK;
}
