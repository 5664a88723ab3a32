#!/bin/sh
# What the rear wall of whipple_shield.yaml gets: with and without the bumper, over stand-off and over the bumper's thickness.
#
#   sh bench/studies/whipple.sh [BRUNT]      default build/brunt
#
# Writes whipple.csv beside this file and prints it as a table (wants python3-vtk9, as bench/render.py). One thread a run, two at a
# time, some six minutes in all. Finished runs (in $OUT, default out/whipple) are kept.
# Without bumper: it lies 0.9 m behind the wall, where nothing comes.
set -u
cd "$(dirname "$0")/../.."
brunt=${1:-build/brunt}
out=${OUT:-out/whipple}
[ -x "$brunt" ] || { echo "no program $brunt" >&2; exit 64; }
mkdir -p "$out"

# cell [mm], bumper [mm] (0: none), stand-off [mm], wall [mm]
cases="0.5:2.5:100:6.5 0.5:0:100:6.5 0.5:0:100:9 0.5:2.5:50:6.5 0.5:2.5:200:6.5 0.5:0.5:100:6.5 0.5:1:100:6.5 0.5:1.5:100:6.5
       0.5:5:100:6.5 0.35:2.5:100:6.5 0.35:0:100:6.5"

run() { # CELL BUMPER STANDOFF WALL
    cell=$1
    shift
    dir=$out/${cell}_$1_$2_$3
    grep -q '"status": *"done"' "$dir/summary.json" 2>/dev/null && return
    if [ "$1" = 0 ]; then from=-1000 to=-997.5 front=-100; else from=-$1 to=0 front=-$(echo "$1 + $2" | bc); fi
    # 80 us from when the cloud is there
    "$brunt" run bench/scenes/whipple_shield.yaml --fresh -q -t 1 -o "$dir" --set "grid.cell=$cell mm" \
        --set "bodies.bumper.shape.box={min: [0, $from mm], max: [40 mm, $to mm]}" \
        --set "bodies.wall.shape.box={min: [0, $(echo "$front - $3" | bc) mm], max: [100 mm, $front mm]}" \
        --set "time.end=$(echo "80 + $2 / 5" | bc) us" --set "output.every=$(echo "80 + $2 / 5" | bc) us" >/dev/null 2>&1
}
for c in $cases; do
    run $(echo "$c" | tr : ' ') &
    n=$((${n:-0} + 1))
    [ $((n % 2)) -ne 0 ] || wait # two at a time
done
wait

/usr/bin/python3 - "$out" "$cases" <<'END_OF_TABLE'
import csv, glob, json, math, sys
import vtk
from vtk.util.numpy_support import vtk_to_numpy

out, cases = sys.argv[1], sys.argv[2].split()
FAST = 100.0  # [m/s] beyond this against the rim a point of the wall flies rather than bends


def points(folder, body):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(sorted(glob.glob(f"{folder}/vtu/{body}_*.vtu"))[-1])
    reader.Update()
    grid = reader.GetOutput()
    data = grid.GetPointData()
    return (vtk_to_numpy(grid.GetPoints().GetData()), vtk_to_numpy(data.GetArray("velocity")), vtk_to_numpy(data.GetArray("mass")))


def first_momentum(history, head):
    return -float(history[1][head.index("body.sphere.mass")]) * float(history[1][head.index("body.sphere.velocity_y")])


def row(cell, bumper, standoff, wall):
    folder = f"{out}/{cell}_{bumper}_{standoff}_{wall}"
    try:
        summary = json.load(open(folder + "/summary.json"))
    except OSError:
        summary = {"status": "not run"}
    if summary["status"] != "done":
        return [cell, bumper, standoff, wall, summary["status"]]
    history = list(csv.reader(open(folder + "/history.csv")))
    head = [name.split()[0] for name in history[0]]
    last = {name: float(value) for name, value in zip(head, history[-1])}
    x, v, m = points(folder, "wall")
    rim = x[:, 0] > 0.09
    rim_v, rim_y = (m[rim] * v[rim, 1]).sum() / m[rim].sum(), (m[rim] * x[rim, 1]).sum() / m[rim].sum()
    rest = ((v[:, 0] ** 2 + (v[:, 1] - rim_v) ** 2) ** 0.5 < FAST)
    hole = x[rest, 0].min()
    behind = (~rest) & (x[:, 1] < rim_y)
    through = 0.0
    for body in ("sphere", "bumper"):
        if body == "bumper" and bumper == "0":
            continue
        X, _, M = points(folder, body)
        through += M[(X[:, 1] < rim_y - 0.5e-3 * float(wall) - 0.002) & (X[:, 0] < 0.1)].sum()  # not past its rim
    ring = rest & (x[:, 0] > 0.025) & (x[:, 0] < 0.03)
    bend = rim_y - (m * x[:, 1])[ring].sum() / m[ring].sum()
    speed = -float(last["body.wall.velocity_y"])
    return [cell, bumper, standoff, wall, f"{speed * last['body.wall.mass']:.2f}", f"{speed * last['body.wall.mass'] / first_momentum(history, head):.2f}",
            f"{1e3 * hole:.1f}", f"{1e3 * m[behind].sum():.2f}", f"{1e3 * through:.2f}", f"{1e3 * bend:.1f}", f"{last['body.wall.plastic']:.0f}",
            f"{summary['measures']['energy_error']['value']:.1e}", f"{summary['measures']['momentum_drift']['value']:.0e}",
            f"{summary['cpu_s']:.0f}"]


table = [["cell [mm]", "bumper [mm]", "stand-off [mm]", "wall [mm]", "momentum [N s]", "over the sphere's", "radius of the hole [mm]",
          "wall thrown off its back [g]", "debris through [g]", "bent at 27 mm [mm]", "plastic work in the wall [J]", "energy error", "momentum drift",
          "cpu [s]"]]
for case in cases:
    table.append(row(*case.split(":")))
with open("bench/studies/whipple.csv", "w") as file:
    csv.writer(file, lineterminator="\n").writerows(table)
for line in table:
    print("| " + " | ".join(str(entry) for entry in line) + " |")
    if line is table[0]:
        print("|" + " --- |" * len(line))
END_OF_TABLE
