#!/usr/bin/env python3
"""What packings of 100 to 10,000 pressed disks take: time by pass, memory, iterations. Writes packing_growth.csv and packing_growth.png.

usage: packing_growth.py [LATTICE...]   (from the top of the tree; BRUNT names the program, default build/brunt; some ten minutes, of which two are of two cores)
       packing_growth.py --plot         draws packing_growth.png anew from packing_growth.csv

The scenes bench/scenes/packing_square.yaml and packing_hex_small.yaml with as many disks a side as are asked for, and Young's moduli all alike or
drawn about 2.75 MPa with a standard deviation of 8 MPa between 0.5 and 5 MPa. Three load steps. Lines of lattices that are named are taken anew, the others
stay. A run that finds no equilibrium within half an hour is a line without iterations.
"""
import csv, json, math, os, re, subprocess, sys, tempfile

HERE = "bench/studies/packing_growth"
BRUNT = os.environ.get("BRUNT", "build/brunt")
PITCH, LONGEST = 10.03, 1800  # mm, s
SCENES = {"square": "packing_square", "hex": "packing_hex_small"}
RUNS = [("square", 0, n, t) for n in (10, 25, 50, 100) for t in (1, 2)] + [("square", 8, n, 1) for n in (10, 25, 50, 100)] + \
       [("hex", 0, n, 1) for n in (10, 25, 50, 93)] + [("hex", 8, n, 1) for n in (10, 25)]
PASSES = ["newton", "evaluate", "matrix", "factor", "solve", "limit", "search", "commit"]
HEAD = ["lattice", "spread [MPa]", "disks", "threads", "iterations", "factorised", "begin [s]", "steps [s]", "output [s]"] + \
       [f"{p} [s]" for p in PASSES] + ["peak [MB]"]


def sets(lattice, spread, side):
    rows = side if lattice == "square" else side + side // 6  # about as high as it is wide
    wide, high = side * PITCH, PITCH + (rows - 1) * PITCH * (1 if lattice == "square" else math.sqrt(0.75))
    yield f"bodies.grains.crowd={{lattice: {lattice}, count: [{side}, {rows}], radius: 5 mm, gap: 30 um}}"
    yield f"bodies.top.shape.box={{min: [0.1 mm, {high:.4f} mm], max: [{wide + 0.1:.4f} mm, {high + 5:.4f} mm]}}"
    yield f"bodies.right.shape.box={{min: [{wide:.4f} mm, 0.1 mm], max: [{wide + 5:.4f} mm, {high + 0.1:.4f} mm]}}"
    for plate in "top", "right":
        yield f"bodies.{plate}.size={0.9 * min(wide, high):.3f} mm"
    if spread:
        yield f"bodies.grains.random={{E: {{normal: [2.75 MPa, {spread} MPa], between: [0.5 MPa, 5 MPa]}}, seed: 1}}"
    if lattice == "hex":
        yield "bodies.grains.size=1 mm"
    yield "output.every=none"


def seconds_of(text, pattern):
    found = re.search(pattern, text, re.M)
    return float(found.group(1)) if found else 0.0


def measure(lattice, spread, side, threads, folder):
    command = [BRUNT, "run", f"bench/scenes/{SCENES[lattice]}.yaml", "-t", str(threads), "-q", "--fresh", "--profile", "-o", folder]
    for one in sets(lattice, spread, side):
        command += ["--set", one]
    try:
        done = subprocess.run(command, timeout=LONGEST, stderr=subprocess.DEVNULL).returncode == 0
    except subprocess.TimeoutExpired:
        done = False
    with open(f"{folder}/log.txt") as file:
        log = file.read()
    rows = side if lattice == "square" else side + side // 6
    disks = side * rows - (0 if lattice == "square" else rows // 2)  # each second row has one less
    if not done:
        return [lattice, spread, disks, threads] + [""] * (len(HEAD) - 4)
    with open(f"{folder}/summary.json") as file:
        summary = json.load(file)
    wall = seconds_of(log, r"^wall ([\d.e+-]+) s")
    steps, output = seconds_of(log, r"of it steps ([\d.e+-]+) s"), seconds_of(log, r"output ([\d.e+-]+) s; cpu")
    passes = [seconds_of(log, rf"^  {p} +([\d.e+-]+) ") for p in PASSES]
    newton = summary["newton"]
    return [lattice, spread, disks, threads, int(newton["iterations"]), int(newton["factorisations"]), f"{wall - steps - output:.2f}", f"{steps:.2f}",
            f"{output:.2f}"] + [f"{p:.3f}" for p in passes] + [f"{summary['peak_rss_bytes'] / 1e6:.0f}"]


def run(lattices):
    rows = []
    if lattices and os.path.exists(f"{HERE}.csv"):
        with open(f"{HERE}.csv", newline="") as file:
            rows = [r for r in list(csv.reader(file))[1:] if r[0] not in lattices]
    with tempfile.TemporaryDirectory() as folder:
        for lattice, spread, side, threads in RUNS:
            if not lattices or lattice in lattices:
                rows.append(measure(lattice, spread, side, threads, f"{folder}/out"))
                print(*rows[-1], flush=True)
    with open(f"{HERE}.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD] + rows)


def plot():
    with open(f"{HERE}.csv", newline="") as file:
        rows = [r for r in csv.DictReader(file) if r["iterations"] and r["threads"] == "1"]
    script = ["set terminal pngcairo size 1300,560 font ',13'", f"set output '{HERE}.png'", "set multiplot layout 1,2", "set logscale xy",
              "set xlabel 'disks'", "set grid", "set key top left", "set xrange [80:13000]"]
    square = [r for r in rows if r["lattice"] == "square" and r["spread [MPa]"] == "0"]
    columns = {"factor": ["factor"], "energies, forces, contact": ["evaluate", "limit", "search", "newton", "commit"], "matrix": ["matrix"],
               "solutions": ["solve"]}

    def block(points):
        return [f"{x} {y}" for x, y in points] + ["e"]
    data, curves = [], []
    for name, passes in columns.items():
        curves.append(f"'-' with linespoints lw 2 pt 7 title '{name}'")
        data += block((r["disks"], sum(float(r[f"{p} [s]"]) for p in passes) / int(r["iterations"])) for r in square)
    for name, key in (("to begin, all in all", "begin [s]"), ("output, all in all", "output [s]")):
        curves.append(f"'-' with linespoints lw 2 dt 2 title '{name}'")
        data += block((r["disks"], float(r[key])) for r in square)
    curves.append("1e-4 * x / 100 * 10 lc rgb 'grey' dt 3 title 'as their number'")
    script += ["set yrange [3e-4:300]", "set ylabel 's an iteration, square lattice, moduli alike'", "plot " + ", ".join(curves)] + data
    data, curves = [], []
    for lattice, spread in sorted({(r["lattice"], r["spread [MPa]"]) for r in rows}, reverse=True):
        of = [r for r in rows if (r["lattice"], r["spread [MPa]"]) == (lattice, spread)]
        curves.append(f"'-' with linespoints lw 2 pt 7 title '{lattice}, {'moduli alike' if spread == '0' else 'moduli by ' + spread + ' MPa'}'")
        data += block((r["disks"], float(r["peak [MB]"]) - 40) for r in of)
    curves.append("0.2 * x lc rgb 'grey' dt 3 title '0.2 MB each'")
    script += ["set yrange [10:10000]", "set ylabel 'peak of memory, beyond the 40 MB of the program [MB]'", "plot " + ", ".join(curves)] + data
    subprocess.run(["gnuplot"], input="\n".join(script) + "\n", text=True, check=True)


if sys.argv[1:] != ["--plot"]:
    if not set(sys.argv[1:]) <= {"square", "hex"}:
        sys.exit(__doc__)
    run(sys.argv[1:])
plot()
