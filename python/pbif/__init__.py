"""Steady-state densities of noisy oscillators, and the parameter values where their shape changes.

A thin module over the library of the program `pbif`: nothing is computed in Python. docs/python.md shows what it does.
"""
from __future__ import annotations

from ._pbif import Figure, version as __version__
from .detected import Density, Detected, DetectedChange, DetectedChanges, Detections, Detector
from .errors import Finding, InputError, Interrupted, Location, PbifError, PbifWarning, RunError
from .fields import Field, Fields
from .found import Change, Changes, Curve, Curves, Map, Page, Run, Solution
from .found import open_plane, open_run as open
from .sweep import Session, Sweep, System, gallery, systems

read = Sweep.read

__all__ = [
    "Change", "Changes", "Curve", "Curves", "Density", "Detected", "DetectedChange", "DetectedChanges", "Detections",
    "Detector", "Field", "Fields", "Figure", "Finding", "InputError", "Interrupted", "Location", "Map", "Page",
    "PbifError", "PbifWarning", "Run", "RunError", "Session", "Solution", "Sweep", "System", "gallery", "main", "open",
    "open_plane", "read", "systems",
]


def main() -> int:
    """The program `pbif`: reads the command line, and gives the status to end with."""
    import signal
    import sys

    from . import _pbif

    # As a program of its own hears them.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _pbif.main(["pbif", *sys.argv[1:]])
