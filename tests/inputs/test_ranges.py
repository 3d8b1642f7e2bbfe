"""The grammar of ranges, and the points that they stand for."""

from __future__ import annotations

import math
import random
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from conftest import Lagtop
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from lagtop import LagtopError, Top, solve

from lagrange_cli.arithmetic.points import POINTS_AT_ONCE, EvenPoints, ListedPoints
from lagrange_cli.inputs.ranges import Product, parse_range, parse_values
from lagrange_cli.motion.over_time.table import rows


def exact_points(points: EvenPoints) -> list[float]:
    return [float(points.start + i * points.step) for i in range(points.count)]


numbers = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(Fraction),
    st.fractions(-(10**6), 10**6, max_denominator=10**4),
    st.decimals(-1000, 1000, places=3).map(Fraction),
)


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])  # no test is timed
@given(numbers, numbers, st.integers(2, 40))
@example(Fraction(0), Fraction(1.797e308), 33)
def test_every_point_is_rounded_once(first: Fraction, last: Fraction, count: int) -> None:
    points = EvenPoints(first, (last - first) / (count - 1), count)
    values = points.at(np.arange(count)).tolist()
    assert values == exact_points(points)
    assert [math.copysign(1, x) for x in values] == [math.copysign(1, x or 1) for x in values]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("start", "step"),
    [
        ("1", Fraction(1, 2**53)),  # every other point lies half way between two doubles
        ("-0.5", "1e-5"),  # over 0
        ("1e308", "1e300"),
        ("-1e-310", "1e-314"),
        ("0", "5e-324"),
        ("1e16", "0.3"),
        ("-123456789.123", "0.001"),
    ],
)
def test_hard_points_are_rounded_once(start: str, step: str | Fraction) -> None:
    points = EvenPoints(Fraction(start), Fraction(step), 30_000)
    assert [x for block in points.blocks() for x in block.tolist()] == exact_points(points)


def test_blocks_and_bounds() -> None:
    points = parse_range(f"1:{3 * POINTS_AT_ONCE}:{3 * POINTS_AT_ONCE}")
    assert [block.size for block in points.blocks()] == [POINTS_AT_ONCE] * 3
    assert points.bounds() == [1, 3 * POINTS_AT_ONCE]
    assert parse_values("3,1,2").bounds() == [1, 3]
    assert parse_values("log:-4:-1:3").bounds() == [-4, -1]
    assert str(parse_range("0:1:3")) == "0:1:3"
    assert str(parse_range("log:1:1e2:3")) == "log:1:100:3"
    assert str(parse_values("0.5,2")) == "1/2,2"


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("away", [1, -1])
def test_the_last_time_of_a_grid_decides_what_is_out_of_reach(side: int, away: int) -> None:
    """Ten times, of which the last (or, from a far start, the first) is near 2^50 periods."""
    motion = solve(Top())
    assert motion.T_nutation is not None
    edge = Fraction(motion.T_nutation) * 2**50
    step = side * edge / 100
    inside, outside = (edge * (1 + k * Fraction(1, 10**9)) * side for k in (-1, 1))

    def grid(end: Fraction) -> EvenPoints:
        """Return ten points that end (or, backwards, begin) at a time."""
        return EvenPoints(end - 9 * step if away > 0 else end, away * step, 10)

    assert next(rows(motion, grid(inside))[1]).shape == (10, 4)
    with pytest.raises(LagtopError, match="within 2\\^50 periods"):
        rows(motion, grid(outside))


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


BAD_RANGES = {
    "0:10:1": "must have a count of 2 or more between different ends, got '0:10:1'",
    "0:1": "must be a range [log:]start:stop:count, got '0:1'",
    "0:1:2:3": "must be a range [log:]start:stop:count, got '0:1:2:3'",
    "lin:0:1:2": "must be a range [log:]start:stop:count",
    "0:1:0": "must have a whole count of 1 to 1e9 in its range",
    "0:1:-2": "must have a whole count of 1 to 1e9 in its range",
    "0:1:2.5": "must have a whole count of 1 to 1e9 in its range",
    "0:1:1e10": "must have a whole count of 1 to 1e9 in its range",
    "0:x:2": "must be a finite decimal number, got 'x'",
    "log:0:1:3": "must have two ends of one sign, not 0, in a log: range",
    "log:-1:1:3": "must have two ends of one sign, not 0, in a log: range",
}
WHERE = {
    "sweep --r0 {}": "--r0",
    "jacobi --k 0.5 --u {}": "--u",
    "eta --delta 1 --delta-star 0 --gap-below 1 --tau {}": "--tau",
    "plot map --x r0={} -o x.png": "--x",
    "plot map --y r0={} -o x.png": "--y",
}


@pytest.mark.parametrize(("text", "command"), list(product(BAD_RANGES, WHERE)))
def test_one_grammar_everywhere(text: str, command: str, lagtop: Lagtop) -> None:
    result = lagtop(*command.format(text).split())
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"Error: {WHERE[command]} {BAD_RANGES[text]}")


def test_ranges_are_spaced_alike_everywhere(lagtop: Lagtop) -> None:
    values = parse_range("0:1:11").at(np.arange(11)).tolist()
    swept = lagtop("sweep", "--r0", "0:1:11", "--keys", "r0").stdout.split()[1:]
    options = ["--k", "0.5", "--u", "0:1:11", "--format", "csv"]
    arguments = [line.partition(",")[0] for line in lagtop("jacobi", *options).stdout.splitlines()]
    assert [float(x) for x in swept] == [float(x) for x in arguments[1:]] == values
    assert values[3] == 0.3


def test_a_logarithmic_range_of_arguments(lagtop: Lagtop) -> None:
    options = ["jacobi", "--k", "0.5", "--u", "log:1:100:3", "--format", "csv"]
    exact = lagtop(*options, "--digits", "20").stdout.splitlines()
    assert [line.partition(",")[0] for line in exact] == ["u", "1.0", "10.0", "100.0"]
    assert lagtop(*options).stdout.splitlines()[2].startswith("10.0,")


def test_combinations() -> None:
    axes = {"r0": ListedPoints([Fraction(1), Fraction(2)]), "theta0_deg": parse_values("5:7:3")}
    blocks = list(Product(axes).blocks(4))
    assert [block.size for block in blocks] == [4, 2]
    columns = [block.arrays({"m": 3.0, "r0": 9.0}).inputs for block in blocks]
    pairs = [
        pair
        for inputs in columns
        for pair in zip(np.ravel(inputs["r0"]), np.ravel(inputs["theta0_deg"]), strict=True)
    ]
    assert pairs == list(product([1, 2], [5, 6, 7]))
    assert {inputs["m"] for inputs in columns} == {3.0}
