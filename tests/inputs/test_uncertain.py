"""Uncertain numbers as they are written."""

from __future__ import annotations

from fractions import Fraction

import pytest

from lagrange_cli import LagtopError
from lagrange_cli.inputs.uncertain import Uncertain, parse_uncertain


@pytest.mark.parametrize(
    ("text", "value", "std"),
    [
        ("73.9(12)", "73.9", "1.2"),
        ("73.9(1.2)", "73.9", "1.2"),
        ("73.95(12)", "73.95", "0.12"),
        ("1587(2)", "1587", "2"),
        ("-0.4293(48)", "-0.4293", "0.0048"),
        ("1.23(4)e-5", "1.23e-5", "0.04e-5"),
        ("1.23(4.5)e2", "123", "450"),
        ("1587+/-2", "1587", "2"),
        ("(1.5 ± 0.25)e3", "1500", "250"),
        ("-200 +- 5 %", "-200", "10"),
    ],
)
def test_forms(text: str, value: str, std: str) -> None:
    assert parse_uncertain(text) == Uncertain(Fraction(value), Fraction(std))


@pytest.mark.parametrize("text", ["1(2", "(1)", "1+/-", "1(-2)", "1(2)(3)", "1±2±3", "5%"])
def test_other_texts_are_refused(text: str) -> None:
    with pytest.raises(LagtopError, match=r"must be a number, or an uncertain one as 1587\(2\)"):
        parse_uncertain(text)


def test_a_negative_uncertainty_is_refused() -> None:
    with pytest.raises(LagtopError, match="must have an uncertainty >= 0"):
        parse_uncertain("1+/--2")
