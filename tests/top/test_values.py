"""Inputs as people write them: numbers, uncertainties, units, ranges, and objects of libraries."""

from __future__ import annotations

import math
import random
from decimal import Decimal, localcontext
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import xarray
from conftest import Lagtop, assert_one_line
from hypothesis import example, given, settings
from hypothesis import strategies as st
from lagtop import LagtopError
from uncertainties import ufloat

from lagrange_cli.arithmetic.text import parse_number
from lagrange_cli.elliptic.arguments import parse_complex, parse_small
from lagrange_cli.top.ranges import POINTS_AT_ONCE, EvenPoints
from lagrange_cli.top.units import unit_of_text
from lagrange_cli.top.values import (
    Value,
    parse_number_or_span,
    parse_range,
    parse_value,
    parse_values,
    value_of,
)


def test_numbers_of_other_libraries_are_values() -> None:
    assert value_of("m", 50) == Value(50)
    assert value_of("m", ufloat(50, 0.5)) == Value(50.0, "", Fraction(1, 2))
    labelled = xarray.DataArray([1.0, 2.0], dims="x", attrs={"units": "kg"})
    assert value_of("m", labelled).number is labelled


# Ranges


def exact_points(points: EvenPoints) -> list[float]:
    return [float(points.start + i * points.step) for i in range(points.count)]


numbers = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(Fraction),
    st.fractions(-(10**6), 10**6, max_denominator=10**4),
    st.decimals(-1000, 1000, places=3).map(Fraction),
)


@settings(max_examples=30)
@given(numbers, numbers, st.integers(2, 40))
@example(Fraction(0), Fraction(1.797e308), 33)
@example(Fraction(0), Fraction(-5e-324), 3)
@example(Fraction(1), Fraction(1) + Fraction(299, 2**53), 300)  # half way between two doubles
@example(Fraction("-1/3"), Fraction("2/3"), 301)  # over 0, neither start nor step is a double
@example(Fraction("-1e-310"), Fraction("1e-310"), 301)
def test_every_point_is_rounded_once(first: Fraction, last: Fraction, count: int) -> None:
    points = EvenPoints(first, (last - first) / (count - 1), count)
    values = points.at(np.arange(count)).tolist()
    assert values == exact_points(points)
    assert [math.copysign(1, x) for x in values] == [math.copysign(1, x or 1) for x in values]


def test_blocks_and_bounds() -> None:
    points = parse_range(f"1:{3 * POINTS_AT_ONCE}:{3 * POINTS_AT_ONCE}")
    assert [block.size for block in points.blocks()] == [POINTS_AT_ONCE] * 3
    assert points.bounds() == [1, 3 * POINTS_AT_ONCE]
    assert parse_values("3,1,2").bounds() == [1, 3]
    assert parse_values("log:-4:-1:3").bounds() == [-4, -1]
    assert [str(parse_values(x)) for x in ("log:1:1e2:3", "0.5,2")] == ["log:1:100:3", "1/2,2"]


def test_logarithmic_points_have_equal_ratios() -> None:
    """Against 60 digits, rounded once."""
    rng = random.Random(5)
    for _ in range(50):
        first, last = 10 ** rng.uniform(-300, 300), 10 ** rng.uniform(-300, 300)
        count = rng.randrange(2, 30)
        points = parse_range(f"log:{first!r}:{last!r}:{count}")
        with localcontext(prec=60):
            ratio = (Decimal(repr(last)) / Decimal(repr(first))).ln() / (count - 1)
            exact = [float(Decimal(repr(first)) * (ratio * i).exp()) for i in range(count)]
        assert points.at(np.arange(count)).tolist() == exact
        assert [float(x) for x in points.decimals()] == exact


ZERO = "0e99999999999999999999"
"""A text that no reader may turn into 0 times a power of ten."""


def test_a_zero_is_0_whatever_its_exponent(tmp_path: Path, lagtop: Lagtop) -> None:
    assert [parse_number(x) for x in (ZERO, f"-{ZERO}", "0.00E-99999999999")] == [0, 0, 0]
    assert parse_value("r0", f"5+/-{ZERO}", uncertain=True).std == 0
    assert parse_value("r0", f"{ZERO}:1:3 rpm", parse_values).number.bounds()[0] == 0
    assert {*parse_small(ZERO), *parse_complex(f"{ZERO}i")} == {0}
    assert lagtop("solve", "--psidot0", ZERO, "--get", "psidot0").stdout == "0.0\n"
    files = {
        "a.toml": f"r0 = {ZERO}\n",
        "a.csv": f"r0,psidot0\n40,{ZERO}\n",
        "t.csv": f"t\n{ZERO}\n",
    }
    for name, text in (files | {"a.ndjson": f'{{"psidot0": "{ZERO}"}}\n'}).items():
        (tmp_path / name).write_text(text)
    assert lagtop("solve", tmp_path / "a.toml", "--get", "r0").stdout == "0.0\n"
    for name in ("a.csv", "a.ndjson"):
        swept = lagtop("sweep", tmp_path / name, "--keys", "psidot0,error").stdout
        assert swept.split()[1] == "0.0,"
    assert lagtop("table", "--times", tmp_path / "t.csv").stdout.split()[1].startswith("0.0,")
    (tiny := tmp_path / "a.ndjson").write_text('{"psidot0": 1e-400}\n')
    said = f"{tiny}, line 1: must be 0 or at least 5e-324 in magnitude, got 1e-400"
    assert_one_line(lagtop("sweep", tiny), 65, said)
    for words in (["table", "--t-max", "1", "--n"], ["solve", "--digits"]):
        assert_one_line(lagtop(*words, ZERO), 2, f"{words[-1]} must be in [1,")


@pytest.mark.parametrize("number", ["1" * 100_000, f"(1+/-{'2' * 100_000}", "0x" + "f" * 9000])
def test_a_long_text_is_refused_at_once(number: str, lagtop: Lagtop) -> None:
    for parse in (None, parse_values, parse_number_or_span):
        with pytest.raises(LagtopError):
            parse_value("r0", number, parse, uncertain=True)
    with pytest.raises(LagtopError):
        parse_complex(f"{number}i")
    with pytest.raises(LagtopError):
        unit_of_text("*".join(["h^9"] * 1000))
    for words in (["--jobs", number], ["--shard", f"1/{number}"]):
        refused = lagtop("sweep", *words)
        assert (refused.exit_code, len(refused.stderr) < 500) == (2, True)
