#!/usr/bin/env python3
"""Writes expected_track_benchmark.json beside this file: perturbed tracks, and what the definitions of eval/track_benchmark.hpp
give for them, computed by array operations with numpy and apart from the C++ code.

    python3 eval/testing/track_reference.py
"""

import json
import pathlib

import numpy as np


def make_tracks(rng):
    """True tracks, and such that follow them badly: rows (id, t, x, y)."""
    truth, tracks = [], []
    for i in range(24):
        start, length, rows = rng.uniform(0.0, 0.5), rng.uniform(0.4, 2.0), int(rng.integers(5, 60))
        t = np.linspace(start, start + length, rows)
        path = lambda s: np.stack([60 + 40 * np.sin(2 * s + i), 50 + 30 * np.cos(1.5 * s + i)], -1)
        truth.append(np.column_stack([np.full(rows, i), t, path(t)]))
        if i in (7, 19):
            continue  # nothing follows these
        end = start + length * (1.0 if i % 3 == 0 else rng.uniform(0.2, 0.95)) + (0.05 if i % 6 == 0 else 0.0)
        s = np.sort(np.concatenate([[start], rng.uniform(start, end, int(rng.integers(8, 60)))]))
        drift = np.outer((s - start) ** 2, rng.normal(0.0, 12.0 * (i % 5), 2))
        jump = 8.0 * (s > start + rng.uniform(0.0, 1.5) * length)[:, None] * (i % 4 == 1)
        tracks.append(np.column_stack([np.full(len(s), i), s, path(s) + drift + jump + rng.normal(0.0, 0.5, (len(s), 2))]))
    return np.round(np.concatenate(truth), 6), np.round(np.concatenate(tracks), 6)


def line(t, known_t, known):
    """Straight lines through known values, the outermost ones going on."""
    out = np.interp(t, known_t, known)
    first = (known[1] - known[0]) / (known_t[1] - known_t[0])
    last = (known[-1] - known[-2]) / (known_t[-1] - known_t[-2])
    out = np.where(t < known_t[0], known[0] + (t - known_t[0]) * first, out)
    return np.where(t > known_t[-1], known[-1] + (t - known_t[-1]) * last, out)


def errors_of(truth, track):
    at = np.stack([line(truth[:, 0], track[:, 0], track[:, k]) for k in (1, 2)], -1)
    return np.linalg.norm(truth[:, 1:] - at, axis=1)[1:]


def cropped(truth, track, threshold):
    """Relative age and mean error; None if the track does not count."""
    if truth[-1, 0] > track[-1, 0]:
        truth = truth[(truth[:, 0] >= track[0, 0]) & (truth[:, 0] <= track[-1, 0])]
    if len(truth) < 2:
        return None
    error, span = errors_of(truth, track), truth[-1, 0] - truth[0, 0]
    beyond = np.flatnonzero(error > threshold)
    if beyond.size == 0:
        return 1.0, error[1:].mean()
    if beyond[0] <= 1:
        return 0.0, None
    last = beyond[0] - 1
    return (truth[last, 0] - truth[0, 0]) / span, error[1 : last + 1].mean()


def full(truth, track, threshold):
    if track is None:
        return 0.0, None
    error = errors_of(truth, track)
    bad = np.flatnonzero((error > threshold) | (truth[1:, 0] > track[-1, 0]))
    good = bad[0] if bad.size else len(error)
    age = (truth[good, 0] - truth[0, 0]) / (truth[-1, 0] - truth[0, 0])
    return age, error[:good].mean() if good else None


def benchmark(all_truth, all_tracks, of_track):
    inliers, ages, count = [], [], 0
    at_5 = None
    for threshold in range(1, 32):
        results = []
        for i in np.unique(all_truth[:, 0]):
            track = all_tracks[all_tracks[:, 0] == i, 1:]
            if len(track) == 0 and of_track is cropped:
                continue
            result = of_track(all_truth[all_truth[:, 0] == i, 1:], track if len(track) else None, threshold)
            if result is not None:
                results.append(result)
        age = np.array([r[0] for r in results])
        count = len(age)
        inliers.append(np.mean(age > 0))
        ages.append(age[age > 0].mean() if (age > 0).any() else 0.0)
        if threshold == 5:
            at_5 = ages[-1], np.mean([r[1] for r in results if r[0] > 0])
    return {
        "tracks": count,
        "expected_age": np.mean(np.array(inliers) * np.array(ages)),
        "inlier_ratio": np.mean(inliers),
        "age": np.mean(ages),
        "age_5px": at_5[0],
        "error_5px": at_5[1],
    }


truth, tracks = make_tracks(np.random.default_rng(11))
expected = {
    "truth": truth.tolist(),
    "tracks": tracks.tolist(),
    "full": benchmark(truth, tracks, full),
    "cropped": benchmark(truth, tracks, cropped),
}
path = pathlib.Path(__file__).with_name("expected_track_benchmark.json")
path.write_text(json.dumps(expected, separators=(",", ":")) + "\n")
