"""Fit of a recording without visible nutation: the mean precession, and the ratio b/a from it.

A fast top precesses almost steadily, by a quadratic equation for its rate Omega:

    a/2 - b Omega + Omega^2 cos(theta) = 0,

with a = 2mgs/A (4,4) and b = C r0/A (4,5).  If a is known, b follows.  Otherwise only their ratio
follows, by the elementary theory of fast tops, which omits the last term: b/a = C r0/2mgs = 1/(2
Omega).  This ratio is too small by the fraction cos(theta)/(4 lambda), with lambda = b^2/2a.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import DataError, LagtopError
from .harmonics import turning_rate
from .least_squares import Fit
from .parameters import KnownInputs, Parameters, known_torque
from .record import Outcome
from .recording import Recording

STEADY = ("theta0", "psidot0", "psi_zero", "phidot", "phi_zero")
"""The parameters of a steady precession: values of lines at the first row, and their rates."""


class _Line(NamedTuple):
    """A weighted straight line, or mean, through an angle."""

    factors: Array
    """The value at t = 0, and the rate of a line."""
    covariance: Array
    residuals: Array
    chi2: float


def steady_fit(recording: Recording, known: KnownInputs, where: str) -> Fit:
    """Fit a steady precession to a recording with psi; its tilt may be known instead of recorded.

    Standard deviations are estimated from the residuals by default.  Raises DataError if psi is
    constant.
    """
    lines = {
        name: _line(recording.t, recording.angles[name], _sigma(recording, name), name != "theta")
        for name in ("theta", "psi", "phi")
        if name in recording.angles
    }
    values, covariance = np.zeros(len(STEADY)), np.zeros((len(STEADY), len(STEADY)))
    for name, rows in (("theta", [0]), ("psi", [2, 1]), ("phi", [4, 3])):
        if name in lines:
            values[rows] = lines[name].factors
            covariance[np.ix_(rows, rows)] = lines[name].covariance
    values[0] = known.get("theta0", values[0])
    if not values[1]:
        raise DataError(f"{where}: psi must precess: its mean rate is 0")
    count = sum(int(np.isfinite(line.residuals).sum()) for line in lines.values())
    return Fit(
        [recording],
        SteadyParameters(known, [(name, 0) for name in STEADY], lines),
        values,
        covariance,
        sum(line.chi2 for line in lines.values()),
        count - sum(line.factors.size for line in lines.values()),
        [{name: line.residuals for name, line in lines.items()}],
    )


def _sigma(recording: Recording, name: str) -> Array | None:
    """Return the standard deviation of an angle; that of an axis is divided by sin(theta)."""
    sigma = recording.sigma
    if not sigma or name in sigma:
        return sigma.get(name)
    return sigma["across"] / np.sin(recording.angles["theta"]) if name == "psi" else sigma["along"]


def _line(t: Array, angle: Array, sigma: Array | None, is_line: bool) -> _Line:
    """Return the line through an angle, or its mean."""
    rate = turning_rate(t, angle) if is_line else 0.0
    known = np.isfinite(angle)
    around = np.unwrap(angle[known] - rate * t[known]) if is_line else angle[known]
    weights = np.ones(around.size) if sigma is None else 1 / sigma[known]
    basis = np.vander(t[known], 1 + is_line, increasing=True)
    weighted = basis * weights[:, np.newaxis]
    factors = np.linalg.lstsq(weighted, around * weights, rcond=None)[0]
    residuals = np.full(t.size, np.nan)
    residuals[known] = around - basis @ factors
    chi2 = float(np.nansum((residuals[known] * weights) ** 2))
    scale = 1.0 if sigma is not None else chi2 / (around.size - factors.size)
    covariance = np.asarray(np.linalg.inv(weighted.T @ weighted), dtype=np.float64) * scale
    whole: Array = factors + np.array([0.0, rate])[: factors.size]
    return _Line(whole, covariance, residuals, chi2)


@dataclass(frozen=True)
class SteadyParameters(Parameters):
    """The parameters of a steady precession, in the order of STEADY."""

    angles: Collection[str]
    """The angles that were recorded."""

    @property
    def spins(self) -> bool:
        """Whether r0 is determined."""
        return "r0" in self.labels

    @property
    def labels(self) -> list[str]:
        """The names of the quantities, with b if a is known, else b/a."""
        labels = ["b/a" if known_torque(self.known) is None else "b", "psidot0", "psi_zero"]
        labels += ["theta0"] if "theta" in self.angles else []
        if "phi" in self.angles:
            tilted = "theta" in self.angles or "theta0" in self.known
            labels += ["r0", "phi_zero"] if tilted else ["phi_zero"]
        return labels

    def quantities(self, values: Array, _: int) -> tuple[Array, Array]:
        """Return the quantities, and their derivatives by the parameters."""
        theta, rate, *_ = values.tolist()
        torque, sine, cosine = known_torque(self.known) or 0.0, math.sin(theta), math.cos(theta)
        r0 = values[3] + rate * cosine
        rows = {
            "b/a": (1 / (2 * rate), [0, -1 / (2 * rate**2), 0, 0, 0]),
            "b": (
                torque / (2 * rate) + rate * cosine,
                [-rate * sine, cosine - torque / (2 * rate**2), 0, 0, 0],
            ),
            "r0": (r0, [-rate * sine, cosine, 0, 1, 0]),
        }
        rows |= {x: (values[i], np.eye(len(STEADY))[i]) for i, x in enumerate(STEADY)}
        found, slopes = zip(*(rows[label] for label in self.labels), strict=True)
        return np.array(found), np.array(slopes)


class SteadyOutcome(Outcome):
    """The results of a fit of a steady precession."""

    derived = ()
    """Empty, because only b/a or b follows from the precession rate."""

    def notes(self) -> list[str]:
        """Return what the recording determines."""
        if "b" in self.shown:
            return ["the nutation is below the noise: b follows from a and the precession"]
        return [
            "the nutation is below the noise: a and b are known only as b/a = C r0/2mgs, by the "
            "elementary theory of fast tops, which is too small by cos(theta)/(4 lambda) of itself"
        ]

    def inputs(self, other: Mapping[str, float] | None = None) -> dict[str, float]:
        """Raise LagtopError, because many tops have this precession."""
        raise LagtopError(
            "a scene needs a and b, and this recording determines b/a only: use a format such as "
            "-o FILE.json"
        )

    def angles(self, t: Array) -> dict[str, Array]:
        """Return the angles of the steady precession, with the zeros of the recording."""
        theta, rate, psi_zero, spin, phi_zero = self.fit.values.tolist()
        return {"theta": theta + 0 * t, "psi": psi_zero + rate * t, "phi": phi_zero + spin * t}
