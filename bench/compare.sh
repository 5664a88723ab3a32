#!/bin/sh
# Compares two files of a machine (bench/machines/README.md): ratios new / old, figure by figure.
#
#   sh bench/compare.sh OLD.csv NEW.csv [PERCENT]
#
# First what differs in their descriptions, then the geometric mean of the ratios by kind, then the ten figures that got worse
# and better the most, then all. Marked: `worse` or `better` by more than PERCENT (default 15) in the median AND the least; `noise`
# where only one of them is, since other work on the machine moves medians first. More is better for GB/s and GFLOP/s.
# Exit codes: 0, 64 bad usage, 65 no figure is in both.
set -eu
[ $# -ge 2 ] && [ $# -le 3 ] || { sed -n '2,/^set -eu/p' "$0" | sed -n 's/^# \{0,1\}//p' >&2; exit 64; }
for file in "$1" "$2"; do
    [ -r "$file" ] || { echo "compare.sh: $file cannot be read" >&2; exit 74; }
done
table=$(mktemp)
trap 'rm -f "$table"' EXIT

echo "old: $1"
echo "new: $2"
# One line a figure in both: cost ratio of the median (above 1: worse), ratio of the least, mark, what it is.
awk -F, -v percent="${3:-15}" -v table="$table" '
    function mark(a, b, most) {
        most = 1 + percent / 100
        if (a > most && b > most) return "worse"
        if (a < 1 / most && b < 1 / most) return "better"
        return a > most || b > most || a < 1 / most || b < 1 / most ? "noise" : "-"
    }
    { sub(/\r$/, "") }
    /^#/ {
        key = $0; sub(/:.*/, "", key); sub(/^# */, "", key)
        value = $0; sub(/^[^:]*: */, "", value)
        if (FILENAME == ARGV[1]) was[key] = value
        else if (was[key] != value) print key ": " was[key] " -> " value
        next
    }
    $1 == "kind" || NF != 9 || $5 ~ /^busy / { next }
    { what = $1 "," $2 "," $3 "," $4 "," $5 }
    FILENAME == ARGV[1] { median[what] = $7; least[what] = $8; olds++; next }
    { news++ }
    what in median && median[what] > 0 && least[what] > 0 && $7 > 0 && $8 > 0 {
        a = $7 / median[what]; b = $8 / least[what]
        if ($6 ~ /^G/) { a = 1 / a; b = 1 / b } # rates
        printf "%.4f,%.4f,%s,%s,%s,%s,%.6g,%.6g\n", a, b, mark(a, b), what, $6, $9, median[what], $7 > table
        if ($6 ~ /^(ns|s$|G)/) { sum[$1] += log(a); low[$1] += log(b); count[$1]++ }
        both++
    }
    END {
        printf "figures: %d old, %d new, %d in both\n\n", olds, news, both
        printf "%-12s %8s %8s %8s   cost new / old, geometric mean\n", "kind", "figures", "median", "least"
        for (kind in count)
            printf "%-12s %8d %8.3f %8.3f\n", kind, count[kind], exp(sum[kind] / count[kind]), exp(low[kind] / count[kind]) | "sort"
        close("sort")
    }' "$1" "$2"
[ -s "$table" ] || { echo "compare.sh: no figure is in both files" >&2; exit 65; }

show() {
    awk -F, '{ printf "%8s %8s  %-7s %-10s %-32s %9s %2s thread%s  %-14s %12s -> %12s %s\n", $1, $2, $3, $4, $5, $6, $7,
               ($7 == 1 ? " " : "s"), $8, $11, $12, $9 }'
}
head="  median    least  mark    what (cost new / old)"
printf '\nworst\n%s\n' "$head"
sort -t, -k1,1gr "$table" | head -n 10 | show
printf '\nbest\n%s\n' "$head"
sort -t, -k1,1g "$table" | head -n 10 | show
printf '\n%d worse, %d better, %d noise of %d\n' "$(grep -c ',worse,' "$table" || true)" "$(grep -c ',better,' "$table" || true)" \
    "$(grep -c ',noise,' "$table" || true)" "$(wc -l <"$table")"
printf '\nall figures\n%s\n' "$head"
show <"$table"
