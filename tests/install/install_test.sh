#!/bin/sh
# Installs into an empty prefix and uses what is there as a stranger would.
#   install_test.sh BUILD SOURCE LOG_WRITER      LOG_WRITER FILE: writes a log with scans 7 and 8 on ODOMETRY
set -eu
BUILD=$1 SOURCE=$2 LOG_WRITER=$3
FOLDER=$(mktemp -d)
trap 'rm -rf "$FOLDER"' EXIT
PREFIX=$FOLDER/prefix
fail() {
  echo "install_test: $*" >&2
  exit 1
}

cmake --install "$BUILD" --prefix "$PREFIX" >"$FOLDER/install.txt" 2>&1 || {
  cat "$FOLDER/install.txt"
  fail "cmake --install failed"
}
# Moved afterwards: nothing in it may hold the place where it was put first.
mv "$PREFIX" "$FOLDER/moved"
PREFIX=$FOLDER/moved
for file in bin/sgraphs bin/sgraphs-backend share/sgraphs/sgraphs.yaml share/sgraphs/lcmtypes/session_t.lcm \
  share/sgraphs/scenes/small_office/plan.json include/sgraphs/session_t.hpp share/doc/sgraphs/README.md; do
  [ -f "$PREFIX/$file" ] || fail "$file is not installed"
done
[ "$(find "$PREFIX/include" -name '*_t.hpp' | wc -l)" = "$(find "$SOURCE/lcmtypes" -name '*.lcm' | wc -l)" ] ||
  fail "headers and .lcm files differ in number"

"$LOG_WRITER" "$FOLDER/run.lcmlog"
"$PREFIX/bin/sgraphs" spy --text --lcm-url "file://$FOLDER/run.lcmlog" | grep -q '^ODOMETRY .* odometry_t .* 2 ' ||
  fail "the installed program does not read a log"

said='scan 7
scan 8'
cmake -S "$SOURCE/tests/install/consumer" -B "$FOLDER/consumer" -DCMAKE_PREFIX_PATH="$PREFIX" >"$FOLDER/cmake.txt" 2>&1 &&
  cmake --build "$FOLDER/consumer" >>"$FOLDER/cmake.txt" 2>&1 || {
  cat "$FOLDER/cmake.txt"
  fail "find_package(sgraphs) does not serve another project"
}
[ "$("$FOLDER/consumer/consumer" "$FOLDER/run.lcmlog")" = "$said" ] || fail "the other project decodes something else"

if command -v pkg-config >/dev/null; then
  PKG_CONFIG_PATH=$(dirname "$(find "$PREFIX" -name sgraphs-lcmtypes.pc)")
  export PKG_CONFIG_PATH
  # shellcheck disable=SC2046
  c++ "$SOURCE/tests/install/consumer/consumer.cpp" -o "$FOLDER/plain" $(pkg-config --cflags --libs sgraphs-lcmtypes)
  [ "$("$FOLDER/plain" "$FOLDER/run.lcmlog")" = "$said" ] || fail "built with pkg-config, it decodes something else"
fi
