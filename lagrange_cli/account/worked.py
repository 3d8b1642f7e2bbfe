"""The numbers of a motion in a formula, with as many digits as give the value of the formula."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Any

from flint import acb, arb

from ..arithmetic.enclosures import at_precision, settled
from ..arithmetic.formulas import evaluated
from ..arithmetic.text import value_text
from ..solver.numbers import FUNCTIONS, square
from ..solver.solve import Motion
from ..top.units import bare_name

_DIGITS = (None, 20, 25, 30, 40, 60, 100, 200, 400)
"""Digits of the numbers that are tried, doubles first."""
_MORE = 700
"""Digits of the arithmetic beyond those of the numbers: the formula may cancel."""
_SMALL = 0.01
"""A difference is small if it is smaller than this part of its first term."""


def worked(
    motion: Motion, key: str, formula: str, names: Mapping[str, str]
) -> tuple[str, dict[str, str], dict[str, str]]:
    """Return a formula with a name for each small difference, the differences, and all numbers.

    A small difference is `u1 - u2`, say; its name is `gap_0`.  `names` are the keys of the names,
    and `key` is that of the formula.  The numbers are texts of doubles or, if these do not give the
    value to its last digit but one, have more digits.  They are doubles if the motion has no such
    number, and for integrals over time.
    """
    gaps: dict[str, str] = {}

    def text(name: str, digits: int | None) -> str:
        if name in names:
            found = motion.number(names[name], digits)
        else:
            part, most = gaps.get(name, name), motion.facts.equal
            found = settled(part, lambda x: evaluated(part, motion.balls(x)), digits or 17, most)
        assert found is not None
        return value_text(found.value).removesuffix(".0")

    for part in dict.fromkeys(re.findall(r"\((\w+ [+-] \w+)\)", formula)):
        first, _, other = part.split()
        if not {first, other} <= {*names, "1"}:
            continue
        size = 1.0 if first == "1" else abs(float(text(first, None)))
        if abs(float(text(part, None))) <= _SMALL * size:
            name = f"gap_{len(gaps)}"
            formula, gaps[name] = formula.replace(f"({part})", f"({name})"), part

    value = motion.number(key) if key and "integral(" not in formula else None
    for digits in _DIGITS:
        texts = {name: text(name, digits) for name in (*names, *gaps)}
        if value is None or _gives(formula, key, value.value, names, texts):
            return formula, gaps, texts
    return formula, gaps, {name: text(name, None) for name in (*names, *gaps)}


def _gives(
    formula: str, key: str, value: float, names: Mapping[str, str], texts: Mapping[str, str]
) -> bool:
    """Return whether texts in place of names give a value; for an equation, by Newton's step."""

    def off() -> arb:
        degree, own = arb.pi() / 180, bare_name(key)
        known = _FUNCTIONS | {"pi": arb.pi()}
        for name, text in texts.items():
            is_in_degrees = names.get(name, "").endswith("_deg")
            known[name] = arb(text) * (degree if is_in_degrees else 1)
        found = _value(formula, known)
        if " = " in formula.partition(" where ")[0]:
            step = known[own].mid() * arb(10) ** -12
            above, below = (_value(formula, known | {own: known[own] + x}) for x in (step, -step))
            found *= 2 * step / (above - below)
        else:
            found = found / (degree if key.endswith("_deg") else 1) - value
        return found

    last_but_one = 10.0 ** (math.floor(math.log10(abs(value))) - 14) if value else 1e-15
    digits = max(map(len, texts.values())) + _MORE
    return at_precision(digits, lambda: bool(abs(off()) < last_but_one))


def _value(formula: str, known: Mapping[str, Any]) -> arb:
    """Return the value of a formula as declared, or the difference of both sides."""
    plain, _, where = re.sub(r" \(limit.*?pole\)", "", formula).partition(" where ")
    names = dict(known)
    for part in filter(None, re.split(r", (?=[A-Z] = )", where)):
        name, _, meaning = part.partition(" = ")
        names[name] = evaluated(meaning, names)
    left, _, right = plain.rpartition(" = ")
    found: arb = evaluated(right, names) - (evaluated(left, names) if left else 0)
    return found


def _legendre(complete: Callable[[Any], acb], any_phi: Callable[..., acb]) -> Callable[..., arb]:
    """Return an integral of phi and k; a ball of phi around pi/2 has branches on both sides."""

    def integral(phi: arb, k: arb) -> arb:
        m = acb(square(k))
        return (complete(m) if phi.overlaps(arb.pi() / 2) else any_phi(acb(phi), m)).real

    return integral


_FUNCTIONS: dict[str, Any] = FUNCTIONS | {
    **{"asin": arb.asin, "cos": arb.cos, "exp": arb.exp, "sin": arb.sin},
    "ellint_F": _legendre(acb.elliptic_k, acb.elliptic_f),
    "ellint_E": _legendre(acb.elliptic_e, acb.elliptic_e_inc),
    "ellint_Pi": lambda n, k: acb.elliptic_pi(acb(n), acb(square(k))).real,
}
