"""The numbers of a motion in a formula, with as many digits as give the value of the formula."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any, TypeVar

from flint import arb

from ..arithmetic.enclosures import settled
from ..arithmetic.text import double_text
from ..solver.solve import Motion
from ..top.units import bare_name

_DIGITS = (None, 20, 25, 30, 40, 60, 100, 200, 400)
"""Digits of the numbers that are tried, doubles first."""
_SMALL = 0.01
"""A difference is small if it is smaller than this part of its first term."""
_DIFFERENCE = re.compile(r"(\(\w+ [+-] \w+\))")
T = TypeVar("T")


def worked(motion: Motion, key: str, formula: str, names: Mapping[str, str]) -> dict[str, str]:
    """Return a number as text for each name in a formula and each small difference `(u1 - u2)`.

    `names` are the keys of the names, and `key` is that of the formula.  The numbers are doubles
    or, if these do not give the value to its last digit but one, have more digits.  They are
    doubles if the motion has no such number, and for integrals over time.
    """
    small = [part for part in {*_DIFFERENCE.findall(formula)} if _is_small(motion, names, part)]
    value = motion.number(key) if key and "integral(" not in formula else None

    def texts(digits: int | None) -> dict[str, str]:
        found = {name: _text(motion, own, digits) for name, own in names.items()}
        gaps = {part: _gap(motion, names, part, digits) for part in small}
        return {x: y.removesuffix(".0") for x, y in (found | gaps).items()}

    for digits in _DIGITS:
        found = texts(digits)
        if value is None or _gives(formula, key, value.value, names, found):
            return found
    return texts(None)


def _text(motion: Motion, key: str, digits: int | None) -> str:
    value = _present(motion.number(key, digits)).value
    return double_text(value) if digits is None else str(value)


def _is_small(motion: Motion, names: Mapping[str, str], part: str) -> bool:
    """Return whether a difference of names is small for its first term."""
    x, _, y = part[1:-1].split()
    if not {x, y} <= {*names, "1"}:
        return False
    size = 1.0 if x == "1" else abs(float(_text(motion, names[x], None)))
    return abs(float(_gap(motion, names, part, None))) <= _SMALL * size


def _gap(motion: Motion, names: Mapping[str, str], part: str, digits: int | None) -> str:
    """Return a sum or difference such as `(u1 - u2)` or `(1 + u2)` as text."""
    x, sign, y = part[1:-1].split()

    def ball(working: int) -> arb:
        one, other = (
            arb(1) if term == "1" else _present(motion.ball(names[term], working))
            for term in (x, y)
        )
        return one + other if sign == "+" else one - other

    return str(_present(settled(part, ball, digits or 17, motion.facts.equal)).value)


def _present(x: T | None) -> T:
    """Return a number that exists."""
    assert x is not None
    return x


def _gives(
    formula: str, key: str, value: float, names: Mapping[str, str], texts: Mapping[str, str]
) -> bool:
    """Return whether texts in place of names give a value; for an equation, by Newton's step."""
    import mpmath  # start-up

    def number(name: str) -> Any:
        return mpmath.mpf(texts[name]) * (degree if names[name].endswith("_deg") else 1)

    with mpmath.workdps(max(map(len, texts.values())) + 40):
        degree = mpmath.pi / 180
        known = {name: getattr(mpmath, name) for name in "acos asin cos exp pi sin sqrt".split()}
        known |= {"abs": abs, "max": max, "ellint_F": lambda phi, k: mpmath.ellipf(phi, k * k)}
        known |= {"ellint_E": lambda phi, k: mpmath.ellipe(phi, k * k)}
        known |= {"ellint_Pi": lambda n, k: mpmath.ellippi(n, k * k)}
        known |= {name: number(name) for name in names}
        for part in texts.keys() - names.keys():
            formula = formula.replace(part, f"(mpf('{texts[part]}'))")
        known["mpf"], own = mpmath.mpf, bare_name(key)

        def result(**changed: Any) -> Any:
            return _evaluated(formula, known | changed)

        try:
            if " = " in formula.partition(" where ")[0]:
                step = known[own] * mpmath.mpf(10) ** -12
                above, below = (result(**{own: known[own] + x}) for x in (step, -step))
                off = result() * 2 * step / (above - below)
            else:
                off = result() / (degree if key.endswith("_deg") else 1) - value
        except ZeroDivisionError:
            return False
        last_but_one = 10.0 ** (math.floor(math.log10(abs(value))) - 14) if value else 1e-15
        return bool(abs(off) < last_but_one)


def _evaluated(formula: str, known: Mapping[str, Any]) -> Any:
    """Return the value of a formula as declared, or the difference of both sides."""
    plain, _, where = re.sub(r" \(limit.*?pole\)", "", formula).partition(" where ")
    names = dict(known)
    for part in filter(None, re.split(r", (?=[A-Z] = )", where)):
        name, _, meaning = part.partition(" = ")
        names[name] = eval(meaning, {}, names)
    left, _, right = plain.rpartition(" = ")
    return eval(right, {}, names) - (eval(left, {}, names) if left else 0)
