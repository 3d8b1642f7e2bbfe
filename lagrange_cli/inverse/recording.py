"""Recordings: measured angles, an axis or an attitude over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.numbers import unit_in_radians
from ..arithmetic.types import Array, Mask
from ..errors import DataError, LagtopError, Message, marked
from ..files import rotations
from ..files.observed import Conventions, Quantities, angles_in, observe, quantities_of, rows_of
from ..files.rotations import within_half_turn
from ..files.trajectory import read_trajectory
from ..names import ANGLES
from ..top.inputs import checked_double

CHANNELS = {
    "angles": ANGLES,
    "axis": ("theta", "across"),
    "attitude": ("theta", "across", "along"),
}
"""Residuals by kind of recording: of the axis along the meridian and across it, of an attitude also
about the axis."""
LEAST_ROWS = 12
_BEYOND = 0.2
"""Largest tilt beyond a pole that counts as noise, in radians."""
_SURE, _LEAST_CHANGE = 5.0, 2e-3
"""Standard deviations of a shifted origin, and the least change of the distance over itself."""
_UNEVEN = 0.05
"""Mean deviation of times from whole frames from which rows are not evenly spaced."""


def are_whole(frames: Array) -> bool:
    """Return whether times in units of a frame are whole numbers, except for jitter."""
    return bool(np.mean(np.abs(frames - np.round(frames))) < _UNEVEN)


def frames_of(t: Array, frame: float) -> Array:
    """Return the number of the frame of each time, the first 0, for a rough length of a frame."""
    return np.concatenate([[0.0], np.cumsum(np.round(np.diff(t) / frame))])


@dataclass(frozen=True)
class Recording:
    """The measured motion of one top; missing numbers are NaN."""

    name: str
    """The number of a window, or empty."""
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
    used: tuple[str, ...] = ()
    """Columns of the file that were read."""
    unused: tuple[str, ...] = ()
    """Other columns of the file."""
    is_mirrored: bool = False
    """Whether psi was counted in the other direction."""
    time_unit: str = "units of the recording"
    """The unit of time for labels."""
    spread: Array | None = None
    """Standard deviations of the times of the rows of which each row is the mean."""
    rows_per_bin: int = 1
    """The number of rows of which each row is the mean."""
    is_turned: bool = False
    """Whether `up` or `axis` has turned its frame."""

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
    def mirrored(self) -> Recording:
        """The recording with psi counted in the other direction."""
        angles = {name: -x if name == "psi" else x for name, x in self.angles.items()}
        return replace(self, angles=angles, is_mirrored=not self.is_mirrored)

    @property
    def is_even(self) -> bool:
        """Whether the rows are whole frames apart, so that whole turns per frame are invisible."""
        return are_whole(self.t / self.frame)

    @property
    def exchanged(self) -> Recording:
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

    def thinned(self, count: int) -> Recording:
        """Return at most `count` rows, evenly from the first to the last."""
        if count >= self.t.size:
            return self
        return self.rows(np.linspace(0, self.t.size - 1, count).astype(int))

    def rows(self, rows: Any) -> Recording:
        """Return some rows, in this order, with the same zero of time."""
        found: dict[str, Any] = {
            key: None if (x := getattr(self, key)) is None else x[rows]
            for key in ("position", "spread")
        }
        return replace(self, t=self.t[rows], angles=rows_of(self.angles, rows), **found)

    def part(self, rows: Any, name: str = "") -> Recording:
        """Return some rows, in this order, with times since the first of them."""
        found = self.rows(rows)
        start = float(found.t[0])
        return replace(found, name=name, t=found.t - start, t_start=self.t_start + start)

    def windows(self, count: int) -> list[Recording]:
        """Return the recording in equal windows of time.  Raises LagtopError for a bad count."""
        if count < 2:
            raise LagtopError(f"window must be at least 2, got {count}", "window")
        number = np.minimum((self.t / self.t[-1] * count).astype(int), count - 1)
        rows = [np.flatnonzero(number == i) for i in range(count)]
        seen = [np.isfinite(y) for y in self.angles.values()]
        if (least := min(int(y[x].sum()) for x in rows for y in seen)) < LEAST_ROWS:
            wanted = f"{LEAST_ROWS} rows or more in each window"
            raise LagtopError(f"window must leave {wanted}, got {least}: use fewer", "window")
        return [self.part(x, f"window {i}") for i, x in enumerate(rows, 1)]


def read_recording(
    path: str, columns: Sequence[str] | None = None, decimal: str = "", **reading: Any
) -> Recording:
    """Return the recording in a file; `reading` are the other arguments of `recording_of`.

    The decimal mark may be left to the file.  Raises LagtopError for a file that cannot be read,
    DataError for one that holds no recording.
    """
    trajectory = read_trajectory(path, columns, decimal)
    conventions = reading["conventions"]
    given = trajectory.values(radians=conventions.radians)
    first = float(given["t"][0, 0]) if given["t"].size else 0.0
    given["t"] = trajectory.elapsed.reshape(-1, 1)
    reading["conventions"] = trajectory.conventions(conventions)
    found = recording_of(trajectory.name, given, **reading)
    used, unused = tuple(trajectory.used), tuple(trajectory.unused)
    found = replace(found, t_start=first + found.t_start, used=used, unused=unused)
    has_unit = trajectory.quantities["t"].unit is not None  # such as ms, converted to s
    return replace(found, time_unit="s") if has_unit else found


def recording_from(
    t: ArrayLike,
    *,
    sigma: Mapping[str, float] | float | None = None,
    **arrays: ArrayLike | None,
) -> Recording:
    """Return the recording in the arguments of `fit`.  Raises LagtopError, DataError."""
    given = {name: x for name, x in arrays.items() if x is not None}
    if len(given) != max(sum(name in ANGLES for name in given), 1):
        shown = ", ".join(given) or "nothing"
        raise LagtopError(f"fit takes angles, or an axis, or a quaternion, got {shown}")
    conventions = Conventions("wxyz", radians=True)
    return recording_of("the recording", quantities_of(t, given), conventions, sigma=sigma)


def recording_of(
    where: str,
    given: Quantities,
    conventions: Conventions,
    *,
    sigma: Mapping[str, float] | float | None = None,
    up: str = "z",
    axis: str = "z",
) -> Recording:
    """Return the recording in some columns, without rows that have no number.

    `sigma` are standard deviations in the unit of angles of the `conventions`: one for all
    channels, or by channel.  The axis `up` of space points upwards in the file, and the axis `axis`
    of the body is the figure axis.  Raises LagtopError, DataError for a bad recording.
    """
    t = given["t"][:, 0]
    _check_times(where, t)
    kind, found = _angles(given, conventions, up, axis)
    position = given["position"] if kind == "axis" and "axis" not in given else None
    if not found:
        shown = ", ".join(x for x in given if x != "t")
        raise DataError(
            f"{where} must have columns for angles, an axis or an attitude, such as theta and "
            f"psi, x y z, or qw qx qy qz, got {shown}"
        )
    angles = {}
    for name, values in found.items():
        known = np.isfinite(values)
        if 0 < known.sum() < 4:
            raise DataError(f"{where}: {name} must have 4 numbers or more, got {known.sum()}")
        if known.any():
            kept = np.where(known, values, np.nan)
            angles[name] = kept if name == "theta" else within_half_turn(kept)
    if angles.keys() == {"phi"}:
        raise DataError(f"{where} must have theta or psi too: phi alone does not determine a top")
    known = np.any([np.zeros(t.size), *map(np.isfinite, angles.values())], axis=0)
    if (count := int(known.sum())) < LEAST_ROWS:
        raise DataError(
            f"{where} must have {LEAST_ROWS} rows or more with a number, got {count} of {t.size}"
        )
    tilts = angles.get("theta", np.zeros(1))
    if (wrong := tilts[np.abs(tilts - np.pi / 2) > np.pi / 2 + _BEYOND]).size:
        hint = ": an angle from the horizontal is named elevation"
        raise DataError(
            f"{where}: theta must be between 0 and 180 deg (pi rad), got {np.degrees(wrong[0]):.6g}"
            f" deg{hint * bool(np.nanmax(np.abs(tilts)) <= np.pi / 2 + _BEYOND)}"
        )
    order = np.flatnonzero(known)[np.argsort(t[known], kind="stable")]
    if not 1e-60 < (span := float(t[order[-1]] - t[order[0]])) < 1e60:
        raise DataError(f"{where}: t must span 1e-60 to 1e+60, got {span:g}")
    raw = Recording("", t, 0.0, kind, angles, {}, position)
    unit = unit_in_radians(radians=conventions.radians)
    spread = {name: x * unit for name, x in _sigma(raw, sigma).items()}
    return replace(raw, sigma=spread, is_turned=(up, axis) != ("z", "z")).part(order)


def _check_times(where: str, t: Array) -> None:
    """Raise DataError for a time that is not finite or turns back."""
    if t.size == 0:
        raise DataError(f"{where} must have at least one row of numbers")
    if not np.isfinite(t).all():
        raise DataError(f"{where}: t must be finite numbers, got {t[~np.isfinite(t)][0]}")
    if (back := np.flatnonzero(np.diff(t) < 0)).size and not (np.diff(t) <= 0).all():
        before, after = t[back[0] : back[0] + 2].tolist()
        raise DataError(
            f"{where}: t must not turn back, got {after:g} after {before:g}: put each recording "
            "into its own file"
        )


def _angles(
    given: Quantities, conventions: Conventions, up: str, axis: str
) -> tuple[str, dict[str, Array]]:
    """Return the kind of a recording, a key of CHANNELS, and the angles known from it."""
    alone = angles_in(given)
    if alone and not {"quaternion", "matrix", "euler", "rotvec"} & given.keys():
        if (up, axis) != ("z", "z"):
            raise LagtopError("align needs an axis or an attitude, got angles", "align")
        return "angles", alone
    seen = observe(given, conventions)
    if axis != "z" and seen.quaternion is None:
        raise LagtopError("align axis=... needs an attitude, got an axis", "align")
    seen = seen.turned(rotations.to_z(up), rotations.to_z(axis))
    if seen.quaternion is not None:
        return "attitude", rotations.angles_of(seen.quaternion)
    if seen.axis is not None:
        return "axis", rotations.angles_of_axis(seen.axis)
    return "angles", {}


def _sigma(raw: Recording, sigma: Mapping[str, float] | float | None) -> dict[str, float]:
    """Return standard deviations by channel.  Raises LagtopError unless all or none are given."""
    given: Any = sigma if isinstance(sigma, Mapping) else dict.fromkeys(raw.channels, sigma)
    found = {name: checked_double("sigma", x) for name, x in given.items() if x is not None}
    if found and found.keys() != {*raw.channels}:
        wanted = f"sigma must be given for all of {', '.join(raw.channels)}"
        raise LagtopError(f"{wanted}, got {', '.join(map(str, found))}", "sigma")
    if wrong := [x for x in found.values() if not 0 < x < np.inf]:
        raise LagtopError(f"sigma must be > 0, got {wrong[0]:g}", "sigma")
    return found


def reoriented(recording: Recording, *, up: str = "z", axis: str = "z") -> Recording:
    """Return a recording of an axis or attitude in other frames.

    The axis `up` of space points upwards, and the axis `axis` of the body is the figure axis.
    """
    theta, psi = recording.angles["theta"], recording.angles["psi"]
    turns = rotations.of_angles(theta, recording.angles.get("phi", np.zeros_like(theta)), psi)
    turns = rotations.product(rotations.to_z(up), turns)
    found = rotations.angles_of(rotations.product(turns, rotations.conjugate(rotations.to_z(axis))))
    return replace(recording, angles={name: found[name] for name in recording.angles})


def shifted_origin(recording: Recording) -> Array | None:
    """Return the pivot in the coordinates of the marker, if these do not begin at the pivot.

    The distance of the marker from its origin grows by d.e if the origin is off by d, with the
    direction e of the marker.  Returns None if the distance does not vary by more than noise, or
    hardly varies.
    """
    if recording.position is None:
        return None
    offset, directions, distance = _offset(recording.position)
    explained = directions @ offset
    rest = distance - distance.mean() - explained
    noise = float(rest @ rest) / max(distance.size - 4, 1)
    gain = float(explained @ explained) / (noise + 1e-30)
    hidden = gain < _SURE**2 + 3 or np.ptp(explained) < _LEAST_CHANGE * distance.mean()
    if hidden:
        return None
    for _ in range(8):  # to first order in what is left
        offset = offset + _offset(recording.position - offset)[0]
    return offset


def _offset(marker: Array) -> tuple[Array, Array, Array]:
    """Return the pivot to first order, a marker's directions less their mean, and its distances."""
    distance = np.linalg.norm(marker, axis=1)
    directions = marker / distance[:, np.newaxis]
    directions = directions - directions.mean(axis=0)
    basis = np.column_stack([np.ones(distance.size), directions])
    return np.linalg.lstsq(basis, distance, rcond=1e-3)[0][1:], directions, distance
