// Meshes as data: the kinds of element, and what a mesh owns.
#include "brunt.h"
#include "base/memory.h"

static const struct {
    const char *name;
    int nodes, dimension;
    bool sheet;
} kinds[BRUNT_ELEMENT_KINDS] = {
    [BRUNT_TET4] = {"tet4", 4, 3, false},
    [BRUNT_HEX8] = {"hex8", 8, 3, false},
    [BRUNT_TRI3] = {"tri3", 3, 2, false},
    [BRUNT_QUAD4] = {"quad4", 4, 2, false},
    [BRUNT_MEMBRANE_QUAD4] = {"membrane_quad4", 4, 3, true},
    [BRUNT_MEMBRANE_TRI3] = {"membrane_tri3", 3, 3, true},
};

// Of a number that is no kind: a name that says so, no nodes, no dimension.
static bool known(brunt_element_kind kind) { return (unsigned)kind < BRUNT_ELEMENT_KINDS; }

const char *brunt_element_name(brunt_element_kind kind) { return known(kind) ? kinds[kind].name : "unknown"; }
int brunt_element_nodes(brunt_element_kind kind) { return known(kind) ? kinds[kind].nodes : 0; }
int brunt_element_dimension(brunt_element_kind kind) { return known(kind) ? kinds[kind].dimension : 0; }
bool brunt_element_is_sheet(brunt_element_kind kind) { return known(kind) && kinds[kind].sheet; }

void brunt_mesh_free(brunt_mesh *mesh) {
    for (int32_t g = 0; g < mesh->group_count; g++) brunt_free(mesh->groups[g].nodes);
    brunt_free(mesh->groups);
    brunt_free(mesh->nodes);
    brunt_free(mesh->elements);
    *mesh = (brunt_mesh){0};
}
