"""The result of a fit: tests of the residuals, verdict, record, scene and curves; reports on fits.

Friction slows a real top, but the closed form has no friction.  Within a short window the loss is
below the noise.  A line through the logarithms of r0, or of b if the spin is not recorded, gives
the decay time.  The torque a = 2mgs/A does not decay: for this line, the fits are corrected to the
weighted mean of a, with which their errors of b and r0 correlate.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.special import fdtrc, gammaincinv, ndtri

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from ..errors import AbsentError
from ..files.rotations import within_half_turn
from ..output.notebook import HasRecord
from ..output.report import Field, Report, uncertain_text
from .recording import Known, Recording, shifted_origin

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GOOD, STEADY, FAILED = "good", "good, no nutation", "failed"
CHANCE = 0.0027
"""Probability that noise fails a test, as for three standard deviations."""
PERCENT = "_percent"
"""Ending of the keys of relative errors of elementary formulas."""
_COLUMNS = ("r0", "b", "theta0_deg", "theta0_rad", "T_nutation", "mean_precession_rate")
"""Numbers in the rows of windows."""
_SURE = 3.0
"""Standard deviations from which a decay is significant."""
_MOST, _ROUNDING = 1.0, 1e-10
"""Largest rms residual of a channel, and rms of rounding errors, in radians."""


class Residuals(NamedTuple):
    """The residuals of a channel at times t, in radians."""

    t: Array
    y: Array

    @property
    def rms(self) -> float:
        """The root mean square."""
        return float(np.sqrt(np.mean(self.y**2)))

    @property
    def autocorrelation(self) -> float:
        """The correlation of residuals with the next ones."""
        if self.rms < _ROUNDING or self.y.size < 2:
            return 0.0
        return float(self.y[1:] @ self.y[:-1] / (self.y @ self.y))

    def structure(self, frequency: float) -> float:
        """Return the probability that noise resembles a drifting oscillation as much.

        An F test of three harmonics of a frequency, times 1, t and t^2, against the rest.
        """
        if self.rms < _ROUNDING:
            return 1.0
        x = 2 * self.t / max(float(self.t[-1]), 1e-300) - 1
        waves = np.exp(2j * np.pi * frequency * self.t[:, np.newaxis] * np.arange(4))
        waves = np.concatenate([waves.real, waves.imag[:, 1:]], axis=1)
        drifts = x[:, np.newaxis, np.newaxis] ** range(3)
        basis = (waves[:, :, np.newaxis] * drifts).reshape(x.size, -1)[:, : max(x.size // 3, 1)]
        space, sizes, _ = np.linalg.svd(basis, full_matrices=False)
        count = int(np.sum(sizes > 1e-6 * sizes[0]))
        explained = float(np.sum((space[:, :count].T @ self.y) ** 2))
        rest = (float(self.y @ self.y) - explained) / (x.size - count)
        return float(fdtrc(count, x.size - count, explained / count / rest))

    def faults(self, name: str, frequency: float, chance: float) -> list[str]:
        """Return why the residuals are not noise, as sentences.

        A wrong motion leaves neighbours alike, unless it oscillates from row to row.
        """
        bound = -float(ndtri(chance / 2)) / math.sqrt(self.y.size)
        if not -2 * bound < self.autocorrelation < bound:
            return [
                f"the residuals of {name} are not noise: neighbours correlate by "
                f"{self.autocorrelation:.2f}, noise by at most {bound:.2f}"
            ]
        if self.structure(frequency) < chance:
            return [f"the residuals of {name} are not noise: they drift or oscillate"]
        return []


def chi2_bounds(freedom: int, chance: float = CHANCE) -> tuple[float, float]:
    """Return the bounds that chi^2 per degree of freedom of noise exceeds with this probability."""
    half = max(freedom, 1) / 2
    low, high = (float(gammaincinv(half, p)) / half for p in (chance / 2, 1 - chance / 2))
    return low, high


class Curve(NamedTuple):
    """A recorded angle and the fitted motion, in the unit of angles in use."""

    name: str
    """The angle; of several recordings, after the name of one and a colon."""
    t: Array
    data: Array
    """Measured values, shifted by whole turns to the motion; NaN if missing."""
    fine_t: Array
    curve: Array
    residual: Array


@dataclass(eq=False)
class Outcome(HasRecord):
    """The result of a fit of one recording, by a nutating top or by a steady precession.

    The numbers are values with standard deviations by key, in the unit of angles in use.
    """

    recording: Recording
    known: Known
    radians: bool
    numbers: Mapping[str, tuple[float, float]]
    meanings: Mapping[str, str]
    motion: Callable[[Array], Array]
    """The fitted theta, phi and psi in radians, shape (3, times), at times since the first row."""
    parameters: int
    """The number of parameters that the recording determines."""
    frequency: float
    """The frequency of the nutation, at which residuals are searched for structure."""
    faults: list[str]
    """Why the motion is wrong or undetermined, besides the residuals."""
    notes: list[str]
    """How the recording was interpreted."""
    inputs: Mapping[str, float] | None = None
    """Inputs of `Top` with this motion; None for a steady precession."""
    correlations: Mapping[str, float] = field(default_factory=dict)
    """Correlations of a, b and r0 by pairs such as `a and b`, as far as they are parameters."""
    hints: list[str] = field(default_factory=list)
    """What to try if the fit has failed, as other fits confirm."""
    chance: float = CHANCE
    """Probability that noise fails a test."""

    @cached_property
    def residuals(self) -> dict[str, Residuals]:
        """The residuals by channel, in radians."""
        one = self.recording
        rows = one.residuals(*self.motion(one.t))
        found = zip(one.channels, rows, one.present, strict=True)
        return {name: Residuals(one.t[known], y[known]) for name, y, known in found}

    @property
    def dof(self) -> int:
        """The number of degrees of freedom."""
        return max(int(self.recording.present.sum()) - self.parameters, 1)

    @property
    def chi2_dof(self) -> float | None:
        """Chi^2 per degree of freedom; None if no standard deviations were given."""
        if not (sigma := self.recording.sigma):
            return None
        sums = [float(np.sum((rest.y / sigma[x]) ** 2)) for x, rest in self.residuals.items()]
        return sum(sums) / self.dof

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
        high, chi2 = chi2_bounds(self.dof, self.chance)[1], self.chi2_dof
        if chi2 is not None and chi2 > high:
            found.append(
                f"chi2/dof = {chi2:.3g} is above {high:.3g}: another motion, or more noise"
            )
        for name, rest in self.residuals.items():
            found += rest.faults(name, self.frequency, self.chance)
        return found

    def failure(self) -> str:
        """Return why the fit has failed and what to try, with the name of the recording."""
        return self.recording.named("; ".join([self.failures()[0], *self.hints]))

    @property
    def verdict(self) -> str:
        """`good`, `good, no nutation` or `failed`."""
        return FAILED if self.failures() else STEADY if self.inputs is None else GOOD

    @property
    def title(self) -> str:
        """The verdict, the first three numbers, and chi^2 if sigma is given, for a picture."""
        shown = [f"{x} = {uncertain_text(*y)}" for x, y in [*self.numbers.items()][:3]]
        if self.chi2_dof is not None:
            shown.append(f"chi2/dof = {self.chi2_dof:.3g}")
        return f"lagtop fit: {', '.join([self.verdict, *shown])}"

    @property
    def angle(self) -> str:
        """The unit of angles in use, `deg` or `rad`."""
        return angle_unit(radians=self.radians)[1]

    def record(self) -> dict[str, Any]:
        """Return everything by key, flat."""
        record: dict[str, Any] = {"name": self.recording.name} if self.recording.name else {}
        for key, (value, std) in self.numbers.items():
            record |= {key: value, f"{key}_std": std}
        record |= {"t_start": self.recording.t_start, "rows": self.recording.t.size}
        record |= {"dof": self.dof, "chi2_dof": self.chi2_dof}
        record["chi2_dof_low"], record["chi2_dof_high"] = chi2_bounds(self.dof)
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
        fine = np.linspace(0, t[-1], 1200)
        names = ("theta", "phi", "psi")
        motion = dict(zip(names, zip(self.motion(t), self.motion(fine), strict=True), strict=True))
        for name in [x for x in ("theta", "psi", "phi") if x in recording.angles]:
            at_rows, at_fine = motion[name]
            rest = within_half_turn(recording.angles[name] - at_rows)
            data, curve = (at_rows + rest) * scale, at_fine * scale
            yield Curve(recording.named(name), t + start, data, fine + start, curve, rest * scale)

    def plot(self, figure: Figure | None = None) -> Figure:
        """Draw data, motion and residuals, on a figure of matplotlib or a new one; return it."""
        from .. import draw_outcome  # drawn by a subpackage above

        drawn: Figure = draw_outcome(self, figure)
        return drawn


class Decay(NamedTuple):
    """The exponential decay of r0 or of b, with chi^2 of the line through the logarithms."""

    quantity: str
    rate: float
    """The relative rate."""
    rate_std: float
    time: float | None
    """The decay time 1/rate; None if no decay is significant."""
    time_std: float | None
    chi2_dof: float

    def __str__(self) -> str:
        shown = f"does not decay: its relative rate is {uncertain_text(*self[1:3])}"
        if self.time is not None and self.time_std is not None:
            shown = f"decays with a time of {uncertain_text(self.time, self.time_std)}"
        return f"{self.quantity} {shown}; chi2/dof of the exponential: {self.chi2_dof:.2f}."


def decay_of(outcomes: Sequence[Outcome]) -> Decay | None:
    """Return the decay through windows, or None if fewer than three of them are good."""
    good = [x for x in outcomes if x.verdict == GOOD]
    if len(good) < 3:
        return None
    name = "r0" if all("r0" in x.numbers for x in good) else "b"
    values, stds = np.array([x.numbers[name] for x in good]).T
    if all((pair := f"a and {name}") in x.correlations for x in good):
        torque, torque_std = np.array([x.numbers["a"] for x in good]).T
        shared = stds * [x.correlations[pair] for x in good]
        mean = np.average(torque, weights=torque_std**-2)
        values = values + shared / torque_std * (mean - torque)
        stds = np.sqrt(stds**2 - shared**2)
    t = np.array([x.recording.middle for x in good])
    logs, weights = np.log(np.abs(values)), np.abs(values / stds)
    (slope, level), spread = np.polyfit(t, logs, 1, w=weights, cov="unscaled")
    off, rate, std = weights * (logs - level - slope * t), -float(slope), math.sqrt(spread[0, 0])
    time, time_std = (1 / rate, std / rate**2) if rate > _SURE * std else (None, None)
    return Decay(name, rate, std, time, time_std, float(off @ off) / (len(good) - 2))


def decay_text(outcomes: Sequence[Outcome]) -> str:
    """Return a sentence on the decay of the spin through windows."""
    return str(decay_of(outcomes) or "Fewer than three windows are good: the decay is not known.")


def fit_report(
    outcomes: Sequence[Outcome], source: str, units: str, *, is_windows: bool = False
) -> Report:
    """Return the report on the recordings of a file, or on its windows: a row for each of them.

    `units` are those of the known inputs.
    """
    recording, known = outcomes[0].recording, outcomes[0].known
    count, channels = sum(x.recording.t.size for x in outcomes), ", ".join(recording.channels)
    shown = [
        f"{name} = {uncertain_text(*x)}{' rad' * (name == 'theta0')}" for name, x in known.items()
    ]
    conditions = {
        "data": f"{source}: {count} rows of {channels}, from t = {recording.t_start:g}",
        "known": (", ".join(shown) or "nothing") + units,
        "sigma": "as given" if recording.sigma else "estimated from the residuals",
    }
    if is_windows:
        keys = [x for x in _COLUMNS if any(x in outcome.numbers for outcome in outcomes)]
        fields = [Field(x, x, is_text=True) for x in ("t", *keys, "verdict")]
        rows = []
        for x in outcomes:
            cells = {y: uncertain_text(*x.numbers[y]) if y in x.numbers else "" for y in keys}
            cells |= {"t": f"{x.recording.middle:.6g}", "verdict": x.verdict}
            rows.append(SimpleNamespace(**cells))
        return Report(conditions, fields, rows, [decay_text(outcomes)])
    fields = [Field(x, x, is_text=True) for x in ("key", "value", "meaning")]
    if any(x.recording.name for x in outcomes):
        fields = [Field("name", "recording", is_text=True), *fields]
    rows = [
        SimpleNamespace(
            name=x.recording.name, key=key, value=uncertain_text(*number), meaning=x.meanings[key]
        )
        for x in outcomes
        for key, number in x.numbers.items()
        if not key.endswith(PERCENT)
    ]
    conclusions = [x.recording.named(line) for x in outcomes for line in _conclusions(x)]
    return Report(conditions, fields, rows, conclusions)


def _conclusions(outcome: Outcome) -> Iterator[str]:
    """Yield sentences on one recording."""
    yield f"Verdict: {outcome.verdict}."
    if outcome.chi2_dof is not None:
        low, high = chi2_bounds(outcome.dof)
        bounds = f"noise {low:.3f} to {high:.3f}; {outcome.dof} dof"
        yield f"chi2/dof = {outcome.chi2_dof:.3f}, {bounds}."
    scale, unit = angle_unit(radians=outcome.radians)
    rest = ", ".join(f"{x} {y.rms * scale:.3g}" for x, y in outcome.residuals.items())
    yield f"RMS residual ({unit}): {rest}."
    if pairs := ", ".join(f"{x} {y:.2f}" for x, y in outcome.correlations.items()):
        yield f"Correlation: {pairs}."
    yield from (f"Note: {text}." for text in outcome.notes)
    yield from (f"Failed: {text}." for text in [*outcome.failures(), *outcome.hints])
