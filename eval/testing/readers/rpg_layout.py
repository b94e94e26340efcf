"""Reads a result folder as rpg_trajectory_evaluation does: columns of numbers with comments, an association of the nearest
stamps within 0.02 s, eval_cfg.yaml; aligns by Umeyama's Sim(3). Prints the absolute error as JSON."""
import json
import os
import sys

import numpy as np

folder = sys.argv[1]
truth = np.loadtxt(os.path.join(folder, "stamped_groundtruth.txt"))
estimate = np.loadtxt(os.path.join(folder, "stamped_traj_estimate.txt"))
assert truth.shape[1] == 8 and estimate.shape[1] == 8
assert np.allclose(np.linalg.norm(estimate[:, 4:], axis=1), 1)
config = {}
for line in open(os.path.join(folder, "eval_cfg.yaml")):
    key, value = line.split(":")
    config[key] = int(value) if key == "align_num_frames" else value.strip()

# Each estimate with the nearest ground truth, each of which is used once: the nearest pairs first.
nearest = np.abs(truth[:, None, 0] - estimate[None, :, 0]).argmin(axis=0)
apart = np.abs(truth[nearest, 0] - estimate[:, 0])
pairs, used = [], set()
for e in np.argsort(apart, kind="stable"):
    if apart[e] < 0.02 and nearest[e] not in used:
        used.add(nearest[e])
        pairs.append((nearest[e], e))
pairs.sort()
p, q = truth[[t for t, _ in pairs], 1:4], estimate[[e for _, e in pairs], 1:4]

# Umeyama 1991: p = s R q + t
p0, q0 = p - p.mean(axis=0), q - q.mean(axis=0)
u, d, v = np.linalg.svd(p0.T @ q0 / len(p))
sign = np.diag([1, 1, np.sign(np.linalg.det(u) * np.linalg.det(v))])
rotation = u @ sign @ v
scale = np.trace(np.diag(d) @ sign) / (q0**2).sum(axis=1).mean()
errors = np.linalg.norm(p0 - scale * q0 @ rotation.T, axis=1)
print(json.dumps({**config, "pairs": len(pairs), "rmse": float(np.sqrt((errors**2).mean()))}))
