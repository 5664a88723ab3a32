// Bodies of small strain that have turned, looked for once, at the end.
//
// Stress and strain of such a body are those of where its nodes were: its forces f have no moment about there, and
// about where they have come to, x, one that nothing holds: sum of x x f, which is 0 of a body that may turn. On one
// that is pressed by N from two sides, R from its middle, and has turned by t, it is 2 N R t: as if what presses went
// by the middle at R t. Friction along its rim, of moment R T, makes up for it, so that forces along surfaces are off
// by t of those across them.
#include <math.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "scheme/implicit.h"

// Of the moments that its forces might have, and [rad]: as if a coefficient of friction were off by one in its second
// digit. Of what has turned alone: forces that are rounding have moments of any share.
static const double MUCH = 1e-2;
static const double DEGREES = 57.29577951308232;

// Membranes are seen from a frame that turns with them.
static bool is_small_strain(const brunt_body_ref *body) {
    const brunt_model *model = (body->fem ? &body->fem->material : &body->mpm->material)->model[BRUNT_STRENGTH];
    return model && model->small_strain && !(body->fem && body->fem->thickness > 0);
}

// Of forces on nodes [begin, end), about their mean: the length of their sum of moments, beside what it would be if
// none went by the middle.
typedef struct moments {
    double sum[3], all;
} moments;

static void place_of(const struct brunt_implicit *m, int32_t n, const double middle[3], double x[3]) {
    const int64_t k = (int64_t)n * m->unknowns.dim;
    for (int a = 0; a < 3; a++)
        x[a] = a < m->unknowns.dim ? m->unknowns.position[k + a] + m->field.u[k + a] - middle[a] : 0;
}

static void add_moments(const struct brunt_implicit *m, const double *force, int32_t begin, int32_t end, moments *sum) {
    const int dim = m->unknowns.dim;
    double middle[3] = {0}, x[3], zero[3] = {0};
    for (int32_t n = begin; n < end; n++) {
        place_of(m, n, zero, x);
        for (int a = 0; a < dim; a++) middle[a] += x[a] / (end - begin);
    }
    for (int32_t n = begin; n < end; n++) {
        double f[3] = {0}, length = 0, arm = 0;
        place_of(m, n, middle, x);
        for (int a = 0; a < dim; a++) {
            f[a] = force[(int64_t)n * dim + a];
            length += f[a] * f[a], arm += x[a] * x[a];
        }
        sum->all += sqrt(length * arm);
        for (int a = 0; a < 3; a++) {
            const int i = (a + 1) % 3, j = (a + 2) % 3;
            sum->sum[a] += x[i] * f[j] - x[j] * f[i];
        }
    }
}

static double share_of(const struct brunt_implicit *m, const double *force, int32_t begin, int32_t end) {
    moments sum = {.all = 0};
    if (end > begin) add_moments(m, force, begin, end, &sum);
    const double length = sqrt(sum.sum[0] * sum.sum[0] + sum.sum[1] * sum.sum[1] + sum.sum[2] * sum.sum[2]);
    return sum.all > 0 ? length / sum.all : 0;
}

int brunt_implicit_take_turns(struct brunt_implicit *m, const double *force, brunt_error *error) {
    const brunt_world *world = m->world;
    const brunt_unknowns *u = &m->unknowns;
    bool any = false;
    if (world->clock.time + m->dt < world->settings.end * (1 - 1e-9)) return BRUNT_OK;
    for (int b = 0; b < world->bodies.count; b++) any = any || is_small_strain(&world->bodies.all[b]);
    if (!any) return BRUNT_OK;
    brunt_free(m->turned);
    if (BRUNT_NEW(m->turned, world->bodies.count, "moments of bodies", error)) return BRUNT_FAILED;
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const brunt_fem_body *fem = &world->bodies.fem[k];
        if (is_small_strain(&world->bodies.all[fem->index]))
            m->turned[fem->index] = share_of(m, force, u->base[k], u->base[k] + fem->node_count);
    }
    for (int i = 0; i < world->bodies.mpm_count; i++)
        if (is_small_strain(&world->bodies.all[world->bodies.mpm[i].index]))
            m->turned[world->bodies.mpm[i].index] = share_of(m, force, u->grid_base[i], u->grid_base[i + 1]);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ by how much

// Sum of places now times places at the start, both from their means.
static void places_of(const brunt_fem_body *fem, double S[3][3]) {
    double now[3] = {0}, start[3] = {0};
    for (int32_t n = 0; n < fem->node_count; n++)
        for (int a = 0; a < fem->dim; a++) {
            now[a] += (double)brunt_fem_node(fem, n)[BRUNT_FEM_X + a] / fem->node_count;
            start[a] += (double)fem->start[4 * (size_t)n + (size_t)a] / fem->node_count;
        }
    for (int32_t n = 0; n < fem->node_count; n++)
        for (int a = 0; a < fem->dim; a++)
            for (int b = 0; b < fem->dim; b++)
                S[a][b] += ((double)brunt_fem_node(fem, n)[BRUNT_FEM_X + a] - now[a]) *
                           ((double)fem->start[4 * (size_t)n + (size_t)b] - start[b]);
}

static void gradients_of(brunt_particles *p, double S[3][3]) {
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    const real *mass = brunt_field(p, BRUNT_FIELD_mass)[0];
    for (int64_t s = 0; s < p->count; s++)
        for (int a = 0; p->id[s] >= 0 && a < p->dim; a++)
            for (int b = 0; b < p->dim; b++) S[a][b] += (double)mass[s] * (double)F[a * p->point_dim + b][s];
}

// [rad] about the axis of its skew part; of a plane rotation, or of one that small strain takes for it, exact.
static double angle_of(double S[3][3]) {
    double axis[3], length = 0, along = 0;
    for (int a = 0; a < 3; a++) {
        axis[a] = S[(a + 2) % 3][(a + 1) % 3] - S[(a + 1) % 3][(a + 2) % 3];
        length += axis[a] * axis[a];
    }
    length = sqrt(length);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3 && length > 0; b++) along += axis[a] * S[a][b] * axis[b] / (length * length);
    return atan2(length, S[0][0] + S[1][1] + S[2][2] - along);
}

static double turn_of(const brunt_body_ref *body) {
    double S[3][3] = {{0}};
    if (body->fem)
        places_of(body->fem, S);
    else
        gradients_of(&body->mpm->particles, S);
    return angle_of(S);
}

void brunt_implicit_tell_turns(brunt_world *world) {
    struct brunt_implicit *m = world->plan.implicit;
    int count = 0, worst = -1;
    double most = 0;
    if (!m->turned) return;
    for (int b = 0; b < world->bodies.count; b++) {
        if (!(m->turned[b] > MUCH)) continue;
        const double turn = turn_of(&world->bodies.all[b]);
        count += turn > MUCH;
        if (turn > fmax(most, MUCH)) most = turn, worst = b;
    }
    if (worst >= 0)
        brunt_warn(
            &world->messages,
            "bodies.%s has turned by %.3g degrees, the most of %d bod%s of small strain whose forces do not turn "
            "along: those along its surface are off by %.2g of those across. neo-hookean turns",
            brunt_body_name(world, worst), DEGREES * most, count, count > 1 ? "ies" : "y", m->turned[worst]);
    brunt_free(m->turned), m->turned = NULL;
}
