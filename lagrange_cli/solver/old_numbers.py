"""The motion in the arithmetic that tables over time still use: kinds in balls, and the sampler."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..arithmetic.ball import Ball, TooFewDigitsError, balls
from ..arithmetic.numbers import R
from ..arithmetic.rounding import decided
from .facts import Regime
from .gaps import Gaps, State, are_told_apart, gaps_from_rest, state
from .regime import Exact, Facts
from .spin_precession import Nutating

if TYPE_CHECKING:
    from .kinds import Kind
    from .sampling import Sampler

SAMPLER_DIGITS = 40
"""Digits of the gaps of a sampler: 2^50 periods use 16 of them, and a double 16 more."""


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


class OldMotion:
    """The motion of one top."""

    def __init__(self, scene: Exact) -> None:
        self.exact, self.kind_class = scene, kind_of(scene.facts)
        self._kinds: dict[int, Kind[Ball]] = {}
        self._sampler: Sampler | None = None

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
