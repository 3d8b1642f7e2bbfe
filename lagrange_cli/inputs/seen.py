"""The old name of `inputs.observed`, for the old layer of options."""

from .observed import Conventions

__all__ = ["Conventions", "euler_sequence"]


def euler_sequence(text: str) -> str:
    """Return a sequence of axes, which `Conventions.checked` checks."""
    return text
