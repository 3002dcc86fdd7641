#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs a build, builds a project of its own against it and runs that: first with what a program
# may use, then with the component `internals`.
# Usage: consumer_test.sh BUILD_DIRECTORY
set -eu
build=$1
here=$(cd "$(dirname "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

configure() {
  cmake -S "$here" -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$scratch/prefix" \
    -DCMAKE_BUILD_TYPE=Debug > "$scratch/configure.log" || { cat "$scratch/configure.log"; exit 1; }
}
expect() {
  [ "$1" = "$2" ] || { echo "found '$1', needs '$2'" >&2; exit 1; }
}

cmake --install "$build" --prefix "$scratch/prefix" > "$scratch/install.log"
configure
cmake --build "$scratch/build"
expect "$("$scratch/build/consumer" "$scratch/store")" "x = 2"
said=$("$scratch/build/front_door" "$scratch/robot.engram")
case $said in
  "6 remembered, x will be 2.1 ("*) ;;
  *) echo "found '$said', needs '6 remembered, x will be 2.1 (...)'" >&2; exit 1 ;;
esac
/usr/bin/python3 "$here/installed_headers.py" "$scratch/prefix" "$scratch/build"

cmake --install "$build" --prefix "$scratch/prefix" --component internals >> "$scratch/install.log"
configure
cmake --build "$scratch/build" --target internals
expect "$("$scratch/build/internals" "$scratch/internals.engram")" "x = 2"
