"""Systems and sweeps: what is asked for."""
from __future__ import annotations

import html
import uuid
from collections.abc import Mapping, Sequence
from typing import Any, Callable

from . import _pbif, _text
from .detected import Detector, Function as Detect, Watch
from .found import Map, Path, Run, Solution, Tell, how

Function = Callable[[Any, dict[str, float]], Any]


def _axis(left: str) -> str:
    """The axis of which the left side of an equation is the rate: of `x`, `x'` and `dx/dt` it is `x`."""
    left = left.strip()
    if left.startswith("d") and left.endswith("/dt"):
        return left[1:-3].strip()
    return left.removesuffix("'")


class System:
    """A system of stochastic differential equations: your own, or a built-in one by its name.

    `equations` are lines `x = …`, `x' = …` or `dx/dt = …` joined by `;` or line ends, or a mapping; `noise` gives an
    axis its amplitude, or a list of them. Other keywords are values of parameters. The language is that of sweep files.

    >>> import pbif
    >>> s = pbif.System("x = a x - x^3", noise={"x": "sqrt(s2)"}, a=0.0, s2=0.25)
    >>> run = s.sweep("a", -1, 1, 11, cells={"x": {"from": -2.2, "to": 2.2, "count": 60}})
    >>> row = run.changes["PB1"]
    >>> row.before, row.after, abs(row.value) < 1e-3
    ('1 peak', '2 peaks', True)

    What formulas do not say, a function can: `drift` takes a batch of states as an array (n × axes, the columns in the
    order of `axes`) and the parameters by name, and gives the drifts in the same shape. An amplitude in `noise` may be
    such a function too, of n values or one. Both are called by many threads, one at a time, with states that move
    freely: they must depend on nothing else, and on each state by itself. It is slow, some tens of microseconds for 64
    states, and what follows from formulas is not known: bounds, symmetry, where a force jumps. What a function raises
    is raised where the work was asked for, with a note of where. docs/python.md says more.

    >>> import numpy as np
    >>> def drift(states, p):
    ...     x = states[:, 0]
    ...     return (p["a"] * x - x**3)[:, np.newaxis]
    >>> s = pbif.System(drift=drift, axes=["x"], noise={"x": "sqrt(s2)"}, a=0.0, s2=0.25)
    >>> found = s.density("a", 0.5, cells={"x": {"from": -2.2, "to": 2.2, "count": 60}})
    >>> found.signatures["x"]
    '2 peaks'
    """

    def __init__(
        self,
        equations: str | Mapping[str, str] | None = None,
        *,
        drift: Function | None = None,
        axes: Sequence[str] = (),
        model: str | None = None,
        noise: Mapping[str, Any] | None = None,
        define: Mapping[str, str] | None = None,
        bounds: Mapping[str, Any] | None = None,
        title: str | None = None,
        parameters: Mapping[str, float] | None = None,
        **values: float,
    ) -> None:
        if isinstance(equations, str):
            lines = [line for line in equations.replace(";", "\n").splitlines() if line.strip()]
            pairs = [line.partition("=") for line in lines]
            equations = {_axis(left): right.strip() for left, _, right in pairs}
        tables = {"equations": equations, "noise": noise, "define": define, "bounds": bounds}
        self._system: dict[str, Any] = {"model": model} if model else {}
        if title:
            self._system["title"] = title
        self._system.update({name: dict(table) for name, table in tables.items() if table})
        self.parameters: dict[str, float] = {**(parameters or {}), **values}
        self._drift: tuple[Function, list[str], dict[str, Any]] | None = None
        if drift is not None:
            if equations or model or define or bounds:
                raise ValueError("a system with a `drift` has no equations, model, definitions or bounds beside it")
            if isinstance(axes, str) or not axes:
                raise ValueError('a system with a `drift` needs the names of its axes: axes=["x", "y"]')
            unknown = [name for name in noise or {} if name not in axes]
            if unknown:
                raise ValueError(f"noise on `{unknown[0]}`, which is none of the axes {list(axes)}")
            self._drift = (drift, list(axes), dict(noise or {}))
            self._system = {"title": title} if title else {}

    def __repr__(self) -> str:
        of = self._drift or self._system.get("model") or self._system.get("equations")
        return f"<pbif.System {of} {self.parameters}>"

    def with_parameters(self, **values: float) -> System:
        """The same system with other values."""
        other = System(parameters={**self.parameters, **values})
        other._system, other._drift = self._system, self._drift
        return other

    def _lent(self, parameter: str) -> _pbif.Drift | None:
        """The drift in Python as the library takes it, under a name that no other system has: what was solved of one
        function is never taken for that of another."""
        if self._drift is None:
            return None
        function, axes, noise = self._drift
        noises = []
        for name, given in noise.items():
            for one in [given] if isinstance(given, str) or callable(given) or not isinstance(given, Sequence) else given:
                text = None if callable(one) else str(one)
                noises.append((axes.index(name), text, one if callable(one) else None))
        values = {**self.parameters, parameter: self.parameters.get(parameter)}
        name = f"python-{getattr(function, '__name__', 'drift')}-{uuid.uuid4().hex[:12]}"
        return _pbif.Drift(name, self._system.get("title", "Drift in Python"), axes, list(values.items()), function, noises)

    def prepare(self, parameter: str, start: float, stop: float, points: int, **sections: Any) -> Sweep:
        """A sweep of a parameter that is ready to run: everything is checked, what is left to the library is chosen.

        `sections` are those of a sweep file: `cells={"x": {"from": -3, "to": 3, "count": 80}}`, `method`, `detect`,
        `locate`, `passage={"exit": {"start": {"x": 0, "y": 0}, "until": "abs(x) > 2"}}`, `regions`, `watch`, `levels`,
        `map`, `figures`; docs/sweep-file.md has all keys."""
        held = {name: value for name, value in self.parameters.items() if name != parameter}
        drift = self._lent(parameter)
        system = {**self._system, "parameters": held}
        if drift is not None:
            system = {"model": drift.name, "parameters": held}
        swept = {"parameter": parameter, "from": start, "to": stop, "points": points}
        return Sweep(_text.document({"system": system, "sweep": swept, **sections}), name="system", _drift=drift)

    def sweep(
        self,
        parameter: str,
        start: float,
        stop: float,
        points: int,
        *,
        out: Path | None = None,  # type: ignore[valid-type]
        resume: bool = False,
        drawn: bool = False,
        threads: int | None = None,
        progress: bool | Tell | None = None,
        detectors: Mapping[str, Detect | Detector] | None = None,
        **sections: Any,
    ) -> Run:
        """Sweeps a parameter and locates the changes: `prepare` and `Sweep.run`.

        >>> import pbif
        >>> s = pbif.System("x = a x - x^3", noise={"x": "sqrt(s2)"}, a=0.0, s2=0.25)
        >>> def middle(p):
        ...     return "low" if p.values[30] < p.values.max() / 2 else "high"
        >>> cells = {"x": {"from": -2.2, "to": 2.2, "count": 61}}
        >>> run = s.sweep("a", -1, 1, 11, cells=cells, detectors={"middle": pbif.Detector(middle, within=0.02)})
        >>> (change,) = run.detected_changes
        >>> change.before, change.after, change.lower < 0.589 < change.upper, change.upper - change.lower <= 0.02
        ('high', 'low', True, True)
        """
        sweep = self.prepare(parameter, start, stop, points, **sections)
        return sweep.run(out=out, resume=resume, figures=drawn, threads=threads, progress=progress, detectors=detectors)

    def density(self, parameter: str, value: float, **sections: Any) -> Solution:
        """The densities at one value of a parameter."""
        stop = value + 1e-6 * max(1.0, abs(value))
        return self.prepare(parameter, value, stop, 2, **sections).session().solve(value)


class Sweep:
    """A sweep file: a text, checked and made ready to run. `settings` are set on top, as `--set` does."""

    def __init__(
        self,
        text: str,
        name: str = "sweep.toml",
        settings: Mapping[str, Any] | Sequence[str] = (),
        _drift: _pbif.Drift | None = None,
    ) -> None:
        self._drift = _drift
        self._made(_pbif.Sweep(name, text, _text.settings(settings), _drift))

    def _made(self, raw: _pbif.Sweep) -> None:
        self._raw, self._about = raw, raw.about()

    @classmethod
    def read(cls, path: Path, settings: Mapping[str, Any] | Sequence[str] = ()) -> Sweep:  # type: ignore[valid-type]
        """Reads a sweep file."""
        made = cls.__new__(cls)
        made._drift = None
        made._made(_pbif.Sweep(path, None, _text.settings(settings), None))
        return made

    def __repr__(self) -> str:
        return f"<pbif.Sweep {self.title!r}, {len(self.values)} values of {self.parameter}>"

    def _repr_html_(self) -> str:
        lines = "".join(f"<div><math>{one}</math></div>" for one in self._about["typeset"])
        return lines + html.escape(repr(self))

    @property
    def title(self) -> str:
        """The title."""
        return str(self._about["title"])

    @property
    def parameter(self) -> str:
        """Name of the swept parameter."""
        return str(self._about["parameter"])

    @property
    def values(self) -> list[float]:
        """The given values of the parameter."""
        return list(self._about["values"])

    @property
    def held(self) -> dict[str, float]:
        """The parameters that are held."""
        return dict(self._about["held"])

    @property
    def equations(self) -> list[str]:
        """The equations, a line each."""
        return list(self._about["equations"])

    @property
    def toml(self) -> str:
        """The complete sweep file, every default filled in."""
        return self._raw.toml

    def run(
        self,
        out: Path | None = None,  # type: ignore[valid-type]
        *,
        resume: bool = False,
        figures: bool = False,
        threads: int | None = None,
        progress: bool | Tell | None = None,
        detectors: Mapping[str, Detect | Detector] | None = None,
    ) -> Run:
        """Solves along the parameter and locates the changes.

        `out` is the folder of the run; without one it is a folder that lasts as long as the run. With `resume` it goes on
        with what is there, and solves nothing where that is complete. `figures` draws those that the file names into the
        folder. `progress` is called with words and `(done, wanted)`, or says whether there is a bar. Ctrl-C raises
        `Interrupted`, whose folder can be gone on with.

        `detectors` are your own, by name: functions of a `Density`, that of the first watched observable, which give a
        number or a word; a `Detector` says which density, and how narrow brackets are to be. Each sees every value as
        soon as it is solved, in no certain order, on the thread that called `run`. What one raises is raised here: it
        stops the sweep, and the same call with `out` and `resume=True` goes on. The run has their
        answers. `System.sweep` has an example."""
        watch = Watch(detectors, self._about["observables"])
        raw = self._raw.run(out, how(resume, figures, threads, progress), watch.look)
        run = Run(raw)
        run._detected = watch.end(run)
        return run

    def map(
        self,
        out: Path | None = None,  # type: ignore[valid-type]
        *,
        resume: bool = False,
        figures: bool = False,
        threads: int | None = None,
        progress: bool | Tell | None = None,
    ) -> Map:
        """The map of regimes that `[map]` asks for; otherwise as `run`."""
        return Map(self._raw.map(out, how(resume, figures, threads, progress)))

    def session(self) -> Session:
        """Opens a session, which solves values one by one."""
        return Session(self._raw.session())

    def density(self, value: float) -> Solution:
        """The densities at one value of the parameter."""
        return self.session().solve(value)

    def __reduce__(self) -> tuple[Any, ...]:
        if self._drift is not None:
            raise TypeError("a sweep of a system with a drift in Python cannot be pickled: pickle the function, and make it anew")
        return Sweep, (self.toml,)


class Session:
    """Solves values of the parameter one after the other, each from what was solved before: neighbours take
    milliseconds. A session is one thread's at a time; sessions of one sweep may run side by side."""

    def __init__(self, raw: _pbif.Session) -> None:
        self._raw = raw

    def solve(self, value: float) -> Solution:
        """The densities at a value, which may lie beyond the ends of the sweep."""
        return Solution(self._raw.solve(value))

    def close(self) -> None:
        """Lets go of what it remembers."""
        self._raw.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def gallery(name: str | None = None, settings: Mapping[str, Any] | Sequence[str] = ()) -> Any:
    """A sweep file of the gallery by its name; without one, the names with their titles."""
    files = {one: (title, text) for one, title, text in _pbif.gallery()}
    if name is None:
        return {one: title for one, (title, _) in files.items()}
    if name not in files:
        raise KeyError(f"`{name}` is none of the gallery: {', '.join(files)}")
    return Sweep(files[name][1], f"{name}.toml", settings)


def systems() -> dict[str, dict[str, Any]]:
    """The built-in models by name: title, equations, axes, parameters with defaults and meanings, source."""
    names = ("title", "equations", "axes", "parameters", "source")
    return {one[0]: dict(zip(names, one[1:])) for one in _pbif.systems()}
