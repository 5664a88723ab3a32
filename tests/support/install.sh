#!/bin/sh
# Installs the build in the folder named as argument under a prefix of its own, builds tests/support/installed.c against it with
# what pkg-config says, and runs that and the installed program; each public header is compiled by itself, in C and C++.
# A build folder with a space in its path is configured, and the program linked as it would be there.
#
#   sh tests/support/install.sh BUILD [COMPILER]      default: cc
set -eu
cd "$(dirname "$0")/../.."
build=${1:?"usage: sh tests/support/install.sh BUILD [COMPILER]"}
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT

DESTDIR='' cmake --install "$build" --prefix "$prefix" >"$prefix/log" || { cat "$prefix/log"; exit 1; }
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name brunt.pc)")
export PKG_CONFIG_PATH
flags=$(pkg-config --cflags --libs brunt)
# shellcheck disable=SC2086
${2:-cc} -std=c17 -Wall -Wextra -Werror tests/support/installed.c -o "$prefix/installed" $flags -lm
"$prefix/installed"
# Each part of brunt.h is whole by itself, in C and in C++.
for header in "$prefix"/include/brunt.h "$prefix"/include/brunt/*.h; do
    name=${header#"$prefix"/include/}
    echo "#include \"$name\"" >"$prefix/part.c"
    ${2:-cc} -std=c17 -Wall -Wextra -Werror -fsyntax-only -I"$prefix/include" "$prefix/part.c"
    command -v clang >/dev/null || continue
    clang -x c++ -std=c++17 -Wall -Wextra -Werror -fsyntax-only -I"$prefix/include" "$prefix/part.c"
done
[ "$(pkg-config --modversion brunt)" = "$("$prefix/bin/brunt" --version | awk '{print $2}')" ] || {
    echo "brunt.pc and the program give different versions"
    exit 1
}
# The program is linked the same way where the build folder has a space in its path.
cmake -S . -B "$prefix/a b" -G 'Unix Makefiles' -DBRUNT_TESTS=OFF -DBRUNT_BENCH=OFF >"$prefix/log" 2>&1 || { cat "$prefix/log"; exit 1; }
link=$(sed "s|-o brunt |-o $prefix/linked |" "$prefix/a b/CMakeFiles/brunt_program.dir/link.txt")
(cd "$build" && eval "$link") && "$prefix/linked" --version >/dev/null
"$prefix/bin/brunt" check bench/scenes/two_disks.yaml >"$prefix/log" || { cat "$prefix/log"; exit 1; }
