"""Why a fit has failed, and what to try: reasons of one type, in the order of the report."""

from __future__ import annotations

from enum import IntEnum, auto
from typing import Self

from ..errors import Message


class Kind(IntEnum):
    """What is wrong, the plainest first, and advice at the end."""

    DATA = auto()
    """The origin of a marker is not the pivot, or a quaternion has no length of 1."""
    ROWS = auto()
    """Rows are repeated or lost."""
    IMPOSSIBLE = auto()
    """The numbers are those of no rigid body, or of no steady precession."""
    MACHINE = auto()
    """Another machine, or a fault of camera, clock or angles, explains the residuals."""
    OPEN = auto()
    """The recording determines no top, or several."""
    MOTION = auto()
    """No motion of a top is near the recording."""
    OUTLIER = auto()
    """A few rows are far off."""
    RESIDUALS = auto()
    """The residuals are not noise."""
    SIGMA = auto()
    """The residuals are larger than the noise that was given."""
    KNOWN = auto()
    """A known input contradicts the recording."""
    READING = auto()
    """Advice: the recording was misread, and a fit of the other reading is good."""
    WINDOWS = auto()
    """Advice: the spin decays, and fits of windows are good, or show its loss."""
    CHECK = auto()
    """Advice: what to check, because nothing else explains the failure."""


NEEDS_ADVICE = {Kind.IMPOSSIBLE, Kind.MACHINE, Kind.MOTION, Kind.OUTLIER, Kind.RESIDUALS}
"""Kinds that a mistake in the recording may cause."""
SAY_WHAT_TO_DO = {Kind.DATA, Kind.ROWS}
"""Kinds with a remedy of their own, beside which no other advice is sought."""
MISFITS = {Kind.MOTION, Kind.OUTLIER, Kind.RESIDUALS, Kind.SIGMA}
"""Kinds of a motion that does not match the recording."""
ADVICE = {Kind.READING, Kind.WINDOWS, Kind.CHECK}
"""Kinds that say what to try."""


class Reason(Message):
    """A reason why a fit has failed, or advice."""

    kind: Kind

    def __new__(cls, kind: Kind, text: str) -> Self:
        """Take a text with arguments that `arg` has marked."""
        found = super().__new__(cls, text)
        found.kind = kind
        return found
