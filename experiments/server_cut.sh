#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Three memory servers, a name system and a client, each on a host of its own (a network namespace),
# over TLS and with tokens. One server is cut off and comes back: how soon does the client go on?
# Needs root, ip and openssl.
#
#     experiments/server_cut.sh PROGRAM [SECONDS_CUT]     PROGRAM: build/dev/bin/server_cut
set -eu

program=$(realpath "$1")
cut=${2:-8}
folder=$(mktemp -d)
bridge=eg$(($$ % 10000))
hosts="names a b c client"
pids=

clean() {
  for pid in $pids; do kill "$pid" 2>/dev/null || true; done
  for pid in $pids; do wait "$pid" 2>/dev/null || true; done
  for host in $hosts; do ip netns del "$bridge-$host" 2>/dev/null || true; done
  ip link del "$bridge" 2>/dev/null || true
  rm -rf "$folder"
}
trap clean EXIT
trap 'exit 1' INT TERM

address() {
  case $1 in names) echo 10.77.31.1 ;; a) echo 10.77.31.2 ;; b) echo 10.77.31.3 ;;
    c) echo 10.77.31.4 ;; client) echo 10.77.31.5 ;; esac
}

# A certificate authority, and a certificate for all addresses.
(
  cd "$folder"
  umask 077
  openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj "/CN=robot" \
    -keyout ca.key -out ca.pem
  openssl req -newkey rsa:2048 -nodes -subj "/CN=server" -keyout server.key -out server.csr
  printf 'subjectAltName=IP:%s,IP:%s,IP:%s,IP:%s\n' \
    "$(address names)" "$(address a)" "$(address b)" "$(address c)" > names.cnf
  openssl x509 -req -in server.csr -CA ca.pem -CAkey ca.key -CAcreateserial -days 2 \
    -extfile names.cnf -out server.pem
  openssl rand -hex 24 | tr -d '\n' > token
  printf 'tokens:\n  - name: robot\n    token_sha256: %s\n    role: write\n    memories: all\n' \
    "$(sha256sum < token | cut -d ' ' -f 1)" > tokens.yaml
) > "$folder/openssl.log" 2>&1

ip link add "$bridge" type bridge
ip link set "$bridge" up
for host in $hosts; do
  ip netns add "$bridge-$host"
  ip link add "$bridge$host" type veth peer name eth0 netns "$bridge-$host"
  ip link set "$bridge$host" master "$bridge" up
  ip -n "$bridge-$host" addr add "$(address $host)/24" dev eth0
  ip -n "$bridge-$host" link set eth0 up
  ip -n "$bridge-$host" link set lo up
done

on() {
  host=$1
  shift
  ip netns exec "$bridge-$host" "$program" "$@" &
  pids="$pids $!"
}

names=$(address names):7070
on names names "$names" "$folder"
for host in a b c; do
  on $host memory "$(address $host):7070" "$folder" "$names" $host
done
on client client "$names" "$folder" $((cut + 18)) a b c > "$folder/said"
client=$!

now() { date +%s.%N; }
sleep 5
off=$(now)
ip link set "${bridge}c" down
sleep "$cut"
back=$(now)
ip link set "${bridge}c" up
wait $client

echo "cut off for $cut s; seconds since then, or since it was back:"
awk -v off="$off" -v back="$back" '
  $1 < off { next }
  $1 < back { printf "  %6.2f after the cut   %s %s\n", $1 - off, $2, $3; if ($2 !~ /c$/) others++ }
  $1 >= back { printf "  %6.2f after the end   %s %s\n", $1 - back, $2, $3
               if ($3 == "works" && $1 - back > last) last = $1 - back
               works[$2] = $3 == "works"; if ($2 !~ /c$/) others++ }
  END { all = works["commit-to-c"] && works["query-of-c"] && works["told-of-c"]
        printf "all works again %.2f s after the end; others interrupted: %d times\n", last, others
        exit !(all && last < 10 && others == 0) }' "$folder/said"
