"""Methods that `bench` compares: ways to compute the angles of a top, and their rows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any, NamedTuple

from ..arithmetic.types import Array
from ..inputs.top import Top

OURS = "lagtop"
NOT_APPLICABLE = "not applicable"

SampledAngles = Sequence[Any]
"""Tilt, spin and precession (radians), each an array or a list in the length of the times."""

AngleFunction = Callable[[Array], SampledAngles]
"""Computes the angles at times that run away from 0."""


class Work(NamedTuple):
    """The work of a run, which is the same on every machine; None for a number that is unknown."""

    evaluations: int | None = None
    """Evaluations of the right-hand side; of a Taylor method, its steps times its order."""
    steps: int | None = None
    jacobians: int | None = None


class Integration:
    """A function that computes angles step by step, and counts its work."""

    def __init__(
        self,
        run: Callable[[Array], tuple[Array, Work]],
        angles: Callable[[Array], SampledAngles],
        drift: Callable[[Array], tuple[float, float]] | None,
    ) -> None:
        """Take what integrates (a row for each variable), and what its rows say."""
        self._run, self._angles, self._drift = run, angles, drift
        self.work = Work()
        """The work of the last run."""
        self.drift: tuple[float, float] | None = None
        """Changes of energy and vertical momentum in it, over the sum of their terms."""

    def __call__(self, t: Array) -> SampledAngles:
        """Return the angles at times that run away from 0."""
        rows, self.work = self._run(t)
        self.drift = self._drift(rows) if self._drift else None
        return self._angles(rows)


class NotApplicableError(Exception):
    """A method cannot do this scene, or not here; the message says why."""


class FailedError(Exception):
    """A method began and did not end well; the message says how."""


class Method(NamedTuple):
    """A way to compute the angles, with the settings that it is tried at."""

    settings: Sequence[Any]
    prepare: Callable[[Top, Any], AngleFunction]
    """Set-up: from a top and a setting to what samples.

    It may raise NotApplicableError; what it returns may raise FailedError.
    """
    package: str = ""
    """The module it needs beyond lagtop itself."""
    whole_turns: bool = True
    """Whether it counts the turns of spin and precession; if not, they are known modulo 2 pi."""
    costly: bool = False
    """A millisecond a sample: timed at the judged times only."""
    engine: str = ""
    """The distribution that it runs in a process of its own; it is not imported here."""

    def check_package(self) -> None:
        """Raise NotApplicableError where the package is missing."""
        if missing := self.missing_package():
            raise NotApplicableError(f"needs {missing}: pip install {missing}")

    def missing_package(self) -> str:
        """Return the name to install it by where its package is missing, or an empty text."""
        name = self.package.partition(".")[0]
        return (self.engine or name) if name and find_spec(name) is None else ""

    def mark(self) -> str | None:
        """Return the engine and its version, which mark its rows; None for other methods."""
        return f"{self.engine} {version(self.engine)}" if self.engine else None


class MethodRow(NamedTuple):
    """The errors and the times of one method at one setting."""

    method: str
    setting: float | str
    periods: float
    theta_max: float | None = None
    """Greatest error of theta over the judged times (rad); then those of phi and psi."""
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
    """Observed order of the method: by how much the error falls with the work, over settings."""
    setup_s: float | None = None
    ns_min: float | None = None
    """Nanoseconds per sample: the least and the median of the runs."""
    ns_median: float | None = None
    runs: int | None = None
    front: bool = False
    """Whether no other is both faster and more accurate."""
    remark: str | None = None


def is_done(row: MethodRow) -> bool:
    """Return whether a row has an error and a time."""
    return row.error_rad is not None and row.ns_min is not None


def is_out(row: MethodRow) -> bool:
    """Return whether the method cannot do the scene, at any setting."""
    return (row.remark or "").startswith(NOT_APPLICABLE)
