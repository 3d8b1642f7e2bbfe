"""Trajectories and times from files or from standard input, held in memory as whole columns.

The first bytes of a file determine its format, not its name: Parquet, npy, npz, or else text.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
        raise DataError(f"{name}: bad {kind} file: {why}") from None
    real = {x: y for x, y in found.items() if y.dtype.kind in "iuf" and y.ndim in {1, 2}}
    time = next((x for x in real if "t" in quantities_in([x])), next(iter(real), None))
    if time is None:
        shown = shortened(", ".join(f"{x} {y.dtype} {y.shape}".strip() for x, y in found.items()))
        raise DataError(f"{name} must have real numbers in 1 or 2 dimensions, got {shown or None}")
    columns: dict[str, Array] = {}
    for x, y in real.items():
        if len(y) == len(real[time]):
            columns |= dict(
                zip(parts(x, y.shape[1] if y.ndim > 1 else 0), np.atleast_2d(y.T), strict=True)
            )
    rows = np.array([*columns.values()], np.float64).T
    headings = None if "" in found else [*columns]
    return Table(name, headings, len(columns), rows, range(1, len(rows) + 1), place="row")


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
    """Return the columns, and lists of a fixed size as matrices; null becomes NaN."""
    import numpy as np
    from pyarrow import parquet

    file = parquet.ParquetFile(BytesIO(content))
    _check_size(8 * file.metadata.num_rows * file.metadata.num_columns)
    found: dict[str, Any] = {}
    table = file.read()
    if twice := repeated(table.column_names):
        raise ValueError(f"two columns are named {twice!r}")
    for name, column in zip(table.column_names, table.columns, strict=True):
        size = getattr(column.type, "list_size", 0)
        rows = [x or [None] * size for x in column.to_pylist()] if size else column.to_numpy()
        found[name] = np.array(rows, np.float64) if size else rows
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
