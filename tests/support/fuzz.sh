#!/bin/sh
# Fuzzes the scene reader: sh tests/support/fuzz.sh [SECONDS] [WORK FOLDER]
# With clang: libFuzzer and the sanitizers. Without: the mutating main of fuzz_scene.c under gcc's sanitizers.
set -eu
seconds=${1:-60}
root=$(cd "$(dirname "$0")/../.." && pwd)
work=${2:-$(mktemp -d)}
mkdir -p "$work/corpus"
# Reading the whole database of units takes most of a run's time: a part of it will do.
database=/usr/share/xml/udunits
if [ -f $database/udunits2-base.xml ]; then
  {
    echo '<unit-system>'
    for part in prefixes base derived; do echo "<import>$database/udunits2-$part.xml</import>"; done
    echo "<unit><def>60 s</def><name><singular>minute</singular></name><symbol>min</symbol></unit>"
    echo '<unit><def>K @ 273.15</def><aliases><symbol>degC</symbol></aliases></unit>'
    echo '<unit><def>0.0174532925199432957 rad</def><name><singular>arc_degree</singular></name></unit>'
    echo '</unit-system>'
  } > "$work/units.xml"
  export UDUNITS2_XML_PATH="$work/units.xml"
fi
cp "$root"/bench/scenes/*.yaml "$root"/tests/bad_scenes/*.yaml "$work/corpus/"
flags="-std=gnu17 -D_GNU_SOURCE -g -O1 -fno-math-errno -fno-omit-frame-pointer -Wno-psabi
  -I$root -I$root/engine -I$root/engine/include -I/usr/include/udunits2"
sources="$root/tests/support/fuzz_scene.c $root/io/scene/units.c $root/engine/base/memory.c $root/engine/base/error.c $root/engine/base/text.c
  $root/engine/base/array.c $root/engine/mpm/courant.c
  $root/engine/world/definitions.c $root/io/file/input_file.c $root/io/study/study_keys.c"
# A scene may name mesh files; the table of elements comes with the kernels.
for file in "$root"/io/scene/scene*.c "$root"/io/mesh/*.c "$root"/engine/geometry/[!f]*.c "$root"/engine/fem/*.c "$root"/engine/fem/elements/*.c "$root"/materials/*.c; do
  sources="$sources $file"
done
if command -v clang >/dev/null 2>&1 &&
   printf 'int LLVMFuzzerTestOneInput(const unsigned char *d, unsigned long n);\nint LLVMFuzzerTestOneInput(const unsigned char *d, unsigned long n) { return d && n ? 0 : 0; }\n' > "$work/probe.c" &&
   clang -fsanitize=fuzzer,address,undefined "$work/probe.c" -o "$work/probe" 2>/dev/null
then
  # shellcheck disable=SC2086
  clang $flags -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all $sources -o "$work/fuzz_scene" -lfyaml -ludunits2 -lm
  cd "$work"
  # udunits2 keeps some 500 bytes of every system of units it has freed: a million scenes need the room.
  ./fuzz_scene -max_total_time="$seconds" -max_len=8192 -timeout=10 -rss_limit_mb=8192 -print_final_stats=1 corpus
else
  # shellcheck disable=SC2086
  ${CC:-cc} $flags -DSTANDALONE -fsanitize=address,undefined -fno-sanitize-recover=all $sources -o "$work/fuzz_scene" \
    -lfyaml -ludunits2 -lm
  "$work/fuzz_scene" "$seconds" 1 "$work"/corpus/*.yaml
fi
echo "fuzz: nothing found in $seconds s"
