"""A back-end for evbench (docs/reference/process_protocol.md): batches of observations, an initial map from two views, resection."""
import os, sys
import numpy as np

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))
import evbench_process

HOME = (np.eye(3), np.zeros(3))  # a pose is (R, t) with x_camera = R x_world + t

def rotation(w):  # Rodrigues' formula
    a, K = np.linalg.norm(w) / np.pi, np.cross(np.eye(3), w)
    return np.eye(3) + np.sinc(a) * K + 0.5 * np.sinc(a / 2) ** 2 * K @ K

def stamped(t, pose):  # the camera in the world, with a quaternion, as evbench takes it
    R, d = pose[0].T, np.diag(pose[0])
    q = np.sqrt(np.maximum(np.append(1 + 2 * d - d.sum(), 1 + d.sum()), 0)) / 2
    return [t, *(-R @ pose[1]), *np.copysign(q, [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 1])]

def triangulate(views):  # linear, of [(pose, ray), ...]
    rows = [x[k] * np.append(R[2], t[2]) - np.append(R[k], t[k]) for (R, t), x in views for k in (0, 1)]
    X = np.linalg.svd(np.array(rows))[2][3]
    return X[:3] / X[3]

def two_views(a, b):  # eight points, RANSAC: the pose of b if a's is HOME, the points, and which are in front of both
    N = np.diag([2, 2, 1])  # gives all columns about the same magnitude
    rows, results = np.array([np.kron(N @ [*q, 1], N @ [*p, 1]) for p, q in zip(a, b)]), []
    fits = [np.linalg.svd(rows[random.choice(len(a), 8, replace=False)])[2][8] for _ in range(100)]
    best = min(fits, key=lambda E: np.median(np.abs(rows @ E)))
    E = np.linalg.svd(rows[np.argsort(np.abs(rows @ best))[: int(0.8 * len(a))]])[2][8]
    U, _, V = np.linalg.svd(N @ E.reshape(3, 3) @ N)
    W = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    for R, t in [(U @ w @ V, s * U[:, 2]) for w in (W, W.T) for s in (1, -1)]:
        pose = (R * np.linalg.det(R), t)
        X = np.array([triangulate([(HOME, p), (pose, q)]) for p, q in zip(a, b)])
        results.append((pose, X, (X[:, 2] > 0) & ((X @ pose[0].T + t)[:, 2] > 0)))
    return max(results, key=lambda result: result[2].sum())

def resect(frame, pose):  # Gauss-Newton on the reprojection errors with Huber's loss; None with too few landmarks
    known = [k for k in frame if k in points]
    X, x = np.array([points[k] for k in known]), np.array([frame[k] for k in known])
    for _ in range(10 if len(known) >= 6 else 0):
        P = X @ pose[0].T + pose[1]
        r, z, w = P[:, :2] / P[:, 2:] - x, P[:, 2], np.zeros((len(P), 2, 3))
        w[:, 0, 0] = w[:, 1, 1] = 1 / z
        w[:, :, 2] = -P[:, :2] / z[:, None] ** 2
        J = np.concatenate([w @ np.cross(np.eye(3), -P[:, None]), w], axis=2)
        weight = np.minimum(1, 2 * noise / np.maximum(np.linalg.norm(r, axis=1), 1e-12))
        A, b = np.einsum("n,nij,nik->jk", weight, J, J), np.einsum("n,nij,ni->j", weight, J, r)
        d = -np.linalg.solve(A + 1e-9 * np.eye(6), b)
        pose = (rotation(d[:3]) @ pose[0], rotation(d[:3]) @ pose[1] + d[3:])
        if np.abs(d).max() < 1e-8: break
    if len(known) < 6: return None
    error = np.linalg.norm(r, axis=1)
    for i in np.flatnonzero(error > max(6 * noise, 4 * np.median(error))):
        outliers.append(known[i]), points.pop(known[i])
    return pose

def locate(track):  # triangulates a landmark from up to 16 poses, if their views differ by 2 degrees
    seen = [i for i, frame in enumerate(frames) if track in frame]
    views = [(poses[seen[i]], frames[seen[i]][track]) for i in {j * (len(seen) - 1) // 15: 0 for j in range(16)}]
    rays = [R.T @ [*x, 1] / np.linalg.norm([*x, 1]) for (R, _), x in views]
    X = triangulate(views) if min(rays[0] @ ray for ray in rays) < np.cos(0.035) else None
    if X is not None and track not in outliers and all((R @ X + t)[2] > 0 for (R, t), _ in views): points[track] = X

def refine(rounds):  # points and poses alternately
    for _ in range(rounds):
        for k in list(points): locate(k)
        poses[:] = [resect(frame, pose) or pose for frame, pose in zip(frames, poses)]

def start():  # an initial map from the oldest and the newest frame, once their images differ enough
    both = sorted(frames[0].keys() & frames[-1].keys())
    if len(both) < 15: del frames[:-1], times[:-1]
    a, b = (np.array([frame[k] for k in both]).reshape(-1, 2) for frame in (frames[0], frames[-1]))
    if len(both) < 15 or np.median(np.linalg.norm(a - b, axis=1)) < 0.1: return
    pose, X, front = two_views(a, b)
    to_b = X + pose[0].T @ pose[1]  # from the second camera
    cosines = np.sum(X * to_b, axis=1) / np.linalg.norm(X, axis=1) / np.linalg.norm(to_b, axis=1)
    if front.mean() < 0.8 or np.median(cosines) > np.cos(0.07): return
    points.update((k, x) for k, x, ok in zip(both, X, front) if ok)
    poses.append(HOME)
    for frame in frames[1:]: poses.append(resect(frame, poses[-1]) or poses[-1])
    refine(10)

def step(t, frame):  # a new frame
    times.append(t), frames.append(frame)
    if not poses: start()
    else:
        pose = resect(frame, poses[-1])
        poses.append(pose or poses[-1])
        for k in sorted(frame) if pose else []: locate(k)
        alone.append(t) if pose is None else alone.clear()

def state():
    if alone: return "lost" if times[-1] - alone[0] > hello["patience"] else "degraded"
    return "tracking" if poses else "no_map"

def take(message):
    causal, dropped = [], len(outliers)
    for track, t, u, v, _ in message["observations"]:
        ray = t, (u - c["cx"]) / c["fx"], (v - c["cy"]) / c["fy"]
        sums.setdefault(int(t / width), {}).setdefault(track, []).append(ray)
    for i in [i for i in sorted(sums) if (i + 1) * width <= message["until"]]:
        centre = (i + 0.5) * width
        lines = {k: np.array(x) - [centre, 0, 0] for k, x in sums.pop(i).items()}  # where each track is at that time:
        step(centre, {k: np.polyfit(x[:, 0], x[:, 1:], 1)[1] for k, x in lines.items() if x[0, 0] < 0 < x[-1, 0]})
        causal += [stamped(times[-1], poses[-1])] if poses else []
    newest = {"newest": causal[-1]} if causal else {}
    return {"state": state(), "causal_poses": causal, "outliers": outliers[dropped:], **newest}

def finish():
    refine(3)
    return {"trajectory": [stamped(*pose) for pose in zip(times, poses)], "map": [[k, *X] for k, X in points.items()]}

hello = evbench_process.hello()
c, width = hello["camera"], hello["options"].get("frame", 0.05)
random = np.random.default_rng(hello["seed"])
noise = hello["options"].get("noise", 1.0) / c["fx"]
times, frames, poses, points, alone, sums, outliers = [], [], [], {}, [], {}, []
evbench_process.serve("two views and resection", take, finish)
