"""The parameters of a fit: the unknowns of the body and of the starts, and what follows from them.

The body is the same in all recordings of a fit: a, and C/A if it ties b to r0.  It does so if it is
known, or if several recordings show their spin.  Each recording has its own start, b or r0 or both,
and zeros of psi and phi.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from .model import STATE
from .recording import Recording

QUANTITIES = (*STATE, "r0", "psi_zero", "phi_zero")
"""What a recording depends on, the state first."""
_START = ("theta0", "thetadot0", "psidot0")
_A, _B, _R0 = (QUANTITIES.index(name) for name in ("a", "b", "r0"))

Name = tuple[str, int]
"""A parameter, and the number of its recording; -1 for one of the body."""


class Parameters(NamedTuple):
    """The parameters of a fit of some recordings, and the inputs that are known."""

    known: Mapping[str, float]
    """Inputs by key, theta0 in radians."""
    names: Sequence[Name]

    def quantities(self, values: Array, i: int) -> tuple[Array, Array]:
        """Return what recording i depends on, and its derivatives by the parameters.

        They are of shape (8,) and (8, parameters), in the order of QUANTITIES.
        """
        found = np.zeros(len(QUANTITIES))
        slopes = np.zeros((len(QUANTITIES), len(values)))
        for row, name in enumerate(QUANTITIES):
            if name in self.known:
                found[row] = self.known[name]
            for key in ((name, -1), (name, i)):
                if key in self.names:
                    column = self.names.index(key)
                    found[row], slopes[row, column] = values[column], 1.0
        known_a = _torque(self.known)
        if known_a is not None:
            found[_A] = known_a
        if self.tied:
            ratio, of_ratio = self._ratio(values, found[_A], slopes[_A])
            found[_B] = ratio * found[_R0]
            slopes[_B] = ratio * slopes[_R0] + found[_R0] * of_ratio
        return found, slopes

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


def parameters_of(known: Mapping[str, float], recordings: Sequence[Recording]) -> Parameters:
    """Return the parameters of a fit."""
    names: list[Name] = []
    if _torque(known) is None:
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


def _torque(known: Mapping[str, float]) -> float | None:
    """Return a = 2mgs/A (4,4) where all of it is known."""
    weight = _weight(known)
    return None if weight is None or "A" not in known else 2 * weight / known["A"]
