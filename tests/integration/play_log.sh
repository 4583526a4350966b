#!/bin/sh
# Plays a log into the real processes, in a network namespace of its own where the machine allows one.
#   play_log.sh BIN LOG OUT SPEED        BIN: folder of the programs; OUT: folder for what they write and say
# PROCESS_OPTIONS in the environment: options of every process.
# Leaves OUT/<process>.txt (stdout and stderr) and OUT/codes ("<backend> <free-space> <rooms> <loops>
# <planes> <odometry>"). Fails with 99 if a process hangs, 98 if the machine has no multicast.
set -u
BIN=$1 LOG=$2 OUT=$3 SPEED=$4

if [ -z "${SGRAPHS_NAMESPACE:-}" ]; then
  if unshare -Urn true 2>/dev/null && command -v ip >/dev/null; then
    SGRAPHS_NAMESPACE=own exec unshare -Urn sh "$0" "$@"
  fi
  SGRAPHS_NAMESPACE=host
else
  ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo || exit 98
fi

# A port that belongs to this run even on the host's route; a receive buffer as on a bare machine.
PORT=$((20000 + $$ % 20000))
URL="udpm://239.255.76.68:$PORT?ttl=0&recv_buf_size=212992"
RAW='SESSION|VELODYNE_PACKETS|LIDAR_POINTS|SPOT_ODOMETRY|ROUND_SCHEDULE|STREAM_END'

mkdir -p "$OUT"
STAGES='free-space rooms loops planes odometry'
"$BIN/sgraphs-backend" ${PROCESS_OPTIONS:-} --lcm-url "$URL" -o "$OUT/result" >"$OUT/backend.txt" 2>&1 &
pids=$!
for stage in $STAGES; do
  "$BIN/sgraphs-$stage" ${PROCESS_OPTIONS:-} --lcm-url "$URL" >"$OUT/$stage.txt" 2>&1 &
  pids="$pids $!"
done
trap 'kill -9 $pids 2>/dev/null' EXIT

all_listen() {
  for process in backend $STAGES; do
    grep -q 'listening' "$OUT/$process.txt" || return 1
  done
}
tries=0
until all_listen; do
  tries=$((tries + 1))
  if [ $tries -gt 300 ]; then
    cat "$OUT"/*.txt
    exit 98
  fi
  sleep 0.1
done

lcm-logplayer -s "$SPEED" -e "$RAW" -l "$URL" "$LOG" >"$OUT/player.txt" 2>&1

tries=0
for pid in $pids; do
  while kill -0 "$pid" 2>/dev/null; do
    tries=$((tries + 1))
    [ $tries -gt 1200 ] && exit 99
    sleep 0.1
  done
done
codes=''
for pid in $pids; do
  wait "$pid"
  codes="$codes$? "
done
echo "${codes% }" >"$OUT/codes"
