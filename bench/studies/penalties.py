#!/usr/bin/env python3
"""Barriers and penalties of load steps: how far tractions are off, and what it takes. Writes penalties.csv and penalties.png.

usage: penalties.py           (from the top of the tree; BRUNT names the program, default build/brunt; some fifteen minutes of one core)
       penalties.py --plot    draws penalties.png anew from penalties.csv

Two cylinders pressed, then sheared (bench/scenes/cylinders_shear) with edges of 0.16 to 0.01 mm, 4 to 60 to half the width of the contact, and a
slip_length of edge / 150: pressures and friction along both rims beside Hertz, Cattaneo and Mindlin of the computed forces (cylinders_shear.py), at nodes
of each rim, and as means over nodes' parts halfway between what lies on each other. Then packings of bench/scenes/runs.txt, whose forces all methods
should agree on, those of round rims as they are, which begin touching; and nine disks in a square lattice whose moduli differ by up to 1e4: every
second one, or drawn by seeds.
Seconds are of one thread, its own (user), the least of RUNS; one after the other, so that ratios hold on a machine with other work.
"""
import csv, json, os, random, re, resource, shlex, subprocess, sys, tempfile

HERE = "bench/studies/penalties"
BRUNT = os.path.abspath(os.environ.get("BRUNT", "build/brunt"))
RUNS = 2
EDGES = {0.16: 3, 0.08: 6, 0.04: 13, 0.02: 26, 0.01: 52}  # [mm], and layers of them under the rim
STIFFER, SOFTER = "contact.penalty=7.4 GPa/mm", "contact.penalty=0.46 GPa/mm"
KINDS = {  # contact of cylinders by edge [mm]: what differs from the scene
    "barrier": lambda edge: ["contact.method=barrier"],
    "barrier, distance 0.1 edge": lambda edge: ["contact.method=barrier", f"contact.distance={100 * edge:g} um", f"bodies.upper.place=[{{translate: [0, {100 * edge:g} um]}}]"],
    "penalty": lambda edge: ["contact.method=penalty"],
    "penalty, 4 times as stiff": lambda edge: ["contact.method=penalty", STIFFER],
    "penalty, 4 times as stiff, arcs": lambda edge: ["contact.method=penalty", STIFFER, "contact.surface=arcs"],
    "penalty, a quarter": lambda edge: ["contact.method=penalty", SOFTER],
}
PACKINGS = ["packing_square_5", "packing_hex_small", "packing_hex_small_32", "packing_hex_small_3", "packing_hex_small_1"]
TOUCHING = ["packing_square_round_5", "packing_hex_round"]
METHODS = {"barrier": ["contact.method=barrier"], "penalty": ["contact.method=penalty"], "penalty, arcs": ["contact.method=penalty", "contact.surface=arcs"]}
NINE = {"barrier": ("barrier, distance: 50 um", 0.03), "penalty": ("penalty, distance: 50 um", 0.03), "penalty, arcs": ("penalty, distance: 50 um, surface: arcs", 0.03),
        "penalty, arcs, touching": ("penalty, surface: arcs", 0)}  # contact, and the gap [mm]
HEAD = ["run", "contact", "edge [mm]", "force [N/m]", "pressures off [%]", "friction off [%]", "pressures halfway off [%]", "friction halfway off [%]", "iterations", "seconds"]


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
    with open(f"{folder}/summary.json") as file:
        return json.load(file), min(times)


def row(names, off, force, summary, seconds):
    return names + ([force(summary), *off(), summary["newton"]["iterations"], f"{seconds:.2f}"] if summary else ["-"] * 7)


def cylinders(folder):
    here = os.path.abspath("bench/scenes")

    def off():
        told = subprocess.run([sys.executable, f"{here}/cylinders_shear.py", f"{folder}/out", "0.5"], capture_output=True, text=True, check=True).stdout
        return re.findall(r"pressures off by ([\d.]+) %, friction by ([\d.]+) %", told)[0] + re.findall(r"parts ([\d.]+) and ([\d.]+) %", told)[1]

    for edge, layers in EDGES.items():
        for sign, name in ((1, "10"), (-1, "12")):
            with open(f"{folder}/cylinder_{name}.msh", "w") as file:
                subprocess.run([sys.executable, f"{here}/cylinder_mesh.py", f"{sign * int(name)}e-3", f"{edge}e-3", "0.68e-3", str(layers)], stdout=file, check=True)
        for kind, sets in KINDS.items():
            meshes = [f"bodies.upper.mesh={folder}/cylinder_10.msh", f"bodies.lower.mesh={folder}/cylinder_12.msh", f"contact.slip_length={1e3 * edge / 150:.6g} um"]
            summary, seconds = run_scene(f"{here}/cylinders_shear.yaml", meshes + sets(edge), f"{folder}/out")
            yield row(["cylinders", kind, edge], off, lambda s: f"{s['measures']['pressed']['value']:.6g}", summary, seconds)


def links(summary):
    return f"{summary['links']['mean']:.6g}"


def packings(folder):
    scenes = {w[0]: (w[1], [x for x in w[3:] if "=" in x]) for w in (shlex.split(line, comments=True) for line in open("bench/scenes/runs.txt")) if w}
    for run in PACKINGS + TOUCHING:
        scene, sets = scenes[run]
        for kind in ["penalty, arcs"] if run in TOUCHING else METHODS:
            summary, seconds = run_scene(f"bench/scenes/{scene}.yaml", sets + METHODS[kind], f"{folder}/out")
            yield row([run, kind, "-"], lambda: ["-"] * 4, links, summary, seconds)


def nine_disks(seed, contact, gap, mesh):
    """Between smooth planes and plates, as in bench/scenes/packing_square.yaml; seed 0: every second one 1e4 times as stiff."""
    draw, cell = random.Random(seed), 10 + gap
    wide, places = 3 * cell, [(i, j) for i in range(3) for j in range(3)]
    moduli = [2.75 * (1e4 ** ((i + j + 1) % 2) if seed == 0 else 10 ** draw.uniform(-2, 2)) for i, j in places]
    plate = f"{{method: fem, element: quad4, size: {0.8 * wide:.9g} mm, material: steel, shape: {{box: {{min: [%s], max: [%s]}}}}}}"
    low, high, far, further = "0.1 mm", f"{wide + 0.1:.9g} mm", f"{wide:.9g} mm", f"{wide + 5:.9g} mm"
    lines = ["brunt: 1", "dimension: 2", "time: {scheme: static, steps: 3}", "newton: {tolerance: 1e-8, iterations: 300}", "materials:", "  steel: {model: linear-elastic, density: 1000 kg/m^3, E: 200 GPa, nu: 0.3}"]
    lines += [f"  m{i}{j}: {{model: linear-elastic, density: 1000 kg/m^3, E: {e:.9g} MPa, nu: 0.3333333}}" for (i, j), e in zip(places, moduli)] + ["bodies:"]
    lines += [f"  g{i}{j}: {{method: fem, mesh: {mesh}, material: m{i}{j}, place: [{{translate: [{(j + 0.5) * cell:.9g} mm, {(i + 0.5) * cell:.9g} mm]}}]}}" for i, j in places]
    lines += ["  top: " + plate % (f"{low}, {far}", f"{high}, {further}"), "  right: " + plate % (f"{far}, {low}", f"{further}, {high}"), "boundaries:",
              "  - {plane: {point: [0, 0], normal: [1, 0]}, condition: separate}", "  - {plane: {point: [0, 0], normal: [0, 1]}, condition: separate}",
              f"  - {{body: top, group: ymax, traction: [0, {-90e3 / wide:.9g} Pa], table: [[0 s, 0], [1 s, 1]]}}",
              f"  - {{body: right, group: xmax, traction: [{-90e3 / wide:.9g} Pa, 0], table: [[0 s, 0], [1 s, 1]]}}",
              "  - {body: top, group: surface, fix: [x]}", "  - {body: right, group: surface, fix: [y]}",
              f"contact: {{method: {contact}, friction: 0.5, pairs: [{{between: [top, right], method: none}}"
              + "".join(f", {{between: [g{i}{j}, {p}], friction: 0}}" for i, j in places for p in ("top", "right")) + "]}", "output: {history: 0 s}"]
    return "\n".join(lines) + "\n"


def nine(folder):
    with open(f"{folder}/disk.msh", "wb") as file:
        subprocess.run([sys.executable, "bench/scenes/disk_mesh.py", "5e-3", "32"], stdout=file, check=True)
    for seed in range(7):
        for kind, (contact, gap) in NINE.items():
            with open(f"{folder}/nine.yaml", "w") as file:
                file.write(nine_disks(seed, contact, gap, f"{folder}/disk.msh"))
            summary, seconds = run_scene(f"{folder}/nine.yaml", [], f"{folder}/out")
            yield row([f"nine disks, {f'seed {seed}' if seed else 'every second'}", kind, "-"], lambda: ["-"] * 4, links, summary, seconds)


def run():
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for part in (cylinders, packings, nine):
            for one in part(folder):
                rows.append(one)
                print(*one, sep=", ", flush=True)
    with open(f"{HERE}.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD] + rows)


def time_to(rows, column, percent):
    """Seconds, by the line between two meshes in logarithms, from which on an error is less, on all that take longer; None: it is never."""
    from math import exp, log
    points = sorted((float(r["seconds"]), float(r[column])) for r in rows if r["seconds"] != "-")
    if not points or points[-1][1] > percent:
        return None
    for (t0, e0), (t1, e1) in reversed(list(zip(points, points[1:]))):
        if e0 > percent >= e1:
            return exp(log(t0) + (log(t1) - log(t0)) * (log(e0) - log(percent)) / (log(e0) - log(e1)))
    return points[0][0]


def plot():
    with open(f"{HERE}.csv", newline="") as file:
        rows = [r for r in csv.DictReader(file) if r["run"] == "cylinders"]
    script = ["set terminal pngcairo size 1100,600 font ',12'", f"set output '{HERE}.png'", "set multiplot layout 1,2", "set logscale xy", "set grid",
              "set xlabel 'processor time [s]'", "set key below", "set yrange [0.1:20]"]
    for column in ("pressures halfway off [%]", "friction halfway off [%]"):
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
