"""`fit`: the top behind a recording, by least squares from the best of many starts.

The starts are closed-form tops with the nutation of the recording.  Their residuals at some rows
select a few, from which the least squares converge.  If no nutation is visible, or none is
determined, a steady precession is fitted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter
from types import NoneType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import OptimizeResult, least_squares

from ..arithmetic.numbers import angle_unit
from ..arithmetic.text import parse_number
from ..arithmetic.types import Array
from ..errors import DataError, LagtopError, check_type
from ..solver.keys import shown_keys, unit_name
from ..sweeps.records import sweep
from ..top.given import gather
from ..top.values import value_of
from .motions import STATE, angles
from .outcome import CHANCE, GOOD, PERCENT, Outcome, chi2_bounds
from .recording import Known, Recording, known_inputs, recording_from, turned_up
from .starts import Signal, noise_of, oscillation_in, signals_in, starts
from .steady import steady_outcome

_FEW_ROWS, _ROWS, _MANY_ROWS = 12, 50, 300
"""Rows at which all starts are compared, then the best, and rows of the first steps."""
_KEPT, _BLOCK = 1500, 2000
_STARTS, _FIRST_STEPS, _FINISHED = 20, 12, 3
"""Starts of the least squares, their first steps, and the number of those that converge."""
_ALIKE = 0.02
"""Relative difference of a and b below which two starts are the same."""
_COMPARABLE, _LIKELY = 50.0, 16.0
"""Factor of chi^2 above the least one, beyond which a start is dropped, and the difference of
-2 log(likelihood) below which two tops explain a recording equally well."""
_WINDOWS = (8, 12, 20, 32, 48)
"""Numbers of windows to suggest if the spin may decay."""
_ROWS_PER_WINDOW, _PERIODS_PER_WINDOW = 24, 1.5
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

    def __init__(self, recording: Recording, known: Known, sizes: Array) -> None:
        self.recording, self.inputs, self.sizes = recording, known, sizes
        """The `sizes` are the standard deviations of the channels."""
        self.known = {name: value for name, (value, _) in known.items()}
        self.stds = {name: std for name, (_, std) in known.items() if std}
        seen, has, weight = recording.angles.keys(), known.keys(), {"m", "g", "s"}
        self.spins = "phi" in seen or "r0" in has
        self.is_even = seen == {"theta"} and self.known.get("psidot0") == 0 and not self.spins
        """Whether the opposite b leaves the same tilt."""
        self.has_torque = weight | {"A"} <= has
        self.is_tied = self.spins and "C" in has and ("A" in has or weight <= has)
        fixed = {*has, *["a"] * self.has_torque, *["b"] * self.is_tied}
        self.names = [x for x in (*STATE, *["r0"] * ("phi" in seen)) if x not in fixed]
        self.names += [f"{x}_zero" for x in ("psi", "phi") if x in seen]
        self.count = len(self.names)
        """The number of parameters without a prior."""
        self.names += self.stds

    def thinned(self, count: int) -> Problem:
        """Return the same problem for at most `count` rows of the recording."""
        rows = np.unique(np.linspace(0, self.recording.t.size - 1, count).astype(int))
        return Problem(self.recording.part(rows), self.inputs, self.sizes)

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
        found = (self.residuals(x) / self.sizes[:, np.newaxis])[:, self.recording.present]
        value = self.values(x)
        priors = [(value[y] - self.known[y]) / std for y, std in self.stds.items()]
        rows: Array = np.nan_to_num(np.column_stack([found, *priors]), nan=_FAR, posinf=_FAR)
        return rows

    def noise(self, x: Array) -> Array:
        """Return the logarithm of the noise that each top leaves, summed over the channels."""
        mean = np.nanmean(self.residuals(x) ** 2, axis=2) + self.sizes**2
        return np.asarray(np.nan_to_num(np.log(mean).sum(axis=1), nan=np.inf))

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
        problem = Problem(recording, problem.inputs, problem.sizes)
        found = problem.solve(start, 80)
        present = recording.present
        share = present.sum() / max(present.sum() - problem.count, 1)
        for _ in range(0 if recording.sigma else 4):
            rest = np.where(present, problem.residuals(found.x[np.newaxis])[0], np.nan)
            problem.sizes = np.sqrt(np.nanmean(rest**2, axis=1) * share) + 1e-12  # never 0
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
        return self.chi2 + 2 * float(rows @ np.log(self.problem.sizes))

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
    numbers = found.numbers(lambda x: _computed(problem, x, radians=radians))
    for name, std in zip(names, np.linalg.norm(found.spread, axis=1), strict=True):
        if std > _IMPROVED * problem.stds.get(name, math.inf):
            numbers.pop(_named(name, radians=radians), None)
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
    unit = found.spread / (np.linalg.norm(found.spread, axis=1, keepdims=True) + 1e-300)
    body = [(i, x) for i, x in enumerate(names) if x in {"a", "b", "r0"} and x in numbers]
    return Outcome(
        recording,
        problem.inputs,
        radians,
        numbers,
        {key: _meaning(key, problem, numbers, radians=radians) for key in numbers},
        lambda t: problem.angles(found.x[np.newaxis], t)[:, 0],
        problem.count,
        frequency,
        faults,
        notes,
        _inputs(found, numbers),
        {f"{x} and {y}": float(unit[i] @ unit[j]) for i, x in body for j, y in body if x < y},
    )


def _named(name: str, *, radians: bool) -> str:
    """Return the key of a parameter, with the unit of an angle."""
    return f"{name}_{angle_unit(radians=radians)[1]}" if name in _ANGLES else name


def _computed(problem: Problem, x: Array, *, radians: bool) -> dict[str, Array]:
    """Return the numbers of the motion and of the body for many parameters."""
    v, scale = problem.values(x), dict.fromkeys(_ANGLES, angle_unit(radians=radians)[0])
    free = {*problem.names, *["b"] * problem.is_tied}
    names = [name for name in (*_MEANINGS, *problem.stds) if name in free]
    found = {_named(name, radians=radians): v[name] * scale.get(name, 1.0) for name in names}
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
    if name in problem.stds:
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
    moment = has.setdefault("A", has.get("C", 1.0))  # with C and r0, A is a number of the fit
    has["r0"] = values["b"] * moment / has.setdefault("C", values["b"] / values["r0"] * moment)
    weight = values["a"] / 2 * moment  # mgs
    unknown = [x for x in ("g", "s", "m") if x not in has]
    for name in unknown[:-1]:
        has[name] = 1.0 if name == "g" else moment * has["g"] / (10 * weight)
    for name in unknown[-1:]:
        has[name] = weight / math.prod(has[x] for x in ("m", "g", "s") if x != name)
    start = {"theta0_deg": math.degrees(values["theta0"])}
    return {x: has[x] for x in body} | start | {x: values[x] for x in ("thetadot0", "psidot0")}


def best_fit(
    recording: Recording,
    known: Known,
    *,
    radians: bool = False,
    chance: float = CHANCE,
    helpful: bool = True,
) -> Outcome:
    """Return the fit of one recording.

    If spin and precession are recorded, psi may count in the other direction.  `chance` is the
    probability that noise fails a test.  A `helpful` fit that fails says what to try.  Raises
    LagtopError, DataError for a recording that cannot be fitted.
    """
    for alone, needed in (("theta", "psidot0"), ("psi", "theta0")):
        if recording.angles.keys() == {alone} and needed not in known:
            flag = f"--{needed}" + (" 0 if the top is released from rest" * (alone == "theta"))
            raise DataError(f"{alone} alone does not determine a top: give {flag}")
    frequency, visible = oscillation_in(signals_in(recording))
    lasts = frequency * recording.t[-1] >= 1
    outcome = None
    if visible and lasts:
        outcome = _nutation(recording, known, frequency, radians=radians)
    outcome = outcome or steady_outcome(recording, known, oscillates=visible, radians=radians)
    outcome.chance = chance
    low = chi2_bounds(outcome.dof)[0]
    if outcome.chi2_dof is not None and outcome.chi2_dof < low:
        shown = f"{outcome.chi2_dof:.3g} is below {low:.3g}"
        outcome.notes.append(f"chi2/dof = {shown}: the noise is below sigma")
    if helpful and outcome.failures():
        near = all(rest.rms < 1 for rest in outcome.residuals.values())
        if visible and not lasts and near:
            outcome.hints.append("a recording must last for a period of the nutation")
        outcome.hints += _hints(recording, known, frequency)
    return outcome


def _nutation(
    recording: Recording, known: Known, frequency: float, *, radians: bool
) -> Outcome | None:
    """Return the best fit of a nutation, with its rival if it has one; None without a start."""
    both = recording.kind == "angles" and {"psi", "phi"} <= recording.angles.keys()
    begun = {}
    for problem, x in _best_starts([recording, recording.mirrored][: 1 + both], known, frequency):
        end = problem.thinned(_MANY_ROWS).solve(x, _FIRST_STEPS)
        begun[problem.recording.notes, f"{end.cost:.6g}"] = problem, end  # each minimum once
    ends = sorted(begun.values(), key=lambda pair: pair[1].cost)[:_FINISHED]
    found = [Minimum.of(p, end.x) for p, end in ends if end.cost <= _COMPARABLE * ends[0][1].cost]
    if not found:
        return None
    best, *others = sorted(found, key=lambda x: x.badness)
    rivals = [x for x in others if x.badness < best.badness + _LIKELY and x.differs(best)]
    return nutating_outcome(best, rivals[0] if rivals else None, frequency, radians=radians)


def _best_starts(
    ways: Sequence[Recording], known: Known, frequency: float
) -> list[tuple[Problem, Array]]:
    """Return the best starts that differ; in each way psi is counted in one direction.

    Starts are scored by the logarithm of the noise that they leave.
    """
    tried: list[tuple[float, Problem, Array]] = []
    for recording in ways:
        signals = signals_in(recording)
        sigma = recording.sigma or noise_of(signals, frequency, recording)
        problem = Problem(recording, known, np.array([sigma[x] for x in recording.channels]))
        states = starts(signals, frequency, problem.known.get("theta0"))
        for name in known.keys() & {*STATE}:
            states[:, STATE.index(name)] = problem.known[name]
        if "r0" in known or problem.is_even:  # r0 has the sign of b
            states = states[states[:, STATE.index("b")] * problem.known.get("r0", 1.0) >= 0]
        for count in (_FEW_ROWS, _ROWS) if len(states) > _KEPT else (_ROWS,):
            few = problem.thinned(count)
            blocks = np.array_split(states, len(states) // _BLOCK + 1)
            x = np.concatenate([few.parameters_of(y, signals.get("phi")) for y in blocks])
            score = np.concatenate([few.noise(y) for y in np.array_split(x, len(blocks))])
            order = np.argsort(score)[:_KEPT]
            states = states[order]
        tried += zip(score[order].tolist(), [problem] * len(order), x[order], strict=True)
    kept: list[tuple[Problem, Array]] = []
    for size, problem, x in sorted(tried, key=itemgetter(0)):
        near = _ALIKE * (np.abs(x[:2]) + 1e-300)
        is_new = all(p is not problem or np.any(np.abs(x - y)[:2] > near) for p, y in kept)
        if is_new and len(kept) < _STARTS and math.isfinite(size):
            kept.append((problem, x))
    return kept


def _hints(recording: Recording, known: Known, frequency: float) -> list[str]:
    """Return what to try after a failed fit, if another fit confirms it."""
    for axis in ("y", "x") if recording.kind != "angles" else ():
        if best_fit(turned_up(recording, axis), known, helpful=False).verdict == GOOD:
            return [f"the {axis} axis of the data points up: use --align up={axis}"]
    both = recording.kind == "angles" and {"phi", "psi"} <= recording.angles.keys()
    if both and best_fit(recording.exchanged, known, helpful=False).verdict == GOOD:
        return ["phi and psi are exchanged: here phi is the spin and psi the precession"]
    body = {name: x for name, x in known.items() if name in {"m", "g", "s", "A", "C"}}
    for count in _WINDOWS:
        enough = count * _ROWS_PER_WINDOW < recording.t.size
        if not enough or frequency * recording.t[-1] < count * _PERIODS_PER_WINDOW:
            break
        parts = recording.windows(count)
        some = (parts[0], parts[count // 2], parts[-1])
        chance = CHANCE / count
        if all(best_fit(x, body, chance=chance, helpful=False).verdict == GOOD for x in some):
            return [
                f"one top does not explain the motion: the spin may decay, try --window {count}"
            ]
    return ["check columns, units and axes, or try --window if the spin may decay"]


def fit_windows(
    recording: Recording, count: int, known: Known, *, radians: bool = False
) -> list[Outcome]:
    """Return the fits of equal windows of a recording.

    Raises LagtopError for a bad number of windows, or for a known input of one instant.
    """
    for name in known.keys() & {"r0", "theta0", "thetadot0", "psidot0"}:
        raise LagtopError(f"{name} is not the same in all windows: leave it out", name)
    return [
        best_fit(part, known, radians=radians, chance=CHANCE / count, helpful=False)
        for part in recording.windows(count)
    ]


def fit(
    t: ArrayLike,
    *,
    theta: ArrayLike | None = None,
    phi: ArrayLike | None = None,
    psi: ArrayLike | None = None,
    axis: ArrayLike | None = None,
    quaternion: ArrayLike | None = None,
    sigma: Mapping[str, float] | float | None = None,
    known: Mapping[str, Any] | None = None,
) -> Outcome:
    """Fit a top to a recording; the results are in `record()`.

    Times have the shape (n,), angles too (radians, within whole turns, NaN where missing).  Instead
    of angles, pass the axis in space, shape (n, 3), or the quaternion w, x, y, z from body to
    space, shape (n, 4).  `sigma` is a standard deviation in radians, or a mapping by channel; by
    default it is estimated from the residuals.  `known` are known inputs by key.  Texts such as
    `"0.070(5)"`, and numbers of uncertainties, are uncertain; units are converted to SI.  Raises
    LagtopError, DataError for a recording that cannot be fitted.

    >>> t = np.linspace(0, 2, 200)
    >>> noise = np.random.default_rng(2).normal(scale=1e-3, size=(3, 200))
    >>> theta, phi, psi = solve(Top()).angles(t) + noise
    >>> outcome = fit(t, theta=theta, phi=phi, psi=psi, known={"C": 17458})
    >>> outcome.verdict, outcome.failures()
    ('good', [])
    >>> [(key, round(x, 1)) for key, (x, std) in outcome.numbers.items()][:3]
    [('a', 319.1), ('b', 22.4), ('r0', 50.0)]
    >>> round(outcome.numbers["A"][0], -2), outcome.record()["dof"]
    (39000.0, 592)
    """
    check_type("known", known, Mapping, NoneType)
    recording = recording_from(
        t, sigma=sigma, theta=theta, phi=phi, psi=psi, axis=axis, quaternion=quaternion
    )
    given = {name: value_of(name, x, parse_number) for name, x in (known or {}).items()}
    found = gather(given)
    return best_fit(recording, known_inputs(found.inputs, found.stds))
