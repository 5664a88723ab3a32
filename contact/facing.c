#include "facing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "closest.h"
#include "memory.h"
#include "particles.h"
#include "threads.h"
#include "transfer.h"

enum { GRAIN = 64, MAX_HITS = 7, MAX_TIED = 16, MAX_NEAR = 32 };
static const double RANGE = 0.25;    // mean edges: how far a body looks for others, if nothing moves faster
static const double MARGIN = 0.125;  // mean edges: how far facets may move before the cells are made anew
static const double CELL = 0.5;      // mean edges: of the cells that facets are found in
static const double OPPOSED = 0.1;   // least cosine between a slave's outward normal and the one into the master
static const double ASKEW = -0.3;    // ... or, where nothing opposed is within ...
static const double CLOSE = 0.25;    // ... so many mean edges, the least one with the normal of a facet
static const double SLACK = 0.125;  // mean edges: facets so much further than the nearest are looked at closely, too
static const double SHALLOW = 0.02; // mean edges: depths that may be pushed out against a load
static const double PUSH = 0.2;      // share of a penetration that is pushed out in a step ...
static const double BOUNCE = 0.5;    // ... but no faster than this share of the approach, so that it adds no energy

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// The nearest facet of one other body.
typedef struct hit {
    int32_t face, triangle, body;
    double gap, n[3], target;
} hit;

typedef struct slave_hits {
    hit hits[MAX_HITS];
    int32_t count;
} slave_hits;

typedef struct bounds {
    double low[3], high[3];
    int body; // of the world
    int fem;  // index in the skin, -1: material points
    int mpm;
} bounds;

typedef struct near_pair {
    int32_t a, b; // of the boxes
} near_pair;

struct brunt_facing {
    double range; // [m] how far a body looks for others in this step ...
    double reach; // ... and how far anything moves towards anything ...
    double wall_reach; // ... and towards a wall
    bounds *box;
    size_t box_capacity;
    int32_t box_count;
    near_pair *near;
    size_t near_capacity;
    int32_t near_count;
    int32_t *box_of; // skin body -> box
    size_t box_of_capacity;
    int32_t *near_first, *near_list; // boxes near a box
    size_t near_first_capacity, near_list_capacity;

    // Cells, and what they were made for.
    bool made;
    double made_range;
    int32_t made_near;
    uint64_t made_pairs;
    double origin[3], cell;
    int32_t n[3];
    int32_t *cell_first, *cell_face;
    size_t cell_first_capacity, cell_face_capacity;
    double (*made_x)[3]; // skin nodes then
    size_t made_x_capacity;

    uint8_t *found; // of each skin node: how many hits ...
    size_t found_capacity;
    hit *hits; // ... in its MAX_HITS places
    size_t hits_capacity;
    int32_t *last; // of each skin node: the face it was nearest to, to look at first; -1
    size_t last_capacity;
    // How far from everything each skin node was when it was looked at, and how far things had moved then: until they have moved
    // that far again, it touches nothing and need not be looked at.
    struct quiet {
        double distance, travelled;
        double second; // of the nearest facet but `last`: until then that one stays the nearest
    } *quiet;
    size_t quiet_capacity;
    double travelled; // [m] twice the furthest motion of each step, summed
    int32_t *support_of; // of each skin node: support, -1
    size_t support_of_capacity;
    int32_t *first_point;
    size_t first_point_capacity;

    int32_t **node_support; // of each mpm body: of each grid node its support + 1
    size_t *node_support_capacity;
    int mpm_count;
    struct grid_support {
        int32_t mpm;
        int64_t node;
        int32_t support;
    } *grid;
    size_t grid_capacity;
    int32_t grid_count;
};

void brunt_facing_free(brunt_facing *f) {
    if (!f) return;
    for (int k = 0; k < f->mpm_count; k++) brunt_free(f->node_support[k]);
    void *owned[] = {f->box,       f->near,       f->box_of,      f->near_first, f->near_list,   f->cell_first,
                     f->cell_face, f->made_x,     f->found,      f->hits,         f->last,         f->quiet,        f->support_of,  f->first_point,
                     f->node_support, f->node_support_capacity, f->grid, f};
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
}

size_t brunt_facing_bytes(const brunt_facing *f) {
    return f ? f->box_capacity + f->near_capacity + f->cell_first_capacity + f->cell_face_capacity + f->made_x_capacity +
                   f->quiet_capacity + f->found_capacity + f->support_of_capacity
             : 0;
}

#define RESERVE(f, what, count) brunt_reserve((void **)&(f)->what, &(f)->what##_capacity, (size_t)(count) * sizeof *(f)->what, 0)

// ------------------------------------------------------------------------------------------ which bodies are near

static void bound_grid(const brunt_body *body, bounds *box) {
    const brunt_grid *grid = &body->grid;
    for (int a = 0; a < 3; a++) box->low[a] = a < grid->dim ? INFINITY : 0, box->high[a] = a < grid->dim ? -INFINITY : 0;
    for (int32_t b = 0; b < grid->block_count; b++)
        for (int a = 0; a < grid->dim; a++) {
            double low = grid->origin[a] + (double)grid->h * grid->blocks[b].coord[a] * grid->side;
            box->low[a] = fmin(box->low[a], low);
            box->high[a] = fmax(box->high[a], low + (double)grid->h * (grid->side + grid->order));
        }
}

static int by_low(const void *a, const void *b) {
    const bounds *p = a, *q = b;
    return p->low[0] < q->low[0] ? -1 : p->low[0] > q->low[0] ? 1 : p->body - q->body;
}

static bool overlap(const bounds *a, const bounds *b, double by) {
    for (int k = 0; k < 3; k++)
        if (a->low[k] - by > b->high[k] || b->low[k] - by > a->high[k]) return false;
    return true;
}

static bool meets(const brunt_meeting *m, const bounds *a, const bounds *b) {
    if (a->fem < 0 && b->fem < 0) return false; // particles have no facets: those meet at grid nodes
    int32_t pair = m->pair_of[a->body * m->body_count + b->body];
    return pair >= 0 && m->pairs[pair].method == BRUNT_CONTACT_AUGURY;
}

static int find_boxes(const brunt_meeting *m, brunt_body *mpm, int mpm_count, brunt_facing *f) {
    const brunt_skin *s = m->skin;
    f->box_count = s->fem_count + mpm_count;
    if (RESERVE(f, box, f->box_count + 1) || RESERVE(f, box_of, s->fem_count + 1)) return -1;
    for (int k = 0; k < s->fem_count; k++) {
        bounds *box = &f->box[k];
        *box = (bounds){.body = s->fem[k]->index, .fem = k, .mpm = -1};
        memcpy(box->low, s->low[k], sizeof box->low), memcpy(box->high, s->high[k], sizeof box->high);
    }
    for (int k = 0; k < mpm_count; k++) {
        bounds *box = &f->box[s->fem_count + k];
        *box = (bounds){.body = mpm[k].index, .fem = -1, .mpm = k};
        bound_grid(&mpm[k], box);
    }
    qsort(f->box, (size_t)f->box_count, sizeof *f->box, by_low);
    for (int32_t k = 0; k < f->box_count; k++)
        if (f->box[k].fem >= 0) f->box_of[f->box[k].fem] = k;
    return 0;
}

static int find_pairs(const brunt_meeting *m, brunt_facing *f) {
    f->near_count = 0;
    for (int32_t i = 0; i < f->box_count; i++)
        for (int32_t k = i + 1; k < f->box_count && f->box[k].low[0] - 2 * f->range <= f->box[i].high[0]; k++) {
            if (!overlap(&f->box[i], &f->box[k], 2 * f->range) || !meets(m, &f->box[i], &f->box[k])) continue;
            if (brunt_reserve((void **)&f->near, &f->near_capacity, ((size_t)f->near_count + 1) * sizeof *f->near,
                              (size_t)f->near_count * sizeof *f->near))
                return -1;
            f->near[f->near_count++] = (near_pair){i, k};
        }
    if (RESERVE(f, near_first, f->box_count + 2) || RESERVE(f, near_list, 2 * f->near_count + 1)) return -1;
    memset(f->near_first, 0, ((size_t)f->box_count + 2) * sizeof *f->near_first);
    for (int32_t p = 0; p < f->near_count; p++) f->near_first[f->near[p].a + 2]++, f->near_first[f->near[p].b + 2]++;
    for (int32_t k = 2; k <= f->box_count + 1; k++) f->near_first[k] += f->near_first[k - 1];
    for (int32_t p = 0; p < f->near_count; p++) {
        f->near_list[f->near_first[f->near[p].a + 1]++] = f->near[p].b;
        f->near_list[f->near_first[f->near[p].b + 1]++] = f->near[p].a;
    }
    return 0;
}

static double plane_distance(const brunt_plane_def *plane, double time, const double x[3]) {
    double d = 0;
    for (int a = 0; a < 3; a++) d += plane->normal[a] * (x[a] - plane->point[a] - plane->velocity[a] * time);
    return d;
}

static bool near_wall(const brunt_skin *s, int k, const brunt_wall *wall, double time, double range) {
    if (wall->region || (wall->body >= 0 && wall->body != s->fem[k]->index)) return false;
    double corner[3]; // of the box, deepest behind the plane
    for (int a = 0; a < 3; a++) corner[a] = wall->plane.normal[a] > 0 ? s->low[k][a] : s->high[k][a];
    return plane_distance(&wall->plane, time, corner) < range;
}

static int make_facing(brunt_facing **facing, int mpm_count, int32_t nodes) {
    if (*facing) return 0;
    brunt_facing *f = *facing = brunt_alloc(sizeof *f);
    if (!f) return -1;
    f->mpm_count = mpm_count;
    f->node_support = brunt_alloc(((size_t)mpm_count + 1) * sizeof(void *));
    f->node_support_capacity = brunt_alloc(((size_t)mpm_count + 1) * sizeof(size_t));
    if (!f->node_support || !f->node_support_capacity || RESERVE(f, found, nodes + 1) ||
        RESERVE(f, hits, MAX_HITS * (nodes + 1)) || RESERVE(f, last, nodes + 1) || RESERVE(f, quiet, nodes + 1))
        return -1;
    for (int32_t n = 0; n < nodes; n++) f->last[n] = -1;
    return 0;
}

int64_t brunt_facing_state_count(const brunt_skin *s) { return 7 * (int64_t)s->node_count + s->fem_count + 1; }

void brunt_facing_state_get(const brunt_facing *f, const brunt_skin *s, double *out) {
    *out++ = f ? f->travelled : 0;
    for (int k = 0; k < s->fem_count; k++) *out++ = s->was_active[k];
    for (int32_t n = 0; n < s->node_count; n++, out += 7) {
        out[0] = f ? f->last[n] : -1;
        out[1] = f ? f->quiet[n].distance : 0, out[2] = f ? f->quiet[n].travelled : 0, out[3] = f ? f->quiet[n].second : 0;
        for (int a = 0; a < 3; a++) out[4 + a] = s->x[n][a];
    }
}

int brunt_facing_state_set(brunt_facing **facing, brunt_skin *s, int mpm_count, const double *in) {
    if (make_facing(facing, mpm_count, s->node_count)) return -1;
    brunt_facing *f = *facing;
    f->travelled = *in++;
    for (int k = 0; k < s->fem_count; k++) s->was_active[k] = *in++ != 0;
    for (int32_t n = 0; n < s->node_count; n++, in += 7) {
        f->last[n] = (int32_t)in[0];
        f->quiet[n] = (struct quiet){in[1], in[2], in[3]};
        for (int a = 0; a < 3; a++) s->x[n][a] = in[4 + a];
    }
    return 0;
}

int brunt_facing_near(const brunt_meeting *m, brunt_body *mpm, int mpm_count, const brunt_wall *walls, int wall_count,
                      double time, brunt_facing **facing) {
    brunt_skin *s = m->skin;
    if (make_facing(facing, mpm_count, s->node_count)) return -1;
    brunt_facing *f = *facing;
    // Nothing may pass anything unseen: the reach covers twice the fastest motion of a step, against the frame of all.
    double fastest = 0, spacing = 0;
    for (int k = 0; k < s->fem_count; k++) fastest = fmax(fastest, s->speed[k]);
    const double frame = sqrt(dot(s->frame, s->frame));
    for (int k = 0; k < mpm_count; k++) {
        spacing = fmax(spacing, mpm[k].spacing);
        for (int32_t b = 0; b < mpm[k].grid.block_count; b++) fastest = fmax(fastest, (double)mpm[k].report[b].speed + frame);
    }
    double walls_speed = 0;
    for (int w = 0; w < wall_count; w++)
        if (!walls[w].region) walls_speed = fmax(walls_speed, sqrt(dot(walls[w].plane.velocity, walls[w].plane.velocity)));
    f->wall_reach = (fastest + frame + walls_speed) * m->dt;
    f->reach = 2 * fastest * m->dt + spacing;
    f->range = fmax(fmax(RANGE * s->mean_edge + spacing, f->reach), m->look);
    if (find_boxes(m, mpm, mpm_count, f) || find_pairs(m, f)) return -1;
    for (int k = 0; k < s->fem_count; k++) {
        int32_t box = f->box_of[k];
        s->active[k] = f->near_first[box + 1] > f->near_first[box];
        for (int w = 0; w < wall_count && !s->active[k]; w++) s->active[k] = near_wall(s, k, &walls[w], time, f->wall_reach + 1e-6 * s->mean_edge);
    }
    f->grid_count = 0;
    if (RESERVE(f, support_of, s->node_count + 1)) return -1;
    for (int32_t n = 0; n < s->node_count; n++) f->support_of[n] = -1;
    return 0;
}

// ------------------------------------------------------------------------------------------ cells of facets

static bool in_reach(const brunt_facing *f, int32_t box, const double low[3], const double high[3], double by) {
    for (int32_t q = f->near_first[box]; q < f->near_first[box + 1]; q++) {
        const bounds *other = &f->box[f->near_list[q]];
        bool apart = false;
        for (int a = 0; a < 3; a++) apart = apart || low[a] - by > other->high[a] || other->low[a] - by > high[a];
        if (!apart) return true;
    }
    return false;
}

static void face_bounds(const brunt_skin *s, int32_t face, double low[3], double high[3]) {
    for (int a = 0; a < 3; a++) low[a] = INFINITY, high[a] = -INFINITY;
    for (int c = 0; c < 4 && s->face[face][c] >= 0; c++)
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], s->x[s->face[face][c]][a]);
            high[a] = fmax(high[a], s->x[s->face[face][c]][a]);
        }
}

static void cell_range(const brunt_facing *f, const double low[3], const double high[3], double by, int32_t from[3],
                       int32_t to[3]) {
    for (int a = 0; a < 3; a++) {
        double l = floor((low[a] - by - f->origin[a]) / f->cell), h = floor((high[a] + by - f->origin[a]) / f->cell);
        from[a] = (int32_t)fmax(0, fmin(l, f->n[a] - 1.0));
        to[a] = (int32_t)fmax(0, fmin(h, f->n[a] - 1.0));
    }
}

// Counts, or lists, the facets of every cell.
static void visit_cells(const brunt_meeting *m, brunt_facing *f, bool list) {
    const brunt_skin *s = m->skin;
    const double by = f->made_range + MARGIN * s->mean_edge;
    for (int k = 0; k < s->fem_count; k++) {
        if (f->near_first[f->box_of[k] + 1] == f->near_first[f->box_of[k]]) continue;
        for (int32_t face = s->face_range[k]; face < s->face_range[k + 1]; face++) {
            double low[3], high[3];
            int32_t from[3], to[3];
            face_bounds(s, face, low, high);
            if (!in_reach(f, f->box_of[k], low, high, 2 * by)) continue;
            cell_range(f, low, high, by, from, to);
            for (int32_t x = from[0]; x <= to[0]; x++)
                for (int32_t y = from[1]; y <= to[1]; y++)
                    for (int32_t z = from[2]; z <= to[2]; z++) {
                        size_t cell = ((size_t)x * (size_t)f->n[1] + (size_t)y) * (size_t)f->n[2] + (size_t)z;
                        if (list) f->cell_face[f->cell_first[cell + 1]++] = face;
                        else f->cell_first[cell + 2]++;
                    }
        }
    }
}

// The room that pairs share, cut into cells; few enough that making them costs no more than the facets do.
static void lay_cells(const brunt_meeting *m, brunt_facing *f) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int32_t p = 0; p < f->near_count; p++) {
        const bounds *a = &f->box[f->near[p].a], *b = &f->box[f->near[p].b];
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], fmax(a->low[k], b->low[k]) - 3 * f->made_range);
            high[k] = fmax(high[k], fmin(a->high[k], b->high[k]) + 3 * f->made_range);
        }
    }
    const double most = 32.0 * m->skin->face_count + 4096;
    f->cell = CELL * m->skin->mean_edge;
    for (;; f->cell *= 1.25) {
        double cells = 1;
        for (int k = 0; k < 3; k++) cells *= floor((high[k] - low[k]) / f->cell) + 1;
        if (cells <= most) break;
    }
    for (int k = 0; k < 3; k++) {
        f->origin[k] = low[k];
        f->n[k] = (int32_t)(floor((high[k] - low[k]) / f->cell) + 1);
    }
}

static int make_cells(const brunt_meeting *m, brunt_facing *f) {
    const brunt_skin *s = m->skin;
    f->made_range = 1.25 * f->range;
    lay_cells(m, f);
    size_t cells = (size_t)f->n[0] * (size_t)f->n[1] * (size_t)f->n[2];
    if (RESERVE(f, cell_first, cells + 3) || RESERVE(f, made_x, s->node_count + 1))
        return -1;
    memset(f->cell_first, 0, (cells + 3) * sizeof *f->cell_first);
    visit_cells(m, f, false);
    for (size_t c = 2; c <= cells + 1; c++) f->cell_first[c] += f->cell_first[c - 1];
    if (RESERVE(f, cell_face, f->cell_first[cells + 1] + 1)) return -1;
    visit_cells(m, f, true);
    for (int k = 0; k < s->fem_count; k++) {
        if (!s->active[k]) continue;
        memcpy(f->made_x + s->node_range[k], s->x + s->node_range[k],
               (size_t)(s->node_range[k + 1] - s->node_range[k]) * sizeof *s->x);
    }
    f->made = true;
    return 0;
}

// Whether the cells still hold all that may be near: nothing has moved further than they allow, and the same bodies are near.
static bool cells_hold(const brunt_meeting *m, const brunt_facing *f, uint64_t pairs) {
    const brunt_skin *s = m->skin;
    if (!f->made || f->made_near != f->near_count || f->made_pairs != pairs || f->range > f->made_range) return false;
    const double most = MARGIN * s->mean_edge, square = most * most;
    for (int k = 0; k < s->fem_count; k++) {
        if (!s->active[k]) continue;
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
            double d2 = 0;
            for (int a = 0; a < 3; a++) d2 += (s->x[n][a] - f->made_x[n][a]) * (s->x[n][a] - f->made_x[n][a]);
            if (d2 > square) return false;
        }
    }
    return true;
}

// A number that differs when other bodies are near or active.
static uint64_t pairs_key(const brunt_meeting *m, const brunt_facing *f) {
    uint64_t key = 1469598103934665603ull;
    for (int32_t p = 0; p < f->near_count; p++) {
        uint64_t a = (uint64_t)f->box[f->near[p].a].body, b = (uint64_t)f->box[f->near[p].b].body;
        uint64_t low = a < b ? a : b, high = a < b ? b : a;
        key += (low * 1000003u + high + 1) * 0x9E3779B97F4A7C15ull;
    }
    for (int k = 0; k < m->skin->fem_count; k++) key += m->skin->active[k] ? (uint64_t)(k + 1) * 1099511628211ull : 0;
    return key;
}

// ------------------------------------------------------------------------------------------ the nearest facet

typedef struct tied {
    brunt_closest at;
    int32_t face;
} tied;

// Keeps `found` among the nearest of its body; nearest points that are equally near belong to facets that share an edge or a
// corner there, and the one that most faces the place decides on which side of the surface it is.
typedef struct nearest {
    int32_t body, count;
    double square, root; // of the distance; a little more than its root
    tied tied[MAX_TIED];
} nearest;

static void keep(nearest *best, const brunt_closest *at, int32_t face) {
    const double same = 1e-9 * best->square;
    if (at->square < best->square - same) best->count = 0, best->square = at->square;
    else if (at->square > best->square + same) return;
    else if (at->square < best->square) best->square = at->square;
    best->root = sqrt(best->square) * (1 + 1e-8);
    if (best->count < MAX_TIED) best->tied[best->count++] = (tied){*at, face};
}

static const tied *most_facing(const nearest *best) {
    const tied *chosen = NULL;
    double most = -1;
    for (int32_t k = 0; k < best->count; k++) {
        double facing = best->tied[k].at.inside ? INFINITY : fabs(dot(best->tied[k].at.normal, best->tied[k].at.d));
        if (facing > most || (facing == most && best->tied[k].face < chosen->face)) most = facing, chosen = &best->tied[k];
    }
    return chosen;
}

// A hit on facets that face the slave; beside an edge or a corner it must also face the way to them.
static bool hit_facing(const brunt_skin *s, const nearest *best, const double *normal, hit *out) {
    const tied *chosen = most_facing(best);
    const brunt_closest *at = &chosen->at;
    double height = dot(at->normal, at->d), distance = sqrt(at->square);
    *out = (hit){.face = chosen->face, .triangle = at->triangle, .body = best->body, .gap = height};
    memcpy(out->n, at->normal, sizeof out->n);
    if (!at->inside && height >= 0 && distance > 1e-6 * sqrt(s->face_area[chosen->face])) {
        out->gap = distance;
        for (int a = 0; a < 3; a++) out->n[a] = at->d[a] / distance;
    }
    return !normal || -dot(out->n, normal) > OPPOSED;
}

// A hit on whatever facet is nearest, when the slave is behind it.
static bool hit_behind(const nearest *best, const double *normal, hit *out) {
    const tied *chosen = most_facing(best);
    const brunt_closest *at = &chosen->at;
    double height = dot(at->normal, at->d);
    if (!(height < 0) || -dot(at->normal, normal) <= ASKEW) return false;
    *out = (hit){.face = chosen->face, .triangle = at->triangle, .body = best->body, .gap = height};
    memcpy(out->n, at->normal, sizeof out->n);
    return true;
}

static int64_t cell_of(const brunt_facing *f, const double x[3]) {
    int64_t cell = 0;
    for (int a = 0; a < 3; a++) {
        double c = floor((x[a] - f->origin[a]) / f->cell);
        if (!(c >= 0) || c >= f->n[a]) return -1;
        cell = cell * f->n[a] + (int64_t)c;
    }
    return cell;
}

static bool near_box(const double box[6], const double x[3], double by) {
    return x[0] >= box[0] - by && x[0] <= box[3] + by && x[1] >= box[1] - by && x[1] <= box[4] + by &&
           x[2] >= box[2] - by && x[2] <= box[5] + by;
}

// Someone who looks around: which bodies may be touched (their boxes are that near), and which may have been entered.
typedef struct looker {
    int32_t box, body;
    const double *x, *normal; // outward; NULL when it has none
    int64_t cell;
    int32_t touch[MAX_NEAR], touches, enter[MAX_NEAR], enters;
} looker;

static bool within(const bounds *box, const double x[3], double by) {
    for (int a = 0; a < 3; a++)
        if (x[a] < box->low[a] - by || x[a] > box->high[a] + by) return false;
    return true;
}

static bool look(const brunt_facing *f, looker *l) {
    l->touches = l->enters = 0;
    for (int32_t q = f->near_first[l->box]; q < f->near_first[l->box + 1] && l->touches < MAX_NEAR; q++) {
        const bounds *other = &f->box[f->near_list[q]];
        if (other->fem < 0 || !within(other, l->x, f->range)) continue;
        l->touch[l->touches++] = other->body;
        if (within(other, l->x, 0)) l->enter[l->enters++] = other->body;
    }
    l->cell = l->touches ? cell_of(f, l->x) : -1;
    return l->cell >= 0;
}

static bool is_among(int32_t body, const int32_t *list, int32_t count) {
    for (int32_t k = 0; k < count; k++)
        if (list[k] == body) return true;
    return false;
}

// The two nearest facets of all, whichever way they face.
typedef struct two_nearest {
    int32_t face;
    double first, second; // squares of their distances
} two_nearest;

// The nearest facets in a cell of each body in `list`, among those that face `normal` by more than `least`. How many bodies.
// `guess`: a face that may well be the nearest, -1; it saves looking closely at most others. `all`: also notes the two nearest
// facets of any direction, as far as `slack` beyond the nearest; may be NULL.
static int find_nearest(const brunt_meeting *m, const brunt_facing *f, const looker *l, const double *normal, double least,
                        const int32_t *list, int32_t count, int32_t guess, double slack, two_nearest *all,
                        nearest best[MAX_HITS]) {
    const brunt_skin *s = m->skin;
    const double range2 = f->range * f->range;
    double bound = INFINITY; // of the one body that the guess belongs to
    brunt_closest guessed;
    if (guess >= 0) guessed = brunt_closest_on_face(s, guess, l->x), bound = sqrt(guessed.square) * (1 + 1e-8);
    int bodies = 0;
    if (all) *all = (two_nearest){-1, range2, range2};
    for (int32_t q = f->cell_first[l->cell]; q < f->cell_first[l->cell + 1]; q++) {
        const int32_t face = f->cell_face[q], other = s->face_body[face];
        if (other == l->body) continue;
        int b = 0;
        while (b < bodies && best[b].body != other) b++;
        double reach = b < bodies ? best[b].root : f->range;
        if (guess >= 0 && bound < reach && s->face_body[guess] == other) reach = bound;
        if (!near_box(s->face_box[face], l->x, reach + slack)) continue;
        const bool faces = !normal || -dot(s->face_normal[face], normal) > least;
        if ((!faces && !all) || !is_among(other, list, count)) continue;
        brunt_closest at = face == guess ? guessed : brunt_closest_on_face(s, face, l->x);
        if (at.square > range2) continue;
        if (all && at.square < all->first) all->second = all->first, all->first = at.square, all->face = face;
        else if (all && at.square < all->second) all->second = at.square;
        if (!faces) continue;
        if (b == bodies) {
            if (b == MAX_HITS) continue;
            best[b].body = other, best[b].count = 0, best[b].square = range2, best[b].root = f->range;
            bodies++;
        }
        keep(&best[b], &at, face);
    }
    return bodies;
}

// What someone meets of each other body. Facets that face the slave come first: a node that slides in under a block meets its
// underside, not the wall it came through. Only a slave that has none of those close by, and is inside, is sent out through the
// nearest facet there is. Tells how far the nearest facet is, or how far was looked, and how far the nearest but the one hit.
static void look_around(const brunt_meeting *m, const brunt_facing *f, const looker *l, int32_t guess, slave_hits *out,
                        double *distance, double *second) {
    const brunt_skin *s = m->skin;
    nearest facing[MAX_HITS], any[MAX_HITS];
    two_nearest two;
    const double close = CLOSE * s->mean_edge, slack = SLACK * s->mean_edge;
    out->count = 0;
    if (guess >= 0 && (!is_among(s->face_body[guess], l->touch, l->touches) ||
                       (l->normal && -dot(s->face_normal[guess], l->normal) <= OPPOSED)))
        guess = -1;
    int bodies = find_nearest(m, f, l, l->normal, OPPOSED, l->touch, l->touches, guess, slack, &two, facing), unresolved = 0;
    int32_t entered[MAX_NEAR];
    for (int32_t k = 0; l->normal && k < l->enters; k++) {
        bool resolved = false;
        for (int b = 0; b < bodies; b++)
            resolved = resolved || (facing[b].body == l->enter[k] && facing[b].count && facing[b].square <= close * close);
        if (!resolved) entered[unresolved++] = l->enter[k];
    }
    int all = unresolved ? find_nearest(m, f, l, NULL, 0, entered, unresolved, -1, 0, NULL, any) : 0;
    for (int b = 0; b < all; b++) {
        if (!any[b].count || !hit_behind(&any[b], l->normal, &out->hits[out->count])) continue;
        out->count++;
        for (int k = 0; k < bodies; k++)
            if (facing[k].body == any[b].body) facing[k].count = 0;
    }
    // Whoever is before the nearest facet of all is outside, even if the nearest facet that faces him is seen from behind.
    bool outside = false;
    if (two.face >= 0) {
        brunt_closest at = brunt_closest_on_face(s, two.face, l->x);
        double height = dot(at.normal, at.d);
        outside = height > 1e-6 * s->mean_edge && height > 0.1 * sqrt(at.square);
    }
    const bool plain = out->count == 0 && l->enters <= 1;
    for (int b = 0; b < bodies && out->count < MAX_HITS; b++) {
        hit *h = &out->hits[out->count];
        if (!facing[b].count || !hit_facing(s, &facing[b], l->normal, h)) continue;
        if (!(h->gap < 0 && outside && h->body == s->face_body[two.face])) out->count++;
    }
    *distance = outside || two.face < 0 ? fmin(f->range, sqrt(two.first)) : 0;
    *second = 0;
    if (plain && out->count == 1 && two.face == out->hits[0].face)
        *second = fmin(fmin(f->range, sqrt(two.second)), *distance + slack) * (1 - 1e-8);
}

// ------------------------------------------------------------------------------------------ boundary nodes

typedef struct job {
    const brunt_meeting *m;
    brunt_facing *f;
    brunt_contact_points *points;
    int32_t entry_base, point_base;
} job;

// Least velocity along the normal: to arrive at the surface, not past it. What is behind it is pushed out, but no faster than half
// as fast as it came, by which no impact gains energy. What rests comes anew each step, as the load brings it: pushing that out
// does work, and is only done over the small depths that unfinished sweeps leave; deeper ones wait until they part by themselves.
static double target_of(const brunt_skin *s, double gap, double approach, double before, double dt) {
    if (gap >= 0) return -gap / dt;
    double came = gap > -SHALLOW * s->mean_edge ? approach : before;
    return fmin(PUSH * -gap / dt, BOUNCE * fmax(0, -came));
}

// Velocity of x relative to the facet under it, along n.
static double approach_of(const brunt_skin *s, const hit *h, const double x[3], const double v[3], double (*of)[3]) {
    double weight[4], along = dot(v, h->n);
    brunt_face_values(s, h->face, h->triangle, x, weight);
    for (int c = 0; c < 4 && s->face[h->face][c] >= 0; c++) along -= weight[c] * dot(of[s->face[h->face][c]], h->n);
    return along;
}

// The facet that was the nearest, when it is certain that it still is: it is nearer than `least`, which no other one is.
static bool still_nearest(const brunt_meeting *m, const brunt_facing *f, int32_t n, const double *normal, double least,
                          slave_hits *out) {
    const brunt_skin *s = m->skin;
    const int32_t face = f->last[n];
    if (face < 0 || (normal && -dot(s->face_normal[face], normal) <= OPPOSED)) return false;
    nearest one = {.body = s->face_body[face], .count = 1, .tied = {{brunt_closest_on_face(s, face, s->x[n]), face}}};
    const double square = one.tied[0].at.square, close = CLOSE * s->mean_edge;
    if (square >= least * least || square > close * close || square > f->range * f->range) return false;
    out->count = hit_facing(s, &one, normal, &out->hits[0]) ? 1 : 0;
    return true;
}

static void find_node(const job *j, int k, int32_t n) {
    const brunt_meeting *m = j->m;
    brunt_facing *f = j->f;
    brunt_skin *s = m->skin;
    slave_hits seen, *found = &seen;
    const double *normal = s->normal[n];
    bool faces = normal[0] != 0 || normal[1] != 0 || normal[2] != 0;
    struct quiet *quiet = &f->quiet[n];
    const double since = f->travelled - quiet->travelled;
    if (quiet->distance - since > f->reach) return;
    if (!(since < quiet->second && still_nearest(m, f, n, faces ? normal : NULL, quiet->second - since, found))) {
        looker l = {.box = f->box_of[k], .body = s->body[n], .x = s->x[n], .normal = faces ? normal : NULL};
        quiet->travelled = f->travelled, quiet->distance = f->range, quiet->second = 0;
        if (!look(f, &l)) {
            if (l.touches) quiet->distance = 0; // near, but outside the cells
            return;
        }
        look_around(m, f, &l, f->last[n], found, &quiet->distance, &quiet->second);
        if (l.touches == MAX_NEAR) quiet->distance = quiet->second = 0; // there may be more bodies than were looked at
        if (found->count) f->last[n] = found->hits[0].face;
    }
    int32_t kept = 0;
    for (int32_t q = 0; q < found->count; q++) {
        hit *h = &found->hits[q];
        if (h->gap > f->reach) continue;
        s->gap[n] = fmin(s->gap[n], h->gap);
        double approach = approach_of(s, h, s->x[n], s->v[n], s->v);
        h->target = target_of(s, h->gap, approach, h->gap < 0 ? approach_of(s, h, s->x[n], s->old[n], s->old) : 0, m->dt);
        if (approach < h->target + 1e-6 * s->mean_edge / m->dt)
            f->hits[MAX_HITS * n + kept++] = *h;
    }
    f->found[n] = (uint8_t)kept;
}

static void find_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    const brunt_skin *s = j->m->skin;
    const brunt_facing *f = j->f;
    int k = 0;
    for (int32_t n = (int32_t)begin; n < end; n++) {
        while (s->node_range[k + 1] <= n) k++;
        j->f->found[n] = 0;
        if (s->active[k] && f->near_first[f->box_of[k] + 1] > f->near_first[f->box_of[k]]) find_node(j, k, n);
    }
}

static int face_corners(const brunt_skin *s, int32_t face) { return s->face[face][2] < 0 ? 2 : s->face[face][3] < 0 ? 3 : 4; }

static void fill_point(const brunt_meeting *m, const hit *h, const double x[3], int body, brunt_contact_point *point) {
    brunt_pair *pair = &m->pairs[m->pair_of[body * m->body_count + h->body]];
    memcpy(point->x, x, sizeof point->x);
    memcpy(point->n, h->n, sizeof point->n);
    point->gap = h->gap;
    point->friction = pair->friction;
    point->action = &pair->last;
    point->sign = body > h->body ? 1 : -1;
}

// The master's entries; sets the point's facet.
static void fill_master(const brunt_skin *s, const brunt_facing *f, const hit *h, const double x[3],
                        brunt_contact_point *point, brunt_contact_entry *entry) {
    double weight[4], gradient[4][3], height;
    brunt_face_weights(s, h->face, h->triangle, x, weight, gradient, point->facet, &height);
    for (int c = 0; c < face_corners(s, h->face); c++) {
        entry[c] = (brunt_contact_entry){.support = f->support_of[s->face[h->face][c]], .weight = -weight[c]};
        for (int a = 0; a < 3; a++) entry[c].turn[a] = height * gradient[c][a];
    }
}

// What is a node's of the surface that faces against n [m^2].
static double area_towards(const brunt_skin *s, int32_t n, const double direction[3]) {
    double area = 0;
    for (int32_t q = s->face_first[n]; q < s->face_first[n + 1]; q++) {
        int32_t f = s->face_of[q];
        double cosine = -dot(s->face_normal[f], direction);
        if (cosine > 0.5) area += cosine * s->face_area[f] / face_corners(s, f);
    }
    return area;
}

static void fill_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    const brunt_meeting *m = j->m;
    const brunt_skin *s = m->skin;
    brunt_facing *f = j->f;
    for (int32_t n = (int32_t)begin; n < end; n++) {
        int32_t at = f->first_point[2 * n], entry = f->first_point[2 * n + 1];
        for (int32_t q = 0; q < f->found[n]; q++, at++) {
            const hit *h = &f->hits[MAX_HITS * n + q];
            brunt_contact_point *point = &j->points->point[at];
            *point = (brunt_contact_point){.first = entry, .count = 1 + face_corners(s, h->face), .tag = n};
            fill_point(m, h, s->x[n], s->body[n], point);
            point->area = 0.5 * area_towards(s, n, h->n); // the other half is counted on the other side
            j->points->entry[entry] = (brunt_contact_entry){.support = f->support_of[n], .weight = 1};
            fill_master(s, f, h, s->x[n], point, j->points->entry + entry + 1);
            point->target = h->target;
            entry += point->count;
        }
    }
}

// The support of a skin node, made when it is first asked for. -1: out of memory.
static int32_t skin_support(brunt_facing *f, const brunt_skin *s, int32_t n, brunt_contact_points *points) {
    if (f->support_of[n] >= 0) return f->support_of[n];
    int32_t at = brunt_points_support(points);
    if (at < 0) return -1;
    brunt_support *support = &points->support[at];
    memcpy(support->v, s->v[n], sizeof support->v);
    memcpy(support->old, s->old[n], sizeof support->old);
    memcpy(support->inverse, s->inverse[n], sizeof support->inverse);
    return f->support_of[n] = at;
}

static int add_nodes(const brunt_meeting *m, brunt_facing *f, brunt_contact_points *points) {
    const brunt_skin *s = m->skin;
    int32_t point = points->point_count, entry = points->entry_count;
    if (RESERVE(f, first_point, 2 * (size_t)s->node_count + 2)) return -1;
    for (int32_t n = 0; n < s->node_count; n++) {
        f->first_point[2 * n] = point, f->first_point[2 * n + 1] = entry;
        for (int32_t q = 0; q < f->found[n]; q++) {
            const int32_t face = f->hits[MAX_HITS * n + q].face;
            if (skin_support(f, s, n, points) < 0) return -1;
            for (int c = 0; c < face_corners(s, face); c++)
                if (skin_support(f, s, s->face[face][c], points) < 0) return -1;
            point++, entry += 1 + face_corners(s, face);
        }
    }
    if (brunt_points_room(points, point, entry)) return -1;
    points->point_count = point, points->entry_count = entry;
    job j = {.m = m, .f = f, .points = points};
    brunt_parallel(m->threads, s->node_count, GRAIN, fill_nodes, &j, m->seconds);
    return 0;
}

// ------------------------------------------------------------------------------------------ material points

static int32_t grid_support(brunt_facing *f, brunt_body *mpm, int k, real *node, brunt_contact_points *points) {
    int64_t number = (node - mpm->grid.nodes) / BRUNT_NODE_REALS;
    int32_t *index = &f->node_support[k][number];
    if (*index) return *index - 1;
    if (brunt_reserve((void **)&f->grid, &f->grid_capacity, ((size_t)f->grid_count + 1) * sizeof *f->grid,
                      (size_t)f->grid_count * sizeof *f->grid))
        return -1;
    int32_t at = brunt_points_support(points);
    if (at < 0) return -1;
    for (int a = 0; a < mpm->grid.dim; a++) {
        points->support[at].v[a] = (double)node[BRUNT_NODE_VELOCITY + a];
        points->support[at].old[a] = (double)node[BRUNT_NODE_OLD + a];
        points->support[at].inverse[a] = 1 / (double)node[BRUNT_NODE_MASS];
    }
    f->grid[f->grid_count].mpm = k, f->grid[f->grid_count].node = number, f->grid[f->grid_count++].support = at;
    *index = at + 1;
    return at;
}

// Nodes and weights under particle `s` of block `b`, at most 64. Their count.
static int particle_nodes(brunt_body *body, int32_t b, int64_t s, real *node[64], double weight[64]) {
    brunt_grid *grid = &body->grid;
    const int dim = grid->dim, n = grid->order + 1;
    int local[3], count = 0;
    int32_t base[3] = {0, 0, 0};
    double w[3][4] = {{1}, {1}, {1}};
    brunt_node_local(grid, body->particles.bin[s], local);
    real *const *x = brunt_field(&body->particles, BRUNT_FIELD_position);
    for (int a = 0; a < dim; a++) {
        base[a] = grid->blocks[b].coord[a] * grid->side + local[a];
        brunt_kernel_weights(grid->order, ((double)x[a][s] - grid->origin[a]) / (double)grid->h - base[a], w[a]);
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            for (int l = 0; l < (dim == 3 ? n : 1); l++) {
                const int32_t at[3] = {base[0] + i, base[1] + k, base[2] + l};
                real *found = brunt_grid_node(grid, at);
                if (!found || !(found[BRUNT_NODE_MASS] > 0)) continue;
                node[count] = found;
                weight[count++] = w[0][i] * w[1][k] * w[2][l];
            }
    return count;
}

static int add_particle(const brunt_meeting *m, brunt_facing *f, brunt_body *body, int k, int32_t b, int64_t s,
                        const double x[3], const hit *h, brunt_contact_points *points) {
    const brunt_skin *skin = m->skin;
    real *node[64];
    double weight[64], v[3] = {0}, old[3] = {0};
    int count = particle_nodes(body, b, s, node, weight);
    for (int e = 0; e < count; e++)
        for (int a = 0; a < body->grid.dim; a++) {
            v[a] += weight[e] * (double)node[e][BRUNT_NODE_VELOCITY + a];
            old[a] += weight[e] * (double)node[e][BRUNT_NODE_OLD + a];
        }
    double approach = approach_of(skin, h, x, v, skin->v);
    double target = target_of(skin, h->gap, approach, approach_of(skin, h, x, old, skin->old), m->dt);
    if (!(approach < target + 1e-6 * skin->mean_edge / m->dt)) return 0;
    int corner = face_corners(skin, h->face);
    for (int c = 0; c < corner; c++)
        if (skin_support(f, skin, skin->face[h->face][c], points) < 0) return -1;
    int32_t at = brunt_points_add(points);
    if (at < 0) return -1;
    fill_point(m, h, x, body->index, &points->point[at]);
    points->point[at].target = target, points->point[at].tag = -1;
    points->point[at].area = body->grid.dim == 3 ? body->spacing * body->spacing : body->spacing;
    for (int e = 0; e < count; e++) {
        int32_t support = grid_support(f, body, k, node[e], points);
        if (support < 0 || brunt_points_entry(points, support, weight[e]) < 0) return -1;
    }
    brunt_contact_entry master[4];
    fill_master(skin, f, h, x, &points->point[at], master);
    for (int c = 0; c < corner; c++) {
        int32_t entry = brunt_points_entry(points, master[c].support, master[c].weight);
        if (entry < 0) return -1;
        points->entry[entry] = master[c];
    }
    return 0;
}

static int add_particles(const brunt_meeting *m, brunt_facing *f, brunt_body *body, int k, int32_t box,
                         brunt_contact_points *points) {
    const brunt_grid *grid = &body->grid;
    brunt_particles *p = &body->particles;
    const int dim = grid->dim;
    const size_t nodes = (size_t)grid->slot_count * BRUNT_BLOCK_NODES;
    if (brunt_reserve((void **)&f->node_support[k], &f->node_support_capacity[k], nodes * sizeof(int32_t), 0)) return -1;
    memset(f->node_support[k], 0, nodes * sizeof(int32_t));
    real *const *place = brunt_field(p, BRUNT_FIELD_position), *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    const real *reach = brunt_field(p, BRUNT_FIELD_reach)[0];
    for (int32_t b = 0; b < grid->block_count; b++) {
        double low[3] = {0}, high[3] = {0};
        for (int a = 0; a < dim; a++) {
            low[a] = grid->origin[a] + (double)grid->h * grid->blocks[b].coord[a] * grid->side;
            high[a] = low[a] + (double)grid->h * (grid->side + 1);
        }
        if (!in_reach(f, box, low, high, f->range)) continue;
        for (int64_t s = grid->blocks[b].first; s < grid->blocks[b].first + grid->blocks[b].count; s++) {
            double x[3] = {0};
            for (int a = 0; a < dim; a++) x[a] = (double)place[a][s];
            slave_hits found;
            looker l = {.box = box, .body = body->index, .x = x};
            if (!look(f, &l)) continue;
            double distance, second;
            look_around(m, f, &l, -1, &found, &distance, &second);
            for (int32_t q = 0; q < found.count; q++) {
                double square = 0;
                for (int c = 0; c < dim; c++) {
                    double t = 0;
                    for (int r = 0; r < dim; r++) t += (double)F[r * dim + c][s] * found.hits[q].n[r];
                    square += t * t;
                }
                found.hits[q].gap -= (double)reach[s] * sqrt(square);
                if (add_particle(m, f, body, k, b, s, x, &found.hits[q], points)) return -1;
            }
        }
    }
    return 0;
}

int brunt_facing_find(const brunt_meeting *m, brunt_body *mpm, int mpm_count, brunt_facing *f,
                      brunt_contact_points *points) {
    const brunt_skin *s = m->skin;
    f->travelled += 2 * s->moved;
    if (!(f->travelled < 1e300)) { // somebody new: nothing is known of distances
        f->travelled = 0;
        for (int32_t n = 0; f->quiet && n < s->node_count; n++) f->quiet[n].distance = f->quiet[n].second = 0;
    }
    if (!f->near_count) return 0;
    uint64_t key = pairs_key(m, f);
    if (!cells_hold(m, f, key)) {
        if (make_cells(m, f)) return -1;
        f->made_near = f->near_count, f->made_pairs = key;
    }
    job j = {.m = m, .f = f, .points = points};
    brunt_parallel(m->threads, s->node_count, GRAIN, find_nodes, &j, m->seconds);
    if (add_nodes(m, f, points)) return -1;
    for (int k = 0; k < mpm_count; k++) {
        int32_t box = 0;
        while (f->box[box].mpm != k) box++;
        if (f->near_first[box + 1] > f->near_first[box] && add_particles(m, f, &mpm[k], k, box, points)) return -1;
    }
    return 0;
}

// ------------------------------------------------------------------------------------------ walls

// Holds a node on a plane: stick takes all components, slip and symmetry the normal one.
static void hold(brunt_skin *s, int32_t n, brunt_wall *wall, double normal_velocity, bool stick) {
    const brunt_plane_def *plane = &wall->plane;
    double now[3], J[3], old[3], along = 0;
    for (int a = 0; a < 3; a++) along += plane->normal[a] * (s->v[n][a] - plane->velocity[a]);
    for (int a = 0; a < 3; a++) {
        now[a] = stick ? plane->velocity[a] + normal_velocity * plane->normal[a]
                       : s->v[n][a] + (normal_velocity - along) * plane->normal[a];
        J[a] = s->mass[n] * (now[a] - s->v[n][a]);
        if (!(s->inverse[n][a] > 0)) now[a] = s->v[n][a], J[a] = 0;
        old[a] = s->old[n][a];
    }
    brunt_action_book(&wall->last, &wall->last.normal_loss, J, s->x[n], old, now, plane->velocity);
    for (int a = 0; a < 3; a++) {
        s->v[n][a] = now[a];
        if (stick || fabs(plane->normal[a]) > 1 - 1e-12) s->inverse[n][a] = 0;
    }
}

static int push_off(const brunt_meeting *m, brunt_facing *f, int32_t n, brunt_wall *wall, double gap,
                    brunt_contact_points *points) {
    const brunt_skin *s = m->skin;
    const brunt_plane_def *plane = &wall->plane;
    double approach = 0, before = 0;
    for (int a = 0; a < 3; a++) {
        approach += plane->normal[a] * (s->v[n][a] - plane->velocity[a]);
        before += plane->normal[a] * (s->old[n][a] - plane->velocity[a]);
    }
    double target = target_of(s, gap, approach, before, m->dt);
    if (!(approach < target + 1e-6 * s->mean_edge / m->dt)) return 0;
    int32_t at = brunt_points_add(points), support = skin_support(f, s, n, points);
    if (at < 0 || support < 0) return -1;
    brunt_contact_point *point = &points->point[at];
    memcpy(point->x, s->x[n], sizeof point->x);
    memcpy(point->n, plane->normal, sizeof point->n);
    memcpy(point->plane, plane->velocity, sizeof point->plane);
    point->gap = gap, point->target = target, point->friction = plane->friction;
    point->action = &wall->last, point->sign = 1, point->tag = n, point->area = area_towards(s, n, plane->normal);
    return brunt_points_entry(points, support, 1) < 0 ? -1 : 0;
}

int brunt_facing_walls(const brunt_meeting *m, brunt_wall *walls, int wall_count, double time, brunt_facing *f,
                       brunt_contact_points *points) {
    brunt_skin *s = m->skin;
    const double on = 1e-6 * s->mean_edge;
    for (int w = 0; w < wall_count; w++) {
        brunt_wall *wall = &walls[w];
        const brunt_condition condition = wall->plane.condition;
        if (wall->region) continue;
        for (int k = 0; k < s->fem_count; k++) {
            if (!s->active[k] || !near_wall(s, k, wall, time, f->wall_reach + on)) continue;
            for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++) {
                double gap = plane_distance(&wall->plane, time, s->x[n]);
                if (gap > f->wall_reach + on) continue;
                if (condition == BRUNT_SEPARATE) {
                    s->gap[n] = fmin(s->gap[n], gap);
                    if (push_off(m, f, n, wall, gap, points)) return -1;
                    continue;
                }
                double along = 0;
                for (int a = 0; a < 3; a++) along += wall->plane.normal[a] * (s->v[n][a] - wall->plane.velocity[a]);
                if (gap <= on) hold(s, n, wall, 0, condition == BRUNT_STICK);
                else if (gap + along * m->dt < 0) hold(s, n, wall, -gap / m->dt, condition == BRUNT_STICK);
            }
        }
    }
    return 0;
}

// ------------------------------------------------------------------------------------------ the way back

static void note_state(brunt_skin *s, const brunt_contact_points *points) {
    for (int32_t k = 0; k < points->point_count; k++) {
        const brunt_contact_point *p = &points->point[k];
        if (p->tag < 0 || !(p->push > 0)) continue;
        bool slips = p->slips || !(p->friction > 0);
        if (slips) s->state[p->tag] = 2;
        else if (!s->state[p->tag]) s->state[p->tag] = 1;
    }
}

void brunt_facing_finish(const brunt_meeting *m, brunt_body *mpm, brunt_facing *f, const brunt_contact_points *points) {
    brunt_skin *s = m->skin;
    for (int32_t n = 0; n < s->node_count; n++) {
        int32_t at = f->support_of[n];
        if (at < 0) continue;
        for (int a = 0; a < 3; a++) {
            s->impulse[n][a] = points->support[at].impulse[a];
            if (s->inverse[n][a] > 0) s->v[n][a] = points->support[at].v[a];
        }
    }
    for (int32_t g = 0; g < f->grid_count; g++) {
        brunt_body *body = &mpm[f->grid[g].mpm];
        real *node = body->grid.nodes + f->grid[g].node * BRUNT_NODE_REALS;
        for (int a = 0; a < body->grid.dim; a++)
            node[BRUNT_NODE_VELOCITY + a] = (real)points->support[f->grid[g].support].v[a];
    }
    note_state(s, points);
}
