"""Measured angles, a measured axis or a measured attitude over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic import rotations
from ..arithmetic.rotations import within_half_turn
from ..arithmetic.types import Array, Mask
from ..errors import DataError, LagtopError, Message, marked
from ..file_bytes import shown_path
from ..names import ANGLES
from ..recordings.clocks import frames_of
from ..recordings.doubts import check_position
from ..recordings.observed import Observed, rows_of
from ..recordings.recording import Recording
from ..top.inputs import checked_double

CHANNELS = {
    "angles": ANGLES,
    "axis": ("theta", "across"),
    "attitude": ("theta", "across", "along"),
}
"""Residuals by kind of recording: of the axis along the meridian and across it, of an attitude also
about the axis."""
ANGLE_OF = {"theta": "theta", "psi": "psi", "phi": "phi", "across": "psi", "along": "phi"}
"""The angle that shows the noise of a channel."""
LEAST_ROWS = 12
_LEAST_NUMBERS = 4
"""Numbers of an angle at least."""
_BEYOND = 0.2
"""Largest tilt beyond a pole that counts as noise, in radians."""
_UNEVEN = 0.05
"""Mean deviation of times from whole frames from which rows are not evenly spaced."""


def are_whole(frames: Array) -> bool:
    """Return whether times in units of a frame are whole numbers, except for jitter."""
    return bool(np.mean(np.abs(frames - np.round(frames))) < _UNEVEN)


@dataclass(frozen=True)
class Measured:
    """The measured motion of one top; missing numbers are NaN."""

    name: str
    """The number of a window, or empty."""
    source: Recording
    """The recording that holds it."""
    t: Array
    """Times since the first row, in ascending order."""
    t_start: float
    kind: str
    """A key of CHANNELS."""
    angles: Mapping[str, Array]
    """The known angles among theta, phi and psi in radians, up to whole turns."""
    sigma: Mapping[str, float]
    """Standard deviations in radians by channel; empty if they are not given."""
    position: Array | None = None
    """The marker in space, shape (n, 3), if the axis is known from its position."""
    is_mirrored: bool = False
    """Whether psi was counted in the other direction."""

    @property
    def time_unit(self) -> str:
        """The unit of time for labels."""
        return self.source.source.time_unit

    @property
    def channels(self) -> list[str]:
        """The channels that are compared with a motion."""
        return [x for x in CHANNELS[self.kind] if x in self.angles or self.kind != "angles"]

    @property
    def spin_channel(self) -> str:
        """The channel of the spin, if it is recorded."""
        return "along" if self.kind == "attitude" else "phi"

    @property
    def present(self) -> Mask:
        """Whether a number is present, shape (channels, times)."""
        known = {name: np.isfinite(x) for name, x in self.angles.items()}
        whole = np.all([*known.values()], axis=0)
        return np.stack([known[x] if self.kind == "angles" else whole for x in self.channels])

    @property
    def has_numbers(self) -> bool:
        """Whether each angle has numbers enough, as those of a part may not."""
        return all(np.isfinite(x).sum() >= _LEAST_NUMBERS for x in self.angles.values())

    @property
    def frame(self) -> float:
        """The usual time between two rows: the mean of even ones, which are rounded in a file."""
        steps = np.diff(self.t)
        usual = float(np.median(steps[steps > 0]))
        even = float(np.polyfit(frames_of(self.t, usual), self.t, 1)[0])
        return even if are_whole(self.t / even) else usual

    @property
    def middle(self) -> float:
        """The time of the middle."""
        return self.t_start + float(self.t[-1]) / 2

    def named(self, text: str) -> str:
        """Return a text on this recording, after its name if it has one."""
        return Message(f"{self.name}: {marked(text)}") if self.name else text

    @property
    def mirrored(self) -> Measured:
        """The recording with psi counted in the other direction."""
        angles = {name: -x if name == "psi" else x for name, x in self.angles.items()}
        return replace(self, angles=angles, is_mirrored=not self.is_mirrored)

    @property
    def is_even(self) -> bool:
        """Whether the rows are whole frames apart, so that whole turns per frame are invisible."""
        return are_whole(self.t / self.frame)

    @property
    def exchanged(self) -> Measured:
        """The recording with phi and psi exchanged, as most books name them."""
        names = {"theta": "theta", "phi": "psi", "psi": "phi"}
        angles = {names[x]: y for x, y in self.angles.items()}
        sigma = {names[x]: y for x, y in self.sigma.items()}
        return replace(self, angles=angles, sigma=sigma)

    def residuals(self, theta: Array, phi: Array, psi: Array) -> Array:
        """Return recording minus motion in radians, shape (..., channels, times).

        The angles of one motion have the shape (times,), those of many (tops, times).
        """
        motion = {"theta": theta, "phi": phi, "psi": psi}
        off = {x: within_half_turn(seen - motion[x]) for x, seen in self.angles.items()}
        if self.kind == "angles":
            return np.stack([off[name] for name in self.channels], axis=-2)
        sine, cosine = np.sin(self.angles["theta"]), np.cos(self.angles["theta"])
        along_meridian = sine * np.cos(theta) * np.cos(off["psi"])
        found = [along_meridian - cosine * np.sin(theta), sine * np.sin(off["psi"])]
        if self.kind == "attitude":
            found.append(within_half_turn(self.angles["phi"] - phi + off["psi"] * np.cos(theta)))
        return np.stack(found, axis=-2)

    def thinned(self, count: int) -> Measured:
        """Return at most `count` rows, evenly from the first to the last."""
        if count >= self.t.size:
            return self
        return self.rows(np.linspace(0, self.t.size - 1, count).astype(int))

    def rows(self, rows: Any) -> Measured:
        """Return some rows, in this order, with the same zero of time."""
        position = None if self.position is None else self.position[rows]
        angles = rows_of(self.angles, rows)
        return replace(self, t=self.t[rows], angles=angles, position=position)

    def part(self, rows: Any, name: str = "") -> Measured:
        """Return some rows, in this order, with times since the first of them."""
        found = self.rows(rows)
        start = float(found.t[0])
        return replace(found, name=name, t=found.t - start, t_start=self.t_start + start)

    def windows(self, count: int) -> list[Measured]:
        """Return the recording in equal windows of time.  Raises LagtopError for a bad count."""
        if count < 2:
            raise LagtopError(f"window must be at least 2, got {count}", "window")
        number = np.minimum((self.t / self.t[-1] * count).astype(int), count - 1)
        rows = [np.flatnonzero(number == i) for i in range(min(count, self.t.size))]
        seen = [np.isfinite(y) for y in self.angles.values()]
        least = min(int(y[x].sum()) for x in rows for y in seen)
        if count > self.t.size or least < LEAST_ROWS:
            least = 0 if count > self.t.size else least
            wrong = f"window must leave {LEAST_ROWS} rows or more in each window, got {least}"
            raise LagtopError(f"{wrong}: use fewer windows", "window")
        return [self.part(x, f"window {i}") for i, x in enumerate(rows, 1)]


def measured(recording: Recording, sigma: Mapping[str, float] | float | None = None) -> Measured:
    """Return the measured motion in a recording, without rows that have no number.

    `sigma` are standard deviations in the unit of angles of the recording: one for all channels, or
    by channel.  Raises LagtopError, DataError for a bad recording.
    """
    seen, file = recording.observed(), recording.source.file
    where = "the recording" if file is None else shown_path(file)
    t = recording.given["t"][:, 0]
    try:
        kind, found = _angles(seen, recording)
        angles = {name: y for name, x in found.items() if (y := _checked(name, x)) is not None}
        rows = _rows(t, angles)
    except DataError as error:
        raise DataError.at(where, error) from None
    position = recording.given.get("position") if kind == "axis" else None
    raw = Measured("", recording, t, recording.begins, kind, angles, {}, position)
    spread = {name: x / recording.reading.units.radian for name, x in _sigma(raw, sigma).items()}
    return replace(raw.part(rows), sigma=spread)


def _angles(seen: Observed, recording: Recording) -> tuple[str, dict[str, Array]]:
    """Return the kind of a recording, a key of CHANNELS, and the angles known from it."""
    if seen.angles:
        return "angles", dict(seen.angles)
    if seen.quaternion is not None:
        return "attitude", rotations.angles_of(seen.quaternion)
    if seen.axis is None:
        shown = ", ".join(x for x in recording.given if x not in {"t", "missing"})
        raise DataError(
            "it must have columns for angles, an axis or an attitude, such as theta and psi, "
            f"x y z, or qw qx qy qz, got {shown}"
        )
    if "position" in recording.given:
        check_position(recording.given["position"])
    return "axis", rotations.angles_of_axis(seen.axis)


def _checked(name: str, values: Array) -> Array | None:
    """Return an angle with NaN for missing numbers, None if all are missing."""
    known = np.isfinite(values)
    if 0 < known.sum() < _LEAST_NUMBERS:
        raise DataError(f"{name} must have {_LEAST_NUMBERS} numbers or more, got {known.sum()}")
    kept = np.where(known, values, np.nan)
    if name != "theta":
        return within_half_turn(kept) if known.any() else None
    if (wrong := kept[np.abs(kept - np.pi / 2) > np.pi / 2 + _BEYOND]).size:
        hint = ": an angle from the horizontal is named elevation"
        is_elevation = np.nanmax(np.abs(kept)) <= np.pi / 2 + _BEYOND
        raise DataError(
            "theta must be between 0 and 180 deg (pi rad), got "
            f"{np.degrees(wrong[0]):.6g} deg{hint * bool(is_elevation)}"
        )
    return kept if known.any() else None


def _rows(t: Array, angles: Mapping[str, Array]) -> NDArray[np.intp]:
    """Return the rows with a number, in the order of their times."""
    if angles.keys() == {"phi"}:
        raise DataError("it must have theta or psi too: phi alone does not determine a top")
    known = np.any([np.zeros(t.size), *map(np.isfinite, angles.values())], axis=0)
    if (count := int(known.sum())) < LEAST_ROWS:
        raise DataError(
            f"it must have {LEAST_ROWS} rows or more with a number, got {count} of {t.size}"
        )
    order = np.flatnonzero(known)[np.argsort(t[known], kind="stable")]
    if not 1e-60 < (span := float(t[order[-1]] - t[order[0]])) < 1e60:
        raise DataError(f"t must span 1e-60 to 1e+60, got {span:g}")
    return order


def _sigma(raw: Measured, sigma: Mapping[str, float] | float | None) -> dict[str, float]:
    """Return standard deviations by channel.  Raises LagtopError unless all or none are given."""
    given: Any = sigma if isinstance(sigma, Mapping) else dict.fromkeys(raw.channels, sigma)
    found = {name: checked_double("sigma", x) for name, x in given.items() if x is not None}
    if found and found.keys() != {*raw.channels}:
        wanted = f"sigma must be given for all of {', '.join(raw.channels)}"
        raise LagtopError(f"{wanted}, got {', '.join(map(str, found))}", "sigma")
    if wrong := [x for x in found.values() if not 0 < x < np.inf]:
        raise LagtopError(f"sigma must be > 0, got {wrong[0]:g}", "sigma")
    return found
