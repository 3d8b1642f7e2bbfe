"""The columns of `lagtop table`: their presentation, and their formulas.

Formulas are attributes of `Parts`, the motion at one time in balls or at many times in doubles.
Common parts are computed on first use, from the attitude

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

up to a common positive factor.  With N = |X|^2 + |Y|^2, both 1 + u = 2 |X|^2/N and 1 - u = 2
|Y|^2/N keep their digits next to the poles.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Generic, NamedTuple

from ..arithmetic.key import Key
from ..arithmetic.numbers import R
from ..names import ANGLES, check_names
from .kinds import Kind, Vertical
from .quantity import quantity

if TYPE_CHECKING:
    from ..arithmetic.numbers import Arithmetic
    from .regime import Exact


GROUPS = {
    "axis": "figure axis in space: axis_x, axis_y, axis_z",
    "quaternion": "from body to space, scalar first: quaternion_w, quaternion_x, ...",
}
"""The meanings of names that stand for several columns."""

_DECLARED = r"""
t | t | time | time
theta | ϑ | tilt | angle | (4,9) | acos(u)
phi | φ | spin | angle | (6,1) | integral(phidot, 0, t)
psi | ψ | precession | angle | (7,1) | integral(psidot, 0, t)
dphi | Δφ | spin less its mean rate times t, a wave | angle | (6,4) | phi - mean_spin_rate*t
dpsi | Δψ | precession less its mean rate times t, a wave | angle | (7,4) \
    | psi - mean_precession_rate*t
u | u | cos ϑ | | (4,30) | u2 + (u1 - u2)*sn(K + 2*K*(t - t1)/T_nutation, k)**2
thetadot | ϑ' | nutation rate | rad/time | (4,2) \
    | thetadot**2 = energy_constant - a*u - psidot**2*(1 - u**2)
phidot | φ' | spin rate | rad/time | (4,8) | r0 - psidot*u
psidot | ψ' | precession rate | rad/time | (4,7) | (momentum_constant - b*u)/(1 - u**2)
p | p | angular velocity about the body's x axis | rad/time | (4,1) \
    | thetadot*cos(phi) + psidot*sin(theta)*sin(phi)
q | q | angular velocity about the body's y axis | rad/time | (4,1) \
    | psidot*sin(theta)*cos(phi) - thetadot*sin(phi)
r | r | angular velocity about the figure axis | rad/time | (4,1) | r0
moment | M | moment of the weight about the line of nodes | mass len²/time² | | m*g*s*sin(theta)
axis_x | | x part in space | | | sin(theta)*sin(psi)
axis_y | | y part in space | | | -sin(theta)*cos(psi)
axis_z | | z part in space | | | u
quaternion_w | | real part of X = w + i z | | | cos(theta/2)*cos((psi + phi)/2)
quaternion_x | | real part of Y = x + i y | | | sin(theta/2)*cos((psi - phi)/2)
quaternion_y | | imaginary part of Y = x + i y | | | sin(theta/2)*sin((psi - phi)/2)
quaternion_z | | imaginary part of X = w + i z | | | cos(theta/2)*sin((psi + phi)/2)
energy | E | energy; constant except for rounding | mass len²/time² | (4,2) \
    | (A*(p**2 + q**2) + C*r**2)/2 + m*g*s*u
Lz | c2 | vertical angular momentum; constant except for rounding | mass len²/time | (4,3) \
    | A*psidot*sin(theta)**2 + C*r0*u
"""
"""Name, symbol, meaning, unit, equation and formula of each column.

A formula is in names of columns and keys; t1 is the time of a passage of u1.
"""

SCALARS: dict[str, Key] = {}
"""The presentation of each column; its group is the name of several columns, or empty."""
for _line in _DECLARED.replace("\\\n", "").strip().splitlines():
    _name, *_texts = (text.strip() for text in _line.split("|"))
    _group = _name.partition("_")[0]
    SCALARS[_name] = Key(_group if _group in GROUPS else "", *_texts)

COLUMNS: dict[str, dict[str, Key]] = {}
"""The columns that each name stands for, in the order of `SCALARS`."""
for _name, _column in SCALARS.items():
    COLUMNS.setdefault(_column.group or _name, {})[_name] = _column

DEFAULT_COLUMNS = ("t", *ANGLES)


def shown_columns(*, radians: bool = False, named: Callable[[str], str] = str) -> dict[str, Key]:
    """Return how each of `COLUMNS` is presented; `named` gives the names of units.

    The formula of a group has one equation per column.
    """
    keys = dict(SCALARS)
    for group, meaning in GROUPS.items():
        formula = ", ".join(f"{name} = {key.formula}" for name, key in COLUMNS[group].items())
        keys[group] = Key(group, "", meaning, formula=formula)
    return {name: keys[name].in_units(radians=radians, named=named) for name in COLUMNS}


def column_names() -> list[str]:
    """Return the names of all columns, groups first."""
    return list(COLUMNS | SCALARS)


def chosen_columns(names: Sequence[str]) -> dict[str, Key]:
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
        f"{name}_{unit}" if column.unit == "angle" else name
        for name, column in chosen_columns(columns).items()
    ]


class ColumnConstants(NamedTuple, Generic[R]):
    """The constants of a top used in its columns."""

    A: R
    C: R
    torque: R
    """mgs."""
    r0: R
    drift: R
    """r0 - b, or r0 on the vertical, where `plus` and `minus` are 0."""
    plus: R
    """(beta + b)/2."""
    minus: R
    """(beta - b)/2."""
    alpha: R
    a: R


def column_constants(kind: Kind[R], exact: Exact) -> ColumnConstants[R]:
    """Return the constants of a motion in its arithmetic."""
    ar, state = kind.ar, kind.state
    A, C = Fraction(exact.top.A), Fraction(exact.top.C)
    with ar.working():
        drift, plus, minus = state.pole_drift, kind.gaps.beta_plus_b / 2, kind.gaps.beta_minus_b / 2
        if isinstance(kind, Vertical):  # all of the rotation counts as spin
            drift, plus, minus = kind.r0, 0 * kind.r0, 0 * kind.r0
        inertia = ar.convert(A), ar.convert(C), ar.convert(exact.a * A / 2)
        alpha = state.energy + state.a * state.cos
        return ColumnConstants(*inertia, state.r0, drift, plus, minus, alpha, state.a)


class Parts(Generic[R]):
    """A motion at one or several times.

    Each column is an attribute of its name; subclasses have `theta`, `phi`, `psi`, `dphi`, `dpsi`
    and the attributes that are annotated here.
    """

    ar: Arithmetic[R]
    t: Any
    top: ColumnConstants[R]
    sizes: Any
    """|X| and |Y|."""
    moduli: Any
    """|X|^2 and |Y|^2."""
    within: Any
    """The spin, up to whole turns."""
    around: Any
    """The precession, up to whole turns."""
    thetadot: Any
    """The nutation rate (5,3)."""
    over: Callable[[R, R], R]
    """A quotient that is 0 for 0/0: on a pole the momentum about it is 0."""

    @quantity
    def args(self) -> tuple[R, R]:
        """(psi + phi)/2 and (psi - phi)/2, up to whole turns of both or half a turn of both."""
        return (self.around + self.within) / 2, (self.around - self.within) / 2

    @quantity
    def unit(self) -> Any:
        """|X| and |Y|, each over sqrt(N)."""
        size, (x, y) = self.ar.sqrt(self.norm), self.sizes
        return x / size, y / size

    norm = quantity[Any](lambda at: at.moduli[0] + at.moduli[1])
    """N."""
    u = quantity[Any](lambda at: (at.moduli[0] - at.moduli[1]) / at.norm)
    """cos(theta) (4,6)."""
    sine = quantity[Any](lambda at: 2 * at.sizes[0] * at.sizes[1] / at.norm)
    """sin(theta)."""
    south = quantity[Any](lambda at: at.over(at.top.plus * at.norm, 2 * at.moduli[0]))
    """(beta + b)/2/(1 + u), the part of the precession rate from the lower pole."""
    north = quantity[Any](lambda at: at.over(at.top.minus * at.norm, 2 * at.moduli[1]))
    """(beta - b)/2/(1 - u), the part of the precession rate from the upper pole."""
    sin_spin = quantity[Any](lambda at: at.ar.sin(at.within))
    cos_spin = quantity[Any](lambda at: at.ar.cos(at.within))

    @quantity
    def across(self) -> R:
        """psi' sin(theta), the angular velocity across the line of nodes (4,1)."""
        x, y = self.sizes
        return self.over(self.top.plus * y, x) + self.over(self.top.minus * x, y)

    phidot = property(lambda at: at.top.drift + at.south - at.north)
    psidot = property(lambda at: at.south + at.north)
    p = property(lambda at: at.across * at.sin_spin + at.thetadot * at.cos_spin)
    q = property(lambda at: at.across * at.cos_spin - at.thetadot * at.sin_spin)
    r = property(lambda at: at.top.r0)
    moment = property(lambda at: at.top.torque * at.sine)
    axis_x = property(lambda at: at.sine * at.ar.sin(at.around))
    axis_y = property(lambda at: -at.sine * at.ar.cos(at.around))
    axis_z = property(lambda at: at.u)
    quaternion_w = property(lambda at: at.unit[0] * at.ar.cos(at.args[0]))
    quaternion_x = property(lambda at: at.unit[1] * at.ar.cos(at.args[1]))
    quaternion_y = property(lambda at: at.unit[1] * at.ar.sin(at.args[1]))
    quaternion_z = property(lambda at: at.unit[0] * at.ar.sin(at.args[0]))

    @property
    def energy(self) -> Any:
        """A (theta'^2 + psi'^2 sin^2 theta)/2 + C r0^2/2 + mgs u (4,2)."""
        swing = self.thetadot * self.thetadot + self.across * self.across
        rotation = self.top.A / 2 * swing + self.top.C / 2 * self.top.r0 * self.top.r0
        return rotation + self.top.torque * self.u

    @property
    def Lz(self) -> Any:
        """A psi' sin^2 theta + C r0 u (4,3)."""
        return self.top.A * self.across * self.sine + self.top.C * self.top.r0 * self.u
