#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# crash.sh [KILLS] [SEED] [BUILD]: kills recording processes at random moments (while they record,
# seal, declare types, publish models, drop what those replace, compact and forget) and looks for every snapshot
# that they acknowledged. Prints a table; fails where one is missing.
set -eu
kills=${1:-300}
seed=${2:-1}
build=${3:-build/dev}
cd "$(dirname "$0")/.."
if [ ! -x "$build/bin/crash" ]; then
  echo "crash.sh: needs $build/bin/crash: make test builds it" >&2
  exit 2
fi
# Syncs are for power cuts: a killed process loses nothing that the system took.
[ -d /dev/shm ] && export TMPDIR="${TMPDIR:-/dev/shm}"
exec "$build/bin/crash" "$kills" "$seed"
