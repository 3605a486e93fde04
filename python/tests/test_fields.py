"""Fields of passages as arrays, and measures of transitions wherever other measures are."""
import pathlib

import numpy as np
import pytest

import pbif

WELLS = {"x": {"from": -2.2, "to": 2.2, "count": 60}}
KINDS = ["mean-time", "committor", "reactive-density", "reactive-current"]
PASSAGE = {"over": {"from": "x < -0.5", "to": "x > 0.5", "fields": KINDS}}
UNITS = {"over_mean_time": "t", "over_committor": "1", "over_reactive_density": "1/x", "over_reactive_current_x": "1/t"}


@pytest.fixture(scope="module")
def system() -> pbif.System:
    return pbif.System("x = a x - x^3", noise={"x": "sqrt(s2)"}, a=0.0, s2=0.25)


@pytest.fixture(scope="module")
def run(system: pbif.System) -> pbif.Run:
    return system.sweep("a", 0.5, 1, 3, cells=WELLS, passage=PASSAGE)


def test_fields_of_passages_are_arrays_over_value_and_state(run: pbif.Run) -> None:
    assert list(run.fields) == list(UNITS) and "over_committor" in run.fields and len(run.fields) == 4
    one = run.fields["over_committor"]
    assert one.values.shape == one.errors.shape == (3, 60) and list(one.at) == [0.5, 0.75, 1.0]
    x = one.centres["x"]
    assert np.allclose(x, (one.edges["x"][1:] + one.edges["x"][:-1]) / 2)
    # By symmetry the committor of a state and of its mirror image sum to one.
    assert np.allclose(one.values + one.values[:, ::-1], 1, atol=2 * one.errors.max() + 1e-9)
    assert (np.diff(one.values[:, np.abs(x) < 0.4], axis=1) > 0).all()
    values, errors = run.field("over_committor")
    assert np.array_equal(values, one.values) and np.array_equal(errors, one.errors)
    with pytest.raises(KeyError, match="no field `over`; there are over_mean_time"):
        run.fields["over"]


def test_a_committor_is_the_integral_that_it_is(run: pbif.Run) -> None:
    one = run.fields["over_committor"]
    x, inside = one.centres["x"], np.abs(one.centres["x"]) < 0.5
    fine = np.linspace(-0.5, 0.5, 4001)
    for a, values, errors in zip(one.at, one.values, one.errors):
        # One over the stationary density, summed from the one border on.
        scale = np.exp(-(a * fine**2 / 2 - fine**4 / 4) / 0.125)
        sums = np.concatenate([[0], np.cumsum((scale[1:] + scale[:-1]) / 2)])
        exact = np.interp(x[inside], fine, sums / sums[-1])
        assert (np.abs(values[inside] - exact) <= errors[inside] + 1e-7).all()


def test_the_flux_is_what_crosses_and_time_what_the_density_on_the_way_holds(run: pbif.Run) -> None:
    density, current = run.fields["over_reactive_density"], run.fields["over_reactive_current_x"]
    flux, time = (run.points[f"over_transition_{of}"] for of in ("flux", "time"))
    held = (density.values * np.diff(density.edges["x"])).sum(axis=1)
    # By midpoints of cells that the borders cut, to a few percent.
    assert np.allclose(held, flux * time, rtol=0.05)
    inside = np.abs(current.centres["x"]) < 0.4
    off = np.abs(current.values - flux[:, np.newaxis])[:, inside]
    assert (off <= (current.errors + run.points["over_transition_flux_error"][:, np.newaxis])[:, inside]).all()


def test_measures_of_transitions_are_wherever_others_are(system: pbif.System, run: pbif.Run) -> None:
    data, table = run.to_xarray(), run.to_pandas()
    solution = system.density("a", 0.75, cells=WELLS, passage=PASSAGE)
    for name, unit in [("flux", "1/t"), ("rate", "1/t"), ("time", "t")]:
        name = f"over_transition_{name}"
        assert run.units[name] == run.units[name + "_error"] == unit == data[name].attrs["units"]
        assert list(data[name].values) == list(run.points[name]) == list(table[name])
        assert solution.measures[name] == pytest.approx(run.points[name][1], rel=1e-9)
        assert 0 < solution.measures[name + "_error"] < 0.01 * solution.measures[name]


def test_a_solution_has_them_over_the_state_alone(system: pbif.System, run: pbif.Run) -> None:
    solution = system.density("a", 0.75, cells=WELLS, passage=PASSAGE)
    assert list(solution.fields) == list(run.fields)
    for name, unit in UNITS.items():
        one, all_of = solution.fields[name], run.fields[name]
        assert one.at == 0.75 and one.values.shape == one.errors.shape == (60,) and one.unit == unit
        assert np.allclose(one.values, all_of.values[1], rtol=1e-7, atol=1e-9)
        assert one.values.flags["C_CONTIGUOUS"] and one.values.flags["WRITEABLE"]
        assert np.array_equal(solution.field(name)[1], one.errors)


def test_xarray_has_fields_with_errors_and_units(run: pbif.Run) -> None:
    pytest.importorskip("xarray")
    data = run.to_xarray()
    for name, unit in UNITS.items():
        for array in (name, name + "_error"):
            assert data[array].dims == ("a", "x") and data[array].attrs["units"] == unit
        assert np.array_equal(data[name].values, run.fields[name].values, equal_nan=True)
        assert np.array_equal(data[name + "_error"].values, run.fields[name].errors, equal_nan=True)
    one = data["over_committor"].sel(a=0.75)
    assert float(np.interp(0.0, one["x"].values, one.values)) == pytest.approx(0.5, abs=1e-3)


def test_files_that_xarray_and_pbif_write_have_the_same_fields(run: pbif.Run, tmp_path: pathlib.Path) -> None:
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("scipy")
    data = run.to_xarray()
    data.to_netcdf(tmp_path / "by-xarray.nc", engine="scipy")
    with xarray.open_dataset(tmp_path / "by-xarray.nc", engine="scipy") as again:
        for name in UNITS:
            assert np.array_equal(again[name].values, data[name].values, equal_nan=True)
            assert "x" in again[name].coords and "a" in again[name].coords
    # What the library writes has the same arrays.
    run.to_netcdf(str(tmp_path / "by-pbif.nc"))
    with xarray.open_dataset(tmp_path / "by-pbif.nc", engine="scipy") as again:
        for name in UNITS:
            assert np.array_equal(again[name].values, data[name].values, equal_nan=True)


def test_fields_come_back_from_a_folder(run: pbif.Run) -> None:
    again = pbif.open(run.folder)
    assert list(again.fields) == list(run.fields)
    for name in UNITS:
        assert np.array_equal(again.fields[name].values, run.fields[name].values, equal_nan=True)
        assert np.array_equal(again.fields[name].errors, run.fields[name].errors, equal_nan=True)


def test_fields_over_two_axes_have_units_of_both() -> None:
    system = pbif.System("x = y; y = x - x^3 - g y", noise={"y": "sqrt(0.2)"}, g=0.5)
    cells = {"x": {"from": -2.2, "to": 2.2, "count": 32}, "y": {"from": -2, "to": 2, "count": 28}}
    passage = {"over": {"from": "x < -0.7", "to": "x > 0.7", "fields": ["reactive-density", "reactive-current"]}}
    solution = system.density("g", 0.5, cells=cells, passage=passage)
    units = {name: one.unit for name, one in solution.fields.items()}
    assert units == {
        "over_reactive_density": "1/(x y)",
        "over_reactive_current_x": "1/(y t)",
        "over_reactive_current_y": "1/(x t)",
    }
    current = solution.fields["over_reactive_current_x"]
    assert current.values.shape == (32, 28) and set(current.centres) == {"x", "y"}
    # What crosses x = 0 is the flux, as far as so few cells know it.
    row = int(np.abs(current.centres["x"]).argmin())
    through = (current.values[row] * np.diff(current.edges["y"])).sum()
    assert through == pytest.approx(solution.measures["over_transition_flux"], rel=0.1)
    assert list(system.density("g", 0.5, cells=cells).fields) == []
