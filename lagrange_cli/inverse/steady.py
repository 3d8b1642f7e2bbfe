"""Recordings without visible nutation: the mean tilt and the mean rates of a steady precession.

A steady precession with the rate Omega keeps the tilt if m g s = Omega (C r0 - A Omega cos(theta)).
Elementary theory neglects the last term: C r0 = m g s/Omega is too small by the fraction
x = A Omega cos(theta)/(C r0), whose sign is known, and whose size depends on C/A.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from .checks import CHANCE, Residuals
from .known import WEIGHT, Known
from .outcome import Number, Outcome
from .recording import Recording
from .signals import Signal

_MOST_TILT, _LEAST_ROWS = 0.04, 30
"""Largest scatter of the tilt in radians that counts as noise, and the least number of rows that
shows a nutation, if sigma is not given."""
_LEAST_RATIO, _MOST_RATIO, _MOST_BIAS = 0.05, 2.0, 0.8
"""C/A in the bounds of the neglected term if it is not known, and the largest such term."""
_SURE, _CONTRADICTS, _QUARTER = 4.0, 3.0, 0.25
"""Standard deviations of a rate that is not 0, those of a contradiction, and turns per row below
which the spin tells the direction of psi."""
_MEANINGS = {
    "mean_tilt": "mean tilt",
    "mean_precession_rate": "mean precession rate",
    "mean_spin_rate": "mean spin rate phi'",
    "r0": "total spin rate, from the means",
    "b/a": "C r0/2mgs",
}
_Pair = tuple[float, float]


class _Mean(NamedTuple):
    """The mean of the tilt, or the mean rate of another angle, and the angle in the first row."""

    value: float
    std: float
    start: float


_NONE = _Mean(0.0, 0.0, 0.0)


def _mean(
    signal: Signal, name: str, recording: Recording, step: float, sigma: float | None
) -> _Mean:
    """Return the mean tilt, or the slope of a straight line through spin or precession.

    The noise is at least that of the steps between values; an angle that never leaves a step is
    known to the size of the step.
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
    if rest.rms < step / 5:
        std = step / math.sqrt(12) * (1 if is_tilt else 1 / float(signal.t[-1]))
    return _Mean(float(factors[0]), std, float(np.polyval(factors, -middle)))


def steady_outcome(
    recording: Recording,
    known: Known,
    signals: Mapping[str, Signal],
    noise: Mapping[str, _Pair],
    frequency: float,
    *,
    radians: bool,
) -> Outcome:
    """Return the result of a fit of a constant tilt and constant rates.

    The `noise` of the channels is that of `Outcome`, `frequency` that of a nutation to look for.
    """
    scale, unit = angle_unit(radians=radians)
    alias = {"theta": "theta", "psi": "across", "phi": "along"}
    sigma = recording.sigma
    means = {
        x: _mean(y, x, recording, noise.get(x, (0.0, 0.0))[0], sigma.get(x) or sigma.get(alias[x]))
        for x, y in signals.items()
    }
    tilt = means.get("theta") or (_Mean(*known["theta0"], 0.0) if "theta0" in known else None)
    notes = ["no nutation is visible: the numbers are means over the recording"]
    turn, spin = means.get("psi", _NONE), means.get("phi", _NONE)
    r0, is_sure = known.get("r0"), "r0" in known
    if "phi" in means and tilt:
        recording, turn, rate, slow = _spin(recording, tilt, turn, spin, notes)
        r0, is_sure = r0 or rate, is_sure or slow
    elif "phi" in means:
        notes.append("without the tilt neither r0 nor C follows: give theta0")
    means |= {"psi": turn} if "psi" in means else {}
    numbers: dict[str, Number] = {}
    for name, key, size in (
        ("theta", f"mean_tilt_{unit}", scale),
        ("psi", "mean_precession_rate", 1.0),
        ("phi", "mean_spin_rate", 1.0),
    ):
        if name in means:
            numbers[key] = _number(key.removesuffix(f"_{unit}"), means[name][:2], size)
    if r0 and "r0" not in known:
        numbers["r0"] = _number("r0", r0)
    ratio, contradictions, distances = None, list[str](), dict[str, float]()
    if turn.value and r0 and tilt and r0[0]:
        ratio, text = _ratio(turn, tilt, r0, known, is_sure=is_sure)
        notes += [text] * bool(text)
    if ratio and r0:
        numbers["b/a"] = _number("b/a", ratio)
        key, body = _body(ratio, r0, known, is_sure=is_sure)
        if key in known:
            found, contradictions, distances = _compared(body, known)
            notes += found
        else:
            numbers[key] = _number(key, body)
    motion_tilt = (tilt or _Mean(math.pi / 2, 0.0, 0.0)).value

    def motion(t: Array) -> Array:
        lines = [x.start + x.value * t for x in (spin, turn)]
        return np.stack([np.full(t.shape, motion_tilt), *lines])

    result = Outcome(
        recording=recording,
        known=known,
        radians=radians,
        numbers=numbers,
        motion=motion,
        parameters=2 * len(means) - ("theta" in means),
        frequency=1 / float(recording.t[-1]),
        noise=noise,
        contradictions=contradictions,
        notes=notes,
        distances=distances,
    )
    result.faults += _faults(recording, turn, r0, result, frequency)
    return result


def _number(key: str, pair: _Pair, scale: float = 1.0) -> Number:
    value, std = pair[0] * scale, pair[1] * scale
    return Number(value, std, _MEANINGS.get(key, "from the mean rates"), std)


def _spin(
    recording: Recording, tilt: _Mean, turn: _Mean, spin: _Mean, notes: list[str]
) -> tuple[Recording, _Mean, _Pair, bool]:
    """Return the recording and psi' in the direction of the spin, r0, and if both are sure.

    Whole turns per row are invisible.  If psi' and r0 have opposite signs, either psi counts in the
    other direction, if the spin is slow, or the spin is faster.
    """
    whole = 2 * math.pi / recording.frame if recording.is_even else 0.0
    along = turn.value * math.cos(tilt.value)
    rate, slow = spin.value + along, abs(spin.value - along) * recording.frame / (2 * math.pi)
    is_backwards = turn.value * rate < 0 < turn.value * (along - spin.value)  # C/A < 0
    if recording.kind == "angles" and is_backwards and (slow < _QUARTER or not whole):
        recording, rate = recording.mirrored, spin.value - along
        turn = _Mean(-turn.value, turn.std, -turn.start)
        assumed = f" (else the spin makes {1 - slow:.2g} turns per row or more)" * bool(whole)
        notes.append(f"psi counts in the other direction: its sign was changed{assumed}")
    elif is_backwards and whole:
        rate += math.copysign(whole, turn.value)
    turns = abs(rate) * recording.frame / (2 * math.pi)
    is_sure = not whole or (turns < _QUARTER and turn.value * rate > 0)
    if whole:
        notes.append(
            f"r0 is known only up to whole turns per row, multiples of {whole:.6g}"
            + "; C and the sign of r0 do not follow" * (not is_sure)
        )
    parts = turn.std * math.cos(tilt.value), turn.value * math.sin(tilt.value) * tilt.std
    return recording, turn, (rate, math.hypot(spin.std, *parts)), is_sure


def _ratio(
    turn: _Mean, tilt: _Mean, r0: _Pair, known: Known, *, is_sure: bool
) -> tuple[_Pair | None, str]:
    """Return b/a = C r0/2mgs with its standard deviation, and a note on the neglected term."""
    half, rate = 1 / (2 * turn.value), turn.value
    along = rate * math.cos(tilt.value)
    moment = _moment(known)
    spread = turn.std / abs(rate)
    if moment and WEIGHT <= known.keys():
        torque = 2 * math.prod(known[x][0] for x in WEIGHT) / moment[0]
        value = half + along / torque
        parts = [abs(half - along / torque) * spread, abs(along / torque) * _of_weight(known)]
        parts += [abs(rate * math.sin(tilt.value) / torque) * tilt.std]
        parts += [abs(along / torque) * moment[1] / moment[0]]
        return (value, math.hypot(*parts)), ""
    least, most = (
        (x := known["C"][0] / moment[0], x)
        if moment and "C" in known
        else (_LEAST_RATIO, _MOST_RATIO)
    )
    ends = [along / (r0[0] * least), along / (r0[0] * most) if is_sure else 0.0]
    if max(ends) > _MOST_BIAS:
        return None, "b/a is not determined: A Omega cos(theta) may be as large as C r0"
    values = [half / (1 - x) for x in ends]
    value, bias = sum(values) / 2, abs(values[0] - values[1]) / 3.5
    text = ""
    if least != most:
        text = (
            f"b/a and C r0 include A Omega cos(theta) = {100 * min(ends):.2g} to "
            f"{100 * max(ends):.2g} % of C r0, for C/A from {most:g} to {least:g}: known A, m, g "
            "and s make them exact"
        )
    return (value, math.hypot(abs(value) * spread, bias)), text


def _moment(known: Known) -> _Pair | None:
    """Return the known A, from A_cm if need be."""
    if "A_cm" in known:
        (m, m_std), (s, s_std), (own, std) = known["m"], known["s"], known["A_cm"]
        return own + m * s * s, math.hypot(std, m_std * s * s, 2 * m * s * s_std)
    return known.get("A")


def _of_weight(known: Known) -> float:
    """Return the relative standard deviation of the product of the known ones of m, g and s."""
    return math.hypot(0.0, *(known[x][1] / known[x][0] for x in WEIGHT & known.keys()))


def _body(ratio: _Pair, r0: _Pair, known: Known, *, is_sure: bool) -> tuple[str, _Pair]:
    """Return C, or C r0 if whole turns may hide in r0, over the unknown ones of m, g and s."""
    unknown = [x for x in ("m", "s", "g") if x not in known]
    value = 2 * ratio[0] * math.prod(known[x][0] for x in "msg" if x in known)
    spread = math.hypot(ratio[1] / ratio[0], _of_weight(known))
    over = {0: "", 1: f"/{''.join(unknown)}"}.get(len(unknown), f"/({'*'.join(unknown)})")
    if not is_sure:
        return f"C*r0{over}", (value, abs(value) * spread)
    spread = math.hypot(spread, r0[1] / r0[0])
    return f"C{over}", (value / r0[0], abs(value / r0[0]) * spread)


def _compared(body: _Pair, known: Known) -> tuple[list[str], list[str], dict[str, float]]:
    """Return notes, contradictions and the distance of the known C from that of the recording."""
    (given, std), (value, spread) = known["C"], body
    far = abs(given - value) / max(math.hypot(std, spread), 1e-9 * abs(value))
    shown = f"known C = {Number(given, std, '')}", f"which gives {Number(value, spread, '')}"
    if far <= _CONTRADICTS:
        note = f"{shown[0]} agrees with the recording, {shown[1]}: {far:.1f} sigma"
        return [note], [], {"C": far}
    text = f"{shown[0]} contradicts the recording, {shown[1]}, {far:.3g} sigma apart: omit C, or"
    return [], [f"{text} check m, s, g and r0"], {"C": far}


def _faults(
    recording: Recording, turn: _Mean, r0: _Pair | None, result: Outcome, frequency: float
) -> list[str]:
    """Return why the motion is no steady precession, besides the residuals."""
    found = []
    for rest in result.residuals.values():
        if not rest.is_coarse and rest.structure(frequency) < CHANCE / 10:
            found.append("the motion is no steady precession: the angles oscillate")
            break
    if "psi" not in recording.angles:
        found.append("no nutation is visible, and without psi no precession rate")
    elif not abs(turn.value) > _SURE * turn.std:
        found.append("no nutation is visible, and the precession rate is not determined")
    elif r0 and turn.value * r0[0] < 0 and (recording.kind == "attitude" or "r0" in result.known):
        found.append("C/A < 0 is impossible: spin and precession have opposite signs")
    scatter = float(np.nanstd(recording.angles.get("theta", np.zeros(1))))
    if scatter > _MOST_TILT and not recording.sigma:
        off = math.degrees(scatter)
        found.append(f"the tilt varies by {off:.2g} degrees: give sigma if this is noise")
    elif recording.t.size < _LEAST_ROWS and not recording.sigma:
        found.append(f"{recording.t.size} rows are too few to tell nutation from noise: give sigma")
    return found
