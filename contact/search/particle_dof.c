#include "contact/search/particle_dof.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/quad.h"
#include "contact/planes/boundary.h"
#include "grid/bspline.h"
#include "mpm/particles.h"

enum { IMAGE_LAYERS = 2 };

// A node under the particles of a block by its place from the block's first one, which may be in the next one along an
// axis.
static real *block_node(const brunt_grid *grid, const brunt_block *block, const int at[3]) {
    int corner = 0, in[3] = {0};
    for (int a = 0; a < grid->dim; a++) {
        const int local = at[a], past = local >= grid->side;
        corner = 2 * corner + past, in[a] = local - past * grid->side;
    }
    return brunt_slot_nodes(grid, block->slot[corner]) +
           (size_t)brunt_node_index(grid, in[0], in[1], in[2]) * BRUNT_NODE_REALS;
}

void brunt_particle_nodes_find(const brunt_body *body, int32_t b, int64_t s, const double *arm,
                               brunt_particle_nodes *out) {
    const brunt_grid *grid = &body->grid;
    const brunt_block *block = &grid->blocks[b];
    const int dim = grid->dim, n = grid->order + 1;
    int local[3];
    int32_t base[3] = {0, 0, 0};
    double w[3][4] = {{1}, {1}, {1}}, slope[3][4] = {{0}};
    out->count = 0;
    brunt_node_local(grid, body->particles.bin[s], local);
    real *const *x = brunt_kernel_position(&body->particles);
    for (int a = 0; a < dim; a++) {
        base[a] = block->coord[a] * grid->side + local[a];
        const double u = ((double)x[a][s] - grid->origin[a]) / (double)grid->h - base[a];
        brunt_bspline_weights(grid->order, u, w[a]);
        if (!arm) continue;
        brunt_bspline_levers(grid->order, u, w[a], slope[a]);
        for (int i = 0; i < n; i++) slope[a][i] *= arm[a] / (double)grid->h;
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            for (int l = 0; l < (dim == 3 ? n : 1); l++) {
                const int in[3] = {local[0] + i, local[1] + k, local[2] + l};
                const int32_t at[3] = {base[0] + i, base[1] + k, base[2] + l};
                real *found = block_node(grid, block, in);
                if (!(found[BRUNT_NODE_MASS] > 0)) continue;
                memcpy(out->at[out->count], at, sizeof at);
                out->node[out->count] = found;
                double weight = w[0][i] * w[1][k] * w[2][l];
                if (arm)
                    weight += slope[0][i] * w[1][k] * w[2][l] + w[0][i] * slope[1][k] * w[2][l] +
                              w[0][i] * w[1][k] * slope[2][l];
                out->weight[out->count++] = weight;
            }
}

void brunt_particle_nodes_add(const brunt_particle_nodes *more, double factor, brunt_particle_nodes *sum) {
    const int before = sum->count;
    for (int e = 0; e < more->count; e++) {
        int at = 0;
        while (at < before && sum->node[at] != more->node[e]) at++;
        if (at == before) {
            at = sum->count++;
            sum->node[at] = more->node[e], sum->weight[at] = 0;
            memcpy(sum->at[at], more->at[e], sizeof sum->at[at]);
        }
        sum->weight[at] += factor * more->weight[e];
    }
}

void brunt_particle_nodes_velocity(const brunt_particle_nodes *under, int dim, int which, double v[3]) {
    v[0] = v[1] = v[2] = 0;
    for (int e = 0; e < under->count; e++)
        for (int a = 0; a < dim; a++) v[a] += under->weight[e] * (double)under->node[e][which + a];
}

// The kernel of a particle along one axis: weights of its nodes, and where they are: in which of two blocks, and there.
typedef struct kernel_axis {
    double weight[4];
    int past[4], local[4];
} kernel_axis;

static kernel_axis axis_of(const brunt_body *body, const brunt_block *block, int64_t s, int a, int local) {
    const brunt_grid *grid = &body->grid;
    const double x = (double)brunt_kernel_position(&body->particles)[a][s];
    const double u = (x - grid->origin[a]) / (double)grid->h - (block->coord[a] * grid->side + local);
    kernel_axis axis;
    brunt_bspline_weights(grid->order, u, axis.weight);
    for (int i = 0; i <= grid->order; i++) {
        axis.past[i] = local + i >= grid->side;
        axis.local[i] = local + i - axis.past[i] * grid->side;
    }
    return axis;
}

// Three reals of a node and what is behind them.
BRUNT_INLINE quad three_of(const real *node) {
    return (quad){(double)node[0], (double)node[1], (double)node[2], (double)node[3]};
}

// Nodes in the order of brunt_particle_nodes_find, so that the sum has the same bits; `n`: nodes along an axis.
BRUNT_INLINE quad sum_velocity(const brunt_grid *grid, const brunt_block *block, const kernel_axis axis[3], int n,
                               bool solid, int which) {
    quad sum = {0};
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++) {
            const int side = 2 * axis[0].past[i] + axis[1].past[k];
            const int32_t *slot = block->slot + (solid ? 2 * side : side);
            const double across = axis[0].weight[i] * axis[1].weight[k];
            for (int l = 0; l < (solid ? n : 1); l++) {
                const int index = brunt_node_index(grid, axis[0].local[i], axis[1].local[k], axis[2].local[l]);
                const real *node = brunt_slot_nodes(grid, slot[axis[2].past[l]]) + (size_t)index * BRUNT_NODE_REALS;
                if (!(node[BRUNT_NODE_MASS] > 0)) continue;
                sum += quad_set(across * axis[2].weight[l]) * three_of(node + which);
            }
        }
    return sum;
}

void brunt_particle_velocity(const brunt_body *body, int32_t b, int64_t s, int which, double v[3]) {
    const brunt_grid *grid = &body->grid;
    const brunt_block *block = &grid->blocks[b];
    kernel_axis axis[3] = {[2] = {.weight = {1}}};
    int local[3];
    brunt_node_local(grid, body->particles.bin[s], local);
    for (int a = 0; a < grid->dim; a++) axis[a] = axis_of(body, block, s, a, local[a]);
    const quad sum = grid->dim == 3 && grid->order == 2 ? sum_velocity(grid, block, axis, 3, true, which)
                     : grid->dim == 3                   ? sum_velocity(grid, block, axis, grid->order + 1, true, which)
                                      : sum_velocity(grid, block, axis, grid->order + 1, false, which);
    for (int a = 0; a < 3; a++) v[a] = a < grid->dim ? sum[a] : 0;
}

void brunt_particle_velocity_bounds(const brunt_body *body, const brunt_node_range *of, int which, double low[3],
                                    double high[3]) {
    const brunt_grid *grid = &body->grid;
    const brunt_block *block = &grid->blocks[of->block];
    const int last = grid->dim - 1;
    const int end[3] = {of->end[0] + grid->order, last == 2 ? of->end[1] + grid->order : 1,
                        of->end[last] + grid->order};
    quad least = {0}, most = {0}; // of nodes without mass, which are left out
    for (int x = of->from[0]; x < end[0]; x++)
        for (int y = last == 2 ? of->from[1] : 0; y < end[1]; y++)
            for (int z = of->from[last], part; z < end[2]; z += part) { // as far as they lie together
                const int at[3] = {x, last == 2 ? y : z, last == 2 ? z : 0};
                const int before = z < grid->side && end[2] > grid->side ? grid->side : end[2];
                const real *node = block_node(grid, block, at);
                part = before - z;
                for (int i = 0; i < part; i++, node += BRUNT_NODE_REALS) {
                    if (!(node[BRUNT_NODE_MASS] > 0)) continue;
                    const quad v = three_of(node + which);
                    least = quad_min(v, least), most = quad_max(v, most);
                }
            }
    for (int a = 0; a < 3; a++) low[a] = a < grid->dim ? least[a] : 0, high[a] = a < grid->dim ? most[a] : 0;
}

// ------------------------------------------------------------------------------------------ degrees of freedom

void brunt_particle_dofs_free(brunt_particle_dofs *dofs) {
    brunt_free(dofs->of);
    brunt_free(dofs->dof);
    memset(dofs, 0, sizeof *dofs);
}

int brunt_particle_dofs_begin(const brunt_contact_context *m, const brunt_body *body, brunt_particle_dofs *dofs,
                              brunt_error *error) {
    const size_t count = (size_t)body->grid.slot_count * BRUNT_BLOCK_NODES;
    if (BRUNT_CAPACITY(dofs->of, count, 0, "grid nodes of a body in contact", error)) return BRUNT_FAILED;
    for (int32_t g = 0; g < dofs->dof_count; g++) dofs->of[dofs->dof[g].node] = 0;
    dofs->dof_count = 0;
    dofs->symmetry_count = brunt_symmetry_of(m, body, dofs->symmetry);
    return BRUNT_OK;
}

// Makes the degree-of-freedom node of a grid node and of its images. BRUNT_OK, or BRUNT_FAILED: out of memory.
static int make_dof_node(const brunt_grid *grid, const int32_t at[3], brunt_particle_dofs *dofs,
                         brunt_constraint_set *set, brunt_error *error) {
    int32_t image[BRUNT_MAX_IMAGES][3];
    real sign[BRUNT_MAX_IMAGES][3];
    int images = brunt_symmetry_images(dofs->symmetry, dofs->symmetry_count, at, IMAGE_LAYERS, image, sign);
    unsigned on_plane = 0;
    for (int i = 0; i < images; i++)
        for (int k = 0; k < dofs->symmetry_count; k++)
            if (image[i][dofs->symmetry[k].axis] == dofs->symmetry[k].node) on_plane |= 1u << dofs->symmetry[k].axis;
    int32_t dof_node = brunt_constraints_dof_node(set, error);
    if (dof_node < 0) return BRUNT_FAILED;
    for (int i = 0; i < images; i++) {
        real *node = brunt_grid_node(grid, image[i]);
        if (!node || !(node[BRUNT_NODE_MASS] > 0)) continue;
        int64_t number = (node - grid->nodes) / BRUNT_NODE_REALS;
        if (BRUNT_CAPACITY_MORE(dofs->dof, "grid nodes under contact points", error)) return BRUNT_FAILED;
        brunt_grid_dof *entry = &dofs->dof[dofs->dof_count];
        *entry = (brunt_grid_dof){.node = number, .dof_node = dof_node};
        for (int a = 0; a < 3; a++) entry->sign[a] = (double)sign[i][a];
        entry->on_plane = on_plane;
        dofs->of[number] = ++dofs->dof_count;
        brunt_dof_node *dof = &set->dof_node[dof_node];
        for (int a = 0; a < grid->dim && i == 0; a++) {
            dof->v[a] = (double)node[BRUNT_NODE_VELOCITY + a];
            dof->old[a] = (double)node[BRUNT_NODE_OLD + a];
            dof->inverse[a] =
                sign[0][a] != 0 && !brunt_node_held(grid, number, a) ? 1 / (double)node[BRUNT_NODE_MASS] : 0;
        }
    }
    return BRUNT_OK;
}

// The degree-of-freedom node of node `e` under a particle; NULL: there is none yet.
static const brunt_grid_dof *dof_under(const brunt_grid *grid, const brunt_particle_dofs *dofs,
                                       const brunt_particle_nodes *under, int e) {
    const int32_t place = dofs->of[(under->node[e] - grid->nodes) / BRUNT_NODE_REALS];
    return place ? &dofs->dof[place - 1] : NULL;
}

// What the images of a particle add to what it does to its own velocity along n: with them less without [1/kg]. A node
// on a symmetry plane has half the mass that the whole has there.
static double image_share(const brunt_grid *grid, const brunt_particle_dofs *dofs, const brunt_particle_nodes *under,
                          const brunt_constraint_set *set, int32_t first) {
    const double *n = set->constraint[set->constraint_count - 1].n;
    double sum = 0;
    for (int32_t e = first; e < set->entry_count; e++)
        for (int a = 0; a < grid->dim; a++)
            sum += pow(n[a] * set->entry[e].weight[a], 2) * set->dof_node[set->entry[e].dof_node].inverse[a];
    for (int e = 0; e < under->count; e++) {
        const brunt_grid_dof *g = dof_under(grid, dofs, under, e);
        double mass = (double)under->node[e][BRUNT_NODE_MASS];
        for (int a = 0; a < grid->dim; a++) mass *= g->on_plane >> a & 1 ? 2 : 1;
        for (int a = 0; a < grid->dim; a++)
            sum -= brunt_node_held(grid, g->node, a) ? 0 : pow(n[a] * under->weight[e], 2) / mass;
    }
    return sum;
}

// Of each degree-of-freedom node the weights of all its nodes, turned over as they are.
int brunt_particle_dofs_enter(const brunt_body *body, const brunt_particle_nodes *under, double factor,
                              brunt_particle_dofs *dofs, brunt_constraint_set *set, brunt_error *error) {
    const brunt_grid *grid = &body->grid;
    const int32_t first = set->entry_count;
    for (int e = 0; e < under->count; e++) {
        if (!dof_under(grid, dofs, under, e) && make_dof_node(grid, under->at[e], dofs, set, error))
            return BRUNT_FAILED;
        const brunt_grid_dof *g = dof_under(grid, dofs, under, e);
        int32_t entry = dofs->symmetry_count ? first : set->entry_count; // without images each node has its own
        while (entry < set->entry_count && set->entry[entry].dof_node != g->dof_node) entry++;
        if (entry == set->entry_count && brunt_constraints_entry(set, g->dof_node, 0, error) < 0) return BRUNT_FAILED;
        for (int a = 0; a < 3; a++) set->entry[entry].weight[a] += factor * under->weight[e] * g->sign[a];
    }
    if (dofs->symmetry_count)
        set->constraint[set->constraint_count - 1].image += image_share(grid, dofs, under, set, first);
    return BRUNT_OK;
}

int32_t brunt_particle_dofs_friction_point(const brunt_body *body, const brunt_particle_nodes *at_arm,
                                           const double x[3], const brunt_particle_dofs *dofs,
                                           brunt_constraint_set *set, brunt_error *error) {
    const int32_t first = brunt_constraints_friction_point(set, x, error);
    if (first >= 0) brunt_particle_dofs_rub(body, at_arm, 1, dofs, first, set);
    return first;
}

void brunt_particle_dofs_rub(const brunt_body *body, const brunt_particle_nodes *at_arm, double factor,
                             const brunt_particle_dofs *dofs, int32_t first, brunt_constraint_set *set) {
    int32_t entry = first;
    for (int e = 0; e < at_arm->count; e++) {
        const brunt_grid_dof *g = dof_under(&body->grid, dofs, at_arm, e);
        if (dofs->symmetry_count) entry = first;
        while (set->entry[entry].dof_node != g->dof_node) entry++;
        for (int a = 0; a < 3; a++) set->entry[entry].weight[a] += factor * at_arm->weight[e] * g->sign[a];
    }
}

// ------------------------------------------------------------------------------------------ the way back

static void add_moment(const double x[3], const double P[3], double factor, double linear[3], double angular[3]) {
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        linear[a] += factor * P[a];
        angular[a] += factor * (x[b] * P[c] - x[c] * P[b]);
    }
}

// What the body's own share of the nodes has got, less what the constraints gave it, is the symmetry planes'.
static void account_symmetry(const brunt_contact_context *m, const brunt_particle_dofs *dofs, double linear[3],
                             double angular[3], const brunt_constraint_set *set) {
    const brunt_symmetry_plane *planes = dofs->symmetry;
    for (int32_t p = 0; p < set->constraint_count; p++) {
        const brunt_constraint *constraint = &set->constraint[p];
        const bool carries = constraint->bearer > 0 && constraint->bearer == dofs->tag + 1;
        const double factor = carries ? 1 : -1;
        double normal_impulse[3];
        if ((constraint->tag != dofs->tag && !carries) || !brunt_constraint_acts(constraint)) continue;
        for (int a = 0; a < 3; a++) normal_impulse[a] = constraint->normal_impulse * constraint->n[a];
        add_moment(constraint->x, normal_impulse, factor, linear, angular);
        add_moment(constraint->friction_point ? set->friction_point[constraint->friction_point - 1].x : constraint->x,
                   constraint->friction_impulse, factor, linear, angular);
    }
    static const double none[3] = {0};
    if (planes[0].boundary >= 0) brunt_impulse_account_reaction(&m->boundaries[planes[0].boundary].last, none, angular);
    for (int a = 0; a < 3; a++) {
        double across[3] = {0};
        const int i = brunt_symmetry_bearer(planes, dofs->symmetry_count, a);
        across[a] = linear[a];
        if (i >= 0 && planes[i].boundary >= 0)
            brunt_impulse_account_reaction(&m->boundaries[planes[i].boundary].last, across, none);
    }
}

void brunt_particle_dofs_scatter(const brunt_contact_context *m, brunt_body *body, brunt_particle_dofs *dofs,
                                 const brunt_constraint_set *set) {
    const brunt_grid *grid = &body->grid;
    double linear[3] = {0}, angular[3] = {0};
    for (int32_t g = 0; g < dofs->dof_count; g++) {
        const brunt_grid_dof *entry = &dofs->dof[g];
        real *node = grid->nodes + entry->node * BRUNT_NODE_REALS;
        double P[3] = {0}, x[3];
        dofs->of[entry->node] = 0;
        for (int a = 0; a < grid->dim; a++) {
            const brunt_dof_node *dof_node = &set->dof_node[entry->dof_node];
            double v = entry->sign[a] * dof_node->v[a];
            if (brunt_node_held(grid, entry->node, a)) // the condition takes it again, and records it
                v += entry->sign[a] * dof_node->impulse[a] / (double)node[BRUNT_NODE_MASS];
            P[a] = (double)node[BRUNT_NODE_SPARE] * (v - (double)node[BRUNT_NODE_VELOCITY + a]);
            node[BRUNT_NODE_VELOCITY + a] = (real)v;
        }
        if (!dofs->symmetry_count) continue;
        brunt_node_position(grid, grid->slots[entry->node / BRUNT_BLOCK_NODES].coord,
                            (int)(entry->node % BRUNT_BLOCK_NODES), x);
        add_moment(x, P, 1, linear, angular);
    }
    if (dofs->dof_count && dofs->symmetry_count) account_symmetry(m, dofs, linear, angular, set);
    dofs->dof_count = 0;
}
