#!/usr/bin/python3
"""Makes reports of invented runs, for the tests of the page: development only.

generate.py --out FOLDER: many.html (100 runs of 60 s), long.html (10 minutes), no_truth.html, failed.html (a sweep of
which all runs failed), hostile.html (names with HTML in them), empty.html (no runs), figures.html (all kinds of marks).
"""
import argparse
import os

import numpy as np

from columns import f32, i16, write_page

HERE = os.path.dirname(os.path.abspath(__file__))


def fact(name, value):
    return {"name": name, "value": value}


class Generator:
    def __init__(self, seed, exact=False):
        self.random = np.random.default_rng(seed)
        self.column = f32 if exact else i16

    def columns(self, values):
        return [self.column(values[:, k]) for k in range(values.shape[1])]

    def motion(self, t, phases):
        p = np.stack([np.sin(t * 0.5 + phases[0]) + 0.3 * np.sin(1.7 * t), np.cos(t * 0.4 + phases[1]), 0.4 * np.sin(0.9 * t + phases[2])], -1)
        half = 0.5 * np.stack([0.3 * np.sin(0.7 * t), 0.4 * np.cos(0.5 * t), 0.9 * np.sin(0.3 * t)], -1)
        angle = np.linalg.norm(half, axis=1, keepdims=True)
        q = np.hstack([half * np.sinc(angle / np.pi), np.cos(angle)])
        return p, q

    def trajectory(self, t, p, q, error=None):
        v = np.gradient(p, t, axis=0)
        w = 2 * np.gradient(q[:, :3], t, axis=0)
        result = {"t": {"from": float(t[0]), "step": float(t[1] - t[0]), "n": len(t)}, "p": self.columns(p), "q": self.columns(q),
                  "v": self.columns(v), "w": self.columns(w)}
        if error is not None:
            result["error_m"] = self.column(np.linalg.norm(error, axis=1))
            result["error_deg"] = self.column(20 * np.linalg.norm(error, axis=1))
        return result

    def smooth(self, n, size):
        steps = self.random.normal(size=(n, 3))
        return size * (np.cumsum(steps, axis=0) - np.linspace(0, 1, n)[:, None] * steps.sum(0)) / np.sqrt(n)

    def sequence(self, name, duration, samples, truth=True):
        t = np.linspace(0, duration, samples)
        p, q = self.motion(t, self.random.uniform(0, 6, 3))
        return {"name": name, "from": 0, "to": duration, "ground_truth": self.trajectory(t, p, q) if truth else None}, (t, p, q)

    def run(self, name, label, sequence, number, data, size, state="ok", tracks=100, landmarks=100, lean=False):
        t, p, q = data
        duration = t[-1]
        failed = state == "failed"
        end = len(t) if state != "lost" else int(0.7 * len(t))
        error = self.smooth(len(t), size)
        known = sequence["ground_truth"] is not None
        sigma = size * np.sqrt(np.linspace(0.05, 1, len(t)))[:, None] * np.ones((1, 3))
        few = np.arange(0, end, 4 if lean else 1)
        estimate = self.trajectory(t[:end], (p + error)[:end], q[:end], error[:end] if known else None)
        begin = np.sort(self.random.uniform(0, duration, tracks))
        pieces = [(i, a, min(duration, a + self.random.exponential(3)), 0) for i, a in enumerate(begin)]
        pieces += [(i, b + 0.5, min(duration, b + 2.5), 1) for i, _, b, _ in pieces[::6] if b + 0.5 < duration]
        pieces = np.array(pieces)
        grid = np.linspace(0, duration, 150 if lean else min(len(t), 300))
        live = ((grid[:, None] >= pieces[None, :, 1]) & (grid[:, None] <= pieces[None, :, 2])).sum(1).astype(float)
        points = self.random.normal(size=(landmarks, 3)) * [2, 2, 0.3] + [0, 0, 3]
        events = [{"t": 0.4, "kind": "initialised", "text": "initial map: 53 landmarks, 975 observations"},
                  {"t": 0.21 * duration, "kind": "hypothesis_accepted", "text": "a better alternative estimate of everything, by 94.5"}]
        if state == "lost":
            events.append({"t": float(t[end - 1]), "kind": "lost", "text": "fewer than 3 landmarks in view for more than 1 s"})
        reason = {"ok": "", "lost": "fewer than 3 landmarks in view for more than 1 s", "failed": "never initialised: median parallax 1.60 deg, 4.00 needed",
                  "degraded": "5 landmarks in view, 6 needed"}[state]
        updates = np.linspace(0, duration, 150 if lean else min(len(t), 400))
        return {
            "name": name, "label": label, "experiment": "invented", "folder": f"results/invented/{label}-{number}", "key": f"{label}-{number}",
            "sequence": number, "settings": [fact("seed", "1")], "state": state, "reason": reason,
            "time": None if state == "ok" else float(t[end - 1]), "alignment": "Sim(3), scale 2.4" if known and not failed else "",
            "scores": [] if failed or not known else [fact("ATE", f"{np.sqrt((error[:end] ** 2).sum(1).mean()):.4g} m")],
            "segments": [] if failed else [{"from": 0, "to": float(t[end - 1]), "scored": True, "note": "", "poses": 100 * int(duration), "estimate": estimate,
                                             "landmarks": [f32(points[:, k]) for k in range(3)], "landmarks_total": 10 * landmarks}],
            "causal": None if failed or lean else self.trajectory(t[:end], (p + 1.5 * error)[:end], q[:end], 1.5 * error[:end] if known else None),
            "newest": None if failed else {"t": self.column(t[few]), "p": self.columns((p + error)[few]), "q": self.columns(q[few]), "sigma_m": self.columns(sigma[few]),
                                           "sigma_deg": self.columns(20 * sigma[few]),
                                           **({"error_m": self.columns(error[few]), "error_deg": self.columns(20 * error[few])} if known else {})},
            "control_times": None if failed else {"from": 0, "step": 0.5, "n": int(2 * t[end - 1])},
            "periods": [{"kind": "degraded", "from": 0.4 * duration, "to": 0.45 * duration, "text": "5 landmarks in view, 6 needed"}] if state == "degraded" else [],
            "events": [] if failed else events,
            "tracks": {"total": 10 * tracks, **{key: self.column(pieces[:, k]) for k, key in enumerate(["row", "from", "to", "reacquired"])},
                       "live_t": self.column(grid), "live": self.column(live)},
            "updates": {"total": 20 * int(duration), "t": self.column(updates), "ms": f32(10 ** self.random.normal(1, 0.3, len(updates))),
                        "states": self.column(np.linspace(0, 1200, len(updates))), "landmarks": self.column(np.linspace(0, 2000, len(updates)))},
            "parameters": None if failed else {"t": self.column(updates), "columns": [
                {"name": f"qc_{kind}_{axis}", "unit": "", "values": self.column(10 ** self.smooth(len(updates), 1)[:, 0])} for kind in ("rotation", "translation") for axis in "xyz"]},
            "log": "".join(f"{0.5 * i:.3f} s: message {i} of {name}\n" for i in range(30)) + f"status: {state} {reason}\n", "config": "",
        }


def table(runs, ates):
    rows = []
    for i, (run, ate) in enumerate(zip(runs, ates)):
        ok = run["state"] != "failed"
        number = lambda value, text: {"text": text.format(value), "value": float(value)} if ok else "-"
        rows.append({"runs": [i], "cells": [run["label"], str(run["sequence"]), number(ate, "{:.4f}"), number(3 * ate, "{:.3f}"), number(0.1 * ate, "{:.5f}"),
                                            number(99.5, "{:.1f}"), number(20 / (i + 1), "{:.2f}"), run["state"] + (f" at {run['time']:.2f} s" if run["time"] else "")]})
    best = min((row["cells"][2]["value"] for row in rows if isinstance(row["cells"][2], dict)), default=None)
    for row in rows:
        if isinstance(row["cells"][2], dict) and row["cells"][2]["value"] == best:
            row["cells"][2]["best"] = True
    headers = [("run", False), ("sequence", True), ("ATE [m]", True), ("ATE [deg]", True), ("RPE [m]", True), ("covered [%]", True), ("real-time factor", True), ("status", False)]
    return {"title": "All runs", "file": "runs", "columns": [{"header": header, "number": number} for header, number in headers], "rows": rows,
            "notes": ["Bold: the best of a column among runs of one sequence, seed and protocol."]}


def payload(title, sequences, runs, tables, figures=()):
    return {"format": "evbench.report", "version": 1, "title": title, "created": "2026-11-29T05:37:50Z", "program": "evbench 1.0.0 (invented)",
            "command": "generate.py", "about": [fact("description", "invented runs for tests of the page")],
            "protocol": ["Sim(3) alignment on all poses; interpolated ground truth within 0.01 s."], "remarks": [],
            "tables": tables, "figures": list(figures), "sequences": sequences, "runs": runs}


def axis(label, scale="linear", share=False, ends=()):
    return {"label": label, "scale": scale, "share": share, "ends": list(ends)}


def mark(kind, series, x=(), y=(), low=(), high=(), runs=None):
    return {"kind": kind, "series": series, "x": list(x), "y": list(y), "low": list(low), "high": list(high), **({"runs": runs} if runs is not None else {})}


def panel(x, y, marks, names=(), title="", equal=False):
    return {"x": x, "y": y, "marks": list(marks), "names": list(names), "title": title, "equal": equal}


def figure(panels, series, caption, columns=1, height=64.0):
    return {"width_mm": 174.0, "height_mm": height, "columns": columns, "legend": True, "alike": False, "caption": caption,
            "series": [{"label": label, "truth": False, "number": i} for i, label in enumerate(series)], "panels": list(panels)}


def sweep_figure(runs, methods, ates):
    """A method's runs over the sequences, as a sweep's figure."""
    marks = []
    for m, method in enumerate(methods):
        own = [i for i, run in enumerate(runs) if run["label"] == method]
        x = [run["sequence"] + 1 for run in runs if run["label"] == method]
        good = [i for i in own if runs[i]["state"] in ("ok", "degraded")]
        if len(own) == len(good):
            marks.append(mark("band", m, x, [], [0.8 * ates[i] for i in own], [1.2 * ates[i] for i in own]))
        marks.append(mark("points", m, x, [ates[i] if i in good else None for i in own], runs=[[i] for i in own]))
        bad = [i for i in own if i not in good]
        if bad:
            marks.append(mark("failures", m, [runs[i]["sequence"] + 1 for i in bad], [], [1] * len(bad), [1] * len(bad), runs=[[i] for i in bad]))
    return {"title": "ATE over the sequences", "file": "sweep", "figure": figure([panel(axis("sequence", ends=[1, 10]), axis("ATE [m]", "log"), marks)], methods, "Invented numbers.")}


def many(template, out):
    generator = Generator(1)
    sequences, data = zip(*(generator.sequence(f"sequence {i}", 60.0, 400) for i in range(10)))
    methods = [f"method {m}" for m in range(10)]
    runs, ates = [], []
    for m, label in enumerate(methods):
        for s in range(10):
            size = 0.02 * (m + 1)
            state = "lost" if (m, s) in ((9, 3), (8, 8)) else "failed" if (m, s) == (9, 9) else "degraded" if (m, s) == (5, 5) else "ok"
            runs.append(generator.run(f"{label}, sequence {s}", label, sequences[s], s, data[s], size, state, lean=True))
            ates.append(size * (1 + 0.1 * s))
    write_page(template, payload("invented: 100 runs", list(sequences), runs, [table(runs, ates)], [sweep_figure(runs, methods, ates)]), os.path.join(out, "many.html"))


def single(template, out, name, duration, samples, truth=True, states=("ok", "degraded"), title=None, labels=("gp_map", "bundle_adjustment"), exact=True, tracks=800):
    generator = Generator(2, exact)
    sequence, data = generator.sequence("sequence 0", duration, samples, truth)
    runs = [generator.run(label, label, sequence, 0, data, 0.03 * (i + 1), states[i % len(states)], tracks=tracks, landmarks=2000) for i, label in enumerate(labels)]
    ates = [0.03 * (i + 1) for i in range(len(runs))]
    figures = [sweep_figure(runs, list(labels), ates)] if name in ("failed", "hostile") else []
    write_page(template, payload(title or f"invented: {name}", [sequence], runs, [table(runs, ates)], figures), os.path.join(out, f"{name}.html"))


def all_marks(template, out):
    random = np.random.default_rng(3)
    x = np.linspace(0, 10, 50)
    grid = [(a, b) for a in (0.5, 1, 2, 4) for b in (10, 20, 40)]
    figures = [
        {"title": "Lines, bands, levels, steps", "file": "lines", "figure": figure([
            panel(axis("time [s]"), axis("error [m]"), [mark("line", 0, x.tolist(), np.sin(x).tolist()), mark("line", 1, x.tolist(), np.cos(x).tolist())], title="lines"),
            panel(axis("batch [s]", "log", ends=[0.01, 1]), axis("share", share=True), [
                mark("steps", 0, [0.01, 0.1, 0.5, 1], [0.1, 0.5, 0.9, 1]), mark("level", 1, [], [0.4], [0.3], [0.5]), mark("failures", 1, [], [], [1], [10]),
                mark("points", 2, [0.02, 0.2, 0.8], [0.2, None, 0.7]), mark("band", 2, [0.02, 0.2, 0.8], [], [0.1, None, 0.6], [0.3, None, 0.8]),
                mark("failures", 2, [0.2], [], [3], [3])], title="steps")], ["first", "second", "third"], "Every kind of mark.", columns=2)},
        {"title": "Cells", "file": "cells", "figure": figure([panel(axis("speed [m/s]"), axis("batch [ms]"), [
            mark("cells", 0, [a for a, _ in grid], [b for _, b in grid], [None if i == 5 else float(v) for i, v in enumerate(np.exp(random.normal(size=len(grid))))])])],
            ["ratio"], "Ratio of the ATE to that of the base.")},
        {"title": "Boxes", "file": "boxes", "figure": figure([panel(axis("ATE [m]"), axis(""), [
            mark("box", i, [i], (0.1 * (i + 1) + 0.02 * random.normal(size=12)).tolist()) for i in range(3)], names=["first", "second (1 of 13 fail)", "third with a name\nin two lines"])],
            ["first", "second", "third"], "Boxes.")},
    ]
    write_page(template, payload("invented: all kinds of marks", [], [], [], figures), os.path.join(out, "figures.html"))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", required=True)
    parser.add_argument("--template", default=os.path.join(HERE, "..", "report.html"))
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    many(options.template, options.out)
    single(options.template, options.out, "long", 600.0, 6000, states=("ok", "lost"))
    single(options.template, options.out, "no_truth", 20.0, 600, truth=False)
    single(options.template, options.out, "failed", 10.0, 300, states=("failed",), labels=("gp_map", "bundle_adjustment", "other"))
    hostile = ("<script>window.hacked=1</script>", "\"><img src=x onerror=window.hacked=1>", "'quoted' & &amp; \u202e </td></table>", "{{a|b}} ${1+1} {b|x} =cmd()")
    single(options.template, options.out, "hostile", 10.0, 300, labels=hostile, title="</title></script><script>window.hacked=1</script>")
    write_page(options.template, payload("invented: nothing", [], [], []), os.path.join(options.out, "empty.html"))
    all_marks(options.template, options.out)


if __name__ == "__main__":
    main()
