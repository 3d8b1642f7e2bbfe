"""Derivatives of the angles of a nutating top: by series, and in many digits where it has to be.

Next to the separatrix and to the poles the parts of a derivative may cancel.  How much they lose is
known from their sizes.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from functools import cached_property

import numpy as np

from ...arithmetic.duals import Dual
from ...arithmetic.types import Array
from ..kinds import Nutating
from ..over_time.spinors import Spinor, nutating_spinor
from .neighbourhood import PARAMETERS
from .series_derivatives import SeriesDerivatives

_LOST = 1e-15
"""The error of a derivative by series over the sizes of its parts: the worst seen is 2e-16."""

_IN_THE_PLANE = [PARAMETERS.index(name) for name in ("a", "tilt", "theta_rate")]
"""Along these a motion in a plane stays in it."""


class NutationDerivatives:
    """Angles of a nutating top over time, and their derivatives to a tolerance."""

    def __init__(
        self, motion: Nutating[Dual], tilt: float, rows: Sequence[int], tolerance: float
    ) -> None:
        """Take a motion, its tilt in the unit in use, and the parameters along which it is smooth.

        The tolerance is that of a derivative over the condition number of its angle.
        """
        self.motion, self.rows, self.tolerance = motion, rows, tolerance
        self.series = SeriesDerivatives(motion, motion)
        self.max_time = self.series.max_time
        start, period = motion.state, float(motion.T_nutation.value)
        rates = [abs(float(x.value)) for x in (start.theta_rate, start.psi_rate)]
        constants = [abs(float(x.value)) for x in (start.a, start.b, start.r0)]
        sizes = np.array([*constants, tilt, *rates])
        self.sizes = np.where(sizes > 0, sizes, 1 / period)

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return angles (3, times) and their derivatives (3, parameters, times).

        In a plane spin and precession leap and are else constant: along the parameters that leave
        the motion there their derivatives are 0, along the others they come from the series.
        """
        angles, derivatives, parts = self.series.at(t)
        smooth = 3
        if self.motion.facts.plane:
            smooth = 1
            derivatives[1:, _IN_THE_PLANE], parts[1:] = 0.0, 0.0
        doubtful = self._doubtful(derivatives, parts)
        derivatives[:smooth, :, doubtful] = self._in_digits(t[doubtful])[:smooth]
        return angles, derivatives

    def _doubtful(self, derivatives: Array, parts: Array) -> Array:
        """Return at which times a derivative may be beyond the tolerance."""
        sizes = self.sizes[self.rows, None]
        condition = 1.0 + (abs(derivatives[:, self.rows]) * sizes).sum(axis=1)
        error = _LOST * (parts[:, self.rows] * sizes).max(axis=1)
        return np.asarray(~(error <= self.tolerance * condition).all(axis=0))

    @cached_property
    def _spinor(self) -> Spinor[Dual]:
        return nutating_spinor(self.motion)

    def _in_digits(self, t: Array) -> Array:
        """Return the derivatives in dual numbers, which takes some milliseconds per time."""
        found = np.zeros((3, len(PARAMETERS), t.size))
        ar = self.motion.ar
        with ar.working():
            for i, time in enumerate(t.tolist()):
                at = self._spinor(Dual(Decimal(time)))
                for j, angle in enumerate((2 * ar.atan2(at.y, at.x), at.phi, at.psi)):
                    if angle.partials is not None:
                        found[j, :, i] = [float(x) for x in angle.partials]
        return found
