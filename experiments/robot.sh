#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A robot that lives: its memory, the kitchen with its drivers, and the page that shows both, until
# Ctrl-C, or until its terminal is closed.  Usage: robot.sh ENGRAM DIR ROBOT_YAML [OPTIONS OF THE KITCHEN]
set -eu

engram=$1
dir=$2
yaml=$3
shift 3

mkdir -p "$dir"
cp "$yaml" "$dir/robot.yaml"
programs=

# Each program has a session of its own: Ctrl-C would reach it, and the signal of end() would be its
# second one, which ends a server before it has stored what is in its memory.
begin() {
  setsid "$engram" "$@" &
  programs="$! $programs"
}

# The page first, so that it says nothing of a server that is gone; the server last, because it
# stores what is in its memory.
end() {
  trap '' INT TERM HUP
  for program in $programs; do
    kill -TERM "$program" 2> /dev/null || true
    wait "$program" 2> /dev/null || true
  done
}
trap end EXIT
trap 'exit 130' INT TERM
trap 'exit 129' HUP

begin serve --config "$dir/robot.yaml" > "$dir/serve.log" 2>&1
server=$!
until grep -q 'listens at' "$dir/serve.log"; do
  kill -0 "$server" 2> /dev/null || { cat "$dir/serve.log" >&2; exit 1; }
  sleep 0.1
done
cat "$dir/serve.log"
begin simulate kitchen --live "$@"
kitchen=$!
begin view
wait "$kitchen"
