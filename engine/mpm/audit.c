// Sums over particles, several at once. The drift they measure is near rounding itself: each sum keeps what its
// additions round off (T. J. Dekker, Numer. Math. 18 (1971) 224; D. E. Knuth, The Art of Computer Programming
// 2, 4.2.2).
#include "mpm/audit.h"

#include <math.h>
#include <string.h>

#include "base/simd.h"
#include "grid/bspline.h"

// A sum and what was rounded off it.
typedef struct exact_sum {
    doubles sum, rest;
} exact_sum;

BRUNT_INLINE void add(exact_sum *to, doubles a) {
    const doubles sum = to->sum + a, part = sum - to->sum;
    to->rest += (to->sum - (sum - part)) + (a - part);
    to->sum = sum;
}

// Of all lanes, in their order.
static double total(const exact_sum *of) {
    double sum = 0, rest = 0;
    for (int l = 0; l < BRUNT_DOUBLES; l++) {
        const double a = of->sum[l], more = sum + a, part = more - sum;
        rest += ((sum - (more - part)) + (a - part)) + of->rest[l];
        sum = more;
    }
    return sum + rest;
}

typedef struct audit_sums {
    exact_sum mass, kinetic, linear[3], angular[3], moment[3], scale_linear, scale_angular;
} audit_sums;

// Where up to BRUNT_DOUBLES particles are: all behind `first`, or one by one in `slots`.
typedef struct group {
    bool whole;
    int64_t first;
    const int64_t *slots;
    int count;
} group;

// What is not there has the first one's numbers, and no mass.
BRUNT_INLINE doubles read(const group *g, const real *from) {
    if (g->whole) return doubles_of(from + g->first);
    doubles a = {0};
    for (int l = 0; l < BRUNT_DOUBLES; l++) a[l] = (double)from[g->slots[l < g->count ? l : 0]];
    return a;
}

BRUNT_INLINE doubles read_mass(const group *g, const real *mass) {
    doubles a = read(g, mass);
    for (int l = 0; l < BRUNT_DOUBLES; l++)
        if (l >= g->count) a[l] = 0;
    return a;
}

// The second moment of the kernel about a particle along one axis [m^2]: of all alike, but for the linear one.
BRUNT_INLINE doubles read_moment(const group *g, const brunt_grid *grid, const real *place, double origin) {
    const lanes any = bspline_moment(2, (lanes){0}, grid->h, grid->inv_h);
    if (grid->order == 2) return (double)any[0] - (doubles){0};
    doubles at = read(g, place);
    for (int l = 0; l < BRUNT_DOUBLES; l++)
        at[l] = (double)bspline_moment(grid->order, lanes_set((real)at[l] - (real)origin), grid->h, grid->inv_h)[0];
    return at;
}

// B = C D of the affine part, by row and column. The square of what it moves with [m^2/s^2].
BRUNT_INLINE doubles read_affine(const group *g, brunt_body *body, doubles B[3][3]) {
    brunt_particles *p = &body->particles;
    const brunt_grid *grid = &body->grid;
    real *const *C = brunt_field(p, BRUNT_FIELD_affine), *const *place = brunt_kernel_position(p);
    doubles square = {0};
    for (int k = 0; k < p->dim; k++) {
        const doubles D = read_moment(g, grid, place[k], grid->origin[k]);
        for (int r = 0; r < p->dim; r++) {
            const doubles c = read(g, C[r * p->dim + k]);
            B[r][k] = c * D;
            square += c * c * D;
        }
    }
    return square;
}

// The affine part has the lever arms of the undeformed kernel; F takes them to where they are.
static void deform(const group *g, brunt_particles *p, doubles B[3][3]) {
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    for (int r = 0; r < p->dim; r++) {
        doubles row[3] = {{0}};
        for (int c = 0; c < p->dim; c++)
            for (int k = 0; k < p->dim; k++) row[c] += B[r][k] * read(g, F[c * p->dim + k]);
        memcpy(B[r], row, sizeof row);
    }
}

BRUNT_INLINE void add_group(audit_sums *to, brunt_body *body, const group *g, int dim) {
    brunt_particles *p = &body->particles;
    real *const *x = brunt_field(p, BRUNT_FIELD_position), *const *v = brunt_field(p, BRUNT_FIELD_velocity);
    const doubles m = read_mass(g, brunt_field(p, BRUNT_FIELD_mass)[0]);
    doubles X[3] = {{0}}, V[3] = {{0}}, B[3][3] = {{{0}}}, square = {0}, size = {0};
    for (int k = 0; k < dim; k++) X[k] = read(g, x[k]), V[k] = read(g, v[k]), square += V[k] * V[k];
    if (p->field[BRUNT_FIELD_affine].components) square += read_affine(g, body, B);
    if (brunt_total_lagrangian(p)) deform(g, p, B);
    add(&to->mass, m);
    add(&to->kinetic, 0.5 * m * square);
    add(&to->scale_linear, m * doubles_sqrt(square));
    if (brunt_axisymmetric(p)) { // the circle's sums; only sizes are left of what cancels
        add(&to->linear[1], m * V[1]);
        add(&to->moment[1], m * X[1]);
        return;
    }
    for (int k = 0; k < dim; k++) {
        add(&to->linear[k], m * V[k]);
        add(&to->moment[k], m * X[k]);
        size += X[k] * X[k];
    }
    for (int k = dim == 2 ? 2 : 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        add(&to->angular[k], m * (X[i] * V[j] - X[j] * V[i] + (B[j][i] - B[i][j])));
    }
    add(&to->scale_angular, m * doubles_sqrt(square * size));
}

static brunt_audit read_sums(const audit_sums *sums) {
    brunt_audit a = {.mass = total(&sums->mass),
                     .kinetic = total(&sums->kinetic),
                     .scale_linear = total(&sums->scale_linear),
                     .scale_angular = total(&sums->scale_angular)};
    for (int k = 0; k < 3; k++) {
        a.linear[k] = total(&sums->linear[k]);
        a.angular[k] = total(&sums->angular[k]);
        a.moment[k] = total(&sums->moment[k]);
    }
    return a;
}

// The next particles, BRUNT_DOUBLES of them while there are as many, from place `*n` on of `slots` (NULL: of all):
// whatever padding lies between, they are the same together.
BRUNT_INLINE group next_group(const brunt_particles *p, const int64_t *slots, int64_t end, int64_t *n,
                              int64_t here[BRUNT_DOUBLES]) {
    group g = {.whole = !slots && *n + BRUNT_DOUBLES <= end, .first = *n, .slots = here, .count = BRUNT_DOUBLES};
    for (int l = 0; g.whole && l < BRUNT_DOUBLES; l++) g.whole = p->id[*n + l] >= 0;
    if (g.whole) {
        *n += BRUNT_DOUBLES;
        return g;
    }
    for (g.count = 0; g.count < BRUNT_DOUBLES && *n < end; ++*n) {
        const int64_t s = slots ? slots[*n] : *n;
        if (p->id[s] >= 0) here[g.count++] = s; // else padding, or left in the last step
    }
    return g;
}

BRUNT_INLINE brunt_audit sum_slots(brunt_body *body, const int64_t *slots, int64_t begin, int64_t end, int dim) {
    audit_sums sums;
    memset(&sums, 0, sizeof sums);
    for (int64_t n = begin; n < end;) {
        int64_t here[BRUNT_DOUBLES];
        const group g = next_group(&body->particles, slots, end, &n, here);
        if (g.whole)
            add_group(&sums, body, &(group){.whole = true, .first = g.first, .count = BRUNT_DOUBLES}, dim);
        else if (g.count)
            add_group(&sums, body, &g, dim);
    }
    return read_sums(&sums);
}

brunt_audit brunt_slots_audit(brunt_body *body, const int64_t *slots, int64_t begin, int64_t end) {
    return body->particles.dim == 3 ? sum_slots(body, slots, begin, end, 3) : sum_slots(body, slots, begin, end, 2);
}

brunt_audit brunt_body_audit(brunt_body *body) { return brunt_slots_audit(body, NULL, 0, body->particles.slots); }

void brunt_audit_add(brunt_audit *to, const brunt_audit *part) {
    to->mass += part->mass, to->kinetic += part->kinetic;
    to->scale_linear += part->scale_linear, to->scale_angular += part->scale_angular;
    for (int k = 0; k < 3; k++) {
        to->linear[k] += part->linear[k], to->angular[k] += part->angular[k];
        to->moment[k] += part->moment[k];
    }
}
