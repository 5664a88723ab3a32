// Normal and gap of a mesh and the particles about a node of their grid.
#include "contact/methods/surface_on_grid_parts.h"

enum { GRAIN = 16, FACE_LIMIT = 128 };
static const double SEARCH = 1.5; // spacings: how far a particle's reach may go; it starts with 0.87 at most
static const double BAND = 0.5;   // spacings: particles up to so much farther than the nearest have a say in the normal
static const double MARGIN = 2;   // times the way of a step that it looks further
static const double BESIDE = 0.5; // of the distance: a particle less than this above a membrane is beside its border

static double box_distance(const double box[6], const double x[3]) {
    double square = 0;
    for (int a = 0; a < 3; a++) {
        const double under = box[a] - x[a], over = x[a] - box[3 + a], d = under > over ? under : over;
        square += d > 0 ? d * d : 0;
    }
    return square;
}

// Lists, for each block of the body, the faces of mesh k that come near its particles.
static int list_faces(job *j, int b, int k, brunt_error *error) {
    brunt_surface_on_grid *w = j->w;
    const brunt_contact_surface *s = j->m->surface;
    const brunt_body *body = &j->m->mpm[b];
    const brunt_grid *grid = &body->grid;
    const double width = (double)grid->h * grid->side;
    w->near_count = 0;
    // A bin's particles are between base + (order - 1)/2 and one cell further.
    const double shift = 0.5 * (grid->order - 1) * (double)grid->h;
    for (int32_t f = s->face_range[k]; f < s->face_end[k]; f++) {
        int32_t low[3] = {0}, high[3] = {0};
        for (int a = 0; a < grid->dim; a++) {
            const double from = s->face_box[f][a] - w->search_range - grid->origin[a] - shift,
                         to = s->face_box[f][3 + a] + w->search_range - grid->origin[a] - shift;
            low[a] = (int32_t)floor(from / width), high[a] = (int32_t)floor(to / width);
        }
        for (int32_t x = low[0]; x <= high[0]; x++)
            for (int32_t y = low[1]; y <= high[1]; y++)
                for (int32_t z = low[2]; z <= high[2]; z++) {
                    const int32_t coord[3] = {x, y, z}, block = brunt_grid_block(grid, brunt_key(coord));
                    if (block < 0) continue;
                    if (GROW(w, near, "faces near blocks of particles", error)) return BRUNT_FAILED;
                    w->near[w->near_count++] = (near_face){block, f};
                }
    }
    if (RESERVE(w, block_first, grid->block_count + 2, "blocks of particles", error) ||
        RESERVE(w, block_face, w->near_count + 1, "faces near blocks of particles", error) ||
        RESERVE(w, touch, body->particles.slots + 1, "particles near faces", error))
        return BRUNT_FAILED;
    memset(w->block_first, 0, ((size_t)grid->block_count + 2) * sizeof *w->block_first);
    for (int32_t q = 0; q < w->near_count; q++) w->block_first[w->near[q].block + 2]++;
    for (int32_t q = 2; q <= grid->block_count + 1; q++) w->block_first[q] += w->block_first[q - 1];
    for (int32_t q = 0; q < w->near_count; q++) w->block_face[w->block_first[w->near[q].block + 1]++] = w->near[q].face;
    return BRUNT_OK;
}

// Faces that may be near the particles of a bin: those of its block, or some of them.
typedef struct faces {
    int32_t count;
    const int32_t *face;
    int32_t some[FACE_LIMIT];
} faces;

static void faces_of_bin(const job *j, int32_t block, int bin, faces *near) {
    const brunt_surface_on_grid *w = j->w;
    const brunt_contact_surface *s = j->m->surface;
    const brunt_grid *grid = &j->m->mpm[j->range_mpm].grid;
    double low[3] = {0}, high[3] = {0};
    int local[3];
    brunt_node_local(grid, bin, local);
    for (int a = 0; a < grid->dim; a++) {
        low[a] = grid->origin[a] +
                 (double)grid->h * (grid->blocks[block].coord[a] * grid->side + local[a] + 0.5 * (grid->order - 1)) -
                 w->search_range;
        high[a] = low[a] + (double)grid->h + 2 * w->search_range;
    }
    near->count = 0, near->face = near->some;
    for (int32_t q = w->block_first[block]; q < w->block_first[block + 1]; q++) {
        const double *box = s->face_box[w->block_face[q]];
        if (!overlap(low, high, box, box + 3)) continue;
        if (near->count == FACE_LIMIT) { // of a mesh that is much finer than the grid: all of the block
            near->face = w->block_face + w->block_first[block];
            near->count = w->block_first[block + 1] - w->block_first[block];
            return;
        }
        near->some[near->count++] = w->block_face[q];
    }
}

static bool find_nearest(const job *j, const faces *near, const double x[3], brunt_closest *best) {
    const brunt_contact_surface *s = j->m->surface;
    best->square = j->w->search_range * j->w->search_range;
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
    brunt_body *body = &j->m->mpm[j->range_mpm];
    const bool membrane = j->m->surface->fem[j->range_fem]->traits->membrane;
    real *const *place = brunt_field(&body->particles, BRUNT_FIELD_position);
    double x[3] = {0};
    brunt_closest c = {.square = 0};
    for (int a = 0; a < body->particles.dim; a++) x[a] = (double)place[a][s];
    t->near = find_nearest(j, near, x, &c);
    if (!t->near) return;
    const double size = sqrt(c.square), above = dot(c.d, c.normal);
    t->beside = membrane && !c.inside && fabs(above) < BESIDE * size;
    t->height = c.inside ? above : t->beside || above >= 0 ? size : -size;
    // Where the nearest point is an edge or a corner, the way from there; behind a solid's, out of the facet.
    const double along = c.inside || !(size > 0) || (above < 0 && !membrane) ? 0 : above >= 0 || t->beside ? 1 : -1;
    for (int a = 0; a < 3; a++) t->n[a] = along != 0 ? along * c.d[a] / size : c.normal[a];
    t->radius = brunt_extent_along(body, s, t->n);
}

static void touch_block(const job *j, int32_t b) {
    const brunt_surface_on_grid *w = j->w;
    const brunt_grid *grid = &j->m->mpm[j->range_mpm].grid;
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
    const brunt_surface_on_grid *w;
    const double *x;            // of the node
    double support, half, band; // [m]; half of a membrane's thickness
    double side, front, back; // of a membrane: sum over its particles; least gap if they are in front of it, or behind
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

// The least gaps in front and behind, and on which side of a membrane particles are.
static void find_least(view *v, brunt_body *body, const brunt_slot_run *run) {
    for (int64_t s = run->first; s < run->first + run->count; s++) {
        const touch *t = &v->w->touch[s];
        if (!t->near) continue;
        v->front = fmin(gap_of(v, t, 1), v->front), v->back = fmin(gap_of(v, t, -1), v->back);
        if (!t->beside) v->side += weight_of(v, body, s) * t->height;
    }
}

static void add_normals(view *v, brunt_body *body, const brunt_slot_run *run) {
    for (int64_t s = run->first; s < run->first + run->count; s++) {
        const touch *t = &v->w->touch[s];
        const double behind = t->near ? gap_of(v, t, v->side) - v->least : INFINITY;
        if (behind > v->band) continue;
        const double share = weight_of(v, body, s) * (1 - behind / v->band) * (t->beside ? 1 : v->side);
        for (int a = 0; a < 3; a++) v->sum[a] += share * t->n[a];
    }
}

// Gap between the facets and what the particles near a node reach, and the mean direction to those that are nearest.
static void find_gap(const job *j, contact *c) {
    brunt_body *body = &j->m->mpm[c->mpm];
    const brunt_contact_surface *s = j->m->surface;
    const brunt_fem_body *fem = s->fem[c->fem];
    brunt_slot_run runs[BRUNT_MAX_SLOT_RUNS];
    view v = {.w = j->w, .x = c->x, .front = INFINITY, .back = INFINITY};
    v.band = BAND * body->spacing, v.support = 0.5 * (body->grid.order + 1) * (double)body->grid.h;
    v.half = fem->traits->membrane && s->membrane.side ? s->membrane.side[fem->index].half : 0;
    c->gap = INFINITY;
    const int count = brunt_extent_runs(body, c->slot, c->node, runs);
    for (int q = 0; q < count; q++) find_least(&v, body, &runs[q]);
    v.side = fem->traits->membrane && v.side < 0 ? -1 : 1;
    v.least = v.side > 0 ? v.front : v.back;
    if (!isfinite(v.least)) return;
    for (int q = 0; q < count; q++) add_normals(&v, body, &runs[q]);
    for (int a = 0; a < 3; a++) c->n[a] = c->across[a] * v.sum[a];
    if (make_unit(c->n)) c->gap = v.least;
}

// What is a surface node's of the surface, as a vector [m^2].
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
    const brunt_surface_on_grid *w = j->w;
    const brunt_contact_surface *s = j->m->surface;
    const brunt_grid *grid = &j->m->mpm[c->mpm].grid;
    double area[3] = {0}, free[3] = {0}, fixed = 0;
    for (int32_t i = c->first; i < c->first + c->count; i++) {
        const link *l = &w->link[w->by_contact[i]];
        const double m = l->weight * s->mass[l->surface];
        double node_area[3];
        area_vector(s, l->surface, node_area);
        c->mass += m;
        for (int a = 0; a < 3; a++) {
            area[a] += l->weight * l->sign[a] * node_area[a];
            free[a] += s->inverse[l->surface][a] > 0 ? m : 0;
        }
    }
    c->area = sqrt(dot(area, area));
    for (int a = 0; a < 3; a++) c->inverse[a] = free[a] / (c->mass * c->mass);
    find_gap(j, c);
    c->target = -fmax(c->gap, 0) / j->m->dt;
    for (int a = 0; a < 3; a++) fixed += c->n[a] * c->n[a] * (1 - free[a] / c->mass);
    c->relax = (1 - fixed) + fixed * fmin(1, 2 * c->area / pow((double)grid->h, grid->dim - 1));
}

static void prepare_all(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t i = begin; i < end; i++) prepare(j, &j->w->contact[j->range->contact + i]);
}

// Greatest speed of the body and the mesh looked at against each other, at most [m/s].
static double fastest(const job *j) {
    const brunt_contact_surface *s = j->m->surface;
    return (double)j->m->mpm[j->range_mpm].speed + s->motion.speed[j->range_fem] +
           sqrt(dot(s->motion.frame, s->motion.frame));
}

// Normals and gaps of all contacts of body b, mesh after mesh.
int brunt_surface_on_grid_look(job *j, int b, brunt_error *error) {
    brunt_surface_on_grid *w = j->w;
    const range whole = w->range[b];
    j->range_mpm = b;
    for (int32_t c = whole.contact, next; c < whole.contact_end; c = next) {
        j->range_fem = w->contact[c].fem;
        for (next = c + 1; next < whole.contact_end && w->contact[next].fem == j->range_fem; next++) {}
        w->search_range = SEARCH * j->m->mpm[b].spacing + MARGIN * fastest(j) * j->m->dt;
        if (list_faces(j, b, j->range_fem, error)) return BRUNT_FAILED;
        brunt_parallel(j->m->threads, j->m->mpm[b].grid.block_count, 1, touch_blocks, j, j->m->timer);
        const range run = {.contact = c, .contact_end = next};
        j->range = &run;
        brunt_parallel(j->m->threads, next - c, GRAIN, prepare_all, j, j->m->timer);
    }
    j->range = &w->range[b];
    return BRUNT_OK;
}

// A node behind a symmetry plane sees few particles, or none: it has what its image has, reflected. The one that sees
// more of the mesh counts.
void brunt_surface_on_grid_reflect(const job *j) {
    brunt_surface_on_grid *w = j->w;
    const int32_t first = j->range->contact, end = j->range->contact_end;
    if (first == end) return;
    brunt_symmetry_plane symmetry[BRUNT_MAX_PLANES];
    const int symmetry_count = brunt_symmetry_of(j->m, &j->m->mpm[w->contact[first].mpm], symmetry);
    memset(w->place, 0,
           (size_t)j->m->mpm[w->contact[first].mpm].grid.slot_count * BRUNT_BLOCK_NODES * sizeof *w->place);
    for (int32_t i = first; i < end; i++)
        if (w->contact[i].leader == i) w->place[w->contact[i].number] = i + 1;
    for (int32_t i = first; i < end; i++) {
        contact *c = &w->contact[i];
        const brunt_grid *grid = &j->m->mpm[c->mpm].grid;
        int local[3];
        int32_t at[3] = {0}, image[BRUNT_MAX_IMAGES][3];
        real sign[BRUNT_MAX_IMAGES][3];
        double greatest = 0;
        brunt_node_local(grid, c->node, local);
        for (int a = 0; a < grid->dim; a++) at[a] = grid->slots[c->slot].coord[a] * grid->side + local[a];
        const int images = brunt_symmetry_images(symmetry, symmetry_count, at, 2, image, sign);
        for (int q = 0; q < images; q++) {
            slot_cache cached = {.is = false};
            int32_t slot;
            int node;
            if (!brunt_surface_on_grid_node(grid, image[q], &cached, &slot, &node)) continue;
            int32_t o = w->place[slot * BRUNT_BLOCK_NODES + node] - 1;
            while (o >= 0 && w->contact[o].fem != c->fem) o = w->contact[o].next;
            if (o < 0) continue;
            const contact *other = &w->contact[o];
            double own = 0;
            for (int32_t l = other->first; l < other->first + other->count; l++) {
                const link *by = &w->link[w->by_contact[l]];
                own += by->own ? by->weight * j->m->surface->mass[by->surface] : 0;
            }
            if (!(own > greatest)) continue;
            greatest = own;
            if (!q) continue;
            c->gap = other->gap, c->target = other->target, c->relax = other->relax;
            for (int a = 0; a < 3; a++) c->n[a] = (double)sign[q][a] * other->n[a];
        }
    }
}
