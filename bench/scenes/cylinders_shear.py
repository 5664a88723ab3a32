#!/usr/bin/env python3
"""How far tractions are from those of Hertz, and of Cattaneo and Mindlin: of a run of cylinders_shear.yaml, by its tractions.csv.

usage: cylinders_shear.py FOLDER FRICTION        (out/cylinders_shear 0.5)

Along the rims as they were at the start, about the middle of the pressures: p = p0 sqrt(1 - (s / a)^2), q = mu p0 (sqrt(1 - (s / a)^2) - c / a sqrt(1 -
(s / c)^2)) of the forces on a rim. The root of the mean square of the difference over that of the closed form, of both rims; by what nodes
have, and by its mean over the part of the rim that a node stands for. It sticks from the first to the last node with less than 0.99 mu p.
"""
import csv
import sys
from math import asin, copysign, pi, sqrt

R, E, NU = 1 / (1 / 10e-3 + 1 / 12e-3), 50e6, 0.3
MU = float(sys.argv[2])


def root(s, half):
    return sqrt(max(0.0, 1 - (s / half) ** 2))


def mean(s, half, edge):
    """Of that over an edge about s."""
    low, high = (max(-1.0, min(1.0, (s + d * edge) / half)) for d in (-0.5, 0.5))
    return half / edge * sum(k * (x * sqrt(1 - x * x) + asin(x)) / 2 for k, x in ((1, high), (-1, low)))


def off(pairs):
    return 100 * sqrt(sum((a - b) ** 2 for a, b in pairs) / sum(b * b for a, b in pairs))


def main():
    with open(f"{sys.argv[1]}/tractions.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    nodes, means = ([], []), ([], [])
    for body in "lower", "upper":
        at = [tuple(float(r[c]) for c in ("along [m]", "normal [Pa]", "tangential [Pa]")) for r in rows if r["body"] == body]
        edge = (at[-1][0] - at[0][0]) / (len(at) - 1)
        P, Q = (edge * sum(row[k] for row in at) for k in (1, 2))
        middle = edge * sum(s * p for s, p, q in at) / P
        a = sqrt(4 * P * R / (pi * E / (2 * (1 - NU * NU))))
        c, p0 = a * sqrt(1 - abs(Q) / (MU * P)), 2 * P / (pi * a)
        for s, p, q in at:
            s -= middle
            for pairs, form in (nodes, root), (means, lambda s, half: mean(s, half, edge)):
                pairs[0].append((p, p0 * form(s, a)))
                pairs[1].append((q, copysign(MU * p0, Q) * (form(s, a) - c / a * form(s, c))))
        sticks = [(s - middle) / edge for s, p, q in at if abs(q) < 0.99 * MU * p]
        print(f"{body}: {len(at)} nodes, P {P:.1f} N/m, Q {abs(Q) / (MU * P):.4f} mu P, a {a / edge:.1f} edges, sticks from {sticks[0]:.2f} to {sticks[-1]:.2f}, {c / edge:.2f}")
    print(f"pressures off by {off(nodes[0]):.2f} %, friction by {off(nodes[1]):.2f} % (L2); by means over nodes' parts {off(means[0]):.2f} and {off(means[1]):.2f} %")


main()
