"""Standard deviations from residuals, the verdict on their correlation, and fast spins."""

from __future__ import annotations

import math

import fuzz_fits
import numpy as np
import pytest
from lagtop import Top, fit
from scipy.signal import lfilter

from lagrange_cli.fits.model import Residual, residual_of


@pytest.mark.parametrize(
    ("lag1", "is_noise"), [(0.05, True), (-0.09, True), (0.1, False), (-0.15, False)]
)
def test_the_bound_of_a_correlation(lag1: float, is_noise: bool) -> None:
    """Noise of 1000 rows stays within three standard deviations of 1/sqrt(1000), 0.095."""
    assert Residual(1000, 1e-3, lag1).is_noise is is_noise
    assert Residual(100, 1e-3, lag1).is_noise is True


def test_correlated_residuals_are_no_noise() -> None:
    rng = np.random.default_rng(5)
    white = rng.normal(size=20_000)
    red = lfilter([1], [1, -0.15], white)
    assert residual_of(white).is_noise
    assert not residual_of(red).is_noise
    assert residual_of(red).lag1 == pytest.approx(np.corrcoef(red[1:], red[:-1])[0, 1], abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("rows", [14, 30])
def test_deviations_from_residuals_count_degrees_of_freedom(rows: int) -> None:
    """A fit without sigma states what it would with sigma^2 = sum of squares / (rows - unknowns).

    The judge is the fit with any sigma: its chi^2 per degree of freedom is that sum over sigma^2.
    """
    top = Top(theta0_deg=40, thetadot0=1.0, psidot0=-2.0)
    t, rng = np.linspace(0, 1.1, rows), np.random.default_rng(7)
    theta = fuzz_fits.motion_of(top, t)["theta"] + rng.normal(scale=0.01, size=rows)
    known = {"psidot0": -2.0}
    given = fit(t, theta=theta, sigma=0.02, known=known)
    found = fit(t, theta=theta, known=known)
    freedom = given.fit.dof
    assert freedom == rows - given.fit.values.size < rows
    left = given.fit.residuals[0]["theta"]
    assert given.chi2_dof == pytest.approx(float(np.sum(left**2)) / 0.02**2 / freedom, rel=1e-6)
    for name in ("a", "b", "theta0"):
        if given.deviations[name]:
            ratio = found.deviations[name] / given.deviations[name]
            assert ratio == pytest.approx(math.sqrt(given.chi2_dof), rel=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_spin_of_more_than_half_a_turn_per_frame(sign: int) -> None:
    """Between frames phi turns by 6.8 rad: of the rates that look alike 50 is the slowest.

    A whole turn per frame less, 4 rad/s, would need C > 2A.
    """
    top = Top(m=1, s=1, g=60, A=1, C=0.2, r0=sign * 50, theta0_deg=60, psidot0=sign * 1.0)
    t = np.arange(120.0) * (2 * math.pi / 46)
    names, rng = ("theta", "phi", "psi"), np.random.default_rng(2)
    found = fit(t, **fuzz_fits.noisy(top, t, names, 1e-3, rng), sigma=1e-3)
    assert found.verdict == "good"
    assert found.values["r0"] == pytest.approx(50 * sign, abs=0.05)
    assert found.values["b"] == pytest.approx(10 * sign, rel=1e-2)
