// Which boundary particles material points reach with their own boxes.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "boundary/boundary_surface.h"
#include "grid/grid.h"
#include "materials/material.h"

// Boxes are taken somewhat larger than they are: what is held at its own face leaves it by rounding and drift, and must
// be held on. Of a spacing, beyond the half of it.
static const double MARGIN = 0.1;
static const double ROUNDING_SHARE = 1e-9;
// Spacings: how far material may be behind a surface and still be pushed out; of a thin wall half way through it.
static const double BEHIND = 1;
static const double AGAINST = -0.5; // cosine between normals of the two sides of a wall

// The own box of a material point: a cube of half edge `half` [m], turned as the body was placed and deformed: F is of
// both.
typedef struct point_box {
    double x[3], F[9], inverse[9], half, extent[3];
} point_box;

static void invert(int dim, const double *F, double *out) {
    if (dim == 2) {
        const double J = F[0] * F[3] - F[1] * F[2];
        out[0] = F[3] / J, out[1] = -F[1] / J, out[2] = -F[2] / J, out[3] = F[0] / J;
        return;
    }
    double cofactor[9], J = 0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            const int i = (r + 1) % 3, j = (r + 2) % 3, k = (c + 1) % 3, l = (c + 2) % 3;
            cofactor[3 * c + r] = F[3 * i + k] * F[3 * j + l] - F[3 * i + l] * F[3 * j + k];
        }
    for (int c = 0; c < 3; c++) J += F[c] * cofactor[3 * c];
    for (int k = 0; k < 9; k++) out[k] = cofactor[k] / J;
}

// Fluids remember no shape: theirs are cubes of the same volume.
static void make_round(int dim, double *F) {
    const double J = dim == 2 ? F[0] * F[3] - F[1] * F[2]
                              : F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
                                    F[2] * (F[3] * F[7] - F[4] * F[6]);
    const double size = pow(J, 1.0 / dim);
    for (int k = 0; k < dim * dim; k++) F[k] = k % (dim + 1) ? 0 : size;
}

static point_box box_of(brunt_body *body, int64_t s, const double *frame) {
    brunt_particles *p = &body->particles;
    const int dim = p->dim, stride = p->point_dim;
    real *const *x = brunt_field(p, BRUNT_FIELD_position), *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    point_box box = {.half = 0.5 * pow((double)brunt_field(p, BRUNT_FIELD_reference_volume)[0][s], 1.0 / dim)};
    for (int a = 0; a < dim; a++) box.x[a] = (double)x[a][s];
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++)
            for (int k = 0; k < dim; k++) box.F[r * dim + c] += (double)F[r * stride + k][s] * frame[3 * k + c];
    if (body->material.model[BRUNT_STRENGTH]->fluid) make_round(dim, box.F);
    invert(dim, box.F, box.inverse);
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) box.extent[r] += box.half * fabs(box.F[r * dim + c]);
    return box;
}

static void pull_back(int dim, const point_box *box, const double *d, double *out) {
    for (int r = 0; r < dim; r++) {
        out[r] = 0;
        for (int c = 0; c < dim; c++) out[r] += box->inverse[r * dim + c] * d[c];
    }
}

static bool inside(int dim, const point_box *box, const double *d) {
    double local[3];
    pull_back(dim, box, d, local);
    for (int a = 0; a < dim; a++)
        if (fabs(local[a]) > (1 + 2 * MARGIN) * box->half) return false;
    return true;
}

// Where a ray from d, relative to the box, along n enters it and leaves it [m]; false: it does not.
static bool crosses(int dim, const point_box *box, const double *d, const double *n, double *enter, double *leave) {
    double from[3], along[3];
    const double half = box->half * (1 + ROUNDING_SHARE);
    pull_back(dim, box, d, from);
    pull_back(dim, box, n, along);
    *enter = -INFINITY, *leave = INFINITY;
    for (int a = 0; a < dim; a++) {
        if (along[a] == 0) {
            if (fabs(from[a]) > half) return false;
            continue;
        }
        const double one = (-half - from[a]) / along[a], other = (half - from[a]) / along[a];
        *enter = fmax(*enter, fmin(one, other)), *leave = fmin(*leave, fmax(one, other));
    }
    return *enter <= *leave;
}

typedef struct search {
    const brunt_boundary_surface *s;
    double *gap;
    int dim;
    const brunt_boundary_turned *turned; // NULL: it does not turn
    point_box box;    // of the point that looks, its place as the surface was at the start, if that does not turn
    double coming[3]; // [m] how far it goes within the step, as the surface sees it, if that does not turn
    struct sides *sides;
} search;

enum { IN_FRONT = 1, BEHIND_IT = 2, DEEP = 4 };

// On which sides of a surface points are, where that is asked for.
typedef struct sides {
    int64_t front, behind; // points at boundary particles
    uint8_t *mark;         // of each boundary particle: a point near it in front, one behind, one too deep
} sides;

// Where the ray out of a boundary particle enters and leaves the box. Explicit steps push nothing out that is behind as
// a whole, implicit ones what is so by a spacing.
static void take_side(const search *l, int32_t b, double enter, double leave) {
    const double spacing = 2 * l->box.half, depth = -0.5 * (enter + leave),
                 lost = (MARGIN + (l->s->facets.count ? 0 : BEHIND)) * spacing;
    uint8_t *mark = &l->sides->mark[b];
    if (fabs(depth) <= (1 + MARGIN) * spacing) {
        *(depth <= 0 ? &l->sides->front : &l->sides->behind) += 1;
        *mark |= depth <= 0 ? IN_FRONT : BEHIND_IT;
    }
    if (leave < -lost && leave > -lost - (1 + MARGIN) * spacing) *mark |= DEEP;
}

// How far the point goes within the step, as boundary particle b sees it [m].
static void take_coming(const search *l, int32_t b, double coming[3]) {
    for (int a = 0; a < 3; a++) coming[a] = l->coming[a] - (l->turned ? l->turned->goes[b][a] : 0);
}

static void look_at(search *l, int32_t b) {
    const brunt_boundary_particle *p = brunt_boundary_surface_particle(l->s, b);
    double d[3], coming[3], enter, leave, towards = 0;
    take_coming(l, b, coming);
    for (int a = 0; a < l->dim; a++) d[a] = p->x[a] - l->box.x[a], towards -= coming[a] * p->normal[a];
    if (l->s->def.condition != BRUNT_SEPARATE) {
        if (inside(l->dim, &l->box, d)) l->gap[b] = 0;
        return;
    }
    if (!crosses(l->dim, &l->box, d, p->normal, &enter, &leave)) return;
    if (l->sides) {
        take_side(l, b, enter, leave);
        return;
    }
    if (leave < -fmin(2 * BEHIND * l->box.half, 0.5 * p->back) || enter > fmax(0, towards) + 2 * MARGIN * l->box.half)
        return;
    l->gap[b] = fmin(l->gap[b], fmax(enter, 0));
}

int32_t brunt_boundary_surface_cell(const brunt_boundary_surface *s, const int32_t at[3]) {
    const uint64_t key = brunt_key(at);
    int32_t low = 0, high = s->cells;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (s->key[middle] < key)
            low = middle + 1;
        else
            high = middle;
    }
    return low < s->cells && s->key[low] == key ? low : BRUNT_NONE;
}

static void look_in_cell(search *l, const int32_t at[3]) {
    const int32_t cell = brunt_boundary_surface_cell(l->s, at);
    if (cell < 0) return;
    for (int32_t k = l->s->cell_first[cell]; k < l->s->cell_first[cell + 1]; k++) look_at(l, l->s->cell_particle[k]);
}

// The box that the point goes over within the step, around what may hold it.
static void take_range(const search *l, double low[3], double high[3]) {
    for (int a = 0; a < l->dim; a++) {
        const double extent = l->box.extent[a] * (1 + 2 * MARGIN) +
                              (l->s->def.condition == BRUNT_SEPARATE ? 2 * BEHIND * l->box.half : 0) +
                              (l->sides ? 4 * l->box.half : 0);
        low[a] = l->box.x[a] - extent + fmin(0, l->coming[a]);
        high[a] = l->box.x[a] + extent + fmax(0, l->coming[a]);
    }
    if (!l->turned) return;
    double middle[3] = {0}, square = 0, back[3];
    for (int a = 0; a < l->dim; a++)
        middle[a] = 0.5 * (low[a] + high[a]), square += 0.25 * (high[a] - low[a]) * (high[a] - low[a]);
    brunt_boundary_surface_back(l->s, middle, back);
    const double range = sqrt(square) + 1.5 * l->turned->farthest; // particles are half of their way on
    for (int a = 0; a < l->dim; a++) low[a] = back[a] - range, high[a] = back[a] + range;
}

// The boundary particles in that box.
static void look_around(search *l) {
    const brunt_boundary_surface *s = l->s;
    int32_t from[3] = {0}, to[3] = {0};
    double cells = 1, low[3], high[3];
    take_range(l, low, high);
    for (int a = 0; a < l->dim; a++) {
        if (!(low[a] <= s->high[a] && high[a] >= s->low[a])) return;
        from[a] = (int32_t)floor((fmax(low[a], s->low[a]) - s->low[a]) / s->cell);
        to[a] = (int32_t)floor((fmin(high[a], s->high[a]) - s->low[a]) / s->cell);
        cells *= to[a] - from[a] + 1;
    }
    if (cells > s->particle_count) {
        for (int32_t b = 0; b < s->particle_count; b++) look_at(l, b);
        return;
    }
    for (int32_t x = from[0]; x <= to[0]; x++)
        for (int32_t y = from[1]; y <= to[1]; y++)
            for (int32_t z = from[2]; z <= to[2]; z++) look_in_cell(l, (const int32_t[3]){x, y, z});
}

// Whether the middle of the point's box goes through the surface at b, and ends deeper behind it than it is pushed out.
static bool passes(const search *l, int32_t b) {
    const brunt_boundary_particle *p = brunt_boundary_surface_particle(l->s, b);
    const double deep = (1 + 2 * BEHIND) * l->box.half, beside = l->s->cell / l->s->def.particles;
    double from = 0, towards = 0, square = 0, coming[3];
    take_coming(l, b, coming);
    for (int a = 0; a < l->dim; a++) {
        from += (l->box.x[a] - p->x[a]) * p->normal[a];
        towards += coming[a] * p->normal[a];
    }
    if (!(from > 0) || !(from + towards < -deep)) return false;
    for (int a = 0; a < l->dim; a++) {
        const double off = l->box.x[a] - p->x[a] - from / towards * coming[a];
        square += off * off;
    }
    return square < beside * beside;
}

// Farther than from the surface to where it is not pushed out any more.
static bool goes_far(const search *l) {
    double square = 0;
    for (int a = 0; a < l->dim; a++) square += l->coming[a] * l->coming[a];
    if (l->turned) square = pow(sqrt(square) + l->turned->farthest, 2);
    return square > 4 * BEHIND * BEHIND * l->box.half * l->box.half;
}

// The particles that the middle of its box may go through.
static bool passes_any(const search *l) {
    const brunt_boundary_surface *s = l->s;
    const double *low = l->turned ? l->turned->low : s->low, *high = l->turned ? l->turned->high : s->high,
                 beside = s->cell + (l->turned ? l->turned->farthest : 0);
    for (int a = 0; a < l->dim; a++)
        if (!(fmin(l->box.x[a], l->box.x[a] + l->coming[a]) <= high[a] + beside &&
              fmax(l->box.x[a], l->box.x[a] + l->coming[a]) >= low[a] - beside))
            return false;
    for (int32_t b = 0; b < s->particle_count; b++)
        if (passes(l, b)) return true;
    return false;
}

bool brunt_boundary_surface_extent(const brunt_boundary_surface *s, brunt_body *body,
                                   const brunt_boundary_extent *extent, double *gap) {
    search l = {.s = s, .gap = gap, .dim = body->particles.dim, .turned = s->turned.particle ? &s->turned : NULL};
    bool passed = false;
    real *const *v = brunt_field(&body->particles, BRUNT_FIELD_velocity);
    const bool leaves = s->def.condition == BRUNT_SEPARATE;
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        const brunt_block *block = &body->grid.blocks[b];
        for (int64_t p = block->first; p < block->first + block->count; p++) {
            l.box = box_of(body, p, extent->frame);
            for (int a = 0; a < l.dim; a++) {
                l.box.x[a] -= extent->way[a];
                const double goes = extent->moved ? extent->moved[p * l.dim + a] : (double)v[a][p] * extent->dt;
                l.coming[a] = leaves ? goes - extent->step[a] : 0;
            }
            look_around(&l);
            if (extent->moved && leaves && !passed) passed = goes_far(&l) && passes_any(&l);
        }
    }
    return passed;
}

// ------------------------------------------------------------------------------------------ what is far

static void widen(brunt_boundary_bounds *bounds, int a, double at) {
    if (at < bounds->low[a]) bounds->low[a] = at;
    if (at > bounds->high[a]) bounds->high[a] = at;
}

// A row of F is no longer than F, and its components sum to no more than sqrt(dim) of it.
void brunt_boundary_body_bounds(brunt_body *body, double dt, const double *moved, brunt_boundary_bounds *bounds) {
    brunt_particles *p = &body->particles;
    const int dim = p->dim;
    real *const *x = brunt_field(p, BRUNT_FIELD_position), *const *v = brunt_field(p, BRUNT_FIELD_velocity),
                *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    const real *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    double stretch = 0, largest = 0;
    *bounds = (brunt_boundary_bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0, dim};
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        const brunt_block *block = &body->grid.blocks[b];
        for (int64_t s = block->first; s < block->first + block->count; s++) {
            double square = 0;
            for (int r = 0; r < dim; r++) {
                const double at = (double)x[r][s], goes = moved ? moved[s * dim + r] : (double)v[r][s] * dt;
                widen(bounds, r, at), widen(bounds, r, at + goes);
                for (int c = 0; c < dim; c++) {
                    const double f = (double)F[r * p->point_dim + c][s];
                    square += f * f;
                }
            }
            if (square > stretch) stretch = square;
            if ((double)volume[s] > largest) largest = (double)volume[s];
        }
    }
    bounds->extent = pow(largest, 1.0 / dim) * (0.5 * (1 + 2 * MARGIN) * sqrt(dim * stretch) + BEHIND);
}

bool brunt_boundary_surface_far(const brunt_boundary_surface *s, const brunt_boundary_bounds *bounds,
                                const brunt_boundary_extent *extent) {
    const brunt_boundary_turned *turned = s->turned.particle ? &s->turned : NULL;
    const double *low = turned ? turned->low : s->low, *high = turned ? turned->high : s->high,
                 beside = bounds->extent + s->cell + (turned ? 2 * turned->farthest : 0);
    for (int a = 0; a < bounds->dim; a++)
        if (bounds->low[a] - extent->way[a] - fmax(0, extent->step[a]) > high[a] + beside ||
            bounds->high[a] - extent->way[a] - fmin(0, extent->step[a]) < low[a] - beside)
            return true;
    return false;
}

// Whether q is the other side of the wall behind p; how far away.
static bool is_back(const brunt_boundary_surface *s, const brunt_boundary_particle *p, const brunt_boundary_particle *q,
                    double *away) {
    double depth = 0, square = 0, turn = 0;
    for (int a = 0; a < 3; a++) {
        const double d = q->x[a] - p->x[a];
        depth -= d * p->normal[a], square += d * d, turn += p->normal[a] * q->normal[a];
    }
    const double beside = s->cell / s->def.particles;
    *away = depth;
    return turn < AGAINST && depth > 0 && depth < s->cell && square - depth * depth < beside * beside;
}

void brunt_boundary_surface_backs(brunt_boundary_surface *s) {
    for (int32_t b = 0; b < s->particle_count; b++) {
        brunt_boundary_particle *p = &s->particle[b];
        int32_t at[3], to[3];
        double away;
        p->back = INFINITY;
        if (s->def.condition != BRUNT_SEPARATE) continue;
        for (int a = 0; a < 3; a++) at[a] = (int32_t)floor((p->x[a] - s->low[a]) / s->cell);
        for (int k = 0; k < 27; k++) {
            to[0] = at[0] + k / 9 - 1, to[1] = at[1] + k / 3 % 3 - 1, to[2] = at[2] + k % 3 - 1;
            const int32_t cell = brunt_boundary_surface_cell(s, to);
            for (int32_t i = cell < 0 ? 0 : s->cell_first[cell]; cell >= 0 && i < s->cell_first[cell + 1]; i++)
                if (is_back(s, p, &s->particle[s->cell_particle[i]], &away)) p->back = fmin(p->back, away);
        }
    }
}

// On which sides of a surface a body is when the run begins.
static void find_sides(const brunt_boundary_surface *s, brunt_body *body, const double *frame, sides *found) {
    double way[3] = {0};
    search l = {.s = s, .dim = body->particles.dim, .sides = found, .turned = s->turned.particle ? &s->turned : NULL};
    if (!l.turned) brunt_boundary_surface_way(s, 0, way);
    for (int32_t b = 0; b < body->grid.block_count; b++)
        for (int64_t n = 0; n < body->grid.blocks[b].count; n++) {
            l.box = box_of(body, body->grid.blocks[b].first + n, frame);
            for (int a = 0; a < l.dim; a++) l.box.x[a] -= way[a];
            look_around(&l);
        }
}

static int check_sides(const brunt_boundary_surface *s, const brunt_body *body, const sides *found, bool may_pass,
                       brunt_error *error) {
    if (found->behind > 0 && found->front == 0)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "boundaries (%s): body '%s' is behind it: its normal points to what may leave it, %s",
                          s->boundary->name, body->name,
                          body->particles.dim == 2 ? "to the left of the line: turn the order of its points"
                                                   : "as the corners of its facets go round: mesh.reversed turns it");
    for (int32_t b = 0; b < s->particle_count && !may_pass; b++) {
        const double *x = brunt_boundary_surface_particle(s, b)->x;
        if (found->mark[b] == (IN_FRONT | BEHIND_IT | DEEP))
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "boundaries (%s): it goes through body '%s' near (%.4g, %.4g, %.4g) m: what is behind it "
                              "there would not be held, since condition separate acts on its side alone; move one of "
                              "them, or cut the body there",
                              s->boundary->name, body->name, x[0], x[1], x[2]);
    }
    return BRUNT_OK;
}

int brunt_boundary_surfaces_sides(const brunt_boundary_surfaces *surfaces, const brunt_bodies *bodies, bool may_pass,
                                  brunt_error *error) {
    for (int k = 0; k < surfaces->count; k++) {
        const brunt_boundary_surface *s = &surfaces->surface[k];
        uint8_t *mark;
        int status = BRUNT_OK;
        if (s->def.condition != BRUNT_SEPARATE) continue;
        if (BRUNT_NEW(mark, s->particle_count + 1, "particles of a boundary", error)) return BRUNT_FAILED;
        for (int i = 0; i < bodies->mpm_count && !status; i++) {
            sides found = {.mark = mark};
            if (!brunt_boundary_surface_acts(s, &bodies->mpm[i])) continue;
            memset(mark, 0, (size_t)s->particle_count);
            find_sides(s, &bodies->mpm[i], surfaces->frame[i], &found);
            status = check_sides(s, &bodies->mpm[i], &found, may_pass, error);
        }
        brunt_free(mark);
        if (status) return status;
    }
    return BRUNT_OK;
}
