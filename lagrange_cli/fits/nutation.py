"""Turning points, period and mean precession of the nutation in a recording.

The cosine of the tilt is periodic; spin and precession are periodic except for their mean rates.
Each of them is fitted by a few harmonics.  If the tilt is not recorded, it follows from the rates
of the other angles, as cos(theta) = (r0 - phi')/psi' (4,8).  Several values of the unknown spin
rate r0 are tried.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.types import Array
from ..errors import DataError
from .harmonics import Harmonics, Signal, turning_rate
from .invert import TurningPoints
from .recording import Recording

_MOST_ROWS = 3000
"""Number of rows for a start; of longer recordings this many are drawn."""
_LEAST_F = 8.0
"""Least variance that a harmonic of a nutation explains, over the variance of the noise.  Noise by
chance explains less, even at the best of all frequencies.
"""
_LEAST_NOISE = 1e-9
"""Noise in radians assumed for a recording without noise, above its rounding errors."""
_MOST_NOISE = math.radians(30)
"""Noise in radians beyond which turns of an angle cannot be counted from row to row."""
_EDGE = 1e-4
"""Least distance of a turning point from a pole."""
_PHASES = np.linspace(0, 1, 721)[:-1]
"""Phases within a period, in periods."""


class NoNutationError(DataError):
    """A recording shows no nutation beyond its noise."""


class Shown(NamedTuple):
    """The nutation that a recording shows."""

    nutation: TurningPoints
    seen: tuple[float, float]
    """The least and the greatest tilt of any row."""
    u_start: float
    """The cosine of the tilt in the first row."""
    falls: float
    """1 if the tilt grows in the first row, else -1."""
    noise: Mapping[str, float]
    """Standard deviations of the residuals of a fit by harmonics, by channel, in radians.  They are
    about the noise of the recording.  A channel without such a fit is missing.
    """
    mean_rates: list[float]
    """Possible mean precession rates, the likeliest first, as angles are known up to whole turns.
    Empty if psi is not given.
    """


class Turns(NamedTuple):
    """The precession and the spin of a recording over a period."""

    psi: Harmonics
    phi: Harmonics | None
    """The spin, if it was recorded."""
    noise: dict[str, float]
    """Standard deviations of the residuals, of psi and phi."""


def shown_by(recording: Recording, where: str) -> Shown:
    """Return the nutation of a recording with the tilt.  Raises DataError if there is none."""
    tilt = recording.angles["theta"]
    rows = _some_rows(tilt)
    t, theta = recording.t[rows], tilt[rows]
    if not np.ptp(theta) > 1e-12:
        raise NoNutationError(
            f"{where}: theta must vary, got {math.degrees(theta[0]):g} in all rows"
        )
    signal = Signal(t, np.cos(theta))
    series = signal.series(signal.frequency(), fine=True)  # turning points need more harmonics
    frequency = series.frequency
    _check(signal, series, where, "theta")
    noise = {"theta": max(series.noise / max(float(np.sin(theta).mean()), 0.1), _LEAST_NOISE)}
    turns, mean_rates = _turns(recording), []
    channels = {"psi": "psi", "phi": "phi"} if recording.kind == "angles" else {"across": "psi"}
    for channel, name in channels.items():
        if name in turns:
            rows, turn = turns[name]
            weights = np.sin(tilt[rows]) if channel == "across" else None
            fine = turn.series(frequency, fine=True, weights=weights)
            noise[channel] = max(fine.noise, _LEAST_NOISE)
    if "psi" in turns:
        rows, turn = turns["psi"]
        weights = np.where(np.isfinite(tilt[rows]), np.abs(np.sin(tilt[rows])), 0.0) + 0.05
        rate = turn.series(frequency, weights=weights).growth
        whole = 2 * math.pi * frequency  # turns per period are unknown next to a pole
        mean_rates = [rate, rate - whole, rate + whole]
    wave = series.at(_PHASES / frequency)
    ends = np.arccos(np.clip([wave.max(), wave.min()], -1, 1))
    tilts = np.clip([*ends, theta.min(), theta.max()], _EDGE, math.pi - _EDGE)
    least, greatest, low, high = tilts.tolist()
    return Shown(
        TurningPoints(least, greatest, 1 / frequency),
        (low, high),
        float(wave[0]),
        1.0 if wave[1] < wave[0] else -1.0,
        noise,
        mean_rates,
    )


def turns_in(recording: Recording, where: str) -> Turns:
    """Return the turns of a recording without the tilt.  Raises DataError without nutation."""
    turns = {name: turn for name, (_, turn) in _turns(recording).items()}
    plain = {name: turn.series(turn.frequency()) for name, turn in turns.items()}
    clear = max(turns, key=lambda name: turns[name].clearness(plain[name]))
    _check(turns[clear], plain[clear], where, " or ".join(turns))
    frequency = plain[clear].frequency
    fine = {name: turn.series(frequency, fine=True) for name, turn in turns.items()}
    noise = {name: max(series.noise, _LEAST_NOISE) for name, series in fine.items()}
    for name, size in noise.items():
        if size > _MOST_NOISE:
            shown = f"{math.degrees(size):.3g}"
            raise DataError(f"{where}: {name} must have less noise than 30 degrees, got {shown}")
    return Turns(fine["psi"], fine.get("phi"), noise)


def _check(signal: Signal, series: Harmonics, where: str, names: str) -> None:
    """Raise DataError for a nutation that is too slow, NoNutationError for one below the noise."""
    if not signal.clearness(series) > _LEAST_F:
        raise NoNutationError(
            f"{where}: {names} must nutate beyond its noise: no period explains it"
        )
    span = float(signal.t[-1] - signal.t[0])
    if series.frequency * span < 1:
        raise DataError(
            f"{where}: a recording must last for a period of the nutation, got {span:g}"
        )


def _turns(recording: Recording) -> dict[str, tuple[NDArray[np.intp], Signal]]:
    """Return the turns of the precession and of the spin, with their rows."""
    found = {}
    for name in [x for x in ("psi", "phi") if x in recording.angles]:
        angle = recording.angles[name]
        rate, rows = turning_rate(recording.t, angle), _some_rows(angle)
        t = recording.t[rows]
        found[name] = rows, Signal(t, np.unwrap(angle[rows] - rate * t), True, rate)
    return found


def _some_rows(angle: Array) -> NDArray[np.intp]:
    """Return at most _MOST_ROWS rows that have an angle, in order."""
    rows = np.flatnonzero(np.isfinite(angle))
    if rows.size > _MOST_ROWS:
        drawn = np.random.default_rng(0).choice(rows[1:-1], _MOST_ROWS - 2, replace=False)
        rows = np.concatenate([rows[:1], np.sort(drawn), rows[-1:]])
    return rows.astype(np.intp)
