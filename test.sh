#!/usr/bin/env bash
# Sets everything up and passes the tests:
#   ./test.sh                 what every commit must pass: the fuzz targets for some seconds each, all tests but the long ones
#   ./test.sh STAGE...        fast       those that take less than half a second, in a minute
#                             long       those that take longer than seven seconds, and 100,000 random sequences, 100 kills
#                             sanitize   all but the long ones and those of the installation with ASan and UBSan
#                             thread     what runs in several threads with ThreadSanitizer
#                             release, debug, clang, fuzz      all but the long ones of that preset
# Tests of real data need EVBENCH_DATA and EVBENCH_PROBLEMS (README.md); without them they say that they are skipped.
set -euo pipefail
cd "$(dirname "$0")"
case ${1:-} in
  -h | --help) sed -n '2,9s/^# //p' test.sh && exit ;;
esac
[ $# -gt 0 ] || set -- fuzz release
failed=()
for stage in "$@"; do
  case $stage in
    fast) preset=release test=(release -L '^fast$') report=() ;;
    long) preset=release test=(long) report=(--for report) ;;
    *) preset=$stage test=("$stage") report=() ;;
  esac
  ./setup.sh --for tests --for figures ${report[@]+"${report[@]}"} "$preset"
  echo "== testing ($stage)"
  ctest --preset "${test[@]}" -j "$(nproc)" || failed+=("$stage")
done
if [ ${#failed[@]} -gt 0 ]; then
  echo "test.sh: tests fail: ${failed[*]}" >&2
  exit 1
fi
