"""Formulas as text, compiled once; their names are looked up in any mapping."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from types import CodeType
from typing import Any

_BRACKETS = r"\((?:[^()]|\([^()]*\))*\)"
_SQUARED = re.compile(rf"(\w+(?:{_BRACKETS})?|{_BRACKETS})\*\*2")
"""A square of a name, a function or a sum: Arb has no power of a ball that contains 0."""


@cache
def code_of(formula: str) -> CodeType:
    """Return a formula compiled for `eval`, with `square(x)` for `x**2`."""
    text = _SQUARED.sub(r"square(\1)", formula)
    assert "**" not in text, formula
    return compile(text, "<formula>", "eval")


def evaluated(formula: str, names: Mapping[str, Any]) -> Any:
    """Return the value of a formula."""
    return eval(code_of(formula), {}, names)
