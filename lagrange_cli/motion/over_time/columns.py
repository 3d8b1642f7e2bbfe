"""The columns of `lagtop table`: each is declared once, with its formula.

The formula of a column is a function of `ColumnParts`, a motion at one or several times.  Equation
numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Flag, auto
from functools import partial
from typing import Any, NamedTuple

from ...arithmetic.values import Key
from ...inputs.names import ANGLES, check_names


class Needs(Flag):
    """The parts of X and Y (see `samplers`) that columns need; no others are computed."""

    NOTHING = 0
    TILT = auto()
    MODULI = auto()
    TURN = auto()
    """The arguments of X and Y."""
    RATE = auto()
    """The nutation rate."""


NOTHING, TILT, MODULI, TURN = Needs.NOTHING, Needs.TILT, Needs.MODULI, Needs.TURN
ATTITUDE, SWING = MODULI | TURN, MODULI | Needs.RATE


class Column(NamedTuple):
    """One column of numbers."""

    key: Key
    """The presentation of the column; its group is the name of several columns, or empty."""
    formula: str
    """The formula in names of columns and keys; t1 is the time of a passage of u1."""
    needs: Needs
    value: Callable[[Any], Any]
    """The formula as a function of `ColumnParts`."""

    @property
    def is_angle(self) -> bool:
        """Whether the numbers are in degrees or radians."""
        return self.key.unit == "angle"


GROUPS = {
    "axis": "figure axis in space: axis_x, axis_y, axis_z",
    "quaternion": "from body to space, scalar first: quaternion_w, quaternion_x, ...",
}
"""The meanings of names that stand for several columns."""

_alone, _axis, _quaternion = (partial(Key, group) for group in ("", *GROUPS))
_WAVE = "less its mean rate times t, a wave"
_ABOUT = "angular velocity about the"
_CONSTANT = "constant except for rounding"

SCALARS: dict[str, Column] = {
    "t": Column(_alone("t", "time", "time"), "", NOTHING, lambda at: at.t),
    "theta": Column(_alone("ϑ", "tilt", "angle", "(4,9)"), "acos(u)", TILT, lambda at: at.tilt),
    "phi": Column(
        _alone("φ", "spin", "angle", "(6,1)"), "integral(phidot, 0, t)", TURN, lambda at: at.spin
    ),
    "psi": Column(
        _alone("ψ", "precession", "angle", "(7,1)"),
        "integral(psidot, 0, t)",
        TURN,
        lambda at: at.precession,
    ),
    "dphi": Column(
        _alone("Δφ", f"spin {_WAVE}", "angle", "(6,4)"),
        "phi - mean_spin_rate*t",
        TURN,
        lambda at: at.spin_wave,
    ),
    "dpsi": Column(
        _alone("Δψ", f"precession {_WAVE}", "angle", "(7,4)"),
        "psi - mean_precession_rate*t",
        TURN,
        lambda at: at.precession_wave,
    ),
    "u": Column(
        _alone("u", "cos ϑ", "", "(4,30)"),
        "u2 + (u1 - u2)*sn(K + 2*K*(t - t1)/T_nutation, k)**2",
        MODULI,
        lambda at: at.u,
    ),
    "thetadot": Column(
        _alone("ϑ'", "nutation rate", "rad/time", "(4,2)"),
        "thetadot**2 = energy_constant - a*u - psidot**2*(1 - u**2)",
        SWING,
        lambda at: at.thetadot,
    ),
    "phidot": Column(
        _alone("φ'", "spin rate", "rad/time", "(4,8)"),
        "r0 - psidot*u",
        MODULI,
        lambda at: at.top.drift + at.south - at.north,
    ),
    "psidot": Column(
        _alone("ψ'", "precession rate", "rad/time", "(4,7)"),
        "(momentum_constant - b*u)/(1 - u**2)",
        MODULI,
        lambda at: at.south + at.north,
    ),
    "p": Column(
        _alone("p", f"{_ABOUT} body's x axis", "rad/time", "(4,1)"),
        "thetadot*cos(phi) + psidot*sin(theta)*sin(phi)",
        SWING | TURN,
        lambda at: at.across * at.sin_spin + at.thetadot * at.cos_spin,
    ),
    "q": Column(
        _alone("q", f"{_ABOUT} body's y axis", "rad/time", "(4,1)"),
        "psidot*sin(theta)*cos(phi) - thetadot*sin(phi)",
        SWING | TURN,
        lambda at: at.across * at.cos_spin - at.thetadot * at.sin_spin,
    ),
    "r": Column(
        _alone("r", f"{_ABOUT} figure axis", "rad/time", "(4,1)"),
        "r0",
        NOTHING,
        lambda at: at.top.r0,
    ),
    "moment": Column(  # the only component of s k' x (-mg k), section 4 a
        _alone("M", "moment of the weight about the line of nodes", "mass len²/time²"),
        "m*g*s*sin(theta)",
        MODULI,
        lambda at: at.top.torque * at.sine,
    ),
    "axis_x": Column(
        _axis("", "x part in space"),
        "sin(theta)*sin(psi)",
        ATTITUDE,
        lambda at: at.sine * at.ar.sin(at.around),
    ),
    "axis_y": Column(
        _axis("", "y part in space"),
        "-sin(theta)*cos(psi)",
        ATTITUDE,
        lambda at: -at.sine * at.ar.cos(at.around),
    ),
    "axis_z": Column(_axis("", "z part in space"), "u", MODULI, lambda at: at.u),
    "quaternion_w": Column(
        _quaternion("", "real part of X = w + i z"),
        "cos(theta/2)*cos((psi + phi)/2)",
        ATTITUDE,
        lambda at: at.unit[0] * at.ar.cos(at.args[0]),
    ),
    "quaternion_x": Column(
        _quaternion("", "real part of Y = x + i y"),
        "sin(theta/2)*cos((psi - phi)/2)",
        ATTITUDE,
        lambda at: at.unit[1] * at.ar.cos(at.args[1]),
    ),
    "quaternion_y": Column(
        _quaternion("", "imaginary part of Y = x + i y"),
        "sin(theta/2)*sin((psi - phi)/2)",
        ATTITUDE,
        lambda at: at.unit[1] * at.ar.sin(at.args[1]),
    ),
    "quaternion_z": Column(
        _quaternion("", "imaginary part of X = w + i z"),
        "cos(theta/2)*sin((psi + phi)/2)",
        ATTITUDE,
        lambda at: at.unit[0] * at.ar.sin(at.args[0]),
    ),
    "energy": Column(
        _alone("E", f"energy; {_CONSTANT}", "mass len²/time²", "(4,2)"),
        "(A*(p**2 + q**2) + C*r**2)/2 + m*g*s*u",
        SWING,
        lambda at: at.rotation_energy + at.top.torque * at.u,
    ),
    "Lz": Column(
        _alone("c2", f"vertical angular momentum; {_CONSTANT}", "mass len²/time", "(4,3)"),
        "A*psidot*sin(theta)**2 + C*r0*u",
        MODULI,
        lambda at: at.top.A * at.across * at.sine + at.top.C * at.top.r0 * at.u,
    ),
}

COLUMNS: dict[str, dict[str, Column]] = {}
"""The columns that each name stands for, in the order of `SCALARS`."""
for _name, _column in SCALARS.items():
    COLUMNS.setdefault(_column.key.group or _name, {})[_name] = _column

DEFAULT_COLUMNS = ("t", *ANGLES)


def shown_columns(*, radians: bool = False, named: Callable[[str], str] = str) -> dict[str, Key]:
    """Return how each of `COLUMNS` is presented; `named` gives the names of units.

    The formula of a group has one equation per column.
    """
    keys = {name: column.key.replace(formula=column.formula) for name, column in SCALARS.items()}
    for group, meaning in GROUPS.items():
        formula = ", ".join(f"{name} = {keys[name].formula}" for name in COLUMNS[group])
        keys[group] = Key(group, "", meaning, formula=formula)
    return {name: keys[name].in_units(radians=radians, named=named) for name in COLUMNS}


def column_names() -> list[str]:
    """Return the names of all columns, groups first."""
    return list(COLUMNS | SCALARS)


def chosen_columns(names: Sequence[str]) -> dict[str, Column]:
    """Return the columns of some names, groups expanded.

    Raises LagtopError for an unknown or repeated name.
    """
    check_names("columns", names, column_names())
    chosen = [part for name in names for part in COLUMNS.get(name, [name])]
    check_names("columns", chosen, chosen)
    return {name: SCALARS[name] for name in chosen}


def headings(columns: Sequence[str], *, radians: bool = False) -> list[str]:
    """Return the headings of some columns.  Raises LagtopError for an unknown one."""
    unit = "rad" if radians else "deg"
    return [
        f"{name}_{unit}" if column.is_angle else name
        for name, column in chosen_columns(columns).items()
    ]
