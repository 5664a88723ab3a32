// Where touches go on without the node that keeps what they have taken: it has left past a rim, or the edges that
// crossed beside it cross no more. Those that touch the same body beside it, and nodes of that body on its facets, take
// that in equal shares; otherwise it would be lost as the bodies part.
#include "base/parallel.h"
#include "contact/search/nearest.h"

enum { GRAIN = 64 };

typedef struct left_job {
    const brunt_contact_surface *surface;
    brunt_node_to_facet *f;
    touch_round round;
} left_job;

// What node n holds of facets or edges while it is on none and they cross no more. NULL: nothing.
static brunt_touch_energy *left_at(const brunt_node_to_facet *f, int32_t n, touched what) {
    if (f->nodes.count[n]) return NULL;
    brunt_touch_energy *left = &f->touches.of[n][what];
    return left->held != 0 && (what == TOUCHED_FACET || left->met == NONE_TOUCH) ? left : NULL;
}

// A share for node n, which is on a body of partner number `on`, of what another that has left holds of `partner`.
static void take_share(const left_job *j, int32_t n, int32_t on, int32_t from, int32_t partner) {
    brunt_touch_energy *to = &j->f->touches.of[n][TOUCHED_FACET];
    for (touched what = TOUCHED_FACET; what <= TOUCHED_EDGE; what++) {
        brunt_touch_energy *left = left_at(j->f, from, what);
        if (!left || !is_of(left, partner)) continue;
        if (j->round == TOUCH_CLAIM) __atomic_fetch_add(&left->claims, 1, __ATOMIC_RELAXED);
        if (j->round == TOUCH_TAKE) to->held += left->held / left->claims, to->partner = on;
    }
}

// The shares of node n, which is on a facet, edge or corner h.
static void take_from_about(const left_job *j, int32_t n, const facet_candidate *h) {
    const brunt_contact_surface *s = j->surface;
    int count;
    const int32_t *under = node_corners_under(j->f, s, h, &count), on = h->body + 1;
    for (int c = 0; c < count; c++) take_share(j, n, on, under[c], s->body[n] + 1);
    for (int32_t k = s->face_first[n]; k < s->face_first[n + 1]; k++) {
        const int32_t *beside = s->face[s->face_of[k]];
        for (int c = 0; c < brunt_face_corners(beside); c++) take_share(j, n, on, beside[c], on);
    }
}

// A node takes of one body: that of which it holds something, or else the first that it is on.
static void take_shares(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const left_job *j = context;
    const brunt_contact_surface *s = j->surface;
    for (int32_t n = (int32_t)begin; n < end; n++) {
        const brunt_touch_energy own = j->f->touches.of[n][TOUCHED_FACET];
        const int32_t first = j->f->nodes.count[n] ? node_candidate_of(j->f, s, n, 0)->body + 1 : 0,
                      of = own.held != 0 && own.partner ? own.partner : first;
        for (int32_t q = 0; q < j->f->nodes.count[n]; q++) {
            const facet_candidate *h = node_candidate_of(j->f, s, n, q);
            if (h->body + 1 == of && !is_membrane(s, s->body[n]) && !is_membrane(s, h->body)) take_from_about(j, n, h);
        }
    }
}

// What is left, of which what was claimed has gone.
static void look_at_left(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const left_job *j = context;
    for (int32_t n = (int32_t)begin; n < end; n++)
        for (touched what = TOUCHED_FACET; what <= TOUCHED_EDGE; what++) {
            brunt_touch_energy *left = left_at(j->f, n, what);
            if (!left) continue;
            if (left->claims) left->held = 0;
            left->claims = 0;
            __atomic_store_n(&j->f->touches.left, true, __ATOMIC_RELAXED);
        }
}

void brunt_touches_go_on(const brunt_contact_context *m, brunt_node_to_facet *f) {
    static void (*const passes[])(void *, int64_t, int64_t, int) = {take_shares, take_shares, look_at_left};
    const brunt_contact_surface *s = m->surface;
    left_job j = {.surface = s, .f = f};
    f->touches.left = false;
    brunt_parallel(m->threads, s->node_count, GRAIN, look_at_left, &j, m->timer);
    for (j.round = TOUCH_CLAIM; f->touches.left && j.round < TOUCH_ROUNDS; j.round++)
        brunt_parallel(m->threads, s->node_count, GRAIN, passes[j.round], &j, m->timer);
}
