// Meshes of triangles that lie behind material points.
#pragma once

#include "grid/grid.h"
#include "tests/support/def_world.h"

// A place off the lattice by up to a quarter, by its number alone.
static inline double triangle_mesh_off(int32_t n) { return 0.25 * sin(12.9898 * n + 4.1); }

// A rectangle from (x, y), nodes i * (across + 1) + j; inner ones are off the lattice, diagonals go either way.
static inline brunt_mesh triangle_mesh(double x, double y, int along, int across, double edge) {
    brunt_mesh m = {.kind = BRUNT_TRI3, .node_count = (along + 1) * (across + 1), .element_count = 2 * along * across};
    m.nodes = brunt_def_alloc((size_t)m.node_count * sizeof *m.nodes);
    m.elements = brunt_def_alloc((size_t)m.element_count * 3 * sizeof *m.elements);
    for (int32_t n = 0; n < m.node_count; n++) {
        const int i = n / (across + 1), j = n % (across + 1);
        const bool inner = i > 0 && i < along && j > 0 && j < across;
        m.nodes[n][0] = x + edge * (i + inner * triangle_mesh_off(2 * n));
        m.nodes[n][1] = y + edge * (j + inner * triangle_mesh_off(2 * n + 1));
    }
    int32_t *e = m.elements;
    for (int i = 0; i < along; i++)
        for (int j = 0; j < across; j++, e += 6) {
            const int32_t a = i * (across + 1) + j, b = a + across + 1;
            const int32_t one[6] = {a, b, b + 1, a, b + 1, a + 1}, other[6] = {a, b, a + 1, b, b + 1, a + 1};
            memcpy(e, (i + j) % 3 ? one : other, sizeof one);
        }
    return m;
}

// A definition whose points go with a kernel by its number in grid.h; those of a mesh have this one, which it owns.
static inline void use_kernel(brunt_world_def *def, int kernel, brunt_mesh mesh) {
    def->kernel = (brunt_kernel)(kernel > BRUNT_CUBIC ? BRUNT_LINEAR : kernel);
    def->cells = kernel == BRUNT_GRID_MESH  ? BRUNT_MESH_CELLS
                 : kernel == BRUNT_GRID_CUT ? BRUNT_TRIANGLES
                                            : BRUNT_QUADS;
    if (kernel == BRUNT_GRID_MESH)
        def->background = mesh;
    else
        brunt_mesh_free(&mesh);
}
