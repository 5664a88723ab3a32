// Nodes of a file of gmsh, and which has a tag. For gmsh_read.c only.
#pragma once

#include "io/mesh/gmsh_cursor.h"

// The section $Nodes of version 2.2, after its count, and of 4.1.
void gmsh_read_nodes_2(gmsh_cursor *c);
void gmsh_read_nodes_4(gmsh_cursor *c);
// Once all nodes are there. Complains of a tag that is given twice.
void gmsh_number_nodes(gmsh_cursor *c);
// Node of a tag, BRUNT_NONE: none.
int32_t gmsh_find_node(const gmsh_file *file, int64_t tag);
