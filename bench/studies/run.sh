#!/bin/sh
# Runs the studies and keeps what they say: report, table and pictures of each go to bench/studies/NAME/.
#
#   sh bench/studies/run.sh [NAME...]      default: all of bench/studies/*.yaml
#
# Single runs, scripts for gnuplot and SVG stay in out/study/NAME. One thread, three runs of every case: two quiet minutes a study.
# Exit codes as those of brunt: 64 bad usage, 70 a study failed, 74 file system.
set -eu
cd "$(dirname "$0")/../.."
if [ $# -eq 0 ]; then
    for study in bench/studies/*.yaml; do set -- "$@" "$(basename "$study" .yaml)"; done
fi
for name in "$@"; do
    [ -f "bench/studies/$name.yaml" ] && continue
    echo "run.sh: there is no bench/studies/$name.yaml" >&2
    exit 64
done

sh cmake/install.sh build
cores=$(getconf _NPROCESSORS_ONLN)
cmake -S . -B build -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build build -j "$cores" --target brunt_program >/dev/null
for name in "$@"; do # programs that a study names besides this one: of presets
    if grep -q 'program: .*build-float/' "bench/studies/$name.yaml"; then
        cmake --preset float >/dev/null
        cmake --build build-float -j "$cores" --target brunt_program >/dev/null
        break
    fi
done

failed=
for name in "$@"; do
    echo "== $name"
    from=out/study/$name
    to=bench/studies/$name
    code=0
    build/brunt study "bench/studies/$name.yaml" -o "$from" --fresh || code=$?
    case $code in
    0) ;;
    70) failed="$failed $name"; continue ;;
    *) exit "$code" ;;
    esac
    mkdir -p "$to"
    rm -f "$to"/*.png
    for file in "$from"/report.md "$from"/study.csv "$from"/*.png; do
        [ ! -f "$file" ] || cp "$file" "$to/" || exit 74
    done
done
[ -z "$failed" ] || { echo "run.sh: failed:$failed" >&2; exit 70; }
