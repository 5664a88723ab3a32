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

// f1 = 2 y/e - y^2/e^2 below e = dt eps_v, then 1; where it sticks 2 y/e without end.
static barrier_slip law_at(const brunt_barrier *b, const barrier_contact *c, const double y[3]) {
    const barrier_law law = barrier_law_of(b, c->law);
    const double e = b->step.dt * law.slip_speed, size = sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]);
    barrier_slip s = {.y = {y[0], y[1], y[2]}, .size = size};
    if (law.friction == INFINITY) {
        s.ratio = 2 / e, s.potential = size * size / e;
    } else if (size < e) {
        s.ratio = 2 / e - size / (e * e), s.potential = size * size / e * (1 - size / (3 * e)) + e / 3;
        s.bend = 1 / ((2 - size / e) * (2 - size / e));
    } else {
        s.ratio = 1 / size, s.potential = size, s.bend = 1;
    }
    return s;
}

barrier_slip barrier_slip_at(const brunt_barrier *b, const barrier_contact *c, const double *u) {
    const brunt_barrier_step *step = &b->step;
    double y[3], before[3] = {0};
    barrier_slip_of(b, c, u, y);
    if (step->before) barrier_slip_of(b, c, step->before, before);
    for (int k = 0; k < 3; k++) y[k] = step->factor * y[k] + (1 - step->factor) * before[k];
    if (b->keeps) {
        const barrier_rub *rub = &b->rub[c - b->lagged.contact];
        for (int k = 0; k < 3; k++) y[k] = rub->kept[k] + rub->share * y[k];
    }
    return law_at(b, c, y);
}

double barrier_slip_rate(const brunt_barrier *b, const barrier_contact *c) {
    return b->step.factor * (b->keeps ? b->rub[c - b->lagged.contact].share : 1);
}

// [N]
static double greatest_force(const brunt_barrier *b, const barrier_contact *c) {
    const double friction = barrier_law_of(b, c->law).friction;
    return (friction == INFINITY ? 1 : friction) * c->normal_force;
}

double barrier_slip_energy(const brunt_barrier *b, const barrier_contact *c, const double *u) {
    return greatest_force(b, c) * barrier_slip_at(b, c, u).potential / barrier_slip_rate(b, c);
}

void barrier_slip_force(const brunt_barrier *b, const barrier_contact *c, const double *u, double force[3]) {
    const barrier_slip s = barrier_slip_at(b, c, u);
    const double greatest = greatest_force(b, c), scale = greatest * s.ratio;
    const double *part = b->live ? b->rub[c - b->lagged.contact].part : NULL;
    for (int k = 0; k < 3; k++) force[k] = part ? -greatest * part[k] : -scale * s.y[k];
}

void barrier_slip_gradient(const brunt_barrier *b, const barrier_contact *c, const double *u, double *gradient) {
    double force[3];
    barrier_slip_force(b, c, u, force);
    for (int i = 0; i < c->at.places; i++)
        for (int k = 0; k < b->dim; k++) gradient[i * b->dim + k] = -c->at.w[i] * force[k];
}

// ------------------------------------------------------------------------------------------------- the way there
//
// The force leaps, on a slip of dt eps_v, from one side to the other, and is constant beyond. Newton's method for it
// sees either nothing or a wall, and goes to and fro where some slip and others stick. Hence the force is an unknown of
// its own, and what is linearised is not w = r(|y|) y but the smooth w / r(|y|) = y (Chan, Golub and Mulet, SIAM J.
// Sci. Comput. 20 (1999), for sums of lengths):
//   dy - (1/r)' w (y . dy) / |y| = (w + dw) / r - y
// Put into the balance of forces that gives the gradient as it is, and for the Hessian r (1 - (1/r)' w y^T / |y|),
// which is positive as long as |w| <= 1, and which is the true one where w = r y. Its symmetric part is taken.

double barrier_approach(const brunt_barrier *b, const barrier_contact *c, const double *u) {
    double apart = 0;
    for (int i = 0; i < c->at.places; i++) {
        double move[3];
        barrier_move(b, c->place[i], u, move);
        for (int k = 0; k < 3; k++) apart += c->at.w[i] * move[k] * c->at.n[k];
    }
    return -apart;
}

// Surfaces that meet within a load step rub from where their gap came below the distance, on a straight way.
static double share_of(const brunt_barrier *b, const barrier_contact *c, const double *u) {
    const double within = barrier_law_of(b, c->law).distance - (c->at.d - c->offset);
    const double approach = b->keeps ? barrier_approach(b, c, u) : 0;
    return approach > within ? within / approach : 1;
}

void barrier_slip_begin(const brunt_barrier *b, const barrier_contact *c, const double *u, barrier_rub *rub) {
    *rub = (barrier_rub){.energy = 0};
    rub->turned = barrier_kept_slip(b, c, rub->kept);
    rub->share = share_of(b, c, u);
    const barrier_slip s = barrier_slip_at(b, c, u);
    for (int k = 0; k < 3; k++) rub->slip[k] = s.y[k], rub->part[k] = s.ratio * s.y[k];
}

void barrier_slip_follow(const brunt_barrier *b, const barrier_contact *c, const double *u, barrier_rub *rub) {
    const barrier_slip now = barrier_slip_at(b, c, u), old = law_at(b, c, rub->slip);
    double along = 0, square = 0;
    for (int k = 0; k < 3; k++) along += old.y[k] * (now.y[k] - old.y[k]);
    if (old.size > 0) along *= old.bend / old.size;
    for (int k = 0; k < 3; k++) {
        rub->part[k] = old.ratio * (now.y[k] - along * rub->part[k]);
        square += rub->part[k] * rub->part[k];
        rub->slip[k] = now.y[k];
    }
    if (square <= 1 || barrier_law_of(b, c->law).friction == INFINITY) return;
    for (int k = 0; k < 3; k++) rub->part[k] /= sqrt(square);
}

// g_i = w_i f of place i, f = F r(|y|) y with F = mu N: dg_i = dw_i f + w_i (dF w + F d(r y)), where d(r y) is that of
// the smooth form above, with w the force that is an unknown of its own: the true derivative where w = r y, and no wall
// where a slip turns round. The first place is a point, w = 1, so that its rows of the Hessian of d are dn, and n times
// those of the others their dw. Of two edges that cross it is the first that moves against the second: its ends' rows
// sum up to dn, as their weights do to 1.
//
// What was kept, k, and had a along the normal before it was turned along the surfaces, turns on with them by -a (dn -
// k k . dn / k . k), where dn is not along it.
void barrier_slip_tangent(const brunt_barrier *b, const barrier_contact *c, const double part[3], const double *u,
                          double *tangent) {
    const int dim = b->dim, places = c->at.places, rows = places * dim;
    const barrier_slip s = barrier_slip_at(b, c, u);
    const double *n = c->at.n, greatest = greatest_force(b, c),
                 mu = c->normal_force > 0 ? greatest / c->normal_force : 0;
    double dF[BARRIER_DOFS], turn[BARRIER_DOFS * BARRIER_DOFS] = {0}, move[BRUNT_CLOSEST_PLACES][3], slip[3];
    const int first = c->threshold > 0 ? 2 : 1; // places of the first feature
    const double apart = -barrier_approach(b, c, u), share = share_of(b, c, u);
    brunt_closest_hessian(&c->at, dim, 0, 1, turn);
    barrier_contact_force_gradient(b, c, mu, dF);
    for (int i = 0; i < places; i++) barrier_move(b, c->place[i], u, move[i]);
    barrier_slip_of(b, c, u, slip);
    const double *kept = b->rub[c - b->lagged.contact].kept, turns = b->rub[c - b->lagged.contact].turned,
                 square = kept[0] * kept[0] + kept[1] * kept[1] + kept[2] * kept[2];
    // d(r y) = r (dy - (1/r)' w (y . dy) / |y|)
    const double bend = s.size > 0 ? s.bend / s.size : 0;
    for (int j = 0; j < places; j++)
        for (int l = 0; l < dim; l++) {
            const int column = j * dim + l;
            double dn[3] = {0}, dw[BRUNT_CLOSEST_PLACES] = {0}, dy[3] = {0}, across = 0, along = 0, normal = 0,
                   turned = 0, of_kept = 0;
            for (int i = 0; i < first; i++)
                for (int k = 0; k < dim; k++) dn[k] += turn[(i * dim + k) * rows + column];
            for (int i = first == 1; i < places; i++)
                for (int k = 0; k < dim; k++) dw[i] += n[k] * turn[(i * dim + k) * rows + column];
            for (int k = 0; k < dim; k++) {
                dy[k] = (k == l) * c->at.w[j];
                for (int i = first == 1; i < places; i++) dy[k] += dw[i] * move[i][k];
                across += dy[k] * n[k], normal += dn[k] * s.y[k], turned += dn[k] * slip[k];
                of_kept += square > 0 ? dn[k] * kept[k] / square : 0;
            }
            // The share is that of the gap within the distance in the approach, -apart.
            const double more = share < 1 ? (c->at.w[j] * n[l] - share * (across + turned)) / apart : 0;
            for (int k = 0; k < dim; k++)
                dy[k] = share * dy[k] - (share * (across * n[k] + apart * dn[k]) + normal * n[k]) + more * slip[k] -
                        turns * (dn[k] - of_kept * kept[k]);
            for (int k = 0; k < dim; k++) along += s.y[k] * dy[k];
            for (int k = 0; k < dim; k++) {
                const double f = greatest * s.ratio * s.y[k],
                             df = dF[column] * part[k] + greatest * s.ratio * (dy[k] - bend * along * part[k]);
                for (int i = 0; i < places; i++) tangent[(i * dim + k) * rows + column] = c->at.w[i] * df + dw[i] * f;
            }
        }
}

void barrier_slip_hessian(const brunt_barrier *b, const barrier_contact *c, const barrier_rub *rub, const double *u,
                          double *h) {
    const barrier_slip s = barrier_slip_at(b, c, u);
    const double scale = barrier_slip_rate(b, c) * greatest_force(b, c) * s.ratio,
                 bend = s.size > 0 ? s.bend / s.size / 2 : 0;
    const int rows = c->at.places * b->dim;
    for (int i = 0; i < c->at.places; i++)
        for (int j = 0; j < c->at.places; j++)
            for (int k = 0; k < b->dim; k++)
                for (int l = 0; l < b->dim; l++)
                    h[(i * b->dim + k) * rows + j * b->dim + l] =
                        scale * c->at.w[i] * c->at.w[j] *
                        ((k == l) - c->at.n[k] * c->at.n[l] - bend * (rub->part[k] * s.y[l] + s.y[k] * rub->part[l]));
}
