#!/usr/bin/env python3
"""How much the forces between pressed disks differ, by how much their moduli do: square and hexagonal packings. Writes packings.csv and packings.png.

usage: packings.py           (from the top of the tree; BRUNT names the program, default build/brunt; some two hours of one core. Goes on after
                             the draws that packings.csv has: remove it to draw all anew)
       packings.py --plot    draws packings.png anew from packings.csv
       packings.py --table   writes the table of the README from packings.csv

The runs packing_square_round (625 disks) and packing_hex (711) of bench/scenes, with Young's moduli drawn from a normal distribution about 2.75 MPa cut
off at 0.5 and 5 MPa, by its standard deviation; each with several seeds. A run that does not converge, or leaves more than 1e-8 of the forces on a
body, ends the study.
"""
import csv, json, os, shlex, statistics, subprocess, sys, tempfile

HERE = "bench/studies/packings"
BRUNT = os.environ.get("BRUNT", "build/brunt")
PACKINGS = {"square": "packing_square_round", "hex": "packing_hex"}
FRICTION, SPREADS = (0, 0.1, 0.3, 0.5), (0, 0.125, 0.5, 2, 8, 32)  # SPREADS in MPa
HEAD = ["lattice", "friction", "spread [MPa]", "seed", "links", "mean [N/m]", "sd [N/m]", "greatest [N/m]", "slipping", "balance", "cuts",
        "iterations", "time [s]"]


def seeds(lattice, friction, spread):
    """Draws of a row: ten where moduli differ the most, as the paper has, three elsewhere; alike there is nothing to draw. A square lattice that no
    friction holds collapses, in up to 1,301 iterations: one draw from 2 MPa on."""
    one = not spread or (lattice == "square" and friction == 0 and spread >= 2)
    return range(1, 2 if one else 11 if spread == 32 and friction in (0.1, 0.5) else 4)


def overrides(run):
    for line in open("bench/scenes/runs.txt"):
        words = shlex.split(line, comments=True)
        if words and words[0] == run:
            return words[1], [w for w in words[3:] if "=" in w]
    sys.exit(f"packings.py: bench/scenes/runs.txt has no run {run}")


def measure(lattice, friction, spread, seed, folder):
    scene, sets = overrides(PACKINGS[lattice])
    sets = sets + [f"contact.friction={friction}", "newton.tolerance=1e-10", "newton.iterations=600", "output.every=none"]
    if spread:
        sets.append(f"bodies.grains.random={{E: {{normal: [2.75 MPa, {spread} MPa], between: [0.5 MPa, 5 MPa]}}, seed: {seed}}}")
    command = [BRUNT, "run", f"bench/scenes/{scene}.yaml", "-t", "1", "-q", "-o", folder]
    for one in sets:
        command += ["--set", one]
    subprocess.run(command, check=True)
    with open(f"{folder}/summary.json") as file:
        summary = json.load(file)
    links, balance, newton = summary["links"], summary["balance"]["body"], summary["newton"]
    if balance > 1e-8:
        sys.exit(f"packings.py: {lattice}, friction {friction}, spread {spread}, seed {seed}: {balance:.3g} of the forces on a body are left")
    return [lattice, friction, spread, seed, links["count"]] + [f"{links[k]:.6g}" for k in ("mean", "sd", "greatest")] + \
           [links["slipping"], f"{balance:.2g}", newton["cuts"], newton["iterations"], f"{summary['cpu_s']:.1f}"]


def read():
    with open(f"{HERE}.csv", newline="") as file:
        return list(csv.DictReader(file))


def run():
    done = {(r["lattice"], r["friction"], r["spread [MPa]"], r["seed"]) for r in read()} if os.path.exists(f"{HERE}.csv") else set()
    with tempfile.TemporaryDirectory() as folder, open(f"{HERE}.csv", "a", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        if not done:
            writer.writerow(HEAD)
        for friction in sorted(FRICTION, reverse=True):
            for spread in SPREADS:
                for lattice in PACKINGS:
                    for seed in seeds(lattice, friction, spread):
                        if (lattice, str(friction), str(spread), str(seed)) not in done:
                            row = measure(lattice, friction, spread, seed, f"{folder}/out")
                            writer.writerow(row)
                            file.flush()
                            print(*row, flush=True)


def shares(rows, lattice, friction, spread):
    of = [r for r in rows if r["lattice"] == lattice and float(r["friction"]) == friction and float(r["spread [MPa]"]) == spread]
    return of, [float(r["sd [N/m]"]) / float(r["mean [N/m]"]) for r in of]


def table():
    rows = read()
    print("| standard deviation of forces over their mean, moduli [MPa] | " + " | ".join(f"{s:g}" for s in SPREADS) + " |\n" + "| --- " * (len(SPREADS) + 1) + "|")
    for lattice in PACKINGS:
        for friction in FRICTION:
            cells = []
            for spread in SPREADS:
                of, sd = shares(rows, lattice, friction, spread)
                if not of:
                    cells.append("-")
                    continue
                least, most = (f"{value:.3f}" for value in (min(sd), max(sd)))
                took = [int(r["iterations"]) for r in of]
                cells.append((least if least == most else f"{statistics.mean(sd):.3f} ({least} .. {most})") + f", {statistics.mean(took):.0f} it.")
            print(f"| {lattice}, friction {friction:g} | " + " | ".join(cells) + " |")


def plot():
    rows = read()
    script = ["set terminal pngcairo size 900,600 font ',13'", f"set output '{HERE}.png'", "set logscale x", "set key right bottom",
              "set xlabel 'standard deviation of the moduli [MPa]'", "set ylabel 'standard deviation of the normal forces over their mean'",
              "set yrange [0:*]", "set xrange [0.1:50]", "set grid"]
    curves, data = [], []
    for lattice in PACKINGS:
        for friction in FRICTION:
            base = shares(rows, lattice, friction, 0)[1][0]
            curves.append(f"'-' using 1:2:3:4 with yerrorlines lw 2 title '{lattice}, friction {friction:g} (all alike: {base:.3f})'")
            for spread in SPREADS[1:]:
                sd = shares(rows, lattice, friction, spread)[1]
                if not sd:
                    continue
                data.append(f"{spread * 1.03 ** len(curves)} {statistics.mean(sd)} {min(sd)} {max(sd)}")
            data.append("e")
    subprocess.run(["gnuplot"], input="\n".join(script + ["plot " + ", ".join(curves)] + data) + "\n", text=True, check=True)


if sys.argv[1:] not in ([], ["--plot"], ["--table"]):
    sys.exit(__doc__)
if sys.argv[1:] == ["--table"]:
    table()
else:
    if not sys.argv[1:]:
        run()
    plot()
