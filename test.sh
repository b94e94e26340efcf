#!/usr/bin/env bash
# Sets everything up and passes the tests: ./test.sh [release|debug|sanitize|fuzz]...; without a name, fuzz and release.
# Tests of real data need EVBENCH_DATA and EVBENCH_PROBLEMS (README.md); without them they say that they are skipped.
set -euo pipefail
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- fuzz release
failed=()
for preset in "$@"; do
  ./setup.sh "$preset"
  echo "== testing (preset $preset)"
  ctest --preset "$preset" -j "$(nproc)" || failed+=("$preset")
done
if [ ${#failed[@]} -gt 0 ]; then
  echo "test.sh: tests fail: ${failed[*]}" >&2
  exit 1
fi
