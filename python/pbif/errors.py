"""What goes wrong, and what is warned of."""
from __future__ import annotations

import warnings
from typing import NamedTuple


class Location(NamedTuple):
    """Where something stands in a sweep file, as people count: from 1."""

    source: str
    line: int
    column: int


class Finding(NamedTuple):
    """One finding in what was given."""

    title: str
    location: Location | None


class PbifError(Exception):
    """Something cannot be done. The words are those of the program."""


class RunError(PbifError):
    """A folder cannot be read or written."""


class InputError(PbifError, ValueError):
    """What was given is wrong: all that was found, drawn with the lines in which it stands.

    `findings` are all of them, `location` is the place of the first that has one.
    """

    def __init__(self, words: str, findings: list[tuple[str, tuple[str, int, int] | None]] | None = None) -> None:
        super().__init__(words)
        self.findings = [Finding(title, Location(*place) if place else None) for title, place in findings or []]

    @property
    def location(self) -> Location | None:
        """File, line and column of the first finding that has a place."""
        return next((one.location for one in self.findings if one.location), None)


class Interrupted(KeyboardInterrupt):
    """Work was interrupted. What was solved is kept in `folder`: the same call with `out=folder, resume=True` goes on."""

    def __init__(self, folder: str | None = None) -> None:
        super().__init__(f"interrupted; what was solved is kept in {folder}" if folder else "interrupted")
        self.folder = folder


class PbifWarning(UserWarning):
    """Something worth knowing of what was given or found."""


def warn(words: str) -> None:
    """Warns at the first line outside of this package."""
    import sys

    level, frame = 1, sys._getframe()
    while frame and frame.f_globals.get("__name__", "").partition(".")[0] == "pbif":
        level, frame = level + 1, frame.f_back  # type: ignore[assignment]
    warnings.warn(words, PbifWarning, stacklevel=level)
