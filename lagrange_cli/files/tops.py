"""Many tops: the combinations of some values, or a file with a top in each row.

A file has a table with headings, or JSON objects.  A row that cannot be read becomes an error of
its own and does not affect other rows.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.text import shortened
from ..errors import DataError, LagtopError
from ..names import repeated
from ..top.given import Given, gather
from ..top.inputs import INPUTS, STEADY_WORDS, TILT, checked_double, one_of_each, overridden
from ..top.ranges import MOST_POINTS, Points
from ..top.units import conversion
from ..top.values import Value, tilt_key
from .headings import name_and_unit, plain_name
from .tables import table_in
from .text_tables import Table

_TIMES = {"t", "time", "timestamp"}
"""Names of a time, which a file of tops does not have."""


class Tops(NamedTuple):
    """The inputs of some tops, with the columns, lines and errors of each."""

    size: int
    inputs: Mapping[str, Any]
    """For each input an array of any type, or one value for all tops; None if a top lacks it."""
    carried: Sequence[Sequence[Any]] = ()
    """The extra columns, which are copied to the output."""
    places: Sequence[str] | None = None
    """The line or row of each top, if the tops come from a file."""
    errors: Mapping[int, str] = {}
    """Messages of the errors found so far, by row."""


class Product(NamedTuple):
    """Combinations of the values of several inputs; the last input varies fastest."""

    axes: Mapping[str, Points]
    """The values of each input, by its name."""
    first: int = 0
    """The number of the first combination."""
    stop: int | None = None
    """One more than the number of the last combination; None for all combinations."""

    @property
    def size(self) -> int:
        """The number of combinations.  Raises LagtopError for more than 1e9 of them."""
        stop = prod(x.count for x in self.axes.values()) if self.stop is None else self.stop
        if stop > MOST_POINTS:
            raise LagtopError(f"a sweep has at most 1e9 tops, this one would have {stop:.4g}")
        return stop - self.first

    def blocks(self, size: int) -> Iterator[Product]:
        """Yield all combinations, `size` at a time."""
        for first in range(0, self.size, size):
            yield Product(self.axes, first, min(first + size, self.size))

    def arrays(self, shared: Mapping[str, Any]) -> Tops:
        """Return the inputs of the combinations; `shared` holds those that do not vary."""
        counts = MOST_POINTS, *(x.count for x in self.axes.values())
        _, *places = np.unravel_index(np.arange(self.first, self.first + self.size), counts)
        found = {name: x.at(i) for (name, x), i in zip(self.axes.items(), places, strict=True)}
        return Tops(self.size, {**shared, **found})


class TopsFile(NamedTuple):
    """A file of tops, or a block of its rows, whose numbers have not been read yet."""

    columns: Sequence[str]
    """The keys of inputs, and the other headings as they are written."""
    carried: Sequence[str]
    """The extra columns, which are copied to the output, in their order."""
    units: Mapping[str, Value]
    """The number 1 in the unit of its heading, for each column of an input."""
    table: Table

    def shared(self, inputs: Mapping[str, Any], scene: str | None, *, units: bool = False) -> Given:
        """Return the inputs given in addition to the file; with `units`, all must have units.

        Raises DataError for a heading that lacks a unit, and the errors of `gather`.
        """
        try:
            return gather(inputs, scene, units=units, varying=self.columns, others=self.units)
        except LagtopError as error:
            if error.key in self.units and error.key not in inputs:
                raise DataError(f"{self.table.name}, heading {error.key}: {error}") from None
            raise

    @property
    def size(self) -> int:
        """The number of tops in a block."""
        return sum(1 for _ in self.table.rows)

    def blocks(self, size: int) -> Iterator[TopsFile]:
        """Yield the file in blocks of `size` rows, which any process can read."""
        return (self._replace(table=block) for block in self.table.blocks(size))

    def arrays(self, shared: Mapping[str, Any]) -> Tops:
        """Return the inputs of the tops; `shared` inputs are the defaults of rows without error."""
        found, carried, errors = list[dict[str, Any]](), list[list[Any]](), dict[int, str]()
        places = list[str]()
        for i, (number, row) in enumerate(self.table.rows):
            values, inputs = dict[str, Any](), dict[str, Any]()
            places.append(f"{self.table.place} {number}")
            try:
                cells = self.table.cells(row)
                values = dict(zip(self.columns, cells, strict=False))
                self.table.check(cells)
                named = [name for name in self.units if values.get(name) is not None]
                given = {name: self._double(name, values[name]) for name in named}
                one_of_each(given)
                inputs = overridden(shared, given)
            except LagtopError as error:
                errors[i] = str(error) if error.key else error.args[0]  # a heading is no option
            found.append(inputs)
            carried.append([values.get(name) for name in self.carried])
        names = {*shared, *(x for inputs in found for x in inputs)}
        arrays = {x: np.array([inputs.get(x) for inputs in found], object) for x in names}
        return Tops(len(places), arrays, [*zip(*carried, strict=True)], places, errors)

    def _double(self, name: str, cell: Any) -> Any:
        """Return the input in a cell, a double or a word for psidot0.  Raises LagtopError."""
        if name == "psidot0" and cell in STEADY_WORDS:
            return cell
        try:
            number = self.table.number(cell)
        except LagtopError as error:
            raise LagtopError(f"{name} {error.marked}") from None
        return checked_double(name, number * self.units[name].number)


def read_tops(path: str, computed: Collection[str], decimal: str = "") -> TopsFile:
    """Return a file of tops, or standard input for `-`.

    Columns named in `computed` are neither read nor copied.  `decimal` is a point or a comma, or
    empty if the file decides.  Raises DataError.
    """
    table = table_in(path, _known_inputs, decimal)
    name, headings = table.name, [" ".join(x.split()) for x in table.headings or ()]
    columns, units = list[str](), dict[str, Value]()
    for heading in headings:
        column, unit = _column_of(heading)
        if unit and column != TILT and column.startswith(TILT):
            raise DataError(f"{name}: the column {column} must be called {TILT} [{unit}]")
        if column in INPUTS or unit:  # a tilt needs its unit in the name or in the heading
            try:
                factor, unit = conversion(column, unit)
            except LagtopError as error:
                raise DataError(f"{name}, heading {shortened(heading)}: {error}") from None
            column = tilt_key(column, Value(factor, unit))
            units[column] = Value(factor, unit)
        columns.append(column)
    if not units and any(plain_name(x)[0] in _TIMES for x in headings):
        shown = shortened(", ".join(headings), 120)
        wrong = f"must hold tops, got a recording with the columns {shown}"
        raise DataError(f"{name} {wrong}: pass it to fit or compare")
    carried = [x for x in columns if x not in units and x not in computed]
    inputs = {_plain(known): known for known in reversed(INPUTS) if known not in units}
    if not any(x.startswith(TILT) for x in units):
        inputs |= dict.fromkeys(("theta", "tilt"), "theta0_deg")
        inputs["elevation"] = "theta0_deg, the tilt from the upward vertical"
    if not units.keys() & {"r0", "phidot0", "spin_period"}:
        inputs |= dict.fromkeys(("spin", "spinrate", "omega"), "r0 (total rate) or phidot0")
    inputs |= {"mass": "m"} if "m" not in units else {}
    for column in carried:
        if known := inputs.get(_plain(column)):
            raise DataError(f"{name}: the column {column} must be spelt {known}")
    if (twice := repeated(columns)) is not None:
        raise DataError(f"{name} must name each column once, got {twice!r} twice")
    if not units:
        wanted = f"must begin with a header that names inputs ({' '.join(INPUTS)})"
        raise DataError(f"{name} {wanted}, got {table.described}")
    return TopsFile(columns, carried, units, table)


def _column_of(heading: str) -> tuple[str, str]:
    """Return the name of a column and, for an input, its unit."""
    name, unit = name_and_unit(heading)
    return (name, unit) if name in {*INPUTS, TILT} else (heading, "")


def _known_inputs(headings: Sequence[str]) -> int:
    return sum(_column_of(x)[0] in {*INPUTS, TILT} for x in headings)


def _plain(column: str) -> str:
    """Return a name without easily mistaken parts: case, underscores, the 0 of theta0, the unit."""
    return plain_name(column)[0].replace("0", "") or column
