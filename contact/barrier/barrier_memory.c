// What friction keeps from one load step to the next: how far surfaces have given along each other, without slipping.
// Kept by the points of surfaces of meshes, for each body or plane that one touches.
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

// Turned with the surfaces, as long as it was.
static void turn(const double n[3], double slip[3]) {
    double along = 0, before = 0, after = 0;
    for (int k = 0; k < 3; k++) along += slip[k] * n[k], before += slip[k] * slip[k];
    for (int k = 0; k < 3; k++) slip[k] -= along * n[k], after += slip[k] * slip[k];
    for (int k = 0; k < 3 && after > 0; k++) slip[k] *= sqrt(before / after);
}

void barrier_kept_slip(const brunt_barrier *b, const barrier_contact *c, double slip[3]) {
    slip[0] = slip[1] = slip[2] = 0;
    if (!b->keeps || c->threshold > 0 || c->place[0] >= barrier_surface_points(b)) return;
    const barrier_kept *kept = &b->kept[(int64_t)c->place[0] * BARRIER_KEPT];
    const int32_t other = other_of(b, c);
    for (int s = 0; s < BARRIER_KEPT; s++) {
        if (kept[s].other != other || !(kept[s].force > 0)) continue;
        memcpy(slip, kept[s].slip, sizeof kept[s].slip);
        turn(c->at.n, slip);
        return;
    }
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

// Where a vertex touches several features of a body, their mean by what presses.
static void keep_one(brunt_barrier *b, const barrier_contact *c, const double y[3], double greatest) {
    barrier_kept *kept = slot_of(&b->kept[(int64_t)c->place[0] * BARRIER_KEPT], other_of(b, c), c->normal_force);
    const double size = sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]), part = size > greatest ? greatest / size : 1;
    if (!kept) return;
    const bool first = kept->other != other_of(b, c);
    if (first) *kept = (barrier_kept){.other = other_of(b, c)};
    for (int k = 0; k < 3; k++)
        kept->slip[k] = (kept->force * kept->slip[k] + c->normal_force * part * y[k]) / (kept->force + c->normal_force);
    kept->force += c->normal_force;
}

int brunt_barrier_keep(brunt_barrier *b, const brunt_team *team, const double *u, brunt_error *error) {
    if (!b->keeps) return BRUNT_OK;
    if (brunt_barrier_lag(b, team, u, error)) return BRUNT_FAILED;
    for (int64_t i = 0; i < (int64_t)barrier_surface_points(b) * BARRIER_KEPT; i++)
        b->kept[i] = (barrier_kept){.other = BRUNT_NONE};
    for (int64_t i = 0; i < b->lagged.count; i++) {
        const barrier_contact *c = &b->lagged.contact[i];
        const barrier_law law = barrier_law_of(b, c->law);
        if (c->threshold > 0 || c->place[0] >= barrier_surface_points(b)) continue;
        keep_one(b, c, b->rub[i].slip, law.friction == INFINITY ? INFINITY : b->step.dt * law.slip_speed);
    }
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ of the state

int64_t brunt_barrier_kept_count(const brunt_barrier *b) {
    return b && b->keeps ? (int64_t)barrier_surface_points(b) * BARRIER_KEPT * 5 : 0;
}

void brunt_barrier_kept_get(const brunt_barrier *b, double *out) {
    for (int64_t i = 0; i < brunt_barrier_kept_count(b) / 5; i++, out += 5) {
        out[0] = b->kept[i].other, out[1] = b->kept[i].force;
        memcpy(out + 2, b->kept[i].slip, sizeof b->kept[i].slip);
    }
}

void brunt_barrier_kept_set(brunt_barrier *b, const double *in) {
    for (int64_t i = 0; i < brunt_barrier_kept_count(b) / 5; i++, in += 5) {
        b->kept[i].other = (int32_t)in[0], b->kept[i].force = in[1];
        memcpy(b->kept[i].slip, in + 2, sizeof b->kept[i].slip);
    }
}
