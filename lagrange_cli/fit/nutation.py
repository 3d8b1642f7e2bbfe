"""The fit of a nutating top: its parameters and residuals, a minimum, and every number of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from ..motion.quantity import unit_name
from ..motion.record import shown_keys
from ..sweep.records import sweep
from .motions import STATE, angles
from .outcome import Outcome
from .recording import Known, Recording
from .starts import Signal

PERCENT = "_percent"
"""Ending of the keys of relative errors of elementary formulas."""
_MEANINGS = {
    "a": "2mgs/A (4,4)",
    "b": "C r0/A (4,5)",
    "r0": "total spin rate",
    "theta0": "tilt in the first row",
    "thetadot0": "nutation rate in the first row",
    "psidot0": "precession rate in the first row",
    "psi_zero": "psi of the data in the first row",
    "phi_zero": "phi of the data in the first row",
}
_ANGLES = ("theta0", "psi_zero", "phi_zero")
_ELEMENTARY = {
    "T_nutation_elementary": "T_nutation",
    "precession_rate_elementary": "mean_precession_rate",
}
_DERIVED = (
    *("T_nutation", "T_precession", "mean_precession_rate", "mean_spin_rate"),
    *("theta_min_deg", "theta_max_deg", "stability_factor", *_ELEMENTARY),
)
_DEPENDENT = 1e-7
"""Ratio of singular values of the slopes below which parameters are not determined."""
_IMPROVED = 0.999
"""Standard deviation of a known input after the fit, over the given one, from which it is new."""
_SHARE = 0.05
"""Share of a parameter in a direction that is not determined, from which it is not either."""
_APART, _LEAST, _FASTEST = 4.0, 2.0, 1e6
"""Standard deviations between different tops, those by which a > 0, and the largest b^2/a at which
a is determined."""
_STEP, _SHORT_STEP, _LEAST_SIZE = 1e-6, 1e-7, 1e-3
"""Steps of central and of forward differences, over the size of a parameter, and its least size."""
_POLE, _FAR = 1e-9, 1e3
"""Least distance from a pole, and weighted residual of a motion that does not exist."""


class Problem:
    """The parameters of a recording, and its residuals for many tops at once.

    Parameters are the state, r0 if the spin is recorded, and the zeros of psi and phi.  Known
    inputs replace a, b, r0 and the start as far as they determine them.  A known input that is
    uncertain is a parameter with a prior.
    """

    def __init__(self, recording: Recording, known: Known, sigma: Mapping[str, float]) -> None:
        self.recording, self.known, self.sigma = recording, known, dict(sigma)
        seen, has, weight = recording.angles.keys(), known.keys(), {"m", "g", "s"}
        self.spins = "phi" in seen or "r0" in has
        self.is_even = seen == {"theta"} and known.get("psidot0") == 0 and not self.spins
        """Whether the opposite b leaves the same tilt."""
        self.has_torque = weight | {"A"} <= has
        self.is_tied = self.spins and "C" in has and ("A" in has or weight <= has)
        fixed = {*has, *["a"] * self.has_torque, *["b"] * self.is_tied}
        self.names = [x for x in (*STATE, *["r0"] * ("phi" in seen)) if x not in fixed]
        self.names += [f"{x}_zero" for x in ("psi", "phi") if x in seen]
        self.count = len(self.names)
        """The number of parameters without a prior."""
        self.names += known.stds

    def thinned(self, count: int) -> Problem:
        """Return the same problem for at most `count` rows of the recording."""
        rows = np.unique(np.linspace(0, self.recording.t.size - 1, count).astype(int))
        return Problem(self.recording.part(rows), self.known, self.sigma)

    def values(self, x: Array) -> dict[str, Array]:
        """Return the quantities of the motion from parameters, shape (tops, parameters)."""
        found: dict[str, Any] = {"psi_zero": 0.0, "phi_zero": 0.0, **self.known}
        found |= dict(zip(self.names, x.T, strict=True))
        weight = 2 * math.prod(found.get(x, math.nan) for x in ("m", "g", "s"))
        if self.has_torque:
            found["a"] = weight / found["A"]
        if self.is_tied:
            moment = found["A"] if "A" in found else weight / found["a"]
            found["b"] = found["C"] / moment * found["r0"]
        found.setdefault("r0", found["b"])
        return {name: np.broadcast_to(value, len(x)) for name, value in found.items()}

    def ratio(self, x: Array) -> Array:
        """Return C/A = b/r0."""
        value = self.values(x)
        return value["b"] / value["r0"]

    def angles(self, x: Array, t: Array) -> Array:
        """Return theta, phi and psi with the zeros of the recording, shape (3, tops, times)."""
        value = self.values(x)
        states = np.stack([value[name] for name in STATE], axis=-1)
        states, tops = np.unique(states, axis=0, return_inverse=True)
        theta, phi, psi = angles(states, t)[:, tops]
        phi = phi + np.outer(value["r0"] - value["b"], t) + value["phi_zero"][:, np.newaxis]
        return np.stack([theta, phi, psi + value["psi_zero"][:, np.newaxis]])

    def residuals(self, x: Array) -> Array:
        """Return recording minus motion in radians, shape (tops, channels, times)."""
        return self.recording.residuals(*self.angles(x, self.recording.t))

    def weighted(self, x: Array) -> Array:
        """Return residuals over standard deviations, a row for each top, and priors at the end."""
        sizes = np.array([self.sigma[channel] for channel in self.recording.channels])
        found = (self.residuals(x) / sizes[:, np.newaxis])[:, self.recording.present]
        value = self.values(x)
        priors = [(value[y] - self.known[y]) / std for y, std in self.known.stds.items()]
        rows: Array = np.nan_to_num(np.column_stack([found, *priors]), nan=_FAR, posinf=_FAR)
        return rows

    def slopes(
        self, x: Array, function: Callable[[Array], Array], *, central: bool = True
    ) -> Array:
        """Return the derivatives of a function of many tops by the parameters, in the last axis."""
        steps = (_STEP if central else _SHORT_STEP) * np.maximum(np.abs(x), _LEAST_SIZE)
        steps = np.where(np.array(self.names) == "a", np.minimum(steps, np.abs(x) / 2), steps)
        below = x - np.diag(steps) if central else x[np.newaxis]
        found = function(np.concatenate([x + np.diag(steps), below]))
        return np.asarray((found[: x.size] - found[x.size :]).T / ((1 + central) * steps))

    def solve(self, x: Array, steps: int) -> OptimizeResult:
        """Return the least squares from one start."""
        low = [{"a": 1e-30, "theta0": _POLE}.get(name, -np.inf) for name in self.names]
        high = [math.pi - _POLE if name == "theta0" else np.inf for name in self.names]
        return least_squares(
            lambda at: self.weighted(at[np.newaxis])[0],
            np.clip(x, low, high),
            lambda at: self.slopes(at, self.weighted, central=False),
            bounds=(low, high),
            x_scale="jac",
            xtol=1e-12,
            ftol=1e-11,
            gtol=1e-12,
            max_nfev=steps,
        )

    def parameters_of(self, states: Array, spin: Signal | None) -> Array:
        """Return the parameters of states, with the best zeros and spin rate of each."""
        known, seen, t = self.known, self.recording.angles, self.recording.t
        value: dict[str, Any] = {**known, **dict(zip(STATE, states.T, strict=True))}
        theta, phi, psi = angles(states, t)
        if spin is not None:
            around = t - t.mean()
            shown = np.interp(t, spin.t, spin.y) + spin.rate * t
            r0 = value["b"] + (shown - phi) @ around / (around @ around)
            r0 = np.asarray(known.get("r0", slowest(r0, value["b"], self.recording.frame)))
            value["r0"] = np.broadcast_to(r0, len(states))
            turned = seen["phi"] - phi - np.outer(value["r0"] - value["b"], t)
            value["phi_zero"] = _mean_angle(turned)
        if "psi" in seen:
            value["psi_zero"] = _mean_angle(seen["psi"] - psi, np.sin(theta))
        rows = [np.broadcast_to(value[name], len(states)) for name in self.names]
        return np.stack(rows, axis=-1)


def slowest(r0: Array, b: Array, frame: float) -> Array:
    """Return the slowest of the spin rates that look alike in frames and have 0 < b/r0 <= 2.

    If there is none, the given rates are returned.
    """
    alike = r0 + 2 * math.pi / frame * np.arange(-3, 4)[:, np.newaxis]
    size = np.where((b / alike > 0) & (b / alike <= 2.05), np.abs(alike), np.inf)
    best = alike[np.argmin(size, axis=0), np.arange(np.size(r0))]
    return np.where(np.isfinite(size.min(axis=0)), best, r0)


def _mean_angle(turned: Array, weights: Array | float = 1.0) -> Array:
    found: Array = np.angle(np.nansum(weights * np.exp(1j * turned), axis=1))
    return found


class Minimum(NamedTuple):
    """One minimum of the least squares."""

    problem: Problem
    x: Array
    spread: Array
    """A matrix S with the covariance S S^T of the parameters."""
    chi2: float
    unknown: list[str]
    """Parameters that the recording does not determine."""

    @classmethod
    def of(cls, problem: Problem, start: Array) -> Minimum:
        """Converge; standard deviations that were not given come from the residuals."""
        recording = problem.recording
        problem = Problem(recording, problem.known, problem.sigma)
        found = problem.solve(start, 80)
        present = recording.present
        share = present.sum() / max(present.sum() - problem.count, 1)
        for _ in range(0 if recording.sigma else 4):
            rest = np.where(present, problem.residuals(found.x[np.newaxis])[0], np.nan)
            sizes = np.sqrt(np.nanmean(rest**2, axis=1) * share) + 1e-12  # never 0
            problem.sigma = dict(zip(recording.channels, sizes.tolist(), strict=True))
            found = problem.solve(found.x, 20)
        slopes = problem.slopes(found.x, problem.weighted)
        size = np.linalg.norm(slopes, axis=0) + 1e-300
        _, values, rows = np.linalg.svd(slopes / size, full_matrices=False)
        sure = values > _DEPENDENT * values[0]
        loose = np.abs(rows[~sure]).max(axis=0, initial=0.0) > _SHARE
        spread = rows[sure].T / values[sure] / size[:, np.newaxis]
        if "a" in problem.names:  # a <= 0 is no top
            i, b = problem.names.index("a"), problem.values(found.x[np.newaxis])["b"][0]
            least = max(_LEAST * np.linalg.norm(spread[i]), b * b / _FASTEST)
            loose[i] |= found.x[i] <= least
        unknown = [name for name, x in zip(problem.names, loose, strict=True) if x]
        return cls(problem, found.x, spread, 2 * float(found.cost), unknown)

    @property
    def badness(self) -> float:
        """Minus twice the logarithm of the likelihood."""
        rows = self.problem.recording.present.sum(axis=1)
        sizes = np.log([self.problem.sigma[x] for x in self.problem.recording.channels])
        return self.chi2 + 2 * float(rows @ sizes)

    @property
    def values(self) -> dict[str, float]:
        """The quantities of the motion, and known inputs."""
        found = self.problem.values(self.x[np.newaxis])
        return {name: float(x[0]) for name, x in found.items()}

    def numbers(
        self, function: Callable[[Array], Mapping[str, Array]]
    ) -> dict[str, tuple[float, float]]:
        """Return finite functions of the parameters, with standard deviations."""

        def columns(x: Array) -> Array:
            return np.stack([*function(x).values()], axis=-1)

        stds = np.linalg.norm(self.problem.slopes(self.x, columns) @ self.spread, axis=1)
        found = zip(function(self.x[np.newaxis]).items(), stds, strict=True)
        numbers = {key: (float(value), float(std)) for (key, (value,)), std in found}
        return {key: x for key, x in numbers.items() if np.isfinite(x).all()}

    def differs(self, other: Minimum) -> bool:
        """Return whether this is another top: in a, b or r0."""
        rows = [i for i, name in enumerate(self.problem.names) if name in {"a", "b", "r0"}]
        near = _APART * np.linalg.norm(self.spread, axis=1) + 1e-6 * np.abs(self.x)
        return bool(np.any((np.abs(self.x - other.x) > near)[rows]))


def nutating_outcome(
    found: Minimum, rival: Minimum | None, frequency: float, *, radians: bool
) -> Outcome:
    """Return the result of a fit; the `rival` is another top that fits as well."""
    problem, recording = found.problem, found.problem.recording
    values, names = found.values, problem.names
    sizes = zip(names, np.linalg.norm(found.spread, axis=1), strict=True)
    stds = problem.known.stds
    free = {name for name, std in sizes if std < _IMPROVED * stds.get(name, math.inf)}
    numbers = found.numbers(lambda x: _computed(problem, x, free, radians=radians))
    notes, faults = [*recording.notes], []
    if problem.is_even:
        notes.append("the sign of b is not determined: theta alone does not show the direction")
    if rival:
        shown = ", ".join(f"{x} = {rival.values[x]:.6g}" for x in ("a", "b", "r0") if x in names)
        faults.append(f"another top explains the recording as well: {shown}")
    if found.unknown:
        faults.append(f"the recording does not determine {' and '.join(found.unknown)}")
    if problem.spins:
        ratio, std = found.numbers(lambda x: {"C/A": problem.ratio(x)}).get("C/A", (0.0, 0.0))
        if not -_APART * std < ratio < 2 + _APART * std:
            faults.append(f"C/A = {ratio:.3g} is impossible: a rigid body has 0 < C/A <= 2")
        if "phi" in recording.angles and abs(values["r0"]) * recording.frame > math.pi:
            notes.append("the spin exceeds half a turn per frame: r0 is the slowest possible rate")
    if products := [x for x in numbers if set(x) & set("*/")]:
        notes.append(f"only {' and '.join(products)} can be determined: give known inputs")
    body = [(i, x) for i, x in enumerate(names) if x in {"a", "b", "r0"} and x in numbers]
    return Outcome(
        recording,
        problem.known,
        radians,
        numbers,
        {key: _meaning(key, problem, numbers, radians=radians) for key in numbers},
        lambda t: problem.angles(found.x[np.newaxis], t)[:, 0],
        problem.count,
        frequency,
        faults,
        notes,
        _inputs(found, numbers),
        {(x, y): float(found.spread[i] @ found.spread[j]) for i, x in body for j, y in body},
    )


def _computed(
    problem: Problem, x: Array, free: Collection[str], *, radians: bool
) -> dict[str, Array]:
    """Return the numbers of the motion and of the body for many parameters.

    Of the parameters, only those in `free` are returned: not the known inputs that the recording
    does not improve.
    """
    v, (scale, unit) = problem.values(x), angle_unit(radians=radians)
    free = {*free, *["b"] * problem.is_tied}
    found = {}
    for name in (*_MEANINGS, *problem.known.stds):
        if name in _ANGLES and name in free:
            found[f"{name}_{unit}"] = v[name] * scale
        elif name in free:
            found[name] = v[name]
    has = {name: v[name] for name in (*problem.known, *["r0"] * problem.spins)}
    found |= body_numbers(v["a"] / 2, v["b"], has)
    keys = [unit_name(key, radians=radians) for key in _DERIVED]
    start = {"theta0_rad": v["theta0"], "thetadot0": v["thetadot0"], "psidot0": v["psidot0"]}
    swept = sweep(keys=keys, radians=radians, m=1, A=1, C=1, s=1, g=v["a"] / 2, r0=v["b"], **start)
    derived = {key: np.asarray(swept[key], float) for key in keys}
    derived["mean_spin_rate"] = derived["mean_spin_rate"] + v["r0"] - v["b"]
    if not problem.spins:
        del derived["mean_spin_rate"]
    for key, exact in _ELEMENTARY.items():
        derived[f"{key}{PERCENT}"] = 100 * (derived[key] / derived[exact] - 1)
    return found | derived


def body_numbers(torque: Array, b: Array, has: Mapping[str, Array]) -> dict[str, Array]:
    """Return the unknown inputs of the body, or products of them, from mgs/A, b and known inputs.

    The names of products are such as `m*s/A`.
    """
    has, found = dict(has), dict[str, Array]()
    if "A" not in has:
        if {"m", "g", "s"} <= has.keys():
            found["A"] = has["m"] * has["g"] * has["s"] / torque
        elif {"C", "r0"} <= has.keys():
            found["A"] = has["C"] * has["r0"] / b
        has |= found
    over, moment = ("", has["A"]) if "A" in has else ("/A", 1.0)
    for names, value in ((("C", "r0"), b), (("m", "g", "s"), torque)):
        if unknown := [x for x in names if x not in has]:
            rest = math.prod(has[x] for x in names if x in has)
            found["*".join(unknown) + over] = value * moment / rest
    return dict(sorted(found.items()))


def _meaning(
    key: str, problem: Problem, numbers: Mapping[str, tuple[float, float]], *, radians: bool
) -> str:
    name = key.removesuffix(f"_{angle_unit(radians=radians)[1]}")
    if name in problem.known.stds:
        return "known, improved by the fit"
    if off := numbers.get(f"{key}{PERCENT}"):
        word, sigmas = ("small", "large")[off[0] > 0], off[0] / (off[1] or math.inf)
        sure = f"{sigmas:+.{int(abs(sigmas) < 10)}f} sigma"
        return f"of a fast top: {abs(off[0]):.2g} % too {word}, {sure}"
    declared = shown_keys(radians=radians, requested=True)
    if name not in _MEANINGS and key in declared:
        return declared[key].meaning
    return _MEANINGS.get(name, "only this product is known" if set(key) & set("*/") else "")


def _inputs(found: Minimum, numbers: Mapping[str, tuple[float, float]]) -> dict[str, float]:
    """Return inputs of `Top` with this motion.

    Undetermined ones are A = C = g = 1, and m s^2 = A/10.
    """
    values, body = found.values, ("m", "s", "g", "A", "C", "r0")
    has = {x: values[x] for x in body if x in found.problem.known}
    has |= {x: numbers[x][0] for x in body if x in numbers}
    has.setdefault("A", has.get("C", 1.0))  # if C and r0 are known, A is a number of the fit
    if "C" not in has:
        has["C"] = values["b"] * has["A"] / has["r0"] if has.get("r0") else has["A"]
    has["r0"] = values["b"] * has["A"] / has["C"]
    weight = values["a"] / 2 * has["A"]  # mgs
    unknown = [x for x in ("g", "s", "m") if x not in has]
    for name in unknown[:-1]:
        has[name] = 1.0 if name == "g" else has["A"] * has["g"] / (10 * weight)
    for name in unknown[-1:]:
        has[name] = weight / math.prod(has[x] for x in ("m", "g", "s") if x != name)
    start = {"theta0_deg": math.degrees(values["theta0"])}
    start |= {x: values[x] for x in ("thetadot0", "psidot0")}
    return {**{x: has[x] for x in body}, **start}
