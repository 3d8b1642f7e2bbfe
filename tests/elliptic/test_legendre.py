"""Legendre's F, E and Pi for every modulus, against mpmath's functions and quadrature."""

from __future__ import annotations

import math
import random
from decimal import Decimal
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import Lagtop
from function_reference import cells_of


def rows(
    lagtop: Lagtop, name: str, value: float, amplitudes: list[complex], *more: str
) -> list[list[complex]]:
    """Return F, E and, with n, Pi of some amplitudes."""
    texts = [
        f"{Decimal(z.real)}{Decimal(z.imag):+f}i" if z.imag else f"{Decimal(z.real):f}"
        for z in amplitudes
    ]
    words = f"--{name}={Decimal(value)}", f"--phi={','.join(texts)}", *more
    cells = cells_of(lagtop, *words, digits=None)
    nothing = ["0"] * len(texts)
    parts = [
        zip(cells.get(x) or cells[f"{x}_re"], cells.get(f"{x}_im", nothing), strict=True)
        for x in ("F", "E", "Pi")
        if {x, f"{x}_re"} & {*cells}
    ]
    return [[complex(float(re), float(im)) for re, im in row] for row in zip(*parts, strict=True)]


NODES, WEIGHTS = np.polynomial.legendre.leggauss(120)


def line(function: Any, start: complex, end: complex) -> Any:
    """Return an integral along a line; the substitution allows roots that vanish at its ends."""
    half, middle, w = (end - start) / 2, (end + start) / 2, np.pi / 2 * NODES
    values = function(middle + half * np.sin(w)) * half * np.cos(w)
    return (WEIGHTS * values).sum() * np.pi / 2


def by_quadrature(m: float, phi: complex, n: float) -> list[complex]:
    """Return F, E and Pi along the real axis to Re phi, and then parallel to the imaginary axis.

    Each stretch of the real axis is the mean of two ways around its middle, one on each side.  A
    pole there leaves its principal value.
    """
    side = -1 if phi.real < 0 else 1
    x, end = side * phi.real, side * phi
    bends = [i * np.pi + s * np.arcsin(m**-0.5) for i in range(4) for s in (1, -1) if m > 1]
    stops = sorted({0.0, x, *(t for t in bends if 0 < t < x), *np.arange(0, x, np.pi / 2)})

    def integral(integrand: Any) -> complex:
        def leg(*places: complex, on_axis: float) -> Any:
            is_below = m * np.sin(on_axis) ** 2 < 1

            def along(t: Any) -> Any:  # with the root +i |Delta| beyond a branch point
                square = 1 - m * np.sin(t) ** 2 + 0j
                return integrand(t, np.sqrt(square) if is_below else 1j * np.sqrt(-square))

            return sum(line(along, *ends) for ends in pairwise(places))

        total = leg(x, end, on_axis=x)
        for a, b in pairwise(stops):
            ways = ((a + b) / 2 + 0.5j * s * (b - a) for s in (1, -1))
            total += sum(leg(a, way, b, on_axis=(a + b) / 2) for way in ways) / 2
        return complex(total) * side

    kinds = (lambda t, d: 1 / d, lambda t, d: d, lambda t, d: 1 / (1 - n * np.sin(t) ** 2) / d)
    return [integral(kind) for kind in kinds]


CASES = [
    *((0.6, 4.2, 0.4), (0.9, -2 + 0.7j, None), (0.3, 1.2, 7.0), (0.8, -4.4, 1.5)),
    *((-4.0, 2.6, -3.0), (-0.5, -1.7 + 1j, None), (-9.0, 1.1, 3.0)),
    *((4.0, 0.4, 0.3), (4.0, 1.3, -2.0), (4.0, 3.4, None), (1.2, -2.2, 0.9)),
    *((4.0, 1.3 + 0.6j, None), (4.0, 1.3 - 0.6j, None), (4.0, -2.0 + 0.3j, None)),
    *((4.0, 0.3 + 0.9j, None), (4.0, 1.4, 2.5), (4.0, 1.2, 6.0), (2.5, -2.9, 1.7)),
]
"""Parameters m, amplitudes in radians, and n."""


@pytest.mark.parametrize(("m", "phi", "n"), CASES)
def test_path(m: float, phi: complex, n: float | None, lagtop: Lagtop) -> None:
    """The integrals are those of the path, on every side of branch points and poles."""
    (found,) = rows(lagtop, "m", m, [phi], "--rad", *([] if n is None else [f"--n={n}"]))
    for value, true in zip(found, by_quadrature(m, phi, n or 0), strict=False):
        assert abs(value - true) <= 1e-5 * (1 + abs(true)), (m, phi, n, found)


@pytest.mark.parametrize("count", [9, pytest.param(600, marks=pytest.mark.slow)])
def test_functions_of_mpmath(count: int, lagtop: Lagtop) -> None:
    """mpmath has the same branches for k in [0, 1), for imaginary k, and for k sin(Re phi) < 1."""
    rng = random.Random(61)
    for i in range(count):
        m = [rng.random(), -(10 ** rng.uniform(-3, 3)), 1 + 10 ** rng.uniform(-3, 2)][i % 3]
        reach = 7 if m < 1 else math.asin(m**-0.5)
        phi = complex(rng.uniform(-reach, reach), rng.choice([0, rng.uniform(-3, 3)]))
        n = None if phi.imag else rng.uniform(-9, 1)
        more = [] if n is None else [f"--n={Decimal(n)}"]
        (found,) = rows(lagtop, "m", m, [phi], "--rad", *more)
        with mpmath.workdps(40):
            exact = [mpmath.ellipf(phi, m), mpmath.ellipe(phi, m)]
            exact += [] if n is None else [mpmath.ellippi(n, phi, m)]
            for value, true in zip(found, exact, strict=True):
                assert abs(value - true) <= 2.3e-16 * abs(true), (m, phi, n)


@pytest.mark.parametrize("degrees", [False, True])
@pytest.mark.parametrize(("name", "value"), [("k", 0.3), ("k_prime", 0.03), ("k_prime", 1e-9)])
def test_rounding(name: str, value: float, degrees: bool, lagtop: Lagtop) -> None:
    """Tiny amplitudes, far ones, and those next to quarter turns: each is correctly rounded."""
    rng, quarter = random.Random(f"F {name} {degrees}"), 90.0 if degrees else math.pi / 2
    near = quarter * rng.randrange(-9, 10)
    amplitudes: list[complex] = [
        *(rng.uniform(-5, 5) * quarter, 10 ** rng.uniform(-20, 0) * quarter, near),
        *(math.nextafter(near, 1e9), quarter * 10 ** rng.uniform(0, 15.05)),
    ]
    with mpmath.workdps(60):
        found = rows(lagtop, name.replace("_", "-"), value, amplitudes, *["--rad"][degrees:])
        m = mpmath.mpf(value) ** 2 if name == "k" else 1 - mpmath.mpf(value) ** 2
        for phi, values in zip(amplitudes, found, strict=True):
            angle = mpmath.mpf(phi.real) * (mpmath.pi / 180 if degrees else 1)
            for got, of in zip(values, (mpmath.ellipf, mpmath.ellipe), strict=True):
                assert abs(got.real - of(angle, m)) <= math.ulp(got.real) * 0.5001, (m, phi)
