"""Chrapan's section 4 g to l: the motion by our functions of the imaginary modulus kappa.

The other sides are those of mpmath, which takes the imaginary modulus as it is: in sn, cn, dn, in
K, and in the theta functions, whose nome is then negative.
"""

from __future__ import annotations

from functools import partial
from itertools import chain
from typing import Any, ClassVar

import pytest
from chrapan_top import PARTS, J, Motion, ar, moments, slope, spoil, tops
from equations import EquationTests, Register, pairs
from ours import Ours

chrapan = Register()
ours = Ours(ar)


def kappa(top: Motion) -> Any:
    """Return the imaginary modulus of section 4 g."""
    return J * ar.sqrt(-top.kappa2)


def eta(top: Motion, t: Any) -> Any:
    """Return the argument of section 4 g."""
    return ar.sqrt(top.a * (top.u3 - top.u1)) * t / 2


def here(top: Motion, v: Any) -> list[Any]:
    """Return our sn, cn and dn for the imaginary modulus."""
    return list(ours.jacobi(v, kappa(top))[1:])


def there(top: Motion, v: Any) -> list[Any]:
    """Return sn, cn and dn for the imaginary modulus of the record's k, by mpmath."""
    return [ar.ellipfun(name, v, m=-((top.k / top.k_prime) ** 2)) for name in ("sn", "cn", "dn")]


def parameters(top: Motion) -> tuple[Any, Any]:
    """Return the parameters alpha1 = i alpha k' and alpha2 = alpha1 + k' (iK' + K) of 4 j."""
    first = J * top.alpha * top.k_prime
    return first, first + top.k_prime * (J * top.K_prime + top.K)


def squares(top: Motion) -> list[list[Any]]:
    """Return the squares of sn, cn, dn at alpha1 and at alpha2, from the roots (4 i)."""
    u1, u2, u3 = top.roots
    return [
        [x / (1 + u1) for x in (u1 - u3, u3 + 1, 1 + u2)],
        [x / (1 - u1) for x in (u3 - u1, 1 - u3, 1 - u2)],
    ]


def at_parameters(top: Motion) -> list[list[Any]]:
    """Return sn, cn, dn at alpha1 and at alpha2, from the roots (4 i).

    The paper gives the squares and takes positive roots.  At alpha2, sn and dn are negative.
    """
    first, (sn, cn, dn) = ([ar.sqrt(ar.mpc(x)) for x in part] for part in squares(top))
    return [first, [-sn, cn, -dn]]


def pi01(top: Motion, t: Any) -> list[Any]:
    """Return our Pi01(eta, alpha1, kappa) and Pi01(eta, alpha2, kappa), continuous in t."""
    return [ours.pi_function("01", eta(top, t), v, kappa(top)) for v in parameters(top)]


def pi01_there(top: Motion, t: Any, v: Any) -> Any:
    """Return exp 2 Pi01(eta, v, kappa) by its definition and mpmath's theta with nome -q."""
    q, scale = -top.nome, ar.pi / (2 * ar.ellipk(-((top.k / top.k_prime) ** 2)))
    zeta = scale * ar.jtheta(4, scale * v, q, 1) / ar.jtheta(4, scale * v, q)
    less, more = (ar.jtheta(4, scale * (eta(top, t) + sign * v), q) for sign in (-1, 1))
    return ar.exp(2 * eta(top, t) * zeta) * less / more


def weighted(top: Motion, t: Any) -> list[Any]:
    """Return sn/(cn dn) times Pi01 of each parameter, from the roots, over sqrt(a (u3 - u1))/b."""
    size = top.b / ar.sqrt(top.a * (top.u3 - top.u1))
    places = zip(at_parameters(top), pi01(top, t), strict=True)
    return [size * sn / (cn * dn) * value for (sn, cn, dn), value in places]


def rates_of_xi(top: Motion, t: Any) -> list[tuple[Any, Any]]:
    """Return f and the rate of xi = sn(eta, kappa) with their formulas."""
    (u1, u2, u3), xi = top.roots, here(top, eta(top, t))[0]
    rest = (1 - xi**2) * (1 - top.kappa2 * xi**2)
    return [
        (slope(top.u, t) ** 2, top.a * (u1 - u2) ** 2 * (u3 - u1) * xi**2 * rest),
        (slope(lambda at: here(top, eta(top, at))[0], t) ** 2, top.a * (u3 - u1) / 4 * rest),
    ]


chrapan.each(
    tops,
    {
        "section 4 g: the modulus, and its complement greater than 1": lambda top: pairs(
            [kappa(top), ar.sqrt((top.u3 - top.u2) / (top.u3 - top.u1)), ar.sqrt(1 - top.kappa2)],
            [J * top.k / top.k_prime, 1 / top.k_prime, 1 / top.k_prime],
        ),
        "section 4 h: quarter periods of the imaginary modulus": lambda top: pairs(
            [top.k_prime * top.K, top.k_prime * (top.K_prime - J * top.K)],
            [ar.ellipk(top.kappa2), ar.ellipk(1 / top.k_prime**2)],
        ),
        "section 4 i: squares of sn, cn, dn at both parameters": lambda top: pairs(
            [x**2 for v in parameters(top) for x in here(top, v)], chain(*squares(top))
        ),
        "section 4 i: sn, cn, dn at both parameters, with their signs": lambda top: pairs(
            chain(*at_parameters(top)), chain(*(there(top, v) for v in parameters(top)))
        ),
        "section 4 g: sn, cn, dn of the imaginary modulus anywhere": lambda top: pairs(
            *(side(top, top.alpha * ar.mpc("0.3", "0.4")) for side in (here, there))
        ),
        "section 4 j: the second parameter is iK' further, the product is 1": lambda top: [
            (parameters(top)[1] - parameters(top)[0], J * ar.ellipk(1 / top.k_prime**2)),
            (top.kappa2 * ar.fprod(there(top, v)[0] for v in parameters(top)) ** 2, 1),
            (top.kappa2 * squares(top)[0][0] * squares(top)[1][0], 1),
        ],
        "section 4 j: sn, cn, dn of i alpha for the real modulus": lambda top: pairs(
            [x**2 for x in ours.jacobi(J * top.alpha, top.k)[1:]],
            [x / (1 + top.u2) for x in (top.u2 - top.u3, top.u3 + 1, 1 + top.u1)],
        ),
    },
)
chrapan.each(
    moments,
    {
        "section 4 g: u by sn of the imaginary modulus": lambda top, t: [
            (top.u(t), top.u1 - (top.u1 - top.u2) * side(top, eta(top, t))[0] ** 2)
            for side in (here, there)
        ],
        "section 4 i: precession by Pi01": lambda top, t: (
            top.sigma * J * sum(pi01(top, t)),
            top.angles(t)[2],
        ),
        "section 4 l: spin by Pi01": lambda top, t: (
            top.r0 * t + top.sigma * J * (pi01(top, t)[0] - pi01(top, t)[1]),
            top.angles(t)[1],
        ),
    },
)
chrapan.each(
    partial(moments, PARTS[0], PARTS[2], PARTS[5]),
    {
        "section 4 g: f and the rate of xi": rates_of_xi,
        "section 4 i: Pi01 of both parameters": lambda top, t: pairs(
            [ar.exp(2 * value) for value in pi01(top, t)],
            [pi01_there(top, t, v) for v in parameters(top)],
        ),
        "section 4 i: precession by Pi01 and the values at its parameters": lambda top, t: (
            weighted(top, t)[0] - weighted(top, t)[1],
            top.angles(t)[2],
        ),
        "section 4 l: spin by Pi01 and the values at its parameters": lambda top, t: (
            top.r0 * t + sum(weighted(top, t)),
            top.angles(t)[1],
        ),
    },
)


class TestChrapan(EquationTests):
    """Tests of the register."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = set()

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put tops in place whose record and angles are wrong."""
        spoil(patch)
