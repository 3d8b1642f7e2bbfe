"""Properties that hold for every input, searched by hypothesis."""

from __future__ import annotations

import csv
import io
import json
import math
from fractions import Fraction
from typing import Any

import numpy as np
import orjson
import pytest
from click.testing import CliRunner
from hypothesis import example, given, settings
from hypothesis import strategies as st
from lagtop import LagtopError, Top, solve

from lagrange_cli.arithmetic.text import csv_text, double_text, parse_number, value_text
from lagrange_cli.cli.app import main
from lagrange_cli.motion.numbers import record_in_range
from lagrange_cli.motion.record import NUMBER_KEYS
from lagrange_cli.output.formats import block_text, part_file

doubles = st.floats(allow_nan=False, allow_infinity=False)
spins = st.floats(-1e6, 1e6)
tilts = st.floats(0, 180)


@given(doubles)
def test_a_printed_double_reads_back_as_itself(x: float) -> None:
    assert float(parse_number(repr(x))) == x


@given(doubles)
def test_a_double_has_one_text_in_every_format(x: float) -> None:
    text = double_text(x)
    assert text.encode() == orjson.dumps(x)
    assert text == value_text(x) == csv_text(x)
    assert f"{text}\n".encode() == block_text([np.array([[x]])], ["x"], "csv")
    assert f'{{"x":{text}}}\n'.encode() == block_text([np.array([[x]])], ["x"], "ndjson")
    assert math.copysign(1, float(text)) == math.copysign(1, x)
    assert float(text) == x


cells = st.one_of(st.none(), st.text(st.characters(exclude_categories=["Cs"])), st.integers(0, 9))


@pytest.mark.slow
@given(st.lists(st.tuples(cells, doubles, cells), min_size=1))
def test_csv_and_json_read_back_as_they_were(rows: list[tuple[Any, float, Any]]) -> None:
    first, numbers, last = (list(column) for column in zip(*rows, strict=True))
    columns: list[Any] = [first, np.array(numbers)[:, None], last]
    names = ["a", "b,", 'c"']
    for style in ("ndjson", "json"):
        text = block_text(columns, names, style).decode()
        lines = text.rstrip("\n").split("\n") if style == "ndjson" else json.loads(f"[{text}]")
        found = [json.loads(line) if isinstance(line, str) else line for line in lines]
        assert [tuple(row.values()) for row in found] == rows
    text = part_file("csv", names, 0, block_text(columns, names, "csv")).decode()
    header, *found = csv.reader(io.StringIO(text, newline=""))
    assert header == names
    wanted = [["" if x is None else x if type(x) is str else str(x) for x in row] for row in rows]
    assert [[a, float(b), c] for a, b, c in found] == [[a, float(b), c] for a, b, c in wanted]


@pytest.mark.slow
@given(st.text())
def test_any_text_is_a_number_or_one_clear_error(text: str) -> None:
    try:
        number = parse_number(text)
    except LagtopError:
        with pytest.raises(LagtopError, match=r"^must "):
            parse_number(text)
    else:
        assert isinstance(number, Fraction)


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


@pytest.mark.slow
@settings(max_examples=25)
@given(r0=spins, theta0=tilts)
def test_json_is_json_and_carries_the_doubles(r0: float, theta0: float) -> None:
    options = ["--r0", repr(r0), "--theta0", repr(theta0), "--format", "json"]
    result = CliRunner().invoke(main, ["solve", *options])
    if result.exit_code:
        assert result.stderr.startswith("Error: ")
        assert (result.exit_code, result.stdout, result.stderr.count("\n")) == (2, "", 1)
        return
    record = json.loads(result.stdout, parse_constant=pytest.fail)
    del record["summary"]
    assert record["r0"] == r0
    expected, beyond = record_in_range(solve(Top(r0=r0, theta0_deg=theta0)))
    assert record == expected
    assert result.stderr == (f"Warning: {'; '.join(map(str, beyond))}\n" if beyond else "")
