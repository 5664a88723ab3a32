// Meshes of gmsh: files of format 4.1 and 2.2, in text or binary.
//
// Written after the gmsh reference manual, chapter "File formats" (Geuzaine and Remacle 2009, Int. J. Numer. Meth.
// Engng 79).
#pragma once

#include <stdio.h>

#include "brunt.h"

// Reads the body that is the physical group named `group`, of dimension `dimension` (2 or 3); "" or NULL is all
// elements of that dimension, when the file has no more than one group of them. A group without a name has its number
// for one. Elements are all of one kind of brunt_element_kind. Physical groups of lower dimension become groups of the
// mesh, with those of their nodes that the body has. Elements and nodes keep the order of the file; nodes the body does
// not use are left out. A body that is inside out as a whole is turned over. What was left out or turned is said on
// `warnings` (NULL: nowhere), a line each. BRUNT_BAD_INPUT, with the line or for binary files the byte, for a file that
// is not such a mesh; BRUNT_IO_ERROR when it cannot be read; BRUNT_FAILED without memory. The mesh is empty after an
// error; it is not checked by brunt_mesh_check.
int brunt_gmsh_read(const char *path, const char *group, int dimension, brunt_mesh *mesh, FILE *warnings,
                    brunt_error *error);
// The same of a surface in three dimensions, as sheets: its triangles or quadrangles become elements of a membrane
// kind, turned as they are in the file. Physical groups of surfaces, too, become groups of the mesh, and all nodes are
// its group `surface`. A file that has solid elements as well needs the name of the physical surface.
int brunt_gmsh_read_membrane(const char *path, const char *group, brunt_mesh *mesh, FILE *warnings, brunt_error *error);

// Facets of a surface in three dimensions: those of the physical group, or of the file when there is no more than one,
// in the order of the file and turned as they are there.
typedef struct brunt_gmsh_facets {
    double (*points)[3]; // [m]; of the facets only, in the order of the file
    int32_t point_count;
    int32_t (*corners)[4]; // of each facet; -1: a triangle has none
    int32_t count;
} brunt_gmsh_facets;
// Triangles and quadrangles, for brunt_free; errors as above, after which there is nothing to free.
int brunt_gmsh_read_facets(const char *path, const char *group, brunt_gmsh_facets *facets, brunt_error *error);

// Says what is in a file: format, nodes and elements by kind, bounds, physical groups, and of each that can be a body
// its quality. Errors as above.
int brunt_gmsh_describe(const char *path, FILE *out, brunt_error *error);
