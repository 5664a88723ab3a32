#!/usr/bin/env python3
"""How much the forces between pressed disks differ, by how much their moduli do: square and hexagonal packings. Writes packings.csv and packings.png.

usage: packings.py           (from the top of the tree; BRUNT names the program, default build/brunt; some three minutes of one core)
       packings.py --plot    draws packings.png anew from packings.csv

The runs packing_square_5 and packing_hex_small of bench/scenes, with Young's moduli drawn from a normal distribution about 2.75 MPa cut off at 0.5 and
5 MPa, by its standard deviation; each with several seeds. A run that does not converge, or leaves more than 1e-8 of the forces on a body, ends the study.
"""
import csv, json, os, shlex, statistics, subprocess, sys, tempfile

HERE = "bench/studies/packings"
BRUNT = os.environ.get("BRUNT", "build/brunt")
PACKINGS = {"square": "packing_square_5", "hex": "packing_hex_small"}
FRICTION, SPREADS, SEEDS = (0.1, 0.5), (0, 0.25, 1, 4, 32), (1, 2, 3)  # SPREADS in MPa
HEAD = ["lattice", "friction", "spread [MPa]", "seed", "links", "mean [N/m]", "sd [N/m]", "greatest [N/m]", "slipping", "balance", "iterations"]


def overrides(run):
    for line in open("bench/scenes/runs.txt"):
        words = shlex.split(line, comments=True)
        if words and words[0] == run:
            return words[1], [w for w in words[3:] if "=" in w]
    sys.exit(f"packings.py: bench/scenes/runs.txt has no run {run}")


def measure(lattice, friction, spread, seed, folder):
    scene, sets = overrides(PACKINGS[lattice])
    sets = sets + [f"contact.friction={friction}", "newton.tolerance=1e-10", "output.every=none"]
    if spread:
        sets.append(f"bodies.grains.random={{E: {{normal: [2.75 MPa, {spread} MPa], between: [0.5 MPa, 5 MPa]}}, seed: {seed}}}")
    command = [BRUNT, "run", f"bench/scenes/{scene}.yaml", "-t", "1", "-q", "-o", folder]
    for one in sets:
        command += ["--set", one]
    subprocess.run(command, check=True)
    with open(f"{folder}/summary.json") as file:
        summary = json.load(file)
    links, balance = summary["links"], summary["balance"]["body"]
    if balance > 1e-8:
        sys.exit(f"packings.py: {lattice}, friction {friction}, spread {spread}, seed {seed}: {balance:.3g} of the forces on a body are left")
    return [lattice, friction, spread, seed, links["count"]] + [f"{links[k]:.6g}" for k in ("mean", "sd", "greatest")] + \
           [links["slipping"], f"{balance:.2g}", summary["newton"]["iterations"]]


def run():
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for lattice in PACKINGS:
            for friction in FRICTION:
                for spread in SPREADS:
                    for seed in SEEDS if spread else SEEDS[:1]:
                        rows.append(measure(lattice, friction, spread, seed, f"{folder}/out"))
                        print(*rows[-1], flush=True)
    with open(f"{HERE}.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD] + rows)


def plot():
    with open(f"{HERE}.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    script = ["set terminal pngcairo size 900,600 font ',13'", f"set output '{HERE}.png'", "set logscale x", "set key right bottom",
              "set xlabel 'standard deviation of the moduli [MPa]'", "set ylabel 'standard deviation of the normal forces over their mean'",
              "set yrange [0:*]", "set xrange [0.2:40]", "set grid"]
    curves, data = [], []
    for lattice in PACKINGS:
        for friction in FRICTION:
            of = [r for r in rows if r["lattice"] == lattice and float(r["friction"]) == friction]
            base = next(float(r["sd [N/m]"]) / float(r["mean [N/m]"]) for r in of if float(r["spread [MPa]"]) == 0)
            curves.append(f"'-' using 1:2:3:4 with yerrorlines lw 2 title '{lattice}, friction {friction:g} (all alike: {base:.3f})'")
            for spread in SPREADS[1:]:
                shares = [float(r["sd [N/m]"]) / float(r["mean [N/m]"]) for r in of if float(r["spread [MPa]"]) == spread]
                data.append(f"{spread * 1.04 ** len(curves)} {statistics.mean(shares)} {min(shares)} {max(shares)}")
            data.append("e")
    subprocess.run(["gnuplot"], input="\n".join(script + ["plot " + ", ".join(curves)] + data) + "\n", text=True, check=True)


if sys.argv[1:] not in ([], ["--plot"]):
    sys.exit(__doc__)
if not sys.argv[1:]:
    run()
plot()
