"""Own detectors, and fields of passages as arrays."""
import numpy as np
import pytest

import pbif

WELLS = {"x": {"from": -2.2, "to": 2.2, "count": 60}}


@pytest.fixture(scope="module")
def system() -> pbif.System:
    return pbif.System("x = a x - x^3", noise={"x": "sqrt(s2)"}, a=0.0, s2=0.25)


@pytest.fixture(scope="module")
def run(system: pbif.System) -> pbif.Run:
    return system.sweep("a", -1, 1, 11, cells=WELLS)


def maxima(p: pbif.Density) -> int:
    inner = p.values[1:-1]
    return int(((inner > p.values[:-2]) & (inner >= p.values[2:])).sum())


def test_a_counter_of_ones_own_finds_the_split_that_the_library_locates(run: pbif.Run) -> None:
    found = run.detected(maxima, "x")
    known = run.to_xarray()["a"].values.tolist()
    assert found.values == known
    assert [answer for _, answer in found][0] == 1 and found.answers[-1] == 2
    (change,) = found.changes
    (located,) = run.bifurcations
    # Two neighbouring cells that are equally high hide a split for about a cell: a h² of the curve's a x²/s2.
    assert change.lower - 0.05 < located.value < change.upper
    assert (change.before, change.after) == (1, 2)


def test_brackets_are_halved_by_solving_more_values(run: pbif.Run) -> None:
    wide = lambda p: bool(np.average(p.centres["x"] ** 2, weights=p.values) > 0.3)  # noqa: E731
    (coarse,) = run.detected(wide).changes
    (change,) = run.detected(wide, within=1e-4).changes
    assert coarse.lower <= change.lower < change.upper <= coarse.upper
    assert change.upper - change.lower <= 1e-4 < coarse.upper - coarse.lower
    x = np.linspace(-3, 3, 20001)
    mean = lambda a: np.average(x**2, weights=np.exp((a * x**2 / 2 - x**4 / 4) / 0.125))  # noqa: E731
    # Averages over cells are off by h²/12 of the mean square, which moves by about 0.3 a unit of a.
    assert mean(change.lower - 2e-3) < 0.3 < mean(change.upper + 2e-3)


def test_what_a_detector_raises_is_raised_and_unknown_densities_are_named(run: pbif.Run) -> None:
    def broken(p: pbif.Density) -> int:
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        run.detected(broken)
    with pytest.raises(KeyError, match="there are x"):
        run.detected(maxima, "y")


def test_fields_of_passages_are_arrays_over_value_and_state(system: pbif.System) -> None:
    passage = {"over": {"from": "x < -0.5", "to": "x > 0.5", "fields": ["committor", "reactive-density"]}}
    run = system.sweep("a", 0.5, 1, 3, cells=WELLS, passage=passage)
    assert run.fields == ["over_committor", "over_reactive_density"]
    values, errors = run.field("over_committor")
    assert values.shape == errors.shape == (3, 60)
    # By symmetry the committor of a state and of its mirror image sum to one.
    assert np.allclose(values + values[:, ::-1], 1, atol=2 * errors.max() + 1e-9)
    inside = values[:, np.abs(run.to_xarray()["x"].values) < 0.4]
    assert (np.diff(inside, axis=1) > 0).all()
    density, _ = run.field("over_reactive_density")
    flux, time = (run.points[f"over_transition_{of}"] for of in ("flux", "time"))
    widths = np.diff(run.to_xarray()["x_edges"].values)
    # The integral is flux times time; by midpoints of cells that the borders cut, to a few percent.
    assert np.allclose((density * widths).sum(axis=1), flux * time, rtol=0.05)
    solution = system.density("a", 0.75, cells=WELLS, passage=passage)
    assert solution.fields == run.fields
    assert np.allclose(solution.field("over_committor")[0], values[1], atol=1e-9)
