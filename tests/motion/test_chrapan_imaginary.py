"""Chrapan's section 4 g to l: the motion by our functions of the imaginary modulus kappa.

The other sides are those of mpmath, which takes the imaginary modulus as it is: in sn, cn, dn, in
K, and in the theta functions, whose nome is then negative.
"""

from __future__ import annotations

from functools import partial
from typing import Any, ClassVar

import pytest
from chrapan_top import MOTIONS, PARTS, J, Motion, ar, moments, slope, spoil
from equations import EquationTests, Register, Sides
from ours import Ours

chrapan = Register()
equation = chrapan.equation
FEW = PARTS[0], PARTS[2], PARTS[5]
NAMES = ("sn", "cn", "dn")
ours = Ours(ar)


def kappa(motion: Motion) -> Any:
    """Return the imaginary modulus of section 4 g."""
    return J * ar.sqrt(-motion.kappa2)


def eta(motion: Motion, t: Any) -> Any:
    """Return the argument of section 4 g."""
    return ar.sqrt(motion.a * (motion.u3 - motion.u1)) * t / 2


def here(motion: Motion, v: Any) -> list[Any]:
    """Return our sn, cn and dn for the imaginary modulus."""
    return list(ours.jacobi(v, kappa(motion))[1:])


def there(motion: Motion, name: str, v: Any) -> Any:
    """Return sn, cn or dn for the imaginary modulus of the record's k, by mpmath."""
    return ar.ellipfun(name, v, m=-((motion.k / motion.k_prime) ** 2))


def parameters(motion: Motion) -> tuple[Any, Any]:
    """Return the parameters alpha1 = i alpha k' and alpha2 = alpha1 + k' (iK' + K) of 4 j."""
    first = J * motion.alpha * motion.k_prime
    return first, first + motion.k_prime * (J * motion.K_prime + motion.K)


def squares(motion: Motion) -> list[list[Any]]:
    """Return the squares of sn, cn, dn at alpha1 and at alpha2, from the roots (4 i)."""
    u1, u2, u3 = motion.roots
    south, north = 1 + u1, 1 - u1
    return [
        [-(u3 - u1) / south, (u3 + 1) / south, (1 + u2) / south],
        [(u3 - u1) / north, -(u3 - 1) / north, (1 - u2) / north],
    ]


def at_parameters(motion: Motion) -> list[list[Any]]:
    """Return sn, cn, dn at alpha1 and at alpha2, from the roots (4 i).

    The paper gives the squares and takes positive roots.  At alpha2, sn and dn are negative.
    """
    first, (sn, cn, dn) = ([ar.sqrt(ar.mpc(x)) for x in part] for part in squares(motion))
    return [first, [-sn, cn, -dn]]


def pi01(motion: Motion, t: Any) -> tuple[Any, Any]:
    """Return our Pi01(eta, alpha1, kappa) and Pi01(eta, alpha2, kappa), continuous in t."""
    first, second = (
        ours.pi_function("01", eta(motion, t), v, kappa(motion)) for v in parameters(motion)
    )
    return first, second


@equation("section 4 g: the modulus, and its complement greater than 1")
def _() -> Sides:
    for motion in MOTIONS:
        u1, u2, u3 = motion.roots
        yield kappa(motion), J * motion.k / motion.k_prime
        yield ar.sqrt((u3 - u2) / (u3 - u1)), 1 / motion.k_prime
        yield ar.sqrt(1 - motion.kappa2), 1 / motion.k_prime


@equation("section 4 g: u by sn of the imaginary modulus")
def _() -> Sides:
    for motion, t in moments():
        u1, u2, _ = motion.roots
        yield motion.u(t), u1 - (u1 - u2) * here(motion, eta(motion, t))[0] ** 2
        yield motion.u(t), u1 - (u1 - u2) * there(motion, "sn", eta(motion, t)) ** 2


def _xi(motion: Motion, t: Any) -> Any:
    return here(motion, eta(motion, t))[0]


@equation("section 4 g: f and the rate of xi")
def _() -> Sides:
    for motion, t in moments(*FEW):
        (u1, u2, u3), xi = motion.roots, _xi(motion, t)
        rest = (1 - xi**2) * (1 - motion.kappa2 * xi**2)
        yield slope(motion.u, t) ** 2, motion.a * (u1 - u2) ** 2 * (u3 - u1) * xi**2 * rest
        yield slope(partial(_xi, motion), t) ** 2, motion.a * (u3 - u1) / 4 * rest


@equation("section 4 h: quarter periods of the imaginary modulus")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.k_prime * motion.K, ar.ellipk(motion.kappa2)
        second = motion.k_prime * (motion.K_prime - J * motion.K)
        yield second, ar.ellipk(1 / motion.k_prime**2)


@equation("section 4 i: squares of sn, cn, dn at both parameters")
def _() -> Sides:
    for motion in MOTIONS:
        for v, right in zip(parameters(motion), squares(motion), strict=True):
            yield from ((x**2, y) for x, y in zip(here(motion, v), right, strict=True))


@equation("section 4 i: sn, cn, dn at both parameters, with their signs")
def _() -> Sides:
    for motion in MOTIONS:
        for v, values in zip(parameters(motion), at_parameters(motion), strict=True):
            for name, value in zip(NAMES, values, strict=True):
                yield value, there(motion, name, v)


@equation("section 4 g: sn, cn, dn of the imaginary modulus anywhere")
def _() -> Sides:
    for motion in MOTIONS:
        v = motion.alpha * ar.mpc("0.3", "0.4")
        for name, value in zip(NAMES, here(motion, v), strict=True):
            yield value, there(motion, name, v)


@equation("section 4 j: the second parameter is iK' further, the product is 1")
def _() -> Sides:
    for motion in MOTIONS:
        first, second = parameters(motion)
        yield second - first, J * ar.ellipk(1 / motion.k_prime**2)
        product = there(motion, "sn", first) * there(motion, "sn", second)
        yield motion.kappa2 * product**2, 1
        (square, _, _), (other, _, _) = squares(motion)
        yield motion.kappa2 * square * other, 1


def _pi01_there(motion: Motion, t: Any, v: Any) -> Any:
    """Return exp 2 Pi01(eta, v, kappa) by its definition and mpmath's theta with nome -q."""
    q, scale = -motion.nome, ar.pi / (2 * ar.ellipk(-((motion.k / motion.k_prime) ** 2)))
    zeta = scale * ar.jtheta(4, scale * v, q, 1) / ar.jtheta(4, scale * v, q)
    less, more = (ar.jtheta(4, scale * (eta(motion, t) + sign * v), q) for sign in (-1, 1))
    return ar.exp(2 * eta(motion, t) * zeta) * less / more


@equation("section 4 i: Pi01 of both parameters")
def _() -> Sides:
    for motion, t in moments(*FEW):
        for v, value in zip(parameters(motion), pi01(motion, t), strict=True):
            yield ar.exp(2 * value), _pi01_there(motion, t, v)


def _weighted(motion: Motion, t: Any) -> tuple[Any, Any]:
    """Return sn/(cn dn) times Pi01 of each parameter, from the roots, over sqrt(a (u3 - u1))/b."""
    size = motion.b / ar.sqrt(motion.a * (motion.u3 - motion.u1))
    first, second = (
        size * sn / (cn * dn) * value
        for (sn, cn, dn), value in zip(at_parameters(motion), pi01(motion, t), strict=True)
    )
    return first, second


@equation("section 4 i: precession by Pi01 and the values at its parameters")
def _() -> Sides:
    for motion, t in moments(*FEW):
        first, second = _weighted(motion, t)
        yield first - second, motion.angles(t)[2]


@equation("section 4 l: spin by Pi01 and the values at its parameters")
def _() -> Sides:
    for motion, t in moments(*FEW):
        first, second = _weighted(motion, t)
        yield motion.r0 * t + first + second, motion.angles(t)[1]


@equation("section 4 j: sn, cn, dn of i alpha for the real modulus")
def _() -> Sides:
    for motion in MOTIONS:
        u1, u2, u3 = motion.roots
        _, sn, cn, dn = ours.jacobi(J * motion.alpha, motion.k)
        yield sn**2, -(u3 - u2) / (1 + u2)
        yield cn, ar.sqrt((u3 + 1) / (1 + u2))
        yield dn**2, (1 + u1) / (1 + u2)


@equation("section 4 i: precession by Pi01")
def _() -> Sides:
    for motion, t in moments():
        first, second = pi01(motion, t)
        yield motion.sigma * J * (first + second), motion.angles(t)[2]


@equation("section 4 l: spin by Pi01")
def _() -> Sides:
    for motion, t in moments():
        first, second = pi01(motion, t)
        yield motion.r0 * t + motion.sigma * J * (first - second), motion.angles(t)[1]


class TestChrapan(EquationTests):
    """Tests of the register."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = set()

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put tops in place whose record and angles are wrong."""
        spoil(patch, __name__)
