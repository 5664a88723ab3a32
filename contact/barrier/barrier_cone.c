// Friction's potential with what presses now.
//
// Coulomb's law has none: what presses bounds friction, which does not ask friction. It has one where surfaces that
// slip by y come apart by mu f0(|y|) as well, since force and motion are then normal to each other's cones: that of a
// gap that is so much less, w b(d - mu f0(|y|)), whose forces are -w b' n and mu w (-b') f1 y/|y|. It is convex in gap
// and slip. What surfaces come apart by is given back, as it is where a round begins: b(d - o) with the opening o = mu
// (f0(|y|) - f0(|y|) there). Where the slip ends as it began, so do the gap and Coulomb's law (G. de Saxce and Z.-Q.
// Feng, Math. Comput. Modelling 28 (1998) 225; V. Acary, F. Cadoux, C. Lemarechal and J. Malick, Z. Angew. Math. Mech.
// 91 (2011) 155).
//
// Surfaces that slip less than there would come as much nearer, through each other if they may: by no more than what
// about doubles what presses, room (exp(o / room) - 1), convex as well.
#include "contact/barrier/barrier_parts.h"

typedef struct cone {
    barrier_slip slip;
    double mu, rate;
    double follows, bend;          // slope of what surfaces come apart by, by the opening, and its slope [1/m]
    double weight;                 // [m^2] 0: it did not push where the round began, and has no friction in it
    brunt_barrier_value gap, less; // the barrier at the gap and at what slips leave of it
} cone;

static cone cone_at(const brunt_barrier *b, const barrier_contact *c, const double *u) {
    const barrier_law law = barrier_law_of(b, c->law);
    cone k = {.slip = barrier_slip_at(b, c, u), .rate = barrier_slip_rate(b, c)};
    k.mu = law.friction == INFINITY ? 1 : law.friction;
    const double gap = c->at.d - c->offset, before = gap + barrier_approach(b, c, u) - barrier_approach(b, c, b->from);
    const brunt_barrier_value then = law.energy(before, law.distance, law.stiffness);
    const double opening = k.mu / k.rate * (k.slip.potential - barrier_slip_at(b, c, b->from).potential);
    const double room = -0.5 * then.db / then.ddb, beyond = opening / room + 1;
    const bool much = beyond < 0;
    const double apart = much ? room * (expm1(beyond) - 1) : opening;
    k.follows = much ? exp(beyond) : 1, k.bend = much ? k.follows / room : 0;
    k.gap = law.energy(gap, law.distance, law.stiffness);
    k.less = law.energy(gap - apart, law.distance, law.stiffness);
    if (barrier_is_lost(&law, gap - apart)) k.less.b = INFINITY;
    k.weight = -c->normal_force / k.gap.db;
    if (before >= law.distance) k.weight = k.follows = k.bend = 0, k.less = k.gap;
    return k;
}

double barrier_cone_energy(const brunt_barrier *b, const barrier_contact *c, const double *u) {
    const cone k = cone_at(b, c, u);
    return k.weight > 0 ? k.weight * (k.less.b - k.gap.b) : 0;
}

// Within a corner weights follow both gaps.
static void add_weight(const brunt_barrier *b, const barrier_contact *c, double more, double *gradient) {
    const barrier_within within = barrier_within_of(b, c);
    for (int i = 0; i < 8; i++)
        gradient[i] += more * (within.weight[0] * c->at.w[i / 2] * c->at.n[i % 2] + within.weight[1] * within.other[i]);
}

void barrier_cone_gradient(const brunt_barrier *b, const barrier_contact *c, const double *u, double *gradient) {
    const cone k = cone_at(b, c, u);
    for (int i = 0; i < c->at.places; i++)
        for (int q = 0; q < b->dim; q++)
            gradient[i * b->dim + q] =
                k.weight * c->at.w[i] *
                ((k.less.db - k.gap.db) * c->at.n[q] - k.less.db * k.mu * k.follows * k.slip.ratio * k.slip.y[q]);
    if (c->within && k.weight > 0) add_weight(b, c, k.less.b - k.gap.b, gradient);
}

// The force that friction has of the greatest, `part`, is an unknown of its own, as in barrier_slip.c.
void barrier_cone_hessian(const brunt_barrier *b, const barrier_contact *c, const double part[3], const double *u,
                          double *h) {
    const cone k = cone_at(b, c, u);
    const double *n = c->at.n, *y = k.slip.y, bend = k.slip.size > 0 ? k.slip.bend / k.slip.size / 2 : 0;
    const int rows = c->at.places * b->dim;
    double a[3];
    for (int q = 0; q < 3; q++) a[q] = n[q] - k.mu * k.follows * part[q];
    for (int i = 0; i < c->at.places; i++)
        for (int j = 0; j < c->at.places; j++)
            for (int p = 0; p < b->dim; p++)
                for (int q = 0; q < b->dim; q++) {
                    const double slips = (p == q) - n[p] * n[q] - bend * (part[p] * y[q] + y[p] * part[q]);
                    const double opens =
                        k.follows * k.mu * k.rate * k.slip.ratio * slips + k.bend * k.mu * k.mu * part[p] * part[q];
                    h[(i * b->dim + p) * rows + j * b->dim + q] =
                        k.weight * c->at.w[i] * c->at.w[j] *
                        (k.less.ddb * a[p] * a[q] - k.gap.ddb * n[p] * n[q] - k.less.db * opens);
                }
}
