"""One scene: the top, how it starts, the guards on both, and the scene file (TOML)."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import Any, NamedTuple

from .elliptic import Arithmetic, Real

Number = float | Fraction
"""An input: a double, or the exact value of a decimal."""

_DECIMAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_MAX_SCENE_BYTES = 1 << 20
_PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459")


class LagtopError(ValueError):
    """A bad input. `key` names the input at fault where there is one."""

    def __init__(self, message: str, key: str | None = None) -> None:
        super().__init__(message)
        self.key = key


class SceneError(LagtopError):
    """A scene file that is missing, broken, or holds something it should not."""


def parse_number(text: str) -> Fraction:
    """The exact value of a decimal such as `30`, `-1.5` or `2e-3`.

    Raises LagtopError, with the remedy, for anything else and for what no double can hold.
    """
    text = text.strip()
    if not _DECIMAL.fullmatch(text):
        raise LagtopError(f"must be a finite decimal number, got {text!r}{_remedy(text)}")
    nearest = float(text)
    if math.isinf(nearest):
        raise LagtopError(f"must be at most 1.8e308 in size, got {text}")
    if nearest == 0 and re.search("[1-9]", re.split("[eE]", text)[0]):
        raise LagtopError(f"must be 0 or at least 5e-324 in size, got {text}")
    return Fraction(text)


def _remedy(text: str) -> str:
    if "," in text:
        return " (write a decimal point, not a comma)"
    if "_" in text:
        return " (leave out the underscores)"
    if any(dash in text for dash in "\u2212\u2013\u2014"):
        return " (write the minus sign as an ASCII hyphen, -)"
    return ""


class Tilt(NamedTuple):
    """Sine and cosine of theta0 and of its half."""

    sin: Real
    cos: Real
    sin_half: Real
    cos_half: Real


@dataclass(frozen=True, kw_only=True)
class Top:
    """A heavy symmetric top with a fixed point, and its state at t = 0 (phi = psi = 0 there).

    Any consistent units; the defaults are the worked example of Chrapan (1952), section 8, in CGS.
    Give the tilt as `theta0_deg` or as `theta0_rad`, not both.  Raises LagtopError for a body or a
    start that cannot be.
    """

    m: Number = 1587.0
    """Mass, > 0."""
    A: Number = 39032.0
    """Equatorial moment of inertia about the pivot, > 0."""
    C: Number = 17458.0
    """Polar moment of inertia, 0 < C <= 2A."""
    s: Number = 4.0
    """Distance from the pivot to the centre of mass, >= 0."""
    g: Number = 981.0
    """Gravity, >= 0."""
    r0: Number = 50.0
    """Spin: the angular velocity about the figure axis, which is constant (any sign)."""
    theta0_deg: Number | None = None
    """Tilt of the figure axis from the upward vertical, 0 to 180 degrees."""
    thetadot0: Number = 0.0
    """Nutation rate at t = 0."""
    psidot0: Number = 0.0
    """Precession rate at t = 0."""
    theta0_rad: Number | None = None
    """The tilt in radians, 0 to pi, instead of `theta0_deg`."""

    def __post_init__(self) -> None:
        if self.theta0_deg is None and self.theta0_rad is None:
            object.__setattr__(self, "theta0_deg", 30.0)
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None:
                object.__setattr__(self, field.name, _finite(field.name, value))
        _check_ranges(self)

    def inputs(self, *, radians: bool = False) -> dict[str, Number]:
        """The nine inputs by record key, the tilt in degrees or in radians."""
        names = ["m", "A", "C", "s", "g", "r0", "thetadot0", "psidot0"]
        values: dict[str, Number] = {name: getattr(self, name) for name in names[:6]}
        values["theta0_rad" if radians else "theta0_deg"] = self._tilt(radians)
        return values | {name: getattr(self, name) for name in names[6:]}

    def _tilt(self, radians: bool) -> Number:
        given = self.theta0_rad if radians else self.theta0_deg
        if given is not None:
            return given
        if radians:
            return math.radians(_known(self.theta0_deg))
        return math.degrees(_known(self.theta0_rad))

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

    def caveat(self) -> str | None:
        """One line on a body that can be computed but not built, or None."""
        about_centre = Fraction(self.A) - Fraction(self.m) * Fraction(self.s) ** 2
        if Fraction(self.C) <= 2 * about_centre:
            return None
        return (
            f"no rigid body has C = {self.C} with A = {self.A} about the pivot: "
            f"C must be <= 2 (A - m s^2) = {float(2 * about_centre)}"
        )


def number(ar: Arithmetic, value: Number) -> Real:
    """A number of the arithmetic, rounded once."""
    return ar.convert(value) if hasattr(ar, "convert") else float(value)


def _known(value: Number | None) -> Number:
    assert value is not None
    return value


def _finite(name: str, value: Any) -> Number:
    if isinstance(value, Fraction):
        return value
    try:
        value = float(value)
    except (TypeError, ValueError):
        raise LagtopError(f"{name} must be a number, got {value!r}", name) from None
    if not math.isfinite(value):
        raise LagtopError(f"{name} must be finite, got {value}", name)
    return value


def _check_ranges(top: Top) -> None:
    for name in ("m", "A", "C"):
        _require(getattr(top, name) > 0, name, "> 0", getattr(top, name))
    _require(top.s >= 0, "s", ">= 0", top.s, "for a low centre of mass use 180 - theta0 and -r0")
    _require(top.g >= 0, "g", ">= 0", top.g, "for upward gravity use 180 - theta0 and -r0")
    limit = 2 * Fraction(top.A)
    _require(top.C <= limit, "C", f"<= 2 A = {float(limit)}", top.C, "no rigid body has more")
    if top.theta0_deg is not None and top.theta0_rad is not None:
        raise LagtopError("theta0_deg and theta0_rad are both given: leave one out", "theta0_rad")
    if top.theta0_deg is not None:
        _require(0 <= top.theta0_deg <= 180, "theta0_deg", "in [0, 180]", top.theta0_deg)
    if top.theta0_rad is not None:
        _require(0 <= top.theta0_rad <= _PI, "theta0_rad", "in [0, pi]", top.theta0_rad)


def _require(fine: bool, name: str, wanted: str, value: Number, remedy: str = "") -> None:
    if not fine:
        hint = f" ({remedy})" if remedy else ""
        raise LagtopError(f"{name} must be {wanted}, got {float(value)}{hint}", name)


def read_scene(path: str) -> dict[str, Fraction]:
    """The inputs in a TOML scene file, as exact decimals.  Raises SceneError."""
    import tomllib

    try:
        with open(path, "rb") as file:
            raw = file.read(_MAX_SCENE_BYTES + 1)
        if len(raw) > _MAX_SCENE_BYTES:
            raise SceneError(f"{path}: a scene file is at most 1 MiB")
        text = raw.decode("utf-8-sig")
        table = tomllib.loads(text, parse_float=_toml_float)
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror}") from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SceneError(f"{path}: not a TOML file: {error}") from None
    return {key: _scene_value(path, text, key, value) for key, value in table.items()}


def _toml_float(text: str) -> Fraction | str:
    try:
        return parse_number(text.replace("_", ""))
    except LagtopError:
        return text


def _scene_value(path: str, text: str, key: str, value: Any) -> Fraction:
    known = [field.name for field in fields(Top)]
    where = f"{path}, line {scene_line(text, key)}"
    if key not in known:
        raise SceneError(f"{where}: unknown key {key!r} (known: {' '.join(known)})", key)
    if isinstance(value, Fraction):
        return value
    if isinstance(value, int) and not isinstance(value, bool):
        value = str(value)
        try:
            return parse_number(value)
        except LagtopError as error:
            raise SceneError(f"{where}: {key} {error}", key) from None
    raise SceneError(f"{where}: {key} must be a finite number, got {value!r}", key)


def scene_line(text: str, key: str) -> int:
    """The line of a scene file's text that sets a key (1 where it cannot be told)."""
    pattern = re.compile(rf"""\s*\[*\s*["']?{re.escape(key)}\b""")
    lines = text.splitlines()
    return next((i for i, line in enumerate(lines, 1) if pattern.match(line)), 1)


def build_top(inputs: Mapping[str, Number], *, exact: bool = False) -> Top:
    """A Top from inputs by key, read as exact decimals or rounded to doubles.

    Raises LagtopError.
    """
    return Top(**{key: value if exact else float(value) for key, value in inputs.items()})
