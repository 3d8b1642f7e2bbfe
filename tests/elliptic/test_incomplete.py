"""F(phi, k) and E(phi, k) of any real amplitude, against Arb's Carlson integrals."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from arb_balls import exact_arb
from conftest import Lagtop
from flint import acb, arb, ctx
from function_judge import EPS

from lagrange_cli.arithmetic.arrays import ARRAYS
from lagrange_cli.elliptic.incomplete import (
    e_of,
    f_of,
    in_degrees,
    in_radians,
    incomplete_e,
    incomplete_f,
)
from lagrange_cli.elliptic.many_digits import ManyDigits
from lagrange_cli.elliptic.modulus import modulus


class Exact:
    """F and E of one modulus, given by k or k', and one amplitude, as balls with their slopes."""

    def __init__(self, name: str, value: float, phi: float, degrees: bool) -> None:
        ctx.prec = 2600 if value < 1e-20 else 500
        other = exact_arb(value) ** 2
        m, rest = (other, 1 - other) if name == "k" else (1 - other, other)
        complete = acb(m).elliptic_k().real, acb(m).elliptic_e().real
        if degrees and Fraction(phi) / 90 % 2 == 1:
            quarters = int(Fraction(phi) / 90)
            self.values = complete[0] * quarters, complete[1] * quarters
            self.slopes = 0.0, 0.0
            return
        angle = exact_arb(phi) * (arb.pi() / 180 if degrees else 1)
        turns = (angle / arb.pi() + exact_arb(Fraction(1, 2))).floor()
        within = angle - turns * arb.pi()
        sine, cosine2 = within.sin(), within.cos() ** 2
        delta2 = cosine2 + rest * sine * sine
        arguments = acb(cosine2), acb(delta2), acb(1)
        first = sine * acb.elliptic_rf(*arguments).real
        second = first - m * sine**3 * acb.elliptic_rd(*arguments).real / 3
        self.values = first + 2 * turns * complete[0], second + 2 * turns * complete[1]
        size, pace = abs(float(within.mid())), float(delta2.sqrt().mid())
        self.slopes = size / pace, size * pace

    def units(self, computed: Iterable[float]) -> float:
        """Return the greater error in eps (max(1, |f|) + |phi f'|), phi less whole half turns."""
        return max(map(self._units, computed, self.values, self.slopes))

    @staticmethod
    def _units(computed: float, exact: Any, slope: float) -> float:
        unit = EPS * (max(1.0, abs(float(exact.mid()))) + slope)
        error = abs(exact_arb(computed) - exact)
        assert float(error.rad()) < 1e-3 * unit, "the judge needs more bits"
        return float(error.mid()) / unit


def random_modulus(rng: random.Random) -> tuple[str, float]:
    """Return a way to give k, over all that it can say."""
    return rng.choice(
        [
            ("k", rng.random()),
            ("k", 10 ** rng.uniform(-100, 0)),
            ("k_prime", rng.random()),
            ("k_prime", 10 ** rng.uniform(-30, 0)),
            ("k_prime", 10 ** rng.uniform(-300, 0)),
        ]
    )


def random_amplitude(rng: random.Random, quarter: float) -> float:
    """Return an amplitude of the worst kinds: tiny, far, at and next to quarter turns."""
    near = quarter * rng.randrange(-9, 10)
    return rng.choice(
        [
            rng.uniform(-5, 5) * quarter,
            10 ** rng.uniform(-20, 0) * quarter,
            near,
            math.nextafter(near, rng.choice([-math.inf, math.inf])),
            near * (1 + 10 ** rng.uniform(-16, -1)),
            quarter * 10 ** rng.uniform(0, 15.05),
        ]
    )


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [False, True])
def test_integrals(degrees: bool) -> None:
    """Worst seen in 20 000: F 0.9, E 2.3 units of eps (max(1, |f|) + |phi f'|)."""
    rng = random.Random(f"F {degrees}")
    for _ in range(60):
        name, value = random_modulus(rng)
        phi = random_amplitude(rng, 90.0 if degrees else math.pi / 2)
        amplitude = (in_degrees if degrees else in_radians)(ARRAYS, np.array([phi]))
        given = modulus(ARRAYS, **{name: value})
        computed = [float(f(ARRAYS, amplitude, given)[0]) for f in (f_of, e_of)]
        assert Exact(name, value, phi, degrees).units(computed) <= 2.5, (name, value, phi)


def test_arrays_of_moduli_and_many_digits() -> None:
    phi, k_prime = np.linspace(-9, 9, 7), np.array([[0.0], [1e-200], [0.3], [1.0]])
    ar = ManyDigits(40)
    for ours in (incomplete_f, incomplete_e):
        together = ours(ARRAYS, phi, modulus(ARRAYS, k_prime=k_prime))
        for row, x in zip(together, k_prime[:, 0], strict=True):
            given = modulus(ar, k_prime=x)
            alone = [float(ours(ar, ar.convert(angle), given)) for angle in phi]
            np.testing.assert_allclose(row, alone, rtol=4 * EPS)
    with mpmath.workdps(40):
        exact = mpmath.ellipe(mpmath.mpf(7), mpmath.mpf("0.64"))
    assert abs(incomplete_e(ar, ar.mpf(7), modulus(ar, k=ar.mpf("0.8"))) - exact) < 1e-37


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
    shown = lagtop(*"jacobi --k 1 --phi 90,-210 --digits 20 --format csv".split()).stdout
    assert shown.splitlines()[1:] == ["90.0,,1.0", "-210.0,,-2.5"]
    shown = lagtop(*"jacobi --k 1 --phi 90,0 --format csv".split()).stdout
    assert shown.splitlines()[1:] == ["90.0,,1.0", "0.0,0.0,0.0"]
    shown = lagtop(*"jacobi --k 0 --rad --phi 1.5 --digits 20 --format csv".split()).stdout
    assert shown.splitlines() == ["phi_rad,F,E", "1.5,1.5,1.5"]


def test_far_amplitudes_with_digits(lagtop: Lagtop) -> None:
    """1e30 degrees are 5555555555555555555555555555 half turns and 100 degrees."""
    shown = lagtop(*"jacobi --k 0.6 --phi 1e30 --digits 45 --format csv".split()).stdout
    with mpmath.workdps(80):
        m = mpmath.mpf("0.36")
        turns = 5555555555555555555555555555
        exact = 2 * turns * mpmath.ellipk(m) + mpmath.ellipf(mpmath.radians(100), m)
        assert abs(mpmath.mpf(shown.splitlines()[1].split(",")[1]) / exact - 1) < 1e-44


@pytest.mark.parametrize("sign", ["", "-"])
def test_the_double_below_a_quarter_turn_is_below_it(lagtop: Lagtop, sign: str) -> None:
    """F(phi, 1) = asinh(tan phi), by mpmath."""
    phi = 1.5707963267948966
    with mpmath.workdps(50):
        exact = mpmath.asinh(mpmath.tan(mpmath.mpf(phi)))
    options = ["--k", 1, "--rad", f"--phi={sign}{phi}", "--format", "csv"]
    _, row = lagtop("jacobi", *options).stdout.splitlines()
    assert float(row.split(",")[1]) == float(f"{sign}{float(exact)}")
    beyond = [*options[:3], f"--phi={sign}1.5707963267948968", *options[4:]]
    assert lagtop("jacobi", *beyond).stdout.splitlines()[1].split(",")[1] == ""
    assert lagtop("jacobi", "--rad", "--modular-angle", phi, "--u", 1).exit_code == 0
    assert lagtop("jacobi", "--rad", "--modular-angle", 1.5707963267948968).exit_code == 2
