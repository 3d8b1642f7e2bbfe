"""Trajectories and times from files or from standard input, held in memory as whole columns.

The first bytes of a file determine its format, not its name: Parquet, or else text.
"""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import shortened
from ..errors import DataError, LagtopError, UnavailableError
from ..file_bytes import LARGEST_FILE, read_bytes, shown_path
from ..names import repeated
from ..top.ranges import ListedPoints
from .columns import (
    QUANTITIES,
    converted,
    expanded,
    in_known_unit,
    known_quantities,
    named_twice,
    quantities_in,
)
from .text_tables import Table, parts, read_table

if TYPE_CHECKING:
    from ..arithmetic.types import Array
    from .observed import Conventions

_PARQUET = b"PAR1"


class Trajectory:
    """The columns of a file: times and quantities of a motion, and other columns."""

    def __init__(self, table: Table, columns: Sequence[str] | None = None) -> None:
        """Find the quantities; `columns` names all columns from the left.

        Raises DataError without a time or a quantity besides, LagtopError for wrong `columns`.
        """
        self.name, self.table = table.name, table
        if columns is not None and len(columns) != table.width:
            wanted = f"all {table.width} columns of {table.name} (_ leaves one out)"
            wrong = f"columns must name {wanted}, got {len(columns)} names"
            raise LagtopError(wrong, "columns")
        names = table.headings if columns is None else columns
        if names is None:
            remedy = f"name its {table.width} columns with --columns, such as t,quaternion"
            raise DataError(f"{table.name} has no header: {remedy}")
        self.names = list(names)
        found = quantities_in(self.names)
        if "t" not in found or len(found) < 2:
            wanted = f"the time ({QUANTITIES['t'].shown}) and {', '.join([*QUANTITIES][1:])}"
            shown = shortened(", ".join(map(repr, self.names)), 120)
            lacks_z = {"x", "y"} <= {*self.names} and "z" not in self.names
            remedy = "z is missing" if lacks_z else "name them with --columns"
            wrong = f"must have columns among {wanted}, got {shown}: {remedy}"
            raise DataError(f"{self.name} {wrong}")
        if twice := named_twice(self.names, found):
            wrong = f"must name each quantity once, got {twice[0]!r} and {twice[1]!r}"
            if columns is not None:
                raise LagtopError(f"columns {wrong}", "columns")
            remedy = "name the columns with --columns, and one of them _"
            raise DataError(f"{self.name} {wrong}: {remedy}")
        try:
            self.quantities = {key: in_known_unit(key, x, self.names) for key, x in found.items()}
        except LagtopError as error:
            raise DataError(f"{self.name}: {error}") from None

    def values(self, *, radians: bool) -> dict[str, Array]:
        """Return every quantity as an array of shape (rows, parts), with NaN for missing numbers.

        Angles are returned in radians; those without a unit are in degrees, or else in `radians`.
        Raises DataError for a cell that is not a number.
        """
        wanted = [i for found in self.quantities.values() for i in found.columns]
        numbers = self.table.numbers(wanted, self.names)
        values: dict[str, Array] = {}
        for key, found in self.quantities.items():
            columns = numbers[:, [wanted.index(i) for i in found.columns]]
            values[key] = converted(key, found, columns, radians=radians)
        return values

    def conventions(self, given: Conventions) -> Conventions:
        """Return conventions, overridden by the names of columns; the frame `space` is kept."""
        found = {x: self.quantities[x].says for x in given._fields if x in self.quantities}
        if given.rates == "space":
            found.pop("rates", None)
        implied: dict[str, Any] = {key: says for key, says in found.items() if says}
        return given._replace(**implied)

    def words(self, column: str) -> list[str]:
        """Return the cells of a column as texts; numbers have their shortest form."""
        cells = self.table.column(self.names.index(column))
        return [f"{x:.17g}" if isinstance(x, float) else str(x) for x in cells]

    def check_times(self, t: Array) -> None:
        """Raise DataError for a time that is not finite, that repeats, or that turns back."""
        import numpy as np

        with np.errstate(all="ignore"):
            ways = np.sign(np.diff(t))
        for wrong, wanted in (
            (~np.isfinite(t), "be a finite number, got {1}"),
            (np.r_[False, ways == 0], "not repeat, got {1} twice"),
            (np.r_[False, ways != ways[:1]], "not turn back, got {1} after {0}"),
        ):
            for i in np.flatnonzero(wrong)[:1]:
                must = wanted.format(float(t[i - 1]), float(t[i]))
                raise DataError(f"{self.table.where(i)}: t must {must}")


def read_trajectory(
    path: str, columns: Sequence[str] | None = None, decimal: str = ""
) -> Trajectory:
    """Return the trajectory in a file, or in standard input for `-`.

    `columns` names all columns from the left and overrides the names in the file.  `decimal` is a
    point or a comma, or empty if the file decides.  Raises DataError for a file that cannot be read
    or holds no trajectory.
    """
    names, name = None if columns is None else expanded(columns), shown_path(path)
    content = read_bytes(path)
    if content.startswith(_PARQUET):
        return Trajectory(_read_parquet(content, name), names)
    table = read_table(content, name, known_quantities, decimal, len(names or ()) or None)
    if table.headings is None and not table.width:
        raise DataError(f"{name} must hold a trajectory, got no row")
    return Trajectory(table, names)


def _read_parquet(content: bytes, name: str) -> Table:
    """Return the columns of numbers of a Parquet file; a list of a fixed size is several columns.

    Null becomes NaN.
    """
    import numpy as np

    try:
        from pyarrow import parquet
    except ImportError:
        remedy = "pip install 'lagtop[parquet]'"
        raise UnavailableError(f"{name}: Parquet needs pyarrow: {remedy}") from None
    try:
        file = parquet.ParquetFile(BytesIO(content))
        _check_size(file)
        table = file.read()
        if twice := repeated(table.column_names):
            raise ValueError(f"two columns are named {twice!r}")
        columns: dict[str, Array] = {}
        for heading, column in zip(table.column_names, table.columns, strict=True):
            size = getattr(column.type, "list_size", 0)
            rows = [x or [None] * size for x in column.to_pylist()] if size else column.to_numpy()
            numbers: Array = np.array(rows, np.float64) if size else np.asarray(rows)
            if numbers.dtype.kind in "iuf":
                headings = parts(heading, size)
                columns |= dict(zip(headings, np.atleast_2d(numbers.T), strict=True))
    except Exception as error:  # no library lists its exceptions
        why = shortened(" ".join(str(error).split()), 100) or type(error).__name__
        raise DataError(f"{name}: bad Parquet file: {why}") from None
    values = np.array([*columns.values()], np.float64).T
    lines = range(1, len(values) + 1)
    return Table(name, [*columns], len(columns), values, lines, place="row")


def _check_size(file: Any) -> None:
    """Raise ValueError for a Parquet file that needs too much memory, before it is read."""
    groups = [file.metadata.row_group(i) for i in range(file.metadata.num_row_groups)]
    listed = sum(getattr(x.type, "list_size", 1) for x in file.schema_arrow)
    size = max(sum(x.total_byte_size for x in groups), 8 * file.metadata.num_rows * listed)
    if size > LARGEST_FILE:
        raise ValueError(f"it must have at most {LARGEST_FILE} bytes of numbers, has {size}")


def read_times(path: str, decimal: str = "") -> ListedPoints:
    """Return the times in a file exactly, from its column `t` or its only column.

    `decimal` is a point or a comma, or empty if the file decides.  Raises DataError for a file that
    cannot be read, and for a row without a time.
    """
    table = read_table(read_bytes(path), shown_path(path), known_quantities, decimal)
    names = ["t"] * (table.width < 2) if table.headings is None else table.headings
    found = quantities_in(names).get("t")
    if found is None:
        shown = shortened(", ".join(map(repr, names))) or f"{table.width} columns without headings"
        wanted = "the time must be a number below the heading t or time"
        raise DataError(f"{table.name}: {wanted}, got {shown}")
    try:
        factor = in_known_unit("t", found, names).factor or 1
    except LagtopError as error:
        raise DataError(f"{table.name}: {error}") from None
    times = []
    for row, cell in enumerate(table.column(found.columns[0])):
        try:
            times.append(factor * table.number(cell))
        except LagtopError as error:
            raise DataError(f"{table.where(row)}: the time {error}") from None
    if not times:
        raise DataError(f"{table.name} must hold at least one time, got none")
    return ListedPoints(times)
