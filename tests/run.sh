#!/bin/sh
# Runs the tests, on a machine that may have nothing but a shell and this folder.
#
#   sh tests/run.sh         all but the long ones; unit, io and what loses particles and elements once more under the
#                           sanitizers; unit and some more in single precision; the kernels without vectors; the other
#                           compiler; the installed library; the benchmarks run at all; sources are formatted, and pass
#                           the checks of .clang-tidy
#   sh tests/run.sh long    the long ones; no races where numbers of threads are compared (thread sanitizer)
#
# The last line is "N passed, N failed". Exit code 0 only when tests ran and none failed.
set -u
cd "$(dirname "$0")/.." || exit 1

case ${1:-} in
'') label=short ;;
long) label=long ;;
*)
    echo "usage: sh tests/run.sh [long]" >&2
    exit 64
    ;;
esac

passed=0
failed=0
broken=0
jobs=$(getconf _NPROCESSORS_ONLN)

finish() {
    echo "$passed passed, $failed failed"
    [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ] && [ "$broken" -eq 0 ]
    exit
}

# check NAME COMMAND...: one test that is a command.
check() {
    name=$1
    shift
    began=$(date +%s)
    "$@"
    code=$?
    if [ "$code" -eq 77 ]; then
        echo "$name: cannot be checked here"
    elif [ "$code" -eq 0 ]; then
        passed=$((passed + 1))
        echo "$name: passed, $(($(date +%s) - began)) s"
    else
        failed=$((failed + 1))
        echo "$name: FAILED"
        return 1
    fi
}

# build PRESET [CMAKE_OPTION...]: shows the compiler's words only when it fails.
build() {
    preset=$1
    shift
    log=$(mktemp)
    cmake --preset "$preset" -DBRUNT_WERROR=ON >"$log" 2>&1 && cmake --build --preset "$preset" -j "$jobs" "$@" >>"$log" 2>&1
    code=$?
    [ "$code" -eq 0 ] || cat "$log"
    rm -f "$log"
    return "$code"
}

# run FOLDER CTEST_OPTION...: adds what ctest counted. A test that could not be started counts as failed, one that said
# it cannot run here as neither.
run() {
    folder=$1
    shift
    report=$PWD/$folder/report.xml
    rm -f "$report"
    ctest --test-dir "$folder" --output-on-failure -j "$jobs" --output-junit "$report" "$@"
    code=$?
    touch "$report"
    good=$(grep -c '<testcase .*status="run"' "$report")
    bad=$(grep -c '<testcase .*status="fail"' "$report")
    bad=$((bad + $(grep '<skipped message=' "$report" | grep -vc 'message="SKIP_')))
    [ "$code" -eq 0 ] || [ "$bad" -gt 0 ] || bad=1
    passed=$((passed + good))
    failed=$((failed + bad))
    if [ $((good + bad)) -eq 0 ]; then
        echo "No test ran in $folder." >&2
        broken=1
    fi
}

sh cmake/install.sh build test || {
    broken=1
    finish
}
check "build" build release || finish
if [ "$label" = long ]; then
    run build -L long
    if command -v clang >/dev/null; then
        check "build under the thread sanitizer" build tsan --target test_determinism test_surfaces test_erosion_contact test_writer \
            test_node_lanes &&
            check "races" sh tests/support/races.sh build-tsan
    fi
    finish
fi
rm -rf build/hard_cases && mkdir build/hard_cases
BRUNT_HARD_CASES=$PWD/build/hard_cases run build -LE long
# What takes one core each, the one list beside the other; what the first says is told when both have ended.
said=$(mktemp)
tally=$(mktemp)
(
    before="$passed $failed"
    check "structure of the sources" python3 tests/structure.py check
    check "what one more thing costs" python3 tests/adding.py check
    check "list of mistakes" python3 tests/mutations.py check
    check "format" sh tests/support/static.sh format
    check "page of hard cases" python3 tests/hard_cases.py check build/hard_cases
    check "installed library" sh tests/support/install.sh build
    check "whole benchmark" sh bench/run.sh --quick
    check "study of contact" build/bench/contact_study cubes h=1
    echo "$before $passed $failed" | awk '{ print $3 - $1, $4 - $2 }' >"$tally"
) >"$said" 2>&1 &
check "one more of each thing" python3 tests/adding.py run
check "static checks" sh tests/support/static.sh tidy build
wait $!
cat "$said"
read -r good bad <"$tally" || { good=0; bad=1; }
passed=$((passed + good))
failed=$((failed + bad))
rm -f "$said" "$tally"
# among "SUITE...": the name of each suite, as ctest takes it.
among() { echo "^($(echo "$1" | tr ' ' '|'))\$"; }

some="test_axisymmetric_bodies test_point_erosion test_tied test_total_lagrangian"
# shellcheck disable=SC2086
check "build in single precision" build float --target brunt_program tests_unit $some && run build-float -L '^unit$' -LE long &&
    run build-float -R "$(among "$some")"
kernels="test_lanes test_materials test_elements test_axisymmetric_elements test_brittle test_explosives test_failure"
# shellcheck disable=SC2086
check "build without vectors" build scalar --target $kernels &&
    run build-scalar -R "$(among "$kernels")"
some="test_contact_sides test_erosion_contact test_point_erosion test_total_lagrangian"
# Not what does one thing a thousand times, and others do once.
# shellcheck disable=SC2086
check "build under the sanitizers" build asan --target brunt_program tests_unit tests_io $some &&
    run build-asan -L '^(unit|io)$' -LE long -E "$(among "test_numbers test_predict test_fluids")" && run build-asan -R "$(among "$some")"
if command -v clang >/dev/null; then
    check "build with clang" build clang --target brunt_program tests_unit
fi
finish
