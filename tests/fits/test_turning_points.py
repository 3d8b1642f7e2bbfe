"""Turning points next to a pole: means over a period by mpmath, and tops that `solve` gave."""

from __future__ import annotations

import random

import mpmath
import numpy as np
import pytest
from conftest import Lagtop
from lagtop import Top, solve
from test_find import SEEN_KEYS

from lagrange_cli.fits.invert import invert, mean_inverse

EPS = 2.0**-52


def test_means_next_to_a_pole_are_within_10_eps() -> None:
    """Scipy's R_F + n/3 R_J had lost six of sixteen digits here."""
    rng, worst = random.Random(0), 0.0
    cases = [(1 - 0.9999973576932308, 1.67, 4e-10), (0.5, 1.5, 1e-8)]
    cases += [
        (10 ** rng.uniform(-14, 0), 10 ** rng.uniform(-18, -1), rng.uniform(0.01, 2))
        for _ in range(398)
    ]
    for m1, *ends in cases:
        at_u1, at_u2 = ends if rng.random() < 0.5 else ends[::-1]
        k_prime = m1**0.5
        with mpmath.workdps(50):
            m = 1 - mpmath.mpf(k_prime) ** 2
            n = 1 - mpmath.mpf(at_u1) / mpmath.mpf(at_u2)
            exact = mpmath.ellippi(n, m) / mpmath.ellipk(m) / at_u2
            off = abs(float(mean_inverse(np.array(k_prime), at_u1, at_u2)) / exact - 1)
        worst = max(worst, float(off) / EPS)
    assert 0.1 < worst < 10


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("upper", [True, False])
def test_a_and_b_of_a_top_that_starts_next_to_a_pole(seed: int, upper: bool) -> None:
    """Differences of cosines lost 38 of 100 tops at the upper pole; 11 crashed at the lower."""
    rng = random.Random(seed)
    near = 10 ** rng.uniform(-6, -1)
    tilt = {"theta0_deg": near if upper else 180 - near, "psidot0": rng.gauss(0, 1)}
    seen = solve(Top(m=1, s=1, g=100, A=1, C=1, r0=10 ** rng.uniform(0, 1.5), **tilt))
    found = invert([f"{key}={getattr(seen, key)!r}" for key in SEEN_KEYS])
    best = min(found, key=lambda x: abs(x.a / seen.a - 1) + abs(x.b / seen.b - 1))
    assert (best.a, best.b) == pytest.approx((seen.a, seen.b), rel=1e-13)
    assert best.mean_precession_rate == pytest.approx(seen.mean_precession_rate, rel=1e-12)


def test_the_greatest_tilt_may_be_next_to_the_lower_pole(lagtop: Lagtop) -> None:
    words = "theta_min=30 theta_max=179.9999999 T_nutation=1 mean_precession_rate=3"
    result = lagtop("find", *words.split(), "--keys", "mean_precession_rate,theta_max_deg")
    assert result.exit_code == 0, result.stderr
    rate, tilt = (float(x) for x in result.stdout.splitlines()[1].split(","))
    assert rate == pytest.approx(3, rel=1e-13)
    assert tilt == pytest.approx(179.9999999, abs=1e-12)
