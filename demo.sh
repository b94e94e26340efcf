#!/usr/bin/env bash
# Sets everything up and runs the main jobs: from simulated events to a trajectory; the paper's Table I on a simulated
# sequence and, where the recordings are at hand (EVBENCH_DATA), on real tracks. Writes results/.
set -euo pipefail
cd "$(dirname "$0")"
echo "== On two cores this takes some five minutes the first time, most of them compiling; one minute from then on."
./setup.sh --for figures release evbench
evbench=build/release/bin/evbench

echo "== From events to a trajectory: 10 s before a textured wall, simulated"
"$evbench" run configs/examples/events_to_trajectory.json
echo "== Table I, simulated: 30 s of a robot arm in front of dots"
"$evbench" run configs/paper/table1_simulated.json --report
if [ -n "${EVBENCH_DATA:-}" ]; then
  echo "== Table I, real tracks: poster_translation, seconds 0 to 3.05"
  "$evbench" run configs/paper/table1_poster_translation.json
else
  echo "== EVBENCH_DATA is not set: the comparison on real tracks (configs/paper/table1_poster_translation.json) is left out"
fi

cat <<'END'
== Tables, trajectories and figures in a browser: results/table1_simulated/report.html
== What next:
export PATH=$PWD/build/release/bin:$PATH
evbench table results/table1_simulated --format markdown                           # a table for a paper, again
evbench figure trajectory results/table1_simulated --out trajectories.svg          # and a figure of its runs
evbench sweep configs/examples/simulated_tracks.json --vary seed=1..5 -j 2         # over seeds
END
