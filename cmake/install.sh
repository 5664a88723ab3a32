#!/bin/sh
# Installs what is missing of the package groups named as arguments (build, test, picture), from cmake/packages.txt.
set -eu

list=$(dirname "$0")/packages.txt
wanted=
for group in "$@"; do
    packages=$(awk -v group="$group" '$1 == group { print $2 }' "$list")
    if [ -z "$packages" ]; then
        echo "install.sh: no package group '$group' in $list" >&2
        exit 64
    fi
    wanted="$wanted $packages"
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "Not a Debian system: these packages (or what they are called here) must be installed:" $wanted >&2
    exit 0
fi

missing=
for package in $wanted; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$state" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

root=
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "These packages are missing, and neither root nor sudo is here to install them:$missing" >&2
        exit 1
    fi
    root=sudo
fi
echo "Installing$missing"
$root apt-get update -q
$root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing
