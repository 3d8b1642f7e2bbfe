"""Complete elliptic integrals and the nome; the place of a point in a period.

Balls take the functions of Arb.  The loops serve arrays of doubles and of pairs of doubles.  Each
loop only adds and multiplies positive numbers, so its result is good to a few eps, even next to a
zero.  They are the arithmetic-geometric mean and Landen's descending transformation (DLMF 22.7(i)),

    sn(u, k) = (1 + l) sn(u/(1 + l), l)/(1 + l sn^2(u/(1 + l), l)),    l = k^2/(1 + k')^2.

The transformation keeps the place u/K and squares the nome, so l falls quickly, until sn is a sine.
Points are given by numbers s2 : c2 = sn^2 : cn^2, with any common factor.
"""

from __future__ import annotations

from ..arithmetic.ball import Balls
from ..arithmetic.numbers import Arithmetic, R, in_arithmetic, root_of_epsilon
from .carlson import carlson_rf


@in_arithmetic
def agm(ar: Arithmetic[R], a: R | int, b: R) -> R:
    """Return the arithmetic-geometric mean of a > 0 and b > 0 (DLMF 19.8.1)."""
    if isinstance(ar, Balls):
        return ar.agm(a, b)
    tolerance = ar.sqrt(ar.eps)
    while ar.anywhere(abs(a - b) > tolerance * a):
        a, b = (a + b) / 2, ar.sqrt(a * b)
    return (a + b) / 2


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
    + b)/(m + p).  The weight lies between g/m and m/g, and so does the error of a ball.
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
    value = (a * mean + b) / (mean + p)
    apart = geometric / mean
    return ar.between(value * apart, value / apart) if isinstance(ar, Balls) else value


@in_arithmetic
def complete_e(ar: Arithmetic[R], k_prime: R) -> R:
    """Return the complete integral of the second kind, E = E(pi/2, k), from k' in (0, 1]."""
    return complete_k(ar, k_prime) * period_mean(ar, k_prime, 1, 1, k_prime * k_prime)


@in_arithmetic
def nome(ar: Arithmetic[R], *, m: R, k_prime: R) -> R:
    """Return the nome q = exp(-pi K'/K) of m = k^2 < 1, equation (2,4), to a few eps.

    In doubles the exponential would lose log(1/q) digits if q is small.  Instead, each step of the
    AGM of (1, k') squares the nome, until the series q = e + 2 e^5 + 15 e^9 ... (DLMF 19.5.5) is
    short.
    """
    if isinstance(ar, Balls):
        return ar.exp(-ar.pi * ar.agm(1, k_prime) / ar.agm(1, ar.sqrt(m))) if m else 0 * m
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
    for far in reversed(squarings):
        q = ar.where(far, ar.sqrt(q), q)
    return q


@in_arithmetic
def first_kind(ar: Arithmetic[R], *, m: R, k_prime: R, sn: R, cn2: R) -> R:
    """Return Legendre's F(phi, k) from sin phi and cos^2 phi, for |phi| <= pi/2 (DLMF 19.25.5)."""
    return sn * carlson_rf(ar, cn2, cn2 + k_prime * k_prime * (sn * sn), 0 * cn2 + 1)


@in_arithmetic
def place(ar: Arithmetic[R], *, m: R, k_prime: R, sn: R, cn2: R) -> R:
    """Return x = pi u/2K from sn(u, k) and cn^2(u, k), for -K <= u <= K and m = k^2 < 1."""
    integral = first_kind(ar, m=m, k_prime=k_prime, sn=sn, cn2=cn2)
    return ar.pi * integral / (2 * complete_k(ar, k_prime))


@in_arithmetic
def cosine_and_sine(ar: Arithmetic[R], *, m: R, k_prime: R, s2: R, c2: R) -> tuple[R, R]:
    """Return cos x and sin x for x = pi u/2K, where sn^2(u, k) : cn^2(u, k) = s2 : c2.

    The domain is 0 <= u <= K and m = k^2 < 1.
    """
    if isinstance(ar, Balls):
        total, rest = s2 + c2, c2 + k_prime * k_prime * s2
        x = place(ar, m=m, k_prime=k_prime, sn=ar.sqrt(s2 / total), cn2=c2 / total)
        # sn^2(K - u) = cn^2/dn^2 and cn^2(K - u) = k'^2 sn^2/dn^2
        mc_s2 = k_prime * k_prime * s2
        from_end = place(ar, m=m, k_prime=k_prime, sn=ar.sqrt(c2 / rest), cn2=mc_s2 / rest)
        return ar.sin(from_end), ar.sin(x)
    _, factor, last = _descended(ar, m, k_prime, c2 / (s2 + c2))
    return ar.sqrt(last), ar.sqrt(s2 / (s2 + c2)) / factor


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
    """
    if isinstance(ar, Balls):
        total = s2 + c2
        sn, dn2 = ar.sqrt(s2 / total), (c2 + m * s2) / total
        integral = sn * ar.carlson_rf(c2 / total, dn2, 0 * c2 + 1)
        y = ar.pi * integral / (2 * complete_k(ar, k_prime))
        return ar.cosh(y), ar.sinh(y)
    falling = True
    while falling:
        small = m / ((1 + k_prime) * (1 + k_prime))
        root = ar.sqrt((1 + small) * (1 + small) * c2 + 4 * small * s2)
        divisor = ((1 + small) * ar.sqrt(c2) + root) / 2
        s2, c2 = s2 / (divisor * divisor), 0 * s2 + 1
        m, k_prime = small * small, 2 * ar.sqrt(k_prime) / (1 + k_prime)
        falling = ar.anywhere(small * (1 + s2) > ar.eps)
    return ar.sqrt(1 + s2), ar.sqrt(s2)
