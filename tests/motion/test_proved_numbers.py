"""Numbers of `solve` against the judge in Arb's balls, which has formulas of its own."""

from __future__ import annotations

import json
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from arb_balls import exact_arb
from ball_judge import Judge
from balls.scene import arb_bits
from conftest import Lagtop
from lagtop import Top, solve
from scenes import EVERY_KIND, NAMED

from lagrange_cli.errors import OutOfRangeWarning
from lagrange_cli.motion.record import NUMBER_KEYS, all_keys, requested_keys

SCENES = EVERY_KIND | NAMED
KEYS = (*NUMBER_KEYS, *requested_keys())


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_every_number_is_the_nearest_double_and_its_radius_holds(scene: dict[str, Any]) -> None:
    top = Top(**scene)
    motion, judge = solve(top), Judge(top.as_dict())
    record = motion.record(radii=True, keys=all_keys())
    plain = motion.record()
    assert {key: record[key] for key in plain} == plain
    with arb_bits(400):
        for key in KEYS:
            exact, value = judge.exact(key), record[key]
            assert (value is None) == (exact is None) == (record[f"{key}_radius"] is None), key
            if exact is not None:
                away, radius = abs(exact - exact_arb(value)), exact_arb(record[f"{key}_radius"])
                assert not away > radius, key
                assert radius <= abs(exact) * 2.0**-52 or away.contains(0), key
                assert judge.ulps(key, value) <= 0.5 + 1e-9, key
                assert str(value) != "-0.0", key


DECIMAL = {
    "worked example": {},
    "any start": EVERY_KIND["any start"],
    "decimals": {"r0": Fraction("50.1"), "theta0_deg": Fraction("30.1"), "psidot0": -3},
    "separatrix": EVERY_KIND["separatrix"],
    "radians": EVERY_KIND["radians"],
}


@pytest.mark.parametrize("digits", [1, 20, 50, 200])
@pytest.mark.parametrize("name", DECIMAL)
def test_digits_are_those_of_the_judge(digits: int, name: str) -> None:
    top = Top(**DECIMAL[name])
    record, judge = solve(top).record(digits=digits, radii=True), Judge(top.as_dict())
    for key in NUMBER_KEYS:
        if (text := record[key]) is not None:
            unit = Fraction(10) ** (Decimal(text).adjusted() + 1 - digits)
            away = judge.away(key, Fraction(text), digits)
            assert away <= exact_arb(unit) / 2, key
            assert not away > exact_arb(record[f"{key}_radius"]), key


def test_radians_and_inputs_have_radii() -> None:
    record = solve(Top(theta0_deg=30.0)).record(radians=True, radii=True)
    assert record["theta0_rad"] == 0.5235987755982989
    assert 0 < float(record["theta0_rad_radius"]) < 1.2e-16
    assert record["m_radius"] == "0.0"
    assert list(record)[-1] == "precession_rate_half_radius"
    rounded = solve(Top(m=Fraction("1587.25"))).record(digits=4, radii=True)
    assert (rounded["m"], rounded["m_radius"]) == ("1587.0", "0.26")
    some = solve(Top()).record(keys=["T_nutation", "regime"], radii=True)
    assert list(some) == ["regime", "T_nutation", "T_nutation_radius"]


def test_a_number_that_underflows_is_not_printed_as_zero(lagtop: Lagtop) -> None:
    """A printed 0 is exactly 0: what is smaller than all doubles is null, and digits print it."""
    motion = solve(Top(r0=1e90))
    with pytest.warns(OutOfRangeWarning, match="nome .* at least 5e-324.* got 3.975e-356: use"):
        assert motion.record()["nome"] is None
    assert motion.record(digits=4)["nome"] == "3.975e-356"
    shown = lagtop("solve", "--r0", "1e90", "--format", "json")
    assert json.loads(shown.stdout)["nome"] is None
    assert "use --digits" in shown.stderr
