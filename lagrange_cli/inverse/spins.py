"""The spin between two rows: neither whole turns of it nor the direction of psi are visible."""

from __future__ import annotations

import math

import numpy as np

FASTER = 3.0
"""Ratio of spin rates from which the slower one tells the direction of psi."""
_TRIED = np.arange(-3, 4)
"""Whole turns per row that are tried."""


def slowest_rate(rate: float, turn: float, b: float, std: float = 0.0) -> float:
    """Return the slowest of the rates that look alike with which 0 < b/rate <= 2, or infinity.

    Alike are those that differ by `turn`, whole turns per row.  If b is not known, it is 0.
    """
    rates = rate + turn * _TRIED
    if b:
        least = (abs(b) - 2 * std) / 2
        rates = rates[(rates * b > 0) & (np.abs(rates) >= least)]
    return float(min(rates, key=abs, default=math.inf))


def reversed_note(turns: float) -> str:
    """Return a note on psi, which counts as read if the spin makes some turns per row."""
    note = "psi counts in the other direction: its sign was changed"
    faster = f" (else the spin makes {turns:.2g} turns per row or more)"
    return note + faster * (0 < turns < math.inf)


def unsure_note(turns: float) -> str:
    """Return a note on psi, whose direction may be the other one with a spin of some turns."""
    return f"psi may count in the other direction, if the spin makes {turns:.2g} turns per row"


def aliased_note(turn: float, *, is_selected: bool) -> str:
    """Return a note on a spin that is known up to multiples of `turn`, unless C selects it."""
    how = "rate that C selects" if is_selected else "slowest possible rate"
    return (
        "the spin exceeds half a turn per row: r0 is known only up to multiples of "
        f"{turn:.6g}; the {how} is reported"
    )
