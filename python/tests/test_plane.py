"""Curves, figures by matplotlib and one solve, on a small grid."""
import pickle

import pytest

import pbif

CELLS = {"x": {"from": -3.0, "to": 3.0, "count": 24}, "y": {"from": -4.7, "to": 4.7, "count": 24}}
SECTIONS = {"cells": CELLS, "locate": {"tolerance": 0.05, "grid_check": "off"}}


@pytest.fixture(scope="module")
def system() -> pbif.System:
    return pbif.System("x = y; y = -(c + x^2) y - x", noise={"y": "sqrt(2 D)"}, c=0.0, D=0.1)


@pytest.mark.filterwarnings("ignore::pbif.PbifWarning")
def test_a_curve_goes_through_the_row_that_it_was_begun_at(system: pbif.System) -> None:
    run = system.sweep("c", -0.4, 0.2, 7, **SECTIONS)
    row = next(one for one in run.bifurcations if one.observable == "x")
    curves = run.curve(row.label, second="D", bounds=(0.09, 0.11), step=0.25, branches="off")
    assert curves.parameters == ("c", "D") and curves.figure() is not None
    points = curves.curves[0].points
    assert points.shape[1] == 2 and min(abs(points[:, 0] - row.value)) < 0.02
    assert len(pickle.loads(pickle.dumps(curves)).curves) == len(curves.curves)
    with pytest.raises(pbif.InputError, match="no P- or D-bifurcation `PB99`"):
        run.curve("PB99", second="D", bounds=(0.09, 0.11))


@pytest.mark.filterwarnings("ignore::pbif.PbifWarning")
def test_one_density_has_measures_of_passages(system: pbif.System) -> None:
    passage = {"exit": {"start": {"x": 0, "y": 0}, "until": "abs(x) > 1"}}
    solution = system.density("c", 0.1, cells=CELLS, passage=passage)
    assert solution.measures["exit_mean"] > 0 and solution.measures["exit_mean_error"] >= 0
    assert solution.density("xy").shape == (24, 24)


def test_pictures_are_drawn_on_given_axes() -> None:
    pytest.importorskip("matplotlib")
    import matplotlib.pyplot as plt

    run = pbif.gallery("verhulst", {"sweep.points": 5, "locate.tolerance": 0.5}).run()
    _, axes = plt.subplots(1, 2)
    name = run.observables[0]
    assert run.plot.diagram(name, ax=axes[0]) is axes[0] and run.plot.marginal(name, ax=axes[1]) is axes[1]
