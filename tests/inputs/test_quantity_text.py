"""Inputs as people write them: where the number ends and the unit begins."""

from __future__ import annotations

import pytest

from lagrange_cli.arithmetic.text import parse_number
from lagrange_cli.errors import LagtopError
from lagrange_cli.inputs.quantity_text import Quantity, parse_quantity, split_unit


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


def test_a_quantity_has_its_number_read_and_its_unit_as_written() -> None:
    assert parse_quantity("350 g", parse_number) == Quantity(350, "g")
    assert parse_quantity("1e3", parse_number) == 1000
    with pytest.raises(LagtopError, match=r"decimal point, not a comma"):
        parse_quantity("3,5 g", parse_number)
