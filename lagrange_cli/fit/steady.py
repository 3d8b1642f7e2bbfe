"""Recordings without visible nutation: the mean tilt and the mean rates of a steady precession.

A steady precession with the rate Omega keeps the tilt if a/2 = Omega (b - Omega cos(theta)).  Thus
b/a = 1/(2 Omega), the elementary theory, is too small by the fraction Omega cos(theta)/b, which is
cos(theta)/(4 lambda) with the stability factor lambda = b^2/(2a).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from .outcome import Outcome, Residuals
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


class _Line(NamedTuple):
    """A straight line through an angle, or the mean of the tilt; `leading` is the rate or mean."""

    leading: tuple[float, float]
    at: Callable[[Array], Array]
    residuals: Residuals

    @classmethod
    def through(cls, t: Array, y: Array, degree: int) -> _Line:
        """Return the line through the values of an angle."""
        middle = float(t.mean())
        factors, spread = np.polyfit(t - middle, y, degree, cov=True)

        def at(times: Array) -> Array:
            return np.asarray(np.polyval(factors, times - middle))

        leading = float(factors[0]), math.sqrt(spread[0, 0])
        return cls(leading, at, Residuals(t, y - at(t)))


def _lines(recording: Recording) -> dict[str, _Line]:
    found = {x: y.t * y.rate + y.y for x, y in signals_in(recording).items()}
    t = {x: recording.t[np.isfinite(y)] for x, y in recording.angles.items()}
    if "theta" in found:
        found["theta"] = recording.angles["theta"][np.isfinite(recording.angles["theta"])]
    return {x: _Line.through(t[x], y, int(x != "theta")) for x, y in found.items()}


def steady_outcome(
    recording: Recording, known: Known, *, oscillates: bool, radians: bool
) -> Outcome:
    """Return the result of a fit of a constant tilt and constant rates."""
    scale, unit = angle_unit(radians=radians)
    lines = _lines(recording)
    given = known.get("theta0", math.pi / 2), known.stds.get("theta0", 0.0)
    tilt, tilt_std = lines["theta"].leading if "theta" in lines else given
    (rate, rate_std), (spin, spin_std) = (
        lines[x].leading if x in lines else (0.0, 0.0) for x in ("psi", "phi")
    )
    cosine = math.cos(tilt)
    backwards = rate * (spin + rate * cosine) < 0 < -rate * (spin - rate * cosine)  # C/A < 0
    if recording.kind == "angles" and backwards:
        recording, rate = recording.mirrored, -rate
        lines = _lines(recording)
    numbers: _Numbers = {}
    notes = ["no nutation is visible: the numbers are means over the recording", *recording.notes]
    if "theta" in lines:
        numbers[f"mean_tilt_{unit}"] = tilt * scale, tilt_std * scale
    if "psi" in lines:
        numbers["mean_precession_rate"] = rate, rate_std
    r0 = known.get("r0", 0.0), known.stds.get("r0", 0.0)
    if "phi" in lines:
        numbers["mean_spin_rate"] = spin, spin_std
    if "phi" in lines and "r0" not in known:
        r0 = numbers["r0"] = spin + rate * cosine, math.hypot(spin_std, rate_std * cosine)
        turn = f"{2 * math.pi / recording.frame:.6g}"
        notes.append(f"r0 is known only up to whole turns per frame, multiples of {turn}")
    if rate and r0[0]:
        certain = {"A", "C"} <= known.keys()
        bias = abs(rate * cosine / r0[0]) / (known["C"] / known["A"] if certain else _RATIO)
        numbers |= _of_body(rate, math.hypot(rate_std / rate, bias), r0, known)
        assumed = "" if certain else f" if C/A = {_RATIO:g}"
        notes.append(
            f"b/a is too small by cos(theta)/(4 lambda), {100 * bias:.2g} %{assumed}, which its "
            "uncertainty contains"
        )
    residuals = {}
    for name, line in lines.items():
        whole = recording.kind != "angles"
        channel = {"psi": "across", "phi": "along"}.get(name, name) if whole else name
        size = math.sin(tilt) if channel == "across" else 1.0
        residuals[channel] = line.residuals._replace(y=line.residuals.y * size)
    dof = sum(x.y.size - 2 for x in residuals.values()) + ("theta" in lines)
    sigma = recording.sigma or {x: y.rms or 1.0 for x, y in residuals.items()}
    chi2 = sum(float(np.sum((y.y / sigma[x]) ** 2)) for x, y in residuals.items())

    def motion(t: Array) -> Array:
        some = [lines[x].at(t) if x in lines else 0 * t for x in ("phi", "psi")]
        return np.stack([np.full(t.shape, tilt), *some])

    return Outcome(
        recording,
        known,
        radians,
        numbers,
        {x: _MEANINGS.get(x.removesuffix(f"_{unit}"), "by the elementary theory") for x in numbers},
        residuals,
        dof,
        chi2 / dof,
        1 / float(recording.t[-1]),
        motion,
        [*_faults(recording, residuals, numbers, oscillates=oscillates)],
        notes,
    )


def _faults(
    recording: Recording,
    residuals: Mapping[str, Residuals],
    numbers: _Numbers,
    *,
    oscillates: bool,
) -> Iterator[str]:
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
    if "theta" in residuals and residuals["theta"].rms > _MOST_TILT and not recording.sigma:
        off = math.degrees(residuals["theta"].rms)
        yield f"the tilt varies by {off:.2g} degrees: give --sigma if this is noise"
    elif recording.t.size < _LEAST_ROWS and not recording.sigma:
        yield f"{recording.t.size} rows are too few to tell nutation from noise: give --sigma"


def _of_body(rate: float, spread: float, r0: tuple[float, float], known: Known) -> _Numbers:
    """Return numbers of the body; `spread` is the relative uncertainty of the rate, with bias."""
    half, unknown = 1 / (2 * rate), [x for x in ("m", "s", "g") if x not in known]
    found = {"b/a": (half, abs(half) * spread)}
    if "C" not in known:
        value = 2 * half / r0[0] * math.prod(known[x] for x in "msg" if x in known)
        over = {0: "", 1: f"/{''.join(unknown)}"}.get(len(unknown), f"/({'*'.join(unknown)})")
        found[f"C{over}"] = value, abs(value) * math.hypot(spread, r0[1] / r0[0])
    return found
