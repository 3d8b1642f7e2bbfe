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

from ..arithmetic.types import Array
from .columns import COLUMNS, Chosen, need_rate
from .samplers import Attitude
from .solve import SAMPLER_DIGITS, Motion


class ColumnConstants(NamedTuple):
    """What the columns need of a top, as doubles."""

    A: float
    C: float
    torque: float
    """mgs."""
    r0: float
    drift: float
    """r0 - b."""
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
    state, gaps, top = kind.state, kind.gaps, motion.top
    with kind.ar.working():
        around = state.psi_rate * state.sin
        energy = state.theta_rate * state.theta_rate + around * around
        return ColumnConstants(
            A=float(top.A),
            C=float(top.C),
            torque=float(state.a) * float(top.A) / 2,
            r0=float(state.r0),
            drift=float(state.pole_drift),
            plus=float(gaps.beta_plus_b / 2),
            minus=float(gaps.beta_minus_b / 2),
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
        self.x, self.y = attitude.spinor.x, attitude.spinor.y
        self._groups: dict[str, Sequence[Array]] = {}

    def column(self, chosen: Chosen) -> Array:
        """Return a column; its group is computed once."""
        if chosen.group not in self._groups:
            self._groups[chosen.group] = getattr(self, COLUMNS[chosen.group].method)()
        return self._groups[chosen.group][chosen.part]

    def times(self) -> list[Array]:
        """Return the times."""
        return [self.t]

    def theta(self) -> list[Array]:
        """Return the tilt."""
        return [self.attitude.theta()]

    def phi(self) -> list[Array]:
        """Return the spin."""
        return [self.attitude.phi(wrap=self.wrap)]

    def psi(self) -> list[Array]:
        """Return the precession."""
        return [self.attitude.psi(wrap=self.wrap)]

    def phi_remainder(self) -> list[Array]:
        """Return the spin less its mean growth (6,4)."""
        return [self.attitude.phi_remainder()]

    def psi_remainder(self) -> list[Array]:
        """Return the precession less its mean growth (7,4)."""
        return [self.attitude.psi_remainder()]

    def cosine(self) -> list[Array]:
        """Return cos(theta) (4,6)."""
        return [self.u]

    def r(self) -> list[Array]:
        """Return the angular velocity about the figure axis, which is constant."""
        return [np.full_like(self.t, self.constants.r0)]

    @cached_property
    def norm(self) -> Array:
        """N."""
        return self.x * self.x + self.y * self.y

    @cached_property
    def u(self) -> Array:
        """cos(theta) (4,6)."""
        return (self.x - self.y) * (self.x + self.y) / self.norm

    @cached_property
    def sine(self) -> Array:
        """sin(theta)."""
        return 2.0 * self.x * self.y / self.norm

    @cached_property
    def poles(self) -> tuple[Array, Array]:
        """(beta + b)/2/(1 + u) and (beta - b)/2/(1 - u), the two parts of the precession rate."""
        return (
            _over(self.constants.plus * self.norm, 2.0 * self.x * self.x),
            _over(self.constants.minus * self.norm, 2.0 * self.y * self.y),
        )

    def phi_rate(self) -> list[Array]:
        """Return the spin rate (4,8)."""
        south, north = self.poles
        return [self.constants.drift + south - north]

    def psi_rate(self) -> list[Array]:
        """Return the precession rate (4,7)."""
        south, north = self.poles
        return [south + north]

    @cached_property
    def theta_rate(self) -> Array:
        """(5,3), with its sign; on a pole by the energy (4,2), with the sign of the start."""
        product = 2.0 * self.norm * self.x * self.y
        rate = self.attitude.spinor.rate
        assert rate is not None
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

    def nutation_rate(self) -> list[Array]:
        """Return the nutation rate (5,3)."""
        return [self.theta_rate]

    def p(self) -> list[Array]:
        """Return the angular velocity about the body's x axis (4,1)."""
        return [self.body_rates[0]]

    def q(self) -> list[Array]:
        """Return the angular velocity about the body's y axis (4,1)."""
        return [self.body_rates[1]]

    def moment(self) -> list[Array]:
        """Return mgs sin(theta), the moment s k' x (-mg k) of section 4 a, which has no other part.

        The line of nodes lies at psi in the horizontal plane.
        """
        return [self.constants.torque * self.sine]

    def axis(self) -> list[Array]:
        """Return the figure axis in space; the line of nodes lies along x at psi = 0."""
        psi = self.attitude.psi(wrap=True)
        return [self.sine * np.sin(psi), -self.sine * np.cos(psi), self.u]

    def quaternion(self) -> list[Array]:
        """Return w, x, y, z of the rotation from body to space: X = w + i z, Y = x + i y."""
        arg_x, arg_y = self.attitude.args()
        size = np.sqrt(self.norm)
        x, y = self.x / size, self.y / size
        return [x * np.cos(arg_x), y * np.cos(arg_y), y * np.sin(arg_y), x * np.sin(arg_x)]

    def energy(self) -> list[Array]:
        """Return A (theta'^2 + psi'^2 sin^2 theta)/2 + C r0^2/2 + mgs cos(theta) (4,2)."""
        c = self.constants
        swing = self.theta_rate**2 + self.across**2
        return [0.5 * c.A * swing + 0.5 * c.C * c.r0 * c.r0 + c.torque * self.u]

    def vertical_momentum(self) -> list[Array]:
        """Return A psi' sin^2 theta + C r0 cos(theta), constant (4,3)."""
        c = self.constants
        return [c.A * self.across * self.sine + c.C * c.r0 * self.u]


def _over(value: Array, divisor: Array) -> Array:
    """Return the quotient, and 0 where both vanish: over a pole there is no momentum about it."""
    return np.divide(value, divisor, out=np.zeros_like(divisor), where=divisor != 0.0)


def samples(
    motion: Motion, t: Array, chosen: Sequence[Chosen], *, wrap: bool
) -> Iterator[tuple[slice, Sample]]:
    """Yield the motion at the times t, a block at a time, with what some columns need."""
    sampler, constants = motion.sampler(), column_constants(motion)
    sampler.check(t)
    for part, attitude in sampler.attitudes(t, rate=need_rate(chosen)):
        yield part, Sample(t[part], attitude, constants, wrap)
