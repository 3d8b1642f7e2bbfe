"""The formulas that `lagtop explain` shows, evaluated by mpmath with the numbers of the record."""

from __future__ import annotations

import re
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from lagrange_cli import Motion, Top, solve
from lagrange_cli.motion.explanation import column_formula, explanations, listed
from lagrange_cli.motion.over_time.columns import COLUMNS
from lagrange_cli.motion.record import all_keys, number_key

TOPS = {
    "worked example": Top(),
    "loops": Top(psidot0=-8.0, theta0_deg=70.0),
    "any start": Top(r0=-35.0, theta0_deg=100.0, thetadot0=3.0, psidot0=2.0),
    "steady at 40 degrees": Top(r0=60.0, theta0_deg=40.0, psidot0=1.0),
}
WITHOUT = {"m", "A", "C", "s", "g", "r0", "theta0_deg", "thetadot0", "psidot0"}


def functions(motion: Motion) -> dict[str, Any]:
    """Return the functions and constants of formulas, and the time at which the axis is at u1."""

    def rate(t: float, name: str = "thetadot") -> float:
        return float(motion.table([t], [name])[name][0])

    times = np.linspace(0, motion.T_nutation, 65)
    rates = motion.table(times, ["thetadot"])["thetadot"]
    (rises,) = np.nonzero((rates[:-1] < 0) & (rates[1:] > 0))
    t1 = brentq(rate, times[rises[0]], times[rises[0] + 1], xtol=1e-15) if rises.size else 0.0
    return {
        **{name: getattr(mpmath, name) for name in "acos asin atan sqrt cos sin exp pi".split()},
        "ellint_F": lambda phi, k: mpmath.ellipf(phi, k * k),
        "ellint_E": lambda phi, k: mpmath.ellipe(phi, k * k),
        "ellint_Pi": lambda n, k: mpmath.ellippi(n, k * k),
        "sn": lambda u, k: mpmath.ellipfun("sn", u, m=k * k),
        "integral": lambda name, low, high: quad(
            rate, float(low), float(high), args=(name,), epsabs=1e-11, limit=200
        )[0],
        "abs": abs,
        "max": max,
        "t1": t1,
    }


def evaluated(formula: str, names: dict[str, Any]) -> tuple[Any, Any]:
    """Return both sides of an equation; the left one is None if there is only a value."""
    text, _, abbreviations = formula.partition(" where ")
    text = re.sub(r"integral\((\w+),", r"integral('\1',", text)
    for part in filter(None, re.split(r", (?=[A-Z] = )", abbreviations)):
        name, _, meaning = part.partition(" = ")
        names = names | {name: eval(meaning, {}, names)}
    left, _, right = text.rpartition(" = ")
    return (eval(left, {}, names) if left else None), eval(right, {}, names)


def numbers_of(motion: Motion) -> dict[str, Any]:
    record = motion.record(radians=True, keys=all_keys(radians=True))
    bare = {name.removesuffix("_rad"): value for name, value in record.items()}
    return {name: value for name, value in bare.items() if isinstance(value, float)}


@pytest.mark.parametrize("top", TOPS.values(), ids=TOPS)
def test_the_formula_of_a_key_gives_its_number(top: Top) -> None:
    motion = solve(top)
    numbers = numbers_of(motion)
    names = functions(motion) | numbers
    checked = set()
    for key in all_keys():
        name, shown = key.removesuffix("_deg"), number_key(key)
        if shown is None or name not in numbers:
            continue
        left, right = evaluated(shown.formula, names)
        value = numbers[name] if left is None else left
        assert float(right) == pytest.approx(float(value), rel=1e-8, abs=1e-9), key
        checked.add(key)
    assert len(checked) >= 40


@pytest.mark.parametrize("top", TOPS.values(), ids=TOPS)
def test_the_formula_of_a_column_gives_its_number(top: Top) -> None:
    motion = solve(top)
    t = 0.3 * motion.T_nutation
    values = {name: float(x[0]) for name, x in motion.table([t], list(COLUMNS)).items()}
    names = functions(motion) | numbers_of(motion) | values
    for column in COLUMNS.values():
        for part in column.parts:
            name = part.heading.removesuffix("_*")
            if not part.formula:
                assert name == "t"
                continue
            at = {"t": t - names["t1"]} if name == "u" else {}
            left, right = evaluated(part.formula, names | at)
            value = values[name] if left is None else left
            if name.startswith("quaternion"):  # a quaternion and its opposite are one attitude
                assert abs(float(right)) == pytest.approx(abs(value), abs=1e-9), name
            else:
                assert float(right) == pytest.approx(float(value), rel=1e-8, abs=1e-9), name


def test_every_number_has_a_formula() -> None:
    assert all(row.text for row in listed() if row.name not in WITHOUT | {"regime", "path", "t"})
    assert column_formula(COLUMNS["axis"]).count(" = ") == 3


def test_a_formula_is_shown_in_symbols_and_with_numbers() -> None:
    (row,) = explanations(solve(Top()), ["T_nutation"])
    assert row.formula == "4 K/√(a (u3 - u2))"
    assert row.numbers == "4·1.9298/√(319.091·(1.29042 - 0.276952))"
    assert row.value == solve(Top()).T_nutation
    (tilt,) = explanations(solve(Top()), ["spin_rate_start"])
    assert tilt.formula == "r0 - ψ'0 cos(ϑ0)"
    assert tilt.numbers == "50 - 0·cos(30°)"
