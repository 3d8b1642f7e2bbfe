"""A recording: the quantities of a motion in a file or in arrays, and how they are read."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.types import Array, Mask
from ..errors import LagtopError, arg
from ..names import check_names
from ..top.units import RADIANS
from .doubts import centre_above
from .observed import Observed, Quantities, framed, observe, quantities_of, rows_of
from .options import Alignment, Options, Reading
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
    time_size: float = 1.0
    """The size of the unit in the heading of the time, in seconds."""

    def record(self) -> dict[str, Any]:
        """Return what was read, by key of a document."""
        return {
            "columns": ", ".join(self.used) or None,
            "unused": ", ".join(self.unused) or None,
            "read": "; ".join(self.lines) or None,
        }


class Given(Options, total=False):
    """What `fit` and `compare` take in Python: arrays with a row for each time, and options."""

    quaternion: ArrayLike | None
    matrix: ArrayLike | None
    theta: ArrayLike | None
    phi: ArrayLike | None
    psi: ArrayLike | None
    euler: ArrayLike | None
    rotvec: ArrayLike | None
    axis: ArrayLike | None
    position: ArrayLike | None
    above: ArrayLike | None
    rates: ArrayLike | None
    angle_rates: ArrayLike | None


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

    def within(self) -> Recording:
        """Return the rows in the range of time of the reading.  Raises LagtopError for none."""
        first, last = self.reading.t_min, self.reading.t_max
        kept = np.flatnonzero(~((self.t < first) | (self.t > last)))
        if not kept.size:
            span = f"t goes from {self.t.min():g} to {self.t.max():g}"
            raise LagtopError(
                f"no row is between {arg('t_min')} and {arg('t_max')}: {span}", "t_min"
            )
        if kept.size == len(self.t):
            return self
        given = rows_of(self.given, kept)
        t = given["t"]
        return self._replace(given=given | {"t": t - t[0]}, begins=self.begins + float(t[0, 0]))

    def observed(self, rows: slice = slice(None)) -> Observed:
        """Return the motion of some rows, in the frames of lagtop and with its clock."""
        seen = framed(observe(rows_of(self.given, rows), self.reading), self.align)
        begins = -self.given["t"][0, 0] if self.align.time else self.begins
        return replace(seen, t=seen.t + begins)


def recording_of(t: ArrayLike | None, arguments: Mapping[str, Any]) -> Recording:
    """Return the recording in the arguments of `fit` or `compare` (see `Given`).

    The times `t` may be left out, or count frames, if `dt` or `fps` is given.  Raises LagtopError
    for arrays of a wrong shape, and for times that turn back.
    """
    options = {key: x for key, x in arguments.items() if key in Options.__annotations__}
    given = {key: x for key, x in arguments.items() if x is not None and key not in options}
    reading = Reading.of(units=RADIANS, **options)
    if not given:
        raise LagtopError("an attitude, an axis, angles or rates must be given by name, got none")
    check_names("arrays", [*given], [x for x in QUANTITIES if x != "t"])
    if t is None and reading.dt is None:
        raise LagtopError(f"t must be given, or {arg('dt')} or {arg('fps')}", "t")
    first = np.atleast_1d(np.asarray(next(iter(given.values())), object))
    rows = quantities_of(np.arange(float(len(first))) if t is None else t, given)
    if reading.dt is not None:
        rows["t"] = rows["t"] * reading.dt
    times, rows["missing"] = rows["t"][:, 0], np.zeros_like(rows["t"])
    steps = np.diff(times)
    if not times.size or not ((steps >= 0).all() or (steps <= 0).all()):
        raise LagtopError("t must hold at least one time, and must not turn back", "t")
    for key, x in given.items():
        if isinstance(x, np.ma.MaskedArray):
            rows["missing"] += np.ma.getmaskarray(x).reshape(rows[key].shape).any(1, keepdims=True)
    precess_about(rows)
    return Recording(rows, reading).within()


def precess_about(rows: dict[str, Array]) -> Array | None:
    """Put psi in the place of a marker seen from above, and return the point that it turns about.

    Return None, and leave the marker out, if there is no marker or something better.
    """
    marks = rows.pop("above", None)
    if marks is None or rows.keys() & {*QUANTITIES} - {"t", "rates", "angle_rates"}:
        return None
    centre = centre_above(rows["t"][:, 0], marks)
    x, y = (marks - centre).T
    rows["psi"] = np.arctan2(x, -y).reshape(-1, 1)
    return centre


def used_in(rows: Quantities, reading: Reading) -> set[str]:
    """Return the quantities that the motion depends on, whatever their numbers."""
    unit = [1.0, 0.0, 0.0, 0.0]  # repeated it is a quaternion, a vector, or the identity matrix
    first = {key: np.resize(unit, (1, x.shape[1])) for key, x in rows.items()}

    def motion(**changed: Array) -> str:
        return repr(observe(first | changed, reading))

    return {key for key, x in first.items() if motion(**{key: np.nan * x}) != motion()}
