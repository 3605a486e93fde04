"""Your own detectors: a function that looks at a density, and where its answer changes along a sweep."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: How often a bracket is halved at most.
HALVINGS = 60


@dataclass(frozen=True)
class Density:
    """A density at one value of the parameter, as a detector sees it.

    `values` has one number a cell (∫ = 1), a joint density a row a cell of its first axis; `errors` are standard errors of
    the same shape; `centres` and `edges` of the cells stand by the names of the axes."""

    name: str
    at: float
    values: NDArray[np.float64]
    errors: NDArray[np.float64]
    centres: dict[str, NDArray[np.float64]]
    edges: dict[str, NDArray[np.float64]]


@dataclass(frozen=True)
class DetectedChange:
    """An answer that changes between two values of the parameter. The change is somewhere between `lower` and `upper`:
    a function says nothing of how it comes, so that there is a bracket, and neither a value nor an error."""

    lower: float
    upper: float
    before: Any
    after: Any


@dataclass(frozen=True)
class Detected:
    """The answers of a detector, in ascending parameter, and where they change."""

    values: list[float]
    answers: list[Any]

    @property
    def changes(self) -> list[DetectedChange]:
        """The brackets in which the answer changes, in ascending parameter."""
        known = list(zip(self.values, self.answers))
        pairs = zip(known, known[1:])
        return [DetectedChange(low, high, one, other) for (low, one), (high, other) in pairs if one != other]

    def __iter__(self) -> Iterator[tuple[float, Any]]:
        return iter(zip(self.values, self.answers))

    def __len__(self) -> int:
        return len(self.values)


Detector = Callable[[Density], Any]


def densities(found: Any, name: str) -> list[Density]:
    """A density at every value at which it is known."""
    arrays, _ = found._raw.arrays()
    by_name = {array: (names, values) for array, names, values, _ in arrays}
    if f"p_{name}" not in by_name:
        raise KeyError(f"no density `{name}`; there are {', '.join(found.observables)}")
    (_, *axes), family = by_name[f"p_{name}"]
    errors = by_name[f"p_{name}_error"][1]
    centres = {axis: by_name[axis][1] for axis in axes}
    edges = {axis: by_name[f"{axis}_edges"][1] for axis in axes}
    values = by_name[found.parameter][1].tolist()
    return [Density(name, at, family[row], errors[row], centres, edges) for row, at in enumerate(values)]


def detected(found: Any, detector: Detector, name: str, within: float | None, solve: Callable[[float], Any]) -> Detected:
    """The answers along a run; brackets in which they change are halved until they are no wider than `within`."""
    answers = {one.at: detector(one) for one in densities(found, name)}
    places = sorted(answers)
    brackets = [pair for pair in zip(places, places[1:]) if answers[pair[0]] != answers[pair[1]]]
    for low, high in brackets if within is not None else []:
        _narrow(answers, (low, high), within, lambda at: [detector(one) for one in densities(solve(at), name)])
    places = sorted(answers)
    return Detected(places, [answers[at] for at in places])


def _narrow(answers: dict[float, Any], first: tuple[float, float], within: float, ask: Callable[[float], list[Any]]) -> None:
    brackets = [(first, 0)]
    while brackets:
        (low, high), halvings = brackets.pop()
        middle = 0.5 * (low + high)
        if high - low <= within or halvings == HALVINGS or not low < middle < high:
            continue
        found = ask(middle)
        # Where there is no density there is no answer, and the bracket stays as it is.
        if not found:
            continue
        answers[middle] = found[0]
        parts = ((low, middle), (middle, high))
        brackets += [(part, halvings + 1) for part in parts if answers[part[0]] != answers[part[1]]]
