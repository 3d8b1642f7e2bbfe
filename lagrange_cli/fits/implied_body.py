"""The body that a motion implies: its inputs, and products of inputs not determined separately.

A motion determines a = 2mgs/A (4,4) and b = C r0/A (4,5), and r0 if the spin is recorded.  The
logarithms of these numbers are linear in the logarithms of the six inputs.  These equations are
brought to echelon form.  An input that is not determined alone remains in a product of powers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import NamedTuple

BODY_INPUTS = ("C", "r0", "m", "s", "g", "A")
"""The inputs of a body and its spin; earlier ones are expressed by later ones."""
_EXPONENTS: Mapping[str, Mapping[str, int]] = {
    "a": {"m": 1, "s": 1, "g": 1, "A": -1},
    "b": {"C": 1, "r0": 1, "A": -1},
    "b/a": {"C": 1, "r0": 1, "m": -1, "s": -1, "g": -1},
    "r0": {"r0": 1},
}
"""The inputs whose product is each number; a means a/2 here, and b/a means 2b/a."""

_FACTORS = {"a": 0.5, "b/a": 2.0}


class DeterminedProduct(NamedTuple):
    """A product of powers of inputs that the numbers and the known inputs determine."""

    powers: Mapping[str, Fraction]
    value: float
    shares: Mapping[str, Fraction]
    """Powers of a, b, r0 and the known inputs in the product, for its uncertainty."""

    @property
    def name(self) -> str:
        """The product as text, such as `m*s/A`."""
        above = "*".join(_power(x, n) for x, n in self.powers.items() if n > 0)
        below = [_power(x, -n) for x, n in self.powers.items() if n < 0]
        product = "*".join(below)
        return f"{above}/{f'({product})' if len(below) > 1 else product}" if below else above


def _power(name: str, exponent: Fraction) -> str:
    return name if exponent == 1 else f"{name}^{exponent}"


def determined_products(
    seen: Mapping[str, float], known: Mapping[str, float]
) -> list[DeterminedProduct]:
    """Return the unknown inputs that are determined, single or as products.

    `seen` are a, b and, if the spin is recorded, r0; if one of them is 0, none is determined.
    """
    if not all(seen.values()):
        return []
    unknown = [name for name in BODY_INPUTS if name not in known]
    others = [*seen, *known]
    rows = []
    for number in seen:
        powers = _EXPONENTS[number]
        right = [Fraction(x == number) - (powers.get(x, 0) if x in known else 0) for x in others]
        rows.append([*(Fraction(powers.get(x, 0)) for x in unknown), *right])
    sizes = [abs(x * _FACTORS.get(name, 1.0)) for name, x in {**seen, **known}.items()]
    products = []
    for row in _reduced(rows, len(unknown)):
        named = {name: n for name, n in zip(unknown, row, strict=False) if n}
        shares = dict(zip(others, row[len(unknown) :], strict=True))
        size = math.prod(x ** float(n) for x, n in zip(sizes, shares.values(), strict=True))
        spin = seen["b"] if "b" in seen else seen["b/a"]
        sign = math.copysign(1.0, spin) if named.get("r0") else 1.0
        parts = {name: n for name, n in shares.items() if n}
        products.append(DeterminedProduct(named, sign * size, parts))
    return products


def _reduced(rows: list[list[Fraction]], width: int) -> list[list[Fraction]]:
    """Return rows in echelon form of the first columns, without rows that are 0 in these."""
    done: list[list[Fraction]] = []
    for column in range(width):
        pivot = next((row for row in rows if row[column]), None)
        if pivot is None:
            continue
        one = [x / pivot[column] for x in pivot]
        rest = [row for row in rows if row is not pivot]
        rows, done = (
            [[x - row[column] * y for x, y in zip(row, one, strict=True)] for row in part]
            for part in (rest, done)
        )
        done.append(one)
    return done


def completed_body(seen: Mapping[str, float], known: Mapping[str, float]) -> dict[str, float]:
    """Return all six inputs of a body with this motion.

    Undetermined inputs are A = 1, C = A and g = 1.  The first input of a determined product takes
    its value.  A product of m and s is split so that m s^2 = A/10, which a real body can have.
    """
    others = {"r0": seen["b"], "A": known.get("C", 1.0)}
    inputs = {name: others.get(name, 1.0) for name in BODY_INPUTS} | dict(known)
    for x in determined_products(seen, known):
        (name, power), *rest = x.powers.items()
        assert power == 1
        inputs[name] = x.value / math.prod(inputs[other] ** float(n) for other, n in rest)
    if not {"m", "s"} & known.keys():
        product = inputs["m"] * inputs["s"]
        inputs["s"] = inputs["A"] / (10 * product)
        inputs["m"] = product / inputs["s"]
    return {name: inputs[name] for name in ("m", "A", "C", "s", "g", "r0")}
