"""The reference in 50 digits against theta functions, and the definition of error."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import mpmath
import pytest
from hard_scenes import HARD_KINDS, nutating
from lagtop import Top, solve

from lagrange_cli.bench.reference import Reference, rotation_angle
from lagrange_cli.solver.tables import ProvedTable


@pytest.mark.parametrize("kind", [*HARD_KINDS, "generic by phidot0"])
def test_attitudes_agree_with_the_reference(kind: str) -> None:
    """Legendre's third integral from the lowest point, and theta functions from the highest."""
    kind, _, spin = kind.partition(" by ")
    scene = nutating(kind, random.Random(2))
    top = Top(**({spin: scene.pop("r0")} if spin else {}), **scene)
    reference = Reference(top)
    t = 3.7 * float(reference.T)
    row = ProvedTable(solve(top), ["quaternion"], 40).row(Fraction(t))
    assert rotation_angle([x.value for x in row], reference.attitude(t)) < 1e-20


def test_the_error_is_the_angle_of_a_rotation() -> None:
    turned = [math.cos(5e-13), 0.0, math.sin(5e-13), 0.0]
    start = tuple(map(mpmath.mpf, (1, 0, 0, 0)))
    assert rotation_angle(turned, start) == pytest.approx(1e-12, rel=1e-12)
    assert rotation_angle([-2 * x for x in turned], start) == pytest.approx(1e-12, rel=1e-12)
    assert rotation_angle([0.0, 1.0, 0.0, 0.0], start) == pytest.approx(math.pi)
    assert rotation_angle([math.nan, 1.0, 0.0, 0.0], start) == math.inf
    assert rotation_angle(start, start) == 0
