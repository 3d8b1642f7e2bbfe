"""The fit of a nutating top: its parameters and residuals, a minimum, and every number of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from ..inputs.rotations import within_half_turn
from ..motion.quantity import unit_name
from ..motion.record import shown_keys
from ..sweep.records import sweep
from .motions import STATE, angles
from .outcome import Outcome, Residuals, chi2_bounds
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
_SHARE = 0.05
"""Share of a parameter in a direction that is not determined, from which it is not either."""
_APART, _LEAST, _FASTEST = 4.0, 2.0, 1e6
"""Standard deviations between different tops, those by which a > 0, and the largest b^2/a at which
a is determined."""
_STEP, _SHORT_STEP, _LEAST_STEP = 1e-6, 1e-7, 1e-3
"""Steps of central and of forward differences, over the size of a parameter, and its least size."""
_POLE, _FAR = 1e-9, 1e3
"""Least distance from a pole, and weighted residual of a motion that does not exist."""


class Problem:
    """The parameters of a recording, and its residuals for many tops at once.

    Parameters are the state, r0 if the spin is recorded, and the zeros of psi and phi.  Known
    inputs replace a, b, r0 and the start as far as they determine them.  A known input that is
    uncertain, and does so, is a parameter with a prior.
    """

    def __init__(self, recording: Recording, known: Known, sigma: Mapping[str, float]) -> None:
        self.recording, self.known, self.sigma = recording, known, dict(sigma)
        seen, has, weight = recording.angles.keys(), known.keys(), {"m", "g", "s"}
        self.spins = "phi" in seen or "r0" in has
        self.is_even = seen == {"theta"} and known.get("psidot0") == 0 and not self.spins
        """Whether the opposite b leaves the same tilt."""
        self.has_torque = weight | {"A"} <= has
        self.is_tied = self.spins and "C" in has and ("A" in has or weight <= has)
        used = {*STATE, *["r0"] * self.spins}
        if self.has_torque:
            used |= weight | {"A"}
        if self.is_tied:
            used |= {"C"} | ({"A"} if "A" in has else weight)
        self.priors = [x for x in known.stds if x in used]
        fixed = {*has, *["a"] * self.has_torque, *["b"] * self.is_tied}
        self.names = [x for x in (*STATE, *["r0"] * ("phi" in seen)) if x not in fixed]
        self.names += [f"{x}_zero" for x in ("psi", "phi") if x in seen]
        self.names += self.priors

    def thinned(self, count: int) -> Problem:
        """Return the same problem for at most `count` rows of the recording."""
        one = self.recording
        rows = np.unique(np.linspace(0, one.t.size - 1, count).astype(int))
        angles = {key: x[rows] for key, x in one.angles.items()}
        return Problem(replace(one, t=one.t[rows], angles=angles), self.known, self.sigma)

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
        theta, phi, psi = self.angles(x, self.recording.t)
        seen = self.recording.angles
        if self.recording.kind == "angles":
            motion = {"theta": theta, "phi": phi, "psi": psi}
            found = [within_half_turn(seen[key] - motion[key]) for key in self.recording.channels]
            return np.asarray(np.stack(found, axis=1))
        turned, sine = within_half_turn(seen["psi"] - psi), np.sin(seen["theta"])
        along_meridian = sine * np.cos(theta) * np.cos(turned)
        found = [along_meridian - np.cos(seen["theta"]) * np.sin(theta), sine * np.sin(turned)]
        if self.recording.kind == "attitude":
            found.append(within_half_turn(seen["phi"] - phi + turned * np.cos(theta)))
        return np.stack(found, axis=1)

    def weighted(self, x: Array) -> Array:
        """Return residuals over standard deviations, a row for each top, and priors at the end."""
        sizes = np.array([self.sigma[channel] for channel in self.recording.channels])
        found = (self.residuals(x) / sizes[:, np.newaxis])[:, self.recording.present]
        value = self.values(x)
        priors = [(value[y] - self.known[y]) / self.known.stds[y] for y in self.priors]
        rows: Array = np.nan_to_num(np.column_stack([found, *priors]), nan=_FAR, posinf=_FAR)
        return rows

    def slopes(self, x: Array, *, central: bool = False) -> Array:
        """Return the derivatives of the weighted residuals, by forward or central differences."""
        steps = (_STEP if central else _SHORT_STEP) * np.maximum(np.abs(x), _LEAST_STEP)
        if central:
            steps = np.where(np.array(self.names) == "a", np.minimum(steps, np.abs(x) / 2), steps)
        below = x - np.diag(steps) if central else x[np.newaxis]
        found = self.weighted(np.concatenate([x + np.diag(steps), below]))
        return np.asarray((found[: x.size] - found[x.size :]).T / ((1 + central) * steps))

    def solve(self, x: Array, steps: int) -> OptimizeResult:
        """Return the least squares from one start."""
        low = [{"a": 1e-30, "theta0": _POLE}.get(name, -np.inf) for name in self.names]
        high = [math.pi - _POLE if name == "theta0" else np.inf for name in self.names]
        return least_squares(
            lambda at: self.weighted(at[np.newaxis])[0],
            np.clip(x, low, high),
            self.slopes,
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
    dof: int
    unknown: list[str]
    """Parameters that the recording does not determine."""

    @classmethod
    def of(cls, problem: Problem, start: Array) -> Minimum:
        """Converge; standard deviations that were not given come from the residuals."""
        recording = problem.recording
        problem = Problem(recording, problem.known, problem.sigma)
        found = problem.solve(start, 80)
        present = recording.present
        share = present.sum() / max(present.sum() - found.x.size, 1)
        for _ in range(0 if recording.sigma else 4):
            rest = np.where(present, problem.residuals(found.x[np.newaxis])[0], np.nan)
            sizes = np.sqrt(np.nanmean(rest**2, axis=1) * share) + 1e-12  # never 0
            problem.sigma = dict(zip(recording.channels, sizes.tolist(), strict=True))
            found = problem.solve(found.x, 20)
        slopes = problem.slopes(found.x, central=True)
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
        dof = slopes.shape[0] - slopes.shape[1]
        return cls(problem, found.x, spread, 2 * float(found.cost), max(dof, 1), unknown)

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
    rows = problem.residuals(found.x[np.newaxis])[0]
    present = zip(recording.channels, rows, recording.present, strict=True)
    values, names = found.values, problem.names
    numbers = _numbers(found, radians=radians)
    notes, faults = [*recording.notes], []
    if problem.is_even:
        notes.append("the sign of b is not determined: theta alone does not show the direction")
    if rival:
        shown = ", ".join(f"{x} = {rival.values[x]:.6g}" for x in ("a", "b", "r0") if x in names)
        faults.append(f"another top explains the recording as well: {shown}")
    if found.unknown:
        faults.append(f"the recording does not determine {' and '.join(found.unknown)}")
    if problem.spins:
        pairs = [
            (names.index(x), sign / values[x]) for x, sign in (("b", 1), ("r0", -1)) if x in names
        ]
        ratio = values["b"] / values["r0"] if values["r0"] else 0.0
        std = abs(ratio) * float(np.linalg.norm(sum(y * found.spread[i] for i, y in pairs)))
        if not -_APART * std < ratio < 2 + _APART * std:
            faults.append(f"C/A = {ratio:.3g} is impossible: a rigid body has 0 < C/A <= 2")
        if "phi" in recording.angles and abs(values["r0"]) * recording.frame > math.pi:
            notes.append("the spin exceeds half a turn per frame: r0 is the slowest possible rate")
    chi2_dof = found.chi2 / found.dof
    if recording.sigma and chi2_dof < (low := chi2_bounds(found.dof)[0]):
        notes.append(f"chi2/dof = {chi2_dof:.3g} is below {low:.3g}: the noise is below sigma")
    if products := [x for x in numbers if set(x) & set("*/")]:
        notes.append(f"only {' and '.join(products)} can be determined: give known inputs")
    body = [(i, x) for i, x in enumerate(names) if x in {"a", "b", "r0"}]
    return Outcome(
        recording,
        problem.known,
        radians,
        numbers,
        {key: _meaning(key, problem, numbers, radians=radians) for key in numbers},
        {name: Residuals(recording.t[known], y[known]) for name, y, known in present},
        found.dof,
        chi2_dof,
        frequency,
        lambda t: problem.angles(found.x[np.newaxis], t)[:, 0],
        faults,
        notes,
        _inputs(found, numbers),
        {(x, y): float(found.spread[i] @ found.spread[j]) for i, x in body for j, y in body},
    )


def _numbers(found: Minimum, *, radians: bool) -> dict[str, tuple[float, float]]:
    """Return every number and its standard deviation, from one batch of finite differences."""
    problem, known = found.problem, found.problem.known
    others = [x for x in known.stds if x not in problem.names]
    centre = np.array([*found.x, *(known[x] for x in others)])
    spread = np.zeros((centre.size, found.spread.shape[1] + len(others)))
    spread[: found.x.size, : found.spread.shape[1]] = found.spread
    for i, name in enumerate(others, -len(others)):
        spread[i, i] = known.stds[name]
    steps = 1e-6 * np.maximum(np.abs(centre), 1e-3)
    x = np.concatenate([[centre], centre + np.diag(steps), centre - np.diag(steps)])
    uncertain = dict(zip(others, x[:, found.x.size :].T, strict=True))
    numbers, (per_radian, unit) = {}, angle_unit(radians=radians)
    computed = _computed(problem, x[:, : found.x.size], uncertain, radians=radians)
    for key, y in computed.items():
        slopes = (y[1 : steps.size + 1] - y[steps.size + 1 :]) / (2 * steps)
        std = float(np.linalg.norm(slopes @ spread))
        scale, ending = (
            (per_radian, f"_{unit}") if key in {"theta0", "psi_zero", "phi_zero"} else (1.0, "")
        )
        if np.isfinite([y[0], std]).all():
            numbers[f"{key}{ending}"] = float(y[0]) * scale, std * scale
    return numbers


def _computed(
    problem: Problem, x: Array, others: Mapping[str, Array], *, radians: bool
) -> dict[str, Array]:
    """Return the unknown numbers of the motion and of the body for many parameters."""
    v = {**problem.values(x), **others}
    free = {*problem.names, *["b"] * problem.is_tied}
    found = {name: v[name] for name in (*_MEANINGS, *problem.priors) if name in free}
    has = {name: v[name] for name in problem.known} | ({"r0": v["r0"]} if problem.spins else {})
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
    certain = problem.known.keys() - problem.known.stds.keys()
    return {key: y for key, y in (found | derived).items() if key not in certain}


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
    if name in problem.priors:
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
