"""Arguments in units of K: table 2 of Aksenov to the letter, and any rational multiple."""

from __future__ import annotations

import json
import math
import random
from fractions import Fraction
from typing import Any

import pytest
from arb_balls import exact_arb
from conftest import Lagtop
from flint import acb, arb, ctx
from function_judge import EPS, INDEX, Judge
from function_tables import array_rows
from lagtop import LagtopError

from lagrange_cli.arithmetic.points import ExactComplex, ListedPoints
from lagrange_cli.elliptic.function_table import FunctionTable
from lagrange_cli.elliptic.modulus import ModulusInput
from lagrange_cli.elliptic.request import FunctionRequest
from lagrange_cli.inputs.ranges import Multiple, parse_multiple

TABLE_2 = {
    "sn": ["0.0", "1.0", "0.0", "-1.0", "0.0"],
    "cn": ["1.0", "0.0", "-1.0", "0.0", "1.0"],
    "dn": ["1.0", "0.6", "1.0", "0.6", "1.0"],
}
"""Aksenov's table 2 for k = 0.8, k' = 0.6."""


def columns(text: str) -> dict[str, list[str]]:
    """Return the cells of a CSV table by column."""
    header, *lines = (line.split(",") for line in text.splitlines())
    return dict(zip(header, map(list, zip(*lines, strict=True)), strict=True))


@pytest.mark.parametrize("digits", [[], ["--digits", "30"]])
@pytest.mark.parametrize("modulus", [["--k", "0.8"], ["--k-prime", "0.6"]])
def test_table_2_prints_exactly(digits: list[str], modulus: list[str], lagtop: Lagtop) -> None:
    args = ["jacobi", *modulus, "--u", "0:4K:5", *digits, "--format", "csv"]
    shown = columns(lagtop(*args).stdout)
    assert {name: shown[name] for name in TABLE_2} == TABLE_2
    assert shown["am_deg"] == ["0.0", "90.0", "180.0", "270.0", "360.0"]


@pytest.mark.slow
@pytest.mark.parametrize("digits", [[], ["--digits", "20"]])
@pytest.mark.parametrize("modulus", ["--k 0.3", "--k-prime 1e-9", "--nome 0.2"])
@pytest.mark.parametrize("parameter", ["0.4", "0.4i", "0"])
def test_zeros_and_poles_of_the_theta_functions(
    digits: list[str], modulus: str, parameter: str, lagtop: Lagtop
) -> None:
    """Zeros and poles are at whole quarters; no other cell there is 0 or empty."""
    args = ["--functions", "am,theta,zeta,omega,pi", "--param", parameter, "--format", "csv"]
    shown = lagtop(*["jacobi", *modulus.split(), "--u=-3K:3K:7", *args, *digits]).stdout.replace(
        "_imag", ""
    )
    even, odd = [1, 3, 5], [0, 2, 4, 6]
    imaginary, zero = parameter.endswith("i"), parameter == "0"
    zeros = {
        **{"theta11": even, "theta10": odd, "zeta10": even, "zeta11": odd},
        **dict.fromkeys(("zeta01", "zeta00", "omega01", "omega00"), range(7)),
        "omega11": [4] if imaginary else range(7),
        **dict.fromkeys(("pi01", "pi00"), range(7) if zero else [3]),
        "pi11": [] if imaginary or zero else [3],
        **{"sn": even, "cn": odd, "u": [3], "am_deg": [3]},
    }
    poles = {"zeta11": even, "zeta10": odd, "pi11": range(7) if zero else []}
    for name, cells in columns(shown).items():
        assert [i for i, x in enumerate(cells) if x == "0.0"] == list(zeros.get(name, [])), name
        assert [i for i, x in enumerate(cells) if not x] == list(poles.get(name, [])), name


def test_arrays_have_poles_where_the_argument_is_the_parameter() -> None:
    """The parameter is reduced once, the arguments as an array: rounding may part the two."""
    rng = random.Random("poles")
    for _ in range(40):
        v = Fraction(rng.choice([-1, 1]) * 10 ** rng.uniform(-9, 9))
        modulus = ModulusInput("k", Fraction(rng.random()))
        request = FunctionRequest(modulus, ("omega", "pi"), ExactComplex(v))
        for row in array_rows(FunctionTable(ListedPoints([v, -v]), request)):
            assert math.isnan(row["omega11"])
            assert math.isnan(row["pi11"])
            assert math.isfinite(row["pi01"])


def random_request(rng: random.Random) -> tuple[Judge, FunctionRequest, Fraction]:
    """Return a modulus and a multiple of K, next to whole quarters or far from 0 among others."""
    name, value = rng.choice(
        [
            ("k", rng.random()),
            ("k", 10 ** rng.uniform(-20, 0)),
            ("k_prime", rng.random()),
            ("k_prime", 10 ** rng.uniform(-200, 0)),
        ]
    )
    factor = rng.choice(
        [
            rng.uniform(-6, 6),
            rng.randrange(-8, 8) + rng.choice([-1, 1]) * 10 ** rng.uniform(-15, 0),
            10 ** rng.uniform(0, 15),
            rng.randrange(-20, 20) / 4,
        ]
    )
    judge = Judge(name, Fraction(value), 2600 if value < 1e-20 else 700)
    modulus = ModulusInput(name, Fraction(value))
    return judge, FunctionRequest(modulus, ("am", "theta"), in_quarters=True), Fraction(factor)


def exact_values(judge: Judge, factor: Fraction) -> dict[str, tuple[Any, float]]:
    """Return the functions at a multiple of K by Arb's theta functions, and how steep they are.

    The slope is times the argument less whole periods.
    """
    ctx.prec = judge.bits
    turns = round(factor / 2)
    x = exact_arb(factor / 2 - turns)
    sign = (-1) ** turns
    at = {ij: judge.theta(ij, x).real for ij in INDEX}
    zero = {ij: judge.theta(ij, arb(0)).real for ij in INDEX}
    exact = {f"theta{ij}": at[ij] * (sign if ij[0] == "1" else 1) for ij in INDEX}
    sn = zero["00"] / zero["10"] * at["11"] / at["01"]
    cn = zero["01"] / zero["10"] * at["10"] / at["01"]
    dn = zero["01"] / zero["00"] * at["00"] / at["01"]
    exact |= {"sn": sign * sn, "cn": sign * cn, "dn": dn}
    exact["am_deg"] = 180 * turns + (acb(cn, sn).log().imag * 180 / arb.pi())
    exact["u"] = exact_arb(factor) * judge.K
    slopes = {f"theta{ij}": float((x * judge.theta(ij, x, 1).real).mid()) for ij in INDEX}
    reach = float((x * 2 * judge.K).mid())
    slopes |= {"sn": reach * float((cn * dn).mid()), "cn": reach * float((sn * dn).mid())}
    slopes |= {"dn": reach * float((sn * cn).mid()), "am_deg": reach * float(dn.mid()) * 57.3}
    return {name: (value, abs(slopes.get(name, 0.0))) for name, value in exact.items()}


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_any_multiple(seed: int) -> None:
    """Worst seen in 22 000 values: 2.2 units (theta), 1.2 (am, sn, cn, dn)."""
    rng = random.Random(f"K {seed}")
    for _ in range(30):
        judge, request, factor = random_request(rng)
        (cells,) = array_rows(FunctionTable(ListedPoints([factor]), request))
        for name, (exact, slope) in exact_values(judge, factor).items():
            unit = EPS * (max(1.0, abs(float(exact.mid()))) + slope)
            error = float(abs(exact_arb(cells[name]) - exact).mid()) / unit
            assert error <= 2.5, (name, request.modulus, factor)


def test_digits_of_a_third_of_a_quarter() -> None:
    judge = Judge("k", Fraction(1, 2))
    request = FunctionRequest(ModulusInput("k", Fraction(1, 2)), ("am", "theta"), in_quarters=True)
    (cells,) = FunctionTable(ListedPoints([Fraction(1, 3)]), request).digit_rows(40)
    for name, text in cells.items():
        exact, _ = exact_values(judge, Fraction(1, 3))[name]
        assert float(abs((exact_arb(Fraction(text)) - exact) / exact).mid()) < 5.01e-40, name


@pytest.mark.parametrize("seed", range(2))
def test_small_tables_of_multiples_have_the_nearest_doubles(seed: int) -> None:
    """Without NumPy am, sn, cn, dn and the theta functions are rounded once."""
    rng = random.Random(f"few {seed}")
    for _ in range(4):
        judge, request, factor = random_request(rng)
        (texts,) = FunctionTable(ListedPoints([factor]), request).digit_rows()
        cells = {name: float(text) for name, text in texts.items()}
        for name, (exact, _) in exact_values(judge, factor).items():
            if exact.contains(0):
                assert cells[name] == 0, name
            else:
                assert (
                    abs(exact_arb(cells[name]) - exact) <= exact_arb(math.ulp(cells[name])) / 2
                ), name


@pytest.mark.parametrize(
    ("text", "multiple"),
    [
        ("K", Multiple(Fraction(1), True)),
        ("-K", Multiple(Fraction(-1), True)),
        ("+K/2", Multiple(Fraction(1, 2), True)),
        (" 2K ", Multiple(Fraction(2), True)),
        ("-2.5K", Multiple(Fraction(-5, 2), True)),
        ("3K/4", Multiple(Fraction(3, 4), True)),
        ("1e3K/7", Multiple(Fraction(1000, 7), True)),
        ("0K", Multiple(Fraction(0), True)),
        ("0.5", Multiple(Fraction(1, 2), False)),
    ],
)
def test_grammar(text: str, multiple: Multiple) -> None:
    assert parse_multiple(text) == multiple


@pytest.mark.parametrize("text", ["2K/0", "K/-2", "K/", "2KK", "K2", "aK", "1/2K", "2*K", "k", ""])
def test_invalid_multiples_are_refused(text: str) -> None:
    with pytest.raises(LagtopError, match=r"must be a (multiple of K such as|finite decimal)"):
        parse_multiple(text)


def test_zero_goes_with_both_kinds(lagtop: Lagtop) -> None:
    for arguments in (["0", "K"], ["0K", "K"], ["0", "1"]):
        shown = lagtop(
            "jacobi", "--k", "0.6", "--u", ",".join(arguments), "--format", "json"
        ).stdout
        assert json.loads(shown)[0]["sn"] == 0
