// Membranes in implicit steps. Everything of an element (membrane.inc) follows from three vectors that are linear in
// its nodes' displacements, y = (F_1, F_2, q), y_m = y_m at the start + sum_a s_ma u_a with s_ma = b_a1, b_a2, gamma_a:
//   E(y) = V W(Cbar) + k/2 (|q|^2 - s^2) + k_w/2 (s - w0)^2,
//   Cbar = F_a . F_b + (|q|^2 - w0^2) M_ab,   s = q . n,   n = g N,   N = F_1 x F_2,   g = 1 / |N| or as crushed,
// so that gradient and Hessian by y, 9 and 9 x 9 (6 of triangles), are all there is. With S and A = 4 d2W/dCdC
//   dE = V S_ab F_b . dF_a + V (S:M) q . dq + k q . dq + t ds,                     t = k_w (s - w0) - k s
//   d2E = V (S_ab dF_a . dF_b + (S:M) |dq|^2 + e A e) + k |dq|^2 + (k_w - k) ds^2 + t d2s,
//   e = sym(F . dF) + q . dq M,   ds = n . dq + w . dN,   w = g q + 2 g' (q . N) N,
//   d2s = 2 dq . dn + 2 g' (2 (N . dN)(q . dN) + (q . N) |dN|^2) + 4 g'' (q . N)(N . dN)^2 + 2 w . (dF_1 x dF_2),
//   dn = g dN + 2 g' (N . dN) N, with g' and g'' by |N|^2.
// W is infinite where Cbar is not positive; a membrane may otherwise turn as it likes, so that steps have no limit.
#include "fem/crushed.h"
#include "fem/layout.h"
#include "fem/potential_parts.h"
#include "linear/project.h"

enum { Y = 9, HESSIAN = 45 };

typedef struct fem_membrane {
    double share[3][4];                     // s_ma
    double frame[2][3], start[3];           // [-] e_1, e_2; [m] q at the start, w0 e_3
    double M[3], spring, warp_spring, warp; // 11, 22, 12 [1/m^2]; k, k_w [N/m]; w0 [m]
} fem_membrane;

// --------------------------------------------------------------------------------- making

static double inner(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void vector_product(const double *a, const double *b, double *out) {
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void warping_of(const brunt_fem_potential *p, int64_t slot, const double (*x)[3], const double e[3][3],
                       fem_membrane *membrane) {
    brunt_fem_body *body = p->body;
    const int8_t *mode = body->element->hourglass[0];
    double carried[3] = {0}, square = 0;
    for (int a = 0; a < p->nodes; a++)
        for (int i = 0; i < 3; i++) carried[i] += mode[a] * (x[a][i] - x[0][i]);
    membrane->warp = inner(carried, e[2]);
    for (int a = 0; a < p->nodes; a++) {
        const double b[2] = {membrane->share[0][a], membrane->share[1][a]};
        membrane->share[2][a] = mode[a] - inner(carried, e[0]) * b[0] - inner(carried, e[1]) * b[1];
        for (int c = 0; c < 3; c++) membrane->M[c] += b[c == 1] * b[c > 0] / 12;
        square += b[0] * b[0] + b[1] * b[1];
    }
    for (int i = 0; i < 3; i++) membrane->start[i] = membrane->warp * e[2][i];
    const double c0 = (double)body->material.wave_speed, modulus = (double)body->material.density * c0 * c0;
    const double volume = (double)brunt_element_scalars(body, BRUNT_ELEMENT_reference_volume)[0][slot];
    const double thickness = (double)body->thickness, area = volume / thickness;
    membrane->spring = (double)body->hourglass_coefficient * modulus * volume * square / 8;
    membrane->warp_spring = membrane->spring * fmin(thickness * thickness / area, 1);
}

static void membrane_of(const brunt_fem_potential *p, int64_t slot, fem_membrane *membrane) {
    double x[BRUNT_ELEMENT_NODES][3], e[3][3];
    real b[BRUNT_ELEMENT_NODES][3];
    *membrane = (fem_membrane){.warp = 0};
    brunt_fem_corners(p->body, (int32_t)slot, x);
    brunt_membrane_frame(p->nodes, (const double(*)[3])x, e);
    p->body->element->gradient((const double(*)[3])x, b);
    memcpy(membrane->frame, e, sizeof membrane->frame);
    for (int a = 0; a < p->nodes; a++)
        for (int m = 0; m < 2; m++)
            for (int i = 0; i < 3; i++) membrane->share[m][a] += (double)b[a][i] * e[m][i];
    if (p->nodes == 4) warping_of(p, slot, (const double(*)[3])x, (const double(*)[3])e, membrane);
}

static int make(brunt_fem_potential *p, brunt_error *error) {
    const brunt_fem_body *body = p->body;
    const size_t stride = ((size_t)body->slots + 7) / 8 * 8 + 8;
    p->slab_bytes = HESSIAN * stride * sizeof(real) + (size_t)body->slots * sizeof *p->membrane;
    if (BRUNT_NEW(p->slab, HESSIAN * stride, "numbers of elements of a membrane", error) ||
        BRUNT_NEW(p->membrane, body->slots, "elements of a membrane", error))
        return BRUNT_FAILED;
    for (int k = 0; k < HESSIAN; k++) p->tangent[k] = p->slab + (size_t)k * stride;
    for (int32_t b = 0; b < body->block_count; b++)
        for (int32_t s = body->block[b].first; s < body->block[b].first + body->block[b].count; s++)
            membrane_of(p, s, &p->membrane[s]);
    return BRUNT_OK;
}

// --------------------------------------------------------------------------------- a tile of elements

typedef struct membrane_tile {
    real U[3][FEM_TILE], density[FEM_TILE], S[3][FEM_TILE], tangent[6][FEM_TILE]; // 11, 22, 12
    double y[FEM_TILE][Y];
} __attribute__((aligned(64))) membrane_tile;

// y, and the mean metric less 1, which keeps its digits when it is small.
static void deform(const brunt_fem_potential *p, int64_t slot, double y[Y], double c[3]) {
    const fem_membrane *membrane = &p->membrane[slot];
    const int32_t *node = p->body->element_node + slot * p->nodes;
    double H[3][3] = {{0}}, more = 0;
    for (int a = 0; a < p->nodes; a++)
        for (int m = 0; m < 3; m++)
            for (int i = 0; i < 3; i++) H[m][i] += membrane->share[m][a] * p->displacement[(int64_t)node[a] * 3 + i];
    for (int i = 0; i < 3; i++) {
        for (int m = 0; m < 2; m++) y[3 * m + i] = membrane->frame[m][i] + H[m][i];
        y[6 + i] = membrane->start[i] + H[2][i];
        more += H[2][i] * (y[6 + i] + membrane->start[i]);
    }
    for (int m = 0; m < 2; m++) c[m] = inner(H[m], H[m]) + 2 * inner(membrane->frame[m], H[m]);
    c[2] = inner(y, H[1]) + inner(membrane->frame[1], H[0]);
    for (int k = 0; k < 3; k++) c[k] += more * membrane->M[k];
}

// U = sqrt(I + c) of element s of the tile, not a number where I + c is not positive.
static void stretch(const double c[3], membrane_tile *tile, int32_t s) {
    const double C0 = 1 + c[0], C1 = 1 + c[1], det = C0 * C1 - c[2] * c[2], J = det > 0 && C0 > 0 ? sqrt(det) : NAN;
    const double trace = 1 / sqrt(C0 + C1 + 2 * J);
    tile->U[0][s] = (real)((C0 + J) * trace), tile->U[1][s] = (real)((C1 + J) * trace);
    tile->U[2][s] = (real)(c[2] * trace);
}

// What the material says of `count` elements from `slot` on, `there` of which are no padding.
static void respond(const fem_call *call, int64_t slot, int32_t there, int32_t count, membrane_tile *tile) {
    const brunt_fem_potential *p = call->p;
    brunt_trial_points trial[BRUNT_COMPONENTS] = {{.count = count, .dim = 2, .dt = p->dt}};
    for (int32_t s = 0; s < count; s++) {
        double c[3];
        tile->U[0][s] = tile->U[1][s] = 1, tile->U[2][s] = 0;
        if (s >= there) continue;
        deform(p, slot + s, tile->y[s], c);
        stretch(c, tile, s);
    }
    static const int place[4] = {0, 2, 2, 1};
    brunt_trial_points *strength = &trial[BRUNT_STRENGTH];
    *strength = (brunt_trial_points){.count = count, .dim = 2, .dt = p->dt};
    for (int c = 0; c < 4; c++) strength->F[c] = tile->U[place[c]];
    if (call->wanted == FEM_ENERGY) strength->density = tile->density;
    for (int c = 0; c < 3 && call->wanted != FEM_ENERGY; c++) strength->stress[c] = tile->S[c];
    for (int c = 0; c < 6 && call->wanted == FEM_TANGENT; c++) strength->tangent[c] = tile->tangent[c];
    brunt_material_respond(&p->body->material, trial);
}

// --------------------------------------------------------------------------------- springs of the warping mode

typedef struct warping {
    double N[3], n[3], w[3], g[3], along, s; // F_1 x F_2; g N; g, g', g'' of |N|^2; q . N, q . n [m]
    double by_y[Y];                          // ds
} warping;

// Half of what |q|^2 - s^2 is, with its digits where q is along n.
static double flat_part(const warping *at, const double *q) {
    double flat = at->s * at->s * (1 - inner(at->n, at->n));
    for (int i = 0; i < 3; i++) flat += (q[i] - at->s * at->n[i]) * (q[i] - at->s * at->n[i]);
    return 0.5 * flat;
}

static warping warping_at(const double y[Y]) {
    warping at;
    const double *q = y + 6, crushed = BRUNT_CRUSHED * BRUNT_CRUSHED;
    vector_product(y, y + 3, at.N);
    const double area = inner(at.N, at.N);
    if (area >= crushed)
        at.g[0] = 1 / sqrt(area), at.g[1] = -0.5 * at.g[0] / area, at.g[2] = 0.75 * at.g[0] / (area * area);
    else
        at.g[0] = (3 - area / crushed) / (2 * BRUNT_CRUSHED), at.g[1] = -0.5 / (BRUNT_CRUSHED * crushed), at.g[2] = 0;
    at.along = inner(q, at.N), at.s = at.g[0] * at.along;
    for (int i = 0; i < 3; i++) {
        at.n[i] = at.by_y[6 + i] = at.g[0] * at.N[i];
        at.w[i] = at.g[0] * q[i] + 2 * at.g[1] * at.along * at.N[i];
    }
    vector_product(y + 3, at.w, at.by_y), vector_product(at.w, y, at.by_y + 3);
    return at;
}

// dN by y: N = F_1 x F_2.
static void normal_slope(const double y[Y], double D[3][6]) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 6; k++) D[i][k] = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        D[i][j] = y[3 + k], D[i][k] = -y[3 + j], D[i][3 + k] = y[j], D[i][3 + j] = -y[k];
    }
}

// Adds `t` d2s.
static void add_warping_curvature(const double y[Y], const warping *at, double t, double h[Y][Y]) {
    const double *q = y + 6, *N = at->N;
    double D[3][6], K[3][3], KD[3][6] = {{0}}, PD[3][6] = {{0}};
    normal_slope(y, D);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            K[i][j] = 2 * at->g[1] * (N[i] * q[j] + q[i] * N[j] + (i == j ? at->along : 0)) +
                      4 * at->g[2] * at->along * N[i] * N[j];
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 6; c++)
            for (int j = 0; j < 3; j++)
                KD[i][c] += K[i][j] * D[j][c], PD[i][c] += ((i == j) * at->g[0] + 2 * at->g[1] * N[i] * N[j]) * D[j][c];
    for (int r = 0; r < 6; r++)
        for (int c = 0; c < 6; c++)
            for (int i = 0; i < 3; i++) h[r][c] += t * D[i][r] * KD[i][c];
    for (int i = 0; i < 3; i++) {
        for (int c = 0; c < 6; c++) h[6 + i][c] += t * PD[i][c], h[c][6 + i] += t * PD[i][c];
        const int j = (i + 1) % 3, k = (i + 2) % 3; // w . (dF_1 x dF_2)
        h[j][3 + k] += t * at->w[i], h[3 + k][j] += t * at->w[i];
        h[k][3 + j] -= t * at->w[i], h[3 + j][k] -= t * at->w[i];
    }
}

// --------------------------------------------------------------------------------- an element

static double volume_of(const brunt_fem_potential *p, int64_t slot) {
    return (double)brunt_element_scalars(p->body, BRUNT_ELEMENT_reference_volume)[0][slot];
}

static void add_energy(const brunt_fem_potential *p, int64_t slot, const membrane_tile *tile, int32_t s,
                       brunt_energy_sum *sum) {
    const fem_membrane *membrane = &p->membrane[slot];
    const double stored = volume_of(p, slot) * (double)tile->density[s], *q = tile->y[s] + 6;
    sum->value += stored, sum->magnitude += fabs(stored);
    if (p->nodes == 3 || !(stored < INFINITY)) return;
    const warping at = warping_at(tile->y[s]);
    const double rise = at.s - membrane->warp,
                 held = membrane->spring * flat_part(&at, q) + 0.5 * membrane->warp_spring * rise * rise;
    sum->value += held, sum->magnitude += held;
}

static void gradient_of(const brunt_fem_potential *p, int64_t slot, const membrane_tile *tile, int32_t s, double g[Y]) {
    const fem_membrane *membrane = &p->membrane[slot];
    const double volume = volume_of(p, slot), *y = tile->y[s];
    const double S[3] = {volume * (double)tile->S[0][s], volume * (double)tile->S[1][s],
                         volume * (double)tile->S[2][s]};
    const double across = S[0] * membrane->M[0] + S[1] * membrane->M[1] + 2 * S[2] * membrane->M[2];
    for (int i = 0; i < 3; i++) {
        g[i] = S[0] * y[i] + S[2] * y[3 + i], g[3 + i] = S[2] * y[i] + S[1] * y[3 + i];
        g[6 + i] = (across + membrane->spring) * y[6 + i];
    }
    if (p->nodes == 3) return;
    const warping at = warping_at(y);
    const double t = membrane->warp_spring * (at.s - membrane->warp) - membrane->spring * at.s;
    for (int k = 0; k < Y; k++) g[k] += t * at.by_y[k];
}

// Of the metric: e by y, for 11, 22, and twice 12.
static void strain_slope(const fem_membrane *membrane, const double y[Y], double e[3][Y]) {
    for (int i = 0; i < 3; i++) {
        e[0][i] = y[i], e[1][i] = 0, e[2][i] = y[3 + i];
        e[0][3 + i] = 0, e[1][3 + i] = y[3 + i], e[2][3 + i] = y[i];
        for (int m = 0; m < 3; m++) e[m][6 + i] = (m == 2 ? 2 : 1) * membrane->M[m] * y[6 + i];
    }
}

static void hessian_of(const brunt_fem_potential *p, int64_t slot, const membrane_tile *tile, int32_t s,
                       double h[Y][Y]) {
    static const int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}, of[2][2] = {{0, 2}, {2, 1}};
    const fem_membrane *membrane = &p->membrane[slot];
    const double volume = volume_of(p, slot), *y = tile->y[s];
    double e[3][Y], S[3], across = 0;
    strain_slope(membrane, y, e);
    for (int m = 0; m < 3; m++) {
        S[m] = volume * (double)tile->S[m][s];
        across += (m == 2 ? 2 : 1) * S[m] * membrane->M[m];
    }
    for (int r = 0; r < Y; r++)
        for (int c = 0; c < Y; c++) {
            double sum = 0;
            for (int m = 0; m < 3; m++)
                for (int n = 0; n < 3; n++) sum += e[m][r] * (double)tile->tangent[place[m][n]][s] * e[n][c];
            h[r][c] = volume * sum;
            if (r % 3 != c % 3) continue;
            if (r < 6 && c < 6) h[r][c] += S[of[r / 3][c / 3]];
            if (r >= 6 && c >= 6) h[r][c] += across + membrane->spring;
        }
    if (p->nodes == 3) return;
    const warping at = warping_at(y);
    for (int r = 0; r < Y; r++)
        for (int c = 0; c < Y; c++) h[r][c] += (membrane->warp_spring - membrane->spring) * at.by_y[r] * at.by_y[c];
    add_warping_curvature(y, &at, membrane->warp_spring * (at.s - membrane->warp) - membrane->spring * at.s, h);
}

// --------------------------------------------------------------------------------- the kind

static void add_force(const brunt_fem_potential *p, int64_t slot, const double g[Y], real *partial) {
    const uint16_t *local = p->body->local + slot * p->nodes;
    for (int a = 0; a < p->nodes; a++)
        for (int i = 0; i < 3; i++) {
            double force = 0;
            for (int m = 0; m < 3; m++) force += p->membrane[slot].share[m][a] * g[3 * m + i];
            partial[(size_t)local[a] * 4 + (size_t)i] += (real)force;
        }
}

static void keep_hessian(const fem_call *call, int64_t slot, const membrane_tile *tile, int32_t s) {
    const brunt_fem_potential *p = call->p;
    double h[Y][Y];
    hessian_of(p, slot, tile, s, h);
    if (call->project) brunt_project_positive(Y, h[0]);
    for (int r = 0, k = 0; r < Y; r++)
        for (int c = r; c < Y; c++, k++) p->tangent[k][slot] = (real)h[r][c];
}

static void evaluate(const fem_call *call, int32_t b) {
    brunt_fem_potential *p = call->p;
    const brunt_fem_block *block = &p->body->block[b];
    real *partial = p->force + (size_t)block->node_first * 4;
    if (call->wanted == FEM_GRADIENT) memset(partial, 0, (size_t)block->node_count * 4 * sizeof *partial);
    brunt_energy_sum sum = {0};
    membrane_tile tile;
    for (int32_t first = 0; first < block->count; first += FEM_TILE) {
        const int32_t there = block->count - first < FEM_TILE ? block->count - first : FEM_TILE;
        const int64_t slot = (int64_t)block->first + first;
        respond(call, slot, there, (there + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES, &tile);
        for (int32_t s = 0; s < there; s++) {
            double g[Y];
            if (call->wanted == FEM_ENERGY) add_energy(p, slot + s, &tile, s, &sum);
            if (call->wanted == FEM_TANGENT) keep_hessian(call, slot + s, &tile, s);
            if (call->wanted != FEM_GRADIENT) continue;
            gradient_of(p, slot + s, &tile, s, g);
            add_force(p, slot + s, g, partial);
        }
    }
    p->energy[b] = sum;
}

static void hessian(const brunt_fem_potential *p, int64_t slot, double *dense) {
    const fem_membrane *membrane = &p->membrane[slot];
    const int size = 3 * p->nodes;
    double h[Y][Y];
    for (int r = 0, k = 0; r < Y; r++)
        for (int c = r; c < Y; c++, k++) h[r][c] = h[c][r] = (double)p->tangent[k][slot];
    for (int A = 0; A < p->nodes; A++)
        for (int B = 0; B < p->nodes; B++)
            for (int ij = 0; ij < 9; ij++) {
                const int i = ij / 3, j = ij % 3;
                double sum = 0;
                for (int m = 0; m < 3; m++)
                    for (int n = 0; n < 3; n++)
                        sum += membrane->share[m][A] * h[3 * m + i][3 * n + j] * membrane->share[n][B];
                dense[(3 * A + i) * size + 3 * B + j] = sum;
            }
}

static void product(const fem_call *call, int32_t b) {
    const brunt_fem_potential *p = call->p;
    const brunt_fem_block *block = &p->body->block[b];
    real *partial = p->force + (size_t)block->node_first * 4;
    memset(partial, 0, (size_t)block->node_count * 4 * sizeof *partial);
    for (int64_t slot = block->first; slot < (int64_t)block->first + block->count; slot++) {
        const int32_t *node = p->body->element_node + slot * p->nodes;
        double x[Y] = {0}, g[Y] = {0};
        for (int a = 0; a < p->nodes; a++)
            for (int k = 0; k < Y; k++)
                x[k] += p->membrane[slot].share[k / 3][a] * call->way[(int64_t)node[a] * 3 + k % 3];
        for (int r = 0, k = 0; r < Y; r++, k++) {
            g[r] += (double)p->tangent[k][slot] * x[r];
            for (int c = r + 1; c < Y; c++) {
                const double h = (double)p->tangent[++k][slot];
                g[r] += h * x[c], g[c] += h * x[r];
            }
        }
        add_force(p, slot, g, partial);
    }
}

// The element's kernel does it all: its laws are elastic, and look at nothing that a step did.
static void commit(brunt_fem_potential *p, int32_t b, brunt_fem_workspace *work) {
    brunt_fem_report *report = &p->body->report[b];
    p->body->element->forces(p->body, b, p->dt, work, report);
    report->stress_work = 0; // as solids have it, of which implicit steps ask their potentials
}

const fem_potential_kind brunt_fem_membrane_potential = {
    .make = make, .evaluate = evaluate, .hessian = hessian, .product = product, .commit = commit};
