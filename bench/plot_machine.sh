#!/bin/sh
# Pictures of a machine's file (bench/machines/README.md): cost over size, the crowd, kernels and transfers. Needs gnuplot.
#
#   sh bench/plot_machine.sh FILE.csv [-o FOLDER]
#
# Writes NAME_growth, NAME_crowd and NAME_kernels as .png and .svg to FOLDER (default: where the file is); those it has no
# figures for are left out.
# Exit codes as those of brunt: 64 bad usage, 65 bad input, 74 file system.
set -eu
fail() {
    code=$1
    shift
    echo "plot_machine.sh: $*" >&2
    exit "$code"
}
case $# in
1) folder=$(dirname "$1") ;;
3) [ "$2" = -o ] || fail 64 "usage: plot_machine.sh FILE.csv [-o FOLDER]"; folder=$3 ;;
*) fail 64 "usage: plot_machine.sh FILE.csv [-o FOLDER]" ;;
esac
file=$1
name=$(basename "$file" .csv)
[ -r "$file" ] || fail 74 "$file cannot be read"
[ -d "$folder" ] || fail 74 "there is no folder $folder"
command -v gnuplot >/dev/null || fail 65 "gnuplot is not here: sh cmake/install.sh picture"
machine=$(sed -n "s/^# processor: *//p; s/'//g" "$file" | head -n 1)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# rows KIND NAME FIGURE THREADS: "units median least", by units.
rows() {
    awk -F, -v kind="$1" -v name="$2" -v figure="$3" -v threads="$4" \
        '$1 == kind && $2 == name && $5 == figure && $4 == threads { print $3, $7, $8 }' "$file" | sort -g
}

# draw NAME: the script on standard input, after terminal and style, once for each format.
draw() {
    cat >"$work/script"
    for format in png svg; do
        case $format in
        png) terminal="pngcairo size 900,620 font 'sans,14' noenhanced" ;;
        svg) terminal="svg size 900,620 font 'sans,14' noenhanced background 'white'" ;;
        esac
        {
            echo "set terminal $terminal"
            echo "set output '$work/picture.$format'"
            # Okabe and Ito's colours, which colour-blind readers tell apart, too.
            echo "set linetype 1 linecolor '#0072B2'; set linetype 2 linecolor '#D55E00'; set linetype 3 linecolor '#009E73'"
            echo "set linetype 4 linecolor '#CC79A7'; set linetype 5 linecolor '#E69F00'"
            echo "set border 3; set tics nomirror out; set grid back linecolor '#cccccc' linewidth 1 dashtype 1"
            cat "$work/script"
        } >"$work/all"
        gnuplot "$work/all" >&2 || fail 65 "gnuplot refused (above)"
        mv "$work/picture.$format" "$folder/${name}_$1.$format" || fail 74 "$folder cannot be written"
        echo "$folder/${name}_$1.$format"
    done
}

# Cost over size: a colour and a mark a thing; one thread a full line, two threads a dashed one with open marks.
growth() {
    plots='' index=0
    for thing in "3d quadratic apic neo-hookean:material points 3D:7:6" "2d quadratic apic neo-hookean:material points 2D:5:4" \
        "hex8:hex8:9:8" "tet4:tet4:13:12"; do
        index=$((index + 1))
        row=${thing%%:*} rest=${thing#*:}
        label=${rest%%:*} marks=${rest#*:}
        for threads in 1 2; do
            data=$work/growth_${index}_$threads
            rows growth "$row" step $threads >"$data"
            [ -s "$data" ] || continue
            [ $threads -eq 1 ] && look="dashtype 1 pointtype ${marks%:*}" || look="dashtype 2 pointtype ${marks#*:}"
            words="$label, $threads thread$([ $threads -eq 1 ] || echo s)"
            plots="$plots${plots:+, }'$data' using 1:2 with linespoints linecolor $index $look linewidth 2 pointsize 1.2 title '$words'"
        done
    done
    [ -n "$plots" ] || return 0
    draw growth <<SCRIPT
set title 'Cost of a step over size ($machine)'
set logscale x
set format x '10^{%L}'
set termoption enhanced
set xlabel 'particles or elements [-]' offset 0,0.8
set ylabel 'time per particle or element and step [ns]'
set yrange [0:*]
set key outside center bottom horizontal maxcols 4 samplen 3 font ',12' spacing 0.95
plot $plots
SCRIPT
}

# Crowd: seconds a step over bodies, and the power that fits them.
crowd() {
    plots=
    for threads in 1 2; do
        data=$work/crowd_$threads
        rows contact "augury crowd" step $threads >"$data"
        [ "$(wc -l <"$data")" -ge 2 ] || continue
        fit=$(awk '{ x = log($1); y = log($2); n++; sx += x; sy += y; sxx += x * x; sxy += x * y }
            END { p = (n * sxy - sx * sy) / (n * sxx - sx * sx); printf "%.4f %.10g", p, exp((sy - p * sx) / n) }' "$data")
        power=${fit% *} factor=${fit#* }
        [ $threads -eq 1 ] && look="pointtype 7" || look="pointtype 4"
        plots="$plots${plots:+, }'$data' using 1:(1e3 * \$2) with points linecolor $threads $look pointsize 1.6"
        plots="$plots title '$threads thread$([ $threads -eq 1 ] || echo s)', 1e3 * $factor * x**$power with lines linecolor $threads"
        plots="$plots dashtype $((threads * 2)) linewidth 1.5 title sprintf('bodies^{%.2f}', $power)"
    done
    [ -n "$plots" ] || return 0
    draw crowd <<SCRIPT
set title 'Cubes of 384 tetrahedra falling on each other ($machine)'
set termoption enhanced
set logscale xy
set xlabel 'bodies [-]'
set ylabel 'time of a step [ms]'
set key top left Left reverse samplen 3
plot $plots
SCRIPT
}

# Kernels and transfers on one thread: bars are medians, their whiskers reach down to the least.
kernels() {
    for dimension in 3 2; do
        for kernel in linear quadratic cubic; do
            printf '%s' "$kernel"
            for transfer in apic flip pic; do
                found=$(rows particles "${dimension}d $kernel $transfer neo-hookean" step 1 | tail -n 1)
                [ -n "$found" ] && echo "$found" | awk '{ printf " %s %s %s", $2, $3, $2 }' || printf ' NaN NaN NaN'
            done
            echo
        done >"$work/kernels_$dimension"
    done
    grep -q '[0-9]' "$work/kernels_3" "$work/kernels_2" || return 0
    draw kernels <<SCRIPT
set style data histograms
set style histogram errorbars gap 1 linewidth 1.5
set style fill solid 0.85 border -1
set xtics scale 0
set grid noxtics
set xrange [-0.6:2.6]
set yrange [0:*]
set multiplot layout 1,2 title 'Cost of a step by kernel and transfer, one thread ($machine)'
set key outside top center horizontal samplen 1
set xlabel '3D, 8 particles a cell'
set ylabel 'time per particle and step [ns]'
plot '$work/kernels_3' using 2:3:4:xtic(1) linetype 1 title 'APIC', '' using 5:6:7 linetype 5 title 'FLIP', '' using 8:9:10 linetype 3 title 'PIC'
unset ylabel
set xlabel '2D, 4 particles a cell'
plot '$work/kernels_2' using 2:3:4:xtic(1) linetype 1 title 'APIC', '' using 5:6:7 linetype 5 title 'FLIP', '' using 8:9:10 linetype 3 title 'PIC'
unset multiplot
SCRIPT
}

growth
crowd
kernels
