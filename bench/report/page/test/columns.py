"""Columns of the payload (src/data.ts, type Column), and the page itself. Development only."""
import base64
import json

import numpy as np


def f32(values):
    return {"f32": base64.b64encode(np.asarray(values, "<f4").tobytes()).decode()}


def i16(values):
    values = np.asarray(values, float)
    known = values[np.isfinite(values)]
    low, high = (known.min(), known.max()) if known.size else (0.0, 0.0)
    offset = 0.5 * (low + high)
    scale = (high - low) / 65530 or 1.0
    codes = np.where(np.isfinite(values), np.round((values - offset) / scale), -32768)
    return {"i16": base64.b64encode(codes.astype("<i2").tobytes()).decode(), "scale": float(f"{scale:.9g}"), "offset": float(f"{offset:.12g}")}


def write_page(template, payload, out):
    page = open(template, encoding="utf-8").read()
    data = json.dumps(payload, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    head, tail = page.split("@DATA@")
    with open(out, "w", encoding="utf-8") as file:
        file.write(head + data + tail)
    print(f"{out}: {len(page) / 1e6:.2f} MB page, {len(data) / 1e6:.2f} MB data")
