"""Own detectors, along a sweep and of a run."""
import os
import pathlib
import signal
import threading
from collections.abc import Callable
from typing import Any

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


def wide(p: pbif.Density) -> bool:
    return bool(np.average(p.centres["x"] ** 2, weights=p.values) > 0.3)


def test_a_counter_of_ones_own_finds_the_split_that_the_library_locates(run: pbif.Run) -> None:
    found = run.detected(maxima, "x")
    known = run.to_xarray()["a"].values.tolist()
    assert found.values == known
    assert [answer for _, answer in found][0] == 1 and found.answers[-1] == 2
    (change,) = found.changes
    (located,) = run.bifurcations
    # Two neighbouring cells that are equally high hide a split for about a cell: a h² of the curve's a x²/s2.
    assert change.lower - 0.05 < located.value < change.upper
    assert (change.detector, change.observable, change.before, change.after) == ("maxima", "x", 1, 2)


def test_brackets_are_halved_by_solving_more_values(run: pbif.Run) -> None:
    (coarse,) = run.detected(wide).changes
    (change,) = run.detected(wide, within=1e-4).changes
    assert coarse.lower <= change.lower < change.upper <= coarse.upper
    assert change.upper - change.lower <= 1e-4 < coarse.upper - coarse.lower
    x = np.linspace(-3, 3, 20001)
    mean = lambda a: np.average(x**2, weights=np.exp((a * x**2 / 2 - x**4 / 4) / 0.125))  # noqa: E731
    # Averages over cells are off by h²/12 of the mean square, which moves by about 0.3 a unit of a.
    assert mean(change.lower - 2e-3) < 0.3 < mean(change.upper + 2e-3)


def test_detectors_of_a_sweep_say_what_they_say_of_the_run(system: pbif.System, run: pbif.Run) -> None:
    threads = []

    def bumps(p: pbif.Density) -> int:
        threads.append(threading.current_thread())
        found = maxima(p)
        # An array is the function's own.
        p.values[:] = 0
        return found

    narrow = pbif.Detector(wide, "x", within=1e-3)
    own = system.sweep("a", -1, 1, 11, cells=WELLS, detectors={"bumps": bumps, "wide": narrow})
    assert list(own.detected) == ["bumps", "wide"] and set(threads) == {threading.current_thread()}
    # A value each, those that locating has added too; once.
    assert len(threads) == len(own) == len(own.detected["bumps"])
    assert list(own.detected["bumps"]) == list(run.detected(maxima))
    assert list(own.detected["wide"]) == list(run.detected(wide, within=1e-3))
    assert [row.detector for row in own.detected_changes] == ["bumps", "wide"]
    table = own.detected_changes.to_pandas()
    assert [row.before for row in own.detected_changes] == list(table["before"]) == [1, False]
    assert "bumps" in own._repr_html_()
    for name in ("value", "error", "lower", "upper"):
        assert [getattr(row, name) for row in own.changes] == [getattr(row, name) for row in run.changes]
    ours, theirs = own.to_xarray().drop_vars("seconds"), run.to_xarray().drop_vars("seconds")
    assert ours.equals(theirs)
    with pytest.raises(KeyError, match="there are bumps, wide"):
        own.detected["dips"]


def test_a_density_has_errors_and_both_axes() -> None:
    system = pbif.System("x = y; y = -(c + x^2) y - x", noise={"y": "sqrt(2 D)"}, c=0.1, D=0.4)
    cells = {"x": {"from": -4, "to": 4, "count": 48}, "y": {"from": -4, "to": 4, "count": 40}}
    seen: list[pbif.Density] = []
    coarse = {"tolerance": 1, "grid_check": "off"}
    system.sweep("c", 0.1, 0.2, 2, cells=cells, locate=coarse, detectors={"all": pbif.Detector(seen.append, "xy")})
    assert {0.1, 0.2} <= {one.at for one in seen}
    for one in seen:
        assert one.name == "xy" and one.values.shape == one.errors.shape == (48, 40)
        area = np.outer(np.diff(one.edges["x"]), np.diff(one.edges["y"]))
        assert abs((one.values * area).sum() - 1) < 1e-4 and len(one.centres["y"]) == 40
        assert (one.errors >= 0).all() and one.errors.max() < one.values.max()
        alone = system.density("c", one.at, cells=cells)
        # A session starts from other values than a sweep.
        assert np.abs(alone.density("xy") - one.values).max() < 1e-6 * one.values.max()


def test_what_a_detector_raises_stops_the_sweep_which_goes_on_to_the_same_bytes(
    system: pbif.System, run: pbif.Run, tmp_path: pathlib.Path
) -> None:
    calls = []

    def broken(p: pbif.Density) -> int:
        calls.append(p.at)
        if len(calls) == 4:
            raise ZeroDivisionError("mine")
        return maxima(p)

    ask = lambda one: system.sweep(  # noqa: E731
        "a", -1, 1, 11, cells=WELLS, out=tmp_path / "run", resume=True, threads=1, detectors={"bumps": one}
    )
    with pytest.raises(ZeroDivisionError, match="mine") as caught:
        ask(broken)
    assert len(calls) == 4 and (tmp_path / "run").is_dir()
    assert any(str(tmp_path / "run") in note for note in getattr(caught.value, "__notes__", [str(tmp_path / "run")]))
    again = ask(maxima)
    # What was solved before is seen too, and so is all of a run that is complete.
    assert list(again.detected["bumps"]) == list(run.detected(maxima))
    assert list(ask(maxima).detected["bumps"]) == list(run.detected(maxima))
    for table in ("bifurcations.csv", "features.csv"):
        assert (tmp_path / "run" / table).read_bytes() == (pathlib.Path(run.folder) / table).read_bytes()


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_an_interrupt_in_a_detector_leaves_a_run_that_goes_on(system: pbif.System, tmp_path: pathlib.Path) -> None:
    def asks(p: pbif.Density) -> int:
        os.kill(os.getpid(), signal.SIGINT)
        return maxima(p)

    narrow = pbif.Detector(at_the_ends(asks), within=1e-3)
    cases: list[tuple[str, int, Any]] = [("sweep", 2001, asks), ("narrow", 2, narrow)]
    for name, points, detector in cases:
        with pytest.raises(pbif.Interrupted) as caught:
            system.sweep("a", 0.5, 1, points, cells=WELLS, out=tmp_path / name, detectors={"one": detector})
        assert str(caught.value.folder) == str(tmp_path / name) and (tmp_path / name).is_dir()
    # Halving begins when the sweep has come to its end.
    assert len(pbif.open(tmp_path / "narrow")) >= 2


def at_the_ends(detector: Callable[[pbif.Density], Any]) -> Callable[[pbif.Density], Any]:
    """Answers by the value at the ends of the sweep, so that there is something to narrow, and else as the detector."""
    return lambda p: p.at > 0.7 if p.at in (0.5, 1.0) else detector(p)


def test_what_a_detector_raises_is_raised_and_unknown_densities_are_named(system: pbif.System, run: pbif.Run) -> None:
    def broken(p: pbif.Density) -> int:
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        run.detected(broken)
    with pytest.raises(KeyError, match="there are x"):
        run.detected(maxima, "y")
    # Before anything is solved.
    with pytest.raises(KeyError, match="for the detector `bumps`; there are x"):
        system.sweep("a", -1, 1, 11, cells=WELLS, detectors={"bumps": pbif.Detector(maxima, "y")})
    with pytest.raises(TypeError, match="a function of a density"):
        system.sweep("a", -1, 1, 11, cells=WELLS, detectors={"bumps": 3})  # type: ignore[dict-item]
    with pytest.raises(ValueError, match="above zero"):
        run.detected(maxima, within=-1.0)
    with pytest.raises(TypeError, match="not with ndarray"):
        run.detected(lambda p: p.values)


def test_numbers_of_numpy_are_numbers_and_nan_is_no_change(run: pbif.Run) -> None:
    found = run.detected(lambda p: np.float64(np.nan) if p.at < 0 else np.int64(2))
    assert {type(answer) for answer in found.answers} == {float, int} and len(found.changes) == 1


def test_a_system_with_a_drift_in_python_has_narrow_brackets_too() -> None:
    drift = lambda states, p: p["a"] * states - states**3  # noqa: E731
    system = pbif.System(drift=drift, axes=["x"], noise={"x": "sqrt(s2)"}, a=0.0, s2=0.25)
    run = system.sweep("a", -1, 1, 5, cells=WELLS, detectors={"wide": pbif.Detector(wide, within=0.01)})
    (change,) = run.detected_changes
    assert 0 < change.upper - change.lower <= 0.01


def test_a_detector_may_solve_and_progress_is_told_beside_it(system: pbif.System) -> None:
    sweep = system.prepare("a", -1, 1, 5, cells=WELLS)
    session = sweep.session()
    told: list[object] = []
    same = lambda p: session.solve(p.at).signatures["x"]  # noqa: E731
    run = sweep.run(detectors={"same": same}, progress=lambda words, done: told.append(done))
    assert [answer for _, answer in run.detected["same"]] == [one["x"] for one in run.signatures] and told
