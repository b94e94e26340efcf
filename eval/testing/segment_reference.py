#!/usr/bin/env python3
"""Reference values of errors over sub-trajectories, as rpg_trajectory_evaluation and KITTI's development kit define them.

    segment_reference.py TRAJECTORIES > expected_segments.json

A slow and literal reading of the published definitions with numpy, which shares nothing with the program. TRAJECTORIES
holds folders with groundtruth.txt and estimate.txt (TUM). Poses are associated as evo does (nearest in time within
0.01 s, stepping through the trajectory with fewer poses), the estimate is aligned by Sim(3) (Umeyama 1991).
"""
import json
import os
import sys

import numpy as np


def read(path):
    rows = np.loadtxt(path)
    poses = []
    for x, y, z, qx, qy, qz, qw in rows[:, 1:]:
        n = np.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
        qx, qy, qz, qw = qx / n, qy / n, qz / n, qw / n
        T = np.eye(4)
        T[:3, :3] = [[1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qz * qw), 2 * (qx * qz + qy * qw)],
                     [2 * (qx * qy + qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qx * qw)],
                     [2 * (qx * qz - qy * qw), 2 * (qy * qz + qx * qw), 1 - 2 * (qx * qx + qy * qy)]]
        T[:3, 3] = x, y, z
        poses.append(T)
    return rows[:, 0], poses


def associate(truth, estimate):
    swap = len(estimate[0]) > len(truth[0])
    short, long = (truth, estimate) if swap else (estimate, truth)
    pairs = []
    for t, T in zip(*short):
        nearest = int(np.argmin(np.abs(long[0] - t)))
        if abs(long[0][nearest] - t) <= 0.01:
            pairs.append((T, long[1][nearest]) if swap else (long[1][nearest], T))
    return [p[0] for p in pairs], [p[1] for p in pairs]


def sim3_scale(truth, estimate):
    x = np.array([T[:3, 3] for T in estimate])
    y = np.array([T[:3, 3] for T in truth])
    x, y = x - x.mean(0), y - y.mean(0)
    U, D, Vt = np.linalg.svd(y.T @ x / len(x))
    S = np.diag([1, 1, np.sign(np.linalg.det(U) * np.linalg.det(Vt))])
    return np.trace(np.diag(D) @ S) / (x ** 2).sum(1).mean()


def distances(poses):
    d = [0.0]
    for a, b in zip(poses, poses[1:]):
        d.append(d[-1] + np.linalg.norm(b[:3, 3] - a[:3, 3]))
    return d


def error(truth, estimate, scale, i, j):
    dt = np.linalg.inv(truth[i]) @ truth[j]
    de = np.linalg.inv(estimate[i]) @ estimate[j]
    de[:3, 3] *= scale
    E = np.linalg.inv(dt) @ de
    angle = np.degrees(np.arccos(min(1.0, max(-1.0, (np.trace(E[:3, :3]) - 1) / 2))))
    return np.linalg.norm(E[:3, 3]), angle


def rpg_pairs(d, length):
    pairs = []
    for i in range(len(d)):
        best, least = -1, 0.2 * length
        for j in range(i, len(d)):
            if abs(d[j] - (d[i] + length)) < least:
                best, least = j, abs(d[j] - (d[i] + length))
        if best != -1:
            pairs.append((i, best))
    return pairs if len(pairs) > 1 else []


def kitti_pairs(d, length):
    pairs = []
    for i in range(0, len(d), 10):
        for j in range(i, len(d)):
            if d[j] > d[i] + length:
                pairs.append((i, j))
                break
    return pairs


def statistics(errors):
    e = np.array(errors)
    return {"rmse": np.sqrt((e ** 2).mean()), "mean": e.mean(), "median": np.median(e), "std": e.std(),
            "min": e.min(), "max": e.max(), "n": len(e)}


def segments(folder, pairs_of, lengths):
    raw_truth, raw_estimate = read(folder + "/groundtruth.txt"), read(folder + "/estimate.txt")
    truth, estimate = associate(raw_truth, raw_estimate)
    scale = sim3_scale(truth, estimate)
    if lengths is None:  # rpg: percentages of the whole ground truth, cut to two decimals
        whole = distances(raw_truth[1])[-1]
        lengths = [int(100 * share * whole) / 100 for share in (0.1, 0.2, 0.3, 0.4, 0.5)]
    d = distances(truth)
    result, all_trans, all_rot = [], [], []
    for length in lengths:
        errors = [error(truth, estimate, scale, i, j) for i, j in pairs_of(d, length)]
        trans, rot = [100 * e[0] / length for e in errors], [e[1] / length for e in errors]
        all_trans, all_rot = all_trans + trans, all_rot + rot
        result.append({"length_m": length, "trans_percent": statistics(trans), "rot_deg_per_m": statistics(rot)})
    return {"trans_percent": statistics(all_trans), "rot_deg_per_m": statistics(all_rot), "by_length": result}


def main():
    root, result = sys.argv[1], {}
    for name in ("mvsec_flying1", "tumvie_desk2", "tumvie_mocap-6dof"):
        folder = os.path.join(root, name)
        result[name] = {"rpg": segments(folder, rpg_pairs, None), "kitti": segments(folder, kitti_pairs, [0.5, 1, 2])}
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
