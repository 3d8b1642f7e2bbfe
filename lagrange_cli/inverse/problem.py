"""The least squares of a fit: parameters, residuals, covariance, and the numbers of a top."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from operator import itemgetter
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from ..arithmetic.types import Array
from ..top.inputs import all_replaced, replaced_by
from .known import WEIGHT, Known, in_all_forms
from .measured import Measured
from .motions import STATE, angles, states_of
from .signals import NEAR_POLE, Signal, mean_rate

_DEPENDENT = 1e-7
"""Ratio of singular values of the slopes below which parameters are not determined."""
_SHARE = 0.05
"""Share of a parameter in a direction that is not determined, from which it is not either."""
_LEAST, _FASTEST = 2.0, 1e6
"""Standard deviations by which a > 0, and the largest b^2/a at which a is determined."""
_STEP, _SHORT_STEP, _LEAST_SIZE, _LEAST_PLACE = 1e-6, 1e-7, 1e-3, 0.03
"""Steps of central and of forward differences, over the size of a parameter, and its least size,
also beside a pole."""
_IN_PHASE = 0.7
"""Largest rms residual of the spin, in radians, of a motion that may be out of phase."""
STEPS = 60
"""Evaluations of the least squares."""
BESIDE_POLE = {"along": "theta0", "across": "psidot0", "speed": "thetadot0"}
"""Parameters of a start beside a pole, each in place of one that is singular on the pole: the place
of the axis along and across its velocity, in radians from the pole, and its speed."""
_POLE, _FAR = 1e-9, 1e3
"""Least distance from a pole, and weighted residual of a motion that does not exist."""
_GAIN = 1e-7
"""Relative gain at which the least squares end."""
_WALKED, _LEG, _LEAPS, _AHEAD, _SETTLED, _HOPELESS = 1000, 30, 8, 3.0, 0.02, 5.0
"""For a fit that moves slowly along a bent valley: the most rows, evaluations of one leg, how often
it leaps ahead and how many times as far, and the gain of chi^2/2, and its size per number, that end
this."""
_APART = 4.0
"""Standard deviations between different tops."""
_CURVED, _FAR_ALONG, _BENT, _BROKEN, _STIFF, _ASIDE = 2.0, 2.5, 2.0, 6.0, 100.0, 5.0
"""Standard deviations at which chi^2 is compared with a parabola, how many times as far a bent
valley is followed, the factors above the parabola that show such a valley and, on both sides, one
without a floor, the weight of the distance at which the floor is searched, and the standard
deviations by which a or b may be off a straight valley."""
_SHAPE_ROWS = 300
"""Rows that show the shape of chi^2."""


class Problem:
    """The parameters of a recording, and its residuals for many tops at once.

    Parameters are the state, r0 if the spin is recorded, and the zeros of psi and phi.  Known
    inputs replace a, b, r0 and the start as far as they determine them, unless the fit is `free`.
    Then they only serve to compute the body.  A known input that is uncertain is a parameter with
    a prior.  If whole turns of the spin per row are invisible, r0 exceeds the rate that is seen,
    which is below half a turn per row, by the `turns` per unit of time.  If the start is beside a
    `pole` (1 or -1), its parameters are those of BESIDE_POLE, and the zeros are those of an axis
    that leaves the pole in the direction of its velocity.
    """

    def __init__(
        self,
        recording: Measured,
        known: Known,
        sizes: Array,
        *,
        free: bool = False,
        turns: float = 0,
        pole: int = 0,
    ) -> None:
        self.recording, self.sizes, self.turns, self.free = recording, sizes, turns, free
        self.pole = pole
        """The `sizes` are the standard deviations of the channels."""
        seen = recording.angles.keys()
        alone = {"psidot0"} if seen == {"theta"} else {"theta0"} if seen == {"psi"} else set()
        shown = {*STATE} - alone | ({"r0"} if "phi" in seen else set())
        self.inputs = known
        used = {
            x: y
            for x, y in known.items()
            if not (free and replaced_by(x) in shown) and x != "steady"
        }
        self.known = {name: value for name, (value, _) in used.items()}
        self.stds = {name: std for name, (_, std) in used.items() if std}
        has = all_replaced(used)
        self.is_moment_known = "A" in has
        self.spins = "phi" in seen or "r0" in has
        self.is_even = seen == {"theta"} and self.known.get("psidot0") == 0 and not self.spins
        """Whether b and -b give the same tilt."""
        self.has_torque = WEIGHT <= has and self.is_moment_known and not free
        self.is_tied = (
            self.spins and "C" in has and (self.is_moment_known or WEIGHT <= has) and not free
        )
        fixed = {*has, *["a"] * self.has_torque, *["b"] * self.is_tied}
        names = [x for x in (*STATE, *["r0"] * ("phi" in seen)) if x not in fixed]
        names += [f"{x}_zero" for x in ("psi", "phi") if x in seen]
        if pole:
            smooth = {y: x for x, y in BESIDE_POLE.items()}
            names = [smooth.get(x, x) for x in names]
        self.count = len(names)
        """The number of parameters without a prior."""
        self.names = [*names, *self.stds]

    def of(self, recording: Measured, sizes: Array | None = None, pole: int = 0) -> Problem:
        """Return the same problem for another form of the recording, or of a start at a pole."""
        sizes = self.sizes if sizes is None else sizes
        known, free, turns, pole = self.inputs, self.free, self.turns, pole or self.pole
        return Problem(recording, known, sizes, free=free, turns=turns, pole=pole)

    @property
    def rows(self) -> int:
        """The number of rows."""
        return self.recording.t.size

    def thinned(self, count: int) -> Problem:
        """Return the same problem for at most `count` rows of the recording."""
        return self.of(self.recording.thinned(count)) if count < self.rows else self

    def values(self, x: Array) -> dict[str, Array]:
        """Return the quantities of the motion from parameters, shape (tops, parameters)."""
        found: dict[str, Any] = {"psi_zero": 0.0, "phi_zero": 0.0, **self.known}
        found |= dict(zip(self.names, x.T, strict=True))
        if self.pole:
            distance = np.maximum(np.hypot(found["along"], found["across"]), _POLE)
            turn = np.arctan2(found["across"], found["along"])  # of the velocity from the meridian
            found["theta0"] = distance if self.pole > 0 else math.pi - distance
            found["thetadot0"] = self.pole * found["speed"] * np.cos(turn)
            found["psidot0"] = found["speed"] * np.sin(turn) / np.sin(distance)
            found["psi_zero"] = found["psi_zero"] - turn
            found["phi_zero"] = found["phi_zero"] + self.pole * turn
        found = in_all_forms(found)
        found |= {name: found[name] for name in all_replaced(self.known)}
        weight = 2 * math.prod(found.get(x, math.nan) for x in ("m", "g", "s"))
        if self.has_torque:
            found["a"] = weight / found["A"]
        if self.is_tied:
            moment = found["A"] if "A" in found else weight / found["a"]
            found["b"] = found["C"] / moment * found["r0"]
        found.setdefault("r0", found["b"])
        return {name: np.broadcast_to(value, len(x)) for name, value in found.items()}

    def beside_pole(self, x: Array) -> tuple[Problem, Array]:
        """Return the problem, and parameters, in the form for a start beside a pole, if it is."""
        v = {name: y[0] for name, y in self.values(x[np.newaxis]).items()}
        pole = 1 if v["theta0"] < math.pi / 2 else -1
        distance = min(v["theta0"], math.pi - v["theta0"])
        away, round_it = pole * v["thetadot0"], v["psidot0"] * math.sin(distance)
        speed, turn = math.hypot(away, round_it), math.atan2(round_it, away)
        is_free = {*BESIDE_POLE.values()} <= {*self.names} - self.inputs.keys()
        if not is_free or not distance < min(NEAR_POLE, speed):
            return self, x
        v |= {"along": distance * math.cos(turn), "across": distance * math.sin(turn)}
        v |= {"speed": speed, "psi_zero": v["psi_zero"] + turn}
        v["phi_zero"] -= pole * turn
        problem = self.of(self.recording, pole=pole)
        return problem, np.array([v[name] for name in problem.names])

    def angles(self, x: Array, t: Array) -> Array:
        """Return theta, phi and psi with the zeros of the recording, shape (3, tops, times)."""
        value = self.values(x)
        states = np.stack([value[name] for name in STATE], axis=-1)
        states, tops = np.unique(states, axis=0, return_inverse=True)
        theta, phi, psi = angles(states_of(*states.T), t)[:, tops]
        rate = value["r0"] - self.turns - value["b"]
        phi = phi + np.outer(rate, t) + value["phi_zero"][:, np.newaxis]
        return np.stack([theta, phi, psi + value["psi_zero"][:, np.newaxis]])

    def residuals(self, x: Array) -> Array:
        """Return recording minus motion in radians, shape (tops, channels, times)."""
        recording = self.recording
        if (spread := recording.spread) is None:
            return recording.residuals(*self.angles(x, recording.t))
        both = self.angles(x, np.concatenate([recording.t - spread, recording.t + spread]))
        return recording.residuals(*np.stack(np.split(both, 2, axis=2)).mean(axis=0))

    def weighted(self, x: Array) -> Array:
        """Return residuals over standard deviations, a row for each top, and priors at the end."""
        sizes = self.sizes[:, np.newaxis] / math.sqrt(self.recording.rows_per_bin)
        found = (self.residuals(x) / sizes)[:, self.recording.present]
        rest = np.column_stack([found, *self.priors(x)])
        rows: Array = np.nan_to_num(rest, nan=_FAR, posinf=_FAR)
        return rows

    def priors(self, x: Array) -> list[Array]:
        """Return the distances of uncertain inputs from their known values, in sigmas."""
        value = self.values(x)
        return [(value[y] - self.known[y]) / std for y, std in self.stds.items()]

    def slopes(
        self, x: Array, function: Callable[[Array], Array], *, central: bool = True
    ) -> Array:
        """Return the derivatives of a function with respect to the parameters, in the last axis."""
        least = np.array(
            [_LEAST_PLACE if name in BESIDE_POLE else _LEAST_SIZE for name in self.names]
        )
        steps = (_STEP if central else _SHORT_STEP) * np.maximum(np.abs(x), least)
        steps = np.where(np.array(self.names) == "a", np.minimum(steps, np.abs(x) / 2), steps)
        below = x - np.diag(steps) if central else x[np.newaxis]
        found = function(np.concatenate([x + np.diag(steps), below]))
        return np.asarray((found[: x.size] - found[x.size :]).T / ((1 + central) * steps))

    def solve(
        self,
        x: Array,
        steps: int,
        function: Callable[[Array], Array] | None = None,
        *,
        central: bool = False,
    ) -> tuple[Array, float]:
        """Return the least squares from one start by the method of Levenberg and Marquardt.

        They are the parameters and half the sum of squares after at most `steps` evaluations.  The
        `function` returns the weighted residuals of many tops; `central` are the differences that
        give its slopes.
        """
        weighted = function or self.weighted
        low = np.array([{"a": 1e-30, "theta0": _POLE}.get(name, -np.inf) for name in self.names])
        high = np.array([math.pi - _POLE if name == "theta0" else np.inf for name in self.names])
        found = least_squares(
            lambda at: weighted(np.clip(at, low, high)[np.newaxis])[0],
            np.clip(x, low, high),
            lambda at: self.slopes(np.clip(at, low, high), weighted, central=central),
            method="lm",
            x_scale="jac",
            max_nfev=steps,
            ftol=_GAIN,
            xtol=_GAIN**1.5,
            gtol=_GAIN**1.5,
        )
        return np.clip(found.x, low, high), float(found.cost)

    def walked(self, x: Array) -> Array:
        """Return parameters near the least squares, also at the far end of a bent valley.

        The method of Levenberg and Marquardt moves slowly along it, so that points ahead are tried.
        """
        x, cost = self.solve(x, _LEG)
        for _ in range(_LEAPS):
            last, (x, least) = x, self.solve(x, _LEG)
            if cost - least < _SETTLED or least > _HOPELESS * self.recording.present.sum():
                break
            x, cost = min((x, least), self.solve(x + _AHEAD * (x - last), _LEG), key=itemgetter(1))
        return x

    def rephased(self, x: Array) -> Array:
        """Return parameters whose r0 is right to a turn over the recording, if it is free."""
        names, recording = self.names, self.recording
        if not {"r0", "phi_zero"} <= {*names}:
            return x
        channel = recording.channels.index(recording.spin_channel)
        rest = self.residuals(x[np.newaxis])[0, channel]
        t, rest = recording.t[np.isfinite(rest)], rest[np.isfinite(rest)]
        if float(np.mean(rest**2)) < _IN_PHASE**2:
            return x
        rate, x = mean_rate(t, rest, recording.frame), x.copy()
        x[names.index("r0")] += rate
        x[names.index("phi_zero")] += float(np.angle(np.sum(np.exp(1j * (rest - rate * t)))))
        return x

    def started(self, states: Array, spin: Signal | None) -> tuple[Array, Array]:
        """Return the parameters of states, with the best zeros and spin rate of each.

        The second array is the logarithm of the noise that they leave, summed over the channels.
        """
        known, seen, t = self.known, self.recording.angles, self.recording.t
        value: dict[str, Any] = {**known, **dict(zip(STATE, states.T, strict=True))}
        theta, phi, psi = angles(states_of(*states.T), t)
        if spin is not None:
            if (whole := in_all_forms(value)).has("r0"):
                r0 = np.broadcast_to(whole["r0"], len(states))
            else:
                r0 = self._spin_rates(value["b"], phi, spin)
            value["r0"] = r0
            phi = phi + np.outer(r0 - self.turns - value["b"], t)
            value["phi_zero"] = _mean_angle(seen["phi"] - phi)
            phi = phi + value["phi_zero"][:, np.newaxis]
        if "psi" in seen:
            value["psi_zero"] = _mean_angle(seen["psi"] - psi, np.sin(theta))
            psi = psi + value["psi_zero"][:, np.newaxis]
        rest = mean_squares(self.recording.residuals(theta, phi, psi))
        noise = np.log(rest + self.sizes**2 / self.recording.rows_per_bin).sum(axis=1)
        rows = [np.broadcast_to(value[name], len(states)) for name in self.names]
        return np.stack(rows, axis=-1), np.nan_to_num(noise, nan=np.inf)

    def _spin_rates(self, b: Array, phi: Array, spin: Signal) -> Array:
        """Return the spin rates that explain phi best; next to a pole it may jump by turns."""
        t, seen = self.recording.t, self.recording.angles["phi"]
        around = t - t.mean()
        shown = np.interp(t, spin.t, spin.y) + spin.rate * t
        r0 = b + (shown - phi) @ around / (around @ around)
        rates = r0 + 2 * math.pi * np.array([[0.0], [1.0], [-1.0]])  # in units of the period
        fits = []
        for rate in rates:
            wave = np.exp(1j * (seen - phi - np.outer(rate - b, t)))
            fits.append(np.abs(np.nansum(wave, axis=1)) * (1.05 if rate is rates[0] else 1.0))
        return np.asarray(rates[np.argmax(fits, axis=0), np.arange(b.size)])


def mean_squares(rest: Array) -> Array:
    """Return the mean squares of residuals over times, 0 for a channel without any."""
    count = np.maximum(np.isfinite(rest).sum(axis=-1), 1)
    return np.asarray(np.nansum(rest**2, axis=-1) / count)


def _mean_angle(turned: Array, weights: Array | float = 1.0) -> Array:
    found: Array = np.angle(np.nansum(weights * np.exp(1j * turned), axis=1))
    return found


@dataclass
class Minimum:
    """One minimum of the least squares."""

    problem: Problem
    x: Array
    spread: Array
    """A matrix S with the covariance S S^T of the parameters."""
    chi2: float
    unknown: list[str]
    """Parameters that the recording does not determine."""
    is_curved: bool = False
    """Whether chi^2 is not parabolic within two standard deviations."""
    is_hopeless: bool = False
    """Whether no motion of a top is near the recording."""

    @classmethod
    def of(
        cls,
        problem: Problem,
        start: Array,
        floors: Array,
        factors: Array | float = 1.0,
        *,
        is_final: bool = False,
    ) -> Minimum:
        """Converge; standard deviations that were not given come from the residuals.

        They are at least the `floors`.  `factors` widen them for noise that is correlated.  The
        curvature of chi^2 is checked only of a minimum that `is_final`.
        """
        recording = problem.recording
        problem = problem.of(recording, problem.sizes * (factors if recording.sigma else 1.0))
        problem, start = problem.beside_pole(start)
        if is_final:
            start = problem.thinned(_WALKED).walked(start)
        most = STEPS if is_final or recording.sigma else STEPS // 3
        x, cost = problem.solve(start, most, central=is_final)
        present = recording.present
        share = present.sum() * recording.rows_per_bin
        share = share / max(present.sum() - problem.count, 1)
        for _ in range(0 if recording.sigma else 8):
            rest = np.where(present, problem.residuals(x[np.newaxis])[0], np.nan)
            size = np.maximum(np.sqrt(mean_squares(rest) * share), floors)
            done = np.allclose(size * factors, problem.sizes, rtol=1e-3)
            problem.sizes = size * factors
            if done:
                break
            x, cost = problem.solve(x, STEPS // 4 if is_final else STEPS // 6, central=is_final)
        slopes = problem.slopes(x, problem.weighted)
        size = np.linalg.norm(slopes, axis=0) + 1e-300
        _, values, rows = np.linalg.svd(slopes / size, full_matrices=False)
        sure = values > _DEPENDENT * values[0]
        loose = np.abs(rows[~sure]).max(axis=0, initial=0.0) > _SHARE
        spread = rows[sure].T / values[sure] / size[:, np.newaxis]
        stretch, is_curved = _curvature(problem, x, spread) if is_final else (1.0, False)
        spread = spread * stretch
        if "a" in problem.names:  # a <= 0 is no top
            i, b = problem.names.index("a"), problem.values(x[np.newaxis])["b"][0]
            least = max(_LEAST * np.linalg.norm(spread[i]), b * b / _FASTEST)
            loose[i] |= x[i] <= least
        names = [BESIDE_POLE.get(name, name) for name in problem.names]
        unknown = [name for name, x in zip(names, loose, strict=True) if x]
        return cls(problem, x, spread, 2 * cost, unknown, is_curved)

    @property
    def badness(self) -> float:
        """Minus twice the logarithm of the likelihood."""
        rows = self.problem.recording.present.sum(axis=1)
        return self.chi2 + 2 * float(rows @ np.log(self.problem.sizes))

    @property
    def values(self) -> dict[str, float]:
        """The quantities of the motion, and known inputs."""
        found = self.problem.values(self.x[np.newaxis])
        return {name: float(x[0]) for name, x in found.items()}

    def std(self, name: str) -> float:
        """Return the standard deviation of a parameter, 0 if it is none."""
        names = self.problem.names
        return float(np.linalg.norm(self.spread[names.index(name)])) if name in names else 0.0

    def turned(self, turns: float) -> Minimum:
        """Return the minimum with a spin that is faster by whole turns per row."""
        problem, x = self.problem.of(self.problem.recording), self.x.copy()
        problem.turns += turns
        x[problem.names.index("r0")] += turns
        return replace(self, problem=problem, x=x)

    def numbers(
        self, function: Callable[[Array], Mapping[str, Array]]
    ) -> dict[str, tuple[float, float, float]]:
        """Return finite functions of the parameters, with standard deviations.

        The second one is the standard deviation if known inputs are exact.
        """

        def columns(x: Array) -> Array:
            return np.stack([*function(x).values()], axis=-1)

        if not (values := function(self.x[np.newaxis])):
            return {}
        slopes = self.problem.slopes(self.x, columns) @ self.spread
        priors, _ = np.linalg.qr(self.spread[self.problem.count :].T)
        own = np.linalg.norm(slopes - slopes @ priors @ priors.T, axis=1)
        stds = np.linalg.norm(slopes, axis=1)
        found = zip(values.items(), stds, own, strict=True)
        numbers = {key: (float(x), float(y), float(z)) for (key, (x,)), y, z in found}
        return {key: x for key, x in numbers.items() if np.isfinite(x).all()}

    def differs(self, other: Minimum) -> bool:
        """Return whether this is another top: in a or b, whose sign changes in a mirror image."""
        problem, x, y = self.problem, self.x, other.x
        rows = [i for i, name in enumerate(problem.names) if name in {"a", "b"}]
        if problem.recording.is_mirrored is not other.problem.recording.is_mirrored:
            x, y = np.abs(x), np.abs(y)
        near = _APART * np.linalg.norm(self.spread, axis=1) + 1e-6 * np.abs(x)
        return bool(np.any((np.abs(x - y) > near)[rows]))


def _curvature(problem: Problem, x: Array, spread: Array) -> tuple[Array, bool]:
    """Return factors by which the axes of a covariance are too short, at least 1.

    Two standard deviations away on either side, chi^2 should have grown by 4.  If it grows by much
    more, the valley of chi^2 is bent, and its floor is followed, also to five standard deviations,
    as it may become flatter.  If there is none on either side, or if a or b is far aside on it, the
    covariance is wrong, as the second number says.  Chi^2 is that of the change of the motion.
    """
    few = problem.thinned(_SHAPE_ROWS)
    few = few.of(few.recording, few.sizes * math.sqrt(few.rows / problem.rows))
    rows, at_x = np.linalg.pinv(spread), few.weighted(x[np.newaxis])
    stds, is_far = np.linalg.norm(spread, axis=1) + 1e-300, False
    shown = [i for i, name in enumerate(problem.names) if name in {"a", "b"}]

    def change(at: Array) -> Array:
        return few.weighted(at) - at_x

    ends = x + _CURVED * np.concatenate([spread.T, -spread.T])
    grown = np.sum(change(ends) ** 2, axis=1).reshape(2, -1)
    for side, axis in zip(*np.nonzero(grown > _BENT * _CURVED**2), strict=True):
        end = x
        for times in (1.0, _FAR_ALONG):
            wanted, row = times * _CURVED * (1 - 2 * side), rows[axis]

            def held(at: Array, row: Array = row, wanted: float = wanted) -> Array:
                return np.column_stack([change(at), _STIFF * ((at - x) @ row - wanted)])

            end, _ = few.solve(end + wanted / times * spread[:, axis], STEPS // 3, held)
            size = float(np.sum(change(end[np.newaxis]) ** 2)) / times**2
            off = np.abs(end - x - wanted * spread[:, axis]) / stds
            is_far |= bool(np.any(off[shown] > times * _ASIDE))
            grown[side, axis] = size if times == 1 else min(size, grown[side, axis])
    least = np.maximum(grown.min(axis=0, initial=math.inf), 0.04)
    factors = np.sqrt(np.clip(_CURVED**2 / least, 1.0, 100.0))
    return np.asarray(factors), is_far or bool(np.any(grown.min(axis=0) > _BROKEN * _CURVED**2))
