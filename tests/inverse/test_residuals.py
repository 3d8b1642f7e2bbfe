"""Noise and residuals against numbers that are known before, and the descent of least squares."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
from machines import filtered
from noisy_recordings import DEGREE, fitted, recorded
from scipy.optimize import curve_fit
from scipy.stats import chi2

from lagrange_cli.inverse.descent import descended, polished
from lagrange_cli.inverse.measured import measured
from lagrange_cli.inverse.residuals import CHANCE, Residuals, chi2_bounds
from lagrange_cli.inverse.search import best_fit
from lagrange_cli.inverse.signals import mean_rate, neighbour_noise, step_between
from lagrange_cli.recordings.recording import recording_of


def test_a_bent_valley_is_followed_to_its_end() -> None:
    """Rosenbrock's valley, with sides of 100 times its slope, from several starts at once."""
    starts = np.array([[-1.2, 1.0], [3.0, -4.0], [-2.0, 4.0]])

    def valley(x: Any, who: Any) -> Any:
        assert x.shape[0] == np.size(who)
        return np.stack([1 - x[..., 0], 100 * (x[..., 1] - x[..., 0] ** 2)], axis=-1)

    for central in (False, True):
        ends, sums = descended(valley, starts, 40, gain=1e-12, central=central)
        assert ends == pytest.approx(1, abs=1e-5)
        assert sums.max() < 1e-10
    end = polished(valley, starts[1:2], 40)  # chi^2 would grow by steps with the first slopes
    assert np.sum(valley(end[:, np.newaxis], [0]) ** 2) < 0.1


def test_many_rows_are_fitted_from_the_fit_of_some() -> None:
    t = np.linspace(0, 1, 20_000)
    y = 2 * np.exp(-3 * t) + np.random.default_rng(4).normal(scale=0.1, size=t.size)

    def rest(x: Any, _: Any) -> Any:
        return (y - x[..., :1] * np.exp(-x[..., 1:] * t)) / 0.1

    exact, covariance = curve_fit(lambda t, size, rate: size * np.exp(-rate * t), t, y, (2, 3))
    found = polished(rest, exact[np.newaxis] + [[0.05, 0.3]], 40)[0]
    assert np.all(np.abs(found - exact) < 0.32 * np.sqrt(np.diag(covariance)))  # chi^2 falls by 0.1


def test_noise_steps_and_mean_rates_of_signals() -> None:
    rng, t = np.random.default_rng(3), np.arange(900) / 50
    y = 3 * np.sin(2 * t) + rng.normal(scale=0.02, size=900)
    assert neighbour_noise(y) == pytest.approx(0.02, rel=0.08)
    assert step_between(np.round(y / 0.3) * 0.3) == pytest.approx(0.3)
    assert step_between(np.ones(9)) == 0
    uneven = np.sort(rng.uniform(0, 18, 900))
    for times, rate in ((t, 40), (t, -150), (uneven, 40)):
        angle = rate * times + y / 9
        assert mean_rate(times, np.angle(np.exp(1j * angle)), 0.02) == pytest.approx(rate, abs=0.1)


def test_residuals_of_an_encoder_and_outliers() -> None:
    rng, t = np.random.default_rng(4), np.arange(400.0)
    steps = rng.uniform(-0.5, 0.5, 400)
    assert Residuals(t, steps, step=1.0).is_coarse
    assert not Residuals(t, 2 * steps, step=1.0).is_coarse
    sizes = np.where(t % 2, 0.6745, -0.6745)  # as those of noise with the standard deviation 1
    assert Residuals(t, np.where(t == 7, -15.1, sizes)).outliers.nonzero()[0].tolist() == [7]
    assert not Residuals(t, np.where(t == 7, -14.9, sizes)).outliers.any()
    assert Residuals(t, np.ones(400) + steps / 9).rms == pytest.approx(1, rel=0.01)


@pytest.mark.parametrize("seconds", [0.2, 30.0])
def test_noise_may_correlate_within_half_a_period(seconds: float) -> None:
    rng, t = np.random.default_rng(5), np.linspace(0, seconds, 600)
    smooth = np.convolve(rng.normal(size=605), np.ones(6) / 6, "valid")
    rest = Residuals(t, smooth)
    assert rest.reach in {5, 6}
    assert not [*rest.faults("x", 600 / 24 / seconds, CHANCE)]
    (fault,) = rest.faults("x", 600 / 9 / seconds, CHANCE)
    assert fault.startswith("the residuals of x are not noise: neighbours correlate by 0.8")
    assert rest.widening() == pytest.approx(math.sqrt(6), rel=0.1)
    lost = rest.lost(600 / 24 / seconds)  # of the mean of six: (n^2 - 1)/24 w^2
    assert lost == pytest.approx((2 * math.pi / 24) ** 2 * 35 / 24, rel=0.3)


def test_a_filter_explains_smooth_noise_but_no_slow_oscillation() -> None:
    rng, t = np.random.default_rng(7), np.arange(600.0)
    noise = rng.normal(size=600)
    for way in ("mean", "lag", "cubic"):
        assert Residuals(t, filtered(noise, 5, way)).is_smoothed, way
    assert Residuals(t, noise).reach <= 2
    assert Residuals(t, np.sin(0.9 * t) + noise / 10).reach > t.size / 5  # it passes through 0
    slow = Residuals(t, noise + np.sin(t / 9))
    assert not slow.is_smoothed
    assert any(slow.faults("x", 1 / 40, CHANCE))
    assert Residuals(t, noise / 20, range=0.1).is_large
    assert not Residuals(t, noise / 20, range=0.4).is_large
    noisy = Residuals(t, noise / 20, neighbours=0.05, range=0.13)
    assert not noisy.is_large  # a nutation of twice the noise is seen in many rows


def test_noise_hardly_ever_fails_a_test() -> None:
    rng, t = np.random.default_rng(18), np.linspace(0, 1, 90)
    faults = [any(Residuals(t, rng.normal(size=90)).faults("x", 4.0, CHANCE)) for _ in range(500)]
    assert sum(faults) <= 8  # 2.7 expected
    wave = Residuals(t, rng.normal(size=90) + 1.5 * np.sin(2 * math.pi * 22.25 * t))
    assert abs(wave.autocorrelation) < 0.2  # four rows per period
    assert next(wave.faults("x", 22.25, CHANCE)).endswith("they drift or oscillate")
    for rows, width, most in ((300, 5, 6), (70, 3, 25)):  # harmonics describe much of few rows
        noise = rng.normal(size=(300, rows + width)).cumsum(axis=1)
        smooth = (noise[:, width:] - noise[:, :-width]) / width
        faults = [
            any(Residuals(np.arange(1.0 * rows), y).faults("x", 0.05, CHANCE)) for y in smooth
        ]
        assert sum(faults) <= most
    drift = Residuals(t, rng.normal(size=90) + 3 * t * np.sin(8 * math.pi * t))
    assert any(drift.faults("x", 4.0, CHANCE))
    for dof in (1, 100):
        exact = chi2.ppf([CHANCE / 2, 1 - CHANCE / 2], dof) / dof
        assert chi2_bounds(dof) == pytest.approx(tuple(exact), rel=1e-6)


def test_sigma_is_tested_on_both_sides() -> None:
    t, seen = recorded("theta", "psi", seed=14)
    plain = fitted(t, seen)
    sigma = {x: y.rms * (100 / plain.dof) ** 0.5 for x, y in plain.residuals.items()}
    again = fitted(t, seen, sigma=sigma)
    assert again.chi2_dof == pytest.approx(1, rel=1e-3)
    assert again.numbers["b"][:2] == pytest.approx(plain.numbers["b"][:2], rel=1e-3)
    one = recording_of(t, dict(seen))
    low, high = (best_fit(measured(one, x * DEGREE), {}) for x in (0.15, 0.6))
    assert re.match("chi2/dof = .*: the rms of (theta|psi) is (1.9|2)", low.failures()[0])
    assert high.verdict == "good"
    assert "the noise is below sigma" in high.remarks[-1]
