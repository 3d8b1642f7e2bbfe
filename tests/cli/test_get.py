"""`solve --get` for shell scripts."""

from __future__ import annotations

import pytest
from conftest import Lagtop
from lagtop import Top, solve

from lagrange_cli.arithmetic.text import value_text


@pytest.mark.parametrize("key", ["T_nutation", "regime", "theta0_deg", "path"])
def test_get_prints_one_bare_value(key: str, lagtop: Lagtop) -> None:
    record = solve(Top(r0=40)).record()
    assert lagtop("solve", "--r0", "40", "--get", key).stdout == f"{value_text(record[key])}\n"


def test_get_with_digits_and_radians(lagtop: Lagtop) -> None:
    result = lagtop("solve", "--get", "theta_max_rad", "--rad", "--theta0", "1", "--digits", "25")
    table = lagtop("solve", "--rad", "--theta0", "1", "--digits", "25", "--format", "json").stdout
    assert f'"theta_max_rad":{result.stdout.strip()},' in table


def test_get_what_is_not_there(lagtop: Lagtop) -> None:
    absent = lagtop("solve", "--theta0", "0", "--get", "T_nutation")
    assert (absent.exit_code, absent.stdout) == (1, "")
    assert absent.stderr == "Error: T_nutation is undefined in the regime 'sleeping'\n"
    in_csv = lagtop("solve", "--get", "T_nutation,k", "--format", "csv").stdout
    bare = lagtop("solve", "--get", "T_nutation,k").stdout
    assert in_csv == f"T_nutation,k\n{bare.replace(chr(10), ',', 1)}"
    assert lagtop("solve", "--get", "a,k,a").stderr == (
        "Error: --get must not repeat a name, got 'a' twice\n"
    )


def test_several_values(lagtop: Lagtop) -> None:
    record = solve(Top(r0=40)).record()
    keys = ["path", "T_nutation", "Lz"]
    lines = lagtop("solve", "--r0", "40", "--get", ",".join(keys)).stdout.splitlines()
    assert lines == [record["path"], str(record["T_nutation"]), str(solve(Top(r0=40)).Lz)]
    absent = lagtop("solve", "--theta0", "0", "--get", "a,T_nutation")
    assert (absent.exit_code, absent.stdout) == (1, "")
