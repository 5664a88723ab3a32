#include "contact/methods/surface_on_grid.h"

#include <math.h>
#include <string.h>

#include "contact/distance/point_facet.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "mpm/transfer.h"

enum { GRAIN = 16, MOST_FACES = 128, MORE_SWEEPS = 4 };
static const double SIGHT = 1.5;  // spacings: how far a particle's reach may go; it starts with 0.87 at most
static const double BAND = 0.5;   // spacings: particles up to so much farther than the nearest have a say in the normal
static const double MARGIN = 2;   // times the way of a step that it looks further
static const double CUT = 1e-6;   // cells: how near a mirror plane what it cuts is
static const double BESIDE = 0.5; // of the distance: a particle less than this above a sheet is beside its border

// What a skin node gives to a node of the grid, itself or, by a mirror, its image.
typedef struct link {
    int32_t skin, contact;
    double weight;
    int8_t sign[3]; // of each component of its velocity
    bool own;       // not of an image
} link;

// A skin node at the grid of a body: its links.
typedef struct item {
    int32_t skin, first, count;
} item;

// A mesh and a body at a grid node.
typedef struct contact {
    int32_t mpm, fem, slot, node, number; // number: of the node in its grid
    int32_t leader, next;                 // contacts at one grid node: the first of them has its velocity; -1
    int32_t first, count;                 // links, in by_contact
    int8_t across[3];                     // 0 where a mirror plane through the node lets nothing move
    brunt_pair *pair;
    real *at;
    double x[3], mass, area; // of the mesh: [kg], [m^2]
    double v[3], inverse_s;  // of the body (the leader's counts)
    double inverse[3];       // [1/kg] of the mesh, by component
    double relax;            // share of what is asked for that a sweep gives
    double n[3], gap, target;
    double push, drag[3], given[3];
} contact;

// Contacts and items of one body of material points.
typedef struct range {
    int32_t contact, contact_end, item, item_end;
} range;

// A face near a block of particles.
typedef struct near_face {
    int32_t block, face;
} near_face;

// What a particle knows of the nearest facet. Of a sheet, its front is meant.
typedef struct touch {
    double height, radius, n[3]; // [m] in front of it, [m] reach along n; unit, to where it is in front
    bool near, beside;           // beside: of the border of a sheet, with n from there
} touch;

struct brunt_grid_surfaces {
    near_face *near;
    size_t near_capacity;
    int32_t near_count;
    int32_t *block_first, *block_face; // faces near block b: block_face[block_first[b] .. block_first[b + 1])
    size_t block_first_capacity, block_face_capacity;
    touch *touch; // of each particle slot
    size_t touch_capacity;
    double range_of_sight;
    range *range;
    link *link;
    item *item;
    contact *contact;
    int32_t *by_contact, *place;
    uint8_t *met; // of each skin node, how many bodies
    size_t met_capacity;
    double *changed;
    size_t range_capacity, link_capacity, item_capacity, contact_capacity, by_contact_capacity, place_capacity,
        changed_capacity;
    int32_t range_count, link_count, item_count, contact_count;
};

typedef struct job {
    const brunt_contact_context *m;
    brunt_grid_surfaces *w;
    brunt_body *mpm;
    const brunt_symmetry_plane *mirrors;
    int mirror_count;
    const range *range;       // contacts and items that are worked on ...
    int range_mpm, range_fem; // ... of these two
} job;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static bool make_unit(double n[3]) {
    double size = sqrt(dot(n, n));
    if (!(size > 0) || !isfinite(size)) return false;
    for (int a = 0; a < 3; a++) n[a] /= size;
    return true;
}

// Room for one more, keeping what is there.
#define GROW(w, what)                                                                                                  \
    brunt_reserve((void **)&(w)->what, &(w)->what##_capacity, ((size_t)(w)->what##_count + 1) * sizeof *(w)->what,     \
                  (size_t)(w)->what##_count * sizeof *(w)->what)
#define RESERVE(w, what, count)                                                                                        \
    brunt_reserve((void **)&(w)->what, &(w)->what##_capacity, (size_t)(count) * sizeof *(w)->what, 0)

void brunt_grid_surfaces_free(brunt_grid_surfaces *w) {
    if (!w) return;
    void *owned[] = {w->range, w->link,        w->item,       w->contact, w->by_contact, w->place, w->changed,
                     w->near,  w->block_first, w->block_face, w->touch,   w->met,        w};
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
}

size_t brunt_grid_surfaces_bytes(const brunt_grid_surfaces *w) {
    return w ? w->range_capacity + w->link_capacity + w->item_capacity + w->contact_capacity + w->by_contact_capacity +
                   w->place_capacity + w->changed_capacity + w->near_capacity + w->block_first_capacity +
                   w->block_face_capacity + w->touch_capacity + w->met_capacity
             : 0;
}

// ------------------------------------------------------------------------------------------ who meets whom

static brunt_pair *pair_of(const brunt_contact_context *m, const brunt_body *body, const brunt_fem_body *fem) {
    int32_t pair = m->pair_of[body->index * m->body_count + fem->index];
    return pair >= 0 && m->pairs[pair].method == BRUNT_CONTACT_MULTI_VELOCITY ? &m->pairs[pair] : NULL;
}

// Bounds of the points whose kernel reaches nodes of the grid [m].
static void bound_grid(const brunt_grid *grid, double low[3], double high[3]) {
    const double reach = 0.5 * (grid->order + 1) * (double)grid->h;
    for (int a = 0; a < 3; a++) low[a] = a < grid->dim ? INFINITY : -INFINITY, high[a] = -low[a];
    for (int32_t s = 0; s < grid->slot_count; s++)
        for (int a = 0; a < grid->dim; a++) {
            double first = grid->origin[a] + (double)grid->h * grid->slots[s].coord[a] * grid->side,
                   last = first + (double)grid->h * (grid->side - 1);
            low[a] = fmin(low[a], first - reach), high[a] = fmax(high[a], last + reach);
        }
}

static bool overlap(const double low[3], const double high[3], const double low2[3], const double high2[3]) {
    for (int a = 0; a < 3; a++)
        if (low[a] > high2[a] || low2[a] > high[a]) return false;
    return true;
}

void brunt_grid_surfaces_near(const brunt_contact_context *m, const brunt_body *mpm, int mpm_count) {
    brunt_contact_surface *s = m->skin;
    for (int b = 0; b < mpm_count; b++) {
        double low[3], high[3];
        bound_grid(&mpm[b].grid, low, high);
        for (int k = 0; k < s->fem_count; k++)
            if (!s->active[k] && pair_of(m, &mpm[b], s->fem[k]))
                s->active[k] = overlap(low, high, s->low[k], s->high[k]);
    }
}

static int32_t floor_divide(int32_t a, int32_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

// Slot and node with global coordinates `at`; false when it is not alive. `seen` remembers the last slot.
typedef struct seen_slot {
    int32_t coord[3], slot;
    bool is;
} seen_slot;
static bool find_place(const brunt_grid *grid, const int32_t at[3], seen_slot *seen, int32_t *slot, int *node) {
    int32_t coord[3] = {0, 0, 0}, local[3] = {0, 0, 0};
    for (int a = 0; a < grid->dim; a++) {
        coord[a] = floor_divide(at[a], grid->side);
        local[a] = at[a] - coord[a] * grid->side;
    }
    if (!seen->is || memcmp(seen->coord, coord, sizeof coord)) {
        memcpy(seen->coord, coord, sizeof coord);
        seen->slot = brunt_grid_slot(grid, brunt_key(coord)), seen->is = true;
    }
    *slot = seen->slot;
    *node = brunt_node_index(grid, local[0], local[1], local[2]);
    return *slot >= 0;
}

// The contact of mesh k with body b at a node, made when it is first asked for; -1: the body has no mass there, -2: out
// of memory.
static int32_t find_contact(job *j, int b, int k, brunt_pair *pair, int32_t slot, int node) {
    brunt_grid_surfaces *w = j->w;
    const int32_t number = slot * BRUNT_BLOCK_NODES + node;
    int32_t last = -1, leader = -1;
    for (int32_t c = w->place[number] - 1; c >= 0; c = w->contact[c].next) {
        if (w->contact[c].fem == k) return c;
        leader = leader < 0 ? c : leader, last = c;
    }
    real *at = j->mpm[b].grid.nodes + (size_t)number * BRUNT_NODE_REALS;
    if (!(at[BRUNT_NODE_MASS] > 0)) return -1;
    if (GROW(w, contact)) return -2;
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
                   .pair = pair,
                   .at = at,
                   .inverse_s = 1 / (double)at[BRUNT_NODE_MASS]};
    brunt_node_position(&j->mpm[b].grid, j->mpm[b].grid.slots[slot].coord, node, c->x);
    for (int a = 0; a < j->mpm[b].grid.dim; a++) c->v[a] = (double)at[BRUNT_NODE_VELOCITY + a];
    if (last >= 0)
        w->contact[last].next = made;
    else
        w->place[number] = made + 1;
    return made;
}

static int add_link(job *j, int b, int k, brunt_pair *pair, int32_t n, const int32_t at[3], double weight,
                    const real *sign, seen_slot *seen) {
    brunt_grid_surfaces *w = j->w;
    int32_t slot;
    int node;
    if (!find_place(&j->mpm[b].grid, at, seen, &slot, &node)) return 0;
    int32_t c = find_contact(j, b, k, pair, slot, node);
    if (c < 0) return c == -1 ? 0 : -1;
    if (GROW(w, link)) return -1;
    link *l = &w->link[w->link_count++];
    *l = (link){.skin = n, .contact = c, .weight = weight, .sign = {1, 1, 1}, .own = !sign};
    for (int a = 0; a < 3 && sign; a++) l->sign[a] = (int8_t)sign[a];
    w->contact[c].count++;
    return 0;
}

// Links of skin node n with the nodes of body b, and, near mirrors, with their images: the same as the particles'
// shares get from brunt_symmetry_fold.
static int add_item(job *j, int b, int k, brunt_pair *pair, int32_t n) {
    brunt_grid_surfaces *w = j->w;
    const brunt_grid *grid = &j->mpm[b].grid;
    const double *x = j->m->skin->x[n];
    const int dim = grid->dim, nodes = grid->order + 1;
    int32_t base[3] = {0, 0, 0};
    double weight[3][4] = {{1}, {1}, {1}};
    for (int a = 0; a < dim; a++) {
        double u = (x[a] - grid->origin[a]) / (double)grid->h;
        base[a] = (int32_t)floor(u - 0.5 * (grid->order - 1));
        brunt_kernel_weights(grid->order, u - base[a], weight[a]);
    }
    seen_slot seen = {.is = false}, seen_image = {.is = false};
    const int32_t first = w->link_count;
    for (int p = 0; p < nodes; p++)
        for (int q = 0; q < nodes; q++)
            for (int r = 0; r < (dim == 3 ? nodes : 1); r++) {
                const double share = weight[0][p] * weight[1][q] * weight[2][r];
                const int32_t at[3] = {base[0] + p, base[1] + q, base[2] + r};
                if (!(share > 0)) continue;
                if (!j->mirror_count) {
                    if (add_link(j, b, k, pair, n, at, share, NULL, &seen)) return -1;
                    continue;
                }
                int32_t image[BRUNT_MAX_IMAGES][3];
                real sign[BRUNT_MAX_IMAGES][3];
                int images = brunt_symmetry_images(j->mirrors, j->mirror_count, at, 2, image, sign);
                for (int i = 0; i < images; i++) {
                    const int32_t before = w->link_count;
                    if (add_link(j, b, k, pair, n, image[i], share, sign[i], i ? &seen_image : &seen)) return -1;
                    if (w->link_count == before) continue;
                    w->link[before].own = i == 0;
                    for (int a = 0; a < 3; a++)
                        if (sign[i][a] == 0) w->contact[w->link[before].contact].across[a] = 0;
                }
            }
    if (w->link_count == first) return 0;
    if (GROW(w, item)) return -1;
    w->item[w->item_count++] = (item){n, first, w->link_count - first};
    return 0;
}

// Whether a skin node is on what mirror planes have cut open, and on no other surface.
static bool on_cut(const job *j, const brunt_grid *grid, int32_t n) {
    const brunt_contact_surface *s = j->m->skin;
    double normal[3] = {s->normal[n][0], s->normal[n][1], s->normal[n][2]};
    bool cut = false;
    for (int m = 0; m < j->mirror_count; m++) {
        const int axis = j->mirrors[m].axis;
        const double plane = grid->origin[axis] + (double)grid->h * j->mirrors[m].node;
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
static int find_contacts(job *j, int b) {
    brunt_grid_surfaces *w = j->w;
    const brunt_contact_surface *s = j->m->skin;
    const brunt_grid *grid = &j->mpm[b].grid;
    range *r = &w->range[w->range_count++];
    *r = (range){w->contact_count, w->contact_count, w->item_count, w->item_count};
    double low[3], high[3];
    bool any = false;
    bound_grid(grid, low, high);
    for (int k = 0; k < s->fem_count; k++) {
        brunt_pair *pair = pair_of(j->m, &j->mpm[b], s->fem[k]);
        if (!pair || !s->active[k] || !overlap(low, high, s->low[k], s->high[k])) continue;
        if (!any) {
            const size_t nodes = (size_t)grid->slot_count * BRUNT_BLOCK_NODES;
            if (RESERVE(w, place, nodes + 1)) return -1;
            memset(w->place, 0, nodes * sizeof *w->place);
            any = true;
        }
        for (int32_t n = s->node_range[k]; n < s->node_end[k]; n++) {
            if (s->face_first[n + 1] == s->face_first[n]) continue; // a loose node: there is no surface to press with
            if (inside(s->x[n], low, high) && !on_cut(j, grid, n) && add_item(j, b, k, pair, n)) return -1;
        }
    }
    r->contact_end = w->contact_count, r->item_end = w->item_count;
    return 0;
}

// Links by contact, in their order.
static int sort_links(brunt_grid_surfaces *w) {
    if (RESERVE(w, by_contact, w->link_count + 1) || RESERVE(w, changed, w->contact_count + 1)) return -1;
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
    return 0;
}

// ------------------------------------------------------------------------------------------ particles at the facets

static double box_distance(const double box[6], const double x[3]) {
    double square = 0;
    for (int a = 0; a < 3; a++) {
        const double under = box[a] - x[a], over = x[a] - box[3 + a], d = under > over ? under : over;
        square += d > 0 ? d * d : 0;
    }
    return square;
}

// Lists, for each block of the body, the faces of mesh k that come near its particles. 0, or -1: out of memory.
static int list_faces(job *j, int b, int k) {
    brunt_grid_surfaces *w = j->w;
    const brunt_contact_surface *s = j->m->skin;
    const brunt_body *body = &j->mpm[b];
    const brunt_grid *grid = &body->grid;
    const double width = (double)grid->h * grid->side;
    w->near_count = 0;
    // A bin's particles are between base + (order - 1)/2 and one cell further.
    const double shift = 0.5 * (grid->order - 1) * (double)grid->h;
    for (int32_t f = s->face_range[k]; f < s->face_end[k]; f++) {
        int32_t low[3] = {0}, high[3] = {0};
        for (int a = 0; a < grid->dim; a++) {
            const double from = s->face_box[f][a] - w->range_of_sight - grid->origin[a] - shift,
                         to = s->face_box[f][3 + a] + w->range_of_sight - grid->origin[a] - shift;
            low[a] = (int32_t)floor(from / width), high[a] = (int32_t)floor(to / width);
        }
        for (int32_t x = low[0]; x <= high[0]; x++)
            for (int32_t y = low[1]; y <= high[1]; y++)
                for (int32_t z = low[2]; z <= high[2]; z++) {
                    const int32_t coord[3] = {x, y, z}, block = brunt_grid_block(grid, brunt_key(coord));
                    if (block < 0) continue;
                    if (GROW(w, near)) return -1;
                    w->near[w->near_count++] = (near_face){block, f};
                }
    }
    if (RESERVE(w, block_first, grid->block_count + 2) || RESERVE(w, block_face, w->near_count + 1) ||
        RESERVE(w, touch, body->particles.slots + 1))
        return -1;
    memset(w->block_first, 0, ((size_t)grid->block_count + 2) * sizeof *w->block_first);
    for (int32_t q = 0; q < w->near_count; q++) w->block_first[w->near[q].block + 2]++;
    for (int32_t q = 2; q <= grid->block_count + 1; q++) w->block_first[q] += w->block_first[q - 1];
    for (int32_t q = 0; q < w->near_count; q++) w->block_face[w->block_first[w->near[q].block + 1]++] = w->near[q].face;
    return 0;
}

// Faces that may be near the particles of a bin: those of its block, or some of them.
typedef struct faces {
    int32_t count;
    const int32_t *face;
    int32_t some[MOST_FACES];
} faces;

static void faces_of_bin(const job *j, int32_t block, int bin, faces *near) {
    const brunt_grid_surfaces *w = j->w;
    const brunt_contact_surface *s = j->m->skin;
    const brunt_grid *grid = &j->mpm[j->range_mpm].grid;
    double low[3] = {0}, high[3] = {0};
    int local[3];
    brunt_node_local(grid, bin, local);
    for (int a = 0; a < grid->dim; a++) {
        low[a] = grid->origin[a] +
                 (double)grid->h * (grid->blocks[block].coord[a] * grid->side + local[a] + 0.5 * (grid->order - 1)) -
                 w->range_of_sight;
        high[a] = low[a] + (double)grid->h + 2 * w->range_of_sight;
    }
    near->count = 0, near->face = near->some;
    for (int32_t q = w->block_first[block]; q < w->block_first[block + 1]; q++) {
        const double *box = s->face_box[w->block_face[q]];
        if (!overlap(low, high, box, box + 3)) continue;
        if (near->count == MOST_FACES) { // of a mesh that is much finer than the grid: all of the block
            near->face = w->block_face + w->block_first[block];
            near->count = w->block_first[block + 1] - w->block_first[block];
            return;
        }
        near->some[near->count++] = w->block_face[q];
    }
}

static bool find_nearest(const job *j, const faces *near, const double x[3], brunt_closest *best) {
    const brunt_contact_surface *s = j->m->skin;
    best->square = j->w->range_of_sight * j->w->range_of_sight;
    bool found = false;
    for (int32_t q = 0; q < near->count; q++) {
        const int32_t f = near->face[q];
        if (box_distance(s->face_box[f], x) > best->square) continue;
        const brunt_closest at = brunt_closest_on_face(s, f, x);
        // Of facets that share the nearest point, the one that faces the particle more knows which side it is on.
        const double same = found ? 1e-9 * best->square : 0;
        if (at.square > best->square + same) continue;
        if (found && at.square >= best->square - same && fabs(dot(at.d, at.normal)) <= fabs(dot(best->d, best->normal)))
            continue;
        *best = at, found = true;
    }
    return found;
}

static void touch_particle(const job *j, int64_t s, const faces *near) {
    touch *t = &j->w->touch[s];
    brunt_body *body = &j->mpm[j->range_mpm];
    const bool sheet = j->m->skin->fem[j->range_fem]->element->sheet;
    real *const *place = brunt_field(&body->particles, BRUNT_FIELD_position);
    double x[3] = {0};
    brunt_closest c = {.square = 0};
    for (int a = 0; a < body->particles.dim; a++) x[a] = (double)place[a][s];
    t->near = find_nearest(j, near, x, &c);
    if (!t->near) return;
    const double size = sqrt(c.square), above = dot(c.d, c.normal);
    t->beside = sheet && !c.inside && fabs(above) < BESIDE * size;
    t->height = c.inside ? above : t->beside || above >= 0 ? size : -size;
    // Where the nearest point is an edge or a corner, the way from there; behind a solid's, out of the facet.
    const double along = c.inside || !(size > 0) || (above < 0 && !sheet) ? 0 : above >= 0 || t->beside ? 1 : -1;
    for (int a = 0; a < 3; a++) t->n[a] = along != 0 ? along * c.d[a] / size : c.normal[a];
    t->radius = brunt_extent_along(body, s, t->n);
}

static void touch_block(const job *j, int32_t b) {
    const brunt_grid_surfaces *w = j->w;
    const brunt_grid *grid = &j->mpm[j->range_mpm].grid;
    const brunt_block *block = &grid->blocks[b];
    const int32_t *start = grid->bin_start + (int64_t)b * BRUNT_BIN_STARTS;
    for (int64_t s = block->first; s < block->first + block->count; s++) w->touch[s].near = false;
    if (w->block_first[b + 1] == w->block_first[b]) return;
    for (int bin = 0; bin < BRUNT_BLOCK_NODES; bin++) {
        if (start[bin] == start[bin + 1]) continue;
        faces near;
        faces_of_bin(j, b, bin, &near);
        for (int32_t i = start[bin]; near.count && i < start[bin + 1]; i++) touch_particle(j, block->first + i, &near);
    }
}

static void touch_blocks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    for (int64_t b = begin; b < end; b++) touch_block(context, (int32_t)b);
}

// ------------------------------------------------------------------------------------------ normal and gap

// What particles near a grid node know of the distance.
typedef struct view {
    const brunt_grid_surfaces *w;
    const double *x;            // of the node
    double support, half, band; // [m]; half of a sheet's thickness
    double side, front, back;   // of a sheet: sum over its particles; least gap if they are in front of it, or behind
    double least, sum[3];
} view;

static double weight_of(const view *v, brunt_body *body, int64_t s) {
    real *const *x = brunt_field(&body->particles, BRUNT_FIELD_position);
    double weight = 1;
    for (int a = 0; a < body->grid.dim; a++) {
        const double share = 1 - fabs((double)x[a][s] - v->x[a]) / v->support;
        weight *= share > 0 ? share : 0;
    }
    return weight;
}

static double gap_of(const view *v, const touch *t, double side) {
    return (t->beside ? 1 : side) * t->height - v->half - t->radius;
}

static void find_least(void *context, brunt_body *body, int64_t s, const int base[3]) {
    (void)base;
    view *v = context;
    const touch *t = &v->w->touch[s];
    if (!t->near) return;
    const double front = gap_of(v, t, 1), back = gap_of(v, t, -1);
    v->front = front < v->front ? front : v->front, v->back = back < v->back ? back : v->back;
    if (!t->beside) v->side += weight_of(v, body, s) * t->height;
}

static void add_normal(void *context, brunt_body *body, int64_t s, const int base[3]) {
    (void)base;
    view *v = context;
    const touch *t = &v->w->touch[s];
    if (!t->near) return;
    const double behind = gap_of(v, t, v->side) - v->least;
    if (behind > v->band) return;
    const double share = weight_of(v, body, s) * (1 - behind / v->band) * (t->beside ? 1 : v->side);
    for (int a = 0; a < 3; a++) v->sum[a] += share * t->n[a];
}

// Gap between the facets and what the particles near a node reach, and the mean direction to those that are nearest.
static void find_gap(const job *j, contact *c) {
    brunt_body *body = &j->mpm[c->mpm];
    const brunt_contact_surface *s = j->m->skin;
    const brunt_fem_body *fem = s->fem[c->fem];
    view v = {.w = j->w, .x = c->x, .front = INFINITY, .back = INFINITY};
    v.band = BAND * body->spacing, v.support = 0.5 * (body->grid.order + 1) * (double)body->grid.h;
    v.half = fem->element->sheet && s->side ? s->side[fem->index].half : 0;
    c->gap = INFINITY;
    brunt_extent_visit(body, c->slot, c->node, find_least, &v);
    v.side = fem->element->sheet && v.side < 0 ? -1 : 1;
    v.least = v.side > 0 ? v.front : v.back;
    if (!isfinite(v.least)) return;
    brunt_extent_visit(body, c->slot, c->node, add_normal, &v);
    for (int a = 0; a < 3; a++) c->n[a] = c->across[a] * v.sum[a];
    if (make_unit(c->n)) c->gap = v.least;
}

// ------------------------------------------------------------------------------------------ one grid node

// Velocity of the mesh at a contact, of the skin's `of`.
static void map_velocity(const job *j, const contact *c, double (*of)[3], double v[3]) {
    const brunt_grid_surfaces *w = j->w;
    v[0] = v[1] = v[2] = 0;
    for (int32_t i = c->first; i < c->first + c->count; i++) {
        const link *l = &w->link[w->by_contact[i]];
        const double m = l->weight * j->m->skin->mass[l->skin] / c->mass;
        for (int a = 0; a < 3; a++) v[a] += m * l->sign[a] * of[l->skin][a];
    }
}

// What is a skin node's of the surface, as a vector [m^2].
static void area_vector(const brunt_contact_surface *s, int32_t n, double area[3]) {
    area[0] = area[1] = area[2] = 0;
    for (int32_t q = s->face_first[n]; q < s->face_first[n + 1]; q++) {
        const int32_t f = s->face_of[q], *node = s->face[f];
        const double share = s->face_area[f] / (node[2] < 0 ? 2 : node[3] < 0 ? 3 : 4);
        for (int a = 0; a < 3; a++) area[a] += share * s->face_normal[f][a];
    }
}

// Masses, normal and gap at a contact. Where components of the mesh are prescribed, mass is infinite but felt by a
// whole kernel: a sweep then takes what the surface's share of the node is, so that nodes a cell away are not held
// fast.
static void prepare(const job *j, contact *c) {
    const brunt_grid_surfaces *w = j->w;
    const brunt_contact_surface *s = j->m->skin;
    const brunt_grid *grid = &j->mpm[c->mpm].grid;
    double area[3] = {0}, free[3] = {0}, held = 0;
    for (int32_t i = c->first; i < c->first + c->count; i++) {
        const link *l = &w->link[w->by_contact[i]];
        const double m = l->weight * s->mass[l->skin];
        double node_area[3];
        area_vector(s, l->skin, node_area);
        c->mass += m;
        for (int a = 0; a < 3; a++) {
            area[a] += l->weight * l->sign[a] * node_area[a];
            free[a] += s->inverse[l->skin][a] > 0 ? m : 0;
        }
    }
    c->area = sqrt(dot(area, area));
    for (int a = 0; a < 3; a++) c->inverse[a] = free[a] / (c->mass * c->mass);
    find_gap(j, c);
    c->target = -fmax(c->gap, 0) / j->m->dt;
    for (int a = 0; a < 3; a++) held += c->n[a] * c->n[a] * (1 - free[a] / c->mass);
    c->relax = (1 - held) + held * fmin(1, 2 * c->area / pow((double)grid->h, grid->dim - 1));
}

static void prepare_all(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t i = begin; i < end; i++) prepare(j, &j->w->contact[j->range->contact + i]);
}

// Greatest speed of the body and the mesh looked at against each other, at most [m/s].
static double fastest(const job *j) {
    const brunt_contact_surface *s = j->m->skin;
    return (double)j->mpm[j->range_mpm].speed + s->speed[j->range_fem] + sqrt(dot(s->frame, s->frame));
}

// Normals and gaps of all contacts of body b, mesh after mesh.
static int look_at_facets(job *j, int b) {
    brunt_grid_surfaces *w = j->w;
    const range whole = w->range[b];
    j->range_mpm = b;
    for (int32_t c = whole.contact, next; c < whole.contact_end; c = next) {
        j->range_fem = w->contact[c].fem;
        for (next = c + 1; next < whole.contact_end && w->contact[next].fem == j->range_fem; next++) {}
        w->range_of_sight = SIGHT * j->mpm[b].spacing + MARGIN * fastest(j) * j->m->dt;
        if (list_faces(j, b, j->range_fem)) return -1;
        brunt_parallel(j->m->threads, j->mpm[b].grid.block_count, 1, touch_blocks, j, j->m->timer);
        const range run = {.contact = c, .contact_end = next};
        j->range = &run;
        brunt_parallel(j->m->threads, next - c, GRAIN, prepare_all, j, j->m->timer);
    }
    j->range = &w->range[b];
    return 0;
}

// A node behind a mirror plane sees few particles, or none: it has what its image has, reflected. The one that sees
// more of the mesh counts.
static void reflect(const job *j) {
    brunt_grid_surfaces *w = j->w;
    const int32_t first = j->range->contact, end = j->range->contact_end;
    if (first == end) return;
    memset(w->place, 0, (size_t)j->mpm[w->contact[first].mpm].grid.slot_count * BRUNT_BLOCK_NODES * sizeof *w->place);
    for (int32_t i = first; i < end; i++)
        if (w->contact[i].leader == i) w->place[w->contact[i].number] = i + 1;
    for (int32_t i = first; i < end; i++) {
        contact *c = &w->contact[i];
        const brunt_grid *grid = &j->mpm[c->mpm].grid;
        int local[3];
        int32_t at[3] = {0}, image[BRUNT_MAX_IMAGES][3];
        real sign[BRUNT_MAX_IMAGES][3];
        double most = 0;
        brunt_node_local(grid, c->node, local);
        for (int a = 0; a < grid->dim; a++) at[a] = grid->slots[c->slot].coord[a] * grid->side + local[a];
        const int images = brunt_symmetry_images(j->mirrors, j->mirror_count, at, 2, image, sign);
        for (int q = 0; q < images; q++) {
            seen_slot seen = {.is = false};
            int32_t slot;
            int node;
            if (!find_place(grid, image[q], &seen, &slot, &node)) continue;
            int32_t o = w->place[slot * BRUNT_BLOCK_NODES + node] - 1;
            while (o >= 0 && w->contact[o].fem != c->fem) o = w->contact[o].next;
            if (o < 0) continue;
            const contact *other = &w->contact[o];
            double own = 0;
            for (int32_t l = other->first; l < other->first + other->count; l++) {
                const link *by = &w->link[w->by_contact[l]];
                own += by->own ? by->weight * j->m->skin->mass[by->skin] : 0;
            }
            if (!(own > most)) continue;
            most = own;
            if (!q) continue;
            c->gap = other->gap, c->target = other->target, c->relax = other->relax;
            for (int a = 0; a < 3; a++) c->n[a] = (double)sign[q][a] * other->n[a];
        }
    }
}

// Brings one contact to its complementarity condition, as far as mesh and body are concerned there; returns the change
// of velocity [m/s].
static double visit(const job *j, contact *c, double vs[3]) {
    double v[3], slip[3], along, push_inverse = c->inverse_s, drag_inverse = c->inverse_s;
    memset(c->given, 0, sizeof c->given);
    if (!isfinite(c->target)) return 0;
    map_velocity(j, c, j->m->skin->v, v);
    for (int a = 0; a < 3; a++) slip[a] = vs[a] - v[a];
    along = dot(slip, c->n);
    for (int a = 0; a < 3; a++) {
        slip[a] -= along * c->n[a];
        push_inverse += c->n[a] * c->n[a] * c->inverse[a];
        drag_inverse = fmax(drag_inverse, c->inverse_s + c->inverse[a]);
    }
    const double push = fmax(0, c->push + c->relax * (c->target - along) / push_inverse), step = push - c->push;
    double changed = fabs(step) * push_inverse;
    c->push = push;
    for (int a = 0; a < 3; a++) c->given[a] = step * c->n[a];
    if (c->pair->friction > 0) {
        double drag[3], size = 0, moved = 0;
        for (int a = 0; a < 3; a++) {
            drag[a] = c->drag[a] - c->relax * slip[a] / drag_inverse;
            size += drag[a] * drag[a];
        }
        size = sqrt(size);
        const double most = c->pair->friction * push, scale = size > most ? most / size : 1;
        for (int a = 0; a < 3; a++) {
            const double now = scale * drag[a], add = now - c->drag[a];
            c->given[a] += add;
            moved += add * add;
            c->drag[a] = now;
        }
        changed = fmax(changed, sqrt(moved) * drag_inverse);
    }
    for (int a = 0; a < 3; a++) vs[a] += c->given[a] * c->inverse_s;
    return changed;
}

static void visit_all(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    brunt_grid_surfaces *w = j->w;
    for (int64_t i = j->range->contact + begin; i < j->range->contact + end; i++) {
        w->changed[i] = 0;
        if (w->contact[i].leader != i) continue;
        for (int32_t c = (int32_t)i; c >= 0; c = w->contact[c].next)
            w->changed[i] = fmax(w->changed[i], visit(j, &w->contact[c], w->contact[i].v));
    }
}

// What the mesh's nodes get of what the contacts gave in this sweep (eq. 59).
static void give_all(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    const brunt_grid_surfaces *w = j->w;
    brunt_contact_surface *s = j->m->skin;
    for (int64_t i = j->range->item + begin; i < j->range->item + end; i++) {
        const int32_t n = w->item[i].skin;
        double change[3] = {0};
        for (int32_t l = w->item[i].first; l < w->item[i].first + w->item[i].count; l++) {
            if (!w->link[l].own) continue;
            const contact *c = &w->contact[w->link[l].contact];
            for (int a = 0; a < 3; a++) change[a] -= w->link[l].weight * c->given[a] / c->mass;
        }
        for (int a = 0; a < 3; a++) {
            s->impulse[n][a] += s->mass[n] * change[a];
            if (s->inverse[n][a] > 0) s->v[n][a] += change[a];
        }
    }
}

// ------------------------------------------------------------------------------------------ a step

// The back of a sheet moves with its front.
static void follow_front(brunt_contact_surface *s) {
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_end[k]; s->active[k] && n < s->node_range[k + 1]; n++)
            memcpy(s->v[n], s->v[s->front[n]], sizeof s->v[n]);
}

// Whether some node of a mesh is met by two bodies. What they squeeze between them passes on in a sweep no more than a
// share of what its own mass can carry.
static bool squeezed(brunt_grid_surfaces *w, const brunt_contact_surface *s, bool *found) {
    int32_t met = 0;
    *found = false;
    for (int32_t b = 0; b < w->range_count; b++) met += w->range[b].item_end > w->range[b].item;
    if (met < 2) return true;
    if (RESERVE(w, met, s->node_count + 1)) return false;
    memset(w->met, 0, (size_t)s->node_count * sizeof *w->met);
    for (int32_t i = 0; i < w->item_count && !*found; i++) *found = w->met[w->item[i].skin]++ > 0;
    return true;
}

static double sweep(job *j) {
    const brunt_contact_context *m = j->m;
    double most = 0;
    for (int32_t k = 0; k < j->w->range_count; k++) {
        // What two bodies squeeze between them should not know which of them has the first name.
        const range *r = j->range = &j->w->range[m->step % 2 ? j->w->range_count - 1 - k : k];
        brunt_parallel(m->threads, r->contact_end - r->contact, GRAIN, visit_all, j, m->timer);
        brunt_parallel(m->threads, r->item_end - r->item, GRAIN, give_all, j, m->timer);
        for (int32_t c = r->contact; c < r->contact_end; c++) most = fmax(most, j->w->changed[c]);
    }
    return most;
}

int brunt_grid_surfaces_meet(const brunt_contact_context *m, brunt_body *mpm, int mpm_count,
                             const brunt_symmetry_plane *mirrors, int mirror_count, int sweeps,
                             brunt_grid_surfaces **work) {
    if (!*work) *work = brunt_alloc(sizeof **work);
    if (!*work) return -1;
    brunt_grid_surfaces *w = *work;
    job j = {.m = m, .w = w, .mpm = mpm, .mirrors = mirrors, .mirror_count = mirror_count};
    w->range_count = w->link_count = w->item_count = w->contact_count = 0;
    if (RESERVE(w, range, mpm_count + 1)) return -1;
    for (int b = 0; b < mpm_count; b++)
        if (find_contacts(&j, b)) return -1;
    if (!w->contact_count) return 0;
    if (sort_links(w)) return -1;
    for (int32_t b = 0; b < w->range_count; b++) {
        if (look_at_facets(&j, b)) return -1;
        if (mirror_count) reflect(&j);
    }
    bool two;
    if (!squeezed(w, m->skin, &two)) return -1;
    for (int k = 0; k < (two ? MORE_SWEEPS : 1) * sweeps; k++)
        if (!(sweep(&j) > 0)) break;
    for (int32_t i = 0; i < w->contact_count; i++) {
        const contact *c = &w->contact[i];
        for (int a = 0; c->leader == i && a < mpm[c->mpm].grid.dim; a++) c->at[BRUNT_NODE_VELOCITY + a] = (real)c->v[a];
    }
    follow_front(m->skin);
    return 0;
}

// ------------------------------------------------------------------------------------------ accounts

static void book(const job *j, const contact *c) {
    const int dim = j->mpm[c->mpm].grid.dim;
    const double sign = j->mpm[c->mpm].index > j->m->skin->fem[c->fem]->index ? 1 : -1,
                 own = (double)(c->at[BRUNT_NODE_SPARE] / c->at[BRUNT_NODE_MASS]);
    static const double rest[3] = {0, 0, 0};
    double push[3], drag[3], old[3], now[3];
    map_velocity(j, c, j->m->skin->old, old);
    map_velocity(j, c, j->m->skin->v, now);
    for (int a = 0; a < 3; a++) {
        push[a] = sign * own * c->push * c->n[a], drag[a] = sign * own * c->drag[a];
        old[a] = sign * ((a < dim ? (double)c->at[BRUNT_NODE_OLD + a] : 0) - old[a]);
        now[a] = sign * ((a < dim ? (double)c->at[BRUNT_NODE_VELOCITY + a] : 0) - now[a]);
    }
    brunt_impulse_account *last = &c->pair->last;
    brunt_impulse_account_book(last, &last->normal_loss, push, c->x, old, now, rest);
    if (c->pair->friction > 0) brunt_impulse_account_book(last, &last->friction_loss, drag, c->x, old, now, rest);
    last->area += own * c->area;
}

static void note_state(const job *j, const contact *c) {
    brunt_contact_surface *s = j->m->skin;
    const bool slips = !(dot(c->drag, c->drag) < (1 - 1e-9) * pow(c->pair->friction * c->push, 2));
    for (int32_t i = c->first; i < c->first + c->count; i++) {
        const link *l = &j->w->link[j->w->by_contact[i]];
        if (!l->own) continue;
        s->gap[l->skin] = fmin(s->gap[l->skin], c->gap);
        if (slips || !s->state[l->skin]) s->state[l->skin] = slips ? 2 : 1;
    }
}

// Across a mirror plane the two do not get the same, each being the half of a whole: the rest is the plane's.
static void book_mirror(const job *j, const contact *c, brunt_wall *walls) {
    const brunt_grid *grid = &j->mpm[c->mpm].grid;
    const double own = (double)(c->at[BRUNT_NODE_SPARE] / c->at[BRUNT_NODE_MASS]);
    double given = 0;
    for (int32_t i = c->first; i < c->first + c->count; i++) {
        const link *l = &j->w->link[j->w->by_contact[i]];
        given += l->own ? l->weight * j->m->skin->mass[l->skin] / c->mass : 0;
    }
    for (int m = 0; m < j->mirror_count; m++) {
        const int axis = j->mirrors[m].axis;
        const double plane = grid->origin[axis] + (double)grid->h * j->mirrors[m].node;
        if (j->mirrors[m].wall < 0 || fabs(c->x[axis] - plane) > 2.5 * (double)grid->h) continue;
        walls[j->mirrors[m].wall].last.impulse[axis] += (own - given) * (c->push * c->n[axis] + c->drag[axis]);
    }
}

void brunt_grid_surfaces_finish(const brunt_contact_context *m, brunt_body *mpm, const brunt_symmetry_plane *mirrors,
                                int mirror_count, brunt_wall *walls, const brunt_grid_surfaces *work) {
    if (!work) return;
    job j = {.m = m, .w = (brunt_grid_surfaces *)work, .mpm = mpm, .mirrors = mirrors, .mirror_count = mirror_count};
    for (int32_t i = 0; i < work->contact_count; i++) {
        const contact *c = &work->contact[i];
        if (!(c->push > 0)) continue;
        book(&j, c);
        note_state(&j, c);
        if (mirror_count) book_mirror(&j, c, walls);
    }
}
