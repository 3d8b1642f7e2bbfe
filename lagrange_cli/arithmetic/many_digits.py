"""The arithmetic of mpmath: any number of digits, complex numbers, and special functions."""

from __future__ import annotations

from mpmath.ctx_mp import MPContext

from .scalars import Scalars, Unenclosed


class ManyDigits(Scalars, Unenclosed, MPContext):  # type: ignore[misc]
    """An mpmath context of its own: nobody else's precision is touched.

    By default it has the digits for constants that are rounded to doubles; 34 would do, the rest is
    margin.
    """

    @property
    def magnitude(self) -> float:
        """The decimal logarithm of eps."""
        return 1.0 - float(self.dps)

    def __init__(self, digits: int = 50) -> None:
        super().__init__()
        self.dps = digits
