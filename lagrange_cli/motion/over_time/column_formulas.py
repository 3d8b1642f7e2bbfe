"""The formulas of the columns of `lagtop table`: rates, attitude and conserved quantities.

Each column is an attribute with its name, computed from the attitude

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

up to a common positive factor.  With N = |X|^2 + |Y|^2, both 1 + u = 2 |X|^2/N and 1 - u = 2
|Y|^2/N keep their digits next to the poles.  `table` evaluates the formulas at arrays of times,
`proved_table` in balls at one time.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from abc import abstractmethod
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from ...arithmetic.numbers import R
from ...arithmetic.values import Over, Values
from ..kinds import Kind, Vertical

if TYPE_CHECKING:
    from ...arithmetic.protocol import Arithmetic
    from ..regime import Exact


class ColumnConstants(Values, Over[R]):
    """The constants of a top used in its columns."""

    half_A: R
    """A/2."""
    half_C: R
    torque: R
    """mgs."""
    r0: R
    drift: R
    """r0 - b, or r0 on the vertical, where `plus` and `minus` are 0."""
    plus: R
    """(beta + b)/2."""
    minus: R
    """(beta - b)/2."""
    alpha: R
    a: R


def column_constants(kind: Kind[R], exact: Exact) -> ColumnConstants[R]:
    """Return the constants of a motion in its arithmetic."""
    ar, state = kind.ar, kind.state
    A, C = Fraction(exact.top.A), Fraction(exact.top.C)
    with ar.working():
        drift, plus, minus = state.pole_drift, kind.gaps.beta_plus_b / 2, kind.gaps.beta_minus_b / 2
        if isinstance(kind, Vertical):  # all of the rotation counts as spin
            drift, plus, minus = kind.r0, 0 * kind.r0, 0 * kind.r0
        return ColumnConstants(
            half_A=ar.convert(A / 2),
            half_C=ar.convert(C / 2),
            torque=ar.convert(exact.a * A / 2),
            r0=state.r0,
            drift=drift,
            plus=plus,
            minus=minus,
            alpha=state.energy + state.a * state.cos,
            a=state.a,
        )


class ColumnFormulas(Over[R]):
    """A motion at one or several times; each column, and each part, is computed on first use."""

    ar: Arithmetic[R]
    t: R
    constants: ColumnConstants[R]

    @cached_property
    def within(self) -> R:
        """The spin, up to whole turns."""
        raise NotImplementedError

    @cached_property
    def around(self) -> R:
        """The precession, up to whole turns."""
        raise NotImplementedError

    @property
    @abstractmethod
    def dphi(self) -> R:
        """The periodic part of the spin (6,4)."""

    @property
    @abstractmethod
    def dpsi(self) -> R:
        """The periodic part of the precession (7,4)."""

    @cached_property
    @abstractmethod
    def thetadot(self) -> R:
        """The nutation rate (5,3)."""

    @abstractmethod
    def over(self, value: R, divisor: R) -> R:
        """Return a quotient, and 0 for 0/0: on a pole the momentum about it is 0."""

    @cached_property
    def args(self) -> tuple[R, R]:
        """(psi + phi)/2 and (psi - phi)/2, up to whole turns of both or half a turn of both."""
        return (self.around + self.within) / 2, (self.around - self.within) / 2

    @property
    def theta(self) -> R:
        """The tilt."""
        return 2 * self.ar.atan2(self.y, self.x)

    @property
    def phi(self) -> R:
        """The spin."""
        return self.within

    @property
    def psi(self) -> R:
        """The precession."""
        return self.around

    @property
    def r(self) -> R:
        """The angular velocity about the figure axis, which is constant."""
        return self.constants.r0

    @cached_property
    def x(self) -> R:
        """|X|."""
        return self.ar.sqrt(self.x2)

    @cached_property
    def y(self) -> R:
        """|Y|."""
        return self.ar.sqrt(self.y2)

    @cached_property
    def x2(self) -> R:
        """|X|^2."""
        return self.x * self.x

    @cached_property
    def y2(self) -> R:
        """|Y|^2."""
        return self.y * self.y

    @cached_property
    def norm(self) -> R:
        """N."""
        return self.x2 + self.y2

    @cached_property
    def u(self) -> R:
        """cos(theta) (4,6)."""
        return (self.x2 - self.y2) / self.norm

    @property
    def axis_z(self) -> R:
        """The z part of the figure axis in space."""
        return self.u

    @cached_property
    def sine(self) -> R:
        """sin(theta)."""
        return 2 * self.x * self.y / self.norm

    @cached_property
    def poles(self) -> tuple[R, R]:
        """(beta + b)/2/(1 + u) and (beta - b)/2/(1 - u), the two parts of the precession rate."""
        return (
            self.over(self.constants.plus * self.norm, 2 * self.x2),
            self.over(self.constants.minus * self.norm, 2 * self.y2),
        )

    @property
    def phidot(self) -> R:
        """The spin rate (4,8)."""
        south, north = self.poles
        return self.constants.drift + south - north

    @property
    def psidot(self) -> R:
        """The precession rate (4,7)."""
        south, north = self.poles
        return south + north

    @cached_property
    def across(self) -> R:
        """psi' sin(theta), the angular velocity across the line of nodes (4,1)."""
        south = self.over(self.constants.plus * self.y, self.x)
        return south + self.over(self.constants.minus * self.x, self.y)

    @cached_property
    def turned(self) -> tuple[R, R]:
        """Sine and cosine of the spin."""
        return self.ar.sin(self.within), self.ar.cos(self.within)

    @property
    def p(self) -> R:
        """The angular velocity about the body's x axis (4,1)."""
        sin, cos = self.turned
        return self.across * sin + self.thetadot * cos

    @property
    def q(self) -> R:
        """The angular velocity about the body's y axis (4,1)."""
        sin, cos = self.turned
        return self.across * cos - self.thetadot * sin

    @property
    def moment(self) -> R:
        """mgs sin(theta), the only component of the moment s k' x (-mg k) of section 4 a.

        The moment acts about the line of nodes, at psi in the horizontal plane.
        """
        return self.constants.torque * self.sine

    @property
    def axis_x(self) -> R:
        """The x part of the figure axis in space."""
        return self.sine * self.ar.sin(self.around)

    @property
    def axis_y(self) -> R:
        """The y part of the figure axis in space."""
        return -self.sine * self.ar.cos(self.around)

    @cached_property
    def unit(self) -> tuple[R, R]:
        """|X| and |Y|, each over sqrt(N)."""
        size = self.ar.sqrt(self.norm)
        return self.x / size, self.y / size

    @property
    def quaternion_w(self) -> R:
        """The real part of X = w + i z, of the rotation from body to space."""
        return self.unit[0] * self.ar.cos(self.args[0])

    @property
    def quaternion_x(self) -> R:
        """The real part of Y = x + i y."""
        return self.unit[1] * self.ar.cos(self.args[1])

    @property
    def quaternion_y(self) -> R:
        """The imaginary part of Y = x + i y."""
        return self.unit[1] * self.ar.sin(self.args[1])

    @property
    def quaternion_z(self) -> R:
        """The imaginary part of X = w + i z."""
        return self.unit[0] * self.ar.sin(self.args[0])

    @property
    def energy(self) -> R:
        """A (theta'^2 + psi'^2 sin^2 theta)/2 + C r0^2/2 + mgs cos(theta) (4,2)."""
        c = self.constants
        swing = self.thetadot * self.thetadot + self.across * self.across
        return c.half_A * swing + c.half_C * c.r0 * c.r0 + c.torque * self.u

    @property
    def Lz(self) -> R:
        """A psi' sin^2 theta + C r0 cos(theta), constant (4,3)."""
        c = self.constants
        return 2 * c.half_A * self.across * self.sine + 2 * c.half_C * c.r0 * self.u
