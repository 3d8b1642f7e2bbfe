"""Omega and Pi (Chrapan sections 2 and 3) of complex arguments and parameters and of any modulus.

    Omega_ij(eta, v) = log[Theta_ij(eta - v)/Theta_ij(eta + v)]/2,   Pi_ij = eta Z_ij(v) + Omega_ij

Chrapan leaves the branch of the logarithm open, and his equations hold modulo i pi.  Here the
branch of log Theta_ij(z) is fixed by the following conditions.

- It is continuous on each side of the lines of zeros: Im z = 2nK' for 11 and 10, Im z = (2n + 1)K'
  for 01 and 00.
- It is continuous on the imaginary axis, where a zero turns it by half a turn.
- Its values at conjugate z are conjugate.
- On a line of zeros it is the mean of both sides.

Real and imaginary parameters then have the values that `third_kind` gives.  For k > 1 this is the
branch of the modulus 1/k.

Apart from a series close to 1, log Theta is a sum of polynomials in the coordinates of eta and v.
Their difference is written out, so that nothing cancels.  The growth of both functions over the
periods is computed once, in many digits.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arithmetic.numbers import in_arithmetic
from ..arithmetic.protocol import ComplexArithmetic, Numeric
from .any_modulus import ModulusKind
from .complex_theta import base_at, inner_name, rises, slope_in_cell
from .periods import Complex, Fine, Lattice, Place, coarse, fine_whole, place_of


class Parameter(NamedTuple):
    """A parameter v and the constants of Omega_ij and Pi_ij, in many digits or in doubles."""

    ij: str
    v: Complex
    periods: Lattice
    at: Place
    slope: Complex
    """d log theta/dz at v, of the series and its height alone; z is the argument in periods."""
    along: Complex
    """Growth of Pi when eta grows by 2K, without half turns."""
    up: Complex
    """Growth of Pi when eta grows by 2iK', without half turns."""
    turns: Numeric
    """The half turns that `along` leaves out, so that it is small if they cancel."""
    side: int
    """Sign of the height of v if the slope leaves out the rise of the series with it; else 0."""

    def rounded(self) -> Parameter:
        """Return the parameter with its constants in doubles, for use with arrays."""
        import numpy as np

        from ..arithmetic.arrays import ARRAYS  # start-up

        periods = self.periods.rounded()
        return self._replace(
            periods=periods,
            at=place_of(ARRAYS, np.array([complex(self.v)]), periods),  # equal parts agree
            slope=complex(self.slope),
            along=complex(self.along),
            up=complex(self.up),
        )


def parameter(ar: ComplexArithmetic, ij: str, v: Complex, periods: Lattice) -> Parameter:
    """Return Omega_ij and Pi_ij of a parameter, with constants in balls or an mpmath context.

    At the pole of Z_ij (v = 0 for the function 11) the constants of Pi are NaN.
    """
    at = place_of(ar, v, periods)
    inner = inner_name(ij, periods.given.kind)
    r, s = at.x.rest, at.y.rest
    height = s if periods.circular else r
    if inner == "11" and not (r or s):
        none = complex(math.nan, math.nan)
        return Parameter(ij, v, periods, at, none, none, none, 0, 0)
    whole = slope_in_cell(ar, inner, at, periods)
    t, T = periods.steepness, periods.ratio
    bell = ar.mpc(0, 0) if periods.circular else ar.mpc(2 * t * r, 2 * ar.pi * s)
    rise = ar.mpc(0, ar.pi) if periods.circular else ar.mpc(-t, 0)
    side = int(ar.sign(height)) if rises(inner, periods) else 0
    if ar.either(abs(whole + bell) < abs(whole + bell + side * rise)):
        side = 0  # next to v = 0, where the rises on both sides cancel
    slope = whole + bell + side * rise
    up = ar.mpc(0, T) * whole + ar.mpc(-T * s, r) * (2 * ar.pi)
    turns = int(ar.nint(ar.im(whole) / ar.pi))
    along = whole - ar.mpc(0, turns * ar.pi)
    return Parameter(ij, v, periods, at, slope, along, up, turns, side)


@in_arithmetic
def complex_omega(ar: ComplexArithmetic, eta: Complex, given: Parameter) -> Complex:
    """Return Omega_ij(eta, v) for complex eta."""
    return omega_at(ar, place_of(ar, eta, given.periods), given)


@in_arithmetic
def complex_pi(ar: ComplexArithmetic, eta: Complex, given: Parameter) -> Complex:
    """Return Pi_ij(eta, v) for complex eta; NaN if it has a pole for every eta."""
    return pi_at(ar, place_of(ar, eta, given.periods), given)


def omega_at(ar: ComplexArithmetic, at: Place, given: Parameter) -> Complex:
    """Return Omega_ij at a place."""
    T, v, u = given.periods.ratio, given.at, at.within()
    cell = _Cell(ar, u, given)
    (r, s), (a, b) = at.coarse_rests(), v.coarse_rests()
    height, other = (u.y, v.y) if given.periods.circular else (u.x, v.x)
    bends = given.periods.given.kind is ModulusKind.LARGE
    rise, turns = cell.rise, cell.half_turns(ar, at)
    if bends or not given.periods.circular:
        rise = rise + 2 * (height.rest * other.rest)
    real, imag = coarse(given.periods.steepness) * coarse(rise), cell.phase
    if not given.periods.circular:
        imag = imag + 2 * (r * b + s * a)
        real = real - 2 * ar.pi * T * s * b * (0 if bends else 1)
    if bends:
        x, y, V, W = (end.exactly() for end in (*at, *v))
        share = (x + y) * (V + W) * given.periods.bend
        real = coarse(rise * given.periods.steepness - share * given.periods.lift * 2)
        waves = y * W + x * v.y.rest + at.y.rest * V - share
        imag = imag - 2 * coarse(waves)
    else:
        real = real - 2 * ar.pi * T * (at.y.whole * v.y.total() + s * v.y.whole)
        turns = turns + 2 * (v.y.whole * at.x.whole + at.y.whole * v.x.whole)
        imag = imag + 2 * (v.y.whole * r + at.y.whole * a)
    return cell.logarithm + ar.mpc(real, ar.pi * (imag + turns))


def pi_at(ar: ComplexArithmetic, at: Place, given: Parameter) -> Complex:
    """Return Pi_ij at a place."""
    T, t, u = given.periods.ratio, coarse(given.periods.steepness), at.within()
    cell = _Cell(ar, u, given)
    r, s = at.coarse_rests()
    height = (u.y if given.periods.circular else u.x).rest
    rise = cell.rise + given.side * height
    phase = cell.phase + given.side * (-r if given.periods.circular else s)
    turns = cell.half_turns(ar, at) + 2 * given.at.x.whole * at.y.whole + given.turns * at.x.whole
    within = ar.mpc(t * coarse(rise), ar.pi * (phase + turns))
    within = within + (ar.mpc(r, T * s) * given.slope + cell.logarithm)
    return at.x.whole * given.along + (at.y.whole * given.up + within)


class _Cell:
    """The parts of log Theta(u - v) - log Theta(u + v), for u and v less whole periods."""

    rise: Fine
    """Half the difference of the heights, in units of the steepness."""
    phase: Numeric
    """Half the difference of the phases, in half turns."""
    logarithm: Complex
    """Half the difference of the logarithms of the series."""

    def __init__(self, ar: ComplexArithmetic, u: Place, given: Parameter) -> None:
        periods, v = given.periods, given.at
        self.inner = inner_name(given.ij, periods.given.kind)
        self.given = given
        self.places = less, more = u.shifted(ar, v, -1), u.shifted(ar, v, 1)
        ends = [place_.y if periods.circular else place_.x for place_ in self.places]
        steps = [(whole := fine_whole(end)) * (end.rest * 2 + whole) for end in ends]
        rise = (steps[0] - steps[1]) * 0.5
        if rises(self.inner, periods):
            rise = rise + (abs(ends[0].rest) - abs(ends[1].rest)) * 0.5
        self.rise = rise
        if periods.circular:
            here = [coarse(u.x.rest - v.x.rest), coarse(u.x.rest + v.x.rest)]
            self.phase = more.y.whole * here[1] - less.y.whole * here[0]
        else:
            self.phase = less.x.whole * coarse(less.y.rest) - more.x.whole * coarse(more.y.rest)
        values = [base_at(ar, self.inner, end, periods).value for end in self.places]
        angles = [self._angle(ar, z, end) for z, end in zip(values, self.places, strict=True)]
        size = ar.log(abs(values[0]) / abs(values[1]))
        self.logarithm = ar.mpc(size, angles[0] - angles[1]) / 2

    def _angle(self, ar: ComplexArithmetic, value: Complex, at: Place) -> Numeric:
        """Return the angle of the series at a place; on a line of zeros, the mean of both sides."""
        angle = ar.atan2(ar.im(value), ar.re(value))
        if self.inner == "11":  # from -pi/2 to 3 pi/2 above the line of zeros
            side = ar.where(coarse(at.y.rest) < 0, -1, 1)
            angle = side * (ar.atan2(-ar.re(value), side * ar.im(value)) + ar.pi / 2)
        if self.inner[0] == "1":
            angle = ar.where(coarse(at.y.rest) == 0, 0 * angle, angle)
        return angle

    def half_turns(self, ar: ComplexArithmetic, at: Place) -> Numeric:
        """Return the half turns of the difference, including the whole periods of u and v."""
        (less, more), v = self.places, self.given.at
        turns = more.y.whole * (at.x.whole + v.x.whole) - less.y.whole * (at.x.whole - v.x.whole)
        twice = 2 * turns
        if self.inner[1] == "1":
            twice = twice + (less.y.whole - more.y.whole) - 2 * v.y.whole
        if self.inner[0] == "1":
            sides = [ar.sign(coarse(end.y.rest)) for end in (less, more)]
            across = sides[0] * (less.x.whole + at.x.whole - v.x.whole)
            twice = twice - (across - sides[1] * (more.x.whole + at.x.whole + v.x.whole))
        return ar.convert(twice) / 2
