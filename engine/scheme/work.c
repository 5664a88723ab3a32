// What the passes of a step move and compute, counted from the arrays they go over and the arithmetic of their kernels.
//
// Bytes: what has to go over the memory's bus when nothing stays in the caches from one pass to the next: a field that
// is read once, one that is written twice, since a line that is written is read first, one that is read and written
// twice. What a block needs again within a pass it finds in the cache. Lines that several blocks share (nodes) count
// once. Padding of blocks to whole vectors is not counted.
//
// Flops: additions and multiplications of the kernels, a multiply-add as two, divisions and roots as one; not counted
// are comparisons, signs, selections, conversions. Vectors over the reals of a node or record count whole, as they are
// executed whole. Names as in the kernels: d dimensions, N = order + 1 nodes an axis, S modes that strain, M modes, H
// hourglass modes. Materials by what brunt_model says of them, without what only flowing points do.
//
// Checked against the floating-point instructions that valgrind counts in a build with one lane: README.md of this
// folder.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/simd.h"
#include "scheme/scheme.h"

static const brunt_amount NOTHING = {0, 0};

static brunt_amount sum_of(brunt_amount a, brunt_amount b) {
    return (brunt_amount){a.bytes + b.bytes, a.flops + b.flops};
}

// ------------------------------------------------------------------------------------------ material points

typedef enum transfer_pass { P2G, MUSL, G2P, G2P_REST, TRANSFER_PASSES } transfer_pass;

// How often each field goes over the bus: scatter, the first stage of the gather in two (linear kernel), all of the
// gather, its second stage.
static const uint8_t trips[][TRANSFER_PASSES] = {
    [BRUNT_FIELD_position] = {1, 1, 2, 2},             // that of kernels, which is read; moved by the gather
    [BRUNT_FIELD_velocity] = {1, 2, 2, 1},             //
    [BRUNT_FIELD_affine] = {1, 0, 2, 2},               //
    [BRUNT_FIELD_deformation_gradient] = {0, 0, 2, 2}, //
    [BRUNT_FIELD_kirchhoff_stress] = {1, 1, 2, 2},     // read by the stages for the power of the stress
    [BRUNT_FIELD_mass] = {1, 0, 1, 1},                 //
    [BRUNT_FIELD_reference_volume] = {1, 1, 1, 1},     //
    [BRUNT_FIELD_undeformed_position] = {1, 0, 1, 0},  // of total-Lagrangian bodies, which have no stages
    [BRUNT_FIELD_grid_velocity] = {0, 2, 0, 1},
};
_Static_assert(BRUNT_COUNT(trips) == BRUNT_BASE_FIELDS && BRUNT_FIELD_grid_velocity == BRUNT_BASE_FIELDS - 1,
               "a row of trips for each field");
enum { STATE_TRIPS = 2 }; // of materials, by what updates them

static double particle_bytes(const brunt_particles *p, transfer_pass pass) {
    const bool total = brunt_total_lagrangian(p);
    double reals = 0;
    for (int f = 0; f < p->field_count; f++) {
        int times = f < BRUNT_BASE_FIELDS ? trips[f][pass] : pass >= G2P ? STATE_TRIPS : 0;
        int components = p->field[f].components;
        if (total && pass == P2G && f == BRUNT_FIELD_position) times = 0;
        if (total && pass == P2G && f == BRUNT_FIELD_deformation_gradient) times = 1;
        if (f == BRUNT_FIELD_kirchhoff_stress && pass == P2G) components = BRUNT_SYMMETRIC(p->dim); // of rings
        reals += times * components;
    }
    return reals * sizeof(real) + (pass == P2G ? sizeof *p->bin : 0);
}

// Blocks, slots and bins for each particle of a body.
typedef struct crowd {
    double blocks, slots, bins;
} crowd;

static crowd crowd_of(const brunt_body *body) {
    const brunt_grid *grid = &body->grid;
    const double particles = fmax(1, (double)body->particles.count);
    int64_t bins = 0; // with particles
    for (int32_t b = 0; b < grid->block_count; b++) {
        const int32_t *start = grid->bin_start + (size_t)b * BRUNT_BIN_STARTS;
        for (int k = 0; k < BRUNT_BLOCK_NODES; k++) bins += start[k + 1] > start[k];
    }
    return (crowd){grid->block_count / particles, grid->slot_count / particles, (double)bins / particles};
}

static double slot_bytes(void) { return BRUNT_BLOCK_NODES * BRUNT_NODE_REALS * sizeof(real); }
static double buffer_bytes(const brunt_grid *grid) { return grid->span_nodes * 8.0 * sizeof(real); }

// Along an axis: u, bspline_weights, bspline_slopes.
static double kernel_flops(int order) {
    static const int weights[] = {0, 1, 9, 18}, slopes[] = {0, 0, 4, 12};
    _Static_assert(BRUNT_COUNT(weights) == BRUNT_CUBIC + 1 && BRUNT_COUNT(slopes) == BRUNT_CUBIC + 1,
                   "a row for each kernel");
    return 3 + weights[order] + slopes[order];
}

static double inverse_flops(int d) { return d == 3 ? 42 : 8; }       // cofactors, determinant, 1 / it, times
static double product_flops(int d) { return d * d * (2.0 * d - 1); } // of two matrices
static double pairs_of(int d) { return d * (d + 1) / 2.0; }          // components of a symmetric one

static double p2g_flops(const brunt_body *body, bool affine, crowd per) {
    const brunt_particles *p = &body->particles;
    const int d = p->dim, order = body->grid.order, N = order + 1;
    const double nodes = pow(N, d);
    double stage = 1 + d + pairs_of(d);                                         // dt V, m v, T
    if (brunt_total_lagrangian(p)) stage += inverse_flops(d) + d * d * 2.0 * d; // T F^-T
    if (brunt_axisymmetric(p)) stage += 2 + 2 * N;                              // the hoop's, along r
    stage += d * (kernel_flops(order) + (affine ? d : 0));                      // m C
    // Columns: offset, mass, m v + m C offset, weighted; slope times T.
    for (int a = 0; a < d; a++)
        stage += N * ((affine ? 2 : 0) + (a == 0) + d * ((affine ? 2 : 0) + (affine || a == 0) + 1));
    // U = wy X + wx Y; in 3D wx wy, and wz U + wxy Z to each node. Sums of a bin go to the buffer when it ends.
    const double rows = N * N, give = d == 3 ? rows * (24 + 1) + nodes * 32 : rows * (24 + 8);
    const double flush = d == 3 && order == 3 ? 0 : per.bins * nodes * 8;
    return stage + give + flush;
}

// What the stress does over a particle (stress_power), and the hoop's (hoop_power).
static double power_flops(const brunt_particles *p) {
    const int d = p->dim;
    return d * d * (2.0 * d + 3) + 2 + (brunt_axisymmetric(p) ? 6 : 0);
}

// From nodes to particles: coefficients of a bin's polynomials, shared by its particles, and their evaluation.
static double interpolation_flops(const brunt_body *body, bool old, bool affine, crowd per) { // both: of the old too
    static const int polynomial[] = {0, 1, 7, 15}, correction[] = {0, 0, 4, 5}, slope[] = {0, 0, 3, 6};
    _Static_assert(BRUNT_COUNT(polynomial) == BRUNT_CUBIC + 1 && BRUNT_COUNT(slope) == BRUNT_CUBIC + 1,
                   "a row for each kernel");
    const int d = body->particles.dim, order = body->grid.order, N = order + 1, side = body->grid.side,
              span = side + order;
    const int width = old ? 8 : 4;
    const double sweep = d == 3 ? span * side * (span + side * N) : span * side; // of a block, along all axes but x
    const double shared = width * polynomial[order] * (per.blocks * sweep + per.bins * (d == 3 ? N * N : N));
    // Horner: along z for all powers of x and y, then y, then x; the same with one power less where it is the highest.
    double each = (d == 3 ? N * N * 2 * order : 0) + 2 * order * N + 2 * order * order + 2 * order + 2 * slope[order];
    if (d == 3) each += order * (2 * order * N + 2 * order) + slope[order];
    if (old && affine) each += each + 3 * d; // all of the old velocity, its C alone
    each += d;                               // gradient: / h
    if (affine && order > 1) each += 3 * d;  // C: correction, / h
    if (old && !affine) each += d == 3 ? N * (N * (2 * order + 2) + 2) : N * (2 * N + 2);
    return shared + 3 * d + (affine ? correction[order] * d : 0) + d * each;
}

static double update_flops(const brunt_body *body, brunt_transfer transfer, bool keeps, transfer_pass pass) {
    const brunt_particles *p = &body->particles;
    const int d = p->dim;
    const bool total = brunt_total_lagrangian(p), axisymmetric = brunt_axisymmetric(p);
    double flops = pass != G2P_REST && transfer == BRUNT_FLIP ? 5 * d : 0; // flip (v + change) + (1 - flip) v_grid
    if (pass == MUSL) return flops + (axisymmetric ? 1 : 0) + power_flops(p);
    flops += 4 * d + (axisymmetric ? 4 : 0) + 3; // x, speed; hoop; kinetic energy
    flops +=
        total ? d * d * 2 + 2 * inverse_flops(d) + product_flops(d) + d * d * (2.0 * d + 1) // F, F^-1, L, its stretch
              : d * d * (2.0 * d + 1);                                                      // F += dt L F
    if (transfer == BRUNT_APIC)                                                             // C - dt sym(C C), |C|^2
        flops += d * (2.0 * d + 2) + (pairs_of(d) - d) * (4 * d + 2) + d * d * 3 + 2 * d +
                 (body->grid.order == 1 ? 7 * d : 0);
    if (keeps) // V + a (v - V_old); its change, off; off_C, C; spin of each pair of axes, and where it goes
        flops += 3 * d + 2 * d + 3 * d * d + (pairs_of(d) - d) * (4 * d + 6) +
                 (total ? inverse_flops(d) + d * d * 2.0 * d : d * d);
    return flops + power_flops(p) * (pass == G2P_REST ? 2 : 1);
}

static double model_flops(const brunt_material *material, int dim) {
    double flops = 0;
    for (int k = 0; k < BRUNT_COMPONENTS; k++)
        if (material->model[k]) flops += material->model[k]->flops[material->membrane ? 2 : dim - 2];
    return flops;
}

static brunt_amount p2g_work(const brunt_settings *settings, const brunt_body *body) {
    const crowd per = crowd_of(body);
    return (brunt_amount){particle_bytes(&body->particles, P2G) + 2 * per.blocks * buffer_bytes(&body->grid),
                          p2g_flops(body, settings->transfer == BRUNT_APIC, per)};
}

// With nodes as velocities where `pass` takes them from the grid.
static brunt_amount g2p_work(const brunt_settings *settings, const brunt_body *body, transfer_pass pass) {
    const crowd per = crowd_of(body);
    const bool keeps = settings->apic > 0, old = keeps || (settings->transfer == BRUNT_FLIP && pass != G2P_REST);
    const bool affine = settings->transfer == BRUNT_APIC && pass != MUSL;
    brunt_amount work = {particle_bytes(&body->particles, pass) + per.slots * slot_bytes(),
                         interpolation_flops(body, old, affine, per) +
                             update_flops(body, settings->transfer, keeps, pass)};
    if (pass != MUSL) work.flops += model_flops(&body->material, body->particles.point_dim);
    return work;
}

// Each step looks where particles are; where they have changed their bins, arrays move: all, or those of the blocks.
static brunt_amount sort_work(const brunt_body *body) {
    const brunt_particles *p = &body->particles;
    const double scalars = p->scalar_count, groups = ceil(scalars / BRUNT_SORT_GROUP);
    const double id = sizeof *p->id, key = sizeof *p->key, order = sizeof *p->order, bin = sizeof *p->bin;
    const double look = p->dim * sizeof(real) + id + 2 * key;
    double move = (id + key) + (id + key + 2 * order);   // count_blocks, fill_blocks
    move += 2 * order + key + 2 * id + 2 * bin;          // sort_blocks
    move += scalars * 3 * sizeof(real) + groups * order; // move_scalars: read, written elsewhere
    move += order + 3 * id + bin + 2 * key;              // move_ids, set_keys
    const double in_place = 2 * (key + order) + bin + key + 2 * (id + scalars * sizeof(real));
    const double sorts = fmax(1, (double)p->sorts), share = (double)p->moves / sorts,
                 blocks = (double)p->moved / (sorts * fmax(1, (double)p->count));
    return (brunt_amount){look + share * move + blocks * in_place, 3 * p->dim};
}

// ------------------------------------------------------------------------------------------ nodes of grids

static brunt_amount grid_sum_work(const brunt_settings *settings, const brunt_body *body) {
    const brunt_grid *grid = &body->grid;
    const double nodes = fmax(1, (double)grid->slot_count * BRUNT_BLOCK_NODES);
    const double sources = (double)grid->block_count * grid->span_nodes / nodes; // of a node: blocks that reach it
    return (brunt_amount){BRUNT_NODE_REALS * sizeof(real) * (2 + sources),
                          8 * sources + (settings->has_gravity ? 6 : 0)};
}

// 1 / m and the part of it that is the body's own; of each component v, work, v + impulse / m.
static brunt_amount grid_update_work(void) { return (brunt_amount){2 * BRUNT_NODE_REALS * sizeof(real), 2 + 3 * 8}; }

// Squares of both velocities and their sum by mass, of each component; both energies; with gravity the place and m x.
static brunt_amount ledger_work(const brunt_settings *settings) {
    return (brunt_amount){BRUNT_NODE_REALS * sizeof(real), 3 * 7 + 4 + (settings->has_gravity ? 13 : 0)};
}

// ------------------------------------------------------------------------------------------ meshes

// Records of four reals count whole. Force, momentum, v + dt f / m + dt g.
static brunt_amount kick_work(const brunt_fem_body *body) {
    const double partials = body->node_count ? (double)body->partial_count / body->node_count : 0;
    brunt_amount work = {2 * BRUNT_FEM_NODE_REALS * sizeof(real) + sizeof *body->partial_first +
                             partials * (sizeof *body->partial_of + 4 * sizeof(real)),
                         4 * partials + 8 + 12 + 1};
    if (body->load) work = sum_of(work, (brunt_amount){4 * sizeof(real), 8 + 4});
    return work;
}

// x + dt v, m v, and the sums: m x 8, m v 4, m v^2 4 + 8, x x m v 16, m 1, |v| |x| 4 + 4 + 7; with loads 28 more.
static brunt_amount drift_work(const brunt_fem_body *body) {
    brunt_amount work = {2 * BRUNT_FEM_NODE_REALS * sizeof(real), 8 + 4 + 56};
    if (body->load) work = sum_of(work, (brunt_amount){4 * sizeof(real), 28});
    return work;
}

static double hourglass_flops(const brunt_element_flops *c, int d, int H, bool viscous) {
    const double S = c->strain_modes, carry = 2.0 * d * d * H + d * d; // couple, times 1 / V
    if (!viscous)                                                      // k; of each mode bend, q, carried, Q, energy
        return S * 2 * d - 1 + 4 + H * (d * (2.0 * d - 1) + 3 * d + 2 * d + 2) + carry;
    // size, c; modes of v; L (I + dt L)^-1; of each mode h, middle, rate, work, Q, energy
    return (d == 3 ? 20 : 1) + 2 + c->combine + 2.0 * d * d + inverse_flops(d) + product_flops(d) +
           H * (d * (2.0 * d + 2 * d + 4 + 1) + 3 * d + 3) + carry;
}

// The bound of omega^2.
static double frequency_flops(const brunt_element_flops *c, int d, int H, bool viscous) {
    const double S = c->strain_modes;
    double flops = (H ? 0 : (S - 1) * d) + 2 + pairs_of(d) * (2 * S - 1 + (H ? 1 : 2) + 1); // sum, 1 / V^2, S0
    flops += product_flops(d) + pairs_of(d) * (2.0 * d - 1);                                // F^-T S0 F^-1
    flops += d - 1 + (d == 3 ? 5 : 1) + 2 + 3 * d + 3 + 5; // trace, off, mean, deviator, greatest, strain
    return flops + (!H ? 0 : viscous ? (d == 3 ? 20 : 2) + 16 : d - 1 + 2 + 9);
}

static double kernel_element_flops(const brunt_fem_body *body, const brunt_element_flops *c) {
    const int d = body->dim, n = body->traits->nodes, H = body->element->hourglass_modes;
    const bool viscous = H && body->hourglass == BRUNT_HOURGLASS_VISCOUS;
    const double S = c->strain_modes;
    double flops = 2 * c->combine + c->slope + 1;             // modes of X and u, V and G, 1 / V
    flops += d * d * 2 * S + d;                               // H, F
    flops += 2 * d * d + inverse_flops(d) + product_flops(d); // L
    if (H) flops += hourglass_flops(c, d, H, viscous);
    flops += inverse_flops(d) + (H ? d * d : 0) + product_flops(d); // F^-1, tau, T
    flops += S * d * (2.0 * d - 1) + H * d + c->spread + 4 * n;     // modes' forces, those of nodes, into records
    return flops + frequency_flops(c, d, H, viscous);
}

static brunt_amount element_work(const brunt_fem_body *body) {
    const double elements = fmax(1, body->element_count), nodes = body->node_count / elements;
    const double copies = body->partial_count / elements; // nodes of blocks
    const brunt_element_flops *c = &body->element->flops;
    const bool viscous = body->element->hourglass_modes && body->hourglass == BRUNT_HOURGLASS_VISCOUS;
    double reals = 0;
    for (int f = 0; f < body->field_count; f++) {
        const bool read_only = f == BRUNT_ELEMENT_reference_volume || f == BRUNT_ELEMENT_density_scale;
        reals += (read_only ? 1 : 2) * body->field[f].components;
    }
    double bytes = reals * sizeof(real) + body->traits->nodes * sizeof *body->local;
    bytes += nodes * (BRUNT_FEM_NODE_REALS + 4) * sizeof(real);          // record and start
    bytes += copies * (sizeof *body->block_node + 2 * 4 * sizeof(real)); // number, partial force
    double flops = c->whole[0] > 0 ? c->whole[viscous] : kernel_element_flops(body, c);
    flops += copies * (4 + 8); // u = x - X, work of the forces
    return (brunt_amount){bytes, flops + model_flops(&body->material, body->point_dim)};
}

// ------------------------------------------------------------------------------------------ passes

brunt_amount brunt_work_sort(const brunt_world *world, brunt_body_ref body) {
    (void)world;
    return body.mpm ? sort_work(body.mpm) : NOTHING;
}

brunt_amount brunt_work_p2g(const brunt_world *world, brunt_body_ref body) {
    return body.mpm ? p2g_work(&world->settings, body.mpm) : NOTHING;
}

brunt_amount brunt_work_grid(const brunt_world *world, brunt_body_ref body) {
    return body.mpm ? grid_sum_work(&world->settings, body.mpm) : NOTHING;
}

brunt_amount brunt_work_update(const brunt_world *world, brunt_body_ref body) {
    (void)world;
    return body.mpm ? grid_update_work() : NOTHING;
}

brunt_amount brunt_work_ledger(const brunt_world *world, brunt_body_ref body) {
    return body.mpm ? ledger_work(&world->settings) : NOTHING;
}

// Once more to the grid and back, of the nodes that there are for a particle.
brunt_amount brunt_work_musl_velocity(const brunt_world *world, brunt_body_ref body) {
    if (!body.mpm) return NOTHING;
    const brunt_amount nodes = sum_of(grid_sum_work(&world->settings, body.mpm), grid_update_work());
    const double share = crowd_of(body.mpm).slots * BRUNT_BLOCK_NODES;
    const brunt_amount points =
        sum_of(g2p_work(&world->settings, body.mpm, MUSL), p2g_work(&world->settings, body.mpm));
    return sum_of(points, (brunt_amount){share * nodes.bytes, share * nodes.flops});
}

brunt_amount brunt_work_g2p(const brunt_world *world, brunt_body_ref body) {
    return body.mpm ? g2p_work(&world->settings, body.mpm, world->transfers.musl_velocity ? G2P_REST : G2P) : NOTHING;
}

brunt_amount brunt_work_kick(const brunt_world *world, brunt_body_ref body) {
    (void)world;
    return body.fem ? kick_work(body.fem) : NOTHING;
}

brunt_amount brunt_work_drift(const brunt_world *world, brunt_body_ref body) {
    (void)world;
    return body.fem ? drift_work(body.fem) : NOTHING;
}

brunt_amount brunt_work_elements(const brunt_world *world, brunt_body_ref body) {
    (void)world;
    return body.fem ? element_work(body.fem) : NOTHING;
}

// How many units of a pass a body has.
static double units_of(brunt_body_ref body, const char *unit) {
    const bool nodes = strcmp(unit, "node") == 0;
    if (body.mpm)
        return nodes ? (double)body.mpm->grid.slot_count * BRUNT_BLOCK_NODES : (double)body.mpm->particles.count;
    return nodes ? body.fem->node_count : body.fem->element_count;
}

static void add_work(const brunt_world *world, const brunt_pass_row *row, brunt_body_ref body, brunt_amount *all,
                     double *units) {
    const brunt_amount each = row->work(world, body);
    const double count = units_of(body, row->unit);
    if (!(each.bytes > 0)) return;
    *units += count;
    *all = sum_of(*all, (brunt_amount){count * each.bytes, count * each.flops});
}

brunt_amount brunt_pass_work(const brunt_world *world, const brunt_pass_row *row) {
    brunt_amount all = NOTHING;
    double units = 0;
    for (int i = 0; row->work && i < world->bodies.mpm_count; i++)
        add_work(world, row, (brunt_body_ref){.mpm = &world->bodies.mpm[i]}, &all, &units);
    for (int k = 0; row->work && k < world->bodies.fem_count; k++)
        add_work(world, row, (brunt_body_ref){.fem = &world->bodies.fem[k]}, &all, &units);
    return units > 0 ? (brunt_amount){all.bytes / units, all.flops / units} : NOTHING;
}
