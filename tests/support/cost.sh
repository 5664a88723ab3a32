#!/bin/sh
# Counts the instructions of a step in scenes that differ by an effect: cost.sh FOLDER, run from the top of the tree.
#
# One line for each dress of cost_scene.c: its name and its instructions per step.
set -eu
folder=$1
sh tests/support/cost_build.sh "$folder"

for dress in plain contact options gravity plastic wall two met apart far erode floor_hard floor_spring wall_spring \
    hex8 hex8_wall hex8_apart hex8_far hex8_far_lossy hex8_met hex8_met_lossy hex8_mixed hex8_mixed_far hex8_erode hex8_soft hex8_viscous hex8_inviscid; do
    echo "$dress $(sh tests/support/cost_count.sh "$folder" $dress)"
done
