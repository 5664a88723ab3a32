#!/bin/sh
# Counts the instructions of a step of small scenes, side by side with another state of the sources.
#
#   sh bench/instructions.sh OTHER [DRESS...]      OTHER: top of another tree, or a commit of this one
#
# One line for each dress of tests/support/cost_scene.c (default: plain pic flip cubic dim2 gravity plastic wall met hex8 tet4
# hex8_viscous hex8_met hex8_on_plane): instructions of a step there and here, and their ratio. Both engines are built for any
# machine, as valgrind does not know every instruction of every one. Counts of one compiler do not vary from run to run: a ratio off 1
# is a change. Some six minutes, most of it to build.
# Exit codes: 0, 64 bad usage, else that of what failed.
set -eu
[ $# -ge 1 ] || { sed -n '2,/^set -eu/p' "$0" | sed -n 's/^# \{0,1\}//p' >&2; exit 64; }
cd "$(dirname "$0")/.."
other=$1
shift
[ $# -gt 0 ] || set -- plain pic flip cubic dim2 gravity plastic wall met hex8 tet4 hex8_viscous hex8_met hex8_on_plane
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ ! -d "$other" ]; then
    git rev-parse -q --verify "$other^{commit}" >/dev/null || { echo "instructions.sh: '$other' is neither a folder nor a commit" >&2; exit 64; }
    mkdir "$work/tree"
    git archive "$other" | tar -x -C "$work/tree"
    other=$work/tree
fi
here=$PWD
mkdir "$work/there" "$work/here"
(cd "$other" && BRUNT=$work/there/brunt COST_SCENE=$here/tests/support/cost_scene.c sh "$here/tests/support/cost_build.sh" "$work/there")
BRUNT=$work/here/brunt sh tests/support/cost_build.sh "$work/here"

printf '%-16s %14s %14s %8s\n' dress there here ratio
for dress; do
    before=$(sh tests/support/cost_count.sh "$work/there" "$dress")
    now=$(sh tests/support/cost_count.sh "$work/here" "$dress")
    echo "$dress $before $now" | awk '{ printf "%-16s %14d %14d %8.4f\n", $1, $2, $3, $3 / $2 }'
done
