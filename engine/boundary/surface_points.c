// Lines and surfaces in explicit steps: material points that touch them.
//
// Each point that touches a facet, or would within the step, is a constraint with the point's own weights, as at
// planes, and is solved with those: what it may do is said by the motion of the facet there. Friction acts where the
// two meet. Pieces have what their points took: tractions, for pictures and reports.
//
// Tried and left: rows of boundary particles, as implicit steps have. A node that hardly any material reaches then
// takes the impulse, as no stiffness ties it to the others within a step: in a bar that flies at its end 2e-4 of the
// mass of a cell did, the bar went 0.015 cells into the boundary, and the force swung by 3 % of rho c v. With a point's
// own weights 0.7 of it does, 9e-4 cells, 1.3 %.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/check.h"
#include "base/vector.h"
#include "boundary/boundary_surface.h"
#include "boundary/curve.h"
#include "contact/distance/particle_extent.h"
#include "contact/search/overlap_spring.h"
#include "contact/search/particle_dof.h"

static const double NEAR = 0.1;     // cells: gaps that are looked at, beside how far things go in a step
static const double HOLD = 1.2;     // of its extent: from how far a point is held, as in implicit steps
static const double AGAINST = -0.5; // cosine between normals of the two sides of a thin wall
// What is behind is pushed out, but no faster than with this share of the speed at which it came: no push gains energy.
// What does not come stays as deep as it is.
//
// Tried and left: lifting what is pressed, by a hundredth of what its load brings in a step. A wedge that a block flows
// past presses on the same points all the time, which turn and reach farther than they did, so that they are never out:
// it gave the block up to 1.3 % of its work, on finer grids more.
static const double RESTITUTION = 0.5, CORRECTION = 0.2;

// ------------------------------------------------------------------------------------------ motion

brunt_placement brunt_boundary_surface_place(const brunt_boundary_surface *s, double time) {
    const brunt_rotation_def *by = &s->def.rotation;
    if (s->tool.free) return brunt_tool_place(&s->tool);
    brunt_placement place = brunt_placement_identity();
    double way[3];
    if (by->angle != 0)
        place = brunt_placement_rotate(place, by->axis, by->angle * brunt_curve_at(&s->def.table, time), by->about);
    brunt_boundary_surface_way(s, time, way);
    for (int a = 0; a < 3; a++) place.translation[a] += way[a];
    return place;
}

static void into(const brunt_placement *place, const double x[3], double out[3]) {
    for (int a = 0; a < 3; a++) {
        out[a] = 0;
        for (int b = 0; b < 3; b++) out[a] += place->rotation[3 * b + a] * (x[b] - place->translation[b]);
    }
}

static void turn(const brunt_placement *place, const double n[3], double out[3]) {
    for (int a = 0; a < 3; a++) {
        out[a] = 0;
        for (int b = 0; b < 3; b++) out[a] += place->rotation[3 * a + b] * n[b];
    }
}

// The greatest rate at which the table changes, or what it is at most.
static double greatest(const brunt_curve *table, bool rate) {
    double most = rate || table->count ? 0 : 1;
    for (int32_t k = 0; k < table->count; k++) {
        const double *p = table->points[k], *q = table->points[k > 0 ? k - 1 : 0];
        if (!rate) most = fmax(most, fabs(p[1]));
        if (rate && p[0] > q[0]) most = fmax(most, fabs((p[1] - q[1]) / (p[0] - q[0])));
    }
    return most;
}

void brunt_boundary_surface_hurry(brunt_boundary_surface *s) {
    double spin[3];
    brunt_tool_spin(&s->tool, spin);
    s->speed[0] = sqrt(dot(s->tool.v, s->tool.v)) + s->lever * sqrt(dot(spin, spin));
}

int brunt_boundary_surface_points(brunt_boundary_surface *s, const brunt_boundary_surface_def *def,
                                  const brunt_world_def *world, brunt_error *error) {
    double square = 0;
    brunt_tool_make(&s->tool, def, world->dimension, world->axisymmetric);
    if (brunt_facets_make(&s->facets, def, world->dimension, error) ||
        BRUNT_NEW(s->rate, (size_t)s->pieces + 1, "pieces of a boundary", error))
        return BRUNT_FAILED;
    for (int a = 0; a < 3; a++) square += def->value[a] * def->value[a];
    for (int32_t k = 0; k < def->point_count; k++) {
        const double *x = def->point[k], *about = s->tool.free ? def->center : def->rotation.about;
        s->lever = fmax(s->lever, hypot(hypot(x[0] - about[0], x[1] - about[1]), x[2] - about[2]));
    }
    s->speed[0] = sqrt(square) * greatest(&s->def.table, def->displacement) +
                  fabs(def->rotation.angle) * s->lever * greatest(&s->def.table, true);
    if (s->tool.free) brunt_boundary_surface_hurry(s);
    return BRUNT_OK;
}

const double *brunt_boundary_surface_speed(const brunt_boundary *boundary) {
    static const double still[3] = {0, 0, 0};
    return boundary->surface ? boundary->surface->speed : still;
}

// ------------------------------------------------------------------------------------------ what touches

typedef struct surface_job {
    const brunt_contact_context *m;
    brunt_boundary *boundary;
    brunt_boundary_surface *s;
    brunt_body *body;
    brunt_particle_dofs *dofs;
    brunt_constraint_set *set;
    brunt_placement now, then; // of the surface, at the start of the step and at its end
    double near;               // [m] gaps that are looked at
} surface_job;

// A material point that looks, and where it may meet the surface.
typedef struct point {
    int32_t block;
    int64_t slot;
    double x[3];
    brunt_particle_nodes under;
} point;

static bool leaves(const surface_job *j) { return j->s->def.condition == BRUNT_SEPARATE; }

// Which of the places around a point hold it: of what it may leave those before it and the nearest of those behind it,
// but for the other side of a thin wall.
static int admit(const surface_job *j, brunt_touch *touch, int count) {
    int nearest = -1, behind = -1, kept = 0;
    for (int k = 0; k < count; k++) {
        if (nearest < 0 || fabs(touch[k].distance) < fabs(touch[nearest].distance)) nearest = k;
        if (touch[k].distance < 0 && (behind < 0 || touch[k].distance > touch[behind].distance)) behind = k;
    }
    if (!leaves(j) && j->s->def.condition == BRUNT_STICK && count > 0) {
        touch[0] = touch[nearest];
        return !touch[0].rim;
    }
    const brunt_touch first = count ? touch[nearest] : (brunt_touch){.distance = 0};
    for (int k = 0; k < count; k++) {
        const bool against = k != nearest && dot(touch[k].normal, first.normal) < AGAINST;
        if (touch[k].rim && (!leaves(j) || touch[k].distance < 0)) continue;
        if (leaves(j) && (against || (touch[k].distance < 0 && k != behind))) continue;
        touch[kept++] = touch[k];
    }
    return kept;
}

// The mean velocity of the surface's place at `at` over the step, and the normal as it is now.
static void move_with(const surface_job *j, const brunt_touch *touch, double n[3], double v[3]) {
    double start[3], end[3];
    turn(&j->now, touch->normal, n);
    turn(&j->now, touch->at, start), turn(&j->then, touch->at, end);
    for (int a = 0; a < 3; a++) v[a] = (end[a] - start[a] + j->then.translation[a] - j->now.translation[a]) / j->m->dt;
}

// How fast what is behind is pushed out [m/s].
static double push_out(const surface_job *j, double gap, double before) {
    return gap < 0 ? fmin(CORRECTION * -gap / j->m->dt, RESTITUTION * fmax(0, -before)) : 0;
}

// The rate along n at which a point has to go at least, beside the surface's; false: it is not met.
static bool find_target(const surface_job *j, const point *p, const double n[3], const double v[3], double gap,
                        double room, double *target) {
    const brunt_grid *grid = &j->body->grid;
    double now[3], old[3], approach = 0, before = 0;
    *target = 0;
    if (!leaves(j)) return true;
    brunt_particle_nodes_velocity(&p->under, grid->dim, BRUNT_NODE_VELOCITY, now);
    brunt_particle_nodes_velocity(&p->under, grid->dim, BRUNT_NODE_OLD, old);
    for (int a = 0; a < grid->dim; a++) approach += n[a] * (now[a] - v[a]), before += n[a] * (old[a] - v[a]);
    gap += room;
    *target = gap < 0 ? push_out(j, gap, before) : -gap / j->m->dt;
    return gap < room || approach <= *target + 1e-6 * (double)grid->h / j->m->dt;
}

// The boundary particle that is nearest to a place on the surface, as it was at the start.
static int32_t nearest_particle(const brunt_boundary_surface *s, const double at[3]);

static int rub(const surface_job *j, const point *p, const double n[3], double distance, brunt_error *error) {
    double arm[3], kernel_arm[3], at[3];
    brunt_particle_nodes at_arm;
    brunt_extent_arm(j->body, p->slot, n, distance, arm, kernel_arm);
    for (int a = 0; a < 3; a++) at[a] = p->x[a] + arm[a];
    brunt_particle_nodes_find(j->body, p->block, p->slot, kernel_arm, &at_arm);
    if (brunt_particle_dofs_friction_point(j->body, &at_arm, at, j->dofs, j->set, error) < 0) return BRUNT_FAILED;
    if (j->s->tool.free) brunt_tool_rub(&j->s->tool, at, j->set);
    return BRUNT_OK;
}

static int add_touch(const surface_job *j, point *p, const brunt_touch *touch, brunt_error *error) {
    brunt_boundary_surface *s = j->s;
    double n[3], v[3], target;
    move_with(j, touch, n, v);
    const double extent = brunt_extent_along(j->body, p->slot, n), gap = touch->distance - extent;
    const double spring = leaves(j) ? brunt_overlap_spring(j->m, j->body, p->slot) : 0,
                 room = spring > 0 ? brunt_overlap_limit(j->body, extent) : extent;
    if (leaves(j) ? gap > j->near || touch->distance < -room : fabs(touch->distance) > HOLD * extent) return BRUNT_OK;
    if (!p->under.count) brunt_particle_nodes_find(j->body, p->block, p->slot, NULL, &p->under);
    if (!find_target(j, p, n, v, gap, spring > 0 ? room : 0, &target)) return BRUNT_OK;
    const int32_t at = brunt_constraints_add(j->set, error);
    if (at < 0 || BRUNT_CAPACITY_MORE(s->touching, "material points at a boundary", error)) return BRUNT_FAILED;
    s->touching[s->touching_count++] = (brunt_touching){at, nearest_particle(s, touch->at)};
    brunt_constraint *c = &j->set->constraint[at];
    memcpy(c->x, p->x, sizeof c->x), memcpy(c->n, n, sizeof c->n);
    if (!s->tool.free) memcpy(c->plane, v, sizeof c->plane);
    c->gap = gap, c->target = target;
    c->spring = spring, c->least = leaves(j) ? 0 : -INFINITY, c->sticks = s->def.condition == BRUNT_STICK;
    c->friction = c->sticks ? 1 : s->def.friction;
    c->account = &j->boundary->last, c->sign = 1, c->tag = j->dofs->tag;
    c->area = pow(j->body->spacing, j->body->particles.dim - 1);
    const double friction = c->friction;
    if (brunt_particle_dofs_enter(j->body, &p->under, 1, j->dofs, j->set, error)) return BRUNT_FAILED;
    if (s->tool.free && brunt_tool_enter(&s->tool, p->x, j->set, error)) return BRUNT_FAILED;
    return friction > 0 ? rub(j, p, n, touch->distance, error) : BRUNT_OK;
}

// How far what the point in a slot has around it goes at most [m], whatever the direction.
static double extent_of(brunt_particles *p, int64_t slot) {
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    double square = 0;
    for (int k = 0; k < p->dim * p->point_dim; k++) square += (double)F[k][slot] * (double)F[k][slot];
    return (double)brunt_field(p, BRUNT_FIELD_reach)[0][slot] * sqrt(square);
}

static bool is_outside(const brunt_facets *f, const double x[3], double range) {
    for (int a = 0; a < f->dim; a++)
        if (!(x[a] >= f->low[a] - range && x[a] <= f->high[a] + range)) return true;
    return false;
}

static int add_block(const surface_job *j, int32_t b, brunt_error *error) {
    brunt_particles *particles = &j->body->particles;
    const brunt_block *block = &j->body->grid.blocks[b];
    real *const *place = brunt_field(particles, BRUNT_FIELD_position);
    const double far = j->near + 4 * (double)j->body->grid.h;
    for (int64_t slot = block->first; slot < block->first + block->count; slot++) {
        brunt_touch touch[BRUNT_TOUCH_LIMIT];
        double x[3], at[3] = {0};
        for (int a = 0; a < particles->dim; a++) at[a] = (double)place[a][slot];
        into(&j->now, at, x);
        if (is_outside(&j->s->facets, x, far)) continue;
        const double extent = extent_of(particles, slot),
                     range = fmin(far, leaves(j) ? j->near + extent : HOLD * extent);
        const int count = admit(j, touch, brunt_facets_near(&j->s->facets, x, range, touch));
        if (!count) continue;
        point p;
        p.block = b, p.slot = slot, p.under.count = 0;
        memcpy(p.x, at, sizeof p.x);
        for (int k = 0; k < count; k++) BRUNT_TRY(add_touch(j, &p, &touch[k], error));
    }
    return BRUNT_OK;
}

// Whether the points of blocks with these coordinates are all too far away. Those of a total-Lagrangian body are not
// where its nodes are.
static bool is_far(const surface_job *j, const int32_t low[3], const int32_t high[3]) {
    const brunt_grid *grid = &j->body->grid;
    const double h = (double)grid->h;
    double middle[3] = {0}, x[3], square = 0;
    if (brunt_total_lagrangian(&j->body->particles)) return false;
    for (int a = 0; a < grid->dim; a++) {
        const double half = 0.5 * h * ((high[a] + 1 - low[a]) * grid->side + 1);
        middle[a] = grid->origin[a] + h * (low[a] * grid->side + 0.5 * grid->order - 1) + half;
        square += half * half;
    }
    into(&j->now, middle, x);
    return brunt_facets_are_far(&j->s->facets, x, sqrt(square) + j->near + 4 * h);
}

// The same of all blocks.
static bool all_far(const surface_job *j) {
    const brunt_grid *grid = &j->body->grid;
    if (!grid->block_count) return true;
    int32_t low[3], high[3];
    memcpy(low, grid->blocks[0].coord, sizeof low), memcpy(high, low, sizeof high);
    for (int32_t b = 1; b < grid->block_count; b++)
        for (int a = 0; a < grid->dim; a++) {
            const int32_t at = grid->blocks[b].coord[a];
            low[a] = at < low[a] ? at : low[a], high[a] = at > high[a] ? at : high[a];
        }
    return is_far(j, low, high);
}

int brunt_boundary_surface_meet(const brunt_contact_context *m, brunt_boundary *boundary, brunt_body *body,
                                brunt_particle_dofs *dofs, brunt_constraint_set *set, brunt_error *error) {
    brunt_boundary_surface *s = boundary->surface;
    surface_job j = {.m = m, .boundary = boundary, .s = s, .body = body, .dofs = dofs, .set = set};
    j.now = brunt_boundary_surface_place(s, m->time), j.then = brunt_boundary_surface_place(s, m->time + m->dt);
    if (s->tool.free) j.then = brunt_tool_place_after(&s->tool, m->dt), s->tool.node = BRUNT_NONE;
    j.near = NEAR * (double)body->grid.h + ((double)body->speed + s->speed[0]) * m->dt;
    s->touching_count = 0;
    if (all_far(&j)) return BRUNT_OK;
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        const int32_t *at = body->grid.blocks[b].coord;
        if (!is_far(&j, at, at)) BRUNT_TRY(add_block(&j, b, error));
    }
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ what came of it

static void compare(const brunt_boundary_surface *s, int32_t b, const double at[3], double *least, int32_t *best) {
    double square = 0;
    for (int a = 0; a < 3; a++) square += (s->particle[b].x[a] - at[a]) * (s->particle[b].x[a] - at[a]);
    if (square < *least) *least = square, *best = b;
}

static int32_t nearest_particle(const brunt_boundary_surface *s, const double at[3]) {
    int32_t best = BRUNT_NONE, cell[3], near[3];
    double least = INFINITY;
    for (int a = 0; a < 3; a++) cell[a] = (int32_t)floor((at[a] - s->low[a]) / s->cell);
    for (int k = 0; k < 27; k++) {
        near[0] = cell[0] + k / 9 - 1, near[1] = cell[1] + k / 3 % 3 - 1, near[2] = cell[2] + k % 3 - 1;
        const int32_t c = brunt_boundary_surface_cell(s, near);
        for (int32_t i = c < 0 ? 0 : s->cell_first[c]; c >= 0 && i < s->cell_first[c + 1]; i++)
            compare(s, s->cell_particle[i], at, &least, &best);
    }
    if (best >= 0) return best;
    for (int32_t b = 0; b < s->particle_count; b++) compare(s, b, at, &least, &best); // few a cell, and far apart
    return best;
}

void brunt_boundary_surfaces_open(brunt_boundary_surfaces *surfaces, const double gravity[3], double kick) {
    for (int k = 0; k < surfaces->count; k++) {
        brunt_boundary_surface *s = &surfaces->surface[k];
        s->active = 0, s->drift = 0;
        if (!s->tool.free) continue;
        brunt_tool_begin(&s->tool, gravity, kick);
        brunt_boundary_surface_hurry(s);
    }
}

void brunt_boundary_surfaces_close(brunt_boundary_surfaces *surfaces, double dt) {
    for (int k = 0; k < surfaces->count; k++) {
        brunt_boundary_surface *s = &surfaces->surface[k];
        if (!s->tool.free) continue;
        brunt_tool_end(&s->tool, dt, &s->boundary->last);
        brunt_boundary_surface_hurry(s);
    }
}

// Area of a piece [m^2], in plane strain [m]; of what stands for a circle all of that.
static double area_of(const brunt_boundary_surface *s, int32_t piece, bool axisymmetric) {
    double sum = 0;
    for (int32_t b = s->first[piece]; b < s->first[piece + 1]; b++)
        sum += s->particle[b].weight * (axisymmetric ? 2 * 3.14159265358979323846 * fabs(s->particle[b].x[0]) : 1);
    return sum;
}

// Adds what a constraint gave to the traction of its piece, along the directions that this has: minus the impulse.
static void add_impulse(const brunt_boundary_surface *s, const brunt_touching *t, const brunt_placement *place,
                        const brunt_constraint *c, double *traction) {
    const brunt_boundary_particle *particle = &s->particle[t->particle];
    double J[3], here[3], direction[3];
    for (int a = 0; a < 3; a++) J[a] = c->normal_impulse * c->n[a] + c->friction_impulse[a];
    for (int a = 0; a < 3; a++) {
        here[a] = 0;
        for (int b = 0; b < 3; b++) here[a] += place->rotation[3 * b + a] * J[b];
    }
    const int rows = brunt_boundary_surface_rows(s, s->facets.dim);
    for (int k = 0; k < rows; k++) {
        brunt_boundary_surface_direction(s, particle, k, direction);
        traction[3 * (size_t)particle->piece + (size_t)k] -= dot(here, direction);
    }
}

// The pieces of which points were held, or pushed; how fast what is held leaves, as mean over a piece.
static void close_pieces(brunt_boundary_surface *s, const brunt_contact_context *m, bool axisymmetric,
                         double *traction) {
    for (int32_t piece = 0; piece < s->pieces; piece++) {
        if (!(s->rate[piece][1] > 0)) continue;
        const double scale = m->kick * area_of(s, piece, axisymmetric);
        for (int k = 0; k < 3; k++) traction[3 * (size_t)piece + (size_t)k] /= scale;
        s->active++;
        s->drift = fmax(s->drift, fabs(s->rate[piece][0]) / s->rate[piece][1]);
    }
}

void brunt_boundary_surface_met(const brunt_contact_context *m, brunt_boundary *boundary, const brunt_body *body,
                                const brunt_constraint_set *set) {
    brunt_boundary_surface *s = boundary->surface;
    double *traction = s->traction + 3 * (size_t)(body - m->mpm) * (size_t)s->pieces;
    const brunt_placement place = brunt_boundary_surface_place(s, m->time);
    memset(traction, 0, 3 * (size_t)s->pieces * sizeof *traction);
    memset(s->rate, 0, (size_t)s->pieces * sizeof *s->rate);
    for (int32_t k = 0; k < s->touching_count; k++) {
        const brunt_constraint *c = &set->constraint[s->touching[k].constraint];
        double *rate = s->rate[s->particle[s->touching[k].particle].piece], u[3];
        if (!brunt_constraint_acts(c)) continue;
        add_impulse(s, &s->touching[k], &place, c, traction);
        brunt_constraint_velocity(set, c, false, u);
        if (c->least < 0) rate[0] += dot(u, c->n);
        rate[1]++;
    }
    close_pieces(s, m, brunt_axisymmetric(&body->particles), traction);
    if (s->tool.free) brunt_tool_take(&s->tool, set);
}
