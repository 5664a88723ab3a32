// Reading meshes: fields at nodes, then at elements, in the numbers of the mesh they were made from.
#include <math.h>
#include <string.h>

#include "base/simd.h"
#include "body/derived.h"
#include "body/fields.h"

// ------------------------------------------------------------------------------------------ at nodes

typedef void node_fn(const brunt_fem_body *fem, int32_t node, double *out);

static void node_position(const brunt_fem_body *fem, int32_t n, double *out) {
    for (int a = 0; a < 3; a++) out[a] = (double)brunt_fem_node(fem, n)[a];
}
static void node_displacement(const brunt_fem_body *fem, int32_t n, double *out) {
    for (int a = 0; a < 3; a++) out[a] = (double)(brunt_fem_node(fem, n)[a] - fem->start[4 * (size_t)n + (size_t)a]);
}
static void node_velocity(const brunt_fem_body *fem, int32_t n, double *out) {
    for (int a = 0; a < 3; a++) out[a] = (double)brunt_fem_node(fem, n)[BRUNT_FEM_V + a];
}
static void node_mass(const brunt_fem_body *fem, int32_t n, double *out) {
    *out = (double)brunt_fem_node(fem, n)[BRUNT_FEM_MASS];
}
static void node_id(const brunt_fem_body *fem, int32_t n, double *out) { *out = fem->node_id[n]; }

static const struct node_field {
    brunt_field_info info;
    node_fn *read;
} node_fields[] = {
    {{"position", "m", 3, false, BRUNT_AT_NODES}, node_position},
    {{"displacement", "m", 3, false, BRUNT_AT_NODES}, node_displacement},
    {{"velocity", "m/s", 3, false, BRUNT_AT_NODES}, node_velocity},
    {{"mass", "kg", 1, false, BRUNT_AT_NODES}, node_mass},
    {{"node", "1", 1, false, BRUNT_AT_NODES}, node_id},
};
enum { NODE_FIELDS = sizeof node_fields / sizeof node_fields[0] };

// ------------------------------------------------------------------------------------------ at elements

static double scalar(const brunt_fem_body *fem, int field, int c, int32_t s) {
    return (double)fem->scalar[fem->field[field].first + c][s];
}

static void read_point(const brunt_fem_body *fem, int32_t s, brunt_point_values *p) {
    const int dim = fem->point_dim;
    const bool membrane = fem->traits->membrane;
    memset(p, 0, sizeof *p);
    p->F[8] = membrane ? scalar(fem, BRUNT_ELEMENT_thickness_stretch, 0, s) : 1;
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) p->F[3 * r + c] = scalar(fem, BRUNT_ELEMENT_deformation_gradient, r * dim + c, s);
    const double *F = p->F;
    p->J = F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
    for (int c = 0; c < BRUNT_SYMMETRIC(dim); c++)
        p->stress[c] = scalar(fem, BRUNT_ELEMENT_kirchhoff_stress, c, s) / p->J;
    if (membrane) brunt_membrane_stress(fem, s, p->stress);
    p->volume = scalar(fem, BRUNT_ELEMENT_reference_volume, 0, s) * p->J;
    p->density = (double)fem->material.density / p->J;
}

typedef void element_fn(const brunt_fem_body *fem, int32_t slot, const brunt_point_values *p, double *out);

static void element_stress(const brunt_fem_body *fem, int32_t s, const brunt_point_values *p, double *out) {
    (void)fem, (void)s;
    memcpy(out, p->stress, sizeof p->stress);
}
static void element_J(const brunt_fem_body *fem, int32_t s, const brunt_point_values *p, double *out) {
    (void)fem, (void)s;
    *out = p->J;
}
static void element_volume(const brunt_fem_body *fem, int32_t s, const brunt_point_values *p, double *out) {
    (void)fem, (void)s;
    *out = p->volume;
}
static void element_density(const brunt_fem_body *fem, int32_t s, const brunt_point_values *p, double *out) {
    (void)fem, (void)s;
    *out = p->density;
}
static void element_F(const brunt_fem_body *fem, int32_t s, const brunt_point_values *p, double *out) {
    (void)fem, (void)s;
    memcpy(out, p->F, sizeof p->F);
}
static void element_id(const brunt_fem_body *fem, int32_t s, const brunt_point_values *p, double *out) {
    (void)p;
    *out = fem->element_id[s];
}

static void element_thickness(const brunt_fem_body *fem, int32_t s, const brunt_point_values *p, double *out) {
    (void)s;
    *out = (double)fem->thickness * p->F[8];
}

#pragma GCC diagnostic ignored "-Wmissing-field-initializers" // rows of their own leave the last out
#define DERIVED(name) {.derived = &brunt_field_##name},
static const struct element_field {
    brunt_field_info info;
    element_fn *read;
    const brunt_derived_field *derived; // in place of both
} element_fields[] = {
    {{"stress", "Pa", 6, true, BRUNT_AT_ELEMENTS}, element_stress},
    BRUNT_DERIVED_FIELDS(DERIVED){{"J", "1", 1, false, BRUNT_AT_ELEMENTS}, element_J},
    {{"volume", "m^3", 1, false, BRUNT_AT_ELEMENTS}, element_volume},
    {{"density", "kg/m^3", 1, false, BRUNT_AT_ELEMENTS}, element_density},
    {{"deformation_gradient", "1", 9, false, BRUNT_AT_ELEMENTS}, element_F},
    {{"element", "1", 1, false, BRUNT_AT_ELEMENTS}, element_id},
    {{"thickness", "m", 1, false, BRUNT_AT_ELEMENTS}, element_thickness}, // the last: of membranes alone
};
static int element_count(const brunt_fem_body *fem) {
    return (int)(sizeof element_fields / sizeof element_fields[0]) - (fem->traits->membrane ? 0 : 1);
}

// ------------------------------------------------------------------------------------------ all together

// Fields at nodes, those at elements, and after them the states of the material.
int32_t brunt_mesh_field_count(const brunt_body_ref *ref) {
    return NODE_FIELDS + element_count(ref->fem) + ref->fem->field_count - BRUNT_ELEMENT_BASE_FIELDS;
}

brunt_field_info brunt_mesh_field(const brunt_body_ref *ref, int32_t field) {
    const brunt_fem_body *fem = ref->fem;
    if (field < NODE_FIELDS) return node_fields[field].info;
    if ((field -= NODE_FIELDS) < element_count(fem))
        return brunt_field_info_of(element_fields[field].derived, element_fields[field].info, BRUNT_AT_ELEMENTS);
    const brunt_element_field *f = &fem->field[BRUNT_ELEMENT_BASE_FIELDS + field - element_count(fem)];
    bool symmetric = f->components > 1 && f->components == BRUNT_SYMMETRIC(fem->point_dim);
    return (brunt_field_info){f->name, f->unit, symmetric ? 6 : f->components, symmetric, BRUNT_AT_ELEMENTS};
}

// The place of a slot's element among those that are left, in the order of their numbers in the mesh.
static int64_t place_of(brunt_fem_body *fem, int32_t slot) {
    if (!fem->rank) return fem->element_id[slot];
    brunt_fem_ranks(fem);
    return fem->rank[fem->element_id[slot]];
}

void brunt_mesh_read(const brunt_body_ref *ref, int32_t field, double *out) {
    brunt_fem_body *fem = ref->fem;
    const brunt_field_info info = brunt_mesh_field(ref, field);
    if (field < NODE_FIELDS) {
        for (int32_t n = 0; n < fem->node_count; n++)
            node_fields[field].read(fem, n, out + (int64_t)fem->node_id[n] * info.components);
        return;
    }
    field -= NODE_FIELDS;
    const brunt_element_field *state =
        field < element_count(fem) ? NULL : &fem->field[BRUNT_ELEMENT_BASE_FIELDS + field - element_count(fem)];
    for (int32_t s = 0; s < fem->slots; s++) {
        if (fem->element_id[s] < 0) continue;
        double *to = out + place_of(fem, s) * info.components;
        brunt_point_values point;
        if (!state) {
            read_point(fem, s, &point);
            if (element_fields[field].derived)
                element_fields[field].derived->read(&point, to);
            else
                element_fields[field].read(fem, s, &point, to);
        }
        for (int c = 0; state && c < info.components; c++)
            to[c] = c < state->components ? (double)fem->scalar[state->first + c][s] : 0;
    }
}

void brunt_mesh_connectivity(const brunt_body_ref *ref, int32_t *out) {
    brunt_fem_body *fem = ref->fem;
    const int nodes = fem->traits->nodes;
    for (int32_t s = 0; s < fem->slots; s++) {
        if (fem->element_id[s] < 0) continue;
        for (int c = 0; c < nodes; c++)
            out[(size_t)place_of(fem, s) * (size_t)nodes + (size_t)c] =
                fem->node_id[fem->element_node[(size_t)s * (size_t)nodes + (size_t)c]];
    }
}
