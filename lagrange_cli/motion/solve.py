"""`solve(top)`: the motion of one top, whose numbers are computed when they are asked for."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Collection, Sequence
from decimal import Decimal, DivisionByZero, InvalidOperation
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

from ..arithmetic.correct_rounding import (
    TooFewDigitsError,
    correctly_rounded,
    nearest_double,
    precisions,
    text_of,
)
from ..arithmetic.decimals import decimals
from ..errors import LagtopError, OutOfRangeError, OutOfRangeWarning
from ..inputs.top import Top
from .gaps import agree, are_told_apart, gaps_of, released, state
from .kinds import Kind, kind_of
from .record import NUMBER_KEYS, number_key, record_of, requested_keys, source_of
from .regime import Exact, Regime, exact

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..arithmetic.text import NumberText
    from ..arithmetic.types import Array
    from .notebook import Document
    from .samplers import Angles, Sampler

T = TypeVar("T")

SAMPLER_DIGITS = 40
"""Digits of the gaps behind a sampler: 2^50 periods take 16 of them, and a double 16 more."""


def solve(top: Top) -> Motion:
    """Return the motion of a top.  Raises LagtopError for a start that describes no motion."""
    return Motion(exact(top))


class Motion:
    """The motion of one top: the numbers of its record as attributes, and its angles over time.

    Each number is the double nearest to its exact value, computed when it is first asked for; one
    that the regime does not have is None.  Their names are those of `lagtop solve`: a, b, u1, u2,
    u3, k, T_nutation, mean_precession_rate ...; `record` gives all of them.
    """

    def __init__(self, scene: Exact) -> None:
        self.exact = scene
        self.kind_class = kind_of(scene.facts)
        self._kinds: dict[int, Kind[Decimal]] = {}
        self._doubles: dict[str, float | None] = {}
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
        path: str | None = self._settled_kind.path
        return path

    @property
    def remark(self) -> str | None:
        """One line on what is special about the motion, or None."""
        return self.remark_in()

    def remark_in(self, *, radians: bool = False) -> str | None:
        """Return the remark, with angles in degrees or `radians`."""
        return self._settled_kind.remark(radians=radians)

    def __getattr__(self, name: str) -> Any:
        """Return a number by its key, a float, or None where the motion has none."""
        if number_key(name) is None:
            raise AttributeError(f"a motion has no {name!r}")
        if name not in self._doubles:
            self._doubles[name] = self._number(name, nearest_double(name), float)
        return self._doubles[name]

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
        self, *, radians: bool = False, keys: Collection[str] | None = None
    ) -> dict[str, Any]:
        """Return inputs and results by key, in the order of the paper; `radians` for all angles.

        A number beyond the range of doubles is None, and an OutOfRangeWarning names it.  `keys`
        asks for some of them only; of these it raises OutOfRangeError.
        """
        record, beyond = self.record_in_range(radians=radians, keys=keys)
        if beyond and keys is not None:
            raise beyond[0]
        if beyond:
            warnings.warn("; ".join(map(str, beyond)), OutOfRangeWarning, stacklevel=2)
        return record

    def record_in_range(
        self, *, radians: bool = False, keys: Collection[str] | None = None
    ) -> tuple[dict[str, Any], list[OutOfRangeError]]:
        """Return the record, and what is to be said of numbers beyond the range of doubles."""
        beyond = []

        def number(name: str, radians: bool) -> float | None:
            try:
                return self._double_in(name, radians)
            except OutOfRangeError as error:
                beyond.append(error)
                return None

        with decimals(40).working():
            given = self.top.inputs(radians=radians, ar=decimals(40))
        inputs = {name: float(x) for name, x in given.items()}
        return record_of(self, inputs, number, radians=radians, keys=keys), beyond

    def digits(
        self, digits: int, *, radians: bool = False, keys: Collection[str] | None = None
    ) -> dict[str, Any]:
        """Return the record with every number written out to so many significant digits.

        `keys` asks for some of them only.  The inputs count as decimals and stand as they were
        given.  Raises LagtopError where no precision tells a number from 0.
        """

        def number(name: str, radians: bool) -> NumberText | None:
            return self._number(
                name, lambda x: text_of(x, digits), lambda x: text_of(x, digits), digits, radians
            )

        ar = decimals(digits + 10)
        with ar.working():
            inputs = {
                name: text_of(x if isinstance(x, Decimal) else Fraction(x), digits)
                for name, x in self.top.inputs(radians=radians, ar=ar).items()
            }
        return record_of(self, inputs, number, radians=radians, keys=keys)

    def _double_in(self, name: str, radians: bool) -> float | None:
        if not (radians and name.endswith("_deg")):
            value: float | None = getattr(self, name)
            return value
        return self._number(name, nearest_double(name), float, radians=True)

    def _number(
        self,
        name: str,
        rounding: Callable[[Decimal], T],
        of_fraction: Callable[[Fraction], T],
        digits: int = 0,
        radians: bool = False,
    ) -> T | None:
        """Return a number of the record, rounded correctly: the fraction where it is one."""
        if name in self.kind_class.lacks:
            return None
        in_radians = radians and name.endswith("_deg")
        declared = number_key(name)
        cancels = declared is not None and declared.cancels

        def exactly() -> T | None:
            from .rational_keys import known_fraction  # for few tops only

            known = known_fraction(self.exact, name, radians=in_radians)
            return None if known is None else of_fraction(known)

        def value_in(digits: int) -> Decimal | None:
            kind = self.kind(digits)
            value: Decimal | None = getattr(source_of(name, kind, self.exact), name)
            if not in_radians or value is None:
                return value
            with kind.ar.working():
                return value * kind.degree

        return correctly_rounded(
            name,
            value_in,
            rounding,
            first=max(32, digits + 10),
            zero_is_proved=not cancels,
            exactly=exactly,
            lost=8 if self.exact.facts.at_rest and not cancels else None,
        )

    def kind(self, digits: int) -> Kind[Decimal]:
        """Return the motion computed with so many decimal digits.

        Raises TooFewDigitsError where these do not tell the roots apart.
        """
        if digits not in self._kinds:
            ar = decimals(digits)
            with ar.working():
                start = state(ar, self.exact)
                gaps = gaps_of(ar, self.exact.facts, start)
                if not are_told_apart(self.exact.facts, gaps):
                    raise TooFewDigitsError
            self._kinds[digits] = self.kind_class(ar, self.exact.facts, start, gaps)
        return self._kinds[digits]

    @property
    def _settled_kind(self) -> Kind[Decimal]:
        return self.settled_kind(8)

    def settled_kind(self, digits: int) -> Kind[Decimal]:
        """Return the motion computed with enough digits that so many of every gap are right."""
        previous: Kind[Decimal] | None = None
        first = max(32, digits * 6 // 5)
        for working in precisions(first):
            try:
                kind = self.kind(working)
            except (TooFewDigitsError, InvalidOperation, DivisionByZero):
                continue
            if released(self.exact.facts):
                return kind
            if previous is not None:
                with kind.ar.working():
                    if agree(kind.gaps, previous.gaps, digits):
                        return previous
            previous = kind
        raise LagtopError("the roots of the cubic cannot be told apart")

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
        from .table import table

        return table(self, t, columns, wrap=wrap)

    def sampler(self) -> Sampler:
        """Return the series behind `angles`, made once."""
        if self._sampler is None:
            self._sampler = self.settled_kind(SAMPLER_DIGITS).sampler()
        return self._sampler
