"""The commands: formats, times, errors and help, in process."""

from __future__ import annotations

import csv
import json
import random
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Lagtop, Solved, assert_one_line, dicts
from lagtop import Top, solve
from test_frozen import KEYS as FROZEN_KEYS

from lagrange_cli import errors
from lagrange_cli.cli.app import NAMES as COMMANDS
from lagrange_cli.cli.fit import _write as write_fits
from lagrange_cli.output.destination import Output
from lagrange_cli.output.document import record_page
from lagrange_cli.output.formats.table import FORMAT
from lagrange_cli.output.report import Report
from lagrange_cli.solver.columns import COLUMNS
from lagrange_cli.solver.keys import KEYS as SHOWN
from lagrange_cli.solver.keys import all_keys
from lagrange_cli.top.inputs import DECLARED


def rows(text: str) -> list[list[float]]:
    return [list(map(float, row.values())) for row in dicts(text)]


# solve


def test_a_symbol_is_accepted_where_a_key_is(lagtop: Lagtop) -> None:
    by_key = lagtop("solve", "--get", "T_nutation,mean_precession_rate,theta_max_deg")
    assert lagtop("solve", "--get", "T,ψ' mean,ϑ max").stdout == by_key.stdout
    twice = lagtop("solve", "--get", "T,ψ' mean", "--get", "ϑ max")
    assert twice.stdout == by_key.stdout  # and nothing of the first list is lost
    radians = "solve --rad --theta0 0.5 --get".split()
    assert lagtop(*radians, "ϑ max").stdout == lagtop(*radians, "theta_max_rad").stdout
    budget = lagtop("solve", "--r0", "50(1)", "--budget", "T")
    assert budget.stdout == lagtop("solve", "--r0", "50(1)", "--budget", "T_nutation").stdout
    explained = lagtop("explain", "T", "Tψ", "E", "m").stdout  # m is also a unit
    names = [table.split()[0] for table in explained.split("\n\n")]
    assert names == ["T_nutation", "T_precession", "E", "m"]


@pytest.mark.parametrize("fmt", ["table", "csv"])
def test_an_undefined_key_does_not_suppress_the_others(lagtop: Lagtop, fmt: str) -> None:
    ask = ["solve", "--r0", "60", "--psidot0", "steady", "--format", fmt, "--get"]
    found = lagtop(*ask, "regime,path,T_nutation")
    start = "steady precession\n\n0.4" if fmt == "table" else "regime,path,T_nutation\nsteady"
    assert found.stdout.startswith(start)
    assert found.exit_code == 1
    assert found.stderr == "Error: path is undefined in the regime 'steady precession'\n"
    alone = lagtop(*ask, "path")
    assert (alone.exit_code, alone.stdout, alone.stderr) == (1, "", found.stderr)


def test_json_and_csv_have_the_frozen_keys_in_order(lagtop: Lagtop, solved: Solved) -> None:
    found = list(solved())
    inputs = "m A C s g r0 theta0_deg thetadot0 psidot0".split()
    numbers = [key for key in FROZEN_KEYS if key in found]
    assert found == [*inputs, "regime", *numbers, "path", "remark", "summary"]
    assert lagtop("solve", "--format", "csv").stdout.splitlines()[0] == ",".join(found[:-1])


def test_a_wide_table_has_the_names_too() -> None:
    keys = {"K": SHOWN["K"]}
    narrow, wide = (
        FORMAT.page(record_page({"K": 1.5}, lambda: keys, width), width) for width in (109, 110)
    )
    assert "first kind" in wide
    assert "first kind" not in narrow


def test_tables_of_ordinary_tops_fit_80_columns(lagtop: Lagtop) -> None:
    rng = random.Random(80)
    for _ in range(40):
        A, tilt = 10 ** rng.uniform(-5, 5), rng.choice([0, 180, rng.uniform(0, 180)])
        body = {"m": 10 ** rng.uniform(-3, 4), "A": A, "C": A * rng.uniform(0.01, 2)}
        body |= {"s": 10 ** rng.uniform(-2, 1), "g": rng.choice([0, 9.81, 981])}
        rates = {name: rng.choice([0, 10 ** rng.uniform(-2, 3)]) for name in ("r0", "psidot0")}
        rates |= {} if 0 < tilt < 180 else {"psidot0": 0}
        given = body | rates | {"theta0": tilt, "thetadot0": rng.choice([0, rng.uniform(-9, 9)])}
        options = [word for name, x in given.items() for word in (f"--{name}", repr(x))]
        shown = lagtop("solve", *options)
        assert shown.exit_code == 0, shown.stderr
        assert max(map(len, shown.stdout.splitlines())) <= 80, options


def test_the_table_says_whether_a_sleeping_top_is_stable(lagtop: Lagtop) -> None:
    for r0, regime in ((50, "sleeping, unstable"), (60, "sleeping")):
        shown = lagtop("solve", "--theta0", 0, "--r0", r0).stdout
        (line,) = (x for x in shown.splitlines() if x.startswith("regime"))
        assert line.removeprefix("regime").strip() == regime
        assert shown.splitlines()[-2:] == ["", solve(Top(theta0_deg=0, r0=r0)).remark]


# table


def test_formats_carry_the_same_doubles(lagtop: Lagtop) -> None:
    plain = rows(lagtop("table", "--t-max", "2").stdout)
    exact = np.stack(solve(Top()).angles([row[0] for row in plain]), axis=1)
    assert np.radians([row[1:] for row in plain]) == pytest.approx(exact, rel=4e-16, abs=0)
    objects = json.loads(lagtop("table", "--t-max", "2", "--format", "json").stdout)
    assert [list(item.values()) for item in objects] == plain
    assert list(objects[0]) == ["t", "theta_deg", "phi_deg", "psi_deg"]
    shown = lagtop("table", "--t-max", "2", "--format", "table").stdout.splitlines()[2:]
    assert [list(map(float, line.split())) for line in shown] == plain


@pytest.mark.parametrize(
    "line",
    [
        "table --n 3",
        "table --r0 50(1) --n 2",
        "table --digits 25 --certify --n 3 --t-max 1",
        "sweep --r0 5,50,300 --theta0 30,-1",
        "find --r0 10:200 T_precession=2",
    ],
)
def test_a_decimal_comma_changes_the_marks_only(line: str, lagtop: Lagtop) -> None:
    first, *rows_ = csv.reader(lagtop(*line.split()).stdout.splitlines())
    name, *others = csv.reader(
        lagtop(*line.split(), "--decimal", "comma").stdout.splitlines(), delimiter=";"
    )
    assert name == first
    words = [first.index(x) for x in ("regime", "path", "remark", "error") if x in first]
    for row, other in zip(rows_, others, strict=True):
        marked = [x if i in words else x.replace(".", ",") for i, x in enumerate(row)]
        assert other == marked


def test_a_grid_of_times_has_a_hundred_steps(lagtop: Lagtop) -> None:
    """Until a time, or for 1 if there is no period; `examples/numbers.txt` has other grids."""
    for words in (["--t-max", 1], ["--theta0", 0]):
        text = lagtop("table", *words).stdout
        assert text.splitlines()[0] == "t,theta_deg,phi_deg,psi_deg"
        assert [row[0] for row in rows(text)] == pytest.approx([i / 100 for i in range(101)])


@pytest.mark.parametrize("fmt", ["csv", "ndjson"])
def test_the_record_of_a_steady_top_is_a_file_of_tops(fmt: str, lagtop: Lagtop) -> None:
    record = lagtop("solve", "--r0", "60", "--psidot0", "steady", "--format", fmt).stdout
    result = lagtop("sweep", "-", "--keys", "regime,T_nutation", input=record)
    *_, regime, period, error = result.stdout.splitlines()[1].split(",")
    assert (regime, error) == ("steady precession", "")
    assert float(period) == pytest.approx(0.4637087134781949, rel=2e-15)


def test_one_window_of_a_fit_is_a_record_in_json(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    outcome: Any = SimpleNamespace(record=lambda: {"a": 1.5}, remarks=[])
    empty = Report({}, [], [], [])
    monkeypatch.setattr("lagrange_cli.inverse.report.fit_report", lambda *_, **__: empty)
    write_fits([outcome], "", "", Output(str(path := tmp_path / "fit"), "json"))
    assert path.read_text() == '{"a":1.5}\n'


# help


@pytest.mark.parametrize("command", ["", "-h", *COMMANDS])
def test_help_fits_a_screen_and_ends_with_examples(command: str, lagtop: Lagtop) -> None:
    result = lagtop(*command.split(), *(["--help"] if command in COMMANDS else []))
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert lines[0].startswith("Usage: lagtop ")
    assert max(map(len, lines)) <= 80
    examples = lines[lines.index("  Examples:") + 1 :]
    assert len(examples) >= 3
    assert all(line.startswith("    lagtop ") for line in examples)


def test_options_of_inputs_come_first_in_their_order(lagtop: Lagtop) -> None:
    shown = lagtop("solve", "--help").stdout.partition("Options:")[2]
    options = re.findall(r"^  (?:-\w, )?(--\S+)", shown, re.MULTILINE)
    inputs = [f"--{name.replace('_', '-')}" for name in DECLARED]
    assert [*options[: len(inputs) + 1], *options[-2:]] == [*inputs, "--rad", "--format", "--help"]
    assert " ".join(shown.split()).count("rad per unit of time") == 4


def test_help_shows_the_defaults_of_the_inputs(lagtop: Lagtop) -> None:
    for command in ("solve", "table", "sweep", "plot"):
        shown = " ".join(lagtop(command, "--help").stdout.split())
        for default in (1587, 39032, 17458, 4, 981, 50, 30, 0):
            assert f"[default: {default}]" in shown, command


def test_explain_lists_every_key_and_every_column(lagtop: Lagtop) -> None:
    names = [row["name"] for row in dicts(lagtop("explain", "--format", "csv").stdout)]
    assert sorted(names) == sorted([*all_keys(), *COLUMNS])
    assert lagtop("explain", "remark").stdout == f"remark: {SHOWN['remark'].meaning}\n"
    assert "pseudo-regular" in lagtop("explain", "remark", "fast-gyroscope").stdout


def test_scenes_are_found_by_name(
    lagtop: Lagtop, solved: Solved, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    by_file = {x.stem: solved(x) for x in (ROOT / "sample_inputs").glob("*.toml")}
    monkeypatch.chdir(tmp_path)
    listed = dicts(lagtop("scenes", "--format", "csv").stdout)
    assert [row["name"] for row in listed] == sorted(by_file)
    for name, record in by_file.items():
        assert solved(name) == record
        assert lagtop("table", name, "--n", "1").exit_code == 0
    unknown = lagtop("solve", "simo-wong")
    assert_one_line(
        unknown, 65, "simo-wong: No such file or directory (did you mean 'simo-wong-1991'?"
    )


def test_the_help_lists_the_exit_code_of_every_error(lagtop: Lagtop) -> None:
    listed = re.findall(r"(?m)^    (\d+)  +\S", lagtop("--help").stdout)
    kinds = [x for x in vars(errors).values() if isinstance(x, type) and hasattr(x, "exit_code")]
    assert {*listed} == {"0", "70"} | {str(kind.exit_code) for kind in kinds}
