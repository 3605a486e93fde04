"""What is found: runs, single solutions, curves and maps."""
from __future__ import annotations

import csv
import html
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from . import _pbif
from ._pbif import Figure
from .detected import Detected, DetectedChanges, Detections
from .fields import Fields

if TYPE_CHECKING:
    import numpy as np
    import pandas
    import xarray
    from numpy.typing import NDArray

Tell = Callable[[str, "tuple[int, int] | None"], object]
Path = "str | os.PathLike[str]"


def how(resume: bool, figures: bool, threads: int | None, progress: bool | Tell | None) -> _pbif._How:
    """How a job is carried out."""
    tell = progress if callable(progress) else None
    if progress is True or (progress is None and _watched()):
        tell = _bar
    return {"resume": resume, "figures": figures, "threads": threads, "tell": tell}


def _watched() -> bool:
    import sys

    return bool(sys.stderr and sys.stderr.isatty()) or "ipykernel" in sys.modules


def _bar(words: str, done: tuple[int, int] | None) -> None:
    """A progress bar on standard error."""
    import sys

    bar = ""
    if done:
        full = 30 * done[0] // max(done[1], 1)
        bar = f"{'#' * full}{'.' * (30 - full)} {done[0]}/{done[1]}  "
    end = "\n" if words == "drawing" else ""
    print(f"\r{bar}{words}"[:110].ljust(110), end=end, file=sys.stderr, flush=True)


@dataclass(frozen=True)
class Change:
    """A row of the table of changes. `EP` is an end of the sweep, `PB` a P-bifurcation, `LV` a level that is crossed,
    `MX` values without a density. `value` and `error` are in units of the parameter, `lower` and `upper` the bracket;
    `status` is one of located, unchecked, unresolved, unconfirmed; `reason` says what speaks against a value."""

    label: str
    parameter: str
    value: float
    error: float
    lower: float
    upper: float
    observable: str
    before: str
    after: str
    status: str
    change: str
    method: str
    reason: str


class Changes(list[Change]):
    """The rows, a list that a notebook shows as a table."""

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            for row in self:
                if row.label == key:
                    return row
            raise KeyError(key)
        return super().__getitem__(key)

    def to_pandas(self) -> pandas.DataFrame:
        """The rows as a DataFrame, one column a field of `Change`."""
        import pandas

        names = [one.name for one in fields(Change)]
        return pandas.DataFrame([[getattr(row, name) for name in names] for row in self], columns=names)

    def _repr_html_(self) -> str:
        names = ["label", "value", "error", "observable", "before", "after", "change", "status", "reason"]
        head = "".join(f"<th>{name}</th>" for name in names)
        rows = (
            "".join(f"<td>{html.escape(_short(getattr(row, name)))}</td>" for name in names)
            for row in self
            if not row.label.startswith("EP")
        )
        return f"<table><tr>{head}</tr>" + "".join(f"<tr>{row}</tr>" for row in rows) + "</table>"


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


class Plots:
    """Pictures by matplotlib, each onto `ax` where one is given."""

    def __init__(self, of: _Found) -> None:
        self._of = of

    def diagram(self, name: str = "x", ax: Any = None, **options: Any) -> Any:
        """The marginal density of `name` as colours over the parameter, peaks and valleys as dots, changes as lines.

        Gives the axes that were drawn on; `options` go to `pcolormesh`."""
        import numpy as np

        ax = _axes(ax)
        arrays = self._of._arrays()
        parameter, family = arrays[self._of.parameter], _density(arrays, name)
        edges = np.concatenate([parameter[:1], (parameter[1:] + parameter[:-1]) / 2, parameter[-1:]])
        ax.pcolormesh(edges, arrays[name + "_edges"], family.T, **{"cmap": "viridis", **options})
        marks = {"peak": "white", "valley": "black"}
        for value, of, kind, place, *_, verdict in self._of._raw.features():
            if of == name and verdict == "present" and kind in marks:
                ax.plot(value, place[0], ".", color=marks[kind], markersize=2)
        for row in self._of._raw.changes():
            if row["observable"] == name:
                ax.axvline(row["value"], color="white", linestyle="--", linewidth=1)
        ax.set(xlabel=self._of.parameter, ylabel=name)
        return ax

    def marginal(self, name: str = "x", at: float | None = None, ax: Any = None, **options: Any) -> Any:
        """The marginal density of `name` at the value nearest to `at`, with its standard error as a band."""
        import numpy as np

        ax = _axes(ax)
        arrays = self._of._arrays()
        values = arrays[self._of.parameter]
        row = 0 if at is None else int(np.abs(values - at).argmin())
        p, error, x = _density(arrays, name)[row], arrays[f"p_{name}_error"][row], arrays[name]
        ax.plot(x, p, **{"label": f"{self._of.parameter} = {values[row]:g}", **options})
        ax.fill_between(x, p - error, p + error, alpha=0.3, linewidth=0)
        ax.set(xlabel=name, ylabel=f"p({name})")
        return ax

    def joint(self, name: str = "xy", at: float | None = None, ax: Any = None, **options: Any) -> Any:
        """The joint density `name` at the value nearest to `at`, as colours."""
        import numpy as np

        ax = _axes(ax)
        arrays = self._of._arrays()
        family = _density(arrays, name)
        found, _ = self._of._raw.arrays()
        dimensions = {array: names for array, names, *_ in found}[f"p_{name}"]
        values = arrays[self._of.parameter]
        row = 0 if at is None else int(np.abs(values - at).argmin())
        _, first, second = dimensions
        edges = (arrays[f"{first}_edges"], arrays[f"{second}_edges"])
        ax.pcolormesh(*edges, family[row].T, **{"cmap": "viridis", **options})
        ax.set(xlabel=first, ylabel=second, title=f"{self._of.parameter} = {values[row]:g}")
        return ax


def _density(arrays: Mapping[str, Any], name: str) -> Any:
    if f"p_{name}" not in arrays:
        known = [one[2:-6] for one in arrays if one.startswith("p_") and one.endswith("_error")]
        raise KeyError(f"no density of `{name}`: there are {', '.join(known)}")
    return arrays[f"p_{name}"]


def _axes(ax: Any) -> Any:
    if ax is None:
        import matplotlib.pyplot as plt

        _, ax = plt.subplots()
    return ax


class _Found:
    """What runs and solutions have in common."""

    _is_single = False

    def __init__(self, raw: _pbif.Found) -> None:
        self._raw = raw

    @property
    def parameter(self) -> str:
        """Name of the swept parameter."""
        return self._raw.parameter

    @property
    def observables(self) -> list[str]:
        """Names of the densities that are watched: `x` a marginal, `xy` a joint density."""
        return self._raw.observables

    @property
    def toml(self) -> str:
        """The complete sweep file. Read again it gives the same sweep."""
        return self._raw.toml

    def _arrays(self) -> dict[str, NDArray[np.float64]]:
        return {name: values for name, _, values, _ in self._raw.arrays()[0]}

    @property
    def fields(self) -> Fields:
        """The fields of passages over the state that `[passage]` asked for, by name: `fields["cross_committor"]`."""
        return Fields(self._raw, self._is_single)

    def field(self, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Values and errors of a field of a passage over the state; `fields` has its axes and its unit besides."""
        one = self.fields[name]
        return one.values, one.errors

    def to_xarray(self) -> xarray.Dataset:
        """Densities `p_x` (∫ = 1), fields of passages, their errors, moments and measures over the parameter, as an
        xarray Dataset.

        Cells have centres `x`, edges `x_edges` and CF bounds `x_bounds`; attributes hold equations, the parameters that
        are held (JSON) and the table of changes (CSV). What the solver leaves below zero in a density is zero
        here, and what is left is scaled so that the integral stays."""
        import xarray

        arrays, attributes = self._raw.arrays()
        dataset = xarray.Dataset(attrs=dict(attributes))
        for name, dimensions, values, attrs in arrays:
            dataset[name] = (dimensions, values, attrs)
        for name, unit in self._raw.fields():
            for array in (name, name + "_error"):
                dataset[array].attrs["units"] = unit
        values = dataset[self.parameter].values
        columns = self._raw.columns()
        solved = [v in set(values.tolist()) for v in columns[self.parameter][0].tolist()]
        for name, (column, unit) in columns.items():
            if unit and name not in dataset:
                dataset[name] = (self.parameter, column[solved], {"units": unit})
        return dataset.set_coords([name for name in dataset if str(name).endswith(("_bounds", "_edges"))])

    def to_netcdf(self, path: Path) -> None:  # type: ignore[valid-type]
        """Writes densities and moments as NetCDF classic; nothing but the library is needed."""
        self._raw.export(path, False)

    @property
    def figures(self) -> list[str]:
        """Names of the figures that `figure` draws."""
        return self._raw.figure_names()

    def figure(self, name: str | None = None, at: Sequence[float] = ()) -> Figure | None:
        """A figure of the library by its name, the first without one; `None` where there is nothing to see. Marginals
        and joint densities are drawn at the computed values nearest to `at`."""
        return self._raw.figure(name if name is not None else self.figures[0], list(at))

    @property
    def plot(self) -> Plots:
        """Pictures by matplotlib."""
        return Plots(self)


class Run(_Found):
    """A run: what was found along a sweep, and its folder."""

    def __init__(self, raw: _pbif.Found) -> None:
        super().__init__(raw)
        self._detected: dict[str, Detected] = {}

    def __repr__(self) -> str:
        return f"<pbif.Run {self._raw.title!r}: {len(self)} values, {len(self.bifurcations)} changes>"

    def __len__(self) -> int:
        return len(self._raw.columns()[self.parameter][0])

    def _repr_html_(self) -> str:
        figure = self.figure()
        shown = (figure.svg if figure else "") + self.changes._repr_html_()
        return shown + (self.detected_changes._repr_html_() if self._detected else "")

    @property
    def folder(self) -> str:
        """The folder. One that was not named is removed with the last object that holds it, unless it is kept."""
        return str(self._raw.folder)

    def keep(self) -> str:
        """Keeps the folder for good, and gives it."""
        self._raw.keep()
        return self.folder

    @property
    def changes(self) -> Changes:
        """The table of changes, ends of the sweep included, in ascending parameter; `changes["PB1"]` is one row."""
        return Changes(Change(**row) for row in self._raw.changes())

    @property
    def bifurcations(self) -> Changes:
        """The P-bifurcations alone."""
        return Changes(row for row in self.changes if row.label.startswith("PB"))

    @property
    def points(self) -> dict[str, Any]:
        """Columns over the values of the parameter: the parameter, `status`, every measure and its error (`…_error`)."""
        return {name: values for name, (values, _) in self._raw.columns().items()}

    @property
    def units(self) -> dict[str, str]:
        """Units of the columns, made of `t` and the names of axes."""
        return {name: unit for name, (_, unit) in self._raw.columns().items()}

    @property
    def signatures(self) -> list[dict[str, str]]:
        """What was counted at every value, by observable."""
        return [dict(zip(self.observables, one)) for one in self._raw.seen()[0]]

    @property
    def detected(self) -> Detections:
        """What your own detectors say: `detected["bumps"]` of one that the sweep was given by that name, and
        `detected(function, of="x")` of another one."""
        return Detections(self, self._detected)

    @property
    def detected_changes(self) -> DetectedChanges:
        """The brackets in which answers of the detectors of the sweep change."""
        return DetectedChanges(row for one in self._detected.values() for row in one.changes)

    def _solving(self) -> Callable[[float], _pbif.Found]:
        """Solves values, one after the other, as the sweep would."""
        opened: list[_pbif.Session] = []

        def solve(at: float) -> _pbif.Found:
            if not opened:
                opened.append(self._raw.session())
            return opened[0].solve(at)

        return solve

    def spectrum(self, of: str = "x") -> dict[str, NDArray[np.float64]]:
        """A spectrum that `[spectrum]` asked for: the power spectrum of an observable, or the cross spectrum of `"x, v"`.

        `parameter` has n values and `frequency` m; `power` and `power_error` are (n, m), and so are `imaginary` and
        `imaginary_error` of a cross spectrum. Frequencies are angular, per unit time."""
        return self._fluctuations("spectra.csv", "frequency", of)

    def correlation(self, of: str = "x") -> dict[str, NDArray[np.float64]]:
        """A correlation function that `[spectrum]` asked for: `parameter` (n), `lag` (m), `covariance` and `covariance_error` (n, m)."""
        return self._fluctuations("correlations.csv", "lag", of)

    def _fluctuations(self, table: str, along: str, of: str) -> dict[str, NDArray[np.float64]]:
        import numpy as np

        path = os.path.join(self.folder, table)
        if not os.path.isfile(path):
            raise KeyError(f"{table}: `[spectrum]` did not ask for it")
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        known = sorted({row["of"] for row in rows})
        own = [row for row in rows if row["of"] == of]
        if not own:
            raise KeyError(f"no spectrum of `{of}`; there are those of {', '.join(known)}")
        number = lambda name: np.array([float(row[name]) for row in own])  # noqa: E731
        values = list(dict.fromkeys(number(self.parameter)))
        columns = [name for name in own[0] if name not in (self.parameter, "of", along) and own[0][name] != ""]
        found = {name: number(name).reshape(len(values), -1) for name in columns}
        return {"parameter": np.array(values), along: number(along)[: len(own) // len(values)], **found}

    def to_pandas(self) -> pandas.DataFrame:
        """The columns of `points` as a DataFrame."""
        import pandas

        return pandas.DataFrame(self.points)

    def explore(self, height: int = 640) -> Page:
        """The explorer: a page that slides through the densities. A notebook shows it in a frame."""
        return Page(self._raw.page(), height)

    def curve(
        self,
        row: str | None = None,
        second: str | None = None,
        bounds: tuple[float, float] | None = None,
        *,
        out: Path | None = None,  # type: ignore[valid-type]
        resume: bool = False,
        figures: bool = False,
        threads: int | None = None,
        progress: bool | Tell | None = None,
        **settings: Any,
    ) -> Curves:
        """Follows the curves from a row in the plane of the swept and a second parameter, within `bounds` of the second.

        `settings` are further keys of `[curve]`, such as `first_from`, `step` and `branches`."""
        from ._text import settings as text

        given: dict[str, Any] = dict(settings)
        if second is not None:
            given["parameter"] = second
        if bounds is not None:
            given["from"], given["to"] = bounds
        if row is not None:
            given["rows"] = [row]
        return Curves(self._raw.curve(text({"curve": given}), out, how(resume, figures, threads, progress)))

    def __reduce__(self) -> tuple[Any, ...]:
        return open_run, (self.keep(),)


def open_run(folder: Path, **settings: Any) -> Run:  # type: ignore[valid-type]
    """Opens the run in a folder. Keys of `detect`, `locate` and `figures` can be set anew: `detect={"confidence": 0.99}`."""
    from ._text import settings as text

    return Run(_pbif.open(folder, text(settings)))


class Solution(_Found):
    """What was found at one value of the parameter."""

    _is_single = True

    def __repr__(self) -> str:
        return f"<pbif.Solution {self.parameter} = {self.value:g}: {self.status}, {self.signatures}>"

    def _repr_html_(self) -> str:
        figure = self.figure("marginals") if "marginals" in self.figures else None
        return (figure.svg if figure else "") + html.escape(repr(self))

    @property
    def value(self) -> float:
        """The value."""
        return float(self._raw.columns()[self.parameter][0][0])

    @property
    def status(self) -> str:
        """`solved`, `escaping`, `not-converged`, `no-steady-state`, `several-classes` or `failed`."""
        return str(self._raw.columns()["status"][0][0])

    @property
    def measures(self) -> dict[str, float]:
        """Numbers of the value and their errors (`…_error`): moments, rates, times of passage."""
        numbers = self._raw.columns().items()
        return {name: float(one[0]) for name, (one, _) in numbers if name not in ("status", self.parameter)}

    @property
    def signatures(self) -> dict[str, str]:
        """What was counted, by observable."""
        return dict(zip(self.observables, self._raw.seen()[0][0]))

    @property
    def findings(self) -> list[str]:
        """What must be known of it, in words."""
        return self._raw.seen()[1][0]

    def density(self, name: str = "x") -> NDArray[np.float64]:
        """A density by its name, one value a cell, ∫ = 1; a joint density with a row a cell of its first axis."""
        found: NDArray[np.float64] = _density(self._arrays(), name)[0]
        return found

    def edges(self, axis: str = "x") -> NDArray[np.float64]:
        """The edges of the cells of an axis."""
        return self._arrays()[axis + "_edges"]


@dataclass(frozen=True)
class Curve:
    """A curve of P-bifurcations: `points` has a row a point with both parameters, `to_edge` goes from there to one edge
    of the band that is believed to hold the curve, the other edge is as far on the other side."""

    observable: str
    indicator: str
    points: NDArray[np.float64]
    to_edge: NDArray[np.float64]
    status: list[str]
    ends: list[tuple[str, str]]


class _Plane:
    """What curves and maps have in common."""

    def __init__(self, raw: _pbif.Plane) -> None:
        self._raw = raw

    @property
    def folder(self) -> str:
        """The folder."""
        return str(self._raw.folder)

    @property
    def parameters(self) -> tuple[str, str]:
        """Names of both parameters."""
        first, second = self._raw.sides
        return first[0], second[0]

    @property
    def curves(self) -> list[Curve]:
        """The curves."""
        return [Curve(**one) for one in self._raw.curves()]

    @property
    def codimension_two(self) -> list[dict[str, Any]]:
        """Points where two conditions meet: label, kind, values, error, status."""
        names = ("label", "kind", "values", "error", "status")
        return [dict(zip(names, one)) for one in self._raw.codimension_two()]

    @property
    def figures(self) -> list[str]:
        """Names of the figures that `figure` draws."""
        return self._raw.figure_names()

    def figure(self, name: str | None = None) -> Figure | None:
        """A figure of the library by its name, the first without one."""
        return self._raw.figure(name if name is not None else self.figures[0])

    def explore(self, height: int = 640, progress: bool | Tell | None = None) -> Page:
        """The explorer of the plane; its densities are solved for it."""
        return Page(self._raw.page(how(False, False, None, progress)["tell"]), height)

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """The curves by matplotlib, each with its name."""
        ax = _axes(ax)
        for one in self.curves:
            label = f"{one.observable}: {one.indicator}"
            ax.plot(one.points[:, 0], one.points[:, 1], **{"label": label, **options})
        ax.set(xlabel=self.parameters[0], ylabel=self.parameters[1])
        return ax

    def _repr_html_(self) -> str:
        figure = self.figure() if self.figures else None
        return figure.svg if figure else ""

    def __reduce__(self) -> tuple[Any, ...]:
        self._raw.keep()
        return open_plane, (self.folder,)


class Curves(_Plane):
    """Curves that were followed from a row of a run."""

    def __repr__(self) -> str:
        return f"<pbif.Curves in {' and '.join(self.parameters)}: {len(self.curves)}>"

    def __iter__(self) -> Iterator[Curve]:
        return iter(self.curves)


class Map(_Plane):
    """A map of regimes in the plane of two parameters."""

    def __repr__(self) -> str:
        return f"<pbif.Map of {' and '.join(self.parameters)}: {len(self.curves)} curves>"

    @property
    def nodes(self) -> list[dict[str, Any]]:
        """The values that were solved, with the signature of every density."""
        names, watched = self.parameters, self._raw.observables
        return [{**dict(zip(names, at)), "status": status, **dict(zip(watched, seen))} for at, status, seen in self._raw.nodes()]


def open_plane(folder: Path) -> Curves | Map:  # type: ignore[valid-type]
    """Opens the folder of curves or of a map."""
    raw = _pbif.open_plane(folder)
    return Map(raw) if raw.is_map else Curves(raw)


class Page:
    """A page of the explorer, one file that needs nothing else."""

    def __init__(self, text: str, height: int) -> None:
        self.html, self._height = text, height

    def save(self, path: Path) -> None:  # type: ignore[valid-type]
        """Writes the page."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.html)

    def _repr_html_(self) -> str:
        text = html.escape(self.html, quote=True)
        return f'<iframe srcdoc="{text}" width="100%" height="{self._height}" style="border:0"></iframe>'
