#!/bin/sh
# Counts the instructions of a step and of its timers: timers.sh FOLDER, run from the top of the tree.
#
# One line for each dress of cost_scene.c: its name, its instructions per step, of these in the functions that keep the time, and
# how often a step reads the clock. Valgrind does not see what a reading does in the kernel's page (some 60 instructions).
# brunt_parallel counts whole, although it does more than keeping time.
set -eu
folder=$1
sh tests/support/cost_build.sh "$folder"

# All instructions, those of the timers, readings of the clock: of $2 steps in the dress $1.
count() {
    out="$folder/callgrind.out"
    valgrind --tool=callgrind --instr-atstart=no --compress-strings=no --compress-pos=no --callgrind-out-file="$out" "$folder/cost_scene" "$1" "$2" \
        2>"$folder/log" || {
        cat "$folder/log" >&2
        exit 1
    }
    awk '/^fn=/ { own = /^fn=(brunt_clock|brunt_pass_begin|brunt_pass_end|brunt_step_begin|brunt_step_end|brunt_parallel|book|tell_.*|.*clock_gettime.*)$/ }
         /^cfn=/ { clock = /clock_gettime/ }
         /^calls=/ { if (clock) { split($1, n, "="); readings += n[2] } skip = 1; next }
         /^[0-9+*-]/ { if (skip) skip = 0; else { all += $2; if (own) timers += $2 } }
         END { print all + 0, timers + 0, readings + 0 }' "$out"
}

for dress in plain hex8 few; do
    echo "$dress $(count $dress 20)" | awk '{ print $1, $2 / 20, $3 / 20, $4 / 20 }'
done
