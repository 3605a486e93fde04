"""The module: values, errors, interruption, threads, arrays, curves. The program of the same wheel gives the values to compare."""
import copy
import csv
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import pbif

BISTABLE = """
[system]
model = "bistable"
[system.parameters]
sigma2 = 0.25
[sweep]
parameter = "a"
from = -1.0
to = 1.0
points = 11
[cells]
x = { from = -2.2, to = 2.2, count = 60 }
"""


@pytest.fixture(scope="module")
def run() -> pbif.Run:
    return pbif.Sweep(BISTABLE).run()


def test_values_are_those_of_the_program_to_the_last_bit(run: pbif.Run, tmp_path: pathlib.Path) -> None:
    (tmp_path / "s.toml").write_text(BISTABLE)
    words = ["pbif", "sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / "run"), "--quiet"]
    code = "import sys, pbif; sys.exit(pbif.main())"
    done = subprocess.run([sys.executable, "-c", code, *words[1:]], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "run" / "bifurcations.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    assert [row["label"] for row in rows] == [row.label for row in run.changes]
    for theirs, ours in zip(rows, run.changes):
        for name in ("value", "error", "lower", "upper"):
            assert float(theirs[name]) == getattr(ours, name)
    with open(tmp_path / "run" / "points.csv", newline="") as table:
        points = list(csv.DictReader(table))
    for name in ("a", "mean_x", "sd_x", "residual"):
        assert [float(one[name]) for one in points] == list(run.points[name])
    again = pbif.open(tmp_path / "run")
    assert [row.value for row in again.changes] == [row.value for row in run.changes]


def test_bad_input_has_the_words_of_the_program_and_a_place() -> None:
    with pytest.raises(pbif.InputError, match="did you mean `points`") as caught:
        pbif.Sweep(BISTABLE.replace("points", "piont"), name="mine.toml")
    assert caught.value.location == pbif.Location("mine.toml", 10, 1)
    with pytest.raises(ValueError, match="kapa"):
        pbif.System("x = y; y = -x + kapa y", noise={"y": "1"}, a=1.0).sweep("a", 0, 1, 3)
    with pytest.raises(pbif.RunError):
        pbif.open("there/is/no/run")


def test_equations_are_written_as_rates_too_and_cells_as_numbers() -> None:
    texts = ["x = y; y = -y - x", "x' = y; y' = -y - x", "dx/dt = y\ndy/dt = -y - x"]
    given = [pbif.System(text, noise={"y": "a"}, a=1.0).prepare("a", 1, 2, 2, cells={"x": 20, "y": 20}) for text in texts]
    assert given[0].toml == given[1].toml == given[2].toml
    assert given[0].density(1.0).density("xy").shape == (20, 20)


def test_a_density_that_is_not_there_is_told_with_those_that_are(run: pbif.Run) -> None:
    with pytest.raises(KeyError, match="no density of `z`: there are x"):
        run.plot.diagram("z")


def test_arrays_are_densities_with_bounds(run: pbif.Run) -> None:
    xarray = pytest.importorskip("xarray")
    data = run.to_xarray()
    assert isinstance(data, xarray.Dataset)
    widths = np.diff(data["x_edges"].values)
    assert np.allclose((data["p_x"].values * widths).sum(axis=1), 1.0, atol=1e-9)
    assert data["x"].attrs["bounds"] == "x_bounds" and data["x_bounds"].shape == (60, 2)
    assert data["p_x"].values.min() >= 0.0 and "PB1" in data.attrs["changes"]


def test_a_session_solves_what_a_run_has_solved(run: pbif.Run) -> None:
    with pbif.Sweep(BISTABLE).session() as session:
        solution = session.solve(1.0)
    assert solution.signatures == {"x": "2 peaks"} and solution.status == "solved"
    masses = solution.density("x") * np.diff(solution.edges("x"))
    assert abs(masses.sum() - 1.0) < 1e-9


def test_runs_are_pickled_by_their_folder(run: pbif.Run) -> None:
    again = pickle.loads(pickle.dumps(run))
    assert [row.value for row in again.changes] == [row.value for row in run.changes]
    assert copy.copy(run).folder == run.folder


def test_figures_and_pages_are_those_of_the_library(run: pbif.Run) -> None:
    figure = run.figure("diagram_x")
    assert figure is not None and figure._repr_svg_().startswith("<svg") or "<svg" in figure.svg[:200]
    assert figure.png[:4] == b"\x89PNG"
    assert run.explore().html.startswith("<!doctype html>") and "PB1" in run._repr_html_()


def test_progress_is_told_and_may_stop_the_run() -> None:
    heard = []
    pbif.Sweep(BISTABLE).run(progress=lambda words, done: heard.append(done))
    assert (11, 11) in heard or any(done for done in heard)

    def enough(words: str, done: object) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        pbif.Sweep(BISTABLE).run(progress=enough)


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_an_interrupt_is_heard_at_once_and_leaves_a_run_that_goes_on(tmp_path: pathlib.Path) -> None:
    text = "title='t'\n" + BISTABLE.replace("points = 11", "points = 4000").replace("count = 60", "count = 400")
    sweep, asked = pbif.Sweep(text), [0.0]

    def interrupt() -> None:
        asked[0] = time.monotonic()
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.5, interrupt).start()
    with pytest.raises(pbif.Interrupted) as caught:
        sweep.run(tmp_path / "run")
    took = time.monotonic() - asked[0]
    assert took < 0.3, took
    assert caught.value.folder == tmp_path / "run" and (tmp_path / "run").exists()

    def first(words: str, _: object) -> None:
        if "are done already" in words:
            raise RuntimeError(words)

    with pytest.raises(RuntimeError, match="are done already"):
        sweep.run(tmp_path / "run", resume=True, progress=first)


def test_threads_may_run_beside_each_other() -> None:
    found: list[float] = []
    work = lambda: found.append(pbif.Sweep(BISTABLE).run(threads=1).changes["PB1"].value)  # noqa: E731
    threads = [threading.Thread(target=work) for _ in range(3)]
    [one.start() for one in threads]
    [one.join() for one in threads]
    assert len(found) == 3 and len(set(found)) == 1


def test_the_gallery_and_the_models_are_there() -> None:
    assert "toggle" in pbif.gallery() and "coulomb" in pbif.systems()
    assert pbif.gallery("verhulst").parameter


def test_spectra_are_arrays_over_value_and_frequency(tmp_path: pathlib.Path) -> None:
    s = pbif.System("x = -k x", noise={"x": "sqrt(2)"}, k=1.0)
    asked = {"of": ["x"], "to": 4.0, "points": 9, "lag": 2.0}
    run = s.sweep("k", 0.5, 1.0, 3, cells={"x": {"from": -9.0, "to": 9.0, "count": 80}}, spectrum=asked)
    found = run.spectrum("x")
    assert found["power"].shape == (3, 9) and list(found["parameter"]) == [0.5, 0.75, 1.0]
    k, w = found["parameter"][:, None], found["frequency"][None, :]
    assert np.all(abs(found["power"] - 2 / (k**2 + w**2)) <= found["power_error"])
    covariance = run.correlation("x")
    assert np.all(abs(covariance["covariance"] - np.exp(-k * covariance["lag"]) / k) <= covariance["covariance_error"])
    with pytest.raises(KeyError, match="there are those of x"):
        run.spectrum("y")
