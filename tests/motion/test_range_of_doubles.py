"""A number that leaves the range of doubles spoils only itself."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from conftest import process
from lagtop import LagtopError, Top, solve, sweep

from lagrange_cli.errors import OutOfRangeError, OutOfRangeWarning

SCENE: dict[str, float] = {"r0": 2e-307, "theta0_deg": 30}
"""Almost a pendulum: it passes so close to the lower pole that it precesses there at 1e309."""
BEYOND = ["spin_rate_half", "precession_rate_half"]


def test_the_size_of_the_scene() -> None:
    """At T/2, (4,7) with 1 + u2 of (4,14): b (u1 - u2)/((1 + u2)(1 - u2)), next to u2 = -1."""
    a, b = (mpmath.mpf(getattr(solve(Top(**SCENE)), key)) for key in "ab")
    u1 = mpmath.cos(mpmath.pi / 6)
    below = b * b * (1 + u1) / (2 * a)  # (u3 + 1)(u2 + 1) = b^2 (1 + u1)/a, with u3 + 1 = 2
    assert b * (u1 + 1) / (2 * below) > mpmath.mpf(10) ** 309


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


def test_other_keys_do_not_warn() -> None:
    """Warnings are errors in these tests."""
    assert solve(Top(**SCENE)).record(keys=["T_nutation", "spin_rate_start"])
    assert solve(Top(**SCENE)).record(digits=20)["spin_rate_half"].startswith("3.56")


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


@pytest.mark.slow
@pytest.mark.parametrize("r0", [0.0, 1.0, 20.0])
def test_phases_whose_hyperbolic_functions_are_beyond_all_doubles(r0: float) -> None:
    """The axis leaves the upward vertical by 1e-315 rad in a unit of time.

    As long as it is upright phi + psi = r0 t, which is what r = phi' + psi' cos(theta) says.
    """
    motion = solve(Top(theta0_deg=0, thetadot0=1e-315, r0=r0))
    assert motion.T_nutation is not None
    parts = np.array([0.0, 0.1, 0.25, 0.4, 0.6, 0.75, 0.9, 1.0])
    times = parts * motion.T_nutation
    angles = motion.angles(times)
    assert np.abs(angles.theta).max() < 1e-3
    turned = (angles.phi + angles.psi)[parts < 0.5]
    assert turned == pytest.approx((r0 * times)[parts < 0.5], rel=1e-12, abs=1e-12)
    assert np.isfinite(angles.phi).all()
    assert np.isfinite(angles.psi).all()
