"""Every column of `lagtop jacobi` against balls, at the arguments that are worst for it."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import pytest
from arb_balls import exact_arb
from conftest import Lagtop
from function_judge import EPS, Judge, units
from function_tables import array_rows, request_of
from lagtop import LagtopError

from lagrange_cli.arithmetic.arrays import ARRAYS
from lagrange_cli.arithmetic.ball import TooFewDigitsError
from lagrange_cli.arithmetic.points import ListedPoints
from lagrange_cli.elliptic.function_table import FunctionTable
from lagrange_cli.elliptic.modulus import ModulusInput

FAMILIES = ("theta", "zeta", "omega", "pi")


class Case(NamedTuple):
    """A modulus, a parameter and arguments."""

    name: str
    modulus: float
    parameter: float
    imaginary: bool
    arguments: list[float]

    def table(self, most: int | None = None) -> FunctionTable:
        """Return the table of the first arguments, or of all."""
        modulus = ModulusInput(self.name, Fraction(self.modulus))
        request = request_of(modulus, FAMILIES, Fraction(self.parameter), self.imaginary)
        return FunctionTable(ListedPoints([Fraction(u) for u in self.arguments[:most]]), request)

    def judge(self) -> Judge:
        """Return the judge, with the bits that 1 - k^2 takes."""
        return Judge(self.name, Fraction(self.modulus), 2600 if self.modulus < 1e-20 else 700)


def nudged(x: float, steps: int) -> float:
    """Return the double so many steps from x."""
    for _ in range(abs(steps)):
        x = math.nextafter(x, math.copysign(math.inf, steps))
    return x


def random_modulus(rng: random.Random) -> tuple[str, float]:
    """Return a way to give k, over all that it can say, and next to k = k'."""
    return rng.choice(
        [
            ("k", rng.random()),
            ("k", 10 ** rng.uniform(-150, 0)),
            ("k", 10 ** rng.uniform(-300, -150)),
            ("k", 10 ** rng.uniform(-20, 0)),
            ("k_prime", rng.random()),
            ("k_prime", 10 ** rng.uniform(-6, 0)),
            ("k_prime", 10 ** rng.uniform(-150, 0)),
            ("k_prime", 10 ** rng.uniform(-300, -150)),
            ("k", nudged(math.sqrt(0.5), rng.randrange(-1, 2))),
        ]
    )


def random_case(rng: random.Random) -> tuple[Case, Judge]:
    """Return a case of the worst kinds: next to poles and zeros, tiny and far, near K and K'."""
    name, modulus = random_modulus(rng)
    judge = Case(name, modulus, 0.0, False, []).judge()
    K, K_prime = float(judge.K.mid()), float(judge.K_prime.mid())
    imaginary = rng.random() < 0.5
    if imaginary:
        sizes = [
            rng.random() * K_prime,
            10 ** rng.uniform(-20, 0) * K_prime,
            K_prime * (1 - 10 ** rng.uniform(-16, 0)),
            nudged(K_prime, -rng.randrange(1, 4)),
            rng.random() * min(K_prime, 1.0),
        ]
    else:
        sizes = [
            rng.random() * K,
            10 ** rng.uniform(-20, 0) * K,
            K * (1 - 10 ** rng.uniform(-16, -1)),
            10 ** rng.uniform(0, 15) * K,
            nudged(K, rng.randrange(-2, 3)),
            2 * K * rng.randrange(1, 9) * (1 + 10 ** rng.uniform(-16, -3)),
        ]
    parameter = rng.choice([-1, 1]) * rng.choice(sizes)
    halves = [rng.randrange(4), rng.randrange(10**6), rng.randrange(10**14)]
    near = abs(parameter) if abs(parameter) < 1e14 * K else 1.0
    arguments = [
        rng.choice([-1, 1])
        * rng.choice(
            [
                rng.random() * K,
                10 ** rng.uniform(-20, 0) * K,
                10 ** rng.uniform(-300, 0),
                nudged(rng.choice(halves) * K, rng.randrange(-3, 4)),
                rng.choice(halves) * K * (1 + 10 ** rng.uniform(-16, -2)),
                K * 10 ** rng.uniform(0, 15),
                nudged(near, rng.randrange(-3, 4)),
                near * (1 + 10 ** rng.uniform(-16, 0)),
            ]
        )
        for _ in range(8)
    ]
    arguments = [u for u in arguments if u == 0 or abs(u) > 1e-300]  # or 1/u is no double
    return Case(name, modulus, parameter, imaginary, arguments or [1.0]), judge


def errors(case: Case, judge: Judge) -> Iterator[tuple[str, float]]:
    """Yield the columns and their errors in units."""
    for u, cells in zip(case.arguments, array_rows(case.table()), strict=True):
        for column, exact in judge.columns(u, case.parameter, case.imaginary):
            yield column, units(cells[column], exact, with_v=True)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_columns(seed: int) -> None:
    """Worst seen in 97 000 values: 2.2 units of eps (max(1, |f|) + |u f'| + |v df/dv|)."""
    rng = random.Random(seed)
    for _ in range(3):
        case, judge = random_case(rng)
        for column, error in errors(case, judge):
            assert error <= 2.5, (column, case)


def misrounded(case: Case, judge: Judge) -> Iterator[str]:
    """Yield the columns of a small table that are not the doubles nearest to the exact values."""
    for u, cells in zip(case.arguments, case.table().digit_rows(), strict=True):
        for column, exact in judge.columns(u, case.parameter, case.imaginary):
            shown = float(cells[column])
            if abs(exact_arb(shown) - exact.value) > exact_arb(math.ulp(shown)) / 2:
                yield column


def test_what_takes_many_digits_is_left_to_arrays() -> None:
    """Pi at 1e-300 is the difference of two numbers that agree in 300 digits."""
    request = request_of(ModulusInput("k", Fraction(4, 5)), ("pi",), Fraction(3, 10))
    for u, is_array in (("0.5", False), ("1e-300", True)):
        header, found = FunctionTable(ListedPoints([Fraction(u)]), request).rows()
        assert header == ["u", "pi01", "pi00", "pi11"]
        assert isinstance(next(found), np.ndarray) == is_array


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_small_tables_have_the_nearest_doubles(seed: int) -> None:
    """Numbers of many digits are rounded once: each of 3 900 values was right."""
    case, judge = random_case(random.Random(f"few {seed}"))
    judged = 0
    for u in case.arguments[:4]:
        with suppress(TooFewDigitsError):  # an argument that is left to arrays
            assert list(misrounded(case._replace(arguments=[u]), judge)) == []
            judged += 1
    assert judged


@pytest.mark.parametrize(
    "case",
    [
        Case("k", 0.9, 0.0, False, [1e12]),
        Case("k_prime", 1.1016073613135097e-57, 4.571935101098555e-13, False, [-60294438282173.9]),
        Case("k", 1e-40, 85.0, True, [1.0]),
        Case("k", 1e-30, 60.0, True, [1.0, 6e11]),
        Case("k", 1e-150, 200.0, True, [1.0, -2.5]),
        Case("k_prime", 1.8954585774513647e-06, 0.3, False, [29.124688232919205]),
        Case("k", 0.6, 1.9953027776647294 - 1e-12, True, [1e-17, 3e-18]),
        Case("k_prime", 1e-200, 100.0, False, [99.0, 101.0, 300.0, -460.0]),
        Case("k_prime", 1e-300, 691.0, False, [690.5, 1e-3]),
        Case("k", 1e-170, 0.25, False, [1.0]),
        Case("k", nudged(0.5**0.5, 1), -6.587964957907565e-18, False, [-6.587964957907564e-18]),
        Case("k", 3.531006704930225e-77, -1.5201004253689179, False, [-1.520100425368918]),
    ],
    ids=lambda case: f"{case.name}={case.modulus:.3g}, v={case.parameter:.3g}",
)
def test_columns_that_were_wrong(case: Case) -> None:
    """Columns that were off by up to 1e13 units, or empty."""
    for column, error in errors(case, case.judge()):
        assert error <= 2.5, column


def test_odd_thetas_keep_their_digits_where_the_nome_leaves_the_doubles(lagtop: Lagtop) -> None:
    """q^(1/4) = sqrt(k)/2 there, while q itself is 0 in doubles."""
    for k in ("1e-160", "1e-200", "1e-300"):
        row = json.loads(
            lagtop(*f"jacobi --k {k} --u 1 --functions theta --format json".split()).stdout
        )[0]
        size = math.sqrt(float(k))
        assert row["theta11"] == pytest.approx(size * math.sin(1), rel=2 * EPS, abs=0)
        assert row["theta10"] == pytest.approx(size * math.cos(1), rel=2 * EPS, abs=0)


@pytest.mark.parametrize("modulus", ["k 0.8", "k-prime 0.8", "k-prime 1e-9"])
def test_zeta10_next_to_its_pole(modulus: str, lagtop: Lagtop) -> None:
    """One double from K, which was an empty cell."""
    option, value = modulus.split()
    judge = Judge(option.replace("-", "_"), Fraction(value))
    nearest = float(judge.K.mid())
    for x in (nudged(nearest, steps) for steps in (-1, 0, 1)):
        args = [f"--{option}", value, "--u", repr(x), "--functions", "zeta", "--format", "json"]
        cell = json.loads(lagtop("jacobi", *args).stdout)[0]["zeta10"]
        exact = dict(judge.columns(x, None, False))["zeta10"]
        assert units(cell, exact, with_v=False) <= 2.5
        assert cell == pytest.approx(float(exact.value.mid()), rel=8 * EPS)


@pytest.mark.parametrize(
    ("args", "column", "text"),
    [
        (
            "--k 1e-30 --u 0.5 --functions omega,pi --param 0.25",
            "omega01",
            "-5.0427835013916863e-62",
        ),
        ("--k 1e-30 --u 0.5 --functions omega,pi --param 0.25", "pi01", "9.5003573116085122e-63"),
        ("--k 1e-30 --u 0.5 --functions omega,pi --param 0.25", "pi00", "-9.5003573116085122e-63"),
        ("--k 0.9 --u 1e12 --functions pi --param 0", "pi00", "0.0"),
        ("--k 0.5 --u 0.3 --functions pi --param 0i", "pi11_imag", ""),
        ("--k 0.5 --u 0.3 --functions pi --param 0i", "pi01_imag", "0.0"),
        ("--k 0.5 --u 0.3 --functions omega,pi --param 0.3", "omega11", ""),
        ("--k 0 --u 1 --functions zeta", "zeta01", "0.0"),
        ("--k 0.5 --u 0 --functions zeta", "zeta00", "0.0"),
    ],
)
def test_printed_zeros_and_empty_cells_are_proved(
    args: str, column: str, text: str, lagtop: Lagtop
) -> None:
    shown = lagtop("jacobi", *args.split(), "--digits", "17", "--format", "csv").stdout
    header, row = shown.splitlines()
    assert dict(zip(header.split(","), row.split(","), strict=True))[column] == text


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_digits(seed: int) -> None:
    """Every digit is right, of tiny values too, and where few are asked for."""
    rng = random.Random(f"digits {seed}")
    for _ in range(3):
        case, judge = random_case(rng)
        digits = rng.choice([1, 2, 17])
        for u, cells in zip(case.arguments[:2], case.table(2).digit_rows(digits), strict=True):
            for column, exact in judge.columns(u, case.parameter, case.imaginary):
                if exact.value == 0:
                    assert cells[column] == "0.0", (column, case)
                    continue
                if not exact.value.is_finite() or exact.value.rel_accuracy_bits() < 80:
                    continue  # so small that this judge does not see it
                error = abs((exact_arb(Fraction(cells[column])) - exact.value) / exact.value)
                assert float(error.mid()) <= 5.01 * 10.0**-digits, (column, case)


@pytest.mark.slow
@pytest.mark.parametrize(
    "args",
    [
        "--functions zeta --k 0.956 --u 5.29784315909212489 --digits 2",
        "--functions zeta --nome 0.6984809099903848 --u 13.751811435348458 --digits 1",
        "--k 0.5 --u 1 --functions pi --param 1e300 --digits 20",
        "--nome 0.9999999999999 --u 1 --functions pi --param 0.5 --digits 60",
        "--k 0 --u 1 --functions omega,pi --param 1e15i --digits 5",
    ],
)
def test_digits_where_there_was_a_traceback_or_no_end(args: str, lagtop: Lagtop) -> None:
    result = lagtop("jacobi", *args.split(), "--format", "csv")
    assert result.exit_code == 0
    assert "nan" not in result.stdout
    assert ",," not in result.stdout


@pytest.mark.slow
def test_far_parameters_with_digits() -> None:
    """Pi of a parameter of 1e300, against one reduced by the judge."""
    judge = Judge("k", Fraction(1, 2), 2000)
    exact = dict(judge.columns(1.0, 1e300, False))
    request = request_of(ModulusInput("k", Fraction(1, 2)), ("pi",), Fraction(1e300))
    cells = next(FunctionTable(ListedPoints([Fraction(1)]), request).digit_rows(20))
    for column in ("pi01", "pi00", "pi11"):
        error = abs(
            (exact_arb(Fraction(cells[column])) - exact[column].value) / exact[column].value
        )
        assert float(error.mid()) <= 5.01e-20


def test_bad_indices_of_the_functions() -> None:
    from lagrange_cli.elliptic.modulus import modulus
    from lagrange_cli.elliptic.theta import theta

    with pytest.raises(LagtopError, match="ij must be 01, 00, 11 or 10"):
        theta(ARRAYS, "12", 0.5, modulus(ARRAYS, k=0.5))
