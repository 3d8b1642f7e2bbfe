"""The results of a fit by key: numbers, their standard deviations, and the verdict."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from ..inputs.names import ANGLES
from ..motion.notebook import HasRecord
from ..motion.quantity import unit_name
from .implied_body import BODY_INPUTS, DeterminedProduct, completed_body, determined_products
from .least_squares import Fit
from .model import (
    MEANINGS,
    STATE,
    DerivedNumber,
    as_recorded,
    chi2_bounds,
    derived_numbers,
    motion_angles,
    residual_of,
    std_of,
)
from .parameters import BODY_QUANTITIES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ANGLES = ("theta0", "psi_zero", "phi_zero")
"""Quantities whose keys end in a unit."""
FAILED = "failed"
_MUCH = 2.0
"""Residuals of a channel, over its noise, beyond which a fit has failed."""
MUCH_CHI2 = 100.0
"""Chi^2 per degree of freedom beyond which a fit has failed: residuals are ten times sigma."""
_SURE = 4.0
"""Number of standard deviations from which b counts as not 0."""


def flat_numbers(numbers: Iterable[tuple[str, Any, Any]]) -> dict[str, Any]:
    """Return numbers by key, each followed by its standard deviation as KEY_std."""
    found: dict[str, Any] = {}
    for key, value, std in numbers:
        found |= {key: value, f"{key}_std": std}
    return found


class Outcome(HasRecord):
    """The results of a fit for one recording."""

    def __init__(self, found: Fit, index: int, *, radians: bool = False) -> None:
        self.fit, self.index, self.radians = found, index, radians
        self.per_radian, self.angle = angle_unit(radians=radians)
        self.recording = found.recordings[index]
        parameters = found.parameters
        self.stds = parameters.known.stds
        values, self.covariance = found.quantities(index)
        self.labels = list(parameters.labels)
        self.values = dict(zip(self.labels, values.tolist(), strict=True))
        deviations = np.sqrt(np.maximum(np.diag(self.covariance), 0))
        self.deviations = dict(zip(self.labels, deviations.tolist(), strict=True))
        self.known = {x: self.values.get(x, y) for x, y in parameters.known.items()}
        exact = self.known.keys() - self.stds.keys()
        shown = {"a", "b", "b/a", *["r0"] * parameters.spins} - exact
        self.shown = {x: y for x, y in self.values.items() if x in shown}
        self.determined = determined_products(self.shown, self.known)
        self.residuals_by_row = found.residuals[index]
        self.residuals = {x: residual_of(values) for x, values in self.residuals_by_row.items()}

    @property
    def chi2_dof(self) -> float:
        """Chi^2 per degree of freedom, over all recordings of the fit."""
        return self.fit.chi2 / max(self.fit.dof, 1)

    @property
    def verdict(self) -> str:
        """`failed`, `doubtful` if there are warnings only, or `good`."""
        if self.failures():
            return FAILED
        return "doubtful" if self.warnings() else "good"

    def failures(self) -> list[str]:
        """Return the reasons why the fit has failed, if there are any."""
        fit, found = self.fit, []
        if fit.rival is not None:
            shown = ", ".join(f"{name} = {fit.rival[name]:.6g}" for name in self.shown)
            found.append(f"another top explains the recording as well: {shown}")
        if fit.unknown:
            found.append(f"the recording does not determine {' and '.join(fit.unknown)}")
        if not fit.converged:
            found.append("the least squares do not converge")
        remedy = "the spin may decay: try --window" if fit.noise else "use shorter windows"
        if fit.sigma_known and self.chi2_dof > MUCH_CHI2:
            found.append(f"no motion fits the recording: chi2/dof = {self.chi2_dof:.3g}; {remedy}")
        for channel, noise in (fit.noise[self.index] if fit.noise else {}).items():
            rms = self.residuals[channel].rms
            if rms > min(_MUCH * noise, 1.0):  # a radian: then harmonics do not fit either
                off, noise_shown = (f"{x * self.per_radian:.3g}" for x in (rms, noise))
                found.append(
                    f"no motion fits the recording: {channel} is {off} {self.angle} off, "
                    f"plain harmonics {noise_shown}; {remedy}"
                )
        if not self.leaves_noise:
            found += [f"no motion fits the recording: {x}" for x in self._impossible()]
        return found

    def shown_as(self, name: str) -> tuple[str, float]:
        """Return the key of a quantity in the unit of angles in use, and its factor to this."""
        return (f"{name}_{self.angle}", self.per_radian) if name in _ANGLES else (name, 1.0)

    def found(self) -> Iterator[tuple[str, float, float]]:
        """Yield name, value and standard deviation of each fitted quantity of the motion."""
        has = {
            "r0": self.fit.parameters.spins,
            "psi_zero": "psi" in self.recording.angles,
            "phi_zero": "phi" in self.recording.angles,
        }
        for name in MEANINGS:
            is_free = name not in self.known or name in self.stds
            if name in self.labels and is_free and has.get(name, True):
                yield name, self.values[name], self.deviations[name]

    def products(self) -> Iterator[tuple[DeterminedProduct, float]]:
        """Yield the determined products of the body, except r0, and their standard deviations."""
        values = {**self.known, **self.values}
        for product in self.determined:
            if product.name != "r0":
                shares = {x: float(n) / values[x] for x, n in product.shares.items()}
                gradient = np.array([shares.get(label, 0.0) for label in self.labels])
                alone = [x for x in shares if x not in self.labels and x in self.stds]
                others = sum((shares[x] * self.stds[x]) ** 2 for x in alone)
                yield product, abs(product.value) * std_of(gradient, self.covariance, others)

    @cached_property
    def derived(self) -> Sequence[DerivedNumber]:
        """Numbers that follow from the motion, with their standard deviations."""
        spins = self.fit.parameters.spins
        return list(derived_numbers(self.values, self.covariance, spins=spins))

    def numbers(self) -> Iterator[tuple[str, float, float, str]]:
        """Yield key, value, standard deviation and meaning of every number, in the unit in use."""
        for name, value, deviation in self.found():
            key, scale = self.shown_as(name)
            yield key, value * scale, deviation * scale, MEANINGS[name]
        for name in [x for x in BODY_QUANTITIES if x in self.known and self.deviations.get(x, 0.0)]:
            yield name, self.known[name], self.deviations[name], "known, improved by the fit"
        for product, deviation in self.products():
            meaning = "" if len(product.powers) == 1 else "only this product is known"
            yield product.name, product.value, deviation, meaning
        for x in self.derived:
            key = unit_name(x.key, radians=self.radians)
            scale = 1.0 if key == x.key else math.radians(1.0)
            distance = "" if x.off is None else f", {x.off:+.{int(abs(x.off) < 10)}f} sigma"
            yield key, x.value * scale, x.std * scale, x.meaning + distance

    def correlations(self) -> Iterator[tuple[str, str, float]]:
        """Yield the correlations of a, b and r0."""
        names = [name for name in self.shown if self.deviations[name] > 0]
        for first, second in combinations(names, 2):
            both = self.covariance[self.labels.index(first), self.labels.index(second)]
            yield first, second, float(both) / (self.deviations[first] * self.deviations[second])

    def undetermined(self) -> list[str]:
        """Return sentences on inputs that are not determined separately."""
        several = [(x.name, list(x.powers)) for x in self.determined if len(x.powers) > 1]
        return [f"{', '.join(x[:-1])} and {x[-1]} are known only as {name}" for name, x in several]

    def failure(self) -> str:
        """Return why a fit has failed, with the name of the recording if it has one."""
        first, name = self.failures()[0], self.recording.name
        return f"{name}: {first}" if name else first

    def warnings(self) -> list[str]:
        """Return the reasons for doubt in the numbers; reasons of a failure come first."""
        found = self.failures()
        if self.fit.sigma_known and self.fit.dof > 0:
            low, high = chi2_bounds(self.fit.dof)
            if not low <= self.chi2_dof <= high:
                found.append(
                    f"chi2/dof = {self.chi2_dof:.3g} is beyond {low:.3g} to {high:.3g}: another "
                    "motion, or another sigma"
                )
        for channel, left in self.residuals.items():
            if not left.is_noise:
                found.append(
                    f"the residuals of {channel} are not noise: neighbours correlate by "
                    f"{left.lag1:.2f}, noise by at most {3 / math.sqrt(left.rows):.2f}"
                )
        return [*found, *self._impossible()] if self.leaves_noise else found

    @property
    def leaves_noise(self) -> bool:
        """Whether the residuals of all channels are noise."""
        return all(left.is_noise for left in self.residuals.values())

    def _impossible(self) -> Iterator[str]:
        """Yield a sentence if C/A is impossible, unless the spin is too small to decide."""
        b, r0 = self.values.get("b", 0.0), self.values.get("r0", 0.0)
        if r0 and abs(b) > _SURE * self.deviations.get("b", 0.0) and not 0 < b / r0 <= 2:
            yield f"C/A = {b / r0:.3g} is impossible: a rigid body has 0 < C/A <= 2"

    def notes(self) -> list[str]:
        """Return sentences on how the recording was interpreted."""
        if not self.recording.is_mirrored:
            return []
        if self.verdict != "good":
            return ["psi may be counted in the other direction: this fit changed its sign"]
        return ["psi is counted in the other direction: its sign was changed"]

    def curves(self) -> Any:
        """Yield the curves of the picture, one for each recorded angle."""
        from .report import curves_of

        return curves_of(self)

    def plot(self, figure: Figure | None = None) -> Figure:
        """Draw data, motion and residuals, on a figure of matplotlib or a new one; return it."""
        from .. import draw_outcome  # the face of the package: drawn by a subpackage above

        drawn: Figure = draw_outcome(self, figure)
        return drawn

    def record(self) -> dict[str, Any]:
        """Return everything by key, flat."""
        recording = self.recording
        record: dict[str, Any] = {"name": recording.name} if recording.name else {}
        record |= flat_numbers(number[:3] for number in self.numbers())
        record |= {f"{x.key}_off_sigma": x.off for x in self.derived if x.exact}
        for name, value in self.known.items():
            key, scale = self.shown_as(name)
            record.setdefault(key, value * scale)
        for first, second, value in self.correlations():
            record[f"{first}_{second}_correlation"] = value
        low, high = chi2_bounds(max(self.fit.dof, 1))
        record |= {
            "t_start": recording.t_start,
            "rows": recording.t.size,
            "dof": self.fit.dof,
            "chi2_dof": self.chi2_dof if self.fit.sigma_known else None,
            "chi2_dof_low": low,
            "chi2_dof_high": high,
        }
        for channel, left in self.residuals.items():
            record[f"{channel}_rms_{self.angle}"] = left.rms * self.per_radian
            record[f"{channel}_lag1"] = left.lag1
        return record | {
            "verdict": self.verdict,
            "remark": "; ".join([*self.notes(), *self.undetermined(), *self.warnings()]) or None,
        }

    def inputs(self, other: Mapping[str, float] | None = None) -> dict[str, float]:
        """Return inputs of `Top` with this motion, or with other values of the quantities.

        Undetermined inputs are those of `completed_body`.
        """
        values = self.values if other is None else other
        known = {x: values.get(x, y) for x, y in self.known.items() if x in BODY_INPUTS}
        shown = {x: values[x] for x in self.shown}
        body = completed_body(shown, known)
        start = {name: values[name] for name in ("thetadot0", "psidot0")}
        return {**body, "theta0_deg": math.degrees(values["theta0"]), **start}

    def angles(self, t: Array) -> dict[str, Array]:
        """Return the angles of the fitted motion, with the zeros and signs of the recording."""
        values = self.values
        found = motion_angles(np.array([[values[name] for name in STATE]]), t)[:, 0]
        if "phi" not in self.recording.angles:
            values = values | {"r0": values["b"]}
        return dict(zip(ANGLES, as_recorded(found, values, t), strict=True))
