#!/usr/bin/env bash
# Sets everything up and passes the tests: ./test.sh [release|debug|sanitize]
# Tests of real data need EVBENCH_DATA and EVBENCH_PROBLEMS (README.md); without them they say that they are skipped.
set -euo pipefail
cd "$(dirname "$0")"
preset=${1:-release}
./setup.sh "$preset"
echo "== testing"
ctest --preset "$preset" -j "$(nproc)"
