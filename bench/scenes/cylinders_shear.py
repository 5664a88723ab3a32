#!/usr/bin/env python3
"""How far tractions are from those of Hertz, and of Cattaneo and Mindlin: of a run of cylinders_shear.yaml, by its tractions.csv.

usage: cylinders_shear.py FOLDER FRICTION        (out/cylinders_shear 0.5)

Along the rims as they were at the start, about the middle of the pressures: p = p0 sqrt(1 - (s / a)^2), q = mu p0 (sqrt(1 - (s / a)^2) - c / a sqrt(1 -
(s / c)^2)) of the forces on a rim. The root of the mean square of the difference over that of the closed form, of both rims; by what nodes
have, and by its mean over the part of the rim that a node stands for. It sticks from the first to the last node with less than 0.99 mu p.

The closed form is that of slips that are nothing beside a, so that what lies on each other was opposite to each other at the start. Of a slip w it
is (s - w / 2) on the one rim that lies on (s + w / 2) on the other: gaps and tractions are those of s then, but for the square of w / a, and
those of a rim's own places are off by the order of w / a, which is that of mu p0 / E'. So the same again halfway, at the mean s of the two, of tractions by
length of that.
"""
import csv
import sys
from bisect import bisect
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


def between(x, xs, ys):
    i = min(max(bisect(xs, x), 1), len(xs) - 1)
    return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1])


def halfway(own, other):
    """Rows (s, p, q) of a rim at the mean s of its nodes and of what lies on them, in that order; the two rims run against each other."""
    x, along = zip(*sorted((r[3], r[0]) for r in other))
    at = [(r[0] - between(r[3], x, along)) / 2 for r in own]
    last = len(own) - 1
    rows = []
    for i, (s, p, q, x) in enumerate(own):
        low, high = max(i - 1, 0), min(i + 1, last)
        part = (own[high][0] - own[low][0]) / (at[high] - at[low])
        rows.append((at[i], part * p, part * q))
    return rows


class Differences:
    def __init__(self):
        self.of = ([], []), ([], [])  # nodes, means over their parts; each of pressures, of friction

    def add(self, at, middle, edge, P, Q):
        """Rows (s, p, q) of a rim with edges of that length and forces P and Q about its middle; gives a and c."""
        a = sqrt(4 * P * R / (pi * E / (2 * (1 - NU * NU))))
        c, p0 = a * sqrt(1 - abs(Q) / (MU * P)), 2 * P / (pi * a)
        for s, p, q in at:
            s -= middle
            for pairs, form in zip(self.of, (root, lambda s, half: mean(s, half, edge))):
                pairs[0].append((p, p0 * form(s, a)))
                pairs[1].append((q, copysign(MU * p0, Q) * (form(s, a) - c / a * form(s, c))))
        return a, c

    def told(self):
        (p, q), means = self.of
        return f"pressures off by {off(p):.2f} %, friction by {off(q):.2f} % (L2); by means over nodes' parts {off(means[0]):.2f} and {off(means[1]):.2f} %"


def main():
    rims = {"lower": [], "upper": []}
    with open(f"{sys.argv[1]}/tractions.csv", newline="") as file:
        for r in csv.DictReader(file):
            rims[r["body"]].append(tuple(float(r[c]) for c in ("along [m]", "normal [Pa]", "tangential [Pa]", "x [m]")))
    own, both = Differences(), Differences()
    for body, other in ("lower", "upper"), ("upper", "lower"):
        at = [row[:3] for row in rims[body]]
        edge = (at[-1][0] - at[0][0]) / (len(at) - 1)
        P, Q = (edge * sum(row[k] for row in at) for k in (1, 2))
        middle = edge * sum(s * p for s, p, q in at) / P
        a, c = own.add(at, middle, edge, P, Q)
        there = halfway(rims[body], rims[other])
        both.add(there, edge * sum(s[0] * p for s, (_, p, _) in zip(there, at)) / P, edge, P, Q)
        sticks = [(s - middle) / edge for s, p, q in at if abs(q) < 0.99 * MU * p]
        print(f"{body}: {len(at)} nodes, P {P:.1f} N/m, Q {abs(Q) / (MU * P):.4f} mu P, a {a / edge:.1f} edges, sticks from {sticks[0]:.2f} to {sticks[-1]:.2f}, {c / edge:.2f}")
    print(own.told())
    print(f"halfway between what lies on each other: {both.told()}")


main()
