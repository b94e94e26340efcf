"""Reads a result archive as evo's file_interface.load_res_file does: JSON and .npy files of a zip, arrays by their names
without the ending. Prints what is in it, and what follows from the arrays, as JSON."""
import io
import json
import os
import sys
import zipfile

import numpy as np

arrays = {}
with zipfile.ZipFile(sys.argv[1], mode="r") as archive:
    assert archive.testzip() is None
    names = archive.namelist()
    assert "info.json" in names and "stats.json" in names, names
    info = json.loads(archive.read("info.json").decode("utf-8"))
    stats = json.loads(archive.read("stats.json").decode("utf-8"))
    for name in names:
        if name.endswith(".npy"):
            with io.BytesIO(archive.read(name)) as content:
                arrays[os.path.splitext(os.path.basename(name))[0]] = np.load(content)

errors = arrays["error_array"]
assert set(stats) == {"rmse", "mean", "median", "std", "min", "max", "sse"}, stats
assert set(info) == {"title", "label", "ref_name", "est_name"}, info
for name in ("timestamps", "seconds_from_start", "distances_from_start"):
    assert arrays[name].shape == errors.shape and arrays[name].dtype == np.float64, name
transform = arrays["alignment_transformation_sim3"]
assert transform.shape == (4, 4) and np.array_equal(transform[3], [0, 0, 0, 1])
print(json.dumps({
    "info": info, "stats": stats, "errors": len(errors), "rmse": float(np.sqrt(np.mean(errors**2))),
    "scale": float(np.cbrt(np.linalg.det(transform[:3, :3]))), "last_time": float(arrays["timestamps"][-1]),
    "path": float(arrays["distances_from_start"][-1])}))
