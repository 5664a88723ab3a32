#!/bin/sh
# Counts the instructions of a step in scenes that differ by an effect: cost.sh FOLDER, run from the top of the tree.
#
# One line for each dress of cost_scene.c: its name and its instructions per step. The steps' own cost is the difference of
# two runs of different length. Valgrind does not know every instruction of every machine: the engine is built for any.
set -eu
folder=$1
cmake -S . -B "$folder/engine" -DBRUNT_NATIVE=OFF -DBRUNT_TESTS=OFF -DBRUNT_BENCH=OFF >"$folder/log" 2>&1 &&
    cmake --build "$folder/engine" --target brunt_library >>"$folder/log" 2>&1 &&
    ${CC:-cc} -std=gnu17 -O2 -Wall -Wextra -Werror -Iengine -o "$folder/cost_scene" tests/cost_scene.c "$folder/engine/libbrunt.a" \
        -fopenmp -lm >>"$folder/log" 2>&1 || {
    cat "$folder/log" >&2
    exit 1
}

count() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$folder/cost_scene" "$1" "$2" 2>"$folder/log" || {
        cat "$folder/log" >&2
        exit 1
    }
    sed -n 's/.*Collected : *//p' "$folder/log"
}

for dress in plain contact options gravity plastic wall two met; do
    short=$(count $dress 4)
    long=$(count $dress 24)
    echo "$dress $(((long - short) / 20))"
done
