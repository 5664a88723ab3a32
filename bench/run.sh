#!/bin/sh
# Measures what this machine does with brunt: one CSV file, compared with the one stored in bench/machines, and pictures.
#
#   sh bench/run.sh [--quick] [--only KIND[,KIND...]] [--store] [--build FOLDER]
#
#   --quick         small sizes, a minute or less: to see that it works
#   --only KIND     roofline, particles, growth, elements, materials, contact, memory, scenes
#   --store         what was measured becomes the stored file of this machine; not with --quick or --only
#   --build FOLDER  where to build (default: build)
#
# About a quarter of an hour, and 3 GB of memory. Nothing else should run: other work shows as medians far above the least.
# Writes bench/results/NAME.csv (NAME: processor and cores), compare.txt and pictures beside it.
# Exit codes as those of brunt: 64 bad usage, 70 a benchmark failed, 74 file system.
set -eu
cd "$(dirname "$0")/.."

usage() {
    sed -n '2,/^set -eu/p' "$0" | sed -n 's/^# \{0,1\}//p' >&2
    exit 64
}
kinds=roofline,particles,growth,elements,materials,contact,memory,scenes
quick='' only='' store='' build=build
while [ $# -gt 0 ]; do
    case $1 in
    --quick) quick=--quick ;;
    --store) store=yes ;;
    --only | --build)
        [ $# -gt 1 ] || usage
        [ "$1" = --only ] && only=$2 || build=$2
        shift ;;
    *) usage ;;
    esac
    shift
done
[ -z "$store" ] || [ -z "$quick$only" ] || { echo "run.sh: --store wants all of it (no --quick, no --only)" >&2; exit 64; }
for kind in $(echo "$only" | tr , ' '); do
    case ,$kinds, in *",$kind,"*) ;; *) echo "run.sh: there is no kind '$kind', but $kinds" >&2; exit 64 ;; esac
done
wanted() {
    case ,${only:-$kinds}, in *",$1,"*) echo "== $1" ;; *) return 1 ;; esac
}

sh cmake/install.sh build
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$build" -j "$(getconf _NPROCESSORS_ONLN)" --target brunt_program bench_roofline bench_passes bench_elements \
    bench_materials bench_contact bench_memory bench_scenes contact_study >/dev/null
name=$("$build/bench/bench_roofline" --name)
mkdir -p bench/results
part=bench/results/$name.part
result=bench/results/$name.csv
stored=bench/machines/$name.csv
rm -f "$part"
trap 'rm -f "$part"' EXIT

# bench PROGRAM OPTION...
bench() {
    program=$1
    shift
    # shellcheck disable=SC2086
    "$build/bench/$program" "$@" $quick -o "$part" || exit 70
}
study() {
    "$build/bench/contact_study" "$@" rows="$part" || exit 70
}

began=$(date +%s)
! wanted roofline || bench bench_roofline
! wanted particles || bench bench_passes --particles 250000 --steps 8
! wanted growth || { bench bench_passes --growth --rounds 5 --steps 8 && bench bench_elements --growth --rounds 5; }
! wanted elements || bench bench_elements
! wanted materials || bench bench_materials
if wanted contact; then
    for threads in 1 2; do
        for sweeps in 4 16; do
            study slide h="$([ "$quick" ] && echo 5 || echo 1)" n=$sweeps samples=30 rounds=5 threads=$threads
        done
        study slide h="$([ "$quick" ] && echo 5 || echo 1)" n=16 slave=2 samples=30 rounds=5 threads=$threads
        study slide h="$([ "$quick" ] && echo 5 || echo 1)" n=16 touch=elastic samples=30 rounds=5 threads=$threads
        for crowd in 2:5 8:5 64:5 512:3 2000:2; do # bodies, rounds
            [ -z "$quick" ] || [ "${crowd%:*}" -le 64 ] || continue
            study crowd bodies="${crowd%:*}" rounds="${crowd#*:}" samples=30 threads=$threads
        done
    done
    bench bench_contact
fi
! wanted memory || bench bench_memory
! wanted scenes || bench bench_scenes --rounds 3
echo "== measured in $(($(date +%s) - began)) s"

mv "$part" "$result"
if [ "$quick" ]; then
    echo "nothing is compared: sizes are not the stored ones"
elif [ ! -f "$stored" ]; then
    echo "no stored file to compare with: $stored"
elif sh bench/compare.sh "$stored" "$result" >bench/results/compare.txt; then
    sed '/^all figures/,$d' bench/results/compare.txt
    echo "all of it: bench/results/compare.txt"
fi
if [ "$store" ]; then
    cp "$result" "$stored"
    [ ! "$(command -v gnuplot)" ] || sh bench/plot_machine.sh "$stored" -o bench/machines
    echo "stored: $stored"
else
    [ ! "$(command -v gnuplot)" ] || sh bench/plot_machine.sh "$result" -o bench/results
    echo "written: $result (--store makes it the stored one)"
fi
