// Velocity gradients of a surface by its facets, for form smooth, and the transpose.
#include "contact/methods/averaged_surface_parts.h"

static facet make_triangle(const brunt_contact_surface *s, const int32_t *node, int p, int q, int r, double weight) {
    facet t = {.corner = {(int8_t)p, (int8_t)q, (int8_t)r}, .count = 3};
    double e1[3], e2[3];
    for (int a = 0; a < 3; a++) {
        e1[a] = s->x[node[q]][a] - s->x[node[p]][a];
        e2[a] = s->x[node[r]][a] - s->x[node[p]][a];
    }
    cross(e1, e2, t.n);
    double twice = normalise(t.n);
    if (!(twice > 0)) return t;
    cross(e2, t.n, t.g[1]);
    cross(t.n, e1, t.g[2]);
    t.weight = weight * twice / 2;
    for (int a = 0; a < 3; a++) {
        t.g[1][a] /= twice, t.g[2][a] /= twice;
        t.g[0][a] = -t.g[1][a] - t.g[2][a];
    }
    return t;
}

static facet make_segment(const brunt_contact_surface *s, int32_t face) {
    const int32_t *node = s->face[face];
    facet t = {.corner = {0, 1, 0}, .count = 2, .weight = s->face_area[face]};
    double length = 0;
    for (int a = 0; a < 2; a++) {
        t.n[a] = s->face_normal[face][a];
        t.g[1][a] = s->x[node[1]][a] - s->x[node[0]][a];
        length += t.g[1][a] * t.g[1][a];
    }
    for (int a = 0; a < 2; a++) t.g[1][a] = length > 0 ? t.g[1][a] / length : 0, t.g[0][a] = -t.g[1][a];
    return t;
}

void brunt_averaged_make_facets(const brunt_contact_surface *s, used_face *f) {
    const int32_t *node = s->face[f->face];
    f->facet_count = 0;
    if (node[2] < 0) {
        f->facet[f->facet_count++] = make_segment(s, f->face);
    } else if (node[3] < 0) {
        f->facet[f->facet_count++] = make_triangle(s, node, 0, 1, 2, 1);
    } else {
        f->facet[f->facet_count++] = make_triangle(s, node, 0, 1, 2, 0.5);
        f->facet[f->facet_count++] = make_triangle(s, node, 0, 2, 3, 0.5);
        f->facet[f->facet_count++] = make_triangle(s, node, 0, 1, 3, 0.5);
        f->facet[f->facet_count++] = make_triangle(s, node, 1, 2, 3, 0.5);
    }
}

// grad v of a facet, as far as it shows: what its corners say along it, and the rotation of its normal,
//   L = sum_k v_k (x) g_k - (n . v_k) g_k (x) n,
// which is exact for rigid motions.
void brunt_averaged_measure_faces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const averaged_job *j = context;
    for (int64_t i = begin; i < end; i++) {
        used_face *f = &j->work->face[j->face_first[j->master] + i];
        const int32_t *node = j->surface->face[f->face];
        memset(f->L, 0, sizeof f->L);
        for (int t = 0; t < f->facet_count; t++) {
            const facet *c = &f->facet[t];
            for (int k = 0; k < c->count; k++) {
                const double *v = j->surface->v[node[c->corner[k]]], *g = c->g[k], rise = dot(c->n, v);
                for (int a = 0; a < 3; a++)
                    for (int b = 0; b < 3; b++) f->L[3 * a + b] += c->weight * (v[a] * g[b] - rise * g[a] * c->n[b]);
            }
        }
    }
}

void brunt_averaged_measure_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const averaged_job *j = context;
    for (int64_t i = begin; i < end; i++) {
        changed_node *t = &j->work->touched[j->touched_first[j->master] + i];
        if (!t->master) continue;
        memset(t->C, 0, sizeof t->C);
        memset(t->D, 0, sizeof t->D);
        for (int32_t q = j->surface->face_first[t->node]; q < j->surface->face_first[t->node + 1]; q++) {
            const double *L = j->work->face[j->work->face_of[j->surface->face_of[q]]].L;
            for (int a = 0; a < 9 && t->area > 0; a++) t->C[a] += L[a] / t->area;
        }
    }
}

// The transpose of the two: dipoles D of nodes to faces, and from there impulses on their corners,
//   F_k = weight (E g_k - n (g_k . E n)).
void brunt_averaged_load_faces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const averaged_job *j = context;
    for (int64_t i = begin; i < end; i++) {
        used_face *f = &j->work->face[j->face_first[j->master] + i];
        memset(f->E, 0, sizeof f->E);
        for (int k = 0; k < 4 && j->surface->face[f->face][k] >= 0; k++) {
            const changed_node *t = &j->work->touched[j->work->touched_of[j->surface->face[f->face][k]]];
            for (int a = 0; a < 9 && t->master && t->area > 0; a++) f->E[a] += t->D[a] / t->area;
        }
    }
}

void brunt_averaged_give_dipoles(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const averaged_job *j = context;
    for (int64_t i = begin; i < end; i++) {
        changed_node *t = &j->work->touched[j->touched_first[j->master] + i];
        double F[3] = {0};
        for (int32_t q = j->surface->face_first[t->node]; q < j->surface->face_first[t->node + 1]; q++) {
            const int32_t used = j->work->face_of[j->surface->face_of[q]];
            if (used < 0) continue;
            const used_face *f = &j->work->face[used];
            for (int c = 0; c < f->facet_count; c++)
                for (int k = 0; k < f->facet[c].count; k++) {
                    const facet *p = &f->facet[c];
                    if (j->surface->face[f->face][p->corner[k]] != t->node) continue;
                    double Eg[3], En[3];
                    for (int a = 0; a < 3; a++) Eg[a] = dot(f->E + 3 * a, p->g[k]), En[a] = dot(f->E + 3 * a, p->n);
                    double bend = dot(p->g[k], En);
                    for (int a = 0; a < 3; a++) F[a] += p->weight * (Eg[a] - bend * p->n[a]);
                }
        }
        give_impulse(j, t, F);
    }
}
