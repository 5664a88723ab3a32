#!/bin/sh
# Installs what is missing, builds, runs the headline impact and says what to open.
#
#   sh bench/demo.sh [SCENE]      default: bench/scenes/taylor_bar.yaml
set -eu
cd "$(dirname "$0")/.."

scene=${1:-bench/scenes/taylor_bar.yaml}
sh cmake/install.sh build
cmake -S . -B build
cmake --build build -j "$(getconf _NPROCESSORS_ONLN)" --target brunt_program
out=out/$(basename "$scene" .yaml)
build/brunt run "$scene" --fresh -o "$out"
echo
echo "Done. Open $PWD/$out/brunt.pvd in ParaView and press play."
