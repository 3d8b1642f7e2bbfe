"""The numbers of a nutating top, from a minimum of the least squares."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..arithmetic.types import Array
from ..solver.keys import shown_keys
from ..sweeps.records import sweep
from ..top.inputs import all_replaced
from ..top.units import Units
from .conditions import Comparison, Vector
from .known import CONTRADICTS, WEIGHT, Known, body_numbers, time_power
from .measured import Measured
from .outcome import PERCENT, Number, Outcome
from .reasons import Kind, Reason

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
    *("theta_min_rad", "theta_max_rad", "stability_factor", *_ELEMENTARY),
)
_UNSURE = 0.1
"""Standard deviations of the tilt over its distance from a pole, beyond which the precession in the
first row is not determined."""
_OPEN = 0.25
"""The same for the sign of the nutation rate."""
_IMPROVED = 0.999
"""Standard deviation of a known input after the fit, over the given one, from which it is new."""
_KNOWN = 1e-4
"""Standard deviation of a number over that without known inputs, below which they determine it."""


def nutating_outcome(
    found: Comparison,
    recording: Measured,
    scale: float,
    *,
    is_spin_known: bool,
    is_even: bool,
    rivals: Sequence[Reason],
    assumed: Sequence[str],
    **others: Any,
) -> Outcome:
    """Return the result of a fit whose unit of time is `scale` units of the recording.

    Without `is_spin_known`, no number follows from r0.  The notes begin with what is `assumed` of
    the spin.  `rivals` are other tops.  All other arguments are those of `Outcome`.
    """
    vector, best = found.vector, found.vector.best
    names, motion = best.problem.names, best.problem.angles
    pairs = vector.numbers(lambda at: _computed(vector, at, is_spin_known=is_spin_known))
    hidden = {x for x, (_, std, _) in pairs.items() if std <= _KNOWN * found.free.get(x, 0.0)}
    hidden |= {x for x, (_, y) in vector.known.items() if pairs.get(x, (0, 0))[1] >= _IMPROVED * y}
    tilt = best.values["theta0"]
    nearness = pairs.get("theta0", (0.0, 0.0))[1] / min(tilt, math.pi - tilt)
    hidden |= {"psidot0", "psi_zero", "phi_zero"} if nearness > _UNSURE else set()
    hidden |= {"thetadot0"} if nearness > _OPEN else set()
    numbers = {}
    for name, (value, *spreads) in pairs.items():
        if name in hidden or not spreads[0]:  # without a spread, known inputs determine it
            continue
        size = 1.0 if name in _ANGLES else scale ** time_power(name)
        std, own = (x * size for x in spreads)
        key = f"{name}_rad" if name in _ANGLES else name
        meaning = _meaning(name, vector.known, pairs)
        turns = (math.pi - value) // (2 * math.pi) if name.endswith("_zero") else 0  # within a half
        numbers[key] = Number((value + 2 * math.pi * turns) * size, std, meaning, own)
    body = {
        x: vector.spread[names.index(x)]
        for x in ("a", "b", "r0")
        if {x} <= numbers.keys() & {*names}
    }
    unit = {x: y / np.linalg.norm(y) for x, y in body.items()}
    products = [x for x in numbers if set(x) & set("*/") and is_spin_known]
    notes = [*assumed, *[_wish(products)] * bool(products), *_too_small(pairs, vector.known)]
    if recording.angles.keys() == {"theta"} and vector.known.get("psidot0") == (0, 0):
        notes.append("the sign of b is not determined: theta alone does not show the direction")
    inputs, arbitrary = _inputs(found, is_spin_known=is_spin_known)
    arbitrary |= hidden & {"thetadot0", "psidot0"} - all_replaced(vector.known)
    return Outcome(
        recording=recording,
        in_radians=numbers,
        motion=lambda t: motion(best.x[np.newaxis, np.newaxis], t / scale)[:, 0, 0],
        parameters=best.x.size - vector.conditions,
        frequency=1 / scale,
        reasons=[*rivals, *_faults(found, is_even=is_even)],
        notes=[*notes, *found.notes],
        inputs={x: y * scale ** time_power(x) for x, y in inputs.items()},
        arbitrary=arbitrary,
        distances=found.distances,
        correlations={
            f"{x} and {y}": float(unit[x] @ unit[y]) for x in unit for y in unit if x < y
        },
        **others,
    )


def _wish(products: Sequence[str]) -> str:
    """Return which products of inputs are determined, and which inputs would separate them."""
    names = sorted({x for product in products for x in re.findall(r"\w+", product)})
    some = " or ".join(names) + " is" if len(names) == 2 else f"some of {', '.join(names)} are"
    return f"only {' and '.join(products)} can be determined, unless {some} given"


def _too_small(pairs: Mapping[str, tuple[float, ...]], known: Known) -> list[str]:
    """Return a note if A is below m s^2, by more than the uncertainties of A, m and s."""
    if not {"m", "s"} <= known.keys() or "A" not in pairs:
        return []
    (m, m_std), (s, s_std), (A, A_std, *_) = known["m"], known["s"], pairs["A"]
    least, std = m * s**2, math.hypot(A_std, m_std * s**2, 2 * m * s * s_std)
    if A + CONTRADICTS * std >= least:
        return []
    return [
        f"A is impossible: a rigid body needs A > m s^2 = {least:.5g}: check the values and units "
        "of m, s and g"
    ]


def _faults(found: Comparison, *, is_even: bool) -> list[Reason]:
    """Return why the top is undetermined or impossible, or contradicts known inputs."""
    best, faults = found.vector.best, [Reason(Kind.KNOWN, x) for x in found.contradictions]
    values = best.values
    if best.unknown:
        known = [x for x in best.unknown if not x.endswith("_zero")] or best.unknown
        missing = f"the recording does not determine {', '.join(known)}"
        faults.append(Reason(Kind.OPEN, missing))
    elif best.is_curved:
        hardly = (
            "the recording hardly determines the top: chi^2 is not parabolic within two standard "
            "deviations"
        )
        faults.append(Reason(Kind.OPEN, hardly))
    spins = best.spins
    r0 = values["r0"] if spins else found.vector.here(found.vector.body).get("r0", 0.0)
    if r0 and not best.unknown:
        ratio, std = values["b"] / r0, best.std("b") / abs(r0)
        is_free = spins and is_even
        if not -3 * std < ratio < 2 + 3 * std and not (is_free and abs(ratio) < 3 * std):
            wrong = f"C/A = {ratio:.3g} is impossible: a rigid body has 0 < C/A <= 2"
            faults.append(Reason(Kind.IMPOSSIBLE, wrong))
    return faults


def _computed(vector: Vector, at: Array, *, is_spin_known: bool) -> dict[str, Array]:
    """Return the numbers of the motion and of the body for many vectors, start in radians."""
    v, has, body, seen = vector.motion(at), vector.inputs(at), vector.body(at), vector.best.spins
    angles = vector.best.problem.recording.angles
    names = [x for x in _MEANINGS if x != "r0" or seen]
    found = {x: v[x] for x in names if x not in {"phi_zero", "psi_zero"} or x[:3] in angles}
    found |= {x: has[x] for x in vector.uncertain}
    has_spin = (seen or "r0" in body) and is_spin_known
    body = {x: y for x, y in body.items() if x != "r0"} | ({"r0": v["r0"]} if has_spin else {})
    found |= body_numbers(v["a"] / 2, v["b"], body)
    start: dict[str, Any] = {"theta0_rad": v["theta0"]}
    start |= {x: v[x] for x in ("thetadot0", "psidot0")}
    swept = sweep(keys=_DERIVED, radians=True, m=1, A=1, C=1, s=1, g=v["a"] / 2, r0=v["b"], **start)
    derived = {key: np.asarray(swept[key], float) for key in _DERIVED}
    derived["mean_spin_rate"] = derived["mean_spin_rate"] + v["r0"] - v["b"]
    if not has_spin and not seen:
        del derived["mean_spin_rate"]
    for key, exact in _ELEMENTARY.items():
        derived[f"{key}{PERCENT}"] = 100 * (derived[key] / derived[exact] - 1)
    return found | derived


def _meaning(name: str, known: Known, pairs: Mapping[str, tuple[float, ...]]) -> str:
    if name in known:
        return "known, improved by the fit"
    if off := pairs.get(f"{name}{PERCENT}"):
        side, sigmas = ("below", "above")[off[0] > 0], abs(off[0]) / (off[1] or math.inf)
        sure = f"{sigmas:.{int(sigmas < 10)}f} sigma"
        return f"fast-top formula: {abs(off[0]):.2g} % {side} the fit ({sure})"
    declared = shown_keys(Units(radians=True), requested=True)
    if name in declared and name not in _MEANINGS:
        return declared[name].meaning
    return _MEANINGS.get(
        name, "only this combination is determined" if set(name) & set("*/") else ""
    )


@np.errstate(all="ignore")
def _inputs(found: Comparison, *, is_spin_known: bool) -> tuple[dict[str, float], set[str]]:
    """Return inputs of `Top` with this motion, and which of the body's are arbitrary.

    Undetermined ones are A = g = 1, C = A, and m s^2 = A/10 or less, as a body allows.  If known
    inputs contradict the motion, its a and b determine A and C.
    """
    v, has = found.vector.here(found.vector.motion), found.vector.here(found.vector.body)
    if found.vector.best.spins:
        has["r0"] = v["r0"]
    wrong = {"r0"} if not is_spin_known else set()
    if found.contradictions:
        wrong |= {"A"} if has.keys() >= WEIGHT else set()
        wrong |= {"C"} if {"r0"} <= has.keys() - wrong else set()
    has = {x: y for x, y in has.items() if x not in wrong}
    names = ("m", "s", "g", "A", "C", "r0")

    def complete() -> None:
        """Add what follows from a, b and the others."""
        follow = body_numbers(v["a"] / 2, v["b"], has).items()
        has.update({x: y for x, y in follow if x in names and np.isfinite(y)})

    complete()
    arbitrary = {*names} - has.keys()
    has.setdefault("A", has.get("C", 1.0))
    complete()
    has["r0"] = v["b"] * has["A"] / has.setdefault("C", has["A"])
    share = min(0.1, max(1 - has["C"] / (2 * has["A"]), 1e-3) / 2)
    has.setdefault("g", 1.0)
    complete()
    has.setdefault("s", 2 * share * has["g"] / v["a"])
    complete()
    inputs = {x: has[x] for x in names} | {"theta0_deg": math.degrees(v["theta0"])}
    inputs |= {x: v[x] for x in ("thetadot0", "psidot0")}
    return {x: float(y) for x, y in inputs.items()}, arbitrary
