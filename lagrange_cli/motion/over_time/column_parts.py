"""The parts of the columns of `lagtop table`, for any arithmetic.

The parts are computed from the attitude

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

up to a common positive factor.  With N = |X|^2 + |Y|^2, both 1 + u = 2 |X|^2/N and 1 - u = 2
|Y|^2/N keep their digits next to the poles.  `table` computes the parts at arrays of times,
`proved_table` in balls at one time.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from ...arithmetic.numbers import R
from ...arithmetic.values import Over, Values
from ..kinds import Kind, Vertical
from ..quantity import quantity
from .columns import SCALARS

if TYPE_CHECKING:
    from ...arithmetic.numbers import Arithmetic
    from ..regime import Exact


class ColumnConstants(Values, Over[R]):
    """The constants of a top used in its columns."""

    A: R
    C: R
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
            A=ar.convert(A),
            C=ar.convert(C),
            torque=ar.convert(exact.a * A / 2),
            r0=state.r0,
            drift=drift,
            plus=plus,
            minus=minus,
            alpha=state.energy + state.a * state.cos,
            a=state.a,
        )


class ColumnParts(Over[R]):
    """A motion at one or several times; most parts are computed on first use."""

    ar: Arithmetic[R]
    t: R
    top: ColumnConstants[R]
    within: quantity[R]
    """The spin, up to whole turns."""
    around: quantity[R]
    """The precession, up to whole turns."""
    spin_wave: quantity[R]
    """The periodic part of the spin (6,4)."""
    precession_wave: quantity[R]
    """The periodic part of the precession (7,4)."""
    thetadot: quantity[R]
    """The nutation rate (5,3)."""
    x: quantity[R]
    """|X|."""
    y: quantity[R]
    """|Y|."""
    x2: quantity[R]
    """|X|^2."""
    y2: quantity[R]
    """|Y|^2."""

    def column(self, name: str) -> R:
        """Return a column by its name."""
        value: R = SCALARS[name].value(self)
        return value

    def over(self, value: R, divisor: R) -> R:
        """Return a quotient, and 0 for 0/0: on a pole the momentum about it is 0."""
        raise NotImplementedError

    @property
    def tilt(self) -> R:
        """The angle theta."""
        return 2 * self.ar.atan2(self.y, self.x)

    @property
    def spin(self) -> R:
        """The angle phi."""
        return self.within

    @property
    def precession(self) -> R:
        """The angle psi."""
        return self.around

    @quantity
    def args(self) -> tuple[R, R]:
        """(psi + phi)/2 and (psi - phi)/2, up to whole turns of both or half a turn of both."""
        return (self.around + self.within) / 2, (self.around - self.within) / 2

    @quantity
    def norm(self) -> R:
        """N."""
        return self.x2 + self.y2

    @quantity
    def u(self) -> R:
        """cos(theta) (4,6)."""
        return (self.x2 - self.y2) / self.norm

    @quantity
    def sine(self) -> R:
        """sin(theta)."""
        return 2 * self.x * self.y / self.norm

    @quantity
    def south(self) -> R:
        """(beta + b)/2/(1 + u), the part of the precession rate from the lower pole."""
        return self.over(self.top.plus * self.norm, 2 * self.x2)

    @quantity
    def north(self) -> R:
        """(beta - b)/2/(1 - u), the part of the precession rate from the upper pole."""
        return self.over(self.top.minus * self.norm, 2 * self.y2)

    @quantity
    def across(self) -> R:
        """psi' sin(theta), the angular velocity across the line of nodes (4,1)."""
        south = self.over(self.top.plus * self.y, self.x)
        return south + self.over(self.top.minus * self.x, self.y)

    @quantity
    def sin_spin(self) -> R:
        """The sine of the spin."""
        return self.ar.sin(self.within)

    @quantity
    def cos_spin(self) -> R:
        """The cosine of the spin."""
        return self.ar.cos(self.within)

    @property
    def rotation_energy(self) -> R:
        """A (theta'^2 + psi'^2 sin^2 theta)/2 + C r0^2/2 (4,2)."""
        top = self.top
        swing = self.thetadot * self.thetadot + self.across * self.across
        return top.A / 2 * swing + top.C / 2 * top.r0 * top.r0

    @quantity
    def unit(self) -> tuple[R, R]:
        """|X| and |Y|, each over sqrt(N)."""
        size = self.ar.sqrt(self.norm)
        return self.x / size, self.y / size
