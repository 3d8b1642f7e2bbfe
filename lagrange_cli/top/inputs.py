"""The inputs of a top by key: meaning, unit, default and alternatives; warnings about defaults.

Help texts, tables of records, units, pictures and READMEs take the inputs from here.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any, NamedTuple, TypeVar

from ..arithmetic.numbers import Real, is_real
from ..arithmetic.text import quoted
from ..errors import LagtopError, MixedBodyWarning, arg

N = TypeVar("N")


class Input(NamedTuple):
    """An input of a top."""

    symbol: str
    name: str
    """A few words, for tables and pictures."""
    meaning: str
    """The full meaning, for help texts."""
    bound: str
    unit: str
    """The unit in words; `angle` means degrees or radians."""
    default: float | None
    """The value in the worked example, in CGS; None for an alternative to another input."""
    gives: str = ""
    """The input that this form gives: `A` or `r0`, or another form of one; empty for an input."""
    formula: str = ""
    """Its value from this form and others."""
    inverse: str = ""
    """The value of this form from it and others."""


_TABLE = """
m | m | mass | mass | positive | mass | 1587
A | A | equatorial moment
    | equatorial moment about the pivot | positive | mass len² | 39032
A_cm | A_cm | moment about the centre of mass
    | equatorial moment about the centre of mass (A = A_cm + m s^2) | 0 or more | mass len² |
    | A | A_cm + m*s*s | A - m*s*s
C | C | polar moment | polar moment of inertia
    | positive; above 2A only if m, A, C, s and g are given without units | mass len² | 17458
s | s | pivot to centre of mass
    | distance from the pivot to the centre of mass | 0 or more | len | 4
g | g | gravity | gravitational acceleration | 0 or more | len/time² | 981
r0 | r0 | total spin rate
    | total spin rate about the axis, phi' + psi' cos(theta) | | rad/time | 50
phidot0 | φ'0 | spin rate at the start
    | spin rate at the start | instead of r0 = phidot0 + psidot0 cos(theta0) | rad/time |
    | r0 | phidot0 + psidot0*u0 | r0 - psidot0*u0
spin_period | T_φ0 | spin period at the start
    | time of one turn of the spin at the start, seen from the gimbal (not by a camera at rest)
    | not 0; it sets phidot0 = 2 pi/spin_period
    | time |
    | phidot0 | 2*pi/spin_period | 2*pi/phidot0
theta0 | ϑ0 | tilt at the start
    | tilt from the upward vertical | 0 to 180 degrees | angle | 30
theta0_deg | ϑ0 | tilt at the start | | | deg | | theta0 | theta0_deg*pi/180 | theta0*180/pi
theta0_rad | ϑ0 | tilt at the start | | | rad | | theta0 | theta0_rad | theta0
thetadot0 | ϑ'0 | nutation rate at the start | nutation rate at the start | | rad/time | 0
psidot0 | ψ'0 | precession rate at the start
    | precession rate at the start | or the word steady (slow) or steady-fast, to keep the tilt
    | rad/time | 0
"""


def declared(table: str) -> Iterator[list[str]]:
    """Yield the cells of a table, one row per line; indented lines continue the line before.

    A stroke without a blank on both sides, as in `|r0|`, separates no cells.
    """
    for line in re.sub("\n +", " ", table.strip()).split("\n"):
        yield [cell.strip() for cell in re.split(r"(?<!\S)\|(?!\S)", line)]


STEADY_WORDS = ("steady", "steady-fast")
"""Words accepted as a precession rate: the steady rate of smaller or of larger size."""
TILT = "theta0"
"""The key of a tilt whose value has a unit; its forms `theta0_deg` and `theta0_rad` imply one."""
_ROWS = {
    key: Input(symbol, name, meaning, bound, unit, float(default) if default else None, *form)
    for key, symbol, name, meaning, bound, unit, default, *form in declared(_TABLE)
}
DECLARED = {key: x for key, x in _ROWS.items() if x.gives != TILT}
"""Every input by key, in the order used everywhere."""
FORMS = {key: x for key, x in _ROWS.items() if x.gives}
"""The measured inputs that stand for others, and the tilt in each unit."""
NINE = tuple(key for key, x in _ROWS.items() if not x.gives)
EXAMPLE = {
    f"{name}_deg" if name == TILT else name: x.default
    for name, x in DECLARED.items()
    if x.default is not None
}
"""The inputs of the worked example of Chrapan (1952), section 8, in CGS: the defaults."""
INPUTS = (*EXAMPLE, *(key for key in FORMS if key not in EXAMPLE))
"""The keys of all inputs of a top, the forms last."""
BODY = {name: EXAMPLE[name] for name in ("m", "A", "C", "s", "g")}
BODY_UNITS = {"m": "g", "A": "g*cm^2", "C": "g*cm^2", "s": "cm", "g": "cm/s^2"}


def replaced_by(key: str) -> str:
    """Return the input that a form stands for in the end, such as r0; other keys are their own."""
    return replaced_by(FORMS[key].gives) if key in FORMS else key


def all_replaced(keys: Iterable[str]) -> set[str]:
    """Return the inputs that some inputs determine in any form."""
    return {replaced_by(key) for key in keys}


def overridden(inputs: Mapping[str, N], given: Mapping[str, N]) -> dict[str, N]:
    """Return inputs by key, overridden by the given ones, also in another form."""
    taken = all_replaced(given)
    kept = {key: x for key, x in inputs.items() if replaced_by(key) not in taken}
    return kept | dict(given)


def one_of_each(given: Iterable[str]) -> None:
    """Raise LagtopError if an input is given in two ways."""
    keys = [key for key in reversed(INPUTS) if key in {*given}]  # a form before its input
    for key, other in combinations(keys, 2):
        if replaced_by(key) == replaced_by(other):
            raise LagtopError(f"{key} and {arg(other)} are both given: leave one out", key)


def from_example(given: Mapping[str, Any]) -> dict[str, float]:
    """Return the missing inputs of an incomplete body by key, with their defaults.

    None is missing if all given body inputs are 0, because zeros fit any units.
    """
    own = {name: replaced_by(name) for name in given if replaced_by(name) in BODY}
    if all(isinstance(given[name], int | float | Fraction) and not given[name] for name in own):
        return {}
    return {name: value for name, value in BODY.items() if name not in own.values()}


def remark_on(missing: Iterable[str], words: Sequence[str]) -> str:
    """Return a warning about missing inputs, with the words that set them."""
    *others, last = missing
    named = f"{', '.join(others)} and {last} default" if others else f"{last} defaults"
    return f"{named} to the worked example, in g, cm and s: {' '.join(words)}"


def warn_of(missing: Mapping[str, float], stacklevel: int) -> None:
    """Warn of missing inputs, with the arguments that set them."""
    arguments = ", ".join(f"{name}={value:g}" for name, value in missing.items())
    warnings.warn(remark_on(missing, [arguments]), MixedBodyWarning, stacklevel)


def checked_double(key: str, value: Real) -> float:
    """Return an input as the nearest double.  Raises LagtopError, also beyond their range."""
    try:
        if not is_real(value):
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise LagtopError(f"{key} must be a real number, got {quoted(value)}", key) from None
    except OverflowError:
        raise LagtopError(f"{key} must be at most 1.8e308 in magnitude", key) from None
