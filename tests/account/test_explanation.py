"""The sentence before a record, and formulas of `lagtop explain` evaluated with its numbers."""

from __future__ import annotations

import math
import re
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import Lagtop, Solved
from lagtop import Motion, Top, solve
from scipy.integrate import quad
from scipy.optimize import brentq

from lagrange_cli.account.explanation import explanations, listed
from lagrange_cli.account.summary import summary
from lagrange_cli.solver.columns import COLUMNS, SCALARS, shown_columns
from lagrange_cli.solver.keys import NUMBERS, TEXT_KEYS, all_keys
from lagrange_cli.top.units import Units, bare_name

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


@pytest.mark.parametrize("top", TOPS.values(), ids=TOPS)
def test_the_formula_of_a_key_or_column_gives_its_number(top: Top) -> None:
    motion = solve(top)
    record = motion.record(radians=True, keys=all_keys(Units(radians=True)))
    numbers = {bare_name(key): x for key, x in record.items() if isinstance(x, float)}
    columns = motion.table([0.3 * motion.T_nutation], list(COLUMNS)[1:])
    numbers |= {name: float(x[0]) for name, x in columns.items()}
    names = functions(motion) | numbers | {"t": 0.3 * motion.T_nutation}
    shown = {bare_name(key): line for key, line in NUMBERS.items()} | SCALARS
    checked = [name for name in numbers if name in shown]
    for name in checked:
        left, right = evaluated(shown[name].formula, names)
        value = numbers[name] if left is None else left
        if name.startswith("quaternion"):  # a quaternion and its opposite are one attitude
            right, value = abs(right), abs(value)
        assert float(right) == pytest.approx(float(value), rel=1e-8, abs=1e-9), name
    assert len(checked) >= 40 + len(columns)


def test_every_number_has_a_formula() -> None:
    assert all(row.text for row in listed() if row.name not in WITHOUT | {*TEXT_KEYS, "t"})
    assert shown_columns()["axis"].formula.count(" = ") == 3


SHOWN = {"·": "*", "²": "**2", "√": "sqrt", "arc": "a", "F(": "ellint_F(", "E(": "ellint_E("}
SHOWN |= {"Π": "ellint_Pi", "π": "pi", "t₁": "t1"}


OVER_POLES = {
    "lower": Top(theta0_deg=180, r0=20, thetadot0=1),
    "upper": Top(theta0_deg=0, r0=20, thetadot0=1),
    "upper lower": Top(theta0_deg=60, r0=0, thetadot0=50),
}
"""Tops by the poles that the axis passes over."""


def of_numbers(text: str) -> tuple[Any, Any]:
    """Return both sides of a formula that is shown with numbers, in many digits."""
    for gap in re.findall(r"(?:,| where) (\S+ [+-] \S+) = (\S+?)(?=,|$)", text):
        text = text.replace(f"({gap[0]})", f"({gap[1]})")
        text = re.sub(rf"(, | where ){re.escape(' = '.join(gap))}", "", text)
    for shown, word in SHOWN.items():
        text = text.replace(shown, word)
    text = re.sub(r"(?<![\w.])(\d+\.?\d*(?:e[+-]?\d+)?)(°?)", r"mpf('\1')\2", text)
    text = text.replace("°", "*pi/180").replace("**mpf('2')", "**2")
    with mpmath.workdps(60):
        names = functions(solve(Top())) | {"mpf": mpmath.mpf, "pi": mpmath.mp.pi}
        return evaluated(re.sub(r" \(limit.*? pole\)", "", text), names)


HARD = {
    "P and Q cancel": Top(r0=55.2, theta0_deg=176.3, thetadot0=-7.9),
    "sides cancel": Top(r0=80.3, theta0_deg=6.4, psidot0=1.7),
    "fast": Top(r0=1e6, psidot0=1e-5),
}


@pytest.mark.parametrize("name", TOPS | OVER_POLES | HARD)
def test_the_formula_with_numbers_gives_the_number(name: str) -> None:
    """To its last digit but one; over a pole it shows its limit, and no division by 0."""
    motion, checked = solve((TOPS | OVER_POLES | HARD)[name]), 0
    for row in explanations(motion, [key for key in all_keys() if key != "remark"]):
        if not row.numbers or "∫" in row.numbers or row.kind == "column":
            continue
        if row.name in {"mean_spin_rate", "mean_precession_rate"}:
            limits = re.findall(r"\(limit over the (\w+) pole\)", row.numbers)
            assert limits == (name.split() if name in OVER_POLES else [])
        left, right = of_numbers(row.numbers)
        if left is None:
            value = right * 180 / mpmath.pi if row.name.endswith("_deg") else right
            last = 10.0 ** (math.floor(math.log10(abs(row.value))) - 14) if row.value else 1e-14
            assert abs(value - row.value) < last, row
        else:
            assert abs(left - right) <= 1e-13 * float(motion.a) + 1e-6 * abs(right), row
        checked += 1
    assert checked >= 40


def test_numbers_differ_in_as_many_digits_as_that_takes() -> None:
    for r0 in (1e3, 1e5, 1e7):
        motion = solve(Top(r0=r0))
        low, high = re.findall(r"[\d.]+(?= and| deg)", summary(motion))[:2]
        assert float(low) == 30.0 < float(high)
        assert float(high) == pytest.approx(motion.theta_max_deg, rel=1e-3)


def test_the_sentence_does_not_depend_on_the_digits_of_the_record(solved: Solved) -> None:
    near_a_pole = ("--theta0", 179.9999999, "--psidot0", 0.3)
    sentences = {solved(*near_a_pole, *more)["summary"] for more in ((), ("--digits", 5))}
    assert len(sentences) == 1
    assert "nutates between 179.99999990 and 179.99999993 deg" in sentences.pop()
    beyond = ("--g", 0, "--theta0", 30, "--r0", 1e-309, "--psidot0", 1e-310, "--digits", 20)
    assert "summary" not in solved(*beyond)


def test_small_differences_are_named_in_order() -> None:
    (row,) = explanations(solve(Top(r0=55.2, theta0_deg=176.3)), ["mean_precession_rate"])
    named = re.findall(r", (\S+ [+-] \S+) = ", row.numbers)
    assert named == ["u1 - u2", "β + b", "u2 - u1", "1 + u2"]


def test_a_missing_number_has_no_value(lagtop: Lagtop) -> None:
    shown = lagtop("explain", "K", "--theta0", 0).stdout
    assert "missing  K, k: undefined" in shown
    assert "value" not in shown
