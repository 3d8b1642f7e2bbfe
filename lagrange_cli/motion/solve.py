"""`solve(top)`: the motion of one top, whose numbers are computed when they are asked for."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Collection, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

from ..arithmetic.ball import Ball, TooFewDigitsError
from ..arithmetic.balls import balls
from ..arithmetic.rounding import Settled, decided, rounding_of, settled
from ..errors import OutOfRangeWarning
from ..inputs.top import Top
from .gaps import are_told_apart, gaps_of, largest_root, state
from .kinds import Kind, kind_of, middle_of
from .record import NUMBER_KEYS, number_key, record_in_range, requested_keys
from .regime import Exact, Regime, exact

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..arithmetic.types import Array
    from .notebook import Document
    from .over_time.samplers import Angles, Sampler
    from .paper.worked_example import WorkedExample

S = TypeVar("S")

SAMPLER_DIGITS = 40
"""Digits of the gaps behind a sampler: 2^50 periods take 16 of them, and a double 16 more."""


def solve(top: Top) -> Motion:
    """Return the motion of a top.  Raises LagtopError for a start that describes no motion."""
    return Motion(exact(top))


class Motion:
    """The motion of one top: the numbers of its record as attributes, and its angles over time.

    Each number is the double nearest to its exact value, proved by an enclosure when it is first
    asked for; one that the regime does not have is None.  Their names are those of `lagtop solve`:
    a, b, u1, u2, u3, k, T_nutation, mean_precession_rate ...; `record` gives all of them.
    """

    def __init__(self, scene: Exact) -> None:
        self.exact = scene
        self.kind_class = kind_of(scene.facts)
        self._kinds: dict[int, Kind[Ball]] = {}
        self._requested: dict[int, WorkedExample[Ball]] = {}
        self._doubles: dict[str, Settled | None] = {}
        self._sampler: Sampler | None = None

    @property
    def top(self) -> Top:
        """The top, and its start."""
        return self.exact.top

    @property
    def regime(self) -> Regime:
        """The kind of motion."""
        return self.exact.facts.regime

    @property
    def path(self) -> str | None:
        """Path of the figure axis: `cusped`, `looping` or `wavy`; None where it has none."""
        return self.decide("path", lambda kind: kind.path)

    @property
    def remark(self) -> str | None:
        """One line on what is special about the motion, or None."""
        return self.remark_in()

    def remark_in(self, *, radians: bool = False) -> str | None:
        """Return the remark, with angles in degrees or `radians`."""
        return self.decide("remark", lambda kind: kind.remark(radians=radians))

    def __getattr__(self, name: str) -> Any:
        """Return a number by its key, a float, or None where the motion has none."""
        if number_key(name) is None:
            raise AttributeError(f"a motion has no {name!r}")
        found = self.number(name)
        return None if found is None else found.value

    def __dir__(self) -> Sequence[str]:
        """Return all names, the keys of the record among them."""
        return [*super().__dir__(), *NUMBER_KEYS, *requested_keys()]

    def __eq__(self, other: object) -> bool:
        """Return whether the other is the motion of the same top."""
        return isinstance(other, Motion) and other.top == self.top

    def __hash__(self) -> int:
        return hash(self.top)

    def __reduce__(self) -> tuple[Callable[[Top], Motion], tuple[Top]]:
        """Return how copies and pickles are made: from the top."""
        return solve, (self.top,)

    def numbers(self) -> dict[str, float | None]:
        """Return the numbers of the record by key, angles in degrees; see `record`."""
        record = self.record()
        return {name: record[name] for name in NUMBER_KEYS}

    def record(
        self,
        *,
        digits: int | None = None,
        radii: bool = False,
        radians: bool = False,
        keys: Collection[str] | None = None,
    ) -> dict[str, Any]:
        """Return inputs and results by key, in the order of the paper; `radians` for all angles.

        Numbers are doubles or, with `digits`, texts of so many significant digits; inputs then
        count as decimals.  `radii` adds KEY_radius: the greatest distance of the exact value from
        the number under KEY.  A number beyond the range of doubles is None, and an
        OutOfRangeWarning names it.  `keys` asks for some of them only; of these it raises
        OutOfRangeError.  Raises LagtopError if no precision tells a number from 0.
        """
        record, beyond = record_in_range(
            self, digits=digits, radii=radii, radians=radians, keys=keys
        )
        if beyond and keys is not None:
            raise beyond[0]
        if beyond:
            warnings.warn("; ".join(map(str, beyond)), OutOfRangeWarning, stacklevel=2)
        return record

    def number(
        self, name: str, digits: int | None = None, *, radians: bool = False
    ) -> Settled | None:
        """Return the double nearest to a number, or so many digits of it; None if it has none.

        Raises LagtopError if no precision tells it from 0 or a tie.
        """
        in_radians = radians and name.endswith("_deg")
        is_usual = digits is None and not in_radians
        if is_usual and name in self._doubles:
            return self._doubles[name]
        found = settled(
            name,
            lambda working: self.enclosure(name, working, radians=in_radians),
            rounding_of(name, digits),
            digits=digits or 0,
            exactly=lambda: self._known(name, radians=in_radians),
        )
        if is_usual:
            self._doubles[name] = found
        return found

    def _known(self, name: str, *, radians: bool = False) -> Fraction | None:
        """Return a number if it is known as a fraction."""
        from .exact.rational_keys import known_fraction  # for few tops only

        return known_fraction(self.exact, name, radians=radians)

    def enclosure(self, name: str, digits: int, *, radians: bool = False) -> Ball | None:
        """Return a ball that holds a number, by its key; None if the motion has none.

        Angles are in degrees or `radians`.  Raises TooFewDigitsError if these digits leave open
        which formula holds.
        """
        if name in self.kind_class.lacks:
            return None
        kind = self.kind(digits)
        try:
            source = kind if name in NUMBER_KEYS else self._on_request(digits)
            value: Ball | None = getattr(source, name)
        except TooFewDigitsError:
            from .exact.rational_keys import is_endless  # for few tops only

            if is_endless(self.exact, name):
                return None
            raise
        return value * kind.degree if radians and value is not None else value

    def _on_request(self, digits: int) -> WorkedExample[Ball]:
        """Return the keys on request in balls of so many digits."""
        from .paper.worked_example import WorkedExample  # the last of the classes with such keys

        if digits not in self._requested:
            self._requested[digits] = WorkedExample(self.kind(digits), self.exact)
        return self._requested[digits]

    def decide(self, what: str, ask: Callable[[Kind[Ball]], S]) -> S:
        """Return an answer of the motion, at the first precision that decides it.

        Raises LagtopError if none does.
        """
        return decided(what, lambda digits: ask(self.kind(digits)))

    def kind(self, digits: int) -> Kind[Ball]:
        """Return the motion in balls of so many digits.

        Raises TooFewDigitsError if these do not tell the roots apart.
        """
        if digits not in self._kinds:
            ar, facts = balls(digits), self.exact.facts
            start = state(ar, self.exact)
            gaps = gaps_of(ar, facts, start, largest_root)
            if not are_told_apart(facts, gaps):
                raise TooFewDigitsError
            self._kinds[digits] = self.kind_class(ar, facts, start, gaps)
        return self._kinds[digits]

    def middle(self, digits: int = SAMPLER_DIGITS) -> Kind[Decimal]:
        """Return the motion in decimals, from a start and gaps that are proved to so many digits.

        Nothing cancels in the constants of its series, which need no balls.
        """

        def sharp(working: int) -> Kind[Ball]:
            kind = self.kind(working)
            constant = kind.facts.steady  # none of the gaps is used
            if not (constant or all(gap.is_known_to(digits) for gap in kind.gaps)):
                raise TooFewDigitsError
            return kind

        middle: Kind[Decimal] = middle_of(decided("the roots of the cubic", sharp, digits))
        return middle

    def __repr__(self) -> str:
        return f"<Motion: {self.regime}, T_nutation = {self.T_nutation}, {self.top}>"

    def _repr_html_(self) -> str:
        """Return the record as a table for a notebook."""
        from .notebook import record_table

        return record_table(self)

    def view(self) -> Document:
        """Return a page on which the top turns, for a notebook or, with `save`, for a browser.

        Raises LagtopError for inputs that are beyond what the page computes with.
        """
        from .. import view  # the face of the package: pictures are drawn by a room above this one

        return view(self)

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """Return tilt, spin and precession (radians) at the times t, in the shape of t.

        Spin and precession are unwrapped and 0 at t = 0; `wrap` brings them to (-pi, pi].
        Raises LagtopError for a time that is not finite or beyond 2^50 nutation periods.
        """
        return self.sampler().angles(t, wrap=wrap)

    def table(
        self,
        t: ArrayLike,
        columns: Sequence[str] = ("t", "theta", "phi", "psi"),
        *,
        wrap: bool = False,
    ) -> dict[str, Array]:
        """Return columns of `lagtop table` by name, each a float64 array in the shape of t.

        Angles are in radians; `axis` and `quaternion` expand into axis_x ... quaternion_z, which
        may also be named singly.  Raises LagtopError for an unknown column or a time out of reach.
        """
        from .over_time.table import table

        return table(self, t, columns, wrap=wrap)

    def sampler(self) -> Sampler:
        """Return the series behind `angles`, made once."""
        if self._sampler is None:
            self._sampler = self.middle().sampler()
        return self._sampler
