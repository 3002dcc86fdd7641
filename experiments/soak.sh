#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# soak.sh [SECONDS] [SEED] [BUILD]: a robot of a name system, three memory servers, eight writers and
# eight readers; any of them is killed at random moments and started again. Prints what was counted;
# fails where a commit that was acknowledged as durable is missing, an answer is wrong, a server
# takes too much RAM, or something is left behind.
set -eu
seconds=${1:-300}
seed=${2:-1}
build=${3:-build/dev}
cd "$(dirname "$0")/.."
if [ ! -x "$build/bin/soak_server" ]; then
  echo "soak.sh: needs $build/bin/soak_server: make test builds it" >&2
  exit 2
fi
exec "$build/bin/soak_server" "$seconds" "$seed"
