#!/bin/sh
# A VLP-16's driver on real sockets: packets by UDP in, messages by LCM out, recorded by lcm-logger. In a network
# namespace of its own where the machine allows one.
#   live_driver.sh BIN FILE OUT [options of sgraphs send-packets]
# Leaves OUT/live.lcmlog, OUT/driver.txt, OUT/sender.txt and OUT/code (of the driver, stopped by SIGINT). Fails with 98
# if the machine has no multicast or no port, 99 if the driver hangs.
set -u
BIN=$1 FILE=$2 OUT=$3

if [ -z "${SGRAPHS_NAMESPACE:-}" ]; then
  if unshare -Urn true 2>/dev/null && command -v ip >/dev/null; then
    SGRAPHS_NAMESPACE=own exec unshare -Urn sh "$0" "$@"
  fi
  SGRAPHS_NAMESPACE=host
else
  ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo || exit 98
fi
shift 3

# Ports that belong to this run even on the host's network.
PORT=$((20000 + $$ % 20000))
DATA=$((40000 + $$ % 10000))
URL="udpm://239.255.76.68:$PORT?ttl=0&recv_buf_size=212992"

mkdir -p "$OUT"
lcm-logger -q -f --lcm-url="$URL" "$OUT/live.lcmlog" >"$OUT/logger.txt" 2>&1 &
logger=$!
pids=$logger
trap 'kill -9 $pids 2>/dev/null' EXIT
sleep 1
"$BIN/sgraphs-velodyne-driver" --lcm-url "$URL" --set drivers.velodyne_driver.data_port=$DATA \
  --set drivers.velodyne_driver.position_port=0 --set drivers.velodyne_driver.stamps=device \
  >"$OUT/driver.txt" 2>&1 &
driver=$!
pids="$logger $driver"
tries=0
until grep -q 'listening' "$OUT/driver.txt"; do
  tries=$((tries + 1))
  if [ $tries -gt 300 ] || ! kill -0 $driver 2>/dev/null; then
    cat "$OUT"/*.txt
    exit 98
  fi
  sleep 0.1
done

"$BIN/sgraphs" send-packets "$FILE" --to "127.0.0.1:$DATA" "$@" >"$OUT/sender.txt" 2>&1
sleep 0.5
kill -INT $driver
tries=0
while kill -0 $driver 2>/dev/null; do
  tries=$((tries + 1))
  [ $tries -gt 200 ] && exit 99
  sleep 0.1
done
wait $driver
echo $? >"$OUT/code"
sleep 0.5
kill -INT $logger
wait $logger
exit 0
