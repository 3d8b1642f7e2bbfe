"""Requests for tables of functions of one modulus, and the values that are known exactly."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.points import ExactComplex
from .any_modulus import AnyModulus, ModulusKind
from .modulus import ModulusInput

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..arithmetic.protocol import Numeric
    from ..arithmetic.types import Array

THIRD = ("01", "00", "11")
"""The indices of the functions of an argument and a parameter."""


class FunctionRequest(NamedTuple):
    """A request: a modulus, families of functions, and the parameter of Omega and Pi."""

    modulus: ModulusInput | ExactComplex
    """A modulus in [0, 1] by one of its names, or a number that is imaginary or above 1."""
    families: tuple[str, ...] = ("am",)
    """Some of am (with sn, cn and dn), theta, zeta, omega and pi."""
    parameter: ExactComplex = ExactComplex(Fraction(0))
    """The parameter of omega and pi; a number in doubles if the table is."""
    imaginary: bool = False
    """Whether the parameter of a table of real functions is imaginary (0i counts as imaginary)."""
    radians: bool = False
    in_quarters: bool = False
    """Whether the arguments are real multiples of K."""

    @property
    def am(self) -> str:
        """The name of the column of am, with its unit."""
        return "am_rad" if self.radians else "am_deg"

    @property
    def real_modulus(self) -> ModulusInput:
        """The modulus of a table of real functions."""
        assert isinstance(self.modulus, ModulusInput)
        return self.modulus

    @property
    def size(self) -> Fraction:
        """The parameter of a table of real functions, divided by i if it is imaginary."""
        return self.parameter.imag if self.imaginary else self.parameter.real

    @property
    def has_parameter(self) -> bool:
        """Whether Omega or Pi is among the families."""
        return bool({"omega", "pi"} & set(self.families))


class ComplexPoints(NamedTuple):
    """Complex arguments: their real parts and, unless all are real, their imaginary parts."""

    real: Points
    imag: Points | None = None

    def blocks(self) -> Iterator[Numeric]:
        """Yield all arguments as complex arrays."""
        if self.imag is None:
            yield from (block + 0j for block in self.real.blocks())
        else:
            pairs = zip(self.real.blocks(), self.imag.blocks(), strict=True)
            yield from (real + 1j * imag for real, imag in pairs)

    def decimals(self) -> Iterator[ExactComplex]:
        """Yield every argument exactly."""
        if self.imag is None:
            yield from map(ExactComplex, self.real.decimals())
        else:
            yield from map(ExactComplex, self.real.decimals(), self.imag.decimals())


VANISH = {
    "u": "u am_deg am_rad sn theta11 zeta01 zeta00 zeta10 omega01 omega00 pi01 pi00",
    "param": "omega01 omega00 omega11 pi01 pi00",
    "k": "theta11 theta10 zeta01 zeta00 omega01 omega00 pi01 pi00",
}
"""The columns that are 0 if u, the parameter or k is 0; no others vanish at rational u."""


def known_values(u: Fraction, request: FunctionRequest) -> dict[str, float]:
    """Return the columns that are known exactly at u: 0, or NaN at a pole.

    K is transcendental for algebraic k (Schneider 1937), so only the rational places u = 0 and u =
    +-v matter.
    """
    suffix = "_imag" if request.imaginary else ""
    known: dict[str, float] = {}

    def add(names: str, x: float) -> None:
        for column in names.split():
            known[column + suffix * column.startswith(("omega", "pi"))] = x

    if "k" in request.real_modulus.zeros():
        add(VANISH["k"], 0)
    if u == 0:
        add(VANISH["u"] + ("" if request.imaginary else " omega11 pi11"), 0)
        add("zeta11", math.nan)
    if request.size == 0:
        add(VANISH["param"], 0)
        add("pi11", math.nan)
    elif abs(u) == abs(request.size) and not (request.imaginary or request.in_quarters):
        add("omega11 pi11", math.nan)
    if request.in_quarters and u.denominator == 1:
        known |= _at_quarter(int(u % 4), suffix)
        known |= {} if request.radians else {"am_deg": 90 * int(u)}
        known |= {"omega11_imag": 0} if u == 1 and request.imaginary else {}
    return known


def _at_quarter(quarter: int, suffix: str) -> dict[str, float]:
    """Return the columns that are 0, 1, -1 or a pole at the multiples quarter + 4n of K.

    The values are the entries of Aksenov's table 2, and their consequences for theta and Zeta
    functions and for the Omega functions of a parameter.  At odd quarters, dn is k'.
    """
    odd = quarter % 2
    known: dict[str, float] = {"sn": (0, 1, 0, -1)[quarter], "cn": (1, 0, -1, 0)[quarter]}
    zeros = "zeta11 theta10" if odd else "zeta10 theta11"
    known |= dict.fromkeys(f"{zeros} zeta01 zeta00 omega01{suffix} omega00{suffix}".split(), 0)
    known["zeta10" if odd else "zeta11"] = math.nan
    return known | ({} if odd else {"dn": 1}) | ({} if suffix else {"omega11": 0})


def put_exact_values(table: dict[str, Array], u: Array, request: FunctionRequest) -> None:
    """Put exact values into a table at u = 0, at whole multiples of K and at poles."""
    import numpy as np

    places = {Fraction(0): u == 0}
    if request.in_quarters:
        whole = u == np.rint(u)
        every_turn = {Fraction(4 + i): whole & (u % 4 == i) for i in range(4)}
        places = every_turn | {Fraction(1): u == 1} | places
    elif not request.imaginary:
        places = {abs(request.size): abs(u) == abs(float(request.size))} | places
    for place, here in places.items():
        for name, value in known_values(place, request).items():
            if name in table:
                known = 90 * u if name == "am_deg" else value
                table[name] = np.where(here, known, table[name])


_RIGHT = ModulusInput("modular_angle", Fraction(45))
"""The modulus sin 45 degrees, for which K' = K."""


def known_parts(
    u: ExactComplex, request: FunctionRequest, given: AnyModulus, *, beyond: bool
) -> dict[str, float | Fraction]:
    """Return the parts that are known exactly at u: 0, or NaN at a pole; am is u if k = 0.

    Set `beyond` if u lies beyond the branch points of am.
    """
    v, am, kind, zeros = request.parameter, request.am, given.kind, ""
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
        zeros += f" {am} sn zeta01_re zeta01_im zeta00_re zeta00_im zeta10_re zeta10_im"
        zeros += " theta11_re theta11_im"
    known: dict[str, float | Fraction] = {}
    if not given.modulus.k:
        zeros += " dn_im"
        if request.radians:
            known = {am: u.real, f"{am}_re": u.real, f"{am}_im": u.imag}
    poles = {"zeta11"} if along and upright else set()
    if not any(v):
        poles.add("pi11")
    if v in (u, ExactComplex(-u.real, -u.imag)):
        poles |= {"omega11", "pi11"}
    if beyond:
        poles.add(am)
    split = [f"{name}{part}" for name in poles for part in ("", "_re", "_im")]
    return known | dict.fromkeys(zeros.split(), 0.0) | dict.fromkeys(split, math.nan)


def whole_quarters(u: ExactComplex, request: FunctionRequest, kind: ModulusKind) -> set[str]:
    """Return the parts of Omega and Pi that are multiples of a quarter turn by symmetry."""
    v, large = request.parameter, kind is ModulusKind.LARGE
    turns = _third("pi", u, v) + ("" if large and any(u) and any(v) else _third("omega", u, v))
    return set(turns.split()) | (set() if large else _turns(u, v, request.modulus))


def _third(family: str, u: ExactComplex, v: ExactComplex) -> str:
    """Return the parts of Omega or Pi that vanish by symmetry, up to quarter turns."""
    parts = ""
    if not (any(u) and any(v)):
        parts = "re im"
    elif (not u.imag and not v.real) or (not u.real and not v.imag):
        parts = "re"
    if (not u.imag and not v.imag) or (not u.real and not v.real):
        parts += " im"
    names = (f" {family}{ij}_{part}" for ij in ("01", "00", "11") for part in parts.split())
    return "".join(names)


def _turns(u: ExactComplex, v: ExactComplex, modulus: ModulusInput | ExactComplex) -> set[str]:
    """Return the parts that are multiples of a quarter turn for u and v on symmetric lines.

    Omega(u, v) is Omega(v, u), except for the odd theta function and half turns.  It is therefore
    real if u is conj v or -conj v.

    If K' = K, or K' = K - iK for k = i, theta(iu) is exp(pi u^2/4K^2) times theta(u).  The odd
    function has a further factor i.  On the diagonals conj u is iu or -iu.  So Pi is real
    if u and v are on the same diagonal, and imaginary if they are on different ones.
    """
    if not (all(u) and all(v)):
        return set()
    turns, straight = set(), u.real * v.real == u.imag * v.imag
    if v in (ExactComplex(u.real, -u.imag), ExactComplex(-u.real, u.imag)):
        turns = {"omega01_im", "omega00_im"}
    on_diagonals = all(abs(z.real) == abs(z.imag) for z in (u, v))
    even = {ExactComplex(Fraction(0), Fraction(1)): "01", _RIGHT: "00"}.get(modulus)
    if even and on_diagonals:
        turns |= {f"pi{ij}_{'im' if straight else 're'}" for ij in (even, "11")}
    return turns
