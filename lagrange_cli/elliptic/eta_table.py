"""Tables of eta over tau, in doubles or to any number of digits."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.doubles import DOUBLES
from ..arithmetic.many_digits import ManyDigits
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Value
from .complete import complete_k
from .eta import Band, EtaConstants, band_of, eta_and_rate, eta_constants, modulus_in_use
from .jacobi import jacobi_at
from .periods import whole_and_rest
from .proved_digits import require_digits, settled_texts
from .quadrature import Quadrature

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..arithmetic.text import NumberText
    from ..arithmetic.types import Array

HEADER = ["tau", "eta", "etadot"]


def header(unit: str = "") -> list[str]:
    """Return the names of the columns; with h1, theta and xi' where theta has a unit."""
    return [*HEADER, *(("h1", f"theta_{unit}", "xi_prime") if unit else ())]


def chain(
    ar: FunctionArithmetic, periods: tuple[Value, Value], c: EtaConstants, band: Band, unit: str
) -> tuple[Value, Value, Value]:
    """Return h1, theta and xi' so many periods, whole ones and a rest, after a passage of delta*.

    h1 = sigma1 (tau + tau3) (3.2.10), theta = am(h1, k1) (3.2.9), in the unit deg or rad, and
    xi' = sn(h1, k1) (3.2.11).  Where k1 is imaginary theta is am(v, kappa) - pi/2 and xi' is
    -cn(v, kappa), v = 4K w/T.
    """
    turns, phase = periods
    half_turn = 180 if unit == "deg" else ar.pi
    shift = 0 if band.pair else 0.5
    x = whole_and_rest(ar, 2 * phase - shift)
    am, sn, cn, _ = jacobi_at(ar, x, modulus_in_use(c, band))
    theta = (2 * turns + am / ar.pi - (0.5 - shift)) * half_turn
    h1 = c.sigma1 * c.period * (turns + phase - 0.25)
    return h1, theta, (-cn if band.pair else sn)


def rows(quadrature: Quadrature, times: Points, c3: Fraction, unit: str = "") -> Iterator[Array]:
    """Return blocks of rows of the columns of `header`; eta = delta* at tau = -c3.

    Raises LagtopError as `Quadrature.check_doubles` does, and for times beyond 2^50 periods.
    """
    import numpy as np

    from ..arithmetic.double_double import reduce_phase
    from ..arithmetic.sums_of_doubles import pair

    quadrature.check_doubles()
    exact = ManyDigits()
    exactly = eta_constants(exact, quadrature)
    rate = pair(1 / exactly.period)
    offset = exact.convert(c3) / exactly.period
    whole = exact.nint(offset)
    shift = float(offset - whole)
    c, band = EtaConstants(*map(float, exactly)), band_of(ARRAYS, quadrature)
    check_reach("tau", times, min(MAX_PERIODS * c.period, MAX_TIME))
    half_period = 2 * complete_k(DOUBLES, float(modulus_in_use(c, band).k_prime))

    def block(tau: Array) -> Array:
        with np.errstate(all="ignore"):  # squares of small numbers may leave the doubles
            turns, since = reduce_phase(tau, rate, shift)
            columns = [tau, *eta_and_rate(ARRAYS, half_period * (since + shift), c, band)]
            if unit:
                columns += chain(ARRAYS, (turns + float(whole), since + shift), c, band, unit)
        return np.stack(columns, axis=1) + 0.0  # no -0

    return (block(tau) for tau in times.blocks())


def digit_rows(
    quadrature: Quadrature, times: Points, c3: Fraction, digits: int, unit: str = ""
) -> Iterator[list[NumberText]]:
    """Return rows of the columns of `header` to so many significant digits.

    h1 and theta vanish at no rational tau: K is transcendental for algebraic k (Schneider 1937).
    Raises LagtopError as `Quadrature.check` does.
    """
    quadrature.check()
    still = quadrature.lower == quadrature.upper
    names = header(unit)

    def at(tau: Fraction) -> list[NumberText]:
        def compute(ar: ManyDigits) -> dict[str, Value]:
            c, time = eta_constants(ar, quadrature), ar.convert(tau + c3)
            require_digits(ar, digits, abs(time / c.period))
            band = band_of(ar, quadrature)
            turns, phase, _ = whole_and_rest(ar, time / c.period)
            quarter = complete_k(ar, modulus_in_use(c, band).k_prime)
            values = [ar.convert(tau), *eta_and_rate(ar, 2 * quarter * phase, c, band)]
            if unit:
                values += chain(ar, (turns, phase), c, band, unit)
            return dict(zip(names, values, strict=True))

        at_start = still or tau + c3 == 0
        zero = {"tau": tau == 0, "eta": at_start and not quadrature.lower, "etadot": at_start}
        known = [name for name, is_zero in zero.items() if is_zero]
        return list(settled_texts(compute, digits, known).values())

    return (at(tau) for tau in times.decimals())
