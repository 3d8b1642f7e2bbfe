"""Functions of complex arguments, complex parameters and of any modulus, against Arb and mpmath."""

from __future__ import annotations

import cmath
import math
import random
from collections.abc import Iterator
from typing import Any, NamedTuple

import mpmath
import numpy as np
import pytest
from function_judge import INDEX, ComplexJudge, complex_units
from lagtop import LagtopError

from lagrange_cli.arithmetic.arrays import ARRAYS
from lagrange_cli.elliptic.any_modulus import any_constants, any_modulus
from lagrange_cli.elliptic.complex_theta import complex_theta, complex_zeta
from lagrange_cli.elliptic.complex_third_kind import complex_omega, complex_pi, parameter
from lagrange_cli.elliptic.jacobi import complex_jacobi
from lagrange_cli.elliptic.many_digits import ManyDigits
from lagrange_cli.elliptic.periods import lattice

AR = ManyDigits(50)
THIRD = ("01", "00", "11")


class Case(NamedTuple):
    """A modulus, arguments and a parameter."""

    k: complex
    arguments: list[complex]
    v: complex


def columns(case: Case) -> dict[str, Any]:
    """Return our functions on an array of arguments, by their columns."""
    given = any_modulus(AR, case.k)
    exact = lattice(AR, given)
    periods, u = exact.rounded(), np.array(case.arguments)
    found = complex_jacobi(ARRAYS, u, given.rounded())._asdict()
    for ij in INDEX:
        found[f"theta{ij}"] = complex_theta(ARRAYS, ij, u, periods)
        found[f"zeta{ij}"] = complex_zeta(ARRAYS, ij, u, periods)
    for ij in THIRD:
        kind = parameter(AR, ij, AR.convert(case.v), exact).rounded()
        found[f"omega{ij}"] = complex_omega(ARRAYS, u, kind)
        found[f"pi{ij}"] = complex_pi(ARRAYS, u, kind)
    return found


def errors(case: Case) -> Iterator[tuple[str, complex, float]]:
    """Yield the columns, the arguments and the errors in units; theta leaves the doubles first."""
    judge = ComplexJudge(case.k, 700 if 1e-3 < abs(case.k) < 1e3 else 2600)
    found = columns(case)
    for i, u in enumerate(case.arguments):
        for name, exact in judge.columns(u, case.v):
            value = complex(found[name][i])
            if name == "am" and cmath.isnan(value):
                continue  # beyond the branch points
            if name.startswith("theta") and not abs(exact.value) < 1e300:
                continue
            yield name, u, complex_units(name, value, exact)


def random_case(rng: random.Random) -> Case:
    """Return a case next to poles and zeros, tiny and far, with a modulus from anywhere."""

    def power(low: float, high: float) -> float:
        return float(10 ** rng.uniform(low, high))

    k = complex(
        rng.choice(
            [
                rng.choice([rng.random(), power(-150, 0), 1 - power(-14, -1), math.sqrt(0.5)]),
                1j * rng.choice([rng.random(), power(-100, 0), power(0, 8), 1.0]),
                rng.choice([1 + rng.random(), 1 + power(-14, 0), power(0, 20)]),
            ]
        )
    )
    periods = lattice(AR, any_modulus(AR, k))
    sizes = float(1 / (2 * periods.given.scale)), float(1 / (2 * periods.given.across))
    far = rng.choice([1.0, 1.0, power(0, 14)])

    def part(size: float) -> float:
        sizes = [
            rng.random() * 2,
            power(-20, 0),
            rng.randrange(9) * (1 + rng.choice([-1, 1]) * power(-16, -2)),
            1 + rng.choice([-1, 1]) * power(-16, -1),
            0.0 if rng.random() < 0.3 else 1.3,
        ]
        return rng.choice([-1, 1]) * rng.choice(sizes) * size

    def number() -> complex:
        return complex(part(sizes[0]) * rng.choice([1, far]), part(sizes[1])) or 0.3 + 0j

    v = number()
    near = complex(v.real + part(sizes[0]) * power(-12, -1), v.imag + sizes[1])
    return Case(k, [number(), number(), v * (1 + power(-16, -1)), near], v)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_columns(seed: int) -> None:
    """Worst seen in 210 000 values: 3.9 units."""
    rng = random.Random(f"complex {seed}")
    for _ in range(6):
        case = random_case(rng)
        for name, u, error in errors(case):
            assert error <= 4, (name, u, case)


@pytest.mark.parametrize(
    "case",
    [
        Case(0.8 + 0j, [0.3 + 0.7j, -5.1 + 3j], 0.2 + 0.7j),
        Case(0.8j, [0.3 + 0.7j, 2.0 + 0j], 0.4j),
        Case(1.5 + 0j, [0.3 + 0.7j, 2.0 + 0j], 0.2 + 0.1j),
        Case(1j, [-1.3110287771460614 - 1.31102877714606j], 1.2 + 2.6j),
        Case(5.223776957152364j, [0.5960034881991857j], 0.29800175529533124j),
        Case(0.9999999996746572 + 0j, [-11.9628337367151 + 2.9814396037793514j], 6.8e-12j),
        Case(4.5e17 + 0j, [1.8998648348051266e-17 - 5.523213226366698e-16j], 1e-17 + 0j),
        Case(34810908.28491808j, [7.860815596744782e-23 + 0j], 1.47e-13j),
        Case(0.5**0.5 + 0j, [-1903162939.5967197 - 5.49e-05j], -1903162939.59 + 1.8540747j),
    ],
    ids=lambda case: f"k={case.k:.3g}",
)
def test_columns_that_are_hard(case: Case) -> None:
    """Plain cases, and those that were off while the functions were made."""
    for name, u, error in errors(case):
        assert error <= 4, (name, u)


@pytest.mark.parametrize("k", [0.8j, 3j, 1.5 + 0j, 40 + 0j])
def test_constants(k: complex) -> None:
    """All of them as mpmath has them, on its side of the cuts."""
    given, *found = any_constants(AR, k).values()
    assert given == k
    with mpmath.workdps(50):
        m = (mpmath.mpmathify(k) ** 2).real
        K, K_prime = mpmath.ellipk(m), mpmath.ellipk(1 - m)
        q = mpmath.exp(-mpmath.pi * K_prime / K)
        exact = mpmath.sqrt(1 - m), q, K, K_prime, mpmath.ellipe(m), mpmath.ellipe(1 - m)
        for ours, theirs in zip(found, exact, strict=True):
            assert abs(mpmath.mpmathify(ours) - theirs) < 1e-45 * (1 + abs(theirs))


@pytest.mark.slow
@pytest.mark.parametrize("k", [0.4 + 0j, 0.95 + 0j, 0.8j, 1.5 + 0j])
@pytest.mark.parametrize("v", [0.2 + 0.7j, 0.3 - 0.4j])
def test_the_branch_has_no_jumps_between_lines_of_zeros(k: complex, v: complex) -> None:
    """Along the real direction nothing jumps, in any strip."""
    exact = lattice(AR, any_modulus(AR, k))
    up = float(1 / (2 * exact.given.across))
    for ij in THIRD:
        kind = parameter(AR, ij, AR.convert(v), exact).rounded()
        for function in (complex_omega, complex_pi):
            for y in (0.0, 0.1 * up, 1.37 * up, -2.6 * up):
                values = function(ARRAYS, np.linspace(-9, 9, 2000) + 1j * y, kind)
                assert abs(np.diff(values)).max() < 0.5, (ij, y)


@pytest.mark.slow
def test_real_numbers_keep_the_values_of_the_real_functions() -> None:
    """Check that the branch is the one that real and imaginary parameters have had."""
    from lagrange_cli.elliptic.modulus import modulus
    from lagrange_cli.elliptic.third_kind import omega, pi_function

    for k in (0.3, 0.95):
        exact, real = lattice(AR, any_modulus(AR, complex(k))), modulus(AR, k=AR.mpf(k))
        for ij in THIRD:
            for v in (0.7j, -0.7j, 0.6 + 0j, 7.3 + 0j):
                kind = parameter(AR, ij, AR.convert(v), exact)
                for u in (0.1, -0.2, 2.5, -14.2):
                    v_there = AR.mpc(v) if v.imag else AR.mpf(v.real)
                    for ours, theirs in ((complex_omega, omega), (complex_pi, pi_function)):
                        there = theirs(AR, ij, AR.mpf(u), v_there, real)
                        assert abs(ours(AR, AR.mpf(u), kind) - there) < 1e-44


@pytest.mark.slow
def test_am_is_the_integral_of_dn() -> None:
    """Check it as far as it goes, unwrapped; beyond its branch points it is not a number."""
    for k in (0.6, 0.8j, 1.5):
        given, m = any_modulus(AR, complex(k)), (mpmath.mpmathify(k) ** 2).real
        for u in (0.3 + 0.4j, 5.2 - 0.6j, -7.7 + 0.3j):
            with mpmath.workdps(20):
                path = [0, u.real / 3, 2 * u.real / 3, u.real, u]
                there = mpmath.quad(lambda x, m=m: mpmath.ellipfun("dn", x, m=m), path)
            assert abs(complex(complex_jacobi(AR, AR.convert(u), given).am - there)) < 1e-14
        assert np.isnan(complex_jacobi(ARRAYS, np.array([0.1 + 9j]), given.rounded()).am).all()


@pytest.mark.parametrize("k", [0.5 + 0.2j, -0.5 + 0j, -0.8j, complex("nan"), complex("inf")])
def test_moduli_out_of_range(k: complex) -> None:
    with pytest.raises(LagtopError, match=r"k must be 0 or more, or imaginary as 0\.8i, got"):
        any_modulus(AR, k)


def test_one_period_has_no_theta_functions() -> None:
    for k in (0j, 1 + 0j):
        with pytest.raises(LagtopError, match="k must not be 0 or 1"):
            lattice(AR, any_modulus(AR, k))
