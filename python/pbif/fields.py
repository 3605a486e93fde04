"""Fields of passages over the state."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Field:
    """A field of a passage over the state: mean time, committor, density or current of processes on their way.

    Of a solution, `values` has one number a cell, a row a cell of the first axis, and `at` is the value of the
    parameter; of a run, both have one more dimension, which comes first. `errors` have the shape of `values`; what is
    not known is NaN in both. `unit` is made of `t` and the names of axes; `centres` and `edges` of the cells stand by
    these names."""

    name: str
    unit: str
    at: Any
    values: NDArray[np.float64]
    errors: NDArray[np.float64]
    centres: dict[str, NDArray[np.float64]]
    edges: dict[str, NDArray[np.float64]]


class Fields(Mapping[str, Field]):
    """The fields by their names; numbers are copied from the library when a field is asked for, once."""

    def __init__(self, raw: Any, is_single: bool) -> None:
        self._raw, self._is_single = raw, is_single
        self._units: dict[str, str] = dict(raw.fields())

    def __getitem__(self, name: str) -> Field:
        found = self._raw.field(name) if name in self._units else None
        if found is None:
            raise KeyError(f"no field `{name}`; there are {', '.join(self._units) or 'none'}")
        at, values, errors, axes = found
        if self._is_single:
            at, values, errors = float(at[0]), values[0], errors[0]
        centres = {axis: middles for axis, middles, _ in axes}
        edges = {axis: ends for axis, _, ends in axes}
        return Field(name, self._units[name], at, values, errors, centres, edges)

    def __iter__(self) -> Iterator[str]:
        return iter(self._units)

    def __len__(self) -> int:
        return len(self._units)

    def __repr__(self) -> str:
        return f"<pbif.Fields: {', '.join(self._units) or 'none'}>"
