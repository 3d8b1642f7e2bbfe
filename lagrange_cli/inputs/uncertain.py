"""Uncertain inputs: the forms of their numbers, and the correlations between them.

`1587(2)`, `1587+/-2`, `1587+-2`, `1587±2` and `1587 +/- 0.1 %` are uncertain numbers.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping
from fractions import Fraction
from itertools import product

from ..arithmetic.text import parse_number, quoted
from ..errors import LagtopError

_DECIMAL = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_PLUS_MINUS = rf"(?P<number>{_DECIMAL})\s*(?:\+/?-|±)\s*(?P<std>{_DECIMAL})\s*(?P<percent>%?)"
_FORMS = (
    r"(?P<number>[+-]?(?:\d+\.?\d*|\.\d+))\((?P<last>\d+\.?\d*)\)(?P<exponent>[eE].*)?",
    _PLUS_MINUS,
    rf"\(\s*{_PLUS_MINUS}\s*\)(?P<exponent>[eE].*)?",
)
_ROUNDING = Fraction(1, 10**14)
"""A variance up to this size, of variables with variance 1, counts as 0."""
_TOLERANCE = 1e-6
"""Largest error of a correlation, because files have rounded ones."""

Correlations = Mapping[tuple[str, str], Fraction]
"""The correlation matrix by pair of inputs, in both orders; 1 for an input with itself."""


def split_uncertainty(text: str) -> tuple[str, Fraction]:
    """Return the number in an uncertain number, as text, and its standard uncertainty.

    Raises LagtopError for any other text, and for a negative uncertainty.
    """
    found = _form_of(text)
    if found is None:
        forms = "1587(2), 1587+/-2 or 1587+/-0.1%"
        raise LagtopError(f"must be a number, or an uncertain one as {forms}, got {quoted(text)}")
    parts = found.groupdict(default="")
    exponent = parts.get("exponent", "")
    number, power = parts["number"] + exponent, parse_number(f"1{exponent}")
    if "last" in parts:
        last = parts["last"]
        decimals = 0 if "." in last else len(parts["number"].partition(".")[2])
        std = parse_number(f"{last}e-{decimals}") * power
    else:
        std = parse_number(parts["std"]) * power
        std = abs(parse_number(number)) * std / 100 if parts["percent"] else std
    if std < 0:
        raise LagtopError(f"must have an uncertainty >= 0, got {quoted(text)}")
    return number, std


def _form_of(text: str) -> re.Match[str] | None:
    return next((match for form in _FORMS if (match := re.fullmatch(form, text))), None)


def uncertainty_in(text: str) -> str:
    """Return the uncertainty of an uncertain number as it is written, such as `(2)`, or nothing."""
    found = re.search(r"\([\d.]+\)|(\+/?-|±)\s*[^\s)%]+(\s*%)?", text) if _form_of(text) else None
    return found[0] if found else ""


def independent_sources(
    correlations: Correlations,
) -> list[tuple[Fraction, Mapping[str, Fraction]]]:
    """Return the variances of the independent sources of uncertainty, and their shares by input.

    A source changes each input by its share of the standard uncertainty.  The matrix
    of correlations is L D L^T: the shares are the columns of L, the variances the diagonal of D.
    """
    left, names = dict(correlations), [x for x, y in correlations if x == y]
    sources: list[tuple[Fraction, Mapping[str, Fraction]]] = []
    for i, name in enumerate(names):
        if (variance := left[name, name]) > _ROUNDING:
            shares = {x: left[name, x] / variance for x in names[i:] if left[name, x]}
            sources.append((variance, shares))
            for x, y in product(shares, repeat=2):
                left[x, y] -= shares[x] * shares[y] * variance
    return sources


def are_possible(correlations: Correlations) -> bool:
    """Return whether the matrix of correlations is positive semidefinite, up to rounding."""
    made: dict[tuple[str, str], Fraction] = defaultdict(Fraction)
    for variance, shares in independent_sources(correlations):
        for x, y in product(shares, repeat=2):
            made[x, y] += variance * shares[x] * shares[y]
    return all(abs(made[pair] - r) < _TOLERANCE for pair, r in correlations.items())
