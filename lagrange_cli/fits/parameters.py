"""The parameters of a fit: the unknowns of the body and of the starts, and what follows from them.

The body is the same in all recordings of a fit: a, and C/A if it ties b to r0.  It does so if it is
known, or if several recordings show their spin.  Each recording has its own start, b or r0 or both,
and zeros of psi and phi.

Coordinates for the least squares, in which the parameters of a recording hardly correlate.

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

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.measured import moment
from ..inputs.names import check_names
from ..inputs.top import Top
from .model import STATE
from .recording import Recording

FIT_QUANTITIES = (*STATE, "r0", "psi_zero", "phi_zero")
"""The quantities that a recording depends on, the state first."""
_START = ("theta0", "thetadot0", "psidot0")
_A, _B, _R0 = (FIT_QUANTITIES.index(name) for name in ("a", "b", "r0"))

STEADY = ("theta0", "psidot0", "psi_zero", "phidot", "phi_zero")
"""The parameters of a steady precession: values of lines at the first row, and their rates."""

Name = tuple[str, int]
"""A parameter, and the number of its recording; -1 for one of the body."""
_INSTEAD = ("A_cm", "phidot0")
_NOT_ZERO = ("s", "g", "r0")
"""Inputs that are factors of a product: if one is 0, nothing else of it is determined."""
_NEEDED = {"a", "b", "theta0", "psidot0"}
_REACH = 3.0
"""Standard deviations at which uncertainties hold."""
_STEP = 1e-30
"""An imaginary step, which rounds nothing off a derivative."""


class Parameters(NamedTuple):
    """The parameters of a fit of some recordings, and the inputs that are known."""

    known: Mapping[str, float]
    """Inputs by key, theta0 in radians."""
    names: Sequence[Name]

    def quantities(self, values: Array, i: int) -> tuple[Array, Array]:
        """Return the quantities of recording i, and their derivatives by the parameters.

        They are of shape (8,) and (8, parameters), in the order of FIT_QUANTITIES.
        """
        found = np.zeros(len(FIT_QUANTITIES))
        slopes = np.zeros((len(FIT_QUANTITIES), len(values)))
        for row, name in enumerate(FIT_QUANTITIES):
            if name in self.known:
                found[row] = self.known[name]
            for key in ((name, -1), (name, i)):
                if key in self.names:
                    column = self.names.index(key)
                    found[row], slopes[row, column] = values[column], 1.0
        known_a = known_torque(self.known)
        if known_a is not None:
            found[_A] = known_a
        if self.tied:
            ratio, of_ratio = self._ratio(values, found[_A], slopes[_A])
            found[_B] = ratio * found[_R0]
            slopes[_B] = ratio * slopes[_R0] + found[_R0] * of_ratio
        return found, slopes

    @property
    def labels(self) -> Sequence[str]:
        """The names of the quantities."""
        return FIT_QUANTITIES

    @property
    def tied(self) -> bool:
        """Whether b follows from r0 by C/A."""
        return ("b", 0) not in self.names

    @property
    def spins(self) -> bool:
        """Whether r0 is in play, beside b."""
        return "r0" in self.known or ("r0", 0) in self.names

    def _ratio(self, values: Array, a: float, of_a: Array) -> tuple[float, Array]:
        """Return C/A and its derivatives: a parameter, known, or C a/(2mgs)."""
        if ("ratio", -1) in self.names:
            column = self.names.index(("ratio", -1))
            return float(values[column]), np.eye(len(values))[column]
        weight = _weight(self.known)
        if "A" in self.known:
            return self.known["C"] / self.known["A"], np.zeros(len(values))
        assert weight is not None
        return self.known["C"] * a / (2 * weight), self.known["C"] / (2 * weight) * of_a


class SteadyParameters(NamedTuple):
    """The parameters of a steady precession, in the order of STEADY."""

    known: Mapping[str, float]
    angles: Collection[str]
    """The angles that were recorded."""

    @property
    def spins(self) -> bool:
        """Whether r0 is determined."""
        return "r0" in self.labels

    @property
    def labels(self) -> list[str]:
        """The quantities that follow: b if a is known, else b/a."""
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


def parameters_of(known: Mapping[str, float], recordings: Sequence[Recording]) -> Parameters:
    """Return the parameters of a fit."""
    names: list[Name] = []
    if known_torque(known) is None:
        names.append(("a", -1))
    ratio_known = "C" in known and ("A" in known or _weight(known) is not None)
    seen = any("phi" in recording.angles for recording in recordings)
    spins = seen or ratio_known or "r0" in known
    tied = spins and (ratio_known or len(recordings) > 1)
    if tied and not ratio_known:
        names.append(("ratio", -1))
    for i, recording in enumerate(recordings):
        if not tied:
            names.append(("b", i))
        if spins and "r0" not in known:
            names.append(("r0", i))
        names += [(name, i) for name in _START if name not in known]
        names += [(f"{x}_zero", i) for x in ("psi", "phi") if x in recording.angles]
    return Parameters(dict(known), names)


def _weight(known: Mapping[str, float]) -> float | None:
    """Return the product m g s where all of it is known."""
    if {"m", "g", "s"} <= known.keys():
        return known["m"] * known["g"] * known["s"]
    return None


def known_torque(known: Mapping[str, float]) -> float | None:
    """Return a = 2mgs/A (4,4) where all of it is known."""
    weight = _weight(known)
    return None if weight is None or "A" not in known else 2 * weight / known["A"]


def known_inputs(given: Mapping[str, Any]) -> dict[str, float]:
    """Return inputs that are known, by key of `Top`, with A for A_cm and theta0 in radians.

    Raises LagtopError for one that no top has, that a fit cannot use, or that needs others.
    """
    check_names("known", [*given] or ["m"], [*Top.fields, *_INSTEAD])
    known = {name: float(x) for name, x in given.items()}
    if "phidot0" in known:
        raise LagtopError("phidot0 is no input of a fit: give r0", "phidot0")
    if "A_cm" in known and not {"m", "s"} <= known.keys():
        raise LagtopError("A_cm must be given with m and s, as A = A_cm + m s^2", "A_cm")
    for name in _NOT_ZERO:
        if known.get(name) == 0:
            raise LagtopError(f"{name} must not be 0 in a fit: leave it out", name)
    _guard(known)
    if "A_cm" in known:
        known["A"] = float(moment(known))
        del known["A_cm"]
    for key, unit in (("theta0_deg", math.pi / 180), ("theta0_rad", 1.0)):
        if key in known:
            known["theta0"] = known.pop(key) * unit
    return known


def _guard(known: Mapping[str, float]) -> None:
    """Raise LagtopError for inputs that no top has."""
    moment = known.get("A", known.get("A_cm", known.get("C", 1.0)))
    others = {"m": 1.0, "s": 1.0, "g": 1.0, "C": moment}
    others |= {} if "A_cm" in known else {"A": moment}
    Top(**others | dict(known))


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
