"""The formulas of the columns of `lagtop table`: rates, attitude and conserved quantities.

Each is computed from X and Y (see `angles`) when it is asked for: with N = |X|^2 + |Y|^2,
1 + u = 2 |X|^2/N and 1 - u = 2 |Y|^2/N keep their digits next to the poles.  Equation numbers are
Chrapan's.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.blocks import BLOCK, blocks
from ..arithmetic.types import Array
from ..arithmetic.workspace import workspace
from .attitude import Attitude, needed
from .columns import Part, needs_of
from .kinds import rate_parts
from .solve import SAMPLER_DIGITS, Motion


class ColumnConstants(NamedTuple):
    """What the columns need of a top, as doubles."""

    A: float
    C: float
    torque: float
    """mgs."""
    r0: float
    drift: float
    """r0 - b, or r0 on the vertical, where the next two are 0."""
    plus: float
    """(beta + b)/2."""
    minus: float
    """(beta - b)/2."""
    alpha: float
    a: float
    rises: int
    """Sign of the nutation rate at the start."""


def column_constants(motion: Motion) -> ColumnConstants:
    """Return the constants of a motion, rounded from many digits."""
    kind = motion.settled_kind(SAMPLER_DIGITS)
    state, top = kind.state, motion.top
    with kind.ar.working():
        drift, plus, minus = rate_parts(kind)
        around = state.psi_rate * state.sin
        energy = state.theta_rate * state.theta_rate + around * around
        return ColumnConstants(
            A=float(top.A),
            C=float(top.C),
            torque=float(state.a) * float(top.A) / 2,
            r0=float(state.r0),
            drift=float(drift),
            plus=float(plus / 2),
            minus=float(minus / 2),
            alpha=float(energy + state.a * state.cos),
            a=float(state.a),
            rises=-1 if state.theta_rate < 0 else 1,
        )


class Sample:
    """The motion at a block of times; a quantity is computed once, and only when asked for."""

    def __init__(
        self, t: Array, attitude: Attitude, constants: ColumnConstants, wrap: bool
    ) -> None:
        self.t, self.attitude, self.constants, self.wrap = t, attitude, constants, wrap

    def write(self, part: Part, target: Array) -> None:
        """Write a column into an array."""
        target[:] = getattr(self, part.method)()

    def times(self) -> Array:
        """Return the times."""
        return self.t

    def r(self) -> float:
        """Return the angular velocity about the figure axis, which is constant."""
        return self.constants.r0

    def theta(self) -> Array:
        """Return the tilt."""
        return self.attitude.theta()

    def phi(self) -> Array:
        """Return the spin."""
        return self.attitude.phi(wrap=self.wrap)

    def psi(self) -> Array:
        """Return the precession."""
        return self.attitude.psi(wrap=self.wrap)

    def phi_remainder(self) -> Array:
        """Return the spin less its mean growth (6,4)."""
        return self.attitude.phi_remainder()

    def psi_remainder(self) -> Array:
        """Return the precession less its mean growth (7,4)."""
        return self.attitude.psi_remainder()

    def cosine(self) -> Array:
        """Return cos(theta) (4,6)."""
        return self.u

    @cached_property
    def x2(self) -> Array:
        """|X|^2."""
        return needed(self.attitude.spinor.x2)

    @cached_property
    def y2(self) -> Array:
        """|Y|^2."""
        return needed(self.attitude.spinor.y2)

    @cached_property
    def x(self) -> Array:
        """|X|."""
        return np.sqrt(self.x2)

    @cached_property
    def y(self) -> Array:
        """|Y|."""
        return np.sqrt(self.y2)

    @cached_property
    def norm(self) -> Array:
        """N."""
        return self.x2 + self.y2

    @cached_property
    def u(self) -> Array:
        """cos(theta) (4,6)."""
        return (self.x2 - self.y2) / self.norm

    @cached_property
    def sine(self) -> Array:
        """sin(theta)."""
        return 2.0 * self.x * self.y / self.norm

    @cached_property
    def poles(self) -> tuple[Array, Array]:
        """(beta + b)/2/(1 + u) and (beta - b)/2/(1 - u), the two parts of the precession rate."""
        return (
            _over(self.constants.plus * self.norm, 2.0 * self.x2),
            _over(self.constants.minus * self.norm, 2.0 * self.y2),
        )

    def phi_rate(self) -> Array:
        """Return the spin rate (4,8)."""
        south, north = self.poles
        return self.constants.drift + south - north

    def psi_rate(self) -> Array:
        """Return the precession rate (4,7)."""
        south, north = self.poles
        return south + north

    @cached_property
    def theta_rate(self) -> Array:
        """(5,3), with its sign; on a pole by the energy (4,2), with the sign of the start."""
        product = 2.0 * self.norm * self.x * self.y
        rate = needed(self.attitude.spinor.rate)
        speed = np.sqrt(np.maximum(self.constants.alpha - self.constants.a * self.u, 0.0))
        speed *= self.constants.rises
        return np.divide(rate, product, out=speed, where=product != 0.0)

    @cached_property
    def across(self) -> Array:
        """psi' sin(theta), the angular velocity across the line of nodes (4,1)."""
        south = _over(self.constants.plus * self.y, self.x)
        return south + _over(self.constants.minus * self.x, self.y)

    @cached_property
    def body_rates(self) -> tuple[Array, Array]:
        """p and q (4,1)."""
        phi = self.attitude.phi(wrap=True)
        sin, cos = np.sin(phi), np.cos(phi)
        return (
            self.across * sin + self.theta_rate * cos,
            self.across * cos - self.theta_rate * sin,
        )

    def nutation_rate(self) -> Array:
        """Return the nutation rate (5,3)."""
        return self.theta_rate

    def p(self) -> Array:
        """Return the angular velocity about the body's x axis (4,1)."""
        return self.body_rates[0]

    def q(self) -> Array:
        """Return the angular velocity about the body's y axis (4,1)."""
        return self.body_rates[1]

    def moment(self) -> Array:
        """Return mgs sin(theta), the moment s k' x (-mg k) of section 4 a, which has no other part.

        The line of nodes lies at psi in the horizontal plane.
        """
        return self.constants.torque * self.sine

    @cached_property
    def around(self) -> Array:
        """The precession, without whole turns; the line of nodes lies along x at psi = 0."""
        return self.attitude.psi(wrap=True)

    def axis_x(self) -> Array:
        """Return the x part of the figure axis in space."""
        return self.sine * np.sin(self.around)

    def axis_y(self) -> Array:
        """Return the y part of the figure axis in space."""
        return -self.sine * np.cos(self.around)

    @cached_property
    def unit_spinor(self) -> tuple[Array, Array, Array, Array]:
        """|X| and |Y|, each over sqrt(N) and with a sign, and the arguments that go with these."""
        size = np.sqrt(self.norm)
        (arg_x, x_sign), (arg_y, y_sign) = self.attitude.quarters()
        return x_sign * self.x / size, y_sign * self.y / size, arg_x, arg_y

    def quaternion_w(self) -> Array:
        """Return the real part of X = w + i z, of the rotation from body to space."""
        x, _, arg_x, _ = self.unit_spinor
        return x * np.cos(arg_x)

    def quaternion_x(self) -> Array:
        """Return the real part of Y = x + i y."""
        _, y, _, arg_y = self.unit_spinor
        return y * np.cos(arg_y)

    def quaternion_y(self) -> Array:
        """Return the imaginary part of Y = x + i y."""
        _, y, _, arg_y = self.unit_spinor
        return y * np.sin(arg_y)

    def quaternion_z(self) -> Array:
        """Return the imaginary part of X = w + i z."""
        x, _, arg_x, _ = self.unit_spinor
        return x * np.sin(arg_x)

    def energy(self) -> Array:
        """Return A (theta'^2 + psi'^2 sin^2 theta)/2 + C r0^2/2 + mgs cos(theta) (4,2)."""
        c = self.constants
        swing = self.theta_rate**2 + self.across**2
        return 0.5 * c.A * swing + 0.5 * c.C * c.r0 * c.r0 + c.torque * self.u

    def vertical_momentum(self) -> Array:
        """Return A psi' sin^2 theta + C r0 cos(theta), constant (4,3)."""
        c = self.constants
        return c.A * self.across * self.sine + c.C * c.r0 * self.u


def _over(value: Array, divisor: Array) -> Array:
    """Return the quotient, and 0 where both vanish: over a pole there is no momentum about it."""
    return np.divide(value, divisor, out=np.zeros_like(divisor), where=divisor != 0.0)


def samples(
    motion: Motion, t: Array, chosen: Sequence[Part], *, wrap: bool
) -> Iterator[tuple[slice, Sample]]:
    """Yield the motion at the times t, a block at a time, with what some columns need.

    A sample is used up when the next one is asked for.
    """
    sampler, constants, needs = motion.sampler(), column_constants(motion), needs_of(chosen)
    farthest = sampler.check(t)
    with workspace(min(t.size, BLOCK)) as space:
        for part in blocks(t.size):
            with ARRAYS.working():
                attitude = sampler.attitude(t[part], needs, farthest, space)
            yield part, Sample(t[part], attitude, constants, wrap)
