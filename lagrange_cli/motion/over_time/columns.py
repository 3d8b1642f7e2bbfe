"""The columns of `lagtop table` by name: their headings, and the method that computes each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any, NamedTuple

from ...inputs.names import ANGLES, check_names


class Needs(NamedTuple):
    """The parts of X and Y (see `samplers`) that columns need; no others are computed."""

    tilt: bool = False
    moduli: bool = False
    arguments: bool = False
    rate: bool = False

    def __or__(self, other: Needs) -> Needs:
        """Return the parts that either needs."""
        return Needs(*(one or another for one, another in zip(self, other, strict=True)))


NOTHING, TILT, TURN = Needs(), Needs(tilt=True), Needs(arguments=True)
MODULI = Needs(moduli=True)
ATTITUDE, SWING = MODULI | TURN, MODULI | Needs(rate=True)


_FORMULAS = {
    "theta": "acos(u)",
    "phi": "integral(phidot, 0, t)",
    "psi": "integral(psidot, 0, t)",
    "dphi": "phi - mean_spin_rate*t",
    "dpsi": "psi - mean_precession_rate*t",
    "u": "u2 + (u1 - u2)*sn(K + 2*K*(t - t1)/T_nutation, k)**2",
    "thetadot": "thetadot**2 = energy_constant - a*u - psidot**2*(1 - u**2)",
    "phidot": "r0 - psidot*u",
    "psidot": "(momentum_constant - b*u)/(1 - u**2)",
    "p": "thetadot*cos(phi) + psidot*sin(theta)*sin(phi)",
    "q": "psidot*sin(theta)*cos(phi) - thetadot*sin(phi)",
    "r": "r0",
    "moment": "m*g*s*sin(theta)",
    "axis_x": "sin(theta)*sin(psi)",
    "axis_y": "-sin(theta)*cos(psi)",
    "axis_z": "u",
    "quaternion_w": "cos(theta/2)*cos((psi + phi)/2)",
    "quaternion_x": "sin(theta/2)*cos((psi - phi)/2)",
    "quaternion_y": "sin(theta/2)*sin((psi - phi)/2)",
    "quaternion_z": "cos(theta/2)*sin((psi + phi)/2)",
    "energy": "(A*(p**2 + q**2) + C*r**2)/2 + m*g*s*u",
    "Lz": "A*psidot*sin(theta)**2 + C*r0*u",
}
"""The formula of each column in names of columns and keys; t1 is the time of a passage of u1."""


class ScalarColumn(NamedTuple):
    """One column."""

    heading: str
    """The heading; `*` is replaced by the unit of angles."""
    method: str
    """The method of `table.Sample` that computes the column."""
    needs: Needs
    unit: str = ""
    """A unit such as `rad/time`, unless the column is an angle."""
    symbol: str = ""
    equation: str = ""

    @property
    def formula(self) -> str:
        """The formula; empty for the time."""
        return _FORMULAS.get(name_of(self), "")


class Column(NamedTuple):
    """One or several columns by name."""

    meaning: str
    parts: Sequence[ScalarColumn]


def _one(meaning: str, *column: Any) -> Column:
    return Column(meaning, [ScalarColumn(*column)])


_RATE, _ENERGY, _MOMENTUM = "rad/time", "mass len²/time²", "mass len²/time"
_WAVE = "less its mean rate times t, a wave"
_ABOUT = "angular velocity about the"
_CONSTANT = "constant except for rounding"
COLUMNS: dict[str, Column] = {
    "t": _one("time", "t", "times", NOTHING, "time", "t"),
    "theta": _one("tilt", "theta_*", "theta", TILT, "", "ϑ", "(4,9)"),
    "phi": _one("spin", "phi_*", "phi", TURN, "", "φ", "(6,1)"),
    "psi": _one("precession", "psi_*", "psi", TURN, "", "ψ", "(7,1)"),
    "dphi": _one(f"spin {_WAVE}", "dphi_*", "phi_remainder", TURN, "", "Δφ", "(6,4)"),
    "dpsi": _one(f"precession {_WAVE}", "dpsi_*", "psi_remainder", TURN, "", "Δψ", "(7,4)"),
    "u": _one("cos ϑ", "u", "cosine", MODULI, "", "u", "(4,30)"),
    "thetadot": _one("nutation rate", "thetadot", "nutation_rate", SWING, _RATE, "ϑ'", "(4,2)"),
    "phidot": _one("spin rate", "phidot", "phi_rate", MODULI, _RATE, "φ'", "(4,8)"),
    "psidot": _one("precession rate", "psidot", "psi_rate", MODULI, _RATE, "ψ'", "(4,7)"),
    "p": _one(f"{_ABOUT} body's x axis", "p", "p", SWING | TURN, _RATE, "p", "(4,1)"),
    "q": _one(f"{_ABOUT} body's y axis", "q", "q", SWING | TURN, _RATE, "q", "(4,1)"),
    "r": _one(f"{_ABOUT} figure axis", "r", "r", NOTHING, _RATE, "r", "(4,1)"),
    "moment": _one(
        "moment of the weight about the line of nodes", "moment", "moment", MODULI, _ENERGY, "M"
    ),
    "axis": Column(
        "figure axis in space: axis_x, axis_y, axis_z",
        [
            ScalarColumn("axis_x", "axis_x", ATTITUDE),
            ScalarColumn("axis_y", "axis_y", ATTITUDE),
            ScalarColumn("axis_z", "cosine", MODULI),
        ],
    ),
    "quaternion": Column(
        "from body to space, scalar first: quaternion_w, quaternion_x, ...",
        [ScalarColumn(f"quaternion_{x}", f"quaternion_{x}", ATTITUDE) for x in "wxyz"],
    ),
    "energy": _one(f"energy; {_CONSTANT}", "energy", "energy", SWING, _ENERGY, "E", "(4,2)"),
    "Lz": _one(
        f"vertical angular momentum; {_CONSTANT}",
        "Lz",
        "vertical_momentum",
        MODULI,
        _MOMENTUM,
        "c2",
        "(4,3)",
    ),
}
DEFAULT_COLUMNS = ("t", *ANGLES)

_SINGLE = {
    part.heading: [part]
    for column in COLUMNS.values()
    if len(column.parts) > 1
    for part in column.parts
}
"""Each column of a group by its own name."""


def name_of(part: ScalarColumn) -> str:
    """Return the heading of a column without a unit."""
    return part.heading.removesuffix("_*")


def column_names() -> list[str]:
    """Return the names of all columns, groups first."""
    return [*COLUMNS, *_SINGLE]


def chosen_columns(names: Sequence[str]) -> list[ScalarColumn]:
    """Return the columns of some names, groups expanded.

    Raises LagtopError for an unknown or repeated name.
    """
    check_names("columns", names, column_names())
    chosen = [
        part
        for name in names
        for part in (_SINGLE[name] if name in _SINGLE else COLUMNS[name].parts)
    ]
    headings = [part.heading for part in chosen]
    check_names("columns", headings, headings)
    return chosen


def needs_of(chosen: Sequence[ScalarColumn]) -> Needs:
    """Return the parts that some columns need together."""
    return reduce(Needs.__or__, (part.needs for part in chosen), NOTHING)


def headings(columns: Sequence[str], *, radians: bool = False) -> list[str]:
    """Return the headings of some columns.  Raises LagtopError for an unknown one."""
    unit = "rad" if radians else "deg"
    return [column.heading.replace("*", unit) for column in chosen_columns(columns)]
