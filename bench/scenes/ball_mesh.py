#!/usr/bin/env python3
"""Writes the mesh of hertz_ball.yaml: an eighth of a ball of radius 1 about the origin, hexahedra, fine at its pole (0, 0, 1).

usage: ball_mesh.py [N] > ball.msh     (gmsh 2.2, binary; lengths in metres; 4 N^3 hexahedra, default N = 8)

The eighth is a tetrahedron with three corners on the sphere and one in the centre, and that is four blocks of hexahedra, one at each
corner. (bx, by, bz), what the corners on the axes weigh in it, becomes (bx + by + bz) b / |b|. Groups: x, y, z, its plane sides,
and `ball`.
"""
import sys
from array import array
from itertools import product
from math import sqrt

N = int(sys.argv[1]) if len(sys.argv) > 1 else 8
FINE = 0.15  # size of the smallest hexahedra over that of equal ones
POLE, CENTRE = 2, 3  # of corners 0, 1, 2 on the axes and the centre


def place(corner, others, steps):
    """Of a node of the block at `corner`, `steps` from it towards each of the `others`."""
    s = [k / N for k in steps]
    s = [FINE * t + (1 - FINE) * t**4 if corner == POLE or o != POLE else t for t, o in zip(s, others)]
    weight = [0.0] * 4
    for toward in product((0, 1), repeat=3):
        share = 1.0
        for t, on in zip(s, toward):
            share *= t if on else 1 - t
        there = [corner] + [o for o, on in zip(others, toward) if on]
        for c in there:
            weight[c] += share / len(there)
    length = sqrt(sum(w * w for w in weight[:3]))
    return tuple(sum(weight[:3]) * w / length if length > 0 else 0.0 for w in weight[:3])


def volume(at):
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = [[at[k][d] - at[0][d] for d in range(3)] for k in (1, 3, 4)]
    return ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)


def main():
    number, nodes, cells = {}, [], []
    for corner in range(4):
        others = [c for c in range(4) if c != corner]
        for steps in product(range(N), repeat=3):
            cell = []
            for d in ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)):
                at = place(corner, others, [k + e for k, e in zip(steps, d)])
                key = tuple(round(x * 1e9) for x in at)
                if key not in number:
                    number[key] = len(nodes)
                    nodes.append(at)
                cell.append(number[key])
            if volume([nodes[n] for n in cell]) < 0:
                cell = cell[4:] + cell[:4]
            cells.append(cell)
    sides = []
    for axis in range(3):
        for cell in cells:
            flat = [n for n in cell if abs(nodes[n][axis]) < 1e-12]
            if len(flat) == 4:
                faces = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
                sides += [(axis + 1, [cell[k] for k in f]) for f in faces if {cell[k] for k in f} == set(flat)]
    out = sys.stdout.buffer
    names = ['2 1 "x"', '2 2 "y"', '2 3 "z"', '3 4 "ball"']
    out.write(b"$MeshFormat\n2.2 1 8\n" + array("i", [1]).tobytes() + b"\n$EndMeshFormat\n")
    out.write(("$PhysicalNames\n4\n" + "\n".join(names) + f"\n$EndPhysicalNames\n$Nodes\n{len(nodes)}\n").encode())
    for n, at in enumerate(nodes, 1):
        out.write(array("i", [n]).tobytes() + array("d", [float(f"{x:.9g}") for x in at]).tobytes())
    out.write(f"\n$EndNodes\n$Elements\n{len(sides) + len(cells)}\n".encode() + array("i", [3, len(sides), 2]).tobytes())
    for e, (group, face) in enumerate(sides, 1):
        out.write(array("i", [e, group, group, *(n + 1 for n in face)]).tobytes())
    out.write(array("i", [5, len(cells), 2]).tobytes())
    for e, cell in enumerate(cells, len(sides) + 1):
        out.write(array("i", [e, 4, 4, *(n + 1 for n in cell)]).tobytes())
    out.write(b"\n$EndElements\n")


main()
