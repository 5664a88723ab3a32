#!/bin/sh
# Runs what compares numbers of threads under the thread sanitizer: a build of the preset tsan in the folder named as argument,
# with the targets below. It ends at a race, with the two places.
#
#   sh tests/support/races.sh BUILD
set -eu
cd "$(dirname "$0")/../.."
build=${1:?"usage: sh tests/support/races.sh BUILD"}

# libomp is not built with the sanitizer; its tool Archer says what waits for what.
OMP_TOOL_LIBRARIES=$(sed -n 's/^BRUNT_ARCHER:FILEPATH=//p' "$build/CMakeCache.txt")
TSAN_OPTIONS="ignore_noninstrumented_modules=1 halt_on_error=1"
BRUNT_SOURCE=$PWD CK_DEFAULT_TIMEOUT=0 OMP_WAIT_POLICY=passive
export OMP_TOOL_LIBRARIES TSAN_OPTIONS BRUNT_SOURCE CK_DEFAULT_TIMEOUT OMP_WAIT_POLICY

# race SUITE CASE: the case must be there.
race() {
    report=$(CK_RUN_CASE=$2 "$build/tests/$1" 2>&1) || { echo "$report"; exit 1; }
    case $report in
    *"Checks: 0"*) echo "$1 has no case $2"; exit 1 ;;
    esac
}
race test_determinism bits
race test_surfaces same_bits_for_threads_and_restart
race test_erosion_contact same_bits
race test_writer writer
# No threads, but what GCC and others round each in their way: this is the one optimised build of another compiler.
race test_node_lanes together
