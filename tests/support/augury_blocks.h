// Blocks with surfaces and lumped masses, as contact sees them: a skin without an engine around it. Tetrahedra (six a
// cell, all along the same diagonal), hexahedra, or in 2D quadrilaterals. Tetrahedra can be stretched too: neo-Hookean
// forces, for short runs in leap-frog.
#pragma once

#include "tests/support/suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "contact/methods/augury.h"

typedef enum blocks_kind { BLOCKS_TETS, BLOCKS_HEXES, BLOCKS_PLANE } blocks_kind;

enum { BLOCKS_LIMIT = 520 };

typedef struct blocks {
    blocks_kind kind;
    int count; // bodies
    int32_t node_count, tet_count;
    double (*x)[3], (*v)[3], (*old)[3], (*force)[3], *mass;
    uint8_t *held;                     // bits of components with prescribed velocity
    int32_t *body, *number, (*tet)[4]; // number in the skin, -1 inside
    double (*inverse)[9], *volume, (*lame)[2];
    brunt_contact_surface surface;
    brunt_pair *pairs;
    brunt_pair_map pair_map;
    double elastic; // [J] of the last forces
} blocks;

typedef struct block_def {
    double low[3], size[3];
    int cells[3];
    double rotation[9], shift[3]; // x = R X + shift
    double velocity[3], density, E, nu;
} block_def;

static const double blocks_upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

#define BLOCKS_GROW(array, count) ((array) = realloc((array), (size_t)((count) + 1) * sizeof *(array)))
// Room for one more after `count`: doubled at each power of two.
#define BLOCKS_PUSH(array, count)                                                                                      \
    if (((count) & ((count)-1)) == 0) BLOCKS_GROW(array, 2 * (count) + 1)

static inline void blocks_grow_nodes(blocks *b, int32_t n) {
    BLOCKS_GROW(b->x, n), BLOCKS_GROW(b->v, n), BLOCKS_GROW(b->old, n), BLOCKS_GROW(b->force, n);
    BLOCKS_GROW(b->mass, n), BLOCKS_GROW(b->held, n), BLOCKS_GROW(b->body, n), BLOCKS_GROW(b->number, n);
}

static inline void blocks_invert(const double M[9], double I[9], double *det) {
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            int i = (c + 1) % 3, j = (c + 2) % 3, k = (r + 1) % 3, l = (r + 2) % 3;
            I[3 * r + c] = M[3 * i + k] * M[3 * j + l] - M[3 * i + l] * M[3 * j + k];
        }
    *det = M[0] * I[0] + M[1] * I[3] + M[2] * I[6];
    for (int a = 0; a < 9; a++) I[a] /= *det;
}

static inline void blocks_edges(const blocks *b, const int32_t *t, double M[9]) {
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) M[3 * a + k] = b->x[t[k + 1]][a] - b->x[t[0]][a];
}

static inline void blocks_add_tets(blocks *b, const block_def *d, const int32_t *corner) {
    static const int path[6][3] = {{1, 3, 7}, {1, 5, 7}, {2, 3, 7}, {2, 6, 7}, {4, 5, 7}, {4, 6, 7}};
    for (int p = 0; p < 6; p++) {
        int32_t n = b->tet_count++;
        BLOCKS_PUSH(b->tet, n);
        BLOCKS_PUSH(b->inverse, n);
        BLOCKS_PUSH(b->volume, n);
        BLOCKS_PUSH(b->lame, n);
        int32_t t[4] = {corner[0], corner[path[p][0]], corner[path[p][1]], corner[path[p][2]]};
        double M[9], det;
        blocks_edges(b, t, M);
        blocks_invert(M, b->inverse[n], &det);
        if (det < 0) {
            int32_t swap = t[1];
            t[1] = t[2], t[2] = swap;
            blocks_edges(b, t, M);
            blocks_invert(M, b->inverse[n], &det);
        }
        memcpy(b->tet[n], t, sizeof t);
        b->volume[n] = det / 6;
        b->lame[n][0] = d->E / 2 / (1 + d->nu), b->lame[n][1] = d->E * d->nu / (1 + d->nu) / (1 - 2 * d->nu);
        for (int k = 0; k < 4; k++) b->mass[t[k]] += d->density * b->volume[n] / 4;
    }
}

static inline void blocks_add_face(blocks *b, const int32_t *node, int corners) {
    brunt_contact_surface *s = &b->surface;
    int32_t f = s->face_count++;
    BLOCKS_PUSH(s->face, f);
    for (int k = 0; k < 4; k++) s->face[f][k] = k < corners ? node[k] : -1;
}

// Sides of a structured block as quadrilaterals, or segments in 2D, outward.
static inline void blocks_add_sides(blocks *b, const int n[3], int32_t first) {
    const int dim = b->kind == BLOCKS_PLANE ? 2 : 3;
    for (int axis = 0; axis < dim; axis++)
        for (int end = 0; end < 2; end++) {
            int u = (axis + 1) % 3, v = (axis + 2) % 3, c[3];
            for (int j = 0; j < (dim == 3 ? n[v] : 1); j++)
                for (int i = 0; i < n[dim == 3 ? u : 1 - axis]; i++) {
                    int32_t q[4];
                    for (int k = 0; k < (dim == 3 ? 4 : 2); k++) {
                        c[axis] = end ? n[axis] : 0;
                        if (dim == 3)
                            c[u] = i + (k == 1 || k == 2), c[v] = j + (k >= 2);
                        else
                            c[1 - axis] = i + k, c[2] = 0;
                        q[k] = first + c[0] + (n[0] + 1) * (c[1] + (n[1] + 1) * c[2]);
                    }
                    bool turn = dim == 3 ? !end : (axis == 0) != (end == 1);
                    int last = dim == 3 ? 3 : 1, one = dim == 3 ? 1 : 0;
                    if (turn) {
                        int32_t swap = q[one];
                        q[one] = q[last], q[last] = swap;
                    }
                    blocks_add_face(b, q, last + 1);
                }
        }
}

static inline int blocks_compare(const void *p, const void *q) { return memcmp(p, q, 3 * sizeof(int32_t)); }

// Faces that only one tetrahedron has, in the order of the tetrahedra.
static inline void blocks_add_tet_faces(blocks *b, int32_t first_tet) {
    static const int corner[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    int32_t n = 4 * (b->tet_count - first_tet), (*key)[4] = malloc((size_t)n * sizeof *key);
    uint8_t *outside = calloc((size_t)n, 1);
    for (int32_t i = 0; i < n; i++) {
        int32_t *k = key[i];
        for (int c = 0; c < 3; c++) k[c] = b->tet[first_tet + i / 4][corner[i % 4][c]];
        for (int c = 0; c < 3; c++)
            for (int e = 0; e < 2; e++)
                if (k[e] > k[e + 1]) {
                    int32_t swap = k[e];
                    k[e] = k[e + 1], k[e + 1] = swap;
                }
        k[3] = i;
    }
    qsort(key, (size_t)n, sizeof *key, blocks_compare);
    for (int32_t i = 0; i < n; i++) {
        bool twin = (i + 1 < n && !blocks_compare(key[i], key[i + 1])) || (i && !blocks_compare(key[i], key[i - 1]));
        outside[key[i][3]] = !twin;
    }
    for (int32_t i = 0; i < n; i++) {
        if (!outside[i]) continue;
        int32_t q[3];
        for (int c = 0; c < 3; c++) q[c] = b->tet[first_tet + i / 4][corner[i % 4][c]];
        blocks_add_face(b, q, 3);
    }
    free(key);
    free(outside);
}

static inline void blocks_add(blocks *b, const block_def *d) {
    const bool plane = b->kind == BLOCKS_PLANE;
    const int n[3] = {d->cells[0], d->cells[1], plane ? 0 : d->cells[2]};
    const int32_t first = b->node_count, first_tet = b->tet_count, first_face = b->surface.face_count;
    const int32_t added = (n[0] + 1) * (n[1] + 1) * (n[2] + 1);
    blocks_grow_nodes(b, first + added);
    for (int32_t i = 0; i < added; i++, b->node_count++) {
        int c[3] = {i % (n[0] + 1), i / (n[0] + 1) % (n[1] + 1), i / ((n[0] + 1) * (n[1] + 1))};
        double X[3];
        for (int a = 0; a < 3; a++) X[a] = n[a] ? d->low[a] + d->size[a] * c[a] / n[a] : 0;
        int32_t at = b->node_count;
        for (int a = 0; a < 3; a++) {
            const double *R = d->rotation + 3 * a;
            b->x[at][a] = R[0] * X[0] + R[1] * X[1] + R[2] * X[2] + d->shift[a];
            b->v[at][a] = b->old[at][a] = d->velocity[a];
        }
        b->mass[at] = 0, b->held[at] = 0, b->body[at] = b->count, b->number[at] = -1;
    }
    double cell_mass = d->density * d->size[0] * d->size[1] / n[0] / n[1];
    if (!plane) cell_mass *= d->size[2] / n[2];
    for (int z = 0; z < (plane ? 1 : n[2]); z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) {
                int32_t corner[8];
                for (int k = 0; k < 8; k++)
                    corner[k] = first + x + (k & 1) + (n[0] + 1) * (y + (k >> 1 & 1) + (n[1] + 1) * (z + (k >> 2)));
                if (b->kind == BLOCKS_TETS)
                    blocks_add_tets(b, d, corner);
                else
                    for (int k = 0; k < (plane ? 4 : 8); k++) b->mass[corner[k]] += cell_mass / (plane ? 4 : 8);
            }
    if (b->kind == BLOCKS_TETS)
        blocks_add_tet_faces(b, first_tet);
    else
        blocks_add_sides(b, n, first);
    brunt_contact_surface *s = &b->surface;
    BLOCKS_GROW(s->face_body, s->face_count);
    for (int32_t f = first_face; f < s->face_count; f++) {
        s->face_body[f] = b->count;
        for (int k = 0; k < 4 && s->face[f][k] >= 0; k++) b->number[s->face[f][k]] = 0;
    }
    b->count++;
}

// The skin of all blocks, and a pair of each two.
static inline void blocks_finish(blocks *b, double friction) {
    brunt_contact_surface *s = &b->surface;
    s->dim = b->kind == BLOCKS_PLANE ? 2 : 3;
    s->fem_count = b->count;
    s->node_range = calloc((size_t)b->count + 2, sizeof(int32_t));
    s->face_range = calloc((size_t)b->count + 2, sizeof(int32_t));
    s->low = calloc((size_t)b->count, sizeof *s->low), s->high = calloc((size_t)b->count, sizeof *s->high);
    s->active = malloc((size_t)b->count);
    memset(s->active, 1, (size_t)b->count);
    for (int32_t i = 0; i < b->node_count; i++)
        if (b->number[i] == 0) b->number[i] = s->node_count++, s->node_range[b->body[i] + 1] = s->node_count;
    for (int32_t f = 0; f < s->face_count; f++) {
        s->face_range[s->face_body[f] + 1] = f + 1;
        for (int k = 0; k < 4 && s->face[f][k] >= 0; k++) s->face[f][k] = b->number[s->face[f][k]];
    }
    size_t n = (size_t)s->node_count, m = (size_t)s->face_count;
    s->body = calloc(n, sizeof *s->body), s->node = calloc(n, sizeof *s->node);
    s->x = calloc(n, sizeof *s->x), s->v = calloc(n, sizeof *s->v), s->old = calloc(n, sizeof *s->old);
    s->mass = calloc(n, sizeof *s->mass), s->inverse = calloc(n, sizeof *s->inverse);
    s->normal = calloc(n, sizeof *s->normal), s->area = calloc(n, sizeof *s->area);
    s->affine = calloc(n, sizeof *s->affine), s->output.gap = calloc(n, sizeof *s->output.gap);
    s->output.impulse = calloc(n, sizeof *s->output.impulse), s->output.state = calloc(n, 1);
    s->face_normal = calloc(m, sizeof *s->face_normal), s->face_centre = calloc(m, sizeof *s->face_centre);
    s->face_area = calloc(m, sizeof *s->face_area);
    s->face_first = calloc(n + 2, sizeof(int32_t)), s->face_of = calloc(4 * m, sizeof(int32_t));
    for (size_t f = 0; f < m; f++)
        for (int k = 0; k < 4 && s->face[f][k] >= 0; k++) s->face_first[s->face[f][k] + 2]++;
    for (size_t i = 2; i < n + 2; i++) s->face_first[i] += s->face_first[i - 1];
    for (size_t f = 0; f < m; f++)
        for (int k = 0; k < 4 && s->face[f][k] >= 0; k++) s->face_of[s->face_first[s->face[f][k] + 1]++] = (int32_t)f;
    b->pairs = calloc((size_t)(b->count * b->count), sizeof *b->pairs);
    int32_t pair = 0;
    for (int p = 0; p < b->count; p++)
        for (int q = p + 1; q < b->count; q++, pair++) {
            b->pairs[pair] = (brunt_pair){.a = p, .b = q, .meets = BRUNT_MEET_AT_FACETS, .friction = friction};
            ck_assert_int_eq(brunt_pair_map_add(&b->pair_map, p, q, pair, NULL), 0);
        }
    brunt_pair_map_sort(&b->pair_map);
}

// Places and velocities to the skin, normals.
static inline void blocks_take(blocks *b) {
    brunt_contact_surface *s = &b->surface;
    for (int k = 0; k < b->count; k++)
        for (int a = 0; a < 3; a++) s->low[k][a] = INFINITY, s->high[k][a] = -INFINITY;
    for (int32_t i = 0; i < b->node_count; i++) {
        int32_t n = b->number[i];
        if (n < 0) continue;
        s->body[n] = b->body[i], s->node[n] = i, s->mass[n] = b->mass[i], s->area[n] = 0;
        s->output.gap[n] = INFINITY, s->output.state[n] = 0;
        for (int a = 0; a < 3; a++) {
            s->x[n][a] = b->x[i][a], s->v[n][a] = b->v[i][a], s->old[n][a] = b->old[i][a];
            s->inverse[n][a] = b->held[i] >> a & 1 || a >= s->dim ? 0 : 1 / b->mass[i];
            s->normal[n][a] = s->output.impulse[n][a] = 0;
            s->low[b->body[i]][a] = fmin(s->low[b->body[i]][a], b->x[i][a]);
            s->high[b->body[i]][a] = fmax(s->high[b->body[i]][a], b->x[i][a]);
        }
    }
    for (int32_t f = 0; f < s->face_count; f++) {
        const int32_t *q = s->face[f];
        int corners = q[2] < 0 ? 2 : q[3] < 0 ? 3 : 4;
        double e[3], g[3], n[3], size = 0;
        for (int a = 0; a < 3; a++) {
            e[a] = s->x[q[corners == 4 ? 2 : 1]][a] - s->x[q[0]][a];
            g[a] = corners == 4 ? s->x[q[3]][a] - s->x[q[1]][a] : corners == 3 ? s->x[q[2]][a] - s->x[q[0]][a] : 0;
            s->face_centre[f][a] = 0;
            for (int k = 0; k < corners; k++) s->face_centre[f][a] += s->x[q[k]][a] / corners;
        }
        for (int a = 0; a < 3; a++) n[a] = 0.5 * (e[(a + 1) % 3] * g[(a + 2) % 3] - e[(a + 2) % 3] * g[(a + 1) % 3]);
        if (corners == 2) n[0] = e[1], n[1] = -e[0], n[2] = 0;
        for (int a = 0; a < 3; a++) size += n[a] * n[a];
        size = sqrt(size);
        s->face_area[f] = size;
        for (int a = 0; a < 3; a++) s->face_normal[f][a] = n[a] / size;
        for (int k = 0; k < corners; k++) {
            s->area[q[k]] += size / corners;
            for (int a = 0; a < 3; a++) s->normal[q[k]][a] += n[a] / corners;
        }
    }
    for (int32_t n = 0; n < s->node_count; n++) {
        double size = 0;
        for (int a = 0; a < 3; a++) size += s->normal[n][a] * s->normal[n][a];
        for (int a = 0; a < 3; a++) s->normal[n][a] = size > 0 ? s->normal[n][a] / sqrt(size) : 0;
    }
}

static inline void blocks_give(blocks *b) {
    for (int32_t i = 0; i < b->node_count; i++)
        if (b->number[i] >= 0) memcpy(b->v[i], b->surface.v[b->number[i]], sizeof b->v[i]);
}

static inline brunt_contact_context blocks_meeting(blocks *b, double dt, double cell, int iterations, int threads) {
    for (int k = 0; k < b->count * b->count; k++) b->pairs[k].last = (brunt_impulse_account){.area = 0};
    return (brunt_contact_context){.surface = &b->surface,
                                   .pairs = b->pairs,
                                   .pair_map = &b->pair_map,
                                   .body_count = b->count,
                                   .dt = dt,
                                   .cell = cell,
                                   .iterations = iterations,
                                   .step = 1,
                                   .threads = threads};
}

static inline void blocks_free(blocks *b) {
    brunt_free(b->pair_map.entry);
    brunt_contact_surface *s = &b->surface;
    void *owned[] = {b->x,
                     b->v,
                     b->old,
                     b->force,
                     b->mass,
                     b->held,
                     b->body,
                     b->number,
                     b->tet,
                     b->inverse,
                     b->volume,
                     b->lame,
                     b->pairs,
                     s->face,
                     s->face_body,
                     s->node_range,
                     s->face_range,
                     s->low,
                     s->high,
                     s->active,
                     s->body,
                     s->node,
                     s->x,
                     s->v,
                     s->old,
                     s->mass,
                     s->inverse,
                     s->normal,
                     s->area,
                     s->affine,
                     s->output.gap,
                     s->output.impulse,
                     s->output.state,
                     s->face_normal,
                     s->face_centre,
                     s->face_area,
                     s->face_first,
                     s->face_of};
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) free(owned[k]);
    *b = (blocks){.kind = b->kind};
}

// Neo-Hookean forces of the tetrahedra, P = mu (F - F^-T) + lambda ln J F^-T, and their energy.
static inline void blocks_forces(blocks *b) {
    memset(b->force, 0, (size_t)b->node_count * sizeof *b->force);
    b->elastic = 0;
    for (int32_t e = 0; e < b->tet_count; e++) {
        double D[9], F[9] = {0}, I[9], J, square = 0;
        blocks_edges(b, b->tet[e], D);
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                for (int k = 0; k < 3; k++) F[3 * r + c] += D[3 * r + k] * b->inverse[e][3 * k + c];
        blocks_invert(F, I, &J);
        for (int k = 0; k < 9; k++) square += F[k] * F[k];
        const double mu = b->lame[e][0], lambda = b->lame[e][1], l = log(fmax(J, 0.05));
        b->elastic += b->volume[e] * (0.5 * mu * (square - 3) - mu * l + 0.5 * lambda * l * l);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) {
                double f = 0;
                for (int c = 0; c < 3; c++)
                    f -= b->volume[e] * (mu * F[3 * a + c] + (lambda * l - mu) * I[3 * c + a]) *
                         b->inverse[e][3 * k + c];
                b->force[b->tet[e][k + 1]][a] += f;
                b->force[b->tet[e][0]][a] -= f;
            }
    }
}
