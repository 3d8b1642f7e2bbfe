"""The registers are complete: every numbered equation of both sources is in one of them."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest
from equations import Register

CHRAPAN = {1: 8, 2: 11, 3: 8, 4: 34, 5: 3, 6: 6, 7: 5}
"""Number of the last equation of each section, (1,1) to (7,5)."""

AKSENOV = {"3.1": 8, "3.2": 12}
"""Number of the last equation of each section, (3.1.1) to (3.2.12)."""

NUMBERED = [
    *(f"({section},{i})" for section, last in CHRAPAN.items() for i in range(1, last + 1)),
    *(f"({section}.{i})" for section, last in AKSENOV.items() for i in range(1, last + 1)),
]

UNNUMBERED = """
(1,1) and (1,2) of complex arguments
(2,5), continued over all w
(3,8) for the imaginary modulus of section 4
(4,1) solved for the rates
(4,14), second
(4,15), second
(4,15), third
(6,1) from u, in the first half of a period
line before (4,27)
section 1 a: argument and modulus of Z may be any numbers
section 1 c: real forms of Z(i alpha)
section 1 d: sum of Z00 and Z11
section 1 e: Legendre's relation
section 1 e: Z(alpha) = E(alpha, k') - E' alpha/K'
section 2 a: argument, parameter and modulus of Omega may be any numbers
section 3 a: Pi01 of Jacobi
section 3 a: argument, parameter and modulus of Pi may be any numbers
section 3 d: slopes of Pi
section 3 e: slope of Pi01 as a rational function of sn, cn, dn
section 3.1: a linear-fractional substitution
section 3.1: definitions of sn, cn, dn
section 3.1: property 1
section 3.1: property 2
section 3.1: property 3
section 3.1: property 4
section 3.1: property 5
section 3.1: property 5, next terms
section 3.1: table 2
section 4 a: the line of nodes
section 4 b: the angular velocity
section 4 c: Euler's equations
section 4 ch: rate of precession
section 4 d: c1 and c2
section 4 d: p and q by the rates
section 4 d: power of the weight
section 4 e: f and its slope at 1, -1 and u1
section 4 e: sign of u2
section 4 e: the discriminant
section 4 f: sum of products
section 4 g: f and the rate of xi
section 4 g: sn, cn, dn of the imaginary modulus anywhere
section 4 g: the modulus, and its complement greater than 1
section 4 g: u by sn of the imaginary modulus
section 4 g: u by the imaginary modulus
section 4 h: quarter periods of the imaginary modulus
section 4 i: Pi01 of both parameters
section 4 i: precession by Pi01
section 4 i: precession by Pi01 and the values at its parameters
section 4 i: sn, cn, dn at both parameters, with their signs
section 4 i: sn, cn, dn of the parameters
section 4 i: squares of sn, cn, dn at both parameters
section 4 j: product of the two sn
section 4 j: sn, cn, dn of i alpha for the real modulus
section 4 j: the second parameter is iK' further, the product is 1
section 4 k: rate of spin
section 4 l: spin by Pi01
section 4 l: spin by Pi01 and the values at its parameters
section 4 l: w
section 5: quarters of the nutation
section 6: spin after half a period and a whole one
section 6: the halves of the spin are alike
section 7: precession after half a period and a whole one
section 7: rates of the precession at T/2 and T
section 7: the halves of the precession are alike
section 8: rates of the precession
sections 6 and 7: no remainder at half periods
""".strip().splitlines()
"""Equations without a number of their own in the source: each is asked for by name."""

MODULES = {
    *("elliptic/test_aksenov", "elliptic/test_chrapan_functions"),
    *("motion/test_chrapan_solution", "motion/test_chrapan_angles"),
    "motion/test_chrapan_imaginary",
}
"""The modules with a register."""


@pytest.fixture
def registered(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Return the places of all equations that are in a register."""
    places: set[str] = set()
    for module in sorted(MODULES):
        folder, name = module.split("/")
        monkeypatch.syspath_prepend(Path(__file__).parent / folder)
        found = vars(import_module(name)).values()
        places.update(*(x.holds for x in found if isinstance(x, Register)))
    return places


def test_every_equation_of_the_sources_is_in_a_register(registered: set[str]) -> None:
    assert len(NUMBERED) == 95
    assert {*NUMBERED, *UNNUMBERED} - registered == set()


def test_every_equation_of_a_register_is_asked_for(registered: set[str]) -> None:
    """A new equation goes into a list, or its deletion would fail nothing."""
    assert registered - {*NUMBERED, *UNNUMBERED} == set()


def test_an_equation_without_a_place_is_refused() -> None:
    for name in ("Legendre's relation", "(3,8", "section: nothing", "section 4 d:"):
        with pytest.raises(AssertionError, match="does not begin with a place"):
            Register().equation(name)(lambda: iter(()))
