#!/bin/sh
# Checks that read the sources only.
#
#   sh tests/support/static.sh format        every C file is as .clang-format has it
#   sh tests/support/static.sh tidy BUILD    the checks of .clang-tidy, with the commands of BUILD/compile_commands.json
#
# Both are of clang 14, Debian 12's: other versions break lines and warn otherwise, so that with them nothing is checked (77).
set -eu
cd "$(dirname "$0")/../.."

tool=clang-$1
[ "$1" = format ] || [ "$1" = tidy ] || { echo "usage: sh tests/support/static.sh format | tidy BUILD" >&2; exit 64; }
version=$("$tool" --version 2>/dev/null | sed -n 's/.*version \([0-9]*\).*/\1/p')
[ "${version:-none}" = 14 ] || { echo "$tool 14 is wanted; here: ${version:-none}"; exit 77; }

list() { git ls-files "$@" | while read -r file; do [ -e "$file" ] && echo "$file"; done; }

if [ "$1" = format ]; then
    list '*.c' '*.h' | xargs clang-format --dry-run -Werror
else
    # The commands may be gcc's, with warnings of its own.
    list 'engine/*.c' 'contact/*.c' 'materials/*.c' 'io/*.c' |
        xargs -P "$(getconf _NPROCESSORS_ONLN)" -n 12 clang-tidy -p "${2:?BUILD}" --extra-arg=-Wno-unknown-warning-option --quiet 2>/dev/null
fi
