"""`lagtop sweep`: the numbers of `solve`, for many tops, from grids and from files."""

from __future__ import annotations

import csv
import decimal
import io
import json
import math
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Lagtop, dicts
from lagtop import Top, solve, sweep

from lagrange_cli.sweeps.records import column_keys


def test_a_steady_top_per_row(lagtop: Lagtop) -> None:
    """A row has the rate as a number, or an error if there is none; a file may have the word."""
    keys = ["--keys", "r0,psidot0,T_nutation,error"]
    grid = lagtop("sweep", "--r0=-60,50,70", "--psidot0", "steady", *keys)
    cells = "r0,psidot0\n-60,steady\n50,steady\n70,steady\n"
    assert lagtop("sweep", "-", *keys, input=cells).stdout.replace("line 3: ", "") == grid.stdout
    slow, absent, fast = dicts(grid.stdout)
    assert absent["error"].startswith("psidot0 cannot be steady: |r0| must be at least 52.5611")
    assert [absent["T_nutation"], slow["error"], fast["error"]] == ["", "", ""]
    for row in (slow, fast):
        motion = solve(Top(r0=float(row["r0"]), psidot0="steady"))
        assert float(row["psidot0"]) == pytest.approx(motion.top.psidot0, rel=1e-15)
    none = sweep(psidot0="steady", r0=np.linspace(1, 52, 99), keys=["b", "T_nutation", "error"])
    assert np.isnan([none["b"], none["T_nutation"]]).all()
    assert all(none["error"])
    mixed = dicts(lagtop("sweep", "-", *keys, input=f"{cells}70,2\n").stdout)
    assert [mixed[2], mixed[3]["psidot0"], mixed[3]["error"]] == [fast, "2.0", ""]


def test_results_have_the_column_error_if_a_top_has_one() -> None:
    bad = sweep(m=[1587, -1, math.nan], theta0_deg=[[30], [181]], keys=["T_nutation"])
    assert list(bad) == ["T_nutation", "error"]
    assert np.isfinite(bad["T_nutation"]).tolist() == [[True, False, False], [False] * 3]
    reasons = [None, "m must be > 0, got -1.0", "m must be finite, got nan"]
    assert bad["error"][0].tolist() == reasons
    assert bad["error"][1, 0] == "theta0_deg must be in [0, 180], got 181.0"
    assert sweep(r0=[])["nome"].shape == (0,)
    late = sweep(m=9000 * [1587] + [-1], keys=["T_nutation"])["error"]
    assert np.flatnonzero(late).tolist() == [9000]
    assert list(sweep(m=[1587], keys=["T_nutation"])) == ["T_nutation"]
    assert list(sweep(m=[-1], keys=["error", "a"])) == ["error", "a"]


def test_settings_of_the_host_program_change_no_bit() -> None:
    tilts, rates = [0, 1e-150, 179.9999999, 30], [[[0]], [[1]]]
    inputs: Any = {"theta0_deg": tilts, "r0": [[0], [50]], "psidot0": rates}
    context = decimal.Context(prec=1, Emin=-1, Emax=1, traps=[decimal.Inexact, decimal.Rounded])
    for keys in (None, ["steady_rate_fast", "f_upright", "Lz"]):
        usual = sweep(**inputs, keys=keys)
        with np.errstate(all="raise"), decimal.localcontext(context):
            found = sweep(**inputs, keys=keys)
        for key, column in usual.items():
            np.testing.assert_array_equal(column, found[key])


def test_keys_of_a_grid_are_all_that_is_printed(lagtop: Lagtop) -> None:
    result = lagtop("sweep", "--r0", "0,50", "--keys", "T_nutation,spin_rate_half")
    header, *rows = csv.reader(io.StringIO(result.stdout))
    assert header == ["T_nutation", "spin_rate_half"]
    assert [bool(cell) for row in rows for cell in row] == [True, False, True, True]
    said = "Error: 1 of 2 tops have an error; the first: theta0_deg must be in [0, 180], got -1.0"
    for key, cell, remedy in (
        ("k", '""', "; add error to --keys to see every reason"),
        ("error", f'"{said.partition("first: ")[2]}"', ""),
    ):
        failed = lagtop("sweep", "--r0", "50", "--theta0", "30,-1", "--keys", key)
        assert (failed.exit_code, failed.stderr) == (1, f"{said}{remedy}\n")
        assert failed.stdout.splitlines()[::2] == [key, cell]
    assert lagtop("sweep", "--C", "1,8e4").exit_code == 1


def test_where_keeps_the_rows_that_satisfy_every_condition(lagtop: Lagtop) -> None:
    """In every format, and with parts that keep no row; a missing number satisfies nothing."""
    grid = ["sweep", "--theta0", "0,30", "--r0", "20:60:5", "--keys", "r0,T_nutation,path,error"]
    where = ["--where", "T_nutation<0.43", "--where", "theta_max <= 65"]
    every = dicts(lagtop(*grid[:-1], f"{grid[-1]},theta_max_deg").stdout)
    kept = [x for x in every if x["T_nutation"] and float(x["T_nutation"]) < 0.43]
    kept = [x for x in kept if float(x.pop("theta_max_deg")) <= 65]
    assert 0 < len(kept) < 5
    assert dicts(lagtop(*grid, *where).stdout) == kept
    for fmt in ("json", "ndjson", "csv"):
        all_rows = lagtop(*grid, "--where", "r0>0", "--format", fmt).stdout
        assert all_rows == lagtop(*grid, "--format", fmt).stdout
        none = lagtop(*grid, "--where", "T_nutation > 9", "--format", fmt)
        assert none.stdout == {"json": "[]\n", "csv": "r0,T_nutation,path,error\n"}.get(fmt, "")
        assert none.stderr == "Warning: no top satisfies T_nutation > 9\n"
    words = lagtop(*grid, "--where", "regime=sleeping").stdout
    assert [x["T_nutation"] for x in dicts(words)] == [""] * 5
    bad = lagtop("sweep", "-", "--where", "r0<9", "--keys", "r0", input="id,r0\n1,50\n2,x\n3,5\n")
    assert (bad.exit_code, bad.stdout) == (1, "id,r0,error\n3,5.0,\n")
    assert "1 of 3 tops have an error; the first: line 3" in bad.stderr


def test_formats_carry_the_same_doubles(lagtop: Lagtop) -> None:
    grid, absent = ["sweep", "--r0", "0:60:7", "--theta0", "0,30", "--format"], {"nan", "None"}
    exact = sweep(r0=np.repeat(np.arange(0, 61, 10), 2), theta0_deg=np.tile([0, 30], 7))
    objects = json.loads(lagtop(*grid, "json").stdout)
    assert objects == [json.loads(line) for line in lagtop(*grid, "ndjson").stdout.splitlines()]
    for i, (row, cells) in enumerate(zip(objects, dicts(lagtop(*grid, "csv").stdout), strict=True)):
        assert list(row) == list(cells) == column_keys()
        for key, value in row.items():
            assert cells[key] == ("" if value is None else str(value))
            assert value == exact[key][i] or (value is None and str(exact[key][i]) in absent)


def test_parquet_carries_the_same(tmp_path: Path, lagtop: Lagtop) -> None:
    pytest.importorskip("pyarrow")
    from pyarrow import parquet

    text = tmp_path / "tops.csv"
    text.write_text("id,r0\n7,0\n8,40\n9,x\n")
    rows = lagtop("sweep", text, "--format", "json").stdout
    whole, parts = tmp_path / "x.parquet", tmp_path / "parts"
    for options in (["-o", whole], ["--parts", parts]):
        assert lagtop("sweep", text, "--format", "parquet", *options).exit_code == 1
    for file in (whole, parts / "part-000000.parquet"):
        assert parquet.read_table(file).to_pylist() == json.loads(rows)
    large = tmp_path / "large.parquet"
    assert lagtop("sweep", "--r0", "1:9:110000", "--keys", "r0", "-o", large).exit_code == 0
    about = parquet.ParquetFile(large).metadata
    groups = [about.row_group(i).num_rows for i in range(about.num_row_groups)]
    assert (sum(groups), groups[0] >= 100_000, len(groups)) == (110_000, True, 2)
    empty = tmp_path / "empty.parquet"
    lagtop("sweep", "-", "--format", "parquet", "-o", empty, input="r0\n")
    assert parquet.read_table(empty).num_rows == 0


def test_dicts(tmp_path: Path, lagtop: Lagtop) -> None:
    file = tmp_path / "tops.csv"
    file.write_text('r0;m\n"1,5";3\n2.5;3\n')
    mixed = lagtop("sweep", file, "--keys", "r0", "--A", "9", "--C", "9", "--s", "4", "--g", "9")
    assert mixed.stderr.endswith(
        "r0 must be a finite decimal number, got '2.5' (use --decimal point)\n"
    )
    file.write_text("r0,theta0_deg\n400 rpm,30\n")
    hint = "got '400 rpm' (write the unit in the heading, as NAME [UNIT])\n"
    assert lagtop("sweep", file, "--keys", "r0").stderr.endswith(hint)
    file.write_bytes(
        b"\xef\xbb\xbfname,r0,theta0_deg,T_nutation\r\n"
        b'"a, ""b""",50,30,9\r\n\r\n=x,5_0,30,9\r\nc,7\r\n'
        b'd,"40",1e400,9\r\n"e,1,2\r\nf,-60,20,9\r\n'
    )
    result = lagtop("sweep", file, "--keys", "r0,T_nutation", "--psidot0", "0")
    assert result.exit_code == 1
    assert result.stderr == (
        "Error: 4 of 6 tops have an error; the first: line 4: r0 must be a finite decimal number, "
        "got '5_0' (leave out the underscores)\n"
    )
    rows = dicts(result.stdout)
    assert [row["name"] for row in rows] == ['a, "b"', "=x", "c", "d", "", "f"]
    where = ["", *(f"line {i}" for i in range(4, 8)), ""]
    assert [row["error"].partition(":")[0] for row in rows] == where
    assert float(rows[-1]["T_nutation"]) == pytest.approx(
        solve(Top(r0=-60, theta0_deg=20)).T_nutation, rel=1e-15
    )


def test_rows_of_json(lagtop: Lagtop) -> None:
    text = '{"id": 1, "r0": 40}\n{"id": {"x": [2]}, "theta0_rad": 1, "r0": 7}\n{"r0": true}\n'
    text += '{"r0": "500(5)"}\n'
    keys = ["--keys", "r0,theta0_deg,error", "--format", "ndjson"]
    result = lagtop("sweep", "-", "--theta0", "20", *keys, input=text)
    rows = list(map(json.loads, result.stdout.splitlines()))
    assert [(row["id"], row["id.x_0"]) for row in rows[:3]] == [(1, None), (None, 2), (None, None)]
    assert [row["theta0_deg"] for row in rows[:2]] == [20, math.degrees(1)]
    assert [row["error"] for row in rows[:3]] == [
        *2 * [None],
        "line 3: r0 must be a finite number, got true",
    ]
    assert "r0 must be a finite decimal number, got '500(5)'" in rows[3]["error"]
    assert result.exit_code == 1


def test_what_a_sweep_wrote_can_be_swept_again(tmp_path: Path, lagtop: Lagtop) -> None:
    once, twice = tmp_path / "once.csv", tmp_path / "twice.csv"
    lagtop("sweep", "--r0", "0:100:50", "--theta0", "0,10,180", "-o", once)
    lagtop("sweep", once, "-o", twice)
    assert once.read_bytes() == twice.read_bytes()


MANY = 240_000
GRID = {"r0": np.linspace(1, 100, 200)[:, None], "theta0_deg": np.linspace(1, 179, MANY // 200)}
STARTS = {"theta0_deg": np.linspace(1, 179, MANY), "psidot0": np.linspace(-5, 5, MANY)}
BODY = {"m": 1587.0, "C": 17458.0, "s": 4.0, "g": 981.0, "A_cm": np.full(MANY, 13640.0)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("inputs", "keys"),
    [
        (GRID, ["r0", "T_nutation"]),
        (GRID, None),
        (STARTS | {"thetadot0": np.full(MANY, 2.0)}, ["T_nutation"]),
        (STARTS | {"phidot0": np.full(MANY, 50.0)}, ["T_nutation", "Lz"]),
        (STARTS | BODY, ["T_nutation"]),
    ],
    ids=["grid", "record", "any start", "another form", "another body"],
)
def test_memory_of_a_sweep_is_its_result_and_a_block(
    inputs: dict[str, Any], keys: list[str] | None
) -> None:
    """Measured 7 to 14 MB for a block; inputs that are one number for all take no room."""
    tracemalloc.start()
    try:
        size = sum(column.nbytes for column in sweep(**inputs, keys=keys).values())
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak - size < 16e6
