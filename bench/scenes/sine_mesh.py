#!/usr/bin/env python3
"""Writes the mesh of sine_boundary.yaml: a rigid slab whose lower side is y = 1.225 + cos(2 pi x / 0.1) / 40.

usage: sine_mesh.py [FACETS] > sine.msh     (gmsh 2.2, ASCII; lengths in metres; FACETS a wave, default 16)

Its crests are 0.2 above a box that ends at y = 1; it covers the box when it has moved by 0.5 to the left. All its nodes are the
group `wave`.
"""
import sys
from math import cos, pi

FACETS = int(sys.argv[1]) if len(sys.argv) > 1 else 16
WAVE, AMPLITUDE, LOW, TOP = 0.1, 0.025, 1.225, 1.3
WAVES = range(-3, 18)  # from x = -0.3 to 1.8


def main():
    count = FACETS * len(WAVES)
    at = [WAVE * (WAVES[0] + k / FACETS) for k in range(count + 1)]
    nodes = [(x, LOW + AMPLITUDE * cos(2 * pi * x / WAVE)) for x in at] + [(x, TOP) for x in at]
    print('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 1 "wave"\n2 2 "slab"\n$EndPhysicalNames')
    print(f"$Nodes\n{len(nodes)}")
    for n, (x, y) in enumerate(nodes, 1):
        print(n, f"{x:.9g} {y:.9g} 0")
    lines = [k for k in range(count) if k % 2 == 0 or k == count - 1]  # they reach all nodes
    print(f"$EndNodes\n$Elements\n{2 * (count + len(lines))}")
    for e, k in enumerate(lines):
        print(2 * e + 1, 1, 2, 1, 1, k + 1, k + 2)
        print(2 * e + 2, 1, 2, 1, 1, count + 2 + k, count + 3 + k)
    for k in range(count):
        a, b, c, d = k + 1, k + 2, count + 3 + k, count + 2 + k
        e = 2 * (len(lines) + k)
        print(e + 1, 2, 2, 2, 2, a, b, c)
        print(e + 2, 2, 2, 2, 2, a, c, d)
    print("$EndElements")


main()
