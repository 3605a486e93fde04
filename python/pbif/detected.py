"""Your own detectors: a function that looks at a density, and where its answer changes along a sweep."""
from __future__ import annotations

import html
from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from .errors import Interrupted

if TYPE_CHECKING:
    import numpy as np
    import pandas
    from numpy.typing import NDArray

    from .found import Run, Solution

#: How often a bracket is halved at most.
HALVINGS = 60


@dataclass(frozen=True)
class Density:
    """A density at one value of the parameter, as a detector sees it.

    `values` has one number a cell (∫ = 1), a joint density a row a cell of its first axis; `errors` are standard errors
    of the same shape; `centres` and `edges` of the cells stand by the names of the axes. `at` is the value."""

    name: str
    at: float
    values: NDArray[np.float64]
    errors: NDArray[np.float64]
    centres: dict[str, NDArray[np.float64]]
    edges: dict[str, NDArray[np.float64]]


Function = Callable[[Density], Any]


@dataclass(frozen=True)
class Detector:
    """A function, the density `of` that it looks at (the first that is watched where it has no name), and how narrow
    brackets are to be: values are solved until each is no wider than `within`; without it nothing is solved."""

    function: Function
    of: str | None = None
    within: float | None = None

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise TypeError(f"a detector is a function of a density, not {self.function!r}")
        if self.within is not None and not self.within > 0:
            raise ValueError(f"within={self.within}: a width above zero is needed, in units of the parameter")

    def __call__(self, density: Density) -> Any:
        answer = self.function(density)
        # A number of NumPy is that number.
        if getattr(answer, "shape", None) == () and hasattr(answer, "item"):
            answer = answer.item()
        if not isinstance(answer, Hashable):
            raise TypeError(f"a detector answers with a number or a word, not with {type(answer).__name__}")
        return answer


@dataclass(frozen=True)
class DetectedChange:
    """An answer that changes between two neighbouring values of the parameter. The change is somewhere between `lower`
    and `upper`, and there may be more than one: a function says nothing of how it comes, so that there is a bracket,
    and neither a value nor an error."""

    detector: str
    observable: str
    lower: float
    upper: float
    before: Any
    after: Any


class DetectedChanges(list[DetectedChange]):
    """The brackets, a list that a notebook shows as a table."""

    def to_pandas(self) -> pandas.DataFrame:
        """The brackets as a DataFrame, one column a field of `DetectedChange`."""
        import pandas

        names = [one.name for one in fields(DetectedChange)]
        return pandas.DataFrame([[getattr(row, name) for name in names] for row in self], columns=names)

    def _repr_html_(self) -> str:
        names = [one.name for one in fields(DetectedChange)]
        head = "".join(f"<th>{name}</th>" for name in names)
        short = lambda one: html.escape(f"{one:.6g}" if isinstance(one, float) else str(one))  # noqa: E731
        rows = ("".join(f"<td>{short(getattr(row, name))}</td>" for name in names) for row in self)
        return f"<table><tr>{head}</tr>" + "".join(f"<tr>{row}</tr>" for row in rows) + "</table>"


@dataclass(frozen=True)
class Detected:
    """The answers of a detector at `values` of the parameter, ascending, and where they change."""

    detector: str
    observable: str
    values: list[float]
    answers: list[Any]

    @property
    def changes(self) -> DetectedChanges:
        """The brackets in which the answer changes, ascending. An answer that is NaN twice has not changed."""
        pairs = zip(self, list(self)[1:])
        found = [(low, high, one, other) for (low, one), (high, other) in pairs if _differ(one, other)]
        return DetectedChanges(DetectedChange(self.detector, self.observable, *one) for one in found)

    def __iter__(self) -> Iterator[tuple[float, Any]]:
        return iter(zip(self.values, self.answers))

    def __len__(self) -> int:
        return len(self.values)


def _differ(one: Any, other: Any) -> bool:
    return bool(one != other) and not (bool(one != one) and bool(other != other))


class Answers(dict[float, Any]):
    """The answers of a detector by value, as they come."""

    def __init__(self, name: str, detector: Function | Detector, observables: list[str]) -> None:
        super().__init__()
        self._name = name
        self._detector = detector if isinstance(detector, Detector) else Detector(detector)
        self._of = self._detector.of if self._detector.of is not None else next(iter(observables), "")
        if self._of not in observables:
            raise KeyError(f"no density `{self._of}` for the detector `{name}`; there are {', '.join(observables)}")

    def look(self, found: Any) -> None:
        """Asks at every value of what was found that has no answer yet."""
        axes, rows = found.densities(self._of) or ([], [])
        centres = {name: middles for name, middles, _ in axes}
        edges = {name: ends for name, _, ends in axes}
        for at, values, errors in rows:
            if at not in self:
                self[at] = self._detector(Density(self._of, at, values, errors, centres, edges))

    def narrow(self, solve: Callable[[float], Any]) -> None:
        """Halves brackets in which the answer changes until each is as narrow as is wanted."""
        if self._detector.within is None:
            return
        places = sorted(self)
        brackets = [(low, high, 0) for low, high in zip(places, places[1:])]
        while brackets:
            low, high, halvings = brackets.pop()
            middle = 0.5 * (low + high)
            is_done = high - low <= self._detector.within or halvings == HALVINGS or not low < middle < high
            if is_done or not _differ(self[low], self[high]):
                continue
            self.look(solve(middle))
            # Where there is no density there is no answer, and the bracket stays as it is.
            if middle in self:
                brackets += [(low, middle, halvings + 1), (middle, high, halvings + 1)]

    @property
    def all(self) -> Detected:
        """All of them."""
        places = sorted(self)
        return Detected(self._name, self._of, places, [self[at] for at in places])


class Watch:
    """The detectors of a sweep while it runs."""

    def __init__(self, detectors: Mapping[str, Function | Detector] | None, observables: list[str]) -> None:
        self._answers = {name: Answers(name, one, observables) for name, one in (detectors or {}).items()}

    @property
    def look(self) -> Callable[[Any], None] | None:
        """What is to see every value."""
        return self._look if self._answers else None

    def _look(self, found: Any) -> None:
        for one in self._answers.values():
            one.look(found)

    def end(self, run: Run) -> dict[str, Detected]:
        """What they say of a run. Where one raises, the run is kept."""
        try:
            for one in self._answers.values():
                one.look(run._raw)
                one.narrow(run._solving())
        except KeyboardInterrupt:
            raise Interrupted(run.keep()) from None
        except BaseException as raised:
            folder = run.keep()
            if hasattr(raised, "add_note"):
                raised.add_note(f"what was solved is kept in {folder}")
            raise
        return {name: one.all for name, one in self._answers.items()}


class Detections(Mapping[str, Detected]):
    """What detectors say of a run: by their names those of the sweep (`detectors=`), and, called with a function, that
    of another one."""

    def __init__(self, run: Run, known: dict[str, Detected]) -> None:
        self._run, self._known = run, known

    def __getitem__(self, name: str) -> Detected:
        if name not in self._known:
            raise KeyError(f"the sweep had no detector `{name}`; there are {', '.join(self._known) or 'none'}")
        return self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._known)

    def __len__(self) -> int:
        return len(self._known)

    def __repr__(self) -> str:
        return f"<pbif.Detections of {', '.join(self._known) or 'none'}>"

    def __call__(self, function: Function | Detector, of: str | None = None, within: float | None = None) -> Detected:
        """What a function makes of the density `of` at every value of a run, and where its answer changes.

        `function` is called with a `Density` and gives a number or a word. With `within`, in units of the parameter,
        more values are solved until each bracket in which the answer changes is no wider. They are not added to the run.
        What the function raises is raised here.

        >>> import numpy as np, pbif
        >>> s = pbif.System("x = a x - x^3", noise={"x": "sqrt(s2)"}, a=0.0, s2=0.25)
        >>> run = s.sweep("a", -1, 1, 11, cells={"x": {"from": -2.2, "to": 2.2, "count": 60}})
        >>> def is_wide(p):
        ...     return bool(np.average(p.centres["x"] ** 2, weights=p.values) > 0.3)
        >>> (change,) = run.detected(is_wide, "x", within=1e-3).changes
        >>> change.before, change.after, change.upper - change.lower <= 1e-3
        (False, True, True)
        """
        detector = function if isinstance(function, Detector) else Detector(function, of, within)
        name = getattr(detector.function, "__name__", type(detector.function).__name__)
        answers = Answers(name, detector, self._run.observables)
        answers.look(self._run._raw)
        answers.narrow(self._run._solving())
        return answers.all
