#!/usr/bin/env python3
"""Which transfer for what: solids, fluids and shocks by each, from scenes of bench/scenes. Writes transfers.csv and, of it, transfers.md.

usage: transfers.py [CASE...]      (default: all; from the top of the tree; BRUNT names the program, default build/brunt; ten minutes of one core)

A row a scene, transfer and figure; a run that stops has its reason in place of a figure. Noise: what of the points' motion at the end no velocities of the grid's
nodes can follow (a fit by least squares, disk_losses.py), as a share of the greatest
kinetic energy of the run.
"""
import csv, glob, json, os, subprocess, sys, tempfile
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from disk_losses import picture, unseen

HERE = "bench/studies/transfers.csv"
SHOULD = {"energy_kept": 1, "kinetic_left": 1, "length": 0.016303, "foot_radius": 0.006765, "front_slope": 1.324, "floor_force": 17.39, "pressure_plateau": 0.30313, "pressure": 9.627e9, "front_at_3": 6.957e-7}
BRUNT = os.path.abspath(os.environ.get("BRUNT", "build/brunt"))
TRANSFERS = ("pic", "apic", "{apic: 0.5}", "{apic: 0.9}", "{apic: 0.98}", "{flip: 0.98}", "{flip: 1}")
DISKS = ["contact={method: augury, friction: 0, stop: spring}", "grid.cell=25 mm", "output.every=3.5 s"]
# Name, scene, what is set, measures, cell for noise [m] (0: not asked)
CASES = (
    ("two disks, cfl 0.5", "two_disks", DISKS, ("energy_kept",), 0.025),
    ("two disks, cfl 0.1", "two_disks", [*DISKS, "time.cfl=0.1"], ("energy_kept",), 0.025),
    ("bar, ten periods, cfl 0.5", "axial_vibration", ["time.end=100 s", "time.cfl=0.5"], ("energy_kept",), 0),
    ("bar, ten periods, cfl 0.1", "axial_vibration", ["time.end=100 s", "time.cfl=0.1"], ("energy_kept",), 0),
    ("cube, twenty turns", "spinning_cube", [], ("kinetic_left", "angular_drift"), 0),
    ("Taylor bar", "taylor_bar_mpm3d", ["time={end: 80 us}"], ("length", "foot_radius"), 0),  # steps are each transfer's own
    ("dam break", "dam_break", ["output.every=0.19 s"], ("front_slope", "floor_force"), 0.0028575),
    ("shock tube", "shock_tube_mpm", ["output.every=0.2 s"], ("density_error", "pressure_plateau"), 0.0025),
    ("plate impact", "plate_impact_copper_mpm", [], ("pressure", "front_at_3"), 0),
)


def noise(folder, cell, moves):
    total = 0.0
    for path in {max(glob.glob(f"{folder}/vtu/{body}_*.vtu")) for body in {os.path.basename(p).rsplit("_", 1)[0] for p in glob.glob(folder + "/vtu/*.vtu")}}:
        arrays = picture(path)[0]
        total += unseen(arrays, list(arrays["mass"]), cell)
    return total / moves


def figures(scene, sets, measures, cell, transfer, folder):
    sets = ["output.every=none", "output.checkpoint=none", "output.fields=[velocity, mass]", "output.precision=float64", *sets, f"grid.transfer={transfer}"]
    done = subprocess.run([BRUNT, "run", f"bench/scenes/{scene}.yaml", "-t", "1", "-q", "--fresh", "-o", folder] + [w for s in sets for w in ("--set", s)], capture_output=True, text=True)
    if done.returncode:
        return {"stops": done.stderr.strip().splitlines()[-1].replace(",", ";")[:120]}
    with open(folder + "/summary.json") as file:
        found = json.load(file)["measures"]
    out = {name: f"{found[name]['value']:.6g}" for name in measures}
    if cell:
        with open(folder + "/history.csv") as file:
            moves = max(float(row["energy.kinetic [J]"]) for row in csv.DictReader(file))
        out["noise"] = f"{noise(folder, cell, moves):.2g}"
    return out


def shown(figure, value):
    off = f" ({100 * (float(value) / SHOULD[figure] - 1):+.2g})" if value and figure in SHOULD else ""
    return f"{float(value):.4g}{off}" if value and figure != "stops" else value


def main(names):
    rows = []
    if names and os.path.exists(HERE):
        with open(HERE) as file:
            rows = [row for row in list(csv.reader(file))[1:] if row[0] not in names]
    for name, scene, sets, measures, cell in CASES:
        for transfer in TRANSFERS if not names or name in names else ():
            with tempfile.TemporaryDirectory() as folder:
                found = figures(scene, sets, measures, cell, transfer, folder)
            rows += [[name, transfer, figure, value] for figure, value in found.items()]
            print(name, transfer, found, flush=True)
    order = [case[0] for case in CASES]
    rows.sort(key=lambda row: order.index(row[0]))
    with open(HERE, "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["case", "transfer", "figure", "value"])
        table.writerows(rows)
    with open(HERE.replace(".csv", ".md"), "w") as file:
        file.write("# Which transfer for what\n\nWritten by [transfers.py](transfers.py), which says what the cases are. Behind a figure, how far it is off what it should be [%].\n\n")
        file.write("| case | figure | " + " | ".join(TRANSFERS) + " |\n|" + " --- |" * (len(TRANSFERS) + 2) + "\n")
        for case, figure in dict.fromkeys((row[0], row[2]) for row in rows):
            of = {row[1]: row[3] for row in rows if (row[0], row[2]) == (case, figure)}
            file.write(f"| {case} | {figure} | " + " | ".join(shown(figure, of.get(transfer, "")) for transfer in TRANSFERS) + " |\n")


if __name__ == "__main__":
    if set(sys.argv[1:]) - {case[0] for case in CASES}:
        sys.exit(__doc__)
    main(sys.argv[1:])
