"""A recording: the quantities of a motion in a file or in arrays, and how they are read."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.types import Array, Mask
from ..errors import LagtopError
from ..names import check_names
from .observed import Observed, Quantities, framed, observe, quantities_of, rows_of
from .options import Alignment, Reading
from .quantities import QUANTITIES


class Source(NamedTuple):
    """Where a recording comes from, and what its columns were read as."""

    file: str | None = None
    used: Sequence[str] = ()
    """The columns of the file that are used."""
    unused: Sequence[str] = ()
    """Its other columns, except those that `columns` leaves out."""
    lines: Sequence[str] = ()
    """What was read, a line for each quantity."""
    time_unit: str = "units of the recording"
    """The unit of time for labels."""


class Recording(NamedTuple):
    """A recording as it is given, and how it is read."""

    given: Quantities
    """Arrays of quantities, with all angles in radians.

    The array `missing` is 1 in rows with empty cells, which count as far as they have numbers.
    """
    reading: Reading
    begins: float = 0.0
    """The time of the first row, if the times are counted from there."""
    source: Source = Source()

    @property
    def t(self) -> Array:
        """The times of all rows."""
        return self.given["t"][:, 0] + self.begins

    @property
    def missing(self) -> Mask:
        """Whether a row has empty cells."""
        return self.given["missing"][:, 0] > 0

    @property
    def align(self) -> Alignment:
        """The alignment under which it is read."""
        return self.reading.align

    def read_as(self, **options: Any) -> Recording:
        """Return the recording under other options."""
        return self._replace(reading=self.reading._replace(**options))

    def changed(self, changes: Mapping[str, Callable[[Array], Array]]) -> Recording:
        """Return the recording with some quantities changed."""
        given = {x: changes.get(x, np.asarray)(y) for x, y in self.given.items()}
        return self._replace(given=given)

    def timed(self, factor: float = 1.0, shift: float = 0.0) -> Recording:
        """Return the recording with another unit of time, or an earlier clock."""
        found = self.changed({"t": lambda t: t * factor})
        return found._replace(begins=self.begins * factor - shift)

    def few(self, most: int) -> Recording:
        """Return at most `most` rows, evenly spread."""
        every = -(-len(self.given["t"]) // most)
        return self._replace(given=rows_of(self.given, slice(None, None, every)))

    def observed(self, rows: slice = slice(None)) -> Observed:
        """Return the motion of some rows, in the frames of lagtop and with its clock."""
        seen = framed(observe(rows_of(self.given, rows), self.reading), self.align)
        begins = -self.given["t"][0, 0] if self.align.time else self.begins
        return replace(seen, t=seen.t + begins)


def recording_of(
    t: ArrayLike, arrays: Mapping[str, ArrayLike | None], reading: Reading
) -> Recording:
    """Return the recording in the arguments of `fit` or `compare`, with angles in radians.

    Raises LagtopError for arrays of a wrong shape, and for times that turn back.
    """
    given = {key: x for key, x in arrays.items() if x is not None}
    if not given:
        raise LagtopError("an attitude, an axis, angles or rates must be given, got none")
    check_names("arrays", [*given], [x for x in QUANTITIES if x != "t"])
    rows = quantities_of(t, given)
    times, rows["missing"] = rows["t"][:, 0], np.zeros_like(rows["t"])
    steps = np.diff(times)
    if not times.size or not ((steps >= 0).all() or (steps <= 0).all()):
        raise LagtopError("t must have times that increase, or decrease, from row to row", "t")
    for key, x in given.items():
        if isinstance(x, np.ma.MaskedArray):
            rows["missing"] += np.ma.getmaskarray(x).reshape(rows[key].shape).any(1, keepdims=True)
    return Recording(rows, reading)


def used_in(rows: Quantities, reading: Reading) -> set[str]:
    """Return the quantities that the motion depends on, whatever their numbers."""
    unit = [1.0, 0.0, 0.0, 0.0]  # repeated it is a quaternion, a vector, or the identity matrix
    first = {key: np.resize(unit, (1, x.shape[1])) for key, x in rows.items()}

    def motion(**changed: Array) -> str:
        return repr(observe(first | changed, reading))

    return {key for key, x in first.items() if motion(**{key: np.nan * x}) != motion()}
