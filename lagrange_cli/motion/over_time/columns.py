"""The columns of `lagtop table` by name: their headings, and the method that computes each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import NamedTuple

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
    formula: str = ""
    """The formula in names of columns and keys; t1 is the time of a passage of u1."""


class Column(NamedTuple):
    """One or several columns by name."""

    meaning: str
    parts: Sequence[ScalarColumn]


def _one(
    meaning: str, needs: Needs, method: str, heading: str, unit: str = "", **shown: str
) -> Column:
    return Column(meaning, [ScalarColumn(heading, method, needs, unit, **shown)])


COLUMNS: dict[str, Column] = {
    "t": _one("time", NOTHING, "times", "t", "time", symbol="t"),
    "theta": _one(
        "tilt", TILT, "theta", "theta_*", symbol="ϑ", equation="(4,9)", formula="acos(u)"
    ),
    "phi": _one(
        "spin", TURN, "phi", "phi_*", symbol="φ", equation="(6,1)", formula="integral(phidot, 0, t)"
    ),
    "psi": _one(
        "precession",
        TURN,
        "psi",
        "psi_*",
        symbol="ψ",
        equation="(7,1)",
        formula="integral(psidot, 0, t)",
    ),
    "dphi": _one(
        "spin less its mean rate times t, a wave",
        TURN,
        "phi_remainder",
        "dphi_*",
        symbol="Δφ",
        equation="(6,4)",
        formula="phi - mean_spin_rate*t",
    ),
    "dpsi": _one(
        "precession less its mean rate times t, a wave",
        TURN,
        "psi_remainder",
        "dpsi_*",
        symbol="Δψ",
        equation="(7,4)",
        formula="psi - mean_precession_rate*t",
    ),
    "u": _one(
        "cos ϑ",
        MODULI,
        "cosine",
        "u",
        symbol="u",
        equation="(4,30)",
        formula="u2 + (u1 - u2)*sn(K + 2*K*(t - t1)/T_nutation, k)**2",
    ),
    "thetadot": _one(
        "nutation rate",
        SWING,
        "nutation_rate",
        "thetadot",
        "rad/time",
        symbol="ϑ'",
        equation="(4,2)",
        formula="thetadot**2 = energy_constant - a*u - psidot**2*(1 - u**2)",
    ),
    "phidot": _one(
        "spin rate",
        MODULI,
        "phi_rate",
        "phidot",
        "rad/time",
        symbol="φ'",
        equation="(4,8)",
        formula="r0 - psidot*u",
    ),
    "psidot": _one(
        "precession rate",
        MODULI,
        "psi_rate",
        "psidot",
        "rad/time",
        symbol="ψ'",
        equation="(4,7)",
        formula="(momentum_constant - b*u)/(1 - u**2)",
    ),
    "p": _one(
        "angular velocity about the body's x axis",
        SWING | TURN,
        "p",
        "p",
        "rad/time",
        symbol="p",
        equation="(4,1)",
        formula="thetadot*cos(phi) + psidot*sin(theta)*sin(phi)",
    ),
    "q": _one(
        "angular velocity about the body's y axis",
        SWING | TURN,
        "q",
        "q",
        "rad/time",
        symbol="q",
        equation="(4,1)",
        formula="psidot*sin(theta)*cos(phi) - thetadot*sin(phi)",
    ),
    "r": _one(
        "angular velocity about the figure axis",
        NOTHING,
        "r",
        "r",
        "rad/time",
        symbol="r",
        equation="(4,1)",
        formula="r0",
    ),
    "moment": _one(
        "moment of the weight about the line of nodes",
        MODULI,
        "moment",
        "moment",
        "mass len²/time²",
        symbol="M",
        formula="m*g*s*sin(theta)",
    ),
    "axis": Column(
        "figure axis in space: axis_x, axis_y, axis_z",
        [
            ScalarColumn("axis_x", "axis_x", ATTITUDE, formula="sin(theta)*sin(psi)"),
            ScalarColumn("axis_y", "axis_y", ATTITUDE, formula="-sin(theta)*cos(psi)"),
            ScalarColumn("axis_z", "cosine", MODULI, formula="u"),
        ],
    ),
    "quaternion": Column(
        "from body to space, scalar first: quaternion_w, quaternion_x, ...",
        [
            ScalarColumn(f"quaternion_{part}", f"quaternion_{part}", ATTITUDE, formula=formula)
            for part, formula in {
                "w": "cos(theta/2)*cos((psi + phi)/2)",
                "x": "sin(theta/2)*cos((psi - phi)/2)",
                "y": "sin(theta/2)*sin((psi - phi)/2)",
                "z": "cos(theta/2)*sin((psi + phi)/2)",
            }.items()
        ],
    ),
    "energy": _one(
        "energy; constant except for rounding",
        SWING,
        "energy",
        "energy",
        "mass len²/time²",
        symbol="E",
        equation="(4,2)",
        formula="(A*(p**2 + q**2) + C*r**2)/2 + m*g*s*u",
    ),
    "Lz": _one(
        "vertical angular momentum; constant except for rounding",
        MODULI,
        "vertical_momentum",
        "Lz",
        "mass len²/time",
        symbol="c2",
        equation="(4,3)",
        formula="A*psidot*sin(theta)**2 + C*r0*u",
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
