// Surfaces that touch, joined: what carries loads before anything presses.
//
// Where bodies touch as load steps begin nothing holds them: normal forces are 0, and so is friction. Newton's method
// then takes the loads from row to row of a packing, an iteration for each, and bodies turn and wander meanwhile, to an
// equilibrium other than the one that they come to by as much load as one likes to begin with. With all that touches
// joined, along the normals, and across them where there is friction, one linear system tells where the loads take
// them.
#include "contact/barrier/barrier_parts.h"

// Points of curves are a quarter of an edge apart: where two curves touch between theirs, the gaps of those are twice
// what the curve leaves the chord of an eighth by, h^2 / 64 R.
static const double BETWEEN = 0.125, ROUNDING = 1e-6; // of what a curve leaves its chord by; of the shortest facet

// [m] Gaps up to which surfaces touch, as their meshes are.
static double touch_of(const brunt_barrier *b) {
    double bend = 0, shortest = INFINITY;
    for (int32_t f = 0; f < b->facet_count; f++) {
        const int32_t *v = b->facet[f];
        const barrier_arc *arc = barrier_arc_of(b, f);
        double x[BRUNT_CUBIC_PLACES][3], square = 0;
        barrier_relative(b, NULL, v[0], arc ? arc->place : v, arc ? arc->curve.places : b->dim, x);
        for (int k = 0; k < b->dim; k++) square += (x[1][k] - x[0][k]) * (x[1][k] - x[0][k]);
        shortest = fmin(shortest, sqrt(square));
        if (arc) bend = fmax(bend, brunt_cubic_bend((const double(*)[3])x, &arc->curve));
    }
    return b->facet_count ? BETWEEN * bend + ROUNDING * shortest : 0;
}

void brunt_barrier_join(brunt_barrier *b, bool joined) {
    b->touch = joined ? touch_of(b) : 0;
    b->here_count = 0;
}

// [N/m] Of the gap: that below the distance, on both sides of it.
static double stiffness_of(const brunt_barrier *b, const barrier_contact *c, double *gap) {
    const barrier_law law = barrier_law_of(b, c->law);
    *gap = c->at.d - c->offset - law.distance;
    return c->weight * law.energy(law.distance - b->touch, law.distance, law.stiffness).ddb;
}

void barrier_join_gradient(const brunt_barrier *b, const barrier_contact *c, double *gradient) {
    double gap;
    const double stiffness = stiffness_of(b, c, &gap);
    for (int i = 0; i < c->at.places; i++)
        for (int k = 0; k < b->dim; k++) gradient[i * b->dim + k] = stiffness * gap * c->at.w[i] * c->at.n[k];
}

void barrier_join_hessian(const brunt_barrier *b, const barrier_contact *c, double *h) {
    const int rows = c->at.places * b->dim;
    const bool across = barrier_law_of(b, c->law).friction > 0;
    double gap;
    const double stiffness = stiffness_of(b, c, &gap);
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < rows; j++) {
            const int k = i % b->dim, l = j % b->dim;
            h[i * rows + j] =
                stiffness * c->at.w[i / b->dim] * c->at.w[j / b->dim] * (across ? k == l : c->at.n[k] * c->at.n[l]);
        }
}
