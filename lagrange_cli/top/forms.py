"""The forms of inputs: a quantity in any form from the ones that are given, in any arithmetic.

The formulas are those of the table in `inputs`.  They hold for fractions, balls, numbers of mpmath,
doubles, arrays and pairs of doubles.  Their names are keys of inputs, `pi`, and `u0` for the cosine
of the tilt; an inverse may use `sqrt`, too.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

from ..arithmetic.formulas import code_of, evaluated
from .inputs import FORMS


class Quantities(dict[str, Any]):
    """Inputs by key, in one arithmetic; those that are missing are computed on first use.

    A missing input is computed from a form of it that is given, and a missing form from its input.
    """

    def __init__(self, values: Mapping[str, Any], **constants: Callable[[], Any]) -> None:
        """Take values by key, and functions that return `pi` and `u0` if a formula needs them."""
        super().__init__(values)
        self.constants = constants

    def has(self, name: str) -> bool:
        """Return whether an input is given, in any form."""
        return name in self or any(map(self.has, _giving(name)))

    def form_of(self, name: str) -> str:
        """Return the form that gives an input directly, or the input itself if there is none."""
        return next(filter(self.has, _giving(name)), name)

    def __missing__(self, name: str) -> Any:
        if name in self.constants:
            return self.constants[name]()
        if (key := self.form_of(name)) != name:
            return self._computed(name, FORMS[key].formula)
        if name in FORMS:
            return self._computed(name, FORMS[name].inverse)
        raise KeyError(name)

    def _computed(self, name: str, formula: str) -> Any:
        value = self[name] = evaluated(formula, self)
        return value


@cache
def _giving(name: str) -> list[str]:
    """Return the forms whose formula gives an input."""
    return [key for key, form in FORMS.items() if form.gives == name]


def needed_by(key: str) -> tuple[str, ...]:
    """Return the names in the formula of a form, other than its own."""
    return tuple(name for name in code_of(FORMS[key].formula).co_names if name != key)


def equation_of(key: str) -> str:
    """Return the formula of a form, such as A = A_cm + m s^2."""
    form = FORMS[key]
    formula = re.sub(r"\b(\w+)\*\1\b", r"\1^2", form.formula)
    return f"{form.gives} = {formula.replace('*', ' ')}"
