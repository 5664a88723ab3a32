#!/usr/bin/env python3
"""Writes the mesh of belt.yaml: a belt of quadrangles over a drum of radius 100 mm, half round it, with straight ends.

usage: belt_mesh.py [ARCS] > belt.msh     (gmsh 2.2, ASCII; lengths in metres; ARCS of elements round the drum, default 32)

It is 2 mm thick, of two layers; its ends, 50 mm below the middle of the drum, are the groups `left` and `right`.
"""
import sys
from math import cos, pi, sin

ARCS = int(sys.argv[1]) if len(sys.argv) > 1 else 32
RADIUS, THICKNESS, LAYERS, END = 0.1, 2e-3, 2, 0.05


def places():
    """Where the belt goes, from its left end to its right one: a point on the drum, and the direction away from it."""
    straight = round(END * ARCS / (pi * RADIUS))
    for k in range(straight, 0, -1):
        yield -RADIUS, -END * k / straight, -1, 0
    for k in range(ARCS + 1):
        c, s = -cos(pi * k / ARCS), sin(pi * k / ARCS) if 0 < k < ARCS else 0.0
        yield RADIUS * c, RADIUS * s, c, s
    for k in range(1, straight + 1):
        yield RADIUS, -END * k / straight, 1, 0


def main():
    nodes = []
    for x, y, across, up in places():
        for j in range(LAYERS + 1):
            t = THICKNESS * j / LAYERS
            nodes.append((x + t * across, y + t * up))
    row = LAYERS + 1
    columns = len(nodes) // row - 1
    elements = []
    for group, end in ((1, 0), (2, columns)):
        for j in range(LAYERS):
            elements.append((1, group, [end * row + j + 1, end * row + j + 2]))
    for i in range(columns):
        for j in range(LAYERS):
            a = i * row + j + 1
            elements.append((3, 3, [a, a + row, a + row + 1, a + 1]))
    print('$MeshFormat\n2.2 0 8\n$EndMeshFormat')
    print('$PhysicalNames\n3\n1 1 "left"\n1 2 "right"\n2 3 "belt"\n$EndPhysicalNames')
    print(f"$Nodes\n{len(nodes)}")
    for n, (x, y) in enumerate(nodes, 1):
        print(n, f"{x:.9g} {y:.9g} 0")
    print(f"$EndNodes\n$Elements\n{len(elements)}")
    for e, (kind, group, corners) in enumerate(elements, 1):
        print(e, kind, 2, group, group, *corners)
    print("$EndElements")


main()
