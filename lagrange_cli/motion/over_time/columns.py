"""The columns of `lagtop table` by name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from ...inputs.names import ANGLES, check_names

Needs = frozenset[str]
"""The parts of X and Y (see `samplers`) that columns need; no others are computed."""
NOTHING: Needs = frozenset()
TILT, MODULI, TURN = frozenset({"tilt"}), frozenset({"moduli"}), frozenset({"arguments"})
ATTITUDE, SWING = MODULI | TURN, MODULI | {"rate"}

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
    """One column; `column_formulas` computes it under its name."""

    heading: str
    """The heading; `*` is replaced by the unit of angles."""
    needs: Needs
    unit: str = ""
    """A unit such as `rad/time`, unless the column is an angle."""
    symbol: str = ""
    equation: str = ""

    @property
    def name(self) -> str:
        """The heading without a unit."""
        return self.heading.removesuffix("_*")

    @property
    def formula(self) -> str:
        """The formula; empty for the time."""
        return _FORMULAS.get(self.name, "")


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
    "t": _one("time", "t", NOTHING, "time", "t"),
    "theta": _one("tilt", "theta_*", TILT, "", "ϑ", "(4,9)"),
    "phi": _one("spin", "phi_*", TURN, "", "φ", "(6,1)"),
    "psi": _one("precession", "psi_*", TURN, "", "ψ", "(7,1)"),
    "dphi": _one(f"spin {_WAVE}", "dphi_*", TURN, "", "Δφ", "(6,4)"),
    "dpsi": _one(f"precession {_WAVE}", "dpsi_*", TURN, "", "Δψ", "(7,4)"),
    "u": _one("cos ϑ", "u", MODULI, "", "u", "(4,30)"),
    "thetadot": _one("nutation rate", "thetadot", SWING, _RATE, "ϑ'", "(4,2)"),
    "phidot": _one("spin rate", "phidot", MODULI, _RATE, "φ'", "(4,8)"),
    "psidot": _one("precession rate", "psidot", MODULI, _RATE, "ψ'", "(4,7)"),
    "p": _one(f"{_ABOUT} body's x axis", "p", SWING | TURN, _RATE, "p", "(4,1)"),
    "q": _one(f"{_ABOUT} body's y axis", "q", SWING | TURN, _RATE, "q", "(4,1)"),
    "r": _one(f"{_ABOUT} figure axis", "r", NOTHING, _RATE, "r", "(4,1)"),
    "moment": _one("moment of the weight about the line of nodes", "moment", MODULI, _ENERGY, "M"),
    "axis": Column(
        "figure axis in space: axis_x, axis_y, axis_z",
        [ScalarColumn(f"axis_{x}", MODULI if x == "z" else ATTITUDE) for x in "xyz"],
    ),
    "quaternion": Column(
        "from body to space, scalar first: quaternion_w, quaternion_x, ...",
        [ScalarColumn(f"quaternion_{x}", ATTITUDE) for x in "wxyz"],
    ),
    "energy": _one(f"energy; {_CONSTANT}", "energy", SWING, _ENERGY, "E", "(4,2)"),
    "Lz": _one(f"vertical angular momentum; {_CONSTANT}", "Lz", MODULI, _MOMENTUM, "c2", "(4,3)"),
}
DEFAULT_COLUMNS = ("t", *ANGLES)

_PARTS = {name: column.parts for name, column in COLUMNS.items()}
_PARTS |= {part.name: [part] for parts in list(_PARTS.values()) for part in parts}
"""The columns of each name; those of a group have names of their own too."""


def column_names() -> list[str]:
    """Return the names of all columns, groups first."""
    return list(_PARTS)


def chosen_columns(names: Sequence[str]) -> list[ScalarColumn]:
    """Return the columns of some names, groups expanded.

    Raises LagtopError for an unknown or repeated name.
    """
    check_names("columns", names, _PARTS)
    chosen = [part for name in names for part in _PARTS[name]]
    headings = [part.heading for part in chosen]
    check_names("columns", headings, headings)
    return chosen


def headings(columns: Sequence[str], *, radians: bool = False) -> list[str]:
    """Return the headings of some columns.  Raises LagtopError for an unknown one."""
    unit = "rad" if radians else "deg"
    return [column.heading.replace("*", unit) for column in chosen_columns(columns)]
