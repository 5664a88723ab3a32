#!/bin/sh
# Measures the kernels: bench/results/passes.csv, materials.csv, and the tables on the terminal.
#
#   sh bench/run.sh [OPTION...]      options of bench_passes, e.g. --quick, --only quadratic, --particles 250000
#
# About ten minutes, and 2 GB of memory. Other work on the machine shows as medians far above the least.
set -eu
cd "$(dirname "$0")/.."
sh cmake/install.sh build
cmake -S . -B build -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build build -j "$(getconf _NPROCESSORS_ONLN)" --target bench_passes bench_materials >/dev/null
mkdir -p bench/results
quick=
for option in "$@"; do
    [ "$option" != --quick ] || quick=--quick
done
build/bench/bench_materials $quick -o bench/results/materials.csv
build/bench/bench_passes "$@" -o bench/results/passes.csv
