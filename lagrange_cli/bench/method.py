"""Methods that `bench` compares: functions for the angles of a top, and rows of the report."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any, NamedTuple

from ..arithmetic.types import Array
from ..inputs.top import Top

OURS = "lagtop"
NOT_APPLICABLE = "not applicable"

Drift = tuple[float | None, float | None]
"""Changes of energy and vertical momentum in a run, over the sum of their terms."""


class Work(NamedTuple):
    """The work of a run, which is the same on every machine; unknown numbers are None."""

    evaluations: int | None = None
    """Evaluations of the right-hand side; for a Taylor method, its steps times its order."""
    steps: int | None = None
    jacobians: int | None = None


class Run(NamedTuple):
    """The result of a method at some times, and its cost."""

    angles: Sequence[Any]
    """Tilt, spin and precession (radians), each an array or a list with the length of the times."""
    work: Work = Work()
    drift: Drift = (None, None)


AngleFunction = Callable[[Array], Run]
"""A function that computes the angles at times with increasing distance from 0."""


class NotApplicableError(Exception):
    """A method does not apply to this scene or this installation; the message states why."""


class FailedError(Exception):
    """The run of a method has failed; the message states how."""


FAILURES = (NotApplicableError, FailedError, ArithmeticError, ValueError)
"""Errors of methods; foreign formulas in doubles raise the last two."""


class Method(NamedTuple):
    """A way to compute the angles, with the settings at which it is run."""

    settings: Sequence[Any]
    prepare: Callable[[Top, Any], AngleFunction]
    """The set-up, a function of a top and a setting that returns a sampling function.

    The set-up may raise NotApplicableError, and the sampling function FailedError.
    """
    package: str = ""
    """The module that the method needs besides lagtop."""
    whole_turns: bool = True
    """Whether the method counts turns of spin and precession; otherwise they are modulo 2 pi."""
    costly: bool = False
    """Whether a sample takes a millisecond, so that only times with exact angles are timed."""
    engine: str = ""
    """The distribution of an engine that runs in a separate process; it is not imported here."""

    def start(self, top: Top, setting: Any) -> tuple[AngleFunction, float]:
        """Return the sampling function of a top, and the seconds of its set-up.

        Raises NotApplicableError if the package is missing, and the errors of `prepare`.
        """
        if missing := self.missing_package():
            raise NotApplicableError(f"needs {missing}: pip install {missing}")
        if self.package and not self.engine:
            import_module(self.package)  # before the clock starts
        begun = time.perf_counter()
        return self.prepare(top, setting), time.perf_counter() - begun

    def missing_package(self) -> str:
        """Return the name of the package to install if it is missing, or an empty text."""
        name = self.package.partition(".")[0]
        return (self.engine or name) if name and find_spec(name) is None else ""

    def mark(self) -> str | None:
        """Return the name and version of an engine, to mark its rows; None for other methods."""
        return f"{self.engine} {version(self.engine)}" if self.engine else None


class MethodRow(NamedTuple):
    """The errors and the times of one method at one setting."""

    scene: str | None
    """The name of the scene, if it was given."""
    method: str
    setting: float | str
    periods: float
    theta_max: float | None = None
    """Greatest error of theta over the checked times (rad); phi and psi follow."""
    phi_max: float | None = None
    psi_max: float | None = None
    theta_end: float | None = None
    phi_end: float | None = None
    psi_end: float | None = None
    error_rad: float | None = None
    """Greatest error of the three angles (rad)."""
    error_end: float | None = None
    units_max: float | None = None
    evaluations: int | None = None
    """The work of a run, as in `Work`."""
    steps: int | None = None
    jacobians: int | None = None
    order: float | None = None
    """Observed order: the exponent by which the error falls with the work, over settings."""
    setup_s: float | None = None
    ns_min: float | None = None
    """Nanoseconds per sample: the least of the runs, followed by their median."""
    ns_median: float | None = None
    runs: int | None = None
    front: bool = False
    """Whether no other row is both faster and more accurate."""
    remark: str | None = None


def failure_remark(error: Exception) -> str:
    """Return the remark on an error of a method."""
    return f"{NOT_APPLICABLE if isinstance(error, NotApplicableError) else 'failed'}: {error}"


def is_done(row: MethodRow) -> bool:
    """Return whether a row has an error and a time."""
    return row.error_rad is not None and row.ns_min is not None


def is_out(remark: str | None) -> bool:
    """Return whether a remark states that the method cannot do the scene, at any setting."""
    return (remark or "").startswith(NOT_APPLICABLE)
