"""Exact derivatives of the angles over time by the inputs of a top.

They are those of the closed form, not of neighbouring motions, and grow with time where rates
differ.  Next to a steady precession they are small nutations; over a pole, along the vertical and
on the separatrix some do not exist, or are not computed: these are NaN.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ...arithmetic.arrays import ARRAYS, blocks
from ...arithmetic.ball import TooFewDigitsError
from ...arithmetic.numbers import unit_in_radians
from ...arithmetic.rounding import decided
from ...arithmetic.types import Array
from ...inputs.names import check_names
from ...inputs.top import Top
from ..kinds import middle_of
from ..numbers import Numbers
from ..over_time.samplers import Angles
from ..over_time.times import check_times, times_of
from ..regime import Exact, Regime, exact
from .neighbourhood import PARAMETERS, by_inputs, smallness
from .sensitivities import Partials
from .series_derivatives import SeriesDerivatives
from .spinor_derivatives import NutationDerivatives
from .steady_neighbours import SteadyDerivatives

_DIGITS = 48
"""Digits of the constants of series, if nothing is small."""


class AngleSensitivities(NamedTuple):
    """Angles in radians in the shape of the times, and their derivatives by some inputs."""

    inputs: tuple[str, ...]
    """Names of the inputs, in the order of the last axis."""
    angles: Angles
    theta: Array
    """Derivatives of the tilt: one more axis than the times, for the inputs."""
    phi: Array
    psi: Array


def angle_sensitivities(
    top: Top, t: ArrayLike, inputs: Sequence[str] | None = None
) -> AngleSensitivities:
    """Return the angles of a top at the times t, and their derivatives by inputs (default: all).

    Angles are in radians, unwrapped; a derivative by `theta0_deg` is per degree.  Each derivative
    is within 1e-12 times the condition number of the angle, which is 1 rad and how far it moves by
    all inputs, each by its size; times where this takes many digits take some milliseconds each.
    Derivatives that do not exist are NaN.  Raises LagtopError for an unknown input or a time out of
    reach.
    """
    scene = exact(top)
    chain = by_inputs(scene)
    names = check_names("inputs", list(chain) if inputs is None else inputs, chain)
    neighbours = AngleDerivatives(scene)
    times = times_of(t)
    check_times(times, neighbours.max_time)
    flat = np.ascontiguousarray(times).reshape(-1)
    angles, found = np.empty((3, flat.size)), np.empty((3, flat.size, len(names)))
    with ARRAYS.working():
        for part in blocks(flat.size):
            angles[:, part], partials = neighbours.at(flat[part])
            for i, name in enumerate(names):
                found[:, part, i] = _chained_arrays(partials, chain[name])
    shape = times.shape
    return AngleSensitivities(
        tuple(names),
        Angles(*(angle.reshape(shape) for angle in angles)),
        *(derivative.reshape(*shape, len(names)) for derivative in found),
    )


def _chained_arrays(partials: Array, by: dict[str, Fraction]) -> Array:
    """Return the derivatives by an input from those by the parameters that hang on it."""
    total = np.zeros_like(partials[:, 0])
    for i, name in enumerate(PARAMETERS):
        if name in by:
            total += float(by[name]) * partials[:, i]
    return total


def sharp_partials(scene: Exact) -> Partials:
    """Return the derivatives of the gaps of a top with as many digits as its series need.

    These are two for each order of magnitude by which something is small.  Raises LagtopError if no
    precision tells the roots apart.
    """

    def sharp(digits: int) -> Partials:
        partials = Partials(scene, digits)
        if digits < _DIGITS + 2 * smallness(partials.near):
            raise TooFewDigitsError
        return partials

    return decided("the roots of the cubic", sharp, _DIGITS)


class Model(Protocol):
    """Some motions next to a top."""

    max_time: float

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return angles (3, times) and their derivatives (3, parameters, times)."""


class AngleDerivatives:
    """The angles of one top over time and their derivatives by `PARAMETERS`."""

    def __init__(self, scene: Exact, tolerance: float = 1e-12) -> None:
        """Take a scene, and how far derivatives may be off, over the condition number of an angle.

        Where the parts of one cancel beyond that, it takes some milliseconds per time.
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
                self.models.append((TorqueDerivatives(partials), [PARAMETERS.index("a")]))
        self.max_time = self.models[0][0].max_time
        self.known = {i for _, rows in self.models for i in rows}
        """The places of the parameters by which the angles have derivatives."""
        self.reason = partials.reason("an angle")
        """Why they have none by the others, if there are others."""

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return angles (3, times) and their derivatives (3, parameters, times)."""
        angles = np.empty((3, t.size))
        derivatives = np.full((3, len(PARAMETERS), t.size), np.nan)
        for model, rows in reversed(self.models):
            angles, found = model.at(t)
            derivatives[:, rows] = found[:, rows]
        start = t == 0
        angles[1:, start], derivatives[1:, :, start] = 0.0, 0.0
        derivatives[0][:, start] = 0.0
        derivatives[0, PARAMETERS.index("tilt"), start] = self.arc
        return angles, derivatives


class TorqueDerivatives:
    """Angles of a torque-free motion, of whose derivatives the one by a is right."""

    def __init__(self, partials: Partials) -> None:
        motion, means = middle_of(partials.generic), middle_of(partials.generic_means)
        self.series = SeriesDerivatives(motion, means)
        self.max_time = self.series.max_time

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return angles (3, times) and their derivatives (3, parameters, times)."""
        return self.series.at(t)[:2]


class Spinning:
    """Motions of which only the spin by r0 alone is told: the others part from them at once."""

    def __init__(self, scene: Exact) -> None:
        self.sampler = Numbers(scene).sampler()
        self.max_time = self.sampler.max_time

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return angles, and their derivatives: the spin grows with r0, and nothing else does."""
        derivatives = np.zeros((3, len(PARAMETERS), t.size))
        derivatives[1, PARAMETERS.index("r0")] = t
        return np.array(self.sampler.angles(t)), derivatives
