// Energy, force and stiffness of one contact, by its places.
#include "contact/barrier/barrier_parts.h"

typedef struct mollifier {
    double m, dm, ddm; // and by |ea x eb|^2
    double gradient[12], second[36];
} mollifier;

// c^2 smooth between 0 where edges are parallel and 1 from the threshold on (Li et al. 2020).
static double mollify(double cross2, double threshold, double *slope, double *curvature) {
    const double x = cross2 / threshold;
    const bool less = x < 1;
    *slope = less ? 2 * (1 - x) / threshold : 0;
    *curvature = less ? -2 / (threshold * threshold) : 0;
    return less ? x * (2 - x) : 1;
}

// By places: ea = a1 - a0, eb = b1 - b0.
static mollifier mollifier_of(const barrier_contact *c) {
    mollifier m = {.m = 1};
    double g[6];
    if (c->threshold == 0) return m;
    const double cross2 = brunt_edge_cross(c->edge[0], c->edge[1], g, m.second);
    m.m = mollify(cross2, c->threshold, &m.dm, &m.ddm);
    for (int k = 0; k < 3; k++) {
        m.gradient[k] = -g[k], m.gradient[3 + k] = g[k];
        m.gradient[6 + k] = -g[3 + k], m.gradient[9 + k] = g[3 + k];
    }
    return m;
}

// The barrier at a contact's gap, and its weight there.
static double weighted(const brunt_barrier *b, const barrier_contact *c, brunt_barrier_value *v) {
    const barrier_law law = barrier_law_of(b, c->law);
    double unused, g[6], second[36];
    *v = law.energy(c->at.d - c->offset, law.distance, law.stiffness);
    if (barrier_is_lost(&law, c->at.d - c->offset)) v->b = INFINITY;
    return c->threshold == 0 ? c->weight
                             : c->weight * mollify(brunt_edge_cross(c->edge[0], c->edge[1], g, second), c->threshold,
                                                   &unused, &unused);
}

double barrier_contact_energy(const brunt_barrier *b, const barrier_contact *c) {
    brunt_barrier_value v;
    const double weight = weighted(b, c, &v);
    if (c->within) return barrier_within_energy(b, c, v.ddb);
    return weight == 0 ? (v.b < INFINITY ? 0 : INFINITY) : weight * v.b;
}

double barrier_contact_force(const brunt_barrier *b, const barrier_contact *c) {
    brunt_barrier_value v;
    return -weighted(b, c, &v) * v.db;
}

void barrier_contact_force_gradient(const brunt_barrier *b, const barrier_contact *c, double scale, double *gradient) {
    const int dim = b->dim, rows = c->at.places * dim;
    brunt_barrier_value v;
    double slope = -weighted(b, c, &v) * v.ddb;
    const barrier_within within = c->within ? barrier_within_of(b, c) : (barrier_within){.slope = {0}};
    if (c->within) slope = -v.ddb * within.slope[0];
    for (int i = 0; i < rows; i++) gradient[i] = scale * slope * c->at.w[i / dim] * c->at.n[i % dim];
    for (int i = 0; i < rows && c->within; i++) gradient[i] -= scale * v.ddb * within.slope[1] * within.other[i];
    if (c->threshold == 0) return;
    const mollifier m = mollifier_of(c);
    for (int i = 0; i < 12; i++) gradient[i] -= scale * c->weight * v.db * m.dm * m.gradient[i];
}

bool barrier_contact_is_stiffer(const brunt_barrier *b, const barrier_contact *c, double *step) {
    brunt_barrier_value v;
    const double area = weighted(b, c, &v);
    double inverse = 0;
    for (int i = 0; i < c->at.places; i++) {
        const int32_t *node;
        const double *weight;
        const int64_t count = barrier_nodes(b, c->place[i], &node, &weight);
        for (int64_t k = 0; k < count; k++) {
            const double w = c->at.w[i] * weight[k];
            inverse += w * w * b->step.inverse_mass[node[k]];
        }
    }
    if (!(area * v.ddb * inverse > 0)) return false;
    const double longest = brunt_barrier_longest_step(area, v.ddb, 1 / inverse);
    if (!(longest < *step)) return false;
    *step = longest;
    return true;
}

void barrier_contact_gradient(const brunt_barrier *b, const barrier_contact *c, double *gradient) {
    brunt_barrier_value v;
    const double weight = weighted(b, c, &v);
    for (int i = 0; i < c->at.places; i++)
        for (int k = 0; k < b->dim; k++) gradient[i * b->dim + k] = weight * v.db * c->at.w[i] * c->at.n[k];
    if (c->threshold == 0) return;
    const mollifier m = mollifier_of(c);
    if (m.dm == 0) return;
    for (int i = 0; i < 12; i++) gradient[i] += c->weight * v.b * m.dm * m.gradient[i];
}

// b (m'' grad c grad c^T + m' grad^2 c) + b' m' (grad d grad c^T + grad c grad d^T).
static void mollified(const barrier_contact *c, const mollifier *m, brunt_barrier_value v, double *h) {
    for (int i = 0; i < 12; i++)
        for (int j = 0; j < 12; j++) {
            const double sign = (i / 3 % 2 ? 1 : -1) * (j / 3 % 2 ? 1 : -1);
            const double second = sign * m->second[(i / 6 * 3 + i % 3) * 6 + j / 6 * 3 + j % 3];
            const double di = c->at.w[i / 3] * c->at.n[i % 3], dj = c->at.w[j / 3] * c->at.n[j % 3];
            h[i * 12 + j] += c->weight * (v.b * (m->ddm * m->gradient[i] * m->gradient[j] + m->dm * second) +
                                          v.db * m->dm * (di * m->gradient[j] + m->gradient[i] * dj));
        }
}

// Half of what couples both gaps of a corner: the contact with the other face has as much.
static void add_wedge(const barrier_contact *c, const barrier_within *within, double stiffness, double *h) {
    const double half = stiffness * within->slope[1] / 2;
    for (int i = 0; i < 8; i++)
        for (int j = 0; j < 8; j++) {
            const double di = c->at.w[i / 2] * c->at.n[i % 2], dj = c->at.w[j / 2] * c->at.n[j % 2];
            h[i * 8 + j] += half * (di * within->other[j] + within->other[i] * dj);
        }
}

void barrier_contact_hessian(const brunt_barrier *b, const barrier_contact *c, bool project, double *h) {
    const int rows = c->at.places * b->dim;
    brunt_barrier_value v;
    const double weight = weighted(b, c, &v);
    memset(h, 0, (size_t)rows * (size_t)rows * sizeof *h);
    // While surfaces that slip come apart the weight is as if it stayed: what that adds takes its own slope.
    if (c->within && !b->from) {
        const barrier_within within = barrier_within_of(b, c);
        brunt_closest_hessian(&c->at, b->dim, within.slope[0] * v.ddb, weight * v.db, h);
        add_wedge(c, &within, v.ddb, h);
    } else {
        brunt_closest_hessian(&c->at, b->dim, weight * v.ddb, weight * v.db, h);
    }
    if (c->threshold > 0) {
        const mollifier m = mollifier_of(c);
        if (m.dm != 0) mollified(c, &m, v, h);
    }
    if (project) brunt_project_positive(rows, h);
}
