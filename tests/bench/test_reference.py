"""The reference in 50 digits against Arb with other formulas, and the definition of error."""

from __future__ import annotations

import math
import random

import mpmath
import pytest
from ball_reference import BallReference
from balls.scene import many_digits
from hard_scenes import HARD_KINDS, nutating
from lagtop import Top

from lagrange_cli.bench.reference import Reference, inputs_of, rotation_angle


@pytest.mark.parametrize("kind", HARD_KINDS)
def test_attitudes_agree_with_the_reference(kind: str) -> None:
    """Legendre's third integral from the lowest point, by mpmath and by Arb."""
    top = Top(**nutating(kind, random.Random(2)))
    reference, balls = Reference(inputs_of(top)), BallReference(top.as_dict())
    t = 3.7 * float(reference.T)
    with mpmath.workdps(50):
        theta, phi, psi = map(many_digits, balls.at(t)[:3])
        cos, sin = mpmath.cos(theta / 2), mpmath.sin(theta / 2)
        plus, minus = (psi + phi) / 2, (psi - phi) / 2
        attitude = (
            *(cos * mpmath.cos(plus), sin * mpmath.cos(minus)),
            *(sin * mpmath.sin(minus), cos * mpmath.sin(plus)),
        )
    assert rotation_angle(attitude, reference.attitude(t)) < 1e-20


def test_the_error_is_the_angle_of_a_rotation() -> None:
    half = 1e-12 / 2
    turned = [math.cos(half), 0.0, math.sin(half), 0.0]
    start = tuple(map(mpmath.mpf, (1, 0, 0, 0)))
    assert rotation_angle(turned, start) == pytest.approx(1e-12, rel=1e-12)
    assert rotation_angle([-2 * x for x in turned], start) == pytest.approx(1e-12, rel=1e-12)
    assert rotation_angle([0.0, 1.0, 0.0, 0.0], start) == pytest.approx(math.pi)
    assert rotation_angle([math.nan, 1.0, 0.0, 0.0], start) == math.inf
    assert rotation_angle(start, start) == 0
