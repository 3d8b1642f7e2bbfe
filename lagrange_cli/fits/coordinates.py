"""Coordinates for the least squares, in which the parameters of a recording hardly correlate.

A small nutation about a steady precession with the rate Omega has the frequency omega of

    omega^2 = (b - 2 Omega cos(theta))^2 + (Omega sin(theta))^2.

The tilt determines omega, and the acceleration of the tilt at the first row, but not a, b and Omega
separately: these can change together along a curve, which a minimizer follows in many small steps.
On that curve omega and the acceleration are constant.  It has the coordinate chi, with

    tan(chi) = Omega sin(theta)/(b - 2 Omega cos(theta)).

In place of r0 stands phi' = r0 - Omega cos(theta), which the spin angle determines.  Every motion
has these coordinates, with the precession rate at the first row for Omega.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..arithmetic.types import Array

_NEEDED = {"a", "b", "theta0", "psidot0"}
_REACH = 3.0
"""Standard deviations at which uncertainties hold."""
_STEP = 1e-30
"""An imaginary step, which rounds nothing off a derivative."""


class Coordinates:
    """Coordinates of the parameters of one recording, which are known by their names.

    If a parameter that they need is missing, the parameters are their own coordinates.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self.names = names
        self.apply = set(names) >= _NEEDED

    def of(self, parameters: Array) -> Array:
        """Return the coordinates of parameters."""
        if not self.apply:
            return parameters
        value = self._named(parameters)
        a, b, rate = value["a"], value["b"], value["psidot0"]
        cosine, sine = np.cos(value["theta0"]), np.sin(value["theta0"])
        along, across = b - 2 * rate * cosine, rate * sine
        found = {
            "a": a - 2 * rate * (b - rate * cosine),
            "b": np.hypot(along, across),
            "psidot0": np.arctan2(across, along),
        }
        if "r0" in value:
            found["r0"] = value["r0"] - rate * cosine
        return np.array([*(value | found).values()])

    def parameters(self, coordinates: Array) -> Array:
        """Return the parameters at some coordinates, real or complex."""
        if not self.apply:
            return coordinates
        value = self._named(coordinates)
        push, omega, chi = value["a"], value["b"], value["psidot0"]
        cosine, sine = np.cos(value["theta0"]), np.sin(value["theta0"])
        rate = omega * np.sin(chi) / sine
        b = omega * np.cos(chi) + 2 * rate * cosine
        found = {"a": push + 2 * rate * (b - rate * cosine), "b": b, "psidot0": rate}
        if "r0" in value:
            found["r0"] = value["r0"] + rate * cosine
        return np.array([*(value | found).values()])

    def slopes(self, coordinates: Array) -> Array:
        """Return the derivatives of the parameters, a row each, by the coordinates."""
        steps = 1j * _STEP * np.eye(len(coordinates))
        rows = [np.imag(self.parameters(coordinates + step)) / _STEP for step in steps]
        return np.stack(rows, axis=-1)

    def covariance(self, coordinates: Array, spread: Array) -> Array:
        """Return the covariance of the parameters, from a spread S of coordinates.

        These have the covariance S S^T.  The parameters are taken three standard deviations away
        on both sides, along each column of S: where they bend, first order would be too small.
        """
        centre = self.parameters(coordinates)
        off = [
            (self.parameters(coordinates + way * column) - centre) / _REACH
            for column in spread.T
            for way in (_REACH, -_REACH)
        ]
        covariance: Array = np.einsum("ip,iq->pq", off, off) / 2
        return covariance

    def _named(self, values: Array) -> dict[str, Any]:
        return dict(zip(self.names, values, strict=True))
