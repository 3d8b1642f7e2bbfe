"""Compare today's numbers with those of commit eec8223, which proved them by another arithmetic.

`frozen.json` was written once by `tools/freeze.py` of commit 69ed2d7.  A later commit may only
remove names from it, or replace the branch of a complex function that mpmath shows to be wrong;
DIGEST changes with it.  The last CORNERS records, tops at the ends of the doubles, have the numbers
of `record_reference` with 6,000 digits for the roots.
A key that is null in the lists `keys` and `radian_keys` is not compared.
"""

from __future__ import annotations

import hashlib
import json
import math
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from conftest import Lagtop, columns_of
from lagtop import LagtopError, Motion, Top, sensitivities, solve

from lagrange_cli.top.inputs import replaced_by

PATH = Path(__file__).parent / "frozen.json"
DIGEST = "66c9e45c46b7f533f85f9c519a89ded57ae53a8de46c232108c64a6d9da066b9"
CORNERS = 16
FROZEN: dict[str, Any] = json.loads(PATH.read_bytes())
KEYS: list[str | None] = FROZEN["keys"]

HAIR = Fraction(1, 10**29)
"""Relative error of a number with 30 digits, rounded up."""
LARGEST, SMALLEST = Fraction(2) ** 1024, Fraction(1, 2**1074)
RADIAN = Fraction("0.0174532925199432957692369076848861271344287188854172545609719144")
ANGLES = ("theta", "phi", "psi", "dphi", "dpsi")


def test_the_file_is_the_frozen_one() -> None:
    """A new digest needs a reason in the message of its commit."""
    assert hashlib.sha256(PATH.read_bytes()).hexdigest() == DIGEST


def top_of(inputs: dict[str, Any]) -> Top:
    """Return a top whose inputs are doubles, words, or texts of decimals."""
    exact: dict[str, Any] = {
        name: Fraction(x) if isinstance(x, str) and not x.startswith("steady") else x
        for name, x in inputs.items()
    }
    top = Top(**exact)
    derived = {x: getattr(top, x) for name in inputs if (x := replaced_by(name)) in {"A", "r0"}}
    return top.replace(**derived)  # at that time A and r0 were rounded to doubles


def assert_double(motion: Motion, key: str, text: str | None) -> None:
    """Check that a number of a motion is its 30 digits, rounded to the nearest double."""
    exact = Fraction(text or 0)
    if exact and not SMALLEST <= abs(exact) < LARGEST:
        with pytest.raises(LagtopError):
            getattr(motion, key)
        return
    value = getattr(motion, key)
    if value is None or text is None:
        assert value is text, (key, motion.top)
    elif value != float(exact):  # perhaps almost midway between two doubles
        near = {float(exact * (1 - HAIR)), float(exact * (1 + HAIR))}
        assert value in near, (key, motion.top, text)


SHARES = [0, *(pytest.param(i, marks=pytest.mark.slow) for i in range(1, 4))]
"""A quick run compares every fourth top, and a slow run the others."""


@pytest.mark.parametrize("share", SHARES)
def test_records(share: int) -> None:
    """Words and numbers with 30 digits are the same, and doubles are next to them."""
    radian_keys = [key for key in FROZEN["radian_keys"] if key]
    for entry in FROZEN["records"][share::4]:
        motion = solve(top_of(entry["top"]))
        expected = {key: x for key, x in zip(KEYS, entry["numbers"], strict=True) if key}
        assert [motion.regime, motion.path] == entry["words"], entry["top"]
        assert motion.record(digits=30, keys=list(expected)) == expected, entry["top"]
        if "radians" in entry:
            found = motion.record(digits=30, radians=True, keys=radian_keys)
            known = zip(FROZEN["radian_keys"], entry["radians"], strict=True)
            assert found == {key: x for key, x in known if key}, entry["top"]
        for key, text in expected.items():
            assert_double(motion, key, text)


def options_of(inputs: dict[str, Any]) -> list[str]:
    """Return a top as options of the command line, with all digits of its doubles."""
    names = {"theta0_deg": "theta0", "theta0_rad": "theta0", "A_cm": "A-cm"}
    options = ["--rad"] if "theta0_rad" in inputs else []
    for key, x in inputs.items():
        options.append(f"--{names.get(key, key)}={x if isinstance(x, str) else Decimal(x)}")
    return options


@pytest.mark.slow  # a picture takes seconds
@pytest.mark.parametrize("entry", FROZEN["records"][-CORNERS:], ids=lambda x: str(x["top"]))
def test_commands_at_the_ends_of_the_doubles(
    lagtop: Lagtop, tmp_path: Path, entry: dict[str, Any]
) -> None:
    """Commands compute, or refuse the top in one line."""
    words, path = options_of(entry["top"]), tmp_path / "rows.csv"
    name = max(entry["top"], key=lambda x: abs(math.log(abs(entry["top"][x]) or 1)))  # the end
    for command in (
        ["table", "--n", 4, "-o", path],
        ["compare", path],
        ["solve", f"--{name.removesuffix('_deg')}", f"{entry['top'][name]!r}+/-0.1%"],
        ["plot", "-o", tmp_path / "picture.svg"],
        ["view", "-o", tmp_path / "page.html"],
    ):
        result = lagtop(*command[:1], *words, *command[1:])
        assert result.exit_code == 0 or command[0] in ("plot", "view"), result.stderr
        assert result.exit_code == 0 or result.stderr.count("Error: ") == 1, result.stderr


@pytest.mark.parametrize("share", SHARES)
def test_tables(share: int, lagtop: Lagtop, tmp_path: Path) -> None:
    """Columns have the same 20 digits, and doubles are within the tolerance of each cell."""
    path = tmp_path / "times.txt"
    for entry in FROZEN["tables"][share::4]:
        cells, times = entry["cells"], entry["times"]
        path.write_text("".join(f"{Decimal(t)}\n" for t in times))
        words = [*options_of(entry["top"]), "--times", path, "--columns", ",".join(cells)]
        result = lagtop("table", *words, "--digits", 20, "--format", "csv")
        assert result.exit_code == 0, result.stderr
        degrees = "theta0_rad" not in entry["top"]
        units = {name: ("_deg" if degrees else "_rad") * (name in ANGLES) for name in cells}
        printed = {f"{name}{units[name]}": column for name, column in cells.items()}
        assert columns_of(result.stdout) == printed, entry["top"]
        computed = solve(Top(**entry["top"])).table(times, list(cells))
        for name, column in cells.items():
            unit = RADIAN if units[name] == "_deg" else 1
            allowed = entry["tolerances"][name]
            for t, text, value, most in zip(times, column, computed[name], allowed, strict=True):
                error = abs(Fraction(float(value)) - Fraction(text) * unit)
                assert error <= Fraction(most), (name, t, entry["top"])


@pytest.mark.parametrize("entry", FROZEN["functions"], ids=lambda entry: " ".join(entry["command"]))
def test_functions(lagtop: Lagtop, entry: dict[str, Any]) -> None:
    """The functions of the two sources have the same 25 digits."""
    result = lagtop(*entry["command"], "--format", "csv")
    assert result.exit_code == 0, result.stderr
    found = columns_of(result.stdout)
    assert {name: found.get(name) for name in entry["columns"]} == entry["columns"]


@pytest.mark.parametrize("entry", FROZEN["derivatives"], ids=lambda entry: str(entry["top"]))
def test_derivatives(entry: dict[str, Any]) -> None:
    """Derivatives are the same; null was not computed, though one-sided it may exist."""
    top = Top(**entry["top"])
    found = sensitivities(top).derivatives
    assert found.keys() == entry["derivatives"].keys()
    for key, row in entry["derivatives"].items():
        for name, derivative in row.items():
            if top.exact_tilt.pole and (key, name) == ("u_quarter", "theta0_deg"):
                continue  # beside the vertical u_quarter does not exist
            if derivative is not None:
                assert found[key][name] == pytest.approx(derivative, rel=1e-12, abs=0), (key, name)
