"""A first P-bifurcation from Python: an oscillator whose damping is swept, as a run, a table, arrays, pictures, a curve.

    pip install .            # in a clone of the project; matplotlib, pandas and xarray are found where they are there
    python examples/python/first.py
"""
import pbif

s = pbif.System("x = y; y = -(c + x^2) y - x", noise={"y": "sqrt(2 D)"}, c=0.0, D=0.1)
run = s.sweep("c", -0.4, 0.2, 7, cells={"x": {"count": 40}, "y": {"count": 40}}, locate={"tolerance": 0.01})
for row in run.bifurcations:
    print(f"{row.label}: c = {row.value:.4f} ± {row.error:.4f}, p({row.observable}): {row.before} -> {row.after}, {row.status}")

densities = run.to_xarray()
print(densities["p_x"].sizes, densities.attrs["parameters"])
run.plot.diagram("x").figure.savefig("diagram.png")

session = s.prepare("c", -0.4, 0.2, 7, cells={"x": {"count": 40}, "y": {"count": 40}}).session()
for c in (-0.3, -0.29):
    solution = session.solve(c)
    print(c, solution.signatures, f"sd of x: {solution.measures['sd_x']:.4f}")
