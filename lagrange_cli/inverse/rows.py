"""Rows that a recorder repeated or lost, rounded times, and rows before a release."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..arithmetic.types import Array, Mask
from ..recordings.clocks import even_times
from .measured import LEAST_ROWS, Measured
from .signals import noise_of, oscillation_in, signals_in

_COARSE = 0.05
"""Share of rows in which one angle alone repeats, from which its steps are coarse."""
_MOST_LOST = 3
"""Rows that are lost at once at most."""
_PLACES = 24
"""Places at which a loss is tried first."""
_ROWS = 400
"""Rows of a recording up to which a loss is searched for."""
_NEAR = 21
"""Frequencies that are tried with a loss."""
_ORDER = 2
"""Harmonics that are tried with a loss; twice as many decide between near rows."""
_HELD = 12
"""Least number of rows before a release."""
_RELEASED = 6.0
"""Standard deviations that show a release."""
_STILL = 3.5
"""Scatter of the rows before a release, over the noise of neighbours, above which they move."""


def repeated(recording: Measured) -> str:
    """Return which rows equal the row before in all cells, unless the steps of angles are coarse.

    Then one angle is often equal where the others differ.
    """
    same = np.stack([np.diff(x) == 0 for x in recording.angles.values()])
    whole: Mask = same.all(axis=0) & (np.diff(recording.t) > 0)
    if len(same) < 2 or not whole.any() or whole.all():  # or nothing moves
        return ""
    alone = [
        (x & ~np.delete(same, i, 0).all(axis=0)).sum()
        / max((~np.delete(same, i, 0).all(0)).sum(), 1)
        for i, x in enumerate(same)
    ]
    count = int(whole.sum())
    if max(alone) > _COARSE:
        return ""
    at = recording.t_start + float(recording.t[1:][whole][0])
    if count == 1:
        return f"the row at t = {at:.6g} repeats the row before it"
    return f"{count} rows repeat the row before them, the first at t = {at:.6g}"


def frequency_of_parts(recording: Measured) -> float:
    """Return the higher frequency of a nutation that is visible in a half, 0 if there is none.

    In a recording whose rows are lost or whose motion changes, harmonics of a lower one describe
    the whole better.
    """
    if (middle := recording.t.size // 2) <= LEAST_ROWS:
        return 0.0
    halves = (recording.part(x) for x in (slice(middle), slice(middle, None)))
    found = [oscillation_in(signals_in(x)) for x in halves]
    return max((x for x, is_visible in found if is_visible), default=0.0)


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

    def noise(row: int, count: int, order: int = _ORDER) -> float:
        near = frequency * (1 + np.linspace(-2, 2, order * _NEAR) * _MOST_LOST / size)
        found: Array = np.zeros(near.size)
        for x in signals.values():
            gap = count * frame * (x.t >= recording.t[row])
            other = x._replace(t=x.t + gap, y=x.y - x.rate * gap)
            found = found + np.log(other.harmonics(near, order)[1])
        return float(found.min())

    rows = range(edge, size - edge, step)
    tried = {(x, n): noise(x, n) for x in rows for n in range(1, _MOST_LOST + 1)}
    row, _ = min(tried, key=lambda x: tried[x])
    near = range(max(row - step + 1, edge), min(row + step, size - edge))
    exact = {(x, n): noise(x, n, 2 * _ORDER) for x in near for n in range(1, _MOST_LOST + 1)}
    return min(exact, key=lambda x: exact[x])


def evenly_timed(recording: Measured) -> Measured | None:
    """Return a recording at even times, if its times are these after rounding to some digits."""
    even = even_times(recording.t_start + recording.t)
    return None if even is None else replace(recording, t=even - even[0])


def calmness(recording: Measured) -> float:
    """Return the logarithm of the noise that harmonics of one frequency leave, over the angles."""
    signals = signals_in(recording)
    frequency, _ = oscillation_in(signals)
    return sum(math.log(x) for x in noise_of(signals, frequency, recording).values())


def release(recording: Measured) -> int:
    """Return the row in which a top that was held begins to move, or 0.

    The first rows of a top that is held differ only by noise.
    """
    rows = []
    for name, values in recording.angles.items():
        seen = np.flatnonzero(np.isfinite(values))
        if name == "phi" or seen.size <= _HELD:
            continue
        y = values[seen] if name == "theta" else np.unwrap(values[seen])
        noise = max(float(np.std(y[:_HELD])), 1e-9) * _RELEASED
        moves = np.flatnonzero(np.abs(y - y[:_HELD].mean()) > noise)
        held = y[: moves[0]] if moves.size else y
        if np.std(held) > _STILL * math.sqrt(np.mean(np.diff(held) ** 2) / 2) + 1e-9:
            return 0
        rows.append(int(seen[moves[0]]) if moves.size else values.size)
    row = min(rows, default=0)
    return row if _HELD < row < recording.t.size - 2 * _HELD else 0
