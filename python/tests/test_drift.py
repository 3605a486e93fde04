"""A drift in Python as a system: the values of the typed one, errors with their place, interruption, threads."""
import os
import signal
import threading
import time
from typing import Any

import numpy as np
import pytest

import pbif

CELLS = {"x": {"from": -4, "to": 4, "count": 40}, "y": {"from": -4, "to": 4, "count": 40}}
HELD = {"c": -0.3, "D": 0.2}


def drift(states: np.ndarray, p: dict[str, float]) -> np.ndarray:
    x, y = states.T
    return np.stack([y, -(p["c"] + x**2) * y - x], axis=1)


def typed() -> pbif.System:
    return pbif.System("x = y; y = -(c + x^2) y - x", noise={"y": "sqrt(2 D)"}, **HELD)


def own(function: Any = drift, noise: Any = "sqrt(2 D)") -> pbif.System:
    return pbif.System(drift=function, axes=["x", "y"], noise={"y": noise}, **HELD)


def test_densities_are_those_of_the_typed_system() -> None:
    one = typed().density("c", -0.3, cells=CELLS)
    for noise in ["sqrt(2 D)", lambda states, p: np.full(len(states), np.sqrt(2 * p["D"])), lambda states, p: np.sqrt(2 * p["D"])]:
        other = own(noise=noise).density("c", -0.3, cells=CELLS)
        for name in ["x", "y"]:
            a, b = one.density(name), other.density(name)
            # The same schemes; a constant amplitude that is a function is not known to be constant.
            assert np.abs(a - b).max() < 1e-6 * a.max(), name
        assert one.signatures["x"] == other.signatures["x"]


def test_a_sweep_locates_what_the_typed_one_does() -> None:
    runs = [s.sweep("c", -0.4, 0.2, 7, cells=CELLS, detect={"marginals": ["x"], "joint": []}) for s in (typed(), own())]
    rows = [[(row.before, row.after, row.value, row.error) for row in run.changes] for run in runs]
    assert len(rows[0]) == len(rows[1]) and rows[0], rows
    for one, other in zip(*rows):
        assert one[:2] == other[:2]
        assert abs(one[2] - other[2]) <= one[3] + other[3]


def test_what_the_function_raises_is_raised_with_a_note() -> None:
    def broken(states: np.ndarray, p: dict[str, float]) -> np.ndarray:
        raise KeyError("nothing")

    with pytest.raises(KeyError) as raised:
        own(broken).density("c", 0.1, cells=CELLS)
    notes = getattr(raised.value, "__notes__", [""])
    assert "drift" in notes[0] or not hasattr(raised.value, "add_note")
    later = {"left": 40}

    def breaks(states: np.ndarray, p: dict[str, float]) -> np.ndarray:
        later["left"] -= 1
        if later["left"] < 0:
            raise ZeroDivisionError("late")
        return drift(states, p)

    with pytest.raises(ZeroDivisionError):
        own(breaks).density("c", 0.1, cells=CELLS)


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda states, p: states[:, :1], "shape"),
        (lambda states, p: drift(states, p) / 0.0, "finite"),
        (lambda states, p: drift(states, p) + states.mean(), "batch"),
    ],
)
def test_what_is_no_drift_is_refused(function: Any, words: str) -> None:
    with np.errstate(all="ignore"), pytest.raises(ValueError, match=words):
        own(function).prepare("c", -0.4, 0.2, 3, cells=CELLS)


def test_wrong_arguments_are_told() -> None:
    with pytest.raises(ValueError, match="axes"):
        pbif.System(drift=drift)
    with pytest.raises(ValueError, match="none of the axes"):
        pbif.System(drift=drift, axes=["x", "y"], noise={"z": "1"})
    with pytest.raises(ValueError, match="beside"):
        pbif.System("x = -x", drift=drift, axes=["x"])


def test_an_interrupt_ends_it() -> None:
    def slow(states: np.ndarray, p: dict[str, float]) -> np.ndarray:
        time.sleep(2e-3)
        return drift(states, p)

    sweep = own(drift).prepare("c", -0.4, 0.2, 41, cells=CELLS)
    del sweep
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        own(slow).sweep("c", -0.4, 0.2, 4001, cells=CELLS)
    assert time.monotonic() - began < 20.0


def test_two_threads_solve_side_by_side() -> None:
    found: dict[float, Any] = {}

    def solve(value: float) -> None:
        found[value] = own().density("c", value, cells=CELLS).density("x")

    threads = [threading.Thread(target=solve, args=(value,)) for value in (-0.3, 0.1)]
    for one in threads:
        one.start()
    for one in threads:
        one.join()
    for value, density in found.items():
        assert np.array_equal(density, own().density("c", value, cells=CELLS).density("x"))
