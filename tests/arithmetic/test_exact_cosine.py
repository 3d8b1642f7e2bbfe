"""Signs and zeros of polynomials in a cosine, against minimal polynomials from textbooks."""

from __future__ import annotations

import random
from fractions import Fraction

import mpmath
import pytest

from lagrange_cli.arithmetic.exact_cosine import Cosine, Polynomial, U

MINIMAL = {
    "36": (-1, -2, 4),
    "72": (-1, 2, 4),
    "45": (-1, 0, 2),
    "30": (-3, 0, 4),
    "40": (1, -6, 0, 8),
    "20": (-1, -6, 0, 8),
    "24": (1, 8, -16, -8, 16),
    "15": (1, 0, -16, 0, 16),
    "7.5": (1, 0, -64, 0, 320, 0, -512, 0, 256),
    "60": (-1, 2),
    "90": (0, 1),
    "120": (1, 2),
    "135": (-1, 0, 2),
    "0": (-1, 1),
    "180": (1, 1),
}
"""Degrees, and the polynomial of least degree that vanishes there, the lowest power first."""


def at_degrees(degrees: str | Fraction | int) -> Cosine:
    """Return the cosine of some degrees."""
    return Cosine(Fraction(degrees), None)


def at_radians(radians: str) -> Cosine:
    """Return the cosine of some radians."""
    return Cosine(None, Fraction(radians))


def exact_sign(cosine: Cosine, coefficients: tuple[Fraction | int, ...]) -> int:
    """Return the sign of a polynomial by mpmath, in 400 digits."""
    with mpmath.workdps(400):
        if cosine.radians is None:
            degrees = cosine.degrees or Fraction(0)
            x = mpmath.cospi(mpmath.mpf(degrees.numerator) / degrees.denominator / 180)
        else:
            x = mpmath.cos(mpmath.mpf(cosine.radians.numerator) / cosine.radians.denominator)
        value = mpmath.mpf(0)
        for c in map(Fraction, reversed(coefficients)):
            value = value * x + mpmath.mpf(c.numerator) / c.denominator
        return int(mpmath.sign(value))


@pytest.mark.parametrize(("degrees", "coefficients"), MINIMAL.items())
def test_minimal_polynomials_vanish(degrees: str, coefficients: tuple[int, ...]) -> None:
    cosine, polynomial = at_degrees(degrees), Polynomial(*coefficients)
    assert cosine.vanishes(polynomial)
    assert cosine.sign(polynomial) == 0
    assert cosine.vanishes(polynomial * (3 + U * U) * Fraction(2, 7))
    assert cosine.sign((5 * U - 1) * polynomial) == 0


@pytest.mark.parametrize(("degrees", "coefficients"), MINIMAL.items())
@pytest.mark.parametrize("miss", ["1e-20", "1e-100", "1e-300"])
def test_a_near_miss_is_no_zero(degrees: str, coefficients: tuple[int, ...], miss: str) -> None:
    cosine, polynomial = at_degrees(degrees), Polynomial(*coefficients)
    for shift in (Fraction(miss), -Fraction(miss)):
        assert not cosine.vanishes(polynomial + shift)
        assert cosine.sign(polynomial + shift) == (1 if shift > 0 else -1)
    beside = at_degrees(Fraction(degrees) + (Fraction(miss) if degrees != "180" else 0))
    if degrees not in {"0", "180"}:
        assert not beside.vanishes(polynomial)


@pytest.mark.parametrize(("degrees", "coefficients"), MINIMAL.items())
def test_no_polynomial_of_lower_degree_vanishes(
    degrees: str, coefficients: tuple[int, ...]
) -> None:
    rng = random.Random(degrees)
    for _ in range(50):
        shorter = [rng.randrange(-4, 5) for _ in coefficients[:-1]]
        assert at_degrees(degrees).vanishes(Polynomial(*shorter)) == (not any(shorter))


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [7, 53, 136, Fraction(1, 3), Fraction(45, 4)])
def test_multiple_angles_are_identities(degrees: Fraction | int) -> None:
    """T_n(cos x) = cos(n x), rational where n x is a multiple of 60 or 90 degrees."""
    rational: dict[Fraction | int, Fraction | int] = {
        0: 1,
        60: Fraction(1, 2),
        90: 0,
        120: Fraction(-1, 2),
        180: -1,
    }
    chebyshev = [Polynomial(1), U]
    tried = 0
    for n in range(1, 41):
        turned = n * Fraction(degrees) % 360
        value = rational.get(min(turned, 360 - turned))
        if value is not None:
            assert at_degrees(degrees).vanishes(chebyshev[n] - value)
            assert not at_degrees(degrees).vanishes(chebyshev[n] - value - Fraction("1e-100"))
            tried += 1
        else:
            wrong = Polynomial(*chebyshev[n].coefficients) - Fraction(1, 2)
            assert not at_degrees(degrees).vanishes(wrong)
        chebyshev.append(2 * U * chebyshev[n] - chebyshev[n - 1])
    assert tried or Fraction(degrees).denominator > 1 or degrees in {7, 11, 31, 53, 97, 161}


def test_random_signs() -> None:
    rng = random.Random(36)
    for _ in range(200):
        tilt = Fraction(rng.choice([*MINIMAL, "0.1", "1e-9", "179.5", "53.125"]))
        cosine = rng.choice([Cosine(tilt, None), Cosine(None, tilt / 60 or Fraction(1))])
        coefficients = tuple(Fraction(rng.randrange(-9, 10), rng.randrange(1, 5)) for _ in range(5))
        if not cosine.vanishes(Polynomial(*coefficients)):
            assert cosine.sign(Polynomial(*coefficients)) == exact_sign(cosine, coefficients)


def test_the_cosine_of_radians_is_transcendental() -> None:
    cosine = at_radians("1")
    with mpmath.workdps(150):
        digits = mpmath.nstr(mpmath.cos(1), 120)
    close = Fraction(digits)
    assert not cosine.vanishes(U - close)
    assert cosine.sign(U - close) == exact_sign(cosine, (-close, 1)) != 0
    assert cosine.sign(U - close + Fraction("1e-118")) == 1
    assert cosine.sign(U - close - Fraction("1e-118")) == -1
    assert cosine.vanishes(U - U)
    assert at_radians("0").rational == 1
    assert cosine.rational is None


@pytest.mark.parametrize(("degrees", "value"), [(0, 1), (60, 0.5), (90, 0), (120, -0.5), (180, -1)])
def test_niven(degrees: int, value: float) -> None:
    assert at_degrees(degrees).rational == Fraction(value)
    assert at_degrees(degrees + Fraction("1e-30") if degrees < 180 else 179).rational is None


def test_polynomials_add_and_multiply() -> None:
    p = (1 + U) * (1 - U) - Fraction(1, 3)
    assert tuple(p.coefficients) == (Fraction(2, 3), 0, -1)
    assert tuple((2 - U).coefficients) == (2, -1)


@pytest.mark.parametrize(
    ("degrees", "coefficients", "value"),
    [
        (45, [0, 0, 1], "1/2"),
        (30, [Fraction(1, 3), 0, 4], "10/3"),
        (36, [0, Fraction(-1, 2), 1], "1/4"),  # cos 36 = (1 + sqrt 5)/4
        (20, [7, -3, 0, 4], "15/2"),  # cos 3x = 4 cos^3 x - 3 cos x
        (18, [0, 0, -20, 0, 16], "-5"),  # cos 5x / cos x
        (50, [7, -3, 0, 4], None),
        (45, [0, 1, 1], None),
        (Fraction(1, 7), [0, 0, 1], None),
    ],
)
def test_polynomials_with_rational_values(
    degrees: Fraction | int, coefficients: list[Fraction | int], value: str | None
) -> None:
    cosine = Cosine(Fraction(degrees), None)
    expected = None if value is None else Fraction(value)
    assert cosine.fraction(Polynomial(*coefficients, 0)) == expected
