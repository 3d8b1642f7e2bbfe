"""Trajectories and times from files or from standard input, held in memory as whole columns.

The first bytes of a file determine its format, not its name: Parquet, npy, npz, or else text.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from io import BytesIO
from typing import TYPE_CHECKING, Any

from ..arithmetic.points import ListedPoints
from ..arithmetic.text import quoted, shortened
from ..errors import DataError, LagtopError, UnavailableError
from .files import LARGEST_FILE, read_bytes, shown_path
from .names import repeated
from .text_tables import Table, parts, read_table
from .trajectory_columns import (
    QUANTITIES,
    FoundQuantity,
    expanded,
    in_known_unit,
    known_quantities,
    named_twice,
    plain_name,
    quantities_in,
)

if TYPE_CHECKING:
    from ..arithmetic.types import Array

_MAGIC = {b"PAR1": "Parquet", b"\x93NUM": "npy", b"PK\x03\x04": "npz", b"PK\x05\x06": "npz"}


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
            remedy = "name the columns with --columns, and one of them _"
            raise DataError(f"{self.name} {wrong}: {remedy}")
        try:
            self.quantities = {key: self._in_known_unit(key, x) for key, x in found.items()}
        except LagtopError as error:
            raise DataError(f"{self.name}: {error}") from None

    def _in_known_unit(self, key: str, quantity: FoundQuantity) -> FoundQuantity:
        """Return a quantity with the factor that converts it, to s, rad/s, rad or degrees."""
        named = [self.names[i] for i in quantity.columns]
        if len({plain_name(part)[1] for part in named}) > 1:
            shown = " and ".join(map(repr, named[:2]))
            raise LagtopError(f"the parts of {key} must have one unit, got {shown}")
        unit, factor = in_known_unit(key, quantity.unit)
        return quantity._replace(unit=unit, factor=factor)

    def values(self) -> dict[str, Array]:
        """Return every quantity as an array of shape (rows, parts), with NaN for missing numbers.

        Raises DataError for a cell that is not a number.
        """
        wanted = [i for found in self.quantities.values() for i in found.columns]
        numbers = self.table.numbers(wanted, self.names)
        return {
            key: found.scaled(numbers[:, [wanted.index(i) for i in found.columns]])
            for key, found in self.quantities.items()
        }

    def words(self, column: str) -> list[str]:
        """Return the cells of a column as texts; numbers have their shortest form."""
        cells = self.table.column(self.names.index(column))
        return [f"{x:.17g}" if isinstance(x, float) else str(x) for x in cells]

    def check_times(
        self, t: Array, rows: Sequence[int] | None = None, *, repeats: bool = False
    ) -> None:
        """Raise DataError for a time that is not finite, or that turns back.

        A repeated time is an error too, unless `repeats` is true.  `rows` are the indices of the
        times among all rows (default: all).
        """
        import numpy as np

        before, after = t[:-1], t[1:]
        ways = (after > before) * 1.0 - (after < before)  # a difference may be beyond all doubles
        moving = ways[ways != 0]
        back = ways * (moving[0] if moving.size else 0.0) < 0
        for wrong, wanted in (
            (~np.isfinite(t), "t must be a finite number, got {1}"),
            (np.r_[False, back], "t must not turn back, got {1} after {0}"),
            (np.r_[False, (ways == 0) & (not repeats)], "t must not repeat, got {1} twice"),
        ):
            if (found := np.flatnonzero(wrong)).size:
                i = int(found[0])
                place = self.table.where(i if rows is None else rows[i])
                raise DataError(f"{place}: {wanted.format(float(t[i - 1]), float(t[i]))}")


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
    if kind := _MAGIC.get(content[:4]):
        return Trajectory(_read_arrays(content, name, kind), names)
    table = read_table(content, name, known_quantities, decimal, len(names or ()) or None)
    if table.headings is None and not table.width:
        raise DataError(f"{name} must hold a trajectory, got no row")
    return Trajectory(table, names)


def _read_arrays(content: bytes, name: str, kind: str) -> Table:
    """Return the columns of real numbers that are as long as the column of times, no pickles."""
    import numpy as np

    try:
        found = (_parquet if kind == "Parquet" else _numpy)(content)
    except ImportError:
        remedy = "pip install 'lagtop[parquet]'"
        raise UnavailableError(f"{name}: Parquet needs pyarrow: {remedy}") from None
    except Exception as error:  # no library lists its exceptions
        why = shortened(" ".join(str(error).split()), 100) or type(error).__name__
        article = "a" if kind == "Parquet" else "an"
        raise DataError(f"{name}: not {article} {kind} file: {why}") from None
    real = {x: y for x, y in found.items() if y.dtype.kind in "iuf" and y.ndim in {1, 2}}
    time = next((x for x in real if "t" in quantities_in([x])), next(iter(real), None))
    if time is None:
        shown = shortened(", ".join(f"{x} {y.dtype} {y.shape}".strip() for x, y in found.items()))
        raise DataError(f"{name} must have real numbers in 1 or 2 dimensions, got {shown or None}")
    tables = {x: y.reshape(len(y), -1).T for x, y in real.items() if len(y) == len(real[time])}
    names = [
        part for x, y in tables.items() for part in parts(x, len(y) if real[x].ndim > 1 else 0)
    ]
    if (twice := repeated(names)) is not None:
        raise DataError(f"{name} must name each column once, got {quoted(twice)} twice")
    rows = np.concatenate([*tables.values()]).T.astype(np.float64)
    headings = None if [*tables] == [""] else names
    return Table(name, headings, len(names), rows, range(1, len(rows) + 1), place="row")


def _numpy(content: bytes) -> Mapping[str, Any]:
    """Return the arrays of an npz file, the fields of an npy file, or its array without a name."""
    import numpy as np

    if content.startswith(b"PK"):
        from zipfile import ZipFile

        _check_size(sum(x.file_size for x in ZipFile(BytesIO(content)).infolist()))
        with np.load(BytesIO(content), allow_pickle=False) as archive:
            return dict(archive)
    array = np.load(BytesIO(content), allow_pickle=False)
    return {x: array[x] for x in array.dtype.names} if array.dtype.names else {"": array}


def _parquet(content: bytes) -> Mapping[str, Any]:
    """Return the numeric columns, and lists of a fixed size as matrices; null becomes NaN."""
    import numpy as np
    from pyarrow import parquet, types

    file = parquet.ParquetFile(BytesIO(content))
    _check_size(8 * file.metadata.num_rows * file.metadata.num_columns)
    table = file.read()
    if (twice := repeated(table.column_names)) is not None:
        raise ValueError(f"the column {twice!r} comes twice")
    found: dict[str, Any] = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        size = getattr(column.type, "list_size", 0)
        kind = column.type.value_type if size else column.type
        if types.is_floating(kind) or types.is_integer(kind):
            rows = column.to_pylist()
            cells = [x or [None] * size for x in rows] if size else column.to_numpy()
            found[name] = np.array(cells, np.float64)
    return found


def _check_size(size: int) -> None:
    if size > LARGEST_FILE:
        raise ValueError(f"it must have at most {LARGEST_FILE} bytes of numbers, has {size}")


def read_times(path: str, decimal: str = "") -> ListedPoints:
    """Return the times in a file exactly, from its column `t` or its only column.

    `decimal` is a point or a comma, or empty if the file decides.  Raises DataError for a file that
    cannot be read, and for a row without a time.
    """
    table = read_table(read_bytes(path), shown_path(path), known_quantities, decimal)
    if table.headings is None and table.width > 1:
        wanted = f"{table.width} columns must have headings, t among them"
        raise DataError(f"{table.where(0)}: {wanted}, got none")
    names = ["t"] if table.headings is None else table.headings
    found = quantities_in(names)
    if "t" not in found:
        shown = shortened(", ".join(map(repr, names)))
        wanted = "the time must be a number below the heading t or time"
        raise DataError(f"{table.name}: {wanted}, got {shown}")
    column = found["t"].columns[0]
    try:
        _, factor = in_known_unit("t", found["t"].unit)
    except LagtopError as error:
        raise DataError(f"{table.name}: {error}") from None
    table.decide([column])
    times = []
    for row, cell in enumerate(table.column(column)):
        try:
            times.append((factor or 1) * table.number(cell))
        except LagtopError as error:
            raise DataError(f"{table.where(row)}: the time {error}") from None
    if not times:
        raise DataError(f"{table.name} must hold at least one time, got none")
    return ListedPoints(times)
