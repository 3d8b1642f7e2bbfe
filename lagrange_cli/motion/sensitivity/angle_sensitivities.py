"""Exact derivatives of the angles over time by the inputs of a top.

The closed form is differentiated, not neighbouring motions.  Derivatives grow with time if rates
depend on the input.  Next to a steady precession they are small nutations.  Over a pole, on the
vertical and on the separatrix some derivatives do not exist or are not computed: these are NaN.

Next to the separatrix and to the poles the parts of a derivative may cancel.  Their sizes bound the
loss of digits, and a derivative that loses too many is computed in high precision.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from decimal import Decimal
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ...arithmetic.arrays import ARRAYS, blocks, doubles_of
from ...arithmetic.ball import TooFewDigitsError
from ...arithmetic.duals import Dual
from ...arithmetic.numbers import DOUBLES, unit_in_radians
from ...arithmetic.rounding import decided
from ...arithmetic.types import Array
from ...inputs.names import ANGLES, check_names
from ...inputs.top import Top
from ...inputs.value import Stds
from ..numbers import Numbers, middle_of
from ..over_time.samplers import Angles, check_times
from ..over_time.series_constants import Pose, pose_of
from ..regime import Exact, Regime, exact
from ..spin_precession import Nutating
from .angle_derivatives import SeriesDerivatives, SteadyDerivatives
from .neighbourhood import PARAMETERS, by_inputs, smallness
from .sensitivities import Partials
from .uncertainty import by_given

_DIGITS = 48
"""Digits of the constants of the series, if no number is small."""
_LOST = 1e-15
"""Bound of the error of a derivative over the sizes of its parts; the worst seen is 2e-16."""

_IN_THE_PLANE = [PARAMETERS.index(name) for name in ("a", "tilt", "theta_rate")]
"""The parameters along which a motion in a plane stays in it."""

_FEW_DIGITS = 1e-6
"""Tolerance of an uncertainty: few digits suffice, and a table may have many rows."""


class AngleSensitivities(NamedTuple):
    """Angles in radians in the shape of the times, and their derivatives by some inputs."""

    inputs: tuple[str, ...]
    """Names of the inputs, in the order of the last axis."""
    angles: Angles
    theta: Array
    """Derivatives of the tilt; the last axis runs over the inputs."""
    phi: Array
    psi: Array


def angle_sensitivities(
    top: Top, t: ArrayLike, inputs: Sequence[str] | None = None
) -> AngleSensitivities:
    """Return the angles of a top at the times t, and their derivatives by inputs (default: all).

    Angles are in radians, unwrapped; a derivative by `theta0_deg` is per degree.  The error of a
    derivative is at most 1e-12 times the condition number of the angle.  This is 1 rad plus the sum
    of each input times its derivative, in size.  Times that need high precision take some
    milliseconds each.  Derivatives that do not exist are NaN.  Raises LagtopError for an unknown
    input or a time out of range.

    >>> angle_sensitivities(Top(), [0.0, 0.1], ["r0", "theta0_deg"]).theta.shape
    (2, 2)
    """
    scene = exact(top)
    chain = by_inputs(scene)
    names = check_names("inputs", list(chain) if inputs is None else inputs, chain)
    neighbours = AngleDerivatives(scene)
    times = doubles_of("t", t)
    check_times(times, neighbours.max_time)
    flat = np.ascontiguousarray(times).reshape(-1)
    angles, found = np.empty((3, flat.size)), np.empty((3, flat.size, len(names)))
    with ARRAYS.working():
        for part in blocks(flat.size):
            angles[:, part], partials = neighbours.at(flat[part])
            for i, name in enumerate(names):
                found[:, part, i] = sum(
                    float(slope) * partials[:, PARAMETERS.index(parameter)]
                    for parameter, slope in chain[name].items()
                    if parameter in PARAMETERS
                )
    shape = times.shape
    return AngleSensitivities(
        tuple(names),
        Angles(*(angle.reshape(shape) for angle in angles)),
        *(derivative.reshape(*shape, len(names)) for derivative in found),
    )


def sharp_partials(scene: Exact) -> Partials:
    """Return the derivatives of the gaps of a top with as many digits as its series need.

    Each order of magnitude by which a number is small takes two more digits.  Raises LagtopError if
    no precision separates the roots.
    """

    def sharp(digits: int) -> Partials:
        partials = Partials(scene, digits)
        if digits < _DIGITS + 2 * smallness(partials.near):
            raise TooFewDigitsError
        return partials

    return decided("the roots of the cubic", sharp, _DIGITS)


class Model(Protocol):
    """A family of motions next to a top."""

    max_time: float

    def at(self, t: Array) -> tuple[Array, ...]:
        """Return angles (3, times), their derivatives (3, parameters, times), perhaps sizes."""


class AngleDerivatives:
    """The angles of one top over time and their derivatives by `PARAMETERS`."""

    def __init__(self, scene: Exact, tolerance: float = 1e-12) -> None:
        """Take a scene, and the tolerance of derivatives over the condition number of an angle.

        If the parts of a derivative cancel beyond the tolerance, each time takes some milliseconds.
        """
        partials = sharp_partials(scene)
        near, facts = partials.near, scene.facts
        self.arc = unit_in_radians(radians=scene.top.theta0_deg is None)
        kept = [i for i, name in enumerate(PARAMETERS) if name not in near.broken]
        every = list(range(len(PARAMETERS)))
        self.models: list[tuple[Model, list[int]]]
        if facts.regime is Regime.SEPARATRIX or (facts.steady and facts.pole):
            self.models = [(Spinning(scene), kept)]
        elif facts.steady:
            self.models = [(SteadyDerivatives(near), every)]
        else:
            tilt = abs(float(scene.top.theta0_deg or scene.top.theta0_rad or 0))
            here = middle_of(partials.here)
            self.models = [(NutationDerivatives(here, tilt, kept, tolerance), kept)]
            if facts.free and not (facts.over_bottom or facts.over_top):
                # only the derivative by a is correct
                beside = middle_of(partials.generic), middle_of(partials.generic_means)
                self.models.append((SeriesDerivatives(*beside), [PARAMETERS.index("a")]))
        self.max_time = self.models[0][0].max_time
        self.known = {i for _, rows in self.models for i in rows}
        """The indices of the parameters with respect to which the angles have derivatives."""
        self.reason = partials.reason("an angle")
        """The reason why derivatives by the other parameters do not exist."""

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return angles (3, times) and their derivatives (3, parameters, times)."""
        angles = np.empty((3, t.size))
        derivatives = np.full((3, len(PARAMETERS), t.size), np.nan)
        for model, rows in reversed(self.models):
            angles, found, *_ = model.at(t)
            derivatives[:, rows] = found[:, rows]
        start = t == 0
        angles[1:, start], derivatives[1:, :, start] = 0.0, 0.0
        derivatives[0][:, start] = 0.0
        derivatives[0, PARAMETERS.index("tilt"), start] = self.arc
        return angles, derivatives


class NutationDerivatives:
    """Angles of a nutating top over time, and their derivatives to a tolerance."""

    def __init__(
        self, motion: Nutating[Dual], tilt: float, rows: Sequence[int], tolerance: float
    ) -> None:
        """Take a motion, its tilt in the unit in use, and the parameters along which it is smooth.

        The tolerance of a derivative is relative to the condition number of its angle.
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

        In a plane spin and precession are constant except for jumps.  Their derivatives are 0 along
        the parameters that keep the motion in the plane.  The series give the other derivatives.
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
        """Return a mask of the times at which a derivative may miss the tolerance."""
        sizes = self.sizes[self.rows, None]
        condition = 1.0 + (abs(derivatives[:, self.rows]) * sizes).sum(axis=1)
        error = _LOST * (parts[:, self.rows] * sizes).max(axis=1)
        return np.asarray(~(error <= self.tolerance * condition).all(axis=0))

    @cached_property
    def _pose(self) -> Callable[[Dual], Pose[Dual]]:
        return pose_of(self.motion)

    def _in_digits(self, t: Array) -> Array:
        """Return the derivatives by dual numbers, which take some milliseconds per time."""
        found = np.zeros((3, len(PARAMETERS), t.size))
        ar = self.motion.ar
        with ar.working():
            for i, time in enumerate(t.tolist()):
                at = self._pose(Dual(Decimal(time)))
                for j, angle in enumerate((2 * ar.atan2(at.y, at.x), at.phi, at.psi)):
                    if angle.partials is not None:
                        found[j, :, i] = [float(x) for x in angle.partials]
        return found


class Spinning:
    """Motions from which neighbours depart at once; only the spin has a derivative, by r0."""

    def __init__(self, scene: Exact) -> None:
        self.sampler = Numbers(scene).sampler()
        self.max_time = self.sampler.max_time

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return angles and their derivatives: only the derivative of the spin by r0 is not 0."""
        derivatives = np.zeros((3, len(PARAMETERS), t.size))
        derivatives[1, PARAMETERS.index("r0")] = t
        return np.array(self.sampler.angles(t)), derivatives


class AngleStds:
    """Uncertainties of tilt, spin and precession of a top."""

    def __init__(self, scene: Exact, stds: Stds, given: Collection[str]) -> None:
        """Take the uncertainties of the inputs as given, and the names of all given inputs."""
        self.neighbours, solved = AngleDerivatives(scene, _FEW_DIGITS), by_inputs(scene)
        inputs = by_given(DOUBLES, scene.top, given)
        self.moved = np.zeros((len(stds.sources), len(PARAMETERS)))
        """The change of each parameter by one standard deviation of each source."""
        for row, (variance, shares) in zip(self.moved, stds.sources, strict=True):
            for name, share in shares.items():
                change = stds[name] * float(share) * math.sqrt(variance)
                for one, slope in inputs[name].items():
                    row += [change * slope * float(solved[one].get(x, 0)) for x in PARAMETERS]
        used = set(np.flatnonzero(self.moved.any(axis=0)).tolist())
        self.reason = None if used <= self.neighbours.known else self.neighbours.reason
        """The reason why uncertainties do not exist after the start, or None."""

    def at(self, t: Array) -> Array:
        """Return the uncertainties in radians, of shape (3, times); NaN if they do not exist."""
        with ARRAYS.working():
            _, derivatives = self.neighbours.at(t)
            square = np.zeros((len(ANGLES), t.size))
            for row in self.moved:
                used = np.flatnonzero(row)
                square += np.einsum("p,apt->at", row[used], derivatives[:, used]) ** 2
            return np.asarray(np.sqrt(square))
