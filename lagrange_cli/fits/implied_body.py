"""What a motion tells of the body: its inputs, and those that cannot be told apart.

A motion shows a = 2mgs/A (4,4) and b = C r0/A (4,5), and r0 where the spin is seen.  Their
logarithms are linear in those of the six inputs; what is not known by itself is left as a product
of powers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import NamedTuple

BODY_INPUTS = ("C", "r0", "m", "s", "g", "A")
"""The inputs of a body and its spin; what stands first is expressed by what stands last."""
_EXPONENTS: Mapping[str, Mapping[str, int]] = {
    "a": {"m": 1, "s": 1, "g": 1, "A": -1},
    "b": {"C": 1, "r0": 1, "A": -1},
    "r0": {"r0": 1},
}
"""The inputs whose product each number is; a stands for a/2."""


class DeterminedProduct(NamedTuple):
    """A product of powers of inputs that the numbers and the known inputs tell."""

    powers: Mapping[str, Fraction]
    value: float
    shares: Mapping[str, Fraction]
    """Powers of the numbers a, b and r0 in it, for its uncertainty."""

    @property
    def name(self) -> str:
        """The product as text, such as `m*s/A`."""
        above = "*".join(_power(x, n) for x, n in self.powers.items() if n > 0)
        below = "*".join(_power(x, -n) for x, n in self.powers.items() if n < 0)
        return f"{above}/{below}" if below else above


def _power(name: str, exponent: Fraction) -> str:
    return name if exponent == 1 else f"{name}^{exponent}"


def determined_products(
    seen: Mapping[str, float], known: Mapping[str, float]
) -> list[DeterminedProduct]:
    """Return what is told of the inputs that are not known: single ones, and products.

    `seen` are a, b and, where it is seen, r0; none of them is 0.
    """
    unknown = [name for name in BODY_INPUTS if name not in known]
    rows = []
    for number, value in seen.items():
        powers = [Fraction(_EXPONENTS[number].get(name, 0)) for name in unknown]
        shares = [Fraction(int(other == number)) for other in seen]
        size = abs(value / 2 if number == "a" else value)
        logarithm = math.log(size) - sum(
            n * math.log(abs(known[name]))
            for name, n in _EXPONENTS[number].items()
            if name in known
        )
        rows.append((powers, shares, logarithm))
    told = []
    for powers, shares, logarithm in _reduced(rows, len(unknown)):
        named = {name: n for name, n in zip(unknown, powers, strict=True) if n}
        sign = math.copysign(1.0, seen["b"]) if named.get("r0") else 1.0
        parts = {number: n for number, n in zip(seen, shares, strict=True) if n}
        told.append(DeterminedProduct(named, sign * math.exp(logarithm), parts))
    return told


Row = tuple[list[Fraction], list[Fraction], float]


def _reduced(rows: list[Row], width: int) -> list[Row]:
    """Return the rows in echelon form, each with a first power of 1, without those of no input."""
    done: list[Row] = []
    left = list(rows)
    for column in range(width):
        pivot = next((row for row in left if row[0][column]), None)
        if pivot is None:
            continue
        left.remove(pivot)
        pivot = _scaled(pivot, 1 / pivot[0][column])
        left = [_less(row, pivot, row[0][column]) for row in left]
        done = [_less(row, pivot, row[0][column]) for row in done] + [pivot]
    return done


def _scaled(row: Row, factor: Fraction) -> Row:
    powers, shares, logarithm = row
    return [factor * x for x in powers], [factor * x for x in shares], float(factor) * logarithm


def _less(row: Row, other: Row, times: Fraction) -> Row:
    """Return a row less so many times another."""
    return (
        [x - times * y for x, y in zip(row[0], other[0], strict=True)],
        [x - times * y for x, y in zip(row[1], other[1], strict=True)],
        row[2] - float(times) * other[2],
    )


def completed_body(
    seen: Mapping[str, float], known: Mapping[str, float], told: list[DeterminedProduct]
) -> dict[str, float]:
    """Return all six inputs of a body that moves so; what is not told is 1, or such that C = A.

    A product that is told stands in its first input; m and s that are told as a product are shared
    out so that m s^2 = A/10, as of a body that can be built.
    """
    others = {"r0": seen["b"], "A": known.get("C", 1.0)}
    inputs = {name: others.get(name, 1.0) for name in BODY_INPUTS} | dict(known)
    for x in told:
        (name, power), *rest = x.powers.items()
        assert power == 1
        inputs[name] = x.value / math.prod(inputs[other] ** float(n) for other, n in rest)
    if not {"m", "s"} & known.keys():
        product = inputs["m"] * inputs["s"]
        inputs["s"] = inputs["A"] / (10 * product)
        inputs["m"] = product / inputs["s"]
    return {name: inputs[name] for name in ("m", "A", "C", "s", "g", "r0")}
