// What friction keeps from one load step to the next: how far surfaces have given along each other, without slipping.
// Kept by the points of surfaces of meshes, for each body or plane that one touches. Edges that cross keep it
// for each other. Which edges cross changes as surfaces slide: those that meet anew begin with what their ends have
// kept, and ends that touch nothing themselves, as beyond the other surface's border, are given it by their edges.
#include "contact/barrier/barrier_parts.h"

int brunt_barrier_keep_slips(brunt_barrier *b, brunt_error *error) {
    const size_t slots = (size_t)barrier_surface_points(b) * BARRIER_KEPT + 1;
    if (BRUNT_CAPACITY(b->kept, slots, 0, "slips of surfaces", error)) return BRUNT_FAILED;
    for (size_t i = 0; i < slots; i++) b->kept[i] = (barrier_kept){.other = BRUNT_NONE};
    b->keeps = true;
    return BRUNT_OK;
}

// By body, or by plane behind all bodies' numbers.
static int32_t other_of(const brunt_barrier *b, const barrier_contact *c) {
    return barrier_law_is_plane(b, c->law) ? -2 - c->law : barrier_body_of(b, c->place[1]);
}

// Turned with the surfaces, as long as it was. What of it was along the normal, by as much longer.
static double turn(const double n[3], double slip[3]) {
    double along = 0, before = 0, after = 0;
    for (int k = 0; k < 3; k++) along += slip[k] * n[k], before += slip[k] * slip[k];
    for (int k = 0; k < 3; k++) slip[k] -= along * n[k], after += slip[k] * slip[k];
    for (int k = 0; k < 3 && after > 0; k++) slip[k] *= sqrt(before / after);
    return after > 0 ? along * sqrt(before / after) : 0;
}

// The slot of a point for what it touches, NULL: none.
static const barrier_kept *slot_for(const brunt_barrier *b, int32_t point, int32_t other) {
    const barrier_kept *kept = &b->kept[(int64_t)point * BARRIER_KEPT];
    for (int s = 0; s < BARRIER_KEPT; s++)
        if (kept[s].other == other && kept[s].force > 0) return &kept[s];
    return NULL;
}

// What two edges that cross have kept, NULL: they meet anew. In the order of their first ends.
static const barrier_kept_edges *kept_of_edges(const brunt_barrier *b, const barrier_contact *c) {
    int64_t low = 0, high = b->kept_edges_count;
    while (low < high) {
        const int64_t middle = low + (high - low) / 2;
        if (b->kept_edges[middle].place[0] < c->place[0])
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < b->kept_edges_count && b->kept_edges[low].place[0] == c->place[0]; low++)
        if (!memcmp(b->kept_edges[low].place, c->place, sizeof b->kept_edges[low].place)) return &b->kept_edges[low];
    return NULL;
}

// The mean of what ends of the two edges keep of the other's body, wherever they cross.
static void kept_of_ends(const brunt_barrier *b, const barrier_contact *c, double slip[3]) {
    int ends = 0;
    for (int i = 0; i < 4; i++) {
        const barrier_kept *kept = slot_for(b, c->place[i], barrier_body_of(b, c->place[i < 2 ? 2 : 0]));
        if (!kept) continue;
        for (int k = 0; k < 3; k++) slip[k] += (i < 2 ? 1 : -1) * kept->slip[k];
        ends++;
    }
    for (int k = 0; k < 3 && ends > 0; k++) slip[k] /= ends;
}

double barrier_kept_slip(const brunt_barrier *b, const barrier_contact *c, double slip[3]) {
    slip[0] = slip[1] = slip[2] = 0;
    if (!b->keeps || c->place[0] >= barrier_surface_points(b)) return 0;
    if (c->threshold > 0) {
        const barrier_kept_edges *kept = kept_of_edges(b, c);
        if (kept)
            memcpy(slip, kept->slip, sizeof kept->slip);
        else
            kept_of_ends(b, c, slip);
    } else {
        const barrier_kept *kept = slot_for(b, c->place[0], other_of(b, c));
        if (kept) memcpy(slip, kept->slip, sizeof kept->slip);
    }
    return turn(c->at.n, slip);
}

// The slot of a vertex for what it touches: its own, a free one, or that of the least force if that is less.
static barrier_kept *slot_of(barrier_kept *kept, int32_t other, double force) {
    barrier_kept *least = kept;
    for (int s = 0; s < BARRIER_KEPT; s++)
        if (kept[s].other == other) return &kept[s];
    for (int s = 0; s < BARRIER_KEPT; s++) {
        if (!(kept[s].force > 0)) return &kept[s];
        if (kept[s].force < least->force) least = &kept[s];
    }
    return least->force < force ? least : NULL;
}

// Where a point touches several features of a body, their mean by what presses; of y its share is kept.
static void keep_at(brunt_barrier *b, int32_t point, int32_t other, double force, double share, const double y[3],
                    bool by_edges) {
    barrier_kept *kept = slot_of(&b->kept[(int64_t)point * BARRIER_KEPT], other, force);
    if (!kept || !(force > 0) || (by_edges && kept->other == other && !kept->by_edges)) return;
    if (kept->other != other) *kept = (barrier_kept){.other = other, .by_edges = by_edges};
    for (int k = 0; k < 3; k++)
        kept->slip[k] = (kept->force * kept->slip[k] + force * share * y[k]) / (kept->force + force);
    kept->force += force;
}

static void keep_one(brunt_barrier *b, const barrier_contact *c, const double y[3], double greatest) {
    const double size = sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]), part = size > greatest ? greatest / size : 1;
    if (!(c->threshold > 0)) {
        keep_at(b, c->place[0], other_of(b, c), c->normal_force, part, y, false);
        return;
    }
    barrier_kept_edges *kept = &b->kept_edges[b->kept_edges_count++];
    memcpy(kept->place, c->place, sizeof kept->place);
    for (int k = 0; k < 3; k++) kept->slip[k] = part * y[k];
    for (int i = 0; i < 4; i++)
        keep_at(b, c->place[i], barrier_body_of(b, c->place[i < 2 ? 2 : 0]), fabs(c->at.w[i]) * c->normal_force,
                i < 2 ? part : -part, y, true);
}

static int reserve_edges(brunt_barrier *b, int64_t count, brunt_error *error) {
    return BRUNT_CAPACITY(b->kept_edges, (size_t)count + 1, 0, "slips of edges", error);
}

int brunt_barrier_keep(brunt_barrier *b, const brunt_team *team, const double *u, brunt_error *error) {
    if (!b->keeps) return BRUNT_OK;
    if (brunt_barrier_lag(b, team, u, error) || reserve_edges(b, b->dim == 3 ? b->lagged.count : 0, error))
        return BRUNT_FAILED;
    b->kept_edges_count = 0;
    for (int64_t i = 0; i < (int64_t)barrier_surface_points(b) * BARRIER_KEPT; i++)
        b->kept[i] = (barrier_kept){.other = BRUNT_NONE};
    for (int64_t k = 0; k < 2 * b->lagged.count; k++) { // points, then edges
        const int64_t i = k % b->lagged.count;
        const barrier_contact *c = &b->lagged.contact[i];
        const barrier_law law = barrier_law_of(b, c->law);
        if (c->place[0] >= barrier_surface_points(b) || (c->threshold > 0) != (k >= b->lagged.count)) continue;
        keep_one(b, c, b->rub[i].slip, law.friction == INFINITY ? INFINITY : b->step.dt * law.slip_speed);
    }
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ of the state

enum { OF_POINT = 5, OF_EDGES = 7 }; // numbers

static int64_t slots(const brunt_barrier *b) {
    return b && b->keeps ? (int64_t)barrier_surface_points(b) * BARRIER_KEPT : 0;
}

int64_t brunt_barrier_kept_count(const brunt_barrier *b) {
    return slots(b) * OF_POINT + (slots(b) ? b->kept_edges_count * OF_EDGES : 0);
}

bool brunt_barrier_kept_fits(const brunt_barrier *b, int64_t count) {
    const int64_t edges = count - slots(b) * OF_POINT;
    return slots(b) && b->dim == 3 ? edges >= 0 && edges % OF_EDGES == 0 : edges == 0;
}

void brunt_barrier_kept_get(const brunt_barrier *b, double *out) {
    for (int64_t i = 0; i < slots(b); i++, out += OF_POINT) {
        out[0] = b->kept[i].other, out[1] = b->kept[i].force;
        memcpy(out + 2, b->kept[i].slip, sizeof b->kept[i].slip);
    }
    for (int64_t i = 0; slots(b) && i < b->kept_edges_count; i++, out += OF_EDGES) {
        for (int k = 0; k < 4; k++) out[k] = b->kept_edges[i].place[k];
        memcpy(out + 4, b->kept_edges[i].slip, sizeof b->kept_edges[i].slip);
    }
}

int brunt_barrier_kept_set(brunt_barrier *b, const double *in, int64_t count, brunt_error *error) {
    const int64_t edges = (count - slots(b) * OF_POINT) / OF_EDGES;
    BRUNT_ASSERT(brunt_barrier_kept_fits(b, count));
    if (edges && reserve_edges(b, edges, error)) return BRUNT_FAILED;
    for (int64_t i = 0; i < slots(b); i++, in += OF_POINT) {
        b->kept[i].other = (int32_t)in[0], b->kept[i].force = in[1];
        memcpy(b->kept[i].slip, in + 2, sizeof b->kept[i].slip);
    }
    for (int64_t i = 0; i < edges; i++, in += OF_EDGES) {
        for (int k = 0; k < 4; k++) b->kept_edges[i].place[k] = (int32_t)in[k];
        memcpy(b->kept_edges[i].slip, in + 4, sizeof b->kept_edges[i].slip);
    }
    if (slots(b)) b->kept_edges_count = edges;
    return BRUNT_OK;
}
