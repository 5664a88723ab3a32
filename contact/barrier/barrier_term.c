// The two terms: the barrier, and friction with what it was at the last lag.
#include "contact/barrier/barrier_parts.h"

enum { AT_ONCE = 1024 }; // contacts whose forces are kept at a time

// ---------------------------------------------------------------------------------------------------- barrier

// Whether contacts are listed where places are by u: the terms are asked there one after the other, for forces, sets,
// and Hessians.
static bool is_here(const brunt_barrier *b, const double *u) {
    return u && b->here_count && !memcmp(b->here, u, (size_t)b->here_count * sizeof *u);
}

// Lists contacts at u, what is near being known.
static int list_at(brunt_barrier *b, const brunt_team *team, const double *u, brunt_error *error) {
    if (is_here(b, u)) return BRUNT_OK;
    const int64_t count = u ? barrier_unknowns(b) : 0; // NULL: all are 0, and nodes may have no numbers yet
    b->here_count = 0, b->looked_here = false, b->stale = true;
    if (barrier_list_contacts(b, team, u, &b->contacts, error) ||
        BRUNT_CAPACITY(b->here, (size_t)count + 1, 0, "unknowns of contact", error) ||
        (b->overlaps && barrier_clear_keep(b, u, count, error)))
        return BRUNT_FAILED;
    if (u) memcpy(b->here, u, (size_t)count * sizeof *u);
    b->here_count = count;
    return BRUNT_OK;
}

// The point within a corner that ends the facet: what the faces couple.
static void list_corner(barrier_contacts *list, const brunt_barrier *b, int32_t point, int32_t facet) {
    if (!b->corner_count || b->corner_of[facet] < 0) return;
    const barrier_corner *corner = &b->corner[b->corner_of[facet]];
    const int32_t *f = b->facet[facet];
    list->contact[list->count++] =
        (barrier_contact){.place = {point, f[0], f[1], barrier_beyond_corner(b, corner)}, .at.places = 4};
}

// All pairs that are near, as if they touched: what may couple on the way.
static int list_candidates(brunt_barrier *b, brunt_error *error) {
    barrier_contacts *list = &b->contacts;
    const int64_t most = b->facets.first[b->facets.count] * (b->corner_count ? 2 : 1) +
                         b->planes.first[b->planes.count] + b->edges.first[b->edges.count];
    if (BRUNT_CAPACITY(list->contact, (size_t)most + 1, 0, "places of contact", error)) return BRUNT_FAILED;
    list->count = 0, b->here_count = 0;
    for (int32_t i = 0; i < b->facets.count; i++) {
        for (int64_t k = b->facets.first[i]; k < b->facets.first[i + 1]; k++) {
            const int32_t *f = b->facet[b->facets.item[k]];
            const barrier_arc *arc = barrier_arc_of(b, b->facets.item[k]);
            barrier_contact *c = &list->contact[list->count++];
            *c = (barrier_contact){.place = {i, f[0], f[1], f[2]}, .at.places = 1 + b->dim};
            list_corner(list, b, i, b->facets.item[k]);
            if (!arc) continue;
            c->at.places = 1 + arc->curve.places;
            memcpy(c->place + 1, arc->place, sizeof arc->place);
        }
        for (int64_t k = b->planes.first[i]; k < b->planes.first[i + 1]; k++)
            list->contact[list->count++] =
                (barrier_contact){.place = {i, barrier_points(b) + b->planes.item[k]}, .at.places = 2};
    }
    for (int32_t i = 0; i < b->edges.count; i++)
        for (int64_t k = b->edges.first[i]; k < b->edges.first[i + 1]; k++) {
            const int32_t *e = b->edge[i], *f = b->edge[b->edges.item[k]];
            list->contact[list->count++] = (barrier_contact){.place = {e[0], e[1], f[0], f[1]}, .at.places = 4};
        }
    return BRUNT_OK;
}

static int term_look(void *self, const brunt_team *team, const double *u, const double *p, brunt_error *error) {
    brunt_barrier *b = self;
    // No step goes farther than what was near last lets it, which spares what lies along the rest of a long one.
    const double part = p && b->known ? barrier_limit(b, team, u, p, 1) : 1;
    if (!p && b->looked_here && is_here(b, u)) return brunt_hand_on(error, &b->unsaid);
    if (brunt_hand_on(error, &b->unsaid) || barrier_find_near(b, team, u, p, part, error)) return BRUNT_FAILED;
    b->contacts.count = b->sets.count = 0;
    b->stale = true;
    if (p) return BRUNT_OK;
    if (list_at(b, team, u, error)) return BRUNT_FAILED;
    b->looked_here = true;
    return BRUNT_OK;
}

static brunt_energy_sum term_energy(void *self, const brunt_team *team, const double *u) {
    return barrier_sum_energy(self, team, u);
}

typedef struct force_work {
    brunt_barrier *b;
    const barrier_contacts *list;
    const double *u;
    bool friction;
    int64_t first; // of the contacts whose forces there is room for
    double (*local)[BARRIER_DOFS];
} force_work;

static void take_forces(void *context, int64_t begin, int64_t end, int worker) {
    const force_work *w = context;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        const barrier_contact *c = &w->list->contact[w->first + i];
        if (w->friction && w->b->from)
            barrier_cone_gradient(w->b, c, w->u, w->local[i]);
        else if (w->friction)
            barrier_slip_gradient(w->b, c, w->u, w->local[i]);
        else if (w->b->touch > 0)
            barrier_join_gradient(w->b, c, w->local[i]);
        else
            barrier_contact_gradient(w->b, c, w->local[i]);
    }
}

// Adds to g the forces of a list, in its order: of friction, which follow the slips at u, or of the barrier as it was
// listed.
static void add_forces(force_work *w, const brunt_team *team, double *g) {
    double room[AT_ONCE][BARRIER_DOFS];
    w->local = room;
    for (w->first = 0; w->first < w->list->count; w->first += AT_ONCE) {
        const int64_t count = w->list->count - w->first < AT_ONCE ? w->list->count - w->first : AT_ONCE;
        brunt_parallel(team->threads, count, BARRIER_TASK_GRAIN, take_forces, w, team->timer);
        for (int64_t i = 0; i < count; i++) barrier_add_gradient(w->b, &w->list->contact[w->first + i], room[i], g);
    }
}

static void term_gradient(void *self, const brunt_team *team, const double *u, double *g) {
    brunt_barrier *b = self;
    force_work work = {.b = b, .list = &b->contacts, .u = u};
    if (!list_at(b, team, u, &b->unsaid) && !b->unsaid.code) add_forces(&work, team, g);
}

static brunt_stencils term_stencils(void *self) {
    brunt_barrier *b = self;
    if (b->stale &&
        ((b->swept && list_candidates(b, &b->unsaid)) || barrier_make_sets(b, &b->contacts, &b->sets, &b->unsaid)))
        b->sets.count = 0;
    b->stale = false;
    return (brunt_stencils){.count = b->sets.count, .first = b->sets.first, .node = b->sets.node};
}

static void term_hessian(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *m) {
    brunt_barrier *b = self;
    const barrier_assembly a = {b, &b->contacts, &b->sets, &b->colours, false};
    if (list_at(b, team, u, &b->unsaid) || b->unsaid.code) return;
    if (!b->stale || !barrier_make_sets(b, &b->contacts, &b->sets, &b->unsaid))
        barrier_add_hessian(&a, team, u, project, m, &b->unsaid);
}

static double term_limit(void *self, const brunt_team *team, const double *u, const double *p, double largest) {
    const brunt_barrier *b = self;
    return barrier_limit(b, team, u, p, fmin(largest, b->part));
}

brunt_term brunt_barrier_term(brunt_barrier *barrier) {
    static const brunt_term_ops ops = {
        .name = "barrier",
        .look = term_look,
        .energy = term_energy,
        .gradient = term_gradient,
        .stencils = term_stencils,
        .hessian = term_hessian,
        .limit = term_limit,
    };
    return (brunt_term){&ops, barrier};
}

// --------------------------------------------------------------------------------------------------- friction

// Contacts that rub at u, of what is near, with their normal forces.
static int list_rubbing(brunt_barrier *b, const brunt_team *team, const double *u, brunt_error *error) {
    barrier_contacts *listed = &b->contacts;
    if (list_at(b, team, u, error) ||
        BRUNT_CAPACITY(b->lagged.contact, (size_t)listed->count + 1, 0, "places of contact", error) ||
        BRUNT_CAPACITY(b->rub, (size_t)listed->count + 1, 0, "places that rub", error))
        return BRUNT_FAILED;
    barrier_contacts *list = &b->lagged;
    int64_t kept = 0;
    for (int64_t i = 0; i < listed->count; i++) {
        const barrier_contact *c = &listed->contact[i];
        const double force = barrier_contact_force(b, c);
        if (!(force > 0 && barrier_law_of(b, c->law).friction > 0)) continue;
        list->contact[kept] = *c;
        list->contact[kept++].normal_force = force;
    }
    list->count = kept;
    for (int64_t i = 0; i < kept; i++) barrier_slip_begin(b, &list->contact[i], u, &b->rub[i]);
    return BRUNT_OK;
}

int brunt_barrier_lag(brunt_barrier *b, const brunt_team *team, const double *u, brunt_error *error) {
    const bool looked = is_here(b, u) && b->looked_here;
    if ((!looked && barrier_find_near(b, team, u, NULL, 1, error)) || list_rubbing(b, team, u, error))
        return BRUNT_FAILED;
    return barrier_make_sets(b, &b->lagged, &b->lagged_sets, error);
}

double brunt_barrier_bound(const brunt_barrier *b) {
    double sum = 0;
    for (int64_t i = 0; i < b->lagged.count; i++) {
        const double friction = barrier_law_of(b, b->lagged.contact[i].law).friction;
        if (friction < INFINITY) sum += b->lagged.contact[i].normal_force * friction;
    }
    return sum;
}

// ------------------------------------------------------------------------------ friction that follows what presses

void brunt_barrier_follow(brunt_barrier *b, bool live) {
    b->live = live, b->from = NULL, b->tries = false, b->felt_count = 0;
}

void brunt_barrier_associate(brunt_barrier *b, const double *from) {
    brunt_barrier_follow(b, from);
    b->from = from;
}

static bool felt_of(const barrier_felt *f, const barrier_contact *c) {
    return f->law == c->law && f->edges == (c->threshold > 0) && !memcmp(f->place, c->place, sizeof f->place);
}

static bool comes_before(const barrier_felt *f, const barrier_contact *c) {
    const bool edges = c->threshold > 0;
    return f->edges != edges ? edges : f->place[0] < c->place[0];
}

// Slips and parts of the greatest force of contacts that were there at the last look become what follows from those, as
// `rub` does in the potential; of others they are as at u. Lists have the order of their points, then of their edges.
static void feel(const brunt_barrier *b, const double *u) {
    int64_t from = 0;
    for (int64_t i = 0; i < b->lagged.count; i++) {
        const barrier_contact *c = &b->lagged.contact[i];
        barrier_rub *rub = &b->rub[i];
        while (from < b->felt_count && comes_before(&b->felt[from], c)) from++;
        int64_t at = from;
        while (at < b->felt_count && b->felt[at].place[0] == c->place[0] && !felt_of(&b->felt[at], c)) at++;
        if (at == b->felt_count || b->felt[at].place[0] != c->place[0]) continue;
        memcpy(rub->slip, b->felt[at].slip, sizeof rub->slip), memcpy(rub->part, b->felt[at].part, sizeof rub->part);
        barrier_slip_follow(b, c, u, rub);
    }
}

// Keeps what was felt at u; friction there is that of its slips.
static int keep_felt(brunt_barrier *b, const double *u, brunt_error *error) {
    feel(b, u);
    if (BRUNT_CAPACITY(b->felt_before, (size_t)b->lagged.count + 1, 0, "places that rub", error)) return BRUNT_FAILED;
    barrier_felt *felt = b->felt_before;
    for (int64_t i = 0; i < b->lagged.count; i++) {
        const barrier_contact *c = &b->lagged.contact[i];
        felt[i].law = c->law, felt[i].edges = c->threshold > 0;
        memcpy(felt[i].place, c->place, sizeof felt[i].place);
        memcpy(felt[i].slip, b->rub[i].slip, sizeof felt[i].slip);
        memcpy(felt[i].part, b->rub[i].part, sizeof felt[i].part);
        barrier_slip_begin(b, c, u, &b->rub[i]);
    }
    const size_t capacity = b->felt_before_capacity;
    b->felt_before = b->felt, b->felt_before_capacity = b->felt_capacity;
    b->felt = felt, b->felt_capacity = capacity;
    b->felt_count = b->lagged.count;
    return BRUNT_OK;
}

// Places that are tried have the forces that are unknowns of their own: those of their slips leap to and fro.
static void friction_try(void *self, double share) {
    brunt_barrier *b = self;
    (void)share;
    b->tries = b->live && !b->from;
}

// ------------------------------------------------------------------------------------------------ its term

typedef struct slip_work {
    brunt_barrier *b;
    const double *u;
} slip_work;

static void follow_slips(void *context, int64_t begin, int64_t end, int worker) {
    const slip_work *w = context;
    (void)worker;
    for (int64_t i = begin; i < end; i++) barrier_slip_follow(w->b, &w->b->lagged.contact[i], w->u, &w->b->rub[i]);
}

static int friction_look(void *self, const brunt_team *team, const double *u, const double *p, brunt_error *error) {
    brunt_barrier *b = self;
    slip_work work = {b, u};
    b->tries = false;
    if (b->live) return p ? BRUNT_OK : brunt_barrier_lag(b, team, u, error) || keep_felt(b, u, error);
    if (!p) brunt_parallel(team->threads, b->lagged.count, BARRIER_GRAIN, follow_slips, &work, team->timer);
    return brunt_hand_on(error, &b->unsaid);
}

static void take_slip_energies(void *context, int64_t begin, int64_t end, int worker) {
    const slip_work *w = context;
    (void)worker;
    brunt_barrier *b = w->b;
    for (int64_t i = begin; i < end; i++)
        b->rub[i].energy = (b->from ? barrier_cone_energy : barrier_slip_energy)(b, &b->lagged.contact[i], w->u);
}

static brunt_energy_sum friction_energy(void *self, const brunt_team *team, const double *u) {
    brunt_barrier *b = self;
    brunt_energy_sum sum = {0};
    slip_work work = {b, u};
    if (b->live && list_rubbing(b, team, u, &b->unsaid)) return sum;
    brunt_parallel(team->threads, b->lagged.count, BARRIER_GRAIN, take_slip_energies, &work, team->timer);
    for (int64_t i = 0; i < b->lagged.count; i++)
        sum.value += b->rub[i].energy, sum.magnitude += fabs(b->rub[i].energy);
    return sum;
}

static void friction_gradient(void *self, const brunt_team *team, const double *u, double *g) {
    brunt_barrier *b = self;
    force_work work = {.b = b, .list = &b->lagged, .u = u, .friction = true};
    if (b->live && list_rubbing(b, team, u, &b->unsaid)) return;
    if (b->tries) feel(b, u);
    add_forces(&work, team, g);
}

static brunt_stencils friction_stencils(void *self) {
    const brunt_barrier *b = self;
    return (brunt_stencils){.count = b->lagged.count ? b->lagged_sets.count : 0,
                            .first = b->lagged_sets.first,
                            .node = b->lagged_sets.node};
}

static void friction_hessian(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *m) {
    brunt_barrier *b = self;
    const barrier_assembly a = {b, &b->lagged, &b->lagged_sets, &b->lagged_colours, true};
    (void)project;
    if (b->lagged.count) barrier_add_hessian(&a, team, u, false, m, &b->unsaid);
}

brunt_term brunt_barrier_friction_term(brunt_barrier *barrier) {
    static const brunt_term_ops ops = {
        .name = "friction",
        .look = friction_look,
        .energy = friction_energy,
        .gradient = friction_gradient,
        .stencils = friction_stencils,
        .hessian = friction_hessian,
        .follow = friction_try,
    };
    return (brunt_term){&ops, barrier};
}
