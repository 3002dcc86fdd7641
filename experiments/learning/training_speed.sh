#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Images per second of processor time that the autoencoder trains on, one thread, beside the same
# networks in PyTorch's Python (image_latents.py), in turn. The last column is how often as many.
# Usage: training_speed.sh ENGRAM VIDEO [PAIRS [STEPS [WIDTH]]]
set -euo pipefail
engram=$1 video=$2 pairs=${3:-3} steps=${4:-120} width=${5:-128}
here=$(dirname "$0")
entity=Vision/RGB/head/cam

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
quietly() { "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }; }
quietly "$engram" import --video "$video" --entity $entity --crop-square --size 128x128 --rate 5 \
  "$work/clip.engram"
quietly "$engram" export "$work/clip.engram" "$entity @ all" --to png -o "$work/images"

# The autoencoder gets 70 % of all steps.
ours() {
  "$engram" consolidate "$work/clip.engram" --entity $entity --representation latents --psnr 40 \
    --width "$width" --threads 1 --steps $((steps * 10 / 7)) --force --anew --progress none --json |
    /usr/bin/python3 -c 'import json, sys
print(json.load(sys.stdin)["entities"][0]["images_per_processor_second"])'
}

theirs() {
  /usr/bin/python3 "$here/image_latents.py" "$work/images" --db 40 --width "$width" \
    --steps "$steps" --out "$work/latents.bin" | sed -n 's/ images per second.*//p'
}

printf 'pair  engram  PyTorch  ratio   (images per second of processor time, width %s)\n' "$width"
for pair in $(seq "$pairs"); do
  a=$(ours) b=$(theirs)
  awk -v pair="$pair" -v a="$a" -v b="$b" \
    'BEGIN { printf "%4d  %6.1f  %7.1f  %5.2f\n", pair, a, b, a / b }'
done
