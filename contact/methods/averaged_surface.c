// Contact by impulses between nodes and grid-averaged surfaces: forms "surface" and "smooth".
//
// Per pair of bodies A and B, all sums over what lies within reach of grid node i, N the quadratic B-spline:
//   1. S = sum N a_f, s = sum N a_f n_f of each body's faces; d = unit(c_A^4 s_A/|s_A| - c_B^4 s_B/|s_B|), from A to B,
//      with the coherence c = |s|/S: where a surface turns by much, the other's direction counts. Once more with only
//      those faces that look along d, which drops the far side of thin bodies.
//   2. the facing surface of each body: W = sum N a, X = sum N a x_f / W, n = unit(sum N a n_f) of faces along d;
//      M = sum N m of nodes along d, the mass that takes reactions
//   3. sweeps; in each, nodes p of one body (the slaves) against the surface of the other (the master):
//      gap g = sum w n . (x_p - X), u = v_p - sum w v_i, w the masked and normalised N; where u.n < target = -g/dt, an
//      impulse with Coulomb's limit, and its reaction through the grid to the master's nodes
// Masters' effective masses come from the slaves that press at the same time, so that a sweep cannot raise the kinetic
// energy (Cauchy for the sum on the grid, Jensen for what nodes get back).
//
// "smooth" takes C = grad v of each node from its faces and extends affinely:
//   v_i = sum N m (v_q + C_q (x_i - x_q))/M,  C_i = sum N m C_q/M,  v(x_p) = sum w (v_i + C_i (x_p - x_i))
// and hands reactions back by the exact transpose, down to the nodes of the faces. As u is 0 for every rigid motion of
// both bodies, impulses with their reactions have no resultant and no moment. Coulomb's slip uses plain averages: with
// affine ones a bouncing block creeps sideways twice as far. "surface" uses plain averages for all, and a rigid spin of
// the nodes it changed takes the moment away that is left, for pairs without prescribed nodes.
//
// No constraints of the common solver are made of it: which nodes press is decided anew in each sweep, the effective
// masses with it, and what one has given is not taken back, so that there is no impulse in all to hold to the cone.
// Friction of a sweep is within the cone of that sweep (coulomb.h).
//
// Prescribed components have infinite mass: a cluster that holds one moves with it, and reactions end there.
// Tried and worse: impulses at grid nodes (half a cell of overlap at edges), faces as carriers of momentum (half the
// approach stays), memory of slip, pushing out in "smooth" (adds up to 7 % of energy: M knows nothing of the moments).
#include <math.h>
#include <string.h>
#include "contact/methods/averaged_surface_parts.h"

void brunt_averaged_work_free(brunt_averaged_work *work) {
    if (!work) return;
#define FREE(type, name) brunt_free(work->name);
    ARRAYS(FREE)
#undef FREE
    brunt_free(work);
}

// Slot of a node that may change. BRUNT_NONE: out of memory.
static int32_t touch(averaged_job *j, int32_t node, brunt_error *error) {
    brunt_averaged_work *work = j->work;
    if (work->touched_of[node] >= 0) return work->touched_of[node];
    if (NEED(work, touched, work->touched_count + 1, work->touched_count, "nodes that contact may change", error))
        return BRUNT_NONE;
    changed_node *t = &work->touched[work->touched_count];
    *t = (changed_node){.node = node};
    memcpy(t->before, j->surface->v[node], sizeof t->before);
    return work->touched_of[node] = work->touched_count++;
}

static int touch_face(averaged_job *j, int32_t face, brunt_error *error) {
    brunt_averaged_work *work = j->work;
    if (work->face_of[face] >= 0) return BRUNT_OK;
    if (NEED(work, face, work->face_count + 1, work->face_count, "faces that contact may change", error))
        return BRUNT_FAILED;
    work->face[work->face_count].face = face;
    brunt_averaged_make_facets(j->surface, &work->face[work->face_count]);
    work->face_of[face] = work->face_count++;
    for (int k = 0; k < 4 && j->surface->face[face][k] >= 0; k++)
        if (touch(j, j->surface->face[face][k], error) < 0) return BRUNT_FAILED;
    return BRUNT_OK;
}

// Everything that may change, body by body.
static int touch_all(averaged_job *j, brunt_error *error) {
    brunt_averaged_work *work = j->work;
    const brunt_contact_surface *s = j->surface;
    work->touched_count = work->face_count = 0;
    for (int b = 0; b < 2; b++) {
        j->touched_first[b] = work->touched_count, j->face_first[b] = work->face_count;
        for (int32_t k = j->node_first[b]; k < j->node_first[b + 1]; k++) {
            averaged_node *p = &work->averaged_node[k];
            if (!p->master_count && !p->meets) continue;
            if ((p->touched = touch(j, p->node, error)) < 0) return BRUNT_FAILED;
            work->touched[p->touched].master = p->master_count > 0;
            if (!j->affine || !p->master_count) continue;
            for (int32_t q = s->face_first[p->node]; q < s->face_first[p->node + 1]; q++) {
                if (touch_face(j, s->face_of[q], error)) return BRUNT_FAILED;
                const used_face *f = &work->face[work->face_of[s->face_of[q]]];
                for (int c = 0; c < f->facet_count; c++) work->touched[p->touched].area += f->facet[c].weight;
            }
        }
    }
    j->touched_first[2] = work->touched_count, j->face_first[2] = work->face_count;
    return BRUNT_OK;
}

static void untouch_all(brunt_averaged_work *work) {
    for (int32_t k = 0; k < work->touched_count; k++) work->touched_of[work->touched[k].node] = -1;
    for (int32_t k = 0; k < work->face_count; k++) work->face_of[work->face[k].face] = -1;
    work->touched_count = work->face_count = 0;
}

static bool changed(const averaged_job *j, const changed_node *t) {
    return memcmp(t->before, j->surface->v[t->node], sizeof t->before) != 0;
}

// Solves I w = T for a symmetric I (xx yy zz xy xz yz) that may be nearly singular. False: nothing to turn.
static bool spin_of(const double I[6], const double T[3], double w[3]) {
    const double some = 1e-7 * (I[0] + I[1] + I[2]);
    const double a = I[0] + some, b = I[1] + some, c = I[2] + some, d = I[3], e = I[4], f = I[5];
    const double c0 = b * c - f * f, c1 = e * f - d * c, c2 = d * f - b * e, det = a * c0 + d * c1 + e * c2;
    if (!(det > 0)) return false;
    const double inv[6] = {c0 / det, (a * c - e * e) / det, (a * b - d * d) / det, c1 / det,
                           c2 / det, (d * e - a * f) / det};
    double left[3] = {T[0], T[1], T[2]};
    w[0] = w[1] = w[2] = 0;
    for (int k = 0; k < 3; k++) { // the little that was added to I is taken back by refinement
        w[0] += inv[0] * left[0] + inv[3] * left[1] + inv[4] * left[2];
        w[1] += inv[3] * left[0] + inv[1] * left[1] + inv[5] * left[2];
        w[2] += inv[4] * left[0] + inv[5] * left[1] + inv[2] * left[2];
        left[0] = T[0] - (I[0] * w[0] + I[3] * w[1] + I[4] * w[2]);
        left[1] = T[1] - (I[3] * w[0] + I[1] * w[1] + I[5] * w[2]);
        left[2] = T[2] - (I[4] * w[0] + I[5] * w[1] + I[2] * w[2]);
    }
    return true;
}

// Gives the nodes that changed the rigid spin that takes back the moment of their impulses.
static void repair_moment(averaged_job *j) {
    const brunt_averaged_work *work = j->work;
    brunt_contact_surface *s = j->surface;
    double mass = 0, centre[3] = {0}, T[3] = {0}, I[6] = {0}, w[3];
    for (int32_t k = 0; k < work->touched_count; k++) {
        const changed_node *t = &work->touched[k];
        if (!changed(j, t)) continue;
        mass += s->mass[t->node];
        for (int a = 0; a < 3; a++) centre[a] += s->mass[t->node] * s->x[t->node][a];
    }
    if (!(mass > 0)) return;
    for (int a = 0; a < 3; a++) centre[a] /= mass;
    for (int32_t k = 0; k < work->touched_count; k++) {
        const changed_node *t = &work->touched[k];
        if (!changed(j, t)) continue;
        const double m = s->mass[t->node];
        double r[3], dv[3], moment[3];
        for (int a = 0; a < 3; a++) r[a] = s->x[t->node][a] - centre[a], dv[a] = s->v[t->node][a] - t->before[a];
        cross(r, dv, moment);
        for (int a = 0; a < 3; a++) T[a] += m * moment[a], I[a] += m * (dot(r, r) - r[a] * r[a]);
        I[3] -= m * r[0] * r[1], I[4] -= m * r[0] * r[2], I[5] -= m * r[1] * r[2];
    }
    if (!spin_of(I, T, w)) return;
    for (int32_t k = 0; k < work->touched_count; k++) {
        const changed_node *t = &work->touched[k];
        if (!changed(j, t)) continue;
        double r[3], turn[3];
        for (int a = 0; a < 3; a++) r[a] = s->x[t->node][a] - centre[a];
        cross(w, r, turn);
        for (int a = 0; a < s->dim; a++) s->v[t->node][a] -= turn[a];
    }
}

// Notes what was done.
static int remember_pair(averaged_job *j, const brunt_augury_neighbours *near, brunt_error *error) {
    brunt_averaged_work *work = j->work;
    const brunt_contact_surface *s = j->surface;
    if (NEED(work, impulse, work->impulse_count + work->touched_count, work->impulse_count, "impulses on nodes",
             error) ||
        NEED(work, pair_account, work->pair_account_count + 1, work->pair_account_count, "accounts of pairs", error))
        return BRUNT_FAILED;
    pair_account *d = &work->pair_account[work->pair_account_count];
    *d = (pair_account){.pair = near->pair, .first = work->impulse_count, .body_b = brunt_augury_body(s, near->b)};
    for (int32_t k = 0; k < work->touched_count; k++) {
        const changed_node *t = &work->touched[k];
        brunt_node_impulse *J = &work->impulse[work->impulse_count];
        bool any = false;
        J->node = t->node;
        for (int a = 0; a < 3; a++) {
            double inverse = s->inverse[t->node][a];
            J->J[a] = inverse > 0 ? (s->v[t->node][a] - t->before[a]) / inverse : t->fixed_impulse[a];
            any |= J->J[a] != 0;
        }
        work->impulse_count += any;
    }
    double area[2] = {0};
    for (int32_t k = 0; k < j->node_first[2]; k++) {
        const averaged_node *p = &work->averaged_node[k];
        d->friction_loss += p->friction_loss;
        if (p->pressed) area[k >= j->node_first[1]] += s->area[p->node];
    }
    d->area = fmax(area[0], area[1]);
    d->end = work->impulse_count;
    work->pair_account_count += d->end > d->first;
    return BRUNT_OK;
}

static int meet_pair(averaged_job *j, const brunt_augury_neighbours *near, brunt_error *error) {
    brunt_averaged_work *work = j->work;
    j->friction = j->m->pairs[near->pair].friction;
    bool some = false;
    if (brunt_averaged_collect(j, near->a, near->b, &some, error)) return BRUNT_FAILED;
    if (some && brunt_averaged_orient(j, &some, error)) return BRUNT_FAILED;
    if (!some) return BRUNT_OK;
    brunt_averaged_face(j);
    j->node_first[0] = 0;
    j->node_first[1] = j->w->cloud[0].count;
    j->node_first[2] = j->node_first[1] + j->w->cloud[1].count;
    if (NEED(work, averaged_node, j->node_first[2], 0, "nodes near the other body", error) ||
        NEED(work, entries, 2 * STENCIL * (size_t)j->node_first[2], 0, "grid nodes about nodes near the other body",
             error))
        return BRUNT_FAILED;
    brunt_averaged_run(j, j->node_first[2], brunt_averaged_list_entries);
    int status = touch_all(j, error);
    // Two sweeps in a row without work: nothing will change any more.
    for (int k = 0, idle = 0; !status && k < j->m->iterations && idle < 2; k++) {
        j->master = (k + j->m->step) % 2 != 0;
        idle = brunt_averaged_sweep(j) ? 0 : idle + 1;
    }
    if (!status && !j->affine && !work->fixed[near->a] && !work->fixed[near->b]) repair_moment(j);
    if (!status) status = remember_pair(j, near, error);
    untouch_all(work);
    return status;
}

static void find_fixed(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const averaged_job *j = context;
    const brunt_contact_surface *s = j->surface;
    for (int64_t k = begin; k < end; k++) {
        j->work->fixed[k] = false;
        if (!s->active[k]) continue;
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++)
            for (int a = 0; a < s->dim; a++) j->work->fixed[k] |= !(s->inverse[n][a] > 0);
    }
}

static int prepare(averaged_job *j, brunt_error *error) {
    brunt_averaged_work *work = j->work;
    const brunt_contact_surface *s = j->surface;
    if (NEED(work, touched_of, s->node_count, work->marked_nodes, "nodes of surfaces", error) ||
        NEED(work, face_of, s->face_count, work->marked_faces, "faces of surfaces", error) ||
        NEED(work, fixed, s->fem_count, 0, "bodies with surfaces", error))
        return BRUNT_FAILED;
    for (; work->marked_nodes < s->node_count; work->marked_nodes++) work->touched_of[work->marked_nodes] = -1;
    for (; work->marked_faces < s->face_count; work->marked_faces++) work->face_of[work->marked_faces] = -1;
    work->impulse_count = work->pair_account_count = 0;
    brunt_parallel(j->m->threads, s->fem_count, 1, find_fixed, j, j->m->timer);
    return brunt_augury_near_runs(&j->w->near, s, j->m->threads, j->m->timer, error);
}

static void account_pairs(const averaged_job *j) {
    for (int32_t k = 0; k < j->work->pair_account_count; k++) {
        const pair_account *d = &j->work->pair_account[k];
        brunt_impulse_account *account = &j->m->pairs[d->pair].last;
        double loss = 0;
        for (int32_t i = d->first; i < d->end; i++) {
            const brunt_node_impulse *J = &j->work->impulse[i];
            loss += brunt_impulse_account_node(j->surface, account, J, j->surface->body[J->node] == d->body_b);
        }
        account->friction_loss += d->friction_loss;
        account->normal_loss += loss - d->friction_loss;
        account->area += d->area;
    }
}

int brunt_augury_surface(const brunt_contact_context *m, bool affine, brunt_augury_workspace **work,
                         brunt_error *error) {
    brunt_augury_workspace *w = brunt_augury_work(work, error);
    if (!w) return BRUNT_FAILED;
    if (!w->averaged && BRUNT_NEW(w->averaged, 1, "room for averaged surfaces", error)) return BRUNT_FAILED;
    if (brunt_augury_near_find(&w->near, m, STENCIL_WIDTH * m->cell, error)) return BRUNT_FAILED;
    if (!w->near.count) return BRUNT_OK;
    averaged_job j = {.m = m, .surface = m->surface, .w = w, .work = w->averaged, .affine = affine};
    if (prepare(&j, error)) return BRUNT_FAILED;
    for (int32_t k = 0; k < w->near.count; k++)
        if (meet_pair(&j, &w->near.found[k], error)) return BRUNT_FAILED;
    account_pairs(&j);
    return BRUNT_OK;
}
