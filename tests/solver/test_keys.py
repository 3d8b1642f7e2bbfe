"""The table of keys: printed formulas have the values of the evaluated ones.

`test_digits` compares all numbers with a reference of other formulas.
"""

from __future__ import annotations

import random
from collections import ChainMap
from functools import partial
from typing import Any

import pytest
from flint import acb, arb
from hard_scenes import KINDS
from lagtop import Top, solve

from lagrange_cli.arithmetic.enclosures import at_precision
from lagrange_cli.solver.keys import LINES
from lagrange_cli.solver.numbers import Numbers, code_of

DIGITS = 120
PRINTED: dict[str, Any] = {
    "asin": lambda x: x.asin(),
    "atan": lambda x: x.atan(),
    "exp": lambda x: x.exp(),
    "ellint_Pi": lambda n, k: acb.elliptic_pi(acb(n), acb(k * k)).real,
}
"""The functions that only printed formulas use."""


def sides(formula: str, of: Numbers) -> list[arb]:
    """Return the sides of a printed equation, or the value of a printed formula."""
    names = ChainMap(PRINTED, of)
    return [eval(code_of(side), {}, names) for side in formula.partition(" where ")[0].split(" = ")]


TWO_FORMS = [
    name
    for name, line in LINES.items()
    if line.evaluated not in line.formula and "integral" not in line.formula
]


@pytest.mark.parametrize("kind", ["generic", "from rest", "slow", "thresholds"])
def test_the_printed_formula_has_the_value_of_the_evaluated_one(kind: str) -> None:
    """Fifty random tops of a kind, to thirty digits."""
    assert len(TWO_FORMS) >= 15
    checked = 0
    for i in range(50):
        motion = solve(Top(**KINDS[kind](random.Random(f"{kind} {i}"))))
        if not motion.facts.a or not motion.facts.nutates:
            continue
        of = motion.balls(DIGITS)
        for name in TWO_FORMS:
            if name in {"P", "Q", "U", "V"} or motion.has(name):
                formula = LINES[name].formula
                *left, right = at_precision(DIGITS, partial(sides, formula, of))
                value = left[0] if left else of[name]
                apart, size = abs(value - right), abs(value) + abs(right) + arb(10) ** -60
                assert apart.abs_upper() <= arb(10) ** -30 * size.abs_upper(), (name, motion.top)
                checked += 1
    assert checked > 15 * 30
