"""The top: its body, its initial state, and the checks on both."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from types import MappingProxyType
from typing import Any, NamedTuple, Self

from ..arithmetic.enclosures import pi_to, text_of
from ..arithmetic.numbers import Real, unrounded
from ..errors import LagtopError
from ..names import suggestion
from .derived import Spin, Tilt, exact_inputs, steady_rate_of
from .inputs import (
    BODY,
    DECLARED,
    EXAMPLE,
    INPUTS,
    NINE,
    TILT,
    checked_double,
    from_example,
    one_of_each,
    overridden,
    replaced_by,
    warn_of,
)
from .units import Units

_EPS, _DEGREE = Fraction(1, 1 << 52), math.pi / 180
_LEAST_TILT, _SMALLEST = Fraction(1, 10**150), Fraction(1, 10**100)  # decimals, and below doubles
_LARGEST = 1e100
_UNITS = "choose other units"
_OTHER_END = {"s": "the centre of mass is beyond the pivot", "g": "gravity acts upwards"}
"""Causes of a negative input that turning the top over describes."""
_TURNED_OVER = "with 180 - theta0, -r0 and -thetadot0"


class BodyAndStart(NamedTuple):
    """The inputs of a top by key: m, A, C, s and g of its body, and the others of its start."""

    body: dict[str, Real]
    start: dict[str, Real]


_EXAMPLE: Any = None
"""The default of an input: its value in the worked example."""


@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Top:
    """A heavy symmetric top with a fixed point, and its state at t = 0, where phi = psi = 0.

    Use any consistent units.  Inputs you omit default to the worked example of Chrapan (1952),
    section 8, in CGS.  A MixedBodyWarning names the defaults if you give only some of m, A, C, s
    and g, and C > 2A, which no rigid body has, is then an error.  Each input is a real number: int,
    float, Fraction, Decimal or a NumPy scalar.  It is taken exactly: a number that is not a double,
    such as Decimal("0.1"), is kept as a Fraction.

        m, A, C     mass, equatorial and polar moment about the pivot, > 0
        A_cm        in place of A: the equatorial moment about the centre of mass, A = A_cm + m s^2
        s, g        distance from the pivot to the centre of mass, and gravity, >= 0
        r0          total spin rate: the constant angular velocity about the figure axis (any sign)
        phidot0     in place of r0: the rate of phi at t = 0, r0 = phidot0 + psidot0 cos(theta0)
        spin_period in place of phidot0: the time of one turn of phi, phidot0 = 2 pi/spin_period
        theta0_deg  tilt of the figure axis from the upward vertical, 0 to 180 degrees (default 30),
        theta0_rad  or the same in radians, 0 to pi; not both
        thetadot0   nutation rate at t = 0
        psidot0     precession rate at t = 0; "steady" or "steady-fast" is the exact rate of
                    smaller or larger size at which the tilt stays constant, for thetadot0 = 0

    A and r0 that are derived from A_cm and phidot0 are the nearest doubles.  The motion is computed
    from the exact numbers, also for the word steady.  Raises LagtopError for a body or a start that
    is impossible, TypeError for an unknown input.

    >>> top = Top(r0=60, theta0_deg=45)
    >>> top.parts.start
    {'r0': 60.0, 'theta0_deg': 45.0, 'thetadot0': 0.0, 'psidot0': 0.0}
    >>> top.replace(r0=50) == Top(**top.parts.body, theta0_deg=45)
    True
    >>> top.is_released, top.caveat(), top.inputs()["m"], top.as_dict()["m"]
    (True, None, 1587.0, 1587.0)
    """

    m: Real = _EXAMPLE
    A: Real = _EXAMPLE
    C: Real = _EXAMPLE
    s: Real = _EXAMPLE
    g: Real = _EXAMPLE
    r0: Real = _EXAMPLE
    theta0_deg: Real | None = None
    thetadot0: Real = _EXAMPLE
    psidot0: Any = None
    theta0_rad: Real | None = None
    A_cm: Real | None = None
    phidot0: Real | None = None
    spin_period: Real | None = None
    _given: dict[str, Any] = field(init=False, hash=False)

    def __new__(cls, *values: Any, **inputs: Any) -> Self:
        """Return a new top.  Raises TypeError for an unknown input with the name that was meant."""
        if values:
            raise TypeError("a top takes inputs by name, such as Top(theta0_deg=30, r0=50)")
        for name in inputs.keys() - set(INPUTS):
            raise TypeError(f"a top has no input {name!r}{suggestion(name, INPUTS)}")
        return object.__new__(cls)

    def __post_init__(self) -> None:
        """Replace missing inputs by their defaults, derive others, and check all."""
        inputs = {name: x for name in INPUTS if (x := getattr(self, name)) is not None}
        inputs = {
            name: x if name == "psidot0" and isinstance(x, str) else _checked(name, x)
            for name, x in inputs.items()
        }
        one_of_each(inputs)
        kept = overridden(EXAMPLE, inputs)
        given = {x: kept[x] for x in sorted(kept, key=lambda x: NINE.index(replaced_by(x)))}
        values = dict.fromkeys(INPUTS) | given | _derived(given) | {"_given": given}
        for name, x in values.items():
            object.__setattr__(self, name, x)
        if missing := from_example(inputs):
            self.check_body()
            warn_of(missing, stacklevel=4)

    @property
    def given(self) -> Mapping[str, Any]:
        """The inputs that were given, by key, and the defaults of those that were not.

        Attributes hold the numbers that follow: A, r0 and psidot0 always, None for another form.
        """
        return MappingProxyType(self._given)

    def __repr__(self) -> str:
        return f"Top({', '.join(f'{name}={x!r}' for name, x in self.given.items())})"

    def as_dict(self) -> dict[str, Any]:
        """Return the inputs by key as given; of two inputs that replace each other, one is None."""
        return {name: self.given.get(name) for name in INPUTS}

    def exact(self, name: str) -> Fraction:
        """Return an input as a fraction, also in a form in which it was not given.

        A rate that is derived from the tilt is irrational: then `name` must not be r0 or psidot0.
        """
        found: Fraction = exact_inputs(self.given)[name]
        return found

    @property
    def exact_tilt(self) -> Tilt:
        """The tilt, with its exact sine and cosine."""
        return Tilt.of(self.given)

    @property
    def exact_spin(self) -> Spin:
        """The total rate r0, linear in the precession if it is derived from the rate of phi."""
        return Spin.of(self.given)

    @property
    def steady_word(self) -> str | None:
        """The word that was given for psidot0, which then is the nearest double, or None."""
        return word if isinstance(word := self.given["psidot0"], str) else None

    def replace(self, **changes: Any) -> Self:
        """Return the top with other values of some inputs, such as `replace(r0=60)`.

        An input replaces another way to give it: A replaces A_cm, r0 replaces phidot0, a tilt in
        radians one in degrees, and vice versa.  Raises LagtopError.
        """
        return type(self)(**overridden(self.given, changes))

    @property
    def parts(self) -> BodyAndStart:
        """The inputs by key in two parts, `body` and `start`, such as for a sweep of one body."""
        body = {name: x for name, x in self.given.items() if replaced_by(name) in BODY}
        start = {name: x for name, x in self.given.items() if name not in body}
        return BodyAndStart(body, start)

    def inputs(self, *, radians: bool = False) -> dict[str, Any]:
        """Return the nine inputs by record key, the tilt in degrees or in radians."""
        tilt, number = self.exact_tilt, float(self.exact_tilt.number)
        if radians == (tilt.radians is None):  # given in the other unit
            number = number * _DEGREE if radians else number / _DEGREE
        key = Units(radians).key(f"{TILT}_deg")
        keys = (key if name == TILT else name for name in NINE)
        return {x: number if (y := getattr(self, x)) is None else y for x in keys}

    @property
    def is_released(self) -> bool:
        """Whether the top starts at rest in nutation and precession, the case of the paper."""
        return bool(self.thetadot0 == 0 and self.psidot0 == 0)

    def check_body(self) -> None:
        """Raise LagtopError for C > 2A, which no body has; as numbers, they can be computed."""
        twice, remedy = 2 * self.exact("A"), "no rigid body has more"
        _require(twice >= self.exact("C"), "C", f"<= 2 A = {_shown(twice)}", self.C, remedy)

    def caveat(self) -> str | None:
        """Return a line on a body that cannot be built, or None; A may be off by its rounding."""
        A, offset = self.exact("A"), Fraction(self.m) * Fraction(self.s) ** 2
        limit, rounding = 2 * (A - offset), A * _EPS
        if limit + rounding <= 0:
            name, bound, most = "A", "A > m s^2", offset
        elif self.C > limit + rounding:
            name, bound, most = "C", "C <= 2 (A - m s^2)", limit
        else:
            return None
        least, own = (f"{float(x):.15g}" for x in (most, getattr(self, name)))
        return f"a rigid body needs {bound} = {least}, but {name} is {own}; computed anyway"

    def as_text(self) -> str:
        """Return the inputs as a text, such as `m=1587.0 A=39032.0`, without rates that are 0."""
        kept = (x for x in self.given.items() if x[1] or x[0] not in {"thetadot0", "psidot0"})
        return " ".join(f"{name}={value}" for name, value in kept)


def _derived(given: Mapping[str, Any]) -> dict[str, Real]:
    """Return A, psidot0 and r0 as numbers, those that are derived as the nearest doubles.

    Raises LagtopError if a top cannot have them.
    """
    exact, turn = exact_inputs(given), given["psidot0"]
    A = given.get("A") or _checked("A", float(exact["A"]))
    if isinstance(turn, str):
        turn = steady_rate_of(given, turn)
    r0 = given.get("r0")
    if r0 is None:
        r0 = _checked("r0", Spin.of(given).nearest(turn, Tilt.of(given)))
    return {"A": A, "psidot0": turn, "r0": r0}


def _checked(name: str, value: Any) -> Real:
    """Return an input as a double or as a fraction.  Raises LagtopError for an impossible one."""
    nearest = checked_double(name, value)
    if not math.isfinite(nearest):
        raise LagtopError(f"{name} must be finite, got {nearest}", name)
    if value and not nearest and not isinstance(value, Fraction):
        raise LagtopError(f"{name} must be 0 or at least 5e-324 in magnitude, got {value!s}", name)
    number: Real = unrounded(value, nearest)
    _require(-_LARGEST <= number <= _LARGEST, name, "within 1e100 in magnitude", number, _UNITS)
    bound = DECLARED[name].bound if name in DECLARED else ""
    if bound.startswith("positive"):
        _require(number > 0, name, "> 0", number)
        _require(number >= _SMALLEST, name, ">= 1e-100", number, _UNITS)
    if bound == "0 or more":
        is_turned = name in _OTHER_END
        remedy = f"if {_OTHER_END[name]}, use |{name}| {_TURNED_OVER}" if is_turned else ""
        _require(number >= 0, name, ">= 0", number, remedy)
    if bound.startswith("not 0"):
        _require(not -_SMALLEST < number < _SMALLEST, name, "1e-100 or more in magnitude", number)
    if name.startswith(f"{TILT}_"):
        exact: Fraction = Fraction(number)
        in_degrees = name.endswith("deg")
        most = Fraction(180) if in_degrees else pi_to(exact.denominator.bit_length() + 20)
        wanted = "in [0, 180]" if in_degrees else "in [0, pi rad]"
        _require(0 <= exact <= most, name, wanted, number)
        _require(not number or number >= _LEAST_TILT, name, "0 or at least 1e-150", number)
    return number


def _require(fine: bool, name: str, wanted: str, value: Real, remedy: str = "") -> None:
    if not fine:
        hint = f" ({remedy})" if remedy else ""
        raise LagtopError(f"{name} must be {wanted}, got {_shown(value)}{hint}", name)


def _shown(value: Real) -> str:
    """Return a number as text, with enough digits to tell 180.00000000000000000001 from 180."""
    is_double = isinstance(value, float) or (abs(value) <= _LARGEST and float(value) == value)
    return str(float(value)) if is_double else text_of(Fraction(value), 50)
