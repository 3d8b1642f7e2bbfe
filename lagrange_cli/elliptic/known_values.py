"""The columns of a table of functions whose value is known from a formula: 0, 1, -1, or a pole."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from .request import FunctionRequest

if TYPE_CHECKING:
    from ..arithmetic.types import Array

VANISH = {
    "u": "u am_deg am_rad sn theta11 zeta01 zeta00 zeta10 omega01 omega00 pi01 pi00",
    "param": "omega01 omega00 omega11 pi01 pi00",
    "k": "theta11 theta10 zeta01 zeta00 omega01 omega00 pi01 pi00",
}
"""The columns that are exactly 0 where u, the parameter or k is; no other is, at rational u."""


def known_values(u: Fraction, request: FunctionRequest) -> dict[str, float]:
    """Return the columns that are exactly 0 at u, and not a number where they have a pole.

    K is transcendental for algebraic k (Schneider 1937), so that u = 0 and u = +-v are the only
    rational places to think of.
    """
    name, value, _ = request.real_modulus
    suffix = "_imag" if request.imaginary else ""
    known: dict[str, float] = {}

    def add(names: str, x: float) -> None:
        for column in names.split():
            known[column + suffix * column.startswith(("omega", "pi"))] = x

    if value == (1 if name == "k_prime" else 0):
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
        known |= known_at_quarter(int(u % 4), request)
        known |= {} if request.radians else {"am_deg": 90 * int(u)}
        known |= {"omega11_imag": 0} if u == 1 and request.imaginary else {}
    return known


def known_at_quarter(quarter: int, request: FunctionRequest) -> dict[str, float]:
    """Return the columns that are 0, 1, -1 or a pole at the multiples quarter + 4n of K.

    These are the entries of Aksenov's table 2, and what follows for theta and Zeta functions and
    the Omega functions of a parameter.  dn is k' at odd quarters.
    """
    odd = quarter % 2
    known: dict[str, float] = {"sn": (0, 1, 0, -1)[quarter], "cn": (1, 0, -1, 0)[quarter]}
    zeros = "zeta10 theta11" if not odd else "zeta11 theta10"
    known |= dict.fromkeys(f"{zeros} zeta01 zeta00".split(), 0)
    known["zeta10" if odd else "zeta11"] = math.nan
    suffix = "_imag" if request.imaginary else ""
    known |= {f"omega01{suffix}": 0, f"omega00{suffix}": 0}
    if not odd:
        known["dn"] = 1
    if not request.imaginary:
        known["omega11"] = 0
    return known


def put_exact_values(table: dict[str, Array], u: Array, request: FunctionRequest) -> None:
    """Put what is known at u = 0, at whole multiples of K and at poles in its place."""
    import numpy as np

    def put(here: Array, known: dict[str, float]) -> None:
        for name in known.keys() & table.keys():
            table[name] = np.where(here, known[name], table[name])

    if request.in_quarters:
        whole = u == np.rint(u)
        for quarter in range(4):
            put(whole & (u % 4 == quarter), known_at_quarter(quarter, request))
        if "am_deg" in table:
            table["am_deg"] = np.where(whole, 90 * u, table["am_deg"])
        if request.imaginary:
            put(u == 1, {"omega11_imag": 0})
    put(u == 0, known_values(Fraction(0), request))
    if request.size and not request.imaginary:
        poles = abs(table["u"]) == abs(float(request.size))
        put(poles, dict.fromkeys(("omega11", "pi11"), math.nan))
