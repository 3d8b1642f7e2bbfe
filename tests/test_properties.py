"""What holds for every input, searched by hypothesis."""

from __future__ import annotations

import json
import math
from fractions import Fraction

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from lagrange_cli import LagtopError, Top, solve
from lagrange_cli.cli import main
from lagrange_cli.top import parse_number

doubles = st.floats(allow_nan=False, allow_infinity=False)
spins = st.floats(-1e6, 1e6)
tilts = st.floats(0, 180)


@given(doubles)
def test_a_printed_double_reads_back_as_itself(x: float) -> None:
    assert float(parse_number(repr(x))) == x


@given(st.text())
def test_any_text_is_a_number_or_one_clear_error(text: str) -> None:
    try:
        number = parse_number(text)
    except LagtopError:
        with pytest.raises(LagtopError, match=r"^must "):
            parse_number(text)
    else:
        assert isinstance(number, Fraction)


@settings(max_examples=40, deadline=None)
@given(r0=spins, theta0=tilts, psidot0=st.floats(-1e3, 1e3), thetadot0=st.floats(-1e3, 1e3))
def test_every_start_gives_numbers_or_one_clear_error(
    r0: float, theta0: float, psidot0: float, thetadot0: float
) -> None:
    start = {"r0": r0, "theta0_deg": theta0, "psidot0": psidot0, "thetadot0": thetadot0}
    try:
        motion = solve(Top(**start))
    except LagtopError:
        with pytest.raises(LagtopError, match=r"^\w+ must be "):
            solve(Top(**start))
        return
    assert all(value is None or math.isfinite(value) for value in motion.numbers().values())
    t = np.linspace(-1, 1, 101) * float(motion.T_nutation or 1)
    angles = motion.angles(t)
    assert np.isfinite(angles).all()
    least, greatest = (
        math.radians(motion.theta_min_deg or 0),
        math.radians(motion.theta_max_deg or 0),
    )
    assert angles.theta.min() >= least - 4e-15
    assert angles.theta.max() <= greatest + 4e-15


@settings(max_examples=25, deadline=None)
@given(r0=spins, theta0=tilts)
def test_json_is_json_and_carries_the_doubles(r0: float, theta0: float) -> None:
    options = ["--r0", repr(r0), "--theta0", repr(theta0), "--format", "json"]
    result = CliRunner().invoke(main, ["solve", *options])
    if result.exit_code:
        assert result.stderr.startswith("Error: ")
        assert (result.exit_code, result.stdout, result.stderr.count("\n")) == (2, "", 1)
        return
    record = json.loads(result.stdout, parse_constant=pytest.fail)
    assert record["r0"] == r0
    expected = solve(Top(r0=r0, theta0_deg=theta0)).record()
    assert record == expected
