"""Complete elliptic integrals and the nome; the place of a point in a period.

The methods are the arithmetic-geometric mean and Landen's descending transformation (DLMF 22.7(i)),

    sn(u, k) = (1 + l) sn(u/(1 + l), l)/(1 + l sn^2(u/(1 + l), l)),    l = k^2/(1 + k')^2.

The transformation keeps the place u/K and squares the nome, so l falls quickly, until sn is a sine.
Every loop only adds and multiplies positive numbers, so each result is good to a few eps, even next
to a zero.  Points are given by numbers s2 : c2 = sn^2 : cn^2, with any common factor.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..arithmetic.numbers import R, in_arithmetic, power, root_of_epsilon

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic


@in_arithmetic
def agm(ar: Arithmetic[R], a: R | int, b: R) -> R:
    """Return the arithmetic-geometric mean M of a > 0 and b > 0 (DLMF 19.8.1).

    The error of the last step is (a + b)/2 - M.  With x = (a - b)/(a + b), 2 M/(a + b) is pi/2K(x)
    (DLMF 19.8.5).  The powers of x^2 in 2K/pi have logarithmically convex coefficients, so the
    coefficients of its inverse are negative from the second on (Kaluza 1928).  As M = 0 at x = 1,
    the sizes of these coefficients add up to 1.  None is larger than the same coefficient of x^2/(1
    - x^2), which therefore bounds the error and its derivatives.
    """
    tolerance = ar.sqrt(ar.eps)
    while ar.anywhere(abs(a - b) > tolerance * a):
        a, b = (a + b) / 2, ar.sqrt(a * b)
    total = a + b
    return ar.widened(
        total / 2,
        lambda: ((a - b) / total, total),
        lambda x, total: total * (x * x / (2 * (1 - x * x))),
    )


@in_arithmetic
def complete_k(ar: Arithmetic[R], k_prime: R) -> R:
    """Return the quarter period K = F(pi/2, k) from the complement k' in (0, 1] (DLMF 19.8.5)."""
    return ar.pi / (2 * agm(ar, 1, k_prime))


@in_arithmetic
def period_mean(ar: Arithmetic[R], k_prime: R, p: R | int, a: R | int, b: R | int) -> R:
    """Return the mean over a period of (a cn^2 + b sn^2)/(cn^2 + p sn^2).

    k' and p are positive; a and b are not negative.  Bulirsch's complete integral cel(k', p, a, b)
    is K times this mean (DLMF 19.2.11), so that

        E = K period_mean(k', 1, 1, k'^2),    R_J(0, k'^2, 1, p) = 3 K period_mean(k', p, 0, 1).

    Each step is Bartky's transformation (Bulirsch 1969).  It keeps the mean, over a quarter turn of
    z and with the weight M/sqrt(m^2 c^2 + g^2 s^2), of

        R = (a m^2 c^2 + b p s^2)/(m^2 c^2 + p^2 s^2),    c = cos z,  s = sin z,

    where M is the agm of m and g.  The last step uses the weight 1, for which the mean of R is (a m
    + b)/(m + p).

    The error of the last step is bounded as follows.  Let x = (m - g)/(m + g).  The weight is
    pi/2K(x) (see `agm`) times the sum of P_n(-cos 2z) x^n (DLMF 18.12.11).  It is therefore 1 plus
    powers of x.  Their coefficients are at most those of 1/(1 - x)^2 - 1, and so of 2 x/(1 - 2 x).
    As R is not negative, the error is at most 2 x/(1 - 2 x) times its mean.

    The derivatives of the two terms of R by log(p/m) are at most twice and once the terms
    themselves.  The powers of `ratio` in the bound express this.
    """
    tolerance = ar.sqrt(ar.eps)
    mean, geometric, p = k_prime * 0 + 1, k_prime, ar.sqrt(p)
    b = b / p
    close = False
    while not close:
        product = mean * geometric
        quotient = product / p
        a, b = (a + b / p) / 2, (b + a * quotient) / 2
        p = (p + quotient) / 2
        close = not ar.anywhere(abs(mean - geometric) > tolerance * mean)
        mean, geometric = (mean + geometric) / 2, ar.sqrt(product)

    def small() -> tuple[R, ...]:
        ratio, apart = p / mean, (mean - geometric) / (mean + geometric)
        changes = ratio / ar.fixed(ratio), mean / ar.fixed(mean)
        return apart, a + 0 * mean, b + 0 * mean, ar.fixed(mean), ar.fixed(1 / (mean + p)), *changes

    def bound(*sizes: R) -> R:
        x, a, b, mean, share, ratio, size = sizes
        return 2 * x / (1 - 2 * x) * share * ratio * (a * mean * ratio + b * size)

    return ar.widened((a * mean + b) / (mean + p), small, bound)


@in_arithmetic
def complete_e(ar: Arithmetic[R], k_prime: R) -> R:
    """Return the complete integral of the second kind, E = E(pi/2, k), from k' in (0, 1]."""
    return complete_k(ar, k_prime) * period_mean(ar, k_prime, 1, 1, k_prime * k_prime)


@in_arithmetic
def nome(ar: Arithmetic[R], *, m: R, k_prime: R) -> R:
    """Return the nome q = exp(-pi K'/K) of m = k^2 < 1, equation (2,4), to a few eps.

    The exponential would lose log(1/q) digits if q is small.  Instead, each step of the AGM of (1,
    k') squares the nome, until the series q = e + 2 e^5 + 15 e^9 ... (DLMF 19.5.5) is short.

    The series leaves out powers of e whose coefficients are at most those of (2 e)^21/(1 - 2 e).
    With e = k^(1/2)(q^4)/2 and dq/dm = q/(m theta4(q)^4) (DLMF 20.9.2, 22.2), it solves

        e dq/de = q/theta4(q^4)^4,    1/theta4 = (1 + q)(1 + q^2).../(1 - q)(1 - q^2)...

    The powers of 1/theta4 have no negative coefficients.  Comparing powers of e on both sides, one
    after the other, shows that q(e) has none either.  As q(1/2) = 1, no coefficient of e^n is
    larger than 2^n.
    """
    tolerance = 2 * root_of_epsilon(ar, 20910, 20)
    a, b = (1 + k_prime) / 2, ar.sqrt(k_prime)
    c, squarings = m / (4 * a), []
    while ar.anywhere(c > tolerance * a):
        far = c > tolerance * a
        squarings.append(far)
        mean = (a + b) / 2
        a, b = ar.where(far, mean, a), ar.where(far, ar.sqrt(a * b), b)
        c = ar.where(far, c * (c / (4 * mean)), c)
    e = c / (2 * (a + b))
    e4 = (e * e) * (e * e)
    q = e * (1 + e4 * (2 + e4 * (15 + e4 * (150 + e4 * 1707))))
    q = ar.widened(q, lambda: (2 * e,), lambda double: power(double, 21) / (1 - double))
    for far in reversed(squarings):
        q = ar.where(far, ar.sqrt(q), q)
    return q


@in_arithmetic
def place(ar: Arithmetic[R], *, m: R, k_prime: R, sn: R, cn2: R) -> R:
    """Return x = pi u/2K from sn(u, k) and cn^2(u, k), for -K <= u <= K and m = k^2 < 1.

    Legendre's F(phi, k) is 2K x/pi, with sn = sin phi and cn2 = cos^2 phi.

    The error of the last step, x - am u, is bounded as follows.  Let S_j be the integral of
    sin^(2j), and b_j <= 1 its mean.  Then F(am u, m) = 2K x/pi is the sum of b_j m^j S_j(am u).
    The error is therefore pi/2K times the sum of b_j m^j p_j.  The slope of p_j = S_j(phi) - b_j
    phi is at most 1.  The powers of m in pi/2K have coefficients of at most those of 1/(1 - m) (see
    `agm`). Hence phi m/(1 - m)^2 bounds the error and its derivatives by phi and m, and so does phi
    m/(1 - 2 m).
    """
    m, factor, cn2 = _descended(ar, m, k_prime, cn2)
    amplitude = ar.atan2(sn / factor, ar.sqrt(cn2))
    return ar.widened(amplitude, lambda: (amplitude, m), lambda phi, m: phi * (m / (1 - 2 * m)))


@in_arithmetic
def first_kind(ar: Arithmetic[R], *, m: R, k_prime: R, sn: R, cn2: R) -> R:
    """Return Legendre's F(phi, k) from sin phi, cos^2 phi and m = k^2, for |phi| <= pi/2.

    Arrays use Carlson's R_F (DLMF 19.25.5), which has smaller rounding errors.  In many digits it
    would take a hundred times as many steps.
    """
    if ar.is_array:
        from .carlson import carlson_rf  # start-up

        integral: R = carlson_rf(ar, cn2, cn2 + k_prime * k_prime * (sn * sn), 0 * cn2 + 1)
        return sn * integral
    return 2 * complete_k(ar, k_prime) * place(ar, m=m, k_prime=k_prime, sn=sn, cn2=cn2) / ar.pi


@in_arithmetic
def cosine_and_sine(ar: Arithmetic[R], *, m: R, k_prime: R, s2: R, c2: R) -> tuple[R, R]:
    """Return cos x and sin x for x = pi u/2K, where sn^2(u, k) : cn^2(u, k) = s2 : c2.

    The domain is 0 <= u <= K and m = k^2 < 1.

    The error follows from the series of the amplitude (DLMF 22.16.9),

        am u - x = sum over n >= 1 of 2 q^n sin(2 n x)/(n (1 + q^(2n))).

    Here q <= m, since q/m is 1 at m = 1 and its powers of m have no negative coefficients.  As
    |sin(2 n x)| <= n |sin 2x|, am u is within 4 q/(1 - q) |sin x cos x| of x.  The relative errors
    of both results are then at most 4 m/(1 - 5 m).
    """
    m, factor, last = _descended(ar, m, k_prime, c2 / (s2 + c2))

    def widened(x: R) -> R:
        return ar.widened(
            x, lambda: (x, m), lambda x, m: x * (4 * m / (1 - 5 * m)), values_only=True
        )

    return widened(ar.sqrt(last)), widened(ar.sqrt(s2 / (s2 + c2)) / factor)


def _descended(ar: Arithmetic[R], m: R, k_prime: R, cn2: R) -> tuple[R, R, R]:
    """Return m, the total divisor of sn, and cn^2 after steps that take m below eps^2."""
    factor = 0 * cn2 + 1
    falling = True
    while falling:
        small = m / ((1 + k_prime) * (1 + k_prime))
        one_less = 2 * k_prime / (1 + k_prime)
        root = ar.sqrt(one_less * one_less + 4 * small * cn2)
        divisor = (1 + small + root) / 2
        cn2 = (1 + small) * cn2 * (1 + 2 * small / (root + one_less)) / (divisor * divisor)
        factor = factor * divisor
        m, k_prime = small * small, 2 * ar.sqrt(k_prime) / (1 + k_prime)
        falling = ar.anywhere(small > ar.eps)
    return m, factor, cn2


@in_arithmetic
def hyperbolic_cosine_and_sine(ar: Arithmetic[R], *, m: R, k_prime: R, s2: R, c2: R) -> tuple[R, R]:
    """Return cosh y and sinh y for y = pi v/2K, where sn^2(v, k') : cn^2(v, k') = s2 : c2.

    The domain is 0 <= v <= K' and m = k^2 < 1.  The transformation is applied at imaginary u = iv,
    where sn(iv, k) = i sc(v, k').

    With am(iv, k) = i p, the series of `cosine_and_sine` gives

        0 <= p - y <= 2 q sinh(2 y)/(1 - q e^(2 y)),

    as sinh(2 n y) <= n sinh(2 y) e^(2 (n - 1) y).  Since y <= p and e^(2 p) <= 4 C^2 with C = cosh
    p, the relative errors of both results are at most

        4 m C^2/(1 - 4 m C^2).
    """
    falling = True
    while falling:
        small = m / ((1 + k_prime) * (1 + k_prime))
        root = ar.sqrt((1 + small) * (1 + small) * c2 + 4 * small * s2)
        divisor = ((1 + small) * ar.sqrt(c2) + root) / 2
        s2, c2 = s2 / (divisor * divisor), 0 * s2 + 1
        m, k_prime = small * small, 2 * ar.sqrt(k_prime) / (1 + k_prime)
        falling = ar.anywhere(small * (1 + s2) > ar.eps)

    def widened(x: R) -> R:
        part = 4 * m * (1 + s2)
        return ar.widened(
            x, lambda: (x, part), lambda x, part: x * (part / (1 - part)), values_only=True
        )

    return widened(ar.sqrt(1 + s2)), widened(ar.sqrt(s2))
