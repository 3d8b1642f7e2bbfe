"""The columns of `lagtop table`: each is declared once, with its formula.

A line of the table is

    name | symbol | meaning | unit | equation | formula

and an indented line continues the line before.  A formula is in names of columns and keys.  If
digits would be lost, as next to a pole, the form that is evaluated follows after `~`, in names that
are defined below.  Arrays of doubles (`sampling`) and proved rows (`tables`) evaluate the same
forms; both start from the attitude

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

up to a common positive factor.  With N = |X|^2 + |Y|^2, both 1 + u = 2 |X|^2/N and 1 - u = 2
|Y|^2/N keep their digits next to the poles.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from flint import arb

from ..arithmetic.enclosures import exact
from ..arithmetic.formulas import evaluated
from ..names import ANGLES, Key, check_names
from ..top.inputs import declared
from ..top.units import DEGREES, Units
from .numbers import Numbers

GROUPS = {
    "axis": "figure axis in space: axis_x, axis_y, axis_z",
    "quaternion": "from body to space, scalar first: quaternion_w, quaternion_x, ...",
    "matrix": "from body to space, row by row: matrix_xx, matrix_xy, ...",
    "omega": "angular velocity in space: omega_space_x, ...",
}
"""The meanings of names that stand for several columns."""

_TEXT = """
t | t | time | time | |
theta | ϑ | tilt | angle | (4,6) | acos(u) ~ tilt
phi | φ | spin | angle | (6,1) | integral(phidot, 0, t) ~ spin
psi | ψ | precession | angle | (7,1) | integral(psidot, 0, t) ~ precession
dphi | Δφ | periodic part of the spin, from 0 at t = 0 | angle | (6,4)
   | phi - mean_spin_rate*t ~ spin_wave
dpsi | Δψ | periodic part of the precession, from 0 at t = 0 | angle | (7,4)
   | psi - mean_precession_rate*t ~ precession_wave
u | u | cos ϑ | | (4,20)
   | u2 + (u1 - u2)*sn(K + 2*K*(t - t1)/T_nutation, k)**2 ~ (XX - YY)/N
thetadot | ϑ' | nutation rate | rad/time | (4,2)
   | thetadot**2 = energy_constant - a*u - psidot**2*(1 - u**2) ~ nutation_rate
phidot | φ' | spin rate | rad/time | (4,8) | r0 - psidot*u ~ drift + south - north
psidot | ψ' | precession rate | rad/time | (4,7)
   | (momentum_constant - b*u)/(1 - u**2) ~ south + north
p | p | angular velocity about the body's x axis | rad/time | (4,1)
   | thetadot*cos(phi) + psidot*sin(theta)*sin(phi)
   ~ thetadot*cos(spin_turn) + across*sin(spin_turn)
q | q | angular velocity about the body's y axis | rad/time | (4,1)
   | psidot*sin(theta)*cos(phi) - thetadot*sin(phi)
   ~ across*cos(spin_turn) - thetadot*sin(spin_turn)
r | r | angular velocity about the figure axis | rad/time | (4,1) | r0
moment | M | moment of the weight about the line of nodes | mass len²/time² | | m*g*s*sin(theta)
   ~ torque*sine
axis_x | | x part in space | | | sin(theta)*sin(psi) ~ sine*sin(precession_turn)
axis_y | | y part in space | | | -sin(theta)*cos(psi) ~ -sine*cos(precession_turn)
axis_z | | z part in space | | | u
quaternion_w | | real part of X = w + i z | | | cos(theta/2)*cos((psi + phi)/2)
   ~ signed_X*cos(angle_X)/sqrt(N)
quaternion_x | | real part of Y = x + i y | | | sin(theta/2)*cos((psi - phi)/2)
   ~ signed_Y*cos(angle_Y)/sqrt(N)
quaternion_y | | imaginary part of Y = x + i y | | | sin(theta/2)*sin((psi - phi)/2)
   ~ signed_Y*sin(angle_Y)/sqrt(N)
quaternion_z | | imaginary part of X = w + i z | | | cos(theta/2)*sin((psi + phi)/2)
   ~ signed_X*sin(angle_X)/sqrt(N)
matrix_xx | | | | | cos(psi)*cos(phi) - u*sin(psi)*sin(phi)
   ~ quaternion_w**2 + quaternion_x**2 - quaternion_y**2 - quaternion_z**2
matrix_xy | | | | | -cos(psi)*sin(phi) - u*sin(psi)*cos(phi)
   ~ 2*(quaternion_x*quaternion_y - quaternion_w*quaternion_z)
matrix_xz | | | | | sin(theta)*sin(psi) ~ axis_x
matrix_yx | | | | | sin(psi)*cos(phi) + u*cos(psi)*sin(phi)
   ~ 2*(quaternion_x*quaternion_y + quaternion_w*quaternion_z)
matrix_yy | | | | | -sin(psi)*sin(phi) + u*cos(psi)*cos(phi)
   ~ quaternion_w**2 - quaternion_x**2 + quaternion_y**2 - quaternion_z**2
matrix_yz | | | | | -sin(theta)*cos(psi) ~ axis_y
matrix_zx | | | | | sin(theta)*sin(phi) ~ sine*sin(spin_turn)
matrix_zy | | | | | sin(theta)*cos(phi) ~ sine*cos(spin_turn)
matrix_zz | | | | | u
omega_space_x | | | rad/time | | thetadot*cos(psi) + phidot*sin(theta)*sin(psi)
   ~ thetadot*cos(precession_turn) - across*u*sin(precession_turn) + r*axis_x
omega_space_y | | | rad/time | | thetadot*sin(psi) - phidot*sin(theta)*cos(psi)
   ~ thetadot*sin(precession_turn) + across*u*cos(precession_turn) + r*axis_y
omega_space_z | | | rad/time | | psidot + phidot*u ~ across*sine + r*u
energy | E | energy; constant except for rounding | mass len²/time² | (4,2)
   | (A*(p**2 + q**2) + C*r**2)/2 + m*g*s*u
   ~ A*thetadot*thetadot/2 + A*across*across/2 + C*r0*r0/2 + torque*u
Lz | c2 | vertical angular momentum; constant except for rounding | mass len²/time | (4,3)
   | A*psidot*sin(theta)**2 + C*r0*u ~ A*across*sine + C*r0*u
"""
"""In formulas, t1 is the time of a passage of u1."""

FORMULAS = {
    "N": "XX + YY",
    "sine": "2*X*Y/N",  # of the tilt
    "across": "ratio(plus*Y, X) + ratio(minus*X, Y)",  # psi' sin(theta), across the line of nodes
    "south": "ratio(plus*N, 2*XX)",  # (beta + b)/2/(1 + u), the part of psi' from the lower pole
    "north": "ratio(minus*N, 2*YY)",  # (beta - b)/2/(1 - u), the part of psi' from the upper pole
}
"""The form of each column that is evaluated, and of names in it; see `Columns` for the others."""
SCALARS: dict[str, Key] = {}
"""The presentation of each column; its group is the name of several columns, or empty."""
for _name, _symbol, _meaning, _unit, _equation, _formula in declared(_TEXT):
    _printed, _, _evaluated = map(str.strip, _formula.partition("~"))
    _group = _name.partition("_")[0]
    _group = _group if _group in GROUPS else ""
    SCALARS[_name] = Key(_group, _symbol, _meaning, _unit, _equation, _printed)
    FORMULAS[_name] = _evaluated or _printed

COLUMNS: dict[str, dict[str, Key]] = {}
"""The columns that each name stands for, in the order of `SCALARS`."""
for _name, _column in SCALARS.items():
    COLUMNS.setdefault(_column.group or _name, {})[_name] = _column

DEFAULT_COLUMNS = ("t", *ANGLES)
REDUCED = {"phi": "spin_turn", "psi": "precession_turn"}
"""The names, in formulas, of phi and psi within a turn."""
WITHOUT_ATTITUDE = frozenset({"t", "r"})
"""Columns that need no attitude."""
WITHIN_A_TURN = frozenset(
    "p q axis_x axis_y quaternion_w quaternion_x quaternion_y quaternion_z".split()
) | {*REDUCED.values(), *COLUMNS["matrix"], *COLUMNS["omega"]}
"""Columns that need an angle within a turn."""


def shown_columns(units: Units = DEGREES) -> dict[str, Key]:
    """Return how each of `COLUMNS` is presented, with its unit as printed.

    The formula of a group has one equation per column.
    """
    keys = dict(SCALARS)
    for group, meaning in GROUPS.items():
        formula = ", ".join(f"{name} = {key.formula}" for name, key in COLUMNS[group].items())
        keys[group] = Key(group, "", meaning, formula=formula)
    return {x: keys[x]._replace(unit=units.named(keys[x].unit)) for x in COLUMNS}


def chosen_columns(names: Sequence[str]) -> dict[str, Key]:
    """Return the columns of some names, groups expanded.

    Raises LagtopError for an unknown or repeated name.
    """
    check_names("columns", names, [*COLUMNS | SCALARS])
    chosen = [part for name in names for part in COLUMNS.get(name, [name])]
    check_names("columns", chosen, chosen)
    return {name: SCALARS[name] for name in chosen}


def headings(columns: Iterable[str], units: Units) -> list[str]:
    """Return the headings of some columns."""
    return [units.key(name + "_deg" * (SCALARS[name].unit == "angle")) for name in columns]


def column_constants(of: Numbers) -> dict[str, arb]:
    """Return the constants in the formulas of columns, in balls.

    `drift` is r0 - b, `torque` is mgs, `plus` and `minus` are (beta + b)/2 and (beta - b)/2.
    On the vertical all of the rotation counts as spin.
    """
    facts, r0 = of.facts, of["r0"] if of.facts.spin else arb(0)
    names = ("A", "C", "a", "energy_constant")
    found = {name: of[name] for name in names} | {"r0": r0, "torque": of["m"] * of["g"] * of["s"]}
    if facts.vertical:
        return found | {"drift": r0, "plus": arb(0), "minus": arb(0)}
    drift = r0 * exact(1 - facts.inputs["C"] / facts.inputs["A"])
    plus, minus = of["beta_plus_b"] / 2, of["beta_minus_b"] / 2
    return found | {"drift": drift, "plus": plus, "minus": minus}


class Columns(dict[str, Any]):
    """Columns of a motion at one or several times by name; each is computed on first use.

    The first items are the constants, `t`, and functions: cos, sin, sqrt, square and ratio (a
    quotient that is 0 for 0/0: on a pole the momentum about it is 0).  They and `formulas` have

    - X, Y, XX, YY: |X|, |Y| and their squares,
    - tilt, spin, precession, spin_wave, precession_wave, nutation_rate,
    - spin_turn, precession_turn: spin and precession, perhaps without whole turns,
    - angle_X, angle_Y: arguments of X and Y, perhaps without whole half turns, and signed_X,
      signed_Y: |X| and |Y|, negative if an odd number of them is left out.
    """

    def __init__(self, formulas: Mapping[str, str], items: Mapping[str, Any]) -> None:
        super().__init__(items)
        self.formulas = formulas

    def __missing__(self, name: str) -> Any:
        found = self[name] = evaluated(self.formulas[name], self)
        return found
