"""Chrapan's section 4 g to l with the imaginary modulus: our functions against mpmath's.

Ours go by the text's transformations to a real modulus; mpmath takes the imaginary one as it is,
in sn, cn, dn, in K, and in the theta functions, whose nome is then negative.
"""

from __future__ import annotations

from functools import partial
from typing import Any, ClassVar

import pytest
from chrapan_top import MOTIONS, PARTS, J, Motion, ar, moments, slope, spoil
from equations import EquationTests, Register, Sides
from lagtop import LagtopError, Top, solve

from lagrange_cli.motion.paper.imaginary_modulus import ImaginaryForm, imaginary_form

chrapan = Register()
equation = chrapan.equation
FEW = PARTS[0], PARTS[2], PARTS[5]


def form(motion: Motion) -> ImaginaryForm:
    """Return the imaginary form from the numbers of a record."""
    roots = dict(zip(("u1", "u2", "u3"), motion.roots, strict=True))
    return ImaginaryForm(ar, a=motion.a, r0=motion.r0, **roots)


def there(motion: Motion, name: str, v: Any) -> Any:
    """Return sn, cn or dn for the imaginary modulus of the record's k, by mpmath."""
    return ar.ellipfun(name, v, m=-((motion.k / motion.k_prime) ** 2))


@equation("section 4 g: the modulus, and its complement greater than 1")
def _() -> Sides:
    for motion in MOTIONS:
        ours = form(motion)
        yield ours.kappa, J * motion.k / motion.k_prime
        yield ours.kappa_prime, 1 / motion.k_prime
        yield ar.sign(ours.kappa_prime - 1), 1


@equation("section 4 g: u by sn of the imaginary modulus")
def _() -> Sides:
    for motion, t in moments():
        ours, (u1, u2, _) = form(motion), motion.roots
        eta = ar.sqrt(motion.a * (motion.u3 - u1)) * t / 2
        yield ours.u(t), motion.u(t)
        yield ours.u(t), u1 - (u1 - u2) * there(motion, "sn", eta) ** 2


def _xi(motion: Motion, t: Any) -> Any:
    ours = form(motion)
    return ours.jacobi(ours.eta(t)).sn


@equation("section 4 g: f and the rate of xi")
def _() -> Sides:
    for motion, t in moments(*FEW):
        (u1, u2, u3), xi = motion.roots, _xi(motion, t)
        rest = (1 - xi**2) * (1 - form(motion).kappa_squared * xi**2)
        yield slope(motion.u, t) ** 2, motion.a * (u1 - u2) ** 2 * (u3 - u1) * xi**2 * rest
        yield slope(partial(_xi, motion), t) ** 2, motion.a * (u3 - u1) / 4 * rest


@equation("section 4 h: quarter periods of the imaginary modulus")
def _() -> Sides:
    for motion in MOTIONS:
        first, second = form(motion).half_periods
        yield first, ar.ellipk(-((motion.k / motion.k_prime) ** 2))
        yield second / J, ar.ellipk(1 / motion.k_prime**2)


@equation("section 4 i: squares of sn, cn, dn at both parameters")
def _() -> Sides:
    for motion in MOTIONS:
        for v, squares in zip(form(motion).parameters, form(motion).squares, strict=True):
            for name, square in zip(("sn", "cn", "dn"), squares, strict=True):
                yield square, there(motion, name, v) ** 2


@equation("section 4 i: sn, cn, dn at both parameters, with their signs")
def _() -> Sides:
    for motion in MOTIONS:
        for v, values in zip(form(motion).parameters, form(motion).at_parameters, strict=True):
            for name, value in zip(("sn", "cn", "dn"), values, strict=True):
                yield value, there(motion, name, v)


@equation("section 4 g: sn, cn, dn of the imaginary modulus anywhere")
def _() -> Sides:
    for motion in MOTIONS:
        v = motion.alpha * ar.mpc("0.3", "0.4")
        for name, value in zip(("sn", "cn", "dn"), form(motion).jacobi(v), strict=True):
            yield value, there(motion, name, v)


@equation("section 4 j: the second parameter is iK' further, the product is 1")
def _() -> Sides:
    for motion in MOTIONS:
        ours = form(motion)
        first, second = ours.parameters
        yield first, J * motion.alpha * motion.k_prime
        yield second - first, J * ar.ellipk(1 / motion.k_prime**2)
        product = there(motion, "sn", first) * there(motion, "sn", second)
        yield ours.kappa_squared * product**2, 1
        yield ours.kappa_squared * ours.squares[0].sn * ours.squares[1].sn, 1


def _pi01_there(motion: Motion, t: Any, v: Any) -> Any:
    """Return exp 2 Pi01(eta, v, kappa) by its definition and mpmath's theta with nome -q."""
    kappa2 = -((motion.k / motion.k_prime) ** 2)
    quarter = ar.ellipk(kappa2)
    q, scale = -motion.nome, ar.pi / (2 * quarter)
    eta = ar.sqrt(motion.a * (motion.u3 - motion.u1)) * t / 2
    zeta = scale * ar.jtheta(4, scale * v, q, 1) / ar.jtheta(4, scale * v, q)
    less, more = (ar.jtheta(4, scale * (eta + sign * v), q) for sign in (-1, 1))
    return ar.exp(2 * eta * zeta) * less / more


@equation("section 4 i: Pi01 of both parameters")
def _() -> Sides:
    for motion, t in moments(*FEW):
        ours = form(motion)
        for v, value in zip(ours.parameters, ours.pi01(t), strict=True):
            yield ar.exp(2 * value), _pi01_there(motion, t, v)


def _weighted(motion: Motion, t: Any) -> tuple[Any, Any]:
    """Return sn/(cn dn) times Pi01 of each parameter, from the roots, over sqrt(a (u3 - u1))/b."""
    ours = form(motion)
    size = motion.b / ar.sqrt(motion.a * (motion.u3 - motion.u1))
    first, second = (
        size * x.sn / (x.cn * x.dn) * value
        for x, value in zip(ours.at_parameters, ours.pi01(t), strict=True)
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
        sn, cn, dn = (
            ar.ellipfun(name, J * form(motion).alpha, m=motion.k**2) for name in ("sn", "cn", "dn")
        )
        yield sn**2, -(u3 - u2) / (1 + u2)
        yield cn, ar.sqrt((u3 + 1) / (1 + u2))
        yield dn**2, (1 + u1) / (1 + u2)


@equation("section 4 i: precession by Pi01")
def _() -> Sides:
    for motion, t in moments():
        yield form(motion).psi(t), motion.angles(t)[2]


@equation("section 4 l: spin by Pi01")
def _() -> Sides:
    for motion, t in moments():
        yield form(motion).phi(t), motion.angles(t)[1]


class TestChrapan(EquationTests):
    """Tests of the register."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = set()

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put tops in place whose record and angles are wrong."""
        spoil(patch, __name__)


def test_the_form_of_a_motion_has_the_digits_asked_for() -> None:
    motion = solve(Top())
    ours = imaginary_form(motion)
    psi = motion.record(digits=30, keys=["psi_half_rad"], radians=True)["psi_half_rad"]
    half = ours.ar.mpf(motion.record(digits=40, keys=["T_nutation"])["T_nutation"]) / 2
    assert abs(ours.psi(half) - ours.ar.mpf(psi)) < 1e-29


@pytest.mark.parametrize("inputs", [{"r0": 0}, {"theta0_deg": 0}, {"psidot0": 1}, {"g": 0}])
def test_other_motions_have_no_imaginary_form(inputs: dict[str, float]) -> None:
    with pytest.raises(LagtopError, match=r"^for the imaginary form the top must spin and"):
        imaginary_form(solve(Top(**inputs)))
