"""Markdown: a parser of CommonMark and tables reads back the cells that other formats hold."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import Lagtop, dicts, tables_of
from hypothesis import given, settings
from hypothesis import strategies as st
from markdown_it import MarkdownIt

from lagrange_cli.output.document import Grid
from lagrange_cli.output.formats.markdown import FORMAT
from lagrange_cli.output.terminal import printable

TEXTS = st.text() | st.text("ab1 _*`~<>[]()!:/.-+#=|\\&;$^'\"@{}")


@settings(max_examples=15)
@given(st.lists(st.lists(TEXTS, min_size=2, max_size=2), min_size=1, max_size=4))
def test_any_text_in_a_cell_is_read_back(rows: list[list[str]]) -> None:
    (found,) = tables_of(FORMAT.page([Grid(["a", "b"], rows)], None))
    assert found[1:] == [[printable(" ".join(x.split())) for x in row] for row in rows]


@given(TEXTS)
def test_any_text_is_one_paragraph(text: str) -> None:
    shown = printable(" ".join(text.split()))
    tokens = MarkdownIt("commonmark").enable("table").parse(FORMAT.page([text], None))
    assert [x.type for x in tokens] == ["paragraph_open", "inline", "paragraph_close"][
        : 3 * bool(shown)
    ]
    assert "".join(x.content for y in tokens for x in y.children or []) == shown


ROWS = (
    "table --t-max 1 --n 5 --columns t,axis,energy",
    "sweep --r0 1,-2,50 --theta0 10,180",
    "find --r0 10:200 T_precession=2 --keys r0,regime",
    "jacobi --k 0.8 --u 0:4K:5 --functions sn,cn,theta",
    "eta --delta 0.5 --delta-star -0.5 --p 3 --q 1 --tau 0:9:5",
    "scenes",
    "explain",
)
SHOWN = (
    "solve",
    "solve --certify",
    "solve --derivation",
    "explain T_nutation mean_precession_rate looping-top",
    "solve --r0 '50(1)' --budget T_nutation",
    "jacobi --k 0.8",
    "eta --delta 0.5 --delta-star -0.5 --p 3 --q 1",
    "fit rec.csv",
    "compare rec.csv",
    "bench --methods lagtop --n 3 --spans 1",
)


@pytest.mark.parametrize("line", ROWS)
def test_the_cells_are_those_of_csv(line: str, lagtop: Lagtop) -> None:
    words = line.split()
    (table,) = tables_of(lagtop(*words, "--format", "markdown").stdout)
    rows = [list(row.values()) for row in dicts(lagtop(*words, "--format", "csv").stdout)]
    assert table[1:] == [[" ".join(x.split()) for x in row[: len(table[0])]] for row in rows]


@pytest.mark.parametrize("line", SHOWN)
def test_the_cells_are_those_of_a_drawn_table(
    line: str, lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    lagtop("table", "--t-max", "1", "--n", "60", "-o", "rec.csv")
    words = line.replace("'", "").split()
    tables = tables_of(lagtop(*words, "--format", "markdown").stdout)
    drawn = lagtop(*words, "--format", "table").stdout
    cells = [" ".join(x) for table in tables for x in table]
    assert tables
    if not line.startswith("bench"):  # which measures times
        lines = [" ".join(x.split()) for x in drawn.splitlines()]
        assert {" ".join(x.split()) for x in cells} <= {*lines}
