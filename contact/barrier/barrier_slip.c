// Friction of one contact: Coulomb's law, mu times the lagged normal force against the slip, rounded off below the slip
// dt eps_v so that it has a potential (Li et al. 2020).
#include "contact/barrier/barrier_parts.h"

void barrier_slip_of(const brunt_barrier *b, const barrier_contact *c, const double *u, double slip[3]) {
    double along = 0;
    slip[0] = slip[1] = slip[2] = 0;
    for (int i = 0; i < c->at.places; i++) {
        double move[3];
        barrier_move(b, c->place[i], u, move);
        for (int k = 0; k < 3; k++) slip[k] += c->at.w[i] * move[k];
    }
    for (int k = 0; k < 3; k++) along += slip[k] * c->at.n[k];
    for (int k = 0; k < 3; k++) slip[k] -= along * c->at.n[k];
}

typedef struct slip_law {
    double y[3], size;  // [m] dt times the velocity of the slip, and its length
    double limit;       // [N] mu times the normal force
    double width;       // [m] dt eps_v
    double ratio, drop; // f1 / size; (f1' - f1 / size) / size^2
    double potential;   // f0 [m]
} slip_law;

// f1 = 2 y/e - y^2/e^2 below e, then 1; where it sticks 2 y/e without end.
static slip_law slip_at(const brunt_barrier *b, const barrier_contact *c, const double *u) {
    const brunt_barrier_step *step = &b->step;
    const barrier_law law = barrier_law_of(b, c->law);
    const bool sticks = law.friction == INFINITY;
    slip_law s = {.limit = (sticks ? 1 : law.friction) * c->normal_force, .width = step->dt * law.slip_speed};
    double before[3] = {0};
    barrier_slip_of(b, c, u, s.y);
    if (step->before) barrier_slip_of(b, c, step->before, before);
    for (int k = 0; k < 3; k++) {
        s.y[k] = step->factor * s.y[k] + (1 - step->factor) * before[k];
        s.size += s.y[k] * s.y[k];
    }
    s.size = sqrt(s.size);
    const double e = s.width, y = s.size;
    if (sticks)
        s.ratio = 2 / e, s.potential = y * y / e;
    else if (y < e)
        s.ratio = 2 / e - y / (e * e), s.potential = y * y / e * (1 - y / (3 * e)) + e / 3;
    else
        s.ratio = 1 / y, s.potential = y;
    if (!sticks && y > 0) s.drop = y < e ? -1 / (e * e * y) : -1 / (y * y * y);
    return s;
}

double barrier_slip_energy(const brunt_barrier *b, const barrier_contact *c, const double *u) {
    const slip_law s = slip_at(b, c, u);
    return s.limit * s.potential / b->step.factor;
}

void barrier_slip_force(const brunt_barrier *b, const barrier_contact *c, const double *u, double force[3]) {
    const slip_law s = slip_at(b, c, u);
    for (int k = 0; k < 3; k++) force[k] = -s.limit * s.ratio * s.y[k];
}

void barrier_slip_gradient(const brunt_barrier *b, const barrier_contact *c, const double *u, double *gradient) {
    double force[3];
    barrier_slip_force(b, c, u, force);
    for (int i = 0; i < c->at.places; i++)
        for (int k = 0; k < b->dim; k++) gradient[i * b->dim + k] = -c->at.w[i] * force[k];
}

// Never negative: the force grows with the slip, or stays.
void barrier_slip_hessian(const brunt_barrier *b, const barrier_contact *c, const double *u, double *h) {
    const slip_law s = slip_at(b, c, u);
    const double scale = b->step.factor * s.limit;
    const int rows = c->at.places * b->dim;
    for (int i = 0; i < c->at.places; i++)
        for (int j = 0; j < c->at.places; j++)
            for (int k = 0; k < b->dim; k++)
                for (int l = 0; l < b->dim; l++)
                    h[(i * b->dim + k) * rows + j * b->dim + l] =
                        scale * c->at.w[i] * c->at.w[j] *
                        (s.ratio * ((k == l) - c->at.n[k] * c->at.n[l]) + s.drop * s.y[k] * s.y[l]);
}
