"""Jacobi's am, sn, cn, dn of complex arguments and of any modulus.

By the addition theorem (DLMF 22.8(i), 22.6.1) they are products and sums of like signs of the
functions of the real part, of modulus k, and of the imaginary part, of modulus k'; nothing cancels.
An imaginary modulus takes those of the real part a quarter of a period further on; a modulus above
1 lets cn and dn change places.
"""

from __future__ import annotations

from ..arithmetic.formulas import in_arithmetic
from ..arithmetic.protocol import ComplexArithmetic, Value
from ..arithmetic.sums_of_doubles import triple
from .any_modulus import AnyModulus, ModulusKind
from .complete import complete_k
from .jacobi import Jacobi, jacobi, jacobi_at
from .modulus import Modulus
from .periods import Complex, reduced


@in_arithmetic
def complex_jacobi(ar: ComplexArithmetic, u: Complex, given: AnyModulus) -> Jacobi:
    """Return am, sn, cn, dn of complex numbers u; arrays take the digits of one modulus in context.

    am is not a number beyond its branch points, which are the poles next to the real axis: for a
    modulus in [0, 1] where |Im u| > K'.  am is unwrapped for k < 1 and imaginary k; for k > 1 its
    real part stays within a quarter of a turn.
    """
    k, k_prime, _ = given.modulus
    inner = (k, k_prime) if not ar.is_array else (float(k), float(k_prime))
    real, _ = _real(ar, ar.re(u), given.modulus, given.stretch)
    other, turns = _real(ar, ar.im(u), Modulus(k_prime, k), given.stretch)
    result = _combined(ar, real, other, given.kind, inner)
    return result._replace(am=ar.where(turns == 0, result.am, ar.mpc(ar.nan, ar.nan)))


def _real(
    ar: ComplexArithmetic, u: Value, modulus: Modulus, stretch: Value
) -> tuple[Jacobi, Value]:
    """Return the functions of real numbers times a factor, and the whole periods in these."""
    k, k_prime, _ = modulus
    rate = stretch / (2 * complete_k(k.context, k_prime)) if k_prime else 0 * k
    if not ar.is_array:
        return jacobi(ar, stretch * u, modulus), ar.nint(rate * u)
    if not rate:
        return jacobi(ar, u, Modulus(float(k), float(k_prime))), 0 * u
    x = reduced(u, triple(rate))
    return jacobi_at(ar, x, Modulus(float(k), float(k_prime))), x.turns


def _combined(
    ar: ComplexArithmetic,
    real: Jacobi,
    other: Jacobi,
    kind: ModulusKind,
    inner: tuple[Value, Value],
) -> Jacobi:
    """Return the functions from those of the real part and of the imaginary part."""
    k, k_prime = inner
    am, s, c, d = real
    _, s1, c1, d1 = other
    if kind is ModulusKind.IMAGINARY:
        s, c, d = c / d, -k_prime * s / d, k_prime / d
    slant, ratio = k * s * s1, d1 / c1
    lift = slant / c1
    below = c1 + lift * slant  # all over cn of the imaginary part
    sn = ar.mpc(s * ratio, c * d * s1) / below
    cn = ar.mpc(c, -s * d * s1 * ratio) / below
    dn = ar.mpc(d * d1, -k * c * lift) / below
    size = ar.sqrt(c1 * c1 + slant * slant)
    if kind is ModulusKind.IMAGINARY:
        angle = _near(ar, ar.atan2(-c * c1, s * d1), am)
        return Jacobi(ar.mpc(angle, ar.asinh(d * s1 / size)), -cn, sn, dn / k_prime)
    if kind is ModulusKind.LARGE:
        angle, rise = ar.atan2(k * s, d * c1), k * c * s1 / size
        return Jacobi(ar.mpc(angle, ar.asinh(rise)), k * sn, dn, cn)
    angle = _near(ar, ar.atan2(s * d1, c * c1), am)
    return Jacobi(ar.mpc(angle, ar.asinh(d * s1 / size)), sn, cn, dn)


def _near(ar: ComplexArithmetic, angle: Value, am: Value) -> Value:
    """Return an angle with the whole turns that take it next to am of the real part."""
    return angle + 2 * ar.pi * ar.nint((am - angle) / (2 * ar.pi))
