// What contact was at the end of a step.
#include "contact/barrier/barrier_parts.h"

// [m] of the point, or on the first edge.
static void take_position(const brunt_barrier *b, const double *u, const barrier_contact *c, double place[3]) {
    for (int k = 0; k < 3; k++) place[k] = 0;
    for (int i = 0; i < (c->threshold > 0 ? 2 : 1); i++) {
        const double *x = barrier_start(b, c->place[i]);
        double move[3];
        barrier_move(b, c->place[i], u, move);
        for (int k = 0; k < b->dim; k++) place[k] += c->at.w[i] * (x[k] + move[k]);
    }
}

// The body of the second feature; -1: a plane.
static int32_t other_of(const brunt_barrier *b, const barrier_contact *c) {
    return barrier_law_is_plane(b, c->law) ? -1 : barrier_body_of(b, c->place[c->threshold > 0 ? 2 : 1]);
}

static void note_stiffness(const brunt_barrier *b, const double *u, const barrier_contact *c,
                           brunt_barrier_stiffest *s) {
    if (!b->step.inverse_mass || !barrier_contact_is_stiffer(b, c, &s->step)) return;
    s->body = barrier_body_of(b, c->place[0]), s->other = other_of(b, c);
    take_position(b, u, c, s->position);
}

// Within a corner that of the nearer face.
static double gap_of(const barrier_contact *c) {
    const double gap = c->at.d - c->offset;
    return c->within ? fmax(gap, c->wedge.gap) : gap;
}

static void note_gap(const brunt_barrier *b, const double *u, const barrier_contact *c, brunt_barrier_report *r) {
    if (c->weight <= 0 || !(gap_of(c) < r->least_gap)) return;
    const bool plane = barrier_law_is_plane(b, c->law), edges = c->threshold > 0;
    const barrier_law law = barrier_law_of(b, c->law);
    r->least_gap = gap_of(c);
    r->least_part = law.reach > 0 ? 1 + (r->least_gap - law.distance) / law.reach : r->least_gap / law.distance;
    r->overlaps = law.reach > 0;
    r->point = edges ? -1 : c->place[0], r->plane = plane ? c->law : -1;
    r->body = barrier_body_of(b, c->place[0]);
    r->other = other_of(b, c);
    take_position(b, u, c, r->position);
}

double brunt_barrier_least_gap(const brunt_barrier *b) {
    double least = INFINITY;
    for (int64_t i = 0; i < b->contacts.count; i++)
        if (b->contacts.contact[i].weight > 0) least = fmin(least, gap_of(&b->contacts.contact[i]));
    return least;
}

// 1: on the law's body a is what is on the first feature; -1: the reaction. 0: a body with itself has both.
static int sign_of(const brunt_barrier *b, const barrier_contact *c) {
    if (barrier_law_is_plane(b, c->law)) return c->side;
    const brunt_barrier_pair *pair = barrier_pair_of(b, c->law);
    return pair->a == pair->b ? 0 : c->side;
}

static void add_normal(const brunt_barrier *b, const barrier_contact *c, brunt_barrier_force *force) {
    const double f = sign_of(b, c) * barrier_contact_force(b, c);
    if (!(c->threshold > 0)) force->area += c->weight; // edges are where points are not, and have none
    for (int k = 0; k < b->dim; k++) force->normal[k] += f * c->at.n[k];
    force->contacts++;
}

// Friction at u: its force, and what it takes along the way.
static void add_friction(const brunt_barrier *b, const double *u, const double *way, brunt_barrier_force *force) {
    for (int64_t i = 0; i < b->lagged.count; i++) {
        const barrier_contact *c = &b->lagged.contact[i];
        double f[3], slip[3];
        barrier_slip_force(b, c, u, f), barrier_slip_of(b, c, way, slip);
        for (int k = 0; k < b->dim; k++) {
            force[c->law].heat -= f[k] * slip[k];
            force[c->law].friction[k] += sign_of(b, c) * f[k];
        }
    }
}

int brunt_barrier_forces_extend(brunt_barrier_forces *forces, int32_t count, brunt_error *error) {
    const int32_t from = forces->count;
    if (count <= from) return BRUNT_OK;
    if (BRUNT_CAPACITY(forces->force, (size_t)count, (size_t)from, "planes and pairs of bodies", error))
        return BRUNT_FAILED;
    memset(&forces->force[from], 0, (size_t)(count - from) * sizeof *forces->force);
    forces->count = count;
    return BRUNT_OK;
}

void brunt_barrier_forces_free(brunt_barrier_forces *forces) {
    brunt_free(forces->force);
    *forces = (brunt_barrier_forces){.force = NULL};
}

int brunt_barrier_look_back(brunt_barrier *b, const brunt_team *team, const double *u, const double *way,
                            brunt_barrier_report *r, brunt_barrier_forces *forces, brunt_error *error) {
    *r = (brunt_barrier_report){.least_gap = INFINITY,
                                .least_part = INFINITY,
                                .body = -1,
                                .other = -1,
                                .point = -1,
                                .plane = -1,
                                .stiffest = {.step = INFINITY, .body = -1, .other = -1}};
    const int code = brunt_barrier_term(b).ops->look(b, team, u, NULL, error);
    if (code) return code;
    if (forces) forces->count = 0;
    if (forces && brunt_barrier_forces_extend(forces, b->step.plane_count + b->pair_count, error)) return BRUNT_FAILED;
    brunt_barrier_force *force = forces ? forces->force : NULL;
    for (int64_t i = 0; i < b->contacts.count; i++) {
        const barrier_contact *c = &b->contacts.contact[i];
        note_gap(b, u, c, r);
        note_stiffness(b, u, c, &r->stiffest);
        r->energy += barrier_contact_energy(b, c);
        if (force) add_normal(b, c, &force[c->law]);
    }
    r->contacts = b->contacts.count;
    if (force) add_friction(b, u, way, force);
    return BRUNT_OK;
}
