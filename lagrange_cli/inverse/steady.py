"""Recordings without visible nutation: the mean tilt and the mean rates of a steady precession.

A steady precession with the rate Omega keeps the tilt if m g s = Omega (C r0 - A Omega cos(theta)).
Elementary theory neglects the last term: C r0 = m g s/Omega is too small by the fraction
x = A Omega cos(theta)/(C r0), whose sign is known, and whose size depends on C/A.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import Message, arg
from ..top.inputs import TILT, all_replaced, replaced_by
from ..top.units import bare_name
from .conditions import Comparison, Vector, compare
from .known import START, WEIGHT, Known, body_of
from .measured import ANGLE_OF, Measured
from .outcome import Number, Outcome
from .problem import Ties
from .reasons import Kind, Reason
from .residuals import CHANCE, Noise, Residuals
from .signals import Signal
from .spins import FASTER, reversed_note, slowest_rate

_MOST_TILT = 0.04
"""Largest scatter of the tilt in radians that counts as noise, if sigma is not given."""
_LEAST_ROWS = 30
"""Least number of rows that shows a nutation, if sigma is not given."""
_LEAST, _MOST = 0.05, 2.0
"""Bounds of C/A if it is not known."""
_MOST_BIAS = 0.8
"""Largest share of the neglected term with which b/a is determined."""
_UNIFORM = 1.75
"""Half of a range over the standard deviation of a number in it."""
_SURE = 4.0
"""Standard deviations of a rate that is not 0."""
_KNOWN = 1e-9
"""Standard deviation of b/a over that without known inputs, up to which they alone give it."""
_Pair = tuple[float, float]
_MEANS = {"theta": "mean_tilt_rad", "psi": "mean_precession_rate", "phi": "mean_spin_rate"}
_MEANINGS = {
    "mean_tilt": "mean tilt",
    "mean_precession_rate": "mean precession rate",
    "mean_spin_rate": "mean spin rate phi'",
    "r0": "total spin rate, from the means",
    "b/a": "C r0/2mgs",
}


class _Mean(NamedTuple):
    """The mean of the tilt, or the mean rate of another angle, and the angle in the first row."""

    value: float
    std: float
    start: float


_NONE = _Mean(0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Means:
    """A steady precession whose parameters are its tilt, psi', phi' and the factor 1/(1 - x).

    The factor is that of b/a by the neglected term.  It counts if known inputs do not give C/A; b
    and a have no meaning then but their ratio.  A number that a known A or C itself gives is NaN,
    so that they are not compared: a, if m, g, s and A are known, or else b, if A and C are.
    """

    x: Array
    spread: Array
    spins: bool
    turns: float
    """Whole turns per row, as a rate, that r0 exceeds the visible rate by."""

    def quantities(self, at: Array, has: Mapping[str, Any]) -> dict[str, Array]:
        """Return the quantities of motions, shape (tries,), and b/a."""
        tilt, turn, spin, factor = at.T
        along = turn * np.cos(tilt)
        v = {TILT: tilt, "thetadot0": 0 * tilt, "psidot0": turn}
        body = body_of(has, v)
        r0 = spin + along + self.turns if self.spins else body.get("r0", along)
        with np.errstate(all="ignore"):
            if "A" in body and body.keys() >= WEIGHT:
                a = 2 * body["m"] * body["g"] * body["s"] / body["A"]
                b = a / (2 * turn) + along
                v |= {"a": np.nan * a, "b": b, "b/a": b / a}
            elif {"A", "C"} <= body.keys():
                b = r0 * body["C"] / body["A"]
                a = 2 * turn * (b - along)
                v |= {"a": a, "b": np.nan * b, "b/a": b / a}
            else:
                v |= {"a": 2 * turn * r0 / factor, "b": r0, "b/a": factor / (2 * turn)}
        return v | {"r0": r0}

    def turned(self, turns: float) -> Means:
        """Return the same with a spin that is faster by whole turns per row."""
        return replace(self, turns=self.turns + turns)

    def tied(self, _: Ties) -> Means:
        """Return the same: no further fit is needed to obey known inputs."""
        return self


def _mean(
    signal: Signal, name: str, recording: Measured, step: float, sigma: float | None
) -> _Mean:
    """Return the mean tilt, or the slope of a straight line through spin or precession.

    The noise is at least that of the steps between values.  If steps explain the residuals, the
    mean is known to a step, and the rate to a step over the duration.
    """
    is_tilt, middle = name == "theta", signal.t.mean()
    y = signal.y + signal.rate * signal.t
    if is_tilt:
        y = recording.angles[name][np.isfinite(recording.angles[name])]
    around = signal.t - middle
    factors = np.polyfit(around, y, 0 if is_tilt else 1)
    rest = Residuals(signal.t, y - np.polyval(factors, around), step)
    noise = max(sigma or rest.rms * math.sqrt(y.size / (y.size - 2)), step / math.sqrt(12), 1e-12)
    size = math.sqrt(float(around @ around)) if not is_tilt else math.sqrt(y.size)
    std = noise * rest.widening() / size
    if rest.is_coarse:  # errors of steps may not average out
        std = max(std, step / math.sqrt(12) / (1 if is_tilt else float(signal.t[-1])))
    return _Mean(float(factors[0]), std, float(np.polyval(factors, -middle)))


def steady_outcome(
    recording: Measured,
    known: Known,
    signals: Mapping[str, Signal],
    noise: Mapping[str, Noise],
    frequency: float,
    **others: Any,
) -> Outcome:
    """Return the result of a fit of a constant tilt and constant rates.

    The `noise` of the channels and all others are those of `Outcome`, `frequency` is that of a
    nutation to look for.
    """
    sigma = {ANGLE_OF[x]: y for x, y in recording.sigma.items()}
    means = {
        x: _mean(y, x, recording, noise.get(x, Noise()).step, sigma.get(x))
        for x, y in signals.items()
    }
    tilt = means.get("theta") or (_Mean(*known[TILT], 0.0) if TILT in known else None)
    notes = ["no nutation is visible: the numbers are means over the recording"]
    more, is_sure, seen = 0.0, True, "phi" in means
    turn = 2 * math.pi / recording.frame if recording.is_even and seen else 0.0
    if seen and tilt:
        recording, means, more, is_sure = _direction(recording, means, tilt.value, turn, notes)
    elif seen:
        unknown = "without the tilt, neither r0 nor C is determined"
        notes.append(Message(f"{unknown}: give {arg(TILT)}"))
    body = {x: y for x, y in known.items() if replaced_by(x) not in {*START, "steady"}}
    is_known = "r0" in all_replaced(body)
    each = [tilt or _NONE, *(means.get(x, _NONE) for x in ("psi", "phi"))]
    is_sure |= is_known
    is_derived = bool(tilt) and (seen or is_known)
    x, stds = (np.array([y[i] for y in each] + [1 - i]) for i in (0, 1))
    best = Means(x, np.diag(stds), seen and bool(tilt), more)
    factor = _factor(Vector(best, body), notes, is_sure=is_sure) if is_derived else None
    if factor:
        best.x[3], best.spread[3, 3] = factor
    found = compare(best, body, 1.0, turn)
    is_sure |= found.is_selected
    if tilt and turn:
        notes.append(
            f"r0 is known only up to whole turns per row, multiples of {turn:.6g}"
            + "; C and the sign of r0 do not follow" * (not is_sure)
        )

    numbers = _numbers(found, means, is_derived=is_derived, is_sure=is_sure, has_ratio=bool(factor))
    spin, turned = (means.get(x, _NONE) for x in ("phi", "psi"))

    def motion(t: Array) -> Array:
        lines = [x.start + x.value * t for x in (spin, turned)]
        return np.stack([np.full(t.shape, tilt.value if tilt else math.pi / 2), *lines])

    result = Outcome(
        recording=recording,
        known=known,
        in_radians=numbers,
        motion=motion,
        parameters=2 * len(means) - ("theta" in means),
        frequency=1 / float(recording.t[-1]),
        noise=noise,
        notes=notes + found.notes,
        distances=found.distances,
        **others,
    )
    reasons = [Reason(Kind.KNOWN, x) for x in found.contradictions]
    has_sign = is_derived and not reasons  # a wrong r0 has any
    r0 = float(found.vector.here(found.vector.motion)["r0"]) if has_sign else 0.0
    reasons += _faults(recording, turned, r0, result, frequency)
    return replace(result, reasons=reasons)


def _numbers(
    found: Comparison,
    means: Mapping[str, _Mean],
    *,
    is_derived: bool,
    is_sure: bool,
    has_ratio: bool,
) -> dict[str, Number]:
    """Return the means, r0 if it is derived, and the numbers from b/a if it is determined."""
    vector = found.vector

    def computed(at: Array) -> dict[str, Array]:
        v, has = vector.motion(at), vector.body(at)
        numbers = {_MEANS[x]: at[:, i] for i, x in enumerate(_MEANS) if x in means}
        numbers |= {"r0": v["r0"]} if is_derived else {}
        if has_ratio:
            weight = 2 * math.prod(has[x] for x in "msg" if x in has)
            unknown = [x for x in "msg" if x not in has]
            over = {0: "", 1: f"/{''.join(unknown)}"}.get(len(unknown), f"/({'*'.join(unknown)})")
            numbers["b/a"] = v["b/a"]
            product = numbers["b/a"] * weight / (v["r0"] if is_sure else 1)
            numbers[f"C{over}" if is_sure else f"C*r0{over}"] = product
        return {x: y for x, y in numbers.items() if x not in vector.known}

    return {
        key: Number(value, std, _MEANINGS.get(bare_name(key), "from the mean rates"), own)
        for key, (value, std, own) in vector.numbers(computed).items()
        if std > _KNOWN * found.free.get(key, 0.0)
    }


def _factor(vector: Vector, notes: list[str], *, is_sure: bool) -> _Pair | None:
    """Return 1/(1 - x) and its standard deviation, None if b/a is not determined."""
    v, body = vector.here(vector.motion), vector.here(vector.body)
    r0, along = v["r0"], v["psidot0"] * math.cos(v[TILT])
    if not v["psidot0"] or not r0:
        return None
    if "A" in body and ("C" in body or body.keys() >= WEIGHT):
        return 1.0, 0.0
    if not is_sure:  # psi may count in the other direction, or the spin be faster
        r0 = math.copysign(min(abs(r0), abs(vector.z[2] - along)), r0)
    shares = [along / (r0 * _LEAST), along / (r0 * _MOST) * is_sure]
    if max(shares) > _MOST_BIAS:
        notes.append("b/a is not determined: A Omega cos(theta) may be as large as C r0")
        return None
    low, high = sorted(1 / (1 - x) for x in shares)
    if low != high:
        notes.append(
            f"b/a and C r0 include A Omega cos(theta) = {100 * min(shares):.2g} to "
            f"{100 * max(shares):.2g} % of C r0, for C/A from {_MOST:g} to {_LEAST:g}: known A, m, "
            "g and s make them exact"
        )
    return (low + high) / 2, (high - low) / 2 / _UNIFORM


def _direction(
    recording: Measured, means: dict[str, _Mean], tilt: float, turn: float, notes: list[str]
) -> tuple[Measured, dict[str, _Mean], float, bool]:
    """Return recording and means with psi in the direction of the spin, the whole turns per row
    that r0 exceeds its visible rate by, and if the direction is sure.

    If psi' and r0 have opposite signs, either psi counts in the other direction, or the spin is
    faster.
    """
    psi, spin = means.get("psi", _NONE), means["phi"].value
    visible = [spin + x * psi.value * math.cos(tilt) for x in (1, -1)]
    rates = [slowest_rate(y, turn, x * psi.value) for x, y in zip((1, -1), visible, strict=True)]
    way = int(recording.kind == "angles" and FASTER * abs(rates[1]) < abs(rates[0]))
    if way:
        notes.append(reversed_note(abs(rates[0]) / turn if turn else 0.0))
        psi = _Mean(-psi.value, psi.std, -psi.start)
        recording, means = recording.mirrored, means | {"psi": psi}
    rate = rates[way] if math.isfinite(rates[way]) else visible[way]
    is_sure = not turn or (abs(rate) * (1 + FASTER) < turn and psi.value * rate > 0)
    return recording, means, rate - visible[way], is_sure


def _faults(
    recording: Measured, turn: _Mean, r0: float, result: Outcome, frequency: float
) -> list[Reason]:
    """Return why the motion is not a steady precession, besides the residuals."""
    found = list[Reason]()
    for rest in result.residuals.values():
        if not rest.is_coarse and rest.structure(frequency)[1] < CHANCE / 10:
            wrong = "the motion is not a steady precession: the angles oscillate"
            found.append(Reason(Kind.IMPOSSIBLE, wrong))
            break
    if "psi" not in recording.angles:
        without = "no nutation is visible, and without psi no precession rate"
        found.append(Reason(Kind.OPEN, without))
    elif not abs(turn.value) > _SURE * turn.std:
        slow = "no nutation is visible, and the precession rate is not determined"
        found.append(Reason(Kind.OPEN, slow))
    elif turn.value * r0 < 0 and (
        recording.kind == "attitude" or "r0" in all_replaced(result.known)
    ):
        wrong = "C/A < 0 is impossible: spin and precession have opposite signs"
        found.append(Reason(Kind.IMPOSSIBLE, wrong))
    scatter = float(np.nanstd(recording.angles.get("theta", np.zeros(1))))
    if scatter > _MOST_TILT and not recording.sigma:
        off = math.degrees(scatter)
        noise = f"give {arg('sigma')} if this is noise"
        found.append(Reason(Kind.OPEN, f"the tilt varies by {off:.2g} degrees: {noise}"))
    elif recording.t.size < _LEAST_ROWS and not recording.sigma:
        few = f"{recording.t.size} rows are too few to tell nutation from noise"
        found.append(Reason(Kind.OPEN, f"{few}: give {arg('sigma')}"))
    return found
