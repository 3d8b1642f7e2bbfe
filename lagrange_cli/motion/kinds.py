"""The kinds of motion, each with the numbers of its record by key.

Only `kind_of` selects a kind.  `lacks` names the keys that a kind does not have.
"""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

from ..arithmetic.ball import TooFewDigitsError
from ..arithmetic.numbers import R
from .quantity import quantity
from .regime import Facts, Regime
from .spin_precession import SpinPrecession

if TYPE_CHECKING:
    from .degenerate import Separatrix, Steady, Vertical

Real = float | Decimal
Kind: TypeAlias = "Nutating[R] | Steady[R] | Vertical[R] | Separatrix[R]"
"""Any kind of motion."""


class Nutating(SpinPrecession[R]):
    """A top whose tilt oscillates between u1 and u2."""

    def remark(self, *, radians: bool = False) -> str | None:
        """Return a line on a fast top, with its nutation in degrees or `radians`; else None.

        Raises TooFewDigitsError if the ends of an enclosure would be printed differently.
        """
        if not self.facts.fast:
            return None
        nodding, *others = self.fast_numbers
        numbers: Any = nodding if radians else nodding / self.degree, *others
        lines = {
            fast_remark(*ends, radians=radians)
            for ends in zip(*(number.ends() for number in numbers), strict=True)
        }
        if len(lines) > 1:
            raise TooFewDigitsError
        return lines.pop()

    @property
    def fast_numbers(self) -> tuple[R, R, R, R]:
        """The numbers in the remark on a fast top, see `fast_remark`; angles in radians."""
        return self.nodding, self.T_nutation, self.elementary_rate, self.excess

    @quantity
    def nodding(self) -> R:
        """The amplitude theta_max - theta_min in radians, computed without a subtraction."""
        ar, gaps = self.ar, self.gaps
        across = ar.sqrt(gaps.above_u2 * gaps.below_u1) + ar.sqrt(gaps.below_u2 * gaps.above_u1)
        along = ar.sqrt(gaps.below_u1 * gaps.below_u2) + ar.sqrt(gaps.above_u1 * gaps.above_u2)
        return 2 * ar.atan2(2 * gaps.u1_u2 / across, along)

    @quantity
    def elementary_rate(self) -> R:
        """The precession rate mgs/(C r0) = a/2b of the elementary theory of fast tops."""
        return self.state.a / (2 * self.state.b)

    @quantity
    def excess(self) -> R:
        """The relative excess of the mean precession rate (7,3) over the elementary rate."""
        return self.mean_precession_rate / self.elementary_rate - 1


def fast_remark(
    nodding: Real, period: Real, elementary: Real, excess: Real, *, radians: bool
) -> str:
    """Return the remark on a pseudo-regular precession.

    `nodding` is the amplitude theta_max - theta_min in degrees or radians, `excess` the relative
    excess of the mean precession rate over the elementary rate.
    """
    parts = round(Fraction(excess) * 10**6)
    where = f"{abs(parts)} ppm {'below' if parts < 0 else 'above'}" if parts else "within 1 ppm of"
    return (
        f"pseudo-regular precession: nutates by {_figures(nodding)} {'rad' if radians else 'deg'} "
        f"in {_figures(period)} time; its mean is {where} mgs/(C r0) = {_figures(elementary)} "
        "rad/time"
    )


def _figures(x: Real) -> str:
    """Return a number as text with three significant digits."""
    return f"{float(f'{x:.3g}'):.3g}"


def kind_of(facts: Facts) -> type[Kind[Any]]:
    """Return the class of the motion with these facts."""
    vertical = facts.regime in {Regime.SLEEPING, Regime.HANGING}
    if not (vertical or facts.steady or facts.regime is Regime.SEPARATRIX):
        return Nutating
    from .degenerate import Separatrix, Steady, Vertical  # start-up: for few tops

    if vertical:
        return Vertical
    return Steady if facts.steady else Separatrix
