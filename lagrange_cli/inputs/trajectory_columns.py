"""The columns of a trajectory by name: their quantities, and the conventions that names imply.

To add a name or a quantity, add an entry to QUANTITIES.  The help of `lagtop compare` and the table
in the README of `judge` are generated from it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ..arithmetic.text import quoted
from ..errors import LagtopError
from .headings import name_and_unit
from .names import ANGLES, suggestion

ELEVATION = "elevation"
"""The convention of an angle measured from the horizontal."""
SKIPPED = "_"
"""The name of an ignored column."""


class Spelling(NamedTuple):
    """Plain names of the parts of a quantity, in one spelling."""

    names: Sequence[str]
    says: str = ""
    """A convention that the names imply, such as the order of a quaternion."""


class Quantity(NamedTuple):
    """A quantity that columns of a trajectory may hold."""

    meaning: str
    shown: str
    """Examples of names, for help texts."""
    spellings: Sequence[Spelling]

    @property
    def size(self) -> int:
        """The number of columns."""
        return len(self.spellings[0].names)


class FoundQuantity(NamedTuple):
    """A quantity that was found in a trajectory."""

    columns: Sequence[int]
    """The indices of the columns of its parts."""
    says: str
    unit: str | None
    """The unit in its headings."""


def _spelt(prefixes: str, parts: str, says: str = "") -> list[Spelling]:
    """Return one spelling for each prefix, joined to every part; `-` means an empty text."""
    return [
        Spelling([f"{prefix}{part}".replace("-", "") for part in parts.split()], says)
        for prefix in prefixes.split()
    ]


_XYZ, _DIGITS = "x y z", ("0 1 2", "0 1 2 3", "0 1 2 3 4 5 6 7 8")
_MATRIX = "matrix rotationmatrix rotation xmat rot r m"

QUANTITIES: dict[str, Quantity] = {
    "t": Quantity(
        "time", "t, time, timestamp", _spelt("t time timestamp times simtime xvalue", "-")
    ),
    "quaternion": Quantity(
        "quaternion from body to space",
        "quaternion_w ..., qw qx qy qz; by number: quaternion_0 ..., q0 ...",
        [
            *_spelt("quaternion quat q orientation attitude xquat -", "w x y z", "wxyz"),
            *_spelt("quaternion quat q orientation attitude", _DIGITS[1]),
            *_spelt("qpos u", "3 4 5 6", "wxyz"),  # a position comes first
            *_spelt("bodyq", "3 4 5 6", "xyzw"),
            *_spelt("qpos xquat ep eulerparameters", _DIGITS[1], "wxyz"),
        ],
    ),
    "matrix": Quantity(
        "rotation matrix from body to space, row by row",
        "matrix_0 ..., r11 r12 ... r33, R00 ... R22",
        [
            *_spelt(_MATRIX, _DIGITS[2]),
            *_spelt(_MATRIX, "11 12 13 21 22 23 31 32 33"),
            *_spelt(_MATRIX, "00 01 02 10 11 12 20 21 22"),
            *_spelt(_MATRIX, "xx xy xz yx yy yz zx zy zz"),
        ],
    ),
    "theta": Quantity(
        "tilt",
        "theta, theta_deg, theta_rad, \u03b8, tilt; elevation: 90 degrees minus the tilt",
        [*_spelt("theta tilt", "-"), Spelling(["elevation"], ELEVATION)],
    ),
    "phi": Quantity("spin", "phi, phi_deg, phi_rad, \u03c6, spin", _spelt("phi spin", "-")),
    "psi": Quantity(
        "precession",
        "psi, psi_deg, psi_rad, \u03c8, precession",
        _spelt("psi precession", "-"),
    ),
    "euler": Quantity(
        "three angles of turns about coordinate axes",
        "euler_0 ..., roll pitch yaw",
        [
            *_spelt("euler rpy", _DIGITS[0]),
            Spelling(["roll", "pitch", "yaw"], "xyz"),
            *_spelt("rotxyz", _DIGITS[0], "XYZ"),
        ],
    ),
    "rotvec": Quantity(
        "rotation vector from body to space, in radians",
        "rotvec_x ..., rv0 rv1 rv2",
        [x for parts in (_XYZ, _DIGITS[0]) for x in _spelt("rotvec rotationvector rv", parts)],
    ),
    "axis": Quantity(
        "figure axis in space",
        "axis_x axis_y axis_z",
        [x for parts in (_XYZ, _DIGITS[0]) for x in _spelt("axis figureaxis director", parts)],
    ),
    "position": Quantity(
        "mass centre in space, from the pivot; read if nothing above is given",
        "x y z, com_x ..., tx ty tz",
        [x for parts in (_XYZ, _DIGITS[0]) for x in _spelt("position com pos p t", parts)]
        + _spelt("-", _XYZ),
    ),
    "rates": Quantity(
        "angular velocity in radians per unit of time",
        "p q r (body), omega_x ..., omega_body_x ..., omega_space_x ..., wx wy wz",
        [
            *_spelt("-", "p q r", "body"),
            *(
                spelling
                for parts in (_XYZ, _DIGITS[0])
                for spelling in (
                    *_spelt("omega w angularvelocity gyro rates", parts),
                    *_spelt("omegabody omegalocal angularvelocitylocal wbody qvel", parts, "body"),
                    *_spelt("omegaspace omegaworld omegaglobal wspace", parts, "space"),
                )
            ),
        ],
    ),
    "angle_rates": Quantity(
        "rates of tilt, spin and precession in radians per unit of time",
        "thetadot phidot psidot",
        [
            Spelling(["thetadot", "phidot", "psidot"]),
            Spelling(["dtheta", "dphi", "dpsi"]),
            *_spelt("anglerates", _DIGITS[0]),
        ],
    ),
}
"""The quantities by name, in the order of preference for the attitude."""

_BY_PLAIN_NAME = {name.replace("_", ""): quantity for name, quantity in QUANTITIES.items()}

_EXUDYN = {
    "RotationMatrix": ["t", "matrix"],
    "Rotation": ["t", "rotxyz0_rad", "rotxyz1_rad", "rotxyz2_rad"],
    "AngularVelocity": ["t", "omega_space_x", "omega_space_y", "omega_space_z"],
    "AngularVelocityLocal": ["t", "omega_body_x", "omega_body_y", "omega_body_z"],
    "Position": ["t", "position"],
    "Displacement": ["t", "position"],
}
"""The columns of an EXUDYN sensor file by the kind of output in its comments."""


def quantities_in(names: Sequence[str]) -> dict[str, FoundQuantity]:
    """Return the quantities of some columns; a column belongs to the first quantity that fits."""
    words: dict[str, int] = {}
    for i, name in enumerate(names):
        words.setdefault(plain_name(name)[0], i)
    found: dict[str, FoundQuantity] = {}
    for key, quantity in QUANTITIES.items():
        for spelling in quantity.spellings:
            if all(name in words for name in spelling.names):
                columns = [words.pop(name) for name in spelling.names]
                unit = plain_name(names[columns[0]])[1]
                found[key] = FoundQuantity(columns, spelling.says, unit)
                break
    return found


def known_quantities(names: Sequence[str]) -> int:
    """Return the number of quantities that some headings name; 0 without a time."""
    found = quantities_in(names)
    return len(found) if "t" in found else 0


def numeric_columns(names: Sequence[str]) -> list[int]:
    """Return the columns of all quantities."""
    return [i for found in quantities_in(names).values() for i in found.columns]


def named_twice(names: Sequence[str], found: Mapping[str, FoundQuantity]) -> tuple[str, str] | None:
    """Return two names of the same part of a quantity, or of the same angle, or None."""
    plain = [plain_name(name)[0] for name in names]
    for key, quantity in found.items():
        angle = {x.names[0] for x in QUANTITIES[key].spellings} if key in ANGLES else set()
        for i in quantity.columns:
            for other, word in enumerate(plain):
                if other != i and word in {plain[i], *angle}:
                    return names[i], names[other]
    return None


def plain_name(name: str) -> tuple[str, str | None]:
    """Return a name in lower-case letters and digits only, and its unit.

    The name of an angle may end in its unit, as in `theta_deg`.  Only the last two parts of the
    path of a ROS message count, as in `/imu/orientation/x`.
    """
    text, unit = name_and_unit(name)
    text = text.lower()
    if text.startswith("/"):
        text = "/".join(text.split("/")[-2:])
    match = re.fullmatch(r"(.+?)[\s_.]*(deg|rad)(?:rees|ians)?", text)
    if not unit and match and not match[2].startswith(match[1]):
        text, unit = match[1], match[2]
    return re.sub(r"[^a-z0-9]", "", text), unit or None


def expanded(names: Sequence[str]) -> list[str]:
    """Return the names of columns, groups expanded: `quaternion` becomes quaternion_0 and so on.

    Raises LagtopError for an unknown name.
    """
    single: list[str] = []
    for name in names:
        word, unit = plain_name(name)
        quantity = _BY_PLAIN_NAME.get(word)
        if quantity is None or quantity.size == 1:
            single.append(name)
        else:
            ending = f"_{unit}" if unit else ""
            single += [f"{word}{i}{ending}" for i in range(quantity.size)]
    used = {i for found in quantities_in(single).values() for i in found.columns}
    for i, name in enumerate(single):
        if i not in used and name != SKIPPED:
            raise LagtopError(
                f"columns must be among {', '.join(QUANTITIES)}, all parts of one of them (such as "
                f"qw,qx,qy,qz) or {SKIPPED}, got {quoted(name)}{suggestion(name, QUANTITIES)}",
                "columns",
            )
    return single


def names_in_comments(comments: Sequence[str], cells: int) -> list[str] | None:
    """Return the names of `cells` columns from the comments above them, or None."""
    for comment in reversed(comments):
        if kind := re.fullmatch(r"OutputVariableType\s*=\s*(\w+)", comment):
            names = _EXUDYN.get(kind[1])
            return None if names is None else expanded(names)
        words = re.split(r"[\s,;]+", comment.strip())
        if len(words) == cells and "t" in quantities_in(words):
            return words
    return None
