// The sweeps over a pair: what the masters' surface does on the grid, which slaves it holds back, and the reaction.
#include "contact/constraint/coulomb.h"
#include "contact/methods/averaged_surface_parts.h"

enum { NODE_GRAIN = 64 };
static const double SLOP = 0.02;       // [cells] left alone by the push
static const double CORRECTION = 0.2;  // share of the overlap to be undone in a step
static const double RESTITUTION = 0.5; // of the approach, the most a push gives back: above, it adds energy
static const double STUCK = 1e-6;      // of Coulomb's limit that a node is below of when it sticks

// Share of a master's mass that counts at a grid node, for a component: all, or where something is held only that.
static double mass_share(const side *s, double w, double mass, double inverse, int a) {
    return s->fixed[a] > 0 && inverse > 0 ? 0 : w * mass * s->share[a];
}

static void send_motion(void *context, int32_t begin, int32_t end) {
    const averaged_job *j = context;
    const brunt_contact_surface *surface = j->surface;
    for (int32_t k = begin; k < end; k++) {
        const averaged_node *p = &j->work->averaged_node[j->node_first[j->of] + k];
        const entry *e = entries_of(j, p, true);
        const double *v = surface->v[p->node], *x = surface->x[p->node], mass = surface->mass[p->node];
        const double *C = j->affine && p->master_count ? j->work->touched[p->touched].C : NULL;
        for (int q = 0; q < p->master_count; q++) {
            shared_node *n = &j->work->shared[e[q].at];
            side *s = &n->side[j->of];
            double r[3] = {n->x[0] - x[0], n->x[1] - x[1], n->x[2] - x[2]};
            for (int a = 0; a < 3; a++) {
                double w = mass_share(s, e[q].w, mass, surface->inverse[p->node][a], a);
                s->v[a] += w * v[a];
                if (!C) continue;
                s->plain[a] += w * v[a];
                s->v[a] += w * dot(C + 3 * a, r);
                for (int b = 0; b < 3; b++) s->C[3 * a + b] += w * C[3 * a + b];
            }
        }
    }
}

// Least velocity away from the surface: arrive there at the end of the step and no further; out of an overlap gently.
static double least_velocity(const averaged_job *j, double gap, double along) {
    const double slop = SLOP * j->m->cell;
    if (gap >= 0) return -gap / j->m->dt;
    if (j->affine || gap >= -slop) return 0;
    return fmin(CORRECTION * (-gap - slop) / j->m->dt, RESTITUTION * fmax(0, -along));
}

static bool can_move(const brunt_contact_surface *s, int32_t node) {
    return s->inverse[node][0] > 0 || s->inverse[node][1] > 0 || s->inverse[node][2] > 0;
}

static void find_pressing(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const averaged_job *j = context;
    for (int64_t k = begin; k < end; k++) {
        averaged_node *p = &j->work->averaged_node[j->node_first[!j->master] + k];
        p->presses = false;
        if (!p->meets) continue;
        const entry *e = entries_of(j, p, false);
        const double *x = j->surface->x[p->node], *v = j->surface->v[p->node];
        double affine[3] = {0}, plain[3] = {0};
        for (int q = 0; q < p->slave_count; q++) {
            const shared_node *n = &j->work->shared[e[q].at];
            const side *s = &n->side[j->master];
            for (int a = 0; a < 3; a++) affine[a] += e[q].w * s->v[a];
            if (!j->affine) continue;
            double r[3] = {x[0] - n->x[0], x[1] - n->x[1], x[2] - n->x[2]};
            for (int a = 0; a < 3; a++) plain[a] += e[q].w * s->plain[a], affine[a] += e[q].w * dot(s->C + 3 * a, r);
        }
        const double *slip = j->affine ? plain : affine;
        double rest = 0;
        p->along = 0;
        for (int a = 0; a < 3; a++) {
            p->along += (v[a] - affine[a]) * p->n[a];
            p->u[a] = v[a] - slip[a];
            rest += p->u[a] * p->n[a];
        }
        for (int a = 0; a < 3; a++) p->u[a] -= rest * p->n[a]; // tangential from here on
        p->target = least_velocity(j, p->gap, p->along);
        // A node that cannot give way leaves it to the other surface's nodes to stop at its own, which they do exactly,
        // until it is inside: pressing on a free surface through the grid throws that back by some 5 % of the approach.
        bool waits = p->gap >= -SLOP * j->m->cell && !can_move(j->surface, p->node);
        p->presses = p->along < p->target && !waits;
    }
}

static void send_pressing(void *context, int32_t begin, int32_t end) {
    const averaged_job *j = context;
    for (int32_t k = begin; k < end; k++) {
        const averaged_node *p = &j->work->averaged_node[j->node_first[j->of] + k];
        if (!p->presses) continue;
        const entry *e = entries_of(j, p, false);
        for (int q = 0; q < p->slave_count; q++)
            j->work->shared[e[q].at].side[j->of].pressing += e[q].w * j->surface->mass[p->node];
    }
}

// What an impulse of 1 along a unit vector does to the relative velocity, others pressing too [1/kg].
static double compliance(const brunt_contact_surface *surface, const averaged_node *p, const double yield[3],
                         const double along[3]) {
    double sum = 0;
    for (int a = 0; a < 3; a++)
        sum += along[a] * along[a] * (surface->inverse[p->node][a] + yield[a] / surface->mass[p->node]);
    return sum;
}

static void press(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const averaged_job *j = context;
    brunt_contact_surface *surface = j->surface;
    for (int64_t k = begin; k < end; k++) {
        averaged_node *p = &j->work->averaged_node[j->node_first[!j->master] + k];
        if (!p->presses) continue;
        const entry *e = entries_of(j, p, false);
        double yield[3] = {0};
        for (int q = 0; q < p->slave_count; q++) {
            const side *s = j->work->shared[e[q].at].side;
            for (int a = 0; a < 3; a++) yield[a] += e[q].w * s[!j->master].pressing * s[j->master].inverse[a];
        }
        double normal = compliance(surface, p, yield, p->n);
        p->presses = normal > 0; // else neither of the two can move
        if (!p->presses) continue;
        double normal_impulse = (p->target - p->along) / normal, friction_impulse = 0,
               t[3] = {p->u[0], p->u[1], p->u[2]};
        double slip = normalise(t), tangential = compliance(surface, p, yield, t);
        if (j->friction > 0 && slip > 0 && tangential > 0) {
            friction_impulse = brunt_coulomb_size(j->friction, normal_impulse, slip / tangential);
            p->friction_loss += friction_impulse * (slip - 0.5 * friction_impulse * tangential);
        }
        p->normal_impulse += normal_impulse, p->friction_impulse += friction_impulse;
        for (int a = 0; a < 3; a++) p->J[a] = normal_impulse * p->n[a] - friction_impulse * t[a];
        give_impulse(j, &j->work->touched[p->touched], p->J);
        p->pressed = true;
        surface->output.state[p->node] = p->friction_impulse < j->friction * p->normal_impulse * (1 - STUCK) ? 1 : 2;
    }
}

static void send_reaction(void *context, int32_t begin, int32_t end) {
    const averaged_job *j = context;
    for (int32_t k = begin; k < end; k++) {
        const averaged_node *p = &j->work->averaged_node[j->node_first[j->of] + k];
        if (!p->presses) continue;
        const entry *e = entries_of(j, p, false);
        const double *x = j->surface->x[p->node];
        for (int q = 0; q < p->slave_count; q++) {
            shared_node *n = &j->work->shared[e[q].at];
            side *s = &n->side[!j->of];
            for (int a = 0; a < 3; a++) {
                double F = e[q].w * p->J[a];
                s->F[a] -= F;
                for (int b = 0; b < 3 && j->affine; b++) s->T[3 * a + b] -= F * (x[b] - n->x[b]);
            }
        }
    }
}

static void take_reaction(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const averaged_job *j = context;
    const brunt_contact_surface *surface = j->surface;
    for (int64_t k = begin; k < end; k++) {
        const averaged_node *p = &j->work->averaged_node[j->node_first[j->master] + k];
        if (!p->master_count) continue;
        const entry *e = entries_of(j, p, true);
        changed_node *t = &j->work->touched[p->touched];
        const double *x = surface->x[p->node], mass = surface->mass[p->node];
        double F[3] = {0}, D[9] = {0};
        for (int q = 0; q < p->master_count; q++) {
            const shared_node *n = &j->work->shared[e[q].at];
            const side *s = &n->side[j->master];
            for (int a = 0; a < 3; a++) {
                double w = mass_share(s, e[q].w, mass, surface->inverse[p->node][a], a);
                F[a] += w * s->F[a];
                for (int b = 0; b < 3 && j->affine; b++)
                    D[3 * a + b] += w * (s->F[a] * (n->x[b] - x[b]) + s->T[3 * a + b]);
            }
        }
        give_impulse(j, t, F);
        if (j->affine) memcpy(t->D, D, sizeof D);
    }
}

void brunt_averaged_run(averaged_job *j, int64_t count, brunt_task_fn *task) {
    int threads = count < BRUNT_AUGURY_PARALLEL ? 1 : j->m->threads;
    brunt_parallel(threads, count, NODE_GRAIN, task, j, j->m->timer);
}

// One sweep, with nodes of the body other than j->master as slaves. Whether any of them was held back.
bool brunt_averaged_sweep(averaged_job *j) {
    brunt_averaged_work *work = j->work;
    const int master = j->master, slave = !master;
    const int64_t masters = j->node_first[master + 1] - j->node_first[master];
    const int64_t slaves = j->node_first[slave + 1] - j->node_first[slave];
    const int64_t faces = j->face_first[master + 1] - j->face_first[master];
    const int64_t touched = j->touched_first[master + 1] - j->touched_first[master];
    for (int32_t i = 0; i < work->shared_count; i++) {
        side *s = &work->shared[i].side[master];
        for (int a = 0; a < 3; a++) s->v[a] = s->plain[a] = s->F[a] = 0;
        for (int a = 0; a < 9; a++) s->C[a] = s->T[a] = 0;
        work->shared[i].side[slave].pressing = 0;
    }
    if (j->affine)
        brunt_averaged_run(j, faces, brunt_averaged_measure_faces),
            brunt_averaged_run(j, touched, brunt_averaged_measure_nodes);
    brunt_averaged_scatter(j, master, send_motion);
    brunt_averaged_run(j, slaves, find_pressing);
    bool any = false;
    for (int64_t k = 0; k < slaves; k++) any |= work->averaged_node[j->node_first[slave] + k].presses;
    if (!any) return false;
    brunt_averaged_scatter(j, slave, send_pressing);
    brunt_averaged_run(j, slaves, press);
    brunt_averaged_scatter(j, slave, send_reaction);
    brunt_averaged_run(j, masters, take_reaction);
    if (j->affine)
        brunt_averaged_run(j, faces, brunt_averaged_load_faces),
            brunt_averaged_run(j, touched, brunt_averaged_give_dipoles);
    return true;
}
