#!/bin/sh
# Depth of rod_on_plate.yaml over impact velocity, at two cell sizes, beside hydrodynamic theory and Tate and Alekseevskii's.
#
#   sh bench/studies/rod.sh [BRUNT [CELL...]]      default build/brunt, cells 0.5 and 0.35 [mm]
#
# Writes rod.csv beside this file and prints it as a table. One thread a run, some ten minutes. Finished runs (in $OUT, default
# out/rod) are kept; one that is not finished is a row that says so.
#
# Tate (J. Mech. Phys. Solids 15 (1967) 387): rod and target flow where Y_p + rho_p (v - u)^2 / 2 = R_t + rho_t u^2 / 2, the rod behind
# is slowed by Y_p. Y_p is the rod's flow stress, R_t = 2/3 Y (1 + ln(2 E / 3 Y)) the pressure that opens a spherical cavity in
# the target, of Johnson and Cook's strengths: `static` at the onset of flow, `dynamic` at a strain of 0.3 and 1e5 / s; cold.
set -u
cd "$(dirname "$0")/../.."
brunt=${1:-build/brunt}
[ $# -gt 0 ] && shift
cells=${*:-0.5 0.35}
out=${OUT:-out/rod}
velocities="1500 2000 2500 3500"
[ -x "$brunt" ] || { echo "no program $brunt" >&2; exit 64; }
mkdir -p "$out"

for cell in $cells; do
    for v in $velocities; do
        dir=$out/${cell}_$v
        grep -q '"status": *"done"' "$dir/summary.json" 2>/dev/null && continue
        end=$((180000 / v)) # us; the rod is used up in some 85 to 110 mm / v
        [ "$v" -eq 2500 ] && every="10 us" || every=none
        "$brunt" run bench/scenes/rod_on_plate.yaml --fresh -q -t 1 -o "$dir" --set "grid.cell=$cell mm" --set "bodies.rod.velocity=[0, -$v]" \
            --set "time.end=$end us" --set "output.every=$every" >/dev/null 2>&1
    done
done

python3 - "$out" "$velocities" "$cells" <<'END_OF_TABLE'
import csv, json, math, sys

out, velocities, cells = sys.argv[1], sys.argv[2].split(), sys.argv[3].split()
rho_p, rho_t, length = 17000.0, 7830.0, 0.05
E, dynamic_rate = 200e9, math.log(1e5)


def resistance(Y):
    return 2 / 3 * Y * (1 + math.log(2 * E / (3 * Y)))


STRENGTH = {"static": (1506e6, resistance(792e6)),
            "dynamic": ((1506e6 + 177e6 * 0.3 ** 0.12) * (1 + 0.016 * dynamic_rate),
                        resistance((792e6 + 510e6 * 0.3 ** 0.26) * (1 + 0.014 * dynamic_rate)))}


def front(v, Y, R):
    """Speed of the bottom of the hole, from the balance of pressures; 0 where the rod does not flow."""
    a, b, c = rho_p - rho_t, -2 * rho_p * v, rho_p * v * v + 2 * (Y - R)
    return max(0.0, 2 * c / (-b + math.sqrt(b * b - 4 * a * c))) if c > 0 else 0.0


def tate(v, Y, R):
    L, depth, first, dt = length, 0.0, front(v, Y, R), 1e-8
    while L > 1e-4 * length:
        u = front(v, Y, R)
        if u == 0.0:
            break
        L, v, depth = L - dt * (v - u), v - dt * Y / (rho_p * L), depth + dt * u
    return first, depth / length


def measured(folder):
    """Speed between two and six diameters of depth, depth over length, status, energy error, steps, cpu time."""
    try:
        summary = json.load(open(folder + "/summary.json"))
        rows = csv.reader(open(folder + "/history.csv"))
    except OSError:
        return None
    head = [name.split()[0] for name in next(rows)]
    t, y = head.index("time"), head.index("body.rod.low_y")
    path = [(float(r[t]), -float(r[y])) for r in rows]
    at = [next((a for a, d in path if d > limit), math.nan) for limit in (0.01, 0.03)]
    deepest = max(d for _, d in path)
    half = next(d for a, d in path if a >= 0.8 * path[-1][0])
    return (0.02 / (at[1] - at[0]), deepest / length, half / deepest, summary["status"], summary["measures"]["energy_error"]["value"],
            summary["steps"], summary["cpu_s"])


heads = ["cell [mm]", "impact [m/s]", "u [m/s]", "u hydrodynamic", "u Tate static", "u Tate dynamic", "P/L", "P/L hydrodynamic",
         "P/L Tate static", "P/L Tate dynamic", "share of depth at 0.8 of the time", "energy error", "steps", "cpu [s]", "status"]
table = [heads]
for cell in cells:
    for v in velocities:
        ideal = float(v) / (1 + math.sqrt(rho_t / rho_p))
        low, high = (tate(float(v), *STRENGTH[k]) for k in ("static", "dynamic"))
        m = measured(f"{out}/{cell}_{v}")
        u, P, late, status, error, steps, cpu = m or (math.nan, math.nan, math.nan, "not run", math.nan, 0, math.nan)
        table.append([cell, v, f"{u:.0f}", f"{ideal:.0f}", f"{low[0]:.0f}", f"{high[0]:.0f}", f"{P:.3f}", f"{math.sqrt(rho_p / rho_t):.3f}",
                      f"{low[1]:.3f}", f"{high[1]:.3f}", f"{late:.3f}", f"{error:.1e}", steps, f"{cpu:.0f}", status])
with open("bench/studies/rod.csv", "w") as file:
    csv.writer(file, lineterminator="\n").writerows(table)
for k, (Y, R) in STRENGTH.items():
    print(f"{k}: Y_p {Y / 1e9:.2f} GPa, R_t {R / 1e9:.2f} GPa")
for row in table:
    print("| " + " | ".join(str(cell) for cell in row) + " |")
    if row is heads:
        print("|" + " --- |" * len(row))
END_OF_TABLE
