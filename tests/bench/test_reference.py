"""The many-digit reference against the judge in balls, and its definition of errors."""

from __future__ import annotations

import math
import random

import mpmath
import pytest
from arb_balls import many_digits
from ball_judge import Judge
from lagtop import Top

from lagrange_cli.bench.battery import judged_inputs
from lagrange_cli.bench.hard_scenes import STRATA
from lagrange_cli.bench.reference import Reference, angle_units


@pytest.mark.parametrize("stratum", STRATA)
def test_the_reference_agrees_with_the_judge(stratum: str) -> None:
    """Legendre's third integral about the bottom, by mpmath and by Arb."""
    top = Top(**judged_inputs(stratum, random.Random(2)))
    reference, judge = Reference(top, 60), Judge(top.as_dict())
    t = 3.7 * float(reference.T)
    with mpmath.workdps(60):
        for mine, other in zip(reference.at(t)[:3], judge.at(t)[:3], strict=True):
            assert abs(mine - many_digits(other)) < 1e-25 * (1 + abs(mine))


def test_errors_are_counted_by_the_one_definition() -> None:
    exact = Reference(Top()).at(0.25)
    angles = float(exact.theta), float(exact.phi), float(exact.psi)
    assert max(angle_units(angles, exact)) <= 0.5
    off = (angles[0] + 2.0**-40, angles[1], angles[2])
    assert angle_units(off, exact)[0] > 1000
    assert angle_units((math.nan, angles[1], angles[2]), exact)[0] == math.inf
