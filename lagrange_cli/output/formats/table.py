"""Tables drawn by rich, on a terminal or as text."""

from __future__ import annotations

from collections.abc import Iterable
from io import StringIO
from itertools import groupby
from textwrap import fill
from typing import Any

from ..document import Grid, Lines, Page
from ..terminal import printable
from .base import ForPeople


class Table(ForPeople):
    """Paragraphs, and tables without vertical lines between empty lines."""

    def page(self, page: Page, width: int | None) -> str:
        """Return texts, lines and tables."""
        found: list[str] = []
        for are_texts, parts in groupby(page, lambda part: isinstance(part, str)):
            shown = [_part(part, width) for part in parts]
            found += ["\n".join(shown)] if are_texts else shown
        return "\n\n".join(found) + "\n"


def _part(part: str | Grid | Lines, width: int | None) -> str:
    if isinstance(part, str):
        return "\n".join(_filled(line, width) for line in part.split("\n"))
    if isinstance(part, Grid):
        return "\n\n".join(drawn(x, width).rstrip("\n") for x in _fitting(part, width))
    wrap = (width or 100) if part.hanging else None
    return "\n".join(_filled(line, wrap, part.hanging) for line in part.lines)


def _filled(text: str, width: int | None, indent: int = 0) -> str:
    """Return running text, in lines that fit if there is a width."""
    hanging = " " * indent
    return (
        fill(printable(text), width, subsequent_indent=hanging, break_on_hyphens=False)
        if width
        else printable(text)
    )


def _fitting(grid: Grid, width: int | None) -> list[Grid]:
    """Return rows as one table, or upright, a line per column, if they are too wide.

    Upright tables follow each other, each with as many rows as fit.
    """
    if not (width and grid.may_stand and grid.rows) or fits(grid, width):
        return [grid]
    columns = [*zip(grid.headings, *grid.rows, strict=True)]
    shown = [i for i in range(len(columns)) if any(columns[i][1:])]
    names = ["key", *(grid.headings[i] for i in shown)]
    found: list[list[list[str]]] = []
    room = 0
    for number, row in enumerate(grid.rows, 1):
        cells = [str(number), *(row[i] for i in shown)]
        room -= _width(cells)
        if room < 0:
            found.append([names])
            room = width - _width(names) + 2 - _width(cells)
        found[-1].append(cells)
    tables = [[*zip(*lines, strict=True)] for lines in found]
    return [Grid(first, rest, range(1, len(first))) for first, *rest in tables]


def fits(grid: Grid, width: int) -> bool:
    """Return whether a table fits a terminal without wrapped cells."""
    columns = zip(grid.headings, *grid.rows, strict=True)
    return sum(map(_width, columns)) - 2 <= width


def _width(cells: Iterable[str]) -> int:
    """Return the width of a column, with the space to the next one."""
    from rich.cells import cell_len

    return max(map(cell_len, cells)) + 2


def drawn(grid: Grid, width: int | None = None) -> str:
    """Return a table drawn by rich.

    On a terminal of a `width`, texts are wrapped and headings are bold.  No digit is ever cut.
    """
    from rich import box
    from rich.console import Console
    from rich.measure import Measurement
    from rich.table import Table as RichTable
    from rich.text import Text

    table = RichTable(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    for i, heading in enumerate(grid.headings):
        justify: Any = "right" if i in grid.numbers else "left"
        table.add_column(Text(printable(heading)), justify=justify, no_wrap=i in grid.numbers)
    empty = [Text()] * (len(grid.headings) - 1)
    texts = [
        [Text(printable(row[0]), "bold"), *empty]
        if len(row) == 1 < len(grid.headings)
        else [Text(printable(x)) for x in row]
        for row in grid.rows
    ]
    columns = list(zip(*texts, strict=True))
    spaces = 3 * (len(grid.headings) - 1)
    if sum(max(x.cell_len for x in column) for column in columns) + spaces <= (width or 10**6):
        texts = [[Text("\n").join(column) for column in columns]]  # rich is slow for many cells
    for row in texts:
        table.add_row(*row)
    console = Console(file=StringIO(), width=10**6, force_terminal=width is not None)
    least = Measurement.get(console, console.options, table).minimum
    console.width = max(width or 10**6, least)
    with console.capture() as captured:
        console.print(table, crop=False)
    return "".join(f"{line.rstrip()}\n" for line in captured.get().splitlines())


FORMAT = Table()
