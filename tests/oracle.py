"""The judge of the tests: Chrapan's own formulas (1952) in mpmath, and a plain integration.

Written from the paper alone, slips put right, and sharing nothing with the program it judges.
Numbers in parentheses are the paper's equations.  The closed forms take `dps`, the decimal digits
wanted, and work with as many more as the scene can lose; a caller who computes on with the
results raises `mp.dps` himself.  phi is the spin, psi the precession, both counted from zero.
"""

from collections.abc import Iterable, Sequence
from functools import cache
from typing import NamedTuple, TypeAlias

import numpy as np
from mpmath import mp, mpf
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Number: TypeAlias = float | str | mpf
Array: TypeAlias = NDArray[np.float64]


class Scene(NamedTuple):
    """The data of a top let go at rest; the defaults are the worked example of section 8."""

    m: Number = 1587
    A: Number = 39032
    C: Number = 17458
    s: Number = 4
    g: Number = 981
    r0: Number = 50
    theta0_deg: Number = 30


class Top(NamedTuple):
    """The constants of a scene by (4,4) to (5,1), computed once for all times."""

    a: mpf
    b: mpf
    r0: mpf
    steady_spin: mpf
    sigma: mpf
    u1: mpf
    u2: mpf
    u3: mpf
    k: mpf
    k_prime: mpf
    K: mpf
    K_prime: mpf
    E: mpf
    amplitude: mpf
    alpha: mpf
    E_amplitude: mpf
    T: mpf


class Phase(NamedTuple):
    """Where an instant lies: `turns` whole periods, then x = pi t/T and the functions of w."""

    turns: mpf
    x: mpf
    sn: mpf
    cn: mpf
    dn: mpf
    u: mpf


def constants(scene: Scene, dps: int = 50) -> dict[str, mpf]:
    """Return every constant of the motion, under the names of the program's record."""
    digits = _digits(scene, dps, mpf(0))
    with mp.workdps(digits):
        top = _solve(scene, digits)
        spin, precession = _mean_spin(top), _mean_precession(top)
        fields = ("a", "b", "u1", "u2", "u3", "k", "k_prime", "K", "K_prime", "E", "alpha")
        return {name: getattr(top, name) for name in fields} | {
            "modular_angle_deg": mp.degrees(mp.asin(top.k)),
            "nome": _nome(top),
            "amplitude_deg": mp.degrees(top.amplitude),
            "T_nutation": top.T,
            "T_spin": 2 * mp.pi / abs(spin),
            "T_precession": 2 * mp.pi / abs(precession),
            "u_quarter": top.u3 - mp.sqrt((top.u3 - top.u1) * (top.u3 - top.u2)),  # (5,2)
            "theta_min_deg": mp.degrees(mp.acos(top.u1)),
            "theta_max_deg": mp.degrees(mp.acos(top.u2)),
            "mean_spin_rate": spin,
            "mean_precession_rate": precession,
            "spin_rate_start": top.r0,
            "spin_rate_half": top.r0 - top.a / top.b * top.u2,  # (6,2)
            "precession_rate_start": mpf(0),
            "precession_rate_half": top.a / top.b,  # section 7
        }


def angles(scene: Scene, t: float | mpf, dps: int = 50) -> tuple[mpf, mpf, mpf]:
    """Return theta, phi, psi in radians at any real time, phi and psi unwrapped."""
    time = mp.convert(t)
    digits = _digits(scene, dps, time)
    with mp.workdps(digits):
        top = _solve(scene, digits)
        phase = _phase(top, time)
        return mp.acos(phase.u), _spin(top, phase, time), _precession(top, phase, time)


def angle_rates(scene: Scene, t: float | mpf, dps: int = 50) -> tuple[mpf, mpf, mpf]:
    """Return the rates of theta, phi, psi: (5,3) with (4,22) to (4,24) put in, (4,8), (4,7)."""
    time = mp.convert(t)
    digits = _digits(scene, dps, time)
    with mp.workdps(digits):
        top = _solve(scene, digits)
        _, _, sn, cn, dn, u = _phase(top, time)
        swing = (top.u1 - top.u2) * (top.u3 - top.u1) * sn * cn / dn**3
        nutation = mp.sqrt(top.a / (top.u3 - top.u2)) * swing / mp.sqrt(1 - u**2)
        precession = top.b * (top.u1 - u) / (1 - u**2)
        return nutation, top.r0 - u * precession, precession


def units(
    computed: Sequence[float], scene: Scene, t: float | mpf, dps: int = 50
) -> tuple[float, float, float]:
    """Return the errors of computed angles (radians) in units of their unavoidable rounding."""
    exact, rates, time = angles(scene, t, dps), angle_rates(scene, t, dps), mp.convert(t)
    digits = _digits(scene, dps, time)
    with mp.workdps(digits):
        period = _solve(scene, digits).T
        tau = time - period * mp.nint(time / period)
        theta, phi, psi = map(_error, computed, exact, (tau * rate for rate in rates))
        return theta, phi, psi


def integrate(scene: Scene, times: Iterable[float]) -> Array:
    """Return theta, phi, psi in rows, from Euler's equations of section 4 in doubles."""
    instants = np.asarray(list(times), dtype=float)
    result = np.empty((instants.size, 3))
    for side in (instants >= 0, instants < 0):
        order = np.flatnonzero(side)[np.argsort(abs(instants[side]))]
        result[order] = _march(scene, instants[order])
    return result


def _error(computed: float, exact: mpf, drift: mpf) -> float:
    """Return |computed - exact| over eps (max(1, |exact|) + |tau rate|), infinity for a NaN."""
    if mp.isnan(computed):
        return float("inf")
    return float(abs(computed - exact) * 2**52 / (max(mpf(1), abs(exact)) + abs(drift)))


def _data(scene: Scene) -> tuple[mpf, mpf, mpf, mpf, mpf]:
    """Return a and b of (4,4) and (4,5), r0, the factor 1 - C/2A, theta0 in radians."""
    m, A, C, s, g, r0, degrees = map(mp.convert, scene)
    return 2 * m * g * s / A, C * r0 / A, r0, 1 - C / (2 * A), mp.radians(degrees)


def _digits(scene: Scene, dps: int, t: mpf) -> int:
    """Return dps and what fast, slow, nearly upright or hanging tops and long times cancel."""
    with mp.workdps(dps + 30):
        a, b, _, _, theta0 = _data(scene)
        extremes = abs(mp.log10(b**2 / a)) + abs(mp.log10(mp.sin(theta0)))
        periods = mp.log10(1 + abs(t) * (mp.sqrt(a) + abs(b)))
        return dps + 30 + 20 * int(mp.ceil((4 * extremes + periods) / 20))


@cache
def _solve(scene: Scene, digits: int) -> Top:
    """Solve for roots, modulus (4,19), k' (4,21), amplitude (7,2), alpha (1,6), period (5,1)."""
    with mp.workdps(digits):
        a, b, r0, factor, theta0 = _data(scene)
        u1 = mp.cos(theta0)
        root = mp.sqrt(b**4 - 4 * a * b**2 * u1 + 4 * a**2)
        u2, u3 = (b**2 - root) / (2 * a), (b**2 + root) / (2 * a)
        m, n = (u1 - u2) / (u3 - u2), (u3 - u1) / (u3 - u2)
        amplitude = mp.asin(mp.sqrt((u3 - u2) / (u3 + 1)))
        E, alpha, E_amplitude = mp.ellipe(m), mp.ellipf(amplitude, n), mp.ellipe(amplitude, n)
        K, K_prime, T = mp.ellipk(m), mp.ellipk(n), 4 * mp.ellipk(m) / mp.sqrt(a * (u3 - u2))
        first = (a, b, r0, r0 * factor, mp.sign(r0), u1, u2, u3, mp.sqrt(m), mp.sqrt(n))
        return Top(*first, K, K_prime, E, amplitude, alpha, E_amplitude, T)


def _phase(top: Top, t: mpf) -> Phase:
    """Return the instant reduced modulo T: x of (7,1), w of (4,30), u of (4,20)."""
    turns = mp.floor(t / top.T)
    part = t / top.T - turns
    sn, cn, dn = (mp.ellipfun(name, 2 * top.K * part, m=top.k**2) for name in ("sn", "cn", "dn"))
    return Phase(turns, mp.pi * part, sn, cn, dn, top.u3 - (top.u3 - top.u1) / dn**2)


def _nome(top: Top) -> mpf:
    """Return the nome (2,4)."""
    return mp.exp(-mp.pi * top.K_prime / top.K)


def _mean_spin(top: Top) -> mpf:
    """Return the mean spin rate (6,3), for either sign of r0."""
    return top.steady_spin + top.sigma * mp.pi / top.T


def _mean_precession(top: Top) -> mpf:
    """Return the mean precession rate (7,3), for either sign of r0."""
    curve = top.K * top.E_amplitude - (top.K - top.E) * top.alpha - mp.pi / 4
    return top.a / (2 * top.b) * (2 - top.u3 + top.u2) + top.sigma * 4 / top.T * curve


def _spin(top: Top, phase: Phase, t: mpf) -> mpf:
    """Return the spin (6,1) for all times: the arccot runs over (0, pi) once in every period."""
    rho = mp.sqrt((top.u3 - top.u2) / (top.u3 + top.u2))
    arccot = mp.atan2(phase.sn * phase.dn, rho * phase.cn)
    return top.steady_spin * t + top.sigma * (mp.pi * phase.turns + arccot)


def _precession(top: Top, phase: Phase, t: mpf) -> mpf:
    """Return (7,1) for all times, with E(phi,k') - F(phi,k')(1 - E/K) as the factor of t."""
    y = mp.pi * top.alpha / (2 * top.K)
    arccot = mp.atan2(mp.sin(phase.x), mp.cos(phase.x) * mp.tanh(y))
    growth = top.E_amplitude - top.alpha * (1 - top.E / top.K)
    growing = mp.sqrt(top.a * (top.u3 - top.u2)) * growth * t
    waving = mp.pi * phase.turns + arccot + _series(phase.x, y, _nome(top))
    return top.a / (2 * top.b) * (2 - top.u3 + top.u2) * t + top.sigma * (growing - waving)


def _series(x: mpf, y: mpf, q: mpf) -> mpf:
    """Return the sum of arctangents in (7,1), up to the first one below the working precision."""
    total, power, sign = mpf(0), q, 1
    sine, cosine = mp.sin(2 * x) * mp.sinh(2 * y), mp.cos(2 * x) * mp.cosh(2 * y)
    while power * mp.cosh(2 * y) > mp.eps:
        below = 1 + power**2 + 2 * sign * power * cosine
        total += sign * mp.atan(2 * power * sine / below)
        power, sign = power * q, -sign
    return total


def _march(scene: Scene, times: Array) -> Array:
    """Integrate away from t = 0 through times of one sign, and unwrap along all the steps."""
    m, A, C, s, g, r0, degrees = map(float, scene)

    def slope(_: float, state: Array) -> Array:
        """Return Euler's equations in the body, and the quaternion's (body to space)."""
        p, q, e0, e1, e2, e3 = state
        pull, push = 2 * (e2 * e3 + e0 * e1), 2 * (e1 * e3 - e0 * e2)
        rates = (
            ((A - C) * q * r0 + m * g * s * pull) / A,
            ((C - A) * p * r0 - m * g * s * push) / A,
            (-e1 * p - e2 * q - e3 * r0) / 2,
            (e0 * p + e2 * r0 - e3 * q) / 2,
            (e0 * q + e3 * p - e1 * r0) / 2,
            (e0 * r0 + e1 * q - e2 * p) / 2,
        )
        return np.array(rates)

    half = np.radians(degrees) / 2
    path = [np.array([0, 0, np.cos(half), np.sin(half), 0, 0])]
    marks, now = [], 0.0
    step = 0.05 / (abs(r0) * max(1, C / A) + np.sqrt(2 * m * g * s / A))
    tight = {"rtol": 3e-14, "atol": 1e-16, "max_step": step}
    for time in times:
        flow = solve_ivp(slope, (now, time), path[-1], "DOP853", **tight)
        path.extend(flow.y.T[1:])
        marks.append(len(path) - 1)
        now = time
    return _euler(np.array(path)[:, 2:])[marks]


def _euler(path: Array) -> Array:
    """Return theta, phi, psi along a path of quaternions, from (psi + phi)/2 and (psi - phi)/2."""
    upper, lower = path[:, 0] + 1j * path[:, 3], path[:, 1] + 1j * path[:, 2]
    mean, half = np.unwrap(np.angle(upper)), np.unwrap(np.angle(lower))
    return np.stack((2 * np.arctan2(abs(lower), abs(upper)), mean - half, mean + half), axis=1)
