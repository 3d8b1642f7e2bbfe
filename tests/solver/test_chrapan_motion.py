"""Chrapan's sections 4 to 8, equation by equation, for tops of both directions of spin.

On one side stand the angles and the record of the program in 150 digits; on the other definitions:
the rotation matrix, Euler's equations with slopes of those angles, quadratures, and mpmath's
elliptic functions, those of the paper's imaginary modulus too.  mpmath takes this modulus as it is,
in sn, cn, dn, in K, and in the theta functions, whose nome is then negative; so do our own
functions.
"""

from __future__ import annotations

from functools import partial
from typing import Any, ClassVar

import pytest
from chrapan_top import FAR, LEFT, PARTS, RIGHT, SLOW, UPRIGHT, J, Moment, ar, moments, ours, spoil
from equations import EquationTests, Register
from errata import misprints

chrapan = Register(__name__, ar)
tops, right = partial(moments, 0), partial(moments, 0, of=[RIGHT])
upright = partial(moments, 0, of=[UPRIGHT])
tops_and_slow, tops_and_upright = (partial(tops, more=[x]) for x in (SLOW, UPRIGHT))
first_half, first_period = (partial(moments, *PARTS[:i]) for i in (2, 4))
some, far = partial(moments, *PARTS[::2][:2], PARTS[5]), partial(moments, *FAR)
early_and_far = partial(moments, *PARTS[2:], *FAR)
half_periods = partial(moments, *(ar.mpf(i) / 2 for i in (-3, 1, 2, 5)))
right_early, right_at_a_third, right_in_second_half = (
    partial(moments, x, of=[RIGHT]) for x in (PARTS[0], ar.mpf(1) / 3, ar.mpf(5) / 8)
)
left_at_a_third = partial(moments, ar.mpf(1) / 3, of=[LEFT])


# Mechanics


def rotation(now: Moment) -> Any:
    """Return the matrix from body to space: turns about z, the line of nodes, and z'."""

    def about_z(angle: Any) -> Any:
        c, s = ar.cos(angle), ar.sin(angle)
        return ar.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    c, s = ar.cos(now.theta), ar.sin(now.theta)
    return about_z(now.psi) * ar.matrix([[1, 0, 0], [0, c, -s], [0, s, c]]) * about_z(now.phi)


def spin(now: Moment) -> list[Any]:
    """Return p, q and r from the derivative of the rotation."""
    found = rotation(now).T * now.d(rotation)
    return [found[2, 1], found[0, 2], found[1, 0]]


def turning(now: Moment) -> list[Any]:
    """Return omega in space, from the derivative of the rotation."""
    found = now.d(rotation) * rotation(now).T
    return [found[2, 1], found[0, 2], found[1, 0]]


def nodes(angle: Any) -> list[Any]:
    """Return i cos + j sin, the coordinates of a direction in the plane (x, y)."""
    return [ar.cos(angle), ar.sin(angle), ar.mpf(0)]


def momentum(now: Moment) -> Any:
    """Return the angular momentum in space."""
    return rotation(now) * ar.matrix([now.A * now.p, now.A * now.q, now.C * now.r0])


def velocity(now: Moment, angle: Any, rate: Any) -> list[Any]:
    """Return omega of section 4 b in space, with the angle that stands for the precession."""
    axis, along, around = rotation(now)[:, 2], nodes(angle), [0, 0, rate]
    return [now.thetadot * along[i] + around[i] + now.phidot * axis[i] for i in range(3)]


def across(now: Moment) -> tuple[Any, Any]:
    """Return p sin phi + q cos phi and p cos phi - q sin phi, from the derivative of rotation."""
    (p, q, _), sine, cosine = spin(now), ar.sin(now.phi), ar.cos(now.phi)
    return p * sine + q * cosine, p * cosine - q * sine


# The cubic and its roots


def cubic(now: Moment, u: Any) -> Any:
    """Return f(u) from the roots of the record."""
    return now.a * (now.u1 - u) * (u - now.u2) * (now.u3 - u)


def start(now: Moment) -> Any:
    """Return u1 of the start."""
    return ar.cos(ar.radians(now.motion.motion.top.theta0_deg))


def discriminant(now: Moment) -> Any:
    """Return b^4 - 4 a b^2 u1 + 4 a^2 with u1 of the start."""
    return now.b**4 - 4 * now.a * now.b**2 * start(now) + 4 * now.a**2


# Parameters, precession and spin


def pole(now: Moment, i: int) -> Any:
    """Return x/(1 - x), x = kappa^2 sn^2 xi^2 at a parameter."""
    x = now.kappa2 * now.six[3 * i] ** 2 * now.xi**2
    return x / (1 - x)


def printed_six(now: Moment) -> list[Any]:
    """Return sn, cn, dn of alpha1, then of alpha2, as section 4 i prints them."""
    u1, u2, u3 = now.u1, now.u2, now.u3
    south = [J * ar.sqrt(u3 - u1), ar.sqrt(u3 + 1), ar.sqrt(1 + u2)]
    north = [ar.sqrt(u3 - u1), J * ar.sqrt(u3 - 1), ar.sqrt(1 - u2)]
    return [x / ar.sqrt(1 + u1) for x in south] + [x / ar.sqrt(1 - u1) for x in north]


def quotient(now: Moment, v: Any) -> Any:
    """Return sn/(cn dn) for the imaginary modulus, v already stretched to the real one."""
    sn, cn, dn = (ar.ellipfun(name, v, m=now.k**2) for name in ("sn", "cn", "dn"))
    return now.k_prime * sn * dn / cn


def pi00_11(now: Moment, sign: int) -> Any:
    """Return Pi00 of section 4 j, plus or minus Pi11 + i pi/2."""
    even, odd = (ours.pi_function(x, now.w, J * now.alpha, now.k) for x in ("00", "11"))
    return even + sign * (odd + J * ar.pi / 2)


def pi01(now: Moment) -> list[Any]:
    """Return our Pi01(eta, alpha1, kappa) and Pi01(eta, alpha2, kappa), continuous in t."""
    return [ours.pi_function("01", now.eta, v, now.kappa) for v in now.parameters]


def pi01_there(now: Moment, v: Any) -> Any:
    """Return exp 2 Pi01(eta, v, kappa) by its definition and mpmath's theta with nome -q."""
    q, scale = -now.nome, ar.pi / (2 * ar.ellipk(now.kappa2))
    zeta = scale * ar.jtheta(4, scale * v, q, 1) / ar.jtheta(4, scale * v, q)
    less, more = (ar.jtheta(4, scale * (now.eta + sign * v), q) for sign in (-1, 1))
    return ar.exp(2 * now.eta * zeta) * less / more


def weighted(now: Moment) -> list[Any]:
    """Return sn/(cn dn) times Pi01 of each parameter, over sqrt(a (u3 - u1))/b."""
    size, six = now.b / ar.sqrt(now.a * (now.u3 - now.u1)), now.six
    return [
        size * six[i] / (six[i + 1] * six[i + 2]) * x
        for i, x in zip((0, 3), pi01(now), strict=True)
    ]


def own_sn(now: Moment) -> Any:
    """Return our sn(eta, kappa)."""
    return ours.jacobi(now.eta, now.kappa)[1]


# Sections 5 to 8: nutation, spin and precession


def period_by_quadrature(now: Moment) -> Any:
    """Return (5,1) as an integral over chi with u = u1 - (u1 - u2) sin^2 chi."""

    def inverse_rate(chi: Any) -> Any:
        u = now.u1 - (now.u1 - now.u2) * ar.sin(chi) ** 2
        return 4 / ar.sqrt(now.a * (now.u3 - u))

    with ar.workdps(50):
        return ar.quad(inverse_rate, [0, ar.pi / 4, ar.pi / 2])


def steady(now: Moment) -> Any:
    """Return the first term of (6,1)."""
    return now.r0 * (1 - now.C / (2 * now.A)) * now.t


def arccot(now: Moment, sign: Any = 1) -> Any:
    """Return the arccot of (6,1) from u, its roots positive as the text has them.

    In (6,4) they are negative in the second half of a period.
    """
    above, below = (now.u3 - now.u) * (now.u - now.u2), (now.u3 + now.u2) * (now.u1 - now.u)
    return ar.atan2(ar.sqrt(below), sign * ar.sqrt(above))


def drift(now: Moment) -> Any:
    """Return the first term of (7,1) over t."""
    return now.elementary * (2 - (now.u3 - now.u2))


def curve(now: Moment, wrong: int = 0) -> Any:
    """Return the bracket of (7,1), or as it is printed."""
    phi, m = ar.asin(ar.sqrt((now.u3 - now.u2) / (now.u3 + 1))), 1 - now.k**2
    E, F, rest = ar.ellipe(phi, m), ar.ellipf(phi, m), 1 - now.E / now.K
    return E - F * rest + wrong * F * (1 - rest)


def precession(now: Moment, bracket: Any, waves: Any, sigma: Any = 1) -> Any:
    """Return (7,1) with a bracket and with waves, for a direction of spin."""
    rate = ar.sqrt(now.a * (now.u3 - now.u2))
    return drift(now) * now.t + sigma * (rate * now.t * bracket - waves)


chrapan.enter("""
# moments
section 4 b: the angular velocity | turning(now) = velocity(now, psi, psidot)
    | fdot(velocity(now, psi, psidot), rotation(now)[:, 2]) = r0
(4,1) | [p, q, r0] = spin(now)
(4,1) solved for the rates | psidot = across(now)[0]/sin(theta)
    | phidot = r0 - across(now)[0]*cot(theta) | thetadot = across(now)[1]
section 4 d: c1 and c2 | A/2*(p**2 + q**2) + mgs*u = mgs*u1
    | A*sin(theta)*(p*sin(phi) + q*cos(phi)) + C*r0*u = C*r0*u1
section 4 d: p and q by the rates | p**2 + q**2 = thetadot**2 + (1 - u**2)*psidot**2
    | p*sin(phi) + q*cos(phi) = sin(theta)*psidot
    | 2*mgs*(u1 - u)/A = thetadot**2 + (1 - u**2)*psidot**2
# first_half
section 4 a: the line of nodes | rotation(now)*matrix(nodes(-phi)) = nodes(psi)
    | d(momentum)/(mgs*sin(theta)) = nodes(psi)
section 4 c: Euler's equations | A*d('p') + (C - A)*r0*q = mgs*sin(theta)*cos(phi)
    | A*d('q') - (C - A)*r0*p = -mgs*sin(theta)*sin(phi)
section 4 d: power of the weight | A*(p*d('p') + q*d('q')) = mgs*sin(theta)*thetadot
# right_early: as printed
section 4 a: the line of nodes | (d(momentum)/(mgs*sin(theta)))[:2] = nodes(phi)[:2]
(4,1) | p = phidot*sin(theta)*sin(phi) + thetadot*cos(phi)
# right_at_a_third: as printed
section 4 b: the angular velocity | turning(now) = velocity(now, phi, phidot)
(4,1) solved for the rates | phidot = (p*sin(phi) + q*cos(phi))/sin(theta)
section 4 d: p and q by the rates | p**2 + q**2 = thetadot**2 + (1 - u**2)*phidot**2
    | p*sin(phi) + q*cos(phi) = sin(theta)*phidot
# moments
(4,2) | A*(thetadot**2 + psidot**2*(1 - u**2)) = 2*mgs*(u1 - u)
(4,3) | A*(1 - u**2)*psidot = C*r0*(u1 - u)
(4,7) | psidot = b*(u1 - u)/(1 - u**2)
(4,8) | phidot = r0 - b*u*(u1 - u)/(1 - u**2)
# right_early: as printed
(4,2) | A*(thetadot**2 + phidot**2*(1 - u**2)) = 2*mgs*(u1 - u)
(4,3) | A*(1 - u**2)*phidot = C*r0*(u1 - u)
(4,7) | phidot = b*(u1 - u)/(1 - u**2)
(4,8) | psidot = r0 - b*u*(u1 - u)/(1 - u**2)
# tops
(4,4) | a = 2*mgs/A
(4,5) | b = C*r0/A
(4,6) | u1 = u | u2 = at(T/2).u
(4,10) | u2 = (b**2 - sqrt(discriminant(now)))/(2*a) | u3 = (b**2 + sqrt(discriminant(now)))/(2*a)
    | -a*u2**2 + b**2*u2 - (b**2*u1 - a) = 0 | -a*u3**2 + b**2*u3 - (b**2*u1 - a) = 0
(4,19) | k = sqrt((u1 - u2)/(u3 - u2))
(4,21) | k_prime = sqrt((u3 - u1)/(u3 - u2))
section 4 e: the discriminant | (a*(u3 - u2))**2 = discriminant(now)
    | sign(discriminant(now) - (b**2 - 2*a)**2) = 1
section 4 e: f and its slope at 1, -1 and u1 | cubic(now, 1) = -(b*(start(now) - 1))**2
    | cubic(now, -1) = -(b*(start(now) + 1))**2
    | diff(lambda u: cubic(now, u), start(now)) = -a*(1 - start(now)**2)
(4,11) | u3 + u2 = b**2/a
section 4 f: sum of products | u1*u2 + u1*u3 - u2*u3 = 1
(4,12) | u2*u3 = b**2/a*u1 - 1
(4,13) | 1 - u1**2 = (u1 - u2)*(u3 - u1)
(4,14) | 1 - u2**2 = (u1 - u2)*(u3 + u2)
(4,14), second | u3**2 - 1 = (u3 - u1)*(u3 + u2)
(4,15) | (1 + u1)*(1 - u2) = (u3 + 1)*(u1 - u2)
(4,15), second | (1 - u1)*(1 + u2) = (u3 - 1)*(u1 - u2)
(4,15), third | (1 + u1)*(u3 - 1) = (1 + u2)*(u3 - u1)
(4,16) | (1 - u1)*(u3 + 1) = (1 - u2)*(u3 - u1)
(4,17) | (1 + u2)*(u3 + 1) = (1 + u1)*(u3 + u2)
(4,18) | (1 - u2)*(u3 - 1) = (1 - u1)*(u3 + u2)
# tops_and_slow
section 4 e: sign of u2 | a*u3*at(T/2).u = b**2*u1 - a | sign(u3 - 1) = 1
# moments
(4,9) | d('u')**2 = (1 - u*u)*(a*u1 - a*u) - (b*u1 - b*u)**2
(4,20) | u = u3 - (u3 - u1)/jacobi[2]**2
    | u = u1 - (u1 - u2)*(u3 - u1)/(u3 - u2)*(jacobi[0]/jacobi[2])**2
(4,22) | jacobi[2]**2 = (u3 - u1)/(u3 - u)
(4,23) | jacobi[0]**2 = (u1 - u)*(u3 - u2)/((u3 - u)*(u1 - u2))
(4,24) | jacobi[1]**2 = (u3 - u1)*(u - u2)/((u3 - u)*(u1 - u2))
(4,25) | 1 + u = (1 + u1)*(1 - (u1 - u2)/(1 + u1)*xi**2)
(4,26) | 1 - u = (1 - u1)*(1 + (u1 - u2)/(1 - u1)*xi**2)
section 4 g: u by the imaginary modulus | u1 - u = (u1 - u2)*xi**2 | u - u2 = (u1 - u2)*(1 - xi**2)
    | u3 - u = (u3 - u1)*(1 - kappa2*xi**2)
# moments
section 4 ch: rate of precession | psidot = b/2*(pole(now, 0) - pole(now, 1))
section 4 k: rate of spin | phidot = r0 + b/2*(pole(now, 0) + pole(now, 1))
(4,29) | psi = sigma*J*pi00_11(now, 1)
(4,30) | 2*K*t/T = eta*sqrt((u3 - u2)/(u3 - u1)) | 2*K*t/T = eta*sqrt(1 - kappa2) | 2*K*t/T = w
section 4 l: w | ellipfun('dn', sqrt(a*(u3 - u2))*t/2, m=k**2)**2 = (u3 - u1)/(u3 - u)
(4,34) | phi = r0*t + sigma*J*pi00_11(now, -1)
section 4 g: u by sn of the imaginary modulus | u = u1 - (u1 - u2)*own_sn(now)**2
    | u = u1 - (u1 - u2)*imaginary(eta)[0]**2
section 4 i: precession by Pi01 | sigma*J*(pi01(now)[0] + pi01(now)[1]) = psi
section 4 l: spin by Pi01 | r0*t + sigma*J*(pi01(now)[0] - pi01(now)[1]) = phi
# some
section 4 g: f and the rate of xi
    | d('u')**2 = a*(u1 - u2)**2*(u3 - u1)*own_sn(now)**2*(1 - own_sn(now)**2)*(1 -
      kappa2*own_sn(now)**2) | d(own_sn)**2 = a*(u3 - u1)/4*(1 - xi**2)*(1 - kappa2*xi**2)
section 4 i: Pi01 of both parameters
    | [exp(2*x) for x in pi01(now)] = [pi01_there(now, v) for v in parameters]
section 4 i: precession by Pi01 and the values at its parameters
    | weighted(now)[0] - weighted(now)[1] = psi
section 4 l: spin by Pi01 and the values at its parameters | r0*t + sum(weighted(now)) = phi
# tops
section 4 i: sn, cn, dn of the parameters
    | six = [s*x for s, x in zip((1, 1, 1, -1, 1, -1), printed_six(now))]
    | [x**2 for x in six] = [x**2 for x in printed_six(now)]
line before (4,27) | six[0]/(six[1]*six[2]) = quotient(now, J*alpha)
    | quotient(now, J*alpha) = J*sqrt((u3 - u1)*(1 + u1)/((u3 + 1)*(1 + u2)))
(4,27) | quotient(now, J*alpha) = J*sqrt(a*(u3 - u1))/abs(b)
(4,28) | quotient(now, J*alpha + J*K_prime + K) = -J*sqrt(a*(u3 - u1))/abs(b)
(4,31) | ellipfun('cn', alpha, m=1 - k**2) = sqrt((1 + u2)/(u3 + 1))
(4,32) | ellipfun('sn', alpha, m=1 - k**2) = sqrt((u3 - u2)/(u3 + 1))
(4,33) | ellipfun('dn', alpha, m=1 - k**2) = sqrt((1 + u1)/(u3 + 1))
section 4 g: the modulus, and its complement greater than 1 | kappa = J*k/k_prime
    | sqrt((u3 - u2)/(u3 - u1)) = 1/k_prime | sqrt(1 - kappa2) = 1/k_prime
section 4 h: quarter periods of the imaginary modulus | k_prime*K = ellipk(kappa2)
    | k_prime*(K_prime - J*K) = ellipk(1/k_prime**2)
section 4 i: squares of sn, cn, dn at both parameters
    | [x**2 for x in printed_six(now)] =
      [x**2 for v in parameters for x in ours.jacobi(v, kappa)[1:]]
section 4 g: sn, cn, dn of the imaginary modulus anywhere
    | [ellipfun(x, alpha*(3 + 4*J)/10, m=-(k/k_prime)**2) for x in ('sn', 'cn', 'dn')] =
      ours.jacobi(alpha*(3 + 4*J)/10, kappa)[1:]
section 4 j: the second parameter is iK' further, the product is 1
    | parameters[1] - parameters[0] = J*ellipk(1/k_prime**2) | kappa2*(six[0]*six[3])**2 = 1
    | kappa2*(printed_six(now)[0]*printed_six(now)[3])**2 = 1
section 4 j: sn, cn, dn of i alpha for the real modulus
    | [x**2 for x in ours.jacobi(J*alpha, k)[1:]] = [x/(1 + u2) for x in (u2 - u3, u3 + 1, 1 + u1)]
# tops: as printed
section 4 i: sn, cn, dn of the parameters | six[3::2] = printed_six(now)[3::2]
line before (4,27) | quotient(now, J*alpha) = J*sqrt((u3 + u1)*(1 + u1)/((u3 + 1)*(1 + u2)))
# right_at_a_third: as printed
section 4 ch: rate of precession as printed, the power
    | psidot = b/2*(kappa*pole(now, 0) - pole(now, 1))
section 4 ch: rate of precession as printed, the left side
    | phidot = b/2*(pole(now, 0) - pole(now, 1))
(4,30) as printed, the roots | 2*K*t/T = eta*sqrt((u3 + u2)/(u3 - u2))
(4,30) as printed, the modulus | 2*K*t/T = eta*sqrt(1 + k**2)
section 4 l: w | ellipfun('dn', sqrt(a*(u3 - u2))*t/3, m=k**2)**2 = (u3 - u1)/(u3 - u)
# left_at_a_third: as printed
(4,27) | quotient(now, J*alpha) = J*sqrt(a*(u3 - u1))/b
(4,28) | quotient(now, J*alpha + J*K_prime + K) = -J*sqrt(a*(u3 - u1))/b
(4,29) | psi = J*pi00_11(now, 1)
(4,34) | phi = r0*t + J*pi00_11(now, -1)
# tops
(5,1) | T = period_by_quadrature(now) | T = 4*ellipk(k**2)/sqrt(a*(u3 - u2))
(5,2) | u_quarter = at(T/4).u | at(T/4).u = u3 - sqrt((u3 - u1)*(u3 - u2))
    | at(3*T/4).u = u3 - sqrt((u3 - u1)*(u3 - u2))
section 6: spin after half a period and a whole one | at(T/2).phi = steady(at(T/2)) + sigma*pi/2
    | at(T).phi = steady(at(T)) + sigma*pi
section 6: the halves of the spin are alike | 2*at(T/2).phi = at(T).phi
(6,2) | at(T).phidot = r0 | at(T/2).phidot = r0 - 2*elementary*u2
    | spin_rate_half = r0 - 2*elementary*u2
(6,3) | at(T).phi/T = mean_spin_rate | mean_spin_rate = (steady(at(T)) + sigma*pi)/T
section 7: precession after half a period and a whole one
    | at(T/2).psi = precession(at(T/2), curve(now), pi/2, sigma)
    | at(T).psi = precession(at(T), curve(now), pi, sigma)
section 7: the halves of the precession are alike | 2*at(T/2).psi = at(T).psi
(7,2) | radians(amplitude_deg) = asin(sqrt((u3 - u2)/(u3 + 1)))
    | alpha = ellipf(radians(amplitude_deg), 1 - k**2)
section 7: rates of the precession at T/2 and T | at(T).psidot = 0 | at(T/2).psidot = 2*elementary
(7,3) | mean_precession_rate = drift(now) + sigma*4/T*(K*curve(now) - pi/4)
    | mean_precession_rate = at(T).psi/T
# tops_and_upright
section 5: quarters of the nutation
    | (u - at(T/4).u)/(at(T/4).u - at(T/2).u) = sqrt((u3 - u1)/(u3 - u2))
    | sign(1 - sqrt((u3 - u1)/(u3 - u2))) = 1
# moments
(5,3) | thetadot = sign(sin(2*pi*t/T))*sqrt(a*(u1 - u)*(u - u2)*(u3 - u)/(1 - u*u))
(6,1) | phi = steady(now) + sigma*(pi*floor(t/T) + spin_arccot)
(7,1) | psi = precession(now, curve(now), pi*floor(t/T) + waves, sigma)
# first_half
(6,1) from u, in the first half of a period | phi = steady(now) + sigma*arccot(now)
# first_period
(6,4) | dphi = sigma*(arccot(now, sign(T/2 - t)) - pi*t/T)
(7,4) | dpsi = sigma*(pi*t/T - waves)
# early_and_far
(6,5) | dphi = at(tau).dphi | dpsi = at(tau).dpsi
# half_periods
sections 6 and 7: no remainder at half periods | dphi = 0 | dpsi = 0
# far
(6,6) | phi = mean_spin_rate*t + sigma*(at(tau).spin_arccot - pi*tau/T)
(7,5) | psi = mean_precession_rate*t + sigma*(pi*tau/T - at(tau).waves)
# right
section 8: rates of the precession | mean_precession_rate/7.98957 = 1
    | precession_rate_half/14.2682 = 1
# right_in_second_half: as printed
(5,3) | thetadot = sqrt(a*(u1 - u)*(u - u2)*(u3 - u)/(1 - u*u))
(6,1) as printed, in the second half of a period | phi = steady(now) + arccot(now)
(6,1) as printed, after the first period | at(t + T).phi = steady(at(t + T)) + spin_arccot
(6,4) | dphi = arccot(at(tau2)) - pi*tau2/T | dphi = arccot(now) - pi*tau2/T
(6,5) | dphi = at(tau2).dphi | dpsi = at(tau2).dpsi
(7,1) as printed, the bracket | psi = precession(now, curve(now, 1), waves)
(7,1) as printed, after the first period | at(t + T).psi = precession(at(t + T), curve(now), waves)
(7,3) as printed, the left side | mean_spin_rate = drift(now) + 4/T*(K*curve(now) - pi/4)
(7,4) | dpsi = pi*tau2/T - at(tau2).waves | dpsi = pi*tau2/T - waves | dpsi = pi*tau2/T + pi - waves
section 5: quarters of the nutation as printed, the labels of u | sign(at(T).u/2 - u2 - u1) = 1
    | sign(at(3*T).u/2 - u2 - u1) = 1
section 7: rates of the precession at T/2 and T | at(T).phidot = 0 | at(T/2).phidot = 2*elementary
section 8: rates of the precession | mean_spin_rate/7.98957 = 1 | spin_rate_half/14.2682 = 1
# left_at_a_third: as printed
(6,1) as printed, for r0 < 0 | phi = steady(now) + arccot(now)
section 6: spin after half a period and a whole one | at(T).phi = steady(at(T)) + pi
(6,3) | mean_spin_rate = (steady(at(T)) + pi)/T
(7,1) as printed, for r0 < 0 | psi = precession(now, curve(now), waves)
(7,3) as printed, for r0 < 0 | mean_precession_rate = drift(now) + 4/T*(K*curve(now) - pi/4)
# upright: as printed
section 5: quarters of the nutation as printed, the tilt
    | sign(at(T/2).theta - 2*at(T/4).theta + theta) = 1
""")


class TestChrapan(EquationTests):
    """Tests of the register."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = misprints("Chrapan", 4, 5, 6, 7, 8)
    tolerances: ClassVar[dict[str, float]] = {"section 8: rates of the precession": 2e-4}

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put tops in place whose record and angles are wrong."""
        spoil(patch)
