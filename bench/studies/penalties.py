#!/usr/bin/env python3
"""Barriers and penalties of load steps: how far tractions are off, and what it takes. Writes penalties.csv and penalties.png.

usage: penalties.py           (from the top of the tree; BRUNT names the program, default build/brunt; some five minutes of one core)
       penalties.py --plot    draws penalties.png anew from penalties.csv

Two cylinders pressed, then sheared (bench/scenes/cylinders_shear) with edges of 0.16 to 0.02 mm, 4 to 30 to half the width of the contact:
pressures and friction along both rims beside Hertz, Cattaneo and Mindlin of the computed forces (cylinders_shear.py), and the force beside that
of the finest mesh by barriers over the least distance. Then packings of bench/scenes/runs.txt, whose forces both methods should agree on.
Seconds are of one thread, its own (user), the least of RUNS; one after the other, so that ratios hold on a machine with other work.
"""
import csv, os, re, resource, shlex, subprocess, sys, tempfile

HERE = "bench/studies/penalties"
BRUNT = os.path.abspath(os.environ.get("BRUNT", "build/brunt"))
RUNS = 2
EDGES = {0.16: 3, 0.08: 6, 0.04: 13, 0.02: 26}  # [mm], and layers of them under the rim
KINDS = {  # contact of cylinders by edge [mm]: what differs from the scene
    "barrier": lambda edge: ["contact.method=barrier"],
    "barrier, distance 0.1 edge": lambda edge: ["contact.method=barrier", f"contact.distance={100 * edge:g} um", f"bodies.upper.place=[{{translate: [0, {100 * edge:g} um]}}]"],
    "penalty": lambda edge: ["contact.method=penalty"],
    "penalty, 4 times as stiff": lambda edge: ["contact.method=penalty", "contact.penalty=7.4 GPa/mm"],
    "penalty, a quarter": lambda edge: ["contact.method=penalty", "contact.penalty=0.46 GPa/mm"],
}
PACKINGS = ["packing_square_5", "packing_hex_small", "packing_hex_small_32", "packing_hex_small_3", "packing_hex_small_1"]
HEAD = ["run", "contact", "edge [mm]", "force [N/m]", "pressures off [%]", "friction off [%]", "iterations", "seconds"]


def seconds_of(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        return None
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def run_scene(scene, sets, folder):
    command = [BRUNT, "run", scene, "-t", "1", "-q", "-o", folder, "--fresh"]
    for one in sets + ["output.every=none"]:
        command += ["--set", one]
    times = [seconds_of(command) for _ in range(RUNS)]
    if None in times:
        return None, None
    import json
    with open(f"{folder}/summary.json") as file:
        return json.load(file), min(times)


def cylinders(folder):
    here = os.path.abspath("bench/scenes")
    for edge, layers in EDGES.items():
        for sign, name in ((1, "10"), (-1, "12")):
            with open(f"{folder}/cylinder_{name}.msh", "w") as file:
                subprocess.run([sys.executable, f"{here}/cylinder_mesh.py", f"{sign * int(name)}e-3", f"{edge}e-3", "0.68e-3", str(layers)], stdout=file, check=True)
        for kind, sets in KINDS.items():
            meshes = [f"bodies.upper.mesh={folder}/cylinder_10.msh", f"bodies.lower.mesh={folder}/cylinder_12.msh"]
            summary, seconds = run_scene(f"{here}/cylinders_shear.yaml", meshes + sets(edge), f"{folder}/out")
            if not summary:
                yield ["cylinders", kind, edge] + ["-"] * 5
                continue
            told = subprocess.run([sys.executable, f"{here}/cylinders_shear.py", f"{folder}/out", "0.5"], capture_output=True, text=True, check=True).stdout
            off = re.search(r"pressures off by ([\d.]+) %, friction by ([\d.]+) %", told)
            force = summary["measures"]["pressed"]["value"]
            yield ["cylinders", kind, edge, f"{force:.6g}", off[1], off[2], summary["newton"]["iterations"], f"{seconds:.2f}"]


def packings(folder):
    for run in PACKINGS:
        scene, sets = next((w[1], [x for x in w[3:] if "=" in x]) for w in (shlex.split(line, comments=True) for line in open("bench/scenes/runs.txt")) if w and w[0] == run)
        for kind in ("barrier", "penalty"):
            summary, seconds = run_scene(f"bench/scenes/{scene}.yaml", sets + [f"contact.method={kind}"], f"{folder}/out")
            if not summary:
                yield [run, kind, "-"] + ["-"] * 5
                continue
            yield [run, kind, "-", f"{summary['links']['mean']:.6g}", "-", "-", summary["newton"]["iterations"], f"{seconds:.2f}"]


def run():
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for part in (cylinders, packings):
            for row in part(folder):
                rows.append(row)
                print(*row, sep=", ", flush=True)
    with open(f"{HERE}.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD] + rows)


def time_to(rows, column, percent):
    """Seconds, by the line between two meshes in logarithms, from which on an error is less; None: it is never."""
    from math import exp, log
    points = sorted((float(r["seconds"]), float(r[column])) for r in rows if r["seconds"] != "-")
    if points and points[0][1] <= percent:
        return points[0][0]
    for (t0, e0), (t1, e1) in zip(points, points[1:]):
        if e0 > percent >= e1:
            return exp(log(t0) + (log(t1) - log(t0)) * (log(e0) - log(percent)) / (log(e0) - log(e1)))
    return None


def plot():
    with open(f"{HERE}.csv", newline="") as file:
        rows = [r for r in csv.DictReader(file) if r["run"] == "cylinders"]
    script = ["set terminal pngcairo size 1100,520 font ',12'", f"set output '{HERE}.png'", "set multiplot layout 1,2", "set logscale xy", "set grid",
              "set xlabel 'processor time [s]'", "set key left bottom", "set yrange [0.4:40]"]
    for column in ("pressures off [%]", "friction off [%]"):
        script.append(f"set ylabel '{column}'")
        curves = ", ".join(f"'-' with linespoints lw 2 title '{kind}'" for kind in KINDS)
        script.append(f"plot {curves}")
        for kind in KINDS:
            of = [r for r in rows if r["contact"] == kind and r["seconds"] != "-"]
            script += [f"{r['seconds']} {r[column]}" for r in of] + ["e"]
            times = [time_to(of, column, p) for p in (5, 2, 1)]
            print(f"{column[:9]}, {kind}: 5, 2, 1 % in", ", ".join("-" if t is None else f"{t:.1f} s" for t in times))
    subprocess.run(["gnuplot"], input="\n".join(script) + "\n", text=True, check=True)


if sys.argv[1:] not in ([], ["--plot"]):
    sys.exit(__doc__)
if not sys.argv[1:]:
    run()
plot()
