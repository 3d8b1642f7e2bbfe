"""Parts of a fit against numbers that are known before: descent, noise, means, decay."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from lagtop import fit
from machines import filtered
from scipy.optimize import curve_fit

from lagrange_cli.inverse.checks import CHANCE, Residuals
from lagrange_cli.inverse.decay import decay_of
from lagrange_cli.inverse.descent import descended, polished
from lagrange_cli.inverse.known import compared
from lagrange_cli.inverse.outcome import Number
from lagrange_cli.inverse.signals import (
    mean_rate,
    neighbour_noise,
    step_between,
)


def test_a_bent_valley_is_followed_to_its_end() -> None:
    """Rosenbrock's valley, with sides of 100 times its slope, from several starts at once."""
    starts = np.array([[-1.2, 1.0], [3.0, -4.0], [-2.0, 4.0]])

    def valley(x: Any, who: Any) -> Any:
        assert x.shape[0] == np.size(who)
        return np.stack([1 - x[..., 0], 100 * (x[..., 1] - x[..., 0] ** 2)], axis=-1)

    for central in (False, True):
        ends, chi2 = descended(valley, starts, 40, gain=1e-12, central=central)
        assert ends == pytest.approx(1, abs=1e-5)
        assert chi2.max() < 1e-10
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


@pytest.mark.parametrize("factor", [30 / math.pi, 60, 1e3, 1e7])
def test_a_contradiction_by_a_unit_says_so(factor: float) -> None:
    for given, words in ((3 * factor, "times as large"), (3 / factor, "of it")):
        far, agrees, text = compared("C", (given, 0.0), (3.0, 0.01), {})
        assert not agrees
        assert far == pytest.approx(abs(given - 3) / 0.01)
        assert f"{words}: check the units, or omit C" in text
    far, agrees, text = compared("r0", (3.04, 0.03), (3.0, 0.04), {})
    assert (agrees, text.rpartition(": ")[2]) == (True, "0.8 sigma")
    assert compared("r0", (3.4, 0.03), (3.0, 0.04), {})[2].endswith(
        "8 sigma apart: omit r0, or check the unit of t"
    )


def test_noise_steps_and_mean_rates_of_signals() -> None:
    rng, t = np.random.default_rng(3), np.arange(900) / 50
    y = 3 * np.sin(2 * t) + rng.normal(scale=0.02, size=900)
    assert neighbour_noise(y) == pytest.approx(0.02, rel=0.08)
    assert step_between(np.round(y / 0.3) * 0.3) == pytest.approx(0.3)
    assert step_between(np.ones(9)) == 0
    for rate in (40.0, -150.0):
        assert mean_rate(t, np.angle(np.exp(1j * (rate * t + y / 9))), 0.02) == pytest.approx(
            rate, abs=0.1
        )
    uneven = np.sort(rng.uniform(0, 18, 900))
    assert mean_rate(uneven, 40 * uneven + y / 9, 0.02) == pytest.approx(40, abs=0.1)


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


def test_means_of_a_steady_precession() -> None:
    rng, t = np.random.default_rng(6), np.linspace(0, 4, 200)
    theta, psi, phi = (x + rng.normal(scale=0.01, size=200) for x in (0 * t + 1, 2 * t, 15 * t))
    outcome = fit(t, theta=theta, psi=psi, phi=phi)
    assert outcome.verdict == "good, no nutation"
    rate = 0.01 * math.sqrt(12 / 200) / 4
    r0 = math.hypot(rate, rate * math.cos(1), 2 * math.sin(1) * 0.01 / math.sqrt(200))
    truth = {"mean_tilt_deg": (math.degrees(1), math.degrees(0.01 / math.sqrt(200)))}
    truth |= {"mean_precession_rate": (2, rate), "mean_spin_rate": (15, rate)}
    truth |= {"r0": (15 + 2 * math.cos(1), r0)}
    for key, (value, std) in truth.items():
        found = outcome.numbers[key]
        assert found.std == pytest.approx(std, rel=0.2), key
        assert abs(found.value - value) < 4 * std, key


def test_a_decay_is_that_of_the_windows() -> None:
    def window(t: float, a_off: float) -> Any:
        """Return a good fit whose a is off, and with it its r0, by the correlation 0.6."""
        value = -50 * math.exp(-t / 20)
        numbers = {"r0": Number(value + 0.3 * a_off, 1.0, "", 0.5)}
        numbers["a"] = Number(90 + a_off, 1.0, "", 1.0)
        part = SimpleNamespace(middle=t)
        pairs = {"a and r0": 0.6}
        return SimpleNamespace(verdict="good", numbers=numbers, correlations=pairs, recording=part)

    t = np.array([1.0, 3.0, 5.0, 7.0])
    found: Any = decay_of([window(*x) for x in zip(t, (0.5, -0.7, 0.9, -0.7), strict=True)])
    assert (found.quantity, found.rate, found.time) == ("r0", *map(pytest.approx, (0.05, 20)))
    assert [found.value(x) for x in (0, 20)] == pytest.approx([-50, -50 / math.e])
    weights = (50 * np.exp(-t / 20) / 0.4) ** 2  # 0.4 is what the correlation leaves of 0.5
    middle = np.average(t, weights=weights)
    assert found.rate_std == pytest.approx(np.sum(weights * (t - middle) ** 2) ** -0.5)
    assert found.time_std == pytest.approx(20**2 * found.rate_std)
    assert found.chi2_dof == pytest.approx(0, abs=1e-9)
    assert decay_of([window(x, 0) for x in (1, 2)]) is None


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
