"""The parameters of a fit: the unknowns of the body and of the starts, and quantities from them.

All recordings share a and, if it is known or several recordings have their spin, C/A = b/r0.  Each
recording has its own start, zeros, and b or r0 or both.

In the coordinates for the least squares the parameters of a recording hardly correlate.  A small
nutation about a steady precession with the rate Omega has the frequency omega of

    omega^2 = (b - 2 Omega cos(theta))^2 + (Omega sin(theta))^2.

The tilt determines omega, and the acceleration of the tilt at the first row, but not a, b and
Omega.  These can change together along a curve, on which a minimizer is slow.  Its coordinate is
chi, with

    tan(chi) = Omega sin(theta)/(b - 2 Omega cos(theta)).

The coordinate phi' = r0 - Omega cos(theta), which the spin angle determines, replaces r0.  Every
motion has these coordinates, with the precession rate at the first row for Omega.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.derived_inputs import moment
from ..inputs.input_keys import checked_double
from ..inputs.names import check_names
from ..inputs.top import Top
from .model import STATE
from .recording import Recording

BODY_QUANTITIES = ("m", "s", "g", "C", "A", "A_cm")
FIT_QUANTITIES = (*STATE, "r0", "psi_zero", "phi_zero", *BODY_QUANTITIES)
"""Quantities that a recording depends on: the state, then the known inputs of the body."""
_START = ("theta0", "thetadot0", "psidot0")
Name = tuple[str, int]
"""A parameter, and the number of its recording; -1 for one of the body."""
_INSTEAD = ("A_cm", "phidot0")
_NOT_ZERO = ("s", "g", "r0")
"""Inputs that are factors of a product; if one is 0, the others are not determined."""
_NEEDED = {"a", "b", "theta0", "psidot0"}
_REACH = 3.0
"""Distance, in standard deviations, at which uncertainties are evaluated."""
_STEP = 1e-30
"""An imaginary step, for derivatives without cancellation."""


def imaginary_slopes(function: Callable[[Array], Array], at: Array) -> Array:
    """Return the derivatives of a function, a row for each of its values, by imaginary steps."""
    rows = [np.imag(function(at + step)) / _STEP for step in 1j * _STEP * np.eye(at.size)]
    return np.stack(rows, axis=-1)


class KnownInputs(dict[str, float]):
    """Known inputs by key, theta0 in radians, and the standard deviations of uncertain ones."""

    def __init__(
        self, inputs: Mapping[str, float], stds: Mapping[str, float] = MappingProxyType({})
    ) -> None:
        super().__init__(inputs)
        self.stds = stds


@dataclass(frozen=True)
class Parameters:
    """The parameters of a fit of some recordings, and the inputs that are known."""

    known: KnownInputs
    """Inputs; uncertain ones are parameters with a prior."""
    names: Sequence[Name]

    def quantities(self, values: Array, i: int) -> tuple[Array, Array]:
        """Return the quantities of recording i, and their derivatives by the parameters.

        The shapes are (14,) and (14, parameters), in the order of FIT_QUANTITIES; 0 if unknown.
        """
        own = [j for j, (_, recording) in enumerate(self.names) if recording in {-1, i}]
        names = [self.names[j][0] for j in own]

        def computed(numbers: Array) -> Array:
            return self._computed(dict(zip(names, numbers, strict=True)))

        slopes = np.zeros((len(FIT_QUANTITIES), len(values)))
        slopes[:, own] = imaginary_slopes(computed, values[own])
        return computed(values[own]), slopes

    def _computed(self, free: Mapping[str, Any]) -> Array:
        """Return the quantities at real or complex parameters."""
        given: dict[str, Any] = {**self.known, **free}
        if "A_cm" in given:
            given["A"] = given["A_cm"] + given["m"] * given["s"] ** 2
        if (torque := known_torque(given)) is not None:
            given["a"] = torque
        if self.tied:
            given["b"] = self._ratio(given) * given["r0"]
        return np.array([given.get(name, 0.0) for name in FIT_QUANTITIES])

    @staticmethod
    def _ratio(given: Mapping[str, Any]) -> Any:
        """Return C/A: a parameter, a known ratio, or C a/(2mgs)."""
        if "ratio" in given:
            return given["ratio"]
        if "A" in given:
            return given["C"] / given["A"]
        return given["C"] * given["a"] / (2 * given["m"] * given["g"] * given["s"])

    def start(self, alone: Sequence[Mapping[str, float]]) -> Array:
        """Return the start of a fit from the quantities of each recording, by their medians."""
        certain = {name: self.known[name] for name in self.known.stds}
        found = [
            {**one, "ratio": one["b"] / one["r0"] if one["r0"] else 1.0, **certain} for one in alone
        ]
        values = [
            np.median([one[name] for j, one in enumerate(found) if i in {-1, j}])
            for name, i in self.names
        ]
        return np.array(values)

    def priors(self, values: Array) -> tuple[Array, Array]:
        """Return deviations of uncertain inputs over their standard deviations, and slopes."""
        rows = [i for i, (name, _) in enumerate(self.names) if name in self.known.stds]
        mean = np.array([self.known[self.names[i][0]] for i in rows])
        std = np.array([self.known.stds[self.names[i][0]] for i in rows])
        return (values[rows] - mean) / std, np.eye(values.size)[rows] / std[:, np.newaxis]

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
        """Whether r0 is a quantity of the fit, besides b."""
        return "r0" in self.known or ("r0", 0) in self.names


def parameters_of(known: KnownInputs, recordings: Sequence[Recording]) -> Parameters:
    """Return the parameters of a fit of some recordings."""
    names: list[Name] = [(name, -1) for name in BODY_QUANTITIES if name in known.stds]
    if known_torque(known) is None:
        names.append(("a", -1))
    ratio_known = "C" in known and ("A" in known or _weighs(known))
    seen = any("phi" in recording.angles for recording in recordings)
    spins = seen or ratio_known or "r0" in known
    tied = spins and (ratio_known or len(recordings) > 1)
    if tied and not ratio_known:
        names.append(("ratio", -1))
    free = [name for name in ("r0", *_START) if name not in known or name in known.stds]
    for i, recording in enumerate(recordings):
        if not tied:
            names.append(("b", i))
        names += [(name, i) for name in free if name != "r0" or spins]
        names += [(f"{x}_zero", i) for x in ("psi", "phi") if x in recording.angles]
    return Parameters(known, names)


def _weighs(known: Mapping[str, Any]) -> bool:
    """Return whether the product m g s is known."""
    return {"m", "g", "s"} <= known.keys()


def known_torque(known: Mapping[str, Any]) -> Any:
    """Return a = 2mgs/A (4,4), real or complex, or None if one of these inputs is unknown."""
    if not _weighs(known) or "A" not in known:
        return None
    return 2 * known["m"] * known["g"] * known["s"] / known["A"]


def known_inputs(given: Mapping[str, Any], stds: Mapping[str, float]) -> KnownInputs:
    """Return known inputs from inputs of `Top`, and the standard deviations of some.

    A_cm is kept besides A only if it is uncertain.  Raises LagtopError for an invalid input, one
    that a fit cannot use, or one that needs others.
    """
    check_names("known", [*given] or ["m"], [*Top.fields, *_INSTEAD])
    known, spread = {name: checked_double(name, x) for name, x in given.items()}, dict(stds)
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
        if not {"A_cm", "m", "s"} & spread.keys():
            del known["A_cm"]
    for key, unit in (("theta0_deg", math.pi / 180), ("theta0_rad", 1.0)):
        for values in (known, spread):
            if key in values:
                values["theta0"] = values.pop(key) * unit
    return KnownInputs(known, spread)


def _guard(known: Mapping[str, float]) -> None:
    """Raise LagtopError for inputs that no top has."""
    moment = known.get("A", known.get("A_cm", known.get("C", 1.0)))
    others = {"m": 1.0, "s": 1.0, "g": 1.0, "C": moment}
    Top(**others | ({} if "A_cm" in known else {"A": moment}) | dict(known))


class Coordinates:
    """Coordinates of the parameters of one recording, found by their names.

    If a parameter is missing, or if there are several recordings, the coordinates are the
    parameters themselves.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self.names = names
        self.apply = set(names) >= _NEEDED and len(set(names)) == len(names)

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
        return imaginary_slopes(self.parameters, coordinates)

    def covariance(self, coordinates: Array, spread: Array) -> Array:
        """Return the covariance of the parameters, from coordinates with the covariance S S^T.

        Parameters are evaluated three standard deviations away on both sides, along each column of
        S.  If they are not linear there, linear propagation would underestimate the covariance.
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
