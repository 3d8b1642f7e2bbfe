"""Properties that hold for every input, searched by hypothesis."""

from __future__ import annotations

import math

import numpy as np
import orjson
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from lagtop import LagtopError, Top, solve

from lagrange_cli.arithmetic.text import csv_text, double_text, value_text
from lagrange_cli.motion.numbers import record_in_range
from lagrange_cli.motion.record import NUMBER_KEYS
from lagrange_cli.output.formats import block_text

doubles = st.floats(allow_nan=False, allow_infinity=False)
spins = st.floats(-1e6, 1e6)
tilts = st.floats(0, 180)


@given(doubles)
def test_a_double_has_one_text_in_every_format(x: float) -> None:
    text = double_text(x)
    assert text.encode() == orjson.dumps(x)
    assert text == value_text(x) == csv_text(x)
    assert f"{text}\n".encode() == block_text([np.array([[x]])], ["x"], "csv")
    assert f'{{"x":{text}}}\n'.encode() == block_text([np.array([[x]])], ["x"], "ndjson")
    assert math.copysign(1, float(text)) == math.copysign(1, x)
    assert float(text) == x


@pytest.mark.slow
@settings(max_examples=40)
@given(r0=spins, theta0=tilts, psidot0=st.floats(-1e3, 1e3), thetadot0=st.floats(-1e3, 1e3))
@example(r0=0.0, theta0=8.6e-122, psidot0=8.6e-122, thetadot0=1.0)  # the least tilt is 1e-365
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
    record, _ = record_in_range(motion)
    assert all(math.isfinite(record[key] or 0) for key in NUMBER_KEYS)
    t = np.linspace(-1, 1, 101) * float(motion.T_nutation or 1)
    angles = motion.angles(t)
    assert np.isfinite(angles).all()
    least, greatest = (math.radians(record[f"theta_{end}_deg"] or 0) for end in ("min", "max"))
    assert angles.theta.min() >= least - 4e-15
    assert angles.theta.max() <= greatest + 4e-15
