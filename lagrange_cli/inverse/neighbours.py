"""Neighbours of a Lagrange top: other machines, and faults of camera, clock and rows.

Each is a template, the change of the motion by a small one.  The templates and the residuals are
projected off the changes by the parameters of the top.  The rest of a template gives its size; the
part that is projected off is what it does to the numbers of the fit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Legendre
from scipy.interpolate import make_interp_spline
from scipy.special import fdtrc, ndtri

from ..arithmetic.text import uncertain_text
from ..arithmetic.types import Array
from .checks import ROUNDING, Residuals
from .measured import Measured
from .variations import Variations

SMALL = 0.01
"""Size of a neighbour that counts in the model error if the recording does not show it."""
_SURE = 4.0
"""Standard deviations of a neighbour that is shown."""
_SURE_OF_STEP = 3.5
"""The same of a step at a known row; a search among rows takes more."""
_MOVED = 1.0
"""Standard deviations by which a neighbour that is shown moves a number of the fit at least."""
_ALIKE = 6.0
"""Difference of chi^2 below which two neighbours explain a recording equally well."""
_CLOCK = "the clock"
"""The name of a step of the clock."""
_MAYBE = 2.5
"""Standard deviations of a step of the clock from which a fit with lost rows is worth its time."""
_SEARCHED = 10.0
"""Cost of the search for the row of a step, in chi^2."""
_UNSEEN = 2.0
"""Standard deviations of a neighbour that may be there beside its size."""
_LINES = 5
"""Neighbours that a line lists."""
_LARGEST = 1.0
"""Size from which a change is not a small one, so that its template is wrong."""
_WIDEST = 1 / (2 * math.pi**2)
"""The same of the square of a filter's width over the period: no nutation is left."""
_POINTS = 48
"""Points of the grid in a period of the nutation."""
_PER_TURN = 10
"""Points of the grid in a turn of the spin."""
_MOST_POINTS = 9000
"""Points of the grid at most."""
_POLE = 0.03
"""Least sin(theta) of a motion whose changes by forces are computed."""
_DEPENDENT = 1e-7
"""Ratio of singular values below which parameters are not determined."""
NUMBERS = ("a", "b", "theta0", "thetadot0", "psidot0", "r0")
"""The parameters of the motion that neighbours move."""


class Neighbour(NamedTuple):
    """A small change of a Lagrange top or of its recording."""

    name: str
    amount: str
    """Its size in words, with {} for a number of per cent."""
    changes: list[Array]
    """Changes of theta, phi and psi for the size 1, one for each of its directions."""
    is_positive: bool = False
    """Whether a negative size is impossible."""
    is_square: bool = False
    """Whether the changes are those of a square of the size."""


def machines(x: Variations) -> Iterator[Neighbour]:
    """Yield other machines than a Lagrange top.  Dry and viscous friction look alike."""
    (nods, _, turns), s, c, push = x.rates, x.sine, x.cosine, x.pushed
    over = "by {} % over the recording"
    yield Neighbour(
        "a stand that turns with the top", "with {} % of A", [push(psi=-x.slope(turns))], True
    )
    yoke = push(theta=-x.slope(nods))
    yield Neighbour("a yoke that tilts with the axis", "with {} % of A", [yoke], True)
    ring = push(theta=-turns * turns * s * c, psi=-x.slope(turns * c * c))
    yield Neighbour("a ring that does not spin", "with {} % of A", [ring], True)
    drag = push(phi=-x.b + 0 * s, psi=-x.b * c) / x.length
    mean = f"{over} (b is its mean)" if math.isnan(x.ratio) else over
    yield Neighbour("a decay of the spin", mean, [drag], True)
    damped = push(psi=-turns) / x.length
    yield Neighbour("a vertical bearing that damps", over, [damped], True)
    damped = push(theta=-nods) / x.length
    yield Neighbour("a bearing of the tilt that damps", over, [damped], True)
    yield Neighbour("a second torque", "of {} % of mgs sin(2 theta)", [push(theta=x.a * s * c)])
    axis, _, down = x.frame
    force = x.slope(x.slope(axis, 2), 2) / (2 * math.pi) ** 2
    around = axis[0] * force[1] - axis[1] * force[0]
    soft = push(theta=np.sum(force * down, axis=0), psi=around)
    yield Neighbour("a pivot that yields", "with (m s^2/A)(m/k)(2 pi/T)^2 = {} %", [soft], True)
    if math.isnan(x.ratio):
        return
    sine, cosine, half = np.sin(x.angles[1]), np.cos(x.angles[1]), -x.a / 2
    beside = [push(theta=half * c * sine, phi=half * s * cosine)]
    beside += [push(theta=half * c * cosine, phi=-half * s * sine)]
    yield Neighbour("a centre of mass off the axis", "by {} % of s", beside)
    p, q = nods * cosine + turns * s * sine, -nods * sine + turns * s * cosine
    unlike = []
    for y, z in ((p, -q), (q, p)):  # the kinetic energy grows by (p^2 - q^2)/4 and p q/2
        by_nods, by_turns = (y * cosine - z * sine) / 2, (y * sine + z * cosine) * s / 2
        by_theta, by_phi = (y * sine + z * cosine) * turns * c / 2, (y * q - z * p) / 2
        forces = {"theta": by_theta - x.slope(by_nods), "phi": by_phi, "psi": -x.slope(by_turns)}
        unlike.append(push(**forces))
    yield Neighbour("equatorial moments that differ", "by {} %", unlike)


def misread(x: Variations, kind: str, seen: Sequence[str]) -> Iterator[Neighbour]:
    """Yield faults of the clock, the camera and the angles of a kind of recording."""
    (_, phi, psi), s, c, only = x.angles, x.sine, x.cosine, x.only
    drift = x.rates * x.t**2 / (2 * x.length)
    yield Neighbour("a clock whose rate changes", "by {} %", [drift])
    place = 2 * x.t / x.length - 1
    wander = [x.rates * Legendre.basis(n)(place) * x.length / 4 for n in (3, 4, 5)]
    yield Neighbour("a clock whose rate wanders", "by {} %", wander)
    if "psi" in seen:
        mean = np.polyfit(x.t, psi, 1)[0]
        turned = [only(psi=mean * x.t)]
        yield Neighbour("a camera that turns", "with {} % of the precession", turned)
    along, beside = np.cos(psi), np.sin(psi)
    if {"theta", "psi"} <= {*seen}:
        leaning = [only(theta=along, phi=beside / s, psi=-beside * c / s)]
        leaning += [only(theta=beside, phi=-along / s, psi=along * c / s)]
        yield Neighbour("a tilted vertical of the data", "by {} % of a radian", leaning)
    if {"theta", "phi", "psi"} <= {*seen}:
        along, beside = np.cos(phi), np.sin(phi)
        askew = [only(theta=along, phi=-c * beside / s, psi=beside / s)]
        askew += [only(theta=-beside, phi=-c * along / s, psi=along / s)]
        yield Neighbour("a misaligned figure axis of the data", "by {} % of a radian", askew)
    smooth = x.slope(x.angles, 2) / 2
    if kind != "angles":
        axis, nodes, down = x.frame
        bent = x.slope(axis, 2) / 2
        turned_by = np.sum(bent * nodes, axis=0) / s
        smooth = only(theta=np.sum(bent * down, axis=0), psi=turned_by, phi=-c * turned_by)
    words = "a filter", "with a standard deviation of {} % of a period"
    yield Neighbour(*words, [smooth], True, True)
    if kind == "angles" and "theta" in seen:
        yield Neighbour("a wrong zero of theta", "by {} % of a radian", [only(theta=1.0)])
    if kind == "angles" and "psi" in seen:
        yield Neighbour("a wrong scale of psi", "by {} %", [only(psi=psi)])


class Finding(NamedTuple):
    """What a recording shows of a neighbour of the fitted top."""

    text: str
    """Its name with its size."""
    name: str
    is_possible: bool
    size: float
    std: float
    sigmas: float
    """The size in standard deviations, or the same probability in several directions."""
    gain: float
    """The fall of chi^2."""
    effect: float
    """How far it moves a number of the fit at most, in standard deviations of the fit."""
    shifts: Mapping[str, Array]
    """Changes of NUMBERS by the size that may be there unseen, for each of its directions."""

    is_untested: bool
    """Whether the recording could not show one of the size SMALL."""

    @property
    def is_shown(self) -> bool:
        """Whether it is there and matters."""
        return self.is_possible and self.sigmas >= _SURE and self.effect >= _MOVED


class Neighbours:
    """The neighbours of a fitted top, against its residuals over their standard deviations."""

    def __init__(
        self,
        recording: Measured,
        residuals: Mapping[str, Residuals],
        variations: Variations,
        rest: Array,
        period: float,
        *,
        smoothing: float,
    ) -> None:
        """Project the residuals off the changes by the parameters.

        `rest` are the residuals in radians, shape (channels, times).
        """
        self.recording, self.residuals, self.motion = recording, residuals, variations
        self.period, self.smoothing, one = period, smoothing, recording
        pairs = residuals.items()
        sizes = [one.sigma.get(x) or max(y.rms, y.step / math.sqrt(12)) for x, y in pairs]
        self.sizes = np.maximum(sizes, ROUNDING)[:, np.newaxis]
        self.least = float(np.mean((ROUNDING / self.sizes) ** 2))
        spins = "phi" in one.angles
        kept = [0, 1, 2, 3, 4, *[5, 6] * spins, *[7] * ("psi" in one.angles)]
        columns = np.stack([self.column(self.motion.by_parameters[i]) for i in kept], axis=1)
        norm = np.linalg.norm(columns, axis=0) + 1e-300
        left, values, rows = np.linalg.svd(columns / norm, full_matrices=False)
        sure = values > _DEPENDENT * values[0]
        self.basis = left[:, sure]
        self.inverse = (rows[sure].T / values[sure] / norm[:, np.newaxis])[: 5 + spins]
        rest = (rest / self.sizes)[one.present]
        self.rest = rest - self.basis @ (self.basis.T @ rest)
        self.free = max(self.rest.size - self.basis.shape[1], 2)

    def column(self, change: Array) -> Array:
        """Return a change of the angles on the grid as a change of the channels in the rows."""
        rows = make_interp_spline(
            self.motion.t, np.vstack([change, self.motion.angles[0]]), axis=-1
        )
        theta, phi, psi, tilt = rows(self.recording.t / self.period)
        found = {"theta": theta, "phi": phi, "psi": psi}
        found |= {"across": np.sin(tilt) * psi, "along": phi + np.cos(tilt) * psi}
        shown = np.stack([found[x] for x in self.recording.channels]) / self.sizes
        return np.asarray(shown[self.recording.present])

    @cached_property
    def findings(self) -> list[Finding]:
        """What the recording shows of machines, and of faults of clock, camera and angles."""
        one = self.recording
        known = [*machines(self.motion), *misread(self.motion, one.kind, [*one.angles])]
        return [self._finding(x, np.stack([*map(self.column, x.changes)], axis=1)) for x in known]

    @cached_property
    def shown(self) -> list[Finding]:
        """The neighbours that the recording shows, the best first."""
        least = math.sqrt(_SURE_OF_STEP**2 + 2 * math.log(self.recording.t.size))
        found = [(x.gain, x) for x in self.findings if x.is_shown]
        found += [(x.gain - _SEARCHED, x) for x in self.steps if x.is_shown and x.sigmas > least]
        return [x for _, x in sorted(found, key=lambda pair: -pair[0])]

    @property
    def is_late(self) -> bool:
        """Whether rows may be lost somewhere, which a fit with a gap decides."""
        return any(x.sigmas > _MAYBE and x.effect > _MOVED and x.name == _CLOCK for x in self.steps)

    @property
    def name(self) -> str:
        """The best neighbour, and others that explain as much; empty if none is shown."""
        alike = [x.text for x in self.shown[:3] if x.gain > self.shown[0].gain - _ALIKE]
        return " or ".join(alike)

    @cached_property
    def untested(self) -> list[Finding]:
        """The neighbours of the size SMALL that the recording could not show, the largest first."""
        found = [x for x in self.findings if x.is_untested]
        return sorted(found, key=lambda x: -max(np.abs([*x.shifts["a"], *x.shifts["b"]])))

    def errors(self, *, has_moment: bool) -> dict[str, float]:
        """Return the relative model errors of a, b, A and C: by neighbours that are not shown.

        A known moment A has none.
        """
        hidden = [x.shifts for x in self.findings if not x.is_shown]
        a, b, r0 = (np.concatenate([x[y] for x in hidden]) for y in ("a", "b", "r0"))
        moment = 0 * a if has_moment else -a
        found = {"a": a, "b": b, "A": moment, "C": b + moment - r0}
        return {x: float(np.linalg.norm(y)) for x, y in found.items()}

    @property
    def line(self) -> str:
        """The neighbours that move the numbers most, if the recording does not test them."""
        names = ", ".join(x.name for x in self.untested[:_LINES])
        return f"1 % each of {names}, which the recording cannot show" if names else ""

    def _widening(self, rest: Array) -> Array:
        """Return the factors of standard deviations for what correlates from row to row."""
        one, whole = self.recording, np.full(self.recording.present.shape, np.nan)
        whole[one.present] = rest
        found = zip(whole * self.sizes, one.present, self.residuals.values(), strict=True)
        wide = [Residuals(one.t[x], y[x], old.step).widening() for y, x, old in found]
        return np.asarray((np.array(wide)[:, np.newaxis] + 0 * whole)[one.present])

    def _finding(self, one: Neighbour, raw: Array) -> Finding:
        """Return what the recording shows of a neighbour whose columns are `raw`."""
        shared = self.basis.T @ raw
        left, values, rows = np.linalg.svd(raw - self.basis @ shared, full_matrices=False)
        sure = values > 1e-6 * np.linalg.norm(raw)
        left, inverse, count = left[:, sure], rows[sure].T / values[sure], max(int(sure.sum()), 1)
        parts = left.T @ self.rest
        rest = self.rest - left @ parts
        wide = self._widening(rest)
        noise = float(np.sum((wide * rest) ** 2)) / self.free + self.least
        gain, sizes = float(parts @ parts) / noise, inverse @ parts
        freedom = max(self.free / float(np.mean(wide**2)) - count, 1.0)
        chance = max(float(fdtrc(count, freedom, gain / count)), 1e-300)
        size = float(sizes[0] if sizes.size == 1 else np.linalg.norm(sizes))
        std = math.sqrt(noise / count) * float(np.linalg.norm(inverse)) if sure.any() else math.inf
        moved = self.inverse @ shared
        stds = math.sqrt(noise) * np.linalg.norm(self.inverse, axis=1) + 1e-300
        root = math.sqrt(abs(size)) + 1e-300
        pair = (root, std / 2 / root) if one.is_square else (size, std)
        largest = _WIDEST if one.is_square else _LARGEST
        is_possible = math.isfinite(std) and abs(size) < largest
        is_possible &= size > 0 or not one.is_positive
        small = SMALL**2 if one.is_square else SMALL
        shown = uncertain_text(*(100 * x for x in pair)) if is_possible else ""
        unseen = min(small, abs(size) + _UNSEEN * std)
        unseen = max(unseen, self.smoothing * one.is_square)
        return Finding(
            f"{one.name} {one.amount.format(shown)}",
            one.name,
            is_possible,
            size,
            std,
            -float(ndtri(chance / 2)),
            gain,
            float(np.max(np.abs(moved @ sizes) / stds)),
            self._shifts(moved * unseen),
            std * _SURE > small,
        )

    def _shifts(self, moved: Array) -> dict[str, Array]:
        """Return changes of NUMBERS, relative ones of a, b and r0, which is 0 without the spin."""
        sizes = {"a": self.motion.a, "b": self.motion.b, "r0": self.motion.r0}
        found = {x: np.zeros(moved.shape[1]) for x in NUMBERS}
        rows = zip(NUMBERS, moved, strict=False)
        return found | {x: y / (sizes.get(x, 1.0) or math.inf) for x, y in rows}

    @cached_property
    def steps(self) -> list[Finding]:
        """A step of each angle and of the clock, at the row where it explains most."""
        return [*self._steps()]

    def _steps(self) -> Iterator[Finding]:
        """Yield the steps; that of the clock is possible if it is a whole number of rows."""
        one, frame, motion = self.recording, self.recording.frame / self.period, self.motion
        rows = np.broadcast_to(np.arange(one.t.size), one.present.shape)[one.present]
        order = np.argsort(-rows, kind="stable")
        last = np.flatnonzero(np.diff(rows[order], append=-1))  # of the numbers of a row
        tries = {x: self.column(motion.only(**{x: 1.0})) for x in one.angles}
        for name, column in [*tries.items(), (_CLOCK, self.column(motion.rates) * frame)]:
            parts = np.stack([column * self.rest, column**2, *(column * self.basis.T)])
            work, size, *taken = np.cumsum(parts[:, order], axis=1)[:, last]
            left = size - np.sum(np.square(taken), axis=0)
            gains = np.where(left > 0.02 * size.max() / one.t.size, work**2, 0.0) / (left + 1e-300)
            row = int(rows[order][last[np.argmax(gains[3:-3]) + 3]])
            found = self._finding(Neighbour(name, "", []), (column * (rows >= row))[:, np.newaxis])
            x, std, at = found.size, found.std, f"at t = {one.t_start + float(one.t[row]):.6g}"
            if name != _CLOCK:
                shown = uncertain_text(math.degrees(x), math.degrees(std))
                yield found._replace(text=f"a jump of {name} by {shown} degrees {at}")
                continue
            is_whole = abs(x) > 0.5 and abs(x - round(x)) < max(3 * std, 0.1)
            what = f"{uncertain_text(abs(x), std)} {'doubled' if x < 0 else 'lost'} rows"
            yield found._replace(text=f"{what} {at}", is_possible=is_whole)


def neighbours_of(
    recording: Measured,
    residuals: Mapping[str, Residuals],
    motion: Callable[[Array], Array],
    inputs: Mapping[str, float],
    period: float,
    *,
    smoothing: float = 0.0,
) -> Neighbours | None:
    """Return the neighbours of a fitted motion with some inputs of `Top`.

    `smoothing` is the square of the width of a filter, over the period, if one made the noise
    smooth.  The result is None if there are none: of one angle, or of a motion that passes a pole.
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
    rest = one.residuals(*motion(one.t))
    return Neighbours(one, residuals, found, rest, period, smoothing=smoothing) if is_away else None
