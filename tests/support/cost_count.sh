#!/bin/sh
# Instructions of a step of cost_scene, by valgrind: cost_count.sh FOLDER DRESS, after cost_build.sh FOLDER.
set -eu
steps=20
valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file=/dev/null "$1/cost_scene" "$2" $steps 2>"$1/log" || {
    cat "$1/log" >&2
    exit 1
}
echo "$(($(sed -n 's/.*Collected : *//p' "$1/log") / steps))"
