"""One scene: the top, how it starts, and the guards on both."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple, TypeVar

from ..arithmetic import decimals
from ..arithmetic.generic import Arithmetic, Number, Real, number
from ..errors import LagtopError

N = TypeVar("N")

_LEAST_TILT = 1e-150
_LARGEST = 1e100
_UNITS = "choose other units"
_PI = Fraction(decimals.pi)


class Tilt(NamedTuple):
    """Sine and cosine of theta0 and of its half."""

    sin: Real
    cos: Real
    sin_half: Real
    cos_half: Real

    def degrees(self, ar: Arithmetic) -> Real:
        """The angle itself, in degrees."""
        return 360 * ar.atan2(self.sin_half, self.cos_half) / ar.pi


class _Inputs(NamedTuple):
    m: Number
    A: Number
    C: Number
    s: Number
    g: Number
    r0: Number
    theta0_deg: Number | None
    thetadot0: Number
    psidot0: Number
    theta0_rad: Number | None


class Top(_Inputs):
    """A heavy symmetric top with a fixed point, and its state at t = 0 (phi = psi = 0 there).

    Any consistent units; the defaults are the worked example of Chrapan (1952), section 8, in CGS.

    m, A, C     mass, equatorial and polar moment of inertia about the pivot, > 0; C <= 2A
    s, g        distance from the pivot to the centre of mass, and gravity, >= 0
    r0          spin: the angular velocity about the figure axis, which is constant (any sign)
    theta0_deg  tilt of the figure axis from the upward vertical, 0 to 180 degrees (default 30),
    theta0_rad  or the same in radians, 0 to pi; not both
    thetadot0   nutation rate at t = 0
    psidot0     precession rate at t = 0

    Raises LagtopError for a body or a start that cannot be.
    """

    # A named tuple and not a dataclass: that would take 3 % of the run of `lagtop solve`.
    __slots__ = ()

    def __new__(
        cls,
        *,
        m: Number = 1587.0,
        A: Number = 39032.0,
        C: Number = 17458.0,
        s: Number = 4.0,
        g: Number = 981.0,
        r0: Number = 50.0,
        theta0_deg: Number | None = None,
        thetadot0: Number = 0.0,
        psidot0: Number = 0.0,
        theta0_rad: Number | None = None,
    ) -> Top:
        """Check the inputs and keep them."""
        if theta0_deg is None and theta0_rad is None:
            theta0_deg = 30.0
        given = _Inputs(m, A, C, s, g, r0, theta0_deg, thetadot0, psidot0, theta0_rad)
        numbers: Iterator[Any] = (
            None if value is None else _finite(name, value)
            for name, value in zip(given._fields, given, strict=True)
        )
        top = super().__new__(cls, *numbers)
        _check_ranges(top)
        return top

    def __getnewargs_ex__(self) -> tuple[tuple[()], dict[str, Any]]:
        """For copies and pickles, which go through the guards again."""
        return (), self._asdict()

    def inputs(self, *, radians: bool = False, ar: Arithmetic = math) -> dict[str, Any]:
        """The nine inputs by record key, the tilt in degrees or in radians."""
        names = ["m", "A", "C", "s", "g", "r0", "thetadot0", "psidot0"]
        values: dict[str, Any] = {name: getattr(self, name) for name in names[:6]}
        values["theta0_rad" if radians else "theta0_deg"] = self._tilt_in(radians, ar)
        return values | {name: getattr(self, name) for name in names[6:]}

    def _tilt_in(self, radians: bool, ar: Arithmetic) -> Real:
        given, other = self.theta0_deg, self.theta0_rad
        if radians:
            given, other = other, given
        if given is not None:
            return given
        return number(ar, _known(other)) * (ar.pi / 180 if radians else 180 / ar.pi)

    def tilt(self, ar: Arithmetic) -> Tilt:
        """Sines and cosines of theta0 and theta0/2, each with full *relative* accuracy."""
        if self.theta0_rad is not None:
            arc = number(ar, self.theta0_rad)
            return Tilt(ar.sin(arc), ar.cos(arc), ar.sin(arc / 2), ar.cos(arc / 2))
        tilt = Fraction(_known(self.theta0_deg))
        nearer = number(ar, min(tilt, 180 - tilt)) * ar.pi / 180
        sin_half, cos_half = ar.sin(nearer / 2), ar.cos(nearer / 2)
        if tilt > 90:
            sin_half, cos_half = cos_half, sin_half
        cosine = ar.sin(number(ar, 90 - tilt) * ar.pi / 180)
        return Tilt(ar.sin(nearer), cosine, sin_half, cos_half)

    @property
    def is_released(self) -> bool:
        """Whether it starts at rest in nutation and precession, the paper's case."""
        return self.thetadot0 == 0 and self.psidot0 == 0

    @property
    def pole(self) -> int:
        """1 where the axis starts upright, -1 where it hangs, else 0."""
        if self.theta0_deg == 0 or self.theta0_rad == 0:
            return 1
        return -1 if self.theta0_deg == 180 else 0

    def caveat(self) -> str | None:
        """One line on a body that can be computed but not built, or None."""
        offset = Fraction(self.m) * Fraction(self.s) ** 2
        limit = 2 * (Fraction(self.A) - offset)
        if limit <= 0:
            bound = f"A > m s^2, got {float(self.A)}"
        elif self.C > limit:
            bound = f"C <= 2 (A - m s^2) = {float(limit)}, got {float(self.C)}"
        else:
            return None
        return f"a rigid body with its mass centre at s has {bound}; computing all the same"

    def options(self) -> str:
        """Return the top as the options that give it to any command."""
        words = [f"--{name} {getattr(self, name)!r}" for name in ("m", "A", "C", "s", "g", "r0")]
        if self.theta0_rad is None:
            words.append(f"--theta0 {self.theta0_deg!r}")
        else:
            words.append(f"--rad --theta0 {self.theta0_rad!r}")
        for name in ("thetadot0", "psidot0"):
            if getattr(self, name):
                words.append(f"--{name} {getattr(self, name)!r}")
        return " ".join(words)


def _known(value: Number | None) -> Number:
    assert value is not None
    return value


def _finite(name: str, value: Any) -> Number:
    if isinstance(value, Fraction):
        return value
    try:
        nearest = float(value)
    except (TypeError, ValueError, OverflowError):
        raise LagtopError(f"{name} must be a number, got {value!r}", name) from None
    if not math.isfinite(nearest):
        raise LagtopError(f"{name} must be finite, got {nearest}", name)
    return nearest


def _check_ranges(top: Top) -> None:
    for name in ("m", "A", "C"):
        _require(getattr(top, name) > 0, name, "> 0", getattr(top, name))
        _require(getattr(top, name) >= 1 / _LARGEST, name, ">= 1e-100", getattr(top, name), _UNITS)
    for name in ("m", "A", "C", "s", "g", "r0", "thetadot0", "psidot0"):
        size = abs(getattr(top, name))
        _require(size <= _LARGEST, name, "within 1e100 in size", getattr(top, name), _UNITS)
    _require(top.s >= 0, "s", ">= 0", top.s, "for a low centre of mass use 180 - theta0 and -r0")
    _require(top.g >= 0, "g", ">= 0", top.g, "for upward gravity use 180 - theta0 and -r0")
    twice = 2 * Fraction(top.A)
    _require(twice >= top.C, "C", f"<= 2 A = {_shown(twice)}", top.C, "no rigid body has more")
    if top.theta0_deg is not None and top.theta0_rad is not None:
        raise LagtopError("theta0_deg and theta0_rad are both given: leave one out", "theta0_rad")
    for name, most, shown in (("theta0_deg", 180, "180"), ("theta0_rad", _PI, "pi")):
        tilt = getattr(top, name)
        if tilt is not None:
            _require(0 <= tilt <= most, name, f"in [0, {shown}]", tilt)
            _require(tilt == 0 or tilt >= _LEAST_TILT, name, f"0 or at least {_LEAST_TILT}", tilt)


def _require(fine: bool, name: str, wanted: str, value: Number, remedy: str = "") -> None:
    if not fine:
        hint = f" ({remedy})" if remedy else ""
        raise LagtopError(f"{name} must be {wanted}, got {_shown(value)}{hint}", name)


def _shown(value: Number) -> str:
    """As it was given, so that 180.00000000000000000001 is not shown as 180."""
    if isinstance(value, float) or float(value) == value:
        return str(float(value))
    return str(Decimal(value.numerator) / Decimal(value.denominator))


def overridden(inputs: Mapping[str, N], given: Mapping[str, N]) -> dict[str, N]:
    """The inputs with those given in their place; a tilt takes the place of one in either unit."""
    tilted = any(key.startswith("theta0_") for key in given)
    kept = {x: y for x, y in inputs.items() if not (tilted and x.startswith("theta0_"))}
    return kept | dict(given)


def build_top(inputs: Mapping[str, Number], *, exact: bool = False) -> Top:
    """A Top from inputs by key, read as exact decimals or rounded to doubles.

    Raises LagtopError.
    """
    return Top(**{key: value if exact else _nearest(key, value) for key, value in inputs.items()})


def _nearest(key: str, value: Number) -> float:
    try:
        return float(value)
    except OverflowError:
        raise LagtopError(f"{key} must be at most 1.8e308 in size", key) from None
