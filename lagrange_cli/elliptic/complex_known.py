"""The parts of functions of complex numbers that are exactly 0, and the poles, for proved digits.

They follow from f(conj u, conj v) = conj f(u, v), f(-u, v) = -f(u, v) up to half turns, and their
like.  K and K' are transcendental for algebraic k (Schneider 1937), so that no others are rational.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from ..arithmetic.points import ExactComplex
from ..arithmetic.protocol import Value
from .any_modulus import AnyModulus, ModulusKind
from .complete import complete_k
from .many_digits import ManyDigits
from .modulus_input import ModulusInput
from .request import FunctionRequest

_RIGHT = ModulusInput("modular_angle", Fraction(45))
"""The modulus sin 45 degrees, of which K' = K."""


class Known(NamedTuple):
    """Parts that may be 0, and columns that are not numbers."""

    parts: frozenset[str]
    poles: frozenset[str]
    turns: frozenset[str] = frozenset()
    """Parts that are whole multiples of a quarter turn, of which rounding leaves a trace."""

    def names(self) -> set[str]:
        """Return all parts that may be 0 or not a number."""
        split = {f"{name}{part}" for name in self.poles for part in ("", "_re", "_im")}
        return split | self.parts | self.turns

    def cleared(self, ar: ManyDigits, parts: dict[str, Value]) -> dict[str, Value]:
        """Return all parts, those of no turn as 0: a trace is far smaller than a quarter turn."""
        trace = ar.mpf(10) ** (-ar.dps // 2)
        none = {name for name in self.turns & parts.keys() if abs(parts[name]) < trace}
        return {name: 0 * part if name in none else part for name, part in parts.items()}


def known_parts(u: ExactComplex, request: FunctionRequest, given: AnyModulus) -> Known:
    """Return the parts that are exactly 0 at u, and the poles."""
    v, am, kind, zeros = request.parameter, request.am, given.kind, "u_re u_im"
    large, along, upright = kind is ModulusKind.LARGE, not u.imag, not u.real
    if along:
        zeros += f" {am}_im sn_im cn_im dn_im"
        zeros += "" if large else " zeta01_im zeta00_im zeta11_im zeta10_im theta01_im theta00_im"
        zeros += " theta11_im theta10_im" if kind is ModulusKind.UNIT else ""
    if upright:
        zeros += f" {am}_re sn_re cn_im dn_im"
        zeros += "" if large else " zeta01_re zeta00_re zeta11_re zeta10_re theta01_im theta00_im"
        zeros += " theta11_re theta10_im" if kind is ModulusKind.UNIT else ""
    if along and upright:
        zeros += f" u {am} sn zeta01_re zeta01_im zeta00_re zeta00_im zeta10_re zeta10_im"
        zeros += " theta11_re theta11_im"
    if not given.modulus.k:
        zeros += " dn_im"
    zeros += _third("pi", u, v) + ("" if large and any(u) and any(v) else _third("omega", u, v))
    poles = {"zeta11"} if along and upright else set()
    if not any(v):
        poles.add("pi11")
    if v in (u, ExactComplex(-u.real, -u.imag)):
        poles |= {"omega11", "pi11"}
    if _beyond(u, given):
        poles.add(am)
    turns = frozenset() if large else _turns(u, v, request.modulus)
    return Known(frozenset(zeros.split()), frozenset(poles), turns)


def _third(family: str, u: ExactComplex, v: ExactComplex) -> str:
    """Return the parts of Omega or Pi that vanish by symmetry; half turns may be none."""
    parts = ""
    if not (any(u) and any(v)):
        parts = "re im"
    elif (not u.imag and not v.real) or (not u.real and not v.imag):
        parts = "re"
    if (not u.imag and not v.imag) or (not u.real and not v.real):
        parts += " im"
    names = (f" {family}{ij}_{part}" for ij in ("01", "00", "11") for part in parts.split())
    return "".join(names)


def _turns(
    u: ExactComplex, v: ExactComplex, modulus: ModulusInput | ExactComplex
) -> frozenset[str]:
    """Return the parts that are multiples of a quarter turn where u and v are on symmetric lines.

    Omega(u, v) is Omega(v, u), but for the odd theta function and half turns; so it is real where u
    is conj v or -conj v.  For K' = K (or K' = K - iK, of k = i) theta(iu) is theta(u), i theta(u)
    of the odd one, times exp(pi u^2/4K^2).  On the diagonals conj u is iu or -iu; so Pi is real
    where u and v are on one of them, and imaginary where they are on both.
    """
    if not (all(u) and all(v)):
        return frozenset()
    turns, straight = set(), u.real * v.real == u.imag * v.imag
    if v in (ExactComplex(u.real, -u.imag), ExactComplex(-u.real, u.imag)):
        turns = {"omega01_im", "omega00_im"}
    on_diagonals = all(abs(z.real) == abs(z.imag) for z in (u, v))
    even = {ExactComplex(Fraction(0), Fraction(1)): "01", _RIGHT: "00"}.get(modulus)
    if even and on_diagonals:
        turns |= {f"pi{ij}_{'im' if straight else 're'}" for ij in (even, "11")}
    return frozenset(turns)


def _beyond(u: ExactComplex, given: AnyModulus) -> bool:
    """Return whether u is beyond the branch points of am."""
    k = given.modulus.k
    if not k:
        return False
    ar = k.context
    return bool(abs(ar.convert(u.imag)) * given.stretch > complete_k(ar, k))
