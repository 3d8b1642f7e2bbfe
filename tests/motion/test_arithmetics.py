"""The formulas over other arithmetics, none of which they know: dual numbers, pairs, and more."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from dual_numbers import Dual, Duals
from scenes import EPS, UNIT

from lagrange_cli import Top, solve
from lagrange_cli.arithmetic.arrays import PAIRS
from lagrange_cli.arithmetic.decimals import decimals
from lagrange_cli.arithmetic.double_double import DoubleDouble
from lagrange_cli.arithmetic.doubles import DOUBLES
from lagrange_cli.arithmetic.many_digits import ManyDigits
from lagrange_cli.motion.gaps import State, gaps_from_start, gaps_of, largest_root, state
from lagrange_cli.motion.kinds import kind_of
from lagrange_cli.motion.record import CANCELLING, NUMBER_KEYS
from lagrange_cli.motion.regime import exact as exact_of

SCENES: dict[str, dict[str, float]] = {
    "worked example": {},
    "from rest, slow": UNIT | {"r0": 0.5, "theta0_deg": 130},
    "from rest, fast": UNIT | {"r0": -9, "theta0_deg": 40},
    "any start": UNIT | {"r0": 2, "theta0_deg": 70, "thetadot0": 0.75, "psidot0": 0.5},
    "against the spin": UNIT | {"r0": -3, "theta0_deg": 110, "thetadot0": 1.5, "psidot0": 1},
    "starts lowest": UNIT | {"r0": 3, "theta0_deg": 40, "psidot0": 2},
}


def keys_in(ar: Any, top: Top, start: Any = None) -> dict[str, Any]:
    """Return the numbers of a record in any arithmetic, from another start where there is one."""
    exact = exact_of(top)
    with ar.working():
        begin = state(ar, exact) if start is None else start
        motion = kind_of(exact.facts)(ar, exact.facts, begin, gaps_of(ar, exact.facts, begin))
        return {key: getattr(motion, key) for key in NUMBER_KEYS if key not in motion.lacks}


def moving(ar: Duals, top: Top, name: str) -> State[Dual]:
    """Return the start of a top, with its derivatives by one of the inputs."""
    begin = state(ar, exact_of(top))
    plain = ar.plain
    A, C = plain.convert(Fraction(top.A)), plain.convert(Fraction(top.C))
    a, b, r0 = begin.a, begin.b, begin.r0
    da = {"m": a.value / plain.convert(Fraction(top.m)), "A": -a.value / A}.get(name, 0)
    db = {"r0": C / A, "A": -b.value / A, "C": r0.value / A}.get(name, 0)
    a, b, r0 = Dual(a.value, da), Dual(b.value, db), Dual(r0.value, int(name == "r0"))
    arc = plain.pi / 180 if name == "theta0_deg" else Decimal(0)
    tilt = {
        "sin": Dual(begin.sin.value, begin.cos.value * arc),
        "cos": Dual(begin.cos.value, -begin.sin.value * arc),
        "sin_half": Dual(begin.sin_half.value, begin.cos_half.value * arc / 2),
        "cos_half": Dual(begin.cos_half.value, -begin.sin_half.value * arc / 2),
    }
    rates = {
        "theta_rate": Dual(begin.theta_rate.value, int(name == "thetadot0")),
        "psi_rate": Dual(begin.psi_rate.value, int(name == "psidot0")),
    }
    return State(a, b, r0, b * b / 2 - a, r0 - b / 2, r0 - b, **tilt, **rates)


STEP = Fraction(1, 10**20)
INPUTS = ["m", "A", "C", "r0", "theta0_deg", "thetadot0", "psidot0"]


DIRECTIONS = [
    (scene, name)
    for scene, inputs in SCENES.items()
    for name in INPUTS
    if name not in {"thetadot0", "psidot0"} or inputs.get(name)
]
"""Rates that are 0 are left out: after release from rest the formulas are those of rest."""


@pytest.mark.parametrize(("scene", "name"), DIRECTIONS)
def test_dual_numbers_give_derivatives(scene: str, name: str) -> None:
    """Each derivative is that of solutions in 80 digits, a step of 1e-20 to either side."""
    top, ar = Top(**SCENES[scene]), Duals(60)
    with ar.working():
        start = moving(ar, top, name)
    computed = keys_in(ar, top, start)
    told = [key for key, dual in computed.items() if dual is not None and dual.rate]
    assert len(told) >= 8
    value = Fraction(getattr(top, name))
    ahead, behind = (
        solve(top.replace(**{name: value + shift})).settled_kind(70) for shift in (STEP, -STEP)
    )
    with ahead.ar.working():
        for key, dual in computed.items():
            if dual is None:
                continue
            slope = (getattr(ahead, key) - getattr(behind, key)) / (2 * Decimal(1) / 10**20)
            size = max(1, abs(slope), abs(dual.value))
            assert abs(dual.rate - slope) <= Decimal("1e-25") * size, key


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


def polished(ar: Any, c2: Any, c1: Any, c0: Any, bound: Any) -> Any:
    """Return the largest root with one more step: pairs are compared by their larger halves."""
    x = largest_root(ar, c2, c1, c0, bound)
    return x - (((x + c2) * x + c1) * x + c0) / ((3 * x + 2 * c2) * x + c1)


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_pairs_of_doubles_give_the_gaps(scene: dict[str, float]) -> None:
    """Pairs have no sine: their start comes from decimals.  The worst seen is 1e-29."""
    top = Top(**scene)
    exact, ar = exact_of(top), decimals(60)
    with ar.working():
        begin = state(ar, exact)
        wanted = gaps_of(ar, exact.facts, begin)
        halves = [(float(x), float(x - Decimal(float(x)))) for x in begin]
        start: State[DoubleDouble] = State(
            *(DoubleDouble(np.array([x]), np.array([y])) for x, y in halves)
        )
        if exact.facts.at_rest:
            computed = gaps_of(PAIRS, exact.facts, start)
        else:
            computed = gaps_from_start(PAIRS, start, exact.facts, polished)
        scale = max(abs(x) for x in (*begin, *wanted))
        for name, ours, theirs in zip(wanted.fields, computed, wanted, strict=True):
            value = Decimal(float(ours.high[0])) + Decimal(float(ours.low[0]))
            assert abs(value - theirs) <= Decimal("1e-28") * (abs(theirs) + scale), name
