"""The definition of error, and the exact attitude in 50 digits of mpmath.

The reference shares only Viete's cosines for the roots with lagtop, which uses theta functions
counted from the highest point and the arithmetic-geometric mean.  It uses mpmath's sn, cn and dn
counted from the lowest point, and Legendre's third integral by Carlson's R_F and R_J:

    u = u2 + (u1 - u2) sn^2 w,  w = sqrt(a (u3 - u2)) (t - t2)/2,
    (psi +- phi)/2 = +-(r0 - b) t/2 + (beta +- b)/2 * integral of dt / (1 +- u).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import mpmath

from ..errors import LagtopError
from ..solver.facts import Regime
from ..solver.solve import Motion
from ..top.top import Top

DIGITS, ROOT_DIGITS = 50, 1000
"""Digits of the motion, and of the roots: differences of roots may be as small as 1e-600."""

Many = Any
"""A number of mpmath."""
Quaternion = tuple[Many, ...]
"""The parts w, x, y, z of the rotation from body to space."""


def _exact(x: Fraction) -> Many:
    return mpmath.mpf(x.numerator) / x.denominator


def rotation_angle(computed: Sequence[Any], exact: Quaternion) -> float:
    """Return the angle (rad) of the rotation from an exact to a computed attitude.

    This is the definition of error in all reports.  The computed quaternion may have any norm and
    either sign.  Its angle is infinite if a part is not finite.
    """
    with mpmath.workdps(DIGITS):
        w, x, y, z = map(mpmath.mpf, computed)
        a, b, c, d = exact
        along = a * w + b * x + c * y + d * z
        i, j, k = a * x - b * w, a * y - c * w, a * z - d * w
        across = i - c * z + d * y, j - d * x + b * z, k - b * y + c * x
        angle = float(2 * mpmath.atan2(mpmath.norm(across), abs(along)))
    return angle if math.isfinite(angle) else math.inf


def viete_roots(c2: Many, c1: Many, c0: Many) -> list[Many]:
    """Return the three real roots of u^3 + c2 u^2 + c1 u + c0 = 0, in increasing order."""
    shift, p = c2 / 3, c1 - c2**2 / 3
    size = 2 * mpmath.sqrt(-p / 3)
    q = 2 * shift**3 - shift * c1 + c0
    third = mpmath.acos(max(-1, min(1, 3 * q / (p * size)))) / 3
    return sorted(size * mpmath.cos(third - k * 2 * mpmath.pi / 3) - shift for k in range(3))


class Reference:
    """The exact motion of a top that nutates under a torque."""

    def __init__(self, top: Top) -> None:
        """Compute the roots and the start of a top, from its exact inputs."""
        with mpmath.workdps(ROOT_DIGITS):  # differences of roots may cancel
            tilt, spin = top.exact_tilt, top.exact_spin
            names = ("m", "A", "C", "s", "g", "thetadot0", "psidot0")
            m, A, C, s, g, theta_rate, psi_rate = (_exact(top.exact(name)) for name in names)
            degree = mpmath.mpf(1) if tilt.degrees is None else mpmath.pi / 180
            theta = _exact(tilt.number) * degree
            u0 = mpmath.cos(theta)
            r0 = _exact(spin.constant) + _exact(spin.share) * psi_rate * u0
            a, b = 2 * m * g * s / A, C * r0 / A
            around = psi_rate * mpmath.sin(theta) ** 2
            beta, alpha = around + b * u0, theta_rate**2 + around * psi_rate + a * u0
            cubic = -(alpha + b**2) / a, 2 * b * beta / a - 1, (alpha - beta**2) / a
            u2, u1, u3 = viete_roots(*cubic)
            if not theta_rate:  # the start is a root, to all digits
                u1, u2 = (u0, u2) if abs(u0 - u1) < abs(u0 - u2) else (u1, u0)
            band, u3_u2 = u1 - u2, u3 - u2
            self.k2, self.k2_prime = band / u3_u2, (u3 - u1) / u3_u2
            self.gaps = (1 + u1, 1 + u2), (1 - u1, 1 - u2)
            self.momenta, self.drift = (beta + b, beta - b), (r0 - b) / 2
            sn2, cn2, dn2 = (u0 - u2) / band, (u1 - u0) / band, (u3 - u0) / u3_u2
        with mpmath.workdps(DIGITS):
            self.speed, self.K = mpmath.sqrt(a * u3_u2) / 2, mpmath.ellipk(self.k2)
            self.T = 2 * self.K / self.speed
            sign = -1 if theta_rate > 0 else 1  # the tilt grows towards u2, where w = 0
            self.w0 = sign * mpmath.sqrt(sn2) * mpmath.elliprf(max(cn2, 0), dn2, 1)
            self.wholes = [self._third(x1 / x2, 1, 0, self.k2_prime) for x1, x2 in self.gaps]
            self.start = self._state(mpmath.mpf(0))[2:]

    def _third(self, rest: Many, sn: Many, cn2: Many, dn2: Many) -> Many:
        """Return Legendre's third integral of dw/(1 - n sn^2 w) from 0, with rest = 1 - n."""
        part = (1 - rest) / 3 * sn**2 * mpmath.elliprj(cn2, dn2, 1, cn2 + rest * sn**2)
        return sn * (mpmath.elliprf(cn2, dn2, 1) + part)

    def _state(self, t: Many) -> tuple[Many, ...]:
        """Return sn and cn, and (psi + phi)/2 and (psi - phi)/2 up to their values at t = 0."""
        w, drift = self.w0 + self.speed * t, self.drift * t
        turns = mpmath.nint(w / (2 * self.K))
        rest = w - 2 * turns * self.K
        sn, cn, dn = (mpmath.ellipfun(f, rest, m=self.k2) for f in ("sn", "cn", "dn"))
        halves = []
        for momentum, (x1, x2), whole in zip(self.momenta, self.gaps, self.wholes, strict=True):
            integral = 2 * turns * whole + self._third(x1 / x2, sn, cn**2, dn**2)
            halves.append(momentum / 2 * integral / (x2 * self.speed))
        return sn, cn, halves[0] + drift, halves[1] - drift

    def attitude(self, t: Many) -> Quaternion:
        """Return the attitude at a time, which is on the line of nodes at t = 0."""
        with mpmath.workdps(DIGITS):
            sn, cn, *halves = self._state(mpmath.mpf(t))
            cos, sin = (mpmath.sqrt((x1 * sn**2 + x2 * cn**2) / 2) for x1, x2 in self.gaps)
            plus, minus = map(mpmath.fsub, halves, self.start)
            upright = cos * mpmath.cos(plus), cos * mpmath.sin(plus)
            return upright[0], sin * mpmath.cos(minus), sin * mpmath.sin(minus), upright[1]


def check(motion: Motion) -> None:
    """Raise LagtopError for a motion that the reference cannot compute."""
    if motion.regime not in (Regime.REGULAR, Regime.NO_SPIN):
        raise LagtopError(f"the top must nutate, but its regime is {motion.regime.value!r}")
    if not motion.facts.off_poles:
        raise LagtopError("the axis must not pass exactly through the vertical")


def exact_motion(motion: Motion) -> Reference:
    """Return the reference of a motion.  Raises LagtopError (see `check`)."""
    check(motion)
    return Reference(motion.top)
