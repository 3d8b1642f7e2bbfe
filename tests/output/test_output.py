"""Formats of rows, reports, files that are replaced, and texts on a terminal."""

from __future__ import annotations

import csv
import io
import json
import math
import os
import re
import stat
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import orjson
import pytest
from conftest import tables_of
from hypothesis import given
from hypothesis import strategies as st
from lagtop import LagtopError, Top, solve
from pyarrow import parquet

from lagrange_cli.arithmetic.text import NumberText, double_text, value_text
from lagrange_cli.errors import CannotWriteError
from lagrange_cli.output import terminal
from lagrange_cli.output.destination import Output, opened
from lagrange_cli.output.document import Document, Grid, record_document, record_page, rows_grid
from lagrange_cli.output.formats.base import format_of
from lagrange_cli.output.formats.table import FORMAT, drawn
from lagrange_cli.output.notebook import HasRecord
from lagrange_cli.output.report import Field, Report
from lagrange_cli.output.text import csv_text
from lagrange_cli.solver.keys import shown_keys

NAMES = ["a", "text", 'b,"', "c", "more"]


def write_x(path: str) -> None:
    with opened(path) as stream:
        stream.write(b"x")


def table_of(page: Any, width: int | None) -> str:
    return FORMAT.page(page, width)


def rows_text(names: Any, rows: Any, width: int | None) -> str:
    return table_of([rows_grid(names, rows)], width)


def rows_of(count: int) -> tuple[list[Any], list[list[Any]]]:
    """Return the columns of a block, and its rows as Python values."""
    rng = np.random.default_rng(count)
    numbers = rng.normal(size=(count, 3)) * 10.0 ** rng.integers(-300, 300, (count, 3))
    numbers[rng.random((count, 3)) < 0.2] = np.nan
    texts = [(None, "re]g,[ular", 'a "b"\n', "ü")[i] for i in rng.integers(0, 4, count)]
    more = [(True, 1, 1.0, {"x": [1]}, "null")[i] for i in rng.integers(0, 5, count)]
    cells = [[None if math.isnan(x) else x for x in row] for row in numbers.tolist()]
    rows = [[x[0], y, *x[1:], z] for x, y, z in zip(cells, texts, more, strict=True)]
    return [numbers[:, :1], texts, numbers[:, 1:], more], rows


def text_of(fmt: str, names: list[str], *blocks: Any) -> str:
    stream, form = io.BytesIO(), format_of(fmt)
    form.write(stream, names, [form.block(columns, names) for columns in blocks], None)
    return stream.getvalue().decode()


def test_two_blocks_read_back_as_the_rows() -> None:
    (columns, rows), (more, others) = rows_of(3), rows_of(50)
    expected = [dict(zip(NAMES, row, strict=True)) for row in rows + others]
    assert json.loads(text_of("json", NAMES, columns, more)) == expected
    lines = text_of("ndjson", NAMES, columns, more).splitlines()
    assert [json.loads(line) for line in lines] == expected
    header, *cells = csv.reader(io.StringIO(text_of("csv", NAMES, columns, more), newline=""))
    assert header == NAMES
    for found, row in zip(cells, rows + others, strict=True):
        for cell, value in zip(found, row, strict=True):
            if isinstance(value, str | None):
                assert cell == (value or "")
            else:
                assert json.loads(cell) == value


def test_blocks_of_parquet_and_parts_read_back() -> None:
    form = format_of("parquet")
    blocks = [form.block([np.array([[1.5], [math.nan]]), [x, None]], ["a", "b"]) for x in "xy"]
    for kept, end in ((blocks, "y"), (blocks[:1], "x")):
        form.write(stream := io.BytesIO(), ["a", "b"], kept, None)
        found = parquet.read_table(stream).to_pylist()
        assert found[:2] == [{"a": 1.5, "b": "x"}, {"a": None, "b": None}]
        assert found[-2:] == [{"a": 1.5, "b": end}, {"a": None, "b": None}]
    assert [format_of("csv").part(["a"], i, b"1\n") for i in (0, 1)] == [b"a\n1\n", b"1\n"]
    assert format_of("ndjson").part(["a"], 0, b"{}\n") == b"{}\n"


def test_every_format_holds_the_rows_of_a_document() -> None:
    rows = [{"n": 1, "text": "x", "any": {"y": 2}, "none": None, "late": None}]
    rows += [{"n": 2.5, "text": None, "any": "z", "none": None, "late": math.inf}]
    document = Document([*rows[0]], rows, lambda _: [])
    read = parquet.read_table(io.BytesIO(format_of("parquet").document(document, None)))
    assert read.to_pylist() == [rows[0] | {"any": '{"y":2}'}, rows[1]]
    assert [str(x) for x in read.schema.types] == ["double", "string", "string", *["double"] * 2]
    assert json.loads(format_of("json").document(document, None))[0] == rows[0]
    with pytest.raises(LagtopError, match="format parquet is not for a terminal"):
        format_of("parquet").document(document, 80)


def test_numbers_that_are_written_out_keep_their_digits() -> None:
    columns = [[NumberText("1.50"), NumberText("")], [NumberText(""), NumberText("2e-9")]]
    assert text_of("csv", ["a", "b"], columns) == "a,b\n1.50,\n,2e-9\n"
    assert text_of("json", ["a", "b"], columns) == '[{"a":1.50,"b":null},\n{"a":null,"b":2e-9}]\n'
    assert text_of("csv", ["a"], [[NumberText("")]]) == 'a\n""\n'
    assert text_of("csv", ["a"], [np.array([[math.nan], [1e-7]])]) == 'a\n""\n1e-7\n'
    assert text_of("csv", ["a", "b"], [np.array([[math.nan, 2], [3, 4]])]) == "a,b\n,2.0\n3.0,4.0\n"
    assert text_of("csv", ["a", "b"]) == "a,b\n"
    assert text_of("json", ["a"]) == "[]\n"
    assert text_of("ndjson", ["a"]) == ""


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_double_has_one_text_in_every_format(x: float) -> None:
    text = double_text(x)
    assert text.encode() == orjson.dumps(x)
    assert text == value_text(x) == csv_text(x)
    assert f"{text}\n".encode() == format_of("csv").block([np.array([[x]])], ["x"])
    assert f'{{"x":{text}}}\n'.encode() == format_of("ndjson").block([np.array([[x]])], ["x"])
    assert math.copysign(1, float(text)) == math.copysign(1, x)
    assert float(text) == x


RECORD = {
    "name": 'a "b"\\\tθ',
    "quoted": 'a "b"',
    "a": 1e-7,
    "b": None,
    "c": NumberText("1.50"),
    "u": {"x": "y"},
}


def test_a_record_in_json_and_csv(tmp_path: Path) -> None:
    path = tmp_path / "record"
    Output(str(path), "json").document(record_document(RECORD, dict))
    text = path.read_text(encoding="utf-8")
    assert '"a":1e-7,"b":null,"c":1.50' in text
    assert json.loads(text) == RECORD | {"c": 1.5}
    record = {x: RECORD[x] for x in "abc"}
    Output(str(path), "csv").document(record_document(record, dict))
    assert path.read_text() == "a,b,c\n1e-7,,1.50\n"


# tables and reports


def test_a_table_cuts_no_digit_however_narrow_the_terminal() -> None:
    groups = [*dict.fromkeys(x.group for name, x in shown_keys().items() if name != "remark")]
    for digits in (None, 50):
        record = solve(Top()).record(digits=digits)
        numbers = {str(x) for x in record.values() if x is not None}
        for width in (None, 200, 80, 40, 10):
            shown = table_of(record_page(record, shown_keys, width), width)
            assert numbers <= set(shown.split()), width
            assert width or [x for x in shown.splitlines() if x in groups] == groups
            assert width or digits or max(map(len, shown.splitlines())) <= 80


def test_rows_that_do_not_fit_a_terminal_stand_side_by_side() -> None:
    names, rows = [f"key{i}" for i in range(9)], [[f"1.{i}23456789" for i in range(9)]] * 2
    rows[1] = ["2.0", *[""] * 8]
    for width in (None, 140):
        assert [len(x.split()) for x in rows_text(names, rows, width).splitlines()[1:]] == [1, 9, 1]
    upright = rows_text(names, rows, 60).splitlines()
    assert [x.split() for x in upright[2:4]] == [
        ["key0", *(x[0] for x in rows)],
        ["key1", rows[0][1]],
    ]
    assert len(upright) == 2 + 9
    assert re.sub("\x1b[^m]*m", "", upright[0]).split() == ["key", "1", "2"]
    several = rows_text(names, rows * 9, 60).split("\n\n")  # upright tables that fit
    assert len(several) > 1
    assert all(len(table.splitlines()) == 2 + 9 for table in several)
    assert "key8" in rows_text(names, [], 60)


def test_a_cell_that_is_wrapped_moves_the_rows_below_it() -> None:
    for width in (7, 9):
        shown = drawn(Grid(["a", "b"], [["x y z", "1"], ["w", "2"]]), width).splitlines()[2:]
        rows = [["x", "y", "1"], ["z"], ["w", "2"]] if width == 7 else [["x", "y", "z", "1"]]
        assert [line.split() for line in shown][: len(rows)] == rows


def test_brackets_in_cells_are_no_markup_and_control_characters_are_escaped() -> None:
    shown = drawn(Grid(["[bold]x"], [["[red]y\x1b[31m\x9b\u202e"]]))
    assert shown.split() == ["[bold]x", "─" * 24, "[red]y\\x1b[31m\\x9b\\u202e"]


def test_a_report_in_every_format() -> None:
    fields = [Field("key", "key", is_text=True), Field("value", "value"), Field("hidden")]
    rows = [SimpleNamespace(key="x,y", value=1.5, hidden=math.inf)]
    report_ = Report({"samples": "3"}, fields, rows, ["Fine."], {"x": "kg"})
    report = report_.document()
    texts = {x: format_of(x).document(report, None) for x in ("csv", "ndjson", "json", "table")}
    assert texts["csv"] == b'key,value,hidden\n"x,y",1.5,inf\n'
    row = {"key": "x,y", "value": 1.5, "hidden": None}
    assert json.loads(texts["ndjson"]) == row
    whole = {"conditions": {"samples": "3"}, "rows": [row], "conclusions": ["Fine."]}
    assert json.loads(texts["json"]) == whole | {"units": {"x": "kg"}}
    shown = [line.split() for line in texts["table"].decode().splitlines() if line]
    assert shown == [["samples", "3"], ["key", "value"], ["─" * 10], ["x,y", "1.5"], ["Fine."]]


def test_results_are_tables_in_a_notebook() -> None:
    (table,) = tables_of(solve(Top(theta0_deg=0))._repr_markdown_())
    rows = {row[0]: row[1:] for row in table}
    assert rows["m"] == ["m", "mass", "1587.0", "mass", ""]
    assert rows["regime"][2] == "sleeping"
    assert "path" not in rows  # it is None
    (table,) = tables_of(text := Result()._repr_markdown_())
    assert table == [["Key", "Value"], ["m", "1.0"]]
    assert re.search(r"^\|[ -]+\|[ -]+: *\|$", text, re.MULTILINE)  # numbers stand at the right


class Result(HasRecord):
    verdict = "good"

    def record(self) -> dict[str, Any]:
        return {"m": 1.0, "remark": None}


# files


def test_a_file_is_replaced_only_on_success(tmp_path: Path) -> None:
    target, link = tmp_path / "out.csv", tmp_path / "link.csv"
    target.write_text("old")
    target.chmod(0o640)
    link.symlink_to(target)
    with suppress(KeyboardInterrupt), opened(str(link)) as stream:
        stream.write(b"half")
        raise KeyboardInterrupt
    assert (target.read_text(), sorted(tmp_path.iterdir())) == ("old", [link, target])
    with opened(str(link)) as stream:
        stream.write(b"new")
        assert target.read_text() == "old"
    assert (target.read_text(), link.is_symlink()) == ("new", True)
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert sorted(tmp_path.iterdir()) == [link, target]
    target.unlink()
    with opened(str(link)):
        pass
    (tmp_path / "usual").touch()
    assert target.stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_a_fifo_and_a_device_are_written_in_place(tmp_path: Path) -> None:
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    reader = os.open(fifo, os.O_RDONLY | os.O_NONBLOCK)
    write_x(str(fifo))
    assert os.read(reader, 9) == b"x"
    os.close(reader)
    write_x("/dev/null")
    assert stat.S_ISFIFO(fifo.stat().st_mode)
    with pytest.raises(CannotWriteError, match="No space left"):
        write_x("/dev/full")


# the terminal


def test_messages_are_one_printable_line() -> None:
    hostile = "a\x1b[31m\x9b\x7f\u202e\u200b\udcff\n b"
    assert terminal.one_line(hostile) == "a\\x1b[31m\\x9b\\x7f\\u202e\\u200b\\udcff b"
    long = terminal.one_line("x" * 50_000)
    assert terminal.MOST_CHARACTERS - 20 < len(long) <= terminal.MOST_CHARACTERS
    assert "characters ...]" in long


class Screen(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_only_standard_output_may_be_a_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    for stream, found in ((Screen(), [True, False]), (io.StringIO(), [False, False])):
        monkeypatch.setattr("sys.stdout", stream)
        assert [terminal.is_screen(path) for path in ("-", "a.csv")] == found


def test_progress_is_a_line_that_vanishes(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = Screen()
    monkeypatch.setattr("sys.stderr", screen)
    assert list(terminal.with_progress([1, 2], "rows")) == [1, 2]
    assert screen.getvalue() == ""  # because the work took less than a second
    monkeypatch.setattr(terminal, "DELAY", -1.0)
    parts: Any = terminal.with_progress([30, 10], "rows", size=int)
    assert next(parts) == 30
    assert next(parts) == 10
    assert screen.getvalue() == "\r\rrows: 75 %\r          \r"
    with pytest.raises(LagtopError):
        parts.throw(LagtopError("x"))
    assert list(terminal.with_progress(iter([5]), "rows")) == [5]
    assert screen.getvalue().endswith("\r\rrows: 1 done\r            \r")


def test_no_progress_unless_standard_error_is_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(terminal, "DELAY", -1.0)
    for stream in (io.StringIO(), None):  # None is a closed stream
        monkeypatch.setattr("sys.stderr", stream)
        assert list(terminal.with_progress([1, 2], "rows")) == [1, 2]
        assert not (stream and stream.getvalue())


@pytest.mark.parametrize("is_screen", [False, True])
@pytest.mark.parametrize("fmt", ["csv", "ndjson", "table"])
def test_data_do_not_control_a_terminal(
    fmt: str, is_screen: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    hostile = "\x1b]0;evil\x07"
    stdout = io.TextIOWrapper(io.BytesIO())
    monkeypatch.setattr("sys.stdout", stdout)
    monkeypatch.setattr("lagrange_cli.output.destination.is_screen", lambda _: is_screen)
    out = Output("-", fmt, is_named=True)
    out.blocks(["id", "r0"], [out.format.block([[hostile], [1.0]], ["id", "r0"])])
    text = stdout.buffer.getvalue().decode()
    assert (hostile in text) is (fmt == "csv" and not is_screen)
    assert "evil" in text


TABLE, UPRIGHT, CSV = "a [kg] text", "key 1", "a,text"


@pytest.mark.parametrize("is_named", [False, True])
@pytest.mark.parametrize(
    ("rows", "width", "first"),
    [
        (1000, 80, (TABLE, TABLE)),
        (1001, 80, (CSV, TABLE)),
        (50, 11, (UPRIGHT, UPRIGHT)),
        (51, 11, (CSV, UPRIGHT)),
    ],
)
def test_a_long_or_wide_table_on_a_terminal_is_csv(
    rows: int, width: int, first: list[str], is_named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("lagrange_cli.output.destination.width_of", lambda _: width)
    monkeypatch.setattr("sys.stdout", stdout := io.TextIOWrapper(io.BytesIO()))
    blocks = iter([[np.arange(9.0), ["x,y"] * 9], [np.arange(9.0, rows), ["z"] * (rows - 9)]])
    Output("-", "table", is_named).blocks(["a", "text"], blocks, ["a [kg]", "text"])
    shown = re.sub("\x1b[^m]*m", "", stdout.buffer.getvalue().decode())
    assert shown.split("\n")[0].split() == first[is_named].split()
    assert re.findall(r"\d+\.0(?=\D)", shown) == [f"{i}.0" for i in range(rows)]


def test_a_descriptor_is_written_to_and_its_file_is_kept(tmp_path: Path) -> None:
    """A name such as /dev/stdout leads to a file that other commands write to as well."""
    if not os.path.isdir("/dev/fd"):
        pytest.skip("no /dev/fd")
    path, link = tmp_path / "log", tmp_path / "link"
    with open(path, "a") as file:
        file.write("old\n")
        file.flush()
        link.symlink_to(f"/dev/fd/{file.fileno()}")
        for name in (f"/dev/fd/{file.fileno()}", f"/proc/self/fd/{file.fileno()}", str(link)):
            with opened(name) as stream:
                stream.write(b"new\n")
    assert path.read_text() == "old\nnew\nnew\nnew\n"
    assert sorted(tmp_path.iterdir()) == [link, path]


def test_texts_in_a_table_are_one_printable_line_each() -> None:
    texts = ["a\fb", "c\u2028d", "e\nf\x85", "x" * 200_000, '"\udcff']
    lines = text_of("table", ["text", "number"], [texts, np.arange(5.0)]).splitlines()
    assert len(lines) == 2 + len(texts)
    assert [line.split()[0] for line in lines[2:5]] == ["a\\x0cb", "c\\u2028d", "e\\nf\\x85"]
    assert "..." in lines[5]
    with pytest.raises(LagtopError, match="csv, json, ndjson or parquet for more than 10000 rows"):
        text_of("table", ["a"], *[[np.zeros(4000)]] * 3)


@pytest.mark.slow
def test_parquet_starts_no_thread(tmp_path: Path) -> None:
    """The threads of pyarrow now and then abort the process at its end."""
    if not os.path.isdir("/proc/self/task"):
        pytest.skip("no list of threads")
    code = f"""if True:
        import os
        import numpy as np
        import pyarrow.csv, pyarrow.parquet
        from lagrange_cli.recordings.reading import Reading, read_recording
        from lagrange_cli.output.destination import Output
        before = os.listdir("/proc/self/task")
        Output({str(tmp_path / "x")!r}, "parquet").rows(["t", "theta"], [np.ones((9, 2))] * 2)
        assert len(read_recording({str(tmp_path / "x")!r}, Reading()).t) == 18
        assert os.listdir("/proc/self/task") == before
    """
    subprocess.run([sys.executable, "-c", code], check=True)
