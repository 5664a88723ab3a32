#!/bin/sh
# Measurements of contact between meshes: runs contact_study over forms, edge lengths, regimes, slopes and stacks, two runs at a
# time, and writes bench/studies/contact_table.md.
#
#   sh bench/studies/contact_table.sh [-f] [-o FILE] [-p PATTERN] [CONTACT_STUDY]
#
# -f: also edges of 1/8 m (minutes more). -o: writes FILE instead. -p: only runs whose arguments match. CONTACT_STUDY: the program; default
# build/bench/contact_study. Takes some ten minutes. A run that is stopped after LIMIT seconds, or fails, has a row that says so.
set -u
cd "$(dirname "$0")/../.."
fine=no file=bench/studies/contact_table.md pattern=
while getopts fo:p: option; do
    case $option in
    f) fine=yes ;;
    o) file=$OPTARG ;;
    p) pattern=$OPTARG ;;
    *) exit 64 ;;
    esac
done
shift $((OPTIND - 1))
study=${1:-build/bench/contact_study}
limit=${LIMIT:-400}
[ -x "$study" ] || { echo "no program $study: build the target contact_study" >&2; exit 64; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Each line of the plan: SECTION | what is said of the run | arguments. Runs are numbered in this order.
plan() {
    published="form=published grid=2"
    for h in 1 .5 .25; do
        for n in 0 1 2; do
            echo "cubes|published PIC, N = $n|cubes h=$h $published transfer=pic n=$n"
            echo "cubes|published APIC, N = $n|cubes h=$h $published transfer=apic n=$n"
        done
        for form in averaged_surface averaged_facets node_to_facet; do echo "cubes|$form|cubes h=$h form=$form"; done
        echo "cubes|node_to_facet, hex8|cubes h=$h form=node_to_facet element=hex8"
    done
    if [ $fine = yes ]; then
        echo "cubes|node_to_facet|cubes h=.125 form=node_to_facet"
        echo "cubes|published APIC, N = 1|cubes h=.125 $published n=1"
    fi

    for form in node_to_facet averaged_facets averaged_surface "published n=1"; do
        name=${form%% n=1}
        echo "regimes|$name, as it is|cubes form=$form"
        echo "regimes|$name, mu = 0.3|cubes form=$form mu=.3"
        echo "regimes|$name, speed x 3|cubes form=$form speed=3"
        echo "regimes|$name, speed x 10|cubes form=$form speed=10 dt=.1"
        echo "regimes|$name, E / 100, speed / 10|cubes form=$form stiff=.01 speed=.1 dt=10"
        echo "regimes|$name, first E x 1000, density x 10|cubes form=$form e1=1000 r1=10"
        echo "regimes|$name, second E x 1000, density x 10|cubes form=$form stiff=100 e1=.001 r1=.1"
        echo "regimes|$name, corner on face|corner form=$form"
        echo "regimes|$name, face on face|face form=$form"
        echo "regimes|$name, dt x 2|cubes form=$form dt=2"
        echo "regimes|$name, dt x 5|cubes form=$form dt=5"
        echo "regimes|$name, dt x 12|cubes form=$form dt=12"
    done

    for mu in 0 .1 .2 .4 .6; do
        for h in 1 .5; do
            echo "ramp|exact node by node on a rigid plane|ramp h=$h mu=$mu form=rigid"
            echo "ramp|node_to_facet|ramp h=$h mu=$mu form=node_to_facet"
            for form in averaged_facets averaged_surface published; do
                case $mu in 0 | .2) cells=".5 1 2" ;; *) cells=1 ;; esac
                for grid in $cells; do echo "ramp|$form, cell $grid h|ramp h=$h mu=$mu form=$form grid=$grid"; done
            done
        done
        echo "ramp|exact node by node on a rigid plane|ramp h=.25 mu=$mu form=rigid"
        echo "ramp|node_to_facet|ramp h=.25 mu=$mu form=node_to_facet"
    done
    for grid in .5 2; do echo "ramp|node_to_facet, cell $grid h|ramp h=.5 mu=.2 form=node_to_facet grid=$grid"; done
    for form in rigid node_to_facet averaged_facets averaged_surface published; do
        echo "ramp|$form, turned by 37 degrees|ramp h=.5 mu=.2 form=$form turn=37"
    done
    for mu in 0 .2 .4 .6; do
        for form in rigid node_to_facet averaged_facets averaged_surface published; do
            echo "sudden|$form|ramp h=.5 mu=$mu form=$form ramp=0 end=.25"
        done
    done

    for form in node_to_facet averaged_facets averaged_surface published; do
        echo "stack|$form, mu = 0.5|stack h=.333333333333 mu=.5 form=$form end=1e5"
        echo "stack|$form, mu = 0, hex8|stack h=.333333333333 mu=0 element=hex8 form=$form end=1e5"
        echo "stack|$form, mu = 0.5, off centre|stack h=.333333333333 mu=.5 shift=.3 form=$form end=2e4"
        echo "stack|$form, load / 4|stack h=.333333333333 mu=.5 load=.25 form=$form end=2e4"
        echo "stack|$form, load x 4|stack h=.333333333333 mu=.5 load=4 form=$form end=2e4"
        echo "stack|$form, base E x 100|stack h=.333333333333 mu=.5 e1=100 form=$form end=2e4"
        echo "stack|$form, base E / 2|stack h=.333333333333 mu=.5 e1=.5 form=$form end=2e4"
    done
    echo "stack|node_to_facet, 16 sweeps, mu = 0.5|stack h=.333333333333 mu=.5 n=16 form=node_to_facet end=1e5"
    echo "stack|node_to_facet, mu = 0.5, hex8|stack h=.333333333333 mu=.5 element=hex8 form=node_to_facet end=1e5"

    for form in node_to_facet averaged_facets averaged_surface "published n=1"; do
        name=${form%% n=1}
        echo "moved|$name, as it is|cubes form=$form"
        echo "moved|$name, shifted by 0.3 h|cubes form=$form shift=.3"
        echo "moved|$name, turned by 22 degrees|cubes form=$form turn=22"
        echo "moved|$name, turned by 90 degrees|cubes form=$form turn=90"
    done

    for form in node_to_facet averaged_facets averaged_surface "published n=1"; do
        name=${form%% n=1}
        echo "unequal|$name, edges 1.5 and 0.15 m|cubes h=1.5 h2=.15 dt=4 samples=20 form=$form"
        echo "unequal|$name, edges 0.15 and 1.5 m|cubes h=.15 h2=1.5 dt=4 samples=20 form=$form"
    done
}

plan | grep -E "\|[^|]*$pattern[^|]*$" >"$work/plan"
number=0
: >"$work/jobs"
while IFS='|' read -r section what arguments; do
    number=$((number + 1))
    printf '%d %s\n' "$number" "$arguments" >>"$work/jobs"
done <"$work/plan"

cat >"$work/run" <<'END'
number=$1
shift
timeout "$LIMIT" "$STUDY" "$@" >"$WORK/$number" 2>&1 || echo "ended with code $?" >>"$WORK/$number"
END
export LIMIT=$limit STUDY=$study WORK=$work
xargs -P 2 -L 1 sh "$work/run" <"$work/jobs"

# Rows of a section: what is said, then figures of the run found by their keys.
rows() {
    number=0
    while IFS='|' read -r section what arguments; do
        number=$((number + 1))
        [ "$section" = "$1" ] || continue
        awk -v what="$what" -v keys="$2" -v arguments="$arguments" '
            NR == 1 || /ended with code/ {
                line = $0
                gsub(/\(max /, "deepest=", line)
                vector = ""
                if (match(line, /v=\([^)]*\)/)) vector = substr(line, RSTART + 2, RLENGTH - 2)
                gsub(/[()]/, "", line)
                n = split(line, field, " ")
                for (k = 1; k <= n; k++) if (split(field[k], part, "=") == 2 && !(part[1] in value)) value[part[1]] = part[2]
                if ($0 ~ /ended with code/) failed = $0
            }
            NR == 2 && !/ended with code/ { failed = $0 }
            END {
                value["v"] = vector
                n = split(arguments, field, " ")
                for (k = 2; k <= n; k++) { split(field[k], part, "="); if (!(part[1] in value)) value[part[1]] = part[2] }
                row = "| " what
                n = split(keys, key, " ")
                for (k = 1; k <= n; k++) {
                    text = value[key[k]]
                    sub(/[h%]+$/, "", text)
                    row = row " | " text
                }
                print row " |" (failed != "" ? " " failed " |" : "")
            }' "$work/$number"
    done <"$work/plan"
}

head() { printf '\n## %s\n\n%s\n\n%s\n' "$1" "$2" "$3"; printf '%s\n' "$3" | sed 's/[^|]\{1,\}/ --- /g'; }

{
    cat <<'END'
# Contact between meshes, measured

Written by `sh bench/studies/contact_table.sh`; what the cases are is in [contact_study.c](contact_study.c), what follows from
them in [tests/README.md](../../tests/README.md). E/E0: kinetic, stored and hourglass energy at the end over the energy at the
start, and the most it was at any sample. Depths are of a boundary node inside the other mesh, sampled 60 times a run; nearest:
the least distance at which a boundary node outside has been; gap: at the end, negative inside. h is the edge. Drifts are relative
(angular: about the origin, with the spin that the paper's form stores). v: velocity of the second body's centre relative to the
first's at the end. Cells are the forms' own (published: 2 h) unless given; node_to_facet depends on none. dt is the paper's, 1e-4 h s/m, in the
cubes, 2.5e-5 h on the slope, and half the stable step in the stack. The paper's tau is always dt in the engine. One thread; the
seconds are of a shared machine.
END
    head "Two cubes that meet at 22 degrees" \
        "Cubes of 3 m, E = 100 MPa, 2700 kg/m3, closing at 70 m/s (a third of the wave speed), tet4 unless said. They have parted when the gap at the end is more than some h and v_y is positive. t = 0.15 s." \
        "| form | h [m] | E/E0 | most | error of the ledger | deepest [h] | nearest [h] | gap [h] | linear drift | angular drift | v [m/s] | v_y [m/s] | steps | s |"
    rows cubes "h E/E0 max error pen near now dP dL v apart steps wall"
    head "Regimes" "The same, h = 1/2, one thing changed." \
        "| form, case | E/E0 | most | error of the ledger | deepest [h] | nearest [h] | gap [h] | linear drift | angular drift | v_y [m/s] | steps |"
    rows regimes "E/E0 max error pen near now dP dL apart steps"
    head "A block on a slope of 30 degrees" \
        "A cube of 1 m, E = 10 GPa, 1e6 kg/m3, on a plate of 4 x 1.5 x 0.25 m, g = 100 m/s2 that grows over 0.2 s; way along the slope at 0.36 s. Error: of the way by Coulomb's law for a rigid block; where it sticks the difference in m counts, which holds the block's own shear." \
        "| form | h [m] | mu | way [m] | Coulomb [m] | error [%] | difference [m] | sideways [m] | depth [h] | s |"
    rows ramp "h mu along exact error diff side pen wall"
    head "The same under sudden gravity" "t = 0.25 s: the block rings, its load touches 0 and it slips then; the exact reference does too." \
        "| form | h [m] | mu | way [m] | Coulomb [m] | error [%] | difference [m] | sideways [m] | depth [h] | s |"
    rows sudden "h mu along exact error diff side pen wall"
    head "A block on a block on a block" \
        "Cubes of 1 m on a block of 2 x 1 x 2 m held below, rho g L / E = 0.05, h = 1/3, bulk viscosity on. Two loose blocks buckle under their own weight from rho g L / E = 0.08 on (Greenhill 1881), so that four times the load must fall, and without friction nothing holds a block on an elastic one. Sink and way sideways are of the top block; 2nd: in the second half of the run. N/mg: mean force of the lower pair over the weight." \
        "| form, case | t [s] | depth [h] | deepest [h] | sink, 2nd [h] | sideways [h] | sideways, 2nd [h] | kinetic / m g h | N/mg - 1 | steps | s |"
    rows stack "t pen deepest sink2nd lateral lateral2nd KE/mgh N/mg-1 steps wall"
    head "Shifted and turned" "The cubes, h = 1/2: shift in all directions by parts of an edge, turn about y." \
        "| form, case | E/E0 | deepest [h] | nearest [h] | v [m/s] | v_y [m/s] |"
    rows moved "E/E0 pen near v apart"
    head "Unequal meshes" "Edges 10:1, 2 and 20 elements a side. Depth in edges of the first cube; dt of the finer mesh x 4." \
        "| form, case | E/E0 | most | deepest [h] | nearest [h] | gap [h] | linear drift | angular drift | v_y [m/s] | s |"
    rows unequal "E/E0 max pen near now dP dL apart wall"
} >"$work/table"
mv "$work/table" "$file"
echo "$(($(wc -l <"$work/plan"))) runs; $file"
