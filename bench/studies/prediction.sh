#!/bin/sh
# What `brunt check` predicts against what runs take: time and memory of all scenes, on one thread.
#
#   sh bench/studies/prediction.sh [BRUNT] [SCENE.yaml...]      default build/brunt, bench/scenes/*.yaml
#
# Writes prediction.csv and prediction.png (gnuplot) beside this file and says how many are within a factor of 1.5. Nothing else should
# run. Some 40 minutes in all; finished runs (in $OUT, default out/prediction) are kept, LIMIT (default 1200) seconds are the most for one:
# a run beyond that, or one that fails, is in the table without measured figures and is not counted.
set -eu
cd "$(dirname "$0")/../.."
brunt=${1:-build/brunt}
[ $# -eq 0 ] || shift
[ -x "$brunt" ] || { echo "no program $brunt" >&2; exit 64; }
[ $# -gt 0 ] || set -- bench/scenes/*.yaml
out=${OUT:-out/prediction} limit=${LIMIT:-1200} csv=bench/studies/prediction.csv
mkdir -p "$out"

for scene; do
    name=$(basename "$scene" .yaml)
    [ -s "$out/$name.check" ] || "$brunt" check "$scene" -t 1 >"$out/$name.check" || { rm -f "$out/$name.check"; echo "$name: check failed" >&2; continue; }
    [ -s "$out/$name.json" ] && continue
    if timeout "$limit" "$brunt" run "$scene" -t 1 -q -o "$out/$name" >/dev/null; then
        cp "$out/$name/summary.json" "$out/$name.json"
    else
        echo "$name: not finished within $limit s, or failed" >&2
    fi
    rm -rf "${out:?}/$name"
done

/usr/bin/python3 - "$out" "$csv" "$@" <<'END_OF_TABLE'
import csv, json, os, re, sys

out, table, scenes = sys.argv[1], sys.argv[2], sys.argv[3:]
UNIT = {"B": 1, "kB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12}
HEAD = ["scene", "steps_predicted", "steps_measured", "step_predicted_s", "step_measured_s", "output_predicted_s", "output_measured_s",
        "predicted_s", "measured_s", "ratio", "cpu_s", "peak_predicted_MB", "peak_measured_MB", "peak_ratio", "factor", "check_s"]


def row_of(scene):
    name = os.path.basename(scene)[:-len(".yaml")]
    try:
        text = open(f"{out}/{name}.check").read()
    except OSError:
        return None
    steps = float(re.search(r"about (\d+) steps", text)[1])
    step, output = map(float, re.search(r"^  steps (\S+) s \(.*\+ output (\S+) s = ", text, re.M).groups())
    peak = re.search(r"peak about (\S+) (\w+)", text)
    peak = float(peak[1]) * UNIT[peak[2]] / 1e6
    seen = re.search(r"rehearsed (\S+) times coarser in (\S+) s", text)
    whole = re.search(r"rehearsed as it is, without output, in (\S+) s", text)
    factor, took = seen.groups() if seen else ("1", whole[1]) if whole else ("", "")
    row = dict(zip(HEAD, [name, steps, "", step, "", output, "", step + output, "", "", "", peak, "", "", factor, took]))
    try:
        s = json.load(open(f"{out}/{name}.json"))
    except OSError:
        return row
    measured = s["step_s"] + s["phases"]["output"]
    row.update(steps_measured=s["steps"], step_measured_s=s["step_s"], output_measured_s=s["phases"]["output"], measured_s=measured,
               ratio=(step + output) / measured, cpu_s=s["cpu_s"], peak_measured_MB=s["peak_rss_bytes"] / 1e6,
               peak_ratio=peak / (s["peak_rss_bytes"] / 1e6))
    return row


rows = [r for r in map(row_of, scenes) if r]
with open(table, "w", newline="") as file:
    writer = csv.DictWriter(file, HEAD, lineterminator="\n")
    writer.writeheader()
    for r in rows:
        writer.writerow({k: f"{v:.4g}" if isinstance(v, float) else v for k, v in r.items()})
known = [r for r in rows if r["ratio"] != ""]
for what, key in (("time", "ratio"), ("memory", "peak_ratio")):
    near = [r for r in known if 1 / 1.5 <= r[key] <= 1.5]
    print(f"{what}: {len(near)} of {len(known)} scenes are within a factor of 1.5" +
          "".join(f", {r['scene']} {r[key]:.2f}" for r in known if r not in near))
if len(known) < len(rows):
    print("not measured: " + ", ".join(r["scene"] for r in rows if r not in known))
END_OF_TABLE

command -v gnuplot >/dev/null || { echo "no gnuplot: prediction.png is not drawn" >&2; exit 0; }
# Okabe and Ito's colours; outliers are of another shape as well, and named.
gnuplot <<END_OF_PLOT
set terminal pngcairo noenhanced size 1500, 760 font 'sans,11'
set output 'bench/studies/prediction.png'
set datafile separator ','
set multiplot layout 1, 2
set logscale xy
set key top left reverse Left
set style fill solid 0.25 noborder
set format xy '%g'
near(p, m) = p / m <= 1.5 && p / m >= 1 / 1.5
set title 'Time, one thread'
set xlabel 'measured [s]'
set ylabel 'predicted [s]'
set xrange [0.05:2000]
set yrange [0.05:2000]
plot '+' using 1:(\$1 / 1.5):(\$1 * 1.5) with filledcurves lc rgb '#56B4E9' title 'factor of 1.5', x with lines lc rgb 'black' notitle, \\
    '$csv' every ::1 using (strlen(strcol(9)) && near(column(8), column(9)) ? column(9) : NaN):8 with points pt 7 lc rgb '#0072B2' title 'scenes', \\
    '' every ::1 using (strlen(strcol(9)) && !near(column(8), column(9)) ? column(9) : NaN):8 with points pt 9 ps 1.5 lc rgb '#D55E00' title 'outside', \\
    '' every ::1 using (strlen(strcol(9)) && !near(column(8), column(9)) ? column(9) : NaN):8:1 with labels noenhanced offset 1, -0.7 left notitle
set title 'Memory'
set xlabel 'measured peak [MB]'
set ylabel 'predicted peak [MB]'
set xrange [10:1000]
set yrange [10:1000]
plot '+' using 1:(\$1 / 1.5):(\$1 * 1.5) with filledcurves lc rgb '#56B4E9' title 'factor of 1.5', x with lines lc rgb 'black' notitle, \\
    '$csv' every ::1 using (strlen(strcol(13)) && near(column(12), column(13)) ? column(13) : NaN):12 with points pt 7 lc rgb '#0072B2' title 'scenes', \\
    '' every ::1 using (strlen(strcol(13)) && !near(column(12), column(13)) ? column(13) : NaN):12 with points pt 9 ps 1.5 lc rgb '#D55E00' title 'outside', \\
    '' every ::1 using (strlen(strcol(13)) && !near(column(12), column(13)) ? column(13) : NaN):12:1 with labels noenhanced offset 1, -0.7 left notitle
END_OF_PLOT
