// Planes and boundary nodes: those that push (condition separate) and those that hold (stick, slip, symmetry).
#include "contact/planes/boundary_lists.h"
#include "contact/planes/condition.h"
#include "contact/search/node_to_facet_parts.h"
#include "contact/search/plane_contact.h"

static const double ON = 1e-6; // mean edges: how far off a plane a node may be and still lie on it

double brunt_plane_distance(const brunt_plane_def *plane, double time, const double x[3]) {
    double d = 0;
    for (int a = 0; a < 3; a++) d += plane->normal[a] * (x[a] - plane->point[a] - plane->velocity[a] * time);
    return d;
}

// Holds a node on a plane: stick takes all components, slip and symmetry the normal one. `back`: how much further its
// twin is, of a membrane; else 0.
static void fix_node(brunt_contact_surface *s, int32_t n, int32_t back, brunt_boundary *boundary,
                     double normal_velocity, bool stick) {
    const brunt_plane_def *plane = &boundary->plane;
    double now[3], J[3], old[3], along = 0;
    for (int a = 0; a < 3; a++) along += plane->normal[a] * (s->v[n][a] - plane->velocity[a]);
    for (int a = 0; a < 3; a++) {
        now[a] = stick ? plane->velocity[a] + normal_velocity * plane->normal[a]
                       : s->v[n][a] + (normal_velocity - along) * plane->normal[a];
        J[a] = s->mass[n] * (now[a] - s->v[n][a]);
        if (!(s->inverse[n][a] > 0)) now[a] = s->v[n][a], J[a] = 0;
        old[a] = s->old[n][a];
    }
    brunt_impulse_account_record(&boundary->last, &boundary->last.normal_loss, J, s->x[n], old, now, plane->velocity);
    for (int a = 0; a < 3; a++) {
        s->v[n][a] = now[a];
        if (stick || fabs(plane->normal[a]) > 1 - 1e-12) s->inverse[n][a] = 0;
    }
    if (!back) return;
    memcpy(s->v[n + back], s->v[n], sizeof *s->v);
    memcpy(s->inverse[n + back], s->inverse[n], sizeof *s->inverse);
}

// A plane that meets the surface.
typedef struct plane_job {
    const brunt_contact_context *m;
    brunt_boundary *boundary;
    brunt_node_to_facet *f;
    brunt_constraint_set *constraints;
} plane_job;

static int add_plane_constraint(const plane_job *j, int32_t n, int32_t back, double gap, brunt_error *error) {
    const brunt_contact_surface *s = j->m->surface;
    const brunt_plane_def *plane = &j->boundary->plane;
    brunt_constraint_set *constraints = j->constraints;
    double approach = 0, before = 0;
    for (int a = 0; a < 3; a++) {
        approach += plane->normal[a] * (s->v[n][a] - plane->velocity[a]);
        before += plane->normal[a] * (s->old[n][a] - plane->velocity[a]);
    }
    double target = brunt_node_to_facet_target(s, (double[]){gap, gap}, approach, before, j->m->dt);
    if (!(approach < target + 1e-6 * s->mean_edge / j->m->dt) && !brunt_node_holds(&j->f->touches, n, TOUCHED_PLANE))
        return BRUNT_OK;
    int32_t at = brunt_constraints_add(constraints, error),
            dof_node = brunt_node_to_facet_dof_node(j->f, s, n, constraints, error);
    if (at < 0 || dof_node < 0) return BRUNT_FAILED;
    brunt_constraint *constraint = &constraints->constraint[at];
    memcpy(constraint->x, s->x[n], sizeof constraint->x);
    memcpy(constraint->n, plane->normal, sizeof constraint->n);
    memcpy(constraint->plane, plane->velocity, sizeof constraint->plane);
    constraint->gap = gap, constraint->target = target, constraint->friction = plane->friction;
    constraint->account = &j->boundary->last, constraint->sign = 1, constraint->tag = n,
    constraint->area = brunt_node_to_facet_area(s, n, plane->normal);
    if (!back) constraint->touch = brunt_node_touch(&j->f->touches, n, TOUCHED_PLANE);
    constraint->partner = -1 - (int32_t)(j->boundary - j->m->boundaries);
    if (back) constraint->area += brunt_node_to_facet_area(s, n + back, plane->normal);
    return brunt_constraints_entry(constraints, dof_node, 1, error) < 0 ? BRUNT_FAILED : BRUNT_OK;
}

bool brunt_plane_near_surface(const brunt_contact_surface *s, int k, const brunt_boundary *boundary, double time,
                              double range) {
    double corner[3]; // of the box, deepest behind the plane
    for (int a = 0; a < 3; a++) corner[a] = boundary->plane.normal[a] > 0 ? s->low[k][a] : s->high[k][a];
    return brunt_plane_distance(&boundary->plane, time, corner) < range;
}

// What a plane does to a node that it may touch in this step.
static int meet_node(const plane_job *j, int32_t n, int32_t back, double gap, brunt_error *error) {
    brunt_contact_surface *s = j->m->surface;
    brunt_boundary *boundary = j->boundary;
    const double dt = j->m->dt;
    const brunt_condition_row *condition = &brunt_conditions[boundary->plane.condition];
    if (condition->pushes) {
        s->output.gap[n] = fmin(s->output.gap[n], gap);
        return add_plane_constraint(j, n, back, gap, error);
    }
    double along = 0;
    for (int a = 0; a < 3; a++) along += boundary->plane.normal[a] * (s->v[n][a] - boundary->plane.velocity[a]);
    if (gap <= ON * s->mean_edge)
        fix_node(s, n, back, boundary, 0, condition->sticks);
    else if (gap + along * dt < 0)
        fix_node(s, n, back, boundary, -gap / dt, condition->sticks);
    return BRUNT_OK;
}

int brunt_plane_meet_surface(const brunt_contact_context *m, brunt_boundary *boundary, brunt_node_to_facet *f,
                             brunt_constraint_set *set, brunt_error *error) {
    const brunt_contact_surface *s = m->surface;
    const double range = f->bodies.plane_travel + ON * s->mean_edge;
    const plane_job j = {.m = m, .boundary = boundary, .f = f, .constraints = set};
    int k, end;
    brunt_surface_meshes(s, boundary->body, &k, &end);
    for (; k < end; k++) {
        if (!s->active[k] || !brunt_plane_near_surface(s, k, boundary, m->time, range)) continue;
        const int32_t back = s->node_range[k + 1] - s->node_end[k];
        const double half =
            brunt_boundary_pushes(boundary) && s->membrane.side ? s->membrane.side[s->fem[k]->index].half : 0;
        for (int32_t n = s->node_range[k]; n < s->node_end[k]; n++) {
            const double gap = brunt_plane_distance(&boundary->plane, m->time, s->x[n]);
            if (!(gap > range) && meet_node(&j, n, back, gap - half, error)) return BRUNT_FAILED;
        }
    }
    return BRUNT_OK;
}

// The plane that keeps component a of a node from moving: of those that hold it, the nearest. -1: none.
static int fixing_plane(const brunt_contact_context *m, int32_t n, int a) {
    const brunt_contact_surface *s = m->surface;
    int nearest = -1, w;
    double least = INFINITY;
    brunt_boundary_walk acting = brunt_boundaries_of(m->acting, s->body[n]);
    while ((w = brunt_boundary_next(&acting)) != BRUNT_NONE) {
        const brunt_plane_def *plane = &m->boundaries[w].plane;
        if (!brunt_boundary_holds(&m->boundaries[w])) continue;
        if (!(brunt_condition_components(plane, 3) >> a & 1)) continue;
        double gap = brunt_plane_distance(plane, m->time, s->x[n]);
        if (gap < least) least = gap, nearest = w;
    }
    return nearest;
}

void brunt_node_to_facet_account_fixed(const brunt_contact_context *m, const brunt_node_to_facet *f,
                                       const brunt_constraint_set *constraints) {
    const brunt_contact_surface *s = m->surface;
    int k = 0;
    bool any = false;
    for (int w = 0; w < m->boundary_count; w++) any = any || brunt_boundary_holds(&m->boundaries[w]);
    for (int32_t n = 0; any && n < s->node_count; n++) {
        while (s->node_range[k + 1] <= n) k++;
        if (f->nodes.dof_of[n] < 0 || (s->membrane.front && s->membrane.front[n] != n)) continue;
        for (int a = 0; a < s->dim; a++) {
            if (s->inverse[n][a] > 0) continue;
            const double given = constraints->dof_node[f->nodes.dof_of[n]].impulse[a];
            if (given == 0) continue;
            if (s->fem[k]->held && s->fem[k]->held[s->node[n]] >> a & 1) continue; // by a group, which has its account
            int w = fixing_plane(m, n, a);
            if (w < 0) continue;
            double J[3] = {0};
            J[a] = -given;
            brunt_impulse_account *last = &m->boundaries[w].last;
            brunt_impulse_account_record(last, &last->normal_loss, J, s->x[n], s->old[n], s->v[n], s->v[n]);
        }
    }
}
