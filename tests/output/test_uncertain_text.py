"""The rounding rule of the Particle Data Group, next to its bounds."""

from __future__ import annotations

import pytest

from lagrange_cli.output.report import last_place, uncertain_text


@pytest.mark.parametrize(
    ("std", "shown"),
    [
        (0.1, "5.00(10)"),
        (0.3549, "5.00(35)"),
        (0.355, "5.0(4)"),
        (0.9494, "5.0(9)"),
        (0.95, "5.0(1.0)"),
        (0.97, "5.0(1.0)"),
        (0.9949, "5.0(1.0)"),
        (0.999, "5.0(1.0)"),
        (1.0, "5.0(1.0)"),
    ],
)
def test_digits_next_to_the_bounds_of_the_rule(std: float, shown: str) -> None:
    """The text is that of the rule: 354, 355, 949, 950 and 1000 are its bounds."""
    assert uncertain_text(5.0, std) == shown


@pytest.mark.parametrize("power", [-12, -3, 0, 5, 200])
def test_the_place_follows_the_power_of_ten(power: int) -> None:
    for first_three, digits in ((100, 2), (354, 2), (355, 1), (949, 1), (950, 1), (999, 1)):
        std = float(f"{first_three}e{power - 2}")
        assert last_place(std) == power - digits + 1
