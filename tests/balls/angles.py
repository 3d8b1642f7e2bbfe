"""Angles, rates and attitude of one motion at any time, in balls."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

from flint import acb, arb

from balls.constants import Constants
from balls.scene import Undecided, exact_arb, middle


class State(NamedTuple):
    """An instant: angles in radians from 0 at the start, their rates, attitude and phase."""

    theta: arb
    phi: arb
    psi: arb
    theta_rate: arb
    phi_rate: arb
    psi_rate: arb
    tau: arb
    """Time since the nearest whole period."""
    quaternion: tuple[arb, arb, arb, arb]
    """w, x, y, z, from body to space, continuous from t = 0."""
    quaternion_rate: arb
    """Bound of the rate of its parts."""


class Moving(Constants):
    """The motion over time."""

    @property
    def starts_at(self) -> int:
        """1 where the start is the highest point, -1 where it is the lowest, else 0."""
        if self.scene.theta_rate and not self.facts.pole:
            return 0
        return 1 if abs(self.u0 - self.u1).mid() < abs(self.u0 - self.u2).mid() else -1

    @cached_property
    def w0(self) -> arb:
        """w at the start: negative while the tilt grows."""
        if self.starts_at:
            return -self.K if self.starts_at > 0 else arb(0)
        s2 = (self.u0 - self.u2) / self.band
        c2 = (self.u1 - self.u0) / self.band
        if not (s2 > 0 and c2 > 0):
            raise Undecided("the phase of the start")
        amplitude = arb.atan2(s2.sqrt(), c2.sqrt())
        w = acb.elliptic_f(acb(amplitude), acb(self.m)).real
        return -w if self.scene.theta_rate > 0 else w

    def _jacobi(self, rest: arb) -> tuple[arb, arb, arb]:
        """Return sn, cn, dn."""
        if self.K_prime is None:
            return rest.sin(), rest.cos(), arb(1)
        tau = acb(0, self.K_prime / self.K)
        zero = [theta.real for theta in acb.modular_theta(acb(0), tau)]
        here = [theta.real for theta in acb.modular_theta(acb(rest / (2 * self.K)), tau)]
        _, two, three, four = zero
        return (
            three / two * (here[0] / here[3]),
            four / two * (here[1] / here[3]),
            four / three * (here[2] / here[3]),
        )

    def _third(self, sign: int, amplitude: arb, turns: int) -> arb:
        """Return the integral of dt/(1 + sign u) from the lowest point: Legendre's Pi."""
        at_u2 = 1 + sign * self.u2
        n, m = acb(-sign * self.band / at_u2), acb(self.m)
        part = acb.elliptic_pi_inc(n, acb(amplitude), m).real
        if turns:
            part += 2 * turns * self.whole(sign)
        return part / (at_u2 * self.speed)

    def whole(self, sign: int) -> arb:
        """Return the complete integral."""
        key = "_whole_south" if sign > 0 else "_whole_north"
        if key not in self.__dict__:
            n = acb(-sign * self.band / (1 + sign * self.u2))
            self.__dict__[key] = acb.elliptic_pi(n, acb(self.m)).real
        whole: arb = self.__dict__[key]
        return whole

    def _south(self, w: arb, amplitude: arb, turns: int) -> arb:
        """Return the integral of (beta + b)/2/(1 + u), or the half turns at the lower pole."""
        if not self.passes_bottom:
            return self.from_minus_b / 2 * self._third(1, amplitude, turns)
        return arb.pi() * floor_of(w / (2 * self.K))

    def _north(self, w: arb, amplitude: arb, turns: int) -> arb:
        """Return the integral of (beta - b)/2/(1 - u), or the half turns at the upper pole."""
        if not self.passes_top:
            return self.from_b / 2 * self._third(-1, amplitude, turns)
        return arb.pi() * floor_of((w / self.K + 1) / 2)

    @cached_property
    def _start(self) -> tuple[arb, arb]:
        """Both integrals at the start; a pole there was passed just before where it is left."""
        half = arb.pi() / 2
        if not self.starts_at:
            sn, cn, _ = self._jacobi(self.w0)
            amplitude = arb.atan2(sn, cn)
            return self._south(self.w0, amplitude, 0), self._north(self.w0, amplitude, 0)
        if self.starts_at < 0:
            early = -arb.pi() if self.scene.theta_rate > 0 else arb(0)
            return early if self.passes_bottom else arb(0), arb(0)
        south, north = -arb.pi() if self.passes_bottom else self._at_top(1), self._at_top(-1)
        if self.passes_top:
            north = -2 * half if self.scene.theta_rate < 0 else arb(0)
        return south, north

    def _at_top(self, sign: int) -> arb:
        """Return an integral at w = -K."""
        if sign < 0 and self.passes_top:
            return arb(0)
        factor = (self.from_minus_b if sign > 0 else self.from_b) / 2
        return -factor * self.whole(sign) / ((1 + sign * self.u2) * self.speed)

    def at(self, t: Fraction) -> State:
        """Return the motion at a time."""
        if self.facts.steady:
            return self._steady(exact_arb(t))
        if self.facts.separatrix:
            return self._separatrix(t)
        if t == 0:
            return self._at_start()
        time = exact_arb(t)
        _, rest = self._phase(time)
        sn, cn, dn = self._jacobi(rest)
        halves = self.halves_at(time)
        below, above = self.below_u2 + self.band * sn**2, self.above_u1 + self.band * cn**2
        swing = -2 * self.band * sn * cn * dn * self.speed
        periods = nearest(time / self.T)
        return self._state(halves, (below, above), swing, time - periods * self.T)

    def _phase(self, time: arb) -> tuple[int, arb]:
        """Return the half periods passed at a time, and the rest of w."""
        w = self.w0 + self.speed * time
        turns = nearest(w / (2 * self.K))
        return turns, w - 2 * turns * self.K

    def halves_at(self, time: arb) -> tuple[arb, arb]:
        """Return (psi + phi)/2 and (psi - phi)/2 at a time."""
        turns, rest = self._phase(time)
        sn, cn, _ = self._jacobi(rest)
        w, amplitude = rest + 2 * turns * self.K, arb.atan2(sn, cn)
        south, north = self._south(w, amplitude, turns), self._north(w, amplitude, turns)
        drift = (self.r0 - self.b) * time / 2
        return drift + south - self._start[0], -drift + north - self._start[1]

    def _at_start(self) -> State:
        """Return the start."""
        x, y = self._half_tilt()
        swing = self.rise * self.sine2.sqrt()
        return self._state((arb(0), arb(0)), (2 * x**2, 2 * y**2), swing, arb(0))

    def _half_tilt(self) -> tuple[arb, arb]:
        """Return cosine and sine of half the tilt."""
        cosine = arb(0) if self.facts.pole < 0 else (self.tilt / 2).cos()
        return cosine, (self.tilt / 2).sin()

    def _state(self, halves: tuple[arb, arb], gaps: tuple[arb, arb], swing: arb, tau: arb) -> State:
        """Return the state from (psi +- phi)/2, 1 +- u and -du/dt."""
        (plus, minus), (below, above), zero = halves, gaps, arb(0)
        south = zero if self.from_minus_b.is_zero() else self.from_minus_b / 2 / below
        north = zero if self.from_b.is_zero() else self.from_b / 2 / above
        sine = (below * above).sqrt()
        x, y = (below / 2).sqrt(), (above / 2).sqrt()
        theta_rate = swing / sine if sine > 0 else abs(self.rise)
        turn = south + north
        return State(
            theta=2 * arb.atan2(y, x),
            phi=plus - minus,
            psi=plus + minus,
            theta_rate=theta_rate,
            phi_rate=self.r0 - self.b + south - north,
            psi_rate=turn,
            tau=tau,
            quaternion=(x * plus.cos(), y * minus.cos(), y * minus.sin(), x * plus.sin()),
            quaternion_rate=(theta_rate**2 + (turn * sine) ** 2 + self.r0**2).sqrt() / 2,
        )

    def _steady(self, time: arb) -> State:
        """Return constant rates; on the vertical all of the rotation counts as spin."""
        turn = arb(0) if self.facts.pole else self.turn
        spin = self.r0 - turn * self.u0
        plus, minus = (turn + spin) * time / 2, (turn - spin) * time / 2
        x, y = self._half_tilt()
        return State(
            theta=self.tilt,
            phi=spin * time,
            psi=turn * time,
            theta_rate=arb(0),
            phi_rate=spin,
            psi_rate=turn,
            tau=time,
            quaternion=(x * plus.cos(), y * minus.cos(), y * minus.sin(), x * plus.sin()),
            quaternion_rate=(turn**2 * self.sine2 + self.r0**2).sqrt() / 2,
        )

    def _separatrix(self, t: Fraction) -> State:
        """Return the swing 1 - u = (1 - u2)/cosh^2 h, whose third integral is an arctangent."""
        time, q = exact_arb(t), 1 - self.u2
        speed = (self.a * q).sqrt() / 2
        h0 = arb(0)
        if self.scene.theta_rate:
            h0 = (q / (1 - self.u0)).sqrt().acosh()
            h0 = -h0 if self.scene.theta_rate > 0 else h0
        h = h0 + speed * time

        def south(value: arb) -> arb:
            if self.passes_bottom:  # b = 0: half a turn at the lowest point
                return arb.pi() / 2 * (1 if value > 0 else -1)
            angle = (value.tanh() * (q / self.below_u2).sqrt()).atan()
            return self.b * (angle * (q / self.below_u2).sqrt() / (2 * speed))

        first = south(h0) if self.scene.theta_rate or not self.passes_bottom else arb(0)
        if self.passes_bottom and not self.scene.theta_rate:
            raise Undecided("a start on the pole")
        swing = south(h) - first if t else arb(0)
        drift = (self.r0 - self.b) * time / 2
        halves = drift + self.b * time / 2 + swing, -drift
        above = q / h.cosh() ** 2
        below = self.below_u2 + q * h.tanh() ** 2
        return self._state(halves, (below, above), -2 * speed * above * h.tanh(), time)


def nearest(value: arb) -> int:
    """Return a whole number next to a ball."""
    if not value.is_finite():
        raise Undecided("a number of periods")
    return round(middle(value))


def floor_of(value: arb) -> int:
    whole = value.floor().unique_fmpz() if value.is_finite() else None
    if whole is None:
        raise Undecided("a side of a pole")
    return int(whole)
