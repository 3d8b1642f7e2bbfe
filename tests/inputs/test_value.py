"""Inputs as people write them: the number, its uncertainty, and where the unit begins."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pint
import pytest
import xarray
from uncertainties import ufloat

from lagrange_cli.errors import LagtopError
from lagrange_cli.inputs.ranges import parse_values
from lagrange_cli.inputs.uncertain import are_possible
from lagrange_cli.inputs.value import Stds, Value, parse_value, split_unit, value_of


@pytest.mark.parametrize(
    ("text", "number", "unit"),
    [
        ("30", "30", ""),
        (" -1.5e-3 ", "-1.5e-3", ""),
        ("350g", "350", "g"),
        ("3.9e-3 kg*m^2", "3.9e-3", "kg*m^2"),
        ("2e3eV", "2e3", "eV"),
        ("2e g", "2", "e g"),
        ("50 1/s", "50", "1/s"),
        ("50/s", "50", "/s"),
        ("1 1 / s", "1", "1 / s"),
        ("-30°/s", "-30", "°/s"),
        ("5 µm", "5", "µm"),
        ("1587(2) g", "1587(2)", "g"),
        ("1587(2)e-3kg", "1587(2)e-3", "kg"),
        ("1587+/-2 g", "1587+/-2", "g"),
        ("1587 ± 0.1 % g", "1587 ± 0.1 %", "g"),
        ("(1.587 +/- 0.002)e3 g", "(1.587 +/- 0.002)e3", "g"),
        ("1587+/-2", "1587+/-2", ""),
        ("100:200:5 rpm", "100:200:5", "rpm"),
        ("log:1:1e4:50 rpm", "log:1:1e4:50", "rpm"),
        ("log:1:1e4:50", "log:1:1e4:50", ""),
        ("1,2,3kg", "1,2,3", "kg"),
        ("1kg,2kg", "1kg,2kg", ""),
        ("0:x:2", "0:x:2", ""),
        ("0:1:x", "0:1:x", ""),
        ("log:1:2: x", "log:1:2: x", ""),
        ("1,2,x", "1,2,x", ""),
        ("nan", "nan", ""),
        ("-inf", "-inf", ""),
        ("pi/6", "pi/6", ""),
        ("", "", ""),
        ("1_000", "1_000", ""),
        ("5O", "5", "O"),
    ],
)
def test_the_unit_begins_at_the_first_letter(text: str, number: str, unit: str) -> None:
    assert split_unit(text) == (number, unit)


def test_a_value_has_its_number_read_and_its_unit_as_written() -> None:
    assert parse_value("350 g") == Value(Fraction(350), "g")
    assert parse_value("1e3") == Value(Fraction(1000))
    assert parse_value("350(2) g", uncertain=True) == Value(Fraction(350), "g", Fraction(2))
    with pytest.raises(LagtopError, match=r"got '3,5 g' \(write a decimal point, not a comma"):
        parse_value("3,5 g")
    with pytest.raises(LagtopError, match=r"no uncertainty in this command, got '1\(2\)'"):
        parse_value("1(2)")


@pytest.mark.parametrize(
    ("text", "number", "std"),
    [
        ("73.9(12)", "73.9", "1.2"),
        ("73.9(1.2)", "73.9", "1.2"),
        ("73.95(12)", "73.95", "0.12"),
        ("1587(2)", "1587", "2"),
        ("-20(0)", "-20", "0"),
        ("-0.4293(48)", "-0.4293", "0.0048"),
        ("1.587(2)e3", "1587", "2"),
        ("1.23(4)e-5", "1.23e-5", "0.04e-5"),
        ("1.23(4.5)e2", "123", "450"),
        ("1587+/-2", "1587", "2"),
        ("1587±2", "1587", "2"),
        ("1587 +- 2", "1587", "2"),
        (" 1587 +/- 0.1 % ", "1587", "1.587"),
        ("(-1.5+/-0.1)e3", "-1500", "100"),
        ("(1.5 ± 0.25)e3", "1500", "250"),
        ("-200 +- 5 %", "-200", "10"),
    ],
)
def test_uncertain_numbers_are_exact(text: str, number: str, std: str) -> None:
    assert parse_value(text, uncertain=True) == Value(Fraction(number), "", Fraction(std))
    points = parse_value(text, parse_values, uncertain=True)
    assert (points.number.exact, points.std) == ([Fraction(number)], Fraction(std))


@pytest.mark.parametrize(
    "text", ["1(2", "(1)", "1+/-", "1(-2)", "1(2)(3)", "1±2±3", "5%", "nan+/-1", "()"]
)
def test_other_texts_are_refused(text: str) -> None:
    with pytest.raises(LagtopError, match=r"must be a number, or an uncertain one as 1587\(2\)"):
        parse_value(text, uncertain=True)


@pytest.mark.parametrize(
    ("text", "wrong"), [("1+/--2", "uncertainty >= 0"), ("3(1)e999", "1.8e308")]
)
def test_an_uncertainty_is_at_least_0_and_finite(text: str, wrong: str) -> None:
    with pytest.raises(LagtopError, match=wrong):
        parse_value(text, uncertain=True)


UNIT: Any = pint.UnitRegistry()


@pytest.mark.parametrize(
    ("given", "value"),
    [
        (50, Value(50)),
        (Value(Fraction(1), "g"), Value(Fraction(1), "g")),
        (ufloat(50, 0.5), Value(50.0, "", Fraction(1, 2))),
        (UNIT.Quantity(350, "g"), Value(Fraction(350), "gram")),
        (UNIT.Quantity(np.int64(3), "kg m^2"), Value(Fraction(3), "kilogram*meter**2")),
        (UNIT.Quantity(np.array(0.25), "m"), Value(Fraction(1, 4), "meter")),
        (UNIT.Quantity(ufloat(50, 0.5), "degree"), Value(50, "degree", Fraction(1, 2))),
        (UNIT.Quantity(4.0, "cm").plus_minus(0.25), Value(4, "centimeter", Fraction(1, 4))),
    ],
)
def test_objects_of_other_libraries_are_values(given: Any, value: Value) -> None:
    found = value_of("x", given)
    assert found == value
    assert isinstance(found.number, Fraction) == bool(value.unit)


def test_arrays_keep_their_type_and_a_unit_of_pint() -> None:
    found = value_of("r0", UNIT.Quantity([400.0, 500.0], "rpm"))
    assert (found.unit, found.number.tolist()) == ("revolutions_per_minute", [400.0, 500.0])
    assert found.scaled(Fraction(1, 4)).number.tolist() == [100.0, 125.0]
    labelled = xarray.DataArray([1.0, 2.0], dims="x", attrs={"units": "kg"})
    assert value_of("m", labelled).number is labelled
    assert value_of("m", labelled).unit == ""


@pytest.mark.parametrize(
    ("given", "wrong"),
    [
        (UNIT.Quantity(float("nan"), "kg"), "m must be a finite number, got nan"),
        (ufloat(1, float("inf")), "the uncertainty of m must be a finite number, got inf"),
    ],
)
def test_objects_without_a_finite_number_are_refused(given: Any, wrong: str) -> None:
    with pytest.raises(LagtopError) as found:
        value_of("m", given)
    assert (str(found.value), found.value.key) == (wrong, "m")


def test_sources_are_factors_of_the_correlations() -> None:
    """Random matrices of any rank: the sources add up to them, as NumPy multiplies."""
    rng, names = np.random.default_rng(1), ["m", "A", "C", "s", "r0"]
    for rank in (1, 2, 4, 5, 5):
        vectors = rng.normal(size=(5, rank))
        vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
        matrix = vectors @ vectors.T
        pairs = {
            frozenset((names[i], names[j])): Fraction(float(matrix[i, j]))
            for i in range(5)
            for j in range(i)
        }
        stds = Stds(dict.fromkeys(names, 1.0), pairs)
        assert len(stds.sources) == rank
        columns = np.array(
            [
                [float(shares.get(x, 0)) * float(d) ** 0.5 for x in names]
                for d, shares in stds.sources
            ]
        ).T
        assert columns @ columns.T == pytest.approx(matrix, abs=1e-6 if rank < 5 else 1e-14)
        assert are_possible(stds.matrix())
        some = stds.only(["s", "m"])
        assert (list(some), list(some.correlations)) == (["m", "s"], [frozenset("ms")])


def test_correlations_are_possible_if_no_eigenvalue_is_negative() -> None:
    rng, names = np.random.default_rng(2), ["m", "A", "C", "s"]
    found = []
    for _ in range(200):
        low = np.tril(rng.uniform(-1, 1, size=(4, 4)), -1)
        least = np.linalg.eigvalsh(low + low.T + np.eye(4))[0]
        pairs = {
            frozenset((names[i], names[j])): Fraction(float(low[i, j]))
            for i in range(4)
            for j in range(i)
        }
        assert are_possible(Stds(dict.fromkeys(names, 1.0), pairs).matrix()) == (least > 0)
        found.append(least > 0)
    assert 20 < sum(found) < 180
