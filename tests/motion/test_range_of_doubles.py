"""A number that leaves the range of doubles spoils only itself."""

from __future__ import annotations

import math

import pytest
from conftest import process
from lagtop import LagtopError, Top, solve, sweep

from lagrange_cli.errors import OutOfRangeError, OutOfRangeWarning

SCENE: dict[str, float] = {"r0": 2e-307, "theta0_deg": 30}
"""Almost a pendulum: it passes so close to the lower pole that it precesses there at 1e309."""
BEYOND = ["spin_rate_half", "precession_rate_half"]


def test_record() -> None:
    with pytest.warns(OutOfRangeWarning, match=r"spin_rate_half .*; precession_rate_half"):
        record = solve(Top(**SCENE)).record()
    assert [key for key, value in record.items() if value is None] == [*BEYOND, "remark"]
    assert (record["T_nutation"], record["u2"]) == (solve(Top(r0=0)).T_nutation, -1)


@pytest.mark.parametrize("key", BEYOND)
def test_a_key_that_is_asked_for_is_an_error(key: str) -> None:
    motion = solve(Top(**SCENE))
    with pytest.raises(OutOfRangeError, match=f"^{key} must be within 1.8e308"):
        getattr(motion, key)
    with pytest.raises(LagtopError, match=f"^{key} must be within 1.8e308"):
        motion.record(keys=["T_nutation", key])


def test_sweep() -> None:
    keys = ["T_nutation", *BEYOND, "error"]
    found = sweep(keys=keys, r0=[SCENE["r0"], 5.0], theta0_deg=30)
    assert all(math.isnan(found[key][0]) and not math.isnan(found[key][1]) for key in BEYOND)
    assert found["T_nutation"][0] == solve(Top(**SCENE)).T_nutation
    assert str(found["error"][0]).startswith("spin_rate_half must be within 1.8e308")
    assert found["error"][1] is None


@pytest.mark.parametrize(("fmt", "none"), [("json", b"null"), ("csv", b",,")])
def test_command(fmt: str, none: bytes) -> None:
    result = process("solve", "--r0", "2e-307", "--format", fmt)
    assert none in result.stdout
    assert result.stderr.startswith(b"Warning: spin_rate_half must be within 1.8e308")
    assert result.stderr.count(b"\n") == 1
    some = process("solve", "--r0", "2e-307", "--get", "T_nutation")
    assert (some.stderr, float(some.stdout)) == (b"", solve(Top(r0=0)).T_nutation)
    refused = process("solve", "--r0", "2e-307", "--get", BEYOND[0], check=False)
    assert refused.returncode == 2
    assert refused.stdout == b""
    assert refused.stderr.startswith(b"Error: spin_rate_half must be within 1.8e308")
