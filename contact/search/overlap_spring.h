// Material points that overlap what they touch are pushed out by springs, where a scene asks for that: what a spring
// takes it gives back, where a stop within one step loses the energy of a layer of cells, some of it in contact and
// some in the transfer to the grid, which does not see what is that sudden.
//
// A point stands for a column of material, a cell long and m / (rho s) wide, s its spacing: k = m c^2 / (s h), c the
// wave speed of the undeformed body. It is a constant, so that there is a potential, k d^2 / 2, and what is pressed
// stays a cell times its strain in what presses. Springs that are a share of what nodes weigh in each step (by which
// bodies did not need to be known) gave a ball of five cells back 1.7 % more than they took.
#pragma once

#include "contact/contact.h"
#include "mpm/mpm_body.h"
#include "mpm/particles.h"

// Of the particle in a slot [N/m] (rings: of the whole circle); 0: it is stopped within a step.
static inline double brunt_overlap_spring(const brunt_contact_context *m, brunt_body *body, int64_t slot) {
    if (!m->springs) return 0;
    const double c = (double)body->material.wave_speed,
                 mass = (double)brunt_field(&body->particles, BRUNT_FIELD_mass)[0][slot];
    return mass * c * c / (body->spacing * (double)body->grid.h);
}

// How far a spring lets the surface of a point go in before the point is stopped within a step [m]: to its centre, or
// half a spacing, whose centre is on the surface of its body.
static inline double brunt_overlap_limit(const brunt_body *body, double extent) {
    return extent > 0.5 * body->spacing ? extent : 0.5 * body->spacing;
}

// The same spring where the master is of points, too, which push it as well: half of both springs one behind the other.
static inline double brunt_overlap_spring_between(const brunt_contact_context *m, brunt_body *body, int64_t slot,
                                                  const brunt_body *other) {
    const double c = (double)body->material.wave_speed, of_other = (double)other->material.wave_speed,
                 stiff = (double)body->material.density * c * c / (double)body->grid.h,
                 stiff_other = (double)other->material.density * of_other * of_other / (double)other->grid.h;
    return 0.5 * brunt_overlap_spring(m, body, slot) * stiff_other / (stiff + stiff_other);
}
