"""The formulas over other arithmetics, which they do not know: doubles, arrays and pairs."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from lagtop import Top, solve
from scenes import EPS, EVERY_KIND, NAMED

from lagrange_cli.arithmetic.arrays import PAIRS
from lagrange_cli.arithmetic.ball import Ball, balls
from lagrange_cli.arithmetic.double_double import DoubleDouble
from lagrange_cli.arithmetic.numbers import DOUBLES
from lagrange_cli.motion.any_start import gaps_from_start
from lagrange_cli.motion.gaps import Gaps, State, gaps_from_rest, state
from lagrange_cli.motion.numbers import kind_of
from lagrange_cli.motion.record import NUMBER_KEYS
from lagrange_cli.motion.regime import Facts
from lagrange_cli.motion.regime import exact as exact_of

SCENES: dict[str, dict[str, float]] = {
    **{x: EVERY_KIND[x] for x in ("worked example", "slow", "any start", "looping")},
    **{x: EVERY_KIND[x] for x in ("starts lowest", "fast")},
}


def newton(ar: Any, c2: Any, c1: Any, c0: Any, above: Any) -> Any:
    """Return the largest root of a cubic: Newton's method falls to it until it falls no more."""
    x = above
    while True:
        following = x - (((x + c2) * x + c1) * x + c0) / ((3 * x + 2 * c2) * x + c1)
        if not ar.anywhere(following < x):
            return x
        x = following


def gaps_by_newton(ar: Any, facts: Facts, begin: State[Any]) -> Gaps[Any]:
    """Return the gaps of any top, with `newton` for a start with rates."""
    return gaps_from_rest(ar, begin) if facts.falls else gaps_from_start(ar, begin, facts, newton)


def start_of(top: Top) -> State[Ball]:
    """Return the constants and the start of a top in sixty digits."""
    with balls(60) as ar:
        return state(ar, exact_of(top))


def in_doubles(begin: State[Ball]) -> State[float]:
    return State(*(float(x.middle) for x in begin))


def keys_in_doubles(top: Top) -> dict[str, Any]:
    """Return the numbers of a record in doubles."""
    facts, begin = exact_of(top).facts, in_doubles(start_of(top))
    motion: Any = kind_of(facts)(DOUBLES, facts, begin, gaps_by_newton(DOUBLES, facts, begin))
    return {key: getattr(motion, key) for key in NUMBER_KEYS if key not in motion.lacks}


@pytest.mark.parametrize("scene", NAMED.values(), ids=NAMED)
def test_after_rest_every_key_is_good_in_doubles(scene: dict[str, float]) -> None:
    top = Top(**scene)
    floats = keys_in_doubles(top)
    for key, value in solve(top).numbers().items():
        assert value is not None
        unit: float = 1 if key in ("u1", "u2", "u_quarter") else abs(value)
        unit = max(unit, abs(float(top.r0))) if key == "spin_rate_half" else unit
        assert abs(floats[key] - value) <= 6 * EPS * unit, key


def polished(ar: Any, c2: Any, c1: Any, c0: Any, bound: Any) -> Any:
    """Return the largest root with one more step: pairs are compared by their larger halves."""
    x = newton(ar, c2, c1, c0, bound)
    return x - (((x + c2) * x + c1) * x + c0) / ((3 * x + 2 * c2) * x + c1)


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_pairs_of_doubles_give_the_gaps(scene: dict[str, float]) -> None:
    """Pairs have no sine: their start comes from balls.  The worst error seen is 1e-29."""
    top = Top(**scene)
    begin, kind = start_of(top), solve(top).sharp()
    with balls(60):
        halves = [(float(x.middle), float((x - float(x.middle)).middle)) for x in begin]
    start: State[DoubleDouble] = State(
        *(DoubleDouble(np.array([x]), np.array([y])) for x, y in halves)
    )
    if kind.facts.at_rest:
        computed = gaps_from_rest(PAIRS, start)
    else:
        computed = gaps_from_start(PAIRS, start, kind.facts, polished)
    scale = Fraction(max(abs(float(x.middle)) for x in (*begin, *kind.gaps)))
    for name, ours, theirs in zip(Gaps._fields, computed, kind.gaps, strict=True):
        value, exact = Fraction(ours.high[0]) + Fraction(ours.low[0]), Fraction(theirs.ends()[0])
        assert abs(value - exact) <= Fraction("1e-28") * (abs(exact) + scale), name
