// Contact between bodies on the grid, one velocity field a body (Bardenhagen, Guilkey et al. 2001).
//
// Only slots that two or more bodies have alive are looked at, and only nodes where two have mass. There, per pair:
//   normal   from a to b, along -grad phi_a + grad phi_b of the volume fractions: n_ba = -n_ab to the bit
//   gap      between the surfaces as the particles near the node have them (node_gap.c), not as the kernels feel
//   them approach the relative velocity along n may not exceed gap/dt, so the gap closes to zero and not past it;
//   bodies not
//            yet within reach are left alone
//   friction the tangential impulse that would stop the slip, at most mu times the normal one
// Tied pairs share one velocity instead, whatever the normal and the gap.
// Impulses are equal and opposite at one point: linear and angular momentum are kept to rounding. Three and more bodies
// at a node are solved together by Gauss-Seidel sweeps over the pairs to convergence; bodies are ordered by name, so
// the order in a file changes nothing.
//
// No constraints of the common solver are made of it. Nodes are independent: the problem of two free bodies is solved
// by one step of the law (coulomb.h), to rounding, and one of three by some 24 sweeps of its own. The common sweeps go
// over all nodes until the last is done, are of Jacobi, which takes 75 there, and have no constraint that also pulls
// (tied).
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/constraint/coulomb.h"
#include "contact/methods/method.h"
#include "contact/methods/node_gap.h"
#include "contact/planes/boundary.h"
#include "contact/planes/followed.h"
#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/sweep.h"

enum { MAX_SWEEPS = 1000, MAX_TOGETHER = 16 };
static const double SWEEP_TOLERANCE = 1e-13; // of the velocities at the node

// A slot of a body that some other body may share.
typedef struct shared_slot {
    uint64_t key;
    int32_t body, slot;
} shared_slot;
// Slots with the same coordinate: entries first .. first+count-1, and where their pairs' actions are collected.
typedef struct group {
    int32_t first, count, account;
} group;
typedef struct box {
    int32_t low[3], high[3];
} box;

// A body by the low end of its box along the first axis.
typedef struct body_low {
    int32_t low, body;
} body_low;

struct brunt_contact_workspace {
    box *bounds;
    size_t bounds_capacity;
    body_low *lows;
    size_t lows_capacity;
    shared_slot *shared;
    size_t shared_capacity;
    int32_t shared_count;
    group *groups;
    size_t groups_capacity;
    int32_t group_count;
    brunt_impulse_account *accounts;
    size_t accounts_capacity;
    int32_t account_count;
    brunt_node_gap *thread; // of each thread
    int thread_count;
};

#define ONE(name, word) +1
enum { METHODS = 0 BRUNT_CONTACT_METHODS(ONE) };
#undef ONE

typedef struct job {
    const brunt_contact_context *m;
    brunt_body *bodies; // of material points
    brunt_contact_workspace *w;
    bool follows;                 // there are symmetry planes: images follow
    int bearers;                  // accounts of a group besides those of pairs: of those planes
    brunt_node_law *law[METHODS]; // of each method
} job;

void brunt_contact_workspace_free(brunt_contact_workspace *workspace) {
    if (!workspace) return;
    brunt_free(workspace->bounds);
    brunt_free(workspace->lows);
    brunt_free(workspace->shared);
    brunt_free(workspace->groups);
    brunt_free(workspace->accounts);
    for (int t = 0; t < workspace->thread_count; t++) brunt_node_gap_free(&workspace->thread[t]);
    brunt_free(workspace->thread);
    brunt_free(workspace);
}

// ------------------------------------------------------------------------------------------ what meets what

static box slot_bounds(const brunt_grid *grid) {
    box b = {{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
    for (int32_t s = 0; s < grid->slot_count; s++)
        for (int a = 0; a < 3; a++) {
            int32_t c = grid->slots[s].coord[a];
            if (c < b.low[a]) b.low[a] = c;
            if (c > b.high[a]) b.high[a] = c;
        }
    return b;
}

static bool overlap(const box *a, const box *b) {
    for (int k = 0; k < 3; k++)
        if (a->low[k] > b->high[k] || b->low[k] > a->high[k]) return false;
    return true;
}

static bool inside(const box *b, const int32_t c[3]) {
    for (int k = 0; k < 3; k++)
        if (c[k] < b->low[k] || c[k] > b->high[k]) return false;
    return true;
}

static int compare_shared(const void *a, const void *b) {
    const shared_slot *u = a, *v = b;
    if (u->key != v->key) return u->key < v->key ? -1 : 1;
    return (u->body > v->body) - (u->body < v->body);
}

// The pair of two bodies by their places among those of material points; BRUNT_NONE: none.
static int32_t pair_between(const job *j, int a, int b) {
    const int32_t pair = brunt_pair_of(j->m->pair_map, j->bodies[a].index, j->bodies[b].index);
    return pair >= 0 && j->m->pairs[pair].meets & BRUNT_MEET_AT_NODES ? pair : BRUNT_NONE;
}

static int compare_low(const void *a, const void *b) {
    const body_low *u = a, *v = b;
    if (u->low != v->low) return u->low < v->low ? -1 : 1;
    return (u->body > v->body) - (u->body < v->body);
}

// Slots of a body inside the box of another.
static int share_slots(const job *j, int body, int other, brunt_error *error) {
    brunt_contact_workspace *w = j->w;
    const brunt_grid *grid = &j->bodies[body].grid;
    if (BRUNT_CAPACITY(w->shared, (size_t)(w->shared_count + grid->slot_count), (size_t)w->shared_count,
                       "blocks of nodes that bodies share", error))
        return BRUNT_FAILED;
    for (int32_t s = 0; s < grid->slot_count; s++)
        if (inside(&w->bounds[other], grid->slots[s].coord))
            w->shared[w->shared_count++] = (shared_slot){grid->slot_key[s], body, s};
    return BRUNT_OK;
}

// Of each two bodies that may touch and whose boxes overlap, the slots in there: boxes by their low ends, so that of
// many bodies only those that overlap along the axis that they are spread out along are looked at.
static int find_shared(job *j, brunt_error *error) {
    brunt_contact_workspace *w = j->w;
    const int n = j->m->mpm_count;
    if (BRUNT_CAPACITY(w->bounds, (size_t)n, 0, "bodies of material points", error) ||
        BRUNT_CAPACITY(w->lows, (size_t)n, 0, "bodies of material points", error))
        return BRUNT_FAILED;
    brunt_spread spread = {.count = 0};
    for (int b = 0; b < n; b++) {
        const box *of = &w->bounds[b];
        w->bounds[b] = slot_bounds(&j->bodies[b].grid);
        if (of->low[0] <= of->high[0]) brunt_spread_add(&spread, (const double[3]){of->low[0], of->low[1], of->low[2]});
    }
    const int axis = brunt_spread_axis(&spread);
    for (int b = 0; b < n; b++) w->lows[b] = (body_low){w->bounds[b].low[axis], b};
    qsort(w->lows, (size_t)n, sizeof *w->lows, compare_low);
    for (int i = 0; i < n; i++) {
        const int a = w->lows[i].body;
        for (int k = i + 1; k < n && w->lows[k].low <= w->bounds[a].high[axis]; k++) {
            const int b = w->lows[k].body;
            if (!overlap(&w->bounds[a], &w->bounds[b]) || pair_between(j, a, b) < 0) continue;
            if (share_slots(j, a, b, error) || share_slots(j, b, a, error)) return BRUNT_FAILED;
        }
    }
    return BRUNT_OK;
}

// Slots that bodies share, sorted; then those that really coincide.
static int find_groups(job *j, brunt_error *error) {
    brunt_contact_workspace *w = j->w;
    w->shared_count = w->group_count = w->account_count = 0;
    if (find_shared(j, error)) return BRUNT_FAILED;
    if (!w->shared_count) return BRUNT_OK;
    qsort(w->shared, (size_t)w->shared_count, sizeof *w->shared, compare_shared);
    int32_t unique = 0;
    for (int32_t i = 0; i < w->shared_count; i++)
        if (!unique || compare_shared(&w->shared[i], &w->shared[unique - 1])) w->shared[unique++] = w->shared[i];
    w->shared_count = unique;
    if (BRUNT_CAPACITY(w->groups, (size_t)unique, 0, "blocks of nodes that bodies share", error)) return BRUNT_FAILED;
    for (int32_t i = 0, next; i < unique; i = next) {
        for (next = i + 1; next < unique && w->shared[next].key == w->shared[i].key; next++) {}
        int32_t count = next - i;
        if (count < 2) continue;
        w->groups[w->group_count++] = (group){i, count, w->account_count};
        w->account_count += count * (count - 1) / 2 + j->bearers;
    }
    const size_t accounts = (size_t)(w->account_count + 1);
    if (BRUNT_CAPACITY(w->accounts, accounts, 0, "accounts of blocks that bodies share", error)) return BRUNT_FAILED;
    memset(w->accounts, 0, accounts * sizeof *w->accounts);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ one node

typedef struct node_contact {
    int a, b;                                   // members
    int account;                                // index among the group's pairs
    double n[3], target;                        // normal from a to b; least relative velocity along it [m/s]
    double friction;                            // [-]
    double inverse, slide;                      // [1/kg] along n; the greatest across
    double normal_impulse, friction_impulse[3]; // [N s] on b
    brunt_node_law *law;                        // of the pair's method; NULL: pushes and friction
} node_contact;

typedef struct member {
    brunt_body *body;
    int32_t slot;
    real *node;
    int entry;
    bool fixed, rests;                   // rests: on a plane that it sticks to, which takes what it is given
    double v[3], inverse[3], applied[3]; // [m/s], [1/kg] by component: 0 where a condition gives v; [N s]
} member;

static double relative(const member *members, const node_contact *m, double v[3]) {
    double along = 0;
    for (int k = 0; k < 3; k++) {
        v[k] = members[m->b].v[k] - members[m->a].v[k];
        along += v[k] * m->n[k];
    }
    return along;
}

// Does what the method of a pair says; returns the change of velocity [m/s].
static double follow_law(member *members, node_contact *m) {
    double v[3], inverse[3], J[3] = {0};
    relative(members, m, v);
    for (int k = 0; k < 3; k++) inverse[k] = members[m->a].inverse[k] + members[m->b].inverse[k];
    const double changed = m->law(v, inverse, J);
    for (int k = 0; k < 3; k++) {
        m->friction_impulse[k] += J[k];
        members[m->a].v[k] -= J[k] * members[m->a].inverse[k];
        members[m->b].v[k] += J[k] * members[m->b].inverse[k];
    }
    return changed;
}

// Brings one pair to its complementarity condition; returns the change of velocity [m/s].
static double solve_contact(member *members, node_contact *m) {
    if (m->law) return follow_law(members, m);
    double v[3], J[3], along = relative(members, m, v);
    const double step = brunt_coulomb_normal(&m->normal_impulse, (m->target - along) / m->inverse);
    double changed = fabs(step) * m->inverse;
    for (int k = 0; k < 3; k++) J[k] = step * m->n[k];
    if (m->friction > 0) {
        double wanted[3], change[3];
        for (int k = 0; k < 3; k++) wanted[k] = m->friction_impulse[k] - (v[k] - along * m->n[k]) / m->slide;
        brunt_coulomb_project(3, m->friction, m->normal_impulse, wanted, m->friction_impulse, change);
        for (int k = 0; k < 3; k++) J[k] += change[k];
        changed = fmax(changed, brunt_coulomb_norm(3, change) * m->slide);
    }
    for (int k = 0; k < 3; k++) {
        members[m->a].v[k] -= J[k] * members[m->a].inverse[k];
        members[m->b].v[k] += J[k] * members[m->b].inverse[k];
    }
    return changed;
}

// What two members yield along the normal, and at most across it.
static void weigh_contact(const member *a, const member *b, node_contact *m) {
    m->inverse = m->slide = a->inverse[0] + b->inverse[0];
    if (!a->fixed && !b->fixed) return;
    m->inverse = 0;
    for (int k = 0; k < 3; k++) {
        const double inverse = a->inverse[k] + b->inverse[k];
        m->inverse += m->n[k] * m->n[k] * inverse;
        m->slide = fmax(m->slide, inverse);
    }
}

static void make_member(const job *j, brunt_body *body, const shared_slot *s, int node, real *at, int entry,
                        member *m) {
    m->body = body, m->slot = s->slot, m->node = at, m->entry = entry, m->fixed = false;
    m->rests = j->follows && brunt_followed_rests(j->m, body, s->slot, node);
    for (int a = 0; a < 3; a++) {
        const bool there = a < body->grid.dim,
                   fixed = there &&
                           (m->rests || brunt_node_held(&body->grid, (int64_t)s->slot * BRUNT_BLOCK_NODES + node, a));
        m->v[a] = there ? (double)at[BRUNT_NODE_VELOCITY + a] : 0;
        m->inverse[a] = there && !fixed ? 1 / (double)at[0] : 0;
        m->applied[a] = 0;
        m->fixed |= fixed;
    }
}

// The planes near a node that some of the bodies there have images by.
typedef struct bearers {
    int count;
    brunt_symmetry_plane plane[BRUNT_MAX_PLANES];
    brunt_impulse_account *account[BRUNT_MAX_PLANES]; // of the group
} bearers;

// What planes take of a change of velocity from `old` at a node.
static void bear(const brunt_grid *grid, const real *node, const int32_t at[3], const real old[3],
                 const bearers *near) {
    double x[3] = {0};
    for (int a = 0; a < grid->dim; a++) x[a] = grid->origin[a] + (double)grid->h * at[a];
    for (int a = 0; a < grid->dim && near->count; a++) {
        const int i = (a + 1) % 3, k = (a + 2) % 3;
        const double J = (double)node[BRUNT_NODE_SPARE] * (double)(node[BRUNT_NODE_VELOCITY + a] - old[a]);
        double share[BRUNT_MAX_PLANES];
        brunt_symmetry_shares(near->plane, near->count, at, a, share);
        for (int m = 0; m < near->count; m++) {
            double linear[3] = {0}, turn[3] = {0};
            linear[a] = share[m] * J, turn[i] = share[m] * x[k] * J, turn[k] = -share[m] * x[i] * J;
            brunt_impulse_account_reaction(near->account[m], linear, turn);
        }
    }
}

// The node has what it was given even where it is held: the condition then takes it, and records it. Where it rests on
// a plane nothing takes it. `near`: what takes all that the bodies get together there.
static void scatter_node(const job *j, const member *m, int node, const bearers *near) {
    const brunt_grid *grid = &m->body->grid;
    int32_t at[3];
    real old[3] = {0};
    memcpy(old, m->node + BRUNT_NODE_VELOCITY, (size_t)grid->dim * sizeof *old);
    for (int a = 0; a < grid->dim && !m->rests; a++)
        m->node[BRUNT_NODE_VELOCITY + a] =
            (real)(m->inverse[a] > 0 ? m->v[a] : m->v[a] + m->applied[a] / (double)m->node[0]);
    if (!j->follows) return;
    brunt_followers images;
    brunt_node_coordinates(grid, m->slot, node, at);
    bear(grid, m->node, at, old, near);
    brunt_followers_find(j->m, m->body, m->slot, node, &images);
    for (int i = 0; i < images.count; i++) {
        memcpy(old, images.node[i] + BRUNT_NODE_VELOCITY, (size_t)grid->dim * sizeof *old);
        for (int a = 0; a < grid->dim; a++)
            images.node[i][BRUNT_NODE_VELOCITY + a] = images.sign[i][a] * m->node[BRUNT_NODE_VELOCITY + a];
        bear(grid, images.node[i], images.at[i], old, near);
    }
}

// The body's own share of what a member gets.
static double own_share(const job *j, const member *m, int node) {
    double own = (double)(m->node[BRUNT_NODE_SPARE] / m->node[0]);
    brunt_followers images = {.count = 0};
    if (j->follows) brunt_followers_find(j->m, m->body, m->slot, node, &images);
    for (int i = 0; i < images.count; i++) own += (double)(images.node[i][BRUNT_NODE_SPARE] / images.node[i][0]);
    return own;
}

// Bodies at a node of the grids, and the contacts between them.
typedef struct node_contacts {
    member members[MAX_TOGETHER];
    node_contact contacts[MAX_TOGETHER * (MAX_TOGETHER - 1) / 2];
    int count, contact_count;
    bool fixed; // something holds one of them
} node_contacts;

static void find_members(const job *j, const group *g, int node, brunt_node_gap *thread, node_contacts *here) {
    for (int32_t i = 0; i < g->count; i++) {
        const shared_slot *s = &j->w->shared[g->first + i];
        real *at = brunt_slot_nodes(&j->bodies[s->body].grid, s->slot) + node * BRUNT_NODE_REALS;
        if (!(at[0] > 0) || (j->follows && brunt_followed_behind(j->m, &j->bodies[s->body], s->slot, node))) continue;
        if (here->count == MAX_TOGETHER) {
            brunt_fail(&thread->error, BRUNT_FAILED, "more than %d bodies meet at one grid node", MAX_TOGETHER);
            here->count = 0;
            return;
        }
        make_member(j, &j->bodies[s->body], s, node, at, i, &here->members[here->count++]);
    }
}

// The contact of members a and b, if they meet there.
static void add_contact(const job *j, const group *g, int node, int a, int b, brunt_node_gap *thread,
                        node_contacts *here) {
    const member *one = &here->members[a], *other = &here->members[b];
    const int32_t pair = pair_between(j, (int)(one->body - j->bodies), (int)(other->body - j->bodies));
    if (pair < 0) return;
    node_contact *m = &here->contacts[here->contact_count];
    const int low = one->entry, high = other->entry;
    *m = (node_contact){.a = a,
                        .b = b,
                        .account = low * g->count - low * (low + 1) / 2 + high - low - 1,
                        .friction = j->m->pairs[pair].friction,
                        .law = j->law[j->m->pairs[pair].method]};
    double gap = 0;
    const brunt_node_side sides[2] = {{one->body, one->slot, low, one->v}, {other->body, other->slot, high, other->v}};
    thread->alone = here->count == 2;
    if (!m->law && !brunt_node_gap_find(thread, j->m, sides, node, m->n, &gap)) return;
    m->target = -fmax(gap, 0) / j->m->dt;
    weigh_contact(one, other, m);
    here->fixed |= one->fixed || other->fixed;
    here->contact_count += m->law || m->inverse > 0;
}

static void solve_node(node_contacts *here, double scale) {
    for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
        double changed = 0;
        for (int q = 0; q < here->contact_count; q++)
            changed = fmax(changed, solve_contact(here->members, &here->contacts[q]));
        if ((here->contact_count == 1 && !here->fixed) || changed <= SWEEP_TOLERANCE * scale) break;
    }
}

// Applies what a contact has come to at x, and records it.
static void account_contact(const job *j, const group *g, int node, const double x[3], node_contacts *here,
                            const node_contact *m) {
    static const double rest[3] = {0, 0, 0};
    member *members = here->members;
    double normal_impulse[3], friction_impulse[3], old[3] = {0}, now[3];
    const double own = own_share(j, &members[m->b], node);
    relative(members, m, now);
    for (int k = 0; k < 3; k++) {
        normal_impulse[k] = own * m->normal_impulse * m->n[k], friction_impulse[k] = own * m->friction_impulse[k];
        members[m->a].applied[k] -= m->normal_impulse * m->n[k] + m->friction_impulse[k];
        members[m->b].applied[k] += m->normal_impulse * m->n[k] + m->friction_impulse[k];
    }
    for (int k = 0; k < j->bodies[0].grid.dim; k++)
        old[k] = (double)(members[m->b].node[BRUNT_NODE_OLD + k] - members[m->a].node[BRUNT_NODE_OLD + k]);
    brunt_impulse_account *account = &j->w->accounts[g->account + m->account];
    brunt_impulse_account_record(account, &account->normal_loss, m->law ? friction_impulse : normal_impulse, x, old,
                                 now, rest);
    if (m->friction > 0 && !m->law)
        brunt_impulse_account_record(account, &account->friction_loss, friction_impulse, x, old, now, rest);
}

// Whether some body at a node is near enough to a plane to have images by it.
static bool any_follows(const job *j, const brunt_symmetry_plane *plane, int node, const node_contacts *here) {
    bool any = false;
    for (int i = 0; i < here->count; i++) {
        const member *m = &here->members[i];
        int32_t at[3];
        brunt_node_coordinates(&m->body->grid, m->slot, node, at);
        any = any || (brunt_boundary_acts_on(&j->m->boundaries[plane->boundary], m->body->index) &&
                      brunt_symmetry_before(plane, at) <= m->body->grid.order);
    }
    return any;
}

static void find_bearers(const job *j, const group *g, int node, const node_contacts *here, bearers *near) {
    near->count = 0;
    for (int k = 0; k < j->bearers; k++) {
        const brunt_symmetry_plane *plane = &j->m->symmetry[k];
        if (plane->boundary < 0 || !any_follows(j, plane, node, here)) continue;
        near->account[near->count] = &j->w->accounts[g->account + g->count * (g->count - 1) / 2 + k];
        near->plane[near->count++] = *plane;
    }
}

static void meet_at_node(const job *j, const group *g, int node, brunt_node_gap *thread) {
    node_contacts here;
    here.count = here.contact_count = 0, here.fixed = false;
    find_members(j, g, node, thread, &here);
    if (here.count < 2) return;
    double scale = 0;
    for (int i = 0; i < here.count; i++) {
        for (int a = 0; a < j->bodies[0].grid.dim; a++) scale = fmax(scale, fabs(here.members[i].v[a]));
        for (int k = i + 1; k < here.count; k++) add_contact(j, g, node, i, k, thread, &here);
    }
    if (!here.contact_count) return;
    solve_node(&here, scale);
    const brunt_grid *grid = &here.members[0].body->grid;
    double x[3];
    brunt_node_position(grid, grid->slots[here.members[0].slot].coord, node, x);
    for (int q = 0; q < here.contact_count; q++)
        if (here.contacts[q].normal_impulse > 0 || here.contacts[q].law)
            account_contact(j, g, node, x, &here, &here.contacts[q]);
    bearers near;
    find_bearers(j, g, node, &here, &near);
    for (int i = 0; i < here.count; i++) scatter_node(j, &here.members[i], node, &near);
}

// Which nodes of a block have mass of two bodies, and how far they go along the last axis. Whether there are any.
static bool find_shared_nodes(const job *j, const group *g, bool shared[BRUNT_BLOCK_NODES], int nodes[2]) {
    uint8_t count[BRUNT_BLOCK_NODES] = {0};
    const brunt_grid *any = &j->bodies[0].grid;
    for (int32_t i = 0; i < g->count; i++) {
        const shared_slot *s = &j->w->shared[g->first + i];
        const real *at = brunt_slot_nodes(&j->bodies[s->body].grid, s->slot);
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++)
            count[node] += at[node * BRUNT_NODE_REALS] > 0 && count[node] < 2;
    }
    nodes[0] = any->side, nodes[1] = -1;
    for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
        int local[3];
        brunt_node_local(any, node, local);
        const int at = local[any->dim - 1];
        shared[node] = count[node] > 1;
        if (shared[node] && at < nodes[0]) nodes[0] = at;
        if (shared[node] && at > nodes[1]) nodes[1] = at;
    }
    return nodes[1] >= 0;
}

static void meet_in_block(const job *j, const group *g, brunt_node_gap *thread) {
    bool shared[BRUNT_BLOCK_NODES];
    int nodes[2];
    if (!find_shared_nodes(j, g, shared, nodes) || brunt_node_gap_begin(thread, g->count, nodes)) return;
    for (int node = 0; node < BRUNT_BLOCK_NODES; node++)
        if (shared[node]) meet_at_node(j, g, node, thread);
}

static void meet_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const job *j = context;
    for (int64_t q = begin; q < end; q++) meet_in_block(j, &j->w->groups[q], &j->w->thread[worker]);
}

static int make_threads(brunt_contact_workspace *w, int threads, brunt_error *error) {
    if (w->thread_count >= threads) return BRUNT_OK;
    const int status = BRUNT_NEW(w->thread, threads, "threads that meet at grid nodes", error);
    w->thread_count = status ? 0 : threads;
    return status;
}

int brunt_grid_velocity_apply(const brunt_contact_context *m, brunt_contact_workspace **workspace, brunt_error *error) {
    if (!*workspace && BRUNT_NEW(*workspace, 1, "room for contact at grid nodes", error)) return BRUNT_FAILED;
    if (make_threads(*workspace, m->threads, error)) return BRUNT_FAILED;
    job j = {.m = m, .bodies = m->mpm, .w = *workspace};
    for (int k = 0; k < METHODS; k++) j.law[k] = brunt_contact_node_law((brunt_contact_method)k);
    j.follows = m->symmetry_count > 0, j.bearers = m->symmetry_count;
    if (find_groups(&j, error)) return BRUNT_FAILED;
    for (int t = 0; t < m->threads; t++) j.w->thread[t].error.code = BRUNT_OK;
    brunt_parallel(m->threads, j.w->group_count, 1, meet_blocks, &j, m->timer);
    for (int t = 0; t < m->threads; t++)
        if (brunt_hand_on(error, &j.w->thread[t].error)) return BRUNT_FAILED;
    for (int32_t q = 0; q < j.w->group_count; q++) {
        const group *g = &j.w->groups[q];
        int at = g->account;
        for (int32_t i = 0; i < g->count; i++)
            for (int32_t k = i + 1; k < g->count; k++, at++) {
                int32_t pair = pair_between(&j, j.w->shared[g->first + i].body, j.w->shared[g->first + k].body);
                if (pair >= 0) brunt_impulse_account_add(&m->pairs[pair].last, &j.w->accounts[at]);
            }
        for (int k = 0; k < j.bearers; k++, at++)
            if (m->symmetry[k].boundary >= 0)
                brunt_impulse_account_add(&m->boundaries[m->symmetry[k].boundary].last, &j.w->accounts[at]);
    }
    return BRUNT_OK;
}
