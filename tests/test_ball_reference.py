"""The reference in ball arithmetic against the frozen numbers, an integrator and known values.

The integrator (DOP853 on a quaternion) knows no Euler angle and no pole.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from ball_reference import BallReference
from engines import Body, dop853
from lagtop import Top
from mpmath import mpf
from scenes import EVERY_KIND
from test_frozen import FROZEN, numbers_of, top_of

UNIT: dict[str, float] = {"m": 1, "A": 1, "C": 1, "s": 1, "g": 1, "thetadot0": 0, "psidot0": 0}
GENERIC = UNIT | {"r0": 2, "theta0_deg": 70, "thetadot0": 0.7, "psidot0": 0.4}


@pytest.mark.parametrize("entry", FROZEN["records"][::13], ids=lambda entry: str(entry["top"]))
def test_records_are_those_of_another_arithmetic(entry: dict[str, Any]) -> None:
    """The frozen numbers have 30 digits, and were proved in decimals by lagtop's formulas."""
    record = BallReference(top_of(entry["top"]).as_dict()).record
    known = [(text, record.get(key)) for key, text in numbers_of(entry).items() if text]
    both = [(mpf(text), mpf(ball.mid().str(60, radius=False))) for text, ball in known if ball]
    for true, value in both:
        assert abs(value - true) <= mpf(10) ** -29 * abs(true) + mpf(10) ** -100
    assert len(both) > 8


SINGULAR = [
    *("over the top", "over the top, back", "over the bottom", "pendulum", "whirling"),
    *("from the upper pole", "back from the upper pole", "from the lower pole", "separatrix"),
    *("round from the lower pole", "steady", "sleeping", "hanging", "torque-free"),
    *("without torque over the poles", "without torque from the upper pole"),
]


@pytest.mark.parametrize("name", SINGULAR)
def test_singular_motions_are_those_of_the_integrator(name: str) -> None:
    scene = UNIT | EVERY_KIND[name]
    balls = BallReference(scene)
    _, states = dop853(Body.of(Top(**scene)), np.array([0, 0.3, 1.1, 2.7, 4.9]))
    for t, wanted in zip((0.3, 1.1, 2.7, 4.9), states[1:, :4], strict=True):  # then it departs
        parts = [float(part) for part in balls.at(t).quaternion]
        assert parts == pytest.approx(wanted.tolist(), abs=3e-9), (name, t)


def test_a_key_one_double_off_is_told() -> None:
    scene = GENERIC
    balls = BallReference(scene)
    for key, ball in balls.record.items():
        if ball is not None and not ball.is_exact():
            nearest = float(ball.mid())
            assert balls.ulps(key, nearest) <= 0.5
            assert balls.ulps(key, math.nextafter(nearest, math.inf)) > 0.5
            assert balls.ulps(key, math.nextafter(nearest, -math.inf)) > 0.5


def test_a_turn_is_told() -> None:
    balls = BallReference(GENERIC)
    state = balls.at(1e9)
    exact = [float(value) for value in (*state[:3], *state.quaternion)]
    assert max(balls.errors(1e9, tuple(exact))) < 1
    for i in (1, 2):
        wrong = [x + (2 * math.pi if j == i else 0) for j, x in enumerate(exact)]
        assert balls.errors(1e9, tuple(wrong))[i] > 1e5
    assert min(balls.errors(1e9, tuple(-x for x in exact))[3:]) > 1e4
    assert balls.errors(1e9, (math.nan,) * 7) == [math.inf] * 7
