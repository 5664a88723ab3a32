// Fields of bodies that output reads, stored and derived, and the tables of what is asked of bodies.
#pragma once

#include "body/bodies.h"

#define BRUNT_BODY_FIELDS(kind)                                                                                        \
    int32_t brunt_##kind##_field_count(const brunt_body_ref *ref);                                                     \
    brunt_field_info brunt_##kind##_field(const brunt_body_ref *ref, int32_t field);                                   \
    void brunt_##kind##_read(const brunt_body_ref *ref, int32_t field, double *out)
BRUNT_BODY_FIELDS(points); // points_fields.c
BRUNT_BODY_FIELDS(mesh);   // mesh_fields.c
// Nodes of each element of a mesh that it still has, by their numbers in the mesh, in the order of the elements there.
void brunt_mesh_connectivity(const brunt_body_ref *ref, int32_t *out);

// The row of a kind of body, of the functions of these names in its file.
#define BRUNT_BODY_OPS(kind)                                                                                           \
    {                                                                                                                  \
        .parts = parts, .measure = measure, .hash = hash, .name = name, .material = material, .method = method,        \
        .dim = dim, .fineness = fineness, .count = count, .stable_step = stable_step, .first_step = first_step,        \
        .transit = transit, .field_count = brunt_##kind##_field_count, .field = brunt_##kind##_field,                  \
        .read = brunt_##kind##_read, .validate = validate, .block_count = block_count, .block_info = block_info,       \
        .block_get = block_get, .block_set = block_set                                                                 \
    }
