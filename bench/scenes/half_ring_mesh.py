#!/usr/bin/env python3
"""Writes the mesh of nested_rings.yaml: the upper half of a ring of triangles between the radii 12 and 14.

usage: half_ring_mesh.py [LAYERS] > half_ring.msh     (gmsh 2.2, ASCII; lengths in metres; LAYERS of elements, default 5)

Its feet, on y = 0, are the group `feet`. Each square is cut along the diagonal that makes the mesh its own mirror image.
"""
import sys
from math import cos, pi, sin

LAYERS = int(sys.argv[1]) if len(sys.argv) > 1 else 5
INNER, OUTER = 12.0, 14.0
ARCS = 2 * round(pi * (INNER + OUTER) / 4 * LAYERS / (OUTER - INNER))


def main():
    nodes = []
    for i in range(ARCS + 1):
        angle = pi * i / ARCS
        for j in range(LAYERS + 1):
            r = INNER + (OUTER - INNER) * j / LAYERS
            nodes.append((r * cos(angle), 0.0 if i in (0, ARCS) else r * sin(angle)))
    elements = []
    for end in (0, ARCS):
        for j in range(LAYERS):
            elements.append((1, 1, [end * (LAYERS + 1) + j + 1, end * (LAYERS + 1) + j + 2]))
    for i in range(ARCS):
        for j in range(LAYERS):
            a = i * (LAYERS + 1) + j + 1
            b, c, d = a + 1, a + LAYERS + 2, a + LAYERS + 1  # a, b outwards; then along the arc
            for corners in ([a, b, c], [a, c, d]) if i < ARCS // 2 else ([a, b, d], [b, c, d]):
                elements.append((2, 2, corners))
    print('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 1 "feet"\n2 2 "ring"\n$EndPhysicalNames')
    print(f"$Nodes\n{len(nodes)}")
    for n, (x, y) in enumerate(nodes, 1):
        print(n, f"{x:.9g} {y:.9g} 0")
    print(f"$EndNodes\n$Elements\n{len(elements)}")
    for e, (kind, group, corners) in enumerate(elements, 1):
        print(e, kind, 2, group, group, *corners)
    print("$EndElements")


main()
