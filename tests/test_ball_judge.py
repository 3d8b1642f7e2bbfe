"""The judge in ball arithmetic is itself judged: by quadrature, by an integrator, by known values.

Quadrature (mpmath, 30 digits) goes along chi, u = (u1 + u2)/2 + (u1 - u2)/2 cos chi, where
dt = dchi/sqrt(a (u3 - u)).  The integrator (DOP853 on a quaternion) knows no Euler angle, no pole.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any, NamedTuple

import mpmath
import numpy as np
import pytest
from ball_judge import Judge
from mpmath import mp, mpf
from scipy.integrate import solve_ivp

UNIT: dict[str, float] = {"m": 1, "A": 1, "C": 1, "s": 1, "g": 1, "thetadot0": 0, "psidot0": 0}
DIGITS, WORKING = 20, 30
PEAK = 0.1
"""How far in chi a pass next to a pole reaches."""

REGULAR: dict[str, dict[str, float]] = {
    "generic": {"r0": 2, "theta0_deg": 70, "thetadot0": 0.7, "psidot0": 0.4},
    "rising": {"r0": 2, "theta0_deg": 70, "thetadot0": -0.7, "psidot0": 0.4},
    "against the spin": {"r0": -3, "theta0_deg": 110, "thetadot0": 1.5, "psidot0": 0.8},
    "starts highest": {"r0": 3, "theta0_deg": 40, "psidot0": 0.1},
    "starts lowest": {"r0": 3, "theta0_deg": 40, "psidot0": 2},
    "from rest": {"r0": 3, "theta0_deg": 40},
    "from rest, in radians": {"r0": -3, "theta0_rad": 2},
    "no spin": {"r0": 0, "theta0_deg": 80, "thetadot0": 0.5, "psidot0": 1},
    "disc": {"C": 2, "r0": 0.8, "theta0_deg": 15, "thetadot0": 0.2, "psidot0": -1.1},
    "needle": {"C": 0.01, "r0": 20, "theta0_deg": 100, "thetadot0": -2, "psidot0": 3},
    "next to the top": {"r0": 1.2, "theta0_deg": 30, "thetadot0": 2, "psidot0": 0.643},
    "next to the bottom": {"r0": 1.2, "theta0_deg": 150, "thetadot0": 1, "psidot0": -0.643},
}


class Quadrature(NamedTuple):
    """Roots and start of a motion in mpmath."""

    a: mpf
    b: mpf
    r0: mpf
    beta: mpf
    u1: mpf
    u2: mpf
    u3: mpf
    chi0: mpf

    def along(self, chi: mpf) -> tuple[mpf, mpf, mpf, mpf]:
        """Return t, theta, phi and psi at chi, from their integrals."""

        def over(rate: Any) -> mpf:
            low, high = sorted((self.chi0, chi))
            peaks = [n * mp.pi + near for n in range(-4, 8) for near in (-PEAK, 0, PEAK)]
            marks = [low, *(peak for peak in peaks if low < peak < high), high]
            whole = mpmath.quad(lambda x: rate(self.u(x)) / self.swing(self.u(x)), marks)
            return whole if chi > self.chi0 else -whole

        def turn(u: mpf) -> mpf:
            return (self.beta - self.b * u) / (1 - u * u)

        theta = mpmath.acos(self.u(chi))
        phi, psi = over(lambda u: self.r0 - u * turn(u)), over(turn)
        return over(lambda _: mpf(1)), theta, phi, psi

    def u(self, chi: mpf) -> mpf:
        """Return cos theta."""
        return (self.u1 + self.u2) / 2 + (self.u1 - self.u2) / 2 * mpmath.cos(chi)

    def swing(self, u: mpf) -> mpf:
        """Return dchi/dt."""
        return mpmath.sqrt(self.a * (self.u3 - u))


def quadrature(scene: dict[str, float]) -> Quadrature:
    """Return the roots, by mpmath's own finder, and the phase of the start."""
    x = {key: mpf(value) for key, value in scene.items()}
    a, b = 2 * x["m"] * x["g"] * x["s"] / x["A"], x["C"] * x["r0"] / x["A"]
    tilt = x["theta0_rad"] if "theta0_rad" in x else x["theta0_deg"] * mp.pi / 180
    u, sine2 = mpmath.cos(tilt), mpmath.sin(tilt) ** 2
    beta = x["psidot0"] * sine2 + b * u
    alpha = x["thetadot0"] ** 2 + x["psidot0"] ** 2 * sine2 + a * u

    def cubic(v: Any) -> Any:
        return (1 - v * v) * (alpha - a * v) - (beta - b * v) ** 2

    powers = (a, -alpha - b * b, 2 * b * beta - a, alpha - beta * beta)
    near = sorted(np.roots([float(power) for power in powers]).real.tolist())
    u2, u1, u3 = (mpmath.findroot(cubic, root, tol=1e-56) for root in near)
    chi0 = mpmath.acos(max(-1, min(1, (2 * u - u1 - u2) / (u1 - u2))))
    if not x["thetadot0"]:
        chi0 = mpf(0) if abs(u - u1) < abs(u - u2) else mp.pi
    return Quadrature(a, b, x["r0"], beta, u1, u2, u3, -chi0 if x["thetadot0"] < 0 else chi0)


def _exact(value: mpf) -> Fraction:
    sign, mantissa, exponent, _ = value._mpf_
    return Fraction(int(mantissa) * (-1) ** sign) * Fraction(2) ** int(exponent)


def _agree(ball: Any, value: mpf, digits: int = DIGITS) -> bool:
    middle = mpmath.mpf(ball.mid().str(60, radius=False))
    return bool(abs(middle - value) <= mpf(10) ** -digits * max(1, abs(value)))


@pytest.mark.slow
@pytest.mark.parametrize("name", REGULAR)
def test_angles_are_those_of_quadrature(name: str) -> None:
    scene = UNIT | REGULAR[name]
    with mpmath.workdps(WORKING):
        exact, judge = quadrature(scene), Judge(scene)
        for chi in (mpf("-7.3"), mpf("0.4"), mpf("9.1")):
            t, *angles = exact.along(chi)
            state = judge.at(_exact(t))
            pairs = zip((state.theta, state.phi, state.psi), angles, strict=True)
            assert all(_agree(ball, angle) for ball, angle in pairs), (name, chi)


@pytest.mark.slow
@pytest.mark.parametrize("name", REGULAR)
def test_record_is_that_of_quadrature(name: str) -> None:
    scene = UNIT | REGULAR[name]
    with mpmath.workdps(WORKING):
        exact, record = quadrature(scene), Judge(scene).record
        begin, end = (exact.along(exact.chi0 + turn) for turn in (0, 2 * mp.pi))
        T, phi, psi = end[0] - begin[0], end[2] - begin[2], end[3] - begin[3]
        m = (exact.u1 - exact.u2) / (exact.u3 - exact.u2)
        wanted = {
            "u1": exact.u1,
            "u2": exact.u2,
            "u3": exact.u3,
            "k": mpmath.sqrt(m),
            "k_prime": mpmath.sqrt(1 - m),
            "modular_angle_deg": mpmath.degrees(mpmath.asin(mpmath.sqrt(m))),
            "nome": mpmath.qfrom(m=m),
            "K": mpmath.ellipk(m),
            "K_prime": mpmath.ellipk(1 - m),
            "E": mpmath.ellipe(m),
            "T_nutation": T,
            "mean_spin_rate": phi / T,
            "mean_precession_rate": psi / T,
            "T_spin": 2 * mp.pi * T / abs(phi),
            "T_precession": 2 * mp.pi * T / abs(psi),
            "theta_min_deg": mpmath.degrees(mpmath.acos(exact.u1)),
            "theta_max_deg": mpmath.degrees(mpmath.acos(exact.u2)),
        }
        if record.get("u_quarter") is not None:
            between = mpmath.findroot(lambda chi: exact.along(chi)[0] - T / 4, 1.5)
            wanted["u_quarter"] = exact.u(between)
        if "amplitude_deg" in record:
            sine2 = (exact.u3 - exact.u2) / (exact.u3 + 1)
            wanted["amplitude_deg"] = mpmath.degrees(mpmath.asin(mpmath.sqrt(sine2)))
            wanted["alpha"] = mpmath.ellipf(mpmath.asin(mpmath.sqrt(sine2)), 1 - m)
        half = Judge(scene).at(_exact(T / 2))
        wanted["spin_rate_half"] = mpf(half.phi_rate.mid().str(60, radius=False))
        wanted["precession_rate_half"] = mpf(half.psi_rate.mid().str(60, radius=False))
        bad = [key for key, value in wanted.items() if not _agree(record[key], value)]
        assert not bad, (name, bad)


SINGULAR: dict[str, dict[str, float]] = {
    "over the top": {"theta0_deg": 120, "psidot0": 1, "r0": 0.5, "thetadot0": 2.5},
    "over the bottom": {"theta0_deg": 60, "psidot0": -2, "r0": 1, "thetadot0": 0.7},
    "from the bottom's other side": {"theta0_deg": 60, "psidot0": -2, "r0": 1, "thetadot0": -0.7},
    "pendulum": {"theta0_deg": 60, "r0": 0},
    "whirling pendulum": {"theta0_deg": 60, "r0": 0, "thetadot0": 3},
    "whirling back": {"theta0_deg": 60, "r0": 0, "thetadot0": -3},
    "from the upper pole": {"theta0_deg": 0, "r0": 1, "thetadot0": 1},
    "from the upper pole backwards": {"theta0_deg": 0, "r0": 1, "thetadot0": -1},
    "from the lower pole": {"theta0_deg": 180, "r0": 1, "thetadot0": 1},
    "from the lower pole backwards": {"theta0_deg": 180, "r0": 1, "thetadot0": -1},
    "separatrix": {"theta0_deg": 60, "psidot0": 1, "r0": 1.5, "thetadot0": 0.5},
    "separatrix, rising": {"theta0_deg": 60, "psidot0": 1, "r0": 1.5, "thetadot0": -0.5},
    "steady": {"theta0_deg": 60, "psidot0": 1, "r0": 1.5},
    "sleeping": {"theta0_deg": 0, "r0": 3},
    "hanging": {"theta0_deg": 180, "r0": 3},
    "torque-free": {"theta0_deg": 50, "g": 0, "r0": 2, "psidot0": 1, "thetadot0": 1},
    "torque-free, no spin": {"theta0_deg": 50, "g": 0, "r0": 0, "psidot0": 1, "thetadot0": 1},
    "torque-free from the pole": {"theta0_deg": 0, "g": 0, "r0": 2, "thetadot0": 1},
}


def integrated(scene: dict[str, float], times: list[float]) -> np.ndarray[Any, Any]:
    """Return the quaternion at ascending times after the start, from Euler's equations."""
    A, C, r0, torque = scene["A"], scene["C"], scene["r0"], scene["m"] * scene["g"] * scene["s"]

    def slope(_: float, state: Any) -> list[float]:
        p, q, w, x, y, z = state
        return [
            ((A - C) * q * r0 + torque * 2 * (y * z + w * x)) / A,
            ((C - A) * p * r0 - torque * 2 * (x * z - w * y)) / A,
            (-x * p - y * q - z * r0) / 2,
            (w * p + y * r0 - z * q) / 2,
            (w * q + z * p - x * r0) / 2,
            (w * r0 + x * q - y * p) / 2,
        ]

    tilt = math.radians(scene["theta0_deg"])
    turn = scene["psidot0"] * math.sin(tilt)
    begin = [scene["thetadot0"], turn, math.cos(tilt / 2), math.sin(tilt / 2), 0, 0]
    tight = {"rtol": 1e-13, "atol": 1e-15, "t_eval": times}
    path: np.ndarray[Any, Any] = solve_ivp(slope, (0, times[-1]), begin, "DOP853", **tight).y
    return path[2:].T


@pytest.mark.parametrize("name", SINGULAR)
def test_singular_motions_are_those_of_the_integrator(name: str) -> None:
    scene, judge = UNIT | SINGULAR[name], Judge(UNIT | SINGULAR[name])
    times = [0.3, 1.1, 2.7, 4.9]  # separatrices are left by 5
    for t, wanted in zip(times, integrated(scene, times), strict=True):
        parts = [float(part) for part in judge.at(t).quaternion]
        assert parts == pytest.approx(wanted.tolist(), abs=3e-9), (name, t)


def test_degenerate_starts_are_decided_exactly() -> None:
    def facts(**inputs: float) -> Any:
        return Judge(UNIT | {"r0": 1} | inputs).facts

    assert facts(theta0_deg=60, psidot0=1, r0=1.5).steady
    assert not facts(theta0_deg=60, psidot0=1, r0=math.nextafter(1.5, 3)).steady
    assert facts(theta0_deg=60, psidot0=1, r0=1.5, thetadot0=0.5).separatrix
    assert not facts(theta0_deg=60, psidot0=1, r0=1.5, thetadot0=math.nextafter(0.5, 1)).separatrix
    assert facts(theta0_deg=60, psidot0=-2).over_bottom
    assert not facts(theta0_deg=61, psidot0=-2).over_bottom
    assert facts(theta0_deg=0).vertical
    assert facts(theta0_deg=180).vertical


def test_a_key_one_double_off_is_told() -> None:
    scene = UNIT | REGULAR["generic"]
    judge = Judge(scene)
    for key, ball in judge.record.items():
        if ball is not None and not ball.is_exact():
            nearest = float(ball.mid())
            assert judge.ulps(key, nearest) <= 0.5
            assert judge.ulps(key, math.nextafter(nearest, math.inf)) > 0.5
            assert judge.ulps(key, math.nextafter(nearest, -math.inf)) > 0.5


def test_a_turn_is_told() -> None:
    judge = Judge(UNIT | REGULAR["generic"])
    state = judge.at(1e9)
    exact = [float(value) for value in (*state[:3], *state.quaternion)]
    assert max(judge.errors(1e9, tuple(exact))) < 1
    for i in (1, 2):
        wrong = [x + (2 * math.pi if j == i else 0) for j, x in enumerate(exact)]
        assert judge.errors(1e9, tuple(wrong))[i] > 1e5
    assert min(judge.errors(1e9, tuple(-x for x in exact))[3:]) > 1e4
    assert judge.errors(1e9, (math.nan,) * 7) == [math.inf] * 7
