#!/usr/bin/env python3
"""How far pressures are from those of a line contact: of a run of brazil_disk.yaml, by its tractions.csv and history.csv.

usage: brazil_disk.py FOLDER        (out/brazil_disk)

a^2 = 4 F R (1 - nu^2) / (pi E) and p = 2 F / (pi a) sqrt(1 - (s / a)^2) of the force that was computed, along the rim as it was at the start; half
the width by the pressures' second moment, which is a^2 / 4; the root of the mean square of the difference over that of p.
"""
import csv
import sys
from math import pi, sqrt

R, E, NU = 10e-3, 50e6, 0.3
with open(f"{sys.argv[1]}/history.csv", newline="") as file:
    last = list(csv.DictReader(file))[-1]
force = float(next(v for k, v in last.items() if k.startswith("wall.below.force_y")))
a = sqrt(4 * force * R * (1 - NU * NU) / (pi * E))
with open(f"{sys.argv[1]}/tractions.csv", newline="") as file:
    rows = list(csv.DictReader(file))
for side in "below", "above":
    at = [(float(r["along [m]"]), float(r["normal [Pa]"])) for r in rows if r["other"] == side]
    pressed = sum(p for s, p in at)
    middle = sum(s * p for s, p in at) / pressed
    half = 2 * sqrt(sum((s - middle) ** 2 * p for s, p in at) / pressed)
    exact = [2 * force / (pi * a) * sqrt(max(0, 1 - ((s - middle) / a) ** 2)) for s, p in at]
    off = sqrt(sum((p - q) ** 2 for (s, p), q in zip(at, exact)) / sum(q * q for q in exact))
    print(f"{side}: {len(at)} nodes, a {1e3 * a:.5f} mm, by pressures {half / a:.4f} of it, pressures off by {100 * off:.2f} % (L2)")
