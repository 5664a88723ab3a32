#!/usr/bin/env python3
"""Writes the mesh of a disk of triangles, fine at its rim: those of pyramid.yaml and brazil_disk.yaml.

usage: disk_mesh.py RADIUS RIM [LAYERS [lean]] > NAME.msh     (gmsh 2.2, binary; lengths in metres)

RIM edges on the circle, 3 or 4 times a power of 2; under them LAYERS (default 2) as deep as the edges are long, then half as many edges every
two layers. The mesh is its own mirror image about both axes; with `lean` all diagonals lean the same way about the middle, so that all nodes of the
rim are alike, and it is its own image turned by half a turn.
"""
import sys
from cmath import rect
from math import pi

from gmsh_triangles import write

radius, rim = float(sys.argv[1]), int(sys.argv[2])
layers = int(sys.argv[3]) if len(sys.argv) > 3 else 2
lean = sys.argv[4:] == ["lean"]


def rings():
    """(r, edges) of the unit circle's rings, outside first."""
    r, n, left = 1.0, rim, layers
    while True:
        yield r, n
        edge = 2 * pi * r / n
        if n <= 12:
            return
        if left == 0:
            n, left, edge = n // 2, 2, 1.5 * edge
        left -= 1
        r -= edge


def main():
    nodes, triangles, outer = [], [], None
    for r, n in rings():
        first = len(nodes)
        nodes += [rect(r, 2 * pi * k / n) for k in range(n)]
        if outer:
            before, many = outer
            for k in range(n):
                c, d = first + k, first + (k + 1) % n
                if many == n:
                    a, b = before + k, before + (k + 1) % n
                    triangles += [(a, b, c), (b, d, c)] if lean or k % 2 else [(a, b, d), (a, d, c)]
                else:
                    a, b, e = before + 2 * k, before + 2 * k + 1, before + (2 * k + 2) % many
                    triangles += [(a, b, c), (b, e, d), (b, d, c)]
        outer = first, n
    first, n = outer
    nodes.append(0j)
    triangles += [(first + k, first + (k + 1) % n, len(nodes) - 1) for k in range(n)]
    write("disk", [[float(f"{c:.9g}") for c in (radius * z.real, radius * z.imag)] for z in nodes], triangles)


main()
