"""Neighbours of the fitted top that a recording shows, and their effect on the numbers of the fit.

The templates and the residuals are projected off the changes by the parameters of the top.  The
rest of a template gives its size.  The part that is projected off gives its effect on the numbers
of the fit.  If the recording shows several neighbours, the likeliest are compared again, each by
forces along the motion that it has changed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.special import fdtrc, ndtri

from ..arithmetic.text import uncertain_text
from ..arithmetic.types import Array
from .measured import Measured
from .neighbours import LOST, WANDER, Neighbour, lost_text, machines, misread, unround, wander
from .residuals import CHANCE, ROUNDING, Residuals
from .variations import Variations

SMALL = 0.01
"""Size of a neighbour that counts in the model error if the recording does not show it."""
_SURE = 4.0
"""Standard deviations of a neighbour that is shown; more if it is searched at many places, or in
windows."""
_MAYBE = 2.5
"""Standard deviations within which a neighbour may be there unseen, and from which rows may be
lost."""
_ALIKE = 6.0
"""Difference of chi^2 below which two neighbours explain a recording equally well."""
_EDGE = 6
"""Rows at either end in which no step is sought; fewer in a recording of few rows."""
_EXPLAINS = 4.0
"""Fall of chi^2, as a factor, by a neighbour that explains a motion far from that of any top."""
_LIKELIEST = 5
"""Number of neighbours among which the name is chosen, and of those that a line lists."""
_LARGEST = 0.5
"""Size above which a change is not small, so that its template is wrong."""
_LARGEST_WANDER = 0.1
"""The same of a clock, whose wander resembles strong friction, and much else."""
_POINTS = 96
"""Points of the grid in a period of the nutation."""
_PER_TURN = 10
"""Points of the grid in a turn of the spin."""
_MOST_POINTS = 9000
"""Largest number of points of the grid."""
_MOST_TRIED = 400_000
"""Spins times points up to which a spin that is not recorded is searched."""
_POLE = 0.03
"""Least sin(theta) of a motion whose changes by forces are computed."""
_DEPENDENT = 1e-7
"""Ratio of singular values below which parameters are not determined."""


class Finding:
    """What a recording shows of a neighbour of the fitted top, along a motion.

    It has the `size` and its standard deviation, the `sizes` in each direction, the `fall` of
    chi^2 to `chi2`, and the mean square `noise` of the residuals, wider if they correlate.  Its
    `score` is set when findings are ranked.
    """

    score: float

    def __init__(self, fit: Neighbours, one: Neighbour, motion: Variations) -> None:
        self.fit, self.one, self.motion = fit, one, motion
        raw = np.stack([fit.columns(x, one.row) for x in one.changes], axis=1)
        shared = fit.basis.T @ raw
        left, values, axes = np.linalg.svd(raw - fit.basis @ shared, full_matrices=False)
        sure = values > 1e-6 * np.linalg.norm(raw)
        left, inverse, count = left[:, sure], axes[sure].T / values[sure], max(int(sure.sum()), 1)
        parts = left.T @ fit.rest
        rest = fit.rest - left @ parts
        self.sizes, self.by_one = inverse @ parts, -fit.inverse @ shared
        self.fall, self.chi2 = float(parts @ parts), float(rest @ rest)
        self.rests = fit.by_channel(rest)
        wide = np.repeat([x.widening() for x in self.rests], [x.y.size for x in self.rests])
        self.noise = float(np.sum((wide * rest) ** 2)) / fit.free + fit.least
        self.size = float(self.sizes[0] if len(raw.T) == 1 else np.linalg.norm(self.sizes))
        spread = math.sqrt(self.noise / count) * float(np.linalg.norm(inverse))
        self.std = spread if sure.any() else math.inf
        freedom = max(fit.free / float(np.mean(wide**2)) - count, 1.0)
        chance = float(fdtrc(count, freedom, self.fall / self.noise / count))
        self.sigmas = -float(ndtri(max(chance, 1e-300) / 2))

    @property
    def is_shown(self) -> bool:
        """Whether it is there and moves a number of the fit by a standard deviation or more."""
        return self.is_there and self.effect >= 1

    @property
    def is_there(self) -> bool:
        """Whether the recording shows it."""
        least = math.sqrt(_SURE**2 + 2 * math.log(self.one.tried * CHANCE / self.fit.chance))
        return self.is_possible and self.sigmas >= least

    @property
    def is_possible(self) -> bool:
        """Whether its sign is possible, its size is small, and it leaves residuals of a top."""
        most = 1 / (2 * math.pi) ** 2 if self.one.is_square else _LARGEST  # half is left
        most = _LARGEST_WANDER if self.one.name == WANDER else most
        size = abs(self.size)
        is_possible = size < most and (self.size > 0 or not self.one.is_positive)
        if self.one.name == LOST:
            is_possible = self.size > 0.5 and abs(size - round(size)) < max(3 * self.std, 0.1)
        if self.one.is_square and math.sqrt(size) * self.fit.period > self.fit.recording.frame:
            is_possible &= not all(x.is_white for x in self.rests)  # it smooths the noise, too
        is_far = any(x.is_large or x.outliers.any() for x in self.rests)
        explains = not is_far or self.chi2 * _EXPLAINS < self.fit.chi2
        return is_possible and explains and math.isfinite(self.std)

    @cached_property
    def effect(self) -> float:
        """How far it moves a number of the fit at most, in standard deviations of the fit."""
        fit = self.fit
        stds = math.sqrt(self.noise) * np.linalg.norm(fit.inverse[: fit.spins], axis=1) + 1e-300
        return float(np.max(np.abs(self.by_one[: fit.spins] @ self.sizes) / stds))

    @property
    def change(self) -> Array:
        """The change of the motion by it and by the parameters that it moves."""
        moved = self.motion.by_parameters
        parameters = np.tensordot(self.by_one @ self.sizes, moved[self.fit.kept], 1)
        return np.asarray(np.tensordot(self.sizes, self.one.changes, 1) + parameters)

    @cached_property
    def shifts(self) -> dict[str, Array]:
        """Relative changes of numbers by a size that may be there unseen, in each direction."""
        small = SMALL ** (1 + self.one.is_square)
        unseen = min(small, abs(self.size) + _MAYBE * self.std)
        return self.fit.relative(self.by_one * max(unseen, self.fit.smoothing * self.one.is_square))

    @property
    def is_untested(self) -> bool:
        """Whether the recording could not show one of the size SMALL."""
        return self.std * _SURE > SMALL ** (1 + self.one.is_square)

    @property
    def directions(self) -> int:
        """The number of its parameters."""
        return len(self.one.changes) + (self.one.tried > 1)

    @property
    def text(self) -> str:
        """Its name with its size, and the time or the spin at which it was found."""
        one, recording, where = self.one, self.fit.recording, ""
        if one.name == LOST:
            return lost_text(recording, one.row, self.size)
        if one.row:
            where = f" t = {recording.t_start + float(recording.t[one.row]):.6g}"
        elif math.isfinite(self.motion.ratio) and self.fit.spins == 5:
            where = f", if r0 = {self.motion.b * self.motion.ratio / self.fit.period:.3g}"
        root = math.sqrt(abs(self.size)) + 1e-300
        pair = (root, self.std / 2 / root) if one.is_square else (self.size, self.std)
        unit = 180 / math.pi if "degrees" in one.amount else 100.0
        shown = uncertain_text(*(unit * x for x in pair))
        return f"{one.name} {one.amount.format(shown)}{where}"


class Neighbours:
    """The neighbours of a fitted top, against its residuals over their standard deviations.

    `rest` are the residuals in radians, shape (channels, times).  The fit `is_failing` if they are
    not those of a top.  `smoothing` is the square of the width of a filter, over the period, if one
    made the noise smooth.  `chance` is the probability that noise fails a test.
    """

    def __init__(
        self,
        recording: Measured,
        residuals: Mapping[str, Residuals],
        motion: Variations,
        rest: Array,
        period: float,
        *,
        smoothing: float = 0.0,
        is_failing: bool = False,
        chance: float = CHANCE,
    ) -> None:
        self.recording, self.residuals, self.motion = recording, residuals, motion
        self.period, self.smoothing, self.is_failing = period, smoothing, is_failing
        self.chance, self.rows, one = chance, recording.t / period, recording
        noise = [
            one.sigma.get(x)
            or max(min(y.rms, y.neighbours if is_failing else math.inf), y.step / math.sqrt(12))
            for x, y in residuals.items()
        ]
        self.sizes = np.maximum(noise, ROUNDING)[:, np.newaxis]
        self.least = float(np.mean((ROUNDING / self.sizes) ** 2))
        self.spins = 5 + ("phi" in one.angles)  # a, b, the start, r0
        self.kept = [*range(self.spins), *[6] * (self.spins > 5), *[7] * ("psi" in one.angles)]
        columns = self.columns(motion.by_parameters[self.kept].swapaxes(0, 1)).T
        norm = np.linalg.norm(columns, axis=0) + 1e-300
        left, values, axes = np.linalg.svd(columns / norm, full_matrices=False)
        sure = values > _DEPENDENT * values[0]
        self.basis, self.inverse = left[:, sure], axes[sure].T / values[sure] / norm[:, np.newaxis]
        rest = (rest / self.sizes)[one.present]
        self.rest = rest - self.basis @ (self.basis.T @ rest)
        self.chi2 = float(self.rest @ self.rest)
        self.free = max(self.rest.size - self.basis.shape[1], 2)

    def columns(self, changes: Array, row: int = 0) -> Array:
        """Return changes on the grid as changes of the channels in the rows, in the last axis."""
        t, tilt = self.motion.t, self.motion.angles[0]
        theta, phi, psi = make_interp_spline(t, changes, axis=-1)(self.rows)
        tilt = make_interp_spline(t, tilt)(self.rows)
        found = {"theta": theta, "phi": phi, "psi": psi}
        found |= {"across": np.sin(tilt) * psi, "along": phi + np.cos(tilt) * psi}
        shown = np.stack([found[x] for x in self.recording.channels], axis=-2) / self.sizes
        shown = shown * (np.arange(self.rows.size) >= row)
        return np.asarray(shown[..., self.recording.present])

    def by_channel(self, rest: Array) -> list[Residuals]:
        """Return residuals by channel, from those over their standard deviations."""
        one, whole = self.recording, np.full(self.recording.present.shape, np.nan)
        whole[one.present] = rest
        found = zip(whole * self.sizes, one.present, self.residuals.values(), strict=True)
        return [replace(old, t=one.t[x], y=y[x]) for y, x, old in found]

    def relative(self, moved: Array) -> dict[str, Array]:
        """Return relative changes of numbers by changes of parameters; that of r0 may be unseen."""
        x = self.motion
        spin = moved[5] / x.r0 if self.spins > 5 and x.r0 else 0 * moved[0]
        tilt = x.by_parameters[self.kept, 0, 0] @ moved / x.angles[0, 0]
        return {"a": moved[0] / x.a, "b": moved[1] / (x.b or math.inf), "r0": spin, "theta0": tilt}

    def _everywhere(self, motion: Variations) -> Iterator[Neighbour]:
        """Yield the neighbours of a motion that act in all rows."""
        yield from machines(motion)
        yield from misread(motion, self.recording)

    def _from_row(self, motion: Variations) -> Iterator[Neighbour]:
        """Yield steps of the angles and of the clock."""
        for x in self.recording.angles:
            yield Neighbour(f"a jump of {x}", "by {} degrees at", [motion.only(**{x: 1.0})])
        yield Neighbour(LOST, "", [motion.rates * self.recording.frame / self.period])

    @cached_property
    def findings(self) -> list[Finding]:
        """What the recording shows of machines, and of faults of clock, camera and angles."""
        return [Finding(self, x, self.motion) for x in self._everywhere(self.motion)]

    @cached_property
    def steps(self) -> list[Finding]:
        """A step of each angle and of the clock, at the row where it explains most."""
        present, found = self.recording.present, []
        rows = np.broadcast_to(np.arange(self.rows.size), present.shape)[present]
        order = np.argsort(-rows, kind="stable")
        last = np.flatnonzero(np.diff(rows[order], append=-1))  # of the numbers of a row
        inner = slice(edge := min(_EDGE, (last.size - 1) // 2), last.size - edge)
        for one in self._from_row(self.motion):
            column = self.columns(one.changes[0])
            parts = np.stack([column * self.rest, column**2, *(column * self.basis.T)])
            work, size, *taken = np.cumsum(parts[:, order], axis=1)[:, last]
            left = size - np.sum(np.square(taken), axis=0)
            gains = np.where(left > 0.02 * size.max() / self.rows.size, work**2, 0.0)
            row = int(rows[order][last[np.argmax((gains / (left + 1e-300))[inner]) + edge]])
            found.append(Finding(self, one._replace(row=row, tried=self.rows.size), self.motion))
        return found

    def _turning(self) -> Iterator[Finding]:
        """Yield bodies that are not round, with the spin that explains most, if it is not seen."""
        x = self.motion
        rates = np.arange(abs(x.b) / 2, 2 * math.pi * _POINTS / _PER_TURN, 1.5 / x.length)
        size = rates.size * max(x.t.size, self.rest.size)
        if not (math.isnan(x.ratio) and x.b and 0 < size < _MOST_TRIED):
            return
        spins = np.copysign(rates, x.b)[:, np.newaxis]
        for one in unround(x, x.angles[1] + (spins - x.b) * x.since):
            columns = np.stack([self.columns(y) for y in one.changes], axis=-1)
            columns = columns - self.basis @ (self.basis.T @ columns)
            left, sizes, _ = np.linalg.svd(columns, full_matrices=False)
            parts = np.where(sizes > 1e-6 * sizes.max(), self.rest @ left, 0.0)
            best = int(np.argmax(np.sum(parts**2, axis=1)))
            changes, spin = [y[:, best] for y in one.changes], float(spins[best, 0])
            motion = x.along(x.only(phi=(spin - x.b) * x.since), spin / x.b)
            yield Finding(self, one._replace(changes=changes, tried=rates.size), motion)

    @cached_property
    def shown(self) -> list[Finding]:
        """The neighbours that the recording shows, the best first."""
        likely = [*self.findings, *self.steps, Finding(self, wander(self.motion), self.motion)]
        if not (self.is_failing or any(x.is_shown for x in likely)):
            return []
        likely += self._turning() if self.is_failing else []
        followed = [self._followed(x) for x in self._ranked(likely)[:_LIKELIEST]]
        found = [x for x in followed if x.is_there] if any(x.is_shown for x in followed) else []
        return self._ranked(found)

    def _ranked(self, found: list[Finding]) -> list[Finding]:
        """Return findings by their scores: falls of -2 log(likelihood) minus costs."""
        best = min(found, key=lambda x: x.chi2, default=None)
        count = best.chi2 / best.noise if best else 0.0  # of independent residuals
        for x in found:
            fall = count * math.log((self.chi2 + self.least) / (x.chi2 + self.least))
            x.score = fall - x.directions * math.log(self.free)
        return sorted(found, key=lambda x: -x.score)

    def _followed(self, first: Finding) -> Finding:
        """Return what the recording shows of a neighbour along the motion that it has changed.

        If this explains less, as for a clock that changes rates by much, return what was found.
        """
        begin, old = first.motion, first.one
        motion = begin.along(first.change * (old.row == 0), begin.ratio)
        every = chain(self._everywhere(motion), self._from_row(motion), [wander(motion)])
        one = next(x for x in every if x.name == old.name)
        found = Finding(self, one._replace(row=old.row, tried=old.tried), motion)
        return min(first, found, key=lambda x: x.chi2)

    @cached_property
    def late(self) -> Finding | None:
        """Rows that may be lost, which only a fit with a gap can decide."""
        found = self.steps[-1]
        is_hinted = found.sigmas > _MAYBE and found.effect > 1 and found.size > 0.5
        return found if is_hinted and not found.is_shown else None

    @property
    def name(self) -> str:
        """The best neighbour, and others that explain as much; empty if none is shown."""
        alike = [x.text for x in self.shown[:3] if x.score > self.shown[0].score - _ALIKE]
        return " or ".join(alike)

    @cached_property
    def untested(self) -> list[Finding]:
        """The neighbours of the size SMALL that the recording could not show, the largest first."""
        found = [x for x in self.findings if x.is_untested]
        return sorted(found, key=lambda x: -max(np.abs([*x.shifts["a"], *x.shifts["b"]])))

    def errors(self, *, has_moment: bool) -> dict[str, float]:
        """Return the relative model errors of a, b, A, C and theta0 by what is not shown.

        A known moment A has none.
        """
        hidden = [x.shifts for x in self.findings if not x.is_shown]
        hidden += [self.relative(x.by_one @ x.sizes[:, np.newaxis]) for x in (self.late,) if x]
        a, b, tilt, r0 = (
            np.concatenate([x[y] for x in hidden]) for y in ("a", "b", "theta0", "r0")
        )
        moment = 0 * a if has_moment else -a
        found = {"a": a, "b": b, "A": moment, "C": b + moment - r0, "theta0": tilt}
        return {x: float(np.linalg.norm(y)) for x, y in found.items()}

    @property
    def line(self) -> str:
        """The neighbours that move the numbers most, if the recording does not test them."""
        names = ", ".join(x.one.name for x in self.untested[:_LIKELIEST])
        late = f", and maybe {self.late.text}" if self.late else ""
        return f"1 % each of {names}, which the recording cannot show{late}" if names else late[2:]


def neighbours_of(
    recording: Measured,
    residuals: Mapping[str, Residuals],
    motion: Array,
    inputs: Mapping[str, float],
    period: float,
    **others: Any,
) -> Neighbours | None:
    """Return the neighbours of a motion with some inputs of `Top`, given in the rows.

    All others are those of `Neighbours`.  The result is None if there are none: of one angle, or of
    a motion that passes a pole.
    """
    one, has = recording, inputs
    if len(one.channels) < 2:
        return None
    weight, moment = has["m"] * has["g"] * has["s"], has["A"] / period
    a, b = 2 * weight * period / moment, has["C"] * has["r0"] / moment
    start = math.radians(has["theta0_deg"]), has["thetadot0"] * period, has["psidot0"] * period
    ratio = has["A"] / has["C"] if "phi" in one.angles and b else math.nan
    length = float(one.t[-1]) / period
    turns = np.nan_to_num(abs(b * ratio)) * length / (2 * math.pi)
    count = int(min(max(_POINTS * length, _PER_TURN * turns, 5 * _POINTS), _MOST_POINTS))
    found = Variations(np.array([a, b, *start]), ratio, np.linspace(0, length, count))
    is_away = np.isfinite(found.slopes).all() and found.sine.min() > _POLE
    rest = one.residuals(*motion)
    return Neighbours(one, residuals, found, rest, period, **others) if is_away else None
