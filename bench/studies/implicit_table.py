#!/usr/bin/env python3
# Where the time of an implicit step goes, by size, length of the step, solver and threads: runs a soft block that sags on a floor,
# of material points and of elements, and writes bench/studies/implicit_table.md.
#
#   python3 bench/studies/implicit_table.py [-o FILE] [-m MOST_NODES] [-p PATTERN] [BRUNT]
#
# -m: no sizes beyond that many nodes. -p: only runs whose first columns match. BRUNT: the program; default build/brunt. With all
# sizes some twenty minutes and 3 GB. A direct solution that is expected to take more than a minute has no row.
import getopt
import json
import os
import re
import subprocess
import sys
import tempfile

STEPS = 2
LIMIT = 60  # [s] expected of one direct solution
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
a step; iterations of conjugate gradients to 1e-3 for each of Newton's; peak of the process, its checkpoint among it. `auto` is what
the program chooses by itself. Direct solutions that would take more than a minute were not made.

| body | nodes | c dt/h | solver | threads | Newton | CG | """ + " | ".join(PASSES) + """ | step | MB |
|---|---|---|---|---|---|---|""" + "---|" * len(PASSES) + """---|---|
"""


def cheapest(rows):
    """By body, size and step: the solver whose pass takes least."""
    lines = ["", "Cheapest pass `solve` on one thread:", "", "| body | nodes | c dt/h | direct [ms] | pcg [ms] | cheaper |",
             "|---|---|---|---|---|---|"]
    keys = dict.fromkeys(tuple(r[:3]) for r in rows)
    for key in keys:
        times = {r[3]: float(r[9]) for r in rows if tuple(r[:3]) == key and r[4] == "1"}
        best = min(times, key=times.get)
        lines.append("| %s | %s | %s |" % (" | ".join(key), " | ".join(
            "%.3g" % times[s] if s in times else "" for s in ("direct", "pcg")), best))
    return "\n".join(lines) + "\n"


def main():
    options, rest = getopt.getopt(sys.argv[1:], "o:m:p:")
    options = dict(options)
    brunt = os.path.abspath(rest[0] if rest else "build/brunt")
    most, pattern = float(options.get("-m", 1e9)), options.get("-p", "")
    rows = []
    for model, (dim, method, sides) in MODELS.items():
        for side in sides:
            nodes = (side + (3 if "points" in model else 1)) ** dim
            if nodes > most:
                continue
            for courant in (1, 10, 100, 1000):
                for solver, threads in (("direct", 1), ("pcg", 1), ("pcg", 2)):
                    name = "%s %d %g %s %d" % (model, nodes, courant, solver, threads)
                    if not re.search(pattern, name) or solver == "direct" and expected(dim, nodes) > LIMIT:
                        continue
                    summary = run(brunt, scene(dim, method, side, courant, solver), threads)
                    rows.append(row(model, summary.get("nodes") or nodes, courant, solver, threads, summary))
                    print(" ".join(rows[-1]), flush=True)
    with open(options.get("-o", "bench/studies/implicit_table.md"), "w", encoding="utf-8") as file:
        file.write(HEAD + "".join("| " + " | ".join(r) + " |\n" for r in rows) + cheapest(rows))


main()
