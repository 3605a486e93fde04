"""Reads a run of pbif and plots a marginal density along the sweep, with the located changes:

    pbif sweep sweeps/bistable.toml
    python examples/python/read_run.py output/bistable --out marginal.png

Needs xarray, zarr and matplotlib (pip install xarray zarr matplotlib). The store is read as pbif left it.
"""
import argparse
import csv
import json
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import xarray as xr

arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
arguments.add_argument("run", type=pathlib.Path, help="folder of a run, as pbif sweep left it")
arguments.add_argument("--axis", default="x", help="axis whose marginal density is drawn")
arguments.add_argument("--out", default="marginal.png", help="picture to write")
asked = arguments.parse_args()

manifest = json.loads((asked.run / "run.json").read_text())
parameter = manifest["sweep"]["sweep"]["parameter"]
densities = xr.open_zarr(asked.run / "densities.zarr")
p = densities[f"p_{asked.axis}"]

# Densities are averages over cells: ∫ p dx = Σ p Δx = 1 at every value of the parameter.
widths = densities[f"{asked.axis}_edges"].diff(f"{asked.axis}_edges").values
mass = (p * widths).sum(asked.axis)
print(f"{manifest['ending']}: {p.sizes[parameter]} values of {parameter}, masses {mass.min().item():.12f} to {mass.max().item():.12f}")

p.plot(x=parameter, y=asked.axis, cmap="viridis")
with open(asked.run / "bifurcations.csv", newline="") as table:
    for row in csv.DictReader(table):
        if row["status"] and row["observable"] == asked.axis:
            print(f"{row['label']}: {parameter} = {row['value']} ± {row['error']}, {row['before']} -> {row['after']} ({row['status']})")
            plt.axvline(float(row["value"]), color="white", linestyle="--")
plt.xlabel(parameter)
plt.ylabel(asked.axis)
plt.title(manifest["sweep"]["title"])
plt.savefig(asked.out, dpi=150)
print(asked.out)
