#!/usr/bin/env python3
"""Runs the trackers from true corners in five simulated sequences, and joins their tracks.

An experiment of results/reference/experiments.json. In the root of the repository, with evbench in PATH, it writes
results/track_benchmark: a run for each sequence and tracker, and tracks/true.txt and tracks/TRACKER.txt for evbench
eval-tracks, with the tracks of all sequences (ids of the n-th start at n * 100,000).
"""

import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
FOLDER = pathlib.Path("results/track_benchmark")
TRACKERS = ["correlation", "haste_correlation", "haste_correlation_star", "haste_difference", "haste_difference_star", "poisson",
            "str"]
SEQUENCES = [("shapes", 0.4, 0), ("shapes", 0, 0.3), ("shapes", 0.3, 0.2), ("boxes", 0.4, 0), ("boxes", 0, 0.3)]


def shifted(path, sequence):
    for line in path.read_text().splitlines():
        identity, rest = line.split(" ", 1)
        yield f"{int(identity) + 100000 * sequence} {rest}\n"


def settings(values):
    return [word for key, value in values.items() for word in ("--set", f"{key}={value}")]


def tracks_of(label):
    found = [path.parent / "tracks.txt" for path in FOLDER.glob("*/config.json")
             if json.loads(path.read_text())["backend"]["label"] == label]
    assert len(found) == 1, f"{label}: {len(found)} runs in {FOLDER}, expected one"
    return found[0]


def main():
    joined = FOLDER / "tracks"
    joined.mkdir(parents=True, exist_ok=True)
    config = [str(HERE / "track_benchmark.config.json")]
    lines = {name: [] for name in ["true", *TRACKERS]}
    for n, (scene, amplitude, rotation) in enumerate(SEQUENCES):
        sequence = settings({"source.scene.kind": scene, "source.motion.amplitude": amplitude,
                             "source.motion.rotation_amplitude": rotation})
        seeds = joined / f"true_{n}.txt"
        subprocess.run(["evbench", "export", *config, *sequence, "--tracks", seeds, "--force"], check=True,
                       stdout=subprocess.DEVNULL)
        lines["true"] += shifted(seeds, n)
        for tracker in TRACKERS:
            label = f"{scene}, translation {amplitude}, rotation {rotation}, {tracker}"
            kind = {"frontend.type": tracker} if tracker in ("poisson", "str") else {"frontend.variant": tracker}
            made = subprocess.run(["evbench", "run", *config, *sequence, "--tracks", "--quiet",
                                   *settings({"backend.label": label, "frontend.seeds": str(seeds.resolve()), **kind})])
            if made.returncode not in (0, 3):  # 3: the back-end failed, which does not concern the tracks
                return made.returncode
            lines[tracker] += shifted(tracks_of(label), n)
    for name, tracks in lines.items():
        (joined / f"{name}.txt").write_text("".join(tracks))
    return 0


sys.exit(main())
