"""The theta series at a phase and a height, z = phase + i height t/pi, with the nome exp(-t).

t is at least pi, the phase within 1/2, and the height from 0 to 1/2.  Each function has one zero
there, next to which it is read from the series of sines that vanishes at 0; so all values keep
their digits.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arithmetic.protocol import ComplexArithmetic, Value
from .lattice import Fine, coarse
from .periods import Complex, negligible


class Base(NamedTuple):
    """The value of a series, and the derivative of its logarithm by z."""

    value: Complex
    slope: Complex

    def mirrored(self, ar: ComplexArithmetic, where: Value) -> Base:
        """Return the series of the conjugate argument where a condition holds."""
        return self.chosen(ar, where, Base(ar.conj(self.value), ar.conj(self.slope)))

    def chosen(self, ar: ComplexArithmetic, where: Value, other: Base) -> Base:
        """Return another one where a condition holds."""
        return Base(*(ar.where(where, b, a) for a, b in zip(self, other, strict=True)))


def cell_series(ar: ComplexArithmetic, ij: str, phase: Fine, height: Fine, t: Value) -> Base:
    """Return theta_ij for 01 and 00, and q^(-1/4) exp(-t height) theta_ij for 11 and 10."""
    if ij == "11":
        return _sines(ar, coarse(phase), coarse(height), t)
    if ij == "10":
        return _cosines(ar, phase, coarse(height), t)
    low = coarse(height) < 0.25
    near_0 = ar.where(low, coarse(height), 0 * coarse(height))
    plain = _even(ar, coarse(phase), near_0, t, alternating=ij[1] == "1")
    beyond = coarse(0.5 - height)
    rest = _sines(ar, coarse(phase), beyond, t) if ij == "01" else _cosines(ar, phase, beyond, t)
    rest = rest.mirrored(ar, True)  # half a period tau back: theta01 is then exp(-i pi z) theta11
    angle = ar.pi * coarse(phase)
    turn = ar.mpc(ar.cos(angle), -ar.sin(angle)) * (ar.mpc(0, 1) if ij == "01" else 1)
    return Base(turn * rest.value, rest.slope - ar.mpc(0, ar.pi)).chosen(ar, low, plain)


def _cosines(ar: ComplexArithmetic, phase: Fine, height: Value, t: Value) -> Base:
    """Return the series of theta10; next to its zero as theta11 half a period away."""
    here = coarse(phase)
    middle = abs(here) < 0.25
    left = here < 0
    there = ar.where(left, coarse(0.5 + phase), coarse(0.5 - phase))
    value, slope = _sines(ar, there, height, t)
    beside = Base(ar.conj(value), -ar.conj(slope)).chosen(ar, left, Base(value, slope))
    plain = _odd(ar, ar.where(middle, here, 0 * here), height, t, sines=False)
    return beside.chosen(ar, middle, plain)


def _sines(ar: ComplexArithmetic, phase: Value, height: Value, t: Value) -> Base:
    """Return the series of theta11."""
    return _odd(ar, phase, height, t, sines=True)


def _odd(ar: ComplexArithmetic, phase: Value, height: Value, t: Value, *, sines: bool) -> Base:
    """Return 2 sum (-1)^n q^(n (n + 1)) sin (2n + 1) pi z, over exp(t height), and its slope.

    Without `sines`: the sum of cosines without the signs.
    """
    real = imag = slope_real = slope_imag = 0 * phase
    for n in range(_terms(ar)):
        near = (-1) ** (n * sines) * ar.exp(-(t * n) * (n + 1 - 2 * height))
        drop, rate = ar.expm1(-(4 * n + 2) * t * height), (2 * n + 1) * ar.pi
        both, apart = near * (2 + drop), -near * drop
        sine, cosine = ar.sin(rate * phase), ar.cos(rate * phase)
        across = both * sine, apart * cosine
        along = both * cosine, -apart * sine
        if not sines:
            across, along = along, (-across[0], -across[1])
        real, imag = real + across[0], imag + across[1]
        slope_real, slope_imag = slope_real + rate * along[0], slope_imag + rate * along[1]
    value = ar.mpc(real, imag)
    if not ar.is_array and not value:
        return Base(value, ar.mpc(ar.inf, 0))
    return Base(value, ar.mpc(slope_real, slope_imag) / value)


def _even(
    ar: ComplexArithmetic, phase: Value, height: Value, t: Value, *, alternating: bool
) -> Base:
    """Return 1 + 2 sum (+-1)^n q^(n^2) cos 2 n pi z, and its slope, for a height up to 1/4."""
    real, imag, slope_real, slope_imag = 1 + 0 * phase, 0 * phase, 0 * phase, 0 * phase
    for n in range(1, _terms(ar)):
        near = (-1) ** (n * alternating) * ar.exp(-(t * n) * (n - 2 * height))
        drop, rate = ar.expm1(-4 * n * t * height), 2 * n * ar.pi
        both, apart = near * (2 + drop), -near * drop
        sine, cosine = ar.sin(rate * phase), ar.cos(rate * phase)
        real, imag = real + both * cosine, imag - apart * sine
        slope_real, slope_imag = (
            slope_real - rate * (both * sine),
            slope_imag - rate * (apart * cosine),
        )
    value = ar.mpc(real, imag)
    return Base(value, ar.mpc(slope_real, slope_imag) / value)


def _terms(ar: ComplexArithmetic) -> int:
    """Return how many terms matter, of which the last is at most exp(-pi (n - 1/2)^2)."""
    return 2 + math.ceil(math.sqrt(negligible(ar) / math.pi))
