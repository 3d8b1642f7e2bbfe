"""Exact tilts: signs of polynomials in their cosine, and their digits."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import pytest
from flint import fmpq_poly
from lagtop import Top

from lagrange_cli.arithmetic.enclosures import at_precision, ends_of
from lagrange_cli.top.derived import Tilt, rational

MOST = 1_400
MINIMAL: dict[float, tuple[int, ...]] = {
    **{0: (-1, 1), 30: (-3, 0, 4), 36: (-1, -2, 4), 45: (-1, 0, 2), 60: (-1, 2), 72: (-1, 2, 4)},
    **{90: (0, 1), 120: (1, 2), 180: (1, 1), 22.5: (1, 0, -8, 0, 8)},
}
"""Polynomials with the root cos(theta), the constant first, by theta in degrees."""


def sign_by_mpmath(degrees: Fraction, coefficients: tuple[Fraction | int, ...]) -> int:
    with mpmath.workdps(400):
        u = mpmath.cos(mpmath.pi * degrees.numerator / degrees.denominator / 180)
        terms = [mpmath.mpf(Fraction(c).numerator) / Fraction(c).denominator for c in coefficients]
        return int(mpmath.sign(sum(c * u**i for i, c in enumerate(terms))))


def sign(tilt: Tilt, *coefficients: Fraction | int) -> int:
    return tilt.sign(fmpq_poly([rational(x) for x in coefficients]), MOST)


@pytest.mark.parametrize("degrees", MINIMAL)
def test_a_polynomial_vanishes_at_its_root_and_not_one_bit_beside(degrees: float) -> None:
    exact, coefficients = Fraction(degrees), MINIMAL[degrees]
    third = [Fraction(c, 3) for c in coefficients]
    assert sign(Tilt(exact, None), *coefficients) == 0
    assert sign(Tilt(exact, None), *third) == 0
    tiny = Fraction(math.ulp(degrees)) if degrees else Fraction(1, 10**100)
    for beside in (exact - tiny, exact + tiny):
        if 0 <= beside <= 180:
            found = sign(Tilt(beside, None), *coefficients)
            assert found == sign_by_mpmath(beside, coefficients) != 0
    for small in (Fraction(1, 2**53), -Fraction(1, 10**300)):
        other = [Fraction(x) for x in coefficients]
        other[0] += small
        assert sign(Tilt(exact, None), *other) == (1 if small > 0 else -1)


@pytest.mark.parametrize("theta0", ["0.00001", "1.570796326794", "1.5707963267948966192", "3.1415"])
@pytest.mark.parametrize("degrees", [False, True])
def test_tilts_next_to_the_quarters_have_all_digits_asked_for(theta0: str, degrees: bool) -> None:
    """In degrees no digits are lost; in radians those are lost that agree with pi."""
    given = Fraction(theta0)
    tilt = Tilt(given * 57, None) if degrees else Tilt(None, given)
    with mpmath.workdps(100):
        exact = mpmath.mpf(given.numerator) / given.denominator
        exact = exact * 57 * mpmath.pi / 180 if degrees else exact
        balls = at_precision(60, lambda: [tilt.angle(), *tilt.sine_and_cosine()])
        truths = exact, mpmath.sin(exact), mpmath.cos(exact)
        for found, truth in zip(balls, truths, strict=True):
            low, high = (mpmath.mpf(str(end)) for end in ends_of(found))
            assert low <= truth <= high
            assert found.rel_accuracy_bits() > 3.33 * (57 if degrees else 38)


def test_a_tilt_in_doubles() -> None:
    assert Tilt(Fraction(60), None).doubles() == (3**0.5 / 2, 0.5, 0.5, 3**0.5 / 2)
    tiny = Fraction(1, 10**30)
    assert Tilt(180 - tiny, None).doubles()[::3] == pytest.approx(
        (math.radians(1e-30), math.radians(1e-30) / 2), rel=1e-15
    )
    assert Tilt(None, Fraction(0)).doubles() == (0, 1, 0, 1)
    assert Tilt.of(Top(theta0_rad=1).as_dict()) == Tilt(None, Fraction(1))
    assert Top(theta0_rad=1).inputs()["theta0_deg"] == pytest.approx(math.degrees(1), rel=1e-15)
