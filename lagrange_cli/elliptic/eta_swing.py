"""Where eta is in its band, and how fast it moves, from sn, cn and dn (Aksenov section 3.2)."""

from __future__ import annotations

from math import prod
from typing import NamedTuple

from ..arithmetic.protocol import FunctionArithmetic, Value
from .eta import Band, EtaConstants, modulus_in_use
from .jacobi import jacobi


class Swing(NamedTuple):
    """Where eta is in its band."""

    eta: Value
    risen: Value
    """eta - delta*."""
    left: Value
    """delta - eta."""
    falling: Value
    """Whether eta is on its way back to delta*."""

    def rate(self, ar: FunctionArithmetic, band: Band) -> Value:
        """Return d eta/d tau, the root of (3.2.1) from distances that keep their digits."""
        risen, left = self.risen, self.left
        gaps = [gap + risen for gap in band.below] + [gap + left for gap in band.above]
        if band.pair:
            from_lower, from_upper, height = band.pair
            apart = ar.where(ar.either(risen < left), from_lower + risen, from_upper - left)
            gaps = [ar.sqrt(apart * apart + height * height)] * 2
        size = prod(map(ar.sqrt, (band.g, risen, left, *gaps)))
        return ar.where(self.falling, -size, size)


def swing(ar: FunctionArithmetic, v: Value, c: EtaConstants, band: Band) -> Swing:
    """Return the place of eta where v = 2K w/T, w the time since a passage of delta*.

    eta - delta* : delta - eta = (sqrt(g) m'' sn v)^2 : (sigma1 cn v dn v)^2, which is (3.2.10) to
    (3.2.12) after a halving of the argument: both distances keep their digits.  Of a complex pair
    of roots it is m'' (sn v dn v)^2 : m' cn^2 v of the modulus kappa.
    """
    _, sn, cn, dn = jacobi(ar, v, modulus_in_use(c, band))
    if band.pair:
        up, down = abs(ar.sqrt(c.m2) * sn * dn), abs(ar.sqrt(c.m1) * cn)
    else:
        up, down = abs(ar.sqrt(band.g) * c.m2 * sn), abs(c.sigma1 * cn * dn)
    larger = ar.where(ar.either(up < down), down, up)  # so that no square leaves the range
    up, down = (up / larger) ** 2, (down / larger) ** 2
    risen, left = band.width * up / (up + down), band.width * down / (up + down)
    eta = ar.where(ar.either(risen < left), band.lower + risen, band.upper - left)
    return Swing(eta, risen, left, sn * cn < 0)
