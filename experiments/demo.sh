#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# One journey through everything: recordings become a memory that answers about the past and the
# future.  Usage: demo.sh ENGRAM DIR RECORDINGS BUDGET SECONDS
set -eu

engram=$1
dir=$2
recordings=$3
budget=$4
seconds=$5
store=$dir/robot.engram
camera=Vision/RGB/head/cam
joints=RobotState/Proprioception/robot/joints

say() { printf '\n\033[1m%s\033[0m\n' "$*"; }

# Shows a command as one would type it, and runs it.
run() {
  printf '$ engram'
  for word in "$@"; do
    case $word in
      *[!A-Za-z0-9_./:=,+-]*) printf " '%s'" "$word" ;;
      *) printf ' %s' "$word" ;;
    esac
  done
  printf '\n'
  "$engram" "$@"
}

# Pairs NAME.mp4 and NAME.csv below a folder, one "video table" a line.
pairs() {
  find "$1" -name '*.mp4' | sort | while read -r video; do
    name=$(basename "$video" .mp4)
    table=$(find "$1" -name "$name.csv" | sort | head -n 1)
    [ -z "$table" ] || printf '%s\t%s\n' "$video" "$table"
  done
}

# What is remembered where there are no recordings: a simulated kitchen, or a drawn scene where the
# program is built without.
without_recordings() {
  [ -z "$recordings" ] || [ -d "$recordings" ] || echo "No recordings in '$recordings'."
  if ! "$engram" simulate --help | grep -q 'built without'; then
    echo "kitchen of $seconds s"
    return
  fi
  "$engram" simulate scene --seconds "$seconds" --seed 1 --width 128 --height 128 \
    --video "$dir/scene.mp4" --table "$dir/scene.csv" >&2
  printf '%s\t%s\n' "$dir/scene.mp4" "$dir/scene.csv"
}

import_recordings() {
  say "1. Import: filter to 5 Hz, compress, journal, segments"
  minute=0
  tab=$(printf '\t')
  while IFS="$tab" read -r video table; do
    # A column that counts the rows is no state of the robot.
    skip=
    if head -n 1 "$table" | grep -q '^frame_index,'; then skip="--skip-column frame_index"; fi
    # shellcheck disable=SC2086  # two arguments or none
    run import --video "$video" --table "$table" --entity $camera --state-entity $joints \
      --size 128x128 --rate 5 $skip \
      --start "$(printf '2022-02-18T13:%02d:00Z' $minute)" "$store"
    minute=$((minute + 1))
  done < "$dir/recordings.txt"
}

record_kitchen() {
  say "1. Record a humanoid in a kitchen: physics, images, joints, objects, plans, actions, words"
  run simulate kitchen "$store" --fast --seconds "$seconds" --seed 1 \
    --config "$(dirname "$0")/demo_kitchen.yaml"
}

mkdir -p "$dir"
if [ -n "$recordings" ] && [ -d "$recordings" ] && [ -n "$(pairs "$recordings")" ]; then
  pairs "$recordings" > "$dir/recordings.txt"
else
  without_recordings > "$dir/recordings.txt"
fi
is_kitchen=
learned=
if grep -q '^kitchen' "$dir/recordings.txt"; then
  is_kitchen=yes
  camera=Vision/RGB/head/stereo
  learned="--entity $camera --entity $joints"
fi

# A kitchen has many entities: the journey shows what is learned.
show_store() {
  if [ -n "$is_kitchen" ]; then run ls "$store"; else run info "$store"; fi
}

# The same recordings and budget: the memory is there already.
wanted="$(cat "$dir/recordings.txt") $budget"
if [ -d "$store" ] && [ "$(cat "$dir/done.txt" 2>/dev/null)" = "$wanted" ]; then
  say "The memory of the last run is used again (remove $dir to start afresh)"
else
  rm -rf "$store" "$dir/done.txt"
  if [ -n "$is_kitchen" ]; then record_kitchen; else import_recordings; fi

  say "2. What the memory holds, and the last moments of it, as they were recorded"
  show_store
  run query "$store" "$camera @ latest:3" --save "$dir/latest"

  say "3. Consolidate: one autoencoder per entity ($budget in all)"
  # shellcheck disable=SC2086  # options or none
  run consolidate "$store" $learned --training "$budget" --representation latents --psnr 35
  printf '%s' "$wanted" > "$dir/done.txt"
fi

say "4. The same moments, from what was learned"
show_store
run query "$store" "$camera @ latest:3" --prefer latent --save "$dir/reconstructed"

if [ -n "$is_kitchen" ]; then
  run query "$store" 'Speech/Commands/human/text @ all'
fi

say "5. The future"
run query "$store" "$camera @ +200ms" --save "$dir/future"
run query "$store" "$joints @ +400ms" --save "$dir/future"

say "6. How good is it?"
# shellcheck disable=SC2086  # options or none
run eval "$store" $learned --picture "$dir/eval.png"
printf '\nLook at %s: recorded, reconstructed and predicted side by side.\n' "$dir/eval.png"
printf 'Look around in its memory: %s view %s\n' "$engram" "$store"
