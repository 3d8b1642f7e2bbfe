"""The formulas over other arithmetics, none of which they know: mpmath, doubles and pairs."""

from __future__ import annotations

from decimal import Decimal
from typing import Any, cast

import numpy as np
import pytest
from lagtop import Top, solve
from scenes import EPS, EVERY_KIND, NAMED

from lagrange_cli.arithmetic.arrays import ARRAYS, PAIRS
from lagrange_cli.arithmetic.decimals import decimals
from lagrange_cli.arithmetic.double_double import DoubleDouble
from lagrange_cli.arithmetic.numbers import DOUBLES
from lagrange_cli.elliptic.many_digits import ManyDigits
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


CANCELLING = frozenset(
    "u1 u2 u_quarter mean_spin_rate mean_precession_rate T_spin T_precession "
    "spin_rate_start spin_rate_half precession_rate_half".split()
)
"""Keys in which larger numbers may cancel."""


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


def keys_in(ar: Any, top: Top) -> dict[str, Any]:
    """Return the numbers of a record in any arithmetic."""
    exact = exact_of(top)
    with ar.working():
        begin = state(ar, exact)
        gaps = gaps_by_newton(ar, exact.facts, begin)
        motion = kind_of(exact.facts)(ar, exact.facts, begin, gaps)
        return {key: getattr(motion, key) for key in NUMBER_KEYS if key not in motion.lacks}


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_mpmath_and_doubles_give_what_decimals_give(scene: dict[str, float]) -> None:
    """Doubles are compared in the keys that do not cancel: the worst seen is 20 eps."""
    top = Top(**scene)
    motion = solve(top)
    many, floats = keys_in(ManyDigits(80), top), keys_in(DOUBLES, top)
    for key in NUMBER_KEYS:
        nearest = getattr(motion, key)
        if nearest is None:
            assert many.get(key) is floats.get(key) is None
            continue
        assert abs(float(many[key]) - nearest) <= EPS * EPS + EPS / 2 * abs(nearest), key
        if key not in CANCELLING:
            assert abs(floats[key] - nearest) <= 22 * EPS * abs(nearest), key


@pytest.mark.parametrize("scene", NAMED.values(), ids=NAMED)
def test_after_rest_every_key_is_good_in_doubles(scene: dict[str, float]) -> None:
    """Floats and mpmath give what decimals give: the formulas do not depend on the digits."""
    top = Top(**scene)
    nearest = cast(dict[str, Any], solve(top).numbers())
    many, floats = keys_in(ManyDigits(80), top), keys_in(DOUBLES, top)
    for key, value in nearest.items():
        assert float(many[key]) == value, key
        unit: float = 1 if key in ("u1", "u2", "u_quarter") else abs(value)
        unit = max(unit, abs(float(top.r0))) if key == "spin_rate_half" else unit
        assert abs(floats[key] - value) <= 6 * EPS * unit, key


def test_the_formulas_hold_on_arrays() -> None:
    tops = [Top(**scene) for scene in NAMED.values()]
    states = [state(DOUBLES, exact_of(top)) for top in tops]
    together = gaps_from_rest(ARRAYS, State(*map(np.array, zip(*states, strict=True))))
    for i, one in enumerate(states):
        alone = gaps_from_rest(DOUBLES, one)
        assert [float(gaps[i]) for gaps in together] == pytest.approx(list(alone), rel=4 * EPS)


def polished(ar: Any, c2: Any, c1: Any, c0: Any, bound: Any) -> Any:
    """Return the largest root with one more step: pairs are compared by their larger halves."""
    x = newton(ar, c2, c1, c0, bound)
    return x - (((x + c2) * x + c1) * x + c0) / ((3 * x + 2 * c2) * x + c1)


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_pairs_of_doubles_give_the_gaps(scene: dict[str, float]) -> None:
    """Pairs have no sine: their start comes from decimals.  The worst seen is 1e-29."""
    top = Top(**scene)
    exact, ar = exact_of(top), decimals(60)
    with ar.working():
        begin = state(ar, exact)
        wanted = gaps_by_newton(ar, exact.facts, begin)
        halves = [(float(x), float(x - Decimal(float(x)))) for x in begin]
        start: State[DoubleDouble] = State(
            *(DoubleDouble(np.array([x]), np.array([y])) for x, y in halves)
        )
        if exact.facts.at_rest:
            computed = gaps_from_rest(PAIRS, start)
        else:
            computed = gaps_from_start(PAIRS, start, exact.facts, polished)
        scale = max(abs(x) for x in (*begin, *wanted))
        for name, ours, theirs in zip(wanted.fields, computed, wanted, strict=True):
            value = Decimal(float(ours.high[0])) + Decimal(float(ours.low[0]))
            assert abs(value - theirs) <= Decimal("1e-28") * (abs(theirs) + scale), name
