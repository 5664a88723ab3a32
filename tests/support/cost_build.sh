#!/bin/sh
# Builds cost_scene for cost.sh and timers.sh, run from the top of the tree: cost_build.sh FOLDER puts it into FOLDER.
#
# Its engine stands beside the program that BRUNT names, in cost/, made once for all that count; a second call waits.
# engine/ is where brunt.h was before engine/include. COST_SCENE: another tree's cost_scene.c, to count both engines alike. Valgrind does not know every instruction of every machine: the engine is built for any.
set -eu
folder=$1
engine=${BRUNT%/*}/cost
mkdir -p "$engine"
exec 9>"$engine/lock"
flock 9
cmake -S . -B "$engine" -DBRUNT_NATIVE=OFF -DBRUNT_TESTS=OFF -DBRUNT_BENCH=OFF >"$folder/log" 2>&1 &&
    cmake --build "$engine" --target brunt_library -j "$(getconf _NPROCESSORS_ONLN)" >>"$folder/log" 2>&1 &&
    ${CC:-cc} -std=gnu17 -O2 -Wall -Wextra -Werror -Iengine/include -Iengine -o "$folder/cost_scene" "${COST_SCENE:-tests/support/cost_scene.c}" "$engine/libbrunt.a" \
        -fopenmp -ldmumps_seq -lmetis -ldl -lm >>"$folder/log" 2>&1 || {
    cat "$folder/log" >&2
    exit 1
}
