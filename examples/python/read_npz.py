"""Reads a run of pbif with numpy alone, and says where the density at the first and the last value has its highest point:

    pbif sweep sweeps/bistable.toml
    pbif export output/bistable --format npz
    python examples/python/read_npz.py output/bistable.npz a
"""
import sys

import numpy as np

path, parameter = sys.argv[1:3]
run = np.load(path)
values, x, edges, p = run[parameter], run["x"], run["x_edges"], run["p_x"]

mean = (p * x * np.diff(edges)).sum(axis=1)
assert np.allclose((p * np.diff(edges)).sum(axis=1), 1.0), "densities are normalised: ∫ p dx = 1"
for index in (0, -1):
    print(f"{parameter} = {values[index]:g}: highest at x = {x[p[index].argmax()]:.3f}, mean {mean[index]:.2e}, sd {run['sd_x'][index]:.4f}")
