"""The numbers of one motion: enclosures in any precision, the record, and the sampler of angles."""

from __future__ import annotations

from collections.abc import Callable, Collection
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

from ..arithmetic.ball import Ball, TooFewDigitsError, balls
from ..arithmetic.numbers import R
from ..arithmetic.rounding import FIRST_DIGITS, Rounded, decided, rounding_of, settled, sign_of
from ..errors import OutOfRangeError
from ..top.top import Top
from .gaps import Gaps, State, are_told_apart, gaps_from_rest, state
from .quantity import degree_name, unit_name
from .record import NUMBER_KEYS, all_keys, number_key, record_keys, requested_keys
from .regime import Exact, Facts, Regime
from .spin_precession import Nutating

if TYPE_CHECKING:
    from .kinds import Kind
    from .sampling import Sampler

_S = TypeVar("_S")

SAMPLER_DIGITS = 40
"""Digits of the gaps of a sampler: 2^50 periods use 16 of them, and a double 16 more."""
MEAN_RATES = {"T_spin": "mean_spin_rate", "T_precession": "mean_precession_rate"}
"""The mean rate of each period of one turn, which does not exist if the rate is 0."""


def gaps_of(ar: Any, facts: Facts, start: State[R]) -> Gaps[R]:
    """Return the gaps of any top."""
    if facts.falls:
        return gaps_from_rest(ar, start)
    from .any_start import gaps_from_start  # start-up: not for a release from rest

    return gaps_from_start(ar, start, facts)


def kind_of(facts: Facts) -> type[Kind[Any]]:
    """Return the class of the motion with these facts."""
    vertical = facts.regime in {Regime.SLEEPING, Regime.HANGING}
    if not (vertical or facts.steady or facts.regime is Regime.SEPARATRIX):
        return Nutating
    from .kinds import Constant, Separatrix, Vertical  # start-up: for few tops

    if vertical:
        return Vertical
    return Constant if facts.steady else Separatrix


class Numbers:
    """The motion of one top; each number is computed once, in balls of sufficient precision.

    Numbers are attributes named by the keys of the record; see `Motion`.
    """

    def __init__(self, scene: Exact) -> None:
        self.exact = scene
        self.kind_class = kind_of(scene.facts)
        self._kinds: dict[int, Kind[Ball]] = {}
        self._requested: dict[int, Any] = {}
        self._doubles: dict[str, Rounded | None] = {}
        self._zeros: dict[str, bool] = {}
        self._sampler: Sampler | None = None

    @property
    def top(self) -> Top:
        """The top with its initial state."""
        return self.exact.top

    @property
    def regime(self) -> Regime:
        """The kind of motion."""
        return self.exact.facts.regime

    def __getattr__(self, name: str) -> Any:
        """Return a number by its key: a float, or None if the motion has no such number."""
        if number_key(name) is None:
            from ..names import suggestion  # start-up: for a misspelt name only

            hint = "" if name.startswith("_") else suggestion(name, dir(self))
            raise AttributeError(f"a motion has no {name!r}{hint}", name=name, obj=self)
        found = self.number(name)
        return None if found is None else found.value

    def number(
        self, name: str, digits: int | None = None, *, radians: bool = False
    ) -> Rounded | None:
        """Return a number correctly rounded to a double or to `digits`; None if it does not exist.

        Raises LagtopError if no precision distinguishes it from 0 or from a tie.
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
            most=self.exact.equal + 10 * (digits or 0),
        )
        if is_usual:
            self._doubles[name] = found
        return found

    def is_zero(self, name: str) -> bool:
        """Return whether a number is 0, or agrees with 0 to D digits."""
        if name not in self._zeros:
            sign = sign_of(lambda digits: self.enclosure(name, digits), self.exact.equal)
            self._zeros[name] = sign == 0
        return self._zeros[name]

    def enclosure(self, name: str, digits: int, *, radians: bool = False) -> Ball | None:
        """Return a ball that contains a number, by key; None if the motion has no such number.

        Angles are in degrees or `radians`.  The ball is computed at the precision in use, with the
        roots of the cubic in `digits` digits.  Raises TooFewDigitsError if the digits do not decide
        which formula holds.
        """
        if name in self.kind_class.lacks:
            return None
        if name in MEAN_RATES and self.is_zero(MEAN_RATES[name]):
            return None
        kind = self.kind(digits)
        source = kind if name in NUMBER_KEYS else self._on_request(digits)
        value: Ball | None = getattr(source, name)
        return value * kind.degree if radians and value is not None else value

    def absence(self, name: str) -> str:
        """Return why the motion lacks a number: `undefined in ...` or `defined only if ...`."""
        name = degree_name(name)
        key = number_key(name)
        if key is None or not key.only or name in self.kind_class.lacks:
            return f"undefined in the regime {self.regime.value!r}"
        return f"defined only {key.only}"

    def _on_request(self, digits: int) -> Any:
        """Return the further keys in balls of `digits` digits."""
        from .requested import Requested  # start-up

        if digits not in self._requested:
            self._requested[digits] = Requested(self.kind(digits), self.exact)
        return self._requested[digits]

    def decide(self, what: str, ask: Callable[[Kind[Ball]], _S]) -> _S:
        """Return the result of `ask` at the first precision that decides it.

        Raises LagtopError if no precision does.
        """
        return decided(what, lambda digits: ask(self.kind(digits)))

    def kind(self, digits: int) -> Kind[Ball]:
        """Return the motion in balls of `digits` digits.

        Raises TooFewDigitsError if they do not separate the roots.
        """
        if digits not in self._kinds:
            facts = self.exact.facts
            with balls(digits) as ar:
                start = state(ar, self.exact)
                gaps = gaps_of(ar, facts, start)
                if not are_told_apart(facts, gaps):
                    raise TooFewDigitsError
            self._kinds[digits] = self.kind_class(ar, facts, start, gaps)
        return self._kinds[digits]

    def sharp(self, digits: int = SAMPLER_DIGITS) -> Kind[Ball]:
        """Return the motion in balls, from a start and gaps proved to `digits` digits."""

        def kind_in(working: int) -> Kind[Ball]:
            kind = self.kind(working)
            constant = kind.facts.steady  # no gap is used
            if not (constant or all(gap.is_known_to(digits) for gap in kind.gaps)):
                raise TooFewDigitsError
            return kind

        return decided("the roots of the cubic", kind_in, digits)

    def sampler(self) -> Sampler:
        """Return the series used by `angles`, computed once."""
        from .sampling import sampler_of  # start-up: loads NumPy

        if self._sampler is None:
            self._sampler = decided(  # a start of many digits may need more of them
                "the angles", lambda digits: sampler_of(self.sharp(digits - 10)), SAMPLER_DIGITS
            )
        return self._sampler


def record_in_range(
    motion: Numbers,
    *,
    digits: int | None = None,
    radii: bool = False,
    radians: bool = False,
    keys: Collection[str] | None = None,
) -> tuple[dict[str, Any], list[OutOfRangeError]]:
    """Return `Motion.record`, and an error for each number beyond the range of doubles."""
    names, numbers = record_keys(radians=radians), NUMBER_KEYS
    wanted = set(names if keys is None else keys)
    if not wanted <= set(names):
        names, numbers = all_keys(radians=radians), [*NUMBER_KEYS, *requested_keys()]
    found, beyond = _inputs(motion.exact, digits, radians=radians), []
    for name in numbers:
        shown = unit_name(name, radians=radians)
        if shown in wanted:
            try:
                found[shown] = motion.number(name, digits, radians=radians)
            except OutOfRangeError as error:
                found[shown] = None
                beyond.append(error)
    values = {name: None if number is None else number.value for name, number in found.items()}
    values["regime"] = motion.regime.value
    if motion.top.steady_word:
        values["psidot0"] = motion.top.steady_word
    if "path" in wanted:
        values["path"] = motion.decide("path", lambda kind: kind.path)
    if "remark" in wanted:
        values["remark"] = motion.decide("remark", lambda kind: kind.remark(radians=radians))
    record = {name: values[name] for name in names if name in wanted}
    if radii:
        known = {name: found[name] for name in record if name in found}
        record |= {f"{name}_radius": x and x.radius for name, x in known.items()}
    return record, beyond


def _inputs(exact: Exact, digits: int | None, *, radians: bool) -> dict[str, Rounded | None]:
    """Return the inputs as they are printed; None for a word."""
    top = exact.top

    def shown(name: str, value: Any) -> Rounded | None:
        rounding = rounding_of(name, digits)
        if not isinstance(value, Ball):
            return Rounded(rounding(Fraction(value)), Fraction(value))
        return settled(
            name,
            lambda working: top.inputs(radians=radians, ar=balls(working))[name],
            rounding,
            digits=digits or 0,
            most=exact.equal + 10 * (digits or 0),
        )

    given = top.inputs(radians=radians, ar=balls(FIRST_DIGITS))
    words = {"psidot0": None} if top.steady_word else {}
    return {name: shown(name, value) for name, value in given.items()} | words
