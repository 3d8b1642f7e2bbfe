"""The inputs of a top by key: meaning, unit, default and alternatives; warnings about defaults.

Help texts, tables of records, units, pictures and READMEs take the inputs from here.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
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


_TABLE = """
m | m | mass | mass | positive | mass | 1587
A | A | equatorial moment
    | equatorial moment about the pivot | positive | mass len² | 39032
A_cm | A_cm | moment about the centre of mass
    | equatorial moment about the centre of mass: A = A_cm + m s^2 | | mass len² |
C | C | polar moment | polar moment of inertia | positive, at most 2A | mass len² | 17458
s | s | pivot to centre of mass
    | distance from the pivot to the centre of mass | 0 or more | len | 4
g | g | gravity | gravitational acceleration | 0 or more | len/time² | 981
r0 | r0 | total spin rate
    | total spin rate about the axis, phi' + psi' cos(theta) | | rad/time | 50
phidot0 | φ'0 | spin rate at the start
    | spin rate at the start | instead of r0 = phidot0 + psidot0 cos(theta0) | rad/time |
theta0 | ϑ0 | tilt at the start
    | tilt from the upward vertical | 0 to 180 degrees | angle | 30
thetadot0 | ϑ'0 | nutation rate at the start | nutation rate at the start | | rad/time | 0
psidot0 | ψ'0 | precession rate at the start
    | precession rate at the start | or the word steady (slow) or steady-fast, to keep the tilt
    | rad/time | 0
"""


def declared(table: str) -> Iterator[list[str]]:
    """Yield the cells of a table, one row per line; indented lines continue the line before."""
    for line in table.strip().replace("\n ", " ").split("\n"):
        yield [cell.strip() for cell in line.split("|")]


DECLARED = {
    key: Input(symbol, name, meaning, bound, unit, float(default) if default else None)
    for key, symbol, name, meaning, bound, unit, default in declared(_TABLE)
}
"""Every input by key, in the order used everywhere."""

TILT = "theta0"
"""The key of a tilt whose value has a unit; the keys `theta0_deg` and `theta0_rad` imply one."""
STANDS_FOR = {"A_cm": "A", "phidot0": "r0"}
"""The measured inputs, and the inputs of a top that they replace."""
NINE = tuple(name for name in DECLARED if name not in STANDS_FOR)
EXAMPLE = {
    f"{name}_deg" if name == TILT else name: x.default
    for name, x in DECLARED.items()
    if x.default is not None
}
"""The inputs of the worked example of Chrapan (1952), section 8, in CGS: the defaults."""
BODY = {name: EXAMPLE[name] for name in ("m", "A", "C", "s", "g")}
BODY_UNITS = {"m": "g", "A": "g*cm^2", "C": "g*cm^2", "s": "cm", "g": "cm/s^2"}
_POWERS = {"m": 3, "A": 7, "C": 7, "s": 2, "g": 2}
BODY_IN_SI = {name: Fraction(x) / 10 ** _POWERS[name] for name, x in BODY.items()}
_SAME = STANDS_FOR | dict.fromkeys(("theta0_deg", "theta0_rad"), TILT)


def overridden(inputs: Mapping[str, N], given: Mapping[str, N]) -> dict[str, N]:
    """Return inputs by key, overridden by the given ones.

    A tilt replaces a tilt in either unit, A_cm replaces A, and phidot0 replaces r0.
    """
    taken = {_SAME.get(key, key) for key in given}
    kept = {key: x for key, x in inputs.items() if _SAME.get(key, key) not in taken}
    return kept | dict(given)


def one_of_each(given: Iterable[str]) -> None:
    """Raise LagtopError if an input is given in two ways."""
    keys = set(given)
    for key, other in (*STANDS_FOR.items(), ("theta0_rad", "theta0_deg")):
        if {key, other} <= keys:
            raise LagtopError(f"{key} and {arg(other)} are both given: leave one out", key)


def from_example(given: Mapping[str, Any]) -> dict[str, float]:
    """Return the missing inputs of an incomplete body by key, with their defaults.

    None is missing if all given body inputs are 0, because zeros fit any units.
    """
    own = {"A" if name == "A_cm" else name for name in given} & BODY.keys()
    if all(isinstance(given.get(name), int | float | Fraction) and not given[name] for name in own):
        return {}
    return {name: value for name, value in BODY.items() if name not in own}


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
        raise LagtopError(f"{key} must be at most 1.8e308 in size", key) from None
