"""The columns of `lagtop table` by name: their headings, and the formula of `sample` for each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..inputs.names import check_names


class Column(NamedTuple):
    """One or several columns by name."""

    headings: Sequence[str]
    """A `*` stands for the unit of angles."""
    method: str
    """The method of `sample.Sample` that computes them."""
    meaning: str
    needs_rate: bool = False


COLUMNS: dict[str, Column] = {
    "t": Column(["t"], "times", "time"),
    "theta": Column(["theta_*"], "theta", "tilt"),
    "phi": Column(["phi_*"], "phi", "spin"),
    "psi": Column(["psi_*"], "psi", "precession"),
    "dphi": Column(["dphi_*"], "phi_remainder", "spin less its mean growth (6,4), a wave"),
    "dpsi": Column(["dpsi_*"], "psi_remainder", "precession less its mean growth (7,4), a wave"),
    "u": Column(["u"], "cosine", "cos(theta)"),
    "thetadot": Column(["thetadot"], "nutation_rate", "nutation rate", True),
    "phidot": Column(["phidot"], "phi_rate", "spin rate"),
    "psidot": Column(["psidot"], "psi_rate", "precession rate"),
    "p": Column(["p"], "p", "angular velocity about the body's x axis", True),
    "q": Column(["q"], "q", "angular velocity about the body's y axis", True),
    "r": Column(["r"], "r", "angular velocity about the figure axis"),
    "moment": Column(["moment"], "moment", "moment of the weight about the line of nodes"),
    "axis": Column(
        ["axis_x", "axis_y", "axis_z"], "axis", "figure axis in space: axis_x, axis_y, axis_z"
    ),
    "quaternion": Column(
        ["quaternion_w", "quaternion_x", "quaternion_y", "quaternion_z"],
        "quaternion",
        "from body to space, scalar first: quaternion_w, quaternion_x, ...",
    ),
    "energy": Column(["energy"], "energy", "energy; constant but for rounding", True),
    "Lz": Column(
        ["Lz"], "vertical_momentum", "vertical angular momentum; constant but for rounding"
    ),
}

_SINGLE = {
    heading: (name, i)
    for name, column in COLUMNS.items()
    if len(column.headings) > 1
    for i, heading in enumerate(column.headings)
}
"""Each column of a group by its own name."""


class Chosen(NamedTuple):
    """One column that was asked for."""

    name: str
    """The heading without a unit."""
    heading: str
    group: str
    part: int


def chosen_columns(names: Sequence[str]) -> list[Chosen]:
    """Return the columns of some names, groups expanded.

    Raises LagtopError for a name that is unknown or comes twice.
    """
    check_names("columns", names, [*COLUMNS, *_SINGLE])
    chosen = []
    for name in names:
        group, index = _SINGLE.get(name, (name, None))
        for i, heading in enumerate(COLUMNS[group].headings):
            if index in {None, i}:
                chosen.append(Chosen(heading.removesuffix("_*"), heading, group, i))
    headings = [column.heading for column in chosen]
    check_names("columns", headings, headings)
    return chosen


def need_rate(chosen: Sequence[Chosen]) -> bool:
    """Return whether one of the columns needs the nutation rate."""
    return any(COLUMNS[column.group].needs_rate for column in chosen)
