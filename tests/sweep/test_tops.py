"""`solve --get` for shell scripts, and `table --tops` for the tables of many tops."""

from __future__ import annotations

import csv
import io
import json

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
    for wrong, meant in (("nutation_period", "T_nutation"), ("spin_rate_mean", "mean_spin_rate")):
        assert f"(did you mean '{meant}'?)" in lagtop("solve", "--get", wrong).stderr
    unknown = lagtop("solve", "--get", "T")
    assert (unknown.exit_code, unknown.stdout) == (2, "")
    assert unknown.stderr.startswith("Error: --get must be among 76 names, got 'T': m, A, C")
    assert lagtop("solve", "--get", "T_nut").stderr.startswith(
        "Error: --get must be among 76 names, got 'T_nut' (did you mean 'T_nutation'?): m, A, C"
    )
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


TOPS = "id,r0,theta0_deg\na,50,30\nb,5O,30\nc,-20,180\n"


def test_tables_of_tops(lagtop: Lagtop) -> None:
    options = ["--t-max", "1", "--n", "3", "--columns", "t,theta,axis"]
    result = lagtop("table", "--tops", "-", *options, input=TOPS)
    assert result.exit_code == 1
    header, *rows = csv.reader(io.StringIO(result.stdout))
    assert header == ["id", "t", "theta_deg", "axis_x", "axis_y", "axis_z", "error"]
    assert [row[0] for row in rows] == ["a", "a", "a", "b", "c", "c", "c"]
    assert rows[3][1:-1] == [""] * 5
    assert rows[3][-1].startswith("line 3: r0 must be")
    alone = list(csv.reader(io.StringIO(lagtop("table", *options).stdout)))[1:]
    assert [row[1:-1] for row in rows[:3]] == alone


def test_tables_of_tops_as_json_with_the_line_where_nothing_is_carried(lagtop: Lagtop) -> None:
    tops = '{"r0": 50}\n{"r0": 60, "psidot0": 1}\n'
    result = lagtop("table", "--tops", "-", "--n", "2", "--rad", "--format", "json", input=tops)
    rows = json.loads(result.stdout)
    assert [row["line"] for row in rows] == [1, 1, 2, 2]
    periods = [solve(Top(r0=50)).T_nutation, solve(Top(r0=60, psidot0=1)).T_nutation]
    assert [row["t"] for row in rows] == [0, periods[0], 0, periods[1]]
    assert {row["error"] for row in rows} == {None}


@pytest.mark.parametrize(
    "more", [["--digits", "20"], ["--format", "table"], ["--times", "-"], ["--columns", "x"]]
)
def test_what_does_not_go_with_tops(more: list[str], lagtop: Lagtop) -> None:
    result = lagtop("table", "--tops", "-", *more, input=TOPS)
    assert (result.exit_code, result.stdout) == (2, "")


@pytest.mark.parametrize("rad", [[], ["--rad", "--wrap"]])
@pytest.mark.parametrize("columns", ["t,theta,phi,psi", "psi,t"])
def test_tables_of_many_tops_are_computed_together(
    columns: str, rad: list[str], lagtop: Lagtop
) -> None:
    """Arrays serve from 16 tops on, where the times are the same; each is the table of one top."""
    tilt = "theta0_rad" if rad else "theta0_deg"
    tops = f"id,r0,{tilt},psidot0\n" + "".join(f"{i},{20 + i},{i % 3},{i % 2}\n" for i in range(40))
    options = ["--columns", columns, "--t-max", "2", "--n", "5", *rad]
    result = lagtop("table", "--tops", "-", *options, input=tops + "x,5O,1,0\n")
    assert result.exit_code == 1
    header, *rows = csv.reader(io.StringIO(result.stdout))
    assert header[1:-1] == next(csv.reader(io.StringIO(lagtop("table", *options).stdout)))
    assert [row[0] for row in rows] == [
        *(str(i) for i in range(40) for _ in range(1 if i % 3 == 0 and i % 2 else 5)),
        "x",
    ]
    assert rows[-1][-1].startswith("line 42: r0 must be")
    for i in (1, 2, 6, 38):
        more = ["--r0", 20 + i, "--theta0", i % 3, "--psidot0", i % 2]
        alone = list(csv.reader(io.StringIO(lagtop("table", *options, *more).stdout)))[1:]
        together = [row[1:-1] for row in rows if row[0] == str(i)]
        for one, other in zip(together, alone, strict=True):
            assert [float(x) for x in one] == pytest.approx([float(x) for x in other], rel=1e-14)
