#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs a build, builds the measurement programs against it and runs all experiments in their
# short form, on a simulated kitchen: one report, nothing missing, figures as scikit-image has them.
# Usage: paper_test.sh BUILD_DIRECTORY SOURCE_DIRECTORY
set -eu
build=$1
source=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cmake --install "$build" --prefix "$scratch/prefix" --strip > "$scratch/install.log"
cmake --install "$build" --prefix "$scratch/prefix" --component internals >> "$scratch/install.log"
cmake -S "$source/experiments" -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$scratch/prefix" \
  -DCMAKE_BUILD_TYPE=Release > "$scratch/configure.log" || { cat "$scratch/configure.log"; exit 1; }
cmake --build "$scratch/build" --target step_bars age_bars

cd "$source"
export PYTHONPATH="$source:$build/python" PYTHONDONTWRITEBYTECODE=1
page=$(/usr/bin/python3 -m experiments.paper --profile short --recordings "" \
  --engram "$build/bin/engram" --programs "$scratch/build" --work "$scratch/paper")
[ "$page" = "$scratch/paper/short/paper.html" ]
/usr/bin/python3 "$source/tests/experiments/check_paper.py" "$scratch/paper/short"
