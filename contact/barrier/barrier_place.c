#include "contact/barrier/barrier_parts.h"

int32_t barrier_body_of(const brunt_barrier *b, int32_t point) {
    const barrier_rim *rim = barrier_rim_of(b, point);
    if (rim) return b->body[b->facet[rim->facet][0]];
    return point < b->vertex_count ? b->body[point] : b->step.particles.body[point - barrier_surface_points(b)];
}

const double *barrier_start(const brunt_barrier *b, int32_t place) {
    if (place < b->vertex_count) return b->step.x[place];
    const barrier_rim *rim = barrier_rim_of(b, place);
    if (rim) return rim->x;
    const int32_t particle = place - barrier_surface_points(b), plane = particle - b->step.particles.count;
    return plane < 0 ? b->step.particles.x[particle] : b->step.planes[plane].origin;
}

double barrier_area_of(const brunt_barrier *b, int32_t point) {
    const barrier_rim *rim = barrier_rim_of(b, point);
    if (rim) return rim->area;
    if (point >= b->vertex_count) return b->step.particles.area[point - barrier_surface_points(b)];
    return b->round ? b->vertex_area[point] / (BARRIER_RIM_POINTS + 1) : b->vertex_area[point];
}

int64_t barrier_nodes(const brunt_barrier *b, int32_t place, const int32_t **node, const double **weight) {
    static const double one = 1;
    *weight = &one;
    if (place < b->vertex_count) return *node = &b->step.node[place], 1;
    const barrier_rim *rim = barrier_rim_of(b, place);
    if (rim) return *node = rim->node, *weight = rim->weight, b->arc[rim->facet].curve.places;
    const brunt_barrier_particles *p = &b->step.particles;
    const int32_t particle = place - barrier_surface_points(b), plane = particle - p->count;
    if (plane >= 0) return *node = &b->step.planes[plane].node, **node >= 0;
    *node = p->node + p->first[particle], *weight = p->weight + p->first[particle];
    return p->first[particle + 1] - p->first[particle];
}

// Sums in registers: through `out`, which may be what they are of, each node would wait for the one before.
void barrier_move(const brunt_barrier *b, int32_t place, const double *u, double out[3]) {
    const int32_t *node;
    const double *weight;
    out[0] = out[1] = out[2] = 0;
    if (!u) return;
    const int64_t count = barrier_nodes(b, place, &node, &weight);
    double x = 0, y = 0, z = 0;
    if (b->dim == 3)
        for (int64_t i = 0; i < count; i++) {
            const double *v = u + (int64_t)node[i] * 3;
            x += weight[i] * v[0], y += weight[i] * v[1], z += weight[i] * v[2];
        }
    else
        for (int64_t i = 0; i < count; i++) {
            const double *v = u + (int64_t)node[i] * 2;
            x += weight[i] * v[0], y += weight[i] * v[1];
        }
    out[0] = x, out[1] = y, out[2] = z;
}

// Differences of places at the start, then of displacements: both keep their digits far from the origin.
void barrier_relative(const brunt_barrier *b, const double *u, int32_t from, const int32_t *place, int count,
                      double (*out)[3]) {
    double base[3];
    const double *x0 = barrier_start(b, from);
    barrier_move(b, from, u, base);
    for (int i = 0; i < count; i++) {
        const double *x = barrier_start(b, place[i]);
        double move[3];
        barrier_move(b, place[i], u, move);
        for (int k = 0; k < 3; k++) out[i][k] = k < b->dim ? (x[k] - x0[k]) + (move[k] - base[k]) : 0;
    }
}

int64_t barrier_unknowns(const brunt_barrier *b) {
    const brunt_barrier_particles *p = &b->step.particles;
    int32_t last = -1;
    for (int32_t v = 0; v < b->vertex_count; v++) last = b->step.node[v] > last ? b->step.node[v] : last;
    for (int64_t k = 0; p->count && k < p->first[p->count]; k++) last = p->node[k] > last ? p->node[k] : last;
    for (int32_t q = 0; q < b->step.plane_count; q++)
        last = b->step.planes[q].node > last ? b->step.planes[q].node : last;
    return ((int64_t)last + 1) * b->dim;
}
