"""Rows that a recorder repeated, gaps in time, and rows before a release."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..arithmetic.types import Mask
from .measured import LEAST_ROWS, Measured
from .signals import noise_of, oscillation_in, signals_in

_COARSE = 0.05
"""Share of rows in which one angle alone repeats, from which its steps are coarse."""
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
    found = [oscillation_in(signals_in(x)) for x in halves if x.has_numbers]
    return max((x for x, is_visible in found if is_visible), default=0.0)


def with_gap(recording: Measured, row: int, count: int) -> Measured:
    """Return the recording with the times that rows have if some were lost before one of them."""
    later = np.arange(recording.t.size) >= row
    return replace(recording, t=recording.t + count * recording.frame * later)


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
