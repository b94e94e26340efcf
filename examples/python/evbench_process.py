"""The loop of a back-end or front-end in Python for evbench (docs/reference/process_protocol.md), to be imported.

    import evbench_process
    hello = evbench_process.hello()             # camera, options, seed, ...
    def take(message): ...                      # returns the answer, a dictionary
    def finish(): ...                           # returns the last answer
    evbench_process.serve("my name", take, finish)
"""
import json, sys

answers, sys.stdout = sys.stdout, sys.stderr  # print() writes to the log, not between the answers

def hello():
    """Reads the opening message of evbench; call it once, before serve()."""
    return json.loads(sys.stdin.readline())

def say(answer): print(json.dumps(answer), file=answers, flush=True)

def serve(name, take, finish):
    """Answers each message by take(message) until there are no more, then by finish()."""
    say({"evbench": 1, "name": name})
    for message in map(json.loads, sys.stdin):
        if "finish" in message: break
        say(take(message))
    say(finish())

def run_backend(name, make):
    """A back-end with numpy arrays. make(hello) returns an object with
        take(until, tracks, times, pixels, sigmas)   n, n, n x 2, n: the new observations; returns new poses, m x 8
        finish()                                     returns the final trajectory, m x 8
    A pose is t, position and quaternion (x y z w) of the camera in the world. There is a map once it has a pose."""
    import numpy as np
    back_end, known = make(hello()), False
    def rows(poses): return np.asarray(poses, float).reshape(-1, 8).tolist()
    def take(message):
        nonlocal known
        z = np.array(message["observations"], float).reshape(-1, 5)
        poses = rows(back_end.take(message["until"], z[:, 0].astype(int), z[:, 1], z[:, 2:4], z[:, 4]))
        known = known or bool(poses)
        return {"state": "tracking" if known else "no_map", "causal_poses": poses, **({"newest": poses[-1]} if poses else {})}
    serve(name, take, lambda: {"trajectory": rows(back_end.finish()), "map": []})
