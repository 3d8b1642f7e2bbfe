"""The numbers of a motion, each correctly rounded, and its record: results and words by key."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

from flint import arb

from ..arithmetic.enclosures import Rounded, TooFewDigitsError, decided, rounded, settled, sign_to
from ..errors import OutOfRangeError
from ..names import RADIUS, suggestion
from ..top.top import Top
from ..top.units import DEGREES, Units, bare_name
from .facts import Facts, Regime
from .keys import LINES, NUMBERS, all_keys, exists, lacks, needed, record_keys
from .numbers import Numbers

if TYPE_CHECKING:
    from .sampling import Sampler


class Solution:
    """The numbers of one motion as attributes, named by their keys; see `Motion`."""

    def __init__(self, facts: Facts) -> None:
        self.facts = facts
        self._balls: dict[int, Numbers] = {}
        self._doubles: dict[str, Rounded | None] = {}
        self._has: dict[str, bool] = {}
        self._sampler: Sampler | None = None

    @property
    def top(self) -> Top:
        """The top with its initial state."""
        return self.facts.top

    @cached_property
    def regime(self) -> Regime:
        """The kind of motion."""
        return self.facts.regime

    def __getattr__(self, name: str) -> Any:
        """Return a number by its key: a float, or None if the motion has no such number."""
        if name not in NUMBERS:
            hint = "" if name.startswith("_") else suggestion(name, dir(self))
            raise AttributeError(f"a motion has no {name!r}{hint}", name=name, obj=self)
        found = self.number(name)
        return None if found is None else found.value

    def balls(self, digits: int) -> Numbers:
        """Return the numbers of the motion in balls of some digits, angles in radians."""
        if digits not in self._balls:
            self._balls[digits] = Numbers(self.facts, digits)
        return self._balls[digits]

    def ball(self, name: str, digits: int) -> arb | None:
        """Return a ball that holds a number or an input, by key; None if the motion has none.

        An angle is in degrees or in radians, as its name says.  Raises TooFewDigitsError if the
        digits do not separate the roots of the cubic.
        """
        if not self.has(name):
            return None
        of, bare = self.balls(digits), bare_name(name)
        ball: arb = self.facts.tilt.angle() if bare == "theta0" else of[bare]
        return ball * 180 / arb.pi() if name.endswith("_deg") else ball

    def has(self, name: str) -> bool:
        """Return whether the motion has a number or an input, by key."""
        bare = bare_name(name)
        if bare not in LINES:
            return True
        if bare not in self._has:
            self._has[bare] = bool(exists(bare, self.facts, self))
        return self._has[bare]

    def number(self, name: str, digits: int | None = None) -> Rounded | None:
        """Return a number correctly rounded to a double or to `digits`; None if it does not exist.

        `name` is a key; that of an angle ends in `_deg` or `_rad`.  Raises LagtopError if no
        precision distinguishes the number from 0 or from a tie.
        """
        if digits is None and name in self._doubles:
            return self._doubles[name]
        most = self.facts.equal + 10 * (digits or 0)
        found = settled(name, lambda working: self.ball(name, working), digits, most)
        if digits is None:
            self._doubles[name] = found
        return found

    def is_zero(self, name: str) -> bool:
        """Return whether a number is 0, or agrees with 0 to D digits."""
        return not sign_to(lambda digits: self.balls(digits)[name], self.facts.equal)

    def absence(self, name: str) -> str:
        """Return why the motion lacks a number: `undefined in ...` or `defined only if ...`.

        If the motion lacks a number that the formula names, the reason is that of the first one.
        """
        bare = bare_name(name)
        for other in needed(bare) if bare in LINES else ():
            if not self.has(other):
                return self.absence(other)
        if bare not in LINES or lacks(bare, self.facts):  # a text, such as the path
            return f"undefined in the regime {self.regime.value!r}"
        return f"defined only {LINES[bare].only}"

    @cached_property
    def path(self) -> str | None:
        """Path of the figure axis: `cusped`, `looping` or `wavy`; None if there is no such path."""
        return next((word for word, holds in path_words(self.facts, self) if holds), None)

    def precession_at(self, u: str) -> int:
        """Return the sign of b (beta - b u): 1 if the precession at u1 or u2 has the sign of r0."""

        def value(digits: int) -> arb:
            of = self.balls(digits)
            found: arb = of["b"] * (of["momentum_constant"] - of["b"] * of[u])
            return found

        return sign_to(value, self.facts.equal)

    @property
    def remark(self) -> str | None:
        """One line on special properties of the motion, or None."""
        return remark_of(self)

    def sampler(self) -> Sampler:
        """Return the constants used by `angles`, computed once."""
        from .sampling import FIRST_DIGITS, Sampler  # start-up: loads NumPy

        def sampler(digits: int) -> Sampler:
            return Sampler(self.balls(digits)["course"], self.facts.tilt.angle())

        if self._sampler is None:
            self._sampler = decided(sampler, self.facts.equal, digits=FIRST_DIGITS)
        return self._sampler


def record_in_range(
    motion: Solution,
    *,
    digits: int | None = None,
    radii: bool = False,
    units: Units = DEGREES,
    keys: Collection[str] | None = None,
) -> tuple[dict[str, Any], list[OutOfRangeError]]:
    """Return `Motion.record`, and an error for each number beyond the range of doubles."""
    words: dict[str, Callable[[], str | None]] = {
        "regime": lambda: motion.regime.value,
        "path": lambda: motion.path,
        "remark": lambda: units.remark(remark_of(motion, units)),
    }
    names = record_keys(units) if keys is None else [x for x in all_keys(units) if x in keys]
    record: dict[str, Any] = {}
    found: dict[str, Rounded | None] = {}
    beyond = []
    for name in names:
        if name in words:
            record[name] = words[name]()
        else:
            try:
                found[name] = _number(motion, name, digits)
            except OutOfRangeError as error:
                found[name] = None
                beyond.append(error)
            number = found[name]
            record[name] = None if number is None else number.value
    if "psidot0" in record and motion.top.steady_word:
        record["psidot0"] = motion.top.steady_word
    if radii:
        record |= {f"{name}{RADIUS}": number and number.radius for name, number in found.items()}
    return record, beyond


def _number(motion: Solution, name: str, digits: int | None) -> Rounded | None:
    """Return a number or an input as it is printed; None for a word."""
    facts = motion.facts
    tilt = {"theta0_deg": facts.tilt.degrees, "theta0_rad": facts.tilt.radians}
    given = facts.inputs.get(name, tilt.get(name))
    if given is not None:
        return Rounded(rounded(name, given, digits), given)
    return None if name == "psidot0" else motion.number(name, digits)


def path_words(facts: Any, of: Any) -> Iterator[tuple[str, Any]]:
    """Yield paths of the axis, each with its condition: a bool, or a mask for many motions.

    The first one whose condition holds is the path.  The precession stops at u1 (a cusp), between
    u1 and u2 (a loop), or nowhere.
    """
    if facts.plane or facts.steady:
        return
    yield "cusped", facts.released
    yield "wavy", facts.spin == 0
    yield "wavy", facts.over_top or facts.separatrix  # where beta - b u1 = 0 without a stop
    at_u1 = of.precession_at("u1")
    yield "cusped", at_u1 == 0
    yield "wavy", at_u1 > 0
    yield "looping", of.precession_at("u2") > 0
    yield "wavy", True


_FAST_WORDS = "pseudo-regular precession"


def remark_words(facts: Any) -> Iterator[tuple[str, Any]]:
    """Yield remarks, each with its condition, as `path_words`; numbers follow if a top is fast."""
    if facts.vertical:
        yield "only phi - psi is defined; stable", facts.pole < 0
        yield "only phi + psi is defined; stable (lambda = b^2/2a >= 1)", facts.stable
        yield "only phi + psi is defined; unstable (lambda = b^2/2a < 1)", True
    yield "rises to the vertical in infinite time", facts.separatrix
    yield _FAST_WORDS, facts.fast


def remark_without_numbers(facts: Facts) -> str | None:
    """Return the remark of one motion as a sweep has it."""
    return next((words for words, holds in remark_words(facts) if holds), None)


def remark_of(motion: Solution, units: Units = DEGREES) -> str | None:
    """Return a line on special properties of a motion."""
    words = remark_without_numbers(motion.facts)
    return _fast_remark(motion, units.angle) if words == _FAST_WORDS else words


def _fast_remark(motion: Solution, unit: str) -> str:
    """Return the remark on a pseudo-regular precession, numbers with three digits."""

    def short(name: str) -> str:
        found = motion.number(name, 3)
        assert found is not None
        return f"{float(found.value):.3g}"

    def excess(digits: int) -> int:
        found = (motion.balls(digits)["excess"] + 0.5).floor().unique_fmpz()
        if found is None:
            raise TooFewDigitsError
        return int(found)

    parts = decided(excess, motion.facts.equal)
    where = f"{abs(parts)} ppm {'below' if parts < 0 else 'above'}" if parts else "within 1 ppm of"
    return (
        f"{_FAST_WORDS}: nutates by {short(f'nutation_{unit}')} {unit} "
        f"in {short('T_nutation')} time; the mean rate is {where} mgs/(C r0) = "
        f"{short('precession_rate_elementary')} rad/time"
    )
