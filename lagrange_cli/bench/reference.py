"""The one definition of error, and a many-digit reference that shares no formula with the program.

Where the program uses theta functions about the highest point, the reference uses Legendre's third
integral about the lowest, by mpmath's sn, R_F and R_J, from roots by Viete's cosines:

    u = u2 + (u1 - u2) sn^2 w,  w = sqrt(a (u3 - u2)) (t - t2)/2,
    (psi +- phi)/2 = +-(r0 - b) t/2 + (beta +- b)/2 * integral of dt / (1 +- u).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import mpmath

from ..errors import LagtopError
from ..inputs.top import Top

EPS = 2.0**-52

Many = Any
"""An mpf with many digits."""


class Exact(NamedTuple):
    """Tilt, spin and precession at one time (radians, unwrapped), and their rates."""

    theta: Many
    phi: Many
    psi: Many
    theta_rate: Many
    phi_rate: Many
    psi_rate: Many
    tau: Many
    """The time reduced to the nearest multiple of the nutation period."""


def unit(exact: Many, rate: Many, tau: Many) -> float:
    """eps (max(1, |exact|) + |tau rate|), what the error of a computed value is counted in.

    The second term is what one rounding of the time, less whole periods, does.
    """
    return EPS * float(max(1, abs(exact)) + abs(tau * rate))


def units(computed: float, exact: Many, rate: Many, tau: Many) -> float:
    """The error of one value in units; not a number counts as infinite."""
    if not math.isfinite(computed):
        return math.inf
    return float(abs(mpmath.mpf(computed) - exact)) / unit(exact, rate, tau)


def angle_differences(
    angles: Sequence[Any], exact: Exact, *, whole_turns: bool = True
) -> tuple[float, float, float]:
    """|computed - exact| of tilt, spin and precession, in radians.

    Not a number counts as infinite.  Without `whole_turns`, spin and precession count modulo 2 pi.
    """
    with mpmath.workdps(80):  # more than what is compared: nothing is lost in the differences
        theta, phi, psi = (
            mpmath.mpf(x) - true if mpmath.isfinite(x) else mpmath.inf
            for x, true in zip(angles, exact[:3], strict=True)
        )
        if not whole_turns:
            phi, psi = (_less_turns(x) for x in (phi, psi))
        return float(abs(theta)), float(abs(phi)), float(abs(psi))


def _less_turns(angle: Many) -> Many:
    turn = 2 * mpmath.pi
    return angle - turn * mpmath.nint(angle / turn) if mpmath.isfinite(angle) else angle


def angle_units(
    angles: Sequence[Any], exact: Exact, *, whole_turns: bool = True
) -> tuple[float, float, float]:
    """The same in units."""
    differences = angle_differences(angles, exact, whole_turns=whole_turns)
    theta, phi, psi = (
        difference / unit(true, rate, exact.tau)
        for difference, true, rate in zip(differences, exact[:3], exact[3:6], strict=True)
    )
    return theta, phi, psi


class _Jacobi(NamedTuple):
    """Half periods passed, and sn, cn, dn of the rest."""

    turns: Many
    sn: Many
    cn: Many
    dn: Many


def _three_real_roots(c2: Many, c1: Many, c0: Many) -> list[Many]:
    """Of u^3 + c2 u^2 + c1 u + c0 = 0, in order, by Viete's cosines."""
    shift, p = c2 / 3, c1 - c2**2 / 3
    size = 2 * mpmath.sqrt(-p / 3)
    q = 2 * shift**3 - shift * c1 + c0
    third = mpmath.acos(max(-1, min(1, 3 * q / (p * size)))) / 3
    return sorted(size * mpmath.cos(third - k * 2 * mpmath.pi / 3) - shift for k in range(3))


class Reference:
    """The exact motion of a nutating top."""

    def __init__(self, top: Top, digits: int = 50) -> None:
        """Raise LagtopError for a top that does not nutate."""
        self.digits = digits
        with mpmath.workdps(2 * digits):  # a double root takes half of them
            self._constants(top)

    def _constants(self, top: Top) -> None:
        body = (top.m, top.A, top.C, top.s, top.g, top.r0)
        m, A, C, s, g, r0 = (mpmath.mpf(x) for x in body)
        self.r0, self.a, self.b = r0, 2 * m * g * s / A, C * r0 / A
        tilt = mpmath.mpf(top.theta0_rad or 0)
        if top.theta0_deg is not None:
            tilt = mpmath.mpf(top.theta0_deg) * mpmath.pi / 180
        self.u0 = mpmath.cos(tilt)
        around = mpmath.mpf(top.psidot0) * mpmath.sin(tilt) ** 2
        self.beta = around + self.b * self.u0
        energy = mpmath.mpf(top.thetadot0) ** 2 + around * mpmath.mpf(top.psidot0)
        alpha = energy + self.a * self.u0
        if not self.a:
            raise LagtopError("the reference needs a torque")
        self.u2, self.u1, self.u3 = _three_real_roots(
            -(alpha + self.b**2) / self.a,
            2 * self.b * self.beta / self.a - 1,
            (alpha - self.beta**2) / self.a,
        )
        if not top.thetadot0:  # the start is a root, to all digits
            near_u1 = abs(self.u0 - self.u1) < abs(self.u0 - self.u2)
            self.u1, self.u2 = (self.u0, self.u2) if near_u1 else (self.u1, self.u0)
        self.speed = mpmath.sqrt(self.a * (self.u3 - self.u2)) / 2
        self.m = (self.u1 - self.u2) / (self.u3 - self.u2)
        self.K = mpmath.ellipk(self.m)
        self.T = 2 * self.K / self.speed
        self.w0 = self._argument(self.u0, mpmath.sign(mpmath.mpf(top.thetadot0)))
        self.start = self._halves(mpmath.mpf(0))

    def _argument(self, u: Many, theta_sign: Many) -> Many:
        """w at t = 0: before the lowest point while the tilt grows."""
        s2 = (u - self.u2) / (self.u1 - self.u2)
        c2, d2 = (self.u1 - u) / (self.u1 - self.u2), (self.u3 - u) / (self.u3 - self.u2)
        w = mpmath.sqrt(s2) * mpmath.elliprf(max(c2, 0), d2, 1)
        return -w if theta_sign > 0 else w

    def _jacobi(self, t: Many) -> _Jacobi:
        w = self.w0 + self.speed * t
        turns = mpmath.nint(w / (2 * self.K))
        rest = w - 2 * turns * self.K
        return _Jacobi(turns, *(mpmath.ellipfun(f, rest, m=self.m) for f in ("sn", "cn", "dn")))

    def _halves(self, t: Many) -> tuple[Many, Many]:
        """(psi + phi)/2 and (psi - phi)/2, but for their start."""
        now, drift = self._jacobi(t), (self.r0 - self.b) * t / 2
        plus = self._third(1 + self.u2, -(self.u1 - self.u2), now)
        minus = self._third(1 - self.u2, self.u1 - self.u2, now)
        return (
            drift + (self.beta + self.b) / 2 * plus,
            -drift + (self.beta - self.b) / 2 * minus,
        )

    def _third(self, gap: Many, slope: Many, now: _Jacobi) -> Many:
        """Integral of dw / (gap - slope sn^2) over the speed: Legendre's Pi with n = slope/gap."""
        n, sn2, cn2, dn2 = slope / gap, now.sn**2, now.cn**2, now.dn**2
        whole = self.K + n / 3 * mpmath.elliprj(0, 1 - self.m, 1, 1 - n)
        part = mpmath.elliprf(cn2, dn2, 1) + n / 3 * sn2 * mpmath.elliprj(cn2, dn2, 1, 1 - n * sn2)
        return (2 * now.turns * whole + now.sn * part) / (gap * self.speed)

    def at(self, t: float) -> Exact:
        """The exact angles and rates at a time."""
        with mpmath.workdps(self.digits):
            time = mpmath.mpf(t)
            _, sn, cn, dn = self._jacobi(time)
            halves = zip(self._halves(time), self.start, strict=True)
            band = self.u1 - self.u2
            u = self.u2 + band * sn**2
            below, above = (1 + self.u2) + band * sn**2, (1 - self.u2) - band * sn**2
            theta = 2 * mpmath.atan2(mpmath.sqrt(above), mpmath.sqrt(below))
            plus, minus = (now - then for now, then in halves)
            sine2 = below * above
            psi_rate = (self.beta - self.b * u) / sine2
            return Exact(
                theta=theta,
                phi=plus - minus,
                psi=plus + minus,
                theta_rate=-2 * band * sn * cn * dn * self.speed / mpmath.sqrt(sine2),
                phi_rate=self.r0 - psi_rate * u,
                psi_rate=psi_rate,
                tau=time - mpmath.nint(time / self.T) * self.T,
            )

    def record(self) -> dict[str, Many]:
        """Exact values of the keys that a general start has."""
        with mpmath.workdps(self.digits):
            first, last = (self._halves(t) for t in (mpmath.mpf(0), self.T))
            plus, minus = (last[i] - first[i] for i in range(2))
            spin, precession = (plus - minus) / self.T, (plus + minus) / self.T
            K_prime = mpmath.ellipk(1 - self.m)
            start, half = self.at(mpmath.mpf(0)), self.at(self.T / 2)
            return {
                "u1": self.u1,
                "u2": self.u2,
                "u3": self.u3,
                "k": mpmath.sqrt(self.m),
                "k_prime": mpmath.sqrt((self.u3 - self.u1) / (self.u3 - self.u2)),
                "modular_angle_deg": mpmath.degrees(mpmath.asin(mpmath.sqrt(self.m))),
                "nome": mpmath.exp(-mpmath.pi * K_prime / self.K),
                "K": self.K,
                "K_prime": K_prime,
                "E": mpmath.ellipe(self.m),
                "T_nutation": self.T,
                "T_spin": 2 * mpmath.pi / abs(spin),
                "T_precession": 2 * mpmath.pi / abs(precession),
                "theta_min_deg": mpmath.degrees(mpmath.acos(self.u1)),
                "theta_max_deg": mpmath.degrees(mpmath.acos(self.u2)),
                "mean_spin_rate": spin,
                "mean_precession_rate": precession,
                "spin_rate_start": start.phi_rate,
                "spin_rate_half": half.phi_rate,
                "precession_rate_start": start.psi_rate,
                "precession_rate_half": half.psi_rate,
            }
