"""The parts of functions of complex numbers that are exactly 0, and the poles, for proved digits.

They follow from f(conj u, conj v) = conj f(u, v), f(-u, v) = -f(u, v) up to half turns, and their
like.  K and K' are transcendental for algebraic k (Schneider 1937), so that no others are rational.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.exact_complex import ExactComplex
from ..arithmetic.many_digits import ManyDigits
from .any_modulus import Kind
from .complete import complete_k

if TYPE_CHECKING:
    from .complex_table import ComplexRequest


class Known(NamedTuple):
    """Parts that may be 0, and columns that are not numbers."""

    parts: frozenset[str]
    poles: frozenset[str]

    def names(self) -> set[str]:
        """Return all parts that may be 0 or not a number."""
        split = {f"{name}{part}" for name in self.poles for part in ("", "_re", "_im")}
        return split | self.parts


def known_parts(u: ExactComplex, request: ComplexRequest, kind: Kind) -> Known:
    """Return the parts that are exactly 0 at u, and the poles."""
    v, zeros = request.parameter, "u_re u_im"
    large, along, upright = kind is Kind.LARGE, not u.imag, not u.real
    am = "am_rad" if request.radians else "am_deg"
    if along:
        zeros += f" {am}_im sn_im cn_im dn_im"
        zeros += "" if large else " zeta01_im zeta00_im zeta11_im zeta10_im theta01_im theta00_im"
        zeros += " theta11_im theta10_im" if kind is Kind.UNIT else ""
    if upright:
        zeros += f" {am}_re sn_re cn_im dn_im"
        zeros += "" if large else " zeta01_re zeta00_re zeta11_re zeta10_re theta01_im theta00_im"
        zeros += " theta11_re theta10_im" if kind is Kind.UNIT else ""
    if along and upright:
        zeros += f" u {am} sn zeta01_re zeta01_im zeta00_re zeta00_im zeta10_re zeta10_im"
        zeros += " theta11_re theta11_im"
    if not request.modulus_in(ManyDigits()).modulus.k:
        zeros += " dn_im"
    zeros += _third("pi", u, v) + ("" if large and any(u) and any(v) else _third("omega", u, v))
    poles = {"zeta11"} if along and upright else set()
    if not any(v):
        poles.add("pi11")
    elif v in (u, ExactComplex(-u.real, -u.imag)):
        poles |= {"omega11", "pi11"}
    if _beyond(u, request):
        poles.add(am)
    return Known(frozenset(zeros.split()), frozenset(poles))


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


def _beyond(u: ExactComplex, request: ComplexRequest) -> bool:
    """Return whether u is beyond the branch points of am."""
    ar = ManyDigits()
    given = request.modulus_in(ar)
    if not given.modulus.k:
        return False
    return bool(abs(ar.convert(u.imag)) * given.stretch > complete_k(ar, given.modulus.k))
