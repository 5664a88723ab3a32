#!/bin/sh
# Counts the instructions of a step in scenes that differ by an effect: cost.sh FOLDER, run from the top of the tree.
#
# One line for each dress of cost_scene.c: its name and its instructions per step. The steps' own cost is the difference of
# two runs of different length.
set -eu
folder=$1
sh tests/support/cost_build.sh "$folder"

count() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$folder/cost_scene" "$1" "$2" 2>"$folder/log" || {
        cat "$folder/log" >&2
        exit 1
    }
    sed -n 's/.*Collected : *//p' "$folder/log"
}

for dress in plain contact options gravity plastic wall two met apart far erode floor_hard floor_spring wall_spring \
    hex8 hex8_wall hex8_apart hex8_far hex8_far_lossy hex8_met hex8_met_lossy hex8_mixed hex8_mixed_far hex8_erode hex8_soft hex8_viscous hex8_inviscid; do
    short=$(count $dress 4)
    long=$(count $dress 24)
    echo "$dress $(((long - short) / 20))"
done
