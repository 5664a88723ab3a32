// Making a finite-element body from its definition and mesh, and looking at its elements as points of a material.
#include "fem/fem_body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/axis.h"
#include "base/error.h"
#include "base/simd.h"
#include "fem/layout.h"
#include "base/array.h"
#include "base/memory.h"

typedef struct element_needs {
    bool mass_scaling, viscous_hourglass, membrane;
} element_needs;

static void list_fields(brunt_fem_body *body, const element_needs *needs) {
    const int dim = body->point_dim;
    int scalars = 0;
#define ADD_FIELD(name_, unit_, components_, when)                                                                     \
    body->field[BRUNT_ELEMENT_##name_] =                                                                               \
        (brunt_element_field){#name_, unit_, scalars, (when) ? components_(dim) : 0, NULL, 0};                         \
    scalars += body->field[BRUNT_ELEMENT_##name_].components;
    BRUNT_ELEMENT_FIELDS(ADD_FIELD)
#undef ADD_FIELD
    body->field_count = BRUNT_ELEMENT_BASE_FIELDS;
    for (int m = 0; m < BRUNT_COMPONENTS; m++) {
        const brunt_model *model = body->material.model[m];
        for (int s = 0; model && s < model->state_count; s++) {
            const brunt_state_field *state = &model->state[s];
            int components = dim == 3 ? state->components3 : state->components2;
            body->field[body->field_count++] =
                (brunt_element_field){state->name, state->unit, scalars, components, model, s};
            scalars += components;
        }
    }
    body->scalar_count = scalars;
}

// One slab; the arrays' distance is 9 cache lines past a page, so that streams read together do not fall into the same
// sets of the cache.
static int allocate_fields(brunt_fem_body *body, brunt_error *error) {
    size_t stride = ((size_t)body->slots * sizeof(real) + 4095) / 4096 * 4096 + (size_t)9 * 64;
    body->slab_bytes = stride * (size_t)body->scalar_count;
    if (!(body->slab = brunt_alloc(body->slab_bytes)))
        return brunt_fail_memory(error, "bytes of fields of elements", body->slab_bytes, 1);
    for (int k = 0; k < body->scalar_count; k++) body->scalar[k] = (real *)((char *)body->slab + stride * (size_t)k);
    return BRUNT_OK;
}

// New, undeformed material in slots [0, count).
static void reset_state(brunt_fem_body *body, double temperature, int32_t count) {
    for (int f = 0; f < body->field_count; f++) {
        const brunt_element_field *field = &body->field[f];
        const brunt_state_field *state = field->model ? &field->model->state[field->state] : NULL;
        int component = 0;
        while (field->model && body->material.model[component] != field->model) component++;
        if (f == BRUNT_ELEMENT_reference_volume || f == BRUNT_ELEMENT_density_scale) continue;
        for (int c = 0; c < field->components; c++) {
            real value = 0;
            if (f == BRUNT_ELEMENT_deformation_gradient) value = c % (body->point_dim + 1) == 0;
            if (f == BRUNT_ELEMENT_thickness_stretch) value = 1;
            if (f == BRUNT_ELEMENT_kirchhoff_stress && c < 3) value = body->material.rest_stress;
            if (state && state->initial) value = state->initial(body->material.constants[component], c);
            if (state && !strcmp(state->name, "temperature") && temperature > 0) value = (real)temperature;
            for (int32_t s = 0; s < count; s++) body->scalar[field->first + c][s] = value;
        }
    }
}

// lambda / (lambda + 2 mu): what a small uniaxial stretch of the first elements makes of the new material's stress,
// with the equation of state if there is one. A material without pressure gives 0, a fluid 1.
static void measure_lateral_ratio(brunt_fem_body *body, double temperature) {
    const real stretch = sizeof(real) == 4 ? (real)1e-4 : (real)1e-6;
    enum { AXIAL, LATERAL };
    real L[9][BRUNT_LANES] = {{0}}, plastic[BRUNT_LANES] = {0}, viscous[BRUNT_LANES] = {0}, strain[BRUNT_LANES] = {0};
    double before[2], stress[2];
    brunt_material_points points[BRUNT_COMPONENTS];
    for (int step = 0; step < 2; step++) { // an equation of state may have stress at rest
        reset_state(body, temperature, BRUNT_LANES);
        for (int l = 0; l < BRUNT_LANES && step; l++) {
            L[0][l] = stretch;
            brunt_element_scalars(body, BRUNT_ELEMENT_deformation_gradient)[0][l] += stretch;
        }
        for (int k = 0; k < BRUNT_COMPONENTS; k++) {
            points[k] = brunt_fem_points(body, (brunt_component)k, 0, BRUNT_LANES);
            points[k].dt = 1;
            points[k].cell = 1;
            for (int c = 0; c < BRUNT_MATRIX(body->point_dim); c++) points[k].L[c] = L[c];
        }
        brunt_material_update(&body->material, points, plastic, viscous, strain);
        for (int k = 0; k < 2; k++) stress[k] = (double)points[BRUNT_STRENGTH].stress[k][0];
        if (step == 0) memcpy(before, stress, sizeof before);
    }
    double ratio = (stress[LATERAL] - before[LATERAL]) / (stress[AXIAL] - before[AXIAL]);
    body->lateral_ratio = (real)(ratio >= -1 && ratio <= 1 ? ratio : 1);
}

// The springs of the stiffness form are a share of the greatest stiffness, that against uniaxial strain. Where that is
// almost all resistance to a change of volume, they would stiffen what is soft, bending and shear: a ball of nu = 0.499
// stored 40 % of the energy of an impact in them. From nu = 0.417 on they go with the shear modulus: at most SHEARS
// times mu = (1 - r) / 2 of the stiffness. A fluid has no shear modulus and keeps its springs.
static void soften_hourglass(brunt_fem_body *body) {
    const real SHEARS = 7;
    const real share = SHEARS * (1 - body->lateral_ratio) / 2;
    if (body->hourglass != BRUNT_HOURGLASS_STIFFNESS || body->material.model[BRUNT_STRENGTH]->fluid) return;
    if (share < 1) body->hourglass_coefficient *= share;
}

static void place_nodes(const brunt_body_def *def, const brunt_mesh *mesh, brunt_fem_body *body) {
    const double *R = def->place.rotation, *t = def->place.translation;
    for (int32_t n = 0; n < body->node_count; n++) {
        const double *x = mesh->nodes[body->node_id[n]];
        for (int i = 0; i < body->dim; i++) {
            double at = R[3 * i] * x[0] + R[3 * i + 1] * x[1] + t[i];
            if (body->dim == 3) at += R[3 * i + 2] * x[2];
            body->start[(size_t)n * 4 + (size_t)i] = brunt_fem_node(body, n)[i] = (real)at;
        }
    }
}

// Rings lie at r >= 0. What is on the axis up to rounding is on it.
static int put_on_axis(brunt_fem_body *body, brunt_error *error) {
    double far = 0;
    for (int32_t n = 0; n < body->node_count; n++) far = fmax(far, fabs((double)body->start[(size_t)n * 4]));
    const double on = far * (sizeof(real) == 4 ? 1e-6 : 1e-12);
    for (int32_t n = 0; n < body->node_count; n++) {
        real *r = &body->start[(size_t)n * 4];
        if ((double)*r < -on)
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "bodies.%s: node %d of the mesh is at r = %g m: " BRUNT_CUT_AT_AXIS, body->name,
                              body->node_id[n] + 1, (double)*r);
        if ((double)*r > on) continue;
        *r = brunt_fem_node(body, n)[BRUNT_FEM_X] = 0;
        body->held[n] = 1;
    }
    return BRUNT_OK;
}

static double element_volume(const brunt_fem_body *body, const double (*x)[3]) {
    double share[BRUNT_ELEMENT_NODES], volume = 0;
    if (!body->element->shares)
        return body->element->volume(x) * (body->traits->membrane ? (double)body->thickness : 1);
    body->element->shares(x, share);
    for (int a = 0; a < body->traits->nodes; a++) volume += share[a] > 0 ? share[a] : NAN;
    return volume;
}

static int measure_volumes(brunt_fem_body *body, brunt_error *error) {
    real *volume = brunt_element_scalars(body, BRUNT_ELEMENT_reference_volume)[0];
    for (int32_t b = 0; b < body->block_count; b++) {
        brunt_fem_block *block = &body->block[b];
        double sum = 0;
        for (int32_t s = block->first; s < block->first + block->count; s++) {
            double x[BRUNT_ELEMENT_NODES][3];
            brunt_fem_corners(body, s, x);
            double V = element_volume(body, (const double(*)[3])x);
            if (!(V > 0) || !isfinite(V))
                return brunt_fail(error, BRUNT_BAD_INPUT,
                                  "bodies.%s: element %d of the mesh has volume %g: it is flat or inside out",
                                  body->name, body->element_id[s] + 1, V);
            volume[s] = (real)V;
            sum += body->element->volume((const double(*)[3])x);
        }
        block->length = (real)pow(sum / block->count, 1.0 / body->traits->span);
    }
    return BRUNT_OK;
}

void brunt_fem_shares(const brunt_fem_body *body, int32_t slot, double *share) {
    const real volume = body->scalar[body->field[BRUNT_ELEMENT_reference_volume].first][slot];
    const int nodes = body->traits->nodes;
    double x[BRUNT_ELEMENT_NODES][3];
    for (int a = 0; a < nodes; a++) share[a] = (double)volume / nodes;
    if (!body->element->shares || !(volume > 0)) return;
    brunt_fem_corners(body, slot, x);
    body->element->shares((const double(*)[3])x, share);
}

// Each node gets an equal share of its elements' masses: the sum of a row of the consistent matrix for simplices and
// parallelograms. The bound of the stable step is for equal shares. Nodes of a ring get that row itself.
static void share_masses(brunt_fem_body *body, double *mass) {
    const int nodes = body->traits->nodes;
    const brunt_element_field *scale = &body->field[BRUNT_ELEMENT_density_scale];
    for (int32_t s = 0; s < body->slots; s++) {
        double factor = scale->components ? (double)body->scalar[scale->first][s] : 1;
        double share[BRUNT_ELEMENT_NODES];
        brunt_fem_shares(body, s, share);
        for (int a = 0; a < nodes; a++)
            mass[body->element_node[(int64_t)s * nodes + a]] += (double)body->material.density * factor * share[a];
    }
    for (int32_t n = 0; n < body->node_count; n++) brunt_fem_node(body, n)[BRUNT_FEM_MASS] = (real)mass[n];
}

static int ascending(const void *left, const void *right) {
    int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
    return (a > b) - (a < b);
}

// The mesh's groups in the body's node numbers. Nodes that no element has are left out.
static int number_groups(brunt_fem_body *body, const brunt_mesh *mesh, int32_t *number, brunt_error *error) {
    memset(number, -1, (size_t)mesh->node_count * sizeof *number);
    for (int32_t n = 0; n < body->node_count; n++) number[body->node_id[n]] = n;
    if (BRUNT_NEW(body->groups, mesh->group_count, "groups of nodes", error)) return BRUNT_FAILED;
    for (int32_t g = 0; g < mesh->group_count; g++) {
        const brunt_group *from = &mesh->groups[g];
        brunt_group *to = &body->groups[body->group_count++];
        memcpy(to->name, from->name, sizeof to->name);
        if (BRUNT_NEW(to->nodes, from->count, "nodes of a group", error)) return BRUNT_FAILED;
        for (int32_t k = 0; k < from->count; k++)
            if (number[from->nodes[k]] >= 0) to->nodes[to->count++] = number[from->nodes[k]];
        qsort(to->nodes, (size_t)to->count, sizeof *to->nodes, ascending);
    }
    return BRUNT_OK;
}

static int measure_surface(brunt_fem_body *body, brunt_error *error) {
    brunt_faces faces;
    const int status = brunt_fem_faces(body, &faces, error);
    if (status) return status;
    const int corners = body->traits->face_nodes, edges = body->dim == 3 ? corners : 1;
    double sum = 0;
    for (int32_t f = 0; f < faces.count; f++)
        for (int k = 0; k < edges; k++) {
            const real *a = body->start + (size_t)faces.node[f][k] * 4,
                       *b = body->start + (size_t)faces.node[f][(k + 1) % corners] * 4;
            double square = 0;
            for (int i = 0; i < 3; i++) square += pow((double)b[i] - (double)a[i], 2);
            sum += sqrt(square);
        }
    body->mean_edge = sum / ((double)faces.count * edges);
    brunt_faces_free(&faces);
    return BRUNT_OK;
}

static int allocate_nodes(brunt_fem_body *body, brunt_error *error) {
    if (BRUNT_NEW(body->node, (size_t)body->node_count * BRUNT_FEM_NODE_REALS, "numbers of nodes of a mesh", error) ||
        BRUNT_NEW(body->start, (size_t)body->node_count * 4, "numbers of nodes of a mesh", error) ||
        BRUNT_NEW(body->partial, (size_t)body->partial_count * 4, "numbers of nodes of blocks of a mesh", error) ||
        BRUNT_NEW(body->report, body->block_count, "blocks of a mesh", error))
        return BRUNT_FAILED;
    return body->element->axisymmetric ? BRUNT_NEW(body->held, body->node_count + 1, "nodes of a mesh", error)
                                       : BRUNT_OK;
}

static int make(const brunt_body_def *def, const brunt_mesh *mesh, brunt_fem_body *body, double *mass, int32_t *number,
                brunt_error *error) {
    if (brunt_fem_layout(body, mesh, error) || allocate_nodes(body, error) || allocate_fields(body, error) ||
        number_groups(body, mesh, number, error))
        return BRUNT_FAILED;
    place_nodes(def, mesh, body);
    int status = body->element->axisymmetric ? put_on_axis(body, error) : BRUNT_OK;
    if (!status) status = measure_volumes(body, error);
    if (!status) status = measure_surface(body, error);
    if (status) return status;
    measure_lateral_ratio(body, def->temperature);
    soften_hourglass(body);
    reset_state(body, def->temperature, body->slots);
    brunt_fem_stable_steps(body, def->mass_scaling);
    share_masses(body, mass);
    for (int32_t b = 0; b < body->block_count; b++) body->report[b] = (brunt_fem_report){.bad = -1};
    return BRUNT_OK;
}

static int make_body(const brunt_body_def *def, const brunt_material *material, int dim, bool axisymmetric,
                     const brunt_mesh *mesh, brunt_fem_body *body, brunt_error *error) {
    *body = (brunt_fem_body){.dim = dim,
                             .point_dim = brunt_element_is_membrane(mesh->kind) ? 2
                                          : axisymmetric                        ? 3
                                                                                : dim,
                             .thickness = brunt_element_is_membrane(mesh->kind) ? (real)def->thickness : 0,
                             .contact_thickness = !brunt_element_is_membrane(mesh->kind) ? 0
                                                  : isnan(def->contact_thickness)        ? (real)def->thickness
                                                                                         : (real)def->contact_thickness,
                             .damping = def->damping,
                             .damping_mass = 1,
                             .kind = mesh->kind,
                             .traits = brunt_element_traits_of(mesh->kind),
                             .element = (axisymmetric ? brunt_axisymmetric_elements : brunt_elements)[mesh->kind],
                             .material = *material,
                             .hourglass = def->hourglass};
    memcpy(body->name, def->name, sizeof body->name);
    const double standard = def->hourglass == BRUNT_HOURGLASS_VISCOUS ? 0.1 : 0.05;
    body->hourglass_coefficient = (real)(isnan(def->hourglass_coefficient) ? standard : def->hourglass_coefficient);
    if (!(body->hourglass_coefficient > 0)) body->hourglass = BRUNT_HOURGLASS_STIFFNESS; // no dampers, nor their rates
    if (!body->element)
        return brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s: %s elements do not turn about an axis: tri3 and quad4 do",
                          def->name, brunt_element_name(mesh->kind));
    if (body->traits->dimension != dim)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "bodies.%s: %s elements are %d-dimensional, the scene is %d-dimensional", def->name,
                          body->traits->name, body->traits->dimension, dim);
    if (mesh->element_count < 1)
        return brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s: the mesh has no elements", def->name);
    if (body->traits->membrane && !(def->thickness > 0 && isfinite(def->thickness)))
        return brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s.thickness: %g m is no thickness of a membrane", def->name,
                          def->thickness);
    if (body->traits->membrane && body->element->hourglass_modes && def->hourglass == BRUNT_HOURGLASS_VISCOUS)
        return brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s.hourglass: membranes have the stiffness form only",
                          def->name);
    const element_needs needs = {.mass_scaling = def->mass_scaling > 0,
                                 .membrane = body->traits->membrane,
                                 .viscous_hourglass =
                                     brunt_fem_has_hourglass(body) && body->hourglass == BRUNT_HOURGLASS_VISCOUS};
    list_fields(body, &needs);
    double *mass;
    int32_t *number = NULL;
    int status = BRUNT_NEW(mass, mesh->node_count, "masses of nodes of a mesh", error);
    if (!status) status = BRUNT_NEW(number, mesh->node_count, "numbers of nodes of a mesh", error);
    if (!status) status = make(def, mesh, body, mass, number, error);
    brunt_free(mass);
    brunt_free(number);
    if (status) brunt_fem_free(body);
    return status;
}

int brunt_fem_make(const brunt_body_def *def, const brunt_material *material, int dim, const brunt_mesh *mesh,
                   brunt_fem_body *body, brunt_error *error) {
    return make_body(def, material, dim, false, mesh, body, error);
}

int brunt_fem_make_axisymmetric(const brunt_body_def *def, const brunt_material *material, const brunt_mesh *mesh,
                                brunt_fem_body *body, brunt_error *error) {
    return make_body(def, material, 2, true, mesh, body, error);
}

void brunt_fem_free(brunt_fem_body *body) {
    for (int32_t g = 0; g < body->group_count; g++) brunt_free(body->groups[g].nodes);
    void *const owned[] = {body->node,         body->start,   body->node_id, body->held,       body->load,
                           body->element_id,   body->local,   body->slab,    body->block,      body->block_node,
                           body->element_node, body->partial, body->report,  body->partial_of, body->partial_first,
                           body->groups,       body->bonds,   body->mark,    body->rank};
    for (size_t k = 0; k < sizeof owned / sizeof *owned; k++) brunt_free(owned[k]);
    *body = (brunt_fem_body){0};
}

size_t brunt_fem_bytes(const brunt_fem_body *body) {
    size_t nodes = (size_t)body->node_count, corners = (size_t)body->slots * (size_t)body->traits->nodes;
    size_t bytes = nodes * ((BRUNT_FEM_NODE_REALS + 4) * sizeof(real) + 2 * sizeof(int32_t));
    bytes += body->held ? nodes : 0;
    bytes += body->load ? nodes * 4 * sizeof(real) : 0;
    bytes += corners * (sizeof(int32_t) + sizeof(uint16_t)) + (size_t)body->slots * sizeof(int32_t) + body->slab_bytes;
    bytes += (size_t)body->partial_count * (4 * sizeof(real) + 2 * sizeof(int32_t));
    if (body->bonds) bytes += (nodes + (size_t)body->mesh_elements) * sizeof(int32_t) + (size_t)body->slots;
    return bytes + (size_t)body->block_count * (sizeof *body->block + sizeof *body->report);
}

// See element.inc: copies of the nodes, at most 40 vectors of a stage, 9 components of the gradient and 3 increments.
size_t brunt_fem_tile_reals(const brunt_fem_body *body) {
    return (size_t)body->block_nodes * 12 + (size_t)(40 + 9 + 3) * BRUNT_FEM_TILE;
}

int brunt_fem_workspace_fit(brunt_fem_workspace *work, const brunt_fem_body *body, brunt_error *error) {
    size_t reals = brunt_fem_tile_reals(body);
    if (body->erodes_inverted) reals += (size_t)body->scalar_count * BRUNT_FEM_TILE;
    return BRUNT_CAPACITY_IN(work->memory, work->capacity, reals, 0, "numbers of a thread to work with", error);
}

void brunt_fem_workspace_free(brunt_fem_workspace *work) {
    brunt_free(work->memory);
    *work = (brunt_fem_workspace){0};
}

brunt_material_points brunt_fem_points(brunt_fem_body *body, brunt_component component, int64_t first, int32_t count) {
    brunt_material_points points = {
        .count = count, .dim = body->point_dim, .wave_speed = body->material.wave_speed, .time = body->time};
    real **F = brunt_element_scalars(body, BRUNT_ELEMENT_deformation_gradient),
         **stress = brunt_element_scalars(body, BRUNT_ELEMENT_kirchhoff_stress);
    for (int c = 0; c < BRUNT_MATRIX(body->point_dim); c++) points.F[c] = F[c] + first;
    for (int c = 0; c < BRUNT_SYMMETRIC(body->point_dim); c++) points.stress[c] = stress[c] + first;
    if (body->traits->membrane)
        points.thickness = brunt_element_scalars(body, BRUNT_ELEMENT_thickness_stretch)[0] + first;
    points.volume = brunt_element_scalars(body, BRUNT_ELEMENT_reference_volume)[0] + first;
    const brunt_model *model = body->material.model[component];
    int at = 0;
    for (int f = BRUNT_ELEMENT_BASE_FIELDS; model && f < body->field_count; f++) {
        if (body->field[f].model != model) continue;
        for (int c = 0; c < body->field[f].components; c++)
            points.state[at++] = body->scalar[body->field[f].first + c] + first;
    }
    return points;
}

brunt_point_energy brunt_fem_energy(brunt_fem_body *body, int32_t begin, int32_t end) {
    brunt_point_energy energy = {0};
    for (int32_t b = begin; b < end; b++) {
        const brunt_fem_block *block = &body->block[b];
        int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
        for (int k = 0; k < BRUNT_COMPONENTS; k++) {
            if (!body->material.model[k]) continue;
            brunt_material_points points = brunt_fem_points(body, (brunt_component)k, block->first, padded);
            brunt_material_energy(&body->material, (brunt_component)k, &points, &energy);
        }
    }
    return energy;
}
