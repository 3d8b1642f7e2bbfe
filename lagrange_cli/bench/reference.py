"""The definition of error, and a many-digit reference that shares no formula with the program.

Both share only the inputs in a `Top`.  The program uses theta functions about the highest point,
and the arithmetic-geometric mean.  The reference uses Legendre's third integral about the lowest
point, by mpmath's sn, R_F, R_J, K and E, from roots by Viete's cosines:

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

_ROOT_DIGITS = 1000
"""Digits of the roots, because their differences may be as small as 1e-600."""

Many = Any
"""An mpf with many digits."""


class ExactAngles(NamedTuple):
    """The exact tilt, spin and precession at one time (radians, unwrapped), with their rates."""

    theta: Many
    phi: Many
    psi: Many
    theta_rate: Many
    phi_rate: Many
    psi_rate: Many
    tau: Many
    """Time since the nearest whole nutation period."""
    quaternion: tuple[Many, ...]
    """Parts w, x, y, z of the rotation from body to space, continuous from t = 0."""
    turning_rate: Many
    """Bound of the rate of each part of the quaternion: half of the angular velocity."""


def unit(exact: Many, rate: Many, tau: Many) -> float:
    """Return eps (max(1, |exact|) + |tau rate|), the unit of the error of a computed value.

    The second term is the effect of one rounding of the time since the nearest whole period.
    """
    return EPS * float(max(1, abs(exact)) + abs(tau * rate))


def error_in_units(computed: float, exact: Many, rate: Many, tau: Many) -> float:
    """Return the error of one value in units; the error of NaN is infinite."""
    if not math.isfinite(computed):
        return math.inf
    return float(abs(mpmath.mpf(computed) - exact)) / unit(exact, rate, tau)


def angle_differences(
    angles: Sequence[Any], exact: ExactAngles, *, whole_turns: bool = True
) -> list[float]:
    """Return |computed - exact| of tilt, spin and precession, in radians.

    The difference of NaN is infinite.  Without `whole_turns`, spin and precession count modulo 2
    pi.
    """
    with mpmath.workdps(80):  # more digits than the numbers have
        away = [mpmath.mpf(x) - true for x, true in zip(angles, exact[:3], strict=True)]
        if not whole_turns:
            turn = 2 * mpmath.pi
            away[1:] = [x - turn * mpmath.nint(x / turn) for x in away[1:]]
        return [float(abs(x)) if mpmath.isfinite(x) else math.inf for x in away]


def angle_units(
    angles: Sequence[Any], exact: ExactAngles, *, whole_turns: bool = True
) -> list[float]:
    """Return the errors of tilt, spin and precession in units (see `angle_differences`)."""
    differences = angle_differences(angles, exact, whole_turns=whole_turns)
    return [
        difference / unit(true, rate, exact.tau)
        for difference, true, rate in zip(differences, exact[:3], exact[3:6], strict=True)
    ]


def quaternion_units(parts: Sequence[float], exact: ExactAngles) -> float:
    """Return the worst error of the parts w, x, y, z in units; a wrong sign is an error."""
    return max(
        error_in_units(part, true, exact.turning_rate, exact.tau)
        for part, true in zip(parts, exact.quaternion, strict=True)
    )


def quaternion(cos_half: Many, sin_half: Many, plus: Many, minus: Many) -> tuple[Many, ...]:
    """Return the parts w, x, y, z, from theta/2 and plus or minus = (psi +- phi)/2."""
    return (
        cos_half * mpmath.cos(plus),
        sin_half * mpmath.cos(minus),
        sin_half * mpmath.sin(minus),
        cos_half * mpmath.sin(plus),
    )


def key_ulps(computed: float, exact: Many, digits: int) -> float:
    """Return |computed - exact| over the gap between doubles there; at most 1/2 for the nearest.

    The gap is the one on the side of the exact value, which has `digits` digits.
    """
    with mpmath.workdps(digits):
        away = exact - mpmath.mpf(computed)
        beyond = math.nextafter(computed, math.inf if away > 0 else -math.inf)
        return float(abs(away) / abs(mpmath.mpf(beyond) - mpmath.mpf(computed)))


def _three_real_roots(c2: Many, c1: Many, c0: Many) -> list[Many]:
    """Return the roots of u^3 + c2 u^2 + c1 u + c0 = 0, in order, by Viete's cosines."""
    shift, p = c2 / 3, c1 - c2**2 / 3
    size = 2 * mpmath.sqrt(-p / 3)
    q = 2 * shift**3 - shift * c1 + c0
    third = mpmath.acos(max(-1, min(1, 3 * q / (p * size)))) / 3
    return sorted(size * mpmath.cos(third - k * 2 * mpmath.pi / 3) - shift for k in range(3))


class Reference:
    """The exact motion of a top that nutates under a torque."""

    def __init__(self, top: Top, digits: int = 50) -> None:
        """Raise LagtopError for a top that does not nutate."""
        self.digits = digits
        with mpmath.workdps(max(2 * digits, _ROOT_DIGITS)):  # for differences of roots
            self._roots(top)
        with mpmath.workdps(digits):
            self.speed = mpmath.sqrt(self.a * self.u3_u2) / 2
            self.m, self.mc = self.band / self.u3_u2, self.u3_u1 / self.u3_u2
            self.K = mpmath.ellipk(self.m)
            self.T = 2 * self.K / self.speed
            self.w0 = self._argument(mpmath.sign(mpmath.mpf(top.thetadot0)))
            self.wholes = [
                self._legendre(at_u1 / at_u2, 1, 0, self.mc) for at_u1, at_u2 in self.gaps
            ]
            self.start = self._halves(mpmath.mpf(0))

    def _roots(self, top: Top) -> None:
        """Set the constants, the roots, and all differences that may cancel."""
        body = (top.m, top.A, top.C, top.s, top.g, top.r0)
        m, A, C, s, g, r0 = (mpmath.mpf(x) for x in body)
        self.r0, self.a, self.b = r0, 2 * m * g * s / A, C * r0 / A
        tilt = mpmath.mpf(top.theta0_rad or 0)
        if top.theta0_deg is not None:
            tilt = mpmath.mpf(top.theta0_deg) * mpmath.pi / 180
        self.tilt, u0 = tilt, mpmath.cos(tilt)
        self.psi_rate, self.at_rest = mpmath.mpf(top.psidot0), top.is_released
        around = self.psi_rate * mpmath.sin(tilt) ** 2
        beta = around + self.b * u0
        alpha = mpmath.mpf(top.thetadot0) ** 2 + around * self.psi_rate + self.a * u0
        if not self.a:
            raise LagtopError("the reference needs a torque")
        u2, u1, u3 = _three_real_roots(
            -(alpha + self.b**2) / self.a,
            2 * self.b * beta / self.a - 1,
            (alpha - beta**2) / self.a,
        )
        near_u1 = abs(u0 - u1) < abs(u0 - u2)
        self.starts_highest = near_u1 and not top.thetadot0
        self.starts_lowest = not (near_u1 or top.thetadot0)
        if not top.thetadot0:  # the start is a root, to all digits
            u1, u2 = (u0, u2) if near_u1 else (u1, u0)
        self.u1, self.u2, self.u3 = u1, u2, u3
        self.band, self.u3_u1, self.u3_u2 = u1 - u2, u3 - u1, u3 - u2
        self.gaps = (1 + u1, 1 + u2), (1 - u1, 1 - u2)
        """1 + u and 1 - u at u1 and at u2."""
        self.from_poles = beta + self.b, beta - self.b
        self.drift = (r0 - self.b) / 2
        self.spin_start = r0 - self.psi_rate * u0
        self.of_start = u0 - u2, u1 - u0, u3 - u0

    def _argument(self, theta_sign: Many) -> Many:
        """Return w at t = 0, negative (before the lowest point) while the tilt grows."""
        from_u2, to_u1, to_u3 = self.of_start
        s2, c2, d2 = from_u2 / self.band, to_u1 / self.band, to_u3 / self.u3_u2
        w = mpmath.sqrt(s2) * mpmath.elliprf(max(c2, 0), d2, 1)
        return -w if theta_sign > 0 else w

    def _jacobi(self, t: Many) -> tuple[Many, ...]:
        """Return the half periods until a time, and sn, cn, dn of the remaining argument."""
        w = self.w0 + self.speed * t
        turns = mpmath.nint(w / (2 * self.K))
        rest = w - 2 * turns * self.K
        return turns, *(mpmath.ellipfun(f, rest, m=self.m) for f in ("sn", "cn", "dn"))

    def _halves(self, t: Many) -> tuple[Many, Many]:
        """Return (psi + phi)/2 and (psi - phi)/2, up to their values at t = 0."""
        (turns, sn, cn, dn), drift = self._jacobi(t), self.drift * t
        plus, minus = (
            momentum
            / 2
            * (2 * turns * whole + self._legendre(at_u1 / at_u2, sn, cn**2, dn**2))
            / (at_u2 * self.speed)
            for momentum, (at_u1, at_u2), whole in zip(
                self.from_poles, self.gaps, self.wholes, strict=True
            )
        )
        return drift + plus, -drift + minus

    def _legendre(self, rest: Many, sn: Many, cn2: Many, dn2: Many) -> Many:
        """Return Legendre's Pi, the integral of dw/(1 - n sn^2 w) from 0, with rest = 1 - n."""
        part = (1 - rest) / 3 * sn**2 * mpmath.elliprj(cn2, dn2, 1, cn2 + rest * sn**2)
        return sn * (mpmath.elliprf(cn2, dn2, 1) + part)

    def at(self, t: float) -> ExactAngles:
        """Return the exact angles and rates at a time."""
        with mpmath.workdps(self.digits):
            time = mpmath.mpf(t)
            _, sn, cn, dn = self._jacobi(time)
            halves = zip(self._halves(time), self.start, strict=True)
            below, above = (at_u1 * sn**2 + at_u2 * cn**2 for at_u1, at_u2 in self.gaps)
            theta = 2 * mpmath.atan2(mpmath.sqrt(above), mpmath.sqrt(below))
            plus, minus = (now - then for now, then in halves)
            sine2 = below * above
            south, north = self.from_poles[0] / below / 2, self.from_poles[1] / above / 2
            psi_rate = south + north
            theta_rate = -2 * self.band * sn * cn * dn * self.speed / mpmath.sqrt(sine2)
            x, y = mpmath.sqrt(below / 2), mpmath.sqrt(above / 2)
            return ExactAngles(
                theta=theta,
                phi=plus - minus,
                psi=plus + minus,
                theta_rate=theta_rate,
                phi_rate=2 * self.drift + south - north,
                psi_rate=psi_rate,
                tau=time - mpmath.nint(time / self.T) * self.T,
                quaternion=quaternion(x, y, plus, minus),
                turning_rate=mpmath.sqrt(theta_rate**2 + psi_rate**2 * sine2 + self.r0**2) / 2,
            )

    def record(self) -> dict[str, Many]:
        """Return the exact value of every number of the record; None if the motion has none."""
        with mpmath.workdps(self.digits):
            plus, minus = (
                last - first for last, first in zip(self._halves(self.T), self.start, strict=True)
            )
            spin, precession = (plus - minus) / self.T, (plus + minus) / self.T
            half, K_prime = self.at(self.T / 2), mpmath.ellipk(self.mc)
            return self._turning_points() | {
                **{name: getattr(self, name) for name in ("a", "b", "u1", "u2", "u3", "K")},
                "k": mpmath.sqrt(self.m),
                "k_prime": mpmath.sqrt(self.mc),
                "modular_angle_deg": mpmath.degrees(mpmath.asin(mpmath.sqrt(self.m))),
                "nome": mpmath.exp(-mpmath.pi * K_prime / self.K),
                "K_prime": K_prime,
                "E": mpmath.ellipe(self.m),
                "T_nutation": self.T,
                "T_spin": 2 * mpmath.pi / abs(spin),
                "T_precession": 2 * mpmath.pi / abs(precession),
                "mean_spin_rate": spin,
                "mean_precession_rate": precession,
                "spin_rate_start": self.spin_start,
                "spin_rate_half": half.phi_rate,
                "precession_rate_start": self.psi_rate,
                "precession_rate_half": half.psi_rate,
            }

    def _turning_points(self) -> dict[str, Many]:
        """Return the tilts, u(T/4) of a start at the highest point, and (7,2) of one at rest."""
        at_rest, highest = self.at_rest, self.starts_highest
        amplitude = mpmath.asin(mpmath.sqrt(self.u3_u2 / (self.u3 + 1)))
        quarter = mpmath.ellipfun("sn", self.K / 2, m=self.m)
        at_u1, at_u2 = (
            2 * mpmath.atan2(mpmath.sqrt(above), mpmath.sqrt(below))
            for below, above in zip(*self.gaps, strict=True)
        )
        least = self.tilt if highest else at_u1
        most = self.tilt if self.starts_lowest else at_u2
        return {
            "theta_min_deg": mpmath.degrees(least),
            "theta_max_deg": mpmath.degrees(most),
            "u_quarter": self.u2 + self.band * quarter**2 if highest else None,
            "amplitude_deg": mpmath.degrees(amplitude) if at_rest else None,
            "alpha": mpmath.ellipf(amplitude, self.mc) if at_rest else None,
        }
