"""What the theta series of the attitude leave out: cut short, their balls still hold the truth.

The tilt is compared with sn by Arb's own theta functions, the arguments with a long series.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import pytest
from flint import acb, arb
from lagtop import Top, solve
from scenes import UNIT

from lagrange_cli.arithmetic.ball import balls
from lagrange_cli.solver import series
from lagrange_cli.solver.series import evaluate, theta_series

DIGITS = 120
TOPS: dict[str, dict[str, Any]] = {
    "small k": {"r0": 3, "theta0_deg": 40},
    "k^2 = 0.46": {"r0": 1.5, "theta0_deg": 60},
    "k^2 = 0.73": {"r0": 1, "theta0_deg": 50},
    "near the separatrix": {"r0": 1.9, "theta0_deg": 1},
    "against the spin": {"r0": 1, "theta0_deg": 100, "psidot0": -1.5},
}
PHASES = [(0, "-0.5"), (0, "0.31"), (0, "0.75"), (1, "-0.75"), (1, "0.2")]


def evaluations(inputs: dict[str, Any], terms: int) -> Iterator[tuple[Any, Any, arb]]:
    """Yield X and Y by a short and by a long series, and (|Y|/|X|)^2 by theta functions."""
    motion: Any = solve(Top(**UNIT | inputs)).kind(DIGITS)
    short, long = (theta_series(motion, count) for count in (terms, 14))
    ar, gaps = motion.ar, motion.gaps
    tau = acb(0, (motion.K_prime / motion.K).x)
    for step, text in PHASES:
        phase = ar.convert(Fraction(text))
        place = (step + short.first + phase + 1) / 2  # w/2K + 1/2, counted from u2 (4,30)
        theta1, _, _, theta4 = acb.modular_theta(acb(place.x), tau)
        _, theta2, theta3, _ = acb.modular_theta(acb(0), tau)
        rise = gaps.u1_u2.x * ((theta3 * theta1) / (theta2 * theta4)).real ** 2
        square = (gaps.above_u2.x - rise) / (gaps.below_u2.x + rise)
        yield *(evaluate(ar, one, step, phase, 1) for one in (short, long)), square


@pytest.mark.parametrize("terms", [3, 4, 6])
@pytest.mark.parametrize("name", TOPS)
def test_a_series_cut_short_holds_the_truth(name: str, terms: int) -> None:
    with balls(DIGITS):
        for short, long, square in evaluations(TOPS[name], terms):
            for found in (short, long):
                ratio = found[2].x / found[0].x
                assert (ratio * ratio).overlaps(square)
            for one, whole in ((short[1], long[1]), (short[3], long[3])):
                assert one.x.overlaps(whole.x)
                assert whole.x.rad() < 1e-60


def test_the_bound_of_the_series_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    weights = series._weights

    def bare(ar: Any, *rest: Any) -> Any:
        return [x.middle for x in weights(ar, *rest)]

    monkeypatch.setattr(series, "_weights", bare)
    missed = 0
    with balls(DIGITS):
        for name in ("k^2 = 0.46", "k^2 = 0.73"):
            for short, long, _ in evaluations(TOPS[name], 3):
                missed += not short[1].x.overlaps(long[1].x)
    assert missed >= 5
