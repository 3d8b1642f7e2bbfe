"""Recordings of tops: measured tilt, spin and precession, with their uncertainties."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arithmetic.text import quoted
from ..arithmetic.types import Array, Mask
from ..errors import DataError, LagtopError
from ..inputs import rotations
from ..inputs.input_keys import checked_double
from ..inputs.names import ANGLES
from ..inputs.scene_file import scene_in
from ..inputs.seen import Conventions, Named, Quantities, angles_in, quantities_of, rows_of, see
from ..inputs.text_lines import UNDECIDED, Dialect
from ..inputs.top import Top
from ..inputs.trajectory import Clock, Trajectory, open_trajectory
from ..inputs.trajectory_columns import plain_name

CHANNELS = {
    "angles": ANGLES,
    "axis": ("theta", "across"),
    "attitude": ("theta", "across", "along"),
}
"""Channels that are compared, by kind of recording.  Angles have their own columns.  The direction
of the axis is compared along the meridian and across it, and the attitude also about the axis.
"""
LEAST_ROWS = 12
_LEAST_NUMBERS = 4
"""Least number of rows of a recording, and of numbers of each of its angles."""
_SHORTEST, _LONGEST = 1e-60, 1e60
_BEYOND = 0.2
"""Largest tilt beyond a pole that counts as noise, in radians."""


@dataclass(frozen=True)
class Recording:
    """The measured motion of one top; missing numbers are NaN."""

    name: str
    """The word of these rows in the `--by` column, or empty."""
    t: Array
    """Times since the first row, in ascending order."""
    t_start: float
    """The time of the first row."""
    kind: str
    """A key of CHANNELS."""
    angles: Mapping[str, Array]
    """The known angles among theta, phi and psi, in radians, up to whole turns."""
    sigma: Mapping[str, Array]
    """Standard deviations in radians by channel; empty if they are not given."""
    is_mirrored: bool = False
    """Whether psi is counted in the direction opposite to that of the data."""
    scene: Top | None = None
    """The top that the file describes, if any."""

    @property
    def channels(self) -> list[str]:
        """The channels that are compared with a motion."""
        return [x for x in CHANNELS[self.kind] if x in self.angles or self.kind != "angles"]

    @property
    def known(self) -> Mask:
        """Whether a number is present, shape (channels, times)."""
        is_whole = self.kind != "angles"  # an axis or an attitude is complete, or missing
        names = ["theta" if is_whole else name for name in self.channels]
        return np.stack([np.isfinite(self.angles[name]) for name in names])

    @property
    def mirrored(self) -> Recording:
        """The recording with psi counted in the other direction."""
        angles = {name: -x if name == "psi" else x for name, x in self.angles.items()}
        return replace(self, angles=angles, is_mirrored=not self.is_mirrored)

    def part(self, rows: NDArray[np.intp], name: str = "") -> Recording:
        """Return some rows, in this order, with times since the first of them."""
        t = self.t[rows]
        return replace(
            self,
            name=name,
            t=t - t[0],
            t_start=self.t_start + float(t[0]),
            angles=rows_of(self.angles, rows),
            sigma=rows_of(self.sigma, rows),
        )


class Reading(NamedTuple):
    """Options of reading a file of recordings."""

    columns: Sequence[str] | None = None
    conventions: Conventions = Conventions()
    by: str | None = None
    """A column whose words separate recordings."""
    sigma: Mapping[str, float] | float | None = None
    """Standard deviations in radians: one for all channels, or by channel."""
    dialect: Dialect = UNDECIDED


def read_recordings(path: str, reading: Reading) -> list[Recording]:
    """Return the recordings of a file, in the order in which they begin.

    Raises LagtopError for a file that cannot be read, DataError for one that holds no recording.
    """
    with open_trajectory(path, reading.columns, reading.dialect) as trajectory:
        spread = _add_spreads(trajectory)
        found = {}
        for name, given in _parts(trajectory, reading.by).items():
            where = f"{trajectory.name}{f', {reading.by} {name}' if name else ''}"
            found[name] = _recording_of(where, given, reading, trajectory.quantities, spread)
        scene = scene_in(trajectory.description, trajectory.name)
    return [replace(one, name=name, scene=scene) for name, one in found.items()]


def _add_spreads(trajectory: Trajectory) -> Mapping[str, str | None]:
    """Read the columns NAME_std too; return the units in their names, by NAME."""
    units: dict[str, str | None] = {}
    for name in trajectory.names:
        base = name.lower().replace("_std", "")
        word, unit = plain_name(base)
        if base != name.lower() and word in (*ANGLES, "axis", "quaternion", "attitude"):
            units[word] = trajectory.add_angle(f"{word}_std", name, unit)
    return units


def _parts(trajectory: Trajectory, by: str | None) -> dict[str, dict[str, Array]]:
    """Return the rows of each word of a column, or all rows under an empty name.

    Raises LagtopError if the column is missing, DataError for a file without rows.
    """
    if by is not None and by not in trajectory.names:
        shown = ", ".join(trajectory.names)[:100]
        raise LagtopError(f"by must name a column of {trajectory.name} ({shown}), got {by!r}", "by")
    word_of = None if by is None else trajectory.add_words("by", by)
    parts = defaultdict[float, list[Quantities]](list)
    clocks = defaultdict[float, Clock](lambda: Clock(trajectory, repeats=True))
    for block, places in trajectory.rows():
        labels = block.get("by", np.zeros((len(places), 1)))[:, 0]
        for label in dict.fromkeys(labels.tolist()):
            rows = np.flatnonzero(labels == label)
            clocks[label].advance(block["t"][rows, 0], [places[row] for row in rows.tolist()])
            parts[label].append(rows_of(block, rows))
    if not parts:
        raise DataError(f"{trajectory.name} must have {LEAST_ROWS} rows or more, got 0")
    return {
        word_of(label) if word_of else "": {
            key: np.concatenate([block[key] for block in blocks]) for key in blocks[0]
        }
        for label, blocks in parts.items()
    }


def _recording_of(
    where: str,
    given: Quantities,
    reading: Reading,
    named: Named = MappingProxyType({}),
    spread: Mapping[str, str | None] = MappingProxyType({}),
) -> Recording:
    """Return the recording in some columns, from its first row on, in the order of time.

    `spread` has the units of the columns NAME_std.  Rows and angles without a number are left out.
    Raises LagtopError, DataError for a bad recording.
    """
    t = given["t"][:, 0]
    kind, measured = _angles(given, reading.conventions, named)
    raw = Recording("", t, 0.0, kind, measured, {})
    sigma = _sigma(raw, given, reading, spread)
    if t.size < LEAST_ROWS:
        raise DataError(f"{where} must have {LEAST_ROWS} rows or more, got {t.size}")
    angles = _cleaned(measured, where)
    if angles.keys() == {"phi"}:
        raise DataError(f"{where} must have theta or psi too: phi alone does not determine a top")
    known = np.any([np.zeros(t.size), *map(np.isfinite, angles.values())], axis=0)
    order = np.flatnonzero(known)[np.argsort(t[known], kind="stable")]
    if order.size < LEAST_ROWS:
        raise DataError(
            f"{where} must have {LEAST_ROWS} rows or more with a number, got {order.size}"
        )
    tilts = angles.get("theta", np.zeros(1))
    if (wrong := tilts[np.abs(tilts - np.pi / 2) > np.pi / 2 + _BEYOND]).size:
        raise DataError(
            f"{where}: theta must be between 0 and pi rad (180 deg), got {wrong[0]:.6g} rad"
        )
    first, last = t[order[[0, -1]]].tolist()
    if not last > first:
        raise DataError(f"{where}: t must increase, got {first:g} in all rows")
    if not _SHORTEST < last - first < _LONGEST:
        raise DataError(f"{where}: t must span {_SHORTEST:g} to {_LONGEST:g}, got {last - first:g}")
    for channel, values in sigma.items():
        if not np.all((values > 0) | np.isnan(values)):
            raise DataError(f"{where}: {channel}_std must be > 0, got {np.nanmin(values):g}")
    return replace(raw, angles=angles, sigma=sigma).part(order)


def _cleaned(angles: Mapping[str, Array], where: str) -> dict[str, Array]:
    """Return the angles that have numbers, within half a turn; infinities become NaN.

    Raises DataError for an angle with too few numbers.
    """
    found = {}
    for name, values in angles.items():
        known = np.isfinite(values)
        if 0 < known.sum() < _LEAST_NUMBERS:
            raise DataError(
                f"{where}: {name} must have {_LEAST_NUMBERS} numbers or more, got {known.sum()}"
            )
        if known.any():
            kept = np.where(known, values, np.nan)
            found[name] = kept if name == "theta" else rotations.within_half_turn(kept)
    return found


def _angles(
    given: Quantities, conventions: Conventions, named: Named
) -> tuple[str, dict[str, Array]]:
    """Return the kind of a recording, a key of CHANNELS, and the angles known from it."""
    alone = angles_in(given, conventions, named)
    if alone and not {"quaternion", "matrix", "euler", "rotvec"} & given.keys():
        return "angles", alone
    seen = see(given, conventions, named)
    if seen.quaternion is not None:
        return "attitude", rotations.angles_of(seen.quaternion)
    if seen.axis is not None:
        return "axis", rotations.angles_of_axis(seen.axis)
    return "angles", {}


def _sigma(
    raw: Recording, given: Quantities, reading: Reading, spread: Mapping[str, str | None]
) -> dict[str, Array]:
    """Return the standard deviation of each channel, from columns or else from the options.

    Raises LagtopError for an unknown channel, or if only some channels have one.
    """
    sigma = reading.sigma
    each = sigma if isinstance(sigma, Mapping) else dict.fromkeys(raw.channels, sigma)
    if unknown := [name for name in each if name not in raw.channels]:
        raise LagtopError(
            f"sigma must be for {', '.join(raw.channels)}, got {quoted(unknown[0])}", "sigma"
        )
    found = {
        name: np.full(raw.t.size, checked_double("sigma", x))
        for name, x in each.items()
        if x is not None
    }
    for channel in raw.channels:
        names = [channel] if raw.kind == "angles" else ["attitude", "quaternion", "axis"]
        column = next((name for name in names if name in spread), None)
        if column is not None:
            unit = spread[column]
            radians = reading.conventions.radians if unit is None else unit == "rad"
            values = given[f"{column}_std"][:, 0]
            found[channel] = values if radians else np.radians(values)
    if found and (missing := [x for x in raw.channels if x not in found]):
        raise LagtopError(
            f"sigma must be given for all angles or for none, got none for {missing[0]}", "sigma"
        )
    return found


def recording_from(
    t: ArrayLike,
    *,
    sigma: Mapping[str, float] | float | None = None,
    **angles: ArrayLike | None,
) -> Recording:
    """Return the recording in the arguments of `fit`.  Raises LagtopError, DataError."""
    given = {name: x for name, x in angles.items() if x is not None}
    if len(given) != max(sum(name in ANGLES for name in given), 1):
        shown = ", ".join(given) or "nothing"
        raise LagtopError(f"fit takes angles, or an axis, or a quaternion, got {shown}")
    rows = quantities_of(t, given)
    times = rows["t"][:, 0]
    if not np.isfinite(times).all():
        raise LagtopError("t must be finite numbers", "t")
    if (back := np.flatnonzero(np.diff(times) < 0)).size:
        before, after = times[back[0] : back[0] + 2].tolist()
        raise LagtopError(f"t must not turn back, got {after} after {before}", "t")
    reading = Reading(conventions=Conventions("wxyz", radians=True), sigma=sigma)
    return _recording_of("the recording", rows, reading)
