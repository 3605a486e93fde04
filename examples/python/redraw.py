"""Draws the diagram of a run of pbif anew, with NumPy and matplotlib alone: the density of an axis over the swept
parameter as an image, and what was located as lines:

    pbif sweep sweeps/tutorials/first.toml
    python examples/python/redraw.py output/first --out diagram.png
"""
import argparse
import csv
import json
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
arguments.add_argument("run", type=pathlib.Path, help="folder of a run, as pbif sweep left it")
arguments.add_argument("--axis", default="x", help="axis whose marginal density is drawn")
arguments.add_argument("--out", default="diagram.png", help="picture to write")
asked = arguments.parse_args()


def read(name):
    """An array of the store: chunks of numbers, each in a file of its own."""
    folder = asked.run / "densities.zarr" / name
    about = json.loads((folder / "zarr.json").read_text())
    chunk = about["chunk_grid"]["configuration"]["chunk_shape"]
    values = np.full(about["shape"], np.nan)
    for file in (path for path in (folder / "c").rglob("*") if path.is_file()):
        starts = [int(n) * length for n, length in zip(file.relative_to(folder / "c").parts, chunk)]
        place = values[tuple(slice(start, start + length) for start, length in zip(starts, chunk))]
        block = np.fromfile(file, "<f8").reshape(chunk)
        place[...] = block[tuple(slice(0, length) for length in place.shape)]
    return values


parameter = json.loads((asked.run / "run.json").read_text())["sweep"]["sweep"]["parameter"]
at, centres, density = read(parameter), read(asked.axis), read(f"p_{asked.axis}")

figure, panel = plt.subplots(figsize=(84 / 25.4, 66 / 25.4), constrained_layout=True)
colours = panel.pcolormesh(at, centres, density.T, shading="gouraud", cmap="viridis", rasterized=True)
figure.colorbar(colours, label=f"p({asked.axis})")
with open(asked.run / "bifurcations.csv", newline="") as table:
    for row in csv.DictReader(table):
        if row["status"] and row["observable"] == asked.axis:
            print(f"{row['label']}: {parameter} = {float(row['value']):.6f} ± {float(row['error']):.6f} ({row['status']})")
            panel.axvline(float(row["value"]), color="white", linestyle="--", linewidth=1)
            panel.annotate(row["label"], (float(row["value"]), 1), xycoords=("data", "axes fraction"), va="bottom", ha="center")
panel.set(xlabel=parameter, ylabel=asked.axis)
figure.savefig(asked.out, dpi=288)
