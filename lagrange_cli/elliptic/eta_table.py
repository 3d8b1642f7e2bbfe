"""Tables of eta over tau, in doubles or to any number of digits."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.ball_functions import BallFunctions, ball_functions
from ..arithmetic.doubles import DOUBLES
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Value
from ..arithmetic.rounding import decided
from ..arithmetic.sums_of_doubles import Pair, pair
from .complete import complete_k
from .eta import Band, EtaConstants, band_of, eta_constants, modulus_in_use
from .eta_swing import swing
from .jacobi import jacobi_at
from .periods import whole_and_rest
from .proved_numbers import ProvedNumbers
from .quadrature import Quadrature

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..arithmetic.text import NumberText
    from ..arithmetic.types import Array


class Wanted(NamedTuple):
    """What a table has beside tau and eta."""

    rate: bool = False
    """Whether it has d eta/d tau."""
    unit: str = ""
    """The unit of theta, deg or rad, where it has h1, theta and xi'; else nothing."""


TAU_AND_ETA = Wanted()


def header(wanted: Wanted) -> list[str]:
    """Return the names of the columns."""
    rate = ["etadot"] if wanted.rate else []
    return [
        "tau",
        "eta",
        *rate,
        *(("h1", f"theta_{wanted.unit}", "xi_prime") if wanted.unit else ()),
    ]


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


def rows(
    quadrature: Quadrature, times: Points, c3: Fraction, wanted: Wanted = TAU_AND_ETA
) -> Iterator[Array]:
    """Return blocks of rows of the columns of `header`; eta = delta* at tau = -c3.

    Raises LagtopError as `Quadrature.check_doubles` does, and for times beyond 2^50 periods.
    """
    import numpy as np

    from ..arithmetic.double_double import reduce_phase

    quadrature.check_doubles()

    def constants(digits: int) -> tuple[EtaConstants, Pair, int, float]:
        ar = ball_functions(digits)
        exact = eta_constants(ar, quadrature)
        offset = ar.convert(c3) / exact.period
        whole = ar.nint(offset)
        c = EtaConstants(*map(float, exact))
        return c, pair(1 / exact.period), whole, float(offset - whole)

    c, rate, whole, shift = decided("the constants of eta", constants)
    band = band_of(ARRAYS, quadrature)
    check_reach("tau", times, min(MAX_PERIODS * c.period, MAX_TIME))
    half_period = 2 * complete_k(DOUBLES, float(modulus_in_use(c, band).k_prime))

    def block(tau: Array) -> Array:
        with np.errstate(all="ignore"):  # squares of small numbers may leave the doubles
            turns, since = reduce_phase(tau, rate, shift)
            place = swing(ARRAYS, half_period * (since + shift), c, band)
            columns = [tau, place.eta]
            if wanted.rate:
                columns.append(place.rate(ARRAYS, band))
            if wanted.unit:
                phase = turns + float(whole), since + shift
                columns += chain(ARRAYS, phase, c, band, wanted.unit)
        return np.stack(columns, axis=1) + 0.0  # no -0

    return (block(tau) for tau in times.blocks())


def digit_rows(
    quadrature: Quadrature, times: Points, c3: Fraction, wanted: Wanted, digits: int
) -> Iterator[list[NumberText]]:
    """Return rows of the columns of `header` to so many significant digits.

    h1 and theta vanish at no rational tau: K is transcendental for algebraic k (Schneider 1937).
    Raises LagtopError as `Quadrature.check` does.
    """
    quadrature.check()
    still = quadrature.lower == quadrature.upper
    names, numbers = header(wanted), ProvedNumbers(digits)

    @cache
    def constants(ar: BallFunctions) -> tuple[EtaConstants, Band]:
        return eta_constants(ar, quadrature), band_of(ar, quadrature)

    def at(tau: Fraction) -> list[NumberText]:
        def compute(ar: BallFunctions) -> dict[str, Value]:
            (c, band), time = constants(ar), ar.convert(tau + c3)
            turns, phase, _ = whole_and_rest(ar, time / c.period)
            quarter = complete_k(ar, modulus_in_use(c, band).k_prime)
            place = swing(ar, 2 * quarter * phase, c, band)
            values = [ar.convert(tau), place.eta]
            if wanted.rate:
                values.append(place.rate(ar, band))
            if wanted.unit:
                values += chain(ar, (turns, phase), c, band, wanted.unit)
            return dict(zip(names, values, strict=True))

        at_start = still or tau + c3 == 0
        zero = {"tau": tau == 0, "eta": at_start and not quadrature.lower, "etadot": at_start}
        known = {name: 0 for name, is_zero in zero.items() if is_zero}
        return list(numbers.texts(compute, known).values())

    return (at(tau) for tau in times.decimals())
