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
from .harmonics import Harmonics, frequency_of, harmonics_of, turning_rate
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
    rows = _some_rows(recording.angles["theta"])
    t, theta = recording.t[rows], recording.angles["theta"][rows]
    if not np.ptp(theta) > 1e-12:
        raise NoNutationError(
            f"{where}: theta must vary, got {math.degrees(theta[0]):g} in all rows"
        )
    u = np.cos(theta)
    frequency = frequency_of(t, u)
    series = harmonics_of(t, u, frequency, fine=True)  # the turning points need more harmonics
    _check(series, u, t, f"{where}: theta")
    noise = {"theta": max(series.noise / max(float(np.sin(theta).mean()), 0.1), _LEAST_NOISE)}
    channels = {"psi": "psi", "phi": "phi"} if recording.kind == "angles" else {"across": "psi"}
    for channel, name in channels.items():
        if name in recording.angles:
            turn = _turn_of(recording, name)
            weights = np.sin(recording.angles["theta"][turn.rows]) if channel == "across" else None
            series_of_turn = turn.series(frequency, fine=True, weights=weights)
            noise[channel] = max(series_of_turn.noise, _LEAST_NOISE)
    rates = _mean_rates(recording, frequency) if "psi" in recording.angles else []
    seen = float(theta.min()), float(theta.max())
    return _shown(series.at(_PHASES / frequency), seen, frequency, noise, rates)


def turns_in(recording: Recording, where: str) -> Turns:
    """Return the turns of a recording without the tilt.  Raises DataError without nutation."""
    turns = {name: _turn_of(recording, name) for name in ("psi", "phi") if name in recording.angles}
    clear = max(turns.values(), key=_Turn.clearness)
    frequency = clear.frequency
    _check(clear.series(frequency), clear.around, clear.t, f"{where}: {' or '.join(turns)}")
    fine = {name: turn.series(frequency, fine=True) for name, turn in turns.items()}
    noise = {name: max(series.noise, _LEAST_NOISE) for name, series in fine.items()}
    for name, size in noise.items():
        if size > _MOST_NOISE:
            shown = f"{math.degrees(size):.3g}"
            raise DataError(f"{where}: {name} must have less noise than 30 degrees, got {shown}")
    return Turns(fine["psi"], fine.get("phi"), noise)


def _shown(
    wave: Array,
    seen: tuple[float, float],
    frequency: float,
    noise: Mapping[str, float],
    mean_rates: list[float],
) -> Shown:
    """Return the nutation from the cosine of the tilt over a period, from the first row on."""
    least, greatest = np.arccos(np.clip([wave.max(), wave.min()], -1, 1)).tolist()
    nutation = TurningPoints(_inside(least), _inside(greatest), 1 / frequency)
    falls = 1.0 if wave[1] < wave[0] else -1.0
    edges = _inside(seen[0]), _inside(seen[1])
    return Shown(nutation, edges, float(wave[0]), falls, noise, mean_rates)


def _inside(tilt: float) -> float:
    """Return a tilt moved away from the poles if necessary."""
    return min(max(tilt, _EDGE), math.pi - _EDGE)


def _check(series: Harmonics, y: Array, t: Array, what: str) -> None:
    """Raise DataError for a nutation that is too slow, NoNutationError for one below the noise."""
    span = float(t[-1] - t[0])
    if not _clearness(series, y, t) > _LEAST_F:
        raise NoNutationError(f"{what} must nutate beyond its noise: no period explains it")
    if series.frequency * span < 1:
        where = what.rpartition(":")[0]
        raise DataError(
            f"{where}: a recording must last for a period of the nutation, got {span:g}"
        )


def _clearness(series: Harmonics, y: Array, t: Array) -> float:
    """Return the mean variance that a harmonic explains, over the variance of the noise."""
    steady = np.polyval(np.polyfit(t, y, int(series.grows)), t)
    explained = (float(np.sum((y - steady) ** 2)) - series.misfit) / (2 * series.order)
    return explained / max(series.noise**2, 1e-300)


class _Turn(NamedTuple):
    """The periodic part of the precession or of the spin."""

    rows: NDArray[np.intp]
    t: Array
    around: Array
    rate: float

    @property
    def frequency(self) -> float:
        """The frequency of the nutation that the angle shows."""
        return frequency_of(self.t, self.around, grows=True)

    def series(
        self, frequency: float, *, fine: bool = False, weights: Array | None = None
    ) -> Harmonics:
        """Return the harmonics and the mean rate of the whole angle."""
        found = harmonics_of(self.t, self.around, frequency, grows=True, fine=fine, weights=weights)
        return found._replace(factors=np.append(found.factors[:-1], found.growth + self.rate))

    def clearness(self) -> float:
        """Return how clearly the angle shows the nutation."""
        return _clearness(self.series(self.frequency), self.around, self.t)


def _turn_of(recording: Recording, name: str) -> _Turn:
    rate = turning_rate(recording.t, recording.angles[name])
    rows = _some_rows(recording.angles[name])
    t = recording.t[rows]
    return _Turn(rows, t, np.unwrap(recording.angles[name][rows] - rate * t), rate)


def _some_rows(angle: Array) -> NDArray[np.intp]:
    """Return at most _MOST_ROWS rows that have an angle, in order."""
    rows = np.flatnonzero(np.isfinite(angle))
    if rows.size > _MOST_ROWS:
        drawn = np.random.default_rng(0).choice(rows[1:-1], _MOST_ROWS - 2, replace=False)
        rows = np.concatenate([rows[:1], np.sort(drawn), rows[-1:]])
    return rows.astype(np.intp)


def _mean_rates(recording: Recording, frequency: float) -> list[float]:
    """Return possible mean precession rates, as turns per period are unknown next to a pole."""
    turn = _turn_of(recording, "psi")
    theta = recording.angles["theta"][turn.rows]
    weights = np.where(np.isfinite(theta), np.abs(np.sin(theta)), 0.0) + 0.05
    rate = turn.series(frequency, weights=weights).growth
    whole = 2 * math.pi * frequency
    return [rate, rate - whole, rate + whole]
