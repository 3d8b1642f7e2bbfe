"""Real arguments counted in periods 2K: whole ones, and a rest that keeps its digits.

Next to a pole of a Zeta function, or far from zero, all that matters is the rest; so 1/(2K) is held
as a sum of three doubles, and the rest as a sum of two.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.protocol import FunctionArithmetic, Value

if TYPE_CHECKING:  # NumPy is loaded for arrays only
    from ..arithmetic.rounding import Triple
    from ..arithmetic.types import Array

NAMES = ("01", "00", "11", "10")
"""The indices of the four theta functions, in the order of the sources."""

Complex = Value
"""A real or complex number, or array, of the arithmetic in use."""


class Periods(NamedTuple):
    """A real argument in periods: whole ones and the rest, which is within half of one."""

    turns: Value
    rest: Value
    low: Value = 0.0
    """What rounding took from the rest (arrays only)."""

    def half_further(self, ar: FunctionArithmetic) -> Periods:
        """Return the place half a period further on."""
        forward = ar.either(self.rest < 0)
        if not ar.is_array:
            return Periods(self.turns + (not forward), self.rest + (0.5 if forward else -0.5))
        from ..arithmetic.double_double import two_sum

        rest, low = two_sum(self.rest, ar.where(forward, 0.5, -0.5))
        return Periods(self.turns + ar.where(forward, 0.0, 1.0), rest + (low + self.low))


def whole_and_rest(ar: FunctionArithmetic, x: Value) -> Periods:
    """Return a real number of periods as whole ones and the rest."""
    turns = ar.nint(x)
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


def negligible(ar: FunctionArithmetic) -> float:
    """Return -log of the largest number that does not matter beside 1."""
    magnitude: float = ar.magnitude
    return 2.0 - math.log(10) * magnitude


def is_complex(ar: FunctionArithmetic, x: Complex) -> bool:
    """Return whether a number or an array has an imaginary part."""
    return bool(ar.anywhere(ar.im(x) != 0))


def each_alone(
    ar: FunctionArithmetic, function: Callable[..., Value], x: Value, *constants: Value
) -> Value:
    """Return a function of arrays that broadcast, evaluated once for each set of constants."""
    if not ar.is_array:
        return function(x, *constants)
    import numpy as np

    x, *others = np.broadcast_arrays(x, *constants)
    values = np.zeros(x.shape, dtype=np.result_type(float, x, *others))
    for these in set(zip(*(part.ravel() for part in others), strict=True)):
        same = np.all([part == one for part, one in zip(others, these, strict=True)], axis=0)
        values[same] = function(x[same], *these)
    return values
