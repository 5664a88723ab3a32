#!/bin/sh
# Runs the tests, on a machine that may have nothing but a shell and this folder.
#
#   sh tests/run.sh         all but the long ones; then unit and io once more under the sanitizers
#   sh tests/run.sh long    the long ones
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
empty=0
jobs=$(getconf _NPROCESSORS_ONLN)

finish() {
    echo "$passed passed, $failed failed"
    [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ] && [ "$empty" -eq 0 ] && [ "${1:-0}" -eq 0 ]
    exit
}

# build FOLDER CMAKE_OPTION...
build() {
    folder=$1
    shift
    if ! cmake -S . -B "$folder" "$@" >"$folder.log" 2>&1 || ! cmake --build "$folder" -j "$jobs" >>"$folder.log" 2>&1; then
        cat "$folder.log"
        echo "The build in $folder failed." >&2
        finish 1
    fi
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
        empty=1
    fi
}

sh cmake/install.sh build test || finish 1
build build -DCMAKE_BUILD_TYPE=Release
if [ "$label" = long ]; then
    run build -L long
else
    run build -LE long
    build build-asan -DCMAKE_BUILD_TYPE=RelWithDebInfo -DBRUNT_SANITIZE=ON -DBRUNT_BENCH=OFF
    run build-asan -L '^(unit|io)$' -LE long
fi
finish 0
