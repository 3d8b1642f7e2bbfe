"""What a picture of a fit shows: the angles that were measured beside those of the motion."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arithmetic.angles import per_radian
from ..arithmetic.types import Array
from ..inputs.rotations import within_half_turn
from .record import Outcome, angles_at

_FINE = 1200
"""Points of a curve."""

Curve = tuple[str, Array, Array, Array, Array, Array]
"""Name, times, data, fine times, motion at these, and data less motion."""


def curves_of(outcome: Outcome) -> Iterator[Curve]:
    """Yield the curves of one recording, in the unit of angles in use.

    What was measured is brought to the turn of the motion that was found.
    """
    recording, scale = outcome.recording, per_radian(radians=outcome.radians)
    t = recording.t
    fine = np.linspace(0, t[-1], _FINE)
    at_rows, at_fine = angles_at(outcome, t), angles_at(outcome, fine)
    for name in ("theta", "psi", "phi"):
        if name in recording.angles:
            left = within_half_turn(recording.angles[name] - at_rows[name])
            data = at_rows[name] + left
            start = recording.t_start
            label = f"{recording.name}: {name}" if recording.name else name
            yield (
                *(label, t + start, data * scale),
                *(fine + start, at_fine[name] * scale, left * scale),
            )
