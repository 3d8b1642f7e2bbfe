"""The inputs of many tops as arrays, and the start of their motions.

`solve` takes the constants of a motion from exact fractions.  Here they are computed in pairs of
doubles and rounded once, so that the formulas begin with equal numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import factorial
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.bounded import EPS, PAIR_EPS, Bounded, choose, known, size_of
from ..arithmetic.pairs import PI, DoubleDouble, pair
from ..arithmetic.types import Array, Mask
from ..names import RADIUS
from ..solver.facts import Regime
from ..top.forms import Quantities
from ..top.inputs import FORMS, NINE, STEADY_WORDS, TILT, replaced_by
from ..top.top import Top
from ..top.units import bare_name

_SMALL, _LARGE = 1e-30, 1e30
"""Sizes between which no formula leaves the range of doubles."""
_DEGREE = DoubleDouble(np.array([np.pi / 180]), np.array([2.9486522708701687e-19]))
_NEAR_1 = 2.0**-44
"""Distance of lambda = b^2/2a from 1, or of the energies of a pendulum and the separatrix relative
to their size, below which a pair of doubles may lose the difference."""
_KNOWN = 2.0**-80
"""Largest relative error of an input that follows from another form."""
UNKNOWN = Bounded(np.nan, np.inf)
"""A number that only `solve` computes."""


def pi_of(*, pairs: bool) -> Bounded:
    """Return pi, in doubles or in pairs of doubles."""
    if not pairs:
        return Bounded(np.pi, None, EPS, positive=True)
    return Bounded(DoubleDouble(*map(np.asarray, PI)), None, EPS**2, positive=True)


class Angles(NamedTuple):
    """Tilts, each in the unit in which it was given."""

    number: Array
    in_degrees: Mask

    def within(self, degrees: float, radians: float) -> Mask:
        """Return the tilts of at least 1e-30 and at most some angle, or exactly 0."""
        most = np.where(self.in_degrees, degrees, radians)
        fits: Mask = (self.number == 0) | (self.number >= _SMALL) & (self.number <= most)
        return fits

    def in_unit(self, key: str) -> Array:
        """Return the tilts under a key that ends in their unit."""
        if key.endswith("_rad"):
            return np.where(self.in_degrees, np.radians(self.number), self.number)
        return np.where(self.in_degrees, self.number, np.degrees(self.number))

    def half_from_pole(self) -> tuple[Mask, DoubleDouble]:
        """Return the tilts that are nearer to the lower pole, and half the angles from the pole."""
        number, in_degrees = self.number, self.in_degrees
        down = number > np.where(in_degrees, 90, np.pi / 2)
        arc = DoubleDouble(np.where(down, 180 - number, number)) * _DEGREE
        if not in_degrees.all():
            own = DoubleDouble(number)
            own = DoubleDouble.choose(down, _DEGREE * 180.0 - own, own)
            arc = DoubleDouble.choose(in_degrees, arc, own)
        return down, arc.scaled(0.5)

    def start(self, *, pairs: bool) -> dict[str, Any]:
        """Return sine and cosine of the tilts, and 1 - u0 and 1 + u0, by the names of formulas.

        Half the angle is taken from the nearer pole, so that the relative error of the distance is
        that of all.
        """
        down, half = self.half_from_pole()
        near: Any
        far: Any
        if pairs:
            near = _sine(half)
            far = (1.0 - near * near).sqrt()
        else:
            near, far = np.sin(half.high), np.cos(half.high)
            near, far = near + half.low * far, far - half.low * near
        unit = 4 * PAIR_EPS if pairs else 3 * EPS
        sine, cosine = (Bounded(x, None, unit, positive=True) for x in (near, far))
        if not self.in_degrees.all():  # pi - theta0
            error = unit * size_of(near) + np.where(down, 4 * PAIR_EPS, 0.0)
            sine = Bounded(near, error, positive=True)
        from_pole, from_other = 2.0 * (sine * sine), 2.0 * (cosine * cosine)
        u0 = 1.0 - from_pole
        return {
            "theta0": (2.0 * (sine * cosine), choose(down, -u0, u0)),
            "above_u0": choose(down, from_other, from_pole),
            "below_u0": choose(down, from_pole, from_other),
        }

    def cosine(self) -> Bounded:
        """Return the cosines, in pairs of doubles."""
        found: Bounded = self.start(pairs=True)["theta0"][1]
        return found


INPUTS = frozenset(NINE) - {TILT}
"""The inputs that are numbers in any form, by their keys in a record, without the tilt."""


class TopArrays(NamedTuple):
    """The inputs of many tops, an array each."""

    given: Mapping[str, Array]
    """What was given, by the keys of `Top`; None in rows that have an input in another form."""
    tilt: Angles
    steady: Array
    """1 or 2 for the words of a steady precession, else 0."""
    numbers: Mapping[str, Array]
    """The other inputs; NaN for a word, and where only `solve` knows it."""
    derived: Mapping[str, Bounded]
    """The inputs that follow from another form, in pairs of doubles."""

    def known(self, keys: Iterable[str]) -> dict[str, Array]:
        """Return inputs by key: in the form that all tops have, with the bounds of their errors."""
        found: dict[str, Any] = {}
        for key in keys:
            form, radius, _ = key.partition(RADIUS)
            own = self.given.get(form)
            if bare_name(key) == TILT:
                found[key] = self.tilt.in_unit(key)
            elif key in INPUTS:
                found[key] = self.numbers[key]
            elif form in FORMS and own is not None and (own.dtype != object or None not in own):
                found[key] = own.astype(float) * (not radius)
        return found

    def part(self, rows: Any) -> TopArrays:
        """Return some of the tops, by a slice, a mask or their row numbers."""

        def some(arrays: Mapping[str, Any]) -> dict[str, Any]:
            return {name: x[rows] for name, x in arrays.items()}

        tilt = Angles(*(x[rows] for x in self.tilt))
        numbers, derived = some(self.numbers), some(self.derived)
        return TopArrays(some(self.given), tilt, self.steady[rows], numbers, derived)

    def one(self, row: int) -> Top:
        """Return one top.  Raises LagtopError if it is invalid."""
        return Top(**{name: x.item(row) for name, x in self.given.items()})

    def groups(self) -> dict[tuple[Regime | None, bool], Mask]:
        """Return the tops of ordinary size that the formulas of sweeps compute.

        The keys are a regime and whether tilts are in degrees.  Tops released from rest, plane
        pendulums, and steady ones given by a word are keyed by their regime; None has those with
        other initial rates, with a torque and off the vertical.
        """
        x, ordinary, steady = self.numbers, self._are_ordinary(), self.steady > 0
        upright, in_degrees = self.tilt.number == 0, self.tilt.in_degrees
        hanging = in_degrees & (self.tilt.number == 180)
        falls, torque = x["thetadot0"] != 0, (x["s"] > 0) & (x["g"] > 0)
        at_rest = ordinary & ~falls & (x["psidot0"] == 0)
        inclined = ordinary & ~(upright | hanging)
        released = inclined & at_rest & torque
        pendulum = inclined & torque & (x["r0"] == 0) & (x["psidot0"] == 0)
        groups = {
            Regime.SLEEPING: at_rest & upright,
            Regime.HANGING: at_rest & hanging,
            Regime.TORQUE_FREE: inclined & at_rest & ~torque,
            Regime.NO_SPIN: pendulum & self._are_off_separatrix(),
            Regime.REGULAR: released & (x["r0"] != 0),
            Regime.STEADY: inclined & steady & torque & ~falls & self._have_steady_rates(),
            None: inclined & ~steady & torque & ~pendulum & (falls | (x["psidot0"] != 0)),
        }
        units = [unit for unit in (True, False) if (in_degrees == unit).any()]
        return {
            (regime, unit): mask & (in_degrees == unit) if len(units) > 1 else mask
            for regime, mask in groups.items()
            for unit in units
        }

    def _are_off_separatrix(self) -> Mask:
        """Return the pendulums of which doubles decide whether they turn over."""
        m, A, s, g, rate = (self.numbers[name] for name in ("m", "A", "s", "g", "thetadot0"))
        swing = rate * rate
        over = swing - 4 * m * g * s / A * np.sin(self.tilt.in_unit("theta0_rad") / 2) ** 2
        found: Mask = abs(over) >= _NEAR_1 * swing
        return found

    def _have_steady_rates(self) -> Mask:
        """Return the tops with rates of steady precession; `solve` gives the others an error."""
        m, A, C, s, g, r0 = (self.numbers[name] for name in ("m", "A", "C", "s", "g", "r0"))
        least = 4 * A * m * g * s * np.cos(self.tilt.in_unit("theta0_rad"))
        found: Mask = (C * r0) ** 2 > least
        return found

    def _are_ordinary(self) -> Mask:
        """Return the valid tops whose sizes fit, and that are not next to the sleeping threshold.

        Comparisons with NaN are false: tops that lack an input are not among them.
        """
        m, A, C, s, g, r0 = (self.numbers[name] for name in ("m", "A", "C", "s", "g", "r0"))
        ordinary: Mask = self.tilt.within(180, np.pi)
        for x in (m, A, C):
            ordinary &= (x >= _SMALL) & (x <= _LARGE)
        rate = np.where(self.steady > 0, 0.0, self.numbers["psidot0"])
        for x in (s, g, np.abs(r0), np.abs(self.numbers["thetadot0"]), np.abs(rate)):
            ordinary &= (x == 0) | (x >= _SMALL) & (x <= _LARGE)
        torque = m * g * s
        lam = (C * r0) ** 2 / (4 * A * torque)
        ordinary &= (torque == 0) | (lam == 0) | (lam >= _SMALL**2) & (lam <= _LARGE**2)
        return ordinary & ~(np.abs(lam - 1) < _NEAR_1)

    def number(self, name: str, *, pairs: bool) -> Bounded:
        """Return an input other than the tilt, in doubles or in pairs of doubles."""
        if (found := self.derived.get(name)) is not None:
            found.positive = name in "mACsg"
            return found if pairs else found.rounded()
        exact = self.numbers[name]
        return Bounded(DoubleDouble(exact) if pairs else exact, positive=name in "mACsg")


_SINE = [pair(Fraction((-1) ** n, factorial(2 * n + 1))) for n in range(15)]
"""Coefficients of the sine in x^2; from x^17 on, their low parts do not count."""


def _sine(x: DoubleDouble) -> DoubleDouble:
    """Return the sine by its Taylor series, for |x| <= pi/4."""
    square = x * x
    tail = np.zeros_like(square.high)
    for term in _SINE[:7:-1]:
        tail = tail * square.high + term.high
    total = DoubleDouble(tail)
    for term in _SINE[7::-1]:
        total = total * square + DoubleDouble(*map(np.array, term))
    return total * x


def top_arrays(inputs: Mapping[str, Any], size: int) -> TopArrays:
    """Return the inputs of tops, each an array or one value; None where a top lacks it.

    psidot0 may be a word of a steady precession, or an array of objects with such words among its
    numbers.
    """
    given = {name: np.broadcast_to(x, (size,)) for name, x in inputs.items()}
    turn, (slow, fast) = given["psidot0"], STEADY_WORDS
    steady = np.broadcast_to(np.float64(turn == slow) + 2 * np.float64(turn == fast), (size,))
    rate = np.where(steady > 0, np.nan, turn.astype(object)) if steady.any() else turn
    numbers = {name: x.astype(float) for name, x in (given | {"psidot0": rate}).items()}
    tilt = _tilts(numbers, size)
    nine = {name: numbers.get(name, np.full(size, np.nan)) for name in INPUTS}
    derived = dict[str, Bounded]()
    for key in (x for x in numbers if x in FORMS and replaced_by(x) != TILT):
        rows = np.array([x is not None for x in given[key]])  # the others have another form
        name = replaced_by(key)
        own = {x: y for x, y in numbers.items() if x == key or x not in {*FORMS, name}}
        other = derived.get(name, Bounded(DoubleDouble(nine[name])))
        derived[name] = choose(rows, _from_form(key, own, tilt), other)
        nine[name] = derived[name].doubles
    return TopArrays(given, tilt, steady, nine, derived)


def _tilts(numbers: Mapping[str, Array], size: int) -> Angles:
    """Return the tilts of tops from both of their forms."""
    none = np.full(size, np.nan)
    degrees, radians = (numbers.get(x, none) for x in ("theta0_deg", "theta0_rad"))
    in_degrees = np.isnan(radians)
    return Angles(np.where(in_degrees, degrees, radians), in_degrees)


def _from_form(key: str, numbers: Mapping[str, Array], tilt: Angles) -> Bounded:
    """Return the input that a form gives; NaN if it has lost digits, or is out of bounds."""
    with np.errstate(all="ignore"):
        pairs = {name: Bounded(DoubleDouble(x)) for name, x in numbers.items()}
        found = Quantities(pairs, pi=lambda: pi_of(pairs=True), u0=tilt.cosine)[replaced_by(key)]
        if FORMS[key].bound == "0 or more":
            found = choose(numbers[key] >= 0, found, UNKNOWN)
        return known(found, _KNOWN, positive=False)
