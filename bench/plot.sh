#!/bin/sh
# Curves of histories, over a reference if there is one: history.csv in, PNG (or SVG) out. Needs gnuplot
# (`sh cmake/install.sh picture`).
#
#   sh bench/plot.sh out/dam_break/history.csv body.water.high_x -o front.png
#
#   FILE.csv...           one or more histories; their first lines name the columns: "name [unit]"
#   COLUMN...             what is drawn, each of each file
#   -o FILE               ends in .png or .svg
#   --x COLUMN            what it is drawn over (default: time)
#   --shift-x S, --shift-y S, --scale-x S, --scale-y S
#                         values of the histories are shifted first, then multiplied
#   --reference FILE[:X:Y[:LABEL]]
#                         points drawn as they are: columns number X and Y (default 1 and 2) of a CSV file whose lines
#                         may be comments (#); may be given several times
#   --label TEXT          of the curves in the key, in order (default: the column, and the file's folder if there are several)
#   --xlabel TEXT, --ylabel TEXT, --title TEXT
#   --xrange A:B, --yrange A:B
#
# Exit codes as those of brunt: 64 bad usage, 65 bad input, 74 file system.
set -eu

# Okabe and Ito's colours, which colour-blind readers tell apart, too; each curve has a dash of its own besides.
colours='#0072B2 #D55E00 #009E73 #CC79A7 #56B4E9 #E69F00'
dashes='1 2 4 5 3 6'

fail() {
    code=$1
    shift
    echo "plot.sh: $*" >&2
    exit "$code"
}
usage() {
    sed -n '2,/^set -eu/p' "$0" | sed -n 's/^# \{0,1\}//p'
}
number() {
    printf '%s\n' "$2" | grep -Eqx -e '[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?' || fail 64 "$1: '$2' is no number"
}
interval() {
    from=${2%%:*} to=${2#*:}
    [ "$from:$to" = "$2" ] || fail 64 "$1: '$2' is not A:B"
    [ -z "$from" ] || number "$1" "$from"
    [ -z "$to" ] || number "$1" "$to"
}
# Text as gnuplot takes it between single quotes.
quoted() {
    printf "'%s'" "$(printf %s "$1" | tr '\n' ' ' | sed "s/'/''/g")"
}
# Number of a column and its unit, by its name without unit: "36 m".
column() {
    sed -n '/^#/d;p;q' "$1" | awk -F, -v name="$2" '{
        sub(/\r$/, "")
        for (i = 1; i <= NF; i++) {
            unit = ""
            title = $i
            if (match(title, / \[[^]]*\]$/)) {
                unit = substr(title, RSTART + 2, RLENGTH - 3)
                title = substr(title, 1, RSTART - 1)
            }
            if (title == name) { print i, unit; exit }
        }
    }'
}
wanted_column() {
    found=$(column "$1" "$2")
    [ -n "$found" ] || fail 65 "$1 has no column '$2'; there are: $(sed -n '/^#/d;s/ \[[^]]*\]//g;s/,/ /g;p;q' "$1")"
}
readable() {
    [ -f "$1" ] && [ -r "$1" ] || fail 74 "$1 cannot be read"
}

files= columns= output= over=time references= labels=
shift_x=0 shift_y=0 scale_x=1 scale_y=1 xlabel= ylabel= title= xrange=: yrange=:
newline='
'
while [ $# -gt 0 ]; do
    case $1 in
    -h | --help) usage; exit 0 ;;
    -o | --output | --x | --shift-x | --shift-y | --scale-x | --scale-y | --reference | --label | --xlabel | --ylabel | \
        --title | --xrange | --yrange)
        [ $# -gt 1 ] || fail 64 "$1 wants a value"
        case $1 in
        -o | --output) output=$2 ;;
        --x) over=$2 ;;
        --shift-x) number "$1" "$2"; shift_x=$2 ;;
        --shift-y) number "$1" "$2"; shift_y=$2 ;;
        --scale-x) number "$1" "$2"; scale_x=$2 ;;
        --scale-y) number "$1" "$2"; scale_y=$2 ;;
        --reference) references=$references$2$newline ;;
        --label) labels=$labels$2$newline ;;
        --xlabel) xlabel=$2 ;;
        --ylabel) ylabel=$2 ;;
        --title) title=$2 ;;
        --xrange) interval "$1" "$2"; xrange=$2 ;;
        --yrange) interval "$1" "$2"; yrange=$2 ;;
        esac
        shift 2 ;;
    -*) fail 64 "unknown option $1 (see --help)" ;;
    *.csv) files=$files$1$newline; shift ;;
    *) columns=$columns$1$newline; shift ;;
    esac
done
[ -n "$files" ] || fail 64 "no history is given (FILE.csv, see --help)"
[ -n "$columns" ] || fail 64 "no column is given (see --help)"
case $output in
*.png) terminal="pngcairo size 1200,800 font 'sans,22' linewidth 2 noenhanced" ;;
*.svg) terminal="svg size 1200,800 font 'sans,22' linewidth 2 noenhanced background 'white'" ;;
'') fail 64 "-o is missing: a file to write" ;;
*) fail 64 "-o: '$output' ends in neither .png nor .svg" ;;
esac
command -v gnuplot >/dev/null || fail 65 "gnuplot is not here: sh cmake/install.sh picture"

set -f # names with a star in them stay as they are
IFS=$newline
plots= count=0 unit_x= unit_y= same=yes
file_count=$(printf %s "$files" | wc -l)
column_count=$(printf %s "$columns" | wc -l)
nth() { printf %s "$1" | tr ' ' '\n' | sed -n "$(($2 % 6 + 1))p"; }
for file in $files; do
    readable "$file"
    wanted_column "$file" "$over"
    x=${found%% *} unit_x=${found#* }
    for name in $columns; do
        wanted_column "$file" "$name"
        y=${found%% *} unit=${found#* }
        [ "$count" -eq 0 ] || [ "$unit" = "$unit_y" ] || same=no
        unit_y=$unit
        label=$(printf %s "$labels" | sed -n "$((count + 1))p")
        if [ -z "$label" ]; then
            label=$name
            folder=$(basename "$(dirname "$file")")
            [ "$file_count" -eq 1 ] || { [ "$column_count" -eq 1 ] && label=$folder || label="$folder: $name"; }
        fi
        plots="$plots${plots:+, }$(quoted "$file")"
        plots="$plots using ((column($x)+($shift_x))*($scale_x)):((column($y)+($shift_y))*($scale_y)) with lines linewidth 2"
        plots="$plots linecolor '$(nth "$colours" "$count")' dashtype $(nth "$dashes" "$count") title $(quoted "$label")"
        count=$((count + 1))
    done
done
points=0
for reference in $references; do
    path=${reference%%:*} rest=${reference#"${reference%%:*}"}
    x=$(printf %s "$rest" | cut -d: -f2) y=$(printf %s "$rest" | cut -d: -f3) label=$(printf %s "$rest" | cut -s -d: -f4-)
    readable "$path"
    for c in "${x:=1}" "${y:=2}"; do
        case $c in '' | *[!0-9]* | 0*) fail 64 "--reference: '$reference' is not FILE:X:Y, numbers of columns from 1" ;; esac
    done
    # Copied out: gnuplot would take the line of names for the first after comments.
    rows=$(sed '/^#/d;s/\r$//' "$path" | awk -F, -v x="$x" -v y="$y" 'NR > 1 && $x != "" && $y != "" { print $x "," $y }')
    [ -n "$rows" ] || fail 65 "$path has no points in columns $x and $y"
    data="${data:-}\$reference$points << END$newline$rows${newline}END$newline"
    [ -n "$label" ] || label=$(basename "$path" .csv)
    plots="$plots, \$reference$points using 1:2 with points pointtype $((6 + 2 * (points % 3))) pointsize 1.8 linewidth 1.5"
    plots="$plots linecolor 'black' title $(quoted "$label")"
    points=$((points + 1))
done

# Units of the header hold only for what was not scaled.
[ -n "$xlabel" ] || { xlabel=$over; [ "$scale_x" != 1 ] || [ "$unit_x" = 1 ] || xlabel="$over [$unit_x]"; }
if [ -z "$ylabel" ]; then
    [ "$column_count" -ne 1 ] || ylabel=$(printf %s "$columns" | sed -n 1p)
    [ "$scale_y" != 1 ] || [ "$unit_y" = 1 ] || [ "$same" = no ] || ylabel="$ylabel [$unit_y]"
fi
# A part at a time: a picture that failed leaves none behind that looks like one.
part=$output.part
trap 'rm -f "$part"' EXIT
(: >"$part") 2>/dev/null || fail 74 "$output cannot be written"
gnuplot >&2 <<SCRIPT || fail 65 "gnuplot refused (above)"
set terminal $terminal
set output $(quoted "$part")
set datafile separator comma
set datafile missing ''
set border 3 linewidth 1
set tics nomirror out
set grid linecolor '#dddddd' linewidth 0.5 dashtype 1
set key above left reverse Left samplen 3 noenhanced # beside no curve, wherever it runs
set xlabel $(quoted "$xlabel") noenhanced
set ylabel $(quoted "$ylabel") noenhanced
${title:+set title $(quoted "$title") noenhanced}
set xrange [$xrange]
set yrange [$yrange]
${data:-}
plot $plots
SCRIPT
mv "$part" "$output" || fail 74 "$output cannot be written"
