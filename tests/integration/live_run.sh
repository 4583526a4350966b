#!/bin/sh
# `sgraphs run` of a log, in a network namespace of its own where the machine allows one, while one of its processes is
# ill-treated.
#   live_run.sh BIN LOG OUT TREATMENT PROCESS [ARGUMENT…]      BIN: folder of the programs
# TREATMENT: none; stutter (PROCESS is stopped for a moment, again and again); kill (kill -9 to each of PROCESS,PROCESS,… in
# turn, 1.5 s apart); interrupt (SIGINT to `sgraphs run` after 4 s). ARGUMENTs go to `sgraphs run`.
# Leaves OUT/run.txt (stdout and stderr), OUT/code, OUT/result and OUT/recording. Fails with 99 if it hangs, 98 if the
# machine has no multicast.
set -u
BIN=$1 LOG=$2 OUT=$3 TREATMENT=$4 PROCESS=$5

if [ -z "${SGRAPHS_NAMESPACE:-}" ]; then
  if unshare -Urn true 2>/dev/null && command -v ip >/dev/null; then
    SGRAPHS_NAMESPACE=own exec unshare -Urn sh "$0" "$@"
  fi
  SGRAPHS_NAMESPACE=host
else
  ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo || exit 98
fi
shift 5

PORT=$((20000 + $$ % 20000))
URL="udpm://239.255.76.69:$PORT?ttl=0&recv_buf_size=4000000"
# A process is stopped for no longer than its receive buffer holds what comes meanwhile.
STOP=0.6
[ "$(cat /proc/sys/net/core/rmem_max)" -ge 2000000 ] || STOP=0.3
mkdir -p "$OUT"
"$BIN/sgraphs" run --log "$LOG" --record "$OUT/recording" -o "$OUT/result" --lcm-url "$URL" "$@" \
  >"$OUT/run.txt" 2>&1 &
RUN=$!
trap 'kill -9 $RUN 2>/dev/null' EXIT

# Process id of the run's child PROCESS; empty: it is not there.
child() {
  for pid in $(cat "/proc/$RUN/task/$RUN/children" 2>/dev/null); do
    case $(readlink "/proc/$pid/exe") in */sgraphs-"$PROCESS") echo "$pid" ;; esac
  done
}
streams() { [ -s "$OUT"/recording/*.lcmlog ] 2>/dev/null && [ -e "$OUT/result/log/player.txt" ]; }

tries=0
until streams; do
  tries=$((tries + 1))
  if [ $tries -gt 400 ] || ! kill -0 $RUN 2>/dev/null; then break; fi
  sleep 0.1
done
case $TREATMENT in
  stutter)
    while kill -0 $RUN 2>/dev/null && ! grep -q 'ending:' "$OUT/run.txt"; do
      kill -STOP "$(child)" 2>/dev/null
      sleep $STOP
      kill -CONT "$(child)" 2>/dev/null
      sleep 0.2
    done
    ;;
  kill)
    for PROCESS in $(echo "$PROCESS" | tr , ' '); do
      sleep 1.5
      kill -9 "$(child)"
    done
    ;;
  interrupt)
    sleep 4
    kill -INT $RUN
    ;;
esac

tries=0
while kill -0 $RUN 2>/dev/null; do
  tries=$((tries + 1))
  [ $tries -gt 1800 ] && exit 99
  sleep 0.1
done
wait $RUN
echo $? >"$OUT/code"
