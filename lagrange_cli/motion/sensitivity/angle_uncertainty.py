"""Standard uncertainties of the angles over time, of first order by exact derivatives."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from ...arithmetic.arrays import ARRAYS
from ...arithmetic.numbers import DOUBLES
from ...arithmetic.types import Array
from ...inputs.names import ANGLES
from ..regime import Exact
from .angle_sensitivities import AngleDerivatives
from .neighbourhood import PARAMETERS, by_inputs
from .uncertainty import by_given

_TOLERANCE = 1e-6
"""An uncertainty has few digits, and a table may have many rows."""


class AngleStds:
    """Uncertainties of tilt, spin and precession of a top, whose inputs are not correlated."""

    def __init__(self, scene: Exact, stds: Mapping[str, float], given: Collection[str]) -> None:
        """Take the uncertainties of the inputs as they were given, and the names of all inputs."""
        self.neighbours, solved = AngleDerivatives(scene, _TOLERANCE), by_inputs(scene)
        inputs = by_given(DOUBLES, scene.top, given)
        self.moved = np.zeros((len(stds), len(PARAMETERS)))
        """How far one uncertainty moves each parameter."""
        for row, (name, std) in zip(self.moved, stds.items(), strict=True):
            for one, slope in inputs[name].items():
                for by, factor in solved[one].items():
                    row[PARAMETERS.index(by)] += std * slope * float(factor)
        used = set(np.flatnonzero(self.moved.any(axis=0)).tolist())
        self.reason = None if used <= self.neighbours.known else self.neighbours.reason
        """Why there are no uncertainties after the start, where there are none."""

    def at(self, t: Array) -> Array:
        """Return the uncertainties in radians, of shape (3, times); NaN where there is none."""
        with ARRAYS.working():
            _, derivatives = self.neighbours.at(t)
            square = np.zeros((len(ANGLES), t.size))
            for row in self.moved:
                used = np.flatnonzero(row)
                square += np.einsum("p,apt->at", row[used], derivatives[:, used]) ** 2
            return np.asarray(np.sqrt(square))
