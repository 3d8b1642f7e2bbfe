"""The old name of `inputs.observed`, until all users import that."""

from .observed import (
    ORDERS,
    Conventions,
    Named,
    Quantities,
    angles_in,
    quantities_of,
    rows_of,
)
from .observed import Observed as Seen
from .observed import observe as see

__all__ = [
    "ORDERS",
    "Conventions",
    "Named",
    "Quantities",
    "Seen",
    "angles_in",
    "euler_sequence",
    "quantities_of",
    "rows_of",
    "see",
]


def euler_sequence(text: str) -> str:
    """Return a sequence of axes, which `Conventions.checked` checks."""
    return text
