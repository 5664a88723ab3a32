#!/usr/bin/env python3
"""Writes the mesh of airbag.yaml: a square bag of two layers sewn together at the rim, laid flat and folded once.

usage: airbag_mesh.py [CELLS] > airbag.msh     (gmsh 2.2, ASCII; lengths in metres)

The bag is laid out over u and v, its layers GAP apart. A turn about the line u = 0 brings the half u < 0 over the
other. The turn is as long as the sheet it takes: its radius, between the layers, is the length of TURN elements over
pi. Of the two layers the inner one is then shorter than the bag laid out by pi GAP / 2, the outer one as much longer:
1.3 % of the side.
"""
import sys
from math import cos, pi, sin

SIDE = 0.48                                              # m, of the bag laid out
CELLS = int(sys.argv[1]) if len(sys.argv) > 1 else 32    # elements along a side, even
GAP = 0.004                                              # m, between the two layers
TURN = 2 * max(1, CELLS // 16)                           # elements along the fold, even
STEP = SIDE / CELLS
RADIUS = TURN * STEP / pi


def place(u, v, layer):
    """Where the point u, v of layer -1 (under) or 1 (over) lies; layer 0 is the seam."""
    bend = TURN * STEP / 2
    height = layer * GAP / 2
    if u >= bend:
        return u - bend, v, height
    if u <= -bend:
        return -bend - u, v, 2 * RADIUS - height
    angle = (bend - u) / (2 * bend) * pi
    return -(RADIUS - height) * sin(angle), v, RADIUS - (RADIUS - height) * cos(angle)


def main():
    nodes, number = [], {}

    def node(i, j, layer):
        seam = i in (0, CELLS) or j in (0, CELLS)
        key = (i, j, 0 if seam else layer)
        if key not in number:
            u, v = (i / CELLS - 0.5) * SIDE, (j / CELLS - 0.5) * SIDE
            nodes.append(place(u, v, key[2]))
            number[key] = len(nodes)
        return number[key]

    quads = []
    for layer in (1, -1):
        for i in range(CELLS):
            for j in range(CELLS):
                corners = [node(i, j, layer), node(i + 1, j, layer), node(i + 1, j + 1, layer), node(i, j + 1, layer)]
                quads.append(corners if layer > 0 else corners[::-1])
    print("$MeshFormat\n2.2 0 8\n$EndMeshFormat")
    print('$PhysicalNames\n1\n2 1 "bag"\n$EndPhysicalNames')
    print(f"$Nodes\n{len(nodes)}")
    for n, x in enumerate(nodes, 1):
        print(n, *(f"{c:.9g}" for c in x))
    print(f"$EndNodes\n$Elements\n{len(quads)}")
    for e, corners in enumerate(quads, 1):
        print(e, 3, 2, 1, 1, *corners)
    print("$EndElements")


main()
