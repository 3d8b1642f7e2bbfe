"""Records, rows and reports as tables drawn by rich.  No digit is ever cut.

On a terminal a table that is too wide is folded: blocks of columns follow one below the other.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from textwrap import fill, wrap
from typing import TYPE_CHECKING, Any, NamedTuple

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table
from rich.text import Text

from .terminal import spelt

if TYPE_CHECKING:
    from .terminal import View

_GAP = 3
"""Width of the space between two columns of a table."""
_RECORD_WIDTH = 80
"""The width of the summary of a record if the output is not a terminal."""
_TEXT_WIDTH = 100
"""The width of running text if the output is not a terminal."""

_CODES = re.compile("\x1b\\[[0-9;]*m")
_HEADING, _GIVEN, _FOUND, _WARNING = "bold", "cyan", "green", "yellow"
"""Styles of headings, inputs, results and warnings on a terminal."""
INPUT_GROUP = "Inputs"
"""The group of a record that holds the inputs."""


class DrawnColumn(NamedTuple):
    """A column of a table: its heading, its cells, and whether they are numbers."""

    heading: str
    cells: Sequence[str]
    numeric: bool = True

    def width(self) -> int:
        """Return the width on the screen."""
        lines = (line for cell in (self.heading, *self.cells) for line in cell.split("\n"))
        return max(map(cell_len, lines))

    def flush_right(self) -> DrawnColumn:
        """Return the column, with heading and cells aligned to the right if it is numeric."""
        if not self.numeric:
            return self
        heading, *cells = _flush_right([self.heading, *self.cells])
        return self._replace(heading=heading, cells=cells)

    def cut_into_lines(self, width: int) -> DrawnColumn:
        """Return the column with every cell in lines of at most `width` characters."""
        cut = _chunks if self.numeric else wrap
        return self._replace(cells=["\n".join(cut(cell, width)) for cell in self.cells])


def drawn_record(
    record: Mapping[str, Any],
    headings: Sequence[str],
    groups: Mapping[str, list[list[str]]],
    view: View,
) -> bytes:
    """Return the summary of a record, its cells by group, a line per key, and its remark."""
    text = _drawn(_record(headings, groups), view)
    if view.width and _width(text) > view.width:
        text = _drawn(_narrow_record(groups, view.width), view)
    if summary := record.get("summary"):
        text = f"{fill(spelt(summary, view), view.width or _RECORD_WIDTH)}\n\n{text}"
    if remark := record.get("remark"):
        text += f"\n{_coloured(_filled(remark, view), view)}\n"
    return _encoded(text, view)


def _record(headings: Sequence[str], groups: Mapping[str, list[list[str]]]) -> Table:
    """Return five columns; a group is one row of many lines, as rich is slow for many cells."""
    texts = {
        group: ["\n".join(cells) for cells in zip(*lines, strict=True)]
        for group, lines in groups.items()
    }
    heading, *numbers = _flush_right([headings[2], *(columns[2] for columns in texts.values())])
    table = _empty([*headings[:2], heading, *headings[3:]])
    for (group, (symbols, names, _, *rest)), values in zip(texts.items(), numbers, strict=True):
        name_cell = Text.assemble((f"{group}\n", _HEADING), names)
        value_cell = Text(f"\n{values}", _style(group))
        table.add_row(f"\n{symbols}", name_cell, value_cell, *(f"\n{cells}" for cells in rest))
    return table


def _narrow_record(groups: Mapping[str, list[list[str]]], width: int) -> Table:
    """Return four columns, with each value on separate lines below its name."""
    every = [line for lines in groups.values() for line in lines]
    beside = [DrawnColumn("", [line[i] for line in every]).width() for i in (0, 3, 4)]
    room = max(width - sum(max(used, len("Equation")) for used in beside) - 3 * _GAP, 12)
    table = _empty(["Symbol", "Name, value", "Unit", "Equation"])
    for group, lines in groups.items():
        table.add_row("", Text(group, _HEADING), "", "")
        for symbol, name, value, unit, equation in lines:
            digits = "".join(f"\n{chunk}" for chunk in _chunks(value, room))
            table.add_row(symbol, Text.assemble(name, (digits, _style(group))), unit, equation)
    return table


def _style(group: str) -> str:
    """Return the style of the values of a group of a record."""
    return _GIVEN if group == INPUT_GROUP else _FOUND


def drawn_table(
    conditions: Mapping[str, str],
    keys: Sequence[DrawnColumn],
    columns: Sequence[DrawnColumn],
    conclusions: Sequence[str],
    view: View,
) -> bytes:
    """Return conditions as lines, a table whose blocks all begin with the keys, and conclusions."""
    heads = (_condition(name, text, view) for name, text in conditions.items())
    above = "".join(f"{spelt(head, view)}\n" for head in heads) + "\n" * bool(conditions)
    below = "".join(f"\n{_filled(line, view)}" for line in conclusions)
    below = f"{spelt(below, view)}\n" if below else ""
    return above.encode() + _encoded(_folded(keys, columns, view), view) + below.encode()


def _folded(keys: Sequence[DrawnColumn], columns: Sequence[DrawnColumn], view: View) -> str:
    """Return the table in blocks of columns that fit; each block begins with the keys."""
    blocks = _blocks(keys, columns, view.width) if view.width else [[*keys, *columns]]
    return "\n".join(_drawn(_filled_table(block), view) for block in blocks)


def _blocks(
    keys: Sequence[DrawnColumn], columns: Sequence[DrawnColumn], width: int
) -> Iterator[list[DrawnColumn]]:
    used = sum(column.width() + _GAP for column in keys)
    if any(used + column.width() > width for column in columns):  # keys too wide to repeat
        keys, columns, used = [], [*keys, *columns], 0
    block, room = list(keys), width - used
    for column in columns:
        fitting = column.cut_into_lines(width - used) if column.width() > width - used else column
        if len(block) > len(keys) and fitting.width() > room:
            yield block
            block, room = list(keys), width - used
        block.append(fitting)
        room -= fitting.width() + _GAP
    yield block


def _filled_table(columns: Sequence[DrawnColumn]) -> Table:
    columns = [column.flush_right() for column in columns]
    table = _empty([column.heading for column in columns])
    for row in zip(*(column.cells for column in columns), strict=True):
        table.add_row(*row)
    return table


def _empty(headings: Iterable[str]) -> Table:
    """Return a table without rows, for texts that are already aligned (rich takes longer)."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    for heading in headings:
        table.add_column(heading, overflow="ignore", no_wrap=True)
    return table


def _flush_right(texts: Sequence[str]) -> list[str]:
    """Return texts of one or more lines, with every line padded on its left."""
    lines = [text.split("\n") for text in texts]
    width = max(len(line) for text in lines for line in text)
    return ["\n".join(line.rjust(width) for line in text) for text in lines]


def _chunks(text: str, width: int) -> list[str]:
    """Return a text in pieces of at most `width` characters, at least one."""
    return [text[i : i + width] for i in range(0, len(text), width)] or [""]


def _width(text: str) -> int:
    """Return the width of a drawn text, without codes for styles."""
    return max(cell_len(line) for line in _CODES.sub("", text).splitlines())


def _filled(text: str, view: View) -> str:
    """Return running text in lines that fit."""
    return fill(text, view.width, break_on_hyphens=False) if view.width else text


def _condition(name: str, text: str, view: View) -> str:
    """Return a name with its text beside it, in lines that fit."""
    width = min(view.width or _TEXT_WIDTH, _TEXT_WIDTH)
    return fill(f"{name:11}{text}", width, subsequent_indent=" " * 11, break_on_hyphens=False)


def _coloured(text: str, view: View) -> str:
    """Return a warning in its colour, if the output has colours."""
    return _drawn(Text(text, _WARNING), view).rstrip("\n") if view.has_colours else text


def _drawn(table: Table | Text, view: View) -> str:
    """Return the text drawn by rich at its natural width, with styles only if they are shown."""
    file = io.StringIO()
    Console(
        file=file,
        color_system="standard" if view.has_colours else None,
        force_terminal=view.has_colours,
        no_color=False,
        width=10_000,
        highlight=False,
        markup=False,
        emoji=False,
    ).print(table, crop=False)
    lines = [line.rstrip() for line in file.getvalue().splitlines()]
    return "\n".join(lines).strip("\n") + "\n"


def _encoded(text: str, view: View) -> bytes:
    if view.has_greek:
        return text.encode()
    return text.replace("─", "-").encode("ascii", "replace")
