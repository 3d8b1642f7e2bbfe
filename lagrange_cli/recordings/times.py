"""The times in a file, exactly: those of `table`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from ..errors import DataError, LagtopError
from ..files.tables import table_in
from ..files.text_tables import Table
from ..top.ranges import ListedPoints
from .quantities import in_known_unit, known_quantities, quantities_in


def read_times(path: str, decimal: str = "") -> ListedPoints:
    """Return the times in a file exactly, from its column `t` or its only column.

    `decimal` is as in `read_tops`.  Raises DataError, also for a row without a time.
    """
    table = table_in(path, known_quantities, decimal)
    names = ["t"] * (table.width < 2) if table.headings is None else table.headings
    found = quantities_in(names).get("t")
    if found is None:
        wanted = "the time must be a number below the heading t or time"
        raise DataError(f"{table.name}: {wanted}, got {table.described}")
    try:
        factor = in_known_unit("t", found, names).factor or Fraction(1)
    except LagtopError as error:
        raise DataError.at(table.name, error) from None
    times = ListedPoints(_Times(table, found.columns[0], factor))
    if not times.count:
        raise DataError(f"{table.name} must hold at least one time, got none")
    return times


@dataclass
class _Times:
    """The exact numbers in a column of a file, which are read again and again."""

    table: Table
    column: int
    factor: Fraction

    def __iter__(self) -> Iterator[Fraction]:
        for number, cell in self.table.column(self.column):
            try:
                yield self.factor * self.table.number(cell)
            except LagtopError as error:
                raise self.table.wrong(number, f"the time {error.marked}") from None
