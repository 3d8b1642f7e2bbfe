"""The arithmetic of mpmath, for callers from Python, the nome series and the paper's forms."""

from __future__ import annotations

from mpmath.ctx_mp import MPContext

from ..arithmetic.numbers import Scalars, Unenclosed


class ManyDigits(Scalars, Unenclosed, MPContext):  # type: ignore[misc]
    """The arithmetic of mpmath: any number of digits, complex numbers, and special functions.

    Each instance is a context of its own and leaves other precisions alone.
    """

    def __init__(self, digits: int = 50) -> None:
        super().__init__()
        self.dps = digits

    @property
    def magnitude(self) -> float:
        """The decimal logarithm of eps."""
        return 1.0 - float(self.dps)
