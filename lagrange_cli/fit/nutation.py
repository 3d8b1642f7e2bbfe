"""The fit of a nutating top: one minimum of the least squares, and the numbers that follow."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from ..motion.quantity import unit_name
from ..motion.record import shown_keys
from ..sweep.records import sweep
from .noise import Residuals, chi2_bounds
from .outcome import Outcome
from .problem import Problem

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
_DERIVED = (
    *("T_nutation", "T_precession", "mean_precession_rate", "mean_spin_rate"),
    *("theta_min_deg", "theta_max_deg", "stability_factor"),
    *("T_nutation_elementary", "precession_rate_elementary"),
)
_ELEMENTARY = {
    "T_nutation_elementary": "T_nutation",
    "precession_rate_elementary": "mean_precession_rate",
}
_IN_DEGREES = ("theta0", "psi_zero", "phi_zero")
_DEPENDENT = 1e-7
"""Ratio of singular values of the slopes below which parameters are not determined."""
_SHARE = 0.05
"""Share of a parameter in a direction that is not determined, from which it is not either."""
_APART = 4.0
"""Standard deviations between different tops, and between numbers that differ for sure."""
_LEAST, _FASTEST = 2.0, 1e6
"""Standard deviations by which a > 0, and the largest b^2/a at which a is determined."""
_REWEIGHTINGS, _STEPS, _FEW_STEPS = 4, 80, 20
_ZERO = 1e-12
"""Noise in radians that is added to that of residuals, which may be 0."""


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
        found = problem.solve(start, _STEPS)
        present = recording.present
        share = present.sum() / max(present.sum() - found.x.size, 1)
        for _ in range(0 if recording.sigma else _REWEIGHTINGS):
            rest = np.where(present, problem.residuals(found.x[np.newaxis])[0], np.nan)
            sizes = np.sqrt(np.nanmean(rest**2, axis=1) * share) + _ZERO
            problem.sigma = dict(zip(recording.channels, sizes.tolist(), strict=True))
            found = problem.solve(found.x, _FEW_STEPS)
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
    def deviations(self) -> Array:
        """The standard deviations of the parameters."""
        return np.asarray(np.linalg.norm(self.spread, axis=1))

    @property
    def values(self) -> dict[str, float]:
        """The quantities of the motion, and known inputs."""
        found = self.problem.values(self.x[np.newaxis])
        return {name: float(x[0]) for name, x in found.items()}

    def differs(self, other: Minimum) -> bool:
        """Return whether this is another top: in a, b or r0."""
        rows = [i for i, name in enumerate(self.problem.names) if name in {"a", "b", "r0"}]
        near = _APART * self.deviations + 1e-6 * np.abs(self.x)
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
    notes, faults = [], []
    if recording.is_mirrored:
        notes.append("psi counts in the other direction: its sign was changed")
    if problem.is_even:
        notes.append("the sign of b is not determined: theta alone does not show the direction")
    if rival:
        shown = ", ".join(f"{x} = {rival.values[x]:.6g}" for x in ("a", "b", "r0") if x in names)
        faults.append(f"another top explains the recording as well: {shown}")
    if found.unknown:
        faults.append(f"the recording does not determine {' and '.join(found.unknown)}")
    if problem.spins:
        i, j = (names.index(x) if x in names else -1 for x in ("b", "r0"))
        ratio = values["b"] / values["r0"] if values["r0"] else 0.0
        slopes = [1 / values["b"] if i >= 0 else 0.0, -1 / values["r0"] if j >= 0 else 0.0]
        std = abs(ratio) * float(np.linalg.norm(slopes @ found.spread[[i, j]]))
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
    covariance = {
        (x, y): float(found.spread[i] @ found.spread[j]) for i, x in body for j, y in body
    }
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
        covariance,
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
        scale, ending = (per_radian, f"_{unit}") if key in _IN_DEGREES else (1.0, "")
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
    if "A" not in has:
        spins = {"C", "r0"} <= has.keys()
        has["A"] = has["C"] * has["r0"] / values["b"] if spins else has.get("C", 1.0)
    if "C" not in has:
        has["C"] = values["b"] * has["A"] / has["r0"] if has.get("r0") else has["A"]
    weight = values["a"] / 2 * has["A"]  # mgs
    if {"m", "s"} <= has.keys():
        has.setdefault("g", weight / (has["m"] * has["s"]))
    gravity = has.setdefault("g", 1.0)
    if "m" not in has:
        has.setdefault("s", has["A"] * gravity / (10 * weight))
        has["m"] = weight / (gravity * has["s"])
    has.setdefault("s", weight / (gravity * has["m"]))
    has["r0"] = values["b"] * has["A"] / has["C"]
    start = {"theta0_deg": math.degrees(values["theta0"])}
    start |= {x: values[x] for x in ("thetadot0", "psidot0")}
    return {**{x: has[x] for x in body}, **start}
