"""A motion at one time in balls: the columns of `lagtop table`, each with its formula.

The attitude is that of the theta series in balls (`spinors`), whose remainders are proved
in `theta_series`, so that the unwrapped turns are proved with it.  A column here has the name of a
method of `sample.Sample`, of which it is the exact value.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, cast

from ..arithmetic.balls import Ball
from .kinds import Constant, Separatrix, rate_parts
from .rational_keys import known_fraction
from .spinors import Attitude

if TYPE_CHECKING:
    from ..arithmetic.balls import Balls
    from .certified import Certified


def sample_at(motion: Certified, t: Fraction, bits: int, *, wrap: bool = False) -> BallSample:
    """Return a motion at a time in balls of so many bits.

    Raises TooFewDigitsError where these do not tell the roots or the half periods apart.
    """
    kind = motion.kind(bits)
    with kind.ar.working():
        time = cast("Balls", kind.ar).convert(t)
        if t:
            return BallSample(motion, bits, time, motion.spinor(bits)(time), wrap=wrap)
        state = kind.state
        start = Attitude(state.cos_half, state.sin_half, time, time, time, state.theta_rate)
        return BallSample(motion, bits, time, start, wrap=wrap)


class BallSample:
    """A motion at one time in balls; a quantity is computed when it is asked for."""

    def __init__(
        self, motion: Certified, bits: int, t: Ball, at: Attitude[Ball], *, wrap: bool
    ) -> None:
        self.exact, self.top, self.kind = motion.exact, motion.top, motion.kind(bits)
        self.t, self.at, self.wrap = t, at, wrap
        self.ar = cast("Balls", self.kind.ar)

    def theta(self) -> Ball:
        """Return the tilt."""
        return 2 * self.ar.atan2(self.at.y, self.at.x)

    def phi(self) -> Ball:
        """Return the spin."""
        return self._angle(self.at.phi)

    def psi(self) -> Ball:
        """Return the precession."""
        return self._angle(self.at.psi)

    def _angle(self, angle: Ball) -> Ball:
        """Return an angle as it stands, or in (-pi, pi]."""
        if not self.wrap:
            return angle
        ar, pi = self.ar, self.ar.pi
        if self.kind.facts.plane:  # half turns, where both ends belong to pi
            return pi * (ar.nint(angle / pi) % 2)
        return angle - 2 * pi * ar.ceiling(angle / (2 * pi) - 1 / ar.convert(2))

    @cached_property
    def growths(self) -> tuple[Ball, Ball]:
        """Mean growth of spin and precession, on the separatrix in infinite time."""
        kind = self.kind
        if isinstance(kind, Separatrix):
            return kind.state.spin_drift * self.t, kind.b / 2 * self.t
        still = known_fraction(self.exact, "mean_spin_rate") == 0
        spin = 0 * self.t if still else kind.mean_spin_rate * self.t
        return spin, kind.mean_precession_rate * self.t

    def phi_remainder(self) -> Ball:
        """Return the spin less its mean growth (6,4)."""
        constant = isinstance(self.kind, Constant)
        return 0 * self.t if constant else self.at.phi - self.growths[0]

    def psi_remainder(self) -> Ball:
        """Return the precession less its mean growth (7,4)."""
        constant = isinstance(self.kind, Constant)
        return 0 * self.t if constant else self.at.psi - self.growths[1]

    @cached_property
    def unit(self) -> tuple[Ball, Ball]:
        """|X| and |Y| over the root of the sum of their squares."""
        x, y = self.at.x, self.at.y
        size = self.ar.sqrt(x * x + y * y)
        return x / size, y / size

    @cached_property
    def u(self) -> Ball:
        """cos(theta) (4,6)."""
        x, y = self.unit
        return (x - y) * (x + y)

    def cosine(self) -> Ball:
        """Return cos(theta) (4,6)."""
        return self.u

    @cached_property
    def sine(self) -> Ball:
        """sin(theta)."""
        x, y = self.unit
        return 2 * x * y

    @cached_property
    def rate_parts(self) -> tuple[Ball, Ball, Ball]:
        """What the rates of spin and precession are made of."""
        return rate_parts(self.kind)

    @cached_property
    def poles(self) -> tuple[Ball, Ball]:
        """(beta + b)/2/(1 + u) and (beta - b)/2/(1 - u), the two parts of the precession rate."""
        _, *momenta = self.rate_parts
        south, north = (
            0 * momentum if not momentum else momentum / (4 * part * part)
            for momentum, part in zip(momenta, self.unit, strict=True)
        )
        return south, north

    def phi_rate(self) -> Ball:
        """Return the spin rate (4,8)."""
        south, north = self.poles
        return self.rate_parts[0] + south - north

    def psi_rate(self) -> Ball:
        """Return the precession rate (4,7)."""
        south, north = self.poles
        return south + north

    @cached_property
    def across(self) -> Ball:
        """psi' sin(theta), the angular velocity across the line of nodes (4,1)."""
        return self.psi_rate() * self.sine

    @cached_property
    def swing(self) -> Ball:
        """theta'^2 + psi'^2 sin^2 theta at the start (4,2)."""
        state = self.kind.state
        around = state.psi_rate * state.sin
        return state.theta_rate * state.theta_rate + around * around

    @cached_property
    def nutation_square(self) -> Ball:
        """theta'^2 by the energy (4,2)."""
        state, across = self.kind.state, self.across
        return self.swing + state.a * (state.cos - self.u) - across * across

    @cached_property
    def theta_rate(self) -> Ball:
        """theta', which has the sign of `at.tilting`."""
        tilting = self.at.tilting
        if not tilting:
            return 0 * self.t
        speed = self.ar.sqrt(self.nutation_square)
        return speed if tilting > 0 else -speed

    def nutation_rate(self) -> Ball:
        """Return the nutation rate."""
        return self.theta_rate

    def p(self) -> Ball:
        """Return the angular velocity about the body's x axis (4,1)."""
        phi = self.at.phi
        return self.across * self.ar.sin(phi) + self.theta_rate * self.ar.cos(phi)

    def q(self) -> Ball:
        """Return the angular velocity about the body's y axis (4,1)."""
        phi = self.at.phi
        return self.across * self.ar.cos(phi) - self.theta_rate * self.ar.sin(phi)

    def r(self) -> Ball:
        """Return the angular velocity about the figure axis."""
        return self.kind.r0

    def moment(self) -> Ball:
        """Return mgs sin(theta), the moment of the weight about the line of nodes."""
        return self._torque() * self.sine

    def energy(self) -> Ball:
        """Return A (theta'^2 + psi'^2 sin^2 theta)/2 + C r0^2/2 + mgs cos(theta) (4,2)."""
        ar, state, top = self.ar, self.kind.state, self.top
        turning = ar.convert(top.C) * state.r0 * state.r0
        return (ar.convert(top.A) * self.swing + turning) / 2 + self._torque() * state.cos

    def vertical_momentum(self) -> Ball:
        """Return A psi' sin^2 theta + C r0 cos(theta) (4,3)."""
        ar, state, top = self.ar, self.kind.state, self.top
        around = ar.convert(top.A) * state.psi_rate * state.sin * state.sin
        return around + ar.convert(top.C) * state.r0 * state.cos

    def _torque(self) -> Ball:
        """Return mgs."""
        return self.ar.convert(Fraction(self.top.m) * Fraction(self.top.g) * Fraction(self.top.s))

    def axis_x(self) -> Ball:
        """Return the x part of the figure axis in space."""
        return self.sine * self.ar.sin(self.at.psi)

    def axis_y(self) -> Ball:
        """Return the y part of the figure axis in space."""
        return -self.sine * self.ar.cos(self.at.psi)

    @cached_property
    def turns(self) -> tuple[Ball, Ball]:
        """The arguments of X and Y since the start."""
        return (self.at.psi + self.at.phi) / 2, (self.at.psi - self.at.phi) / 2

    def quaternion_w(self) -> Ball:
        """Return the real part of X = w + i z, of the rotation from body to space."""
        return self.unit[0] * self.ar.cos(self.turns[0])

    def quaternion_x(self) -> Ball:
        """Return the real part of Y = x + i y."""
        return self.unit[1] * self.ar.cos(self.turns[1])

    def quaternion_y(self) -> Ball:
        """Return the imaginary part of Y = x + i y."""
        return self.unit[1] * self.ar.sin(self.turns[1])

    def quaternion_z(self) -> Ball:
        """Return the imaginary part of X = w + i z."""
        return self.unit[0] * self.ar.sin(self.turns[0])
