// What loads that follow a surface add to the stable step of its body.
//
// Gas of volume V at pressure p pushes on node i with (p - p_outside) a_i, a_i = dV/dx_i. Its stiffness is
//   gamma p / V  a a^T - (p - p_outside) d^2V/dx dx.
// The first part has rank one: its eigenvalue with lumped masses is gamma p / V sum_i |a_i|^2 / m_i, exactly; of a
// membrane of density rho, thickness t and area A around it that is gamma p A / (V rho t), whatever the mesh. The
// second part, that of any pressure that follows, has no such sign: with |v^T K_f v| <= k_f sum |v_i|^2 over the nodes
// of face f it is at most max_i 1/m_i sum_f k_f, and
//   edge (2D)       k_f = p                                   since f_i = p/2 J (x_1 - x_0)
//   ring            k_f = p (pi L + sqrt(2 (R_0^2 + R_1^2)))  R_i = pi/3 (r_0 + r_1 + r_i), L its length
//   triangle        k_f = p sqrt(sum of squared edges / 12)   since f_i = p/6 e x g
//   quadrilateral   k_f = p/3 sqrt(10 (|a|^2 + |b|^2) + 2 |c|^2)   of its modes a, b, c (see quad_shares in holds.c)
// by the Frobenius norm of what the (orthogonal) modes do to one another. Prescribed components do not move.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "boundary/curve.h"
#include "boundary/gas.h"
#include "boundary/load_step.h"

// Whether it acts along the normals of the faces as they are.
static bool follows(const brunt_node_set *set) { return set->does->push != NULL; }

int brunt_load_step_make(brunt_node_sets *sets, brunt_error *error) {
    if (BRUNT_NEW(sets->load_rate, sets->fem_count + 1, "meshes with loads", error)) return BRUNT_FAILED;
    for (int k = 0; k < sets->count; k++) {
        double **rate = &sets->load_rate[sets->set[k].fem_index];
        if (!follows(&sets->set[k]) || *rate) continue;
        if (BRUNT_NEW(*rate, sets->set[k].fem->node_count + 1, "rates of loads on nodes", error)) return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

void brunt_load_step_free(brunt_node_sets *sets) {
    for (int k = 0; sets->load_rate && k < sets->fem_count; k++) brunt_free(sets->load_rate[k]);
    brunt_free(sets->load_rate);
}

static double length2(const double a[3]) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

static double apart2(const double a[3], const double b[3]) {
    return length2((const double[3]){a[0] - b[0], a[1] - b[1], a[2] - b[2]});
}

// k_f of a pressure of 1 Pa.
static double face_stiffness(const double (*x)[3], int corners, bool axisymmetric) {
    if (corners == 2 && !axisymmetric) return 1;
    if (corners == 2) {
        const double sum = x[0][0] + x[1][0], first = sum + x[0][0], second = sum + x[1][0];
        return M_PI * sqrt(apart2(x[0], x[1])) + M_PI / 3 * sqrt(2 * (first * first + second * second));
    }
    if (corners == 3) return sqrt((apart2(x[0], x[1]) + apart2(x[1], x[2]) + apart2(x[2], x[0])) / 12);
    double c[3]; // |a|^2 + |b|^2 is an eighth of the squared diagonals
    for (int k = 0; k < 3; k++) c[k] = 0.25 * ((x[0][k] - x[1][k]) + (x[2][k] - x[3][k]));
    return sqrt(1.25 * (apart2(x[0], x[2]) + apart2(x[1], x[3])) + 2 * length2(c)) / 3;
}

// sum_i |a_i|^2 / m_i of the components that are free. `area` has room for the group's nodes and is 0, and so it is
// left.
static double mobility(const brunt_node_set *set) {
    const brunt_fem_body *fem = set->fem;
    double *area = set->area;
    double sum = 0;
    for (int32_t i = 0; i < set->node_count; i++) {
        const int32_t n = set->node[i];
        for (int a = 0; a < 3; a++) {
            const bool free = !fem->held || !(fem->held[n] >> a & 1);
            if (free) sum += area[3 * i + a] * area[3 * i + a] / (double)brunt_fem_node(fem, n)[BRUNT_FEM_MASS];
        }
    }
    memset(area, 0, (size_t)set->node_count * 3 * sizeof *area);
    return sum;
}

// Adds the faces' k_f to the nodes; of gas, gives the eigenvalue of the first part.
static double look_at_faces(const brunt_node_set *set, double time, double *rate) {
    const brunt_fem_body *fem = set->fem;
    const brunt_group_def *def = &set->def;
    brunt_gas gas = {.pressure = 0};
    double push = fabs(def->value[0] * brunt_curve_at(&def->table, time));
    if (set->does->gas) {
        gas = brunt_gas_now(set);
        push = fabs(gas.pressure - def->gas.outside);
    }
    for (int32_t f = 0; f < set->face_count; f++) {
        const int32_t *node = set->face[f];
        const int corners = node[2] < 0 ? 2 : node[3] < 0 ? 3 : 4;
        double x[4][3], shares[4][3];
        for (int c = 0; c < corners; c++)
            for (int a = 0; a < 3; a++) x[c][a] = (double)brunt_fem_node(fem, node[c])[a];
        const double stiffness = push * face_stiffness((const double(*)[3])x, corners, fem->element->axisymmetric);
        for (int c = 0; c < corners; c++) rate[node[c]] += stiffness;
        if (!set->does->gas) continue;
        brunt_face_shares((const double(*)[3])x, corners, shares);
        for (int c = 0; c < corners; c++)
            for (int a = 0; a < 3; a++) set->area[3 * (set->place[node[c]] - 1) + a] += shares[c][a];
    }
    if (!set->does->gas || !(gas.volume > 0)) return 0;
    return def->gas.gamma * gas.pressure / gas.volume * mobility(set);
}

double brunt_load_frequency(const brunt_node_sets *sets, const brunt_bodies *bodies, int index, double time) {
    const brunt_fem_body *body = bodies->all[index].fem;
    const int fem = body ? (int)(body - bodies->fem) : -1;
    if (fem < 0 || !sets->load_rate || !sets->load_rate[fem]) return 0;
    double *rate = sets->load_rate[fem], greatest = 0, gas = 0;
    const uint8_t all = (uint8_t)((1 << body->dim) - 1);
    memset(rate, 0, (size_t)body->node_count * sizeof *rate);
    for (int k = sets->first[fem]; k != BRUNT_NONE; k = sets->set[k].next)
        if (follows(&sets->set[k])) gas += look_at_faces(&sets->set[k], time, rate);
    for (int32_t n = 0; n < body->node_count; n++)
        if (!body->held || (body->held[n] & all) != all)
            greatest = fmax(greatest, rate[n] / (double)brunt_fem_node(body, n)[BRUNT_FEM_MASS]);
    return gas + greatest;
}
