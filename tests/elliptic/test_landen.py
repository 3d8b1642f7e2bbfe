"""Places in a period by Landen's transformation, against mpmath's incomplete integral."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import mpmath
import numpy as np
import pytest

from lagrange_cli.arithmetic.arrays import PAIRS
from lagrange_cli.arithmetic.decimals import decimals
from lagrange_cli.arithmetic.double_double import DoubleDouble
from lagrange_cli.elliptic.complete import cosine_and_sine, hyperbolic_cosine_and_sine

AR = decimals(40)
PLACES = [("0", "1"), ("1e-60", "1"), ("0.3", "0.7"), ("2", "1e-30"), ("1", "0")]


def place(modulus: Any, s2: Any, c2: Any, *, imaginary: bool = False) -> mpmath.mpf:
    """Return pi F(phi, m)/2K(m) for the amplitude phi with sin^2 : cos^2 = s2 : c2.

    An imaginary place is pi F(phi, 1 - m)/2K(m).
    """
    m, sine2, cosine2 = (
        mpmath.mpf(x if isinstance(x, float) else str(x)) for x in (modulus, s2, c2)
    )
    phi = mpmath.atan2(mpmath.sqrt(sine2), mpmath.sqrt(cosine2))
    return mpmath.pi * mpmath.ellipf(phi, 1 - m if imaginary else m) / (2 * mpmath.ellipk(m))


def away(value: Decimal, exact: mpmath.mpf) -> float:
    found = mpmath.mpf(str(value))
    return float(abs(found - exact) / abs(exact)) if exact else float(abs(found))


@pytest.mark.parametrize(("s2", "c2"), PLACES)
@pytest.mark.parametrize("m", ["0", "1e-30", "0.2", "0.5"])
def test_places_on_the_real_axis(m: str, s2: str, c2: str) -> None:
    with mpmath.workdps(120), AR.working():
        modulus = Decimal(m)
        x = place(modulus, s2, c2)
        cos, sin = cosine_and_sine(
            AR, m=modulus, k_prime=(1 - modulus).sqrt(), s2=Decimal(s2), c2=Decimal(c2)
        )
        assert away(sin, mpmath.sin(x)) < 1e-37
        exact = mpmath.cos(x) if Decimal(c2) else mpmath.mpf(0)
        assert away(cos, exact) < 1e-37


@pytest.mark.parametrize(("s2", "c2"), PLACES)
@pytest.mark.parametrize("m", ["1e-30", "0.2", "0.5"])
def test_places_on_the_imaginary_axis(m: str, s2: str, c2: str) -> None:
    with mpmath.workdps(120), AR.working():
        modulus = Decimal(m)
        y = place(modulus, s2, c2, imaginary=True)
        cosh, sinh = hyperbolic_cosine_and_sine(
            AR, m=modulus, k_prime=(1 - modulus).sqrt(), s2=Decimal(s2), c2=Decimal(c2)
        )
        assert away(sinh, mpmath.sinh(y)) < 1e-37
        assert away(cosh, mpmath.cosh(y)) < 1e-37


def test_pairs_of_doubles() -> None:
    m, s2, c2 = np.array([[0.0, 0.125, 0.5], [0.3, 0.9, 1e-20], [0.7, 0.1, 1.0]])
    cos, sin = cosine_and_sine(
        PAIRS,
        m=DoubleDouble(m),
        k_prime=DoubleDouble(1 - m).sqrt(),
        s2=DoubleDouble(s2),
        c2=DoubleDouble(c2),
    )
    with mpmath.workdps(60):
        for i in range(3):
            x = place(*map(float, (m[i], s2[i], c2[i])))
            for found, exact in ((cos, mpmath.cos(x)), (sin, mpmath.sin(x))):
                value = mpmath.mpf(found.high[i]) + mpmath.mpf(found.low[i])
                assert abs(value - exact) < 1e-30 * exact
