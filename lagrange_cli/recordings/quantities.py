"""The columns of a trajectory by name: their quantities, and the conventions that names imply.

To add a name or a quantity, add a line to a table.  The help of `lagtop compare` and the table in
the README of `compare` are generated from them.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ..arithmetic.text import quoted, shortened
from ..arithmetic.types import Array
from ..errors import LagtopError, arg
from ..files.headings import name_and_unit, plain_name
from ..names import ANGLES, suggestion
from ..top.inputs import declared
from ..top.units import conversion, is_unit

SKIPPED = "_"
"""The name of an ignored column."""
NAMING = f"for example {arg('columns', 't,quaternion')} ('t [ms]' for times in ms)"
"""An example of names of columns, for messages."""


class Quantity(NamedTuple):
    """A quantity that columns of a trajectory may hold."""

    meaning: str
    shown: str
    """Examples of names, for help texts."""
    unit: str
    """`angle`, `time` or `rad/time`, which are converted; or the only unit, empty for none."""
    spellings: Sequence[tuple[Sequence[str], str]]
    """Plain names of its parts in each spelling, and a convention that they imply, if any."""

    @property
    def size(self) -> int:
        """The number of columns."""
        return len(self.spellings[0][0])


class FoundQuantity(NamedTuple):
    """A quantity that was found in a trajectory."""

    columns: Sequence[int]
    """The indices of the columns of its parts."""
    says: str = ""
    unit: str | None = None
    """The unit in its headings, or the one into which they are converted by the factor."""
    written: str = ""
    """The unit as it is written."""
    factor: Fraction | None = None
    """The factor that converts its numbers to the units in use, if any."""


_QUANTITIES = """
t | time | time | t, time, timestamp
quaternion | | quaternion from body to space
    | quaternion_w ..., qw qx qy qz; by number: quaternion_0 ..., q0 ...
matrix | | rotation matrix from body to space, row by row
    | matrix_0 ..., r11 r12 ... r33, R00 ... R22
theta | angle | tilt | theta, theta_deg, theta_rad, θ, tilt; elevation: 90 degrees minus the tilt
phi | angle | spin | phi, phi_deg, phi_rad, φ, spin
psi | angle | precession | psi, psi_deg, psi_rad, ψ, precession
euler | angle | three angles of turns about coordinate axes | euler_0 ..., roll pitch yaw
rotvec | rad | rotation vector from body to space, in radians | rotvec_x ..., rv0 rv1 rv2
axis | | figure axis in space | axis_x axis_y axis_z
position | m | position of a marker on the axis; read if nothing above is given
    | x y z, com_x ..., tx ty tz
above | m | marker seen from above, which gives psi; read if nothing above is given | x y
rates | rad/time | angular velocity; in radians per unit of time
    | p q r (body), omega_x ..., omega_body_x ..., omega_space_x ..., wx wy wz
angle_rates | rad/time | rates of tilt, spin and precession; in radians per unit of time
    | thetadot phidot psidot
"""
"""The name of each quantity, its unit, its meaning, and examples of columns."""

_SPELLINGS = """
t | t time timestamp times simtime xvalue | |
t | | sec nanosec; secs nsecs; stampsec stampnanosec; stampsecs stampnsecs | nanoseconds
t | elapsed elapsedtime secondselapsed sec secs seconds | |
t | frame frames framenumber frameno | | frames
quaternion | quaternion quat q orientation attitude xquat rot rotation | w x y z | wxyz
quaternion | | w x y z | wxyz
quaternion | quaternion quat q orientation attitude rotation rot | 0 1 2 3 |
quaternion | qpos u | 3 4 5 6 | wxyz
quaternion | bodyq | 3 4 5 6 | xyzw
quaternion | qpos xquat ep eulerparameters | 0 1 2 3 | wxyz
matrix | matrix rotationmatrix rotation xmat rot r m
    | 0 1 2 3 4 5 6 7 8; 11 12 13 21 22 23 31 32 33; 00 01 02 10 11 12 20 21 22;
    xx xy xz yx yy yz zx zy zz |
theta | theta tilt | |
theta | elevation | | elevation
phi | phi spin | |
psi | psi precession | |
euler | euler rpy | 0 1 2 |
euler | | roll pitch yaw | xyz
euler | rotxyz | 0 1 2 | XYZ
rotvec | rotvec rotationvector rv | x y z; 0 1 2 |
axis | axis figureaxis director | x y z; 0 1 2 |
position | position com pos p t | x y z; 0 1 2 |
position | | x y z |
above | above | x y; 0 1 |
above | | x y |
rates | | p q r | body
rates | omega w angularvelocity gyro gyroscope rates | x y z; 0 1 2 |
rates | omegabody omegalocal angularvelocitylocal wbody qvel | x y z; 0 1 2 | body
rates | omegaspace omegaworld omegaglobal wspace | x y z; 0 1 2 | space
angle_rates | | thetadot phidot psidot |
angle_rates | | dtheta dphi dpsi |
angle_rates | anglerates | 0 1 2 |
"""
"""The quantity of some columns, possible prefixes and endings, and the convention they imply.

The plain name of a column is a prefix followed by an ending: `qw` for the prefix q, the ending w.
"""


def _spellings_of(key: str) -> list[tuple[Sequence[str], str]]:
    """Return the declared spellings of a quantity, one for each prefix and set of endings."""
    return [
        ([prefix + ending for ending in some.split() or [""]], says)
        for quantity, prefixes, endings, says in declared(_SPELLINGS)
        if quantity == key
        for some in endings.split(";")
        for prefix in prefixes.split() or [""]
    ]


QUANTITIES = {
    key: Quantity(meaning, shown, unit, _spellings_of(key))
    for key, unit, meaning, shown in declared(_QUANTITIES)
}
"""The quantities by name, in the order of preference for the attitude."""

_TIMES = {name for names, _ in QUANTITIES["t"].spellings for name in names}

_BY_PLAIN_NAME = {name.replace("_", ""): quantity for name, quantity in QUANTITIES.items()}

_POSE = "r11 r12 r13 x r21 r22 r23 y r31 r32 r33 z".split()
"""The columns of a pose, as KITTI and others write it: the rows of a rotation and a translation."""

_NO_UNITS = {None, "-", "1", "time", "rad/time", "1/time"}
"""Units that mean those of the scene, as in a drawn table."""


def quantities_in(names: Sequence[str]) -> dict[str, FoundQuantity]:
    """Return the quantities of some columns; a column belongs to the first quantity that fits."""
    plain = _plain_names(names)
    words = {word: i for i, (word, _) in reversed([*enumerate(plain)])}
    found: dict[str, FoundQuantity] = {}
    for key, quantity in QUANTITIES.items():
        for spelling, says in quantity.spellings:
            one_more = f"{spelling[0][:-1]}{len(spelling)}"  # of a longer list
            fits = all(name in words for name in spelling)
            if key not in found and fits and not (spelling[0][-1] == "0" and one_more in words):
                columns = [words.pop(name) for name in spelling]
                found[key] = FoundQuantity(columns, says, plain[columns[0]][1])
    return found


def _plain_names(names: Sequence[str]) -> list[tuple[str, str | None]]:
    """Return the plain names and units of columns; T beside another time is a temperature."""
    found = [plain_name(name) for name in names]
    if sum(word in _TIMES for word, _ in found) < 2:
        return found
    return [("", None) if name == "T" else x for name, x in zip(names, found, strict=True)]


def known_quantities(names: Sequence[str]) -> int:
    """Return the number of quantities that some headings name; 0 without a time."""
    found = quantities_in(names)
    return len(found) if "t" in found else 0


def with_units_of(headings: Sequence[str], names: Sequence[str]) -> list[str]:
    """Return names of columns; those without a unit take that of the heading they replace."""
    found = quantities_in(names).items()
    may_have_unit = {i for key, x in found if QUANTITIES[key].unit for i in x.columns}
    named = list(names)
    for i in may_have_unit:
        unit = name_and_unit(headings[i])[1]
        if unit and is_unit(unit) and not plain_name(names[i])[1]:
            named[i] = f"{names[i]} [{unit}]"
    return named


def found_in(names: Sequence[str], *, needs_time: bool = True) -> dict[str, FoundQuantity]:
    """Return the quantities of a trajectory, a time among them (see `in_known_unit`).

    Raises LagtopError for columns without a time or a quantity besides; the key of the error is
    `columns` if a quantity is named twice.
    """
    found = quantities_in(names)
    if (needs_time and "t" not in found) or len({*found} - {"t"}) < 1:
        wanted = f"the time ({QUANTITIES['t'].shown}) and one of {', '.join([*QUANTITIES][1:])}"
        shown = shortened(", ".join(map(repr, names)), 120) or "none"
        remedy = f"name them, {NAMING}"
        if found and "t" not in found:
            remedy = f"the time is missing, give {arg('dt')} or {arg('fps')} for even rows"
        raise LagtopError(f"columns must name {wanted}, got {shown}: {remedy}")
    plain = [word for word, _ in _plain_names(names)]
    for key, quantity in found.items():
        angle = {x[0] for x, _ in QUANTITIES[key].spellings} if key in ANGLES else set()
        for i in quantity.columns:
            same = [repr(names[j]) for j, x in enumerate(plain) if x in {plain[i], *angle}]
            if len(same) > 1:
                wrong = f"must name each quantity once, got {' and '.join(same)}"
                remedy = f"skip one with _, for example {arg('columns', 't,theta,_')}"
                raise LagtopError(f"columns {wrong}: {remedy}", "columns")
    return {key: in_known_unit(key, x, names) for key, x in found.items()}


def in_known_unit(key: str, found: FoundQuantity, names: Sequence[str]) -> FoundQuantity:
    """Return a quantity with the factor to s, m, rad/s or rad, if any.  Raises LagtopError."""
    named = [names[i] for i in found.columns]
    if len({plain_name(part)[1] for part in named}) > 1:
        shown = " and ".join(map(repr, named[:2]))
        raise LagtopError(f"the parts of {key} must have one unit, got {shown}")
    own, unit = QUANTITIES[key].unit, found.unit
    if unit in {*_NO_UNITS, own}:
        return found._replace(unit=None)
    if own == "angle" and unit in {"deg", "rad"}:
        return found
    if not own:
        raise LagtopError(f"{key} must have no unit, got {quoted(unit)}")
    into = "rad" if own == "angle" else own
    factor = conversion(key, str(unit), into)[0]
    return found._replace(unit=into, written=str(unit), factor=factor)


def converted(key: str, found: FoundQuantity, values: Array, *, radians: bool) -> Array:
    """Return numbers in known units, all angles in radians; `radians` if their unit is missing."""
    if found.factor is not None:
        size = float(max(found.factor, 1 / found.factor))
        values = values * size if found.factor > 1 else values / size  # by a whole number, if it is
    if QUANTITIES[key].unit != "angle":
        return values
    radians = radians if found.unit is None else found.unit == "rad"
    if found.says == "elevation":  # from the horizontal
        values = (np.pi / 2 if radians else 90.0) - values
    return values if radians else np.asarray(np.radians(values))


def expanded(names: Sequence[str]) -> list[str]:
    """Return names of columns, `quaternion` as quaternion_0 and so on.  Raises LagtopError."""
    single: list[str] = []
    for name in names:
        if name == "pose":
            single += _POSE
            continue
        word, unit = plain_name(name)
        quantity = _BY_PLAIN_NAME.get(word)
        size, ending = quantity.size if quantity else 1, f"_{unit}" if unit else ""
        single += [name] if size == 1 else [f"{word}{i}{ending}" for i in range(size)]
    found = quantities_in(single)
    used = {single[i] for x in found.values() for i in x.columns}
    if unknown := [name for name in single if name not in {*used, SKIPPED}]:
        wanted = f"columns must be one of {', '.join(QUANTITIES)}, all parts of one (such as"
        got = f"{quoted(unknown[0])}{suggestion(unknown[0], QUANTITIES)}"
        raise LagtopError(f"{wanted} qw,qx,qy,qz) or {SKIPPED}, got {got}", "columns")
    for key, x in found.items():
        in_known_unit(key, x, single)
    return single
