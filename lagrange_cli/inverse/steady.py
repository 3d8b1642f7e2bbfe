"""Recordings without visible nutation: the mean tilt and the mean rates of a steady precession.

A steady precession with the rate Omega keeps the tilt if m g s = Omega (C r0 - A Omega cos(theta)).
Elementary theory neglects the last term: C r0 = m g s/Omega is too small by the fraction
x = A Omega cos(theta)/(C r0), whose sign is known, and whose size depends on C/A.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import Message, arg
from ..top.inputs import TILT, all_replaced, replaced_by
from ..top.units import bare_name
from .checks import CHANCE, Noise, Residuals
from .known import WEIGHT, Known, compared, in_all_forms, whole_turns
from .measured import Measured
from .outcome import Number, Outcome
from .reasons import Kind, Reason
from .signals import Signal

_MOST_TILT, _LEAST_ROWS = 0.04, 30
"""Largest scatter of the tilt in radians that counts as noise, and the least number of rows that
shows a nutation, if sigma is not given."""
_RATIOS, _MOST_BIAS = (0.05, 2.0), 0.8
"""C/A in the bounds of the neglected term if it is not known, and the largest such term."""
_SURE, _QUARTER = 4.0, 0.25
"""Standard deviations of a rate that is not 0, and turns per row below which the spin shows the
direction of psi."""
_MEANINGS = {
    "mean_tilt": "mean tilt",
    "mean_precession_rate": "mean precession rate",
    "mean_spin_rate": "mean spin rate phi'",
    "r0": "total spin rate, from the means",
    "b/a": "C r0/2mgs",
}
_SMALL = 1e-3
"""Steps of differences in standard deviations."""
_Pair = tuple[float, float]


class _Mean(NamedTuple):
    """The mean of the tilt, or the mean rate of another angle, and the angle in the first row."""

    value: float
    std: float
    start: float


_NONE = _Mean(0.0, 0.0, 0.0)


def _mean(
    signal: Signal, name: str, recording: Measured, step: float, sigma: float | None
) -> _Mean:
    """Return the mean tilt, or the slope of a straight line through spin or precession.

    The noise is at least that of the steps between values.  If steps explain the residuals, the
    mean is known to a step, and the rate to a step over the duration.
    """
    is_tilt, middle = name == "theta", signal.t.mean()
    y = np.arccos(np.clip(signal.y, -1, 1)) if is_tilt else signal.y + signal.rate * signal.t
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
    alias = {"theta": "theta", "psi": "across", "phi": "along"}
    sigma = recording.sigma
    means = {
        x: _mean(y, x, recording, noise.get(x, Noise()).step, sigma.get(x) or sigma.get(alias[x]))
        for x, y in signals.items()
    }
    tilt = means.get("theta") or (_Mean(*known["theta0"], 0.0) if "theta0" in known else None)
    notes = ["no nutation is visible: the numbers are means over the recording"]
    is_sure, whole = "r0" in all_replaced(known), 0.0
    if "phi" in means and tilt:
        recording, means, whole, is_slow = _direction(recording, means, tilt, notes)
        is_sure |= is_slow
    elif "phi" in means:
        unknown = "without the tilt, neither r0 nor C is determined"
        notes.append(Message(f"{unknown}: give {arg('theta0')}"))
    numbers: dict[str, Number] = {}
    for name, key in (
        ("theta", "mean_tilt_rad"),
        ("psi", "mean_precession_rate"),
        ("phi", "mean_spin_rate"),
    ):
        if name in means:
            value, std = means[name][:2]
            numbers[key] = Number(value, std, _MEANINGS[bare_name(key)], std)
    turn, spin = (means.get(x, _NONE) for x in ("psi", "phi"))
    derived = dict[str, _Pair]()
    if tilt and ("phi" in means or is_sure):
        given = {**known, **{x: y[:2] for x, y in means.items()}, "theta": tilt[:2]}
        derived = _derived(given, whole, notes, is_sure=is_sure)
    reasons, distances = list[Reason](), dict[str, float]()
    seen, slowest = dict[str, _Pair](), dict[str, _Pair]()
    if tilt and "phi" in means:
        at = {TILT: tilt[:2], "psidot0": turn[:2], "phi": spin[:2]}
        visible = 2 * math.pi / recording.frame if recording.is_even else 0.0
        seen, slowest = (_spins(known, at, x) for x in (visible, 0.0))
    for key, pair in (derived | seen).items():
        if key in seen or (key == "C" and key in known):
            distances[key], agrees, text = compared(
                key, known[key], pair, known, slowest.get(key, (None,))[0]
            )
            if agrees:
                notes.append(text)
            else:
                reasons.append(Reason(Kind.KNOWN, text))
        elif key not in known:
            meaning = _MEANINGS.get(key, "from the mean rates")
            numbers[key] = Number(*pair, meaning, pair[1])

    def motion(t: Array) -> Array:
        lines = [x.start + x.value * t for x in (spin, turn)]
        return np.stack([np.full(t.shape, tilt.value if tilt else math.pi / 2), *lines])

    result = Outcome(
        recording=recording,
        known=known,
        in_radians=numbers,
        motion=motion,
        parameters=2 * len(means) - ("theta" in means),
        frequency=1 / float(recording.t[-1]),
        noise=noise,
        notes=notes,
        distances=distances,
        **others,
    )
    r0 = 0.0 if reasons else derived.get("r0", _NONE[:2])[0]  # a wrong one has any sign
    reasons += _faults(recording, turn, r0, result, frequency)
    return replace(result, reasons=reasons)


def _direction(
    recording: Measured, means: dict[str, _Mean], tilt: _Mean, notes: list[str]
) -> tuple[Measured, dict[str, _Mean], float, bool]:
    """Return recording and means with psi in the direction of the spin, the whole turns per row
    that r0 exceeds its visible rate by, and if the direction is sure.

    Whole turns per row are invisible.  If psi' and r0 have opposite signs, either psi counts in the
    other direction, if the spin is slow, or the spin is faster.
    """
    turn, spin = means.get("psi", _NONE), means["phi"]
    whole, more = 2 * math.pi / recording.frame if recording.is_even else 0.0, 0.0
    along = turn.value * math.cos(tilt.value)
    rate, slow = spin.value + along, abs(spin.value - along) * recording.frame / (2 * math.pi)
    is_backwards = turn.value * rate < 0 < turn.value * (along - spin.value)  # C/A < 0
    if recording.kind == "angles" and is_backwards and (slow < _QUARTER or not whole):
        recording, rate = recording.mirrored, spin.value - along
        turn = _Mean(-turn.value, turn.std, -turn.start)
        means = means | {"psi": turn}
        assumed = f" (else the spin makes {1 - slow:.2g} turns per row or more)" * bool(whole)
        notes.append(f"psi counts in the other direction: its sign was changed{assumed}")
    elif is_backwards and whole:
        more = math.copysign(whole, turn.value)
    turns = abs(rate + more) * recording.frame / (2 * math.pi)
    is_sure = not whole or (turns < _QUARTER and turn.value * (rate + more) > 0)
    if whole:
        notes.append(
            f"r0 is known only up to whole turns per row, multiples of {whole:.6g}"
            + "; C and the sign of r0 do not follow" * (not is_sure)
        )
    return recording, means, more, is_sure


def _derived(given: Known, whole: float, notes: list[str], *, is_sure: bool) -> dict[str, _Pair]:
    """Return r0, b/a = C r0/2mgs, and C, or C r0 if it is not sure, over unknown ones of m, g, s.

    Their standard deviations are propagated from those of means and known inputs.
    """
    least, most = _RATIOS
    is_moment_known, is_spin_known = (x in all_replaced(given) for x in ("A", "r0"))
    is_exact = is_moment_known and WEIGHT <= given.keys()
    unknown = [x for x in ("m", "s", "g") if x not in given]
    over = {0: "", 1: f"/{''.join(unknown)}"}.get(len(unknown), f"/({'*'.join(unknown)})")

    def numbers(v: Mapping[str, float]) -> tuple[dict[str, float], list[float]]:
        """Return the numbers, and the shares of the neglected term at both bounds of C/A."""
        along, turn = v.get("psi", 0.0) * math.cos(v["theta"]), v.get("psi", 0.0)
        if is_spin_known:
            found = {"r0": in_all_forms({**v, TILT: v["theta"], "psidot0": turn})["r0"]}
        else:
            found = {"r0": v["phi"] + along + whole}
        if not turn or not found["r0"]:
            return found, []
        moment = in_all_forms(v)["A"] if is_moment_known else 1.0
        ratios = [v["C"] / moment] * 2 if "C" in v and is_moment_known else [least, most]
        slowest = found["r0"]
        if not is_sure and "phi" in v:  # psi may count in the other direction
            slowest = math.copysign(min(abs(slowest), abs(v["phi"] - along)), slowest)
        ends = [along / (slowest * x) * (is_sure or x != most) for x in ratios]
        if is_exact:
            ends = []
            found["b/a"] = 1 / (2 * turn) + along * moment / (2 * v["m"] * v["g"] * v["s"])
        elif max(ends) > _MOST_BIAS:
            return found, ends
        else:
            found["b/a"] = sum(1 / (1 - x) for x in ends) / (4 * turn)
        product = 2 * found["b/a"] * math.prod(v[x] for x in "msg" if x in v)
        found[f"C{over}" if is_sure else f"C*r0{over}"] = product / (found["r0"] if is_sure else 1)
        return found, ends

    _, ends = numbers({name: x for name, (x, _) in given.items()})
    bias = 0.0
    if ends and max(ends) > _MOST_BIAS:
        notes.append("b/a is not determined: A Omega cos(theta) may be as large as C r0")
    elif ends and ends[0] != ends[1]:
        low, high = sorted(1 / (1 - x) for x in ends)
        bias = (high - low) / (high + low) / 1.75
        notes.append(
            f"b/a and C r0 include A Omega cos(theta) = {100 * min(ends):.2g} to "
            f"{100 * max(ends):.2g} % of C r0, for C/A from {most:g} to {least:g}: known A, m, g "
            "and s make them exact"
        )
    pairs = _propagated(lambda v: numbers(v)[0], given)
    return {
        key: (x, math.hypot(std, abs(x) * bias * (key != "r0"))) for key, (x, std) in pairs.items()
    }


def _propagated(
    numbers: Callable[[Mapping[str, float]], Mapping[str, float]], given: Known
) -> dict[str, _Pair]:
    """Return numbers of the given values, with standard deviations by linear propagation."""
    values = {name: x for name, (x, _) in given.items()}
    moved = [
        [numbers(values | {name: values[name] + sign * std}) for sign in (_SMALL, -_SMALL)]
        for name, (_, std) in given.items()
        if std
    ]
    return {
        key: (
            x,
            math.hypot(*((u.get(key, x) - w.get(key, x)) / 2 / _SMALL for u, w in moved)),
        )
        for key, x in numbers(values).items()
    }


def _spins(known: Known, means: Known, turn: float) -> dict[str, _Pair]:
    """Return the known inputs that give the spin, as the means show them.

    `means` has the tilt and the rates of psi and phi.  The visible spin is shifted by whole turns
    per row, if these are invisible, to be nearest to the known one.
    """
    found = dict[str, _Pair]()
    for name in (x for x in known if replaced_by(x) == "r0"):

        def seen(v: Mapping[str, float], name: str = name) -> dict[str, float]:
            start = {x: v[x] for x in (TILT, "psidot0")}
            rate = v["phi"] + v["psidot0"] * math.cos(v[TILT])
            wanted = in_all_forms(start | {name: known[name][0]})["r0"]
            rate += whole_turns(rate, wanted, turn)
            return {name: float(in_all_forms(start | {"r0": rate})[name])}

        found |= _propagated(seen, means)
    return found


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
