#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the packages of a list that are missing; does nothing where all are there.
# Usage: install_packages.sh [FILE, from the root of the sources: packages.txt]
set -eu
cd "$(dirname "$0")/.."
list=${1:-packages.txt}

if ! command -v dpkg-query >/dev/null; then
  echo "engram: this is no Debian system; install the equivalents of $list by hand" >&2
  exit 0
fi

# What installed packages provide: Node.js of another source has npm in it, and conflicts with
# Debian's. Versions behind the names do not count here.
provided=$(dpkg-query -W -f '${db:Status-Status}, ${Provides}\n' 2>/dev/null |
  sed -n 's/^installed, //p' | tr ',' '\n' | sed 's/^ *//; s/[ (].*//')

missing=
for package in $(sed 's/#.*//' "$list"); do
  state=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
  [ "$state" = "install ok installed" ] && continue
  printf '%s\n' "$provided" | grep -qxF -- "$package" || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

echo "engram: installing$missing" >&2
as_root=
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || {
    echo "engram: needs root (or sudo) to install:$missing" >&2
    exit 1
  }
  as_root="sudo"
fi
$as_root apt-get update -qq
# shellcheck disable=SC2086  # one argument per package
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing
