"""A front-end for evbench (docs/reference/process_protocol.md): tracks the centres of dots from one window of events to the next."""
import os, sys
import numpy as np

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))
import evbench_process

hello = evbench_process.hello()
size = np.array([hello["camera"]["width"], hello["camera"]["height"]])
options = {"window": 0.01, "radius": 6.0, "sigma": 0.4, "most": 60, **hello["options"]}
window, radius = options["window"], options["radius"]
tracks, made = {}, 0  # number -> [centre, velocity in pixels a window, quiet windows]

def centre_near(place, xy, on):  # of a dot: its leading and trailing edges cause events of opposite polarity
    for _ in range(2):
        near = np.square(xy - place).sum(axis=1) < radius**2
        bright, dark = near & on, near & ~on
        if bright.sum() < 4 or dark.sum() < 4: return None, near
        place = (xy[bright].mean(axis=0) + xy[dark].mean(axis=0)) / 2
    return place, near

def follow(t, xy, on):  # one window that ends at t: observations and ended tracks
    global made
    observations, ended, free = [], [], np.ones(len(xy), bool)
    for number, (centre, velocity, quiet) in list(tracks.items()):
        found, near = centre_near(centre + velocity, xy, on)
        free &= ~near
        crowded = any(k < number and np.abs(other[0] - centre).max() < radius for k, other in tracks.items())
        outside = (np.minimum(centre, size - centre) < radius).any()
        if crowded or outside or (found is None and quiet >= 5):
            ended.append([number, t])
            del tracks[number]
        elif found is None and len(xy) > 50:  # fewer: the camera is at rest, and so are the tracks
            tracks[number] = [centre + velocity, velocity, quiet + 1]
        elif found is not None:
            tracks[number] = [found, 0.5 * velocity + 0.5 * (found - centre) if quiet == 0 else velocity, 0]
            # The centre is at the middle of the window; extrapolate it to its end.
            observations.append([number, t, *(found + velocity / 2), options["sigma"]])
    counts = np.histogram2d(*xy[free].T, bins=size // 8, range=[[0, size[0]], [0, size[1]]])[0]
    for cell in np.argsort(-counts, axis=None)[: options["most"] - len(tracks)]:
        if counts.flat[cell] < 10: break
        found, near = centre_near((np.array(np.unravel_index(cell, counts.shape)) + 0.5) * 8, xy[free], on[free])
        if found is None or (np.minimum(found, size - found) < 2 * radius).any(): continue
        if any(np.linalg.norm(other[0] - found) < 2 * radius for other in tracks.values()): continue
        made += 1
        tracks[made] = [found, np.zeros(2), 0]
        observations.append([made, t, *found, options["sigma"]])
    return observations, ended

def take(message):
    global events, end
    events += message["events"]
    observations, ended = [], []
    while end <= message["until"]:
        table = np.array(events).reshape(-1, 4)
        count = np.searchsorted(table[:, 0], end, side="right")
        new, gone = follow(end, table[:count, 1:3], table[:count, 3] > 0)
        observations, ended, events = observations + new, ended + gone, events[count:]
        end += window
    return {"observations": observations, "ended": ended}

def finish(): return {"remarks": [f"{made} tracks"]}

events, end = [], hello["range"][0] + window
evbench_process.serve("centres of dots", take, finish)
