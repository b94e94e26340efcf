#!/usr/bin/env bash
# Sets everything up and runs the main jobs: from simulated events to a trajectory; the paper's Table I on a simulated
# sequence and, where the recordings are at hand (EVBENCH_DATA), on real tracks. Writes results/.
set -euo pipefail
cd "$(dirname "$0")"
./setup.sh release evbench
evbench=build/release/bin/evbench

echo "== From events to a trajectory: 10 s before a textured wall, simulated"
"$evbench" run configs/examples/events_to_trajectory.json
echo "== Table I, simulated: 30 s of a robot arm in front of dots"
"$evbench" run configs/paper/table1_simulated.json
if [ -n "${EVBENCH_DATA:-}" ]; then
  echo "== Table I, real tracks: poster_translation, seconds 0 to 3.05"
  "$evbench" run configs/paper/table1_poster_translation.json
else
  echo "== EVBENCH_DATA is not set: the comparison on real tracks (configs/paper/table1_poster_translation.json) is left out"
fi
