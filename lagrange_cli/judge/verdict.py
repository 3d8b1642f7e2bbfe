"""The words that a trajectory is judged by."""

from __future__ import annotations

from .convergence import Convergence
from .judgement import Judgement

FINE, DRIFTS, OFF, ANOTHER, LOST = (
    "fine",
    "drifts",
    "off from the start",
    "another top",
    "lost",
)
VERDICTS = {
    FINE: "the error stays below the limit, 1e-3 rad or --max-error",
    DRIFTS: "it starts right, and the error grows beyond the limit",
    ANOTHER: "it is beyond the limit and does not fall with the step, or a usual slip explains it",
    OFF: "the first row is beyond the limit already: another start, or other frames",
    LOST: "a row is not finite",
}
"""The words with their meanings; of several that apply it is the last one."""


def verdict(judgement: Judgement, limit: float, found: Convergence | None) -> str:
    """Return the word for a trajectory, alone or among others with other steps."""
    beyond = judgement.error_max is not None and judgement.error_max > limit
    if judgement.lost_at is not None:
        return LOST
    if judgement.error_start > limit:
        return OFF
    if judgement.explained_by or (beyond and found is not None and not found.falls):
        return ANOTHER
    return DRIFTS if beyond else FINE
