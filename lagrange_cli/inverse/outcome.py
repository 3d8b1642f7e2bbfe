"""The result of a fit: its numbers, verdict, record, scene and curves."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arithmetic.rotations import directed, within_half_turn
from ..arithmetic.text import uncertain_text
from ..arithmetic.types import Array
from ..errors import AbsentError, joined
from ..names import ANGLES
from ..output.notebook import HasRecord
from ..recordings.doubts import pivot_of
from ..top.inputs import DECLARED, all_replaced
from ..top.units import DEGREES, Units
from .findings import Finding, Neighbours, neighbours_of
from .known import Known
from .measured import Measured
from .minimum import APART
from .neighbours import DECAY
from .reasons import ADVICE, MISFITS, Kind, Reason
from .residuals import CHANCE, LARGEST, Noise, Residuals, chi2_bounds
from .rows import repeated
from .spins import FASTER

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FILTERED = 1e-4
"""Least share of the nutation, lost to a filter, that a note reports."""
_LENGTHS = 1.2
"""Ratio of lengths of a quaternion that noise does not make."""
PERCENT = "_percent"
"""Ending of the keys of relative errors of elementary formulas."""
GOOD, STEADY, FAILED = "good", "good, no nutation", "failed"


class Number(NamedTuple):
    """A number of a fit, with its standard deviation."""

    value: float
    std: float
    meaning: str
    own_std: float = 0.0
    """The standard deviation if known inputs are exact."""

    def __str__(self) -> str:
        return uncertain_text(self.value, self.std)

    def widened(self, error: float) -> Number:
        """Return the number with a further error."""
        if not error:
            return self
        return self._replace(
            std=math.hypot(self.std, error), own_std=math.hypot(self.own_std, error)
        )

    def scaled(self, size: float) -> Number:
        """Return the number in a smaller unit."""
        return Number(self.value * size, self.std * size, self.meaning, self.own_std * size)


class Curve(NamedTuple):
    """A recorded angle and the fitted motion, in the unit of angles in use."""

    name: str
    """The angle."""
    t: Array
    data: Array
    """Measured values, shifted by whole turns to the motion; NaN if missing."""
    fine_t: Array
    curve: Array
    residual: Array


@dataclass(eq=False, kw_only=True, repr=False)
class Outcome(HasRecord):
    """The result of a fit of one recording, by a nutating top or by a steady precession."""

    recording: Measured
    known: Known
    in_radians: Mapping[str, Number]
    """The numbers by key; those of angles end in `_rad`."""
    motion: Callable[[Array], Array]
    """The fitted theta, phi and psi in radians, shape (3, times), at times since the first row."""
    parameters: int
    """The number of parameters that the recording determines."""
    frequency: float
    """The frequency of the nutation, at which residuals are searched for structure."""
    noise: Mapping[str, Noise]
    """What the data show of their noise, by channel."""
    units: Units = DEGREES
    """The units of texts and records."""
    reasons: Sequence[Reason] = ()
    """Why the fit has failed, besides the residuals: the top or a known input; and advice."""
    notes: Sequence[str] = ()
    """What was assumed, and how the recording was interpreted."""
    inputs: Mapping[str, float] | None = None
    """Inputs of `Top` with this motion; None for a steady precession."""
    arbitrary: Collection[str] = ()
    """Those of the inputs that the recording does not determine."""
    correlations: Mapping[str, float] = field(default_factory=dict)
    """Correlations of a, b and r0 by pairs such as `a and b`, as far as they are parameters."""
    distances: Mapping[str, float] = field(default_factory=dict)
    """Distances of known inputs from their values in the recording, in standard deviations."""
    turns: float = 0.0
    """Turns per row of a spin that is recorded, but not known."""
    chance: float = CHANCE
    """Probability that noise fails a test."""

    def __repr__(self) -> str:
        rows = [f"{key:22}  {x}" for key, x in self.numbers.items() if not key.endswith(PERCENT)]
        return "\n".join([f"fit of {self.recording.t.size} rows: {self.verdict}", *rows])

    @cached_property
    def residuals(self) -> dict[str, Residuals]:
        """The residuals by channel, in radians."""
        one = self.recording
        motion = self.motion(one.t)
        found = {}
        for x, y, is_in in zip(one.channels, one.residuals(*motion), one.present, strict=True):
            noise = self.noise[x]
            if x == "theta" and self.inputs is not None:
                noise = noise._replace(range=min(noise.range, float(np.ptp(motion[0]))))
            found[x] = Residuals(one.t[is_in], y[is_in], *noise)
        return found

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

    @cached_property
    def chi2_bounds(self) -> tuple[float, float]:
        """The bounds of chi2_dof that noise exceeds once in 1/chance times."""
        widest = max(rest.widening(self.chance) for rest in self.residuals.values())
        return chi2_bounds(self.dof / widest**2, self.chance)

    @cached_property
    def failed(self) -> list[Reason]:
        """Why the fit has failed, in the order of `Kind`, which is empty if it is good.

        A known input contradicts only a motion that is right.
        """
        found = sorted(self.wrong(), key=lambda x: x.kind)
        return [x for x in found if x.kind < Kind.KNOWN] or found

    def wrong(self) -> Iterator[Reason]:
        """Yield the reasons why the fit has failed, the slowest checks last."""
        yield from (x for x in self.reasons if x.kind not in ADVICE)
        for found in (self._of_data, self._misfits, self._of_neighbours):
            yield from found()

    @property
    def is_spin_slow(self) -> bool:
        """Whether the spin is slow enough to show the direction of psi."""
        return self.turns < 1 / (1 + FASTER)

    @property
    def kinds(self) -> set[Kind]:
        """The kinds of the reasons why the fit has failed."""
        return {x.kind for x in self.failed}

    @property
    def is_open(self) -> bool:
        """Whether the recording determines no top, or several."""
        return any(x.kind is Kind.OPEN for x in self.failed)

    @property
    def hints(self) -> list[Reason]:
        """What to try if the fit has failed, as other fits confirm."""
        return [x for x in self.reasons if x.kind in ADVICE]

    def failures(self) -> list[Reason]:
        """Return the reasons why the fit has failed.

        A machine is left out if rows or another reading explain the recording, if rows that seem
        lost are not, or if the spin decays and the machine is not a decay.
        """
        others = {Kind.ROWS, Kind.READING, Kind.CHECK}
        others |= set() if DECAY in self.shown else {Kind.WINDOWS}
        is_other = any(x.kind in others for x in [*self.failed, *self.hints])
        kept = [x for x in self.failed if not (is_other and x.kind is Kind.MACHINE)]
        return kept or self.failed

    def _of_neighbours(self) -> Iterator[Reason]:
        """Yield what else than a Lagrange top the recording shows.

        Windows show a decay by their means.
        """
        first = next(iter(self.shown), None)
        if first and not (self.recording.name and first == DECAY):
            shows = "the recording shows more than a Lagrange top"
            yield Reason(Kind.MACHINE, f"{shows}: {self.neighbour}")

    def _of_data(self) -> Iterator[Reason]:
        """Yield what is wrong with the rows, whatever the motion."""
        if text := repeated(self.recording):
            yield Reason(Kind.ROWS, text)
        marker = self.recording.position
        if marker is not None and (pivot := pivot_of(marker)) is not None:
            where = f"the pivot is at {pivot}: subtract it" if str(pivot) else "is it at the pivot?"
            varies = "the distance of the marker from the origin varies with its direction"
            yield Reason(Kind.DATA, f"{varies}: {where}")
        given = self.recording.source.given.get("quaternion", np.ones((1, 4)))
        lengths = np.linalg.norm(directed(given), axis=1)  # 0 is a missing number
        least, most = np.nanmin(lengths), np.nanmax(lengths)
        if most > _LENGTHS * least:
            text = f"the length of the quaternion varies from {least:.3g} to {most:.3g}"
            yield Reason(Kind.DATA, f"{text}, as if each component was smoothed alone")

    def _misfits(self) -> Iterator[Reason]:
        """Yield why the motion does not match the recording."""
        scale, unit = self.units.radian, self.units.angle
        for name, rest in self.residuals.items():
            if rest.is_large:
                off = f"{name} is {rest.rms * scale:.3g} {unit} off"
                of = f", a third of its range or more, {rest.range * scale:.3g} {unit}"
                text = f"no motion of a top matches: {off}{of * (rest.rms <= LARGEST)}"
                yield Reason(Kind.MOTION, text)
        for name, rest in self.residuals.items():
            if rest.outliers.any():
                row = np.abs(rest.y).argmax()
                off = f"{name} is {abs(rest.y[row]) * scale:.3g} {unit} off"
                at = self.recording.t_start + rest.t[row]
                yield Reason(Kind.OUTLIER, f"{off} at t = {at:.6g}, far more than elsewhere")
        for name, rest in self.residuals.items():
            yield from rest.faults(name, self.frequency, self.chance / len(self.residuals))
        chi2, high = self.chi2_dof, self.chi2_bounds[1]
        if chi2 is not None and chi2 > high:
            sigma = self.recording.sigma
            times, name = max((rest.rms / sigma[x], x) for x, rest in self.residuals.items())
            above = f"chi2/dof = {chi2:.3g} is above {high:.3g}"
            more = f"a different motion, or more noise: the rms of {name} is {times:.3g} sigma"
            yield Reason(Kind.SIGMA, f"{above}: {more}")

    @cached_property
    def neighbours(self) -> Neighbours | None:
        """What else the recording could be; None if this cannot be said."""
        if self.inputs is None:
            return None
        others: Any = {
            "smoothing": self.lost / (2 * math.pi**2),
            "is_failing": any(self._misfits()),
            "chance": self.chance,
        }
        has = self.motion(self.recording.t), self.inputs, 1 / self.frequency
        return neighbours_of(self.recording, self.residuals, *has, **others)

    @property
    def shown(self) -> dict[str, Finding]:
        """The neighbours that the recording shows by name, the best first."""
        return {x.one.name: x for x in self.neighbours.shown} if self.neighbours else {}

    @property
    def late(self) -> Finding | None:
        """Rows that may be lost from a recording whose fit is good; a fit with a gap decides."""
        return self.neighbours.late if self.neighbours and not self.failed else None

    @property
    def neighbour(self) -> str:
        """What else than a Lagrange top the recording shows, or empty."""
        return self.neighbours.name if self.neighbours else ""

    @property
    def untested(self) -> str:
        """What the recording cannot show, or empty."""
        if self.inputs is None:
            return "without nutation, no other machine and no fault of the data can be detected"
        return self.neighbours.line if self.neighbours else ""

    @property
    def model_errors(self) -> dict[str, float]:
        """The relative model errors of a, b, A, C and the tilt, as far as the fit has them."""
        if not self.neighbours:
            return {}
        found = self.neighbours.errors(has_moment="A" in all_replaced(self.known))
        found[self.units.key("theta0_rad")] = found.pop("theta0")
        return {x: y for x, y in found.items() if x in self.numbers}

    @property
    def remarks(self) -> list[str]:
        """The notes, unless the motion that they describe does not match."""
        if any(x.kind in MISFITS for x in self.failed):
            return []
        return [*self.notes, *self._on_noise()]

    def _on_noise(self) -> Iterator[str]:
        """Yield notes on the size of the noise, and on its correlation."""
        low, chi2 = self.chi2_bounds[0], self.chi2_dof
        if chi2 is not None and chi2 < low:
            yield f"chi2/dof = {chi2:.3g} is below {low:.3g}: the noise is below sigma"
        widest = max(rest.widening(self.chance) for rest in self.residuals.values())
        if widest > 1 and not self.failed:
            note = (
                "the residuals correlate from row to row (smoothed data, or an encoder): standard "
                f"deviations are multiplied by {widest:.2g}"
            )
            if self.lost > _FILTERED:
                smaller = f"the nutation is {100 * self.lost:.2g} % too small"
                note += f"; if a filter smoothed the data, {smaller}, and late by its width"
            yield note

    @property
    def noisiness(self) -> float:
        """The sum of the logarithms of usual residuals over the range of the data.

        A few rows do not change it, nor does another unit.
        """
        found = 0.0
        for name, rest in self.residuals.items():
            size = self.noise[name].range
            usual = float(np.median(np.abs(rest.y))) + 1e-12
            found += math.log(usual / (size if 0 < size < math.inf else 1.0) + 1e-12)
        return found

    def deviance(self, other: Outcome) -> float:
        """Return how much larger -2 log(likelihood) is than that of another fit of these rows."""
        pairs = [(x, other.residuals[y]) for y, x in self.residuals.items() if y in other.residuals]
        return sum(x.y.size * 2 * math.log((x.rms + 1e-12) / (y.rms + 1e-12)) for x, y in pairs)

    def differs(self, other: Outcome) -> bool:
        """Return whether another fit is that of another top, whatever the direction of psi."""
        one, two = self.in_radians, other.in_radians
        pairs = [(one[x], two[x]) for x in ("a", "b") if x in one.keys() & two.keys()]
        return any(abs(abs(x.value) - abs(y.value)) > APART * x.std for x, y in pairs)

    def failure(self) -> str:
        """Return why the fit has failed and what to try, with the name of the recording."""
        return self.recording.named(joined([self.failures()[0], *self.hints]))

    @property
    def verdict(self) -> str:
        """`good`, `good, no nutation` or `failed`."""
        return FAILED if self.failed else STEADY if self.inputs is None else GOOD

    @property
    def numbers(self) -> dict[str, Number]:
        """The numbers by key, in the unit of angles in use."""
        size, late = self.units.radian, self._by_delay()
        found = {x: y.widened(late.get(x, 0.0)) for x, y in self.in_radians.items()}
        return {
            self.units.key(key): x.scaled(size) if key.endswith("_rad") else x
            for key, x in found.items()
        }

    @cached_property
    def lost(self) -> float:
        """The share of the nutation that a filter takes away if it smoothed the data."""
        if self.inputs is None or not any(x.widening(self.chance) > 1 for x in self._rests):
            return 0.0
        return max(x.lost(self.frequency) for x in self._rests)

    @property
    def _rests(self) -> Collection[Residuals]:
        return self.residuals.values()

    def _by_delay(self) -> dict[str, float]:
        """Return what a filter that is late by its width changes in the first row."""
        if self.lost < _FILTERED:
            return {}
        late = math.sqrt(2 * self.lost) / (2 * math.pi * self.frequency)
        before, now, after = self.motion(np.array([-late, 0.0, late])).T
        moved, turned = np.abs(after - before) / 2, np.abs(after - 2 * now + before) / late
        keys = ("theta0_rad", "phi_zero_rad", "psi_zero_rad")
        rates = {"thetadot0": float(turned[0]), "psidot0": float(turned[2])}
        return dict(zip(keys, moved.tolist(), strict=True)) | rates

    @property
    def title(self) -> str:
        """The verdict, and chi^2 if sigma is given, for a picture."""
        chi2 = "" if self.chi2_dof is None else f", χ²/dof = {self.chi2_dof:.3g}"
        return f"Fit: {self.verdict}{chi2}"

    def record(self) -> dict[str, Any]:
        """Return everything by key, flat."""
        record: dict[str, Any] = {"name": self.recording.name} if self.recording.name else {}
        for key, number in self.numbers.items():
            record |= {key: number.value, f"{key}_std": number.std}
        record |= {f"{key}_known_sigmas": x for key, x in self.distances.items()}
        record |= {"t_start": self.recording.t_start, "rows": self.recording.t.size}
        record |= self.recording.source.source.record()
        record |= {"dof": self.dof, "chi2_dof": self.chi2_dof}
        record["chi2_dof_low"], record["chi2_dof_high"] = self.chi2_bounds
        scale, unit = self.units.radian, self.units.angle
        for name, rest in self.residuals.items():
            record[f"{name}_rms_{unit}"] = rest.rms * scale
            record[f"{name}_autocorrelation"] = rest.autocorrelation
        record |= {"neighbour": self.neighbour or None, "untested": self.untested or None}
        record |= {f"{x}_model_percent": 100 * y for x, y in self.model_errors.items()}
        remarks = [*self.remarks, *self.failures(), *self.hints]
        return record | {"verdict": self.verdict, "remark": "; ".join(remarks) or None}

    def scene(self, source: str) -> str:
        """Return a scene file of the motion, whose comments have the uncertainties.

        In SI, inputs have units.  Comments mark those that are not determined.  Raises AbsentError
        for a steady precession.
        """
        if self.inputs is None:
            raise AbsentError("no scene is written: a steady precession does not determine a top")
        lines = [
            f"# Found by `lagtop fit` from {source}: the start is its first row, at "
            f"t = {self.recording.t_start!r}.",
            *(f"# {note}" for note in self.remarks),
            *(f"# {key} = {x}" for key, x in self.numbers.items()),
            *(f"# correlation of {pair}: {r:.3f}" for pair, r in self.correlations.items()),
        ]
        for key, x in self.inputs.items():
            text = f"{key} = {x!r}"
            if self.units.si and key in DECLARED:  # theta0_deg and theta0_rad name their unit
                text = f'{key} = "{x!r} {self.units.named(DECLARED[key].unit)}"'
            lines.append(text + "  # not determined by the recording" * (key in self.arbitrary))
        return "".join(f"{line}\n" for line in lines)

    def curves(self) -> Iterator[Curve]:
        """Yield the curves of the picture, one for each recorded angle."""
        recording, scale = self.recording, self.units.radian
        t, start = recording.t, recording.t_start
        fine = np.linspace(0, t[-1], 1200)
        at_rows, at_fine = (dict(zip(ANGLES, self.motion(x), strict=True)) for x in (t, fine))
        for name in [x for x in ("theta", "psi", "phi") if x in recording.angles]:
            rest = within_half_turn(recording.angles[name] - at_rows[name])
            data, curve = (at_rows[name] + rest) * scale, at_fine[name] * scale
            yield Curve(name, t + start, data, fine + start, curve, rest * scale)

    def plot(self, figure: Figure | None = None) -> Figure:
        """Draw data, motion and residuals, on a figure of matplotlib or a new one; return it."""
        from .. import draw_outcome  # drawn by a subpackage above

        drawn: Figure = draw_outcome(self, figure)
        return drawn
