#!/usr/bin/env python3
"""Writes the mesh of ogive_6061.yaml: half the section of an ogive-nosed rod, tip down, in triangles.

usage: ogive_mesh.py [SIZE] > ogive.msh     (gmsh 2.2, ASCII; lengths in metres; SIZE of the elements in mm, default 1.4)

The nose is an arc of radius CRH times the diameter that meets the shank without a corner; x is the distance from the axis,
y runs along it, the tip is a node at x = y = 0. Rows of nodes lie across the axis, as many nodes on each as fit, and triangles between them: elements
of one size up to the tip, where quadrilaterals in columns would be far smaller than what they push aside.
The volume goes to the error output: the density of the scene is the rod's mass over it.
"""
import sys
from math import ceil, pi, sqrt

DIAMETER, LENGTH, CRH, MASS = 12.9e-3, 88.9e-3, 3, 0.079      # m, m, -, kg
SIZE = float(sys.argv[1]) * 1e-3 if len(sys.argv) > 1 else 1.4e-3

RADIUS, ARC = DIAMETER / 2, CRH * DIAMETER
NOSE = sqrt(ARC**2 - (ARC - RADIUS) ** 2)                     # m, its length


def radius(y):
    """Radius of the rod, y from its tip."""
    return RADIUS if y >= NOSE else sqrt(ARC**2 - (NOSE - y) ** 2) - (ARC - RADIUS)


def even(a, b, count):
    return [a + (b - a) * k / count for k in range(1, count + 1)]


def main():
    ys = [0.0] + even(0, NOSE, ceil(NOSE / SIZE)) + even(NOSE, LENGTH, ceil((LENGTH - NOSE) / SIZE))
    rs = [0.0] + [radius(y) for y in ys[1:]]
    nodes, rows = [], []
    for y, r in zip(ys, rs):
        count = max(1, round(r / SIZE)) if r > 0 else 0       # intervals across
        rows.append([len(nodes) + i + 1 for i in range(count + 1)])
        nodes += [(r * i / count if count else 0.0, y) for i in range(count + 1)]
    triangles = []
    for low, high in zip(rows, rows[1:]):
        i = j = 0                                             # zip the rows together, the shorter diagonal each time
        while i + 1 < len(low) or j + 1 < len(high):
            here, there = nodes[low[i] - 1], nodes[high[j] - 1]
            up = i + 1 == len(low)
            if not up and j + 1 < len(high):
                a, b = nodes[low[i + 1] - 1], nodes[high[j + 1] - 1]
                up = abs(b[0] - here[0]) < abs(a[0] - there[0]) or (abs(b[0] - here[0]) == abs(a[0] - there[0]) and i > j)
            triangles.append((low[i], high[j + 1], high[j]) if up else (low[i], low[i + 1], high[j]))
            i, j = (i, j + 1) if up else (i + 1, j)
    volume = sum(pi / 3 * (b - a) * (p * p + p * q + q * q) for a, b, p, q in zip(ys, ys[1:], rs, rs[1:]))
    sys.stderr.write(f"volume {volume:.9g} m^3, density for {MASS} kg {MASS / volume:.6g} kg/m^3, {len(triangles)} elements\n")
    print("$MeshFormat\n2.2 0 8\n$EndMeshFormat")
    print('$PhysicalNames\n1\n2 1 "ogive"\n$EndPhysicalNames')
    print(f"$Nodes\n{len(nodes)}")
    for n, (x, y) in enumerate(nodes, 1):
        print(n, f"{x:.9g} {y:.9g} 0")
    print(f"$EndNodes\n$Elements\n{len(triangles)}")
    for e, corners in enumerate(triangles, 1):
        print(e, 2, 2, 1, 1, *corners)
    print("$EndElements")


main()
