// What is in a file of gmsh, as it is there: nodes, elements of all types and dimensions, physical groups. For gmsh.c
// only.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "brunt.h"

enum { GMSH_TYPE_LIMIT = 32 };

// An element type of gmsh; nodes 0: not known.
typedef struct gmsh_type {
    int dimension, nodes;
    const char *name;
} gmsh_type; // "4-node tetrahedra"
extern const gmsh_type gmsh_types[GMSH_TYPE_LIMIT];

typedef struct gmsh_physical {
    int32_t dimension, tag;
    char *name;
} gmsh_physical; // name: its number when the file has none

// Elements that stand together in the file, of one type and in the same physical groups.
typedef struct gmsh_run {
    int32_t type;
    int64_t count;
    size_t first;                           // of its nodes in `element_nodes`
    int32_t physical_first, physical_count; // in `memberships`
} gmsh_run;

typedef struct gmsh_entity {
    int32_t dimension, tag, physical_first, physical_count;
} gmsh_entity;

typedef struct gmsh_file {
    const char *path;
    char *bytes;
    size_t size; // the whole file, and a 0
    bool binary;
    char version[8]; // "2.2" or "4.1"
    gmsh_physical *physicals;
    int32_t physical_count;
    size_t physical_capacity;
    int32_t *memberships;
    int32_t membership_count;
    size_t membership_capacity; // indices into `physicals`
    gmsh_entity *entities;
    int32_t entity_count;
    size_t entity_capacity; // 4.1; ascending once read
    int32_t node_count;
    int64_t *node_tag; // > 0, each once
    double (*x)[3];    // [m], finite
    int64_t least_tag; // node of a tag: node_of[tag - least_tag] (-1: none) when tags are dense ...
    int32_t *node_of;
    size_t node_of_count;
    struct gmsh_numbered *numbered; // ... and else a search in pairs sorted by tag
    gmsh_run *runs;
    int32_t run_count;
    size_t run_capacity;
    int64_t element_count;
    int32_t *element_nodes;
    size_t element_node_count, element_node_capacity; // indices of nodes
} gmsh_file;

// Reads the file and checks that it is whole: sections closed, counts kept, numbers finite, node tags given once and
// known. BRUNT_BAD_INPUT, BRUNT_IO_ERROR, BRUNT_FAILED; the file is to be freed in any case.
int gmsh_file_read(const char *path, gmsh_file *file, brunt_error *error);
void gmsh_file_free(gmsh_file *file);
