"""Standard uncertainties of the angles over time, by linear propagation (GUM 5.1.2).

Motions beside the given one are compared with it at the same phase of the nutation, so that the
differences stay small at any time.  The exact derivatives of the period and of the mean rates give
the part that grows with time.  Proved rows give the derivatives wherever rounding errors show.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from fractions import Fraction

import numpy as np

from ..arithmetic.enclosures import decided
from ..arithmetic.numbers import unit_in_radians
from ..arithmetic.types import Array
from ..errors import LagtopError
from .derivatives import Derivatives, neighbours, sines, size_of
from .sampling import period_of, whole_periods
from .solve import Motion
from .tables import STD_COLUMNS, ProvedTable
from .uncertainty import MISLEADING, away

_STEP, _NOISE = 2.0**-17, 2.0**-33
"""Step of a stencil, and errors of a derivative, over the range of an input in which motions are
alike."""
_MOST_NOISE = 0.01
"""Largest error of an uncertainty, over itself."""
_WAVES = ("theta", "dphi", "dpsi", "dphi", "dpsi")
"""`STD_COLUMNS` without the growth at mean rates."""
_LEAST = 1e-9
"""Least error that is reported, in radians."""
_ROUNDING = 2.0**-50
"""Errors of angles over their size."""


class AngleStds:
    """Uncertainties of tilt, spin and precession of a top over time."""

    def __init__(self, motion: Motion, stds: Mapping[str, float]) -> None:
        """Take the uncertainties of the inputs as given."""
        self.motion, self.stds = motion, {name: std for name, std in stds.items() if std}
        self.misleading: dict[str, float] = {}
        """The angles for which linear propagation misleads, each with the time from which on."""
        self._away = away(motion, self.stds)
        self._excess = np.zeros(len(STD_COLUMNS))
        self.period: float | None = motion.T_nutation
        if self.period:
            of, most = motion.balls, motion.facts.equal
            self._length = decided(lambda x: period_of(of(x)["T_nutation"]), most, digits=24)
        self._record = Derivatives(motion)
        self.noise: dict[str, float] = {}
        """Sizes of the rounding errors of the derivatives, by input."""
        self.missing: set[str] = set()
        """The inputs with respect to which the angles have no derivative."""
        self._beside: dict[str, list[tuple[Motion, float]]] = {}
        """Neighbours with their weights in derivatives, by input."""
        self._slopes: dict[str, list[float]] = {}
        """Derivatives of the period and of the mean rates of spin and precession, by input."""
        keys = ("T_nutation", "mean_spin_rate", "mean_precession_rate") if self.period else ()
        for name in self.stds:
            steepness = self._steepness(name)
            self.noise[name], step = _NOISE * steepness, Fraction(_STEP / steepness)
            found = [(x, y / float(step)) for x, y in neighbours(motion, name, step) if y]
            slopes = [self._record.nearest(key, name) for key in keys]
            departs = not self.period and any(x.T_nutation for x, _ in found)
            if departs or any(map(math.isnan, slopes)):
                self.missing.add(name)
            self._beside[name], self._slopes[name] = found, slopes

    def _steepness(self, name: str) -> float:
        """Return the largest relative change of a size of the motion per unit of an input.

        Next to the separatrix k' is small, and next to a pole the sine of an extreme tilt.
        """
        sizes = {"k_prime": self.motion.k_prime, "T_nutation": self.period}
        sizes |= {key: math.degrees(x) for key, x in sines(self.motion).items()}
        found = [abs(self._record.nearest(key, name) / x) for key, x in sizes.items() if x]
        known = [float(x) for x in found if not math.isnan(x)]
        return max(1 / size_of(self.motion, name), *known, 0.0)

    def at(self, t: Array) -> Array:
        """Return the uncertainties of `STD_COLUMNS` in radians, of shape (5, times).

        They are NaN if they do not exist.  Proved rows give the derivatives wherever rounding
        errors would be more than 1 % of an uncertainty.
        """
        stds = np.array([*self.stds.values()])[:, None, None]
        changes = self.slopes(t) * stds
        noise = sum(std * self.noise[name] for name, std in self.stds.items())
        found: Array = np.sqrt((changes**2).sum(axis=0))
        doubtful = ((found > 0) & (noise > _MOST_NOISE * found)).any(axis=0)
        if doubtful.any():
            changes[:, :, doubtful] = self.proved_slopes(t[doubtful]) * stds
            found = np.sqrt((changes**2).sum(axis=0))
        self._compare(t, found)
        return found

    def slopes(self, t: Array) -> Array:
        """Return derivatives of the columns `STD_COLUMNS` at n times, of shape (inputs, 5, n).

        They are NaN after the start if they do not exist.
        """
        found = np.zeros((len(self.stds), len(STD_COLUMNS), t.size))
        phase, names = t, STD_COLUMNS
        if self.period:
            rates = self.motion.table(t, ["thetadot", "phidot", "psidot"]).values()
            means = 0.0, self.motion.mean_spin_rate, self.motion.mean_precession_rate
            waving = [rate - mean for rate, mean in zip(rates, means, strict=True)]
            _, rest, lost = whole_periods(t, self._length, float(np.abs(t).max(initial=0.0)))
            phase, names = (rest - lost) / self.period, _WAVES
        for values, name in zip(found, self.stds, strict=True):
            for motion, share in self._beside[name]:
                at = phase * (motion.T_nutation or 1.0)
                values[:] += share * motion.sampler().evaluate(at, names)
            if self.period:
                by_period, *by_rates = self._slopes[name]
                values[:] -= np.array(waving + waving[1:]) * (t * (by_period / self.period))
                values[1:3] += np.multiply.outer(by_rates, t)
            if self.motion.facts.plane:  # the other angles change by half turns only
                values[1:] = 0.0
        return self._completed(found, t)

    def proved_slopes(self, t: Array) -> Array:
        """Return the same as `slopes` from proved rows, which take some milliseconds per time."""
        found = np.zeros((len(self.stds), len(STD_COLUMNS), t.size))
        for values, name in zip(found, self.stds, strict=True):
            step, beside = self._record.neighbours(name)
            exact = np.zeros((t.size, len(STD_COLUMNS)), dtype=object)
            for motion, weight in beside:
                if weight:
                    table = ProvedTable(motion, STD_COLUMNS, 90, radians=True)
                    rows = [[Fraction(x.value) for x in table.row(Fraction(y))] for y in t.tolist()]
                    exact = exact + np.array(rows) * (Fraction(weight) / step)
            values[:] = exact.T.astype(float)
        return self._completed(found, t)

    def _completed(self, found: Array, t: Array) -> Array:
        """Return derivatives with those at t = 0, and NaN for those that do not exist."""
        for values, name in zip(found, self.stds, strict=True):
            if name in self.missing:
                values[:] = math.nan
            values[:, t == 0] = 0.0
            if name.startswith("theta0"):
                values[0, t == 0] = unit_in_radians(radians=name == "theta0_rad")
        return found

    def _compare(self, t: Array, found: Array) -> None:
        """Compare uncertainties with the spread of motions one and two standard deviations away.

        A root mean square over all rows up to a time is judged: an uncertainty that passes through
        0 has large relative errors there, which do not matter.
        """
        here, squares = _all_angles(self.motion, t), np.zeros_like(found)
        with suppress(LagtopError):  # t is beyond 2^50 periods of a motion
            for weight, beside in self._away:
                squares += weight * (_all_angles(beside, t) - here) ** 2
            least = _LEAST + _ROUNDING * np.abs(here)
            off = (np.sqrt(squares) - found) ** 2 - (MISLEADING * found) ** 2 - least**2
            order = np.argsort(np.abs(t), kind="stable")
            sums = self._excess[:, None] + np.cumsum(off[:, order], axis=1)
            for name, excess in zip(STD_COLUMNS, sums, strict=True):
                fine = np.flatnonzero(~(excess > 0))
                first = fine[-1] + 1 if fine.size else 0
                if first == t.size:
                    self.misleading.pop(name, None)
                elif first or name not in self.misleading:
                    self.misleading[name] = float(t[order[first]])
            self._excess = sums[:, -1]


def _all_angles(motion: Motion, t: Array) -> Array:
    return np.stack([*motion.table(t, STD_COLUMNS).values()])
