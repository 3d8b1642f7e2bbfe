"""Recordings without visible nutation: the mean tilt and the mean rates of a steady precession.

A steady precession with the rate Omega keeps the tilt if a/2 = Omega (b - Omega cos(theta)).  Thus
b/a = 1/(2 Omega), the elementary theory, is too small by the fraction Omega cos(theta)/b, which is
cos(theta)/(4 lambda) with the stability factor lambda = b^2/(2a).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from .outcome import Outcome
from .recording import Known, Recording
from .starts import signals_in

_MOST_TILT, _LEAST_ROWS = 0.04, 30
"""Largest scatter of the tilt in radians that counts as noise, and the least number of rows that
shows a nutation, if sigma is not given."""
_RATIO = 0.5
"""C/A in the estimate of the bias, if A and C are not known."""
_SURE = 4.0
_MEANINGS = {
    "mean_tilt": "mean tilt",
    "mean_precession_rate": "mean precession rate",
    "mean_spin_rate": "mean spin rate phi'",
    "r0": "total spin rate, from the means",
    "b/a": "C r0/2mgs, by the elementary theory",
}
_Numbers = dict[str, tuple[float, float]]


class _Mean(NamedTuple):
    """The mean of the tilt, or the mean rate of another angle, and the angle in the first row."""

    value: float
    std: float
    start: float


def _means(recording: Recording) -> dict[str, _Mean]:
    """Return the mean tilt, and the slopes of straight lines through spin and precession."""
    found = {}
    for name, signal in signals_in(recording).items():
        is_tilt, middle = name == "theta", signal.t.mean()
        y = np.arccos(signal.y) if is_tilt else signal.y + signal.rate * signal.t
        factors, spread = np.polyfit(signal.t - middle, y, 0 if is_tilt else 1, cov=True)
        start = float(np.polyval(factors, -middle))
        found[name] = _Mean(float(factors[0]), math.sqrt(spread[0, 0]), start)
    return found


def steady_outcome(
    recording: Recording, known: Known, *, oscillates: bool, radians: bool
) -> Outcome:
    """Return the result of a fit of a constant tilt and constant rates."""
    scale, unit = angle_unit(radians=radians)
    means, none = _means(recording), _Mean(0.0, 0.0, 0.0)
    tilt = means.get("theta", _Mean(*known.get("theta0", (math.pi / 2, 0.0)), 0.0))
    turn, spin = means.get("psi", none), means.get("phi", none)
    along = turn.value * math.cos(tilt.value)
    backwards = turn.value * (spin.value + along) < 0 < turn.value * (along - spin.value)  # C/A < 0
    if recording.kind == "angles" and backwards:
        recording, along = recording.mirrored, -along
        turn = _Mean(-turn.value, turn.std, -turn.start)
    numbers: _Numbers = {}
    for name, key, (value, std, _), size in (
        ("theta", f"mean_tilt_{unit}", tilt, scale),
        ("psi", "mean_precession_rate", turn, 1.0),
        ("phi", "mean_spin_rate", spin, 1.0),
    ):
        if name in means:
            numbers[key] = value * size, std * size
    notes = ["no nutation is visible: the numbers are means over the recording", *recording.notes]
    r0 = known.get("r0", (0.0, 0.0))
    if "phi" in means and "r0" not in known:
        r0_std = math.hypot(spin.std, turn.std * math.cos(tilt.value))
        r0 = numbers["r0"] = spin.value + along, r0_std
        turns = f"{2 * math.pi / recording.frame:.6g}"
        notes.append(f"r0 is known only up to whole turns per frame, multiples of {turns}")
    if turn.value and r0[0]:
        certain = {"A", "C"} <= known.keys()
        ratio = known["C"][0] / known["A"][0] if certain else _RATIO
        bias = abs(along / r0[0]) / ratio
        numbers |= _of_body(turn.value, math.hypot(turn.std / turn.value, bias), r0, known)
        assumed = "" if certain else f" if C/A = {_RATIO:g}"
        notes.append(
            f"b/a is too small by cos(theta)/(4 lambda), {100 * bias:.2g} %{assumed}, which its "
            "uncertainty contains"
        )

    def motion(t: Array) -> Array:
        lines = [x.start + x.value * t for x in (spin, turn)]
        return np.stack([np.full(t.shape, tilt.value), *lines])

    return Outcome(
        recording,
        known,
        radians,
        numbers,
        {x: _MEANINGS.get(x.removesuffix(f"_{unit}"), "by the elementary theory") for x in numbers},
        motion,
        2 * len(means) - ("theta" in means),
        1 / float(recording.t[-1]),
        [*_faults(recording, numbers, oscillates=oscillates)],
        notes,
    )


def _faults(recording: Recording, numbers: _Numbers, *, oscillates: bool) -> Iterator[str]:
    """Yield why the motion is no steady precession, besides the residuals."""
    rate, std = numbers.get("mean_precession_rate", (0.0, 0.0))
    if oscillates:
        yield "the motion is no steady precession: the angles oscillate"
    if "psi" not in recording.angles:
        yield "no nutation is visible, and without psi no precession rate"
    elif not abs(rate) > _SURE * std:
        yield "no nutation is visible, and the precession rate is not determined"
    elif "r0" in numbers and rate * numbers["r0"][0] < 0:
        yield "C/A < 0 is impossible: spin and precession have opposite signs"
    scatter = float(np.nanstd(recording.angles.get("theta", 0.0)))
    if scatter > _MOST_TILT and not recording.sigma:
        off = math.degrees(scatter)
        yield f"the tilt varies by {off:.2g} degrees: give --sigma if this is noise"
    elif recording.t.size < _LEAST_ROWS and not recording.sigma:
        yield f"{recording.t.size} rows are too few to tell nutation from noise: give --sigma"


def _of_body(rate: float, spread: float, r0: tuple[float, float], known: Known) -> _Numbers:
    """Return numbers of the body; `spread` is the relative uncertainty of the rate, with bias."""
    half, unknown = 1 / (2 * rate), [x for x in ("m", "s", "g") if x not in known]
    found = {"b/a": (half, abs(half) * spread)}
    if "C" not in known:
        value = 2 * half / r0[0] * math.prod(known[x][0] for x in "msg" if x in known)
        over = {0: "", 1: f"/{''.join(unknown)}"}.get(len(unknown), f"/({'*'.join(unknown)})")
        found[f"C{over}"] = value, abs(value) * math.hypot(spread, r0[1] / r0[0])
    return found
