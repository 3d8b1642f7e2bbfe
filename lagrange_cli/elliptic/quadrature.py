"""The radicand of Aksenov's quadrature (3.2.1), with rational roots, and what it must fulfil."""

from __future__ import annotations

from fractions import Fraction
from math import prod
from typing import NamedTuple

from ..errors import LagtopError

LEAST, MOST = Fraction("1e-100"), Fraction("1e100")
"""Sizes of roots, gaps and g in doubles."""


class Quadrature(NamedTuple):
    """The radicand: the band, up to two outer roots, and g, which is -2 alpha1 c^2 in (3.2.1).

    `check` it before use.
    """

    lower: Fraction
    """delta*."""
    upper: Fraction
    """delta."""
    outer: tuple[Fraction, ...]
    """The outer roots that are not at infinity, in any order; of a complex pair the real parts."""
    g: Fraction = Fraction(1)
    """The leading coefficient, without its sign."""
    height: Fraction = Fraction(0)
    """Size of the imaginary parts of a complex pair."""

    def check(self) -> None:
        """Raise LagtopError unless the motion is periodic: an empty band, an outer root in it."""
        if self.upper < self.lower:
            raise LagtopError(
                f"delta must be >= delta_star = {float(self.lower)}, got {float(self.upper)}",
                "delta",
            )
        if self.g <= 0:
            raise LagtopError(f"g must be > 0, got {float(self.g)}", "g")
        for root in () if self.height else self.outer:
            if root in {self.lower, self.upper}:
                raise LagtopError(
                    "an outer root at an end of the band makes the period infinite (k1 = 1), "
                    f"got {float(root)}"
                )
            if self.lower <= root <= self.upper:
                raise LagtopError(
                    "the outer roots must lie outside the band from delta* to delta, "
                    f"[{float(self.lower)}, {float(self.upper)}], got {float(root)}"
                )

    def check_doubles(self) -> None:
        """Raise LagtopError as `check` does, and where a size is out of reach of doubles."""
        self.check()
        gaps = [abs(end - root) for root in self.outer for end in (self.lower, self.upper)]
        sizes = {
            "delta": [self.upper],
            "delta_star": [self.lower],
            "g": [self.g],
            "delta - delta_star": [self.upper - self.lower],
            "the gap to an outer root": [] if self.height else gaps,
            "q": [self.height],
            "p": self.outer[:1] if self.height else [],
        }
        for name, values in sizes.items():
            for value in values:
                if value and not LEAST <= abs(value) <= MOST:
                    raise LagtopError(
                        f"{name} must be from 1e-100 to 1e100 in size, got {float(value)} "
                        "(or give --digits)",
                        name,
                    )

    @property
    def squares(self) -> tuple[Fraction, Fraction]:
        """Squares of m' and m'' (3.2.3), exactly."""
        to_upper = prod((abs(root - self.upper) for root in self.outer), start=Fraction(1))
        to_lower = prod((abs(root - self.lower) for root in self.outer), start=Fraction(1))
        return to_upper + self.height**2, to_lower + self.height**2

    @property
    def layout(self) -> str:
        """Places of the outer roots, in words."""
        if self.height:
            return "complex pair"
        if not self.outer:
            return "both at infinity"
        above = sum(root > self.upper for root in self.outer)
        if len(self.outer) == 1:
            return "one above" if above else "one below"
        return ("both below", "one on each side", "both above")[above]

    @property
    def kind(self) -> str:
        """The radicand by its degree, and what is degenerate about it."""
        degree = ("quadratic", "cubic", "quartic")[len(self.outer)]
        if self.lower == self.upper:
            return f"{degree}, the band is a double root: eta is constant"
        if not self.outer:
            return "quadratic, k1 = 0: a harmonic oscillation"
        if len(set(self.outer)) < len(self.outer) and not self.height:
            return "quartic with a double outer root, k1 = 0: circular functions"
        return "quartic, k1 is imaginary" if self.height else degree
