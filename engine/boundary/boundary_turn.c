// Lines and surfaces that turn, over an implicit step.
//
// Particle b goes from x_b to x_b + d_b within the step, as the surface is at its start and at its end. What sticks
// goes with it: the mean over a piece of its way is that of the rigid motion, taken at the nodes that the piece sees,
// so that a body that moves as a whole does so without a force. What slips or may leave is asked for along the normal n
// of the middle of the step, at the particle's place x_b + (d_b - n (n . d_b)) / 2: on the surface where it is at the
// start, as material is, half way along it. Then the work of a traction is its force times the way, a circle that turns
// about its own middle asks for nothing and has no moment but that of friction, and a plane takes what does not slide
// on it along exactly. What slides by s while it turns by an angle is off by half the product of both.
#include "boundary/boundary_surface.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vector.h"
#include "boundary/curve.h"

static const double MOST = 1.5707963267948966; // [rad] within a step

static void rotate(const double R[9], const double x[3], double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = dot(R + 3 * a, x);
}

static void rotate_back(const double R[9], const double x[3], double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = R[a] * x[0] + R[3 + a] * x[1] + R[6 + a] * x[2];
}

int brunt_boundary_turned_make(brunt_boundary_surface *s, brunt_error *error) {
    if (s->def.rotation.angle == 0) return BRUNT_OK;
    if (BRUNT_NEW(s->turned.particle, s->particle_count + 1, "particles of a boundary that turns", error) ||
        BRUNT_NEW(s->turned.goes, s->particle_count + 1, "particles of a boundary that turns", error))
        return BRUNT_FAILED;
    brunt_boundary_surface_turn(s, 0, 0);
    return BRUNT_OK;
}

void brunt_boundary_turned_free(brunt_boundary_turned *turned) {
    brunt_free(turned->particle), brunt_free(turned->goes);
    *turned = (brunt_boundary_turned){.particle = NULL};
}

// Of a place x that goes with it: D x + e, 0 where it stands still.
static void take_motion(brunt_boundary_turned *turned) {
    const double *now = turned->now.rotation, *then = turned->then.rotation;
    double back[3];
    for (int k = 0; k < 9; k++) turned->D[k] = dot(then + 3 * (k / 3), now + 3 * (k % 3)) - (k % 4 == 0);
    if (!memcmp(now, then, sizeof turned->now.rotation)) memset(turned->D, 0, sizeof turned->D);
    rotate(turned->D, turned->now.translation, back);
    for (int a = 0; a < 3; a++) turned->e[a] = turned->then.translation[a] - turned->now.translation[a] - back[a];
}

static void place_particle(const brunt_boundary_surface *s, int32_t b, const double middle[9]) {
    const brunt_boundary_particle *from = &s->particle[b];
    const brunt_boundary_turned *turned = &s->turned;
    brunt_boundary_particle *to = &turned->particle[b];
    double start[3], end[3], *d = turned->goes[b];
    *to = *from;
    rotate(turned->now.rotation, from->x, start), rotate(turned->then.rotation, from->x, end);
    for (int k = 0; k < 2; k++) rotate(middle, from->tangent[k], to->tangent[k]);
    rotate(middle, from->normal, to->normal);
    for (int a = 0; a < 3; a++) d[a] = end[a] - start[a] + turned->then.translation[a] - turned->now.translation[a];
    const double along = dot(to->normal, d), half = s->def.condition == BRUNT_STICK ? 0 : 0.5;
    for (int a = 0; a < 3; a++)
        to->x[a] = start[a] + turned->now.translation[a] + half * (d[a] - along * to->normal[a]);
}

void brunt_boundary_surface_turn(brunt_boundary_surface *s, double time, double dt) {
    const brunt_rotation_def *by = &s->def.rotation;
    brunt_boundary_turned *turned = &s->turned;
    const double from = brunt_curve_at(&s->def.table, time), to = brunt_curve_at(&s->def.table, time + dt);
    const brunt_placement middle =
        brunt_placement_rotate(brunt_placement_identity(), by->axis, by->angle * 0.5 * (from + to), by->about);
    double square = 0;
    turned->now = brunt_boundary_surface_place(s, time), turned->then = brunt_boundary_surface_place(s, time + dt);
    turned->angle = by->angle * (to - from);
    take_motion(turned);
    for (int a = 0; a < 3; a++) turned->low[a] = INFINITY, turned->high[a] = -INFINITY;
    for (int32_t b = 0; b < s->particle_count; b++) {
        place_particle(s, b, middle.rotation);
        square = fmax(square, dot(turned->goes[b], turned->goes[b]));
        for (int a = 0; a < 3; a++) {
            turned->low[a] = fmin(turned->low[a], turned->particle[b].x[a]);
            turned->high[a] = fmax(turned->high[a], turned->particle[b].x[a]);
        }
    }
    turned->farthest = sqrt(square);
}

bool brunt_boundary_surface_turns_far(const brunt_boundary_surface *s) {
    return s->turned.particle && fabs(s->turned.angle) > MOST;
}

const brunt_boundary_particle *brunt_boundary_surface_particle(const brunt_boundary_surface *s, int32_t b) {
    return s->turned.particle ? &s->turned.particle[b] : &s->particle[b];
}

void brunt_boundary_surface_goes(const brunt_boundary_surface *s, const double x[3], double way[3]) {
    rotate(s->turned.D, x, way);
    for (int a = 0; a < 3; a++) way[a] += s->turned.e[a];
}

void brunt_boundary_surface_back(const brunt_boundary_surface *s, const double x[3], double out[3]) {
    const brunt_placement *now = &s->turned.now;
    const double from[3] = {x[0] - now->translation[0], x[1] - now->translation[1], x[2] - now->translation[2]};
    rotate_back(now->rotation, from, out);
}

// Tractions of what sticks are along the axes of the scene, and turn with the surface from step to step.
void brunt_boundary_surface_bring(const brunt_boundary_surface *s, const double kept[3], double traction[3]) {
    if (s->turned.particle && s->def.condition == BRUNT_STICK)
        rotate(s->turned.now.rotation, kept, traction);
    else
        memcpy(traction, kept, 3 * sizeof *traction);
}

void brunt_boundary_surface_keep(const brunt_boundary_surface *s, const double traction[3], double kept[3]) {
    if (s->turned.particle && s->def.condition == BRUNT_STICK)
        rotate_back(s->turned.then.rotation, traction, kept);
    else
        memcpy(kept, traction, 3 * sizeof *kept);
}
