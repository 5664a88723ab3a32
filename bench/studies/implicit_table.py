#!/usr/bin/env python3
# Where the time of an implicit step goes, by size, length of the step, solver and threads: runs a soft block that sags on a floor,
# of material points and of elements, and writes bench/studies/implicit_table.md.
#
#   python3 bench/studies/implicit_table.py [-o FILE] [-m MOST_NODES] [-l SECONDS] [-p PATTERN] [BRUNT]
#
# -m: no sizes beyond that many nodes. -l: no direct solution that is expected to take longer; default 5 s. -p: only runs whose first
# columns match. BRUNT: the program; default build/brunt. The file is written anew after each run, small sizes first; all of them take
# some ten minutes and 2 GB.
import getopt
import json
import os
import re
import subprocess
import sys
import tempfile

STEPS = 2
SMALL = 5000  # nodes: up to there all lengths of steps and one thread, beyond two of them and two threads
CELL = 0.05
WAVE = 36.69  # [m/s] of the material below

SCENE = """brunt: 1
title: A soft block sags
dimension: {dim}
time: {{end: {end} s, scheme: implicit, step: {step} s}}
newton: {{solver: {solver}}}
grid: {{cell: {cell} m}}
materials:
  soft: {{model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}}
bodies:
  block:
    material: soft
    shape: {{box: {{min: {low}, max: {high}}}}}
    {method}
boundaries:
  - {{name: floor, plane: {{point: {low}, normal: {up}}}, condition: stick}}
loads: {{gravity: {down}}}
output: {{every: 1000 s}}
"""

POINTS = "method: mpm\n    particles_per_cell: {}"
MESH = "method: fem\n    element: {}\n    size: {} m"
MODELS = {
    "points 2D": (2, POINTS.format(4), (32, 100, 220, 440)),
    "tri3": (2, MESH.format("tri3", CELL), (32, 100, 220, 440)),
    "points 3D": (3, POINTS.format(8), (8, 16, 25, 37)),
    "tet4": (3, MESH.format("tet4", CELL), (10, 18, 27, 38)),
}
PASSES = ("evaluate", "matrix", "solve", "limit", "search")


def scene(dim, method, side, courant, solver):
    step = courant * CELL / WAVE
    length = side * CELL
    vector = lambda value, last: "[" + ", ".join([value] * (dim - 1) + [last]) + "]"
    return SCENE.format(
        dim=dim, end=STEPS * step * 1.0001, step=step, solver=solver, cell=CELL, method=method,
        low="[" + ", ".join(["0"] * dim) + "]", high="[" + ", ".join(["%.9g" % length] * dim) + "]",
        up=vector("0", "1"), down=vector("0", "-1"))


def expected(dim, nodes):
    """Seconds of a direct factor, as engine/linear/choose.c has them, at its widest rows."""
    return 1e-2 * (nodes / 1e4) ** 1.52 * 10 if dim == 2 else 2.85e9 * (nodes / 4096) ** 2.2 * 10 / 3.5e10


def run(brunt, text, threads):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "block.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        done = subprocess.run([brunt, "run", path, "-o", folder + "/out", "-t", str(threads), "--profile", "-q"],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit("%s\n%s" % (text, done.stderr))
        with open(folder + "/out/summary.json", encoding="utf-8") as file:
            return json.load(file)


def row(model, nodes, courant, solver, threads, summary):
    newton = summary["newton"]
    count = newton["iterations"]
    busy = {p["name"]: max(p["thread_s"]) if threads > 1 and p["name"] in ("evaluate", "matrix") else p["seconds"]
            for p in summary["profile"]["passes"]}
    passes = ["%.3g" % (1e3 * busy.get(name, 0) / count) for name in PASSES]
    whole = 1e3 * summary["step_s"] / count
    return [model, str(nodes), "%g" % courant, solver, str(threads), "%g" % (count / newton["steps"]),
            "%.3g" % (newton["linear_iterations"] / count)] + passes + [
                "%.3g" % whole, "%.0f" % (summary["peak_rss_bytes"] / 1e6)]


HEAD = """# Time of implicit steps, measured

Written by `python3 bench/studies/implicit_table.py`: a block of neo-Hookean material sags on a floor under its weight, two steps of
each length; material points with quadratic kernels (4 a cell in 2D, 8 in 3D), or elements as wide as a cell. Milliseconds an iteration
of Newton's method by pass (wall clock of a shared machine: compare neighbours), `step` the whole step over its iterations; iterations
a step; iterations of conjugate gradients to 1e-3 for each of Newton's; peak of the process, its checkpoint among it. Two threads:
of `evaluate` and `matrix` the time that the slower one was at work. Sizes without a row for `direct` would have taken too long (-l). A run that
is ended early leaves the smaller sizes.

| body | nodes | c dt/h | solver | threads | Newton | CG | """ + " | ".join(PASSES) + """ | step | MB |
|---|---|---|---|---|---|---|""" + "---|" * len(PASSES) + """---|---|
"""


def cheapest(rows):
    """By body, size and step: the solver whose pass takes least."""
    lines = ["", "## The cheaper solver", "", "Pass `solve` on one thread [ms an iteration]:", "",
             "| body | nodes | c dt/h | direct | pcg | cheaper |", "|---|---|---|---|---|---|"]
    for key in dict.fromkeys(tuple(r[:3]) for r in rows):
        times = {r[3]: float(r[9]) for r in rows if tuple(r[:3]) == key and r[4] == "1"}
        if len(times) < 2:
            continue
        best = min(times, key=times.get)
        lines.append("| %s | %s | %s | %s by %.2g |" % (" | ".join(key), "%.3g" % times["direct"], "%.3g" % times["pcg"], best,
                                                       max(times.values()) / times[best]))
    return "\n".join(lines) + "\n"


def write(path, rows):
    order = list(MODELS)
    rows = sorted(rows, key=lambda r: order.index(r[0]))
    with open(path, "w", encoding="utf-8") as file:
        file.write(HEAD + "".join("| " + " | ".join(r) + " |\n" for r in rows) + cheapest(rows))


def plan(most, limit):
    """Model, nodes, c dt/h, solver, threads, scene: sizes from small to large."""
    for size in range(4):
        for model, (dim, method, sides) in MODELS.items():
            nodes = (sides[size] + (3 if "points" in model else 1)) ** dim
            for courant in (1, 10, 100, 1000) if nodes < SMALL else (10, 100):
                for solver, threads in (("pcg", 1), ("direct", 1), ("pcg", 2)):
                    too_long = solver == "direct" and expected(dim, nodes) > limit
                    if nodes <= most and not too_long and (threads == 1 or nodes > SMALL):
                        yield model, nodes, courant, solver, threads, scene(dim, method, sides[size], courant, solver)


def main():
    options, rest = getopt.getopt(sys.argv[1:], "o:m:l:p:")
    options = dict(options)
    brunt = os.path.abspath(rest[0] if rest else "build/brunt")
    rows = []
    for *key, text in plan(float(options.get("-m", 1e9)), float(options.get("-l", 5))):
        if re.search(options.get("-p", ""), "%s %d %g %s %d" % tuple(key)):
            rows.append(row(*key, run(brunt, text, key[4])))
            print(" ".join(rows[-1]), flush=True)
            write(options.get("-o", "bench/studies/implicit_table.md"), rows)


main()
