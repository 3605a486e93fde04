"""Reads the densities of a run of pbif with numpy alone, from the store itself, and says where the density at the first
and the last value has its highest point:

    pbif sweep sweeps/bistable.toml
    python examples/python/read_store.py output/bistable a
"""
import json
import pathlib
import sys

import numpy as np

run, parameter = pathlib.Path(sys.argv[1]), sys.argv[2]


def read(name):
    """An array of the store: chunks of numbers, each in a file of its own."""
    folder = run / "densities.zarr" / name
    about = json.loads((folder / "zarr.json").read_text())
    chunk = about["chunk_grid"]["configuration"]["chunk_shape"]
    values = np.full(about["shape"], np.nan)
    for file in (path for path in (folder / "c").rglob("*") if path.is_file()):
        starts = [int(n) * length for n, length in zip(file.relative_to(folder / "c").parts, chunk)]
        place = values[tuple(slice(start, start + length) for start, length in zip(starts, chunk))]
        block = np.fromfile(file, "<f8").reshape(chunk)
        place[...] = block[tuple(slice(0, length) for length in place.shape)]
    return values


values, x, edges, p = (read(name) for name in (parameter, "x", "x_edges", "p_x"))
mean = (p * x * np.diff(edges)).sum(axis=1)
assert np.allclose((p * np.diff(edges)).sum(axis=1), 1.0), "densities are normalised: ∫ p dx = 1"
for index in (0, -1):
    print(f"{parameter} = {values[index]:g}: highest at x = {x[p[index].argmax()]:.3f}, mean {mean[index]:.2e}")
