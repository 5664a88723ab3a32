#!/bin/sh
# Runs the scenes anew and puts their figures into bench/scenes/figures.csv and all documents that quote them.
#
#   sh bench/figures.sh [RUN...]      default: all of bench/scenes/runs.txt, half an hour of one core
#
# Says what moved by more than the runs' own digits; `git diff` shows where. Exit code 1 when a measure is not what it should be.
set -u
cd "$(dirname "$0")/.." || exit 74
sh cmake/install.sh build test || exit
cores=$(getconf _NPROCESSORS_ONLN)
cmake -S . -B build -DCMAKE_BUILD_TYPE=Release >/dev/null && cmake --build build -j "$cores" --target brunt_program >/dev/null || exit
before=$(mktemp)
cp bench/scenes/figures.csv "$before"
code=0
python3 bench/figures.py run -j "$cores" "$@" || code=1
python3 bench/figures.py write "$@" || code=1
python3 bench/figures.py compare "$before" bench/scenes/figures.csv
rm -f "$before"
exit "$code"
