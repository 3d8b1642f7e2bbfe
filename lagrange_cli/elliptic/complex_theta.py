"""Theta and Zeta functions of complex arguments and of any modulus (Chrapan section 1).

In the cell of the origin, where |x| and |y| are at most 1/2, the series run in the smaller of the
two nomes.  For k <= k' this is the nome of tau, and the terms grow with y.  For larger k it is the
nome of -1/tau (Jacobi's imaginary transformation), and the terms grow with x.  So one coordinate is
a height, along which a series is a sum of exponentials, and the other is a phase.

From cell to cell, theta functions change by factors that are exponentials of polynomials.  These
factors are written out.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arithmetic.complex_balls import complex_balls
from ..arithmetic.numbers import in_arithmetic
from ..arithmetic.protocol import ComplexArithmetic, Numeric
from ..arithmetic.rounding import decided
from .any_modulus import ModulusKind, reduced_modulus
from .modulus import Modulus, in_many_digits
from .periods import (
    Complex,
    Fine,
    Lattice,
    Place,
    check_index,
    coarse,
    coordinate_of,
    fine_whole,
    lattice,
    negligible,
    place_of,
)

_OTHER_NAMES = {
    ModulusKind.UNIT: {},
    ModulusKind.IMAGINARY: {"01": "00", "00": "01"},
    ModulusKind.LARGE: {"10": "00", "00": "10"},
}
"""The function of the reduced modulus that replaces each function, if the index differs."""


def inner_name(ij: str, kind: ModulusKind) -> str:
    """Return the index of the function of the reduced modulus in [0, 1] that replaces ij.

    Raises LagtopError for indices other than 01, 00, 11 and 10.
    """
    check_index(ij)
    return _OTHER_NAMES[kind].get(ij, ij)


def rises(ij: str, periods: Lattice) -> bool:
    """Return whether the terms of a series are exponentials of odd multiples of the height."""
    return ij[0 if periods.circular else 1] == "1"


@in_arithmetic
def complex_theta(ar: ComplexArithmetic, ij: str, v: Complex, periods: Lattice) -> Complex:
    """Return Theta_ij(v) for complex v."""
    return theta_at_place(ar, ij, place_of(ar, v, periods), periods)


@in_arithmetic
def complex_zeta(ar: ComplexArithmetic, ij: str, v: Complex, periods: Lattice) -> Complex:
    """Return Z_ij(v), the derivative of log Theta_ij(v), for complex v."""
    return zeta_at_place(ar, ij, place_of(ar, v, periods), periods)


def theta_of_modulus(ar: ComplexArithmetic, ij: str, x: Complex, modulus: Modulus) -> Complex:
    """Return theta_ij(x, iK'/K) for complex x and one modulus between 0 and 1."""
    periods = _lattice_of(ar, modulus)
    parts = ar.re(x), ar.im(x) / periods.ratio
    if ar.is_array:
        from ..arithmetic.double_double import DoubleDouble  # start-up

        parts = DoubleDouble(parts[0]), DoubleDouble(parts[1])
    at = Place(*(coordinate_of(ar, part) for part in parts))
    return theta_at_place(ar, ij, at, periods)


def zeta_of_modulus(ar: ComplexArithmetic, ij: str, v: Complex, modulus: Modulus) -> Complex:
    """Return Z_ij(v) for complex v and one modulus between 0 and 1."""
    return complex_zeta(ar, ij, v, _lattice_of(ar, modulus))


def _lattice_of(ar: ComplexArithmetic, modulus: Modulus) -> Lattice:
    """Return the periods of a modulus in [0, 1]; for arrays, rounded from balls."""
    if not ar.is_array:
        return lattice(ar, reduced_modulus(ar, ModulusKind.UNIT, modulus))

    def rounded(digits: int) -> Lattice:
        many = complex_balls(digits)
        exact = reduced_modulus(many, ModulusKind.UNIT, in_many_digits(many, modulus))
        return lattice(many, exact).rounded()

    return decided("the periods of the modulus", rounded)


def theta_at_place(ar: ComplexArithmetic, ij: str, at: Place, periods: Lattice) -> Complex:
    """Return Theta_ij at a place."""
    inner, T = inner_name(ij, periods.given.kind), periods.ratio
    (r, s), (X, Y) = ((c.rest for c in at), map(fine_whole, at))
    parity = at.x.whole * (inner[0] == "1") + at.y.whole * (inner[1] == "1")
    turn = ar.mpc(1, 0) / (1 if periods.circular else ar.sqrt(T))
    size = abs(s if periods.circular else r)
    odd = rises(inner, periods)
    if periods.circular:
        rise = size - 0.25 if odd else 0 * r
        square, half_turns = Y * (Y + s * 2), Y * r * -2
    else:
        rise = -((0.5 - size) * (0.5 - size)) if odd else -(r * r)
        square, half_turns = (Y + s) * (Y + s), r * (Y + s) * -2
    if periods.given.kind is ModulusKind.LARGE:
        whole = X + r + Y + s
        bent = whole * whole * periods.bend
        square = bent - s * s if periods.circular else bent
        half_turns = s * (s + (X + Y) * 2 + (r * 2 if periods.circular else 0)) - bent
        parity = parity + at.y.whole
        turn = turn * ar.sqrt(ar.mpc(1, -T))
    if ij in _EIGHTH[periods.given.kind]:
        turn = turn * ar.mpc(1, 1) / ar.sqrt(2)
    growth = rise * periods.steepness + square * periods.lift
    angle = ar.pi * 2 * coarse(coordinate_of(ar, half_turns * 0.5).rest)
    wave = ar.mpc(ar.cos(angle), ar.sin(angle)) * (1 - 2 * (parity % 2))
    value = wave * (turn * base_at(ar, inner, at, periods).value)
    rest = growth - coarse(growth)
    return value * (1 + coarse(rest)) * ar.exp(coarse(growth))


_EIGHTH = {
    ModulusKind.UNIT: (),
    ModulusKind.IMAGINARY: ("11", "10"),
    ModulusKind.LARGE: ("11", "01"),
}
"""Functions that gain an eighth of a turn if tau + 1 or tau/(1 - tau) replaces tau."""


def zeta_at_place(ar: ComplexArithmetic, ij: str, at: Place, periods: Lattice) -> Complex:
    """Return Z_ij at a place."""
    inner, T = inner_name(ij, periods.given.kind), periods.ratio
    real, imag = 0 * at.x.whole, at.y.whole
    if periods.given.kind is ModulusKind.LARGE:
        bent = (at.x.total() + at.y.total()) / (1 + T * T)
        real, imag = 2 * ar.pi * T * bent, bent - coarse(at.y.rest)
    slope = slope_in_cell(ar, inner, at, periods)
    return (slope + ar.mpc(real, -2 * ar.pi * imag)) * coarse(periods.given.scale)


def slope_in_cell(ar: ComplexArithmetic, inner: str, at: Place, periods: Lattice) -> Complex:
    """Return d log theta/dz at the rests of a place, where z is the argument in periods."""
    slope = base_at(ar, inner, at, periods).slope
    if periods.circular:
        return slope
    real, imag = coarse(at.x.rest), coarse(at.y.rest)
    return slope - ar.mpc(2 * coarse(periods.steepness) * real, 2 * ar.pi * imag)


def base_at(ar: ComplexArithmetic, inner: str, at: Place, periods: Lattice) -> Base:
    """Return the series of theta_ij at the rests of a place."""
    x, y, t = at.x.rest, at.y.rest, coarse(periods.steepness)
    if periods.circular:
        base = cell_series(ar, inner, x, abs(y), t)
        return base.mirrored(ar, coarse(y) < 0)
    value, slope = cell_series(ar, inner[1] + inner[0], abs(y), abs(x), t)
    base = Base(value, slope).mirrored(ar, coarse(x) > 0)
    turn = ar.mpc(0, 1) if inner == "11" else 1
    base = Base(turn * base.value, ar.mpc(0, -1 / periods.ratio) * base.slope)
    return base.mirrored(ar, coarse(y) < 0)


class Base(NamedTuple):
    """The value of a series, and its logarithmic derivative with respect to z."""

    value: Complex
    slope: Complex

    def mirrored(self, ar: ComplexArithmetic, where: Numeric) -> Base:
        """Return the series of the conjugate argument where a condition holds."""
        return self.chosen(ar, where, Base(ar.conj(self.value), ar.conj(self.slope)))

    def chosen(self, ar: ComplexArithmetic, where: Numeric, other: Base) -> Base:
        """Return the `other` series where a condition holds, and this one elsewhere."""
        return Base(*(ar.where(where, b, a) for a, b in zip(self, other, strict=True)))


def cell_series(ar: ComplexArithmetic, ij: str, phase: Fine, height: Fine, t: Numeric) -> Base:
    """Return theta_ij at z = phase + i height t/pi, with the nome exp(-t), and its slope.

    For 11 and 10, return q^(-1/4) exp(-t height) theta_ij.  Requires t >= pi, a phase within 1/2,
    and a height from 0 to 1/2.

    Each function has one zero in this range.  Next to it, the series of sines that vanishes at 0
    gives the value, so that all values keep their digits.
    """
    if ij == "11":
        return _sines(ar, coarse(phase), coarse(height), t)
    if ij == "10":
        return _cosines(ar, phase, coarse(height), t)
    low = ar.either(coarse(height) < 0.25)
    near_0 = ar.where(low, coarse(height), 0 * coarse(height))
    plain = _series(ar, coarse(phase), near_0, t, alternating=ij[1] == "1")
    beyond = coarse(0.5 - height)
    rest = _sines(ar, coarse(phase), beyond, t) if ij == "01" else _cosines(ar, phase, beyond, t)
    rest = rest.mirrored(ar, True)  # half a period tau back: theta01 is then exp(-i pi z) theta11
    angle = ar.pi * coarse(phase)
    turn = ar.mpc(ar.cos(angle), -ar.sin(angle)) * (ar.mpc(0, 1) if ij == "01" else 1)
    return Base(turn * rest.value, rest.slope - ar.mpc(0, ar.pi)).chosen(ar, low, plain)


def _cosines(ar: ComplexArithmetic, phase: Fine, height: Numeric, t: Numeric) -> Base:
    """Return the series of theta10; next to its zero, theta11 half a period away."""
    here = coarse(phase)
    middle = ar.either(abs(here) < 0.25)
    left = here < 0
    there = ar.where(left, coarse(0.5 + phase), coarse(0.5 - phase))
    value, slope = _sines(ar, there, height, t)
    beside = Base(ar.conj(value), -ar.conj(slope)).chosen(ar, left, Base(value, slope))
    plain = _series(ar, ar.where(middle, here, 0 * here), height, t, odd=True)
    return beside.chosen(ar, middle, plain)


def _sines(ar: ComplexArithmetic, phase: Numeric, height: Numeric, t: Numeric) -> Base:
    """Return the series of theta11."""
    return _series(ar, phase, height, t, odd=True, sines=True)


def _series(
    ar: ComplexArithmetic, phase: Numeric, height: Numeric, t: Numeric, **which: bool
) -> Base:
    """Return a sum of `sums_in_cell` and its logarithmic derivative."""
    value, slope = sums_in_cell(ar, phase, height, t, **which)
    if not ar.is_array and ar.either(abs(value) == 0):
        return Base(value, ar.mpc(ar.inf, 0))
    return Base(value, slope / value)


def sums_in_cell(
    ar: ComplexArithmetic,
    phase: Numeric,
    height: Numeric,
    t: Numeric,
    *,
    odd: bool = False,
    sines: bool = False,
    alternating: bool = False,
) -> tuple[Complex, Complex]:
    """Return 1 + 2 sum (+-1)^n q^(n^2) cos 2n pi z, and its slope, for a height up to 1/4.

    For an odd function, return 2 sum q^(n (n + 1)) cos (2n + 1) pi z over exp(t height).  With
    `sines`, cosines become sines, and signs alternate.  Heights are then from -1/20 to 11/20.

    Let m be the order, 2n or 2n + 1.  A sine is at most m times the first sine, and `apart` at most
    m times its first factor.  So a left-out term of the slope is at most these two first factors
    times 2 pi m^3 exp(-t (n - 1/2)^2).  Each is less than half of the one before.
    """
    real, imag, slope_real, slope_imag = 0 * phase if odd else 1 + 0 * phase, *[0 * phase] * 3
    first, terms = 1 if odd else 2, _terms(ar)
    for order in range(first, 2 * terms, 2):
        n, rate = order // 2, order * ar.pi
        near = (-1) ** (n * (sines or alternating)) * ar.exp(-(t * n) * (n + odd - 2 * height))
        drop = ar.expm1(-2 * order * t * height)
        both, apart = near * (2 + drop), -near * drop
        wave, other = ar.sin(rate * phase), ar.cos(rate * phase)
        if not sines:
            wave, other = other, -wave
        real, imag = real + both * wave, imag + apart * other
        slope_real = slope_real + rate * (both * other)
        slope_imag = slope_imag - rate * (apart * wave)

    def widened(x: Numeric, sine: bool, apart: bool) -> Numeric:
        def left_out() -> tuple[Numeric, ...]:
            rest = 13 * (2 * terms + 1) ** 3 * ar.exp(-t * (terms - 0.5) ** 2)
            sines = [ar.sin(first * ar.pi * phase)] * sine
            return rest, *sines, *[ar.expm1(-2 * first * t * height)] * apart

        return ar.widened(x, left_out, lambda *sizes: math.prod(sizes), values_only=True)

    value = ar.mpc(widened(real, sines, False), widened(imag, not sines, True))
    return value, ar.mpc(widened(slope_real, not sines, False), widened(slope_imag, sines, True))


def _terms(ar: ComplexArithmetic) -> int:
    """Return the number n of terms needed; the last is at most exp(-pi (n - 1/2)^2)."""
    return 2 + math.ceil(math.sqrt(negligible(ar) / math.pi))
