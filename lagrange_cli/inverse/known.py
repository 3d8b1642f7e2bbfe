"""Known inputs of a fit: what they determine of the body, and whether the recording agrees."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..arithmetic.text import uncertain_text
from ..arithmetic.types import Array
from ..errors import LagtopError, Message, arg
from ..names import check_names
from ..top.forms import Quantities, equation_of, needed_by
from ..top.given import Given
from ..top.inputs import (
    BODY,
    DECLARED,
    FORMS,
    INPUTS,
    STEADY_WORDS,
    TILT,
    checked_double,
    replaced_by,
)
from ..top.top import Top
from ..top.units import power_of_time

Known = Mapping[str, tuple[float, float]]
"""Known inputs by key, theta0 in radians, with standard deviations, which may be 0.

The key `steady` stands for `psidot0` if that is one of the STEADY_WORDS.
"""
START = (TILT, "thetadot0", "psidot0")
WEIGHT = {"m", "g", "s"}
CONTRADICTS = 3.0
"""Standard deviations from which a known input contradicts the recording."""
_UNITS = (6.0, 2 * math.pi, 30 / math.pi, 10.0, 180 / math.pi, 60.0, 100.0, 1e3, 1e4, 1e6, 1e7)
_ROUGHLY = 0.02
"""Factors between units, in either direction, and how close a contradiction is to them."""
_OPPOSITE = "of the opposite sign"
_CLOCK = "the unit of t"
_POWERS = {"a": -2, "b": -1, "T_nutation": 1, "T_precession": 1, "precession_rate": -1}
_POWERS |= {"mean_spin_rate": -1, "mean_precession_rate": -1}
_POWERS |= {key: power_of_time(x.unit) for key, x in DECLARED.items()}


def known_inputs(found: Given) -> Known:
    """Return known inputs, some with standard deviations.

    Raises LagtopError for an input that a fit cannot use, and for C > 2A as `Given.top` does.
    """
    given, stds = found.inputs, found.stds
    check_names("known", [*given] or ["m"], INPUTS)
    words = {name for name in given if given[name] in STEADY_WORDS}
    known = {x: checked_double(x, y) for x, y in given.items() if x not in words}
    for name in ("m", "s", "g", "A", "C", "r0", "spin_period"):
        if known.get(name) == 0:
            raise LagtopError(f"{name} must not be 0 in a fit: leave it out", name)
    for name in known.keys() & FORMS.keys():
        body = [x for x in needed_by(name) if x in BODY]
        if not {*body} <= known.keys():
            wrong = f"{name} must be given with {' and '.join(body)}, as {equation_of(name)}"
            raise LagtopError(wrong, name)
    whole = in_all_forms(known)
    plain = {x: float(whole[x]) for x in (*BODY, *START[1:]) if whole.has(x)}
    plain |= {x: y for x, y in known.items() if replaced_by(x) in {TILT, "r0"}}
    moment = plain.get("A", plain.get("C", 1.0))
    top = Top(**{"m": 1.0, "s": 1.0, "g": 1.0, "A": moment, "C": moment, **plain})
    if found.is_body:
        top.check_body()
    pairs = {name: (value, stds.get(name, 0.0)) for name, value in known.items()}
    for name in [x for x in known if replaced_by(x) == TILT]:
        unit = in_all_forms({name: 1.0})[TILT]
        value, std = pairs.pop(name)
        pairs[TILT] = value * unit, std * unit
    return pairs | dict.fromkeys(["steady"] * bool(words), (0.0, 0.0))


def in_all_forms(values: Mapping[str, Any]) -> Quantities:
    """Return quantities of a motion that has inputs in any form; the tilt is in radians."""
    constants: Any = {"pi": lambda: math.pi, "sqrt": lambda: np.sqrt}
    found = Quantities(values, u0=lambda: np.cos(found[TILT]), **constants)
    return found


def body_of(known: Mapping[str, Any], start: Mapping[str, Any]) -> dict[str, Any]:
    """Return the inputs of the body and r0 that known ones determine in any form, with a start."""
    whole = in_all_forms({**known, **{x: start[x] for x in START}})
    return {x: whole[x] for x in (*BODY, "r0") if whole.has(x)}


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


def compared(
    name: str,
    given: tuple[float, float],
    found: tuple[float, float],
    known: Known,
    slowest: float | None = None,
) -> tuple[float, bool, str]:
    """Return the distance of a known input from its value by the recording, in sigmas.

    A text says whether both agree, as the second number does, and else what to omit or check.  If
    whole turns of the spin per row are invisible, `slowest` is the value for the slowest spin, of
    which the input may be a multiple by a unit.
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
        body = {x: known[x][0] for x in ("m", "s")}
        added = in_all_forms(body | {"A_cm": given[0]})["A"]
        if abs(added - found[0]) <= CONTRADICTS * math.hypot(given[1], found[1]):
            text += ": it is about the centre of mass, so give "
            return far, False, Message(f"{text}{arg('A_cm')} instead")
    ratio = given[0] / found[0] if found[0] else math.inf
    for value in dict.fromkeys((slowest or found[0], found[0])):
        if value and (times := _times(given[0] / value)):
            if value != found[0]:
                text = f"known {name} = {shown} contradicts the recording, which gives "
                text += f"{value * size:.6g}{unit} for the slowest spin"
            check = "the sign" if times == _OPPOSITE else "the units"
            return far, False, Message(f"{text}, {times}: check {check}, or omit {arg(name)}")
    others = [x for x in known if replaced_by(x) in {*WEIGHT, "A", "r0"} and x != name]
    others += [_CLOCK] * (WEIGHT <= known.keys() and not 1 / 3 < abs(ratio) < 3)
    checks = {"A": ", ".join(others), "C": ", ".join(others), "r0": _CLOCK}
    what = checks.get(replaced_by(name))
    check = f", or check {what}" if what else ""
    return far, False, Message(f"{text}: omit {arg(name)}{check}")


def _times(ratio: float) -> str:
    """Return in words which sign and unit make a ratio, or empty."""
    sign = f" and {_OPPOSITE}" if ratio < 0 else ""
    if abs(ratio + 1) < _ROUGHLY:
        return _OPPOSITE
    for factor in (x for unit in _UNITS for x in (unit, 1 / unit)):
        if abs(abs(ratio) / factor - 1) < _ROUGHLY:
            more = f"about {_plain(factor)} times as large"
            return (more if factor > 1 else f"about 1/{_plain(1 / factor)} of it") + sign
    return ""


def _plain(x: float) -> str:
    """Return a factor in three digits, and up to a million without an exponent."""
    return f"{x:.3g}" if not 1000 <= x < 1e6 else f"{x:.0f}"
