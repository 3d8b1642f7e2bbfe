"""Recordings without visible nutation: the mean tilt and the mean rates of a steady precession.

A steady precession with the rate Omega keeps the tilt if a/2 = Omega (b - Omega cos(theta)).  Thus
b/a = 1/(2 Omega), the elementary theory, is too small by the fraction Omega cos(theta)/b, which is
cos(theta)/(4 lambda) with the stability factor lambda = b^2/(2a).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from .noise import Residuals
from .outcome import Outcome
from .problem import Known
from .recording import Recording
from .starts import Oscillation, Signal, signals_in

_MOST_TILT = 0.1
"""Largest scatter of the tilt in radians that counts as noise if sigma is not given."""
_RATIO = 0.5
"""C/A in the estimate of the bias, if A and C are not known."""
_SURE = 4.0
_MEANINGS = {
    "mean_tilt": "mean tilt",
    "mean_precession_rate": "mean precession rate",
    "mean_spin_rate": "mean spin rate phi'",
    "r0": "total spin rate, from the means",
    "b/a": "C r0/2mgs, by the elementary theory",
    "b": "C r0/A (4,5)",
}


class _Line(NamedTuple):
    """A straight line through an angle, or the mean of the tilt."""

    middle: float
    mean: float
    mean_std: float
    rate: float
    rate_std: float
    residuals: Residuals

    @classmethod
    def through(cls, name: str, signal: Signal, tilt: Array) -> _Line:
        """Return the line of a signal; `tilt` replaces its values for theta."""
        t, grows = signal.t, name != "theta"
        y = signal.y + signal.rate * t if grows else tilt[np.isfinite(tilt)]
        around = t - t.mean()
        rate = float(around @ y) / float(around @ around) if grows else 0.0
        rest = y - y.mean() - rate * around
        noise = math.sqrt(float(rest @ rest) / max(t.size - 1 - grows, 1))
        std = noise / math.sqrt(float(around @ around)) if grows else 0.0
        mean_std = noise / math.sqrt(t.size)
        return cls(float(t.mean()), float(y.mean()), mean_std, rate, std, Residuals(t, rest))

    def mirrored(self) -> _Line:
        """Return the line of the angle counted in the other direction."""
        rest = self.residuals._replace(y=-self.residuals.y)
        return self._replace(mean=-self.mean, rate=-self.rate, residuals=rest)

    def at(self, t: Array) -> Array:
        """Return the line at some times."""
        return self.mean + self.rate * (t - self.middle)


def steady_outcome(
    recording: Recording, known: Known, oscillation: Oscillation, *, radians: bool
) -> Outcome:
    """Return the result of a fit of a constant tilt and constant rates."""
    scale, unit = angle_unit(radians=radians)
    tilts = recording.angles.get("theta", np.zeros(0))
    lines = {x: _Line.through(x, y, tilts) for x, y in signals_in(recording).items()}
    tilt, tilt_std = known.get("theta0", math.pi / 2), known.stds.get("theta0", 0.0)
    if "theta" in lines:
        tilt, tilt_std = lines["theta"].mean, lines["theta"].mean_std
    psi, spin, cosine = lines.get("psi"), lines.get("phi"), math.cos(tilt)
    if recording.kind == "angles" and psi and spin:
        spins = [spin.rate + sign * psi.rate * cosine for sign in (1, -1)]
        if psi.rate * spins[0] < 0 < -psi.rate * spins[1]:  # C/A > 0
            recording, psi = recording.mirrored, psi.mirrored()
            lines["psi"] = psi
    numbers: dict[str, tuple[float, float]] = {}
    notes = ["no nutation is visible: the numbers are means over the recording"]
    if "theta" in lines:
        numbers[f"mean_tilt_{unit}"] = tilt * scale, tilt_std * scale
    if psi:
        numbers["mean_precession_rate"] = psi.rate, psi.rate_std
        r0 = (known["r0"], known.stds.get("r0", 0.0)) if "r0" in known else None
        if spin:
            numbers["mean_spin_rate"] = spin.rate, spin.rate_std
            if r0 is None:
                std = math.hypot(spin.rate_std, psi.rate_std * cosine)
                r0 = numbers["r0"] = spin.rate + psi.rate * cosine, std
        more, bias = _of_body(psi, cosine, r0, known)
        numbers |= more
        if recording.is_mirrored:
            notes.append("psi counts in the other direction: its sign was changed")
        notes += [bias] if bias else []
    whole = recording.kind != "angles"
    alias = {"psi": "across", "phi": "along"} if whole else {}
    residuals = {}
    for name, line in lines.items():
        size = math.sin(tilt) if whole and name == "psi" else 1.0
        residuals[alias.get(name, name)] = line.residuals._replace(y=line.residuals.y * size)
    dof = sum(x.residuals.y.size - 2 + (y == "theta") for y, x in lines.items())
    sigma = recording.sigma or {x: y.rms or 1.0 for x, y in residuals.items()}
    chi2 = sum(float(np.sum((y.y / sigma[x]) ** 2)) for x, y in residuals.items())
    flat = _Line(0.0, 0.0, 0.0, 0.0, 0.0, Residuals(recording.t, recording.t))
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
        lambda t: np.stack(
            [np.full(t.shape, tilt), lines.get("phi", flat).at(t), lines.get("psi", flat).at(t)]
        ),
        _faults(lines, numbers, oscillation, bool(recording.sigma), radians=radians),
        notes,
    )


def _faults(
    lines: dict[str, _Line],
    numbers: dict[str, tuple[float, float]],
    oscillation: Oscillation,
    has_sigma: bool,
    *,
    radians: bool,
) -> list[str]:
    """Return why the motion is no steady precession, besides the residuals."""
    found, (scale, unit) = [], angle_unit(radians=radians)
    psi, tilt = lines.get("psi"), lines.get("theta")
    if oscillation.is_visible:
        found.append("the motion is no steady precession: the angles oscillate")
    if psi is None:
        found.append("no nutation is visible, and without psi no precession rate")
    elif not abs(psi.rate) > _SURE * psi.rate_std:
        found.append("no nutation is visible, and the precession rate is not determined")
    elif "r0" in numbers and psi.rate * numbers["r0"][0] < 0:
        found.append("C/A < 0 is impossible: spin and precession have opposite signs")
    if tilt and tilt.residuals.rms > _MOST_TILT and not has_sigma:
        off = f"{tilt.residuals.rms * scale:.2g} {unit}"
        found.append(f"the tilt varies by {off}: give --sigma if this is noise")
    return found


def _of_body(
    psi: _Line, cosine: float, r0: tuple[float, float] | None, known: Known
) -> tuple[dict[str, tuple[float, float]], str]:
    """Return numbers of the body, and a note on the bias that their uncertainties contain."""
    rate, relative = psi.rate, psi.rate_std / abs(psi.rate)
    if {"m", "g", "s", "A"} <= known.keys():
        b = known["m"] * known["g"] * known["s"] / known["A"] / rate + rate * cosine
        spread = math.hypot(relative, *(known.stds.get(x, 0.0) / known[x] for x in "mgsA"))
        found = {"b": (b, abs(b) * spread)}
        if r0 and "C" not in known:
            polar, std = b / r0[0] * known["A"], math.hypot(spread, r0[1] / r0[0])
            found["C"] = polar, abs(polar) * std
        return found, ""
    if r0 is None:
        return {}, ""
    given = {"A", "C"} <= known.keys()
    ratio = known["C"] / known["A"] if given else _RATIO
    bias = abs(rate * cosine / (ratio * r0[0]))
    half, spread = 1 / (2 * rate), math.hypot(relative, bias)
    found = {"b/a": (half, abs(half) * spread)}
    if "C" not in known:
        unknown = [x for x in "mgs" if x not in known]
        value = 2 * half / r0[0] * math.prod(known[x] for x in "mgs" if x in known)
        over = {0: "", 1: f"/{''.join(unknown)}"}.get(len(unknown), f"/({'*'.join(unknown)})")
        found[f"C{over}"] = value, abs(value) * math.hypot(spread, r0[1] / r0[0])
    assumed = "" if given else f" if C/A = {_RATIO:g}"
    return found, (
        f"b/a is too small by cos(theta)/(4 lambda), {100 * bias:.2g} %{assumed}, which its "
        "uncertainty contains"
    )
