// Reading material points: stored fields and those derived from them, in the order of the ids.
#include <math.h>
#include <string.h>

#include "base/simd.h"
#include "body/derived.h"
#include "body/fields.h"

typedef void derive_fn(brunt_body *body, int64_t slot, double *out);

static double entry(brunt_particles *p, int field, int c, int64_t s) { return (double)brunt_field(p, field)[c][s]; }

static inline void matrix_of(int dim, real *const *entries, int64_t s, double last, double out[9]) {
    memset(out, 0, 9 * sizeof *out);
    out[8] = last;
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) out[3 * r + c] = (double)entries[r * dim + c][s];
}

static void matrix(brunt_particles *p, int field, int64_t s, double last, double out[9]) {
    if (p->point_dim == 3)
        matrix_of(3, brunt_field(p, field), s, last, out);
    else
        matrix_of(2, brunt_field(p, field), s, last, out);
}

static double jacobian(brunt_particles *p, int64_t s) {
    double F[9];
    matrix(p, BRUNT_FIELD_deformation_gradient, s, 1, F);
    return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
}

static void derive_position(brunt_body *body, int64_t s, double *out) {
    for (int a = 0; a < 3; a++)
        out[a] = a < body->particles.dim ? entry(&body->particles, BRUNT_FIELD_position, a, s) : 0;
}
static void derive_velocity(brunt_body *body, int64_t s, double *out) {
    for (int a = 0; a < 3; a++)
        out[a] = a < body->particles.dim ? entry(&body->particles, BRUNT_FIELD_velocity, a, s) : 0;
}
static void stress_at(brunt_body *body, int64_t s, double J, double *out) {
    for (int c = 0; c < 6; c++)
        out[c] = c < BRUNT_SYMMETRIC(body->particles.point_dim)
                     ? entry(&body->particles, BRUNT_FIELD_kirchhoff_stress, c, s) / J
                     : 0;
}
static void derive_stress(brunt_body *body, int64_t s, double *out) {
    stress_at(body, s, jacobian(&body->particles, s), out);
}
static void derive_J(brunt_body *body, int64_t s, double *out) { *out = jacobian(&body->particles, s); }
static void derive_volume(brunt_body *body, int64_t s, double *out) {
    *out = entry(&body->particles, BRUNT_FIELD_reference_volume, 0, s) * jacobian(&body->particles, s);
}
static void derive_density(brunt_body *body, int64_t s, double *out) {
    *out = (double)body->material.density / jacobian(&body->particles, s);
}
static void derive_mass(brunt_body *body, int64_t s, double *out) {
    *out = entry(&body->particles, BRUNT_FIELD_mass, 0, s);
}
static void derive_F(brunt_body *body, int64_t s, double *out) {
    matrix(&body->particles, BRUNT_FIELD_deformation_gradient, s, 1, out);
}
static void derive_id(brunt_body *body, int64_t s, double *out) { *out = (double)body->particles.id[s]; }

static void derive_shared(const brunt_derived_field *field, brunt_body *body, int64_t s, double *out) {
    brunt_point_values at;
    derive_F(body, s, at.F);
    derive_J(body, s, &at.J);
    stress_at(body, s, at.J, at.stress);
    at.volume = entry(&body->particles, BRUNT_FIELD_reference_volume, 0, s) * at.J;
    at.density = (double)body->material.density / at.J;
    field->read(&at, out);
}

#pragma GCC diagnostic ignored "-Wmissing-field-initializers" // rows of their own leave the last out
#define SHARED(name) {.shared = &brunt_field_##name},
static const struct derived {
    brunt_field_info info;
    derive_fn *derive;
    const brunt_derived_field *shared; // in place of both
} derived[] = {
    {{"position", "m", 3, false, BRUNT_AT_PARTICLES}, derive_position},
    {{"velocity", "m/s", 3, false, BRUNT_AT_PARTICLES}, derive_velocity},
    {{"stress", "Pa", 6, true, BRUNT_AT_PARTICLES}, derive_stress},
    BRUNT_DERIVED_FIELDS(SHARED){{"J", "1", 1, false, BRUNT_AT_PARTICLES}, derive_J},
    {{"volume", "m^3", 1, false, BRUNT_AT_PARTICLES}, derive_volume},
    {{"density", "kg/m^3", 1, false, BRUNT_AT_PARTICLES}, derive_density},
    {{"mass", "kg", 1, false, BRUNT_AT_PARTICLES}, derive_mass},
    {{"deformation_gradient", "1", 9, false, BRUNT_AT_PARTICLES}, derive_F},
    {{"id", "1", 1, false, BRUNT_AT_PARTICLES}, derive_id},
};
enum { DERIVED = sizeof derived / sizeof derived[0] };

// After the derived fields come the states of the material.
int32_t brunt_points_field_count(const brunt_body_ref *ref) {
    return DERIVED + ref->mpm->particles.field_count - BRUNT_BASE_FIELDS;
}

brunt_field_info brunt_points_field(const brunt_body_ref *ref, int32_t field) {
    if (field < DERIVED) return brunt_field_info_of(derived[field].shared, derived[field].info, BRUNT_AT_PARTICLES);
    const brunt_particles *p = &ref->mpm->particles;
    const brunt_particle_field *f = &p->field[BRUNT_BASE_FIELDS + field - DERIVED];
    bool symmetric = f->components > 1 && f->components == BRUNT_SYMMETRIC(p->point_dim);
    return (brunt_field_info){f->name, f->unit, symmetric ? 6 : f->components, symmetric, BRUNT_AT_PARTICLES};
}

// Where some have left: the place of each id among those that are alive.
static const int32_t *rank_ids(brunt_body *body) {
    const brunt_particles *p = &body->particles;
    memset(body->rank, 0, (size_t)p->made * sizeof *body->rank);
    for (int64_t s = 0; s < p->slots; s++)
        if (p->id[s] >= 0) body->rank[p->id[s]] = 1;
    for (int64_t id = 0, next = 0; id < p->made; id++) {
        const bool alive = body->rank[id];
        body->rank[id] = (int32_t)next;
        next += alive;
    }
    return body->rank;
}

void brunt_points_read(const brunt_body_ref *ref, int32_t field, double *out) {
    brunt_body *body = ref->mpm;
    brunt_particles *p = &body->particles;
    brunt_field_info info = brunt_points_field(ref, field);
    const int32_t *rank = p->count < p->made ? rank_ids(body) : NULL;
    for (int64_t s = 0; s < p->slots; s++) {
        if (p->id[s] < 0) continue;
        double *to = out + (rank ? rank[p->id[s]] : p->id[s]) * info.components;
        if (field < DERIVED) {
            if (derived[field].shared)
                derive_shared(derived[field].shared, body, s, to);
            else
                derived[field].derive(body, s, to);
            continue;
        }
        const brunt_particle_field *f = &p->field[BRUNT_BASE_FIELDS + field - DERIVED];
        for (int c = 0; c < info.components; c++) to[c] = c < f->components ? (double)p->scalar[f->first + c][s] : 0;
    }
}
