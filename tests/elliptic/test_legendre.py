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
from function_reference import cells_of, check


def text_of(z: complex) -> str:
    """Return all digits of an amplitude."""
    return f"{Decimal(z.real):f}" + (f"{Decimal(z.imag):+f}i" if z.imag else "")


NODES, WEIGHTS = np.polynomial.legendre.leggauss(120)


def line(function: Any, start: complex, end: complex) -> Any:
    """Return an integral along a line; the substitution allows roots that vanish at its ends."""
    half, middle, w = (end - start) / 2, (end + start) / 2, np.pi / 2 * NODES
    values = function(middle + half * np.sin(w)) * half * np.cos(w)
    return (WEIGHTS * values).sum() * np.pi / 2


def by_quadrature(m: float, phi: complex, n: float | None) -> dict[str, complex]:
    """Return F, E and, with n, Pi: along the real axis to Re phi, then to phi.

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

    kinds = {"F": lambda t, d: 1 / d, "E": lambda t, d: d}
    kinds |= {} if n is None else {"Pi": lambda t, d: 1 / (1 - n * np.sin(t) ** 2) / d}
    return {name: integral(kind) for name, kind in kinds.items()}


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
    more = [] if n is None else [f"--n={n}"]
    cells = cells_of(lagtop, f"--m={m}", f"--phi={text_of(phi)}", "--rad", *more)
    for name, true in by_quadrature(m, phi, n).items():
        real, imag = (cells.get(x, ["0"]) for x in (f"{name}_re", f"{name}_im"))
        found = complex(float(cells.get(name, real)[0]), float(imag[0]))
        assert abs(found - true) <= 1e-5 * (1 + abs(true)), (m, phi, n, found)


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
        cells = cells_of(lagtop, f"--m={Decimal(m)}", f"--phi={text_of(phi)}", "--rad", *more)
        with mpmath.workdps(60):
            exact = {"F": mpmath.ellipf(phi, m), "E": mpmath.ellipe(phi, m)}
            exact |= {} if n is None else {"Pi": mpmath.ellippi(n, phi, m)}
            assert check(cells, exact, (m, phi, n)) >= 3


@pytest.mark.parametrize("degrees", [False, True])
@pytest.mark.parametrize(("name", "value"), [("k", 0.3), ("k-prime", 0.03), ("k-prime", 1e-9)])
def test_rounding(name: str, value: float, degrees: bool, lagtop: Lagtop) -> None:
    """Tiny amplitudes, far ones, and those next to quarter turns: each is correctly rounded."""
    rng, quarter = random.Random(f"F {name} {degrees}"), 90.0 if degrees else math.pi / 2
    near = quarter * rng.randrange(-9, 10)
    amplitudes = [rng.uniform(-5, 5) * quarter, 10 ** rng.uniform(-20, 0) * quarter, near]
    amplitudes += [math.nextafter(near, 1e9), quarter * 10 ** rng.uniform(0, 15.05)]
    words = f"--{name}={Decimal(value)}", f"--phi={','.join(map(text_of, amplitudes))}"
    cells = cells_of(lagtop, *words, *["--rad"][degrees:], digits=None)
    with mpmath.workdps(60):
        m = mpmath.mpf(value) ** 2 if name == "k" else 1 - mpmath.mpf(value) ** 2
        for key, function in (("F", mpmath.ellipf), ("E", mpmath.ellipe)):
            for phi, found in zip(amplitudes, map(float, cells[key]), strict=True):
                true = function(mpmath.mpf(phi) * (mpmath.pi / 180 if degrees else 1), m)
                assert abs(found - true) <= math.ulp(found) * 0.5001, (m, phi)
