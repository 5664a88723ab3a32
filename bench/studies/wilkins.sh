#!/bin/sh
# The line of Wilkins and Guinan: ln((L1 - h) / (L0 - h)) over rho U^2 of taylor_bar_wilkins.yaml, and the flow stress read off it.
#
#   sh bench/studies/wilkins.sh [BRUNT]      default build/brunt
#
# Writes wilkins.csv, wilkins.png and, on the terminal, the table of wilkins.md (beside this file). Half a minute. The line is fitted by
# least squares for the h that fits it best, and for h = 0.12 L0.
set -eu
cd "$(dirname "$0")/../.."
brunt=${1:-build/brunt}
out=${OUT:-out/wilkins}
[ -x "$brunt" ] || { echo "no program $brunt" >&2; exit 64; }
mkdir -p "$out"
csv=bench/studies/wilkins.csv
echo "speed [m/s],rho U^2 [Pa],length [m],foot radius [m]" >$csv
for speed in 100 125 150 175 200 225 250 275 300; do
    "$brunt" run bench/scenes/taylor_bar_wilkins.yaml --fresh -q -o "$out/$speed" --set "bodies.rod.velocity=[0, -$speed]" --set "output.every=60 us" >/dev/null
    python3 - "$out/$speed/summary.json" "$speed" <<'END' >>$csv
import json, sys
m = json.load(open(sys.argv[1]))["measures"]
u = float(sys.argv[2])
print(f"{u:g},{7850 * u * u:.6g},{m['length']['value']:.6g},{m['foot_radius']['value']:.6g}")
END
done
python3 - $csv <<'END'
import csv, math, sys
rows = [list(map(float, r)) for r in list(csv.reader(open(sys.argv[1])))[1:]]
L0 = 25.4e-3

def fit(h):  # ln((L1 - h) / (L0 - h)) = a + b rho U^2
    x = [r[1] for r in rows]
    y = [math.log((r[2] - h) / (L0 - h)) for r in rows]
    n, mx, my = len(x), sum(x) / len(x), sum(y) / len(y)
    b = sum((p - mx) * (q - my) for p, q in zip(x, y)) / sum((p - mx) ** 2 for p in x)
    a = my - b * mx
    worst = max(abs(q - a - b * p) for p, q in zip(x, y))
    spread = sum((q - my) ** 2 for q in y)
    r2 = 1 - sum((q - a - b * p) ** 2 for p, q in zip(x, y)) / spread
    return a, b, worst, r2

for h in (0.0, 0.06, 0.12, 0.18):
    a, b, worst, r2 = fit(h * L0)
    print(f"h = {h:.2f} L0: flow stress {-1 / (2 * b) / 1e6:.0f} MPa, intercept {a:+.4f}, farthest from the line {worst:.4f}, R^2 {r2:.5f}")
END
cat $csv
