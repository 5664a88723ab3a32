#!/bin/sh
# Residual velocities of ogive_6061.yaml: four impact velocities at two cell sizes, with and without friction.
#
#   sh bench/studies/ogive.sh [BRUNT [CELL...]]      default build/brunt, cells 0.8 and 0.5 [mm]
#
# Writes ogive.csv (beside this file) and prints it as a table. Two runs at a time, one thread each; some ten minutes. A run that is
# not finished is a row that says so; finished ones (in $OUT, default out/ogive) are kept.
set -u
cd "$(dirname "$0")/../.."
brunt=${1:-build/brunt}
[ $# -gt 0 ] && shift
cells=${*:-0.8 0.5}
out=${OUT:-out/ogive}
[ -x "$brunt" ] || { echo "no program $brunt" >&2; exit 64; }
mkdir -p "$out"
# impact and residual velocity as measured [m/s], and when the rod has left [us]
measured="396:217:500 575:455:280 730:655:210 863:797:180"
frictions="0 0.02"

run() { # CELL VELOCITY END FRICTION
    dir=$out/$1_$2_$4
    grep -q '"status": *"done"' "$dir/summary.json" 2>/dev/null && return
    "$brunt" run bench/scenes/ogive_6061.yaml --fresh -q -t 1 -o "$dir" --set "grid.cell=$1 mm" --set "contact.friction=$4" \
        --set "bodies.rod.velocity=[0, -$2]" --set "time.end=$3 us" --set output.every=none \
        --set "measures.force_at_the_end.from=$(($3 - 20)) us" >/dev/null 2>&1
}
for cell in $cells; do
    for row in $measured; do
        for friction in $frictions; do # two: one on each core
            run "$cell" "${row%%:*}" "${row##*:}" "$friction" &
        done
        wait
    done
done

csv=bench/studies/ogive.csv
python3 - "$out" "$csv" "$cells" "$frictions" $measured <<'TABLE'
import json, sys
from math import nan, sqrt
out, csv, cells, frictions, *measured = sys.argv[1:]
head = ["cell [mm]", "friction", "impact [m/s]", "measured [m/s]", "residual [m/s]", "limit by energy [m/s]", "plastic", "friction work",
        "contact", "transfer", "energy error", "steps", "wall [s]", "status"]
rows = []
for cell in cells.split():
    for friction in frictions.split():
        for row in measured:
            impact, residual, _ = row.split(":")
            try:
                s = json.load(open(f"{out}/{cell}_{impact}_{friction}/summary.json"))
                m, e = s["measures"], s["energy"]
                v = m["residual_velocity"]["value"]
                rows.append([cell, friction, impact, residual, f"{v:.1f}", f"{sqrt(max(0, float(impact)**2 - v * v)):.0f}"]
                            + [f"{e[k] / e['initial']:.4f}" for k in ("plastic", "friction", "contact", "transfer")]
                            + [f"{m['energy_error']['value']:.1e}", s["steps"], f"{s['wall_s']:.0f}", s["status"]])
            except (OSError, KeyError, ValueError, TypeError):
                rows.append([cell, friction, impact, residual] + ["nan"] * 9 + ["not finished"])
with open(csv, "w") as f:
    for row in [head] + rows:
        f.write(",".join(str(x) for x in row) + "\n")
for row in [head, ["---"] * len(head)] + rows:
    print("| " + " | ".join(str(x) for x in row) + " |")
TABLE
