"""Tables of eta over tau (Aksenov section 3.2)."""

from __future__ import annotations

from collections.abc import Callable, Collection
from fractions import Fraction
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.balls import Balls, balls
from ..arithmetic.numbers import DOUBLES
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, Points, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Numeric
from ..arithmetic.rounding import Pair, decided, pair
from .complete import complete_k
from .eta import EtaConstants, Quadrature, eta_constants, modulus_in_use
from .jacobi import jacobi, jacobi_at
from .periods import whole_and_rest
from .tables import ProvedNumbers, TableOfFunctions

if TYPE_CHECKING:
    from .tables import Known


_CHAIN = ("h1", "theta", "xi_prime")
ETA_COLUMNS = ("tau", "eta", "etadot", *_CHAIN)
"""The columns; tau is always included."""


class EtaMotion(NamedTuple):
    """The constants of a motion of eta in its band."""

    constants: EtaConstants
    half_period: Numeric
    """2K of the modulus in use."""
    periods: Callable[[Numeric], tuple[Numeric, Numeric]]
    """Function of tau: periods since a passage of delta*, as whole periods and the rest."""


class EtaTable(TableOfFunctions):
    """Tables of eta, its rate, h1, theta and xi' over tau, with eta = delta* at tau = 0.

    Raises LagtopError as `Quadrature.check` does and, in doubles, for times beyond 2^50 periods.
    """

    def __init__(
        self,
        points: Points,
        quadrature: Quadrature,
        *,
        names: Collection[str] = ("eta",),
        angle: str = "deg",
    ) -> None:
        """Take the inputs; `names` are some of ETA_COLUMNS, `angle` is the unit, deg or rad."""
        super().__init__(points, points.count)
        self.quadrature, self.names, self.angle = quadrature, names, angle

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError unless the motion is periodic; see the class for doubles."""
        self.quadrature.check(doubles=doubles)

    def constants(self, ar: Balls) -> EtaMotion:
        """Return the motion in balls."""
        c = eta_constants(ar, self.quadrature)
        quarter = complete_k(ar, modulus_in_use(c, self.quadrature).k_prime)
        return EtaMotion(c, 2 * quarter, lambda tau: whole_and_rest(ar, tau / c.period)[:2])

    def rounded_constants(self) -> EtaMotion:
        """Return the motion in doubles; raise LagtopError for times beyond 2^50 periods."""
        from ..arithmetic.double_double import reduce_phase  # start-up

        def rounded(digits: int) -> tuple[EtaConstants, Pair]:
            exact = eta_constants(balls(digits), self.quadrature)
            return EtaConstants(*map(float, exact)), pair(1 / exact.period)

        c, rate = decided("the constants of eta", rounded)
        check_reach("tau", self.points, min(MAX_PERIODS * c.period, MAX_TIME))
        quarter = complete_k(DOUBLES, modulus_in_use(c, self.quadrature).k_prime)
        return EtaMotion(c, 2 * quarter, lambda tau: reduce_phase(tau, rate))

    def columns(
        self, ar: FunctionArithmetic, x: Numeric, constants: EtaMotion, known: Known
    ) -> dict[str, Numeric]:
        """Return tau, eta and the other columns of the table."""
        x = ar.convert(x)
        c, half_period, periods = constants
        turns, rest = periods(x)
        place = place_in_band(ar, half_period * rest, c, self.quadrature)
        columns = {"tau": x, "eta": place.eta}
        if "etadot" in self.names:
            columns["etadot"] = place.rate(ar, self.quadrature)
        if not set(_CHAIN).isdisjoint(self.names):
            columns |= chain(ar, (turns, rest), c, self.quadrature, self.angle)
        angle = f"theta_{self.angle}"
        chosen = {name: columns[name] for name in ETA_COLUMNS if name in {"tau", *self.names}}
        return {angle if name == "theta" else name: value for name, value in chosen.items()}

    def known(self, x: Fraction) -> dict[str, float]:
        """Return the columns that are exactly 0 at tau.

        h1 and theta vanish at no rational tau, because K is transcendental for algebraic k
        (Schneider 1937).
        """
        lower, still = self.quadrature.lower, self.quadrature.lower == self.quadrature.upper
        at_start = still or x == 0
        zero = {"tau": x == 0, "eta": at_start and not lower, "etadot": at_start}
        return {name: 0 for name, is_zero in zero.items() if is_zero}


def chain(
    ar: FunctionArithmetic,
    periods: tuple[Numeric, Numeric],
    c: EtaConstants,
    quadrature: Quadrature,
    unit: str,
) -> dict[str, Numeric]:
    """Return h1, theta and xi' at a time given in periods since a passage of delta*.

        h1 = sigma1 (tau + tau3) (3.2.10),  theta = am(h1, k1) (3.2.9),  xi' = sn(h1, k1) (3.2.11)

    `periods` are whole periods and the rest; theta has the unit deg or rad.  If k1 is imaginary,
    theta is am(v, kappa) - pi/2 and xi' is -cn(v, kappa), where v = 4K w/T.
    """
    turns, phase = periods
    half_turn = 180 if unit == "deg" else ar.pi
    shift = 0 if quadrature.height else 0.5
    x = whole_and_rest(ar, 2 * phase - shift)
    am, sn, cn, _ = jacobi_at(ar, x, modulus_in_use(c, quadrature))
    theta = (2 * turns + am / ar.pi - (0.5 - shift)) * half_turn
    h1 = c.sigma1 * c.period * (turns + phase - 0.25)
    return dict(zip(_CHAIN, (h1, theta, -cn if quadrature.height else sn), strict=True))


class PlaceInBand(NamedTuple):
    """The place of eta in its band, by its distances from both ends."""

    eta: Numeric
    risen: Numeric
    """eta - delta*."""
    left: Numeric
    """delta - eta."""
    falling: Numeric
    """Whether eta is returning to delta*."""

    def rate(self, ar: FunctionArithmetic, quadrature: Quadrature) -> Numeric:
        """Return d eta/d tau, the root of (3.2.1), from distances that keep their digits."""
        risen, left, (lower, upper, outer, g, height) = self.risen, self.left, quadrature
        if height:
            from_lower, from_upper = (ar.convert(end - outer[0]) for end in (lower, upper))
            apart = ar.where(ar.either(risen < left), from_lower + risen, from_upper - left)
            gaps = [ar.sqrt(apart * apart + ar.convert(height) * ar.convert(height))] * 2
        else:
            gaps = [ar.convert(lower - root) + risen for root in outer if root < lower]
            gaps += [ar.convert(root - upper) + left for root in outer if root > upper]
        size = prod(map(ar.sqrt, (ar.convert(g), risen, left, *gaps)))
        return ar.where(self.falling, -size, size)


def place_in_band(
    ar: FunctionArithmetic, v: Numeric, c: EtaConstants, quadrature: Quadrature
) -> PlaceInBand:
    """Return the place of eta at v = 2K w/T, where w is the time since a passage of delta*.

        (eta - delta*) : (delta - eta) = (sqrt(g) m'' sn v)^2 : (sigma1 cn v dn v)^2

    This ratio follows from (3.2.10) to (3.2.12) by halving the argument, and both distances keep
    their digits.  For a complex pair of roots it is m'' (sn v dn v)^2 : m' cn^2 v, with the modulus
    kappa.
    """
    _, sn, cn, dn = jacobi(ar, v, modulus_in_use(c, quadrature))
    lower, upper, _, g, height = quadrature
    if height:
        up, down = abs(ar.sqrt(c.m2) * sn * dn), abs(ar.sqrt(c.m1) * cn)
    else:
        up, down = abs(ar.sqrt(ar.convert(g)) * c.m2 * sn), abs(c.sigma1 * cn * dn)
    larger = ar.where(ar.either(up < down), down, up)  # so that no square leaves the range
    up, down, width = (up / larger) ** 2, (down / larger) ** 2, ar.convert(upper - lower)
    risen, left = width * up / (up + down), width * down / (up + down)
    lower_half = ar.either(risen < left)
    eta = ar.where(lower_half, ar.convert(lower) + risen, ar.convert(upper) - left)
    return PlaceInBand(eta, risen, left, sn * cn < 0)


def record(quadrature: Quadrature, digits: int | None = None) -> dict[str, Any]:
    """Return the roots and constants, correctly rounded to doubles or to `digits` digits.

    Raises LagtopError as `Quadrature.check` does.
    """
    quadrature.check(doubles=digits is None)
    zeros = dict.fromkeys(_zeros_of_record(quadrature), 0)
    return ProvedNumbers(digits).of(lambda ar: _record_in(ar, quadrature), zeros)


def _zeros_of_record(quadrature: Quadrature) -> set[str]:
    """Return the constants that are exactly 0."""
    square1, square2 = quadrature.squares
    upper, lower, outer = quadrature.upper, quadrature.lower, quadrature.outer
    opposite = square2 * upper**2 == square1 * lower**2
    exact = {
        "delta": upper,
        "delta_star": lower,
        "p": sum(outer),
        "q": outer[0] - outer[-1] if outer else 0,
        "outer_root": sum(outer),
        "d": square2 - square1,
        "s": not (opposite and upper * lower >= 0),
        "gamma": not (opposite and upper * lower <= 0),
        "k": (upper - lower) * (outer[0] - outer[1] if len(outer) > 1 else len(outer)),
    }
    if quadrature.height:
        exact["k_imag"] = upper - lower
    zeros = {name for name, x in exact.items() if not x}
    return zeros | {name.replace("k", "k1") for name in zeros & {"k", "k_imag"}}


def _record_in(ar: FunctionArithmetic, quadrature: Quadrature) -> dict[str, Any]:
    """Return the record in balls; None for keys that the layout does not have."""
    c, outer = eta_constants(ar, quadrature), quadrature.outer
    pair_of_roots, imaginary = len(outer) > 1, bool(quadrature.height)
    return {
        "delta": ar.convert(quadrature.upper),
        "delta_star": ar.convert(quadrature.lower),
        "p": ar.convert((outer[0] + outer[-1]) / 2) if pair_of_roots else None,
        "q": ar.convert(abs(outer[0] - outer[1]) / 2) if pair_of_roots and not imaginary else None,
        "q_imag": ar.convert(quadrature.height) if imaginary else None,
        "outer_root": ar.convert(outer[0]) if len(outer) == 1 else None,
        "g": ar.convert(quadrature.g),
        "layout": quadrature.layout,
        "kind": quadrature.kind,
        "m_prime": c.m1,
        "m_double_prime": c.m2,
        "k": None if imaginary else c.k,
        "k_imag": c.k if imaginary else None,
        "k1": None if imaginary else c.k1,
        "k1_imag": c.k1 if imaginary else None,
        "k1_prime": c.k1_prime,
        "K1": c.period * c.sigma1 / 4,
        "sigma1": c.sigma1,
        "s": c.s,
        "d": c.d,
        "gamma": c.gamma,
        "period": c.period,
        "tau3": -c.period / 4,
    }
