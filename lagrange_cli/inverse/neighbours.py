"""Neighbours of a Lagrange top: other machines, and faults of camera, clock and rows.

Each neighbour is a template: how it changes the motion if it is small, computed from forces along
the motion or from another reading of it.  `findings` measures them in a recording.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Legendre

from ..arithmetic.types import Array
from .measured import Measured
from .variations import Variations

LOST = "lost rows"
"""The name of a step of the clock."""
DECAY = "a decay of the spin"
"""The name of friction."""
_DRIFT, WANDER = "a clock whose rate changes", "a clock whose rate wanders"
"""The names of two faults of the clock."""
SLOWING = {DECAY, _DRIFT, WANDER}
"""Names of neighbours that a loss of spin may explain."""


class Neighbour(NamedTuple):
    """A small change of a Lagrange top or of its recording."""

    name: str
    amount: str
    """Its size in words, with {} for a number of per cent."""
    changes: list[Array]
    """Changes of theta, phi and psi for the size 1, one for each of its directions."""
    is_positive: bool = False
    """Whether a negative size is impossible."""
    is_square: bool = False
    """Whether the changes are those of a square of the size."""
    row: int = 0
    """The row from which it acts."""
    tried: int = 1
    """The number of places or rates among which it was searched."""


def machines(x: Variations) -> Iterator[Neighbour]:
    """Yield other machines than a Lagrange top.  Dry and viscous friction look alike."""
    (nods, _, turns), s, c, push = x.rates, x.sine, x.cosine, x.pushed
    over = "by {} % over the recording"
    yield Neighbour(
        "a stand that turns with the top", "with {} % of A", [push(psi=-x.slope(turns))], True
    )
    yoke = push(theta=-x.slope(nods))
    yield Neighbour("a yoke that tilts with the axis", "with {} % of A", [yoke], True)
    ring = push(theta=-turns * turns * s * c, psi=-x.slope(turns * c * c))
    yield Neighbour("a ring that does not spin", "with {} % of A", [ring], True)
    drag = push(phi=-x.b + 0 * s, psi=-x.b * c) / x.length
    mean = f"{over} (b is its mean)" if math.isnan(x.ratio) else over
    yield Neighbour(DECAY, mean, [drag], True)
    damped = push(psi=-turns) / x.length
    yield Neighbour("a vertical bearing that damps", over, [damped], True)
    damped = push(theta=-nods) / x.length
    yield Neighbour("a bearing of the tilt that damps", over, [damped], True)
    yield Neighbour("a second torque", "of {} % of mgs sin(2 theta)", [push(theta=x.a * s * c)])
    axis, _, down = x.frame
    force = x.slope(x.slope(axis, 2), 2) / (2 * math.pi) ** 2
    around = axis[0] * force[1] - axis[1] * force[0]
    soft = push(theta=np.sum(force * down, axis=0), psi=around)
    yield Neighbour("a pivot that yields", "with (m s^2/A)(m/k)(2 pi/T)^2 = {} %", [soft], True)
    if not math.isnan(x.ratio):
        yield from unround(x, x.angles[1])


def unround(x: Variations, phi: Array) -> Iterator[Neighbour]:
    """Yield bodies that are not round, for spin angles of shape (..., times)."""
    (nods, _, turns), s, c, push = x.rates, x.sine, x.cosine, x.pushed
    sine, cosine, half = np.sin(phi), np.cos(phi), -x.a / 2
    beside = [push(theta=half * c * sine, phi=half * s * cosine)]
    beside += [push(theta=half * c * cosine, phi=-half * s * sine)]
    yield Neighbour("a centre of mass off the axis", "by {} % of s", beside)
    p, q = nods * cosine + turns * s * sine, -nods * sine + turns * s * cosine
    unlike = []
    for y, z in ((p, -q), (q, p)):  # the kinetic energy grows by (p^2 - q^2)/4 and p q/2
        by_nods, by_turns = (y * cosine - z * sine) / 2, (y * sine + z * cosine) * s / 2
        by_theta, by_phi = (y * sine + z * cosine) * turns * c / 2, (y * q - z * p) / 2
        forces = {"theta": by_theta - x.slope(by_nods), "phi": by_phi, "psi": -x.slope(by_turns)}
        unlike.append(push(**forces))
    yield Neighbour("equatorial moments that differ", "by {} %", unlike)


def misread(x: Variations, one: Measured) -> Iterator[Neighbour]:
    """Yield faults of the clock, the camera and the angles of a recording."""
    (_, phi, psi), s, c, only, seen = x.angles, x.sine, x.cosine, x.only, one.angles
    axis, nodes, down = x.frame
    is_angles = one.kind == "angles"

    def turned(by: Array) -> Array:
        """Return the change of the angles by changes of the axis, shape (3, times)."""
        turn = np.sum(by * nodes, axis=0) / s
        return only(theta=np.sum(by * down, axis=0), psi=turn, phi=-c * turn)

    drift = x.rates * x.t**2 / (2 * x.length)
    yield Neighbour(_DRIFT, "by {} %", [drift])
    if "psi" in seen:
        mean = only(psi=np.polyfit(x.t, psi, 1)[0] * x.t)
        yield Neighbour("a camera that turns", "with {} % of the precession", [mean])
    along, beside = np.cos(psi), np.sin(psi)
    if {"theta", "psi"} <= seen.keys():
        leaning = [only(theta=along, phi=beside / s, psi=-beside * c / s)]
        leaning += [only(theta=beside, phi=-along / s, psi=along * c / s)]
        yield Neighbour("a tilted vertical of the data", "by {} % of a radian", leaning)
    if {"theta", "phi", "psi"} <= seen.keys():
        along, beside = np.cos(phi), np.sin(phi)
        askew = [only(theta=along, phi=-c * beside / s, psi=beside / s)]
        askew += [only(theta=-beside, phi=-c * along / s, psi=along / s)]
        yield Neighbour("a misaligned figure axis of the data", "by {} % of a radian", askew)
    if one.position is not None:
        shifted = [turned(y[:, np.newaxis]) for y in np.eye(3)]
        yield Neighbour("an origin beside the pivot", "by {} % of the distance", shifted)
    smooth = x.slope(x.angles, 2) / 2 if is_angles else turned(x.slope(axis, 2) / 2)
    words = "a filter", "with a standard deviation of {} % of a period"
    yield Neighbour(*words, [smooth], True, True)
    if is_angles and "theta" in seen:
        yield Neighbour("a wrong zero of theta", "by {} % of a radian", [only(theta=1.0)])
    if is_angles and "psi" in seen:
        yield Neighbour("a wrong scale of psi", "by {} %", [only(psi=psi)])


def wander(x: Variations) -> Neighbour:
    """Return a clock whose rate wanders; its drift is in the model error already."""
    place = 2 * x.t / x.length - 1
    drifts = [x.rates * Legendre.basis(n)(place) * x.length / 4 for n in (2, 3, 4)]
    return Neighbour(WANDER, "by {} %", drifts)


def lost_text(recording: Measured, row: int, size: float) -> str:
    """Return how many rows are lost before a row, at least one."""
    count, at = max(round(size), 1), recording.t_start + float(recording.t[row])
    return f"{count} row{'s are' if count > 1 else ' is'} lost before t = {at:.6g}"
