// The term of lines and surfaces: an augmented Lagrangian, whose multipliers follow Newton's method.
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "contact/constraint/coulomb.h"
#include "linear/block_matrix.h"
#include "scheme/boundary_rows.h"

enum { SWEEP_LIMIT = 10, SLOW_LIMIT = 30, SOFTER = 3 }; // SOFTER: times as many where b is that of the grid
static const double EVEN = 1e-11;      // cells: how well what is held keeps its place within a step of Newton's method
static const double SLOW = 1e-8;       // cells: what many sweeps leave of conditions that do not contradict each other
static const double SETTLED = 1e-9;    // cells: the same of what may leave, at the end
static const double SAME_BOUND = 1e-6; // of the greatest: bounds of friction

// ------------------------------------------------------------------------------------------ one patch

// C u along each row [m^3].
void brunt_boundary_patch_rows(const brunt_boundary_rows *r, int32_t patch, const double *u, double out[3]) {
    const int dim = r->unknowns->dim;
    for (int k = 0; k < 3; k++) out[k] = 0;
    for (int64_t e = r->first[patch]; e < r->first[patch + 1]; e++)
        for (int k = 0; k < r->patch[patch].rows; k++)
            for (int a = 0; a < dim; a++) out[k] += r->weight[e][3 * k + a] * u[r->node[e] * (int64_t)dim + a];
}

// t of what would be without cone or sign, taken to where it may be.
void brunt_boundary_patch_admit(const brunt_boundary_patch *p, double t[3]) {
    double change[2], friction[2] = {0, 0};
    if (p->leaves) t[0] = fmin(0, t[0]);
    if (!p->rubs) return;
    brunt_coulomb_project(p->rows - 1, 1, p->bound, t + 1, friction, change);
    memcpy(t + 1, friction, (size_t)(p->rows - 1) * sizeof *t);
}

// l + b/D gap, before it is admitted.
static void tentative(const brunt_boundary_rows *r, int32_t patch, const double moved[3], double t[3]) {
    const brunt_boundary_patch *p = &r->patch[patch];
    for (int k = 0; k < 3; k++)
        t[k] = k < p->rows ? p->multiplier[k] + p->stiffness / p->size * (moved[k] - p->goal[k]) : 0;
}

void brunt_boundary_patch_traction(const brunt_boundary_rows *r, int32_t patch, const double *u, double t[3],
                                   double moved[3]) {
    brunt_boundary_patch_rows(r, patch, u, moved);
    tentative(r, patch, moved, t);
    brunt_boundary_patch_admit(&r->patch[patch], t);
    for (int k = 0; k < r->patch[patch].rows; k++) moved[k] -= r->patch[patch].prescribed[k];
}

void brunt_boundary_patch_force(const brunt_boundary_rows *r, int32_t patch, int64_t k, const double t[3],
                                double F[3]) {
    for (int a = 0; a < 3; a++) F[a] = 0;
    for (int row = 0; row < r->patch[patch].rows; row++)
        for (int a = 0; a < 3; a++) F[a] -= t[row] * r->weight[k][3 * row + a];
}

static double size_of(const double *t, int count) {
    double square = 0;
    for (int k = 0; k < count; k++) square += t[k] * t[k];
    return sqrt(square);
}

// ------------------------------------------------------------------------------------------ the energy

static brunt_energy_sum patch_energy(const brunt_boundary_rows *r, int32_t patch, const double *u) {
    const brunt_boundary_patch *p = &r->patch[patch];
    const double factor = 0.5 * p->size / p->stiffness;
    brunt_energy_sum sum = {0};
    double moved[3], wanted[3], t[3];
    brunt_boundary_patch_rows(r, patch, u, moved);
    tentative(r, patch, moved, wanted);
    memcpy(t, wanted, sizeof t);
    brunt_boundary_patch_admit(p, t);
    for (int k = 0; k < p->rows; k++) {
        // Beyond the cone the energy goes on straight: t . (2 wanted - t).
        const double now = p->rubs && k > 0 ? t[k] * (2 * wanted[k] - t[k]) : t[k] * t[k],
                     then = p->multiplier[k] * p->multiplier[k];
        sum.value += factor * (now - then), sum.magnitude += factor * (fabs(now) + then);
    }
    return sum;
}

static brunt_energy_sum rows_energy(void *term, const brunt_team *team, const double *u) {
    (void)team;
    const brunt_boundary_rows *r = term;
    brunt_energy_sum sum = {0};
    for (int32_t p = 0; p < r->patch_count; p++) {
        const brunt_energy_sum e = patch_energy(r, p, u);
        sum.value += e.value, sum.magnitude += e.magnitude;
    }
    return sum;
}

// ------------------------------------------------------------------------------------------ gradient and Hessian

// Adds C t.
void brunt_boundary_patch_add(const brunt_boundary_rows *r, int32_t patch, const double t[3], double *g) {
    const int dim = r->unknowns->dim;
    for (int64_t e = r->first[patch]; e < r->first[patch + 1]; e++)
        for (int k = 0; k < r->patch[patch].rows; k++)
            for (int a = 0; a < dim; a++) g[r->node[e] * (int64_t)dim + a] += t[k] * r->weight[e][3 * k + a];
}

static void rows_gradient(void *term, const brunt_team *team, const double *u, double *g) {
    (void)team;
    const brunt_boundary_rows *r = term;
    double t[3], moved[3];
    for (int32_t p = 0; p < r->patch_count; p++) {
        brunt_boundary_patch_traction(r, p, u, t, moved);
        brunt_boundary_patch_add(r, p, t, g);
    }
}

static brunt_stencils rows_stencils(void *term) {
    const brunt_boundary_rows *r = term;
    return (brunt_stencils){.count = r->patch_count, .first = r->first, .node = r->node, .version = r->version};
}

// Derivative of t by gap, times D: of what pushes or is held, and of friction within or on the cone.
static void slopes(const brunt_boundary_rows *r, brunt_boundary_patch *p, const double wanted[3], double slope[9]) {
    memset(slope, 0, 9 * sizeof *slope);
    if (r->exact) { // A: of whatever b, nothing of what comes out depends on it
        for (int k = 0; k < p->rows; k++) slope[4 * k] = p->stiffness;
        return;
    }
    p->stiff[0] = !p->leaves || wanted[0] <= 0, p->stiff[1] = !p->rubs;
    if (p->stiff[0]) slope[0] = p->stiffness;
    if (!p->rubs) {
        for (int k = 1; k < p->rows; k++) slope[4 * k] = p->stiffness;
        return;
    }
    const double size = size_of(wanted + 1, p->rows - 1), share = size > p->bound ? p->bound / size : p->bound > 0;
    p->stiff[1] = size <= p->bound && p->bound > 0;
    const bool straight = p->stiff[1] || size == 0;
    for (int i = 1; i < p->rows; i++)
        for (int j = 1; j < p->rows; j++)
            slope[3 * i + j] =
                p->stiffness * share * ((i == j) - (straight ? 0 : wanted[i] * wanted[j] / (size * size)));
}

static void add_patch_matrix(brunt_boundary_rows *r, int32_t patch, const double *u, brunt_block_matrix *h) {
    brunt_boundary_patch *p = &r->patch[patch];
    const int dim = r->unknowns->dim, nodes = (int)(r->first[patch + 1] - r->first[patch]);
    const double(*weight)[9] = (const double(*)[9])r->weight + r->first[patch];
    double moved[3], wanted[3], slope[9];
    brunt_boundary_patch_rows(r, patch, u, moved);
    tentative(r, patch, moved, wanted);
    slopes(r, p, wanted, slope);
    memset(r->dense, 0, (size_t)(nodes * dim) * (size_t)(nodes * dim) * sizeof *r->dense);
    for (int k = 0; k < p->rows; k++)
        for (int l = 0; l < p->rows; l++) {
            if (slope[3 * k + l] == 0) continue;
            for (int e = 0; e < nodes * dim; e++)
                for (int f = 0; f < nodes * dim; f++)
                    r->dense[e * nodes * dim + f] += slope[3 * k + l] / p->size * weight[e / dim][3 * k + e % dim] *
                                                     weight[f / dim][3 * l + f % dim];
        }
    brunt_block_matrix_add(h, r->node + r->first[patch], nodes, r->dense);
}

static void rows_hessian(void *term, const brunt_team *team, const double *u, bool project,
                         struct brunt_block_matrix *h) {
    (void)team; // it has no negative eigenvalues
    brunt_boundary_rows *r = term;
    r->swept = 0;
    for (int32_t p = 0; p < r->patch_count; p++) {
        if (!project) memcpy(r->patch[p].from, r->patch[p].multiplier, sizeof r->patch[p].from);
        add_patch_matrix(r, p, u, h);
    }
}

double brunt_boundary_rows_forces(const brunt_boundary_rows *r, const double *u) {
    double sum = 0, t[3], moved[3], F[3];
    for (int32_t p = 0; p < r->patch_count; p++) {
        brunt_boundary_patch_traction(r, p, u, t, moved);
        for (int64_t k = r->first[p]; k < r->first[p + 1]; k++) {
            brunt_boundary_patch_force(r, p, k, t, F);
            sum += fabs(F[0]) + fabs(F[1]) + fabs(F[2]);
        }
    }
    return sum;
}

double brunt_boundary_rows_effort(const brunt_boundary_rows *r) {
    double sum = 0;
    for (int32_t p = 0; p < r->patch_count; p++)
        for (int k = 0; k < r->patch[p].rows; k++) sum += r->patch[p].stiffness * fabs(r->patch[p].prescribed[k]);
    return sum;
}

// ------------------------------------------------------------------------------------------ multipliers

// The multiplier of rows that the matrix has, as it is to be where C u is `moved`; the greatest change over b h. What
// leaves there, or slips, is not as the matrix has it: those rows follow no more in this iteration.
static double follow(brunt_boundary_patch *p, const double here[3], const double there[3], double cell,
                     double multiplier[3]) {
    double most = 0;
    memcpy(multiplier, p->multiplier, 3 * sizeof *multiplier);
    // With the new multiplier it has to push at u as well: `here` and `there` are t with the old one.
    if (p->leaves && (there[0] >= 0 || there[0] + (here[0] - p->multiplier[0]) >= 0)) p->stiff[0] = false;
    if (p->rubs && size_of(there + 1, p->rows - 1) > p->bound) p->stiff[1] = false;
    for (int k = 0; k < p->rows; k++) {
        if (!p->stiff[k > 0 && p->rubs]) continue;
        most = fmax(most, fabs(there[k] - p->multiplier[k]) / (p->stiffness * cell));
        multiplier[k] = there[k];
    }
    return most;
}

static int never_ends(const brunt_boundary_rows *r, int32_t patch, brunt_error *error) {
    const brunt_boundary_patch *p = &r->patch[patch];
    return brunt_fail(
        error, BRUNT_FAILED,
        "Boundary '%s': the tractions on its pieces find no end: pieces of %g cells are too short for this grid, "
        "or something else holds what they hold.",
        p->surface->boundary->name, p->surface->def.piece);
}

// The multipliers of a patch after the step; `change` over b h.
static double patch_sweep(brunt_boundary_rows *r, int32_t patch, const double *u, const double *step,
                          double multiplier[3]) {
    double here[3], there[3], moved[3], along[3];
    brunt_boundary_patch_rows(r, patch, u, moved);
    brunt_boundary_patch_rows(r, patch, step, along);
    tentative(r, patch, moved, here);
    for (int k = 0; k < 3; k++) moved[k] += along[k];
    tentative(r, patch, moved, there);
    const double change = follow(&r->patch[patch], here, there, r->cell, multiplier);
    memcpy(r->patch[patch].to, multiplier, 3 * sizeof *multiplier);
    return change;
}

static int answer(brunt_boundary_rows *r, const double *u, const double *step, double *g,
                  const brunt_response *response, bool *changed, brunt_error *error) {
    int32_t worst = -1;
    if (r->swept || r->patch_count == 0) return BRUNT_OK;
    if (brunt_boundary_rows_answer(r, u, step, g, response, &worst))
        return worst < 0 ? BRUNT_FAILED : never_ends(r, worst, error);
    r->sweeps++, r->swept++;
    *changed = true;
    return BRUNT_OK;
}

static int rows_sweep(void *term, const double *u, const double *step, double *g, const brunt_response *response,
                      bool *changed, brunt_error *error) {
    brunt_boundary_rows *r = term;
    if (r->exact) return answer(r, u, step, g, response, changed, error);
    int32_t worst = -1;
    double most = EVEN, multiplier[3];
    for (int32_t p = 0; p < r->patch_count; p++) {
        const double change = patch_sweep(r, p, u, step, multiplier);
        if (change > most) most = change, worst = p;
    }
    // What is left of it is in t as it is: no force is lost. Pieces of which little is reached go on slowly.
    const bool soft = worst >= 0 && r->forces && r->patch[worst].leaves;
    if (worst < 0 || r->swept >= (soft ? SOFTER * SLOW_LIMIT : SLOW_LIMIT)) return BRUNT_OK;
    if (r->swept >= SWEEP_LIMIT && most > SLOW && !soft) return never_ends(r, worst, error);
    for (int32_t p = 0; p < r->patch_count; p++) {
        double before[3], after[3], moved[3];
        brunt_boundary_patch_traction(r, p, u, before, moved);
        patch_sweep(r, p, u, step, multiplier);
        memcpy(r->patch[p].multiplier, multiplier, sizeof multiplier);
        brunt_boundary_patch_traction(r, p, u, after, moved);
        for (int k = 0; k < 3; k++) after[k] -= before[k];
        brunt_boundary_patch_add(r, p, after, g);
    }
    r->sweeps++;
    r->swept++;
    *changed = true;
    return BRUNT_OK;
}

// Friction's bound goes with the pressure where tractions are answers.
static void rows_follow(void *term, double share) {
    const brunt_boundary_rows *r = term;
    for (int32_t patch = 0; patch < r->patch_count; patch++) {
        brunt_boundary_patch *p = &r->patch[patch];
        for (int k = 0; k < p->rows; k++) p->multiplier[k] = p->from[k] + share * (p->to[k] - p->from[k]);
        if (r->exact && p->rubs) p->bound = p->surface->def.friction * fmax(0, -p->multiplier[0]);
    }
}

// Whether tractions and bounds at u are not yet those that it was found with.
static bool unsettled(const brunt_boundary_rows *r, const double *u) {
    double most = 0, greatest = 0, bend = 0;
    for (int32_t patch = 0; patch < r->patch_count; patch++) {
        const brunt_boundary_patch *p = &r->patch[patch];
        double t[3], moved[3];
        if (!p->leaves) continue;
        brunt_boundary_patch_traction(r, patch, u, t, moved);
        for (int k = 0; k < p->rows; k++) most = fmax(most, fabs(t[k] - p->multiplier[k]) / (p->stiffness * r->cell));
        // Answers have their bounds by what they are; t has what is left of gaps as well, much of it in short steps.
        const double pressure = r->exact ? -p->multiplier[0] : -t[0];
        const double bound = p->rubs ? p->surface->def.friction * pressure : 0;
        bend = fmax(bend, fabs(bound - p->bound)), greatest = fmax(greatest, bound);
    }
    return most > fmax(SETTLED, r->known * r->dt / r->cell) || bend > SAME_BOUND * greatest;
}

bool brunt_boundary_rows_settle(brunt_boundary_rows *r, const double *u) {
    if (!unsettled(r, u)) return false;
    for (int32_t patch = 0; patch < r->patch_count; patch++) {
        brunt_boundary_patch *p = &r->patch[patch];
        double t[3], moved[3];
        if (!p->leaves) continue;
        brunt_boundary_patch_traction(r, patch, u, t, moved);
        memcpy(p->multiplier, t, (size_t)p->rows * sizeof *t);
        p->bound = p->rubs ? p->surface->def.friction * -t[0] : 0;
    }
    return true;
}

const brunt_term_ops brunt_boundary_rows_ops = {.name = "boundaries",
                                                .energy = rows_energy,
                                                .gradient = rows_gradient,
                                                .stencils = rows_stencils,
                                                .hessian = rows_hessian,
                                                .sweep = rows_sweep,
                                                .follow = rows_follow};
