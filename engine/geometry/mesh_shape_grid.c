// Structured grids of quadrilaterals and hexahedra: quadrilateral, ball in two and three dimensions, annulus,
// extrusion.
//
// The ball (2D: disk) is a cube with `core` cells a side, bulged towards the ball, and `shells` layers of cells between
// each of its sides and the surface ("O-grid", "cubed ball"). With q in [-1,1]^d, w = max |q_i| and S(q) the
// equiangular projection on the unit ball's surface (Ronchi, Iacono and Paolucci 1996, "The cubed sphere", J. Comput.
// Phys. 124; in 2D equal angles), the core is c [(1 - b w) q / sqrt(d) + b w^2 S(q)], whose corners lie at c for every
// b, and a shell point at share s of the way is (1 - s) core(q) + s S(q) with w = 1. Nodes with s = 1 lie on the
// surface up to rounding. b = 0 is a straight-sided core, whose corner cells are squeezed, b = 1 a round one, whose
// corners are flat.
#include "geometry/mesh_shape.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

// c and b, found by trying c from 0.5 to 0.8 and b from 0.2 to 0.9 with even cores of 2 to 40 cells: the least scaled
// Jacobian of a ball's hexahedra is then 0.68 or more at any size and that of its tetrahedra 0.25 (c = 0.62: 0.21; b =
// 0.35: 0.23; odd cores, which cannot be cut symmetrically: 0.16 to 0.24). Half as many shells as core cells give the
// ball of n core cells a side 4 n^3 cells, the disk 3 n^2: edges of R/n in the mean, 0.62 R/n in the core to 1.57 R/n
// around.
static const double core_extent = 0.541, core_bulge = 0.45;

static const double pi = 3.14159265358979323846;

void brunt_mesh_grid_free(brunt_mesh_grid *grid) {
    brunt_free(grid->x);
    brunt_free(grid->rank);
    brunt_free(grid->groups);
    brunt_free(grid->cell);
    *grid = (brunt_mesh_grid){0};
}

// So many that node numbers, and those of six tetrahedra a cell, fit 32 bits, and that memory is not asked for in vain.
static const double count_limit = 100e6;

// A grid that is to be extruded is refused when the extrusion would be.
static int allocate(int dimension, double nodes, double cells, brunt_mesh_grid *grid) {
    double layers = grid->layers;
    *grid = (brunt_mesh_grid){.dimension = dimension};
    if (!(nodes * (layers + 1) < count_limit) || !(cells * (layers + 1) < count_limit)) return BRUNT_GRID_TOO_MANY;
    grid->node_count = (int32_t)nodes;
    grid->cell_count = (int32_t)cells;
    grid->x = brunt_alloc((size_t)grid->node_count * sizeof *grid->x);
    grid->rank = brunt_alloc((size_t)grid->node_count * sizeof *grid->rank);
    grid->groups = brunt_alloc((size_t)grid->node_count * sizeof *grid->groups);
    grid->cell = brunt_alloc((size_t)grid->cell_count * sizeof *grid->cell);
    if (grid->x && grid->rank && grid->groups && grid->cell) return 0;
    brunt_mesh_grid_free(grid);
    return BRUNT_GRID_MEMORY;
}

int brunt_mesh_grid_keep(int axis, bool upper, double at, brunt_mesh_grid *grid) {
    const int corners = grid->dimension == 2 ? 4 : 8;
    int32_t cells = 0, nodes = 0, *number = brunt_alloc(((size_t)grid->node_count + 1) * sizeof *number);
    if (!number) return BRUNT_GRID_MEMORY;
    for (int32_t c = 0; c < grid->cell_count; c++) {
        bool stays = true;
        for (int a = 0; a < corners; a++) {
            const double x = grid->x[grid->cell[c][a]][axis];
            stays = stays && (upper ? x >= at : x <= at);
        }
        if (!stays) continue;
        for (int a = 0; a < corners; a++) number[grid->cell[c][a]] = 1;
        memmove(grid->cell[cells++], grid->cell[c], sizeof *grid->cell);
    }
    for (int32_t n = 0; n < grid->node_count; n++) {
        if (!number[n]) continue;
        memmove(grid->x[nodes], grid->x[n], sizeof *grid->x);
        grid->rank[nodes] = grid->rank[n], grid->groups[nodes] = grid->groups[n];
        number[n] = nodes++;
    }
    for (int32_t c = 0; c < cells; c++)
        for (int a = 0; a < corners; a++) grid->cell[c][a] = number[grid->cell[c][a]];
    grid->node_count = nodes, grid->cell_count = cells;
    brunt_free(number);
    return 0;
}

// Point i of n between a and b. Exactly a and b at the ends, exactly a everywhere when b is a, and mirrored bit for
// bit.
static double between(double a, double b, int32_t i, int32_t n) {
    return 2 * (int64_t)i <= n ? a + (b - a) * i / n : b - (b - a) * (n - i) / n;
}

// ---------------------------------------------------------------------------------------------------- quadrilateral

int brunt_mesh_grid_quadrilateral(const double corner[4][2], const int32_t count[2], brunt_mesh_grid *grid) {
    int32_t nx = count[0], ny = count[1];
    int status = allocate(2, (nx + 1.0) * (ny + 1.0), (double)nx * ny, grid);
    if (status) return status;
    for (int32_t j = 0; j <= ny; j++) {
        for (int32_t i = 0; i <= nx; i++) {
            int32_t node = j * (nx + 1) + i;
            for (int d = 0; d < 2; d++) {
                double lower = between(corner[0][d], corner[1][d], i, nx),
                       upper = between(corner[3][d], corner[2][d], i, nx);
                grid->x[node][d] = between(lower, upper, j, ny);
            }
            grid->rank[node] = (uint8_t)(i % 2 + j % 2);
            grid->groups[node] = (uint16_t)((j == 0) | (i == nx) << 1 | (j == ny) << 2 | (i == 0) << 3);
        }
    }
    for (int32_t j = 0; j < ny; j++) {
        for (int32_t i = 0; i < nx; i++) {
            int32_t *c = grid->cell[j * nx + i], node = j * (nx + 1) + i;
            c[0] = node, c[1] = node + 1, c[2] = node + nx + 2, c[3] = node + nx + 1;
        }
    }
    return 0;
}

// ---------------------------------------------------------------------------------------------------- ball

typedef struct ball {
    int dimension;
    int32_t core, shells;
    double radius;
    int32_t stride[3]; // of the core's lattice
    int32_t core_nodes, rim_count;
    int32_t *rim; // of each core node: its place among those on the core's surface, -1 inside
} ball;

// S(q), of unit length.
static void project(const double *q, int dimension, double w, double *s) {
    double square = 0;
    for (int d = 0; d < dimension; d++) {
        s[d] = fabs(q[d]) == w ? copysign(1, q[d]) : tan(pi / 4 * (q[d] / w));
        square += s[d] * s[d];
    }
    for (int d = 0; d < dimension; d++) s[d] /= sqrt(square);
}

// The point at share `out` of the way from the core's point q to the surface; out is 0 inside the core.
static void ball_point(const ball *b, const double *q, double out, double *x) {
    int dim = b->dimension;
    double w = 0, s[3] = {0};
    for (int d = 0; d < dim; d++) w = fmax(w, fabs(q[d]));
    if (w > 0) project(q, dim, w, s);
    for (int d = 0; d < dim; d++) {
        double core = core_extent * ((1 - core_bulge * w) * q[d] / sqrt(dim) + core_bulge * w * w * s[d]);
        x[d] = b->radius * (out == 1 ? s[d] : (1 - out) * core + out * s[d]);
    }
}

static int32_t shell_node(const ball *b, int32_t core_node, int32_t shell) {
    return shell == 0 ? core_node : b->core_nodes + (shell - 1) * b->rim_count + b->rim[core_node];
}

static void ball_nodes(const ball *b, brunt_mesh_grid *grid) {
    for (int32_t node = 0; node < b->core_nodes; node++) {
        double q[3];
        int odd = 0;
        for (int d = 0; d < b->dimension; d++) {
            int32_t i = node / b->stride[d] % (b->core + 1);
            q[d] = between(-1, 1, i, b->core);
            odd += i % 2;
        }
        ball_point(b, q, 0, grid->x[node]);
        grid->rank[node] = (uint8_t)odd;
        if (b->rim[node] < 0) continue;
        for (int32_t s = 1; s <= b->shells; s++) {
            int32_t outer = shell_node(b, node, s);
            ball_point(b, q, (double)s / b->shells, grid->x[outer]);
            grid->rank[outer] = (uint8_t)(odd + s % 2);
            grid->groups[outer] = s == b->shells;
        }
    }
}

// Corner a of a cell of VTK's order, as steps along the first, second, third direction.
static const int8_t corner_step[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                         {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

static int32_t ball_core_cells(const ball *b, brunt_mesh_grid *grid) {
    int32_t made = 0, nz = b->dimension == 3 ? b->core : 1;
    for (int32_t k = 0; k < nz; k++)
        for (int32_t j = 0; j < b->core; j++)
            for (int32_t i = 0; i < b->core; i++, made++)
                for (int a = 0; a < 1 << b->dimension; a++)
                    grid->cell[made][a] = (i + corner_step[a][0]) * b->stride[0] +
                                          (j + corner_step[a][1]) * b->stride[1] +
                                          (k + corner_step[a][2]) * b->stride[2];
    return made;
}

// The cells over one side of the core, that at its least or greatest index along `axis`. The side's own directions are
// taken so that (first, second, outwards) is right-handed; in 2D the one direction runs clockwise, for (outwards, back
// along it) to be so.
static int32_t ball_side_cells(const ball *b, int axis, bool upper, int32_t made, brunt_mesh_grid *grid) {
    int dim = b->dimension, first = (axis + 1) % dim, second = (axis + 2) % dim;
    if (dim == 3 && !upper) first = (axis + 2) % 3, second = (axis + 1) % 3;
    int32_t base = upper ? b->core * b->stride[axis] : 0, rows = dim == 3 ? b->core : 1;
    bool forwards = upper == (axis == 0); // counter-clockwise: +y on the right side, -x on the upper one
    for (int32_t s = 0; s < b->shells; s++) {
        for (int32_t j = 0; j < rows; j++) {
            for (int32_t i = 0; i < b->core; i++, made++) {
                int32_t *cell = grid->cell[made];
                if (dim == 3) {
                    for (int a = 0; a < 8; a++) {
                        int32_t node = base + (i + corner_step[a][0]) * b->stride[first] +
                                       (j + corner_step[a][1]) * b->stride[second];
                        cell[a] = shell_node(b, node, s + corner_step[a][2]);
                    }
                } else {
                    int32_t from = base + (i + !forwards) * b->stride[first],
                            to = base + (i + forwards) * b->stride[first];
                    cell[0] = shell_node(b, from, s), cell[1] = shell_node(b, from, s + 1);
                    cell[2] = shell_node(b, to, s + 1), cell[3] = shell_node(b, to, s);
                }
            }
        }
    }
    return made;
}

int brunt_mesh_grid_ball(int dimension, double radius, int32_t core, int32_t shells, brunt_mesh_grid *grid) {
    double n = core, core_nodes = pow(n + 1, dimension), rim = core_nodes - pow(n - 1, dimension);
    double core_cells = pow(n, dimension), sides = 2 * dimension * pow(n, dimension - 1);
    int status = allocate(dimension, core_nodes + rim * shells, core_cells + sides * shells, grid);
    if (status) return status;
    ball b = {
        .dimension = dimension, .core = core, .shells = shells, .radius = radius, .core_nodes = (int32_t)core_nodes};
    b.stride[0] = 1, b.stride[1] = core + 1, b.stride[2] = dimension == 3 ? (core + 1) * (core + 1) : 0;
    b.rim = brunt_alloc((size_t)b.core_nodes * sizeof *b.rim);
    if (!b.rim) {
        brunt_mesh_grid_free(grid);
        return BRUNT_GRID_MEMORY;
    }
    for (int32_t node = 0; node < b.core_nodes; node++) {
        bool outside = false;
        for (int d = 0; d < dimension; d++) outside |= node / b.stride[d] % (core + 1) % core == 0;
        b.rim[node] = outside ? b.rim_count++ : -1;
    }
    ball_nodes(&b, grid);
    int32_t made = ball_core_cells(&b, grid);
    for (int axis = 0; axis < dimension; axis++)
        for (int upper = 0; upper < 2; upper++) made = ball_side_cells(&b, axis, upper, made, grid);
    brunt_free(b.rim);
    return 0;
}

// ---------------------------------------------------------------------------------------------------- annulus

int brunt_mesh_grid_annulus(double inner, double outer, int32_t around, int32_t layers, brunt_mesh_grid *grid) {
    int status = allocate(2, around * (layers + 1.0), (double)around * layers, grid);
    if (status) return status;
    for (int32_t k = 0; k <= layers; k++) {
        double r = between(inner, outer, k, layers);
        for (int32_t p = 0; p < around; p++) {
            // Quarters are turned copies of the first, so that nodes on the axes lie on them exactly.
            int32_t quarter = p / (around / 4), step = p % (around / 4), node = k * around + p;
            double angle = pi / 2 * step / (around / 4), u = r * cos(angle), v = r * sin(angle);
            grid->x[node][0] = quarter == 0 ? u : quarter == 1 ? -v : quarter == 2 ? -u : v;
            grid->x[node][1] = quarter == 0 ? v : quarter == 1 ? u : quarter == 2 ? -v : -u;
            grid->rank[node] = (uint8_t)(k % 2 + p % 2);
            grid->groups[node] = (uint16_t)((k == 0) | (k == layers) << 1);
        }
    }
    for (int32_t k = 0; k < layers; k++) {
        for (int32_t p = 0; p < around; p++) {
            int32_t *c = grid->cell[k * around + p], next = (p + 1) % around;
            c[0] = k * around + p, c[1] = c[0] + around, c[2] = (k + 1) * around + next, c[3] = k * around + next;
        }
    }
    return 0;
}

// ---------------------------------------------------------------------------------------------------- extrusion

int brunt_mesh_grid_extrude(double from, double to, int32_t layers, brunt_mesh_grid *grid) {
    brunt_mesh_grid flat = *grid;
    int status = allocate(3, flat.node_count * (layers + 1.0), (double)flat.cell_count * layers, grid);
    for (int32_t k = 0; k <= layers && !status; k++) {
        for (int32_t n = 0; n < flat.node_count; n++) {
            int32_t node = k * flat.node_count + n;
            memcpy(grid->x[node], flat.x[n], 2 * sizeof(double));
            grid->x[node][2] = between(from, to, k, layers);
            grid->rank[node] = (uint8_t)(flat.rank[n] + k % 2);
            grid->groups[node] =
                (uint16_t)(flat.groups[n] | (k == 0) << BRUNT_GRID_START | (k == layers) << BRUNT_GRID_END);
        }
        for (int32_t c = 0; c < flat.cell_count && k < layers; c++)
            for (int a = 0; a < 8; a++)
                grid->cell[k * flat.cell_count + c][a] = flat.cell[c][a % 4] + (k + a / 4) * flat.node_count;
    }
    brunt_mesh_grid_free(&flat);
    return status;
}
