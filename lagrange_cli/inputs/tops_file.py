"""Files of tops, one per row: a table with headings, or JSON objects.

Lines are split into blocks before they are parsed, so that any machine can process any block.  A
line that cannot be read becomes an error of its own row and does not affect other rows.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from fractions import Fraction
from io import BufferedIOBase
from itertools import chain, islice
from typing import Any, NamedTuple

from ..errors import DataError, LagtopError
from .files import decoded_file, shown_path
from .given import Given, gather
from .headings import check_header, check_spelling, column_of, heading_units
from .input_keys import TILT, checked_double, from_example, one_of_each, overridden
from .ranges import InputArrays
from .text_lines import UNDECIDED, Dialect, Numbered, decoded_row, json_object, shown_json
from .text_tables import TextTable, read_table
from .top import INPUTS
from .value import STEADY_WORDS, Value, steady_refused

LARGEST_BLOCK = 1 << 27
"""Most bytes of lines kept in memory at a time."""


class TopRow(NamedTuple):
    """One top: its line number, its extra columns, and its inputs or an error message."""

    line: int
    carried: Sequence[Any]
    inputs: Mapping[str, float]
    error: str | None = None

    def completed(self, shared: Mapping[str, float]) -> Mapping[str, float]:
        """Return the inputs; `shared` inputs are the defaults.

        If the row has an error, only the inputs that could be read are returned.
        """
        return self.inputs if self.error else overridden(shared, self.inputs)


class Lines(NamedTuple):
    """Consecutive rows of a file of tops, not parsed yet."""

    file: TopsFile
    texts: Sequence[Numbered]

    @property
    def size(self) -> int:
        """The number of tops."""
        return len(self.texts)

    def rows(self) -> Iterator[TopRow]:
        """Yield the tops."""
        return (self.file.row(*text) for text in self.texts)

    def arrays(self, shared: Mapping[str, float]) -> InputArrays:
        """Return the inputs of the tops; `shared` inputs are the defaults."""
        import numpy as np

        rows = list(self.rows())
        completed = [row.completed(shared) for row in rows]
        return InputArrays(
            len(rows),
            {name: np.array([x.get(name, math.nan) for x in completed]) for name in INPUTS},
            list(zip(*(row.carried for row in rows), strict=True)),
            [row.line for row in rows],
            {i: row.error for i, row in enumerate(rows) if row.error},
        )


class TopsFile(NamedTuple):
    """The format of a file, the same for all of its blocks."""

    name: str
    """The name of the file in messages."""
    columns: Sequence[str] | None
    """The header of a table; None for JSON lines."""
    carried: Sequence[str]
    """The extra columns, which are copied to the output, in their order."""
    computed: frozenset[str]
    """Names that are neither read nor copied."""
    named: Collection[str]
    """The inputs in the header, or in the first JSON object with any."""
    units: Mapping[str, Value] = {}
    """The value 1 in the unit of its heading, for each column of an input."""
    factors: Mapping[str, Fraction] = {}
    """The conversion factor of each column whose heading has a unit."""
    dialect: Dialect = UNDECIDED

    def among(
        self, inputs: Mapping[str, Any], scene: str | None, system: str | None
    ) -> tuple[Given, TopsFile]:
        """Return the inputs given in addition to the file, and its format in the same units.

        Raises DataError for a heading that lacks a unit, LagtopError for JSON lines if other inputs
        have units, and the errors of `gather`.
        """
        try:
            found = gather(inputs, scene, system=system, varying=self.named, others=self.units)
        except LagtopError as error:
            column = self.units.get(error.key or "")
            if column is not None and not column.unit:
                raise DataError(f"{self.name}, heading {error.key}: {error}") from None
            raise
        if self.columns is None and found.system is not None:
            raise LagtopError(
                f"{self.name}: JSON lines have no units: use CSV with headings such as m [g], or "
                "inputs without units"
            )
        keys = dict(zip(self.units, found.others, strict=True))
        factors = {keys[x]: found.others[keys[x]] for x in keys if self.units[x].unit}
        columns = None if self.columns is None else [keys.get(x, x) for x in self.columns]
        return found, self._replace(columns=columns, factors=factors)

    def row(self, number: int, raw: bytes) -> TopRow:
        """Return the top of a row, or its error message."""
        values: Mapping[str, Any] = {}
        inputs: dict[str, float] = {}
        error = None
        try:
            if self.columns is None:
                values = json_object(raw)
            else:
                cells = self.dialect.cells(decoded_row(raw))
                values = dict(zip(self.columns, cells, strict=False))
                if len(cells) != len(self.columns):
                    raise LagtopError(
                        f"a row must have {len(self.columns)} cells, got {len(cells)}"
                    )
            for name, value in values.items():
                if name in INPUTS:
                    inputs[name] = self._double(name, value)
                elif (
                    self.columns is None and name not in self.carried and name not in self.computed
                ):
                    raise LagtopError(f"the key {name!r} must be in one of the first rows too")
            one_of_each(inputs)
        except LagtopError as wrong:
            error = str(wrong)
        return TopRow(number, [values.get(name) for name in self.carried], inputs, error)

    def _double(self, name: str, value: Any) -> float:
        """Return the input in a cell or in an entry of a JSON object.  Raises LagtopError."""
        if self.columns is not None:
            return _double_in_text(name, value, self.dialect, self.factors.get(name))
        if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
            return float(value)
        if value in STEADY_WORDS:
            raise LagtopError(f"{name} {steady_refused(value)}")
        raise LagtopError(f"{name} must be a finite number, got {shown_json(value)}")


def _double_in_text(name: str, text: str, dialect: Dialect, factor: Fraction | None) -> float:
    bare = text.strip()
    try:
        value = float(dialect.with_point(text))
    except ValueError:
        value = math.nan
    if factor is None and value and math.isfinite(value) and text.isascii() and "_" not in text:
        return value
    if not bare:
        raise LagtopError(f"{name} must be a number, got an empty cell")
    if bare in STEADY_WORDS:
        raise LagtopError(f"{name} {steady_refused(bare)}")
    try:
        number = dialect.number(text)
    except LagtopError as error:
        raise LagtopError(f"{name} {error}") from None
    return checked_double(name, number if factor is None else number * factor)


def open_tops(
    path: str,
    computed: Collection[str],
    size: int,
    stream: BufferedIOBase | None = None,
    dialect: Dialect = UNDECIDED,
) -> tuple[TopsFile, Iterator[Lines], Callable[[], None]]:
    """Return the format of a file (standard input for `-`), its lines, and how to close it early.

    The lines come in blocks of `size`; the file is closed at their end.  Columns named in
    `computed` are neither read nor copied.  An open `stream` is read in place of the path.  Raises
    DataError for a file that cannot be read or has neither headings nor an object, and for a wrong
    unit in a heading.
    """
    name = shown_path(path)
    with ExitStack() as stack:
        file_of_tops = stack.enter_context(decoded_file(path, stream))
        table = read_table(file_of_tops, name, dialect, _known_inputs)
        rows = table.rows()
        if table.around is None:
            file = _of_headings(table, computed)
        else:
            first = list(_some(name, rows, size))
            rows = chain(first, rows)
            file = _of_objects(name, first, computed)
        kept = stack.pop_all()
        return file, _blocks(file, rows, size, kept), kept.close


def _of_headings(table: TextTable, computed: Collection[str]) -> TopsFile:
    """Return the format of a table.  Raises DataError for bad headings."""
    name, first = table.lines.name, table.first[0][1] if table.first else b""
    headings = [column_of(x) for x in table.headings or [first.decode(errors="replace").strip()]]
    columns = [column for column, _ in headings]
    known = {*INPUTS, *(x for x, unit in headings if unit)}
    carried = [x for x in columns if x not in known and x not in computed]
    named = set(columns) & set(INPUTS)
    check_spelling(carried, named, name)
    check_header(columns, known, name)
    units = heading_units(headings, known, name)
    dialect = table.decided(i for i, column in enumerate(columns) if column in known)
    return TopsFile(name, columns, carried, frozenset(computed), named, units, dialect=dialect)


def _of_objects(name: str, first: Iterable[Numbered], computed: Collection[str]) -> TopsFile:
    """Return the format of JSON objects, whose keys are taken from the first ones.

    Its inputs are those of the first object with an incomplete body, or else of the last object.
    """
    objects = [*_objects(first)]
    incomplete = (x for x in objects if from_example(dict.fromkeys(x)))
    named = {*next(incomplete, objects[-1] if objects else ())} & {*INPUTS}
    keys = dict.fromkeys(chain.from_iterable(objects))
    carried = [x for x in keys if x not in INPUTS and x not in computed]
    check_spelling(carried, named, name)
    return TopsFile(name, None, carried, frozenset(computed), named)


def _objects(rows: Iterable[Numbered]) -> Iterator[dict[str, Any]]:
    for _, raw in rows:
        with suppress(LagtopError):  # which the row will name
            yield json_object(raw)


def _known_inputs(names: Sequence[str]) -> int:
    """Return the number of inputs that some headings name."""
    return sum(column_of(name)[0] in {*INPUTS, TILT} for name in names)


def _blocks(
    file: TopsFile, rows: Iterator[Numbered], size: int, opened: ExitStack
) -> Iterator[Lines]:
    with opened:
        while block := list(_some(file.name, rows, size)):
            yield Lines(file, block)


def _some(name: str, rows: Iterable[Numbered], size: int) -> Iterator[Numbered]:
    """Yield the next rows.  Raises DataError if together they are too long to keep."""
    left = LARGEST_BLOCK
    for number, raw in islice(rows, size):
        left -= len(raw)
        if left < 0:
            wrong = f"{size} lines must have at most {LARGEST_BLOCK} bytes together"
            raise DataError(f"{name}, line {number}: {wrong}")
        yield number, raw
