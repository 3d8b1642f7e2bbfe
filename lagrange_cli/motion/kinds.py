"""The four kinds of motion, each with the numbers of its record under their keys.

`kind_of` is the only place that chooses.  `lacks` names the keys that a kind does not have.
"""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any, TypeAlias

from ..arithmetic.ball import TooFewDigitsError
from ..arithmetic.numbers import R
from .quantity import quantity
from .regime import Facts, Regime
from .spin_precession import SpinPrecession


class Nutating(SpinPrecession[R]):
    """A top whose tilt goes to and fro between u1 and u2."""

    def remark(self, *, radians: bool = False) -> str | None:
        """Return a line on a fast top, with its nutation in degrees or `radians`.

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
        """What is said of a fast top, see `fast_remark`; angles in radians."""
        return self.nodding, self.T_nutation, self.elementary_rate, self.excess

    @quantity
    def nodding(self) -> R:
        """The greatest nutation theta_max - theta_min in radians, without a difference."""
        ar, gaps = self.ar, self.gaps
        across = ar.sqrt(gaps.above_u2 * gaps.below_u1) + ar.sqrt(gaps.below_u2 * gaps.above_u1)
        along = ar.sqrt(gaps.below_u1 * gaps.below_u2) + ar.sqrt(gaps.above_u1 * gaps.above_u2)
        return 2 * ar.atan2(2 * gaps.u1_u2 / across, along)

    @quantity
    def elementary_rate(self) -> R:
        """The rate mgs/(C r0) = a/2b of the precession by the elementary theory of fast tops."""
        return self.state.a / (2 * self.state.b)

    @quantity
    def excess(self) -> R:
        """How far the mean precession (7,3) exceeds the elementary rate, relative to that."""
        return self.mean_precession_rate / self.elementary_rate - 1


class Constant(SpinPrecession[R]):
    """A motion at constant tilt, with constant rates of spin and precession."""

    lacks = frozenset("amplitude_deg alpha u_quarter spin_rate_half precession_rate_half".split())

    @quantity
    def T_nutation(self) -> Any:
        """The period (5,1) of a small nutation; None where nothing moves."""
        moves = self.argument_rate > 0
        if not self.ar.anywhere(moves):
            return None
        return 2 * self.K / self.ar.where(moves, self.argument_rate, self.ar.nan)

    @quantity
    def theta_min_deg(self) -> R:
        """The tilt, in degrees."""
        return 2 * self.ar.atan2(self.state.sin_half, self.state.cos_half) / self.degree

    @quantity
    def theta_max_deg(self) -> R:
        """The tilt, in degrees."""
        return self.theta_min_deg

    @quantity
    def mean_spin_rate(self) -> R:
        """The spin rate (4,8), which is constant; on the vertical all rotation counts as spin."""
        return self.r0 if self.facts.pole else self.r0 - self.state.psi_rate * self.state.cos

    @quantity
    def spin_rate_start(self) -> R | None:
        """The spin rate, which is constant."""
        return self.mean_spin_rate

    @quantity
    def mean_precession_rate(self) -> R:
        """The precession rate, which is constant."""
        return self.state.psi_rate


class Steady(Constant[R]):
    """A steady precession, or a top without torque that turns about an axis of its own."""


class Vertical(Constant[R]):
    """An upright or hanging top: of phi and psi only the sum or the difference has a meaning."""

    lacks = Constant.lacks | set(
        "u3 k k_prime modular_angle_deg nome K K_prime E T_nutation "
        "mean_precession_rate precession_rate_start T_precession".split()
    )

    def remark(self, *, radians: bool = False) -> str | None:
        """Return which angles have a meaning, and whether the motion is stable."""
        return vertical_remark(self.facts.regime, bool(self.facts.stable))


def vertical_remark(regime: Regime, stable: bool) -> str:
    """Return what there is to say of an upright or hanging top."""
    if regime is Regime.HANGING:
        return "only phi - psi is defined; stable"
    word, sign = ("stable", ">=") if stable else ("unstable", "<")
    return f"only phi + psi is defined; {word} (lambda = b^2/2a {sign} 1)"


def fast_remark(
    nodding: Real, period: Real, elementary: Real, excess: Real, *, radians: bool
) -> str:
    """Return what a pseudo-regular precession is in numbers.

    `nodding` is the greatest nutation in degrees or radians, `excess` how far the mean precession
    exceeds the elementary rate, relative to that.
    """
    parts = round(Fraction(excess) * 10**6)
    where = f"{abs(parts)} ppm {'below' if parts < 0 else 'above'}" if parts else "within 1 ppm of"
    return (
        f"pseudo-regular precession: nods by {_figures(nodding)} {'rad' if radians else 'deg'} in "
        f"{_figures(period)} time; its mean is {where} mgs/(C r0) = {_figures(elementary)} rad/time"
    )


def _figures(x: Real) -> str:
    """Return three significant digits, written as those of a double."""
    return f"{float(f'{x:.3g}'):.3g}"


class Separatrix(SpinPrecession[R]):
    """The swing up to the vertical in infinite time: u1 = u3 = 1, k = 1."""

    lacks = frozenset(
        "amplitude_deg alpha K T_nutation T_spin T_precession u_quarter mean_spin_rate "
        "mean_precession_rate spin_rate_half precession_rate_half".split()
    )

    def remark(self, *, radians: bool = False) -> str | None:
        """Return what becomes of the top."""
        return "rises to the vertical in infinite time"

    @quantity
    def m(self) -> R:
        """The parameter k^2, which is 1."""
        return 0 * self.a + 1

    @quantity
    def nome(self) -> R:
        """The nome, which is 1."""
        return self.m

    @quantity
    def E(self) -> R:
        """The complete integral of the second kind, which is 1."""
        return self.m


Real = float | Decimal
Kind: TypeAlias = Nutating[R] | Steady[R] | Vertical[R] | Separatrix[R]
"""Any of the four."""


def kind_of(facts: Facts) -> type[Kind[Any]]:
    """Return the class of the motion that some facts describe."""
    if facts.regime in {Regime.SLEEPING, Regime.HANGING}:
        return Vertical
    if facts.steady:
        return Steady
    return Separatrix if facts.regime is Regime.SEPARATRIX else Nutating


def middle_of(kind: Any) -> Any:
    """Return a motion in decimals, from the middles of the balls of its start and its gaps."""
    middles = (type(x)(*(number.middle for number in x)) for x in (kind.state, kind.gaps))
    return type(kind)(kind.ar.middles, kind.facts, *middles)


def rate_parts(kind: Kind[R]) -> tuple[R, R, R]:
    """Return r0 - b, beta + b and beta - b, of which both rates are made (4,7), (4,8).

    On the vertical all of the rotation counts as spin.
    """
    if isinstance(kind, Vertical):
        return kind.r0, 0 * kind.r0, 0 * kind.r0
    return kind.state.pole_drift, kind.gaps.beta_plus_b, kind.gaps.beta_minus_b
