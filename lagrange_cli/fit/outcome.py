"""The result of a fit: numbers with standard deviations, the verdict, the record and the scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from ..errors import AbsentError
from ..inputs.rotations import within_half_turn
from ..motion.notebook import HasRecord
from ..output.report import uncertain_text
from .noise import CHANCE, Residuals, chi2_bounds
from .problem import Known
from .recording import Recording, shifted_origin

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GOOD, STEADY, FAILED = "good", "good, no nutation", "failed"
_MOST = 1.0
"""Largest rms residual of a channel, in radians."""
_FINE = 1200


class Curve(NamedTuple):
    """A recorded angle and the fitted motion, in the unit of angles in use."""

    name: str
    """`theta`, `phi` or `psi`; of several recordings, after the name of one and a colon."""
    t: Array
    data: Array
    """Measured values, shifted by whole turns to the motion; NaN if missing."""
    fine_t: Array
    curve: Array
    """The motion at the fine times."""
    residual: Array
    """Data minus motion at the times t."""


@dataclass(eq=False)
class Outcome(HasRecord):
    """The result of a fit of one recording, by a nutating top or by a steady precession."""

    recording: Recording
    known: Known
    radians: bool
    numbers: Mapping[str, tuple[float, float]]
    """Every number and its standard deviation by key, in the unit of angles in use."""
    meanings: Mapping[str, str]
    """The meanings of the numbers."""
    residuals: Mapping[str, Residuals]
    """The residuals by channel, in radians."""
    dof: int
    chi2_dof: float
    """Chi^2 per degree of freedom, and the degrees of freedom."""
    frequency: float
    """The frequency of the nutation, at which residuals are searched for structure."""
    motion: Callable[[Array], Array]
    """The fitted theta, phi and psi in radians, shape (3, times), at times since the first row."""
    faults: list[str]
    """Why the motion is wrong or undetermined, besides the residuals."""
    notes: list[str]
    """How the recording was interpreted."""
    inputs: Mapping[str, float] | None = None
    """Inputs of `Top` with this motion; None for a steady precession."""
    covariance: Mapping[tuple[str, str], float] = field(default_factory=dict)
    """The covariance of a, b and r0 by pairs of keys, as far as they are parameters."""
    hints: list[str] = field(default_factory=list)
    """What to try if the fit has failed, as other fits confirm."""
    chance: float = CHANCE
    """Probability that noise fails a test."""

    def failures(self) -> list[str]:
        """Return the reasons why the fit has failed, if there are any."""
        found: list[str] = []
        if (offset := shifted_origin(self.recording)) is not None:
            shown = ", ".join(f"{x:.2g}" for x in offset)
            found.append(
                "the distance of the marker from the origin varies with its direction: is the "
                f"origin at the pivot, or is the pivot at about ({shown})?"
            )
        found += self.faults
        scale, unit = angle_unit(radians=self.radians)
        for name, rest in self.residuals.items():
            if rest.rms > _MOST:
                off = f"{rest.rms * scale:.3g} {unit}"
                found.append(f"no motion of a top matches: {name} is {off} off")
        high = chi2_bounds(self.dof, self.chance)[1]
        if self.recording.sigma and self.chi2_dof > high:
            found.append(
                f"chi2/dof = {self.chi2_dof:.3g} is above {high:.3g}: another motion, or more noise"
            )
        for name, rest in self.residuals.items():
            found += rest.faults(name, self.frequency, self.chance)
        return found

    def failure(self) -> str:
        """Return why the fit has failed and what to try, with the name of the recording."""
        name = f"{self.recording.name}: " if self.recording.name else ""
        return name + "; ".join([self.failures()[0], *self.hints])

    @property
    def verdict(self) -> str:
        """`good`, `good, no nutation` or `failed`."""
        return FAILED if self.failures() else STEADY if self.inputs is None else GOOD

    @property
    def title(self) -> str:
        """The verdict, the first three numbers, and chi^2 if sigma is given, for a picture."""
        shown = [f"{x} = {uncertain_text(*y)}" for x, y in [*self.numbers.items()][:3]]
        shown += [f"chi2/dof = {self.chi2_dof:.3g}"] * bool(self.recording.sigma)
        return f"lagtop fit: {', '.join([self.verdict, *shown])}"

    @property
    def correlations(self) -> dict[str, float]:
        """Correlations of a, b and r0 by pairs, such as `a and b`."""
        return {
            f"{x} and {y}": c / (self.numbers[x][1] * self.numbers[y][1])
            for (x, y), c in self.covariance.items()
            if x < y
        }

    @property
    def angle(self) -> str:
        """The unit of angles in use, `deg` or `rad`."""
        return angle_unit(radians=self.radians)[1]

    @property
    def middle(self) -> float:
        """The time of the middle of the recording."""
        return self.recording.t_start + float(self.recording.t[-1]) / 2

    def angles(self, t: Array) -> dict[str, Array]:
        """Return the angles of the motion at times since the first row, in radians."""
        return dict(zip(("theta", "phi", "psi"), self.motion(np.asarray(t, float)), strict=True))

    def record(self) -> dict[str, Any]:
        """Return everything by key, flat."""
        record: dict[str, Any] = {"name": self.recording.name} if self.recording.name else {}
        for key, (value, std) in self.numbers.items():
            record |= {key: value, f"{key}_std": std}
        low, high = chi2_bounds(self.dof)
        record |= {
            "t_start": self.recording.t_start,
            "rows": self.recording.t.size,
            "dof": self.dof,
            "chi2_dof": self.chi2_dof if self.recording.sigma else None,
            "chi2_dof_low": low,
            "chi2_dof_high": high,
        }
        scale, unit = angle_unit(radians=self.radians)
        for name, rest in self.residuals.items():
            record[f"{name}_rms_{unit}"] = rest.rms * scale
            record[f"{name}_autocorrelation"] = rest.autocorrelation
        remarks = [*self.notes, *self.failures(), *self.hints]
        return record | {"verdict": self.verdict, "remark": "; ".join(remarks) or None}

    def scene(self, source: str) -> str:
        """Return a scene file of the motion, whose comments have the uncertainties.

        Raises AbsentError for a steady precession.
        """
        if self.inputs is None:
            raise AbsentError("no scene is written: a steady precession does not determine a top")
        lines = [
            f"# Found by `lagtop fit` from {source}: the start is its first row, at "
            f"t = {self.recording.t_start!r}.",
            *(f"# {note}" for note in self.notes),
            *(f"# {key} = {uncertain_text(*x)}" for key, x in self.numbers.items()),
            *(f"# correlation of {pair}: {r:.3f}" for pair, r in self.correlations.items()),
            *(f"{key} = {x!r}" for key, x in self.inputs.items()),
        ]
        return "".join(f"{line}\n" for line in lines)

    def curves(self) -> Iterator[Curve]:
        """Yield the curves of the picture, one for each recorded angle."""
        recording, (scale, _) = self.recording, angle_unit(radians=self.radians)
        t, start = recording.t, recording.t_start
        fine = np.linspace(0, t[-1], _FINE)
        at_rows, at_fine = self.angles(t), self.angles(fine)
        for name in [x for x in ("theta", "psi", "phi") if x in recording.angles]:
            rest = within_half_turn(recording.angles[name] - at_rows[name])
            data, curve = (at_rows[name] + rest) * scale, at_fine[name] * scale
            label = f"{recording.name}: {name}" if recording.name else name
            yield Curve(label, t + start, data, fine + start, curve, rest * scale)

    def plot(self, figure: Figure | None = None) -> Figure:
        """Draw data, motion and residuals, on a figure of matplotlib or a new one; return it."""
        from .. import draw_outcome  # drawn by a subpackage above

        drawn: Figure = draw_outcome(self, figure)
        return drawn
