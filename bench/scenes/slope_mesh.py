#!/usr/bin/env python3
"""Writes the mesh of cylinder_slope_3d.yaml: a plane that falls by 60 degrees along x and lies askew to the axes, of triangles.

usage: slope_mesh.py [PARTS] > slope.msh     (gmsh 2.2, ASCII; lengths in metres; PARTS along it, default 6)

It goes through the origin; its normal points up. The group `slope` is all of it.
"""
import sys
from math import cos, pi, sin

PARTS = int(sys.argv[1]) if len(sys.argv) > 1 else 6
ACROSS = max(1, PARTS // 3)
ANGLE, ASKEW = pi / 3, 0.4  # of the fall; about the vertical
LENGTH, WIDTH, BEFORE = 4.8, 1.6, 0.8
DOWN = [cos(ANGLE) * cos(ASKEW), cos(ANGLE) * sin(ASKEW), -sin(ANGLE)]
SIDE = [-sin(ASKEW), cos(ASKEW), 0]


def main():
    nodes, triangles = [], []
    for i in range(PARTS + 1):
        for j in range(ACROSS + 1):
            s, t = LENGTH * i / PARTS - BEFORE, WIDTH * (j / ACROSS - 0.5)
            nodes.append([s * d + t * e for d, e in zip(DOWN, SIDE)])
    for i in range(PARTS):
        for j in range(ACROSS):
            a = i * (ACROSS + 1) + j + 1
            b = a + ACROSS + 1
            triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
    print('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 "slope"\n$EndPhysicalNames')
    print(f"$Nodes\n{len(nodes)}")
    for n, x in enumerate(nodes, 1):
        print(n, *(f"{c:.16g}" for c in x))
    print(f"$EndNodes\n$Elements\n{len(triangles)}")
    for e, t in enumerate(triangles, 1):
        print(e, 2, 2, 1, 1, *t)
    print("$EndElements")


main()
