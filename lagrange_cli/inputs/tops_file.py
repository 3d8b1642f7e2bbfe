"""Files of tops, one per row: a table with headings, or JSON objects.

Rows are split into blocks before their numbers are read, so that any process can do that.  A row
that cannot be read becomes an error of its own and does not affect other rows.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from ..arithmetic.text import quoted
from ..errors import DataError, LagtopError
from .files import read_bytes, shown_path
from .given import Given, gather
from .headings import name_and_unit
from .input_keys import TILT, checked_double, one_of_each, overridden
from .names import repeated
from .text_tables import Table, read_table, split_row
from .top import INPUTS
from .values import STEADY_WORDS, InputArrays, Value, steady_refused


class TopRow(NamedTuple):
    """One top: its line number, its extra columns, and its inputs or an error message."""

    line: int
    carried: Sequence[Any]
    inputs: Mapping[str, float]
    error: str | None = None


class Lines(NamedTuple):
    """Consecutive rows of a file of tops, whose numbers have not been read yet."""

    file: TopsFile
    texts: Sequence[tuple[int, Any]]
    """The line of each row, and its text or the values of its JSON object."""

    @property
    def size(self) -> int:
        """The number of tops."""
        return len(self.texts)

    def rows(self) -> list[TopRow]:
        """Return the tops."""
        return [self.file.row(*text) for text in self.texts]

    def arrays(self, shared: Mapping[str, float]) -> InputArrays:
        """Return the inputs of the tops; `shared` inputs are the defaults of rows without error."""
        import numpy as np

        rows = self.rows()
        inputs = [row.inputs if row.error else overridden(shared, row.inputs) for row in rows]
        return InputArrays(
            len(rows),
            {name: np.array([x.get(name, math.nan) for x in inputs]) for name in INPUTS},
            list(zip(*(row.carried for row in rows), strict=True)),
            [row.line for row in rows],
            {i: row.error for i, row in enumerate(rows) if row.error},
        )


class TopsFile(NamedTuple):
    """The format of a file, the same for all of its blocks."""

    columns: Sequence[str]
    """The keys of inputs, and the other headings as they are written."""
    carried: Sequence[str]
    """The extra columns, which are copied to the output, in their order."""
    units: Mapping[str, Value]
    """The value 1 in the unit of its heading, for each column of an input."""
    form: Table
    """The table without its rows."""
    factors: Mapping[str, Fraction] = {}
    """The conversion factor of each column whose heading has a unit."""

    def among(self, inputs: Mapping[str, Any], scene: str | None) -> tuple[Given, TopsFile]:
        """Return the inputs given in addition to the file, and its format in the same units.

        Raises DataError for a heading that lacks a unit, and the errors of `gather`.
        """
        try:
            found = gather(inputs, scene, varying=self.units.keys(), others=self.units)
        except LagtopError as error:
            if error.key in self.units and error.key not in inputs:
                raise DataError(f"{self.form.name}, heading {error.key}: {error}") from None
            raise
        keys = dict(zip(self.units, found.others, strict=True))
        factors = {keys[x]: found.others[keys[x]] for x in keys if self.units[x].unit}
        return found, self._replace(columns=[keys.get(x, x) for x in self.columns], factors=factors)

    def row(self, line: int, raw: Any) -> TopRow:
        """Return the top of a row, or its error message."""
        values: Mapping[str, Any] = {}
        inputs: dict[str, float] = {}
        error = None
        try:
            cells = split_row(raw, self.form.delimiter) if isinstance(raw, str) else raw
            values = dict(zip(self.columns, cells, strict=False))
            if len(cells) != len(self.columns):
                raise LagtopError(f"a row must have {len(self.columns)} cells, got {len(cells)}")
            for name in INPUTS:
                if values.get(name) is not None:
                    inputs[name] = self._double(name, values[name])
            one_of_each(inputs)
        except LagtopError as wrong:
            error = str(wrong)
        return TopRow(line, [values.get(name) for name in self.carried], inputs, error)

    def _double(self, name: str, cell: Any) -> float:
        """Return the input in a cell.  Raises LagtopError."""
        if cell in STEADY_WORDS:
            raise LagtopError(f"{name} {steady_refused(cell)}")
        try:
            number = self.form.number(cell)
        except LagtopError as error:
            if isinstance(cell, str) and re.search(r"\d\s*(\(\d|±|\+/?-)", cell):
                wrong = f"must have no uncertainty, got {quoted(cell)}: loop over solve"
                raise LagtopError(f"{name} {wrong}") from None
            raise LagtopError(f"{name} {error}") from None
        return checked_double(name, number * self.factors.get(name, 1))


def read_tops(
    path: str, computed: Collection[str], size: int, decimal: str = ""
) -> tuple[TopsFile, Iterator[Lines]]:
    """Return the format of a file (standard input for `-`), and its rows in blocks of `size`.

    Columns named in `computed` are neither read nor copied.  `decimal` is a point or a comma, or
    empty if the file decides.  Raises DataError for a file that cannot be read, or that has no
    headings of inputs.
    """
    table = read_table(read_bytes(path), shown_path(path), _known_inputs, decimal)
    file = _format(table, computed)
    rows = list(zip(table.lines, table.texts, strict=True))
    return file, (Lines(file, rows[i : i + size]) for i in range(0, len(rows), size))


def _format(table: Table, computed: Collection[str]) -> TopsFile:
    """Return the format of a table.  Raises DataError for bad headings."""
    name, headings = table.name, table.headings or []
    found = [_column_of(x) for x in headings]
    columns = [column for column, _ in found]
    # A tilt needs its unit in the name or in the heading.
    units = {x: Value(Fraction(1), y) for x, y in found if x in INPUTS or (x == TILT and y)}
    carried = [x for x in columns if x not in units and x not in computed]
    _check_spelling(carried, units.keys(), name)
    if (twice := repeated(columns)) is not None:
        raise DataError(f"{name} must name each column once, got {twice!r} twice")
    if not units:
        wanted = f"must begin with a header that names inputs ({' '.join(INPUTS)})"
        raise DataError(f"{name} {wanted}, got {quoted(','.join(headings))}")
    for column, one in units.items():
        if one.unit and column.startswith(f"{TILT}_"):
            raise DataError(f"{name}: the column {column} must be called {TILT} [{one.unit}]")
        if one.unit:
            from .units import factor_of  # for few files only

            try:
                factor_of(column, one.unit)
            except LagtopError as error:
                raise DataError(f"{name}, heading {column} [{one.unit}]: {error}") from None
    table.decide(i for i, x in enumerate(columns) if x in units)
    # Blocks of rows go to other processes, without the rest of the file.
    form = Table(name, headings, (), (), table.delimiter)
    form.decimal = table.decimal
    return TopsFile(columns, carried, units, form)


def _column_of(heading: str) -> tuple[str, str]:
    """Return the name of a column and, for an input, its unit."""
    name, unit = name_and_unit(heading)
    return (name, unit) if name in {*INPUTS, TILT} else (heading, "")


def _known_inputs(headings: Sequence[str]) -> int:
    """Return the number of inputs that some headings name."""
    return sum(_column_of(x)[0] in {*INPUTS, TILT} for x in headings)


def _check_spelling(carried: Sequence[str], named: Collection[str], name: str) -> None:
    """Raise DataError for an unread column that looks like an input missing from `named`."""
    inputs = {_plain(known): known for known in reversed(INPUTS) if known not in named}
    if not any(x.startswith(TILT) for x in named):
        inputs |= dict.fromkeys(("theta", "tilt", "elevation"), "theta0_deg")
    for column in carried:
        if known := inputs.get(_plain(column)):
            raise DataError(f"{name}: the column {column} must be spelt {known}")


def _plain(column: str) -> str:
    """Return a name without easily mistaken parts: case, underscores, the 0 of theta0, the unit."""
    return re.sub("_|0|deg$|rad$", "", name_and_unit(column)[0].lower()) or column
