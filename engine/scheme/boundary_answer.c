// The tractions that an iteration of Newton's method leads to, of all pieces at once.
//
// Where materials have no energy, nothing says which of two guesses of what pushes, sticks and slips is better, and
// guesses that change from iteration to iteration go to and fro. But the rows are few, and the factor says what each
// moves. The linear system K du + g + C^T l = 0 is, with A = K + C^T b/D C and y = l - b/D C du,
//   A du = -g - C^T y,   C du = c - C A^-1 C^T y,   l = y + b/D C du,
// of which c and the matrix are known. Pieces are asked in turn for the l that their conditions want, each with the y
// of the others as they are by then, until none changes (Jourdan, Alart and Jean 1998, Comput. Methods Appl. Mech.
// Engrg. 155). Friction is by the pressure of the same l. Where that goes to and fro, as it may with friction and
// slopes that are not symmetric, the turn that changed least is taken: the next iteration goes on from there.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "contact/constraint/coulomb.h"
#include "scheme/boundary_rows.h"

enum { ROUND_LIMIT = 1000, PATIENCE = 200, AT_ONCE = 32 }; // PATIENCE: rounds; AT_ONCE: systems, for the solver's sake
static const double LEAST = 1e-6;   // of the stiffness of a row, without b: what has less, or none, as softening has,
static const double INSTEAD = 0.05; // is asked as if it had this
static const double EVEN = 1e-11;   // cells: what pieces change at the end
static const double SLOW = 1e-8;    // cells: what may be left of what is held

// What a unit traction of each row moves, along all rows: column by column.
static int take_columns(const brunt_boundary_rows *r, const brunt_response *response, double *x, double *moves) {
    const int64_t unknowns = (int64_t)r->unknowns->count * r->unknowns->dim;
    const int rows = r->row_count;
    double out[3];
    for (int first = 0; first < rows; first += AT_ONCE) {
        const int count = rows - first < AT_ONCE ? rows - first : AT_ONCE;
        memset(x, 0, (size_t)(count * unknowns) * sizeof *x);
        for (int32_t p = 0; p < r->patch_count; p++)
            for (int k = 0; k < r->patch[p].rows; k++) {
                const int at = r->patch[p].row + k - first;
                const double unit[3] = {k == 0, k == 1, k == 2};
                if (at >= 0 && at < count) brunt_boundary_patch_add(r, p, unit, x + at * unknowns);
            }
        if (response->ways(response->context, count, x)) return BRUNT_FAILED;
        for (int k = 0; k < count; k++)
            for (int32_t q = 0; q < r->patch_count; q++) {
                brunt_boundary_patch_rows(r, q, x + k * unknowns, out);
                for (int i = 0; i < r->patch[q].rows; i++)
                    moves[(size_t)(r->patch[q].row + i) * (size_t)rows + (size_t)(first + k)] = out[i];
            }
    }
    return BRUNT_OK;
}

typedef struct turn {
    const brunt_boundary_rows *r;
    const double *moves;
    double part;                  // of the way to what is wanted: less where it goes to and fro
    double *gap, *way, *y, *best; // of all rows: at u [m^3]; by the step with y = 0 [m^3]; y [Pa], the best so far
} turn;

static double own(const turn *t, int row) { return t->moves[(size_t)row * (size_t)t->r->row_count + (size_t)row]; }

// How far a row goes.
static double way_of(const turn *t, int row) {
    const double *moves = t->moves + (size_t)row * (size_t)t->r->row_count;
    double sum = 0;
    for (int k = 0; k < t->r->row_count; k++) sum += moves[k] * t->y[k];
    return t->way[row] - sum;
}

// What is left of the stiffness of a row of A without b, of all of it.
static double rest(const turn *t, const brunt_boundary_patch *p, int row) {
    const double left = 1 - p->stiffness / p->size * own(t, row);
    return left > LEAST ? left : INSTEAD;
}

// The traction of a row, and the one that alone would close its gap.
static double closing(const turn *t, const brunt_boundary_patch *p, int row, double *traction) {
    const double way = way_of(t, row);
    *traction = t->y[row] + p->stiffness / p->size * way;
    return own(t, row) > 0 ? *traction + rest(t, p, row) / own(t, row) * (t->gap[row] + way) : *traction;
}

// Gives a row another traction; by how much that changes its gap [m].
static double change(const turn *t, const brunt_boundary_patch *p, int row, double by) {
    t->y[row] += t->part * by / rest(t, p, row);
    return fabs(by / rest(t, p, row)) * own(t, row) / p->size;
}

// Directions of friction.
static double rub(const turn *t, brunt_boundary_patch *p) {
    const int rows = p->rows - 1, first = p->row + 1;
    double traction[2], wanted[2], friction[2] = {0}, off[2], most = 0;
    for (int k = 0; k < rows; k++) {
        wanted[k] = closing(t, p, first + k, &traction[k]);
        wanted[k] = traction[k] + (wanted[k] - traction[k]) / rows; // two of them do not overshoot
    }
    brunt_coulomb_project(rows, 1, p->bound, wanted, friction, off);
    for (int k = 0; k < rows; k++) most = fmax(most, change(t, p, first + k, friction[k] - traction[k]));
    return most;
}

// The greatest way by which a patch changes the gaps of its own rows [m].
static double ask(const turn *t, brunt_boundary_patch *p) {
    double most = 0, traction;
    for (int k = 0; k < (p->rubs ? 1 : p->rows); k++) {
        const double closes = closing(t, p, p->row + k, &traction), l = p->leaves ? fmin(0, closes) : closes;
        most = fmax(most, change(t, p, p->row + k, l - traction));
        if (p->rubs) p->bound = p->surface->def.friction * fmax(0, -(traction + t->part * (l - traction)));
    }
    return p->rubs ? fmax(most, rub(t, p)) : most;
}

// Ways of all rows in the step, and what acts on A by then: the tractions at u.
static void take_gaps(const turn *t, const double *u, const double *step) {
    const brunt_boundary_rows *r = t->r;
    double now[3], at[3], along[3];
    for (int32_t p = 0; p < r->patch_count; p++) {
        const brunt_boundary_patch *patch = &r->patch[p];
        brunt_boundary_patch_traction(r, p, u, now, at);
        brunt_boundary_patch_rows(r, p, u, at);
        brunt_boundary_patch_rows(r, p, step, along);
        for (int k = 0; k < patch->rows; k++) {
            t->gap[patch->row + k] = at[k] - patch->goal[k];
            t->way[patch->row + k] = along[k], t->y[patch->row + k] = now[k];
        }
    }
    for (int k = 0; k < r->row_count; k++)
        for (int j = 0; j < r->row_count; j++)
            t->way[k] += t->moves[(size_t)k * (size_t)r->row_count + (size_t)j] * t->y[j];
}

static void ask_all(turn *t) {
    const brunt_boundary_rows *r = t->r;
    const size_t bytes = (size_t)r->row_count * sizeof *t->y;
    double most = INFINITY, least = INFINITY;
    for (int round = 0; round < ROUND_LIMIT && most > EVEN * r->cell; round++) {
        most = 0, t->part = round < PATIENCE ? 1 : 0.5;
        for (int32_t p = 0; p < r->patch_count; p++) {
            const double changed = ask(t, &r->patch[p]);
            if (!(changed <= most)) most = changed;
        }
        if (!isfinite(most)) break; // it grows without end
        if (most < least) least = most, memcpy(t->best, t->y, bytes);
    }
    memcpy(t->y, t->best, bytes);
}

// A patch whose rows have no end though they alone decide it: something else holds what they hold.
static int32_t find_held(const turn *t) {
    const brunt_boundary_rows *r = t->r;
    for (int32_t p = 0; p < r->patch_count; p++) {
        const brunt_boundary_patch *patch = &r->patch[p];
        for (int k = patch->row; k < patch->row + patch->rows && !patch->leaves; k++)
            if (!(own(t, k) > 0) && fabs(t->gap[k] + way_of(t, k)) > SLOW * r->cell * patch->size) return p;
    }
    return BRUNT_NONE;
}

// Multipliers as they were found, to be followed; what acts on A instead of the tractions at u is added to g.
static void take_tractions(const turn *t, const double *u, double *g) {
    const brunt_boundary_rows *r = t->r;
    double now[3], other[3], moved[3];
    for (int32_t p = 0; p < r->patch_count; p++) {
        brunt_boundary_patch *patch = &r->patch[p];
        patch->bound = patch->before_bound;
        brunt_boundary_patch_traction(r, p, u, now, moved);
        for (int k = 0; k < patch->rows; k++) {
            closing(t, patch, patch->row + k, &patch->to[k]);
            other[k] = t->y[patch->row + k] - now[k];
        }
        if (patch->rubs) patch->bound = patch->surface->def.friction * fmax(0, -patch->to[0]);
        brunt_boundary_patch_admit(patch, patch->to);
        brunt_boundary_patch_add(r, p, other, g);
    }
}

int brunt_boundary_rows_answer(brunt_boundary_rows *r, const double *u, const double *step, double *g,
                               const brunt_response *response, int32_t *worst) {
    const size_t unknowns = (size_t)r->unknowns->count * (size_t)r->unknowns->dim, rows = (size_t)r->row_count;
    *worst = BRUNT_NONE;
    if (BRUNT_CAPACITY(r->answer, AT_ONCE * unknowns + rows * rows + 4 * rows, 0, "tractions of boundaries", NULL))
        return BRUNT_FAILED;
    double *moves = r->answer + AT_ONCE * unknowns, *gap = moves + rows * rows;
    turn t = {.r = r, .moves = moves, .gap = gap, .way = gap + rows, .y = gap + 2 * rows, .best = gap + 3 * rows};
    if (take_columns(r, response, r->answer, moves)) return BRUNT_FAILED;
    take_gaps(&t, u, step);
    memcpy(t.best, t.y, rows * sizeof *t.best);
    for (int32_t p = 0; p < r->patch_count; p++) r->patch[p].before_bound = r->patch[p].bound;
    ask_all(&t);
    *worst = find_held(&t);
    if (*worst != BRUNT_NONE) return BRUNT_FAILED;
    take_tractions(&t, u, g);
    return BRUNT_OK;
}
