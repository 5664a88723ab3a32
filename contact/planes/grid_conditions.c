#include "contact/planes/grid_conditions.h"
#include "contact/distance/particle_extent.h"
#include "contact/planes/followed.h"

#include <math.h>
#include <string.h>

#include "base/array.h"

void brunt_condition_reflect(bool axisymmetric, const double position[3], double h, double now[3]) {
    if (!axisymmetric) return;
    if (position[0] < -1e-9 * h) now[0] = -now[0];
    if (fabs(position[0]) <= 1e-9 * h) now[0] = 0;
}

// Node `number` of the grid gets a velocity, components of it are held, and what moves at `rest` is recorded; x [m]:
// its place.
static void hold_node(brunt_body *body, int64_t number, const double now[3], const double rest[3], unsigned held,
                      brunt_impulse_account *account, double x[3]) {
    const brunt_grid *grid = &body->grid;
    const int32_t s = (int32_t)(number / BRUNT_BLOCK_NODES);
    const int node = (int)(number % BRUNT_BLOCK_NODES);
    real *n = grid->nodes + number * BRUNT_NODE_REALS;
    double J[3] = {0}, old[3] = {0};
    grid->held[number] |= (uint8_t)held;
    brunt_node_position(grid, grid->slots[s].coord, node, x);
    if (brunt_total_lagrangian(&body->particles)) brunt_extent_deformed(body, s, node, x);
    for (int a = 0; a < grid->dim; a++) {
        J[a] = (double)n[BRUNT_NODE_SPARE] * (now[a] - (double)n[BRUNT_NODE_VELOCITY + a]);
        old[a] = (double)n[BRUNT_NODE_OLD + a];
        n[BRUNT_NODE_VELOCITY + a] = (real)now[a];
    }
    brunt_impulse_account_record(account, &account->normal_loss, J, x, old, now, rest);
}

// ------------------------------------------------------------------------------------------ images

// A node and its images.
typedef struct image_class {
    int count;
    int32_t at[BRUNT_MAX_IMAGES][3];
    real sign[BRUNT_MAX_IMAGES][3], *node[BRUNT_MAX_IMAGES]; // NULL: nothing is there
    bool follows;                                            // itself, what is before the planes
} image_class;

static void find_images(const brunt_held_grid *g, int32_t s, int node, image_class *c) {
    const brunt_grid *grid = &g->body->grid;
    int32_t at[3];
    brunt_node_coordinates(grid, s, node, at);
    c->count = brunt_symmetry_images(g->symmetry, g->symmetry_count, at, BRUNT_IMAGE_LAYERS, c->at, c->sign);
    c->follows = false;
    for (int i = 0; i < c->count; i++) {
        bool before = true;
        c->node[i] = brunt_grid_node(grid, c->at[i]);
        if (c->node[i] && !(c->node[i][BRUNT_NODE_MASS] > 0)) c->node[i] = NULL;
        for (int k = 0; k < g->symmetry_count; k++)
            before = before && brunt_symmetry_before(&g->symmetry[k], c->at[i]) >= 0;
        c->follows = c->follows || (i && before && c->node[i]);
    }
}

// What planes bear of an impulse at x and of its moment, of each component by its share.
static void bear(const brunt_held_grid *g, const int32_t at[3], const double J[3], const double x[3]) {
    for (int a = 0; a < g->body->grid.dim; a++) {
        const int i = (a + 1) % 3, j = (a + 2) % 3;
        double share[BRUNT_MAX_PLANES];
        brunt_symmetry_shares(g->symmetry, g->symmetry_count, at, a, share);
        for (int k = 0; k < g->symmetry_count; k++) {
            double part[3] = {0}, turn[3] = {0};
            part[a] = share[k] * J[a], turn[i] = x[j] * part[a], turn[j] = -x[i] * part[a];
            brunt_impulse_account_reaction(g->account[k], part, turn);
        }
    }
}

// Image i follows the node, at x, where what moves it is.
static void follow(const brunt_held_grid *g, const image_class *c, int i, const double x[3], const double rest[3],
                   unsigned held, brunt_impulse_account *account) {
    const brunt_grid *grid = &g->body->grid;
    const int64_t number = (c->node[i] - grid->nodes) / BRUNT_NODE_REALS;
    brunt_impulse_account own = {.external_work = 0};
    double now[3] = {0}, moves[3] = {0}, there[3], J[3], turn[3];
    for (int a = 0; a < grid->dim; a++) {
        now[a] = (double)(c->sign[i][a] * c->node[0][BRUNT_NODE_VELOCITY + a]);
        moves[a] = (double)c->sign[i][a] * rest[a];
    }
    hold_node(g->body, number, now, moves, held, &own, there);
    bear(g, c->at[i], own.impulse, there);
    for (int a = 0; a < 3; a++) J[a] = -(double)c->sign[i][a] * own.impulse[a];
    bear(g, c->at[0], J, x);
    for (int a = 0; a < 3; a++) own.impulse[a] = -J[a];
    for (int a = 0; a < 3; a++) turn[a] = x[(a + 2) % 3] * J[(a + 1) % 3] - x[(a + 1) % 3] * J[(a + 2) % 3];
    memcpy(own.angular, turn, sizeof turn);
    own.area = account->area;
    brunt_impulse_account_add(account, &own);
}

// The components that something later gives another velocity than `rest`, which is that of those held here.
static unsigned given_later(const brunt_held_grid *g, const brunt_slot *slot, int node, const double rest[3],
                            unsigned held) {
    const brunt_grid *grid = &g->body->grid;
    const bool total = brunt_total_lagrangian(&g->body->particles);
    unsigned given = 0;
    double x[3];
    if (!g->later_count) return 0;
    brunt_node_position(grid, slot->coord, node, x);
    if (brunt_axisymmetric(&g->body->particles)) x[0] = fabs(x[0]);
    for (int k = 0; k < g->later_count; k++) {
        const brunt_boundary *b = &g->later[k];
        double v[3] = {0};
        if (!b->kind->hold_at || b->symmetry_plane >= 0 || (b->body >= 0 && b->body != g->body->index)) continue;
        const double time = total && b->kind->is_plane ? 0 : g->time; // of such bodies planes are where they began
        const unsigned theirs = b->kind->hold_at(b, grid->dim, time, x, BRUNT_ON_BOUNDARY * (double)grid->h, v);
        for (int a = 0; a < grid->dim; a++)
            if (theirs >> a & 1 && (!(held >> a & 1) || v[a] != rest[a])) given |= 1u << a;
    }
    return given;
}

void brunt_condition_hold(const brunt_held_grid *g, const brunt_slot *slot, int node, const double velocity[3],
                          const double rest[3], unsigned held, brunt_impulse_account *account) {
    const brunt_grid *grid = &g->body->grid;
    const int64_t number = (slot - grid->slots) * BRUNT_BLOCK_NODES + node;
    const real *n = grid->nodes + number * BRUNT_NODE_REALS;
    const unsigned theirs = given_later(g, slot, node, rest, held);
    image_class c;
    double x[3], now[3] = {0}, given[3] = {0}, moves[3] = {0};
    held &= ~theirs;
    for (int a = 0; a < grid->dim; a++) now[a] = theirs >> a & 1 ? (double)n[BRUNT_NODE_VELOCITY + a] : velocity[a];
    if (!g->symmetry_count) {
        hold_node(g->body, number, now, rest, held, account, x);
        return;
    }
    find_images(g, (int32_t)(slot - grid->slots), node, &c);
    if (c.follows) return;
    for (int a = 0; a < grid->dim; a++) {
        const bool rests = c.sign[0][a] == 0;
        given[a] = rests ? (double)n[BRUNT_NODE_VELOCITY + a] : now[a];
        moves[a] = rests ? 0 : rest[a];
        held &= rests ? ~(1u << a) : ~0u;
    }
    hold_node(g->body, number, given, moves, held, account, x);
    for (int i = 1; i < c.count; i++)
        if (c.node[i]) follow(g, &c, i, x, moves, held, account);
}

// ------------------------------------------------------------------------------------------ all

int brunt_condition_clear(brunt_body *body, brunt_error *error) {
    const size_t bytes = (size_t)body->grid.slot_count * BRUNT_BLOCK_NODES;
    if (BRUNT_CAPACITY(body->grid.held, bytes, 0, "grid nodes under conditions", error)) return BRUNT_FAILED;
    memset(body->grid.held, 0, bytes);
    return BRUNT_OK;
}
