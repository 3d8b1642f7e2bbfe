"""Known inputs of a fit: what they determine of the body, and whether the recording agrees."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError, Message, arg
from ..names import check_names
from ..output.report import uncertain_text
from ..top.inputs import checked_double
from ..top.top import INPUTS, Top
from ..top.values import STEADY_WORDS

Known = Mapping[str, tuple[float, float]]
"""Known inputs by key, theta0 in radians, with standard deviations, which may be 0.

The key `steady` stands for `psidot0` if that is one of the STEADY_WORDS.
"""
WEIGHT = {"m", "g", "s"}
CONTRADICTS = 3.0
"""Standard deviations from which a known input contradicts the recording."""
_MOST_TURNS, _APART = 10, 6.0
"""A known C selects among spins that differ by whole turns per row: the most turns, and the least
distance of these spins in standard deviations."""
_UNITS = (6.0, 2 * math.pi, 30 / math.pi, 180 / math.pi, 60.0, 100.0, 1e3, 1e4, 1e6, 1e7)
_ROUGHLY = 0.02
"""Factors between units, in either direction, and how close a contradiction is to them."""
_CLOCK = "the unit of t"
_RATES = ("b", "r0", "phidot0", "thetadot0", "psidot0", "mean_spin_rate", "mean_precession_rate")
_POWERS = {"a": -2, "g": -2, "T_nutation": 1, "T_precession": 1, "precession_rate": -1}
_POWERS |= dict.fromkeys(_RATES, -1)


def known_inputs(given: Mapping[str, Any], stds: Mapping[str, float]) -> Known:
    """Return known inputs from inputs of `Top`, and the standard deviations of some.

    Raises LagtopError for an input that a fit cannot use.
    """
    check_names("known", [*given] or ["m"], INPUTS)
    words = {name for name in given if given[name] in STEADY_WORDS}
    known = {x: checked_double(x, y) for x, y in given.items() if x not in words}
    for name in ("m", "s", "g", "A", "C", "r0"):
        if known.get(name) == 0:
            raise LagtopError(f"{name} must not be 0 in a fit: leave it out", name)
    if "A_cm" in known and not {"m", "s"} <= known.keys():
        raise LagtopError("A_cm must be given with m and s, as A = A_cm + m s^2", "A_cm")
    plain = {x: y for x, y in known.items() if x not in {"A_cm", "phidot0"}}
    if "A_cm" in known:
        plain["A"] = known["A_cm"] + known["m"] * known["s"] ** 2
    moment = plain.get("A", known.get("C", 1.0))
    Top(**{"m": 1.0, "s": 1.0, "g": 1.0, "A": moment, "C": moment, **plain})  # checks the inputs
    pairs = {name: (value, stds.get(name, 0.0)) for name, value in known.items()}
    for key, unit in (("theta0_deg", math.pi / 180), ("theta0_rad", 1.0)):
        if key in pairs:
            value, std = pairs.pop(key)
            pairs["theta0"] = value * unit, std * unit
    return pairs | dict.fromkeys(["steady"] * bool(words), (0.0, 0.0))


def time_power(key: str) -> int:
    """Return the power of time in the unit of a number of a fit, such as -1 for r0."""
    above, _, below = key.removesuffix("_elementary").partition("/")
    powers = [_POWERS.get(x, 0) for x in above.split("*")]
    return sum(powers) - sum(_POWERS.get(x, 0) for x in re.findall(r"\w+", below))


def scaled_known(known: Known, scale: float) -> Known:
    """Return known inputs in another unit of time, `scale` times as long."""
    return {
        key: (value / scale ** time_power(key), std / scale ** time_power(key))
        for key, (value, std) in known.items()
    }


def body_numbers(torque: Array, b: Array, has: Mapping[str, Array]) -> dict[str, Array]:
    """Return the unknown inputs of the body, or products of them, from mgs/A, b and known inputs.

    The names of products are such as `m*s/A`.
    """
    has, found = dict(has), dict[str, Array]()
    if "A" not in has:
        if WEIGHT <= has.keys():
            found["A"] = has["m"] * has["g"] * has["s"] / torque
        elif {"C", "r0"} <= has.keys():
            found["A"] = has["C"] * has["r0"] / b
        has |= found
    over, moment = ("", has["A"]) if "A" in has else ("/A", 1.0)
    for names, value in ((("C", "r0"), b), (("m", "g", "s"), torque)):
        if unknown := [x for x in names if x not in has]:
            rest = math.prod(has[x] for x in names if x in has)
            found["*".join(unknown) + over] = value * moment / rest
    return dict(sorted(found.items()))


def estimates(
    known: Known, v: Mapping[str, Array], turn: float, *, spins: bool
) -> dict[str, Array]:
    """Return estimates of known inputs from the motion and the other known inputs.

    `v` has the quantities of a motion that was fitted without them, `turn` is 2 pi per frame if
    whole turns are invisible, else 0, and `spins` is true if the spin is recorded.
    """
    found = {x: v[x] for x in ("theta0", "thetadot0", "psidot0") if x in known}
    rates = {"r0": v["r0"], "phidot0": v["r0"] - v["psidot0"] * np.cos(v["theta0"])}
    for name in rates.keys() & known.keys() if spins else ():
        found[name] = _nearest(rates[name], known[name][0], turn)
    moment = v.get("A")
    if WEIGHT <= known.keys():
        implied = v["m"] * v["g"] * v["s"] / (v["a"] / 2)
        if "A_cm" in known:
            found["A_cm"] = implied - v["m"] * v["s"] ** 2
        elif "A" in known:
            found["A"] = implied
        moment = implied if moment is None else moment
    if "C" in known and moment is not None and (spins or {"r0", "phidot0"} & known.keys()):
        r0 = v["r0"]
        if "r0" in known:
            r0 = np.full_like(r0, known["r0"][0])
        elif spins:
            wanted = float((v["b"] * moment)[0]) / known["C"][0]
            r0 = _nearest(r0, wanted, turn) if abs(wanted) <= _MOST_TURNS * turn else r0
        found["C"] = v["b"] * moment / r0
    return found


def compared(
    name: str, given: tuple[float, float], found: tuple[float, float], known: Known
) -> tuple[float, bool, str]:
    """Return the distance of a known input from its value by the recording, in sigmas.

    A text says whether both agree, as the second number does, and else what to omit or check.
    """
    size, unit = (180 / math.pi, " deg") if name == "theta0" else (1.0, "")
    far = abs(given[0] - found[0]) / max(math.hypot(given[1], found[1]), 1e-9 * abs(found[0]))
    shown, own = (
        (uncertain_text(x * size, std * size) if std else f"{x * size:.6g}") + unit
        for x, std in (given, found)
    )
    verb = "agrees with" if far <= CONTRADICTS else "contradicts"
    text = f"known {name} = {shown} {verb} the recording, which gives {own}"
    if far <= CONTRADICTS:
        return far, True, f"{text}: {far:.1f} sigma"
    text = f"{text}, {_plain(far)} sigma apart"
    if name == "A" and WEIGHT <= known.keys():
        added = given[0] + known["m"][0] * known["s"][0] ** 2
        if abs(added - found[0]) <= CONTRADICTS * math.hypot(given[1], found[1]):
            text += ": it is about the centre of mass, so give "
            return far, False, Message(f"{text}{arg('A_cm')} instead")
    ratio = given[0] / found[0] if found[0] else math.inf
    for factor in (x for unit in _UNITS for x in (unit, 1 / unit)):
        if abs(ratio / factor - 1) < _ROUGHLY:
            more = f"{_plain(factor)} times as large"
            times = more if factor > 1 else f"1/{_plain(1 / factor)} of it"
            text += f", about {times}: check the units, or omit {arg(name)}"
            return far, False, Message(text)
    others = [x for x in ("m", "g", "s", "A", "A_cm", "r0") if x in known and x != name]
    others += [_CLOCK] * (WEIGHT <= known.keys() and not 1 / 3 < abs(ratio) < 3)
    checks = dict.fromkeys(("A", "A_cm", "C"), ", ".join(others))
    checks |= dict.fromkeys(("r0", "phidot0"), _CLOCK)
    check = f", or check {checks[name]}" if checks.get(name) else ""
    return far, False, Message(f"{text}: omit {arg(name)}{check}")


def _plain(x: float) -> str:
    """Return a factor in three digits, and up to a million without an exponent."""
    return f"{x:.3g}" if not 1000 <= x < 1e6 else f"{x:.0f}"


def selects_any(turns: float, spread: float) -> bool:
    """Return whether several spins that differ by whole turns per row meet a known C.

    `turns` are those per row of the spin that C implies, and `spread` is their relative standard
    deviation.  A C that implies more than _MOST_TURNS is wrong.
    """
    return 0.5 < turns <= _MOST_TURNS and turns * spread * _APART > 1


def whole_turns(rate: float, wanted: float, turn: float) -> float:
    """Return the whole turns per row that bring a rate next to a wanted one."""
    return turn * round((wanted - rate) / turn) if turn else 0.0


def _nearest(rate: Array, given: float, turn: float) -> Array:
    """Return rates that are shifted together by whole turns to be nearest to a given one."""
    return rate + whole_turns(float(rate[0]), given, turn)
