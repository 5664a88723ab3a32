#!/usr/bin/env python3
"""Writes the mesh of the half of a cylinder that stands on the origin, fine where it touches: those of cylinders_shear.yaml.

usage: cylinder_mesh.py RADIUS EDGE HALF LAYERS > NAME.msh     (gmsh 2.2, binary; lengths in metres)

RADIUS: of the lower half of a cylinder above the origin; negative: the mirror image of that below it. Edges of the rim are EDGE long up to HALF on
either side, LAYERS as deep; about that block lie rings whose edges grow with them, half as many every two rings down to some 24. They fill half
of the half-disk |z| < 2 RADIUS of a half-plane, which w = z / (1 - i z / (2 RADIUS)) bends into the half of the cylinder. Group `cut`: its diameter.

All diagonals of the block lean the same way, so that all nodes of the rim are alike; those of the mirror image lean so that both rims give the same
way under what presses. Nodes of the rim are a quarter of EDGE off the middle, to the right, and in the mirror image to the left: those of the one lie
between those of the other.
"""
import sys
from cmath import rect
from math import copysign, pi

from gmsh_triangles import write

radius, edge, half, layers = float(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4])
far = 2 * abs(radius)
LEAST = 24  # edges of a ring


def block():
    """Its nodes (x + i y), how many edges run along it, and its sides and top, from the left end of the rim to the right one."""
    n = 2 * round(half / edge)
    nodes = [complex((i - n / 2 + copysign(0.25, radius)) * edge, j * edge) for j in range(layers + 1) for i in range(n + 1)]
    around = [j * (n + 1) for j in range(layers + 1)] + [layers * (n + 1) + i for i in range(1, n)]
    around += [j * (n + 1) + n for j in range(layers, -1, -1)]
    triangles = []
    for j in range(layers):
        for i in range(n):
            a, c = j * (n + 1) + i, (j + 1) * (n + 1) + i
            triangles += [(a, a + 1, c), (a + 1, c + 1, c)]
    return nodes, around, triangles


def add_ring(nodes, triangles, ring, start, way):
    """One more about `ring`, from `start` on the block's sides a part `way` of the way to the half-circle that is far away."""
    edges, first = len(start) - 1, len(nodes)
    nodes += [(1 - way) * p + way * rect(far, pi * (1 - k / edges)) for k, p in enumerate(start)]
    for k in range(edges):
        c, d = first + k, first + k + 1
        if len(ring) > len(start):
            a, e, b = ring[2 * k : 2 * k + 3]
            triangles += [(a, e, c), (e, b, d), (e, d, c)]
        else:
            triangles += [(ring[k], ring[k + 1], c), (ring[k + 1], d, c)]
    return list(range(first, first + edges + 1))


def turned(places, triangle):
    """With its corners counter-clockwise."""
    (ax, ay), (bx, by), (cx, cy) = (places[n] for n in triangle)
    return triangle if (bx - ax) * (cy - ay) > (by - ay) * (cx - ax) else triangle[::-1]


def main():
    nodes, ring, triangles = block()
    start = [nodes[k] for k in ring]
    long = sum(abs(b - a) for a, b in zip(start, start[1:]))
    way, left = 0.0, 2
    while way < 1:
        if left == 0 and len(start) % 2 and len(start) // 2 >= LEAST:
            start, left = start[::2], 2
        edges = len(start) - 1
        way += ((1 - way) * long + way * pi * far) / edges / far
        if way > 1 - 0.3 * pi / edges:
            way = 1.0
        ring, left = add_ring(nodes, triangles, ring, start, way), left - 1
    bent = [z / (1 - 1j * z / far) for z in nodes]
    places = [[float(f"{c:.9g}") for c in (w.real, copysign(w.imag, radius) if w.imag else 0.0)] for w in bent]
    write("cylinder", places, [turned(places, t) for t in triangles], {"cut": list(zip(ring, ring[1:]))})


main()
