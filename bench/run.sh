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
cmake --build build -j "$(getconf _NPROCESSORS_ONLN)" --target bench_passes bench_materials bench_elements contact_study >/dev/null
mkdir -p bench/results
quick=
edge=1
for option in "$@"; do
    [ "$option" != --quick ] || { quick=--quick edge=4; }
done
build/bench/bench_materials $quick -o bench/results/materials.csv
build/bench/bench_passes "$@" -o bench/results/passes.csv
build/bench/bench_elements $quick
for threads in 1 2; do
    build/bench/contact_study slide h=$edge samples=60 threads=$threads
done
