"""Rows that a recorder repeated or lost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arithmetic.types import Array, Mask
from .measured import Measured
from .signals import oscillation_in, signals_in

_MOST_LOST = 3
"""Rows that are lost at once at most."""
_PLACES = 24
"""Places at which a loss is tried first."""
_ROWS = 400
"""Rows of a recording up to which a loss is searched for."""
_NEAR = 21
"""Frequencies that are tried with a loss."""
_ORDER = 2
"""Harmonics that are tried with a loss."""


def repeated(recording: Measured) -> str:
    """Return which rows equal the row before in all cells, if chance does not explain them.

    The chance is that of angles whose steps are coarse.
    """
    same = np.stack([np.diff(x) == 0 for x in recording.angles.values()])
    whole: Mask = same.all(axis=0) & (np.diff(recording.t) > 0)
    if len(same) < 2 or not whole.any() or whole.all():  # or nothing moves
        return ""
    alone = (same & ~whole).mean(axis=1) + 1 / whole.size
    chance = whole.size * float(np.prod(np.minimum(alone, 1)))
    count = int(whole.sum())
    if count <= chance + 3 * np.sqrt(chance) + 0.5:
        return ""
    at = recording.t_start + float(recording.t[1:][whole][0])
    if count == 1:
        return f"the row at t = {at:.6g} repeats the row before it"
    return f"{count} rows repeat the row before them, the first at t = {at:.6g}"


def with_gap(recording: Measured, row: int, count: int) -> Measured:
    """Return the recording with the times that rows have if some were lost before one of them."""
    later = np.arange(recording.t.size) >= row
    return replace(recording, t=recording.t + count * recording.frame * later)


def likely_gap(recording: Measured) -> tuple[int, int] | None:
    """Return the row and the number of rows whose loss before it explains the signals best.

    Harmonics of one frequency then leave the least noise.
    """
    size = recording.t.size
    if not recording.is_even or size > _ROWS:
        return None
    signals = signals_in(recording)
    frequency, _ = oscillation_in(signals)
    edge, frame = max(size // 12, 4), recording.frame
    step = max((size - 2 * edge) // _PLACES, 1)

    def noise(row: int, count: int) -> float:
        near = frequency * (1 + np.linspace(-2, 2, _NEAR) * count / size)
        found: Array = np.zeros(_NEAR)
        for x in signals.values():
            gap = count * frame * (x.t >= recording.t[row])
            other = x._replace(t=x.t + gap, y=x.y - x.rate * gap)
            found = found + np.log(other.harmonics(near, _ORDER)[1])
        return float(found.min())

    rows = range(edge, size - edge, step)
    tried = {(x, n): noise(x, n) for x in rows for n in range(1, _MOST_LOST + 1)}
    row, count = min(tried, key=lambda x: tried[x])
    for x in range(max(row - step + 1, edge), min(row + step, size - edge)):
        tried[x, count] = noise(x, count)
    return min(tried, key=lambda x: tried[x])
