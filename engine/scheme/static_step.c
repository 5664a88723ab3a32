// Load steps: how large the forces are of which some stay unbalanced, how stiff nodes are, and what nothing holds.
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "scheme/implicit.h"

// Of the stiffness, beside which bodies stay near where they are: that nothing holds, and that contact alone holds.
static const double UNSUPPORTED = 1e-5, BORNE = 1e-7, LEAST = 1e-10;

// ------------------------------------------------------------------------------------------ parts of load steps

double brunt_static_least(const brunt_settings *settings) {
    return settings->fixed_step * ldexp(1 - 1e-9, -settings->newton.cut);
}

// Up to the next load step; after a step that was cut, longer ones again.
double brunt_static_wanted(const brunt_world *world) {
    const double whole = world->settings.fixed_step, time = world->clock.time;
    const double next = fmin((floor(time / whole + 1e-6) + 1) * whole, world->settings.end);
    return fmin(world->clock.next_dt, next - time);
}

// ------------------------------------------------------------------------------------------ how stiff, how large

static void stiffen(struct brunt_implicit *m, int32_t n, double mass, double rate) {
    m->field.stiffness[n] = fmax(m->field.stiffness[n], mass * rate * rate);
}

// m (c / h)^2 of nodes: what waves make of them is their stiffness, about. Planes that move are as stiff as the
// stiffest.
static void take_stiffness(const brunt_world *world, struct brunt_implicit *m) {
    const brunt_unknowns *u = &m->unknowns;
    double most = 0;
    memset(m->field.stiffness, 0, (size_t)u->count * sizeof *m->field.stiffness);
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const brunt_fem_body *fem = &world->bodies.fem[k];
        for (int32_t i = 0; i < fem->node_count; i++)
            stiffen(m, u->base[k] + i, u->mass[u->base[k] + i], (double)fem->material.wave_speed / fem->mean_edge);
    }
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        const brunt_body *body = &world->bodies.mpm[i];
        const double rate = (double)body->material.wave_speed / (double)body->grid.h;
        for (int64_t q = 0; q < (int64_t)body->grid.slot_count * BRUNT_BLOCK_NODES; q++)
            if (u->number[i][q] >= 0) stiffen(m, u->number[i][q], u->mass[u->number[i][q]], rate);
    }
    for (int32_t n = 0; n < u->count; n++) most = fmax(most, m->field.stiffness[n]);
    for (int w = 0; w < world->boundaries.boundary_count; w++)
        if (u->plane[w] >= 0) m->field.stiffness[u->plane[w]] = most;
}

// [N] Surfaces that begin within the distance push each other apart: by a force that on its way stores what barriers
// began with.
static double pushes(const brunt_world *world) {
    const struct brunt_implicit *m = world->plan.implicit;
    if (!m->contact.barrier || !(m->contact.distance > 0)) return 0;
    if (world->clock.steps > 0) return world->ledger.barrier_initial / m->contact.distance;
    const brunt_term *term = &m->term[m->body_terms];
    return term->ops->energy(term->self, &m->team, m->field.u).value / m->contact.distance;
}

static const double ROUNDING = DBL_EPSILON; // of places and ways, of their size

double brunt_static_rounding(const struct brunt_implicit *m, int64_t k) {
    return ROUNDING * m->field.stiffness[k / m->unknowns.dim] * fabs(m->unknowns.position[k]);
}

static const double STALLS = 0.5; // of what was left before
enum { IN_A_ROW = 2 };            // iterations: friction that turns round may stop one
static const double ALONE = 100;  // times the tolerance: of the forces on one body

// Forces within bodies as the step begins, which loads and reactions balance; loads at its end, without any those that
// push at the start; and what rounding makes of them.
static void take_scale(const brunt_world *world, struct brunt_implicit *m) {
    const int64_t all = brunt_implicit_components(m);
    double within = 0, loads = 0, rounding = 0;
    const brunt_fold *fold = brunt_unknowns_fold(&m->unknowns);
    brunt_implicit_gradient(m, m->fixed_terms, m->body_terms, m->field.u, m->field.step);
    if (fold) brunt_fold_gather(fold, m->unknowns.dim, m->field.step);
    for (int64_t k = 0; k < all; k++) {
        within += fabs(m->field.step[k]), loads += fabs(m->field.load[k]);
        rounding += brunt_static_rounding(m, k);
    }
    if (m->holds) rounding += ROUNDING * brunt_boundary_rows_effort(&m->rows);
    m->scale = (brunt_load_scale){
        .least = fmax(within, loads > 0 ? loads : pushes(world)), .rounding = rounding, .stalled = IN_A_ROW - 1};
}

double brunt_static_unbalance(void *context, const double *gradient) {
    struct brunt_implicit *m = context;
    double left = 0, reactions = 0;
    for (int64_t k = 0; k < brunt_implicit_components(m); k++)
        *(m->unknowns.held[k] ? &reactions : &left) += fabs(gradient[k]);
    if (m->holds) reactions += brunt_boundary_rows_forces(&m->rows, m->field.u);
    const double act = fmax(m->scale.least, reactions), share = act > 0 ? left / act : left > 0 ? 1 : 0;
    // What rounding of all forces makes one body may hold alone: it is none as long as iterations lessen it.
    if (left != m->scale.left) { // else it is where it was
        m->scale.stalled = left > STALLS * m->scale.left ? m->scale.stalled + 1 : 0;
        m->scale.left = left;
    }
    const bool rounding = left <= m->scale.rounding && m->scale.stalled >= IN_A_ROW;
    double counts = rounding ? 0 : share;
    // A small share of all forces may be most of those on one body.
    if (!rounding && share <= m->options.tolerance) counts = fmax(share, brunt_static_alone(m, gradient, act) / ALONE);
    // Where it has converged its stability is asked for next: that bodies which contact alone holds slide on its
    // ripples is no matter.
    const bool done = counts <= m->options.tolerance;
    const double less = done ? 1 : sqrt(fmin(share, 1));
    m->proximal.share[BRUNT_UNSUPPORTED] = fmax(LEAST, UNSUPPORTED * less);
    m->proximal.share[BRUNT_BORNE] = fmax(LEAST, (done ? UNSUPPORTED : BORNE) * less);
    return counts;
}

void brunt_static_settle(brunt_world *world) {
    const struct brunt_implicit *m = world->plan.implicit;
    const int64_t grids = (int64_t)m->unknowns.mesh_count * m->unknowns.dim;
    for (int64_t k = 0; k < brunt_implicit_components(m); k++)
        if (!m->unknowns.held[k])
            *(k < grids ? &world->ledger.scheme : &world->ledger.transfer) +=
                0.5 * m->field.force_before[k] * m->field.u[k];
}

// Between its ends forces may go as they like, as long as bodies are stiff: by the trapezium of both, little is lost.
void brunt_static_watch(brunt_world *world, double taken, double work) {
    static const double MUCH = 0.1; // of the work
    struct brunt_implicit *m = world->plan.implicit;
    if (m->told_jump || !(fabs(taken) > MUCH * fabs(work)) || !(fabs(work) > 0)) return;
    m->told_jump = true;
    const brunt_unknowns *u = &m->unknowns;
    int64_t most = 0;
    for (int64_t k = 0; k < brunt_implicit_components(m); k++)
        if (!u->held[k] && fabs(m->field.u[k]) > fabs(m->field.u[most])) most = k;
    const brunt_unknown_location at = brunt_unknowns_location(u, &world->bodies, (int32_t)(most / u->dim));
    brunt_warn(
        &world->messages,
        "bodies.%s: from t = %.6g to %.6g of the loads %.3g of the work on bodies (%.3g J) is not stored in them: near "
        "(%.4g, %.4g, %.4g) m they jump to another equilibrium, or load steps are too long (time.steps)",
        at.body < 0 ? "" : brunt_body_name(world, at.body), world->clock.time, world->clock.time + m->dt, taken / work,
        taken, at.x[0], at.x[1], at.x[2]);
}

// ------------------------------------------------------------------------------------------ what nothing holds

enum { MODES = 6 };

// Nodes of a body, or of bodies that are tied; rigid motions about their middle, turns scaled by their size.
typedef struct piece {
    const brunt_unknowns *u;
    const int32_t *node; // NULL: first, first + 1 ..
    int32_t first, count;
    int modes;
    double middle[3], size;
    const brunt_boundary_rows *rows; // NULL: it has none
    int body;                        // whose they are
} piece;

static int32_t node_of(const piece *p, int32_t i) { return p->node ? p->node[i] : p->first + i; }

static void rigid_modes(const piece *p, int32_t n, double mode[MODES][3]) {
    const int dim = p->u->dim;
    double x[3] = {0};
    memset(mode, 0, MODES * sizeof *mode);
    for (int a = 0; a < dim; a++)
        mode[a][a] = 1, x[a] = (p->u->position[n * (int64_t)dim + a] - p->middle[a]) / p->size;
    for (int k = dim; k < p->modes; k++) {
        const int axis = dim == 2 ? 2 : k - dim, i = (axis + 1) % 3, j = (axis + 2) % 3;
        mode[k][i] = -x[j], mode[k][j] = x[i];
    }
}

static void measure_piece(piece *p) {
    const int dim = p->u->dim;
    double mass = 0, square = 0, sum[3] = {0};
    for (int32_t i = 0; i < p->count; i++) {
        const int32_t n = node_of(p, i);
        mass += p->u->mass[n];
        for (int a = 0; a < dim; a++) sum[a] += p->u->mass[n] * p->u->position[n * (int64_t)dim + a];
    }
    for (int a = 0; a < dim; a++) p->middle[a] = sum[a] / mass;
    for (int32_t i = 0; i < p->count; i++)
        for (int a = 0; a < dim; a++) {
            const double off = p->u->position[node_of(p, i) * (int64_t)dim + a] - p->middle[a];
            square += p->u->mass[node_of(p, i)] * off * off;
        }
    p->size = sqrt(square / mass);
}

// What holders can take of forces along the rigid motions: Gram's matrix of those over all that is held, A; loads along
// them, b [N]. `all`: sum of the sizes of loads.
typedef struct holding {
    double A[MODES][MODES], b[MODES], all;
} holding;

// What pieces of surfaces hold, along their rows.
static void add_rows(const piece *p, holding *h) {
    const brunt_boundary_rows *rows = p->rows;
    const int dim = p->u->dim;
    for (int32_t patch = 0; rows && patch < rows->patch_count; patch++) {
        const brunt_boundary_patch *at = &rows->patch[patch];
        for (int row = 0; at->body == p->body && !at->leaves && row < at->rows; row++) {
            double along[MODES] = {0}, mode[MODES][3], square = 0;
            for (int64_t e = rows->first[patch]; e < rows->first[patch + 1]; e++) {
                rigid_modes(p, rows->node[e], mode);
                for (int a = 0; a < dim; a++) {
                    const double w = rows->weight[e][3 * row + a];
                    square += w * w;
                    for (int k = 0; k < p->modes; k++) along[k] += w * mode[k][a];
                }
            }
            for (int k = 0; k < p->modes; k++)
                for (int q = 0; q < p->modes; q++) h->A[k][q] += along[k] * along[q] / square;
        }
    }
}

static void take_holding(const piece *p, const double *load, holding *h) {
    const int dim = p->u->dim;
    double mode[MODES][3];
    *h = (holding){.all = 0};
    for (int32_t i = 0; i < p->count; i++) {
        const int32_t n = node_of(p, i);
        rigid_modes(p, n, mode);
        for (int a = 0; a < dim; a++) {
            const bool held = p->u->held[n * (int64_t)dim + a] != 0;
            h->all += fabs(load[n * (int64_t)dim + a]);
            for (int k = 0; k < p->modes; k++) {
                h->b[k] += mode[k][a] * load[n * (int64_t)dim + a];
                for (int q = 0; held && q < p->modes; q++) h->A[k][q] += mode[k][a] * mode[q][a];
            }
        }
    }
    add_rows(p, h);
}

// Solves (A + spare I) c = b by Cholesky; whether A alone was definite. What A cannot give of b is spare c.
static bool solve_holding(holding *h, int modes, double c[MODES]) {
    double trace = 0, least = INFINITY, L[MODES][MODES] = {{0}};
    for (int k = 0; k < modes; k++) trace += h->A[k][k];
    const double spare = trace > 0 ? 1e-12 * trace : 1;
    for (int k = 0; k < modes; k++)
        for (int q = 0; q <= k; q++) {
            double sum = h->A[k][q] + (k == q ? spare : 0);
            for (int r = 0; r < q; r++) sum -= L[k][r] * L[q][r];
            if (k == q) least = fmin(least, sum), L[k][k] = sqrt(fmax(sum, 0.5 * spare));
            if (k != q) L[k][q] = sum / L[q][q];
        }
    for (int k = 0; k < modes; k++) {
        c[k] = h->b[k];
        for (int q = 0; q < k; q++) c[k] -= L[k][q] * c[q];
        c[k] /= L[k][k];
    }
    for (int k = modes - 1; k >= 0; k--) {
        for (int q = k + 1; q < modes; q++) c[k] -= L[q][k] * c[q];
        c[k] /= L[k][k];
    }
    for (int k = 0; k < modes; k++) c[k] *= spare;
    return least > 100 * spare;
}

// Whether it comes to a surface that it may leave.
static bool meets_surface(const struct brunt_implicit *m, int i) {
    bool meets = false;
    for (int32_t p = 0; m->holds && p < m->rows.patch_count; p++)
        meets = meets || (m->rows.patch[p].body == i && m->rows.patch[p].leaves);
    return meets;
}

static bool meets_something(const struct brunt_implicit *m, int body) {
    const brunt_implicit_contact *c = &m->contact;
    bool meets = c->met && c->met[body];
    for (int32_t q = 0; q < c->plane_count; q++) meets = meets || !c->plane[q].meets || c->plane[q].meets[body];
    return meets;
}

// Whether holders and contact can bear the loads of a piece, whose name is that of `body`.
static int check_piece(brunt_world *world, piece *p, int body, bool meets, brunt_error *error) {
    static const double SMALL = 1e-6; // of the loads
    struct brunt_implicit *m = world->plan.implicit;
    holding h;
    double left[MODES], force = 0, moment = 0;
    measure_piece(p);
    take_holding(p, m->field.load, &h);
    const bool held = solve_holding(&h, p->modes, left);
    const brunt_support support = held ? BRUNT_GROUNDED : meets ? BRUNT_BORNE : BRUNT_UNSUPPORTED;
    for (int32_t i = 0; i < p->count; i++) m->field.support[node_of(p, i)] = (uint8_t)support;
    for (int k = 0; k < p->modes; k++) *(k < p->u->dim ? &force : &moment) += left[k] * left[k];
    force = sqrt(force), moment = sqrt(moment);
    if (held || meets || force + moment <= SMALL * h.all) return BRUNT_OK;
    char reason[200];
    snprintf(reason, sizeof reason,
             "nothing holds it against its loads: a force of %.3g N and a moment of %.3g N m stay unbalanced, and it "
             "meets nothing: no equilibrium",
             force, moment * p->size);
    return brunt_fail_position(world, body, p->middle, error, reason);
}

// The nodes of points that are tied to body i, and whether one of them meets something.
static int check_points(brunt_world *world, int i, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    const brunt_unknowns *u = &m->unknowns;
    piece p = {.u = u, .first = u->mesh_count, .modes = u->dim == 2 ? 3 : MODES};
    p.rows = m->holds ? &m->rows : NULL, p.body = i;
    bool meets = meets_surface(m, i);
    int32_t *node;
    uint8_t *seen = NULL;
    int status = BRUNT_NEW(node, u->count + 1, "unknowns of points", error);
    if (!status) status = BRUNT_NEW(seen, u->count + 1, "marks of unknowns", error);
    for (int k = i; !status && k < world->bodies.mpm_count; k++) {
        const brunt_body *body = &world->bodies.mpm[k];
        if (u->tie[k] != i) continue;
        meets = meets || meets_something(m, body->index);
        for (int64_t q = 0; q < (int64_t)body->grid.slot_count * BRUNT_BLOCK_NODES; q++) {
            const int32_t n = u->number[k][q];
            if (n < 0 || seen[n]) continue;
            seen[n] = 1, node[p.count++] = n;
        }
    }
    p.node = node;
    if (!status && p.count) status = check_piece(world, &p, world->bodies.mpm[i].index, meets, error);
    brunt_free(node), brunt_free(seen);
    return status;
}

int brunt_static_begin(brunt_world *world, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    const brunt_unknowns *u = &m->unknowns;
    take_stiffness(world, m);
    take_scale(world, m);
    memset(m->field.support, BRUNT_GROUNDED, (size_t)u->count);
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const brunt_fem_body *fem = &world->bodies.fem[k];
        piece p = {.u = u, .first = u->base[k], .count = fem->node_count, .modes = u->dim == 2 ? 3 : MODES};
        if (check_piece(world, &p, fem->index, meets_something(m, fem->index), error)) return BRUNT_FAILED;
    }
    for (int i = 0; i < world->bodies.mpm_count; i++)
        if (u->tie[i] == i && check_points(world, i, error)) return BRUNT_FAILED;
    return BRUNT_OK;
}
