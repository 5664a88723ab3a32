#!/usr/bin/env python3
"""Implicit beside explicit: the same scene by both, error over processor time. Writes schemes.csv, schemes.md and schemes.png.

usage: schemes.py [PAIR...]     (from the top of the tree; BRUNT names the program, default build/brunt; a minute of one core)
       schemes.py --table       writes schemes.md and schemes.png anew from schemes.csv; pairs that are run replace their rows of it

Both have the mesh, the cells and the materials of a scene; slow loads are judged against implicit steps as small as change nothing and against closed
forms, which know of neither method (and whose distance is the mesh's as well), the drop against a mesh of a quarter of the size, the impact against
its closed form. What is refined is the scheme's own: of explicit runs under slow loads how slowly they come (their step is bounded by waves), else
the step. A run is within an error if all finer ones of its method are, so that none is by accident.
"""
import csv, glob, json, os, shutil, subprocess, sys, tempfile

HERE = "bench/studies/schemes"
SCENES = "bench/scenes/"
BRUNT = os.environ.get("BRUNT", "build/brunt")
GOALS = (0.10, 0.03, 0.01)

DROP = """brunt: 1
title: A block falls on a plane
dimension: 2
time: {end: 0.6 s, cfl: 0.9}
materials: {soft: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}}
bodies:
  block: {method: fem, material: soft, size: 0.05 m, shape: {box: {min: [0, 0.201], max: [0.5, 0.701]}}}
boundaries: [{name: floor, plane: {point: [0, 0], normal: [0, 1]}, condition: separate}]
loads: {gravity: [0, -10]}
output: {every: none, history: 1 ms, checkpoint: none}
measures: {back: {history: body.block.velocity_y, take: max, from: 0.2 s, unit: m/s}}
"""


# Without scheme and step: what else is of implicit steps explicit ones leave unused.
EXPLICIT_PRESS = ["time={end: 1 s, cfl: 0.9}"]
DISK_FORCE = ["measures={force: {history: contact.disk-lower.force, unit: N/m}}", "output.every=none"]
# Points meet a mesh half a spacing from where they are in explicit contact: the plates are that much farther out.
EXPLICIT_DISK = ["time={end: 1 s}", "bodies.lower.shape.box={min: [-2, -1.21], max: [2, -1.018968]}",
                 "bodies.upper.shape.box={min: [-2, 1.018968], max: [2, 1.21]}"]

# Closed forms of the slow pairs at the end of their way.
OUTSIDE = {"slow press": ("Hertz and Tatara", 387.6), "quasi-static indentation": ("Johnson 5.57", 86664574)}

# scene, measure, what it is compared with (a number, or a run of its own), [(method, what is refined, overrides)], from coarse to fine
PAIRS = {
    "slow press": (
        "hertz_ball.yaml", "force", "implicit, 80 steps",
        ["bodies.ball.mesh=ball_coarse.msh", "output.every=none", "measures={force: {history: wall.z.force_z, unit: N}}"],
        [("explicit", f"{v} m/s", EXPLICIT_PRESS + [f"time.end={0.01 / v}", f"boundaries[0].velocity=[0, 0, {-v}]"])
         for v in (1, 0.3, 0.1, 0.03, 0.01)]
        + [("implicit", f"{n} steps", [f"time.step={10 / n}"]) for n in (1, 2, 4, 8, 80)]),
    "quasi-static indentation": (
        "brazilian_disk.yaml", "force", "implicit, 128 steps", DISK_FORCE + ["grid.cell=0.1 m", "bodies.disk.shape.disk.radius=1.018867925"],
        [("explicit", f"{v} m/s", EXPLICIT_DISK + [f"time.end={0.032 / v}", f"boundaries[1].velocity=[0, {-v}]"])
         for v in (100, 30, 10, 3)]
        + [("implicit", f"{n} steps", [f"time.step={0.32 / n}"]) for n in (4, 8, 16, 32, 128)]),
    "drop": (
        DROP, "back", "reference, a quarter of the size", [],
        [("reference", "a quarter of the size", ["bodies.block.size=12.5 mm"])]
        + [("explicit", f"cfl {c}", [f"time.cfl={c}"]) for c in (0.9, 0.6, 0.3)]
        + [(f"implicit, {rule}", f"{s} ms",
            [f"time={{scheme: implicit, end: 0.6 s, step: {s} ms, integrator: {rule}}}"])
           for rule in ("euler", "newmark") for s in (8, 4, 2, 1, 0.5)]),
    "impact": (
        "rod_on_wall.yaml", "rebound", 202.2 * 0.0254, ["bodies.rod.size=0.25 in", "output.every=none"],
        [("explicit", f"cfl {c}", [f"time.cfl={c}"]) for c in (0.9, 0.5, 0.25)]
        + [(f"implicit, {rule}", f"{s} us",
            [f"time={{scheme: implicit, end: 250 us, step: {s} us, integrator: {rule}}}", "contact={distance: 0.001 in}"])
           for rule, s in (("euler", 4), ("euler", 2), ("newmark", 4), ("newmark", 2))]),
}


def run(scene, sets, measure):
    """Processor seconds and the measure; what was said when there is none."""
    folder = tempfile.mkdtemp()
    try:
        text = scene
        if "\n" not in scene:
            with open(SCENES + scene) as file:
                text = file.read()
            for mesh in glob.glob(SCENES + "ball*.msh"):
                shutil.copy(mesh, folder)
        path = os.path.join(folder, "scene.yaml")
        with open(path, "w") as file:
            file.write(text)
        command = [BRUNT, "run", path, "-q", "-t", "1", "-o", os.path.join(folder, "out")]
        sets = [w for s in sets for w in ("--set", s)]
        done = subprocess.run(command + sets, capture_output=True, text=True)
        if not os.path.exists(os.path.join(folder, "out", "summary.json")):
            return None, None, done.stderr.strip().splitlines()[0]
        with open(os.path.join(folder, "out", "summary.json")) as file:
            summary = json.load(file)
        if summary["status"] != "done":
            return None, None, summary["reason"]
        return summary["cpu_s"], summary["measures"][measure]["value"], summary["steps"]
    finally:
        shutil.rmtree(folder)


def judge(name):
    scene, measure, reference, common, runs = PAIRS[name]
    rows = []
    for method, what, sets in runs:
        seconds, value, steps = run(scene, common + sets, measure)
        print(f"{name}: {method}, {what}: {value} in {seconds} s, {steps}", flush=True)
        rows.append([name, method, what, steps, seconds, value])
    if isinstance(reference, str):
        right = [r[5] for r in rows if f"{r[1]}, {r[2]}" == reference][0]
    else:
        right = reference
    return [r + [abs(r[5] / right - 1) if r[5] is not None else None] for r in rows if r[1] != "reference"]


def outside(row):
    """How far it is off the pair's closed form, if it has one."""
    return abs(row[5] / OUTSIDE[row[0]][1] - 1) if row[0] in OUTSIDE and row[5] is not None else None


def cheapest(rows, error, goal):
    """Of runs from coarse to fine the cheapest from which on all are within the goal."""
    good = []
    for r in reversed(rows):
        if error(r) is None or error(r) > goal:
            break
        good.append(r)
    best = min(good, key=lambda r: r[4], default=None)
    return f"{best[4]:.2g} s ({best[2]})" if best else "-"


def store(rows):
    with open(HERE + ".csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["pair", "method", "refined", "steps", "cpu_s", "value", "error"])
        out.writerows(rows)


def stored():
    """What the last runs gave; a run that failed has no value, and what was said stands for its steps."""
    number = lambda text: float(text) if text else None
    with open(HERE + ".csv", newline="") as file:
        return [r[:4] + [number(text) for text in r[4:]] for r in list(csv.reader(file))[1:]]


def table_of_the_cheapest(rows):
    head = "| pair | method | against | 10 % | 3 % | 1 % |\n| --- | --- | --- | --- | --- | --- |\n"
    lines = []
    for pair, method in dict.fromkeys((r[0], r[1]) for r in rows):
        at = [r for r in rows if r[:2] == [pair, method]]
        own = PAIRS[pair][2] if isinstance(PAIRS[pair][2], str) else "closed form"
        for name, error in [(own, lambda r: r[6])] + ([(OUTSIDE[pair][0], outside)] if pair in OUTSIDE else []):
            lines.append(f"| {pair} | {method} | {name} | " + " | ".join(cheapest(at, error, goal) for goal in GOALS) + " |\n")
    return head + "".join(lines)


def table_of_all(rows):
    head = "| pair | method | | steps | time [s] | value | error | off the closed form |\n" + "| --- " * 8 + "|\n"
    lines = []
    for r in rows:
        pair, method, what, steps, seconds, value, error = r
        if value is None:
            lines.append(f"| {pair} | {method} | {what} | {steps} | | | | |\n")
        else:
            off = f"{100 * outside(r):.2g} %" if pair in OUTSIDE else ""
            lines.append(f"| {pair} | {method} | {what} | {steps} | {seconds:.2g} | {value:.5g} | {100 * error:.2g} % | {off} |\n")
    return head + "".join(lines)


def write(rows):
    with open(HERE + ".md", "w") as file:
        file.write("# Implicit beside explicit\n\n![Error over processor time](schemes.png)\n\n")
        file.write("`python3 bench/studies/schemes.py`; one thread, processor time of the whole run. Cheapest run of each within the error, as are\n"
                   "all finer ones of its method. Slow loads are judged twice: against the finest implicit run, which has the same mesh, and against a\n"
                   "closed form, which is neither method's.\n\n")
        file.write(table_of_the_cheapest(rows) + "\n" + table_of_all(rows))


def draw(rows):
    script = ["set terminal pngcairo size 1200,900 font 'Helvetica,13'", f"set output '{HERE}.png'", "set logscale xy",
              "set multiplot layout 2,2", "set key top right", "set xlabel 'processor time [s]'", "set ylabel 'error'", "set format y '10^{%T}'"]
    colours = {"explicit": "#0072B2", "implicit": "#D55E00", "implicit, euler": "#D55E00", "implicit, newmark": "#009E73"}
    for pair in dict.fromkeys(r[0] for r in rows):
        curves = []
        for m, method in enumerate(dict.fromkeys(r[1] for r in rows if r[0] == pair)):
            at = [r for r in rows if r[:2] == [pair, method] and r[6]]
            script.append(f"$d{m} << E\n" + "\n".join(f"{r[4]} {r[6]}" for r in at) + "\nE")
            curves.append(f"$d{m} with linespoints pt {m + 5} lc '{colours[method]}' lw 2 title '{method}'")
        script += [f"set title '{pair}'", "plot " + ", ".join(curves)]
    subprocess.run(["gnuplot"], input="\n".join(script) + "\n", text=True, check=True)


def main():
    names = [w for w in sys.argv[1:] if w != "--table"]
    rows = stored() if os.path.exists(HERE + ".csv") else []
    for name in names or ([] if "--table" in sys.argv else list(PAIRS)):
        rows = [r for r in rows if r[0] != name] + judge(name)
    rows.sort(key=lambda r: list(PAIRS).index(r[0]))
    store(rows)
    write(rows)
    draw(rows)


main()
