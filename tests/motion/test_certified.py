"""Proved numbers: they agree with the judge in balls, which has formulas of its own."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from ball_judge import Judge
from scenes import EVERY_KIND as SCENES

from lagrange_cli import LagtopError, Top, solve
from lagrange_cli.arithmetic.balls import balls
from lagrange_cli.arithmetic.correct_rounding import TooFewDigitsError
from lagrange_cli.motion import certified as module
from lagrange_cli.motion.certified import certified, proved_largest_root
from lagrange_cli.motion.record import NUMBER_KEYS, requested_keys


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_the_record_is_that_of_the_program_and_of_the_judge(scene: dict[str, Any]) -> None:
    top = Top(**scene)
    proved, plain, judge = certified(top).record(), solve(top).record(), Judge(top.as_dict())
    assert {key: proved[key] for key in plain} == plain
    for key in NUMBER_KEYS:
        exact = judge.record.get(key)
        assert (proved[key] is None) == (exact is None) == (proved[f"{key}_radius"] is None), key
        if exact is not None:
            with balls(400).working():
                away = abs(exact - balls(400).convert(proved[key]).arb)
                radius = balls(400).convert(Fraction(proved[f"{key}_radius"])).arb
                assert not away > radius, key
                assert radius <= abs(exact) * 2.0**-52 or away.contains(0), key


@pytest.mark.parametrize("name", ["worked example", "any start", "over the top", "torque-free"])
def test_numbers_on_request(name: str) -> None:
    top = Top(**SCENES[name])
    motion, proved = solve(top), certified(top)
    for key in requested_keys():
        found = proved.number(key)
        assert (None if found is None else found.value) == getattr(motion, key), key


@pytest.mark.parametrize("digits", [1, 20, 150])
@pytest.mark.parametrize("name", ["worked example", "any start", "separatrix", "radians"])
def test_digits_are_those_of_the_program(digits: int, name: str) -> None:
    top = Top(**SCENES[name])
    plain, proved = solve(top).digits(digits), certified(top).record(digits)
    assert {key: proved[key] for key in plain} == plain
    for key in ("T_nutation", "u2"):
        if plain[key] is not None:
            size, radius = abs(Fraction(proved[key])), Fraction(proved[f"{key}_radius"])
            assert 0 < radius <= size * Fraction(10) ** (1 - digits)


def test_radians_and_inputs_have_radii() -> None:
    record = certified(Top(theta0_deg=30.0)).record(radians=True)
    assert record["theta0_rad"] == 0.5235987755982989
    assert 0 < float(record["theta0_rad_radius"]) < 1.2e-16
    assert record["m_radius"] == "0.0"
    assert list(record)[-1] == "precession_rate_half_radius"
    rounded = certified(Top(m=Fraction("1587.25"))).record(4)
    assert (rounded["m"], rounded["m_radius"]) == ("1587.0", "0.26")
    some = certified(Top()).record(keys=["T_nutation", "regime"])
    assert list(some) == ["regime", "T_nutation", "T_nutation_radius"]


def test_a_number_beyond_doubles_is_said() -> None:
    with pytest.raises(LagtopError, match=r"within 1\.8e308"):
        certified(Top(m=1e100, s=1e100, g=1e100, A=1e-80, C=1e-80)).record()


@pytest.mark.parametrize(("near", "proved"), [(5, True), (5.0001, True), (2, False), (1, False)])
def test_the_root_is_proved_to_be_the_largest(
    near: float, proved: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Start from a point next to another root of (x - 1)(x - 2)(x - 5)."""
    ar = balls(200)
    with ar.working():
        c2, c1, c0, bound, point = (ar.convert(x) for x in (-8, 17, -10, 100, near))
        assert proved_largest_root(ar, c2, c1, c0, bound).arb.contains(5)
        monkeypatch.setattr(module, "near_largest_root", lambda *_: point.arb)
        if proved:
            assert proved_largest_root(ar, c2, c1, c0, bound).arb.contains(5)
        else:
            with pytest.raises(TooFewDigitsError):
                proved_largest_root(ar, c2, c1, c0, bound)
