"""F(phi, k) and E(phi, k) of any real amplitude, against mpmath's incomplete integrals."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from conftest import Lagtop

from lagrange_cli.elliptic.incomplete import AmplitudeTable
from lagrange_cli.elliptic.modulus import ModulusInput
from lagrange_cli.top.ranges import ListedPoints


def exact(name: str, value: float, phi: float, degrees: bool) -> tuple[Any, Any]:
    """Return F and E by mpmath, by Carlson's integrals within half a turn."""
    with mpmath.workdps(60):
        other = mpmath.mpf(value) ** 2
        m, rest = (other, 1 - other) if name == "k" else (1 - other, other)
        angle = mpmath.radians(mpmath.mpf(phi)) if degrees else mpmath.mpf(phi)
        turns = mpmath.nint(angle / mpmath.pi)
        within = angle - turns * mpmath.pi
        sine, cosine2 = mpmath.sin(within), mpmath.cos(within) ** 2
        delta2 = cosine2 + rest * sine**2
        first = sine * mpmath.elliprf(cosine2, delta2, 1)
        second = first - m * sine**3 * mpmath.elliprd(cosine2, delta2, 1) / 3
        K, E = mpmath.ellipk(m), mpmath.ellipe(m)
        return first + 2 * turns * K, second + 2 * turns * E


def is_nearest(text: str, true: Any) -> bool:
    return bool(abs(mpmath.mpf(text) - true) <= math.ulp(float(text)) * 0.5001)


@pytest.mark.parametrize("degrees", [False, True])
@pytest.mark.parametrize(("name", "value"), [("k", 0.3), ("k_prime", 0.03), ("k_prime", 1e-9)])
def test_integrals(name: str, value: float, degrees: bool) -> None:
    """Tiny amplitudes, far ones, and those next to quarter turns: each is correctly rounded."""
    rng, quarter = random.Random(f"F {name} {degrees}"), 90.0 if degrees else math.pi / 2
    near = quarter * rng.randrange(-9, 10)
    amplitudes = [
        *(rng.uniform(-5, 5) * quarter, 10 ** rng.uniform(-20, 0) * quarter, near),
        *(math.nextafter(near, 1e9), quarter * 10 ** rng.uniform(0, 15.05)),
    ]
    given = ModulusInput(name, Fraction(value), radians=not degrees)
    table = AmplitudeTable(ListedPoints([Fraction(x) for x in amplitudes]), given)
    (rows,) = table.rows()[1]
    for phi, (_, first, second) in zip(amplitudes, rows, strict=True):
        F, E = exact(name, value, phi, degrees)
        assert is_nearest(first, F), (name, value, phi)
        assert is_nearest(second, E), (name, value, phi)


def test_amplitudes_of_the_command(lagtop: Lagtop) -> None:
    """At whole quarter turns they are whole multiples of K and E; F has a pole for k = 1."""
    shown = lagtop(*"jacobi --k 0.6 --phi=-180:270:6 --digits 25 --format csv".split()).stdout
    header, *lines = shown.splitlines()
    assert header == "phi_deg,F,E"
    with mpmath.workdps(60):
        m = mpmath.mpf("0.36")
        for quarters, line in zip(range(-2, 4), lines, strict=True):
            _, first, second = map(mpmath.mpf, line.split(","))
            assert abs(first - quarters * mpmath.ellipk(m)) <= abs(first) * 5.01e-25
            assert abs(second - quarters * mpmath.ellipe(m)) <= abs(second) * 5.01e-25
    assert lines[2] == "0.0,0.0,0.0"
    for options, rows in {
        "--k 1 --phi 90,-210 --digits 20": ["90.0,,1.0", "-210.0,,-2.5"],
        "--k 1 --phi 90,0": ["90.0,,1.0", "0.0,0.0,0.0"],
        "--k 0 --rad --phi 1.5 --digits 20": ["1.5,1.5,1.5"],
    }.items():
        shown = lagtop("jacobi", *options.split(), "--format", "csv").stdout
        assert shown.splitlines()[1:] == rows


@pytest.mark.parametrize("sign", ["", "-"])
def test_the_double_below_a_quarter_turn_is_below_it(lagtop: Lagtop, sign: str) -> None:
    """F(phi, 1) = asinh(tan phi), by mpmath; the next double is above the quarter turn."""
    options = f"jacobi --k 1 --rad --phi={sign}1.5707963267948966,{sign}1.5707963267948968"
    _, below, above = lagtop(*options.split(), "--format", "csv").stdout.splitlines()
    with mpmath.workdps(50):
        true = mpmath.asinh(mpmath.tan(mpmath.mpf(1.5707963267948966)))
    assert float(below.split(",")[1]) == float(f"{sign}{float(true)}")
    assert above.split(",")[1] == ""
