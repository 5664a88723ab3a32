// What a mesh owns.
#include "brunt.h"
#include "base/memory.h"

void brunt_mesh_free(brunt_mesh *mesh) {
    for (int32_t g = 0; g < mesh->group_count; g++) brunt_free(mesh->groups[g].nodes);
    brunt_free(mesh->groups);
    brunt_free(mesh->nodes);
    brunt_free(mesh->elements);
    *mesh = (brunt_mesh){0};
}
