#!/usr/bin/env python3
"""Writes a mesh of triangles to lie behind material points (grid.cells.mesh): a rectangle, its inner nodes off the lattice.

usage: background_mesh.py X Y LENGTH WIDTH EDGE [DEGREES] > mesh.msh     (gmsh 2.2, binary; lengths in metres)

X, Y: the corner from which LENGTH runs along x and WIDTH along y, both turned by DEGREES about it. Nodes are off by up to a quarter
of EDGE along each, by a hash of their number (SplitMix64) alone; quadrangles are cut by the shorter of their diagonals.
"""
import sys
from math import cos, dist, pi, sin

from gmsh_triangles import write


def share(n):
    n = (n + 1) * 0x9E3779B97F4A7C15 & 0xFFFFFFFFFFFFFFFF
    n = (n ^ n >> 30) * 0xBF58476D1CE4E5B9 & 0xFFFFFFFFFFFFFFFF
    n = (n ^ n >> 27) * 0x94D049BB133111EB & 0xFFFFFFFFFFFFFFFF
    return ((n ^ n >> 31) >> 11) / 2**53


def main():
    x, y, length, width, edge = map(float, sys.argv[1:6])
    turn = float(sys.argv[6]) * pi / 180 if len(sys.argv) > 6 else 0
    along, across = round(length / edge), round(width / edge)
    nodes, triangles = [], []
    for i in range(along + 1):
        for j in range(across + 1):
            n = 2 * len(nodes)
            s = i + (share(n) - 0.5) / 2 * (0 < i < along)
            t = j + (share(n + 1) - 0.5) / 2 * (0 < j < across)
            s, t = s * length / along, t * width / across
            nodes.append((x + s * cos(turn) - t * sin(turn), y + s * sin(turn) + t * cos(turn)))
    for i in range(along):
        for j in range(across):
            a = i * (across + 1) + j
            b = a + across + 1
            if dist(nodes[a], nodes[b + 1]) < dist(nodes[b], nodes[a + 1]):
                triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
            else:
                triangles += [(a, b, a + 1), (b, b + 1, a + 1)]
    write("background", nodes, triangles)


main()
