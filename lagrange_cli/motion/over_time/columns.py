"""The columns of `lagtop table` by name: their headings, and the formula of `sample` for each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import NamedTuple

from ...inputs.names import ANGLES, check_names


class Needs(NamedTuple):
    """What is needed of X and Y (see `samplers`), which is computed only then."""

    tilt: bool = False
    moduli: bool = False
    arguments: bool = False
    rate: bool = False

    def __or__(self, other: Needs) -> Needs:
        """Return what either needs."""
        return Needs(*(one or another for one, another in zip(self, other, strict=True)))


NOTHING, TILT, TURN = Needs(), Needs(tilt=True), Needs(arguments=True)
MODULI = Needs(moduli=True)
ATTITUDE, SWING = MODULI | TURN, MODULI | Needs(rate=True)


class ScalarColumn(NamedTuple):
    """One column."""

    heading: str
    """A `*` stands for the unit of angles."""
    method: str
    """The method of `sample.Sample` that computes it."""
    needs: Needs
    unit: str = ""
    """A unit such as `rad/time`, where it is none of angles."""


class Column(NamedTuple):
    """One or several columns by name."""

    meaning: str
    parts: Sequence[ScalarColumn]


def _one(meaning: str, needs: Needs, method: str, heading: str, unit: str = "") -> Column:
    return Column(meaning, [ScalarColumn(heading, method, needs, unit)])


COLUMNS: dict[str, Column] = {
    "t": _one("time", NOTHING, "times", "t", "time"),
    "theta": _one("tilt", TILT, "theta", "theta_*"),
    "phi": _one("spin", TURN, "phi", "phi_*"),
    "psi": _one("precession", TURN, "psi", "psi_*"),
    "dphi": _one("spin less its mean growth (6,4), a wave", TURN, "phi_remainder", "dphi_*"),
    "dpsi": _one("precession less its mean growth (7,4), a wave", TURN, "psi_remainder", "dpsi_*"),
    "u": _one("cos(theta)", MODULI, "cosine", "u"),
    "thetadot": _one("nutation rate", SWING, "nutation_rate", "thetadot", "rad/time"),
    "phidot": _one("spin rate", MODULI, "phi_rate", "phidot", "rad/time"),
    "psidot": _one("precession rate", MODULI, "psi_rate", "psidot", "rad/time"),
    "p": _one("angular velocity about the body's x axis", SWING | TURN, "p", "p", "rad/time"),
    "q": _one("angular velocity about the body's y axis", SWING | TURN, "q", "q", "rad/time"),
    "r": _one("angular velocity about the figure axis", NOTHING, "r", "r", "rad/time"),
    "moment": _one(
        "moment of the weight about the line of nodes",
        MODULI,
        "moment",
        "moment",
        "mass len²/time²",
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
        [ScalarColumn(f"quaternion_{part}", f"quaternion_{part}", ATTITUDE) for part in "wxyz"],
    ),
    "energy": _one(
        "energy; constant but for rounding", SWING, "energy", "energy", "mass len²/time²"
    ),
    "Lz": _one(
        "vertical angular momentum; constant but for rounding",
        MODULI,
        "vertical_momentum",
        "Lz",
        "mass len²/time",
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
    """Return the names of all columns, of groups first."""
    return [*COLUMNS, *_SINGLE]


def chosen_columns(names: Sequence[str]) -> list[ScalarColumn]:
    """Return the columns of some names, groups expanded.

    Raises LagtopError for a name that is unknown or comes twice.
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
    """Return what some columns need together."""
    return reduce(Needs.__or__, (part.needs for part in chosen), NOTHING)


def headings(columns: Sequence[str], *, radians: bool = False) -> list[str]:
    """Return the header of some columns.  Raises LagtopError for an unknown one."""
    unit = "rad" if radians else "deg"
    return [column.heading.replace("*", unit) for column in chosen_columns(columns)]
