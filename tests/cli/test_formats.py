"""Formats of rows: one text per double everywhere, and files of numbers for NumPy and Arrow."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import orjson
import pytest
from conftest import ROOT, Lagtop, assert_one_line
from pyarrow import parquet

from lagrange_cli.arithmetic.text import csv_text
from lagrange_cli.output.destination import Output
from lagrange_cli.output.formats import FORMATS
from lagrange_cli.output.rows import csv_lines, json_objects

NAMES = ["a", "text", 'b,"', "c", "more"]


def rows_of(count: int) -> tuple[list[Any], list[list[Any]]]:
    """Return the columns of a block, and its rows as Python values."""
    rng = np.random.default_rng(count)
    numbers = rng.normal(size=(count, 3)) * 10.0 ** rng.integers(-300, 300, (count, 3))
    numbers[rng.random((count, 3)) < 0.2] = np.nan
    numbers[:, 2] = -0.0
    numbers[-1:] = numbers[:1]  # alike at the ends, but not in between
    texts = [(None, "re]g,[ular", 'a "b"\n', "ü")[i] for i in rng.integers(0, 4, count)]
    more = [(True, 1, 1.0, {"x": [1]}, "null")[i] for i in rng.integers(0, 5, count)]
    columns = [numbers[:, :1], texts, numbers[:, 1:], more]
    cells = [[None if math.isnan(x) else x for x in row] for row in numbers.tolist()]
    rows = [[x[0], y, *x[1:], z] for x, y, z in zip(cells, texts, more, strict=True)]
    return columns, rows


@pytest.mark.parametrize("count", [0, 1, 2, 1 << 14])
def test_blocks_are_what_each_row_gives_by_itself(count: int) -> None:
    columns, rows = rows_of(count)
    objects = [orjson.dumps(dict(zip(NAMES, row, strict=True))) for row in rows]
    assert json_objects(columns, NAMES, b",\n") == b",\n".join(objects)
    lines = "".join(",".join(map(csv_text, row)) + "\n" for row in rows)
    assert csv_lines(columns, NAMES) == lines.encode()


@pytest.mark.parametrize("width", [1, 2, 8, 9])
def test_arrays_alone_are_what_each_row_gives_by_itself(width: int) -> None:
    numbers = np.random.default_rng(width).normal(size=(50, width))
    numbers[::7, 0] = np.nan
    names = [f"x{i}" for i in range(width)]
    rows = [[None if math.isnan(x) else x for x in row] for row in numbers.tolist()]
    lines = [",".join(map(csv_text, row)) or '""' for row in rows]
    assert csv_lines([numbers], names).decode().splitlines() == lines


@pytest.mark.slow
@pytest.mark.parametrize("options", ["--n 40000", "--columns theta --n 3", "--times FILE --rad"])
@pytest.mark.parametrize("form", ["npy", "parquet"])
def test_files_of_numbers_hold_the_doubles_of_csv(
    form: str, options: str, tmp_path: Path, lagtop: Lagtop
) -> None:
    (tmp_path / "times").write_text("# seconds\n0\n0.25\n-3e5\n")
    words = options.replace("FILE", str(tmp_path / "times")).split()
    file = tmp_path / f"x.{form}"
    assert lagtop("table", *words, "--format", form, "-o", file).exit_code == 0
    header, *rows = csv.reader(io.StringIO(lagtop("table", *words).stdout))
    if form == "npy":
        array = np.load(file)
        assert list(array.dtype.names) == header
        found = array.tolist()
    else:
        table = parquet.read_table(file)
        assert table.column_names == header
        found = list(zip(*table.to_pydict().values(), strict=True))
    assert found == [tuple(map(float, row)) for row in rows]


@pytest.mark.parametrize("form", ["npy", "parquet"])
def test_the_judge_reads_what_table_writes(form: str, tmp_path: Path, lagtop: Lagtop) -> None:
    file = tmp_path / f"x.{form}"
    lagtop("table", "--r0", "40", "--t-max", "9", "--format", form, "-o", file)
    result = lagtop("compare", file, "--r0", "40", "--format", "json")
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["rows"]


def test_parquet_holds_the_tables_of_tops(tmp_path: Path, lagtop: Lagtop) -> None:
    file, tops = tmp_path / "x.parquet", "id,r0\na,5O\nb,50\n"
    options = ("table", "--tops", "-", "--n", "2", "--format")
    assert lagtop(*options, "parquet", "-o", file, input=tops).exit_code == 1
    rows = json.loads(lagtop(*options, "json", input=tops).stdout)
    assert parquet.read_table(file).to_pylist() == rows


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ("--format npy --tops -", "--format npy holds numbers of one top"),
        ("--format npy --digits 20", "--format npy holds doubles"),
        ("--format parquet --digits 20", "--format parquet holds doubles"),
        ("--format npy --times -", "--format npy begins with the number of rows"),
    ],
)
def test_what_files_of_numbers_cannot_hold(options: str, error: str, lagtop: Lagtop) -> None:
    assert_one_line(lagtop("table", *options.split(), input="0\n1\n"), 2, error)


ENDED = ["solve", "table --n 2", "sweep --keys T_nutation", "jacobi --k 0.8", "find --r0 9:99 b=20"]


NAMED = {"x.csv": "csv", "x.json": "json", "x.JSON": "json", "x.Csv": "csv"}
USUAL = dict.fromkeys(["ended", "ended.txt", "ended.TXT", ".csv", "ended."])


@pytest.mark.parametrize(
    ("line", "name", "form"),
    [(line, name, form) for line in ENDED for name, form in (NAMED | USUAL).items()]
    + [("table --n 2", "x.npy", "npy"), ("table --n 2", "x.parquet", "parquet")]
    + [("sweep", "x.parquet", "parquet")],
)
def test_the_name_of_a_file_tells_its_format(
    line: str, name: str, form: str | None, lagtop: Lagtop, tmp_path: Path
) -> None:
    """No extension and .txt mean the default; a format that is named may have any extension."""
    named = ["--format", form] if form else []
    wanted = lagtop(*line.split(), *named).stdout_bytes
    (tmp_path / "a.json").mkdir()
    file = tmp_path / "a.json" / name
    assert lagtop(*line.split(), "-o", file).exit_code == 0
    assert file.read_bytes() == wanted
    if form:
        lagtop(*line.split(), *named, "-o", tmp_path / "named.geojson")
        assert (tmp_path / "named.geojson").read_bytes() == wanted


@pytest.mark.parametrize("ending", ["npy", "parquet"])
def test_a_format_of_few_commands(ending: str, lagtop: Lagtop, tmp_path: Path) -> None:
    message = f"solve writes table, json, csv, ndjson, markdown and no {ending}, got --output"
    assert_one_line(lagtop("solve", "-o", tmp_path / f"solved.{ending}"), 2, message)


REPORTS = [
    "compare TRAJECTORY",
    "bench --n 3 --t-max 1",
    "stability --samples 1",
    "eta --delta 0.5 --delta-star -0.5 --p 1 --q 2",
]


@pytest.mark.parametrize(
    "name", "x.npz x.tsv x.xlsx x.csv.gz x.html x.table x.toml a.b/x.rst".split()
)
@pytest.mark.parametrize("line", [*ENDED, *REPORTS])
def test_other_extensions_are_refused(
    line: str, name: str, lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    refused = lagtop(*line.split(), "-o", name)
    assert (refused.exit_code, refused.stdout, list(tmp_path.iterdir())) == (2, "", [])
    assert f" and no {name.rpartition('.')[2]}, got --output '{name}'" in refused.stderr
    assert refused.stderr.endswith(": change the extension, or add --format\n")


def test_only_fit_writes_scenes(lagtop: Lagtop, tmp_path: Path) -> None:
    scene = tmp_path / "FITTED.TOML"
    assert lagtop("fit", ROOT / "sample_inputs" / "recording.csv", "-o", scene).exit_code == 0
    assert "r0 = " in scene.read_text()


def test_reports_and_rows_in_markdown(lagtop: Lagtop) -> None:
    summary, blank, heading, rule, *rows = lagtop("solve", "--format", "markdown").stdout.split(
        "\n"
    )
    assert summary.startswith("The axis nutates between 30.00 and 73.92 deg")
    assert blank == ""
    assert heading.split("|")[1:4] == [" Symbol ", " Name ", " Value "]
    assert set(rule) == {"|", "-", " "}
    assert {row.count("|") for row in rows if row} == {heading.count("|")}


def test_functions_as_files_of_numbers(lagtop: Lagtop, tmp_path: Path) -> None:
    request = ["jacobi", "--k", "0.8", "--u", "0:1:5"]
    rows = list(csv.reader(io.StringIO(lagtop(*request, "--format", "csv").stdout)))
    for name in ("table.npy", "table.parquet"):
        assert lagtop(*request, "-o", tmp_path / name).exit_code == 0
    array = np.load(tmp_path / "table.npy")
    frame = parquet.read_table(tmp_path / "table.parquet").to_pydict()
    assert list(array.dtype.names) == list(frame) == rows[0]
    for i, name in enumerate(rows[0]):
        expected = [float(row[i]) for row in rows[1:]]
        assert array[name].tolist() == frame[name] == expected


@pytest.mark.parametrize("name", ['a "b"', "a\\b", "a\tb", "θ", ""])
def test_a_record_in_json_holds_any_text(name: str, tmp_path: Path) -> None:
    """A recording has the name that a cell of its file gives it."""
    path = tmp_path / "record.json"
    Output(str(path), "json").record({"name": name, "a": 1.5, "remark": None}, dict)
    text = path.read_text(encoding="utf-8")
    assert json.loads(text) == {"name": name, "a": 1.5, "remark": None}
    assert text.encode() == orjson.dumps(json.loads(text)) + b"\n"


def test_missing_numbers_among_texts() -> None:
    texts = {name: form.texts for name, form in FORMATS.items() if form.texts}
    rows, names = [["1.5", ""], ["", "2"]], ["a", "b"]
    assert texts["csv"](rows, names) == b"1.5,\n,2\n"
    assert texts["csv"]([[""]], ["a"]) == b'""\n'  # readers would skip an empty line
    assert texts["json"](rows, names) == b'{"a":1.5,"b":null},\n{"a":null,"b":2}'
    assert texts["ndjson"](rows, names) == b'{"a":1.5,"b":null}\n{"a":null,"b":2}\n'
