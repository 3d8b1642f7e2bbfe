"""Arguments counted in periods 2K: whole ones, and a rest that keeps its digits.

Next to a pole of a Zeta function, or far from zero, all that matters is the rest; so 1/(2K) is held
as a sum of three doubles, and the rest as a sum of two.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.protocol import FunctionArithmetic, Value

if TYPE_CHECKING:  # NumPy is loaded for arrays only
    from ..arithmetic.sums_of_doubles import Triple
    from ..arithmetic.types import Array

Complex = Value
"""A real or complex number, or array, of the arithmetic in use."""


class Periods(NamedTuple):
    """An argument in periods: whole ones and the rest, its real part within half of one."""

    turns: Value
    rest: Complex
    low: Value = 0.0
    """What rounding took from the rest (real arrays only)."""

    def half_further(self, ar: FunctionArithmetic) -> Periods:
        """Return the place half a period further on."""
        forward = ar.either(ar.re(self.rest) < 0)
        if not ar.is_array:
            return Periods(self.turns + (not forward), self.rest + (0.5 if forward else -0.5))
        half, turns = ar.where(forward, 0.5, -0.5), self.turns + ar.where(forward, 0.0, 1.0)
        if is_real_array(ar, self.rest):
            from ..arithmetic.double_double import two_sum

            rest, low = two_sum(self.rest, half)
            return Periods(turns, rest + (low + self.low))
        return Periods(turns, self.rest + half)


def whole_and_rest(ar: FunctionArithmetic, x: Complex) -> Periods:
    """Return a number of periods as whole ones and the rest."""
    real = ar.re(x)
    turns = ar.nint(real)
    return Periods(turns, x - turns)


def of_quarters(ar: FunctionArithmetic, factor: Value) -> Periods:
    """Return a real multiple of K in periods 2K; that of an array is exact up to 2^52 K."""
    return whole_and_rest(ar, factor / 2)


def reduced(u: Array, rate: Triple) -> Periods:
    """Return real arguments in periods by the rate 1/(2K), for |u| up to 1e290."""
    import numpy as np

    from ..arithmetic.double_double import two_product, two_sum

    u, high, middle, low = np.broadcast_arrays(np.asarray(u, dtype=float), *rate)
    product, error = two_product(u, high)
    second, second_error = two_product(u, middle)
    turns = product.round()
    total, first_rest = two_sum(product - turns, error)
    total, second_rest = two_sum(total, second)
    rest, low = two_sum(total, first_rest + (second_rest + (second_error + u * low)))
    more = rest.round()
    rest, low = two_sum(rest - more, low)
    return Periods(turns + more, rest, low)


def is_real_array(ar: FunctionArithmetic, x: Complex) -> bool:
    """Return whether x is an array of real numbers, whose rests have two doubles."""
    if not ar.is_array:
        return False
    import numpy as np

    return bool(np.isrealobj(x))
