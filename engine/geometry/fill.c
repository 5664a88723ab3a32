#include "geometry/fill.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"

#include <math.h>

// Of the spacing: a site that rounding puts on either side of the surface must not break the shape's symmetry, and a
// site on the seam between two parts of a union belongs to both.
static const double surface_tolerance = 1e-9;

typedef struct lattice {
    const brunt_shape *shape;
    int dimension;
    double spacing, first[3]; // [m] centre of site (0, 0, 0)
    int64_t count[3];         // 1 along a missing dimension
} lattice;

// The number of sites along an axis is the whole number nearest to the extent: no farther pair of sites of that parity
// has its centre inside the box, and the extent of the particles is never off by more than half a spacing.
static int make_lattice(const brunt_body_def *body, int dimension, double spacing, lattice *l, brunt_error *error) {
    double min[3], max[3];
    if (!brunt_shape_bounds(&body->shape, dimension, min, max))
        return brunt_fail(error, BRUNT_BAD_INPUT, "body '%s': its shape is empty or has no bounds", body->name);
    if (!(spacing > 0) || !isfinite(spacing))
        return brunt_fail(error, BRUNT_BAD_INPUT, "body '%s': a particle spacing of %g m, a positive length is wanted",
                          body->name, spacing);
    *l = (lattice){.shape = &body->shape, .dimension = dimension, .spacing = spacing, .count = {1, 1, 1}};
    for (int i = 0; i < dimension; i++) {
        double extent = max[i] - min[i], whole = floor(extent / spacing + 0.5 - 1e-6);
        if (whole < 1)
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "body '%s': its shape is %g m along %c, less than half the particle spacing of %g m",
                              body->name, extent, "xyz"[i], spacing);
        if (whole > 4e9)
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "body '%s': %.3g particles along %c (%g m by %g m), at most 2^31 in all are possible",
                              body->name, whole, "xyz"[i], extent, spacing);
        double margin = (extent - whole * spacing) / 2;
        if (fabs(margin) < surface_tolerance * spacing) margin = 0;
        l->first[i] = min[i] + margin + spacing / 2;
        l->count[i] = (int64_t)whole;
    }
    return BRUNT_OK;
}

static void site_position(const lattice *l, const int64_t *site, double *x) {
    for (int i = 0; i < 3; i++) x[i] = i < l->dimension ? l->first[i] + (double)site[i] * l->spacing : 0;
}

// A sample of at most 64 sites an axis: enough to say "about 3e12 particles" before trying.
static double estimate_count(const lattice *l) {
    int64_t samples[3] = {1, 1, 1}, tried = 0, inside = 0;
    double sites = 1;
    for (int i = 0; i < l->dimension; i++) {
        samples[i] = l->count[i] < 64 ? l->count[i] : 64;
        sites *= (double)l->count[i];
    }
    for (int64_t i = 0; i < samples[0]; i++)
        for (int64_t j = 0; j < samples[1]; j++)
            for (int64_t k = 0; k < samples[2]; k++) {
                int64_t sample[3] = {i, j, k}, site[3] = {0, 0, 0};
                for (int a = 0; a < l->dimension; a++)
                    site[a] = (int64_t)(((double)sample[a] + 0.5) * (double)l->count[a] / (double)samples[a]);
                double x[3];
                site_position(l, site, x);
                tried++;
                inside += brunt_shape_distance(l->shape, l->dimension, x) < 0;
            }
    return sites * (double)inside / (double)tried;
}

// The next site of a row at or after `site` that is inside. Outside, no distance is overestimated: that far can be
// skipped.
static bool next_inside(const lattice *l, int64_t *site, double *x, double *distance) {
    int last = l->dimension - 1;
    while (site[last] < l->count[last]) {
        site_position(l, site, x);
        *distance = brunt_shape_distance(l->shape, l->dimension, x);
        if (*distance < surface_tolerance * l->spacing) return true;
        double skip = floor(*distance / l->spacing * (1 - 1e-12));
        if (!(skip < (double)l->count[last])) return false;
        site[last] += skip > 1 ? (int64_t)skip : 1;
    }
    return false;
}

// Uniform in [-1, 1), from the seed, the site and the axis alone.
static double random_of(uint64_t seed, uint64_t index, uint64_t axis) {
    uint64_t bits = brunt_hash_add(brunt_hash_add(brunt_hash_add(0, seed), index), axis);
    return (double)(bits >> 11) * 0x1p-52 - 1;
}

// Moves a site by a random part of the spacing; halved until the particle is inside, or not at all on the surface.
static void jitter(const lattice *l, const brunt_body_def *body, uint64_t index, double *x, double *distance) {
    double shift[3];
    for (int i = 0; i < l->dimension; i++)
        shift[i] = body->jitter * l->spacing * random_of(body->seed, index, (uint64_t)i);
    for (int attempt = 0; attempt < 16; attempt++) {
        double moved[3] = {0, 0, 0};
        for (int i = 0; i < l->dimension; i++) moved[i] = x[i] + shift[i];
        double d = brunt_shape_distance(l->shape, l->dimension, moved);
        if (d < 0) {
            for (int i = 0; i < l->dimension; i++) x[i] = moved[i];
            *distance = d;
            return;
        }
        for (int i = 0; i < l->dimension; i++) shift[i] /= 2;
    }
}

static void place(const brunt_placement *placement, const double *x, double *placed) {
    const double *R = placement->rotation;
    for (int i = 0; i < 3; i++)
        placed[i] = R[3 * i] * x[0] + R[3 * i + 1] * x[1] + R[3 * i + 2] * x[2] + placement->translation[i];
}

// Visits the inside sites in order; with `out` its arrays are filled. Returns how many, at most INT32_MAX + 1.
static int64_t visit(const lattice *l, const brunt_body_def *body, brunt_filled *out) {
    int64_t found = 0, rows = 1, last = l->dimension - 1;
    for (int i = 0; i < last; i++) rows *= l->count[i];
    double limit = 0.5 * sqrt(l->dimension) * l->spacing;
    for (int64_t row = 0; row < rows; row++) {
        int64_t site[3] = {row, 0, 0};
        if (last == 2) site[0] = row / l->count[1], site[1] = row % l->count[1];
        double x[3], placed[3], distance;
        for (; next_inside(l, site, x, &distance); site[last]++) {
            if (found > INT32_MAX) return found;
            if (out) {
                if (body->fill == BRUNT_FILL_JITTERED)
                    jitter(l, body, (uint64_t)row * (uint64_t)l->count[last] + (uint64_t)site[last], x, &distance);
                place(&body->place, x, placed);
                for (int i = 0; i < l->dimension; i++) out->position[i][found] = placed[i];
                out->reach[found] = fmin(fmax(-distance, 0), limit);
            }
            found++;
        }
    }
    return found;
}

static int out_of_memory(const brunt_body_def *body, brunt_filled *out, int64_t count, brunt_error *error) {
    brunt_filled_free(out);
    return brunt_fail(error, BRUNT_FAILED, "body '%s': no memory for %lld particles", body->name, (long long)count);
}

// Ring j of a disk, inmost first, has 4 (2 j + 1) particles, one of them below the centre: all rings are as wide and
// all particles as large, 2 / sqrt(pi) of the spacing across and sqrt(pi) / 2 of it along.
static int fill_rings(const brunt_body_def *body, int dimension, double spacing, brunt_filled *out,
                      brunt_error *error) {
    const double pi = 3.14159265358979323846;
    const brunt_shape *disk = &body->shape;
    if (dimension != 2 || disk->kind != BRUNT_SPHERE)
        return brunt_fail(error, BRUNT_BAD_INPUT, "body '%s': fill: rings is for a disk in two dimensions", body->name);
    const double rings = floor(disk->radius / spacing * sqrt(pi) / 2 + 0.5);
    if (!(rings >= 1 && 4 * rings * rings <= INT32_MAX))
        return brunt_fail(error, BRUNT_BAD_INPUT, "body '%s': %g rings in a disk, 1 to 23170 are possible", body->name,
                          rings);
    const int64_t count = (int64_t)(4 * rings * rings);
    const double width = disk->radius / rings;
    out->volume = pi * width * width / 4;
    out->reach = brunt_alloc((size_t)count * sizeof *out->reach);
    for (int i = 0; i < 2; i++) out->position[i] = brunt_alloc((size_t)count * sizeof *out->position[i]);
    if (!out->reach || !out->position[0] || !out->position[1]) return out_of_memory(body, out, count, error);
    for (int64_t j = 0; j < (int64_t)rings; j++)
        for (int64_t k = 0; k < 4 * (2 * j + 1); k++) {
            const double r = ((double)j + 0.5) * width, angle = 2 * pi * (double)k / (double)(4 * (2 * j + 1)) - pi / 2;
            const double x[3] = {disk->center[0] + r * cos(angle), disk->center[1] + r * sin(angle), 0};
            double placed[3];
            place(&body->place, x, placed);
            for (int i = 0; i < 2; i++) out->position[i][out->count] = placed[i];
            out->reach[out->count++] = fmin(disk->radius - r, 0.5 * sqrt(2) * spacing);
        }
    return BRUNT_OK;
}

int brunt_fill_shape(const brunt_body_def *body, int dimension, double spacing, brunt_filled *out, brunt_error *error) {
    *out = (brunt_filled){0};
    if (body->fill == BRUNT_FILL_RINGS) return fill_rings(body, dimension, spacing, out, error);
    lattice l;
    int code = make_lattice(body, dimension, spacing, &l, error);
    if (code) return code;
    double sites = (double)l.count[0] * (double)l.count[1] * (double)l.count[2];
    if (sites > 0x1p40) // more rows than can be walked, however few of their sites are inside
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "body '%s': about %.3g lattice sites at a spacing of %g m, about %.3g inside: too many",
                          body->name, sites, spacing, estimate_count(&l));
    double expected = sites > INT32_MAX ? estimate_count(&l) : 0;
    int64_t count = expected > 1.1 * INT32_MAX ? INT64_MAX : visit(&l, body, NULL);
    if (count > INT32_MAX)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "body '%s': about %.3g particles at a spacing of %g m, at most 2147483647 are possible",
                          body->name, expected > INT32_MAX ? expected : (double)INT32_MAX + 1, spacing);
    if (!count)
        return brunt_fail(error, BRUNT_BAD_INPUT, "body '%s': no particle lies inside its shape at a spacing of %g m",
                          body->name, spacing);
    out->volume = dimension == 3 ? spacing * spacing * spacing : spacing * spacing;
    out->reach = brunt_alloc((size_t)count * sizeof *out->reach);
    bool complete = out->reach;
    for (int i = 0; i < dimension; i++) {
        out->position[i] = brunt_alloc((size_t)count * sizeof *out->position[i]);
        complete = complete && out->position[i];
    }
    if (!complete) return out_of_memory(body, out, count, error);
    out->count = (int32_t)visit(&l, body, out);
    return BRUNT_OK;
}

void brunt_filled_free(brunt_filled *filled) {
    for (int i = 0; i < 3; i++) brunt_free(filled->position[i]);
    brunt_free(filled->reach);
    *filled = (brunt_filled){0};
}
