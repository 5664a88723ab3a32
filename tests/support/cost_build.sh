#!/bin/sh
# Builds cost_scene against the engine in FOLDER, for cost.sh and timers.sh: cost_build.sh FOLDER, run from the top of the tree.
#
# COST_SCENE: another tree's cost_scene.c, to count both engines alike. Valgrind does not know every instruction of every machine: the engine is built for any.
set -eu
folder=$1
cmake -S . -B "$folder/engine" -DBRUNT_NATIVE=OFF -DBRUNT_TESTS=OFF -DBRUNT_BENCH=OFF >"$folder/log" 2>&1 &&
    cmake --build "$folder/engine" --target brunt_library >>"$folder/log" 2>&1 &&
    ${CC:-cc} -std=gnu17 -O2 -Wall -Wextra -Werror -Iengine/include -o "$folder/cost_scene" "${COST_SCENE:-tests/support/cost_scene.c}" "$folder/engine/libbrunt.a" \
        -fopenmp -ldmumps_seq -lmetis -ldl -lm >>"$folder/log" 2>&1 || {
    cat "$folder/log" >&2
    exit 1
}
