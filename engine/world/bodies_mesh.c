// Bodies of finite elements from their definitions.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "world/create.h"

// Nodes that no element uses are left out: the others are numbered without gaps, in the mesh's order.
static int close_ranks(brunt_fem_body *fem, int32_t mesh_nodes, brunt_error *error) {
    if (fem->node_count == mesh_nodes) return BRUNT_OK;
    int32_t *rank, next = 0;
    if (BRUNT_NEW(rank, mesh_nodes + 1, "ranks of nodes of a mesh", error)) return BRUNT_FAILED;
    for (int32_t n = 0; n < fem->node_count; n++) rank[fem->node_id[n]] = 1;
    for (int32_t i = 0; i < mesh_nodes; i++)
        if (rank[i]) rank[i] = next++;
    for (int32_t n = 0; n < fem->node_count; n++) fem->node_id[n] = rank[fem->node_id[n]];
    brunt_free(rank);
    return BRUNT_OK;
}

static bool is_graded(const brunt_body_def *def) {
    return def->grading[0].count || def->grading[1].count || def->grading[2].count;
}

static int check_numbers(const brunt_body_def *from, brunt_error *error) {
    const bool membrane = from->method == BRUNT_MEMBRANE;
    if (membrane && !(from->thickness > 0 && isfinite(from->thickness)))
        REFUSE("bodies.%s.thickness: %g m is not a positive length", from->name, from->thickness);
    if (is_graded(from) && (membrane || from->mesh.node_count || from->shape.kind != BRUNT_BOX))
        REFUSE("bodies.%s.grading: only the mesh of a box of method fem is graded", from->name);
    if (!from->mesh.node_count && !(from->size > 0))
        REFUSE("bodies.%s.size: %g m is not a positive length", from->name, from->size);
    return BRUNT_OK;
}

static int mesh_of_shape(const brunt_body_def *from, int dimension, brunt_mesh *mesh, brunt_error *error) {
    if (from->method == BRUNT_MEMBRANE)
        return brunt_mesh_surface(&from->shape, from->element, from->size,
                                  (const char(*)[BRUNT_NAME_LENGTH])from->faces, from->face_count, mesh, error);
    if (is_graded(from))
        return brunt_mesh_graded(&from->shape, dimension, from->element, from->size, from->grading, mesh, error);
    return brunt_mesh_shape(&from->shape, dimension, from->element, from->size, mesh, error);
}

// The nodes' velocities at the start.
static void set_motion(brunt_fem_body *fem, const brunt_world_def *def, const brunt_body_def *from) {
    for (int32_t n = 0; n < fem->node_count; n++) {
        real *node = brunt_fem_node(fem, n);
        double x[3], v[3], gradient[3][3];
        for (int a = 0; a < 3; a++) x[a] = (double)node[a];
        brunt_start_motion(from, def->dimension, x, v, gradient);
        for (int a = 0; a < def->dimension; a++) node[BRUNT_FEM_V + a] = (real)v[a];
        if (def->axisymmetric && fem->held[n]) node[BRUNT_FEM_V] = 0; // on the axis
    }
}

int brunt_make_elements(brunt_world *world, const brunt_world_def *def, const brunt_body_def *from, int index,
                        brunt_error *error) {
    brunt_fem_body *fem = &world->bodies.fem[world->bodies.fem_count];
    brunt_mesh_report *report = &world->bodies.mesh_reports[world->bodies.fem_count++];
    world->bodies.all[index] = (brunt_body_ref){.ops = &brunt_mesh_ops, .fem = fem};
    brunt_mesh made = {0};
    brunt_material material;
    const bool membrane = from->method == BRUNT_MEMBRANE;
    int status = check_numbers(from, error);
    if (status) return status;
    if (!from->mesh.node_count) status = mesh_of_shape(from, def->dimension, &made, error);
    const brunt_mesh *mesh = from->mesh.node_count ? &from->mesh : &made;
    if (!status) status = brunt_mesh_check(mesh, &report->quality, error);
    if (status && error) {
        char reason[sizeof error->message];
        memcpy(reason, error->message, sizeof reason);
        brunt_fail(error, error->code, "bodies.%s: %.900s", from->name, reason);
    }
    if (!status && brunt_element_is_membrane(mesh->kind) != membrane)
        status = brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s: elements of kind %s are not for method %s", from->name,
                            brunt_element_name(mesh->kind), membrane ? "membrane" : "fem");
    const brunt_material_def *law = &def->materials[from->material];
    if (!status)
        status = membrane ? brunt_material_make_membrane(law, from->tension_only, &material, error)
                          : brunt_material_make(law, &material, error);
    if (!status) brunt_material_set_temperature(&material, from->temperature);
    if (!status)
        status = def->axisymmetric ? brunt_fem_make_axisymmetric(from, &material, mesh, fem, error)
                                   : brunt_fem_make(from, &material, def->dimension, mesh, fem, error);
    if (!status) status = close_ranks(fem, mesh->node_count, error);
    if (!status) {
        fem->index = index;
        report->least_step = fem->least_step;
        report->added_mass = fem->added_mass, report->scaled_elements = fem->scaled_elements;
        if (report->quality.duplicate_nodes)
            brunt_warn(&world->messages, "bodies.%s: %d nodes of the mesh lie on others: the body is not joined there",
                       from->name, report->quality.duplicate_nodes);
        if (report->quality.worst_shape < 0.1)
            brunt_warn(&world->messages, "bodies.%s: element %d is nearly flat (shape %.2g, 1 is regular)", from->name,
                       report->quality.worst + 1, report->quality.worst_shape);
    }
    if (!status) set_motion(fem, def, from);
    brunt_mesh_free(&made);
    return status;
}
