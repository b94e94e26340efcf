#!/usr/bin/env python3
"""Scores two trajectory files by every named protocol, and compares with `evbench eval --protocol`.

An independent transcription of the definitions in docs/reference/metrics.md, in numpy.
usage: protocols.py EVBENCH GROUNDTRUTH ESTIMATE [OPTION FOR evbench eval]...
"""
import json
import subprocess
import sys

import numpy as np


class Trajectory:
    """Times [s], positions (n, 3) and rotation matrices (n, 3, 3)."""

    def __init__(self, t, p, R):
        self.t, self.p, self.R = t, p, R

    def take(self, i):
        return Trajectory(self.t[i], self.p[i], self.R[i])


def rotation_matrices(q):
    x, y, z, w = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
                     2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                     2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], 1).reshape(-1, 3, 3)


def read(path, order, microseconds, offset):
    rows = np.loadtxt(path)
    t = rows[:, 0] * 1e-6 if microseconds else rows[:, 0]
    keep = np.concatenate([[True], np.diff(t) > 0])
    q = rows[keep, 4:8]
    if order == "yzwx":
        q = q[:, [3, 0, 1, 2]]
    return Trajectory(t[keep], rows[keep, 1:4], rotation_matrices(q)), offset


def associate(truth, estimate, tolerance, offset):
    """evo's rule: each pose of the shorter trajectory gets the nearest of the longer one."""
    ours = estimate.t + offset
    if len(estimate.t) > len(truth.t):
        steps, others = truth.t - offset, estimate.t
    else:
        steps, others = ours, truth.t
    right = np.clip(np.searchsorted(others, steps), 1, len(others) - 1)
    nearest = np.where(steps - others[right - 1] <= others[right] - steps, right - 1, right)
    fine = np.abs(others[nearest] - steps) <= tolerance
    i, j = np.flatnonzero(fine), nearest[fine]
    return (truth.take(i), estimate.take(j)) if len(estimate.t) > len(truth.t) else (truth.take(j), estimate.take(i))


def umeyama(x, y, with_scale):
    mx, my = x.mean(0), y.mean(0)
    U, d, Vt = np.linalg.svd((y - my).T @ (x - mx) / len(x))
    S = np.diag([1, 1, np.sign(np.linalg.det(U) * np.linalg.det(Vt))])
    scale = np.trace(np.diag(d) @ S) / ((x - mx) ** 2).sum(1).mean() if with_scale else 1.0
    R = U @ S @ Vt
    return scale, R, my - scale * R @ mx


def yaw_only(x, y):
    C = (y - y.mean(0)).T @ (x - x.mean(0))
    a = np.arctan2(C[1, 0] - C[0, 1], C[0, 0] + C[1, 1])
    R = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    return 1.0, R, y.mean(0) - R @ x.mean(0)


def angles(R):
    """Angles of rotation matrices [rad], exact near 0."""
    axis = np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], 1)
    return np.arctan2(np.linalg.norm(axis, axis=1), np.trace(R, axis1=1, axis2=2) - 1)


def relative(truth, estimate, i, j):
    """Translation errors [m] and angles [deg] of the motions from i to j."""
    def motion(a):
        Rt = np.swapaxes(a.R[i], 1, 2)
        return Rt @ a.R[j], (Rt @ (a.p[j] - a.p[i])[:, :, None])[:, :, 0]
    (Rq, pq), (Rp, pp) = motion(truth), motion(estimate)
    return np.linalg.norm(pp - pq, axis=1), np.degrees(angles(np.swapaxes(Rq, 1, 2) @ Rp))


def within_a_second(t):
    pairs = []
    for i, first in enumerate(t):
        j = int(np.argmin(np.abs(t - first - 1.0)))
        if j > i and abs(t[j] - first - 1.0) <= 0.1:
            pairs.append((i, j))
    return pairs


def rmse(x):
    return float(np.sqrt(np.mean(np.square(x)))) if len(x) else None


# Alignment, poses to align on, tolerance [s], relative errors.
everything = ("all", None)
protocols = {
    "evo": ("none", everything, 0.01, "frames"),
    "tum": ("se3", everything, 0.02, "second"),
    "devo": ("sim3", everything, 1.0, None),
    "deio": ("sim3", ("first", 1000), 1.0, None),
    "hku_5s": ("se3", ("seconds", (0, 5)), 0.01, None),
    "eklt_vio": ("yaw", ("seconds", (3, 8)), 0.02, None),
    "evslam": ("se3", everything, 0.001, None),
    "esvo": ("se3", everything, 0.02, "second"),
    "rpg": ("sim3", everything, 0.02, None),
    "kitti": ("none", everything, 0.01, None),
}


def score(name, truth, estimate, offset):
    alignment, (by, which), tolerance, steps = protocols[name]
    path = np.linalg.norm(np.diff(truth.p, axis=0), axis=1).sum()
    truth, estimate = associate(truth, estimate, tolerance, offset)
    t = estimate.t + offset
    chosen = np.ones(len(t), bool)
    if by == "first":
        chosen = np.arange(len(t)) < which
    elif by == "seconds":
        chosen = (t >= t[0] + which[0]) & (t <= t[0] + which[1])
    if alignment == "none":
        scale, R, shift = 1.0, np.eye(3), np.zeros(3)
    elif alignment == "yaw":
        scale, R, shift = yaw_only(estimate.p[chosen], truth.p[chosen])
    else:
        scale, R, shift = umeyama(estimate.p[chosen], truth.p[chosen], alignment == "sim3")
    estimate = Trajectory(t, scale * estimate.p @ R.T + shift, R @ estimate.R)
    distance = np.linalg.norm(estimate.p - truth.p, axis=1)
    rotation = np.degrees(angles(np.swapaxes(estimate.R, 1, 2) @ truth.R))
    turned = estimate.R @ np.swapaxes(truth.R, 1, 2)
    yaw = np.degrees(np.abs(np.arctan2(turned[:, 1, 0], turned[:, 0, 0])))
    result = {"ate.trans_m.rmse": rmse(distance), "ate.trans_m.mean": float(distance.mean()),
              "ate.rot_deg.rmse": rmse(rotation), "mpe_percent": 100 * float(distance.mean()) / path,
              "mre_deg_per_m": float(rotation.mean()) / path, "mye_deg_per_m": float(yaw.mean()) / path,
              "scale": float(scale), "pairs": len(t)}
    if steps:
        pairs = [(i, i + 1) for i in range(len(t) - 1)] if steps == "frames" else within_a_second(t)
        i, j = np.array(pairs).T
        trans, rot = relative(truth, estimate, i, j)
        result["rpe.trans_m.rmse"], result["rpe.rot_deg.rmse"] = rmse(trans), rmse(rot)
    return result


def main():
    program, truth_path, estimate_path, *options = sys.argv[1:]
    given = dict(zip(options[::2], options[1::2]))
    offset = float(given.get("--t_offset", 0))
    truth, _ = read(truth_path, "xyzw", False, 0)
    estimate, _ = read(estimate_path, given.get("--estimate_quaternion", "xyzw"),
                       given.get("--estimate_unit") == "us", offset)
    wrong = 0
    for name in protocols:
        run = subprocess.run([program, "eval", truth_path, estimate_path, "--protocol", name, "--json", "/dev/stdout",
                              *options], capture_output=True, text=True)
        if run.returncode:
            print(f"{name}: {run.stderr.strip()}")
            wrong += 1
            continue
        scores = json.loads(run.stdout)["final"]
        if scores["protocol"] != {"name": name, "custom": []}:
            print(f"{name}: the scores name the protocol {scores['protocol']}")
            wrong += 1
        for key, expected in score(name, truth, estimate, offset).items():
            found = scores
            for part in key.split("."):
                found = found[part]
            if not abs(found - expected) <= 1e-9 * max(1.0, abs(expected)):
                print(f"{name}: {key} is {found}, numpy has {expected}")
                wrong += 1
    print(f"{len(protocols)} protocols, {wrong} differences")
    sys.exit(1 if wrong else 0)


main()
