"""Proved numbers of one motion: its formulas in ball arithmetic, sharp enough to be rounded.

The inputs are exact rationals, so that the regime and every exact zero are decided in fractions
(`regime`); the balls prove the rest, that each gap between roots is positive among it.  A number is
taken where both ends of its ball are rounded alike, at whatever precision that is; a motion or a
tie that 20 000 bits do not decide is said, not guessed.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from decimal import Decimal
from fractions import Fraction
from typing import Any, TypeVar

from ..arithmetic.balls import Ball, Balls, balls, near_largest_root
from ..arithmetic.correct_rounding import TooFewDigitsError, nearest_double, text_of
from ..arithmetic.numbers import Number
from ..arithmetic.proved_rounding import Proved, about, decided, proved
from ..arithmetic.text import NumberText
from ..errors import OutOfRangeError
from ..inputs.top import Top
from .gaps import are_told_apart, gaps_of, state
from .kinds import Kind, Nutating, fast_remark, kind_of
from .rational_keys import known_fraction
from .record import record_of, source_of, unit_name
from .regime import Exact, Regime, exact
from .spinors import Spinor

S = TypeVar("S")

_MEAN_RATES = {"T_spin": "mean_spin_rate", "T_precession": "mean_precession_rate"}
"""The rates that periods are made of: where one is exactly 0, there is no period."""


def proved_largest_root(ar: Balls, c2: Ball, c1: Ball, c0: Ball, bound: Ball) -> Ball:
    """Return a ball that holds the largest root of x^3 + c2 x^2 + c1 x + c0, whose roots are real.

    Laguerre's method finds a point p near it.  If p - f(p)/f'(X) is within a ball X around p, then
    X holds a root, and just one (Moore 1966); if f' and f'' are positive in X, they are so beyond,
    and no root is larger.  Raises TooFewDigitsError where these bits do not prove it.
    """

    def cubic(x: Ball) -> Ball:
        return ((x + c2) * x + c1) * x + c0

    def slope(x: Ball) -> Ball:
        return (3 * x + 2 * c2) * x + c1

    point = Ball(near_largest_root(c2.arb.mid(), c1.arb.mid(), c0.arb.mid(), bound.arb.mid()))
    scale = 4 * abs(cubic(point) / slope(point)) + 16 * ar.eps * abs(point)
    around = ar.widened(point, lambda: scale)
    root = point - cubic(point) / slope(around)
    if not (around.holds(root) and slope(around) > 0 and 3 * around + c2 > 0):
        raise TooFewDigitsError
    return root


class Certified:
    """The motion of one top in balls; each precision is computed once."""

    def __init__(self, scene: Exact) -> None:
        self.exact, self.top = scene, scene.top
        self.kind_class = kind_of(scene.facts)
        self._kinds: dict[int, Kind[Ball]] = {}
        self._spinors: dict[int, Spinor[Ball]] = {}

    @property
    def regime(self) -> Regime:
        """The kind of motion."""
        return self.exact.facts.regime

    @property
    def path(self) -> str | None:
        """Path of the figure axis: `cusped`, `looping` or `wavy`; None where it has none."""
        return self.decide("path", lambda kind: kind.path)

    def remark_in(self, *, radians: bool = False) -> str | None:
        """Return the remark, whose numbers are rounded as both ends of their balls are."""

        def remark(kind: Kind[Ball]) -> str | None:
            if not (isinstance(kind, Nutating) and kind.facts.fast):
                return kind.remark(radians=radians)
            nodding, *others = kind.fast_numbers
            with kind.ar.working():
                numbers = [nodding if radians else nodding / kind.degree, *others]
            low, high = (
                _fast_remark(*ends, radians=radians)
                for ends in zip(*(ball.ends(40) for ball in numbers), strict=True)
            )
            if low != high:
                raise TooFewDigitsError
            return low

        return self.decide("remark", remark)

    def kind(self, bits: int) -> Kind[Ball]:
        """Return the motion in balls of so many bits.

        Raises TooFewDigitsError where these do not tell the roots apart.
        """
        if bits not in self._kinds:
            ar, facts = balls(bits), self.exact.facts
            with ar.working():
                start = state(ar, self.exact)
                gaps = gaps_of(ar, facts, start, proved_largest_root)
                if not are_told_apart(facts, gaps):
                    raise TooFewDigitsError
            self._kinds[bits] = self.kind_class(ar, facts, start, gaps)
        return self._kinds[bits]

    def spinor(self, bits: int) -> Spinor[Ball]:
        """Return the attitude as a function of time.  Raises as `kind`."""
        if bits not in self._spinors:
            self._spinors[bits] = self.kind(bits).spinor()
        return self._spinors[bits]

    def decide(self, what: str, ask: Callable[[Kind[Ball]], S]) -> S:
        """Return what is asked of the motion, at the first precision that decides it.

        Raises LagtopError where none does.
        """
        return decided(what, lambda bits: ask(self.kind(bits)))

    def enclosure(self, name: str, bits: int, *, radians: bool = False) -> Ball | None:
        """Return a ball that holds a number, by its key; None where the motion has none.

        Angles are in degrees or `radians`.  Raises TooFewDigitsError where these bits leave open
        which formula holds.
        """
        if name in self.kind_class.lacks:
            return None
        kind = self.kind(bits)
        try:
            value: Ball | None = getattr(source_of(name, kind, self.exact), name)
        except TooFewDigitsError:
            if name in _MEAN_RATES and known_fraction(self.exact, _MEAN_RATES[name]) == 0:
                return None
            raise
        if value is None or not (radians and name.endswith("_deg")):
            return value
        with kind.ar.working():
            return value * kind.degree

    def judged(self, name: str, judge: Callable[[Ball | None], S]) -> S:
        """Return what a judge says of a number, at the first precision at which it does.

        It is asked with an enclosure or, where that says too little, with a ball about the fraction
        that the number is known to be.  Raises LagtopError where it never says anything.
        """

        def with_bits(bits: int) -> S:
            ar = balls(bits)
            with ar.working():
                try:
                    return judge(self.enclosure(name, bits))
                except TooFewDigitsError:
                    known = known_fraction(self.exact, name)
                    if known is None:
                        raise
                    return judge(ar.convert(known))

        return decided(name, with_bits)

    def number(
        self, name: str, digits: int | None = None, *, radians: bool = False
    ) -> Proved[Any] | None:
        """Return the double nearest to a number, or so many digits of it, with its radius.

        None stands where the motion has none.  Raises LagtopError where no precision tells.
        """
        in_radians = radians and name.endswith("_deg")
        return proved(
            name,
            lambda bits: self.enclosure(name, bits, radians=radians),
            rounding(name, digits),
            digits=digits or 0,
            exactly=lambda: known_fraction(self.exact, name, radians=in_radians),
        )

    def record(
        self,
        digits: int | None = None,
        *,
        radians: bool = False,
        keys: Collection[str] | None = None,
    ) -> dict[str, Any]:
        """Return the record of `Motion.record`, or of `Motion.digits`, with radii.

        `KEY_radius` says how far the exact value may be from the number under KEY.  Raises
        LagtopError where no precision tells a number, or where one is beyond the range of doubles.
        """
        record, beyond = self.record_in_range(digits, radians=radians, keys=keys)
        if beyond:
            raise beyond[0]
        return record

    def record_in_range(
        self,
        digits: int | None = None,
        *,
        radians: bool = False,
        keys: Collection[str] | None = None,
    ) -> tuple[dict[str, Any], list[OutOfRangeError]]:
        """Return the record with radii, and what is to be said of numbers beyond doubles."""
        radii: dict[str, NumberText | None] = {}
        beyond: list[OutOfRangeError] = []

        def note(name: str, found: Proved[Any] | None) -> Any:
            radii[name] = None if found is None else found.radius
            return None if found is None else found.value

        def number(name: str, radians: bool) -> Any:
            found = None
            try:
                found = self.number(name, digits, radians=radians)
            except OutOfRangeError as error:
                beyond.append(error)
            return note(unit_name(name, radians=radians), found)

        inputs = {name: note(name, x) for name, x in self._inputs(digits, radians=radians).items()}
        record = record_of(self, inputs, number, radians=radians, keys=keys)
        return record | {f"{x}_radius": radii[x] for x in record if x in radii}, beyond

    def _inputs(self, digits: int | None, *, radians: bool) -> Mapping[str, Proved[Any]]:
        """Return the inputs as they are printed."""

        def shown(name: str, value: Ball | Number) -> Proved[Any]:
            to = rounding(name, digits)
            if not isinstance(value, Ball):
                return about(to(Fraction(value)), Fraction(value))
            found = proved(
                name, lambda bits: self._inputs_in(bits, radians)[name], to, digits=digits or 0
            )
            assert found is not None
            return found

        return {name: shown(name, x) for name, x in self._inputs_in(64, radians).items()}

    def _inputs_in(self, bits: int, radians: bool) -> dict[str, Any]:
        ar = balls(bits)
        with ar.working():
            return self.top.inputs(radians=radians, ar=ar)


def certified(top: Top) -> Certified:
    """Return the motion of a top in balls.  Raises LagtopError as `solve` does."""
    return Certified(exact(top))


def rounding(name: str, digits: int | None) -> Callable[[Decimal | Fraction], Any]:
    """Return the rounding of a number to doubles, or to so many significant digits."""
    if digits is not None:
        return lambda value: text_of(value, digits)
    nearest = nearest_double(name)
    return lambda value: nearest(value) + 0.0  # never -0.0


def _fast_remark(*numbers: Decimal, radians: bool) -> str:
    """Return the remark on a fast top, its numbers rounded as decimals to what it shows of them."""
    nodding, period, elementary = (float(f"{x:.3g}") for x in numbers[:3])
    excess = round(numbers[3] * 10**6) / 1e6
    return fast_remark(nodding, period, elementary, excess, radians=radians)
