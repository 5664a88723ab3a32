// Which nodes of a mesh and of the grid of a body have to do with each other.
#include "contact/methods/surface_on_grid_parts.h"

static const double CUT = 1e-6; // cells: how near a symmetry plane what it cuts is

static brunt_pair *pair_of(const brunt_contact_context *m, const brunt_body *body, const brunt_fem_body *fem) {
    int32_t pair = brunt_pair_of(m->pair_map, body->index, fem->index);
    return pair >= 0 && m->pairs[pair].meets & BRUNT_MEET_ON_GRID ? &m->pairs[pair] : NULL;
}

static int32_t floor_divide(int32_t a, int32_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

bool brunt_surface_on_grid_node(const brunt_grid *grid, const int32_t at[3], slot_cache *cached, int32_t *slot,
                                int *node) {
    int32_t coord[3] = {0, 0, 0}, local[3] = {0, 0, 0};
    for (int a = 0; a < grid->dim; a++) {
        coord[a] = floor_divide(at[a], grid->side);
        local[a] = at[a] - coord[a] * grid->side;
    }
    if (!cached->is || memcmp(cached->coord, coord, sizeof coord)) {
        memcpy(cached->coord, coord, sizeof coord);
        cached->slot = brunt_grid_slot(grid, brunt_key(coord)), cached->is = true;
    }
    *slot = cached->slot;
    *node = brunt_node_index(grid, local[0], local[1], local[2]);
    return *slot >= 0;
}

// Bounds of the points whose kernel reaches nodes of the grid [m].
static void bound_grid(const brunt_grid *grid, double low[3], double high[3]) {
    const double width = 0.5 * (grid->order + 1) * (double)grid->h;
    for (int a = 0; a < 3; a++) low[a] = a < grid->dim ? INFINITY : -INFINITY, high[a] = -low[a];
    for (int32_t s = 0; s < grid->slot_count; s++)
        for (int a = 0; a < grid->dim; a++) {
            double first = grid->origin[a] + (double)grid->h * grid->slots[s].coord[a] * grid->side,
                   last = first + (double)grid->h * (grid->side - 1);
            low[a] = fmin(low[a], first - width), high[a] = fmax(high[a], last + width);
        }
}

void brunt_surface_on_grid_near(const brunt_contact_context *m) {
    const brunt_body *mpm = m->mpm;
    brunt_contact_surface *s = m->surface;
    for (int b = 0; b < m->mpm_count; b++) {
        double low[3], high[3];
        bound_grid(&mpm[b].grid, low, high);
        for (int k = 0; k < s->fem_count; k++)
            if (!s->active[k] && pair_of(m, &mpm[b], s->fem[k]))
                s->active[k] = overlap(low, high, s->low[k], s->high[k]);
    }
}

// A surface node, of mesh `fem`, at the grid of body `mpm`.
typedef struct grid_place {
    int mpm, fem;
    int32_t node;
    brunt_pair *pair;
} grid_place;

// The contact of a mesh with a body at a node that has mass, made when it is first asked for. BRUNT_NONE: out of
// memory.
static int32_t find_contact(job *j, const grid_place *of, int32_t slot, int node, brunt_error *error) {
    brunt_surface_on_grid *w = j->w;
    const int b = of->mpm, k = of->fem;
    const int32_t number = slot * BRUNT_BLOCK_NODES + node;
    int32_t last = -1, leader = -1;
    for (int32_t c = w->place[number] - 1; c >= 0; c = w->contact[c].next) {
        if (w->contact[c].fem == k) return c;
        leader = leader < 0 ? c : leader, last = c;
    }
    real *at = j->m->mpm[b].grid.nodes + (size_t)number * BRUNT_NODE_REALS;
    if (GROW(w, contact, "contacts at grid nodes", error)) return BRUNT_NONE;
    const int32_t made = w->contact_count++;
    contact *c = &w->contact[made];
    *c = (contact){.mpm = b,
                   .fem = k,
                   .slot = slot,
                   .node = node,
                   .number = number,
                   .leader = leader < 0 ? made : leader,
                   .next = -1,
                   .across = {1, 1, 1},
                   .pair = of->pair,
                   .at = at};
    for (int a = 0; a < 3; a++) {
        const bool held = a < j->m->mpm[b].grid.dim && brunt_node_held(&j->m->mpm[b].grid, number, a);
        c->inverse_s[a] = held ? 0 : 1 / (double)at[BRUNT_NODE_MASS];
        c->held |= held;
    }
    brunt_node_position(&j->m->mpm[b].grid, j->m->mpm[b].grid.slots[slot].coord, node, c->x);
    for (int a = 0; a < j->m->mpm[b].grid.dim; a++) c->v[a] = (double)at[BRUNT_NODE_VELOCITY + a];
    if (last >= 0)
        w->contact[last].next = made;
    else
        w->place[number] = made + 1;
    return made;
}

static int add_link(job *j, const grid_place *of, const int32_t at[3], double weight, const real *sign,
                    slot_cache *cached, brunt_error *error) {
    brunt_surface_on_grid *w = j->w;
    int32_t slot;
    int node;
    if (!brunt_surface_on_grid_node(&j->m->mpm[of->mpm].grid, at, cached, &slot, &node)) return BRUNT_OK;
    const size_t number = (size_t)slot * BRUNT_BLOCK_NODES + (size_t)node;
    if (!(j->m->mpm[of->mpm].grid.nodes[number * BRUNT_NODE_REALS + BRUNT_NODE_MASS] > 0)) return BRUNT_OK;
    const int32_t c = find_contact(j, of, slot, node, error);
    if (c < 0) return BRUNT_FAILED;
    if (GROW(w, link, "links of surface nodes with grid nodes", error)) return BRUNT_FAILED;
    link *l = &w->link[w->link_count++];
    *l = (link){.surface = of->node, .contact = c, .weight = weight, .sign = {1, 1, 1}, .own = !sign};
    for (int a = 0; a < 3 && sign; a++) l->sign[a] = (int8_t)sign[a];
    w->contact[c].count++;
    return BRUNT_OK;
}

// Links of surface node n with the nodes of body b, and, near symmetry planes, with their images: the same as the
// particles' shares get from brunt_symmetry_fold.
static int add_item(job *j, const grid_place *of, brunt_error *error) {
    brunt_surface_on_grid *w = j->w;
    const brunt_grid *grid = &j->m->mpm[of->mpm].grid;
    const double *x = j->m->surface->x[of->node];
    const int dim = grid->dim, nodes = grid->order + 1;
    int32_t base[3] = {0, 0, 0};
    double weight[3][4] = {{1}, {1}, {1}};
    for (int a = 0; a < dim; a++) {
        double u = (x[a] - grid->origin[a]) / (double)grid->h;
        base[a] = (int32_t)floor(u - 0.5 * (grid->order - 1));
        brunt_bspline_weights(grid->order, u - base[a], weight[a]);
    }
    slot_cache cached = {.is = false}, cached_image = {.is = false};
    const int32_t first = w->link_count;
    for (int p = 0; p < nodes; p++)
        for (int q = 0; q < nodes; q++)
            for (int r = 0; r < (dim == 3 ? nodes : 1); r++) {
                const double share = weight[0][p] * weight[1][q] * weight[2][r];
                const int32_t at[3] = {base[0] + p, base[1] + q, base[2] + r};
                if (!(share > 0)) continue;
                if (!j->symmetry_count) {
                    if (add_link(j, of, at, share, NULL, &cached, error)) return BRUNT_FAILED;
                    continue;
                }
                int32_t image[BRUNT_MAX_IMAGES][3];
                real sign[BRUNT_MAX_IMAGES][3];
                int images = brunt_symmetry_images(j->symmetry, j->symmetry_count, at, 2, image, sign);
                for (int i = 0; i < images; i++) {
                    const int32_t before = w->link_count;
                    if (add_link(j, of, image[i], share, sign[i], i ? &cached_image : &cached, error))
                        return BRUNT_FAILED;
                    if (w->link_count == before) continue;
                    w->link[before].own = i == 0;
                    for (int a = 0; a < 3; a++)
                        if (sign[i][a] == 0) w->contact[w->link[before].contact].across[a] = 0;
                }
            }
    if (w->link_count == first) return BRUNT_OK;
    if (GROW(w, item, "surface nodes at a grid", error)) return BRUNT_FAILED;
    w->item[w->item_count++] = (item){of->node, first, w->link_count - first};
    return BRUNT_OK;
}

// Whether a surface node is on what symmetry planes have cut open, and on no other surface.
static bool on_cut(const job *j, const brunt_grid *grid, int32_t n) {
    const brunt_contact_surface *s = j->m->surface;
    double normal[3] = {s->normal[n][0], s->normal[n][1], s->normal[n][2]};
    bool cut = false;
    for (int m = 0; m < j->symmetry_count; m++) {
        const int axis = j->symmetry[m].axis;
        const double plane = grid->origin[axis] + (double)grid->h * j->symmetry[m].node;
        if (fabs(s->x[n][axis] - plane) < CUT * (double)grid->h) normal[axis] = 0, cut = true;
    }
    return cut && dot(normal, normal) < CUT * CUT;
}

static bool inside(const double x[3], const double low[3], const double high[3]) {
    for (int a = 0; a < 3; a++)
        if (x[a] < low[a] || x[a] > high[a]) return false;
    return true;
}

// Contacts, links and items of body b.
int brunt_surface_on_grid_link(job *j, int b, brunt_error *error) {
    brunt_surface_on_grid *w = j->w;
    const brunt_contact_surface *s = j->m->surface;
    const brunt_grid *grid = &j->m->mpm[b].grid;
    range *r = &w->range[w->range_count++];
    *r = (range){w->contact_count, w->contact_count, w->item_count, w->item_count};
    double low[3], high[3];
    bool any = false;
    j->symmetry_count = brunt_symmetry_of(j->m, &j->m->mpm[b], j->symmetry);
    bound_grid(grid, low, high);
    for (int k = 0; k < s->fem_count; k++) {
        brunt_pair *pair = pair_of(j->m, &j->m->mpm[b], s->fem[k]);
        if (!pair || !s->active[k] || !overlap(low, high, s->low[k], s->high[k])) continue;
        if (!any) {
            const size_t nodes = (size_t)grid->slot_count * BRUNT_BLOCK_NODES;
            if (RESERVE(w, place, nodes + 1, "nodes of a grid", error)) return BRUNT_FAILED;
            memset(w->place, 0, nodes * sizeof *w->place);
            any = true;
        }
        for (int32_t n = s->node_range[k]; n < s->node_end[k]; n++) {
            if (s->face_first[n + 1] == s->face_first[n])
                continue; // a detached node: there is no surface to press with
            const grid_place of = {b, k, n, pair};
            if (inside(s->x[n], low, high) && !on_cut(j, grid, n) && add_item(j, &of, error)) return BRUNT_FAILED;
        }
    }
    r->contact_end = w->contact_count, r->item_end = w->item_count;
    return BRUNT_OK;
}

// Links by contact, in their order.
int brunt_surface_on_grid_sort(brunt_surface_on_grid *w, brunt_error *error) {
    if (RESERVE(w, by_contact, w->link_count + 1, "links of surface nodes with grid nodes", error) ||
        RESERVE(w, changed, w->contact_count + 1, "contacts at grid nodes", error))
        return BRUNT_FAILED;
    int32_t first = 0;
    for (int32_t c = 0; c < w->contact_count; c++) {
        w->contact[c].first = first;
        first += w->contact[c].count;
        w->contact[c].count = 0;
    }
    for (int32_t l = 0; l < w->link_count; l++) {
        contact *c = &w->contact[w->link[l].contact];
        w->by_contact[c->first + c->count++] = l;
    }
    return BRUNT_OK;
}
