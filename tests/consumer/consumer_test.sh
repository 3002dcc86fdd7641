#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs a build, builds a project of its own against it and runs that.
# Usage: consumer_test.sh BUILD_DIRECTORY
set -eu
build=$1
here=$(cd "$(dirname "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cmake --install "$build" --prefix "$scratch/prefix" > "$scratch/install.log"
cmake -S "$here" -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$scratch/prefix" \
  -DCMAKE_BUILD_TYPE=Debug > "$scratch/configure.log" || { cat "$scratch/configure.log"; exit 1; }
cmake --build "$scratch/build"
said=$("$scratch/build/consumer" "$scratch/store")
[ "$said" = "x = 2" ] || { echo "found '$said', needs 'x = 2'" >&2; exit 1; }
said=$("$scratch/build/front_door" "$scratch/robot.engram")
case $said in
  "6 remembered, x will be 2.1 ("*) ;;
  *) echo "found '$said', needs '6 remembered, x will be 2.1 (...)'" >&2; exit 1 ;;
esac
