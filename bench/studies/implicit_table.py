#!/usr/bin/env python3
# Where the time of an implicit step goes, by size, length of the step, solver and threads: runs a soft block that sags on a floor,
# of material points and of elements, and two halves of one that meet, and writes bench/studies/implicit_table.md.
#
#   python3 bench/studies/implicit_table.py [-a] [-o FILE] [-m NODES] [-t THREADS] [-l SECONDS] [-p PATTERN] [BRUNT]
#
# -m, -t: at most so many nodes, threads (2). -l: no direct solution that is expected to take longer; default 60 s. -p: only runs whose
# first columns match. -a: rows that the file has stay, and are not measured again. BRUNT: the program; default build/brunt. The file is
# written after each run, small sizes first.
import getopt
import json
import math
import os
import re
import subprocess
import sys
import tempfile

REPEATS, SHORT = 3, 2  # the middle one of so many runs that take fewer seconds
SMALL = 5000  # nodes: up to there all lengths of steps and one thread, beyond two of them and two threads
MEDIUM = 15000  # nodes: up to there ten steps of each length, so that the start counts little; beyond two
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
{bodies}boundaries:
  - {{name: floor, plane: {{point: {low}, normal: {up}}}, condition: stick}}
loads: {{gravity: {down}}}
output: {{every: 1000 s}}
"""

BODY = """  {name}:
    material: soft
    shape: {{box: {{min: {low}, max: {high}}}}}
    {method}
"""
GAP = 0.002  # [m] between halves that meet at 1 m/s, within their first step

POINTS = "method: mpm\n    particles_per_cell: {}"
MESH = "method: fem\n    element: {}\n    size: {} m"
HALVES = " in contact"
MODELS = {
    "points 2D": (2, POINTS.format(4), (32, 100, 220, 440)),
    "tri3": (2, MESH.format("tri3", CELL), (32, 100, 220, 440)),
    "points 3D": (3, POINTS.format(8), (8, 16, 25, 37)),
    "tet4": (3, MESH.format("tet4", CELL), (10, 18, 27, 38)),
    "quad4": (2, MESH.format("quad4", CELL), (100, 220)),
    "hex8": (3, MESH.format("hex8", CELL), (18, 27)),
    "tri3 in contact": (2, MESH.format("tri3", CELL), (100, 220)),
    "quad4 in contact": (2, MESH.format("quad4", CELL), (100, 220)),
    "tet4 in contact": (3, MESH.format("tet4", CELL), (18, 24)),
    "hex8 in contact": (3, MESH.format("hex8", CELL), (18, 24)),
}
FITTED = ("points 2D", "tri3", "points 3D", "tet4")  # by every solver and step; of the others pcg at c dt/h = 10
BLOCKS = {"points 2D": 25, "tri3": 7, "points 3D": 125, "tet4": 15}  # that a node couples with, within
PASSES = ("evaluate", "matrix", "solve", "limit", "search")
PARTS = {"solve": ("factor", "solve")}  # of a pass of the table; else itself
SOLVERS = ("direct", "pcg", "matrix-free")


def corner(dim, value, last):
    return "[" + ", ".join(["%.9g" % value] * (dim - 1) + ["%.9g" % last]) + "]"


def bodies_of(dim, method, length, halves):
    if not halves:
        return BODY.format(name="block", low=corner(dim, 0, 0), high=corner(dim, length, length), method=method)
    falls = method + "\n    velocity: " + corner(dim, 0, -1)
    return (BODY.format(name="lower", low=corner(dim, 0, 0), high=corner(dim, length, length / 2), method=method) +
            BODY.format(name="upper", low=corner(dim, 0, length / 2 + GAP), high=corner(dim, length, length + GAP), method=falls) +
            "contact: {method: barrier, friction: 0.3}\n")


def scene(model, side, steps, courant, solver):
    dim, method, _ = MODELS[model]
    step = courant * CELL / WAVE
    return SCENE.format(
        dim=dim, end=steps * step * 1.0001, step=step, solver=solver, cell=CELL,
        bodies=bodies_of(dim, method, side * CELL, model.endswith(HALVES)),
        low=corner(dim, 0, 0), up=corner(dim, 0, 1), down=corner(dim, 0, -1))


def expected(model, nodes):
    """Seconds of a direct factor, about; its memory goes with it: 8 GB where it takes 200 s."""
    if MODELS[model][0] == 2:
        return (0.2 if "points" in model else 0.05) * (nodes / 1e4) ** 1.52
    return (0.8 if "points" in model else 0.08) * (nodes / 4096) ** 2.2


def call(brunt, text, *words):
    """What a command says, and the folder's summary if there is one."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "block.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        words = [word.format(folder=folder) for word in words]
        done = subprocess.run([brunt, words[0], path, *words[1:]], capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit("%s\n%s" % (text, done.stderr))
        if words[0] == "check":
            return done.stdout
        with open(folder + "/out/summary.json", encoding="utf-8") as file:
            return json.load(file)


def run(brunt, text, threads):
    runs = []
    while len(runs) < REPEATS and (not runs or runs[-1]["wall_s"] < SHORT):
        runs.append(call(brunt, text, "run", "-o", "{folder}/out", "-t", str(threads), "--profile", "-q"))
    return sorted(runs, key=lambda summary: summary["step_s"] * share(summary))[len(runs) // 2]


def share(summary):
    """Of a core that one thread had."""
    return min(1, summary["cpu_s"] / summary["wall_s"]) if summary["threads"] == 1 else 1


def row(model, nodes, courant, solver, threads, summary):
    newton = summary["newton"]
    count = newton["iterations"]
    busy = {p["name"]: max(p["thread_s"]) if threads > 1 and p["name"] in ("evaluate", "matrix") else p["seconds"]
            for p in summary["profile"]["passes"]}
    passes = ["%.3g" % (1e3 * share(summary) * sum(busy.get(part, 0) for part in PARTS.get(name, (name,))) / count)
              for name in PASSES]
    whole = 1e3 * share(summary) * summary["step_s"] / count
    return [model, str(nodes), "%g" % courant, solver, str(threads), "%g" % (count / newton["steps"]),
            "%.3g" % (newton["linear_iterations"] / count)] + passes + [
                "%.3g" % whole, "%.0f" % (summary["peak_rss_bytes"] / 1e6)]


HEAD = """# Time of implicit steps, measured

Written by `python3 bench/studies/implicit_table.py`: a block of neo-Hookean material sags on a floor under its weight, ten steps of
each length, two of bodies of more than 15,000 nodes; material points with quadratic kernels (4 a cell in 2D, 8 in 3D), or elements as
wide as a cell. Milliseconds an iteration of Newton's method by pass, `step` the whole step over its iterations; iterations a step; iterations of conjugate gradients to 1e-3 for
each of Newton's; peak of the process, its checkpoint among it. One thread: wall clock times the share of a core that the process had.
Two threads: wall clock of a machine of two cores, of `evaluate` and `matrix` the time that the slower one was at work.

| body | nodes | c dt/h | solver | threads | Newton | CG | """ + " | ".join(PASSES) + """ | step | MB |
|---|---|---|---|---|---|---|""" + "---|" * len(PASSES) + """---|---|
"""


def number(text):
    return "%.3g" % text if text is not None else ""


def cheapest(rows):
    """By body, size and step: the solver whose passes `matrix` and `solve` take least."""
    lines = ["", "## The cheaper solver", "", "Passes `matrix` and `solve` on one thread [ms an iteration]; by how much the cheapest is cheaper than the",
             "next; memory of the process [MB].", "",
             "| body | nodes | c dt/h | " + " | ".join(SOLVERS) + " | cheapest | " + " | ".join("MB, " + s for s in SOLVERS) + " |",
             "|---" * 10 + "|"]
    for key in dict.fromkeys(tuple(r[:3]) for r in rows):
        own = {(r[3], r[4]): r for r in rows if tuple(r[:3]) == key}
        times = {s: float(own[s, "1"][8]) + float(own[s, "1"][9]) for s in SOLVERS if (s, "1") in own}
        if len(times) < 2:
            continue
        best, next_one = sorted(times, key=times.get)[:2]
        lines.append("| " + " | ".join(list(key) + [number(times.get(s)) for s in SOLVERS] +
                     ["%s by %.2g" % (best, times[next_one] / times[best])] +
                     [own[s, "1"][13] if (s, "1") in own else "" for s in SOLVERS]) + " |")
    return "\n".join(lines) + "\n"


def machine_gain(brunt):
    """What two threads do of what one does, at most: a sentence."""
    done = subprocess.run([os.path.join(os.path.dirname(brunt), "bench", "bench_roofline")], capture_output=True, text=True, check=False)
    (read, work), (read_2, work_2) = [tuple(map(float, r)) for r in re.findall(
        r"[12] threads? +([\d.]+) GB/s .*? ([\d.]+) GFLOP/s", done.stdout)[:2]]
    return ("On this machine two threads read memory that no cache holds %.2f times as fast as one, and multiply numbers in registers\n"
            "%.2f times (`bench_roofline`): the matrix and its factor of `pcg` are read, once an iteration of conjugate gradients." %
            (read_2 / read, work_2 / work))


def gains(rows, machine=""):
    """By body, size, step and solver: a step of one thread over one of two."""
    lines = ["", "## Two threads", "", "A step of one thread over one of two. " + machine, "",
             "| body | nodes | c dt/h | pcg | matrix-free |", "|---" * 5 + "|"]
    steps = {tuple(r[:5]): float(r[12]) for r in rows}
    for key in dict.fromkeys(tuple(r[:3]) for r in rows if r[4] == "2"):
        gain = [steps[(*key, s, "1")] / steps[(*key, s, "2")] if (*key, s, "2") in steps else None for s in ("pcg", "matrix-free")]
        lines.append("| " + " | ".join([*key, *(number(g) for g in gain)]) + " |")
    return "\n".join(lines) + "\n"


def place(row):
    return list(MODELS).index(row[0]), int(row[1]), float(row[2]), int(row[4]), SOLVERS.index(row[3])


def write(path, rows, end="", machine=""):
    rows = sorted(rows, key=place)
    with open(path, "w", encoding="utf-8") as file:
        file.write(HEAD + "".join("| " + " | ".join(r) + " |\n" for r in rows) + missing(rows) + cheapest(rows) + gains(rows, machine) + end)


def measured(path):
    """Rows that a file has."""
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        rows = [line.strip("| \n").split(" | ") for line in file if line.startswith("|")]
    return [r for r in rows if r[0] in MODELS and len(r) == 7 + len(PASSES) + 2]


def least_squares(terms, seconds):
    """Factors of terms, none negative, for which the sum over them misses the seconds by the least share."""
    rows = [[value / whole for value in row] for row, whole in zip(terms, seconds)]
    use = list(range(len(rows[0])))
    while True:
        a = [[sum(r[i] * r[j] for r in rows) for j in use] + [sum(r[i] for r in rows)] for i in use]
        for k, pivot in enumerate(a):
            for other in a:
                if other is not pivot:
                    factor = other[k] / pivot[k]
                    other[:] = [x - factor * y for x, y in zip(other, pivot)]
        x = {i: a[k][-1] / a[k][k] for k, i in enumerate(use)}
        worst = min(use, key=lambda i: x[i] * rows[0][i])
        if x[worst] >= 0:
            return [x.get(i, 0) for i in range(len(rows[0]))]
        use.remove(worst)


def iterations(nodes, dim, courant, law):
    """1 + about the lesser of `law[0]` c dt/h and `law[1]` nodes across."""
    return 1 + 1 / math.hypot(1 / (law[0] * courant), 1 / (law[1] * nodes ** (1 / dim)))


def law_of(rows, dim):
    """Both numbers of `iterations`, to some percent."""
    def miss(law):
        return sum(math.log(iterations(int(r[1]), dim, float(r[2]), law) / float(r[6])) ** 2 for r in rows)
    steps = [0.2 * 1.05 ** k for k in range(70)]
    return min(((a, b) for a in steps for b in steps), key=miss)


def fit(rows):
    """The constants of engine/linear/choose.c."""
    pcg = [r for r in rows if r[0] in FITTED and r[3] == "pcg" and r[4] == "1"]
    direct = [r for r in rows if r[0] in FITTED and r[3] == "direct" and r[4] == "1"]
    if {r[0] for r in pcg} != set(FITTED) or {r[0] for r in direct} != set(FITTED):
        return ""
    lines = ["", "## What estimates go by", "",
             "Fitted to the rows of one thread, n nodes of b blocks (%s) in d dimensions:" %
             ", ".join("%s %d" % item for item in BLOCKS.items()), "",
             "| body | iterations of conjugate gradients: 1 + the lesser of |", "|---|---|"]
    for model in FITTED:
        dim = MODELS[model][0]
        law = law_of([r for r in pcg if r[0] == model], dim)
        lines.append("| %s | %.2g c dt/h and %.2g n^(1/d), 1 over the root of the sum of 1/square |" % (model, *law))
    terms, seconds = [], []
    for r in pcg:
        dim, n, b, count = MODELS[r[0]][0], int(r[1]), BLOCKS[r[0]], float(r[6])
        terms.append([n * b, n * b * b, n * count, n * b * dim * dim * count]), seconds.append(1e-3 * float(r[9]))
    lines += ["", "pcg: n (%.2g b + %.2g b^2 + (%.2g + %.2g b d^2) iterations) s." % tuple(least_squares(terms, seconds))]
    terms, seconds = [], []
    for r in direct:
        dim, n, b = MODELS[r[0]][0], int(r[1]), BLOCKS[r[0]]
        flops = (n / 1e4) ** 1.5 * (b / 7) ** 1.85 if dim == 2 else (n / 4096) ** 2 * (b / 13.5) ** 1.1
        terms.append([n, n * b, flops * (dim == 2), flops * (dim == 3)]), seconds.append(1e-3 * float(r[9]))
    lines += ["", "direct: n (%.2g + %.2g b) s, and in 2D %.2g (n / 1e4)^1.5 (b / 7)^1.85 s, in 3D %.2g (n / 4096)^2 (b / 13.5)^1.1 s."
              % tuple(least_squares(terms, seconds))]
    return "\n".join(lines) + "\n"


def auto(brunt, rows):
    """By body, size and step: what `solver: auto` takes, by which estimates, and what it loses by that."""
    lines = ["", "## What `auto` takes", "", "It goes by estimates of pass `solve` [s] (`engine/linear/choose.c`), and takes the direct solver, which cannot stall,",
             "where it is thought to take less than twice as long. Over the measured time: 1 is right; a loss of 1: it took the quicker one.", "",
             "| body | nodes | c dt/h | direct, estimate over measured | pcg, estimate over measured | takes | loss |", "|---" * 7 + "|"]
    scenes = {(m, str(n), "%g" % c): text for m, n, c, solver, _, text in plan(1e9, 1e9) if solver == "pcg"}
    losses = []
    for key in dict.fromkeys(tuple(r[:3]) for r in sorted(rows, key=place)):
        seconds = {r[3]: 1e-3 * float(r[9]) for r in rows if tuple(r[:3]) == key and r[4] == "1"}
        if "direct" not in seconds or "pcg" not in seconds:
            continue
        said = call(brunt, scenes[key].replace("solver: pcg", "solver: auto"), "check")
        one, a, two, b = re.search(r"solver (\w+): some (\S+) s an iteration, (\w+) (\S+) s", said).groups()
        estimate = {one: float(a), two: float(b)}
        losses.append(seconds[one] / min(seconds["direct"], seconds["pcg"]))
        lines.append("| %s | %.2g | %.2g | %s | %.2g |" % (" | ".join(key), estimate["direct"] / seconds["direct"],
                                                         estimate["pcg"] / seconds["pcg"], one, losses[-1]))
    lines += ["", "The quicker one in %d of %d, no loss above %.2g." % (losses.count(1), len(losses), max(losses, default=1))]
    return "\n".join(lines) + "\n"


def missing(rows):
    """Direct solutions that were left out."""
    have = {(r[0], r[1]) for r in rows if r[3] == "direct"}
    sizes = {(r[0], r[1]) for r in rows if r[0] in FITTED} - have
    texts = ["%s, %s nodes (%.2g s a factor)" % (model, nodes, expected(model, int(nodes)))
             for model, nodes in sorted(sizes, key=lambda k: (list(MODELS).index(k[0]), int(k[1])))]
    return "\nNo direct solution, by what it is expected to take: " + "; ".join(texts) + ".\n" if texts else ""


def plan(most, limit):
    """Model, nodes, c dt/h, solver, threads, scene: sizes from small to large."""
    for size in range(4):
        for model, (dim, _, sides) in MODELS.items():
            if size >= len(sides):
                continue
            fitted, layers = model in FITTED, 2 if model.endswith(HALVES) else 1
            nodes = (sides[size] + (3 if "points" in model else 1)) ** (dim - 1) * (sides[size] + (3 if "points" in model else layers))
            for courant in ((1, 10, 100, 1000) if nodes < SMALL else (10, 100)) if fitted else (10,):
                for solver, threads in (("pcg", 1), ("pcg", 2), ("matrix-free", 1), ("matrix-free", 2), ("direct", 1)):
                    too_long = solver == "direct" and expected(model, nodes) > limit
                    if nodes <= most and not too_long and (threads == 1 or nodes > SMALL) and (fitted or solver == "pcg"):
                        steps = 10 if nodes < MEDIUM else 2
                        yield model, nodes, courant, solver, threads, scene(model, sides[size], steps, courant, solver)


def main():
    options, rest = getopt.getopt(sys.argv[1:], "ao:m:t:l:p:")
    options = dict(options)
    brunt = os.path.abspath(rest[0] if rest else "build/brunt")
    path = options.get("-o", "bench/studies/implicit_table.md")
    rows = measured(path) if "-a" in options else []
    for *key, text in plan(float(options.get("-m", 1e9)), float(options.get("-l", 60))):
        name = "%s %d %g %s %d" % tuple(key)
        known = name in (" ".join(r[:5]) for r in rows)
        if known or key[4] > int(options.get("-t", 2)) or not re.search(options.get("-p", ""), name):
            continue
        rows.append(row(*key, run(brunt, text, key[4])))
        print(" ".join(rows[-1]), flush=True)
        write(path, rows)
    write(path, rows, fit(rows) + auto(brunt, rows), machine_gain(brunt))


main()
