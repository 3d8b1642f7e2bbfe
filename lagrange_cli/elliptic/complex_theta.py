"""Theta and Zeta functions of complex arguments and of any modulus (Chrapan section 1).

In the cell of the origin, |x| and |y| within 1/2, the series run in the smaller of the two nomes:
for k <= k' in that of tau, and their terms grow with y; else by Jacobi's imaginary transformation
in that of -1/tau, and their terms grow with x.  So one coordinate is a height, along which a series
is a sum of exponentials, and the other one a phase.  The factors by which theta functions change
from cell to cell are exponentials of polynomials, which are written out.
"""

from __future__ import annotations

from ..arithmetic.double_double import DoubleDouble
from ..arithmetic.numbers import in_arithmetic
from ..arithmetic.protocol import ComplexArithmetic
from ..errors import LagtopError
from .any_modulus import AnyModulus, ModulusKind
from .cell_series import Base, cell_series
from .lattice import Fine, Lattice, Place, coarse, coordinate_of, fine_whole, lattice, place_of
from .many_digits import ManyDigits
from .modulus import Modulus, in_many_digits
from .periods import NAMES, Complex

_OTHER_NAMES = {
    ModulusKind.UNIT: {},
    ModulusKind.IMAGINARY: {"01": "00", "00": "01"},
    ModulusKind.LARGE: {"10": "00", "00": "10"},
}
"""The function of the modulus in [0, 1] that one of another modulus is read from."""


def inner_name(ij: str, kind: ModulusKind) -> str:
    """Return the function of the modulus in [0, 1] that ij of a kind of modulus is read from.

    Raises LagtopError for other indices than 01, 00, 11 and 10.
    """
    if ij not in NAMES:
        raise LagtopError(f"ij must be 01, 00, 11 or 10, got {ij}", "ij")
    return _OTHER_NAMES[kind].get(ij, ij)


def rises(ij: str, periods: Lattice) -> bool:
    """Return whether the terms of a series are exponentials of odd multiples of the height."""
    return ij[0 if periods.circular else 1] == "1"


@in_arithmetic
def complex_theta(ar: ComplexArithmetic, ij: str, v: Complex, periods: Lattice) -> Complex:
    """Return Theta_ij(v) of complex numbers v."""
    return theta_at_place(ar, ij, place_of(ar, v, periods), periods)


@in_arithmetic
def complex_zeta(ar: ComplexArithmetic, ij: str, v: Complex, periods: Lattice) -> Complex:
    """Return Z_ij(v), the derivative of log Theta_ij(v), of complex numbers v."""
    return zeta_at_place(ar, ij, place_of(ar, v, periods), periods)


def theta_of_modulus(ar: ComplexArithmetic, ij: str, x: Complex, modulus: Modulus) -> Complex:
    """Return theta_ij(x, iK'/K) of complex x, for one modulus between 0 and 1."""
    periods = _lattice_of(ar, modulus)
    parts = ar.re(x), ar.im(x) / periods.ratio
    if ar.is_array:
        parts = DoubleDouble(parts[0]), DoubleDouble(parts[1])
    at = Place(*(coordinate_of(ar, part) for part in parts))
    return theta_at_place(ar, ij, at, periods)


def zeta_of_modulus(ar: ComplexArithmetic, ij: str, v: Complex, modulus: Modulus) -> Complex:
    """Return Z_ij(v) of complex v, for one modulus between 0 and 1."""
    return complex_zeta(ar, ij, v, _lattice_of(ar, modulus))


def _lattice_of(ar: ComplexArithmetic, modulus: Modulus) -> Lattice:
    """Return the periods of a modulus in [0, 1], for arrays rounded from many digits."""
    if not ar.is_array:
        return lattice(ar, AnyModulus(ModulusKind.UNIT, modulus))
    many = ManyDigits()
    exact = in_many_digits(many, modulus)
    return lattice(many, AnyModulus(ModulusKind.UNIT, exact)).rounded(ar)


def theta_at_place(ar: ComplexArithmetic, ij: str, at: Place, periods: Lattice) -> Complex:
    """Return Theta_ij at a place."""
    inner, T = inner_name(ij, periods.kind), periods.ratio
    (r, s), (X, Y) = ((c.rest for c in at), map(fine_whole, at))
    parity = at.x.whole * (inner[0] == "1") + at.y.whole * (inner[1] == "1")
    turn = ar.mpc(1, 0) / (1 if periods.circular else ar.sqrt(T))
    size = fine_size(s if periods.circular else r)
    odd = rises(inner, periods)
    if periods.circular:
        rise = size - 0.25 if odd else 0 * r
        square, half_turns = Y * (Y + s * 2), Y * r * -2
    else:
        rise = -((0.5 - size) * (0.5 - size)) if odd else -(r * r)
        square, half_turns = (Y + s) * (Y + s), r * (Y + s) * -2
    if periods.kind is ModulusKind.LARGE:
        whole = X + r + Y + s
        bent = whole * whole * periods.bend
        square = bent - s * s if periods.circular else bent
        half_turns = s * (s + (X + Y) * 2 + (r * 2 if periods.circular else 0)) - bent
        parity = parity + at.y.whole
        turn = turn * ar.sqrt(ar.mpc(1, -T))
    if ij in _EIGHTH[periods.kind]:
        turn = turn * ar.mpc(1, 1) / ar.sqrt(2)
    growth = rise * periods.steep + square * periods.lift
    angle = ar.pi * 2 * coarse(coordinate_of(ar, half_turns * 0.5).rest)
    wave = ar.mpc(ar.cos(angle), ar.sin(angle)) * (1 - 2 * (parity % 2))
    value = wave * (turn * base_at(ar, inner, at, periods).value)
    rest = growth - _as_fine(growth)
    return ar.exp(coarse(growth)) * (value * (1 + coarse(rest)))


def _as_fine(x: Fine) -> Fine:
    """Return the leading part of a number."""
    return DoubleDouble(x.high) if isinstance(x, DoubleDouble) else x


_EIGHTH = {
    ModulusKind.UNIT: (),
    ModulusKind.IMAGINARY: ("11", "10"),
    ModulusKind.LARGE: ("11", "01"),
}
"""The functions that are turned by an eighth, where tau is one unit further or tau/(1 - tau)."""


def zeta_at_place(ar: ComplexArithmetic, ij: str, at: Place, periods: Lattice) -> Complex:
    """Return Z_ij at a place."""
    inner, T = inner_name(ij, periods.kind), periods.ratio
    real, imag = 0 * at.x.whole, at.y.whole
    if periods.kind is ModulusKind.LARGE:
        bent = (at.x.total() + at.y.total()) / (1 + T * T)
        real, imag = 2 * ar.pi * T * bent, bent - coarse(at.y.rest)
    slope = slope_in_cell(ar, inner, at, periods)
    return periods.scale * (slope + ar.mpc(real, -2 * ar.pi * imag))


def slope_in_cell(ar: ComplexArithmetic, inner: str, at: Place, periods: Lattice) -> Complex:
    """Return d log theta by the argument in periods, at the rests of a place."""
    slope = base_at(ar, inner, at, periods).slope
    if periods.circular:
        return slope
    real, imag = coarse(at.x.rest), coarse(at.y.rest)
    return slope - ar.mpc(2 * periods.steepness * real, 2 * ar.pi * imag)


def base_at(ar: ComplexArithmetic, inner: str, at: Place, periods: Lattice) -> Base:
    """Return the series of theta_ij at the rests of a place."""
    x, y, t = at.x.rest, at.y.rest, periods.steepness
    if periods.circular:
        base = cell_series(ar, inner, x, fine_size(y), t)
        return base.mirrored(ar, coarse(y) < 0)
    value, slope = cell_series(ar, inner[1] + inner[0], fine_size(y), fine_size(x), t)
    base = Base(value, slope).mirrored(ar, coarse(x) > 0)
    turn = ar.mpc(0, 1) if inner == "11" else 1
    base = Base(turn * base.value, ar.mpc(0, -1 / periods.ratio) * base.slope)
    return base.mirrored(ar, coarse(y) < 0)


def fine_size(x: Fine) -> Fine:
    """Return the size of a coordinate."""
    if not isinstance(x, DoubleDouble):
        return abs(x)
    sign = 1.0 - 2.0 * (x.high < 0)
    return DoubleDouble(sign * x.high, sign * x.low)
