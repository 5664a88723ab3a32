#!/usr/bin/env python3
"""Writes the mesh of cube_twist.yaml: the lower half of a spherical shell of tetrahedra between the radii 0.45 and 0.5.

usage: bowl_mesh.py [PARTS] > bowl.msh     (gmsh 2.2, ASCII; lengths in metres; PARTS of a quarter of the rim, default 5)

Its lowest point is (0, 0, 1.01). The faces of an octahedron are cut into PARTS^2 triangles each and drawn out to the sphere; the
group `top` is what is above half of the radius.
"""
import sys
from math import sqrt

PARTS = int(sys.argv[1]) if len(sys.argv) > 1 else 5
INNER, OUTER, CENTER = 0.45, 0.5, 1.51
CORNERS = [(1, 0), (0, 1), (-1, 0), (0, -1)]


def main():
    number, nodes, triangles, tetrahedra = {}, [], [], []

    def node(p):
        if p not in number:
            size = sqrt(sum(c * c for c in p))
            number[p] = len(nodes) // 2
            for r in (INNER, OUTER):
                nodes.append([r * c / size for c in p])
        return number[p]

    for quarter in range(4):
        (ax, ay), (bx, by) = CORNERS[quarter], CORNERS[(quarter + 1) % 4]

        def at(i, j):  # i parts towards one corner of the rim, j towards the next, the rest down
            return node((i * ax + j * bx, i * ay + j * by, i + j - PARTS))

        for i in range(PARTS):
            for j in range(PARTS - i):
                triangles.append((at(i, j), at(i + 1, j), at(i, j + 1)))
                if i + j < PARTS - 1:
                    triangles.append((at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)))
    for triangle in triangles:
        # A prism in three, cut so that neighbours agree: its sides go from the inner node of the smaller number.
        a, b, c = sorted(triangle)
        for t in ((2 * a, 2 * b, 2 * c, 2 * c + 1), (2 * a, 2 * b, 2 * c + 1, 2 * b + 1), (2 * a, 2 * b + 1, 2 * c + 1, 2 * a + 1)):
            p, q, r, s = (nodes[n] for n in t)
            e, f, g = ([v[k] - p[k] for k in range(3)] for v in (q, r, s))
            volume = sum(e[k] * (f[(k + 1) % 3] * g[(k + 2) % 3] - f[(k + 2) % 3] * g[(k + 1) % 3]) for k in range(3))
            tetrahedra.append(t if volume > 0 else (t[1], t[0], t[2], t[3]))
    top = [n for n in range(len(nodes)) if nodes[n][2] > -OUTER / 2 + 1e-9]
    print('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n0 1 "top"\n3 2 "bowl"\n$EndPhysicalNames')
    print(f"$Nodes\n{len(nodes)}")
    for n, (x, y, z) in enumerate(nodes, 1):
        print(n, f"{x:.9g} {y:.9g} {z + CENTER:.9g}")
    print(f"$EndNodes\n$Elements\n{len(top) + len(tetrahedra)}")
    for e, n in enumerate(top, 1):
        print(e, 15, 2, 1, 1, n + 1)
    for e, t in enumerate(tetrahedra, len(top) + 1):
        print(e, 4, 2, 2, 2, *(n + 1 for n in t))
    print("$EndElements")


main()
