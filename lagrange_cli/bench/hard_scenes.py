"""Random scenes of every hard kind: the one list of `stability`, of the tests and of the fuzz.

A kind is one row of a table: its name, its scenes in words, the rows that it begins with, and
assignments to the inputs in Python.  Lengths, masses and times are of the size of 1, and rates have
both signs, unless a row states otherwise.  Numbers are doubles, or fractions if a double cannot be
near enough to the hard case.  With m = s = g = 1, a is 2/A and b is C*r0/A.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from functools import cache, partial
from random import Random
from types import CodeType
from typing import Any

from ..errors import LagtopError
from ..solver.solve import solve
from ..top.inputs import INPUTS, declared
from ..top.top import Top
from .reference import check

Scene = dict[str, Any]
Kind = Callable[[Random], Scene]

_PARTS = """\
moving | ordinary tops with moderate rates |
    | m = s = g = 1; A = uniform(0.5, 2); C = A*uniform(0.05, 2); r0 = uniform(-6, 6);
    theta0_deg = uniform(1, 179); thetadot0 = uniform(-3, 3); psidot0 = uniform(-4, 4)
released | the same, released from rest | moving | thetadot0 = psidot0 = 0
ordinary | the same; half start at an end of their nutation | moving | thetadot0 *= one(0, 1)
any rates | a spin of 1e-3 to 1e3, and other rates of 0, of 1 or down to 1e-25 | generic
    | r0 = size(-3, 3); thetadot0 = one(0, size(-25, 1), 1); psidot0 = one(0, size(-25, 1), 1)
swing | a swing that ends upright: psi' = b/(1 + u), theta'^2 = a (1 - u) - psi'^2 (1 - u^2) |
    | part = uniform(0.05, 0.9); r0 = signed(sqrt(4*A*part)/C); u = uniform(2*part - 1, 1);
    theta0_deg = degrees(acos(u)); psidot0 = C*r0/A/(1 + u);
    thetadot0 = signed(root(2/A*(1 - u) - psidot0**2*(1 - u*u)))
passage | the axis passes over a pole |
    | r0 = uniform(-3, 3); u = cos(radians(theta0_deg)); pole = one(-1, 1);
    psidot0 = pole*C*r0/A/(1 + pole*u); thetadot0 = root(uniform(0, 40) - psidot0**2*(1 - u*u))
slow rate | the slow rate of steady precession |
    | r0 = signed(sqrt(4*A)/C*uniform(1, 5)); b = C*r0; u = cos(radians(theta0_deg));
    psidot0 = 2/(b + copysign(root(b*b - 4*A*u), b)); thetadot0 = 0
exact tilt | a tilt with a rational cosine u, and a spherical top |
    | theta0_deg, u = one((60, 0.5), (90, 0.0), (120, -0.5)); A = C = s = g = 1; thetadot0 = 0
"""
"""Rows that others begin with."""
_NUTATING = """\
generic | any start of any body: a sphere, a disc, a needle | ordinary
    | psidot0 *= one(0, 1, 1); off = one(0, power(-15, -6));
    C = A*one(uniform(0.01, 2), power(-8, -2), 1 + signed(off), 2*(1 - off))
from rest | releases, slow to fast | generic
    | thetadot0 = psidot0 = 0; r0 = one(size(-3, 3), signed(uniform(0, 9)))
stiff | fast rates: the spin, or some | generic
    | sized(one("r0", "r0", "r0 thetadot0 psidot0"), 1, 15, 3)
slow | tiny rates, some or all | generic | sized("r0 thetadot0 psidot0", -30, -1, 3)
tiny tilt | 1e-30 to 1 degree from the vertical; spins about the threshold of sleep | generic
    | theta0_deg = one(power(-12, 0), power(-30, 0), 180 - power(-12, 0));
    r0 = signed(sqrt(4*A)/C*one(uniform(0.1, 3), near(1), near(1)));
    thetadot0 = one(0, size(-20, -1)); psidot0 = one(0, 1, -2.5)
tiny tilt with rates | 1e-150 to 0.1 degrees; smaller tilts are refused | any rates
    | theta0_deg = power(-150, -1)
near a pole | the axis passes within 1e-16 to 1e-2 of a pole | generic, passage
    | psidot0 = near(psidot0)
near separatrix | swings that nearly end upright | generic, swing
    | thetadot0 = near(thetadot0); psidot0 = near(psidot0)
near steady | a steady precession, a little disturbed | generic, slow rate
    | psidot0 = near(psidot0); thetadot0 = one(0, size(-16, -3))
next to rest | rates of 1e-18 to 1e-3 beside the spin | generic
    | x, y = size(-18, -3), size(-18, -3); thetadot0, psidot0 = one((x, 0), (0, y), (x, y))
next to a cusp | b N^2 + P (b P - a) sin^2 is nearly 0: off by 1e-2 to 1e-60 of the rates | generic
    | a = 2/A; b = C*r0/A; turn = near(a/b*uniform(0, 1)); off = Fraction(whole(-9000, 9000), 1000);
    rise = root(turn*(a - b*turn)/b)*sin(radians(theta0_deg)); thetadot0 = signed(near(rise));
    psidot0 = Fraction(turn)*(1 + off*one(0, Fraction(10)**whole(-60, -20)))
double cusp | two cusps that coincide (b = a/2), or are 1e-60 to 1e-3 apart | exact tilt
    | theta0_deg = 90; m = one(1, 2, 5); turn = Fraction(whole(1, 9), 4); r0 = m/turn;
    thetadot0 = one(1, 0.5); psidot0 = turn*(1 + signed(Fraction(10)**whole(-60, -2)))
no spin | pendulums, plane or spherical, or nearly | generic
    | r0 = one(0, 0, size(-60, -6)); psidot0 *= one(0, 1);
    theta0_deg = one(60, 90, 120, theta0_deg)
radians | a tilt in radians, mostly 1e-30 to 0.1 from 0, pi/2 or pi | generic
    | halves, side = one((0, 1), (1, 1), (1, -1), (2, -1)); still = one(0, 1);
    exact = halves*half_pi + side*Fraction(power(-30, -1)); thetadot0 *= still; psidot0 *= still;
    theta0_rad = one(exact, exact, float(exact), float(exact), radians(theta0_deg)); del theta0_deg
units | masses, lengths and times of 1e-20 to 1e20, half with wild rates | generic
    | in_units(20); wild = one(0, 12); r0 *= power(-wild, wild);
    thetadot0 *= power(-wild, wild); psidot0 *= power(-wild, wild)
any spin | a spin from 1e-300 to 1e100, with both rates | generic
    | r0 = size(-300, 100); thetadot0 = one(0, uniform(-3, 3));
    psidot0 = signed(one(1, 3, power(-6, 6)))
equal moduli | releases close to k = k' | generic
    | thetadot0 = psidot0 = 0; theta0_deg = uniform(1, 85);
    r0 = signed(sqrt(4*A*cos(radians(theta0_deg))*(1 + size(-15, -3)))/C)
hardly any torque | a gravity of 1e-15 to 1e-6 | ordinary | g = power(-15, -6)
hardly moving | rates of 1e-15 to 1e-6 | ordinary | sized("r0 thetadot0 psidot0", -15, -6, 3)
"""
_OTHERS = """\
near hanging | 1e-300 to 0.1 degrees from the lower vertical, a decimal | any rates
    | theta0_deg = 180 - Fraction(whole(1000, 9000), 1000)*Fraction(10)**whole(-300, 0)
separatrix | a swing that ends upright, exactly: 2 m = a, thetadot0^2 = (1 - u) (a - b psidot0)
    | exact tilt | theta0_deg, u, step = one((60, 0.5, 0.25), (120, -0.5, 0.75));
    turn = whole(1, 9)/4; psidot0 = signed(turn); thetadot0 = whole(-6, 7)*step;
    r0 = psidot0*(1 + u); m = (turn**2*(1 + u) + thetadot0**2/(1 - u))/2
steady | a steady precession, exactly: 2 b psidot0 = a + 2 psidot0^2 u | exact tilt
    | psidot0 = signed(2.0**whole(-4, 5)); m = whole(1, 64)/8; r0 = m/psidot0 + psidot0*u
over a pole | the axis passes exactly over a pole: psidot0 (1 +- u) = +-b | exact tilt
    | pole = one(-1, 1); m = whole(1, 9)/4; C = one(0.5, 1, 2); psidot0 = signed(whole(1, 33)/8);
    r0 = psidot0*pole*(1 + pole*u)/C; thetadot0 = one(uniform(-6, 6), uniform(-1, 1), 0)
from a pole | a start on the vertical, which the axis leaves | generic
    | theta0_deg = one(0, 180); psidot0 = 0; r0 *= one(0, 1, 1);
    thetadot0 = signed(one(uniform(0.01, 6), power(-9, 1)))
no torque | no gravity or no distance s, or nearly | generic
    | x = one(0, 0, power(-18, -3)); g, s = one((x, 1), (1, x)); r0 *= one(0, 1, 1, 1);
    theta0_deg = one(60, 90, 0, theta0_deg); psidot0 *= theta0_deg > 0
nice numbers | small rationals, whose keys are often exactly 0, or midway between two doubles |
    | few = 0, 0.25, 0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 10; s = 1; g = one(1, 1, 10);
    m, A = one(0.5, 1, 2, 3), one(0.5, 1, 2, 3); C = A*one(0.25, 0.5, 1, 2); r0 = signed(one(*few));
    tilts = 30, 45, 60, 60, 60, 90, 90, 90, 120, 120, 120, 135, 150, 0, 180, whole(1, 180);
    theta0_deg = one(*tilts); thetadot0 = one(0, 0, signed(one(*few)));
    psidot0 = one(0, 0, signed(one(*few))) if theta0_deg % 180 else 0
"""
_CORNERS = """\
subnormal | a rate or g of 1e-323 to 1e-290 | ordinary
    | sized("g r0 thetadot0 psidot0", -323, -290)
small | a mass, length or moment of 1e-100 to 1e-90, the least that is accepted | ordinary
    | sized("m s A", -97.5, -90)
huge | an input of 1e90 to 1e100, the greatest that is accepted | ordinary
    | sized("m s g A r0 thetadot0 psidot0", 90, 99.5)
both ends | three inputs at the ends, in ratios of 1e180 to 1e420 | ordinary
    | sized("g r0 thetadot0 psidot0", -323, -290); sized("m s A", -97.5, -90);
    sized("m s g A r0 thetadot0 psidot0", 90, 99.5)
"""
_STIFF_AND_EXTREME = """\
fast-spin | | moving | r0 = size(3, 6)
slow-spin | | released | r0 = size(-9, -2)
near-separatrix | | moving, swing | thetadot0 = near(thetadot0, -9, -3)
near-vertical | | moving, passage | psidot0 = near(psidot0, -8, -4)
tiny-tilt-with-rates | | moving | theta0_deg = power(-60, -4)
near-steady | | moving, slow rate
    | psidot0 = near(psidot0, -12, -3); thetadot0 = one(0, size(-16, -3))
near-hanging | | released | theta0_deg = 180 - Fraction(power(-9, -2))
extreme-sizes | | moving | in_units(12)
"""
"""The kinds of `stability`, which its README describes."""
_HALF_PI = Fraction("1.57079632679489661923132169163975144209858469968755291048747")
_TO_NEIGHBOURS, _MOST_STEPS = 0.3, 2
"""Of the numbers near a value: the share that are at most so many doubles away."""


class _Drawing(dict[str, Any]):
    """The names in the code of rows: numbers so far, and functions that draw or compute others."""

    Fraction, half_pi = Fraction, _HALF_PI

    def __init__(self, rng: Random) -> None:
        self.rng, self.uniform, self.whole = rng, rng.uniform, rng.randrange

    def __missing__(self, name: str) -> Any:
        found = getattr(self, name, None) or getattr(math, name, None)
        if found is None:
            raise KeyError(name)
        return found

    def one(self, *values: Any) -> Any:
        """Return one of some values."""
        return self.rng.choice(values)

    def signed(self, size: Any) -> Any:
        """Return a size with a random sign."""
        return self.one(-1, 1) * size

    def power(self, low: float, high: float) -> float:
        """Return a number between 10^low and 10^high, with a uniform logarithm."""
        return float(10 ** self.rng.uniform(low, high))

    def size(self, low: float, high: float) -> Any:
        """Return such a number with a random sign."""
        return self.signed(self.power(low, high))

    def root(self, square: float) -> float:
        """Return a square root, 0 of a negative number."""
        return math.sqrt(max(square, 0.0))

    def near(self, value: float, low: float = -16, high: float = -2) -> float:
        """Return a double that is 10^low to 10^high of a value away, or one of its neighbours."""
        if low > -16 or self.rng.random() > _TO_NEIGHBOURS:
            return value * (1 + float(self.size(low, high)))
        for _ in range(self.whole(_MOST_STEPS + 1)):
            value = math.nextafter(value, self.signed(math.inf))
        return value

    def sized(self, names: str, low: float, high: float, most: int = 1) -> None:
        """Give one of some inputs, or up to `most`, another size; C keeps its ratio to A."""
        ratio, given = self["C"] / self["A"], names.split()
        for name in self.rng.sample(given, self.rng.randint(1, min(most, len(given)))):
            self[name] = (self.size if name.endswith("0") else self.power)(low, high)
        self["C"] = ratio * self["A"]

    def in_units(self, most: float) -> None:
        """Take units of mass, length and time between 10^-most and 10^most."""
        mass, length, time = (self.power(-most, most) for _ in range(3))
        moment = mass * length**2
        sizes = {"m": mass, "s": length, "g": length / time**2, "A": moment, "C": moment}
        for name, size in (sizes | dict.fromkeys(("r0", "thetadot0", "psidot0"), 1 / time)).items():
            self[name] *= size


def _kinds(table: str) -> dict[str, Kind]:
    return {name: partial(_scene_of, name) for name, *_ in declared(table)}


def _scene_of(name: str, rng: Random) -> Scene:
    """Return a random scene of a kind."""
    drawing = _Drawing(rng)
    for code in _code_of(name):
        exec(code, {}, drawing)
    return {x: drawing[x] for x in INPUTS if x in drawing}


@cache
def _code_of(name: str) -> list[CodeType]:
    """Return the code of a row, after that of the rows that it begins with."""
    begins, code = _ROWS[name]
    before = [x for row in begins.split(",") if row for x in _code_of(row.strip())]
    return [*before, compile(code, name, "exec")]


_TABLES = _PARTS + _NUTATING + _OTHERS + _CORNERS + _STIFF_AND_EXTREME
_ROWS = {name: (begins, code) for name, _, begins, code in declared(_TABLES)}
CORNERS = _kinds(_CORNERS)
"""Kinds at the ends of the doubles; many of their numbers lie beyond."""
NUTATING_KINDS = _kinds(_NUTATING)
"""The kinds whose tops nearly all nutate under a torque, by name."""
KINDS = NUTATING_KINDS | _kinds(_OTHERS)
"""All kinds but CORNERS and those of `stability`."""


def in_doubles(scene: Scene) -> Scene:
    """Return a scene with each input rounded to the nearest double."""
    return {name: float(value) for name, value in scene.items()}


def nutating(kind: str, rng: Random) -> Scene:
    """Return the inputs, as doubles, of a scene of a kind that nutates under a torque.

    The kind is any of KINDS, or a kind of `stability`.
    """
    while True:
        scene = in_doubles(_scene_of(kind, rng))
        with suppress(LagtopError):
            check(solve(Top(**scene)))
            return scene
