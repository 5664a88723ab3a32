#!/bin/sh
# Residual velocities and ballistic limit of plate_weldox_blunt.yaml: the ten published impact velocities at three element sizes.
#
#   sh bench/studies/weldox.sh [BRUNT [SIZE...]]      default build/brunt, sizes 0.4 0.25 0.15 [mm]
#
# Writes weldox.csv, weldox.png (gnuplot) and, on the terminal, the tables of weldox.md, beside this file. The limit is halved in three
# more runs a size. Two runs at a time, one thread each: twenty minutes, most of them for 0.15 mm. Finished runs are kept, in $OUT
# (default out/weldox); a run that fails is a row that says so.
set -eu
cd "$(dirname "$0")/../.."
brunt=${1:-build/brunt}
[ $# -eq 0 ] || shift
[ -x "$brunt" ] || { echo "no program $brunt" >&2; exit 64; }
mkdir -p "${OUT:=out/weldox}"
[ $# -gt 0 ] || set -- 0.4 0.25 0.15
python3 - "$brunt" "$OUT" "$@" <<'END'
import json, os, subprocess, sys
from concurrent.futures import ThreadPoolExecutor

brunt, out, *sizes = sys.argv[1:]
sizes = list(dict.fromkeys(sizes))
# impact and residual velocity as measured [m/s] (Borvik et al. 2002); 0: stopped
measured = {399.6: 291.3, 303.5: 199.7, 285.4: 181.1, 244.2: 132.6, 224.7: 113.7, 200.4: 71.4, 189.6: 42.0, 184.8: 0, 184.3: 0, 181.5: 0}
STOPPED = 5.0  # [m/s] less than that is no perforation


def run(size, velocity):
    folder = f"{out}/{size}_{velocity:g}"
    path = folder + "/summary.json"
    if not os.path.exists(path) or json.load(open(path))["status"] != "done":
        subprocess.run([brunt, "run", "bench/scenes/plate_weldox_blunt.yaml", "--fresh", "-q", "-t", "1", "-o", folder,
                        "--set", f"bodies.plate.size={size} mm", "--set", f"bodies.projectile.velocity=[0, -{velocity:g}]",
                        "--set", "output.every=50 us", "--set", "time.end=400 us"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        return json.load(open(path))
    except OSError:
        return None


def residual(summary):
    return summary["measures"]["residual_velocity"]["value"] if summary and summary["status"] == "done" else float("nan")


def limit(size):
    low = max((v for v in measured if residual(run(size, v)) < STOPPED), default=float("nan"))
    high = min((v for v in measured if residual(run(size, v)) >= STOPPED), default=float("nan"))
    for _ in range(3):
        middle = round(0.5 * (low + high), 1)
        low, high = (low, middle) if residual(run(size, middle)) >= STOPPED else (middle, high)
    return low, high


with ThreadPoolExecutor(2) as pool:
    list(pool.map(lambda job: run(*job), [(s, v) for s in sizes for v in measured]))
    limits = dict(zip(sizes, pool.map(limit, sizes)))
with open("bench/studies/weldox.csv", "w") as csv:
    print("size [mm],impact [m/s],measured [m/s],residual [m/s],eroded elements,energy error,momentum drift,steps,cpu [s],status", file=csv)
    for size in sizes:
        for velocity, vr in measured.items():
            s = run(size, velocity)
            if not s:
                print(f"{size},{velocity:g},{vr:g},nan,nan,nan,nan,nan,nan,did not start", file=csv)
                continue
            m = s["measures"]
            print(f"{size},{velocity:g},{vr:g},{max(residual(s), 0):.1f},{s['eroded'].get('plate', {}).get('elements', 0)},"
                  f"{m['energy_error']['value']:.1e},{s['momentum']['linear_drift']:.0e},{s['steps']},{s['cpu_s']:.0f},{s['status']}", file=csv)
print("| impact | measured | " + " | ".join(f"{s} mm" for s in sizes) + " |")
for velocity, vr in measured.items():
    print(f"| {velocity:g} | {vr:g} | " + " | ".join(f"{max(residual(run(s, velocity)), 0):.1f}" for s in sizes) + " |")
for size in sizes:
    low, high = limits[size]
    print(f"ballistic limit at {size} mm: between {low:g} and {high:g} m/s")
with open(out + "/limits", "w") as f:
    for size in sizes:
        print(size, 0.5 * sum(limits[size]), file=f)
END
if command -v gnuplot >/dev/null; then
    gnuplot <<'END'
set terminal pngcairo size 900,620 font "sans,12"
set output "bench/studies/weldox.png"
set datafile separator ","
set xlabel "impact velocity [m/s]"
set ylabel "residual velocity [m/s]"
set key left top
set grid
set xrange [170:410]
set yrange [0:320]
a = 0.78; p = 2.3; limit = 184.5
curve(v) = v > limit ? a * (v**p - limit**p)**(1 / p) : 0
set samples 1000
plot curve(x) with lines lc rgb "black" title "measured: Recht and Ipson's form", \
  "bench/studies/weldox.csv" using ($1 == 0.4 ? $2 : 1/0):3 with points pt 7 ps 1.4 lc rgb "black" title "measured (Borvik et al. 2002)", \
  "" using ($1 == 0.4 ? $2 : 1/0):4 with linespoints pt 4 ps 1.3 lc rgb "#e69f00" title "0.4 mm", \
  "" using ($1 == 0.25 ? $2 : 1/0):4 with linespoints pt 6 ps 1.3 lc rgb "#56b4e9" title "0.25 mm", \
  "" using ($1 == 0.15 ? $2 : 1/0):4 with linespoints pt 8 ps 1.5 lc rgb "#d55e00" title "0.15 mm"
END
fi
