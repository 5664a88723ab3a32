// Triangles of quadrilaterals and tetrahedra of hexahedra.
//
// A quadrilateral is cut by the diagonal through its first node, by rank and then by number: neighbours cut a face they
// share alike, whatever they are (Dompierre, Labbe, Vallet and Camarero 1999, "How to subdivide pyramids, prisms and
// hexahedra into tetrahedra", 8th International Meshing Roundtable). A hexahedron is the cone from its first node over
// the triangles of the three faces it is not on. The rank is the number of odd lattice indices: where a lattice is not
// disturbed this makes the triangulation known as J1 or union jack (Todd 1976): Kuhn's six tetrahedra around one
// diagonal, in cells that are mirror images of their neighbours, so that a mesh with an even number of cells keeps the
// mirror symmetry of its shape.
#include "geometry/mesh_shape.h"

// Faces of a hexahedron, counter-clockwise seen from outside.
static const uint8_t hex_face[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                       {2, 3, 7, 6}, {1, 2, 6, 5}, {0, 4, 7, 3}};

static bool comes_before(const brunt_mesh_grid *grid, int32_t a, int32_t b) {
    return grid->rank[a] != grid->rank[b] ? grid->rank[a] < grid->rank[b] : a < b;
}

static int first_of(const brunt_mesh_grid *grid, const int32_t *nodes, int count) {
    int first = 0;
    for (int a = 1; a < count; a++)
        if (comes_before(grid, nodes[a], nodes[first])) first = a;
    return first;
}

static void cut_face(const brunt_mesh_grid *grid, const int32_t face[4], int32_t triangle[2][3]) {
    int a = first_of(grid, face, 4);
    for (int t = 0; t < 2; t++) {
        triangle[t][0] = face[a];
        triangle[t][1] = face[(a + t + 1) % 4];
        triangle[t][2] = face[(a + t + 2) % 4];
    }
}

static void cut_hexahedron(const brunt_mesh_grid *grid, const int32_t *cell, int32_t tetrahedron[6][4]) {
    int apex = first_of(grid, cell, 8), made = 0;
    for (int f = 0; f < 6; f++) {
        int32_t face[4], triangle[2][3];
        bool holds_apex = false;
        for (int a = 0; a < 4; a++) {
            face[a] = cell[hex_face[f][a]];
            holds_apex |= hex_face[f][a] == apex;
        }
        if (holds_apex) continue;
        cut_face(grid, face, triangle);
        for (int t = 0; t < 2; t++, made++) { // seen from the apex the triangle runs clockwise: turned over
            tetrahedron[made][0] = triangle[t][0];
            tetrahedron[made][1] = triangle[t][2];
            tetrahedron[made][2] = triangle[t][1];
            tetrahedron[made][3] = cell[apex];
        }
    }
}

void brunt_mesh_grid_split(const brunt_mesh_grid *grid, int32_t *elements) {
    for (int32_t c = 0; c < grid->cell_count; c++) {
        if (grid->dimension == 2)
            cut_face(grid, grid->cell[c], (int32_t(*)[3])(elements + (size_t)c * 6));
        else
            cut_hexahedron(grid, grid->cell[c], (int32_t(*)[4])(elements + (size_t)c * 24));
    }
}
